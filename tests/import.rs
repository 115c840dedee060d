//! Frames of other programs: what comes out of a recording, and what happens to one that lies.

mod caster_lights;
mod convert;
mod machine;
mod map_faces;
mod maps;
#[cfg(unix)]
mod process;
mod shared;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde_json::{Value, json};
use shared::{assert_makes_what_was_stored, draws, recording};
use std::fs;
use std::io::Write;
use stencilscope::import::{self, ImportError, RawContents, RawKind, RawTopology, RecordedApi};
use tempfile::TempDir;

/// Pixels a draw whose stencil may differ where volume and surface share a corner, and so a depth.
const TIES: usize = 8;

#[test]
fn the_stencil_shadows_of_ogre_come_out_whole() {
    let frame = import::read(&recording("ogre")).expect("a frame");
    assert_eq!((frame.api, frame.recorder.as_str()), (RecordedApi::OpenGl, "RenderDoc 1.24"));
    assert!(frame.limits.is_empty(), "{:?}", frame.limits);
    let triangles: Vec<usize> = draws(&frame).iter().map(|draw| draw.triangles.len()).collect();
    assert_eq!(triangles, [2, 576, 12, 4, 120, 12, 8, 2, 576, 12, 4]);
    assert_makes_what_was_stored(&frame);
    assert!(machine::compare(&frame).iter().all(|draw| draw.stencil <= TIES));
}

#[test]
fn z_fail_and_z_pass_of_one_frame_come_out_whole() {
    let frame = import::read(&recording("ogre-inside")).expect("a frame");
    assert_makes_what_was_stored(&frame);
}

/// What wgpu draws on Vulkan: depth as a float and reversed, a viewport of negative height, light caps.
#[test]
fn our_own_z_fail_comes_out_whole() {
    let frame = import::read(&recording("own")).expect("a frame");
    assert_eq!((frame.api, draws(&frame).len()), (RecordedApi::Vulkan, 15));
    let passes = frame.events.iter().filter(|event| event.kind == RawKind::BeginPass);
    let passes: Vec<&str> = passes.map(|event| event.groups[0].as_str()).collect();
    assert_eq!(passes, ["ambient", "volumes", "mask", "light"]);
    let volume = draws(&frame)[2];
    assert!(volume.view.y_up && !volume.view.z_from_minus_w && volume.view.viewport == [0.0, 0.0, 160.0, 120.0]);
    assert_makes_what_was_stored(&frame);
}

/// Row 0 is at the top: OGRE's blue background is above the floor.
#[test]
fn pictures_and_geometry_are_the_same_way_up() {
    let frame = import::read(&recording("ogre")).expect("a frame");
    let color = frame.events.last().and_then(|_| frame.events.iter().rev().find_map(|event| event.after.color.clone()));
    let color = color.expect("a colour");
    assert_eq!(color.rgba_at([0, 0]), Some([26, 26, 76, 255]), "background");
    let floor = draws(&frame)[0];
    let view = &floor.view;
    assert!(view.y_up && view.z_from_minus_w && view.viewport == [0.0, 0.0, 320.0, 240.0]);
    // All that is seen of the floor is lower than its horizon.
    assert!(floor.positions.iter().all(|[_, y, _, w]| *w < 0.0 || *y < 0.9 * w));
}

/// What does not change is one picture in memory.
#[test]
fn equal_pictures_are_shared() {
    let frame = import::read(&recording("ogre")).expect("a frame");
    let colors: Vec<_> = frame.events.iter().filter_map(|event| event.after.color.as_ref()).collect();
    let volumes = &colors[5..9];
    assert!(volumes.iter().all(|color| std::sync::Arc::ptr_eq(color, volumes[0])));
}

#[test]
fn the_list_names_events_states_and_targets() {
    let frame = import::read(&recording("ogre")).expect("a frame");
    let list = import::list(&frame);
    for words in
        ["14 events, 11 draws, 1328 triangles", "pass increment-wrap", "320x240 D24S8", "stencil equal 0; blend"]
    {
        assert!(list.contains(words), "{words}: {list}");
    }
}

/// A folder of two textures of 2x2 texels, and a clear and a draw of one triangle; `change` may lie about it.
fn made(change: impl FnOnce(&mut Value, &mut Vec<Vec<u8>>)) -> TempDir {
    let positions = [[0.0_f32, 0.0, 0.0, 1.0], [f32::NAN, 0.0, 0.0, 1.0], [1.0, 1.0, f32::INFINITY, 1.0]];
    let floats = positions.as_flattened().iter().flat_map(|float| float.to_le_bytes()).collect();
    let mut blobs: Vec<Vec<u8>> = vec![vec![7; 16], vec![0xff; 16], floats, vec![0, 1, 2], b"void main() {}".to_vec()];
    let face = json!({"fail": "Keep", "depth_fail": "Keep", "pass": "IncWrap", "compare": "AlwaysTrue", "reference": 0,
        "compare_mask": 255, "write_mask": 255});
    let equation = json!({"source": "One", "target": "Zero", "operation": "Add"});
    let target = |texture: usize| json!({"texture": texture, "mip": 0, "layer": 0});
    let texture = |name: &str, format: &str| json!({"name": name, "format": format, "size": [2, 2], "layers": 1, "mips": 1, "samples": 1, "depth": false});
    let event = |id: u32, kind: &str| {
        json!({"id": id, "name": "glCall(Depth = 1)", "groups": ["a"], "kind": kind, "colors": [target(0), null],
            "depth": target(1), "color_after": 0, "depth_after": 1, "clears": [true, true]})
    };
    let mut draw = event(2, "draw");
    draw["draw"] = json!({"stencil_test": true, "depth_test": true, "depth_write": true, "depth_bounds": false,
        "depth_clamp": false, "depth_clip": true, "bias": [0, 0, 0], "alpha_to_coverage": false, "discards_all": false,
        "negative_one_to_one": true, "origin_lower_left": true, "clip_planes": false, "front": face, "back": face,
        "depth_compare": "Less", "cull": "NoCull", "front_ccw": true, "fill": "Solid", "viewport": [0, 0, 2, 2],
        "depth_range": [0, 1], "scissor": null, "why": "",
        "instances": [{"topology": "TriangleList", "count": 3, "vertices": 2, "stride": 16, "indices": 3,
            "index_stride": 1, "base_vertex": 0, "restart": null}],
        "blend": {"enabled": false, "color": equation, "alpha": equation, "write_mask": 15, "logic": false},
        "shader": {"encoding": "GLSL", "bytes": 4}});
    let mut document = json!({"format": 1, "recorder": "RenderDoc 1.24", "api": "OpenGL", "adapter": "none",
        "textures": [texture("color", "R8G8B8A8_UNORM"), texture("depth", "D24S8")],
        "before": [{"target": target(0), "contents": 0}], "limits": [], "events": [event(1, "clear"), draw]});
    change(&mut document, &mut blobs);
    let folder = tempfile::tempdir().expect("a folder");
    let (mut data, mut table) = (Vec::new(), Vec::new());
    for blob in &blobs {
        let mut packed = ZlibEncoder::new(Vec::new(), Compression::fast());
        packed.write_all(blob).expect("packed");
        let packed = packed.finish().expect("packed");
        table.push(json!([data.len(), packed.len(), blob.len()]));
        data.extend(packed);
    }
    if document.get("blobs").is_none() {
        document["blobs"] = Value::Array(table);
    }
    fs::write(folder.path().join("frame.json"), document.to_string()).expect("written");
    fs::write(folder.path().join("data.bin"), data).expect("written");
    folder
}

/// Depth as the integers of 24 bits that it was stored as.
fn bits(after: &RawContents) -> Vec<u32> {
    let depth = after.depth.as_ref().expect("depth");
    let depths = depth.rows().flat_map(|row| row.as_chunks::<4>().0).map(|depth| f32::from_le_bytes(*depth));
    depths.map(|depth| (f64::from(depth) * f64::from(0xff_ffff)).round() as u32).collect()
}

fn stencils(after: &RawContents) -> Vec<u8> {
    after.stencil.as_ref().expect("stencil").rows().flatten().copied().collect()
}

#[test]
fn a_folder_made_by_hand_is_read() {
    let frame = import::read(made(|_, _| {}).path()).expect("a frame");
    assert_eq!(frame.events[0].kind, RawKind::Clear { color: true, depth: true, stencil: false });
    let [draw] = draws(&frame)[..] else { panic!("a draw") };
    assert_eq!((draw.topology, &draw.triangles[..]), (RawTopology::TriangleList, &[[0, 1, 2]][..]));
    assert!(draw.positions[1][0].is_nan() && draw.positions[2][2].is_infinite());
    let after = &frame.events[1].after;
    assert_eq!((bits(after), stencils(after)), (vec![0xff_ffff; 4], vec![255; 4]));
}

#[test]
fn a_picture_may_be_assembled_from_pieces() {
    let frame = import::read(
        made(|document, blobs| {
            document["textures"][0]["size"] = json!([2, 4]);
            document["events"][0]["color_after"] = json!(5);
            document["events"][1]["color_after"] = json!(5);
            document["before"] = json!([]);
            blobs.push(Vec::new());
        })
        .path(),
    );
    assert!(frame.expect_err("no bytes are no picture").to_string().contains("has 0 bytes, not 32"));
    let folder = made(|document, _| {
        document["textures"][0]["size"] = json!([2, 4]);
        document["events"][0]["color_after"] = json!(5);
        document["events"][1]["color_after"] = json!(5);
        document["before"] = json!([]);
    });
    let file = folder.path().join("frame.json");
    let mut document: Value = serde_json::from_slice(&fs::read(&file).expect("read")).expect("JSON");
    document["blobs"].as_array_mut().expect("blobs").push(json!({"pieces": [0, 1]}));
    fs::write(&file, document.to_string()).expect("written");
    let frame = import::read(folder.path()).expect("a frame");
    // OpenGL's rows come from the bottom.
    let color = frame.events[1].after.color.as_ref().expect("a colour");
    assert_eq!([color.rgba_at([0, 0]), color.rgba_at([1, 3])], [Some([0xff; 4]), Some([7; 4])]);
}

/// Of three triangles two go into the last layer of three, and one into the first.
#[test]
fn a_draw_into_layers_is_read_as_one_for_each() {
    let layered = |document: &mut Value, blobs: &mut Vec<Vec<u8>>| {
        let vertex = |index: usize, layer: u32| {
            let place = [index as f32, 0.0, 0.0, 1.0].map(f32::to_le_bytes);
            [place.as_flattened(), &layer.to_le_bytes()[..]].concat()
        };
        blobs[2] = (0..9).flat_map(|index| vertex(index, [2, 0, 2][index / 3])).collect();
        (0..2).for_each(|texture| document["textures"][texture]["layers"] = json!(3));
        for event in document["events"].as_array_mut().expect("events") {
            event["layers_after"] = json!([1, 0, null]);
        }
        let draw = &mut document["events"][1]["draw"];
        draw["layer_at"] = json!(16);
        draw["instances"][0]["indices"] = Value::Null;
        (draw["instances"][0]["stride"], draw["instances"][0]["count"]) = (json!(20), json!(9));
        // What follows is of the same layers.
        let (mut again, events) = (document["events"][1].clone(), document["events"].as_array_mut().expect("events"));
        again["id"] = json!(3);
        events.push(again);
    };
    let frame = import::read(made(layered).path()).expect("a frame");
    let targets: Vec<(u32, u32, usize)> = frame
        .events
        .iter()
        .map(|event| (event.id, event.depth_target.expect("a target").layer, event.color_targets.len()))
        .collect();
    assert_eq!(targets, [(1, 0, 1), (1, 1, 1), (1, 2, 1), (2, 0, 1), (3, 0, 1), (2, 2, 1), (3, 2, 1)]);
    assert_eq!(draws(&frame).iter().map(|draw| draw.triangles.len()).collect::<Vec<_>>(), [1, 1, 2, 2]);
    assert_eq!(draws(&frame)[2].positions.iter().map(|place| place[0]).collect::<Vec<_>>(), [0., 1., 2., 6., 7., 8.]);
    let held = [0, 1].map(|event| bits(&frame.events[event].after)[0]);
    assert_eq!((held, frame.events[2].after.depth.is_none()), ([0xff_ffff, 0x07_0707], true));
    let lost = import::read(
        made(|document, blobs| {
            layered(document, blobs);
            document["events"][1]["layers_after"] = json!([1]);
        })
        .path(),
    );
    let limits = lost.expect("a frame").limits;
    assert!(
        limits.iter().any(|limit| limit == "event 2: 2 triangles are drawn into layers that are not there"),
        "{limits:?}"
    );
}

#[test]
fn lies_are_refused_in_words() {
    type Lie = fn(&mut Value, &mut Vec<Vec<u8>>);
    let cases: [(&str, Lie); 22] = [
        ("format 2, not 1", |document, _| document["format"] = json!(2)),
        ("of the API `D3D11`", |document, _| document["api"] = json!("D3D11")),
        ("has 70000x2 texels", |document, _| document["textures"][0]["size"][0] = json!(70_000)),
        ("has 16 bytes, not 64", |document, _| document["textures"][0]["size"] = json!([4, 4])),
        ("has 16 bytes, not 32", |document, _| {
            // Another texture has the same bytes, and they fit it.
            (document["textures"][1]["size"], document["textures"][1]["format"]) =
                (json!([2, 4]), json!("R8G8B8A8_UNORM"));
            document["events"][1]["depth_after"] = json!(0);
            document["events"][0]["depth_after"] = json!(null);
        }),
        ("there is no byte string 99", |document, _| document["events"][1]["color_after"] = json!(99)),
        ("level 0 of layer 3 of texture 0", |document, _| document["before"][0]["target"]["layer"] = json!(3)),
        ("of texture 8", |document, _| document["events"][0]["depth"]["texture"] = json!(8)),
        ("of the kind `dance`", |document, _| document["events"][0]["kind"] = json!("dance")),
        ("no stencil operation `Double`", |document, _| {
            document["events"][1]["draw"]["front"]["pass"] = json!("Double")
        }),
        ("no comparison `Nearly`", |document, _| document["events"][1]["draw"]["depth_compare"] = json!("Nearly")),
        ("closer than a position", |document, _| document["events"][1]["draw"]["instances"][0]["stride"] = json!(4)),
        ("indices are 3 bytes long", |document, _| {
            document["events"][1]["draw"]["instances"][0]["index_stride"] = json!(3);
        }),
        ("lies outside", |document, _| document["blobs"] = json!([[0, 1_000_000, 16]])),
        ("lies outside", |document, _| document["blobs"] = json!([[u64::MAX, 2, 16]])),
        ("not 14 bytes long", |document, _| {
            document["blobs"] = json!([[0, 11, 16], [0, 11, 16], [0, 0, 0], [0, 0, 0], [0, 11, 14]])
        }),
        ("byte string 1 is a piece that has pieces", |document, _| {
            document["blobs"] = json!([[0, 11, 16], {"pieces": [0, 1]}]);
        }),
        ("there is no byte string 7", |document, _| document["blobs"] = json!([{"pieces": [7]}])),
        ("byte string 0 is an empty piece", |document, _| {
            document["blobs"] = json!([[0, 11, 0], {"pieces": [0, 0]}]);
        }),
        ("has 18446744073709551615 bytes, not 16", |document, _| {
            document["blobs"] = json!([[0, 11, u64::MAX], {"pieces": [0, 0]}]);
            document["before"][0]["contents"] = json!(1);
        }),
        ("level 0 of layer 1 of texture 1", |document, _| document["events"][1]["layers_after"] = json!([1, 1])),
        ("frame.json", |document, _| document["events"] = json!("none")),
    ];
    for (words, lie) in cases {
        let error = import::read(made(lie).path()).expect_err(words).to_string();
        assert!(error.contains(words) && !error.contains('\n'), "{words}: {error}");
    }
}

#[test]
fn a_byte_string_of_any_claimed_length_takes_no_memory() {
    let folder = made(|document, _| {
        document["textures"][0]["size"] = json!([16_384, 16_384]);
        document["blobs"] = json!([[0, 10, 1_u64 << 30], [0, 10, u64::MAX]]);
    });
    assert!(matches!(import::read(folder.path()), Err(ImportError::Folder(_))));
    let folder = made(|document, _| {
        document["before"] = json!([]);
        document["events"][1]["draw"]["shader"]["bytes"] = json!(0);
        document["events"].as_array_mut().expect("events").remove(0);
        document["blobs"] = json!([[0, 10, u64::MAX]]);
        document["events"][0]["depth"] = json!(null);
        document["events"][0]["colors"] = json!([]);
    });
    assert!(matches!(import::read(folder.path()), Err(ImportError::TooLarge { .. })));
}

/// No depth, no triangles, several samples: each in one line that says what to do.
#[test]
fn frames_that_can_not_be_followed_are_named() {
    type Change = fn(&mut Value);
    let cases: [(&str, Change); 4] = [
        ("no depth buffer that could be followed: --list shows", |document| {
            (document["events"][0]["depth"], document["events"][1]["depth"]) = (Value::Null, Value::Null);
            document["events"][0]["depth_after"] = Value::Null;
            document["events"][1]["depth_after"] = Value::Null;
        }),
        ("4 samples a pixel, of which no history can be told: record it again, or switch the", |document| {
            document["textures"][1]["samples"] = json!(4);
            document["events"][0]["depth_after"] = Value::Null;
            document["events"][1]["depth_after"] = Value::Null;
        }),
        ("no triangles that could be followed", |document| {
            document["events"][1]["draw"]["instances"][0]["topology"] = json!("LineList");
        }),
        ("no depth buffer", |document| document["events"].as_array_mut().expect("events").truncate(1)),
    ];
    for (words, change) in cases {
        let frame = import::read(made(|document, _| change(document)).path()).expect("a frame");
        let error = import::convert(&frame, "made").expect_err(words).to_string();
        assert!(error.contains(words) && !error.contains('\n'), "{words}: {error}");
    }
}

/// The first of four samples a pixel is followed where it was recorded, and that is said.
#[test]
fn the_first_of_several_samples_is_followed() {
    let folder = made(|document, _| document["textures"][1]["samples"] = json!(4));
    let frame = import::read(folder.path()).expect("a frame");
    let [draw] = draws(&frame)[..] else { panic!("a draw") };
    // OpenGL's first sample lies at 3/8, 7/8 of a pixel from its upper left corner.
    assert_eq!(draw.view.viewport, [0.125, -0.375, 2.0, 2.0]);
    assert!(
        frame.limits.iter().any(|limit| limit.contains("`depth` has 4 samples a pixel: of each the first is read"))
    );
    assert!(frame.events[1].after.depth.is_some());
    let found = import::convert(&frame, "made").expect("a frame");
    assert_eq!(found.capture.size, [2, 2]);
}

/// Two thousand draws of 64 x 256 pixels, each of which changes eight rows: the frame takes what has changed.
#[test]
fn a_frame_of_many_draws_takes_the_memory_of_what_they_changed() {
    const DRAWS: usize = 2000;
    const SIZE: [usize; 2] = [64, 256];
    let folder = made(|document, blobs| {
        document["textures"][0]["size"] = json!(SIZE);
        document["textures"][1]["size"] = json!(SIZE);
        let mut picture = vec![0; SIZE[0] * SIZE[1] * 4];
        blobs[0].clone_from(&picture);
        blobs[1].clone_from(&picture);
        let (first, draw) = (document["events"][0].clone(), document["events"][1].clone());
        let after = |at: usize| {
            let mut event = draw.clone();
            (event["id"], event["depth_after"]) = (json!(2 + at), json!(blobs.len() + at));
            event
        };
        let events: Vec<Value> = std::iter::once(first).chain((0..DRAWS).map(after)).collect();
        document["events"] = json!(events);
        for at in 0..DRAWS {
            let rows = SIZE[0] * 4 * 8;
            let start = at % (SIZE[1] / 8) * rows;
            picture[start..start + rows].iter_mut().for_each(|byte| *byte = byte.wrapping_add(1));
            blobs.push(picture.clone());
        }
    });
    let frame = import::read(folder.path()).expect("a frame");
    let made = import::convert(&frame, "made").expect("followed");
    let draws: Vec<_> = made.capture.steps.iter().flat_map(|step| &step.draws).collect();
    assert_eq!(draws.len(), DRAWS);
    let whole = DRAWS * SIZE[0] * SIZE[1] * 5;
    let bytes = made.capture.bytes();
    assert!(bytes * 20 < whole as u64, "{bytes} of {whole}");
}

#[test]
fn what_can_not_be_followed_is_said() {
    let frame = import::read(
        made(|document, blobs| {
            blobs[3] = vec![0, 1, 200];
            document["textures"][0]["format"] = json!("R32_UINT");
            document["events"][1]["draw"]["clip_planes"] = json!(true);
        })
        .path(),
    );
    let frame = frame.expect("a frame");
    assert!(draws(&frame)[0].triangles.is_empty() && frame.events[1].after.color.is_none());
    for words in ["corners point to no vertex", "format R32_UINT", "planes of its own"] {
        assert!(frame.limits.iter().any(|limit| limit.contains(words)), "{words}: {:?}", frame.limits);
    }
}

#[test]
fn an_index_that_restarts_has_all_bits() {
    let frame = import::read(
        made(|document, blobs| {
            blobs[3] = vec![0, 1, 2, 255, 2, 1, 0];
            let instance = &mut document["events"][1]["draw"]["instances"][0];
            (instance["topology"], instance["restart"]) = (json!("TriangleStrip"), json!(u32::MAX));
        })
        .path(),
    );
    assert_eq!(draws(&frame.expect("a frame"))[0].triangles, [[0, 1, 2], [2, 1, 0]]);
}

/// RenderDoc's bytes for Vulkan: stencil above depth, rows from the top, and unused padding at the end.
#[test]
fn depth_of_24_bits_with_stencil_has_padding_after_it_on_vulkan() {
    let frame = import::read(
        made(|document, blobs| {
            document["api"] = json!("Vulkan");
            let words = [0x0100_0000_u32, 0x02ff_ffff, 0x0300_0001, 0x0480_0000];
            blobs[1] = words.iter().flat_map(|word| word.to_le_bytes()).chain([9; 4]).collect();
        })
        .path(),
    );
    let after = &frame.expect("a frame").events[0].after;
    assert_eq!((bits(after), stencils(after)), (vec![0, 0xff_ffff, 1, 0x80_0000], vec![1, 2, 3, 4]));
}

/// A random number from another; good enough to choose what to break.
fn next(state: &mut u64) -> usize {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 11) as usize
}

/// Breaks bytes here and there, cuts off, or writes another number in place of one.
fn broken(mut bytes: Vec<u8>, state: &mut u64) -> Vec<u8> {
    const NUMBERS: [&str; 7] = ["0", "-1", "1", "255", "4294967295", "18446744073709551615", "1e39"];
    match next(state) % 4 {
        0 => bytes.truncate(next(state) % bytes.len()),
        1 => (0..=next(state) % 8).for_each(|_| {
            let at = next(state) % bytes.len();
            bytes[at] = next(state) as u8;
        }),
        _ => {
            let is_digit = |at: &usize| bytes[*at].is_ascii_digit();
            let digits: Vec<usize> = (0..bytes.len()).filter(is_digit).collect();
            let Some(&at) = digits.get(next(state) % digits.len().max(1)) else { return bytes };
            let start = (0..at).rev().take_while(|at| bytes[*at].is_ascii_digit()).last().unwrap_or(at);
            let end = (at..bytes.len()).find(|at| !bytes[*at].is_ascii_digit()).unwrap_or(bytes.len());
            bytes.splice(start..end, NUMBERS[next(state) % NUMBERS.len()].bytes());
        }
    }
    bytes
}

#[test]
fn broken_recordings_make_an_error_or_a_frame() {
    let folder = tempfile::tempdir().expect("a folder");
    let [states, data] = ["frame.json", "data.bin"].map(|file| {
        let bytes = fs::read(recording("ogre").join(file)).expect(file);
        fs::write(folder.path().join(file), &bytes).expect(file);
        (folder.path().join(file), bytes)
    });
    let (mut state, mut frames, mut errors) = (0x9e37_79b9_7f4a_7c15, 0, 0);
    for turn in 0..300 {
        let (file, bytes) = if turn % 6 == 0 { &data } else { &states };
        fs::write(file, broken(bytes.clone(), &mut state)).expect("written");
        *(if import::read(folder.path()).is_ok() { &mut frames } else { &mut errors }) += 1;
        fs::write(file, bytes).expect("written");
    }
    assert!(frames > 20 && errors > 100, "{frames} frames, {errors} errors");
}

/// Nobody waits for a writer.
#[cfg(unix)]
#[test]
fn a_pipe_in_place_of_a_file_is_refused_by_name() {
    for name in ["frame.json", "data.bin"] {
        let folder = tempfile::tempdir().expect("a folder");
        for file in ["frame.json", "data.bin"] {
            fs::copy(recording("own").join(file), folder.path().join(file)).expect("copied");
        }
        fs::remove_file(folder.path().join(name)).expect("removed");
        let made = std::process::Command::new("mkfifo").arg(folder.path().join(name)).status().expect("mkfifo");
        assert!(made.success());
        let error = import::read(folder.path()).expect_err("a pipe").to_string();
        assert!(error.contains(&format!("{name}: is a pipe: only plain files are read")), "{error}");
    }
}

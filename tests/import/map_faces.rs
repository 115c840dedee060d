//! A light's map in one layer, in an atlas, and in textures of its own: a recording's, arranged anew.

use super::shared::recording;
use std::sync::Arc;
use stencilscope::capture::{Image, PixelFormat};
use stencilscope::glam::DVec4;
use stencilscope::import::{ConvertedFrame, RawContents, RawEvent, RawFrame, RawKind, RawTarget, convert, read};
use stencilscope::plan::LightId;

/// The recording, and the index of its map's texture.
fn recorded() -> (RawFrame, usize) {
    let frame = read(&recording("pygfx")).expect("a recording");
    let is_map = |event: &&RawEvent| matches!(event.kind, RawKind::Draw(_)) && event.color_targets.is_empty();
    let map = frame.events.iter().find(is_map).and_then(|event| event.depth_target).expect("a map");
    (frame, map.texture)
}

/// The events that change the map, or draw into it.
fn of_map(frame: &RawFrame, map: usize) -> Vec<RawEvent> {
    let is_of_map = |event: &&RawEvent| event.depth_target.is_some_and(|target| target.texture == map);
    frame.events.iter().filter(is_of_map).cloned().collect()
}

/// Two depth images of one size side by side.
fn side_by_side(left: &Image, right: &Image) -> Arc<Image> {
    let [columns, rows] = left.size();
    let bytes: Vec<u8> = left.rows().zip(right.rows()).flat_map(|(left, right)| [left, right].concat()).collect();
    Arc::new(Image::packed(PixelFormat::Depth32F, [2 * columns, rows], bytes))
}

/// Makes the map the right half of a texture of twice its width, whose left half holds the same from a light that stands
/// elsewhere where `is_moved`: each corner is moved in clip space.
fn in_atlas(is_moved: bool) -> RawFrame {
    let (mut frame, map) = recorded();
    let [columns, rows] = frame.textures[map].size;
    let clear = Image::uniform(PixelFormat::Depth32F, [columns, rows], &1.0_f32.to_le_bytes());
    let events = of_map(&frame, map);
    let mut last = Arc::new(clear.clone());
    for event in frame.events.iter_mut().filter(|event| event.depth_target.is_some_and(|at| at.texture == map)) {
        if let RawKind::Draw(draw) = &mut event.kind {
            draw.view.viewport[0] += columns as f32;
            draw.view.scissor =
                draw.view.scissor.map(|[left, top, width, height]| [left + columns as i32, top, width, height]);
        }
        if let Some(depth) = event.after.depth.take() {
            event.after.depth = Some(side_by_side(&clear, &depth));
            last = depth;
        }
    }
    let after_map = frame.events.iter().rposition(|event| event.depth_target.is_some_and(|at| at.texture == map));
    let mut again = events;
    again.retain(|event| matches!(event.kind, RawKind::Draw(_)));
    for event in &mut again {
        event.id += 100_000;
        event.after.depth = event.after.depth.take().map(|depth| side_by_side(&depth, &last));
        let RawKind::Draw(draw) = &mut event.kind else { unreachable!("a draw") };
        for corner in draw.positions.iter_mut().filter(|_| is_moved) {
            // Sheared, so that the light stands in another direction.
            corner[0] += 0.4 * corner[2];
        }
    }
    let at = after_map.expect("events of the map") + 1;
    frame.events.splice(at..at, again);
    frame.before.retain(|(target, _)| target.texture != map);
    frame.textures[map].size = [2 * columns, rows];
    frame
}

/// Adds a second texture that is drawn as the map is, and sampled with it.
fn in_two_textures() -> RawFrame {
    let (mut frame, map) = recorded();
    let second = frame.textures.len();
    frame.textures.push(frame.textures[map].clone());
    let mut again = of_map(&frame, map);
    for event in &mut again {
        event.id += 100_000;
        event.depth_target = event.depth_target.map(|target| RawTarget { texture: second, ..target });
    }
    let at = frame.events.iter().rposition(|event| event.depth_target.is_some_and(|at| at.texture == map));
    let at = at.expect("events of the map") + 1;
    for event in &mut frame.events[at..] {
        if let RawKind::Draw(draw) = &mut event.kind
            && let Some(sampled) = draw.sampled.as_mut().filter(|sampled| sampled.contains(&map))
        {
            sampled.push(second);
        }
    }
    frame.events.splice(at..at, again);
    let before = frame.before.iter().filter(|(target, _)| target.texture == map);
    let before: Vec<(RawTarget, RawContents)> =
        before.map(|(target, contents)| (RawTarget { texture: second, ..*target }, contents.clone())).collect();
    frame.before.extend(before);
    frame
}

fn converted(frame: &RawFrame) -> ConvertedFrame {
    convert(frame, "pygfx").expect("a frame")
}

fn light_of(converted: &ConvertedFrame) -> DVec4 {
    converted.lights[0].expect("a light").position
}

#[test]
fn viewports_of_an_atlas_and_textures_that_one_light_draws_are_faces_of_its_map() {
    let alone = converted(&recorded().0);
    let stored = &alone.capture.lights[0].map.as_ref().expect("a map").faces[0];
    for (name, frame) in [("atlas", in_atlas(false)), ("textures", in_two_textures())] {
        let found = converted(&frame);
        assert_eq!(found.lights.len(), 1, "{name}: {:?}", found.lights);
        assert!(light_of(&found).distance(light_of(&alone)) < 1e-9, "{name}: {:?}", found.lights);
        let map = found.capture.lights[0].map.as_ref().expect("a map");
        assert_eq!(map.faces.len(), 2, "{name}");
        assert!(map.faces.iter().all(|face| face == stored), "{name}: each face holds what the map alone does");
        assert_eq!(found.capture.lights[0].shadow, alone.capture.lights[0].shadow, "{name}");
        let attachment = found.plan.attachment(found.plan.lights[0].map.as_ref().expect("a map").attachment);
        assert_eq!((attachment.layers, attachment.size), (2, stored.size()), "{name}");
    }
}

#[test]
fn viewports_of_an_atlas_that_two_lights_draw_are_two_maps() {
    let found = converted(&in_atlas(true));
    let [Some(one), Some(other)] = found.lights[..] else { panic!("{:?}", found.lights) };
    let angle = one.position.truncate().angle_between(other.position.truncate()).to_degrees();
    assert!(angle > 5.0 && one.position.w == 0.0 && other.position.w == 0.0, "{angle}: {:?}", found.lights);
    for light in &found.capture.lights {
        assert_eq!(light.map.as_ref().expect("a map").faces.len(), 1);
    }
    assert_eq!(found.scene.expect("a scene").lights.len(), 2);
}

#[test]
fn draws_say_which_maps_they_sample() {
    let found = converted(&recorded().0);
    let is_lit = |draw: &&stencilscope::plan::Draw| draw.samples_maps_of == [LightId(0)];
    let of = |is_of_picture: bool| {
        let passes = found.plan.passes.iter().filter(move |pass| (pass.name != "map") == is_of_picture);
        passes.flat_map(|pass| &pass.draws).filter(is_lit).count()
    };
    assert!(of(true) >= 3 && of(false) == 0, "{}", found.plan);
    assert!(found.plan.to_string().contains("samples the map of light 1"), "{}", found.plan);
}

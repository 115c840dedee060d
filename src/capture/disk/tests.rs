//! Capture folders of a hand-made capture: padded rows, shared aspects, a cube, a sun; no GPU.

use super::*;
use crate::accuracy::{ErrorCounts, Finding, VisibilityError, WrongRegion};
use crate::capture::{
    AdapterInfo, Aspect, Capture, CapturedLight, CapturedMap, CapturedTruth, DrawSummary, FrameSnapshot, Image,
    PixelFormat, Snapshot, Step, StoredQuantity, Timing, VisibilityTruth,
};
use crate::files::brought::{InMemory, main_file};
use crate::math::depth::DepthMapping;
use crate::plan::{CountedSide, DecidedBy, Decision, DrawPart, LeftOut};
use crate::scene::{Camera, Object, Projection};
use glam::{DMat4, DVec3, DVec4};
use std::collections::BTreeMap;
use std::fs;
use std::sync::Arc;

const SIZE: [u32; 2] = [5, 3];

/// Rows padded to 32 bytes; the padding is `0xee`.
fn padded(format: PixelFormat, first: u8) -> Arc<Image> {
    let row_bytes = SIZE[0] as usize * format.texel_bytes();
    let mut bytes = vec![0xee; 32 * SIZE[1] as usize];
    for (y, row) in bytes.chunks_mut(32).enumerate() {
        row[..row_bytes].iter_mut().enumerate().for_each(|(x, byte)| *byte = first.wrapping_add((y * 40 + x) as u8));
    }
    Arc::new(Image::from_rows(format, SIZE, 32, bytes))
}

fn aspect(image: &Arc<Image>, unchanged: bool) -> Aspect {
    Aspect { image: Arc::clone(image), unchanged }
}

fn step(name: &str, light: Option<usize>, snapshot: Snapshot) -> Step {
    let draw = DrawSummary {
        name: "sides of bunny".into(),
        caster: Some("bunny".into()),
        part: DrawPart::Side,
        triangles: 7,
        after: None,
        differs: None,
    };
    Step {
        name: name.to_owned(),
        purpose: "To be seen.".to_owned(),
        light,
        draws: vec![draw.clone(), DrawSummary { caster: None, part: DrawPart::Surface, ..draw }],
        gpu_ms: light.map(|_| 0.1 + 0.2),
        snapshot,
    }
}

/// Passes of the picture and of a map, shared aspects, padded and uniform images, both kinds of light.
fn example() -> Capture {
    let color = padded(PixelFormat::Rgba8Srgb, 3);
    let depth = padded(PixelFormat::Depth32F, 9);
    let cleared = Arc::new(Image::uniform(PixelFormat::U8, SIZE, &[0]));
    let stencil = padded(PixelFormat::U8, 250);
    let frame = |stencil: Option<Aspect>, unchanged: bool, target: FrameTarget| {
        Snapshot::Frame(FrameSnapshot {
            color: aspect(&color, unchanged),
            depth: aspect(&depth, unchanged),
            stencil,
            target,
        })
    };
    let face = |value: f32| Arc::new(Image::uniform(PixelFormat::Depth32F, [4, 4], &value.to_le_bytes()));
    let cube = CapturedMap {
        faces: (0..6).map(|index| face(index as f32 / 7.0)).collect(),
        light_from_world: DMat4::from_translation(DVec3::new(0.1, -0.7, 1e-300)),
        layer_names: Vec::new(),
        clip_from_light: (0..6).map(|index| DMat4::from_rotation_x(f64::from(index) / 3.0)).collect(),
        quantity: StoredQuantity::Distance { squares: [1e-4, 2e-4, 1.0 / 3.0], residual: 1e-7 },
    };
    let textures = CapturedMap {
        faces: (0..3).map(|index| Arc::new(Image::uniform(PixelFormat::Rgba8, [4, 4], &[index, 20, 30, 40]))).collect(),
        light_from_world: DMat4::IDENTITY,
        layer_names: vec!["floor".to_owned(), "wall".to_owned(), "box".to_owned()],
        clip_from_light: (0..3).map(|index| DMat4::from_rotation_y(f64::from(index))).collect(),
        quantity: StoredQuantity::Depth,
    };
    let decided_by = DecidedBy::StencilCount { side: CountedSide::Behind };
    let unlit = |position: DVec4, map| CapturedLight {
        position,
        of_casters: BTreeMap::new(),
        decided_by,
        count_of: None,
        shadow: None,
        count: None,
        visibility: None,
        map,
        truth: None,
    };
    let lit = |position: DVec4, map| CapturedLight { shadow: Some(padded(PixelFormat::U8, 1)), ..unlit(position, map) };
    let truth = CapturedTruth {
        labels: padded(PixelFormat::U8, 0),
        findings: padded(PixelFormat::U8, 2),
        error: ErrorCounts { compared: 11, false_shadow: 1, missing_shadow: 2, wrong_surface: 3, edge_band: 4 },
        worst: Some(WrongRegion { pixels: 2, kind: Finding::MissingShadow, bounds: [1, 0, 4, 2], at: [1, 2] }),
        visibility: Some(VisibilityTruth {
            image: padded(PixelFormat::Value32F, 4),
            error: VisibilityError { compared: 11, darkened: 0.25, lightened: 0.125, partly_dark: 3, partly_lit: 2 },
        }),
    };
    Capture {
        scene: "bunny \"on\" a floor".into(),
        technique: "z-fail".into(),
        settings: [("faces".to_owned(), "two-sided".to_owned())].into(),
        size: SIZE,
        profile: None,
        adapter: AdapterInfo { name: "none".into(), driver: "by hand".into(), kind: "other".into() },
        depth: DepthMapping::StandardFinite.curve(0.1, 50.0, 0.0),
        camera: Camera { fov_y_degrees: 44.9, ..Camera::looking([0.1, 0.2, 1.0 / 3.0], [0.0; 3]) },
        steps: vec![
            step("ambient", None, frame(Some(aspect(&cleared, true)), false, FrameTarget::Picture)),
            step("light 0 map +x", Some(0), Snapshot::Map { light: 0, face: 3 }),
            step("volumes", Some(0), frame(Some(aspect(&stencil, false)), true, FrameTarget::Picture)),
            step("mask", Some(0), frame(Some(aspect(&stencil, true)), true, FrameTarget::Labels)),
            step("no stencil", Some(1), frame(None, true, FrameTarget::Picture)),
            step("texture 1", Some(2), Snapshot::Map { light: 2, face: 1 }),
            step("counts", Some(2), frame(None, true, FrameTarget::Count)),
            step("visibility", Some(0), frame(Some(aspect(&stencil, true)), true, FrameTarget::Visibility)),
        ],
        lights: vec![
            CapturedLight {
                truth: Some(truth),
                visibility: Some(padded(PixelFormat::Value32F, 5)),
                ..lit(DVec4::new(1.0, 2.0, 3.0, 1.0), Some(cube))
            },
            CapturedLight {
                of_casters: [("torus 2".to_owned(), DVec4::new(0.6, 0.8, 0.0, 0.0))].into(),
                ..lit(DVec4::new(0.0, 1.0, 0.0, 0.0), None)
            },
            CapturedLight {
                count: Some(padded(PixelFormat::Value32F, 7)),
                ..unlit(DVec4::new(0.5, 0.0, 0.0, 1.0), Some(textures))
            },
        ],
        left_out: vec![LeftOut::counted(Decision::Caps, 1, "torus 2", "outside the near-clip volume")],
        timing: Timing { frame_ms: Some(9.1), captured_ms: None, write_ms: None, setup_ms: Some(0.3) },
        plan_text: "pass ambient\n".into(),
        origin: None,
    }
}

/// The example's folder, and what it lies in.
fn written() -> (tempfile::TempDir, PathBuf) {
    let parent = tempfile::tempdir().expect("a folder");
    let folder = parent.path().join("out");
    write(&example(), &folder, false).expect("written");
    (parent, folder)
}

fn manifest(folder: &Path) -> serde_json::Value {
    serde_json::from_str(&fs::read_to_string(folder.join(MANIFEST)).expect("a manifest")).expect("JSON")
}

/// Names in a folder, sorted.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn what_is_written_is_read_back() {
    let parent = tempfile::tempdir().expect("a folder");
    let folder = parent.path().join("out");
    let written = example();
    write(&written, &folder, false).expect("written");
    let mut read_back = read(&folder).expect("read");
    assert!(read_back.timing.write_ms.is_some_and(|ms| ms >= 0.0));
    read_back.timing.write_ms = None;
    assert_eq!(read_back, written);
    assert_eq!(names(parent.path()), ["out"]);
}

/// The manifest of a perspective camera is what it was before there were other kinds.
#[test]
fn a_parallel_camera_is_read_back_and_a_folder_without_one_has_a_pinhole() {
    let parent = tempfile::tempdir().expect("a folder");
    let folder = parent.path().join("out");
    let oblique = Projection::Oblique { half_height: 1.0 / 3.0, angle_degrees: 30.0, factor: 0.5 };
    for projection in [Projection::Orthographic { half_height: 2.5 }, oblique] {
        let camera = Camera { projection, ..example().camera };
        let depth = DepthMapping::ReversedInfinite.linear_curve(0.05, 9.0);
        write(&Capture { camera, depth, ..example() }, &folder, true).expect("written");
        let found = read(&folder).expect("read");
        assert_eq!((found.camera, found.depth), (camera, depth));
    }
    assert_eq!(manifest(&folder)["camera"]["projection"]["kind"], "oblique");
    write(&example(), &folder, true).expect("written");
    let json = manifest(&folder);
    assert!(json["camera"].get("projection").is_none() && json["depth"].get("is_linear").is_none());
    assert_eq!(read(&folder).expect("read").camera, example().camera);
    let refused = reading_after(|text| text.replacen("\"up\"", "\"projection\": {\"kind\": \"fish-eye\"}, \"up\"", 1));
    assert!(refused.contains("fish-eye"), "{refused}");
}

#[test]
fn the_folder_is_laid_out_as_promised() {
    let (_parent, folder) = written();
    let expected = [
        "000-ambient.color.png",
        "000-ambient.depth.npy",
        "000-ambient.stencil.npy",
        "002-volumes.stencil.npy",
        "light0.error.npy",
        "light0.map.npy",
        "light0.shadow.npy",
        "light0.truth-visibility.npy",
        "light0.truth.npy",
        "light0.visibility.npy",
        "light1.shadow.npy",
        "light2.count.npy",
        "light2.textures.npy",
        MANIFEST,
        "plan.txt",
    ];
    assert_eq!(names(&folder), expected);
    let manifest = manifest(&folder);
    let passes = &manifest["passes"];
    assert_eq!(passes[0]["caster"], serde_json::Value::Null);
    assert_eq!(passes[0]["draws"], 2);
    assert_eq!(passes[0]["triangles"], 14);
    // Nothing was there to point to.
    assert_eq!(passes[0]["unchanged"], serde_json::json!(["stencil"]));
    assert_eq!(passes[1]["map"], "light0.map.npy");
    assert_eq!(passes[1]["map_face"], 3);
    assert!(passes[1].get("color").is_none());
    assert_eq!(passes[2]["color"], "000-ambient.color.png");
    assert_eq!(passes[2]["unchanged"], serde_json::json!(["color", "depth"]));
    assert_eq!(passes[3]["stencil"], "002-volumes.stencil.npy");
    assert_eq!(passes[3]["labels"], "light0.shadow.npy");
    assert!(passes[4].get("stencil").is_none());
    assert_eq!((&passes[5]["textures"], &passes[5]["texture_layer"]), (&"light2.textures.npy".into(), &1.into()));
    assert_eq!(passes[6]["count"], "light2.count.npy");
    assert_eq!(passes[7]["visibility"], "light0.visibility.npy");
    assert_eq!(manifest["lights"][1]["kind"], "directional");
    assert_eq!(manifest["lights"][1]["towards"], serde_json::json!([0.0, 1.0, 0.0]));
    assert_eq!(manifest["lights"][0]["matrices"]["light_from_world"][0][3], 0.1);
    let light = &manifest["lights"][0];
    assert_eq!((&light["truth"], &light["error_picture"]), (&"light0.truth.npy".into(), &"light0.error.npy".into()));
    let error = serde_json::json!(
        {"compared": 11, "false_shadow": 1, "missing_shadow": 2, "wrong_surface": 3, "edge_band": 4}
    );
    assert_eq!(light["error"], error);
    let visibilities = ["light0.visibility.npy", "light0.truth-visibility.npy"];
    assert_eq!([&light["visibility"], &light["truth_visibility"]], visibilities);
    let error = serde_json::json!(
        {"compared": 11, "darkened": 0.25, "lightened": 0.125, "partly_dark": 3, "partly_lit": 2}
    );
    assert_eq!(light["visibility_error"], error);
    assert_eq!(light["worst_region"]["box"], serde_json::json!([1, 0, 4, 2]));
    assert!(manifest["lights"][1].get("error").is_none() && manifest["lights"][1].get("truth").is_none());
    assert!(manifest["lights"][2].get("shadow").is_none());
    assert_eq!(manifest["camera"]["far"], serde_json::Value::Null);
}

#[test]
fn arrays_are_what_numpy_expects() {
    let (_parent, folder) = written();
    let bytes = fs::read(folder.join("002-volumes.stencil.npy")).expect("an array");
    let header = String::from_utf8_lossy(&bytes[..128]).into_owned();
    assert!(bytes.starts_with(b"\x93NUMPY") && header.contains("'|u1'") && header.contains("(3, 5"), "{header}");
    // Rows follow each other without the padding.
    let row = |y: u8| (0..5).map(move |x| 250u8.wrapping_add(y * 40 + x));
    assert_eq!(bytes[bytes.len() - 15..], (0..3).flat_map(row).collect::<Vec<u8>>());
    let map = fs::read(folder.join("light0.map.npy")).expect("an array");
    let header = String::from_utf8_lossy(&map[..128]).into_owned();
    assert!(header.contains("'<f4'") && header.contains("(6, 4, 4"), "{header}");
}

#[test]
fn a_folder_in_the_way_is_left_alone() {
    for nameless in [".", "..", "/"] {
        assert!(matches!(check_target(Path::new(nameless), true), Err(CaptureError::InTheWay { .. })), "{nameless}");
    }
    let parent = tempfile::tempdir().expect("a folder");
    let folder = parent.path().join("out");
    fs::create_dir(&folder).expect("made");
    fs::write(folder.join("precious"), "data").expect("written");
    for overwrite in [false, true] {
        let error = write(&example(), &folder, overwrite).expect_err("in the way");
        assert!(matches!(error, CaptureError::InTheWay { .. }), "{error}");
    }
    assert_eq!(names(&folder), ["precious"]);
    assert_eq!(names(parent.path()), ["out"]);
    let file = folder.join("precious");
    assert!(matches!(write(&example(), &file, true), Err(CaptureError::InTheWay { .. })));
}

#[test]
fn a_capture_is_replaced_only_on_request() {
    let (parent, folder) = written();
    let other = Capture { scene: "other".into(), ..example() };
    assert!(matches!(write(&other, &folder, false), Err(CaptureError::Exists { .. })));
    assert_eq!(manifest(&folder)["scene"], "bunny \"on\" a floor");
    write(&other, &folder, true).expect("replaced");
    assert_eq!(manifest(&folder)["scene"], "other");
    assert_eq!(names(parent.path()), ["out"]);
}

#[test]
fn a_failure_leaves_nothing_and_keeps_the_old_capture() {
    let (parent, folder) = written();
    let mut broken = example();
    // A map without faces can't be written.
    broken.lights[0].map.as_mut().expect("a map").faces.clear();
    assert!(matches!(write(&broken, &folder, true), Err(CaptureError::Write { .. })));
    assert_eq!(names(parent.path()), ["out"]);
    assert_eq!(read(&folder).expect("the old one").scene, example().scene);
    let fresh = parent.path().join("fresh");
    assert!(write(&broken, &fresh, false).is_err());
    assert_eq!(names(parent.path()), ["out"]);
}

#[test]
fn a_link_to_a_capture_is_followed() {
    let (parent, folder) = written();
    #[cfg(unix)]
    {
        let link = parent.path().join("link");
        std::os::unix::fs::symlink(&folder, &link).expect("a link");
        write(&Capture { scene: "other".into(), ..example() }, &link, true).expect("replaced");
        assert!(link.is_symlink());
        assert_eq!(manifest(&folder)["scene"], "other");
        assert_eq!(names(parent.path()), ["link", "out"]);
    }
}

/// Returns the result of reading the example after `change` to the manifest's text.
fn reading_after(change: impl Fn(&str) -> String) -> String {
    let (_parent, folder) = written();
    let path = folder.join(MANIFEST);
    let text = fs::read_to_string(&path).expect("a manifest");
    let changed = change(&text);
    assert_ne!(changed, text, "nothing was changed");
    fs::write(&path, changed).expect("written");
    let error = read(&folder).expect_err("broken").to_string();
    assert!(!error.contains('\n'), "{error}");
    error
}

#[test]
fn broken_folders_are_refused_with_a_reason() {
    let replaced = |from: &'static str, to: &'static str| reading_after(move |text| text.replacen(from, to, 1));
    assert!(replaced("\"schema\": 2", "\"schema\": 3").contains("schema is 3"));
    assert!(replaced("000-ambient.depth.npy", "../secret.npy").contains("outside its folder"));
    assert!(replaced("000-ambient.depth.npy", "missing.npy").contains("missing.npy"));
    assert!(replaced("000-ambient.depth.npy", "000-ambient.stencil.npy").contains("stencil.npy"));
    assert!(replaced("000-ambient.depth.npy", "light1.shadow.npy").contains("light1.shadow.npy"));
    assert!(replaced("000-ambient.color.png", "000-ambient.depth.npy").contains("capture the scene again"));
    assert!(replaced("  \"size\": [\n    5,", "  \"size\": [\n    6,").contains("size is not"));
    assert!(replaced("  \"size\": [\n    5,", "  \"size\": [\n    4000000000,").contains("4000000000x3"));
    assert!(replaced("\"part\": \"side\"", "\"part\": \"inside\"").contains("part of a draw"));
    assert!(replaced("\"map_face\": 3", "\"map_face\": 99").contains("not there"));
    assert!(replaced("\"kind\": \"missing_shadow\"", "\"kind\": \"agrees\"").contains("worst region"));
    assert!(replaced("\"box\": [\n          1", "\"box\": [\n          9").contains("worst region"));
    assert!(replaced("light0.truth.npy", "000-ambient.depth.npy").contains("capture the scene again"));
    assert!(replaced("\"near\": ", "\"near\": -").contains("camera"));
    assert!(replaced("\"mapping\": ", "\"bits\": 40, \"mapping\": ").contains("depths of 40 bits"));
    assert!(replaced("\"torus 2\": [\n          0.6", "\"torus 2\": [\n          null").contains(MANIFEST));
    assert!(
        replaced("0.6,\n          0.8,\n          0.0,\n          0.0", "0.0,\n0.0,\n0.0,\n0.0")
            .contains("no place for a caster")
    );
    assert!(replaced("{", "").contains(MANIFEST));
    let parent = tempfile::tempdir().expect("a folder");
    assert!(matches!(read(parent.path()), Err(CaptureError::Read { .. })));
}

#[test]
fn a_cut_array_is_refused() {
    let (_parent, folder) = written();
    for name in ["000-ambient.depth.npy", "light0.map.npy", "000-ambient.color.png"] {
        let path = folder.join(name);
        let whole = fs::read(&path).expect("a file");
        for length in [0, 7, whole.len() / 2, whole.len() - 1] {
            fs::write(&path, &whole[..length]).expect("written");
            // The last byte of a PNG is the end chunk's checksum, which readers may pass over.
            if !(name.ends_with(".png") && length + 1 == whole.len()) {
                assert!(matches!(read(&folder), Err(CaptureError::Read { .. })), "{name} cut to {length}");
            }
        }
        fs::write(&path, &whole).expect("written");
    }
    read(&folder).expect("whole again");
}

#[test]
fn what_decides_a_light_is_written_and_derived_where_a_folder_does_not_say() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("capture");
    write(&example(), &path, false).expect("written");
    let mut json = manifest(&path);
    assert_eq!(json["lights"][0]["decided_by"], serde_json::json!({"kind": "stencil-count", "side": "behind"}));
    let left_out = serde_json::json!({
        "decision": "caps", "what": "caps", "of": "torus 2", "count": 1, "because": "outside the near-clip volume"
    });
    assert_eq!(json["left_out"][0], left_out);
    json["technique"] = "auto".into();
    for light in json["lights"].as_array_mut().expect("lights") {
        light.as_object_mut().expect("a light").remove("decided_by");
    }
    json["left_out"][0]["decision"] = "unheard-of".into();
    fs::write(path.join(MANIFEST), json.to_string()).expect("written");
    let older = read(&path).expect("read");
    let side = CountedSide::AsNeeded;
    assert_eq!(older.lights[0].decided_by, DecidedBy::StencilCount { side });
    assert_eq!(older.lights[2].decided_by, DecidedBy::FloatCount { side });
    assert_eq!((older.left_out[0].decision, older.left_out[0].count), (None, Some(1)));
}

/// A capture with a scene and the model beside it, in a folder and at the root.
#[test]
fn a_folder_in_memory_is_read_as_one_on_disk() {
    let (parent, _) = written();
    let folder = parent.path().join("whole");
    let scene = scene::open(&scene::OpenSpec::new("assets/scenes/pattern.toml")).expect("a scene");
    let mut capture = example();
    let write = |capture: &Capture| {
        write(FolderContents { capture, plan: None, scene: Some(&scene) }, &folder, true).expect("written");
        read_whole(&folder)
    };
    let refused = write(&capture).expect_err("a place for an object that is not there").to_string();
    assert!(refused.contains("a light has a place for `torus 2`, which the scene has not"), "{refused}");
    let mut crowd = scene.clone();
    crowd.objects =
        (0..1025).map(|index| Object { name: format!("caster {index}"), ..scene.objects[0].clone() }).collect();
    let place = |(index, object): (usize, &Object)| (object.name.clone(), DVec4::new(index as f64, 1.0, 0.0, 0.0));
    capture.lights[1].of_casters = crowd.objects.iter().enumerate().map(place).collect();
    let contents = FolderContents { capture: &capture, plan: None, scene: Some(&crowd) };
    super::write(contents, &folder, true).expect("written");
    let refused = read_whole(&folder).expect_err("too many places").to_string();
    assert!(refused.contains("a light is in 1025 places, of 1024"), "{refused}");
    let own = DVec4::new(0.6, 0.8, 0.0, 0.0);
    capture.lights[1].of_casters = [(scene.objects[0].name.clone(), own)].into();
    let on_disk = write(&capture).expect("read");
    let positions = |scene: &Scene| scene.objects[0].light_positions.clone();
    assert_eq!(on_disk.scene.as_ref().map(positions), Some([(1, own)].into()));
    let files: Vec<(String, Vec<u8>)> =
        names(&folder).into_iter().map(|name| (name.clone(), fs::read(folder.join(name)).expect("a file"))).collect();
    for (place, opened) in [("out/", "out"), ("", ".")] {
        let files: Vec<(String, &[u8])> =
            files.iter().map(|(name, bytes)| (format!("{place}{name}"), &bytes[..])).collect();
        let files: Vec<(&str, &[u8])> = files.iter().map(|(name, bytes)| (name.as_str(), *bytes)).collect();
        assert_eq!(main_file(files.iter().map(|(name, _)| *name)), Ok(opened.to_owned()));
        let _files = InMemory::with(&files);
        assert!(crate::files::is_folder(Path::new(opened)) && is_capture(Path::new(opened)));
        let in_memory = read_whole(Path::new(opened)).expect("read");
        assert_eq!((in_memory.capture, in_memory.scene), (on_disk.capture.clone(), on_disk.scene.clone()));
    }
    assert!(on_disk.scene.is_some());
}

//! The shadow map tab: texels and the pixels that read them, each way.

use super::*;
use egui::accesskit::Toggled;
use glam::DMat4;
use stencilscope::capture::{CapturedMap, StoredQuantity};
use stencilscope::math::projection::orthographic;
use stencilscope::plan::DecidedBy;

/// A map of 4 × 4 texels that looks the way the camera looks, over a wall at distance 1 that fills the
/// picture: 0.83 m high and 1.1 m wide. The map is 0.8 m each way, so a texel is 0.2 m wide.
fn capture() -> Capture {
    let mut capture = z_fail(SIZE);
    let wall = Arc::new(Image::uniform(PixelFormat::Depth32F, SIZE, &0.1_f32.to_le_bytes()));
    for step in &mut capture.steps {
        if let stencilscope::capture::Snapshot::Frame(frame) = &mut step.snapshot {
            frame.depth.image = wall.clone();
        }
    }
    capture.settings.insert("bias-slope".to_owned(), "2".to_owned());
    capture.lights[0].map = Some(CapturedMap {
        layer_names: Vec::new(),
        faces: vec![Arc::new(Image::uniform(PixelFormat::Depth32F, [4, 4], &0.5_f32.to_le_bytes()))],
        light_from_world: DMat4::from_translation(DVec3::NEG_Z),
        clip_from_light: vec![orthographic([0.4, 0.4], 0.0, 2.0, true)],
        quantity: StoredQuantity::Depth,
    });
    capture
}

/// Pixels whose middle, on the wall, lies in a column and row of the map.
fn expected(texel: [i32; 2]) -> usize {
    let up = 22.5_f64.to_radians().tan();
    let place =
        |at: u32, side: u32, half: f64| ((2.0 * (f64::from(at) + 0.5) / f64::from(side) - 1.0) * half + 0.4) / 0.2;
    let of = |[x, y]: [u32; 2]| {
        let column = place(x, SIZE[0], up * f64::from(SIZE[0]) / f64::from(SIZE[1])).floor() as i32;
        [column, place(y, SIZE[1], up).floor() as i32]
    };
    common::pixels(SIZE).filter(|at| of(*at) == texel).count()
}

/// Where there is no map, a press draws one.
#[test]
fn without_a_map_the_tab_offers_the_technique_that_has_one() {
    let mut harness = harness(z_fail(SIZE));
    show_tab(&mut harness, "Shadow map");
    harness.get_by_label("This frame has no shadow map.");
    click_button(&mut harness, "Draw it with shadow-map");
    assert_eq!(last_run(&harness).choice.technique(), Technique::ShadowMap);
    let mut folder = of_folder();
    show_tab(&mut folder, "Shadow map");
    assert!(folder.query_by_label("Draw it with shadow-map").is_none(), "it can't be run");
}

#[test]
fn pointing_at_a_texel_counts_the_pixels_that_read_it() {
    let mut harness = harness(capture());
    show_tab(&mut harness, "Shadow map");
    harness.run_steps(2);
    let canvas = harness.get_by_label("Shadow map canvas").rect();
    let side = canvas.width().min(canvas.height()) / 4.0;
    let at = canvas.center() + vec2(-0.5, -1.5) * side;
    harness.hover_at(at);
    harness.run_steps(3);
    harness.get_by_label("Texel 1, 0");
    let pixels = expected([1, 0]);
    assert!(pixels > 20);
    harness.get_by_label(&format!("{pixels} pixels read it."));
    harness.get_by_label("0.2000 m");
    harness.get_by_label_contains("0.4000 m at 45°");
}

#[test]
fn a_picked_pixel_marks_its_texel_and_a_picked_texel_its_pixels() {
    let mut harness = picked(capture(), [20, 15]);
    show_tab(&mut harness, "Shadow map");
    harness.run_steps(2);
    harness.get_by_label("Texel 2, 2");
    let canvas = harness.get_by_label("Shadow map canvas").rect();
    let side = canvas.width().min(canvas.height()) / 4.0;
    mouse(&mut harness, canvas.center() + vec2(1.5, 1.5) * side, PointerButton::Secondary);
    harness.get_by_label("Texel 3, 3");
    let small = harness.get_by_label("Small picture").rect();
    mouse(&mut harness, small.center() - vec2(3.0, 3.0), PointerButton::Primary);
    assert_eq!(harness.state().inspector.model.selection.pick, Some([19, 14]));
    harness.get_by_label("Texel 1, 1");
}

#[test]
fn what_a_pixel_covers_of_the_map_is_reported() {
    let mut harness = picked(capture(), [20, 15]);
    show_tab(&mut harness, "Shadow map");
    harness.run_steps(2);
    // A pixel is a square of the wall.
    let side = 2.0 * 22.5_f64.to_radians().tan() / f64::from(SIZE[1]) / 0.2;
    harness.get_by_label(&format!("{side:.2} × {side:.2} texels"));
    harness.get_by_label("pixel's depth");
}

/// Over real frames: where the technique's own lookup says "shadow", the texel that was found holds something
/// nearer than the depth that was found for it. Large biases along the normal carry points over several texels.
#[test]
fn the_texel_that_is_found_explains_the_mask_of_a_real_frame() {
    let mut session = common::session();
    let gallery = pictures::Gallery::open();
    let (mut unlike, mut cubes) = (0, 0);
    for (name, settings, least) in [
        ("tori", &[][..], 0.998),
        ("tori", &[("bias-normal", "12"), ("size", "128"), ("bias-slope", "0")][..], 0.998),
        ("two-lights", &[("bias-normal", "6"), ("size", "256")][..], 0.998),
    ] {
        let request = common::request_with(Technique::ShadowMap, settings, [160, 90]);
        let frame = common::frame(&mut session, name, request);
        // As run, and as read from a folder, which has no normals.
        for (is_run, least) in [(true, least), (false, 0.98)] {
            let mut inspector = pictures::inspector(&frame, [80, 45]);
            if is_run {
                inspector.set_plan(frame.plan.clone());
            }
            let mut harness = harness_of(inspector);
            show_tab(&mut harness, "Shadow map");
            // The face that the picked pixel reads is shown, though that is found out later.
            let (face, _) = harness.state().inspector.map_texel_of([80, 45]).expect("a texel");
            let names = ["+x", "−x", "+y", "−y", "+z", "−z"];
            let is_shown = |harness: &Harness<Seen>, face: usize| {
                let button = harness.query_by_role_and_label(Role::Button, names[face]);
                button.is_none_or(|button| button.accesskit_node().toggled() == Some(Toggled::True))
            };
            assert!(is_shown(&harness, face), "{name}: face {face}");
            let read =
                |at: &[u32; 2]| harness.state().inspector.map_texel_of(*at).is_some_and(|(other, _)| other != face);
            let other = common::pixels([160, 90]).find(read);
            let faces = frame.capture.lights[0].map.as_ref().expect("a map").faces.len();
            assert_eq!(other.is_some(), faces > 1, "{name}: pixels read more than one of {faces} faces");
            cubes += usize::from(faces > 1);
            if let Some(other) = other {
                // A face that the user chooses stays, until another pixel is picked.
                let chosen = (face + 1) % names.len();
                click_button(&mut harness, names[chosen]);
                assert!(is_shown(&harness, chosen));
                change(&mut harness, |inspector| inspector.model.selection.pick = Some(other));
                let (face, _) = harness.state().inspector.map_texel_of(other).expect("a texel");
                assert!(is_shown(&harness, face), "{name}: {other:?} reads face {face}");
                change(&mut harness, |inspector| inspector.model.selection.pick = Some([80, 45]));
            }
            let (agree, all, moved) = agreement(&harness, &frame.capture);
            println!("{name}, {settings:?}, run: {is_run}: {agree} of {all} agree, {moved} read another texel");
            assert!(all > 1_000 && f64::from(agree) >= least * f64::from(all), "{name}: {agree} of {all}");
            unlike += if is_run { moved } else { 0 };
            click_button(&mut harness, "Show the picked pixel's texel");
            gallery.draw(&mut harness, &format!("shadow-map-{name}-{}-{is_run}", settings.len()), [1264, 784]);
        }
    }
    assert!(unlike > 500, "the bias moves what is read: {unlike}");
    assert!(cubes > 0, "the face of another pixel is looked for in no frame");
}

/// Links come later than the frame: the map is there meanwhile, and those of a frame that was shown before are
/// dropped.
#[test]
fn the_map_is_shown_while_its_links_are_waited_for() {
    let mut harness = harness(capture());
    harness.state_mut().asked = Some(Vec::new());
    show_tab(&mut harness, "Shadow map");
    let waiting = "Finding which texel each pixel reads…";
    harness.get_by_label(waiting);
    harness.get_by_label("Shadow map canvas");
    let asked = |harness: &Harness<Seen>| harness.state().asked.clone().expect("held back");
    assert_eq!(asked(&harness).len(), 1);
    show_capture(&mut harness, capture());
    let [old, new] = &asked(&harness)[..] else { panic!("asked once for each frame") };
    let result = found(&harness.state().inspector, old);
    change(&mut harness, |inspector| inspector.answer(old.ticket, result, true));
    harness.get_by_label(waiting);
    assert!(harness.state().inspector.map_texel_of([4, 4]).is_none());
    let result = found(&harness.state().inspector, new);
    change(&mut harness, |inspector| inspector.answer(new.ticket, result, true));
    assert!(harness.query_by_label(waiting).is_none());
    assert_eq!(asked(&harness).len(), 2, "nothing is asked twice");
}

/// The times of a machine that others use too are no ground to fail: they are printed, and linking must not take
/// seconds.
#[test]
fn a_large_picture_is_linked_with_its_map_soon() {
    let mut session = common::session();
    for bias in ["0", "1.5"] {
        let request = common::request_with(Technique::ShadowMap, &[("bias-normal", bias)], [1280, 720]);
        let frame = common::frame(&mut session, "tori", request);
        let mut inspector = pictures::inspector(&frame, [640, 360]);
        inspector.set_plan(frame.plan);
        let mut harness = harness_of(inspector);
        let start = std::time::Instant::now();
        show_tab(&mut harness, "Shadow map");
        let took = start.elapsed();
        println!("bias-normal {bias}: the tab over 1280x720 pixels opens in {took:?}");
        assert!(harness.state().inspector.map_texel_of([640, 360]).is_some() && took.as_secs_f64() < 3.0, "{took:?}");
    }
}

/// Of the pixels that are lit or in shadow of the first light: how many their texels explain, how many there are,
/// and how many read another texel than the one where their surface itself lies.
fn agreement(harness: &Harness<Seen>, capture: &Capture) -> (u32, u32, u32) {
    let map = capture.lights[0].map.clone().expect("a map");
    let mask = capture.lights[0].shadow.clone().expect("a mask");
    let (mut agree, mut all, mut moved) = (0, 0, 0);
    for [x, y] in common::pixels([160, 90]) {
        let inspector = &harness.state().inspector;
        let Some(texel) = inspector.map_texel_of([x, y]) else { continue };
        let stored = map.faces[texel.0].depth_at(texel.1).expect("a texel");
        let Some(label @ (0 | 1)) = mask.byte_at([x, y]) else { continue };
        let depth = inspector.map_depth_of([x, y]).expect("a depth");
        let is_dark = stored != 0.0 && f64::from(stored) > depth;
        all += 1;
        agree += u32::from(is_dark == (label == 1));
        let itself = texel_in_map(capture, texel.0, [x, y]);
        moved += u32::from(itself.is_some_and(|itself| itself != texel.1));
    }
    (agree, all, moved)
}

/// The texel of a face of the first light's map where what is seen at a pixel lies.
fn texel_in_map(capture: &Capture, face: usize, [x, y]: [u32; 2]) -> Option<[u32; 2]> {
    let camera = &capture.camera;
    let stored = capture.frame_at(capture.steps.len() - 1)?.depth.image.depth_at([x, y])?;
    let distance = capture.depth.distance(stored)?;
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward) * (camera.fov_y_degrees.to_radians() / 2.0).tan();
    let [width, height] = capture.size.map(f64::from);
    let across = right * (camera.fov_y_degrees.to_radians() / 2.0).tan() * width / height;
    let [u, v] = [2.0 * (f64::from(x) + 0.5) / width - 1.0, 1.0 - 2.0 * (f64::from(y) + 0.5) / height];
    let world = camera.eye + (forward + across * u + up * v) * distance;
    let map = capture.lights[0].map.as_ref()?;
    let clip = map.clip_from_light[face] * map.light_from_world * world.extend(1.0);
    let [columns, rows] = map.faces[face].size().map(f64::from);
    Some([((clip.x / clip.w * 0.5 + 0.5) * columns) as u32, ((0.5 - clip.y / clip.w * 0.5) * rows) as u32])
}

/// The map by hand, of which the texel that the picked pixel reads holds something at 1.2 m from the light: the wall is
/// at 0.9 m or at 1.5 m of its range of 2 m.
fn decided(is_dark: bool) -> Harness<'static, Seen> {
    let mut capture = capture();
    capture.technique = "shadow-map".to_owned();
    capture.lights[0].decided_by = DecidedBy::Map;
    capture.settings.insert("depth".to_owned(), "reversed-infinite".to_owned());
    let label = u8::from(is_dark);
    capture.lights[0].shadow = Some(Arc::new(Image::uniform(PixelFormat::U8, SIZE, &[label])));
    let map = capture.lights[0].map.as_mut().expect("a map");
    map.faces = vec![Arc::new(Image::uniform(PixelFormat::Depth32F, [4, 4], &0.4_f32.to_le_bytes()))];
    // The wall is a metre before the camera, so that far from the near plane of the map or a half of that.
    let near = if is_dark { 0.5 } else { -0.5 };
    map.light_from_world = DMat4::from_translation(DVec3::new(0.0, 0.0, -1.0 - near));
    let mut inspector = inspector(capture);
    inspector.model.selection.pick = Some([20, 15]);
    harness_in(inspector, [1280.0, 1000.0])
}

#[test]
fn the_pixel_panel_names_the_texel_with_both_depths_and_what_follows() {
    let dark = decided(true);
    dark.get_by_label("Dark under light 1.");
    let why = "Texel 2, 2 holds a caster at a depth of 1.200 m along the map's axis, and this surface is at 1.500 m: the caster is nearer, so the \
               light pass adds nothing.";
    dark.get_by_label(why);
    for value in ["2, 2", "0.4 (1.200 m)", "0.25 (1.500 m)", "stored is nearer to the light: shadow"] {
        dark.get_by_label(value);
    }
    let lit = decided(false);
    lit.get_by_label_contains("nothing nearer is stored, so the light pass adds the light.");
    lit.get_by_label("stored is not nearer: lit");
}

#[test]
fn the_texel_is_one_click_away_from_the_pixel() {
    let mut harness = decided(true);
    click_button(&mut harness, "Show the texel in Shadow map");
    harness.run_steps(3);
    harness.get_by_label("Texel 2, 2");
    harness.get_by_label("pixel's depth");
}

#[test]
fn explain_has_the_comparison_with_its_numbers() {
    let mut harness = decided(true);
    show_tab(&mut harness, "Explain");
    harness.get_by_label_contains("lit where the map stores nothing nearer to the light");
    harness.get_by_label("pixel 20, 15 reads texel 2, 2");
    harness.get_by_label("stored 0.4 (1.200 m), this surface 0.25 (1.500 m): stored is nearer to the light: shadow");
}

//! An off-centre frustum and a depth range: no pixel is wrong for them where theory says so, and all where it says that.

use crate::commands::{assert_fails, folder, run, text};
use crate::common::{judged, judged_by, last_frame, opened, request, request_with, session, wrong};
use glam::{DMat4, DVec2, DVec3, DVec4};
use std::collections::BTreeSet;
use stencilscope::diagnosis::Cause;
use stencilscope::math::depth::DepthMapping;
use stencilscope::progress::Progress;
use stencilscope::reading::coordinates::{PixelCoordinates, TransformStep};
use stencilscope::scene::{Camera, Projection, Scene};
use stencilscope::session::InjectedFault;
use stencilscope::technique::Technique;

const SIZE: [u32; 2] = [96, 72];

/// Frustums that show a part of what the camera does, and more beside it: to the right and up, to the left and down, and
/// stretched, with the view's axis out of the picture.
fn off_center(camera: &Camera) -> [Projection; 3] {
    let Projection::Frustum { right, top, .. } = camera.to_frustum(4.0 / 3.0) else { panic!("a frustum") };
    [[-0.4, 1.8, -0.6, 1.5], [-2.0, 0.3, -1.4, 0.5], [0.1, 0.9, -0.9, 1.3]].map(|[left, to_right, bottom, up]| {
        Projection::Frustum { left: left * right, right: to_right * right, bottom: bottom * top, top: up * top }
    })
}

fn seen_by(scene: &Scene, projection: Projection) -> Scene {
    Scene { camera: Camera { projection, ..scene.camera }, ..scene.clone() }
}

fn matrix(rows: [[f64; 4]; 4]) -> DMat4 {
    DMat4::from_cols_array_2d(&rows).transpose()
}

/// With the eye in a shadow, too (`inside`), where z-pass is as wrong as ever, and z-pass-plus mends it.
#[test]
fn z_fail_and_auto_have_no_wrong_pixel_off_centre() {
    let mut session = session();
    let mut counted = Vec::new();
    for name in ["tori", "inside", "gate", "tetrahedron"] {
        let scene = opened(name);
        for projection in off_center(&scene.camera) {
            let scene = seen_by(&scene, projection);
            // Counts of 256 read as none in eight bits, which is no matter here.
            let z_fail = request_with(Technique::ZFail, &[("counter", "float")], SIZE);
            for request in [z_fail, request(Technique::Auto, SIZE)] {
                let capture = judged_by(&mut session, &scene, &request);
                assert_eq!(wrong(&capture), 0, "{name} {:?} {projection}", request.choice.technique());
            }
            if name == "inside" {
                let [z_pass, z_pass_plus] = [Technique::ZPass, Technique::ZPassPlus]
                    .map(|technique| wrong(&judged(&mut session, &scene, technique, SIZE)));
                counted.push([z_pass, z_pass_plus]);
            }
        }
    }
    assert!(counted.iter().any(|[z_pass, _]| *z_pass > 100), "{counted:?}");
    // Cracks where casters cross the near plane alone.
    assert!(counted.iter().all(|[_, z_pass_plus]| *z_pass_plus <= 20), "{counted:?}");
}

/// The picture of a frustum within a camera's is that part of the camera's: each pixel shows the same surface.
#[test]
fn an_off_centre_picture_is_a_part_of_the_whole() {
    let mut session = session();
    let scene = opened("tori");
    let [left, right, bottom, top] = scene.camera.to_frustum(4.0 / 3.0).edges().expect("edges");
    let middle = DVec2::new(left + right, bottom + top) / 2.0;
    assert!(middle.length() < 1e-15, "{middle}");
    // The upper right quarter, as large as the whole.
    let quarter = Projection::Frustum { left: 0.0, right, bottom: 0.0, top };
    let mut depths = |scene: &Scene, size: [u32; 2]| {
        let capture = session.capture(scene, &request(Technique::ZFail, size)).expect("a capture");
        last_frame(&capture).depth.image.clone()
    };
    let whole = depths(&scene, SIZE.map(|side| 2 * side));
    let part = depths(&seen_by(&scene, quarter), SIZE);
    let mut off = 0;
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            let [of_whole, of_part] = [whole.depth_at([x + SIZE[0], y]), part.depth_at([x, y])];
            let [of_whole, of_part] = [of_whole.expect("a depth"), of_part.expect("a depth")];
            off += u32::from((of_whole - of_part).abs() > 1e-4 * of_whole);
        }
    }
    assert!(off < 10, "{off} pixels show something else");
}

/// The point of a pixel is carried to its middle, with a depth range to the depth that is stored, in both conventions.
#[test]
fn points_go_through_a_frustum_and_a_depth_range_to_the_pixel_and_its_stored_depth() {
    let mut session = session();
    let mut points = 0;
    for (name, range) in [("tori", "0.25,0.75"), ("inside", "0,1"), ("gate", "0.5,1")] {
        let scene = opened(name);
        for (projection, mapping) in off_center(&scene.camera).into_iter().zip(DepthMapping::ALL) {
            let scene = seen_by(&scene, projection);
            let settings = [("depth", mapping.name()), ("depth-range", range)];
            let capture = session.capture(&scene, &request_with(Technique::None, &settings, SIZE)).expect("a capture");
            for pixel in [[10, 60], [48, 36], [90, 5], [70, 70]] {
                let place = PixelCoordinates::of(&capture, pixel);
                let Some(point) = place.point else { continue };
                points += 1;
                let what = format!("{name} {range} {mapping:?} {pixel:?}: {point:?}");
                let [x, y, depth] = point.window;
                let middle = pixel.map(|at| f64::from(at) + 0.5);
                assert!((x - middle[0]).abs() < 1e-6 && (y - middle[1]).abs() < 1e-6, "{what}");
                let stored = last_frame(&capture).depth.image.depth_at(pixel).expect("a depth");
                assert!((depth - f64::from(stored)).abs() < 1e-6, "{what}");
                let ends: Vec<f64> = range.split(',').map(|end| end.parse().expect("a depth")).collect();
                assert!((ends[0]..=ends[1]).contains(&depth), "{what}");
                let step = |steps: &[TransformStep], at: usize| matrix(steps[at].matrix);
                let eye = DVec3::from_array(point.eye).extend(1.0);
                let carried = |clip: DMat4, window: DMat4| {
                    let clip: DVec4 = clip * eye;
                    (window * (clip / clip.w)).truncate()
                };
                let ours = carried(step(&place.chain, 1), step(&place.chain, 2));
                let theirs = carried(step(&place.opengl, 0), step(&place.opengl, 1));
                assert!((ours - DVec3::from_array(point.window)).length() < 1e-9, "{what}");
                let from_below = DVec3::new(theirs.x, f64::from(SIZE[1]) - theirs.y, theirs.z);
                assert!((ours - from_below).length() < 1e-9, "{what}: {theirs}");
            }
        }
    }
    assert!(points > 15, "{points}");
}

/// Every depth is put between the ends, order stays, and so do the shadows: of every mapping, clamped ones too.
#[test]
fn a_depth_range_moves_depths_and_no_shadow() {
    let mut session = session();
    for (name, technique) in [("tori", Technique::ZFail), ("inside", Technique::Auto), ("tori", Technique::ShadowMap)] {
        let scene = opened(name);
        for mapping in DepthMapping::ALL {
            let of = |range: &str| request_with(technique, &[("depth", mapping.name()), ("depth-range", range)], SIZE);
            let [whole, ranged] = ["0,1", "0.25,0.75"].map(|range| judged_by(&mut session, &scene, &of(range)));
            let what = format!("{name} {technique:?} {mapping:?}");
            assert_eq!(wrong(&whole), wrong(&ranged), "{what}");
            let clear = mapping.clear_depth();
            let [before, after] = [&whole, &ranged].map(|capture| last_frame(capture).depth.image.clone());
            let mut seen = 0;
            for (x, y) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))) {
                let [one, other] = [&before, &after].map(|image| image.depth_at([x, y]).expect("a depth"));
                assert_eq!(one == clear, other == clear, "{what} at {x}, {y}: {one}, {other}");
                seen += u32::from(one != clear);
                assert!(
                    one == clear || (other - (0.25 + 0.5 * one)).abs() < 1e-5,
                    "{what}: {one} is stored as {other}"
                );
            }
            assert!(seen > 3000, "{what}: {seen}");
        }
    }
}

/// Of histories, too: what is replayed by the numbers is what the GPU stored.
#[test]
fn histories_agree_with_the_gpu_off_centre_and_in_a_depth_range() {
    let mut session = session();
    for (name, range, mapping) in [
        ("tori", "0.1,0.6", "reversed-infinite"),
        ("inside", "0.3,1", "standard-finite-clamp"),
        ("gate", "0,1", "standard-finite"),
    ] {
        let scene = opened(name);
        let scene = seen_by(&scene, off_center(&scene.camera)[0]);
        let request = request_with(Technique::ZFail, &[("depth-range", range), ("depth", mapping)], SIZE);
        let (capture, plan) = session.capture_with_plan(&scene, &request).expect("a capture");
        for pixel in [[5, 5], [30, 40], [48, 36], [60, 66], [91, 20], [77, 55]] {
            let history = session.history(&plan, &capture, pixel).expect("a history");
            assert!(history.agrees(), "{name} {range} {pixel:?}: {:?}", history.disagreements());
        }
    }
}

/// All depths are one number: z-pass counts nothing, and z-fail all of a volume's faces, which add to 0, so that both show
/// every shadow as lit; and why is found, and that the whole range mends it.
#[test]
fn with_an_empty_depth_range_counts_are_off_as_theory_says_and_why_is_found() {
    let mut session = session();
    let scene = opened("tori");
    for technique in [Technique::ZFail, Technique::ZPass] {
        let request = request_with(technique, &[("depth-range", "0.5,0.5")], SIZE);
        let capture = judged_by(&mut session, &scene, &request);
        let depths = &last_frame(&capture).depth.image;
        let all: BTreeSet<u32> = (0..SIZE[1])
            .flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]))
            .map(|at| depths.depth_at(at).expect("a depth").to_bits())
            .collect();
        assert_eq!(all, BTreeSet::from([0.5_f32.to_bits()]), "{technique:?}");
        let counts = crate::common::label_counts(&capture);
        assert_eq!(counts[1], 0, "{technique:?}: no pixel is in shadow: {counts:?}");
        assert!(wrong(&capture) > 500, "{technique:?}");
        let found = session.diagnose(&scene, &request, InjectedFault::None, &Progress::default()).expect("a diagnosis");
        let page = found.to_text(&[]);
        let (_, plan) = session.capture_with_plan(&scene, &request).expect("a capture");
        let history = session.history(&plan, &capture, [48, 36]).expect("a history");
        let told = history.story(&capture.depth);
        assert!(told.contains("a surface, how far away is not known: all depths are stored as 0.5"), "{told}");
        assert!(!told.contains("infinity") && !told.contains("no surface ("), "{told}");
        let place = PixelCoordinates::of(&capture, [48, 36]).text();
        assert!(place.contains("the point is not known") && place.contains("which has no inverse"), "{place}");
        let sought = Cause::DepthPrecision.name();
        assert!(page.contains(sought) && page.contains("depth-range=0,1"), "{technique:?}: {page}");
    }
}

#[test]
fn the_command_line_takes_both_and_refuses_what_can_not_be() {
    let work = folder();
    let of = |arguments: &[&str]| {
        let start = ["pixel", "tori", "--at", "40,30", "--size", "80x60", "--coordinates"];
        let output = run(work.path(), &[&start[..], arguments].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let about = of(&["--eye-spherical", "6,30,20"]);
    assert!(about.contains("r 6.0000, θ 30.00° from +Z towards +X, φ 20.00° above level"), "{about}");
    let above = of(&["--eye-spherical=6,0,90"]);
    assert!(above.contains("r 6.0000, θ ") && above.contains("φ 90.00° above level"), "{above}");
    let frustum = of(&["--frustum=-0.01,0.03,-0.02,0.01", "--set", "depth-range=0.25,0.75"]);
    assert!(frustum.contains("frustum on the near plane from −0.01 to 0.03 m across, −0.02 to 0.01 m up"), "{frustum}");
    assert!(frustum.contains("stored from 0.25 to 0.75"), "{frustum}");
    let start = ["pixel", "tori", "--at", "4,4"];
    for (arguments, words) in [
        (&["--eye", "1,2,3", "--eye-spherical", "6,30,20"][..], "given twice"),
        (&["--eye-spherical", "6,30,95"], "elevation φ"),
        (&["--eye-spherical", "6,30"], "R,THETA,PHI"),
        (&["--frustum", "1,0,0,1"], "left less than right"),
        (&["--frustum", "0,1,0"], "LEFT,RIGHT,BOTTOM,TOP"),
        (&["--frustum", "0,1,0,1", "--fov", "30"], "leave one out"),
        (&["--set", "depth-range=0.8,0.2"], "N not above F: WebGPU refuses"),
        (&["--set", "depth-range=0,1.5"], "two depths from 0 to 1"),
        (&["--set", "depth-range=0.5"], "two depths from 0 to 1"),
    ] {
        assert_fails(&[&start[..], arguments].concat(), 2, &[words]);
    }
}

/// The formulas that help states are those of the program: each entry of the frustum's matrix, of the viewport's, and of the
/// view by spherical coordinates.
#[test]
fn help_derives_each_matrix_of_the_camera() {
    let work = folder();
    let help = |key: &str| {
        let page = text(&run(work.path(), &["help", key]).stdout);
        page.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let clip = help("clip_from_eye");
    for words in
        ["similar triangles", "(2 n x + (r + l) z) / (r - l)", "(2 n y + (t + b) z) / (t - b)", "((f + n) z + 2 n f)"]
    {
        assert!(clip.contains(words), "{words}: {clip}");
    }
    let window = help("window_from_ndc");
    for words in ["x0 + (x + 1) w / 2", "n_w + (f_w - n_w) z", "(f_w + n_w) / 2 + z (f_w - n_w) / 2", "glDepthRange"] {
        assert!(window.contains(words), "{words}: {window}");
    }
    let eye = help("eye_from_world");
    assert!(eye.contains("gluLookAt") && eye.contains("help spherical-camera"), "{eye}");
    assert!(help("spherical-camera").contains("E = T + r (cos φ sin θ, sin φ, cos φ cos θ)"));
    assert!(help("off-centre").contains("glFrustum(l, r, b, t, n, f)") && help("frustum").contains("glFrustum"));
    assert!(help("depth-range").contains("z_w = N + (F - N) z"));
    assert!(help("eye_spherical").contains("target + r (cos φ sin θ, sin φ, cos φ cos θ)"));
}

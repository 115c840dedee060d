//! Pictures of the panels over real frames, for people to look at.

use super::{Seen, click, click_button, harness_of, mouse, place_of, press};
use crate::common;
use crate::common::report::{one_scene, three_scenes};
use egui::{Key, PointerButton};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use stencilscope::ask::{MeshesOf, ReportOf, RunRequest, TruthOf};
use stencilscope::capture::Capture;
use stencilscope::inspector::{Inspector, SceneEntry};
use stencilscope::progress::Progress;
use stencilscope::reading::ObjectMesh;
use stencilscope::reading::shown::{PictureKind, TexelZoom};
use stencilscope::report::{MeasuredReport, Report};
use stencilscope::scene::{OpenSpec, Scene, open};
use stencilscope::session::CaptureRequest;
use stencilscope::technique::Technique;

/// The harness leaves this much around the panels, pixels.
pub const MARGIN: u32 = 8;
/// Where light, one shadow and two shadows meet.
const PICK: [u32; 2] = [689, 142];

/// `INSPECTOR_PICTURES=FOLDER cargo test pictures_of` writes them; the README's is
/// `z-fail-stencil-1440.png`. Without the variable the panels are only drawn, small.
#[test]
fn pictures_of_the_panels_can_be_drawn() {
    let folder = std::env::var_os("INSPECTOR_PICTURES").map(PathBuf::from);
    let sizes = sizes(folder.is_some());
    let scene = open(&OpenSpec::new("tori")).expect("tori");
    let mut session = common::session();
    for technique in [Technique::ZFail, Technique::ShadowMap, Technique::Planar] {
        let timing_runs = if folder.is_some() { 5 } else { 0 };
        let request = CaptureRequest { timing_runs, ..common::request(technique, [1280, 720]) };
        let capture = Arc::new(session.capture(&scene, &request).expect("a capture"));
        let judged = Arc::new(session.judged(&scene, &capture, &Progress::default()).expect("a truth"));
        let views = VIEWS.iter().map(|view| (view, &capture)).chain(JUDGED_VIEWS.iter().map(|view| (view, &judged)));
        for ((name, view), capture) in views {
            for size in sizes {
                let inspector = inspector(&scene, &request, capture, PICK);
                let outer = size.map(|side| (side + 2 * MARGIN) as f32);
                let mut harness = harness_of(inspector, outer);
                view(&mut harness);
                harness.run_steps(2);
                draw(&mut harness, folder.as_deref(), &format!("{}-{name}", technique.name()), *size);
            }
        }
    }
}

pub fn inspector(scene: &Scene, request: &CaptureRequest, capture: &Arc<Capture>, pick: [u32; 2]) -> Inspector {
    let entry = SceneEntry { name: "tori".to_owned(), lesson: "four tori".to_owned() };
    let mut inspector = Inspector::new(vec![entry]);
    let draft = RunRequest::of(scene, request.choice.clone(), request.size);
    inspector.set_scene(scene, draft);
    inspector.set_capture(capture.clone());
    inspector.pick(pick);
    inspector
}

pub fn sizes(are_kept: bool) -> &'static [[u32; 2]] {
    if are_kept { &[[1280, 800], [1440, 900], [1920, 1080]] } else { &[[640, 400]] }
}

pub fn draw(harness: &mut Harness<Seen>, folder: Option<&Path>, name: &str, size: [u32; 2]) {
    let picture = harness.render().expect("a picture");
    if let Some(folder) = folder {
        save(&folder.join(format!("{name}-{}.png", size[0])), picture.as_raw(), size);
    }
}

/// What only some techniques have: textures, silhouettes, counts in floats; and what meshes and
/// settings look like there.
#[test]
fn pictures_of_textures_silhouettes_and_counts_can_be_drawn() {
    let folder = std::env::var_os("INSPECTOR_PICTURES").map(PathBuf::from);
    let mut session = common::session();
    for Example { scene, technique, settings, pick, views } in EXAMPLES {
        let scene = open(&OpenSpec::new(*scene)).expect("a built-in scene");
        let mut request = common::request(*technique, [1280, 720]);
        settings.iter().for_each(|(key, value)| request.choice.set(key, value).expect("a setting"));
        let capture = Arc::new(session.capture(&scene, &request).expect("a capture"));
        let mesh = |(object, topology)| ObjectMesh { object, topology };
        let meshes: Vec<ObjectMesh> = session.topologies(&scene).into_iter().map(mesh).collect();
        for (name, view) in *views {
            for size in sizes(folder.is_some()) {
                let mut inspector = inspector(&scene, &request, &capture, *pick);
                inspector.tell(MeshesOf { added: Vec::new() }, Ok(Arc::new(meshes.clone())));
                let mut harness = harness_of(inspector, size.map(|side| (side + 2 * MARGIN) as f32));
                view(&mut harness);
                harness.run_steps(2);
                draw(&mut harness, folder.as_deref(), &format!("{}-{}-{name}", technique.name(), scene.name), *size);
            }
        }
    }
}

/// Passes draw by draw: states that are there, that are being fetched, and that a folder lacks.
#[test]
fn pictures_of_draws_can_be_drawn() {
    let folder = std::env::var_os("INSPECTOR_PICTURES").map(PathBuf::from);
    let mut session = common::session();
    let scene = open(&OpenSpec::new("tori")).expect("tori");
    let request = common::request(Technique::ZFail, [1280, 720]);
    let plain = Arc::new(session.capture(&scene, &request).expect("a capture"));
    let plan = session.plan(&scene, &request).expect("a plan");
    let filled = Arc::new(plain.with_draws(&session.step_draws(&plan, &plain, 1).expect("draws")));
    let views: [(&str, &Arc<Capture>, View); 4] = [
        ("held", &filled, |_| ()),
        ("pass", &filled, |harness| harness.state_mut().inspector.select_step(1)),
        ("fetching", &plain, |_| ()),
        ("folder", &plain, |harness| harness.state_mut().inspector.open_folder(None)),
    ];
    for (name, capture, view) in views {
        for size in sizes(folder.is_some()) {
            let mut inspector = inspector(&scene, &request, capture, PICK);
            inspector.set_picture_kind(PictureKind::Stencil);
            inspector.select_draw(1, 2);
            let mut harness = harness_of(inspector, size.map(|side| (side + 2 * MARGIN) as f32));
            view(&mut harness);
            harness.run_steps(2);
            draw(&mut harness, folder.as_deref(), &format!("draws-{name}"), *size);
        }
    }
}

/// A frame and what is looked at in it.
struct Example {
    scene: &'static str,
    technique: Technique,
    settings: &'static [(&'static str, &'static str)],
    pick: [u32; 2],
    views: &'static [(&'static str, View)],
}

const EXAMPLES: &[Example] = &[
    Example {
        scene: "panels",
        technique: Technique::PlanarTexture,
        settings: &[],
        pick: [640, 600],
        views: &[
            ("colour", |_| ()),
            ("all", |harness| harness.state_mut().inspector.set_picture_kind(PictureKind::Map)),
            ("one", first_layer),
            ("meshes", |harness| {
                click(harness, "Scene settings");
                harness.get_by_label("Meshes").scroll_to_me();
                harness.run_steps(4);
            }),
        ],
    },
    Example {
        scene: "gate",
        technique: Technique::ZFail,
        settings: &[("counter", "float")],
        pick: [640, 360],
        views: &[("count", |harness| click_button(harness, "Count"))],
    },
    Example {
        scene: "glass",
        technique: Technique::Projective,
        settings: &[],
        pick: [640, 600],
        views: &[
            ("colour", |_| ()),
            ("all", |harness| harness.state_mut().inspector.set_picture_kind(PictureKind::Map)),
            ("one", first_layer),
            ("settings", |harness| click(harness, "Scene settings")),
        ],
    },
    Example {
        scene: "tori",
        technique: Technique::ZFail,
        settings: &[("counter", "float")],
        pick: PICK,
        views: &[
            ("count", |harness| click_button(harness, "Count")),
            ("count-step", |harness| harness.state_mut().inspector.select_step(1)),
            ("settings", |harness| click(harness, "Scene settings")),
        ],
    },
];

/// The first layer that is drawn, with a texel picked.
fn first_layer(harness: &mut Harness<Seen>) {
    press(harness, Key::Home);
    let capture = harness.state().inspector.capture().cloned().expect("a capture");
    let size = capture.lights[0].map.as_ref().expect("a map").faces[0].size();
    let at = place_of(harness, size.map(|side| side / 2), size);
    mouse(harness, at, PointerButton::Secondary);
}

/// Writes the picture without its margin.
fn save(file: &Path, rgba: &[u8], [width, height]: [u32; 2]) {
    let stride = (width + 2 * MARGIN) as usize * 4;
    let rows = rgba.chunks_exact(stride).skip(MARGIN as usize).take(height as usize);
    let inner: Vec<u8> = rows.flat_map(|row| &row[MARGIN as usize * 4..][..width as usize * 4]).copied().collect();
    let file = std::fs::File::create(file).expect("a file");
    let mut encoder = png::Encoder::new(file, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_compression(png::Compression::High);
    encoder.write_header().expect("a header").write_image_data(&inner).expect("the picture");
}

type View = fn(&mut Harness<Seen>);

fn tell_report(harness: &mut Harness<Seen>, report: Report) {
    let measured = MeasuredReport { report, left_out: Vec::new() };
    harness.state_mut().inspector.tell(ReportOf::grid().expect("a grid"), Ok(Arc::new(measured)));
}

const VIEWS: [(&str, View); 13] = [
    ("colour", |_| ()),
    ("stencil", |harness| {
        harness.state_mut().inspector.select_step(1);
        harness.state_mut().inspector.set_picture_kind(PictureKind::Stencil);
    }),
    ("depth", |harness| harness.state_mut().inspector.set_picture_kind(PictureKind::Depth)),
    ("mask", |harness| harness.state_mut().inspector.set_picture_kind(PictureKind::Mask)),
    ("map", |harness| harness.state_mut().inspector.set_picture_kind(PictureKind::Map)),
    ("tracing", |harness| {
        harness.state_mut().inspector.set_picture_kind(PictureKind::Error);
        harness.run_steps(1);
        let progress = super::last_asked::<TruthOf>(harness).progress;
        progress.start(100);
        (0..43).for_each(|_| progress.advance());
    }),
    ("large", |harness| {
        harness.state_mut().inspector.set_picture_kind(PictureKind::Stencil);
        harness.state_mut().inspector.set_zoom(TexelZoom::Pixels(28.0), PICK.map(f64::from));
    }),
    ("settings", |harness| click(harness, "Scene settings")),
    ("report", |harness| {
        tell_report(harness, one_scene());
    }),
    ("report-running", |harness| {
        let mut report = one_scene();
        report.rows.truncate(8);
        report.mark_pareto();
        tell_report(harness, report);
        harness.state_mut().inspector.start(ReportOf::grid().expect("a grid"));
        harness.run_steps(1);
        let progress = super::last_asked::<ReportOf>(harness).progress;
        progress.start(15);
        (0..8).for_each(|_| progress.advance());
    }),
    ("report-scenes", |harness| {
        tell_report(harness, three_scenes());
    }),
    ("open", |harness| click(harness, "Open…")),
    ("error", |harness| {
        harness.state_mut().inspector.push_error("bunny.obj: no such file: check the path".to_owned());
    }),
];

/// Of frames that were held against the truth.
const JUDGED_VIEWS: [(&str, View); 4] = [
    ("truth", |harness| harness.state_mut().inspector.set_picture_kind(PictureKind::Truth)),
    ("wrong", |harness| harness.state_mut().inspector.set_picture_kind(PictureKind::Error)),
    ("wrong-largest", go_to_the_largest),
    ("wrong-pixels", |harness| {
        go_to_the_largest(harness);
        let at = harness.state().inspector.picked().unwrap_or(PICK);
        harness.state_mut().inspector.set_zoom(TexelZoom::Pixels(28.0), at.map(f64::from));
    }),
];

fn go_to_the_largest(harness: &mut Harness<Seen>) {
    harness.state_mut().inspector.set_picture_kind(PictureKind::Error);
    harness.run_steps(2);
    if harness.query_by_label("Go to the largest").is_some() {
        click(harness, "Go to the largest");
    }
}

//! Pictures of the panels over real frames, for people to look at.

use super::*;
use crate::common::report::{one_scene, three_scenes};
use stencilscope::anatomy::Anatomy;
use stencilscope::ask::MeshesOf;
use stencilscope::inspector::ThemeChoice;
use stencilscope::reading::ObjectMesh;
use stencilscope::report::{MeasuredReport, Report};

/// The harness leaves this much around the panels, pixels.
pub const MARGIN: u32 = 8;
/// Where light, one shadow and two shadows meet.
const PICK: [u32; 2] = [689, 142];

/// Pictures of the panels: written where `INSPECTOR_PICTURES` names a folder, and only drawn, small, where it does not.
pub struct Gallery {
    pub folder: Option<PathBuf>,
}

impl Gallery {
    pub fn open() -> Gallery {
        Gallery { folder: std::env::var_os("INSPECTOR_PICTURES").map(PathBuf::from) }
    }

    pub fn sizes(&self) -> &'static [[u32; 2]] {
        match self.folder.is_some() {
            true => &[[1000, 700], [1280, 800], [1440, 900], [1920, 1080]],
            false => &[[1280, 400]],
        }
    }

    /// Draws the panels in windows of several sizes, once they were brought into a state to be looked at; where pictures are
    /// kept, what is dark also in light colours.
    pub fn show(
        &self,
        name: &str,
        sizes: &[[u32; 2]],
        mut inspector: impl FnMut() -> Inspector,
        mut view: impl FnMut(&mut Harness<Seen>),
    ) {
        for size in sizes {
            for is_light in [false, true] {
                let mut inspector = inspector();
                if is_light && (self.folder.is_none() || inspector.model.theme == ThemeChoice::Light) {
                    continue;
                }
                let theme = if is_light { ThemeChoice::Light } else { inspector.model.theme };
                inspector.model.theme = theme;
                let mut harness = harness_in(inspector, size.map(|side| (side + 2 * MARGIN) as f32));
                view(&mut harness);
                harness.run_steps(2);
                self.draw(&mut harness, &if is_light { format!("{name}-light") } else { name.to_owned() }, *size);
            }
        }
    }

    pub fn draw(&self, harness: &mut Harness<Seen>, name: &str, size: [u32; 2]) {
        let picture = window_picture(harness);
        if let Some(folder) = &self.folder {
            save(&folder.join(format!("{name}-{}.png", size[0])), &picture, size);
        }
    }
}

/// `INSPECTOR_PICTURES=FOLDER cargo test --profile bench pictures_of` writes them; the README's is
/// `z-fail-stencil-1440.png`. Without the variable the panels are only drawn, small.
#[test]
fn pictures_of_the_panels_can_be_drawn() {
    let gallery = Gallery::open();
    let mut session = common::session();
    for technique in [Technique::ZFail, Technique::ShadowMap, Technique::Planar] {
        let timing_runs = if gallery.folder.is_some() { 5 } else { 0 };
        let request = CaptureRequest { timing_runs, ..common::request(technique, [1280, 720]) };
        let frame = common::frame(&mut session, "tori", request);
        let scene = frame.scene().expect("a scene");
        let capture = session.judged(scene, &frame.capture, &Progress::default()).expect("a truth");
        let judged = RunFrame { capture: Arc::new(capture), ..frame.clone() };
        let views = VIEWS.iter().map(|view| (view, &frame)).chain(JUDGED_VIEWS.iter().map(|view| (view, &judged)));
        for ((name, view), frame) in views {
            let name = format!("{}-{name}", technique.name());
            gallery.show(&name, gallery.sizes(), || inspector(frame, PICK), view);
        }
    }
}

pub fn inspector(frame: &RunFrame, pick: [u32; 2]) -> Inspector {
    let (scene, request) = frame.made().expect("a scene");
    inspector_of(scene, request, &frame.capture, pick)
}

pub fn inspector_of(scene: &Scene, request: &CaptureRequest, capture: &Arc<Capture>, pick: [u32; 2]) -> Inspector {
    let entry = SceneEntry { name: "tori".to_owned(), lesson: "four tori".to_owned() };
    let mut inspector = Inspector::new(vec![entry]);
    inspector.set_scene(scene, RunRequest::of(scene, request.choice.clone(), request.size));
    inspector.set_capture(capture.clone());
    inspector.model.selection.pick = Some(pick);
    inspector
}

/// What a frame is made of, as the app finds it out.
pub fn anatomy(session: &mut Session, frame: &RunFrame) -> Arc<Anatomy> {
    let (scene, request) = frame.made().expect("a scene");
    Arc::new(session.anatomy(scene, Some(&request.choice), &frame.plan))
}

/// What only some techniques have: textures, silhouettes, counts in floats; and what meshes and
/// settings look like there.
#[test]
fn pictures_of_textures_silhouettes_and_counts_can_be_drawn() {
    let gallery = Gallery::open();
    let mut session = common::session();
    for Example { scene, technique, settings, pick, views } in EXAMPLES {
        let frame = common::frame(&mut session, scene, common::request_with(*technique, settings, [1280, 720]));
        let mesh = |(object, topology)| ObjectMesh { object, topology };
        let topologies = session.topologies(frame.scene().expect("a scene"));
        let meshes: Vec<ObjectMesh> = topologies.into_iter().map(mesh).collect();
        let with_meshes = || {
            let mut inspector = inspector(&frame, *pick);
            inspector.take_in(MeshesOf { added: Vec::new() }, Ok(Arc::new(meshes.clone())));
            inspector
        };
        for (name, view) in *views {
            gallery.show(&format!("{}-{scene}-{name}", technique.name()), gallery.sizes(), with_meshes, view);
        }
    }
}

/// Passes draw by draw: states that are there, that are being fetched, and that a folder lacks.
#[test]
fn pictures_of_draws_can_be_drawn() {
    let gallery = Gallery::open();
    let mut session = common::session();
    let plain = common::frame(&mut session, "tori", common::request(Technique::ZFail, [1280, 720]));
    let draws = session.step_draws(&plain.plan, &plain.capture, 1).expect("draws");
    let filled = RunFrame { capture: Arc::new(plain.capture.with_draws(&draws)), ..plain.clone() };
    let views: [(&str, &RunFrame, View); 4] = [
        ("held", &filled, |_| ()),
        ("pass", &filled, |harness| harness.state_mut().inspector.model.select_step(1)),
        ("fetching", &plain, |_| ()),
        ("folder", &plain, |harness| harness.state_mut().inspector.open_folder(None)),
    ];
    for (name, frame, view) in views {
        let at_a_draw = || {
            let mut inspector = inspector(frame, PICK);
            inspector.model.choose_picture(PictureKind::Stencil);
            inspector.select_draw(1, 2);
            inspector
        };
        gallery.show(&format!("draws-{name}"), gallery.sizes(), at_a_draw, view);
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
            ("all", |harness| harness.state_mut().inspector.model.choose_picture(PictureKind::Map)),
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
            ("all", |harness| harness.state_mut().inspector.model.choose_picture(PictureKind::Map)),
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
            ("count-step", |harness| harness.state_mut().inspector.model.select_step(1)),
            ("settings", |harness| click(harness, "Scene settings")),
        ],
    },
];

/// The first layer that is drawn, with a texel picked.
fn first_layer(harness: &mut Harness<Seen>) {
    press(harness, Key::Home);
    let capture = harness.state().inspector.model.frame.capture.as_ref().cloned().expect("a capture");
    let size = capture.lights[0].map.as_ref().expect("a map").faces[0].size();
    pick_by_mouse(harness, size.map(|side| side / 2), size);
}

/// Writes the picture without its margin.
fn save(file: &Path, picture: &Picture, [width, height]: [u32; 2]) {
    let inner =
        Picture::drawn([width, height], |[x, y]| picture.at([x + MARGIN, y + MARGIN]).expect("within the window"));
    std::fs::write(file, inner.to_png().expect("a PNG")).expect("written");
}

/// Brings the panels into a state to be looked at.
pub type View = fn(&mut Harness<Seen>);

fn give_report(harness: &mut Harness<Seen>, report: Report) {
    let measured = MeasuredReport { report, left_out: Vec::new(), is_whole: true };
    harness.state_mut().inspector.take_in(ReportOf::grid().expect("a grid"), Ok(Arc::new(measured)));
}

const VIEWS: [(&str, View); 13] = [
    ("colour", |_| ()),
    ("stencil", |harness| {
        harness.state_mut().inspector.model.select_step(1);
        harness.state_mut().inspector.model.choose_picture(PictureKind::Stencil);
    }),
    ("depth", |harness| harness.state_mut().inspector.model.choose_picture(PictureKind::Depth)),
    ("mask", |harness| harness.state_mut().inspector.model.choose_picture(PictureKind::Mask)),
    ("map", |harness| harness.state_mut().inspector.model.choose_picture(PictureKind::Map)),
    ("tracing", |harness| {
        harness.state_mut().inspector.model.choose_picture(PictureKind::Error);
        harness.run_steps(1);
        let progress = last_asked::<TruthOf>(harness).progress;
        progress.start(100);
        (0..43).for_each(|_| progress.advance());
    }),
    ("large", |harness| {
        harness.state_mut().inspector.model.choose_picture(PictureKind::Stencil);
        harness.state_mut().inspector.set_zoom(TexelZoom::Pixels(28.0), PICK.map(f64::from));
    }),
    ("settings", |harness| click(harness, "Scene settings")),
    ("report", |harness| {
        give_report(harness, one_scene());
    }),
    ("report-running", |harness| {
        let mut report = one_scene();
        report.rows.truncate(8);
        report.mark_pareto();
        give_report(harness, report);
        harness.state_mut().inspector.model.answers.start(ReportOf::grid().expect("a grid"));
        harness.run_steps(1);
        let progress = last_asked::<ReportOf>(harness).progress;
        progress.start(15);
        (0..8).for_each(|_| progress.advance());
    }),
    ("report-scenes", |harness| {
        give_report(harness, three_scenes());
    }),
    ("open", |harness| click(harness, "Open…")),
    ("error", |harness| {
        harness.state_mut().inspector.model.push_error("bunny.obj: no such file: check the path".to_owned());
    }),
];

/// Views of frames that were compared with the truth.
const JUDGED_VIEWS: [(&str, View); 4] = [
    ("truth", |harness| harness.state_mut().inspector.model.choose_picture(PictureKind::Truth)),
    ("wrong", |harness| harness.state_mut().inspector.model.choose_picture(PictureKind::Error)),
    ("wrong-largest", go_to_the_largest),
    ("wrong-pixels", |harness| {
        go_to_the_largest(harness);
        let at = harness.state().inspector.model.selection.pick.unwrap_or(PICK);
        harness.state_mut().inspector.set_zoom(TexelZoom::Pixels(28.0), at.map(f64::from));
    }),
];

fn go_to_the_largest(harness: &mut Harness<Seen>) {
    change(harness, |inspector| inspector.model.choose_picture(PictureKind::Error));
    if harness.query_by_label("Go to the largest").is_some() {
        click(harness, "Go to the largest");
    }
}

//! Whatever is pressed, clicked, dragged, dropped or resized, and whatever answers come: no panic.
//!
//! Inputs come from fixed seeds, so that a failure can be had again: it reports the seed, the frame and the inputs
//! before it.

use super::accessibility::known;
use super::*;
use crate::common::random::Random;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use stencilscope::ask::TestsOf;

const FRAMES: usize = 450;
/// How many inputs before a failure are reported.
const REPORTED_INPUTS: usize = 6;
/// Sizes of windows in points: from what a window manager may do to a large screen.
const SIZES: [[f32; 2]; 6] =
    [[1280.0, 800.0], [640.0, 400.0], [220.0, 1000.0], [1800.0, 90.0], [24.0, 16.0], [1.0, 1.0]];
const KEYS: [Key; 38] = [
    Key::ArrowLeft,
    Key::ArrowRight,
    Key::ArrowUp,
    Key::ArrowDown,
    Key::Home,
    Key::End,
    Key::PageUp,
    Key::PageDown,
    Key::Space,
    Key::Enter,
    Key::Escape,
    Key::Tab,
    Key::Delete,
    Key::Backspace,
    Key::A,
    Key::B,
    Key::C,
    Key::D,
    Key::F,
    Key::G,
    Key::H,
    Key::I,
    Key::L,
    Key::O,
    Key::P,
    Key::S,
    Key::T,
    Key::V,
    Key::W,
    Key::X,
    Key::Y,
    Key::Z,
    Key::F1,
    Key::Questionmark,
    Key::Comma,
    Key::Period,
    Key::Plus,
    Key::Minus,
];

struct Monkey {
    random: Random,
    captures: Vec<Arc<Capture>>,
    at: Pos2,
    recent: VecDeque<String>,
}

impl Monkey {
    fn below(&mut self, count: usize) -> usize {
        ((self.random.unit() * count as f64) as usize).min(count - 1)
    }

    fn place(&mut self, harness: &Harness<Seen>) -> Pos2 {
        let size = harness.ctx.content_rect().size();
        // A little over the border too.
        let mut within = |side: f32| (self.random.unit() as f32 * 1.04 - 0.02) * side;
        pos2(within(size.x), within(size.y))
    }

    fn modifiers(&mut self) -> Modifiers {
        [Modifiers::NONE, Modifiers::NONE, Modifiers::COMMAND, Modifiers::SHIFT, Modifiers::ALT][self.below(5)]
    }

    fn report(&mut self, what: String) {
        self.recent.push_back(what);
        if self.recent.len() > REPORTED_INPUTS {
            self.recent.pop_front();
        }
    }

    /// One random thing happens.
    fn act(&mut self, harness: &mut Harness<Seen>) {
        match self.below(16) {
            0..4 => self.press(harness),
            4..8 => self.click(harness),
            8..10 => self.drag(harness),
            10 => self.wheel(harness),
            11 => {
                let text = ["0", "12", "-3", "1e309", "NaN", "x", "∞", "…/../"][self.below(8)];
                self.report(format!("typed {text}"));
                harness.event(Event::Text(text.to_owned()));
            }
            12 => self.resize(harness),
            13 => {
                self.at = self.place(harness);
                self.report(format!("pointer to {}", self.at));
                harness.hover_at(self.at);
                harness.event(Event::MouseMoved(vec2(self.random.unit() as f32 * 80.0 - 40.0, 9.0)));
            }
            _ => self.answer(harness),
        }
    }

    fn press(&mut self, harness: &mut Harness<Seen>) {
        let (key, modifiers) = (KEYS[self.below(KEYS.len())], self.modifiers());
        self.report(format!("{modifiers:?} {key:?}"));
        match self.below(4) {
            0 => harness.key_down_modifiers(modifiers, key),
            1 => harness.key_up_modifiers(modifiers, key),
            _ => harness.key_press_modifiers(modifiers, key),
        }
    }

    fn button(&mut self, harness: &Harness<Seen>, button: PointerButton, pressed: bool) {
        let modifiers = self.modifiers();
        harness.event(Event::PointerButton { pos: self.at, button, pressed, modifiers });
    }

    fn click(&mut self, harness: &mut Harness<Seen>) {
        self.at = self.place(harness);
        let button = [PointerButton::Primary, PointerButton::Primary, PointerButton::Secondary][self.below(3)];
        self.report(format!("{button:?} click at {}", self.at));
        harness.hover_at(self.at);
        harness.run_steps(1);
        self.button(harness, button, true);
        harness.run_steps(1);
        self.button(harness, button, false);
    }

    fn drag(&mut self, harness: &mut Harness<Seen>) {
        self.at = self.place(harness);
        let button = [PointerButton::Primary, PointerButton::Secondary, PointerButton::Middle][self.below(3)];
        self.report(format!("{button:?} drag from {}", self.at));
        harness.hover_at(self.at);
        harness.run_steps(1);
        self.button(harness, button, true);
        for _ in 0..2 {
            self.at = self.place(harness);
            harness.hover_at(self.at);
            harness.run_steps(1);
        }
        // Now and then the button is let go outside the window, of which there is no event.
        if self.below(8) > 0 {
            self.button(harness, button, false);
        }
    }

    fn wheel(&mut self, harness: &Harness<Seen>) {
        let steps = [1.0, -1.0, 40.0, -40.0, 4000.0, -4000.0][self.below(6)];
        self.report(format!("wheel {steps}"));
        harness.event(Event::MouseWheel {
            unit: egui::MouseWheelUnit::Line,
            delta: vec2(0.0, steps),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: self.modifiers(),
        });
    }

    fn resize(&mut self, harness: &mut Harness<Seen>) {
        let size = SIZES[if self.below(2) == 0 { 0 } else { self.below(SIZES.len()) }];
        let scale = [1.0, 1.0, 2.0, 0.75][self.below(4)];
        self.report(format!("{size:?} at {scale}"));
        harness.set_size(size.into());
        harness.set_pixels_per_point(scale);
    }

    /// News from the worker, right, late or bad.
    fn answer(&mut self, harness: &mut Harness<Seen>) {
        let what = self.below(15);
        self.report(format!("news {what}"));
        let bad = || "it failed: try again".to_owned();
        let capture = self.below(self.captures.len());
        let capture = self.captures[capture].clone();
        let pixel = [self.below(70) as u32, self.below(50) as u32];
        let seen = harness.state_mut();
        let inspector = &mut seen.inspector;
        match what {
            0..3 => inspector.set_capture(capture),
            3 => inspector.model.update_capture(capture),
            4 => inspector.take_in(HistoryOf { at: pixel }, Err(bad())),
            5 => inspector.take_in(AnatomyOf {}, Err(bad())),
            6 => {
                inspector.take_in(TestsOf { step: pixel[0] as usize, draw: Some(pixel[1] as usize) }, Err(bad()));
            }
            7 => inspector.take_in(TruthOf {}, Err(bad())),
            8 => inspector.model.push_error(format!("broken-{}.obj: no faces: choose another file", pixel[0])),
            9 => inspector.set_job([None, Some("rendering".to_owned())][pixel[0] as usize % 2].clone()),
            10 => {
                inspector.set_scene(&scene(), run_request(Technique::ZFail));
                inspector.set_capture(capture);
            }
            11 => {
                inspector.open_folder(None);
                inspector.set_capture(capture);
            }
            12 => {
                inspector.model.answers.start(ReportOf::grid().expect("a grid"));
                inspector.model.start_diagnosis();
            }
            13 => {
                // An answer to any question that was ever asked, in time or late.
                let asked: Vec<u64> = seen.actions.iter().filter_map(ticket).collect();
                let ticket = asked.get(self.below(asked.len().max(1))).copied().unwrap_or_default();
                inspector.answer(ticket, Err(bad()), pixel[0].is_multiple_of(2));
                inspector.model.answers.make_way();
            }
            _ => harness.input_mut().dropped_files.push(Arc::new(Dropped(PathBuf::from("broken.obj")))),
        }
    }
}

fn ticket(action: &Action) -> Option<u64> {
    if let Action::Ask(asked) = action { Some(asked.ticket) } else { None }
}

/// What panels are shown over: by hand, empty, smallest, with maps and with broken values.
fn by_hand() -> Vec<Arc<Capture>> {
    let mut empty = z_fail([1, 1]);
    empty.steps.clear();
    empty.lights.clear();
    let mut broken = z_fail(SIZE);
    let values = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 2.0, 0.0];
    let texels = (0..SIZE[0] * SIZE[1]).flat_map(|at| values[at as usize % values.len()].to_le_bytes());
    let depth = Arc::new(Image::packed(PixelFormat::Depth32F, SIZE, texels.collect::<Vec<u8>>()));
    for step in &mut broken.steps {
        if let stencilscope::capture::Snapshot::Frame(frame) = &mut step.snapshot {
            frame.depth.image = depth.clone();
        }
    }
    [z_fail(SIZE), cube_map(), z_fail([1, 1]), empty, broken].map(Arc::new).to_vec()
}

fn run(name: &str, seed: u64, inspector: Inspector, captures: &[Arc<Capture>]) {
    let (at, recent) = (Pos2::ZERO, VecDeque::new());
    let mut monkey = Monkey { random: Random::new(seed), captures: captures.to_vec(), at, recent };
    let mut frame = 0;
    let result = catch_unwind(AssertUnwindSafe(|| {
        let mut harness = harness_in(inspector, SIZES[0]);
        while frame < FRAMES {
            monkey.act(&mut harness);
            harness.run_steps(1);
            frame += 1;
        }
    }));
    assert!(result.is_ok(), "{name}, seed {seed}, input {frame}, after {:#?}", monkey.recent);
}

#[test]
fn random_input_over_captures_by_hand_does_not_panic() {
    for seed in 1..=4 {
        run("by hand", seed, inspector(z_fail(SIZE)), &by_hand());
    }
}

#[test]
fn random_input_over_a_real_capture_does_not_panic() {
    for (seed, technique) in [(11, Technique::ZFail), (12, Technique::ShadowMap)] {
        let inspector = known(technique);
        let mut captures = by_hand();
        captures.extend(inspector.model.frame.capture.as_ref().cloned());
        run("tori", seed, inspector, &captures);
    }
}

#[test]
fn random_input_over_a_recorded_frame_does_not_panic() {
    let mut session = common::session();
    let ogre = recorded::frame(&mut session, "ogre");
    for seed in [21, 22] {
        let mut inspector = recorded::inspector(&ogre);
        let at = [60, 140];
        let history = session.history(&ogre.plan, &ogre.capture, at).expect("a history");
        let scene = ogre.scene().expect("a scene");
        inspector.model.selection.pick = Some(at);
        inspector.take_in(HistoryOf { at }, Ok(Arc::new(history)));
        inspector.take_in(AnatomyOf {}, Ok(Arc::new(session.anatomy(scene, None, &ogre.plan))));
        run("ogre", seed, inspector, &[Arc::clone(&ogre.capture)]);
    }
}

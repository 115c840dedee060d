//! The panels without a window, led through tours: what they ask for is done, and frames are made once.

use crate::common::{opened, session};
use std::collections::BTreeMap;
use std::sync::Arc;
use stencilscope::ask::RunRequest;
use stencilscope::capture::Capture;
use stencilscope::inspector::{Action, Inspector, Tour};
use stencilscope::plan::FramePlan;
use stencilscope::progress::Progress;
use stencilscope::session::{CaptureRequest, Session};
use stencilscope::technique::{Choice, Technique};

/// The size of the frames.
pub const SIZE: [u32; 2] = [320, 240];

/// The panels without a window, led from stop to stop: frames are made as they ask for them.
pub struct Guided {
    pub inspector: Inspector,
    ctx: egui::Context,
    session: Session,
    frames: BTreeMap<String, (Arc<Capture>, Arc<FramePlan>)>,
}

impl Guided {
    pub fn new() -> Guided {
        let ctx = egui::Context::default();
        Guided { inspector: Inspector::default(), ctx, session: session(), frames: BTreeMap::new() }
    }

    pub fn go_to(&mut self, tour: &Tour, stop: usize) {
        let actions = self.inspector.go_to_stop(tour.technique, stop);
        self.carry_out(actions, tour.technique);
    }

    /// Does what is asked for, and what is asked for then; a scene is opened with a technique.
    pub fn carry_out(&mut self, mut actions: Vec<Action>, technique: Technique) {
        for _ in 0..8 {
            for action in actions {
                match action {
                    Action::Open(name) => {
                        let scene = opened(&name);
                        let draft = RunRequest::of(&scene, Choice::new(technique), SIZE);
                        self.inspector.open_scene(&scene, draft.clone(), Some(name));
                        self.run(&draft);
                    }
                    Action::Run(run) => self.run(&run),
                    _ => {}
                }
            }
            let input = egui::RawInput {
                screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1280.0, 800.0))),
                ..egui::RawInput::default()
            };
            let mut asked = Vec::new();
            let mut output = self.ctx.run_ui(input, |ui| asked.extend(self.inspector.ui(ui)));
            // Nothing is drawn.
            output.textures_delta.clear();
            actions = asked;
        }
    }

    /// Captures the open scene so, with its truth, and shows it.
    pub fn run(&mut self, run: &RunRequest) {
        let name = self.inspector.model.scene.as_ref().expect("a scene").name.clone();
        let session = &mut self.session;
        let made = self.frames.entry(format!("{name} {:?}", run.choice)).or_insert_with(|| {
            let scene = opened(&name);
            let request = CaptureRequest::new(run.choice.clone(), SIZE);
            let (capture, plan) = session.capture_with_plan(&scene, &request).expect("a capture");
            let capture = session.judged(&scene, &capture, &Progress::default()).expect("a truth");
            (Arc::new(capture), Arc::new(plan))
        });
        let (capture, plan) = made.clone();
        self.inspector.set_capture(capture);
        self.inspector.set_plan(plan);
    }

    pub fn frame(&self) -> (Arc<Capture>, Arc<FramePlan>) {
        let frame = &self.inspector.model.frame;
        (frame.capture.clone().expect("a capture"), frame.plan.clone().expect("a plan"))
    }
}

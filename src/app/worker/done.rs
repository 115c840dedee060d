//! What is asked of the frame that was captured last: its time, its truth, its draws, what happened
//! to a pixel, why it is wrong, and how other techniques do in its place.

use super::Bench;
use crate::app::allocator;
use crate::app::news::News;
use crate::app::orders::{Inbox, Measure, Order};
use crate::capture::Capture;
use crate::plan::FramePlan;
use crate::progress::Progress;
use crate::report::Report;
use crate::scene::Scene;
use crate::session::{CaptureRequest, Fault, Measurement, Session, SessionError, median_ms, report_rows};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Frames that are timed, each with and without snapshots.
const TIMED_FRAMES: usize = 5;

/// Bytes that a row of a report, or a mend that a diagnosis tries, may take beyond the frame that is shown, where
/// the GPU's memory is this program's own: a window that is open for hours shares the machine. A mend that is
/// applied takes as much again for its snapshots.
const MOST_OF_A_TRIAL: u64 = 128 << 20;

/// While rows of a report come and go.
const GIVE_BACK_EVERY: Duration = Duration::from_millis(500);

/// A frame that was captured.
pub(super) struct Done {
    /// Tells it from others.
    pub frame: u64,
    /// At the moment that was captured.
    pub scene: Scene,
    /// How it was captured.
    pub request: CaptureRequest,
    /// What is known of it by now.
    pub capture: Arc<Capture>,
    /// What was run.
    pub plan: Arc<FramePlan>,
    /// It was not timed yet, and is short enough to be.
    pub wants_timing: bool,
}

impl Done {
    /// Lets no more be tried than there is room for.
    fn make_room(&self, session: &mut Session) {
        let shares_memory = session.adapter().kind == "cpu";
        session.set_room(shares_memory.then(|| self.plan.bytes() + MOST_OF_A_TRIAL));
    }

    /// The history of a pixel: so quick that nothing has to say it is being done.
    fn history(&self, session: &mut Session, at: [u32; 2]) -> News {
        let history = session.history(&self.plan, &self.capture, at);
        News::History { frame: self.frame, at, history: history.map(Arc::new).map_err(|error| error.to_string()) }
    }

    /// How the fragments of a step or draw fared in the tests.
    fn tests(&self, session: &mut Session, step: usize, draw: Option<usize>) -> News {
        let result = session.step_tests(&self.plan, step, draw);
        News::Tests { frame: self.frame, step, draw, result: result.map(Arc::new).map_err(|error| error.to_string()) }
    }

    /// What it is made of in space.
    fn anatomy(&self, session: &mut Session) -> News {
        let anatomy = session.anatomy(&self.scene, &self.request.choice, &self.plan);
        News::Anatomy { frame: self.frame, anatomy: Ok(Arc::new(anatomy)) }
    }

    /// The states after the draws of a step.
    fn fill_draws(&mut self, session: &mut Session, step: usize) -> News {
        let mut capture = Capture::clone(&self.capture);
        match session.fill_draws(&self.plan, &mut capture, step) {
            Ok(()) => {
                self.capture = Arc::new(capture);
                News::Draws { frame: self.frame, capture: Arc::clone(&self.capture) }
            }
            Err(error) => News::NoDraws { frame: self.frame, step, reason: error.to_string() },
        }
    }

    /// Obeys an order about this frame that takes no long time; others are dropped, as they are
    /// about a frame that is shown no more.
    fn obey_short(&mut self, session: &mut Session, order: &Order) -> Option<News> {
        match *order {
            Order::History { frame, at } if frame == self.frame => Some(self.history(session, at)),
            Order::Draws { frame, step } if frame == self.frame => Some(self.fill_draws(session, step)),
            Order::Anatomy { frame } if frame == self.frame => Some(self.anatomy(session)),
            Order::Tests { frame, step, draw } if frame == self.frame => Some(self.tests(session, step, draw)),
            _ => None,
        }
    }
}

impl Bench {
    pub(super) fn time(&mut self) {
        let (Some(session), Some(done)) = (&mut self.session, &mut self.last) else { return };
        done.wants_timing = false;
        // The frame has just run, so this can fail only where the GPU is lost: the next run says so.
        if let Ok(cost) = session.capture_cost(&done.scene, &done.request, TIMED_FRAMES) {
            let mut capture = Capture::clone(&done.capture);
            capture.timing.frame_ms = median_ms(&cost.frames);
            capture.timing.captured_ms = median_ms(&cost.captured);
            done.capture = Arc::new(capture);
            (self.tell)(News::Timed { frame: done.frame, capture: Arc::clone(&done.capture) });
        }
    }

    /// Adds the states after the draws of a step to the frame that was captured last, if it is the
    /// one that is meant.
    pub(super) fn fill_draws(&mut self, frame: u64, step: usize) {
        let (Some(session), Some(done)) = (&mut self.session, &mut self.last) else {
            let reason = "the open scene was not rendered: mend what the error says".to_owned();
            return (self.tell)(News::NoDraws { frame, step, reason });
        };
        if done.frame != frame {
            return;
        }
        let name = done.capture.steps.get(step).map_or("the pass", |step| step.name.as_str());
        (self.tell)(News::Busy(format!("capturing the draws of {name}")));
        (self.tell)(done.fill_draws(session, step));
        (self.tell)(News::Idle);
    }

    /// Adds the truth to the frame that was captured last, if it is the one that is meant.
    pub(super) fn judge(&mut self, frame: u64, progress: &Progress) {
        let is_meant = |done: &&mut Done| done.frame == frame && !progress.is_cancelled();
        let (Some(session), Some(done)) = (&mut self.session, self.last.as_mut().filter(is_meant)) else { return };
        (self.tell)(News::Busy("tracing the truth".to_owned()));
        let mut capture = Capture::clone(&done.capture);
        match session.judge(&done.scene, &mut capture, progress) {
            Ok(()) => {
                done.capture = Arc::new(capture);
                (self.tell)(News::Judged { frame, capture: Arc::clone(&done.capture) });
            }
            // The window knows: it has asked for it.
            Err(SessionError::Cancelled) => {}
            Err(error) => (self.tell)(News::NotJudged { frame, reason: error.to_string() }),
        }
        (self.tell)(News::Idle);
    }

    /// Says why the frame that was captured last is wrong, if it is the one that is meant.
    pub(super) fn diagnose(&mut self, frame: u64, job: u64, progress: &Progress) {
        if progress.is_cancelled() {
            return;
        }
        (self.tell)(News::Busy("diagnosing".to_owned()));
        let meant = self.last.as_ref().filter(|done| done.frame == frame);
        let result = match (&mut self.session, meant) {
            (Some(session), Some(done)) => {
                done.make_room(session);
                let found = session.diagnose(&done.scene, &done.request, Fault::None, progress);
                found.map(Arc::new).map_err(|error| error.to_string())
            }
            _ => Err("another picture came meanwhile: diagnose again when it is the one you want".to_owned()),
        };
        // Where it was cancelled, the window has asked for it.
        if !progress.is_cancelled() {
            (self.tell)(News::Diagnosed { job, result });
        }
        (self.tell)(News::Idle);
    }

    /// Tells the history of a pixel of the frame that was captured last, if it is the one that is
    /// meant.
    pub(super) fn history(&mut self, frame: u64, at: [u32; 2]) {
        let meant = self.last.as_ref().filter(|done| done.frame == frame);
        (self.tell)(match (&mut self.session, meant) {
            (Some(session), Some(done)) => done.history(session, at),
            _ => {
                let reason = "the frame that is shown is of a scene that is open no more: mend what the error says";
                News::History { frame, at, history: Err(reason.to_owned()) }
            }
        });
    }

    /// Tells how fragments of the frame that was captured last fared, if it is the one that is meant.
    pub(super) fn tests(&mut self, frame: u64, step: usize, draw: Option<usize>) {
        let meant = self.last.as_ref().filter(|done| done.frame == frame);
        (self.tell)(match (&mut self.session, meant) {
            (Some(session), Some(done)) => done.tests(session, step, draw),
            _ => {
                let reason = "the frame that is shown is of a scene that is open no more: mend what the error says";
                News::Tests { frame, step, draw, result: Err(reason.to_owned()) }
            }
        });
    }

    /// Tells what the frame that was captured last is made of in space, if it is the one that is meant.
    pub(super) fn anatomy(&mut self, frame: u64) {
        let meant = self.last.as_ref().filter(|done| done.frame == frame);
        (self.tell)(match (&mut self.session, meant) {
            (Some(session), Some(done)) => done.anatomy(session),
            _ => {
                let reason = "the frame that is shown is of a scene that is open no more: mend what the error says";
                News::Anatomy { frame, anatomy: Err(reason.to_owned()) }
            }
        });
    }

    /// Measures the open scene as it was captured last. What is asked of its frame meanwhile is told
    /// in between.
    pub(super) fn measure(&mut self, what: Measure, inbox: &mut Inbox) {
        if what.progress.is_cancelled() {
            return;
        }
        (self.tell)(News::Busy("measuring every technique".to_owned()));
        let mut left_out = Vec::new();
        let result = match (&mut self.session, &mut self.last) {
            _ if what.generation != self.generation => {
                Err("another scene was opened meanwhile: measure again when it is the one you want".to_owned())
            }
            (Some(session), Some(done)) => {
                let (scene, size) = (done.scene.clone(), done.request.size);
                done.make_room(session);
                let measurement = Measurement { choices: what.choices, size, runs: what.runs };
                let mut given_back = Instant::now();
                let mut between = |session: &mut Session| {
                    // What one row leaves behind, the next does not fill.
                    if given_back.elapsed() > GIVE_BACK_EVERY {
                        allocator::give_back();
                        given_back = Instant::now();
                    }
                    while let Some(order) = inbox.next_short() {
                        done.obey_short(session, &order).into_iter().for_each(&self.tell);
                    }
                };
                let measured = session.measure_between(&scene, &measurement, &what.progress, &mut between);
                measured.map_err(|error| error.to_string()).map(|measured| {
                    left_out = measurement.choices;
                    left_out.retain(|choice| measured.iter().all(|row| row.choice != *choice));
                    Report::new(session.adapter().clone(), report_rows(&scene.name, size, &measured))
                })
            }
            _ => Err("the open scene was not rendered: mend what the error says, then measure again".to_owned()),
        };
        // Where it was cancelled, the window has asked for it.
        if !what.progress.is_cancelled() {
            (self.tell)(News::Measured { job: what.job, result, left_out });
        }
        (self.tell)(News::Idle);
    }
}

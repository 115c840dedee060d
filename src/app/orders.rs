//! What the window asks of the worker, and what of it still counts when the worker gets to it.

use crate::inspector::RunRequest;
use crate::progress::Progress;
use crate::session::StressSteps;
use crate::stress::{Case, Entrant, Row};
use crate::technique::Choice;
use std::sync::mpsc::Receiver;

/// Pictures of stress cases, but for those with a size of their own.
const STRESS_SIZE: [u32; 2] = [320, 240];

/// What the window asks for.
#[derive(Debug)]
pub enum Order {
    /// A built-in scene, or the path of a scene file, model or capture folder.
    Open(String),
    /// The open scene from its file again, run as it is now.
    Reload {
        /// How it is run.
        request: Box<RunRequest>,
    },
    /// The scene as it is run, into a file.
    SaveScene {
        /// The scene that is meant.
        generation: u64,
        /// How it is run.
        request: Box<RunRequest>,
        /// Where to.
        path: String,
        /// What is there may be replaced.
        replace: bool,
    },
    /// The scene of a stress case.
    OpenCase {
        /// Which case.
        case: &'static Case,
        /// The value of its number.
        value: f64,
        /// How its shadows are made; `None`: as before.
        entrant: Option<Entrant>,
    },
    /// Stress cases.
    Stress(Box<StressRun>),
    /// The open scene again, changed.
    Run {
        /// The scene that is meant.
        generation: u64,
        /// The change.
        request: Box<RunRequest>,
    },
    /// The open scene as another technique draws it, beside the frame that is shown.
    Compare {
        /// The scene that is meant.
        generation: u64,
        /// How.
        request: Box<RunRequest>,
    },
    /// How fragments of the frame that was captured last fared in the tests.
    Tests {
        /// The frame that is meant.
        frame: u64,
        /// Index of the step.
        step: usize,
        /// Index of the draw; `None`: all of the step.
        draw: Option<usize>,
    },
    /// The states after the draws of a step of the frame that was captured last.
    Draws {
        /// The frame that is meant.
        frame: u64,
        /// Index of the step.
        step: usize,
    },
    /// The truth of the frame that was captured last.
    Judge {
        /// The frame that is meant.
        frame: u64,
        /// Watched and stopped by the window.
        progress: Progress,
    },
    /// The history of a pixel of the frame that was captured last.
    History {
        /// The frame that is meant.
        frame: u64,
        /// Column and row.
        at: [u32; 2],
    },
    /// What the frame that was captured last is made of in space.
    Anatomy {
        /// The frame that is meant.
        frame: u64,
    },
    /// What can't be walked through in the open scene.
    Walls {
        /// The scene that is meant.
        generation: u64,
        /// Which objects are there, and when.
        request: Box<RunRequest>,
    },
    /// Techniques measured on the open scene, as it was captured last.
    Measure(Measure),
    /// Why the frame that was captured last is wrong.
    Diagnose {
        /// The frame that is meant.
        frame: u64,
        /// Tells one diagnosing from another.
        job: u64,
        /// Watched and stopped by the window.
        progress: Progress,
    },
}

/// Techniques to measure.
#[derive(Debug)]
pub struct Measure {
    /// The scene that is meant.
    pub generation: u64,
    /// Tells one measuring from another.
    pub job: u64,
    /// Techniques with their settings.
    pub choices: Vec<Choice>,
    /// Timed frames of each.
    pub runs: usize,
    /// Watched and stopped by the window.
    pub progress: Progress,
}

/// Stress cases to run, or what is left of them.
#[derive(Debug)]
pub struct StressRun {
    /// Told with the rows.
    pub job: u64,
    /// The rows to make.
    pub steps: StressSteps,
    /// The rows so far of the case that is under way.
    pub rows: Vec<Row>,
    /// Counts rows; watched and stopped by the window.
    pub progress: Progress,
}

impl StressRun {
    /// All of `cases`, but for what would keep the window waiting.
    #[must_use]
    pub fn new(job: u64, cases: &[&'static Case], progress: Progress) -> StressRun {
        let steps = StressSteps::new(cases, &[], STRESS_SIZE).without_heavy();
        progress.start(steps.left());
        StressRun { job, steps, rows: Vec::new(), progress }
    }
}

/// Orders that wait: of each sort only the newest counts.
#[derive(Debug, Default)]
pub struct Waiting {
    picture: Option<Order>,
    save: Option<Order>,
    walls: Option<Order>,
    draws: Option<Order>,
    history: Option<Order>,
    anatomy: Option<Order>,
    tests: Option<Order>,
    compare: Option<Order>,
    judge: Option<Order>,
    diagnose: Option<Order>,
    measure: Option<Order>,
    stress: Option<Order>,
}

impl Waiting {
    /// One more.
    pub fn add(&mut self, order: Order) {
        match order {
            Order::Draws { .. } => self.draws = Some(order),
            Order::History { .. } => self.history = Some(order),
            Order::Anatomy { .. } => self.anatomy = Some(order),
            Order::Tests { .. } => self.tests = Some(order),
            Order::Compare { .. } => self.compare = Some(order),
            Order::Judge { .. } => self.judge = Some(order),
            Order::Diagnose { .. } => self.diagnose = Some(order),
            Order::Measure(_) => self.measure = Some(order),
            Order::Walls { .. } => self.walls = Some(order),
            Order::Stress(_) => self.stress = Some(order),
            Order::SaveScene { .. } => self.save = Some(order),
            Order::Open(_) | Order::Reload { .. } | Order::OpenCase { .. } | Order::Run { .. } => {
                self.picture = Some(match self.picture.take() {
                    Some(earlier) => newest(earlier, order),
                    None => order,
                });
            }
        }
    }

    /// What is left of an order that was obeyed in part; a newer one of its sort counts instead.
    pub fn put_back(&mut self, rest: Box<StressRun>) {
        self.stress.get_or_insert(Order::Stress(rest));
    }

    /// The next that is about the frame that is shown and takes no longer than a frame; none while a
    /// new picture is waited for.
    pub fn next_short(&mut self) -> Option<Order> {
        let mut of_frame = || {
            self.draws
                .take()
                .or_else(|| self.history.take())
                .or_else(|| self.anatomy.take())
                .or_else(|| self.tests.take())
        };
        if self.picture.is_some() { None } else { of_frame() }
    }

    /// The next to obey: what is seen first, what is known of it later.
    pub fn next(&mut self) -> Option<Order> {
        // A scene is saved before it is changed.
        if self.save.is_some() {
            return self.save.take();
        }
        // The next picture is a step among them.
        if self.walls.is_some() {
            return self.walls.take();
        }
        let seen = self.picture.take().or_else(|| self.draws.take()).or_else(|| self.history.take());
        let seen = seen.or_else(|| self.anatomy.take()).or_else(|| self.tests.take());
        let seen = seen.or_else(|| self.compare.take());
        let of_frame = seen.or_else(|| self.judge.take()).or_else(|| self.diagnose.take());
        of_frame.or_else(|| self.measure.take()).or_else(|| self.stress.take())
    }
}

/// Where orders come in, and those that wait.
#[derive(Debug)]
pub struct Inbox<'a> {
    /// From the window.
    pub orders: &'a Receiver<Order>,
    /// Taken in, and not obeyed yet.
    pub waiting: Waiting,
}

impl Inbox<'_> {
    /// [`Waiting::next`], once all that came was taken in.
    pub fn next(&mut self) -> Option<Order> {
        self.take_in();
        self.waiting.next()
    }

    /// [`Waiting::next_short`], once all that came was taken in.
    pub fn next_short(&mut self) -> Option<Order> {
        self.take_in();
        self.waiting.next_short()
    }

    fn take_in(&mut self) {
        self.orders.try_iter().for_each(|order| self.waiting.add(order));
    }
}

/// Which of two orders in a row counts: opening wins over the runs around it, as those before
/// are of the old scene and those after were made before the window knew the new one.
fn newest(earlier: Order, later: Order) -> Order {
    match (&earlier, &later) {
        (Order::Open(_) | Order::Reload { .. } | Order::OpenCase { .. }, Order::Run { .. }) => earlier,
        _ => later,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::technique::Technique;

    fn run(width: u32) -> Order {
        let request = RunRequest {
            choice: Choice::new(Technique::ZFail),
            size: [width, 1],
            camera: crate::scene::Camera {
                eye: glam::DVec3::ZERO,
                target: glam::DVec3::X,
                up: glam::DVec3::Y,
                fov_y_degrees: 45.0,
                near: 0.1,
                far: None,
            },
            lights: Vec::new(),
            time: 0.0,
            off: std::collections::BTreeSet::new(),
        };
        Order::Run { generation: 1, request: Box::new(request) }
    }

    fn judge(frame: u64) -> Order {
        Order::Judge { frame, progress: Progress::default() }
    }

    fn waiting(orders: impl IntoIterator<Item = Order>) -> Waiting {
        let mut waiting = Waiting::default();
        orders.into_iter().for_each(|order| waiting.add(order));
        waiting
    }

    #[test]
    fn of_waiting_runs_the_newest_counts() {
        let order = waiting([run(1), run(2), run(3)]).next();
        assert!(matches!(order, Some(Order::Run { request, .. }) if request.size[0] == 3));
    }

    #[test]
    fn opening_is_not_lost_to_a_run_of_the_scene_before() {
        let order = waiting([run(1), Order::Open("table".to_owned()), run(2)]).next();
        assert!(matches!(order, Some(Order::Open(name)) if name == "table"));
    }

    #[test]
    fn draws_are_seen_before_a_truth_is_known_and_only_the_last_ones_count() {
        let draws = |step| Order::Draws { frame: 1, step };
        let mut waiting = waiting([judge(1), draws(1), draws(2)]);
        assert!(matches!(waiting.next(), Some(Order::Draws { step: 2, .. })));
        assert!(matches!(waiting.next(), Some(Order::Judge { .. })));
        assert!(waiting.next().is_none());
    }

    #[test]
    fn of_a_dragged_pick_only_the_newest_pixel_is_asked_about_and_before_all_long_work() {
        let history = |x: u32| Order::History { frame: 1, at: [x, 0] };
        let mut waiting = waiting([judge(1), history(1), history(2), history(3)]);
        assert!(matches!(waiting.next(), Some(Order::History { at: [3, 0], .. })));
        assert!(matches!(waiting.next(), Some(Order::Judge { .. })));
        assert!(waiting.next().is_none());
    }

    #[test]
    fn the_rest_of_the_stress_cases_comes_last_and_gives_way_to_a_newer_run() {
        let run = |job| Box::new(StressRun::new(job, &[], Progress::default()));
        let mut waiting = waiting([Order::Stress(run(2)), judge(1)]);
        waiting.put_back(run(1));
        assert!(matches!(waiting.next(), Some(Order::Judge { .. })));
        assert!(matches!(waiting.next(), Some(Order::Stress(run)) if run.job == 2));
        waiting.put_back(run(1));
        assert!(matches!(waiting.next(), Some(Order::Stress(run)) if run.job == 1));
    }

    #[test]
    fn between_steps_of_long_work_only_what_is_short_is_obeyed_and_nothing_of_a_frame_that_goes() {
        let history = || Order::History { frame: 1, at: [0, 0] };
        let mut still = waiting([judge(1), history(), Order::Draws { frame: 1, step: 1 }]);
        assert!(matches!(still.next_short(), Some(Order::Draws { .. })));
        assert!(matches!(still.next_short(), Some(Order::History { .. })));
        assert!(still.next_short().is_none(), "a truth takes long");
        assert!(matches!(still.next(), Some(Order::Judge { .. })));
        assert!(waiting([history(), run(1)]).next_short().is_none());
    }

    #[test]
    fn a_diagnosis_comes_after_the_truth_and_before_a_report() {
        let diagnose = |job| Order::Diagnose { frame: 1, job, progress: Progress::default() };
        let measure = Measure { generation: 1, job: 1, choices: Vec::new(), runs: 1, progress: Progress::default() };
        let mut waiting = waiting([Order::Measure(measure), diagnose(1), judge(1), diagnose(2)]);
        assert!(matches!(waiting.next(), Some(Order::Judge { .. })));
        assert!(matches!(waiting.next(), Some(Order::Diagnose { job: 2, .. })));
        assert!(matches!(waiting.next(), Some(Order::Measure(_))));
    }

    #[test]
    fn walls_are_known_before_the_next_step_among_them() {
        let walls = |generation| match run(1) {
            Order::Run { request, .. } => Order::Walls { generation, request },
            other => other,
        };
        let mut waiting = waiting([walls(1), run(1), walls(2)]);
        assert!(matches!(waiting.next(), Some(Order::Walls { generation: 2, .. })));
        assert!(matches!(waiting.next(), Some(Order::Run { .. })));
        assert!(waiting.next().is_none());
    }

    #[test]
    fn a_truth_is_not_lost_to_a_run_but_waits_for_it() {
        let mut waiting = waiting([judge(1), run(1), judge(2)]);
        assert!(matches!(waiting.next(), Some(Order::Run { .. })));
        assert!(matches!(waiting.next(), Some(Order::Judge { frame: 2, .. })));
        assert!(waiting.next().is_none());
    }
}

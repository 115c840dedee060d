//! The orders of the window to the worker, and which of them are still valid when the worker gets to them.

use super::task::ChannelReceiver;
use crate::ask::{PendingQuestion, QuestionKind, RunRequest};
use crate::stress::{Entrant, StressCase};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::mpsc::TryRecvError;

/// An order of the window to the worker.
#[derive(Debug)]
pub enum Order {
    /// Open a built-in scene, or the path of a scene file, model or capture folder.
    Open(String),
    /// Load the open scene from its file again, and run it as it is run now.
    Reload {
        /// How it is run.
        request: Box<RunRequest>,
    },
    /// Open the scene of a stress case.
    OpenCase {
        /// The case.
        case: &'static StressCase,
        /// The value of the case's number.
        value: f64,
        /// The technique and settings to use; `None`: those in use now.
        entrant: Option<Entrant>,
    },
    /// Run the open scene with changes.
    Run {
        /// Number of the scene that is meant.
        scene: u64,
        /// The changed request.
        request: Arc<RunRequest>,
        /// More changes are likely to follow at once, as while something is dragged.
        is_moving: bool,
    },
    /// Run whole what was shown as a preview, without waiting whether more changes follow.
    CompletePreview,
    /// Write the scene, as it is run, into a file.
    SaveScene {
        /// Number of the scene that is meant.
        scene: u64,
        /// How it is run.
        request: Box<RunRequest>,
        /// Path of the file.
        path: String,
        /// An existing file may be replaced.
        replace: bool,
    },
    /// Answer a question.
    Answer {
        /// Number of the scene that is meant.
        scene: u64,
        /// Number of the frame that is meant.
        frame: u64,
        /// The question.
        asked: PendingQuestion,
    },
}

/// Kinds of orders, the most urgent first: the newest of each kind replaces the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum OrderKind {
    /// Saving a scene, before it is changed.
    Save,
    /// A question on which the next picture depends.
    BeforePicture(QuestionKind),
    /// An order that leads to a new picture.
    Picture,
    /// The whole of what a picture was a preview of.
    WholePicture,
    /// A question about a frame or a scene that is shown.
    Question(QuestionKind),
}

impl Order {
    fn sort(&self) -> OrderKind {
        match self {
            Order::SaveScene { .. } => OrderKind::Save,
            Order::Open(_) | Order::Reload { .. } | Order::OpenCase { .. } | Order::Run { .. } => OrderKind::Picture,
            Order::CompletePreview => OrderKind::WholePicture,
            Order::Answer { asked, .. } if asked.ask.kind().is_urgent() => OrderKind::BeforePicture(asked.ask.kind()),
            Order::Answer { asked, .. } => OrderKind::Question(asked.ask.kind()),
        }
    }

    /// Returns whether this order is not replaced by a later one of its kind. Opening a scene is not replaced by a run:
    /// runs before it are of the old scene, and runs after it were asked for before the window knew the new one.
    fn outlasts(&self, later: &Order) -> bool {
        !matches!(self, Order::Run { .. }) && matches!(later, Order::Run { .. })
    }
}

/// Orders that wait, one a kind, in order of urgency: saving, questions that the next picture depends on, pictures,
/// whole ones after previews, other questions.
#[derive(Debug, Default)]
pub struct OrderQueue(BTreeMap<OrderKind, Order>);

impl OrderQueue {
    /// Adds an order in place of the waiting one of its kind; but a run that comes after an order to open a scene is
    /// dropped, as it was asked for before the window knew that scene.
    pub fn add(&mut self, order: Order) {
        let sort = order.sort();
        if sort != OrderKind::Picture || self.0.get(&sort).is_none_or(|earlier| !earlier.outlasts(&order)) {
            self.0.insert(sort, order);
        }
    }

    /// Puts an order back that was carried out in part, unless there is a newer one of its kind.
    pub fn restore_waiting(&mut self, rest: Order) {
        self.0.entry(rest.sort()).or_insert(rest);
    }

    /// Removes and returns the most urgent order, also a question that waits for quiet; `None` where no order waits.
    pub fn next(&mut self) -> Option<Order> {
        self.0.pop_first().map(|(_, order)| order)
    }

    /// Removes and returns the most urgent order; `None` where no order waits, or the most urgent one is a question
    /// that waits for quiet, which stays.
    pub fn next_now(&mut self) -> Option<Order> {
        let first = self.0.first_entry()?;
        (!matches!(first.key(), OrderKind::Question(kind) if kind.waits_for_quiet())).then(|| first.remove())
    }

    /// Takes the next order that long work is interrupted for; `None` while a new picture is waited for.
    pub fn next_short(&mut self) -> Option<Order> {
        // Saving a scene waits for the end of long work, and must not delay short orders.
        let first = *self.0.keys().find(|sort| **sort != OrderKind::Save)?;
        let is_short = matches!(first, OrderKind::Question(kind) if kind.is_short());
        is_short.then(|| self.0.remove(&first)).flatten()
    }

    /// Returns whether no order waits.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// The channel of the window's orders, and the orders that were received and wait.
#[derive(Debug)]
pub struct Inbox {
    /// Receives the window's orders.
    pub orders: ChannelReceiver<Order>,
    /// Orders that were received, and not carried out yet.
    pub queue: OrderQueue,
    /// The window is closed.
    pub is_closed: bool,
}

impl Inbox {
    /// Receives all orders, then does the same as [`OrderQueue::next_now`].
    pub fn next_now(&mut self) -> Option<Order> {
        self.take_in();
        self.queue.next_now()
    }

    /// Receives all orders, then does the same as [`OrderQueue::next_short`].
    pub fn next_short(&mut self) -> Option<Order> {
        self.take_in();
        self.queue.next_short()
    }

    fn take_in(&mut self) {
        loop {
            match self.orders.try_recv() {
                Ok(order) => self.queue.add(order),
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => {
                    self.is_closed = true;
                    return;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ask::{
        Ask, DiagnosisOf, DrawsOf, HistoryOf, ObjectChanges, ReportOf, StressOf, TimingOf, TruthOf, WallsOf,
    };
    use crate::progress::Progress;
    use crate::technique::{Choice, Technique};
    use std::collections::BTreeSet;

    fn request(width: u32) -> RunRequest {
        let scene = crate::scene::open(&crate::scene::OpenSpec::new("table")).expect("a built-in scene");
        RunRequest::of(&scene, Choice::new(Technique::ZFail), [width, 1])
    }

    fn run(width: u32) -> Order {
        Order::Run { scene: 1, request: Arc::new(request(width)), is_moving: false }
    }

    fn asked(ticket: u64, ask: impl Into<Ask>) -> Order {
        Order::Answer {
            scene: 1,
            frame: 1,
            asked: PendingQuestion { ticket, ask: ask.into(), progress: Progress::default() },
        }
    }

    fn queue(orders: impl IntoIterator<Item = Order>) -> OrderQueue {
        let mut queue = OrderQueue::default();
        orders.into_iter().for_each(|order| queue.add(order));
        queue
    }

    /// Tickets of the questions in the order in which they are answered; 0 for other orders.
    fn tickets(mut queue: OrderQueue) -> Vec<u64> {
        let orders = std::iter::from_fn(|| queue.next());
        orders.map(|order| if let Order::Answer { asked, .. } = order { asked.ticket } else { 0 }).collect()
    }

    fn history(x: u32) -> HistoryOf {
        HistoryOf { at: [x, 0] }
    }

    fn walls() -> WallsOf {
        WallsOf { off: BTreeSet::new(), objects: ObjectChanges::default(), time: 0.0 }
    }

    #[test]
    fn of_waiting_runs_the_newest_counts() {
        let order = queue([run(1), run(2), run(3)]).next();
        assert!(matches!(order, Some(Order::Run { request, .. }) if request.size[0] == 3));
    }

    #[test]
    fn opening_is_not_lost_to_a_run_of_the_scene_before() {
        let order = queue([run(1), Order::Open("table".to_owned()), run(2)]).next();
        assert!(matches!(order, Some(Order::Open(name)) if name == "table"));
    }

    #[test]
    fn draws_are_seen_before_a_truth_is_known_and_only_the_last_ones_count() {
        let queue = queue([asked(1, TruthOf {}), asked(2, DrawsOf { step: 1 }), asked(3, DrawsOf { step: 2 })]);
        assert_eq!(tickets(queue), [3, 1]);
    }

    #[test]
    fn of_a_dragged_pick_only_the_newest_pixel_is_asked_about_and_before_all_long_work() {
        let picks = (2..5).map(|ticket| asked(ticket, history(ticket as u32)));
        assert_eq!(tickets(queue([asked(1, TruthOf {})].into_iter().chain(picks))), [4, 1]);
    }

    #[test]
    fn the_rest_of_the_stress_cases_comes_last_and_gives_way_to_a_newer_run() {
        let stress = |ticket| asked(ticket, StressOf { cases: Vec::new() });
        let mut queue = queue([stress(2), asked(3, TruthOf {})]);
        queue.restore_waiting(stress(1));
        assert_eq!(tickets(queue), [3, 2]);
        let mut queue = OrderQueue::default();
        queue.restore_waiting(stress(1));
        assert_eq!(tickets(queue), [1]);
    }

    #[test]
    fn between_steps_of_long_work_only_what_is_short_is_obeyed_and_nothing_of_a_frame_that_goes() {
        let mut still = queue([asked(1, TruthOf {}), asked(2, history(0)), asked(3, DrawsOf { step: 1 })]);
        let short = |queue: &mut OrderQueue| match queue.next_short() {
            Some(Order::Answer { asked, .. }) => Some(asked.ticket),
            _ => None,
        };
        assert_eq!([short(&mut still), short(&mut still), short(&mut still)], [Some(3), Some(2), None]);
        assert_eq!(tickets(still), [1], "a truth takes long");
        assert!(queue([asked(2, history(0)), run(1)]).next_short().is_none());
    }

    #[test]
    fn a_diagnosis_comes_after_the_truth_and_before_a_report_and_the_clock_runs_when_nothing_is_asked() {
        let report = ReportOf { choices: Vec::new(), runs: 1 };
        let diagnosis = || DiagnosisOf { request: Box::new(request(1)) };
        let orders = [
            asked(5, TimingOf {}),
            asked(1, report),
            asked(2, diagnosis()),
            asked(3, TruthOf {}),
            asked(4, diagnosis()),
        ];
        let mut queue = queue(orders);
        for expected in [3, 4, 1] {
            assert!(matches!(queue.next_now(), Some(Order::Answer { asked, .. }) if asked.ticket == expected));
        }
        assert!(queue.next_now().is_none());
        assert_eq!(tickets(queue), [5]);
    }

    #[test]
    fn walls_are_known_before_the_next_step_among_them() {
        assert_eq!(tickets(queue([asked(1, walls()), run(1), asked(2, walls())])), [2, 0]);
    }

    #[test]
    fn what_was_let_go_is_run_whole_after_its_last_preview_and_before_long_work() {
        let mut queue = queue([asked(1, TruthOf {}), Order::CompletePreview, run(1)]);
        assert!(matches!(queue.next(), Some(Order::Run { .. })));
        assert!(queue.next_short().is_none());
        assert!(matches!(queue.next(), Some(Order::CompletePreview)));
        assert_eq!(tickets(queue), [1]);
    }

    #[test]
    fn a_truth_is_not_lost_to_a_run_but_waits_for_it() {
        assert_eq!(tickets(queue([asked(1, TruthOf {}), run(1), asked(2, TruthOf {})])), [0, 2]);
    }
}

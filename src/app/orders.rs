//! What the window asks of the worker, and what of it still counts when the worker gets to it.

use crate::inspector::RunRequest;
use crate::progress::Progress;
use crate::technique::Choice;

/// What the window asks for.
#[derive(Debug)]
pub enum Order {
    /// A built-in scene, or the path of a scene file, model or capture folder.
    Open(String),
    /// The open scene again, changed.
    Run {
        /// The scene that is meant.
        generation: u64,
        /// The change.
        request: Box<RunRequest>,
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
    /// Techniques measured on the open scene, as it was captured last.
    Measure(Measure),
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

/// Orders that wait: of each sort only the newest counts.
#[derive(Debug, Default)]
pub struct Waiting {
    picture: Option<Order>,
    draws: Option<Order>,
    judge: Option<Order>,
    measure: Option<Order>,
}

impl Waiting {
    /// One more.
    pub fn add(&mut self, order: Order) {
        match order {
            Order::Draws { .. } => self.draws = Some(order),
            Order::Judge { .. } => self.judge = Some(order),
            Order::Measure(_) => self.measure = Some(order),
            Order::Open(_) | Order::Run { .. } => {
                self.picture = Some(match self.picture.take() {
                    Some(earlier) => newest(earlier, order),
                    None => order,
                });
            }
        }
    }

    /// The next to obey: what is seen first, what is known of it later.
    pub fn next(&mut self) -> Option<Order> {
        let seen = self.picture.take().or_else(|| self.draws.take());
        seen.or_else(|| self.judge.take()).or_else(|| self.measure.take())
    }
}

/// Which of two orders in a row counts: opening wins over the runs around it, as those before
/// are of the old scene and those after were made before the window knew the new one.
fn newest(earlier: Order, later: Order) -> Order {
    match (&earlier, &later) {
        (Order::Open(_), Order::Run { .. }) => earlier,
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
    fn a_truth_is_not_lost_to_a_run_but_waits_for_it() {
        let mut waiting = waiting([judge(1), run(1), judge(2)]);
        assert!(matches!(waiting.next(), Some(Order::Run { .. })));
        assert!(matches!(waiting.next(), Some(Order::Judge { frame: 2, .. })));
        assert!(waiting.next().is_none());
    }
}

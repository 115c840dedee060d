//! When no frame is drawn, as a job has just begun: where a CPU draws the window, a frame would take its time from the
//! job, and show nothing of it.

use super::news::{News, WindowNews};
use std::time::Duration;
use web_time::Instant;

/// How long a job lasts before it is shown, unless something else is drawn.
pub const JOB_SHOWN_AFTER: Duration = Duration::from_millis(250);

/// The time in which nothing is drawn: from the beginning of a job until it has lasted a while, or until there is something
/// else to show.
#[derive(Debug, Default)]
pub struct QuietTime {
    until: Option<Instant>,
}

impl QuietTime {
    /// Takes in all news that have come since the last call, each with when it was sent. A quiet time that has begun, or
    /// has ended without a frame, is not made longer: jobs that follow each other quickly are shown, too.
    pub fn hear<'a>(&mut self, news: impl IntoIterator<Item = (Instant, &'a WindowNews)>) {
        let mut begun = None;
        let mut has_any = false;
        for (sent, one) in news {
            has_any = true;
            match one {
                WindowNews::Worker(News::Busy(_)) => begun = Some(sent),
                WindowNews::Worker(News::Idle) => begun = None,
                _ => {
                    self.until = None;
                    return;
                }
            }
        }
        match begun {
            Some(begun) => self.until = self.until.or(Some(begun + JOB_SHOWN_AFTER)),
            None if has_any => self.until = None,
            None => {}
        }
    }

    /// Returns whether there is one that no frame has ended, in which nothing may be drawn yet.
    pub fn is_on(&self) -> bool {
        self.until.is_some()
    }

    /// Returns how long nothing is to be drawn yet; `None` where a frame may be drawn.
    pub fn left(&self, now: Instant) -> Option<Duration> {
        self.until?.checked_duration_since(now).filter(|left| !left.is_zero())
    }

    /// Notes that a frame is drawn.
    pub fn end(&mut self) {
        self.until = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn busy() -> WindowNews {
        WindowNews::Worker(News::Busy("work".to_owned()))
    }

    #[test]
    fn a_job_is_quiet_from_its_beginning_on_and_not_for_ever() {
        let start = Instant::now();
        let after = |milliseconds| start + Duration::from_millis(milliseconds);
        let mut quiet = QuietTime::default();
        assert_eq!(quiet.left(start), None);
        // Heard later than it was sent.
        quiet.hear([(start, &busy())]);
        assert_eq!(quiet.left(after(100)), Some(Duration::from_millis(150)));
        assert_eq!(quiet.left(after(250)), None);
        // The next job begins before anything was drawn.
        quiet.hear([(after(200), &WindowNews::Worker(News::Idle)), (after(200), &busy())]);
        assert_eq!((quiet.left(after(260)), quiet.is_on()), (None, true));
        quiet.end();
        assert!(!quiet.is_on());
        quiet.hear([(after(300), &busy())]);
        assert_eq!(quiet.left(after(310)), Some(Duration::from_millis(240)));
    }

    #[test]
    fn what_is_to_be_shown_ends_it_also_beside_the_next_job() {
        let start = Instant::now();
        let chosen = |name: &str| WindowNews::Chosen(name.to_owned());
        let idle = || WindowNews::Worker(News::Idle);
        for news in [vec![chosen("tori")], vec![chosen("tori"), busy()], vec![idle()], vec![busy(), idle()]] {
            let mut quiet = QuietTime::default();
            quiet.hear([(start, &busy())]);
            assert!(quiet.left(start).is_some());
            quiet.hear([]);
            assert!(quiet.left(start).is_some(), "nothing was heard");
            quiet.hear(news.iter().map(|one| (start, one)));
            assert_eq!(quiet.left(start), None);
        }
    }
}

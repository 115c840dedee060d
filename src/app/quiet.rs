//! When no frame is drawn, as a job has just begun: where a CPU draws the window, a frame would take its time from the
//! job, and show nothing of it.

use super::news::{News, WindowNews};
use std::time::Duration;
use web_time::Instant;

/// How long a job lasts before it is shown, unless something else is drawn.
pub const JOB_SHOWN_AFTER: Duration = Duration::from_millis(250);
/// How long a job has after a frame that was drawn while it ran. Frames that followed each other at once would wait before
/// it in the GPU's queue, so that it lasted ever longer.
const BETWEEN_FRAMES: Duration = Duration::from_millis(300);

/// The time in which nothing is drawn: while a job runs, until it has lasted a while or there is something else to show.
#[derive(Debug, Default)]
pub struct QuietTime {
    /// When the job that runs began.
    running: Option<Instant>,
    /// Until when nothing is drawn while it runs. It is not put off by jobs that follow: they are shown, too.
    until: Option<Instant>,
    /// Something else is to be shown.
    has_news: bool,
}

impl QuietTime {
    /// Takes in all news that have come since the last call, each with when it was sent.
    pub fn hear<'a>(&mut self, news: impl IntoIterator<Item = (Instant, &'a WindowNews)>) {
        for (sent, one) in news {
            match one {
                WindowNews::Worker(News::Busy(_)) => {
                    self.running = Some(sent);
                    self.until = self.until.or(Some(sent + JOB_SHOWN_AFTER));
                }
                WindowNews::Worker(News::Idle) => self.running = None,
                _ => self.has_news = true,
            }
        }
    }

    /// Returns whether a frame waits until a job has lasted a while.
    pub fn is_on(&self) -> bool {
        self.running.is_some() && !self.has_news
    }

    /// Returns how long nothing is to be drawn yet; `None` where a frame may be drawn.
    pub fn left(&self, now: Instant) -> Option<Duration> {
        let until = self.until.filter(|_| self.is_on())?;
        until.checked_duration_since(now).filter(|left| !left.is_zero())
    }

    /// Notes that a frame is drawn.
    pub fn end(&mut self, now: Instant) {
        self.has_news = false;
        self.until = self.running.map(|began| (began + JOB_SHOWN_AFTER).max(now + BETWEEN_FRAMES));
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
        quiet.end(after(260));
        assert_eq!(quiet.left(after(300)), Some(Duration::from_millis(260)), "the job has its time between frames");
        quiet.hear([(after(300), &WindowNews::Worker(News::Idle)), (after(301), &busy())]);
        assert_eq!(quiet.left(after(310)), Some(Duration::from_millis(250)), "and the next job no more");
        quiet.hear([(after(320), &WindowNews::Worker(News::Idle))]);
        assert!(!quiet.is_on());
        quiet.end(after(330));
        quiet.hear([(after(400), &busy())]);
        assert_eq!(quiet.left(after(410)), Some(Duration::from_millis(240)));
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

    /// A picture that came while the next one was asked for is shown, and then the next one has its time.
    #[test]
    fn the_next_job_is_quiet_once_the_last_ones_picture_was_drawn() {
        let start = Instant::now();
        let idle = WindowNews::Worker(News::Idle);
        let mut quiet = QuietTime::default();
        quiet.hear([(start, &WindowNews::Chosen(String::new())), (start, &idle), (start, &busy())]);
        assert_eq!(quiet.left(start), None);
        quiet.end(start);
        assert_eq!(quiet.left(start), Some(BETWEEN_FRAMES));
    }
}

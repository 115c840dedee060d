//! Which techniques are right for a scene: each is run on it.

use super::{Measurement, Session, SessionError, median_ms};
use crate::diagnosis::Suited;
use crate::progress::Progress;
use crate::scene::Scene;

/// Frames of each technique that are timed.
const RUNS: usize = 3;

impl Session {
    /// Measures every candidate on a scene: the right ones first, of these the fastest. What can't draw the scene
    /// is left out.
    ///
    /// # Errors
    /// A scene that can't be traced; [`SessionError::Cancelled`].
    pub fn suited(&mut self, scene: &Scene, size: [u32; 2], progress: &Progress) -> Result<Vec<Suited>, SessionError> {
        self.traced(scene, size, progress)?;
        let choices = Suited::candidates();
        progress.start(choices.len());
        let mut suited = Vec::with_capacity(choices.len());
        for choice in choices {
            if progress.is_cancelled() {
                return Err(SessionError::Cancelled);
            }
            let what = Measurement { choices: vec![choice], size, runs: RUNS };
            // With a progress of its own: its steps are not these.
            let measured = match self.measure(scene, &what, &Progress::default()) {
                Ok(measured) => measured,
                Err(SessionError::Plan(_) | SessionError::Gpu(_)) => Vec::new(),
                Err(error) => return Err(error),
            };
            suited.extend(measured.into_iter().map(|one| Suited {
                wrong: one.error.wrong(),
                frame_ms: median_ms(&one.frames).unwrap_or(f64::INFINITY),
                choice: one.choice,
            }));
            progress.advance();
        }
        suited.sort_by(|a, b| a.wrong.cmp(&b.wrong).then(a.frame_ms.total_cmp(&b.frame_ms)));
        Ok(suited)
    }
}

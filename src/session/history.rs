//! The history of a pixel: geometry, the GPU's log and the stencil machine, joined.

use super::{Session, SessionError};
use crate::capture::Capture;
use crate::history::PixelHistory;
use crate::plan::FramePlan;

impl Session {
    /// Everything that happened to `pixel` in the frame of `plan`, which left `capture`.
    ///
    /// # Errors
    /// A pixel outside the picture; a lost GPU.
    pub fn history(
        &mut self,
        plan: &FramePlan,
        capture: &Capture,
        pixel: [u32; 2],
    ) -> Result<PixelHistory, SessionError> {
        let [width, height] = plan.size;
        if pixel[0] >= width || pixel[1] >= height {
            return Err(SessionError::NoSuchPixel { pixel, size: plan.size });
        }
        let covering = plan.covering(pixel);
        let log = self.executor.log_fragments(plan, pixel, &covering)?;
        Ok(PixelHistory::new(plan, capture, pixel, &covering, &log))
    }
}

//! The true count of shadow volumes, beyond what eight bits hold.

use super::{CaptureRequest, Session, SessionError};
use crate::capture::Capture;
use crate::gpu::GpuError;
use crate::scene::{Scene, TechniqueRequest};
use crate::technique::Choice;

impl Session {
    /// Fills in the signed count of each light's volumes where the technique counts them in the
    /// stencil: the same frame is run again with a float target. Leaves a capture as it is whose
    /// technique counts nothing, or on an adapter that can't blend floats.
    ///
    /// # Errors
    /// A scene or setting that can't be planned, a lost GPU.
    pub fn count(&mut self, scene: &Scene, capture: &mut Capture) -> Result<(), SessionError> {
        let request = TechniqueRequest { name: capture.technique.clone(), settings: capture.settings.clone() };
        let Some(choice) = Choice::parse(&request)?.counting_in_floats() else { return Ok(()) };
        let request = CaptureRequest::new(choice, capture.size);
        match self.capture(scene, &request) {
            Ok(counted) => {
                for (light, counted) in capture.lights.iter_mut().zip(counted.lights) {
                    light.count = counted.count;
                }
                Ok(())
            }
            Err(SessionError::Gpu(GpuError::MissingFeature { .. })) => Ok(()),
            Err(error) => Err(error),
        }
    }
}

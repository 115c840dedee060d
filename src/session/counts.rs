//! The true count of shadow volumes, beyond what eight bits can store.

use super::{CaptureRequest, Session, SessionError};
use crate::capture::{Capture, Image};
use crate::gpu::GpuError;
use crate::scene::{Scene, TechniqueRequest};
use crate::technique::Choice;
use std::sync::Arc;

impl Session {
    /// Returns the signed count of each light's volumes where the technique counts them in the stencil: the same frame
    /// is run again with a float target. `None` for each light of a technique that counts nothing, or on an adapter
    /// that can't blend floats.
    pub fn counts(&mut self, scene: &Scene, capture: &Capture) -> Result<Vec<Option<Arc<Image>>>, SessionError> {
        // Another program's frame can't be run with another counter.
        if capture.origin.is_some() {
            return Ok(Vec::new());
        }
        let request = TechniqueRequest { name: capture.technique.clone(), settings: capture.settings.clone() };
        let Some(choice) = Choice::parse(&request)?.counting_in_floats() else { return Ok(Vec::new()) };
        let request = CaptureRequest::new(choice, capture.size);
        match self.capture(scene, &request) {
            Ok(counted) => Ok(counted.lights.into_iter().map(|light| light.count).collect()),
            Err(SessionError::Gpu(GpuError::MissingFeature { .. })) => Ok(Vec::new()),
            Err(error) => Err(error),
        }
    }
}

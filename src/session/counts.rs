//! The true count of shadow volumes, beyond what eight bits can store.

use super::{AsyncSession, CaptureRequest, SessionError};
use crate::capture::{Capture, Image};
use crate::gpu::GpuError;
use crate::scene::{Scene, TechniqueRequest};
use crate::technique::Choice;
use std::sync::Arc;

impl AsyncSession {
    /// As [`Session::counts`](super::Session::counts).
    pub async fn counts(&mut self, scene: &Scene, capture: &Capture) -> Result<Vec<Option<Arc<Image>>>, SessionError> {
        // Another program's frame can't be run with another counter.
        if capture.origin.is_some() {
            return Ok(Vec::new());
        }
        let request = TechniqueRequest { name: capture.technique.clone(), settings: capture.settings.clone() };
        let Some(choice) = Choice::parse(&request)?.counting_in_floats() else { return Ok(Vec::new()) };
        let request = CaptureRequest::new(choice, capture.size);
        match self.capture(scene, &request).await {
            Ok(counted) => Ok(counted.lights.into_iter().map(|light| light.count).collect()),
            Err(SessionError::Gpu(GpuError::MissingFeature { .. })) => Ok(Vec::new()),
            Err(error) => Err(error),
        }
    }
}

//! A frame as a fault and a fix leave it: planned, drawn, and drawn with maps of other pictures.

use super::{AsyncSession, CaptureRequest, InjectedFault, SessionError};
use crate::capture::Capture;
use crate::diagnosis::Fix;
use crate::diagnosis::facts::MovedMap;
use crate::plan::FramePlan;
use crate::scene::{Camera, Scene};
use crate::technique::{self, Choice, PlanRequest};

/// A frame as a fault and a fix leave it.
pub(super) struct FixedFrame {
    pub scene: Scene,
    pub choice: Choice,
    pub plan: FramePlan,
    /// The plan as it is drawn, clipped where the adapter needs that.
    pub drawn: FramePlan,
}

impl AsyncSession {
    /// As [`Session::capture_fixed`](super::Session::capture_fixed).
    pub async fn capture_fixed(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
        fault: InjectedFault<'_>,
        fix: &Fix,
    ) -> Result<(Capture, FramePlan), SessionError> {
        let FixedFrame { scene, drawn, .. } = self.plan_fixed(scene, request, fault, fix, None).await?;
        Ok((self.capture_plan(&scene, &drawn).await?, drawn))
    }

    /// Plans the frame with the fault first, then the fix: what is wrong stays wrong unless the fix changes it. Returns
    /// the changed scene and choice too. Maps that follow the view are fitted to that of `map_camera`, where it is given.
    pub(super) async fn plan_fixed(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
        fault: InjectedFault<'_>,
        fix: &Fix,
        map_camera: Option<&Camera>,
    ) -> Result<FixedFrame, SessionError> {
        let (given, mut choice) = fault.applied(scene, &request.choice);
        let mut given = given.into_owned();
        fix.apply(&mut given, &mut choice)?;
        let size = fix.size(request.size);
        let job = PlanRequest { scene: &given, size, choice: &choice, cache: &mut self.geometry, map_camera };
        let fresh = technique::plan(job)?;
        let mut plan = fresh.clone();
        if let InjectedFault::Plan(change) = fault {
            change(&mut plan);
        }
        fix.edit(&mut plan, &fresh);
        let drawn = self.executor.clipped(plan.clone()).await?;
        Ok(FixedFrame { scene: given, choice, plan, drawn })
    }

    /// Draws the frame, with the fault and then the fix, once with maps fitted to the view of each of these cameras.
    pub(super) async fn moved_maps(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
        fault: InjectedFault<'_>,
        fix: &Fix,
        cameras: &[Camera],
    ) -> Result<Vec<MovedMap>, SessionError> {
        let mut moved = Vec::with_capacity(cameras.len());
        for camera in cameras {
            let FixedFrame { plan, drawn, .. } = self.plan_fixed(scene, request, fault, fix, Some(camera)).await?;
            let ready = self.executor.prepare_once(&drawn).await?;
            let labels = self.executor.labels(ready).await?;
            moved.push(MovedMap { plan, labels, moved: camera.eye.distance(scene.camera.eye) });
        }
        Ok(moved)
    }
}

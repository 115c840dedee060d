//! Frames compared with the truth: their labels, and their pictures with the one that the truth lights.

use super::SessionError;
use super::truth::TracedScene;
use crate::accuracy::{self, ErrorCounts, VisibilityError};
use crate::capture::{Image, LightTargets};
use crate::geometry::GeometryCache;
use crate::gpu::{Executor, Prepared, work_parts};
use crate::scene::Scene;
use crate::technique::{self, Choice, PlanRequest};
use std::sync::Arc;

/// Reference pictures of one scene: one for each way to shade it.
pub(super) struct ReferencePictures<'a> {
    scene: &'a Scene,
    traced: &'a TracedScene,
    pictures: Vec<(Choice, Arc<Image>)>,
}

/// The wrong labels and wrong colours of a frame.
pub(super) struct FrameError {
    /// Errors of labels, summed over lights.
    pub labels: ErrorCounts,
    /// How far the visibility of all lights together is from the truth's; `None` where the technique knows no shares.
    pub visibility: Option<VisibilityError>,
    /// Pixels of another colour than the reference picture's.
    pub wrong_color: u64,
}

impl<'a> ReferencePictures<'a> {
    /// Returns the references of a scene and its truth; each picture is computed when it is first used.
    pub fn new(scene: &'a Scene, traced: &'a TracedScene) -> ReferencePictures<'a> {
        ReferencePictures { scene, traced, pictures: Vec::new() }
    }

    /// Runs a choice's frame, untimed, and returns how its labels, summed over lights, and its colours differ from the
    /// truth; lights without labels are not counted.
    pub async fn judge(
        &mut self,
        executor: &mut Executor,
        choice: &Choice,
        ready: Prepared<'_>,
    ) -> Result<FrameError, SessionError> {
        let answer = executor.answer(ready).await?;
        let right = self.picture(executor, choice).await?;
        let of_lights = || answer.of_lights.iter().enumerate();
        let (mut counts, mut findings) = (Vec::new(), Vec::new());
        for (light, labels) in of_lights().filter_map(|(light, of)| Some((light, of.labels.as_ref()?))) {
            let judged = self.traced.compare(executor, light, labels).await;
            counts.push(judged.counts);
            findings.push(judged.findings);
        }
        let [picture, right] = [&answer.picture, &right].map(|image| image.rows().collect::<Vec<&[u8]>>());
        let TracedScene { tracer, truth, step, .. } = self.traced;
        let mut wrong_color = 0;
        for part in work_parts(picture.len(), 1) {
            executor.yield_now().await;
            wrong_color += accuracy::wrong_colors_in(tracer, truth, &findings, [&picture, &right], *step, part);
        }
        let of_light = |(light, of): (usize, &LightTargets)| {
            Some(VisibilityError::of(&truth.labels[light], &of.visibility.as_ref()?.values()))
        };
        let visibility: Vec<VisibilityError> = of_lights().filter_map(of_light).collect();
        Ok(FrameError {
            labels: counts.into_iter().sum(),
            visibility: VisibilityError::of_all(visibility),
            wrong_color,
        })
    }

    /// Returns the scene lit by the truth's labels, in the shading of `choice`; cached for choices with the same
    /// shading.
    async fn picture(&mut self, executor: &mut Executor, choice: &Choice) -> Result<Arc<Image>, SessionError> {
        let choice = choice.truth_in_same_shading();
        if let Some((_, picture)) = self.pictures.iter().find(|(known, _)| *known == choice) {
            return Ok(picture.clone());
        }
        let TracedScene { truth, .. } = self.traced;
        let job = PlanRequest {
            scene: self.scene,
            size: truth.size,
            choice: &choice,
            cache: &mut GeometryCache::default(),
            map_camera: None,
        };
        let plan = executor.clipped(technique::plan_of_labels(job, &truth.labels)?).await?;
        let ready = executor.prepare_apart(&plan).await?;
        let picture = executor.answer(ready).await?.picture;
        self.pictures.push((choice, picture.clone()));
        Ok(picture)
    }
}

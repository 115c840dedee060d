//! The ground truth of a scene, cached while nothing that it depends on changes.

use super::{AsyncSession, SessionError};
use crate::accuracy::{self, Accuracy, VisibilityError};
use crate::capture::{Capture, CapturedLight, CapturedTruth, FrameTruth, Image, PixelFormat, VisibilityTruth};
use crate::diagnosis::TruthCoverage;
use crate::gpu::{Executor, work_parts};
use crate::plan::LightId;
use crate::progress::Progress;
use crate::recorded::{MapReading, StoredSurfaces, outside_cone};
use crate::scene::{Camera, Pose, Scene};
use crate::truth::{BACKGROUND, LIT, SHADOW, TILE, Tracer, TracerBuilder, Truth};
use glam::{DVec2, DVec3, DVec4};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;
use web_time::Instant;

/// A scene's ray tracer and the truth that it found for one picture, with what they depend on.
#[derive(Debug)]
pub(super) struct TracedScene {
    key: TruthKey,
    pub tracer: Tracer,
    pub truth: Truth,
    /// The step that corners snap to on the session's adapter, pixels: what lies so near to an edge is excused.
    pub step: f64,
}

/// What a picture shows of a scene: nothing else has a truth. The default is all of it.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct ShownSurfaces {
    /// Distance at which view rays end, metres.
    far: Option<f64>,
    /// What another program's picture stores for each light; `None` where it is not known, and empty for our own.
    stored: Vec<Option<StoredSurfaces>>,
    /// For each light of another program, which pixels its map does not cover, where that leaves open what lights them.
    outside: Vec<Option<Vec<bool>>>,
}

impl ShownSurfaces {
    /// Returns what a capture shows. What lies beyond another program's far plane is not in its picture, nor is what
    /// something that is not known hides.
    fn of(capture: &Capture) -> ShownSurfaces {
        if capture.origin.is_none() {
            return ShownSurfaces::default();
        }
        let stored = (0..capture.lights.len()).map(|light| StoredSurfaces::of(capture, light)).collect();
        let outside = (0..capture.lights.len()).map(|light| outside_cone(capture, LightId(light))).collect();
        ShownSurfaces { far: capture.depth.far, stored, outside }
    }

    /// Takes out of a truth what the picture does not show.
    fn keep(&self, tracer: &Tracer, truth: &mut Truth) {
        if self.stored.iter().all(Option::is_none) {
            return;
        }
        let distances = tracer.distances();
        for (labels, stored) in truth.labels.iter_mut().zip(&self.stored) {
            let Some(stored) = stored else { continue };
            let unknown = labels.iter_mut().zip(stored.known(&distances)).filter(|(_, is_known)| !is_known);
            unknown.for_each(|(label, _)| *label = BACKGROUND);
        }
        for (labels, outside) in truth.labels.iter_mut().zip(&self.outside) {
            let outside = labels.iter_mut().zip(outside.iter().flatten()).filter(|(_, is_outside)| **is_outside);
            outside.for_each(|(label, _)| *label = BACKGROUND);
        }
    }
}

/// All that a truth depends on: a scene with an equal key is not traced again.
#[derive(Debug, Clone, PartialEq)]
struct TruthKey {
    size: [u32; 2],
    camera: Camera,
    shown: ShownSurfaces,
    lights: Vec<DVec4>,
    objects: Vec<ObjectKey>,
}

#[derive(Debug, Clone, PartialEq)]
struct ObjectKey {
    mesh: u64,
    pose: Pose,
    casts: bool,
    receives: bool,
    visible: bool,
    light_positions: BTreeMap<usize, DVec4>,
}

impl TruthKey {
    fn new(scene: &Scene, size: [u32; 2], shown: ShownSurfaces) -> TruthKey {
        let objects = scene.objects.iter().map(|object| ObjectKey {
            mesh: object.mesh.content_hash(),
            pose: object.pose,
            casts: object.casts,
            receives: object.receives,
            visible: object.visible,
            light_positions: object.light_positions.clone(),
        });
        let lights = scene.lights.iter().map(|light| light.position);
        TruthKey { size, camera: scene.camera, shown, lights: lights.collect(), objects: objects.collect() }
    }
}

impl AsyncSession {
    /// As [`Session::truth`](super::Session::truth).
    pub async fn truth(
        &mut self,
        scene: &Scene,
        capture: &Capture,
        progress: &Progress,
    ) -> Result<FrameTruth, SessionError> {
        let traced = self.traced_for(scene, capture, progress).await?;
        // Of a frame of our own all is known.
        let coverage = if capture.origin.is_some() { traced.coverage(capture) } else { Vec::new() };
        if let Some(first) = coverage.first().filter(|_| coverage.iter().all(TruthCoverage::is_too_little)) {
            return Err(SessionError::TooLittleCompared(*first));
        }
        let size = capture.size;
        let mut lights = Vec::with_capacity(capture.lights.len());
        for (index, light) in capture.lights.iter().enumerate() {
            if progress.is_cancelled() {
                return Err(SessionError::Cancelled);
            }
            let is_too_little = coverage.get(index).is_some_and(TruthCoverage::is_too_little);
            let Some(shadow) = light.shadow.as_ref().filter(|_| !is_too_little) else {
                lights.push(None);
                continue;
            };
            let Accuracy { counts, findings, worst } = traced.compare(&self.executor, index, shadow).await;
            let image = |bytes: Vec<u8>| Arc::new(Image::packed(PixelFormat::U8, size, bytes));
            let truth = &traced.truth.labels[index];
            let visibility = light.visibility.as_ref().map(|visibility| visibility_truth(truth, visibility));
            let labels = image(truth.clone());
            lights.push(Some(CapturedTruth { labels, findings: image(findings), error: counts, worst, visibility }));
        }
        // Where eight bits read a count of 256 as none, the truth alone would not explain it.
        Ok(FrameTruth { size, lights, counts: self.counts(scene, capture).await? })
    }

    /// As [`Session::judged`](super::Session::judged).
    pub async fn judged(
        &mut self,
        scene: &Scene,
        capture: &Capture,
        progress: &Progress,
    ) -> Result<Capture, SessionError> {
        Ok(capture.with_truth(&self.truth(scene, capture, progress).await?))
    }

    /// Returns the truth of a scene at a size, traced unless it is the last one traced.
    pub(super) async fn traced(
        &mut self,
        scene: &Scene,
        size: [u32; 2],
        progress: &Progress,
    ) -> Result<Arc<TracedScene>, SessionError> {
        self.traced_between(scene, size, ShownSurfaces::default(), progress, &mut async |_| ()).await
    }

    /// Returns the truth that a capture is compared with, traced unless it is the last one traced: of what it shows.
    pub(super) async fn traced_for(
        &mut self,
        scene: &Scene,
        capture: &Capture,
        progress: &Progress,
    ) -> Result<Arc<TracedScene>, SessionError> {
        self.traced_between(scene, capture.size, ShownSurfaces::of(capture), progress, &mut async |_| ()).await
    }

    /// Returns the truth of what a capture shows of another scene than its own; it does not take the place of the last one
    /// traced.
    pub(super) async fn traced_apart(
        &mut self,
        scene: &Scene,
        capture: &Capture,
        progress: &Progress,
    ) -> Result<Arc<TracedScene>, SessionError> {
        let own = self.traced.take();
        let traced = self.traced_for(scene, capture, progress).await;
        self.traced = own;
        traced
    }

    /// Returns the truth of what is shown of a scene, traced in parts with a call of `between` before each. Where it is
    /// the last one traced, it is not traced again, and `between` is not called.
    pub(super) async fn traced_between(
        &mut self,
        scene: &Scene,
        size: [u32; 2],
        shown: ShownSurfaces,
        progress: &Progress,
        between: &mut impl AsyncFnMut(&mut AsyncSession),
    ) -> Result<Arc<TracedScene>, SessionError> {
        let key = TruthKey::new(scene, size, shown);
        if let Some(traced) = self.traced.as_ref().filter(|traced| traced.key == key) {
            return Ok(traced.clone());
        }
        let mut builder = TracerBuilder::new(scene, size)?;
        for part in work_parts(builder.hierarchy_count(), 1) {
            self.executor.yield_now().await;
            if progress.is_cancelled() {
                return Err(SessionError::Cancelled);
            }
            builder.build_next(part.len());
        }
        let tracer = builder.finish().ending_at(key.shown.far);
        let mut truth = self.trace(&tracer, progress, between).await?;
        key.shown.keep(&tracer, &mut truth);
        let step = self.executor.profile().await?.subpixel();
        Ok(self.traced.insert(Arc::new(TracedScene { key, tracer, truth, step })).clone())
    }

    /// Traces the truth in parts, before each of which it gives way and calls `between`.
    pub(super) async fn trace(
        &mut self,
        tracer: &Tracer,
        progress: &Progress,
        between: &mut impl AsyncFnMut(&mut AsyncSession),
    ) -> Result<Truth, SessionError> {
        let lights = tracer.lights();
        let mut truth = tracer.begin(&lights, progress);
        for rows in work_parts(tracer.size()[1] as usize, TILE) {
            self.executor.yield_now().await;
            between(self).await;
            tracer.trace_rows(rows, &lights, &mut truth, progress).ok_or(SessionError::Cancelled)?;
        }
        Ok(truth)
    }
}

/// Measured times of tracing the truth of a scene, one of each kind for each run.
#[derive(Debug, Clone, PartialEq)]
pub struct TruthCost {
    /// Sorting the scene's triangles as the eye and each light see them.
    pub sorting: Vec<Duration>,
    /// Following rays.
    pub following: Vec<Duration>,
    /// How many rays are followed each time.
    pub rays: u64,
}

/// Times the truth of a scene `runs` times, after a warm-up; it takes no GPU.
pub fn truth_cost(scene: &Scene, size: [u32; 2], runs: usize) -> Result<TruthCost, SessionError> {
    let mut cost = TruthCost { sorting: Vec::new(), following: Vec::new(), rays: 0 };
    for run in 0..=runs {
        let start = Instant::now();
        let tracer = Tracer::new(scene, size)?;
        let sorting = start.elapsed();
        let truth = tracer.trace(&Progress::default()).ok_or(SessionError::Cancelled)?;
        if run > 0 {
            cost.following.push(start.elapsed() - sorting);
            cost.sorting.push(sorting);
        }
        cost.rays = Tracer::rays(&truth);
    }
    Ok(cost)
}

/// Returns the true visibility for the truth's labels of a light, and how far a technique's is from it.
fn visibility_truth(labels: &[u8], visibility: &Image) -> VisibilityTruth {
    let share = |label: &u8| f32::from(u8::from(*label == LIT)).to_le_bytes();
    let bytes: Vec<u8> = labels.iter().flat_map(share).collect();
    VisibilityTruth {
        image: Arc::new(Image::packed(PixelFormat::Value32F, visibility.size(), bytes)),
        error: VisibilityError::of(labels, &visibility.values()),
    }
}

impl TracedScene {
    /// Returns how much of a capture's labels is compared with this truth, for each light.
    pub fn coverage(&self, capture: &Capture) -> Vec<TruthCoverage> {
        let of_light = |(index, (light, truth)): (usize, (&CapturedLight, &Vec<u8>))| {
            let own = light.shadow.as_ref().map(|labels| labels.rows().flatten().copied().collect::<Vec<u8>>());
            let outside = self.key.shown.outside.get(index).and_then(Option::as_deref);
            TruthCoverage::of_labels(truth, own.as_deref(), outside)
        };
        capture.lights.iter().zip(&self.truth.labels).enumerate().map(of_light).collect()
    }

    /// Returns whether a pixel whose right label is another than a map gives it is wrong only by the size of the map's texels: on
    /// the plane that it shows, the faces of casters that the map keeps make the middle of its texel what the map says, and the
    /// pixel itself right. `kept` says which those are, towards the light or away from it; `None` is both.
    pub fn is_of_texels(
        &self,
        reading: &MapReading<'_>,
        light: LightId,
        kept: Option<bool>,
        at: [u32; 2],
        right: u8,
    ) -> bool {
        let Some(seen) = self.tracer.seen_at(at.map(|side| f64::from(side) + 0.5)) else { return false };
        let label = |point: DVec3| {
            let hits = self.tracer.between_in_plane(light.0, &seen, point);
            let is_dark = hits.iter().any(|hit| kept.is_none_or(|towards| hit.faces_light == towards));
            if is_dark { SHADOW } else { LIT }
        };
        // What the truth of a pixel may be off by, its texel's may, too.
        let sides = [-accuracy::LABEL_REACH, accuracy::LABEL_REACH];
        let corners = sides.into_iter().flat_map(|x| sides.map(|y| DVec2::new(x, y)));
        let mut points =
            std::iter::once(DVec2::ZERO).chain(corners).filter_map(|beside| reading.texel_point(at, beside));
        label(seen.point) == right && points.any(|point| label(point) != right)
    }

    /// Compares the labels of the light with this index with the truth, pixel by pixel, and gives way meanwhile.
    pub async fn compare(&self, executor: &Executor, light: usize, labels: &Image) -> Accuracy {
        let TracedScene { tracer, truth, step, .. } = self;
        let rows: Vec<&[u8]> = labels.rows().collect();
        let mut findings = Vec::with_capacity(truth.labels[light].len());
        for part in work_parts(rows.len(), 1) {
            executor.yield_now().await;
            findings.extend(accuracy::findings_in(tracer, truth, light, &rows, *step, part));
        }
        Accuracy::of(findings, truth.size)
    }
}

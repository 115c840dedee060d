//! Error against run time: several techniques on one scene, timed in turn.

use super::reference::{FrameError, ReferencePictures};
use super::truth::ShownSurfaces;
use super::{AsyncSession, CaptureRequest, SessionError, median, milliseconds};
use crate::accuracy::{ErrorCounts, VisibilityError};
use crate::geometry::GeometryCache;
use crate::gpu::AttachmentPool;
use crate::math::angle;
use crate::plan::FramePlan;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::technique::{self, Choice, PlanRequest};
use glam::DVec3;
use std::time::Duration;
use web_time::Instant;

/// Bytes of GPU memory that choices may take together while others are timed, without the attachments that all of them
/// share. A software GPU's memory is this program's own.
const CACHED_BYTES: u64 = 128 << 20;

/// How many frames of a choice are timed one after the other before it is the next one's turn.
const FRAMES_IN_A_TURN: usize = 3;

/// The inputs of a measurement of techniques on one scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Techniques with their settings.
    pub choices: Vec<Choice>,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Frames of each choice that are timed, in turns of a few after one that is not.
    pub runs: usize,
}

named_enum! {
    /// Which part of the scene moves from frame to frame.
    pub enum MovingPart {
        /// What the scene's file or code moves.
        Scene = "scene",
        /// Its first light alone, about the vertical axis through the point that the camera looks at.
        Light = "light",
        /// The eye alone, about the same axis.
        Eye = "eye",
        /// What the scene moves, its first light and the eye.
        Everything = "everything",
        /// Nothing: what was set up for the first frame serves the others.
        Nothing = "nothing",
    }
}

/// Speed of orbiting lights and eyes, degrees per second.
const DEGREES_PER_SECOND: f64 = 10.0;

impl MovingPart {
    /// Returns the scene `seconds` after the start with only this part moved; light and eye are rotated about the
    /// vertical axis through the camera's target at a constant speed.
    fn at(self, scene: &Scene, seconds: f64) -> Scene {
        let moves_all = self == MovingPart::Everything;
        let mut moved = scene.at(if self == MovingPart::Scene || moves_all { seconds } else { 0.0 });
        let turn = angle::rotation(DVec3::Y, (seconds * DEGREES_PER_SECOND).to_radians());
        let target = moved.camera.target;
        if self == MovingPart::Eye || moves_all {
            moved.camera.eye = target + turn * (moved.camera.eye - target);
        }
        if let Some(light) = moved.lights.first_mut().filter(|_| self == MovingPart::Light || moves_all) {
            let middle = target * light.position.w;
            light.position = (middle + turn * (light.position.truncate() - middle)).extend(light.position.w);
        }
        moved
    }
}

/// The frames of a moving scene that are measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionFrames {
    /// What moves.
    pub moves: MovingPart,
    /// Seconds after the start: the frame before those that count.
    pub from: f64,
    /// Seconds after the start: the last frame.
    pub to: f64,
    /// The number of frames that count, in even steps.
    pub frames: usize,
}

impl MotionFrames {
    /// Returns the times, in seconds, of the frames that count: even steps after `from`, up to `to`.
    fn all(self) -> impl Iterator<Item = f64> {
        let MotionFrames { from, to, frames, .. } = self;
        (1..=frames).map(move |frame| from + (to - from) * frame as f64 / frames as f64)
    }
}

/// The measured error and frame times of one technique.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredTechnique {
    /// Technique and settings.
    pub choice: Choice,
    /// Errors of labels, summed over lights.
    pub error: ErrorCounts,
    /// How far the lights' visibility is from the truth's, over all lights and frames together; `None` where the
    /// technique knows no shares.
    pub visibility: Option<VisibilityError>,
    /// Pixels whose colour differs from the picture that the truth lights in the same shading, background included: see
    /// [`wrong_colors`](crate::accuracy::wrong_colors).
    pub wrong_color: u64,
    /// Wall times of frames without capture: recording, submitting, waiting.
    pub frames: Vec<Duration>,
    /// Median of the GPU's time for the frame's passes, measured in frames of their own before
    /// the others; `None` where the hardware can't measure it.
    pub gpu_ms: Option<f64>,
    /// Time of planning, geometry, pipelines and uploads for this technique.
    pub setup_ms: f64,
    /// Set-up times of the frames of a moving scene, one for each of `frames`; empty where nothing moves.
    pub setups: Vec<Duration>,
    /// The number of triangles submitted in a frame.
    pub triangles: u64,
    /// Bytes of GPU memory for attachments, vertices and indices.
    pub bytes: u64,
}

impl AsyncSession {
    /// As [`Session::measure`](super::Session::measure).
    pub async fn measure(
        &mut self,
        scene: &Scene,
        what: &Measurement,
        progress: &Progress,
    ) -> Result<Vec<MeasuredTechnique>, SessionError> {
        self.measured(scene, what, progress, false, &mut async |_, _| ()).await
    }

    /// As [`Session::measure_between`](super::Session::measure_between).
    pub async fn measure_between(
        &mut self,
        scene: &Scene,
        what: &Measurement,
        progress: &Progress,
        between: &mut impl AsyncFnMut(&mut AsyncSession, &[MeasuredTechnique]),
    ) -> Result<Vec<MeasuredTechnique>, SessionError> {
        self.measured(scene, what, progress, true, between).await
    }

    /// Measures every choice. `between` is given what is measured so far: where it `shows_first`, of each choice one frame
    /// is timed before those that count.
    async fn measured(
        &mut self,
        scene: &Scene,
        what: &Measurement,
        progress: &Progress,
        shows_first: bool,
        between: &mut impl AsyncFnMut(&mut AsyncSession, &[MeasuredTechnique]),
    ) -> Result<Vec<MeasuredTechnique>, SessionError> {
        let mut while_tracing = async |session: &mut AsyncSession| between(session, &[]).await;
        let shown = ShownSurfaces::default();
        let traced = self.traced_between(scene, what.size, shown, progress, &mut while_tracing).await?;
        let mut go_on = async |session: &mut AsyncSession, so_far: &[MeasuredTechnique]| {
            session.executor.yield_now().await;
            between(session, so_far).await;
            if progress.is_cancelled() { Err(SessionError::Cancelled) } else { Ok(()) }
        };
        progress.start(what.choices.len() * (what.runs + 1));
        let mut reference = ReferencePictures::new(scene, &traced);
        let mut measured = Vec::with_capacity(what.choices.len());
        // For each row, the index of its choice, and what only it keeps in the GPU's memory.
        let mut items = Vec::with_capacity(what.choices.len());
        for (item, choice) in what.choices.iter().enumerate() {
            progress.turn_to(item);
            go_on(self, &measured).await?;
            let row = self.first_frame(scene, what, choice, &mut reference, shows_first).await?;
            let steps = if row.is_some() { 1 } else { 1 + what.runs };
            if let Some(FirstFrame { measured: row, own_bytes }) = row {
                items.push((item, own_bytes));
                measured.push(row);
            }
            (0..steps).for_each(|_| progress.advance());
        }
        let own_bytes: Vec<u64> = items.iter().map(|(_, own_bytes)| *own_bytes).collect();
        let plans = self.kept_plans(scene, what.size, &measured, &own_bytes).await?;
        let mut targets = AttachmentPool::shared();
        let mut prepared_frames = Vec::with_capacity(plans.len());
        for plan in &plans {
            go_on(self, &measured).await?;
            prepared_frames.push(match plan {
                Some(plan) => Some(self.executor.prepare_in_turn(plan, &mut targets).await?),
                None => None,
            });
        }
        let mut gpu: Vec<Vec<f64>> = vec![Vec::with_capacity(what.runs); plans.len()];
        for turn in (0..what.runs).step_by(FRAMES_IN_A_TURN) {
            for (index, ((item, _), prepared_frames)) in items.iter().zip(&prepared_frames).enumerate() {
                progress.turn_to(*item);
                go_on(self, &measured).await?;
                let row = &mut measured[index];
                if turn == 0 {
                    // What was timed of the first frame stood in for these.
                    row.frames.clear();
                }
                let (plan, made);
                let ready = match prepared_frames {
                    Some(ready) => ready,
                    None => {
                        plan = self.plan(scene, &CaptureRequest::new(row.choice.clone(), what.size)).await?;
                        made = self.executor.prepare_in_turn(&plan, &mut targets).await?;
                        // Work that only a first frame does is done in a frame that does not count.
                        self.executor.time(&made, false).await?;
                        &made
                    }
                };
                // Nor does the frame after another choice's count, whose data the processor still holds.
                gpu[index].extend(self.executor.gpu_ms(ready).await?);
                for _ in turn..what.runs.min(turn + FRAMES_IN_A_TURN) {
                    row.frames.push(self.executor.time(ready, false).await?);
                    progress.advance();
                }
            }
        }
        for (row, gpu) in measured.iter_mut().zip(gpu) {
            row.gpu_ms = median(gpu);
        }
        Ok(measured)
    }

    /// As [`Session::measure_moving`](super::Session::measure_moving).
    pub async fn measure_moving(
        &mut self,
        scene: &Scene,
        what: &Measurement,
        motion: MotionFrames,
        progress: &Progress,
    ) -> Result<Vec<MeasuredTechnique>, SessionError> {
        progress.start(what.choices.len() * (motion.frames + 1));
        let first = motion.moves.at(scene, motion.from);
        let traced = self.traced(&first, what.size, &Progress::default()).await?;
        let mut reference = ReferencePictures::new(&first, &traced);
        let mut moving = Vec::with_capacity(what.choices.len());
        for (item, choice) in what.choices.iter().enumerate() {
            progress.turn_to(item);
            if let Some(FirstFrame { measured, .. }) =
                self.first_frame(&first, what, choice, &mut reference, false).await?
            {
                let measured =
                    MeasuredTechnique { error: ErrorCounts::default(), visibility: None, wrong_color: 0, ..measured };
                moving.push((item, measured, GeometryCache::default()));
            }
            progress.advance();
        }
        // What stays valid is cached before the first frame that counts.
        let mut plans = Vec::with_capacity(moving.len());
        for (_, measured, cache) in &mut moving {
            let plan = technique::plan(PlanRequest {
                scene: &first,
                size: what.size,
                choice: &measured.choice,
                cache,
                map_camera: None,
            })?;
            let plan = self.drawable(plan, &measured.choice).await?;
            let ready = self.executor.prepare(&plan).await?;
            self.executor.time(&ready, false).await?;
            plans.push(plan);
        }
        for (turn, seconds) in motion.all().enumerate() {
            let scene = motion.moves.at(scene, seconds);
            let traced = self.traced(&scene, what.size, &Progress::default()).await?;
            let mut reference = ReferencePictures::new(&scene, &traced);
            // The frame just before may slow a frame: each time begins with another choice, every other one backwards.
            let mut order: Vec<usize> = (0..moving.len()).collect();
            order.rotate_left(turn % moving.len().max(1));
            if turn % 2 == 1 {
                order.reverse();
            }
            for index in order {
                let ((item, measured, cache), prepared_frames) = (&mut moving[index], &plans[index]);
                progress.turn_to(*item);
                if progress.is_cancelled() {
                    return Err(SessionError::Cancelled);
                }
                // Each frame is timed after another frame, not after ray tracing.
                let before = self.executor.prepare(prepared_frames).await?;
                self.executor.time(&before, false).await?;
                let mut made = None;
                let ready = if motion.moves == MovingPart::Nothing {
                    measured.setups.push(Duration::ZERO);
                    before
                } else {
                    drop(before);
                    let start = Instant::now();
                    let plan = technique::plan(PlanRequest {
                        scene: &scene,
                        size: what.size,
                        choice: &measured.choice,
                        cache,
                        map_camera: None,
                    })?;
                    let plan = made.insert(self.drawable(plan, &measured.choice).await?);
                    let ready = self.executor.prepare(plan).await?;
                    measured.setups.push(start.elapsed());
                    ready
                };
                measured.frames.push(self.executor.time(&ready, false).await?);
                let FrameError { labels, visibility, wrong_color } =
                    reference.judge(&mut self.executor, &measured.choice, ready).await?;
                measured.error = [measured.error, labels].into_iter().sum();
                let visibilities = [measured.visibility, visibility].into_iter().flatten().collect();
                measured.visibility = VisibilityError::of_all(visibilities);
                measured.wrong_color += wrong_color;
                if let Some(made) = made {
                    plans[index] = made;
                }
                progress.advance();
            }
        }
        Ok(moving.into_iter().map(|(_, measured, _)| measured).collect())
    }

    /// Sets a choice up from nothing and judges its first frame, of which another is timed where `is_timed`; `None` where it
    /// is left out. Nothing is cached from
    /// one choice to the next, so that none profits from the set-up of another.
    async fn first_frame(
        &mut self,
        scene: &Scene,
        what: &Measurement,
        choice: &Choice,
        reference: &mut ReferencePictures<'_>,
        is_timed: bool,
    ) -> Result<Option<FirstFrame>, SessionError> {
        self.executor.forget();
        let cache = &mut GeometryCache::default();
        let start = Instant::now();
        let plan = technique::plan(PlanRequest { scene, size: what.size, choice, cache, map_camera: None })?;
        if self.memory_budget.is_some_and(|most| plan.bytes() > most) {
            return Ok(None);
        }
        let plan = self.drawable(plan, choice).await?;
        let (triangles, bytes) = (plan.triangles(), plan.bytes());
        let own_bytes = bytes.saturating_sub(AttachmentPool::shared_bytes(&plan));
        let ready = self.executor.prepare(&plan).await?;
        let setup_ms = milliseconds(start.elapsed());
        let mut frames = Vec::with_capacity(what.runs);
        if is_timed && what.runs > 0 {
            // The first of two also compiles.
            self.executor.time(&ready, false).await?;
            frames.push(self.executor.time(&ready, false).await?);
        }
        let FrameError { labels, visibility, wrong_color } = reference.judge(&mut self.executor, choice, ready).await?;
        let measured = MeasuredTechnique {
            choice: choice.clone(),
            error: labels,
            visibility,
            wrong_color,
            frames,
            gpu_ms: None,
            setup_ms,
            setups: Vec::new(),
            triangles,
            bytes,
        };
        Ok(Some(FirstFrame { measured, own_bytes }))
    }

    /// Returns, for each choice, the plan that stays set up for all of its frames: those with the fewest bytes of their
    /// own, until [`CACHED_BYTES`] are used; `None` for the others.
    async fn kept_plans(
        &mut self,
        scene: &Scene,
        size: [u32; 2],
        measured: &[MeasuredTechnique],
        own_bytes: &[u64],
    ) -> Result<Vec<Option<FramePlan>>, SessionError> {
        let mut kept: Vec<Option<FramePlan>> = measured.iter().map(|_| None).collect();
        let mut smallest_first: Vec<usize> = (0..measured.len()).collect();
        smallest_first.sort_by_key(|index| own_bytes[*index]);
        let mut left = CACHED_BYTES;
        for index in smallest_first {
            let Some(rest) = left.checked_sub(own_bytes[index]) else { break };
            left = rest;
            let request = CaptureRequest::new(measured[index].choice.clone(), size);
            kept[index] = Some(self.plan(scene, &request).await?);
        }
        Ok(kept)
    }
}

/// A choice after its first frame, of which at most one frame is timed, in place of those that count.
struct FirstFrame {
    measured: MeasuredTechnique,
    /// Bytes of GPU memory that no other choice's frame can share.
    own_bytes: u64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    /// Each part moves alone as it does with everything, of which nothing is left behind.
    #[test]
    fn everything_is_what_the_scene_moves_and_its_light_and_the_eye() {
        for builtin in builtin::ALL {
            let scene = builtin.scene().expect("a scene");
            let start = scene.at(0.0);
            let [all, scenes, light, eye, nothing] =
                [MovingPart::Everything, MovingPart::Scene, MovingPart::Light, MovingPart::Eye, MovingPart::Nothing]
                    .map(|part| part.at(&scene, 1.5));
            assert_eq!(nothing, start, "{}", builtin.name);
            assert_eq!(scenes, scene.at(1.5), "{}", builtin.name);
            assert_eq!(all.objects, scenes.objects, "{}", builtin.name);
            assert_eq!(all.camera, eye.camera, "{}", builtin.name);
            assert_eq!(all.lights, MovingPart::Light.at(&scenes, 1.5).lights, "{}", builtin.name);
            assert_eq!((&light.objects, light.camera), (&start.objects, start.camera), "{}", builtin.name);
            assert_eq!((&eye.objects, &eye.lights), (&start.objects, &start.lights), "{}", builtin.name);
            assert!(eye.camera != start.camera, "{}", builtin.name);
            // A light straight above what the camera looks at stays there.
            let away = start.lights[0].position - start.camera.target.extend(1.0) * start.lights[0].position.w;
            assert!(light.lights != start.lights || (away.x, away.z) == (0.0, 0.0), "{}", builtin.name);
        }
    }
}

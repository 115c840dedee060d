//! The history of a pixel: geometry, the GPU's log and the stencil machine, joined.

use super::{AsyncSession, CaptureRequest, SessionError};
use crate::capture::Capture;
use crate::history::PixelHistory;
use crate::plan::FramePlan;
use crate::scene::Scene;
use std::time::Duration;
use web_time::Instant;

/// Measured times of computing pixel histories.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct HistoryCost {
    /// Plain frames, for comparison.
    pub frames: Vec<Duration>,
    /// The first history, including all that is computed only once.
    pub first: Duration,
    /// The others, one for each pixel.
    pub histories: Vec<Duration>,
    /// For each history: finding the triangles over the pixel.
    pub geometry: Vec<Duration>,
    /// For each history: the GPU's log of their fragments.
    pub logs: Vec<Duration>,
    /// The number of events of all histories together.
    pub events: usize,
    /// The number of events of the longest history.
    pub most_events: usize,
    /// True where all of them agree with what the GPU stored.
    pub all_agree: bool,
}

impl AsyncSession {
    /// As [`Session::history`](super::Session::history).
    pub async fn history(
        &mut self,
        plan: &FramePlan,
        capture: &Capture,
        pixel: [u32; 2],
    ) -> Result<PixelHistory, SessionError> {
        Ok(self.timed_history(plan, capture, pixel).await?.0)
    }

    /// As [`Session::history_cost`](super::Session::history_cost).
    pub async fn history_cost(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
        count: usize,
    ) -> Result<HistoryCost, SessionError> {
        let frames = self.capture_cost(scene, request, 5).await?.frames;
        let (capture, plan) =
            self.capture_with_plan(scene, &CaptureRequest { timing_runs: 0, ..request.clone() }).await?;
        let mut cost = HistoryCost { frames, all_agree: true, ..HistoryCost::default() };
        for index in 0..=count {
            let start = Instant::now();
            let (history, [geometry, log]) = self.timed_history(&plan, &capture, spread(index, plan.size)).await?;
            let took = start.elapsed();
            cost.all_agree &= history.agrees() || history.unknown_discard().is_some();
            if index == 0 {
                cost.first = took;
                continue;
            }
            cost.events += history.events.len();
            cost.most_events = cost.most_events.max(history.events.len());
            cost.histories.push(took);
            cost.geometry.push(geometry);
            cost.logs.push(log);
        }
        Ok(cost)
    }

    /// Returns the history of a pixel with the times of finding triangles and of the GPU's log; an error where the
    /// pixel is outside the picture.
    async fn timed_history(
        &mut self,
        plan: &FramePlan,
        capture: &Capture,
        pixel: [u32; 2],
    ) -> Result<(PixelHistory, [Duration; 2]), SessionError> {
        let [width, height] = plan.size;
        if pixel[0] >= width || pixel[1] >= height {
            return Err(SessionError::NoSuchPixel { pixel, size: plan.size });
        }
        let start = Instant::now();
        let covering = plan.covering(pixel);
        let geometry = start.elapsed();
        let log = self.executor.log_fragments(plan, pixel, &covering, covering.len() as u32).await?;
        let times = [geometry, start.elapsed() - geometry];
        Ok((PixelHistory::new(plan, capture, pixel, &covering, &log), times))
    }
}

/// Returns a sequence of pixels without a pattern that a picture could have too (Roberts 2018, the plastic number's
/// sequence).
pub(super) fn spread(index: usize, size: [u32; 2]) -> [u32; 2] {
    let at = |step: f64, pixels: u32| (((0.5 + step * index as f64).fract()) * f64::from(pixels)) as u32;
    [at(0.754_877_666_246_692_8, size[0]), at(0.569_840_290_998_053_2, size[1])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::LoggedFragment;
    use crate::scene::{Light, Object, SceneBuilder, builtin, shapes};
    use crate::technique::{Choice, Technique};
    use pollster::block_on;

    /// A log that is too small counts on, and is run again with space for all.
    #[test]
    fn a_full_log_grows() {
        let slab =
            |up: f64| Object::of("slab", shapes::cuboid([1.0, 0.1, 1.0]).expect("a box")).at([0.0, up, 0.0]).unseen();
        let scene = SceneBuilder::new("three slabs")
            .object(Object::of("floor", shapes::quad([20.0; 2]).expect("a floor")))
            .objects([1.0, 1.5, 2.0].map(slab))
            .light(Light::point([0.0, 4.0, 0.0]))
            .seen_from([0.0, 10.0, 0.0], [0.0; 3])
            .build();
        let mut session = block_on(AsyncSession::new(None)).expect("the reference adapter");
        let request = CaptureRequest::new(Choice::new(Technique::ZFail), [65, 65]);
        let plan = block_on(session.plan(&scene, &request)).expect("a plan");
        let covering = plan.covering([32, 32]);
        let mut log = |capacity: u32| {
            block_on(session.executor.log_fragments(&plan, [32, 32], &covering, capacity)).expect("a log")
        };
        let whole = log(covering.len() as u32);
        assert_eq!(whole.counted as usize, whole.fragments.len());
        assert!(whole.fragments.len() > 6, "{whole:?}");
        assert_eq!(log(1), whole);
    }

    /// Returns how many fragments a pixel has, and how far the depths that the CPU's rasteriser computes are at most from
    /// those that the GPU logs.
    ///
    /// # Panics
    /// If the two see other triangles, or other sides of them.
    fn compared(session: &mut AsyncSession, plan: &FramePlan, pixel: [u32; 2], place: &str) -> (usize, f32) {
        let steps = 1 << block_on(session.profile()).expect("a profile").subpixel_bits;
        let covering = plan.covering(pixel);
        let logged = block_on(session.executor.log_fragments(plan, pixel, &covering, 64)).expect("a log").fragments;
        let computed = plan.fragments(pixel, &covering, steps).fragments;
        let faces = |log: &[LoggedFragment]| -> Vec<(usize, bool)> {
            log.iter().map(|fragment| (fragment.covering, fragment.is_front)).collect()
        };
        assert_eq!(faces(&logged), faces(&computed), "{place}");
        let off = |(a, b): (&LoggedFragment, &LoggedFragment)| (a.depth - b.depth).abs();
        (logged.len(), logged.iter().zip(&computed).map(off).fold(0.0, f32::max))
    }

    /// The CPU's rasteriser makes the GPU's log: the same triangles, seen from the same side. Where the GPU draws
    /// triangles as they are given, depths are equal to the bit, except that one pixel in a thousand may be off by what a
    /// corner's last place does.
    #[test]
    fn the_fragments_of_a_pixel_are_those_that_the_gpu_logs() {
        let mut session = block_on(AsyncSession::new(None)).expect("the reference adapter");
        let is_exact = block_on(session.profile()).expect("a profile").exact_range().coarse_step.is_none();
        let rounding = if is_exact { 1e-8 } else { 4e-6 };
        let mut rounded = Vec::new();
        let (mut pixels, mut fragments) = (0, 0);
        for builtin in builtin::ALL {
            let scene = builtin.scene().expect("a scene");
            for technique in Technique::rivals() {
                let request = CaptureRequest::new(Choice::new(technique), [160, 120]);
                let plan = block_on(session.plan(&scene, &request)).expect("a plan");
                for pixel in (0..40).map(|index| spread(index, plan.size)) {
                    let place = format!("{} by {} at {pixel:?}", builtin.name, technique.name());
                    let (count, most) = compared(&mut session, &plan, pixel, &place);
                    assert!(most <= rounding, "{place}: {most}");
                    (pixels, fragments) = (pixels + 1, fragments + count);
                    rounded.extend((most > 0.0).then_some(place));
                }
            }
        }
        assert!(pixels > 4000 && fragments > 100_000, "{pixels} pixels, {fragments} fragments");
        assert!(!is_exact || rounded.len() * 1000 <= pixels, "{} of {pixels}: {rounded:?}", rounded.len());
    }

    /// A logged depth has the draw's bias, which is a hundred times what depths may be off by: its constant part, its
    /// part by slope, and its clamp. Of a triangle that is clipped the unit of the constant part is that of a corner that
    /// not every GPU looks at, so there the clamp decides.
    #[test]
    fn a_logged_depth_has_the_bias_of_its_draw() {
        let mut session = block_on(AsyncSession::new(None)).expect("the reference adapter");
        let is_exact = block_on(session.profile()).expect("a profile").exact_range().coarse_step.is_none();
        let scene = builtin::ALL[0].scene().expect("a scene");
        let request = CaptureRequest::new(Choice::new(Technique::ZFail), [160, 120]);
        let unbiased = block_on(session.plan(&scene, &request)).expect("a plan");
        let biases = [(0, -400.0, 0.0), (1 << 24, 0.0, 1e-3), (-(1 << 24), 0.0, -1e-3), (1 << 20, 0.0, 0.0)];
        for (constant, slope_scale, clamp) in biases.into_iter().take(if is_exact { 4 } else { 3 }) {
            let mut plan = unbiased.clone();
            for draw in plan.passes.iter_mut().flat_map(|pass| &mut pass.draws) {
                draw.raster.depth_bias = wgpu_types::DepthBiasState { constant, slope_scale, clamp };
            }
            let mut moved = 0;
            for pixel in (0..40).map(|index| spread(index, plan.size)) {
                let place = format!("{constant}, {slope_scale}, {clamp} at {pixel:?}");
                let (_, most) = compared(&mut session, &plan, pixel, &place);
                assert!(most <= 4e-6, "{place}: {most}");
                let covering = plan.covering(pixel);
                let depths = |plan: &FramePlan| plan.fragments(pixel, &covering, 256).fragments;
                let pairs = depths(&plan).into_iter().zip(depths(&unbiased));
                moved += { pairs }.filter(|(biased, plain)| (biased.depth - plain.depth).abs() > 4e-4).count();
            }
            assert!(moved > 100, "{constant}, {slope_scale}, {clamp}: {moved}");
        }
    }
}

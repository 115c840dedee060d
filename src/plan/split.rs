//! A frame split into one pass a draw, so that a snapshot after each pass is one after each draw: of the whole frame,
//! or of one of its passes.

use super::{ColorTarget, DepthStencilTarget, FramePlan, Pass};

impl FramePlan {
    /// Returns the plan with each pass split into one pass for each draw, so that the state after every draw can be
    /// read back. The first part clears what the pass clears, the others load what is stored. Caching of maps is off.
    pub fn split_at_draws(&self) -> FramePlan {
        self.split_where(|_| true)
    }

    /// Returns the plan of the frame up to and including pass `index`, with that pass split into one for each of its
    /// draws (the first clears, the others load) and caching of maps off. Passes after it are left out.
    pub fn split_pass_at_draws(&self, index: usize) -> FramePlan {
        let mut plan = self.split_where(|pass| pass == index);
        let parts = self.passes.get(index).map_or(0, |pass| pass.draws.len().max(1));
        plan.passes.truncate(index + parts);
        plan
    }

    fn split_where(&self, is_split: impl Fn(usize) -> bool) -> FramePlan {
        let parts = |(index, pass)| if is_split(index) { split(pass) } else { vec![pass.clone()] };
        let passes = self.passes.iter().enumerate().flat_map(parts).collect();
        let mut plan = FramePlan { passes, ..self.clone() };
        // A cached map would not be drawn, and its draws left nothing to see.
        plan.lights.iter_mut().filter_map(|light| light.map.as_mut()).for_each(|map| map.is_cached = false);
        plan
    }
}

fn split(pass: &Pass) -> Vec<Pass> {
    if pass.draws.len() < 2 {
        return vec![pass.clone()];
    }
    let part = |(index, draw): (usize, &super::Draw)| {
        let is_first = index == 0;
        let color = pass
            .color
            .as_ref()
            .map(|target| ColorTarget { clear: target.clear.filter(|_| is_first), ..target.clone() });
        let depth_stencil = pass.depth_stencil.as_ref().map(|target| DepthStencilTarget {
            clear_depth: target.clear_depth.filter(|_| is_first),
            clear_stencil: target.clear_stencil.filter(|_| is_first),
            ..target.clone()
        });
        let recorded = pass.recorded.clone().map(|mut recorded| {
            recorded.start = recorded.start.take().filter(|_| is_first);
            recorded
        });
        Pass { color, depth_stencil, recorded, draws: vec![draw.clone()], ..pass.clone() }
    };
    pass.draws.iter().enumerate().map(part).collect()
}

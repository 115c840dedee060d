//! The same frame with one pass a draw, so that a snapshot after each pass is one after each draw.

use super::{ColorTarget, DepthStencilTarget, FramePlan, Pass};

impl FramePlan {
    /// Splits every pass at its draws: the first part clears what the pass clears, the others keep
    /// what is there. The pictures after the last part of a pass are those after the pass. A pass
    /// of one draw, or of none, stays as it is.
    #[must_use]
    pub fn split_at_draws(&self) -> FramePlan {
        let passes = self.passes.iter().flat_map(split).collect();
        FramePlan { passes, ..self.clone() }
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
        Pass { color, depth_stencil, draws: vec![draw.clone()], ..pass.clone() }
    };
    pass.draws.iter().enumerate().map(part).collect()
}

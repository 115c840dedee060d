//! A render pass: its view, its targets and what they are cleared to, and its draws.

use super::draw::Draw;
use super::ids::{AttachmentId, LightId, ViewId};
use super::{CpuImage, RecordedPass, Viewport};
use serde::{Deserialize, Serialize};

/// One render pass: its targets, its view and its draws.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pass {
    /// A short name, lower case: `ambient`, `volumes`, `light`.
    pub name: String,
    /// One sentence that explains the pass to a learner.
    pub purpose: String,
    /// The light that it belongs to; `None` for the scene's own passes.
    pub light: Option<LightId>,
    /// Whether its time counts for the frame; that of mask passes does not.
    pub timed: bool,
    /// The view that it is drawn from.
    pub view: ViewId,
    /// Colour target, if any.
    pub color: Option<ColorTarget>,
    /// Depth-stencil target, if any.
    pub depth_stencil: Option<DepthStencilTarget>,
    /// Scissor rectangle: left, top, columns, rows. Draws change nothing outside of it; clears do.
    pub scissor: Option<[u32; 4]>,
    /// Draws in order.
    pub draws: Vec<Draw>,
    /// Where in its targets its draws go, and between which depths; `None` for all of them, from 0 to 1. Not of a recorded
    /// pass, which has its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub viewport: Option<Viewport>,
    /// A picture computed on the CPU that goes into its colour target in place of draws. Capture folders store it as an
    /// array.
    #[serde(skip)]
    pub image: Option<CpuImage>,
    /// Further data of a pass of another program's frame; `None` for our own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recorded: Option<Box<RecordedPass>>,
}

impl Pass {
    /// Returns whether a pixel lies within the pass's scissor rectangle; always true without one.
    pub fn reaches(&self, [x, y]: [u32; 2]) -> bool {
        let holds = |[left, top, columns, rows]: [u32; 4]| {
            (left..left.saturating_add(columns)).contains(&x) && (top..top.saturating_add(rows)).contains(&y)
        };
        self.scissor.is_none_or(holds)
    }

    /// Makes the scissor rectangle its part within an area (left, top, columns, rows); empty where they don't meet.
    pub(crate) fn restrict_to(&mut self, area: [u32; 4]) {
        let [left, top, columns, rows] = self.scissor.unwrap_or(area);
        let common = |[start, length]: [u32; 2], [other, of_other]: [u32; 2]| {
            let first = start.max(other);
            let end = start.saturating_add(length).min(other.saturating_add(of_other));
            [first.min(end), end.saturating_sub(first)]
        };
        let [x, y] = [common([left, columns], [area[0], area[2]]), common([top, rows], [area[1], area[3]])];
        self.scissor = Some([x[0], y[0], x[1], y[1]]);
    }

    /// Returns whether the pass counts, from the light, the volumes around the near plane, with which z-pass-plus
    /// begins.
    pub fn counts_at_near_plane(&self) -> bool {
        self.view != ViewId(0) && self.draws.iter().any(|draw| draw.part.is_of_volume())
    }

    /// Returns the viewport of the pass's draws: the whole target of `size` texels unless it has another.
    pub fn viewport(&self, size: [u32; 2]) -> Viewport {
        self.own_viewport().unwrap_or_else(|| Viewport::whole(size))
    }

    /// Returns the viewport that is set for the pass's draws; `None` where that is the whole target.
    pub fn own_viewport(&self) -> Option<Viewport> {
        self.recorded.as_ref().map(|recorded| recorded.viewport).or(self.viewport)
    }
}

/// The colour target of a pass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ColorTarget {
    /// The attachment that is drawn into.
    pub attachment: AttachmentId,
    /// The layer that is drawn into.
    pub layer: u32,
    /// Value that it is cleared to at the start (linear RGBA, or a label in the first component); `None` loads what is
    /// stored.
    pub clear: Option<[f64; 4]>,
}

/// The depth-stencil target of a pass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DepthStencilTarget {
    /// The attachment that is tested and drawn into.
    pub attachment: AttachmentId,
    /// The layer that is tested and drawn into.
    pub layer: u32,
    /// Depth that it is cleared to at the start; `None` loads what is stored.
    pub clear_depth: Option<f32>,
    /// Stencil value that it is cleared to at the start; `None` loads what is stored.
    pub clear_stencil: Option<u8>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_restricted_to_an_area_keeps_what_both_hold() {
        let restricted = |scissor, area| {
            let mut pass = Pass {
                name: String::new(),
                purpose: String::new(),
                light: None,
                timed: true,
                view: ViewId(0),
                color: None,
                depth_stencil: None,
                scissor,
                draws: Vec::new(),
                image: None,
                viewport: None,
                recorded: None,
            };
            pass.restrict_to(area);
            pass.scissor
        };
        assert_eq!(restricted(None, [1, 2, 3, 4]), Some([1, 2, 3, 4]));
        assert_eq!(restricted(Some([2, 0, 9, 3]), [1, 2, 3, 4]), Some([2, 2, 2, 1]));
        let apart = restricted(Some([0, 0, 1, 1]), [5, 5, 2, 2]).map(|[_, _, columns, rows]| [columns, rows]);
        assert_eq!(apart, Some([0, 0]), "nothing is drawn where the two don't meet");
    }
}

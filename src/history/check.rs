//! Compares a history with what the GPU stored, and checks it against itself: a list with an event dropped, doubled or
//! moved is found out.

use super::{CapturedAfter, FragmentOutcome, PixelEvent, PixelEventKind, PixelHistory, PixelValues};
use crate::numbers;
use crate::stencil_machine::DepthStencil;
use std::fmt;

/// A way in which a pixel's history contradicts the GPU: a bug of this program or of the driver.
#[derive(Debug, Clone, PartialEq)]
pub enum Disagreement {
    /// The GPU made a fragment where geometry says there can be none, or none where there must be one.
    Geometry {
        /// Index of the pass.
        pass: usize,
        /// Name of the draw.
        draw: String,
        /// Which of its triangles.
        primitive: u32,
        /// True where a fragment must exist and does not; false where one exists and can't.
        is_missing: bool,
    },
    /// The number of listed fragments differs from the number that the GPU counted.
    Counted {
        /// Fragments that the GPU counted.
        counted: u32,
        /// Number of those in the list.
        listed: u32,
    },
    /// The number of listed events without a fragment differs from what plan and geometry require.
    WithoutFragment {
        /// Number of clears and of culled and clipped triangles that there must be.
        expected: u32,
        /// Number of those in the list.
        listed: u32,
    },
    /// An event is out of the API's order: it is not after the one before it.
    Order {
        /// Index of the event.
        event: usize,
    },
    /// An event's values before it are not those that the previous event left.
    Chain {
        /// Index of the event.
        event: usize,
    },
    /// The capture has no depth to compare with.
    NotCaptured,
    /// The values that the GPU stored after a pass differ from those that the events lead to.
    Stored {
        /// Index of the pass.
        pass: usize,
        /// The values that the events lead to.
        computed: PixelValues,
        /// The values that the GPU stored.
        captured: CapturedAfter,
    },
}

impl fmt::Display for Disagreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Disagreement::Geometry { pass, draw, primitive, is_missing } => {
                let what =
                    if *is_missing { "left no fragment, but covers the pixel" } else { "left a fragment, but can't" };
                write!(f, "pass {}, {draw}: triangle {} {what}", pass + 1, primitive + 1)
            }
            Disagreement::Counted { counted, listed } => {
                write!(f, "the GPU counted {counted} fragments, and {listed} are listed")
            }
            Disagreement::WithoutFragment { expected, listed } => {
                write!(f, "there are {expected} clears, culled and clipped triangles, and {listed} are listed")
            }
            Disagreement::Order { event } => write!(f, "event {} is out of order", event + 1),
            Disagreement::Chain { event } => {
                write!(f, "event {} does not begin with what the one before it left", event + 1)
            }
            Disagreement::NotCaptured => f.write_str("the capture holds no depth to compare with"),
            Disagreement::Stored { pass, computed, captured } => {
                let DepthStencil { depth, stencil } = captured.stored;
                write!(
                    f,
                    "after pass {} the events make depth {:?} and stencil {}",
                    pass + 1,
                    computed.depth,
                    numbers::signed(computed.stencil)
                )?;
                if let Some(count) = captured.count {
                    return write!(
                        f,
                        ", count {}; the GPU stored {depth:?}, {} and {count}",
                        computed.count,
                        numbers::signed(stencil)
                    );
                }
                write!(f, "; the GPU stored {depth:?} and {}", numbers::signed(stencil))
            }
        }
    }
}

impl PixelHistory {
    /// Returns every contradiction between this history and the GPU: numbers of fragments, order and chain of events,
    /// and captured values. Empty where they agree; a pixel without captured values counts as a contradiction.
    pub fn disagreements(&self) -> Vec<Disagreement> {
        let mut found = self.contradictions.clone();
        let is_fragment = |outcome: FragmentOutcome| {
            matches!(outcome, FragmentOutcome::Tested { .. } | FragmentOutcome::Discarded(_))
        };
        let listed = self.triangles().filter(|(_, one)| is_fragment(one.outcome)).count() as u32;
        if listed != self.counted {
            found.push(Disagreement::Counted { counted: self.counted, listed });
        }
        let without = self.events.len() as u32 - listed;
        if without != self.without_fragment {
            found.push(Disagreement::WithoutFragment { expected: self.without_fragment, listed: without });
        }
        for (index, pair) in self.events.windows(2).enumerate() {
            let event = index + 1;
            if !is_before(&pair[0], &pair[1]) {
                found.push(Disagreement::Order { event });
            }
            if pair[0].after != pair[1].before {
                found.push(Disagreement::Chain { event });
            }
        }
        if self.captured.is_none() {
            found.push(Disagreement::NotCaptured);
        }
        found.extend(self.captured_after.iter().filter_map(|captured| self.differs(captured)));
        found
    }

    fn differs(&self, captured: &CapturedAfter) -> Option<Disagreement> {
        let last = self.events.iter().rev().find(|event| event.pass <= captured.pass);
        let computed = last.map_or(self.start, |event| event.after);
        let is_near = || (computed.depth - captured.stored.depth).abs() <= self.depth_rounding;
        let same_bits = computed.depth.to_bits() == captured.stored.depth.to_bits();
        let same_depth = same_bits || (self.depth_rounding > 0.0 && is_near());
        let same_stencil = !self.has_stencil || computed.stencil == captured.stored.stencil;
        let same_count = captured.count.is_none_or(|count| count == computed.count);
        let differs = !(same_depth && same_stencil && same_count);
        differs.then_some(Disagreement::Stored { pass: captured.pass, computed, captured: *captured })
    }
}

/// Returns whether an event comes before another in the API's order. Two pieces of one triangle may both leave a fragment,
/// where their common edge was moved over the pixel's middle.
fn is_before(one: &PixelEvent, next: &PixelEvent) -> bool {
    let are_pieces = one.triangle().zip(next.triangle()).is_some_and(|(one, next)| one.piece != next.piece);
    place(one) < place(next) || are_pieces && place(one) == place(next)
}

/// Returns a sort key of an event in the API's order: pass, then stored content, clears of depth, stencil and count,
/// then triangles by draw and index.
fn place(event: &PixelEvent) -> (usize, u8, usize, u32) {
    match &event.kind {
        PixelEventKind::Put => (event.pass, 0, 0, 0),
        PixelEventKind::ClearDepth => (event.pass, 1, 0, 0),
        PixelEventKind::ClearStencil => (event.pass, 2, 0, 0),
        PixelEventKind::ClearCount => (event.pass, 3, 0, 0),
        PixelEventKind::Triangle(one) => (event.pass, 4, one.draw, one.primitive),
    }
}

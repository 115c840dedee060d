//! On which side of surfaces volume faces count, and the raster state that counts them.

use crate::geometry::Extrusion;
use crate::plan::{ColorWrite, CountedSide, DrawPart, RasterState, StencilFace};
use crate::technique::Technique;
use crate::technique::settings::{CountOperations, VolumeSettings};
use std::ops::Range;
use wgpu_types::{CompareFunction, DepthBiasState, StencilOperation};

/// How far sides that graze a drawn surface are drawn behind their place, in steps of depth. Depths of a side and of
/// the surface round differently, and where the light grazes a surface, the side that its own edge casts runs behind
/// it, nearer than that difference: what comes out in front leaves the surface's cap without its other half. Rounding
/// grows with a triangle's largest depth, and so does the step of a depth bias; up to some forty steps have been seen
/// on sides that are cut far outside the picture, so this makes errors rare, not impossible.
///
/// No other side has it: a bias moves the edge of a shadow on whatever the light grazes, by this many steps over the
/// tangent of the light's height.
const GRAZING_BIAS: i32 = -4;

/// A range of a volume's triangles that counts, and how.
#[derive(Debug, Clone)]
pub struct CountedPart {
    pub part: DrawPart,
    /// Whether its triangles face inwards, so that the operations of front and back faces are swapped.
    pub flipped: bool,
    /// Whether its sides graze the surface that casts them, so that a depth bias moves them behind it.
    pub grazes: bool,
    /// The number that is added to each index of its draw.
    pub base_vertex: u32,
    pub triangles: Range<usize>,
}

impl CountedPart {
    pub fn new(part: DrawPart, flipped: bool, triangles: &Range<usize>) -> CountedPart {
        CountedPart { part, flipped, grazes: false, base_vertex: 0, triangles: triangles.clone() }
    }
}

/// Which faces of a volume count: those in front of the visible surface (z-pass) or behind it (z-fail).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CountingMode {
    /// In front of the surface.
    InFront,
    /// In front of the surface, starting from the near plane's own count (z-pass-plus).
    InFrontPlus,
    /// Behind the surface.
    Behind,
}

/// How a volume is made and counted: the side that counts, its extrusion, and the caps that the count needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VolumeSpec {
    pub counting: CountingMode,
    pub extrusion: Extrusion,
    pub light_cap: bool,
    pub dark_cap: bool,
}

impl VolumeSpec {
    /// Returns whether the volume ends on a plane; no vertex shader extrudes such volumes.
    pub fn ends_on_plane(&self) -> bool {
        matches!(self.extrusion, Extrusion::Clamped(_))
    }
}

/// Which volume faces a counting pass draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaceSelection {
    /// All faces, with two-sided stencil operations.
    BothFaces,
    /// Only the faces that increment.
    Adding,
    /// Only the faces that decrement.
    TakingAway,
}

impl FaceSelection {
    /// Returns the counting passes of a light in their order: one for both faces, or with two passes incrementing
    /// first, which keeps clamped counts right up to 255, unless the settings say otherwise.
    pub fn all(options: &VolumeSettings) -> &'static [FaceSelection] {
        match (options.two_pass, options.takes_away_first) {
            (false, _) => &[FaceSelection::BothFaces],
            (true, false) => &[FaceSelection::Adding, FaceSelection::TakingAway],
            (true, true) => &[FaceSelection::TakingAway, FaceSelection::Adding],
        }
    }

    /// Returns the name of the counting pass: `volumes`, with two passes `volumes, adding` and `volumes, taking away`.
    pub fn name(self) -> &'static str {
        match self {
            FaceSelection::BothFaces => "volumes",
            FaceSelection::Adding => "volumes, adding",
            FaceSelection::TakingAway => "volumes, taking away",
        }
    }
}

impl CountingMode {
    /// Returns how a volume technique counts: z-pass and z-pass+ in front of the surface, every other technique behind
    /// it.
    pub fn of(technique: Technique) -> CountingMode {
        match technique {
            Technique::ZPass => CountingMode::InFront,
            Technique::ZPassPlus => CountingMode::InFrontPlus,
            _ => CountingMode::Behind,
        }
    }

    /// Returns whether this mode counts volume faces in front of the visible surface (z-pass) or behind it (z-fail).
    pub fn side(self) -> CountedSide {
        match self {
            CountingMode::InFront | CountingMode::InFrontPlus => CountedSide::InFront,
            CountingMode::Behind => CountedSide::Behind,
        }
    }

    /// Returns the raster state with which a part counts in the stencil. Z-fail asks for unclipped depth;
    /// [`FrameBuilder::finish`](crate::technique::frame::FrameBuilder::finish) clears that where the frame can't or
    /// needn't have it.
    pub(super) fn raster(self, part: &CountedPart, options: &VolumeSettings, step: FaceSelection) -> RasterState {
        let (add, take) = operations(options);
        let adds_in_front = (self != CountingMode::Behind) != part.flipped;
        let (front, back) = if adds_in_front { (add, take) } else { (take, add) };
        let surface = RasterState::surface();
        let is_never = options.light_caps_never_pass && part.part == DrawPart::LightCap;
        let depth_compare = if is_never { CompareFunction::Never } else { surface.depth_compare };
        let depth_bias = depth_bias(part);
        let unclipped_depth = self == CountingMode::Behind;
        let color = ColorWrite::None;
        let state = RasterState { unclipped_depth, depth_compare, depth_bias, depth_write: false, color, ..surface };
        // Not by culling, as textbooks have it: on Mesa's software driver, culling one face changes
        // a few counts (2 and 16 of 40 000 pixels on a torn torus), with the operations as they are
        // here or not. Why is not known; without culling both ways leave the same counts.
        let (front_counts, back_counts) = match step {
            FaceSelection::BothFaces => (true, true),
            FaceSelection::Adding => (adds_in_front, !adds_in_front),
            FaceSelection::TakingAway => (!adds_in_front, adds_in_front),
        };
        let keep = |counts: bool, operation| if counts { operation } else { StencilOperation::Keep };
        let (front, back) = (self.face(keep(front_counts, front)), self.face(keep(back_counts, back)));
        state.with_faces(front, back, 0).writing(options.mask())
    }

    /// Returns the raster state with which a part counts in a float target, and what a front face adds there, 1 or −1
    /// (a back face the opposite). As fragments that fail the depth test write nothing, z-fail reverses the test.
    pub(super) fn float_raster(self, part: &CountedPart, options: &VolumeSettings) -> (RasterState, f32) {
        let surface = RasterState::surface();
        let never_passes = options.light_caps_never_pass && part.part == DrawPart::LightCap;
        let depth_compare = match (self, never_passes) {
            (CountingMode::Behind, true) => CompareFunction::Always,
            (CountingMode::Behind, false) => CompareFunction::LessEqual,
            (_, true) => CompareFunction::Never,
            (_, false) => surface.depth_compare,
        };
        let adds_in_front = (self != CountingMode::Behind) != part.flipped;
        let depth_bias = depth_bias(part);
        let unclipped_depth = self == CountingMode::Behind;
        let color = ColorWrite::Add;
        let state = RasterState { unclipped_depth, depth_compare, depth_bias, depth_write: false, color, ..surface };
        (state, if adds_in_front { 1.0 } else { -1.0 })
    }

    fn face(self, operation: StencilOperation) -> StencilFace {
        let keep = StencilFace { compare: CompareFunction::Always, ..StencilFace::IGNORE };
        match self {
            CountingMode::InFront | CountingMode::InFrontPlus => StencilFace { pass_op: operation, ..keep },
            CountingMode::Behind => StencilFace { depth_fail_op: operation, ..keep },
        }
    }
}

fn depth_bias(part: &CountedPart) -> DepthBiasState {
    let constant = if part.grazes { GRAZING_BIAS } else { 0 };
    DepthBiasState { constant, ..DepthBiasState::default() }
}

/// Returns the stencil operations that add 1 and take 1 away, in this order; both invert for parity.
pub fn operations(options: &VolumeSettings) -> (StencilOperation, StencilOperation) {
    match options.operations {
        CountOperations::Wrapping => (StencilOperation::IncrementWrap, StencilOperation::DecrementWrap),
        CountOperations::Clamping => (StencilOperation::IncrementClamp, StencilOperation::DecrementClamp),
        CountOperations::Inverting => (StencilOperation::Invert, StencilOperation::Invert),
    }
}

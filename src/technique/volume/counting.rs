//! On which side of surfaces volume faces count, and the raster state that counts them.

use crate::geometry::Extrusion;
use crate::plan::{ColorWrite, CountedSide, DrawPart, RasterState, StencilFace};
use crate::technique::Technique;
use crate::technique::settings::{CountOperations, VolumeSettings};
use std::ops::Range;
use wgpu::{CompareFunction, DepthBiasState, StencilOperation};

/// How far sides that graze a drawn surface are drawn behind their place, in steps of depth. Depths of a side and of
/// the surface round differently, and where the light grazes a surface, the side that its own edge casts runs behind
/// it, nearer than that difference: what comes out in front leaves the surface's cap without its other half. Rounding
/// grows with a triangle's largest depth, and so does the step of a depth bias; up to some forty steps have been seen
/// on sides that are cut far outside the picture, so this makes errors rare, not impossible.
///
/// No other side has it: a bias moves the edge of a shadow on whatever the light grazes, by this many steps over the
/// tangent of the light's height.
const GRAZING_BIAS: i32 = -4;

/// A range of a volume's triangles that counts, with how.
#[derive(Debug, Clone)]
pub struct CountedPart {
    pub part: DrawPart,
    /// Its triangles face inwards: the operations of front and back faces are swapped.
    pub flipped: bool,
    /// Its sides graze the surface that casts them: they are drawn behind their place.
    pub grazes: bool,
    /// The number that is added to each index.
    pub base_vertex: u32,
    pub triangles: Range<usize>,
}

impl CountedPart {
    pub fn new(part: DrawPart, flipped: bool, triangles: &Range<usize>) -> CountedPart {
        CountedPart { part, flipped, grazes: false, base_vertex: 0, triangles: triangles.clone() }
    }
}

/// On which side of the visible surface a volume's faces count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CountingMode {
    /// In front of the surface.
    InFront,
    /// In front of the surface, on top of what the near plane's count began with.
    InFrontPlus,
    /// Behind the surface.
    Behind,
}

/// How a volume is made and counted: the side that counts, how far it extends, and which caps it needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VolumeSpec {
    pub counting: CountingMode,
    pub extrusion: Extrusion,
    pub light_cap: bool,
    pub dark_cap: bool,
}

impl VolumeSpec {
    /// Returns whether the volume ends on a plane, to which no vertex shader can carry it.
    pub fn ends_on_plane(&self) -> bool {
        matches!(self.extrusion, Extrusion::Clamped(_))
    }
}

/// Which faces one pass draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaceSelection {
    /// All, with an operation each.
    BothFaces,
    /// Those that add.
    Adding,
    /// Those that take away.
    TakingAway,
}

impl FaceSelection {
    /// The passes of one light, in order. What adds comes first, unless the other order is asked for: a clamped
    /// count then only fails beyond 255.
    pub fn all(options: &VolumeSettings) -> &'static [FaceSelection] {
        match (options.two_pass, options.takes_away_first) {
            (false, _) => &[FaceSelection::BothFaces],
            (true, false) => &[FaceSelection::Adding, FaceSelection::TakingAway],
            (true, true) => &[FaceSelection::TakingAway, FaceSelection::Adding],
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            FaceSelection::BothFaces => "volumes",
            FaceSelection::Adding => "volumes, adding",
            FaceSelection::TakingAway => "volumes, taking away",
        }
    }
}

impl CountingMode {
    pub fn of(technique: Technique) -> CountingMode {
        match technique {
            Technique::ZPass => CountingMode::InFront,
            Technique::ZPassPlus => CountingMode::InFrontPlus,
            _ => CountingMode::Behind,
        }
    }

    /// On which side of the surface its faces count.
    pub fn side(self) -> CountedSide {
        match self {
            CountingMode::InFront | CountingMode::InFrontPlus => CountedSide::InFront,
            CountingMode::Behind => CountedSide::Behind,
        }
    }

    /// The state that a part counts with. What counts behind surfaces asks not to be clipped, as far as the frame
    /// can do without ([`Frame::finish`](crate::technique::frame::Frame::finish)).
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

    /// The state for counting in a float target, and what a front face adds there (of a turned part: a
    /// back face that counts as one). What fails the depth test writes nothing, so counting behind
    /// the surface tests the other way round.
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

/// Returns the stencil operations that add 1 and subtract 1.
pub fn operations(options: &VolumeSettings) -> (StencilOperation, StencilOperation) {
    match options.operations {
        CountOperations::Wrapping => (StencilOperation::IncrementWrap, StencilOperation::DecrementWrap),
        CountOperations::Clamping => (StencilOperation::IncrementClamp, StencilOperation::DecrementClamp),
        CountOperations::Inverting => (StencilOperation::Invert, StencilOperation::Invert),
    }
}

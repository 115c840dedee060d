//! Where volume faces count, and the raster state that makes them.

use crate::geometry::Extrusion;
use crate::plan::{ColorWrite, CountBits, LightId, Part, RasterState, Side, StencilFace};
use crate::technique::Technique;
use crate::technique::settings::{CountsBy, VolumeSettings};
use std::ops::Range;
use wgpu::{CompareFunction, DepthBiasState, StencilOperation};

/// How far sides that hug a drawn surface are drawn behind their place, in steps of depth. Depths of a
/// side and of the surface round apart, and where the light grazes a surface, the side that its own
/// edge throws runs behind it, nearer than that: what comes out in front leaves the surface's
/// cap without its other half. Rounding grows with a triangle's largest depth, and so does the step of
/// a depth bias; it has been seen to reach some forty steps on sides that are cut far outside the
/// picture, so this makes errors rare, not impossible.
///
/// No other side has it: a bias moves the edge of a shadow on whatever the light grazes, by so many
/// steps over the tangent of the light's height.
const HUGGING_BIAS: i32 = -4;

/// What a count begins at, and for what.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// The volumes around the eye.
    Eye(u32),
    /// The volumes that parallel lines of sight end in.
    FarEnd(u32),
}

/// A run of a volume's triangles that counts.
#[derive(Debug, Clone)]
pub struct NeededPart {
    pub part: Part,
    /// Its triangles face inwards: operations are swapped.
    pub turned: bool,
    /// Sides that the surface they are thrown by is too near to.
    pub hugs: bool,
    /// What is added to its indices.
    pub base_vertex: u32,
    pub triangles: Range<usize>,
}

impl NeededPart {
    pub fn new(part: Part, turned: bool, triangles: &Range<usize>) -> NeededPart {
        NeededPart { part, turned, hugs: false, base_vertex: 0, triangles: triangles.clone() }
    }
}

/// Where a volume face counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Counting {
    /// In front of the surface.
    InFront,
    /// In front of the surface, on top of what the near plane's count began with.
    InFrontPlus,
    /// Behind the surface.
    Behind,
}

/// How a volume is counted, how far it reaches, and which caps that takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Form {
    pub counting: Counting,
    pub extrusion: Extrusion,
    pub light_cap: bool,
    pub dark_cap: bool,
}

impl Form {
    /// Onto a plane no vertex shader carries it.
    pub fn ends_on_plane(&self) -> bool {
        matches!(self.extrusion, Extrusion::Clamped(_))
    }
}

/// Which faces one pass draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// All, with an operation each.
    BothFaces,
    /// Those that add.
    Adding,
    /// Those that take away.
    TakingAway,
}

impl Step {
    /// The passes of one light, in order. What adds comes first, unless the other order is asked for: a clamped
    /// count then only fails beyond 255.
    pub fn all(options: &VolumeSettings) -> &'static [Step] {
        match (options.two_pass, options.takes_away_first) {
            (false, _) => &[Step::BothFaces],
            (true, false) => &[Step::Adding, Step::TakingAway],
            (true, true) => &[Step::TakingAway, Step::Adding],
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Step::BothFaces => "volumes",
            Step::Adding => "volumes, adding",
            Step::TakingAway => "volumes, taking away",
        }
    }
}

impl Counting {
    pub fn of(technique: Technique) -> Counting {
        match technique {
            Technique::ZPass => Counting::InFront,
            Technique::ZPassPlus => Counting::InFrontPlus,
            _ => Counting::Behind,
        }
    }

    /// On which side of the surface its faces count.
    pub fn side(self) -> Side {
        match self {
            Counting::InFront | Counting::InFrontPlus => Side::InFront,
            Counting::Behind => Side::Behind,
        }
    }

    /// The state that a part counts with. What counts behind surfaces asks not to be clipped, as far as the frame
    /// can do without ([`Frame::finish`](crate::technique::frame::Frame::finish)).
    pub(super) fn raster(self, part: &NeededPart, options: &VolumeSettings, step: Step) -> RasterState {
        let (add, take) = operations(options);
        let adds_in_front = (self != Counting::Behind) != part.turned;
        let (front, back) = if adds_in_front { (add, take) } else { (take, add) };
        let surface = RasterState::surface();
        let is_never = options.light_caps_never_pass && part.part == Part::LightCap;
        let depth_compare = if is_never { CompareFunction::Never } else { surface.depth_compare };
        let depth_bias = depth_bias(part);
        let unclipped_depth = self == Counting::Behind;
        let color = ColorWrite::None;
        let state = RasterState { unclipped_depth, depth_compare, depth_bias, depth_write: false, color, ..surface };
        // Not by culling, as textbooks have it: on Mesa's software driver, culling one face changes
        // a few counts (2 and 16 of 40 000 pixels on a torn torus), with the operations as they are
        // here or not. Why is not known; without culling both ways leave the same counts.
        let (front_counts, back_counts) = match step {
            Step::BothFaces => (true, true),
            Step::Adding => (adds_in_front, !adds_in_front),
            Step::TakingAway => (!adds_in_front, adds_in_front),
        };
        let keep = |counts: bool, operation| if counts { operation } else { StencilOperation::Keep };
        let (front, back) = (self.face(keep(front_counts, front)), self.face(keep(back_counts, back)));
        state.with_faces(front, back, 0).writing(options.mask())
    }

    /// The state for counting in a float target, and what a front face adds there (of a turned part: a
    /// back face that counts as one). What fails the depth test writes nothing, so counting behind
    /// the surface tests the other way round.
    pub(super) fn float_raster(self, part: &NeededPart, options: &VolumeSettings) -> (RasterState, f32) {
        let surface = RasterState::surface();
        let never_passes = options.light_caps_never_pass && part.part == Part::LightCap;
        let depth_compare = match (self, never_passes) {
            (Counting::Behind, true) => CompareFunction::Always,
            (Counting::Behind, false) => CompareFunction::LessEqual,
            (_, true) => CompareFunction::Never,
            (_, false) => surface.depth_compare,
        };
        let adds_in_front = (self != Counting::Behind) != part.turned;
        let depth_bias = depth_bias(part);
        let unclipped_depth = self == Counting::Behind;
        let color = ColorWrite::Add;
        let state = RasterState { unclipped_depth, depth_compare, depth_bias, depth_write: false, color, ..surface };
        (state, if adds_in_front { 1.0 } else { -1.0 })
    }

    fn face(self, operation: StencilOperation) -> StencilFace {
        let keep = StencilFace { compare: CompareFunction::Always, ..StencilFace::IGNORE };
        match self {
            Counting::InFront | Counting::InFrontPlus => StencilFace { pass_op: operation, ..keep },
            Counting::Behind => StencilFace { depth_fail_op: operation, ..keep },
        }
    }
}

fn depth_bias(part: &NeededPart) -> DepthBiasState {
    let constant = if part.hugs { HUGGING_BIAS } else { 0 };
    DepthBiasState { constant, ..DepthBiasState::default() }
}

/// How a light's volumes are counted, to be told.
pub struct Counts<'a> {
    /// `None` counts each volume in its own way.
    pub by: Option<Counting>,
    pub light: LightId,
    pub options: &'a VolumeSettings,
    /// What the count begins with, if anything.
    pub start: Option<Start>,
    /// Volumes are only counted in front of the surface where neither the eye nor the near plane is in them.
    pub chooses_side: bool,
    /// What [`Start::Eye`] is counted around.
    pub place: &'static str,
    /// Lines of sight are parallel: they begin at the near plane, and no eye is where they meet.
    pub is_parallel: bool,
    /// Light caps, dark caps: some would count and are not drawn.
    pub lacks: [bool; 2],
}

impl Counts<'_> {
    /// What a pass is for.
    pub fn purpose(&self, step: Step) -> String {
        let what = self.what();
        let is_inverting = self.options.operations == CountsBy::Inverting && !self.options.counts_in_float;
        if is_inverting {
            let counts = if self.by == Some(Counting::Behind) { "hidden by the surface" } else { "nearer than it" };
            let own = if step == Step::BothFaces { "" } else { ", those of one side in this pass" };
            return format!(
                "Counts {what}, odd or even: every face {counts} turns one bit over{own}. {}1 is left where an odd \
                 number of volumes contains the surface, and an even one reads as none{}.",
                self.begins(),
                self.condition()
            );
        }
        let [adds, takes] = match self.by {
            Some(Counting::InFront | Counting::InFrontPlus) => {
                ["a front face nearer than the surface adds 1", "a back face nearer than it takes 1 away"]
            }
            Some(Counting::Behind) => ["a back face hidden by the surface adds 1", "a hidden front face takes 1 away"],
            None => ["in front, a front face adds 1 and a back face takes 1 away", "behind, it is the other way round"],
        };
        let is_last = match step {
            Step::BothFaces => return format!("Counts {what}: {adds}, {takes}. {}", self.left()),
            Step::Adding => self.options.takes_away_first,
            Step::TakingAway => !self.options.takes_away_first,
        };
        let does = if step == Step::Adding { adds } else { takes };
        match is_last {
            false => format!("Counts {what}, first half: {does}. The other faces follow in a pass of their own."),
            true => format!("Counts {what}, second half: {does}. {}", self.left()),
        }
    }

    fn what(&self) -> String {
        let light = self.light.name();
        match self.by {
            Some(Counting::InFront | Counting::InFrontPlus) => {
                format!("the shadow volumes of {light} in front of each surface")
            }
            Some(Counting::Behind) => format!("the shadow volumes of {light} behind each surface"),
            None => format!(
                "the shadow volumes of {light}, behind each surface where they may hold {}, else in front of it",
                if self.is_parallel { "the near plane" } else { "the eye" }
            ),
        }
    }

    /// What the count says in the end.
    fn left(&self) -> String {
        let begins = self.begins();
        let what = match self.by {
            Some(Counting::InFrontPlus) => "With what the near plane began with, if anything, what is left contains",
            None => "Either way, what is left contains",
            Some(_) => "What is left contains",
        };
        format!("{begins}{what} the surface{}.", self.condition())
    }

    /// The bits that its count is kept in; all, where that is a float.
    fn bits(&self) -> CountBits {
        if self.options.counts_in_float { CountBits::EIGHT } else { CountBits::of_mask(self.options.mask().into()) }
    }

    fn begins(&self) -> String {
        match self.start {
            None => String::new(),
            Some(Start::Eye(start)) => format!("It begins at {start}, for the volumes around {}. ", self.place),
            Some(Start::FarEnd(start)) => format!(
                "It begins at {start}{}: parallel lines of sight all end at one point at infinity, in the volumes of \
                 so many casting triangles, those that a ray from {} along them meets. ",
                match self.bits() {
                    CountBits::EIGHT => String::new(),
                    bits => format!(" in {bits}"),
                },
                self.light.name()
            ),
        }
    }

    /// Where that is so.
    fn condition(&self) -> String {
        let eye = match (self.by, self.start) {
            (Some(Counting::InFront), _) if self.chooses_side && self.is_parallel => ", as the near plane is in none",
            (Some(Counting::InFront), _) if self.chooses_side => ", as neither the eye nor the near plane is in any",
            (Some(Counting::InFront), None | Some(Start::FarEnd(_))) if self.is_parallel => {
                ", if the near plane is in none"
            }
            (Some(Counting::InFront), None | Some(Start::FarEnd(_))) => ", if the eye itself is in none",
            (Some(Counting::InFront), Some(Start::Eye(_))) => ", if the near plane cuts none",
            _ => ", wherever the eye is",
        };
        let caps = match self.lacks {
            [false, false] => "",
            [true, false] => "; but no light cap is drawn, and where one lies on that side the count is wrong",
            [false, true] => "; but no dark cap is drawn, and where one lies on that side the count is wrong",
            [true, true] => "; but no cap is drawn, and where one lies on that side the count is wrong",
        };
        format!("{eye}{caps}")
    }
}

/// What adds 1 and what takes 1 away.
pub fn operations(options: &VolumeSettings) -> (StencilOperation, StencilOperation) {
    match options.operations {
        CountsBy::Wrapping => (StencilOperation::IncrementWrap, StencilOperation::DecrementWrap),
        CountsBy::Clamping => (StencilOperation::IncrementClamp, StencilOperation::DecrementClamp),
        CountsBy::Inverting => (StencilOperation::Invert, StencilOperation::Invert),
    }
}

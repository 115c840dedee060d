//! The settings of planar shadows.

use super::super::lesson::{Lesson, cited};
use super::common::with_own;
use super::face::{ReceiverChoice, SettingMap, SettingSpec, SettingValues, WordSetting, words};
use crate::geometry::planar::FlattenClip;
use wgpu_types::{CompareFunction, DepthBiasState};

const NO_OFFSET: DepthBiasState = DepthBiasState { constant: 0, slope_scale: 0.0, clamp: 0.0 };
/// A depth bias towards the eye, enough to separate a flattened caster from the surface in whose plane it lies.
const OFFSET: DepthBiasState = DepthBiasState { constant: 64, slope_scale: 2.0, clamp: 0.0 };

const STENCIL: WordSetting<bool> = words(
    "stencil",
    &["on", "off"],
    &[true, false],
    "keeps shadows on their receiver",
    Lesson {
        text: "With `off`, the flattened casters are not kept on their receiver: shadows run off it, into the air. \
             With `on`, each receiver's pixels have a mark of its own first.",
        formula: "a receiver's mark is even; a flattened caster raises it by 1 where it is found; light is added where \
             the stencil is even",
        sources: &[cited::KILGARD],
    },
);
const BLEND: WordSetting<ShadowBlend> = words(
    "blend",
    &["once", "twice", "opaque"],
    &[ShadowBlend::Once, ShadowBlend::Twice, ShadowBlend::Opaque],
    "what a flattened caster does to a pixel: keeps the light off, darkens it with each layer, or covers it in black",
    Lesson {
        text: "With `opaque`, flattened casters are drawn in black over the lit picture, as in the first tries: a hole in the \
             floor, for ambient light and other lights are gone too. With `twice`, they are blended over it, and each layer \
             darkens what is below once more: dark patches where triangles overlap. With `once`, the \
             first layer takes the mark away that the next would need. Scene `glass` shows fewer layers beside more, where \
             the shadows of a pane and of the ball overlap.",
        formula: "with ambient light A and what the light adds L, under k layers: once A; twice (A + L) b^k, where each layer \
             leaves the share b = 0.4; opaque 0",
        sources: &[cited::BLINN, cited::KILGARD],
    },
);

/// What flattened casters do to the pixels that they cover.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShadowBlend {
    /// They keep the light off, once, however many layers cover a pixel.
    Once,
    /// Each layer multiplies the lit picture by [`ShadowBlend::LEAVES`].
    Twice,
    /// They replace the lit picture by black.
    Opaque,
}

impl ShadowBlend {
    /// The share of the picture that one blended layer leaves.
    pub const LEAVES: f32 = 0.4;
}
const CLIP: WordSetting<FlattenClip> = words(
    "clip",
    &["on", "off", "gpu"],
    &[FlattenClip::BetweenPlaneAndLight, FlattenClip::Off, FlattenClip::Undivided],
    "drops what is beyond the light or below the receiver",
    Lesson {
        text: "With `off`, what is beyond the light or below the receiver throws a shadow too: the anti-shadow and \
             the false shadow. `on` keeps what is between the two. Beyond the light the shadow matrix makes w negative, and \
             dividing by it carries a point back through the light: that is the anti-shadow. `gpu` hands w over as it is: a GPU \
             clips what has w < 0 and shows no anti-shadow, but it knows nothing of the plane, and the false shadow stays. \
             `pixel --coordinates` prints the matrix with a vertex carried through.",
        formula: "with heights over the receiver's plane: a point casts where 0 < height < the light's height; with the plane P \
             towards the light L: M = (P . L) I - L P^T, and w = the light's height - the point's height",
        sources: &[cited::BLINN],
    },
);
const Z_FIGHTING: WordSetting<(CompareFunction, DepthBiasState)> = words(
    "z-fighting",
    &["depth-off", "polygon-offset", "none"],
    &[
        (CompareFunction::Always, NO_OFFSET),
        (CompareFunction::GreaterEqual, OFFSET),
        (CompareFunction::GreaterEqual, NO_OFFSET),
    ],
    "how a shadow wins over the surface it lies on",
    Lesson {
        text: "A flattened caster lies in its receiver's plane: depths tie, and rounding decides pixel by pixel. \
             With `depth-off` marked pixels have no depth test; `polygon-offset` pulls the shadow towards the \
             eye; `none` shows the fight. Layers hide it: where several triangles of a caster cover a pixel it is enough that \
             one of them wins. With `leave-out = none`, which flattens both sides of closed casters, scene `rings` shows next \
             to none under reversed depth, and a tilted floor or `depth = standard-finite` still show it all over.",
        formula: "offset = slope * m + constant * r, with the triangle's depth slope m a pixel and the smallest step \
             of depth r",
        sources: &[cited::BLINN, cited::SEGAL_AKELEY],
    },
);
const CACHE: WordSetting<bool> = words(
    "cache",
    &["on", "off"],
    &[true, false],
    "keeps flattened casters until plane, caster or light change",
    Lesson {
        text: "With `off`, every frame flattens every caster anew: what a moving light costs. `on` keeps what was \
             flattened until plane, caster or light change.",
        formula: "flattened point = (P.L) V - (P.V) L, for the plane P, the light L and the point V: the same while \
             none of the three changes",
        sources: &[cited::BLINN],
    },
);

const RECEIVERS: SettingSpec = SettingSpec {
    key: "receivers",
    values: SettingValues::Receivers(&ReceiverChoice::WORDS),
    default: "share:0.5",
    meaning: "which flat pieces of surfaces casters are flattened onto",
    lesson: Lesson {
        text: "Every receiver costs a draw for each caster, and the technique is cheap while they are few: a floor, a wall, a \
             table's top. `share`:P keeps the flat pieces that cover P per cent of the picture or more, as far as they are \
             in view, whatever stands before them: as the eye comes nearer, a small one gets its shadow at once. \
             `largest`:N keeps the N largest by area, wherever the eye is. `named`:NAME,NAME keeps those of some objects. \
             `all` keeps each facet of every curved mesh, too, and costs more than shadow volumes, which serve any surface. The \
             stencil has marks for 127; where there are more, those that cover most of the picture have them.",
        formula: "triangles = the sum over receivers of the casters' triangles between receiver and light",
        sources: &[cited::BLINN],
    },
};

/// The settings of `planar`, in the order in which they are shown.
pub(super) const SETTINGS: [SettingSpec; 16] =
    with_own([RECEIVERS, STENCIL.spec, BLEND.spec, CLIP.spec, Z_FIGHTING.spec, CACHE.spec]);

/// The settings of planar shadows, parsed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarSettings {
    /// Whether each receiver's pixels are marked in the stencil first, which keeps shadows on them.
    pub marks: bool,
    /// What flattened casters do to the pixels that they cover.
    pub blend: ShadowBlend,
    /// Which part of a caster is flattened: what lies between plane and light, or all of it.
    pub clip: FlattenClip,
    /// The depth test of a shadow against the surface that it lies on.
    pub depth_compare: CompareFunction,
    /// The depth bias of a shadow against the surface that it lies on.
    pub depth_bias: DepthBiasState,
    /// Whether flattened casters are cached between plans.
    pub keeps: bool,
}

impl ReceiverChoice {
    /// Returns the choice that a frame's settings contain; the default where they have none, or none that is valid.
    pub fn read(values: &SettingMap) -> ReceiverChoice {
        ReceiverChoice::parse(RECEIVERS.of(values)).unwrap_or(ReceiverChoice::All)
    }
}

impl PlanarSettings {
    /// Parses the settings of planar shadows; missing and invalid values become their defaults.
    pub fn read(values: &SettingMap) -> PlanarSettings {
        let (depth_compare, depth_bias) = Z_FIGHTING.read(values);
        PlanarSettings {
            marks: STENCIL.read(values),
            blend: BLEND.read(values),
            clip: CLIP.read(values),
            depth_compare,
            depth_bias,
            keeps: CACHE.read(values),
        }
    }

    /// Returns whether the stencil both keeps shadows on their receivers and lets each pixel be darkened once.
    pub fn counts(&self) -> bool {
        self.marks && self.blend == ShadowBlend::Once
    }

    /// Returns why a setting does nothing with the other settings as they are; `None` where it has an effect.
    pub(in crate::technique) fn without_effect(&self, key: &str) -> Option<&'static str> {
        let is_off = key == BLEND.spec.key && !self.marks && self.blend != ShadowBlend::Opaque;
        is_off.then_some("No effect: without the stencil nothing keeps a pixel from being darkened twice")
    }
}

//! The settings of techniques that draw maps and textures.

use super::super::lesson::{Lesson, cited};
use super::common::with_own;
use super::face::{
    NumberOrWordSetting, NumberSetting, SettingMap, SettingSpec, SettingValues, WordSetting, frustum_numbers, number,
    number_or, whole, words,
};
use crate::geometry::light_frame::LightFrustum;
use wgpu_types::Face;

/// The key of the setting for the number of texels along each side.
pub(in crate::technique) const SIZE: &str = "size";

const fn size(default: &'static str, most: i64, meaning: &'static str) -> NumberSetting {
    const LESSON: Lesson = Lesson {
        text: "Texels along each side. Too few, and edges are stairs; twice as many cost four times the memory.",
        formula: "t = 2 d tan(v/2) / N, the side of a texel at the distance d under the field of view v, with N texels \
             a side",
        sources: &[cited::WILLIAMS],
    };
    whole(SIZE, [1, most], default, meaning, LESSON)
}

const REDRAW: WordSetting<bool> = words(
    "redraw",
    &["always", "changed"],
    &[false, true],
    "maps and textures are drawn in every frame, or only where what makes them has changed",
    Lesson {
        text: "With `changed`, maps and textures stay from frame to frame while nothing that makes them changes; \
             with `always` they are drawn in every frame. They are made of places about the light, so they \
             survive a moving eye.",
        formula: "a map depends on light, casters and size, and not on the eye",
        sources: &[cited::WILLIAMS],
    },
);
const MAP_SIZE: NumberSetting = size("1024", 8192, "texels along each side of the map");
// Rounding of positions to f32 differs by a few steps between the camera's and the light's view.
const CONSTANT: NumberSetting = whole(
    "bias-constant",
    [-1_000_000, 1_000_000],
    "16",
    "steps of depth by which the map is pushed away from the light",
    Lesson {
        text: "Steps of depth: too few, and rounding alone makes surfaces darken themselves (acne).",
        formula: "stored depth = depth - b r, away from the light, with the smallest step of depth r",
        sources: &[cited::REEVES, cited::SEGAL_AKELEY],
    },
);
const SLOPE: NumberSetting = number(
    "bias-slope",
    [-1000.0, 1000.0],
    "2.0",
    "the same in units of a triangle's depth slope across one texel",
    Lesson {
        text: "Depth slopes across a texel: a texel covers a piece of a slanted surface, and its depth is that of \
             one point. With 0 every slanted surface is striped; far too much, and shadows leave their casters \
             (peter-panning): a bias takes the shadow of what is nearer to its receiver, along the light, than the bias is \
             long. In `assets/scenes/heights.toml`, with three boards over a floor, 0 stripes floor and boards, 80 takes the \
             low board's shadow, 300 that of the middle one, too, and the high one keeps its own.",
        formula: "offset = slope * max(|dz/dx|, |dz/dy|), a texel; a plane needs at least (sqrt 2 / 2) t tan a + r, \
             with the texel's side t, the light's angle a to the normal and one step of depth r",
        sources: &[cited::WILLIAMS, cited::SEGAL_AKELEY],
    },
);
const NORMAL: NumberSetting = number(
    "bias-normal",
    [-100.0, 100.0],
    "0",
    "texels by which a lookup is moved along the surface's normal",
    Lesson {
        text: "Moves the lookup off the surface instead of pushing the map away: farther where the light grazes, \
             not at all where it falls straight.",
        formula: "moved by k t sin a along the normal, with the texel's side t and the light's angle a to the normal",
        sources: &[cited::HOLBERT],
    },
);
const RECEIVER_PLANE: WordSetting<bool> = words(
    "bias-receiver-plane",
    &["off", "on"],
    &[false, true],
    "compares each texel with the surface's own plane there",
    Lesson {
        text: "With `on`, each texel is compared with the depth that the surface's own plane has there: the right \
             bias for flat surfaces, at the cost of derivatives, which break at edges. With `off`, all are \
             compared with one depth.",
        formula: "compared depth = z + dz/du * (du) + dz/dv * (dv), with du and dv from the point to the texel's \
             centre",
        sources: &[cited::ISIDORO],
    },
);
const CULL: WordSetting<Option<Face>> = words(
    "cull",
    &["none", "back", "front"],
    &[None, Some(Face::Back), Some(Face::Front)],
    "which faces the map leaves out",
    Lesson {
        text: "With `front`, the map holds back faces, so front faces need no bias; thin casters and contacts then \
             leak light. `back` leaves out the back faces, and `none` nothing.",
        formula: "the map keeps the nearest depth of the faces that are left",
        sources: &[cited::WANG_MOLNAR],
    },
);
const FILTER: NumberOrWordSetting = number_or(
    "filter",
    &["none"],
    "pcf:",
    [1.0, 15.0],
    true,
    "how many texels along each side are compared and averaged",
    Lesson {
        text: "`pcf:K` compares K by K texels and averages: edges are blurred over K texels, everywhere alike. It hides \
             stairs, and is no penumbra, which is nothing at the caster and widens with the distance from it. Labels are no \
             righter than without. `none` compares one texel.",
        formula: "light = (texels that are not nearer to the light than the surface) / K^2",
        sources: &[cited::REEVES],
    },
);

pub(in crate::technique) const LIGHT_FRUSTUM: SettingSpec = SettingSpec {
    key: "light-frustum",
    values: SettingValues::WordOrFrustum(&["casters", "view", "view-snapped"]),
    default: "casters",
    meaning: "what a map covers: what casts, what the camera sees, or a frustum of given numbers",
    lesson: Lesson {
        text: "`casters` fits the map to all that casts: it stands still while the camera moves. `view` fits it to what the \
             camera sees, as many engines do to spend their texels there: as the camera moves, edges of shadows crawl \
             from texel to texel (the map swims). `view-snapped` has one size for all directions of the view from one place and moves \
             by whole texels, so that a sun's edges stand still; a lamp's map becomes a cube, which never moves, as it \
             does with `view`, too, where what is seen does not fit a cone of 120 degrees. \
             FOV:NEAR:FAR are an engine's own numbers, for a map that looks at the middle of what casts: what stands \
             outside casts no shadow, and a surface beyond FAR is still compared. For a sun, FOV is the map's width in metres, and the camera stands so that what \
             casts is midway between NEAR and FAR.",
        formula: "view-snapped: centre = t floor(centre / t) along the map's x and y, with the side t of a texel",
        sources: &[cited::BRABEC, cited::VALIENT],
    },
};

/// The settings of `shadow-map`, in the order in which they are shown.
pub(super) const SHADOW_MAP: [SettingSpec; 19] = with_own([
    MAP_SIZE.spec,
    LIGHT_FRUSTUM,
    CONSTANT.spec,
    SLOPE.spec,
    NORMAL.spec,
    RECEIVER_PLANE.spec,
    CULL.spec,
    FILTER.spec,
    REDRAW.spec,
]);

/// The settings of shadow maps, parsed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapSettings {
    /// Texels along each side.
    pub size: u32,
    /// What the map covers.
    pub frustum: LightFrustum,
    /// Constant bias, in the smallest steps of depth: how far the map is pushed away from the light.
    pub bias_constant: i32,
    /// Slope-scaled bias: how far the map is pushed away, in units of a triangle's depth slope across one texel.
    pub bias_slope: f64,
    /// Normal offset: how many texels a lookup is moved along the surface's normal.
    pub bias_normal: f64,
    /// Receiver-plane bias: whether each texel is compared with the depth of the surface's plane at its centre.
    pub bias_receiver_plane: bool,
    /// The faces that the map leaves out; `None` keeps both.
    pub cull: Option<Face>,
    /// PCF kernel width: texels along each side that are compared and averaged; 1 without a filter.
    pub filter_width: u32,
    /// Whether maps are kept from frame to frame while nothing that they depend on changes.
    pub keeps: bool,
}

impl MapSettings {
    /// Parses the settings of shadow maps from a choice's or a capture's values; missing and invalid values become
    /// their defaults.
    pub fn read(values: &SettingMap) -> MapSettings {
        MapSettings {
            size: MAP_SIZE.read(values) as u32,
            frustum: match LIGHT_FRUSTUM.of(values) {
                "view" => LightFrustum::View { is_snapped: false },
                "view-snapped" => LightFrustum::View { is_snapped: true },
                value => match frustum_numbers(value) {
                    Some([fov, near, far]) => LightFrustum::Given { fov, near, far },
                    None => LightFrustum::Casters,
                },
            },
            bias_constant: CONSTANT.read(values) as i32,
            bias_slope: SLOPE.read(values),
            bias_normal: NORMAL.read(values),
            bias_receiver_plane: RECEIVER_PLANE.read(values),
            cull: CULL.read(values),
            filter_width: FILTER.read(values).map_or(1, |width| width as u32),
            keeps: REDRAW.read(values),
        }
    }
}

const TEXTURE_SIZE: NumberSetting = size("256", 4096, "texels along each side of a receiver's texture");
const SILHOUETTE_SIZE: NumberSetting = size("512", 4096, "texels along each side of a silhouette's picture");
const PASSES: WordSetting<bool> = words(
    "passes",
    &["single", "multi"],
    &[true, false],
    "silhouettes are read while lighting, or darken the lit picture one by one",
    Lesson {
        text: "`multi` lights the scene first and darkens it by one silhouette after another: a silhouette takes \
             away what ambient and other lights gave as well. With `single`, it takes away of its own light \
             alone.",
        formula: "with ambient A, lights L and what silhouettes let through T: single A + sum of L * (product of its \
             T); multi (A + sum of L) * (product of all T)",
        sources: &[cited::SEGAL],
    },
);
const REVERSE: WordSetting<bool> = words(
    "reverse",
    &["off", "on"],
    &[false, true],
    "silhouettes also fall on what is behind the light",
    Lesson {
        text: "With `on`, silhouettes fall on what is behind the light too, through the point that a projection \
             turns round at; with `off`, not.",
        formula: "(s, t) = (x, y) / q is the same for (x, y, q) and (-x, -y, -q): off, q > 0 is asked for",
        sources: &[cited::SEGAL],
    },
);

const FIT: WordSetting<bool> = words(
    "fit",
    &["on", "off"],
    &[true, false],
    "the picture fits the caster; or it has 90° of a lamp's view, or as much of a sun's as the scene is large",
    Lesson {
        text: "With `on` the picture is as large as the caster's silhouette. With `off` it has 90 degrees of a lamp's view \
             around the caster's middle, or as much of a sun's as the scene is large: a small caster gets few texels, and \
             one that is wider is cut off, and beyond its picture all of the light arrives.",
        formula: "x and y of the picture = slopes from the light's axis / the largest slope (on), or / tan 45 degrees (off)",
        sources: &[cited::SEGAL],
    },
);
const BORDER: WordSetting<bool> = words(
    "border",
    &["on", "off"],
    &[true, false],
    "a ring of clear texels round the silhouette and beyond; without it the last texels go on for ever",
    Lesson {
        text: "With `on` a ring of clear texels surrounds the silhouette, and beyond the picture nothing is on light's way. \
             With `off` the silhouette touches the picture's edge and lookups are clamped to it: its last texels go on \
             for ever, as streaks of shadow.",
        formula: "on: scale 0.98 / largest slope; off: 1 / largest slope, and a lookup at clamp(place, 0, 1)",
        sources: &[cited::SEGAL],
    },
);

/// The settings of `planar-texture`, in the order in which they are shown.
pub(super) const PLANAR_TEXTURE: [SettingSpec; 12] = with_own([TEXTURE_SIZE.spec, REDRAW.spec]);
/// The settings of `projective`, in the order in which they are shown.
pub(super) const PROJECTIVE: [SettingSpec; 16] =
    with_own([SILHOUETTE_SIZE.spec, PASSES.spec, REVERSE.spec, FIT.spec, BORDER.spec, REDRAW.spec]);

/// The settings of receiver textures and silhouettes, parsed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureSettings {
    /// Texels along each side.
    pub size: u32,
    /// Whether textures are kept from frame to frame while nothing that they depend on changes.
    pub keeps: bool,
    /// Whether silhouettes are read in the light pass; otherwise each darkens the lit picture in a pass of its own.
    pub is_single_pass: bool,
    /// Whether silhouettes also fall on what lies behind the light (reverse projection).
    pub projects_backwards: bool,
    /// Whether each silhouette's picture is fitted to its caster.
    pub fits: bool,
    /// Whether lookups beyond the picture are clamped to its edge; otherwise a clear border surrounds the silhouette.
    pub repeats_edge: bool,
}

impl TextureSettings {
    /// Parses the settings of receiver textures; missing and invalid values become their defaults. Only size and
    /// caching are read, the rest is fixed.
    pub fn of_receivers(values: &SettingMap) -> TextureSettings {
        let (is_single_pass, projects_backwards) = (true, false);
        TextureSettings {
            size: TEXTURE_SIZE.read(values) as u32,
            keeps: REDRAW.read(values),
            is_single_pass,
            projects_backwards,
            fits: true,
            repeats_edge: false,
        }
    }

    /// Parses the settings of projected silhouettes; missing and invalid values become their defaults.
    pub fn of_silhouettes(values: &SettingMap) -> TextureSettings {
        TextureSettings {
            size: SILHOUETTE_SIZE.read(values) as u32,
            keeps: REDRAW.read(values),
            is_single_pass: PASSES.read(values),
            projects_backwards: REVERSE.read(values),
            fits: FIT.read(values),
            repeats_edge: !BORDER.read(values),
        }
    }
}

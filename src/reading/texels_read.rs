//! The texels that decided each light at a pixel, as text and as JSON: of a shadow map both depths, the bias and the
//! side of the comparison; of textures what they let through. `assets/help/json.md` says what each field means; names
//! are a contract with scripts.

use crate::capture::Capture;
use crate::history::Verdict;
use crate::numbers;
use crate::plan::{DecidedBy, FramePlan};
use crate::reading::fragments::SurfaceFragments;
use crate::reading::map_decision::{ComparedTexel, MapDecision};
use crate::reading::map_readers::MapReaders;
use crate::reading::texture_decision::{LayerRead, TextureDecision};
use crate::technique::MapSettings;
use serde::Serialize;
use std::fmt::Write;
use std::sync::Arc;

/// The most texels that text lists, one a line; of the others only the number is given.
const MOST_LINES: usize = 25;

/// For each light, which texels of its map the pixels read: computed once, then asked for any pixel.
#[derive(Debug)]
pub struct TexelReaders {
    lights: Vec<TexelReader>,
}

#[derive(Debug)]
enum TexelReader {
    Map(Box<MapReaders>),
    Textures(Box<SurfaceFragments>),
    /// No texel decides about this light, or it is not known which.
    None,
}

/// The texels that a pixel read for one light, and what follows.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum TexelsRead {
    /// Depths of its shadow map.
    ShadowMap(DepthsCompared),
    /// None: the surface is outside of what its shadow map shows.
    OutsideMap(OutsideMap),
    /// The texture of the receiver that the pixel shows.
    ReceiverTexture(LightLetThrough),
    /// Silhouettes of casters between the light and the pixel.
    Silhouettes(LightLetThrough),
}

/// A surface that no face of a shadow map sees.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutsideMap {
    /// A sentence on why the light arrives.
    because: String,
}

impl OutsideMap {
    fn new(capture: &Capture, readers: &MapReaders) -> OutsideMap {
        // A map that is fitted to the casters has them all.
        let is_fitted = capture.settings.get("light-frustum").is_none_or(|frustum| frustum == "casters");
        let why = if is_fitted { "no caster lies that way" } else { "whatever lies that way throws no shadow" };
        let adds = if readers.is_off() {
            "but the light is off, and nothing is added"
        } else {
            "and the light pass adds the light"
        };
        OutsideMap { because: format!("This surface is outside the map, so that no depth is compared: {why}, {adds}.") }
    }
}

/// Shadow map texels compared with the surface at a pixel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DepthsCompared {
    /// A sentence on why the light arrives or not.
    because: String,
    face: usize,
    texels: Vec<DepthTexel>,
    /// How many of the texels let the light pass.
    lit: usize,
    lit_where: &'static str,
    /// `None` for another program's map: what its shader adds is not known.
    bias: Option<BiasEntry>,
    /// The GPU's answer where the depths computed on the CPU give another one.
    gpu_says: Option<&'static str>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct DepthTexel {
    at: [u32; 2],
    /// The stored depth; `None` where no caster was drawn.
    stored: Option<f32>,
    stored_metres: Option<f64>,
    surface: f32,
    surface_metres: Option<f64>,
    is_lit: bool,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct BiasEntry {
    constant: i32,
    slope: f64,
    normal: f64,
    receiver_plane: bool,
}

/// Texels of textures or silhouettes, and the light that they let through to a pixel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LightLetThrough {
    because: String,
    layers: Vec<LayerTexels>,
    lets_through: [f64; 4],
    gpu_says: Option<&'static str>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct LayerTexels {
    layer: usize,
    name: String,
    texels: Vec<ShareTexel>,
    lets_through: [f64; 4],
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct ShareTexel {
    at: [u32; 2],
    rgba: [u8; 4],
    share: f64,
}

impl TexelReaders {
    /// Finds the texels that pixels read of each light's map at the end of the frame of `plan`; none for lights that no map
    /// decides, and for another program's map whose view is not known.
    pub fn new(capture: &Capture, plan: &Arc<FramePlan>) -> TexelReaders {
        let reader = |light: usize| match capture.decided_by(light) {
            DecidedBy::Map => {
                MapReaders::new(capture, Some(plan), light).map(|readers| TexelReader::Map(Box::new(readers)))
            }
            DecidedBy::ReceiverTextures | DecidedBy::Silhouettes => SurfaceFragments::new(capture, Some(plan), light)
                .map(|fragments| TexelReader::Textures(Box::new(fragments))),
            _ => None,
        };
        TexelReaders {
            lights: (0..capture.lights.len()).map(|light| reader(light).unwrap_or(TexelReader::None)).collect(),
        }
    }

    /// Returns for each light, in order, the texels that a pixel read, and what follows; `None` where it read none.
    pub fn at(&self, capture: &Capture, pixel: [u32; 2]) -> Vec<Option<TexelsRead>> {
        let of_light = |(light, reader): (usize, &TexelReader)| match reader {
            TexelReader::Map(readers) if capture.origin.is_none() && readers.is_outside(pixel) => {
                Some(TexelsRead::OutsideMap(OutsideMap::new(capture, readers)))
            }
            TexelReader::Map(readers) => {
                let decision = MapDecision::of(capture, readers, light, pixel)?;
                Some(TexelsRead::ShadowMap(DepthsCompared::new(capture, &decision, pixel)))
            }
            TexelReader::Textures(fragments) => {
                let decision = TextureDecision::of(capture, fragments, light, pixel)?;
                let text_of = LightLetThrough::new(capture, &decision, pixel);
                Some(match capture.decided_by(light) {
                    DecidedBy::Silhouettes => TexelsRead::Silhouettes(text_of),
                    _ => TexelsRead::ReceiverTexture(text_of),
                })
            }
            TexelReader::None => None,
        };
        self.lights.iter().enumerate().map(of_light).collect()
    }
}

impl TexelsRead {
    /// Returns a line with the reason, and lines with the texels below it; `light` is the light's index.
    pub fn text(&self, light: usize) -> String {
        let because = match self {
            TexelsRead::ShadowMap(read) => &read.because,
            TexelsRead::OutsideMap(read) => &read.because,
            TexelsRead::ReceiverTexture(read) | TexelsRead::Silhouettes(read) => &read.because,
        };
        let mut text = format!("  {}: {because}\n", numbers::light(light));
        match self {
            TexelsRead::ShadowMap(read) => read.write(&mut text),
            TexelsRead::OutsideMap(_) => {}
            TexelsRead::ReceiverTexture(read) | TexelsRead::Silhouettes(read) => read.write(&mut text),
        }
        text
    }
}

impl DepthsCompared {
    fn new(capture: &Capture, decision: &MapDecision, pixel: [u32; 2]) -> DepthsCompared {
        let light = decision.light;
        let metres = |depth: f32| decision.measure.and_then(|measure| measure.value(depth));
        let texel = |one: &ComparedTexel| DepthTexel {
            at: one.texel.at,
            stored: one.is_caster.then_some(one.stored),
            stored_metres: metres(one.stored).filter(|_| one.is_caster),
            surface: one.depth,
            surface_metres: metres(one.depth),
            is_lit: one.is_lit,
        };
        let settings = MapSettings::read(&capture.settings);
        DepthsCompared {
            because: Verdict::of(capture, light, pixel).with_texels(decision.light, || decision.sentence()).reason(),
            face: decision.middle.texel.face,
            texels: decision.compared.iter().map(texel).collect(),
            lit: decision.lit(),
            lit_where: if capture.map_clear_depth(light) == 0.0 { "surface >= stored" } else { "surface <= stored" },
            bias: capture.origin.is_none().then_some(BiasEntry {
                constant: settings.bias_constant,
                slope: settings.bias_slope,
                normal: settings.bias_normal,
                receiver_plane: settings.bias_receiver_plane,
            }),
            gpu_says: decision.gpu_says,
        }
    }

    fn write(&self, text: &mut String) {
        let depth = |depth: f32, metres: Option<f64>| match metres {
            Some(metres) => format!("{} ({})", numbers::depth(depth), numbers::metres(metres)),
            None => numbers::depth(depth),
        };
        let line = |one: &DepthTexel| {
            let stored = one.stored.map_or_else(|| "no caster".to_owned(), |stored| depth(stored, one.stored_metres));
            let surface = depth(one.surface, one.surface_metres);
            let so = if one.is_lit { "lit" } else { "shadow" };
            format!("    texel {},{}: stored {stored}, surface {surface}: {so}\n", one.at[0], one.at[1])
        };
        text.extend(self.texels.iter().take(MOST_LINES).map(line));
        // Writing to a string can't fail.
        if let Some(more) = self.texels.len().checked_sub(MOST_LINES).filter(|more| *more > 0) {
            let _ = writeln!(text, "    and {more} texels more: `--json` has them all");
        }
        let Some(BiasEntry { constant, slope, normal, receiver_plane }) = self.bias else {
            let _ = writeln!(
                text,
                "    lit where {}, or no caster is stored: how the program's shader compares is not known, and is taken as \
                 one texel with the depth of the surface's own plane there",
                self.lit_where
            );
            return;
        };
        let plane = if receiver_plane { ", each texel with the depth of the surface's own plane there" } else { "" };
        let moved = match normal {
            0.0 => "not moved off the surface".to_owned(),
            by => format!("moved along the surface's normal by up to {by} texels"),
        };
        let _ = writeln!(
            text,
            "    lit where {}, or no caster is stored; stored depths are pushed away from the light by a bias of \
             {constant} steps and {slope} texels of slope, and the lookup is {moved}{plane}",
            self.lit_where
        );
    }
}

impl LightLetThrough {
    fn new(capture: &Capture, decision: &TextureDecision, pixel: [u32; 2]) -> LightLetThrough {
        let layer = |one: &LayerRead| LayerTexels {
            layer: one.layer,
            name: one.name.clone(),
            texels: one
                .texels
                .iter()
                .map(|texel| ShareTexel { at: texel.at, rgba: texel.stored, share: texel.share })
                .collect(),
            lets_through: one.lets_through,
        };
        LightLetThrough {
            because: Verdict::of(capture, decision.light, pixel).reason(),
            layers: decision.layers.iter().map(layer).collect(),
            lets_through: decision.lets_through,
            gpu_says: decision.gpu_says,
        }
    }

    fn write(&self, text: &mut String) {
        for layer in &self.layers {
            let _ = writeln!(text, "    {}: lets through {}", layer.name, shares(layer.lets_through));
            for ShareTexel { at: [x, y], rgba, share } in &layer.texels {
                let stored = shares(rgba.map(|byte| f64::from(byte) / 255.0));
                let _ = writeln!(text, "      texel {x},{y} weighs {share:.3} and lets through {stored}");
            }
        }
        let all = match self.layers.len() {
            0 => "no texel is on the way".to_owned(),
            _ => format!("together {}", shares(self.lets_through)),
        };
        let _ = writeln!(text, "    {all}; the mask says shadow where alpha is below 0.5");
    }
}

/// Returns shares of 1 as text: `red 0.25, green 0.25, blue 0.25, alpha 0`.
fn shares(rgba: [f64; 4]) -> String {
    let [red, green, blue, alpha] = rgba.map(|share| {
        let digits = format!("{share:.3}");
        digits.trim_end_matches('0').trim_end_matches('.').to_owned()
    });
    format!("red {red}, green {green}, blue {blue}, alpha {alpha}")
}

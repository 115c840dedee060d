//! Which texels of a light's textures decided how much of it arrives at a pixel: those of a flat receiver's own
//! texture, or of each silhouette between light and pixel; as `arriving_by_receiver.wgsl` and
//! `arriving_by_projection.wgsl` read them.

use crate::capture::{Capture, CapturedMap};
use crate::reading::fragments::SurfaceFragments;
use crate::reading::layers::{self, MapContent};
use crate::technique::TextureSettings;
use crate::truth::{LIT, SHADOW};
use glam::{DVec2, DVec3, DVec4};

/// A light counts as blocked where less than this share of it arrives.
const BLOCKED_BELOW: f64 = 0.5;

/// A texel that is read, with its bilinear weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TexelShare {
    /// Column and row.
    pub at: [u32; 2],
    /// Red, green, blue and alpha as stored, linear: what the texel lets through.
    pub stored: [u8; 4],
    /// Its bilinear weight, 0 to 1.
    pub share: f64,
}

/// The texels that are read of one texture or silhouette, and what they let through.
#[derive(Debug, Clone, PartialEq)]
pub struct LayerRead {
    /// Index of the texture among the light's textures.
    pub layer: usize,
    /// Name of the receiver or caster that the texture belongs to.
    pub name: String,
    /// The texels with a weight above 0, row by row.
    pub texels: Vec<TexelShare>,
    /// Their weighted sum: red, green, blue and alpha, 0 to 1.
    pub lets_through: [f64; 4],
}

/// How a light's receiver textures or caster silhouettes decide a pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct TextureDecision {
    /// Index of the light.
    pub light: usize,
    /// Whether they are textures of receivers or silhouettes of casters.
    pub content: MapContent,
    /// The textures between light and pixel, in order; empty where a receiver has none, or no silhouette is before it.
    pub layers: Vec<LayerRead>,
    /// What all of them let through together: red, green, blue, and alpha, which decides the label; 0 to 1.
    pub lets_through: [f64; 4],
    /// The technique's own answer where it differs: rounding decides.
    pub gpu_says: Option<&'static str>,
}

impl TextureDecision {
    /// Returns how a light's textures decide a pixel; `None` for depth maps, other programs' frames, and pixels that
    /// look up no texture or whose triangle is not known. A receiver without a texture has no layers, and then all
    /// light arrives.
    pub fn of(
        capture: &Capture,
        fragments: &SurfaceFragments,
        light: usize,
        pixel: [u32; 2],
    ) -> Option<TextureDecision> {
        let content = MapContent::of(capture, light).filter(|content| *content != MapContent::Depth)?;
        // Which layer belongs to a receiver is known from the draws.
        if capture.origin.is_some() || !fragments.are_drawn() {
            return None;
        }
        let of = capture.lights.get(light)?;
        let fragment = fragments.at(pixel).filter(|fragment| fragment.is_drawn && fragment.reads)?;
        let layers = layers_read(capture, light, fragment.world, fragment.layer)?;
        let lets_through = product(&layers);
        let is_lit = lets_through[3] >= BLOCKED_BELOW;
        let gpu_says = match of.shadow.as_ref().and_then(|mask| mask.byte_at(pixel)) {
            Some(LIT) if !is_lit => Some("lit"),
            Some(SHADOW) if is_lit => Some("in shadow"),
            _ => None,
        };
        Some(TextureDecision { light, content, layers, lets_through, gpu_says })
    }

    /// Returns whether at least half of the light arrives (by alpha), so that the label computed here is lit.
    pub fn is_lit(&self) -> bool {
        self.lets_through[3] >= BLOCKED_BELOW
    }
}

/// Returns what a light's textures let through to a point of a surface whose own layer is `own`: red, green and blue, 0 to
/// 1. `None` where the light has none.
pub(super) fn lets_through(capture: &Capture, light: usize, world: DVec3, own: Option<u32>) -> Option<[f64; 3]> {
    let [red, green, blue, _] = product(&layers_read(capture, light, world, own)?);
    Some([red, green, blue])
}

/// Returns the textures that a surface whose own layer is `own` reads at a point, with their texels; `None` for a light that
/// has none.
fn layers_read(capture: &Capture, light: usize, world: DVec3, own: Option<u32>) -> Option<Vec<LayerRead>> {
    let content = MapContent::of(capture, light).filter(|content| *content != MapContent::Depth)?;
    let map = capture.lights.get(light)?.map.as_ref()?;
    let names = layers::layers(capture, light);
    let is_read = |layer: &usize| match content {
        MapContent::Textures => own == Some(*layer as u32),
        _ => own != Some(*layer as u32) && names[*layer].note.is_none(),
    };
    let settings = match content {
        MapContent::Textures => TextureSettings::of_receivers(&capture.settings),
        _ => TextureSettings::of_silhouettes(&capture.settings),
    };
    let read = |layer: usize| {
        let texels = texels(map, layer, world, &settings, content)?;
        let sum =
            |channel: usize| texels.iter().map(|one| f64::from(one.stored[channel]) / 255.0 * one.share).sum::<f64>();
        let lets_through = [0, 1, 2, 3].map(sum);
        Some(LayerRead { layer, name: names[layer].name.clone(), texels, lets_through })
    };
    Some((0..map.faces.len()).filter(is_read).filter_map(read).collect())
}

/// Returns what all layers let through together: red, green, blue and alpha.
fn product(layers: &[LayerRead]) -> [f64; 4] {
    [0, 1, 2, 3].map(|channel: usize| layers.iter().map(|layer| layer.lets_through[channel]).product())
}

/// Returns the texels of a layer that a point's surface reads by bilinear filtering, each once, with a weight above 0, row by
/// row; beyond the border its texels repeat. `None` where a silhouette is not looked up: behind the light or outside,
/// unless the settings project there.
fn texels(
    map: &CapturedMap,
    layer: usize,
    world: DVec3,
    settings: &TextureSettings,
    content: MapContent,
) -> Option<Vec<TexelShare>> {
    let clip: DVec4 = *map.clip_from_light.get(layer)? * (map.light_from_world * world.extend(1.0));
    let place = clip.truncate().truncate() / clip.w * DVec2::new(0.5, -0.5) + 0.5;
    let is_outside = place.cmplt(DVec2::ZERO).any() || place.cmpgt(DVec2::ONE).any();
    let is_silhouette = content == MapContent::Silhouettes;
    let is_behind_light = clip.w <= 0.0 && !settings.projects_backwards;
    if is_silhouette && (is_behind_light || (is_outside && !settings.repeats_edge)) {
        return None;
    }
    let image = map.faces.get(layer)?;
    let [width, height] = image.size();
    // Texels have their values at their middles; beyond the edge the last texel repeats.
    let at = place * DVec2::new(f64::from(width), f64::from(height)) - 0.5;
    let first = at.floor();
    let part = at - first;
    let inside = |value: f64, side: u32| value.clamp(0.0, f64::from(side.saturating_sub(1))) as u32;
    let mut found: Vec<TexelShare> = Vec::new();
    for (right, down) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
        let share =
            (if right > 0.0 { part.x } else { 1.0 - part.x }) * (if down > 0.0 { part.y } else { 1.0 - part.y });
        let at = [inside(first.x + right, width), inside(first.y + down, height)];
        match found.iter_mut().find(|texel| texel.at == at) {
            Some(known) => known.share += share,
            None => found.push(TexelShare { at, stored: image.rgba_at(at)?, share }),
        }
    }
    found.retain(|texel| texel.share > 0.0);
    Some(found)
}

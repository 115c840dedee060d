//! The light of a pixel by what it is: ambient, emissive, diffuse, specular.

use super::light_coordinates::own_layer;
use super::texture_decision::lets_through;
use crate::capture::Capture;
use crate::history::PixelHistory;
use crate::plan::{AttachmentRole, ColorWrite, Draw, FramePlan, Pass, Program};
use crate::truth::PixelLabel;
use glam::DVec3;
use serde::Serialize;

/// The light of a pixel by what it is, linear RGB.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ShadingChannels {
    /// What the surface reflects of ambient light: its colour's share.
    pub ambient: [f64; 3],
    /// What it sends out by itself.
    pub emissive: [f64; 3],
    /// What it reflects diffusely of the lights, as far as they arrive.
    pub diffuse: [f64; 3],
    /// Its highlights, as far as the lights arrive.
    pub specular: [f64; 3],
}

/// A light at a pixel, what arrives of it, and the terms that the surface answers it with.
pub(super) struct ArrivingLight {
    /// The light's linear RGB, faded.
    pub color: [f64; 3],
    /// Which share of it is not blocked, red, green and blue.
    pub share: [f64; 3],
    /// The diffuse term.
    pub diffuse: f64,
    /// The highlight.
    pub highlight: f64,
}

impl ShadingChannels {
    /// Sums up the light of a surface that has `[ambient, emissive]` without lights, a colour, and the lights that arrive; of
    /// their diffuse light the share `unasked` arrives whatever stands between.
    pub(super) fn new(
        [ambient, emissive]: [[f64; 3]; 2],
        color: [f64; 3],
        unasked: f64,
        lights: &[ArrivingLight],
    ) -> ShadingChannels {
        let of_lights = |term: &dyn Fn(&ArrivingLight) -> [f64; 3]| {
            let parts = lights.iter().map(|light| {
                let term = term(light);
                [0, 1, 2].map(|channel| term[channel] * light.color[channel])
            });
            parts.fold([0.0; 3], |sum, part| [0, 1, 2].map(|channel| sum[channel] + part[channel]))
        };
        ShadingChannels {
            ambient,
            emissive,
            diffuse: of_lights(&|light| {
                let arrives = |channel: usize| unasked + (1.0 - unasked) * light.share[channel];
                [0, 1, 2].map(|channel| color[channel] * light.diffuse * arrives(channel))
            }),
            specular: of_lights(&|light| light.share.map(|share| light.highlight * share)),
        }
    }

    /// Returns all of it.
    pub(super) fn sum(&self) -> [f64; 3] {
        let ShadingChannels { ambient, emissive, diffuse, specular } = self;
        [0, 1, 2].map(|channel| ambient[channel] + emissive[channel] + diffuse[channel] + specular[channel])
    }

    /// Returns names and numbers of the parts, as a sum.
    pub fn words(&self) -> String {
        let ShadingChannels { ambient, emissive, diffuse, specular } = *self;
        let parts = [("ambient", ambient), ("emissive", emissive), ("diffuse", diffuse), ("specular", specular)];
        parts.map(|(name, part)| format!("{name} ({})", three(part))).join(" + ")
    }
}

/// Returns which share of each light arrives at a pixel, red, green and blue: by the textures that its surface reads, which may
/// be coloured, else by the technique's visibility there, else by its label. `None` where a pass blends something over the lit
/// picture.
pub(super) fn shares(
    capture: &Capture,
    plan: &FramePlan,
    history: &PixelHistory,
    world: DVec3,
    labels: &[Option<PixelLabel>],
) -> Option<Vec<[f64; 3]>> {
    let blends = |draw: &Draw| draw.raster.color == ColorWrite::Multiply || draw.program == Program::Flat;
    let is_of_picture = |pass: &&Pass| {
        let target = pass.color.as_ref().filter(|_| pass.timed);
        target.is_some_and(|target| plan.attachment(target.attachment).role == AttachmentRole::Color)
    };
    if plan.passes.iter().filter(is_of_picture).flat_map(|pass| &pass.draws).any(blends) {
        return None;
    }
    let share = |(index, label): (usize, &Option<PixelLabel>)| {
        let texture = own_layer(plan, history, index).and_then(|own| lets_through(capture, index, world, own));
        if let Some(texture) = texture {
            return texture;
        }
        let visibility = capture.lights.get(index).and_then(|light| light.visibility.as_ref()?.value_at(history.pixel));
        let share = match (label, visibility) {
            (Some(PixelLabel::Lit | PixelLabel::Shadow), Some(share)) => f64::from(share),
            // Wrapped light reaches round a surface; any other adds nothing to one that faces away.
            (Some(PixelLabel::Lit | PixelLabel::FacesAway), _) => 1.0,
            _ => 0.0,
        };
        [share; 3]
    };
    Some(labels.iter().enumerate().map(share).collect())
}

/// Returns a number with at most four decimals as text to be read, not parsed: without zeros at the end, with `−`
/// (U+2212) where it is negative, and without a sign where it rounds to 0.
pub fn digits(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.replace('-', "−") }
}

/// Returns three numbers as text: `0.25, 0.5, 1`.
pub fn three(values: [f64; 3]) -> String {
    values.map(digits).join(", ")
}

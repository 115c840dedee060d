//! A picture of the first pass whose pixels differ: A, B, and where they differ, side by side.
//!
//! In the third, A is dark and grey, and texels that differ are bright; a frame is around the largest region.

use super::{AspectKind, Difference, PassDifference, after_draw, after_step};
use crate::capture::{Capture, Image, PixelFormat};
use crate::picture::Picture;
use crate::picture::colors::{self, Rgb};
use std::sync::Arc;

/// Gap between two pictures, and around all, pixels.
const GAP: u32 = 8;
/// Colour of texels that differ.
const DIFFERS: Rgb = [0xff, 0x2b, 0xf2];
/// Colour of the frame around the largest region.
const FRAME: Rgb = [0xd9, 0xdc, 0xe3];
/// Pixels from the largest region to its frame, and the frame's width.
const FRAME_GAP: u32 = 3;
const FRAME_WIDTH: u32 = 2;
/// Brightness of A where nothing differs.
const GROUND: f32 = 0.35;

/// A picture of a difference.
#[derive(Debug, Clone, PartialEq)]
pub struct ShownDifference {
    /// A, B, and where they differ.
    pub picture: Picture,
    /// The aspect that is shown.
    pub aspect: AspectKind,
}

impl Difference {
    /// Draws side by side A, B and where they differ, for the first pass whose pixels differ, else for the first such
    /// aspect of a light. `a` and `b` must be the captures that were compared. `None` where no pixel that both have
    /// differs.
    pub fn shown(&self, a: &Capture, b: &Capture) -> Option<ShownDifference> {
        let of_pass = self.first_in_pixels().and_then(|pass| of_pass(pass, a, b));
        let (aspect, in_a, in_b) = of_pass.or_else(|| self.of_lights(a, b))?;
        let difference = super::images::compare(&in_a, &in_b)?;
        let [width, height] = in_a.size();
        let size = [width * 3 + GAP * 4, height + GAP * 2];
        let mut picture = Picture::filled(size, colors::BACKGROUND);
        let range = range(&[&in_a, &in_b]);
        let [shown_a, shown_b] = [&in_a, &in_b].map(|image| colored(aspect, image, range));
        let mut where_differs = Picture::filled(in_a.size(), colors::BACKGROUND);
        for y in 0..height {
            for x in 0..width {
                let differs = in_a.texel([x, y]) != in_b.texel([x, y]);
                let ground = shown_a.at([x, y]).map_or(colors::NOTHING, dark_gray);
                where_differs.set([x, y], if differs { DIFFERS } else { ground });
            }
        }
        where_differs.frame(difference.region.bounds, FRAME_GAP, FRAME_WIDTH, FRAME);
        for (place, shown) in (0..).zip([&shown_a, &shown_b, &where_differs]) {
            picture.paste(shown, [GAP + place * (width + GAP), GAP]);
        }
        Some(ShownDifference { picture, aspect })
    }

    /// Returns the first aspect of a light, in the lights' order, whose texels differ at the end of the frame, with its
    /// pictures in both captures; `None` where there is none.
    fn of_lights(&self, a: &Capture, b: &Capture) -> Option<AspectPair> {
        self.lights.iter().find_map(|light| {
            let aspect = light.aspects.iter().find(|aspect| aspect.pixels().is_some())?.aspect;
            let [in_a, in_b] =
                [a, b].map(|capture| Some(super::at_the_end(capture.lights.get(light.light)?).get(&aspect)?.0.clone()));
            Some((aspect, in_a?, in_b?))
        })
    }
}

/// An aspect in both captures.
type AspectPair = (AspectKind, Arc<Image>, Arc<Image>);

fn of_pass(pass: &PassDifference, a: &Capture, b: &Capture) -> Option<AspectPair> {
    let [step_a, step_b] = [a.steps.get(pass.index[0]?)?, b.steps.get(pass.index[1]?)?];
    if let Some(aspect) = pass.aspects.iter().find(|aspect| aspect.pixels().is_some()) {
        let [state_a, state_b] = [after_step(a, step_a), after_step(b, step_b)];
        return Some((aspect.aspect, state_a.get(&aspect.aspect)?.0.clone(), state_b.get(&aspect.aspect)?.0.clone()));
    }
    pass.draws.iter().find_map(|draw| {
        let aspect = draw.aspects.iter().find(|aspect| aspect.pixels().is_some())?.aspect;
        let [after_a, after_b] =
            [step_a.draws.get(draw.index[0])?.after.as_ref()?, step_b.draws.get(draw.index[1])?.after.as_ref()?];
        let [state_a, state_b] = [after_draw(step_a, after_a), after_draw(step_b, after_b)];
        Some((aspect, state_a.get(&aspect)?.0.clone(), state_b.get(&aspect)?.0.clone()))
    })
}

/// Draws an image of this aspect in the colours of the window; `range` is the smallest and largest depth, for the greys
/// of depths.
fn colored(aspect: AspectKind, image: &Image, range: [f32; 2]) -> Picture {
    let [width, height] = image.size();
    let mut picture = Picture::filled(image.size(), colors::NOTHING);
    for at in (0..height).flat_map(|y| (0..width).map(move |x| [x, y])) {
        picture.set(at, color(aspect, image, at, range));
    }
    picture
}

fn color(aspect: AspectKind, image: &Image, at: [u32; 2], [low, high]: [f32; 2]) -> Rgb {
    match image.format() {
        PixelFormat::Rgba8Srgb | PixelFormat::Rgba8 => {
            image.rgba_at(at).map_or(colors::NOTHING, |[red, green, blue, _]| [red, green, blue])
        }
        PixelFormat::Depth32F => match image.depth_at(at) {
            Some(depth) if depth.is_finite() => {
                let share = (depth - low) / (high - low);
                if share.is_finite() { colors::near_far(1.0 - share) } else { colors::near_far(0.5) }
            }
            _ => DIFFERS,
        },
        PixelFormat::Value32F if matches!(aspect, AspectKind::Visibility | AspectKind::TruthVisibility) => {
            image.value_at(at).map_or(colors::NOTHING, colors::visibility)
        }
        PixelFormat::Value32F => {
            // As eight bits would count; the window's colour beyond 127 is not needed to see a difference.
            colors::stencil(image.value_at(at).map_or(0, |count| (count.round() as i64).rem_euclid(256) as u8))
        }
        PixelFormat::U8 => {
            let value = image.byte_at(at).unwrap_or_default();
            match aspect {
                AspectKind::Stencil => colors::stencil(value),
                AspectKind::Findings => colors::finding(value),
                _ => colors::label(value),
            }
        }
    }
}

/// Returns the smallest and largest finite depth of all depth pictures; infinite and reversed (+∞, −∞) where there is
/// none.
fn range(images: &[&Arc<Image>]) -> [f32; 2] {
    let mut range = [f32::INFINITY, f32::NEG_INFINITY];
    for image in images.iter().filter(|image| image.format() == PixelFormat::Depth32F) {
        for depth in image.rows().flat_map(|row| row.chunks_exact(4)).map(bytemuck::pod_read_unaligned::<f32>) {
            if depth.is_finite() {
                range = [range[0].min(depth), range[1].max(depth)];
            }
        }
    }
    range
}

fn dark_gray(color: Rgb) -> Rgb {
    let [red, green, blue] = color.map(f32::from);
    [((0.299 * red + 0.587 * green + 0.114 * blue) * GROUND) as u8; 3]
}

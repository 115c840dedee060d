//! A picture of what is wrong: the frame in grey, wrong pixels in the colours of the error picture, and a
//! numbered frame around each region.

use super::{Diagnosis, RegionFound};
use crate::accuracy::Finding;
use crate::capture::Capture;
use crate::picture::Picture;
use crate::picture::colors::{self, Rgb};

/// Colour of frames and numbers.
const INK: Rgb = [0xd9, 0xdc, 0xe3];
/// Colour behind numbers.
const PAPER: Rgb = colors::BACKGROUND;
/// Factor by which the captured picture is darkened under the marks.
const GROUND: f32 = 0.45;
/// Distance in pixels from a region to its frame; `WIDTH` is the frame's width.
const GAP: u32 = 2;
const WIDTH: u32 = 1;
/// Side in pixels of a dot of the numbers' dot font.
const DOT: u32 = 2;

impl Diagnosis {
    /// Draws the wrong pixels of a capture in colour over a grey picture, and frames and numbers the regions as in the
    /// text.
    pub fn shown(&self, capture: &Capture) -> Picture {
        let mut picture = wrong_pixels(capture);
        for (index, region) in self.regions.iter().enumerate() {
            outline(&mut picture, region, index + 1);
        }
        picture
    }
}

/// Draws the final picture of a capture in dark grey, and pixels that are wrong for any light in their finding's
/// colour. Excused pixels stay grey; without truth nothing is coloured.
pub fn wrong_pixels(capture: &Capture) -> Picture {
    let mut picture = Picture::filled(capture.size, colors::NOTHING);
    let last = capture.steps.len().checked_sub(1).and_then(|last| capture.frame_at(last));
    let [width, height] = capture.size;
    for at in (0..height).flat_map(|y| (0..width).map(move |x| [x, y])) {
        let ground = last.and_then(|frame| frame.color.image.rgba_at(at)).map(|[r, g, b, _]| dark_gray([r, g, b]));
        let findings = capture.lights.iter().filter_map(|light| light.truth.as_ref()?.findings.byte_at(at));
        let wrong = findings.filter(|byte| Finding::from_byte(*byte).is_some_and(Finding::is_wrong)).min();
        if let Some(color) = wrong.map(colors::finding).or(ground) {
            picture.set(at, color);
        }
    }
    picture
}

fn outline(picture: &mut Picture, region: &RegionFound, number: usize) {
    picture.frame(region.bounds, GAP, WIDTH, INK);
    let [left, top, ..] = region.bounds;
    let [width, height] = Picture::number_size(number, DOT);
    // Above the frame's corner where there is space, else within it.
    let [_, picture_height] = picture.size();
    let y = top.checked_sub(GAP + WIDTH + height).unwrap_or(top).min(picture_height.saturating_sub(height));
    let x = left.saturating_sub(GAP + WIDTH).min(picture.size()[0].saturating_sub(width));
    picture.number([x, y], number, DOT, INK, PAPER);
}

fn dark_gray([red, green, blue]: Rgb) -> Rgb {
    let [red, green, blue] = [red, green, blue].map(f32::from);
    [((0.299 * red + 0.587 * green + 0.114 * blue) * GROUND) as u8; 3]
}

//! Pixels of a frame that are worth a look: in shadow, in light, wrong.

use crate::accuracy::Finding;
use crate::capture::{Capture, Image};
use crate::truth::{LIT, SHADOW};

/// Pixels from the edge of a shadow from which on a pixel is well inside.
const WELL_INSIDE: u32 = 12;

/// Returns the pixel nearest to the middle that is in shadow by the first mask of any light; `None` where there is no mask
/// or no such pixel.
pub fn in_shadow(capture: &Capture) -> Option<[u32; 2]> {
    with_label(capture, SHADOW)
}

/// Returns the pixel nearest to the middle that is lit by the first mask of any light; `None` where there is no mask or no
/// such pixel.
pub fn lit(capture: &Capture) -> Option<[u32; 2]> {
    with_label(capture, LIT)
}

fn with_label(capture: &Capture, label: u8) -> Option<[u32; 2]> {
    let image = capture.lights.iter().find_map(|light| light.shadow.as_ref())?;
    nearest_to_middle(image, |value, _| value == label)
}

/// Returns a wrong pixel away from right ones, where wrong areas are so wide, and near the middle of the picture, under the
/// first light whose truth is known; `None` where no pixel is wrong.
pub fn wrong(capture: &Capture) -> Option<[u32; 2]> {
    let truth = capture.lights.iter().find_map(|light| light.truth.as_ref())?;
    well_inside(&truth.findings, |value| Finding::from_byte(value).is_some_and(Finding::is_wrong))
}

/// Returns a pixel well inside a shadow, away from its edges and near the middle of the picture, by the mask of the last
/// light that has any in shadow, with whose pass a frame ends; `None` where no mask has.
pub fn well_in_shadow(capture: &Capture) -> Option<[u32; 2]> {
    let mut masks = capture.lights.iter().rev().filter_map(|light| light.shadow.as_ref());
    masks.find_map(|mask| well_inside(mask, |value| value == SHADOW))
}

/// Returns, of the pixels for which `is_it` is true of their byte and which are farthest from others, at most
/// [`WELL_INSIDE`], the one nearest to the middle; `None` where it is true of none.
fn well_inside(image: &Image, is_it: impl Fn(u8) -> bool) -> Option<[u32; 2]> {
    let away = edge_distances(image, is_it);
    let most = away.iter().copied().max().filter(|most| *most > 0)?.min(WELL_INSIDE);
    nearest_to_middle(image, |_, index| away[index] >= most)
}

/// Returns for each pixel, row by row, how many steps, diagonal ones too, it is from the nearest pixel for whose byte `is_it`
/// is false or the picture's border; 0 for those themselves (Rosenfeld and Pfaltz 1966).
fn edge_distances(mask: &Image, is_it: impl Fn(u8) -> bool) -> Vec<u32> {
    let [width, height] = mask.size().map(|side| side as usize);
    // With a border of zeros around it, every pixel has all its neighbours.
    let wide = width + 2;
    let mut away = vec![0_u32; wide * (height + 2)];
    for (y, row) in mask.rows().enumerate() {
        for (x, value) in row.iter().enumerate() {
            away[(y + 1) * wide + x + 1] = if is_it(*value) { u32::MAX } else { 0 };
        }
    }
    let places: Vec<usize> = (1..=height).flat_map(|y| (1..=width).map(move |x| y * wide + x)).collect();
    let before = [1, wide - 1, wide, wide + 1];
    for place in &places {
        let least = before.map(|by| away[place - by]).into_iter().fold(u32::MAX, u32::min);
        away[*place] = away[*place].min(least.saturating_add(1));
    }
    for place in places.iter().rev() {
        let least = before.map(|by| away[place + by]).into_iter().fold(u32::MAX, u32::min);
        away[*place] = away[*place].min(least.saturating_add(1));
    }
    places.into_iter().map(|place| away[place]).collect()
}

/// Returns the pixel nearest to the middle for which `is_it` is true, of its byte and its index row by row.
fn nearest_to_middle(image: &Image, is_it: impl Fn(u8, usize) -> bool) -> Option<[u32; 2]> {
    let [width, height] = image.size().map(i64::from);
    let far = |[x, y]: [u32; 2]| (2 * i64::from(x) - width).pow(2) + (2 * i64::from(y) - height).pow(2);
    let bytes = image.rows().flatten().enumerate();
    let found = bytes.filter(|(index, value)| is_it(**value, *index));
    let place = |index: usize| [(index as i64 % width) as u32, (index as i64 / width) as u32];
    found.map(|(index, _)| place(index)).min_by_key(|at| far(*at))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::PixelFormat;

    #[test]
    fn the_distance_from_an_edge_counts_the_border_too() {
        let rows = ["11110", "11111", "11111", "11111"];
        let bytes: Vec<u8> = rows.concat().bytes().map(|byte| byte - b'0').collect();
        let mask = Image::packed(PixelFormat::U8, [5, 4], bytes);
        let expected = [[1, 1, 1, 1, 0], [1, 2, 2, 1, 1], [1, 2, 2, 2, 1], [1, 1, 1, 1, 1]];
        assert_eq!(edge_distances(&mask, |value| value == 1), expected.concat());
        assert_eq!(edge_distances(&mask, |value| value == 0)[4], 1);
        assert!(edge_distances(&mask, |value| value == 7).iter().all(|away| *away == 0));
        assert_eq!(well_inside(&mask, |value| value == 1), Some([2, 2]));
        assert_eq!(well_inside(&mask, |value| value == 7), None);
    }
}

//! What changed between two pictures of one kind, texel by texel: of counts by how much and which way, of depths how
//! far the surface moved, of colours only that they changed.
//!
//! A change is a picture of its own, made once and drawn over the frame's colours in dim grey. Texels that did not
//! change are see-through.

use crate::capture::{Image, PixelFormat};
use crate::reading::depth::DepthMeasure;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The most results of each kind that are cached.
const MOST_CACHED: usize = 6;
/// The factor by which the grey picture under a change is darkened.
const GROUND_LIGHT: f32 = 0.42;

/// The difference between two pictures of the same format, texel by texel.
#[derive(Debug, Clone, PartialEq)]
pub struct StepChange {
    /// The change at each texel, drawn in the colours of [`ChangeKind`].
    pub image: Arc<Image>,
    /// What kind of values changed.
    pub kind: ChangeKind,
    /// How many texels changed.
    pub texels: u64,
    /// The number of changed texels by kind of change.
    pub sorts: ChangedTexels,
}

/// The kind of values that changed, and how [`StepChange::image`] stores the change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChangeKind {
    /// Bytes, such as stencil counts: new minus old, as a signed byte.
    Count,
    /// Depths, stored as floats: new minus old, in metres or in stored depth; −∞ where a surface appeared, ∞ where one
    /// was cleared.
    Depth,
    /// Colours: the new colour, with alpha 0 where the colour did not change.
    Color,
}

/// The number of changed texels by kind of change.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ChangedTexels {
    /// The number of texels for each difference in count.
    Counts(BTreeMap<i8, u64>),
    /// The numbers of texels whose surface came nearer, went farther, appeared, and was cleared.
    Depths([u64; 4]),
    /// Colours are not sorted further.
    Colors,
}

/// A small cache of differences between pictures, computed on first use and found again by the images' addresses.
#[derive(Debug, Default)]
pub struct ChangeCache {
    changes: Vec<([Arc<Image>; 2], DepthMeasure, Option<StepChange>)>,
    grounds: Vec<(Arc<Image>, Arc<Image>)>,
    differing: Vec<([Arc<Image>; 2], Option<u64>)>,
}

impl ChangeCache {
    /// Drops all cached changes.
    pub fn forget(&mut self) {
        *self = ChangeCache::default();
    }

    /// Returns what changed from the first picture to the second, with depths in the unit of `measure`; `None` where
    /// formats or sizes differ, or for float counts.
    pub fn change(&mut self, pair: [&Arc<Image>; 2], measure: DepthMeasure) -> Option<StepChange> {
        let is_it = |of: &[Arc<Image>; 2]| is_pair(of, pair);
        if let Some((_, _, change)) = self.changes.iter().find(|(of, by, _)| is_it(of) && *by == measure) {
            return change.clone();
        }
        let change = change(pair[0], pair[1], measure);
        keep(&mut self.changes, (pair.map(Arc::clone), measure, change.clone()));
        change
    }

    /// Returns a colour picture in dim greys, to be drawn under a change; cached.
    pub fn ground(&mut self, colors: &Arc<Image>) -> Arc<Image> {
        if let Some((_, ground)) = self.grounds.iter().find(|(of, _)| Arc::ptr_eq(of, colors)) {
            return ground.clone();
        }
        let ground = Arc::new(ground(colors));
        keep(&mut self.grounds, (colors.clone(), ground.clone()));
        ground
    }

    /// Returns how many texels of two pictures differ; `None` where they have different sizes or formats, so that they
    /// can't be compared; cached.
    pub fn differing(&mut self, pair: [&Arc<Image>; 2]) -> Option<u64> {
        if let Some((_, texels)) = self.differing.iter().find(|(of, _)| is_pair(of, pair)) {
            return *texels;
        }
        let texels = crate::difference::differing_texels(pair[0], pair[1]);
        keep(&mut self.differing, (pair.map(Arc::clone), texels));
        texels
    }
}

fn is_pair(of: &[Arc<Image>; 2], pair: [&Arc<Image>; 2]) -> bool {
    Arc::ptr_eq(&of[0], pair[0]) && Arc::ptr_eq(&of[1], pair[1])
}

fn keep<T>(items: &mut Vec<T>, item: T) {
    if items.len() >= MOST_CACHED {
        items.remove(0);
    }
    items.push(item);
}

fn change(before: &Image, after: &Image, measure: DepthMeasure) -> Option<StepChange> {
    if before.format() != after.format() || before.size() != after.size() {
        return None;
    }
    Some(match before.format() {
        PixelFormat::U8 => counts(before, after),
        PixelFormat::Depth32F => depths(before, after, measure),
        PixelFormat::Rgba8 | PixelFormat::Rgba8Srgb => colors(before, after),
        PixelFormat::Value32F => return None,
    })
}

fn counts(before: &Image, after: &Image) -> StepChange {
    let mut sorts = BTreeMap::new();
    let mut bytes = Vec::with_capacity(before.size()[0] as usize * before.size()[1] as usize);
    for (old, new) in before.rows().zip(after.rows()) {
        bytes.extend(old.iter().zip(new).map(|(old, new)| new.wrapping_sub(*old)));
    }
    let mut histogram = [0_u64; 256];
    bytes.iter().for_each(|by| histogram[usize::from(*by)] += 1);
    for (by, texels) in (0..=255_u8).zip(histogram).filter(|(by, texels)| *by != 0 && *texels > 0) {
        sorts.insert(by as i8, texels);
    }
    let texels = sorts.values().sum();
    let image = Arc::new(Image::packed(PixelFormat::U8, before.size(), bytes));
    StepChange { image, kind: ChangeKind::Count, texels, sorts: ChangedTexels::Counts(sorts) }
}

fn depths(before: &Image, after: &Image, measure: DepthMeasure) -> StepChange {
    let mut sorts = [0_u64; 4];
    let mut bytes = Vec::with_capacity(before.size()[0] as usize * before.size()[1] as usize * 4);
    for (old, new) in before.rows().zip(after.rows()) {
        for (old, new) in old.chunks_exact(4).zip(new.chunks_exact(4)) {
            let by = if old == new { 0.0 } else { moved(measure, [old, new].map(bytemuck::pod_read_unaligned)) };
            if old != new {
                let sort = match by {
                    f32::NEG_INFINITY => 2,
                    f32::INFINITY => 3,
                    by if by < 0.0 => 0,
                    _ => 1,
                };
                sorts[sort] += 1;
            }
            bytes.extend(by.to_le_bytes());
        }
    }
    let image = Arc::new(Image::packed(PixelFormat::Value32F, before.size(), bytes));
    StepChange { image, kind: ChangeKind::Depth, texels: sorts.iter().sum(), sorts: ChangedTexels::Depths(sorts) }
}

/// Returns by how much the new depth is farther than the old, in the measure's unit: infinite where a surface appeared
/// (−∞) or was cleared (∞), never 0, as the stored bits differ.
fn moved(measure: DepthMeasure, [old, new]: [f32; 2]) -> f32 {
    let by = match (measure.value(old), measure.value(new)) {
        (None, Some(_)) => f64::NEG_INFINITY,
        (Some(_), None) => f64::INFINITY,
        (Some(old), Some(new)) => new - old,
        (None, None) => 0.0,
    };
    let by = by as f32;
    if by == 0.0 || by.is_nan() { f32::MIN_POSITIVE } else { by }
}

fn colors(before: &Image, after: &Image) -> StepChange {
    let mut texels = 0;
    let mut bytes = Vec::with_capacity(before.size()[0] as usize * before.size()[1] as usize * 4);
    for (old, new) in before.rows().zip(after.rows()) {
        for (old, new) in old.chunks_exact(4).zip(new.chunks_exact(4)) {
            let has_changed = old != new;
            texels += u64::from(has_changed);
            bytes.extend([new[0], new[1], new[2], if has_changed { 255 } else { 0 }]);
        }
    }
    let image = Arc::new(Image::packed(after.format(), before.size(), bytes));
    StepChange { image, kind: ChangeKind::Color, texels, sorts: ChangedTexels::Colors }
}

fn ground(colors: &Image) -> Image {
    let grey = |texel: &[u8]| {
        let [red, green, blue] = [texel[0], texel[1], texel[2]].map(f32::from);
        ((0.299 * red + 0.587 * green + 0.114 * blue) * GROUND_LIGHT) as u8
    };
    let rows = colors.rows().flat_map(|row| row.chunks_exact(4));
    let bytes: Vec<u8> = rows.flat_map(|texel| [grey(texel), grey(texel), grey(texel), 255]).collect();
    Image::packed(PixelFormat::Rgba8Srgb, colors.size(), bytes)
}

/// Returns a difference with its sign, such as `+2`; `None` for 0.
pub fn signed(by: i8) -> Option<String> {
    match by {
        0 => None,
        1.. => Some(format!("+{by}")),
        _ => Some(format!("−{}", by.unsigned_abs())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(values: &[u8]) -> Arc<Image> {
        Arc::new(Image::packed(PixelFormat::U8, [values.len() as u32, 1], values.to_vec()))
    }

    #[test]
    fn counts_change_the_shorter_way_round() {
        let change =
            ChangeCache::default().change([&bytes(&[0, 0, 5, 255]), &bytes(&[1, 255, 5, 0])], DepthMeasure::Raw);
        let change = change.expect("pictures of one kind");
        assert_eq!(change.texels, 3);
        assert_eq!(change.sorts, ChangedTexels::Counts(BTreeMap::from([(1, 2), (-1, 1)])));
        assert_eq!(change.image.row(0), [1, 255, 0, 1]);
        assert_eq!(signed(-3).as_deref(), Some("−3"));
        assert_eq!(signed(0), None);
    }

    #[test]
    fn depths_tell_which_way_the_surface_went() {
        let depth = |values: [f32; 4]| {
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            Arc::new(Image::packed(PixelFormat::Depth32F, [4, 1], bytes))
        };
        let measure = DepthMeasure::Perspective { scale: 1.0, offset: 0.0, clear: 0.0 };
        let pair = [depth([0.0, 0.5, 0.25, 0.5]), depth([0.5, 1.0, 0.25, 0.25])];
        let change = ChangeCache::default().change([&pair[0], &pair[1]], measure).expect("pictures of one kind");
        assert_eq!(change.sorts, ChangedTexels::Depths([1, 1, 1, 0]));
        let at = |x| change.image.value_at([x, 0]).expect("a texel");
        assert_eq!([at(1), at(2), at(3)], [-1.0, 0.0, 2.0]);
        assert_eq!(at(0), f32::NEG_INFINITY);
    }

    #[test]
    fn a_change_is_made_once_and_only_of_pictures_of_one_size() {
        let mut cache = ChangeCache::default();
        let pair = [bytes(&[1, 2]), bytes(&[1, 3])];
        let first = cache.change([&pair[0], &pair[1]], DepthMeasure::Raw).expect("a change");
        let again = cache.change([&pair[0], &pair[1]], DepthMeasure::Raw).expect("a change");
        assert!(Arc::ptr_eq(&first.image, &again.image));
        assert_eq!(cache.change([&pair[0], &bytes(&[1])], DepthMeasure::Raw), None);
        assert_eq!(cache.differing([&pair[0], &pair[1]]), Some(1));
    }
}

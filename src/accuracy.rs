//! A technique's labels compared with the ground truth.
//!
//! Compared are the pixels that are lit or in shadow in truth. A technique with any other label is wrong, unless no
//! picture of that size could be certain: the truth itself changes within an eighth of a pixel, or another triangle is
//! visible within the step that the rasteriser snaps corners to. Only for disagreeing pixels are those extra rays cast.
//!
//! Labels do not cover the background, nor how dark a shadow is. So colours are compared too, at every pixel, with the
//! picture of the same shading that is lit by the truth's labels ([`wrong_colors`]): that finds a shadow that hangs
//! over its receiver's edge into the air, and one that is blended twice. It also counts what is meant to differ from
//! hard shadows of opaque casters: soft edges, and light that translucent casters let through.

use crate::numbers;
use crate::truth::{LIT, SHADOW, Tracer, Truth};
use rayon::prelude::*;
use std::ops::Range;

/// How far from a pixel's centre another label excuses a disagreement, in pixels.
pub(crate) const LABEL_REACH: f64 = 1.0 / 8.0;
/// The step that most rasterisers snap corners to, pixels: how far from a pixel's centre another visible triangle then
/// excuses a disagreement.
pub const USUAL_STEP: f64 = 1.0 / 256.0;

/// By how many 8-bit steps (of sRGB, as stored) a channel may differ from the right picture's. Techniques that only
/// decide where light arrives add the same numbers in the same order, and have the same bytes. One that dims stored
/// colours, as shadows that are blended over a lit surface do, multiplies a sum that was rounded to eight bits, half a
/// step, and rounds again: where that is the right colour, its byte may be the next one, and no more.
pub const COLOR_TOLERANCE: u8 = 1;

named_enum! {
    /// How a pixel's label differs from the truth: the value of a pixel of the error picture.
    pub enum Finding {
        /// Truth and technique agree.
        Agrees = "agrees",
        /// Truth: lit. Technique: in shadow.
        FalseShadow = "false_shadow",
        /// Truth: in shadow. Technique: lit.
        MissingShadow = "missing_shadow",
        /// The technique shows another surface, one that faces away, or none.
        WrongSurface = "wrong_surface",
        /// They differ where the truth itself changes: excused.
        EdgeBand = "edge_band",
        /// The truth is background or faces away.
        NotCompared = "not_compared",
    }
}

impl Finding {
    /// Returns the finding with this number, which is its place in [`Finding::ALL`] and the value of its pixels in an
    /// error picture; `None` for any other byte.
    pub fn from_byte(byte: u8) -> Option<Finding> {
        Finding::ALL.get(usize::from(byte)).copied()
    }

    /// Returns whether the finding counts as an error: a false shadow, a missing shadow or a wrong surface. An excused
    /// disagreement ([`Finding::EdgeBand`]) does not.
    pub fn is_wrong(self) -> bool {
        matches!(self, Finding::FalseShadow | Finding::MissingShadow | Finding::WrongSurface)
    }

    /// Compares two labels, without excusing any pixel: `NotCompared` where the truth is neither lit nor in shadow,
    /// `Agrees` where both are equal, `WrongSurface` where the answer is neither lit nor in shadow. Never returns
    /// `EdgeBand`.
    fn of(truth: u8, answer: u8) -> Finding {
        match (truth, answer) {
            (LIT | SHADOW, _) if truth == answer => Finding::Agrees,
            (LIT, SHADOW) => Finding::FalseShadow,
            (SHADOW, LIT) => Finding::MissingShadow,
            (LIT | SHADOW, _) => Finding::WrongSurface,
            _ => Finding::NotCompared,
        }
    }
}

/// Numbers of pixels by finding. With several lights, sums over them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub struct ErrorCounts {
    /// Pixels that are lit or in shadow in truth.
    pub compared: u64,
    /// Pixels that are lit in truth, and in shadow by the technique.
    pub false_shadow: u64,
    /// Pixels that are in shadow in truth, and lit by the technique.
    pub missing_shadow: u64,
    /// Pixels of another surface, or none.
    #[serde(default)]
    pub wrong_surface: u64,
    /// Pixels whose disagreement is excused.
    pub edge_band: u64,
}

impl ErrorCounts {
    /// Returns the number of pixels that are wrong and not excused.
    pub fn wrong(&self) -> u64 {
        self.false_shadow + self.missing_shadow + self.wrong_surface
    }

    /// Returns the share of the compared pixels that are wrong, 0 to 1; 0 where nothing was compared.
    pub fn wrong_fraction(&self) -> f64 {
        if self.compared == 0 { 0.0 } else { self.wrong() as f64 / self.compared as f64 }
    }

    fn of(findings: &[u8]) -> ErrorCounts {
        let mut counts = [0; Finding::ALL.len()];
        findings.iter().for_each(|finding| counts[usize::from(*finding)] += 1);
        let count = |finding: Finding| counts[finding as usize];
        ErrorCounts {
            compared: findings.len() as u64 - count(Finding::NotCompared),
            false_shadow: count(Finding::FalseShadow),
            missing_shadow: count(Finding::MissingShadow),
            wrong_surface: count(Finding::WrongSurface),
            edge_band: count(Finding::EdgeBand),
        }
    }
}

impl std::iter::Sum for ErrorCounts {
    fn sum<I: Iterator<Item = ErrorCounts>>(counts: I) -> ErrorCounts {
        counts.fold(ErrorCounts::default(), |sum, one| ErrorCounts {
            compared: sum.compared + one.compared,
            false_shadow: sum.false_shadow + one.false_shadow,
            missing_shadow: sum.missing_shadow + one.missing_shadow,
            wrong_surface: sum.wrong_surface + one.wrong_surface,
            edge_band: sum.edge_band + one.edge_band,
        })
    }
}

/// How far a technique's visibility of a light, from 0 (dark) to 1 (lit), is from the truth's, over the compared pixels.
/// With several lights, means over all their compared pixels.
///
/// Labels count a pixel as lit or as dark, so that one whose filter mixes in a third of shadow is right or wrong as a
/// whole. This counts the third.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct VisibilityError {
    /// Pixels that are lit or in shadow in truth.
    pub compared: u64,
    /// Light that is missing where the truth is lit, as a share of what all compared pixels could get, 0 to 1.
    pub darkened: f64,
    /// Light that arrives where the truth is in shadow, as a share of what all compared pixels could get, 0 to 1.
    pub lightened: f64,
    /// Pixels that are lit in truth, and where some of the light is missing.
    pub partly_dark: u64,
    /// Pixels that are in shadow in truth, and where some of the light arrives.
    pub partly_lit: u64,
}

impl VisibilityError {
    /// Returns the mean of the differences between the technique's visibility and the truth's, 0 to 1.
    pub fn mean(&self) -> f64 {
        self.darkened + self.lightened
    }

    /// Returns the error in words, without a stop: `of the light of all compared pixels, 1.2 % is missing where it arrives
    /// in truth (300 pixels), and 0 % arrives where it is dark in truth (0 pixels)`.
    pub fn in_words(&self) -> String {
        let percent = |share: f64| numbers::digits(share * 100.0);
        format!(
            "of the light of all compared pixels, {} % is missing where it arrives in truth ({}), and {} % arrives where it \
             is dark in truth ({})",
            percent(self.darkened),
            numbers::counted(self.partly_dark, "pixel"),
            percent(self.lightened),
            numbers::counted(self.partly_lit, "pixel")
        )
    }

    /// Compares a technique's visibility with the truth's labels, in the same order.
    ///
    /// # Panics
    /// If they are not equally many.
    pub fn of(labels: &[u8], visibility: &[f32]) -> VisibilityError {
        assert_eq!(labels.len(), visibility.len(), "pixels with a visibility");
        let mut error = VisibilityError::default();
        for (label, share) in labels.iter().zip(visibility) {
            let share = f64::from(*share);
            match *label {
                LIT => {
                    error.darkened += 1.0 - share;
                    error.partly_dark += u64::from(share < 1.0);
                }
                SHADOW => {
                    error.lightened += share;
                    error.partly_lit += u64::from(share > 0.0);
                }
                _ => continue,
            }
            error.compared += 1;
        }
        error.scaled(1.0 / (error.compared.max(1) as f64))
    }

    /// Returns the error of several lights together, or of several frames; `None` for none.
    pub fn of_all(errors: Vec<VisibilityError>) -> Option<VisibilityError> {
        (!errors.is_empty()).then(|| errors.into_iter().sum())
    }

    fn scaled(self, by: f64) -> VisibilityError {
        VisibilityError { darkened: self.darkened * by, lightened: self.lightened * by, ..self }
    }
}

impl std::iter::Sum for VisibilityError {
    fn sum<I: Iterator<Item = VisibilityError>>(errors: I) -> VisibilityError {
        let sums = errors.fold(VisibilityError::default(), |sum, one| {
            let of_one = one.scaled(one.compared as f64);
            VisibilityError {
                compared: sum.compared + one.compared,
                darkened: sum.darkened + of_one.darkened,
                lightened: sum.lightened + of_one.lightened,
                partly_dark: sum.partly_dark + one.partly_dark,
                partly_lit: sum.partly_lit + one.partly_lit,
            }
        });
        sums.scaled(1.0 / (sums.compared.max(1) as f64))
    }
}

/// Wrong pixels of one kind that touch each other, corners included.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct WrongRegion {
    /// The number of pixels.
    pub pixels: u64,
    /// Their finding.
    pub kind: Finding,
    /// First and last column and row: left, top, right, bottom.
    #[serde(rename = "box")]
    pub bounds: [u32; 4],
    /// One of its pixels: the first in reading order.
    pub at: [u32; 2],
}

/// How a technique's labels for one light differ from the truth: numbers of pixels, a finding for each pixel, and the
/// largest wrong region (`None` where no pixel is wrong).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Accuracy {
    /// Numbers of pixels by finding.
    pub counts: ErrorCounts,
    /// A [`Finding`] for each pixel, row by row.
    pub findings: Vec<u8>,
    /// The largest connected wrong region.
    pub worst: Option<WrongRegion>,
}

/// Compares a technique's labels of one light, given by rows, with the truth that `tracer` has traced. `step` is that to
/// which the rasteriser snaps corners, in pixels.
///
/// # Panics
/// If the rows are not of the truth's size, or there is no such light.
pub fn compare(tracer: &Tracer, truth: &Truth, light: usize, rows: &[&[u8]], step: f64) -> Accuracy {
    Accuracy::of(findings_in(tracer, truth, light, rows, step, 0..rows.len()), truth.size)
}

/// Returns the findings of a `part` of the rows that [`compare`] compares, row by row.
pub(crate) fn findings_in(
    tracer: &Tracer,
    truth: &Truth,
    light: usize,
    rows: &[&[u8]],
    step: f64,
    part: Range<usize>,
) -> Vec<u8> {
    let width = truth.size[0] as usize;
    assert_eq!(rows.len(), truth.size[1] as usize, "rows of labels");
    let labels = &truth.labels[light][part.start * width..part.end * width];
    let mut findings = vec![Finding::NotCompared as u8; labels.len()];
    let by_row = findings.par_chunks_mut(width.max(1)).zip(labels.par_chunks(width.max(1))).zip(&rows[part.clone()]);
    by_row.zip(part).for_each(|(((findings, labels), answers), y)| {
        assert_eq!(answers.len(), width, "labels of a row");
        for (x, ((finding, label), answer)) in findings.iter_mut().zip(labels).zip(*answers).enumerate() {
            let found = Finding::of(*label, *answer);
            let is_excused = found.is_wrong() && is_at_an_edge(tracer, light, *label, [x as u32, y as u32], step);
            *finding = if is_excused { Finding::EdgeBand } else { found } as u8;
        }
    });
    findings
}

impl Accuracy {
    /// Counts the findings of a picture of this size.
    pub(crate) fn of(findings: Vec<u8>, size: [u32; 2]) -> Accuracy {
        Accuracy { counts: ErrorCounts::of(&findings), worst: worst_region(&findings, size), findings }
    }
}

/// Counts the pixels of a picture whose red, green or blue differs from that of the right one by more than
/// [`COLOR_TOLERANCE`], background included. A pixel is excused where no light's label is [wrong](Finding::is_wrong) and
/// the truth of at least one light changes within the distances that excuse labels along edges. `findings` has, for each
/// light with labels, one [`Finding`] byte a pixel; `pictures` are rows of RGBA bytes: the picture and the right one.
/// `step` is that to which the rasteriser snaps corners, in pixels.
///
/// # Panics
/// If rows or findings are not of the truth's size.
pub fn wrong_colors(tracer: &Tracer, truth: &Truth, findings: &[Vec<u8>], pictures: [&[&[u8]]; 2], step: f64) -> u64 {
    wrong_colors_in(tracer, truth, findings, pictures, step, 0..truth.size[1] as usize)
}

/// Returns how many of the pixels that [`wrong_colors`] counts are in a `part` of the rows.
pub(crate) fn wrong_colors_in(
    tracer: &Tracer,
    truth: &Truth,
    findings: &[Vec<u8>],
    [picture, right]: [&[&[u8]]; 2],
    step: f64,
    part: Range<usize>,
) -> u64 {
    let width = truth.size[0] as usize;
    let height = truth.size[1] as usize;
    assert_eq!([picture.len(), right.len()], [height; 2], "rows of pictures");
    let is_wrong = |[x, y]: [usize; 2]| {
        let at = y * width + x;
        let finding = |light: &Vec<u8>| Finding::from_byte(light[at]);
        if findings.iter().filter_map(finding).any(Finding::is_wrong) {
            return true;
        }
        let lights = 0..truth.labels.len();
        let pixel = [x as u32, y as u32];
        !lights.into_iter().any(|light| is_at_an_edge(tracer, light, truth.labels[light][at], pixel, step))
    };
    let of_row = |y: usize| {
        let [shown, right] = [picture[y], right[y]].map(|row| row.as_chunks::<4>().0);
        assert_eq!([shown.len(), right.len()], [width; 2], "pixels of a row");
        let differing = (0..width).filter(|x| differ(shown[*x], right[*x]));
        differing.filter(|x| is_wrong([*x, y])).count() as u64
    };
    part.into_par_iter().map(of_row).sum()
}

/// Returns whether one of the first three channels differs by more than rounding may leave; the fourth is no light.
fn differ(one: [u8; 4], other: [u8; 4]) -> bool {
    (0..3).any(|channel| one[channel].abs_diff(other[channel]) > COLOR_TOLERANCE)
}

/// Returns whether a disagreement at pixel (`x`, `y`) is excused: the truth's label at one of eight points 1/8 pixel
/// around the centre is not `label`, or the triangle visible at one of eight points a `step` around it is not the one at
/// the centre.
fn is_at_an_edge(tracer: &Tracer, light: usize, label: u8, [x, y]: [u32; 2], step: f64) -> bool {
    let center = [f64::from(x) + 0.5, f64::from(y) + 0.5];
    let labels = tracer.labels_at(light, around(center, LABEL_REACH));
    if labels.iter().any(|other| *other != label) {
        return true;
    }
    let [here] = tracer.visible_at([center]);
    tracer.visible_at(around(center, step)).iter().any(|other| *other != here)
}

/// Returns the eight points around a point that are `reach` away along x, along y or along both (those at the corners
/// are √2 times as far). The point itself is left out.
fn around([x, y]: [f64; 2], reach: f64) -> [[f64; 2]; 8] {
    let steps = [[-1, -1], [0, -1], [1, -1], [-1, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];
    steps.map(|[dx, dy]| [x + f64::from(dx) * reach, y + f64::from(dy) * reach])
}

/// Returns the region with the most wrong pixels; of equal ones the first in reading order, `None` where no pixel is
/// wrong.
fn worst_region(findings: &[u8], size: [u32; 2]) -> Option<WrongRegion> {
    wrong_regions(findings.to_vec(), size).into_iter().next()
}

/// Returns the wrong regions of a picture's findings, row by row, the largest first; of equal ones the first in reading
/// order. Pixels of a region have the same finding and touch, corners included; excused pixels belong to none.
pub fn wrong_regions(mut findings: Vec<u8>, size: [u32; 2]) -> Vec<WrongRegion> {
    let is_wrong = |byte: u8| Finding::from_byte(byte).is_some_and(Finding::is_wrong);
    let mut regions = Vec::new();
    for start in 0..findings.len() {
        if is_wrong(findings[start]) {
            regions.push(take_region(&mut findings, start, size));
        }
    }
    regions.sort_by_key(|region| std::cmp::Reverse(region.pixels));
    regions
}

/// Sets the region that contains pixel number `start` to `NotCompared` in `left`, and returns its size, kind and
/// bounds. `start` must be its first pixel in reading order, which becomes [`WrongRegion::at`].
fn take_region(left: &mut [u8], start: usize, size: [u32; 2]) -> WrongRegion {
    let kind = Finding::from_byte(left[start]).unwrap_or(Finding::WrongSurface);
    let at = place(start, size);
    let mut region = WrongRegion { pixels: 0, kind, bounds: [at[0], at[1], at[0], at[1]], at };
    take_connected(left, Finding::NotCompared as u8, start, size, 1, |index| {
        let [x, y] = place(index, size);
        let [low_x, low_y, high_x, high_y] = region.bounds;
        region.bounds = [low_x.min(x), low_y.min(y), high_x.max(x), high_y.max(y)];
        region.pixels += 1;
    });
    region
}

/// Returns the column and row, from the top left, of the pixel with this index in row-major order.
pub(crate) fn place(index: usize, [width, _]: [u32; 2]) -> [u32; 2] {
    [(index % width as usize) as u32, (index / width as usize) as u32]
}

/// Takes the pixels that are connected with `start` and have its value: each is passed to `taken` and then set to
/// `none`. Pixels are connected that are at most `reach` columns and rows apart.
pub(crate) fn take_connected<T: Copy + PartialEq>(
    left: &mut [T],
    none: T,
    start: usize,
    [width, height]: [u32; 2],
    reach: u32,
    mut taken: impl FnMut(usize),
) {
    let label = left[start];
    let mut open = vec![start];
    left[start] = none;
    while let Some(index) = open.pop() {
        taken(index);
        let [x, y] = place(index, [width, height]);
        for near_y in y.saturating_sub(reach)..=(y + reach).min(height - 1) {
            for near_x in x.saturating_sub(reach)..=(x + reach).min(width - 1) {
                let near = near_y as usize * width as usize + near_x as usize;
                if left[near] == label {
                    left[near] = none;
                    open.push(near);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth::FACES_AWAY;

    #[test]
    fn every_pair_of_labels_has_its_finding() {
        use Finding::{Agrees, FalseShadow, MissingShadow, NotCompared, WrongSurface};
        let expected = [
            [Agrees, FalseShadow, WrongSurface, WrongSurface],
            [MissingShadow, Agrees, WrongSurface, WrongSurface],
            [NotCompared; 4],
            [NotCompared; 4],
        ];
        for truth in LIT..=FACES_AWAY {
            for answer in LIT..=FACES_AWAY {
                assert_eq!(Finding::of(truth, answer), expected[usize::from(truth)][usize::from(answer)]);
            }
        }
    }

    #[test]
    fn partly_dark_pixels_are_counted_by_their_shares() {
        let labels = [LIT, LIT, SHADOW, SHADOW, FACES_AWAY, LIT];
        let error = VisibilityError::of(&labels, &[1.0, 0.75, 0.0, 0.5, 0.0, 0.25]);
        let expected = VisibilityError { compared: 5, darkened: 0.2, lightened: 0.1, partly_dark: 2, partly_lit: 1 };
        assert_eq!(error, expected);
        assert!((error.mean() - 0.3).abs() < 1e-15);
        let none = VisibilityError::of(&[LIT; 5], &[1.0; 5]);
        let both: VisibilityError = [error, none].into_iter().sum();
        assert_eq!((both.compared, both.partly_dark), (10, 2));
        assert!((both.darkened - 0.1).abs() < 1e-15 && (both.lightened - 0.05).abs() < 1e-15);
    }

    /// Two regions of false shadow that touch at a corner are one; missing shadow beside it is another.
    #[test]
    fn the_largest_region_is_found_and_measured() {
        let picture = [
            [1, 1, 0, 0, 0, 3], //
            [0, 0, 1, 2, 2, 0],
            [4, 4, 4, 2, 0, 0],
            [4, 4, 4, 4, 5, 5],
        ];
        let worst = worst_region(picture.as_flattened(), [6, 4]).expect("a region");
        assert_eq!(worst, WrongRegion { pixels: 3, kind: Finding::FalseShadow, bounds: [0, 0, 2, 1], at: [0, 0] });
        assert_eq!(worst_region(&[0, 4, 5, 0], [2, 2]), None);
        let counts = ErrorCounts::of(picture.as_flattened());
        let expected = ErrorCounts { compared: 22, false_shadow: 3, missing_shadow: 3, wrong_surface: 1, edge_band: 7 };
        assert_eq!((counts, counts.wrong()), (expected, 7));
        assert_eq!([counts, counts].into_iter().sum::<ErrorCounts>().compared, 44);
    }
}

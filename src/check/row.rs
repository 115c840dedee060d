//! One scene by one technique: what was drawn, and how it stands beside the reference.

use super::{LabelsHash, ReferenceRow};
use crate::accuracy::ErrorCounts;
use crate::diagnosis::{Cause, Diagnosis, Proof, RegionKind};
use crate::numbers;
use crate::technique::Technique;
use std::collections::BTreeMap;

/// A technique's frame of a scene, on the adapter that is checked and on the reference adapter.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckedRow {
    /// The technique, with default settings.
    pub technique: Technique,
    /// What it drew; the reason in words where it could not draw the scene.
    pub drawn: Result<DrawnRow, String>,
    /// What it drew on the reference adapter; `None` where it could not, or was not tried.
    pub reference: Option<ReferenceRow>,
}

/// What a technique drew of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnRow {
    /// Hash of its labels.
    pub labels: LabelsHash,
    /// How they differ from the truth, summed over the lights.
    pub error: ErrorCounts,
    /// Median wall time of a frame without capture, milliseconds.
    pub frame_ms: f64,
    /// How many frames that is the median of.
    pub timed_frames: usize,
    /// Median time that the GPU's timestamps give for a frame's passes, milliseconds; `None` where it has none,
    /// or only one frame was timed.
    pub gpu_ms: Option<f64>,
    /// For each cause that a diagnosis has proven, how many of the wrong pixels it explains. Empty where nothing was
    /// diagnosed: only what is [beyond the reference](CheckedRow::is_beyond) is.
    pub causes: BTreeMap<Cause, u64>,
    /// Why the wrong pixels could not be diagnosed, in words; `None` where they were, or did not need to be.
    pub undiagnosed: Option<String>,
}

/// How a row stands beside the reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowVerdict {
    /// The labels are the reference's, pixel for pixel.
    Equal,
    /// Some labels are not the reference's, but no more are wrong than there.
    NoMoreWrong,
    /// More pixels are wrong than on the reference adapter.
    Wrong {
        /// How many of those more have no proven cause.
        unexplained: u64,
    },
    /// No pixel is wrong, and there is no reference to compare with.
    NoReference,
    /// The technique can't draw the scene, here or on the reference adapter.
    NotDrawn,
    /// The technique can't draw the scene here, and could on the reference adapter.
    Failed,
}

impl RowVerdict {
    /// Returns its name in JSON.
    pub fn name(self) -> &'static str {
        match self {
            RowVerdict::Equal => "equal",
            RowVerdict::NoMoreWrong => "no more wrong",
            RowVerdict::Wrong { .. } => "wrong",
            RowVerdict::NoReference => "no reference",
            RowVerdict::NotDrawn => "not drawn",
            RowVerdict::Failed => "failed",
        }
    }

    /// Returns whether there is something about the row that nothing known explains.
    pub fn is_unexplained(self) -> bool {
        matches!(self, RowVerdict::Wrong { unexplained: 1.. } | RowVerdict::Failed)
    }
}

impl DrawnRow {
    /// Returns the number of wrong pixels that no proven cause explains.
    fn unproven(&self) -> u64 {
        self.error.wrong().saturating_sub(self.causes.values().sum())
    }

    /// Returns the causes of wrong pixels, with how many each explains: `9 by acne, 2 by aliasing`; empty for none.
    pub fn causes_in_words(&self) -> String {
        let words = |(cause, pixels): (&Cause, &u64)| format!("{} by {}", numbers::count(*pixels), cause.name());
        self.causes.iter().map(words).collect::<Vec<_>>().join(", ")
    }
}

impl CheckedRow {
    /// Returns whether more pixels are wrong than on the reference adapter: then their causes are to be looked for.
    pub fn is_beyond(&self) -> bool {
        self.beyond() > 0
    }

    /// Returns how many pixels are wrong beyond the reference's own number.
    fn beyond(&self) -> u64 {
        let wrong = self.drawn.as_ref().map_or(0, |drawn| drawn.error.wrong());
        wrong.saturating_sub(self.reference.as_ref().map_or(0, |reference| reference.wrong))
    }

    /// Returns how the row stands beside the reference.
    pub fn verdict(&self) -> RowVerdict {
        let drawn = match (&self.drawn, &self.reference) {
            (Ok(drawn), _) => drawn,
            (Err(_), None) => return RowVerdict::NotDrawn,
            (Err(_), Some(_)) => return RowVerdict::Failed,
        };
        let is_equal = self.reference.as_ref().map(|reference| reference.labels == drawn.labels);
        match (is_equal, self.is_beyond()) {
            // A limit that the reference shares leaves as many without a cause there.
            (_, true) => {
                let on_reference = self.reference.as_ref().map_or(0, ReferenceRow::unproven);
                let unexplained = drawn.unproven().saturating_sub(on_reference).min(self.beyond());
                RowVerdict::Wrong { unexplained }
            }
            (Some(true), false) => RowVerdict::Equal,
            (Some(false), false) => RowVerdict::NoMoreWrong,
            (None, false) => RowVerdict::NoReference,
        }
    }

    /// Returns the verdict with its numbers, in words: `wrong: 4 pixels, 1 on the reference adapter; 3 by acne`.
    pub fn in_words(&self) -> String {
        let drawn = match &self.drawn {
            Ok(drawn) => drawn,
            Err(reason) => return format!("{}: {reason}", self.verdict().name()),
        };
        match self.verdict() {
            RowVerdict::NoMoreWrong => {
                let on_reference = self.reference.as_ref().map_or(0, |reference| reference.wrong);
                let [wrong, excused, there] =
                    [drawn.error.wrong(), drawn.error.edge_band, on_reference].map(numbers::count);
                format!("other labels, {wrong} wrong and {excused} excused; {there} wrong on the reference adapter")
            }
            RowVerdict::Wrong { unexplained } => {
                let wrong = numbers::counted(drawn.error.wrong(), "pixel");
                let reference = match &self.reference {
                    Some(reference) => format!("{} on the reference adapter", numbers::count(reference.wrong)),
                    None => "no reference".to_owned(),
                };
                let causes = Some(drawn.causes_in_words()).filter(|causes| !causes.is_empty());
                let unexplained = (unexplained > 0).then(|| format!("{} unexplained", numbers::count(unexplained)));
                let undiagnosed = drawn.undiagnosed.as_ref().map(|reason| format!("not diagnosed: {reason}"));
                let parts = [causes, unexplained, undiagnosed].into_iter().flatten();
                parts.fold(format!("wrong: {wrong}, {reference}"), |text, part| format!("{text}; {part}"))
            }
            verdict => verdict.name().to_owned(),
        }
    }
}

/// Returns, for each cause that a diagnosis proves, in how many pixels with a wrong label it does. Of several proven
/// causes of a region the most likely one counts.
pub fn proven_causes(diagnosis: &Diagnosis) -> BTreeMap<Cause, u64> {
    let mut causes = BTreeMap::new();
    for region in diagnosis.regions.iter().filter(|region| matches!(region.kind, RegionKind::Wrong(_))) {
        if let Some(found) = region.causes.iter().find(|found| found.proof == Proof::Proven) {
            *causes.entry(found.cause).or_default() += region.pixels;
        }
    }
    causes
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in crate::check) fn hash(byte: u8) -> LabelsHash {
        LabelsHash::of([Some([&[byte][..]])])
    }

    /// A row with wrong pixels and causes here, and the same of the reference; labels are equal where both are.
    pub(in crate::check) fn row(
        here: (u64, &[(Cause, u64)]),
        reference: Option<(u64, &[(Cause, u64)])>,
        is_equal: bool,
    ) -> CheckedRow {
        let causes = |list: &[(Cause, u64)]| list.iter().copied().collect();
        let error = ErrorCounts { compared: 1000, false_shadow: here.0, edge_band: 3, ..ErrorCounts::default() };
        let drawn = DrawnRow {
            labels: hash(u8::from(is_equal)),
            error,
            frame_ms: 4.25,
            timed_frames: 3,
            gpu_ms: Some(3.5),
            causes: causes(here.1),
            undiagnosed: None,
        };
        let technique = Technique::ZFail;
        let reference = reference.map(|(wrong, list)| ReferenceRow {
            technique,
            labels: hash(1),
            wrong,
            edge_band: 2,
            causes: causes(list),
        });
        CheckedRow { technique, drawn: Ok(drawn), reference }
    }

    #[test]
    fn equal_labels_are_equal_however_many_are_wrong() {
        assert_eq!(row((0, &[]), Some((0, &[])), true).verdict(), RowVerdict::Equal);
        let limit = row((812, &[]), Some((812, &[(Cause::Wrap256, 812)])), true);
        assert_eq!((limit.verdict(), limit.in_words()), (RowVerdict::Equal, "equal".to_owned()));
    }

    #[test]
    fn other_labels_say_so_while_no_more_are_wrong() {
        let differs = row((0, &[]), Some((0, &[])), false);
        assert_eq!(differs.verdict(), RowVerdict::NoMoreWrong);
        assert_eq!(differs.in_words(), "other labels, 0 wrong and 3 excused; 0 wrong on the reference adapter");
        assert_eq!(row((7, &[]), Some((8, &[])), false).verdict(), RowVerdict::NoMoreWrong);
        assert_eq!(row((0, &[]), None, false).verdict(), RowVerdict::NoReference);
    }

    #[test]
    fn only_what_is_beyond_the_reference_and_unproven_is_unexplained() {
        let unexplained = |here, reference| row(here, reference, false).verdict();
        let wrong = |unexplained| RowVerdict::Wrong { unexplained };
        assert_eq!(unexplained((1, &[]), Some((0, &[]))), wrong(1));
        assert_eq!(unexplained((9, &[(Cause::Acne, 9)]), Some((8, &[(Cause::Acne, 8)]))), wrong(0), "proven");
        assert_eq!(unexplained((9, &[(Cause::Acne, 5)]), Some((8, &[(Cause::Acne, 8)]))), wrong(1), "one more");
        assert_eq!(unexplained((9, &[(Cause::Acne, 4)]), Some((5, &[]))), wrong(0), "as many unproven there");
        assert_eq!(unexplained((2, &[]), None), wrong(2), "without a reference");
        assert!(wrong(1).is_unexplained() && !wrong(0).is_unexplained());
    }

    #[test]
    fn a_wrong_row_says_numbers_and_causes() {
        let text = row((9, &[(Cause::Acne, 5), (Cause::Aliasing, 1)]), Some((2, &[])), false).in_words();
        assert_eq!(text, "wrong: 9 pixels, 2 on the reference adapter; 5 by acne, 1 by aliasing; 1 unexplained");
        let mut undiagnosed = row((1, &[]), None, false);
        if let Ok(drawn) = &mut undiagnosed.drawn {
            drawn.undiagnosed = Some("the GPU failed".to_owned());
        }
        let text = "wrong: 1 pixel, no reference; 1 unexplained; not diagnosed: the GPU failed";
        assert_eq!(undiagnosed.in_words(), text);
    }

    #[test]
    fn what_only_the_reference_could_draw_is_unexplained() {
        let failed =
            |reference| CheckedRow { drawn: Err("the GPU failed".to_owned()), ..row((0, &[]), reference, true) };
        assert_eq!(failed(Some((0, &[]))).verdict(), RowVerdict::Failed);
        assert!(failed(Some((0, &[]))).verdict().is_unexplained());
        assert_eq!(failed(None).verdict(), RowVerdict::NotDrawn);
        assert_eq!(failed(None).in_words(), "not drawn: the GPU failed");
    }
}

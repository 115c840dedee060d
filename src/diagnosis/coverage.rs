//! How much of another program's picture could be compared with a truth, and why the rest could not: said before anything
//! is called right or wrong.

use crate::numbers;
use crate::truth::{BACKGROUND, LIT, SHADOW};

named_enum! {
    /// Why a pixel is not compared.
    pub enum NotCompared (
        /// Returns the reason as the end of a sentence that begins with a number of pixels.
        in_words
    ) {
        /// No depth is stored there.
        NoSurface = "no_surface" ("have no surface"),
        /// Depth is stored there, and no triangle of the frame is known to have made it, as where another picture's depth
        /// is used.
        UnknownSurface = "unknown_surface" ("have a surface that no known triangle draws"),
        /// The surface faces away from the light, and is dark with and without a shadow.
        FacesAway = "faces_away" ("face away from the light"),
        /// A spot light's map does not cover the surface, and what lights it, if anything, is not known.
        OutsideMap = "outside_map" ("lie outside of what the map of a spot light covers"),
        /// No draw of the light lets the stencil decide.
        NoLabel = "no_label" ("are lit or dark by no stencil test"),
        /// There is no light, or it is not known where it is.
        NoLight = "no_light" ("have no light that is known"),
    }
}

impl NotCompared {
    /// Returns whether a shadow could darken such pixels.
    fn is_comparable(self) -> bool {
        !matches!(self, NotCompared::NoSurface | NotCompared::FacesAway | NotCompared::OutsideMap)
    }
}

/// How many pixels were compared with the truth of a light, and why the others were not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TruthCoverage {
    /// The pixels of the picture.
    pub pixels: u64,
    /// Those that were compared.
    pub compared: u64,
    /// Those that were not, by reason, in the order of [`NotCompared::ALL`].
    not_compared: [u64; NotCompared::ALL.len()],
}

impl TruthCoverage {
    /// Where fewer of the pixels that could be compared are, nothing is called right or wrong: one in so many.
    const LEAST: u64 = 10;

    /// Returns the coverage of a light: of its labels in truth and, where there are some, the program's, a byte a pixel.
    /// Pixels that have both are compared, where they are lit or in shadow in truth. `outside` says which pixels a spot light's
    /// map does not cover; of them there is no truth.
    ///
    /// # Panics
    /// If they are not equally many.
    pub fn of_labels(truth: &[u8], own: Option<&[u8]>, outside: Option<&[bool]>) -> TruthCoverage {
        assert!(own.is_none_or(|own| truth.len() == own.len()), "labels of a picture");
        let mut coverage = TruthCoverage { pixels: truth.len() as u64, ..TruthCoverage::default() };
        for (index, truth) in truth.iter().enumerate() {
            let because = match (*truth, own.map(|own| own[index])) {
                (LIT | SHADOW, Some(_)) => {
                    coverage.compared += 1;
                    continue;
                }
                (LIT | SHADOW, None) => NotCompared::NoLabel,
                (BACKGROUND, _) if outside.is_some_and(|outside| outside[index]) => NotCompared::OutsideMap,
                (BACKGROUND, Some(BACKGROUND) | None) => NotCompared::NoSurface,
                (BACKGROUND, Some(_)) => NotCompared::UnknownSurface,
                _ => NotCompared::FacesAway,
            };
            coverage.not_compared[because as usize] += 1;
        }
        coverage
    }

    /// Returns the coverage of a picture without a known light: `surfaces` says for each pixel whether depth is stored there.
    pub fn without_light(surfaces: impl IntoIterator<Item = bool>) -> TruthCoverage {
        let mut coverage = TruthCoverage::default();
        for has_surface in surfaces {
            let because = if has_surface { NotCompared::NoLight } else { NotCompared::NoSurface };
            coverage.not_compared[because as usize] += 1;
            coverage.pixels += 1;
        }
        coverage
    }

    /// Returns why nothing is called right or wrong where [too little](TruthCoverage::is_too_little) is compared, in a
    /// sentence without a stop: by what most pixels that a shadow could darken lack.
    pub fn why_too_little(&self) -> &'static str {
        let most = self.reasons().into_iter().find(|(because, _)| because.is_comparable());
        match most.map(|(because, _)| because) {
            Some(NotCompared::UnknownSurface) => {
                "most surfaces are drawn by no triangle that is known, as where another picture's depth is used"
            }
            Some(NotCompared::NoLabel) => "no draw lets a stencil test decide what this light reaches",
            Some(NotCompared::NoLight) => "it is not known where a light is",
            _ => "no pixel shows a surface that faces the light",
        }
    }

    /// Returns the reasons for which pixels are not compared, and how many each explains: those that explain some, the most
    /// first.
    pub fn reasons(&self) -> Vec<(NotCompared, u64)> {
        let all = NotCompared::ALL.into_iter().zip(self.not_compared);
        let mut reasons: Vec<(NotCompared, u64)> = all.filter(|(_, pixels)| *pixels > 0).collect();
        reasons.sort_by_key(|(_, pixels)| std::cmp::Reverse(*pixels));
        reasons
    }

    /// Returns the pixels whose label a shadow decides: all but those without a surface, and those that face away.
    fn comparable(&self) -> u64 {
        let of_reasons = self.reasons().into_iter().filter(|(because, _)| because.is_comparable());
        self.compared + of_reasons.map(|(_, pixels)| pixels).sum::<u64>()
    }

    /// Returns whether so little is compared that nothing may be called right or wrong: nothing at all, or less than a tenth
    /// of what could be.
    pub fn is_too_little(&self) -> bool {
        self.compared == 0 || self.compared * TruthCoverage::LEAST < self.comparable()
    }

    /// Returns the coverage in a sentence, without a stop: `compared 278 112 of 318 120 pixels; 40 008 not: 28 008 have no
    /// surface, 12 000 face away from the light`.
    pub fn in_words(&self) -> String {
        let rest = self.pixels - self.compared;
        let [compared, pixels] = [self.compared, self.pixels].map(numbers::count);
        let mut words = format!("compared {compared} of {pixels} pixels");
        if rest > 0 {
            let reason =
                |(because, pixels): &(NotCompared, u64)| format!("{} {}", numbers::count(*pixels), because.in_words());
            let reasons: Vec<String> = self.reasons().iter().map(reason).collect();
            words += &format!("; {} not: {}", numbers::count(rest), reasons.join(", "));
        }
        words
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth::FACES_AWAY;

    #[test]
    fn every_pixel_is_compared_or_has_a_reason() {
        let truth = [LIT, SHADOW, BACKGROUND, BACKGROUND, FACES_AWAY, LIT];
        let own = [LIT, LIT, BACKGROUND, SHADOW, LIT, BACKGROUND];
        let coverage = TruthCoverage::of_labels(&truth, Some(&own), None);
        assert_eq!((coverage.pixels, coverage.compared), (6, 3));
        assert_eq!(
            coverage.reasons(),
            [(NotCompared::NoSurface, 1), (NotCompared::UnknownSurface, 1), (NotCompared::FacesAway, 1)]
        );
        assert_eq!(
            coverage.in_words(),
            "compared 3 of 6 pixels; 3 not: 1 have no surface, 1 have a surface that no known triangle draws, 1 face away \
             from the light"
        );
        assert!(!coverage.is_too_little());
        let coverage = TruthCoverage::of_labels(&truth, None, None);
        assert_eq!(
            coverage.reasons(),
            [(NotCompared::NoLabel, 3), (NotCompared::NoSurface, 2), (NotCompared::FacesAway, 1)]
        );
        assert!(coverage.is_too_little() && coverage.why_too_little().contains("stencil test"));
        let outside = [false, false, false, true, false, false];
        let coverage = TruthCoverage::of_labels(&truth, Some(&own), Some(&outside));
        assert_eq!(coverage.compared, 3);
        assert!(coverage.reasons().contains(&(NotCompared::OutsideMap, 1)), "{:?}", coverage.reasons());
    }

    #[test]
    fn a_tenth_of_what_could_be_compared_is_enough_and_less_is_not() {
        let coverage = |compared: usize, unknown: usize, none: usize| {
            let truth = [vec![LIT; compared], vec![BACKGROUND; unknown + none]].concat();
            let own = [vec![LIT; compared + unknown], vec![BACKGROUND; none]].concat();
            TruthCoverage::of_labels(&truth, Some(&own), None)
        };
        assert!(!coverage(10, 90, 0).is_too_little());
        assert!(coverage(9, 91, 0).is_too_little());
        assert!(coverage(9, 91, 0).why_too_little().contains("no triangle that is known"));
        // A small thing before the sky is compared whole.
        assert!(!coverage(1, 0, 9999).is_too_little());
        assert!(coverage(0, 0, 100).is_too_little() && coverage(0, 0, 0).is_too_little());
        assert!(coverage(0, 0, 100).why_too_little().contains("faces the light"));
        let nothing = TruthCoverage::without_light([true, false, true]);
        assert!(nothing.is_too_little() && nothing.why_too_little().contains("where a light is"));
        assert_eq!(
            nothing.in_words(),
            "compared 0 of 3 pixels; 3 not: 2 have no light that is known, 1 have no surface"
        );
    }
}

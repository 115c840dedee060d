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
        /// Nothing is drawn there.
        NoSurface = "no_surface" ("have no surface"),
        /// Depth is stored there, and no triangle of the frame is known to have made it, as where another picture's depth
        /// is used.
        UnknownSurface = "unknown_surface" ("have a surface that no known triangle draws"),
        /// The surface faces away from the light, and is dark with and without a shadow.
        FacesAway = "faces_away" ("face away from the light"),
        /// No draw tells lit from dark by the stencil.
        NoLabel = "no_label" ("are lit or dark by no stencil test"),
        /// It is not known where the light is.
        NoLight = "no_light" ("belong to a light that was not found"),
    }
}

/// How many pixels were compared with the truth, and why the others were not. With several lights, sums over them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Coverage {
    /// The pixels of the picture.
    pub pixels: u64,
    /// Those that were compared.
    pub compared: u64,
    /// Those that were not, by reason, in the order of [`NotCompared::ALL`].
    not_compared: [u64; NotCompared::ALL.len()],
}

impl Coverage {
    /// Where fewer of the pixels that could be compared are, nothing is called right or wrong: one in so many.
    const LEAST: u64 = 10;

    /// Returns the coverage of a light's labels: its truth's and the program's, a byte a pixel. Pixels that are lit or in
    /// shadow in truth are compared.
    ///
    /// # Panics
    /// If they are not equally many.
    pub fn of_labels(truth: &[u8], own: &[u8]) -> Coverage {
        assert_eq!(truth.len(), own.len(), "labels of a picture");
        let mut coverage = Coverage { pixels: truth.len() as u64, ..Coverage::default() };
        for (truth, own) in truth.iter().zip(own) {
            let because = match (*truth, *own) {
                (LIT | SHADOW, _) => {
                    coverage.compared += 1;
                    continue;
                }
                (BACKGROUND, BACKGROUND) => NotCompared::NoSurface,
                (BACKGROUND, _) => NotCompared::UnknownSurface,
                _ => NotCompared::FacesAway,
            };
            coverage.not_compared[because as usize] += 1;
        }
        coverage
    }

    /// Returns the coverage of a picture of which no pixel is compared, for one reason.
    pub fn nothing(size: [u32; 2], because: NotCompared) -> Coverage {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let mut coverage = Coverage { pixels, ..Coverage::default() };
        coverage.not_compared[because as usize] = pixels;
        coverage
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
        let of = |because: NotCompared| self.not_compared[because as usize];
        self.pixels - of(NotCompared::NoSurface) - of(NotCompared::FacesAway)
    }

    /// Returns whether so little is compared that nothing may be called right or wrong: nothing at all, or less than a tenth
    /// of what could be.
    pub fn is_too_little(&self) -> bool {
        self.compared == 0 || self.compared * Coverage::LEAST < self.comparable()
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

impl std::iter::Sum for Coverage {
    fn sum<I: Iterator<Item = Coverage>>(all: I) -> Coverage {
        all.fold(Coverage::default(), |mut sum, one| {
            sum.pixels += one.pixels;
            sum.compared += one.compared;
            sum.not_compared.iter_mut().zip(one.not_compared).for_each(|(sum, one)| *sum += one);
            sum
        })
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
        let coverage = Coverage::of_labels(&truth, &own);
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
    }

    #[test]
    fn a_tenth_of_what_could_be_compared_is_enough_and_less_is_not() {
        let coverage = |compared: usize, unknown: usize, none: usize| {
            let truth = [vec![LIT; compared], vec![BACKGROUND; unknown + none]].concat();
            let own = [vec![LIT; compared + unknown], vec![BACKGROUND; none]].concat();
            Coverage::of_labels(&truth, &own)
        };
        assert!(!coverage(10, 90, 0).is_too_little());
        assert!(coverage(9, 91, 0).is_too_little());
        // A small thing before the sky is compared whole.
        assert!(!coverage(1, 0, 9999).is_too_little());
        assert!(coverage(0, 0, 100).is_too_little() && coverage(0, 0, 0).is_too_little());
        let nothing = Coverage::nothing([10, 20], NotCompared::NoLight);
        assert!(nothing.is_too_little());
        assert_eq!(nothing.in_words(), "compared 0 of 200 pixels; 200 not: 200 belong to a light that was not found");
        assert_eq!([coverage(9, 91, 0), nothing].into_iter().sum::<Coverage>().pixels, 300);
    }
}

//! What was measured about a cause, and whether that is enough to call it by its name.
//!
//! A fix such as another technique takes nearly any wrong pixel away, so a fix that helps does not prove its cause.
//! Every rule therefore leaves the numbers that it decided by, and one place decides whether they hold:
//! [`Evidence::holds`].

use super::Proof;
use crate::numbers;

/// What a rule has measured about one cause at the pixels of one region.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence {
    /// What was measured, in a sentence without its stop.
    pub sentence: String,
    /// The numbers by which the rule decides, at the first pixel that shows the cause; all of them must hold.
    pub quantities: Vec<Quantity>,
    /// The number of examined pixels that show the cause; 1 where a whole frame is examined by its states.
    pub shown_by: usize,
    /// The number of examined pixels; 1 where a whole frame is examined by its states.
    pub examined: usize,
}

/// A measured number and what it must be for the cause to bear its name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// What was measured, with its unit.
    pub what: &'static str,
    /// The measured number.
    pub value: f64,
    /// What it is held against.
    pub threshold: Threshold,
}

/// What a measured number is held against.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Threshold {
    /// This number or more.
    AtLeast(f64),
    /// More than this number.
    MoreThan(f64),
    /// This number or less.
    AtMost(f64),
    /// Less than this number.
    LessThan(f64),
}

impl Threshold {
    /// Returns the number itself.
    pub fn number(self) -> f64 {
        match self {
            Threshold::AtLeast(bound)
            | Threshold::MoreThan(bound)
            | Threshold::AtMost(bound)
            | Threshold::LessThan(bound) => bound,
        }
    }

    /// Returns the comparison in words: `at least`.
    pub fn words(self) -> &'static str {
        match self {
            Threshold::AtLeast(_) => "at least",
            Threshold::MoreThan(_) => "more than",
            Threshold::AtMost(_) => "at most",
            Threshold::LessThan(_) => "less than",
        }
    }
}

impl Quantity {
    /// Returns a number that must be `bound` or more.
    pub fn at_least(what: &'static str, value: f64, bound: f64) -> Quantity {
        Quantity { what, value, threshold: Threshold::AtLeast(bound) }
    }

    /// Returns a number that must be more than `bound`.
    pub fn more_than(what: &'static str, value: f64, bound: f64) -> Quantity {
        Quantity { what, value, threshold: Threshold::MoreThan(bound) }
    }

    /// Returns a number that must be `bound` or less.
    pub fn at_most(what: &'static str, value: f64, bound: f64) -> Quantity {
        Quantity { what, value, threshold: Threshold::AtMost(bound) }
    }

    /// Returns a number that must be less than `bound`.
    pub fn less_than(what: &'static str, value: f64, bound: f64) -> Quantity {
        Quantity { what, value, threshold: Threshold::LessThan(bound) }
    }

    /// Returns whether the number is what it must be; false for what is not a number.
    pub fn holds(&self) -> bool {
        let Quantity { value, threshold, .. } = *self;
        match threshold {
            Threshold::AtLeast(bound) => value >= bound,
            Threshold::MoreThan(bound) => value > bound,
            Threshold::AtMost(bound) => value <= bound,
            Threshold::LessThan(bound) => value < bound,
        }
    }
}

impl Evidence {
    /// Returns evidence from the states and volumes of a whole frame, in which no single pixels are examined.
    pub(crate) fn of_frame(sentence: String, quantity: Quantity) -> Evidence {
        Evidence { sentence, quantities: vec![quantity], shown_by: 1, examined: 1 }
    }

    /// Returns whether the numbers carry the cause's name for the region: all of them hold, there are some, and half of
    /// the examined pixels or more show them.
    pub fn holds(&self) -> bool {
        self.numbers_hold() && 2 * self.shown_by >= self.examined
    }

    /// Returns whether the numbers hold where the cause shows, on however few pixels that is.
    pub fn numbers_hold(&self) -> bool {
        self.shown_by > 0 && !self.quantities.is_empty() && self.quantities.iter().all(Quantity::holds)
    }

    /// Returns what the run of a fix proves of the cause: that it takes all wrong pixels away is a proof only where the
    /// evidence holds, and else shows no more than that the fix helps.
    pub(crate) fn proof(&self, run: Proof) -> Proof {
        match run {
            Proof::Proven if !self.holds() => Proof::Part,
            run => run,
        }
    }

    /// Returns why the evidence does not hold, in words without a stop; `None` where it holds.
    pub fn why_not(&self) -> Option<String> {
        let failing = self.quantities.iter().find(|quantity| !quantity.holds());
        match failing {
            Some(Quantity { what, value, threshold }) => Some(format!(
                "{what}: {}, and it should be {} {}",
                numbers::digits(*value),
                threshold.words(),
                numbers::digits(threshold.number())
            )),
            None if self.holds() => None,
            None => Some(format!("{} of {} examined pixels show it", self.shown_by, self.examined)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn evidence(quantities: Vec<Quantity>, shown_by: usize) -> Evidence {
        Evidence { sentence: "the bias is 0 m".to_owned(), quantities, shown_by, examined: 4 }
    }

    #[test]
    fn a_fix_that_helps_proves_nothing_without_numbers_that_hold() {
        let bias = |metres| Quantity::at_least("the bias, in metres", metres, 0.5);
        let held = evidence(vec![bias(0.5)], 2);
        assert!(held.holds() && held.why_not().is_none());
        assert_eq!(held.proof(Proof::Proven), Proof::Proven);
        let fails = evidence(vec![bias(0.5), bias(0.0)], 4);
        assert_eq!(fails.proof(Proof::Proven), Proof::Part);
        assert_eq!(fails.why_not().as_deref(), Some("the bias, in metres: 0, and it should be at least 0.5000"));
        let rare = evidence(vec![bias(1.0)], 1);
        assert_eq!((rare.proof(Proof::Proven), rare.numbers_hold()), (Proof::Part, true));
        assert_eq!(rare.why_not().as_deref(), Some("1 of 4 examined pixels show it"));
        assert_eq!(evidence(Vec::new(), 4).proof(Proof::Proven), Proof::Part);
        assert_eq!(fails.proof(Proof::NotIt), Proof::NotIt);
    }

    #[test]
    fn what_is_no_number_holds_nothing() {
        let of = |make: fn(&'static str, f64, f64) -> Quantity, value| make("gap", value, 1.0).holds();
        for make in [Quantity::at_least, Quantity::more_than, Quantity::at_most, Quantity::less_than] {
            assert!(!of(make, f64::NAN));
        }
        assert!(of(Quantity::at_least, 1.0) && of(Quantity::at_most, 1.0));
        assert!(!of(Quantity::more_than, 1.0) && !of(Quantity::less_than, 1.0));
    }
}

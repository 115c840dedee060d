//! Logarithmic scales and their ticks at 1, 2 and 5 times powers of ten.

/// A logarithmic scale that maps values from `low` to `high` to positions from `start` to `end`, in points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogScale {
    low: f64,
    high: f64,
    start: f64,
    end: f64,
}

/// The least ratio of a scale's ends: two ticks are always inside.
const LEAST_RATIO: f64 = 8.0;

/// Returns the smallest and largest of the positive, finite values, widened by a factor at both ends and so that they
/// are at least `LEAST_RATIO` apart; `fallback` where there are none.
pub fn range(values: impl Iterator<Item = f64>, fallback: [f64; 2]) -> [f64; 2] {
    const MARGIN: f64 = 1.35;
    let usable = values.filter(|value| value.is_finite() && *value > 0.0);
    let ends = usable.fold(None, |ends: Option<[f64; 2]>, value| {
        Some(ends.map_or([value; 2], |[low, high]| [low.min(value), high.max(value)]))
    });
    let Some([low, high]) = ends else { return fallback };
    let [low, high] = [low / MARGIN, high * MARGIN];
    let missing = (LEAST_RATIO * low / high).max(1.0).sqrt();
    // The smallest and largest numbers there are leave no margin.
    [(low / missing).max(f64::MIN_POSITIVE), (high * missing).min(f64::MAX)]
}

impl LogScale {
    /// Returns a scale that maps the range `low` to `high` to positions from `start` to `end`, which may be less than
    /// `start`.
    pub fn new([low, high]: [f64; 2], [start, end]: [f64; 2]) -> LogScale {
        LogScale { low, high, start, end }
    }

    /// Returns the position of a value on the logarithmic axis, in points; values beyond an end (0 and less too) are
    /// placed at it.
    pub fn position(&self, value: f64) -> f64 {
        let [low, high] = [self.low.log10(), self.high.log10()];
        let share = (value.max(self.low).log10() - low) / (high - low);
        self.start + share.clamp(0.0, 1.0) * (self.end - self.start)
    }

    /// Returns the values of the ticks within the scale, at least `apart` points from one to the next: 1, 2, 5, 10 …,
    /// or powers of ten only, or every second, third … of them.
    pub fn ticks(&self, apart: f64) -> Vec<f64> {
        let [low, high] = [self.low.log10(), self.high.log10()];
        let decade = (self.end - self.start).abs() / (high - low);
        let steps: &[f64] = if decade * 2.0_f64.log10() >= apart { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let every = if steps.len() > 1 { 1 } else { ((apart / decade).ceil() as i32).max(1) };
        let powers = (low.floor() as i32..=high.ceil() as i32).filter(|power| power.rem_euclid(every) == 0);
        let values = powers.flat_map(|power| steps.iter().map(move |step| scaled(*step, power)));
        values.filter(|value| (self.low..=self.high).contains(value)).collect()
    }
}

/// Returns `step` times ten to the `power`, as exact as its decimal form: ticks are printed.
fn scaled(step: f64, power: i32) -> f64 {
    format!("{step}e{power}").parse().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_logarithmic() {
        let scale = LogScale::new([1.0, 100.0], [10.0, 210.0]);
        assert_eq!(scale.position(1.0), 10.0);
        assert_eq!(scale.position(10.0), 110.0);
        assert!((scale.position(20.0) - (110.0 + 100.0 * 2.0_f64.log10())).abs() < 1e-9);
        assert_eq!(scale.position(0.0), 10.0, "zero is at the left end");
        assert_eq!(scale.position(1e9), 210.0);
        assert_eq!(LogScale::new([1.0, 100.0], [210.0, 10.0]).position(10.0), 110.0, "backwards");
    }

    #[test]
    fn ticks_thin_out_when_there_is_no_room() {
        let scale = |points: f64| LogScale::new([0.8, 150.0], [0.0, points]);
        assert_eq!(scale(600.0).ticks(40.0), [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0]);
        assert_eq!(scale(200.0).ticks(40.0), [1.0, 10.0, 100.0]);
        assert_eq!(scale(60.0).ticks(40.0), [1.0, 100.0]);
        assert_eq!(LogScale::new([0.0006, 0.06], [0.0, 600.0]).ticks(40.0), [0.001, 0.002, 0.005, 0.01, 0.02, 0.05]);
    }

    #[test]
    fn a_range_has_room_and_always_two_ticks() {
        assert_eq!(range([].into_iter(), [1.0, 10.0]), [1.0, 10.0]);
        assert_eq!(range([f64::NAN, 0.0, -1.0, f64::INFINITY].into_iter(), [1.0, 10.0]), [1.0, 10.0]);
        for value in [0.003, 1.0, 4.9, 5.0, 77.0] {
            let [low, high] = range([value].into_iter(), [1.0, 10.0]);
            assert!(low < value && value < high);
            assert!(LogScale::new([low, high], [0.0, 600.0]).ticks(40.0).len() >= 2, "{value}");
        }
        assert!(range([f64::MIN_POSITIVE, f64::MAX].into_iter(), [1.0, 10.0]).iter().all(|end| end.is_finite()));
    }
}

//! Matrices of a chain of spaces, and how they and coordinates are written.

use glam::DMat4;
use serde::Serialize;

/// A matrix of the transform chain, by rows, with its inverse.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TransformStep {
    /// The matrix's name: `eye from world`, `clip from eye`, `window from NDC`.
    pub name: &'static str,
    /// The matrix by rows; it is multiplied with points as columns on its right.
    pub matrix: [[f64; 4]; 4],
    /// The inverse matrix.
    pub inverse: [[f64; 4]; 4],
}

impl TransformStep {
    pub(super) fn new(name: &'static str, matrix: DMat4) -> TransformStep {
        let rows = |matrix: DMat4| matrix.transpose().to_cols_array_2d();
        TransformStep { name, matrix: rows(matrix), inverse: rows(matrix.inverse()) }
    }
}

/// Returns numbers as text with so many significant digits, separated by commas.
pub fn vector(values: &[f64], digits: u32) -> String {
    let texts: Vec<String> = values.iter().map(|value| number(*value, digits)).collect();
    texts.join(", ")
}

/// Returns a matrix row as text with so many significant digits, in columns of equal width.
pub fn matrix_row(row: &[f64; 4], digits: u32) -> String {
    // A sign, a zero, a point, and up to three zeros after it: with a space before, the longest number that there is.
    let width = digits as usize + 7;
    row.map(|value| format!("{:>width$}", number(value, digits))).concat()
}

/// Returns a number with `shown` significant digits, without zeros at the end and without a sign where it rounds to 0;
/// at most `shown` + 3 decimals.
fn number(value: f64, shown: u32) -> String {
    let digits = if value == 0.0 || !value.is_finite() { 0.0 } else { value.abs().log10().floor() };
    let decimals = (f64::from(shown) - 1.0 - digits).clamp(0.0, f64::from(shown) + 3.0) as usize;
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text };
    if text == "-0" { "0".to_owned() } else { text.replace('-', "−") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_six_digits_and_a_minus_that_is_one() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (1.0, "1"),
            (-1.5, "−1.5"),
            (1234.5678, "1234.57"),
            (0.000123456789, "0.000123457"),
        ] {
            assert_eq!(number(value, 6), text);
        }
    }
}

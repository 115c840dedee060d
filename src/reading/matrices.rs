//! Matrices of a chain of spaces, and how they and coordinates are written.

use glam::DMat4;
use serde::Serialize;

/// A matrix of the transform chain, by rows, with its inverse where it has one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TransformStep {
    /// The matrix's name: `eye from world`, `clip from eye`, `window from NDC`.
    pub name: &'static str,
    /// The matrix by rows; it is multiplied with points as columns on its right.
    pub matrix: [[f64; 4]; 4],
    /// The inverse matrix; `None` where there is none in numbers.
    pub inverse: Option<[[f64; 4]; 4]>,
}

impl TransformStep {
    pub(super) fn new(name: &'static str, matrix: DMat4) -> TransformStep {
        // That of a matrix without one has a determinant of 0, by which it is divided.
        let inverse = Some(matrix.inverse()).filter(|inverse| inverse.is_finite());
        TransformStep { name, matrix: rows(matrix), inverse: inverse.map(rows) }
    }
}

/// Returns a matrix by its rows.
pub(super) fn rows(matrix: DMat4) -> [[f64; 4]; 4] {
    matrix.transpose().to_cols_array_2d()
}

/// Returns numbers as text with so many significant digits, separated by commas.
pub fn vector(values: &[f64], digits: u32) -> String {
    let texts: Vec<String> = values.iter().map(|value| number(*value, digits)).collect();
    texts.join(", ")
}

/// Returns a matrix row as text with so many significant digits, in columns of equal width.
pub fn matrix_row(row: &[f64; 4], digits: u32) -> String {
    // A space, a sign, a zero, a point, and up to three zeros after it; or a point and a power of ten.
    let width = digits as usize + 7;
    row.map(|value| format!("{:>width$}", number(value, digits))).concat()
}

/// Returns the lines of a matrix in rows, with `digits` significant digits, each column as wide as its longest number.
pub fn matrix_text(rows: &[[f64; 4]; 4], digits: u32) -> String {
    let words = rows.map(|row| row.map(|value| number(value, digits)));
    let longest = |column: usize| words.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let line = |row: &[String; 4]| {
        let padded = row.iter().enumerate().map(|(column, word)| format!("{word:>width$}", width = longest(column)));
        padded.collect::<Vec<_>>().join(" ")
    };
    words.each_ref().map(line).join("\n")
}

/// Returns a number with `shown` significant digits, without zeros at the end and without a sign where it rounds to 0;
/// at most `shown` + 3 decimals. Larger ones than `shown` + 3 digits have a power of ten.
fn number(value: f64, shown: u32) -> String {
    let digits = if value == 0.0 || !value.is_finite() { 0.0 } else { value.abs().log10().floor() };
    let decimals = (f64::from(shown) - 1.0 - digits).clamp(0.0, f64::from(shown) + 3.0) as usize;
    let trimmed = |text: String| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    };
    let text = if digits > f64::from(shown) + 2.0 && value.is_finite() {
        format!("{}e{digits}", trimmed(format!("{:.*}", shown as usize - 1, value / 10_f64.powf(digits))))
    } else {
        trimmed(format!("{value:.decimals$}"))
    };
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
            (123_456_789.4, "123456789"),
            (-1_234_567_890.0, "−1.23457e9"),
            (4.0e300, "4e300"),
        ] {
            assert_eq!(number(value, 6), text);
        }
    }
}

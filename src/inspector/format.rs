//! Numbers as text: thousands with a thin space, units always.

pub use crate::report::numbers::count;

/// `count(value)` with the word in the right number: `1 draw`, `2 draws`.
#[must_use]
pub fn counted(value: u64, noun: &str) -> String {
    format!("{} {noun}{}", count(value), if value == 1 { "" } else { "s" })
}

/// Milliseconds, or a dash where they were not measured.
#[must_use]
pub fn milliseconds(value: Option<f64>) -> String {
    match value {
        None => "–".to_owned(),
        Some(ms) if ms < 0.095 => format!("{ms:.2} ms"),
        Some(ms) if ms < 100.0 => format!("{ms:.1} ms"),
        Some(ms) => format!("{} ms", count(ms.round() as u64)),
    }
}

/// A size in memory: `7.1 MB`.
#[must_use]
pub fn bytes(value: u64) -> String {
    match value {
        0..1_000 => format!("{value} B"),
        1_000..1_000_000 => format!("{:.1} kB", value as f64 / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", value as f64 / 1e6),
        _ => format!("{:.1} GB", value as f64 / 1e9),
    }
}

/// A length in metres with about four digits; very small and very large ones with a power of ten.
#[must_use]
pub fn metres(value: f64) -> String {
    format!("{} m", digits(value))
}

/// About four digits of a number.
#[must_use]
pub fn digits(value: f64) -> String {
    let size = value.abs();
    if !value.is_finite() {
        if value > 0.0 { "∞".to_owned() } else { value.to_string() }
    } else if size == 0.0 {
        "0".to_owned()
    } else if !(1e-3..1e5).contains(&size) {
        format!("{value:.1e}")
    } else if size < 0.999_95 {
        format!("{value:.4}")
    } else if size < 99.999_5 {
        format!("{value:.3}")
    } else {
        format!("{value:.1}")
    }
}

/// A stored depth with enough digits to tell neighbours apart.
#[must_use]
pub fn depth(value: f32) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:.7}") }
}

/// Shares of red, green and blue light: `20 % 0 % 100 %`.
#[must_use]
pub fn shares([red, green, blue, _]: [u8; 4]) -> String {
    let share = |byte: u8| format!("{:.0} %", f32::from(byte) / 2.55);
    [red, green, blue].map(share).join("  ")
}

/// The name of a light for people: lights count from 1.
#[must_use]
pub fn light(index: usize) -> String {
    format!("light {}", index + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_always_there() {
        assert_eq!(milliseconds(None), "–");
        assert_eq!(milliseconds(Some(0.012)), "0.01 ms");
        assert_eq!(milliseconds(Some(6.34)), "6.3 ms");
        assert_eq!(bytes(7_100_000), "7.1 MB");
        assert_eq!(metres(13.4823), "13.482 m");
        assert_eq!(metres(1.1e-6), "1.1e-6 m");
        assert_eq!(metres(f64::INFINITY), "∞ m");
    }
}

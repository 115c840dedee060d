//! Numbers as text: thousands with a thin space, units always.

pub use crate::numbers::{count, counted, depth, digits, length, light, metres, precise};

/// Returns a light's title: `Light 1` for index 0.
pub fn light_title(index: usize) -> String {
    format!("Light {}", index + 1)
}

/// Returns milliseconds as text: two decimals below 0.095, one below 100, none above; a dash for `None`, which was not
/// measured.
pub fn milliseconds(value: Option<f64>) -> String {
    match value {
        None => "–".to_owned(),
        Some(ms) if ms < 0.095 => format!("{ms:.2} ms"),
        Some(ms) if ms < 100.0 => format!("{ms:.1} ms"),
        Some(ms) => format!("{} ms", count(ms.round() as u64)),
    }
}

/// Returns a moment of an animated scene as text, in seconds: `1.23 s`.
pub fn time(seconds: f64) -> String {
    format!("{seconds:.2} s")
}

/// Returns a size as text in decimal units, with one decimal from 1 000 bytes on: `999 B`, `7.1 MB`.
pub fn bytes(value: u64) -> String {
    match value {
        0..1_000 => format!("{value} B"),
        1_000..1_000_000 => format!("{:.1} kB", value as f64 / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", value as f64 / 1e6),
        _ => format!("{:.1} GB", value as f64 / 1e9),
    }
}

/// Returns the shares of red, green and blue light as text; a byte of 255 is 100 %: `20 % 0 % 100 %`.
pub fn shares([red, green, blue, _]: [u8; 4]) -> String {
    let share = |byte: u8| format!("{:.0} %", f32::from(byte) / 2.55);
    [red, green, blue].map(share).join("  ")
}

/// Returns a text with its first letter in upper case.
pub fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
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

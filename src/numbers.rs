//! Numbers as text, alike in tables, plots, stories and panels: thousands with a no-break space, two
//! digits of a share, lengths with their unit, and stencil counts with their sign.

/// Writes a count, groups of three digits separated by a no-break space (U+00A0) from the thousands on: `1 234`,
/// `47 425`. egui, browsers and terminals end a line at every other space, narrow ones included.
pub fn count(value: u64) -> String {
    let digits = value.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push('\u{a0}');
        }
        text.push(digit);
    }
    text
}

/// Returns a number with its noun in singular or plural: `1 draw`, `2 draws`.
pub fn counted(value: u64, noun: &str) -> String {
    format!("{} {noun}{}", count(value), if value == 1 { "" } else { "s" })
}

/// Returns whether a count is not 0 but reads as 0 in eight bits.
pub fn reads_zero_in_eight_bits(count: f32) -> bool {
    count != 0.0 && (count.round() as i64).rem_euclid(256) == 0
}

/// Writes a share of 1 in per cent with about two digits, without the sign: `0` only for exactly 0, never rounded up to
/// 100; `–` where it is not finite.
pub fn per_hundred(fraction: f64) -> String {
    let value = fraction * 100.0;
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".to_owned() } else { "–".to_owned() };
    }
    if value >= 99.0 {
        // Never rounded up to 100.
        return if fraction < 1.0 { format!("{:.2}", value.min(99.99)) } else { format!("{value:.0}") };
    }
    let decimals = (1.0 - value.log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{value:.decimals$}")
}

/// Writes a share of 1 in per cent with its sign after a no-break space: `0.12 %`. Exactly 0 is `0` without the sign.
pub fn percent(fraction: f64) -> String {
    match per_hundred(fraction) {
        zero if zero == "0" => zero,
        text => format!("{text}\u{a0}%"),
    }
}

/// Writes milliseconds without the unit: three decimals below 0.1, two below 1, one below 100, none from there on, with
/// separated thousands. `0` for exactly 0, `–` where it is not finite.
pub fn milliseconds(value: f64) -> String {
    match value {
        _ if !value.is_finite() => "–".to_owned(),
        0.0 => "0".to_owned(),
        ..0.1 => format!("{value:.3}"),
        ..1.0 => format!("{value:.2}"),
        ..99.95 => format!("{value:.1}"),
        _ => count(value.round() as u64),
    }
}

/// Writes bytes in MiB without the unit: one decimal below 100 MiB, none from there on.
pub fn mebibytes(bytes: u64) -> String {
    let value = bytes as f64 / f64::from(1 << 20);
    if value < 100.0 { format!("{value:.1}") } else { count(value.round() as u64) }
}

/// Writes a length in metres with about four digits; very small and very large ones with a power of ten.
pub fn metres(value: f64) -> String {
    length(value, "m")
}

/// Writes a length in another unit, with about four digits; very small and very large ones with a power of ten.
pub fn length(value: f64, unit: &str) -> String {
    format!("{} {unit}", digits(value))
}

/// Writes a coordinate in metres as [`metres`] does, with a minus sign and no hyphen below 0.
pub fn signed_metres(value: f64) -> String {
    format!("{}{}", if value < 0.0 { "−" } else { "" }, metres(value.abs()))
}

/// Writes a length as [`length`] does, but one far below a metre in mm, µm or nm, rather than with a power of ten.
pub fn small_length(value: f64, unit: &str) -> String {
    let smaller = [(1e3, "mm"), (1e6, "µm"), (1e9, "nm")];
    let of_metres = smaller.into_iter().filter(|_| unit == "m" && value < 1e-3);
    match of_metres.map(|(many, name)| (value * many, name)).find(|(value, _)| *value >= 0.1) {
        Some((value, name)) => format!("{value:.2} {name}"),
        None => length(value, unit),
    }
}

/// Writes a number with about four digits: in scientific notation below 0.001 and from 100 000 on; `0` for exactly 0,
/// `∞` for positive infinity.
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

/// Writes a number rounded to seven significant digits, without trailing zeros; in scientific notation below 1e-6 and
/// from 1e9 on.
pub fn precise(value: f64) -> String {
    let digits = format!("{value:.6e}").parse().unwrap_or(value);
    if digits != 0.0 && !(1e-6..1e9).contains(&f64::abs(digits)) { format!("{digits:e}") } else { digits.to_string() }
}

/// Writes a stored depth in the fewest digits that read back as the same bits: no two depths look equal.
pub fn depth(value: f32) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:?}") }
}

/// Returns the name of a light as it is shown: lights count from 1.
pub fn light(index: usize) -> String {
    format!("light {}", index + 1)
}

/// Writes a count that is stored as a float, with `−` (U+2212) where it is negative and separated thousands; decimals,
/// then without separators, only where it has some.
pub fn count_in_float(value: f32) -> String {
    if value.fract() != 0.0 || !value.is_finite() {
        return value.to_string().replace('-', "−");
    }
    let sign = if value < 0.0 { "−" } else { "" };
    format!("{sign}{}", count(value.abs() as u64))
}

/// Writes a whole number with a minus sign where it is negative: `−1`, `2`.
pub fn whole(value: i64) -> String {
    format!("{}{}", if value < 0 { "−" } else { "" }, value.unsigned_abs())
}

/// Writes a stencil byte as a signed number where it is 128 or more: 255 is `−1 (255)`, 127 is `127`.
pub fn signed(value: u8) -> String {
    if value < 128 { value.to_string() } else { format!("−{} ({value})", 256 - u32::from(value)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_lengths_are_in_a_unit_that_is_read_at_a_glance() {
        let words = [12.94, 0.0123, 2.04e-4, 7.8e-7, 1.2e-7, 3e-10, 4e-12].map(|value| small_length(value, "m"));
        assert_eq!(words, ["12.940 m", "0.0123 m", "0.20 mm", "0.78 µm", "0.12 µm", "0.30 nm", "4.0e-12 m"]);
        assert_eq!(small_length(2e-4, "units"), "2.0e-4 units");
    }

    #[test]
    fn whole_numbers_have_a_minus_sign_and_no_hyphen() {
        assert_eq!([-12, 0, 3].map(whole), ["−12", "0", "3"]);
        assert_eq!(whole(i64::MIN), "−9223372036854775808");
    }

    #[test]
    fn neighbouring_depths_read_differently() {
        for value in [0.025f32, 1e-7, 0.999_999_9] {
            let next = f32::from_bits(value.to_bits() + 1);
            assert_ne!(depth(value), depth(next));
            assert_eq!(depth(value).parse(), Ok(value));
        }
        assert_eq!(depth(0.025), "0.025");
    }

    #[test]
    fn counts_in_floats_have_a_sign_and_thousands() {
        assert_eq!(count_in_float(0.0), "0");
        assert_eq!(count_in_float(-1.0), "−1");
        assert_eq!(count_in_float(1234.0), "1\u{a0}234");
        assert_eq!(count_in_float(-0.5), "−0.5");
    }

    #[test]
    fn thousands_are_apart() {
        assert_eq!(count(0), "0");
        assert_eq!(count(999), "999");
        assert_eq!(count(256_525), "256\u{a0}525");
        assert_eq!(count(1_000_000), "1\u{a0}000\u{a0}000");
    }

    #[test]
    fn only_zero_reads_as_zero_and_only_all_reads_as_all() {
        assert_eq!(per_hundred(0.0), "0");
        assert_eq!(per_hundred(1.0 / 921_600.0), "0.00011");
        assert_eq!(per_hundred(0.0012), "0.12");
        assert_eq!(per_hundred(0.042), "4.2");
        assert_eq!(per_hundred(0.42), "42");
        assert_eq!(per_hundred(0.999_999), "99.99");
        assert_eq!(per_hundred(1.0), "100");
        assert_eq!(percent(0.0), "0");
        assert_eq!(percent(0.0012), "0.12\u{a0}%");
    }

    #[test]
    fn times_have_two_or_three_digits() {
        assert_eq!(milliseconds(0.0), "0");
        assert_eq!(milliseconds(0.012), "0.012");
        assert_eq!(milliseconds(0.316), "0.32");
        assert_eq!(milliseconds(6.34), "6.3");
        assert_eq!(milliseconds(1520.4), "1\u{a0}520");
        assert_eq!(milliseconds(f64::NAN), "–");
    }
}

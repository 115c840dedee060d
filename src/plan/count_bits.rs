//! How many bits of the stencil store a count.

use std::fmt;

/// How many of the stencil's lowest bits a count of shadow volumes uses, 1 to 8.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct CountBits(u8);

impl CountBits {
    /// All eight bits of the stencil.
    pub const EIGHT: CountBits = CountBits(8);

    /// Returns the bits of a stencil write mask that has only the lowest bits; all eight for any other mask.
    pub fn of_mask(mask: u32) -> CountBits {
        let ones = (mask as u8).trailing_ones() as u8;
        if (1..8).contains(&ones) && mask == (1 << ones) - 1 { CountBits(ones) } else { CountBits::EIGHT }
    }

    /// Returns how many different counts the bits can store: 2 to their number.
    pub fn modulus(self) -> i32 {
        1 << self.0
    }

    /// Returns whether `byte` is what the bits store of `sum`, and yet reads as another number: the count has wrapped.
    /// Of eight bits, 128 and more also read as negative.
    pub fn hold_otherwise(self, sum: i32, byte: u8) -> bool {
        let least = if self == CountBits::EIGHT { -128 } else { 0 };
        sum.rem_euclid(self.modulus()) == i32::from(byte) && !(least..self.modulus()).contains(&sum)
    }
}

/// Written as `eight bits`.
impl fmt::Display for CountBits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const NAMES: [&str; 8] =
            ["one bit", "two bits", "three bits", "four bits", "five bits", "six bits", "seven bits", "eight bits"];
        f.write_str(NAMES[usize::from(self.0) - 1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masks_are_bits_and_bits_hold_sums_modulo_a_power_of_two() {
        let cases = [(0xff, "eight bits", 256), (0xf, "four bits", 16), (0x3, "two bits", 4), (1, "one bit", 2)];
        for (mask, name, modulus) in cases {
            let bits = CountBits::of_mask(mask);
            assert_eq!((bits.to_string().as_str(), bits.modulus()), (name, modulus));
            assert!(bits.hold_otherwise(modulus, 0) && !bits.hold_otherwise(1, 1) && !bits.hold_otherwise(modulus, 1));
        }
        assert!(!CountBits::EIGHT.hold_otherwise(-1, 255), "eight bits are read with a sign");
        assert!(CountBits::of_mask(0xf).hold_otherwise(-1, 15));
        assert_eq!(CountBits::of_mask(0xf0), CountBits::EIGHT, "no count is in these");
        assert_eq!(CountBits::of_mask(0), CountBits::EIGHT);
    }
}

//! A small generator of numbers: the same on every machine.

use glam::DVec3;

/// Numbers in [0, 1) (Knuth's MMIX constants).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15))
    }

    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// From 0 up to and without `end`.
    pub fn below(&mut self, end: u32) -> u32 {
        (self.unit() * f64::from(end)) as u32
    }

    pub fn within(&mut self, reach: f64) -> DVec3 {
        let mut one = || (self.unit() * 2.0 - 1.0) * reach;
        DVec3::new(one(), one(), one())
    }
}

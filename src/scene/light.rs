//! Lights: a homogeneous point, so that point and directional lights are one code path.

use super::Motion;
use crate::math::angle;
use glam::{DVec3, DVec4};

/// Each light is a bit of one word a triangle; the last bit is used otherwise.
pub const MOST_LIGHTS: usize = 31;

/// A light. Its colour is linear RGB; without a `range` it does not fall off with distance.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    /// Homogeneous world position: `w = 1` a point light, `w = 0` the direction *towards* a
    /// directional light (any length but 0).
    pub position: DVec4,
    /// Linear RGB, each ≥ 0.
    pub color: [f32; 3],
    /// Factor of `color`, ≥ 0.
    pub intensity: f32,
    /// Switched on; else it adds nothing. Its passes stay, so that they can be examined.
    pub is_on: bool,
    /// Distance in metres at which a point light has faded to nothing.
    pub range: Option<f64>,
    /// How it moves.
    pub motion: Motion,
}

impl Light {
    /// Returns a white point light at `position`.
    pub fn point(position: impl Into<DVec3>) -> Light {
        Light::white(position.into().extend(1.0))
    }

    /// Returns a white directional light that shines from the direction `towards`.
    pub fn directional(towards: impl Into<DVec3>) -> Light {
        Light::white(towards.into().extend(0.0))
    }

    fn white(position: DVec4) -> Light {
        Light { position, color: [1.0; 3], intensity: 1.0, is_on: true, range: None, motion: Motion::default() }
    }

    /// Returns whether the light is directional (`w = 0`): it shines from one direction everywhere. Otherwise it is a
    /// point light.
    pub fn is_directional(&self) -> bool {
        self.position.w == 0.0
    }

    /// Returns its light: linear RGB times intensity; zero while it is switched off.
    pub fn emitted(&self) -> [f32; 3] {
        if self.is_on { self.color.map(|channel| channel * self.intensity) } else { [0.0; 3] }
    }

    /// Returns the position that geometry is computed with: a direction is scaled by a power of two, which rounds
    /// nothing, to a length near 1, so that products of it stay in range.
    pub fn homogeneous(&self) -> DVec4 {
        if !self.is_directional() {
            return self.position;
        }
        let largest = self.position.abs().max_element();
        // In two steps: the exponent of a subnormal is beyond what one factor holds.
        let half = (-angle::log2(largest).floor() / 2.0).floor();
        let rest = -angle::log2(largest).floor() - half;
        self.position * half.exp2() * rest.exp2()
    }

    /// Names what makes this light unusable, in a few words for an error line.
    ///
    /// # Errors
    /// The first rule broken: finite numbers, a direction that is not zero, colour and intensity
    /// not negative, range greater than zero.
    pub fn check(&self) -> Result<(), &'static str> {
        let color_is_valid = self.color.iter().all(|c| (c * self.intensity).is_finite() && *c >= 0.0);
        if !self.position.is_finite() {
            Err("a light's position must be finite numbers")
        } else if self.is_directional() && self.position.truncate() == DVec3::ZERO {
            Err("a directional light needs a direction other than 0,0,0")
        } else if !(color_is_valid && self.intensity.is_finite() && self.intensity >= 0.0) {
            Err("a light's color and intensity must be finite and not negative")
        } else if self.range.is_some_and(|range| !(1e-30..=1e30).contains(&range)) {
            Err("a light's range must be a distance from 1e-30 to 1e30")
        } else {
            Ok(())
        }
    }
}

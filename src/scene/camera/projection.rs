//! How a camera projects: perspective, an off-centre frustum, or one of the parallel projections.

use crate::math::angle;
use glam::DVec2;
use serde::{Deserialize, Serialize};
use std::fmt;

/// How points before a camera are projected into its picture.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Projection {
    /// View rays begin at the eye; the field of view is the angle between them.
    #[default]
    Perspective,
    /// View rays begin at the eye, and the picture's edges are given where they meet the near plane (glFrustum), in metres
    /// to the right of the view's axis and above it. The picture's middle may be off that axis, and the picture is stretched
    /// where its sides are not in the rectangle's ratio. The field of view does not matter.
    Frustum {
        /// The left edge, metres.
        left: f64,
        /// The right edge, metres, > `left`.
        right: f64,
        /// The lower edge, metres.
        bottom: f64,
        /// The upper edge, metres, > `bottom`.
        top: f64,
    },
    /// View rays are parallel and perpendicular to the picture.
    Orthographic {
        /// Distance from the picture's centre to its upper edge, metres, > 0.
        half_height: f64,
    },
    /// View rays are parallel and oblique to the picture: a plane perpendicular to the view is not distorted, and what
    /// lies behind it moves along a line of the picture. Cavalier projection with a factor of 1, cabinet with ½.
    Oblique {
        /// Distance from the picture's centre to its upper edge, metres, > 0.
        half_height: f64,
        /// Angle of the line along which things recede, degrees, from the right and counter-clockwise.
        angle_degrees: f64,
        /// How far a metre of depth moves things along that line, metres, at least 0.
        factor: f64,
    },
}

impl Projection {
    /// The names of the projections, in the order in which they are offered.
    pub const NAMES: [&str; 4] = ["perspective", "frustum", "orthographic", "oblique"];
    /// The usual angle of an oblique projection, degrees.
    pub const USUAL_ANGLE: f64 = 45.0;
    /// The depth factor of a cabinet projection.
    pub const CABINET: f64 = 0.5;
    /// The depth factor of a cavalier projection.
    pub const CAVALIER: f64 = 1.0;

    /// Returns whether view rays begin at the eye.
    pub fn is_pinhole(&self) -> bool {
        matches!(self, Projection::Perspective | Projection::Frustum { .. })
    }

    /// Returns whether it is the one that a camera has unless another is given: perspective.
    pub fn is_usual(&self) -> bool {
        *self == Projection::Perspective
    }

    /// Returns the edges of a frustum on the near plane, metres: left, right, bottom, top; `None` for other projections.
    pub fn edges(self) -> Option<[f64; 4]> {
        match self {
            Projection::Frustum { left, right, bottom, top } => Some([left, right, bottom, top]),
            _ => None,
        }
    }

    /// Returns its name: one of [`Projection::NAMES`].
    pub fn name(self) -> &'static str {
        match self {
            Projection::Perspective => "perspective",
            Projection::Frustum { .. } => "frustum",
            Projection::Orthographic { .. } => "orthographic",
            Projection::Oblique { .. } => "oblique",
        }
    }

    /// Returns how far to the right and up in the picture a metre of depth moves things, metres.
    pub fn shear(self) -> DVec2 {
        match self {
            Projection::Oblique { angle_degrees, factor, .. } => angle::direction(angle_degrees.to_radians()) * factor,
            Projection::Perspective | Projection::Frustum { .. } | Projection::Orthographic { .. } => DVec2::ZERO,
        }
    }

    /// Checks the projection's own numbers: edges in order and up to 1e30, half height from 1e-30 to 1e30, angle within ±360 degrees, factor from 0 to
    /// 100. The error says what must be.
    pub(super) fn check(self) -> Result<(), &'static str> {
        let is_usable = |half_height: f64| (1e-30..=1e30).contains(&half_height);
        match self {
            Projection::Perspective => Ok(()),
            Projection::Frustum { left, right, bottom, top } => {
                let is_number = [left, right, bottom, top].iter().all(|edge| edge.abs() <= 1e30);
                match is_number && right - left >= 1e-30 && top - bottom >= 1e-30 {
                    true => Ok(()),
                    false => {
                        Err("a frustum's edges must be numbers up to 1e30, left less than right, bottom less than top")
                    }
                }
            }
            Projection::Orthographic { half_height } | Projection::Oblique { half_height, .. }
                if !is_usable(half_height) =>
            {
                Err("the half height of a parallel projection must be from 1e-30 to 1e30 metres")
            }
            Projection::Oblique { angle_degrees, .. } if !(-360.0..=360.0).contains(&angle_degrees) => {
                Err("the angle of an oblique projection must be from -360 to 360 degrees")
            }
            Projection::Oblique { factor, .. } if !(0.0..=100.0).contains(&factor) => {
                Err("the depth factor of an oblique projection must be from 0 to 100")
            }
            Projection::Orthographic { .. } | Projection::Oblique { .. } => Ok(()),
        }
    }
}

/// Its name with all its numbers.
impl fmt::Display for Projection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Projection::Perspective => f.write_str("perspective"),
            Projection::Frustum { left, right, bottom, top } => {
                write!(f, "frustum, left {left}, right {right}, bottom {bottom}, top {top}")
            }
            Projection::Orthographic { half_height } => write!(f, "orthographic, half height {half_height}"),
            Projection::Oblique { half_height, angle_degrees, factor } => {
                write!(f, "oblique, half height {half_height}, angle {angle_degrees}, factor {factor}")
            }
        }
    }
}

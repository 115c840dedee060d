//! A pixel's point in every space that the camera takes it through, with the matrices between them.
//!
//! World space, then eye space (the eye at the origin, looking down −z), clip space, normalized device coordinates
//! (after the division by w) and window space (pixels from the top left, and depth).

use super::depth::DepthMeasure;
use super::fragments::Surface;
use crate::capture::Capture;
use crate::scene::Camera;
use glam::{DMat4, DVec3, DVec4};
use serde::Serialize;
use std::fmt::Write;

/// Bits of depth buffers that are compared; the last is the 32-bit float that is stored here.
const BITS: [u32; 3] = [8, 16, 24];

/// Digits of numbers in text.
const DIGITS: u32 = 6;

/// A point in every space.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Coordinates {
    /// World space, metres.
    pub world: [f64; 3],
    /// Eye space, metres: the eye at the origin, x to the right, y up, looking down −z.
    pub eye: [f64; 3],
    /// Clip space, homogeneous.
    pub clip: [f64; 4],
    /// Normalized device coordinates: x and y from −1 to 1, z as depth.
    pub ndc: [f64; 3],
    /// Pixels from the top left of the picture, and depth.
    pub window: [f64; 3],
}

/// A matrix of the chain, in rows, and its inverse.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Step {
    /// `eye from world`, `clip from eye`, `window from NDC`.
    pub name: &'static str,
    /// Rows; points are columns on its right.
    pub matrix: [[f64; 4]; 4],
    /// The way back.
    pub inverse: [[f64; 4]; 4],
}

/// How finely a depth buffer tells distances at a point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DepthStep {
    /// `8 bits`, `32-bit float`.
    pub stored_in: String,
    /// Metres from one stored depth to the next; `None` where the next is at infinity.
    pub metres: Option<f64>,
}

/// Where the camera stands, seen from what it looks at.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spherical {
    /// Distance, metres.
    pub r: f64,
    /// From the pole (+Y) down, degrees: 90 is level.
    pub theta_degrees: f64,
    /// Around the pole from +Z towards +X, degrees.
    pub phi_degrees: f64,
}

/// All that is told of a pixel's place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Place {
    /// The camera around its target.
    pub camera: Spherical,
    /// World to window.
    pub chain: Vec<Step>,
    /// The surface at the pixel's middle; `None` where the picture shows none.
    pub point: Option<Coordinates>,
    /// How finely depth is kept there, the coarsest buffer first; empty without a surface.
    pub depth_steps: Vec<DepthStep>,
}

/// The three matrices of a camera, in f64.
struct Matrices {
    eye_from_world: DMat4,
    clip_from_eye: DMat4,
    window_from_ndc: DMat4,
}

impl Place {
    /// Of a pixel of a capture, with the depth that its picture ends with.
    #[must_use]
    pub fn of(capture: &Capture, pixel: [u32; 2]) -> Place {
        let matrices = Matrices::of(capture);
        let last = (0..capture.steps.len()).rev().find_map(|step| capture.frame_at(step));
        let depth = last.and_then(|frame| frame.depth.image.depth_at(pixel));
        let seen = depth.and_then(|depth| Some((depth, Surface::new(capture).at(pixel, depth)?)));
        let measure = DepthMeasure::of_camera(capture);
        Place {
            camera: Spherical::of(&capture.camera),
            chain: matrices.chain(),
            point: seen.map(|(_, world)| matrices.carry(world)),
            depth_steps: seen.map_or_else(Vec::new, |(depth, _)| depth_steps(measure, depth)),
        }
    }
}

fn depth_steps(measure: DepthMeasure, depth: f32) -> Vec<DepthStep> {
    let finite = |metres: Option<f64>| metres.map(f64::abs).filter(|metres| metres.is_finite());
    let fixed = BITS.map(|bits| (format!("{bits} bits"), finite(measure.fixed_step_at(depth, bits))));
    let float = ("32-bit float".to_owned(), finite(measure.step_at(depth)));
    fixed.into_iter().chain([float]).map(|(stored_in, metres)| DepthStep { stored_in, metres }).collect()
}

impl Matrices {
    fn of(capture: &Capture) -> Matrices {
        let camera = &capture.camera;
        let [width, height] = capture.size.map(f64::from);
        let rotation = camera.world_from_view().transpose();
        Matrices {
            eye_from_world: DMat4::from_mat3(rotation) * DMat4::from_translation(-camera.eye),
            clip_from_eye: camera.clip_from_view(width / height, &capture.depth),
            // Rows run down, as y does not.
            window_from_ndc: DMat4::from_cols(
                DVec4::new(width / 2.0, 0.0, 0.0, 0.0),
                DVec4::new(0.0, -height / 2.0, 0.0, 0.0),
                DVec4::Z,
                DVec4::new(width / 2.0, height / 2.0, 0.0, 1.0),
            ),
        }
    }

    fn carry(&self, world: DVec3) -> Coordinates {
        let eye = self.eye_from_world * world.extend(1.0);
        let clip = self.clip_from_eye * eye;
        let ndc = clip.truncate() / clip.w;
        let window = self.window_from_ndc * ndc.extend(1.0);
        Coordinates {
            world: world.to_array(),
            eye: eye.truncate().to_array(),
            clip: clip.to_array(),
            ndc: ndc.to_array(),
            window: window.truncate().to_array(),
        }
    }

    fn chain(&self) -> Vec<Step> {
        let rows = |matrix: DMat4| matrix.transpose().to_cols_array_2d();
        let step = |name, matrix: DMat4| Step { name, matrix: rows(matrix), inverse: rows(matrix.inverse()) };
        vec![
            step("eye from world", self.eye_from_world),
            step("clip from eye", self.clip_from_eye),
            step("window from NDC", self.window_from_ndc),
        ]
    }
}

impl Spherical {
    fn of(camera: &Camera) -> Spherical {
        let away = camera.eye - camera.target;
        let r = away.length();
        Spherical {
            r,
            theta_degrees: (away.y / r).clamp(-1.0, 1.0).acos().to_degrees(),
            phi_degrees: away.x.atan2(away.z).to_degrees(),
        }
    }
}

impl Place {
    /// In lines, for `pixel --coordinates`.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = String::new();
        let Spherical { r, theta_degrees, phi_degrees } = self.camera;
        // Writing to a string can't fail.
        let _ = writeln!(
            text,
            "camera around its target: r {r:.4}, θ {theta_degrees:.2}° from +Y, φ {phi_degrees:.2}° from +Z"
        );
        match self.point {
            None => text += "no surface is here\n",
            Some(point) => {
                for (name, values) in point.rows() {
                    let _ = writeln!(text, "{name:7} {}", vector(values, DIGITS));
                }
            }
        }
        for step in &self.depth_steps {
            let metres = step.metres.map_or_else(|| "to infinity".to_owned(), crate::numbers::metres);
            let _ = writeln!(text, "depth in {:13} one step is {metres}", step.stored_in);
        }
        for step in &self.chain {
            let _ = writeln!(text, "{}, and its inverse:", step.name);
            for (row, back) in step.matrix.iter().zip(&step.inverse) {
                let _ = writeln!(text, "  {}   {}", matrix_row(row, DIGITS), matrix_row(back, DIGITS));
            }
        }
        text
    }
}

impl Coordinates {
    /// Name and values of each space, in order.
    #[must_use]
    pub fn rows(&self) -> [(&'static str, &[f64]); 5] {
        [("world", &self.world), ("eye", &self.eye), ("clip", &self.clip), ("NDC", &self.ndc), ("window", &self.window)]
    }
}

/// Numbers between commas, with so many digits.
#[must_use]
pub fn vector(values: &[f64], digits: u32) -> String {
    let texts: Vec<String> = values.iter().map(|value| number(*value, digits)).collect();
    texts.join(", ")
}

/// A row of a matrix in columns of one width.
#[must_use]
pub fn matrix_row(row: &[f64; 4], digits: u32) -> String {
    let width = digits as usize + 5;
    row.map(|value| format!("{:>width$}", number(value, digits))).concat()
}

/// So many digits, and no sign where nothing is left.
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
            assert_eq!(number(value, DIGITS), text);
        }
    }

    #[test]
    fn a_camera_above_and_to_the_right_has_its_angles() {
        let camera = Camera::looking([2.0, 2.0 * 2f64.sqrt() + 1.0, 2.0], [0.0, 1.0, 0.0]);
        let found = Spherical::of(&camera);
        assert!((found.r - 4.0).abs() < 1e-12);
        assert!((found.theta_degrees - 45.0).abs() < 1e-12 && (found.phi_degrees - 45.0).abs() < 1e-12);
    }
}

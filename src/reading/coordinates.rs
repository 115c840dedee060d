//! A pixel's point, and vertices, in every space that the camera takes them through, with the matrices between them.
//!
//! World space, then eye space (the eye at the origin, looking down −z), clip space, normalized device coordinates
//! (after the division by w) and window space (pixels from the top left, and depth).

use super::camera_matrices::{CameraMatrices, projection_words};
use super::depth::DepthMeasure;
use super::light_coordinates::LightCoordinates;
pub use super::matrices::{TransformStep, matrix_row, matrix_text, vector};
use super::shading::seen;
use super::shadow_matrix::ShadowMatrix;
use super::vanishing::{self, AxisLines};
use crate::capture::{Capture, PixelUnprojection};
use crate::history::PixelHistory;
use crate::math::DepthBits;
use crate::plan::FramePlan;
pub use crate::scene::Spherical;
use crate::scene::{Scene, suggestion};
use glam::DVec3;
use serde::Serialize;
use std::fmt::Write;

/// Bits of the fixed-point depth buffers that are compared with the stored 32-bit float.
const BITS: [DepthBits; 3] = [DepthBits::EIGHT, DepthBits::SIXTEEN, DepthBits::TWENTY_FOUR];

/// Significant digits of numbers in text.
const DIGITS: u32 = 6;

/// A point's coordinates in every space from world to window.
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
    /// Window space: x and y in pixels from the picture's upper left, z as depth.
    pub window: [f64; 3],
}

/// A vertex of an object with its coordinates in every space from world to window.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VertexCoordinates {
    /// Name of the object that the vertex belongs to.
    pub object: String,
    /// Index of the vertex in its mesh.
    pub index: u32,
    /// World space, metres.
    pub world: [f64; 3],
    /// Eye space, metres.
    pub eye: [f64; 3],
    /// Clip space, homogeneous.
    pub clip: [f64; 4],
    /// Normalized device coordinates; `None` where w is not positive, as the vertex is then not in front of the eye.
    pub ndc: Option<[f64; 3]>,
    /// Window space: x and y in pixels from the picture's upper left, z as depth; `None` where w is not positive.
    pub window: Option<[f64; 3]>,
    /// The planes of the view that it lies beyond: `left`, `right`, `bottom`, `top`, `near`, `far`; empty where it is
    /// in view.
    pub beyond: Vec<&'static str>,
}

/// Why a text such as `floor:0` names no vertex.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NoVertex {
    /// The text is not of the form `OBJECT:INDEX`.
    #[error("`{0}` is no vertex: give OBJECT:INDEX, as in `floor:0`")]
    Form(String),
    /// No object has this name.
    #[error("no object is called `{object}`: {hint}")]
    Object {
        /// What was asked for.
        object: String,
        /// The nearest name, or all names.
        hint: String,
    },
    /// The object's mesh has fewer vertices.
    #[error("{object} has no vertex {index}: it has {count}, counted from 0")]
    Index {
        /// Name of the object.
        object: String,
        /// What was asked for.
        index: u32,
        /// How many vertices the mesh has.
        count: usize,
    },
}

/// Coordinates of vertices that a user asked for, with the transforms.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VertexPlaces {
    /// The camera's position in spherical coordinates around its target.
    pub camera: Spherical,
    /// The kind of projection in words, with its depth as a formula.
    pub projection: String,
    /// Where lines along each axis of the world go in the picture.
    pub vanishing: [AxisLines; 3],
    /// The transforms from world space to window space, in order.
    pub chain: Vec<TransformStep>,
    /// The transforms after eye space as OpenGL has them, whose z in clip space is from −w to w.
    pub opengl: Vec<TransformStep>,
    /// The vertices that were asked for, in that order.
    pub vertices: Vec<VertexCoordinates>,
}

/// The depth resolution of a buffer at a point: the distance between neighbouring depths.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DepthStep {
    /// The buffer's format: `8 bits`, `32-bit float`.
    pub stored_in: String,
    /// Metres from one stored depth to the next; `None` where the next is at infinity.
    pub metres: Option<f64>,
}

/// The coordinates of the surface at a pixel in every space, with the transforms and the depth resolution there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PixelCoordinates {
    /// The camera's position in spherical coordinates around its target.
    pub camera: Spherical,
    /// The kind of projection in words, with its depth as a formula.
    pub projection: String,
    /// Where lines along each axis of the world go in the picture.
    pub vanishing: [AxisLines; 3],
    /// The transforms from world space to window space, in order.
    pub chain: Vec<TransformStep>,
    /// The transforms after eye space as OpenGL has them, whose z in clip space is from −w to w.
    pub opengl: Vec<TransformStep>,
    /// The surface point at the pixel's centre; `None` where the picture shows no surface.
    pub point: Option<Coordinates>,
    /// The corners of the triangle that the pixel shows, as the GPU is given them; empty where it shows none.
    pub vertices: Vec<VertexCoordinates>,
    /// Depth resolution there of depth buffers of 8, 16 and 24 bits and of 32-bit floats, in this order; empty without
    /// a surface.
    pub depth_steps: Vec<DepthStep>,
    /// The point in the spaces of the lights whose maps or textures decide about it; empty without a surface.
    pub lights: Vec<LightCoordinates>,
    /// How planar shadows are flattened onto the plane there; empty for other techniques, or where the triangle is not known.
    pub flattened: Vec<ShadowMatrix>,
}

impl PixelCoordinates {
    /// Returns the coordinates of the surface at a pixel's centre, by the depth that it has at the end of the frame;
    /// none of a point where the pixel shows no surface. What needs the pixel's history is empty.
    pub fn of(capture: &Capture, pixel: [u32; 2]) -> PixelCoordinates {
        let matrices = CameraMatrices::of(capture);
        let last = (0..capture.steps.len()).rev().find_map(|step| capture.frame_at(step));
        let depth = last.and_then(|frame| frame.depth.image.depth_at(pixel));
        let seen = depth.and_then(|depth| Some((depth, PixelUnprojection::new(capture).at(pixel, depth)?)));
        let measure = DepthMeasure::of_camera(capture);
        PixelCoordinates {
            camera: Spherical::of(&capture.camera),
            projection: projection_words(capture, DIGITS),
            vanishing: vanishing::axes(capture),
            chain: matrices.chain(),
            opengl: matrices.opengl(),
            point: seen.map(|(_, world)| matrices.carry(world)),
            vertices: Vec::new(),
            depth_steps: seen.map_or_else(Vec::new, |(depth, _)| depth_steps(measure, depth)),
            lights: seen.map_or_else(Vec::new, |(_, world)| LightCoordinates::of(capture, world, None)),
            flattened: Vec::new(),
        }
    }

    /// Adds what the pixel's history tells: the corners of the triangle that it shows, the point in textures and silhouettes of
    /// lights, and the matrices of planar shadows.
    #[must_use]
    pub fn with_vertices(self, capture: &Capture, plan: &FramePlan, history: &PixelHistory) -> PixelCoordinates {
        let world = self.point.map(|point| DVec3::from_array(point.world));
        PixelCoordinates {
            vertices: corners(capture, plan, history).unwrap_or_default(),
            lights: world.map_or_else(Vec::new, |world| LightCoordinates::of(capture, world, Some((plan, history)))),
            flattened: world.map_or_else(Vec::new, |world| ShadowMatrix::of(capture, plan, history, world)),
            ..self
        }
    }
}

fn corners(capture: &Capture, plan: &FramePlan, history: &PixelHistory) -> Option<Vec<VertexCoordinates>> {
    let (_, draw, one) = seen(plan, history)?;
    let matrices = CameraMatrices::of(capture);
    let mesh = plan.meshes.get(draw.mesh.0)?;
    let indices = mesh.corners(one.triangle, 0)?;
    let object = draw.caster.as_ref().unwrap_or(&draw.name);
    let corner = |index: &u32| {
        let [x, y, z, _] = mesh.vertices.data().get(*index as usize)?.map(f64::from);
        Some(matrices.vertex(object, *index, capture.camera.eye + DVec3::new(x, y, z)))
    };
    indices.iter().map(corner).collect()
}

impl VertexPlaces {
    /// Returns the coordinates of vertices of a scene's objects in the capture's camera, each asked for as
    /// `OBJECT:INDEX` (counted from 0), in the order asked for. Of objects of one name, the first is meant.
    ///
    /// # Errors
    /// The first vertex that does not exist.
    pub fn of(capture: &Capture, scene: &Scene, asked: &[String]) -> Result<VertexPlaces, NoVertex> {
        let matrices = CameraMatrices::of(capture);
        let vertex = |asked: &String| {
            let parts = asked.rsplit_once(':').and_then(|(object, index)| Some((object, index.parse().ok()?)));
            let (name, index): (&str, u32) = parts.ok_or_else(|| NoVertex::Form(asked.escape_debug().to_string()))?;
            let object = scene.objects.iter().find(|object| object.name == name).ok_or_else(|| {
                let names: Vec<&str> = scene.objects.iter().map(|object| object.name.as_str()).collect();
                NoVertex::Object { object: name.escape_debug().to_string(), hint: suggestion(name, &names) }
            })?;
            let world = object.world_positions();
            let place = world.get(index as usize).ok_or_else(|| NoVertex::Index {
                object: name.to_owned(),
                index,
                count: world.len(),
            })?;
            Ok(matrices.vertex(name, index, *place))
        };
        Ok(VertexPlaces {
            camera: Spherical::of(&capture.camera),
            projection: projection_words(capture, DIGITS),
            vanishing: vanishing::axes(capture),
            chain: matrices.chain(),
            opengl: matrices.opengl(),
            vertices: asked.iter().map(vertex).collect::<Result<_, _>>()?,
        })
    }

    /// Returns the lines that `pixel --vertex` prints: the camera, each vertex, and the matrices.
    pub fn text(&self) -> String {
        let vertices: String = self.vertices.iter().map(VertexCoordinates::text).collect();
        let projection = format!("{}\n{}", self.projection, vanishing::text(&self.vanishing));
        spherical_text(self.camera) + &projection + &vertices + &chain_text(&self.chain) + &chain_text(&self.opengl)
    }
}

impl VertexCoordinates {
    /// Returns the same as OpenGL has it, as [`Coordinates::in_opengl`] does.
    #[must_use]
    pub fn in_opengl(self, height: f64) -> VertexCoordinates {
        let [x, y, z, w] = self.clip;
        VertexCoordinates {
            clip: [x, y, 2.0 * z - w, w],
            ndc: self.ndc.map(ndc_in_opengl),
            window: self.window.map(|window| from_below(window, height)),
            ..self
        }
    }

    /// Returns the vertex in words: `vertex 3 of floor`.
    pub fn name(&self) -> String {
        format!("vertex {} of {}", self.index, self.object)
    }

    /// Returns name and coordinates of the vertex in each space, with `digits` significant digits, and last whether it
    /// is in view or which planes it lies beyond. NDC and window say why they are missing where w is not positive.
    pub fn rows(&self, digits: u32) -> [(&'static str, String); 6] {
        let divided = |values: Option<[f64; 3]>| match values {
            Some(values) => vector(&values, digits),
            None => "not divided: w is not positive, it is not before the eye".to_owned(),
        };
        let view = match self.beyond.as_slice() {
            [] => "in view".to_owned(),
            planes => format!("beyond {}", planes.join(", ")),
        };
        [
            ("world", vector(&self.world, digits)),
            ("eye", vector(&self.eye, digits)),
            ("clip", vector(&self.clip, digits)),
            ("NDC", divided(self.ndc)),
            ("window", divided(self.window)),
            ("view", view),
        ]
    }

    fn text(&self) -> String {
        let rows = self.rows(DIGITS).map(|(name, value)| format!("{name:7} {value}\n")).concat();
        format!("{}\n{rows}", self.name())
    }
}

fn ndc_in_opengl([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, y, 2.0 * z - 1.0]
}

fn from_below([x, y, z]: [f64; 3], height: f64) -> [f64; 3] {
    [x, height - y, z]
}

fn depth_steps(measure: DepthMeasure, depth: f32) -> Vec<DepthStep> {
    let finite = |metres: Option<f64>| metres.map(f64::abs).filter(|metres| metres.is_finite());
    let fixed = BITS.map(|bits| (format!("{bits} bits"), finite(measure.fixed_step_at(depth, bits))));
    let float = ("32-bit float".to_owned(), finite(measure.step_at(depth)));
    fixed.into_iter().chain([float]).map(|(stored_in, metres)| DepthStep { stored_in, metres }).collect()
}

impl CameraMatrices {
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

    fn vertex(&self, object: &str, index: u32, world: DVec3) -> VertexCoordinates {
        let eye = self.eye_from_world * world.extend(1.0);
        let clip = self.clip_from_eye * eye;
        let ndc = (clip.w > 0.0).then(|| clip.truncate() / clip.w);
        let window = ndc.map(|ndc| (self.window_from_ndc * ndc.extend(1.0)).truncate());
        // Clip space decides it without dividing: what is in view has −w ≤ x, y ≤ w and 0 ≤ z ≤ w.
        let [least, most] = if self.is_reversed { ["far", "near"] } else { ["near", "far"] };
        let planes = [
            ("left", clip.x < -clip.w),
            ("right", clip.x > clip.w),
            ("bottom", clip.y < -clip.w),
            ("top", clip.y > clip.w),
            (least, clip.z < 0.0),
            (most, clip.z > clip.w),
        ];
        VertexCoordinates {
            object: object.to_owned(),
            index,
            world: world.to_array(),
            eye: eye.truncate().to_array(),
            clip: clip.to_array(),
            ndc: ndc.map(|ndc| ndc.to_array()),
            window: window.map(|window| window.to_array()),
            beyond: planes.iter().filter(|(_, is_beyond)| *is_beyond).map(|(name, _)| *name).collect(),
        }
    }
}

/// Returns a camera's spherical coordinates as a line of text, with where its angles begin.
fn spherical_text(camera: Spherical) -> String {
    let Spherical { r, theta_degrees, phi_degrees } = camera;
    format!(
        "camera around its target: r {r:.4}, θ {theta_degrees:.2}° from +Z towards +X, φ {phi_degrees:.2}° above level\n"
    )
}

impl PixelCoordinates {
    /// Returns whether an empty depth range stores all depths as one, so that no depth leads back to a point.
    pub fn has_no_distances(&self) -> bool {
        self.chain.last().is_some_and(|step| step.inverse.is_none())
    }

    /// Returns the lines that `pixel --coordinates` prints.
    pub fn text(&self) -> String {
        let mut text =
            spherical_text(self.camera) + &format!("{}\n{}", self.projection, vanishing::text(&self.vanishing));
        match self.point {
            None if self.has_no_distances() => text += "the point is not known: all depths are stored as one\n",
            None => text += "no surface is here\n",
            Some(point) => {
                for (name, values) in point.rows() {
                    // Writing to a string can't fail.
                    let _ = writeln!(text, "{name:7} {}", vector(values, DIGITS));
                }
            }
        }
        for step in &self.depth_steps {
            let metres = step.metres.map_or_else(|| "to infinity".to_owned(), crate::numbers::metres);
            let _ = writeln!(text, "depth in {:13} one step is {metres}", step.stored_in);
        }
        text.extend(self.vertices.iter().map(VertexCoordinates::text));
        text += &(chain_text(&self.chain) + &chain_text(&self.opengl));
        for light in &self.lights {
            text += &format!("{}\n", light.name);
            for (name, values) in light.rows() {
                let _ = writeln!(text, "{name:10} {}", vector(&values, DIGITS));
            }
            text += &(chain_text(&light.chain) + &chain_text(&light.opengl));
        }
        for shadow in &self.flattened {
            let lines = shadow.lines(DIGITS);
            text += &format!("{}\n", lines[0]);
            for row in &shadow.matrix {
                let _ = writeln!(text, "  {}", matrix_row(row, DIGITS));
            }
            text.extend(lines[1..].iter().map(|line| format!("{line}\n")));
        }
        text
    }
}

fn chain_text(chain: &[TransformStep]) -> String {
    let mut text = String::new();
    for step in chain {
        // Writing to a string can't fail.
        let inverse = if step.inverse.is_some() { "and its inverse" } else { "which has no inverse" };
        let _ = writeln!(text, "{}, {inverse}:", step.name);
        for (index, row) in step.matrix.iter().enumerate() {
            let back = step.inverse.map_or_else(String::new, |inverse| matrix_row(&inverse[index], DIGITS));
            let _ = writeln!(text, "{}", format!("  {}   {back}", matrix_row(row, DIGITS)).trim_end());
        }
    }
    text
}

impl Coordinates {
    /// Returns the same as OpenGL has it, in a picture of this height in pixels: clip space's z is from −w to w, that of NDC
    /// from −1 to 1, and the window's rows are counted from below; its depth is the same.
    #[must_use]
    pub fn in_opengl(self, height: f64) -> Coordinates {
        let Coordinates { clip: [x, y, z, w], ndc, window, .. } = self;
        Coordinates {
            clip: [x, y, 2.0 * z - w, w],
            ndc: ndc_in_opengl(ndc),
            window: from_below(window, height),
            ..self
        }
    }

    /// Returns the name and the coordinates of each space, from world to window.
    pub fn rows(&self) -> [(&'static str, &[f64]); 5] {
        [("world", &self.world), ("eye", &self.eye), ("clip", &self.clip), ("NDC", &self.ndc), ("window", &self.window)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_without_an_inverse_says_so_and_shows_no_numbers_for_it() {
        let flat = glam::DMat4::from_scale(DVec3::new(2.0, 0.0, 2.0));
        let text = chain_text(&[TransformStep::new("shadow from world", flat)]);
        assert!(text.starts_with("shadow from world, which has no inverse:\n"), "{text}");
        assert_eq!(
            text.lines().skip(1).map(|row| row.split_whitespace().count()).collect::<Vec<_>>(),
            [4; 4],
            "{text}"
        );
        let text = chain_text(&[TransformStep::new("twice", glam::DMat4::from_scale(DVec3::splat(2.0)))]);
        assert!(text.contains("and its inverse:") && text.contains("0.5"), "{text}");
    }
}

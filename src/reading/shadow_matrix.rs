//! The matrix that flattens casters onto the plane that a pixel shows, with a vertex carried through.
//!
//! Blinn (1988), "Me and My (Fake) Shadow": M = (P·L) I − L Pᵀ, with the plane P turned towards the light L.

use super::matrices::{rows, vector};
use super::shading::seen;
use crate::capture::{Capture, CapturedLight};
use crate::geometry::planar::{FlattenClip, Flattener};
use crate::history::PixelHistory;
use crate::math::Plane;
use crate::numbers;
use crate::plan::{Draw, DrawPart, FramePlan, LightId};
use crate::technique::PlanarSettings;
use glam::{DMat4, DVec3};
use serde::Serialize;

/// How casters are flattened onto the plane of the surface at a pixel, away from one light.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShadowMatrix {
    /// Index of the light.
    pub light: usize,
    /// The plane: its normal towards the light, and its offset.
    pub plane: [f64; 4],
    /// The matrix, from world space to homogeneous world space; it has no inverse, so none is shown.
    pub matrix: [[f64; 4]; 4],
    /// The caster's vertex whose shadow is nearest to the pixel's point; `None` without casters.
    pub vertex: Option<FlattenedVertex>,
}

/// A vertex carried through a shadow matrix.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FlattenedVertex {
    /// Name of the caster.
    pub object: String,
    /// Index of the vertex in its mesh.
    pub index: u32,
    /// World space, metres.
    pub world: [f64; 3],
    /// Homogeneous, as the matrix carries it.
    pub flattened: [f64; 4],
    /// What the sign of w says.
    pub because: String,
}

impl ShadowMatrix {
    /// Returns the matrices by which casters are flattened onto the flat piece that a pixel shows at the surface point `world`,
    /// one for each light whose shadows are drawn on it; none where no caster is flattened onto it.
    pub fn of(capture: &Capture, plan: &FramePlan, history: &PixelHistory, world: DVec3) -> Vec<ShadowMatrix> {
        let Some((_, shown, one)) = seen(plan, history) else { return Vec::new() };
        let eye = capture.camera.eye;
        let [a, b, c] = one.corners.map(|[x, y, z, _]| eye + DVec3::new(x.into(), y.into(), z.into()));
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { return Vec::new() };
        let object = shown.caster.as_deref().unwrap_or(&shown.name);
        let clip = PlanarSettings::read(&capture.settings).clip;
        let of_light = |(light, of): (usize, &CapturedLight)| {
            let shadows =
                plan.planar_shadows_on(LightId(light), object, world, normal).filter(|all| !all.is_empty())?;
            let flattener = Flattener::new(Plane::through(a, normal), of.position, clip)?;
            let (plane, matrix) = (flattener.plane(), flattener.matrix());
            let vertex = nearest(plan, &shadows, eye, matrix, world, object);
            Some(ShadowMatrix {
                light,
                plane: plane.normal.extend(plane.offset).to_array(),
                matrix: rows(matrix),
                vertex: vertex.map(|(object, index, world)| {
                    let flattened = matrix * world.extend(1.0);
                    let heights = VertexHeights {
                        of_vertex: plane.at(world.extend(1.0)),
                        of_light: plane.at(of.position),
                        is_point: of.position.w != 0.0,
                        rounding: ROUNDING * (world - eye).length(),
                    };
                    let because = heights.because(clip);
                    FlattenedVertex { object, index, world: world.to_array(), flattened: flattened.to_array(), because }
                }),
            })
        };
        capture.lights.iter().enumerate().filter_map(of_light).collect()
    }

    /// Returns the name, the vertex and its shadow in words, with so many significant digits; the matrix is not in them.
    pub fn lines(&self, digits: u32) -> Vec<String> {
        let mut lines = vec![format!(
            "{}, shadow matrix (P·L) I − L Pᵀ with P = {}:",
            numbers::light(self.light),
            vector(&self.plane, digits)
        )];
        if let Some(FlattenedVertex { object, index, world, flattened, because }) = &self.vertex {
            let [x, y, z, w] = *flattened;
            let mut line = format!(
                "vertex {index} of {object} at {} goes to {}",
                vector(world, digits),
                vector(flattened, digits)
            );
            if w != 0.0 {
                line += &format!(", over w {}", vector(&[x / w, y / w, z / w], digits));
            }
            lines.push(format!("{line}: {because}"));
        }
        lines
    }
}

/// How far a vertex may be off its height by its rounding to floats relative to the eye, as a part of its distance.
const ROUNDING: f64 = 1e-6;

/// Heights over the plane that a vertex is flattened onto, on the light's side of it, metres.
struct VertexHeights {
    of_vertex: f64,
    /// Of a directional light, its direction's component along the normal.
    of_light: f64,
    is_point: bool,
    /// Differences of this size are none.
    rounding: f64,
}

impl VertexHeights {
    /// Returns what becomes of the vertex, and what the w of its shadow says of it: w is the light's height less its own, or of a
    /// directional light the same for all.
    fn because(&self, clip: FlattenClip) -> String {
        let VertexHeights { of_vertex, of_light, is_point, rounding } = *self;
        let [height, light_height] = [of_vertex, of_light].map(numbers::signed_metres);
        if of_vertex.abs() <= rounding {
            "it lies in the plane and is its own shadow".to_owned()
        } else if of_vertex < 0.0 {
            let then = match clip {
                FlattenClip::BetweenPlaneAndLight => "clip = on cuts it off, as it throws no shadow there",
                FlattenClip::Off => "it throws a false shadow, as clip = off keeps it",
                FlattenClip::Undivided => "it throws a false shadow, as a GPU (clip = gpu) knows nothing of the plane",
            };
            format!("its height {height} is beyond the plane, as the light sees it: {then}")
        } else if !is_point {
            format!("w is the same for all vertices of a directional light, and the height is {height}")
        } else if (of_light - of_vertex).abs() <= rounding {
            format!(
                "w is 0 within rounding, as it is level with the light at {light_height}: its shadow is at infinity"
            )
        } else if of_vertex < of_light {
            format!("w > 0, as its height {height} is less than the light's {light_height}")
        } else {
            let then = match clip {
                FlattenClip::BetweenPlaneAndLight => {
                    "dividing would carry it back through the light, the anti-shadow; clip = on cuts it off before"
                }
                FlattenClip::Off => {
                    "dividing carries it back through the light, the anti-shadow, as clip = off keeps it"
                }
                FlattenClip::Undivided => {
                    "dividing would carry it back through the light, the anti-shadow; a GPU that gets w as it is clips it \
                     (clip = gpu)"
                }
            };
            format!("w < 0, as its height {height} is more than the light's {light_height}: {then}")
        }
    }
}

/// Returns the vertex of a caster among `shadows` whose shadow is nearest to a point, with its caster's name: none of the
/// object that is shown itself, and none whose shadow is at infinity.
fn nearest(
    plan: &FramePlan,
    shadows: &[&Draw],
    eye: DVec3,
    matrix: DMat4,
    point: DVec3,
    shown: &str,
) -> Option<(String, u32, DVec3)> {
    let casters: Vec<&str> = shadows.iter().filter_map(|draw| draw.caster.as_deref()).collect();
    let surfaces = plan.passes.first()?.draws.iter().filter(|draw| draw.part == DrawPart::Surface);
    let of_casters = surfaces.filter_map(|draw| {
        let name = draw.caster.as_deref().unwrap_or(&draw.name);
        (name != shown && casters.contains(&name)).then_some((name, plan.meshes.get(draw.mesh.0)?))
    });
    let vertices = of_casters.flat_map(|(name, mesh)| {
        (0..).zip(mesh.vertices.data()).map(move |(index, [x, y, z, _])| {
            (name, index, eye + DVec3::new(f64::from(*x), f64::from(*y), f64::from(*z)))
        })
    });
    let away = |(_, _, world): &(&str, u32, DVec3)| {
        let shadow = matrix * world.extend(1.0);
        let away = (shadow.truncate() / shadow.w).distance(point);
        away.is_finite().then_some(away)
    };
    let measured = vertices.filter_map(|vertex| Some((away(&vertex)?, vertex)));
    let (_, (name, index, world)) = measured.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((name.to_owned(), index, world))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Over a plane with the light 4 m above it: a vertex below the plane, in it, between, level with the light, above it.
    #[test]
    fn what_becomes_of_a_vertex_is_said_for_each_clip() {
        let said = |of_vertex: f64, clip: FlattenClip| {
            VertexHeights { of_vertex, of_light: 4.0, is_point: true, rounding: 1e-6 }.because(clip)
        };
        let words = |of_vertex: f64| {
            use FlattenClip::{BetweenPlaneAndLight, Off, Undivided};
            [BetweenPlaneAndLight, Off, Undivided].map(|clip| said(of_vertex, clip))
        };
        let [on, off, gpu] = words(-0.5);
        assert!(on.contains("−0.5000 m is beyond the plane") && on.contains("clip = on cuts it off"), "{on}");
        assert!(
            off.contains("false shadow, as clip = off") && gpu.contains("false shadow") && gpu.contains("clip = gpu")
        );
        let [on, off, gpu] = words(5.0);
        assert!(on.contains("would carry") && on.contains("clip = on cuts it off before"), "{on}");
        assert!(off.contains("dividing carries it back") && gpu.contains("clips it (clip = gpu)"), "{off} {gpu}");
        for (height, words_there) in
            [(1e-7, "its own shadow"), (4.0, "at infinity"), (4.0 + 1e-7, "at infinity"), (3.0, "w > 0")]
        {
            assert!(words(height).iter().all(|text| text.contains(words_there)), "{:?}", words(height));
        }
        let of_sun = VertexHeights { of_vertex: 9.0, of_light: 0.5, is_point: false, rounding: 1e-6 };
        assert!(of_sun.because(FlattenClip::Off).contains("the same for all vertices"));
    }
}

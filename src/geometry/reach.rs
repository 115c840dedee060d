//! What a caster and its shadow can reach of a view: reasons to leave things out.
//!
//! Every question is whether a convex body lies wholly outside one plane of another. That errs to
//! the safe side: bodies apart for which no such plane is known count as touching. A body's points
//! are relative to the eye and homogeneous, so a shadow is a caster's points together with the same
//! points carried to infinity, and a plane through the eye asks both alike.
//!
//! The GPU sees points rounded to `f32`. So a body is outside a plane only if it is farther away
//! than that rounding can move it, and a margin for the arithmetic here comes on top.

use crate::math::Plane;
use crate::scene::Camera;
use glam::{DVec2, DVec3, DVec4};

/// A light lies in the near plane if its distance from it is at most this, relative to its distance from the eye.
const IN_PLANE: f64 = 1e-6;
/// How far rounding to `f32` and in the GPU's products may move a point, relative to its distance from the eye.
const ROUNDING: f64 = 1e-5;

/// The volume that a camera sees, without a far plane: its planes and its near rectangle, relative to the eye.
#[derive(Debug, Clone)]
pub struct ViewVolume {
    /// Near, left, right, bottom and top plane; positive inside.
    planes: [Plane; 5],
    /// Corners of the near rectangle, counter-clockwise from the upper right.
    near_rectangle: [DVec3; 4],
    /// Middle of the near rectangle.
    near_middle: DVec3,
    near: f64,
}

/// The near-clip volume: the space between the near rectangle and a light. A caster outside of it neither shadows a
/// point of the rectangle nor is cut by the near plane where that matters.
#[derive(Debug, Clone, PartialEq)]
pub enum NearClipVolume {
    /// The planes around it, positive inside.
    Planes(Vec<Plane>),
    /// The light lies in the near plane, so that whatever touches this plane may be in between.
    Slab(Plane),
}

/// The plane that a body lies wholly outside of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutsidePlane {
    /// Index of the plane in the volume.
    pub plane: usize,
    /// Distance of the body's nearest point from the plane, metres; infinite where all its points are at infinity.
    pub distance: f64,
}

impl ViewVolume {
    /// Returns the volume that a camera sees, relative to the eye: near plane and four sides; `aspect` is width over
    /// height. It has no far plane, as shadow volumes must not be cut there.
    pub fn new(camera: &Camera, aspect: f64) -> ViewVolume {
        let world_from_view = camera.world_from_view();
        let rays = camera.rays(aspect);
        let corner = |x: f64, y: f64| rays.through(DVec2::new(x, y)).at(camera.near);
        let (half, center) = (camera.half_size(aspect), camera.center());
        let ahead = world_from_view * DVec3::NEG_Z;
        // In view space, through the edges that face left, right, down and up.
        let side = |outward: DVec2| {
            let reach = center.dot(outward) + if outward.x == 0.0 { half.y } else { half.x };
            let plane = match camera.is_parallel() {
                false => Plane::through(DVec3::ZERO, world_from_view * (-outward).extend(-reach)),
                true => {
                    let edge = rays.through(outward);
                    let along_edge = world_from_view * outward.perp().extend(0.0);
                    Plane::through(edge.from, edge.along.cross(along_edge))
                }
            };
            let inside = rays.through(DVec2::ZERO).at(1.0).extend(1.0);
            if plane.at(inside) < 0.0 { plane.flipped() } else { plane }
        };
        ViewVolume {
            planes: [
                Plane::through(ahead * camera.near, ahead),
                side(DVec2::NEG_X),
                side(DVec2::X),
                side(DVec2::NEG_Y),
                side(DVec2::Y),
            ],
            near_rectangle: [corner(1.0, 1.0), corner(-1.0, 1.0), corner(-1.0, -1.0), corner(1.0, -1.0)],
            near_middle: rays.through(DVec2::ZERO).at(camera.near),
            near: camera.near,
        }
    }

    /// Returns the corners of the near rectangle, counter-clockwise from the upper right, relative to the eye.
    pub fn near_rectangle(&self) -> [DVec3; 4] {
        self.near_rectangle
    }

    /// Returns the first plane that all points are outside of; `None` where they may reach into the volume.
    pub fn outside(&self, points: &[DVec4]) -> Option<OutsidePlane> {
        outside(&self.planes, points)
    }

    /// Returns whether all points lie beyond the near plane, so that it does not cut their convex hull.
    pub fn is_beyond_near(&self, points: &[DVec4]) -> bool {
        outside(&[self.planes[0].flipped()], points).is_some()
    }

    /// Returns the first side plane of the view that all of these directions are outside of; `None` where they may be
    /// in view, or there are none. The near plane does not matter at infinity.
    pub fn outside_at_infinity(&self, directions: &[DVec3]) -> Option<OutsidePlane> {
        let points: Vec<DVec4> = directions.iter().map(|direction| direction.extend(0.0)).collect();
        let sides = outside(&self.planes[1..], &points);
        sides.map(|found| OutsidePlane { plane: found.plane + 1, ..found })
    }

    /// Returns the near-clip volume of a light, whose position is homogeneous and relative to the eye: the planes
    /// between near rectangle and light, or where the light lies in the near plane, within rounding, that plane as a
    /// slab without thickness.
    pub fn near_clip(&self, light: DVec4) -> NearClipVolume {
        let near_plane = &self.planes[0];
        let height = near_plane.at(light);
        let reach = light.truncate().length() + self.near * light.w;
        if height.abs() <= IN_PLANE * reach {
            return NearClipVolume::Slab(*near_plane);
        }
        let corners = self.near_rectangle;
        let middle = self.near_middle;
        let inwards = |plane: Plane| if plane.at(middle.extend(1.0)) < 0.0 { plane.flipped() } else { plane };
        let side = |index: usize| {
            let [a, b] = [corners[index], corners[(index + 1) % 4]];
            inwards(Plane::through(a, (b - a).cross(light.truncate() - a * light.w)))
        };
        // Towards the light from the near plane, and for a lamp no farther than the light itself.
        let base = if height > 0.0 { *near_plane } else { near_plane.flipped() };
        let mut planes = vec![base, side(0), side(1), side(2), side(3)];
        if light.w != 0.0 {
            planes.push(Plane::through(light.truncate() / light.w, -base.normal));
        }
        NearClipVolume::Planes(planes)
    }
}

impl NearClipVolume {
    /// Returns the name of a plane, by its index, as Lengyel (2002) counts them: K0 to K3 through the edges of the near
    /// rectangle, K4 the near plane, K5 at a point light; of a slab K0 and K1, both the near plane.
    pub fn name(&self, plane: usize) -> &'static str {
        let names = match self {
            NearClipVolume::Planes(_) => &[
                "the near-clip volume (K4, the near plane)",
                "the near-clip volume (K1, through the near rectangle's upper edge)",
                "the near-clip volume (K2, through the near rectangle's left edge)",
                "the near-clip volume (K3, through the near rectangle's lower edge)",
                "the near-clip volume (K0, through the near rectangle's right edge)",
                "the near-clip volume (K5, at the light)",
            ][..],
            NearClipVolume::Slab(_) => &[
                "the near-clip volume (K0, the near plane that the light lies in)",
                "the near-clip volume (K1, the back of the near plane that the light lies in)",
            ][..],
        };
        names.get(plane).copied().unwrap_or("the near-clip volume")
    }

    /// Returns the first of its planes that all points (homogeneous, relative to the eye) are outside of, by more than
    /// rounding; a slab has two, one for each side. `None` where some may be inside, or there are no points.
    pub fn outside(&self, points: &[DVec4]) -> Option<OutsidePlane> {
        match self {
            NearClipVolume::Planes(planes) => outside(planes, points),
            NearClipVolume::Slab(plane) => outside(&[*plane, plane.flipped()], points),
        }
    }
}

/// Returns the first plane that all points are outside of by more than rounding may move them, with the distance of the
/// nearest; `None` where there is none, or no points are given.
fn outside(planes: &[Plane], points: &[DVec4]) -> Option<OutsidePlane> {
    let beyond = |plane: &Plane| {
        let mut nearest = f64::INFINITY;
        for point in points {
            let height = plane.at(*point);
            let margin = ROUNDING * (point.truncate().length() + plane.offset.abs() * point.w);
            if height > -margin {
                return None;
            }
            // A direction only goes farther away.
            if point.w != 0.0 {
                nearest = nearest.min(-height / point.w);
            }
        }
        Some(nearest)
    };
    let found = planes.iter().enumerate().find_map(|(plane, of)| Some(OutsidePlane { plane, distance: beyond(of)? }));
    found.filter(|_| !points.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Projection;

    /// At the origin, looking along −z, 90 degrees each way: the near rectangle is 2 wide at 1.
    fn view() -> ViewVolume {
        let camera = Camera {
            eye: DVec3::new(3e6, -2e6, 1e6),
            target: DVec3::new(3e6, -2e6, 0.0),
            up: DVec3::Y,
            projection: Projection::Perspective,
            fov_y_degrees: 90.0,
            near: 1.0,
            far: None,
            viewport: None,
        };
        ViewVolume::new(&camera, 1.0)
    }

    fn points(of: &[[f64; 3]]) -> Vec<DVec4> {
        of.iter().map(|point| DVec3::from_array(*point).extend(1.0)).collect()
    }

    #[test]
    fn what_is_outside_of_a_side_of_the_view_is_not_seen() {
        let view = view();
        assert!(view.outside(&points(&[[0.0, 0.0, -5.0]])).is_none());
        // The right side is x = −z.
        let right = view.outside(&points(&[[6.0, 0.0, -5.0], [7.0, 1.0, -5.5]])).expect("outside");
        assert_eq!(right.plane, 2);
        assert!((right.distance - 0.5f64.sqrt()).abs() < 1e-12, "{right:?}");
        assert!(view.outside(&points(&[[6.0, 0.0, -5.0], [4.0, 0.0, -5.0]])).is_none(), "one point is inside");
        assert_eq!(view.outside(&points(&[[0.0, 0.0, -0.5]])).expect("nearer than near").plane, 0);
        assert!(view.outside(&[]).is_none(), "nothing is nowhere");
    }

    #[test]
    fn a_shadow_that_goes_on_into_the_view_is_seen() {
        let view = view();
        let caster = [6.0, 0.0, -5.0, 1.0].map(f64::from);
        let caster = DVec4::from_array(caster);
        let shadow = |towards: [f64; 3]| [caster, DVec3::from_array(towards).extend(0.0)];
        assert!(view.outside(&shadow([-1.0, 0.0, 0.0])).is_none(), "it falls to the left, into the view");
        assert!(view.outside(&shadow([1.0, 0.0, 0.0])).is_some(), "it falls to the right");
        assert!(view.outside_at_infinity(&[DVec3::X]).is_some());
        assert!(view.outside_at_infinity(&[DVec3::NEG_Z]).is_none());
    }

    /// The frustum over the near rectangle with its top at a lamp 4 before it.
    #[test]
    fn only_what_is_between_light_and_near_rectangle_can_hold_the_eye_in_its_shadow() {
        let lamp = DVec4::new(0.0, 0.0, -5.0, 1.0);
        let volume = view().near_clip(lamp);
        assert!(volume.outside(&points(&[[0.0, 0.0, -3.0]])).is_none());
        // Halfway it is as wide as half the rectangle.
        assert!(volume.outside(&points(&[[0.49, 0.0, -3.0]])).is_none());
        assert!(volume.outside(&points(&[[0.51, 0.0, -3.0]])).is_some());
        assert!(volume.outside(&points(&[[0.0, 0.0, -0.9]])).is_some(), "between eye and near plane");
        assert!(volume.outside(&points(&[[0.0, 0.0, -5.1]])).is_some(), "beyond the lamp");
        let behind = view().near_clip(DVec4::new(0.0, 0.0, 3.0, 1.0));
        assert!(behind.outside(&points(&[[0.0, 0.0, -2.0]])).is_some(), "the light is behind the eye");
        assert!(behind.outside(&points(&[[0.0, 0.0, 1.0]])).is_none());
        let sun = view().near_clip(DVec4::new(0.0, 1.0, 0.5, 0.0));
        assert!(sun.outside(&points(&[[0.0, 100.0, 49.0]])).is_none(), "it has no end");
        assert!(sun.outside(&points(&[[0.0, 100.0, 40.0]])).is_some());
    }

    /// K0 to K5 are what they are called: of a lamp 4 before the near rectangle, a body beyond one plane alone names it; of a
    /// light in the near plane, one on each side of that.
    #[test]
    fn each_plane_of_the_near_clip_volume_has_its_name() {
        let name = |volume: &NearClipVolume, body: [f64; 3]| {
            volume.name(volume.outside(&points(&[body])).expect("outside").plane)
        };
        let volume = view().near_clip(DVec4::new(0.0, 0.0, -5.0, 1.0));
        for (body, start) in [
            ([3.0, 0.0, -3.0], "the near-clip volume (K0, through the near rectangle's right edge)"),
            ([0.0, 3.0, -3.0], "the near-clip volume (K1, through the near rectangle's upper edge)"),
            ([-3.0, 0.0, -3.0], "the near-clip volume (K2, through the near rectangle's left edge)"),
            ([0.0, -3.0, -3.0], "the near-clip volume (K3, through the near rectangle's lower edge)"),
            ([0.0, 0.0, -0.5], "the near-clip volume (K4, the near plane)"),
            // Beyond the light, where the four sides have crossed.
            ([0.0, 0.0, -5.0 - 1e-3], "the near-clip volume (K1, "),
        ] {
            assert!(name(&volume, body).starts_with(start), "{body:?}: {}", name(&volume, body));
        }
        let NearClipVolume::Planes(planes) = &volume else { panic!("a lamp before the plane") };
        let beyond: Vec<&str> = (0..planes.len())
            .filter(|at| planes[*at].at(DVec4::new(0.0, 0.0, -6.0, 1.0)) < 0.0)
            .map(|at| volume.name(at))
            .collect();
        assert!(beyond.contains(&"the near-clip volume (K5, at the light)"), "{beyond:?}");
        let slab = view().near_clip(DVec4::new(4.0, 0.0, -1.0, 1.0));
        assert!(name(&slab, [9.0, 0.0, -1.5]).contains("(K1, ") && name(&slab, [9.0, 0.0, -0.5]).contains("(K0, "));
    }

    /// The volume of an off-centre frustum: what its rays see is inside, and what lies beyond an edge outside.
    #[test]
    fn the_view_of_an_off_center_frustum_ends_at_its_edges() {
        let projection = Projection::Frustum { left: 0.2, right: 1.5, bottom: -0.5, top: 0.1 };
        let camera = Camera { near: 1.0, projection, ..Camera::looking([0.0; 3], [0.0, 0.0, -1.0]) };
        let view = ViewVolume::new(&camera, 7.0);
        for (at, plane) in [
            ([0.21, 0.0], None),
            ([0.19, 0.0], Some(1)),
            ([1.49, 0.09], None),
            ([1.51, 0.0], Some(2)),
            ([0.5, -0.51], Some(3)),
            ([0.5, 0.11], Some(4)),
        ] {
            let seen = view.outside(&points(&[[at[0] * 5.0, at[1] * 5.0, -5.0]])).map(|outside| outside.plane);
            assert_eq!(seen, plane, "{at:?}");
        }
    }

    #[test]
    fn at_the_boundary_it_errs_to_the_safe_side() {
        let volume = view().near_clip(DVec4::new(0.0, 0.0, -5.0, 1.0));
        for off in [-1e-9, 0.0, 1e-9] {
            assert!(volume.outside(&points(&[[0.5 + off, 0.0, -3.0]])).is_none(), "{off}");
        }
    }

    /// A light in the near plane sees the rectangle as a line: all that the plane intersects counts.
    #[test]
    fn a_light_in_the_near_plane_asks_about_the_plane_alone() {
        let volume = view().near_clip(DVec4::new(4.0, 0.0, -1.0, 1.0));
        assert_eq!(volume, NearClipVolume::Slab(view().planes[0]));
        assert!(volume.outside(&points(&[[9.0, 0.0, -0.9], [9.0, 0.0, -1.1]])).is_none(), "it crosses the plane");
        assert!(volume.outside(&points(&[[9.0, 0.0, -1.1], [9.0, 0.0, -2.0]])).is_some());
    }

    /// Against the definition: a point is between if the ray from the light through it meets the
    /// rectangle beyond it.
    #[test]
    fn the_planes_are_those_of_the_definition() {
        let view = view();
        let mut state = 9u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
        };
        let mut found = [0, 0];
        for _ in 0..40_000 {
            let w = f64::from(u8::from(unit() > 0.0));
            let light = (DVec3::new(unit(), unit(), unit()) * 8.0).extend(w);
            let point = DVec3::new(unit(), unit(), unit()) * 6.0;
            let towards = light.truncate() - point * light.w;
            // The plane z = −1, from the point away from the light.
            let way = (-1.0 - point.z) / -towards.z;
            let on_plane = point - towards * way;
            let is_between = way > 0.0 && on_plane.truncate().abs().max_element() < 1.0;
            let is_outside = view.near_clip(light).outside(&[point.extend(1.0)]).is_some();
            let is_near_edge = (on_plane.truncate().abs().max_element() - 1.0).abs() < 0.01 || way.abs() < 0.01;
            assert!(is_between != is_outside || is_near_edge, "{light} {point}");
            found[usize::from(is_between)] += 1;
        }
        assert!(found[1] > 200, "{found:?}");
    }
}

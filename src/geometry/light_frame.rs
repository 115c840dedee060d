//! Where a shadow map looks from a light, fitted to what casts; or, as engines do, to what the camera sees, or by given
//! numbers ([`LightFrustum`]).
//!
//! What can darken a point lies on the ray from the light to it, so a map that covers every caster
//! answers for every receiver: outside it, nothing stands between. A point light whose casters fit
//! a cone gets one perspective map whose frustum is as narrow as they allow; otherwise a cube of
//! six. A directional light gets an orthographic map around the casters. Receivers beyond a map's
//! far end lie behind every caster: they are compared, not clipped.

use crate::math::depth::{DepthCurve, DepthMapping};
use crate::math::{AxisBox, angle, projection};
use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};
use rayon::prelude::*;

/// How many triangles or corners one thread looks at, at least.
const SHARE: usize = 8 * 1024;

/// Half the opening angle, in degrees, of the widest cone that one map covers.
const WIDEST_HALF_ANGLE: f64 = 60.0;
/// The widest field of view of a given frustum, degrees: a picture on a plane can't be wider than a half space.
pub const WIDEST_GIVEN: f64 = 179.0;
/// The share of its picture's half width that a silhouette with a border reaches.
const SILHOUETTE_FILL: f64 = 0.98;
/// Margin around the casters, in texels, so that no edge falls on the border.
const BORDER_TEXELS: f64 = 2.0;

/// The coordinate systems of a shadow map: light space, and the clip space of each face.
#[derive(Debug, Clone, PartialEq)]
pub struct LightFrame {
    /// The world position that vertices of the map's passes are relative to before rounding to `f32`.
    pub origin: DVec3,
    /// Light space from world space: the light (for a directional one the casters' middle) is at the origin, and the
    /// axes are rotated by `light_from_relative`.
    pub light_from_world: DMat4,
    /// Light space from positions relative to `origin`: a rotation.
    pub light_from_relative: DMat4,
    /// Clip space from light space, for each face: one, or six in the order of [`CUBE_FACES`].
    pub clip_from_light: Vec<DMat4>,
}

/// The faces of a cube map in wgpu's order: name, view direction, and the direction that is up in its picture.
pub const CUBE_FACES: [(&str, DVec3, DVec3); 6] = [
    ("+x", DVec3::X, DVec3::Y),
    ("-x", DVec3::NEG_X, DVec3::Y),
    ("+y", DVec3::Y, DVec3::NEG_Z),
    ("-y", DVec3::NEG_Y, DVec3::Z),
    ("+z", DVec3::Z, DVec3::Y),
    ("-z", DVec3::NEG_Z, DVec3::Y),
];

/// The size of a shadow map, and how it stores depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapStorage {
    /// Texels along each side.
    pub size: u32,
    /// How distance from the light is mapped to depth.
    pub depth: DepthMapping,
    /// The epsilon of the mapping that uses one.
    pub epsilon: f64,
}

/// What a shadow map covers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightFrustum {
    /// All that casts: nothing that can darken a point is outside.
    Casters,
    /// What the camera sees.
    View {
        /// Whether a directional light's map has the same size for all directions of the view and moves by whole texels
        /// only, and a point light's is a cube, so that edges of shadows stand still while the camera moves.
        is_snapped: bool,
    },
    /// A frustum of given numbers that looks at the middle of what casts.
    Given {
        /// The field of view of a point light's map in degrees, the same both ways; the width of a directional light's
        /// in metres.
        fov: f64,
        /// Distance of the near plane, metres: nothing nearer to the light casts. A directional light's camera stands
        /// where the middle of what casts is midway between the planes.
        near: f64,
        /// Distance of the far plane, metres: nothing farther casts.
        far: f64,
    },
}

/// What a map is fitted to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapCover<'a> {
    /// The triangles that cast, world space.
    pub casters: &'a [[DVec3; 3]],
    /// The corners of what the camera sees, world space: those of the near rectangle, then those of the far one. Used by
    /// [`LightFrustum::View`] alone.
    pub view: [DVec3; 8],
    /// Which of them the map covers.
    pub frustum: LightFrustum,
}

impl MapStorage {
    /// Returns the mapping for casters between two distances from the light along the map's axis.
    fn curve(&self, nearest: f64, farthest: f64) -> DepthCurve {
        self.depth.curve(nearest, farthest.max(nearest * 2.0) * 1.01, self.epsilon)
    }
}

/// Makes a shadow map's frame: orthographic for a directional light, else one perspective face or a cube. `None` where
/// nothing casts.
pub fn fit(cover: &MapCover, light: DVec4, storage: &MapStorage) -> Option<LightFrame> {
    let MapCover { casters, view, frustum } = *cover;
    if casters.is_empty() {
        return None;
    }
    let border = 1.0 + 2.0 * BORDER_TEXELS / f64::from(storage.size);
    let is_reversed = storage.depth.is_reversed();
    if light.w == 0.0 {
        let sun = Sun::new(casters, light.truncate());
        return Some(match frustum {
            LightFrustum::Casters => sun.around_casters(border, is_reversed),
            LightFrustum::View { is_snapped: false } => sun.around_view(&view, border, is_reversed),
            LightFrustum::View { is_snapped: true } => sun.around_view_snapped(&view, storage.size, is_reversed),
            LightFrustum::Given { fov, near, far } => sun.given(fov, far - near, is_reversed),
        });
    }
    let eye = light.truncate();
    let relative = casters.par_iter().with_min_len(SHARE).map(|corners| corners.map(|corner| corner - eye));
    let relative: Vec<[DVec3; 3]> = relative.collect();
    let corners = relative.as_flattened();
    let cube = || cube(&relative, eye, storage);
    Some(match frustum {
        LightFrustum::Casters => {
            let one = Cone::around(corners).map(|cone| {
                let distance = |point: &DVec3| -(cone.rotation * *point).z;
                let (nearest, farthest) = (least(corners, distance), greatest(corners, distance));
                let depth = storage.curve(nearest * 0.99, farthest);
                cone.frame(eye, border, &depth)
            });
            one.unwrap_or_else(cube)
        }
        LightFrustum::View { is_snapped: false } => {
            let one = Cone::around(&view.map(|corner| corner - eye)).map(|cone| {
                let (near, farthest) = depth_range(&relative, cone.secant());
                cone.frame(eye, border, &storage.curve(near, farthest))
            });
            one.unwrap_or_else(cube)
        }
        LightFrustum::View { is_snapped: true } => cube(),
        LightFrustum::Given { fov, near, far } => {
            let bounds = AxisBox::around(corners.iter().copied());
            let axis = ((bounds.low + bounds.high) / 2.0).try_normalize().unwrap_or(DVec3::NEG_Y);
            let slope = angle::tan(fov.min(WIDEST_GIVEN).to_radians() / 2.0);
            let [low, high] = [-slope, slope].map(DVec2::splat);
            Cone { rotation: towards(axis), low, high }.frame(eye, 1.0, &DepthCurve::between(storage.depth, near, far))
        }
    })
}

/// Returns the rotation into the space of a camera that looks along `axis`.
fn towards(axis: DVec3) -> DMat3 {
    projection::view_from_world_rotation(axis, projection::some_up_for(axis))
}

/// A view from a point light through a rectangle.
struct Cone {
    /// Light space from world directions.
    rotation: DMat3,
    /// The rectangle at distance 1: lowest and highest x and y.
    low: DVec2,
    high: DVec2,
}

impl Cone {
    /// Fits a view around points, relative to the light. `None` without points, or where they do not fit into the widest
    /// cone.
    fn around(points: &[DVec3]) -> Option<Cone> {
        let shares = || points.par_iter().with_min_len(SHARE);
        let directions = shares().map(|point| point.normalize_or_zero()).map(|direction| (direction, direction));
        let (low, high) = directions.reduce_with(joined)?;
        let axis = (low + high).try_normalize()?;
        let narrowest = least(points, |point| point.normalize_or_zero().dot(axis)).min(1.0);
        if narrowest <= angle::cos(WIDEST_HALF_ANGLE.to_radians()) {
            return None;
        }
        let rotation = towards(axis);
        let slopes = shares().map(|point| rotation * *point).map(|p| p / -p.z).map(|slope| (slope, slope));
        let (low, high) = slopes.reduce_with(joined)?;
        Some(Cone { rotation, low: low.truncate(), high: high.truncate() })
    }

    /// Returns how many times farther along its ray a point in the view can be than along the view's axis.
    fn secant(&self) -> f64 {
        self.low.abs().max(self.high.abs()).extend(1.0).length()
    }

    /// Returns the frame of a map of this view from a light at `eye`, widened by the factor `border`.
    fn frame(&self, eye: DVec3, border: f64, depth: &DepthCurve) -> LightFrame {
        let middle = (self.low + self.high) / 2.0;
        let half = ((self.high - self.low) / 2.0).max(DVec2::splat(1e-6)) * border;
        // An off-centre frustum: x/−z runs from middle − half to middle + half.
        let mut clip_from_light = projection::frustum(1.0 / half.x, 1.0 / half.y, depth);
        clip_from_light.z_axis.x = middle.x / half.x;
        clip_from_light.z_axis.y = middle.y / half.y;
        frame(eye, self.rotation, vec![clip_from_light])
    }
}

/// Returns the distances between which a map stores depth, along its axis: the near plane is before all casters, whose
/// rays are at most `secant` times as long as their distances along the axis. A caster that touches the light leaves a
/// sliver of 1e-6 of the scene unseen.
fn depth_range(relative: &[[DVec3; 3]], secant: f64) -> (f64, f64) {
    let farthest = greatest(relative.as_flattened(), |point| point.length());
    let nearest = least(relative, |corners| distance_to_triangle(*corners));
    ((nearest / secant * 0.99).max(farthest * 1e-6).max(f64::MIN_POSITIVE), farthest)
}

/// Returns the lowest of what is found of each item; infinite without items.
fn least<T: Sync>(items: &[T], of: impl Fn(&T) -> f64 + Sync + Send) -> f64 {
    items.par_iter().with_min_len(SHARE).map(of).reduce(|| f64::INFINITY, f64::min)
}

/// Returns the highest of what is found of each item, 0 if all are below it.
fn greatest<T: Sync>(items: &[T], of: impl Fn(&T) -> f64 + Sync + Send) -> f64 {
    items.par_iter().with_min_len(SHARE).map(of).reduce(|| 0.0, f64::max)
}

/// Returns the lowest and the highest coordinates of two ranges, each given by its lowest and its highest.
fn joined((low, high): (DVec3, DVec3), (other_low, other_high): (DVec3, DVec3)) -> (DVec3, DVec3) {
    (low.min(other_low), high.max(other_high))
}

fn cube(relative: &[[DVec3; 3]], eye: DVec3, storage: &MapStorage) -> LightFrame {
    // A point at distance d is at least d/√3 along the axis of its face.
    let (near, farthest) = depth_range(relative, 3f64.sqrt());
    let lens = projection::frustum(1.0, 1.0, &storage.curve(near, farthest));
    let face = |(_, forward, up): &(&str, DVec3, DVec3)| {
        lens * DMat4::from_mat3(projection::view_from_world_rotation(*forward, *up))
    };
    frame(eye, DMat3::IDENTITY, CUBE_FACES.iter().map(face).collect())
}

/// A directional light, and what casts in its own axes: x and y across the light, z towards it.
struct Sun {
    rotation: DMat3,
    casters: AxisBox,
}

impl Sun {
    fn new(casters: &[[DVec3; 3]], towards_light: DVec3) -> Sun {
        let rotation = towards(-towards_light);
        let shares = casters.par_chunks(SHARE);
        let around = shares.map(|share| AxisBox::around(share.iter().flatten().map(|point| rotation * *point)));
        Sun { rotation, casters: around.reduce(|| AxisBox::around([]), AxisBox::joined) }
    }

    fn around_casters(&self, border: f64, is_reversed: bool) -> LightFrame {
        let AxisBox { low, high } = self.casters;
        self.covering((low + high).truncate() / 2.0, (high - low).truncate() / 2.0, border, is_reversed)
    }

    fn around_view(&self, view: &[DVec3; 8], border: f64, is_reversed: bool) -> LightFrame {
        let AxisBox { low, high } = AxisBox::around(view.iter().map(|corner| self.rotation * *corner));
        self.covering((low + high).truncate() / 2.0, (high - low).truncate() / 2.0, border, is_reversed)
    }

    /// Covers the ball around the view, whose size does not depend on where the camera looks, and which is placed on a
    /// grid of texels.
    fn around_view_snapped(&self, view: &[DVec3; 8], size: u32, is_reversed: bool) -> LightFrame {
        let middle = view.iter().sum::<DVec3>() / 8.0;
        let radius = view.iter().map(|corner| corner.distance(middle)).fold(f64::MIN_POSITIVE, f64::max);
        // In steps, so that no rounding changes the size from frame to frame.
        let step = angle::log2(radius).floor().exp2() / 4.0;
        let half = (radius / step).ceil() * step;
        // A texel of margin, as the middle is up to one away from its place.
        let texel = 2.0 * half / f64::from(size.saturating_sub(2).max(1));
        let place = (self.rotation * middle).truncate();
        let half = DVec2::splat(texel * f64::from(size) / 2.0);
        self.covering((place / texel).floor() * texel, half, 1.0, is_reversed)
    }

    /// A box `width` wide and `depth` deep around the middle of what casts.
    fn given(&self, width: f64, depth: f64, is_reversed: bool) -> LightFrame {
        let origin = self.rotation.transpose() * ((self.casters.low + self.casters.high) / 2.0);
        let clip = projection::orthographic([width / 2.0; 2], -depth / 2.0, depth / 2.0, is_reversed);
        frame(origin, self.rotation, vec![clip])
    }

    /// Covers a rectangle across the light, `border` times as large, and along the light all that casts.
    fn covering(&self, middle: DVec2, half: DVec2, border: f64, is_reversed: bool) -> LightFrame {
        let AxisBox { low, high } = self.casters;
        let origin = self.rotation.transpose() * middle.extend((low.z + high.z) / 2.0);
        let half = half.extend((high.z - low.z) / 2.0);
        let least = half.max_element().max(f64::MIN_POSITIVE) * 1e-6;
        let half = half.max(DVec3::splat(least));
        // Far is behind the casters by half their depth, so that no bias pushes one to the value of
        // texels without a caster.
        let (near, far) = (-half.z * 1.01, half.z * 2.0);
        let clip = projection::orthographic([half.x * border, half.y * border], near, far, is_reversed);
        frame(origin, self.rotation, vec![clip])
    }
}

/// How the picture of a caster's silhouette is framed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SilhouetteView {
    /// As large as the caster's silhouette.
    Fitted {
        /// Whether the silhouette stays clear of the picture's edge.
        has_border: bool,
    },
    /// Of a fixed size around the direction of the caster's middle.
    Fixed {
        /// Half of that size: the tangent of half the field of view for a point light, half the width in metres for a
        /// directional one.
        half: f64,
    },
}

/// Returns clip space from world space for a picture of a caster's silhouette as the light sees it; all depths are
/// equal. `None` where a vertex is behind the light or level with it.
pub fn fit_silhouette(caster: &[DVec3], light: DVec4, view: SilhouetteView) -> Option<DMat4> {
    let from_light: Vec<DVec3> = caster.iter().map(|point| *point * light.w - light.truncate()).collect();
    let forward = from_light.iter().sum::<DVec3>().try_normalize()?;
    // Across the axis that the direction has least of.
    let axis =
        [DVec3::X, DVec3::Y, DVec3::Z].into_iter().min_by(|a, b| along(forward, *a).total_cmp(&along(forward, *b)))?;
    let right = forward.cross(axis).normalize();
    let up = right.cross(forward);
    let (origin, distance) = match light.w == 0.0 {
        true => (DVec3::ZERO, DVec4::W),
        false => (light.truncate(), forward.extend(-forward.dot(light.truncate()))),
    };
    let slopes =
        |side: DVec3| caster.iter().map(move |point| side.dot(*point - origin) / distance.dot(point.extend(1.0)));
    if caster.iter().any(|point| distance.dot(point.extend(1.0)) <= 0.0) {
        return None;
    }
    // A point light's frame is symmetric about its axis; a directional light's is a box.
    let row = |side: DVec3| {
        let (low, high) =
            slopes(side).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| (low.min(s), high.max(s)));
        let (middle, half) =
            if light.w == 0.0 { ((low + high) / 2.0, (high - low) / 2.0) } else { (0.0, high.max(-low)) };
        let scale = match view {
            SilhouetteView::Fitted { has_border: true } => SILHOUETTE_FILL / half.max(f64::MIN_POSITIVE),
            SilhouetteView::Fitted { has_border: false } => 1.0 / half.max(f64::MIN_POSITIVE),
            SilhouetteView::Fixed { half } => 1.0 / half.max(f64::MIN_POSITIVE),
        };
        side.extend(-side.dot(origin) - middle * f64::from(light.w == 0.0)) * scale
    };
    let rows = [row(right), row(up), distance * 0.5, distance];
    let is_usable = rows.iter().all(|row| row.is_finite());
    is_usable.then(|| DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose())
}

fn along(direction: DVec3, axis: DVec3) -> f64 {
    direction.dot(axis).abs()
}

fn frame(origin: DVec3, rotation: DMat3, clip_from_light: Vec<DMat4>) -> LightFrame {
    let light_from_relative = DMat4::from_mat3(rotation);
    let light_from_world = light_from_relative * DMat4::from_translation(-origin);
    LightFrame { origin, light_from_world, light_from_relative, clip_from_light }
}

/// Returns whether a triangle, relative to the frame's origin, may show in the face of the map with this clip space from such
/// positions. Conservative: false only where it lies wholly behind the light or outside one of the frustum's sides.
pub fn may_show(clip_from_relative: DMat4, corners: [DVec3; 3]) -> bool {
    let clip = corners.map(|corner| clip_from_relative * corner.extend(1.0));
    let sides: [fn(DVec4) -> f64; 5] = [|c| c.w + c.x, |c| c.w - c.x, |c| c.w + c.y, |c| c.w - c.y, |c| c.w];
    sides.iter().all(|side| clip.iter().any(|corner| side(*corner) > 0.0))
}

/// Returns the distance from the origin to the nearest point of a triangle, its border and inside included (Ericson
/// 2005, "Real-Time Collision Detection", 5.1.5).
fn distance_to_triangle([a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let over_inside = [(a, b), (b, c), (c, a)].iter().all(|(p, q)| (*q - *p).cross(-*p).dot(normal) >= 0.0);
    if over_inside && normal.length() > 0.0 {
        return (a.dot(normal) / normal.length()).abs();
    }
    [(a, b), (b, c), (c, a)].iter().map(|(p, q)| distance_to_segment(*p, *q)).fold(f64::INFINITY, f64::min)
}

fn distance_to_segment(p: DVec3, q: DVec3) -> f64 {
    let along = q - p;
    let t = (-p.dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    (p + along * t).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn storage(size: u32) -> MapStorage {
        MapStorage { size, depth: DepthMapping::ReversedInfinite, epsilon: 0.0 }
    }

    /// Many casters are looked at in parts, on all cores.
    #[test]
    fn a_frame_of_many_casters_has_the_bits_of_one_that_is_made_on_one_core() {
        let place =
            |index: u32| DVec3::new(f64::from(index % 173), f64::from(index % 31), f64::from(index % 97)) / 97.0;
        let casters: Vec<[DVec3; 3]> =
            (0..40_000).map(|index| [0, 7, 19].map(|by| place(index * 3 + by) + DVec3::new(0.3, -2.0, 0.1))).collect();
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
        for light in [DVec4::new(0.5, 9.0, 0.2, 1.0), DVec4::new(0.9, -1.9, 0.6, 1.0), DVec4::new(0.2, 1.0, -0.4, 0.0)]
        {
            let cover = MapCover { casters: &casters, view: [DVec3::ZERO; 8], frustum: LightFrustum::Casters };
            let made = fit(&cover, light, &storage(512)).expect("a frame");
            let one_by_one = casters.as_flattened().iter();
            let here = alone.install(|| fit(&cover, light, &storage(512)).expect("a frame"));
            assert_eq!(made, here, "{light}");
            let farthest = one_by_one.map(|point| (*point - light.truncate()).length()).fold(0.0, f64::max);
            let all: Vec<DVec3> = casters.as_flattened().iter().map(|point| *point - light.truncate()).collect();
            assert_eq!(greatest(&all, |point| point.length()).to_bits(), farthest.to_bits());
        }
    }

    fn quad(center: DVec3, half: f64) -> Vec<[DVec3; 3]> {
        let corner = |x: f64, z: f64| center + DVec3::new(x, 0.0, z) * half;
        let [a, b, c, d] = [corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)];
        vec![[a, b, c], [a, c, d]]
    }

    fn around(casters: &[[DVec3; 3]]) -> MapCover<'_> {
        MapCover { casters, view: [DVec3::ZERO; 8], frustum: LightFrustum::Casters }
    }

    fn project(frame: &LightFrame, face: usize, point: DVec3) -> DVec3 {
        let clip = frame.clip_from_light[face] * frame.light_from_world * point.extend(1.0);
        clip.truncate() / clip.w
    }

    #[test]
    fn a_narrow_caster_fills_one_perspective_map() {
        let casters = quad(DVec3::new(1.0, 0.0, -2.0), 0.5);
        let frame = fit(&around(&casters), DVec4::new(0.0, 5.0, 1.0, 1.0), &storage(1024)).expect("a frame");
        assert_eq!(frame.clip_from_light.len(), 1);
        let seen: Vec<DVec3> = casters.iter().flatten().map(|point| project(&frame, 0, *point)).collect();
        for axis in 0..2 {
            let low = seen.iter().map(|p| p[axis]).fold(f64::INFINITY, f64::min);
            let high = seen.iter().map(|p| p[axis]).fold(f64::NEG_INFINITY, f64::max);
            assert!((high - 1024.0 / 1028.0).abs() < 1e-9 && (low + 1024.0 / 1028.0).abs() < 1e-9, "{low}..{high}");
        }
        assert!(seen.iter().all(|p| p.z > 0.0 && p.z < 1.0));
    }

    #[test]
    fn casters_all_round_need_a_cube_and_every_point_is_in_its_face() {
        let mut casters = quad(DVec3::new(3.0, 0.0, 0.0), 0.5);
        casters.extend(quad(DVec3::new(-3.0, 0.0, 0.0), 0.5));
        let frame = fit(&around(&casters), DVec4::new(0.0, 0.1, 0.0, 1.0), &storage(512)).expect("a frame");
        assert_eq!(frame.clip_from_light.len(), 6);
        for (face, (_, forward, _)) in CUBE_FACES.iter().enumerate() {
            let seen = project(&frame, face, DVec3::new(0.0, 0.1, 0.0) + *forward * 2.0);
            assert!(seen.truncate().length() < 1e-12 && seen.z > 0.0 && seen.z < 1.0);
        }
    }

    #[test]
    fn a_directional_light_gets_a_box_around_the_casters() {
        let casters = quad(DVec3::new(7.0, 2.0, 1.0), 0.5);
        let frame = fit(&around(&casters), DVec4::new(0.3, 1.0, 0.2, 0.0), &storage(1024)).expect("a frame");
        for point in casters.iter().flatten() {
            let seen = project(&frame, 0, *point);
            assert!(seen.x.abs() < 1.0 && seen.y.abs() < 1.0 && seen.z > 0.0 && seen.z < 1.0);
        }
        let lower = project(&frame, 0, DVec3::new(7.0, -50.0, 1.0));
        assert!(lower.z < 0.0, "receivers beyond the box lie behind every caster");
    }

    const FITTED: SilhouetteView = SilhouetteView::Fitted { has_border: true };

    #[test]
    fn a_silhouette_fills_its_picture_but_for_the_border() {
        let caster: Vec<DVec3> = quad(DVec3::new(1.0, 0.5, -2.0), 0.5).into_iter().flatten().collect();
        for light in [DVec4::new(0.0, 5.0, 1.0, 1.0), DVec4::new(0.3, 1.0, -0.2, 0.0)] {
            let clip_from_world = fit_silhouette(&caster, light, FITTED).expect("a picture");
            let seen: Vec<DVec4> = caster.iter().map(|point| clip_from_world * point.extend(1.0)).collect();
            for axis in 0..2 {
                let widest = seen.iter().map(|clip| (clip[axis] / clip.w).abs()).fold(0.0, f64::max);
                assert!((widest - 0.98).abs() < 1e-12, "{widest}");
            }
            assert!(seen.iter().all(|clip| clip.w > 0.0 && clip.z == clip.w / 2.0));
            // A point and its shadow are in one place.
            let away = if light.w == 0.0 { -light.truncate() } else { caster[0] - light.truncate() };
            let shadow = clip_from_world * (caster[0] + away * 3.0).extend(1.0);
            assert!((shadow.truncate() / shadow.w - seen[0].truncate() / seen[0].w).length() < 1e-12);
        }
        assert_eq!(fit_silhouette(&caster, DVec4::new(1.0, 0.5, -2.0, 1.0), FITTED), None, "the light is within it");
    }

    #[test]
    fn the_nearest_point_of_a_triangle_may_be_inside_on_an_edge_or_a_corner() {
        let plane = [DVec3::new(-1.0, 2.0, -1.0), DVec3::new(-1.0, 2.0, 3.0), DVec3::new(3.0, 2.0, -1.0)];
        assert!((distance_to_triangle(plane) - 2.0).abs() < 1e-12);
        let moved = plane.map(|p| p + DVec3::new(4.0, 0.0, 1.0));
        assert!((distance_to_triangle(moved) - 13f64.sqrt()).abs() < 1e-12);
        let far = plane.map(|p| p + DVec3::new(4.0, 0.0, 4.0));
        assert!((distance_to_triangle(far) - 22f64.sqrt()).abs() < 1e-12);
    }
}

//! The frustum of a light's map: where it looks, and how far its depths reach.

use crate::capture::CapturedMap;
use glam::{DMat4, DVec3, DVec4};
use serde::Serialize;

/// The view of a light's map: its axes in world space, and its planes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MapFrustum {
    /// To the right in the map, of unit length, world space.
    pub right: [f64; 3],
    /// Up in the map.
    pub up: [f64; 3],
    /// Where it looks.
    pub ahead: [f64; 3],
    /// Distance of the near plane along `ahead` from the origin of the light's eye space, metres.
    pub near: f64,
    /// Distance of the far plane; `None` where there is none.
    pub far: Option<f64>,
    /// How many times as far as the near plane the far one is, for a lamp: the larger, the coarser depths are at the far end.
    /// `None` for a directional light, whose depths are as fine everywhere, and without a far plane.
    pub ratio: Option<f64>,
}

impl MapFrustum {
    /// Returns the frustum of a face of a map whose cleared depth is `clear`; `None` where one matrix goes from the world to
    /// clip space, or that has no inverse.
    pub fn of(map: &CapturedMap, face: usize, clear: f32) -> Option<MapFrustum> {
        let clip_from_light = *map.clip_from_light.get(face)?;
        if map.light_from_world == DMat4::IDENTITY {
            return None;
        }
        // Nothing is farther than what the map is cleared to.
        let [near, far] = [1.0 - f64::from(clear), f64::from(clear)];
        let light_from_clip = clip_from_light.inverse();
        // The face's own axes: a cube's look six ways from one eye space.
        let clip_from_world = clip_from_light * map.light_from_world;
        let is_lamp = clip_from_world.row(3).truncate().length_squared() > 0.0;
        let toward = |depth: f64| {
            let light = light_from_clip * DVec4::new(0.0, 0.0, depth, 1.0);
            (light.w.abs() > 1e-12 * light.truncate().length()).then(|| light.truncate() / light.w)
        };
        let ahead_row = if is_lamp { clip_from_world.row(3) } else { clip_from_world.row(2) * (far - near) };
        let ahead = ahead_row.truncate().try_normalize()?;
        // An off-centre frustum's rows of x and y lean towards where it looks.
        let across = |row: usize| {
            let row = clip_from_world.row(row).truncate();
            (row - ahead * row.dot(ahead)).try_normalize()
        };
        let in_light = map.light_from_world.transform_vector3(ahead);
        let distance = |depth: f64| toward(depth).map(|point: DVec3| point.dot(in_light) / in_light.length());
        let (near, far) = (distance(near)?, distance(far));
        Some(MapFrustum {
            right: across(0)?.to_array(),
            up: across(1)?.to_array(),
            ahead: ahead.to_array(),
            near,
            far,
            ratio: far.filter(|_| is_lamp).map(|far| far / near),
        })
    }

    /// Returns names and numbers: the axes, the planes and the ratio of their distances.
    pub fn rows(&self) -> Vec<(&'static str, Vec<f64>)> {
        let MapFrustum { right, up, ahead, near, far, ratio } = self;
        let mut rows = vec![("ahead", ahead.to_vec()), ("right", right.to_vec()), ("up", up.to_vec())];
        rows.push(match far {
            Some(far) => ("near, far", vec![*near, *far]),
            None => ("near", vec![*near]),
        });
        rows.extend(ratio.map(|ratio| ("far : near", vec![ratio])));
        rows
    }
}

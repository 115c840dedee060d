//! Texels of pictures that are projected from a light: where their middles fall on a surface.

use crate::plan::PlanMap;
use glam::{DMat3, DVec2, DVec3};

/// A layer of a light's textures or silhouettes, with the number of its texels along each side.
#[derive(Clone, Copy)]
pub(super) struct TextureLayer<'a> {
    pub map: &'a PlanMap,
    pub layer: usize,
    pub texels: f64,
}

impl TextureLayer<'_> {
    /// Returns where a surface point is in the picture: normalized device coordinates, −1 to 1. `None` behind the light,
    /// or where there is no such layer.
    pub fn place_of(&self, point: DVec3) -> Option<DVec2> {
        let clip = *self.map.clip_from_light.get(self.layer)? * point.extend(1.0);
        (clip.w > 0.0).then(|| clip.truncate().truncate() / clip.w)
    }

    /// Returns where a projection carries a surface point behind the light to, through the point that it turns round at.
    /// `None` before the light, or where there is no such layer.
    pub fn reverse_place_of(&self, point: DVec3) -> Option<DVec2> {
        let clip = *self.map.clip_from_light.get(self.layer)? * point.extend(1.0);
        (clip.w < 0.0).then(|| clip.truncate().truncate() / clip.w)
    }

    /// Returns where the light's lines through the middles of the texels around a place meet the plane through `point`
    /// with this normal. Texels are kept inside the picture; lines that do not meet the plane are left out.
    pub fn points_around(&self, place: DVec2, point: DVec3, normal: DVec3) -> Vec<DVec3> {
        let Some(clip) = self.map.clip_from_light.get(self.layer) else { return Vec::new() };
        // A line of the light is where two planes of clip space meet; the third is the surface's.
        let rows = clip.transpose();
        let line_at = |place: DVec2| {
            let [across, up] = [rows.x_axis - rows.w_axis * place.x, rows.y_axis - rows.w_axis * place.y];
            let planes = DMat3::from_cols(across.truncate(), up.truncate(), normal).transpose();
            planes.inverse() * DVec3::new(-across.w, -up.w, normal.dot(point))
        };
        let nearest = ((place + 1.0) / 2.0 * self.texels).floor();
        let center = |x: f64, y: f64| {
            let texel = (nearest + DVec2::new(x, y)).clamp(DVec2::ZERO, DVec2::splat(self.texels - 1.0));
            (texel + 0.5) / self.texels * 2.0 - 1.0
        };
        let steps = [-1.0, 0.0, 1.0];
        let around = steps.into_iter().flat_map(|x| steps.map(|y| center(x, y)));
        around.map(line_at).filter(|point| point.is_finite()).collect()
    }
}

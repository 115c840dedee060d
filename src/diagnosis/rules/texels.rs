//! Texels of pictures that are projected from a light: where their middles fall on a surface, and whether they are too
//! coarse for a receiver.

use super::planar::OFF_PLANE;
use crate::diagnosis::cause::Cause;
use crate::diagnosis::evidence::Quantity;
use crate::diagnosis::facts::{CauseRule, FrameFacts, RegionSamples, SuspectedCause};
use crate::diagnosis::fix::Fix;
use crate::plan::{Draw, DrawPart, PlanMap};
use crate::technique::Technique;
use crate::truth::SeenSurface;
use glam::{DMat3, DVec2, DVec3};

pub(crate) const RULES: &[CauseRule] = &[texture_aliasing];

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

/// Returns the layer of the receiver texture that a surface draw of this light reads on the visible triangle (the same
/// object and corners, within rounding); `None` where it reads none.
pub(super) fn texture_layer(facts: &FrameFacts, light: usize, seen: &SeenSurface) -> Option<usize> {
    let corners = seen.corners;
    let name = facts.tracer.name(seen.place);
    let is_of_piece = |draw: &&Draw| draw.constants.layer.is_some() && draw.caster.as_deref() == Some(name);
    let light_passes = facts.passes(light).filter(|pass| pass.view.0 == 0).flat_map(|pass| &pass.draws);
    let eye = facts.scene.camera.eye;
    let mut pieces = light_passes.filter(|draw| draw.part == DrawPart::Surface).filter(is_of_piece);
    let piece = pieces.find(|draw| {
        let Some(mesh) = facts.plan.meshes.get(draw.mesh.0) else { return false };
        draw.triangles.clone().any(|index| {
            (0..3).all(|corner| {
                let vertex = mesh
                    .indices
                    .data()
                    .get(index as usize * 3 + corner)
                    .and_then(|v| mesh.vertices.data().get(*v as usize));
                vertex.is_some_and(|[x, y, z, _]| {
                    let point = DVec3::new((*x).into(), (*y).into(), (*z).into());
                    let off = (corners[corner] - eye - point).length();
                    off <= 1e-6 * (point.length() + 1e-30)
                })
            })
        })
    });
    piece?.constants.layer.map(|layer| layer as usize)
}

fn texture_aliasing(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    if facts.technique() != Technique::PlanarTexture {
        return None;
    }
    let light = case.light();
    let map = facts.plan.lights.get(light)?.map.as_ref()?;
    let size = facts.texels();
    let (unlike, shown_by) = case.shown(|sample| {
        let seen = sample.seen?;
        let layer = TextureLayer { map, layer: texture_layer(facts, light, &seen)?, texels: size };
        let unlike = unlike_texels(facts, light, &seen, layer, case.is_false())?;
        (case.is_false() || case.is_missing()).then_some(unlike).filter(|unlike| *unlike > 0)
    })?;
    let sentence = format!("the receiver's texture has {size} texels a side, and the outline runs between two of them");
    let quantity = differing_texels(unlike);
    Some(SuspectedCause::new(Cause::Aliasing, case.evidence(sentence, shown_by, [quantity]), larger(size, 4096.0)))
}

/// Returns how many of the texels around a point lie where the truth is not what it is at the pixel, which must be some.
pub(super) fn differing_texels(unlike: usize) -> Quantity {
    Quantity::at_least("of nine texels around the point, those where the truth is another", unlike as f64, 1.0)
}

/// Returns how many of the nine texels around a point of a receiver lie where rays find the light (or, for a false
/// shadow, do not); `None` behind the light.
fn unlike_texels(
    facts: &FrameFacts,
    light: usize,
    seen: &SeenSurface,
    layer: TextureLayer,
    is_false: bool,
) -> Option<usize> {
    let normal = (seen.corners[1] - seen.corners[0]).cross(seen.corners[2] - seen.corners[0]).normalize_or_zero();
    let points = layer.points_around(layer.place_of(seen.point)?, seen.point, normal);
    // The receiver itself lies in its plane, and so does what throws no shadow on it.
    let in_plane = OFF_PLANE * 1e-3 * (seen.point - facts.scene.camera.eye).length();
    let is_dark = |point: &DVec3| {
        let steepness = normal.dot(facts.tracer.towards(light, *point)).abs();
        facts.tracer.between_points(light, *point).iter().any(|hit| hit.towards_light * steepness > in_plane)
    };
    Some(points.iter().filter(|point| is_dark(point) == is_false).count())
}

/// Returns fixes for coarse texels, in order: setting `size` to twice, then four times `size` (at most `most`; those
/// that are not larger are left out), then z-fail, which has no texels.
pub(crate) fn larger(size: f64, most: f64) -> Vec<Fix> {
    let mut sizes = vec![size];
    for larger in [size * 2.0, size * 4.0].map(|larger| larger.min(most)) {
        if sizes.iter().all(|known| larger > *known) {
            sizes.push(larger);
        }
    }
    let grow = sizes[1..].iter().map(|larger| Fix::setting("size", &format!("{larger}")));
    grow.chain([Fix::technique(Technique::ZFail)]).collect()
}

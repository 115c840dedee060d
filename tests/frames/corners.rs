//! Where a pixel's surface is in a shadow map, from nothing but the corners that two draws of one mesh have: no matrix is
//! solved for, as the weights of a triangle's corners are the same in both.

use std::collections::BTreeMap;
use std::sync::Arc;
use stencilscope::capture::Image;
use stencilscope::glam::{DVec2, DVec3, DVec4};
use stencilscope::import::{RawDraw, RawFrame, RawKind, RawTarget, RawView};

/// A mesh of a pass: its number of triangles, and which of those that have as many it is.
type MeshOfPass = (usize, usize);

/// Draws into one target, each by its mesh.
type TargetDraws<'a> = BTreeMap<MeshOfPass, &'a RawDraw>;

/// The draws of a frame with one shadow map: those of the picture, and of each layer of the map with what it holds.
pub struct SharedMeshes<'a> {
    picture: TargetDraws<'a>,
    layers: BTreeMap<u32, (TargetDraws<'a>, Arc<Image>)>,
    far: Option<f64>,
}

/// A place in a map.
#[derive(Debug)]
pub struct MapPlace {
    pub layer: u32,
    /// Columns and rows from the upper left corner.
    pub texel: DVec2,
    /// The triangle that it is on, in the map's clip space.
    corners: [DVec4; 3],
    view: RawView,
    /// What distances from the light are divided by, where the map holds them, in views of 90 degrees.
    far: Option<f64>,
}

impl MapPlace {
    /// What the map would store of the triangle's plane, at a place in columns and rows: depth, or the distance.
    pub fn depth_at(&self, texel: DVec2) -> f64 {
        let weights = weights(&self.view, self.corners, texel.extend(1.0));
        if let Some(far) = self.far {
            let clip: DVec4 = weights.iter().zip(self.corners).map(|(weight, corner)| corner * *weight).sum();
            return DVec3::new(clip.x, clip.y, 1.0).length() / weights.iter().sum::<f64>() / far;
        }
        // The weights are those of w = 1.
        let z: f64 = weights.iter().zip(self.corners).map(|(weight, corner)| weight * corner.z).sum();
        let z = if self.view.z_from_minus_w { (z + 1.0) / 2.0 } else { z };
        let [near, far] = self.view.depth_range.map(f64::from);
        near + (far - near) * z
    }
}

impl<'a> SharedMeshes<'a> {
    /// Finds the passes: the picture is the target of its size that most triangles are drawn into, and the map has another
    /// texture. `far` is what distances from the light are divided by, where the map holds them.
    pub fn of(frame: &'a RawFrame, size: [u32; 2], map: [u32; 2], far: Option<f64>) -> Option<SharedMeshes<'a>> {
        let mut targets: BTreeMap<RawTarget, (Vec<&RawDraw>, Option<Arc<Image>>)> = BTreeMap::new();
        for event in &frame.events {
            let Some(target) = event.depth_target else { continue };
            let (draws, content) = targets.entry(target).or_default();
            if let RawKind::Draw(draw) = &event.kind {
                draws.push(draw);
                *content = event.after.depth.clone().or(content.take());
            }
        }
        let triangles = |draws: &[&RawDraw]| draws.iter().map(|draw| draw.triangles.len()).sum::<usize>();
        let of_size = |target: &RawTarget, size: [u32; 2]| frame.textures[target.texture].size == size;
        let pictures = targets.iter().filter(|(target, _)| of_size(target, size));
        let (picture, (draws, _)) = pictures.max_by_key(|(_, (draws, _))| triangles(draws))?;
        let maps = targets.iter().filter(|(target, _)| of_size(target, map) && target.texture != picture.texture);
        let layers =
            maps.filter_map(|(target, (draws, content))| Some((target.layer, (by_mesh(draws), content.clone()?))));
        Some(SharedMeshes { picture: by_mesh(draws), layers: layers.collect(), far })
    }

    /// Returns what a layer of the map holds.
    pub fn stored(&self, layer: u32) -> Option<&Image> {
        self.layers.get(&layer).map(|(_, content)| &**content)
    }

    /// Returns where in the map the surface is that a pixel shows; `None` where it shows none, or one that is in no layer.
    /// Of several layers it is in the first one whose view reaches from before it to beyond it: cascades overlap.
    pub fn place(&self, [x, y]: [u32; 2]) -> Option<MapPlace> {
        let at = DVec3::new(f64::from(x) + 0.5, f64::from(y) + 0.5, 1.0);
        let of_draw = |(mesh, draw): (&MeshOfPass, &&RawDraw)| {
            let of_triangle = |index: usize| {
                let weights = weights(&draw.view, corners(draw, index), at);
                let is_inside = weights.iter().all(|weight| *weight >= 0.0) && weights.iter().sum::<f64>() > 0.0;
                is_inside.then_some((weights, *mesh, index))
            };
            (0..draw.triangles.len()).filter_map(of_triangle).collect::<Vec<_>>()
        };
        let all = self.picture.iter().flat_map(of_draw);
        // The sum of the weights is 1 / w.
        let (weights, mesh, triangle) =
            all.max_by(|(a, ..), (b, ..)| a.iter().sum::<f64>().total_cmp(&b.iter().sum::<f64>()))?;
        self.layers.iter().find_map(|(layer, (draws, _))| {
            let draw = draws.get(&mesh)?;
            let (corners, view) = (corners(draw, triangle), draw.view);
            let clip: DVec4 = weights.iter().zip(corners).map(|(weight, corner)| corner * *weight).sum();
            let is_inside = clip.w > 0.0 && clip.x.abs().max(clip.y.abs()) <= clip.w;
            let nearest = if view.z_from_minus_w { -clip.w } else { 0.0 };
            let is_inside = is_inside && (self.layers.len() == 1 || (nearest..=clip.w).contains(&clip.z));
            let window = is_inside.then(|| window(&view, clip) / clip.w)?;
            Some(MapPlace { layer: *layer, texel: window.truncate(), corners, view, far: self.far })
        })
    }
}

fn by_mesh<'a>(draws: &[&'a RawDraw]) -> TargetDraws<'a> {
    let mut found = TargetDraws::new();
    for draw in draws {
        // Depths may be drawn first, alone.
        if found.values().any(|known| known.positions == draw.positions && known.triangles == draw.triangles) {
            continue;
        }
        let triangles = draw.triangles.len();
        let before = found.keys().filter(|(count, _)| *count == triangles).count();
        found.insert((triangles, before), draw);
    }
    found
}

fn corners(draw: &RawDraw, triangle: usize) -> [DVec4; 3] {
    draw.triangles[triangle].map(|corner| DVec4::from_array(draw.positions[corner as usize].map(f64::from)))
}

/// Columns and rows times w; and w.
fn window(view: &RawView, clip: DVec4) -> DVec3 {
    let [left, top, width, height] = view.viewport.map(f64::from);
    let up = if view.y_up { -1.0 } else { 1.0 };
    let [x, y] = [clip.x + clip.w, up * clip.y + clip.w];
    DVec3::new(x * width / 2.0 + clip.w * left, y * height / 2.0 + clip.w * top, clip.w)
}

/// Returns of which parts of a triangle's corners, in clip space, a place in the picture consists, such that their w is 1;
/// none is negative where it is inside. They are not finite where the triangle is seen edge-on.
fn weights(view: &RawView, corners: [DVec4; 3], at: DVec3) -> [f64; 3] {
    let [a, b, c] = corners.map(|corner| window(view, corner));
    let turn = a.dot(b.cross(c));
    [b.cross(c), c.cross(a), a.cross(b)].map(|edge| edge.dot(at) / turn)
}

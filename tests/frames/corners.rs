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

/// The draws of a frame with one shadow map: those of the picture, and of each face of the map with what it holds.
pub struct SharedMeshes<'a> {
    picture: TargetDraws<'a>,
    faces: Vec<DrawnFace<'a>>,
    far: Option<f64>,
}

/// A layer of a map's texture, or of several that make the map; or the part of an atlas that one viewport is.
#[derive(Default)]
struct DrawnFace<'a> {
    draws: TargetDraws<'a>,
    /// Where it begins in its layer, in texels.
    first: [u32; 2],
    stored: Option<Arc<Image>>,
}

/// A place in a map.
#[derive(Debug)]
pub struct MapPlace {
    pub face: usize,
    /// Columns and rows from the upper left corner.
    pub texel: DVec2,
    /// The triangle that it is on, in the map's clip space.
    corners: [DVec4; 3],
    /// Its viewport is that in the face.
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
    /// Finds the passes: the picture is the target of its size that most triangles are drawn into, and the map's faces are of
    /// other textures. `far` is what distances from the light are divided by, where the map holds them.
    pub fn of(frame: &'a RawFrame, size: [u32; 2], face: [u32; 2], far: Option<f64>) -> Option<SharedMeshes<'a>> {
        let mut targets: BTreeMap<RawTarget, (Vec<&RawDraw>, Option<Arc<Image>>)> = BTreeMap::new();
        // Textures in the order in which they are drawn into.
        let mut textures: Vec<usize> = Vec::new();
        for event in &frame.events {
            let Some(target) = event.depth_target else { continue };
            let (draws, content) = targets.entry(target).or_default();
            if let RawKind::Draw(draw) = &event.kind {
                draws.push(draw);
                *content = event.after.depth.clone().or(content.take());
                if !textures.contains(&target.texture) {
                    textures.push(target.texture);
                }
            }
        }
        let triangles = |draws: &[&RawDraw]| draws.iter().map(|draw| draw.triangles.len()).sum::<usize>();
        let pictures = targets.iter().filter(|(target, _)| frame.textures[target.texture].size == size);
        let (picture, (draws, _)) = pictures.max_by_key(|(_, (draws, _))| triangles(draws))?;
        let maps = textures.into_iter().filter(|texture| *texture != picture.texture);
        let layers = maps.flat_map(|texture| {
            (0..frame.textures[texture].layers.max(1)).map(move |layer| RawTarget { texture, layer, mip: 0 })
        });
        let faces = layers.flat_map(|target| match targets.get(&target) {
            Some((draws, stored)) => faces_of(draws, stored.as_ref(), frame.textures[target.texture].size),
            None => vec![(frame.textures[target.texture].size, DrawnFace::default())],
        });
        let faces = faces.filter(|(size, _)| *size == face).map(|(_, face)| face).collect();
        Some(SharedMeshes { picture: by_mesh(draws), faces, far })
    }

    /// Returns what a texel of a face holds.
    pub fn stored(&self, face: usize, [x, y]: [u32; 2]) -> Option<f32> {
        let DrawnFace { first: [left, top], stored, .. } = self.faces.get(face)?;
        stored.as_ref()?.depth_at([left + x, top + y])
    }

    /// Returns where in the map the surface is that a pixel shows; `None` where it shows none, or one that is in no face.
    /// Of several faces it is in the first one whose view reaches from before it to beyond it: cascades overlap.
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
        self.faces.iter().enumerate().find_map(|(face, DrawnFace { draws, first, .. })| {
            let draw = draws.get(&mesh)?;
            let (corners, mut view) = (corners(draw, triangle), draw.view);
            view.viewport[0] -= first[0] as f32;
            view.viewport[1] -= first[1] as f32;
            let clip: DVec4 = weights.iter().zip(corners).map(|(weight, corner)| corner * *weight).sum();
            let is_inside = clip.w > 0.0 && clip.x.abs().max(clip.y.abs()) <= clip.w;
            let nearest = if view.z_from_minus_w { -clip.w } else { 0.0 };
            let is_inside = is_inside && (self.faces.len() == 1 || (nearest..=clip.w).contains(&clip.z));
            let window = is_inside.then(|| window(&view, clip) / clip.w)?;
            Some(MapPlace { face, texel: window.truncate(), corners, view, far: self.far })
        })
    }
}

/// Returns the faces of a layer of this size, each with its own: one for each viewport of its draws.
fn faces_of<'a>(draws: &[&'a RawDraw], stored: Option<&Arc<Image>>, size: [u32; 2]) -> Vec<([u32; 2], DrawnFace<'a>)> {
    let mut viewports: Vec<[f32; 4]> = Vec::new();
    for draw in draws.iter().filter(|draw| !draw.triangles.is_empty()) {
        if !viewports.contains(&draw.view.viewport) {
            viewports.push(draw.view.viewport);
        }
    }
    let whole = || DrawnFace { draws: by_mesh(draws), first: [0, 0], stored: stored.cloned() };
    if viewports.is_empty() {
        return vec![(size, whole())];
    }
    let face = |viewport: [f32; 4]| {
        let own: Vec<&RawDraw> = draws.iter().copied().filter(|draw| draw.view.viewport == viewport).collect();
        let [left, top, width, height] = viewport.map(|texels| texels as u32);
        ([width, height], DrawnFace { draws: by_mesh(&own), first: [left, top], ..whole() })
    };
    viewports.into_iter().map(face).collect()
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

//! A point in the spaces of a light: its eye space, its clip space, and the texture coordinates (s, t, r, q).
//!
//! The last matrix is the bias matrix: it halves x and y and moves them by half of w, so that after the division by q a map
//! or a texture is read from 0 to 1. Rows of texels run down, so y is turned; depth is from 0 to 1 already, so z stays
//! (OpenGL, whose depth is from −1 to 1, halves it too).

use super::camera_matrices::OPENGL_FROM_CLIP;
use super::map_frustum::MapFrustum;
use super::matrices::TransformStep;
use crate::capture::{Capture, CapturedMap};
use crate::history::PixelHistory;
use crate::numbers;
use crate::plan::{DecidedBy, DrawPart, FramePlan, Visibility};
use glam::{DMat4, DVec3, DVec4};
use serde::Serialize;

/// A point carried to a layer of a light's map, textures or silhouettes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LightCoordinates {
    /// Index of the light.
    pub light: usize,
    /// Index of the layer: a face of its map, a receiver's texture, a caster's silhouette.
    pub layer: usize,
    /// Light and layer in words.
    pub name: String,
    /// The light's eye space, metres; `None` where one matrix goes from the world to each layer's clip space.
    pub eye: Option<[f64; 3]>,
    /// The light's clip space, homogeneous.
    pub clip: [f64; 4],
    /// Texture coordinates before the division: s, t, r, q.
    pub strq: [f64; 4],
    /// s, t and r over q; `None` behind the light, where q is not positive.
    pub texture: Option<[f64; 3]>,
    /// Column and row in texels from the upper left corner; `None` behind the light.
    pub texel: Option<[f64; 2]>,
    /// The view of the map; `None` where `eye` is.
    pub frustum: Option<MapFrustum>,
    /// The matrices from world space to texture coordinates, in order.
    pub chain: Vec<TransformStep>,
    /// The last two as OpenGL has them: z in clip space from −w to w, rows of texels from below.
    pub opengl: Vec<TransformStep>,
    /// Rows of texels in the map.
    #[serde(skip)]
    rows_of_texels: f64,
}

/// The bias matrix: (s, t, r, q) from clip space.
pub const TEXTURE_FROM_CLIP: DMat4 = DMat4::from_cols(
    DVec4::new(0.5, 0.0, 0.0, 0.0),
    DVec4::new(0.0, -0.5, 0.0, 0.0),
    DVec4::Z,
    DVec4::new(0.5, 0.5, 0.0, 1.0),
);

/// OpenGL's bias matrix, which halves x, y and z alike and moves them by half of w.
const OPENGL_TEXTURE_FROM_CLIP: DMat4 = DMat4::from_cols(
    DVec4::new(0.5, 0.0, 0.0, 0.0),
    DVec4::new(0.0, 0.5, 0.0, 0.0),
    DVec4::new(0.0, 0.0, 0.5, 0.0),
    DVec4::new(0.5, 0.5, 0.5, 1.0),
);

/// How much farther than its border a face of a depth map is looked up, as in `arriving_by_map.wgsl`.
const BORDER: f64 = 1.0001;

impl LightCoordinates {
    /// Returns the point in the layers that decide about each light: the first face of a map of depths that sees it. Textures
    /// and silhouettes need the plan and the pixel's history: the receiver's own texture, and the silhouettes of all
    /// casters but the surface's own in whose pictures the point is.
    pub fn of(capture: &Capture, world: DVec3, seen: Option<(&FramePlan, &PixelHistory)>) -> Vec<LightCoordinates> {
        let mut found = Vec::new();
        for (light, of) in capture.lights.iter().enumerate() {
            let Some(map) = &of.map else { continue };
            let clear = capture.map_clear_depth(light);
            let own = seen.and_then(|(plan, history)| own_layer(plan, history, light));
            let all = (0..map.clip_from_light.len()).filter_map(|layer| carried(map, [light, layer], clear, world));
            match capture.decided_by(light) {
                DecidedBy::ReceiverTextures => {
                    found.extend(own.flatten().and_then(|layer| carried(map, [light, layer as usize], clear, world)));
                }
                DecidedBy::Silhouettes => {
                    let is_other = |place: &LightCoordinates| own.is_some_and(|own| own != Some(place.layer as u32));
                    found.extend(all.filter(is_other).filter(|place| place.is_inside(1.0)));
                }
                _ => found.extend({ all }.find(|place| place.is_inside(BORDER))),
            }
        }
        found
    }

    fn is_inside(&self, border: f64) -> bool {
        let [x, y, _, w] = self.clip;
        w > 0.0 && x.abs().max(y.abs()) <= w * border
    }

    /// Returns the same as OpenGL has it: clip space's z is from −w to w, t and the rows of texels are counted from below; r is
    /// the same.
    #[must_use]
    pub fn in_opengl(self) -> LightCoordinates {
        let ([x, y, z, w], [s, t, r, q]) = (self.clip, self.strq);
        let before = self.chain.len() - self.opengl.len();
        LightCoordinates {
            clip: [x, y, 2.0 * z - w, w],
            strq: [s, q - t, r, q],
            texture: self.texture.map(|[s, t, r]| [s, 1.0 - t, r]),
            texel: self.texel.map(|[column, row]| [column, self.rows_of_texels - row]),
            chain: [&self.chain[..before], &self.opengl].concat(),
            ..self
        }
    }

    /// Returns name and coordinates of the point in each space of the light, and the numbers of its frustum.
    pub fn rows(&self) -> Vec<(&'static str, Vec<f64>)> {
        let mut rows = Vec::new();
        rows.extend(self.eye.map(|eye| ("light eye", eye.to_vec())));
        rows.push(("light clip", self.clip.to_vec()));
        rows.push(("(s,t,r,q)", self.strq.to_vec()));
        rows.extend(self.texture.map(|texture| ("over q", texture.to_vec())));
        rows.extend(self.texel.map(|texel| ("texel", texel.to_vec())));
        rows.extend(self.frustum.iter().flat_map(MapFrustum::rows));
        rows
    }
}

/// Returns the layer of a light's textures that belongs to the surface that a pixel shows, by the draw that adds the light
/// there: `Some(None)` for a surface without one; `None` where no such draw is known, or it reads no map or texture.
pub(super) fn own_layer(plan: &FramePlan, history: &PixelHistory, light: usize) -> Option<Option<u32>> {
    history.events.iter().rev().find_map(|event| {
        let one = event.triangle().filter(|one| one.outcome.passed() && event.light == Some(light))?;
        let draw = plan.passes.get(event.pass)?.draws.get(one.draw)?;
        (draw.part == DrawPart::Surface && draw.program.visibility().is_some_and(Visibility::reads_map))
            .then_some(draw.constants.layer)
    })
}

fn carried(map: &CapturedMap, [light, layer]: [usize; 2], clear: f32, world: DVec3) -> Option<LightCoordinates> {
    let size = map.faces.get(layer).or(map.faces.first())?.size().map(f64::from);
    let clip_from_eye = *map.clip_from_light.get(layer)?;
    let has_eye = map.light_from_world != DMat4::IDENTITY;
    let eye = map.light_from_world * world.extend(1.0);
    let clip = clip_from_eye * eye;
    let strq = TEXTURE_FROM_CLIP * clip;
    let texture = (strq.w > 0.0).then(|| (strq.truncate() / strq.w).to_array());
    let mut chain = Vec::new();
    if has_eye {
        chain.push(TransformStep::new("light eye from world", map.light_from_world));
        chain.push(TransformStep::new("light clip from light eye", clip_from_eye));
    } else {
        chain.push(TransformStep::new("light clip from world", clip_from_eye));
    }
    chain.push(TransformStep::new("(s,t,r,q) from light clip, the bias matrix", TEXTURE_FROM_CLIP));
    let opengl_clip = OPENGL_FROM_CLIP * clip_from_eye;
    let opengl = vec![
        TransformStep::new(
            if has_eye { "OpenGL's light clip from light eye" } else { "OpenGL's light clip from world" },
            opengl_clip,
        ),
        TransformStep::new("OpenGL's (s,t,r,q) from light clip, its bias matrix", OPENGL_TEXTURE_FROM_CLIP),
    ];
    let of_layer = match map.layer_names.get(layer) {
        Some(name) => format!("layer of {name}"),
        None => format!("face {} of its map", layer + 1),
    };
    Some(LightCoordinates {
        light,
        layer,
        name: format!("{}, {of_layer}", numbers::light(light)),
        eye: has_eye.then(|| eye.truncate().to_array()),
        clip: clip.to_array(),
        strq: strq.to_array(),
        texel: texture.map(|[s, t, _]| [s * size[0], t * size[1]]),
        texture,
        frustum: MapFrustum::of(map, layer, clear),
        chain,
        opengl,
        rows_of_texels: size[1],
    })
}

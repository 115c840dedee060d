//! Which texel of a light's shadow map each pixel of the picture reads: the pixel's surface carried into
//! the map, as the shader does, made once for a frame and light.
//!
//! A bias along the normal moves the surface before it is looked up; the capture has no normals, so that
//! is left out here, and the panel says so.

use super::depth::DepthMeasure;
use crate::capture::{Capture, CapturedMap};
use crate::math::projection;
use glam::{DMat4, DVec3};

/// Points on the border between two faces belong to both, as in `arriving_by_map.wgsl`.
const BORDER: f64 = 1.0001;

/// No filter is wider, texels: a folder may tell anything.
const WIDEST: u32 = 64;

/// A texel of a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MapTexel {
    /// Index of the face.
    pub face: usize,
    /// Column and row.
    pub at: [u32; 2],
}

/// Which texel each pixel reads.
#[derive(Debug)]
pub struct MapReaders {
    size: [u32; 2],
    map_size: [u32; 2],
    /// Texels that are compared along each side.
    filter: u32,
    /// Of each pixel the first texel that it reads: face, column, row.
    first: Vec<Option<[i16; 3]>>,
}

impl MapReaders {
    /// Of the picture after the frame; `None` where the light has no shadow map, or nothing is drawn.
    #[must_use]
    pub fn new(capture: &Capture, light: usize) -> Option<MapReaders> {
        let map = capture.lights.get(light)?.map.as_ref().filter(|map| !map.holds_colors())?;
        let map_size = map.faces.first()?.size();
        let depth = capture.frame_at(capture.steps.len().checked_sub(1)?)?.depth.image.clone();
        let surface = Surface::new(capture);
        let filter = filter_width(capture);
        let mut first = Vec::with_capacity(capture.size[0] as usize * capture.size[1] as usize);
        for (y, row) in (0..).zip(depth.rows()) {
            for (x, texel) in (0..).zip(row.chunks_exact(4)) {
                let world = surface.at([x, y], bytemuck::pod_read_unaligned(texel));
                first.push(world.and_then(|world| lookup(map, world, map_size, filter)));
            }
        }
        Some(MapReaders { size: capture.size, map_size, filter, first })
    }

    /// The texel that a pixel reads, the middle one of several; `None` where it reads none.
    #[must_use]
    pub fn texel_of(&self, [x, y]: [u32; 2]) -> Option<MapTexel> {
        let index = (y as usize).checked_mul(self.size[0] as usize)? + x as usize;
        let [face, column, row] = (*self.first.get(index).filter(|_| x < self.size[0])?)?;
        let middle = (self.filter / 2) as i16;
        let at = [0, 1].map(|axis| {
            let first = [column, row][axis].saturating_add(middle).max(0) as u32;
            first.min(self.map_size[axis].saturating_sub(1))
        });
        Some(MapTexel { face: face as usize, at })
    }

    /// The pixels that read a texel.
    #[must_use]
    pub fn of_texel(&self, texel: MapTexel) -> Vec<[u32; 2]> {
        let reads = |first: [i16; 3]| {
            let is_in = |first: i16, at: u32, side: u32| {
                let last = i32::from(first) + self.filter as i32 - 1;
                let [from, to] = [i32::from(first), last].map(|place| place.clamp(0, (side as i32 - 1).max(0)));
                (from..=to).contains(&(at as i32))
            };
            first[0] as usize == texel.face
                && is_in(first[1], texel.at[0], self.map_size[0])
                && is_in(first[2], texel.at[1], self.map_size[1])
        };
        let width = self.size[0].max(1) as usize;
        let place = |index: usize| [(index % width) as u32, (index / width) as u32];
        let found = self.first.iter().enumerate().filter(|(_, first)| first.is_some_and(reads));
        found.map(|(index, _)| place(index)).collect()
    }
}

/// Face and first texel that a point reads.
fn lookup(map: &CapturedMap, world: DVec3, size: [u32; 2], filter: u32) -> Option<[i16; 3]> {
    let in_light = map.light_from_world * world.extend(1.0);
    for (face, clip_from_light) in map.clip_from_light.iter().enumerate() {
        let clip = *clip_from_light * in_light;
        if clip.w > 0.0 && clip.x.abs().max(clip.y.abs()) <= clip.w * BORDER {
            let aside = 0.5 * f64::from(filter - 1);
            let place = |device: f64, side: u32| ((device * 0.5 + 0.5) * f64::from(side) - aside).floor() as i16;
            return Some([face as i16, place(clip.x / clip.w, size[0]), place(-clip.y / clip.w, size[1])]);
        }
    }
    None
}

/// Texels that are averaged along each side: `pcf:3` is 3.
fn filter_width(capture: &Capture) -> u32 {
    let filter = capture.settings.get("filter").and_then(|filter| filter.strip_prefix("pcf:"));
    filter.and_then(|width| width.parse().ok()).unwrap_or(1).clamp(1, WIDEST)
}

/// From a pixel and its depth to the world.
#[derive(Debug)]
pub struct Surface {
    measure: DepthMeasure,
    world_from_view: glam::DMat3,
    eye: DVec3,
    up: f64,
    size: [f64; 2],
}

impl Surface {
    /// Of the camera of a capture.
    #[must_use]
    pub fn new(capture: &Capture) -> Surface {
        let camera = &capture.camera;
        Surface {
            measure: DepthMeasure::of_camera(capture),
            world_from_view: projection::view_from_world_rotation(camera.target - camera.eye, camera.up).transpose(),
            eye: camera.eye,
            up: (camera.fov_y_degrees.to_radians() / 2.0).tan(),
            size: capture.size.map(f64::from),
        }
    }

    /// World position of the surface at the middle of a pixel; `None` where there is none.
    #[must_use]
    pub fn at(&self, [x, y]: [u32; 2], depth: f32) -> Option<DVec3> {
        let distance = self.measure.value(depth).filter(|distance| distance.is_finite())?;
        let [width, height] = self.size;
        let across = (2.0 * (f64::from(x) + 0.5) / width - 1.0) * self.up * width / height;
        let up = (1.0 - 2.0 * (f64::from(y) + 0.5) / height) * self.up;
        Some(self.eye + self.world_from_view * DVec3::new(across, up, -1.0) * distance)
    }
}

/// How wide a texel of a face is at a world position, metres; `None` where the face does not see it.
#[must_use]
pub fn texel_width(map: &CapturedMap, face: usize, world: DVec3) -> Option<f64> {
    let clip_from_light: &DMat4 = map.clip_from_light.get(face)?;
    let clip = *clip_from_light * map.light_from_world * world.extend(1.0);
    let focal = clip_from_light.row(0).truncate().length();
    let side = f64::from(map.faces.get(face)?.size()[0]);
    (clip.w > 0.0 && focal > 0.0).then(|| 2.0 * clip.w / (focal * side))
}

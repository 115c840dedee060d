//! Points of the world in the picture and in shadow maps.

use crate::capture::Capture;
use crate::reading::depth::DepthMeasure;
use crate::scene::{Camera, CameraRays};
use glam::{DMat3, DVec2, DVec3, DVec4};

/// The texel of a light's shadow map that a pixel's surface falls in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowMapTexel {
    /// Index of the map's face.
    pub face: usize,
    /// Column and row from the top left.
    pub texel: [u32; 2],
    /// The depth that the map stores there.
    pub stored: f32,
    /// The depth that the surface has there, before any bias.
    pub surface: f64,
    /// How much nearer to the light the map's depth is than the surface, metres along the map's axis; `None` where the
    /// map shows nothing there.
    pub gap: Option<f64>,
}

/// Returns the texel of a light's shadow map that a world-space point falls into, on the first face that contains it;
/// `None` outside all faces, or where the light has no map of depths.
pub fn texel_of(capture: &Capture, light: usize, point: DVec3) -> Option<ShadowMapTexel> {
    let map = capture.lights.get(light)?.map.as_ref().filter(|map| !map.holds_colors())?;
    let in_light = map.light_from_world * point.extend(1.0);
    let on_face = |(face, clip_from_light): (usize, &glam::DMat4)| {
        let clip: DVec4 = *clip_from_light * in_light;
        let image = map.faces.get(face)?;
        let [width, height] = image.size().map(f64::from);
        // Row 0 is at the top.
        let at = (clip.truncate().truncate() / clip.w * DVec2::new(0.5, -0.5) + 0.5) * DVec2::new(width, height);
        let is_inside = clip.w > 0.0 && at.cmpge(DVec2::ZERO).all() && at.cmplt(DVec2::new(width, height)).all();
        let texel = is_inside.then_some([at.x as u32, at.y as u32])?;
        let (stored, surface) = (image.depth_at(texel)?, clip.z / clip.w);
        let measure = DepthMeasure::of_map(capture, light, face);
        let metres = |depth: f32| measure.and_then(|measure| measure.value(depth));
        let gap = metres(surface as f32).zip(metres(stored)).map(|(surface, stored)| surface - stored);
        Some(ShadowMapTexel { face, texel, stored, surface, gap })
    };
    map.clip_from_light.iter().enumerate().find_map(on_face)
}

/// The projection of a frame's camera, from world space to pixels and back.
pub struct CameraProjection {
    /// Width and height of the picture, in pixels.
    pub size: DVec2,
    camera: Camera,
    rays: CameraRays,
    view_from_world: DMat3,
}

impl CameraProjection {
    /// Returns the projection of a frame's camera.
    pub fn of(capture: &Capture) -> CameraProjection {
        let camera = &capture.camera;
        let [width, height] = capture.size.map(f64::from);
        CameraProjection {
            size: DVec2::new(width, height),
            camera: *camera,
            rays: camera.picture_rays(capture.size),
            view_from_world: camera.world_from_view().transpose(),
        }
    }

    /// Returns where a world-space point is in the picture, in pixels from its top left corner (perhaps outside), and
    /// its distance along the view axis, metres, negative behind the eye.
    pub fn pixel_and_distance(&self, point: DVec3) -> (DVec2, f64) {
        let in_view = self.view_from_world * (point - self.camera.eye);
        let distance = -in_view.z;
        // The view ray through the picture's centre is there at this distance.
        let middle = self.view_from_world * self.rays.through(DVec2::ZERO).at(distance);
        let half = self.rays.half_size();
        let half = if self.camera.is_parallel() { half } else { half * distance };
        let at = (in_view - middle).truncate() / half;
        ((at * DVec2::new(0.5, -0.5) + 0.5) * self.size, distance)
    }

    /// Returns the world-space point at this place of the picture (pixels from the top left corner), `distance` metres
    /// along the view axis.
    pub fn point(&self, at: DVec2, distance: f64) -> DVec3 {
        let at = (at / self.size - 0.5) * DVec2::new(2.0, -2.0);
        self.camera.eye + self.rays.through(at).at(distance)
    }

    /// Returns the width of a pixel at a distance, metres.
    pub fn pixel_width(&self, distance: f64) -> f64 {
        self.camera.pixel_width_at(distance, self.size.to_array().map(|side| side as u32))
    }
}

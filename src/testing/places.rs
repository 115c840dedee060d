//! Points of the world in the picture and in shadow maps.

use crate::capture::Capture;
use crate::math::projection;
use crate::reading::depth::DepthMeasure;
use glam::{DMat3, DVec2, DVec3, DVec4};

/// The texel of a light's shadow map that a pixel's surface falls in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapTexel {
    /// Which face of the map.
    pub face: usize,
    /// Column and row from the top left.
    pub texel: [u32; 2],
    /// The depth that it holds, as stored.
    pub stored: f32,
    /// The depth that the surface has there, before any bias.
    pub surface: f64,
    /// How much nearer to the light what the map holds is than the surface, metres along the map's axis; `None` where
    /// it holds nothing.
    pub gap: Option<f64>,
}

/// Where a light's shadow map shows a point of the world.
pub fn texel_of(capture: &Capture, light: usize, point: DVec3) -> Option<MapTexel> {
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
        Some(MapTexel { face, texel, stored, surface, gap })
    };
    map.clip_from_light.iter().enumerate().find_map(on_face)
}

/// How the camera sees the world.
pub struct View {
    /// Of the picture, in pixels.
    pub size: DVec2,
    eye: DVec3,
    view_from_world: DMat3,
    /// Half the picture's width and height, a metre away.
    half: DVec2,
}

impl View {
    /// Of the camera of a frame.
    pub fn of(capture: &Capture) -> View {
        let camera = &capture.camera;
        let [width, height] = capture.size.map(f64::from);
        let up = (camera.fov_y_degrees / 2.0).to_radians().tan();
        View {
            size: DVec2::new(width, height),
            eye: camera.eye,
            view_from_world: projection::view_from_world_rotation(camera.target - camera.eye, camera.up),
            half: DVec2::new(up * width / height, up),
        }
    }

    /// Where a point is in the picture, in pixels from its top left corner, and how far along the view axis, metres.
    pub fn pixel_and_distance(&self, point: DVec3) -> (DVec2, f64) {
        let in_view = self.view_from_world * (point - self.eye);
        let distance = -in_view.z;
        let at = in_view.truncate() / distance / self.half;
        ((at * DVec2::new(0.5, -0.5) + 0.5) * self.size, distance)
    }

    /// The point at this place of the picture, so far along the view axis.
    pub fn point(&self, at: DVec2, distance: f64) -> DVec3 {
        let in_view = (at / self.size - 0.5) * DVec2::new(2.0, -2.0) * self.half;
        self.eye + self.view_from_world.transpose() * (in_view.extend(-1.0) * distance)
    }

    /// How wide a pixel is so far away, metres.
    pub fn pixel_width(&self, distance: f64) -> f64 {
        2.0 * self.half.y * distance / self.size.y
    }
}

//! Faces and lines of a stage on a view's screen, the farthest first (the painter's algorithm).
//!
//! Each corner is projected and shaded once, and the mesh names it. What is behind a wall is painted before
//! the wall, the rest after it. What is cut by the near plane of a perspective view is cut into up to two
//! triangles; what lies outside the view's rectangle is left out. Lines are drawn as narrow faces with a
//! soft border.

use super::lens::Lens;
use super::stage::{Face, Layer, Line, Point, Stage};
use super::walls::Sides;
use egui::{Color32, Mesh, Pos2, Rect, Vec2, pos2};
use glam::{DVec4, Mat3, Vec3};
use std::sync::Arc;

/// How far lines and shells are drawn before what they lie on, in parts of the stage's radius.
const LINES_BEFORE: f32 = 0.04;
const SHELLS_BEFORE: f32 = 0.004;
/// What is left of the colour of a wall that one looks through.
const GLASS: f32 = 0.07;
/// Width of a line's soft border, points.
const SOFT: f32 = 0.6;

/// What is painted earlier, whatever the distances.
const BEHIND_WALLS: u64 = 0;
const WALLS_SEEN_FROM_BEHIND: u64 = 1;
const WALLS: u64 = 2;
const BEFORE_WALLS: u64 = 3;
/// Bits of a key that are the index of a face or line.
const INDEX_BITS: u32 = 30;

/// The stage as triangles on the screen.
#[must_use]
pub fn paint(stage: &Stage, lens: &Lens, rect: Rect) -> Arc<Mesh> {
    let view = View::new(stage, lens, rect);
    let mut mesh = Mesh::default();
    mesh.vertices.reserve(stage.points.len() + stage.lines.len() * 8);
    let mut depths = Vec::with_capacity(stage.points.len());
    for point in &stage.points {
        let at = view.at(point.at);
        depths.push(at.z);
        // What is not before the eye has no place; no face names it as it is.
        let place = if at.z <= view.near { view.place(at) } else { rect.center() };
        mesh.colored_vertex(place, view.shade(point, at));
    }
    let order = view.order(stage, &depths, &mesh);
    mesh.indices.reserve(order.len() * 3);
    for key in order {
        let index = (key & ((1 << INDEX_BITS) - 1)) as usize;
        match stage.faces.get(index) {
            Some(face) if face.corners.iter().all(|corner| depths[*corner as usize] <= view.near) => {
                mesh.indices.extend(face.corners);
            }
            Some(face) => view.cut_face(face, stage, &mut mesh),
            None => view.line(&stage.lines[index - stage.faces.len()], &mut mesh),
        }
    }
    Arc::new(mesh)
}

/// The lens in single precision, relative to the stage's middle.
struct View {
    rotation: Mat3,
    offset: Vec3,
    near: f32,
    rect: Rect,
    /// How far before the middle the eye is; `None` in parallel views.
    eye: Option<f32>,
    shear: Vec2,
    scale: f32,
    /// World space, relative to the stage's middle.
    viewer: Vec3,
    is_direction: bool,
    /// What walls hide.
    hidden: Sides,
    radius: f32,
}

impl View {
    fn new(stage: &Stage, lens: &Lens, rect: Rect) -> View {
        let viewer = lens.viewer();
        let relative: DVec4 = viewer - stage.middle.extend(0.0) * viewer.w;
        View {
            rotation: lens.rotation.as_mat3(),
            offset: lens.view(stage.middle).as_vec3(),
            near: lens.near() as f32,
            rect,
            eye: lens.eye.map(|eye| eye as f32),
            shear: Vec2::new(lens.shear.x as f32, lens.shear.y as f32),
            scale: lens.scale as f32,
            viewer: relative.truncate().as_vec3(),
            is_direction: viewer.w == 0.0,
            hidden: stage.walls.hidden(viewer),
            radius: stage.radius as f32,
        }
    }

    fn at(&self, corner: Vec3) -> Vec3 {
        self.rotation * corner + self.offset
    }

    /// [`Lens::project`] in single precision.
    fn place(&self, at: Vec3) -> Pos2 {
        let (x, y) = match self.eye {
            Some(eye) => {
                let share = eye / (eye - at.z);
                (at.x * share, at.y * share)
            }
            None => (at.x - self.shear.x * at.z, at.y - self.shear.y * at.z),
        };
        let middle = self.rect.center();
        pos2(middle.x + x * self.scale, middle.y - y * self.scale)
    }

    /// Keys of what is seen, in the order of painting: the layer, how near it is, the index.
    fn order(&self, stage: &Stage, depths: &[f32], mesh: &Mesh) -> Vec<u64> {
        let mut keys = Vec::with_capacity(stage.faces.len() + stage.lines.len());
        let key =
            |layer: u64, near: f32, index: usize| layer << 62 | u64::from(ordered(near)) << INDEX_BITS | index as u64;
        let layer = |sides: Sides| if sides.meets(self.hidden) { BEHIND_WALLS } else { BEFORE_WALLS };
        for (index, face) in stage.faces.iter().enumerate() {
            let [a, b, c] = face.corners.map(|corner| depths[corner as usize]);
            let middle = (a + b + c) / 3.0;
            let is_whole = a <= self.near && b <= self.near && c <= self.near;
            if !middle.is_finite() || (is_whole && self.is_outside(face, mesh)) {
                continue;
            }
            keys.push(match face.layer {
                Layer::Wall => key(self.wall_layer(&stage.points[face.corners[0] as usize]), middle, index),
                Layer::Solid => key(layer(face.sides), middle, index),
                Layer::Shell => key(layer(face.sides), middle + SHELLS_BEFORE * self.radius, index),
            });
        }
        for (index, line) in stage.lines.iter().enumerate() {
            let middle = self.at((line.ends[0] + line.ends[1]) / 2.0);
            let near = middle.z + LINES_BEFORE * self.radius;
            keys.push(key(layer(line.sides), near, stage.faces.len() + index));
        }
        keys.sort_unstable();
        keys
    }

    /// Of a box one sees no wall before another that is seen from its front.
    fn wall_layer(&self, point: &Point) -> u64 {
        let towards = if self.is_direction { self.viewer } else { self.viewer - point.at };
        if point.normal.dot(towards) > 0.0 { WALLS } else { WALLS_SEEN_FROM_BEHIND }
    }

    fn is_outside(&self, face: &Face, mesh: &Mesh) -> bool {
        let places = face.corners.map(|corner| mesh.vertices[corner as usize].pos);
        !(Rect::from_points(&places).intersects(self.rect) && places.iter().all(|place| place.is_finite()))
    }

    /// What of a face is beyond the near plane.
    fn cut_face(&self, face: &Face, stage: &Stage, mesh: &mut Mesh) {
        let corners = face.corners.map(|corner| {
            let color = mesh.vertices[corner as usize].color;
            (self.at(stage.points[corner as usize].at), color)
        });
        let mut kept = [(Vec3::ZERO, Color32::TRANSPARENT); 4];
        let mut count = 0;
        for index in 0..3 {
            let (here, next) = (corners[index], corners[(index + 1) % 3]);
            if here.0.z <= self.near {
                kept[count] = here;
                count += 1;
            }
            if (here.0.z <= self.near) != (next.0.z <= self.near) {
                let share = (self.near - here.0.z) / (next.0.z - here.0.z);
                kept[count] = (here.0.lerp(next.0, share), here.1.lerp_to_gamma(next.1, share));
                count += 1;
            }
        }
        for last in 2..count {
            self.triangle([kept[0], kept[last - 1], kept[last]], mesh);
        }
    }

    /// Surfaces seen face on are lighter than those seen from the side, whichever way they are wound.
    fn shade(&self, point: &Point, at: Vec3) -> Color32 {
        if point.normal == Vec3::ZERO {
            return point.color;
        }
        let towards = match self.eye {
            Some(eye) => (Vec3::Z * eye - at).normalize_or_zero(),
            None => Vec3::Z,
        };
        let normal = self.rotation * point.normal;
        // What lies between the viewer and all that is held.
        if point.inner * normal.dot(towards) < 0.0 {
            return point.color.gamma_multiply(GLASS);
        }
        // A little from above, so that a box's faces differ.
        let share = 0.5 + 0.4 * normal.dot(towards).abs() + 0.1 * point.normal.y.abs();
        let [red, green, blue, alpha] = point.color.to_array();
        let [red, green, blue] = [red, green, blue].map(|channel| (f32::from(channel) * share) as u8);
        Color32::from_rgba_premultiplied(red, green, blue, alpha)
    }

    fn triangle(&self, corners: [(Vec3, Color32); 3], mesh: &mut Mesh) {
        let places = corners.map(|(at, _)| self.place(at));
        if Rect::from_points(&places).intersects(self.rect) && places.iter().all(|place| place.is_finite()) {
            let first = mesh.vertices.len() as u32;
            places.iter().zip(corners).for_each(|(place, (_, color))| mesh.colored_vertex(*place, color));
            mesh.add_triangle(first, first + 1, first + 2);
        }
    }

    fn line(&self, line: &Line, mesh: &mut Mesh) {
        let [a, b] = line.ends.map(|end| self.at(end));
        let cut = |from: Vec3, to: Vec3| from.lerp(to, (self.near - from.z) / (to.z - from.z));
        let [a, b] = match [a.z <= self.near, b.z <= self.near] {
            [true, true] => [a, b],
            [true, false] => [a, cut(a, b)],
            [false, true] => [cut(b, a), b],
            [false, false] => return,
        };
        let ends = [self.place(a), self.place(b)];
        let is_seen = Rect::from_points(&ends).expand(line.width).intersects(self.rect);
        if is_seen && ends.iter().all(|end| end.is_finite()) {
            strip(ends, line.width, line.color, mesh);
        }
    }
}

/// As a whole number of the same order.
fn ordered(value: f32) -> u32 {
    let bits = value.to_bits();
    if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }
}

/// A line as four rows of corners: clear, full, full, clear.
fn strip([from, to]: [Pos2; 2], width: f32, color: Color32, mesh: &mut Mesh) {
    let along = (to - from).normalized();
    if along == Vec2::ZERO {
        return;
    }
    // Half a point longer each way, so that pieces of one line meet.
    let (from, to) = (from - along * 0.3, to + along * 0.3);
    let across = along.rot90();
    let half = (width / 2.0 - SOFT / 2.0).max(0.2);
    let first = mesh.vertices.len() as u32;
    for (offset, color) in
        [(-half - SOFT, Color32::TRANSPARENT), (-half, color), (half, color), (half + SOFT, Color32::TRANSPARENT)]
    {
        mesh.colored_vertex(from + across * offset, color);
        mesh.colored_vertex(to + across * offset, color);
    }
    for row in 0..3 {
        let corner = first + row * 2;
        mesh.add_triangle(corner, corner + 1, corner + 2);
        mesh.add_triangle(corner + 2, corner + 1, corner + 3);
    }
}

#[cfg(test)]
mod tests {
    use super::super::lens::{PaneView, Projection};
    use super::*;
    use glam::DVec3;

    const RECT: Rect = Rect { min: pos2(0.0, 0.0), max: pos2(400.0, 300.0) };

    fn lens() -> Lens {
        let projection = Projection::Perspective;
        let view =
            PaneView { center: DVec3::ZERO, height: 4.0, yaw: 0.0, pitch: 0.0, fov_y: 60.0, projection, oblique: 45.0 };
        view.lens(RECT)
    }

    type Triangle = ([Vec3; 3], Color32);

    fn triangle(z: f32, color: Color32) -> Triangle {
        ([Vec3::new(-1.0, -1.0, z), Vec3::new(1.0, -1.0, z), Vec3::new(0.0, 1.0, z)], color)
    }

    fn stage(triangles: &[Triangle]) -> Stage {
        let mut stage = Stage { radius: 2.0, ..Stage::default() };
        for (corners, color) in triangles {
            let first = stage.points.len() as u32;
            let point = |at: &Vec3| Point { at: *at, normal: Vec3::ZERO, color: *color, inner: 0.0 };
            stage.points.extend(corners.iter().map(point));
            let corners = [first, first + 1, first + 2];
            stage.faces.push(Face { corners, layer: Layer::Shell, sides: Sides::default() });
        }
        stage
    }

    fn colors(mesh: &Mesh) -> Vec<Color32> {
        mesh.indices.iter().step_by(3).map(|index| mesh.vertices[*index as usize].color).collect()
    }

    #[test]
    fn the_farthest_is_painted_first() {
        let stage = stage(&[triangle(1.0, Color32::RED), triangle(-1.0, Color32::BLUE), triangle(0.0, Color32::GREEN)]);
        assert_eq!(colors(&paint(&stage, &lens(), RECT)), [Color32::BLUE, Color32::GREEN, Color32::RED]);
    }

    #[test]
    fn a_wall_is_painted_before_what_is_not_behind_it_however_far_that_is() {
        let mut stage = stage(&[triangle(1.0, Color32::RED), triangle(-1.0, Color32::BLUE)]);
        stage.faces[0].layer = Layer::Wall;
        assert_eq!(colors(&paint(&stage, &lens(), RECT)), [Color32::RED, Color32::BLUE]);
    }

    #[test]
    fn a_corner_is_as_where_the_lens_puts_it() {
        for (projection, ..) in Projection::ALL {
            let center = DVec3::new(0.2, -0.1, 0.3);
            let view = PaneView { center, height: 4.0, yaw: 25.0, pitch: 12.0, fov_y: 50.0, projection, oblique: 40.0 };
            let stage = Stage { middle: DVec3::new(0.5, 0.25, -0.75), ..stage(&[triangle(0.5, Color32::RED)]) };
            let mesh = paint(&stage, &view.lens(RECT), RECT);
            for (point, vertex) in stage.points.iter().zip(&mesh.vertices) {
                let place = view.lens(RECT).place(stage.middle + point.at.as_dvec3()).expect("seen");
                assert!((place - vertex.pos).length() < 0.01, "{projection:?}: {place:?}, {:?}", vertex.pos);
            }
        }
    }

    #[test]
    fn what_is_behind_the_eye_or_outside_is_left_out_and_what_reaches_there_is_cut() {
        let behind = triangle(9.0, Color32::RED);
        let mut outside = triangle(0.0, Color32::RED);
        outside.0 = outside.0.map(|corner| corner + Vec3::X * 50.0);
        assert!(paint(&stage(&[behind, outside]), &lens(), RECT).indices.is_empty());
        let mut across = triangle(0.0, Color32::RED);
        across.0[2].z = 9.0;
        let mesh = paint(&stage(&[across]), &lens(), RECT);
        assert_eq!(mesh.indices.len(), 6, "a triangle without a corner has four");
        assert!(mesh.is_valid() && mesh.vertices.iter().all(|vertex| vertex.pos.is_finite()));
    }

    #[test]
    fn numbers_that_are_none_are_left_out() {
        let mut broken = triangle(0.0, Color32::RED);
        broken.0[1] = Vec3::NAN;
        assert!(paint(&stage(&[broken]), &lens(), RECT).indices.is_empty());
    }
}

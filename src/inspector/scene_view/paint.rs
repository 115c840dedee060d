//! Faces and lines of a stage on a view's screen, the farthest first (the painter's algorithm).
//!
//! What is cut by the near plane of a perspective view is cut into up to two triangles; what lies
//! outside the view's rectangle is left out. Lines are drawn as narrow faces with a soft border.

use super::lens::Lens;
use super::stage::{Face, Line, Stage};
use egui::{Color32, Mesh, Pos2, Rect, Vec2};
use glam::{Mat3, Vec3};
use std::sync::Arc;

/// How far lines and shells are drawn before what they lie on, in parts of the stage's radius.
const LINES_BEFORE: f32 = 0.04;
const SHELLS_BEFORE: f32 = 0.004;
/// What is left of the colour of a wall that one looks through.
const GLASS: f32 = 0.07;
/// Width of a line's soft border, points.
const SOFT: f32 = 0.6;

/// A face or a line with its distance.
#[derive(Clone, Copy)]
struct Entry {
    /// Greater is farther.
    distance: f32,
    /// Faces, then lines.
    index: u32,
}

/// The stage as triangles on the screen.
#[must_use]
pub fn paint(stage: &Stage, lens: &Lens, rect: Rect) -> Arc<Mesh> {
    let view = View::new(stage, lens, rect);
    let radius = stage.radius as f32;
    let mut entries = Vec::with_capacity(stage.faces.len() + stage.lines.len());
    for (index, face) in stage.faces.iter().enumerate() {
        let middle = view.at((face.corners[0] + face.corners[1] + face.corners[2]) / 3.0);
        let before = if face.normal == Vec3::ZERO { SHELLS_BEFORE * radius } else { 0.0 };
        entries.push(Entry { distance: -middle.z - before, index: index as u32 });
    }
    for (index, line) in stage.lines.iter().enumerate() {
        let middle = view.at((line.ends[0] + line.ends[1]) / 2.0);
        let index = (stage.faces.len() + index) as u32;
        entries.push(Entry { distance: -middle.z - LINES_BEFORE * radius, index });
    }
    entries.sort_unstable_by(|a, b| b.distance.total_cmp(&a.distance).then(a.index.cmp(&b.index)));
    let mut mesh = Mesh::default();
    mesh.reserve_triangles(entries.len());
    mesh.reserve_vertices(entries.len() * 3);
    for entry in &entries {
        match stage.faces.get(entry.index as usize) {
            Some(face) => view.face(face, &mut mesh),
            None => view.line(&stage.lines[entry.index as usize - stage.faces.len()], &mut mesh),
        }
    }
    Arc::new(mesh)
}

/// The lens in single precision, relative to the stage's middle.
struct View<'a> {
    lens: &'a Lens,
    rotation: Mat3,
    offset: Vec3,
    near: f32,
    rect: Rect,
}

impl View<'_> {
    fn new<'a>(stage: &Stage, lens: &'a Lens, rect: Rect) -> View<'a> {
        let offset = lens.view(stage.middle).as_vec3();
        View { lens, rotation: lens.rotation.as_mat3(), offset, near: lens.near() as f32, rect }
    }

    fn at(&self, corner: Vec3) -> Vec3 {
        self.rotation * corner + self.offset
    }

    fn place(&self, view: Vec3) -> Pos2 {
        self.lens.project(view.as_dvec3())
    }

    fn face(&self, face: &Face, mesh: &mut Mesh) {
        let corners = face.corners.map(|corner| self.at(corner));
        let color = self.shade(face, corners[0]);
        if corners.iter().all(|corner| corner.z <= self.near) {
            return self.triangle(corners.map(|corner| self.place(corner)), color, mesh);
        }
        let mut kept = [Vec3::ZERO; 4];
        let mut count = 0;
        for index in 0..3 {
            let (here, next) = (corners[index], corners[(index + 1) % 3]);
            if here.z <= self.near {
                kept[count] = here;
                count += 1;
            }
            if (here.z <= self.near) != (next.z <= self.near) {
                kept[count] = here.lerp(next, (self.near - here.z) / (next.z - here.z));
                count += 1;
            }
        }
        for last in 2..count {
            self.triangle([kept[0], kept[last - 1], kept[last]].map(|corner| self.place(corner)), color, mesh);
        }
    }

    /// Surfaces seen face on are lighter than those seen from the side, whichever way they are wound.
    fn shade(&self, face: &Face, at: Vec3) -> Color32 {
        if face.normal == Vec3::ZERO {
            return face.color;
        }
        let towards = match self.lens.eye {
            Some(eye) => (Vec3::Z * eye as f32 - at).normalize_or_zero(),
            None => Vec3::Z,
        };
        let normal = self.rotation * face.normal;
        // What lies between the viewer and all that is held.
        if face.inner * normal.dot(towards) < 0.0 {
            return face.color.gamma_multiply(GLASS);
        }
        // A little from above, so that a box's faces differ.
        let share = 0.5 + 0.4 * normal.dot(towards).abs() + 0.1 * normal.dot(self.rotation * Vec3::Y).abs();
        let [red, green, blue, alpha] = face.color.to_array();
        let [red, green, blue] = [red, green, blue].map(|channel| (f32::from(channel) * share) as u8);
        Color32::from_rgba_premultiplied(red, green, blue, alpha)
    }

    fn triangle(&self, corners: [Pos2; 3], color: Color32, mesh: &mut Mesh) {
        if Rect::from_points(&corners).intersects(self.rect) && corners.iter().all(|corner| corner.is_finite()) {
            let first = mesh.vertices.len() as u32;
            corners.into_iter().for_each(|corner| mesh.colored_vertex(corner, color));
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
    use egui::pos2;
    use glam::DVec3;

    const RECT: Rect = Rect { min: pos2(0.0, 0.0), max: pos2(400.0, 300.0) };

    fn lens() -> Lens {
        let projection = Projection::Perspective;
        let view =
            PaneView { center: DVec3::ZERO, height: 4.0, yaw: 0.0, pitch: 0.0, fov_y: 60.0, projection, oblique: 45.0 };
        view.lens(RECT)
    }

    fn face(z: f32, color: Color32) -> Face {
        Face {
            corners: [Vec3::new(-1.0, -1.0, z), Vec3::new(1.0, -1.0, z), Vec3::new(0.0, 1.0, z)],
            normal: Vec3::ZERO,
            color,
            inner: 0.0,
        }
    }

    fn stage(faces: Vec<Face>) -> Stage {
        Stage { radius: 2.0, faces, ..Stage::default() }
    }

    #[test]
    fn the_farthest_is_painted_first() {
        let mesh = paint(
            &stage(vec![face(1.0, Color32::RED), face(-1.0, Color32::BLUE), face(0.0, Color32::GREEN)]),
            &lens(),
            RECT,
        );
        let order: Vec<Color32> = mesh.vertices.iter().step_by(3).map(|vertex| vertex.color).collect();
        assert_eq!(order, [Color32::BLUE, Color32::GREEN, Color32::RED]);
    }

    #[test]
    fn what_is_behind_the_eye_or_outside_is_left_out_and_what_reaches_there_is_cut() {
        let behind = face(9.0, Color32::RED);
        let mut outside = face(0.0, Color32::RED);
        outside.corners = outside.corners.map(|corner| corner + Vec3::X * 50.0);
        assert!(paint(&stage(vec![behind, outside]), &lens(), RECT).is_empty());
        let mut across = face(0.0, Color32::RED);
        across.corners[2].z = 9.0;
        let mesh = paint(&stage(vec![across]), &lens(), RECT);
        assert_eq!(mesh.indices.len(), 6, "a triangle without a corner has four");
        assert!(mesh.vertices.iter().all(|vertex| vertex.pos.is_finite()));
    }

    #[test]
    fn numbers_that_are_none_are_left_out() {
        let mut broken = face(0.0, Color32::RED);
        broken.corners[1] = Vec3::NAN;
        assert!(paint(&stage(vec![broken]), &lens(), RECT).is_empty());
    }
}

//! What the views draw: faces and lines of an anatomy, finite and small enough to be sorted.
//!
//! Made once an anatomy and choice of what is shown, whatever the view. Corners are shared, so that each
//! is projected once a view. Walls are split off exactly (`walls.rs`), other large triangles are cut up: a
//! painter who goes by the distance of middles would paint a floor over what stands on it.

use super::coarse::{Coarsened, Detail, words_of_fewer};
use super::far_end::FarEnd;
use super::toggles::{Choice, Toggles};
use super::walls::{Sides, Walls};
use crate::anatomy::{Anatomy, Frustum, PlacedLight, PlacedObject, ShadowVolume, Silhouette, ViewOf};
use crate::inspector::look::theme::Theme;
use crate::plan::Part;
use egui::Color32;
use glam::{DVec3, DVec4, Vec3};
use std::borrow::Cow;
use std::collections::BTreeSet;

/// Faces that cutting up may add.
const MOST_CUTS: usize = 16_000;
/// An object holds others if it is so large, in parts of the whole.
const HOLDER: f64 = 0.5;
/// The longest piece of a shell, in parts of what there is to see: its order among its like is not seen.
const SHELL_PIECE: f64 = 0.7;
/// Triangles share a corner, and its shade, where their normals differ by less than this cosine's angle.
const SMOOTH: f32 = 0.8;
/// A corner that is not there yet.
const NONE: u32 = u32::MAX;
/// Frusta beyond so many are drawn fainter.
const QUIET: f32 = 4.0;
/// Multiplicities beyond one that are written beside their edges, at most.
const MOST_NUMBERS: usize = 400;

/// A corner of faces.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    /// Relative to the stage's middle.
    pub at: Vec3,
    /// Of unit length, for shading; zero: not shaded.
    pub normal: Vec3,
    /// Premultiplied.
    pub color: Color32,
    /// On which side of it, as its normal goes, the camera is, if it is of what holds everything: seen from the
    /// other side it is glass. 0 elsewhere.
    pub inner: f32,
}

/// How a face takes part in the order of painting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// Everything is either behind it or before it.
    Wall,
    /// By its distance.
    Solid,
    /// By its distance, before the solid that it lies on.
    Shell,
}

/// A triangle.
#[derive(Debug, Clone, Copy)]
pub struct Face {
    /// Indices of points.
    pub corners: [u32; 3],
    /// Its order.
    pub layer: Layer,
    /// On which sides of the walls it lies.
    pub sides: Sides,
}

/// A line.
#[derive(Debug, Clone, Copy)]
pub struct Line {
    /// Relative to the stage's middle.
    pub ends: [Vec3; 2],
    /// In points.
    pub width: f32,
    /// Its ink.
    pub color: Color32,
    /// On which sides of the walls it lies.
    pub sides: Sides,
}

/// Words at a place.
#[derive(Debug, Clone)]
pub struct Label {
    /// World space.
    pub at: DVec3,
    /// What is written.
    pub text: String,
    /// The line that it is about, world space: it has to be long enough on the screen.
    pub of: Option<[DVec3; 2]>,
}

/// What the views draw.
#[derive(Debug, Default)]
pub struct Stage {
    /// World space; corners are relative to it.
    pub middle: DVec3,
    /// Half of what there is to see, metres.
    pub radius: f64,
    /// Corners of the faces.
    pub points: Vec<Point>,
    /// In no order.
    pub faces: Vec<Face>,
    /// In no order.
    pub lines: Vec<Line>,
    /// Multiplicities and names.
    pub labels: Vec<Label>,
    /// What hides all that is behind it.
    pub walls: Walls,
    /// Casters that hold everything, whose volumes are not shown unless they are chosen.
    pub left_out: BTreeSet<String>,
    /// What is drawn with fewer triangles than it has, in words.
    pub coarser: Option<String>,
}

/// Which objects hold the others: rooms, walls, floors. They may be as large as they like, and must not
/// hide what they hold.
#[must_use]
pub fn holders(anatomy: &Anatomy) -> Vec<bool> {
    let ends = |points: &mut dyn Iterator<Item = DVec3>| {
        points.map(|point| (point, point)).reduce(|(low, high), (point, _)| (low.min(point), high.max(point)))
    };
    let size = |ends: Option<(DVec3, DVec3)>| ends.map_or(0.0, |(low, high)| (high - low).length());
    let whole = size(ends(&mut anatomy.objects.iter().flat_map(|object| object.positions.iter().copied())));
    let sizes = anatomy.objects.iter().map(|object| size(ends(&mut object.positions.iter().copied())));
    let large: Vec<bool> = sizes.map(|size| size >= HOLDER * whole).collect();
    // Where all are, none holds another.
    if large.contains(&false) { large } else { vec![false; large.len()] }
}

/// The middle and half of what there is to see: the camera, lamps that are not far away, and all objects
/// but those that hold the others.
#[must_use]
pub fn sphere(anatomy: &Anatomy, holders: &[bool]) -> (DVec3, f64) {
    let held = anatomy.objects.iter().zip(holders).filter(|(_, holds)| !**holds);
    let points = held.flat_map(|(object, _)| object.positions.iter().copied()).chain([anatomy.camera.eye]);
    let grow = |(low, high): (DVec3, DVec3), point: DVec3| (low.min(point), high.max(point));
    let (low, high) = points.fold((anatomy.camera.eye, anatomy.camera.eye), grow);
    let (middle, room) = ((low + high) / 2.0, (high - low).length());
    let lamps = anatomy.lights.iter().filter(|light| light.position.w != 0.0);
    let lamps = lamps.map(|light| light.position.truncate() / light.position.w);
    let (low, high) = lamps.filter(|lamp| (*lamp - middle).length() < 1.5 * room).fold((low, high), grow);
    // An eye alone sees as far as its target.
    let least = (anatomy.camera.target - anatomy.camera.eye).length().clamp(1e-3, 1e6) / 2.0;
    ((low + high) / 2.0, ((high - low).length() / 2.0).max(least))
}

impl Stage {
    /// Of `anatomy`, in the colours of `theme`.
    #[must_use]
    pub fn new(anatomy: &Anatomy, shown: &Toggles, choice: Choice, theme: &Theme, coarsened: &mut Coarsened) -> Stage {
        let holders = holders(anatomy);
        let (middle, radius) = sphere(anatomy, &holders);
        let walls = Walls::new(anatomy, &holders, middle, radius);
        let mut stage = Stage { middle, radius, walls, ..Stage::default() };
        let detail = Detail::new(anatomy, shown, choice, &holders);
        if shown.names {
            stage.names(anatomy, &holders);
        }
        if shown.objects {
            stage.objects(anatomy, &holders, (&detail, coarsened), theme);
        }
        let volumes = || anatomy.volumes.iter().filter(|volume| choice.has(volume.light, volume.caster, &holders));
        // Through many shells as much is seen as through a few.
        let strength = 1.0 / (volumes().count().max(1) as f32).sqrt().max(1.0);
        for volume in volumes() {
            if let (Some(light), Some(caster)) = (anatomy.lights.get(volume.light), anatomy.objects.get(volume.caster))
            {
                stage.volume((volume, caster, light), shown, (&detail, coarsened), strength, theme);
            }
        }
        if shown.silhouettes {
            for silhouette in anatomy.silhouettes.iter().filter(|one| choice.has(one.light, one.caster, &holders)) {
                if let Some(caster) = anatomy.objects.get(silhouette.caster) {
                    stage.silhouette(silhouette, caster, theme);
                }
            }
        }
        if shown.frusta {
            stage.frusta(anatomy, choice, theme);
        }
        if shown.near_clip {
            stage.near_clips(anatomy, choice, theme);
        }
        let left_out = anatomy.volumes.iter().map(|volume| volume.caster);
        stage.left_out = match choice.caster {
            None => {
                left_out.filter(|caster| holders[*caster]).map(|caster| anatomy.objects[caster].name.clone()).collect()
            }
            Some(_) => BTreeSet::new(),
        };
        coarsened.forget_unused();
        stage
    }

    fn objects(
        &mut self,
        anatomy: &Anatomy,
        holders: &[bool],
        (detail, coarsened): (&Detail, &mut Coarsened),
        theme: &Theme,
    ) {
        let is_seen = |object: &PlacedObject| object.visible || object.casts;
        let (walls, limit) = (self.walls.clone(), self.radius / 10.0);
        let longest = |index: usize, object: &PlacedObject| {
            if is_seen(object) && !walls.is_wall(index) { longest_edge(object) } else { 0.0 }
        };
        let longest = anatomy.objects.iter().enumerate().map(|(index, object)| longest(index, object));
        let limit = limit.max(longest.fold(0.0, f64::max) / 64.0);
        let mut room = MOST_CUTS;
        let ground = mix(theme.panel, theme.dim, 0.62);
        let edge = mix(theme.panel, theme.dim, 0.2);
        let mut fewer = Vec::new();
        for (index, object) in anatomy.objects.iter().enumerate().filter(|(_, object)| is_seen(object)) {
            // What is not seen in the picture is seen here as glass.
            let color = if object.visible { ground } else { ground.gamma_multiply(0.25) };
            let eye = holders[index].then_some(anatomy.camera.eye);
            let coarse = detail.of_object(object, coarsened);
            if let Some(coarse) = &coarse {
                fewer.push((&*object.name, coarse.triangles.len(), object.mesh.triangles().len()));
            }
            let triangles = coarse.as_ref().map_or(object.mesh.triangles(), |coarse| coarse.triangles.as_slice());
            match walls.is_wall(index) {
                true => self.solid(object, triangles, (color, eye), (f64::INFINITY, &mut room), Layer::Wall),
                false => self.solid(object, triangles, (color, eye), (limit, &mut room), Layer::Solid),
            }
            for edge_ends in &object.edges {
                let ends = [edge_ends.low, edge_ends.high].map(|end| object.positions[end as usize]);
                self.long_line(ends, limit, 1.0, edge);
            }
        }
        self.coarser = words_of_fewer(&fewer);
    }

    /// Triangles in place of an object's own, or these; of one that holds others, the camera's `eye` says which side is glass.
    fn solid(
        &mut self,
        object: &PlacedObject,
        triangles: &[[u32; 3]],
        (color, eye): (Color32, Option<DVec3>),
        (limit, room): (f64, &mut usize),
        layer: Layer,
    ) {
        let at = |corner: u32| object.positions[corner as usize];
        let across = |[a, b, c]: [u32; 3]| (at(b) - at(a)).cross(at(c) - at(a));
        let mut normals = vec![DVec3::ZERO; object.positions.len()];
        for &corners in object.mesh.triangles() {
            let across = across(corners);
            corners.iter().for_each(|corner| normals[*corner as usize] += across);
        }
        let normals: Vec<Vec3> = normals.into_iter().map(|normal| normal.normalize_or_zero().as_vec3()).collect();
        let mut shared = vec![NONE; object.positions.len()];
        for &corners in triangles {
            let places = corners.map(at);
            let normal = across(corners).normalize_or_zero().as_vec3();
            let inner = eye.map_or(0.0, |eye| normal.dot((eye - places[0]).as_vec3()).signum());
            if longest_of(&places) <= limit {
                let indices = [0, 1, 2].map(|index| {
                    let corner = corners[index] as usize;
                    let is_smooth = eye.is_none() && normals[corner].dot(normal) >= SMOOTH;
                    match shared[corner] {
                        known if is_smooth && known != NONE => known,
                        _ if is_smooth => {
                            shared[corner] = self.point(places[index], normals[corner], color, inner);
                            shared[corner]
                        }
                        _ => self.point(places[index], normal, color, inner),
                    }
                });
                self.face(indices, places, layer);
                continue;
            }
            cut_up(places, limit, room, &mut |places| {
                let indices = places.map(|place| self.point(place, normal, color, inner));
                self.face(indices, places, layer);
            });
        }
    }

    fn point(&mut self, place: DVec3, normal: Vec3, color: Color32, inner: f32) -> u32 {
        self.points.push(Point { at: (place - self.middle).as_vec3(), normal, color, inner });
        (self.points.len() - 1) as u32
    }

    fn face(&mut self, corners: [u32; 3], places: [DVec3; 3], layer: Layer) {
        let sides = match layer {
            Layer::Wall => Sides::default(),
            Layer::Solid | Layer::Shell => self.walls.sides((places[0] + places[1] + places[2]) / 3.0),
        };
        self.faces.push(Face { corners, layer, sides });
    }

    fn volume(
        &mut self,
        (volume, caster, light): (&ShadowVolume, &PlacedObject, &PlacedLight),
        shown: &Toggles,
        (detail, coarsened): (&Detail, &mut Coarsened),
        strength: f32,
        theme: &Theme,
    ) {
        let far = FarEnd::new(light, self.middle, self.radius);
        let limit = self.radius * SHELL_PIECE;
        for part in &volume.parts {
            let (is_shown, share) = match part.part {
                Part::Side => (shown.sides, 0.26 * strength),
                Part::LightCap => (shown.light_caps, 0.55),
                _ => (shown.dark_caps, 0.36 * strength),
            };
            let Some(color) = theme.part(part.part).filter(|_| is_shown) else { continue };
            let color = color.gamma_multiply(share);
            let mut room = MOST_CUTS;
            let triangles = match part.part {
                Part::Side => Cow::Borrowed(&part.triangles),
                _ => detail.of_cap(caster, volume, &part.triangles, coarsened),
            };
            let mut shared = vec![NONE; volume.vertices.len()];
            for &indices in triangles.iter() {
                let corners = indices.map(|corner| volume.vertices[corner as usize]);
                let finite = far.finite(corners);
                if let Some(places) = finite[0]
                    .filter(|places| far.is_whole(&corners) && longest_of(places) <= limit && !self.walls.cut(places))
                {
                    let points = [0, 1, 2].map(|index| {
                        let slot = &mut shared[indices[index] as usize];
                        if *slot == NONE {
                            *slot = self.point(places[index], Vec3::ZERO, color, 0.0);
                        }
                        *slot
                    });
                    self.face(points, places, Layer::Shell);
                    continue;
                }
                for places in finite.into_iter().flatten() {
                    for places in self.walls.split(places, &mut room) {
                        cut_up(places, limit, &mut room, &mut |places| self.shell(places, color));
                    }
                }
            }
        }
    }

    fn silhouette(&mut self, silhouette: &Silhouette, caster: &PlacedObject, theme: &Theme) {
        for edge in &silhouette.edges {
            let ends = [edge.edge.low, edge.edge.high].map(|end| caster.positions[end as usize]);
            let many = edge.multiplicity.unsigned_abs();
            self.long_line(ends, self.radius / 20.0, 1.2 + 0.5 * many.clamp(1, 4).saturating_sub(1) as f32, theme.text);
            if many > 1 && self.labels.len() < MOST_NUMBERS {
                let text = format!("{}{many}", if edge.multiplicity > 0 { "+" } else { "−" });
                self.labels.push(Label { at: (ends[0] + ends[1]) / 2.0, text, of: Some(ends) });
            }
        }
    }

    fn frusta(&mut self, anatomy: &Anatomy, choice: Choice, theme: &Theme) {
        let is_shown = |frustum: &&Frustum| match frustum.of {
            ViewOf::Camera => true,
            ViewOf::Map { light, caster, .. } => choice.has_frustum(light, caster),
        };
        let shown = || anatomy.frusta.iter().filter(is_shown);
        // Many are as loud as a few.
        let strength = (QUIET / shown().count().max(1) as f32).sqrt().clamp(0.25, 1.0);
        for frustum in shown() {
            let (color, fill) = match frustum.of {
                ViewOf::Camera => (theme.text.gamma_multiply(0.75), 0.25),
                // What a texture or a silhouette is seen through lies on a surface, or there are many.
                ViewOf::Map { caster, .. } if caster.is_some() || frustum.ends_at_light() => {
                    (theme.lit.gamma_multiply(0.75 * strength), 0.0)
                }
                ViewOf::Map { .. } => (theme.lit.gamma_multiply(0.75 * strength), 0.25),
            };
            let apart = |at: DVec4| at.truncate() / at.w;
            let near = frustum.near.map(apart);
            let reach = (self.middle - near[0]).length() + self.radius;
            let far = [0, 1, 2, 3].map(|corner| {
                let far = frustum.far[corner];
                if far.w == 0.0 { near[corner] + far.truncate().normalize() * reach } else { apart(far) }
            });
            let limit = self.radius / 10.0;
            for corner in 0..4 {
                let next = (corner + 1) % 4;
                self.long_line([near[corner], far[corner]], limit, 1.0, color);
                self.long_line([near[corner], near[next]], limit, 2.0, color);
                if frustum.far[corner].w != 0.0 && far[corner] != far[next] {
                    self.long_line([far[corner], far[next]], limit, 1.0, color);
                }
            }
            for corners in [[near[0], near[1], near[2]], [near[0], near[2], near[3]]] {
                if fill > 0.0 {
                    self.shell(corners, color.gamma_multiply(fill));
                }
            }
        }
    }

    fn near_clips(&mut self, anatomy: &Anatomy, choice: Choice, theme: &Theme) {
        let color = theme.decided;
        for (light, near_clip) in anatomy.near_clips.iter().enumerate() {
            let Some(near_clip) = near_clip.filter(|_| choice.light.is_none_or(|one| one == light)) else { continue };
            let corners = near_clip.rectangle;
            let reach = (self.middle - corners[0]).length() + self.radius;
            for index in 0..4 {
                let ends = [corners[index], corners[(index + 1) % 4]];
                let tips = ends.map(|end| match near_clip.apex.w == 0.0 {
                    true => end + near_clip.apex.truncate().normalize() * reach,
                    false => near_clip.apex.truncate() / near_clip.apex.w,
                });
                let mut room = MOST_CUTS;
                for corners in [[ends[0], ends[1], tips[0]], [ends[1], tips[1], tips[0]]] {
                    let fill = color.gamma_multiply(0.22);
                    cut_up(corners, self.radius / 2.0, &mut room, &mut |corners| self.shell(corners, fill));
                }
                self.long_line([ends[0], tips[0]], self.radius / 10.0, 1.0, color);
                self.long_line(ends, self.radius / 10.0, 1.0, color);
            }
        }
    }

    fn names(&mut self, anatomy: &Anatomy, holders: &[bool]) {
        for (object, _) in anatomy.objects.iter().zip(holders).filter(|(_, holds)| !**holds) {
            let count = object.positions.len().max(1) as f64;
            let at = object.positions.iter().sum::<DVec3>() / count;
            let text = match (object.casts, object.receives) {
                (true, true) => object.name.clone(),
                (true, false) => format!("{} (receives none)", object.name),
                (false, _) => format!("{} (casts none)", object.name),
            };
            self.labels.push(Label { at, text, of: None });
        }
    }

    fn shell(&mut self, places: [DVec3; 3], color: Color32) {
        let points = places.map(|place| self.point(place, Vec3::ZERO, color, 0.0));
        self.face(points, places, Layer::Shell);
    }

    /// A line in pieces, so that each is sorted by where it is.
    fn long_line(&mut self, ends: [DVec3; 2], limit: f64, width: f32, color: Color32) {
        let [from, to] = ends;
        let pieces = ((to - from).length() / limit).ceil().clamp(1.0, 32.0) as usize;
        let at = |piece: usize| from.lerp(to, piece as f64 / pieces as f64);
        for piece in 0..pieces {
            let ends = [at(piece), at(piece + 1)];
            let sides = self.walls.sides((ends[0] + ends[1]) / 2.0);
            self.lines.push(Line { ends: ends.map(|end| (end - self.middle).as_vec3()), width, color, sides });
        }
    }
}

/// The finite part of a triangle, ended where the volumes of its light are.
#[must_use]
pub fn finite_triangle(corners: [DVec4; 3], light: Option<&PlacedLight>, stage: &Stage) -> Vec<[DVec3; 3]> {
    match light {
        Some(light) => FarEnd::new(light, stage.middle, stage.radius).finite(corners).into_iter().flatten().collect(),
        None if corners.iter().all(|corner| corner.w != 0.0) => {
            vec![corners.map(|corner| corner.truncate() / corner.w)]
        }
        None => Vec::new(),
    }
}

/// Halves a triangle's longest edge until none is longer than `limit`, or no more may be added.
fn cut_up(corners: [DVec3; 3], limit: f64, room: &mut usize, found: &mut impl FnMut([DVec3; 3])) {
    let mut waiting = vec![corners];
    while let Some([a, b, c]) = waiting.pop() {
        let edges = [(b - a).length(), (c - b).length(), (a - c).length()];
        let longest =
            if edges[0] >= edges[1] && edges[0] >= edges[2] { 0 } else { 1 + usize::from(edges[2] > edges[1]) };
        // A corner that is no number must not be halved for ever.
        if *room == 0 || !(edges[longest] > limit && edges[longest].is_finite()) {
            found([a, b, c]);
            continue;
        }
        *room -= 1;
        let [a, b, c] = [[a, b, c], [b, c, a], [c, a, b]][longest];
        let middle = (a + b) / 2.0;
        waiting.push([a, middle, c]);
        waiting.push([middle, b, c]);
    }
}

fn longest_of([a, b, c]: &[DVec3; 3]) -> f64 {
    (*b - *a).length().max((*c - *b).length()).max((*a - *c).length())
}

fn longest_edge(object: &PlacedObject) -> f64 {
    let places = |corners: &[u32; 3]| corners.map(|corner| object.positions[corner as usize]);
    object.mesh.triangles().iter().map(|corners| longest_of(&places(corners))).fold(0.0, f64::max)
}

/// A colour between two, `share` of the way to the second.
#[must_use]
pub fn mix(from: Color32, to: Color32, share: f32) -> Color32 {
    from.lerp_to_gamma(to, share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cutting_up_keeps_the_area_and_stops_at_the_limit() {
        let corners = [DVec3::ZERO, DVec3::new(8.0, 0.0, 0.0), DVec3::new(0.0, 0.0, 3.0)];
        let (mut area, mut longest) = (0.0, 0.0_f64);
        let mut room = 10_000;
        cut_up(corners, 0.5, &mut room, &mut |[a, b, c]| {
            area += (b - a).cross(c - a).length() / 2.0;
            longest = longest.max((b - a).length());
        });
        assert!((area - 12.0).abs() < 1e-9 && longest <= 0.5, "{area} {longest}");
        let mut count = 0;
        cut_up(corners, 1e-9, &mut 100, &mut |_| count += 1);
        assert_eq!(count, 101);
        cut_up([DVec3::NAN; 3], 0.5, &mut 10, &mut |_| count += 1);
        assert_eq!(count, 102);
    }
}

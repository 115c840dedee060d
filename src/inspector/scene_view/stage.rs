//! What the views draw: faces and lines of an anatomy, finite and small enough to be sorted.
//!
//! Made once an anatomy and choice of what is shown, whatever the view. Corners at infinity are put on
//! a sphere about a point light, which every ray from it meets once, so that volumes stay closed; what
//! runs to a directional light's point at infinity is cut by a plane across the light. Large triangles
//! are cut up: a painter who goes by the distance of middles would paint a floor over what stands on it.

use crate::anatomy::{Anatomy, PlacedLight, PlacedObject, ShadowVolume, Silhouette, ViewOf};
use crate::inspector::theme::Theme;
use crate::plan::Part;
use egui::Color32;
use glam::{DVec3, DVec4, Vec3};
use std::collections::BTreeSet;

/// Faces that are drawn at most; beyond it large meshes are thinned out.
pub const MOST_FACES: usize = 60_000;
/// Meshes of fewer triangles are never thinned out.
const LEAST_TO_THIN: usize = 2_000;
/// Faces that cutting up may add.
const MOST_CUTS: usize = 16_000;
/// An object holds others if it is so large, in parts of the whole.
const HOLDER: f64 = 0.5;
/// How far volumes go beyond what there is to see, in parts of its radius.
const BEYOND: f64 = 1.2;
/// Multiplicities beyond one that are written beside their edges, at most.
const MOST_NUMBERS: usize = 400;

/// What is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Toggles {
    /// Objects.
    pub objects: bool,
    /// Sides of volumes.
    pub sides: bool,
    /// Their caps near the light.
    pub light_caps: bool,
    /// Their caps away from it.
    pub dark_caps: bool,
    /// Silhouettes with multiplicities.
    pub silhouettes: bool,
    /// Frusta of camera and maps.
    pub frusta: bool,
    /// The near-clip volume.
    pub near_clip: bool,
    /// The pick's view ray and shadow rays.
    pub rays: bool,
    /// Names of objects, lights and camera.
    pub names: bool,
}

impl Default for Toggles {
    fn default() -> Toggles {
        Toggles {
            objects: true,
            sides: true,
            light_caps: true,
            dark_caps: true,
            silhouettes: true,
            frusta: true,
            near_clip: false,
            rays: true,
            names: false,
        }
    }
}

/// Of which light and caster volumes and silhouettes are shown; `None`: of all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Choice {
    /// Index of the light.
    pub light: Option<usize>,
    /// Index of the object.
    pub caster: Option<usize>,
}

impl Choice {
    /// Are the volume and silhouette of a light and caster shown? Those of what holds everything are only
    /// where they are asked for by name.
    fn has(self, light: usize, caster: usize, holders: &[bool]) -> bool {
        let holds = holders.get(caster).is_some_and(|holds| *holds);
        self.light.is_none_or(|one| one == light) && self.caster.map_or(!holds, |one| one == caster)
    }
}

/// A triangle, or what is left of one that was cut by a plane.
#[derive(Debug, Clone, Copy)]
pub struct Face {
    /// Relative to the stage's middle.
    pub corners: [Vec3; 3],
    /// Of unit length, for shading; zero: not shaded.
    pub normal: Vec3,
    /// Premultiplied.
    pub color: Color32,
    /// On which side of it, as its normal goes, the camera is, if it is of what holds everything: seen from the
    /// other side it is glass. 0 elsewhere.
    pub inner: f32,
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
    /// In no order.
    pub faces: Vec<Face>,
    /// In no order.
    pub lines: Vec<Line>,
    /// Multiplicities and names.
    pub labels: Vec<Label>,
    /// Casters that hold everything, whose volumes are not shown unless they are chosen.
    pub left_out: BTreeSet<String>,
    /// What was thinned out, in words.
    pub thinned: Option<String>,
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
    pub fn new(anatomy: &Anatomy, shown: &Toggles, choice: Choice, theme: &Theme) -> Stage {
        let holders = holders(anatomy);
        let (middle, radius) = sphere(anatomy, &holders);
        let mut stage = Stage { middle, radius, ..Stage::default() };
        let thinning = Thinning::new(anatomy, shown, choice, &holders);
        if shown.names {
            stage.names(anatomy, &holders);
        }
        if shown.objects {
            stage.objects(anatomy, &holders, &thinning, theme);
        }
        let volumes = || anatomy.volumes.iter().filter(|volume| choice.has(volume.light, volume.caster, &holders));
        // Through many shells as much is seen as through a few.
        let strength = 1.0 / (volumes().count().max(1) as f32).sqrt().max(1.0);
        for volume in volumes() {
            if let Some(light) = anatomy.lights.get(volume.light) {
                stage.volume(volume, light, shown, (&thinning, strength), theme);
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
        stage.thinned = thinning.words(anatomy);
        stage
    }

    fn objects(&mut self, anatomy: &Anatomy, holders: &[bool], thinning: &Thinning, theme: &Theme) {
        let visible = || anatomy.objects.iter().zip(holders).filter(|(object, _)| object.visible || object.casts);
        let longest = visible().map(|(object, _)| longest_edge(object)).fold(0.0, f64::max);
        let limit = (self.radius / 10.0).max(longest / 64.0);
        let mut room = MOST_CUTS;
        let ground = mix(theme.panel, theme.dim, 0.62);
        for (object, holds) in visible() {
            // What is not seen in the picture is seen here as glass.
            let color = if object.visible { ground } else { ground.gamma_multiply(0.25) };
            for corners in thinning.kept(object.mesh.triangles()) {
                let corners = corners.map(|corner| object.positions[corner as usize]);
                let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero().as_vec3();
                let inner = match holds {
                    true => normal.dot((anatomy.camera.eye - corners[0]).as_vec3()).signum(),
                    false => 0.0,
                };
                cut_up(corners, limit, &mut room, &mut |corners| {
                    let corners = corners.map(|corner| (corner - self.middle).as_vec3());
                    self.faces.push(Face { corners, normal, color, inner });
                });
            }
            let edge = mix(theme.panel, theme.dim, 0.2);
            for edge_ends in &object.edges {
                let ends = [edge_ends.low, edge_ends.high].map(|end| object.positions[end as usize]);
                self.long_line(ends, limit, 1.0, edge);
            }
        }
    }

    fn volume(
        &mut self,
        volume: &ShadowVolume,
        light: &PlacedLight,
        shown: &Toggles,
        (thinning, strength): (&Thinning, f32),
        theme: &Theme,
    ) {
        let far = FarEnd::new(light, self.middle, self.radius);
        let limit = self.radius / 3.0;
        for part in &volume.parts {
            let (is_shown, share) = match part.part {
                Part::Side => (shown.sides, 0.26 * strength),
                Part::LightCap => (shown.light_caps, 0.55),
                _ => (shown.dark_caps, 0.36 * strength),
            };
            let Some(color) = theme.part(part.part).filter(|_| is_shown) else { continue };
            let color = color.gamma_multiply(share);
            let mut room = MOST_CUTS;
            let triangles: Box<dyn Iterator<Item = [u32; 3]>> = match part.part {
                Part::Side => Box::new(part.triangles.iter().copied()),
                _ => Box::new(thinning.kept(&part.triangles)),
            };
            for corners in triangles {
                let corners = corners.map(|corner| volume.vertices[corner as usize]);
                for corners in far.finite(corners).into_iter().flatten() {
                    cut_up(corners, limit, &mut room, &mut |corners| self.shell(corners, color));
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
        for frustum in &anatomy.frusta {
            let color = match frustum.of {
                ViewOf::Camera => theme.text,
                ViewOf::Map { light, .. } if choice.light.is_none_or(|one| one == light) => theme.lit,
                ViewOf::Map { .. } => continue,
            };
            let color = color.gamma_multiply(0.75);
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
                if frustum.far[corner].w != 0.0 {
                    self.long_line([far[corner], far[next]], limit, 1.0, color);
                }
            }
            for corners in [[near[0], near[1], near[2]], [near[0], near[2], near[3]]] {
                self.shell(corners, color.gamma_multiply(0.25));
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

    fn shell(&mut self, corners: [DVec3; 3], color: Color32) {
        let corners = corners.map(|corner| (corner - self.middle).as_vec3());
        self.faces.push(Face { corners, normal: Vec3::ZERO, color, inner: 0.0 });
    }

    /// A line in pieces, so that each is sorted by where it is.
    fn long_line(&mut self, ends: [DVec3; 2], limit: f64, width: f32, color: Color32) {
        let [from, to] = ends.map(|end| end - self.middle);
        let pieces = ((to - from).length() / limit).ceil().clamp(1.0, 32.0) as usize;
        let at = |piece: usize| from.lerp(to, piece as f64 / pieces as f64).as_vec3();
        self.lines.extend((0..pieces).map(|piece| Line { ends: [at(piece), at(piece + 1)], width, color }));
    }
}

/// Where volumes that have no end are ended.
enum FarEnd {
    /// On a sphere about a point light.
    Sphere { light: DVec3, reach: f64 },
    /// At a plane across a directional light: inside is where it is positive.
    Plane(DVec4),
}

impl FarEnd {
    fn new(light: &PlacedLight, middle: DVec3, radius: f64) -> FarEnd {
        let towards = light.position.truncate();
        if light.position.w == 0.0 {
            let towards = towards.normalize();
            return FarEnd::Plane(towards.extend(BEYOND * radius - towards.dot(middle)));
        }
        let light = towards / light.position.w;
        FarEnd::Sphere { light, reach: (light - middle).length() + BEYOND * radius }
    }

    /// The finite part of a triangle: none, or up to two.
    fn finite(&self, corners: [DVec4; 3]) -> [Option<[DVec3; 3]>; 2] {
        match self {
            FarEnd::Sphere { light, reach } => {
                let at = |corner: DVec4| match corner.w == 0.0 {
                    true => *light + corner.truncate().normalize_or_zero() * *reach,
                    false => corner.truncate() / corner.w,
                };
                [Some(corners.map(at)), None]
            }
            FarEnd::Plane(_) if corners.iter().all(|corner| corner.w != 0.0) => {
                [Some(corners.map(|corner| corner.truncate() / corner.w)), None]
            }
            FarEnd::Plane(plane) => {
                let polygon = clip(corners, *plane);
                let at = |index: usize| polygon.get(index).map(|corner| corner.truncate() / corner.w);
                let triangle = |a, b, c| Some([at(a)?, at(b)?, at(c)?]);
                [triangle(0, 1, 2), triangle(0, 2, 3)]
            }
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

/// The part of a triangle where a plane is positive: up to four corners (Sutherland and Hodgman 1974).
fn clip(corners: [DVec4; 3], plane: DVec4) -> Vec<DVec4> {
    let mut kept = Vec::with_capacity(4);
    for (index, &corner) in corners.iter().enumerate() {
        let next = corners[(index + 1) % 3];
        let [here, there] = [plane.dot(corner), plane.dot(next)];
        if here >= 0.0 {
            kept.push(corner);
        }
        if (here < 0.0) != (there < 0.0) {
            kept.push(corner.lerp(next, here / (here - there)));
        }
    }
    // A point that is left at infinity all the same has no place.
    kept.retain(|corner| corner.w > 0.0);
    kept
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

fn longest_edge(object: &PlacedObject) -> f64 {
    let edge = |[a, b, c]: &[u32; 3]| {
        let [a, b, c] = [a, b, c].map(|corner| object.positions[*corner as usize]);
        (b - a).length().max((c - b).length()).max((a - c).length())
    };
    object.mesh.triangles().iter().map(edge).fold(0.0, f64::max)
}

/// A colour between two, `share` of the way to the second.
#[must_use]
pub fn mix(from: Color32, to: Color32, share: f32) -> Color32 {
    from.lerp_to_gamma(to, share)
}

/// How large meshes are thinned out: of their triangles only each so manieth is drawn.
struct Thinning {
    every: usize,
}

impl Thinning {
    fn new(anatomy: &Anatomy, shown: &Toggles, choice: Choice, holders: &[bool]) -> Thinning {
        let objects = anatomy.objects.iter().filter(|_| shown.objects).map(|object| object.mesh.triangles().len());
        let volumes = anatomy.volumes.iter().filter(|volume| choice.has(volume.light, volume.caster, holders));
        let parts = volumes.flat_map(|volume| &volume.parts).filter(|part| match part.part {
            Part::LightCap => shown.light_caps,
            Part::DarkCap => shown.dark_caps,
            _ => false,
        });
        let counts = objects.chain(parts.map(|part| part.triangles.len()));
        let large: usize = counts.filter(|count| *count >= LEAST_TO_THIN).sum();
        Thinning { every: large.div_ceil(MOST_FACES).max(1) }
    }

    fn kept<'a>(&self, triangles: &'a [[u32; 3]]) -> impl Iterator<Item = [u32; 3]> + use<'a> {
        let every = if triangles.len() >= LEAST_TO_THIN { self.every } else { 1 };
        triangles.iter().step_by(every).copied()
    }

    fn words(&self, anatomy: &Anatomy) -> Option<String> {
        let is_large = |object: &&PlacedObject| object.mesh.triangles().len() >= LEAST_TO_THIN;
        let names: Vec<&str> = anatomy.objects.iter().filter(is_large).map(|object| &*object.name).collect();
        let (shown, more) = names.split_at(names.len().min(3));
        let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
        let words = format!("Thinned out: one of {} triangles of {}{more} is drawn.", self.every, shown.join(", "));
        (self.every > 1).then_some(words)
    }
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

    #[test]
    fn a_side_that_runs_to_a_suns_point_at_infinity_ends_at_a_plane() {
        let light = PlacedLight { position: DVec4::new(0.0, 2.0, 0.0, 0.0), color: [1.0; 3], range: None };
        let far = FarEnd::new(&light, DVec3::ZERO, 5.0);
        let corners =
            [DVec4::new(1.0, 2.0, 0.0, 1.0), DVec4::new(-1.0, 2.0, 0.0, 1.0), DVec4::new(0.0, -2.0, 0.0, 0.0)];
        let pieces: Vec<_> = far.finite(corners).into_iter().flatten().collect();
        assert_eq!(pieces.len(), 2, "a triangle without its tip has four corners");
        let lowest = pieces.iter().flatten().map(|corner| corner.y).fold(f64::INFINITY, f64::min);
        assert!((lowest + BEYOND * 5.0).abs() < 1e-9, "{lowest}");
        assert!(pieces.iter().flatten().all(|corner| corner.x.abs() <= 1.0 + 1e-9), "the sides are parallel");
    }

    #[test]
    fn corners_at_infinity_lie_on_the_rays_of_a_lamp() {
        let light = PlacedLight { position: DVec4::new(0.0, 4.0, 0.0, 1.0), color: [1.0; 3], range: None };
        let far = FarEnd::new(&light, DVec3::ZERO, 5.0);
        let near = DVec3::new(1.0, 1.0, 2.0);
        let away = (near - DVec3::new(0.0, 4.0, 0.0)).extend(0.0);
        let [Some([a, _, c]), None] = far.finite([near.extend(1.0), DVec4::W, away]) else { panic!("one triangle") };
        assert_eq!(a, near);
        assert!((c - a).normalize().dot(away.truncate().normalize()) > 1.0 - 1e-12);
        assert!(((c - DVec3::new(0.0, 4.0, 0.0)).length() - 4.0 - BEYOND * 5.0).abs() < 1e-9);
    }
}

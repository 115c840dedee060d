//! The geometry of the views: faces, lines and labels of an anatomy, computed once for an anatomy and a choice of what
//! is shown.
//!
//! Everything is relative to the stage's middle, so that single precision is enough. Where a lamp's volumes go to
//! infinity they end on a sphere about the lamp, which every ray from it hits once, so that volumes stay closed; a
//! directional light's volumes go to the GPU with their points at infinity, and fade with distance.

use super::toggles::{SceneToggles, VolumeFilter};
use crate::anatomy::{Anatomy, Frustum, PlacedLight, PlacedObject, ShadowVolume, Silhouette, ViewOf};
use crate::inspector::look::coloring;
use crate::inspector::look::theme::Theme;
use crate::plan::DrawPart;
use crate::reading::format;
use crate::viewport::{ViewportGeometry, ViewportLine, ViewportVertex};
use egui::Color32;
use glam::{DVec3, DVec4, Vec3};
use std::collections::BTreeSet;
use std::sync::Arc;

/// An object encloses others if it is at least so large, as a share of the whole.
const ENCLOSES: f64 = 0.5;
/// Triangles share a corner, and its shade, where the angle between their normals has a larger cosine than this.
const SMOOTH: f32 = 0.8;
/// How far volumes go beyond the visible scene, as a multiple of its radius.
const BEYOND: f64 = 1.5;
/// How much a view is widened at most, as a factor, to show lamps and camera; of those farther away only arrows at the
/// border are seen.
const NEAR_BY: f64 = 6.0;
/// The grey that is mixed into materials, in both themes.
const GREY: Color32 = Color32::from_rgb(0x8b, 0x92, 0xa1);
/// Stands for a corner that has not been added.
const NONE: u32 = u32::MAX;
/// With more frusta than this each is drawn fainter; the next number is the same for edges of meshes.
const QUIET: f32 = 4.0;
const QUIET_EDGES: f32 = 500.0;
/// Length of a normal, as a share of the visible scene's radius, and how many of an object are drawn.
const NORMAL: f64 = 0.05;
const MOST_NORMALS: usize = 400;
/// How many multiplicities other than one are written beside their edges.
const MOST_NUMBERS: usize = 400;
/// The most vertices that the GPU is given, of all objects and volumes together: a window's buffers have no space for
/// more.
const MOST_VERTICES: usize = 7_000_000;
/// The most triangles that the GPU is given: 240 MB of corners.
const MOST_TRIANGLES: usize = 20_000_000;

/// A text at a point of the scene, or on a line of it.
#[derive(Debug, Clone)]
pub struct StageLabel {
    /// Position in world space, metres.
    pub at: DVec3,
    /// The text.
    pub text: String,
    /// The line that it labels, world space: the label is drawn only where the line is long enough on the screen.
    pub of: Option<[DVec3; 2]>,
}

/// The geometry and labels that all views of the scene show.
#[derive(Debug, Default)]
pub struct SceneStage {
    /// World space; geometry is relative to it.
    pub middle: DVec3,
    /// Radius of the visible scene, metres.
    pub radius: f64,
    /// Largest distance of anything from the middle, metres.
    pub reach: f64,
    /// Faces and lines.
    pub geometry: Arc<ViewportGeometry>,
    /// Multiplicities and names.
    pub labels: Vec<StageLabel>,
    /// Casters that enclose everything, whose volumes are shown only when they are chosen.
    pub left_out: BTreeSet<String>,
    /// There is more geometry than the GPU is given, or some of its positions are not finite.
    pub is_cut: bool,
}

/// Returns for each object whether it encloses the others, as rooms, walls and floors do: its box is nearly as large as
/// that of all objects. All false where all are so large.
pub fn holders(anatomy: &Anatomy) -> Vec<bool> {
    let size =
        |points: &mut dyn Iterator<Item = DVec3>| bounds(points).map_or(0.0, |(low, high)| (high - low).length());
    let whole = size(&mut anatomy.objects.iter().flat_map(|object| object.positions.iter().copied()));
    let sizes = anatomy.objects.iter().map(|object| size(&mut object.positions.iter().copied()));
    let large: Vec<bool> = sizes.map(|size| size >= ENCLOSES * whole).collect();
    // Where all are large, none encloses another.
    if large.contains(&false) { large } else { vec![false; large.len()] }
}

/// Returns middle (world space) and radius, in metres, of the visible objects that do not enclose others, by their box;
/// where there is none, or all are one point, around the camera's target with half its distance from the eye.
pub fn sphere(anatomy: &Anatomy, holders: &[bool]) -> (DVec3, f64) {
    let casters = anatomy.objects.iter().zip(holders).filter(|(object, holds)| !**holds && is_seen(object));
    let camera = &anatomy.camera;
    match bounds(&mut casters.flat_map(|(object, _)| object.positions.iter().copied())) {
        Some((low, high)) if low != high => ((low + high) / 2.0, (high - low).length() / 2.0),
        // Without objects, the scene reaches as far from the eye as its target.
        _ => (camera.target, (camera.target - camera.eye).length().clamp(1e-3, 1e6) / 2.0),
    }
}

/// Returns middle and radius of what a view shows at first: the visible scene, and lamps and camera where they are
/// near.
pub fn framed(anatomy: &Anatomy, holders: &[bool]) -> (DVec3, f64) {
    let (middle, radius) = sphere(anatomy, holders);
    let lamps = anatomy.lights.iter().filter(|light| light.position.w != 0.0);
    let lamps = lamps.map(|light| light.position.truncate() / light.position.w);
    lamps.chain([anatomy.camera.eye]).fold((middle, radius), |(center, reach), place| {
        let away = place - center;
        // The smallest sphere about both.
        let grown = (away.length() + reach) / 2.0;
        if grown <= reach || grown > NEAR_BY * radius {
            return (center, reach);
        }
        (center + away.normalize_or_zero() * (grown - reach), grown)
    })
}

fn bounds(points: &mut dyn Iterator<Item = DVec3>) -> Option<(DVec3, DVec3)> {
    points.map(|point| (point, point)).reduce(|(low, high), (point, _)| (low.min(point), high.max(point)))
}

fn is_seen(object: &PlacedObject) -> bool {
    object.visible || object.casts
}

impl SceneStage {
    /// Returns the stage of `anatomy`, in the colours of `theme`: only the parts that are `shown`, and of volumes and
    /// silhouettes those of `choice`.
    pub fn new(anatomy: &Anatomy, shown: &SceneToggles, choice: VolumeFilter, theme: &Theme) -> SceneStage {
        let holders = holders(anatomy);
        let (middle, radius) = sphere(anatomy, &holders);
        let stage = SceneStage { middle, radius, ..SceneStage::default() };
        let geometry = ViewportGeometry { origin: middle, ..ViewportGeometry::default() };
        let mut build = StageBuilder { stage, geometry, theme };
        if shown.names {
            build.names(anatomy, &holders);
        }
        if shown.objects {
            for (object, holds) in anatomy.objects.iter().zip(&holders).filter(|(object, _)| is_seen(object)) {
                build.object(object, holds.then_some(anatomy.camera.eye));
            }
        }
        if shown.wireframe {
            anatomy.objects.iter().filter(|object| is_seen(object)).for_each(|object| build.wireframe(object));
        }
        if shown.normals {
            anatomy.objects.iter().filter(|object| object.visible).for_each(|object| build.normals(object, anatomy));
        }
        let volumes = || anatomy.volumes.iter().filter(|volume| choice.has(volume.light, volume.caster, &holders));
        // With many shells each is more transparent, so that as much is seen through all as through a few.
        let strength = 1.0 / (volumes().count().max(1) as f32).sqrt();
        for volume in volumes() {
            if let Some(light) = anatomy.lights.get(volume.light) {
                build.volume(volume, light, shown, strength);
            }
        }
        if shown.silhouettes {
            for silhouette in anatomy.silhouettes.iter().filter(|one| choice.has(one.light, one.caster, &holders)) {
                if let Some(caster) = anatomy.objects.get(silhouette.caster) {
                    build.silhouette(silhouette, caster);
                }
            }
        }
        if shown.frusta {
            build.frusta(anatomy, choice);
            build.outside_maps(anatomy, choice);
        }
        if shown.near_clip {
            build.near_clips(anatomy, choice);
        }
        let StageBuilder { mut stage, geometry, .. } = build;
        if choice.caster.is_none() {
            let casters_left_out = anatomy.volumes.iter().map(|volume| volume.caster).filter(|caster| holders[*caster]);
            stage.left_out = casters_left_out.map(|caster| anatomy.objects[caster].name.clone()).collect();
        }
        stage.geometry = Arc::new(geometry);
        stage
    }

    /// Returns a corner of `light`'s volumes relative to the middle; at infinity, with `w = 0`, where the light is
    /// directional.
    fn ended(&self, corner: DVec4, light: &PlacedLight) -> DVec4 {
        let place = match (corner.w == 0.0, light.position.w == 0.0) {
            (false, _) => corner.truncate() / corner.w,
            (true, true) => return (corner.truncate().normalize_or_zero() * self.radius).extend(0.0),
            (true, false) => {
                let lamp = light.position.truncate() / light.position.w;
                let reach = (lamp - self.middle).length() + BEYOND * self.radius;
                lamp + corner.truncate().normalize_or_zero() * reach
            }
        };
        (place - self.middle).extend(1.0)
    }

    /// Returns the drawn part of one triangle, as corners of a polygon in world space. Corners at infinity are ended at
    /// a distance, for a directional light once for each finite neighbour; with `None`, the triangle belongs to no
    /// light's volumes and only corners at infinity are ended.
    pub fn polygon(&self, corners: [DVec4; 3], light: Option<&PlacedLight>) -> Vec<DVec3> {
        let ended = light.map_or(corners.map(|corner| corner - (self.middle * corner.w).extend(0.0)), |light| {
            corners.map(|corner| self.ended(corner, light))
        });
        let mut polygon = Vec::new();
        for (index, corner) in ended.iter().enumerate() {
            if corner.w != 0.0 {
                polygon.push(self.middle + corner.truncate() / corner.w);
                continue;
            }
            // A directional light's sides are parallel: the corner at infinity becomes an end for each of its neighbours.
            for neighbour in [ended[(index + 2) % 3], ended[(index + 1) % 3]].iter().filter(|other| other.w != 0.0) {
                polygon.push(self.middle + neighbour.truncate() / neighbour.w + corner.truncate() * BEYOND);
            }
        }
        polygon
    }
}

/// Builds a stage.
struct StageBuilder<'a> {
    stage: SceneStage,
    geometry: ViewportGeometry,
    theme: &'a Theme,
}

impl StageBuilder<'_> {
    /// Adds an object's triangles, smooth where the angle between them is small, and edges. With `inside`, the eye, for
    /// an object that encloses others, each triangle is flat and faces `inside`.
    fn object(&mut self, object: &PlacedObject, inside: Option<DVec3>) {
        let triangles = object.mesh.triangles();
        let at = |corner: u32| object.positions[corner as usize];
        let across = |[a, b, c]: [u32; 3]| (at(b) - at(a)).cross(at(c) - at(a));
        let mut normals = vec![DVec3::ZERO; object.positions.len()];
        for &corners in triangles {
            corners.iter().for_each(|corner| normals[*corner as usize] += across(corners));
        }
        let normals: Vec<Vec3> = normals.into_iter().map(|normal| normal.normalize_or_zero().as_vec3()).collect();
        let color = self.material(object);
        let mut shared = vec![NONE; object.positions.len()];
        let mut found = Vec::with_capacity(triangles.len());
        for &[a, b, c] in triangles {
            let mut corners = [a, b, c];
            if inside.is_some_and(|eye| across(corners).dot(eye - at(a)) < 0.0) {
                corners = [a, c, b];
            }
            let normal = across(corners).normalize_or_zero().as_vec3();
            found.push(corners.map(|corner| {
                let (index, smooth) = (corner as usize, normals[corner as usize]);
                if inside.is_some() || smooth.dot(normal) < SMOOTH {
                    return self.vertex(at(corner), normal, color);
                }
                if shared[index] == NONE {
                    shared[index] = self.vertex(at(corner), smooth, color);
                }
                shared[index]
            }));
        }
        self.stage.is_cut |= found.iter().flatten().any(|corner| *corner == NONE);
        found.retain(|corners| !corners.contains(&NONE));
        let left = self.triangles_left();
        self.stage.is_cut |= found.len() > left;
        found.truncate(left);
        match (inside, object.visible) {
            (_, false) => self.geometry.shells.extend(found),
            (Some(_), true) => self.geometry.holders.extend(found),
            (None, true) => self.geometry.solids.extend(found),
        }
        // The creases of a fine mesh are noise.
        let strength = (QUIET_EDGES / triangles.len().max(1) as f32).sqrt().min(1.0);
        let ink = Color32::BLACK.gamma_multiply(0.55 * strength);
        for edge in &object.edges {
            self.line([edge.low, edge.high].map(at), 1.0, ink);
        }
    }

    /// Adds a line for each normal that an object is shaded by; of a fine mesh every n-th, as all of them would hide it.
    fn normals(&mut self, object: &PlacedObject, anatomy: &Anatomy) {
        let length = NORMAL * self.stage.radius;
        let all: Vec<_> = object.surfaces.iter().flat_map(|surface| surface.normals(anatomy.camera.eye)).collect();
        for (at, normal) in all.iter().step_by(all.len().div_ceil(MOST_NORMALS).max(1)) {
            self.line([*at, *at + *normal * length], 1.0, self.theme.selected);
        }
    }

    /// Adds each edge of the triangles of an object once, fainter the more there are; notes where they are too many to
    /// be drawn.
    fn wireframe(&mut self, object: &PlacedObject) {
        let triangles = object.mesh.triangles();
        let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let mut edges: Vec<[u32; 2]> = sides.map(|[from, to]| [from.min(to), from.max(to)]).collect();
        edges.sort_unstable();
        edges.dedup();
        // A fine mesh has so many that they would look like one surface.
        let strength = (QUIET_EDGES / edges.len().max(1) as f32).sqrt().clamp(0.35, 1.0);
        let ink = self.theme.text.gamma_multiply(0.8 * strength);
        self.stage.is_cut |= self.geometry.lines.len() + edges.len() > MOST_VERTICES;
        for edge in edges {
            self.line(edge.map(|corner| object.positions[corner as usize]), 1.0, ink);
        }
    }

    /// Returns an object's colour, transparent where the object is invisible in the picture.
    fn material(&self, object: &PlacedObject) -> Color32 {
        let [red, green, blue] = object.color.map(|channel| (channel * 255.0).round() as u8);
        let color = coloring::linear([red, green, blue, 255]);
        // Less saturated than the parts of volumes, and never as dark as the background.
        let color = mix(GREY, color, 0.6);
        if object.visible { color } else { color.gamma_multiply(0.25) }
    }

    /// Returns how many more triangles the GPU is given, of all kinds together.
    fn triangles_left(&self) -> usize {
        let ViewportGeometry { solids, holders, shells, .. } = &self.geometry;
        MOST_TRIANGLES.saturating_sub(solids.len() + holders.len() + shells.len())
    }

    /// Adds a corner; returns [`NONE`] where the limit is reached.
    fn vertex(&mut self, place: DVec3, normal: Vec3, color: Color32) -> u32 {
        self.corner((place - self.stage.middle).extend(1.0), normal, color)
    }

    fn corner(&mut self, at: DVec4, normal: Vec3, color: Color32) -> u32 {
        let index = self.geometry.vertices.len();
        if index >= MOST_VERTICES || !at.is_finite() {
            return NONE;
        }
        self.stage.reach = self.stage.reach.max(at.truncate().length());
        self.geometry.vertices.push(ViewportVertex::new(at, normal, color));
        index as u32
    }

    fn volume(&mut self, volume: &ShadowVolume, light: &PlacedLight, shown: &SceneToggles, strength: f32) {
        for part in &volume.parts {
            let (is_shown, share) = match part.part {
                DrawPart::Side => (shown.sides, 0.26 * strength),
                // It lies on its caster, whose colour is to be seen through it.
                DrawPart::LightCap => (shown.light_caps, 0.42 * strength.max(0.6)),
                _ => (shown.dark_caps, 0.36 * strength),
            };
            let Some(color) = self.theme.part(part.part).filter(|_| is_shown) else { continue };
            let color = color.gamma_multiply(share);
            let mut shared = vec![NONE; volume.vertices.len()];
            for corners in &part.triangles {
                let corners = corners.map(|corner| {
                    let slot = &mut shared[corner as usize];
                    if *slot == NONE {
                        let at = self.stage.ended(volume.vertices[corner as usize], light);
                        *slot = self.corner(at, Vec3::ZERO, color);
                    }
                    *slot
                });
                match corners.contains(&NONE) || self.triangles_left() == 0 {
                    true => self.stage.is_cut = true,
                    false => self.geometry.shells.push(corners),
                }
            }
        }
    }

    fn silhouette(&mut self, silhouette: &Silhouette, caster: &PlacedObject) {
        // A fine mesh has so many short edges that they would hide it.
        let strength = (QUIET_EDGES / silhouette.edges.len().max(1) as f32).sqrt().clamp(0.35, 1.0);
        for edge in &silhouette.edges {
            let ends = [edge.edge.low, edge.edge.high].map(|end| caster.positions[end as usize]);
            let many = edge.multiplicity.unsigned_abs();
            let width = 1.2 + 0.5 * many.clamp(1, 4).saturating_sub(1) as f32;
            self.line(ends, width * strength.max(0.7), self.theme.text.gamma_multiply(strength));
            if many > 1 && self.stage.labels.len() < MOST_NUMBERS {
                let text = format!("{}{many}", if edge.multiplicity > 0 { "+" } else { "−" });
                self.stage.labels.push(StageLabel { at: (ends[0] + ends[1]) / 2.0, text, of: Some(ends) });
            }
        }
    }

    fn frusta(&mut self, anatomy: &Anatomy, choice: VolumeFilter) {
        let is_shown = |frustum: &&Frustum| match frustum.of {
            ViewOf::Camera => true,
            ViewOf::Map { light, caster, .. } => choice.has_frustum(light, caster),
        };
        let shown = || anatomy.frusta.iter().filter(is_shown);
        // So that many are as conspicuous as a few.
        let strength = (QUIET / shown().count().max(1) as f32).clamp(0.25, 1.0);
        for frustum in shown() {
            let (color, fill) = match frustum.of {
                ViewOf::Camera => (self.theme.text.gamma_multiply(0.75), 0.25),
                // The frustum of a texture or a silhouette lies on a surface, or there are many of them.
                ViewOf::Map { caster, .. } if caster.is_some() || frustum.ends_at_light() => {
                    (self.theme.lit.gamma_multiply(0.75 * strength), 0.0)
                }
                ViewOf::Map { .. } => (self.theme.lit.gamma_multiply(0.75 * strength), 0.25),
            };
            let near = frustum.near.map(|corner| corner.truncate() / corner.w);
            let far = [0, 1, 2, 3].map(|corner| self.end(near[corner], frustum.far[corner]));
            for corner in 0..4 {
                let next = (corner + 1) % 4;
                self.line([near[corner], far[corner]], 1.0, color);
                self.line([near[corner], near[next]], 2.0, color);
                if frustum.far[corner].w != 0.0 && far[corner] != far[next] {
                    self.line([far[corner], far[next]], 1.0, color);
                }
            }
            if fill > 0.0 {
                self.shell([near[0], near[1], near[2]], color.gamma_multiply(fill));
                self.shell([near[0], near[2], near[3]], color.gamma_multiply(fill));
            }
        }
    }

    /// Names each caster that no map of a light sees: it throws no shadow of that light.
    fn outside_maps(&mut self, anatomy: &Anatomy, choice: VolumeFilter) {
        let of_light = |light: usize| {
            let is_of = move |frustum: &&Frustum| {
                matches!(frustum.of, ViewOf::Map { light: of, caster: None, .. } if of == light)
                    && !frustum.ends_at_light()
            };
            anatomy.frusta.iter().filter(is_of)
        };
        for light in (0..anatomy.lights.len()).filter(|light| choice.has_frustum(*light, None)) {
            if of_light(light).next().is_none() {
                continue;
            }
            for object in anatomy.objects.iter().filter(|object| object.casts) {
                if !of_light(light).all(|frustum| frustum.holds_none_of(&object.positions)) {
                    continue;
                }
                let at = object.positions.iter().sum::<DVec3>() / object.positions.len().max(1) as f64;
                let text = format!("{}: outside the map of {}", object.name, format::light(light));
                self.stage.labels.push(StageLabel { at, text, of: None });
            }
        }
    }

    fn near_clips(&mut self, anatomy: &Anatomy, choice: VolumeFilter) {
        let color = self.theme.decided;
        for (light, near_clip) in anatomy.near_clips.iter().enumerate() {
            let Some(near_clip) = near_clip.filter(|_| choice.light.is_none_or(|one| one == light)) else { continue };
            for index in 0..4 {
                let ends = [near_clip.rectangle[index], near_clip.rectangle[(index + 1) % 4]];
                let tips = ends.map(|end| self.end(end, near_clip.apex));
                self.shell([ends[0], ends[1], tips[0]], color.gamma_multiply(0.22));
                self.shell([ends[1], tips[1], tips[0]], color.gamma_multiply(0.22));
                self.line([ends[0], tips[0]], 1.0, color);
                self.line(ends, 1.0, color);
            }
        }
    }

    /// Returns the end of a line from a point; for a line to infinity, a point beyond the visible scene.
    fn end(&self, start: DVec3, end: DVec4) -> DVec3 {
        let reach = (self.stage.middle - start).length() + self.stage.radius;
        if end.w == 0.0 { start + end.truncate().normalize_or_zero() * reach } else { end.truncate() / end.w }
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
            self.stage.labels.push(StageLabel { at, text, of: None });
        }
    }

    fn shell(&mut self, places: [DVec3; 3], color: Color32) {
        let corners = places.map(|place| self.vertex(place, Vec3::ZERO, color));
        let has_space = self.triangles_left() > 0;
        self.stage.is_cut |= !has_space;
        self.geometry.shells.extend(Some(corners).filter(|corners| has_space && !corners.contains(&NONE)));
    }

    fn line(&mut self, ends: [DVec3; 2], width: f32, color: Color32) {
        let [from, to] = ends.map(|end| (end - self.stage.middle).as_vec3());
        if from.is_finite() && to.is_finite() && self.geometry.lines.len() < MOST_VERTICES {
            self.stage.reach =
                ends.iter().fold(self.stage.reach, |reach, end| reach.max((*end - self.stage.middle).length()));
            self.geometry.lines.push(ViewportLine { from, width, to, color });
        }
    }
}

/// Returns a colour between two, `share` of the way to the second.
pub fn mix(from: Color32, to: Color32, share: f32) -> Color32 {
    from.lerp_to_gamma(to, share)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stage() -> SceneStage {
        SceneStage { middle: DVec3::new(1.0, 0.0, 0.0), radius: 5.0, ..SceneStage::default() }
    }

    #[test]
    fn a_wireframe_has_each_edge_of_each_triangle_once() {
        let mesh = Arc::new(crate::scene::shapes::cuboid([1.0, 2.0, 3.0]).expect("a box"));
        let cuboid = PlacedObject {
            name: "box".to_owned(),
            casts: true,
            receives: true,
            visible: true,
            color: [0.5; 3],
            positions: mesh.positions().to_vec(),
            mesh,
            edges: Vec::new(),
            surfaces: Vec::new(),
        };
        let anatomy = Anatomy {
            technique: "none".to_owned(),
            camera: crate::scene::Camera::looking([0.0, 0.0, 9.0], [0.0; 3]),
            aspect: 1.0,
            is_view_assumed: false,
            objects: vec![cuboid],
            lights: Vec::new(),
            volumes: Vec::new(),
            silhouettes: Vec::new(),
            frusta: Vec::new(),
            near_clips: Vec::new(),
        };
        let lines = |objects: bool, wireframe: bool| {
            let shown =
                SceneToggles { objects, wireframe, silhouettes: false, frusta: false, ..SceneToggles::default() };
            SceneStage::new(&anatomy, &shown, VolumeFilter::default(), &crate::inspector::look::theme::DARK)
                .geometry
                .lines
                .len()
        };
        // Twelve edges of the box, and a diagonal on each of six sides.
        assert_eq!([lines(true, false), lines(false, true), lines(true, true)], [0, 18, 18]);
    }

    fn light(position: DVec4) -> PlacedLight {
        PlacedLight { position, color: [1.0; 3], range: None }
    }

    #[test]
    fn a_side_that_runs_to_a_suns_point_at_infinity_is_a_strip_with_sides_side_by_side() {
        let sun = light(DVec4::new(0.0, 2.0, 0.0, 0.0));
        let down = DVec4::new(0.0, -2.0, 0.0, 0.0);
        let (a, b) = (DVec3::new(1.0, 2.0, 0.0), DVec3::new(-1.0, 2.0, 0.0));
        assert_eq!(stage().ended(down, &sun), DVec4::new(0.0, -5.0, 0.0, 0.0), "the GPU has it at infinity");
        let strip = stage().polygon([a.extend(1.0), b.extend(1.0), down], Some(&sun));
        let far = DVec3::NEG_Y * 5.0 * BEYOND;
        assert_eq!(strip, [a, b, b + far, a + far]);
        assert!(stage().polygon([down; 3], Some(&sun)).is_empty());
    }

    #[test]
    fn corners_at_infinity_lie_on_the_rays_of_a_lamp() {
        let lamp = DVec3::new(1.0, 4.0, 0.0);
        let near = DVec3::new(2.0, 1.0, 2.0);
        let end = stage().ended((near - lamp).extend(0.0), &light(lamp.extend(1.0)));
        let along = end.truncate() + stage().middle - lamp;
        assert!(end.w == 1.0 && along.normalize().dot((near - lamp).normalize()) > 1.0 - 1e-12, "{end}");
        assert!((along.length() - 4.0 - BEYOND * 5.0).abs() < 1e-9);
    }
}

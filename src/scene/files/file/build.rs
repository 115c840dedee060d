//! From the tables of a scene file to a scene, every value checked.

use super::problem::SceneFileProblem;
use super::shape;
use super::tables::{
    CameraTable, LightTable, MaterialTable, MeshSource, ObjectTable, OrbitTable, SceneTable, SpannedNumber,
    SpannedText, SpannedTriple, SwingTable, TechniqueTable,
};
use crate::math::angle;
use crate::scene::camera::placement::SceneBounds;
use crate::scene::files::model::{self, ModelReader};
use crate::scene::files::read_text::{quoted, stem};
use crate::scene::names::ObjectNames;
use crate::scene::suggestion;
use crate::scene::{
    Camera, Light, Material, MaterialTexture, Mesh, MeshGroup, Motion, Object, Orbit, Pose, Projection, Scene, Shading,
    Spherical, Swing, TechniqueRequest,
};
use glam::DVec3;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use toml::Spanned;

const DEFAULT_AMBIENT: [f32; 3] = [0.15; 3];
const DEFAULT_FOV_Y_DEGREES: f64 = 45.0;
/// Error messages for the two values that only an oblique projection has: its angle and its factor.
const OF_OBLIQUE: [&str; 2] = [
    "`oblique_angle_degrees` is of `projection = \"oblique\"` alone: give that, or leave it out",
    "`oblique_factor` is of `projection = \"oblique\"` alone: give that, or leave it out",
];
/// The near plane's distance unless given, in distances from eye to target.
const DEFAULT_NEAR: f64 = 0.01;

/// Builds a scene from its tables. Its name is `name` unless the table gives one; models are read from `folder`. A
/// camera or lights that the table lacks are placed to fit the objects; a table without objects is an error.
pub fn scene(table: SceneTable, name: &str, folder: &Path) -> Result<Scene, SceneFileProblem> {
    let mut builder = ObjectBuilder {
        folder,
        models: ModelReader::default(),
        known: BTreeMap::new(),
        objects: Vec::new(),
        names: ObjectNames::default(),
    };
    for object in &table.objects {
        builder.add(object)?;
    }
    let objects = builder.objects;
    if objects.is_empty() {
        return Err(SceneFileProblem::new(0..0, "has no objects: add a table [[objects]] with a mesh"));
    }
    let lights = table.lights.iter().map(light).collect::<Result<Vec<_>, _>>()?;
    let points: Vec<DVec3> = objects.iter().flat_map(Object::world_positions).collect();
    let surroundings = || {
        SceneBounds::of(&points)
            .ok_or_else(|| SceneFileProblem::new(0..0, "is too large to be looked at: scale objects down"))
    };
    Ok(Scene {
        name: table.name.unwrap_or_else(|| name.to_owned()),
        ambient: table.ambient.as_ref().map_or(Ok(DEFAULT_AMBIENT), |rgb| color(rgb, f64::MAX))?,
        camera: match &table.camera {
            Some(table) => camera(table)?,
            None => surroundings()?.camera(&points),
        },
        lights: if lights.is_empty() { vec![surroundings()?.light()] } else { lights },
        objects,
        technique: table.technique.as_ref().map(technique).transpose()?,
        not_taken: Vec::new(),
    })
}

fn camera(table: &Spanned<CameraTable>) -> Result<Camera, SceneFileProblem> {
    let place = table;
    let table = place.get_ref();
    let target = finite(&table.target)?;
    let (eye, spherical) = match (&table.eye, &table.eye_spherical) {
        (Some(eye), None) => (finite(eye)?, None),
        (None, Some(at)) => {
            let [r, theta_degrees, phi_degrees] = finite(at)?.to_array();
            let about = Spherical { r, theta_degrees, phi_degrees };
            let problem = |reason| SceneFileProblem::new(at.span(), format!("{reason}: correct it"));
            about.check().map_err(problem)?;
            (about.eye_about(target), Some(about))
        }
        (Some(_), Some(at)) => {
            return Err(SceneFileProblem::new(at.span(), "`eye` and `eye_spherical` are one place: leave one out"));
        }
        (None, None) => {
            let reason = "the key `eye` is missing: add it, or `eye_spherical`";
            return Err(SceneFileProblem::new(place.span(), reason));
        }
    };
    let number = |value: &Option<SpannedNumber>, default: f64| value.as_ref().map_or(Ok(default), finite_number);
    let fov_y_degrees = number(&table.fov_y_degrees, DEFAULT_FOV_Y_DEGREES)?;
    let mut camera = Camera {
        eye,
        target,
        up: table.up.as_ref().map_or(Ok(DVec3::Y), finite)?,
        // Unless given, the height at the target is that of a perspective camera.
        projection: projection(table, eye.distance(target) * angle::tan(fov_y_degrees.to_radians() / 2.0))?,
        fov_y_degrees,
        near: number(&table.near, eye.distance(target) * DEFAULT_NEAR)?,
        far: table.far.as_ref().map(finite_number).transpose()?,
        viewport: table.viewport.as_ref().map(|viewport| *viewport.get_ref()),
    };
    if let (None, Some(about)) = (&table.up, spherical) {
        camera.stand_up(about);
    }
    camera.check().map_err(|reason| {
        let fixes = if reason.contains(": ") { "" } else { ": correct it" };
        SceneFileProblem { at: culprit(table, &camera), reason: format!("{reason}{fixes}") }
    })?;
    Ok(camera)
}

/// Returns the table's projection (perspective by default), with `half_height` where the table gives none. A number
/// that this projection does not use, or an unknown name, is an error.
fn projection(table: &CameraTable, half_height: f64) -> Result<Projection, SceneFileProblem> {
    let number = |value: &Option<SpannedNumber>, default: f64| value.as_ref().map_or(Ok(default), finite_number);
    let kind = table.projection.as_ref().map_or("perspective", |kind| kind.get_ref());
    let is_parallel = kind == "orthographic" || kind == "oblique";
    if let (Some(edges), false) = (&table.frustum, kind == "frustum") {
        let reason = "`frustum` is of `projection = \"frustum\"` alone: give that, or leave it out";
        return Err(SceneFileProblem::new(edges.span(), reason));
    }
    let unused = [
        (&table.half_height, is_parallel, "`half_height` is of parallel projections: give `projection` too"),
        (&table.oblique_angle_degrees, kind == "oblique", OF_OBLIQUE[0]),
        (&table.oblique_factor, kind == "oblique", OF_OBLIQUE[1]),
    ];
    if let Some(kind) = table.projection.as_ref().filter(|kind| !Projection::NAMES.contains(&kind.get_ref().as_str())) {
        return Err(unknown(kind, "projection", &Projection::NAMES));
    }
    if let Some((Some(value), _, reason)) = unused.into_iter().find(|(value, is_used, _)| value.is_some() && !is_used) {
        return Err(SceneFileProblem::new(value.span(), reason));
    }
    let half_height = number(&table.half_height, half_height)?;
    Ok(match kind {
        "perspective" => Projection::Perspective,
        "frustum" => {
            let at = table.projection.as_ref().map_or(0..0, Spanned::span);
            let missing =
                "a frustum needs its edges: add `frustum = [left, right, bottom, top]`, metres on the near plane";
            let edges = table.frustum.as_ref().ok_or_else(|| SceneFileProblem::new(at, missing))?;
            let [left, right, bottom, top] = *edges.get_ref();
            Projection::Frustum { left, right, bottom, top }
        }
        "orthographic" => Projection::Orthographic { half_height },
        _ => Projection::Oblique {
            half_height,
            angle_degrees: number(&table.oblique_angle_degrees, Projection::USUAL_ANGLE)?,
            factor: number(&table.oblique_factor, Projection::CABINET)?,
        },
    })
}

/// Returns the position, as a byte of the text, of the value that makes the camera unusable; of the eye where no other
/// is found.
fn culprit(table: &CameraTable, camera: &Camera) -> usize {
    let place = |value: &Option<SpannedNumber>| value.as_ref().map(|value| value.span().start);
    let eye = table.eye.as_ref().or(table.eye_spherical.as_ref()).map_or(0, |eye| eye.span().start);
    let with_defaults = Camera {
        projection: Projection::Perspective,
        fov_y_degrees: DEFAULT_FOV_Y_DEGREES,
        near: 1.0,
        far: None,
        viewport: None,
        ..*camera
    };
    let of_projection = || {
        let half_height = place(&table.half_height).filter(|_| !(1e-30..=1e30).contains(&camera.half_height()));
        let projection = table.projection.as_ref().map(|kind| kind.span().start);
        half_height
            .or_else(|| table.frustum.as_ref().map(|edges| edges.span().start))
            .or_else(|| place(&table.oblique_factor).filter(|_| is_wrong_factor(camera.projection)))
            .or_else(|| place(&table.oblique_angle_degrees))
            .or(projection)
    };
    let found = if camera.eye == camera.target {
        None
    } else if with_defaults.check().is_err() {
        table.up.as_ref().map(|up| up.span().start)
    } else if (Camera { fov_y_degrees: camera.fov_y_degrees, ..with_defaults }).check().is_err() {
        place(&table.fov_y_degrees)
    } else if (Camera { projection: Projection::Perspective, far: None, viewport: None, ..*camera }).check().is_err() {
        place(&table.near)
    } else if (Camera { projection: Projection::Perspective, viewport: None, ..*camera }).check().is_err() {
        place(&table.far)
    } else if (Camera { projection: Projection::Perspective, ..*camera }).check().is_err() {
        table.viewport.as_ref().map(|viewport| viewport.span().start)
    } else {
        of_projection()
    };
    found.unwrap_or(eye)
}

/// Returns whether a projection is oblique with a depth factor outside 0 to 100.
fn is_wrong_factor(projection: Projection) -> bool {
    matches!(projection, Projection::Oblique { factor, .. } if !(0.0..=100.0).contains(&factor))
}

fn light(table: &LightTable) -> Result<Light, SceneFileProblem> {
    let at_kind = |reason: &str| SceneFileProblem::new(table.kind.span(), reason);
    let kind = table.kind.get_ref().as_str();
    let (place, of_light): (&SpannedTriple, fn(DVec3) -> Light) = match (kind, &table.position, &table.towards) {
        ("point", Some(position), None) => (position, Light::point),
        ("directional", None, Some(towards)) => (towards, Light::directional),
        ("point", ..) => return Err(at_kind("a point light needs `position` and no `towards`: correct it")),
        ("directional", ..) => {
            return Err(at_kind("a directional light needs `towards` and no `position`: correct it"));
        }
        _ => return Err(unknown(&table.kind, "kind of light", &["point", "directional"])),
    };
    let default = of_light(finite(place)?);
    let light = Light {
        color: table.color.as_ref().map_or(Ok(default.color), |rgb| color(rgb, f64::MAX))?,
        intensity: table.intensity.as_ref().map_or(Ok(1.0), |value| within(value, 0.0, f64::from(f32::MAX)))?,
        is_on: table.on.unwrap_or(true),
        range: table.range.as_ref().map(positive).transpose()?,
        motion: motion(DVec3::ZERO, table.orbit.as_ref(), table.swing.as_ref())?,
        ..default
    };
    light.check().map_err(|reason| SceneFileProblem::new(place.span(), format!("{reason}: correct it")))?;
    Ok(light)
}

fn motion(
    spin_degrees_per_second: DVec3,
    orbit: Option<&OrbitTable>,
    swing: Option<&SwingTable>,
) -> Result<Motion, SceneFileProblem> {
    Ok(Motion {
        spin_degrees_per_second,
        orbit: orbit.map(self::orbit).transpose()?,
        swing: swing.map(self::swing).transpose()?,
    })
}

fn orbit(table: &OrbitTable) -> Result<Orbit, SceneFileProblem> {
    let axis = axis(&table.axis, "an orbit")?;
    let degrees_per_second = finite_number(&table.degrees_per_second)?;
    Ok(Orbit { center: finite(&table.center)?, axis, degrees_per_second })
}

fn swing(table: &SwingTable) -> Result<Swing, SceneFileProblem> {
    Ok(Swing {
        pivot: finite(&table.pivot)?,
        axis: axis(&table.axis, "a swing")?,
        degrees: finite_number(&table.degrees)?,
        period_seconds: period(&table.period_seconds)?,
    })
}

/// At least a millisecond: times counted in far shorter periods have no phase.
fn period(value: &SpannedNumber) -> Result<f64, SceneFileProblem> {
    let seconds = finite_number(value)?;
    if seconds >= 0.001 {
        return Ok(seconds);
    }
    Err(SceneFileProblem::new(value.span(), "a period is at least 0.001 seconds: correct it"))
}

fn axis(value: &SpannedTriple, of: &str) -> Result<DVec3, SceneFileProblem> {
    let axis = finite(value)?;
    match axis.try_normalize() {
        Some(_) => Ok(axis),
        None => Err(SceneFileProblem::new(value.span(), format!("the axis of {of} has no direction: correct it"))),
    }
}

fn technique(table: &TechniqueTable) -> Result<TechniqueRequest, SceneFileProblem> {
    let setting = |(key, value): (&String, &Spanned<toml::Value>)| {
        let text = match value.get_ref() {
            toml::Value::String(text) => text.clone(),
            toml::Value::Integer(number) => number.to_string(),
            toml::Value::Float(number) => number.to_string(),
            toml::Value::Boolean(is_on) => if *is_on { "on" } else { "off" }.to_owned(),
            _ => return Err(SceneFileProblem::new(value.span(), "a setting is a text or a number: correct it")),
        };
        Ok((key.clone(), text))
    };
    let settings = table.settings.iter().map(setting).collect::<Result<_, _>>()?;
    Ok(TechniqueRequest { name: table.name.clone(), settings })
}

/// Builds objects; models are loaded once.
struct ObjectBuilder<'a> {
    folder: &'a Path,
    models: ModelReader,
    /// Models that were loaded, by the name that the file gives them.
    known: BTreeMap<String, Arc<Mesh>>,
    objects: Vec<Object>,
    names: ObjectNames,
}

impl ObjectBuilder<'_> {
    fn add(&mut self, table: &ObjectTable) -> Result<(), SceneFileProblem> {
        let mesh = self.mesh(&table.mesh)?;
        let material = material(table.material.as_ref(), &mesh)?;
        let texture = table.material.as_ref().map_or(Ok(None), |table| self.texture(table, &mesh))?;
        let triple = |value: &Option<SpannedTriple>, default: DVec3| value.as_ref().map_or(Ok(default), finite);
        let object = Object {
            pose: Pose {
                translate: triple(&table.translate, DVec3::ZERO)?,
                rotate_degrees: triple(&table.rotate_degrees, DVec3::ZERO)?,
                scale: scale(table.scale.as_ref())?,
            },
            motion: motion(
                triple(&table.spin_degrees_per_second, DVec3::ZERO)?,
                table.orbit.as_ref(),
                table.swing.as_ref(),
            )?,
            casts: table.casts.unwrap_or(true),
            receives: table.receives.unwrap_or(true),
            visible: table.visible.unwrap_or(true),
            texture,
            ..Object::new(self.name(table)?, mesh, material)
        };
        if !object.world_positions().iter().all(|position| position.is_finite()) {
            let reason = "the object's corners are not finite where it is placed: scale it down or move it nearer";
            return Err(SceneFileProblem::new(table.mesh.span(), reason));
        }
        self.objects.push(object);
        Ok(())
    }

    fn mesh(&mut self, source: &Spanned<MeshSource>) -> Result<Arc<Mesh>, SceneFileProblem> {
        let name = match source.get_ref() {
            MeshSource::Shape(table) => return shape::mesh(table).map(Arc::new),
            MeshSource::File(name) => name,
        };
        if let Some(model) = self.known.get(name) {
            return Ok(Arc::clone(model));
        }
        let (file, pointer) = model::split(name);
        let model = self.models.mesh(&self.folder.join(file), pointer);
        let model = Arc::new(model.map_err(|error| SceneFileProblem::new(source.span(), error.to_string()))?);
        self.known.insert(name.clone(), Arc::clone(&model));
        Ok(model)
    }

    /// Returns the texture for those parts of a mesh that have no material of their own; `None` where the table names
    /// none. An error where its other keys are given alone, no part takes it, texture coordinates are missing without
    /// `texture_side`, or the picture can't be read.
    fn texture(&mut self, table: &MaterialTable, mesh: &Mesh) -> Result<Option<MaterialTexture>, SceneFileProblem> {
        let Some(file) = &table.texture else {
            let side = table.texture_side.as_ref().map(|side| ("texture_side", side.span()));
            let clamps = table.texture_clamps.as_ref().map(|clamps| ("texture_clamps", clamps.span()));
            return side.or(clamps).map_or(Ok(None), |(key, span)| {
                Err(SceneFileProblem::new(span, format!("`{key}` is of a `texture`: give that too, or leave it out")))
            });
        };
        let problem = |reason: String| SceneFileProblem::new(file.span(), reason);
        let own: Vec<&MeshGroup> = mesh.groups().iter().filter(|group| group.material.is_none()).collect();
        if own.is_empty() {
            let reason = "every part of the model has a material of its own: name the picture in its library (map_Kd)";
            return Err(problem(reason.to_owned()));
        }
        let side = table.texture_side.as_ref().map(|side| within(side, 1e-3, 1e6)).transpose()?;
        if side.is_none() && !own.iter().all(|group| mesh.has_uvs(&group.triangles)) {
            let reason = "the mesh does not say where it lies in a picture: give a model with texture coordinates (vt), or \
                          `texture_side`, the metres of X and Z that the picture covers";
            return Err(problem(reason.to_owned()));
        }
        let path = self.folder.join(file.get_ref());
        let picture =
            self.models.pictures.load(&path).map_err(|error| problem(format!("{} {error}", quoted(file.get_ref()))))?;
        Ok(Some(MaterialTexture {
            picture,
            side,
            clamps: table.texture_clamps.as_ref().is_some_and(|clamps| *clamps.get_ref()),
        }))
    }

    /// Returns the object's given name, or an error where another object has it; without one, the shape's or the
    /// model's, with a number where that is taken.
    fn name(&mut self, table: &ObjectTable) -> Result<String, SceneFileProblem> {
        if let Some(name) = &table.name {
            if !self.names.take(name.get_ref()) {
                let reason = format!(
                    "another object is called `{}` already: choose another name",
                    name.get_ref().escape_debug()
                );
                return Err(SceneFileProblem::new(name.span(), reason));
            }
            return Ok(name.get_ref().clone());
        }
        Ok(self.names.take_like(&match table.mesh.get_ref() {
            MeshSource::Shape(shape) => shape.shape.get_ref().clone(),
            MeshSource::File(path) => stem(Path::new(model::split(path).0)),
        }))
    }
}

fn material(table: Option<&MaterialTable>, mesh: &Mesh) -> Result<Material, SceneFileProblem> {
    let shading = if mesh.corner_normals().is_some() { Shading::Phong } else { Shading::Flat };
    let default = Material { shading, ..Material::default() };
    let Some(table) = table else { return Ok(default) };
    let fraction =
        |value: &Option<SpannedNumber>, default: f32| value.as_ref().map_or(Ok(default), |v| within(v, 0.0, 1.0));
    Ok(Material {
        color: table.color.as_ref().map_or(Ok(default.color), |rgb| color(rgb, 1.0))?,
        specular: fraction(&table.specular, default.specular)?,
        shininess: table.shininess.as_ref().map_or(Ok(default.shininess), |value| within(value, 0.001, 10_000.0))?,
        shading: table.shading.as_ref().map_or(Ok(shading), shading_named)?,
        opacity: fraction(&table.opacity, default.opacity)?,
        emission: table.emission.as_ref().map_or(Ok(default.emission), |rgb| color(rgb, 1000.0))?,
        checks: table.checks.as_ref().map_or(Ok(default.checks), |value| within(value, 0.0, 1e6))?,
    })
}

fn shading_named(name: &SpannedText) -> Result<Shading, SceneFileProblem> {
    let found = Shading::ALL.into_iter().find(|shading| shading.name() == name.get_ref());
    found.ok_or_else(|| unknown(name, "shading", &Shading::ALL.map(Shading::name)))
}

fn scale(value: Option<&SpannedTriple>) -> Result<DVec3, SceneFileProblem> {
    let Some(value) = value else { return Ok(DVec3::ONE) };
    let scale = finite(value)?;
    if scale.to_array().contains(&0.0) {
        return Err(SceneFileProblem::new(
            value.span(),
            "a scale of zero flattens the object: give numbers other than 0",
        ));
    }
    Ok(scale)
}

fn finite(value: &SpannedTriple) -> Result<DVec3, SceneFileProblem> {
    let vector = DVec3::from_array(*value.get_ref());
    if vector.is_finite() { Ok(vector) } else { Err(not_finite(value)) }
}

fn finite_number(value: &SpannedNumber) -> Result<f64, SceneFileProblem> {
    let number = *value.get_ref();
    if number.is_finite() { Ok(number) } else { Err(not_finite(value)) }
}

fn not_finite<T>(value: &Spanned<T>) -> SceneFileProblem {
    SceneFileProblem::new(value.span(), "NaN and infinity are no places or sizes: give finite numbers")
}

fn positive(value: &SpannedNumber) -> Result<f64, SceneFileProblem> {
    let number = finite_number(value)?;
    if number > 0.0 {
        Ok(number)
    } else {
        Err(SceneFileProblem::new(value.span(), "must be greater than 0: correct it"))
    }
}

fn within(value: &SpannedNumber, low: f64, high: f64) -> Result<f32, SceneFileProblem> {
    let number = finite_number(value)?;
    if (low..=high).contains(&number) {
        return Ok(number as f32);
    }
    let range = if high == f64::from(f32::MAX) {
        format!("must not be below {low}")
    } else {
        format!("must be from {low} to {high}")
    };
    Err(SceneFileProblem::new(value.span(), format!("{range}: correct it")))
}

/// Returns linear RGB, each from 0 to `most`; an error where one is outside or not finite.
fn color(value: &SpannedTriple, most: f64) -> Result<[f32; 3], SceneFileProblem> {
    let rgb = finite(value)?.to_array();
    if rgb.iter().all(|part| (0.0..=most.min(f64::from(f32::MAX))).contains(part)) {
        return Ok(rgb.map(|part| part as f32));
    }
    let range = if most == 1.0 { "from 0 to 1" } else { "not negative" };
    Err(SceneFileProblem::new(value.span(), format!("a color has three parts, {range}: correct it")))
}

fn unknown(name: &SpannedText, what: &str, known: &[&str]) -> SceneFileProblem {
    let word = name.get_ref();
    SceneFileProblem::new(
        name.span(),
        format!("no {what} is called `{}`: {}", word.escape_debug(), suggestion(word, known)),
    )
}

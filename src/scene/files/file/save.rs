//! A scene as a scene file, and the models that it needs beside it.
//!
//! Numbers are written in the fewest digits that read back as the same bits, so that the scene that is read is the one
//! that was written. Small meshes are in the file itself; others become models.

use super::tables::{
    CameraTable, LightTable, MaterialTable, MeshSource, ObjectTable, OrbitTable, SceneTable, ShapeTable, SpannedTriple,
    SwingTable, TechniqueTable, unplaced,
};
use crate::scene::{
    Light, Material, MaterialTexture, Mesh, MeshGroup, Motion, Object, Projection, Scene, TechniqueRequest,
    TextureImage,
};
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::fmt::Write;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// Triangles of the largest mesh that is written in the scene file.
const MOST_INLINE: usize = 32;

/// A scene as the text of a scene file, with the contents of the files that it names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SavedScene {
    /// Text of the scene file.
    pub toml: String,
    /// Pictures, models and their materials: name, beside the scene file, and contents.
    pub files: Vec<(String, Vec<u8>)>,
}

/// Why a scene can't be written.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// The serialiser failed.
    #[error("the scene can't be written as a scene file ({0})")]
    Scene(#[from] toml::ser::Error),
    /// The PNG encoder failed.
    #[error("a picture can't be written ({0})")]
    Picture(#[from] png::EncodingError),
}

/// Returns a scene as text and files, writing nothing. New models are called `stem-object.obj`; meshes in `known` are
/// named by their file instead, and small plain ones are written as triangles in the text.
pub fn save(scene: &Scene, stem: &str, known: Vec<(Arc<Mesh>, String)>) -> Result<SavedScene, SaveError> {
    let mut beside = Beside { stem, files: Vec::new(), meshes: known, pictures: Vec::new() };
    let mut objects = Vec::with_capacity(scene.objects.len());
    for object in &scene.objects {
        let mesh = beside.mesh(object)?;
        let texture = object.texture.as_ref();
        let file = texture.map(|texture| beside.picture(&texture.picture)).transpose()?;
        objects.push(object_table(object, mesh, file));
    }
    let camera = &scene.camera;
    let oblique = match camera.projection {
        Projection::Oblique { angle_degrees, factor, .. } => Some((angle_degrees, factor)),
        Projection::Perspective | Projection::Frustum { .. } | Projection::Orthographic { .. } => None,
    };
    let table = SceneTable {
        name: Some(scene.name.clone()),
        ambient: Some(unplaced(scene.ambient.map(short))),
        camera: Some(unplaced(CameraTable {
            eye: Some(triple(camera.eye)),
            eye_spherical: None,
            target: triple(camera.target),
            up: Some(triple(camera.up)),
            projection: (!camera.projection.is_usual()).then(|| unplaced(camera.projection.name().to_owned())),
            frustum: camera.projection.edges().map(unplaced),
            viewport: camera.viewport.map(unplaced),
            half_height: camera.is_parallel().then(|| unplaced(camera.half_height())),
            oblique_angle_degrees: oblique.map(|(angle_degrees, _)| unplaced(angle_degrees)),
            oblique_factor: oblique.map(|(_, factor)| unplaced(factor)),
            fov_y_degrees: Some(unplaced(camera.fov_y_degrees)),
            near: Some(unplaced(camera.near)),
            far: camera.far.map(unplaced),
        })),
        lights: scene.lights.iter().map(light_table).collect(),
        objects,
        technique: scene.technique.as_ref().map(technique_table),
    };
    Ok(SavedScene { toml: toml::to_string(&table)?, files: beside.files })
}

fn triple(vector: DVec3) -> SpannedTriple {
    unplaced(vector.to_array())
}

fn technique_table(technique: &TechniqueRequest) -> TechniqueTable {
    let setting = |(key, value): (&String, &String)| (key.clone(), unplaced(toml::Value::String(value.clone())));
    TechniqueTable { name: technique.name.clone(), settings: technique.settings.iter().map(setting).collect() }
}

fn light_table(light: &Light) -> LightTable {
    let at = triple(light.position.truncate());
    let (kind, position, towards) =
        if light.is_directional() { ("directional", None, Some(at)) } else { ("point", Some(at), None) };
    let (orbit, swing) = motion(&light.motion);
    LightTable {
        kind: unplaced(kind.to_owned()),
        position,
        towards,
        color: Some(unplaced(light.color.map(short))),
        intensity: Some(unplaced(short(light.intensity))),
        on: (!light.is_on).then_some(false),
        range: light.range.map(unplaced),
        orbit,
        swing,
    }
}

fn motion(motion: &Motion) -> (Option<OrbitTable>, Option<SwingTable>) {
    let orbit = motion.orbit.as_ref().map(|orbit| OrbitTable {
        center: triple(orbit.center),
        axis: triple(orbit.axis),
        degrees_per_second: unplaced(orbit.degrees_per_second),
    });
    let swing = motion.swing.as_ref().map(|swing| SwingTable {
        pivot: triple(swing.pivot),
        axis: triple(swing.axis),
        degrees: unplaced(swing.degrees),
        period_seconds: unplaced(swing.period_seconds),
    });
    (orbit, swing)
}

/// Returns the table of an object, with its mesh and, in `texture`, the file of its picture.
fn object_table(object: &Object, mesh: MeshSource, texture: Option<String>) -> ObjectTable {
    let lies = object.texture.as_ref();
    let (orbit, swing) = motion(&object.motion);
    let spin = object.motion.spin_degrees_per_second;
    let Material { color, specular, shininess, shading, opacity, emission, checks } = object.material;
    let number = |value| Some(unplaced(short(value)));
    ObjectTable {
        name: Some(unplaced(object.name.clone())),
        translate: Some(triple(object.pose.translate)),
        rotate_degrees: Some(triple(object.pose.rotate_degrees)),
        scale: Some(triple(object.pose.scale)),
        spin_degrees_per_second: (spin != DVec3::ZERO).then(|| triple(spin)),
        casts: Some(object.casts),
        receives: Some(object.receives),
        visible: Some(object.visible),
        mesh: unplaced(mesh),
        orbit,
        swing,
        material: Some(MaterialTable {
            color: Some(unplaced(color.map(short))),
            specular: number(specular),
            shininess: number(shininess),
            shading: Some(unplaced(shading.name().to_owned())),
            opacity: number(opacity),
            emission: (emission != [0.0; 3]).then(|| unplaced(emission.map(short))),
            checks: number(checks).filter(|_| checks != 0.0),
            texture: texture.map(unplaced),
            texture_side: lies.and_then(|texture| texture.side).and_then(number),
            texture_clamps: lies.filter(|texture| texture.clamps).map(|_| unplaced(true)),
        }),
    }
}

/// The files beside a scene file.
struct Beside<'a> {
    stem: &'a str,
    files: Vec<(String, Vec<u8>)>,
    /// Meshes that have a file, known ones first.
    meshes: Vec<(Arc<Mesh>, String)>,
    pictures: Vec<(Arc<TextureImage>, String)>,
}

impl Beside<'_> {
    /// Returns how the table names an object's mesh: by the file that has it already, as triangles where they are few
    /// and without groups, normals and texture coordinates, or by a new model file, which is added with its material
    /// library.
    fn mesh(&mut self, object: &Object) -> Result<MeshSource, SaveError> {
        let mesh = &object.mesh;
        if let Some((_, name)) = self.meshes.iter().find(|(other, _)| other == mesh) {
            return Ok(MeshSource::File(name.clone()));
        }
        let has_parts = mesh.groups().iter().any(|group| group.material.is_some() || !group.name.is_empty());
        let has_more = has_parts || mesh.corner_normals().is_some() || mesh.corner_uvs().is_some();
        if mesh.triangles().len() <= MOST_INLINE && !has_more {
            return Ok(MeshSource::Shape(Box::new(ShapeTable {
                shape: unplaced("triangles".to_owned()),
                points: Some(unplaced(mesh.positions().iter().map(|point| point.to_array()).collect())),
                indices: Some(unplaced(mesh.triangles().to_vec())),
                size: None,
                radius: None,
                height: None,
                major: None,
                minor: None,
                segments: None,
                profile: None,
                closed: None,
            })));
        }
        let name = self.unused(&object.name, "obj");
        let pictures =
            |group: &MeshGroup| group.texture.as_ref().map(|texture| self.picture(&texture.picture)).transpose();
        let pictures = mesh.groups().iter().map(pictures).collect::<Result<Vec<_>, _>>()?;
        let library = library(mesh, &pictures);
        let of_library = (!library.is_empty()).then(|| format!("{name}.mtl"));
        self.files.push((format!("{name}.obj"), obj(mesh, of_library.as_deref()).into_bytes()));
        self.files.extend(of_library.map(|file| (file, library.into_bytes())));
        self.meshes.push((mesh.clone(), format!("{name}.obj")));
        Ok(MeshSource::File(format!("{name}.obj")))
    }

    /// Returns the file name of a picture, which is added as PNG unless an earlier object has it.
    fn picture(&mut self, picture: &Arc<TextureImage>) -> Result<String, SaveError> {
        if let Some((_, name)) = self.pictures.iter().find(|(other, _)| other == picture) {
            return Ok(name.clone());
        }
        let of = Path::new(picture.name()).file_stem().map_or_else(String::new, |of| of.to_string_lossy().into_owned());
        let name = format!("{}.png", self.unused(&of, "png"));
        self.files.push((name.clone(), png(picture)?));
        self.pictures.push((picture.clone(), name.clone()));
        Ok(name)
    }

    /// Returns a name, without its ending, that no other added file has: the stem and `of`, in letters, digits and
    /// dashes, with a number where that is taken.
    fn unused(&self, of: &str, ending: &str) -> String {
        let plain: String = of.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
        let taken = |name: &str| self.files.iter().any(|(other, _)| other == &format!("{name}.{ending}"));
        let base = format!("{}-{plain}", self.stem);
        let mut name = base.clone();
        let mut number = 2;
        while taken(&name) {
            name = format!("{base}-{number}");
            number += 1;
        }
        name
    }
}

fn png(picture: &TextureImage) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let [width, height] = picture.size();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(picture.texels().as_flattened())?;
    writer.finish()?;
    Ok(bytes)
}

/// Returns a mesh as the text of an OBJ model, with normals, texture coordinates and groups where it has them;
/// `library` is the file of its materials.
fn obj(mesh: &Mesh, library: Option<&str>) -> String {
    let mut out = String::new();
    if let Some(library) = library {
        write_line(&mut out, format_args!("mtllib {library}"));
    }
    write_lines(&mut out, 0..mesh.positions().len(), |out, index| {
        let DVec3 { x, y, z } = mesh.positions()[index];
        write_line(out, format_args!("v {x:?} {y:?} {z:?}"));
    });
    let uvs = mesh.corner_uvs();
    for Vec2 { x, y } in uvs.into_iter().flatten().flatten().flatten() {
        write_line(&mut out, format_args!("vt {x:?} {y:?}"));
    }
    let normals = mesh.corner_normals();
    for Vec3 { x, y, z } in normals.into_iter().flatten().flatten() {
        write_line(&mut out, format_args!("vn {x:?} {y:?} {z:?}"));
    }
    let mut next_uv = 1;
    let first_uv = |uvs: &Option<_>| {
        let first = next_uv;
        next_uv += if uvs.is_some() { 3 } else { 0 };
        uvs.is_some().then_some(first)
    };
    let first_uvs: Option<Vec<Option<usize>>> = uvs.map(|uvs| uvs.iter().map(first_uv).collect());
    let whole =
        [MeshGroup { name: String::new(), triangles: 0..mesh.triangles().len(), material: None, texture: None }];
    let groups = if mesh.groups().is_empty() { &whole } else { mesh.groups() };
    for (index, group) in groups.iter().enumerate() {
        if groups.len() > 1 || !group.name.is_empty() {
            // A backslash would join the next line.
            let plain = |c: char| if c == '\\' || c.is_control() { '-' } else { c };
            let name = if group.name.is_empty() { "unnamed_object" } else { &group.name };
            let name: String = name.chars().map(plain).collect();
            write_line(&mut out, format_args!("g {name}"));
        }
        // Without a `usemtl` line, the last group's material would apply.
        match group.material {
            Some(_) => write_line(&mut out, format_args!("usemtl {}", material_name(index))),
            None if groups[..index].iter().any(|other| other.material.is_some()) => {
                write_line(&mut out, format_args!("usemtl none"));
            }
            None => {}
        }
        write_lines(&mut out, group.triangles.clone(), |out, triangle| {
            let Some(corners) = mesh.triangles().get(triangle) else { return };
            let [a, b, c] = corners.map(|vertex| vertex + 1);
            let uv = first_uvs.as_ref().and_then(|first| first[triangle]);
            let normal = normals.map(|_| 3 * triangle + 1);
            let mut line = |text: std::fmt::Arguments| write_line(out, text);
            match (uv, normal) {
                (None, None) => line(format_args!("f {a} {b} {c}")),
                (Some(uv), None) => line(format_args!("f {a}/{uv} {b}/{} {c}/{}", uv + 1, uv + 2)),
                (None, Some(n)) => line(format_args!("f {a}//{n} {b}//{} {c}//{}", n + 1, n + 2)),
                (Some(uv), Some(n)) => {
                    line(format_args!("f {a}/{uv}/{n} {b}/{}/{} {c}/{}/{}", uv + 1, n + 1, uv + 2, n + 2));
                }
            }
        });
    }
    out
}

/// Appends what `line` writes for each of these indices, in their order, in parallel: most of the time of a large mesh goes
/// into digits.
fn write_lines(out: &mut String, indices: Range<usize>, line: impl Fn(&mut String, usize) + Sync) {
    let end = indices.end;
    let parts =
        |start: usize, step: usize, end: usize| (start..end).step_by(step).map(move |at| at..(at + step).min(end));
    for some in parts(indices.start, 1 << 18, end) {
        let of_part = |part: Range<usize>| {
            let mut out = String::new();
            part.for_each(|index| line(&mut out, index));
            out
        };
        let some: Vec<Range<usize>> = parts(some.start, 1 << 13, some.end).collect();
        out.extend(some.into_par_iter().map(of_part).collect::<Vec<String>>());
    }
}

fn write_line(out: &mut String, text: std::fmt::Arguments) {
    // Writing to a string can't fail.
    let _ = writeln!(out, "{text}");
}

/// Returns the text of the materials of a mesh's groups (MTL), with the files of their pictures; groups without a
/// material are left out, and it is empty where none has one.
fn library(mesh: &Mesh, pictures: &[Option<String>]) -> String {
    let mut out = String::new();
    for (index, (group, picture)) in mesh.groups().iter().zip(pictures).enumerate() {
        let Some(Material { color: [red, green, blue], specular, shininess, opacity, emission, .. }) = group.material
        else {
            continue;
        };
        // Writing to a string can't fail.
        let _ = writeln!(
            out,
            "newmtl {}\nKd {red} {green} {blue}\nKs {specular} {specular} {specular}\nNs {shininess}\nd {opacity}",
            material_name(index)
        );
        if let [red, green, blue] = emission
            && emission != [0.0; 3]
        {
            let _ = writeln!(out, "Ke {red} {green} {blue}");
        }
        if let (Some(file), Some(MaterialTexture { clamps, .. })) = (picture, &group.texture) {
            let _ = writeln!(out, "map_Kd {}{file}", if *clamps { "-clamp on " } else { "" });
        }
    }
    out
}

fn material_name(group: usize) -> String {
    format!("material-{}", group + 1)
}

/// Returns the number with the fewest digits that is this one in single precision.
fn short(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;
    use crate::scene::files::file::load;
    use std::collections::BTreeMap;
    use std::path::Path;

    /// Returns the scene as it is read again.
    fn again(scene: &Scene) -> (Scene, SavedScene) {
        let folder = tempfile::tempdir().expect("a folder");
        let saved = save(scene, "fixed", Vec::new()).expect("saved");
        let put = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).expect("written");
        saved.files.iter().for_each(|(name, bytes)| put(name, bytes));
        put("fixed.toml", saved.toml.as_bytes());
        (load(&folder.path().join("fixed.toml")).expect("it opens again"), saved)
    }

    fn assert_same(scene: &Scene, again: &Scene) {
        assert_eq!(again.objects.len(), scene.objects.len());
        for (object, other) in scene.objects.iter().zip(&again.objects) {
            assert_eq!(other.mesh.content_hash(), object.mesh.content_hash(), "{}: {}", scene.name, object.name);
            assert_eq!(other.mesh.corner_normals(), object.mesh.corner_normals());
            assert_eq!(other.mesh.corner_uvs(), object.mesh.corner_uvs());
            let textures = |mesh: &Mesh| mesh.groups().iter().map(|group| group.texture.clone()).collect::<Vec<_>>();
            assert_eq!(textures(&other.mesh), textures(&object.mesh));
            assert_eq!(Object { mesh: object.mesh.clone(), ..other.clone() }, *object, "{}", scene.name);
        }
        assert_eq!(Scene { objects: scene.objects.clone(), ..again.clone() }, *scene);
    }

    #[test]
    fn every_built_in_scene_reads_back_as_it_was() {
        for builtin in builtin::ALL {
            let scene = builtin.scene().expect("a scene");
            assert_same(&scene, &again(&scene).0);
        }
    }

    #[test]
    fn scene_files_with_models_materials_and_motion_read_back_as_they_were() {
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes");
        for file in ["knot.toml", "shade.toml", "pattern.toml"] {
            let scene = load(&scenes.join(file)).expect("a scene");
            assert_same(&scene, &again(&scene).0);
        }
        let mut scene = builtin::ALL[0].scene().expect("a scene");
        scene.technique = Some(TechniqueRequest {
            name: "z-fail".to_owned(),
            settings: BTreeMap::from([("casters".to_owned(), "all".to_owned())]),
        });
        (scene.objects[0].casts, scene.objects[0].receives, scene.objects[1].visible) = (false, false, false);
        (scene.lights[0].intensity, scene.lights[0].is_on) = (0.1, false);
        assert_same(&scene, &again(&scene).0);
    }

    #[test]
    fn parts_with_materials_keep_them() {
        let folder = tempfile::tempdir().expect("a folder");
        let put = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
        put("two.mtl", "newmtl red\nKd 0.8 0.1 0.1\nd 0.5\nnewmtl blue\nKd 0.1 0.1 0.8\nKs 0.3 0.3 0.3\nNs 20\n");
        put(
            "two.obj",
            "mtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0.1\nv 1 1 0.3\ng left\nusemtl red\nf 1 2 3\ng right\nusemtl blue\nf 2 4 3\n",
        );
        put("scene.toml", "[[objects]]\nmesh = \"two.obj\"\n");
        let scene = load(&folder.path().join("scene.toml")).expect("a scene");
        assert!(scene.objects[0].mesh.groups().iter().all(|group| group.material.is_some()));
        let (same, saved) = again(&scene);
        assert_same(&scene, &same);
        assert_eq!(same.objects[0].mesh.groups(), scene.objects[0].mesh.groups());
        assert_eq!(
            saved.files.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
            ["fixed-two.obj", "fixed-two.mtl"]
        );
    }

    #[test]
    fn a_mesh_that_is_a_file_already_is_named() {
        let scene = builtin::ALL[0].scene().expect("a scene");
        let known = vec![(scene.objects[0].mesh.clone(), "../model.obj".to_owned())];
        let saved = save(&scene, "fixed", known).expect("saved");
        assert!(saved.toml.contains("mesh = \"../model.obj\""), "{}", saved.toml);
    }
}

//! PLY models: samples that Blender, trimesh and plyfile wrote (`assets/ply`), files that lie, and what is said of both.

use crate::commands::{done, folder, run, text};
use crate::common::{adapter, is_closed, judged_by, request, session, volume};
use std::fs;
use std::path::{Path, PathBuf};
use stencilscope::scene::{Mesh, OpenSpec, Scene, SceneError, Shading, UpAxis, files_of, obj, open};
use stencilscope::technique::Technique;

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/ply").join(name)
}

fn opened(file: &Path) -> Result<Scene, SceneError> {
    open(&OpenSpec::new(file.to_string_lossy()))
}

fn scene(name: &str) -> Scene {
    opened(&sample(name)).unwrap_or_else(|error| panic!("{error}"))
}

/// The model in a scene: beside it there is a floor.
fn model(scene: &Scene) -> &Mesh {
    assert_eq!(scene.objects.len(), 2);
    &scene.objects[0].mesh
}

/// Samples: vertices and triangles of the welded mesh, shading, and what is not taken.
const SAMPLES: [(&str, usize, usize, Shading, &[&str]); 4] = [
    ("blender.ply", 344, 680, Shading::Phong, &[]),
    (
        "plyfile.ply",
        28,
        52,
        Shading::Flat,
        &[
            "14 elements `edge`: a mesh is of vertices, faces and strips",
            "the picture `star.png`: name it as the `texture` of the object's material in a scene file",
        ],
    ),
    ("trimesh.ply", 202, 400, Shading::Flat, &["colours of `vertex`: a surface has its material's colour"]),
    ("trimesh-text.ply", 42, 80, Shading::Phong, &[]),
];

#[test]
fn samples_open_closed_and_right_side_out_and_what_is_not_shown_is_named() {
    for (name, vertices, triangles, shading, reported) in SAMPLES {
        let scene = scene(name);
        let mesh = model(&scene);
        assert_eq!((mesh.positions().len(), mesh.triangles().len()), (vertices, triangles), "{name}");
        assert_eq!(scene.objects[0].material.shading, shading, "{name}");
        assert!(is_closed(mesh) && volume(&scene, &scene.objects[0].name) > 0.1, "{name}");
        let not_taken: Vec<String> =
            mesh.not_taken().iter().map(|one| format!("{}: {}", one.what, one.because)).collect();
        assert_eq!(not_taken, reported, "{name}");
    }
    assert_eq!(crate::common::names(&sample("")).len(), SAMPLES.len());
}

#[test]
fn auto_is_right_on_every_sample() {
    let mut session = session();
    for (name, ..) in SAMPLES {
        let (scene, request) = (scene(name), request(Technique::Auto, [320, 200]));
        let capture = judged_by(&mut session, &scene, &request);
        adapter::assert_right(&mut session, &scene, &request, &capture, &name);
        let compared = capture.error().expect("judged").compared;
        assert!(compared > 2000, "{name}: {compared}");
    }
}

/// A pyramid on a square, with normals and texture coordinates, in numbers that any of the formats holds exactly.
const VERTICES: [[f64; 8]; 5] = [
    [-1.0, 0.0, -1.0, 0.0, 1.0, 0.5, 0.0, 0.0],
    [1.0, 0.0, -1.0, 0.0, 1.0, 0.5, 1.0, 0.0],
    [1.0, 0.0, 1.0, 0.5, 1.0, 0.0, 1.0, 1.0],
    [-1.0, 0.0, 1.0, 0.0, 1.0, -0.5, 0.0, 1.0],
    [0.25, 1.5, 0.0, 0.0, 1.0, 0.0, 0.5, 0.5],
];
const FACES: [&[u32]; 5] = [&[0, 1, 2, 3], &[1, 0, 4], &[2, 1, 4], &[3, 2, 4], &[0, 3, 4]];

#[derive(Clone, Copy)]
enum Encoding {
    Text,
    Little,
    Big,
}

/// The pyramid as a file. `float` is the type of its vertices, `count` and `index` those of its faces' lists.
fn pyramid(encoding: Encoding, float: &str, count: &str, index: &str) -> Vec<u8> {
    let name = match encoding {
        Encoding::Text => "ascii",
        Encoding::Little => "binary_little_endian",
        Encoding::Big => "binary_big_endian",
    };
    let names = ["x", "y", "z", "nx", "ny", "nz", "s", "t"].map(|name| format!("property {float} {name}\n")).concat();
    let mut file = format!(
        "ply\nformat {name} 1.0\nelement vertex 5\n{names}element face 5\nproperty list {count} {index} vertex_indices\nend_header\n"
    )
    .into_bytes();
    let mut put = |number: f64, of: &str, last: bool| {
        let mut bytes = match of {
            _ if matches!(encoding, Encoding::Text) => {
                file.extend(format!("{number}{}", if last { "\n" } else { " " }).bytes());
                return;
            }
            "double" => number.to_le_bytes().to_vec(),
            "float" => (number as f32).to_le_bytes().to_vec(),
            "int" | "uint" => (number as u32).to_le_bytes().to_vec(),
            "short" | "ushort" => (number as u16).to_le_bytes().to_vec(),
            "char" | "uchar" => vec![number as u8],
            other => panic!("{other}"),
        };
        if matches!(encoding, Encoding::Big) {
            bytes.reverse();
        }
        file.extend(bytes);
    };
    for vertex in VERTICES {
        for (at, number) in vertex.into_iter().enumerate() {
            put(number, float, at == 7);
        }
    }
    for face in FACES {
        put(face.len() as f64, count, false);
        for (at, corner) in face.iter().enumerate() {
            put(f64::from(*corner), index, at + 1 == face.len());
        }
    }
    file
}

/// Whatever the encoding and the types, it is the mesh that the same numbers make as an OBJ.
#[test]
fn one_mesh_in_any_encoding_is_the_mesh_of_an_obj() {
    let folder = folder();
    let mut lines = String::new();
    for [x, y, z, nx, ny, nz, s, t] in VERTICES {
        lines += &format!("v {x} {y} {z}\nvn {nx} {ny} {nz}\nvt {s} {t}\n");
    }
    for face in FACES {
        let corners = face.iter().map(|corner| corner + 1).map(|corner| format!(" {corner}/{corner}/{corner}"));
        lines += &format!("f{}\n", corners.collect::<String>());
    }
    fs::write(folder.path().join("a.obj"), lines).expect("written");
    let expected = obj::load(&folder.path().join("a.obj")).expect("a mesh");
    assert_eq!((expected.triangles().len(), is_closed(&expected)), (6, true));
    let kinds = [
        (Encoding::Text, "float", "uchar", "int"),
        (Encoding::Text, "double", "int", "uint"),
        (Encoding::Little, "float", "uchar", "int"),
        (Encoding::Little, "double", "char", "uchar"),
        (Encoding::Big, "float", "ushort", "short"),
        (Encoding::Big, "double", "uint", "ushort"),
    ];
    let file = folder.path().join("a.ply");
    for (encoding, float, count, index) in kinds {
        fs::write(&file, pyramid(encoding, float, count, index)).expect("written");
        let scene = opened(&file).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(model(&scene), &expected, "{float} {count} {index}");
    }
    // As a file of Windows has it, with empty lines between.
    let text = String::from_utf8(pyramid(Encoding::Text, "float", "uchar", "int")).expect("text");
    fs::write(&file, text.replace('\n', "\r\n") + "\r\n").expect("written");
    assert_eq!(model(&opened(&file).expect("a mesh")), &expected);
    // As one of an old Mac does, as text and as bytes.
    fs::write(&file, text.replace('\n', "\r")).expect("written");
    assert_eq!(model(&opened(&file).expect("a mesh")), &expected);
    let mut binary = pyramid(Encoding::Big, "float", "uchar", "int");
    let head = binary.len() - (5 * 8 * 4 + 5 + 16 * 4);
    binary[..head].iter_mut().filter(|byte| **byte == b'\n').for_each(|byte| *byte = b'\r');
    fs::write(&file, binary).expect("written");
    assert_eq!(model(&opened(&file).expect("a mesh")), &expected);
}

#[test]
fn a_scene_file_names_a_ply_and_saving_names_it_again() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("written");
    fs::copy(sample("trimesh.ply"), folder.path().join("ring.PLY")).expect("copied");
    write("a.toml", "[[objects]]\nmesh = \"ring.PLY\"\n[[objects]]\nmesh = \"ring.PLY\"\ntranslate = [3, 0, 0]\n");
    let scene = opened(&folder.path().join("a.toml")).expect("a scene");
    assert!(std::sync::Arc::ptr_eq(&scene.objects[0].mesh, &scene.objects[1].mesh));
    assert_eq!(*scene.objects[0].mesh, *model(&self::scene("trimesh.ply")));
    let spec = OpenSpec::new(folder.path().join("a.toml").to_string_lossy());
    assert!(files_of(&spec).iter().any(|file| file.ends_with("ring.PLY")));

    let (model, saved) = (folder.path().join("ring.PLY"), folder.path().join("saved.toml"));
    let original = opened(&model).expect("a scene");
    stencilscope::scene::file::store(&original, Some(&model), &saved).expect("stored");
    let written = fs::read_to_string(&saved).expect("a scene file");
    assert!(written.contains("mesh = \"ring.PLY\""), "{written}");
    assert_eq!(opened(&saved).expect("a scene").objects, original.objects);
}

/// Many programs have z up, and the file does not say.
#[test]
fn z_can_be_up() {
    let spec = OpenSpec { up: UpAxis::Z, ..OpenSpec::new(sample("plyfile.ply").to_string_lossy()) };
    let scene = open(&spec).expect("a scene");
    let reach =
        |axis: usize| scene.objects[0].world_positions().iter().map(|point| point[axis].abs()).fold(0.0, f64::max);
    // The star is flat along its own y.
    assert!((reach(2) - 0.3).abs() < 1e-9 && reach(1) > 0.9, "{} {}", reach(1), reach(2));
    let folder = folder();
    let file = sample("plyfile.ply").display().to_string();
    done(folder.path(), &["capture", &file, "--z-up", "--size", "64x48", "-o", "out"]);
}

#[test]
fn files_that_lie_are_refused_in_one_line() {
    let folder = folder();
    let whole = String::from_utf8(pyramid(Encoding::Text, "float", "uchar", "int")).expect("text");
    let binary = pyramid(Encoding::Little, "float", "uchar", "int");
    let with = |from: &str, to: &str| {
        assert!(whole.contains(from), "{from}");
        whole.replacen(from, to, 1).into_bytes()
    };
    let cases: Vec<(Vec<u8>, &str)> = vec![
        (Vec::new(), "is empty: give a PLY model with content"),
        (b"solid\n".to_vec(), "is no PLY model: its first line is not `ply`"),
        (b"ply\nformat ascii 1.0\n".to_vec(), "has no end of its header, a line `end_header`: export the file again"),
        (
            b"ply\ncomment a\nend_header\n".to_vec(),
            "has no `format` in its header that is known: export the file again",
        ),
        (with("ascii", "ebcdic"), ":2: `format ebcdic 1.0` can't stand there in a PLY header: export the file again"),
        (with("float x", "quad x"), ":4: `property quad x` can't stand there in a PLY header: export the file again"),
        (with("property float x", "propery float x"), ":4: `propery float x` can't stand there in a PLY header"),
        (with("element face 5", "elements face 5"), ":12: `elements face 5` can't stand there in a PLY header"),
        (with("float z", "float w"), "has no vertices with numbers x, y and z: export its surface"),
        (with("element face 5", "element face 0"), "has no faces of three corners or more: export its surface"),
        (
            with("element face 5", "element face 4000000000"),
            "is too short for 4000000000 elements `face`: export it again",
        ),
        (with("element face 5", "element face 6"), "ends after 5 of 6 elements `face`: export it again"),
        (
            with("-1 0 -1 0 1 0.5 0 0", "-1 x -1 0 1 0.5 0 0"),
            ":15: `-1 x -1 0 1 0.5 0 0` does not hold `x y z nx ny nz s t` of `vertex`: correct it",
        ),
        (
            with("-1 0 -1 0 1 0.5 0 0", "-1 nan -1 0 1 0.5 0 0"),
            ":15: vertex 0, counted from 0, is not finite, and a face uses it: replace NaN and infinity by numbers",
        ),
        (with("3 1 0 4\n", "3 1 0\n"), ":21: `3 1 0` does not hold `vertex_indices` of `face`: correct it"),
        (with("3 1 0 4\n", "3 1 0 5\n"), "uses vertex 5 of 5, counted from 0: export it again"),
        (with("3 1 0 4\n", "3 1 0 -1\n"), ":21: the face uses vertex -1, which can't be"),
        (with("list uchar int", "list uchar float"), "has no one list `vertex_indices` of whole numbers in `face`"),
        (with("vertex_indices", "corners"), "has no one list `vertex_indices` of whole numbers in `face`"),
        (with("float ny", "float nx"), "has two elements or properties of one name: export the file again"),
        (with("float x", "list uchar float x"), "has no vertices with numbers x, y and z"),
        (b"ply\rformat ascii 1.0\r".to_vec(), "has no end of its header, a line `end_header`: export the file again"),
        (binary[..binary.len() - 1].to_vec(), "ends after 4 of 5 elements `face`: export it again"),
        (binary[..binary.len() - 64].to_vec(), "ends after 0 of 5 elements `face`: export it again"),
    ];
    for (bytes, words) in cases {
        fs::write(folder.path().join("a.ply"), bytes).expect("written");
        let error = opened(&folder.path().join("a.ply")).expect_err(words).to_string();
        assert!(error.contains(words) && !error.contains('\n') && error.contains("a.ply"), "{error}, not {words}");
    }
    // A vertex that is no number.
    let head = binary.len() - (5 * 8 * 4 + 5 + 16 * 4);
    let mut nan = binary.clone();
    nan[head..head + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    fs::write(folder.path().join("a.ply"), nan).expect("written");
    assert!(
        opened(&folder.path().join("a.ply"))
            .expect_err("a NaN")
            .to_string()
            .contains("has a vertex, number 0 counted from 0, that is not finite, and a face uses it")
    );
    // A face of a corner that can't be.
    let face = binary.len() - 16 * 4 - 5 + 17;
    let mut broken = binary.clone();
    broken[face + 4] = 255;
    fs::write(folder.path().join("a.ply"), broken).expect("written");
    let error = opened(&folder.path().join("a.ply")).expect_err("no vertex").to_string();
    assert!(
        error.contains("has a face, number 1 counted from 0, that uses vertex -16777215, which can't be"),
        "{error}"
    );
    // Elements of nothing, more than anybody could count.
    let many = whole.replace("element face", "element nothing 18446744073709551615\nelement face").into_bytes();
    fs::write(folder.path().join("a.ply"), many).expect("written");
    assert_eq!(model(&opened(&folder.path().join("a.ply")).expect("a mesh")).triangles().len(), 6);
}

/// A square of two triangles as scanners and modellers leave one: a remark without its keyword, lists among the vertices'
/// numbers, vertices that are not finite, faces of fewer than three corners. `uses` is a corner of the last face.
fn scan(encoding: Encoding, uses: u32) -> Vec<u8> {
    let name = match encoding {
        Encoding::Text => "ascii",
        Encoding::Little => "binary_little_endian",
        Encoding::Big => "binary_big_endian",
    };
    let head = format!(
        "ply\nmade by a scanner\n\nformat {name} 1.0\nelement vertex 6\nproperty float x\nproperty list ushort short near\n\
         property float y\nproperty float z\nproperty list uchar double far\nelement face 6\n\
         property list uchar int vertex_index\nend_header\n"
    );
    let mut file = head.into_bytes();
    let mut put = |text: String, mut little_endian: Vec<u8>| match encoding {
        Encoding::Text => file.extend(text.into_bytes()),
        Encoding::Little => file.extend(little_endian),
        Encoding::Big => {
            little_endian.reverse();
            file.extend(little_endian);
        }
    };
    let nan = f32::NAN;
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [nan, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, f32::INFINITY, 0.0],
    ];
    for (at, [x, y, z]) in corners.into_iter().enumerate() {
        put(format!("{x} {at}"), x.to_le_bytes().to_vec());
        put(String::new(), (at as u16).to_le_bytes().to_vec());
        for near in 0..at as i16 {
            put(format!(" {near}"), near.to_le_bytes().to_vec());
        }
        put(format!(" {y} {z}"), y.to_le_bytes().to_vec());
        put(String::new(), z.to_le_bytes().to_vec());
        put(" 1 0.5\n".to_owned(), vec![1]);
        put(String::new(), 0.5_f64.to_le_bytes().to_vec());
    }
    for face in [&[][..], &[0], &[0, 1, 3], &[5, 2], &[0, 3, uses], &[1, 1]] {
        put(face.len().to_string(), vec![face.len() as u8]);
        for corner in face {
            put(format!(" {corner}"), corner.to_le_bytes().to_vec());
        }
        put("\n".to_owned(), Vec::new());
    }
    file
}

#[test]
fn what_no_surface_needs_is_left_out_and_named_in_any_encoding() {
    let folder = folder();
    let file = folder.path().join("a.ply");
    for (encoding, used) in [
        (Encoding::Text, "a.ply:16: vertex 2, counted from 0, is not finite, and a face uses it: replace NaN"),
        (Encoding::Little, "has a vertex, number 2 counted from 0, that is not finite, and a face uses it"),
        (Encoding::Big, "has a vertex, number 2 counted from 0, that is not finite, and a face uses it"),
    ] {
        fs::write(&file, scan(encoding, 4)).expect("written");
        let scene = opened(&file).unwrap_or_else(|error| panic!("{error}"));
        let mesh = model(&scene);
        assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.positions().iter().map(|at| at.to_array()).collect::<Vec<_>>(), {
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]
        });
        let not_taken: Vec<String> =
            mesh.not_taken().iter().map(|one| format!("{}: {}", one.what, one.because)).collect();
        let expected = [
            "`near` of `vertex`: only places, normals and texture coordinates are taken",
            "`far` of `vertex`: only places, normals and texture coordinates are taken",
            "`made by a scanner` of the header: it begins with no word of PLY: a comment",
            "2 vertices that are not finite: no face uses them",
            "4 faces of fewer than three corners: a surface needs three",
        ];
        assert_eq!(not_taken, expected);
        fs::write(&file, scan(encoding, 2)).expect("written");
        let error = opened(&file).expect_err("a NaN").to_string();
        assert!(error.contains(used) && !error.contains('\n'), "{error}");
    }
}

#[test]
fn numbers_of_other_languages_are_read_in_text() {
    let folder = folder();
    let file = folder.path().join("a.ply");
    let faces = "element face 1\nproperty list uchar int vertex_index\nend_header\n";
    let text = square("property float quality\n", &["-1.#IND", "1.5D+03", "-nan(ind)", "3.1+e2"], faces) + "3 0 1 2\n";
    fs::write(&file, text.replace("0 0 -1e0", "0 0 -1.0+00")).expect("written");
    assert_eq!(model(&opened(&file).unwrap_or_else(|error| panic!("{error}"))).triangles(), [[0, 1, 2]]);
}

/// Two triangles of a square, and the header's lines for a vertex's more numbers, which are `more`.
fn square(properties: &str, more: &[&str; 4], faces: &str) -> String {
    let corners = ["0 0 0", "1. 0 0", "1 0 -1", "0 0 -1e0"];
    let rows: String = corners.iter().zip(more).map(|(corner, more)| format!("{corner} {more}\n")).collect();
    format!(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n{properties}{faces}{rows}"
    )
}

/// Where corners lie in a picture: each as its face says, else as its vertex does.
#[test]
fn places_in_a_picture_are_of_corners_or_of_vertices() {
    let folder = folder();
    let file = folder.path().join("a.ply");
    let uvs = |text: &str| {
        fs::write(&file, text).expect("written");
        let scene = opened(&file).unwrap_or_else(|error| panic!("{error}: {text}"));
        let mesh = model(&scene);
        let not_taken: Vec<String> = mesh.not_taken().iter().map(|one| one.what.clone()).collect();
        let uvs =
            mesh.corner_uvs().map(|uvs| uvs.iter().map(|uvs| uvs.map(|uvs| uvs.map(|uv| uv.to_array()))).collect());
        (uvs.unwrap_or_default(), not_taken)
    };
    let faces = "element face 2\nproperty list uchar int vertex_index\nend_header\n";
    // The rows of faces follow those of vertices.
    let with = |properties: &str, more: &[&str; 4], head: &str, rows: &str| square(properties, more, head) + rows;
    let expected = vec![Some([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), Some([[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]])];
    for [u, v] in [["s", "t"], ["u", "v"], ["texture_u", "texture_v"]] {
        let properties = format!("property float {u}\nproperty float {v}\n");
        let text = with(&properties, &["0 0", "1 0", "1 1", "0 1"], faces, "3 0 1 2\n3 0 2 3\n");
        assert_eq!(uvs(&text), (expected.clone(), vec![]), "{u} {v}");
    }
    // One without the other is none; nor is a number that is none.
    let text = with("property float u\nproperty float s\n", &["0 0"; 4], faces, "3 0 1 2\n3 0 2 3\n");
    assert_eq!(uvs(&text), (vec![], vec!["`u` of `vertex`".to_owned(), "`s` of `vertex`".to_owned()]));
    let text =
        with("property float s\nproperty float t\n", &["0 0", "nan 0", "1 1", "0 1"], faces, "3 0 1 2\n3 0 2 3\n");
    assert_eq!(uvs(&text).0, [None, expected[1]]);
    // Texture coordinates of a face's corners; where a face has none, those of its vertices.
    let of_corners =
        "element face 2\nproperty list uchar int vertex_index\nproperty list uchar float texcoord\nend_header\n";
    let rows = "3 0 1 2 6 .5 0 .5 .5 .5 1\n3 0 2 3 0\n";
    let text = with("property float s\nproperty float t\n", &["0 0", "1 0", "1 1", "0 1"], of_corners, rows);
    assert_eq!(uvs(&text).0, [Some([[0.5, 0.0], [0.5, 0.5], [0.5, 1.0]]), expected[1]]);
    // A list of another type is named, and not taken.
    let text = with("", &[""; 4], &of_corners.replace("uchar float", "uchar int"), "3 0 1 2 0\n3 0 2 3 1 7\n");
    assert_eq!(uvs(&text), (vec![], vec!["`texcoord` of `face`".to_owned()]));
    // The sample has them for its polygons, and none for its strips.
    let sample = scene("plyfile.ply");
    let uvs = model(&sample).corner_uvs().expect("of its polygons");
    assert_eq!(uvs.iter().filter(|uvs| uvs.is_some()).count(), 24);
    let [corner, ..] = model(&sample).triangles()[0];
    let place = model(&sample).positions()[corner as usize];
    let [u, v] = uvs[0].expect("three")[0].to_array();
    assert!((f64::from(u) - (0.5 * place.x + 0.5)).abs() < 1e-6 && (f64::from(v) - (0.5 * place.z + 0.5)).abs() < 1e-6);
}

/// What programs write beside a surface does not keep it from being read.
#[test]
fn what_is_not_wanted_is_read_over() {
    let folder = folder();
    let file = folder.path().join("a.ply");
    let head = "ply\nformat ascii 1.0\n";
    let faces = "element face 1\nproperty list uchar int vertex_indices\nproperty uchar filtered\n";
    let vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float quality\n\
                    property float nx\nproperty float ny\nproperty float nz\nproperty uchar diffuse_red\n";
    let camera = "element camera 1\nproperty list uchar float u\nproperty list uchar float vertex_index\n";
    // Faces before vertices, lists where others have numbers, numbers that are none, words behind the end of a row.
    let text = format!(
        "{head}{camera}{faces}{vertices}end_header\n1 0.5 2 1 2\n3 0 1 2 7\n\n0 0 0 nan nan 0 1 9\n1 0 0 inf 0 2 0 9\n\
         +0 0 -1e0 1 0 1 0 9 more\n"
    );
    fs::write(&file, text).expect("written");
    let scene = opened(&file).unwrap_or_else(|error| panic!("{error}"));
    let mesh = model(&scene);
    assert_eq!(mesh.triangles(), [[0, 1, 2]]);
    // A normal that is none is the triangle's own.
    let normals = mesh.corner_normals().expect("normals")[0].map(|normal| normal.to_array());
    assert_eq!(normals, [[0.0; 3], [0.0, 2.0, 0.0], [0.0, 1.0, 0.0]]);
    let not_taken: Vec<&str> = mesh.not_taken().iter().map(|one| one.what.as_str()).collect();
    let expected = [
        "1 element `camera`",
        "`filtered` of `face`",
        "`quality` of `vertex`",
        "colours of `vertex`",
        "1 normal that is not finite",
    ];
    assert_eq!(not_taken, expected);
}

#[cfg(unix)]
#[test]
fn what_is_no_file_is_not_waited_for() {
    let folder = folder();
    let made = std::process::Command::new("mkfifo").arg(folder.path().join("a.ply")).status().expect("mkfifo");
    assert!(made.success());
    fs::create_dir(folder.path().join("b.ply")).expect("a folder");
    for (name, words) in [
        ("a.ply", "a.ply: is a pipe: only plain files are read"),
        ("b.ply", "b.ply: is a folder: name a PLY model in it"),
        ("c.ply", "c.ply: there is no such file"),
    ] {
        let output = run(folder.path(), &["capture", name, "-o", "out"]);
        assert_eq!(output.status.code(), Some(2), "{name}");
        assert!(text(&output.stderr).contains(words), "{}", text(&output.stderr));
    }
    fs::write(folder.path().join("d.toml"), "[[objects]]\nmesh = \"a.ply\"\n").expect("written");
    let error = opened(&folder.path().join("d.toml")).expect_err("a pipe").to_string();
    assert!(error.contains("d.toml:2: ") && error.contains("is a pipe: only plain files are read"), "{error}");
}

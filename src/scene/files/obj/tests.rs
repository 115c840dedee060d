use super::*;
use glam::{DVec3, Vec3};

fn parsed(text: &str) -> Result<Mesh, String> {
    parse(text, Path::new(""), &mut ImageLoader::default()).map_err(|problem| match problem {
        FileProblem::Line(line, reason) => format!("{line}: {reason}"),
        FileProblem::File(reason) => reason,
    })
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn area(mesh: &Mesh) -> DVec3 {
    let corner = |index: u32| mesh.positions()[index as usize];
    mesh.triangles().iter().map(|&[a, b, c]| (corner(b) - corner(a)).cross(corner(c) - corner(a)) / 2.0).sum()
}

#[test]
fn a_face_may_have_any_size_and_negative_indices() {
    for face in ["f 1 2 3 4", "f -4 -3 -2 -1", "f 1/1 2/1 3/1 4/1 # a comment", "f 1 2 \\\n 3 4"] {
        let mesh = parsed(&format!("{SQUARE}{face}\n")).expect(face);
        assert_eq!(mesh.triangles().len(), 2, "{face}");
        assert_eq!(area(&mesh), DVec3::Z, "{face}");
    }
}

#[test]
fn concave_faces_keep_area_and_orientation() {
    // An L in each of the three planes, both ways round.
    let outline = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 3], [0, 3]];
    for axis in 0..3 {
        for reversed in [false, true] {
            let vertex = |[u, v]: [i32; 2]| {
                let mut at = [0; 3];
                (at[(axis + 1) % 3], at[(axis + 2) % 3]) = (u, v);
                format!("v {} {} {}\n", at[0], at[1], at[2])
            };
            let vertices: String = outline.into_iter().map(vertex).collect();
            let face = if reversed { "f 6 5 4 3 2 1" } else { "f 1 2 3 4 5 6" };
            let mesh = parsed(&format!("{vertices}{face}\n")).expect("an L");
            let mut expected = DVec3::ZERO;
            expected[axis] = if reversed { -4.0 } else { 4.0 };
            assert_eq!(mesh.triangles().len(), 4);
            assert_eq!(area(&mesh), expected, "axis {axis}, reversed {reversed}");
        }
    }
}

#[test]
fn split_vertices_are_welded_and_groups_kept() {
    let text = "o left\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ng right\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 4 6 5\n";
    let mesh = parsed(text).expect("two groups");
    assert_eq!(mesh.positions().len(), 4);
    let names: Vec<&str> = mesh.groups().iter().map(|group| group.name.as_str()).collect();
    assert_eq!(names, ["left", "right"]);
    assert_eq!(mesh.groups()[1].triangles, 1..2);
}

#[test]
fn normals_are_kept_and_missing_ones_are_the_faces_own() {
    let text = format!("{SQUARE}vn 0 1 0\nf 1//1 2//1 3//1\nf 1 3 4\nf 1//1 3 4//1\n");
    let mesh = parsed(&text).expect("normals");
    let normals = mesh.corner_normals().expect("normals");
    assert_eq!(normals[0], [Vec3::Y; 3]);
    assert_eq!(normals[1], [Vec3::Z; 3]);
    assert_eq!(normals[2], [Vec3::Z; 3]);
    assert!(parsed(&format!("{SQUARE}f 1 2 3\n")).expect("no normals").corner_normals().is_none());
}

#[test]
fn points_lines_and_what_is_unknown_are_passed_over() {
    let text = format!("{SQUARE}p 1\nl 1 2\ncurv 0 1 1 2\nmtllib missing.mtl\nusemtl red\nusemtl\nf 1 2 3\n");
    assert_eq!(parsed(&text).expect("one face").triangles().len(), 1);
}

#[test]
fn a_material_library_gives_groups_their_colours_and_a_broken_one_is_passed_over() {
    let folder = tempfile::tempdir().expect("a folder");
    let library = "newmtl broken\nKd 1 2\nmap_Kd\nillum x\nnewmtl red\nKd 1 0 0.5\nNs 20\nd 0.5\nKs 0.2 0.4 0.6\n";
    std::fs::write(folder.path().join("a b.mtl"), library).expect("written");
    let text = format!("mtllib a b.mtl\n{SQUARE}usemtl red\nf 1 2 3\nusemtl broken\nf 1 3 4\n");
    let mesh = parse(&text, folder.path(), &mut ImageLoader::default()).expect("a mesh");
    let red = mesh.groups()[0].material.expect("red");
    assert_eq!((red.color, red.shininess, red.opacity), ([1.0, 0.0, 0.5], 20.0, 0.5));
    assert!((red.specular - 0.4).abs() < 1e-6);
    assert_eq!(mesh.groups()[1].material.expect("broken").color, crate::scene::Material::default().color);
}

#[test]
fn broken_lines_are_named() {
    let cases = [
        ("v 0 0", 5, "three numbers, but this has 2"),
        ("v 0 0 x", 5, "`x` is not a number"),
        ("f 1 2 5", 5, "vertex index 5 is out of range: there are 4 vertices"),
        ("f 1 2 0", 5, "vertex index 0 is out of range"),
        ("f 1 2 -5", 5, "vertex index -5 is out of range: 4 vertices stand before it"),
        ("f 1 2 -9223372036854775808", 5, "out of range"),
        ("f 1 2 9223372036854775808", 5, "is no vertex index"),
        ("vn 0 x 0", 5, "`x` is not a number"),
        ("vn 0 0", 5, "three numbers, but this has 2"),
        ("v 0 0 nan\nf 1 2 5", 5, "vertex 5 is not finite, and a face uses it: replace NaN and infinity by numbers"),
        ("v 0 -inf 0\nv 1 1 nan\nf 1 2 -1", 6, "vertex 6 is not finite"),
        ("v 0 0 1e999\nf 1 2 5", 5, "vertex 5 is not finite"),
        ("f 1 9", 5, "vertex index 9 is out of range"),
        ("f 1//x 2//1 3//1", 5, "`x` is no normal index"),
        ("f 1/2/3/4 2 3", 5, "is no corner"),
        ("f 1 2 \\\n a", 5, "`a` is no vertex index"),
    ];
    for (line, number, words) in cases {
        let reason = parsed(&format!("{SQUARE}{line}\nf 1 2 3\n")).expect_err(line);
        assert!(reason.starts_with(&format!("{number}: ")) && reason.contains(words), "{line}: {reason}");
    }
    for nothing in ["", "f 1 2\nf\n"] {
        let no_faces = parsed(&format!("{SQUARE}{nothing}")).expect_err("no faces");
        assert!(no_faces.contains("has no faces of three corners or more"), "{no_faces}");
    }
    let no_area = parsed(&format!("{SQUARE}f 1 1 2\n")).expect_err("no area");
    assert!(no_area.contains("three different corners"), "{no_area}");
}

fn not_taken(mesh: &Mesh) -> Vec<String> {
    mesh.not_taken().iter().map(|one| format!("{}: {}", one.what, one.because)).collect()
}

/// What no shadow needs is left out, counted and named; what is left is the mesh of the same file without it.
#[test]
fn what_no_surface_needs_is_left_out_and_named() {
    let plain = |faces: &str| parsed(&format!("{SQUARE}{faces}")).expect("a plain file");
    let cases = [
        // Exporters that drop normals and keep their indices.
        (
            "f 1//1 2//1 3//1\nf 1 3 4\n",
            plain("f 1 2 3\nf 1 3 4\n"),
            "1 face's normals: the file does not have them (vn): computed ones are used",
        ),
        (
            "f 1//-1 2//-1 3//-1\nvn 0 0 1\nf 1//2 3//2 4//0\n",
            plain("f 1 2 3\nf 1 3 4\n"),
            "2 faces' normals: the file does not have them (vn): computed ones are used",
        ),
        // Loose edges.
        (
            "f 1 2\nf 1 2 3\nf 1\nf\nf 1 3 4\n",
            plain("f 1 2 3\nf 1 3 4\n"),
            "3 faces of fewer than three corners: a surface needs three",
        ),
        // Range scans, and what Microsoft's runtime wrote.
        ("v nan nan nan\nf 1 2 3\n", plain("f 1 2 3\n"), "1 vertex that is not finite: no face uses them"),
        (
            "v 0 -1.#IND 0\nv 1.#QNAN 1 1\nv 0 0 1.#INF\nv inf 0 0\nv 1e999 0 0\nf 1 2 3\n",
            plain("f 1 2 3\n"),
            "5 vertices that are not finite: no face uses them",
        ),
    ];
    for (text, expected, sentence) in cases {
        let mesh = parsed(&format!("{SQUARE}{text}")).unwrap_or_else(|error| panic!("{error}: {text}"));
        assert_eq!(not_taken(&mesh), [sentence], "{text}");
        assert_eq!((mesh.positions(), mesh.triangles()), (expected.positions(), expected.triangles()), "{text}");
        assert!(mesh.corner_normals().is_none(), "{text}");
    }
}

/// As in a PLY: zero stands for the triangle's own normal.
#[test]
fn normals_that_are_not_finite_are_replaced_and_counted() {
    let mesh = parsed(&format!("{SQUARE}vn nan 0 0\nvn 0 1 0\nvn 0 0 1e99\nf 1//1 2//2 3//3\n")).expect("a mesh");
    assert_eq!(not_taken(&mesh), ["2 normals that are not finite: computed ones are used"]);
    assert_eq!(mesh.corner_normals().expect("normals")[0], [Vec3::ZERO, Vec3::Y, Vec3::ZERO]);
}

#[test]
fn numbers_of_other_languages_are_numbers() {
    let mesh = parsed("v 0.0D+00 0 0\nv 1.0+00 0 0\nv .1+e1 1d0 0\nv 0 +1. 0\nvt 5d-1 0\nf 1/1 2/1 3/1\nf 1 3 4\n");
    let mesh = mesh.expect("a square");
    assert_eq!(area(&mesh), DVec3::Z);
    assert_eq!(mesh.corner_uvs().expect("places")[0], Some([Vec2::new(0.5, 0.0); 3]));
}

/// A small generator, so that every run sees the same bytes (Marsaglia 2003).
struct XorShift(u64);

impl XorShift {
    fn below(&mut self, most: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % most as u64) as usize
    }
}

#[test]
fn no_bytes_panic_and_every_error_is_one_line() {
    let words = [
        "v",
        "vn",
        "vt",
        "f",
        "l",
        "g",
        "o",
        "usemtl",
        "mtllib",
        "\n",
        "\n",
        "\n",
        "1",
        "2",
        "3",
        "-1",
        "-2",
        "0",
        "1//1",
        "1/1/1",
        "//",
        "1e308",
        "-1e308",
        "nan",
        "x",
        "\\",
        "#",
        "\t",
        "\u{2003}",
        "é",
        "9999999999",
        "1//-9",
    ];
    let mut random = XorShift(0x9e37_79b9_7f4a_7c15);
    let mut outcomes = [0, 0];
    for _ in 0..4000 {
        // Models with only a few changed words are valid at times; the others hardly ever.
        let (begun, most) = match random.below(3) {
            0 => (SQUARE.to_owned(), 60),
            1 => ("vn 0 0 1\n".to_owned(), 60),
            _ => (format!("{SQUARE}f 1 2 3\n"), 6),
        };
        let mut text = begun;
        for _ in 0..random.below(most) {
            text += words[random.below(words.len())];
            text.push(if random.below(8) == 0 { '\n' } else { ' ' });
        }
        let reason = parsed(&text).err();
        outcomes[usize::from(reason.is_some())] += 1;
        assert!(reason.as_ref().is_none_or(|reason| !reason.contains('\n')), "{reason:?}");
    }
    assert!(outcomes.iter().all(|count| *count > 100), "{outcomes:?}");
    let file = tempfile::NamedTempFile::new().expect("a file");
    for _ in 0..300 {
        let bytes: Vec<u8> = (0..random.below(400)).map(|_| random.below(256) as u8).collect();
        std::fs::write(file.path(), &bytes).expect("written");
        if let Err(error) = load(file.path()) {
            assert!(!error.to_string().contains('\n'), "{error}");
        }
    }
}

#[test]
fn files_that_are_no_text_say_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("model.obj");
    let error_of = |path: &Path| load(path).expect_err("broken").to_string();
    assert!(error_of(&file).contains("no such file"));
    assert!(error_of(folder.path()).contains("is a folder"));
    std::fs::write(&file, b"  \n").expect("written");
    assert!(error_of(&file).contains("is empty"));
    std::fs::write(&file, b"v 0 0 0\n\xff\xfe\x00").expect("written");
    assert!(error_of(&file).contains("not a text file"));
}

/// Files of programs without UTF-8: names stay distinct, and are found in their library.
#[test]
fn names_and_comments_may_be_in_latin_1() {
    let folder = tempfile::tempdir().expect("a folder");
    let put = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).expect("written");
    put("farben.mtl", b"# T\xfcr\nnewmtl gr\xfcn\nKd 0 1 0\nnewmtl gr\xe4u\nKd 0.5 0.5 0.5\n");
    let faces = b"usemtl gr\xfcn\nf 1 2 3\nusemtl gr\xe4u\nf 1 3 4\n";
    put("haus.obj", &[b"# caf\xe9\nmtllib farben.mtl\n", SQUARE.as_bytes(), faces].concat());
    let mesh = load(&folder.path().join("haus.obj")).expect("a mesh");
    let color = |group: usize| mesh.groups()[group].material.expect("a material").color;
    assert_eq!([color(0), color(1)], [[0.0, 1.0, 0.0], [0.5; 3]]);
}

/// Whatever wrote it: the mesh is the same.
#[test]
fn models_in_utf_16_or_with_line_ends_of_old_macs_are_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("model.obj");
    let text = format!("# caf\u{e9} \u{1f4a1}\n{SQUARE}g \u{e9}\nf 1 2 3\n");
    let expected = parsed(&text).expect("a mesh");
    let units = || format!("\u{feff}{text}").encode_utf16().collect::<Vec<u16>>();
    let cases = [
        text.clone().into_bytes(),
        units().into_iter().flat_map(u16::to_le_bytes).collect(),
        units().into_iter().flat_map(u16::to_be_bytes).collect(),
        text.replace('\n', "\r").into_bytes(),
        text.replace('\n', "\r\n").into_bytes(),
    ];
    for bytes in cases {
        std::fs::write(&file, bytes).expect("written");
        assert_eq!(load(&file).expect("a mesh"), expected);
    }
    std::fs::write(&file, b"\xff\xfe\x00\x00v").expect("written");
    let error = load(&file).expect_err("no text").to_string();
    assert!(error.contains("is in UTF-16: save the OBJ model in UTF-8"), "{error}");
}

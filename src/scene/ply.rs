//! PLY models (`.ply`), as text or binary: one mesh of the elements `vertex`, `face` and `tristrips`.
//!
//! The header is split off first, since its comments may be in any encoding. Then `ply_rs_bw` reads it, and element after
//! element, none of which is kept: a row of numbers becomes a vertex or the corners of a face at once. What else a file
//! holds is named ([`NotTaken`](super::NotTaken)).

use super::mesh::is_usable_uv;
use super::not_taken::Refusals;
use super::read_text::{MOST_TEXT, decoded, quoted};
use super::{Mesh, MeshBuilder, SceneError, polygon};
use crate::files::{ReadError, read_plain};
use glam::{DVec2, DVec3, Vec2, Vec3};
use ply_rs_bw::parser::{self, Parser};
use ply_rs_bw::ply::{ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult};
use std::ops::Range;
use std::path::Path;

/// Bytes of the longest header that is looked for an end.
const MOST_HEADER: usize = 1 << 20;
/// Texture coordinates of vertices, by the programs that write them.
const UV_NAMES: [[&str; 2]; 3] = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"]];
const NORMAL: [&str; 3] = ["nx", "ny", "nz"];
/// How the names of colours end: `diffuse_red` is one, too.
const COLORS: [&str; 4] = ["red", "green", "blue", "alpha"];
/// The list that faces and strips have of their corners.
const CORNER_NAMES: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Loads a model as one mesh. It has corner normals if its vertices have them.
///
/// # Errors
/// A file that can't be read or has no faces; a header or an element that can't be understood, where there are lines with its
/// line; fewer elements than the header says, a face of fewer than three corners, an index out of range, a number that is
/// not finite.
pub fn load(file: &Path) -> Result<Mesh, SceneError> {
    read(file).map_err(|problem| match problem {
        Problem::Line(line, reason) => SceneError::Line { file: file.to_owned(), line, reason },
        Problem::File(reason) => SceneError::Read { file: file.to_owned(), reason },
    })
}

/// What is wrong with a file.
enum Problem {
    /// Of a line, counted from 1.
    Line(usize, String),
    File(String),
}

fn read(file: &Path) -> Result<Mesh, Problem> {
    let bytes = read_plain(file, MOST_TEXT).map_err(|error| match error {
        ReadError::Folder => Problem::File("is a folder: name a PLY model in it".to_owned()),
        other => Problem::File(other.to_string()),
    })?;
    let (header, payload) = split_header(&bytes).map_err(|reason| Problem::File(reason.to_owned()))?;
    let text = decoded(header.to_vec());
    let header = Parser::<Row>::new().read_header(&mut parser::Reader::new(text.as_bytes())).map_err(|error| {
        let line = |line: usize| text.lines().nth(line - 1).unwrap_or_default();
        let of_line =
            |at| Problem::Line(at, format!("{} is no line of a PLY header: export the file again", quoted(line(at))));
        let of_file = || Problem::File("has no line `format` in its header: export the file again".to_owned());
        error.line().map_or_else(of_file, of_line)
    })?;
    let mut rows =
        Rows { encoding: &header.encoding, rest: payload, line: text.lines().count(), parser: Parser::new() };
    let surface = Surface::read(&header, &mut rows)?;
    let mut refusals = Refusals::default();
    name_rest(&header, &mut refusals);
    let mesh = surface.build()?.without(refusals.into_list());
    if mesh.triangles().is_empty() {
        return Err(Problem::File("has no triangle with three different corners: export its surface".to_owned()));
    }
    Ok(mesh)
}

/// The header with its last line, and what follows it.
fn split_header(bytes: &[u8]) -> Result<(&[u8], &[u8]), &'static str> {
    if bytes.is_empty() {
        return Err("is empty: give a PLY model with content");
    }
    let mut end = 0;
    for line in bytes[..bytes.len().min(MOST_HEADER)].split_inclusive(|byte| *byte == b'\n') {
        if end == 0 && line.trim_ascii() != b"ply" {
            return Err("is no PLY model: its first line is not `ply`");
        }
        end += line.len();
        if line.trim_ascii() == b"end_header" {
            return Ok(bytes.split_at(end));
        }
    }
    Err("has no end of its header, a line `end_header`: export the file again")
}

/// What one element says of what is taken: a vertex, a face or a strip.
#[derive(Debug, Default)]
struct Row {
    position: [f64; 3],
    normal: [f64; 3],
    uv: [f64; 2],
    /// −1 ends a strip.
    corners: Vec<i64>,
    /// Two numbers a corner of a face.
    corner_uvs: Vec<f64>,
}

impl PropertyAccess for Row {
    fn new() -> Row {
        Row::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let place = match name {
            "x" => &mut self.position[0],
            "y" => &mut self.position[1],
            "z" => &mut self.position[2],
            "nx" => &mut self.normal[0],
            "ny" => &mut self.normal[1],
            "nz" => &mut self.normal[2],
            name if UV_NAMES.iter().any(|[u, _]| *u == name) => &mut self.uv[0],
            name if UV_NAMES.iter().any(|[_, v]| *v == name) => &mut self.uv[1],
            name if CORNER_NAMES.contains(&name) => {
                return match integers(property) {
                    Some(corners) => set(&mut self.corners, corners),
                    None => PropertyAccessResult::UnsupportedType,
                };
            }
            "texcoord" => {
                return match property {
                    Property::ListFloat(numbers) => {
                        set(&mut self.corner_uvs, numbers.into_iter().map(f64::from).collect())
                    }
                    Property::ListDouble(numbers) => set(&mut self.corner_uvs, numbers),
                    _ => PropertyAccessResult::Ignored,
                };
            }
            _ => return PropertyAccessResult::Ignored,
        };
        match number(&property) {
            Some(number) => set(place, number),
            None => PropertyAccessResult::UnsupportedType,
        }
    }
}

fn set<T>(place: &mut T, value: T) -> PropertyAccessResult {
    *place = value;
    PropertyAccessResult::Set
}

/// `None` of a list.
fn number(property: &Property) -> Option<f64> {
    match property {
        Property::Char(number) => Some(f64::from(*number)),
        Property::UChar(number) => Some(f64::from(*number)),
        Property::Short(number) => Some(f64::from(*number)),
        Property::UShort(number) => Some(f64::from(*number)),
        Property::Int(number) => Some(f64::from(*number)),
        Property::UInt(number) => Some(f64::from(*number)),
        Property::Float(number) => Some(f64::from(*number)),
        Property::Double(number) => Some(*number),
        _ => None,
    }
}

/// `None` of anything but a list of whole numbers.
fn integers(property: Property) -> Option<Vec<i64>> {
    fn of<T: Into<i64>>(numbers: Vec<T>) -> Option<Vec<i64>> {
        Some(numbers.into_iter().map(T::into).collect())
    }
    match property {
        Property::ListChar(numbers) => of(numbers),
        Property::ListUChar(numbers) => of(numbers),
        Property::ListShort(numbers) => of(numbers),
        Property::ListUShort(numbers) => of(numbers),
        Property::ListInt(numbers) => of(numbers),
        Property::ListUInt(numbers) => of(numbers),
        _ => None,
    }
}

/// Reads elements one after the other.
struct Rows<'a> {
    encoding: &'a Encoding,
    rest: &'a [u8],
    /// Lines that were read, where there are lines.
    line: usize,
    parser: Parser<Row>,
}

impl<'a> Rows<'a> {
    /// The next element, the one `at` this place among its kind.
    fn next(&mut self, element: &ElementDef, at: usize) -> Result<Row, Problem> {
        let ends = || {
            let ElementDef { name, count, .. } = element;
            Problem::File(format!("ends after {at} of {count} elements {}: export it again", quoted(name)))
        };
        let read = match self.encoding {
            Encoding::Ascii => {
                let line = self.line().ok_or_else(ends)?;
                let text = str::from_utf8(line).unwrap_or_default();
                return self.parser.read_ascii_element(text, element).map_err(|_| {
                    let known: Vec<&str> = element.properties.keys().map(String::as_str).collect();
                    let known = quoted(&known.join(" "));
                    let text = quoted(String::from_utf8_lossy(line).trim());
                    Problem::Line(
                        self.line,
                        format!("{text} are not the numbers of {}, {known}: correct it", quoted(&element.name)),
                    )
                });
            }
            Encoding::BinaryBigEndian => self.parser.read_big_endian_element(&mut self.rest, element),
            Encoding::BinaryLittleEndian => self.parser.read_little_endian_element(&mut self.rest, element),
        };
        read.map_err(|error| match error.kind() {
            std::io::ErrorKind::UnexpectedEof => ends(),
            _ => {
                let name = quoted(&element.name);
                Problem::File(format!("has an element {name}, number {at} from 0, that can't be read: export it again"))
            }
        })
    }

    /// The next line with anything on it.
    fn line(&mut self) -> Option<&'a [u8]> {
        while !self.rest.is_empty() {
            let end = self.rest.iter().position(|byte| *byte == b'\n').map_or(self.rest.len(), |end| end + 1);
            let (line, rest) = self.rest.split_at(end);
            (self.rest, self.line) = (rest, self.line + 1);
            if !line.trim_ascii().is_empty() {
                return Some(line);
            }
        }
        None
    }
}

/// Vertices and faces as the file has them.
#[derive(Default)]
struct Surface {
    positions: Vec<DVec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    /// Of all faces, one after the other.
    corners: Vec<i64>,
    /// Parallel to `corners`, or empty.
    corner_uvs: Vec<Vec2>,
    faces: Vec<Range<usize>>,
    strips: Vec<Range<usize>>,
}

impl Surface {
    fn read(header: &Header, rows: &mut Rows) -> Result<Surface, Problem> {
        let mut surface = Surface::default();
        if !has(header, "vertex", &["x", "y", "z"]) {
            return Err(Problem::File("has no vertices with x, y and z: export its surface".to_owned()));
        }
        let has_normals = has(header, "vertex", &NORMAL);
        let has_uvs = UV_NAMES.iter().any(|names| has(header, "vertex", names));
        let has_corner_uvs = has(header, "face", &["texcoord"]);
        for element in header.elements.values().filter(|element| !element.properties.is_empty()) {
            // Each takes a byte or more: this many are not there.
            if element.count > rows.rest.len() {
                let (count, name) = (element.count, quoted(&element.name));
                return Err(Problem::File(format!("is too short for {count} elements {name}: export it again")));
            }
            for at in 0..element.count {
                let row = rows.next(element, at)?;
                match element.name.as_str() {
                    "vertex" => {
                        surface.positions.push(DVec3::from_array(row.position));
                        surface.normals.extend(has_normals.then(|| usable(DVec3::from_array(row.normal).as_vec3())));
                        surface.uvs.extend(has_uvs.then(|| DVec2::from_array(row.uv).as_vec2()));
                    }
                    "face" => {
                        if row.corners.len() < 3 {
                            let count = row.corners.len();
                            let reason =
                                format!("has {count} corners at face {at}, counted from 0: a face has three or more");
                            return Err(Problem::File(reason));
                        }
                        let start = surface.corners.len();
                        surface.corners.extend(&row.corners);
                        surface.faces.push(start..surface.corners.len());
                        if has_corner_uvs {
                            let uvs =
                                row.corner_uvs.as_chunks::<2>().0.iter().map(|uv| DVec2::from_array(*uv).as_vec2());
                            // One that is missing is none that can be used.
                            let uvs = uvs.chain(std::iter::repeat(Vec2::NAN));
                            surface.corner_uvs.extend(uvs.take(row.corners.len()));
                        }
                    }
                    "tristrips" => {
                        for strip in row.corners.split(|corner| *corner == -1) {
                            let start = surface.corners.len();
                            surface.corners.extend(strip);
                            surface
                                .corner_uvs
                                .extend(has_corner_uvs.then(|| vec![Vec2::NAN; strip.len()]).into_iter().flatten());
                            surface.strips.push(start..surface.corners.len());
                        }
                    }
                    _ => {}
                }
            }
        }
        if surface.corners.is_empty() {
            return Err(Problem::File("has no faces: export its surface".to_owned()));
        }
        Ok(surface)
    }

    fn build(self) -> Result<Mesh, Problem> {
        let count = self.positions.len();
        if let Some(corner) = self.corners.iter().find(|corner| !(0..count as i64).contains(corner)) {
            return Err(Problem::File(format!("uses vertex {corner} of {count}, counted from 0: export it again")));
        }
        let mut builder = MeshBuilder::default();
        for face in &self.faces {
            let corners: Vec<DVec3> = face.clone().map(|corner| self.position(corner)).collect();
            for triangle in polygon::triangulate(&corners) {
                self.add(triangle.map(|corner| face.start + corner), &mut builder);
            }
        }
        for strip in &self.strips {
            for triangle in polygon::strip(strip.len()) {
                self.add(triangle.map(|corner| strip.start + corner), &mut builder);
            }
        }
        builder.positions = self.positions;
        builder.build().map_err(|error| Problem::File(error.to_string()))
    }

    fn vertex(&self, corner: usize) -> usize {
        self.corners[corner] as usize
    }

    fn position(&self, corner: usize) -> DVec3 {
        self.positions[self.vertex(corner)]
    }

    /// Adds a triangle of these corners.
    fn add(&self, corners: [usize; 3], builder: &mut MeshBuilder) {
        builder.triangles.push(corners.map(|corner| self.vertex(corner) as u32));
        if !self.normals.is_empty() {
            builder.corner_normals.push(corners.map(|corner| self.normals[self.vertex(corner)]));
        }
        let uvs = match (self.corner_uvs.is_empty(), self.uvs.is_empty()) {
            (false, _) => corners.map(|corner| self.corner_uvs[corner]),
            (true, false) => corners.map(|corner| self.uvs[self.vertex(corner)]),
            (true, true) => return,
        };
        builder.corner_uvs.push(uvs.iter().all(is_usable_uv).then_some(uvs));
    }
}

/// Have elements of this kind all of these properties?
fn has(header: &Header, element: &str, properties: &[&str]) -> bool {
    let element = header.elements.get(element);
    element.is_some_and(|element| properties.iter().all(|name| element.properties.contains_key(*name)))
}

/// Names what the file holds and no mesh does.
fn name_rest(header: &Header, refusals: &mut Refusals) {
    for element in header.elements.values().filter(|element| element.count > 0) {
        let name = element.name.as_str();
        let taken: Vec<&str> = match name {
            "vertex" => ["x", "y", "z"].into_iter().chain(NORMAL).chain(UV_NAMES.into_iter().flatten()).collect(),
            "face" => CORNER_NAMES.into_iter().chain(["texcoord"]).collect(),
            "tristrips" => CORNER_NAMES.to_vec(),
            _ => {
                let what = format!("{} elements {}", element.count, quoted(name));
                refusals.refuse(what, "a mesh is of vertices, faces and strips");
                continue;
            }
        };
        for property in element.properties.keys().filter(|property| !taken.contains(&property.as_str())) {
            if COLORS.iter().any(|color| property.ends_with(color)) {
                refusals.refuse(format!("colours of {}", quoted(name)), "a surface has its material's colour");
            } else {
                let what = format!("{} of {}", quoted(property), quoted(name));
                refusals.refuse(what, "only places, normals and texture coordinates are taken");
            }
        }
    }
    for picture in header.comments.iter().filter_map(|comment| comment.strip_prefix("TextureFile")) {
        let because = "name it as the `texture` of the object's material in a scene file";
        refusals.refuse(format!("the picture {}", quoted(picture.trim())), because);
    }
}

/// A normal that is none is the triangle's own.
fn usable(normal: Vec3) -> Vec3 {
    if normal.is_finite() { normal } else { Vec3::ZERO }
}

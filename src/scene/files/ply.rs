//! PLY models (`.ply`), as text or binary: one mesh of the elements `vertex`, `face` and `tristrips`.
//!
//! The header is split off first, since its comments may be in any encoding; `ply_rs_bw` reads it. It decides which
//! properties of each element are read, types and all ([`PlyProperties`]). Then row after row becomes a vertex or the
//! corners of a face: binary ones are read by `ply_rs_bw`, those of text here, as it accepts no `.5` and no `nan`. What
//! else a file contains is listed ([`Unsupported`](crate::scene::Unsupported)).

use super::polygon;
use super::read_text::{MOST_TEXT, decoded, quoted};
use crate::files::{ReadError, read_plain};
use crate::scene::mesh::is_usable_uv;
use crate::scene::not_taken::UnsupportedList;
use crate::scene::{FileProblem, Mesh, MeshBuilder, SceneError};
use glam::{DVec2, DVec3, Vec2, Vec3};
use ply_rs_bw::parser::{self, Parser};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};
use std::io::ErrorKind;
use std::path::Path;

/// Bytes within which the end of a header is searched for.
const MOST_HEADER: usize = 1 << 20;
const PLACE: [&str; 3] = ["x", "y", "z"];
const NORMAL: [&str; 3] = ["nx", "ny", "nz"];
/// Names of vertices' texture coordinates, by the programs that write them.
const UVS: [[&str; 2]; 3] = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"]];
/// Names of the list of corners of faces and strips.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];
/// Name of the texture coordinates of a face's corners.
const CORNER_UVS: &str = "texcoord";
const COLORS: [&str; 4] = ["red", "green", "blue", "alpha"];

/// Loads a model as one mesh. It has corner normals if its vertices have them.
///
/// # Errors
/// A file that can't be read or has no faces; a header or an element that can't be understood, where there are lines with its
/// line; fewer elements than the header says, a face of fewer than three corners, an index out of range, a place that is not
/// finite.
pub fn load(file: &Path) -> Result<Mesh, SceneError> {
    read(file).map_err(|problem| problem.of(file))
}

fn read(file: &Path) -> Result<Mesh, FileProblem> {
    let bytes = read_plain(file, MOST_TEXT).map_err(|error| match error {
        ReadError::Folder => FileProblem::File("is a folder: name a PLY model in it".to_owned()),
        other => FileProblem::File(other.to_string()),
    })?;
    let (head, payload) = split_header(&bytes).map_err(|reason| FileProblem::File(reason.to_owned()))?;
    let head = decoded(head.to_vec());
    let header = header(&head)?;
    let wanted = PlyProperties::of(&header)?;
    let mut rows = PlyRows { encoding: &header.encoding, rest: payload, line: head.lines().count() };
    let surface = PlySurface::read(&header, &wanted, &mut rows)?;
    drop(bytes);
    let mesh = surface.build().map_err(FileProblem::File)?;
    if mesh.triangles().is_empty() {
        return Err(FileProblem::no_triangles());
    }
    Ok(mesh.without(not_taken(&header, &wanted).into_list()))
}

/// Splits a PLY file after its header's last line, `end_header`; an error where it is empty, does not begin with `ply`,
/// or has no end of the header within a limit.
fn split_header(bytes: &[u8]) -> Result<(&[u8], &[u8]), &'static str> {
    if bytes.is_empty() {
        return Err("is empty: give a PLY model with content");
    }
    let mut end = 0;
    for line in bytes[..bytes.len().min(MOST_HEADER)].split_inclusive(|byte| *byte == b'\n') {
        match line.trim_ascii() {
            line if end == 0 && line.starts_with(b"ply\r") => {
                return Err("has lines that end as on old Macs: save it with line feeds");
            }
            line if end == 0 && line != b"ply" => return Err("is no PLY model: its first line is not `ply`"),
            b"end_header" => return Ok(bytes.split_at(end + line.len())),
            _ => end += line.len(),
        }
    }
    Err("has no end of its header, a line `end_header`: export the file again")
}

fn header(text: &str) -> Result<Header, FileProblem> {
    let line = |at: usize| quoted(text.lines().nth(at - 1).unwrap_or_default().trim());
    let wrong = |at: usize| {
        FileProblem::Line(at, format!("{} can't stand there in a PLY header: export the file again", line(at)))
    };
    let no_format =
        || FileProblem::File("has no `format` in its header that is known: export the file again".to_owned());
    let header = Parser::<PlyRow>::new()
        .read_header(&mut parser::Reader::new(text.as_bytes()))
        .map_err(|error| error.line().map_or_else(no_format, wrong))?;
    // Of two properties with one name `ply_rs_bw` stores only one, and the rows would be read wrongly.
    let begin = |word: &str| text.lines().filter(|line| line.split_ascii_whitespace().next() == Some(word)).count();
    let properties = header.elements.values().map(|element| element.properties.len()).sum();
    if [begin("element"), begin("property")] != [header.elements.len(), properties] {
        return Err(FileProblem::File("has two elements or properties of one name: export the file again".to_owned()));
    }
    Ok(header)
}

/// The properties that are read from a file: all of them exist, and have a type that can be used.
struct PlyProperties {
    has_normals: bool,
    /// Index in [`UVS`].
    uvs: Option<usize>,
    has_corner_uvs: bool,
}

impl PlyProperties {
    fn of(header: &Header) -> Result<PlyProperties, FileProblem> {
        let kind = |element: &str, name: &str| {
            header.elements.get(element)?.properties.get(name).map(|property| &property.data_type)
        };
        let are_numbers =
            |names: &[&str]| names.iter().all(|name| matches!(kind("vertex", name), Some(PropertyType::Scalar(_))));
        if !are_numbers(&PLACE) {
            return Err(FileProblem::File("has no vertices with numbers x, y and z: export its surface".to_owned()));
        }
        for element in ["face", "tristrips"].into_iter().filter(|name| header.elements.contains_key(*name)) {
            let lists: Vec<&PropertyType> = CORNERS.iter().filter_map(|name| kind(element, name)).collect();
            if !matches!(lists[..], [PropertyType::List(_, of)] if !is_fraction(of)) {
                let reason = format!(
                    "has no one list `vertex_indices` of whole numbers in {}: export it again",
                    quoted(element)
                );
                return Err(FileProblem::File(reason));
            }
        }
        Ok(PlyProperties {
            has_normals: are_numbers(&NORMAL),
            uvs: UVS.iter().position(|names| are_numbers(names)),
            has_corner_uvs: matches!(kind("face", CORNER_UVS), Some(PropertyType::List(_, of)) if is_fraction(of)),
        })
    }

    /// Returns whether this property of this element is read: positions, normals and texture coordinates of vertices,
    /// and corners of faces and strips.
    fn takes(&self, element: &str, property: &str) -> bool {
        match element {
            "vertex" => {
                let uvs = self.uvs.map(|pair| UVS[pair]).into_iter().flatten();
                let normal = NORMAL.into_iter().filter(|_| self.has_normals);
                PLACE.into_iter().chain(normal).chain(uvs).any(|name| name == property)
            }
            "face" => CORNERS.contains(&property) || (self.has_corner_uvs && property == CORNER_UVS),
            "tristrips" => CORNERS.contains(&property),
            _ => false,
        }
    }
}

fn is_fraction(of: &ScalarType) -> bool {
    matches!(of, ScalarType::Float | ScalarType::Double)
}

/// Returns what the file contains and no mesh stores: other elements, colours and other properties, and pictures that
/// its comments name.
fn not_taken(header: &Header, wanted: &PlyProperties) -> UnsupportedList {
    let mut refusals = UnsupportedList::default();
    for element in header.elements.values().filter(|element| element.count > 0) {
        let name = quoted(&element.name);
        if !["vertex", "face", "tristrips"].contains(&element.name.as_str()) {
            refusals.refuse(format!("{} elements {name}", element.count), "a mesh is of vertices, faces and strips");
            continue;
        }
        let names = element.properties.keys().map(String::as_str);
        for property in names.filter(|property| !wanted.takes(&element.name, property)) {
            let last = property.rsplit('_').next().unwrap_or_default();
            if COLORS.contains(&last) {
                refusals.refuse(format!("colours of {name}"), "a surface has its material's colour");
            } else {
                let because = "only places, normals and texture coordinates are taken";
                refusals.refuse(format!("{} of {name}", quoted(property)), because);
            }
        }
    }
    for picture in header.comments.iter().filter_map(|comment| comment.strip_prefix("TextureFile")) {
        let because = "name it as the `texture` of the object's material in a scene file";
        refusals.refuse(format!("the picture {}", quoted(picture.trim())), because);
    }
    refusals
}

/// The values of one element, whichever are read: a vertex, a face or a strip.
#[derive(Debug, Default)]
struct PlyRow {
    place: [f64; 3],
    normal: [f64; 3],
    /// In the order of [`UVS`].
    uvs: [[f64; 2]; 3],
    /// −1 ends a strip.
    corners: Vec<i64>,
    /// Two numbers for each corner of a face.
    corner_uvs: Vec<f64>,
}

impl PlyRow {
    /// Returns where a vertex's number of this property name is stored; `None` for a property that is not read.
    fn number(&mut self, name: &str) -> Option<&mut f64> {
        let at = |names: &[&str]| names.iter().position(|known| *known == name);
        if let Some(axis) = at(&PLACE) {
            return Some(&mut self.place[axis]);
        }
        if let Some(axis) = at(&NORMAL) {
            return Some(&mut self.normal[axis]);
        }
        let axis = at(&UVS.concat())?;
        Some(&mut self.uvs[axis / 2][axis % 2])
    }
}

impl PropertyAccess for PlyRow {
    fn new() -> PlyRow {
        PlyRow::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        match property {
            Property::ListFloat(numbers) if name == CORNER_UVS => {
                self.corner_uvs = numbers.into_iter().map(f64::from).collect();
            }
            Property::ListDouble(numbers) if name == CORNER_UVS => self.corner_uvs = numbers,
            property if CORNERS.contains(&name) => self.corners = integers(property),
            property => match (self.number(name), number(&property)) {
                (Some(place), Some(number)) => *place = number,
                _ => return PropertyAccessResult::Ignored,
            },
        }
        PropertyAccessResult::Set
    }
}

/// An element of which nothing is read.
struct SkippedElement;

impl PropertyAccess for SkippedElement {
    fn new() -> SkippedElement {
        SkippedElement
    }
}

/// Returns a property's number as a float; `None` for a list.
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

/// Returns a property's list of whole numbers; empty for anything else, also for lists of floats.
fn integers(property: Property) -> Vec<i64> {
    fn of<T: Into<i64>>(numbers: Vec<T>) -> Vec<i64> {
        numbers.into_iter().map(T::into).collect()
    }
    match property {
        Property::ListChar(numbers) => of(numbers),
        Property::ListUChar(numbers) => of(numbers),
        Property::ListShort(numbers) => of(numbers),
        Property::ListUShort(numbers) => of(numbers),
        Property::ListInt(numbers) => of(numbers),
        Property::ListUInt(numbers) => of(numbers),
        _ => Vec::new(),
    }
}

/// Reads elements one after the other.
struct PlyRows<'a> {
    encoding: &'a Encoding,
    rest: &'a [u8],
    /// The number of lines that were read, where there are lines.
    line: usize,
}

impl<'a> PlyRows<'a> {
    /// Reads the next element, number `at` of its kind (counted from 0), as text or binary, and advances; text is
    /// parsed by `of_text`. An error where the file ends or the element does not match the header.
    fn next<E: PropertyAccess>(
        &mut self,
        element: &ElementDef,
        at: usize,
        of_text: impl Fn(&str, &ElementDef) -> Option<E>,
    ) -> Result<E, FileProblem> {
        let ElementDef { name, count, .. } = element;
        let ends =
            || FileProblem::File(format!("ends after {at} of {count} elements {}: export it again", quoted(name)));
        let parser = Parser::<E>::new();
        let read = match self.encoding {
            Encoding::Ascii => {
                let line = self.line().ok_or_else(ends)?;
                return str::from_utf8(line).ok().and_then(|line| of_text(line, element)).ok_or_else(|| {
                    let line = quoted(String::from_utf8_lossy(line).trim());
                    let known: Vec<&str> = element.properties.keys().map(String::as_str).collect();
                    let known = quoted(&known.join(" "));
                    FileProblem::Line(
                        self.line,
                        format!("{line} does not hold {known} of {}: correct it", quoted(name)),
                    )
                });
            }
            Encoding::BinaryBigEndian => parser.read_big_endian_element(&mut self.rest, element),
            Encoding::BinaryLittleEndian => parser.read_little_endian_element(&mut self.rest, element),
        };
        read.map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => ends(),
            _ => {
                let name = quoted(name);
                FileProblem::File(format!("can't be read at element {at} of {name}, counted from 0: export it again"))
            }
        })
    }

    /// Returns the next line that is not blank, with its line end, and counts the lines passed over; `None` at the end.
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

    /// Returns the error about the element that was read last, number `at` of its kind: with its line for a text file,
    /// otherwise with its number.
    fn wrong(&self, what: &str, at: usize, reason: &str) -> FileProblem {
        match self.encoding {
            Encoding::Ascii => FileProblem::Line(self.line, format!("the {what} {reason}")),
            _ => FileProblem::File(format!("has a {what}, number {at} counted from 0, that {reason}")),
        }
    }
}

/// Parses a line of text as an element, passing over properties that are not read; `None` where a number is missing or
/// is none. Words after the last property are ignored.
fn row_of_text(line: &str, element: &ElementDef) -> Option<PlyRow> {
    let mut row = PlyRow::default();
    let mut words = line.split_ascii_whitespace();
    for (name, property) in &element.properties {
        match &property.data_type {
            PropertyType::Scalar(_) => {
                let given: f64 = words.next()?.parse().ok()?;
                if let Some(place) = row.number(name) {
                    *place = given;
                }
            }
            PropertyType::List(..) => {
                let count: usize = words.next()?.parse().ok()?;
                let mut list = (0..count).map(|_| words.next());
                if CORNERS.contains(&name.as_str()) {
                    row.corners = list.map(|word| word?.parse().ok()).collect::<Option<_>>()?;
                } else if name == CORNER_UVS {
                    row.corner_uvs = list.map(|word| word?.parse().ok()).collect::<Option<_>>()?;
                } else if list.any(|word| word.is_none()) {
                    return None;
                }
            }
        }
    }
    Some(row)
}

/// The corners of a face or of a strip.
struct PlyCorners {
    count: u32,
    is_strip: bool,
}

/// Vertices and faces as the file has them.
#[derive(Default)]
struct PlySurface {
    positions: Vec<DVec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    /// Corners of all runs, one after the other.
    corners: Vec<u32>,
    /// Texture coordinates parallel to `corners`, or empty; unusable ones are replaced by the vertex's.
    corner_uvs: Vec<Vec2>,
    runs: Vec<PlyCorners>,
}

impl PlySurface {
    fn read(header: &Header, wanted: &PlyProperties, rows: &mut PlyRows) -> Result<PlySurface, FileProblem> {
        let mut surface = PlySurface::default();
        for element in header.elements.values().filter(|element| !element.properties.is_empty()) {
            // Each takes a byte or more: the file can't contain so many.
            if element.count > rows.rest.len() {
                let (count, name) = (element.count, quoted(&element.name));
                return Err(FileProblem::File(format!("is too short for {count} elements {name}: export it again")));
            }
            for at in 0..element.count {
                match element.name.as_str() {
                    "vertex" => surface.add_vertex(&rows.next(element, at, row_of_text)?, wanted),
                    "face" => {
                        let row: PlyRow = rows.next(element, at, row_of_text)?;
                        if row.corners.len() < 3 {
                            let reason = format!("has {} corners: a face needs three or more", row.corners.len());
                            return Err(rows.wrong("face", at, &reason));
                        }
                        let added = surface.add_run(&row.corners, false);
                        added.map_err(|reason| rows.wrong("face", at, &reason))?;
                        if wanted.has_corner_uvs {
                            let uvs =
                                row.corner_uvs.as_chunks::<2>().0.iter().map(|uv| DVec2::from_array(*uv).as_vec2());
                            surface.corner_uvs.extend(uvs.take(row.corners.len()));
                            surface.corner_uvs.resize(surface.corners.len(), Vec2::NAN);
                        }
                    }
                    "tristrips" => {
                        let row: PlyRow = rows.next(element, at, row_of_text)?;
                        for strip in row.corners.split(|corner| *corner == -1) {
                            let added = surface.add_run(strip, true);
                            added.map_err(|reason| rows.wrong("strip", at, &reason))?;
                        }
                        if wanted.has_corner_uvs {
                            surface.corner_uvs.resize(surface.corners.len(), Vec2::NAN);
                        }
                    }
                    _ => {
                        let SkippedElement = rows.next(element, at, |_, _| Some(SkippedElement))?;
                    }
                }
            }
        }
        if surface.corners.is_empty() {
            return Err(FileProblem::File("has no faces: export its surface".to_owned()));
        }
        Ok(surface)
    }

    fn add_vertex(&mut self, row: &PlyRow, wanted: &PlyProperties) {
        self.positions.push(DVec3::from_array(row.place));
        if wanted.has_normals {
            let normal = DVec3::from_array(row.normal).as_vec3();
            // A normal that is not finite is replaced by the triangle's own.
            self.normals.push(if normal.is_finite() { normal } else { Vec3::ZERO });
        }
        if let Some(pair) = wanted.uvs {
            self.uvs.push(DVec2::from_array(row.uvs[pair]).as_vec2());
        }
    }

    fn add_run(&mut self, corners: &[i64], is_strip: bool) -> Result<(), String> {
        for corner in corners {
            let no_vertex = |_| format!("uses vertex {corner}, which can't be: correct it, or export the file again");
            self.corners.push(u32::try_from(*corner).map_err(no_vertex)?);
        }
        self.runs.push(PlyCorners { count: corners.len() as u32, is_strip });
        Ok(())
    }

    fn build(mut self) -> Result<Mesh, String> {
        let count = self.positions.len();
        if let Some(corner) = self.corners.iter().find(|corner| **corner as usize >= count) {
            return Err(format!("uses vertex {corner} of {count}, counted from 0: export it again"));
        }
        let mut builder = MeshBuilder::default();
        let (mut first, mut corners) = (0, Vec::new());
        for PlyCorners { count, is_strip } in &self.runs {
            let run = first..first + *count as usize;
            let mut add = |triangle: [usize; 3]| self.add(triangle.map(|corner| run.start + corner), &mut builder);
            if *is_strip {
                polygon::strip(run.len()).for_each(add);
            } else {
                corners.clear();
                corners.extend(self.corners[run.clone()].iter().map(|vertex| self.positions[*vertex as usize]));
                polygon::triangulate(&corners, &mut add);
            }
            first = run.end;
        }
        builder.positions = std::mem::take(&mut self.positions);
        drop(self);
        builder.build().map_err(|error| error.to_string())
    }

    /// Adds the triangle of these corners of the file to `builder`, with normals and texture coordinates where the file
    /// has them; a corner's own coordinates come before its vertex's, and the triangle has none where one can't be
    /// used.
    fn add(&self, corners: [usize; 3], builder: &mut MeshBuilder) {
        let vertices = corners.map(|corner| self.corners[corner]);
        builder.triangles.push(vertices);
        if !self.normals.is_empty() {
            builder.corner_normals.push(vertices.map(|vertex| self.normals[vertex as usize]));
        }
        if !(self.uvs.is_empty() && self.corner_uvs.is_empty()) {
            let of_corner = |corner: usize| self.corner_uvs.get(corner).filter(|uv| is_usable_uv(uv));
            let of_vertex = |corner: usize| self.uvs.get(self.corners[corner] as usize);
            let uvs = corners.map(|corner| of_corner(corner).or(of_vertex(corner)).copied().unwrap_or(Vec2::NAN));
            builder.corner_uvs.push(uvs.iter().all(is_usable_uv).then_some(uvs));
        }
    }
}

//! PLY models (`.ply`), as text or binary: one mesh of the elements `vertex`, `face` and `tristrips`.
//!
//! The header (`header`) is split off first, since its comments may be in any encoding. It decides which properties of
//! each element are read, types and all ([`PlyProperties`]). Then row after row becomes a vertex or the corners of a face:
//! binary ones are read by `ply_rs_bw`, those of text here, as it accepts no `.5` and no `nan`. What else a file contains
//! is listed ([`Unsupported`](crate::scene::Unsupported)).

mod header;

use super::polygon;
use super::read_text::{MOST_TEXT, decoded, number, quoted};
use super::repairs::{Repairs, clear_unused};
use crate::files::{ReadError, read_plain};
use crate::scene::mesh::is_usable_uv;
use crate::scene::{FileProblem, Mesh, MeshBuilder, SceneError};
use glam::{DVec2, DVec3, Vec2, Vec3};
use header::{PlyHeader, PlyProperties};
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType};
use std::io::ErrorKind;
use std::path::Path;

const PLACE: [&str; 3] = ["x", "y", "z"];
const NORMAL: [&str; 3] = ["nx", "ny", "nz"];
/// Names of vertices' texture coordinates, by the programs that write them.
const UVS: [[&str; 2]; 3] = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"]];
/// Names of the list of corners of faces and strips.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];
/// Name of the texture coordinates of a face's corners.
const CORNER_UVS: &str = "texcoord";

/// Loads a model as one mesh. It has corner normals if its vertices have them. Faces of fewer than three corners, and
/// vertices that are not finite and that no face uses, are left out and listed ([`Mesh::not_taken`]).
///
/// # Errors
/// A file that can't be read or has no faces; a header or an element that can't be understood, where there are lines with its
/// line; fewer elements than the header says, an index out of range, a vertex that is not finite and that a face uses.
pub fn load(file: &Path) -> Result<Mesh, SceneError> {
    read(file).map_err(|problem| problem.of(file))
}

fn read(file: &Path) -> Result<Mesh, FileProblem> {
    let mut bytes = read_plain(file, MOST_TEXT).map_err(|error| match error {
        ReadError::Folder => FileProblem::File("is a folder: name a PLY model in it".to_owned()),
        other => FileProblem::File(other.to_string()),
    })?;
    header::unify_line_ends(&mut bytes);
    let (head, payload) = header::split_header(&bytes).map_err(|reason| FileProblem::File(reason.to_owned()))?;
    let head = decoded(head.to_vec());
    let header = PlyHeader::read(&head)?;
    let wanted = PlyProperties::of(&header.header)?;
    let mut rows = PlyRows { encoding: &header.header.encoding, rest: payload, line: head.lines().count() };
    let mut surface = PlySurface::read(&header.header, &wanted, &mut rows)?;
    drop(bytes);
    surface.check()?;
    let mut refusals = header::not_taken(&header, &wanted);
    surface.repairs.record(&mut refusals);
    let mesh = surface.build().map_err(FileProblem::File)?;
    if mesh.triangles().is_empty() {
        return Err(FileProblem::no_triangles());
    }
    Ok(mesh.without(refusals.into_list()))
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
            property => match (self.number(name), scalar(&property)) {
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
fn scalar(property: &Property) -> Option<f64> {
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
                let given = number(words.next()?)?;
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
                    row.corner_uvs = list.map(|word| number(word?)).collect::<Option<_>>()?;
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
    /// Lines of vertices that are not finite, in a text file, in order; empty in a binary one.
    broken_lines: Vec<usize>,
    repairs: Repairs,
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
                    "vertex" => {
                        let is_finite = surface.add_vertex(&rows.next(element, at, row_of_text)?, wanted);
                        if !is_finite && *rows.encoding == Encoding::Ascii {
                            surface.broken_lines.push(rows.line);
                        }
                    }
                    "face" => {
                        let row: PlyRow = rows.next(element, at, row_of_text)?;
                        if row.corners.len() < 3 {
                            surface.repairs.short_faces += 1;
                            continue;
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
            return Err(FileProblem::File("has no faces of three corners or more: export its surface".to_owned()));
        }
        Ok(surface)
    }

    /// Adds a vertex, and returns whether its position is finite.
    fn add_vertex(&mut self, row: &PlyRow, wanted: &PlyProperties) -> bool {
        let position = DVec3::from_array(row.place);
        self.positions.push(position);
        if wanted.has_normals {
            let normal = DVec3::from_array(row.normal).as_vec3();
            self.repairs.broken_normals += usize::from(!normal.is_finite());
            // Zero stands for the triangle's own.
            self.normals.push(if normal.is_finite() { normal } else { Vec3::ZERO });
        }
        if let Some(pair) = wanted.uvs {
            self.uvs.push(DVec2::from_array(row.uvs[pair]).as_vec2());
        }
        position.is_finite()
    }

    /// Checks that every corner's vertex is there and finite, and leaves out vertices that are not finite and not used.
    fn check(&mut self) -> Result<(), FileProblem> {
        let count = self.positions.len();
        if let Some(corner) = self.corners.iter().find(|corner| **corner as usize >= count) {
            let reason = format!("uses vertex {corner} of {count}, counted from 0: export it again");
            return Err(FileProblem::File(reason));
        }
        let corners = self.corners.iter().map(|corner| *corner as usize);
        match clear_unused(&mut self.positions, || corners) {
            Ok(unused) => self.repairs.unused_vertices = unused,
            Err(used) => {
                let earlier = self.positions[..used].iter().filter(|position| !position.is_finite()).count();
                let reason = "is not finite, and a face uses it: replace NaN and infinity by numbers";
                return Err(match self.broken_lines.get(earlier) {
                    Some(line) => FileProblem::Line(*line, format!("vertex {used}, counted from 0, {reason}")),
                    None => FileProblem::File(format!("has a vertex, number {used} counted from 0, that {reason}")),
                });
            }
        }
        Ok(())
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

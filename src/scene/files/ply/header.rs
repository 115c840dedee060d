//! The header of a PLY file: where it ends, what it says of elements, and which of their properties are read.
//!
//! `ply_rs_bw` parses its lines, after those were made comments that begin with no word of PLY, as several programs
//! write comments so.

use super::{CORNER_UVS, CORNERS, NORMAL, PLACE, PlyRow, UVS};
use crate::scene::files::read_text::quoted;
use crate::scene::not_taken::UnsupportedList;
use crate::scene::{FileProblem, nearest};
use ply_rs_bw::parser::{self, Parser};
use ply_rs_bw::ply::{Header, PropertyType, ScalarType};

/// Bytes within which the end of a header is searched for.
const MOST_HEADER: usize = 1 << 20;
const COLORS: [&str; 4] = ["red", "green", "blue", "alpha"];

/// Words that begin a line of a header.
const KEYWORDS: [&str; 7] = ["ply", "format", "comment", "obj_info", "element", "property", "end_header"];
/// Words of a header without which the rows are read wrongly: a line that begins with a word much like one is no comment.
const STRUCTURE: [&str; 3] = ["format", "element", "property"];
/// How many words such a line has.
const LENGTHS: [usize; 2] = [3, 5];

/// Makes line feeds of the carriage returns that end the header's lines in a file of an old Mac; in a text file, all lines'.
pub fn unify_line_ends(bytes: &mut [u8]) {
    const END: &[u8] = b"\rend_header\r";
    const TEXT: &[u8] = b"format ascii";
    if !bytes.starts_with(b"ply\r") || bytes.get(4) == Some(&b'\n') {
        return;
    }
    let within = &bytes[..bytes.len().min(MOST_HEADER)];
    let end = within.windows(END.len()).position(|part| part == END).map_or(within.len(), |at| at + END.len());
    let is_text = bytes[..end].windows(TEXT.len()).any(|part| part == TEXT);
    let lines = if is_text { bytes.len() } else { end };
    bytes[..lines].iter_mut().filter(|byte| **byte == b'\r').for_each(|byte| *byte = b'\n');
}

/// Splits a PLY file after its header's last line, `end_header`; an error where it is empty, does not begin with `ply`,
/// or has no end of the header within a limit.
pub fn split_header(bytes: &[u8]) -> Result<(&[u8], &[u8]), &'static str> {
    if bytes.is_empty() {
        return Err("is empty: give a PLY model with content");
    }
    let mut end = 0;
    for line in bytes[..bytes.len().min(MOST_HEADER)].split_inclusive(|byte| *byte == b'\n') {
        match line.trim_ascii() {
            line if end == 0 && line != b"ply" => return Err("is no PLY model: its first line is not `ply`"),
            b"end_header" => return Ok(bytes.split_at(end + line.len())),
            _ => end += line.len(),
        }
    }
    Err("has no end of its header, a line `end_header`: export the file again")
}

/// A header, and its lines that begin with no word of PLY, without their ends.
pub struct PlyHeader {
    pub header: Header,
    passed_over: Vec<String>,
}

impl PlyHeader {
    /// Reads a header, from `ply` to `end_header`. Empty lines are comments, and so are ones that begin with no word of
    /// PLY; but one that begins nearly as `element`, `property` or `format` does is an error.
    pub fn read(text: &str) -> Result<PlyHeader, FileProblem> {
        let (mut plain, mut passed_over) = (String::with_capacity(text.len()), Vec::new());
        for line in text.lines() {
            let word = line.split_ascii_whitespace().next().unwrap_or_default();
            let is_misspelt = || {
                let has_form = LENGTHS.contains(&line.split_ascii_whitespace().count());
                has_form && nearest(word, &STRUCTURE).is_some()
            };
            if !KEYWORDS.contains(&word) && !is_misspelt() {
                plain += "comment ";
                passed_over.extend((!word.is_empty()).then(|| line.trim().to_owned()));
            }
            plain += line.trim();
            plain.push('\n');
        }
        let wrong = |at: usize| {
            let line = quoted(text.lines().nth(at - 1).unwrap_or_default().trim());
            FileProblem::Line(at, format!("{line} can't stand there in a PLY header: export the file again"))
        };
        let no_format =
            || FileProblem::File("has no `format` in its header that is known: export the file again".to_owned());
        let header = Parser::<PlyRow>::new()
            .read_header(&mut parser::Reader::new(plain.as_bytes()))
            .map_err(|error| error.line().map_or_else(no_format, wrong))?;
        // Of two properties with one name `ply_rs_bw` stores only one, and the rows would be read wrongly.
        let begin = |word: &str| text.lines().filter(|line| line.split_ascii_whitespace().next() == Some(word)).count();
        let properties = header.elements.values().map(|element| element.properties.len()).sum();
        if [begin("element"), begin("property")] != [header.elements.len(), properties] {
            let reason = "has two elements or properties of one name: export the file again";
            return Err(FileProblem::File(reason.to_owned()));
        }
        Ok(PlyHeader { header, passed_over })
    }
}

/// The properties that are read from a file: all of them exist, and have a type that can be used.
pub struct PlyProperties {
    pub has_normals: bool,
    /// Index in [`UVS`].
    pub uvs: Option<usize>,
    pub has_corner_uvs: bool,
}

impl PlyProperties {
    pub fn of(header: &Header) -> Result<PlyProperties, FileProblem> {
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

/// Returns what the file contains and no mesh stores: other elements, colours and other properties, pictures that its
/// comments name, and lines of the header that were passed over.
pub fn not_taken(PlyHeader { header, passed_over }: &PlyHeader, wanted: &PlyProperties) -> UnsupportedList {
    let mut refusals = UnsupportedList::default();
    for element in header.elements.values().filter(|element| element.count > 0) {
        let name = quoted(&element.name);
        if !["vertex", "face", "tristrips"].contains(&element.name.as_str()) {
            let elements = if element.count == 1 { "element" } else { "elements" };
            refusals.refuse(format!("{} {elements} {name}", element.count), "a mesh is of vertices, faces and strips");
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
    for line in passed_over {
        refusals.refuse(format!("{} of the header", quoted(line)), "it begins with no word of PLY: a comment");
    }
    refusals
}

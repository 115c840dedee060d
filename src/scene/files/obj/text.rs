//! The text of an OBJ file, read on all cores and checked line by line: the first line that is wrong is reported.
//!
//! Vertex colours, points, lines and curves are left out. Broken texture coordinates are dropped, as no mesh is worth
//! less without. Faces of fewer than three corners, which exporters write for loose edges, and indices of normals that
//! the file does not have are dropped and counted.

use crate::scene::files::read_text::{number, quoted, single_number};
use crate::scene::mesh::is_usable_uv;
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::AddAssign;

/// The content of an OBJ file; indices count from 0 and are in range, polygons are not yet triangles.
#[derive(Debug, Default, PartialEq)]
pub struct ObjContents {
    /// Positions; may be NaN or infinite.
    pub positions: Vec<DVec3>,
    /// Normals; may be NaN or infinite.
    pub normals: Vec<Vec3>,
    /// Texture coordinates; `None` where they can't be used.
    pub places: Vec<Option<Vec2>>,
    /// Corners of all faces, one after the other.
    pub corners: Vec<ObjCorner>,
    /// The number of corners of each face: three or more.
    pub arities: Vec<u32>,
    /// Statements between faces: how many faces come before each, and what it is.
    pub statements: Vec<(usize, ObjStatement)>,
    /// The number of faces that are left out, as they have fewer than three corners.
    pub short_faces: usize,
}

/// A corner of a face, by indices counted from 0; `None` where it has no texture coordinates or normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObjCorner {
    pub vertex: u32,
    pub place: Option<u32>,
    /// [`ObjCorner::MISSING`] where the file does not have the normal that it names.
    pub normal: Option<u32>,
}

impl ObjCorner {
    /// The index of a normal that the file does not have.
    const MISSING: u32 = u32::MAX;
}

/// A statement of an OBJ file that applies to the faces that follow.
#[derive(Debug, PartialEq)]
pub enum ObjStatement {
    /// `o` or `g`; empty where it gives no name.
    Name(String),
    /// `usemtl`.
    Material(String),
    /// `mtllib`.
    Library(String),
}

/// What is wrong with a line of an OBJ file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ObjLineProblem {
    /// Number of the line, counted from 1.
    pub line: usize,
    /// What is wrong and how to fix it.
    pub reason: String,
}

/// Approximate bytes that a thread takes at once.
const PART: usize = 1 << 18;

/// Reads and checks a file.
pub fn read(raw: &str) -> Result<ObjContents, ObjLineProblem> {
    read_in_parts(raw, PART)
}

fn read_in_parts(raw: &str, size: usize) -> Result<ObjContents, ObjLineProblem> {
    let parts = parts(raw, size);
    let counts: Vec<ObjCounts> = parts.par_iter().map(|part| ObjCounts::of(part)).collect();
    let mut all = ObjCounts::default();
    let mut before = Vec::with_capacity(parts.len());
    for count in counts {
        before.push(all);
        all += count;
    }
    let read: Vec<ObjChunk> =
        parts.par_iter().zip(before).map(|(text, before)| ObjChunk::read(text, before, all)).collect();
    // The first error in the file's order, whichever thread was first.
    let of_vectors = read.iter().find_map(|part| part.of_vectors.clone());
    if let Some(problem) = of_vectors.or_else(|| read.iter().find_map(|part| part.of_faces.clone())) {
        return Err(problem);
    }
    let mut joined = ObjContents {
        positions: Vec::with_capacity(all.vertices),
        normals: Vec::with_capacity(all.normals),
        places: Vec::with_capacity(all.places),
        corners: Vec::with_capacity(read.iter().map(|part| part.contents.corners.len()).sum()),
        arities: Vec::with_capacity(read.iter().map(|part| part.contents.arities.len()).sum()),
        statements: Vec::new(),
        short_faces: read.iter().map(|part| part.contents.short_faces).sum(),
    };
    for ObjChunk { contents, .. } in read {
        let faces = joined.arities.len();
        joined.positions.extend(contents.positions);
        joined.normals.extend(contents.normals);
        joined.places.extend(contents.places);
        joined.corners.extend(contents.corners);
        joined.arities.extend(contents.arities);
        joined.statements.extend(contents.statements.into_iter().map(|(at, statement)| (faces + at, statement)));
    }
    Ok(joined)
}

/// Returns the number of the line, counted from 1, that gives vertex `vertex`, counted from 0; 0 where there is none.
pub fn line_of_vertex(raw: &str, vertex: usize) -> usize {
    let vertices = lines(raw).filter(|(_, line)| split_keyword(line).0 == "v");
    vertices.map(|(at, _)| at + 1).nth(vertex).unwrap_or(0)
}

/// Splits the text into pieces of at least `size` bytes (the last may be shorter), each of which ends at the end of a
/// line that is not continued by a backslash.
fn parts(raw: &str, size: usize) -> Vec<&str> {
    let mut parts = Vec::new();
    let mut rest = raw;
    while !rest.is_empty() {
        let bytes = rest.as_bytes();
        let ends = (size.min(bytes.len())..bytes.len()).filter(|end| bytes[*end - 1] == b'\n');
        let goes_on = |end: usize| bytes[..end].trim_ascii_end().ends_with(b"\\");
        let end = ends.into_iter().find(|end| !goes_on(*end)).unwrap_or(bytes.len());
        let (part, after) = rest.split_at(end);
        parts.push(part);
        rest = after;
    }
    parts
}

/// Numbers of lines, vertices, normals and texture coordinates.
#[derive(Debug, Clone, Copy, Default)]
struct ObjCounts {
    lines: usize,
    vertices: usize,
    normals: usize,
    places: usize,
}

impl AddAssign for ObjCounts {
    fn add_assign(&mut self, more: ObjCounts) {
        self.lines += more.lines;
        self.vertices += more.vertices;
        self.normals += more.normals;
        self.places += more.places;
    }
}

impl ObjCounts {
    fn of(part: &str) -> ObjCounts {
        let mut counts =
            ObjCounts { lines: part.bytes().filter(|byte| *byte == b'\n').count(), ..ObjCounts::default() };
        for (_, line) in lines(part) {
            match split_keyword(&line).0 {
                "v" => counts.vertices += 1,
                "vn" => counts.normals += 1,
                "vt" => counts.places += 1,
                _ => {}
            }
        }
        counts
    }
}

/// Returns lines with the number of their first line, counted from 0; a backslash at a line's end joins the next one to
/// it with a space.
fn lines(part: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let mut rest = part.lines().enumerate();
    std::iter::from_fn(move || {
        let (number, line) = rest.next()?;
        let Some(first) = line.trim_ascii_end().strip_suffix('\\') else { return Some((number, Cow::Borrowed(line))) };
        let mut joined = first.to_owned();
        for (_, line) in rest.by_ref() {
            let goes_on = line.trim_ascii_end().strip_suffix('\\');
            joined.push(' ');
            joined.push_str(goes_on.unwrap_or(line));
            if goes_on.is_none() {
                break;
            }
        }
        Some((number, Cow::Owned(joined)))
    })
}

fn split_keyword(line: &str) -> (&str, &str) {
    // Searching for white space beyond ASCII takes longer, and there hardly ever is any.
    let halves = match line.is_ascii() {
        true => line.trim_ascii().split_once(|c: char| c.is_ascii_whitespace()),
        false => line.trim().split_once(char::is_whitespace),
    };
    halves.map_or((line.trim(), ""), |(keyword, rest)| (keyword, rest.trim()))
}

/// Returns the words of a line, separated by white space, up to one that begins with `#`, a comment.
fn words(text: &str) -> impl Iterator<Item = &str> {
    let is_plain = text.is_ascii();
    let plain = is_plain.then(|| text.split_ascii_whitespace());
    let other = (!is_plain).then(|| text.split_whitespace());
    let words = plain.into_iter().flatten().chain(other.into_iter().flatten());
    words.take_while(|word| !word.starts_with('#'))
}

/// Some lines of a file, and the first error in them.
#[derive(Debug, Default)]
struct ObjChunk {
    contents: ObjContents,
    of_vectors: Option<ObjLineProblem>,
    of_faces: Option<ObjLineProblem>,
}

impl ObjChunk {
    fn read(text: &str, before: ObjCounts, all: ObjCounts) -> ObjChunk {
        let mut part = ObjChunk::default();
        for (at, line) in lines(text) {
            let (keyword, rest) = split_keyword(&line);
            let contents = &mut part.contents;
            let problem = |reason| ObjLineProblem { line: before.lines + at + 1, reason };
            let mut state = |statement| contents.statements.push((contents.arities.len(), statement));
            match keyword {
                "v" | "vn" => match vector(keyword, rest) {
                    Ok(vector) if keyword == "v" => contents.positions.push(vector),
                    Ok(vector) => contents.normals.push(vector.as_vec3()),
                    Err(reason) => {
                        part.of_vectors = Some(problem(reason));
                        break;
                    }
                },
                "vt" => contents.places.push(place(rest)),
                "f" if part.of_faces.is_none() => {
                    part.of_faces = contents.add_face(rest, before, all).err().map(problem);
                }
                "o" | "g" => state(ObjStatement::Name(rest.to_owned())),
                "usemtl" if !rest.is_empty() => state(ObjStatement::Material(rest.to_owned())),
                "mtllib" if !rest.is_empty() => state(ObjStatement::Library(rest.to_owned())),
                _ => {}
            }
        }
        part
    }
}

impl ObjContents {
    /// Returns the corners of each face.
    pub fn faces(&self) -> impl Iterator<Item = &[ObjCorner]> {
        let mut rest = self.corners.as_slice();
        self.arities.iter().filter_map(move |arity| rest.split_off(..*arity as usize))
    }

    /// Returns the texture coordinates of a corner; `None` where it has none, or they can't be used.
    pub fn place_of(&self, corner: &ObjCorner) -> Option<Vec2> {
        self.places[corner.place? as usize]
    }

    /// Returns the normal of a corner; `None` where it has none, or the file does not.
    pub fn normal_of(&self, corner: &ObjCorner) -> Option<Vec3> {
        self.normals.get(corner.normal? as usize).copied()
    }

    /// Returns whether this face names a normal that the file does not have.
    pub fn lacks_normals(&self, face: &[ObjCorner]) -> bool {
        face.iter().any(|corner| corner.normal == Some(ObjCorner::MISSING))
    }

    /// Adds a face of a part of a file, with the counts of vertices before the part and in the whole file, to which its
    /// indices refer; one of fewer than three corners is only counted. An error where the index of a vertex is out of
    /// range.
    fn add_face(&mut self, rest: &str, before: ObjCounts, all: ObjCounts) -> Result<(), String> {
        let here = ObjCounts {
            vertices: before.vertices + self.positions.len(),
            normals: before.normals + self.normals.len(),
            places: before.places + self.places.len(),
            ..before
        };
        let first = self.corners.len();
        for word in words(rest) {
            self.corners.push(corner(word, here, all)?);
        }
        let count = self.corners.len() - first;
        if count < 3 {
            self.corners.truncate(first);
            self.short_faces += 1;
        } else {
            self.arities.push(count as u32);
        }
        Ok(())
    }
}

/// Parses the first three numbers of a `v` or `vn` line, further ones are ignored; NaN and infinity are numbers here. An
/// error where there are fewer, or a word is no number.
fn vector(keyword: &str, rest: &str) -> Result<DVec3, String> {
    let what = if keyword == "v" { "vertex" } else { "normal" };
    let mut three = words(rest);
    let mut vector = DVec3::ZERO;
    for axis in 0..3 {
        let word = three.next().ok_or_else(|| {
            let count = words(rest).count();
            format!("a {what} needs three numbers, but this has {count}: complete it")
        })?;
        vector[axis] = number(word).ok_or_else(|| format!("{} is not a number: correct it", quoted(word)))?;
    }
    Ok(vector)
}

/// Parses the first two numbers of a `vt` line, the second is 0 unless given; `None` where they are no numbers or can't
/// be used.
fn place(rest: &str) -> Option<Vec2> {
    let mut numbers = words(rest).map(single_number);
    let place = Vec2::new(numbers.next()??, numbers.next().unwrap_or(Some(0.0))?);
    is_usable_uv(&place).then_some(place)
}

/// Parses a corner: `v`, `v/vt`, `v//vn` or `v/vt/vn`. The index of a vertex that is out of range is an error; one of
/// texture coordinates then counts as none, and one of a normal as one that the file lacks.
fn corner(word: &str, before: ObjCounts, all: ObjCounts) -> Result<ObjCorner, String> {
    let mut parts = word.split('/');
    let (vertex, place, normal) = match [parts.next(), parts.next(), parts.next(), parts.next()] {
        [Some(vertex), place, normal, None] => (vertex, place.unwrap_or_default(), normal.unwrap_or_default()),
        _ => return Err(format!("{} is no corner: write v, v/vt, v//vn or v/vt/vn", quoted(word))),
    };
    let out_of_range = || {
        let range = if vertex.starts_with('-') {
            format!("{} vertices stand before it", before.vertices)
        } else {
            format!("there are {} vertices, counted from 1", all.vertices)
        };
        format!("vertex index {vertex} is out of range: {range}; correct it")
    };
    let normal = match normal {
        "" => None,
        normal => Some(index("normal", normal, before.normals, all.normals)?.unwrap_or(ObjCorner::MISSING)),
    };
    // Coordinates that don't exist count as none; most corners have none.
    let place = match place {
        "" => None,
        place => index("place", place, before.places, all.places).ok().flatten(),
    };
    let vertex = index("vertex", vertex, before.vertices, all.vertices)?.ok_or_else(out_of_range)?;
    Ok(ObjCorner { vertex, place, normal })
}

/// Parses an index of an OBJ file, where 1 is the first and −1 the last before the line (`before` of them), and returns
/// it counted from 0; `None` where it is not below `all`. An error where it is no whole number; `what` is a word for that.
fn index(what: &str, word: &str, before: usize, all: usize) -> Result<Option<u32>, String> {
    let given: i64 = word.parse().map_err(|_| format!("{} is no {what} index: give a whole number", quoted(word)))?;
    let back = usize::try_from(given.unsigned_abs()).unwrap_or(usize::MAX);
    let absolute = if given < 0 { before.checked_sub(back) } else { back.checked_sub(1) };
    Ok(absolute.filter(|index| *index < all).and_then(|index| u32::try_from(index).ok()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Wherever a file is cut for its threads, the result is the same: indices that count back, continued lines, names,
    /// errors.
    #[test]
    fn cuts_change_nothing() {
        let text = "# é\nv 0 0 0\nv 1 0 0 \\\n# more\nv 1 1\\\n 0\r\nvn 0 0 1\nvt 0.5 \\\r\n0.25\nmtllib a b.mtl\no left\nf 1/1/1 2//1 3\n\
                    v 0 1 0\nusemtl red\nf -4 -3 -2 \\\n-1\ng\nvt x\nvn 0 1 0\nf 1/2/-1 2/1/1 -1/-2/-2\nf 4/-7 3/9 1\nf 1 2";
        let whole = read(text).expect("a file");
        assert_eq!((whole.positions.len(), whole.normals.len(), whole.places.len()), (4, 2, 2));
        assert_eq!((&whole.arities[..], whole.statements.len()), ([3, 4, 3, 3].as_slice(), 4));
        assert_eq!((whole.short_faces, line_of_vertex(text, 2), line_of_vertex(text, 4)), (1, 5, 0));
        assert_eq!(whole.corners[3..7].iter().map(|corner| corner.vertex).collect::<Vec<_>>(), [0, 1, 2, 3]);
        assert_eq!(whole.corners[9], ObjCorner { vertex: 3, place: Some(0), normal: Some(0) });
        for size in 1..text.len() {
            assert_eq!(parts(text, size).concat(), text, "{size}");
            assert_eq!(read_in_parts(text, size).as_ref(), Ok(&whole), "{size}");
        }
        // A vertex goes before a face, and of each kind the first.
        for (more, line) in [("f 1 2 9\nf 1 2 x\nv 1\nv 2\n", 25), ("\nf 1 2 9\nv 0 0 0\nf 7 7 7\n", 24)] {
            let broken = format!("{text}\n{more}");
            for size in 1..broken.len() {
                assert_eq!(read_in_parts(&broken, size).expect_err("broken").line, line, "{size}");
            }
        }
    }
}

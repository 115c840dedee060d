//! The text of an OBJ file, checked line by line and reduced to what a mesh needs.
//!
//! `tobj` names neither the line of an error nor survives every broken number, so each line is
//! checked here first. What is left is plain: finite coordinates, faces of at least three corners
//! with absolute indices in range, group and material lines. Vertex colours, points, lines and
//! curves are left out. A face keeps its normals only if all its corners have one; so its places in a
//! picture, which are read here, as no mesh is worth less without.

use crate::scene::read_text::quoted;
use glam::Vec2;
use std::borrow::Cow;

/// Beyond it, a place in a picture is no number worth having in single precision.
const MOST_UV: f32 = 1e5;

/// An OBJ file that `tobj` reads without an error.
#[derive(Debug, Default)]
pub struct CleanText {
    /// Vertices first, then everything else in the file's order.
    pub text: String,
    /// For each face, in order: do all its corners have a normal?
    pub has_normals: Vec<bool>,
    /// For each face, in order: where each corner lies in a picture, if all of them do.
    pub uvs: Vec<Option<Vec<Vec2>>>,
}

/// What is wrong with a line.
#[derive(Debug, PartialEq, Eq)]
pub struct LineProblem {
    /// Counted from 1.
    pub line: usize,
    /// What is wrong and how to mend it.
    pub reason: String,
}

/// Checks and reduces a file.
///
/// # Errors
/// The first broken vertex or normal, else the first broken face.
pub fn clean(raw: &str) -> Result<CleanText, LineProblem> {
    let lines = logical_lines(raw);
    let mut cleaned = CleanText::default();
    let all = Counts::of(&lines, lines.len());
    for (number, line) in &lines {
        let vector = vector_line(line).map_err(|reason| LineProblem { line: *number, reason })?;
        cleaned.text.extend(vector);
    }
    let places: Vec<Option<Vec2>> = lines.iter().filter_map(|(_, line)| place_line(line)).collect();
    let mut before = Counts::default();
    for (number, line) in &lines {
        let (keyword, rest) = split_keyword(line);
        match keyword {
            "v" | "vn" | "vt" => before.add(keyword),
            "f" => {
                cleaned.uvs.push(words(rest).map(|word| place(word, before, &places)).collect());
                let face = face_line(rest, before, all).map_err(|reason| LineProblem { line: *number, reason })?;
                cleaned.has_normals.push(face.contains("//"));
                cleaned.text.push_str(&face);
            }
            "o" | "g" => cleaned.text.push_str(&format!("{keyword} {rest}\n")),
            "usemtl" | "mtllib" if !rest.is_empty() => cleaned.text.push_str(&format!("{keyword} {rest}\n")),
            _ => {}
        }
    }
    Ok(cleaned)
}

/// How many vertices, normals and places in a picture there are.
#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    vertices: usize,
    normals: usize,
    places: usize,
}

impl Counts {
    fn of(lines: &[(usize, Cow<str>)], upto: usize) -> Counts {
        let mut counts = Counts::default();
        lines[..upto].iter().for_each(|(_, line)| counts.add(split_keyword(line).0));
        counts
    }

    fn add(&mut self, keyword: &str) {
        match keyword {
            "v" => self.vertices += 1,
            "vn" => self.normals += 1,
            "vt" => self.places += 1,
            _ => {}
        }
    }
}

/// Lines with their numbers; a backslash at the end joins the next one.
fn logical_lines(raw: &str) -> Vec<(usize, Cow<'_, str>)> {
    let mut joined: Vec<(usize, Cow<str>)> = Vec::new();
    let mut continues = false;
    for (index, line) in raw.lines().enumerate() {
        let (content, goes_on) = match line.trim_end().strip_suffix('\\') {
            Some(content) => (content, true),
            None => (line, false),
        };
        match joined.last_mut().filter(|_| continues) {
            Some((_, start)) => *start = format!("{start} {content}").into(),
            None => joined.push((index + 1, content.into())),
        }
        continues = goes_on;
    }
    joined
}

fn split_keyword(line: &str) -> (&str, &str) {
    let line = line.trim();
    line.split_once(char::is_whitespace).map_or((line, ""), |(keyword, rest)| (keyword, rest.trim()))
}

/// The words before a comment.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split_whitespace().take_while(|word| !word.starts_with('#'))
}

/// A `v` or `vn` line with its three numbers, or `None` for any other line.
fn vector_line(line: &str) -> Result<Option<String>, String> {
    let (keyword, rest) = split_keyword(line);
    let (what, most) = match keyword {
        "v" => ("vertex", f64::MAX),
        "vn" => ("normal", f64::from(f32::MAX)),
        _ => return Ok(None),
    };
    let three: Vec<&str> = words(rest).take(3).collect();
    let [x, y, z] = three[..] else {
        return Err(format!("a {what} needs three numbers, but this has {}: complete it", three.len()));
    };
    for word in [x, y, z] {
        let number: f64 = word.parse().map_err(|_| format!("{} is not a number: correct it", quoted(word)))?;
        if !number.is_finite() || number.abs() > most {
            return Err(format!("{} is not a finite number: replace it", quoted(word)));
        }
    }
    Ok(Some(format!("{keyword} {x} {y} {z}\n")))
}

/// The place of a `vt` line: `None` inside where it can't be used, outside for any other line.
fn place_line(line: &str) -> Option<Option<Vec2>> {
    let (keyword, rest) = split_keyword(line);
    (keyword == "vt").then(|| {
        let mut numbers = words(rest).map(|word| word.parse().ok());
        // The second is 0 unless given.
        let place = Vec2::new(numbers.next()??, numbers.next().unwrap_or(Some(0.0))?);
        is_usable(&place).then_some(place)
    })
}

/// Is it a place that single precision tells from others?
pub fn is_usable(place: &Vec2) -> bool {
    place.to_array().iter().all(|part| part.abs() <= MOST_UV)
}

/// Where a corner, `v/vt` or `v/vt/vn`, lies in a picture, if that can be told.
fn place(word: &str, before: Counts, places: &[Option<Vec2>]) -> Option<Vec2> {
    let named = word.split('/').nth(1).filter(|named| !named.is_empty())?;
    let index = index("place", "places", named, before.places, places.len()).ok()?;
    *places.get(index - 1)?
}

/// A face line with absolute indices, as `v` or, where every corner has a normal, `v//vn`.
fn face_line(rest: &str, before: Counts, all: Counts) -> Result<String, String> {
    let corners = words(rest).map(|word| corner(word, before, all)).collect::<Result<Vec<_>, _>>()?;
    if corners.len() < 3 {
        let count = corners.len();
        return Err(format!("a face needs at least 3 corners, but this has {count}: complete it or delete the line"));
    }
    let all_have_normals = corners.iter().all(|(_, normal)| normal.is_some());
    let mut line = "f".to_owned();
    for (vertex, normal) in corners {
        line += &match normal.filter(|_| all_have_normals) {
            Some(normal) => format!(" {vertex}//{normal}"),
            None => format!(" {vertex}"),
        };
    }
    Ok(line + "\n")
}

/// Vertex and normal of a corner: `v`, `v/vt`, `v//vn` or `v/vt/vn`.
fn corner(word: &str, before: Counts, all: Counts) -> Result<(usize, Option<usize>), String> {
    let parts: Vec<&str> = word.split('/').collect();
    let (vertex, normal) = match parts[..] {
        [vertex] | [vertex, _] => (vertex, ""),
        [vertex, _, normal] => (vertex, normal),
        _ => return Err(format!("{} is no corner: write v, v/vt, v//vn or v/vt/vn", quoted(word))),
    };
    let vertex = index("vertex", "vertices", vertex, before.vertices, all.vertices)?;
    if normal.is_empty() {
        return Ok((vertex, None));
    }
    Ok((vertex, Some(index("normal", "normals", normal, before.normals, all.normals)?)))
}

/// An absolute index, counted from 1; negative ones count back from the line.
fn index(what: &str, plural: &str, word: &str, before: usize, all: usize) -> Result<usize, String> {
    let given: i64 = word.parse().map_err(|_| format!("{} is no {what} index: give a whole number", quoted(word)))?;
    let back = usize::try_from(given.unsigned_abs()).unwrap_or(usize::MAX);
    let absolute = if given < 0 { before.checked_sub(back).map(|index| index + 1) } else { Some(back) };
    absolute.filter(|index| (1..=all).contains(index)).ok_or_else(|| {
        let range = if given < 0 {
            format!("{before} {plural} stand before it")
        } else {
            format!("there are {all} {plural}, counted from 1")
        };
        format!("{what} index {given} is out of range: {range}; correct it")
    })
}

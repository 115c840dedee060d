//! The text of an OBJ file, checked line by line and reduced to what a mesh needs.
//!
//! `tobj` names neither the line of an error nor survives every broken number, so each line is
//! checked here first. What is left is plain: finite coordinates, faces of at least three corners
//! with absolute indices in range, group and material lines. Vertex colours, points, lines and
//! curves are left out. A face keeps its normals only if all its corners have one; so its places in a
//! picture, which are read here, as no mesh is worth less without.

use crate::scene::mesh::is_usable_uv;
use crate::scene::read_text::quoted;
use glam::Vec2;
use rayon::prelude::*;
use std::borrow::Cow;
use std::fmt::Write;

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
    let (lines, all) = counted_lines(raw);
    let vectors: Vec<_> = lines.par_chunks(PART).map(vectors_of).collect();
    let places: Vec<Option<Vec2>> = lines.iter().filter_map(Line::place).collect();
    let others: Vec<_> = lines.par_chunks(PART).map(|lines| others_of(lines, all, &places)).collect();
    // The first error in the file's order, whichever thread was first.
    let mut cleaned = CleanText { text: vectors.into_iter().collect::<Result<_, _>>()?, ..CleanText::default() };
    for part in others {
        let part = part?;
        cleaned.text.push_str(&part.text);
        cleaned.has_normals.extend(part.has_normals);
        cleaned.uvs.extend(part.uvs);
    }
    Ok(cleaned)
}

/// Vertices and normals among some lines.
fn vectors_of(lines: &[Line]) -> Result<String, LineProblem> {
    let mut text = String::new();
    for line in lines {
        line.add_vector(&mut text).map_err(|reason| LineProblem { line: line.number, reason })?;
    }
    Ok(text)
}

/// All else among them.
fn others_of(lines: &[Line], all: Counts, places: &[Option<Vec2>]) -> Result<CleanText, LineProblem> {
    let mut cleaned = CleanText::default();
    let mut corners = Vec::new();
    for Line { number, content, before } in lines {
        let (keyword, rest) = split_keyword(content);
        match keyword {
            "f" => {
                cleaned.uvs.push(words(rest).map(|word| place(word, *before, places)).collect());
                let has_normals = add_face(&mut cleaned.text, rest, (*before, all), &mut corners);
                cleaned.has_normals.push(has_normals.map_err(|reason| LineProblem { line: *number, reason })?);
            }
            "o" | "g" => push_line(&mut cleaned.text, &[keyword, rest]),
            "usemtl" | "mtllib" if !rest.is_empty() => push_line(&mut cleaned.text, &[keyword, rest]),
            _ => {}
        }
    }
    Ok(cleaned)
}

fn push_line(text: &mut String, words: &[&str]) {
    for (index, word) in words.iter().enumerate() {
        text.push_str(if index == 0 { "" } else { " " });
        text.push_str(word);
    }
    text.push('\n');
}

/// Lines that a thread takes at once.
const PART: usize = 8192;

/// A line, joined with those that it continues on.
struct Line<'a> {
    /// Counted from 1.
    number: usize,
    content: Cow<'a, str>,
    /// What stands before it.
    before: Counts,
}

/// How many vertices, normals and places in a picture there are.
#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    vertices: usize,
    normals: usize,
    places: usize,
}

impl Counts {
    fn add(&mut self, keyword: &str) {
        match keyword {
            "v" => self.vertices += 1,
            "vn" => self.normals += 1,
            "vt" => self.places += 1,
            _ => {}
        }
    }
}

/// All lines, and how many vertices, normals and places they have; a backslash at the end joins the next one.
fn counted_lines(raw: &str) -> (Vec<Line<'_>>, Counts) {
    let mut joined: Vec<Line> = Vec::new();
    let mut continues = false;
    for (index, line) in raw.lines().enumerate() {
        let (content, goes_on) = match line.trim_end().strip_suffix('\\') {
            Some(content) => (content, true),
            None => (line, false),
        };
        match joined.last_mut().filter(|_| continues) {
            Some(start) => {
                let joined = start.content.to_mut();
                joined.push(' ');
                joined.push_str(content);
            }
            None => joined.push(Line { number: index + 1, content: content.into(), before: Counts::default() }),
        }
        continues = goes_on;
    }
    let mut counts = Counts::default();
    for line in &mut joined {
        line.before = counts;
        counts.add(split_keyword(&line.content).0);
    }
    (joined, counts)
}

fn split_keyword(line: &str) -> (&str, &str) {
    let line = line.trim();
    line.split_once(char::is_whitespace).map_or((line, ""), |(keyword, rest)| (keyword, rest.trim()))
}

/// The words before a comment.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split_whitespace().take_while(|word| !word.starts_with('#'))
}

impl Line<'_> {
    /// Adds a `v` or `vn` line with its three numbers; nothing of any other line.
    fn add_vector(&self, text: &mut String) -> Result<(), String> {
        let (keyword, rest) = split_keyword(&self.content);
        let (what, most) = match keyword {
            "v" => ("vertex", f64::MAX),
            "vn" => ("normal", f64::from(f32::MAX)),
            _ => return Ok(()),
        };
        let mut three = words(rest);
        let [Some(x), Some(y), Some(z)] = [three.next(), three.next(), three.next()] else {
            let count = words(rest).count();
            return Err(format!("a {what} needs three numbers, but this has {count}: complete it"));
        };
        for word in [x, y, z] {
            let number: f64 = word.parse().map_err(|_| format!("{} is not a number: correct it", quoted(word)))?;
            if !number.is_finite() || number.abs() > most {
                return Err(format!("{} is not a finite number: replace it", quoted(word)));
            }
        }
        push_line(text, &[keyword, x, y, z]);
        Ok(())
    }

    /// The place of a `vt` line: `None` inside where it can't be used, outside for any other line.
    fn place(&self) -> Option<Option<Vec2>> {
        let (keyword, rest) = split_keyword(&self.content);
        (keyword == "vt").then(|| {
            let mut numbers = words(rest).map(|word| word.parse().ok());
            // The second is 0 unless given.
            let place = Vec2::new(numbers.next()??, numbers.next().unwrap_or(Some(0.0))?);
            is_usable_uv(&place).then_some(place)
        })
    }
}

/// Where a corner, `v/vt` or `v/vt/vn`, lies in a picture, if that can be told.
fn place(word: &str, before: Counts, places: &[Option<Vec2>]) -> Option<Vec2> {
    let named = word.split('/').nth(1).filter(|named| !named.is_empty())?;
    let index = index("place", "places", named, before.places, places.len()).ok()?;
    *places.get(index - 1)?
}

/// Vertex and, where it has one, normal of a corner: absolute.
type Corner = (usize, Option<usize>);

/// Adds a face line with absolute indices, as `v` or, where every corner has a normal, `v//vn`: whether they have. `corners`
/// is room for them.
fn add_face(
    text: &mut String,
    rest: &str,
    counts: (Counts, Counts),
    corners: &mut Vec<Corner>,
) -> Result<bool, String> {
    corners.clear();
    for word in words(rest) {
        corners.push(corner(word, counts)?);
    }
    if corners.len() < 3 {
        let count = corners.len();
        return Err(format!("a face needs at least 3 corners, but this has {count}: complete it or delete the line"));
    }
    let all_have_normals = corners.iter().all(|(_, normal)| normal.is_some());
    text.push('f');
    for (vertex, normal) in corners {
        // Writing to a string can't fail.
        let _ = match normal.filter(|_| all_have_normals) {
            Some(normal) => write!(text, " {vertex}//{normal}"),
            None => write!(text, " {vertex}"),
        };
    }
    text.push('\n');
    Ok(all_have_normals)
}

/// Vertex and normal of a corner: `v`, `v/vt`, `v//vn` or `v/vt/vn`.
fn corner(word: &str, (before, all): (Counts, Counts)) -> Result<Corner, String> {
    let mut parts = word.split('/');
    let (vertex, normal) = match [parts.next(), parts.next(), parts.next(), parts.next()] {
        [Some(vertex), _, normal, None] => (vertex, normal.unwrap_or_default()),
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

//! Material libraries (`.mtl`) of OBJ files.
//!
//! Only the lines that a [`Material`] can represent are read, and broken ones are skipped: a model is worth seeing
//! without its colours. Of pictures, `map_Kd` is shown; what else the library asks for is listed ([`UnsupportedList`]).

use crate::files::read_plain;
use crate::scene::files::read_text::{decoded, quoted};
use crate::scene::not_taken::UnsupportedList;
use crate::scene::picture::ImageLoader;
use crate::scene::{Material, MaterialTexture, Shading};
use glam::Vec2;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Bytes of the largest library.
const MOST_BYTES: u64 = 64 << 20;

/// The materials that have been read from a model's `.mtl` files, by name, with their textures, which a borrowed image
/// loader loads.
#[derive(Debug)]
pub struct MaterialLibraries<'a> {
    materials: Vec<tobj::Material>,
    /// Indices in the list; of two materials with one name, the later is used.
    by_name: BTreeMap<String, usize>,
    /// Names of libraries that were read.
    read: BTreeSet<String>,
    /// Textures by the material's name.
    maps: BTreeMap<String, ObjTexture>,
    /// What a library asks for and is not supported.
    pub refusals: UnsupportedList,
    pictures: &'a mut ImageLoader,
}

/// A material's texture, and how texture coordinates are scaled and moved for it.
#[derive(Debug, Clone)]
pub struct ObjTexture {
    /// The texture.
    pub texture: MaterialTexture,
    scale: Vec2,
    offset: Vec2,
}

impl ObjTexture {
    /// Converts texture coordinates of the surface to ones of the picture.
    pub fn place(&self, uv: Vec2) -> Vec2 {
        uv * self.scale + self.offset
    }
}

impl<'a> MaterialLibraries<'a> {
    /// Returns libraries without materials, which read pictures with `pictures`.
    pub fn new(pictures: &'a mut ImageLoader) -> MaterialLibraries<'a> {
        MaterialLibraries {
            materials: Vec::new(),
            by_name: BTreeMap::new(),
            read: BTreeSet::new(),
            maps: BTreeMap::new(),
            refusals: UnsupportedList::default(),
            pictures,
        }
    }

    /// Returns the index of the material of that name in the libraries that were read; `None` where there is none.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// Returns a material by its index from `find`; panics for any other.
    pub fn material(&self, found: usize) -> &tobj::Material {
        &self.materials[found]
    }

    /// Returns the texture of the material of that name; `None` where it has none that can be used.
    pub fn map(&self, material: &str) -> Option<&ObjTexture> {
        self.maps.get(material)
    }

    /// Reads a library; paths of pictures are relative to it. One that can't be read costs colours only, and is listed.
    /// Some programs name it before every object: it is read once.
    pub fn load(&mut self, file: &Path, name: &str) {
        if !self.read.insert(name.to_owned()) {
            return;
        }
        let what = || format!("the materials of {}", quoted(name));
        let text = match read_plain(file, MOST_BYTES) {
            Ok(bytes) => decoded(bytes),
            Err(error) => return self.refusals.refuse(what(), error.to_string()),
        };
        let folder = file.parent().unwrap_or(Path::new(""));
        let mut material = "";
        for line in text.lines() {
            let line = line.trim();
            let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            match keyword {
                "newmtl" => material = rest.trim(),
                "map_Kd" => self.add_map(material, rest, folder),
                keyword if is_map(keyword) => {
                    let of = format!("{} of {}", quoted(keyword).replace('`', ""), quoted(material));
                    self.refusals.refuse(of, "of pictures, only that of the diffuse colour (map_Kd) is shown");
                }
                _ => {}
            }
        }
        let plain: String = text.lines().filter_map(usable_line).collect();
        match tobj::load_mtl_buf(&mut plain.as_bytes()) {
            Ok((materials, by_name)) => {
                let before = self.materials.len();
                self.materials.extend(materials);
                self.by_name.extend(by_name.into_iter().map(|(name, at)| (name, before + at)));
            }
            Err(error) => self.refusals.refuse(what(), format!("{error}: correct the library")),
        }
    }

    fn add_map(&mut self, material: &str, rest: &str, folder: &Path) {
        let what = format!("map_Kd of {}", quoted(material));
        let line = ObjTextureLine::parse(rest);
        for option in &line.passed_over {
            self.refusals.refuse(format!("{option} of map_Kd of {}", quoted(material)), "nothing here does it");
        }
        if line.file.is_empty() {
            return self.refusals.refuse(what, "it names no file");
        }
        let name = line.path();
        match self.pictures.load(&folder.join(&name)) {
            Ok(picture) => {
                if picture.has_alpha() {
                    self.refusals.refuse(format!("the alpha of {}", quoted(&name)), "opacity is the material's (d)");
                }
                let texture = MaterialTexture { picture, side: None, clamps: line.clamps };
                self.maps.insert(material.to_owned(), ObjTexture { texture, scale: line.scale, offset: line.offset });
            }
            Err(error) => self.refusals.refuse(what, format!("{} {error}", quoted(&name))),
        }
    }
}

/// Returns the pictures that a library's `map_Kd` lines name, beside it; empty where it can't be read.
pub fn pictures_of(library: &Path) -> Vec<PathBuf> {
    let Ok(bytes) = read_plain(library, MOST_BYTES) else { return Vec::new() };
    let text = decoded(bytes);
    let maps = text.lines().filter_map(|line| line.trim().strip_prefix("map_Kd"));
    maps.map(|rest| library.with_file_name(ObjTextureLine::parse(rest).path())).collect()
}

/// Returns whether the keyword is of a picture other than that of the diffuse colour.
fn is_map(keyword: &str) -> bool {
    keyword.starts_with("map_") || ["bump", "norm", "disp", "decal", "refl"].contains(&keyword)
}

/// Options that are skipped, with their numbers of words, and the values at which they change nothing; `None` for an
/// option of how a picture is filtered, which this program decides.
const OTHER_OPTIONS: [(&str, usize, Option<&str>); 9] = [
    ("-mm", 2, Some("0 1")),
    ("-cc", 1, Some("off")),
    ("-imfchan", 1, Some("")),
    ("-type", 1, Some("")),
    ("-blendu", 1, None),
    ("-blendv", 1, None),
    ("-boost", 1, None),
    ("-texres", 1, None),
    ("-bm", 1, None),
];

/// The arguments of `map_Kd`.
#[derive(Debug, PartialEq)]
struct ObjTextureLine<'a> {
    file: &'a str,
    scale: Vec2,
    offset: Vec2,
    clamps: bool,
    /// Options that change what is shown, and are not supported.
    passed_over: Vec<&'static str>,
}

impl<'a> ObjTextureLine<'a> {
    /// Returns the file's path, which may have been written on another system.
    fn path(&self) -> String {
        self.file.replace('\\', "/")
    }

    /// Parses the arguments of `map_Kd`. Options come first; the rest is the file, whose name may have spaces. Options
    /// that change what is shown and are not supported are recorded.
    fn parse(rest: &'a str) -> ObjTextureLine<'a> {
        let mut unused = Vec2::ZERO;
        let mut line = ObjTextureLine {
            file: rest.trim(),
            scale: Vec2::ONE,
            offset: Vec2::ZERO,
            clamps: false,
            passed_over: Vec::new(),
        };
        while let Some((option, after)) = next_word(line.file).filter(|(word, _)| word.starts_with('-')) {
            line.file = match option {
                "-s" => numbers(after, &mut line.scale),
                "-o" => numbers(after, &mut line.offset),
                "-clamp" => next_word(after).map_or(after, |(word, after)| {
                    line.clamps = word == "on";
                    after
                }),
                "-t" => {
                    line.passed_over.push("-t");
                    numbers(after, &mut unused)
                }
                _ => match OTHER_OPTIONS.iter().find(|(name, ..)| *name == option) {
                    Some((name, count, plain)) => {
                        let is_plain =
                            plain.is_none_or(|plain| after.split_whitespace().take(*count).eq(plain.split(' ')));
                        line.passed_over.extend((!is_plain).then_some(*name));
                        skip(after, *count)
                    }
                    // A file may have such a name.
                    None => break,
                },
            };
        }
        line
    }
}

/// Splits off the first word, and returns it with the rest, both without leading spaces; `None` where there is no word.
fn next_word(text: &str) -> Option<(&str, &str)> {
    let text = text.trim_start();
    let end = text.find(char::is_whitespace).unwrap_or(text.len());
    (end > 0).then(|| (&text[..end], text[end..].trim_start()))
}

fn skip(text: &str, count: usize) -> &str {
    (0..count).fold(text, |text, _| next_word(text).map_or("", |(_, after)| after))
}

/// Parses up to three numbers at the start of `text`, stores the first two in `into` where they are finite, and returns
/// the rest. The last word is never taken, as it is the file's name.
fn numbers<'a>(mut text: &'a str, into: &mut Vec2) -> &'a str {
    for axis in 0..3 {
        // A number with nothing after it is the file's name, which may begin with digits.
        let number = next_word(text).filter(|(_, after)| !after.is_empty());
        let Some((number, after)) = number.and_then(|(word, after)| Some((word.parse::<f32>().ok()?, after))) else {
            break;
        };
        if axis < 2 && number.is_finite() {
            into[axis] = number;
        }
        text = after;
    }
    text
}

/// Returns the material of a library for surfaces that have normals of their own (`Phong`) or not. One that has a
/// picture and no colour shows the picture unchanged.
pub fn material(from: &tobj::Material, shading: Shading, has_map: bool) -> Material {
    let default = Material::default();
    let within = |low: f32, value: f64, high: f32| (value as f32).clamp(low, high);
    let specular = from.specular.map_or(0.0, |[r, g, b]| (r + g + b) / 3.0);
    let plain = if has_map { [1.0; 3] } else { default.color };
    Material {
        color: from.diffuse.map_or(plain, |rgb| rgb.map(|c| within(0.0, c, 1.0))),
        specular: within(0.0, specular, 1.0),
        shininess: from.shininess.map_or(default.shininess, |exponent| within(1.0, exponent, 1000.0)),
        opacity: from.dissolve.map_or(1.0, |opacity| within(0.0, opacity, 1.0)),
        emission: from.emissive.map_or(default.emission, |rgb| rgb.map(|c| within(0.0, c, 1000.0))),
        shading,
        ..default
    }
}

/// Returns a library's line in plain form, if it begins a material or sets a colour, gloss or opacity that is read,
/// with as many finite numbers as needed; `None` for any other line.
fn usable_line(line: &str) -> Option<String> {
    let (keyword, rest) = line.trim().split_once(char::is_whitespace)?;
    let count = match keyword {
        "newmtl" => return Some(format!("newmtl {}\n", rest.trim())),
        "Kd" | "Ks" | "Ke" => 3,
        "Ns" | "d" => 1,
        _ => return None,
    };
    let words: Vec<&str> = rest.split_whitespace().take(count).collect();
    let numbers_are_usable = words.iter().all(|word| word.parse().is_ok_and(f64::is_finite));
    (words.len() == count && numbers_are_usable).then(|| format!("{keyword} {}\n", words.join(" ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_of_a_map_come_before_its_file_whose_name_may_have_spaces() {
        let plain = ObjTextureLine {
            file: "a b.png",
            scale: Vec2::ONE,
            offset: Vec2::ZERO,
            clamps: false,
            passed_over: Vec::new(),
        };
        let cases = [
            ("a b.png", plain),
            ("-s 2 a.png", ObjTextureLine { file: "a.png", scale: Vec2::new(2.0, 1.0), ..ObjTextureLine::parse("") }),
            (
                "-s 2 3 1 -o 0.5 -clamp on 7.png",
                ObjTextureLine {
                    file: "7.png",
                    scale: Vec2::new(2.0, 3.0),
                    offset: Vec2::new(0.5, 0.0),
                    clamps: true,
                    passed_over: Vec::new(),
                },
            ),
            ("-o 1 2", ObjTextureLine { file: "2", offset: Vec2::new(1.0, 0.0), ..ObjTextureLine::parse("") }),
            ("-mm 0 1 -bm 2 x", ObjTextureLine { file: "x", ..ObjTextureLine::parse("") }),
            (
                "-mm 0 2 -cc on x",
                ObjTextureLine { file: "x", passed_over: vec!["-mm", "-cc"], ..ObjTextureLine::parse("") },
            ),
            ("-t 1 1 1 x", ObjTextureLine { file: "x", passed_over: vec!["-t"], ..ObjTextureLine::parse("") }),
            ("-odd.png", ObjTextureLine { file: "-odd.png", ..ObjTextureLine::parse("") }),
            ("-clamp", ObjTextureLine::parse("")),
        ];
        for (text, expected) in cases {
            assert_eq!(ObjTextureLine::parse(text), expected, "{text}");
        }
    }
}

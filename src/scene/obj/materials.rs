//! Material libraries (`.mtl`) of OBJ files.
//!
//! Only the lines that a [`Material`] can hold are read, and broken ones are passed over: a model
//! is worth seeing without its colours.

use crate::scene::{Material, Shading};
use std::path::Path;

/// Reads a library; a missing one is an error that the caller may ignore.
///
/// # Errors
/// A file that can't be opened.
pub fn load_library(file: &Path) -> tobj::MTLLoadResult {
    let bytes = std::fs::read(file).map_err(|_| tobj::LoadError::OpenFileFailed)?;
    let text: String = String::from_utf8_lossy(&bytes).lines().filter_map(usable_line).collect();
    tobj::load_mtl_buf(&mut text.as_bytes())
}

/// The material of a library for surfaces that have normals of their own (`Phong`) or not.
#[must_use]
pub fn material(from: &tobj::Material, shading: Shading) -> Material {
    let default = Material::default();
    let within = |low: f32, value: f64, high: f32| (value as f32).clamp(low, high);
    let specular = from.specular.map_or(0.0, |[r, g, b]| (r + g + b) / 3.0);
    Material {
        color: from.diffuse.map_or(default.color, |rgb| rgb.map(|c| within(0.0, c, 1.0))),
        specular: within(0.0, specular, 1.0),
        shininess: from.shininess.map_or(default.shininess, |exponent| within(1.0, exponent, 1000.0)),
        opacity: from.dissolve.map_or(1.0, |opacity| within(0.0, opacity, 1.0)),
        shading,
        ..default
    }
}

/// The line in plain form, if it is one that is read and nothing is wrong with it.
fn usable_line(line: &str) -> Option<String> {
    let (keyword, rest) = line.trim().split_once(char::is_whitespace)?;
    let count = match keyword {
        "newmtl" => return Some(format!("newmtl {}\n", rest.trim())),
        "Kd" | "Ks" => 3,
        "Ns" | "d" => 1,
        _ => return None,
    };
    let words: Vec<&str> = rest.split_whitespace().take(count).collect();
    let numbers_are_usable = words.iter().all(|word| word.parse().is_ok_and(f64::is_finite));
    (words.len() == count && numbers_are_usable).then(|| format!("{keyword} {}\n", words.join(" ")))
}

//! Shapes of scene files as meshes.

use super::problem::SceneFileProblem;
use super::tables::{Segments, ShapeTable, SpannedNumber};
use crate::scene::shapes;
use crate::scene::suggestion;
use crate::scene::{Mesh, MeshError};
use glam::DVec2;
use std::ops::Range;
use toml::Spanned;

/// Each shape with its parameters beside `shape`.
const SHAPES: [(&str, &[&str]); 8] = [
    ("quad", &["size"]),
    ("box", &["size"]),
    ("sphere", &["radius", "segments"]),
    ("torus", &["major", "minor", "segments"]),
    ("tetrahedron", &["radius"]),
    ("cylinder", &["radius", "height", "segments"]),
    ("revolve", &["profile", "closed", "segments"]),
    ("triangles", &["points", "indices"]),
];
/// The most segments around or along a shape.
const MOST_SEGMENTS: u32 = 4096;

/// Returns the mesh of a shape, with defaults for parameters that are not given. An unknown shape, or a parameter that
/// it does not take, is an error.
pub fn mesh(table: &ShapeTable) -> Result<Mesh, SceneFileProblem> {
    let name = table.shape.get_ref().as_str();
    let names = SHAPES.map(|(name, _)| name);
    let Some((_, parameters)) = SHAPES.iter().find(|(known, _)| *known == name) else {
        let reason = format!("no shape is called `{}`: {}", name.escape_debug(), suggestion(name, &names));
        return Err(SceneFileProblem::new(table.shape.span(), reason));
    };
    if let Some((key, span)) = given(table).into_iter().find(|(key, _)| !parameters.contains(key)) {
        let reason = format!("a {name} has no `{key}`: it takes {}", parameters.join(", "));
        return Err(SceneFileProblem::new(span, reason));
    }
    let made = match name {
        "quad" => shapes::quad(sizes(table, [1.0; 2])?),
        "box" => shapes::cuboid(sizes(table, [1.0; 3])?),
        "sphere" => {
            let [around, rings] = segments(table, [48, 24])?;
            shapes::sphere(length(table.radius.as_ref(), 1.0)?, around, rings)
        }
        "torus" => {
            let [around, along_tube] = segments(table, [48, 24])?;
            let [major, minor] = [length(table.major.as_ref(), 0.5)?, length(table.minor.as_ref(), 0.2)?];
            shapes::torus(major, minor, around, along_tube)
        }
        "tetrahedron" => shapes::tetrahedron(length(table.radius.as_ref(), 1.0)?),
        "cylinder" => {
            let [around] = segments(table, [48])?;
            let [radius, height] = [length(table.radius.as_ref(), 0.5)?, length(table.height.as_ref(), 1.0)?];
            shapes::cylinder(radius, height, around)
        }
        "revolve" => return revolve(table),
        _ => return triangles(table),
    };
    made.map_err(|error| broken(&table.shape, &error))
}

fn revolve(table: &ShapeTable) -> Result<Mesh, SceneFileProblem> {
    let profile = table.profile.as_ref().ok_or_else(|| missing(table, "profile"))?;
    let points: Vec<DVec2> = profile.get_ref().iter().copied().map(DVec2::from_array).collect();
    if points.len() < 2 || !points.iter().all(|point| point.is_finite() && point.x >= 0.0) {
        let reason = "a profile needs two or more points [radius, height], finite and no radius negative: correct it";
        return Err(SceneFileProblem::new(profile.span(), reason));
    }
    let [around] = segments(table, [48])?;
    let is_closed = table.closed.as_ref().is_some_and(|closed| *closed.get_ref());
    let mesh = shapes::revolve(&points, is_closed, around).map_err(|error| broken(profile, &error))?;
    with_surface(mesh, profile)
}

fn triangles(table: &ShapeTable) -> Result<Mesh, SceneFileProblem> {
    let points = table.points.as_ref().ok_or_else(|| missing(table, "points"))?;
    let indices = table.indices.as_ref().ok_or_else(|| missing(table, "indices"))?;
    let made = shapes::triangles(points.get_ref(), indices.get_ref());
    let mesh = made.map_err(|error| match error {
        MeshError::NotFinite { .. } | MeshError::TooLarge { .. } => broken(points, &error),
        MeshError::IndexOutOfRange { .. } => broken(indices, &error),
    })?;
    with_surface(mesh, indices)
}

fn with_surface<T>(mesh: Mesh, made_of: &Spanned<T>) -> Result<Mesh, SceneFileProblem> {
    if mesh.triangles().is_empty() {
        return Err(SceneFileProblem::new(
            made_of.span(),
            "makes no triangle with three different corners: correct it",
        ));
    }
    Ok(mesh)
}

/// Returns the names of the parameters that are given, with their positions in the text.
fn given(table: &ShapeTable) -> Vec<(&'static str, Range<usize>)> {
    fn place<T>(value: &Option<Spanned<T>>) -> Option<Range<usize>> {
        value.as_ref().map(Spanned::span)
    }
    let all = [
        ("size", place(&table.size)),
        ("radius", place(&table.radius)),
        ("height", place(&table.height)),
        ("major", place(&table.major)),
        ("minor", place(&table.minor)),
        ("segments", place(&table.segments)),
        ("profile", place(&table.profile)),
        ("closed", place(&table.closed)),
        ("points", place(&table.points)),
        ("indices", place(&table.indices)),
    ];
    all.into_iter().filter_map(|(key, span)| span.map(|span| (key, span))).collect()
}

fn length(value: Option<&SpannedNumber>, default: f64) -> Result<f64, SceneFileProblem> {
    let Some(value) = value else { return Ok(default) };
    let number = *value.get_ref();
    if number > 0.0 && number.is_finite() {
        return Ok(number);
    }
    Err(SceneFileProblem::new(value.span(), "must be a finite length greater than 0: correct it"))
}

fn sizes<const N: usize>(table: &ShapeTable, default: [f64; N]) -> Result<[f64; N], SceneFileProblem> {
    let Some(size) = &table.size else { return Ok(default) };
    let lengths: Option<[f64; N]> = size.get_ref().as_slice().try_into().ok();
    lengths.filter(|lengths| lengths.iter().all(|n| *n > 0.0 && n.is_finite())).ok_or_else(|| {
        SceneFileProblem::new(size.span(), format!("the size must be {N} finite lengths greater than 0: correct it"))
    })
}

fn segments<const N: usize>(table: &ShapeTable, default: [u32; N]) -> Result<[u32; N], SceneFileProblem> {
    let Some(segments) = &table.segments else { return Ok(default) };
    let Segments(counts) = segments.get_ref();
    let counts: Option<[u32; N]> = counts.as_slice().try_into().ok();
    counts.filter(|counts| counts.iter().all(|n| (3..=MOST_SEGMENTS).contains(n))).ok_or_else(|| {
        let what = if N == 1 { "one whole number" } else { "two whole numbers in brackets" };
        SceneFileProblem::new(segments.span(), format!("segments must be {what} from 3 to {MOST_SEGMENTS}: correct it"))
    })
}

fn missing(table: &ShapeTable, key: &str) -> SceneFileProblem {
    SceneFileProblem::new(table.shape.span(), format!("a {} needs `{key}`: add it", table.shape.get_ref()))
}

fn broken<T>(made_of: &Spanned<T>, error: &MeshError) -> SceneFileProblem {
    SceneFileProblem::new(made_of.span(), error.to_string())
}

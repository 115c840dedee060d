//! Where a camera's picture has the points in which parallel lines meet.
//!
//! Lines along a direction d all meet at the picture of d's point at infinity, the homogeneous point (d, 0): P · (d, 0), which
//! lies nowhere in the picture's plane where d is parallel to that. Of the three axes of the world, one, two or three have
//! such a point: one-, two- and three-point perspective. In a parallel projection none has.

use crate::capture::Capture;
use crate::reading::matrices::vector;
use glam::{DVec2, DVec3};
use serde::Serialize;

/// Cosine of the angle to the picture's plane below which an axis counts as parallel to it.
const PARALLEL: f64 = 1e-6;

/// The picture of the lines along an axis of the world.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AxisLines {
    /// The axis: `x`, `y` or `z`.
    pub axis: &'static str,
    /// Where the lines go in the picture.
    pub lines: PictureLines,
}

/// Where lines along one direction go in a picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PictureLines {
    /// They meet at this point, in pixels from the picture's upper left, also outside of it.
    Meet([f64; 2]),
    /// They stay parallel, along this direction (right, down), of unit length.
    Parallel([f64; 2]),
    /// Each is seen as a point: they run along the rays of a parallel projection.
    Points,
}

/// Returns the pictures of the lines along x, y and z.
pub fn axes(capture: &Capture) -> [AxisLines; 3] {
    let axes = [("x", DVec3::X), ("y", DVec3::Y), ("z", DVec3::Z)];
    axes.map(|(axis, direction)| AxisLines { axis, lines: lines(capture, direction) })
}

fn lines(capture: &Capture, direction: DVec3) -> PictureLines {
    let camera = &capture.camera;
    let [width, height] = capture.size.map(f64::from);
    let view = camera.world_from_view().transpose() * direction;
    // How depth is stored does not matter here.
    let clip = camera.picture_from_view(capture.size, &capture.depth) * view.extend(0.0);
    let half = DVec2::new(width, -height) / 2.0;
    let across = DVec2::new(clip.x, clip.y) * half;
    if clip.w.abs() > PARALLEL {
        let at = across / clip.w + DVec2::new(width, height) / 2.0;
        return PictureLines::Meet(at.to_array());
    }
    // Of a parallel projection's own rays nothing is left but rounding.
    let is_point = across.length() <= PARALLEL * half.length();
    match across.try_normalize().filter(|_| !is_point) {
        Some(way) => PictureLines::Parallel(way.to_array()),
        None => PictureLines::Points,
    }
}

/// Returns in a sentence how many vanishing points the axes have: `2-point perspective: lines along x and z meet, those along y
/// stay parallel.`
pub fn words(axes: &[AxisLines; 3]) -> String {
    let named = |is_it: fn(&PictureLines) -> bool| {
        let names: Vec<&str> = axes.iter().filter(|one| is_it(&one.lines)).map(|one| one.axis).collect();
        (names.len(), names.join(" and "))
    };
    let (count, meet) = named(|lines| matches!(lines, PictureLines::Meet(_)));
    let (_, parallel) = named(|lines| !matches!(lines, PictureLines::Meet(_)));
    match count {
        0 => "Parallel projection: lines that are parallel stay so.".to_owned(),
        3 => "3-point perspective: lines along each axis meet in a point.".to_owned(),
        _ => format!(
            "{count}-point perspective: lines along {meet} meet in a point, those along {parallel} stay parallel."
        ),
    }
}

/// Returns [`words`] as a line, and one for each vanishing point with its place in the picture.
pub fn text(axes: &[AxisLines; 3]) -> String {
    let point = |one: &AxisLines| match one.lines {
        PictureLines::Meet(at) => Some(format!("  those along {} at {}\n", one.axis, vector(&at, 6))),
        PictureLines::Parallel(_) | PictureLines::Points => None,
    };
    format!("{}\n{}", words(axes), axes.iter().filter_map(point).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis_lines(lines: [PictureLines; 3]) -> [AxisLines; 3] {
        let mut all = lines.into_iter().zip(["x", "y", "z"]).map(|(lines, axis)| AxisLines { axis, lines });
        [(); 3].map(|()| all.next().expect("three"))
    }

    #[test]
    fn the_sentence_counts_the_points() {
        let (meet, parallel) = (PictureLines::Meet([0.0; 2]), PictureLines::Parallel([1.0, 0.0]));
        assert!(words(&axis_lines([meet; 3])).starts_with("3-point"));
        let two = words(&axis_lines([meet, parallel, meet]));
        assert_eq!(two, "2-point perspective: lines along x and z meet in a point, those along y stay parallel.");
        let one = words(&axis_lines([parallel, parallel, meet]));
        assert_eq!(one, "1-point perspective: lines along z meet in a point, those along x and y stay parallel.");
        assert!(words(&axis_lines([parallel, parallel, PictureLines::Points])).starts_with("Parallel projection"));
    }
}

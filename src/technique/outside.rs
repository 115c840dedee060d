//! How far something lies outside of the view, in words.

use crate::geometry::OutsidePlane;
use crate::math::AxisBox;
use crate::numbers;
use glam::DVec3;
use std::borrow::Cow;

/// Objects with more vertices are represented by the 8 corners of their bounding boxes.
const MOST_VERTICES_TO_LOOK_AT: usize = 4096;

/// Names of the view volume's planes, in the order of [`ViewVolume`](crate::geometry::ViewVolume)'s.
pub const VIEW_PLANES: [&str; 5] = [
    "the view's near plane",
    "the view's left side",
    "the view's right side",
    "the view's lower side",
    "the view's upper side",
];

/// Returns text such as `0.8 m outside the view's left side`, where `plane` is `the view's left side` (its index in
/// `outside` is not used); without the distance where that is infinite.
pub fn beyond(outside: OutsidePlane, plane: &str) -> String {
    match outside.distance.is_finite() {
        true => format!("{} outside {plane}", numbers::metres(outside.distance)),
        false => format!("outside {plane}"),
    }
}

/// Returns points whose convex hull contains an object's vertices: the vertices themselves, or the eight corners of
/// their bounding box where they are many.
pub fn outline(world: &[DVec3]) -> Cow<'_, [DVec3]> {
    if world.len() <= MOST_VERTICES_TO_LOOK_AT {
        return Cow::Borrowed(world);
    }
    Cow::Owned(AxisBox::around(world.iter().copied()).corners().to_vec())
}

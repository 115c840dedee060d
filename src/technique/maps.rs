//! The settings that techniques with maps and textures share.

use super::settings::{Number, Words, whole, words};

/// The key of [`size`].
pub const SIZE: &str = "size";

/// Texels along each side.
pub const fn size(default: &'static str, most: i64, meaning: &'static str) -> Number {
    whole(SIZE, [1, most], default, meaning)
}

/// Are maps kept from frame to frame while nothing that makes them changes?
pub const REDRAW: Words<bool> = words(
    "redraw",
    &["always", "changed"],
    &[false, true],
    "maps and textures are drawn in every frame, or only where what makes them has changed",
);

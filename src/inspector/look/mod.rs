//! The look of the inspector: themes, palettes, the names of colours, and pictures as textures.

pub mod coloring;
pub mod findings;
pub mod left_out;
pub mod number_field;
pub mod palette;
pub mod texture;
pub mod theme;
pub mod triangles;
pub mod widgets;

//! Walking through a scene: a body with feet and a head, and the walls that it can't pass.

mod body;
mod collision;
mod wall_tree;

pub use body::{Footing, WalkerBody};
pub use collision::{WallCache, Walls};

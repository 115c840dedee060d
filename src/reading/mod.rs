//! What a frame says, as data: which picture stands for a moment, what a value in it means, why a pixel is dark, which
//! texel it read. Whoever shows a frame, the window or a page, takes it from here: nothing knows a widget.
//!
//! ```text
//! steps.rs     what has a number, what is beside moment.rs    after a step or a draw    shown.rs    the picture of it
//! layers.rs    maps, textures                left_out.rs what the frame did without
//! depth.rs     what a stored depth means         counts.rs    counts beyond eight bits change.rs   what a step changed
//! verdict.rs   why a pixel is dark, a sentence   explain_facts.rs a step as a formula  meshes.rs   how meshes hang together
//! history_row.rs, ladder_layout.rs  a pixel's events in rows, and along its view ray
//! map_decision.rs what a texel stores against a pixel's depth; texture_decision.rs what textures let through to it
//! texels_read.rs both, as text and as JSON                    shading.rs   what each light adds, term by term
//! written.rs    what a step or a draw wrote, and its texels in their colours
//! map_readers.rs  texels and the pixels that read them: fragments.rs, projected.rs, pick_ray.rs, object_ids.rs
//! ```

pub mod bench;
pub mod capture_point;
pub mod change;
pub mod coordinates;
pub mod counts;
pub mod depth;
pub mod explain_facts;
pub mod format;
pub mod fragments;
pub mod history_row;
pub mod ladder_layout;
pub mod layers;
pub mod left_out;
pub mod map_decision;
pub mod map_readers;
pub mod meshes;
pub mod object_ids;
pub mod outcomes;
pub mod pick_ray;
pub mod projected;
pub mod shading;
pub mod shown;
pub mod steps;
pub mod texels_read;
pub mod texture_decision;
pub mod written;

pub use map_readers::{MapReaders, MapTexel};
pub use meshes::ObjectMesh;
pub use outcomes::TestOutcomes;

//! What a frame says, as data: which picture stands for a point of the frame, what a value in it means, which texel a
//! pixel read, what each light adds. The window and the page both show a frame from here: nothing in this module knows
//! a widget.
//!
//! ```text
//! steps.rs     numbered steps, and masks      capture_point.rs   a frame's state after a step or a draw
//! picture_view.rs  the picture of it          layers.rs          maps, textures
//! depth.rs     what a stored depth means      left_out.rs        what the frame left out
//! counts.rs    counts beyond eight bits       change.rs          what a step changed
//! explain_facts.rs a step as a formula        outcomes.rs        results of a step's tests
//! meshes.rs    the topology of meshes
//! history_row.rs, ladder_layout.rs  a pixel's events in rows, and along its view ray
//! map_decision.rs what a texel stores against a pixel's depth; texture_decision.rs what textures let through to it
//! texels_read.rs both, as text and as JSON                    shading.rs   what each light adds, term by term
//! shading_channels.rs the same light by what it is
//! coordinates.rs a pixel's point in every space, light_coordinates.rs in those of lights' maps too, with map_frustum.rs
//! camera_matrices.rs the camera's, in both conventions of depth
//! matrices.rs   how both are written          light_rays.rs what keeps each light away, in truth
//! notable_pixel.rs which pixel is worth a look               vanishing.rs where parallel lines meet
//! shadow_matrix.rs how a vertex is flattened onto a plane     bench.rs    the stencil test by itself
//! setting_values.rs what a value of a setting does
//! written.rs    what a step or a draw wrote, and its texels in their colours   both_sides.rs two frames side by side
//! map_readers.rs  texels and the pixels that read them: fragments.rs, projected.rs, pick_ray.rs, object_ids.rs
//! ```

pub mod bench;
pub mod both_sides;
mod camera_matrices;
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
pub mod light_coordinates;
pub mod light_rays;
pub mod map_decision;
pub mod map_frustum;
pub mod map_readers;
pub mod matrices;
pub mod meshes;
pub mod moment;
pub mod notable_pixel;
pub mod object_ids;
pub mod outcomes;
pub mod pick_ray;
pub mod picture_view;
pub mod projected;
pub mod ray_crossings;
pub mod setting_values;
pub mod shading;
pub mod shading_channels;
pub mod shadow_casters;
pub mod shadow_matrix;
pub mod steps;
pub mod texels_read;
pub mod texture_decision;
pub mod vanishing;
pub mod written;

pub use map_readers::{MapReaders, MapTexel};
pub use meshes::ObjectMesh;
pub use outcomes::TestOutcomes;

//! Tests by behaviour, in one program: it links once, and what they share is used by all.

mod accuracy;
mod animate;
mod auto;
mod brought;
mod capture_folder;
mod channels;
mod check;
mod claims;
mod clipped;
mod commands;
mod common;
mod coordinates;
mod diagnose;
mod diagnosis;
mod diff;
mod draws;
mod explain;
mod extruded;
mod frames_after_others;
mod frustum;
#[cfg(target_os = "linux")]
mod fuzz;
mod gltf;
mod help;
mod history;
mod import;
#[cfg(feature = "inspector")]
mod inspector;
mod language;
mod layering;
mod light_rays;
#[cfg(target_os = "linux")]
mod memory;
mod options;
mod page;
mod parallel;

mod plan;
mod ply;
mod ray_cast;
mod readback;
mod readme;
mod record;
mod recorded;
mod report;
mod scenes;
mod shading;
mod stencil_machine;
mod step_tests;
mod stress;
mod surface_pictures;
mod techniques;
mod texels_read;
mod truth;
mod vanishing;
mod viewport;
mod volumes;
mod whole_folder;

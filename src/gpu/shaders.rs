//! Shader sources: files in `shaders/`, joined to one module a program.
//!
//! A program that lights or labels is its own file and one that says how much light arrives.

use crate::plan::{Program, Visibility};

/// A shader module of a program.
#[derive(Debug, Clone)]
pub(super) struct ProgramSource {
    pub source: String,
    pub vertex: &'static str,
    /// `None` where no colour is written.
    pub fragment: Option<&'static str>,
}

macro_rules! file {
    ($name:literal) => {
        include_str!(concat!("../../shaders/", $name))
    };
}

/// `is_textured`: the surface has a picture, which only some programs show.
pub(super) fn source_of(program: Program, is_textured: bool) -> ProgramSource {
    match (program, is_textured) {
        (Program::Ambient { from_near }, true) => {
            let fragment = if from_near { "fs_ambient_textured_from_near" } else { "fs_ambient_textured" };
            let files = [file!("draw.wgsl"), file!("pulled.wgsl"), file!("texture.wgsl"), file!("ambient.wgsl")];
            joined(&[&files[..], &[file!("ambient_textured.wgsl")]].concat(), "vs_ambient_textured", Some(fragment))
        }
        (Program::Light(visibility), true) => {
            let files = surface_files(file!("light.wgsl"), visibility);
            let textured = [file!("texture.wgsl"), file!("light_textured.wgsl")];
            joined(&[&files[..], &textured].concat(), "vs_surface_textured", Some("fs_light_textured"))
        }
        _ => plain(program),
    }
}

fn joined(files: &[&str], vertex: &'static str, fragment: Option<&'static str>) -> ProgramSource {
    ProgramSource { source: [&[file!("shared.wgsl")], files].concat().join("\n"), vertex, fragment }
}

fn plain(program: Program) -> ProgramSource {
    let (files, vertex, fragment) = match program {
        Program::Position => (vec![file!("position.wgsl")], "vs_position", None),
        Program::Flat | Program::FlatLabel | Program::Count => {
            let fragment = match program {
                Program::Flat => "fs_flat",
                Program::FlatLabel => "fs_flat_label",
                _ => "fs_count",
            };
            (vec![file!("draw.wgsl"), file!("flat.wgsl")], "vs_flat", Some(fragment))
        }
        Program::Ambient { from_near } => {
            let fragment = if from_near { "fs_ambient_from_near" } else { "fs_ambient" };
            (vec![file!("draw.wgsl"), file!("ambient.wgsl")], "vs_ambient", Some(fragment))
        }
        Program::Light(visibility) => (surface_files(file!("light.wgsl"), visibility), "vs_surface", Some("fs_light")),
        Program::Recorded { .. } => (vec![file!("recorded.wgsl")], "vs_recorded", Some("fs_recorded")),
        Program::Through => {
            (surface_files(file!("through.wgsl"), Visibility::Projected), "vs_surface", Some("fs_through"))
        }
        Program::Label(visibility) => (surface_files(file!("label.wgsl"), visibility), "vs_surface", Some("fs_label")),
    };
    joined(&files, vertex, fragment)
}

fn surface_files(own: &'static str, visibility: Visibility) -> Vec<&'static str> {
    let arriving = match visibility {
        Visibility::Everywhere => file!("arriving_everywhere.wgsl"),
        Visibility::Map => file!("arriving_by_map.wgsl"),
        Visibility::Labels => file!("arriving_by_labels.wgsl"),
        Visibility::Count => file!("arriving_by_count.wgsl"),
        Visibility::ReceiverTexture => file!("arriving_by_receiver.wgsl"),
        Visibility::Projected => file!("arriving_by_projection.wgsl"),
    };
    vec![file!("draw.wgsl"), file!("pulled.wgsl"), file!("surface.wgsl"), arriving, own]
}

/// What puts depths into a target.
pub(super) const START: &str = file!("start.wgsl");

/// The log of a pixel's fragments.
pub(super) fn fragment_log() -> String {
    [file!("shared.wgsl"), file!("fragment_log.wgsl")].join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shader_is_valid() {
        let variants = |program: Program| {
            let of = move |is_textured| {
                (format!("{program:?}, textured: {is_textured}"), source_of(program, is_textured).source)
            };
            [Some(of(false)), program.shows_texture().then(|| of(true))]
        };
        let programs = Program::all().into_iter().flat_map(variants).flatten();
        for (name, source) in
            programs.chain([("FragmentLog".to_owned(), fragment_log()), ("Start".to_owned(), START.to_owned())])
        {
            let module = naga::front::wgsl::parse_str(&source).unwrap_or_else(|error| panic!("{name}: {error}"));
            let flags = naga::valid::ValidationFlags::all();
            let mut validator = naga::valid::Validator::new(flags, naga::valid::Capabilities::empty());
            validator.validate(&module).unwrap_or_else(|error| panic!("{name}: {error:?}"));
        }
    }
}

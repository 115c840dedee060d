//! Shader sources: files in `shaders/`, joined to one module a program.
//!
//! A program that lights or labels is its own file and one that says how much light arrives.

use crate::plan::{Draw, DrawMesh, Program, Visibility};

/// Identifies a shader module: a program and the inputs that its draws have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct ShaderKey {
    pub program: Program,
    pub form: ShaderInputs,
}

/// What a program reads in addition to the inputs that all of its draws have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum ShaderInputs {
    Plain,
    /// The texture of the surface.
    Textured,
    /// The planes and lines from which the shader computes vertices, of meshes that are
    /// [`Extruded`](crate::plan::Extruded).
    Extruded,
    /// The fragments that another program's shader did not discard, of a captured frame.
    Retained,
}

impl ShaderKey {
    /// Returns the key of the shader that a draw needs: its program, and the form of its inputs (extruded, retained for
    /// recorded programs, textured or plain; the first of these that applies).
    pub fn of(draw: &Draw, mesh: &DrawMesh) -> ShaderKey {
        let form = match (&mesh.extruded, &mesh.retained, draw.constants.texture) {
            (Some(_), ..) => ShaderInputs::Extruded,
            (None, Some(_), _) if draw.program.is_recorded() => ShaderInputs::Retained,
            (None, _, Some(_)) => ShaderInputs::Textured,
            (None, _, None) => ShaderInputs::Plain,
        };
        ShaderKey { program: draw.program, form }
    }

    /// Returns whether its vertices are read from storage buffers by index, instead of from a vertex buffer.
    pub fn pulls_vertices(self) -> bool {
        self.program.visibility().is_some() || self.form == ShaderInputs::Textured
    }

    /// Returns how many bind groups it uses, from group 0 on.
    pub fn group_count(self) -> usize {
        match self.program {
            Program::Ambient { .. } if self.form == ShaderInputs::Textured => 3,
            Program::Recorded { .. } if self.form == ShaderInputs::Retained => 3,
            Program::Position if self.form == ShaderInputs::Extruded => 2,
            Program::Position | Program::Recorded { .. } => 1,
            Program::Flat | Program::FlatLabel | Program::Count | Program::Ambient { .. } => 2,
            Program::Light(_)
            | Program::AmbientDiffuse
            | Program::Label(_)
            | Program::Arriving(_)
            | Program::Through => 4,
        }
    }
}

/// The WGSL source of a program's shader module, and its entry points.
#[derive(Debug, Clone)]
pub(super) struct ProgramSource {
    pub source: String,
    pub vertex: &'static str,
    /// Name of the fragment entry point; with `_steps` after it, of the one that writes depths as integers.
    pub fragment: &'static str,
    /// Whether it writes a colour, a label or a number.
    pub writes_color: bool,
    /// Whether it discards fragments.
    discards: bool,
}

impl ProgramSource {
    /// Returns the fragment entry point of draws whose target stores depths as integers (`is_stepped`), or as floats; `None`
    /// where the rasteriser's depth is all that a draw leaves.
    pub fn fragment_for(&self, is_stepped: bool) -> Option<String> {
        match is_stepped {
            true => Some(format!("{}_steps", self.fragment)),
            false => (self.writes_color || self.discards).then(|| self.fragment.to_owned()),
        }
    }
}

macro_rules! file {
    ($name:literal) => {
        include_str!(concat!("../../shaders/", $name))
    };
}

pub(super) fn source_of(shader: ShaderKey) -> ProgramSource {
    match (shader.form, shader.program) {
        (ShaderInputs::Extruded, program) => extruding(program),
        (ShaderInputs::Textured, Program::Ambient { .. }) => {
            let files = [file!("draw.wgsl"), file!("pulled.wgsl"), file!("texture.wgsl"), file!("ambient_light.wgsl")];
            valued([&files[..], &[file!("ambient_textured.wgsl")]].concat(), "vs_ambient_textured")
        }
        (ShaderInputs::Textured, Program::AmbientDiffuse) => {
            source_of(ShaderKey { program: Program::Light(Visibility::Everywhere), ..shader })
        }
        (ShaderInputs::Textured, Program::Light(visibility)) => {
            let textured = [file!("added.wgsl"), file!("texture.wgsl"), file!("light_textured.wgsl")];
            valued(surface_files(&textured, visibility), "vs_surface_textured")
        }
        (ShaderInputs::Retained, _) => ProgramSource {
            discards: true,
            writes_color: false,
            ..joined(&[file!("recorded_kept.wgsl")], "vs_recorded_kept", "fs_recorded_kept")
        },
        (ShaderInputs::Plain, program) | (ShaderInputs::Textured, program) => plain(program),
    }
}

fn joined(files: &[&str], vertex: &'static str, fragment: &'static str) -> ProgramSource {
    let source = [&[file!("shared.wgsl"), file!("depth_steps.wgsl")], files].concat().join("\n");
    ProgramSource { source, vertex, fragment, writes_color: true, discards: false }
}

/// Returns the source of a program that writes a value: its own files and the fragment entry points that they all share.
fn valued(mut files: Vec<&str>, vertex: &'static str) -> ProgramSource {
    files.push(file!("fragment.wgsl"));
    joined(&files, vertex, "fs_value")
}

fn plain(program: Program) -> ProgramSource {
    let of_surface = |own: &[&'static str], visibility| valued(surface_files(own, visibility), "vs_surface");
    let flat = |own| valued(vec![file!("draw.wgsl"), file!("flat.wgsl"), own], "vs_flat");
    let depth_alone = |source: ProgramSource| ProgramSource { writes_color: false, ..source };
    match program {
        Program::Position => depth_alone(joined(&[file!("position.wgsl")], "vs_position", "fs_position")),
        Program::Recorded { .. } => depth_alone(joined(&[file!("recorded.wgsl")], "vs_recorded", "fs_recorded")),
        Program::Flat => flat(file!("flat_color.wgsl")),
        Program::FlatLabel => flat(file!("flat_label.wgsl")),
        Program::Count => flat(file!("flat_count.wgsl")),
        Program::Ambient { .. } => {
            valued(vec![file!("draw.wgsl"), file!("ambient_light.wgsl"), file!("ambient.wgsl")], "vs_ambient")
        }
        Program::Light(visibility) => of_surface(&[file!("added.wgsl"), file!("light.wgsl")], visibility),
        Program::AmbientDiffuse => plain(Program::Light(Visibility::Everywhere)),
        Program::Through => of_surface(&[file!("through.wgsl")], Visibility::Projected),
        Program::Label(visibility) => of_surface(&[file!("label.wgsl")], visibility),
        Program::Arriving(visibility) => of_surface(&[file!("visibility.wgsl")], visibility),
    }
}

/// Returns the source of a program whose vertices the shader carries away from a light, for programs that are only
/// positions and a value.
fn extruding(program: Program) -> ProgramSource {
    let plain = plain(program);
    // A program that reads no value of its draw has no constants yet.
    let constants = if program == Program::Position { file!("draw.wgsl") } else { "" };
    let source = [&plain.source, constants, file!("extruded.wgsl")].join("\n");
    ProgramSource { source, vertex: "vs_extruded", ..plain }
}

fn surface_files(own: &[&'static str], visibility: Visibility) -> Vec<&'static str> {
    let arriving = match visibility {
        Visibility::Everywhere => file!("arriving_everywhere.wgsl"),
        Visibility::Map => file!("arriving_by_map.wgsl"),
        Visibility::Labels => file!("arriving_by_labels.wgsl"),
        Visibility::Count => file!("arriving_by_count.wgsl"),
        Visibility::ReceiverTexture => file!("arriving_by_receiver.wgsl"),
        Visibility::Projected => file!("arriving_by_projection.wgsl"),
    };
    let light = if visibility.reads_map() { file!("light_storage.wgsl") } else { file!("light_uniform.wgsl") };
    [&[file!("draw.wgsl"), file!("pulled.wgsl"), file!("surface.wgsl"), light, arriving], own].concat()
}

/// The WGSL source that writes the depths a target starts with.
pub(super) const START: &str = file!("start.wgsl");
pub(super) const PROBE: &str = file!("probe.wgsl");

/// Returns the WGSL module that logs every fragment of its draw (triangle, side, depth) into a storage buffer; it is
/// drawn for one pixel.
pub(super) fn fragment_log() -> String {
    [file!("shared.wgsl"), file!("fragment_log.wgsl")].join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shader_is_valid() {
        let with = |form| move |program| ShaderKey { program, form };
        let plain = Program::all().into_iter().map(with(ShaderInputs::Plain));
        let textured =
            Program::all().into_iter().filter(|program| program.shows_texture()).map(with(ShaderInputs::Textured));
        let extruded = [Program::Position, Program::Flat, Program::Count].into_iter().map(with(ShaderInputs::Extruded));
        let recorded =
            Program::all().into_iter().filter(|program| program.is_recorded()).map(with(ShaderInputs::Retained));
        let shaders = plain.chain(textured).chain(extruded).chain(recorded);
        let programs = shaders.map(|shader| (format!("{shader:?}"), source_of(shader).source));
        for (name, source) in programs.chain([
            ("FragmentLog".to_owned(), fragment_log()),
            ("Start".to_owned(), START.to_owned()),
            ("Probe".to_owned(), PROBE.to_owned()),
        ]) {
            let module = naga::front::wgsl::parse_str(&source).unwrap_or_else(|error| panic!("{name}: {error}"));
            let flags = naga::valid::ValidationFlags::all();
            let mut validator = naga::valid::Validator::new(flags, naga::valid::Capabilities::empty());
            validator.validate(&module).unwrap_or_else(|error| panic!("{name}: {error:?}"));
        }
    }
}

//! Shader sources: files in `shaders/`, joined to one module a program.

use crate::plan::Program;

/// A shader module of a program.
#[derive(Debug, Clone, Copy)]
pub(super) struct ProgramSource {
    pub source: &'static str,
    pub vertex: &'static str,
    /// `None` where no colour is written.
    pub fragment: Option<&'static str>,
}

macro_rules! joined {
    ($($file:literal),+) => { concat!($(include_str!(concat!("../../shaders/", $file)), "\n"),+) };
}

const POSITION: ProgramSource =
    ProgramSource { source: joined!("shared.wgsl", "position.wgsl"), vertex: "vs_position", fragment: None };
const AMBIENT: ProgramSource = ProgramSource {
    source: joined!("shared.wgsl", "draw.wgsl", "ambient.wgsl"),
    vertex: "vs_ambient",
    fragment: Some("fs_ambient"),
};
const LIGHT: ProgramSource = ProgramSource {
    source: joined!("shared.wgsl", "draw.wgsl", "surface.wgsl", "light.wgsl"),
    vertex: "vs_surface",
    fragment: Some("fs_light"),
};
const LIGHT_MAP: ProgramSource = ProgramSource {
    source: joined!("shared.wgsl", "draw.wgsl", "surface.wgsl", "shadow_lookup.wgsl", "light.wgsl", "light_map.wgsl"),
    vertex: "vs_surface",
    fragment: Some("fs_light_map"),
};
const LIGHT_LABELS: ProgramSource = ProgramSource {
    source: joined!("shared.wgsl", "draw.wgsl", "surface.wgsl", "light.wgsl", "light_labels.wgsl"),
    vertex: "vs_surface",
    fragment: Some("fs_light_labels"),
};
const LABEL: ProgramSource = ProgramSource {
    source: joined!("shared.wgsl", "draw.wgsl", "surface.wgsl", "label.wgsl"),
    vertex: "vs_surface",
    fragment: Some("fs_label"),
};
const LABEL_MAP: ProgramSource = ProgramSource {
    source: joined!("shared.wgsl", "draw.wgsl", "surface.wgsl", "shadow_lookup.wgsl", "label.wgsl", "label_map.wgsl"),
    vertex: "vs_surface",
    fragment: Some("fs_label_map"),
};

pub(super) fn source_of(program: Program) -> ProgramSource {
    match program {
        Program::Position => POSITION,
        Program::Ambient => AMBIENT,
        Program::Light { reads_map: false } => LIGHT,
        Program::Light { reads_map: true } => LIGHT_MAP,
        Program::LightByLabels => LIGHT_LABELS,
        Program::Label { reads_map: false } => LABEL,
        Program::Label { reads_map: true } => LABEL_MAP,
    }
}

/// Name and WGSL text of every program, to be validated without a GPU.
#[must_use]
pub fn shader_sources() -> [(&'static str, &'static str); 7] {
    [
        ("position", POSITION.source),
        ("ambient", AMBIENT.source),
        ("light", LIGHT.source),
        ("light through its map", LIGHT_MAP.source),
        ("light by labels", LIGHT_LABELS.source),
        ("label", LABEL.source),
        ("label through the map", LABEL_MAP.source),
    ]
}

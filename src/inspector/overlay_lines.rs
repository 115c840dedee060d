//! Lines of overlays as one mesh: projected once a frame of the scene, placed once a view.

use super::placement::Placement;
use super::projected::Projector;
use super::theme::Theme;
use crate::anatomy::Anatomy;
use crate::capture::Capture;
use crate::plan::Part;
use egui::epaint::{Mesh, Vertex, WHITE_UV};
use egui::{Color32, Pos2, Rect, pos2, vec2};
use glam::DVec2;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Lines that are drawn at most.
const MOST_LINES: usize = 24_000;

/// What a line is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineKind {
    /// A silhouette edge, with its multiplicity.
    Silhouette(i32),
    /// An edge of a part of a shadow volume.
    Volume(Part),
}

/// Lines in texels.
#[derive(Debug, Default)]
pub struct Lines {
    /// Both ends, and what each is of.
    pub lines: Vec<([DVec2; 2], LineKind)>,
    /// Lines that were too many to be drawn.
    pub left_out: usize,
}

impl Lines {
    /// The silhouettes of the casters of a light.
    #[must_use]
    pub fn silhouettes(anatomy: &Anatomy, capture: &Capture, light: usize) -> Lines {
        let projector = Projector::new(capture);
        let mut lines = Lines::default();
        for silhouette in anatomy.silhouettes.iter().filter(|silhouette| silhouette.light == light) {
            let positions = &anatomy.objects[silhouette.caster].positions;
            for edge in &silhouette.edges {
                let ends = [edge.edge.low, edge.edge.high].map(|end| positions[end as usize].extend(1.0));
                lines.add(projector.segment(ends), LineKind::Silhouette(edge.multiplicity));
            }
        }
        lines
    }

    /// The edges of the shadow volumes of a light, each once a part.
    #[must_use]
    pub fn volumes(anatomy: &Anatomy, capture: &Capture, light: usize) -> Lines {
        let projector = Projector::new(capture);
        let mut lines = Lines::default();
        for volume in anatomy.volumes.iter().filter(|volume| volume.light == light) {
            for part in &volume.parts {
                let sides = part.triangles.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]);
                let edges: BTreeSet<[u32; 2]> = sides.map(|[from, to]| [from.min(to), from.max(to)]).collect();
                for edge in edges {
                    let ends = edge.map(|end| volume.vertices[end as usize]);
                    lines.add(projector.segment(ends), LineKind::Volume(part.part));
                }
            }
        }
        lines
    }

    fn add(&mut self, ends: Option<[DVec2; 2]>, kind: LineKind) {
        let Some(ends) = ends else { return };
        if self.lines.len() < MOST_LINES {
            self.lines.push((ends, kind));
        } else {
            self.left_out += 1;
        }
    }

    /// The lines on the screen, with soft edges.
    #[must_use]
    pub fn mesh(&self, placement: Placement, theme: &Theme, pixels_per_point: f32) -> Arc<Mesh> {
        let mut mesh = Mesh::default();
        let place = |at: DVec2| placement.origin + vec2(at.x as f32, at.y as f32) * placement.scale;
        for (ends, kind) in &self.lines {
            let (color, width) = style(*kind, theme);
            add_line(&mut mesh, ends.map(place), color, width, 1.0 / pixels_per_point);
        }
        Arc::new(mesh)
    }
}

/// Colour and width in points.
fn style(kind: LineKind, theme: &Theme) -> (Color32, f32) {
    match kind {
        LineKind::Silhouette(multiplicity) => (theme.lit, 0.6 + 0.6 * multiplicity.unsigned_abs().min(3) as f32),
        LineKind::Volume(part) => (theme.part(part).unwrap_or(theme.dim).gamma_multiply(0.32), 0.6),
    }
}

/// A strip of four rails: outside see-through, inside full.
fn add_line(mesh: &mut Mesh, [from, to]: [Pos2; 2], color: Color32, width: f32, soft: f32) {
    let along = (to - from).normalized();
    let across = vec2(-along.y, along.x);
    let first = mesh.vertices.len() as u32;
    let rails = [
        (-width / 2.0 - soft, Color32::TRANSPARENT),
        (-width / 2.0, color),
        (width / 2.0, color),
        (width / 2.0 + soft, Color32::TRANSPARENT),
    ];
    for end in [from, to] {
        mesh.vertices.extend(rails.map(|(aside, color)| Vertex { pos: end + across * aside, uv: WHITE_UV, color }));
    }
    for rail in first..first + 3 {
        mesh.indices.extend([rail, rail + 1, rail + 4, rail + 1, rail + 5, rail + 4]);
    }
}

/// A mesh that is placed again only where something it depends on has changed.
#[derive(Debug, Default)]
pub struct PlacedLines {
    key: Option<(Placement, bool, u32)>,
    mesh: Arc<Mesh>,
}

impl PlacedLines {
    /// The mesh of `lines`.
    pub fn of(&mut self, lines: &Lines, placement: Placement, theme: &Theme, is_dark: bool, pixels: f32) -> Arc<Mesh> {
        let key = Some((placement, is_dark, pixels.to_bits()));
        if self.key != key {
            self.key = key;
            self.mesh = lines.mesh(placement, theme, pixels);
        }
        self.mesh.clone()
    }
}

/// The middle of a texel on the screen.
#[must_use]
pub fn middle(placement: Placement, at: [u32; 2]) -> Pos2 {
    let Rect { min, max } = placement.rect_of(at);
    pos2((min.x + max.x) / 2.0, (min.y + max.y) / 2.0)
}

//! Lines of overlays as one mesh: projected once for each frame of the scene, placed once for each view.

use crate::anatomy::Anatomy;
use crate::capture::Capture;
use crate::inspector::canvas::placement::Placement;
use crate::inspector::look::theme::Theme;
use crate::plan::DrawPart;
use crate::reading::projected::Projector;
use egui::epaint::{Mesh, Vertex, WHITE_UV};
use egui::{Color32, Pos2, Rect, pos2, vec2};
use glam::DVec2;
use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

/// The largest number of lines that are drawn.
const MOST_LINES: usize = 24_000;
/// An edge's multiplicity is written where the edge is at least so long on the screen, points.
const LEAST_EDGE: f32 = 44.0;
/// The largest number of multiplicities that are written.
const MOST_NUMBERS: usize = 400;
/// Width and height of a written multiplicity, points.
const NUMBER_SIZE: [f32; 2] = [26.0, 18.0];

/// What a line belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineKind {
    /// A silhouette edge, with its multiplicity.
    Silhouette(i32),
    /// An edge of a part of a shadow volume.
    Volume(DrawPart),
}

/// Lines over the picture, in texels of the picture; those beyond a limit are only counted.
#[derive(Debug, Default)]
pub struct OverlayLines {
    /// Both ends of each line, and what it belongs to.
    pub lines: Vec<([DVec2; 2], LineKind)>,
    /// How many lines are not drawn, as there are too many.
    pub left_out: usize,
}

impl OverlayLines {
    /// Returns the silhouette edges of all casters of a light, projected onto the picture; parts that are not in front
    /// of the camera are cut off.
    pub fn silhouettes(anatomy: &Anatomy, capture: &Capture, light: usize) -> OverlayLines {
        let projector = Projector::new(capture);
        let mut lines = OverlayLines::default();
        for silhouette in anatomy.silhouettes.iter().filter(|silhouette| silhouette.light == light) {
            let positions = &anatomy.objects[silhouette.caster].positions;
            for edge in &silhouette.edges {
                let ends = [edge.edge.low, edge.edge.high].map(|end| positions[end as usize].extend(1.0));
                lines.add(projector.segment(ends), LineKind::Silhouette(edge.multiplicity));
            }
        }
        lines
    }

    /// Returns the triangle edges of all shadow volumes of a light, projected onto the picture; an edge that triangles
    /// share is there once for each part (side, light cap, dark cap) that it belongs to.
    pub fn volumes(anatomy: &Anatomy, capture: &Capture, light: usize) -> OverlayLines {
        let projector = Projector::new(capture);
        let mut lines = OverlayLines::default();
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

    /// Returns the silhouette edges whose multiplicity is neither 1 nor −1, in points on the screen, with their
    /// multiplicity.
    fn counting(&self, placement: Placement) -> impl Iterator<Item = ([Pos2; 2], i32)> {
        self.lines.iter().filter_map(move |(ends, kind)| match kind {
            LineKind::Silhouette(multiplicity) if multiplicity.unsigned_abs() != 1 => {
                Some((ends.map(|end| on_screen(placement, end)), *multiplicity))
            }
            LineKind::Silhouette(_) | LineKind::Volume(_) => None,
        })
    }

    /// Returns the multiplicities to write, each with the middle of its edge on the screen: of edges whose multiplicity
    /// is not ±1, that are at least 44 points long, and whose numbers lie wholly in `seen` and do not overlap an
    /// earlier one; at most 400.
    pub fn numbers(&self, placement: Placement, seen: Rect) -> Vec<(Pos2, i32)> {
        let mut numbers: Vec<(Pos2, i32)> = Vec::new();
        let mut taken = TakenCells::default();
        for ([from, to], multiplicity) in self.counting(placement) {
            let at = from + (to - from) / 2.0;
            let area = Rect::from_center_size(at, NUMBER_SIZE.into());
            let is_legible = (to - from).length() >= LEAST_EDGE && seen.contains_rect(area);
            if is_legible && taken.take(at) {
                numbers.push((at, multiplicity));
            }
            if numbers.len() == MOST_NUMBERS {
                break;
            }
        }
        numbers
    }

    /// Returns the multiplicity of the edge nearest to `at` on the screen, of those whose multiplicity is not ±1;
    /// `None` where none is within `reach` points.
    pub fn number_near(&self, placement: Placement, at: Pos2, reach: f32) -> Option<i32> {
        let near = self.counting(placement).map(|(ends, multiplicity)| (distance(ends, at), multiplicity));
        let nearest = near.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
        (nearest.0 <= reach).then_some(nearest.1)
    }

    fn add(&mut self, ends: Option<[DVec2; 2]>, kind: LineKind) {
        let Some(ends) = ends else { return };
        if self.lines.len() < MOST_LINES {
            self.lines.push((ends, kind));
        } else {
            self.left_out += 1;
        }
    }

    /// Returns the lines as a mesh on the screen, with soft edges.
    pub fn mesh(&self, placement: Placement, theme: &Theme, pixels_per_point: f32) -> Arc<Mesh> {
        let mut mesh = Mesh::default();
        for (ends, kind) in &self.lines {
            let (color, width) = style(*kind, theme);
            add_line(&mut mesh, ends.map(|end| on_screen(placement, end)), color, width, 1.0 / pixels_per_point);
        }
        Arc::new(mesh)
    }
}

/// Where numbers are written, by cells of a number's size: each contains at most one middle, so that a number overlaps
/// only numbers of the cells beside its own.
#[derive(Debug, Default)]
struct TakenCells(HashMap<[i32; 2], Pos2>);

impl TakenCells {
    /// Reserves the space of a number with its middle at `at`, and returns true; returns false, and reserves nothing,
    /// where it would overlap one that was reserved before.
    fn take(&mut self, at: Pos2) -> bool {
        let [width, height] = NUMBER_SIZE;
        let cell = [(at.x / width).floor() as i32, (at.y / height).floor() as i32];
        let lies_on = |other: &Pos2| (other.x - at.x).abs() < width && (other.y - at.y).abs() < height;
        let beside = (-1..=1).flat_map(|column| (-1..=1).map(move |row| [cell[0] + column, cell[1] + row]));
        let is_free = !beside.filter_map(|cell| self.0.get(&cell)).any(lies_on);
        if is_free {
            self.0.insert(cell, at);
        }
        is_free
    }
}

fn on_screen(placement: Placement, at: DVec2) -> Pos2 {
    placement.origin + vec2(at.x as f32, at.y as f32) * placement.scale
}

/// Returns the distance from a point to a segment, including its ends; a segment without length counts as a point.
fn distance([from, to]: [Pos2; 2], at: Pos2) -> f32 {
    let along = to - from;
    let share = ((at - from).dot(along) / along.length_sq().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    (from + along * share).distance(at)
}

/// Returns a multiplicity as text with its sign: `+2`, `−2`; 0 is `+0`.
pub fn multiplicity(value: i32) -> String {
    format!("{}{}", if value < 0 { "−" } else { "+" }, value.unsigned_abs())
}

/// Returns the colour of a kind of line, and its width in points: a silhouette edge is wider the larger its
/// multiplicity, up to 3.
fn style(kind: LineKind, theme: &Theme) -> (Color32, f32) {
    match kind {
        LineKind::Silhouette(multiplicity) => (theme.lit, 0.6 + 0.6 * multiplicity.unsigned_abs().min(3) as f32),
        LineKind::Volume(part) => (theme.part(part).unwrap_or(theme.dim).gamma_multiply(0.32), 0.6),
    }
}

/// Adds a line of `width` points to a mesh, with edges that fade out over `soft` points on both sides.
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
    numbers_key: Option<(Placement, Rect)>,
    numbers: Arc<Vec<(Pos2, i32)>>,
}

impl PlacedLines {
    /// Returns the mesh of `lines` on the screen; it is built again only where placement, theme or pixels for each
    /// point have changed, so that one `PlacedLines` belongs to one set of lines.
    pub fn of(
        &mut self,
        lines: &OverlayLines,
        placement: Placement,
        theme: &Theme,
        is_dark: bool,
        pixels: f32,
    ) -> Arc<Mesh> {
        let key = Some((placement, is_dark, pixels.to_bits()));
        if self.key != key {
            self.key = key;
            self.mesh = lines.mesh(placement, theme, pixels);
        }
        self.mesh.clone()
    }

    /// Returns the multiplicities of `lines` that can be read in `seen`, as [`OverlayLines::numbers`] does; computed
    /// again only where placement or `seen` has changed, so that one `PlacedLines` belongs to one set of lines.
    pub fn numbers(&mut self, lines: &OverlayLines, placement: Placement, seen: Rect) -> Arc<Vec<(Pos2, i32)>> {
        let key = Some((placement, seen));
        if self.numbers_key != key {
            self.numbers_key = key;
            self.numbers = Arc::new(lines.numbers(placement, seen));
        }
        self.numbers.clone()
    }
}

/// Returns the middle of a texel on the screen.
pub fn middle(placement: Placement, at: [u32; 2]) -> Pos2 {
    let Rect { min, max } = placement.rect_of(at);
    pos2((min.x + max.x) / 2.0, (min.y + max.y) / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEEN: Rect = Rect { min: Pos2::ZERO, max: Pos2::new(400.0, 300.0) };

    fn lines(edges: &[([[f64; 2]; 2], i32)]) -> OverlayLines {
        let lines = edges.iter().map(|(ends, times)| (ends.map(DVec2::from_array), LineKind::Silhouette(*times)));
        OverlayLines { lines: lines.collect(), left_out: 0 }
    }

    fn placed(scale: f32) -> Placement {
        Placement { origin: Pos2::ZERO, scale, size: [400, 300] }
    }

    #[test]
    fn what_counts_twice_is_numbered_where_its_edge_is_long_and_in_sight() {
        let long = [[10.0, 100.0], [90.0, 100.0]];
        let lines = lines(&[
            (long, 1),
            ([[10.0, 40.0], [90.0, 40.0]], -2),
            ([[200.0, 40.0], [230.0, 40.0]], 2),
            ([[390.0, 0.0], [430.0, 200.0]], 2),
        ]);
        assert_eq!(lines.numbers(placed(1.0), SEEN), [(pos2(50.0, 40.0), -2)]);
        // Twice as large the short one is long enough.
        assert_eq!(lines.numbers(placed(2.0), SEEN).len(), 1, "and out of sight");
        let wide = Rect::from_min_max(Pos2::ZERO, pos2(900.0, 600.0));
        let found: Vec<i32> = lines.numbers(placed(2.0), wide).into_iter().map(|(_, times)| times).collect();
        assert_eq!(found, [-2, 2, 2]);
    }

    #[test]
    fn numbers_do_not_lie_on_one_another() {
        let many: Vec<_> =
            (0..30).map(|row| ([[0.0, f64::from(row) + 20.0], [100.0, f64::from(row) + 20.0]], 2)).collect();
        let numbers = lines(&many).numbers(placed(1.0), SEEN);
        assert!((1..4).contains(&numbers.len()), "{numbers:?}");
        assert!(numbers.windows(2).all(|pair| pair[1].0.y - pair[0].0.y >= NUMBER_SIZE[1]));
    }

    #[test]
    fn many_thousand_edges_are_numbered_as_if_each_were_held_against_all() {
        let mut state = 7_u32;
        let mut random = |most: f64| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24) * most
        };
        let edge = |x: f64, y: f64| ([[x, y], [x + 60.0, y]], 2);
        let many: Vec<_> = (0..20_000).map(|_| edge(random(400.0), random(300.0))).collect();
        let found = lines(&many).numbers(placed(1.0), SEEN);
        let mut expected: Vec<Pos2> = Vec::new();
        for ([from, to], _) in &many {
            let [from, to] = [from, to].map(|end| pos2(end[0] as f32, end[1] as f32));
            let at = from + (to - from) / 2.0;
            let area = Rect::from_center_size(at, NUMBER_SIZE.into());
            let [width, height] = NUMBER_SIZE;
            let lies_on = |other: &Pos2| (other.x - at.x).abs() < width && (other.y - at.y).abs() < height;
            if SEEN.contains_rect(area) && !expected.iter().any(lies_on) {
                expected.push(at);
            }
        }
        let found: Vec<Pos2> = found.into_iter().map(|(at, _)| at).collect();
        assert!(found.len() > 60, "{}", found.len());
        assert_eq!(found, expected);
    }

    #[test]
    fn under_the_pointer_the_nearest_edge_that_counts_twice_is_reported_however_short() {
        let lines = lines(&[
            ([[10.0, 10.0], [14.0, 10.0]], 3),
            ([[10.0, 16.0], [300.0, 16.0]], -2),
            ([[0.0, 0.0], [9.0, 9.0]], 1),
        ]);
        let near = |x, y| lines.number_near(placed(1.0), pos2(x, y), 5.0);
        assert_eq!(near(12.0, 12.0), Some(3));
        assert_eq!(near(200.0, 20.0), Some(-2));
        assert_eq!(near(200.0, 22.0), None, "too far away");
        assert_eq!(near(2.0, 2.0), None, "it counts once");
        assert_eq!([multiplicity(3), multiplicity(-2)], ["+3", "−2"]);
    }
}

//! Draws the report's plot: the same layout as on paper, in the panels' colours, its marks buttons.

use super::row;
use crate::inspector::action::Action;
use crate::inspector::look::theme::{self, Theme};
use crate::inspector::model::Model;
use crate::report::plot::{
    CLEAR, Plot, PlotInk, PlotLine, PlotPoint, PlotRect, PlotText, RADIUS, SceneChart, TechniqueStyle, TextAnchor,
};
use crate::report::{Report, ReportRow};
use egui::epaint::{Mesh, Vertex, WHITE_UV};
use egui::{
    Align2, Color32, CornerRadius, FontId, Id, Painter, Pos2, Rect, Role, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo,
    pos2, vec2,
};

/// Side of the area in which the pointer is over a mark, points.
const TARGET: f32 = 18.0;
/// Radius of the ring around the selected or hovered mark: with its stroke it lies in what texts leave free.
const RING: f32 = CLEAR as f32 - 1.2;

/// Draws `plot` at the next free place in its own size; a click on a row's mark adds the action that renders with its
/// technique and settings.
pub fn ui(ui: &mut Ui, model: &Model, report: &Report, plot: &Plot, actions: &mut Vec<Action>) {
    let size = vec2(plot.size[0] as f32, plot.size[1] as f32);
    let (rect, canvas) = ui.allocate_exact_size(size, Sense::hover());
    canvas.widget_info(|| WidgetInfo::labeled(Role::Image, true, &plot.summary));
    let sheet = PlotSheet {
        painter: ui.painter().with_clip_rect(ui.clip_rect().intersect(rect)),
        corner: rect.min,
        theme: theme::of(ui),
    };
    for chart in &plot.charts {
        sheet.chart(chart);
    }
    for text in &plot.texts {
        sheet.text(text);
    }
    for chart in &plot.charts {
        for spot in &chart.spots {
            if let Some(row) = report.rows.get(spot.row) {
                mark(ui, model, &sheet, spot, row, actions);
            }
        }
    }
}

/// Draws a row's mark in the plot, a button that adds the action to render with its technique and settings; with a ring
/// where the row is what is shown now.
fn mark(ui: &mut Ui, model: &Model, sheet: &PlotSheet, spot: &PlotPoint, row: &ReportRow, actions: &mut Vec<Action>) {
    let at = sheet.place(spot.at);
    let target = Rect::from_center_size(at, Vec2::splat(TARGET));
    let response = ui.interact(target, ui.scope_id().with(("report mark", spot.row)), Sense::click());
    let is_current = row::is_current(model, row);
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_current, &spot.name));
    let ring = |color, width| sheet.painter.circle_stroke(at, RING, Stroke::new(width, color));
    if response.hovered() || response.has_focus() {
        ring(sheet.theme.focus, 1.0);
    }
    if is_current {
        ring(sheet.theme.selected, 2.0);
    }
    sheet.mark(at, spot.style, spot.filled);
    if response.clicked() {
        actions.push(row::open_row(row));
        ui.data_mut(|data| data.insert_temp(chosen_id(), row.summary()));
    }
    response.on_hover_text(&spot.details);
}

/// Where the summary of the row is that was chosen in the plot, until the table has shown it.
fn chosen_id() -> Id {
    Id::unique("row chosen in the plot")
}

/// Returns whether a row was chosen in the plot, and the table has not shown it since.
pub fn takes_chosen(ui: &Ui, row: &ReportRow) -> bool {
    let is_it = ui.data(|data| data.get_temp::<String>(chosen_id())).is_some_and(|chosen| chosen == row.summary());
    if is_it {
        ui.data_mut(|data| data.remove::<String>(chosen_id()));
    }
    is_it
}

/// Draws a technique's mark, as in the plot, around a point.
pub fn key(ui: &Ui, at: Pos2, style: &TechniqueStyle, filled: bool) {
    PlotSheet { painter: ui.painter().clone(), corner: Pos2::ZERO, theme: theme::of(ui) }.mark(at, style, filled);
}

/// The place in which a layout is drawn.
struct PlotSheet {
    painter: Painter,
    corner: Pos2,
    theme: &'static Theme,
}

impl PlotSheet {
    fn place(&self, [x, y]: [f64; 2]) -> Pos2 {
        self.corner + vec2(x as f32, y as f32)
    }

    fn chart(&self, chart: &SceneChart) {
        let PlotRect { min, max } = chart.band;
        let band = Rect::from_min_max(self.place(min), self.place(max));
        self.painter.rect_filled(band, CornerRadius::ZERO, self.theme.raised);
        for line in &chart.lines {
            self.line(line);
        }
        for spot in &chart.spots {
            let ends = spot.whisker.map(|x| self.place([x, spot.at[1]]));
            self.painter.line_segment(ends, Stroke::new(1.0, self.technique(spot.style)));
        }
        for text in &chart.labels {
            // Separates words from lines that they cover.
            let in_band = text.at[1] > chart.band.min[1];
            let words = text.rect();
            let behind = Rect::from_min_max(self.place(words.min), self.place(words.max)).shrink2(vec2(0.0, 1.5));
            let fill = if in_band { self.theme.raised } else { self.theme.panel };
            self.painter.rect_filled(behind, CornerRadius::same(2), fill.gamma_multiply(0.8));
            self.text(text);
        }
        for text in &chart.texts {
            self.text(text);
        }
    }

    fn line(&self, line: &PlotLine) {
        let color = if line.faint { self.ink(line.ink).gamma_multiply(0.45) } else { self.ink(line.ink) };
        let points = line.points.iter().map(|point| self.place(*point)).collect();
        self.painter.line(points, Stroke::new(line.width as f32, color));
    }

    fn text(&self, text: &PlotText) {
        let anchor = match text.anchor {
            TextAnchor::Start => Align2::LEFT_CENTER,
            TextAnchor::Middle => Align2::CENTER_CENTER,
            TextAnchor::End => Align2::RIGHT_CENTER,
        };
        let font = FontId::proportional(text.size as f32);
        let (at, color) = (self.place(text.at), self.ink(text.ink));
        self.painter.text(at, anchor, &text.text, font.clone(), color);
        if text.strong {
            // As in `theme::heading`: the font has one weight.
            self.painter.text(at + vec2(0.4, 0.0), anchor, &text.text, font, color);
        }
    }

    fn mark(&self, at: Pos2, style: &TechniqueStyle, filled: bool) {
        let outline: Vec<Pos2> =
            style.mark.outline(RADIUS).into_iter().map(|[x, y]| at + vec2(x as f32, y as f32)).collect();
        let color = self.technique(style);
        self.painter.add(fan(at, &outline, if filled { color } else { self.theme.panel }));
        self.painter.add(Shape::closed_line(outline, Stroke::new(1.3, color)));
    }

    /// Returns a technique's hue: on a light background that of the printed report.
    fn technique(&self, style: &TechniqueStyle) -> Color32 {
        let [red, green, blue] = if *self.theme == theme::LIGHT { style.paper } else { style.screen };
        Color32::from_rgb(red, green, blue)
    }

    fn ink(&self, ink: PlotInk) -> Color32 {
        match ink {
            PlotInk::Text => self.theme.text,
            PlotInk::Dim | PlotInk::Front => self.theme.dim,
            PlotInk::Grid => self.theme.line,
            PlotInk::Technique(style) => self.technique(style),
        }
    }
}

/// Returns an outline's area as a fan of triangles around `middle`, from which every corner must be visible; the
/// outline may be concave.
fn fan(middle: Pos2, outline: &[Pos2], color: Color32) -> Mesh {
    let mut mesh = Mesh::default();
    let corners = [middle].into_iter().chain(outline.iter().copied());
    mesh.vertices.extend(corners.map(|pos| Vertex { pos, uv: WHITE_UV, color }));
    let count = outline.len() as u32;
    for corner in 0..count {
        mesh.add_triangle(0, 1 + corner, 1 + (corner + 1) % count);
    }
    mesh
}

/// Returns the middle of a row's sign in the table.
pub fn sign_at(row: Rect) -> Pos2 {
    pos2(row.left() + 16.0, row.center().y)
}

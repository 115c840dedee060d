//! The passes of the frame as a tree: scene and lights, their passes in order, the draws of the
//! selected one, what was left out, and why the selected pass is there.

pub mod debug_groups;
pub mod draws;
pub mod fields;
pub mod thumbnail;
pub mod transport;

use crate::capture::{Capture, Step};
use crate::inspector::look::theme;
use crate::inspector::model::{Model, StepSearch};
use crate::reading::format;
use crate::reading::steps;
use crate::reading::written::WrittenAspects;
use egui::{CornerRadius, Margin, Rect, Role, Sense, Stroke, StrokeKind, TextStyle, Ui, WidgetInfo, pos2, vec2};
pub use fields::PassesPanel;
use std::sync::Arc;
use thumbnail::{colored, paint_row_background, paint_thumbnail};

/// In a lower panel, points, why the pass is there stands below the passes, and scrolls with them.
const LEAST_HEIGHT: f32 = 240.0;

/// The words in a mask's row.
const BESIDE: &str = "beside the frame";
/// What that means.
const IS_BESIDE: &str = "no pass of the frame. stencilscope draws it after the frame's own, by the same stencil or maps, to \
                         know which pixels the light reaches";

/// Draws the panel Passes: controls, the frame's passes and draws in order, what was left out, and why the selected
/// pass is there. Without a capture or passes, only a hint. Requests to search and to scroll to the selected row are
/// carried out.
pub fn ui(ui: &mut Ui, own: &mut PassesPanel, model: &mut Model) {
    if let Some(search) = model.requests.search.take() {
        own.search = Some(search);
        own.search_wants_focus = true;
    }
    let Some(capture) = model.frame.capture.clone() else { return empty(ui, model) };
    if capture.steps.is_empty() {
        ui.label(theme::note("This capture has no passes."));
        return;
    }
    transport::ui(ui, own, model);
    debug_groups::origin(ui, model);
    let step = model.selection.step.min(capture.steps.len() - 1);
    let is_low = ui.available_height() < LEAST_HEIGHT;
    if !is_low {
        purpose(ui, &capture.steps[step]);
    }
    // In a list of another height, as in another layout, the selected row may be out of view.
    let height = ui.available_height();
    model.selection.wants_scroll |= std::mem::replace(&mut own.height, height) != height;
    egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        tree(ui, own, model, &capture);
        draws::left_out(ui, &capture.left_out);
        if is_low {
            ui.add_space(8.0);
            why(ui, &capture.steps[step]);
        }
    });
    model.selection.wants_scroll = false;
}

fn empty(ui: &mut Ui, model: &Model) {
    let text = match &model.activity.job {
        Some(_) => "The passes appear here as soon as the frame is captured.",
        None => "Nothing is open. Open a scene, a model or a capture folder, or drop one onto this window.",
    };
    ui.add(egui::Label::new(theme::note(text)).wrap());
}

fn tree(ui: &mut Ui, own: &mut PassesPanel, model: &mut Model, capture: &Arc<Capture>) {
    let filter = match &own.search {
        Some(StepSearch::Find(words)) => words.clone(),
        _ => String::new(),
    };
    let groups = debug_groups::DebugGroups::new(own, model);
    let mut group = None;
    let mut found = 0;
    for (index, step) in capture.steps.iter().enumerate() {
        if !transport::matches(step, &filter) {
            continue;
        }
        found += 1;
        if let Some(groups) = &groups {
            let Some(levels) = groups.above(ui, own, index) else { continue };
            debug_groups::indented(ui, levels, |ui| {
                pass_row(ui, model, capture, index);
                if index == model.selection.step {
                    draws::of_step(ui, own, model, capture);
                }
            });
            continue;
        }
        if group.replace(step.light) != Some(step.light) {
            let last = capture.steps[index..].iter().take_while(|other| other.light == step.light).count();
            group_heading(ui, model, capture, step.light, index + last - 1);
        }
        pass_row(ui, model, capture, index);
        if index == model.selection.step {
            draws::of_step(ui, own, model, capture);
        }
    }
    if found == 0 {
        ui.add_space(8.0);
        ui.label(theme::note("No pass has these words. Escape shows all again."));
    }
}

/// Draws the heading of a light's passes, or of the scene's for `None`; a click selects the pass `last`, whose state is
/// the one after all of them, and stops playing.
fn group_heading(ui: &mut Ui, model: &mut Model, capture: &Capture, light: Option<usize>, last: usize) {
    ui.add_space(8.0);
    let text = match light {
        None => "Scene".to_owned(),
        Some(index) => {
            let kind = capture.lights.get(index).map_or("", |light| kind_of(light.position));
            format!("Light {}{kind}", index + 1)
        }
    };
    let heading = ui.add(egui::Label::new(theme::note(&text)).selectable(false).sense(Sense::click()));
    heading.widget_info(|| WidgetInfo::selected(Role::TreeItem, true, false, &text));
    if heading.has_focus() {
        let outline = Stroke::new(1.0, theme::of(ui).focus);
        ui.painter().rect_stroke(heading.rect.expand(2.0), CornerRadius::same(2), outline, StrokeKind::Outside);
    }
    if heading.on_hover_text(format!("The state after step {}, the last of these", last + 1)).clicked() {
        model.selection.playing = None;
        model.select_step(last);
    }
    ui.add_space(2.0);
}

/// Returns the kind of a light from its homogeneous position, with a separator in front: ` · point`, ` · directional`
/// (w is 0), or ` · not found` where all four are zero, as for a position that is not known.
fn kind_of(position: glam::DVec4) -> &'static str {
    match position.w {
        _ if position == glam::DVec4::ZERO => " · not found",
        0.0 => " · directional",
        _ => " · point",
    }
}

/// Draws the row of one pass, which a click selects: thumbnail of what it wrote, number and name, what it drew, its GPU
/// time, and a mark where it touched the picked pixel. A pass beside the frame (a mask) is dim.
fn pass_row(ui: &mut Ui, model: &mut Model, capture: &Arc<Capture>, index: usize) {
    let step = &capture.steps[index];
    let is_selected = index == model.selection.step && model.selection.draw.is_none();
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), theme::PASS_ROW_HEIGHT), Sense::click());
    let title = steps::title(capture, index);
    response.widget_info(|| WidgetInfo::selected(Role::TreeItem, true, is_selected, &title));
    if is_selected && model.selection.wants_scroll {
        response.scroll_to_me(None);
    }
    if response.clicked() {
        model.selection.playing = None;
        model.select_step(index);
        model.selection.wants_scroll = false;
    }
    if !ui.is_rect_visible(rect) {
        return;
    }
    paint_row_background(ui, rect, is_selected, response.hovered(), response.has_focus());
    let thumbnail = Rect::from_min_size(rect.min + vec2(8.0, 6.0), vec2(52.0, 32.0));
    let written = colored(model, WrittenAspects::by_step(capture, index));
    paint_thumbnail(ui, model, written, thumbnail);
    let left = thumbnail.right() + 8.0;
    let (colors, painter) = (theme::of(ui), ui.painter());
    let lay = |text: String, style: TextStyle| painter.layout_no_wrap(text, style.resolve(ui.style()), colors.dim);
    let time = lay(format::milliseconds(step.gpu_ms), TextStyle::Monospace);
    let mut width = rect.right() - 8.0 - left;
    // The name says more than the time, which the tooltip has too.
    if lay(title.clone(), TextStyle::Body).size().x + time.size().x + 8.0 <= width {
        let corner = pos2(rect.right() - 8.0 - time.size().x, rect.top() + 14.0 - time.size().y / 2.0);
        width = corner.x - left - 4.0;
        painter.galley(corner, time, colors.dim);
    }
    // A step that is not part of the frame is dim.
    let is_beside = steps::is_beside(capture, index);
    let ink = if is_beside { theme::of(ui).dim } else { theme::of(ui).text };
    theme::name_line(ui, pos2(left, rect.top() + 6.0), width, &title, TextStyle::Body, ink);
    let is_touched = model.history_of_frame().is_some_and(|one| one.is_touched_by(index));
    if is_touched {
        pick_mark(ui, pos2(rect.right() - 14.0, rect.top() + 31.0), &steps::words(capture, index));
    }
    let width = rect.right() - if is_touched { 26.0 } else { 8.0 } - left;
    let is_in_group = model.frame.plan.as_ref().is_some_and(|plan| !debug_groups::groups_of(plan, index).is_empty());
    let light = step.light.filter(|_| is_in_group).map(|light| format!("{} · ", format::light(light)));
    let summary = light.unwrap_or_default() + &if is_beside { BESIDE.to_owned() } else { summary(step) };
    theme::line(ui, pos2(left, rect.top() + 23.0), width, &summary, TextStyle::Small, theme::of(ui).dim);
    let time = format::milliseconds(step.gpu_ms);
    response.on_hover_text(match is_beside {
        true => format!("{title}: {IS_BESIDE}\n{time}"),
        false => format!("{title}\n{summary}\n{time}"),
    });
}

/// Draws a small crosshair with its middle at `at`, which says that the pass named `step` did something to the picked
/// pixel.
fn pick_mark(ui: &Ui, at: egui::Pos2, step: &str) {
    let place = Rect::from_center_size(at, egui::Vec2::splat(12.0));
    let response = ui.interact(place, ui.scope_id().with(("pick mark", step)), Sense::hover());
    let name = format!("{step} touched the picked pixel");
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
    let stroke = Stroke::new(1.2, theme::of(ui).text);
    ui.painter().rect_stroke(
        Rect::from_center_size(at, vec2(5.0, 5.0)),
        CornerRadius::ZERO,
        stroke,
        StrokeKind::Middle,
    );
    for direction in [vec2(1.0, 0.0), vec2(-1.0, 0.0), vec2(0.0, 1.0), vec2(0.0, -1.0)] {
        ui.painter().line_segment([at + direction * 3.5, at + direction * 6.0], stroke);
    }
    response.on_hover_text("This pass did something to the picked pixel");
}

fn summary(step: &Step) -> String {
    if step.draws.is_empty() {
        return "no draws".to_owned();
    }
    let draws = format::counted(step.draws.len() as u64, "draw");
    let differing = step.draws.iter().filter(|draw| draw.differs.is_some_and(|differs| !differs.is_nowhere())).count();
    let differing = match differing {
        0 => String::new(),
        1 => " · 1 differs".to_owned(),
        count => format!(" · {count} differ"),
    };
    format!("{draws}{differing} · {}", format::counted(step.triangles(), "triangle"))
}

/// Draws at the panel's foot why the step is there.
fn purpose(ui: &mut Ui, step: &Step) {
    let frame = egui::Frame::new().inner_margin(Margin { top: 8, ..Margin::ZERO });
    let panel = egui::Panel::bottom("why this pass").frame(frame).show_separator_line(false).resizable(false);
    panel.show(ui, |ui| why(ui, step));
}

fn why(ui: &mut Ui, step: &Step) {
    theme::card(ui).show(ui, |ui| {
        ui.set_width(ui.available_width());
        theme::heading(ui, "Why this pass");
        ui.add(egui::Label::new(theme::note(step.purpose.as_str())).wrap());
    });
}

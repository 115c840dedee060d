//! The Stencil test tab: the test by itself. One pixel, one state, and fragments sent through it one by one.

use crate::history::operation_name;
use crate::inspector::look::number_field::number_field;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::plan::{RasterState, StencilFace};
use crate::reading::bench::{COMPARES, TestBench, TestedDraw, name};
use egui::{ComboBox, Grid, Label, Ui, vec2};
use wgpu::{CompareFunction, StencilOperation};

const OPERATIONS: [StencilOperation; 8] = [
    StencilOperation::Keep,
    StencilOperation::Zero,
    StencilOperation::Replace,
    StencilOperation::Invert,
    StencilOperation::IncrementClamp,
    StencilOperation::DecrementClamp,
    StencilOperation::IncrementWrap,
    StencilOperation::DecrementWrap,
];

/// Selects one of a face's operations.
type FaceOperation = fn(&mut StencilFace) -> &mut StencilOperation;

/// Width of a list, points, below which names of operations do not fit into it.
const NARROW_LIST: f32 = 128.0;
/// Width of a field for a number, points.
const FIELD_WIDTH: f32 = 48.0;

/// Draws the tab Stencil test: one pixel, one stencil and depth state, and fragments that are sent through it one by one.
pub fn ui(ui: &mut Ui, own: &mut TestBench, model: &Model) {
    egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        let text = "One pixel and the tests of one draw. Push fragments: each is tested as the GPU would, the stencil \
                    first, then the depth, and one operation changes what is held.";
        ui.add(Label::new(theme::note(text)).wrap());
        ui.add_space(8.0);
        take_over(ui, own, model);
        pixel(ui, own);
        ui.add_space(8.0);
        state(ui, &mut own.state);
        ui.add_space(8.0);
        push(ui, own);
        ui.add_space(8.0);
        pushed(ui, own);
    });
}

/// Draws a button that copies the raster state of the selected draw, or of the step's last draw where none is selected,
/// into the bench; and one that resets the bench. Off where the step draws nothing.
fn take_over(ui: &mut Ui, own: &mut TestBench, model: &Model) {
    let plan = model.frame.plan.clone();
    let pass = plan.as_ref().and_then(|plan| plan.passes.get(model.selection.step));
    let draw =
        pass.and_then(|pass| model.selection.draw.and_then(|draw| pass.draws.get(draw)).or_else(|| pass.draws.last()));
    ui.horizontal_wrapped(|ui| {
        let hover = draw
            .map_or_else(|| "The selected step draws nothing".to_owned(), |draw| format!("As `{}` has it", draw.name));
        let button = ui.add_enabled(draw.is_some(), egui::Button::new("Take the selected draw's state"));
        if button.on_hover_text(&hover).on_disabled_hover_text(&hover).clicked()
            && let Some(draw) = draw
        {
            own.state = draw.raster.clone();
        }
        if ui.button("Start again").on_hover_text("The state of z-fail over an empty count").clicked() {
            *own = TestBench::default();
        }
    });
}

fn pixel(ui: &mut Ui, own: &mut TestBench) {
    theme::heading(ui, "The pixel holds");
    ui.horizontal_wrapped(|ui| {
        number(ui, "stencil held", &mut own.stored.stencil);
        ui.label(theme::number(bits(own.stored.stencil)).color(theme::of(ui).dim));
        depth(ui, "depth held", &mut own.stored.depth);
    });
}

fn state(ui: &mut Ui, state: &mut RasterState) {
    theme::heading(ui, "The draw's tests");
    let mut masks = state.face(true).1;
    // The first column has the names of the rows, the rest of the width is for two columns.
    let width = ((ui.available_width() - 84.0) / 2.0 - 8.0).clamp(60.0, 150.0);
    Grid::new("bench faces").num_columns(3).spacing([8.0, 4.0]).show(ui, |ui| {
        for title in ["", "front faces", "back faces"] {
            ui.label(theme::note(title));
        }
        ui.end_row();
        let [front, back] = [&mut state.stencil.front, &mut state.stencil.back];
        ui.label(theme::note("function"))
            .on_hover_text("Passes where the reference is so to what is stored, both masked");
        compare(ui, "front function", width, &mut front.compare);
        compare(ui, "back function", width, &mut back.compare);
        ui.end_row();
        let rows: [(&str, FaceOperation); 3] = [
            ("stencil fails", |face| &mut face.fail_op),
            ("depth fails", |face| &mut face.depth_fail_op),
            ("both pass", |face| &mut face.pass_op),
        ];
        for (what, of) in rows {
            ui.label(theme::note(what));
            operation(ui, &format!("front, {what}"), width, of(front));
            operation(ui, &format!("back, {what}"), width, of(back));
            ui.end_row();
        }
    });
    ui.horizontal_wrapped(|ui| {
        let mut changed = number(ui, "reference", &mut masks.reference);
        changed |= number(ui, "read mask", &mut masks.read);
        changed |= number(ui, "write mask", &mut masks.write);
        if changed {
            // One reference and one pair of masks for both faces, as WebGPU has it.
            state.back = None;
            state.stencil_reference = masks.reference;
            (state.stencil.read_mask, state.stencil.write_mask) = (masks.read.into(), masks.write.into());
        }
    });
    ui.horizontal_wrapped(|ui| {
        ui.label(theme::note("depth"));
        compare(ui, "depth function", 96.0, &mut state.depth_compare);
        ui.checkbox(&mut state.depth_write, "writes depth");
    });
}

fn push(ui: &mut Ui, own: &mut TestBench) {
    theme::heading(ui, "A fragment comes");
    ui.horizontal_wrapped(|ui| {
        depth(ui, "its depth", &mut own.depth);
        for (name, is_front) in [("Push a front face", true), ("Push a back face", false)] {
            if ui.button(name).clicked() {
                own.push(is_front);
            }
        }
    });
}

/// Draws the list of tested fragments, the newest on top.
fn pushed(ui: &mut Ui, own: &TestBench) {
    for TestedDraw { number, words } in own.pushed.iter().rev() {
        ui.add(Label::new(theme::note(format!("{number}. {words}"))).wrap());
    }
}

fn compare(ui: &mut Ui, label: &str, width: f32, value: &mut CompareFunction) {
    let before = name(*value);
    list(ui, label, width, before, |ui| {
        for (one, name, _) in COMPARES {
            ui.selectable_value(value, one, name);
        }
    });
}

/// Returns the name of an operation with a sign in place of a long word.
fn signed(operation: StencilOperation) -> &'static str {
    match operation {
        StencilOperation::IncrementClamp => "+1 clamp",
        StencilOperation::DecrementClamp => "−1 clamp",
        StencilOperation::IncrementWrap => "+1 wrap",
        StencilOperation::DecrementWrap => "−1 wrap",
        other => operation_name(other),
    }
}

fn operation(ui: &mut Ui, label: &str, width: f32, value: &mut StencilOperation) {
    // In a narrow panel the end of a name is what distinguishes it.
    let before = if width < NARROW_LIST { signed(*value) } else { operation_name(*value) };
    list(ui, label, width, before, |ui| {
        for one in OPERATIONS {
            ui.selectable_value(value, one, operation_name(one));
        }
    });
}

/// Draws a list in so many points, whatever word is chosen; a tooltip says the whole word.
fn list(ui: &mut Ui, label: &str, width: f32, chosen: &str, lines: impl FnOnce(&mut Ui)) {
    ui.allocate_ui(vec2(width, ui.spacing().interact_size.y), |ui| {
        ui.set_max_width(width);
        let combo = ComboBox::from_id_salt(label).selected_text(theme::note(chosen)).width(width).truncate();
        let shown = combo.show_ui(ui, lines);
        shown.response.on_hover_text(format!("{label}: {chosen}")).accessible_name(label);
    });
}

/// Draws the name of a field that comes next, in a new row where both do not fit into this one.
fn name_of_field(ui: &mut Ui, name: &str) {
    let font = egui::FontId::proportional(theme::SMALL_SIZE);
    let word = ui.painter().layout_no_wrap(name.to_owned(), font, egui::Color32::PLACEHOLDER).size().x;
    if word + ui.spacing().item_spacing.x + FIELD_WIDTH > ui.available_size_before_wrap().x {
        ui.end_row();
    }
    ui.label(theme::note(name));
}

fn number(ui: &mut Ui, name: &str, value: &mut u8) -> bool {
    name_of_field(ui, name);
    let hover = bits(*value);
    ui.add(number_field(value, 0.0..=255.0, |widget| widget)).on_hover_text(hover).accessible_name(name).changed()
}

fn depth(ui: &mut Ui, name: &str, value: &mut f32) {
    name_of_field(ui, name);
    ui.add(number_field(value, 0.0..=1.0, |widget| widget.speed(0.005).max_decimals(4))).accessible_name(name);
}

fn bits(value: u8) -> String {
    format!("{:04b} {:04b}", value >> 4, value & 15)
}

//! The Stencil test tab: the test by itself. One pixel, one state, and fragments sent through it one by one.

use crate::history::operation_name;
use crate::inspector::look::number_field::number_field;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::plan::{RasterState, StencilFace};
use crate::reading::bench::{COMPARES, TestBench, TestedDraw, held_before, name};
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
/// Width of the column of names, points.
const NAMES_WIDTH: f32 = 76.0;

/// Draws the tab Stencil test: one pixel, one stencil and depth state, and fragments that are sent through it one by one.
pub fn ui(ui: &mut Ui, own: &mut TestBench, model: &Model) {
    egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        let text = "One pixel and the tests of one draw. Push fragments: each is tested as the GPU would, the stencil \
                    first, then the depth, and one operation changes what is held.";
        ui.add(Label::new(theme::note(text)).wrap());
        ui.add_space(8.0);
        take_over(ui, own, model);
        ui.add_space(8.0);
        pixel(ui, own);
        ui.add_space(8.0);
        state(ui, &mut own.state);
        ui.add_space(8.0);
        let is_new = push(ui, own);
        ui.add_space(8.0);
        pushed(ui, own, is_new);
    });
}

/// Draws a button that copies the raster state of the selected draw, or of the step's last draw where none is selected,
/// into the bench, and what the picked pixel holds before that step; and one that resets the bench. Off where the step draws
/// nothing.
fn take_over(ui: &mut Ui, own: &mut TestBench, model: &Model) {
    let plan = model.frame.plan.clone();
    let pass = plan.as_ref().and_then(|plan| plan.passes.get(model.selection.step));
    let draw =
        pass.and_then(|pass| model.selection.draw.and_then(|draw| pass.draws.get(draw)).or_else(|| pass.draws.last()));
    ui.horizontal_wrapped(|ui| {
        let hover = draw.map_or_else(
            || "The selected step draws nothing".to_owned(),
            |draw| format!("As `{}` has it, over what the picked pixel holds before this step", draw.name),
        );
        let button = ui.add_enabled(draw.is_some(), egui::Button::new("Take the selected draw's state"));
        if button.on_hover_text(&hover).on_disabled_hover_text(&hover).clicked()
            && let Some(draw) = draw
        {
            let capture = model.frame.capture.as_deref();
            let stored =
                capture.zip(model.selection.pick).and_then(|(of, at)| held_before(of, model.selection.step, at));
            own.begin(draw.raster.clone(), stored);
        }
        if ui.button("Start again").on_hover_text("The state of z-fail over an empty count").clicked() {
            *own = TestBench::default();
        }
    });
}

fn pixel(ui: &mut Ui, own: &mut TestBench) {
    theme::heading(ui, "The pixel holds");
    rows("bench pixel").show(ui, |ui| {
        name_of_row(ui, "stencil");
        number(ui, "stencil held", &mut own.stored.stencil);
        ui.label(theme::number(bits(own.stored.stencil)).color(theme::of(ui).dim));
        ui.end_row();
        name_of_row(ui, "depth");
        depth(ui, "depth held", &mut own.stored.depth);
        ui.end_row();
    });
}

fn state(ui: &mut Ui, state: &mut RasterState) {
    theme::heading(ui, "The draw's tests");
    let mut masks = state.face(true).1;
    // The first column has the names of the rows, the rest of the width is for two columns.
    let width = ((ui.available_width() - NAMES_WIDTH - 8.0) / 2.0 - 8.0).clamp(60.0, 150.0);
    rows("bench faces").show(ui, |ui| {
        for title in ["", "front faces", "back faces"] {
            ui.label(theme::note(title));
        }
        ui.end_row();
        let [front, back] = [&mut state.stencil.front, &mut state.stencil.back];
        name_of_row(ui, "stencil test")
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
            name_of_row(ui, what);
            operation(ui, &format!("front, {what}"), width, of(front));
            operation(ui, &format!("back, {what}"), width, of(back));
            ui.end_row();
        }
    });
    // One reference, one pair of masks and one depth test for both faces, as WebGPU has it.
    rows("bench both faces").show(ui, |ui| {
        name_of_row(ui, "reference");
        let mut changed = number(ui, "reference", &mut masks.reference);
        ui.end_row();
        name_of_row(ui, "masks");
        ui.horizontal(|ui| {
            ui.label(theme::note("read"));
            changed |= number(ui, "read mask", &mut masks.read);
            ui.label(theme::note("write"));
            changed |= number(ui, "write mask", &mut masks.write);
        });
        ui.end_row();
        if changed {
            state.back = None;
            state.stencil_reference = masks.reference;
            (state.stencil.read_mask, state.stencil.write_mask) = (masks.read.into(), masks.write.into());
        }
        name_of_row(ui, "depth test");
        ui.horizontal(|ui| {
            compare(ui, "depth function", width.max(96.0), &mut state.depth_compare);
            ui.checkbox(&mut state.depth_write, "writes");
        });
        ui.end_row();
        if let Some(words) = nearer(state.depth_compare) {
            name_of_row(ui, "");
            ui.label(theme::note(words));
            ui.end_row();
        }
    });
}

/// Returns which depths a test takes for nearer; `None` where it prefers neither.
fn nearer(compare: CompareFunction) -> Option<&'static str> {
    match compare {
        CompareFunction::Greater | CompareFunction::GreaterEqual => Some("as where 1 is near and 0 far away"),
        CompareFunction::Less | CompareFunction::LessEqual => Some("as where 0 is near and 1 far away"),
        _ => None,
    }
}

/// Draws the fragment that comes and the buttons that test it; returns true when one was pressed.
fn push(ui: &mut Ui, own: &mut TestBench) -> bool {
    theme::heading(ui, "A fragment comes");
    rows("bench fragment").show(ui, |ui| {
        name_of_row(ui, "depth");
        depth(ui, "its depth", &mut own.depth);
        ui.end_row();
    });
    let mut is_new = false;
    ui.horizontal_wrapped(|ui| {
        for (name, is_front) in [("Push a front face", true), ("Push a back face", false)] {
            if ui.button(name).clicked() {
                own.push(is_front);
                is_new = true;
            }
        }
    });
    is_new
}

/// Draws the list of tested fragments, the newest on top, which is brought into view where it `is_new`.
fn pushed(ui: &mut Ui, own: &TestBench, is_new: bool) {
    for (index, TestedDraw { number, words }) in own.pushed.iter().rev().enumerate() {
        let line = ui.add(Label::new(theme::note(format!("{number}. {words}"))).wrap());
        if is_new && index == 0 {
            line.scroll_to_me(None);
        }
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

/// Returns rows of names and fields, whose columns are as wide in every section.
fn rows(name: &str) -> Grid {
    Grid::new(name).num_columns(3).min_col_width(0.0).spacing([8.0, 4.0])
}

/// Draws the name of a row as wide as those of all sections.
fn name_of_row(ui: &mut Ui, name: &str) -> egui::Response {
    let name = ui.scope(|ui| {
        ui.set_min_width(NAMES_WIDTH);
        ui.label(theme::note(name))
    });
    name.inner
}

fn number(ui: &mut Ui, name: &str, value: &mut u8) -> bool {
    let hover = format!("{name}: {}", bits(*value));
    ui.add(number_field(value, 0.0..=255.0, |widget| widget)).on_hover_text(hover).accessible_name(name).changed()
}

fn depth(ui: &mut Ui, name: &str, value: &mut f32) {
    ui.add(number_field(value, 0.0..=1.0, |widget| widget.speed(0.005).max_decimals(4))).accessible_name(name);
}

fn bits(value: u8) -> String {
    format!("{:04b} {:04b}", value >> 4, value & 15)
}

//! The Bench tab: the stencil test by itself. One pixel, one state, and fragments pushed through it one by one; the same
//! [`stencil_machine`] answers that a test holds against the GPU.

use crate::history::operation_name;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::numbers;
use crate::plan::{ColorWrite, RasterState, StencilFace};
use crate::stencil_machine::{self, Fragment, Outcome, Stored};
use egui::{ComboBox, DragValue, Grid, Label, Ui};
use wgpu::{CompareFunction, StencilOperation};

/// Fragments that are kept; older ones go.
const MOST_PUSHED: usize = 200;

const COMPARES: [(CompareFunction, &str, &str); 8] = [
    (CompareFunction::Never, "never", ""),
    (CompareFunction::Less, "less", "<"),
    (CompareFunction::Equal, "equal", "="),
    (CompareFunction::LessEqual, "less-equal", "≤"),
    (CompareFunction::Greater, "greater", ">"),
    (CompareFunction::NotEqual, "not-equal", "≠"),
    (CompareFunction::GreaterEqual, "greater-equal", "≥"),
    (CompareFunction::Always, "always", ""),
];
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

/// The tab.
#[derive(Debug)]
pub struct Bench {
    state: RasterState,
    held: Stored,
    /// Of the next fragment.
    depth: f32,
    pushed: Vec<Pushed>,
    /// How many there were, the forgotten ones too.
    count: usize,
}

/// A fragment that went through the tests.
#[derive(Debug, Clone, PartialEq)]
struct Pushed {
    /// From 1.
    number: usize,
    words: String,
}

impl Default for Bench {
    /// Z-fail's counting over a surface at half depth.
    fn default() -> Bench {
        let face = |operation| StencilFace {
            compare: CompareFunction::Always,
            depth_fail_op: operation,
            ..StencilFace::IGNORE
        };
        let state = RasterState { depth_write: false, color: ColorWrite::None, ..RasterState::surface() };
        let [front, back] = [StencilOperation::DecrementWrap, StencilOperation::IncrementWrap].map(face);
        Bench {
            state: state.with_faces(front, back, 0),
            held: Stored { depth: 0.5, stencil: 0 },
            depth: 0.25,
            pushed: Vec::new(),
            count: 0,
        }
    }
}

impl Bench {
    fn push(&mut self, front_facing: bool) {
        let fragment = Fragment { depth: self.depth, front_facing };
        let before = self.held;
        let outcome = stencil_machine::test(&self.state, fragment, before);
        self.held = outcome.after;
        self.count += 1;
        let words = words(&self.state, fragment, before, &outcome);
        self.pushed.push(Pushed { number: self.count, words });
        if self.pushed.len() > MOST_PUSHED {
            self.pushed.remove(0);
        }
    }
}

/// Draws the tab.
pub fn ui(ui: &mut Ui, own: &mut Bench, model: &Model) {
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

/// The state of the selected draw, to try it out.
fn take_over(ui: &mut Ui, own: &mut Bench, model: &Model) {
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
            *own = Bench::default();
        }
    });
}

fn pixel(ui: &mut Ui, own: &mut Bench) {
    theme::heading(ui, "The pixel holds");
    ui.horizontal(|ui| {
        number(ui, "stencil held", &mut own.held.stencil);
        ui.label(theme::number(bits(own.held.stencil)).color(theme::of(ui).dim));
        depth(ui, "depth held", &mut own.held.depth);
    });
}

fn state(ui: &mut Ui, state: &mut RasterState) {
    theme::heading(ui, "The draw's tests");
    let mut masks = state.face(true).1;
    // The names of the rows, and the rest for two columns.
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
        let rows: [(&str, fn(&mut StencilFace) -> &mut StencilOperation); 3] = [
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

fn push(ui: &mut Ui, own: &mut Bench) {
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

/// The newest on top.
fn pushed(ui: &mut Ui, own: &Bench) {
    for Pushed { number, words } in own.pushed.iter().rev() {
        ui.add(Label::new(theme::note(format!("{number}. {words}"))).wrap());
    }
}

/// What became of a fragment, from what was tested and what came out.
fn words(state: &RasterState, fragment: Fragment, before: Stored, outcome: &Outcome) -> String {
    let (face, masks) = state.face(fragment.front_facing);
    let side = if fragment.front_facing { "front" } else { "back" };
    let verb = |passes: bool| if passes { "passes" } else { "fails" };
    let stencil = match sign(face.compare) {
        Some(sign) => format!("{} {sign} {}", masks.reference & masks.read, before.stencil & masks.read),
        None => name(face.compare).to_owned(),
    };
    let mut text = format!(
        "{side} face at {}: the stencil test ({stencil}) {}",
        numbers::depth(fragment.depth),
        verb(outcome.stencil_passed)
    );
    if let Some(passed) = outcome.depth_passed {
        let depth = match sign(state.depth_compare) {
            Some(sign) => format!("{} {sign} {}", numbers::depth(fragment.depth), numbers::depth(before.depth)),
            None => name(state.depth_compare).to_owned(),
        };
        text += &format!(", the depth test ({depth}) {}", verb(passed));
    }
    text +=
        &format!("; {}: stencil {} to {}", operation_name(outcome.operation), before.stencil, outcome.after.stencil);
    if outcome.after.depth != before.depth {
        text += &format!(", depth {} to {}", numbers::depth(before.depth), numbers::depth(outcome.after.depth));
    }
    text
}

fn sign(compare: CompareFunction) -> Option<&'static str> {
    COMPARES.iter().find(|(one, ..)| *one == compare).map(|(_, _, sign)| *sign).filter(|sign| !sign.is_empty())
}

fn name(compare: CompareFunction) -> &'static str {
    COMPARES.iter().find(|(one, ..)| *one == compare).map_or("", |(_, name, _)| name)
}

fn compare(ui: &mut Ui, label: &str, width: f32, value: &mut CompareFunction) {
    let combo = ComboBox::from_id_salt(label).selected_text(name(*value)).width(width).truncate();
    let shown = combo.show_ui(ui, |ui| {
        for (one, name, _) in COMPARES {
            ui.selectable_value(value, one, name);
        }
    });
    shown.response.on_hover_text(label).accessible_name(label);
}

fn operation(ui: &mut Ui, label: &str, width: f32, value: &mut StencilOperation) {
    let combo = ComboBox::from_id_salt(label).selected_text(operation_name(*value)).width(width).truncate();
    let shown = combo.show_ui(ui, |ui| {
        for one in OPERATIONS {
            ui.selectable_value(value, one, operation_name(one));
        }
    });
    shown.response.on_hover_text(label).accessible_name(label);
}

fn number(ui: &mut Ui, name: &str, value: &mut u8) -> bool {
    ui.label(theme::note(name));
    ui.add(DragValue::new(value).range(0..=255)).on_hover_text(bits(*value)).accessible_name(name).changed()
}

fn depth(ui: &mut Ui, name: &str, value: &mut f32) {
    ui.label(theme::note(name));
    ui.add(DragValue::new(value).range(0.0..=1.0).speed(0.005).max_decimals(4)).accessible_name(name);
}

fn bits(value: u8) -> String {
    format!("{:04b} {:04b}", value >> 4, value & 15)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A front face at 0.75 lies before the surface at 0.5, reversed; at 0.25 behind it.
    #[test]
    fn what_is_said_is_what_the_machine_did() {
        let mut bench = Bench::default();
        bench.push(false);
        assert_eq!(bench.held, Stored { depth: 0.5, stencil: 1 });
        let said = &bench.pushed[0].words;
        assert_eq!(
            said,
            "back face at 0.25: the stencil test (always) passes, the depth test (0.25 > 0.5) fails; increment-wrap: \
             stencil 0 to 1"
        );
        bench.depth = 0.75;
        bench.push(true);
        assert!(bench.pushed[1].words.ends_with("the depth test (0.75 > 0.5) passes; keep: stencil 1 to 1"));
        bench.state.stencil.front.compare = CompareFunction::Less;
        bench.state.stencil_reference = 7;
        bench.push(true);
        assert!(bench.pushed[2].words.contains("the stencil test (7 < 1) fails; keep"), "{}", bench.pushed[2].words);
    }

    #[test]
    fn old_fragments_are_forgotten_and_numbers_go_on() {
        let mut bench = Bench::default();
        (0..300).for_each(|_| bench.push(false));
        assert_eq!((bench.pushed.len(), bench.pushed[0].number, bench.held.stencil), (MOST_PUSHED, 101, 44));
    }
}

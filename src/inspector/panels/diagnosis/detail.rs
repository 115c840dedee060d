//! The selected region of the Diagnosis tab: its causes with evidence, fixes and proofs; below them facts about meshes
//! and flags.

use crate::ask::DiagnosisOf;
use crate::diagnosis::{Advice, Diagnosis, Fix, FixWithinTechnique, FrameEffect, Proof, RegionFound};
use crate::inspector::action::Action;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::inspector::model::comparing::ComparedWith;
use crate::inspector::model::scene::AppliedFix;
use crate::reading::format;
use egui::{Button, Color32, Label, RichText, Ui};

/// Draws the advice of a diagnosis with its fixes, and where one was applied what was before it.
pub fn advice(ui: &mut Ui, model: &mut Model, diagnosis: &Diagnosis, actions: &mut Vec<Action>) {
    before_and_after(ui, model, actions);
    let Some(advice) = &diagnosis.advice else { return };
    if let Some(staying) = &advice.staying {
        let all = if is_of_a_cause(diagnosis, &staying.fix) { "" } else { ", apply all" };
        let words = format!("Stay with {}{all}", diagnosis.technique.name());
        apply_button(ui, model, (&staying.fix, staying.whole_frame), &words, actions);
    }
    // What one cause asks for is not called all.
    let words = if is_of_a_cause(diagnosis, &advice.fix) { "Apply the fix" } else { "Apply all" };
    apply_button(ui, model, (&advice.fix, Some(of_advice(diagnosis, advice))), words, actions);
    ui.add_space(8.0);
}

/// Draws the causes of a region with their evidence, fixes and proofs, or why it has none.
pub fn causes(ui: &mut Ui, model: &mut Model, diagnosis: &Diagnosis, region: &RegionFound, actions: &mut Vec<Action>) {
    if region.causes.is_empty() {
        let without = diagnosis.without_cause(region);
        wrapped(ui, theme::note(format!("Here {without}. Its history, on the right, tells how a pixel came about.")));
    }
    for index in 0..region.causes.len() {
        cause(ui, model, diagnosis, (region, index), actions);
    }
}

/// Returns what the advised fix does to the whole frame.
fn of_advice(diagnosis: &Diagnosis, advice: &Advice) -> FrameEffect {
    let listed: u64 = diagnosis.regions.iter().map(|region| region.pixels).sum();
    FrameEffect { before: listed + diagnosis.rest.pixels, after: advice.wrong_left + advice.swimming_left }
}

/// Draws buttons for the picture with the applied fix and without it, as far as it is another than the shown one, and says
/// which of the two that is, if any: the user may have chosen something else since. Nothing where no fix was applied.
fn before_and_after(ui: &mut Ui, model: &mut Model, actions: &mut Vec<Action>) {
    let Some(scene) = &model.scene else { return };
    let Some(AppliedFix { before, after }) = scene.applied.clone() else { return };
    let shown = scene.draft.choice.clone();
    let compares = model.modes.compare.is_some_and(|compare| compare.with == ComparedWith::BeforeFix);
    let words = match (shown == after, shown == before) {
        (true, _) if compares => "shown: after, compared with before".to_owned(),
        (true, _) => "shown: after, with the fix".to_owned(),
        (_, true) => "shown: before, without the fix".to_owned(),
        _ if shown.technique() != after.technique() => format!("shown: {}, chosen since", shown.technique().name()),
        _ => "shown: other settings, chosen since".to_owned(),
    };
    ui.horizontal_wrapped(|ui| {
        for (words, choice) in [("Show before", before), ("Show after", after)] {
            let hover = "Renders without the fix, and with it again";
            if shown != choice && ui.button(words).on_hover_text(hover).clicked() {
                model.switch_to(choice, actions);
                // It would be compared with itself.
                model.modes.compare = model.modes.compare.filter(|_| !compares);
            }
        }
        ui.label(theme::note(words));
    });
    ui.add_space(4.0);
}

fn cause(
    ui: &mut Ui,
    model: &mut Model,
    diagnosis: &Diagnosis,
    (region, index): (&RegionFound, usize),
    actions: &mut Vec<Action>,
) {
    let found = &region.causes[index];
    ui.add_space(4.0);
    let color = proof_color(ui, found.proof);
    ui.horizontal_wrapped(|ui| {
        ui.label(theme::number(found.cause.name()).color(theme::of(ui).text));
        ui.label(theme::note(found.proof.name()).color(color));
        if let Some(left) = found.pixels_left.filter(|left| *left > 0) {
            ui.label(theme::note(region.left_words(left)));
        }
    });
    wrapped(ui, theme::note(&found.evidence.sentence).color(theme::of(ui).text));
    if index == 0 {
        wrapped(ui, theme::note(found.cause.meaning()));
    }
    // A fix that has its button above has no second one.
    let offered: Vec<&Fix> = diagnosis.advice.iter().flat_map(Advice::fixes).collect();
    let mut is_said = false;
    let mut offer = |ui: &mut Ui, fix: &Fix, whole_frame: Option<FrameEffect>, words: &str| {
        if offered.contains(&fix) {
            if !std::mem::replace(&mut is_said, true) {
                wrapped(ui, theme::note("Its fix is offered above."));
            }
        } else {
            apply_button(ui, model, (fix, whole_frame), words, actions);
        }
    };
    // A user of this technique is first offered a fix that does not change it.
    if let Some(FixWithinTechnique { fix, pixels_left, whole_frame }) = &found.staying {
        let left = format::counted(*pixels_left, "pixel");
        offer(ui, fix, *whole_frame, &format!("Stay with {}, {left} left here", diagnosis.technique.name()));
    }
    if let Some(fix) = &found.fix {
        offer(ui, fix, found.whole_frame, "Apply the fix");
    }
}

/// Returns whether a fix is one that a cause of a listed region asks for, and not several joined.
fn is_of_a_cause(diagnosis: &Diagnosis, fix: &Fix) -> bool {
    let mut causes = diagnosis.regions.iter().flat_map(|region| &region.causes);
    causes.any(|found| found.fix.as_ref() == Some(fix) || found.staying.as_ref().is_some_and(|one| one.fix == *fix))
}

/// Draws how many pixels of the whole frame are wrong without a fix and with it, as the run that proves it has shown; as
/// a warning where it makes the frame worse.
fn effect(ui: &mut Ui, whole_frame: Option<FrameEffect>) {
    let Some(effect) = whole_frame else { return };
    let (words, color) = match effect.is_worse() {
        true => (format!("× Worse elsewhere: {}", effect.words()), theme::of(ui).error),
        false => (format::capitalized(&effect.words()), theme::of(ui).dim),
    };
    wrapped(ui, theme::note(words).color(color));
}

/// Draws a button that applies a fix to technique and settings and renders, over what the fix does to the whole frame; off
/// where it changes nothing. Where another technique was chosen since, it is applied to what was diagnosed. One that makes
/// the frame worse says so. A fix that changes the scene is only described: that is left to the user.
fn apply_button(
    ui: &mut Ui,
    model: &mut Model,
    (fix, whole_frame): (&Fix, Option<FrameEffect>),
    words: &str,
    actions: &mut Vec<Action>,
) {
    let diagnosed = model.answers.last::<DiagnosisOf>().map(|(asked, _)| asked.request.choice.clone());
    let choice = model.scene.as_ref().filter(|_| fix.is_a_choice()).and_then(|scene| {
        let now = &scene.draft.choice;
        let before = diagnosed.filter(|of| of.technique() != now.technique()).unwrap_or_else(|| now.clone());
        let mut after = before.clone();
        fix.choose(&mut after).ok()?;
        // What the fix itself has chosen is no other technique that was chosen since.
        Some(if after == *now { (now.clone(), after) } else { (before, after) })
    });
    let Some((before, after)) = choice else {
        wrapped(ui, theme::note(format!("To fix it in the scene: {fix}")));
        return effect(ui, whole_frame);
    };
    let is_worse = whole_frame.is_some_and(FrameEffect::is_worse);
    let all_the_same = if is_worse { " all the same" } else { "" };
    let is_done = before == after;
    let is_stale = model.is_diagnosis_stale();
    let button = ui.add_enabled(!is_done && !is_stale, Button::new(format!("{words}{all_the_same}: {fix}")).wrap());
    let hover = match (is_stale, is_done) {
        (true, _) => "It was proven for the scene before it was changed: diagnose again",
        (false, true) => "It is applied",
        (false, false) => "Renders the scene so",
    };
    if button.on_hover_text(hover).on_disabled_hover_text(hover).clicked() {
        model.apply(AppliedFix { before, after }, actions);
    }
    effect(ui, whole_frame);
}

/// Draws what was found of meshes and flags.
pub fn meshes_and_flags(ui: &mut Ui, diagnosis: &Diagnosis) {
    if !diagnosis.mesh_findings.is_empty() {
        ui.add_space(8.0);
        theme::heading(ui, "Meshes, whether it shows here or not");
        for found in &diagnosis.mesh_findings {
            let words = format!("{}: {}: {}", found.object, found.kind.counted(found.count), found.effect);
            wrapped(ui, theme::note(words));
        }
    }
    if !diagnosis.flags.is_empty() {
        ui.add_space(8.0);
        theme::heading(ui, "By the scene's own wish, so not wrong");
        for found in &diagnosis.flags {
            let pixels = format::counted(found.pixels, "pixel");
            wrapped(ui, theme::note(format!("{}: {}: {pixels} would change", found.object, found.cause)));
        }
    }
}

fn proof_color(ui: &Ui, proof: Proof) -> Color32 {
    match proof {
        Proof::Proven => theme::of(ui).passed,
        Proof::Part => theme::of(ui).lit,
        Proof::NotIt => theme::of(ui).failed,
        Proof::NotRun => theme::of(ui).decided,
    }
}

fn wrapped(ui: &mut Ui, text: RichText) {
    ui.add(Label::new(text).wrap());
}

//! What ray tracing says of the picked pixel, and, where it is wrong, the cause that the diagnosis has found.

use crate::accuracy::Finding;
use crate::capture::Capture;
use crate::diagnosis::{CauseFound, Diagnosis, RegionFound, RegionKind};
use crate::inspector::action::PanelKind;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use egui::{Label, RichText, Ui};

/// Returns a sentence on what ray tracing says of a pixel that is labelled so; `None` where it is not compared.
pub fn sentence(finding: Finding) -> Option<&'static str> {
    match finding {
        Finding::Agrees => Some("Right: ray tracing says the same."),
        Finding::FalseShadow => Some("× Wrong: by ray tracing it is lit."),
        Finding::MissingShadow => Some("× Wrong: by ray tracing it is in shadow."),
        Finding::WrongSurface => Some("× Wrong: by ray tracing another surface is seen here."),
        Finding::EdgeBand => Some("By ray tracing it is otherwise, but at an edge: excused."),
        Finding::NotCompared => None,
    }
}

/// Draws the sentence on a light at a pixel of a frame, where its truth is known and it is compared; returns how it differs
/// from the truth.
pub fn of_frame(ui: &mut Ui, capture: &Capture, light: usize, at: [u32; 2]) -> Option<Finding> {
    let finding = capture.finding_at(light, at)?;
    let color = if finding.is_wrong() { theme::of(ui).error } else { theme::of(ui).dim };
    ui.add(Label::new(theme::note(sentence(finding)?).color(color)).wrap());
    Some(finding)
}

/// Draws whether rays agree with what the technique says of a light at a pixel; where they do not, also why, as far as the
/// frame was diagnosed, with a link to the diagnosis. Draws nothing where the truth is not known.
pub fn ui(ui: &mut Ui, model: &mut Model, capture: &Capture, light: usize, at: [u32; 2]) {
    let Some(finding) = of_frame(ui, capture, light, at) else { return };
    let Some(diagnosis) = model.diagnosis_of_frame().filter(|_| finding.is_wrong()) else { return };
    ui.horizontal_wrapped(|ui| {
        ui.label(theme::note(why(&diagnosis, light, finding, at)).color(theme::of(ui).text));
        let link = ui.link(RichText::new("Open the diagnosis").size(theme::SMALL_SIZE));
        if link.on_hover_text("Shows the tab Diagnosis, with the evidence and what fixes it").clicked() {
            model.requests.panels.push(PanelKind::Diagnosis);
        }
    });
}

/// Returns, of a pixel in none of the listed regions, why those are wrong that are so in the same way.
fn too_small(diagnosis: &Diagnosis, light: usize, finding: Finding) -> String {
    let alike = |region: &&RegionFound| region.light == light && region.kind == RegionKind::Wrong(finding);
    let causes = diagnosis.regions.iter().filter(alike).filter_map(|region| region.causes.first());
    let mut names: Vec<&str> = Vec::new();
    for found in causes {
        let name = found.cause.name();
        if !names.contains(&name) {
            names.push(name);
        }
    }
    match names.is_empty() {
        true => "Why: not known, its region is too small to be listed.".to_owned(),
        false => format!("Its region is too small to be listed; those like it are wrong by {}.", names.join(" or ")),
    }
}

/// Returns why a pixel is wrong, as the diagnosis says of the regions that it may be in: it has their bounds, not their
/// pixels.
fn why(diagnosis: &Diagnosis, light: usize, finding: Finding, [x, y]: [u32; 2]) -> String {
    let may_be_in = |region: &&RegionFound| {
        let [left, top, right, bottom] = region.bounds;
        let is_in_bounds = (left..=right).contains(&x) && (top..=bottom).contains(&y);
        region.light == light && region.kind == RegionKind::Wrong(finding) && is_in_bounds
    };
    let regions = diagnosis.regions.iter().filter(may_be_in);
    let mut causes: Vec<String> = regions
        .map(|region| {
            let named = |found: &CauseFound| format!("{} ({})", found.cause, found.proof.name());
            region.causes.first().map_or_else(|| diagnosis.without_cause(region).to_owned(), named)
        })
        .collect();
    causes.dedup();
    match &causes[..] {
        [] => too_small(diagnosis, light, finding),
        [one] => format!("Why: {one}."),
        several => format!("Why: one of {}.", several.join(", ")),
    }
}

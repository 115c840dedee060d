//! Which texel of a light's shadow map decided the picked pixel, and what it stores against the pixel's own depth.

use crate::ask::ReadersOf;
use crate::capture::Capture;
use crate::inspector::action::PanelKind;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::plan::DecidedBy;
use crate::reading::format;
use crate::reading::map_decision::MapDecision;
use crate::technique::MapSettings;
use egui::Ui;

/// Returns how the map decided the picked pixel, for the light in question, or, where the Shadow map tab is open, for
/// the light that it shows. `None` where no map decided it, or that is not known yet: it is computed once no other
/// frame is waited for.
pub fn decision(model: &Model, capture: &Capture, light: usize, at: [u32; 2]) -> Option<MapDecision> {
    let light = model.selection.map_light.unwrap_or(light);
    if capture.decided_by(light) != DecidedBy::Map {
        return None;
    }
    let question = ReadersOf { light };
    let reply = if model.activity.is_waiting { model.answers.of(question) } else { model.answers.want(question) };
    MapDecision::of(capture, &*reply.ready?, light, at)
}

/// Draws how a light's shadow map decides the picked pixel: the texel that it reads, the depth stored there and the
/// surface's own, the result, and a button that goes to the texel.
pub fn ui(ui: &mut Ui, model: &mut Model, capture: &Capture, decision: &MapDecision) {
    let MapSettings { bias_constant, bias_slope, bias_normal, .. } = MapSettings::read(&capture.settings);
    ui.label(theme::note(format!("Shadow map of {}", format::light(decision.light))));
    egui::Grid::new("deciding texel").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
        let mut row = |name: &str, value: String, hover: &str| {
            ui.label(theme::note(name)).on_hover_text(hover);
            ui.label(theme::number(value).color(theme::of(ui).text)).on_hover_text(hover);
            ui.end_row();
        };
        let filter = match decision.compared.len() {
            1 => String::new(),
            all => format!(", and {} around it", all - 1),
        };
        row("texel", format!("{}{filter}", decision.place_words()), "Where this pixel's surface lies in the map");
        let bias = format!(
            "The map's depth there, pushed away from the light by its bias: {bias_constant} steps and {bias_slope} \
             texels of slope"
        );
        let bias = if decision.is_recorded { "The map's depth there".to_owned() } else { bias };
        row("stored", decision.stored_words(), &bias);
        let moved = match bias_normal {
            _ if decision.is_recorded => {
                "This surface's depth, seen from the light, at the texel's middle: what the program's shader adds is not \
                 known"
                    .to_owned()
            }
            0.0 => "This surface's depth, seen from the light".to_owned(),
            by => format!("This surface's depth, seen from the light, moved along its normal by up to {by} texels"),
        };
        row("pixel", decision.depth_words(decision.middle.depth), &moved);
    });
    ui.horizontal_wrapped(|ui| {
        ui.label(theme::note("so"));
        ui.label(egui::RichText::new(decision.outcome()).color(theme::of(ui).text));
    });
    if ui.button(theme::note("Show the texel in Shadow map")).clicked() {
        model.requests.texel_under = Some(decision.light);
        model.requests.panels.push(PanelKind::ShadowMap);
    }
}

//! How each light shades the picked pixel's surface: the cosine, and the formula's terms.

use super::picked::PickedHistory;
use crate::capture::Capture;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::reading::format;
use crate::reading::shading::{SurfaceShading, TextureTerm, digits, three};
use crate::reading::shading_channels::ShadingChannels;
use egui::{CollapsingHeader, Grid, Label, Ui};

/// Draws the section Shading, closed at first: how the picked pixel's colour is computed. Draws nothing for another
/// program's frame, or without a trusted history of the pick.
pub fn ui(ui: &mut Ui, model: &Model, capture: &Capture, picked: &PickedHistory) {
    let (Some(history), Some(plan)) = (&picked.history, &model.frame.plan) else { return };
    if capture.origin.is_some() || !picked.is_of_pick || !picked.wrong.is_empty() {
        return;
    }
    let header = CollapsingHeader::new("Shading").id_salt("shading");
    header.show(ui, |ui| match SurfaceShading::of(capture, plan, history) {
        Some(shaded) => terms(ui, &shaded),
        None => drop(ui.label(theme::note("No surface is here."))),
    });
}

fn terms(ui: &mut Ui, shaded: &SurfaceShading) {
    let words = "light = its colour × fading × (colour × diffuse + highlight)";
    ui.add(Label::new(theme::note(words)).wrap());
    let grid = |name: &str| Grid::new(format!("shading of {name}")).num_columns(2).spacing([12.0, 2.0]);
    let row = |ui: &mut Ui, name: &str, value: String, hover: &str| {
        ui.label(theme::note(name)).on_hover_text(hover);
        ui.label(theme::number(value).color(theme::of(ui).text)).on_hover_text(hover);
        ui.end_row();
    };
    grid("the surface").show(ui, |ui| {
        let kind = format!("{}, {}", shaded.shading, shaded.diffuse);
        row(ui, "shaded", kind, "Where light is computed, and how it falls off with its angle");
        row(ui, "normal", three(shaded.normal), "Of unit length, world space, to the side that the eye sees");
        row(
            ui,
            "surface colour",
            three(shaded.color),
            "Linear red, green and blue that it reflects, with checks and texture",
        );
        if let Some(TextureTerm { name, uv: [u, v], texel: [column, line], level, color }) = &shaded.texture {
            row(
                ui,
                "texture",
                format!("{name}, texel {column},{line}"),
                "The picture on it, and the texel there from its top left",
            );
            row(
                ui,
                "u, v",
                format!("{}, {}", digits(*u), digits(*v)),
                "From the picture's lower left to its upper right",
            );
            let hover = "Of the picture's pyramid: on level k a texel is 2^k texels large, and two levels are mixed";
            row(ui, "level", digits(*level), hover);
            row(ui, "texel's colour", three(*color), "Linear; the surface's colour is multiplied with it");
        }
        row(ui, "without light", three(shaded.unlit), "Under ambient light, and what it sends out by itself; linear");
    });
    let text = theme::number(format!("Together {}", shaded.total_words())).color(theme::of(ui).text);
    let hover = "What the picture has here: without light, and of each light what arrives; linear, cut off at 1";
    ui.add(Label::new(text).wrap()).on_hover_text(hover);
    if let Some(ShadingChannels { ambient, emissive, diffuse, specular }) = shaded.channels {
        ui.label(theme::note("The same by what it is"));
        grid("channels").show(ui, |ui| {
            row(
                ui,
                "ambient",
                three(ambient),
                "The surface's share of the light that is everywhere; linear, as all here",
            );
            row(ui, "emissive", three(emissive), "What it sends out by itself");
            row(
                ui,
                "diffuse",
                three(diffuse),
                "What it scatters of the lights, as far as they arrive: the same to every eye",
            );
            row(ui, "specular", three(specular), "Its highlights, as far as the lights arrive: another from every eye");
        });
    }
    for (index, light) in shaded.lights.iter().enumerate() {
        let is_dark = light.is_in_shadow();
        let kept = match (is_dark, shaded.ambient_diffuse) {
            (false, _) => String::new(),
            (true, 0.0) => ": kept away by the shadow".to_owned(),
            (true, share) => format!(": kept away by the shadow, but for {} of its diffuse light", digits(share)),
        };
        ui.add(Label::new(theme::note(format!("From {}{kept}", format::light(index)))).wrap());
        grid(&format::light(index)).show(ui, |ui| {
            row(ui, "cosine N·L", digits(light.cosine), "Of the angle between the normal and the way to the light");
            if let Some(cosines) = light.corner_cosines {
                row(ui, "at the corners", three(cosines), "Gouraud computes light there, and mixes it");
            }
            let diffuse = match shaded.diffuse {
                "wrapped" => "(N·L + 1) / 2",
                _ if light.is_turned_away => "Its triangle faces away from the light: nothing",
                _ => "max(0, N·L)",
            };
            row(ui, "diffuse", digits(light.diffuse), diffuse);
            let gloss = format!(
                "{} × max(0, N·H)^{}, with H halfway between light and eye",
                digits(shaded.specular),
                digits(shaded.shininess)
            );
            row(ui, "highlight", digits(light.highlight), &gloss);
            row(ui, "fading", digits(light.fading), "What is left at its distance");
            row(ui, "its colour", three(light.color), "Linear red, green and blue, times its intensity");
            let adds = if is_dark { "would add" } else { "adds" };
            row(ui, adds, three(light.adds), "Where it arrives; linear");
        });
    }
}

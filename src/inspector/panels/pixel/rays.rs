//! What keeps each light from the picked pixel's surface, by rays in the frame's own scene: true under every technique.

use crate::ask::{RaysOf, Reply};
use crate::capture::Capture;
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::reading::format;
use crate::reading::light_rays::{LightRay, Occluder};
use egui::{Button, Grid, Label, Ui};

/// How many triangles between a light and the surface are listed, the nearest to the surface first.
const MOST_LISTED: usize = 8;

/// Rays are prepared for each frame anew, which takes longer the more triangles there are: beyond these they are followed
/// only where somebody opens them.
const MOST_FOLLOWED_UNASKED: usize = 300_000;

/// The longest name that is written whole in the table, characters.
const LONGEST_NAME: usize = 16;

/// Asks for the rays to a pixel of the shown frame; an empty reply where another program drew it, or a run is awaited, whose
/// frame will have rays of its own.
fn wanted(model: &Model, capture: &Capture, at: [u32; 2]) -> Reply<Vec<LightRay>> {
    let has_rays = model.scene.is_some() && capture.origin.is_none() && !model.activity.is_waiting;
    if has_rays { model.answers.want(RaysOf { at }) } else { Reply::default() }
}

/// Returns the names of the objects that keep a light from a pixel's surface, the nearest to the surface first, and a
/// sentence with the triangle that does. `None` where nothing does, that is not known yet, or the scene is too large to
/// follow rays in unasked.
pub fn casters(model: &Model, capture: &Capture, light: usize, at: [u32; 2]) -> Option<(Vec<String>, String)> {
    let objects = model.scene.iter().flat_map(|scene| &scene.loaded);
    if objects.map(|object| object.mesh.triangles().len()).sum::<usize>() > MOST_FOLLOWED_UNASKED {
        return None;
    }
    let rays = wanted(model, capture, at).ready;
    let ray = rays.as_ref()?.iter().find(|ray| ray.light == light)?;
    let names = ray.casters();
    (!names.is_empty()).then(|| (names, format!("By its ray: {}.", ray.words())))
}

/// Draws the heading of the lights, with a button beside it that unfolds their rays: a line of its own would take the
/// ladder's height. Without the button where no scene is open, or another program drew the frame.
pub fn heading(ui: &mut Ui, is_open: &mut bool, model: &Model, capture: &Capture) {
    ui.horizontal(|ui| {
        theme::heading(ui, "Lights");
        if model.scene.is_some() && capture.origin.is_none() {
            let words = if *is_open { "Hide rays" } else { "Rays" };
            let button = ui.add(Button::new(theme::note(words)).small());
            let hover = "What is between the surface and each light, in truth: whatever the technique drew";
            *is_open ^= button.on_hover_text(hover).clicked();
        }
    });
}

/// Draws for each light what its ray to the surface meets, triangle by triangle.
pub fn ui(ui: &mut Ui, model: &Model, capture: &Capture, at: [u32; 2]) {
    let reply = wanted(model, capture, at);
    match (&reply.ready, &reply.failed) {
        (Some(rays), _) if rays.is_empty() => drop(ui.label(theme::note("No surface is here."))),
        (Some(rays), _) => rays.iter().for_each(|ray| one(ui, ray)),
        (None, Some(reason)) => drop(ui.add(Label::new(theme::note(reason)).wrap())),
        (None, None) => drop(ui.label(theme::note("Following the rays …"))),
    }
}

fn one(ui: &mut Ui, ray: &LightRay) {
    let light = format::light(ray.light);
    ui.add(Label::new(theme::note(format!("{light}: {}", ray.words()))).wrap());
    if ray.occluders.is_empty() {
        return;
    }
    Grid::new(("triangles before a light", ray.light)).num_columns(4).spacing([10.0, 2.0]).show(ui, |ui| {
        for name in ["object", "triangle", "from here", "from light"] {
            ui.label(theme::note(name));
        }
        ui.end_row();
        for Occluder { object, triangle, from_surface, from_light } in ray.occluders.iter().take(MOST_LISTED) {
            ui.add(Label::new(theme::note(shortened(object))).extend()).on_hover_text(object);
            let away = from_light.map_or_else(|| "infinity".to_owned(), format::metres);
            let cells = [format::count(*triangle as u64 + 1), format::metres(*from_surface), away];
            for cell in cells {
                ui.label(theme::number(cell).color(theme::of(ui).text));
            }
            ui.end_row();
        }
    });
    let more = ray.occluders.len().saturating_sub(MOST_LISTED);
    if more > 0 {
        ui.label(theme::note(format!("and {} behind them", format::counted(more as u64, "more triangle"))));
    }
}

/// Returns a name that leaves the numbers beside it their space: one that is too long without its end.
fn shortened(name: &str) -> String {
    if name.chars().count() <= LONGEST_NAME {
        return name.to_owned();
    }
    name.chars().take(LONGEST_NAME - 1).chain(['…']).collect()
}

//! The toolbar and the legend of the Scene tab.

use super::stage::SceneStage;
use super::toggles::SceneToggles;
use super::view::{Pane, PaneLayout, SceneView};
use crate::anatomy::Anatomy;
use crate::inspector::action::TourSubject;
use crate::inspector::look::theme;
use crate::inspector::look::widgets::segments;
use crate::inspector::model::Model;
use crate::inspector::panels::tour_mark;
use crate::plan::DrawPart;
use crate::reading::format;
use egui::{Color32, Margin, Rect, Sense, Stroke, Ui, UiBuilder, vec2};

/// Draws the Scene tab's toolbar: layout of the views, reset, the camera's own view, and which handles there are; no
/// switches for handles where the view is only assumed, as in other programs' frames.
pub fn toolbar(ui: &mut Ui, view: &mut SceneView, anatomy: &Anatomy) {
    egui::Frame::new().fill(theme::of(ui).panel).inner_margin(Margin::symmetric(8, 6)).show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            layouts(ui, view);
            if ui.button("Reset").on_hover_text("Show the whole scene in every view").clicked() {
                view.reset(anatomy);
            }
            let see = ui.button("See from the camera");
            if see.on_hover_text("The free view becomes the picture's own").clicked() {
                view.see_from(&anatomy.camera);
            }
            if !anatomy.is_view_assumed {
                let gizmos = ui.checkbox(&mut view.gizmos, "Gizmos");
                gizmos.on_hover_text(
                    "Handles that move lights and camera, and of shadow maps the planes and corners of their frusta: drag \
                     them, or use the arrow keys",
                );
                let objects = ui.add_enabled(view.gizmos, egui::Checkbox::new(&mut view.moves_objects, "Move objects"));
                let objects = objects.on_disabled_hover_text("Switch Gizmos on first: these handles are gizmos");
                objects.on_hover_text(
                    "Objects have handles too: drag one by its square or by its name, or use the arrow keys",
                );
            }
        });
    });
}

fn layouts(ui: &mut Ui, view: &mut SceneView) {
    const LAYOUTS: [(PaneLayout, &str, &str); 5] = [
        (PaneLayout::One(Pane::Free), "Free", "One view that is turned by hand"),
        (PaneLayout::One(Pane::Top), "Top", "From above"),
        (PaneLayout::One(Pane::Front), "Front", "From the front, along −z"),
        (PaneLayout::One(Pane::Right), "Right", "From the right, along −x"),
        (PaneLayout::Four, "Four views", "Top, free, front and right"),
    ];
    let labels = LAYOUTS.map(|(_, label, meaning)| (label, meaning));
    let chosen = LAYOUTS.iter().position(|(layout, ..)| *layout == view.layout);
    if let Some(index) = segments(ui, &labels, chosen) {
        view.layout = LAYOUTS[index].0;
    }
}

/// Draws the legend into `rect`: the kinds of geometry with their colours, each a switch, the choice of light and
/// caster, and notes; also that the geometry is of the frame before, where it is not `is_of_frame`.
pub fn legend(
    ui: &mut Ui,
    view: &mut SceneView,
    model: &mut Model,
    anatomy: &Anatomy,
    is_of_frame: bool,
    stage: &SceneStage,
    rect: Rect,
) {
    ui.painter().rect_filled(rect, egui::CornerRadius::ZERO, theme::of(ui).panel);
    let builder = UiBuilder::new().max_rect(rect.shrink2(vec2(8.0, 6.0))).id_salt("scene legend");
    ui.scope_builder(builder, |ui| {
        let scroll = egui::ScrollArea::vertical().id_salt("scene legend").auto_shrink([false, false]);
        scroll.show(ui, |ui| {
            switches(ui, view, model, anatomy);
            ui.add_space(8.0);
            choosers(ui, view, anatomy);
            ui.add_space(8.0);
            if !is_of_frame {
                ui.label(theme::note("Of the frame before."));
            }
            notes(ui, anatomy, stage);
        });
    });
}

fn switches(ui: &mut Ui, view: &mut SceneView, model: &mut Model, anatomy: &Anatomy) {
    let colors = theme::of(ui);
    let edges: u64 = anatomy.silhouettes.iter().map(|one| one.edges.len() as u64).sum();
    let shown = &mut view.shown;
    let objects = anatomy.objects.iter().map(|object| object.mesh.triangles().len() as u64).sum();
    theme::heading(ui, "Shown");
    let hint = format!("{} triangles", format::count(objects));
    switch(ui, &mut shown.objects, EntryMark::Square(colors.dim), "Objects", &hint);
    let hint = "Every edge of every triangle. Those behind a surface are hidden by it, until Objects are switched off";
    switch(ui, &mut shown.wireframe, EntryMark::Line(colors.text, 1.0), "Wireframe", hint);
    let hint = "The unit normals that surfaces are shaded by: of each triangle where shading is flat, of each vertex, \
                averaged over its triangles, where it is smooth; of fine meshes some";
    switch(ui, &mut shown.normals, EntryMark::Line(colors.selected, 1.0), "Normals", hint);
    tour_mark::about(ui, model, TourSubject::Volumes, |ui, _| parts(ui, shown, anatomy));
    let hint = format!("{} edges; thicker and numbered where the multiplicity is not ±1", format::count(edges));
    switch(ui, &mut shown.silhouettes, EntryMark::Line(colors.text, 2.0), "Silhouettes", &hint);
    let hint = "What the camera sees, with the near rectangle, and what each light's map sees; of a receiver's texture \
                from its rectangle to the light, of a silhouette as the light projects it";
    switch(ui, &mut shown.frusta, EntryMark::Line(colors.lit, 1.0), "Frusta", hint);
    let hint = "The space between the near rectangle and the light: what casts within it holds the eye in its shadow, or \
                is cut by the near plane";
    switch(ui, &mut shown.near_clip, EntryMark::Square(colors.decided), "Near-clip volume", hint);
    let hint = "From the eye to the picked pixel's surface, and on to the light: full where it is lit, dashed where \
                it is not";
    switch(ui, &mut shown.rays, EntryMark::Line(colors.text, 1.0), "Rays of the pick", hint);
    switch(ui, &mut shown.names, EntryMark::None, "Names", "What each object is called");
}

/// Draws the switches for the parts of the volumes; one for all where they are not distinguished, as in other programs'
/// frames.
fn parts(ui: &mut Ui, shown: &mut SceneToggles, anatomy: &Anatomy) {
    let colors = theme::of(ui);
    let triangles = |part: DrawPart| -> String {
        let parts = anatomy.volumes.iter().flat_map(|volume| &volume.parts);
        let count = parts.filter(|one| one.part == part).map(|one| one.triangles.len() as u64).sum();
        format!("{} triangles", format::count(count))
    };
    let sides = triangles(DrawPart::Side);
    if anatomy.is_view_assumed {
        let hint = format!("{sides}; sides and caps are not distinguished");
        return switch(ui, &mut shown.sides, EntryMark::Square(colors.side), "Volumes", &hint);
    }
    let [light_caps, dark_caps] = [DrawPart::LightCap, DrawPart::DarkCap].map(triangles);
    switch(ui, &mut shown.sides, EntryMark::Square(colors.side), "Sides", &sides);
    switch(ui, &mut shown.light_caps, EntryMark::Square(colors.light_cap), "Light caps", &light_caps);
    switch(ui, &mut shown.dark_caps, EntryMark::Square(colors.dark_cap), "Dark caps", &dark_caps);
}

/// The sign of an entry.
enum EntryMark {
    Square(Color32),
    Line(Color32, f32),
    None,
}

fn switch(ui: &mut Ui, on: &mut bool, mark: EntryMark, name: &str, hint: &str) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        match mark {
            EntryMark::Square(color) => theme::swatch(ui, color),
            EntryMark::Line(color, width) => {
                let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
                ui.painter().hline(rect.x_range(), rect.center().y, Stroke::new(width, color));
            }
            EntryMark::None => {
                ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
            }
        }
        ui.checkbox(on, name).on_hover_text(hint);
    });
}

/// Draws the choice of the light and of the caster whose shadows are shown, or all; objects that do not cast are not
/// listed.
fn choosers(ui: &mut Ui, view: &mut SceneView, anatomy: &Anatomy) {
    theme::heading(ui, "Shadows of");
    let lights = (0..anatomy.lights.len()).map(format::light_title).collect::<Vec<_>>();
    chooser(ui, "Light shown", "all lights", &lights, &mut view.choice.light);
    let casters = anatomy.objects.iter().map(|object| object.name.clone()).collect::<Vec<_>>();
    let casts = |index: usize| anatomy.objects[index].casts;
    let mut caster = view.choice.caster;
    let text = caster.and_then(|one| casters.get(one)).map_or("all casters", String::as_str);
    let combo = egui::ComboBox::from_id_salt("caster shown").width(ui.available_width() - 8.0).truncate();
    let combo = combo.selected_text(text).show_ui(ui, |ui| {
        ui.selectable_value(&mut caster, None, "all casters");
        for index in (0..casters.len()).filter(|index| casts(*index)) {
            ui.selectable_value(&mut caster, Some(index), &casters[index]);
        }
    });
    combo.response.accessible_name("Caster shown");
    view.choice.caster = caster;
}

fn chooser(ui: &mut Ui, name: &str, all: &str, names: &[String], chosen: &mut Option<usize>) {
    let text = chosen.and_then(|one| names.get(one)).map_or(all, String::as_str);
    let combo = egui::ComboBox::from_id_salt(name).width(ui.available_width() - 8.0).truncate();
    let combo = combo.selected_text(text).show_ui(ui, |ui| {
        ui.selectable_value(chosen, None, all);
        for (index, one) in names.iter().enumerate() {
            ui.selectable_value(chosen, Some(index), one);
        }
    });
    combo.response.accessible_name(name);
}

fn notes(ui: &mut Ui, anatomy: &Anatomy, stage: &SceneStage) {
    if anatomy.is_view_assumed {
        let words = "Found from the draws of another program. Its field of view is not known: 90° is assumed, so widths \
                     and heights may be stretched.";
        ui.add(egui::Label::new(theme::note(words)).wrap());
    }
    if stage.is_cut {
        let words = "Not all of it is drawn: there is too much of it, or places are no numbers.";
        ui.add(egui::Label::new(theme::note(words)).wrap());
    }
    if !stage.left_out.is_empty() {
        let names = stage.left_out.iter().take(3).cloned().collect::<Vec<_>>().join(", ");
        let words = format!("Without the volumes of what holds everything ({names}): choose it to see them.");
        ui.add(egui::Label::new(theme::note(words)).wrap());
    }
    if anatomy.volumes.is_empty() && anatomy.silhouettes.iter().any(|one| !one.edges.is_empty()) {
        let words = format!("{} draws no volumes; silhouettes exist all the same.", anatomy.technique);
        ui.add(egui::Label::new(theme::note(words)).wrap());
    }
    if !anatomy.volumes.is_empty() && !anatomy.is_view_assumed {
        let lacks =
            |part: DrawPart| anatomy.volumes.iter().all(|volume| volume.parts.iter().all(|one| one.part != part));
        let lacking = [(DrawPart::LightCap, "light caps"), (DrawPart::DarkCap, "dark caps")];
        let lacking: Vec<&str> = lacking.into_iter().filter(|(part, _)| lacks(*part)).map(|(_, name)| name).collect();
        if !lacking.is_empty() {
            let words = format!("This frame draws no {}.", lacking.join(" and no "));
            ui.add(egui::Label::new(theme::note(words)).wrap());
        }
    }
    if anatomy.near_clips.iter().any(Option::is_none) {
        let words = "A light lies in the near plane: it has no near-clip volume.";
        ui.add(egui::Label::new(theme::note(words)).wrap());
    }
}

//! The settings of the scene: lights and camera by number, the picture's size. Each is compared with its
//! value when the scene was opened, and can be reset to it.

use super::projection;
use super::row::row;
use crate::ask::RunRequest;
use crate::inspector::look::number_field::{number_field, place_field, place_letters};
use crate::inspector::look::theme;
use crate::inspector::model::scene::OpenScene;
use crate::reading::format;
use crate::scene::{Camera, Light, Spherical};
use egui::Ui;
use glam::DVec3;

/// Largest side of a picture that the panel offers, pixels.
const MOST_PIXELS: u32 = 8192;
/// A far plane that is added is at so many near distances; at least, and at most, so many metres away.
const FAR_OF_NEAR: f64 = 1000.0;
const LEAST_FAR_OF_NEAR: f64 = 1.01;
const MOST_FAR: f64 = 1e7;

/// Draws the settings of the lights; returns true when one changed. An added light has its own values as those to reset
/// to.
pub fn lights(ui: &mut Ui, scene: &mut OpenScene) -> bool {
    let mut changed = false;
    for index in 0..scene.draft.lights.len() {
        ui.add_space(12.0);
        // A light that was added has its own values as initial ones.
        let before = scene.light_opened(index).unwrap_or(&scene.draft.lights[index]).clone();
        changed |= light_settings(ui, index, &mut scene.draft.lights[index], &before);
    }
    changed
}

/// Draws the settings of camera and picture, and which objects are there; returns true when one changed.
pub fn ui(ui: &mut Ui, scene: &mut OpenScene) -> bool {
    let OpenScene { draft, opened, objects, .. } = scene;
    ui.add_space(12.0);
    let mut changed = camera(ui, &mut draft.camera, &opened.camera, draft.size);
    ui.add_space(12.0);
    changed |= picture(ui, draft, opened);
    ui.add_space(12.0);
    changed |= objects_on(ui, draft, objects);
    changed
}

/// Draws the rows under a heading.
fn grid(ui: &mut Ui, name: impl egui::AsIdSalt, rows: impl FnOnce(&mut Ui) -> bool) -> bool {
    egui::Grid::new(name).num_columns(3).min_col_width(0.0).spacing([6.0, 4.0]).show(ui, rows).inner
}

/// Draws a box for each object of the loaded scene that switches it on and off, and the names of added ones, which are
/// removed where they are made; returns true when one changed.
fn objects_on(ui: &mut Ui, draft: &mut RunRequest, objects: &[String]) -> bool {
    theme::heading(ui, "Objects");
    let mut changed = false;
    for (index, name) in objects.iter().enumerate() {
        let mut is_on = !draft.off.contains(&index);
        let check = ui.checkbox(&mut is_on, name).on_hover_text("Drawn, and casts and receives as the scene says");
        if check.changed() {
            changed = true;
            if is_on {
                draft.off.remove(&index)
            } else {
                draft.off.insert(index)
            };
        }
    }
    for object in &draft.objects.added {
        ui.label(theme::note(format!("{}, added: see above", object.name)));
    }
    changed
}

fn light_settings(ui: &mut Ui, index: usize, light: &mut Light, before: &Light) -> bool {
    let name = format::light(index);
    let of = |what: &str| format!("{name} {what}");
    theme::heading(ui, &format!("Light {}", index + 1));
    grid(ui, ("light settings", index), |ui| {
        let mut changed = row(ui, &of("on"), "on", &mut light.is_on, &before.is_on, |ui, is_on| {
            let tick = ui.checkbox(is_on, "").accessible_name(of("is on"));
            tick.on_hover_text("Off, it adds nothing; its passes stay, so that what they do can be seen").changed()
        });
        changed |= row(ui, &of("kind"), "kind", &mut light.position.w, &before.position.w, |ui, w| {
            light_kind(ui, &of("kind"), w)
        });
        let place = if light.is_directional() { "towards" } else { "position" };
        let mut position = light.position.truncate();
        changed |= row(ui, &of(place), place, &mut position, &before.position.truncate(), |ui, position| {
            vector(ui, &of(place), position)
        });
        light.position = position.extend(light.position.w);
        changed |= row(ui, &of("colour"), "colour", &mut light.color, &before.color, |ui, color| {
            // The widget rounds what it displays; only an edit may change the value.
            let mut edited = *color;
            let picker = ui.color_edit_button_rgb(&mut edited).accessible_name(of("colour"));
            // A pale colour is as light as a light panel.
            let edge = egui::Stroke::new(1.0, theme::of(ui).line);
            ui.painter().rect_stroke(picker.rect, egui::CornerRadius::same(4), edge, egui::StrokeKind::Inside);
            let is_edited = picker.on_hover_text("Linear red, green and blue").changed();
            if is_edited {
                *color = edited;
            }
            is_edited
        });
        changed |= row(ui, &of("intensity"), "intensity", &mut light.intensity, &before.intensity, |ui, intensity| {
            let widget = number_field(intensity, 0.0..=1000.0, |widget| widget.speed(0.01));
            ui.add(widget).accessible_name(of("intensity")).changed()
        });
        changed
    })
}

/// Draws the choice of point or directional light, by the homogeneous coordinate `w`, which becomes 1 or 0; returns
/// true when it changed. The other numbers stay: they are a position, or the direction towards the light.
fn light_kind(ui: &mut Ui, name: &str, w: &mut f64) -> bool {
    let before = *w;
    let combo = egui::ComboBox::from_id_salt(("kind", name));
    let combo = combo.selected_text(if before == 0.0 { "directional" } else { "point" }).show_ui(ui, |ui| {
        ui.selectable_value(w, 1.0, "point");
        ui.selectable_value(w, 0.0, "directional");
    });
    combo.response.accessible_name(name);
    *w != before
}

fn camera(ui: &mut Ui, camera: &mut Camera, before: &Camera, size: [u32; 2]) -> bool {
    theme::heading(ui, "Camera");
    grid(ui, "camera settings", |ui| {
        let mut changed = false;
        let vectors = [
            ("camera eye", "eye", &mut camera.eye, &before.eye),
            ("camera target", "target", &mut camera.target, &before.target),
            ("camera up", "up", &mut camera.up, &before.up),
        ];
        for (name, label, value, before) in vectors {
            changed |= row(ui, name, label, value, before, |ui, value| vector(ui, name, value));
        }
        changed |= about_target(ui, camera);
        changed |= projection::rows(ui, camera, before, camera.aspect_in(size));
        changed |= row(ui, "near plane", "near plane", &mut camera.near, &before.near, |ui, near| {
            let widget = number_field(near, 1e-6..=1e6, |widget| widget.speed(0.001).max_decimals(6).suffix(" m"));
            ui.add(widget).accessible_name("Near plane").changed()
        });
        let near = camera.near;
        changed |= row(ui, "far plane", "far plane", &mut camera.far, &before.far, |ui, far| far_plane(ui, far, near));
        changed |= projection::viewport_rows(ui, camera, before, size);
        changed
    })
}

/// Draws the eye's spherical coordinates about its target, r, θ and φ; returns true when one changed. The elevation ends
/// before the eye is right above or below, where the world's up is along the view.
fn about_target(ui: &mut Ui, camera: &mut Camera) -> bool {
    let mut place = Spherical::of(camera);
    // What there is to be reset is the eye, in its own row.
    let before = place;
    let changed = row(ui, "camera r, θ, φ", "r, θ, φ", &mut place, &before, |ui, place| {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 3.0;
            ui.spacing_mut().button_padding.x = 4.0;
            let r = ("camera r", "Distance of the eye from its target, metres", 1e-6..=1e7, 3, "");
            let theta = ("camera θ", "Azimuth about the vertical, from +z towards +x", -360.0..=360.0, 2, "°");
            let phi = ("camera φ", "Elevation over level", -89.9..=89.9, 2, "°");
            let Spherical { r: distance, theta_degrees, phi_degrees } = place;
            let fields = [(r, distance), (theta, theta_degrees), (phi, phi_degrees)];
            fields.into_iter().fold(false, |changed, ((name, hover, range, decimals, unit), value)| {
                // The field rounds what it displays when it is left; only an edit may change the value.
                let digits = 10.0_f64.powi(decimals);
                let shown = (*value * digits).round() / digits;
                let mut edited = shown;
                let widget = number_field(&mut edited, range, |widget| {
                    widget.speed(0.2).max_decimals(decimals as usize).suffix(unit)
                });
                ui.add(widget).accessible_name(name).on_hover_text(hover);
                if edited != shown {
                    *value = edited;
                }
                changed || edited != shown
            })
        })
        .inner
    });
    if changed {
        camera.eye = place.eye_about(camera.target);
    }
    changed
}

/// Draws the choice of no far plane, or of its distance in metres, and returns true when it changed. A far plane that
/// is switched on begins at a multiple of the near plane's distance.
fn far_plane(ui: &mut Ui, far: &mut Option<f64>, near: f64) -> bool {
    ui.horizontal(|ui| {
        let mut is_there = far.is_some();
        let tick = ui.checkbox(&mut is_there, "").accessible_name("Has a far plane");
        let mut changed = tick.on_hover_text("Only finite depth mappings look at it").changed();
        if changed {
            *far = is_there.then_some((near * FAR_OF_NEAR).min(MOST_FAR));
        }
        match far {
            Some(far) => {
                let range = near * LEAST_FAR_OF_NEAR..=MOST_FAR;
                let widget = number_field(far, range, |widget| widget.speed(0.1).max_decimals(4).suffix(" m"));
                changed |= ui.add(widget).accessible_name("Far plane").changed();
            }
            None => drop(ui.label(theme::note("none"))),
        }
        changed
    })
    .inner
}

fn picture(ui: &mut Ui, draft: &mut RunRequest, opened: &RunRequest) -> bool {
    theme::heading(ui, "Picture");
    grid(ui, "picture settings", |ui| {
        row(ui, "picture size", "size", &mut draft.size, &opened.size, |ui, size| {
            let mut changed = false;
            ui.horizontal(|ui| {
                for (side, name) in size.iter_mut().zip(["Picture width", "Picture height"]) {
                    let widget = number_field(side, 1.0..=f64::from(MOST_PIXELS), |widget| widget);
                    changed |= ui.add(widget).accessible_name(name).changed();
                }
            });
            changed
        })
    })
}

/// Width of a digit in a field, of a small one, and of what is around a field's digits, points.
const DIGIT: f32 = 7.5;
const SMALL_DIGIT: f32 = 6.4;
const AROUND: f32 = 11.0;

/// Draws three numbers in a row, x, y and z, smaller or in more rows where they are too long for one; returns true when one
/// changed.
fn vector(ui: &mut Ui, name: &str, value: &mut DVec3) -> bool {
    let letters: usize = value.to_array().into_iter().map(place_letters).sum();
    let fits = |digit: f32| letters as f32 * digit + 3.0 * AROUND <= ui.available_width();
    let (is_small, fits) = (!fits(DIGIT) && fits(SMALL_DIGIT), fits(SMALL_DIGIT));
    let [x, y, z] = value.as_mut();
    let fields = |ui: &mut Ui, fields: &mut [(&str, &mut f64)]| {
        ui.horizontal(|ui| {
            // So that three long numbers fit beside their name.
            ui.spacing_mut().item_spacing.x = 3.0;
            ui.spacing_mut().button_padding.x = 4.0;
            if is_small {
                ui.style_mut().drag_value_text_style = egui::TextStyle::Small;
            }
            let field = |(axis, number): &mut (&str, &mut f64)| {
                let widget = place_field(number, |widget| widget.speed(0.02));
                let name = format!("{name} {axis}");
                ui.add(widget).accessible_name(&name).on_hover_text(name).changed()
            };
            fields.iter_mut().map(field).fold(false, |any, one| any | one)
        })
        .inner
    };
    // A row that wraps by itself tells the grid no more than its first line's height.
    match fits {
        true => fields(ui, &mut [("x", x), ("y", y), ("z", z)]),
        false => ui.vertical(|ui| fields(ui, &mut [("x", x), ("y", y)]) | fields(ui, &mut [("z", z)])).inner,
    }
}

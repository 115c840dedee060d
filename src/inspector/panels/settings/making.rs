//! Editing scenes: lights and objects are added, moved and deleted, and the eye looks at one of them.
//!
//! All of it is part of how the scene is run, so that it can be undone, and is in the scene file that is exported.

use crate::inspector::look::number_field::place_field;
use crate::inspector::look::theme;
use crate::inspector::model::scene::OpenScene;
use crate::reading::format;
use crate::reading::meshes::pictures;
use crate::scene::{Camera, Light, Material, Mesh, MeshError, Object, Pose, Projection, Shading, shapes};
use egui::{CollapsingHeader, Ui};
use glam::DVec3;

/// Size of an added object, as a share of the distance from the eye to its target.
const SIZE: f64 = 0.2;
/// Share of the picture's height that an object has after the eye has turned to it.
const FILLED: f64 = 0.6;
/// Corners around a round shape.
const AROUND: u32 = 32;

/// Returns the mesh of a shape.
type ShapeMaker = fn() -> Result<Mesh, MeshError>;

/// Shapes that can be added, a metre large, with their names.
const SHAPES: [(&str, Shading, ShapeMaker); 5] = [
    ("box", Shading::Flat, || shapes::cuboid([1.0; 3])),
    ("sphere", Shading::Phong, || shapes::sphere(0.5, AROUND, AROUND / 2)),
    ("torus", Shading::Phong, || shapes::torus(0.35, 0.15, AROUND, AROUND / 2)),
    ("cylinder", Shading::Flat, || shapes::cylinder(0.5, 1.0, AROUND)),
    ("board", Shading::Flat, || shapes::quad([1.0; 2])),
];

/// Draws a folded section that adds objects and lights, deletes lights, and edits one object. Returns true when the draft
/// changed; nothing is run.
pub fn ui(ui: &mut Ui, scene: &mut OpenScene) -> bool {
    ui.add_space(8.0);
    let header = CollapsingHeader::new("Add, move or delete lights and objects").id_salt("make");
    let made = header.show(ui, |ui| {
        let added = add(ui, scene);
        let deleted = delete_lights(ui, scene);
        added | deleted | edited(ui, scene)
    });
    made.body_returned.unwrap_or(false)
}

/// Draws buttons that add objects, with a size for the view, where the eye looks, and lights above that. An added
/// object becomes the edited one. Returns true when something was added.
fn add(ui: &mut Ui, scene: &mut OpenScene) -> bool {
    let camera = scene.draft.camera;
    let Camera { eye, target, .. } = camera;
    // As far away as a perspective camera of 45 degrees that shows as much.
    let far = match camera.is_parallel() {
        true => camera.half_height() / 22.5_f64.to_radians().tan(),
        false => eye.distance(target),
    };
    let mut changed = false;
    ui.horizontal_wrapped(|ui| {
        ui.label(theme::note("add"));
        for (name, shading, shape) in SHAPES {
            let button = ui.button(name).on_hover_text(format!("A {name} where the eye looks"));
            if button.clicked()
                && let Ok(mesh) = shape()
            {
                let pose = Pose { translate: target, scale: DVec3::splat(rounded(SIZE * far)), ..Pose::default() };
                let name = unused(name, scene);
                scene.edited = scene.object_count();
                let material = Material { shading, ..Material::default() };
                scene.draft.objects.added.push(Object { pose, ..Object::new(name, mesh.into(), material) });
                changed = true;
            }
        }
        let light = |ui: &mut Ui, name: &str, what: &str| ui.button(name).on_hover_text(what).clicked();
        if light(ui, "point light", "A light above what the eye looks at") {
            scene.add_light(Light::point(target + DVec3::Y * far));
            changed = true;
        }
        if light(ui, "sun", "A light from far away, a little from the side") {
            scene.add_light(Light::directional([0.4, 1.0, 0.3]));
            changed = true;
        }
    });
    changed
}

/// Returns a positive length rounded to two significant digits, as a user would type it; 1 where that is not a normal
/// number.
fn rounded(length: f64) -> f64 {
    let digit = 10.0_f64.powf(length.log10().floor() - 1.0);
    let rounded = (length / digit).round() * digit;
    if rounded.is_normal() { rounded } else { 1.0 }
}

/// Returns the name, or where an object has it, the name with a space and the first number from 2 that no object has;
/// objects that were added count too.
fn unused(name: &str, scene: &OpenScene) -> String {
    let added = scene.draft.objects.added.iter().map(|object| &object.name);
    let taken: Vec<&String> = scene.objects.iter().chain(added).collect();
    let numbered = (2..).map(|number| format!("{name} {number}"));
    let mut names = std::iter::once(name.to_owned()).chain(numbered);
    names.find(|name| !taken.contains(&name)).unwrap_or_default()
}

fn delete_lights(ui: &mut Ui, scene: &mut OpenScene) -> bool {
    let mut deleted = None;
    ui.horizontal_wrapped(|ui| {
        for index in 0..scene.draft.lights.len() {
            let button = ui.button(format!("Delete {}", format::light(index)));
            if button.on_hover_text("Undo brings it back").clicked() {
                deleted = Some(index);
            }
        }
    });
    deleted.map(|index| scene.delete_light(index)).is_some()
}

/// Draws the choice of the edited object, its position, and what can be done with it; objects that are switched off are
/// not listed. Returns true when the draft changed, false without objects.
fn edited(ui: &mut Ui, scene: &mut OpenScene) -> bool {
    let all = 0..scene.object_count();
    let on: Vec<(usize, Object)> = all
        .filter(|index| !scene.draft.off.contains(index))
        .filter_map(|index| Some((index, scene.object(index)?)))
        .collect();
    let Some((index, object)) = on.iter().find(|(index, _)| *index == scene.edited).or(on.last()) else { return false };
    let combo = egui::ComboBox::from_id_salt("edited object").selected_text(&object.name).show_ui(ui, |ui| {
        for (index, object) in &on {
            ui.selectable_value(&mut scene.edited, *index, &object.name);
        }
    });
    combo.response.accessible_name("Object");
    for line in pictures(object) {
        ui.add(egui::Label::new(theme::note(line)).wrap());
    }
    let mut pose = object.pose;
    let mut changed = pose_settings(ui, &mut pose);
    if changed {
        scene.place(*index, pose);
    }
    ui.horizontal_wrapped(|ui| {
        let look =
            ui.button("Look at it").on_hover_text("The eye turns to it, and comes so near that all of it is seen");
        changed |= look.clicked() && look_at(&mut scene.draft.camera, object);
        let up = ui.button("Z is up").on_hover_text(
            "Turns it so that what points along the z axis points up, for models of programs where z is up",
        );
        if up.clicked() {
            scene.place(*index, object.pose.with_z_up());
            changed = true;
        }
        if ui.button("Delete").on_hover_text("Undo brings it back").clicked() {
            delete(scene, *index);
            changed = true;
        }
    });
    changed
}

/// Switches off an object of the loaded scene; removes one that was added, so that the indices after it, also of those
/// switched off, decrease by one.
fn delete(scene: &mut OpenScene, index: usize) {
    let (draft, count) = (&mut scene.draft, scene.loaded.len());
    if index < count {
        draft.off.insert(index);
        return;
    }
    draft.objects.added.remove(index - count);
    let off = std::mem::take(&mut draft.off);
    draft.off = off.into_iter().filter(|off| *off != index).map(|off| off - usize::from(off > index)).collect();
}

fn pose_settings(ui: &mut Ui, pose: &mut Pose) -> bool {
    let mut changed = false;
    egui::Grid::new("edited pose").num_columns(2).spacing([12.0, 4.0]).show(ui, |ui| {
        let rows = [
            ("position", &mut pose.translate, 0.02, ""),
            ("turn", &mut pose.rotate_degrees, 0.5, "°"),
            ("scale", &mut pose.scale, 0.01, ""),
        ];
        for (label, value, speed, unit) in rows {
            ui.label(theme::note(label));
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 4.0;
                for (axis, number) in ["x", "y", "z"].into_iter().zip(value.as_mut()) {
                    let before = *number;
                    let widget = place_field(number, |widget| widget.speed(speed).suffix(unit));
                    let response = ui.add(widget);
                    changed |= response.accessible_name(format!("object {label} {axis}")).changed();
                    // A drag may pass zero, which would flatten the object.
                    if label == "scale" && *number == 0.0 {
                        *number = before;
                    }
                }
            });
            ui.end_row();
        }
    });
    changed
}

/// Makes the eye look at an object from its present side, so near that the object fills most of the view, and brings
/// the near plane nearer where it would cut it. Returns false, and changes nothing, where the object has no size, or
/// eye and target are one point.
fn look_at(camera: &mut Camera, object: &Object) -> bool {
    let positions = object.world_positions();
    let Some(low) = positions.iter().copied().reduce(DVec3::min) else { return false };
    let high = positions.iter().copied().fold(low, DVec3::max);
    let middle = low / 2.0 + high / 2.0;
    let radius = positions.iter().map(|point| point.distance(middle)).fold(0.0, f64::max);
    let away = (camera.eye - camera.target).try_normalize();
    let Some(away) = away.filter(|_| radius > 0.0 && radius.is_finite()) else { return false };
    let half_angle = match camera.projection {
        // Its sides need not be the picture's.
        Projection::Frustum { .. } => camera.half_size(1.0).min_element().atan(),
        _ => (camera.fov_y_degrees / 2.0).to_radians(),
    };
    let distance = radius / (FILLED * half_angle.sin());
    if let Projection::Orthographic { half_height } | Projection::Oblique { half_height, .. } = &mut camera.projection {
        *half_height = radius / FILLED;
    }
    // A frustum's middle may be off the view's axis: it is what looks at the object.
    let aside = camera.world_from_view() * (camera.center() * distance).extend(0.0);
    camera.target = middle - aside;
    camera.eye = camera.target + away * distance;
    // So that the near plane does not cut it.
    *camera = camera.with_near(camera.near.min((distance - radius) * 0.5));
    true
}

//! Which axis of a model is up. Many programs have z up, and their models lie on their side here.
//!
//! Changing it is a change of the scene like any other. Floor, light and camera go where they would be had the file
//! been opened so, each unless the user moved it, or it was elsewhere when the file was opened.

use crate::inspector::look::{theme, widgets};
use crate::inspector::model::scene::OpenScene;
use crate::scene::{Camera, Object, Pose, SceneBounds, is_model};
use egui::Ui;
use glam::{DVec3, DVec4};

const LABELS: [(&str, &str); 2] = [
    ("y up", "As most models have it"),
    ("z up", "Turns the model; floor, light and camera go with it, unless you moved them"),
];

/// Draws the choice of the axis that is up, where the scene was opened from a bare model file; rotates the model when
/// it changes, and then returns true. Draws nothing otherwise.
pub fn ui(ui: &mut Ui, scene: &mut OpenScene) -> bool {
    if !scene.source.as_deref().is_some_and(is_model) {
        return false;
    }
    let Some(model) = scene.loaded.first() else { return false };
    let poses = poses(model);
    let now = scene.draft.objects.moved.get(&0).copied().unwrap_or(model.pose);
    let chosen = poses.iter().position(|pose| *pose == now);
    ui.add_space(12.0);
    theme::heading(ui, "Model");
    let clicked = ui.horizontal(|ui| widgets::segments(ui, &LABELS, chosen)).inner;
    let Some(index) = clicked.filter(|index| Some(*index) != chosen) else { return false };
    turn(scene, poses[index]);
    true
}

/// Returns the poses with y up and with z up; the model may have been opened either way.
fn poses(model: &Object) -> [Pose; 2] {
    let upright = Pose::default();
    let y_up = if model.pose == upright.with_z_up() { upright } else { model.pose };
    [y_up, y_up.with_z_up()]
}

/// The floor, light and camera for a model at a pose.
struct ModelSurroundings {
    floor: Option<Pose>,
    light: DVec4,
    camera: Camera,
}

impl ModelSurroundings {
    fn at(pose: Pose, scene: &OpenScene) -> Option<ModelSurroundings> {
        let [opened, rotated] =
            [scene.loaded[0].pose, pose].map(|pose| Object { pose, ..scene.loaded[0].clone() }.world_positions());
        let (before, around) = (SceneBounds::of(&opened)?, SceneBounds::of(&rotated)?);
        let floor = scene.loaded.get(1).map(|floor| floor.pose);
        let lower = DVec3::Y * (around.lowest() - before.lowest());
        Some(ModelSurroundings {
            floor: floor.map(|floor| Pose { translate: floor.translate + lower, ..floor }),
            light: around.light().position,
            camera: around.camera(&rotated),
        })
    }
}

/// Moves the model, which comes first, and all of its surroundings that are where they were generated, whichever axis
/// was up then: what was placed elsewhere stays.
fn turn(scene: &mut OpenScene, pose: Pose) {
    let before = poses(&scene.loaded[0]).map(|pose| ModelSurroundings::at(pose, scene));
    let made = ModelSurroundings::at(pose, scene);
    scene.place(0, pose);
    let Some(made) = made else { return };
    let before: Vec<ModelSurroundings> = before.into_iter().flatten().collect();
    if let (Some(floor), Some(now)) = (made.floor, scene.object(1).map(|floor| floor.pose))
        && before.iter().any(|one| one.floor == Some(now))
    {
        scene.place(1, floor);
    }
    if scene.light_opened(0).is_some() {
        let position = &mut scene.draft.lights[0].position;
        if before.iter().any(|one| one.light == *position) {
            *position = made.light;
        }
    }
    let camera = &mut scene.draft.camera;
    let view = |camera: &Camera| (camera.eye, camera.target, camera.up);
    if before.iter().any(|one| view(&one.camera) == view(camera)) {
        let is_near_made = before.iter().any(|one| one.camera.near == camera.near);
        let near = if is_near_made { made.camera.near } else { camera.near };
        let Camera { eye, target, up, .. } = made.camera;
        *camera = Camera { eye, target, up, ..camera.with_near(near) };
    }
}

//! Which axis of a model is up. Many programs have z up, and what they write lies on its side here.
//!
//! Turning it is a change of the scene as others are. Floor, light and camera go where they would be had the file been
//! opened so.

use crate::inspector::look::{theme, widgets};
use crate::inspector::model::scene::OpenScene;
use crate::scene::{Camera, Object, Pose, Surroundings};
use egui::Ui;
use glam::DVec3;
use std::path::Path;

const LABELS: [(&str, &str); 2] =
    [("y up", "As most models have it"), ("z up", "Turns the model; floor, light and camera go where it is then")];

/// Draws the choice where a bare model is open; true when it changed.
pub fn ui(ui: &mut Ui, scene: &mut OpenScene) -> bool {
    let is_obj = |source: &String| Path::new(source).extension().is_some_and(|kind| kind.eq_ignore_ascii_case("obj"));
    if !scene.source.as_ref().is_some_and(is_obj) {
        return false;
    }
    let Some(model) = scene.loaded.first() else { return false };
    let poses = [model.pose, model.pose.with_z_up()];
    let now = scene.draft.objects.moved.get(&0).copied().unwrap_or(model.pose);
    let chosen = poses.iter().position(|pose| *pose == now);
    ui.add_space(12.0);
    theme::heading(ui, "Model");
    let clicked = ui.horizontal(|ui| widgets::segments(ui, &LABELS, chosen)).inner;
    let Some(pose) = clicked.filter(|_| clicked != chosen).map(|index| poses[index]) else { return false };
    turn(scene, pose);
    true
}

/// The model, which comes first, and what is around it.
fn turn(scene: &mut OpenScene, pose: Pose) {
    let [opened, turned] =
        [scene.loaded[0].pose, pose].map(|pose| Object { pose, ..scene.loaded[0].clone() }.world_positions());
    scene.place(0, pose);
    let (Some(before), Some(around)) = (Surroundings::of(&opened), Surroundings::of(&turned)) else { return };
    if let Some(floor) = scene.loaded.get(1).map(|floor| floor.pose) {
        let translate = floor.translate + DVec3::Y * (around.lowest() - before.lowest());
        scene.place(1, Pose { translate, ..floor });
    }
    if scene.light_opened(0).is_some() {
        scene.draft.lights[0].position = around.light().position;
    }
    let Camera { projection, fov_y_degrees, far, .. } = scene.draft.camera;
    scene.draft.camera = Camera { projection, fov_y_degrees, far, ..around.camera(&turned) };
}

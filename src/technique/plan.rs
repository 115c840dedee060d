//! Which function plans a frame for each technique, and what is said of each.

use super::choice::{Choice, ChoiceError};
use super::description::{ComparisonRole, TechniqueDescription};
use super::error::PlanError;
use super::frame::PlanRequest;
use super::named::Technique;
use super::{auto, none, planar, planar_texture, projective, ray_traced, shadow_map, volume};
use crate::geometry::{GeometryCache, relative};
use crate::plan::FramePlan;
use crate::scene::Scene;

/// Plans a frame with the chosen technique: returns its passes and draws as data, without a GPU.
pub fn plan(job: PlanRequest) -> Result<FramePlan, PlanError> {
    let plan = job.choice.technique().description().plan;
    if !job.choice.common().rounds_world {
        return plan(job);
    }
    // What is cached belongs to positions that are not rounded.
    let (scene, mut cache) = (seen_in_single_precision(job.scene), GeometryCache::default());
    plan(PlanRequest { scene: &scene, cache: &mut cache, ..job })
}

/// Returns the scene with its eye and its lights rounded to single precision. Objects are rounded where they are placed.
fn seen_in_single_precision(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    // The view looks the same way: float engines store directions, not targets.
    let eye = relative::rounded(scene.camera.eye);
    scene.camera.target += eye - scene.camera.eye;
    scene.camera.eye = eye;
    for light in scene.lights.iter_mut().filter(|light| !light.is_directional()) {
        light.position = relative::rounded(light.position.truncate()).extend(light.position.w);
    }
    scene
}

impl Technique {
    /// Returns the technique's description: help texts, report rows, and its place in stress tables.
    pub const fn description(self) -> &'static TechniqueDescription {
        match self {
            Technique::None => &none::DESCRIPTION,
            Technique::Planar => &planar::DESCRIPTION,
            Technique::PlanarTexture => &planar_texture::DESCRIPTION,
            Technique::ZPass => &volume::Z_PASS,
            Technique::ZFail => &volume::Z_FAIL,
            Technique::ZPassPlus => &volume::Z_PASS_PLUS,
            Technique::Auto => &auto::DESCRIPTION,
            Technique::ShadowMap => &shadow_map::DESCRIPTION,
            Technique::Projective => &projective::DESCRIPTION,
            Technique::RayTraced => &ray_traced::DESCRIPTION,
        }
    }

    /// Returns what the technique does, in one sentence.
    pub fn summary(self) -> &'static str {
        self.description().summary
    }

    /// Returns the techniques that stress cases compare, in the order of their tables; `none` and the ray-traced truth
    /// are not among them.
    pub fn rivals() -> Vec<Technique> {
        let place = |technique: Technique| match technique.description().standing {
            ComparisonRole::Rival { place, .. } => Some((place, technique)),
            ComparisonRole::Apart { .. } => None,
        };
        let mut rivals: Vec<_> = Technique::ALL.into_iter().filter_map(place).collect();
        rivals.sort_unstable();
        rivals.into_iter().map(|(_, technique)| technique).collect()
    }
}

impl Choice {
    /// Returns the choices that a report compares by default: every report row of every technique, in teaching order;
    /// techniques without rows are left out.
    pub fn report_grid() -> Result<Vec<Choice>, ChoiceError> {
        let mut grid = Vec::new();
        for technique in Technique::ALL {
            for row in technique.description().report_rows {
                let mut choice = Choice::new(technique);
                row.iter().try_for_each(|(key, value)| choice.set(key, value))?;
                grid.push(choice);
            }
        }
        Ok(grid)
    }
}

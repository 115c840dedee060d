//! `stencilscope bench moving`: what `auto` costs beside the fastest technique that is right, where everything moves.

use super::options::{FrameOptions, open_session};
use super::{CliError, output};
use crate::progress::Progress;
use crate::scene::{
    Camera, Light, Material, Mesh, MeshError, Motion, Object, Orbit, Projection, Scene, SceneBuilder, SceneError,
    builtin, shapes,
};
use crate::session::{MeasuredTechnique, Measurement, MotionFrames, MovingPart, median_ms};
use crate::technique::{Choice, Technique};
use glam::DVec3;
use std::sync::Arc;
use std::time::Duration;

/// The frames in which every technique is measured: two seconds of a scene.
const MOTION: MotionFrames = MotionFrames { moves: MovingPart::Everything, from: 0.0, to: 2.0, frames: 9 };
/// The frames in which `auto` and the fastest of the others are measured again: these and others between them.
const AGAIN: MotionFrames = MotionFrames { frames: 27, ..MOTION };
/// What names of random scenes begin with; their seed follows.
const TUMBLING: &str = "tumbling ";

/// Runs the benchmark `moving`: of each scene, or of all built-in ones and `tumbling` random ones, moves light, eye and
/// all that the scene moves, sets every frame up anew, and prints the ratio of the time of `auto`, set-up included, to
/// that of the fastest technique without wrong pixels in any frame, and how many are wrong by `auto`.
///
/// The lowest of many medians is too low by chance, so it only chooses the rival: the two are then timed again, alone.
pub fn run(scenes: Vec<Scene>, tumbling: u64, frame: &FrameOptions) -> Result<(), CliError> {
    let scenes = match scenes.is_empty() {
        false => scenes,
        true => {
            let built_in = builtin::ALL.iter().map(|of| of.scene());
            built_in.chain((0..tumbling).map(tumbling_scene)).collect::<Result<_, SceneError>>()?
        }
    };
    let mut session = open_session(frame.adapter.as_deref())?;
    let size = frame.picture_size();
    for scene in &scenes {
        let mut measure = |choices, motion| {
            let what = Measurement { choices, size, runs: 1 };
            session.measure_moving(scene, &what, motion, &Progress::default())
        };
        let all = measure(choices()?, MOTION)?;
        let mut wrong = wrong_by_auto(&all);
        let mut pair = Vec::new();
        for rival in fastest_first(&all) {
            let again = measure(vec![Choice::new(Technique::Auto), rival], AGAIN)?;
            wrong = wrong.max(wrong_by_auto(&again));
            // The second measurement sees more moments, in which the rival may be wrong.
            if again.iter().all(|one| is_auto(one) || is_right(one)) {
                pair = again;
                break;
            }
        }
        output::print(&line(&scene.name, &pair, wrong))?;
    }
    Ok(())
}

/// Returns all that is compared: `auto`, every technique that it may stand beside, and z-fail with the casters' faces
/// toward the light.
fn choices() -> Result<Vec<Choice>, CliError> {
    let mut choices: Vec<Choice> = Technique::rivals().into_iter().map(Choice::new).collect();
    let mut facing = Choice::new(Technique::ZFail);
    facing.set("casters", "light-facing")?;
    choices.push(facing);
    Ok(choices)
}

/// Returns the techniques other than `auto` without wrong pixels, the fastest first.
fn fastest_first(measured: &[MeasuredTechnique]) -> Vec<Choice> {
    let mut right: Vec<_> = measured.iter().filter(|one| !is_auto(one) && is_right(one)).collect();
    right.sort_by(|one, other| total_ms(one).total_cmp(&total_ms(other)));
    right.into_iter().map(|one| one.choice.clone()).collect()
}

fn is_auto(measured: &MeasuredTechnique) -> bool {
    measured.choice.technique() == Technique::Auto
}

fn wrong_by_auto(measured: &[MeasuredTechnique]) -> u64 {
    measured.iter().filter(|one| is_auto(one)).map(|one| one.error.wrong()).sum()
}

fn is_right(measured: &MeasuredTechnique) -> bool {
    measured.error.wrong() == 0
}

/// Returns the lines of one scene from what was measured of `auto` and of the fastest of the others, in this order, and
/// of how many pixels are `wrong` by `auto` in all frames; `pair` is empty where no other is right.
fn line(name: &str, pair: &[MeasuredTechnique], wrong: u64) -> String {
    let [auto, fastest] = pair else {
        return format!("{name}: no technique but auto is right in all frames; {wrong} wrong pixels\n");
    };
    let ms = |times: &[Duration]| median_ms(times).unwrap_or(f64::NAN);
    format!(
        "{name}: auto/fastest that is right {:.2}; {wrong} wrong pixels\n  auto {:.1} + set-up {:.1} ms, {} {:.1} + {:.1}\n",
        total_ms(auto) / total_ms(fastest),
        ms(&auto.frames),
        ms(&auto.setups),
        fastest.choice.technique().name(),
        ms(&fastest.frames),
        ms(&fastest.setups),
    )
}

/// Returns the median time of a frame and its set-up, milliseconds.
fn total_ms(of: &MeasuredTechnique) -> f64 {
    let totals: Vec<Duration> = of.frames.iter().zip(&of.setups).map(|(frame, setup)| *frame + *setup).collect();
    median_ms(&totals).unwrap_or(f64::NAN)
}

/// Returns the random scene that is called so, which can be measured again alone; `None` for other names.
pub fn tumbling_named(name: &str) -> Option<Result<Scene, SceneError>> {
    name.strip_prefix(TUMBLING)?.parse().ok().map(tumbling_scene)
}

/// Returns a random scene: three to six closed bodies that spin and run around a middle above a floor, under a light that
/// runs around it, too. The same for the same seed.
fn tumbling_scene(seed: u64) -> Result<Scene, SceneError> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    // Knuth's MMIX constants.
    let mut unit = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut within = |reach: f64| DVec3::new(unit(), unit(), unit()).map(|one| (2.0 * one - 1.0) * reach);
    let name = format!("{TUMBLING}{seed}");
    let mesh = |made: Result<Mesh, MeshError>| {
        made.map(Arc::new).map_err(|source| SceneError::Mesh { name: name.clone(), source })
    };
    let mut orbit = |speed: f64| Orbit {
        center: DVec3::ZERO,
        axis: within(1.0) + DVec3::Y * 2.0,
        degrees_per_second: within(speed).x,
    };
    let floor = Object { casts: false, ..Object::of("floor", mesh(shapes::quad([20.0, 20.0]))?).at([0.0, -2.0, 0.0]) };
    let light_orbit = orbit(60.0);
    let mut objects = vec![floor];
    let count = 3 + seed % 4;
    for index in 0..count {
        let motion = Motion { orbit: Some(orbit(40.0)), ..Motion::default() };
        let body = match (seed + index) % 4 {
            0 => shapes::torus(0.66, 0.22, 48, 20),
            1 => shapes::sphere(0.6, 40, 20),
            2 => shapes::cuboid([0.9, 0.6, 1.2]),
            _ => shapes::tetrahedron(0.8),
        };
        objects.push(Object { motion, ..Object::of(format!("body {index}"), mesh(body)?) });
    }
    for object in objects.iter_mut().skip(1) {
        object.pose.translate = within(2.2) * DVec3::new(1.0, 0.4, 1.0);
        object.pose.rotate_degrees = within(180.0);
        object.motion.spin_degrees_per_second = within(60.0);
    }
    let light = Light {
        motion: Motion { orbit: Some(light_orbit), ..Motion::default() },
        ..Light::point(DVec3::new(0.4, 2.6, -0.3) + within(0.5))
    };
    let camera = Camera {
        eye: DVec3::new(3.4, 1.6, 4.0) + within(0.5),
        target: within(0.5),
        up: DVec3::Y,
        projection: Projection::Perspective,
        fov_y_degrees: 55.0,
        near: 0.05,
        far: None,
        viewport: None,
    };
    let material = |object: Object, color: DVec3| Object {
        material: Material { color: color.as_vec3().to_array(), ..Material::default() },
        ..object
    };
    let objects =
        objects.into_iter().map(|object| material(object, DVec3::splat(0.5) + within(0.4))).collect::<Vec<_>>();
    Ok(SceneBuilder::new(&name).ambient([0.1; 3]).camera(camera).light(light).objects(objects).build())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tumbling_scenes_are_the_same_for_the_same_seed_and_all_of_them_move() {
        for seed in 0..20 {
            let scene = tumbling_scene(seed).expect("a scene");
            assert_eq!(scene, tumbling_scene(seed).expect("a scene"));
            assert_ne!(scene, tumbling_scene(seed + 1).expect("a scene"));
            let bodies = &scene.objects[1..];
            assert!(bodies.len() >= 3 && bodies.iter().all(|body| !body.motion.is_still()));
            assert!(!scene.lights[0].motion.is_still());
        }
    }
}

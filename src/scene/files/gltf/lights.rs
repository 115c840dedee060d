//! Lights (`KHR_lights_punctual`) and cameras.
//!
//! Intensities are candela and lux there, and there is no exposure here: they are scaled so that all lights together
//! give 1 at the centre of the scene, so that nothing is overexposed, and each keeps its share. Light does not fade
//! here except towards its range.

use super::document::GltfResult;
use super::named;
use super::nodes::GltfNodes;
use crate::scene::camera::placement::SceneBounds;
use crate::scene::files::read_text::quoted;
use crate::scene::not_taken::UnsupportedList;
use crate::scene::{Camera, Light, MOST_LIGHTS, Projection};
use glam::DVec3;
use gltf::json::Root;
use gltf::json::camera::Type as CameraType;
use gltf::json::extensions::scene::khr_lights_punctual::Type;
use gltf::json::validation::Checked;

/// The least near plane of an orthographic camera, as a part of its distance to the far plane.
const NEAREST: f64 = 1e-6;

/// A light or a camera, and the index of the node that it belongs to.
#[derive(Debug, Clone)]
pub struct NodeItem<T> {
    pub node: usize,
    pub it: T,
}

/// Returns the lights of the scene that is shown, in world space, with intensities at the middle of the scene scaled so
/// that they sum to 1; records in `refusals` what is not shown, such as a spot's cone, which becomes a point light, and
/// lights beyond the most that fit.
pub fn lights(
    root: &Root,
    nodes: &GltfNodes,
    around: &SceneBounds,
    refusals: &mut UnsupportedList,
) -> Vec<NodeItem<Light>> {
    let mut found = Vec::new();
    for node in nodes.shown.iter().copied() {
        let extension = root.nodes[node].extensions.as_ref().and_then(|known| known.khr_lights_punctual.as_ref());
        let Some(given) = extension.and_then(|of| root.get(of.light)) else { continue };
        let name = named(given.name.as_deref().or(root.nodes[node].name.as_deref()), || format!("node {node}"));
        let world = &nodes.world[node];
        let at = world.transform_point3(DVec3::ZERO);
        // It shines along its −z axis.
        let towards = world.transform_vector3(DVec3::Z);
        let mut light = match given.type_ {
            Checked::Valid(Type::Directional) => Light::directional(towards.normalize_or_zero()),
            Checked::Valid(Type::Spot) => {
                refusals.refuse(
                    format!("the cone of {}", quoted(&name)),
                    "a spot shines to all sides here, as a point does",
                );
                Light::point(at)
            }
            _ => Light::point(at),
        };
        light.color = given.color.map(|channel| if channel.is_finite() { channel.max(0.0) } else { 0.0 });
        if !light.is_directional() {
            light.range = given.range.map(f64::from).filter(|range| *range > 0.0);
        }
        let away = if light.is_directional() { 1.0 } else { at.distance(around.middle()).max(0.01 * around.extent()) };
        let bright = f64::from(given.intensity.max(0.0)) / (away * away);
        light.intensity = if bright.is_finite() { bright as f32 } else { 0.0 };
        match light.check() {
            Ok(()) => found.push(NodeItem { node, it: light }),
            Err(why) => refusals.refuse(format!("the light {}", quoted(&name)), why),
        }
    }
    if found.len() > MOST_LIGHTS {
        refusals.refuse(format!("{} more lights", found.len() - MOST_LIGHTS), format!("at most {MOST_LIGHTS} fit"));
        found.truncate(MOST_LIGHTS);
    }
    let together: f64 = found.iter().map(|light| f64::from(light.it.intensity)).sum();
    if together > 0.0 {
        found.iter_mut().for_each(|light| light.it.intensity = (f64::from(light.it.intensity) / together) as f32);
    }
    found
}

/// Returns the first camera of the shown scene that can be used; records in `refusals` the others. `None` where there
/// is none.
pub fn camera(
    root: &Root,
    nodes: &GltfNodes,
    around: &SceneBounds,
    refusals: &mut UnsupportedList,
) -> Option<NodeItem<Camera>> {
    let mut seen: Option<NodeItem<Camera>> = None;
    for node in nodes.shown.iter().copied() {
        let Some(given) = root.nodes[node].camera.and_then(|camera| root.get(camera)) else { continue };
        let name = named(given.name.as_deref().or(root.nodes[node].name.as_deref()), || format!("node {node}"));
        let what = format!("the camera {}", quoted(&name));
        if seen.is_some() {
            refusals.refuse(what, "the first one of the scene is the eye");
            continue;
        }
        match placed(given, nodes, node, around) {
            Ok(it) => seen = Some(NodeItem { node, it }),
            Err(why) => refusals.refuse(what, why),
        }
    }
    seen
}

fn placed(given: &gltf::json::Camera, nodes: &GltfNodes, node: usize, around: &SceneBounds) -> GltfResult<Camera> {
    let world = &nodes.world[node];
    let eye = world.transform_point3(DVec3::ZERO);
    let ahead = world.transform_vector3(DVec3::NEG_Z).normalize_or_zero();
    let up = world.transform_vector3(DVec3::Y).normalize_or_zero();
    // The camera's target is at the distance of the scene's centre, so that orbiting it is useful.
    let distance = (around.middle() - eye).dot(ahead);
    let distance = if distance > 0.01 * around.extent() { distance } else { around.extent() };
    let base = Camera { up, ..Camera::looking(eye, eye + ahead * distance) };
    let camera = match (given.type_, &given.perspective, &given.orthographic) {
        (Checked::Valid(CameraType::Perspective), Some(of), _) => Camera {
            fov_y_degrees: f64::from(of.yfov).to_degrees(),
            near: f64::from(of.znear),
            far: of.zfar.map(f64::from),
            ..base
        },
        (Checked::Valid(CameraType::Orthographic), _, Some(of)) => Camera {
            projection: Projection::Orthographic { half_height: f64::from(of.ymag.abs()) },
            // Its near plane may be at the eye, and ours may not.
            near: f64::from(of.znear).max(NEAREST * f64::from(of.zfar)),
            far: Some(f64::from(of.zfar)),
            ..base
        },
        _ => return Err("it has no projection".to_owned()),
    };
    camera.check().map_err(str::to_owned)?;
    Ok(camera)
}

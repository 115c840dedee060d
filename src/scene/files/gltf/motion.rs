//! Animations as motions.
//!
//! What can be converted is a node that rotates at one speed, whole turns, about one axis, with no other animated node
//! above or below it: what hangs on it runs along a circle and rotates with it. Everything else is listed and stands
//! still.

use super::document::{GltfDocument, GltfResult};
use super::named;
use super::nodes::{GltfNodes, pose_of, unit};
use crate::math::angle;
use crate::scene::files::read_text::quoted;
use crate::scene::not_taken::UnsupportedList;
use crate::scene::{Motion, Orbit, Pose};
use glam::{DQuat, DVec3};
use gltf::json::animation::{Animation, Channel, Interpolation, Property};
use gltf::json::validation::Checked;

/// How far rotations may differ from the motion that replaces them, radians.
const BESIDE: f64 = 1e-3;
/// The number of times at which a motion is compared with the rotation that it replaces.
const SAMPLES: usize = 7;

/// The uniform rotation of a node and all below it about an axis.
#[derive(Debug, Clone, Copy)]
pub struct NodeRotation {
    pivot: DVec3,
    /// Axis in world space, of length 1.
    axis: DVec3,
    degrees_per_second: f64,
}

/// The rotations of a file's first animation, by node.
#[derive(Debug)]
pub struct NodeRotations {
    /// For each node, what moves it.
    above: Vec<MovingAncestor>,
}

/// What moves a node.
#[derive(Debug, Clone, Copy)]
enum MovingAncestor {
    Nothing,
    One(NodeRotation),
    /// Animated nodes that hang on each other.
    Several,
}

impl NodeRotations {
    /// Converts the rotations of the file's first animation; records in `refusals` what it leaves out, such as other
    /// animations and other kinds of motion.
    pub fn new(document: &GltfDocument, nodes: &GltfNodes, refusals: &mut UnsupportedList) -> NodeRotations {
        let mut own: Vec<Option<NodeRotation>> = vec![None; document.root.nodes.len()];
        for (index, animation) in document.root.animations.iter().enumerate() {
            let name = named(animation.name.as_deref(), || format!("animation {index}"));
            if index > 0 {
                refusals.refuse(format!("the animation {}", quoted(&name)), "the first one is shown");
                continue;
            }
            for channel in &animation.channels {
                let node = channel.target.node.value();
                let Some(known) = document.root.nodes.get(node) else { continue };
                let of = named(known.name.as_deref(), || format!("node {node}"));
                match turn(document, nodes, animation, channel) {
                    Ok(turn) if own[node].is_none() => own[node] = Some(turn),
                    Ok(_) => refusals.refuse(format!("a second turn of {}", quoted(&of)), "one is shown"),
                    Err(why) => refusals.refuse(format!("{} of {} over time", property(channel), quoted(&of)), why),
                }
            }
        }
        let mut above = vec![MovingAncestor::Nothing; own.len()];
        for node in nodes.all.iter().copied() {
            let inherited = nodes.parents[node].map_or(MovingAncestor::Nothing, |parent| above[parent]);
            above[node] = match (inherited, own[node]) {
                (inherited, None) => inherited,
                (MovingAncestor::Nothing, Some(turn)) => MovingAncestor::One(turn),
                (MovingAncestor::One(_) | MovingAncestor::Several, Some(_)) => MovingAncestor::Several,
            };
        }
        NodeRotations { above }
    }

    /// Returns whether anything moves a node.
    pub fn moves(&self, node: usize) -> bool {
        !matches!(self.above[node], MovingAncestor::Nothing)
    }

    /// Returns the motion of an object of this pose that belongs to a node: still, or a spin about x, y or z, with an
    /// orbit where the node is off the axis.
    ///
    /// # Errors
    /// A rotation that no motion of ours is.
    pub fn of_object(&self, nodes: &GltfNodes, node: usize, pose: &Pose) -> GltfResult<Motion> {
        let Some(turn) = self.of(node)? else { return Ok(Motion::default()) };
        let at = nodes.world[node].transform_point3(DVec3::ZERO);
        let is_on_axis = (at - turn.pivot).cross(turn.axis).length() <= 1e-9 * at.distance(turn.pivot);
        let orbit = (!is_on_axis).then(|| turn.orbit());
        // A spin is added to one of three angles: finds the one that gives this rotation.
        let still = Pose { scale: DVec3::ONE, translate: DVec3::ZERO, ..*pose };
        let rotation = |pose: &Pose| DQuat::from_mat4(&pose.world_from_object());
        let fits = |motion: &Motion| {
            (1..=SAMPLES).all(|sample| {
                let degrees = 360.0 * sample as f64 / (SAMPLES + 1) as f64;
                let wanted = angle::rotation(turn.axis, degrees.to_radians()) * rotation(&still);
                let found = rotation(&motion.apply(&still, degrees / turn.degrees_per_second));
                wanted.angle_between(found).min(wanted.angle_between(-found)) <= BESIDE
            })
        };
        let spins = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
        let found = spins
            .map(|spin| Motion { spin_degrees_per_second: spin * turn.degrees_per_second, orbit: None, swing: None })
            .find(fits);
        let spin = found.ok_or("no spin about x, y or z turns a thing that leans so: it stands as at the start")?;
        Ok(Motion { orbit, ..spin })
    }

    /// Returns the motion of a light that hangs on a node; a directional one rotates too.
    pub fn of_light(&self, node: usize) -> GltfResult<Motion> {
        Ok(Motion { orbit: self.of(node)?.map(|turn| turn.orbit()), ..Motion::default() })
    }

    fn of(&self, node: usize) -> GltfResult<Option<NodeRotation>> {
        match self.above[node] {
            MovingAncestor::Nothing => Ok(None),
            MovingAncestor::One(turn) => Ok(Some(turn)),
            MovingAncestor::Several => Err("it hangs on two nodes that turn: it stands as at the start".to_owned()),
        }
    }
}

impl NodeRotation {
    fn orbit(&self) -> Orbit {
        Orbit { center: self.pivot, axis: self.axis, degrees_per_second: self.degrees_per_second }
    }
}

fn property(channel: &Channel) -> &'static str {
    match channel.target.path {
        Checked::Valid(Property::Translation) => "the place",
        Checked::Valid(Property::Rotation) => "the turn",
        Checked::Valid(Property::Scale) => "the size",
        _ => "the shape",
    }
}

fn turn(
    document: &GltfDocument,
    nodes: &GltfNodes,
    animation: &Animation,
    channel: &Channel,
) -> GltfResult<NodeRotation> {
    const ONLY: &str = "only whole turns at one speed about one axis are shown: it stands as at the start";
    let only = || ONLY.to_owned();
    let node = channel.target.node.value();
    if channel.target.path != Checked::Valid(Property::Rotation) {
        return Err(only());
    }
    let sampler = animation.samplers.get(channel.sampler.value()).ok_or_else(only)?;
    if sampler.interpolation != Checked::Valid(Interpolation::Linear) {
        return Err(only());
    }
    let times = document.numbers::<1>(sampler.input)?;
    let keys = document.numbers::<4>(sampler.output)?;
    // Many channels may use the same keys.
    document.take(keys.len() as u64 / 4)?;
    let keys: Vec<DQuat> = keys.as_chunks::<4>().0.iter().copied().map(unit).collect();
    let (Some(start), Some(end)) = (times.first(), times.last()) else { return Err(only()) };
    if times.len() != keys.len() || !(end - start).is_normal() || end <= start {
        return Err(only());
    }
    // From key to key it rotates the shorter way round.
    let steps: Vec<DVec3> = keys
        .windows(2)
        .map(|pair| {
            let step = pair[1] * pair[0].inverse();
            let step = if step.w < 0.0 { -step } else { step };
            step.to_scaled_axis()
        })
        .collect();
    let whole: DVec3 = steps.iter().sum();
    let speed = whole / (end - start);
    let angle = whole.length();
    let is_steady =
        steps.iter().zip(times.windows(2)).all(|(step, time)| (*step - speed * (time[1] - time[0])).length() <= BESIDE);
    let turns = angle / std::f64::consts::TAU;
    if !(is_steady && turns > 0.5 && (angle - turns.round() * std::f64::consts::TAU).abs() <= BESIDE) {
        return Err(only());
    }
    // Its first key replaces the node's own rotation: both must be equal, or the start would jump.
    let rest = super::nodes::rotation_of(&document.root.nodes[node]);
    if keys[0].angle_between(rest).min(keys[0].angle_between(-rest)) > BESIDE {
        return Err("it begins elsewhere than its node says: it stands as the node says".to_owned());
    }
    let above = nodes.parents[node].map_or(glam::DMat4::IDENTITY, |parent| nodes.world[parent]);
    let axis = above.transform_vector3(speed).normalize_or_zero();
    let is_bent = |parent: usize| pose_of(&nodes.world[parent]).is_none_or(is_uneven);
    if axis == DVec3::ZERO || nodes.parents[node].is_some_and(is_bent) {
        return Err("what it hangs on is mirrored or stretched unevenly: it stands as at the start".to_owned());
    }
    let pivot = nodes.world[node].transform_point3(DVec3::ZERO);
    Ok(NodeRotation { pivot, axis, degrees_per_second: speed.length().to_degrees() })
}

/// Returns whether a pose scales more along one axis than along another.
fn is_uneven(pose: Pose) -> bool {
    let DVec3 { x, y, z } = pose.scale;
    (x - y).abs().max((x - z).abs()) > BESIDE * x.abs()
}

//! The flat receivers of a scene, for techniques that give each its own shadow.

use super::frame::FrameBuilder;
use crate::geometry::planar;
use crate::math::{AxisBox, Sign, side_of_triangle};
use crate::plan::{Decision, LeftOut, LightId};
use glam::DVec3;

/// The most flat receivers that get shadows, the largest first; each costs a draw for every caster.
pub const MOST_RECEIVERS: usize = 64;

/// A flat piece of a drawn object on which planar shadows can fall.
#[derive(Debug, Clone)]
pub struct FlatReceiver {
    /// Index of its object in [`FrameBuilder::placed`].
    pub object: usize,
    pub receiver: planar::Receiver,
    /// A name for people: its object's, and its rank by area among all flat receivers, counted from 1.
    pub name: String,
}

/// Returns every flat piece of drawn objects that receive shadows, the largest by area first, named by object and rank.
pub fn all(frame: &mut FrameBuilder) -> Vec<FlatReceiver> {
    let mut all = Vec::new();
    for (index, placed) in frame.placed.iter().enumerate() {
        if !placed.object.receives || placed.surface.is_none() {
            continue;
        }
        let mesh = &placed.object.mesh;
        let edges = frame.job.cache.edges(mesh);
        let found = planar::receivers(mesh.positions(), &placed.world, mesh.triangles(), &edges);
        all.extend(found.into_iter().map(|receiver| (index, receiver)));
    }
    all.sort_by(|a, b| b.1.area.total_cmp(&a.1.area));
    let name = |object: usize, place: usize| format!("{}, flat piece {}", frame.placed[object].object.name, place + 1);
    let named = all.into_iter().enumerate();
    named.map(|(place, (object, receiver))| FlatReceiver { object, receiver, name: name(object, place) }).collect()
}

impl FlatReceiver {
    /// Returns whether the eye and the light are strictly on the same side of any of this receiver's triangles.
    /// Otherwise it shows no shadow of that light.
    pub fn shows_lit_side(&self, frame: &FrameBuilder, light: LightId) -> bool {
        let (eye, light) = (frame.eye_position(), frame.light_position(light));
        let placed = &frame.placed[self.object];
        self.receiver.triangles.iter().any(|triangle| {
            let corners = placed.object.mesh.triangles()[*triangle as usize].map(|v| placed.world[v as usize]);
            let side = side_of_triangle(corners, eye);
            side != Sign::Zero && side == side_of_triangle(corners, light)
        })
    }
}

/// A flat piece with a smaller share of its object's surface is taken for a facet of a curved surface.
const FACET: f64 = 1.0 / 20.0;

/// Removes from `shown` the receivers on which shadows could not be recognised: facets of curved objects and the
/// insides of closed ones. Without stencil marks each would throw shadows over all that lies in its plane.
pub fn leave_out_unmarked(frame: &mut FrameBuilder, shown: &mut Vec<&FlatReceiver>, of: &str) {
    let (eye, place) = (frame.eye_position(), frame.eye());
    let all = shown.len();
    shown.retain(|one| {
        let placed = &frame.placed[one.object];
        let (world, triangles) = (&placed.world, placed.object.mesh.triangles());
        let corners = triangles[one.receiver.triangles[0] as usize].map(|vertex| world[vertex as usize]);
        // Of an object that contains the eye, one sees the inside; the eye is then within its bounds.
        let is_inside = side_of_triangle(corners, eye) != Sign::Positive
            && !AxisBox::around(world.iter().copied()).holds(place)
            && frame.job.cache.connectivity(&placed.object.mesh).is_closed();
        !is_inside && one.receiver.area >= FACET * area(world, triangles)
    });
    let count = (all - shown.len()) as u64;
    if count > 0 {
        let because = "without the stencil nothing keeps a shadow on them, and they are less than a twentieth of their \
                       object's surface, facets of something round, or the inside of something closed";
        frame.plan.left_out.push(LeftOut::counted(Decision::SmallReceivers, count, of, because));
    }
}

fn area(world: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    let of = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|vertex| world[vertex as usize]);
        (b - a).cross(c - a).length() / 2.0
    };
    triangles.iter().map(of).sum()
}

/// Records how many of a light's `count` receivers are beyond the [`MOST_RECEIVERS`] that get shadows.
pub fn leave_out_small(frame: &mut FrameBuilder, count: usize, of: &str) {
    if count > MOST_RECEIVERS {
        let because = "the 64 largest are kept: every one costs a draw for each caster";
        let left_out = LeftOut::counted(Decision::SmallReceivers, (count - MOST_RECEIVERS) as u64, of, because);
        frame.plan.left_out.push(left_out);
    }
}

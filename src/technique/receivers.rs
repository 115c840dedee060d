//! The flat receivers of a scene, for techniques that give each its own shadow.

use super::frame::FrameBuilder;
use super::settings::ReceiverChoice;
use crate::geometry::planar;
use crate::math::clip::near_plane;
use crate::math::{AxisBox, Sign, side_of_triangle};
use crate::numbers;
use crate::plan::{LeftOut, LightId};
use glam::DVec3;
use std::collections::BTreeMap;

/// The most flat receivers that get textures, the largest first; each costs a draw for every caster.
pub const MOST_TEXTURES: usize = 64;
/// The most flat receivers that the stencil can mark: marks are even and not 0, and the odd number after each is its shadow.
pub const MOST_MARKS: usize = 127;

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

    /// Returns which part of the picture it covers, 0 to 1; what hides it is not asked about.
    fn picture_share(&self, frame: &FrameBuilder) -> f64 {
        let placed = &frame.placed[self.object];
        let (eye, view) = (frame.eye(), frame.plan.views[0].clip_from_relative.as_dmat4());
        let clip = |point: DVec3| view * (point - eye).extend(1.0);
        self.receiver.picture_share(&placed.world, placed.object.mesh.triangles(), near_plane(&frame.plan.depth), clip)
    }
}

/// A flat piece with a smaller share of its object's surface is taken for a facet of a curved surface.
const FACET: f64 = 1.0 / 20.0;

/// Removes from `shown` the receivers on which shadows could not be recognised: facets of curved objects and the
/// insides of closed ones. Without stencil marks each would throw shadows over all that lies in its plane.
pub fn leave_out_unmarked(frame: &mut FrameBuilder, shown: &mut Vec<&FlatReceiver>, of: &str) {
    let (eye, place) = (frame.eye_position(), frame.eye());
    let because = "without the stencil nothing keeps a shadow on them, and they are less than a twentieth of their \
                   object's surface, facets of something round, or the inside of something closed";
    let (kept, left) = std::mem::take(shown).into_iter().partition(|one| {
        let placed = &frame.placed[one.object];
        let (world, triangles) = (&placed.world, placed.object.mesh.triangles());
        let corners = triangles[one.receiver.triangles[0] as usize].map(|vertex| world[vertex as usize]);
        // Of an object that contains the eye, one sees the inside; the eye is then within its bounds.
        let is_inside = side_of_triangle(corners, eye) != Sign::Positive
            && !AxisBox::around(world.iter().copied()).holds(place)
            && frame.job.cache.connectivity(&placed.object.mesh).is_closed();
        !is_inside && one.receiver.area >= FACET * area(world, triangles)
    });
    *shown = kept;
    leave_out(frame, left, of, because);
}

fn area(world: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    let of = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|vertex| world[vertex as usize]);
        (b - a).cross(c - a).length() / 2.0
    };
    triangles.iter().map(of).sum()
}

/// Keeps of `shown`, the largest first, those that a setting chooses, at most [`MOST_MARKS`], and records of which objects
/// pieces are left out, and why. Where the stencil has too few marks, those that cover most of the picture keep theirs.
pub fn choose(frame: &mut FrameBuilder, shown: &mut Vec<&FlatReceiver>, choice: &ReceiverChoice, of: &str) {
    let rated = std::mem::take(shown).into_iter().map(|one| (one, one.picture_share(frame))).enumerate();
    let (kept, left): (Vec<_>, Vec<_>) = rated.partition(|(rank, (one, share))| match choice {
        ReceiverChoice::All => true,
        ReceiverChoice::Share(least) => share * 100.0 >= *least,
        ReceiverChoice::Largest(most) => rank < most,
        ReceiverChoice::Named(names) => names.contains(&frame.placed[one.object].object.name),
    });
    let because = match choice {
        ReceiverChoice::All => String::new(),
        ReceiverChoice::Share(least) => {
            let most = left.iter().map(|(_, (_, share))| *share).fold(0.0, f64::max);
            let most = numbers::per_hundred(most);
            format!(
                "receivers = share keeps what covers {least}\u{a0}% of the picture or more; the largest of these covers {most}\u{a0}%"
            )
        }
        ReceiverChoice::Largest(most) => {
            format!("receivers = largest keeps {}", numbers::counted(*most as u64, "piece"))
        }
        ReceiverChoice::Named(names) => format!("receivers = named keeps those of {}", names.join(" and ")),
    };
    leave_out(frame, left.into_iter().map(|(_, (one, _))| one), of, &because);
    let mut kept: Vec<(&FlatReceiver, f64)> = kept.into_iter().map(|(_, rated)| rated).collect();
    if kept.len() > MOST_MARKS {
        kept.sort_by(|a, b| b.1.total_cmp(&a.1));
        let because = format!("the stencil has marks for {MOST_MARKS}, and others cover more of the picture");
        leave_out(frame, kept.split_off(MOST_MARKS).into_iter().map(|(one, _)| one), of, &because);
    }
    *shown = kept.into_iter().map(|(one, _)| one).collect();
}

/// Records how many flat pieces of each object get no shadow, for a reason.
pub fn leave_out<'r>(
    frame: &mut FrameBuilder,
    pieces: impl IntoIterator<Item = &'r FlatReceiver>,
    of: &str,
    because: &str,
) {
    let mut counts = BTreeMap::new();
    pieces.into_iter().for_each(|one| *counts.entry(one.object).or_insert(0_u64) += 1);
    for (object, count) in counts {
        let name = &frame.placed[object].object.name;
        frame.plan.left_out.push(LeftOut::pieces(count, name, of, because));
    }
}

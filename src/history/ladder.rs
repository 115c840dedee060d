//! The view ray through a pixel with the shadow-volume faces on it, nearest first, and the count as
//! it runs: from infinity towards the surface where faces behind it count (z-fail), else from the
//! eye; where some volumes count in front of it and others behind (auto), along the whole ray.

use super::{PixelEvent, PixelHistory, VolumeCount};
use crate::math::depth::DepthCurve;
use crate::plan::{CountBits, CountedSide};
use std::collections::BTreeMap;

/// The faces of one light's shadow volumes along a pixel's view ray, with the running count.
#[derive(Debug, Clone, PartialEq)]
pub struct Ladder {
    /// Distance of the visible surface along the view axis in metres; `None` for the background.
    pub surface: Option<f64>,
    /// Where faces count: behind the surface, from infinity inwards; or in front of it, from the eye outwards.
    pub side: CountedSide,
    /// The number that the count began with: its clear value, plus the volumes around the near plane where those were
    /// counted.
    pub start: i32,
    /// The part of `start` that is the clear value.
    pub cleared_to: i32,
    /// The bits of the stencil that the count is stored in.
    pub bits: CountBits,
    /// The count in the end, as if it had no limits.
    pub count: i32,
    /// The count as the light pass tests it: in a stencil, wrapped or clamped to its bits.
    pub tested: VolumeCount,
    /// The faces, the nearest first.
    pub rungs: Vec<Rung>,
}

/// One volume face that the view ray crosses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rung {
    /// Index of its event in [`PixelHistory::events`].
    pub event: usize,
    /// Distance along the view axis in metres; infinite for a face at infinity.
    pub distance: f64,
    /// What it added to the count: 1, −1, or 0 where it did not count.
    pub added: i32,
    /// The count after this face, in the order in which the ladder counts.
    pub running: i32,
}

impl Ladder {
    /// Returns whether the count runs from infinity inwards (z-fail) and not from the eye outwards.
    pub fn is_from_infinity(&self) -> bool {
        self.side == CountedSide::Behind
    }
}

impl PixelHistory {
    /// Returns the faces of a light's volumes along the pixel's view ray; `None` where there are none and the near
    /// plane was not counted at either. `curve` is the capture's depth curve.
    pub fn ladder(&self, light: usize, curve: &DepthCurve) -> Option<Ladder> {
        let of_light = |event: &&PixelEvent| event.light == Some(light) && event.is_of_volume();
        let near = || self.events.iter().filter(of_light).filter(|event| !event.is_from_camera);
        let cleared_to = self.cleared_to(light);
        let start = cleared_to + near().map(PixelEvent::counted).sum::<i32>();
        let bits = self.counts_in.get(light).copied().flatten().unwrap_or(CountBits::EIGHT);
        let faces = || self.events.iter().enumerate().filter(|(_, event)| of_light(event) && event.is_from_camera);
        let first = faces().map(|(_, event)| event).next().or_else(|| near().next())?;
        // In two passes every face is drawn twice, and counts in one of them: there it is a rung.
        let mut once: BTreeMap<(usize, u32, Option<u32>), Rung> = BTreeMap::new();
        let all = faces().filter_map(|(event, face)| {
            let triangle = face.triangle()?;
            let distance = curve.distance(triangle.depth).filter(|distance| *distance >= 0.0);
            let distance = distance.unwrap_or(f64::INFINITY);
            let rung = Rung { event, distance, added: face.counted(), running: 0 };
            Some(((triangle.draw, triangle.primitive, triangle.piece), rung))
        });
        for (face, rung) in all {
            let known = once.entry(face).or_insert(rung);
            if known.added == 0 && rung.added != 0 {
                *known = rung;
            }
        }
        let mut rungs: Vec<Rung> = once.into_values().collect();
        let side = self.counted_side(light).unwrap_or(CountedSide::InFront);
        // Of faces at one distance, as of dark caps at infinity, those that add are counted first: a volume is entered
        // before it is left.
        rungs.sort_by(|a, b| {
            let first = if side == CountedSide::Behind { a.added.cmp(&b.added) } else { b.added.cmp(&a.added) };
            a.distance.total_cmp(&b.distance).then(first)
        });
        let tested = self.counted_at(light);
        let mut count = start;
        let mut run = |rung: &mut Rung| {
            count += rung.added;
            rung.running = count;
        };
        if side == CountedSide::Behind {
            rungs.iter_mut().rev().for_each(&mut run)
        } else {
            rungs.iter_mut().for_each(&mut run)
        }
        Some(Ladder {
            surface: curve.distance(first.before.depth),
            side,
            start,
            cleared_to,
            bits,
            count,
            tested,
            rungs,
        })
    }
}

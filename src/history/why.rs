//! Why a light does or does not arrive at a pixel, in one sentence, from what its history counts.

use super::{Event, EventKind, PixelHistory, TriangleEvent};
use crate::numbers;
use crate::plan::Part;
use std::collections::BTreeSet;
use std::fmt;

/// How many faces of each side, of the outside of their volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Faces {
    /// Seen from the front.
    pub front: u32,
    /// Seen from the back.
    pub back: u32,
}

/// What decided about a light at a pixel.
#[derive(Debug, Clone, PartialEq)]
pub enum Why {
    /// Faces of shadow volumes were counted.
    Counted {
        /// Faces behind the surface count, as their depth test fails; else those in front of it.
        is_behind: bool,
        /// Those that counted.
        faces: Faces,
        /// Volumes that contain the near plane, where that was asked.
        near: Option<i32>,
        /// What was left, as the light pass reads it.
        count: Count,
        /// The light pass let the surface through.
        is_lit: bool,
        /// The surface faces away from the light, so that it stays dark either way.
        faces_away: bool,
    },
    /// Casters were flattened onto receivers.
    Flattened {
        /// Names of the casters whose flattened triangles passed all tests here.
        casters: Vec<String>,
        /// Flattened triangles that cover the pixel and failed a test.
        failed: u32,
        /// The pixel is marked as one of a receiver.
        is_marked: bool,
        /// The light pass let the surface through, where it comes after the shadows.
        is_lit: bool,
    },
}

/// A count as it was kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Count {
    /// In the stencil.
    Stencil(u8),
    /// In a float.
    Float(f32),
}

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Count::Stencil(count) => f.write_str(&numbers::signed(*count)),
            Count::Float(count) if *count < 0.0 => write!(f, "−{}", -count),
            Count::Float(count) => write!(f, "{count}"),
        }
    }
}

impl PixelHistory {
    /// What decided about a light; `None` where neither volumes nor flattened casters were drawn for
    /// it over this pixel, and no surface is there to be lit.
    #[must_use]
    pub fn why(&self, light: usize) -> Option<Why> {
        let of_light = || self.events.iter().filter(move |event| event.light == Some(light));
        let is_lit = of_light()
            .any(|event| event.pass_name == LIGHT_PASS && event.triangle().is_some_and(|one| one.fate.passed()));
        let flattened: Vec<&Event> = of_light().filter(|event| part(event) == Some(Part::PlanarShadow)).collect();
        if !flattened.is_empty() {
            return Some(why_flattened(&flattened, is_lit));
        }
        let volume: Vec<&Event> = of_light().filter(|event| event.is_of_volume()).collect();
        let last = volume.last()?;
        let mut faces = Faces::default();
        for event in volume.iter().filter(|event| event.is_from_camera && event.counted() != 0) {
            let is_front = event.triangle().is_some_and(TriangleEvent::shows_outside);
            *(if is_front { &mut faces.front } else { &mut faces.back }) += 1;
        }
        let is_behind = self.counts_behind(light).unwrap_or(false);
        let near = volume.iter().filter(|event| !event.is_from_camera);
        let near = near.clone().next().map(|_| near.map(|event| event.counted()).sum());
        let in_float = self.events.iter().any(|event| event.kind == EventKind::ClearCount);
        let count = if in_float { Count::Float(last.after.count) } else { Count::Stencil(last.after.stencil) };
        let faces_away = self.labels.get(light).copied().flatten() == Some(FACES_AWAY);
        Some(Why::Counted { is_behind, faces, near, count, is_lit, faces_away })
    }
}

/// The label of surfaces that face away.
const FACES_AWAY: u8 = 3;
/// What techniques call the pass that adds a light.
const LIGHT_PASS: &str = "light";

fn part(event: &Event) -> Option<Part> {
    event.triangle().map(|one| one.part)
}

fn why_flattened(events: &[&Event], is_lit: bool) -> Why {
    let passed = |event: &&&Event| event.triangle().is_some_and(|one| one.fate.passed());
    let name = |event: &&Event| event.triangle().and_then(|one| one.caster.clone());
    let casters: BTreeSet<String> = events.iter().filter(passed).filter_map(name).collect();
    let failed = events.iter().filter(|event| !passed(event)).count() as u32;
    let is_marked = events.first().is_some_and(|event| event.before.stencil != 0);
    Why::Flattened { casters: casters.into_iter().collect(), failed, is_marked, is_lit }
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Why::Counted { is_behind, faces, near, count, is_lit, faces_away } => {
                if let Some(near) = near {
                    // More back than front faces in it leave less than none.
                    let sign = if *near < 0 { "−" } else { "" };
                    write!(f, "the near plane is in {sign}{}; ", counted(near.unsigned_abs(), "volume"))?;
                }
                let side = if *is_behind { "behind" } else { "in front of" };
                let all = faces.front + faces.back;
                if all == 0 {
                    write!(f, "no volume face {side} it counts")?;
                } else {
                    let s = if all == 1 { "s" } else { "" };
                    let [front, back] = [faces.front, faces.back];
                    // A float is counted by draws whose tests are the other way round.
                    let are_counted = match (count, is_behind) {
                        (Count::Stencil(_), true) => format!("fail{s} the depth test"),
                        (Count::Stencil(_), false) => {
                            format!("pass{} the depth test", if all == 1 { "es" } else { "" })
                        }
                        (Count::Float(_), _) => {
                            if all == 1 {
                                "is counted".to_owned()
                            } else {
                                "are counted".to_owned()
                            }
                        }
                    };
                    write!(f, "{} {side} it {are_counted}: ", counted(all, "volume face"))?;
                    if *is_behind {
                        write!(f, "{back} back, {front} front")?
                    } else {
                        write!(f, "{front} front, {back} back")?
                    }
                }
                let then = match (is_lit, faces_away) {
                    (true, true) => "would light it, but it faces away from the light",
                    (true, false) => "adds the light",
                    (false, _) => "skips it",
                };
                write!(f, "; count {count}, so the light pass {then}")
            }
            Why::Flattened { casters, failed, is_marked, is_lit } => {
                let s = if *failed == 1 { "s" } else { "" };
                match (casters.is_empty(), is_marked) {
                    (false, _) => {
                        write!(f, "the flattened shadow of {} falls on its receiver here", casters.join(" and "))?;
                    }
                    (true, false) => {
                        let triangles = counted(*failed, "flattened triangle");
                        write!(
                            f,
                            "it is on no marked receiver, so {triangles} that cover{s} it fail{s} the stencil test"
                        )?;
                    }
                    (true, true) => {
                        let triangles = counted(*failed, "flattened triangle");
                        write!(f, "{triangles} cover{s} it, but on the planes of other receivers")?;
                    }
                }
                f.write_str(match (casters.is_empty(), is_lit) {
                    (true, true) => ": the light arrives",
                    (true, false) => ": the light pass skips it all the same",
                    (false, true) => ": it is darkened after the light pass",
                    (false, false) => ", so the light pass skips it",
                })
            }
        }
    }
}

fn counted(count: u32, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_near_plane_that_more_volumes_were_left_than_entered_has_a_sign() {
        let faces = Faces { front: 2, back: 0 };
        let (near, count) = (Some(-1), Count::Stencil(1));
        let why = Why::Counted { is_behind: false, faces, near, count, is_lit: false, faces_away: false };
        assert_eq!(
            why.to_string(),
            "the near plane is in −1 volume; 2 volume faces in front of it pass the depth test: 2 front, 0 back; count \
             1, so the light pass skips it"
        );
    }
}

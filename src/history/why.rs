//! Why a light does or does not arrive at a pixel, in one sentence, from what its history counts.

use super::{FragmentOutcome, PixelEvent, PixelEventKind, PixelHistory, TestResult, TriangleEvent};
use crate::capture::FrameTarget;
use crate::numbers;
use crate::plan::{CountBits, CountedSide, DrawPart, Visibility};
use crate::truth::{BACKGROUND, FACES_AWAY, SHADOW};
use std::collections::BTreeSet;
use std::fmt;

/// What the events of a pixel's history say about a light: why it is added there or not.
#[derive(Debug, Clone, PartialEq)]
pub enum LightDecision {
    /// There is no surface at the pixel.
    Background,
    /// Faces of shadow volumes were counted.
    Counted(CountedFaces, LightPassResult),
    /// Casters were flattened onto receivers (planar shadows).
    Flattened(FlattenedShadow, LightPassResult),
}

/// The shadow volume faces of a light that were counted at a pixel, with the resulting count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CountedFaces {
    /// Where faces count: in front of the surface, as they pass the depth test; or on it and behind it, as they fail.
    pub side: CountedSide,
    /// The faces that counted.
    pub faces: FaceCounts,
    /// The value that the count was cleared to: 0, or the number of volumes around the eye.
    pub cleared_to: i32,
    /// Number of volumes that contain the near plane at this pixel; `None` where that was not counted.
    pub near: Option<i32>,
    /// The sum of the clear value, the near plane's volumes and all faces, as if the count had no limits.
    pub sum: i32,
    /// The bits of the stencil that the sum is stored in.
    pub bits: CountBits,
    /// The count as it is stored and the light pass reads it.
    pub count: VolumeCount,
}

impl CountedFaces {
    /// Returns whether the light pass reads the count as 0: no volume contains the surface.
    fn is_zero(&self) -> bool {
        match self.count {
            VolumeCount::Stencil(count) => i32::from(count) % self.bits.modulus() == 0,
            VolumeCount::Float(count) => count == 0.0,
        }
    }
}

/// Numbers of volume faces that counted, by the side that is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FaceCounts {
    /// Faces whose volume is seen from outside.
    pub front: u32,
    /// Faces whose volume is seen from inside.
    pub back: u32,
    /// Number of faces, of both sides, that lie on the surface itself.
    pub on_surface: u32,
    /// Number of faces, of both sides, whose step was lost, as the count was at its limit.
    pub stopped: u32,
}

/// A count of shadow volumes as it is stored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VolumeCount {
    /// In the stencil: a byte.
    Stencil(u8),
    /// In a float target, signed.
    Float(f32),
}

/// The flattened triangles of a light that cover a pixel, by outcome.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FlattenedShadow {
    /// Names of the casters whose flattened triangles passed all tests here.
    pub casters: Vec<String>,
    /// Number of triangles that failed the stencil test.
    pub failed_stencil: u32,
    /// Number of triangles that failed the depth test.
    pub failed_depth: u32,
    /// Number of triangles that left no fragment.
    pub hidden: u32,
    /// Whether the pixel has the stencil mark of a receiver.
    pub is_marked: bool,
}

/// What a light pass did at a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LightPassResult {
    /// It added the light.
    Adds,
    /// Its test passed, but the light is off, or black.
    AddsNothing,
    /// Its test failed, so that it added nothing.
    Skips,
    /// Nothing blocked the light, but it adds none: the surface faces away from it or is beyond its range.
    FacesAway,
    /// It added the light without a test, as the object receives no shadows.
    AsksNothing,
    /// It took the light away, which was added before.
    Darkens,
    /// Its test failed, so that it took nothing away.
    LeavesLit,
    /// It drew the colour of what is in shadow, which another of its draws has for what is lit.
    DrawsShadow,
}

impl PixelHistory {
    /// Returns what decided whether a light is added at this pixel: the count of its volumes, else flattened shadows.
    /// `None` where the light has no volume draws and no flattened triangle covers the pixel, as with shadow maps.
    pub fn why(&self, light: usize) -> Option<LightDecision> {
        let of_light = |event: &&PixelEvent| event.light == Some(light) && !event.target.is_beside();
        let events = || self.events.iter().filter(of_light);
        let flattened: Vec<&PixelEvent> =
            events().filter(|event| part(event) == Some(DrawPart::PlanarShadow)).collect();
        let bits = self.counts_in.get(light).copied().flatten();
        if bits.is_none() && flattened.is_empty() {
            return None;
        }
        let label = self.labels.get(light).copied().flatten();
        if label == Some(BACKGROUND) {
            return Some(LightDecision::Background);
        }
        let counted = bits.map(|bits| self.counted(light, bits));
        let pass = match self.light_pass(light, counted.as_ref()) {
            LightPassResult::Adds if label == Some(FACES_AWAY) => LightPassResult::FacesAway,
            LightPassResult::Adds if label == Some(SHADOW) && self.replaces.get(light) == Some(&true) => {
                LightPassResult::DrawsShadow
            }
            // What adds nothing may not be drawn at all.
            LightPassResult::Skips
                if label == Some(FACES_AWAY) && counted.as_ref().is_some_and(CountedFaces::is_zero) =>
            {
                LightPassResult::FacesAway
            }
            LightPassResult::Adds if self.is_off.get(light) == Some(&true) => LightPassResult::AddsNothing,
            pass => pass,
        };
        Some(match counted {
            Some(counted) => LightDecision::Counted(counted, pass),
            None => LightDecision::Flattened(flattened_of(&flattened), pass),
        })
    }

    fn counted(&self, light: usize, bits: CountBits) -> CountedFaces {
        let faces = || self.events.iter().filter(|event| event.light == Some(light) && event.is_of_volume());
        let mut counted = FaceCounts::default();
        for event in faces().filter(|event| event.is_from_camera && event.step() != 0) {
            let Some(one) = event.triangle() else { continue };
            *(if one.shows_outside() { &mut counted.front } else { &mut counted.back }) += 1;
            counted.on_surface += u32::from(one.depth == event.before.depth);
            counted.stopped += u32::from(event.counted() == 0);
        }
        let near = faces().filter(|event| !event.is_from_camera);
        let cleared_to = self.cleared_to(light);
        CountedFaces {
            side: self.counted_side(light).unwrap_or(CountedSide::InFront),
            faces: counted,
            cleared_to,
            near: near.clone().next().map(|_| near.map(PixelEvent::counted).sum()),
            sum: cleared_to + faces().map(PixelEvent::counted).sum::<i32>(),
            bits,
            count: self.counted_at(light),
        }
    }

    /// Returns a light's count as its light pass tests it: in a float where any pass cleared a float count here, else
    /// the stencil's byte.
    pub(super) fn counted_at(&self, light: usize) -> VolumeCount {
        let in_float = self.events.iter().any(|event| event.kind == PixelEventKind::ClearCount);
        let values = self.tested_count(light);
        if in_float { VolumeCount::Float(values.count) } else { VolumeCount::Stencil(values.stencil) }
    }

    fn light_pass(&self, light: usize, counted: Option<&CountedFaces>) -> LightPassResult {
        let lit = self.triangles().find(|(event, one)| {
            event.light == Some(light)
                && one.lights.is_some()
                && event.target == FrameTarget::Picture
                && one.outcome.passed()
        });
        if self.darkens.get(light) == Some(&true) {
            return if lit.is_some() { LightPassResult::Darkens } else { LightPassResult::LeavesLit };
        }
        match lit.map(|(_, one)| (one.lights, one.outcome)) {
            None => LightPassResult::Skips,
            Some((Some(Visibility::Count), _)) => match counted.map(|counted| counted.count) {
                Some(VolumeCount::Float(count)) if count != 0.0 => LightPassResult::Skips,
                _ => LightPassResult::Adds,
            },
            // Where shadows are counted, what receives them is tested.
            Some((Some(Visibility::Everywhere), FragmentOutcome::Tested { operation: None, .. }))
                if counted.is_some() =>
            {
                LightPassResult::AsksNothing
            }
            Some(_) => LightPassResult::Adds,
        }
    }
}

fn part(event: &PixelEvent) -> Option<DrawPart> {
    event.triangle().map(|one| one.part)
}

fn flattened_of(events: &[&PixelEvent]) -> FlattenedShadow {
    let mut found = FlattenedShadow {
        is_marked: events.first().is_some_and(|event| event.before.stencil != 0),
        ..FlattenedShadow::default()
    };
    let mut casters = BTreeSet::new();
    for TriangleEvent { caster, draw_name, outcome, .. } in events.iter().filter_map(|event| event.triangle()) {
        match outcome {
            _ if outcome.passed() => {
                casters.insert(caster.clone().unwrap_or_else(|| draw_name.clone()));
            }
            FragmentOutcome::Tested { stencil: TestResult::Failed, .. } => found.failed_stencil += 1,
            FragmentOutcome::Tested { .. } => found.failed_depth += 1,
            FragmentOutcome::Discarded(_) | FragmentOutcome::Culled | FragmentOutcome::Clipped(_) => found.hidden += 1,
        }
    }
    found.casters = casters.into_iter().collect();
    found
}

impl fmt::Display for LightDecision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LightDecision::Background => f.write_str("no surface is here that a shadow could fall on"),
            LightDecision::Counted(counted, pass) => write!(f, "{counted}, so {pass}"),
            LightDecision::Flattened(flattened, pass) => {
                write!(f, "{flattened}")?;
                match (flattened.casters.is_empty(), pass) {
                    (false, LightPassResult::Adds | LightPassResult::AddsNothing) => {
                        f.write_str(", and darkens it after the light pass")
                    }
                    _ => write!(f, ", so {pass}"),
                }
            }
        }
    }
}

impl fmt::Display for CountedFaces {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let CountedFaces { side, faces, cleared_to, near, sum, bits, count } = self;
        if *cleared_to != 0 {
            write!(f, "the count begins at {cleared_to}; ")?;
        }
        if let Some(near) = near {
            // More back than front faces in front of the near plane leave less than none.
            let sign = if *near < 0 { "−" } else { "" };
            write!(f, "the near plane is in {sign}{}; ", amount(near.unsigned_abs(), "volume"))?;
        }
        let all = faces.front + faces.back;
        let where_ = match (side, faces.on_surface) {
            (CountedSide::Behind, 1..) => "on or behind".to_owned(),
            (side, _) => side.preposition().to_owned(),
        };
        let verb = match (count, side, all) {
            // A float is counted by draws whose depth tests are reversed.
            (VolumeCount::Float(_), _, 1) => "is counted",
            (VolumeCount::Float(_), ..) => "are counted",
            (VolumeCount::Stencil(_), CountedSide::Behind, 1) => "fails the depth test",
            (VolumeCount::Stencil(_), CountedSide::Behind, _) => "fail the depth test",
            (VolumeCount::Stencil(_), CountedSide::InFront, 1) => "passes the depth test",
            (VolumeCount::Stencil(_), CountedSide::InFront, _) => "pass the depth test",
            (VolumeCount::Stencil(_), CountedSide::AsNeeded, _) => "count as their volumes need it",
        };
        let FaceCounts { front, back, .. } = faces;
        let faces_there = format!("{} {where_} the surface {verb}", amount(all, "volume face"));
        match (all, side) {
            (0, _) => f.write_str("no volume face on the view ray counts")?,
            (_, CountedSide::Behind) => write!(f, "{faces_there}: {back} back, {front} front")?,
            (_, CountedSide::InFront | CountedSide::AsNeeded) => {
                write!(f, "{faces_there}: {front} front, {back} back")?
            }
        }
        if faces.stopped > 0 {
            write!(
                f,
                ", of which {} the count at its limit",
                if faces.stopped == 1 { "1 found".to_owned() } else { format!("{} found", faces.stopped) }
            )?;
        }
        match count {
            VolumeCount::Stencil(byte) if bits.hold_otherwise(*sum, *byte) => {
                let sign = if *sum < 0 { "−" } else { "" };
                let verb = if bits.modulus() == 2 { "holds" } else { "hold" };
                write!(f, "; together {sign}{}, which {bits} {verb} as {byte}", sum.unsigned_abs())
            }
            VolumeCount::Stencil(byte) if *sum > 127 => write!(f, "; count {byte}"),
            count => write!(f, "; count {count}"),
        }
    }
}

impl VolumeCount {
    /// Returns whether the stored count is exactly 0, which the light pass takes for lit.
    pub fn is_zero(self) -> bool {
        matches!(self, VolumeCount::Stencil(0)) || self == VolumeCount::Float(0.0)
    }
}

impl fmt::Display for VolumeCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            VolumeCount::Stencil(count) => f.write_str(&numbers::signed(*count)),
            VolumeCount::Float(count) => f.write_str(&numbers::count_in_float(*count)),
        }
    }
}

impl fmt::Display for FlattenedShadow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let FlattenedShadow { casters, failed_stencil, failed_depth, hidden, is_marked } = self;
        if !casters.is_empty() {
            return write!(f, "the flattened shadow of {} falls on the surface here", casters.join(" and "));
        }
        if *failed_depth > 0 {
            let what = amount(*failed_depth, "flattened triangle");
            let verb = if *failed_depth == 1 { "fails" } else { "fail" };
            return write!(f, "{what} over the surface {verb} the depth test against it");
        }
        if *failed_stencil > 0 {
            let what = amount(*failed_stencil, "flattened triangle");
            let verb = if *failed_stencil == 1 { "is" } else { "are" };
            let why = match is_marked {
                true => "of another receiver: this surface has a mark of its own",
                false => "over the surface, which is no receiver",
            };
            return write!(f, "{what} {verb} {why}, and the stencil test keeps shadow off it");
        }
        write!(f, "{} over it left no fragment", amount(*hidden, "flattened triangle"))
    }
}

impl fmt::Display for LightPassResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            LightPassResult::Adds => "the light pass adds the light",
            LightPassResult::AddsNothing => "the light pass would add the light, but it is off, or black",
            LightPassResult::Skips => "the light pass skips it",
            LightPassResult::FacesAway => {
                "nothing keeps the light out; but it faces away from the light or is beyond its range, and stays dark"
            }
            LightPassResult::Darkens => "the darkening pass takes the light away",
            LightPassResult::LeavesLit => "the darkening pass leaves the pixel lit",
            LightPassResult::DrawsShadow => "the light pass draws it as what is in shadow",
            LightPassResult::AsksNothing => {
                "it would be lit only at 0; but the object receives no shadows, and the light pass adds the light"
            }
        })
    }
}

fn amount(count: u32, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(faces: FaceCounts, near: Option<i32>, sum: i32, count: VolumeCount) -> CountedFaces {
        let side = if near.is_none() { CountedSide::Behind } else { CountedSide::InFront };
        CountedFaces { side, faces, cleared_to: 0, near, sum, bits: CountBits::EIGHT, count }
    }

    #[test]
    fn a_near_plane_that_more_volumes_were_left_than_entered_has_a_sign() {
        let faces = FaceCounts { front: 2, ..FaceCounts::default() };
        let why = LightDecision::Counted(counted(faces, Some(-1), 1, VolumeCount::Stencil(1)), LightPassResult::Skips);
        assert_eq!(
            why.to_string(),
            "the near plane is in −1 volume; 2 volume faces in front of the surface pass the depth test: 2 front, 0 \
             back; count 1, so the light pass skips it"
        );
    }

    #[test]
    fn a_count_beyond_eight_bits_says_what_they_hold() {
        let faces = FaceCounts { back: 257, front: 1, on_surface: 1, stopped: 0 };
        let text = counted(faces, None, 256, VolumeCount::Stencil(0)).to_string();
        assert_eq!(
            text,
            "258 volume faces on or behind the surface fail the depth test: 257 back, 1 front; together 256, which \
             eight bits hold as 0"
        );
    }

    #[test]
    fn a_clamped_face_is_counted_and_said_to_have_been_lost() {
        let faces = FaceCounts { back: 1, front: 2, on_surface: 0, stopped: 1 };
        let text = counted(faces, None, 0, VolumeCount::Stencil(0)).to_string();
        assert!(text.contains("1 back, 2 front, of which 1 found the count at its limit; count 0"), "{text}");
    }

    #[test]
    fn a_flattened_triangle_that_fails_says_which_test() {
        let marked =
            FlattenedShadow { failed_depth: 2, failed_stencil: 7, is_marked: true, ..FlattenedShadow::default() };
        assert_eq!(marked.to_string(), "2 flattened triangles over the surface fail the depth test against it");
        let elsewhere = FlattenedShadow { failed_depth: 0, failed_stencil: 1, is_marked: false, ..marked.clone() };
        let expected =
            "1 flattened triangle is over the surface, which is no receiver, and the stencil test keeps shadow off it";
        assert_eq!(elsewhere.to_string(), expected);
        let of_another = FlattenedShadow { failed_depth: 0, ..marked };
        let expected = "7 flattened triangles are of another receiver: this surface has a mark of its own, and the \
                        stencil test keeps shadow off it";
        assert_eq!(of_another.to_string(), expected);
    }
}

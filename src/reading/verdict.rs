//! One sentence about the picked pixel, from what the capture holds and no more.
//!
//! It tells what a light's label is and why, as far as labels, stencil and technique say so; it
//! claims nothing about geometry, which the capture does not know.

use crate::capture::{Capture, FrameSnapshot, FrameTarget, Snapshot};
use crate::geometry::Extrusion;
use crate::history::PixelHistory;
use crate::plan::{CountBits, DecidedBy, Side};
use crate::reading::counts;
use crate::reading::format;
use crate::reading::map_decision::MapDecision;
use crate::technique::{CountsBy, VolumeSettings};
use crate::truth::{BACKGROUND, FACES_AWAY, LIT};

/// A sentence with what stands behind it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Verdict {
    /// The answer.
    pub title: String,
    /// Where it comes from.
    pub reason: String,
    /// What the reason that a history gives does to this one.
    by_history: ByHistory,
}

/// What is known beside the capture: a history knows the faces themselves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ByHistory {
    /// It says the same, with numbers.
    Replaced,
    /// It says what comes before.
    Preceded,
    /// It is about something else.
    Kept,
    /// A map decided, of which it says nothing.
    Map,
}

/// The verdict with the reason that the pixel's history gives.
pub fn explained(verdict: Verdict, history: &PixelHistory, light: usize) -> Verdict {
    let why = match history.why(light) {
        Some(why) => format!("{}.", capitalized(&why.to_string())),
        None => return verdict,
    };
    let reason = match verdict.by_history {
        ByHistory::Replaced => why,
        ByHistory::Preceded => format!("{why} {}", verdict.reason),
        ByHistory::Kept | ByHistory::Map => return verdict,
    };
    Verdict { reason, ..verdict }
}

/// The verdict of a light with what its shadow map stores, where that decided it; what another light's stores says nothing.
pub fn by_map(verdict: Verdict, decision: &MapDecision, light: usize) -> Verdict {
    match verdict.by_history {
        ByHistory::Map if decision.light == light => Verdict { reason: decision.sentence(), ..verdict },
        _ => verdict,
    }
}

/// What happened at pixel `at` under `light`.
pub fn verdict(capture: &Capture, light: usize, at: [u32; 2]) -> Verdict {
    let label = capture.lights.get(light).and_then(|light| light.shadow.as_ref()?.byte_at(at));
    let name = format::light(light);
    match label {
        None => Verdict {
            title: "No light was asked about this pixel.".to_owned(),
            reason: "The capture holds no mask, so only the values below are known.".to_owned(),
            by_history: ByHistory::Kept,
        },
        Some(BACKGROUND) => Verdict {
            title: "Background: no surface is at this pixel.".to_owned(),
            reason: "Nothing was drawn here, so there is nothing that a shadow could fall on.".to_owned(),
            by_history: ByHistory::Kept,
        },
        Some(FACES_AWAY) => Verdict {
            title: format!("Turned away from {name}."),
            reason: match capture.settings.get("diffuse").is_some_and(|how| how == "wrapped") {
                false => format!(
                    "{} shines on the other side of this surface, so shading alone leaves it dark.{}",
                    capitalized(&name),
                    count_note(capture, light, at)
                ),
                true => format!(
                    "{} shines on the other side of this surface; wrapped, it reaches round to here unless a shadow keeps \
                     it away.{}",
                    capitalized(&name),
                    count_note(capture, light, at)
                ),
            },
            by_history: ByHistory::Kept,
        },
        Some(label) => decided(capture, light, at, label != LIT),
    }
}

fn decided(capture: &Capture, light: usize, at: [u32; 2], is_dark: bool) -> Verdict {
    let name = format::light(light);
    let title = if is_dark { format!("Dark under {name}") } else { format!("Lit by {name}") };
    if let DecidedBy::StencilCount { side } | DecidedBy::FloatCount { side } = capture.decided_by(light) {
        return counted(capture, light, at, (is_dark, side), &title);
    }
    let reason = reason(capture.decided_by(light), is_dark);
    let by_history = if capture.decided_by(light) == DecidedBy::Map { ByHistory::Map } else { ByHistory::Replaced };
    Verdict { title: format!("{title}."), reason: reason.to_owned(), by_history }
}

/// Why a light is dark or not, as far as what decides about it tells; of counts no more than that they decided.
pub fn reason(decided_by: DecidedBy, is_dark: bool) -> &'static str {
    match (decided_by, is_dark) {
        (DecidedBy::StencilCount { .. } | DecidedBy::FloatCount { .. }, true) => {
            "More volumes are counted at the surface than none, so the light pass skips this pixel."
        }
        (DecidedBy::StencilCount { .. } | DecidedBy::FloatCount { .. }, false) => {
            "No volume is counted at the surface, so the light pass adds the light."
        }
        (DecidedBy::Map, true) => {
            "The light's map holds something nearer to the light here, so the light pass adds nothing."
        }
        (DecidedBy::Map, false) => "The light's map holds nothing nearer to the light here, so the light pass adds it.",
        (DecidedBy::Flattened, true) => "A caster, flattened onto this flat receiver from the light, covers the pixel.",
        (DecidedBy::Flattened, false) => {
            "No flattened caster covers the pixel. Planar shadows fall on flat receivers only, so nothing else is asked."
        }
        (DecidedBy::ReceiverTextures, true) => {
            "The texture of this flat receiver lets less than half of the light through here: a caster between it and \
             the light was drawn there."
        }
        (DecidedBy::ReceiverTextures, false) => {
            "No caster was drawn here into this receiver's texture. Surfaces that are not flat have none, and are lit."
        }
        (DecidedBy::Silhouettes, true) => {
            "The silhouette of another object falls here. Nobody asks whether that object is nearer to the light, and \
             translucent ones count as opaque for the mask."
        }
        (DecidedBy::Silhouettes, false) => {
            "No silhouette of another object falls here; an object's own is never asked."
        }
        (DecidedBy::Nothing, false) => {
            "No shadow of this light is made in this frame: it reaches every surface that faces it."
        }
        (DecidedBy::Labels | DecidedBy::Nothing, true) => {
            "The technique's mask says that something lies between the surface and the light."
        }
        (DecidedBy::Labels, false) => "The technique's mask says that nothing lies between the surface and the light.",
    }
}

/// Shadow volumes: the count that the light pass tested.
fn counted(capture: &Capture, light: usize, at: [u32; 2], (is_dark, side): (bool, Side), title: &str) -> Verdict {
    let in_float = capture.lights.get(light).and_then(|light| light.count.as_ref()?.count_at(at));
    let decides = capture.decided_by(light).counts_in_floats();
    if let Some(count) = in_float.filter(|_| decides) {
        return counted_in_float(counters(capture, light, side), count, is_dark, title);
    }
    let Some(count) = tested_count(capture, light, at) else {
        return Verdict {
            title: format!("{title}."),
            reason: "The count that decided it was not captured.".to_owned(),
            by_history: ByHistory::Replaced,
        };
    };
    let settings = VolumeSettings::read(&capture.settings);
    let shown = crate::numbers::signed(count);
    let title = format!("{title}: its stencil count is {shown}.");
    let counters = counters(capture, light, side);
    let side = side.preposition();
    let bits = CountBits::of_mask(settings.mask().into());
    let inverts = settings.operations == CountsBy::Inverting;
    let reason = match (is_dark, count) {
        (true, 1..) if inverts && counters.begins => {
            format!("{} leave its bit at 1, so the light pass skips this pixel.", counters.sum)
        }
        (true, 1..) if inverts => format!(
            "An odd number of volume faces {side} the surface turned its bit over, so the light pass skips this pixel."
        ),
        (true, 1..) if bits != CountBits::EIGHT => {
            format!("{} leave {shown} in {bits}, not 0, so the light pass skips this pixel.", counters.sum)
        }
        (true, 1..=127) => format!("{} leave {shown}, not 0, so the light pass skips this pixel.", counters.sum),
        (true, 128..) => format!(
            "More volumes were left than entered {side} the surface. Not 0 is all that the light pass asks, so it skips \
             this pixel."
        ),
        (false, 0) if in_float.is_some_and(|count| count != 0.0) => {
            let count = in_float.unwrap_or_default();
            let verb = if bits.modulus() == 2 { "reads" } else { "read" };
            format!("{count} volumes contain the surface, which {bits} {verb} as 0: the light pass adds the light.")
        }
        (false, 0) if inverts && counters.begins => {
            format!("{} leave its bit at 0, so the light pass adds the light.", counters.sum)
        }
        (false, 0) if inverts => format!(
            "An even number of volume faces {side} the surface, or none, turned its bit over, so the light pass adds \
             the light."
        ),
        (false, 0) => counters.cancel_out(),
        // Label and count disagree: say so, and do not explain it away.
        (_, count) => format!("The mask does not match the count {count} that the light pass tested."),
    };
    let by_history = match (is_dark, count) {
        (true, 1..) if inverts || bits != CountBits::EIGHT => ByHistory::Replaced,
        (true, 1..=127) => ByHistory::Replaced,
        (false, 0) if in_float.is_none_or(|count| count == 0.0) => ByHistory::Replaced,
        (true, 128..) | (false, 0) => ByHistory::Preceded,
        _ => ByHistory::Kept,
    };
    Verdict { title, reason, by_history }
}

/// What a count is the sum of, as the beginning of a sentence.
struct Counters {
    /// The count may begin at another number than 0.
    begins: bool,
    /// What is summed.
    sum: String,
    side: &'static str,
}

/// Parallel lines of sight begin in the volumes that they end in at infinity.
fn counters(capture: &Capture, light: usize, side: Side) -> Counters {
    let settings = VolumeSettings::read(&capture.settings);
    let is_point = capture.lights.get(light).is_some_and(|light| light.position.w != 0.0);
    let lacks_caps = settings.extrusion == Extrusion::Infinite && settings.caps[1];
    let begins_at_infinity = capture.camera.is_parallel() && is_point && side != Side::InFront && lacks_caps;
    let begins = begins_at_infinity || settings.starts_at_eye;
    let began = if begins { "What the count began with and the" } else { "The" };
    let side = side.preposition();
    Counters { begins, sum: format!("{began} volume faces {side} the surface"), side }
}

impl Counters {
    fn cancel_out(&self) -> String {
        format!("{} cancel out, so the light pass adds the light.", self.sum)
    }
}

/// A count that is kept in a float has a sign, and no limits.
fn counted_in_float(counters: Counters, count: f32, is_dark: bool, title: &str) -> Verdict {
    let Counters { sum, side, .. } = &counters;
    let shown = counts::text(count);
    let title = format!("{title}: its count is {shown}.");
    let reason = match is_dark {
        true if counts::reads_zero_in_eight_bits(count) => format!(
            "{sum} leave {shown}, so the light pass adds nothing. Eight bits would read 0 and light this pixel."
        ),
        true if count > 0.0 => {
            format!("{sum} leave {shown}, not 0, so the light pass adds nothing.")
        }
        true if count < 0.0 => format!(
            "More volumes were left than entered {side} the surface. Not 0 is all that the light pass asks, so it adds \
             nothing."
        ),
        false if count == 0.0 => counters.cancel_out(),
        // Label and count disagree: say so, and do not explain it away.
        _ => format!("The mask does not match the count {shown} that the light pass read."),
    };
    let by_history = match is_dark {
        true if counts::reads_zero_in_eight_bits(count) || count < 0.0 => ByHistory::Preceded,
        _ if is_dark == (count != 0.0) => ByHistory::Replaced,
        _ => ByHistory::Kept,
    };
    Verdict { title, reason, by_history }
}

fn count_note(capture: &Capture, light: usize, at: [u32; 2]) -> String {
    if !capture.decided_by(light).counts_volumes() {
        return String::new();
    }
    let in_float = capture.lights.get(light).and_then(|light| light.count.as_ref()?.count_at(at)).map(counts::text);
    let count = in_float.or_else(|| tested_count(capture, light, at).map(crate::numbers::signed));
    count.map_or_else(String::new, |count| format!(" Its count is {count}."))
}

/// The stencil value at `at` when the labels of `light` were decided.
pub fn tested_count(capture: &Capture, light: usize, at: [u32; 2]) -> Option<u8> {
    let is_mask = |step: &&crate::capture::Step| {
        step.light == Some(light)
            && matches!(&step.snapshot, Snapshot::Frame(frame) if frame.target == FrameTarget::Labels)
    };
    let mask = capture.steps.iter().find(is_mask)?;
    let Snapshot::Frame(FrameSnapshot { stencil: Some(stencil), .. }) = &mask.snapshot else { return None };
    stencil.image.byte_at(at)
}

fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

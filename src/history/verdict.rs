//! Why a pixel is dark or lit under a light: its label with the evidence for it, and the one place that words both.
//!
//! The mask of a capture has the label. The evidence is as much as is known: what decides about the light, the count
//! that its light pass tested, or, where the pixel's history is known, the faces that made that count
//! ([`LightDecision`]). A verdict claims nothing about geometry that neither the capture nor the history contains.

use super::{LightDecision, LightPassResult, PixelHistory, VolumeCount};
use crate::capture::{Capture, FrameSnapshot, FrameTarget, Snapshot, Step};
use crate::geometry::Extrusion;
use crate::numbers;
use crate::plan::{CountBits, CountedSide, DecidedBy};
use crate::technique::{CountOperations, VolumeSettings};
use crate::truth::PixelLabel::{self, Background, FacesAway, Lit, Shadow};

/// What a light's mask says of a pixel (lit, in shadow, facing away, background), and the evidence for why. It is what
/// the technique decided, not the ray-traced truth.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// Index of the light.
    pub light: usize,
    /// The technique's label in the light's mask; `None` where the capture has no mask.
    pub label: Option<PixelLabel>,
    /// The count of shadow volumes that the light pass tested; `None` where there was none, or it was not captured.
    pub count: Option<VolumeCount>,
    /// The evidence for the label.
    pub evidence: VerdictEvidence,
}

/// The evidence for a label, as far as it is known.
#[derive(Debug, Clone, PartialEq)]
pub enum VerdictEvidence {
    /// Nothing beyond the label itself.
    Label,
    /// Shading alone leaves the surface dark; where it is wrapped, some light reaches round to it.
    Shading {
        /// Whether diffuse light is wrapped, so that some reaches surfaces that face away.
        wraps: bool,
    },
    /// Only the kind of data that the light pass reads.
    Decision(DecidedBy),
    /// A count decided that was not captured.
    NoCount,
    /// The count that the light pass tested.
    Count(TestedCount),
    /// The events of the pixel's history, with the tested count where that needs words of its own.
    History(LightDecision, Option<TestedCount>),
    /// A sentence on what the texels of a shadow map store.
    Texels(String),
}

/// The count that a light pass tested, with how it was made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TestedCount {
    /// The count.
    pub count: VolumeCount,
    /// The side of the surface on which faces were counted.
    pub side: CountedSide,
    /// The bits of the stencil that are counted in.
    pub bits: CountBits,
    /// Whether each face inverts one bit of the stencil (parity).
    pub inverts: bool,
    /// Whether the count may begin at another number than 0: parallel view rays end in volumes at infinity, and z-pass
    /// may begin with the volumes around the eye.
    pub begins_elsewhere: bool,
    /// The number of volumes around the surface from a float count, where the light pass tested the stencil; `None`
    /// where there is no such count.
    pub in_float: Option<f32>,
    /// Whether the pass takes the light away where its test passes, instead of adding it.
    pub darkens: bool,
}

impl Verdict {
    /// Returns the verdict for a light at pixel `at` (column, row) from the capture alone, without a history. Without a
    /// mask there, its label is `None`; a byte that is no label counts as in shadow.
    pub fn of(capture: &Capture, light: usize, at: [u32; 2]) -> Verdict {
        let captured = capture.lights.get(light);
        let label = captured.and_then(|light| light.shadow.as_ref()?.byte_at(at));
        let label = label.map(|byte| PixelLabel::from_byte(byte).unwrap_or(Shadow));
        let decided_by = capture.decided_by(light);
        let in_float = captured.and_then(|light| light.count.as_ref()?.value_at(at));
        let in_stencil = || tested_stencil(capture, light, at).map(VolumeCount::Stencil);
        let count = match (label, decided_by.counted_side()) {
            (None | Some(Background), _) | (_, None) => None,
            (Some(FacesAway), _) => in_float.map(VolumeCount::Float).or_else(in_stencil),
            (Some(Shadow | Lit), _) => {
                in_float.filter(|_| decided_by.counts_in_floats()).map(VolumeCount::Float).or_else(in_stencil)
            }
        };
        let evidence = match (label, decided_by.counted_side(), count) {
            (None | Some(Background), ..) => VerdictEvidence::Label,
            (Some(FacesAway), ..) => {
                VerdictEvidence::Shading { wraps: capture.settings.get("diffuse").is_some_and(|how| how == "wrapped") }
            }
            (_, None, _) => VerdictEvidence::Decision(decided_by),
            (_, Some(_), None) => VerdictEvidence::NoCount,
            (_, Some(side), Some(count)) => {
                VerdictEvidence::Count(TestedCount::new(capture, light, side, count, in_float))
            }
        };
        Verdict { light, label, count, evidence }
    }

    /// Returns the verdict with what the pixel's history says as its evidence. Unchanged where the history has nothing
    /// to say about the light, the mask contradicts the tested count, a shadow map decides, or the surface faces away
    /// or is background.
    pub fn with_history(mut self, history: &PixelHistory) -> Verdict {
        let Some(why) = history.why(self.light) else { return self };
        let is_dark = self.label == Some(Shadow);
        self.evidence = match self.evidence {
            // A history that does not fit the mask explains nothing.
            VerdictEvidence::Count(tested) if tested.contradicts(is_dark) => VerdictEvidence::Count(tested),
            VerdictEvidence::Count(tested) => {
                VerdictEvidence::History(why, tested.needs_words(is_dark).then_some(tested))
            }
            VerdictEvidence::NoCount => VerdictEvidence::History(why, None),
            // A map decides outside of the pixel's own history.
            VerdictEvidence::Decision(decided_by) if decided_by != DecidedBy::Map => {
                VerdictEvidence::History(why, None)
            }
            other => other,
        };
        self
    }

    /// Returns the verdict with `sentence` as its evidence, if `light` is the verdict's light and its evidence so far
    /// is only that a shadow map decides; otherwise unchanged, and `sentence` is not called.
    pub fn with_texels(mut self, light: usize, sentence: impl FnOnce() -> String) -> Verdict {
        if self.light == light && self.evidence == VerdictEvidence::Decision(DecidedBy::Map) {
            self.evidence = VerdictEvidence::Texels(sentence());
        }
        self
    }

    /// Returns a sentence with the label, for a lit or dark pixel also with the count that decided it, where there is
    /// one. Without a label it says that no light was asked.
    pub fn title(&self) -> String {
        match (self.subject(), self.count) {
            (Err(whole), _) => whole,
            (Ok(title), None) => format!("{title}."),
            (Ok(title), Some(VolumeCount::Stencil(count))) => {
                format!("{title}: its stencil count is {}.", numbers::signed(count))
            }
            (Ok(title), Some(VolumeCount::Float(count))) => {
                format!("{title}: its count is {}.", numbers::count_in_float(count))
            }
        }
    }

    /// Returns whether the technique's label is that something lies between the surface and the light.
    pub fn is_in_shadow(&self) -> bool {
        self.label == Some(Shadow)
    }

    /// Returns how the title of a lit or dark pixel begins; as an error the whole title where no count can follow.
    pub fn subject(&self) -> Result<String, String> {
        let name = numbers::light(self.light);
        match self.label {
            None => Err("No light was asked about this pixel.".to_owned()),
            Some(Background) => Err("Background: no surface is at this pixel.".to_owned()),
            Some(FacesAway) => Err(format!("Turned away from {name}.")),
            Some(Shadow) => Ok(format!("Dark under {name}")),
            Some(Lit) => Ok(format!("Lit by {name}")),
        }
    }

    /// Returns the evidence in one or a few sentences.
    pub fn reason(&self) -> String {
        let is_dark = self.label == Some(Shadow);
        match &self.evidence {
            VerdictEvidence::Label if self.label == Some(Background) => {
                "Nothing was drawn here, so there is nothing that a shadow could fall on.".to_owned()
            }
            VerdictEvidence::Label => "The capture holds no mask, so only the values below are known.".to_owned(),
            VerdictEvidence::Shading { wraps } => {
                let name = capitalized(&numbers::light(self.light));
                let follows = match wraps {
                    false => ", so shading alone leaves it dark.",
                    true => "; wrapped, it reaches round to here unless a shadow keeps it away.",
                };
                let count = self.count.map_or_else(String::new, |count| format!(" Its count is {count}."));
                format!("{name} shines on the other side of this surface{follows}{count}")
            }
            VerdictEvidence::Decision(decided_by) => reason(*decided_by, is_dark).to_owned(),
            VerdictEvidence::NoCount => "The count that decided it was not captured.".to_owned(),
            VerdictEvidence::Count(tested) => tested.reason(is_dark),
            VerdictEvidence::History(why, None) => format!("{}.", capitalized(&why.to_string())),
            VerdictEvidence::History(why, Some(tested)) => {
                format!("{}. {}", capitalized(&why.to_string()), tested.reason(is_dark))
            }
            VerdictEvidence::Texels(sentence) => sentence.clone(),
        }
    }
}

impl TestedCount {
    fn new(
        capture: &Capture,
        light: usize,
        side: CountedSide,
        count: VolumeCount,
        in_float: Option<f32>,
    ) -> TestedCount {
        let settings = VolumeSettings::read(&capture.settings);
        let is_point = capture.lights.get(light).is_some_and(|light| light.position.w != 0.0);
        let lacks_caps = settings.extrusion == Extrusion::Infinite && settings.caps[1];
        let begins_at_infinity = capture.camera.is_parallel() && is_point && side != CountedSide::InFront && lacks_caps;
        let in_stencil = matches!(count, VolumeCount::Stencil(_));
        TestedCount {
            count,
            side,
            bits: CountBits::of_mask(settings.mask().into()),
            inverts: in_stencil && settings.operations == CountOperations::Inverting,
            begins_elsewhere: begins_at_infinity || settings.starts_at_eye,
            in_float: in_float.filter(|_| in_stencil),
            darkens: capture.steps.iter().any(|step| step.light == Some(light) && step.darkens()),
        }
    }

    /// Returns whether the label (dark or lit) is not what this count leads to.
    pub fn contradicts(&self, is_dark: bool) -> bool {
        is_dark == self.count.is_zero()
    }

    /// Returns whether the count is below 0: a negative float, or a stencil byte above 127. Never for counts by
    /// inversion or in fewer than eight bits.
    pub fn is_negative(&self) -> bool {
        match self.count {
            VolumeCount::Stencil(count) => !self.inverts && self.bits == CountBits::EIGHT && count > 127,
            VolumeCount::Float(count) => count < 0.0,
        }
    }

    /// Returns the number of volumes, other than 0, that the stencil's bits read as 0, or eight bits would; `None`
    /// where the count reads right.
    pub fn reads_as_zero(&self) -> Option<f32> {
        match self.count {
            VolumeCount::Stencil(_) => self.in_float.filter(|count| *count != 0.0 && self.count.is_zero()),
            VolumeCount::Float(count) => Some(count).filter(|count| numbers::reads_zero_in_eight_bits(*count)),
        }
    }

    /// Returns whether a history's list of faces does not explain this count by itself.
    fn needs_words(&self, is_dark: bool) -> bool {
        (is_dark && self.is_negative()) || self.reads_as_zero().is_some()
    }

    /// Returns a sentence on why a light pass that tests this count adds the light or not; one that says so where the
    /// label (`is_dark`: in shadow) contradicts the count.
    fn reason(&self, is_dark: bool) -> String {
        let TestedCount { count, bits, .. } = self;
        let side = self.side.preposition();
        let began = if self.begins_elsewhere { "What the count began with and the" } else { "The" };
        let sum = format!("{began} volume faces {side} the surface");
        let skips = if matches!(count, VolumeCount::Stencil(_)) { "skips this pixel" } else { "adds nothing" };
        let does = match (is_dark, self.darkens) {
            (true, false) => format!("the light pass {skips}"),
            (false, false) => "the light pass adds the light".to_owned(),
            (is_dark, true) => if is_dark { LightPassResult::Darkens } else { LightPassResult::LeavesLit }.to_string(),
        };
        match (count, self.reads_as_zero()) {
            // Mask and count disagree: say so, and do not explain it away.
            (VolumeCount::Stencil(count), _) if self.contradicts(is_dark) => {
                format!("The mask does not match the count {count} that the light pass tested.")
            }
            (count, _) if self.contradicts(is_dark) => {
                format!("The mask does not match the count {count} that the light pass read.")
            }
            (VolumeCount::Stencil(_), Some(count)) => {
                let verb = if bits.modulus() == 2 { "reads" } else { "read" };
                format!("{count} volumes contain the surface, which {bits} {verb} as 0: {does}.")
            }
            _ if self.inverts && self.begins_elsewhere => {
                format!("{sum} leave its bit at {}, so {does}.", u8::from(is_dark))
            }
            _ if self.inverts => {
                let [parity, none] = if is_dark { ["An odd", ""] } else { ["An even", ", or none,"] };
                format!("{parity} number of volume faces {side} the surface{none} turned its bit over, so {does}.")
            }
            (count, Some(_)) => {
                format!("{sum} leave {count}, so {does}. Eight bits would read 0 and light this pixel.")
            }
            _ if self.is_negative() => format!(
                "More volumes were left than entered {side} the surface. The light pass only asks whether the count is 0: {}.",
                does.replacen("the light pass", "it", 1)
            ),
            (VolumeCount::Stencil(_), _) if is_dark && *bits != CountBits::EIGHT => {
                format!("{sum} leave {count} in {bits}, not 0, so {does}.")
            }
            _ if is_dark => format!("{sum} leave {count}, not 0, so {does}."),
            _ => format!("{sum} cancel out, so {does}."),
        }
    }
}

/// Returns a general sentence on why a pixel is dark or lit, by the kind of data that decides.
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
            "No flattened caster covers the pixel. Planar shadows fall on chosen flat receivers only, and nothing else is asked."
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

/// Returns the stencil value at pixel `at` when the labels of `light` were drawn; `None` where that was not captured.
fn tested_stencil(capture: &Capture, light: usize, at: [u32; 2]) -> Option<u8> {
    let is_mask = |step: &&Step| {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::history::{CountedFaces, FaceCounts};
    use VerdictEvidence::{Decision, History, Label, Shading};

    const IN_STENCIL: TestedCount = TestedCount {
        count: VolumeCount::Stencil(3),
        side: CountedSide::Behind,
        bits: CountBits::EIGHT,
        inverts: false,
        begins_elsewhere: false,
        in_float: None,
        darkens: false,
    };

    fn verdict(label: PixelLabel, count: Option<VolumeCount>, evidence: VerdictEvidence) -> Verdict {
        Verdict { light: 0, label: Some(label), count, evidence }
    }

    #[test]
    fn a_label_is_worded_with_the_count_that_the_light_pass_tested() {
        let titles = [
            (Background, None, "Background: no surface is at this pixel."),
            (FacesAway, Some(VolumeCount::Stencil(3)), "Turned away from light 1."),
            (Shadow, Some(VolumeCount::Stencil(255)), "Dark under light 1: its stencil count is −1 (255)."),
            (Lit, Some(VolumeCount::Stencil(0)), "Lit by light 1: its stencil count is 0."),
            (Shadow, Some(VolumeCount::Float(1256.0)), "Dark under light 1: its count is 1\u{a0}256."),
            (Lit, None, "Lit by light 1."),
        ];
        for (label, count, title) in titles {
            assert_eq!(verdict(label, count, Label).title(), title);
        }
    }

    #[test]
    fn evidence_that_is_no_count_is_worded() {
        let reasons = [
            (Background, None, Label, "Nothing was drawn here, so there is nothing that a shadow could fall on."),
            (
                FacesAway,
                Some(VolumeCount::Stencil(2)),
                Shading { wraps: false },
                "Light 1 shines on the other side of this surface, so shading alone leaves it dark. Its count is 2.",
            ),
            (
                FacesAway,
                None,
                Shading { wraps: true },
                "Light 1 shines on the other side of this surface; wrapped, it reaches round to here unless a shadow \
                 keeps it away.",
            ),
            (
                Shadow,
                None,
                Decision(DecidedBy::Map),
                "The light's map holds something nearer to the light here, so the light pass adds nothing.",
            ),
            (Lit, None, VerdictEvidence::NoCount, "The count that decided it was not captured."),
            (
                Lit,
                None,
                VerdictEvidence::Texels("Texel 1, 2 holds no caster.".to_owned()),
                "Texel 1, 2 holds no caster.",
            ),
        ];
        for (label, count, evidence, reason) in reasons {
            assert_eq!(verdict(label, count, evidence).reason(), reason);
        }
    }

    #[test]
    fn a_count_is_worded_by_what_it_is_the_sum_of() {
        let few = CountBits::of_mask(3);
        let float = |count| TestedCount { count: VolumeCount::Float(count), ..IN_STENCIL };
        let byte = |count| TestedCount { count: VolumeCount::Stencil(count), ..IN_STENCIL };
        let bit = |count| TestedCount { inverts: true, ..byte(count) };
        let elsewhere = |of| TestedCount { begins_elsewhere: true, ..of };
        let reasons = [
            (
                Shadow,
                byte(3),
                "The volume faces behind the surface leave 3, not 0, so the light pass skips this pixel.",
            ),
            (
                Shadow,
                TestedCount { bits: few, ..byte(3) },
                "The volume faces behind the surface leave 3 in two bits, not 0, so the light pass skips this pixel.",
            ),
            (
                Shadow,
                elsewhere(byte(3)),
                "What the count began with and the volume faces behind the surface leave 3, not 0, so the light pass \
                 skips this pixel.",
            ),
            (Shadow, float(2.0), "The volume faces behind the surface leave 2, not 0, so the light pass adds nothing."),
            (
                Shadow,
                float(256.0),
                "The volume faces behind the surface leave 256, so the light pass adds nothing. Eight bits would read 0 \
                 and light this pixel.",
            ),
            (
                Shadow,
                byte(254),
                "More volumes were left than entered behind the surface. The light pass only asks whether the count is 0: \
                 it skips this pixel.",
            ),
            (
                Shadow,
                float(-2.0),
                "More volumes were left than entered behind the surface. The light pass only asks whether the count is 0: \
                 it adds nothing.",
            ),
            (
                Shadow,
                bit(1),
                "An odd number of volume faces behind the surface turned its bit over, so the light pass skips this \
                 pixel.",
            ),
            (
                Lit,
                bit(0),
                "An even number of volume faces behind the surface, or none, turned its bit over, so the light pass adds \
                 the light.",
            ),
            (
                Lit,
                elsewhere(bit(0)),
                "What the count began with and the volume faces behind the surface leave its bit at 0, so the light pass \
                 adds the light.",
            ),
            (Lit, byte(0), "The volume faces behind the surface cancel out, so the light pass adds the light."),
            (
                Lit,
                TestedCount { in_float: Some(512.0), ..byte(0) },
                "512 volumes contain the surface, which eight bits read as 0: the light pass adds the light.",
            ),
            (Lit, byte(7), "The mask does not match the count 7 that the light pass tested."),
            (Shadow, float(0.0), "The mask does not match the count 0 that the light pass read."),
        ];
        for (label, tested, reason) in reasons {
            assert_eq!(verdict(label, Some(tested.count), VerdictEvidence::Count(tested)).reason(), reason);
        }
    }

    /// A negative count is worded beside the faces that a history lists.
    #[test]
    fn what_a_history_shows_comes_before_what_the_count_needs_said() {
        let count = VolumeCount::Stencil(255);
        let faces = FaceCounts { front: 1, ..FaceCounts::default() };
        let bits = CountBits::EIGHT;
        let counted =
            CountedFaces { side: CountedSide::Behind, faces, cleared_to: 0, near: None, sum: -1, bits, count };
        let why = LightDecision::Counted(counted, LightPassResult::Skips);
        let tested = TestedCount { count, ..IN_STENCIL };
        assert_eq!(
            verdict(Shadow, Some(count), History(why, Some(tested))).reason(),
            "1 volume face behind the surface fails the depth test: 0 back, 1 front; count −1 (255), so the light pass \
             skips it. More volumes were left than entered behind the surface. The light pass only asks whether the \
             count is 0: it skips this pixel."
        );
    }
}

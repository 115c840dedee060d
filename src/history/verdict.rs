//! Why a pixel is dark or lit under a light: its label with the evidence for it, and the one place that words both.
//!
//! The mask of a capture has the label. The evidence is as much as is known: what decides about the light, the
//! count that its light pass tested, or, where the pixel's history is known, the faces that made that count
//! ([`Why`]). A verdict claims nothing about geometry that neither the capture nor the history holds.

use super::{Count, PixelHistory, Why};
use crate::capture::{Capture, FrameSnapshot, FrameTarget, Snapshot, Step};
use crate::geometry::Extrusion;
use crate::numbers;
use crate::plan::{CountBits, DecidedBy, Side};
use crate::technique::{CountsBy, VolumeSettings};
use crate::truth::PixelLabel::{self, Background, FacesAway, Lit, Shadow};

/// What became of a light at a pixel, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// Index of the light.
    pub light: usize,
    /// What became of it, as the light's mask says; `None` where the capture has no mask.
    pub label: Option<PixelLabel>,
    /// The count of shadow volumes that the light pass tested; `None` where none was, or it was not captured.
    pub count: Option<Count>,
    /// What the label rests on.
    pub evidence: Evidence,
}

/// What a label rests on, as far as it is known.
#[derive(Debug, Clone, PartialEq)]
pub enum Evidence {
    /// The label says it all.
    Label,
    /// Shading alone leaves the surface dark; where it is wrapped, some light reaches round to it.
    Shading {
        /// The light wraps round surfaces.
        wraps: bool,
    },
    /// The kind of what decides about the light, and no more.
    Decision(DecidedBy),
    /// A count decides that was not captured.
    NoCount,
    /// The count that the light pass tested.
    Count(TestedCount),
    /// What the pixel's history shows; of a count that needs words of its own, with that.
    History(Why, Option<TestedCount>),
    /// What the texels of a shadow map store, in a sentence.
    Texels(String),
}

/// The count that a light pass tested, and what it is the sum of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TestedCount {
    /// The count.
    pub count: Count,
    /// On which side of the surface faces count.
    pub side: Side,
    /// The bits of the stencil that are counted in.
    pub bits: CountBits,
    /// Each face inverts one bit of the stencil.
    pub inverts: bool,
    /// The count may begin at another number than 0: parallel lines of sight end in volumes at infinity, and z-pass may
    /// begin with the volumes around the eye.
    pub begins_elsewhere: bool,
    /// Volumes that contain the surface, counted in a float beside a stencil that reads them as 0.
    pub in_float: Option<f32>,
}

impl Verdict {
    /// What the capture alone says of pixel `at`: column and row, from the top left.
    pub fn of(capture: &Capture, light: usize, at: [u32; 2]) -> Verdict {
        let captured = capture.lights.get(light);
        let label = captured.and_then(|light| light.shadow.as_ref()?.byte_at(at));
        let label = label.map(|byte| PixelLabel::from_byte(byte).unwrap_or(Shadow));
        let decided_by = capture.decided_by(light);
        let in_float = captured.and_then(|light| light.count.as_ref()?.count_at(at));
        let in_stencil = || tested_stencil(capture, light, at).map(Count::Stencil);
        let count = match (label, decided_by.counted_side()) {
            (None | Some(Background), _) | (_, None) => None,
            (Some(FacesAway), _) => in_float.map(Count::Float).or_else(in_stencil),
            (Some(Shadow | Lit), _) => {
                in_float.filter(|_| decided_by.counts_in_floats()).map(Count::Float).or_else(in_stencil)
            }
        };
        let evidence = match (label, decided_by.counted_side(), count) {
            (None | Some(Background), ..) => Evidence::Label,
            (Some(FacesAway), ..) => {
                Evidence::Shading { wraps: capture.settings.get("diffuse").is_some_and(|how| how == "wrapped") }
            }
            (_, None, _) => Evidence::Decision(decided_by),
            (_, Some(_), None) => Evidence::NoCount,
            (_, Some(side), Some(count)) => Evidence::Count(TestedCount::new(capture, light, (side, count), in_float)),
        };
        Verdict { light, label, count, evidence }
    }

    /// The same with what the pixel's history shows, where that says more.
    pub fn with_history(mut self, history: &PixelHistory) -> Verdict {
        let Some(why) = history.why(self.light) else { return self };
        let is_dark = self.label == Some(Shadow);
        self.evidence = match self.evidence {
            // A history that does not fit the mask explains nothing.
            Evidence::Count(tested) if tested.contradicts(is_dark) => Evidence::Count(tested),
            Evidence::Count(tested) => Evidence::History(why, tested.needs_words(is_dark).then_some(tested)),
            Evidence::NoCount => Evidence::History(why, None),
            // A map decides outside of the pixel's own history.
            Evidence::Decision(decided_by) if decided_by != DecidedBy::Map => Evidence::History(why, None),
            other => other,
        };
        self
    }

    /// The same with what the shadow map of a light stores, in a sentence; another light's map is no evidence.
    pub fn with_texels(mut self, light: usize, sentence: impl FnOnce() -> String) -> Verdict {
        if self.light == light && self.evidence == Evidence::Decision(DecidedBy::Map) {
            self.evidence = Evidence::Texels(sentence());
        }
        self
    }

    /// The label in a sentence, with the count that decided it.
    pub fn title(&self) -> String {
        let name = numbers::light(self.light);
        let title = match self.label {
            None => return "No light was asked about this pixel.".to_owned(),
            Some(Background) => return "Background: no surface is at this pixel.".to_owned(),
            Some(FacesAway) => return format!("Turned away from {name}."),
            Some(Shadow) => format!("Dark under {name}"),
            Some(Lit) => format!("Lit by {name}"),
        };
        match self.count {
            None => format!("{title}."),
            Some(Count::Stencil(count)) => format!("{title}: its stencil count is {}.", numbers::signed(count)),
            Some(Count::Float(count)) => format!("{title}: its count is {}.", numbers::count_in_float(count)),
        }
    }

    /// The evidence in one sentence, or in a few.
    pub fn reason(&self) -> String {
        let is_dark = self.label == Some(Shadow);
        match &self.evidence {
            Evidence::Label if self.label == Some(Background) => {
                "Nothing was drawn here, so there is nothing that a shadow could fall on.".to_owned()
            }
            Evidence::Label => "The capture holds no mask, so only the values below are known.".to_owned(),
            Evidence::Shading { wraps } => {
                let name = capitalized(&numbers::light(self.light));
                let follows = match wraps {
                    false => ", so shading alone leaves it dark.",
                    true => "; wrapped, it reaches round to here unless a shadow keeps it away.",
                };
                let count = self.count.map_or_else(String::new, |count| format!(" Its count is {count}."));
                format!("{name} shines on the other side of this surface{follows}{count}")
            }
            Evidence::Decision(decided_by) => reason(*decided_by, is_dark).to_owned(),
            Evidence::NoCount => "The count that decided it was not captured.".to_owned(),
            Evidence::Count(tested) => tested.reason(is_dark),
            Evidence::History(why, None) => format!("{}.", capitalized(&why.to_string())),
            Evidence::History(why, Some(tested)) => {
                format!("{}. {}", capitalized(&why.to_string()), tested.reason(is_dark))
            }
            Evidence::Texels(sentence) => sentence.clone(),
        }
    }
}

impl TestedCount {
    fn new(capture: &Capture, light: usize, (side, count): (Side, Count), in_float: Option<f32>) -> TestedCount {
        let settings = VolumeSettings::read(&capture.settings);
        let is_point = capture.lights.get(light).is_some_and(|light| light.position.w != 0.0);
        let lacks_caps = settings.extrusion == Extrusion::Infinite && settings.caps[1];
        let begins_at_infinity = capture.camera.is_parallel() && is_point && side != Side::InFront && lacks_caps;
        let in_stencil = matches!(count, Count::Stencil(_));
        TestedCount {
            count,
            side,
            bits: CountBits::of_mask(settings.mask().into()),
            inverts: in_stencil && settings.operations == CountsBy::Inverting,
            begins_elsewhere: begins_at_infinity || settings.starts_at_eye,
            in_float: in_float.filter(|_| in_stencil),
        }
    }

    /// The mask says something else than the count.
    pub fn contradicts(&self, is_dark: bool) -> bool {
        is_dark == self.count.is_zero()
    }

    /// More faces were left than entered.
    pub fn is_negative(&self) -> bool {
        match self.count {
            Count::Stencil(count) => !self.inverts && self.bits == CountBits::EIGHT && count > 127,
            Count::Float(count) => count < 0.0,
        }
    }

    /// The number of volumes, other than 0, that eight bits or fewer read or would read as 0.
    pub fn reads_as_zero(&self) -> Option<f32> {
        match self.count {
            Count::Stencil(_) => self.in_float.filter(|count| *count != 0.0 && self.count.is_zero()),
            Count::Float(count) => Some(count).filter(|count| numbers::reads_zero_in_eight_bits(*count)),
        }
    }

    /// The faces that a history lists do not say all of it.
    fn needs_words(&self, is_dark: bool) -> bool {
        (is_dark && self.is_negative()) || self.reads_as_zero().is_some()
    }

    /// Why a light pass that tests this count adds the light or not.
    fn reason(&self, is_dark: bool) -> String {
        let TestedCount { count, bits, .. } = self;
        let side = self.side.preposition();
        let began = if self.begins_elsewhere { "What the count began with and the" } else { "The" };
        let sum = format!("{began} volume faces {side} the surface");
        let skips = if matches!(count, Count::Stencil(_)) { "skips this pixel" } else { "adds nothing" };
        let does = if is_dark { skips } else { "adds the light" };
        match (count, self.reads_as_zero()) {
            // Mask and count disagree: say so, and do not explain it away.
            (Count::Stencil(count), _) if self.contradicts(is_dark) => {
                format!("The mask does not match the count {count} that the light pass tested.")
            }
            (count, _) if self.contradicts(is_dark) => {
                format!("The mask does not match the count {count} that the light pass read.")
            }
            (Count::Stencil(_), Some(count)) => {
                let verb = if bits.modulus() == 2 { "reads" } else { "read" };
                format!("{count} volumes contain the surface, which {bits} {verb} as 0: the light pass adds the light.")
            }
            _ if self.inverts && self.begins_elsewhere => {
                format!("{sum} leave its bit at {}, so the light pass {does}.", u8::from(is_dark))
            }
            _ if self.inverts => {
                let [parity, none] = if is_dark { ["An odd", ""] } else { ["An even", ", or none,"] };
                format!(
                    "{parity} number of volume faces {side} the surface{none} turned its bit over, so the light pass {does}."
                )
            }
            (count, Some(_)) => {
                format!("{sum} leave {count}, so the light pass {does}. Eight bits would read 0 and light this pixel.")
            }
            _ if self.is_negative() => format!(
                "More volumes were left than entered {side} the surface. Not 0 is all that the light pass asks, so it {does}."
            ),
            (Count::Stencil(_), _) if is_dark && *bits != CountBits::EIGHT => {
                format!("{sum} leave {count} in {bits}, not 0, so the light pass {does}.")
            }
            _ if is_dark => format!("{sum} leave {count}, not 0, so the light pass {does}."),
            _ => format!("{sum} cancel out, so the light pass {does}."),
        }
    }
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

/// The stencil value at `at` when the labels of `light` were decided.
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
    use crate::history::{Counted, Faces, LightPass};
    use Evidence::{Decision, History, Label, Shading};

    const IN_STENCIL: TestedCount = TestedCount {
        count: Count::Stencil(3),
        side: Side::Behind,
        bits: CountBits::EIGHT,
        inverts: false,
        begins_elsewhere: false,
        in_float: None,
    };

    fn verdict(label: PixelLabel, count: Option<Count>, evidence: Evidence) -> Verdict {
        Verdict { light: 0, label: Some(label), count, evidence }
    }

    #[test]
    fn a_label_is_worded_with_the_count_that_the_light_pass_tested() {
        let titles = [
            (Background, None, "Background: no surface is at this pixel."),
            (FacesAway, Some(Count::Stencil(3)), "Turned away from light 1."),
            (Shadow, Some(Count::Stencil(255)), "Dark under light 1: its stencil count is −1 (255)."),
            (Lit, Some(Count::Stencil(0)), "Lit by light 1: its stencil count is 0."),
            (Shadow, Some(Count::Float(1256.0)), "Dark under light 1: its count is 1\u{2009}256."),
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
                Some(Count::Stencil(2)),
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
            (Lit, None, Evidence::NoCount, "The count that decided it was not captured."),
            (Lit, None, Evidence::Texels("Texel 1, 2 holds no caster.".to_owned()), "Texel 1, 2 holds no caster."),
        ];
        for (label, count, evidence, reason) in reasons {
            assert_eq!(verdict(label, count, evidence).reason(), reason);
        }
    }

    #[test]
    fn a_count_is_worded_by_what_it_is_the_sum_of() {
        let few = CountBits::of_mask(3);
        let float = |count| TestedCount { count: Count::Float(count), ..IN_STENCIL };
        let byte = |count| TestedCount { count: Count::Stencil(count), ..IN_STENCIL };
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
                "More volumes were left than entered behind the surface. Not 0 is all that the light pass asks, so it \
                 skips this pixel.",
            ),
            (
                Shadow,
                float(-2.0),
                "More volumes were left than entered behind the surface. Not 0 is all that the light pass asks, so it \
                 adds nothing.",
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
            assert_eq!(verdict(label, Some(tested.count), Evidence::Count(tested)).reason(), reason);
        }
    }

    /// A negative count is worded beside the faces that a history lists.
    #[test]
    fn what_a_history_shows_comes_before_what_the_count_needs_said() {
        let count = Count::Stencil(255);
        let faces = Faces { front: 1, ..Faces::default() };
        let bits = CountBits::EIGHT;
        let counted = Counted { side: Side::Behind, faces, cleared_to: 0, near: None, sum: -1, bits, count };
        let why = Why::Counted(counted, LightPass::Skips);
        let tested = TestedCount { count, ..IN_STENCIL };
        assert_eq!(
            verdict(Shadow, Some(count), History(why, Some(tested))).reason(),
            "1 volume face behind the surface fails the depth test: 0 back, 1 front; count −1 (255), so the light pass \
             skips it. More volumes were left than entered behind the surface. Not 0 is all that the light pass asks, so \
             it skips this pixel."
        );
    }
}

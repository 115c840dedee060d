//! The verdict about the picked pixel, without its history, with it, and with its map: its facts compared with labels,
//! counts and the color that the light pass left. How facts are worded is tested in `history/verdict.rs`.

use super::SeenPatterns;
use super::frames::Frame;
use super::patterns::{gaps, number};
use stencilscope::capture::FrameTarget;
use stencilscope::history::{
    CountedFaces, FlattenedShadow, LightDecision, LightPassResult, PixelEventKind, PixelHistory, TestedCount, Verdict,
    VerdictEvidence, VolumeCount,
};
use stencilscope::plan::{CountBits, CountedSide, DecidedBy, DrawPart, Program};
use stencilscope::reading::map_decision::MapDecision;
use stencilscope::truth::PixelLabel;

struct Here<'a> {
    frame: &'a Frame,
    light: usize,
    at: [u32; 2],
    history: &'a PixelHistory,
}

impl Here<'_> {
    fn label(&self) -> Option<u8> {
        self.frame.label(self.light, self.at)
    }

    fn decided_by(&self) -> DecidedBy {
        self.frame.plan.lights[self.light].decided_by
    }

    /// The count as the GPU had it before the light asked: a byte, or a float.
    fn count(&self) -> f64 {
        let light = &self.frame.capture.lights[self.light];
        if self.decided_by().counts_in_floats() {
            return light.count.as_ref().and_then(|count| count.value_at(self.at)).expect("a count").into();
        }
        self.frame.stencil(Some(self.last_volume_pass()), self.at).expect("a stencil").into()
    }

    /// The count as a byte shows it: what is close to 255 is below 0.
    fn signed(&self) -> f64 {
        let count = self.count();
        if !self.decided_by().counts_in_floats() && count > 127.0 { count - 256.0 } else { count }
    }

    fn last_volume_pass(&self) -> usize {
        let is_one = |pass: &stencilscope::plan::Pass| {
            pass.light.is_some_and(|light| light.0 == self.light) && pass.timed && !is_lighting(pass)
        };
        self.frame.plan.passes.iter().rposition(is_one).expect("a pass that counts")
    }

    fn is_count(&self, count: VolumeCount) -> bool {
        let count = match count {
            VolumeCount::Stencil(count) => f64::from(count),
            VolumeCount::Float(count) => f64::from(count),
        };
        count == self.signed() || count == self.count()
    }

    /// Faces that counted, of the outside and of the inside of their volume.
    fn faces(&self) -> [f64; 2] {
        let mut faces = [0.0, 0.0];
        for event in self.history.events.iter().filter(|event| event.light == Some(self.light) && event.is_from_camera)
        {
            let Some(one) = event.triangle().filter(|one| one.part.is_of_volume()) else { continue };
            if event.step() != 0 {
                faces[usize::from(one.is_front == one.faces_inwards)] += 1.0;
            }
        }
        faces
    }

    /// Do the faces that count lie where they are said to, as their depths and the surface's have it?
    fn lie(&self, side: CountedSide, on_surface: u32) -> bool {
        let is_nearer =
            |depth: f32, of: f32| if self.frame.plan.depth.mapping.is_reversed() { depth > of } else { depth < of };
        let all = self.history.events.iter().filter(|event| event.light == Some(self.light) && event.is_from_camera);
        let mut counted = all.filter(|event| event.is_of_volume() && event.step() != 0).filter_map(|event| {
            let one = event.triangle()?;
            Some((is_nearer(one.depth, event.before.depth), one.depth == event.before.depth))
        });
        match side {
            CountedSide::Behind if on_surface > 0 => counted.all(|(nearer, _)| !nearer),
            CountedSide::Behind => counted.all(|(nearer, on)| !nearer && !on),
            CountedSide::InFront => counted.all(|(nearer, _)| nearer),
            CountedSide::AsNeeded => self.is_side(CountedSide::AsNeeded),
        }
    }

    /// May the count begin at another number than 0: of the volumes around the eye, or of those that parallel view rays
    /// end in?
    fn begins_elsewhere(&self) -> bool {
        let starts_at_eye = self.frame.plan.settings.get("start").is_some_and(|start| start == "eye-count");
        let is_point = self.frame.capture.lights[self.light].position.w != 0.0;
        let is_parallel = self.frame.capture.camera.is_parallel();
        starts_at_eye || (is_parallel && is_point && !self.is_side(CountedSide::InFront))
    }

    /// How often faces inverted its bit.
    fn turns(&self) -> usize {
        let own = self.history.events.iter().filter(|event| event.light == Some(self.light) && event.is_of_volume());
        own.filter(|event| event.step() != 0 && event.before.stencil != event.after.stencil).count()
    }

    fn near(&self) -> f64 {
        let events =
            self.history.events.iter().filter(|event| event.light == Some(self.light) && !event.is_from_camera);
        events.map(|event| f64::from(event.counted())).sum()
    }

    fn is_side(&self, side: CountedSide) -> bool {
        self.decided_by().counted_side() == Some(side)
    }

    /// What the light pass did to the picture here.
    fn is_brighter(&self) -> bool {
        let passes = self.frame.plan.passes.iter();
        let at =
            passes.clone().position(|pass| pass.light.is_some_and(|light| light.0 == self.light) && is_lighting(pass));
        let Some(at) = at.filter(|at| *at > 0) else { return false };
        let color = |step| self.frame.capture.frame_at(step).and_then(|frame| frame.color.image.rgba_at(self.at));
        color(at) != color(at - 1)
    }
}

fn is_lighting(pass: &stencilscope::plan::Pass) -> bool {
    pass.draws.iter().any(|draw| matches!(draw.program, Program::Light(_))) || pass.name == "light"
}

impl Here<'_> {
    fn is_label(&self, label: Option<PixelLabel>) -> bool {
        let clear = if self.frame.plan.depth.mapping.is_reversed() { 0.0 } else { 1.0 };
        let depth = || self.frame.capture.frame_at(0).and_then(|frame| frame.depth.image.depth_at(self.at));
        let is_clear = || depth() == Some(clear) || self.frame.capture.steps[0].light.is_some();
        label.is_some_and(|label| self.label() == Some(label as u8))
            && (label != Some(PixelLabel::Background) || is_clear())
    }

    /// A count is reported where the light pass tests one, and its value says whether the pixel is dark.
    fn tested(&self, label: Option<PixelLabel>, count: Option<VolumeCount>) -> bool {
        match (label, count) {
            (None | Some(PixelLabel::Background), count) => count.is_none(),
            (_, None) => !self.decided_by().counts_volumes(),
            (Some(PixelLabel::FacesAway), Some(count)) => self.is_count(count),
            (_, Some(count)) => self.is_count(count) && (self.count() == 0.0) == (label == Some(PixelLabel::Lit)),
        }
    }

    fn evidence(&self, verdict: &Verdict) -> bool {
        match &verdict.evidence {
            VerdictEvidence::Label => verdict.label == Some(PixelLabel::Background),
            VerdictEvidence::Shading { wraps: false } => !self.frame.plan.wraps_diffuse && !self.is_brighter(),
            VerdictEvidence::Shading { wraps: true } => {
                self.frame.plan.wraps_diffuse
                    && verdict.count.is_none_or(|_| self.is_brighter() == (self.count() == 0.0))
            }
            VerdictEvidence::Decision(decided_by) => self.decision(*decided_by),
            VerdictEvidence::NoCount => false,
            VerdictEvidence::Count(tested) => self.sum(verdict, tested),
            VerdictEvidence::History(why, tested) => {
                let shown = match why {
                    LightDecision::Background => false,
                    LightDecision::Counted(counted, pass) => self.counted(counted, *pass),
                    LightDecision::Flattened(flattened, pass) => self.flattened(flattened, *pass),
                };
                shown && tested.is_none_or(|tested| self.sum(verdict, &tested))
            }
            VerdictEvidence::Texels(sentence) => self.texels(sentence),
        }
    }

    fn decision(&self, decided_by: DecidedBy) -> bool {
        let asks = |draw: &stencilscope::plan::Draw| {
            draw.part.is_of_volume() || [DrawPart::PlanarShadow, DrawPart::Map].contains(&draw.part)
        };
        let passes = self.frame.plan.passes.iter();
        let of_light = passes.filter(|pass| pass.light.is_some_and(|light| light.0 == self.light));
        let asks_nothing = || !of_light.flat_map(|pass| &pass.draws).any(asks);
        decided_by == self.decided_by()
            && !decided_by.counts_volumes()
            && (decided_by != DecidedBy::Nothing || self.label() == Some(1) || asks_nothing())
    }

    fn sum(&self, verdict: &Verdict, tested: &TestedCount) -> bool {
        let is_dark = self.label() == Some(1);
        let inverts = self.frame.plan.settings.get("operations").is_some_and(|operations| operations == "invert");
        let mask = i64::from(tested.bits.modulus()) - 1;
        let fits = tested.bits == CountBits::EIGHT || (self.signed() as i64 & mask) == self.signed() as i64;
        let is_parity = || {
            let ends_right = tested.begins_elsewhere || self.turns() % 2 == usize::from(is_dark);
            inverts && ends_right && self.count() == f64::from(u8::from(is_dark))
        };
        let stored = self.frame.capture.lights[self.light].count.as_ref().and_then(|count| count.value_at(self.at));
        let reads_zero = |count: f32| match tested.count {
            VolumeCount::Stencil(_) => self.count() == 0.0 && stored == Some(count),
            VolumeCount::Float(_) => self.count() == f64::from(count) && self.count() % 256.0 == 0.0,
        };
        Some(tested.count) == verdict.count
            && self.is_side(tested.side)
            && (!tested.begins_elsewhere || self.begins_elsewhere())
            && fits
            && (!tested.inverts || is_parity())
            && (!tested.is_negative() || self.signed() < 0.0)
            && tested.reads_as_zero().is_none_or(reads_zero)
    }

    fn counted(&self, counted: &CountedFaces, pass: LightPassResult) -> bool {
        let CountedFaces { side, faces, cleared_to, near, sum, bits, count } = counted;
        let begins = self.history.events.iter().rev().find_map(|event| match event.kind {
            PixelEventKind::ClearStencil if event.light == Some(self.light) => Some(f64::from(event.after.stencil)),
            PixelEventKind::ClearCount if event.light == Some(self.light) => Some(f64::from(event.after.count)),
            _ => None,
        });
        let holds_otherwise = match count {
            VolumeCount::Stencil(byte) => bits.hold_otherwise(*sum, *byte),
            VolumeCount::Float(_) => false,
        };
        let rest = (f64::from(*sum) - self.count()).rem_euclid(bits.modulus().into());
        let does = match pass {
            LightPassResult::Adds => self.label() != Some(1) && self.count() == 0.0,
            LightPassResult::Skips => self.label() != Some(0) && self.count() != 0.0,
            LightPassResult::FacesAway | LightPassResult::AsksNothing => false,
            // No light of these frames is off.
            LightPassResult::AddsNothing => false,
            // Our own frames add light, and take none away.
            LightPassResult::Darkens | LightPassResult::LeavesLit | LightPassResult::DrawsShadow => false,
        };
        f64::from(*cleared_to) == begins.unwrap_or(0.0)
            && near.is_none_or(|near| f64::from(near) == self.near())
            && self.is_count(*count)
            && (!holds_otherwise || rest == 0.0)
            && [f64::from(faces.front), f64::from(faces.back)] == self.faces()
            && (faces.front + faces.back == 0 || self.lie(*side, faces.on_surface))
            && does
    }

    fn flattened(&self, flattened: &FlattenedShadow, pass: LightPassResult) -> bool {
        let of_light = || {
            self.history.triangles().filter(|(event, one)| {
                event.light == Some(self.light)
                    && event.target != FrameTarget::Labels
                    && one.part == DrawPart::PlanarShadow
            })
        };
        let falls =
            |name: &String| of_light().any(|(_, one)| one.outcome.passed() && one.caster.as_ref() == Some(name));
        let FlattenedShadow { casters, failed_stencil, failed_depth, hidden, .. } = flattened;
        if !casters.is_empty() {
            let does = matches!(pass, LightPassResult::Adds | LightPassResult::Skips);
            return casters.iter().all(falls) && does && self.label() == Some(1);
        }
        let left = failed_stencil + failed_depth + hidden;
        of_light().all(|(_, one)| !one.outcome.passed())
            && left >= 1
            && left as usize == of_light().count()
            && pass == LightPassResult::Adds
            && self.label() == Some(0)
    }

    fn texels(&self, sentence: &str) -> bool {
        let by_a_map = |label: u8| self.decided_by() == DecidedBy::Map && self.label() == Some(label);
        let Some(parts) = gaps("Texel {}: {}.", sentence) else { return false };
        let follows = match parts[1] {
            "the caster is nearer, so the light pass adds nothing" => by_a_map(1),
            "nothing nearer is stored, so the light pass adds the light" => by_a_map(0),
            "too close to tell by depths computed anew; the GPU's own say lit" => by_a_map(0),
            "too close to tell by depths computed anew; the GPU's own say in shadow" => by_a_map(1),
            many => gaps("of the {} texels read, {} hold nothing nearer to the light", many).is_some_and(|parts| {
                let [all, lit] = [number(parts[0]), number(parts[1])];
                by_a_map(u8::from(2.0 * lit < all))
            }),
        };
        let stores = [" holds no caster", " holds a caster ", " holds depth "];
        follows && stores.iter().any(|stores| parts[0].contains(stores))
    }
}

/// Kinds of verdicts, each of which some pixel must have.
pub fn patterns() -> Vec<&'static str> {
    vec![
        "background",
        "shading, counted",
        "shading",
        "shading, wrapped",
        "dark by Map",
        "lit by Map",
        "dark by Flattened",
        "lit by Flattened",
        "lit by ReceiverTextures",
        "dark by Silhouettes",
        "lit by Silhouettes",
        "lit by Nothing",
        "lit by Labels",
        "dark by a count in the stencil",
        "lit by a count in the stencil",
        "dark by a count in a float",
        "lit by a count in a float",
        "dark by a count in few bits",
        "dark by a count that begins elsewhere",
        "lit by a count that begins elsewhere",
        "dark by an inverted bit",
        "lit by an inverted bit",
        "an inverted bit that begins elsewhere",
        "dark by faces",
        "lit by faces",
        "a flattened shadow",
        "texels",
    ]
}

fn kind(verdict: &Verdict) -> &'static str {
    let is_dark = verdict.label == Some(PixelLabel::Shadow);
    let of = |dark, lit| if is_dark { dark } else { lit };
    match &verdict.evidence {
        VerdictEvidence::Label => "background",
        VerdictEvidence::Shading { wraps: true } => "shading, wrapped",
        VerdictEvidence::Shading { .. } if verdict.count.is_some() => "shading, counted",
        VerdictEvidence::Shading { .. } => "shading",
        VerdictEvidence::Decision(DecidedBy::Map) => of("dark by Map", "lit by Map"),
        VerdictEvidence::Decision(DecidedBy::Flattened) => of("dark by Flattened", "lit by Flattened"),
        VerdictEvidence::Decision(DecidedBy::ReceiverTextures) => {
            of("dark by ReceiverTextures", "lit by ReceiverTextures")
        }
        VerdictEvidence::Decision(DecidedBy::Silhouettes) => of("dark by Silhouettes", "lit by Silhouettes"),
        VerdictEvidence::Decision(DecidedBy::Nothing) => of("dark by Nothing", "lit by Nothing"),
        VerdictEvidence::Decision(_) => of("dark by Labels", "lit by Labels"),
        VerdictEvidence::NoCount => "no count",
        VerdictEvidence::Count(TestedCount { inverts: true, begins_elsewhere: true, .. }) => {
            "an inverted bit that begins elsewhere"
        }
        VerdictEvidence::Count(TestedCount { inverts: true, .. }) => {
            of("dark by an inverted bit", "lit by an inverted bit")
        }
        VerdictEvidence::Count(TestedCount { begins_elsewhere: true, .. }) => {
            of("dark by a count that begins elsewhere", "lit by a count that begins elsewhere")
        }
        VerdictEvidence::Count(tested) if tested.bits != CountBits::EIGHT => {
            of("dark by a count in few bits", "lit by a count in few bits")
        }
        VerdictEvidence::Count(TestedCount { count: VolumeCount::Stencil(_), .. }) => {
            of("dark by a count in the stencil", "lit by a count in the stencil")
        }
        VerdictEvidence::Count(_) => of("dark by a count in a float", "lit by a count in a float"),
        VerdictEvidence::History(LightDecision::Flattened(flattened, _), _) if flattened.casters.is_empty() => {
            "no flattened shadow"
        }
        VerdictEvidence::History(LightDecision::Flattened(..), _) => "a flattened shadow",
        VerdictEvidence::History(..) => of("dark by faces", "lit by faces"),
        VerdictEvidence::Texels(_) => "texels",
    }
}

pub fn check(frame: &Frame, seen: &mut SeenPatterns) -> Vec<String> {
    let mut wrong = Vec::new();
    for (history, at) in &frame.pixels {
        for light in 0..frame.capture.lights.len() {
            let here = Here { frame, light, at: *at, history };
            let plain = Verdict::of(&frame.capture, light, *at);
            let with_history = plain.clone().with_history(history);
            let map =
                frame.readers[light].as_ref().and_then(|readers| MapDecision::of(&frame.capture, readers, light, *at));
            let with_texels = map.map(|map| plain.clone().with_texels(light, || map.sentence()));
            for verdict in [Some(plain), Some(with_history), with_texels].into_iter().flatten() {
                let is_true = verdict.light == light
                    && here.is_label(verdict.label)
                    && here.tested(verdict.label, verdict.count)
                    && here.evidence(&verdict);
                if is_true {
                    seen.insert(kind(&verdict));
                } else {
                    wrong.push(format!(
                        "of pixel {at:?} under light {}, is not so ({}): {} {} {verdict:?}",
                        light + 1,
                        kind(&verdict),
                        verdict.title(),
                        verdict.reason()
                    ));
                }
            }
        }
    }
    wrong
}

//! The sentence about the picked pixel, without its history, with it, and with its map: held against labels, counts and
//! the color that the light pass left.

use super::Held;
use super::frames::Frame;
use super::patterns::{all_but, find, gaps, mask_of, matching, number};
use stencilscope::capture::FrameTarget;
use stencilscope::history::{Event, EventKind, PixelHistory};
use stencilscope::plan::{DecidedBy, Part, Program};
use stencilscope::reading::map_decision::MapDecision;
use stencilscope::reading::verdict::{Verdict, by_map, explained, verdict};

struct Here<'a> {
    frame: &'a Frame,
    light: usize,
    at: [u32; 2],
    history: &'a PixelHistory,
}

type Check = fn(&Here, &[&str]) -> bool;

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
            return light.count.as_ref().and_then(|count| count.count_at(self.at)).expect("a count").into();
        }
        self.frame.stencil(Some(self.last_volume_pass()), self.at).expect("a stencil").into()
    }

    /// As a byte is told: what is close to 255 is below 0.
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

    /// Has the pixel this label, and is its light told?
    fn is_of_light(&self, label: u8, told: &str) -> bool {
        self.label() == is(label) && number(told) == (self.light + 1) as f64
    }

    /// Is this the count, and one that lights or one that darkens?
    fn is_count_that(&self, lights: bool, told: &str) -> bool {
        self.is_count(told) && (self.count() == 0.0) == lights
    }

    /// The light's events in the pass of the camera.
    fn own_events(&self) -> impl Iterator<Item = &Event> {
        self.history.events.iter().filter(|event| event.light == Some(self.light) && event.is_from_camera)
    }

    fn is_count(&self, told: &str) -> bool {
        let told = told.split(" (").next().unwrap_or_default();
        number(told) == self.signed() || number(told) == self.count()
    }

    /// Faces that counted, of the outside and of the inside of their volume.
    fn faces(&self) -> [f64; 2] {
        let mut faces = [0.0, 0.0];
        for event in self.own_events() {
            let Some(one) = event.triangle().filter(|one| one.part.is_of_volume()) else { continue };
            if event.step() != 0 {
                faces[usize::from(one.is_front == one.faces_inwards)] += 1.0;
            }
        }
        faces
    }

    /// Do the faces that count lie where they are said to, as their depths and the surface's have it?
    fn lie(&self, told: &str) -> bool {
        let is_nearer =
            |depth: f32, of: f32| if self.frame.plan.depth.mapping.is_reversed() { depth > of } else { depth < of };
        let of_volumes = self.own_events().filter(|event| event.is_of_volume() && event.step() != 0);
        let mut counted = of_volumes.filter_map(|event| {
            let one = event.triangle()?;
            Some((is_nearer(one.depth, event.before.depth), one.depth == event.before.depth))
        });
        match told {
            _ if told.ends_with(" on or behind") => counted.all(|(nearer, _)| !nearer),
            _ if told.ends_with(" behind") => counted.all(|(nearer, on)| !nearer && !on),
            _ if told.ends_with(" in front of") => counted.all(|(nearer, _)| nearer),
            _ => told.ends_with(" on either side of") && self.says_side("on either side of"),
        }
    }

    /// May the count begin at another number than 0: of the volumes around the eye, or of those that parallel lines of
    /// sight end in?
    fn begins_elsewhere(&self) -> bool {
        let is_point = self.frame.capture.lights[self.light].position.w != 0.0;
        let is_parallel = self.frame.capture.camera.is_parallel();
        self.frame.starts_at_eye() || (is_parallel && is_point && !self.says_side("in front of"))
    }

    /// How often faces turned its bit over.
    fn turns(&self) -> usize {
        let own = self.history.events.iter().filter(|event| event.light == Some(self.light) && event.is_of_volume());
        own.filter(|event| event.step() != 0 && event.before.stencil != event.after.stencil).count()
    }

    fn near(&self) -> f64 {
        let events =
            self.history.events.iter().filter(|event| event.light == Some(self.light) && !event.is_from_camera);
        events.map(|event| f64::from(event.counted())).sum()
    }

    fn says_side(&self, told: &str) -> bool {
        self.decided_by().counted_side().is_some_and(|side| side.preposition() == told)
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

const fn is(label: u8) -> Option<u8> {
    Some(label)
}

const TITLES: &[(&str, Check)] = &[
    ("Background: no surface is at this pixel.", |here, _| {
        let clear = if here.frame.plan.depth.mapping.is_reversed() { 0.0 } else { 1.0 };
        let depth = here.frame.capture.frame_at(0).and_then(|frame| frame.depth.image.depth_at(here.at));
        here.label() == is(2) && (depth == Some(clear) || here.frame.capture.steps[0].light.is_some())
    }),
    ("Turned away from light {}.", |here, told| here.is_of_light(3, told[0])),
    ("Dark under light {}: its stencil count is {}.", |here, told| {
        here.is_of_light(1, told[0]) && here.is_count_that(false, told[1])
    }),
    ("Lit by light {}: its stencil count is {}.", |here, told| {
        here.is_of_light(0, told[0]) && here.is_count_that(true, told[1])
    }),
    ("Dark under light {}: its count is {}.", |here, told| {
        here.is_of_light(1, told[0]) && here.is_count_that(false, told[1])
    }),
    ("Lit by light {}: its count is {}.", |here, told| {
        here.is_of_light(0, told[0]) && here.is_count_that(true, told[1])
    }),
    ("Dark under light {}.", |here, told| here.is_of_light(1, told[0])),
    ("Lit by light {}.", |here, told| here.is_of_light(0, told[0])),
];

fn dark_count(here: &Here, side: &str, count: &str) -> bool {
    here.label() == is(1) && here.says_side(side) && here.is_count_that(false, count)
}

/// What a light pass does that leaves a pixel dark.
fn darkens(does: &str) -> bool {
    ["skips this pixel", "adds nothing"].contains(&does)
}

/// Is the shadow decided by this, and the pixel's label so?
fn decided(here: &Here, by: DecidedBy, label: u8) -> bool {
    here.decided_by() == by && here.label() == is(label)
}

const REASONS: &[(&str, Check)] = &[
    ("Nothing was drawn here, so there is nothing that a shadow could fall on.", |here, _| here.label() == is(2)),
    (
        "Light {} shines on the other side of this surface, so shading alone leaves it dark. Its count is {}.",
        |here, told| here.is_of_light(3, told[0]) && here.is_count(told[1]) && !here.is_brighter(),
    ),
    (
        "Light {} shines on the other side of this surface; wrapped, it reaches round to here unless a shadow keeps it away.{}",
        |here, told| {
            let count = gaps(" Its count is {}.", told[1])
                .map(|told| here.is_count(told[0]) && here.is_brighter() == (here.count() == 0.0));
            let is_lit = !here.decided_by().counts_volumes();
            here.is_of_light(3, told[0]) && here.frame.plan.wraps_diffuse && count.unwrap_or(is_lit)
        },
    ),
    ("Light {} shines on the other side of this surface, so shading alone leaves it dark.", |here, told| {
        here.is_of_light(3, told[0]) && !here.decided_by().counts_volumes() && !here.is_brighter()
    }),
    ("The volume faces {} the surface leave {} in {}, not 0, so the light pass skips this pixel.", |here, told| {
        let mask = i64::from(mask_of(told[2]));
        dark_count(here, told[0], told[1]) && (here.signed() as i64 & mask) == here.signed() as i64
    }),
    ("The volume faces {} the surface leave {}, not 0, so the light pass skips this pixel.", |here, told| {
        dark_count(here, told[0], told[1])
    }),
    (
        "What the count began with and the volume faces {} the surface leave {}, not 0, so the light pass {}.",
        |here, told| here.begins_elsewhere() && dark_count(here, told[0], told[1]) && darkens(told[2]),
    ),
    ("The volume faces {} the surface leave {}, not 0, so the light pass adds nothing.", |here, told| {
        dark_count(here, told[0], told[1])
    }),
    (
        "The volume faces {} the surface leave {}, so the light pass adds nothing. Eight bits would read 0 and light this pixel.",
        |here, told| dark_count(here, told[0], told[1]) && here.count() % 256.0 == 0.0,
    ),
    (
        "{}More volumes were left than entered {} the surface. Not 0 is all that the light pass asks, so it {}.",
        |here, told| {
            let of_history = told[0].is_empty() || counted(here, told[0].trim_end().trim_end_matches('.'));
            here.label() == is(1) && here.says_side(told[1]) && here.signed() < 0.0 && darkens(told[2]) && of_history
        },
    ),
    ("{}{} volumes contain the surface, which eight bits read as 0: the light pass adds the light.", |here, told| {
        let of_history = told[0].is_empty() || counted(here, told[0]);
        let held = here.frame.capture.lights[here.light].count.as_ref().and_then(|count| count.count_at(here.at));
        here.label() == is(0)
            && here.count() == 0.0
            && of_history
            && held.is_some_and(|count| number(told[1]) == f64::from(count))
    }),
    (
        "What the count began with and the volume faces {} the surface leave its bit at {}, so the light pass {}.",
        |here, told| {
            let is_one = told[1] == "1";
            let does = if is_one { "skips this pixel" } else { "adds the light" };
            let stored = here.label() == is(u8::from(is_one)) && here.count() == f64::from(u8::from(is_one));
            here.begins_elsewhere() && here.says_side(told[0]) && stored && told[2] == does
        },
    ),
    (
        "An odd number of volume faces {} the surface turned its bit over, so the light pass skips this pixel.",
        |here, told| here.label() == is(1) && here.count() == 1.0 && here.says_side(told[0]) && here.turns() % 2 == 1,
    ),
    (
        "An even number of volume faces {} the surface, or none, turned its bit over, so the light pass adds the light.",
        |here, told| here.label() == is(0) && here.count() == 0.0 && here.says_side(told[0]) && here.turns() % 2 == 0,
    ),
    ("The volume faces {} the surface cancel out, so the light pass adds the light.", |here, told| {
        here.label() == is(0) && here.says_side(told[0]) && here.count() == 0.0
    }),
    (
        "What the count began with and the volume faces {} the surface cancel out, so the light pass adds the light.",
        |here, told| here.begins_elsewhere() && here.label() == is(0) && here.says_side(told[0]) && here.count() == 0.0,
    ),
    ("The light's map holds something nearer to the light here, so the light pass adds nothing.", |here, _| {
        decided(here, DecidedBy::Map, 1)
    }),
    ("The light's map holds nothing nearer to the light here, so the light pass adds it.", |here, _| {
        decided(here, DecidedBy::Map, 0)
    }),
    ("Texel {}: {}.", |here, told| {
        let follows = match told[1] {
            "it is nearer, so the light pass adds nothing" => decided(here, DecidedBy::Map, 1),
            "nothing nearer is stored, so the light pass adds the light" => decided(here, DecidedBy::Map, 0),
            "too close to tell by depths computed anew; the GPU's own say lit" => decided(here, DecidedBy::Map, 0),
            "too close to tell by depths computed anew; the GPU's own say in shadow" => {
                decided(here, DecidedBy::Map, 1)
            }
            many => gaps("of the {} texels read, {} hold nothing nearer to the light", many).is_some_and(|told| {
                let [all, lit] = [number(told[0]), number(told[1])];
                decided(here, DecidedBy::Map, u8::from(2.0 * lit < all))
            }),
        };
        follows
            && (told[0].contains(" holds no caster")
                || told[0].contains(" holds a caster ")
                || told[0].contains(" holds depth "))
    }),
    ("A caster, flattened onto this flat receiver from the light, covers the pixel.", |here, _| {
        decided(here, DecidedBy::Flattened, 1)
    }),
    (
        "No flattened caster covers the pixel. Planar shadows fall on flat receivers only, so nothing else is asked.",
        |here, _| decided(here, DecidedBy::Flattened, 0),
    ),
    ("The flattened shadow of {} falls on the surface here, {}.", |here, told| {
        let names = told[0].split(" and ").all(|name| {
            here.history.triangles().any(|(event, one)| {
                event.light == Some(here.light)
                    && one.part == Part::PlanarShadow
                    && one.fate.passed()
                    && one.caster.as_deref() == Some(name)
            })
        });
        let does = ["so the light pass skips it", "and darkens it after the light pass"].contains(&told[1]);
        names && does && here.label() == is(1)
    }),
    ("{} over the surface {} the depth test against it, so the light pass adds the light.", |here, told| {
        flattened_triangles(here, told[0])
    }),
    (
        "{} of another receiver: this surface has a mark of its own, and the stencil test keeps shadow off it, so the light pass adds the light.",
        |here, told| flattened_triangles(here, told[0].trim_end_matches(" is").trim_end_matches(" are")),
    ),
    (
        "{} over the surface, which is no receiver, and the stencil test keeps shadow off it, so the light pass adds the light.",
        |here, told| flattened_triangles(here, told[0].trim_end_matches(" is").trim_end_matches(" are")),
    ),
    ("{} over it left no fragment, so the light pass adds the light.", |here, told| flattened_triangles(here, told[0])),
    (
        "The texture of this flat receiver lets less than half of the light through here: a caster between it and the light was drawn there.",
        |here, _| decided(here, DecidedBy::ReceiverTextures, 1),
    ),
    (
        "No caster was drawn here into this receiver's texture. Surfaces that are not flat have none, and are lit.",
        |here, _| decided(here, DecidedBy::ReceiverTextures, 0),
    ),
    (
        "The silhouette of another object falls here. Nobody asks whether that object is nearer to the light, and translucent ones count as opaque for the mask.",
        |here, _| decided(here, DecidedBy::Silhouettes, 1),
    ),
    ("No silhouette of another object falls here; an object's own is never asked.", |here, _| {
        decided(here, DecidedBy::Silhouettes, 0)
    }),
    ("No shadow of this light is made in this frame: it reaches every surface that faces it.", |here, _| {
        let asks = |draw: &stencilscope::plan::Draw| {
            draw.part.is_of_volume() || [Part::PlanarShadow, Part::Map].contains(&draw.part)
        };
        let of_light =
            here.frame.plan.passes.iter().filter(|pass| pass.light.is_some_and(|light| light.0 == here.light));
        here.decided_by() == DecidedBy::Nothing
            && here.label() == is(0)
            && !of_light.flat_map(|pass| &pass.draws).any(asks)
    }),
    ("The technique's mask says that something lies between the surface and the light.", |here, _| {
        here.label() == is(1)
    }),
    ("The technique's mask says that nothing lies between the surface and the light.", |here, _| here.label() == is(0)),
    ("{}, so the light pass skips it.", |here, told| {
        counted(here, told[0]) && here.label() != is(0) && here.count() != 0.0
    }),
    ("{}, so the light pass adds the light.", |here, told| {
        counted(here, told[0]) && here.label() != is(1) && here.count() == 0.0
    }),
];

fn flattened_triangles(here: &Here, told: &str) -> bool {
    let count = number(told);
    let of_light = here.history.triangles().filter(|(event, one)| {
        event.light == Some(here.light) && event.target != FrameTarget::Labels && one.part == Part::PlanarShadow
    });
    let all: Vec<bool> = of_light.map(|(_, one)| one.fate.passed()).collect();
    let none_passes = all.iter().all(|passed| !passed);
    none_passes
        && count >= 1.0
        && count <= all.len() as f64
        && here.label() == is(0)
        && told.contains("flattened triangle")
}

/// What a history says of faces and counts, up to what follows of it.
fn counted(here: &Here, told: &str) -> bool {
    let told = told
        .trim_end()
        .trim_end_matches(", so the light pass skips it")
        .trim_end_matches(", so the light pass adds the light");
    let [outside, inside] = here.faces();
    let (cleared, told) = match gaps("The count begins at {}; {}", told) {
        Some(parts) => (Some(number(parts[0])), parts[1]),
        None => (None, told),
    };
    let begins = here.history.events.iter().rev().find_map(|event| match event.kind {
        EventKind::ClearStencil if event.light == Some(here.light) => Some(f64::from(event.after.stencil)),
        EventKind::ClearCount if event.light == Some(here.light) => Some(f64::from(event.after.count)),
        _ => None,
    });
    let is_cleared = cleared.unwrap_or(0.0) == begins.unwrap_or(0.0);
    let upper = told.strip_prefix("the").map(|rest| format!("The{rest}"));
    let told = upper.as_deref().unwrap_or(told);
    let (near, told) = match gaps("The near plane is in {}; {}", told) {
        Some(parts) => (Some(number(parts[0])), parts[1]),
        None => (None, told),
    };
    let near_holds = near.is_none_or(|near| near == here.near());
    let (faces, count) = told.rsplit_once("; ").unwrap_or((told, ""));
    let modulus = |bits: &str| match bits {
        "eight bits hold" => 256.0,
        "four bits hold" => 16.0,
        "two bits hold" => 4.0,
        "one bit holds" => 2.0,
        _ => f64::NAN,
    };
    let count_holds = match (gaps("count {}", count), gaps("together {}, which {} as {}", count)) {
        (Some(told), _) => here.is_count(told[0]),
        (_, Some(told)) => {
            here.is_count(told[2]) && (number(told[0]) - here.count()).rem_euclid(modulus(told[1])) == 0.0
        }
        _ => false,
    };
    let faces = faces.split(", of which").next().unwrap_or_default();
    let faces_hold = if faces.to_lowercase() == "no volume face on the view ray counts" {
        outside + inside == 0.0
    } else {
        let (words, parts) = faces.split_once(": ").unwrap_or((faces, ""));
        let front = gaps("{} front, {} back", parts).map(|told| [number(told[0]), number(told[1])]);
        let back = gaps("{} back, {} front", parts).map(|told| [number(told[1]), number(told[0])]);
        let is_there = here.lie(words.split(" the surface").next().unwrap_or_default());
        number(words) == outside + inside && front.or(back) == Some([outside, inside]) && is_there
    };
    is_cleared && near_holds && count_holds && faces_hold
}

pub fn patterns() -> Vec<&'static str> {
    // Told where labels and counts are of several kinds at once, which the pixels here may miss.
    let rare = [
        "which eight bits read as 0",
        "Eight bits would read 0",
        "over it left no fragment",
        "The technique's mask says that something",
        "the depth test against it",
        "of another receiver",
        "which is no receiver",
        "The texture of this flat receiver",
        "More volumes were left",
    ];
    all_but(&rare, &[TITLES, REASONS])
}

/// Of any pattern that knows the text: some know the same ones.
fn find_any(all: &'static [(&'static str, Check)], here: &Here, text: &str, held: &mut Held) -> Option<String> {
    find(matching(all, text), text, held, |check, told| check(here, told))
}

pub fn check(frame: &Frame, held: &mut Held) -> Vec<String> {
    let mut wrong = Vec::new();
    for (history, at) in &frame.pixels {
        for light in 0..frame.capture.lights.len() {
            let here = Here { frame, light, at: *at, history };
            let plain = verdict(&frame.capture, light, *at);
            let told = explained(plain.clone(), history, light);
            let map =
                frame.readers[light].as_ref().and_then(|readers| MapDecision::of(&frame.capture, readers, light, *at));
            let mapped = map.map(|map| by_map(plain.clone(), &map, light));
            let all: Vec<Verdict> = [Some(plain), Some(told), mapped].into_iter().flatten().collect();
            for Verdict { title, reason, .. } in &all {
                let told = [find_any(TITLES, &here, title, held), find_any(REASONS, &here, reason, held)];
                wrong.extend(
                    told.into_iter().flatten().map(|what| format!("of pixel {at:?} under light {}, {what}", light + 1)),
                );
            }
        }
    }
    wrong
}

//! The stops of the guided tours: what each says is compared with the frame that it shows. The words that are checked
//! stand here too, so that others are found.

use super::purposes::steps;
use crate::common::{opened, request, session, stencil};
use std::collections::{BTreeMap, BTreeSet};
use stencilscope::capture::Capture;
use stencilscope::inspector::{TOURS, Tour, TourMove, TourStop};
use stencilscope::plan::{DecidedBy, Draw, DrawPart, FramePlan, Pass, Program, Visibility};
use stencilscope::progress::Progress;
use stencilscope::reading::picture_view::PictureKind;
use stencilscope::scene::Scene;
use stencilscope::technique::Technique;
use wgpu::{CompareFunction, StencilOperation};

const SIZE: [u32; 2] = [320, 240];

/// What a stop shows.
struct Shown<'a> {
    scene: &'a Scene,
    capture: &'a Capture,
    plan: &'a FramePlan,
    step: usize,
}

impl Shown<'_> {
    fn pass(&self) -> &Pass {
        &self.plan.passes[self.step]
    }

    fn draws(&self) -> &[Draw] {
        &self.pass().draws
    }

    /// The draws of all passes.
    fn all_draws(&self) -> impl Iterator<Item = &Draw> + Clone {
        self.plan.passes.iter().flat_map(|pass| &pass.draws)
    }

    fn wrong(&self) -> [u64; 2] {
        let errors = self.capture.lights.iter().filter_map(|light| light.truth.as_ref()).map(|truth| truth.error);
        errors.fold([0, 0], |[one, other], error| [one + error.false_shadow, other + error.missing_shadow])
    }

    fn labels(&self, label: u8) -> usize {
        let shadows = self.capture.lights.iter().filter_map(|light| light.shadow.as_ref());
        shadows.flat_map(|shadow| shadow.rows().flatten()).filter(|one| **one == label).count()
    }

    fn stencil(&self) -> Vec<u8> {
        stencil(self.capture.frame_at(self.step).expect("a frame"))
    }

    /// All sides count on that side of the surface: up where the ray enters it from there, and down where it leaves.
    fn count(&self, in_front: bool) -> bool {
        let sides: Vec<_> = self.draws().iter().filter(|draw| draw.part == DrawPart::Side).filter_map(steps).collect();
        let by = if in_front { (1, -1) } else { (-1, 1) };
        !sides.is_empty() && sides.iter().all(|one| one.is_in_front == in_front && (one.outside, one.inside) == by)
    }

    fn lights_by(&self, how: Visibility) -> bool {
        let passes = self.plan.passes.iter().filter(|pass| pass.name == "light");
        passes.flat_map(|pass| &pass.draws).any(|draw| draw.program == Program::Light(how))
    }

    fn has(&self, part: DrawPart) -> bool {
        self.all_draws().any(|draw| draw.part == part)
    }

    fn faces(&self) -> usize {
        self.capture.lights[0].map.as_ref().map_or(0, |map| map.faces.len())
    }
}

type Claim = (Technique, &'static str, &'static str, fn(&Shown) -> bool);

/// By tour, title and words of a stop.
const CLAIMS: &[Claim] = &[
    (Technique::None, "Ambient light and depth", "The first pass draws every surface in a little light", |shown| {
        let is_ambient = |draw: &Draw| matches!(draw.program, Program::Ambient { .. }) && draw.raster.depth_write;
        shown.step == 0 && shown.draws().iter().all(is_ambient)
    }),
    (Technique::None, "How far everything is", "never draws a surface twice at the same place", |shown| {
        let later = shown.plan.passes[1..].iter().filter(|pass| pass.timed).flat_map(|pass| &pass.draws);
        later.clone().count() > 0 && later.clone().all(|draw| !draw.raster.depth_write)
    }),
    (Technique::None, "Light without shadow", "to every surface that faces it, whatever stands between", |shown| {
        shown.labels(1) == 0 && shown.wrong()[0] == 0 && shown.wrong()[1] > 0
    }),
    (Technique::Planar, "A floor that catches shadows", "Its pixels are marked in the stencil buffer first", |shown| {
        shown.draws().iter().all(|draw| draw.part == DrawPart::Receiver)
            && shown.stencil().iter().any(|byte| *byte != 0)
    }),
    (Technique::Planar, "Casters pressed flat", "lets each pixel be darkened once", |shown| {
        let is_once = |draw: &Draw| {
            draw.part == DrawPart::PlanarShadow && draw.raster.face(true).0.compare == CompareFunction::Equal
        };
        shown.draws().iter().all(is_once) && shown.stencil().iter().any(|byte| byte % 2 == 1)
    }),
    (
        Technique::Planar,
        "One pixel, event by event",
        "the receiver marks it, a flattened triangle passes the test and raises it",
        |shown| {
            let before = &shown.plan.passes[shown.step - 1].draws;
            let all = |draws: &[Draw], does| draws.iter().all(|draw| draw.raster.face(true).0.pass_op == does);
            all(before, StencilOperation::Replace) && all(shown.draws(), StencilOperation::IncrementClamp)
        },
    ),
    (
        Technique::Planar,
        "Where it is wrong",
        "casters beyond the light or under the floor must be clipped away",
        |shown| shown.wrong()[0] == 0,
    ),
    (
        Technique::PlanarTexture,
        "A texture for each flat piece",
        "White lets light through, black keeps it away",
        |shown| {
            let map = shown.capture.lights[0].map.as_ref().expect("textures");
            let texels = map.faces.iter().flat_map(|face| face.rows().flat_map(|row| row.chunks_exact(4)));
            let ends: BTreeSet<[u8; 3]> = texels.map(|texel| [texel[0], texel[1], texel[2]]).collect();
            map.holds_colors() && ends.contains(&[255; 3]) && ends.contains(&[0; 3])
        },
    ),
    (Technique::PlanarTexture, "Light, read through the texture", "No stencil is needed", |shown| {
        shown.lights_by(Visibility::ReceiverTexture) && !shown.has(DrawPart::Receiver)
    }),
    (Technique::PlanarTexture, "Its error", "Wrong pixels lie along edges", |shown| shown.capture.error().is_some()),
    (Technique::ZPass, "Shadow as a volume", "A point is in shadow exactly if it is inside one", |shown| {
        shown.count(true) && shown.stencil().iter().any(|count| *count > 0)
    }),
    (Technique::ZPass, "Seen from beside", "sides, light caps and dark caps in their own colours", |shown| {
        shown.has(DrawPart::Side)
    }),
    (
        Technique::ZPass,
        "The count of one pixel",
        "A front face before the surface adds 1, a back face takes 1 away",
        |shown| shown.count(true),
    ),
    (Technique::ZPass, "Where it fails", "the eye is inside a volume, and the near plane cuts others", |shown| {
        shown.scene.name == "inside" && shown.wrong().iter().sum::<u64>() > 0
    }),
    (Technique::ZPass, "Held against the truth", "The hatched pixels are wrong", |shown| {
        shown.wrong().iter().sum::<u64>() > 0
    }),
    (Technique::ZPass, "The fix: count from the other end", "The same scene, and no pixel is wrong", |shown| {
        shown.capture.technique == "z-fail" && shown.scene.name == "inside" && shown.wrong() == [0, 0]
    }),
    (Technique::ZFail, "What every pixel shows", "First the scene in ambient light, with its depths", |shown| {
        shown.step == 0 && shown.draws().iter().all(|draw| draw.raster.depth_write)
    }),
    (
        Technique::ZFail,
        "Faces behind it",
        "A back face that is hidden by the surface adds 1 to the stencil, a hidden front face takes 1 away",
        |shown| shown.count(false) && shown.pass().color.is_none(),
    ),
    (Technique::ZFail, "Who failed the depth test", "their depth test fails, and just there they count", |shown| {
        shown.count(false)
    }),
    (
        Technique::ZFail,
        "The same in the API's words",
        "decrement for front faces, increment for back faces, both wrapping",
        |shown| {
            shown.draws().iter().filter(|draw| draw.part == DrawPart::Side).all(|draw| {
                let [front, back] = [true, false].map(|is_front| draw.raster.face(is_front).0.depth_fail_op);
                [front, back] == [StencilOperation::DecrementWrap, StencilOperation::IncrementWrap]
            })
        },
    ),
    (
        Technique::ZFail,
        "One pixel, face by face",
        "Failed here means counted: the face lies behind the surface",
        |shown| shown.count(false) && shown.labels(1) > 0,
    ),
    (Technique::ZFail, "Light where the count is 0", "The light's pass tests the stencil for 0", |shown| {
        let tested = shown.draws().iter().filter(|draw| draw.raster.stencil.is_enabled());
        tested.clone().count() > 0
            && tested.clone().all(|draw| {
                draw.raster.stencil_reference == 0 && draw.raster.face(true).0.compare == CompareFunction::Equal
            })
    }),
    (Technique::ZFail, "No wrong pixel", "all pixels agree but for a thin band along edges", |shown| {
        let error = shown.capture.error().expect("a truth");
        let band = u64::from(SIZE[0] * SIZE[1]) - error.compared;
        shown.wrong() == [0, 0] && band > 0 && band * 10 < error.compared
    }),
    (
        Technique::ZPassPlus,
        "What was cut off",
        "an extra pass draws the casters onto the near plane as the light sees them",
        |shown| {
            shown.pass().counts_at_near_plane()
                && shown.pass().view.0 != 0
                && shown.stencil().iter().any(|count| *count > 0)
        },
    ),
    (
        Technique::ZPassPlus,
        "Then count as z-pass does",
        "counted in front of the surface, on top of that start",
        |shown| {
            shown.count(true)
                && shown.pass().depth_stencil.as_ref().is_some_and(|target| target.clear_stencil.is_none())
        },
    ),
    (Technique::ZPassPlus, "What remains", "single pixels may leak along the cut", |shown| {
        // Few, if any: one in a thousand.
        let compared = shown.capture.error().expect("a truth").compared;
        shown.wrong().iter().sum::<u64>() * 1000 <= compared
    }),
    (
        Technique::Auto,
        "The cheapest that is right",
        "a volume that can't be cut by the near plane is counted without caps",
        |shown| {
            let is_in_front = |draw: &&Draw| steps(draw).is_some_and(|one| one.is_in_front);
            let is_cap = |draw: &&Draw| matches!(draw.part, DrawPart::LightCap | DrawPart::DarkCap);
            let in_front: BTreeSet<_> = shown.draws().iter().filter(is_in_front).map(|draw| &draw.caster).collect();
            shown.draws().iter().filter(is_cap).all(|draw| !in_front.contains(&draw.caster))
        },
    ),
    (Technique::Auto, "What was left out", "lists everything that was left out with its reason", |shown| {
        !shown.capture.left_out.is_empty() && shown.capture.left_out.iter().all(|left| left.because.len() > 5)
    }),
    (Technique::Auto, "Still no wrong pixel", "auto has no wrong pixel in any of the built-in scenes", |shown| {
        shown.wrong() == [0, 0]
    }),
    (
        Technique::ShadowMap,
        "What the light sees",
        "where they fit into one view, as here, one map is enough",
        |shown| shown.faces() == 1 && shown.has(DrawPart::Map) && shown.capture.lights[0].decided_by == DecidedBy::Map,
    ),
    (
        Technique::ShadowMap,
        "Compared at every pixel",
        "If the map has something nearer, the point is in shadow",
        |shown| shown.lights_by(Visibility::Map) && shown.labels(1) > 0,
    ),
    (Technique::ShadowMap, "Texel and pixel, linked", "near the light one texel serves many", |shown| {
        shown.faces() > 0
    }),
    (Technique::ShadowMap, "Bias", "The depth is moved by a bias", |shown| {
        let maps = shown.all_draws().filter(|draw| draw.part == DrawPart::Map);
        maps.clone().count() > 0 && maps.clone().all(|draw| draw.raster.depth_bias.constant != 0)
    }),
    (Technique::ShadowMap, "Its error", "Wrong pixels follow the texels along every edge", |shown| {
        shown.wrong().iter().sum::<u64>() > 0
    }),
    (
        Technique::Projective,
        "A slide of each caster",
        "Each caster is drawn in black, or in its colour where it is glass",
        |shown| {
            let glass = shown.scene.objects.iter().filter(|object| object.casts).count();
            let names = &shown.plan.lights[0].map.as_ref().expect("slides").layer_names;
            names.len() <= glass && shown.capture.lights[0].map.as_ref().is_some_and(|map| map.holds_colors())
        },
    ),
    (Technique::Projective, "Thrown over the scene", "Every surface behind it is looked up in that slide", |shown| {
        shown.lights_by(Visibility::Projected) && shown.labels(1) > 0
    }),
    (Technique::Projective, "What it can't know", "a caster can't shadow itself", |shown| {
        // A caster's own layer is left out of its look-up.
        let mut lit = shown.all_draws().filter(|draw| draw.program == Program::Light(Visibility::Projected));
        lit.any(|draw| draw.constants.layer.is_some())
    }),
    (Technique::RayTraced, "A ray for every pixel", "From each surface point a ray goes to the light", |shown| {
        shown.pass().image.is_some()
    }),
    (Technique::RayTraced, "Edges", "Such pixels are an edge band and not compared", |shown| {
        shown.capture.error().is_some_and(|error| error.compared < u64::from(SIZE[0] * SIZE[1]))
    }),
    (Technique::RayTraced, "What it costs", "sets every technique's wrong pixels beside its milliseconds", |shown| {
        shown.wrong() == [0, 0]
    }),
];

/// The scene that a stop is in: its own, or that of one before it.
fn scene_at(tour: &Tour, stop: usize) -> &'static str {
    let of =
        |stop: &TourStop| stop.go.iter().find_map(|go| if let TourMove::Scene(name) = go { Some(*name) } else { None });
    tour.stops[..=stop].iter().rev().find_map(of).expect("a tour opens a scene")
}

/// The step that a stop goes to: what it says, else where the one before was.
fn step_at(stop: &TourStop, plan: &FramePlan, before: usize) -> Option<usize> {
    let mut step = Some(before.min(plan.passes.len() - 1));
    for go in stop.go {
        step = match go {
            TourMove::First => Some(0),
            TourMove::Last => Some(plan.passes.len() - 1),
            TourMove::Step(word) => plan.passes.iter().position(|pass| pass.name.contains(word)),
            _ => step,
        };
    }
    step
}

#[test]
fn every_stop_of_a_tour_shows_what_it_says() {
    let mut session = session();
    let mut frames: BTreeMap<(&str, &str), (Scene, Capture, FramePlan)> = BTreeMap::new();
    let mut checked = 0;
    for tour in &TOURS {
        let mut step = 0;
        for (index, stop) in tour.stops.iter().enumerate() {
            let (name, technique) = (scene_at(tour, index), stop.technique(tour));
            let (scene, capture, plan) = frames.entry((name, technique.name())).or_insert_with(|| {
                let scene = opened(name);
                let (capture, plan) = session.capture_with_plan(&scene, &request(technique, SIZE)).expect("a capture");
                let capture = session.judged(&scene, &capture, &Progress::default()).expect("a truth");
                (scene, capture, plan)
            });
            let place = format!("tour of {}, {}", tour.technique.name(), stop.title);
            step = step_at(stop, plan, step).unwrap_or_else(|| panic!("{place}: there is no such step"));
            let shown = Shown { scene, capture, plan, step };
            let claims: Vec<_> =
                CLAIMS.iter().filter(|(of, title, ..)| *of == tour.technique && *title == stop.title).collect();
            assert!(!claims.is_empty(), "{place}: nothing of it is held");
            for (_, _, words, check) in claims {
                assert!(stop.text.contains(words), "{place}: it does not say \"{words}\" any more");
                assert!(check(&shown), "{place}: it is not so that \"{words}\"");
                checked += 1;
            }
            for go in stop.go {
                let is_there = match go {
                    TourMove::PickShadow => shown.labels(1) > 0,
                    TourMove::PickLit => shown.labels(0) > 0,
                    TourMove::Picture(PictureKind::Stencil) => {
                        capture.frame_at(step).is_some_and(|frame| frame.stencil.is_some())
                    }
                    TourMove::Picture(PictureKind::Map) => capture.lights.iter().any(|light| light.map.is_some()),
                    _ => true,
                };
                assert!(is_there, "{place}: {go:?} finds nothing");
            }
        }
    }
    assert_eq!(checked, CLAIMS.len(), "a claim of no stop");
}

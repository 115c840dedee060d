//! The stops of the guided tours: what each says is compared with the frame that it shows. The words that are checked
//! stand here too, so that others are found.

use super::guided::{Guided, SIZE};
use super::purposes::steps;
use crate::common::{opened, pixels, stencil};
use glam::{DVec3, DVec4};
use std::collections::BTreeSet;
use stencilscope::accuracy::Finding;
use stencilscope::capture::{Capture, CapturedMap, CapturedTruth};
use stencilscope::inspector::{TOURS, TourClaim, TourMove};
use stencilscope::plan::{DecidedBy, Draw, DrawPart, FramePlan, Pass, Program, Visibility};
use stencilscope::reading::pick_ray;
use stencilscope::scene::{Object, Scene};
use stencilscope::technique::Technique;
use stencilscope::truth::PixelLabel;
use wgpu::{CompareFunction, StencilOperation};

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

    /// The points of the surfaces at the pixels with this label of the first light.
    fn surfaces(&self, label: u8) -> Vec<DVec3> {
        let shadow = self.capture.lights[0].shadow.as_ref().expect("labels");
        let is_it = |at: &[u32; 2]| shadow.byte_at(*at) == Some(label);
        pixels(SIZE).filter(is_it).filter_map(|at| pick_ray::surface(self.capture, at)).collect()
    }

    /// The labels of the truth at the pixels with this finding, under the first light.
    fn labels_of(&self, finding: Finding) -> BTreeSet<u8> {
        self.pixels_of(finding).iter().filter_map(|at| self.truth().labels.byte_at(*at)).collect()
    }

    fn pixels_of(&self, finding: Finding) -> Vec<[u32; 2]> {
        let is_it = |at: &[u32; 2]| self.truth().findings.byte_at(*at) == Some(finding as u8);
        pixels(SIZE).filter(is_it).collect()
    }

    fn truth(&self) -> &CapturedTruth {
        self.capture.lights[0].truth.as_ref().expect("a truth")
    }

    fn stencil(&self) -> Vec<u8> {
        stencil(self.capture.frame_at(self.step).expect("a frame"))
    }

    /// All sides count on that side of the surface: up where the ray enters it from there, and down where it leaves.
    fn count(&self, in_front: bool) -> bool {
        let sides: Vec<_> = self.draws().iter().filter(|draw| draw.part == DrawPart::Side).filter_map(steps).collect();
        let by = if in_front { (1, -1) } else { (-1, 1) };
        every(sides, |one| one.is_in_front == in_front && (one.outside, one.inside) == by)
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

/// There are some, and all of them are so: what is said of nothing is not true.
fn every<T>(items: impl IntoIterator<Item = T>, is_so: impl Fn(&T) -> bool) -> bool {
    let found: Vec<bool> = items.into_iter().map(|item| is_so(&item)).collect();
    !found.is_empty() && found.into_iter().all(|is_so| is_so)
}

/// The world's distance between the middles of two neighbouring texels in the middle of a map, on a plane across the
/// light's way at a depth as the map stores it.
fn texel_width(map: &CapturedMap, depth: f64) -> f64 {
    let world_from_clip = (map.clip_from_light[0] * map.light_from_world).inverse();
    let across = 2.0 / f64::from(map.faces[0].size()[0]);
    let [a, b] = [0.0, across].map(|x| world_from_clip * DVec4::new(x, 0.0, depth, 1.0)).map(|at| at.truncate() / at.w);
    (a - b).length()
}

type Claim = (Technique, &'static str, &'static str, fn(&Shown) -> bool);

/// By tour, title and words of a stop.
const CLAIMS: &[Claim] = &[
    (Technique::None, "Ambient light and depth", "The first pass draws every surface in a little light", |shown| {
        let is_ambient = |draw: &Draw| matches!(draw.program, Program::Ambient { .. }) && draw.raster.depth_write;
        shown.step == 0 && every(shown.draws(), |draw| is_ambient(draw))
    }),
    (Technique::None, "How far everything is", "only the nearest surface takes light or shadow", |shown| {
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
        every(shown.draws(), |draw| is_once(draw)) && shown.stencil().iter().any(|byte| byte % 2 == 1)
    }),
    (
        Technique::Planar,
        "One pixel, event by event",
        "the receiver marks it, a flattened triangle passes the test and raises it",
        |shown| {
            let before = &shown.plan.passes[shown.step - 1].draws;
            let all = |draws: &[Draw], does| every(draws, |draw| draw.raster.face(true).0.pass_op == does);
            all(before, StencilOperation::Replace) && all(shown.draws(), StencilOperation::IncrementClamp)
        },
    ),
    (Technique::Planar, "Where it is right", "all that is darkened here is flat", |shown| {
        // The floor of rings is at height 0.
        every(shown.surfaces(1), |at| at.y.abs() < 2e-3)
    }),
    (Technique::Planar, "The anti-shadow", "the hatched pixels are dark and should be lit", |shown| {
        shown.wrong()[0] > 100 && shown.wrong()[1] == 0
    }),
    (Technique::Planar, "Shadows on what is not flat", "on the balls they are missing", |shown| {
        let balls = || shown.scene.objects.iter().filter(|object| object.name.contains("ball"));
        let is_on = |at: DVec3, ball: &Object| {
            let places =
                ball.mesh.positions().iter().map(|place| ball.pose.world_from_object().transform_point3(*place));
            let (low, high) = places.fold((at, at), |(low, high), place| (low.min(place), high.max(place)));
            low.cmplt(at).all() && high.cmpgt(at).all()
        };
        let missing = shown.pixels_of(Finding::MissingShadow);
        let surfaces = missing.into_iter().filter_map(|at| pick_ray::surface(shown.capture, at));
        surfaces.filter(|at| balls().any(|ball| is_on(*at, ball))).count() > 50
    }),
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
    (Technique::ZPass, "Seen from beside", "z-pass draws no more than these sides", |shown| {
        every(shown.draws().iter().filter(|draw| draw.part.is_of_volume()), |draw| draw.part == DrawPart::Side)
    }),
    (Technique::ZPass, "The count of one pixel", "a back face takes 1 away, where the ray leaves it again", |shown| {
        shown.count(true)
    }),
    (Technique::ZPass, "Where it fails", "the eye is inside a volume, and the near plane cuts others", |shown| {
        shown.scene.name == "inside" && shown.wrong().iter().sum::<u64>() > 0
    }),
    (Technique::ZPass, "Held against the truth", "The hatched pixels are wrong", |shown| {
        shown.wrong().iter().sum::<u64>() > 0
    }),
    (Technique::ZPass, "The fix: count from the other end", "The same scene, and no pixel is wrong", |shown| {
        shown.capture.technique == "z-fail" && shown.scene.name == "inside" && shown.wrong() == [0, 0]
    }),
    (Technique::ZFail, "What every pixel shows", "First the scene is drawn in ambient light", |shown| {
        shown.step == 0 && every(shown.draws(), |draw| draw.raster.depth_write)
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
            every(shown.draws().iter().filter(|draw| draw.part == DrawPart::Side), |draw| {
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
        every(tested, |draw| {
            draw.raster.stencil_reference == 0 && draw.raster.face(true).0.compare == CompareFunction::Equal
        })
    }),
    (Technique::ZFail, "What a cap is", "The light cap closes it at the caster, which it tints yellow", |shown| {
        let casters = |part: DrawPart| shown.draws().iter().filter(|draw| draw.part == part).count();
        casters(DrawPart::LightCap) > 0 && casters(DrawPart::LightCap) == casters(DrawPart::DarkCap)
    }),
    (Technique::ZFail, "No wrong pixel", "surfaces turned away from the light, and the background", |shown| {
        let left_out = shown.labels_of(Finding::NotCompared);
        let are_dark_anyway = [PixelLabel::Background, PixelLabel::FacesAway].map(|label| label as u8);
        left_out.contains(&(PixelLabel::FacesAway as u8)) && every(left_out, |label| are_dark_anyway.contains(label))
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
            let caps = shown.draws().iter().filter(is_cap);
            !in_front.is_empty() && caps.into_iter().all(|draw| !in_front.contains(&draw.caster))
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
    (
        Technique::ShadowMap,
        "Texel and pixel, linked",
        "the farther from the light, the larger the piece of surface that shares one texel",
        // Of what the map stores, reversed depth: the nearest has the largest.
        |shown| {
            let map = shown.capture.lights[0].map.as_ref().expect("a map");
            let face = &map.faces[0];
            let stored =
                pixels(face.size()).filter_map(|at| face.depth_at(at)).filter(|depth| *depth > 0.0).map(f64::from);
            let (far, near) = stored.fold((1.0_f64, 0.0_f64), |(far, near), depth| (far.min(depth), near.max(depth)));
            near > far && texel_width(map, far) > 1.05 * texel_width(map, near)
        },
    ),
    (Technique::ShadowMap, "No bias: acne", "Here both bias settings are 0", |shown| {
        let maps = shown.all_draws().filter(|draw| draw.part == DrawPart::Map);
        let bias = |draw: &Draw| (draw.raster.depth_bias.constant, draw.raster.depth_bias.slope_scale);
        maps.clone().count() > 0 && maps.clone().all(|draw| bias(draw) == (0, 0.0)) && shown.wrong()[0] > 1000
    }),
    (Technique::ShadowMap, "The other faces", "the map has the faces that are turned away from the light", |shown| {
        let maps = shown.all_draws().filter(|draw| draw.part == DrawPart::Map);
        every(maps, |draw| draw.raster.cull == Some(wgpu::Face::Front))
    }),
    (Technique::ShadowMap, "Too much bias", "near its caster the shadow is missing", |shown| shown.wrong()[1] > 100),
    (Technique::ShadowMap, "Its error", "Here the map has 256 texels a side", |shown| {
        shown.capture.lights[0].map.as_ref().is_some_and(|map| map.faces[0].size() == [256, 256])
    }),
    (
        Technique::Projective,
        "A slide of each caster",
        "Each caster is drawn in black, or in its colour where it is glass",
        |shown| {
            let casters: BTreeSet<_> =
                shown.scene.objects.iter().filter(|object| object.casts).map(|one| &one.name).collect();
            let names = &shown.plan.lights[0].map.as_ref().expect("slides").layer_names;
            every(names, |name| casters.contains(*name))
                && shown.capture.lights[0].map.as_ref().is_some_and(|map| map.holds_colors())
        },
    ),
    (Technique::Projective, "Thrown over the scene", "Every surface in the slide's beam is looked up in it", |shown| {
        shown.lights_by(Visibility::Projected) && shown.labels(1) > 0
    }),
    (Technique::Projective, "What it can't know", "Nor can a caster shadow itself", |shown| {
        // A caster's own layer is left out of its look-up.
        let mut lit = shown.all_draws().filter(|draw| draw.program == Program::Light(Visibility::Projected));
        lit.any(|draw| draw.constants.layer.is_some())
    }),
    (Technique::RayTraced, "A ray for every pixel", "From each surface point a ray goes to the light", |shown| {
        shown.pass().image.is_some()
    }),
    (Technique::RayTraced, "Edges", "The rays' own mask has no such pixel", |shown| {
        let error = shown.capture.error().expect("a truth");
        error.compared > 0 && error.edge_band == 0 && shown.pixels_of(Finding::Agrees).len() as u64 == error.compared
    }),
    (Technique::RayTraced, "Umbra alone", "each pixel is lit or dark, and nothing lies between", |shown| {
        let lights = &shown.capture.lights;
        // Shares of a light would be stored as such.
        let has_shares = lights.iter().any(|light| light.visibility.is_some());
        let is_point_or_direction = |light: &stencilscope::scene::Light| [0.0, 1.0].contains(&light.position.w);
        !has_shares && every(&shown.scene.lights, |light| is_point_or_direction(light)) && shown.labels(0) > 0
    }),
    (Technique::RayTraced, "What it costs", "sets every technique's wrong pixels beside its milliseconds", |shown| {
        shown.wrong() == [0, 0]
    }),
];

/// Does a claim hold of what a stop shows, with this pixel picked?
fn holds(claim: TourClaim, shown: &Shown, pick: Option<[u32; 2]>) -> bool {
    let [false_shadow, missing_shadow] = shown.wrong();
    let light = &shown.capture.lights[0];
    let label = || light.shadow.as_ref()?.byte_at(pick?);
    let error = || shown.capture.error().expect("a truth");
    match claim {
        TourClaim::NoneWrong => false_shadow + missing_shadow == 0 && error().compared > 0,
        TourClaim::FalseShadow => false_shadow > 0,
        TourClaim::MissingShadow => missing_shadow > 0,
        TourClaim::NoFalseShadow => false_shadow == 0,
        TourClaim::FewWrong(share) => (false_shadow + missing_shadow) * 10_000 <= error().compared * share,
        TourClaim::PickIsWrong => {
            let finding = || Finding::from_byte(light.truth.as_ref()?.findings.byte_at(pick?)?);
            finding().is_some_and(Finding::is_wrong)
        }
        TourClaim::PickIsDark => label() == Some(1),
        TourClaim::PickIsLit => label() == Some(0),
        TourClaim::Draws(part) => shown.draws().iter().any(|draw| draw.part == part),
        TourClaim::LacksPart(part) => !shown.has(part),
        TourClaim::StencilIsSet => shown.stencil().iter().any(|byte| *byte != 0),
    }
}

#[test]
fn every_stop_of_a_tour_shows_what_it_says() {
    let mut guided = Guided::new();
    let mut checked = 0;
    let mut wrong = Vec::new();
    for tour in &TOURS {
        for (index, stop) in tour.stops.iter().enumerate() {
            guided.go_to(tour, index);
            let (capture, plan) = guided.frame();
            let model = &guided.inspector.model;
            let place = format!("tour of {}, {}", tour.technique.name(), stop.title);
            assert_eq!(capture.technique, stop.technique(tour).name(), "{place}");
            assert_eq!(capture.settings, *stop.choice(tour).settings(), "{place}");
            let (step, pick) = (model.selection.step, model.selection.pick);
            let scene = opened(&capture.scene);
            let shown = Shown { scene: &scene, capture: &capture, plan: &plan, step };
            let claims: Vec<_> =
                CLAIMS.iter().filter(|(of, title, ..)| *of == tour.technique && *title == stop.title).collect();
            if claims.is_empty() && stop.claims.is_empty() {
                wrong.push(format!("{place}: nothing of it is held"));
            }
            for (_, _, words, check) in claims {
                checked += 1;
                if !stop.text.contains(words) {
                    wrong.push(format!("{place}: it does not say \"{words}\" any more"));
                } else if !check(&shown) {
                    wrong.push(format!("{place}: it is not so that \"{words}\""));
                }
            }
            let untrue = stop.claims.iter().filter(|claim| !holds(**claim, &shown, pick));
            wrong.extend(untrue.map(|claim| format!("{place}: {claim:?} is not so, {:?}, {pick:?}", shown.wrong())));
            for go in stop.go {
                let is_there = match go {
                    TourMove::PickShadow => label_of(&capture, pick) == Some(1),
                    TourMove::PickLit => label_of(&capture, pick) == Some(0),
                    TourMove::Step(word) => capture.steps[step].name.contains(word),
                    TourMove::Picture(kind) => guided.inspector.picture_kind() == Some(*kind),
                    _ => true,
                };
                if !is_there {
                    wrong.push(format!("{place}: {go:?} finds nothing"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert_eq!(checked, CLAIMS.len(), "a claim of no stop");
}

fn label_of(capture: &Capture, pick: Option<[u32; 2]>) -> Option<u8> {
    capture.lights[0].shadow.as_ref()?.byte_at(pick?)
}

//! Scenes, settings and plans in which one thing is wrong, from a seed.

use super::faults;
use super::occasions::occasion;
use super::scenes::{self, Dice};
use crate::common::choice;
use crate::common::random::Random;
use glam::DVec3;
use stencilscope::diagnosis::Cause;
use stencilscope::plan::{DrawPart, FramePlan};
use stencilscope::scene::{Light, Scene};
use stencilscope::technique::{Choice, Technique};

/// Something wrong in a plan.
pub type PlanFault = Box<dyn Fn(&mut FramePlan)>;

/// A frame with one known cause of wrong pixels.
pub struct Provocation {
    pub cause: Cause,
    pub scene: Scene,
    pub choice: Choice,
    pub fault: Option<PlanFault>,
}

/// The causes that came later than the others, whose scenes they must not change.
const LATER: [Cause; 12] = [
    Cause::TJunction,
    Cause::Mirrored,
    Cause::MapNearPlane,
    Cause::MapFarPlane,
    Cause::F32World,
    Cause::RasteriserPrecision,
    Cause::MapSwims,
    Cause::MapSeam,
    Cause::ReceiverLeftOut,
    Cause::OpaqueShadow,
    Cause::DoubleLighting,
    Cause::DepthPrecision,
];

/// The number of a cause's scenes.
fn number(cause: Cause) -> u64 {
    let later = LATER.iter().position(|later| *later == cause);
    let earlier = || Cause::ALL.into_iter().filter(|other| !LATER.contains(other)).position(|other| other == cause);
    later.map(|place| 1000 + place).or_else(earlier).expect("a cause") as u64
}

/// A scene and choice in which a cause occurs, one way or another for each seed.
pub fn provoke(cause: Cause, seed: u64) -> Provocation {
    let dice = &mut Dice(Random::new(seed.wrapping_mul(64) + number(cause) + 1));
    let facing = [("casters", "light-facing")];
    let (scene, choice, fault): (Scene, Choice, Option<PlanFault>) = match cause {
        Cause::EyeInVolume => (scenes::eye_in_shadow(dice), choice(Technique::ZPass, &[]), None),
        Cause::NearPlaneCut => (scenes::near_in_shadow(dice), choice(Technique::ZPass, &[]), None),
        Cause::NearPlaneCrack => (scenes::near_through_roof(dice), choice(Technique::ZPassPlus, &[]), None),
        Cause::MissingDarkCap => {
            (scenes::beside_the_lamp(dice), choice(Technique::ZFail, &[]), Some(faults::without(DrawPart::DarkCap)))
        }
        Cause::MissingLightCap => {
            (dice.any_scene(), choice(Technique::ZFail, &[]), Some(faults::without(DrawPart::LightCap)))
        }
        Cause::FarClip => (dice.any_scene(), choice(Technique::ZFail, &[("depth", "standard-finite")]), None),
        Cause::FiniteExtrusion => {
            let reach = format!("finite:{:.2}", dice.between(0.05, 0.2));
            (dice.any_scene(), choice(Technique::ZFail, &[("extrusion", &reach)]), None)
        }
        Cause::OpenMesh => {
            let open = scenes::open_box(dice);
            let fault = (dice.one_of(2) == 1).then(faults::textbook_silhouettes);
            (dice.with(open), choice(Technique::ZFail, &facing), fault)
        }
        Cause::NonManifold => {
            let mesh = scenes::walled_box(dice);
            (dice.with(mesh), choice(Technique::ZFail, &facing), Some(faults::textbook_silhouettes()))
        }
        Cause::InconsistentWinding => {
            let mesh = dice.closed();
            let mut scene = dice.with(mesh);
            let light = scene.lights[0].homogeneous().truncate();
            scenes::flip_some(&mut scene.objects[1], light, dice.between(0.2, 0.6));
            (scene, choice(Technique::ZFail, &facing), None)
        }
        Cause::SplitVertices => {
            let mesh = dice.seams(0.0).build_unwelded().expect("a mesh");
            (dice.with(mesh), choice(Technique::ZFail, &facing), Some(faults::textbook_silhouettes()))
        }
        Cause::NearVertices => {
            let mesh = dice.seams(2e-8).build().expect("a mesh");
            (dice.with(mesh), choice(Technique::ZFail, &facing), Some(faults::textbook_silhouettes()))
        }
        Cause::LightInside => {
            let mut scene = dice.still_life();
            let [x, y, z] = scene.lights[0].position.truncate().to_array();
            scene.objects.push(scenes::cuboid("lantern", [x, y, z], [dice.between(0.3, 0.5); 3]));
            (scene, choice(Technique::ZFail, &facing), None)
        }
        Cause::Clamped => (
            scenes::before_many(dice),
            choice(Technique::ZFail, &[("operations", "clamp"), ("faces", "two-pass")]),
            None,
        ),
        Cause::Wrap256 => (scenes::under_panes(dice, 256), choice(Technique::ZFail, &[]), None),
        Cause::LightNotAdded => (
            dice.any_scene(),
            choice(Technique::ZFail, &[("extrusion", "finite:100"), ("far-vertices", "from-origin")]),
            None,
        ),
        Cause::CarriedInF32 => {
            (scenes::lamp_on_a_sheet(dice), choice(Technique::ZFail, &[("extruded-by", "vertex-shader")]), None)
        }
        Cause::FewBits => {
            let bits = dice.one_of(3);
            let count = [2, 4, 16][bits];
            (
                scenes::under_panes(dice, count),
                choice(Technique::ZFail, &[("stencil-bits", ["1", "2", "4"][bits])]),
                None,
            )
        }
        Cause::Parity => (scenes::under_panes(dice, 2), choice(Technique::ZFail, &[("operations", "invert")]), None),
        Cause::EdgeSmear => {
            (scenes::lone_sphere(dice), choice(Technique::Projective, &[("size", "2048"), ("border", "off")]), None)
        }
        Cause::OperationOrder => (dice.any_scene(), choice(Technique::ZFail, &[("operations", "clamp")]), None),
        Cause::CapFighting => (dice.any_scene(), choice(Technique::ZFail, &[]), Some(faults::flipped_caps())),
        Cause::DoubleBlend => (scenes::flat_scene(dice), choice(Technique::Planar, &[("blend", "twice")]), None),
        Cause::DoubleLighting => {
            (scenes::tile_in_the_floor(dice), choice(Technique::ZFail, &[("relight", "unguarded")]), None)
        }
        Cause::OpaqueShadow => (scenes::flat_scene(dice), choice(Technique::Planar, &[("blend", "opaque")]), None),
        Cause::ZFighting => (scenes::flat_scene(dice), choice(Technique::Planar, &[("z-fighting", "none")]), None),
        Cause::OffReceiver => (scenes::over_a_table(dice), choice(Technique::Planar, &[("stencil", "off")]), None),
        Cause::AntiShadow => (scenes::beyond_the_lamp(dice), choice(Technique::Planar, &[("clip", "off")]), None),
        Cause::FalseShadow => (scenes::through_the_floor(dice), choice(Technique::Planar, &[("clip", "off")]), None),
        Cause::NotPlanar => {
            let technique = [Technique::Planar, Technique::PlanarTexture][dice.one_of(2)];
            (scenes::round_receiver(dice), choice(technique, &[]), None)
        }
        // The floor alone, with its shadow, and what stands on it without.
        Cause::ReceiverLeftOut => {
            (scenes::shelf_over_box(dice), choice(Technique::Planar, &[("receivers", "largest:1")]), None)
        }
        Cause::Acne => {
            (dice.any_scene(), choice(Technique::ShadowMap, &[("bias-constant", "0"), ("bias-slope", "0")]), None)
        }
        Cause::PeterPanning => {
            let slope = format!("{:.0}", dice.between(100.0, 400.0));
            (dice.any_scene(), choice(Technique::ShadowMap, &[("bias-slope", &slope)]), None)
        }
        Cause::MapFacesCulled => (scenes::under_a_pane(dice), choice(Technique::ShadowMap, &[("cull", "front")]), None),
        Cause::Aliasing => {
            let size = ["16", "32", "64"][dice.one_of(3)];
            let technique = [Technique::ShadowMap, Technique::Projective, Technique::PlanarTexture][dice.one_of(3)];
            (scenes::lone_sphere(dice), choice(technique, &[("size", size)]), None)
        }
        Cause::OutsideMap => {
            let factor = dice.between(1.6, 3.0);
            (dice.any_scene(), choice(Technique::ShadowMap, &[]), Some(faults::narrowed_map(factor)))
        }
        Cause::MapNearPlane => {
            (scenes::box_under_lamp(dice), choice(Technique::ShadowMap, &[("light-frustum", "100:2.6:9")]), None)
        }
        Cause::MapFarPlane => {
            (scenes::box_under_lamp(dice), choice(Technique::ShadowMap, &[("light-frustum", "100:0.1:1.2")]), None)
        }
        Cause::MapSeam => (
            scenes::posts_in_a_room(dice),
            choice(Technique::ShadowMap, &[("filter", "pcf:9"), ("size", "256"), ("bias-slope", "8")]),
            None,
        ),
        Cause::MapSwims => {
            let mut scene = dice.still_life();
            scene.lights = vec![Light::directional([dice.between(-0.5, 0.5), 1.0, dice.between(-0.5, 0.5)])];
            (scene, choice(Technique::ShadowMap, &[("light-frustum", "view"), ("size", "2048")]), None)
        }
        Cause::TJunction => {
            let mesh = scenes::box_with_t_junctions(dice);
            (dice.with(mesh), choice(Technique::ZFail, &[("silhouette", "shared-corners")]), None)
        }
        Cause::Mirrored => (
            scenes::one_behind_the_other(dice),
            choice(Technique::ZFail, &[("mirrored", "kept"), ("casters", "all")]),
            None,
        ),
        Cause::F32World => {
            let by = DVec3::new(dice.between(3e5, 6e5), 0.0, dice.between(-6e5, -3e5));
            (scenes::moved(dice.still_life(), by), choice(Technique::ZFail, &[("world", "f32")]), None)
        }
        Cause::DepthPrecision => (scenes::coarse_depth(dice), choice(Technique::ZFail, &[("depth-bits", "16")]), None),
        Cause::ReverseProjection => {
            (scenes::wall_behind_lamp(dice), choice(Technique::Projective, &[("reverse", "on")]), None)
        }
        Cause::Between => (scenes::shelf_between(dice), choice(Technique::Projective, &[("size", "2048")]), None),
        Cause::SelfShadow => (scenes::ring_alone(dice), choice(Technique::Projective, &[("size", "2048")]), None),
        Cause::SubpixelEdges => (scenes::far_mesh(), choice(Technique::ZFail, &[]), None),
        Cause::F32Limit => (scenes::low_sun(dice), choice(Technique::ZFail, &[]), None),
        cause => panic!("no scene shows {cause}: {:?}", occasion(cause)),
    };
    let mut scene = scene;
    // A floor is a mesh with an edge too, and a silhouette that falls on what stands on it.
    let is_light_facing = choice.settings().get("casters").is_some_and(|casters| casters == "light-facing");
    if is_light_facing || choice.technique() == Technique::Projective {
        scene.objects[0].casts = false;
    }
    Provocation { cause, scene, choice, fault }
}

//! Depth mappings: five ways to store distance, and what each loses.

use super::{SIZE, capture, over_floor, request, unseen, wrong};
use crate::common::{adapter, from_above, judged_by, label_counts, last_frame, opened, session, square};
use stencilscope::math::DepthBits;
use stencilscope::math::depth::DepthMapping;
use stencilscope::technique::Technique;

/// All techniques that are exact on a square over a floor, and what makes the textures fine enough.
const EXACT: [(Technique, &[(&str, &str)]); 7] = [
    (Technique::Planar, &[]),
    (Technique::PlanarTexture, &[("size", "1024")]),
    (Technique::ZPass, &[]),
    (Technique::ZPassPlus, &[]),
    (Technique::ZFail, &[]),
    (Technique::ShadowMap, &[]),
    (Technique::Projective, &[]),
];

/// Of half-width 1 at height 2, halfway to the light: a shadow of half-width 2, 40 × 40 pixels. A far
/// plane just behind the floor leaves of the floor's own volume only the light cap, which counts
/// −1 everywhere.
#[test]
fn labels_do_not_depend_on_the_mapping_but_for_volumes_that_far_clips() {
    let mut session = session();
    let scene = over_floor(12.0, vec![unseen(square("caster", 0.0, 1.0), [0.0, 2.0, 0.0])]);
    for (technique, settings) in EXACT {
        for mapping in DepthMapping::ALL {
            let settings = [settings, &[("depth", mapping.name())]].concat();
            let counts = label_counts(&capture(&mut session, &scene, technique, &settings));
            let is_clipped = technique == Technique::ZFail && mapping == DepthMapping::StandardFinite;
            let expected = if is_clipped { [0, 40_000, 0, 0] } else { [38_400, 1600, 0, 0] };
            assert_eq!(counts, expected, "{technique:?} {mapping:?}");
        }
    }
}

/// Flooring keeps order, so the nearest surface's floored depth is what fewer bits leave at every pixel: floor(s z) of
/// the float, and that integer over s to the float's last place.
#[test]
fn fewer_bits_store_the_floor_of_each_depth() {
    let mut session = session();
    let (mut pixels, mut coarser) = (0, 0);
    for builtin in stencilscope::scene::builtin::ALL {
        let scene = builtin.scene().expect("a scene");
        for (technique, mapping) in [(Technique::None, "reversed-infinite"), (Technique::ZFail, "standard-finite")] {
            let mut depths = |bits: &str| {
                let settings = [("depth", mapping), ("depth-bits", bits)];
                let capture = capture(&mut session, &scene, technique, &settings);
                capture.frame_at(0).expect("a frame").depth.image.clone()
            };
            let floats = depths("32");
            for bits in [DepthBits::SIXTEEN, DepthBits::TWENTY_FOUR] {
                let steps = f64::from(bits.steps());
                let stored = depths(&bits.to_string());
                for y in 0..SIZE[1] {
                    for x in 0..SIZE[0] {
                        let [float, stored] = [&floats, &stored].map(|image| image.depth_at([x, y]).expect("a depth"));
                        let whole = (f64::from(float) * steps).floor();
                        let place = format!("{} {mapping} {bits} at {x}, {y}", builtin.name);
                        assert_eq!((f64::from(stored) * steps).round(), whole, "{place}");
                        assert!(
                            (f64::from(stored) - whole / steps).abs() <= f64::from(stored.next_up() - stored),
                            "{place}"
                        );
                        assert_eq!(stored, bits.floored(float));
                        (pixels, coarser) = (pixels + 1, coarser + u64::from(stored != float));
                    }
                }
            }
        }
    }
    assert!(coarser > pixels / 2, "{coarser} of {pixels}");
}

/// The biases of a shadow map: the rasteriser adds the slope's to the depth that the fragment shader floors, and the shader a
/// constant of so many steps. A map of floats with the slope's bias alone says what must be floored.
#[test]
fn a_map_of_fewer_bits_is_floored_after_both_biases() {
    let mut session = session();
    let scene = opened("tori");
    let mut map = |bits: &str, slope: &str, constant: &str| {
        let settings = [("size", "128"), ("depth-bits", bits), ("bias-slope", slope), ("bias-constant", constant)];
        let found = capture(&mut session, &scene, Technique::ShadowMap, &settings);
        found.lights[0].map.as_ref().expect("a map").faces.clone()
    };
    let texels = |image: &stencilscope::capture::Image| {
        let [width, height] = image.size();
        let places = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        places.map(|at| image.depth_at(at).expect("a depth")).collect::<Vec<f32>>()
    };
    let unbiased = map("32", "0", "0");
    for bits in [DepthBits::SIXTEEN, DepthBits::TWENTY_FOUR] {
        for (slope, constant) in [("0", "0"), ("0", "3"), ("2", "0"), ("2", "3"), ("7.5", "1")] {
            let floats = map("32", slope, "0");
            let floored = map(&bits.to_string(), slope, constant);
            // Depth is reversed, so that biases lessen it; a step is 1 / 2^bits.
            let lessened = constant.parse::<f32>().expect("a number") / (bits.steps() + 1) as f32;
            let (mut biased, mut drawn) = (0, 0);
            for ((floats, floored), unbiased) in floats.iter().zip(&floored).zip(&unbiased) {
                for ((float, stored), unbiased) in texels(floats).into_iter().zip(texels(floored)).zip(texels(unbiased))
                {
                    // Where nothing is drawn, depth is cleared.
                    if float == 0.0 {
                        continue;
                    }
                    let expected = bits.floored(float - lessened);
                    assert_eq!(stored, expected, "{bits} bits, slope {slope}, constant {constant}: {float}");
                    (drawn, biased) = (drawn + 1, biased + usize::from(float != unbiased));
                }
            }
            assert!(drawn > 1000, "{drawn}");
            assert_eq!(biased > drawn / 2, slope != "0", "{biased} of {drawn}");
        }
    }
}

/// Surfaces of one depth are lit once each: the light pass counts in the stencil wherever depths are floored.
#[test]
fn surfaces_that_fewer_bits_make_equal_are_lit_once() {
    let mut session = session();
    // A hundredth of a millimetre over the floor, where a step of 16 bits is a quarter of a metre.
    let scene = from_above(vec![square("sheet", 1e-5, 1.0)]);
    for technique in [Technique::None, Technique::RayTraced] {
        let mut red = |bits| {
            let found = capture(&mut session, &scene, technique, &[("depth-bits", bits)]);
            last_frame(&found).color.image.rgba_at([100, 100]).expect("a pixel")[0]
        };
        assert_eq!(red("16"), red("32"), "{technique:?}");
    }
}

/// What lies between eye and near plane is not drawn, also where clamped depth clips nothing there.
#[test]
fn nothing_nearer_than_the_near_plane_is_drawn() {
    let mut session = session();
    let near_eye = square("near", 9.95, 0.02);
    let scene = from_above(vec![near_eye]);
    let [plain, clamped] = ["reversed-infinite", "standard-finite-clamp"].map(|depth| {
        let capture = capture(&mut session, &scene, Technique::None, &[("depth", depth)]);
        let frame = capture.frame_at(0).expect("a frame").clone();
        let distance = |[x, y]: [u32; 2]| capture.depth.distance(frame.depth.image.depth_at([x, y]).expect("a depth"));
        [[100, 100], [20, 30]].map(|at| distance(at).expect("a surface"))
    });
    for (plain, clamped) in plain.into_iter().zip(clamped) {
        assert!((plain - 10.0).abs() < 1e-4 && (clamped - 10.0).abs() < 1e-3, "{plain} {clamped}");
    }
}

/// The far plane that a finite mapping is given cuts surfaces as well.
#[test]
fn a_far_plane_of_the_camera_hides_what_is_beyond_it() {
    let mut session = session();
    let mut scene = from_above(vec![square("caster", 2.0, 1.0)]);
    scene.camera.far = Some(9.0);
    let counts = |session: &mut _, depth| label_counts(&capture(session, &scene, Technique::None, &[("depth", depth)]));
    for depth in ["standard-finite", "standard-finite-clamp"] {
        assert_eq!(counts(&mut session, depth)[2], u64::from(SIZE[0] * SIZE[1]) - 625, "{depth}");
    }
    assert_eq!(counts(&mut session, "standard-infinite")[2], 0);
}

/// The tweaked mapping stores infinity just before the end of depth; surfaces keep their order
/// whatever the epsilon.
#[test]
fn labels_do_not_depend_on_the_epsilon() {
    let mut session = session();
    let scene = from_above(vec![square("caster", 2.0, 1.0)]);
    for epsilon in ["0", "2.4e-7", "0.1"] {
        let settings = [("depth", "standard-infinite-epsilon"), ("epsilon", epsilon)];
        assert_eq!(wrong(&mut session, &scene, Technique::ZFail, &settings), [0, 0], "{epsilon}");
        let found = capture(&mut session, &scene, Technique::ZFail, &settings);
        assert_eq!(found.depth.offset, 1.0 - epsilon.parse::<f64>().expect("a number"));
    }
}

/// The count at the near plane and the count from there on must begin at one place, also where
/// clamped depth lets volumes reach nearer.
#[test]
fn z_pass_plus_holds_with_the_eye_inside_a_volume_under_every_mapping() {
    let mut session = session();
    let scene = opened("inside");
    for mapping in DepthMapping::ALL {
        let settings = [("depth", mapping.name())];
        let request = request(Technique::ZPassPlus, &settings);
        let capture = judged_by(&mut session, &scene, &request);
        adapter::assert_right(&mut session, &scene, &request, &capture, &mapping.name());
    }
}

//! The texels that `pixel` names for a light, compared with what `testing` reads and with the GPU's labels.

use crate::commands::{done, folder};
use crate::common::{choice, opened, pixels};
use serde_json::Value;
use std::sync::Arc;
use stencilscope::reading::fragments::SurfaceFragments;
use stencilscope::reading::texels_read::TexelReaders;
use stencilscope::reading::texture_decision::TextureDecision;
use stencilscope::technique::Technique;
use stencilscope::testing::{PixelLabel, Rendered};

const SIZE: [u32; 2] = [160, 120];

fn rendered(scene: &str, technique: Technique, settings: &[(&str, &str)]) -> Rendered {
    Rendered::new(&opened(scene), choice(technique, settings), SIZE).expect("a frame")
}

fn printed(arguments: &[&str]) -> String {
    let folder = folder();
    done(folder.path(), &[&["pixel"], arguments, &["--size", "160x120"]].concat())
}

fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&printed(&[arguments, &["--json"]].concat())).expect("JSON")
}

#[test]
fn pixel_names_the_texel_that_testing_reads_with_both_depths_bias_and_side() {
    for mapping in ["reversed-infinite", "standard-finite"] {
        let mut frame = rendered("table", Technique::ShadowMap, &[("depth", mapping)]);
        for label in [PixelLabel::Shadow, PixelLabel::Lit] {
            // Not the first: that one lies on an edge.
            let mask = frame.capture().lights[0].shadow.clone().expect("a mask");
            let found: Vec<[u32; 2]> = pixels(SIZE).filter(|at| mask.byte_at(*at) == Some(label as u8)).collect();
            let [x, y] = found[found.len() / 2];
            let expected = frame.at([x, y]).map_texel(0).expect("the map shows it");
            let depth = format!("depth={mapping}");
            let at = format!("{x},{y}");
            let asked = ["table", "-t", "shadow-map", "--set", &depth, "--at", &at];
            let document = json(&asked);
            crate::help::assert_json_is_explained("pixel", &document);
            let read = &document["texels"][0];
            assert_eq!((&read["kind"], read["face"].as_u64()), (&"shadow-map".into(), Some(expected.face as u64)));
            assert_eq!(read["texels"].as_array().map(Vec::len), Some(1), "no filter: one texel");
            let texel = &read["texels"][0];
            assert_eq!(texel["at"], serde_json::json!(expected.texel), "{mapping} {label:?}");
            let is_cleared = expected.gap.is_none();
            assert_eq!(texel["stored"].as_f64().map(|depth| depth as f32), (!is_cleared).then_some(expected.stored));
            let surface = texel["surface"].as_f64().expect("a depth");
            assert!((surface - expected.surface).abs() < 1e-5, "{surface} is not {}", expected.surface);
            if let Some(gap) = expected.gap {
                let metres = |key: &str| texel[key].as_f64().expect("metres");
                assert!((metres("surface_metres") - metres("stored_metres") - gap).abs() < 1e-3, "{texel}, gap {gap}");
            }
            let is_lit = label == PixelLabel::Lit;
            assert_eq!((texel["is_lit"].as_bool(), read["lit"].as_u64()), (Some(is_lit), Some(u64::from(is_lit))));
            let side = if mapping == "reversed-infinite" { "surface >= stored" } else { "surface <= stored" };
            assert_eq!(read["lit_where"], side);
            let bias = serde_json::json!({ "constant": 16, "slope": 2.0, "normal": 0.0, "receiver_plane": false });
            assert_eq!(read["bias"], bias);
            // The text has the same numbers.
            let story = printed(&asked);
            let stored = if is_cleared { "no caster".to_owned() } else { format!("{:?}", expected.stored) };
            let line = format!("texel {},{}: stored {stored}", expected.texel[0], expected.texel[1]);
            assert!(story.contains(&line), "`{line}` is not in\n{story}");
            for words in [format!("surface {:?}", surface as f32), format!("lit where {side}")] {
                assert!(story.contains(&words), "`{words}` is not in\n{story}");
            }
            assert!(story.contains("a bias of 16 steps and 2 texels of slope"), "{story}");
            assert!(story.contains(read["because"].as_str().expect("a sentence")), "{story}");
        }
    }
}

#[test]
fn every_texel_of_a_filter_is_read() {
    let asked = ["table", "-t", "shadow-map", "--set", "filter=pcf:6", "--at", "80,70"];
    let document = json(&asked);
    let read = &document["texels"][0];
    let texels = read["texels"].as_array().expect("texels");
    assert_eq!(texels.len(), 36);
    let lit = texels.iter().filter(|texel| texel["is_lit"] == true).count() as u64;
    assert_eq!(read["lit"].as_u64(), Some(lit));
    assert!(printed(&asked).contains("and 11 texels more"));
}

/// A scene, how it is drawn, and settings.
type Case = (&'static str, Technique, &'static [(&'static str, &'static str)]);

/// What textures are computed to let through decides as the GPU's labels do, but where rounding decides.
#[test]
fn what_textures_let_through_is_what_labels_say() {
    let cases: [Case; 5] = [
        ("table", Technique::PlanarTexture, &[]),
        ("two-lights", Technique::PlanarTexture, &[("size", "64")]),
        ("table", Technique::Projective, &[]),
        ("table", Technique::Projective, &[("fit", "off"), ("size", "64"), ("passes", "multi")]),
        ("two-lights", Technique::Projective, &[("border", "off"), ("reverse", "on")]),
    ];
    for (scene, technique, settings) in cases {
        let frame = rendered(scene, technique, settings);
        let (capture, plan) = (frame.capture(), Arc::new(frame.plan().clone()));
        let mut labels = [0_u32; 2];
        let mut off = 0;
        for light in 0..capture.lights.len() {
            let fragments = SurfaceFragments::new(capture, Some(&plan), light).expect("a picture");
            let mask = capture.lights[light].shadow.as_ref().expect("a mask");
            for pixel in pixels(SIZE) {
                let Some(found) = TextureDecision::of(capture, &fragments, light, pixel) else { continue };
                for layer in &found.layers {
                    let sum: f64 = layer.texels.iter().map(|texel| texel.share).sum();
                    assert!((sum - 1.0).abs() < 1e-9, "{layer:?}");
                }
                match mask.byte_at(pixel).and_then(PixelLabel::from_byte) {
                    Some(PixelLabel::Lit) => labels[0] += 1,
                    Some(PixelLabel::Shadow) => labels[1] += 1,
                    _ => continue,
                }
                off += u32::from(found.gpu_says.is_some());
            }
        }
        assert!(labels.iter().all(|count| *count > 100), "{scene} {settings:?}: {labels:?}");
        // A GPU weighs texels in steps of 1/256: at an edge that can be the other side of a half.
        assert!(off * 500 < labels[0] + labels[1], "{scene} {technique:?} {settings:?}: {off} of {labels:?}");
    }
}

#[test]
fn of_a_texture_pixel_lists_texels_with_their_weights_and_explains_each_key() {
    for (technique, kind) in [("planar-texture", "receiver-texture"), ("projective", "silhouettes")] {
        let mut frame = rendered("table", Technique::from_name(technique).expect("a technique"), &[]);
        let [x, y] = frame.first_labelled(0, PixelLabel::Shadow).expect("a shadow");
        frame.at([x, y]).label(0, PixelLabel::Shadow);
        let at = format!("{x},{y}");
        let document = json(&["table", "-t", technique, "--at", &at]);
        crate::help::assert_json_is_explained("pixel", &document);
        let read = &document["texels"][0];
        assert_eq!(read["kind"], kind);
        assert!(read["lets_through"][3].as_f64().is_some_and(|alpha| alpha < 0.5), "{read}");
        let story = printed(&["table", "-t", technique, "--at", &at]);
        for layer in read["layers"].as_array().expect("layers") {
            assert!(story.contains(&format!("{}: lets through", layer["name"].as_str().expect("a name"))), "{story}");
            for texel in layer["texels"].as_array().expect("texels") {
                let line = format!(
                    "texel {},{} weighs {:.3}",
                    texel["at"][0],
                    texel["at"][1],
                    texel["share"].as_f64().expect("a share")
                );
                assert!(story.contains(&line), "`{line}` is not in\n{story}");
            }
        }
    }
}

#[test]
fn where_no_texel_decides_there_is_none() {
    let frame = rendered("table", Technique::ZFail, &[]);
    let plan = Arc::new(frame.plan().clone());
    assert_eq!(TexelReaders::new(frame.capture(), &plan).at(frame.capture(), [80, 70]), [None]);
    assert_eq!(json(&["table", "-t", "z-fail", "--at", "80,70"])["texels"], serde_json::json!([null]));
    // Nor on a pixel without a surface.
    let background = json(&["triangle.obj", "--no-floor", "-t", "shadow-map", "--at", "0,0"]);
    assert_eq!(background["texels"], serde_json::json!([null]));
}

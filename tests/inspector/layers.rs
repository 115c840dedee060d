//! Textures of receivers and silhouettes of casters: colours in layers, where a shadow map has depths.

use super::by_hand::layered;
use super::*;

/// The tab of shadow maps is there whatever is shown.
fn says(harness: &Harness<Seen>, text: &str) -> bool {
    harness.query_all_by_label_contains(text).any(|node| node.accesskit_node().role() != Role::Tab)
}

#[test]
fn textures_are_colours_and_nothing_speaks_of_shadow_maps_or_metres() {
    let mut harness = harness(layered("planar-texture", "texture"));
    click_button(&mut harness, "Textures");
    assert_eq!(harness.state().inspector.picture_kind(), Some(PictureKind::Map));
    harness.get_by_label("textures of light 1 · 16×16 · Rgba8Unorm");
    harness.get_by_label("Light that arrives");
    // White: half of the first and the whole third; tinted: half a row; black: the rest.
    for (name, texels) in [("all of it", "384"), ("none of it", "376"), ("a part", "8")] {
        harness.get_by_label(name);
        harness.get_by_label(texels);
    }
    for word in ["hadow map", "Distance", "Linear", "Raw", " m "] {
        assert!(!says(&harness, word), "{word}");
    }
}

#[test]
fn layers_are_named_by_the_passes_that_drew_them() {
    let mut harness = harness(layered("planar-texture", "texture"));
    click_button(&mut harness, "Textures");
    harness.get_by_role_and_label(Role::Button, "Layer 3");
    click_button(&mut harness, "Texture of wall, flat piece 2");
    harness.get_by_label("textures of light 1: wall, flat piece 2 · 16×16 · Rgba8Unorm");
    harness.get_by_label("256");
    click(&mut harness, "Layer of the picture");
    harness.get_by_role_and_label(Role::Button, "texture of floor, flat piece 1");
    click_button(&mut harness, "layer 3");
    harness.get_by_label("textures of light 1: layer 3 · 16×16 · Rgba8Unorm");
    harness.get_by_label("not drawn: all light arrives");
    choose(&mut harness, "Layer of the picture", "All 3");
    harness.get_by_label("textures of light 1 · 16×16 · Rgba8Unorm");
}

#[test]
fn a_step_that_draws_a_layer_shows_it_and_the_step_after_what_was_shown_before() {
    let mut harness = harness(layered("projective", "silhouette"));
    press(&mut harness, Key::Home);
    harness.get_by_label_contains("silhouettes of light 1: floor, flat piece 1");
    press(&mut harness, Key::ArrowRight);
    harness.get_by_label_contains("silhouettes of light 1: wall, flat piece 2");
    assert!(says(&harness, "Silhouettes") && !says(&harness, "hadow map"));
    press(&mut harness, Key::End);
    assert_eq!(harness.state().inspector.picture_kind(), Some(PictureKind::Color));
}

#[test]
fn the_picked_texel_says_what_it_lets_through() {
    let mut harness = picked(layered("planar-texture", "texture"), [3, 3]);
    press(&mut harness, Key::Home);
    pick_by_mouse(&mut harness, [2, 3], [16, 16]);
    harness.get_by_label("floor, flat piece 1");
    harness.get_by_label("20 %  0 %  0 %");
    harness.get_by_label("51 0 0, alpha 0");
    harness.get_by_label("blocked");
    harness.get_by_label("texel 2, 3   lets through 20 %  0 %  0 %");
    assert!(!says(&harness, "map texel") && !says(&harness, "map distance"));
    pick_by_mouse(&mut harness, [12, 3], [16, 16]);
    harness.get_by_label("100 %  100 %  100 %");
    harness.get_by_label("255 255 255, alpha 255");
    harness.get_by_label("arrives");
}

#[test]
fn the_sentence_reports_what_these_techniques_ask() {
    for (technique, reason) in [
        ("planar-texture", "The texture of this flat receiver lets less than half of the light through here"),
        ("projective", "The silhouette of another object falls here."),
    ] {
        let harness = picked(layered(technique, "texture"), [3, 3]);
        harness.get_by_label("Dark under light 1.");
        harness.get_by_label_contains(reason);
    }
}

#[test]
fn sixty_four_layers_can_all_be_reached() {
    let mut capture = layered("projective", "silhouette");
    let map = capture.lights[0].map.as_mut().expect("a map");
    let blank = Arc::new(Image::uniform(PixelFormat::Rgba8, [16, 16], &[255; 4]));
    map.faces.resize(64, blank);
    map.clip_from_light.resize(64, glam::DMat4::IDENTITY);
    let mut harness = harness(capture);
    click_button(&mut harness, "Silhouettes");
    harness.get_by_role_and_label(Role::Button, "Layer 64").click_accesskit();
    harness.run_steps(3);
    harness.get_by_label_contains("silhouettes of light 1: layer 64");
}

#[test]
fn another_technique_with_fewer_layers_shows_them_all() {
    let mut harness = harness(layered("projective", "silhouette"));
    click_button(&mut harness, "Silhouettes");
    click_button(&mut harness, "Layer 3");
    let mut other = layered("planar-texture", "texture");
    let map = other.lights[0].map.as_mut().expect("a map");
    map.faces.truncate(2);
    map.clip_from_light.truncate(2);
    show_capture(&mut harness, other);
    harness.get_by_label_contains("textures of light 1 ·");
}

//! The Scene tab: a second camera that sees the first.

use super::pictures::{draw, inspector as inspector_over, sizes};
use super::{Seen, click, harness_of};
use crate::common;
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::PathBuf;
use std::sync::Arc;
use stencilscope::scene::{OpenSpec, open};
use stencilscope::technique::Technique;

/// A real frame of a built-in scene with its anatomy.
pub fn harness_over(name: &str, technique: Technique, pick: [u32; 2], size: [f32; 2]) -> Harness<'static, Seen> {
    let scene = open(&OpenSpec::new(name)).expect("a built-in scene");
    let mut session = common::session();
    let request = common::request(technique, [640, 360]);
    let (capture, plan) = session.capture_with_plan(&scene, &request).expect("a capture");
    let anatomy = session.anatomy(&scene, &request.choice, &plan);
    let history = session.history(&plan, &capture, pick).expect("a history");
    let mut inspector = inspector_over(&scene, &request, &Arc::new(capture), pick);
    inspector.set_anatomy(Ok(Arc::new(anatomy)));
    inspector.set_history(pick, Ok(Arc::new(history)));
    harness_of(inspector, size)
}

pub fn show(harness: &mut Harness<Seen>) {
    harness.get_by_role_and_label(Role::Tab, "Scene").click();
    harness.run_steps(3);
}

type View = (&'static str, fn(&mut Harness<Seen>));

/// `INSPECTOR_PICTURES=FOLDER cargo test pictures_of_the_scene` writes them.
#[test]
fn pictures_of_the_scene_tab_can_be_drawn() {
    let folder = std::env::var_os("INSPECTOR_PICTURES").map(PathBuf::from);
    let size = if folder.is_some() { [1280, 800] } else { sizes(false)[0] };
    let views: [View; 4] = [
        ("free", |_| ()),
        ("four", |harness| click(harness, "Four views")),
        ("camera", |harness| click(harness, "See from the camera")),
        ("near", |harness| {
            click(harness, "Near-clip volume");
            click(harness, "Names");
            click(harness, "Dark caps");
        }),
    ];
    let scenes = [
        ("tori", Technique::ZFail, [344, 71]),
        ("rings", Technique::ZFail, [320, 200]),
        ("inside", Technique::ZPassPlus, [320, 250]),
        ("tiger-cage", Technique::ShadowMap, [320, 250]),
    ];
    for (name, technique, pick) in scenes {
        for (view, act) in &views {
            let mut harness = harness_over(name, technique, pick, size.map(|side| (side + 16) as f32));
            show(&mut harness);
            act(&mut harness);
            harness.run_steps(2);
            draw(&mut harness, folder.as_deref(), &format!("scene-{name}-{view}"), size);
        }
    }
}

//! Pictures of what the Picture panel and the shadow map's tab can do, over real frames, for people to look at.

use super::pictures::{draw, inspector, sizes};
use super::{Seen, click, click_button, harness_of, press};
use crate::common;
use egui::Key;
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::PathBuf;
use std::sync::Arc;
use stencilscope::inspector::{Action, Inspector};
use stencilscope::plan::FramePlan;
use stencilscope::reading::shown::PictureKind;
use stencilscope::scene::{OpenSpec, Scene, open};
use stencilscope::session::{CaptureRequest, FrameSource, RunFrame, Session};
use stencilscope::technique::{Choice, Technique};

type View = fn(&mut Harness<Seen>);

const Z_FAIL: [(&str, View); 9] = [
    ("diff-stencil", |harness| {
        stencil(harness);
        press(harness, Key::D);
    }),
    ("diff-colour", |harness| press(harness, Key::D)),
    ("compare-step", |harness| {
        stencil(harness);
        click_button(harness, "Compare");
    }),
    ("compare-technique", |harness| {
        click_button(harness, "Compare");
        click(harness, "Compare with");
        click_button(harness, "technique shadow-map");
    }),
    ("bit", |harness| {
        stencil(harness);
        click(harness, "Bits of the stencil");
        click_button(harness, "Bit 0");
    }),
    ("lines", |harness| overlays(harness, &["Silhouettes", "Wireframe of volumes", "Casters' names"])),
    ("receivers", |harness| overlays(harness, &["Receivers", "Silhouettes"])),
    ("tests", |harness| {
        harness.state_mut().inspector.select_step(1);
        overlays(harness, &["Depth and stencil tests"]);
    }),
    ("overdraw", |harness| {
        harness.state_mut().inspector.select_step(1);
        harness.state_mut().inspector.set_picture_kind(PictureKind::Overdraw);
    }),
];

const SHADOW_MAP: [(&str, View); 2] = [
    ("depth", |harness| harness.state_mut().inspector.set_picture_kind(PictureKind::Depth)),
    ("map", |harness| {
        harness.get_by_role_and_label(Role::Tab, "Shadow map").click();
        harness.run_steps(3);
        click_button(harness, "Show the picked pixel's texel");
    }),
];

fn stencil(harness: &mut Harness<Seen>) {
    harness.state_mut().inspector.select_step(1);
    harness.state_mut().inspector.set_picture_kind(PictureKind::Stencil);
    harness.run_steps(2);
}

fn overlays(harness: &mut Harness<Seen>, names: &[&str]) {
    press(harness, Key::O);
    for name in names {
        harness.get_by_role_and_label(Role::CheckBox, name).click();
        harness.run_steps(2);
    }
    press(harness, Key::Escape);
}

/// Does what the panels asked for, as the app would.
fn answer(inspector: &mut Inspector, asked: &[Action], session: &mut Session, scene: &Scene, plan: &FramePlan) {
    let capture = inspector.capture().cloned().expect("a frame");
    let mut choice = Choice::new(Technique::from_name(&capture.technique).expect("a technique"));
    capture.settings.iter().for_each(|(key, value)| drop(choice.set(key, value)));
    let request = CaptureRequest::new(choice, capture.size);
    let frame = RunFrame {
        capture,
        plan: Arc::new(plan.clone()),
        source: Some(Arc::new(FrameSource { scene: scene.clone(), request: Some(request) })),
    };
    for action in asked {
        let Action::Ask(asked) = action else { continue };
        let result = session.answer(&asked.ask, Some(scene), Some(&frame), &asked.progress);
        inspector.answer(asked.ticket, result.map_err(|error| error.to_string()), true);
    }
}

/// `INSPECTOR_PICTURES=FOLDER cargo test pictures_of_modes` writes them.
#[test]
fn pictures_of_modes_and_overlays_can_be_drawn() {
    let folder = std::env::var_os("INSPECTOR_PICTURES").map(PathBuf::from);
    let mut session = common::session();
    let scene = open(&OpenSpec::new("tori")).expect("tori");
    for (technique, views) in [(Technique::ZFail, &Z_FAIL[..]), (Technique::ShadowMap, &SHADOW_MAP[..])] {
        let request = common::request(technique, [1280, 720]);
        let (capture, plan) = session.capture_with_plan(&scene, &request).expect("a capture");
        let capture = Arc::new(capture);
        for (name, view) in views {
            // Smaller than this the tools have no room.
            let size = sizes(true)[0];
            let inspector = inspector(&scene, &request, &capture, [689, 142]);
            let mut harness = harness_of(inspector, size.map(|side| (side + 2 * super::pictures::MARGIN) as f32));
            view(&mut harness);
            harness.run_steps(2);
            let asked = std::mem::take(&mut harness.state_mut().actions);
            answer(&mut harness.state_mut().inspector, &asked, &mut session, &scene, &plan);
            harness.run_steps(3);
            draw(&mut harness, folder.as_deref(), &format!("modes-{}-{name}", technique.name()), size);
        }
    }
}

//! Pictures of what the Picture panel and the shadow map's tab can do, over real frames, for people to look at.

use super::pictures::{Gallery, View, inspector};
use super::*;

const Z_FAIL: [(&str, View); 10] = [
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
        choose(harness, "Compare with", "technique shadow-map");
    }),
    ("bit", |harness| {
        stencil(harness);
        choose(harness, "Bits of the stencil", "Bit 0");
    }),
    ("lines", |harness| overlays(harness, &["Silhouettes", "Wireframe of volumes", "Casters' names"])),
    ("vanishing", |harness| overlays(harness, &["Vanishing points"])),
    ("receivers", |harness| overlays(harness, &["Receivers", "Silhouettes"])),
    ("tests", |harness| {
        harness.state_mut().inspector.model.select_step(1);
        overlays(harness, &["Depth and stencil tests"]);
    }),
    ("overdraw", |harness| {
        harness.state_mut().inspector.model.select_step(1);
        harness.state_mut().inspector.model.choose_picture(PictureKind::Overdraw);
    }),
];

const SHADOW_MAP: [(&str, View); 2] = [
    ("depth", |harness| harness.state_mut().inspector.model.choose_picture(PictureKind::Depth)),
    ("map", |harness| {
        show_tab(harness, "Shadow map");
        click_button(harness, "Show the picked pixel's texel");
    }),
];

fn stencil(harness: &mut Harness<Seen>) {
    harness.state_mut().inspector.model.select_step(1);
    change(harness, |inspector| inspector.model.choose_picture(PictureKind::Stencil));
}

fn overlays(harness: &mut Harness<Seen>, names: &[&str]) {
    press(harness, Key::O);
    for name in names {
        click_role(harness, Role::CheckBox, name);
    }
    press(harness, Key::Escape);
}

/// Does what the panels asked for, as the app would.
fn answer(harness: &mut Harness<Seen>, session: &mut Session, frame: &RunFrame) {
    for action in std::mem::take(&mut harness.state_mut().actions) {
        let Action::Ask(asked) = action else { continue };
        let result = session.answer(&asked.ask, frame.scene().ok(), Some(frame), &asked.progress);
        harness.state_mut().inspector.answer(asked.ticket, result.map_err(|error| error.to_string()), true);
    }
}

/// `INSPECTOR_PICTURES=FOLDER cargo test --profile bench pictures_of_modes` writes them.
#[test]
fn pictures_of_modes_and_overlays_can_be_drawn() {
    let gallery = Gallery::open();
    let mut session = common::session();
    for (technique, views) in [(Technique::ZFail, &Z_FAIL[..]), (Technique::ShadowMap, &SHADOW_MAP[..])] {
        let frame = common::frame(&mut session, "tori", common::request(technique, [1280, 720]));
        for (name, view) in views {
            let name = format!("modes-{}-{name}", technique.name());
            // In a smaller window the tools don't fit.
            gallery.show(
                &name,
                &[[1280, 800]],
                || inspector(&frame, [689, 142]),
                |harness| {
                    view(harness);
                    harness.run_steps(2);
                    answer(harness, &mut session, &frame);
                },
            );
        }
    }
}

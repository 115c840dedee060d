//! Who uses a page without a mouse, with a screen reader, in either theme or on a phone: every control is reached and named, and
//! every text can be read.

use super::browser::Browser;
use super::made::{Made, scene, tori};
use super::{PHONE, WIDE};
use serde_json::json;
use std::collections::BTreeSet;

/// What can be focused, in words that distinguish one from the other, where it is shown and not switched off.
const CONTROLS: &str = "(() => { const all = [...document.querySelectorAll('button, input, select, summary, [tabindex]')]; \
    const shown = all.filter((one) => !one.disabled && one.checkVisibility()); \
    shown.forEach((one, at) => { one.dataset.at = at; }); return shown.length; })()";

#[test]
fn the_keyboard_alone_reaches_every_control() {
    let made = tori().judged();
    for screen in [WIDE, PHONE] {
        let mut browser = Browser::new(screen, "dark");
        browser.open(&made.page(), "#pixel=322,92&step=2");
        let count = browser.evaluate(CONTROLS).as_u64().expect("a count");
        let mut reached = BTreeSet::new();
        for _ in 0..count + 3 {
            browser.press("Tab", false);
            reached.extend(
                browser.evaluate("Number(document.activeElement.dataset.at ?? -1)").as_i64().filter(|at| *at >= 0),
            );
        }
        assert_eq!(reached.len() as u64, count, "of {count} controls on {screen:?}");
        // A button is pressed with Enter, and keeps the focus.
        browser.evaluate("document.querySelector('[data-id=depth]').focus()");
        browser.press("Enter", false);
        let looked = "[document.activeElement.dataset.id, location.hash]";
        assert_eq!(browser.evaluate(looked), json!(["depth", "#pixel=322,92&step=2&view=depth"]));
        browser.evaluate("document.querySelector('.history .link').focus()");
        browser.press("Enter", false);
        assert_eq!(
            browser.evaluate("document.querySelectorAll('#marks polygon').length"),
            json!(2),
            "its triangle is outlined"
        );
        assert_eq!(browser.complaints(), Vec::<String>::new());
    }
}

#[test]
fn every_control_has_a_name_and_none_is_the_name_of_another() {
    let made = Made::of_scene(scene("two-lights"), "shadow-map", &[], [320, 240]).judged();
    let mut browser = Browser::new(WIDE, "dark");
    browser.open(&made.page(), "#pixel=160,120&view=map&step=1");
    let tree = browser.call("Accessibility.getFullAXTree", json!({}));
    let nodes = tree["nodes"].as_array().expect("nodes");
    let controls = [
        "button",
        "slider",
        "combobox",
        "spinbutton",
        "checkbox",
        "radio",
        "textbox",
        "DisclosureTriangle",
        "image",
        "region",
        "navigation",
        "complementary",
        "toolbar",
    ];
    let mut names = Vec::new();
    for node in nodes.iter().filter(|node| node["ignored"] == json!(false)) {
        let role = node["role"]["value"].as_str().unwrap_or_default();
        if controls.contains(&role) {
            let name = node["name"]["value"].as_str().unwrap_or_default().trim().to_owned();
            assert!(name.chars().any(char::is_alphanumeric), "{role} has no name: {node}");
            names.push((role.to_owned(), name));
        }
    }
    assert!(names.len() > 40, "{names:?}");
    for role in ["slider", "combobox", "spinbutton", "image"] {
        let of_role: Vec<&String> = names.iter().filter(|(of, _)| of == role).map(|(_, name)| name).collect();
        assert_eq!(of_role.iter().collect::<BTreeSet<_>>().len(), of_role.len(), "{role}: {of_role:?}");
    }
    assert_eq!(browser.complaints(), Vec::<String>::new());
}

/// The contrast of every text with what is behind it (WCAG 2, 1.4.3), those of large pictures and of what is switched off left out.
pub const CONTRASTS: &str = include_str!("contrasts.js");

#[test]
fn texts_are_read_in_both_themes_and_nothing_is_wider_than_a_phone() {
    let made = tori().judged();
    for screen in [WIDE, PHONE] {
        for theme in ["dark", "light"] {
            let mut browser = Browser::new(screen, theme);
            browser.open(&made.page(), "#pixel=322,92&step=2");
            browser.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })");
            let scheme = "(() => { const [red] = getComputedStyle(document.body).backgroundColor.match(/[0-9]+/g).map(Number); return red < 128 ? 'dark' : 'light'; })()";
            assert_eq!(browser.evaluate(scheme), json!(theme));
            for _ in 0..2 {
                let poor = browser.evaluate(CONTRASTS);
                assert_eq!(poor, json!([]), "{theme} on {screen:?}");
                // The switch turns it round.
                browser.evaluate("document.querySelector('#theme').click()");
            }
            let wide = browser.evaluate("document.documentElement.scrollWidth").as_u64().expect("a width");
            assert!(wide <= u64::from(screen[0]), "{wide} points on {screen:?}");
            assert_eq!(browser.complaints(), Vec::<String>::new());
        }
    }
}

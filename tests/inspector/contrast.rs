//! Words as they are drawn, against the ground that they stand on, in both themes: all can be read.

use super::accessibility::known;
use super::*;
use egui::epaint::{ClippedShape, TextShape};
use egui::{Color32, Shape};
use stencilscope::inspector::{PanelKind, ThemeChoice};

/// Contrast of words to their ground (WCAG 2.1, success criterion 1.4.3).
const LEAST: f64 = 4.5;
/// Share of a word's rectangle that one colour has to have to be its ground. On a picture no colour has it.
const GROUND_SHARE: f64 = 0.45;

/// A word as it is drawn: its inks, and where it is.
pub struct InkedWord {
    pub text: String,
    inks: Vec<Color32>,
    pub place: Rect,
}

fn words_of(shape: &Shape, clip: Rect, found: &mut Vec<InkedWord>) {
    match shape {
        Shape::Vec(all) => all.iter().for_each(|one| words_of(one, clip, found)),
        Shape::Text(TextShape { pos, galley, fallback_color, override_text_color, opacity_factor, .. }) => {
            let place = galley.mesh_bounds.translate(pos.to_vec2());
            let ink = |color: Color32| {
                let color = if color == Color32::PLACEHOLDER { *fallback_color } else { color };
                override_text_color.unwrap_or(color).gamma_multiply(*opacity_factor)
            };
            let inks = galley.job.sections.iter().map(|section| ink(section.format.color)).collect();
            if clip.contains_rect(place.shrink(1.0)) && place.width() > 4.0 {
                found.push(InkedWord { text: galley.text().to_owned(), inks, place });
            }
        }
        _ => {}
    }
}

/// Relative luminance of a colour (WCAG 2.1).
fn luminance(color: [u8; 3]) -> f64 {
    let [red, green, blue] = color.map(|byte| {
        let share = f64::from(byte) / 255.0;
        if share <= 0.04045 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
    });
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

fn contrast(one: [u8; 3], other: [u8; 3]) -> f64 {
    let (one, other) = (luminance(one) + 0.05, luminance(other) + 0.05);
    one.max(other) / one.min(other)
}

/// The colour that most of a rectangle has; `None` where no colour has so much of it.
fn ground(picture: &Picture, place: Rect) -> Option<[u8; 3]> {
    let place = place.expand(1.0);
    let (columns, rows) =
        (place.left().max(0.0) as u32..place.right() as u32, place.top().max(0.0) as u32..place.bottom() as u32);
    let mut colors = BTreeMap::<[u8; 3], usize>::new();
    for at in rows.flat_map(|y| columns.clone().map(move |x| [x, y])) {
        if let Some(color) = picture.at(at) {
            *colors.entry(color).or_default() += 1;
        }
    }
    let all: usize = colors.values().sum();
    let (color, count) = colors.into_iter().max_by_key(|(_, count)| *count)?;
    (count as f64 >= GROUND_SHARE * all as f64).then_some(color)
}

/// The words of the last frame.
pub fn words(harness: &Harness<Seen>) -> Vec<InkedWord> {
    let mut words = Vec::new();
    for ClippedShape { clip_rect, shape, .. } in &harness.output().shapes {
        words_of(shape, clip_rect.intersect(harness.ctx.content_rect()), &mut words);
    }
    words
}

/// The words that can't be read now, but for those `behind` a dialog, which shades them; how many were looked at.
fn unreadable(harness: &mut Harness<Seen>, at: &str, behind: &[InkedWord]) -> (Vec<String>, usize) {
    harness.remove_cursor();
    harness.run_steps(2);
    let is_before = |word: &InkedWord| !behind.iter().any(|one| one.text == word.text && one.place == word.place);
    let words: Vec<InkedWord> = words(harness).into_iter().filter(is_before).collect();
    let picture = window_picture(harness);
    let (mut faint, mut read) = (Vec::new(), 0);
    for InkedWord { text, inks, place } in words {
        let Some(ground) = ground(&picture, place) else { continue };
        read += 1;
        for ink in inks {
            let [red, green, blue, alpha] = ink.to_array();
            let over = |ink: u8, ground: u8| {
                (f64::from(ink) + f64::from(ground) * (1.0 - f64::from(alpha) / 255.0)).min(255.0) as u8
            };
            let ink = [over(red, ground[0]), over(green, ground[1]), over(blue, ground[2])];
            let found = contrast(ink, ground);
            if found < LEAST {
                faint.push(format!("{at}: “{text}” {ink:?} on {ground:?}: {found:.2}"));
            }
        }
    }
    (faint, read)
}

#[test]
fn every_word_of_every_tab_can_be_read_in_both_themes() {
    let (mut faint, mut read) = (Vec::new(), 0);
    for (technique, theme) in [
        (Technique::ZFail, ThemeChoice::Light),
        (Technique::ShadowMap, ThemeChoice::Light),
        (Technique::ZFail, ThemeChoice::Dark),
    ] {
        let mut harness = harness_in(known(technique), [1440.0, 900.0]);
        change(&mut harness, |inspector| inspector.model.theme = theme);
        let mut look = |harness: &mut Harness<Seen>, at: &str, behind: &[InkedWord]| {
            let found = unreadable(harness, &format!("{technique:?} {theme:?} {at}"), behind);
            faint.extend(found.0);
            read += found.1;
        };
        for panel in PanelKind::ALL {
            show_tab(&mut harness, panel.title());
            look(&mut harness, panel.title(), &[]);
        }
        show_tab(&mut harness, PanelKind::Picture.title());
        for kind in PictureKind::ALL {
            change(&mut harness, |inspector| inspector.model.choose_picture(kind));
            look(&mut harness, &format!("picture {kind:?}"), &[]);
        }
        change(&mut harness, |inspector| drop(inspector.go_to_stop(technique, 1)));
        look(&mut harness, "tour", &[]);
        for button in ["Open…", "Export", "Help"] {
            let behind = words(&harness);
            click_button(&mut harness, button);
            look(&mut harness, button, &behind);
            press(&mut harness, Key::Escape);
        }
    }
    assert!(read > 2_000, "{read} words were looked at");
    let all: BTreeSet<&String> = faint.iter().collect();
    assert!(all.is_empty(), "{} of {read} words are faint:\n{}", all.len(), faint.join("\n"));
}

/// Contrast of a control's outline to its ground (WCAG 2.1, success criterion 1.4.11).
const LEAST_OF_CONTROLS: f64 = 3.0;

/// A box to tick, also an empty one in a menu, is seen against what it lies on.
#[test]
fn every_box_to_tick_is_outlined_in_both_themes() {
    let mut boxes = 0;
    for theme in [ThemeChoice::Light, ThemeChoice::Dark] {
        for (tab, menu) in
            [("Picture", Some("Overlay")), ("Scene settings", Some("leave-out")), ("Scene settings", None)]
        {
            let mut harness = harness_in(known(Technique::ZFail), TALL);
            change(&mut harness, |inspector| inspector.model.theme = theme);
            show_tab(&mut harness, tab);
            menu.into_iter().for_each(|menu| click_button(&mut harness, menu));
            harness.remove_cursor();
            harness.run_steps(2);
            let nodes = harness.query_all_by_role(Role::CheckBox).map(|node| node.rect());
            let places: Vec<Rect> = nodes.filter(|rect| rect.is_positive()).collect();
            let picture = window_picture(&mut harness);
            for place in places {
                let middle = place.center().y as u32;
                // From the ground beside it into the box, along the middle of its row.
                let from = (place.left() as u32).saturating_sub(3);
                let line: Vec<[u8; 3]> = (from..from + 9).filter_map(|x| picture.at([x, middle])).collect();
                let Some(ground) = line.first() else { continue };
                let found = line.iter().map(|color| contrast(*color, *ground)).fold(1.0, f64::max);
                assert!(found >= LEAST_OF_CONTROLS, "{theme:?}, {tab}, {menu:?}: {place}: {found:.2}");
                boxes += 1;
            }
        }
    }
    assert!(boxes > 30, "{boxes}");
}

/// Numbers of texels side by side are not read as one.
#[test]
fn numbers_in_the_magnifier_stand_apart() {
    for technique in [Technique::ZFail, Technique::ShadowMap] {
        let mut harness = harness_in(known(technique), [1280.0, 800.0]);
        show_tab(&mut harness, "Picture");
        change(&mut harness, |inspector| inspector.model.choose_picture(PictureKind::Depth));
        harness.run_steps(2);
        let canvas = harness.get_by_label("Picture canvas").rect();
        let is_number = |word: &InkedWord| canvas.contains_rect(word.place) && word.text.parse::<f64>().is_ok();
        let numbers: Vec<InkedWord> = words(&harness).into_iter().filter(is_number).collect();
        assert!(numbers.len() > 8, "{technique:?}: {}", numbers.len());
        for (index, one) in numbers.iter().enumerate() {
            for other in &numbers[index + 1..] {
                let is_in_row = (one.place.center().y - other.place.center().y).abs() < 3.0;
                let gap = (other.place.left() - one.place.right()).max(one.place.left() - other.place.right());
                assert!(!is_in_row || gap >= 3.0, "{} and {}: {gap}", one.text, other.text);
            }
        }
    }
}

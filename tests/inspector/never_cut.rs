//! At every usual size of the window, and in panels as narrow as a phone, nothing is cut off: a word is whole, or a
//! tooltip says all of it, and what can be operated lies within its panel.

use super::accessibility::known;
use super::*;
use egui::Shape;
use egui::epaint::{ClippedShape, TextShape};
use stencilscope::inspector::{Overlay, PanelKind};

/// Sizes of the window, points. In the last the panels are as wide as one that is docked narrowly.
const SIZES: [[f32; 2]; 5] = [[1280.0, 800.0], [1440.0, 900.0], [1920.0, 1080.0], [1000.0, 700.0], [360.0, 800.0]];
/// How far something may reach over a border, points: half of a stroke.
const TOLERANCE: f32 = 1.0;

/// A text of the last frame, and the part of the window in which it may be seen.
pub struct Word {
    pub text: String,
    place: Rect,
    clip: Rect,
    is_elided: bool,
    rows: usize,
}

impl Word {
    /// Is all of it, from left to right, in the part in which it may be seen?
    fn is_whole(&self) -> bool {
        is_whole(self.place, self.clip)
    }

    /// Is a row of it on the screen at all? What is scrolled away is not.
    fn is_in_view(&self) -> bool {
        self.place.y_range().intersection(self.clip.y_range()).span() > 4.0
    }
}

fn is_whole(place: Rect, clip: Rect) -> bool {
    place.left() >= clip.left() - TOLERANCE && place.right() <= clip.right() + TOLERANCE
}

/// Does an ellipsis stand for letters within a text? One before a space or a comma, or behind a space at the end, says that
/// something goes on or is asked for.
fn is_elided_within(text: &str) -> bool {
    let is_cut = |(place, sign): (usize, &str)| {
        let (before, after) = (text[..place].chars().last(), text[place + sign.len()..].chars().next());
        before.is_some() && after.is_some_and(char::is_alphanumeric)
            || before.is_some_and(char::is_alphanumeric) && after.is_some_and(|letter| !" ,.;:)".contains(letter))
    };
    text.match_indices('…').any(is_cut)
}

fn words_of(shape: &Shape, clip: Rect, found: &mut Vec<Word>) {
    match shape {
        Shape::Vec(all) => all.iter().for_each(|one| words_of(one, clip, found)),
        Shape::Text(TextShape { pos, galley, angle, .. }) if *angle == 0.0 && !galley.text().trim().is_empty() => {
            found.push(Word {
                text: galley.text().to_owned(),
                // Of the letters alone: a text that begins behind another one in its row has that one's width, too.
                place: galley.mesh_bounds.translate(pos.to_vec2()),
                clip,
                is_elided: galley.elided || is_elided_within(galley.text()),
                rows: galley.rows.len(),
            });
        }
        _ => {}
    }
}

pub fn words(harness: &Harness<Seen>) -> Vec<Word> {
    let mut found = Vec::new();
    for ClippedShape { clip_rect, shape, .. } in &harness.output().shapes {
        words_of(shape, clip_rect.intersect(harness.ctx.content_rect()), &mut found);
    }
    found
}

/// The places in which pictures lie. What is written into a picture moves and is cut with it.
fn canvases(harness: &Harness<Seen>) -> Vec<Rect> {
    harness.query_all_by_role(Role::Canvas).map(|canvas| canvas.rect().expand(TOLERANCE)).collect()
}

/// Everything that is cut off now, in words; `seen` holds elided texts whose tooltips were looked at before.
pub fn cut(harness: &mut Harness<Seen>, seen: &mut BTreeSet<String>) -> Vec<String> {
    let canvases = canvases(harness);
    let in_picture = |clip: Rect| canvases.iter().any(|canvas| canvas.contains_rect(clip));
    let panels: Vec<Rect> = harness.query_all_by_role(Role::TabPanel).map(|panel| panel.rect()).collect();
    let mut wrong = Vec::new();
    let words = words(harness);
    for word in words.iter().filter(|word| !in_picture(word.clip)) {
        // Tabs that do not fit are scrolled to.
        let is_tab = PanelKind::ALL.iter().any(|panel| panel.title() == word.text);
        if word.is_in_view() && !word.is_whole() && !is_tab {
            wrong.push(format!("“{}” at {} in {}", word.text, word.place, word.clip));
        }
        // Where nothing scrolls, nothing may lie below either.
        let is_below = word.place.bottom() > word.clip.bottom() + TOLERANCE;
        if is_below
            && panels.iter().any(|panel| panel.shrink(TOLERANCE).contains_rect(word.place) && *panel == word.clip)
        {
            wrong.push(format!("“{}” at {} below {}", word.text, word.place, word.clip));
        }
    }
    // Two texts of a panel may not lie over each other; a heading is drawn twice, to be heavier.
    let in_panels: Vec<&Word> =
        words.iter().filter(|word| word.rows == 1 && word.is_in_view() && !in_picture(word.clip)).collect();
    for (index, word) in in_panels.iter().enumerate() {
        for other in in_panels[..index].iter().filter(|other| other.clip == word.clip && other.text != word.text) {
            if word.place.shrink(TOLERANCE).intersects(other.place.shrink(TOLERANCE)) {
                wrong.push(format!("“{}” lies over “{}” at {}", word.text, other.text, word.place));
            }
        }
    }
    let content = harness.ctx.content_rect();
    let widgets = harness.ctx.viewport(|viewport| {
        let layers = viewport.prev_pass.widgets.layers().map(|(_, widgets)| widgets.to_vec());
        layers.flatten().collect::<Vec<_>>()
    });
    for widget in widgets.iter().filter(|widget| widget.sense.interactive()) {
        let seen = widget.interact_rect.intersect(content);
        if seen.height() > 4.0 && !is_whole(widget.rect, seen) {
            let same = |node: &egui_kittest::Node| {
                node.accesskit_node().bounding_box().is_some() && node.rect() == widget.rect
            };
            let name = harness.root().children_recursive().find(same).and_then(|node| node.accesskit_node().label());
            if !PanelKind::ALL.iter().any(|panel| Some(panel.title()) == name.as_deref()) {
                wrong.push(format!("widget {name:?} at {} in {seen}", widget.rect));
            }
        }
    }
    let elided = words.iter().filter(|word| word.is_elided && word.is_in_view());
    for word in elided.filter(|word| seen.insert(word.text.clone())) {
        harness.hover_at(word.place.intersect(word.clip).center());
        harness.run_steps(4);
        let all: Vec<&str> = word.text.split(|letter: char| letter.is_whitespace() || letter == '…').collect();
        let tells = |other: &Word| !other.is_elided && all.iter().all(|one| other.text.contains(one));
        let is_told = self::words(harness).iter().any(tells);
        if !is_told {
            wrong.push(format!("“{}” is elided without a tooltip", word.text));
        }
        harness.remove_cursor();
        harness.run_steps(2);
    }
    wrong
}

/// Also those that are scrolled to: a window so high shows all.
#[test]
fn the_settings_of_every_technique_fit_a_narrow_panel() {
    let mut wrong = Vec::new();
    for technique in Technique::ALL {
        let mut harness = harness_in(explain::over("tori", technique), [1000.0, 2600.0]);
        show_tab(&mut harness, PanelKind::Settings.title());
        let found = cut(&mut harness, &mut BTreeSet::new());
        wrong.extend(found.into_iter().map(|one| format!("{}: {one}", technique.name())));
    }
    assert_eq!(wrong, [""; 0]);
}

#[test]
fn in_every_tab_at_every_size_nothing_is_cut_off() {
    let mut wrong = Vec::new();
    for technique in [Technique::ZFail, Technique::ShadowMap] {
        for size in SIZES {
            let mut harness = harness_in(known(technique), size);
            let mut seen = BTreeSet::new();
            let mut look = |harness: &mut Harness<Seen>, at: &str, pointer: Option<Pos2>| {
                harness.remove_cursor();
                pointer.into_iter().for_each(|pointer| harness.hover_at(pointer));
                harness.run_steps(2);
                let found = cut(harness, &mut seen);
                wrong.extend(found.into_iter().map(|one| format!("{technique:?} {size:?} {at}: {one}")));
            };
            for panel in PanelKind::ALL {
                show_tab(&mut harness, panel.title());
                look(&mut harness, panel.title(), None);
            }
            // With the values of a texel in the status bar.
            show_tab(&mut harness, PanelKind::Picture.title());
            let canvas = harness.get_by_label("Picture canvas").rect();
            look(&mut harness, "under the pointer", Some(canvas.center()));
            for stop in 0..Inspector::stops_of(technique) {
                change(&mut harness, |inspector| drop(inspector.go_to_stop(technique, stop)));
                look(&mut harness, &format!("stop {stop}"), None);
            }
            change(&mut harness, |inspector| drop(inspector.end_tour()));
            show_tab(&mut harness, PanelKind::Picture.title());
            for kind in PictureKind::ALL {
                change(&mut harness, |inspector| inspector.model.choose_picture(kind));
                look(&mut harness, &format!("picture {kind:?}"), None);
            }
            for overlay in Overlay::ALL {
                change(&mut harness, |inspector| {
                    inspector.model.modes.overlays.clear();
                    inspector.model.modes.overlays.insert(overlay);
                });
                look(&mut harness, &format!("overlay {overlay:?}"), None);
            }
        }
    }
    let all: BTreeSet<&String> = wrong.iter().collect();
    assert!(all.is_empty(), "{} are cut off:\n{}", all.len(), wrong.join("\n"));
}

/// Which caster's face it is, nothing else says: in a side panel of the first layout the names in a history are whole.
#[test]
fn in_the_first_layout_a_history_names_its_casters_whole() {
    let mut session = common::session();
    let frame = common::frame(&mut session, "tori", common::request(Technique::ZFail, [640, 480]));
    let at = stencilscope::reading::notable_pixel::in_shadow(&frame.capture).expect("a dark pixel");
    for size in [[1280.0, 800.0], [1440.0, 900.0]] {
        let mut inspector = pictures::inspector(&frame, at);
        inspector.set_plan(Arc::clone(&frame.plan));
        let history = session.history(&frame.plan, &frame.capture, at).expect("a history");
        inspector.take_in(HistoryOf { at }, Ok(Arc::new(history)));
        let harness = harness_in(inspector, size);
        let words = words(&harness);
        let of_casters: Vec<&Word> = words.iter().filter(|word| word.text.ends_with("torus")).collect();
        assert!(of_casters.len() > 4, "{} names", of_casters.len());
        for word in words.iter().filter(|word| word.is_elided) {
            assert!(!word.text.contains("torus") && !word.text.contains("cap"), "“{}” is cut at {size:?}", word.text);
        }
    }
}

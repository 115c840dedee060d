//! What a stop of a tour speaks of is framed and in view, and what would draw attention from it is folded away.

use super::pictures::{Gallery, MARGIN};
use super::*;
use stencilscope::inspector::{PanelKind, TOURS, ThemeChoice, Tour, TourMove};

const FRAME: [u32; 2] = [320, 240];

/// Does what the panels asked for, as the app would, until they ask for nothing more.
fn answer_all(harness: &mut Harness<Seen>, session: &mut Session, frame: &RunFrame) {
    for _ in 0..4 {
        for action in std::mem::take(&mut harness.state_mut().actions) {
            let Action::Ask(asked) = action else { continue };
            let result = session.answer(&asked.ask, frame.scene().ok(), Some(frame), &asked.progress);
            harness.state_mut().inspector.answer(asked.ticket, result.map_err(|error| error.to_string()), true);
        }
        harness.run_steps(4);
    }
}

/// The panels at a stop, over its frame.
fn at_stop(
    session: &mut Session,
    tour: &Tour,
    stop: usize,
    size: [f32; 2],
    theme: ThemeChoice,
) -> Harness<'static, Seen> {
    let scene = |go: &TourMove| if let TourMove::Scene(name) = go { Some(*name) } else { None };
    let name = tour.stops[..=stop].iter().rev().find_map(|stop| stop.go.iter().find_map(scene)).expect("a scene");
    let request = CaptureRequest::new(tour.stops[stop].choice(tour), FRAME);
    let frame = common::frame(session, name, request.clone());
    let scene = frame.scene().expect("a scene");
    let mut inspector = Inspector::new(Vec::new());
    inspector.model.theme = theme;
    inspector.open_scene(scene, RunRequest::of(scene, request.choice, FRAME), Some(name.to_owned()));
    inspector.set_capture(Arc::clone(&frame.capture));
    inspector.set_plan(Arc::clone(&frame.plan));
    let mut harness = harness_in(inspector, size);
    change(&mut harness, |inspector| assert_eq!(inspector.go_to_stop(tour.technique, stop), []));
    answer_all(&mut harness, session, &frame);
    harness.run_steps(24);
    harness
}

/// `INSPECTOR_PICTURES=FOLDER cargo test --profile bench what_a_stop_speaks_of` writes a picture of each stop.
#[test]
fn what_a_stop_speaks_of_is_framed_and_in_view() {
    let gallery = Gallery::open();
    let mut session = common::session();
    let mut wrong = Vec::new();
    for tour in &TOURS {
        for (index, stop) in tour.stops.iter().enumerate() {
            let place = format!("{} {}", tour.technique.name(), index + 1);
            let subject = stop.go.iter().find_map(|go| if let TourMove::Mark(one) = go { Some(*one) } else { None });
            let Some(subject) = subject else {
                wrong.push(format!("{place} ({}): it marks nothing", stop.title));
                continue;
            };
            for size in [[1280.0, 800.0], [1000.0, 700.0]] {
                let mut harness = at_stop(&mut session, tour, index, size, ThemeChoice::Dark);
                let name = format!("The stop speaks of {}", subject.name());
                let content = harness.ctx.content_rect();
                let bar = harness.get_by_label("End tour").rect();
                match harness.query_by_label(&name).map(|mark| mark.rect()) {
                    None => {
                        wrong.push(format!("{place} ({}) {size:?}: no frame around {}", stop.title, subject.name()))
                    }
                    Some(mark) => {
                        let is_seen = content.contains_rect(mark.shrink(1.0)) && mark.bottom() < bar.top();
                        // A part higher than its panel is seen from its top on.
                        let begins = content.contains(mark.left_top()) && mark.height() > 0.4 * content.height();
                        if !(is_seen || begins) || mark.height() < 12.0 {
                            wrong.push(format!("{place} ({}) {size:?}: {} is at {mark}", stop.title, subject.name()));
                        }
                    }
                }
                if gallery.folder.is_some() {
                    let size = size.map(|side| side as u32 - 2 * MARGIN);
                    gallery.draw(&mut harness, &format!("tour-{}-{:02}", tour.technique.name(), index + 1), size);
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn tour_of(technique: Technique) -> &'static Tour {
    TOURS.iter().find(|tour| tour.technique == technique).expect("a tour")
}

#[test]
fn during_a_tour_other_tours_and_what_was_left_out_do_not_draw_attention() {
    let mut session = common::session();
    let stop = |session: &mut Session, title: &str| {
        let tour = tour_of(Technique::Auto);
        let index = tour.stops.iter().position(|stop| stop.title == title).expect("a stop");
        at_stop(session, tour, index, WINDOW, ThemeChoice::Dark)
    };
    let mut harness = stop(&mut session, "The cheapest that is right");
    show_tab(&mut harness, "Explain");
    assert!(!says(&harness, "Guided tours") && harness.query_by_label("Tour of z-pass").is_none());
    // The list of passes has one as well.
    let lists = |harness: &Harness<Seen>| harness.query_all_by_label("Left out").count();
    assert!(says(&harness, "Left out: ") && lists(&harness) == 1);
    let harness = stop(&mut session, "What was left out");
    assert_eq!(lists(&harness), 2, "here it is what the stop speaks of");
    let mut harness = stop(&mut session, "Still no wrong pixel");
    change(&mut harness, |inspector| drop(inspector.end_tour()));
    show_tab(&mut harness, "Explain");
    assert!(says(&harness, "Guided tours") && !says(&harness, "The stop speaks of"));
}

/// Steps taken during a stop leave the picture that its text is about: the bar says so, and leads back.
#[test]
fn whoever_steps_on_during_a_stop_finds_back_to_it() {
    let mut session = common::session();
    let tour = tour_of(Technique::ZFail);
    let index = tour.stops.iter().position(|stop| stop.title == "Faces behind it").expect("a stop");
    let mut harness = at_stop(&mut session, tour, index, WINDOW, ThemeChoice::Dark);
    let step = |harness: &Harness<Seen>| harness.state().inspector.model.selected();
    let about = step(&harness);
    let back = "Back to this step";
    assert!(harness.query_by_label(back).is_none());
    press(&mut harness, Key::ArrowRight);
    assert_ne!(step(&harness), about);
    click_button(&mut harness, back);
    harness.run_steps(4);
    assert_eq!(step(&harness), about);
    assert!(harness.query_by_label(back).is_none());
}

/// A stop about one volume shows that in which the picked pixel lies; what the user had chosen comes back after it.
#[test]
fn a_stop_about_a_volume_shows_one_and_gives_the_choice_back() {
    let mut session = common::session();
    let tour = tour_of(Technique::ZFail);
    let index = tour.stops.iter().position(|stop| stop.title == "What a cap is").expect("a stop");
    let mut harness = at_stop(&mut session, tour, index, WINDOW, ThemeChoice::Light);
    let chosen = |harness: &Harness<Seen>| {
        harness.get_by_role_and_label(Role::ComboBox, "Caster shown").accesskit_node().value().expect("a value")
    };
    assert_eq!(chosen(&harness), "blue torus", "without a pick");
    // The rays of a pick in another one's shadow would miss that.
    let request = CaptureRequest::new(tour.stops[index].choice(tour), FRAME);
    let frame = common::frame(&mut session, "tori", request);
    let mask = frame.capture.lights[0].shadow.as_ref().expect("a mask");
    let dark = |x: u32, y: u32| mask.byte_at([x, y]) == Some(stencilscope::truth::SHADOW);
    let mut casters = BTreeSet::new();
    for at in common::pixels(FRAME).filter(|[x, y]| dark(*x, *y)).step_by(2003) {
        change(&mut harness, |inspector| inspector.model.selection.pick = Some(at));
        answer_all(&mut harness, &mut session, &frame);
        let caster = chosen(&harness);
        assert!(says(&harness, &format!("In the shadow of {caster}")), "{at:?}: the volume of {caster} is shown");
        casters.insert(caster);
    }
    assert!(casters.len() > 1, "{casters:?}");
    change(&mut harness, |inspector| drop(inspector.end_tour()));
    show_tab(&mut harness, PanelKind::Scene.title());
    assert_eq!(chosen(&harness), "all casters");
}

/// Tabs that a tour showed go back to those that were there.
#[test]
fn the_tabs_from_before_a_tour_come_back() {
    let mut session = common::session();
    let tour = tour_of(Technique::ZFail);
    let frame = common::frame(&mut session, "tori", common::request(Technique::ZFail, [160, 120]));
    let mut harness = harness_in(explain::over("tori", Technique::ZFail), WINDOW);
    let before = [PanelKind::Scene, PanelKind::State, PanelKind::Diagnosis, PanelKind::Settings];
    before.iter().for_each(|panel| show_tab(&mut harness, panel.title()));
    let is_shown =
        |harness: &Harness<Seen>, panel: &PanelKind| harness.state().inspector.model.shown_panels.contains(panel);
    assert!(before.iter().all(|panel| is_shown(&harness, panel)));
    change(&mut harness, |inspector| drop(inspector.go_to_stop(tour.technique, 0)));
    answer_all(&mut harness, &mut session, &frame);
    show_tab(&mut harness, "Picture");
    show_tab(&mut harness, "Pixel");
    assert!(before[..2].iter().all(|panel| !is_shown(&harness, panel)));
    change(&mut harness, |inspector| drop(inspector.end_tour()));
    harness.run_steps(4);
    for panel in &before {
        assert!(is_shown(&harness, panel), "{panel:?}");
    }
}

/// Whoever is new finds the tours by a mark on their button, which says so; it is gone once the list was seen.
#[test]
fn the_button_of_the_tours_is_marked_until_the_list_was_seen() {
    let mut harness = harness_in(explain::over("tori", Technique::ZFail), WINDOW);
    let invites = |harness: &mut Harness<Seen>| {
        harness.get_by_role_and_label(Role::Button, "Tours").hover();
        harness.run_steps(8);
        let invites = says(harness, "New here? Guided tours");
        harness.remove_cursor();
        harness.run_steps(4);
        invites
    };
    assert!(invites(&mut harness) && !harness.state().inspector.remembered().knows_tours);
    click_button(&mut harness, "Tours");
    for tour in &TOURS {
        // Each says what one knows after it.
        assert!(says(&harness, &format!("Begin the tour of {}", tour.technique.name())), "{}", tour.promise);
    }
    press(&mut harness, Key::Escape);
    assert!(!invites(&mut harness) && harness.state().inspector.remembered().knows_tours);
}

/// A presenter's remote sends Page Down and Page Up.
#[test]
fn page_keys_go_from_stop_to_stop() {
    let mut session = common::session();
    let mut harness = at_stop(&mut session, tour_of(Technique::ZFail), 0, WINDOW, ThemeChoice::Dark);
    for (key, title) in [(Key::PageDown, "Faces behind it"), (Key::PageUp, "What every pixel shows")] {
        press(&mut harness, key);
        harness.run_steps(3);
        harness.get_by_label(title);
    }
}

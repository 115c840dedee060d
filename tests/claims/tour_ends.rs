//! What a tour gives back at its end: scene and settings as they were before it.

use super::guided::{Guided, SIZE};
use crate::common::opened;
use egui_kittest::kittest::Queryable;
use stencilscope::ask::RunRequest;
use stencilscope::inspector::{Action, Inspector, TOURS};
use stencilscope::technique::{Choice, Technique};

#[test]
fn a_tour_gives_back_what_it_changed() {
    let mut guided = Guided::new();
    let scene = opened("table");
    let mut own = RunRequest::of(&scene, Choice::new(Technique::ShadowMap), SIZE);
    own.choice.set("size", "64").expect("a setting");
    own.lights[0].position.y += 0.5;
    guided.inspector.open_scene(&scene, own.clone(), Some("table".to_owned()));
    guided.run(&own);
    let (index, tour) = (3, TOURS.iter().find(|tour| tour.technique == Technique::ShadowMap).expect("a tour"));
    guided.go_to(tour, index);
    let during = guided.inspector.draft().expect("a scene");
    assert_eq!(during.choice, tour.stops[index].choice(tour));
    assert_eq!(during.lights, scene.lights, "as the scene is opened, which the text is about");
    let actions = guided.inspector.end_tour();
    assert!(matches!(&actions[..], [Action::Run(run)] if **run == own), "{actions:?}");
    assert_eq!(*guided.inspector.draft().expect("a scene"), own);
}

#[test]
fn a_scene_that_was_edited_before_a_tour_comes_back_from_another_scene() {
    let mut guided = Guided::new();
    let scene = opened("table");
    let mut own = RunRequest::of(&scene, Choice::new(Technique::ZFail), SIZE);
    own.lights[0].position.y += 0.5;
    own.choice.set("casters", "light-facing").expect("a setting");
    guided.inspector.open_scene(&scene, own.clone(), Some("table".to_owned()));
    guided.run(&own);
    let tour = TOURS.iter().find(|tour| tour.technique == Technique::ZPass).expect("a tour");
    guided.go_to(tour, 0);
    guided.go_to(tour, 3);
    assert_eq!(guided.frame().0.scene, "inside");
    let actions = guided.inspector.end_tour();
    assert_eq!(actions, [Action::Open("table".to_owned())]);
    guided.carry_out(actions, Technique::ZFail);
    assert_eq!(*guided.inspector.draft().expect("a scene"), own);
    assert_eq!(guided.inspector.model.scene.as_ref().expect("a scene").name, "table");
}

#[test]
fn a_file_s_scene_of_the_name_of_a_tour_s_is_another_scene() {
    let mut guided = Guided::new();
    let scene = opened("tori");
    let own = RunRequest::of(&scene, Choice::new(Technique::ZFail), SIZE);
    let file = "mine/tori.toml".to_owned();
    guided.inspector.open_scene(&scene, own.clone(), Some(file.clone()));
    guided.run(&own);
    assert_eq!(guided.inspector.go_to_stop(Technique::ZFail, 0), [Action::Open("tori".to_owned())]);
    guided.inspector.open_scene(&scene, own.clone(), Some("tori".to_owned()));
    guided.run(&own);
    assert_eq!(guided.inspector.end_tour(), [Action::Open(file)]);
}

#[test]
fn a_scene_that_the_user_opens_during_a_tour_stays_at_its_end() {
    let mut guided = Guided::new();
    let tour = TOURS.iter().find(|tour| tour.technique == Technique::ZFail).expect("a tour");
    guided.go_to(tour, 0);
    let scene = opened("table");
    let mut own = RunRequest::of(&scene, Choice::new(Technique::ZFail), SIZE);
    own.choice.set("casters", "light-facing").expect("a setting");
    guided.inspector.open_scene(&scene, own.clone(), Some("table".to_owned()));
    assert_eq!(guided.inspector.end_tour(), []);
    assert_eq!(*guided.inspector.draft().expect("a scene"), own);
}

#[test]
fn every_tour_but_the_last_ends_with_the_next_one() {
    for (tour, next) in TOURS.iter().zip(TOURS.iter().skip(1)) {
        let mut inspector = Inspector::default();
        inspector.go_to_stop(tour.technique, tour.stops.len() - 1);
        let mut harness = egui_kittest::Harness::builder()
            .with_size([1280.0, 800.0])
            .build_ui_state(|ui, inspector: &mut Inspector| drop(inspector.ui(ui)), inspector);
        harness.run_steps(2);
        let name = format!("Tour of {}", next.technique.name());
        assert!(harness.query_all_by_label(&name).count() > 0, "{name}");
        assert!(harness.query_by_label("Next stop").is_none());
    }
}

/// A tour that ends while a stop's scene is being opened: that scene comes, and after it the one before, as it was.
#[test]
fn a_tour_that_ends_while_its_scene_opens_gives_the_scene_before_back() {
    let tour = TOURS.iter().find(|tour| tour.technique == Technique::ZPass).expect("a tour");
    // The first stop's scene, and that of a later one while the first one's is open.
    for (shown, opening, name) in [(None, 0, "tori"), (Some(0), 3, "inside")] {
        let mut guided = Guided::new();
        let scene = opened("table");
        let mut own = RunRequest::of(&scene, Choice::new(Technique::ZFail), SIZE);
        own.lights[0].position.y += 0.5;
        guided.inspector.open_scene(&scene, own.clone(), Some("table".to_owned()));
        guided.run(&own);
        shown.into_iter().for_each(|stop| guided.go_to(tour, stop));
        let begun = guided.inspector.go_to_stop(Technique::ZPass, opening);
        assert_eq!(begun, [Action::Open(name.to_owned())]);
        let actions = guided.inspector.end_tour();
        assert_eq!(actions, [Action::Open("table".to_owned())], "{name}");
        // Both are opened, in the order in which they were asked for.
        guided.carry_out(begun, Technique::ZPass);
        guided.carry_out(actions, Technique::ZPass);
        assert_eq!(*guided.inspector.draft().expect("a scene"), own, "{name}");
    }
}

/// What the button says is what happens: a scene without a name to open it by does not come back.
#[test]
fn the_end_of_a_tour_says_whether_the_scene_before_comes_back() {
    for (source, words) in [
        (
            Some("table".to_owned()),
            "scene, settings, picture, pick, overlays, diagnosis and undo go back to what they were before the tour",
        ),
        (None, "can't be opened again by its name"),
    ] {
        let mut guided = Guided::new();
        let scene = opened("table");
        let own = RunRequest::of(&scene, Choice::new(Technique::ZFail), SIZE);
        guided.inspector.open_scene(&scene, own.clone(), source.clone());
        guided.run(&own);
        let tour = TOURS.iter().find(|tour| tour.technique == Technique::ZFail).expect("a tour");
        guided.go_to(tour, 0);
        assert_eq!(guided.frame().0.scene, "tori");
        let mut harness = egui_kittest::Harness::builder()
            .with_size([1280.0, 800.0])
            .build_ui_state(|ui, inspector: &mut Inspector| drop(inspector.ui(ui)), guided.inspector);
        harness.run_steps(2);
        let button = harness.get_by_label("End tour").rect().center();
        harness.hover_at(button);
        harness.run_steps(8);
        assert!(harness.query_all_by_label_contains(words).count() > 0, "{source:?}: {words}");
        let actions = harness.state_mut().end_tour();
        assert_eq!(harness.state().model.view.kind, None, "the kind of picture, which the stop chose");
        assert_eq!(actions, source.map(Action::Open).into_iter().collect::<Vec<_>>());
    }
}

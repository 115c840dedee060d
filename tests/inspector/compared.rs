//! Two pictures side by side: of two techniques, settings or steps, with one pick and one view.

use super::by_hand::{with_draws, with_truth};
use super::*;
use stencilscope::ask::{CaptureOf, FilmSubject};
use stencilscope::inspector::DialogKind;
use stencilscope::scene::Orbit;

/// Two pictures side by side, the other one of another technique, in which the pixel at 3, 4 is lit.
fn side_by_side() -> Harness<'static, Seen> {
    compare_two(picked(z_fail(SIZE), [3, 4]))
}

fn compare_two(mut harness: Harness<'static, Seen>) -> Harness<'static, Seen> {
    click_button(&mut harness, "Compare");
    choose(&mut harness, "Compare with", "technique z-pass");
    reply::<CaptureOf>(&mut harness, Ok(other_side()));
    choose(&mut harness, "Layout of the comparison", "Beside");
    harness.run_steps(3);
    harness
}

fn other_side() -> Capture {
    let mut other = z_fail(SIZE);
    other.technique = "z-pass".to_owned();
    let mask = Image::uniform(PixelFormat::U8, SIZE, &[0]);
    other.lights[0].shadow = Some(Arc::new(mask));
    other
}

/// Chooses an entry of a list that is longer than it is high.
fn compare_with(harness: &mut Harness<Seen>, entry: &str) {
    click_role(harness, Role::ComboBox, "Compare with");
    harness.get_all_by_role_and_label(Role::Button, entry).last().expect("an entry").click_accesskit();
    harness.run_steps(3);
    // Only a click of the mouse closes the list.
    press(harness, Key::Escape);
}

fn canvases(harness: &Harness<Seen>) -> [Rect; 2] {
    ["Compared canvas", "Picture canvas"].map(|name| harness.get_by_label(name).rect())
}

#[test]
fn both_pictures_are_whole_and_as_large_and_each_says_what_it_makes_of_the_pick() {
    let mut harness = side_by_side();
    let [other, own] = canvases(&harness);
    assert!((other.width() - own.width()).abs() < 1.0 && (other.height() - own.height()).abs() < 1.0);
    assert!(own.left() >= other.right() - 1.0, "{other}, {own}");
    assert!(harness.query_by_label("Compare divider").is_none());
    let said = |harness: &Harness<Seen>, words: &str, within: Rect| {
        let nodes = harness.query_all_by_label_contains(words);
        nodes
            .filter(|node| node.rect().left() >= within.left() - 1.0 && node.rect().right() <= within.right() + 1.0)
            .count()
    };
    assert_eq!(said(&harness, "Lit by light 1", other), 1);
    assert!(said(&harness, "Dark under light 1: its stencil count is 1.", own) >= 1);
    press(&mut harness, Key::X);
    let [other, own] = canvases(&harness);
    assert!(other.left() >= own.right() - 1.0, "flipped: {own}, {other}");
    choose(&mut harness, "Layout of the comparison", "Divider");
    harness.get_by_label("Compare divider");
    assert!(harness.query_by_label("Compared canvas").is_none());
}

/// Beside a picture from before the volumes the count is still to come.
#[test]
fn each_side_says_of_which_moment_it_speaks() {
    let mut harness = side_by_side();
    change(&mut harness, |inspector| inspector.model.select_step(0));
    harness.run_steps(2);
    let [_, own] = canvases(&harness);
    let titles = harness.query_all_by_label_contains("Dark under light 1: its stencil count is ");
    let beside: Vec<String> = titles
        .filter(|node| node.rect().left() >= own.left() - 1.0 && node.rect().right() <= own.right() + 1.0)
        .filter_map(|node| node.value())
        .collect();
    assert!(
        !beside.is_empty() && beside.iter().all(|title| title.ends_with("once the light pass tests it.")),
        "{beside:?}"
    );
}

/// An export is of the moment at which it was asked for.
#[test]
fn a_running_animation_stops_when_its_moment_is_exported() {
    let mut harness = side_by_side();
    change(&mut harness, |inspector| inspector.model.animation.is_running = true);
    change(&mut harness, |inspector| inspector.model.dialog = Some(DialogKind::Export(ExportKind::Page)));
    harness.run_steps(2);
    assert!(!harness.state().inspector.model.animation.is_running);
}

/// What an export writes of both sides.
fn exported_both(harness: &mut Harness<Seen>, kind: ExportKind) -> Picture {
    match harness.state_mut().inspector.export(kind) {
        Some(ExportData::BothSides(both)) => both.finish().expect("captions"),
        other => panic!("both sides, not {other:?}"),
    }
}

#[test]
fn a_picture_of_a_comparison_has_both_sides_over_their_names() {
    let mut harness = side_by_side();
    change(&mut harness, |inspector| inspector.model.choose_picture(PictureKind::Mask));
    let (lit, dark) = ([0xf2, 0xd1, 0x6b], [0x46, 0x55, 0x7d]);
    let second = SIZE[0] + 8;
    for kind in [ExportKind::Picture, ExportKind::AsShown] {
        let both = exported_both(&mut harness, kind);
        assert_eq!(both.size(), [2 * SIZE[0] + 8, SIZE[1] + 20], "{kind:?}");
        assert_eq!([both.at([3, 4]), both.at([second + 3, 4])], [Some(lit), Some(dark)], "{kind:?}");
        let has_words = |left: u32| {
            let bar = (left..left + SIZE[0]).flat_map(|x| (SIZE[1]..SIZE[1] + 20).map(move |y| [x, y]));
            bar.filter(|at| both.at(*at) != both.at([left, SIZE[1]])).count() > 20
        };
        assert!(has_words(0) && has_words(second), "{kind:?}");
    }
    press(&mut harness, Key::X);
    let flipped = exported_both(&mut harness, ExportKind::Picture);
    assert_eq!([flipped.at([3, 4]), flipped.at([second + 3, 4])], [Some(dark), Some(lit)]);
    // Without a comparison there is one side.
    click_button(&mut harness, "Compare");
    let alone = harness.state_mut().inspector.export(ExportKind::Picture);
    assert!(matches!(alone, Some(ExportData::Picture(picture)) if picture.size() == SIZE));
}

#[test]
fn films_of_a_comparison_are_of_both_sides_as_they_stand() {
    let mut harness = side_by_side();
    let frames = |harness: &mut Harness<Seen>| match harness.state_mut().inspector.export(ExportKind::Steps) {
        Some(ExportData::Film(FilmSubject::Steps(sides))) => {
            sides.iter().map(|side| side.technique.clone()).collect::<Vec<_>>()
        }
        other => panic!("a film, not {other:?}"),
    };
    assert_eq!(frames(&mut harness), ["z-pass", "z-fail"]);
    press(&mut harness, Key::X);
    assert_eq!(frames(&mut harness), ["z-fail", "z-pass"]);
    let round = harness.state_mut().inspector.export(ExportKind::LightRound);
    let Some(ExportData::Film(FilmSubject::LightRound { sides, .. })) = round else { panic!("a film") };
    let techniques: Vec<Technique> = sides.iter().map(|side| side.choice.technique()).collect();
    assert_eq!(techniques, [Technique::ZFail, Technique::ZPass]);
}

/// What an export leaves out of a comparison is said before it is written.
#[test]
fn each_export_says_which_side_it_carries() {
    let mut harness = side_by_side();
    let said = |harness: &mut Harness<Seen>, kind: ExportKind| {
        change(harness, |inspector| inspector.model.dialog = Some(DialogKind::Export(kind)));
        let said = harness.query_all_by_label_contains("Carries ").filter_map(|node| node.value()).next();
        press(harness, Key::Escape);
        said.unwrap_or_default()
    };
    for kind in [ExportKind::Picture, ExportKind::AsShown, ExportKind::Steps, ExportKind::LightRound] {
        assert_eq!(said(&mut harness, kind), "Carries both sides, each over its name: z-pass and z-fail.", "{kind:?}");
    }
    for kind in [ExportKind::Page, ExportKind::Capture, ExportKind::Data, ExportKind::Scene] {
        let said = said(&mut harness, kind);
        assert!(said.starts_with("Carries one side alone, z-fail, and not z-pass: "), "{kind:?}: {said}");
    }
    click_button(&mut harness, "Compare");
    assert_eq!(said(&mut harness, ExportKind::Page), "", "nothing is compared");
}

/// A scene whose light goes round, compared with z-pass at its start.
fn moving() -> Harness<'static, Seen> {
    let mut scene = scene();
    scene.lights = vec![stencilscope::scene::Light::point(DVec3::new(1.0, 4.0, 0.0))];
    scene.lights[0].motion.orbit = Some(Orbit { center: DVec3::ZERO, axis: DVec3::Y, degrees_per_second: 90.0 });
    let mut inspector = inspector(z_fail(SIZE));
    inspector.set_scene(&scene, RunRequest::of(&scene, Choice::new(Technique::ZFail), SIZE));
    inspector.set_capture(Arc::new(z_fail(SIZE)));
    inspector.model.selection.pick = Some([3, 4]);
    compare_two(harness_of(inspector))
}

#[test]
fn both_sides_live_while_an_animation_runs_and_say_their_time() {
    let mut harness = moving();
    assert!(says(&harness, "z-pass · step 3 · 0.00 s") && says(&harness, "z-fail · step 3 · 0.00 s"));
    harness.state_mut().actions.clear();
    change(&mut harness, |inspector| inspector.model.animation.is_running = true);
    let time = last_run(&harness).time;
    assert!(time > 0.0);
    // The next moment is not there yet: the last one stays on both sides.
    harness.get_by_label("Compared canvas");
    assert!(says(&harness, "z-pass · step 3 · 0.00 s") && !says(&harness, "Capturing z-pass"));
    show_capture(&mut harness, z_fail(SIZE));
    let now = format!("z-fail · step 3 · {time:.2} s");
    assert!(says(&harness, &now) && says(&harness, "z-pass · step 3 · 0.00 s"));
    assert!(!says(&harness, "differ:"), "two moments are not counted as a difference");
    assert_eq!(runs(&harness).len(), 1, "it waits for the other side");
    let asked = asks::<CaptureOf>(&harness).pop().expect("it is asked for");
    assert_eq!(asked.request.time, time);
    reply::<CaptureOf>(&mut harness, Ok(other_side()));
    assert!(says(&harness, &format!("z-pass · step 3 · {time:.2} s")));
    harness.run_steps(2);
    assert_eq!(runs(&harness).len(), 2, "and goes on");
    harness.get_by_label_contains(&format!("at {time:.2} s"));
}

#[test]
fn both_sides_are_stepped_draw_by_draw() {
    let mut harness = compare_two(picked(with_draws(z_fail(SIZE)), [3, 4]));
    change(&mut harness, |inspector| inspector.select_draw(1, 0));
    let asked = asks::<CaptureOf>(&harness).pop().expect("it is asked for");
    assert_eq!(asked.draws_of, Some(1), "the draws of the pass");
    harness.get_by_label_contains("z-pass · step 2 (the whole pass, until its draws are captured)");
    // The other has one draw more before them, and no cap.
    let mut other = with_draws(other_side());
    other.steps[1].draws.pop();
    let mut first = other.steps[1].draws[0].clone();
    first.name = "sides of lid".to_owned();
    other.steps[1].draws.insert(0, first);
    reply::<CaptureOf>(&mut harness, Ok(other));
    harness.get_by_label_contains("z-pass · draw 2 of step 2");
    harness.get_by_label_contains("z-fail · draw 1 of step 2");
    change(&mut harness, |inspector| inspector.select_draw(1, 1));
    harness.get_by_label_contains("z-pass · draw 2 of step 2 (no dark cap of box)");
    let count = asks::<CaptureOf>(&harness).len();
    change(&mut harness, |inspector| inspector.model.select_step(1));
    assert_eq!(asks::<CaptureOf>(&harness).len(), count, "nothing is captured again");
}

/// The other frame is held against the truth, too, as soon as the shown one is.
#[test]
fn error_is_shown_of_both_sides() {
    let mut harness = compare_two(picked(with_truth(z_fail(SIZE)), [3, 4]));
    let asked = asks::<CaptureOf>(&harness).pop().expect("it is asked for");
    assert!(asked.is_judged);
    change(&mut harness, |inspector| inspector.model.choose_picture(PictureKind::Error));
    harness.get_by_label_contains("Holding z-pass against the truth");
    change(&mut harness, |inspector| inspector.take_in(asked, Ok(Arc::new(with_truth(other_side())))));
    assert!(!says(&harness, "Holding z-pass") && !says(&harness, "no such picture"));
}

/// A scene that is opened is compared as the one before, where that means something.
#[test]
fn opening_a_scene_keeps_a_comparison_with_another_technique() {
    let mut harness = side_by_side();
    let open = |harness: &mut Harness<Seen>, name: &str, technique: Technique| {
        let scene = Scene { name: name.to_owned(), ..scene() };
        change(harness, |inspector| inspector.set_scene(&scene, run_request(technique)));
        show_capture(harness, z_fail(SIZE));
        harness.state().inspector.model.modes.compare
    };
    let kept = open(&mut harness, "another", Technique::ZFail).expect("a comparison");
    assert!(kept.has_two_places());
    assert!(says(&harness, "Capturing z-pass"), "of the new scene, and not the old one's");
    assert_eq!(asks::<CaptureOf>(&harness).len(), 2);
    assert!(open(&mut harness, "a third", Technique::ZPass).is_none(), "with itself");
    click_button(&mut harness, "Compare");
    assert!(open(&mut harness, "a fourth", Technique::ZPass).is_none(), "a step of the scene before");
}

#[test]
fn a_pass_that_the_other_side_lacks_is_named() {
    let mut harness = side_by_side();
    let mut other = other_side();
    other.steps.remove(1);
    change(&mut harness, |inspector| {
        let asked = inspector.model.answers.current::<CaptureOf>().map(|(asked, _)| asked.clone());
        inspector.take_in(asked.expect("a comparison"), Ok(Arc::new(other)));
        inspector.model.select_step(1);
    });
    harness.get_by_label_contains("(no volumes: the whole frame)");
}

#[test]
fn a_pick_and_a_zoom_in_one_are_those_of_the_other() {
    let mut harness = side_by_side();
    let [other, _] = canvases(&harness);
    let scale = (other.width() / SIZE[0] as f32).min(other.height() / SIZE[1] as f32);
    let at = other.center() + (vec2(10.5, 20.5) - vec2(20.0, 15.0)) * scale;
    mouse(&mut harness, at, PointerButton::Secondary);
    assert_eq!(harness.state().inspector.model.selection.pick, Some([10, 20]));
    assert_eq!(harness.state().inspector.model.selection.hover.map(|hover| hover.at), Some([10, 20]));
    let before = window_picture(&mut harness);
    wheel(&mut harness, 200.0);
    harness.run_steps(8);
    assert!(matches!(harness.state().inspector.model.view.zoom, TexelZoom::Pixels(pixels) if pixels > scale));
    let after = window_picture(&mut harness);
    // Both are drawn anew: a place in each looks different.
    for canvas in canvases(&harness) {
        let differs = |x: u32, y: u32| before.at([x, y]) != after.at([x, y]);
        let [left, right] = [canvas.left() as u32 + 2, canvas.right() as u32 - 2];
        let [top, bottom] = [canvas.top() as u32 + 2, canvas.bottom() as u32 - 2];
        assert!((top..bottom).any(|y| (left..right).any(|x| differs(x, y))), "{canvas}");
    }
}

#[test]
fn a_setting_is_compared_with_another_value_of_it_and_with_the_defaults() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "Compare");
    compare_with(&mut harness, "caps none");
    let choice = |harness: &Harness<Seen>| asks::<CaptureOf>(harness).pop().expect("it is asked for").request.choice;
    let mut expected = Choice::new(Technique::ZFail);
    expected.set("caps", "none").expect("a setting");
    assert_eq!(choice(&harness), expected);
    harness.get_by_label_contains("Capturing caps none");
    // The defaults are offered where others are in use.
    change(&mut harness, |inspector| drop(inspector.choose(expected.clone())));
    change(&mut harness, |inspector| inspector.set_capture(Arc::new(z_fail(SIZE))));
    compare_with(&mut harness, "default settings");
    assert_eq!(choice(&harness), Choice::new(Technique::ZFail));
    // A technique that has no such setting says so.
    compare_with(&mut harness, "caps light");
    change(&mut harness, |inspector| drop(inspector.choose(Choice::new(Technique::ShadowMap))));
    change(&mut harness, |inspector| inspector.set_capture(Arc::new(z_fail(SIZE))));
    harness.get_by_label_contains("shadow-map has no setting `caps`");
}

/// Settings come first, a line for each, and of numbers some are offered.
#[test]
fn what_to_compare_with_is_in_groups_and_has_numbers() {
    let mut harness = harness_in(inspector(z_fail(SIZE)), WINDOW);
    click_button(&mut harness, "shadow-map");
    show_capture(&mut harness, cube_map());
    click_button(&mut harness, "Compare");
    click_role(&mut harness, Role::ComboBox, "Compare with");
    let top = |words: &str| harness.get_all_by_label(words).last().expect("an entry").rect().top();
    let [technique, setting, step] = ["Another technique", "Another setting of shadow-map", "Another step"].map(top);
    assert!(technique < setting && setting < step, "{technique}, {setting}, {step}");
    assert!(top("size 2048") < top("cull back"), "what has numbers is first");
    assert!((top("cull front") - top("cull back")).abs() < 2.0, "a line for each setting");
    assert!(says(&harness, "size 2048") && says(&harness, "bias-slope 0"));
}

/// What counts texels counts those of its own side, and the outlines of casters are the same on both.
#[test]
fn each_side_has_its_legend() {
    let mut inspector = inspector(z_fail(SIZE));
    inspector.model.select_step(1);
    let mut harness = compare_two(harness_in(inspector, [1920.0, 1080.0]));
    click_button(&mut harness, "Mask");
    harness.run_steps(3);
    let legends = harness.query_all_by_label("Mask, light 1").map(|node| node.rect());
    let legends: Vec<Rect> = legends.collect();
    let [other, own] = canvases(&harness);
    assert_eq!(legends.len(), 2, "{legends:?}");
    for side in [other, own] {
        assert!(legends.iter().any(|legend| side.contains_rect(*legend)), "{legends:?}");
    }
    // All is lit by the other technique.
    harness.get_by_label("1\u{a0}200");
    assert_eq!(harness.query_all_by_label("0 lit").count(), 2);
}

/// Values that do not fit into one line stay beside the name of their setting.
#[test]
fn values_of_a_setting_wrap_beside_its_name() {
    let mut harness = harness_in(inspector(z_fail(SIZE)), [1280.0, 1000.0]);
    click_button(&mut harness, "shadow-map");
    show_capture(&mut harness, cube_map());
    click_button(&mut harness, "Compare");
    click_role(&mut harness, Role::ComboBox, "Compare with");
    let left =
        |harness: &Harness<Seen>, words: &str| harness.get_all_by_label(words).last().expect("an entry").rect().left();
    let first = left(&harness, "size 256");
    let lines: Vec<(String, Rect)> = harness
        .query_all_by_role(Role::Button)
        .filter_map(|node| Some((node.accesskit_node().label()?, node.rect())))
        .filter(|(label, _)| {
            ["size ", "filter ", "cull ", "bias-", "receivers "].iter().any(|key| label.starts_with(key))
        })
        .collect();
    assert!(lines.len() > 12, "{lines:?}");
    assert!(lines.iter().all(|(_, place)| place.left() >= first - 1.0), "{first}: {lines:?}");
}

/// Where no faces are counted, nothing is counted twice.
#[test]
fn the_card_of_silhouettes_speaks_of_counting_only_where_something_is_counted() {
    for (capture, counts) in [(z_fail(SIZE), true), (cube_map(), false)] {
        let mut harness = harness(capture);
        change(&mut harness, |inspector| {
            inspector.model.modes.overlays.extend([stencilscope::inspector::Overlay::Silhouettes]);
        });
        assert_eq!(says(&harness, "counted twice"), counts);
        assert!(says(&harness, "silhouette edge"));
    }
}

#[test]
fn the_frame_before_the_last_change_is_compared_with_what_it_became() {
    let mut harness = harness(z_fail(SIZE));
    // Only what can be opened again by name is known to be the same scene.
    change(&mut harness, |inspector| {
        inspector.open_scene(&scene(), run_request(Technique::ZFail), Some("by hand".to_owned()));
        inspector.set_capture(Arc::new(z_fail(SIZE)));
    });
    click_button(&mut harness, "Compare");
    let entries = |harness: &Harness<Seen>| harness.query_all_by_label_contains("before the change").count();
    click_role(&mut harness, Role::ComboBox, "Compare with");
    assert_eq!(entries(&harness), 0, "nothing is changed yet");
    press(&mut harness, Key::Escape);
    let before = last_draft(&harness);
    change(&mut harness, |inspector| {
        let mut draft = before.clone();
        draft.lights[0].position.y += 0.5;
        let actions = inspector.rerun(draft);
        assert_eq!(actions.len(), 1);
    });
    show_capture(&mut harness, z_fail(SIZE));
    compare_with(&mut harness, "before the change: light 1");
    let asked = asks::<CaptureOf>(&harness);
    assert_eq!(asked.last().map(|asked| &*asked.request), Some(&before));
    reply::<CaptureOf>(&mut harness, Ok(other_side()));
    harness.run_steps(3);
    let shown: Vec<String> = contrast::words(&harness).into_iter().map(|word| word.text).collect();
    for words in ["before the change", "after the change"] {
        assert!(shown.iter().any(|text| text.starts_with(words)), "{words}: {shown:?}");
    }
    let model = &harness.state().inspector.model;
    assert!(!model.compares_one_scene(), "a film has one scene");
    assert!(model.both_frames().is_none());
    // Another technique of the same scene is what every other comparison is of.
    change(&mut harness, |inspector| assert_eq!(inspector.rerun(before).len(), 1));
    show_capture(&mut harness, z_fail(SIZE));
    change(&mut harness, |inspector| {
        let mut draft = *inspector.draft().expect("a scene");
        draft.choice = Choice::new(Technique::ZPass);
        assert_eq!(inspector.rerun(draft).len(), 1);
    });
    assert!(harness.state().inspector.model.compares_one_scene());
}

fn last_draft(harness: &Harness<Seen>) -> RunRequest {
    *harness.state().inspector.draft().expect("a scene")
}

//! The history of the picked pixel: when it is asked for, its rows, its ladder, and what a selected
//! triangle shows elsewhere.

use super::history_by_hand::{FACES, Face, history};
use super::*;
use egui::accesskit::Toggled;
use egui_kittest::Node;
use stencilscope::history::{PixelEvent, PixelEventKind, PixelHistory};
use stencilscope::reading::coordinates::{PixelCoordinates, matrix_text, vector};
use stencilscope::reading::shading::{SurfaceShading, three};

/// Inside the volume: its count is 1.
pub const DARK: [u32; 2] = [3, 4];

fn picked(at: [u32; 2]) -> Harness<'static, Seen> {
    let mut inspector = inspector(z_fail(SIZE));
    inspector.model.selection.pick = Some(at);
    harness_in(inspector, TALL)
}

pub fn answer(harness: &mut Harness<Seen>, history: PixelHistory) {
    let asked = asks::<HistoryOf>(harness).pop();
    // An answer to what is asked no more is dropped.
    let is_asked = asked.is_some_and(|asked| asked.at == history.pixel);
    let ticket = if is_asked { last_asked::<HistoryOf>(harness).ticket } else { 0 };
    change(harness, |inspector| inspector.answer(ticket, Ok(Answer::HistoryOf(Arc::new(history))), true));
}

fn answered(faces: &[Face]) -> Harness<'static, Seen> {
    let mut harness = picked(DARK);
    answer(&mut harness, history(DARK, faces));
    harness
}

fn asked(harness: &Harness<Seen>) -> Vec<[u32; 2]> {
    asks::<HistoryOf>(harness).into_iter().map(|ask| ask.at).collect()
}

fn rows(harness: &Harness<Seen>) -> Vec<String> {
    let rows = harness.query_all_by_role(Role::Row);
    rows.filter_map(|row| row.accesskit_node().label())
        .filter(|label| label.starts_with("pass ") || label.starts_with("mask: "))
        .collect()
}

#[test]
fn histories_by_hand_agree_with_the_capture_by_hand() {
    assert_eq!(history(DARK, &FACES).disagreements(), []);
    assert_eq!(history(DARK, &FACES).computed.stencil, 1);
}

#[test]
fn a_pick_is_asked_about_once_and_again_when_it_moves_or_the_frame_changes() {
    let mut harness = picked(DARK);
    harness.run_steps(3);
    assert_eq!(asked(&harness), [DARK]);
    change(&mut harness, |inspector| inspector.model.selection.pick = Some([4, 4]));
    answer(&mut harness, history([4, 4], &FACES));
    assert_eq!(asked(&harness), [DARK, [4, 4]]);
    change(&mut harness, |inspector| inspector.model.update_capture(Arc::new(z_fail(SIZE))));
    assert_eq!(asked(&harness).len(), 2, "the same frame, of which more is known");
    show_capture(&mut harness, z_fail(SIZE));
    assert_eq!(asked(&harness), [DARK, [4, 4], [4, 4]]);
}

#[test]
fn without_a_pick_nothing_is_asked() {
    let harness = harness_in(inspector(z_fail(SIZE)), TALL);
    assert_eq!(asked(&harness), [[0; 2]; 0]);
}

#[test]
fn every_event_is_a_row_with_its_signs() {
    let harness = answered(&FACES);
    assert_eq!(
        rows(&harness),
        [
            "pass 1: clear depth; → 0",
            "pass 1: clear stencil; → 0",
            "pass 1: floor, front; depth ✓, stencil always; → 4.000 m",
            "pass 2: side of box, front; depth ✓, stencil always; keep; 0",
            "pass 2: side of box, back; depth ✓, stencil always; keep; 0",
            "pass 2: side of box, front; depth ✗, stencil always; −1; 0 → −1",
            "pass 2: side of box, back; depth ✗, stencil always; +1; −1 → 0",
            "pass 2: dark cap of box, back; depth ✗, stencil always; +1; 0 → 1",
            "mask: floor, front; depth -, stencil ✗; keep; 1",
            "pass 3: floor, front; depth -, stencil ✗; keep; 1",
        ]
    );
    harness.get_by_label("10 events");
    harness.get_by_label("· as the GPU stored it");
}

/// What the shown step has not come to yet is told apart from what has happened.
#[test]
fn what_comes_after_the_shown_step_is_marked() {
    let mut harness = answered(&FACES);
    let later = |harness: &Harness<Seen>| {
        rows(harness).iter().map(|row| row.ends_with(", after the shown step")).collect::<Vec<_>>()
    };
    assert_eq!(later(&harness), [false; 10], "the last step is shown");
    change(&mut harness, |inspector| inspector.model.select_step(1));
    assert_eq!(later(&harness), [[false; 8].as_slice(), &[true; 2]].concat(), "volumes");
    press(&mut harness, Key::Home);
    assert_eq!(later(&harness), [[false; 3].as_slice(), &[true; 7]].concat(), "ambient");
}

#[test]
fn hiding_leaves_what_did_something() {
    let mut harness = answered(&FACES);
    click(&mut harness, "Hide idle");
    let left = rows(&harness);
    assert_eq!(left.len(), 5, "the floor, the faces behind it, and what the stencil decides: {left:?}");
    assert!(left[1..4].iter().all(|row| row.contains("depth ✗")), "{left:?}");
    assert!(left[4].starts_with("pass 3: floor") && left[4].contains("stencil ✗"), "{left:?}");
    harness.get_by_label("5 of 10 events");
    click(&mut harness, "Hide idle");
    assert_eq!(rows(&harness).len(), 10);
}

#[test]
fn a_click_selects_and_a_double_click_goes_to_the_step() {
    let mut harness = answered(&FACES);
    let row = "pass 2: dark cap of box, back; depth ✗, stencil always; +1; 0 → 1";
    click(&mut harness, row);
    assert_eq!(
        (harness.state().inspector.selected_event(), harness.state().inspector.model.selection.step),
        (Some(7), 3)
    );
    harness.get_by_label(
        "dark cap of box, triangle 5, back, at 40.000 m: behind the surface, fails the depth test; increment-wrap: stencil 0 to 1",
    );
    // An event of the harness takes a quarter of a second.
    harness.ctx.options_mut(|options| options.input_options.max_double_click_delay = 1.0);
    harness.run_steps(12);
    harness.get_by_label(row).click();
    harness.get_by_label(row).click();
    harness.run_steps(8);
    assert_eq!(harness.state().inspector.model.selection.step, 1);
}

#[test]
fn the_menu_of_an_event_goes_to_its_step_and_to_its_triangle_in_the_scene() {
    let mut harness = answered(&FACES);
    let row = "pass 2: dark cap of box, back; depth ✗, stencil always; +1; 0 → 1";
    harness.get_by_label(row).click_secondary();
    harness.run_steps(3);
    click(&mut harness, "Go to this step");
    assert_eq!(harness.state().inspector.model.selection.step, 1);
    harness.get_by_label(row).click_secondary();
    harness.run_steps(3);
    click(&mut harness, "Show the triangle in the Scene tab");
    assert_eq!(harness.state().inspector.selected_event(), Some(7));
    let tab = harness.get_by_role_and_label(Role::Tab, "Scene");
    assert_eq!(tab.accesskit_node().toggled(), Some(Toggled::True));
}

#[test]
fn the_selected_event_is_gone_to_by_keys_alone() {
    let mut harness = answered(&FACES);
    focus(&mut harness, "pass 2: side of box, front; depth ✗, stencil always; −1; 0 → −1");
    press(&mut harness, Key::Enter);
    assert_eq!(harness.state().inspector.selected_event(), Some(5));
    focus_role(&mut harness, Role::Button, "Go to draw 1 of step 2, volumes");
    press(&mut harness, Key::Enter);
    assert_eq!(harness.state().inspector.model.selection.step, 1);
}

#[test]
fn a_rung_selects_its_row_and_a_row_its_rung() {
    let mut harness = answered(&FACES);
    harness.get_by_label("Counted from infinity towards the surface. 3 of 5 faces count: 1 in all.");
    click(&mut harness, "rung: side of box, triangle 4, back, at 10.000 m: +1, count 2");
    assert_eq!(harness.state().inspector.selected_event(), Some(6));
    click(&mut harness, "pass 2: side of box, back; depth ✓, stencil always; keep; 0");
    assert_eq!(harness.state().inspector.selected_event(), Some(4));
    let rung = harness.get_by_label("rung: side of box, triangle 2, back, at 3.000 m: not counted, count 1");
    assert_eq!(rung.accesskit_node().toggled(), Some(Toggled::True));
    harness.get_by_label("rung: side of box, triangle 3, front, at 8.000 m: −1, count 1");
    harness.get_by_label("rung: dark cap of box, triangle 5, back, at 40.000 m: +1, count 1");
}

#[test]
fn the_selected_triangle_stays_where_the_next_pixel_has_it_too() {
    let mut harness = answered(&FACES);
    click(&mut harness, "rung: side of box, triangle 4, back, at 10.000 m: +1, count 2");
    change(&mut harness, |inspector| inspector.model.selection.pick = Some([4, 4]));
    answer(&mut harness, history([4, 4], &FACES));
    assert_eq!(harness.state().inspector.selected_event(), Some(6));
    change(&mut harness, |inspector| inspector.model.selection.pick = Some([5, 4]));
    answer(&mut harness, history([5, 4], &[]));
    assert_eq!(harness.state().inspector.selected_event(), None);
}

#[test]
fn passes_that_touched_the_pixel_are_marked() {
    let harness = answered(&FACES);
    let marks = |harness: &Harness<Seen>| {
        let is_marked = |step: &&str| {
            let label = format!("{step} touched the picked pixel");
            harness.query_by_label(&label).is_some()
        };
        ["step 1", "step 2", "the mask of light 1", "step 3"].into_iter().filter(is_marked).collect::<Vec<_>>()
    };
    assert_eq!(marks(&harness), ["step 1", "step 2"], "mask and light failed the stencil test");
    // Faces before the surface count nothing.
    let harness = answered(&FACES[..2]);
    assert_eq!(marks(&harness), ["step 1", "the mask of light 1", "step 3"]);
    assert_eq!(marks(&picked(DARK)), [""; 0]);
}

#[test]
fn the_sentence_on_top_counts_the_faces() {
    let mut harness = answered(&FACES);
    harness.get_by_label("Dark under light 1: its stencil count is 1.");
    let why =
        "3 volume faces behind the surface fail the depth test: 2 back, 1 front; count 1, so the light pass skips it.";
    harness.get_by_label(why);
    let lit = [30, 4];
    change(&mut harness, |inspector| inspector.model.selection.pick = Some(lit));
    harness.get_by_label("The volume faces behind the surface cancel out, so the light pass adds the light.");
    answer(&mut harness, history(lit, &[]));
    harness.get_by_label(
        "Lit by light 1: its stencil count was 0 when the light pass tested it; the pass then made it 1.",
    );
    harness.get_by_label("No volume face on the view ray counts; count 0, so the light pass adds the light.");
    harness.get_by_label("No volume face of light 1 is on this pixel's view ray.");
}

#[test]
fn an_answer_about_another_pixel_is_dropped_and_the_last_one_stays_greyed() {
    let mut harness = answered(&FACES);
    harness.state_mut().inspector.model.selection.pick = Some([4, 4]);
    harness.run_steps(1);
    assert_eq!(rows(&harness).len(), 10, "the last one stays");
    harness.run_steps(2);
    harness.get_by_label("waiting for 4, 4 …");
    answer(&mut harness, history([5, 5], &[]));
    harness.get_by_label("waiting for 4, 4 …");
    assert_eq!((rows(&harness).len(), harness.state().inspector.selected_event()), (10, None));
    answer(&mut harness, history([4, 4], &[]));
    assert_eq!(rows(&harness).len(), 5);
    assert!(harness.query_by_label_contains("waiting for").is_none());
}

#[test]
fn what_failed_is_said_and_not_asked_again_until_the_pick_moves() {
    let mut harness = picked(DARK);
    reply::<HistoryOf>(&mut harness, Err("the GPU was lost: open the scene again".to_owned()));
    harness.run_steps(3);
    harness.get_by_label("× There is no history: the GPU was lost: open the scene again");
    assert_eq!(asked(&harness).len(), 1);
    change(&mut harness, |inspector| inspector.model.selection.pick = Some([4, 4]));
    assert_eq!(asked(&harness).len(), 2);
    assert!(harness.query_by_label_contains("There is no history").is_none());
}

#[test]
fn a_folder_says_what_histories_need() {
    let mut inspector = inspector(z_fail(SIZE));
    inspector.open_folder(None);
    inspector.model.selection.pick = Some(DARK);
    let mut harness = harness_in(inspector, TALL);
    assert_eq!(asked(&harness), [[0; 2]; 0]);
    answer(&mut harness, history(DARK, &FACES));
    assert!(rows(&harness).is_empty(), "an answer that was on its way");
    harness.get_by_label_contains("A capture folder holds pictures and no geometry");
    harness.get_by_label_contains("stencilscope pixel SCENE --at X,Y");
    assert!(harness.query_by_label("Ladder").is_none());
}

#[test]
fn a_history_that_contradicts_the_gpu_says_so() {
    let mut wrong = history(DARK, &FACES);
    wrong.events.remove(7);
    let mut harness = picked(DARK);
    answer(&mut harness, wrong);
    harness.get_by_label("× This history is wrong, by the GPU's rounding or a bug of stencilscope: please report it");
    harness.get_by_label("the GPU counted 8 fragments, and 7 are listed");
    assert!(harness.query_by_label("· as the GPU stored it").is_none());
}

/// What another program's shader may have discarded is not known, and no bug.
#[test]
fn a_fragment_that_a_shader_may_have_discarded_is_why_the_gpu_stored_something_else() {
    let mut unknown = history(DARK, &FACES);
    let is_changing = |event: &&mut PixelEvent| event.after != event.before;
    for event in unknown.events.iter_mut().filter(is_changing) {
        if let PixelEventKind::Triangle(triangle) = &mut event.kind {
            triangle.may_discard = true;
        }
    }
    assert_eq!(
        unknown.why_disagreeing(),
        "The GPU stored something else: the shader of floor may have discarded its fragment, which is taken to be there"
    );
    // Before the fragment it explains nothing: here a count after the first pass, of a fragment of the second.
    let mut earlier = unknown.clone();
    for event in &mut earlier.events {
        if let PixelEventKind::Triangle(triangle) = &mut event.kind {
            triangle.may_discard &= event.pass > 0;
        }
    }
    earlier.captured_after[0].stored.depth = 0.125;
    assert!(earlier.unknown_discard().is_none() && earlier.why_disagreeing().contains("please report it"));
    for captured in &mut unknown.captured_after {
        captured.stored.depth = 0.125;
    }
    let said = format!("!! {}", unknown.why_disagreeing());
    assert!(unknown.story(&z_fail(SIZE).depth).contains(&said));
    let mut harness = picked(DARK);
    let why = format!("× {}", unknown.why_disagreeing());
    answer(&mut harness, unknown);
    harness.get_by_label(&why);
}

#[test]
fn of_600_events_only_visible_rows_are_drawn_and_a_rung_scrolls_to_its_row() {
    let faces: Vec<Face> = (0..595).map(|index| (DrawPart::Side, index % 2 == 1, 4.5 + index as f32 * 0.1)).collect();
    let mut harness = answered(&faces);
    harness.get_by_label("600 events");
    assert!((12..=14).contains(&rows(&harness).len()), "{} rows", rows(&harness).len());
    let last = "rung: side of box, triangle 595, back, at 63.900 m: +1, count 1";
    click(&mut harness, last);
    let selected = harness.state().inspector.selected_event();
    assert_eq!(selected, Some(597));
    let is_selected = |row: &Node| row.accesskit_node().toggled() == Some(Toggled::True);
    let row = harness.query_all_by_role(Role::Row).find(is_selected).expect("the row");
    assert_eq!(
        row.accesskit_node().label().as_deref(),
        Some("pass 2: side of box, back; depth ✗, stencil always; +1; 0 → 1")
    );
    let rungs = harness.query_all_by_role(Role::ListItem).filter_map(|rung| rung.accesskit_node().label());
    assert!(rungs.filter(|label| label.starts_with("rung: ")).count() <= 16);
}

#[test]
fn folded_rungs_open_by_a_click_or_by_enter_and_fold_again() {
    let faces: Vec<Face> = (0..300).map(|index| (DrawPart::Side, index % 2 == 1, 4.5 + index as f32 * 0.1)).collect();
    let mut harness = answered(&faces);
    let rungs = |harness: &Harness<Seen>| {
        let rungs = harness.query_all_by_role(Role::ListItem).filter_map(|rung| rung.accesskit_node().label());
        rungs.filter(|label| label.starts_with("rung: ")).count()
    };
    assert_eq!(rungs(&harness), 4);
    let enter = |harness: &mut Harness<Seen>, button: &str| {
        focus_role(harness, Role::Button, button);
        press(harness, Key::Enter);
    };
    click(&mut harness, "+296 more, adding 0");
    assert_eq!(rungs(&harness), 104);
    enter(&mut harness, "+196 more, adding 0");
    assert_eq!(rungs(&harness), 204);
    enter(&mut harness, "Fold");
    assert_eq!(rungs(&harness), 4);
    enter(&mut harness, "+296 more, adding 0");
    assert_eq!(rungs(&harness), 104);
    change(&mut harness, |inspector| inspector.model.selection.pick = Some([3, 5]));
    answer(&mut harness, history([3, 5], &faces));
    assert_eq!(rungs(&harness), 4, "another pixel has other faces");
    assert!(harness.query_by_label("Fold").is_none());
}

#[test]
fn a_dragged_pick_ends_with_the_answer_for_its_last_place() {
    let mut harness = answered(&FACES);
    // Each answer comes when the pick has moved on, the last one but one again after the last.
    for x in 4..=9 {
        harness.state_mut().inspector.model.selection.pick = Some([x, 4]);
        harness.run_steps(1);
        answer(&mut harness, history([x - 1, 4], &FACES));
    }
    answer(&mut harness, history([9, 4], &FACES[..2]));
    answer(&mut harness, history([8, 4], &FACES));
    assert_eq!(asked(&harness), [3, 4, 5, 6, 7, 8, 9].map(|x| [x, 4]));
    assert_eq!(rows(&harness).len(), 7);
    assert!(harness.query_by_label_contains("waiting for").is_none());
}

#[test]
fn what_the_near_plane_clipped_counts_nowhere_and_says_so() {
    let mut faces = FACES.to_vec();
    faces.insert(0, (DrawPart::Side, true, 0.05));
    let harness = answered(&faces);
    assert!(rows(&harness).contains(&"pass 2: side of box, front; clipped at near; 0".to_owned()));
    harness.get_by_label("rung: side of box, triangle 1, front, at 0.0500 m: not counted, count 1");
    let clipped = history(DARK, &faces[..1]);
    assert_eq!(clipped.counted_side(0), None, "it does not tell which side counts");
    assert!(clipped.agrees());
}

#[test]
fn faces_that_are_drawn_in_two_passes_are_one_rung_each() {
    let once = history(DARK, &FACES);
    let mut twice = once.clone();
    let second = once.events.iter().filter(|event| event.is_of_volume()).cloned();
    twice.events.extend(second.map(|event| PixelEvent { pass: 2, before: event.after, ..event }));
    let curve = z_fail(SIZE).depth;
    assert_eq!(twice.ladder(0, &curve), once.ladder(0, &curve));
}

#[test]
fn where_only_the_near_plane_counts_the_ladder_begins_and_ends_with_it() {
    let mut inside = history(DARK, &[]);
    let mut near = history(DARK, &FACES[4..]).events.remove(3);
    near.is_from_camera = false;
    inside.events.insert(3, near);
    let mut harness = picked(DARK);
    answer(&mut harness, inside);
    harness.get_by_label(
        "Counted from the eye towards the surface, starting at 1: the volumes that hold the near plane. 0 of 0 faces \
         count: 1 in all.",
    );
}

/// Caps are drawn with flipped winding; what is called front and back is nonetheless what techniques say of it.
#[test]
fn behind_the_surface_back_faces_add_and_before_it_front_faces() {
    let mut session = common::session();
    let cases = [
        ("tori", Technique::ZFail, -1),
        ("tori", Technique::ZPass, 1),
        ("inside", Technique::ZPassPlus, 1),
        ("gate", Technique::ZFail, -1),
        ("inside", Technique::ZFail, -1),
    ];
    let mut of_technique: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (scene, technique, front) in cases {
        let frame = common::frame(&mut session, scene, common::request(technique, [64, 36]));
        let parts = of_technique.entry(technique.name()).or_default();
        for at in common::pixels([64, 36]).filter(|[x, _]| x % 3 == 0) {
            let history = session.history(&frame.plan, &frame.capture, at).expect("a history");
            let faces = history.triangles().filter(|(event, _)| event.is_of_volume() && event.is_from_camera);
            for (event, one) in faces.filter(|(event, _)| event.counted() != 0) {
                let expected = if one.shows_outside() { front } else { -front };
                assert_eq!(event.counted(), expected, "{scene} {technique:?} {at:?}: {one:?}");
                parts.insert(one.part.name());
            }
        }
    }
    // The far ends of z-fail's volumes are in view in some of them.
    for (technique, parts) in of_technique {
        assert_eq!(parts.contains("dark-cap"), technique == Technique::ZFail.name(), "{technique}: {parts:?}");
    }
}

#[test]
fn coordinates_unfold_into_every_space_and_matrix() {
    let mut harness = picked(DARK);
    assert!(harness.query_by_label("NDC").is_none(), "folded at first");
    harness.get_by_label("Coordinates").click();
    harness.run_steps(20);
    for label in ["world", "eye", "clip", "NDC", "window", "camera", "step, 24 bits", "clip from eye, then back:"] {
        harness.get_by_label(label);
    }
}

#[test]
fn a_click_on_a_corner_shows_its_coordinates_and_another_on_the_point_brings_it_back() {
    let (mut session, at) = (common::session(), [80, 60]);
    let frame = common::frame(&mut session, "tetrahedron", common::request(Technique::ZFail, [160, 120]));
    let history = session.history(&frame.plan, &frame.capture, at).expect("a history");
    let place = PixelCoordinates::of(&frame.capture, at).with_vertices(&frame.capture, &frame.plan, &history);
    let mut inspector = explain::over("tetrahedron", Technique::ZFail);
    inspector.model.selection.pick = Some(at);
    let mut harness = harness_in(inspector, TALL);
    harness.get_by_label("Coordinates").click();
    harness.run_steps(20);
    assert!(harness.query_by_label("the point").is_none(), "until the history tells of the triangle");
    answer(&mut harness, history);
    harness.run_steps(4);
    let [.., corner] = &place.vertices[..] else { panic!("three corners") };
    let clip = vector(&corner.clip, 4);
    assert!(harness.query_by_label(&clip).is_none());
    click(&mut harness, &format!("vertex {}", corner.index));
    harness.get_by_label(&clip);
    harness.get_by_label("in view");
    click(&mut harness, "the point");
    let point = place.point.expect("a point");
    harness.get_by_label(&vector(&point.clip, 4));
    assert!(harness.query_by_label(&clip).is_none());
    harness.get_by_label(&place.projection);
    // As OpenGL has it: z from −w to w, rows from below; and the same world.
    click(&mut harness, "OpenGL, −1 to 1");
    let [x, y, z, w] = point.clip;
    let [column, row, depth] = point.window;
    for expected in [vec![x, y, 2.0 * z - w, w], vec![column, 120.0 - row, depth], point.world.to_vec()] {
        harness.get_by_label(&vector(&expected, 4));
    }
    assert!(harness.query_by_label(&vector(&point.clip, 4)).is_none());
    harness.get_by_label(&format!("{}, then back:", place.opengl[0].name));
    // Points as rows: every matrix is transposed.
    let written = |rows: [[f64; 4]; 4]| matrix_text(&rows, 4);
    let columns = place.opengl[0].matrix;
    let transposed = [0, 1, 2, 3].map(|row| [0, 1, 2, 3].map(|column: usize| columns[column][row]));
    harness.get_by_label(&written(columns));
    click(&mut harness, "p · M");
    harness.get_by_label(&written(transposed));
    assert!(harness.query_by_label(&written(columns)).is_none());
}

/// The floor of `pattern` is tiled: the texel is among the terms.
#[test]
fn shading_unfolds_into_its_terms_with_the_texel() {
    let pattern = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes/pattern.toml");
    let name = pattern.display().to_string();
    let mut inspector = explain::over(&name, Technique::ZFail);
    let (mut session, at) = (common::session(), [100, 100]);
    let frame = common::frame(&mut session, &name, common::request(Technique::ZFail, [160, 120]));
    let history = session.history(&frame.plan, &frame.capture, at).expect("a history");
    let shaded = SurfaceShading::of(&frame.capture, &frame.plan, &history).expect("a surface");
    let [column, row] = shaded.texture.as_ref().expect("a picture").texel;
    inspector.model.selection.pick = Some(at);
    let mut harness = harness_in(inspector, TALL);
    answer(&mut harness, history);
    assert!(harness.query_by_label("texture").is_none(), "folded at first");
    harness.get_by_label("Shading").click();
    harness.run_steps(20);
    harness.get_by_label(&format!("tiles.png, texel {column},{row}"));
    for label in ["texture", "u, v", "level", "texel's colour"] {
        harness.get_by_label(label);
    }
    // The same colour by what it is, as the command says it.
    let channels = shaded.channels.expect("channels");
    for (name, part) in
        [("ambient", channels.ambient), ("emissive", channels.emissive), ("specular", channels.specular)]
    {
        harness.get_by_label(name);
        assert!(harness.query_all_by_label(&three(part)).count() > 0, "{name}: {part:?}");
    }
}

/// The bench takes a draw's state and what the picked pixel holds before its step, and answers as the stencil machine does.
#[test]
fn the_bench_pushes_fragments_through_the_selected_draws_tests() {
    let mut inspector = explain::over("tori", Technique::ZFail);
    let capture = Arc::clone(inspector.model.frame.capture.as_ref().expect("a capture"));
    let counts = capture.frame_at(1).and_then(|frame| frame.stencil.as_ref()).expect("counts").image.clone();
    let [width, height] = counts.size();
    let mut pixels = (0..width * height).map(|at| [at % width, at / width]);
    inspector.model.selection.pick = pixels.find(|at| counts.byte_at(*at) == Some(1));
    inspector.model.select_step(usize::MAX);
    let mut harness = harness_in(inspector, TALL);
    show_tab(&mut harness, "Stencil test");
    click(&mut harness, "Push a back face");
    harness.get_by_label_contains("1. back face at 0.25: the stencil test (always) passes, the depth test (0.25 > 0.5) fails; increment-wrap: stencil 0 to 1");
    click(&mut harness, "Take the selected draw's state");
    assert!(harness.query_by_label_contains("1. back face").is_none(), "that was the former draw's");
    click(&mut harness, "Push a front face");
    harness.get_by_label_contains("1. front face at 0.25: the stencil test (0 = 1) fails");
    click(&mut harness, "Start again");
    assert!(harness.query_by_label_contains("1. front face").is_none());
}

/// In the smallest usual window the history, which the panel is looked at for, is above the fold.
#[test]
fn eight_rows_of_a_history_are_seen_in_a_window_of_a_thousand_points() {
    let faces: Vec<Face> = FACES.iter().copied().cycle().take(4 * FACES.len()).collect();
    for size in [[1000.0, 700.0], [1280.0, 800.0]] {
        let mut inspector = inspector(z_fail(SIZE));
        inspector.model.selection.pick = Some(DARK);
        let mut harness = harness_in(inspector, size);
        answer(&mut harness, history(DARK, &faces));
        harness.run_steps(3);
        let panel = harness.get_by_role_and_label(Role::TabPanel, "Pixel").rect();
        let is_row = |label: String| label.starts_with("pass ") || label.starts_with("mask: ");
        let seen = harness.query_all_by_role(Role::Row).filter(|row| {
            let is_seen = panel.contains_rect(row.rect()) && row.rect().height() > 10.0;
            is_seen && row.accesskit_node().label().is_some_and(is_row)
        });
        let seen = seen.count();
        assert!(seen >= 8, "{size:?}: {seen}");
    }
}

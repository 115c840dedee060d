//! The Stress tab.

use super::*;
use stencilscope::accuracy::ErrorCounts;
use stencilscope::ask::StressOf;
use stencilscope::stress::{self, StressCase, StressRow, StressRows, cases};

fn showing(prepare: impl FnOnce(&mut Inspector)) -> Harness<'static, Seen> {
    let mut inspector = inspector(z_fail(SIZE));
    prepare(&mut inspector);
    let mut harness = harness_in(inspector, [1440.0, 900.0]);
    show_tab(&mut harness, "Stress");
    harness
}

/// Rows of a case, as if every technique had so many wrong pixels at each value.
pub fn rows(name: &str, wrong: impl Fn(&str, f64) -> u64) -> Vec<StressRow> {
    let case = StressCase::named(name).expect("a case");
    let row = |value: &f64| {
        let value = *value;
        case.entrants().into_iter().map(move |entrant| (entrant, value))
    };
    let row_of = |(entrant, value): (stress::Entrant, f64)| StressRow {
        case: case.name,
        parameter: (case.parameter, value),
        entrant,
        settings: BTreeMap::new(),
        error: ErrorCounts {
            compared: 1000,
            missing_shadow: wrong(&entrant.to_string(), value),
            ..ErrorCounts::default()
        },
        seen: stress::TruthCounts { pixels: 2000, lit: 900, shadow: 100 },
        flips: None,
        off_limit: None,
        step: None,
        not_drawn: None,
        expected: case.expected_at(&entrant, value),
        frame_ms: 1.0,
        setup_ms: 1.0,
    };
    case.values.iter().flat_map(row).map(row_of).collect()
}

fn add(inspector: &mut Inspector, rows: Vec<StressRow>) {
    inspector.take_in(StressOf { cases: Vec::new() }, Ok(Arc::new(StressRows::new(rows))));
}

fn fail(inspector: &mut Inspector) {
    inspector.take_in(StressOf { cases: Vec::new() }, Err("the GPU was lost".to_owned()));
}

fn rows_of(inspector: &Inspector) -> Vec<StressRow> {
    inspector.model.answers.last::<StressOf>().map_or_else(Vec::new, |(_, rows)| rows.rows.clone())
}

fn select(harness: &mut Harness<Seen>, row: &str) {
    // Rows below the fold take no click.
    harness.get_by_role_and_label(Role::Row, row).scroll_to_me();
    harness.run_steps(30);
    click_role(harness, Role::Row, row);
}

#[test]
fn cases_are_listed_run_and_cancelled() {
    let mut harness = showing(|_| ());
    let first = cases::all().next().expect("a case").name;
    click_button(&mut harness, &format!("Run {first}"));
    click_button(&mut harness, "Cancel");
    select(&mut harness, "world-scale");
    click_button(&mut harness, "Run world-scale");
    click_button(&mut harness, "Cancel");
    click_button(&mut harness, "Run all");
    let all: Vec<&str> = cases::all().map(|case| case.name).collect();
    let asked = asks::<StressOf>(&harness).into_iter().map(|ask| ask.cases).collect::<Vec<_>>();
    assert_eq!(asked, [vec![first], vec!["world-scale"], all.clone()]);
    let PendingQuestion { ticket, progress, .. } = last_asked::<StressOf>(&harness);
    progress.start(1200);
    (0..40).for_each(|_| progress.advance());
    for name in &all[..3] {
        let part = StressRows::new(rows(name, |_, _| 0));
        harness.state_mut().inspector.answer(ticket, Ok(Answer::StressOf(Arc::new(part))), false);
    }
    harness.run_steps(2);
    harness.get_by_label(&format!("3 of {} · {} · 40 of 1\u{a0}200 rows", all.len(), all[3]));
    click_button(&mut harness, "Cancel");
    assert!(progress.is_cancelled());
}

#[test]
fn a_case_that_was_run_says_who_broke_where_and_opens_there() {
    let wrong = |entrant: &str, value: f64| u64::from(entrant == "z-pass" && value % 256.0 == 0.0) * 7;
    let mut harness = showing(|inspector| add(inspector, rows("nested", wrong)));
    select(&mut harness, "nested: unexpected");
    harness.get_by_role_and_label(Role::Row, "shadow-map: no wrong pixel, holds");
    // It was known to fail, and did not: our knowledge is wrong.
    harness.get_by_role_and_label(
        Role::Row,
        "z-fail: no wrong pixel, unexpected, at 256: right where it is known to fail",
    );
    select(&mut harness, "z-fail: no wrong pixel, unexpected, at 256: right where it is known to fail");
    assert!(matches!(harness.state().actions.last(), Some(Action::OpenStress { value: 256.0, .. })));
    select(&mut harness, "z-pass: breaks at 256, fails as known (wrap-256)");
    let Some(Action::OpenStress { case: "nested", value: 256.0, entrant: Some(entrant) }) =
        harness.state().actions.last()
    else {
        panic!("{:?}", harness.state().actions)
    };
    assert_eq!(entrant.to_string(), "z-pass");
}

#[test]
fn any_value_opens_as_a_scene_and_an_error_is_said() {
    let mut harness = showing(fail);
    harness.get_by_label("× the GPU was lost");
    select(&mut harness, "grazing");
    harness.get_by_label("z-fail: expected right");
    click_button(&mut harness, "1e-4");
    let expected = Action::OpenStress { case: "grazing", value: 1e-4, entrant: None };
    assert_eq!(harness.state().actions, [expected]);
}

/// A million triangles take more than a gigabyte where the GPU's memory is the window's own.
#[test]
fn what_takes_gigabytes_is_not_opened_by_a_click() {
    let case = StressCase::named("triangle-count").expect("a case");
    let [light, heavy] = [case.light_values().last(), case.values.last()].map(|value| *value.expect("values"));
    assert!(light < heavy);
    let mut harness = showing(|_| ());
    select(&mut harness, case.name);
    harness.get_by_label_contains("Runs and opens up to");
    assert!(harness.query_by_role_and_label(Role::Button, &stress::value_text(heavy)).is_none());
    click_button(&mut harness, &stress::value_text(light));
    let expected = Action::OpenStress { case: case.name, value: light, entrant: None };
    assert_eq!(harness.state().actions, [expected]);
}

#[test]
fn what_is_unexpected_opens_and_a_course_is_reported() {
    // Wrong at 256 is known, at 600 it is not.
    let wrong =
        |entrant: &str, value: f64| u64::from(entrant == "z-fail" && [256.0, 512.0, 600.0].contains(&value)) * 7;
    let mut harness = showing(|inspector| {
        add(inspector, rows("nested", wrong));
        let row = |mut row: StressRow| {
            row.off_limit = Some(1);
            row
        };
        add(inspector, rows("light-far", |_, _| 0).into_iter().map(row).collect());
    });
    select(&mut harness, "light-far: unexpected");
    let course = "not as it must be: 1, 1, 1, 1, 1, 1 pixels differ from the limit";
    assert!(harness.query_all_by_label(course).count() > 0);
    select(&mut harness, "nested: unexpected");
    select(&mut harness, "z-fail: breaks at 256, unexpected, at 600: wrong where it must be right");
    assert!(matches!(harness.state().actions.last(), Some(Action::OpenStress { value: 600.0, .. })));
}

#[test]
fn running_a_case_again_replaces_its_rows_and_no_others() {
    let mut inspector = Inspector::default();
    add(&mut inspector, rows("nested", |_, _| 0));
    add(&mut inspector, rows("grazing", |_, _| 0));
    let count = rows_of(&inspector).len();
    add(&mut inspector, rows("nested", |_, _| 1));
    assert_eq!(rows_of(&inspector).len(), count);
    let wrong =
        |name| rows_of(&inspector).iter().filter(|row| row.case == name).map(|row| row.error.wrong()).sum::<u64>();
    assert!(wrong("nested") > 0 && wrong("grazing") == 0);
}

#[test]
fn progress_moves_within_a_case() {
    let mut harness = showing(|_| ());
    change(&mut harness, |inspector| inspector.model.answers.start(StressOf { cases: vec!["random"] }));
    let progress = last_asked::<StressOf>(&harness).progress;
    let share = |harness: &mut Harness<Seen>, rows: usize| {
        progress.start(1000);
        (0..rows).for_each(|_| progress.advance());
        harness.run_steps(2);
        let bar = harness.get_by_role_and_label(Role::ProgressIndicator, "Running stress cases");
        bar.accesskit_node().numeric_value()
    };
    assert_eq!(share(&mut harness, 0), Some(0.0));
    assert_eq!(share(&mut harness, 500), Some(50.0));
    assert_eq!(share(&mut harness, 990), Some(99.0));
}

#[test]
fn the_error_of_a_run_goes_when_the_next_begins_and_does_not_come_back_when_that_is_cancelled() {
    let mut harness = showing(fail);
    for wish in ["Run all", "Cancel"] {
        click_button(&mut harness, wish);
        assert!(harness.query_by_label_contains("the GPU was lost").is_none());
    }
}

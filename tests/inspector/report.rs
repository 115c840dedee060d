//! The Report tab.

use super::contrast::words;
use super::*;
use crate::common::report::{one_scene, three_scenes};
use egui::accesskit::Toggled;
use stencilscope::report::plot::{self, CLEAR, PlotInk, PlotPage, PlotRect, PlotText};
use stencilscope::report::{FrameTimes, MeasuredReport, Report, ReportRow};

fn give_report(inspector: &mut Inspector, report: Report) {
    give_report_without(inspector, report, Vec::new());
}

fn give_report_without(inspector: &mut Inspector, report: Report, left_out: Vec<String>) {
    let question = ReportOf::grid().expect("a grid");
    inspector.take_in(question, Ok(Arc::new(MeasuredReport { report, left_out, is_whole: true })));
}

fn showing(prepare: impl FnOnce(&mut Inspector)) -> Harness<'static, Seen> {
    let mut inspector = inspector(z_fail(SIZE));
    prepare(&mut inspector);
    harness_of(inspector)
}

/// What opening the row of `label` asks for.
fn opening(report: &Report, technique: &str, label: &str) -> Action {
    let is_row = |row: &&ReportRow| row.technique == technique && row.label == label;
    let row = report.rows.iter().find(is_row).expect("a row");
    Action::OpenReportRow { technique: technique.to_owned(), settings: row.settings.clone() }
}

#[test]
fn before_anything_is_measured_it_says_what_it_does() {
    let mut harness = showing(|_| ());
    harness.get_by_label_contains("Measures every technique on this scene");
    click_button(&mut harness, "Measure");
    assert_eq!(asks::<ReportOf>(&harness).len(), 1);
}

#[test]
fn without_a_scene_nothing_can_be_measured() {
    let mut harness = harness_of(Inspector::default());
    harness.get_by_label_contains("Open a scene to measure");
    click_button(&mut harness, "Measure");
    assert!(harness.state().actions.is_empty());
}

#[test]
fn while_it_measures_it_says_how_far_it_is_and_shows_the_rows_so_far() {
    let mut report = one_scene();
    report.rows.truncate(3);
    let mut harness = showing(|inspector| give_report(inspector, report));
    click_button(&mut harness, "Measure again");
    let asked = last_asked::<ReportOf>(&harness);
    // The worker has reported no step yet; how many there will be is known.
    let steps = asks::<ReportOf>(&harness).iter().map(|ask| ask.choices.len() * (ask.runs + 1)).sum::<usize>();
    harness.get_by_label(&format!("0 of {steps} · measuring the truth"));
    let is_z_fail = |choice: &Choice| choice.technique() == Technique::ZFail;
    asked.progress.start(15);
    (0..3).for_each(|_| asked.progress.advance());
    let [question] = &asks::<ReportOf>(&harness)[..] else { panic!("asked once") };
    asked.progress.turn_to(question.choices.iter().position(is_z_fail).expect("z-fail"));
    harness.run_steps(2);
    harness.get_by_label("3 of 15 · measuring z-fail");
    harness.get_by_label("Measuring");
    assert!(harness.query_by_role_and_label(Role::Button, "Measure again").is_none());
    harness.get_by_role_and_label(Role::Row, "z-pass: none wrong, 18.2 ms");
    click_button(&mut harness, "Cancel");
    assert!(asked.progress.is_cancelled());
}

#[test]
fn a_point_and_a_row_open_what_they_stand_for() {
    let report = one_scene();
    let mut harness = showing(|inspector| give_report(inspector, report.clone()));
    click_button(&mut harness, "shadow-map 1024: 1.5\u{a0}% wrong, 14.0 ms");
    assert_eq!(harness.state().actions.last(), Some(&opening(&report, "shadow-map", "1024")));
    click_role(&mut harness, Role::Row, "planar: 9.0\u{a0}% wrong, 10.5 ms");
    assert_eq!(harness.state().actions.last(), Some(&opening(&report, "planar", "")));
    click_button(&mut harness, "Measure again");
    assert_eq!(asks::<ReportOf>(&harness).len(), 1);
}

#[test]
fn what_was_left_out_is_named_and_where_it_is_measured() {
    let left_out = vec!["planar-texture 1024".to_owned(), "shadow-map 4096".to_owned()];
    let harness = showing(|inspector| give_report_without(inspector, one_scene(), left_out));
    harness.get_by_label_contains("without planar-texture 1024, shadow-map 4096: too much memory for a window");
}

#[test]
fn the_keyboard_reaches_points_and_rows() {
    let report = one_scene();
    let mut harness = showing(|inspector| give_report(inspector, report.clone()));
    focus_role(&mut harness, Role::Button, "z-fail: none wrong, 21.7 ms");
    press(&mut harness, Key::Enter);
    assert_eq!(harness.state().actions, [opening(&report, "z-fail", "")]);
    focus_role(&mut harness, Role::Row, "ray-traced: none wrong, 150 ms");
    press(&mut harness, Key::Space);
    assert_eq!(harness.state().actions.last(), Some(&opening(&report, "ray-traced", "")));
}

#[test]
fn what_is_shown_now_is_selected() {
    let mut report = one_scene();
    for row in &mut report.rows {
        row.scene = "by hand".to_owned();
    }
    let mut inspector = inspector(z_fail(SIZE));
    let mut request = run_request(Technique::ShadowMap);
    request.choice = Choice::new(Technique::ShadowMap);
    request.choice.set("size", "2048").expect("a size");
    request.choice.set("bias-slope", "2").expect("a slope");
    inspector.set_scene(&scene(), request);
    give_report(&mut inspector, report);
    let harness = harness_of(inspector);
    for role in [Role::Button, Role::Row] {
        let toggled = |label: &str| harness.get_by_role_and_label(role, label).accesskit_node().toggled();
        assert_eq!(toggled("shadow-map 2048: 0.76\u{a0}% wrong, 23.8 ms"), Some(Toggled::True));
        assert_eq!(toggled("shadow-map 1024: 1.5\u{a0}% wrong, 14.0 ms"), Some(Toggled::False));
    }
}

#[test]
fn scenes_are_headed_and_narrow_windows_have_plot_and_table_below_each_other() {
    for size in [[1920.0, 1080.0], [700.0, 500.0], [320.0, 240.0]] {
        let mut other = Inspector::new(Vec::new());
        other.set_scene(&scene(), run_request(Technique::ZFail));
        give_report(&mut other, three_scenes());
        let harness = harness_in(other, size);
        if size[0] > 1000.0 {
            harness.get_by_label("inside a volume");
            assert_eq!(harness.query_all_by_role(Role::Row).count(), 45);
        }
    }
}

#[test]
fn odd_rows_and_errors_are_shown() {
    let mut report = one_scene();
    report.rows[0].frame_ms.median = f64::NAN;
    report.rows[1].error.compared = 0;
    report.rows[2].settings = BTreeMap::from([("of".to_owned(), "the future".to_owned())]);
    report.rows[2].technique = "later".to_owned();
    report.mark_pareto();
    let harness = showing(|inspector| {
        give_report(inspector, report);
        let question = ReportOf::grid().expect("a grid");
        inspector.take_in(question, Err("no GPU: install mesa-vulkan-drivers".to_owned()));
    });
    harness.get_by_label("× no GPU: install mesa-vulkan-drivers");
    harness.get_by_role_and_label(Role::Button, "later: none wrong, 18.2 ms");
}

#[test]
fn the_rows_can_be_saved() {
    let report = one_scene();
    let mut harness = showing(|_| ());
    assert!(harness.query_by_role_and_label(Role::Button, "Save…").is_none(), "nothing is measured");
    assert!(harness.state_mut().inspector.export(ExportKind::Report).is_none());
    give_report(&mut harness.state_mut().inspector, report.clone());
    harness.run_steps(2);
    click_button(&mut harness, "Save…");
    harness.get_by_label("Export: Report (table or plot)");
    click_button(&mut harness, "Save");
    let Some(Action::Export { kind: ExportKind::Report, path, replace: false }) = harness.state().actions.last() else {
        panic!("{:?}", harness.state().actions);
    };
    assert_eq!(*path, format!("{}-report.csv", report.rows[0].scene));
    let data = harness.state_mut().inspector.export(ExportKind::Report);
    assert!(matches!(data, Some(ExportData::Report(exported)) if *exported == report));
}

#[test]
fn what_was_measured_of_one_scene_does_not_stand_under_another_and_comes_back_with_its_own() {
    let row = "z-fail: none wrong, 21.7 ms";
    let mut harness = showing(|inspector| give_report(inspector, one_scene()));
    harness.get_by_role_and_label(Role::Row, row);
    let other = Scene { name: "another".to_owned(), ..scene() };
    // What is loaded again may be another scene by now.
    for (open, is_there) in [(&other, false), (&scene(), true), (&scene(), false), (&other, false), (&scene(), false)] {
        harness.state_mut().inspector.set_scene(open, run_request(Technique::ZFail));
        show_capture(&mut harness, z_fail(SIZE));
        assert_eq!(harness.query_by_role_and_label(Role::Row, row).is_some(), is_there, "{}", open.name);
    }
}

/// A report as the window measures it: every technique, some of them with several settings, most of them at like times.
fn crowded() -> Report {
    let mut report = one_scene();
    for (technique, label, wrong, ms) in [
        ("auto", "", 0, 19.8),
        ("auto", "occlusion queries", 0, 62.0),
        ("z-fail", "counter float", 0, 46.0),
        ("z-fail", "casters light-facing", 0, 57.0),
        ("z-pass-plus", "", 0, 35.0),
        ("z-pass-plus", "caps light", 0, 88.0),
        ("planar-texture", "64", 9_000, 147.0),
        ("planar-texture", "256", 3_400, 126.0),
        ("projective", "128", 13_000, 170.0),
        ("projective", "512", 2_400, 172.0),
        ("projective", "2048", 2_100, 330.0),
        ("planar", "receivers all", 1_900, 579.0),
        ("planar", "z-fighting none", 56_000, 71.0),
    ] {
        let mut row = report.rows[0].clone();
        (row.technique, row.label) = (technique.to_owned(), label.to_owned());
        row.settings = BTreeMap::from([("of".to_owned(), label.to_owned())]);
        (row.error.missing_shadow, row.error.false_shadow) = (wrong, 0);
        row.frame_ms = FrameTimes { median: ms, min: ms * 0.93, max: ms * 1.4, runs: 5 };
        report.rows.push(row);
    }
    Report::new(report.adapter.clone(), report.rows)
}

#[test]
fn a_label_covers_no_other_no_mark_with_its_ring_no_whisker_and_no_line_to_a_mark() {
    let mut labels = 0;
    for report in [one_scene(), three_scenes(), crowded()] {
        for width in [344.0, 500.0, 640.0, 900.0, 1200.0, 1440.0, 1900.0] {
            for height in [170.0, 240.0, 420.0, 900.0] {
                let page = PlotPage { width, height: Some(height), most_columns: 4, compact: true };
                for chart in plot::layout(&report, &page).charts {
                    let at = format!("{} at {width}×{height}", chart.title);
                    let covers = |rect: &PlotRect, from: [f64; 2], to: [f64; 2]| {
                        // In steps of a point.
                        let steps = (to[0] - from[0]).hypot(to[1] - from[1]).ceil().max(1.0);
                        let point = |step: f64| [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * step / steps);
                        let mut all = (0..=steps as usize).map(|step| point(step as f64));
                        let inner =
                            PlotRect { min: rect.min.map(|low| low + 0.1), max: rect.max.map(|high| high - 0.1) };
                        all.any(|point| inner.holds(&PlotRect { min: point, max: point }))
                    };
                    for technique in chart.spots.iter().map(|spot| spot.style.technique) {
                        let is_of = |label: &PlotText| label.text.split(' ').next() == Some(technique);
                        let is_named = chart.labels.iter().any(is_of);
                        // In a small chart marks leave no place at all.
                        assert!(is_named || width < 440.0 || height < 200.0, "{at}: nothing names {technique}");
                    }
                    let rects: Vec<PlotRect> = chart.labels.iter().map(PlotText::rect).collect();
                    labels += rects.len();
                    for (index, (rect, label)) in rects.iter().zip(&chart.labels).enumerate() {
                        let text = &label.text;
                        assert!(rects[..index].iter().all(|other| !other.overlaps(rect)), "{at}: {text}");
                        for spot in &chart.spots {
                            let ring = |side: f64| spot.at.map(|along| along + side * CLEAR);
                            assert!(
                                !PlotRect { min: ring(-1.0), max: ring(1.0) }.overlaps(rect),
                                "{at}: {text} covers {}",
                                spot.name
                            );
                            let [from, to] = spot.whisker.map(|x| [x, spot.at[1]]);
                            assert!(!covers(rect, from, to), "{at}: {text} lies on the whisker of {}", spot.name);
                        }
                        let leaders = chart.lines.iter();
                        let leaders = leaders
                            .filter(|line| matches!(line.ink, PlotInk::Technique(_)) && line.width < 1.0)
                            .filter(|line| !covers(rect, line.points[1], line.points[1]));
                        for line in leaders {
                            let nearest = rect.holds(&PlotRect { min: line.points[1], max: line.points[1] });
                            assert!(nearest || !covers(rect, line.points[0], line.points[1]), "{at}: {text}");
                        }
                    }
                }
            }
        }
    }
    assert!(labels > 1000, "{labels}");
}

/// Where numbers are long, columns have gaps all the same.
#[test]
fn columns_of_the_table_do_not_touch() {
    let mut report = one_scene();
    for row in &mut report.rows {
        (row.triangles, row.setup_ms, row.bytes) = (1_788_123_456, 123_456.0, 98_765_432_100);
        row.wrong_color = Some(1_234_567);
    }
    for width in [1280.0, 1920.0] {
        let mut inspector = Inspector::new(Vec::new());
        inspector.set_scene(&scene(), run_request(Technique::ZFail));
        give_report(&mut inspector, report.clone());
        let harness = harness_in(inspector, [width, 1080.0]);
        let rows: Vec<Rect> = harness.query_all_by_role(Role::Row).map(|row| row.rect()).collect();
        assert!(rows.len() >= 8, "{width}");
        let all = words(&harness);
        for row in rows {
            let mut places: Vec<Rect> =
                all.iter().map(|word| word.place).filter(|place| row.contains(place.center())).collect();
            places.sort_by(|one, other| one.left().total_cmp(&other.left()));
            for pair in places.windows(2) {
                assert!(pair[1].left() >= pair[0].right() + 10.0, "{width}: {} and {}", pair[0], pair[1]);
            }
        }
    }
}

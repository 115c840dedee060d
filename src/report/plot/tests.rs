//! Layouts of reports made by hand.

use super::*;
use crate::report::tests::{adapter, row};
use crate::report::{FrameTimes, ReportRow, SweepValue};
use std::collections::BTreeMap;

const PAGE: PlotPage = PlotPage { width: 600.0, height: None, most_columns: 3, compact: false };

fn report(rows: Vec<ReportRow>) -> Report {
    Report::new(adapter(), rows)
}

fn with_size(mut row: ReportRow, size: u32, slope: &str) -> ReportRow {
    row.settings = BTreeMap::from([("size".to_owned(), size.to_string()), ("bias-slope".to_owned(), slope.to_owned())]);
    row
}

/// A crowd: `count` rows of one scene, close to each other.
fn crowd(count: usize) -> Report {
    let techniques = ["none", "planar", "z-pass", "z-fail", "shadow-map", "ray-traced", "later"];
    let rows = (0..count).map(|index| {
        let technique = techniques[index % techniques.len()];
        let label = format!("{} of {count}", index + 1);
        row("crowd", technique, &label, (index as u64 * 7) % 11, 3.0 + (index % 9) as f64 * 0.1)
    });
    report(rows.collect())
}

/// Checks what must be true of every layout.
fn check(plot: &Plot) {
    let page = PlotRect { min: [0.0, 0.0], max: plot.size };
    for text in &plot.texts {
        assert!(page.holds(&text.rect()), "{text:?} of {page:?}");
    }
    for chart in &plot.charts {
        let rects: Vec<PlotRect> = chart.labels.iter().map(PlotText::rect).collect();
        for (index, rect) in rects.iter().enumerate() {
            assert!(rects[..index].iter().all(|other| !other.overlaps(rect)), "{:?}", chart.labels[index]);
            assert!(chart.area.holds(rect) || chart.band.holds(rect), "{:?}", chart.labels[index]);
        }
        for spot in &chart.spots {
            assert!(spot.at.iter().chain(&spot.whisker).all(|value| value.is_finite()));
            let at = PlotRect { min: spot.at, max: spot.at };
            assert!(chart.area.holds(&at) || chart.band.holds(&at), "{spot:?}");
        }
        for text in &chart.texts {
            assert!(page.holds(&text.rect()), "{text:?} of {page:?}");
        }
    }
}

/// The only chart.
fn chart(plot: &Plot) -> &SceneChart {
    check(plot);
    assert_eq!(plot.charts.len(), 1);
    &plot.charts[0]
}

#[test]
fn points_are_at_the_logarithms_of_time_and_error() {
    let mut rows =
        vec![row("a", "none", "", 100, 1.0), row("a", "planar", "", 10, 10.0), row("a", "z-fail", "", 0, 100.0)];
    for row in &mut rows {
        (row.frame_ms.min, row.frame_ms.max) = (row.frame_ms.median, row.frame_ms.median);
    }
    let plot = layout(&report(rows), &PAGE);
    let chart = chart(&plot);
    let at = |technique: &str| chart.spots.iter().find(|spot| spot.style.technique == technique).expect("a spot").at;
    // The axis has a margin of a factor of 1.35 at both ends: log10(1.35) of log10(100 · 1.35²) in all.
    let margin = 1.35_f64.log10();
    let place = |decades: f64| chart.area.min[0] + (decades + margin) / (2.0 + 2.0 * margin) * chart.area.width();
    for (technique, decades) in [("none", 0.0), ("planar", 1.0), ("z-fail", 2.0)] {
        assert!((at(technique)[0] - place(decades)).abs() < 1e-6, "{technique}");
    }
    let level = |decades: f64| chart.area.max[1] - (decades + margin) / (1.0 + 2.0 * margin) * chart.area.height();
    assert!((at("none")[1] - level(1.0)).abs() < 1e-6, "10 %");
    assert!((at("planar")[1] - level(0.0)).abs() < 1e-6, "1 %");
    assert!(chart.band.min[1] < at("z-fail")[1] && at("z-fail")[1] < chart.band.max[1]);
    assert!(chart.area.max[1] < chart.band.min[1], "the band is apart from the axis");
}

#[test]
fn the_front_is_filled_and_joined_by_a_staircase() {
    let rows = vec![row("a", "none", "", 100, 1.0), row("a", "planar", "", 10, 10.0), row("a", "z-pass", "", 50, 20.0)];
    let plot = layout(&report(rows), &PAGE);
    let chart = chart(&plot);
    let filled: Vec<usize> = chart.spots.iter().filter(|spot| spot.filled).map(|spot| spot.row).collect();
    assert_eq!(filled, [0, 1]);
    let front: Vec<&PlotLine> = chart.lines.iter().filter(|line| line.ink == PlotInk::Front).collect();
    let [from, to] = [0, 1].map(|row| chart.spots.iter().find(|spot| spot.row == row).expect("a spot").at);
    assert_eq!(front.len(), 1);
    assert_eq!(front[0].points, [from, [to[0], from[1]], to]);
}

#[test]
fn rows_that_differ_in_one_number_are_joined_in_its_order() {
    let size = |size: u32, slope: &str, wrong: u64, ms: f64| {
        with_size(row("a", "shadow-map", &size.to_string(), wrong, ms), size, slope)
    };
    let rows = vec![
        size(1024, "2", 10, 5.0),
        size(256, "2", 90, 3.0),
        size(512, "2", 30, 4.0),
        size(256, "0", 95, 3.1),
        size(512, "0", 35, 4.1),
        row("a", "none", "", 100, 1.0),
    ];
    let plot = layout(&report(rows), &PAGE);
    let chart = chart(&plot);
    let at = |row: usize| chart.spots.iter().find(|spot| spot.row == row).expect("a spot").at;
    let is_join = |line: &&PlotLine| matches!(line.ink, PlotInk::Technique(_)) && line.width > 1.0;
    let joins: Vec<Vec<[f64; 2]>> = chart.lines.iter().filter(is_join).map(|line| line.points.clone()).collect();
    assert_eq!(joins, [[at(3), at(4)], [at(1), at(2)], [at(2), at(0)]]);
    let words: Vec<&str> = chart.labels.iter().map(|label| label.text.as_str()).collect();
    assert!(words.contains(&"shadow-map 256"), "one row carries the name: {words:?}");
    assert!(words.contains(&"512") && words.contains(&"1024"), "{words:?}");
}

#[test]
fn every_technique_is_named_in_a_crowd() {
    for count in [7, 16, 40] {
        for page in [PAGE, PlotPage { height: Some(200.0), compact: true, ..PAGE }, PlotPage::PAPER] {
            let crowd = crowd(count);
            let plot = layout(&crowd, &page);
            let chart = chart(&plot);
            assert_eq!(chart.spots.len(), count);
            for technique in ["none", "planar", "z-pass", "z-fail", "shadow-map", "ray-traced", "later"] {
                let is_in_legend = plot.texts.iter().any(|text| text.text == technique);
                assert_eq!(is_in_legend, !page.compact, "{technique}");
                let is_named = chart.labels.iter().any(|label| label.text.starts_with(technique));
                assert!(is_named || page.height.is_some(), "{technique} of {count}");
            }
        }
    }
}

/// However long the names of its lines are, a sweep's page contains them, and its charts are as wide as ever.
#[test]
fn a_sweep_s_page_holds_the_names_of_its_lines() {
    let swept = |label: &str, value: f64| {
        let sweep = Some(SweepValue { name: "lights".to_owned(), value, text: value.to_string() });
        ReportRow { sweep, ..row("a", "shadow-map", label, 3, 4.0 + value) }
    };
    let page = |label: &str| sweep(&report(vec![swept(label, 1.0), swept(label, 2.0)]));
    let (short, long) = (page("pcf:3"), page("bias-slope 0, bias-constant 64, cull front, redraw changed"));
    for plot in [&short, &long] {
        let page = PlotRect { min: [0.0, 0.0], max: plot.size };
        let [chart] = &plot.charts[..] else { panic!("one chart") };
        assert_eq!(chart.labels.len(), 1);
        assert!(chart.labels.iter().all(|label| page.holds(&label.rect())), "{:?}", chart.labels);
    }
    assert!(short.size[0] < long.size[0] && short.charts[0].area == long.charts[0].area);
}

#[test]
fn scenes_are_charts_side_by_side_on_the_same_axes() {
    let rows = |scene: &str, ms: f64| [row(scene, "none", "", 100, ms), row(scene, "z-fail", "", 0, ms * 3.0)];
    let rows = [rows("a", 1.0), rows("b", 10.0), rows("c", 30.0)].concat();
    let plot = layout(&report(rows), &PlotPage { width: 1000.0, ..PAGE });
    check(&plot);
    let titles: Vec<&str> = plot.charts.iter().map(|chart| chart.title.as_str()).collect();
    assert_eq!(titles, ["a", "b", "c"]);
    let tops: Vec<f64> = plot.charts.iter().map(|chart| chart.area.min[1]).collect();
    assert_eq!(tops, [tops[0]; 3]);
    let words = |chart: &SceneChart| chart.texts.iter().skip(1).map(|text| text.text.clone()).collect::<Vec<_>>();
    assert_eq!(words(&plot.charts[0]), words(&plot.charts[2]));
    let narrow =
        layout(&report(vec![row("a", "x", "", 1, 1.0), row("b", "x", "", 1, 1.0)]), &PlotPage { width: 10.0, ..PAGE });
    check(&narrow);
    assert!(narrow.charts[1].area.min[1] > narrow.charts[0].band.max[1], "below each other where there is no room");
}

#[test]
fn a_given_height_is_filled() {
    let page = PlotPage { height: Some(400.0), compact: true, ..PAGE };
    let plot = layout(&crowd(7), &page);
    check(&plot);
    assert!((380.0..=400.0).contains(&plot.size[1]), "{}", plot.size[1]);
}

#[test]
fn degenerate_reports_have_a_layout() {
    let frame = |ms: f64| FrameTimes { median: ms, min: ms, max: ms, runs: 1 };
    let timed = |ms: f64, wrong: u64| ReportRow { frame_ms: frame(ms), ..row("a", "none", "", wrong, 1.0) };
    let cases = [
        Vec::new(),
        vec![timed(3.0, 0)],
        vec![timed(3.0, 1000)],
        vec![timed(3.0, 5), timed(3.0, 5), timed(3.0, 0), timed(3.0, 0)],
        vec![timed(0.0, 5), timed(0.0, 0)],
        vec![timed(1e-300, 5), timed(1e300, 1)],
        (0..40).map(|_| timed(3.0, 0)).collect(),
        (0..40).map(|index| timed(f64::from(index), 1000)).collect(),
    ];
    for rows in cases {
        let count = rows.len();
        let plot = layout(&report(rows), &PAGE);
        check(&plot);
        assert_eq!(plot.charts.iter().map(|chart| chart.spots.len()).sum::<usize>(), count);
    }
}

#[test]
fn rows_that_cannot_be_drawn_are_noted() {
    let mut nothing = row("a", "planar", "", 0, 2.0);
    nothing.error.compared = 0;
    let rows = vec![row("a", "none", "", 5, f64::NAN), nothing, row("a", "z-fail", "", 0, 0.0)];
    let plot = layout(&report(rows), &PAGE);
    assert_eq!(chart(&plot).spots.len(), 1);
    let notes: Vec<&str> = plot.texts.iter().map(|text| text.text.as_str()).collect();
    for note in [
        "Not drawn: none in a: its time is no number.",
        "Not drawn: planar in a: no pixel was compared.",
        "At the left edge: z-fail in a took 0 ms.",
    ] {
        assert!(notes.contains(&note), "{notes:?}");
    }
}

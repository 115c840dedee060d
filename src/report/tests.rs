//! The report's rules, on rows made by hand.

use super::*;

pub(crate) fn adapter() -> AdapterInfo {
    AdapterInfo { name: "hand".to_owned(), driver: "1".to_owned(), kind: "cpu".to_owned() }
}

/// A row with `wrong` of 1000 pixels wrong, `ms` milliseconds a frame.
pub(crate) fn row(scene: &str, technique: &str, label: &str, wrong: u64, ms: f64) -> ReportRow {
    ReportRow {
        scene: scene.to_owned(),
        technique: technique.to_owned(),
        settings: BTreeMap::new(),
        label: label.to_owned(),
        size: [100, 10],
        sweep: None,
        error: ErrorCounts { compared: 1000, false_shadow: wrong, edge_band: 7, ..ErrorCounts::default() },
        wrong_fraction: 0.0,
        wrong_color: Some(wrong),
        visibility_error: None,
        frame_ms: FrameTimes { median: ms, min: ms - 0.1, max: ms + 0.3, runs: 9 },
        gpu_ms: None,
        moving: None,
        setup_ms: 12.5,
        triangles: 5000,
        bytes: 2 << 20,
        pareto: false,
    }
}

fn front_of(rows: Vec<ReportRow>) -> Vec<bool> {
    Report::new(adapter(), rows).rows.iter().map(|row| row.pareto).collect()
}

#[test]
fn the_front_is_what_nothing_beats() {
    let rows = vec![
        row("a", "none", "", 100, 1.0),
        row("a", "planar", "", 50, 2.0),
        row("a", "z-pass", "", 60, 3.0), // planar is faster and more right
        row("a", "z-fail", "", 0, 4.0),
        row("a", "ray-traced", "", 0, 150.0), // z-fail is as right, and faster
    ];
    assert_eq!(front_of(rows), [true, true, false, true, false]);
}

#[test]
fn of_equal_times_or_errors_the_better_one_is_on_the_front_and_of_equal_rows_all() {
    assert_eq!(front_of(vec![row("a", "x", "", 5, 1.0), row("a", "y", "", 4, 1.0)]), [false, true]);
    assert_eq!(front_of(vec![row("a", "x", "", 5, 1.0), row("a", "y", "", 5, 2.0)]), [true, false]);
    assert_eq!(front_of(vec![row("a", "x", "", 5, 1.0), row("a", "y", "", 5, 1.0)]), [true, true]);
}

#[test]
fn scenes_are_apart() {
    assert_eq!(front_of(vec![row("a", "x", "", 5, 9.0), row("b", "y", "", 0, 1.0)]), [true, true]);
}

#[test]
fn a_row_without_time_or_pixels_is_not_ranked_and_beats_none() {
    let mut nothing_compared = row("a", "x", "", 0, 0.5);
    nothing_compared.error.compared = 0;
    let rows = vec![row("a", "y", "", 5, 1.0), row("a", "z", "", 0, f64::NAN), nothing_compared];
    assert_eq!(front_of(rows), [true, false, false]);
}

#[test]
fn the_wrong_fraction_counts_all_kinds() {
    let mut one = row("a", "x", "", 1, 1.0);
    (one.error.missing_shadow, one.error.wrong_surface) = (2, 3);
    let report = Report::new(adapter(), vec![one]);
    assert_eq!(report.rows[0].wrong(), 6);
    assert_eq!(report.rows[0].wrong_fraction, 0.006);
}

#[test]
fn json_has_the_names_of_the_contract_and_survives_the_way_there_and_back() {
    let mut one = row("tori", "shadow-map", "1024", 20, 3.0 + 1.0 / 3.0);
    one.settings.insert("size".to_owned(), "1024".to_owned());
    let report = Report::new(adapter(), vec![one]);
    let text = report.to_json().expect("JSON");
    let value: serde_json::Value = serde_json::from_str(&text).expect("a value");
    let names = |value: &serde_json::Value| value.as_object().expect("an object").keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&value), ["adapter", "rows", "schema"]);
    assert_eq!(value["schema"], 1);
    assert_eq!(
        names(&value["rows"][0]),
        [
            "bytes",
            "compared",
            "edge_band",
            "false_shadow",
            "frame_ms",
            "gpu_ms",
            "label",
            "missing_shadow",
            "pareto",
            "scene",
            "settings",
            "setup_ms",
            "size",
            "technique",
            "triangles",
            "wrong_color",
            "wrong_fraction",
            "wrong_surface",
        ]
    );
    assert_eq!(names(&value["rows"][0]["frame_ms"]), ["max", "median", "min", "runs"]);
    assert_eq!(value["rows"][0]["gpu_ms"], serde_json::Value::Null);
    assert_eq!(Report::from_json(&text).expect("a report"), report);
}

/// Files from before colours were compared have no such field: it stays unknown, also where parts are merged.
#[test]
fn reports_without_wrong_colours_can_be_read_and_merged() {
    let shards = ["1/2", "2/2"].map(|shard| shard.parse().expect("a shard"));
    let part = |(place, shard)| {
        let one = row("tori", "z-fail", "", 0, 6.25);
        let part = ShardPart::new(shard, vec![place], "one run".to_owned(), ["a".to_owned(), "b".to_owned()]);
        let mut value: serde_json::Value = serde_json::from_str(
            &Report { part: Some(part), ..Report::new(adapter(), vec![one]) }.to_json().expect("JSON"),
        )
        .expect("a value");
        if place == 0 {
            value["rows"][0].as_object_mut().expect("a row").remove("wrong_color").expect("a count");
        }
        (format!("part-{place}.json"), Report::from_json(&value.to_string()).expect("a report"))
    };
    let merged = Report::merged((0..).zip(shards).map(part).collect()).expect("all parts");
    assert_eq!(merged.rows.iter().map(|row| row.wrong_color).collect::<Vec<_>>(), [None, Some(0)]);
    let csv = merged.to_csv();
    assert!(csv.lines().nth(1).is_some_and(|line| line.contains(",7,0,,6.25,")), "{csv}");
    assert!(merged.to_markdown().contains("| 0 | 0 | - | 6.25 |"));
    assert!(merged.rows[0].details().contains("? of another colour"));
}

#[test]
fn another_schema_is_refused() {
    let text = r#"{"schema": 7, "adapter": {"name": "", "driver": "", "kind": ""}, "rows": []}"#;
    let error = Report::from_json(text).expect_err("schema 7").to_string();
    assert!(error.contains("schema 7") && error.contains("make it again"), "{error}");
}

#[test]
fn a_row_says_itself_in_words() {
    let report =
        Report::new(adapter(), vec![row("a", "shadow-map", "1024", 12, 3.12), row("a", "z-fail", "", 0, 6.25)]);
    assert_eq!(report.rows[0].summary(), "shadow-map 1024: 1.2\u{a0}% wrong, 3.1 ms");
    assert_eq!(report.rows[1].summary(), "z-fail: none wrong, 6.2 ms");
    assert!(report.rows[0].details().contains("12 wrong of 1\u{a0}000: 12 false shadow"));
}

#[test]
fn the_plot_as_pixels_has_two_a_point_and_is_not_blank() {
    let report = Report::new(adapter(), vec![row("tori", "z-fail", "", 0, 6.25), row("tori", "none", "", 9, 2.0)]);
    let svg = report.to_svg();
    let height: f32 = svg
        .split("viewBox=\"0 0 760 ")
        .nth(1)
        .and_then(|rest| rest.split('"').next())
        .expect("a height")
        .parse()
        .expect("a number");
    let bytes = report.to_png().expect("a picture");
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut pixels).expect("pixels");
    assert_eq!([info.width, info.height], [1520, (height * 2.0).ceil() as u32]);
    let colors: std::collections::BTreeSet<&[u8]> = pixels.chunks_exact(3).collect();
    assert!(colors.contains(&[255_u8; 3][..]) && colors.len() > 50, "{} colours", colors.len());
}

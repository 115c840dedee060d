//! `report` from outside: all its output formats, and what it refuses.

use crate::commands::{assert_fails, done, folder, read_json, run, text};
use crate::common::{adapter, choice, from_above, opened, session, square};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use stencilscope::progress::Progress;
use stencilscope::report::{Report, ReportRow};
use stencilscope::scene::{Light, Object, Scene};
use stencilscope::session::{MeasuredTechnique, Measurement};
use stencilscope::technique::{Choice, Technique};

const SMALL: [&str; 6] = ["report", "triangle.obj", "--size", "80x60", "--runs", "2"];

#[test]
fn the_default_grid_has_every_technique() {
    let grid = Choice::report_grid().expect("every row's settings are valid");
    for technique in Technique::ALL {
        let rows = grid.iter().filter(|choice| choice.technique() == technique).count();
        assert_eq!(rows, technique.description().report_rows.len(), "{technique:?}");
        assert!(rows >= 1);
    }
}

/// The rows without what a clock has measured.
fn untimed(json: &str) -> serde_json::Value {
    let mut document: serde_json::Value = serde_json::from_str(json).expect("JSON");
    for list in ["rows", "summary"] {
        for row in document[list].as_array_mut().into_iter().flatten() {
            let row = row.as_object_mut().expect("a row");
            // Which rows are on the Pareto front depends on times.
            ["frame_ms", "gpu_ms", "setup_ms", "pareto", "course"].iter().for_each(|key| drop(row.remove(*key)));
        }
    }
    document
}

/// Four parts, one after the other and merged in any order, are the rows of one run; a part can be made again alone, and one
/// that is missing is named.
#[test]
fn parts_merge_into_the_rows_of_one_run() {
    let report = ["report", "triangle.obj", "--sweep", "lights=1..2", "--size", "40x30", "--runs", "1"];
    let stress = ["stress", "--case", "near-plane", "--case", "nested", "--size", "40x30"];
    for command in [&report[..], &stress[..]] {
        let folder = folder();
        let run = |words: &[&str]| run(folder.path(), words);
        let file = |name: &str| fs::read_to_string(folder.path().join(name)).expect(name);
        // Unexpected rows, of pictures as small as these, are no failure here.
        let whole = run(&[command, &["--json", "whole.json"]].concat());
        let parts = ["3", "1", "4", "2"].map(|part| {
            let (shard, json) = (format!("{part}/4"), format!("part-{part}.json"));
            run(&[command, &["--shard", &shard, "--json", &json]].concat());
            assert!(file(&json).contains("\"shard\""));
            json
        });
        let merge: Vec<&str> = ["report", "merge"].into_iter().chain(parts.iter().map(String::as_str)).collect();
        let merged = run(&[&merge[..], &["--json", "merged.json"]].concat());
        assert_eq!(merged.status.code(), whole.status.code(), "{}", text(&merged.stderr));
        assert_eq!(untimed(&file("merged.json")), untimed(&file("whole.json")));
        run(&[command, &["--shard", "4/4", "--json", "part-4.json"]].concat());
        run(&[&merge[..], &["--json", "again.json"]].concat());
        assert_eq!(untimed(&file("again.json")), untimed(&file("whole.json")));
        let missing = run(&[&merge[..5], &["--json", "none.json"]].concat());
        assert_eq!(missing.status.code(), Some(2));
        let line = text(&missing.stderr);
        assert!(line.contains("part 2/4 is missing: make it with `--shard 2/4`"), "{line}");
        assert!(!folder.path().join("none.json").exists());
    }
    assert_fails(&["report", "merge", "missing.json"], 2, &["missing.json", "no such file"]);
    assert_fails(&["report", "merge", "triangle.obj"], 2, &["triangle.obj", "can't be read"]);
    assert_fails(&["report", "triangle.obj", "--shard", "0/4"], 2, &["counted from 1"]);
}

/// A report's rows from its file, of which help explains every key.
fn explained_rows(file: &Path) -> Vec<ReportRow> {
    crate::help::assert_json_is_explained("report", &read_json(file));
    Report::from_json(&fs::read_to_string(file).expect("rows")).expect("a report").rows
}

/// Each value of a sweep is a block of rows: with frames a second, and a plot of time against the value.
#[test]
fn a_sweep_measures_every_value() {
    let folder = folder();
    let sweep = |what: &str, more: &[&str]| {
        let words = ["report", "triangle.obj", "--size", "40x30", "--runs", "1", "--sweep", what, "--json", "s.json"];
        done(folder.path(), &[&words[..], more].concat());
        explained_rows(&folder.path().join("s.json"))
    };
    let z_fail = ["-t", "z-fail", "--markdown", "s.md", "--plot", "s.svg"];
    let finer = sweep("triangles=10..1000", &z_fail);
    let triangles: Vec<u64> = finer.iter().map(|row| row.triangles).collect();
    assert!(finer.len() == 7 && triangles.is_sorted() && triangles[6] > 1000, "{triangles:?}");
    assert!(finer.iter().all(|row| row.wrong() == 0 && row.pareto), "the shape is the same");
    let table = fs::read_to_string(folder.path().join("s.md")).expect("a table");
    assert!(table.contains("| of casters | wrong pixels |") && table.contains("| fps |"), "{table}");
    let plot = fs::read_to_string(folder.path().join("s.svg")).expect("a plot");
    assert!(plot.contains("Frame time against triangles") && plot.contains("frames a second"));
    let values = |rows: &[ReportRow]| -> Vec<String> {
        rows.iter().filter_map(|row| Some(row.sweep.as_ref()?.text.clone())).collect()
    };
    assert_eq!(values(&sweep("lights=1..3", &["-t", "auto"])), ["1", "2", "3"]);
    let casters = sweep("casters=1,5", &["-t", "z-fail"]);
    assert!(casters[1].triangles > casters[0].triangles && values(&casters) == ["1", "5"]);
    assert_eq!(
        sweep("size=20x10,40x20", &["-t", "none"]).iter().map(|row| row.size).collect::<Vec<_>>(),
        [[20, 10], [40, 20]]
    );
    // Only techniques that have a map, with each kind of map.
    let maps = sweep("map-size=64,128", &[]);
    assert!(maps.len() > 4 && maps.iter().all(|row| row.settings.contains_key("size")));
    let refused = |words: &[&str], why: &str| {
        assert_fails(&[&["report", "triangle.obj", "--sweep"], words].concat(), 2, &[why]);
    };
    refused(&["lights=0"], "whole numbers from 1 to 64");
    refused(&["wind=1"], "`size`, `lights`, `casters`, `triangles` or `map-size`");
    refused(&["map-size=64", "-t", "z-fail"], "no technique whose maps");
}

/// Where the scene moves, what each frame is set up in counts, and errors are those of all frames.
#[test]
fn frames_that_move_are_counted_with_their_set_up() {
    let folder = folder();
    let words = ["report", "tetrahedron", "--size", "80x60", "-t", "z-fail", "-t", "none", "--json", "m.json"];
    let rows = |time: &str| {
        done(folder.path(), &[&words[..], &["--time", time]].concat());
        explained_rows(&folder.path().join("m.json"))
    };
    let [still, moving] = ["0.5", "0..1:4"].map(rows);
    for (still, moving) in still.iter().zip(&moving) {
        assert_eq!((still.technique.as_str(), still.moving), (moving.technique.as_str(), None));
        let of_frame = moving.moving.expect("it moves");
        assert!(of_frame.setup_ms > 0.0 && of_frame.total_ms > moving.frame_ms.min, "{of_frame:?}");
        assert!((0.0..1.0).contains(&of_frame.setup_share) && moving.frame_ms.runs == 4);
        assert!(moving.cost_ms() == of_frame.total_ms && still.cost_ms() == still.frame_ms.median);
        // The counts are sums over four frames.
        assert!(moving.wrong_color.is_some_and(|all| still.wrong_color.is_some_and(|one| all >= 3 * one)));
        assert!(
            moving.error.compared > 3 * still.error.compared,
            "{} of {}",
            moving.error.compared,
            still.error.compared
        );
    }
    let wrong = |technique: &str| {
        moving.iter().find(|row| row.technique == technique && row.label.is_empty()).map(|row| row.wrong())
    };
    assert!(wrong("z-fail") == Some(0) && wrong("none") > Some(0));
    let first = |technique: &str| moving.iter().find(|row| row.technique == technique && row.label.is_empty());
    let color = |technique: &str| first(technique).and_then(|row| row.wrong_color);
    assert!(color("z-fail") == Some(0) && color("none") > Some(0));
    // Where nothing moves the first frame's set-up serves all; else each has its own.
    let of_none = |moves: &str| {
        let row = row_of_none(folder.path(), &[&words[..], &["--time", "0.5..1:3", "--moves", moves]].concat());
        (row.moving.expect("it moves").setup_ms > 0.0, row.error.compared, row.error.missing_shadow)
    };
    let of_first = still_at_0(folder.path(), &words);
    assert_eq!(of_none("nothing"), (false, 3 * of_first[0], 3 * of_first[1]));
    let [light, eye] = ["light", "eye"].map(of_none);
    assert!(light.0 && eye.0, "{light:?} {eye:?}");
    // Shadows go elsewhere, and are seen from elsewhere.
    assert!(light.2 != 3 * of_first[1] && eye.2 != 3 * of_first[1] && light != eye, "{light:?} {eye:?}");
    assert_fails(&["report", "tetrahedron", "--time", "0..1", "--moves", "lihgt"], 2, &["light"]);
    assert_fails(&["report", "tetrahedron", "--moves", "light"], 2, &["--time A..B"]);
    let table = run(folder.path(), &[&words[..8], &["--time", "0..1:2"]].concat());
    let table = text(&table.stdout);
    assert!(table.contains("+ set-up") && table.contains("total") && table.contains("fps"), "{table}");
    assert_fails(&["report", "tetrahedron", "--time", "2..1"], 2, &["low to high"]);
    assert_fails(&["report", "tetrahedron", "--time", "0..1:0"], 2, &["frames from 1"]);
    assert_fails(&["capture", "tetrahedron", "--time", "0..1", "-o", "out"], 2, &["for `report`", "one moment"]);
}

/// The row of `none` that a command writes.
fn row_of_none(folder: &Path, words: &[&str]) -> ReportRow {
    done(folder, words);
    let json = fs::read_to_string(folder.join("m.json")).expect("rows");
    let rows = Report::from_json(&json).expect("a report").rows;
    rows.into_iter().find(|row| row.technique == "none").expect("none")
}

/// Compared and missing pixels of `none`.
fn still_at_0(folder: &Path, words: &[&str]) -> [u64; 2] {
    let row = row_of_none(folder, words);
    [row.error.compared, row.error.missing_shadow]
}

#[test]
fn a_report_is_written_in_every_form() {
    let folder = folder();
    let file = |name: &str| fs::read_to_string(folder.path().join(name)).expect(name);
    let output = run(folder.path(), &[&SMALL[..], &["--json", "r.json", "--plot", "r.svg"][..]].concat());
    assert_eq!((output.status.code(), text(&output.stdout)), (Some(0), String::new()), "{}", text(&output.stderr));
    let report = Report::from_json(&file("r.json")).expect("a report");
    crate::help::assert_json_is_explained("report", &read_json(&folder.path().join("r.json")));
    assert_eq!(report.rows.len(), Choice::report_grid().expect("a grid").len());
    let labels: BTreeSet<&str> = report.rows.iter().map(|row| row.label.as_str()).collect();
    assert!(labels.contains("1024") && labels.contains("256, bias-slope 0"), "{labels:?}");
    for row in &report.rows {
        assert!(row.frame_ms.min > 0.0 && row.frame_ms.min <= row.frame_ms.median, "{row:?}");
        assert!(row.frame_ms.median <= row.frame_ms.max && row.setup_ms > 0.0, "{row:?}");
        assert!(row.error.compared > 1000 && row.bytes > 80 * 60 * 8 && row.triangles >= 3, "{row:?}");
        assert_eq!(row.frame_ms.runs, 2);
        // Light-facing triangles alone are wrong for an open mesh, a far plane for every mesh.
        let is_wrong_form = row.label.contains("light-facing") || row.label.contains("standard-finite");
        let is_exact = ["z-pass", "z-fail", "ray-traced"].contains(&row.technique.as_str()) && !is_wrong_form;
        assert!(!is_exact || (row.wrong(), row.wrong_color) == (0, Some(0)), "{row:?}");
    }
    let none = report.rows.iter().find(|row| row.technique == "none").expect("none");
    assert!(none.error.missing_shadow > 20 && none.wrong_fraction > 0.0, "{none:?}");
    assert!(report.rows.iter().any(|row| row.pareto && row.wrong() == 0));
    assert!(file("r.svg").contains("<svg") && file("r.svg").contains("shadow-map 4096"));

    let one = [&SMALL[..], &["-t", "z-pass", "-t", "none"][..]].concat();
    let csv = run(folder.path(), &[&one[..], &["--csv"][..]].concat());
    assert_eq!(text(&csv.stdout).lines().count(), 3, "{}", text(&csv.stdout));
    let markdown =
        run(folder.path(), &[&one[..], &["--markdown", "r.md", "--csv", "r.csv", "--plot", "r.png"][..]].concat());
    assert_eq!(markdown.status.code(), Some(0), "{}", text(&markdown.stderr));
    assert!(file("r.md").contains("z-pass"));
    assert_eq!(file("r.csv").lines().count(), 3, "{}", file("r.csv"));
    assert!(fs::read(folder.path().join("r.png")).expect("a picture").starts_with(b"\x89PNG"));
    let page = run(folder.path(), &[&one[..], &["--plot", "models/r.svg", "-o", "r2.md"][..]].concat());
    assert_eq!((page.status.code(), text(&page.stdout)), (Some(0), String::new()), "{}", text(&page.stderr));
    let command = format!("```sh\nstencilscope {} --plot models/r.svg -o r2.md\n```\n", one.join(" "));
    let page = file("r2.md");
    assert!(page.contains(&command) && page.contains("](models/r.svg)"), "{page}");
    assert!(page.contains("## triangle\n") && page.contains("z-pass") && page.contains("2 timed frames"), "{page}");
    let table = run(folder.path(), &one);
    assert!(text(&table.stdout).contains("z-pass") && !text(&table.stdout).contains("planar"));
}

#[test]
fn rows_beyond_the_memory_budget_are_left_out_and_the_others_are_as_they_were() {
    let mut session = session();
    let scene = opened("table");
    let large = choice(Technique::ShadowMap, &[("size", "4096")]);
    let choices = vec![Choice::new(Technique::ZFail), large, Choice::new(Technique::Planar)];
    let what = Measurement { choices, size: [80, 60], runs: 2 };
    let mut measured = |budget| {
        session.set_memory_budget(budget);
        session.measure(&scene, &what, &Progress::default()).expect("rows")
    };
    // The map alone is 64 MiB: where the budget allows it, it is set up anew for each of its frames.
    let (all, few) = (measured(None), measured(Some(32 << 20)));
    let row = |row: &MeasuredTechnique| (row.choice.technique(), row.error, row.frames.len(), row.bytes);
    assert_eq!(all.iter().map(|one| one.choice.clone()).collect::<Vec<_>>(), what.choices);
    assert_eq!(few.iter().map(row).collect::<Vec<_>>(), [&all[0], &all[2]].map(row));
    assert!(all.iter().all(|row| row.frames.len() == 2 && row.gpu_ms.is_none_or(|ms| ms > 0.0)));
}

/// Planar shadows that are blended leave 0.4 of what is there: this sun is such that it is the ambient light alone. A pixel
/// is 0.2 wide at height 0, and what is a height h above it throws its shadow 3 h to the left.
fn under_a_low_sun(floor: Object, casters: &[[f64; 2]]) -> Scene {
    let caster = |(index, [x, y]): (usize, &[f64; 2])| square(&format!("board {index}"), *y, 1.0).at([*x, 0.0, 0.0]);
    let mut scene = from_above(casters.iter().enumerate().map(caster).collect());
    scene.objects[0] = floor;
    let cosine = 1.0 / 10_f32.sqrt();
    scene.lights = vec![Light { intensity: 1.5 * scene.ambient[0] / cosine, ..Light::directional([3.0, 1.0, 0.0]) }];
    scene
}

/// Wrong labels and wrong colours of a technique with settings.
fn wrong(scene: &Scene, size: [u32; 2], rows: &[(Technique, &[(&str, &str)])]) -> Vec<[u64; 2]> {
    let choice = |(technique, settings): &(Technique, &[(&str, &str)])| choice(*technique, settings);
    let what = Measurement { choices: rows.iter().map(choice).collect(), size, runs: 1 };
    let measured = session().measure(scene, &what, &Progress::default()).expect("rows");
    measured.iter().map(|row| [row.error.wrong(), row.wrong_color]).collect()
}

/// Half of the shadow, 5 by 10 pixels, lies beyond the floor's edge, where nothing has a label.
#[test]
fn a_shadow_in_the_air_has_right_labels_and_wrong_colours() {
    let scene = under_a_low_sun(square("floor", 0.0, 3.0), &[[0.0, 1.0]]);
    let rows: [(Technique, &[_]); 3] =
        [(Technique::Planar, &[]), (Technique::Planar, &[("stencil", "off")]), (Technique::None, &[])];
    // Without shadows, the half on the floor is missing.
    assert_eq!(wrong(&scene, [100, 100], &rows), [[0, 0], [0, 50], [50, 50]]);
}

/// Shadows of two boards overlap in 5 by 10 pixels.
#[test]
fn a_shadow_that_is_blended_twice_has_right_labels_and_wrong_colours() {
    let scene = under_a_low_sun(square("floor", 0.0, 50.0), &[[6.0, 1.0], [8.0, 2.0]]);
    let rows: [(Technique, &[_]); 3] =
        [(Technique::Planar, &[]), (Technique::Planar, &[("blend", "twice")]), (Technique::ZFail, &[])];
    assert_eq!(wrong(&scene, [100, 100], &rows), [[0, 0], [0, 50], [0, 0]]);
}

/// Where labels are right and shadows are hard, so are colours; a wrong label is a wrong colour wherever the light is
/// more than a trace.
#[test]
fn colours_are_wrong_where_labels_are() {
    for name in ["tori", "table", "inside", "two-lights", "glass", "spheres"] {
        let scene = opened(name);
        for shading in ["as-given", "gouraud"] {
            let same = ("shading", shading);
            let right = [Technique::ZFail, Technique::Auto, Technique::RayTraced];
            let rows: Vec<(Technique, &[_])> = right.iter().map(|one| (*one, std::slice::from_ref(&same))).collect();
            let most = if adapter::draws_as_given() { 0 } else { 2 };
            for [labels, colors] in wrong(&scene, [160, 90], &rows) {
                assert!(labels <= most && colors <= labels, "{name}, {shading}: {labels}, {colors}");
            }
        }
        if scene.lights.len() == 1 {
            let rows: [(Technique, &[_]); 2] = [(Technique::ShadowMap, &[("bias-slope", "0")]), (Technique::None, &[])];
            for [labels, colors] in wrong(&scene, [160, 90], &rows) {
                assert!(colors * 100 >= labels * 95 && labels * 100 >= colors * 95, "{name}: {labels}, {colors}");
            }
        }
    }
}

/// Two models of one name are two scenes: neither hides the other's front.
#[test]
fn scenes_of_one_name_are_distinguished() {
    let folder = folder();
    fs::copy(folder.path().join("triangle.obj"), folder.path().join("models/triangle.obj")).expect("copied");
    let arguments = ["report", "triangle.obj", "models/triangle.obj", "--size", "40x30", "--runs", "1", "-t", "none"];
    let output = run(folder.path(), &[&arguments[..], &["--json"][..]].concat());
    let report = Report::from_json(&text(&output.stdout)).expect("a report");
    assert_eq!(report.scenes(), ["triangle", "triangle (2)"]);
    assert!(report.rows.iter().all(|row| row.pareto));
}

#[test]
fn settings_narrow_the_grid() {
    let folder = folder();
    let options = ["-t", "shadow-map", "--set", "size=64", "--set", "bias-slope=1.5", "--json"];
    let output = run(folder.path(), &[&SMALL[..], &options[..]].concat());
    let report = Report::from_json(&text(&output.stdout)).expect("a report");
    // Rows that differ in size or slope alone are one row now.
    let grid = Choice::report_grid().expect("a grid");
    let ways = grid.iter().filter(|choice| choice.technique() == Technique::ShadowMap).map(|choice| {
        let mut settings = choice.settings().clone();
        settings.retain(|key, _| key != "size" && key != "bias-slope");
        settings
    });
    assert_eq!(report.rows.len(), ways.collect::<BTreeSet<_>>().len());
    for row in &report.rows {
        assert_eq!((row.settings["size"].as_str(), row.settings["bias-slope"].as_str()), ("64", "1.5"));
    }
}

#[test]
fn what_a_report_can_not_do_is_refused_before_it_measures() {
    let cases: &[(&[&str], &[&str])] = &[
        (&[], &["<SCENE>"]),
        (&["tori", "--plot", "r.gif"], &[".svg or .png"]),
        (&["tori", "-o", "r.txt"], &["ends in .md"]),
        (&["tori", "-o", "missing/r.md"], &["missing/r.md", "choose another file"]),
        (&["tori", "--markdown", "r.md", "-o", "r.md"], &["two results"]),
        (&["tori", "--plot", "missing/r.svg"], &["missing/r.svg", "choose another file"]),
        (&["tori", "--json", "models"], &["models", "choose another file"]),
        (&["tori", "-t", "z-fial"], &["did you mean `z-fail`?"]),
        (&["tori", "-t", "automatic"], &["no technique is called `automatic`"]),
        (&["tori", "--set", "sise=3"], &["sise"]),
        (&["tori", "--set", "size=0"], &["size", "from 1"]),
        (&["tori", "--runs", "0"], &["0"]),
        (&["tori", "--json", "table"], &["`table` names a scene", "--json=FILE"]),
        (&["tori", "--csv", "triangle.obj"], &["names a scene"]),
        (&["good.toml", "--markdown", "good.toml"], &["names a scene"]),
        (&["tori", "--json", "r.svg", "--plot", "r.svg"], &["two results"]),
        (&["tori", "--json", "--markdown"], &["both go to standard output", "--json=FILE"]),
        (&["tory"], &["did you mean `tori`?"]),
    ];
    for (options, words) in cases {
        assert_fails(&[&["report"], *options].concat(), 2, words);
    }
    assert_fails(&["report", "tori", "--adapter", "no such gpu"], 3, &["mesa-vulkan-drivers"]);
}

//! `report` from outside: all its forms, and what it refuses.

use crate::commands::{assert_fails, folder, run, text};
use crate::common::session;
use std::collections::BTreeSet;
use std::fs;
use stencilscope::progress::Progress;
use stencilscope::report::Report;
use stencilscope::scene::builtin::Builtin;
use stencilscope::session::{Measured, Measurement};
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

#[test]
fn a_report_is_written_in_every_form() {
    let folder = folder();
    let file = |name: &str| fs::read_to_string(folder.path().join(name)).expect(name);
    let output = run(folder.path(), &[&SMALL[..], &["--json", "r.json", "--plot", "r.svg"][..]].concat());
    assert_eq!((output.status.code(), text(&output.stdout)), (Some(0), String::new()), "{}", text(&output.stderr));
    let report = Report::from_json(&file("r.json")).expect("a report");
    crate::help::assert_json_is_explained("report", &serde_json::from_str(&file("r.json")).expect("JSON"));
    assert_eq!(report.rows.len(), Choice::report_grid().expect("a grid").len());
    let labels: BTreeSet<&str> = report.rows.iter().map(|row| row.label.as_str()).collect();
    assert!(labels.contains("1024") && labels.contains("256, bias-slope 0"), "{labels:?}");
    for row in &report.rows {
        assert!(row.frame_ms.min > 0.0 && row.frame_ms.min <= row.frame_ms.median, "{row:?}");
        assert!(row.frame_ms.median <= row.frame_ms.max && row.setup_ms > 0.0, "{row:?}");
        assert!(row.compared > 1000 && row.bytes > 80 * 60 * 8 && row.triangles >= 3, "{row:?}");
        assert_eq!(row.frame_ms.runs, 2);
        // Light-facing triangles alone are wrong for an open mesh, a far plane for every mesh.
        let is_wrong_form = row.label.contains("light-facing") || row.label.contains("standard-finite");
        let is_exact = ["z-pass", "z-fail", "ray-traced"].contains(&row.technique.as_str()) && !is_wrong_form;
        assert!(!is_exact || row.wrong() == 0, "{row:?}");
    }
    let none = report.rows.iter().find(|row| row.technique == "none").expect("none");
    assert!(none.missing_shadow > 20 && none.wrong_fraction > 0.0, "{none:?}");
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
fn rows_for_which_there_is_no_room_are_left_out_and_the_others_are_as_they_were() {
    let mut session = session();
    let scene = Builtin::named("table").expect("a name").scene().expect("a scene");
    let mut large = Choice::new(Technique::ShadowMap);
    large.set("size", "4096").expect("a size");
    let choices = vec![Choice::new(Technique::ZFail), large, Choice::new(Technique::Planar)];
    let what = Measurement { choices, size: [80, 60], runs: 2 };
    let mut measured = |room| {
        session.set_room(room);
        session.measure(&scene, &what, &Progress::default()).expect("rows")
    };
    // The map alone is 64 MiB: where there is room, it is set up anew for each of its frames.
    let (all, few) = (measured(None), measured(Some(32 << 20)));
    let row = |row: &Measured| (row.choice.technique(), row.error, row.frames.len(), row.bytes);
    assert_eq!(all.iter().map(|one| one.choice.clone()).collect::<Vec<_>>(), what.choices);
    assert_eq!(few.iter().map(row).collect::<Vec<_>>(), [&all[0], &all[2]].map(row));
    assert!(all.iter().all(|row| row.frames.len() == 2 && row.gpu_ms.is_none_or(|ms| ms > 0.0)));
}

/// Two models of one name are two scenes: neither hides the other's front.
#[test]
fn scenes_of_one_name_are_told_apart() {
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

//! Dependencies between modules point one way, and only `gpu` and `app` hold a device.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Each module with those that it may use.
const MAY_USE: [(&str, &[&str]); 27] = [
    ("named", &[]),
    ("math", &[]),
    ("progress", &[]),
    ("numbers", &[]),
    ("files", &[]),
    ("picture", &[]),
    ("scene", &["math", "files"]),
    ("truth", &["math", "scene", "progress"]),
    ("accuracy", &["truth"]),
    ("geometry", &["math", "scene"]),
    ("plan", &["math", "scene", "geometry", "numbers"]),
    ("technique", &["math", "scene", "geometry", "plan", "truth", "progress", "numbers"]),
    ("capture", &["math", "scene", "plan", "accuracy"]),
    ("stencil_machine", &["plan"]),
    ("gpu", &["math", "scene", "plan", "capture"]),
    ("history", &["math", "numbers", "plan", "capture", "stencil_machine", "truth"]),
    ("difference", &["capture", "accuracy", "numbers", "picture"]),
    (
        "diagnosis",
        &[
            "math",
            "scene",
            "geometry",
            "plan",
            "technique",
            "capture",
            "truth",
            "accuracy",
            "history",
            "numbers",
            "picture",
        ],
    ),
    ("anatomy", &["math", "scene", "geometry", "plan", "technique"]),
    ("report", &["technique", "capture", "numbers"]),
    ("stress", &["scene", "technique", "accuracy", "capture", "numbers", "report"]),
    (
        "session",
        &[
            "numbers",
            "math",
            "scene",
            "geometry",
            "plan",
            "technique",
            "anatomy",
            "capture",
            "gpu",
            "truth",
            "accuracy",
            "progress",
            "report",
            "history",
            "stencil_machine",
            "diagnosis",
            "stress",
        ],
    ),
    (
        "inspector",
        &[
            "math",
            "scene",
            "geometry",
            "plan",
            "technique",
            "anatomy",
            "capture",
            "difference",
            "diagnosis",
            "picture",
            "stencil_machine",
            "accuracy",
            "report",
            "numbers",
            "history",
            "diagnosis",
            "stress",
        ],
    ),
    (
        "app",
        &[
            "files",
            "scene",
            "plan",
            "technique",
            "anatomy",
            "capture",
            "diagnosis",
            "session",
            "inspector",
            "progress",
            "report",
            "history",
            "picture",
            "stress",
        ],
    ),
    ("testing", &["scene", "technique", "plan", "capture", "history", "session", "truth", "numbers"]),
    (
        "cli",
        &[
            "files",
            "numbers",
            "math",
            "scene",
            "picture",
            "plan",
            "technique",
            "capture",
            "diagnosis",
            "difference",
            "history",
            "session",
            "app",
            "inspector",
            "progress",
            "report",
            "stress",
        ],
    ),
    ("main", &["cli"]),
];

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// The module a file belongs to: its first part below `src`.
fn module_of(file: &Path, source: &Path) -> String {
    let first = file.strip_prefix(source).expect("below src").components().next().expect("a part");
    first.as_os_str().to_string_lossy().trim_end_matches(".rs").to_owned()
}

/// A file's code on one line, without comments.
fn code_of(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join(" ")
}

/// The modules that code names as `crate::name` or in `crate::{name::…, name}`.
fn named_modules(code: &str) -> Vec<String> {
    let name = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut names = Vec::new();
    for after in code.split("crate::").skip(1) {
        let Some(group) = after.strip_prefix('{') else {
            names.push(name(after));
            continue;
        };
        let (mut depth, mut is_start) = (1, true);
        for (at, c) in group.char_indices() {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 1 => is_start = true,
                c if is_start && c.is_alphabetic() => {
                    names.push(name(&group[at..]));
                    is_start = false;
                }
                _ => {}
            }
            if depth == 0 {
                break;
            }
        }
    }
    names
}

/// A device or queue of wgpu, imported in any way or named in full.
fn holds_device(code: &str) -> bool {
    let words = |text: &str| {
        let words = text.split(|c: char| !(c.is_alphanumeric() || c == '_'));
        words.map(ToOwned::to_owned).collect::<Vec<_>>()
    };
    let in_wgpu =
        |item: &str| item.contains("wgpu") && words(item).iter().any(|word| word == "Device" || word == "Queue");
    code.split(';').any(in_wgpu)
}

fn violations(module: &str, text: &str) -> Vec<String> {
    let may_use: BTreeMap<&str, &[&str]> = MAY_USE.into_iter().collect();
    let Some(allowed) = may_use.get(module) else {
        return vec![format!("`{module}` is not in the table of layers")];
    };
    let code = code_of(text);
    let forbidden = named_modules(&code).into_iter().filter(|used| used != module && !allowed.contains(&used.as_str()));
    let mut found: Vec<String> = forbidden.map(|used| format!("`{module}` uses `{used}`")).collect();
    if holds_device(&code) && !["gpu", "app"].contains(&module) {
        found.push(format!("`{module}` names a device"));
    }
    found
}

#[test]
fn dependencies_point_one_way() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    for file in rust_files(&source) {
        let module = module_of(&file, &source);
        if module != "lib" {
            let text = fs::read_to_string(&file).expect("a source file");
            found.extend(violations(&module, &text));
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn an_arrow_that_runs_the_other_way_is_found() {
    assert!(violations("plan", "use crate::technique::Choice;").len() == 1);
    assert!(violations("plan", "use crate::{capture::Image,\n    gpu::{Context, Executor}, scene};").len() == 2);
    assert!(violations("capture", "    let device: wgpu::Device = open();").len() == 1);
    assert!(violations("session", "use wgpu::{\n    Buffer,\n    Queue,\n};").len() == 1);
    assert!(violations("session", "use wgpu::Device as D;").len() == 1);
    assert!(violations("gpu", "use crate::plan::Pass; // crate::technique is not needed").is_empty());
    assert!(violations("newcomer", "").len() == 1);
}

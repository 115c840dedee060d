//! Dependencies between modules point one way, and only `gpu` and `app` hold a device.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Each module with those that it may use.
const MAY_USE: [(&str, &[&str]); 13] = [
    ("math", &[]),
    ("scene", &["math"]),
    ("geometry", &["math", "scene"]),
    ("plan", &["math", "scene", "geometry"]),
    ("technique", &["math", "scene", "geometry", "plan"]),
    ("capture", &["math", "scene", "plan"]),
    ("stencil_machine", &["plan"]),
    ("gpu", &["math", "scene", "plan", "capture"]),
    ("session", &["math", "scene", "geometry", "plan", "technique", "capture", "gpu"]),
    ("inspector", &["math", "scene", "plan", "technique", "capture", "stencil_machine"]),
    ("app", &["scene", "plan", "technique", "capture", "session", "inspector"]),
    ("cli", &["math", "scene", "plan", "technique", "capture", "session", "app"]),
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

/// The modules that a line of code names as `crate::name`.
fn named_modules(line: &str) -> Vec<String> {
    let code = line.split("//").next().unwrap_or_default();
    let after = code.split("crate::").skip(1);
    let name = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    after.map(name).filter(|name| !name.is_empty()).collect()
}

fn violations(module: &str, text: &str) -> Vec<String> {
    let may_use: BTreeMap<&str, &[&str]> = MAY_USE.into_iter().collect();
    let Some(allowed) = may_use.get(module) else {
        return vec![format!("`{module}` is not in the table of layers")];
    };
    let mut found = Vec::new();
    for line in text.lines() {
        for used in named_modules(line) {
            if used != module && !allowed.contains(&used.as_str()) {
                found.push(format!("`{module}` uses `{used}`: {}", line.trim()));
            }
        }
        let holds_device = ["wgpu::Device", "wgpu::Queue", "Device,", "Queue}"].iter().any(|name| line.contains(name));
        if holds_device && line.contains("wgpu") && !["gpu", "app"].contains(&module) {
            found.push(format!("`{module}` names a device: {}", line.trim()));
        }
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
    assert!(violations("capture", "    let device: wgpu::Device = open();").len() == 1);
    assert!(violations("gpu", "use crate::plan::Pass; // crate::technique is not needed").is_empty());
    assert!(violations("newcomer", "").len() == 1);
}

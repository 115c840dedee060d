//! Dependencies between modules point one way, and only `gpu`, `app`, `offscreen`, `repaint`, `viewport`, `wrap` and `record` hold a device.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Each module with those that it may use.
const MAY_USE: [(&str, &[&str]); 43] = [
    ("named", &[]),
    ("last_used", &[]),
    ("math", &[]),
    ("progress", &[]),
    ("numbers", &[]),
    ("files", &[]),
    ("shards", &[]),
    ("picture", &["numbers"]),
    ("viewport", &[]),
    ("adapters", &[]),
    ("repaint", &[]),
    ("offscreen", &["adapters", "picture", "repaint"]),
    ("scene", &["math", "files", "last_used"]),
    ("truth", &["math", "scene", "progress"]),
    ("accuracy", &["numbers", "truth"]),
    ("geometry", &["math", "scene", "last_used"]),
    ("plan", &["math", "scene", "geometry", "numbers"]),
    ("technique", &["math", "scene", "geometry", "plan", "truth", "progress", "numbers"]),
    ("capture", &["math", "scene", "plan", "accuracy", "truth", "files", "numbers"]),
    ("stencil_machine", &["plan"]),
    ("recorded", &["math", "scene", "plan", "capture", "stencil_machine", "truth", "numbers"]),
    ("import", &["math", "scene", "plan", "capture", "recorded", "progress", "files"]),
    ("wrap", &[]),
    ("gpu", &["adapters", "math", "scene", "plan", "capture", "wrap", "last_used"]),
    ("history", &["math", "numbers", "geometry", "plan", "technique", "capture", "stencil_machine", "truth"]),
    ("difference", &["capture", "accuracy", "numbers", "picture", "truth"]),
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
            "recorded",
            "numbers",
            "picture",
        ],
    ),
    ("check", &["accuracy", "capture", "diagnosis", "numbers", "plan", "technique"]),
    ("anatomy", &["math", "scene", "geometry", "plan", "technique", "recorded"]),
    ("report", &["technique", "capture", "accuracy", "numbers", "picture", "shards"]),
    ("stress", &["math", "scene", "technique", "accuracy", "capture", "numbers", "report", "shards"]),
    (
        "reading",
        &[
            "accuracy",
            "anatomy",
            "capture",
            "difference",
            "geometry",
            "history",
            "math",
            "numbers",
            "picture",
            "plan",
            "recorded",
            "scene",
            "stencil_machine",
            "technique",
            "truth",
        ],
    ),
    (
        "ask",
        &[
            "anatomy",
            "capture",
            "diagnosis",
            "history",
            "plan",
            "progress",
            "reading",
            "report",
            "scene",
            "stress",
            "technique",
        ],
    ),
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
            "shards",
            "history",
            "stencil_machine",
            "diagnosis",
            "check",
            "stress",
            "ask",
            "reading",
            "recorded",
        ],
    ),
    ("link", &["scene", "technique", "ask"]),
    ("page", &["math", "plan", "history", "capture", "technique", "picture", "numbers", "files", "reading"]),
    ("film", &["math", "scene", "capture", "reading", "picture", "numbers", "files", "session"]),
    (
        "inspector",
        &[
            "viewport",
            "scene",
            "plan",
            "technique",
            "anatomy",
            "capture",
            "diagnosis",
            "picture",
            "accuracy",
            "report",
            "numbers",
            "history",
            "stress",
            "ask",
            "reading",
        ],
    ),
    (
        "app",
        &[
            "offscreen",
            "repaint",
            "viewport",
            "files",
            "scene",
            "plan",
            "technique",
            "capture",
            "import",
            "link",
            "session",
            "film",
            "page",
            "inspector",
            "progress",
            "report",
            "picture",
            "stress",
            "ask",
            "reading",
        ],
    ),
    ("record", &["wrap", "plan", "capture", "import", "progress", "session"]),
    (
        "testing",
        &["scene", "technique", "plan", "capture", "history", "session", "truth", "numbers", "math", "reading"],
    ),
    (
        "cli",
        &[
            "recorded",
            "files",
            "film",
            "page",
            "numbers",
            "import",
            "scene",
            "picture",
            "plan",
            "technique",
            "capture",
            "diagnosis",
            "difference",
            "history",
            "check",
            "session",
            "app",
            "inspector",
            "link",
            "progress",
            "report",
            "shards",
            "stress",
            "ask",
            "reading",
            "recorded",
        ],
    ),
    ("main", &["cli"]),
];

pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
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
    if holds_device(&code) && !["gpu", "app", "offscreen", "repaint", "viewport", "wrap", "record"].contains(&module) {
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

/// Folders of the inspector, each with those that it may use.
const INSPECTOR_MAY_USE: [(&str, &[&str]); 8] = [
    ("action", &[]),
    ("look", &[]),
    ("tours", &["action"]),
    ("model", &["action", "look"]),
    ("canvas", &["look", "model"]),
    ("panels", &["action", "look", "tours", "model", "canvas"]),
    ("shell", &["action", "look", "tours", "model", "canvas", "panels"]),
    ("mod", &["action", "look", "model", "panels", "shell"]),
];

/// A module's path below the crate: `inspector`, `panels`.
type ModulePath = Vec<String>;

/// What a source file says of others.
#[derive(Default)]
struct Source {
    /// What is imported or named in full.
    uses: Vec<ModulePath>,
    /// Names that it hands on, with where they come from.
    hands_on: BTreeMap<String, ModulePath>,
}

/// The paths of a tree of imports: `a::{b, c::d}` are two.
fn expanded(tree: &str, prefix: &[String], found: &mut Vec<ModulePath>) {
    let (head, group) = match tree.split_once('{') {
        Some((head, rest)) => (head, rest.rsplit_once('}').map(|(group, _)| group)),
        None => (tree, None),
    };
    let head = head.split(" as ").next().unwrap_or_default();
    let parts = head.split("::").map(str::trim).filter(|part| !part.is_empty()).map(ToOwned::to_owned);
    let path: ModulePath = prefix.iter().cloned().chain(parts).collect();
    let Some(group) = group else { return found.push(path) };
    let (mut depth, mut start) = (0, 0);
    for (at, c) in group.char_indices().chain([(group.len(), ',')]) {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                let part = group[start..at].trim();
                if !part.is_empty() {
                    expanded(part, &path, found);
                }
                start = at + 1;
            }
            _ => {}
        }
    }
}

/// Words of code with `::` between them.
fn named_paths(code: &str) -> Vec<ModulePath> {
    let is_of_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let paths = code.split(|c: char| !is_of_path(c)).filter(|path| path.contains("::"));
    paths.map(|path| path.split("::").filter(|part| !part.is_empty()).map(ToOwned::to_owned).collect()).collect()
}

/// From the crate's root: a path as a module at `at` writes it; `None` where it is of another crate.
fn absolute(path: &[String], at: &[String], modules: &BTreeMap<ModulePath, PathBuf>) -> Option<ModulePath> {
    let first = path.first()?.as_str();
    let supers = path.iter().take_while(|part| *part == "super").count();
    let is_child = || modules.contains_key(&at.iter().chain([&path[0]]).cloned().collect::<ModulePath>());
    match first {
        "crate" => Some(path[1..].to_vec()),
        "self" => Some(at.iter().chain(&path[1..]).cloned().collect()),
        "super" => Some(at[..at.len().checked_sub(supers)?].iter().chain(&path[supers..]).cloned().collect()),
        _ => is_child().then(|| at.iter().chain(path).cloned().collect()),
    }
}

/// A file without its own tests.
fn without_tests(text: &str) -> &str {
    let tests =
        text.find("#[cfg(test)]\nmod ").filter(|at| text[*at..].lines().nth(1).is_some_and(|l| l.ends_with('{')));
    tests.map_or(text, |at| &text[..at])
}

fn source_of(text: &str, at: &[String], modules: &BTreeMap<ModulePath, PathBuf>) -> Source {
    let code = code_of(without_tests(text));
    let (mut source, mut rest) = (Source::default(), String::new());
    for statement in code.split(';') {
        let place =
            statement.rfind("use ").filter(|at| statement[..*at].chars().next_back().is_none_or(char::is_whitespace));
        let Some(place) = place else {
            rest.push_str(statement);
            rest.push(';');
            continue;
        };
        let mut paths = Vec::new();
        expanded(&statement[place + 4..], &[], &mut paths);
        let before = statement[..place].trim_end();
        let hands_on = before.ends_with("pub") || (before.ends_with(')') && before.contains("pub("));
        rest.push_str(before);
        for path in paths.iter().filter_map(|path| absolute(path, at, modules)) {
            match (hands_on, path.last()) {
                (true, Some(name)) => drop(source.hands_on.insert(name.clone(), path.clone())),
                _ => source.uses.push(path),
            }
        }
    }
    source.uses.extend(named_paths(&rest).iter().filter_map(|path| absolute(path, at, modules)));
    source
}

/// The module in which what a path names is written: where it is handed on, further down.
fn home(path: &[String], sources: &BTreeMap<ModulePath, Source>, turns: usize) -> Option<ModulePath> {
    let module = (0..=path.len()).rev().map(|end| &path[..end]).find(|prefix| sources.contains_key(*prefix))?;
    let handed_on = path.get(module.len()).and_then(|name| sources[module].hands_on.get(name));
    match handed_on.filter(|_| turns > 0) {
        Some(from) => home(from, sources, turns - 1),
        None => Some(module.to_vec()),
    }
}

/// Every module with those whose files it takes anything from. A folder's `mod.rs` stands for the folder: what the
/// files in it take of it (`super::Error`) is no arrow, as it leaves nothing.
fn arrows() -> BTreeMap<ModulePath, BTreeSet<ModulePath>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let module = |file: &PathBuf| -> ModulePath {
        let path = file.strip_prefix(&root).expect("below src").with_extension("");
        let parts: ModulePath = path.components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
        parts.into_iter().filter(|part| part != "mod" && part != "lib").collect()
    };
    let is_product = |file: &PathBuf| !file.ends_with("tests.rs") && !file.ends_with("main.rs");
    let files = rust_files(&root).into_iter().filter(is_product);
    let modules: BTreeMap<ModulePath, PathBuf> = files.map(|file| (module(&file), file)).collect();
    let text = |file: &PathBuf| fs::read_to_string(file).expect("a source file");
    let sources: BTreeMap<ModulePath, Source> =
        modules.iter().map(|(at, file)| (at.clone(), source_of(&text(file), at, &modules))).collect();
    let used = |(at, source): (&ModulePath, &Source)| {
        let homes = source.uses.iter().filter_map(|path| home(path, &sources, 8));
        (at.clone(), homes.filter(|home| !at.starts_with(home)).collect())
    };
    sources.iter().map(used).collect()
}

/// Modules that lead back to themselves, with all on the way, each circle once.
fn circles(arrows: &BTreeMap<ModulePath, BTreeSet<ModulePath>>) -> BTreeSet<BTreeSet<&ModulePath>> {
    let reached = |from: &ModulePath| {
        let (mut seen, mut left) = (BTreeSet::new(), vec![from]);
        while let Some(next) = left.pop() {
            for to in arrows.get_key_value(next).iter().flat_map(|(_, to)| to.iter()) {
                if seen.insert(to) {
                    left.push(to);
                }
            }
        }
        seen
    };
    let all: BTreeMap<&ModulePath, BTreeSet<&ModulePath>> = arrows.keys().map(|from| (from, reached(from))).collect();
    let circle = |from: &&ModulePath| -> BTreeSet<&ModulePath> {
        all[*from].iter().copied().filter(|to| all.get(*to).is_some_and(|back| back.contains(*from))).collect()
    };
    all.keys().map(circle).filter(|circle| circle.len() > 1).collect()
}

#[test]
fn no_files_use_each_other_in_a_circle() {
    let arrows = arrows();
    assert!(arrows.len() > 300, "{} files are read", arrows.len());
    let name = |circle: &BTreeSet<&ModulePath>| circle.iter().map(|path| path.join("/")).collect::<Vec<_>>().join(", ");
    let circles = circles(&arrows);
    let wrong: Vec<String> = circles.iter().map(name).collect();
    assert!(wrong.is_empty(), "circles of files:\n{}", wrong.join("\n"));
}

#[test]
fn folders_of_the_inspector_use_those_below_them() {
    let may_use: BTreeMap<&str, &[&str]> = INSPECTOR_MAY_USE.into_iter().collect();
    let mut found = Vec::new();
    for (from, to) in arrows() {
        if from.first().is_none_or(|first| first != "inspector") {
            continue;
        }
        let folder = |path: &ModulePath| path.get(1).map_or("mod", String::as_str).to_owned();
        let allowed = may_use.get(folder(&from).as_str()).copied().unwrap_or_default();
        let inside = to.iter().filter(|to| to[0] == "inspector" && folder(to) != folder(&from));
        let wrong = inside.filter(|to| !allowed.contains(&folder(to).as_str()));
        found.extend(wrong.map(|to| format!("{} uses {}", from.join("/"), to.join("/"))));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn a_circle_of_three_is_found_and_what_is_handed_on_is_no_arrow() {
    let path = |text: &str| -> ModulePath { text.split('/').map(ToOwned::to_owned).collect() };
    let modules: BTreeMap<ModulePath, PathBuf> =
        ["a", "a/b", "a/c", "d"].map(|name| (path(name), PathBuf::new())).into_iter().collect();
    let texts = [
        ("a", "mod b;\npub use b::{One, Two};\nuse c::Three;"),
        ("a/b", "use crate::d::{self, Four};"),
        ("a/c", "use super::One;\n#[cfg(test)]\nmod tests {\n    use crate::a::Three;\n}"),
        ("d", "fn f() { crate::a::c::Three::new() }"),
    ];
    let sources: BTreeMap<ModulePath, Source> =
        texts.iter().map(|(at, text)| (path(at), source_of(text, &path(at), &modules))).collect();
    assert_eq!(home(&path("a/One"), &sources, 8), Some(path("a/b")));
    let arrows: BTreeMap<ModulePath, BTreeSet<ModulePath>> = sources
        .iter()
        .map(|(at, source)| (at.clone(), source.uses.iter().filter_map(|to| home(to, &sources, 8)).collect()))
        .collect();
    let all = ["a/b", "a/c", "d"].map(path);
    assert_eq!(circles(&arrows), BTreeSet::from([all.iter().collect()]));
}

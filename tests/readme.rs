//! What is written about the program: links lead somewhere, numbers hold, and comments cite only what is there.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// A page that nobody reads to its end helps nobody.
const MOST_BYTES: usize = 15_000;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(file: &str) -> String {
    fs::read_to_string(root().join(file)).expect(file)
}

/// The files that a page of Markdown links to or shows.
fn links(page: &str) -> Vec<&str> {
    page.split("](").skip(1).filter_map(|after| after.split(')').next()).collect()
}

#[test]
fn the_readme_is_short_and_its_links_lead_somewhere() {
    let readme = read("README.md");
    assert!(readme.len() <= MOST_BYTES, "{} bytes", readme.len());
    let links = links(&readme);
    assert!(links.len() > 10, "{links:?}");
    for link in links {
        assert!(root().join(link).is_file(), "{link}");
    }
}

/// Sentences that were wrong once.
#[test]
fn what_the_readme_once_said_wrongly_it_says_rightly() {
    let readme = read("README.md");
    for says in [
        "casters flattened onto the flat receivers that show most",
        "casters drawn into textures of the largest flat receivers",
        "whichever draws less while right",
        "each pass's formula (volumes, maps: with this scene's and pixel's numbers)",
    ] {
        assert!(readme.contains(says), "{says}");
    }
    for never in ["every flat receiver", "whichever is cheaper", "formula with the numbers of this scene and pixel"] {
        assert!(!readme.contains(never), "{never}");
    }
}

#[test]
fn the_readme_names_every_technique_and_the_number_of_cases() {
    let readme = read("README.md");
    for technique in stencilscope::technique::Technique::ALL {
        assert!(readme.contains(&format!("| `{}` |", technique.name())), "{technique:?}");
    }
    let cases = stencilscope::stress::cases::all().count();
    assert!(readme.contains(&format!("has the {cases} cases")), "{cases}");
}

/// Cargo's own list: what a program gets that only records, beside what its wgpu brings. The features of wgpu that are
/// needed bring four packages more, which cargo has within wgpu.
#[test]
fn library_md_lists_the_packages_of_a_build_that_records() {
    const OF_WGPU: [&str; 4] = ["serde", "serde_core", "serde_derive", "termcolor"];
    let arguments =
        "tree --locked --offline -e normal,build --no-default-features --features record --no-dedupe --prefix depth";
    let mut cargo = std::process::Command::new(env!("CARGO"));
    let output = cargo.args(arguments.split(' ')).args(["-f", " {p}"]).current_dir(root()).output().expect("cargo");
    let tree = String::from_utf8(output.stdout).expect("text");
    let (mut all, mut of_wgpu, mut within) = (BTreeSet::new(), BTreeSet::new(), None);
    for line in tree.lines() {
        let (depth, package) = line.split_once(' ').expect("a depth");
        let depth: u32 = depth.parse().expect("a depth");
        let package: Vec<&str> = package.split(' ').take(2).collect();
        within = within.filter(|top| depth > *top);
        if within.is_none() && package[0] == "wgpu" {
            within = Some(depth);
        }
        all.insert(package.clone());
        of_wgpu.extend(within.map(|_| package));
    }
    let ours: Vec<&str> =
        all.difference(&of_wgpu).map(|package| package[0]).filter(|name| *name != "stencilscope").collect();
    assert!(ours.len() > 10 && ours.len() + OF_WGPU.len() <= 40, "{ours:?}");
    let names: BTreeSet<&str> = ours.iter().copied().chain(OF_WGPU).collect();
    let page = read("assets/library.md");
    let list = page
        .split("packages beside plain wgpu's: ")
        .nth(1)
        .and_then(|after| after.split(".\n").next())
        .expect("a list");
    let listed: BTreeSet<&str> = list
        .split([',', '\n'])
        .map(|name| name.trim().trim_end_matches(" (two)"))
        .filter(|name| !name.is_empty())
        .collect();
    assert_eq!(listed, names);
    assert!(page.contains(&format!("brings {} packages beside", ours.len() + OF_WGPU.len())), "{}", ours.len());
}

/// Pages that the program has written say how.
#[test]
fn measured_pages_name_the_command_that_writes_them() {
    for (page, command) in [("assets/report.md", "stencilscope report "), ("assets/stress.md", "stencilscope stress ")]
    {
        let text = read(page);
        let line = text.split("```sh\n").nth(1).and_then(|after| after.lines().next()).expect("a command");
        assert!(line.starts_with(command) && line.ends_with(&format!("-o {page}")), "{line}");
        for link in links(&text) {
            assert!(root().join("assets").join(link).is_file(), "{page}: {link}");
        }
    }
}

/// All files below a folder with one of these endings.
fn files(folder: &Path, endings: &[&str], found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files(&path, endings, found);
        } else if path.extension().is_some_and(|ending| endings.iter().any(|one| ending == *one)) {
            found.push(path);
        }
    }
}

#[test]
fn no_comment_cites_a_file_that_is_not_here() {
    let is_part = |c: char| c.is_alphanumeric() || "-_./".contains(c);
    let mut all = Vec::new();
    ["src", "shaders", "tests", "assets"].iter().for_each(|folder| {
        files(&root().join(folder), &["rs", "wgsl", "md", "toml", "obj"], &mut all);
    });
    all.push(root().join("README.md"));
    let sources = all.iter().filter(|file| file.extension().is_some_and(|ending| ending == "rs" || ending == "wgsl"));
    let mut cited = 0;
    for file in sources {
        let text = fs::read_to_string(file).expect("a source file");
        let comments = text.lines().filter_map(|line| line.trim_start().strip_prefix("//"));
        let words =
            comments.flat_map(|comment| comment.split(|c: char| !is_part(c)).map(|word| word.trim_end_matches('.')));
        for word in words.filter(|word| {
            [".md", ".rs", ".wgsl"].iter().any(|ending| word.len() > ending.len() && word.ends_with(ending))
        }) {
            cited += 1;
            assert!(all.iter().any(|known| known.ends_with(word)), "{}: {word}", file.display());
        }
    }
    assert!(cited > 10, "{cited}");
}

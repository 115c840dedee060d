//! What is written about the program: links lead somewhere, numbers hold, and comments cite only what is there.

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

#[test]
fn the_readme_names_every_technique_and_the_number_of_cases() {
    let readme = read("README.md");
    for technique in stencilscope::technique::Technique::ALL {
        assert!(readme.contains(&format!("| `{}` |", technique.name())), "{technique:?}");
    }
    let cases = stencilscope::stress::cases::all().count();
    assert!(readme.contains(&format!("has the {cases} cases")), "{cases}");
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

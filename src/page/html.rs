//! The file: the template with style, script and document inserted, and a policy that lets nothing else run or load.
//!
//! The modules are ES modules in `assets/page/`. A file from disk can't load another, so they become one script in the
//! order of [`modules`]: import lines are left out, and so is `export` before what is exported.

use super::arrays::deflated;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use sha2::{Digest, Sha256};

/// A file of `assets/page/` that is built into the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PageAsset {
    /// Its name in `assets/page/`.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
}

macro_rules! asset {
    ($name:literal) => {
        PageAsset { name: $name, text: include_str!(concat!("../../assets/page/", $name)) }
    };
}

/// The page's HTML, with a `{{place}}` for everything that is inserted.
pub const TEMPLATE: &str = include_str!("../../assets/page/page.html");
/// The page's style sheet.
pub const STYLE: &str = include_str!("../../assets/page/style.css");

/// What answers the page's questions (`module.rs`), as WebAssembly.
const MODULE: &[u8] = include_bytes!("../../assets/page/page.wasm");

/// Returns the page's JavaScript modules, each after those that it imports.
pub fn modules() -> Vec<PageAsset> {
    vec![
        asset!("arrays.js"),
        asset!("numbers.js"),
        asset!("reader.js"),
        asset!("capture.js"),
        asset!("palette.js"),
        asset!("looking.js"),
        asset!("elements.js"),
        asset!("picture.js"),
        asset!("passes.js"),
        asset!("pixel.js"),
        asset!("main.js"),
    ]
}

/// Returns the page with this title and document of JSON, with script and style inserted and allowed by their hashes.
/// The title is escaped, and so is each `<` of the document.
pub fn page(title: &str, document: &str) -> String {
    let script = script();
    filled(TEMPLATE, |place| match place {
        "title" => escaped(title),
        "script" => script.clone(),
        "script-hash" => hash(&script),
        "style" => STYLE.to_owned(),
        "style-hash" => hash(STYLE),
        "module" => module(),
        // `<` begins tags within a script; in a string of JSON it may be written as an escape.
        "document" => document.replace('<', "\\u003c"),
        _ => String::new(),
    })
}

/// Returns what answers the page's questions, as a page contains it: WebAssembly in zlib's form, in base64.
pub fn module() -> String {
    BASE64_STANDARD.encode(deflated(MODULE))
}

/// Returns the page's JavaScript modules joined into one script, in the order of [`modules`], without lines that begin
/// with `import `, without lines of comment and indentation, and without the words `export ` at the start of lines.
pub fn script() -> String {
    let line = |line: &str| line.strip_prefix("export ").unwrap_or(line.trim_start()).to_owned() + "\n";
    let is_kept = |line: &&str| !line.starts_with("import ") && !line.trim_start().starts_with("//");
    let of_module = |module: &PageAsset| module.text.lines().filter(is_kept).map(line).collect::<String>();
    modules().iter().map(of_module).collect()
}

/// Returns a template with each `{{place}}` replaced by `content` of its name; inserted text is not searched for
/// places. Where the end `}}` is missing, all of the rest is the name.
fn filled(template: &str, content: impl Fn(&str) -> String) -> String {
    let mut text = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        let (place, after) = after.split_once("}}").unwrap_or((after, ""));
        text.push_str(before);
        text.push_str(&content(place));
        rest = after;
    }
    text + rest
}

/// Returns a text's hash in the form of a content security policy.
fn hash(text: &str) -> String {
    format!("sha256-{}", BASE64_STANDARD.encode(Sha256::digest(text)))
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn what_is_put_in_is_not_looked_at_again() {
        let text = filled("a {{one}} b {{two}}", |place| format!("{{{{{place}}}}}"));
        assert_eq!(text, "a {{one}} b {{two}}");
    }

    #[test]
    fn no_text_of_a_frame_ends_its_element() {
        let page = page("</title><b>", "{\"scene\":\"</script><img src=x>\"}");
        assert!(page.contains("&lt;/title&gt;") && page.contains("\\u003c/script>"));
        assert!(!page.contains("</title><b>") && !page.contains("</script><img"));
    }

    /// One script has no other file to import from, and its names are those of all modules.
    #[test]
    fn modules_import_what_stands_before_them_and_share_no_name() {
        let (mut before, mut names) = (BTreeSet::new(), BTreeSet::new());
        for module in modules() {
            for line in module.text.lines() {
                if let Some(import) = line.strip_prefix("import ") {
                    let from = import.rsplit('"').nth(1).expect("a file in quotes");
                    assert!(before.contains(from.trim_start_matches("./")), "{}: {line}", module.name);
                    assert!(import.ends_with("\";"), "{}: an import is one line: {line}", module.name);
                    assert!(!import.contains(" as "), "{}: names stay: {line}", module.name);
                }
                let declared = line.strip_prefix("export ").unwrap_or(line);
                let words = ["function ", "async function ", "const ", "let ", "class "];
                let declared = words.iter().find_map(|word| declared.strip_prefix(word)).unwrap_or_default();
                let declared = declared.split(['=', '(']).next().unwrap_or_default();
                for name in declared.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|name| !name.is_empty()) {
                    assert!(names.insert(name), "{}: {name} is declared elsewhere too", module.name);
                }
            }
            before.insert(module.name);
        }
        assert!(!script().lines().any(|line| line.starts_with("import ") || line.starts_with("export ")));
    }

    #[test]
    fn the_script_is_small_and_ends_no_element() {
        let lines: usize = modules().iter().map(|module| module.text.lines().count()).sum();
        assert!(lines <= 1000, "{lines} lines");
        assert!(!script().contains("</script") && !STYLE.contains("</style"));
    }
}

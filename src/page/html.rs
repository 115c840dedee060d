//! The file: the template with style, script and document inserted, and a policy that lets nothing else run or load.
//!
//! The modules are ES modules in `assets/page/`. A file from disk can't load another, so they become one script in the
//! order of [`modules`]: import lines are left out, and so is `export` before what is exported.

use super::arrays::deflated;
use crate::numbers;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::Value;
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

/// Returns the page with this title, document of JSON and HTML of a diagnosis, which may be empty, with script and style
/// inserted and allowed by their hashes. The title is escaped, and so is each `<` of the document.
pub fn page(title: &str, document: &str, diagnosis: &str) -> String {
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
        "diagnosis" => diagnosis.to_owned(),
        _ => String::new(),
    })
}

/// Returns the findings of a diagnosis, given in the form of `diagnose --json`, as HTML: how many pixels are wrong, each wrong
/// region with its causes and what the fix leaves, the advice, and what was found beside wrong pixels, of flags and of
/// meshes. A region's pixel links to `link`, the words of a fragment, escaped for HTML, with that pixel added. What the
/// diagnosis does not have is left out.
pub fn findings(diagnosis: &str, link: &str) -> Result<String, serde_json::Error> {
    let found: Value = serde_json::from_str(diagnosis)?;
    let number = |of: &Value, name: &str| of[name].as_u64().unwrap_or(0);
    let list = |of: &Value, name: &str| of[name].as_array().cloned().unwrap_or_default();
    let error = &found["error"];
    let kinds = [
        ("missing_shadow", "lit that should be dark"),
        ("false_shadow", "dark that should be lit"),
        ("wrong_surface", "of another surface"),
    ];
    let wrong: u64 = kinds.iter().map(|(kind, _)| number(error, kind)).sum();
    let parts = kinds.iter().filter(|(kind, _)| number(error, kind) > 0);
    let parts: Vec<String> =
        parts.map(|(kind, words)| format!("{} {words}", numbers::count(number(error, kind)))).collect();
    let regions = list(&found, "regions");
    let title = match wrong {
        _ if found["no_verdict"].is_string() => "Diagnosis: no verdict".to_owned(),
        0 if regions.is_empty() && found["verdict"] != "wrong" => "Diagnosis: no pixel is wrong".to_owned(),
        // Also where none of them is counted as wrong: too dark, lit twice, acne.
        0 => "Diagnosis: what is wrong, and why".to_owned(),
        wrong => format!("Diagnosis: {} wrong, why", numbers::counted(wrong, "pixel")),
    };
    let compared = numbers::counted(number(error, "compared"), "pixel");
    let detail = if parts.is_empty() { String::new() } else { format!(": {}", parts.join(", ")) };
    let mut html = format!("<details id=\"diagnosis\"><summary>{title}</summary>");
    html += &format!("<p class=\"dim\">Of {compared} that rays were compared with{detail}.</p>");
    html +=
        &found["no_verdict"].as_str().map_or_else(String::new, |why| format!("<p>No verdict: {}</p>", escaped(why)));
    for (index, region) in regions.iter().enumerate() {
        html += &region_html(index + 1, region, &list(region, "causes"), link);
    }
    let rest = &found["rest"];
    if number(rest, "regions") > 0 {
        let regions = numbers::counted(number(rest, "regions"), "smaller region");
        html +=
            &format!("<p class=\"dim\">And {regions}, of {}.</p>", numbers::counted(number(rest, "pixels"), "pixel"));
    }
    if let Some(advice) = found["advice"]["sentence"].as_str() {
        html += &format!("<p><b>What to do:</b> {}</p>", escaped(advice));
    }
    let beside = list(&found, "findings").iter().map(|one| cause_html(one, 0)).collect();
    let pixels = |of: &Value| numbers::counted(number(of, "pixels"), "pixel");
    let flag =
        |of: &Value| format!("<p>{}: {}: {} would change</p>", text(of, "object"), text(of, "cause"), pixels(of));
    let mesh = |of: &Value| {
        let count = numbers::count(number(of, "count"));
        format!("<p>{}: {} ({count}): {}</p>", text(of, "object"), text(of, "cause"), text(of, "effect"))
    };
    html += &titled("Beside wrong pixels", beside);
    html += &titled("By the scene's own wish, so not wrong", list(&found, "flags").iter().map(flag).collect());
    html += &titled("Meshes, whether it shows here or not", list(&found, "mesh_findings").iter().map(mesh).collect());
    Ok(html + "</details>")
}

/// Returns paragraphs under a title, on a card; empty where there are none.
fn titled(title: &str, paragraphs: Vec<String>) -> String {
    match &paragraphs[..] {
        [] => String::new(),
        all => format!("<section class=\"card\"><h2>{title}</h2>{}</section>", all.concat()),
    }
}

/// Returns a text of a JSON object, escaped; empty where there is none.
fn text(of: &Value, name: &str) -> String {
    escaped(of[name].as_str().unwrap_or_default())
}

/// Returns the texts of a list of a JSON object after `before`, escaped; empty where there are none.
fn names(of: &Value, name: &str, before: &str) -> String {
    let names: Vec<&str> = of[name].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    if names.is_empty() { String::new() } else { format!(" {before} {}", escaped(&names.join(", "))) }
}

/// Returns a cause of wrong pixels, or what was found beside them, as HTML, with what the fix leaves of `of_region` pixels.
fn cause_html(cause: &Value, of_region: u64) -> String {
    let with = names(cause, "together_with", "with");
    let mut html =
        format!("<p><b>{}</b>{with} ({}): {}</p>", text(cause, "cause"), text(cause, "proof"), text(cause, "evidence"));
    let left = match cause["pixels_left"].as_u64() {
        None => String::new(),
        Some(0) => "run so, none of these pixels is wrong any more".to_owned(),
        // Of others, too, that were right without it.
        Some(left) if left > of_region => format!("run so, {} are wrong here", numbers::counted(left, "pixel")),
        Some(1) => "run so, 1 pixel is still wrong".to_owned(),
        Some(left) => format!("run so, {} pixels are still wrong", numbers::count(left)),
    };
    if let Some(words) = cause["mend"]["words"].as_str() {
        html += &format!("<p>To fix it: {}; {left}</p>", escaped(words));
    } else if !left.is_empty() {
        html += &format!("<p>Without it: {left}</p>");
    }
    html
}

/// Returns a wrong region of a diagnosis as HTML, with its causes but for those that their fix rules out.
fn region_html(number: usize, region: &Value, causes: &[Value], link: &str) -> String {
    let kind = region["kind"].as_str().unwrap_or("wrong").replace('_', " ");
    let light = region["light"].as_u64().unwrap_or(0) + 1;
    let [x, y] = [0, 1].map(|axis| region["at"][axis].as_u64().unwrap_or(0));
    let pixels = numbers::counted(region["pixels"].as_u64().unwrap_or(0), "pixel");
    let mut html = format!(
        "<section class=\"card\"><h2>{number}. {}{}{}</h2><p>{pixels} under light {light}, such as \
         <a class=\"dim\" href=\"#{link}&amp;light={light}&amp;pixel={x},{y}\">{x}, {y}</a></p>",
        escaped(&kind),
        names(region, "casters", "of"),
        names(region, "receivers", "on"),
    );
    if causes.is_empty() {
        html += "<p>No cause was found.</p>";
    }
    let of_region = region["pixels"].as_u64().unwrap_or(0);
    let likely = causes.iter().filter(|cause| cause["proof"] != "not it");
    html += &likely.map(|cause| cause_html(cause, of_region)).collect::<String>();
    html + "</section>"
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
        let page = page("</title><b>", "{\"scene\":\"</script><img src=x>\"}", "");
        assert!(page.contains("&lt;/title&gt;") && page.contains("\\u003c/script>"));
        assert!(!page.contains("</title><b>") && !page.contains("</script><img"));
    }

    #[test]
    fn findings_name_region_cause_fix_and_proof_and_no_name_is_a_tag() {
        let found = serde_json::json!({
            "error": {"compared": 4000, "missing_shadow": 507, "false_shadow": 0, "wrong_surface": 0},
            "regions": [{"pixels": 507, "kind": "missing_shadow", "light": 0, "at": [147, 310], "casters": ["<b>pot"],
                "receivers": ["floor"], "causes": [
                    {"cause": "open-mesh", "proof": "proven", "evidence": "64 edges", "mend": {"words": "set a = b"}, "pixels_left": 0,
                        "together_with": ["two-sided"]},
                    {"cause": "culling", "proof": "not it", "evidence": "none"}]}],
            "advice": {"sentence": "set a = b"},
            "findings": [{"cause": "acne", "proof": "part", "evidence": "3 texels", "mend": null, "pixels_left": null}],
            "flags": [{"object": "lamp<", "cause": "casts-not", "pixels": 9}],
            "mesh_findings": [{"object": "pot", "cause": "open-mesh", "count": 64, "effect": "it has holes"}],
        });
        let html = findings(&found.to_string(), "step=4&amp;view=error").expect("JSON");
        for words in [
            "Diagnosis: 507 pixels wrong, why",
            "1. missing shadow of &lt;b&gt;pot on floor",
            "href=\"#step=4&amp;view=error&amp;light=1&amp;pixel=147,310\"",
            "<b>open-mesh</b> with two-sided (proven): 64 edges",
            "<b>acne</b> (part): 3 texels",
            "lamp&lt;: casts-not: 9 pixels would change",
            "pot: open-mesh (64): it has holes",
            "To fix it: set a = b; run so, none of these pixels is wrong any more",
            "<b>What to do:</b> set a = b",
        ] {
            assert!(html.contains(words), "{words}: {html}");
        }
        assert!(!html.contains("culling"), "ruled out");
        assert!(findings("no JSON", "").is_err());
    }

    /// A frame may be wrong where no pixel is lit or dark that should not be, and what is not known is not called right.
    #[test]
    fn no_frame_is_called_right_that_has_regions_or_no_verdict() {
        let error = serde_json::json!({"compared": 100, "missing_shadow": 0, "false_shadow": 0, "wrong_surface": 0});
        let region = serde_json::json!({"pixels": 9, "kind": "lit_twice", "light": 0, "at": [1, 2], "causes": []});
        let with_left = serde_json::json!({"pixels": 9, "kind": "too_dark", "light": 0, "at": [1, 2], "causes": [
            {"cause": "acne", "proof": "part", "evidence": "", "mend": {"words": "set a = b"}, "pixels_left": 12}]});
        for (found, words) in [
            (serde_json::json!({"error": error, "regions": [region]}), "No cause was found"),
            (serde_json::json!({"error": error, "regions": [with_left]}), "run so, 12 pixels are wrong here"),
            (serde_json::json!({"error": error, "regions": [], "no_verdict": "too little is known"}), "no verdict"),
            (serde_json::json!({"error": error, "regions": [], "verdict": "wrong"}), "what is wrong, and why"),
        ] {
            let html = findings(&found.to_string(), "step=1").expect("JSON");
            assert!(html.contains(words) && !html.contains("no pixel is wrong"), "{words}: {html}");
        }
        let right = findings(&serde_json::json!({"error": error, "regions": []}).to_string(), "step=1").expect("JSON");
        assert!(right.contains("no pixel is wrong"));
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

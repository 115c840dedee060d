//! `stencilscope help [KEY]`: commands, techniques, settings, scene files, capture folders, JSON, causes.
//!
//! What the program holds as data (names, values, defaults, summaries, meanings) is printed from there. What
//! they teach is text under `assets/help/`, built into the program: whole pages, and two files with a section
//! a technique and a setting.

use super::{CliError, CommandLine, output};
use crate::diagnosis::Cause;
use crate::scene::nearest;
use crate::technique::{SettingSpec, Technique};
use clap::{Args, CommandFactory};

/// Pages by key, with what they explain.
const PAGES: [(&str, &str, &str); 3] = [
    ("scene-file", "every key of a scene file (.toml)", include_str!("../../assets/help/scene-file.md")),
    (
        "capture-folder",
        "every file of a capture folder, and its manifest",
        include_str!("../../assets/help/capture-folder.md"),
    ),
    ("json", "what `--json` writes, command by command", include_str!("../../assets/help/json.md")),
];
/// The page of causes is made from the table of causes.
const CAUSES: (&str, &str) = ("causes", "what `diagnose` may find, by name");
const OF_TECHNIQUES: &str = include_str!("../../assets/help/techniques.md");
const OF_SETTINGS: &str = include_str!("../../assets/help/settings.md");

#[derive(Debug, Args)]
pub struct HelpArguments {
    /// A command, a technique, a setting, `scene-file`, `capture-folder`, `json` or `causes` [default: all of them, by name]
    key: Option<String>,
}

/// Prints what is known of a key; without one, what there is.
///
/// # Errors
/// An unknown key, with the nearest one.
pub fn run(arguments: &HelpArguments) -> Result<(), CliError> {
    match arguments.key.as_deref() {
        None => output::print(&overview()),
        Some(key) => output::print(&page(key).ok_or_else(|| unknown(key))?),
    }
}

fn page(key: &str) -> Option<String> {
    let whole = PAGES.iter().find(|(name, ..)| *name == key).map(|(.., text)| (*text).to_owned());
    let causes = || (key == CAUSES.0).then(causes);
    let technique = || Technique::from_name(key).map(technique);
    whole.or_else(causes).or_else(technique).or_else(|| setting(key)).or_else(|| command(key))
}

fn overview() -> String {
    let pages = PAGES.iter().map(|(name, of, _)| (*name, *of)).chain([CAUSES]);
    let pages: String = pages.map(|(name, of)| format!("  {name:14}  {of}\n")).collect();
    let techniques: String =
        Technique::ALL.iter().map(|of| format!("  {:14}  {}\n", of.name(), of.summary())).collect();
    let commands = CommandLine::command().render_help();
    format!(
        "{commands}\n`stencilscope help KEY` explains a command, or one of these.\n\nPages:\n{pages}\nTechniques:\n{techniques}\n\
         Settings:\n  {}\n",
        settings().join(" ")
    )
}

/// Every setting's key once, in the order of the techniques.
fn settings() -> Vec<&'static str> {
    let mut keys: Vec<&str> = Vec::new();
    for spec in Technique::ALL.iter().flat_map(|technique| technique.settings()) {
        if !keys.contains(&spec.key) {
            keys.push(spec.key);
        }
    }
    keys
}

fn technique(technique: Technique) -> String {
    let name = technique.name();
    let settings = technique.settings().iter();
    let settings: String =
        settings.map(|spec| format!("\n- `{}`: {}. {}", spec.key, spec.meaning, values(spec))).collect();
    format!(
        "# {name}\n\n{}\n\n{}\n\nSettings (`--set KEY=VALUE`; `stencilscope help KEY`):\n{settings}\n",
        technique.summary(),
        section(OF_TECHNIQUES, name).unwrap_or_default(),
    )
}

/// One setting, as each of the techniques has it that know it.
fn setting(key: &str) -> Option<String> {
    let mut specs: Vec<(&SettingSpec, Vec<&str>)> = Vec::new();
    for technique in Technique::ALL {
        for spec in technique.settings().iter().filter(|spec| spec.key == key) {
            match specs.iter_mut().find(|(known, _)| *known == spec) {
                Some((_, techniques)) => techniques.push(technique.name()),
                None => specs.push((spec, vec![technique.name()])),
            }
        }
    }
    let line =
        |(spec, of): &(&SettingSpec, Vec<&str>)| format!("- {}: {}. {}\n", of.join(", "), spec.meaning, values(spec));
    let lines: String = specs.iter().map(line).collect();
    (!specs.is_empty()).then(|| {
        let lesson = section(OF_SETTINGS, key).unwrap_or_default();
        format!("# {key}\n\nA setting (`--set {key}=VALUE`, or `{key}` in a scene file's `[technique.settings]`) of\n\n{lines}\n{lesson}\n")
    })
}

fn values(spec: &SettingSpec) -> String {
    let values = spec.values.to_string();
    let mut letters = values.chars();
    let first = letters.next().map(|letter| letter.to_uppercase().collect::<String>()).unwrap_or_default();
    format!("{first}{}; `{}` unless set.", letters.as_str(), spec.default)
}

fn command(key: &str) -> Option<String> {
    let mut all = CommandLine::command();
    all.build();
    all.find_subcommand_mut(key).map(|command| command.render_help().to_string())
}

fn causes() -> String {
    let lines: String = Cause::ALL.iter().map(|cause| format!("- `{}`: {}\n", cause.name(), cause.meaning())).collect();
    format!("# Causes\n\nWhat `stencilscope diagnose` may find, and what to do.\n\n{lines}")
}

/// The text under a heading `## name`.
fn section(text: &'static str, name: &str) -> Option<&'static str> {
    let (_, after) = text.split_once(&format!("\n## {name}\n"))?;
    Some(after.split("\n## ").next().unwrap_or(after).trim())
}

fn unknown(key: &str) -> CliError {
    let pages = PAGES.iter().map(|(name, ..)| *name).chain([CAUSES.0]);
    let techniques = Technique::ALL.iter().map(|technique| technique.name());
    let known: Vec<&str> = pages.chain(techniques).chain(settings()).chain(super::COMMANDS).collect();
    let hint = match nearest(key, &known) {
        Some(near) => format!("did you mean `{near}`?"),
        None => "`stencilscope help` lists what there is".to_owned(),
    };
    CliError::Usage(format!("nothing is called `{}`: {hint}", key.escape_debug()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_technique_and_setting_has_its_lesson_and_no_lesson_is_of_something_else() {
        let headings =
            |text: &'static str| -> Vec<&str> { text.lines().filter_map(|line| line.strip_prefix("## ")).collect() };
        assert_eq!(headings(OF_TECHNIQUES), Technique::ALL.map(Technique::name));
        let mut taught = headings(OF_SETTINGS);
        let mut keys = settings();
        taught.sort_unstable();
        keys.sort_unstable();
        assert_eq!(taught, keys);
        for (text, name) in
            keys.iter().map(|key| (OF_SETTINGS, *key)).chain(Technique::ALL.map(|of| (OF_TECHNIQUES, of.name())))
        {
            assert!(section(text, name).is_some_and(|lesson| lesson.len() > 40), "{name}");
        }
    }

    #[test]
    fn no_two_things_have_one_key() {
        let pages = PAGES.iter().map(|(name, ..)| *name).chain([CAUSES.0]);
        let all = pages.chain(Technique::ALL.map(Technique::name)).chain(settings()).chain(super::super::COMMANDS);
        let mut keys: Vec<&str> = all.collect();
        let count = keys.len();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), count);
        for key in keys {
            assert!(page(key).is_some_and(|text| text.len() > 100), "{key}");
            assert!(overview().contains(key), "{key}");
        }
    }
}

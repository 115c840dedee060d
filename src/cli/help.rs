//! `stencilscope help [KEY]`: commands, techniques, settings, scene files, capture folders, JSON, causes.
//!
//! What the program has as data is printed from there: names, values, defaults, and the lesson beside each technique's
//! and setting's definition. Whole pages are text under `assets/help/`, built into the program.

use super::help_topics::{MATRICES, TOPICS};
use super::{CliError, CommandLine, output};
use crate::diagnosis::Cause;
use crate::import::SHIPPED;
use crate::scene::builtin;
use crate::scene::nearest;
use crate::technique::{Lesson, SettingSpec, Technique};
use clap::{Args, CommandFactory};

/// The pages that can be asked for: key, what the page explains, and its text.
const PAGES: [(&str, &str, &str); 4] = [
    ("scene-file", "every key of a scene file (.toml)", include_str!("../../assets/help/scene-file.md")),
    (
        "capture-folder",
        "every file of a capture folder, and its manifest",
        include_str!("../../assets/help/capture-folder.md"),
    ),
    ("json", "what `--json` writes, command by command", include_str!("../../assets/help/json.md")),
    (
        "stencil-test",
        "the stencil test: functions, operations, masks; the window's tab Stencil test has it",
        include_str!("../../assets/help/stencil-test.md"),
    ),
];
/// The page of causes is generated from the table of causes.
const CAUSES: (&str, &str) = ("causes", "what `diagnose` may find, by name");
/// Where the keys of scene files are explained.
const SCENE_FILE: &str = PAGES[0].2;
/// Width of the output in columns.
const WIDTH: usize = 100;

#[derive(Debug, Args)]
pub struct HelpArguments {
    /// A command, a technique, a setting, a scene, a key of scene files, a cause, a word such as `umbra`, a matrix (`clip_from_eye`), `scene-file`, `capture-folder`, `json`,
    /// `stencil-test` or `causes` [default: all of them, by name]
    key: Option<String>,
}

/// Runs the command `help`: prints the explanation of a key, or without one the program's help with the list of keys.
/// Fails for an unknown key.
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
    // A setting, a key of scene files and a cause may have the same name.
    let keys = || Some([setting(key), scene_key(key), cause(key)].into_iter().flatten().collect::<Vec<_>>().join("\n"));
    let keys = || keys().filter(|text| !text.is_empty());
    let topic =
        || TOPICS.iter().find(|topic| topic.name == key).map(|topic| format!("# {key}\n\n{}", lesson(&topic.lesson)));
    whole
        .or_else(causes)
        .or_else(topic)
        .or_else(technique)
        .or_else(keys)
        .or_else(|| command(key))
        .or_else(|| scene(key))
        .or_else(|| matrix(key))
}

fn overview() -> String {
    CommandLine::command().render_help().to_string()
}

/// Returns the text below the list of commands: the names of all pages, techniques, settings and scenes.
pub fn everything() -> String {
    let pages = PAGES.iter().map(|(name, of, _)| (*name, *of)).chain([CAUSES]);
    let pages = pages.chain(TOPICS.iter().map(|topic| (topic.name, topic.meaning)));
    let line = |(name, of): (&str, &str)| format!("  {name:16}  {of}\n");
    let pages: String = pages.map(line).collect();
    let techniques: String = Technique::ALL.iter().map(|of| line((of.name(), of.summary()))).collect();
    format!(
        "`stencilscope help KEY` explains a command, a key of scene files, or one of these.\n\nPages:\n{pages}\n\
         Techniques (`-t`):\n{techniques}\nSettings (`--set`):\n{}\n{}",
        settings_of_techniques(),
        scenes()
    )
}

/// Returns the text below the options of a command that takes a scene: the names of scenes, techniques and settings,
/// and how to get help on one.
pub fn names() -> String {
    let techniques = Technique::ALL.map(Technique::name).join(" ");
    format!(
        "{}\nTechniques (`-t`):\n{}\nSettings (`--set`):\n{}\n`stencilscope help KEY` explains a technique, a setting or \
         a scene; `help scene-file` what a file may say.",
        scenes(),
        indented(&techniques),
        settings_of_techniques()
    )
}

fn scenes() -> String {
    let scenes: Vec<&str> = builtin::ALL.iter().map(|builtin| builtin.name).collect();
    let recordings: Vec<&str> = SHIPPED.iter().map(|shipped| shipped.name).collect();
    format!(
        "Scenes:\n{}\nRecorded frames of other programs (`view`, `pixel`, `page`, `diagnose`, `diff`):\n{}",
        indented(&scenes.join(" ")),
        indented(&recordings.join(" "))
    )
}

/// Returns lines with the settings' keys, grouped by the set of techniques that have them, in the order in which the
/// keys first appear.
fn settings_of_techniques() -> String {
    let mut rows: Vec<(Vec<&str>, Vec<&str>)> = Vec::new();
    for key in settings() {
        let has = |of: &&Technique| of.settings().iter().any(|spec| spec.key == key);
        let of: Vec<&str> = Technique::ALL.iter().filter(has).map(|of| of.name()).collect();
        match rows.iter_mut().find(|(techniques, _)| *techniques == of) {
            Some((_, keys)) => keys.push(key),
            None => rows.push((of, vec![key])),
        }
    }
    let row = |(of, keys): &(Vec<&str>, Vec<&str>)| {
        let all = of.len() == Technique::ALL.len();
        let of = if all { "every technique".to_owned() } else { of.join(", ") };
        indented(&format!("{of}: {}", keys.join(" ")))
    };
    rows.iter().map(row).collect()
}

fn indented(text: &str) -> String {
    wrapped(text, WIDTH - 2).lines().map(|line| format!("  {line}\n")).collect()
}

/// Returns the text with its lines broken at spaces, to less than `width` characters each; a longer word stays whole,
/// and so do lines that begin with `|` (rows of a table).
fn wrapped(text: &str, width: usize) -> String {
    let mut lines: Vec<String> = Vec::new();
    for line in text.lines() {
        let mut begun = String::new();
        for word in line.split(' ') {
            let is_full = !line.starts_with('|') && begun.chars().count() + word.chars().count() >= width;
            if is_full && !begun.is_empty() {
                lines.push(std::mem::take(&mut begun));
            }
            if !begun.is_empty() {
                begun.push(' ');
            }
            begun.push_str(word);
        }
        lines.push(begun);
    }
    lines.join("\n")
}

/// Returns every setting's key once, in the order of [`Technique::ALL`] and of each technique's settings.
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
        "# {name}\n\n{}\n\n{}\nSettings (`--set KEY=VALUE`; `stencilscope help KEY`):\n{settings}\n",
        technique.summary(),
        lesson(&technique.description().lesson),
    )
}

/// Returns a lesson's text with its formula and its sources; without a source it says that no publication is known.
fn lesson(lesson: &Lesson) -> String {
    let sources: String = match lesson.sources {
        [] => "- this program; no publication is known\n".to_owned(),
        sources => sources.iter().map(|source| format!("- {source}\n")).collect(),
    };
    let Lesson { text, formula, .. } = lesson;
    format!("{}\n\nFormula:\n\n{}\nSource:\n\n{sources}", wrapped(text, WIDTH), indented(formula))
}

/// Returns the page of a setting: its meaning and values for each technique that has it, and the lesson of the first.
/// `None` where no technique has this key.
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
        let lesson = specs.first().map(|(spec, _)| lesson(&spec.lesson)).unwrap_or_default();
        format!(
            "# {key}\n\nA setting (`--set {key}=VALUE`, or `{key}` in a scene file's `[technique.settings]`) of\n\n\
             {lines}\n{lesson}"
        )
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

/// Returns the page of one cause; `None` where none has this name.
fn cause(key: &str) -> Option<String> {
    let meaning = wrapped(Cause::from_name(key)?.meaning(), WIDTH);
    Some(format!(
        "# {key} (cause)\n\nA cause that `stencilscope diagnose` may find (`help causes` has them all).\n\n{meaning}\n"
    ))
}

/// Returns the page of a matrix, whose name may be written with spaces; `None` where none has this name.
fn matrix(key: &str) -> Option<String> {
    let name = key.replace(' ', "_").to_lowercase();
    let topic = MATRICES.iter().find(|topic| topic.name == name)?;
    let points =
        "It is multiplied with points as columns on its right; where points are rows on its left, it is transposed.";
    Some(format!("# {name} (matrix)\n\n{}\n\n{}", wrapped(points, WIDTH), lesson(&topic.lesson)))
}

fn scene(key: &str) -> Option<String> {
    let builtin = builtin::ALL.iter().find(|builtin| builtin.name == key);
    let builtin = builtin.map(|of| format!("# {key}\n\nA built-in scene (`stencilscope {key}`): {}.\n", of.lesson));
    let shipped = SHIPPED.iter().find(|shipped| shipped.name == key);
    let shipped = shipped.map(|of| {
        format!("# {key}\n\nA recorded frame of another program (`stencilscope view {key}`): {}.\n", of.lesson)
    });
    builtin.or(shipped)
}

/// Returns, for each second-level heading of the page on scene files, the heading and its bullets with their
/// continuation lines. Other text is left out.
fn scene_tables() -> Vec<(&'static str, Vec<String>)> {
    let sections = SCENE_FILE.split("\n## ").skip(1);
    let table = |section: &'static str| {
        let (heading, body) = section.split_once('\n').unwrap_or((section, ""));
        let mut bullets: Vec<String> = Vec::new();
        for line in body.lines() {
            match (line.strip_prefix("- "), bullets.last_mut()) {
                (Some(_), _) => bullets.push(line.to_owned()),
                (None, Some(bullet)) if line.starts_with("  ") => *bullet = format!("{bullet}\n{line}"),
                _ => {}
            }
        }
        (heading, bullets)
    };
    sections.map(table).collect()
}

/// Returns the keys that a bullet explains: the words in backticks before its first colon and space.
fn keys_of(bullet: &str) -> Vec<&str> {
    let head = bullet.split(": ").next().unwrap_or(bullet);
    head.split('`').skip(1).step_by(2).collect()
}

/// Returns the page of a key of scene files: its explanation in each table that has it, and the keys of the table of
/// the same name. `None` where no table explains the key, even if a table has that name.
fn scene_key(key: &str) -> Option<String> {
    let tables = scene_tables();
    let of_table = |(heading, bullets): &(&str, Vec<String>)| {
        let said: String =
            bullets.iter().filter(|bullet| keys_of(bullet).contains(&key)).map(|said| format!("{said}\n")).collect();
        let place = if *heading == "The file" { "At the top".to_owned() } else { format!("In `{heading}`") };
        (!said.is_empty()).then(|| format!("{place}:\n\n{said}\n"))
    };
    let said: String = tables.iter().filter_map(of_table).collect();
    let inner = tables.iter().find(|(heading, _)| *heading == key);
    let inner = inner.map_or_else(String::new, |(_, bullets)| format!("Its keys:\n\n{}\n", bullets.join("\n")));
    (!said.is_empty()).then(|| {
        format!("# {key} (scene file)\n\nA key of scene files (`stencilscope help scene-file`).\n\n{said}{inner}")
    })
}

/// Returns every key that `help` explains by name, keys of scene files, causes and matrices excepted: pages, techniques, settings, commands
/// and scenes.
fn named() -> impl Iterator<Item = &'static str> {
    let topics = TOPICS.iter().map(|topic| topic.name);
    let pages = PAGES.iter().map(|(name, ..)| *name).chain([CAUSES.0]).chain(topics);
    let techniques = Technique::ALL.iter().map(|technique| technique.name());
    let scenes = builtin::ALL.iter().map(|builtin| builtin.name).chain(SHIPPED.iter().map(|shipped| shipped.name));
    pages.chain(techniques).chain(settings()).chain(super::COMMANDS).chain(scenes)
}

fn unknown(key: &str) -> CliError {
    let tables = scene_tables();
    let scene_keys = tables.iter().flat_map(|(_, bullets)| bullets).flat_map(|bullet| keys_of(bullet));
    let mut known: Vec<&str> = named().collect();
    known.extend(scene_keys);
    known.extend(Cause::ALL.map(Cause::name));
    known.extend(MATRICES.iter().map(|topic| topic.name));
    let hint = match nearest(key, &known) {
        Some(near) => format!("did you mean `{near}`?"),
        None => "`stencilscope help` lists what there is".to_owned(),
    };
    CliError::Usage(format!("nothing is called `{}`: {hint}", key.escape_debug()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::technique::SettingValues;

    /// Asserts that a lesson has everything that it must have.
    fn assert_teaches(lesson: &Lesson, whose: &str) {
        assert!(lesson.text.len() > 40 && lesson.formula.len() > 15, "{whose} teaches nothing");
        for source in lesson.sources {
            assert!((1700..=2026).contains(&source.year) && source.title.len() > 5, "{whose}: {source}");
        }
    }

    #[test]
    fn every_lesson_says_each_word_that_can_be_chosen() {
        for technique in Technique::ALL {
            assert_teaches(&technique.description().lesson, technique.name());
            for spec in technique.settings() {
                assert_teaches(&spec.lesson, spec.key);
                let words = match spec.values {
                    SettingValues::OneOf(words)
                    | SettingValues::WordOr { words, .. }
                    | SettingValues::SomeOf(words)
                    | SettingValues::WordOrFrustum(words)
                    | SettingValues::Receivers(words) => words,
                    SettingValues::Integer(..) | SettingValues::Number(..) | SettingValues::DepthRange => &[],
                };
                for word in words {
                    assert!(spec.lesson.text.contains(&format!("`{word}`")), "{}: {word} is not taught", spec.key);
                }
            }
        }
    }

    #[test]
    fn a_key_teaches_one_thing_whichever_technique_has_it() {
        for key in settings() {
            let specs = Technique::ALL.iter().flat_map(|of| of.settings()).filter(|spec| spec.key == key);
            let lessons: Vec<&Lesson> = specs.map(|spec| &spec.lesson).collect();
            assert!(lessons.windows(2).all(|pair| pair[0] == pair[1]), "{key}");
        }
    }

    #[test]
    fn every_topic_and_matrix_teaches() {
        for topic in TOPICS.iter().chain(&MATRICES) {
            assert_teaches(&topic.lesson, topic.name);
            assert!(!topic.lesson.sources.is_empty(), "{} has no source", topic.name);
        }
    }

    #[test]
    fn lines_fit_and_no_word_is_lost() {
        let text = "one two three\n\n| a b | c d e f g h |";
        assert_eq!(wrapped(text, 9), "one two\nthree\n\n| a b | c d e f g h |");
    }

    #[test]
    fn no_two_things_have_one_key() {
        let mut keys: Vec<&str> = named().collect();
        let count = keys.len();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), count);
        for key in keys {
            assert!(page(key).is_some_and(|text| text.len() > 50), "{key}");
            assert!(overview().contains(key), "{key}");
        }
    }
}

//! The command line: one file a command.
//!
//! [`run`] takes the words of the command line, does the work and gives back an exit code or the
//! one error that ended it; `main` turns that into text. Results go to standard output, and
//! nothing else does.

mod animate;
mod bench;
mod bench_dragged;
mod bench_moving;
mod bench_panels;
#[cfg(feature = "inspector")]
mod bench_response;
mod capture;
mod check;
mod completions;
mod diagnose;
mod diff;
mod error;
mod fix;
mod help;
mod help_topics;
mod import;
mod live;
mod merge;
mod options;
mod output;
mod page;
mod pictures;
mod pixel;
mod progress;
mod record;
mod report;
mod report_results;
mod results;
mod scenes;
mod stress;
mod usage;
mod view;

pub use error::CliError;

use crate::import::{SHIPPED, ShippedFrame};
use crate::scene::builtin::{self, Builtin};
use crate::scene::nearest;
use clap::{Parser, Subcommand};
use std::ffi::OsString;
use std::path::Path;

/// Names of the commands that exist.
const COMMANDS: [&str; 17] = [
    "view",
    "capture",
    "animate",
    "page",
    "pixel",
    "diagnose",
    "diff",
    "report",
    "stress",
    "check",
    "scenes",
    "import",
    "record",
    "bench",
    "pictures",
    "completions",
    "help",
];

/// An interactive visual debugger for stencil shadows and shadow maps
#[derive(Debug, Parser)]
#[command(name = "stencilscope", version, disable_help_subcommand = true, subcommand_required = true)]
#[command(after_help = help::everything())]
struct CommandLine {
    #[command(subcommand)]
    command: CliCommand,
}

#[derive(Debug, Subcommand)]
enum CliCommand {
    /// Open the inspector window (the default command)
    #[command(after_help = help::names())]
    View(Box<view::ViewArguments>),
    /// Render without a window and write every pass to a folder
    #[command(after_help = help::names())]
    Capture(Box<capture::CaptureArguments>),
    /// Show a frame pass by pass, or a light going round the scene, as an animated PNG
    #[command(after_help = help::names())]
    Animate(Box<animate::AnimateArguments>),
    /// Put a frame into one HTML file that any browser opens
    #[command(after_help = format!("{}\n{}", page::EXAMPLES, help::names()))]
    Page(Box<page::PageArguments>),
    /// Tell the history of a pixel, fragment by fragment
    #[command(after_help = help::names())]
    Pixel(Box<pixel::PixelArguments>),
    /// Say where shadows are wrong, why, and how to fix it, with the proof
    #[command(after_help = help::names())]
    Diagnose(Box<diagnose::DiagnoseArguments>),
    /// Say where two captures, or two techniques of a scene, first differ
    #[command(after_help = help::names())]
    Diff(Box<diff::DiffArguments>),
    /// Measure how wrong each technique is, and what it costs
    #[command(after_help = help::names())]
    Report(Box<report::ReportArguments>),
    /// Drive every technique until it breaks
    Stress(Box<stress::StressArguments>),
    /// Say whether this machine's adapter draws as it should
    Check(Box<check::CheckArguments>),
    /// List the built-in scenes
    Scenes(scenes::ScenesArguments),
    /// Read a frame of another program out of a RenderDoc capture
    Import(Box<import::ImportArguments>),
    /// Run another program under RenderDoc and take one frame of it
    Record(Box<record::RecordArguments>),
    /// Measure the program's own speed, as ratios
    Bench(Box<bench::BenchArguments>),
    /// Take the README's pictures of the window, without a display
    Pictures(Box<pictures::PicturesArguments>),
    /// Print what a shell reads to complete commands and options
    Completions(completions::CompletionsArguments),
    /// Explain a technique, a setting, the scene file, the capture folder, JSON or a command
    Help(help::HelpArguments),
}

/// Runs the command line `arguments`, the program's name first. A first word that is no command is opened with `view`;
/// one that is no scene and no file either is an error that suggests names.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> Result<(), CliError> {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let word = arguments.get(1).map(|word| word.to_string_lossy().into_owned()).unwrap_or_default();
    if is_nothing(&word) {
        return Err(CliError::Usage(unknown(&word)));
    }
    let arguments = with_command(arguments);
    let spoken = spoken(&arguments);
    let command_line = match CommandLine::try_parse_from(arguments) {
        Ok(command_line) => command_line,
        Err(error) => return usage::answer(&error),
    };
    match command_line.command {
        CliCommand::View(arguments) => view::run(&arguments),
        CliCommand::Capture(arguments) => capture::run(&arguments),
        CliCommand::Page(arguments) => page::run(&arguments),
        CliCommand::Animate(arguments) => animate::run(&arguments),
        CliCommand::Pixel(arguments) => pixel::run(&arguments),
        CliCommand::Diagnose(arguments) => diagnose::run(&arguments),
        CliCommand::Diff(arguments) => diff::run(&arguments),
        CliCommand::Report(arguments) => report::run(&arguments, &spoken),
        CliCommand::Stress(arguments) => stress::run(&arguments, &spoken),
        CliCommand::Check(arguments) => check::run(&arguments),
        CliCommand::Scenes(arguments) => scenes::run(&arguments),
        CliCommand::Import(arguments) => import::run(&arguments),
        CliCommand::Record(arguments) => record::run(&arguments),
        CliCommand::Bench(arguments) => bench::run(&arguments),
        CliCommand::Pictures(arguments) => pictures::run(&arguments),
        CliCommand::Completions(arguments) => completions::run(&arguments),
        CliCommand::Help(arguments) => help::run(&arguments),
    }
}

/// Returns the command line as a shell accepts it: the first argument becomes `stencilscope`, and words with other than
/// plain characters are quoted.
fn spoken(arguments: &[OsString]) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./,:=+".contains(c);
    let quoted = |word: &OsString| {
        let word = word.to_string_lossy();
        let is_bare = !word.is_empty() && word.chars().all(is_plain);
        if is_bare { word.into_owned() } else { format!("'{}'", word.replace('\'', r"'\''")) }
    };
    let words = arguments.iter().skip(1).map(quoted);
    std::iter::once("stencilscope".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

/// Inserts `view` after the program's name where the next word is no command and no `-h`, `--help`, `-V` or
/// `--version`, also where there is no next word. An empty list gets a program name first.
fn with_command(mut arguments: Vec<OsString>) -> Vec<OsString> {
    let is_known = |word: &OsString| {
        let text = word.to_string_lossy();
        let is_about_program = ["-h", "--help", "-V", "--version"].contains(&text.as_ref());
        is_about_program || COMMANDS.contains(&text.as_ref())
    };
    if arguments.is_empty() {
        arguments.push("stencilscope".into());
    }
    if !arguments.get(1).is_some_and(is_known) {
        arguments.insert(1, "view".into());
    }
    arguments
}

/// Returns whether the first word is no command, no scene and no file; a word with an extension counts as a file.
fn is_nothing(word: &str) -> bool {
    let is_scene = Builtin::named(word).is_some() || ShippedFrame::named(word).is_some();
    let is_file = word.contains(['/', '\\', '.']) || Path::new(word).exists();
    !(word.is_empty() || word.starts_with('-') || COMMANDS.contains(&word) || is_scene || is_file)
}

/// Returns the error message about a first word that is no command, scene or file: the nearest name, where one is near,
/// and the names of all commands.
fn unknown(word: &str) -> String {
    let scenes = builtin::ALL.iter().map(|builtin| builtin.name).chain(SHIPPED.iter().map(|shipped| shipped.name));
    let known: Vec<&str> = COMMANDS.into_iter().chain(scenes).collect();
    let near = nearest(word, &known).map_or_else(String::new, |near| format!("did you mean `{near}`? "));
    let commands = COMMANDS.join(", ");
    let word = word.escape_debug();
    format!(
        "no command and no scene is called `{word}`: {near}Commands are {commands}; `stencilscope scenes` lists scenes"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_line_is_quoted_where_a_shell_needs_it() {
        let words = ["/usr/bin/stencilscope", "report", "my scene.toml", "it's", "--size", "64x48", ""];
        let words: Vec<OsString> = words.into_iter().map(OsString::from).collect();
        assert_eq!(spoken(&words), r"stencilscope report 'my scene.toml' 'it'\''s' --size 64x48 ''");
    }
}

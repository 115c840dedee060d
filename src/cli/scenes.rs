//! `stencilscope scenes`: the built-in scenes.

use super::{CliError, output};
use crate::scene::builtin;
use clap::Args;

#[derive(Debug, Args)]
pub struct ScenesArguments {
    /// Machine-readable, to a file or to standard output
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    json: Option<Option<String>>,
}

/// Runs the command `scenes`: prints one line for each scene, name first; with `--json` JSON instead, to the file if
/// one is named.
pub fn run(arguments: &ScenesArguments) -> Result<(), CliError> {
    match &arguments.json {
        None => output::print(&lines()),
        Some(file) => output::deliver(&json(), file.as_deref()),
    }
}

fn lines() -> String {
    let width = builtin::ALL.iter().map(|scene| scene.name.len()).max().unwrap_or(0);
    builtin::ALL.iter().map(|scene| format!("{:width$}  {}\n", scene.name, scene.lesson)).collect()
}

fn json() -> String {
    let entry = |scene: &builtin::Builtin| serde_json::json!({ "name": scene.name, "lesson": scene.lesson });
    let scenes: Vec<serde_json::Value> = builtin::ALL.iter().map(entry).collect();
    format!("{:#}\n", serde_json::json!({ "schema": 1, "scenes": scenes }))
}

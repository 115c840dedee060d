//! `stencilscope completions SHELL`: the script from which a shell completes commands and options.

use super::{CliError, CommandLine, output};
use clap::{Args, CommandFactory};
use clap_complete::Shell;

#[derive(Debug, Args)]
pub struct CompletionsArguments {
    /// The shell that will read the script
    shell: Shell,
}

/// Prints the script for the shell.
pub fn run(arguments: &CompletionsArguments) -> Result<(), CliError> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut CommandLine::command(), "stencilscope", &mut script);
    output::print(&String::from_utf8_lossy(&script))
}

//! Parses the command line, calls the command, prints the error: nothing else.

use std::io::Write;
use std::process::ExitCode;

fn main() -> ExitCode {
    match stencilscope::cli::run(std::env::args_os()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            if let Some(line) = error.line() {
                // Standard error may be closed; the exit code still tells.
                let _ = writeln!(std::io::stderr(), "stencilscope: {line}");
            }
            ExitCode::from(error.exit_code())
        }
    }
}

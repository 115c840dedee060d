//! `stencilscope record`: a frame of an unmodified program, through RenderDoc.

use super::import::{ImportTarget, ReaderOptions, with_bar};
use super::{CliError, output};
use crate::import::{self, RecordingRequest};
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(after_help = "A frame as a capture folder:  stencilscope record -o DIR -- PROGRAM ARGS…\n\
    With no display:              xvfb-run -a stencilscope record -o DIR -- PROGRAM ARGS…\n\n\
    The program is not changed, and ended once it has shown the frame. It must draw with Vulkan, OpenGL or OpenGL ES, and \
    itself: not by a script that starts it. RenderDoc records no compatibility-profile OpenGL: such a program is run again \
    on Mesa's zink, and recorded as Vulkan.")]
pub struct RecordArguments {
    /// Which frame that the program shows
    #[arg(long, value_name = "N", default_value = "10")]
    frame: u32,
    /// Seconds that the program has until then
    #[arg(long, value_name = "S", default_value = "60", value_parser = clap::value_parser!(u64).range(1..=86_400))]
    seconds: u64,
    /// Also keep the RenderDoc capture
    #[arg(long, value_name = "FILE.rdc")]
    keep: Option<PathBuf>,
    #[command(flatten)]
    target: ImportTarget,
    #[command(flatten)]
    reader: ReaderOptions,
    /// The program and its arguments
    #[arg(last = true, required = true, value_name = "PROGRAM")]
    command: Vec<String>,
}

/// Runs the command `record`: runs a program under RenderDoc until it has shown the chosen frame, and prints or stores
/// that frame as `import` does. With `--keep` the RenderDoc capture stays too.
pub fn run(arguments: &RecordArguments) -> Result<(), CliError> {
    arguments.target.check()?;
    arguments.keep.as_ref().map_or(Ok(()), |file| output::check_target(&file.to_string_lossy()))?;
    let recording = RecordingRequest {
        command: arguments.command.clone(),
        frame: arguments.frame,
        seconds: arguments.seconds,
        keep: arguments.keep.clone(),
    };
    let options = arguments.reader.options(&arguments.target);
    let frame = with_bar(|progress| import::record(&recording, &options, progress))?;
    let name =
        Path::new(recording.program()).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into());
    arguments.target.deliver(frame, &name)
}

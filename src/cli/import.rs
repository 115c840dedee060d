//! `stencilscope import`: a frame out of a RenderDoc capture.

use super::{CliError, output, progress};
use crate::capture::disk;
use crate::import::{self, ImportError, Options, RawFrame};
use crate::progress::Progress;
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(after_help = "What a capture holds:    stencilscope import frame.rdc --list\n\
    As a capture folder:     stencilscope import frame.rdc -o DIR\n\n\
    Vulkan, OpenGL core and OpenGL ES. RenderDoc's Python module reads the file (Debian: python3-renderdoc), in a \
    process of its own.")]
pub struct ImportArguments {
    /// A RenderDoc capture
    #[arg(value_name = "FILE.rdc")]
    file: PathBuf,
    #[command(flatten)]
    target: FrameTarget,
    #[command(flatten)]
    reader: ReaderOptions,
}

/// What becomes of the frame.
#[derive(Debug, Args)]
pub struct FrameTarget {
    /// The capture folder to write
    #[arg(short, long, value_name = "DIR", required_unless_present = "list")]
    output: Option<PathBuf>,
    /// Replace a capture folder that is there
    #[arg(long, requires = "output")]
    overwrite: bool,
    /// Print the frame's events and states
    #[arg(long)]
    list: bool,
}

/// How RenderDoc is reached.
#[derive(Debug, Args)]
pub struct ReaderOptions {
    /// The interpreter that has the module `renderdoc`
    #[arg(long, value_name = "PYTHON", default_value = "python3")]
    python: String,
    /// Gibibytes of memory that RenderDoc may take to replay the frame
    #[arg(long, value_name = "GIB", default_value = "8", value_parser = clap::value_parser!(u64).range(1..=1024))]
    memory: u64,
    /// Seconds that RenderDoc may take to replay the frame
    #[arg(long, value_name = "SECONDS", default_value = "600", value_parser = clap::value_parser!(u64).range(1..))]
    replay_seconds: u64,
}

impl ReaderOptions {
    /// As the import takes them.
    pub fn options(&self) -> Options {
        Options { python: self.python.clone(), seconds: self.replay_seconds, most_memory: self.memory << 30 }
    }
}

impl FrameTarget {
    /// Checks, before any work, that the folder can be written.
    ///
    /// # Errors
    /// Something is there that may not be replaced.
    pub fn check(&self) -> Result<(), CliError> {
        Ok(self.output.as_deref().map_or(Ok(()), |folder| disk::check_target(folder, self.overwrite))?)
    }

    /// Prints and writes what was asked for.
    ///
    /// # Errors
    /// It can't be printed or written.
    pub fn deliver(&self, frame: RawFrame) -> Result<(), CliError> {
        if self.list {
            output::print(&import::list(&frame))?;
        }
        self.output.as_deref().map_or(Ok(()), |folder| convert(frame, folder, self.overwrite))
    }
}

/// Writes the frame as a capture folder.
fn convert(_frame: RawFrame, folder: &Path, _overwrite: bool) -> Result<(), CliError> {
    Err(CliError::Usage(format!(
        "{}: frames of other programs can't be written yet; see what the frame holds with --list",
        folder.display()
    )))
}

/// Does `work` while a bar shows how far RenderDoc has come.
pub fn with_bar(work: impl FnOnce(&Progress) -> Result<RawFrame, ImportError>) -> Result<RawFrame, CliError> {
    Ok(progress::with_bar("replay", &Progress::default(), work)?)
}

/// Reads a capture and delivers its frame.
///
/// # Errors
/// It can't be read or replayed; no module `renderdoc`; the folder can't be written.
pub fn run(arguments: &ImportArguments) -> Result<(), CliError> {
    arguments.target.check()?;
    let options = arguments.reader.options();
    let frame = with_bar(|progress| import::import(&arguments.file, &options, progress))?;
    arguments.target.deliver(frame)
}

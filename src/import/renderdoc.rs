//! RenderDoc's captures: its Python module in a process of its own takes a frame out of one, or records one first.

use super::error::ImportError;
use super::process::{self, Limits, Run};
use super::{RawFrame, read};
use crate::files::open_plain;
use crate::progress::Progress;
use std::path::{Path, PathBuf};
use std::time::Duration;

const EXTRACT: &str = include_str!("extract.py");
const LAUNCH: &str = include_str!("launch.py");

/// How RenderDoc's module is reached, and what it may take.
#[derive(Debug, Clone)]
pub struct Options {
    /// The interpreter that has the module `renderdoc`.
    pub python: String,
    /// Seconds until its process is ended.
    pub seconds: u64,
    /// Bytes of memory at which its process is ended.
    pub most_memory: u64,
    /// Is what the targets hold after each draw read, or are states and vertices alone?
    pub pictures: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { python: "python3".to_owned(), seconds: 600, most_memory: 8 << 30, pictures: true }
    }
}

/// What to record.
#[derive(Debug, Clone)]
pub struct Recording {
    /// The program and its arguments.
    pub command: Vec<String>,
    /// Which frame it shows; the first is 0.
    pub frame: u32,
    /// Seconds that it has until then.
    pub seconds: u64,
    /// Where the capture is kept.
    pub keep: Option<PathBuf>,
}

impl Recording {
    /// The program's name.
    pub fn program(&self) -> &str {
        self.command.first().map_or("", String::as_str)
    }
}

/// Reads the frame of a RenderDoc capture.
pub fn import(file: &Path, options: &Options, progress: &Progress) -> Result<RawFrame, ImportError> {
    // RenderDoc has one error for all of these.
    let reason = match std::fs::metadata(file) {
        Ok(found) if found.is_dir() => Some("it is a folder".to_owned()),
        // A pipe would be waited for.
        Ok(_) => open_plain(file).err().map(|error| format!("it {error}")),
        Err(error) => Some(error.to_string()),
    };
    if let Some(reason) = reason {
        return Err(ImportError::NoFile { file: file.to_owned(), reason });
    }
    let limits = Limits { time: Duration::from_secs(options.seconds), memory: options.most_memory };
    let mut arguments = vec![file.as_os_str().to_owned()];
    arguments.extend((!options.pictures).then(|| "states".into()));
    let mut run = Run::start(&options.python, EXTRACT, &arguments, limits)?;
    run.finish(progress).map_err(|ended| process::import_error(ended, file, options))?;
    read(run.folder())
}

/// Runs a program until it has shown a frame, ends it, and reads that frame.
pub fn record(recording: &Recording, options: &Options, progress: &Progress) -> Result<RawFrame, ImportError> {
    // The program has its own time; what RenderDoc needs to start and to write comes on top.
    let time = Duration::from_secs(recording.seconds.saturating_add(process::GRACE));
    let limits = Limits { time, memory: u64::MAX };
    let mut arguments = vec![recording.frame.to_string(), recording.seconds.to_string()];
    arguments.extend(recording.command.iter().cloned());
    let arguments: Vec<_> = arguments.into_iter().map(Into::into).collect();
    let mut run = Run::start(&options.python, LAUNCH, &arguments, limits)?;
    let capture = run.finish(&Progress::default()).map_err(|ended| process::record_error(ended, recording, options))?;
    let capture = PathBuf::from(capture);
    if let Some(keep) = &recording.keep {
        let failed = |source| ImportError::Write { file: keep.clone(), source };
        std::fs::copy(&capture, keep).map_err(failed)?;
    }
    let frame = import(&capture, options, progress)?;
    Ok(RawFrame { program: Some(recording.program().to_owned()), ..frame })
}

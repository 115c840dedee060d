//! RenderDoc's captures: its Python module in a process of its own takes a frame out of one, or records one first.

use super::error::ImportError;
use super::process::{GRACE, ProcessEnd, ProcessLimits, ReaderProcess};
use super::{RawFrame, interpreter, read};
use crate::files::open_plain;
use crate::progress::Progress;
use std::path::{Path, PathBuf};
use std::time::Duration;

const EXTRACT: [[&str; 2]; 2] =
    [["extract.py", include_str!("extract.py")], ["draw_runs.py", include_str!("draw_runs.py")]];
const LAUNCH: [[&str; 2]; 1] = [["launch.py", include_str!("launch.py")]];

/// What is said of a frame that was recorded by way of Mesa's zink: a limit of its origin.
const BY_ZINK: &str = "the program draws with compatibility-profile OpenGL, which RenderDoc can't record: the frame was \
                       recorded as the Vulkan that Mesa's zink makes of it";

/// How RenderDoc's module is run, and its limits.
#[derive(Debug, Clone)]
pub struct RenderDocOptions {
    /// The interpreter that has the module `renderdoc`; `None` for the first that has it of those that are usually there.
    pub python: Option<String>,
    /// Seconds after which its process is ended.
    pub seconds: u64,
    /// Bytes of memory at which its process is ended.
    pub most_memory: u64,
    /// Whether the targets' content after each draw is read, or only states and vertices.
    pub pictures: bool,
}

impl RenderDocOptions {
    /// Returns the interpreter: the given one, or one that has the module.
    fn interpreter(&self, progress: &Progress) -> Result<String, ImportError> {
        self.python.clone().map_or_else(|| interpreter::with_module(progress), Ok)
    }
}

impl Default for RenderDocOptions {
    fn default() -> Self {
        Self { python: None, seconds: 600, most_memory: 8 << 30, pictures: true }
    }
}

/// The inputs of a recording with RenderDoc.
#[derive(Debug, Clone)]
pub struct RecordingRequest {
    /// The program and its arguments.
    pub command: Vec<String>,
    /// Number of the frame to record; the first that the program shows is 0.
    pub frame: u32,
    /// Seconds that the program has until then.
    pub seconds: u64,
    /// Where the capture file is saved; `None` discards it.
    pub keep: Option<PathBuf>,
}

impl RecordingRequest {
    /// Returns the name of the program that is recorded.
    pub fn program(&self) -> &str {
        self.command.first().map_or("", String::as_str)
    }
}

/// Reads the frame of a RenderDoc capture file by running RenderDoc's Python module in a process of its own. The file
/// is checked first: a folder, pipe or missing file is an error.
pub fn import(file: &Path, options: &RenderDocOptions, progress: &Progress) -> Result<RawFrame, ImportError> {
    // RenderDoc has one error for all of these.
    let reason = match std::fs::metadata(file) {
        Ok(found) if found.is_dir() => Some("it is a folder".to_owned()),
        // Opening a pipe would wait.
        Ok(_) => open_plain(file).err().map(|error| format!("it {error}")),
        Err(error) => Some(error.to_string()),
    };
    if let Some(reason) = reason {
        return Err(ImportError::NoFile { file: file.to_owned(), reason });
    }
    let limits = ProcessLimits { time: Duration::from_secs(options.seconds), memory: options.most_memory };
    let mut arguments = vec![file.as_os_str().to_owned()];
    arguments.extend((!options.pictures).then(|| "states".into()));
    let python = options.interpreter(progress)?;
    let mut run = ReaderProcess::start(&python, &EXTRACT, &arguments, limits)?;
    run.finish(progress).map_err(|ended| import_error(ended, file, &python, options))?;
    read(run.folder())
}

/// Runs a program under RenderDoc until it has shown the frame, ends it, copies the capture file where that is asked
/// for, and reads its frame with the program's name.
pub fn record(
    recording: &RecordingRequest,
    options: &RenderDocOptions,
    progress: &Progress,
) -> Result<RawFrame, ImportError> {
    if cfg!(not(target_os = "linux")) {
        return Err(ImportError::RecordsOnLinux);
    }
    // The program has its own time, and once more on zink; what RenderDoc needs to start and to write is added.
    let time = Duration::from_secs(recording.seconds.saturating_mul(2).saturating_add(GRACE));
    let limits = ProcessLimits { time, memory: u64::MAX };
    let mut arguments = vec![recording.frame.to_string(), recording.seconds.to_string()];
    arguments.extend(recording.command.iter().cloned());
    let arguments: Vec<_> = arguments.into_iter().map(Into::into).collect();
    let python = options.interpreter(progress)?;
    let mut run = ReaderProcess::start(&python, &LAUNCH, &arguments, limits)?;
    let capture = run.finish(&Progress::default()).map_err(|ended| record_error(ended, recording, &python, options))?;
    let (way, capture) = capture.split_once(' ').unwrap_or((&capture, ""));
    let capture = PathBuf::from(capture);
    if let Some(keep) = &recording.keep {
        let failed = |source| ImportError::Write { file: keep.clone(), source };
        std::fs::copy(&capture, keep).map_err(failed)?;
    }
    let mut frame = import(&capture, &RenderDocOptions { python: Some(python), ..options.clone() }, progress)?;
    frame.limits.extend((way == "zink").then(|| BY_ZINK.to_owned()));
    Ok(RawFrame { program: Some(recording.program().to_owned()), ..frame })
}

/// Returns the error that explains why the process that imported `file` gave no result: by the kind that the script
/// reported, else by how it ended.
fn import_error(ended: ProcessEnd, file: &Path, python: &str, options: &RenderDocOptions) -> ImportError {
    let file = file.to_owned();
    let Some([kind, words]) = said(&ended) else { return common_error(ended, python, options) };
    let reason = words.to_owned();
    match kind {
        "missing" => ImportError::NoFile { file, reason },
        "corrupt" => ImportError::Corrupt { file, reason },
        "newer" => ImportError::Version { file, reason },
        "replay" => ImportError::Replay { file, reason, fix: replay_fix() },
        "api" => ImportError::Api { file, api: reason },
        "large" => ImportError::TooLarge { what: format!("more than {words} GiB") },
        _ => common_error(ended, python, options),
    }
}

/// Returns the error that explains why the process that recorded a program gave no result: by the kind that the script
/// reported, else by how it ended.
fn record_error(
    ended: ProcessEnd,
    recording: &RecordingRequest,
    python: &str,
    options: &RenderDocOptions,
) -> ImportError {
    let Some([kind, words]) = said(&ended) else {
        return match ended {
            // The script has a timeout of its own, and did not get to check it.
            ProcessEnd::TooLong => never(recording, "RenderDoc does not answer"),
            _ => common_error(ended, python, options),
        };
    };
    let program = recording.program().to_owned();
    match kind {
        "program" => ImportError::NoProgram { program, reason: words.to_owned() },
        "died" => {
            let and_said = and_said(&ended);
            let how = if words.is_empty() { String::new() } else { format!(" {words}") };
            ImportError::Died { program, how, frame: recording.frame, and_said, fix: died_fix() }
        }
        "never" => never(recording, words),
        "unsupported" => {
            let (api, reason) = words.split_once(' ').unwrap_or((words, ""));
            ImportError::Unsupported { program, api: api.to_owned(), reason: reason.to_owned() }
        }
        "zink" | "no-zink" => {
            let (how, reason) = words.split_once(": ").unwrap_or((words, "it says no more"));
            let fix = if kind == "zink" { ZINK_FIX } else { NO_ZINK_FIX };
            let and_said = and_said(&ended);
            ImportError::NotByZink { program, reason: reason.to_owned(), how: how.to_owned(), and_said, fix }
        }
        _ => common_error(ended, python, options),
    }
}

fn said(ended: &ProcessEnd) -> Option<[&str; 2]> {
    match ended {
        ProcessEnd::Said { kind, words, .. } => Some([kind, words]),
        _ => None,
    }
}

/// Returns `: ` and the last line on standard error, empty where there was none or the script has not reported.
fn and_said(ended: &ProcessEnd) -> String {
    match ended {
        ProcessEnd::Said { last, .. } if !last.is_empty() => format!(": {last}"),
        _ => String::new(),
    }
}

fn never(recording: &RecordingRequest, seen: &str) -> ImportError {
    ImportError::NeverPresented {
        program: recording.program().to_owned(),
        frame: recording.frame,
        seconds: recording.seconds,
        seen: seen.to_owned(),
        fix: match has_display() {
            true => {
                "ask for an earlier --frame or more --seconds, and name the program itself, not a script that starts it"
            }
            false => NO_DISPLAY,
        },
    }
}

fn common_error(ended: ProcessEnd, python: &str, options: &RenderDocOptions) -> ImportError {
    let gibibytes = options.most_memory >> 30;
    match ended {
        ProcessEnd::TooLong => ImportError::TooLong { seconds: options.seconds },
        ProcessEnd::TooMuchMemory => ImportError::TooMuchMemory { gibibytes },
        ProcessEnd::Cancelled => ImportError::Cancelled,
        ProcessEnd::Said { kind, .. } if kind == "memory" => ImportError::TooMuchMemory { gibibytes },
        ProcessEnd::Said { kind, .. } if kind == "module" => ImportError::NoModule { python: python.to_owned() },
        ProcessEnd::Said { kind, words, .. } if kind == "disk" => {
            ImportError::Write { file: std::env::temp_dir(), source: std::io::Error::other(words) }
        }
        ProcessEnd::Said { words, .. } => ImportError::Script { last: words },
        ProcessEnd::Silent { last, signal: Some(signal) } => {
            let and_said = if last.is_empty() { String::new() } else { format!(": {last}") };
            ImportError::Crashed { signal, and_said }
        }
        ProcessEnd::Silent { last, .. } if last.is_empty() => ImportError::Script { last: "without a word".to_owned() },
        ProcessEnd::Silent { last, .. } => ImportError::Script { last },
    }
}

const ZINK_FIX: &str = "have it use Vulkan or OpenGL core, or ask for an earlier --frame or more --seconds";
const NO_ZINK_FIX: &str = "zink needs Mesa 21 or newer and a Vulkan driver (Debian: libgl1-mesa-dri and \
                           mesa-vulkan-drivers); or have it use Vulkan or OpenGL core";
const NO_DISPLAY: &str = "there is no display here: run stencilscope under `xvfb-run -a`";

fn has_display() -> bool {
    ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))
}

fn replay_fix() -> &'static str {
    if has_display() { "replay it on the machine that recorded it, or install mesa-vulkan-drivers" } else { NO_DISPLAY }
}

fn died_fix() -> &'static str {
    if has_display() { "run it by itself first, or ask for an earlier --frame" } else { NO_DISPLAY }
}

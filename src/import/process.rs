//! A script of ours in an interpreter, in a process of its own, with limits.
//!
//! Script and results are in a temporary folder. The script reports in lines on its standard output (`progress DONE
//! OF`, `error KIND WORDS`, `done WORDS`); of its standard error only the last line is stored. The process leads a
//! group, so that it ends with all that it has started; should we be killed, the script sees its standard input end,
//! removes the folder and ends its group itself.

use super::error::ImportError;
use crate::progress::Progress;
use std::ffi::OsString;
use std::io::{ErrorKind, Read};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Seconds that RenderDoc has to start a program and to write its capture.
pub const GRACE: u64 = 30;
/// Interval at which a process's limits are checked.
const TURN: Duration = Duration::from_millis(50);
/// Limit on the bytes of an output line that are stored.
const LONGEST_LINE: usize = 2000;

/// Limits on the time and memory of a process.
#[derive(Debug, Clone, Copy)]
pub struct ProcessLimits {
    /// Time from its start to its result.
    pub time: Duration,
    /// Memory in bytes, of the interpreter itself.
    pub memory: u64,
}

/// The reason why a process gave no result.
#[derive(Debug)]
pub enum ProcessEnd {
    TooLong,
    TooMuchMemory,
    Cancelled,
    /// The script has reported the reason: a kind, words, and the last line on standard error.
    Said {
        kind: String,
        words: String,
        last: String,
    },
    /// It has ended without a report, by a signal or by itself; this is its last line.
    Silent {
        last: String,
        signal: Option<i32>,
    },
}

/// A running process; dropping it ends the process and removes its folder.
#[derive(Debug)]
pub struct ReaderProcess {
    child: Child,
    has_ended: bool,
    folder: tempfile::TempDir,
    lines: Receiver<String>,
    last: Arc<Mutex<String>>,
    /// Disconnects when standard error ends.
    errors: Receiver<()>,
    start: Instant,
    limits: ProcessLimits,
}

impl ReaderProcess {
    /// Starts `python SCRIPT FOLDER ARGUMENTS…`, where SCRIPT is the first of `scripts` (names and texts, of which the others
    /// are modules for it) in a new temporary FOLDER, which is removed with the process. Returns at once; the limits
    /// apply in [`ReaderProcess::finish`].
    pub fn start(
        python: &str,
        scripts: &[[&str; 2]],
        arguments: &[OsString],
        limits: ProcessLimits,
    ) -> Result<Self, ImportError> {
        let temporary = |source| ImportError::Write { file: std::env::temp_dir(), source };
        let folder = tempfile::TempDir::with_prefix("stencilscope-").map_err(temporary)?;
        for [name, text] in scripts {
            std::fs::write(folder.path().join(name), text).map_err(temporary)?;
        }
        let mut command = Command::new(python);
        command.args(scripts.first().map(|[name, _]| folder.path().join(name)));
        command.arg(folder.path()).args(arguments);
        // It finds its modules beside it, whatever the environment says.
        command.env_remove("PYTHONSAFEPATH");
        // `main` may have set this for our process alone.
        if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
            command.env_remove("NODEVICE_SELECT");
        }
        // RenderDoc's log is removed with the folder.
        command.env("RENDERDOC_TEMP", folder.path());
        if cfg!(windows) {
            // There, paths would come in the system's own encoding.
            command.env("PYTHONUTF8", "1");
        }
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let no_interpreter = |source| ImportError::NoInterpreter { python: python.to_owned(), source };
        let mut child = command.spawn().map_err(no_interpreter)?;
        let (send, lines) = sync_channel(64);
        if let Some(output) = child.stdout.take() {
            // An error means that the receiver is gone: the process is about to end.
            std::thread::spawn(move || each_line(output, |line| send.send(line).is_ok()));
        }
        let last = Arc::new(Mutex::new(String::new()));
        let (open, closed) = sync_channel::<()>(0);
        if let (Some(errors), last) = (child.stderr.take(), Arc::clone(&last)) {
            std::thread::spawn(move || {
                each_line(errors, |line| keep(&last, line));
                drop(open);
            });
        }
        Ok(Self { child, has_ended: false, folder, lines, last, errors: closed, start: Instant::now(), limits })
    }

    /// Returns the folder that the script writes to.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Waits for the script's result and shows its progress; ends the process, and all that it started, in any case.
    ///
    /// # Errors
    /// Why there is none.
    pub fn finish(&mut self, progress: &Progress) -> Result<String, ProcessEnd> {
        let result = self.wait(progress);
        let signal = self.end();
        match result {
            Err(ProcessEnd::Silent { last, .. }) => Err(ProcessEnd::Silent { last, signal }),
            result => result,
        }
    }

    fn wait(&self, progress: &Progress) -> Result<String, ProcessEnd> {
        let mut shown = [0; 2];
        loop {
            match self.lines.recv_timeout(TURN) {
                Ok(line) => match line.split_once(' ').unwrap_or((&line, "")) {
                    ("done", words) => return Ok(words.to_owned()),
                    ("error", words) => {
                        let (kind, words) = words.split_once(' ').unwrap_or((words, ""));
                        return Err(ProcessEnd::Said {
                            kind: kind.to_owned(),
                            words: words.to_owned(),
                            last: self.last(),
                        });
                    }
                    ("progress", numbers) => show(numbers, &mut shown, progress),
                    _ => {}
                },
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(ProcessEnd::Silent { last: self.last(), signal: None });
                }
            }
            if progress.is_cancelled() {
                return Err(ProcessEnd::Cancelled);
            } else if self.start.elapsed() > self.limits.time {
                return Err(ProcessEnd::TooLong);
            } else if memory(self.child.id()).is_some_and(|bytes| bytes > self.limits.memory) {
                return Err(ProcessEnd::TooMuchMemory);
            }
        }
    }

    /// Returns the last line on standard error, after waiting for its end, but at most two seconds; empty where there
    /// was none.
    fn last(&self) -> String {
        const PATIENCE: Duration = Duration::from_secs(2);
        // Nothing is sent: this waits for the disconnection or the timeout.
        let _ = self.errors.recv_timeout(PATIENCE);
        self.last.lock().map(|last| last.clone()).unwrap_or_default()
    }

    /// Kills the process with all that it has started, and returns the signal that ended it, which is ours where
    /// nothing else had. `None` where it exited by itself, or this was called before.
    fn end(&mut self) -> Option<i32> {
        // Once the child is waited for, its number may be that of another process.
        if std::mem::replace(&mut self.has_ended, true) {
            return None;
        }
        // A process that has already ended gives an error that means nothing.
        #[cfg(unix)]
        let _ = rustix::process::kill_process_group(
            rustix::process::Pid::from_child(&self.child),
            rustix::process::Signal::KILL,
        );
        let _ = self.child.kill();
        self.child.wait().ok().and_then(signal_of)
    }
}

/// Returns the signal that ended a process; `None` where it exited by itself.
#[cfg(unix)]
fn signal_of(status: ExitStatus) -> Option<i32> {
    std::os::unix::process::ExitStatusExt::signal(&status)
}

/// Returns `None`: only Unix ends processes by signals.
#[cfg(not(unix))]
fn signal_of(_: ExitStatus) -> Option<i32> {
    None
}

impl Drop for ReaderProcess {
    fn drop(&mut self) {
        self.end();
    }
}

/// Calls `take` with each line without its newline, cut where it is too long, until it returns false or the input ends.
/// A last line without a newline counts; bytes that are no UTF-8 are replaced.
fn each_line(mut input: impl Read, mut take: impl FnMut(String) -> bool) {
    let (mut buffer, mut line) = ([0; 4096], Vec::new());
    loop {
        let read = match input.read(&mut buffer) {
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Ok(0) | Err(_) => break,
            Ok(read) => read,
        };
        for &byte in &buffer[..read] {
            if byte != b'\n' && line.len() < LONGEST_LINE {
                line.push(byte);
            } else if byte == b'\n' && !take(without_return(std::mem::take(&mut line))) {
                return;
            }
        }
    }
    if !line.is_empty() {
        take(without_return(line));
    }
}

/// Returns a line as text, without the carriage return that ends one on Windows.
fn without_return(line: Vec<u8>) -> String {
    let text = String::from_utf8_lossy(&line);
    text.strip_suffix('\r').unwrap_or(&text).to_owned()
}

fn keep(last: &Mutex<String>, line: String) -> bool {
    /// The most characters of it that an error shows.
    const SHOWN: usize = 200;
    let line: String = line.trim().chars().filter(|c| !c.is_control()).take(SHOWN).collect();
    if let Ok(mut last) = last.lock()
        && !line.is_empty()
    {
        *last = line;
    }
    true
}

/// Shows progress from a line `DONE ALL`: starts anew where ALL is not the one before, then advances to DONE. `[shown,
/// of]` stores what is shown; a line of another form is ignored.
fn show(numbers: &str, [shown, of]: &mut [usize; 2], progress: &Progress) {
    let mut numbers = numbers.split(' ').map(str::parse::<usize>);
    let (Some(Ok(done)), Some(Ok(all))) = (numbers.next(), numbers.next()) else { return };
    if all != *of {
        (*shown, *of) = (0, all);
        progress.start(all);
    }
    while *shown < done.min(all) {
        *shown += 1;
        progress.advance();
    }
}

/// Returns the bytes that a process has in memory, as Linux reports them; `None` on other systems, or where it has
/// ended.
fn memory(process: u32) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}

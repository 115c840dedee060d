//! Which frame is recorded, and what becomes of it.

use super::RecordError;
use super::replay::Replay;
use crate::capture::disk::{self, Contents};
use crate::import::{Converted, convert};
use crate::progress::Progress;
use crate::session::Session;
use crate::wrap::command::Finished;
use crate::wrap::{Record, Shared};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A frame that was asked for: where to, and how many frames come before it.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Wish {
    folder: PathBuf,
    frames_before: u32,
}

impl Wish {
    /// Of `DIR` or `DIR:N`.
    fn of(text: &str) -> Wish {
        let counted = text.rsplit_once(':').and_then(|(folder, number)| Some((folder, number.parse().ok()?)));
        let (folder, frames_before) = counted.unwrap_or((text, 0));
        Wish { folder: folder.into(), frames_before }
    }
}

/// The wish of the environment, which the first device takes.
fn of_environment() -> Option<Wish> {
    static TAKEN: AtomicBool = AtomicBool::new(false);
    let text = std::env::var(super::VARIABLE).ok().filter(|text| !text.is_empty())?;
    (!TAKEN.swap(true, Ordering::Relaxed)).then(|| Wish::of(&text))
}

/// What was recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Recorded {
    /// The frame in our words: plan, pictures, scene and lights as far as they were found.
    pub frame: Converted,
    /// Where it was written.
    pub folder: PathBuf,
}

/// The recording of a device.
#[derive(Debug)]
pub struct Recorder {
    is_recording: AtomicBool,
    /// An encoder was made since the last frame ended.
    has_begun: AtomicBool,
    wish: Mutex<Option<Wish>>,
    running: Mutex<Option<Running>>,
}

#[derive(Debug)]
struct Running {
    folder: PathBuf,
    replay: Replay,
    /// A closure ends it, not the frame's end.
    is_closure: bool,
}

impl Recorder {
    pub fn new() -> Recorder {
        Recorder {
            is_recording: AtomicBool::new(false),
            has_begun: AtomicBool::new(false),
            wish: Mutex::new(of_environment()),
            running: Mutex::new(None),
        }
    }

    /// Wishes for the next frame that begins.
    pub fn wish(&self, folder: PathBuf) {
        *self.wishes() = Some(Wish { folder, frames_before: 0 });
    }

    fn wishes(&self) -> MutexGuard<'_, Option<Wish>> {
        self.wish.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn running(&self) -> MutexGuard<'_, Option<Running>> {
        self.running.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A frame begins: is it the one?
    fn begin_if_wished(&self) {
        let mut wish = self.wishes();
        match wish.take() {
            Some(Wish { frames_before: 0, folder }) => self.start(folder, false),
            Some(Wish { frames_before, folder }) => {
                *wish = Some(Wish { frames_before: frames_before - 1, folder });
            }
            None => {}
        }
    }

    fn start(&self, folder: PathBuf, is_closure: bool) {
        *self.running() = Some(Running { folder, replay: Replay::default(), is_closure });
        self.is_recording.store(true, Ordering::Release);
    }

    /// Begins, until [`Recorder::end`].
    ///
    /// # Errors
    /// A frame is being recorded; the folder can't be written.
    pub fn begin(&self, folder: PathBuf) -> Result<(), RecordError> {
        if self.is_recording.load(Ordering::Acquire) {
            return Err(RecordError::Busy);
        }
        disk::check_target(&folder, false)?;
        self.start(folder, true);
        Ok(())
    }

    fn frame_ends(&self, shared: &Shared) {
        let is_waited_for = self.running().as_ref().is_some_and(|running| running.is_closure);
        if is_waited_for {
            return;
        }
        // A submission that draws nothing, such as an upload, is no frame.
        let has_drawn = self.running().as_ref().is_none_or(|running| running.replay.has_drawn());
        if self.is_recording.load(Ordering::Acquire) && has_drawn {
            match self.end(shared) {
                Ok(Recorded { folder, .. }) => eprintln!("stencilscope: recorded a frame to {}", folder.display()),
                Err(error) => eprintln!("stencilscope: no frame is recorded: {error}"),
            }
        }
        if !self.is_recording.load(Ordering::Acquire) {
            self.has_begun.store(false, Ordering::Release);
        }
    }

    /// Writes what was recorded.
    ///
    /// # Errors
    /// Nothing that can be followed was drawn; the folder can't be written.
    pub fn end(&self, shared: &Shared) -> Result<Recorded, RecordError> {
        self.is_recording.store(false, Ordering::Release);
        self.has_begun.store(false, Ordering::Release);
        let Some(Running { folder, replay, .. }) = self.running().take() else { return Err(RecordError::Busy) };
        let frame = replay.frame(&shared.adapter.get_info());
        let name = folder.file_name().map_or_else(|| "frame".into(), |name| name.to_string_lossy().into_owned());
        let mut converted = convert(&frame, &name)?;
        drop(frame);
        let mut session = Session::new(Some(&shared.adapter.get_info().name))?;
        let Converted { plan, capture, .. } = &converted;
        converted.capture = session.held_against_itself(plan, capture, &Progress::default())?;
        write(&converted, &folder)?;
        Ok(Recorded { frame: converted, folder })
    }
}

impl Record for Recorder {
    fn is_recording(&self) -> bool {
        // An encoder asks: the first since the last frame begins the next.
        if !self.has_begun.swap(true, Ordering::AcqRel) {
            self.begin_if_wished();
        }
        self.is_recording.load(Ordering::Acquire)
    }

    fn submit(&self, shared: &Shared, buffers: Vec<Finished>) -> wgpu::SubmissionIndex {
        let index = match self.running().as_mut() {
            Some(Running { replay, .. }) => replay.submit(&shared.device, &shared.queue, buffers),
            None => shared.queue.submit(buffers.into_iter().map(|finished| finished.inner)),
        };
        if !shared.frames.end_where_shown() {
            self.frame_ends(shared);
        }
        index
    }

    fn presented(&self, shared: &Shared) {
        self.frame_ends(shared);
    }
}

fn write(frame: &Converted, folder: &Path) -> Result<(), RecordError> {
    let Converted { plan, capture, scene, .. } = frame;
    disk::write(Contents { capture, plan: Some(plan), scene: scene.as_ref() }, folder, false)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wish_names_a_folder_and_maybe_a_frame() {
        let wish = |folder: &str, frames_before| Wish { folder: folder.into(), frames_before };
        assert_eq!(Wish::of("out"), wish("out", 0));
        assert_eq!(Wish::of("out:12"), wish("out", 12));
        // A drive, or a folder with a colon in its name.
        assert_eq!(Wish::of("C:/out"), wish("C:/out", 0));
        assert_eq!(Wish::of("a:b:3"), wish("a:b", 3));
    }
}

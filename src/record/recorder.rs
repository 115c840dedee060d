//! Which frame is recorded, and what becomes of it.

use super::RecordError;
use super::probe::Probes;
use super::replay::Replay;
use crate::capture::disk::{self, Contents};
use crate::import::{Converted, convert};
use crate::progress::Progress;
use crate::session::Session;
use crate::wrap::command::Finished;
use crate::wrap::{Record, Shared};
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Frames that were asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Wish {
    folder: PathBuf,
    /// Of those that begin from now on, counted from 0.
    frames: Range<u32>,
    /// Each has a folder of its own within, named by its number.
    is_series: bool,
    /// How many have begun.
    begun: u32,
}

impl Wish {
    fn one(folder: PathBuf, number: u32) -> Wish {
        Wish { folder, frames: number..number.saturating_add(1), is_series: false, begun: 0 }
    }

    fn series(folder: PathBuf, frames: Range<u32>) -> Wish {
        Wish { folder, frames, is_series: true, begun: 0 }
    }

    /// Of `DIR`, `DIR:N` or `DIR:A..B`.
    fn of(text: &str) -> Wish {
        let parted = text.rsplit_once(':');
        let one = || {
            let (folder, number) = parted?;
            Some(Wish::one(folder.into(), number.parse().ok()?))
        };
        let series = || {
            let (folder, frames) = parted?;
            let (from, to) = frames.split_once("..")?;
            Some(Wish::series(folder.into(), from.parse().ok()?..to.parse().ok()?))
        };
        one().or_else(series).unwrap_or_else(|| Wish::one(text.into(), 0))
    }

    /// A frame begins: where it is recorded to, if it is.
    fn next(&mut self) -> Option<PathBuf> {
        let number = self.begun;
        self.begun = number.saturating_add(1);
        let to = || if self.is_series { self.folder.join(format!("frame-{number:04}")) } else { self.folder.clone() };
        self.frames.contains(&number).then(to)
    }

    fn is_over(&self) -> bool {
        self.begun >= self.frames.end
    }
}

/// The wish of the environment, which the first device takes.
fn of_environment() -> Option<Wish> {
    static TAKEN: AtomicBool = AtomicBool::new(false);
    let text = std::env::var(super::VARIABLE).ok().filter(|text| !text.is_empty())?;
    (!TAKEN.swap(true, Ordering::Relaxed)).then(|| Wish::of(&text))
}

/// What recording a frame took.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cost {
    /// Draws that were done one by one.
    pub draws: usize,
    /// Time that the program would not have spent otherwise: doing each submission in parts, computing the frame anew,
    /// writing.
    pub time: Duration,
    /// Bytes of the folder.
    pub bytes: u64,
}

impl fmt::Display for Cost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Cost { draws, time, bytes } = self;
        write!(f, "{draws} draws, {:.2} s, {:.1} MB", time.as_secs_f64(), *bytes as f64 / 1e6)
    }
}

/// What was recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Recorded {
    /// The frame in our words: plan, pictures, scene and lights as far as they were found.
    pub frame: Converted,
    /// Where it was written.
    pub folder: PathBuf,
    /// What that took.
    pub cost: Cost,
}

/// A frame of a series.
#[derive(Debug)]
pub struct OfSeries {
    /// Where it was to be written.
    pub folder: PathBuf,
    /// What it took, or why it was not written.
    pub outcome: Result<Cost, RecordError>,
}

/// The recording of a device.
#[derive(Debug)]
pub struct Recorder {
    is_recording: AtomicBool,
    /// An encoder was made since the last frame ended.
    has_begun: AtomicBool,
    wish: Mutex<Option<Wish>>,
    running: Mutex<Option<Running>>,
    series: Mutex<Series>,
}

#[derive(Debug)]
struct Running {
    folder: PathBuf,
    replay: Replay,
    time: Duration,
    end: End,
}

/// What ends a recorded frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    /// A closure that is done.
    Closure,
    /// The program, by showing it or, without a surface, by submitting it.
    Frame { is_of_series: bool },
}

/// What lasts from frame to frame of a series.
#[derive(Debug, Default)]
struct Series {
    recorded: Vec<OfSeries>,
    tools: Tools,
}

/// What recording a frame needs, and takes time to make.
#[derive(Debug, Default)]
struct Tools {
    probes: Probes,
    session: Option<Session>,
}

fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Recorder {
    pub fn new() -> Recorder {
        Recorder {
            is_recording: AtomicBool::new(false),
            has_begun: AtomicBool::new(false),
            wish: Mutex::new(of_environment()),
            running: Mutex::default(),
            series: Mutex::default(),
        }
    }

    /// Wishes for the next frame that begins.
    pub fn wish(&self, folder: PathBuf) {
        *lock(&self.wish) = Some(Wish::one(folder, 0));
    }

    /// Wishes for each frame that begins from now on.
    ///
    /// # Errors
    /// A series is wished for already.
    pub fn start_series(&self, folder: PathBuf) -> Result<(), RecordError> {
        let mut wish = lock(&self.wish);
        if wish.as_ref().is_some_and(|wish| wish.is_series) {
            return Err(RecordError::Busy);
        }
        *wish = Some(Wish::series(folder, 0..u32::MAX));
        *lock(&self.series) = Series::default();
        Ok(())
    }

    /// No further frame is wished for; those of the series that are written.
    pub fn stop_series(&self) -> Vec<OfSeries> {
        lock(&self.wish).take_if(|wish| wish.is_series);
        std::mem::take(&mut *lock(&self.series)).recorded
    }

    /// A frame begins: is it recorded?
    fn begin_if_wished(&self) {
        let mut wish = lock(&self.wish);
        let Some(wished) = wish.as_mut() else { return };
        let (folder, is_of_series) = (wished.next(), wished.is_series);
        wish.take_if(|wish| wish.is_over());
        drop(wish);
        if let Some(folder) = folder {
            self.start(folder, End::Frame { is_of_series });
        }
    }

    fn start(&self, folder: PathBuf, end: End) {
        let is_of_series = end == End::Frame { is_of_series: true };
        let probes = is_of_series.then(|| std::mem::take(&mut lock(&self.series).tools.probes)).unwrap_or_default();
        *lock(&self.running) = Some(Running { folder, replay: Replay::with(probes), time: Duration::ZERO, end });
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
        self.start(folder, End::Closure);
        Ok(())
    }

    /// A frame ends that is recorded, or one that is not and has drawn.
    fn frame_ends(&self, shared: &Shared) {
        let is_running = |running: &Running| running.end != End::Closure && running.replay.has_drawn();
        // A submission that draws nothing, such as an upload, is no frame.
        let running = match &mut *lock(&self.running) {
            None => None,
            Some(running) if !is_running(running) => return,
            running => running.take(),
        };
        self.is_recording.store(false, Ordering::Release);
        self.has_begun.store(false, Ordering::Release);
        let Some(running) = running else { return };
        let (folder, is_of_series) = (running.folder.clone(), running.end == End::Frame { is_of_series: true });
        let mut series = lock(&self.series);
        let mut tools = if is_of_series { std::mem::take(&mut series.tools) } else { Tools::default() };
        let outcome = running.write(shared, &mut tools).map(|recorded| recorded.cost);
        match &outcome {
            Ok(cost) => eprintln!("stencilscope: recorded a frame to {}: {cost}", folder.display()),
            Err(error) => eprintln!("stencilscope: no frame is recorded: {error}"),
        }
        if !is_of_series {
            return;
        }
        // What can't be written once can't be written for each frame that follows.
        let is_last = lock(&self.wish).take_if(|_| matches!(outcome, Err(RecordError::Disk(_)))).is_some()
            || lock(&self.wish).is_none();
        series.recorded.push(OfSeries { folder, outcome });
        series.tools = if is_last { Tools::default() } else { tools };
    }

    /// Writes what was recorded.
    ///
    /// # Errors
    /// Nothing that can be followed was drawn; the folder can't be written.
    pub fn end(&self, shared: &Shared) -> Result<Recorded, RecordError> {
        self.is_recording.store(false, Ordering::Release);
        self.has_begun.store(false, Ordering::Release);
        let running = lock(&self.running).take().ok_or(RecordError::Busy)?;
        running.write(shared, &mut Tools::default())
    }
}

impl Running {
    fn write(self, shared: &Shared, tools: &mut Tools) -> Result<Recorded, RecordError> {
        let Running { folder, replay, mut time, .. } = self;
        let begin = Instant::now();
        let adapter = shared.adapter.get_info();
        let draws = replay.draws();
        let (frame, probes) = replay.frame(&adapter);
        tools.probes = probes;
        let name = folder.file_name().map_or_else(|| "frame".into(), |name| name.to_string_lossy().into_owned());
        let mut converted = convert(&frame, &name)?;
        drop(frame);
        if tools.session.is_none() {
            tools.session = Some(Session::new(Some(&adapter.name))?);
        }
        if let Some(session) = &mut tools.session {
            let Converted { plan, capture, .. } = &converted;
            converted.capture = session.held_against_itself(plan, capture, &Progress::default())?;
        }
        write(&converted, &folder)?;
        time += begin.elapsed();
        let bytes = std::fs::read_dir(&folder).into_iter().flatten().flatten();
        let bytes = bytes.filter_map(|file| Some(file.metadata().ok()?.len())).sum();
        Ok(Recorded { frame: converted, folder, cost: Cost { draws, time, bytes } })
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
        let has_passes = buffers.iter().any(|finished| finished.has_passes);
        let index = match lock(&self.running).as_mut() {
            Some(Running { replay, time, .. }) => {
                let begin = Instant::now();
                let index = replay.submit(&shared.device, &shared.queue, buffers);
                *time += begin.elapsed();
                index
            }
            None => shared.queue.submit(buffers.into_iter().map(|finished| finished.inner)),
        };
        if has_passes && !shared.frames.end_where_shown() {
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
    fn a_wish_names_a_folder_and_maybe_frames() {
        let one = |folder: &str, number| Wish::one(folder.into(), number);
        assert_eq!(Wish::of("out"), one("out", 0));
        assert_eq!(Wish::of("out:12"), one("out", 12));
        assert_eq!(Wish::of("out:3..7"), Wish::series("out".into(), 3..7));
        // A drive, or a folder with a colon or points in its name.
        assert_eq!(Wish::of("C:/out"), one("C:/out", 0));
        assert_eq!(Wish::of("a:b:3"), one("a:b", 3));
        assert_eq!(Wish::of("a:../b"), one("a:../b", 0));
    }

    #[test]
    fn frames_are_counted_as_they_begin() {
        let folders = |mut wish: Wish| -> Vec<Option<String>> {
            let named = |folder: PathBuf| folder.to_string_lossy().into_owned();
            std::iter::from_fn(|| (!wish.is_over()).then(|| wish.next().map(named))).collect()
        };
        assert_eq!(folders(Wish::of("out:2")), [None, None, Some("out".to_owned())]);
        let numbered = |number: &str| Some(format!("out/frame-{number}"));
        assert_eq!(folders(Wish::of("out:1..3")), [None, numbered("0001"), numbered("0002")]);
        assert_eq!(folders(Wish::of("out:3..3")), [None, None, None]);
    }
}

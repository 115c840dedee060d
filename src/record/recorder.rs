//! Which frame is recorded, and what becomes of it.

use super::RecordError;
use super::probes::Probes;
use super::replay::Replay;
use crate::capture::disk::{self, Contents};
use crate::import::{Converted, convert};
use crate::progress::Progress;
use crate::session::{Session, SessionError};
use crate::wrap::command::Finished;
use crate::wrap::{Record, Shared};
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::ThreadId;
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

/// The wish of the environment, which the first device takes that encodes something.
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
#[derive(Debug, Default)]
pub struct Recorder {
    is_recording: AtomicBool,
    /// An encoder was made since the last frame ended.
    has_begun: AtomicBool,
    asked: Mutex<Asked>,
    stage: Stage,
}

/// What was asked for, and has not ended. Nothing of wgpu's is called while it is locked.
#[derive(Debug, Default)]
struct Asked {
    wish: Option<Wish>,
    series: Series,
}

/// What lasts from frame to frame of a series.
#[derive(Debug, Default)]
struct Series {
    number: u64,
    recorded: Vec<OfSeries>,
    tools: Tools,
}

/// What recording a frame needs, and takes time to make.
#[derive(Debug, Default)]
struct Tools {
    probes: Probes,
    session: Option<Session>,
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
    /// The program, by showing it or, without a surface, by submitting it. Maybe it is one of a series.
    Frame(Option<u64>),
}

/// Where a frame is played. Threads take turns; what a thread submits while it has its turn, in a callback of wgpu's, goes
/// past.
#[derive(Debug, Default)]
struct Stage {
    running: Mutex<Option<Running>>,
    player: Mutex<Option<ThreadId>>,
}

impl Stage {
    /// `None` in a callback.
    fn turn(&self) -> Option<Turn<'_>> {
        let thread = std::thread::current().id();
        if *lock(&self.player) == Some(thread) {
            return None;
        }
        let running = lock(&self.running);
        *lock(&self.player) = Some(thread);
        Some(Turn { running, player: &self.player })
    }
}

struct Turn<'a> {
    running: MutexGuard<'a, Option<Running>>,
    player: &'a Mutex<Option<ThreadId>>,
}

impl Drop for Turn<'_> {
    fn drop(&mut self) {
        *lock(self.player) = None;
    }
}

/// A frame that a closure draws: recorded until it ends, or given up where the closure panics.
#[derive(Debug)]
pub struct OfClosure<'a>(&'a Recorder);

impl OfClosure<'_> {
    /// Writes what was recorded.
    pub fn end(self, shared: &Shared) -> Result<Recorded, RecordError> {
        let running = self.0.take(|running| running.end == End::Closure).ok_or(RecordError::Busy)?;
        running.write(shared, &mut Tools::default())
    }
}

impl Drop for OfClosure<'_> {
    fn drop(&mut self) {
        drop(self.0.take(|running| running.end == End::Closure));
    }
}

fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Recorder {
    /// Wishes for the next frame that begins.
    pub fn wish(&self, shared: &Shared, folder: PathBuf) -> Result<(), RecordError> {
        self.ask(shared, |_| Wish::one(folder, 0))
    }

    fn ask(&self, shared: &Shared, wish: impl FnOnce(&mut Series) -> Wish) -> Result<(), RecordError> {
        let mut asked = lock(&self.asked);
        let Asked { wish: asked, series } = &mut *asked;
        if asked.is_some() {
            return Err(RecordError::Busy);
        }
        *asked = Some(wish(series));
        // Without a surface, an encoder that was made since the last frame need not be one of the next: it may have read
        // the last one's picture back.
        if !shared.is_presented() {
            self.has_begun.store(false, Ordering::Release);
        }
        Ok(())
    }

    /// Wishes for each frame that begins from now on.
    pub fn start_series(&self, shared: &Shared, folder: PathBuf) -> Result<(), RecordError> {
        self.ask(shared, |series| {
            *series = Series { number: series.number + 1, ..Series::default() };
            Wish::series(folder, 0..u32::MAX)
        })
    }

    /// No further frame is wished for; those of the series that are written.
    pub fn stop_series(&self) -> Vec<OfSeries> {
        let mut asked = lock(&self.asked);
        asked.wish.take_if(|wish| wish.is_series);
        // A frame that goes on is of no series from now on.
        let number = asked.series.number + 1;
        std::mem::replace(&mut asked.series, Series { number, ..Series::default() }).recorded
    }

    /// A frame begins: is it recorded?
    fn begin_if_wished(&self) {
        let Some(mut turn) = self.stage.turn() else { return };
        if turn.running.is_some() {
            return;
        }
        let mut asked = lock(&self.asked);
        let Asked { wish, series } = &mut *asked;
        if wish.is_none() {
            *wish = of_environment();
        }
        let Some(wished) = wish.as_mut() else { return };
        let (folder, of_series) = (wished.next(), wished.is_series.then_some(series.number));
        wish.take_if(|wish| wish.is_over());
        let Some(folder) = folder else { return };
        let probes = of_series.map(|_| std::mem::take(&mut series.tools.probes)).unwrap_or_default();
        drop(asked);
        self.start(&mut turn, folder, probes, End::Frame(of_series));
    }

    fn start(&self, turn: &mut Turn<'_>, folder: PathBuf, probes: Probes, end: End) {
        *turn.running = Some(Running { folder, replay: Replay::with(probes), time: Duration::ZERO, end });
        self.has_begun.store(true, Ordering::Release);
        self.is_recording.store(true, Ordering::Release);
    }

    /// Begins a frame that a closure draws.
    pub fn begin(&self, folder: PathBuf) -> Result<OfClosure<'_>, RecordError> {
        let mut turn = self.stage.turn().ok_or(RecordError::Busy)?;
        if turn.running.is_some() {
            return Err(RecordError::Busy);
        }
        disk::check_target(&folder, false)?;
        self.start(&mut turn, folder, Probes::default(), End::Closure);
        Ok(OfClosure(self))
    }

    /// The frame that is recorded, if it ends so.
    fn take(&self, ends: impl FnOnce(&Running) -> bool) -> Option<Running> {
        let mut turn = self.stage.turn()?;
        let running = turn.running.take_if(|running| ends(running));
        if turn.running.is_none() {
            self.is_recording.store(false, Ordering::Release);
            self.has_begun.store(false, Ordering::Release);
        }
        running
    }

    /// A frame ends that is recorded, or one that is not and has drawn.
    fn frame_ends(&self, shared: &Shared) {
        // A submission that draws nothing, such as an upload, is no frame.
        let running = self.take(|running| running.end != End::Closure && running.replay.has_drawn());
        let Some(running) = running else { return };
        let (folder, end) = (running.folder.clone(), running.end);
        let is_of = |series: &Series| end == End::Frame(Some(series.number));
        let mut tools = {
            let mut asked = lock(&self.asked);
            if is_of(&asked.series) { std::mem::take(&mut asked.series.tools) } else { Tools::default() }
        };
        let outcome = running.write(shared, &mut tools).map(|recorded| recorded.cost);
        match &outcome {
            Ok(cost) => eprintln!("stencilscope: recorded a frame to {}: {cost}", folder.display()),
            Err(error) => eprintln!("stencilscope: no frame is recorded: {error}"),
        }
        let mut asked = lock(&self.asked);
        if !is_of(&asked.series) {
            return;
        }
        // What can't be written once can't be written for each frame that follows.
        asked.wish.take_if(|_| matches!(outcome, Err(RecordError::Disk(_))));
        if asked.wish.is_some() {
            asked.series.tools = tools;
        }
        asked.series.recorded.push(OfSeries { folder, outcome });
    }
}

impl Tools {
    /// Computes each draw anew, and notes where that differs.
    fn hold_against_itself(&mut self, of: &mut Converted, adapter: &wgpu::AdapterInfo) -> Result<(), SessionError> {
        let session = match &mut self.session {
            Some(session) => session,
            none => none.insert(Session::new(Some(&adapter.name))?),
        };
        of.capture = session.held_against_itself(&of.plan, &of.capture, &Progress::default())?;
        Ok(())
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
        if let Err(why) = tools.hold_against_itself(&mut converted, &adapter) {
            let limit = format!("its draws are not computed anew: {why}");
            converted.capture.origin.iter_mut().for_each(|origin| origin.limits.push(limit.clone()));
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
        let mut turn = if self.is_recording.load(Ordering::Acquire) { self.stage.turn() } else { None };
        let index = match turn.as_mut().and_then(|turn| turn.running.as_mut()) {
            Some(Running { replay, time, .. }) => {
                let begin = Instant::now();
                let index = replay.submit(&shared.device, &shared.queue, buffers);
                *time += begin.elapsed();
                index
            }
            None => {
                drop(turn.take());
                shared.queue.submit(buffers.into_iter().map(|finished| finished.inner))
            }
        };
        drop(turn);
        if has_passes && !shared.is_presented() {
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

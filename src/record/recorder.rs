//! Decides which frame is recorded, and what is done with it.

use super::RecordError;
use super::probes::Probes;
use super::replay::FrameReplay;
use crate::capture::disk::{self, FolderContents};
use crate::import::{ConvertedFrame, convert};
use crate::progress::Progress;
use crate::session::{Session, SessionError};
use crate::wrap::command::FinishedCommands;
use crate::wrap::{CallRecorder, SharedDevice};
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::ThreadId;
use std::time::{Duration, Instant};

/// A request to record one frame or a series of frames.
#[derive(Debug, Clone, PartialEq, Eq)]
struct FrameRequest {
    folder: PathBuf,
    /// Numbers of the frames, counted from 0 for the next that begins.
    frames: Range<u32>,
    /// True where each has a folder of its own within, named by its number.
    is_series: bool,
    /// The number of frames that have begun.
    begun: u32,
}

impl FrameRequest {
    fn one(folder: PathBuf, number: u32) -> FrameRequest {
        FrameRequest { folder, frames: number..number.saturating_add(1), is_series: false, begun: 0 }
    }

    fn series(folder: PathBuf, frames: Range<u32>) -> FrameRequest {
        FrameRequest { folder, frames, is_series: true, begun: 0 }
    }

    /// Parses `DIR` (its first frame, 0), `DIR:N` (one frame) or `DIR:A..B` (a series, B excluded). What is of neither
    /// form is a folder's name as a whole.
    fn of(text: &str) -> FrameRequest {
        let parted = text.rsplit_once(':');
        let one = || {
            let (folder, number) = parted?;
            Some(FrameRequest::one(folder.into(), number.parse().ok()?))
        };
        let series = || {
            let (folder, frames) = parted?;
            let (from, to) = frames.split_once("..")?;
            Some(FrameRequest::series(folder.into(), from.parse().ok()?..to.parse().ok()?))
        };
        one().or_else(series).unwrap_or_else(|| FrameRequest::one(text.into(), 0))
    }

    /// Counts a frame that begins, and returns the folder that it is recorded to: the requested one, `frame-NNNN` in it
    /// for a series; `None` where this frame is not requested.
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

/// Returns the request in the environment variable, once: `None` for every later call, and where it is not set or
/// empty.
fn of_environment() -> Option<FrameRequest> {
    static TAKEN: AtomicBool = AtomicBool::new(false);
    let text = std::env::var(super::VARIABLE).ok().filter(|text| !text.is_empty())?;
    (!TAKEN.swap(true, Ordering::Relaxed)).then(|| FrameRequest::of(&text))
}

/// What recording a frame has cost: draws, time and bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RecordingCost {
    /// The number of draws that were run one by one.
    pub draws: usize,
    /// Time that the program would not have spent otherwise: running each submission in parts, computing the frame
    /// again, writing.
    pub time: Duration,
    /// Bytes of the folder.
    pub bytes: u64,
}

impl fmt::Display for RecordingCost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let RecordingCost { draws, time, bytes } = self;
        write!(f, "{draws} draws, {:.2} s, {:.1} MB", time.as_secs_f64(), *bytes as f64 / 1e6)
    }
}

/// A frame that was recorded, the folder that it was written to, and what that cost.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedFrame {
    /// The frame in the form of our own: plan, pictures, scene and lights as far as they were found.
    pub frame: ConvertedFrame,
    /// The folder that it was written to.
    pub folder: PathBuf,
    /// The cost of recording it.
    pub cost: RecordingCost,
}

/// The outcome of one frame of a recorded series.
#[derive(Debug)]
pub struct SeriesFrame {
    /// The folder that it was to be written to.
    pub folder: PathBuf,
    /// What it cost, or why it was not written.
    pub outcome: Result<RecordingCost, RecordError>,
}

/// Records the frames that are requested of one wrapped device.
#[derive(Debug, Default)]
pub struct Recorder {
    is_recording: AtomicBool,
    /// True where an encoder was created since the last frame ended.
    has_begun: AtomicBool,
    asked: Mutex<PendingRecording>,
    stage: ReplayTurns,
}

/// Requests that have not ended. No function of wgpu is called while it is locked.
#[derive(Debug, Default)]
struct PendingRecording {
    wish: Option<FrameRequest>,
    series: FrameSeries,
}

/// What is reused from frame to frame of a series.
#[derive(Debug, Default)]
struct FrameSeries {
    number: u64,
    recorded: Vec<SeriesFrame>,
    tools: RecordingTools,
}

/// What recording a frame needs, and takes time to create.
#[derive(Debug, Default)]
struct RecordingTools {
    probes: Probes,
    session: Option<Session>,
}

#[derive(Debug)]
struct RunningRecording {
    folder: PathBuf,
    replay: FrameReplay,
    time: Duration,
    end: RecordingEnd,
}

/// The event that ends a recorded frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum RecordingEnd {
    /// The closure returns.
    Closure,
    /// The program presents the frame or, without a surface, submits it. The number is that of its series, if any.
    Frame(Option<u64>),
}

/// Exclusive access to the frame that is replayed. Threads take turns; what a thread submits from a callback of wgpu's
/// during its own turn is not recorded.
#[derive(Debug, Default)]
struct ReplayTurns {
    running: Mutex<Option<RunningRecording>>,
    player: Mutex<Option<ThreadId>>,
}

impl ReplayTurns {
    /// Waits until no other thread is replaying, and returns the lock; `None` where this thread holds it already, as in
    /// a callback.
    fn turn(&self) -> Option<ReplayTurn<'_>> {
        let thread = std::thread::current().id();
        if *lock(&self.player) == Some(thread) {
            return None;
        }
        let running = lock(&self.running);
        *lock(&self.player) = Some(thread);
        Some(ReplayTurn { running, player: &self.player })
    }
}

struct ReplayTurn<'a> {
    running: MutexGuard<'a, Option<RunningRecording>>,
    player: &'a Mutex<Option<ThreadId>>,
}

impl Drop for ReplayTurn<'_> {
    fn drop(&mut self) {
        *lock(self.player) = None;
    }
}

/// A frame that a closure draws: recorded until it ends, or discarded where the closure panics.
#[derive(Debug)]
pub struct ClosureFrame<'a>(&'a Recorder);

impl ClosureFrame<'_> {
    /// Ends the closure's frame, converts it and writes its folder; [`RecordError::Busy`] where it is no longer the one
    /// that is recorded.
    pub fn end(self, shared: &SharedDevice) -> Result<RecordedFrame, RecordError> {
        let running = self.0.take(|running| running.end == RecordingEnd::Closure).ok_or(RecordError::Busy)?;
        running.write(shared, &mut RecordingTools::default())
    }
}

impl Drop for ClosureFrame<'_> {
    fn drop(&mut self) {
        drop(self.0.take(|running| running.end == RecordingEnd::Closure));
    }
}

fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Recorder {
    /// Requests that the next frame that begins is recorded into `folder`.
    pub fn wish(&self, shared: &SharedDevice, folder: PathBuf) -> Result<(), RecordError> {
        self.ask(shared, |_| FrameRequest::one(folder, 0))
    }

    fn ask(
        &self,
        shared: &SharedDevice,
        wish: impl FnOnce(&mut FrameSeries) -> FrameRequest,
    ) -> Result<(), RecordError> {
        let mut asked = lock(&self.asked);
        let PendingRecording { wish: asked, series } = &mut *asked;
        if asked.is_some() {
            return Err(RecordError::Busy);
        }
        *asked = Some(wish(series));
        // Without a surface, an encoder that was created since the last frame need not be one of the next: it may have
        // read the last one's picture back.
        if !shared.is_presented() {
            self.has_begun.store(false, Ordering::Release);
        }
        Ok(())
    }

    /// Requests each frame that begins from now on, in folders `frame-NNNN` within `folder`, as a new series. Fails
    /// where another request is pending or a frame is being recorded.
    pub fn start_series(&self, shared: &SharedDevice, folder: PathBuf) -> Result<(), RecordError> {
        self.ask(shared, |series| {
            *series = FrameSeries { number: series.number + 1, ..FrameSeries::default() };
            FrameRequest::series(folder, 0..u32::MAX)
        })
    }

    /// Ends the request for a series; returns the frames of the series that are written.
    pub fn stop_series(&self) -> Vec<SeriesFrame> {
        let mut asked = lock(&self.asked);
        asked.wish.take_if(|wish| wish.is_series);
        // A frame that is still recorded belongs to no series from now on.
        let number = asked.series.number + 1;
        std::mem::replace(&mut asked.series, FrameSeries { number, ..FrameSeries::default() }).recorded
    }

    /// Called where a frame begins: counts it, and starts recording it if it was requested, by a call or by the
    /// environment. Does nothing while a frame is being recorded.
    fn begin_if_wished(&self) {
        let Some(mut turn) = self.stage.turn() else { return };
        if turn.running.is_some() {
            return;
        }
        let mut asked = lock(&self.asked);
        let PendingRecording { wish, series } = &mut *asked;
        if wish.is_none() {
            *wish = of_environment();
        }
        let Some(wished) = wish.as_mut() else { return };
        let (folder, of_series) = (wished.next(), wished.is_series.then_some(series.number));
        wish.take_if(|wish| wish.is_over());
        let Some(folder) = folder else { return };
        let probes = of_series.map(|_| std::mem::take(&mut series.tools.probes)).unwrap_or_default();
        drop(asked);
        self.start(&mut turn, folder, probes, RecordingEnd::Frame(of_series));
    }

    fn start(&self, turn: &mut ReplayTurn<'_>, folder: PathBuf, probes: Probes, end: RecordingEnd) {
        *turn.running = Some(RunningRecording { folder, replay: FrameReplay::with(probes), time: Duration::ZERO, end });
        self.has_begun.store(true, Ordering::Release);
        self.is_recording.store(true, Ordering::Release);
    }

    /// Begins to record a frame that a closure draws, to `folder`, which must not exist yet or be empty. Fails while
    /// another frame is recorded, and in a callback of wgpu's.
    pub fn begin(&self, folder: PathBuf) -> Result<ClosureFrame<'_>, RecordError> {
        let mut turn = self.stage.turn().ok_or(RecordError::Busy)?;
        if turn.running.is_some() {
            return Err(RecordError::Busy);
        }
        disk::check_target(&folder, false)?;
        self.start(&mut turn, folder, Probes::default(), RecordingEnd::Closure);
        Ok(ClosureFrame(self))
    }

    /// Takes the frame that is being recorded, if `ends` is true for it; otherwise, or in a callback, `None` and
    /// recording goes on.
    fn take(&self, ends: impl FnOnce(&RunningRecording) -> bool) -> Option<RunningRecording> {
        let mut turn = self.stage.turn()?;
        let running = turn.running.take_if(|running| ends(running));
        if turn.running.is_none() {
            self.is_recording.store(false, Ordering::Release);
            self.has_begun.store(false, Ordering::Release);
        }
        running
    }

    /// Called where a frame ends: writes the recorded one, if it has drawn and is not a closure's, and prints what it
    /// cost or why it failed. A frame that can't be written to disk ends its series.
    fn frame_ends(&self, shared: &SharedDevice) {
        // A submission that draws nothing, such as an upload, is no frame.
        let running = self.take(|running| running.end != RecordingEnd::Closure && running.replay.has_drawn());
        let Some(running) = running else { return };
        let (folder, end) = (running.folder.clone(), running.end);
        let is_of = |series: &FrameSeries| end == RecordingEnd::Frame(Some(series.number));
        let mut tools = {
            let mut asked = lock(&self.asked);
            if is_of(&asked.series) { std::mem::take(&mut asked.series.tools) } else { RecordingTools::default() }
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
        // A folder that can't be written once can't be written for each frame that follows.
        asked.wish.take_if(|_| matches!(outcome, Err(RecordError::Disk(_))));
        if asked.wish.is_some() {
            asked.series.tools = tools;
        }
        asked.series.recorded.push(SeriesFrame { folder, outcome });
    }
}

impl RecordingTools {
    /// Runs the recorded frame's plan again on the adapter of the same name, and stores in its capture how each draw's
    /// result differs. The session is opened once for a series.
    fn hold_against_itself(
        &mut self,
        of: &mut ConvertedFrame,
        adapter: &wgpu::AdapterInfo,
    ) -> Result<(), SessionError> {
        let session = match &mut self.session {
            Some(session) => session,
            none => none.insert(Session::new(Some(&adapter.name))?),
        };
        of.capture = session.compared_with_rerun(&of.plan, &of.capture, &Progress::default())?;
        Ok(())
    }
}

impl RunningRecording {
    fn write(self, shared: &SharedDevice, tools: &mut RecordingTools) -> Result<RecordedFrame, RecordError> {
        let RunningRecording { folder, replay, mut time, .. } = self;
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
        Ok(RecordedFrame { frame: converted, folder, cost: RecordingCost { draws, time, bytes } })
    }
}

impl CallRecorder for Recorder {
    fn is_recording(&self) -> bool {
        // The first encoder since the last frame begins the next.
        if !self.has_begun.swap(true, Ordering::AcqRel) {
            self.begin_if_wished();
        }
        self.is_recording.load(Ordering::Acquire)
    }

    fn submit(&self, shared: &SharedDevice, buffers: Vec<FinishedCommands>) -> wgpu::SubmissionIndex {
        let has_passes = buffers.iter().any(|finished| finished.has_passes);
        let mut turn = if self.is_recording.load(Ordering::Acquire) { self.stage.turn() } else { None };
        let index = match turn.as_mut().and_then(|turn| turn.running.as_mut()) {
            Some(RunningRecording { replay, time, .. }) => {
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

    fn presented(&self, shared: &SharedDevice) {
        self.frame_ends(shared);
    }
}

fn write(frame: &ConvertedFrame, folder: &Path) -> Result<(), RecordError> {
    let ConvertedFrame { plan, capture, scene, .. } = frame;
    disk::write(FolderContents { capture, plan: Some(plan), scene: scene.as_ref() }, folder, false)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wish_names_a_folder_and_maybe_frames() {
        let one = |folder: &str, number| FrameRequest::one(folder.into(), number);
        assert_eq!(FrameRequest::of("out"), one("out", 0));
        assert_eq!(FrameRequest::of("out:12"), one("out", 12));
        assert_eq!(FrameRequest::of("out:3..7"), FrameRequest::series("out".into(), 3..7));
        // A drive, or a folder with a colon or points in its name.
        assert_eq!(FrameRequest::of("C:/out"), one("C:/out", 0));
        assert_eq!(FrameRequest::of("a:b:3"), one("a:b", 3));
        assert_eq!(FrameRequest::of("a:../b"), one("a:../b", 0));
    }

    #[test]
    fn frames_are_counted_as_they_begin() {
        let folders = |mut wish: FrameRequest| -> Vec<Option<String>> {
            let named = |folder: PathBuf| folder.to_string_lossy().into_owned();
            std::iter::from_fn(|| (!wish.is_over()).then(|| wish.next().map(named))).collect()
        };
        assert_eq!(folders(FrameRequest::of("out:2")), [None, None, Some("out".to_owned())]);
        let numbered = |number: &str| Some(format!("out/frame-{number}"));
        assert_eq!(folders(FrameRequest::of("out:1..3")), [None, numbered("0001"), numbered("0002")]);
        assert_eq!(folders(FrameRequest::of("out:3..3")), [None, None, None]);
    }
}

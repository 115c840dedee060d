//! `stencilscope capture`: renders without a window and writes every pass to a folder.

use super::options::{FrameOptions, SceneOptions, open_session};
use super::progress::with_bar;
use super::{CliError, output};
use crate::capture::Capture;
use crate::capture::disk::{self, FolderContents};
use crate::page;
use crate::picture::Picture;
use crate::plan::{DecidedBy, FramePlan, LightChannel};
use crate::progress::Progress;
use crate::reading::format;
use crate::scene::Scene;
use crate::session::{CaptureRequest, Session};
use clap::Args;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

#[derive(Debug, Args)]
pub struct CaptureArguments {
    /// A built-in scene, a scene file (.toml) or a model (.obj, .ply, .gltf, .glb)
    scene: String,
    /// The folder to make
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Replace the folder if it is a capture already
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    scene_options: SceneOptions,
    #[command(flatten)]
    frame: FrameOptions,
    /// Also trace the ground truth, and show the technique's errors
    #[arg(long)]
    truth: bool,
    /// Also time the frame, with and without snapshots: it runs twelve times more
    #[arg(long)]
    timing: bool,
    /// Also the light by what it is, each a picture in the folder: channel-ambient.png, channel-emissive.png,
    /// channel-diffuse.png, channel-specular.png; added in linear light they are the whole
    #[arg(long)]
    channels: bool,
    /// Also put the frame into one HTML file that any browser opens; one that is there is replaced with --overwrite
    #[arg(long, value_name = "FILE.html")]
    page: Option<String>,
}

/// Runs the command `capture`: renders a scene, stores its capture in a folder, with `--page` also as an HTML file, and
/// prints a summary.
pub fn run(arguments: &CaptureArguments) -> Result<(), CliError> {
    let CaptureArguments { scene, scene_options, frame, output, overwrite, truth, timing, channels, page } = arguments;
    if let Some(page) = page {
        super::page::check_target(page, *overwrite)?;
    }
    let how = CaptureOutput {
        folder: output,
        overwrite: *overwrite,
        truth: *truth,
        channels: *channels,
        page: page.as_deref(),
    };
    let mut job = CaptureJob::new(scene, scene_options, frame, how)?;
    job.request.timing_runs = if *timing { TIMING_RUNS } else { 0 };
    job.run()
}

/// How many frames are timed where that is asked for, each with and without snapshots, after one of each that is not.
const TIMING_RUNS: usize = 5;

/// A capture that is ready to run: its scene is loaded, and its options and target folder are checked.
pub struct CaptureJob<'a> {
    started: Instant,
    /// As on the command line.
    name: &'a str,
    scene: Scene,
    request: CaptureRequest,
    adapter: Option<&'a str>,
    writing: CaptureOutput<'a>,
}

/// The folder that a capture is written to, and what is written in addition.
pub struct CaptureOutput<'a> {
    /// The folder that is made.
    pub folder: &'a Path,
    /// True where the folder may replace a capture.
    pub overwrite: bool,
    /// True where the ground truth is traced, too.
    pub truth: bool,
    /// True where each channel of the light is written, too.
    pub channels: bool,
    /// Path of the page that is written, too; `None` for no page.
    pub page: Option<&'a str>,
}

impl<'a> CaptureJob<'a> {
    /// Loads the scene and checks options and target folder (not the page's file) before the GPU is opened. `name` is
    /// the scene as on the command line.
    pub fn new(
        name: &'a str,
        scene_options: &SceneOptions,
        frame: &'a FrameOptions,
        writing: CaptureOutput<'a>,
    ) -> Result<CaptureJob<'a>, CliError> {
        let started = Instant::now();
        let scene = scene_options.open(name)?;
        let request = frame.request(&scene)?;
        disk::check_target(writing.folder, writing.overwrite)?;
        Ok(CaptureJob { started, name, scene, request, adapter: frame.adapter.as_deref(), writing })
    }

    /// Renders the scene, traces its truth where asked for, writes the folder and the page where one is named, and
    /// prints a summary.
    pub fn run(self) -> Result<(), CliError> {
        let mut session = open_session(self.adapter)?;
        session.hold_geometry(false);
        let before = self.started.elapsed().as_secs_f64() * 1e3;
        let (mut capture, plan) = session.capture_with_plan(&self.scene, &self.request)?;
        let CaptureOutput { folder, overwrite, truth, channels, page } = self.writing;
        let of_channels =
            if channels { channel_pictures(&mut session, &self.scene, &plan, folder)? } else { Vec::new() };
        if truth {
            capture = with_bar("ground truth", &Progress::default(), |progress| {
                session.judged(&self.scene, &capture, progress)
            })?;
        }
        // What is on the GPU takes as much memory as the files that are now written.
        drop(session);
        // Loading the scene and opening the GPU come before the first frame too.
        capture.timing.setup_ms = capture.timing.setup_ms.map(|setup| setup + before);
        disk::write(
            FolderContents { capture: &capture, plan: Some(&plan), scene: Some(&self.scene) },
            folder,
            overwrite,
        )?;
        for (file, png) in of_channels {
            std::fs::write(&file, png).map_err(|source| CliError::Output { path: file, source })?;
        }
        output::note_left_out(self.name, &self.scene, Some(&folder.join(disk::PLAN)));
        let mut said = summary(&capture, folder);
        if let Some(page) = page {
            let bytes = page::write(&capture, &Arc::new(plan), None, Path::new(page))?;
            said += &format!("{page}: {}\n", format::bytes(bytes));
        }
        output::print(&said)
    }
}

/// Returns the picture at the end of the frame in each channel of its light, as the name and the bytes of a PNG file in
/// `folder`.
fn channel_pictures(
    session: &mut Session,
    scene: &Scene,
    plan: &FramePlan,
    folder: &Path,
) -> Result<Vec<(String, Vec<u8>)>, CliError> {
    let of_channel = |channel: LightChannel| {
        let capture = session.capture_plan(scene, &plan.in_channel(channel))?;
        let last = (0..capture.steps.len()).rev().find_map(|step| capture.frame_at(step));
        let image = last.map(|frame| Arc::clone(&frame.color.image));
        let color = |at: [u32; 2]| {
            let [r, g, b, _] = image.as_ref().and_then(|image| image.rgba_at(at)).unwrap_or_default();
            [r, g, b]
        };
        let file = folder.join(format!("channel-{}.png", channel.name())).display().to_string();
        match Picture::drawn(capture.size, color).to_png() {
            Ok(png) => Ok((file, png)),
            Err(source) => Err(CliError::Output { path: file, source: source.into() }),
        }
    };
    LightChannel::ALL.into_iter().map(of_channel).collect()
}

/// Returns a line with the number of pixels whose count is a multiple of 256 other than 0, which eight bits read as 0.
/// Empty where there is none, or no light is decided by a stencil count.
fn wrapped_line(capture: &Capture) -> String {
    let pixels: u64 = capture.lights.iter().filter_map(crate::capture::CapturedLight::wrapped_pixels).sum();
    if pixels == 0 || !capture.lights.iter().any(|light| matches!(light.decided_by, DecidedBy::StencilCount { .. })) {
        return String::new();
    }
    format!(
        "counts: at {pixels} pixels a multiple of 256 volumes contain the surface, and eight bits read that as none: \
         --set counter=float counts on\n"
    )
}

fn summary(capture: &Capture, folder: &Path) -> String {
    let [width, height] = capture.size;
    let (scene, technique, passes) = (&capture.scene, &capture.technique, capture.steps.len());
    let judged = capture.error().map_or_else(String::new, |error| {
        format!(
            "wrong pixels: {} of {} compared ({} false shadow, {} missing shadow, {} wrong surface); {} at edges excused\n",
            error.wrong(),
            error.compared,
            error.false_shadow,
            error.missing_shadow,
            error.wrong_surface,
            error.edge_band,
        )
    });
    let visibility = capture.visibility_error().map_or_else(String::new, |error| format!("{}\n", error.in_words()));
    let wrapped = wrapped_line(capture);
    format!(
        "{}: {scene}, {technique}, {width}x{height}, {passes} passes\n{judged}{visibility}{wrapped}",
        folder.display()
    )
}

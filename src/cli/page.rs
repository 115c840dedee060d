//! `stencilscope page`: one HTML file of a frame, which opens in any browser.

use super::options::{FrameOptions, SceneOptions, Subject, open_session};
use super::progress::with_bar;
use super::{CliError, live, output};
use crate::page;
use crate::progress::Progress;
use crate::reading::format;
use crate::session::RunFrame;
use clap::Args;
use std::path::Path;
use std::sync::Arc;

/// Examples that are printed below the options in the command's help.
pub const EXAMPLES: &str = "\
A scene:                stencilscope page tori -t z-fail --size 640x480 -o tori.html
A frame that is there:  stencilscope page DIR -o frame.html
With a live window:     stencilscope page tori -o tori.html --live https://HOST/PATH/

The file holds all it shows and loads nothing: steps, values, and the history of every pixel, computed in the browser.
Its address goes to a pixel of a step: tori.html#pixel=322,92&step=2. With --live a button opens the same view, with the
selected step and pixel, in the window for browsers at that address: built-in scenes and recorded frames open there.
";

#[derive(Debug, Args)]
pub struct PageArguments {
    /// A built-in scene, a scene file (.toml), a model (.obj, .ply, .gltf, .glb) or a capture folder
    scene: String,
    /// The file to make
    #[arg(short, long, value_name = "FILE.html")]
    output: String,
    /// Replace the file if it is there
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    scene_options: SceneOptions,
    #[command(flatten)]
    frame: FrameOptions,
    /// Also trace the ground truth, and show the technique's errors
    #[arg(long)]
    truth: bool,
    /// The address of a live window for browsers, which the page links to: its button opens the frame there
    #[arg(long, value_name = "URL", value_parser = live::window_address)]
    live: Option<String>,
}

/// Runs the command `page`: writes the frame as one HTML file and prints its name, what it shows and its size.
pub fn run(arguments: &PageArguments) -> Result<(), CliError> {
    let PageArguments { scene, output, overwrite, scene_options, frame, truth, live } = arguments;
    check_target(output, *overwrite)?;
    frame.refuse_external_capture("a page is made of one, later")?;
    let subject = Subject::new(scene, scene_options, frame)?;
    if matches!(subject, Subject::Folder(_)) {
        frame.refuse_draws("a folder holds what it holds")?;
    }
    // What no link opens is refused before long work.
    let live = match live {
        Some(window) => Some(live::frame_address(window, scene, &subject, scene_options.seconds()?)?),
        None => None,
    };
    let frame = made(subject, frame, *truth)?;
    let bytes = format::bytes(page::write(&frame.capture, &frame.plan, live.as_deref(), Path::new(output))?);
    let capture = &frame.capture;
    let [width, height] = capture.size;
    let (scene, technique, passes) = (&capture.scene, &capture.technique, capture.steps.len());
    output::print(&format!("{output}: {scene}, {technique}, {width}x{height}, {passes} passes, {bytes}\n"))
}

/// Fails, before long work, where the file's extension is neither html nor htm, its folder is missing, or it exists and
/// `overwrite` is false.
pub fn check_target(file: &str, overwrite: bool) -> Result<(), CliError> {
    let name = file.escape_debug();
    let ending = Path::new(file).extension().unwrap_or_default().to_ascii_lowercase();
    if ending != "html" && ending != "htm" {
        return Err(CliError::Usage(format!("`{name}`: a page is an HTML file: give it a name that ends in .html")));
    }
    output::check_target(file)?;
    if Path::new(file).exists() && !overwrite {
        return Err(CliError::Usage(format!("`{name}` is there already: choose another file, or add --overwrite")));
    }
    Ok(())
}

/// Returns the subject's frame, rendered now or as stored, with its truth added where `truth` asks for it. A stored
/// frame opens no GPU unless its truth is asked for and it has none yet.
fn made(subject: Subject, options: &FrameOptions, truth: bool) -> Result<RunFrame, CliError> {
    let mut session = match &subject {
        Subject::Folder(frame) if !truth || frame.capture.error().is_some() => None,
        _ => Some(open_session(options.adapter.as_deref())?),
    };
    let mut frame = match (subject, &mut session) {
        (Subject::Folder(frame), _) => frame,
        (scene @ Subject::Scene(_), Some(session)) => scene.frame(session)?,
        (scene @ Subject::Scene(_), None) => scene.frame(&mut open_session(options.adapter.as_deref())?)?,
    };
    if let Some(session) = session.as_mut().filter(|_| truth) {
        let scene = frame.scene()?;
        let judged =
            with_bar("ground truth", &Progress::default(), |progress| session.judged(scene, &frame.capture, progress))?;
        frame.capture = Arc::new(judged);
    }
    Ok(frame)
}

//! `stencilscope capture`: renders without a window and writes every pass to a folder.

use super::options::{FrameOptions, SceneOptions};
use super::{CliError, output};
use crate::capture::{Capture, disk};
use crate::session::Session;
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct CaptureArguments {
    /// A built-in scene, a scene file (.toml) or a model (.obj)
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
}

/// Everything that can be wrong without a GPU is checked before one is opened.
///
/// # Errors
/// A scene, option or folder that can't be used; no GPU; a frame that can't be made.
pub fn run(arguments: &CaptureArguments) -> Result<(), CliError> {
    let scene = &arguments.scene;
    into_folder(scene, &arguments.scene_options, &arguments.frame, &arguments.output, arguments.overwrite)
}

/// Captures a scene into `folder` and says so.
///
/// # Errors
/// As [`run`].
pub fn into_folder(
    name: &str,
    scene_options: &SceneOptions,
    frame: &FrameOptions,
    folder: &Path,
    overwrite: bool,
) -> Result<(), CliError> {
    let scene = scene_options.open(name)?;
    let request = frame.request(&scene)?;
    disk::check_target(folder, overwrite)?;
    let capture = Session::new(frame.adapter.as_deref())?.capture(&scene, &request)?;
    disk::write(&capture, folder, overwrite)?;
    output::print(&summary(&capture, folder))
}

fn summary(capture: &Capture, folder: &Path) -> String {
    let [width, height] = capture.size;
    let (scene, technique, passes) = (&capture.scene, &capture.technique, capture.steps.len());
    format!("{}: {scene}, {technique}, {width}x{height}, {passes} passes\n", folder.display())
}

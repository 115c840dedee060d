//! `stencilscope view`: the inspector window, or a capture where there can be no window.

use super::options::{FrameOptions, SceneOptions, pixel};
use super::{CliError, capture, output};
use clap::Args;
use std::path::Path;

/// Where a capture goes that takes the place of a window.
const FALLBACK_FOLDER: &str = "stencilscope-out";

#[derive(Debug, Args)]
pub struct ViewArguments {
    /// A built-in scene, a scene file (.toml), a model (.obj) or a capture folder
    #[arg(default_value = "tori")]
    scene: String,
    /// Open at this step
    #[arg(long, value_name = "N")]
    pass: Option<usize>,
    /// Open at this pixel
    #[arg(long, value_name = "X,Y", value_parser = pixel)]
    at: Option<[u32; 2]>,
    #[command(flatten)]
    scene_options: SceneOptions,
    #[command(flatten)]
    frame: FrameOptions,
}

/// Opens the window; with no display, or built without one, says so and captures instead.
///
/// # Errors
/// As [`capture::run`]; a capture folder that can't be read.
pub fn run(arguments: &ViewArguments) -> Result<(), CliError> {
    match no_window_because() {
        None => window::open(arguments),
        Some(reason) => capture_instead(arguments, reason),
    }
}

fn capture_instead(arguments: &ViewArguments, reason: &str) -> Result<(), CliError> {
    let folder = Path::new(FALLBACK_FOLDER);
    if Path::new(&arguments.scene).is_dir() {
        // Whatever is wrong with the folder is the better answer.
        crate::capture::disk::read(Path::new(&arguments.scene))?;
        return Err(CliError::Window(reason.to_owned()));
    }
    output::note(&format!("{reason}: capturing into ./{FALLBACK_FOLDER} instead"));
    capture::into_folder(&arguments.scene, &arguments.scene_options, &arguments.frame, folder, true)
}

/// Why there can be no window; `None` where there may be one.
fn no_window_because() -> Option<&'static str> {
    if cfg!(not(feature = "inspector")) {
        return Some("this build has no window");
    }
    let is_set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let needs_display = cfg!(unix) && !cfg!(target_os = "macos");
    let has_display = !needs_display || is_set("DISPLAY") || is_set("WAYLAND_DISPLAY");
    (!has_display).then_some("there is no display")
}

/// The call site of the window.
#[cfg(feature = "inspector")]
mod window {
    use super::{CliError, ViewArguments};

    pub fn open(arguments: &ViewArguments) -> Result<(), CliError> {
        let _ = (arguments.pass, arguments.at);
        Err(CliError::NotThereYet { what: "the window".to_owned(), instead: "use `stencilscope capture`".to_owned() })
    }
}

/// Without the inspector [`no_window_because`] keeps the call away.
#[cfg(not(feature = "inspector"))]
mod window {
    use super::{CliError, ViewArguments};

    pub fn open(_: &ViewArguments) -> Result<(), CliError> {
        Err(CliError::Window("this build has no window".to_owned()))
    }
}

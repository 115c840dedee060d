//! `stencilscope view`: the inspector window, or a capture where there can be no window.

use super::options::{FrameOptions, SceneOptions, pixel};
use super::{CliError, capture, output};
use clap::Args;
use std::path::Path;

/// Name of the folder for a capture that is made where no window can open.
const FALLBACK_FOLDER: &str = "stencilscope-out";

#[derive(Debug, Args)]
pub struct ViewArguments {
    /// A built-in scene, a scene file (.toml), a model (.obj, .ply, .gltf, .glb) or a capture folder
    #[arg(default_value = "tori")]
    scene: String,
    /// Open at this pass, by its index in the manifest
    #[arg(long, value_name = "N")]
    pass: Option<usize>,
    /// Open at this pixel
    #[arg(long, value_name = "X,Y", value_parser = pixel)]
    at: Option<[u32; 2]>,
    #[command(flatten)]
    scene_options: SceneOptions,
    #[command(flatten)]
    frame: FrameOptions,
    /// Trace the ground truth, and show where the technique is wrong
    #[arg(long)]
    truth: bool,
}

/// Runs the command `view`: opens the window. Where it can't open, says so and captures the scene into a folder
/// instead, replacing a capture there; a capture folder is an error then.
pub fn run(arguments: &ViewArguments) -> Result<(), CliError> {
    match no_window_because() {
        None => window::open(arguments),
        Some(reason) => capture_instead(arguments, reason),
    }
}

fn capture_instead(arguments: &ViewArguments, reason: &str) -> Result<(), CliError> {
    let folder = Path::new(FALLBACK_FOLDER);
    if Path::new(&arguments.scene).is_dir() {
        // An error of the folder itself is the better answer.
        crate::capture::disk::read(Path::new(&arguments.scene))?;
        let fix = "read its manifest.json, .npy and .png files, or open it where there is a display";
        return Err(CliError::Usage(format!("a capture folder can only be shown in a window, but {reason}: {fix}")));
    }
    let writing =
        capture::CaptureOutput { folder, overwrite: true, truth: arguments.truth, channels: false, page: None };
    let job = capture::CaptureJob::new(&arguments.scene, &arguments.scene_options, &arguments.frame, writing)?;
    output::note(&format!("{reason}: capturing into ./{FALLBACK_FOLDER} instead"));
    job.run()
}

/// Returns why no window can open (built without one, or no display), or `None` where it may work.
fn no_window_because() -> Option<&'static str> {
    if cfg!(not(feature = "inspector")) {
        return Some("this build has no window");
    }
    let is_set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let needs_display = cfg!(unix) && !cfg!(target_os = "macos");
    let has_display = !needs_display || is_set("DISPLAY") || is_set("WAYLAND_DISPLAY");
    (!has_display).then_some("there is no display")
}

/// Opens the window, or captures where the system turns out to have none.
#[cfg(feature = "inspector")]
pub mod window {
    use super::{CliError, FrameOptions, SceneOptions, ViewArguments, capture_instead};
    use crate::app::{self, AppError, ViewRequest, ViewSource};
    use crate::capture::disk;
    use crate::import::ShippedFrame;
    use crate::session::CaptureRequest;
    use crate::technique::{Choice, Technique};
    use std::path::Path;

    /// Opens the window and returns when it is closed. Captures into a folder instead where the system turns out to
    /// have no window.
    pub fn open(arguments: &ViewArguments) -> Result<(), CliError> {
        match app::run(request(arguments)?) {
            Err(AppError::NoWindow(reason)) => capture_instead(arguments, &format!("no window ({reason})")),
            result => result.map_err(|error| CliError::Window(error.to_string())),
        }
    }

    /// Returns the request for the window: a folder or shipped frame as it was stored (options of scene and frame are
    /// ignored, the adapter excepted), else a scene as the options say. Fails for `--external-capture` and what can't
    /// be opened.
    fn request(arguments: &ViewArguments) -> Result<ViewRequest, CliError> {
        let why =
            "a window draws many frames, of which the debugger's own key records one; `capture` brackets its frame";
        arguments.frame.refuse_external_capture(why)?;
        let folder = Path::new(&arguments.scene);
        let shipped = ShippedFrame::named(&arguments.scene).filter(|_| !folder.is_dir());
        if !folder.is_dir() && shipped.is_none() {
            let request = scene_request(&arguments.scene, &arguments.scene_options, &arguments.frame)?;
            return Ok(ViewRequest { step: arguments.pass, pick: arguments.at, truth: arguments.truth, ..request });
        }
        let whole = match shipped {
            Some(shipped) => shipped.open()?,
            None => {
                app::why_no_capture(folder).map_or(Ok(()), |why| Err(CliError::Usage(why)))?;
                disk::read_whole(folder)?
            }
        };
        // How a scene is rendered that is opened from the window later.
        let request = CaptureRequest::new(Choice::new(Technique::ZFail), whole.capture.size);
        Ok(ViewRequest {
            source: ViewSource::Folder(Box::new(whole)),
            name: arguments.scene_options.spec(&arguments.scene),
            capture: request,
            time: 0.0,
            adapter: arguments.frame.adapter.clone(),
            step: arguments.pass,
            pick: arguments.at,
            truth: arguments.truth,
        })
    }

    /// Returns the request that opens a scene, at the options' time, in a window or in panels without one; with no
    /// step, no picked pixel and no truth.
    pub fn scene_request(name: &str, scene: &SceneOptions, frame: &FrameOptions) -> Result<ViewRequest, CliError> {
        let loaded = scene.load(name)?;
        let capture = frame.request(&loaded)?;
        Ok(ViewRequest {
            source: ViewSource::Scene(Box::new(loaded)),
            name: scene.spec(name),
            capture,
            time: scene.seconds()?,
            adapter: frame.adapter.clone(),
            step: None,
            pick: None,
            truth: false,
        })
    }
}

/// Built without the inspector, this is never called: see [`no_window_because`].
#[cfg(not(feature = "inspector"))]
mod window {
    use super::{CliError, ViewArguments};

    pub fn open(_: &ViewArguments) -> Result<(), CliError> {
        Err(CliError::Window("this build has no window".to_owned()))
    }
}

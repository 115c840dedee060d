//! The address of a frame in a live window for browsers, which a page links to.

use super::CliError;
use super::options::{SceneSubject, Subject};
use crate::ask::RunRequest;
use crate::capture::disk;
use crate::import::ShippedFrame;
use crate::link::ViewLink;
use crate::scene::builtin::Builtin;
use std::path::Path;

/// Parses the address of a live window's page: it begins with `http://` or `https://`, names a host, and has no query and
/// no fragment, since a link adds its own query.
pub fn window_address(text: &str) -> Result<String, String> {
    let rest = ["https://", "http://"].iter().find_map(|scheme| text.strip_prefix(scheme));
    let is_excluded = |c: char| c.is_whitespace() || c.is_control() || c == '?' || c == '#';
    let has_host = |rest: &str| !rest.is_empty() && !rest.starts_with(['/', ':']);
    if rest.is_some_and(|rest| has_host(rest) && !rest.contains(is_excluded)) {
        Ok(text.to_owned())
    } else {
        Err("give the address of a live window as https://HOST/PATH/, without `?` and `#`".to_owned())
    }
}

/// Returns the address at which a live window shows a frame: `window` with the frame's link as its query. `name` is the
/// scene's as on the command line, and `seconds` is its time.
///
/// # Errors
/// A frame that no link opens, with the reason.
pub fn frame_address(window: &str, name: &str, subject: &Subject, seconds: f64) -> Result<String, CliError> {
    let link = match subject {
        Subject::Scene(scene) => scene_link(name, scene, seconds)?,
        Subject::Folder(_) if ShippedFrame::named(name).is_some() && !disk::is_capture(Path::new(name)) => {
            ViewLink { scene: Some(name.to_owned()), ..ViewLink::default() }
        }
        Subject::Folder(_) => {
            let fix = "name the built-in scene that it was captured of in its place, or leave `--live` out";
            return Err(refused(&format!("no link opens a folder, and `{name}` is one: {fix}")));
        }
    };
    Ok(window.to_owned() + &link.to_query())
}

/// Returns the link to a built-in scene with the camera, lights and time of a command line. A link moves lights and
/// switches them off, and the command line replaces them: where these are not the same, no link is right.
fn scene_link(name: &str, subject: &SceneSubject, seconds: f64) -> Result<ViewLink, CliError> {
    let SceneSubject { loaded, request, .. } = subject;
    let Some(builtin) = Builtin::named(name) else {
        let reason = format!("a link opens built-in scenes alone, and `{name}` is a file: leave `--live` out");
        return Err(refused(&reason));
    };
    let scene = builtin.scene()?;
    let draft = RunRequest { time: seconds, ..RunRequest::of(loaded, request.choice.clone(), request.size) };
    let link = ViewLink::of_run(name, &scene, &draft);
    if link.lacks(&scene, &draft).is_some() {
        let differs = "a link moves a scene's lights, and `--light` and `--sun` put white ones in their place";
        return Err(refused(&format!("{differs}: leave these out, or `--live`")));
    }
    Ok(link)
}

fn refused(reason: &str) -> CliError {
    CliError::Usage(format!("`--live`: {reason}"))
}

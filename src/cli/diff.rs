//! `stencilscope diff`: where two frames first differ, pass by pass.

use super::options::{FrameOptions, SceneOptions, open_session, picture_size, setting};
use super::report_results::is_png;
use super::{CliError, output};
use crate::capture::{Capture, disk};
use crate::difference::{self, Difference};
use crate::scene::Scene;
use crate::session::CaptureRequest;
use clap::Args;
use std::path::Path;

#[derive(Debug, Args)]
#[command(after_help = "Two capture folders:           stencilscope diff before after\n\
    Two techniques of a scene:     stencilscope diff tori -t z-pass -t z-fail\n\
    Two settings of one technique: stencilscope diff tori -t z-fail --set-b casters=light-facing\n\n\
    Exit code 0: every pass and pixel is the same; 1: something differs.")]
pub struct DiffArguments {
    /// A capture folder; or a built-in scene, a scene file (.toml) or a model (.obj, .ply, .gltf, .glb)
    #[arg(value_name = "A")]
    first: String,
    /// The other capture folder
    #[arg(
        value_name = "B",
        conflicts_with_all = [
            "no_floor", "z_up", "eye", "eye_spherical", "frustum", "viewport", "target", "up", "fov", "near", "far", "light", "sun", "off", "time",
            "technique", "set", "set_a", "set_b", "size", "every", "adapter",
        ]
    )]
    second: Option<String>,
    #[command(flatten)]
    scene_options: SceneOptions,
    /// How shadows are made, of A and of B; only one, to compare its settings [default: the scene's, else auto]
    #[arg(short, long, value_name = "NAME")]
    technique: Vec<String>,
    /// A setting of both; repeatable
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    set: Vec<(String, String)>,
    /// A setting of A alone; repeatable
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    set_a: Vec<(String, String)>,
    /// A setting of B alone; repeatable
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    set_b: Vec<(String, String)>,
    /// Width and height of the pictures
    #[arg(long, value_name = "WxH", value_parser = picture_size, default_value = "1280x720")]
    size: [u32; 2],
    /// How often to snapshot
    #[arg(long, value_name = "pass|draw", default_value = "pass")]
    every: String,
    /// A part of the GPU's name; `llvmpipe` is the software one [default: the best]
    #[arg(long, value_name = "SUBSTRING")]
    adapter: Option<String>,
    /// Machine-readable, to a file or to standard output in place of the text
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    json: Option<Option<String>>,
    /// A picture of the first pass whose pixels differ: A, B, and where they differ
    #[arg(short, long, value_name = "FILE.png", value_parser = picture_file)]
    output: Option<String>,
}

/// Compares two captures and says where they differ.
///
/// # Errors
/// A folder, scene, technique or setting that can't be used; pictures that can't be compared; no GPU;
/// [`CliError::Different`].
pub fn run(arguments: &DiffArguments) -> Result<(), CliError> {
    let json = arguments.json.as_ref().and_then(Option::as_deref);
    json.into_iter().chain(arguments.output.as_deref()).try_for_each(output::check_target)?;
    if json.is_some() && json == arguments.output.as_deref() {
        return Err(CliError::Usage("one file is named for two results: choose another file".to_owned()));
    }
    let [a, b] = match &arguments.second {
        Some(second) => [folder(&arguments.first)?, folder(second)?],
        None => techniques(arguments)?,
    };
    let difference = difference::compare(&a, &b)?;
    let pictured =
        arguments.output.as_deref().map_or(Ok(String::new()), |file| picture(&difference, [&a, &b], file))?;
    match &arguments.json {
        Some(_) => {
            let failed =
                |error: serde_json::Error| CliError::Output { path: "the difference".to_owned(), source: error.into() };
            output::deliver(&difference.to_json().map_err(failed)?, json)?;
        }
        None => output::print(&format!("{}{}{pictured}", heading(arguments, [&a, &b]), difference.to_text()))?,
    }
    match difference.first_place() {
        Some(place) => Err(CliError::Different { place }),
        None => Ok(()),
    }
}

fn folder(name: &str) -> Result<Capture, CliError> {
    let path = Path::new(name);
    if !disk::is_capture(path) {
        let what = match (path.is_dir(), path.exists()) {
            (true, _) => "it holds no manifest.json",
            (_, true) => "it is a file",
            (_, false) => "there is no such folder",
        };
        return Err(CliError::Usage(format!(
            "`{}` is no capture folder ({what}): name two folders, or one scene and two techniques (-t)",
            name.escape_debug()
        )));
    }
    Ok(disk::read(path)?)
}

/// Captures one scene with two techniques, or with one and different settings, as A and B. Fails where a capture folder
/// is named alone, more than two techniques are, or both choices are the same.
fn techniques(arguments: &DiffArguments) -> Result<[Capture; 2], CliError> {
    let name = &arguments.first;
    if disk::is_capture(Path::new(name)) {
        return Err(CliError::Usage(format!("`{}` is a capture folder: name the other one too", name.escape_debug())));
    }
    let [of_a, of_b] = match &arguments.technique[..] {
        [a, b] => [Some(a), Some(b)],
        [both] => [Some(both); 2],
        [] => [None; 2],
        more => {
            return Err(CliError::Usage(format!("{} techniques are named: name two (-t A -t B)", more.len())));
        }
    };
    let scene = arguments.scene_options.open(name)?;
    let requests =
        [request(arguments, &scene, of_a, &arguments.set_a)?, request(arguments, &scene, of_b, &arguments.set_b)?];
    if requests[0].choice == requests[1].choice {
        let technique = requests[0].choice.technique().name();
        return Err(CliError::Usage(format!(
            "both are {technique} with the same settings: name two techniques (-t A -t B), or change a setting of one \
             (--set-b KEY=VALUE)"
        )));
    }
    let mut session = open_session(arguments.adapter.as_deref())?;
    let [a, b] = requests;
    Ok([session.capture(&scene, &a)?, session.capture(&scene, &b)?])
}

fn request(
    arguments: &DiffArguments,
    scene: &Scene,
    technique: Option<&String>,
    own: &[(String, String)],
) -> Result<CaptureRequest, CliError> {
    let frame = FrameOptions {
        technique: technique.cloned(),
        set: arguments.set.iter().chain(own).cloned().collect(),
        size: Some(arguments.size),
        every: arguments.every.clone(),
        adapter: arguments.adapter.clone(),
        external_capture: false,
    };
    frame.request(scene)
}

/// Returns two lines that say what A and B are: scene, technique, size and passes, with the folder's name where two
/// folders are compared.
fn heading(arguments: &DiffArguments, captures: [&Capture; 2]) -> String {
    let folders = [Some(&arguments.first), arguments.second.as_ref()];
    let line = |(side, (folder, capture)): (&str, (Option<&String>, &Capture))| {
        let folder = folder.filter(|_| arguments.second.is_some()).map_or_else(String::new, |name| format!("{name}: "));
        let Capture { scene, technique, size: [width, height], .. } = capture;
        format!("{side}  {folder}{scene}, {technique}, {width}x{height}, {} passes\n", capture.steps.len())
    };
    ["A", "B"].into_iter().zip(folders.into_iter().zip(captures)).map(line).collect()
}

/// Writes a PNG of A, of B and of where they differ to `file`, and returns a line about it for the user. Writes nothing
/// where no pixel differs, and the line says so.
fn picture(difference: &Difference, [a, b]: [&Capture; 2], file: &str) -> Result<String, CliError> {
    let Some(shown) = difference.shown(a, b) else {
        return Ok("no picture: no pixel that both have differs\n".to_owned());
    };
    let failed = |error: png::EncodingError| CliError::Output {
        path: file.to_owned(),
        source: std::io::Error::other(error.to_string()),
    };
    output::write(file, &shown.picture.to_png().map_err(failed)?)?;
    Ok(format!(
        "{file}: {} of A, of B, and where they differ (bright; the frame is around the largest region)\n",
        shown.aspect.title()
    ))
}

/// Parses the path of a picture file.
fn picture_file(text: &str) -> Result<String, String> {
    if is_png(text) { Ok(text.to_owned()) } else { Err("give a file that ends in .png".to_owned()) }
}

//! `stencilscope pixel`: what happened to a pixel, fragment by fragment.

use super::options::{FrameOptions, SceneOptions, Subject, open_session, pixel};
use super::{CliError, output};
use crate::capture::Capture;
use crate::history::{PixelDocument, PixelHistory};
use crate::plan::LightId;
use crate::reading::coordinates::{PixelCoordinates, VertexPlaces};
use crate::reading::light_rays::{LightRay, RayFollower};
use crate::reading::shading::SurfaceShading;
use crate::reading::steps;
use crate::reading::texels_read::{TexelReaders, TexelsRead};
use crate::session::{FrameSource, RunFrame, SessionError};
use clap::Args;
use serde::Serialize;
use std::time::Instant;

#[derive(Debug, Args)]
pub struct PixelArguments {
    /// A built-in scene, a scene file (.toml), a model (.obj, .ply, .gltf, .glb) or a capture folder
    scene: String,
    /// Column and row from the top left; repeatable
    #[arg(long, value_name = "X,Y", value_parser = pixel, required_unless_present = "vertex")]
    at: Vec<[u32; 2]>,
    /// In place of a pixel, a vertex of an object's mesh, counted from 0 as corners first name it, equal places once, in world, eye, clip, device and window
    /// coordinates with the matrices between them; repeatable
    #[arg(long, value_name = "OBJECT:INDEX", conflicts_with_all = ["at", "coordinates"])]
    vertex: Vec<String>,
    #[command(flatten)]
    scene_options: SceneOptions,
    #[command(flatten)]
    frame: FrameOptions,
    /// Also the pixel's point and the corners of its triangle in world, eye, clip, device and window coordinates, with the
    /// matrices between them; not of another program's frame, whose camera is a guess
    #[arg(long)]
    coordinates: bool,
    /// Machine-readable, to a file or to standard output in place of the text
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    json: Option<Option<String>>,
}

/// Renders the scene once, or takes the frame of a folder, and prints the history of each pixel. Where there is no GPU, a
/// folder's histories are computed on the CPU.
///
/// # Errors
/// A scene, option or pixel that can't be used; no GPU for a scene; a file that can't be written;
/// [`CliError::WrongHistory`].
pub fn run(arguments: &PixelArguments) -> Result<(), CliError> {
    arguments.frame.refuse_draws("a history always goes fragment by fragment")?;
    let subject = Subject::new(&arguments.scene, &arguments.scene_options, &arguments.frame)?;
    let size = subject.size();
    if let Some(pixel) = arguments.at.iter().find(|[x, y]| *x >= size[0] || *y >= size[1]) {
        return Err(SessionError::NoSuchPixel { pixel: *pixel, size }.into());
    }
    let file = arguments.json.as_ref().and_then(Option::as_deref);
    file.map_or(Ok(()), output::check_target)?;
    let adapter = arguments.frame.adapter.as_deref();
    let (frame, mut session) = match subject {
        Subject::Folder(frame) => match open_session(adapter) {
            Err(error) if error.is_missing_adapter() && adapter.is_none() => (frame, None),
            opened => (frame, Some(opened?)),
        },
        scene => {
            let mut session = open_session(adapter)?;
            (scene.frame(&mut session)?, Some(session))
        }
    };
    let RunFrame { capture, plan, source } = frame;
    let has_vertices = !arguments.vertex.is_empty();
    if (arguments.coordinates || has_vertices) && capture.origin.is_some() {
        let option = if has_vertices { "--vertex" } else { "--coordinates" };
        let why = format!("`{option}` needs the frame's camera, and another program's is a guess: leave it out");
        return Err(CliError::Usage(why));
    }
    if has_vertices {
        return vertices(arguments, &capture, source.as_deref(), file);
    }
    let mut stories = vec![format!("{}, {}, {}x{}\n", capture.scene, capture.technique, size[0], size[1])];
    for (light, counted) in capture.lights.iter().enumerate().filter_map(|(at, light)| Some((at, light.count_of?))) {
        stories[0] += &format!("{}: {}\n", LightId(light).name(), counted.meaning());
    }
    if session.is_none() {
        stories[0] += "No GPU could be used: the program's own rasteriser made the fragments.\n";
    }
    let readers = TexelReaders::new(&capture, &plan);
    // Of another program's frame, the scene is what its draws reveal: rays in it prove nothing.
    let own_scene = source.as_deref().filter(|source| source.request.is_some());
    let follower = own_scene.map(|source| RayFollower::new(&source.scene, size));
    let untraced = match &follower {
        Some(Err(error)) => format!("  no light can be followed by rays: {error}\n"),
        _ => String::new(),
    };
    let follower = follower.and_then(Result::ok);
    let mut documents = Vec::with_capacity(arguments.at.len());
    let mut wrong = 0;
    for pixel in &arguments.at {
        let start = Instant::now();
        let history = match &mut session {
            Some(session) => session.history(&plan, &capture, *pixel)?,
            None => PixelHistory::without_gpu(&plan, &capture, *pixel),
        };
        let took = start.elapsed().as_secs_f64() * 1e3;
        wrong += usize::from(!history.agrees() && history.unknown_discard().is_none());
        let shading = SurfaceShading::of(&capture, &plan, &history);
        let texels = readers.at(&capture, *pixel);
        let read = texels.iter().enumerate().filter_map(|(light, read)| Some(read.as_ref()?.text(light)));
        let rays = follower.as_ref().map(|follower| follower.at(*pixel));
        let met = rays.iter().flatten().map(LightRay::text).chain([untraced.clone()]);
        let reasons = met.chain(read).chain(shading.as_ref().map(SurfaceShading::text)).collect::<String>();
        stories.push(history.story_with(&capture.depth, &reasons, |pass| steps::number(&capture, pass)));
        let place = || PixelCoordinates::of(&capture, *pixel).with_vertices(&capture, &plan, &history);
        let coordinates = arguments.coordinates.then(place);
        stories.extend(coordinates.as_ref().map(PixelCoordinates::text));
        documents.push(PixelOutput { history: PixelDocument::new(&history, took), texels, rays, shading, coordinates });
    }
    match (&arguments.json, &documents[..]) {
        (None, _) => output::print(&stories.join("\n"))?,
        (Some(_), [only]) => output::deliver(&json(only)?, file)?,
        (Some(_), all) => output::deliver(&json(all)?, file)?,
    }
    if wrong == 0 { Ok(()) } else { Err(CliError::WrongHistory { pixels: wrong }) }
}

/// Prints the coordinates of the vertices that `--vertex` names; with `--json` writes them as JSON to `file`, or prints
/// that where it is `None`. Fails where the frame's scene is not there (`source` is `None`).
fn vertices(
    arguments: &PixelArguments,
    capture: &Capture,
    source: Option<&FrameSource>,
    file: Option<&str>,
) -> Result<(), CliError> {
    let no_scene =
        || CliError::Usage("`--vertex` needs the frame's scene, which this folder has not: leave it out".to_owned());
    let scene = &source.ok_or_else(no_scene)?.scene;
    let places = VertexPlaces::of(capture, scene, &arguments.vertex);
    let places = places.map_err(|error| CliError::Usage(format!("--vertex: {error}")))?;
    match arguments.json {
        None => output::print(&places.text()),
        Some(_) => output::deliver(&json(&places)?, file),
    }
}

/// A history, the texels that decided each light, what the rays from the lights meet in truth, how the surface is shaded, and the coordinates of the pixel's point
/// if they were asked for.
#[derive(Debug, Serialize)]
struct PixelOutput {
    #[serde(flatten)]
    history: PixelDocument,
    texels: Vec<Option<TexelsRead>>,
    rays: Option<Vec<LightRay>>,
    shading: Option<SurfaceShading>,
    #[serde(skip_serializing_if = "Option::is_none")]
    coordinates: Option<PixelCoordinates>,
}

fn json<T: Serialize + ?Sized>(value: &T) -> Result<String, CliError> {
    let text = serde_json::to_string_pretty(value);
    let failed = |error: serde_json::Error| CliError::Output { path: "the history".to_owned(), source: error.into() };
    Ok(text.map_err(failed)? + "\n")
}

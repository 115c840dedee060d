//! `stencilscope animate`: a frame pass by pass, a light that moves round the scene, or an eye that moves a little, as an
//! animated PNG.

use super::options::{FrameOptions, SceneOptions, Subject, open_session};
use super::progress::with_bar;
use super::{CliError, output};
use crate::film::{EyeMove, Film, FilmContent, FilmMotion, LightRound, PLACES};
use crate::picture::apng::ColorDepth;
use crate::progress::Progress;
use crate::reading::format;
use crate::scene::Scene;
use crate::session::{CaptureRequest, Session};
use clap::Args;
use std::path::Path;
use std::sync::Arc;

/// The least number of the light's positions in an animation: fewer make no way round.
const FEWEST_PLACES: u32 = 2;
const MOST_PLACES: u32 = 3600;
/// The shortest time for which a picture is shown, milliseconds: viewers show faster animations at a speed of their
/// own.
const LEAST_MILLISECONDS: u16 = 20;
const MOST_MILLISECONDS: u16 = 60_000;

#[derive(Debug, Args)]
#[command(
    after_help = "A frame pass by pass:      stencilscope animate tori -t z-fail --steps --size 640x480 -o steps.png\n\
    A light round the scene:   stencilscope animate tori --light-round --size 640x480 -o round.png\n\
    A map that swims:          stencilscope animate table --sun 0.4,1,0.3 -t shadow-map --set light-frustum=view --eye-moves -o swims.png\n\n\
    Browsers and most chats show animated PNG. Passes keep every value's colour; --light-round rounds colours, by at\n\
    most 1 of 255 a channel, unless --exact is given."
)]
pub struct AnimateArguments {
    /// A built-in scene, a scene file (.toml), a model (.obj, .ply, .gltf, .glb) or a capture folder
    scene: String,
    /// The file to make
    #[arg(short, long, value_name = "FILE.png")]
    output: String,
    /// Replace the file if it is there
    #[arg(long)]
    overwrite: bool,
    /// The frame, pass by pass, each with what it writes [default]
    #[arg(long, conflicts_with = "motion")]
    steps: bool,
    /// A light once round the scene's vertical axis, in N pictures [default N: 24]
    #[arg(long, value_name = "N", num_args = 0..=1, value_parser = places, group = "motion")]
    light_round: Option<Option<u32>>,
    /// The eye a little to its right from picture to picture, in N of them [default N: 24]: what crawls does not stand
    /// still
    #[arg(long, value_name = "N", num_args = 0..=1, value_parser = places, group = "motion")]
    eye_moves: Option<Option<u32>>,
    /// Which light goes round, counted from 1
    #[arg(long, value_name = "K", default_value_t = 1, requires = "light_round",
        value_parser = clap::value_parser!(u16).range(1..))]
    which_light: u16,
    /// Keep colours to the bit: a larger file
    #[arg(long, requires = "motion")]
    exact: bool,
    /// How long each picture is shown [default: 1500 a pass, 100 a place of the light]
    #[arg(long, value_name = "MILLISECONDS", value_parser = milliseconds, allow_hyphen_values = true)]
    delay: Option<u16>,
    #[command(flatten)]
    scene_options: SceneOptions,
    #[command(flatten)]
    frame: FrameOptions,
}

fn places(text: &str) -> Result<u32, String> {
    let places = text.parse().ok().filter(|places| (FEWEST_PLACES..=MOST_PLACES).contains(places));
    places.ok_or_else(|| format!("give a whole number of pictures from {FEWEST_PLACES} to {MOST_PLACES}"))
}

fn milliseconds(text: &str) -> Result<u16, String> {
    let range = LEAST_MILLISECONDS..=MOST_MILLISECONDS;
    let milliseconds = text.parse().ok().filter(|milliseconds| range.contains(milliseconds));
    milliseconds
        .ok_or_else(|| format!("give a whole number of milliseconds from {LEAST_MILLISECONDS} to {MOST_MILLISECONDS}"))
}

/// Runs the command `animate`: writes the passes of a frame, or with `--light-round` a light's way round the scene, as
/// an animated PNG, and prints what it shows.
pub fn run(arguments: &AnimateArguments) -> Result<(), CliError> {
    check_target(&arguments.output, arguments.overwrite)?;
    let refused = "an animation shows whole passes";
    arguments.frame.refuse_draws(refused)?;
    arguments.frame.refuse_external_capture(refused)?;
    let subject = Subject::new(&arguments.scene, &arguments.scene_options, &arguments.frame)?;
    let mut session = LazySession { adapter: arguments.frame.adapter.as_deref(), session: None };
    let is_moving = arguments.light_round.is_some() || arguments.eye_moves.is_some();
    let (name, shows) = match is_moving {
        false => {
            let capture = steps(subject, &mut session)?;
            (format!("{}, {}", capture.scene, capture.technique), FilmContent::Steps(vec![capture]))
        }
        true => {
            let (scene, request) = made(&arguments.scene, &subject)?;
            let name = format!("{}, {}", scene.name, request.choice.technique().name());
            let light = usize::from(arguments.which_light) - 1;
            let motion = match (arguments.light_round, arguments.eye_moves) {
                (None, Some(places)) => FilmMotion::EyeMove(EyeMove::new(scene.clone(), places.unwrap_or(PLACES))),
                (places, _) => {
                    let places = places.flatten().unwrap_or(PLACES);
                    FilmMotion::LightRound(LightRound::new(scene.clone(), light, places)?)
                }
            };
            let colors = if arguments.exact { ColorDepth::Exact } else { ColorDepth::Rounded };
            let sides = vec![request.clone()];
            (name, FilmContent::Moving { motion: Box::new(motion), sides, has_captions: false, colors })
        }
    };
    let [width, height] = shows.size();
    let (pictures, delay) = (shows.pictures(), arguments.delay.unwrap_or(shows.milliseconds()));
    let mut film = Film::begin(shows, Path::new(&arguments.output), delay)?;
    with_bar("pictures", &Progress::default(), |progress| -> Result<(), CliError> {
        progress.start(pictures as usize);
        while pollster::block_on(film.shoot(async |scene, request| session.get()?.capture(scene, request)))? {
            progress.advance();
        }
        Ok(())
    })?;
    let bytes = format::bytes(film.finish()?);
    let output = &arguments.output;
    output::print(&format!("{output}: {name}, {width}x{height}, {pictures} pictures of {delay} ms, {bytes}\n"))
}

/// Fails, before long work, where the file's extension is neither png nor apng, its folder is missing, or it exists and
/// `overwrite` is false.
fn check_target(file: &str, overwrite: bool) -> Result<(), CliError> {
    let name = file.escape_debug();
    let ending = Path::new(file).extension().unwrap_or_default().to_ascii_lowercase();
    if ending != "png" && ending != "apng" {
        return Err(CliError::Usage(format!("`{name}`: animations are PNG files: give it a name that ends in .png")));
    }
    output::check_target(file)?;
    if Path::new(file).exists() && !overwrite {
        return Err(CliError::Usage(format!("`{name}` is there already: choose another file, or add --overwrite")));
    }
    Ok(())
}

/// A session that opens the GPU on first use: a frame from a folder needs none.
struct LazySession<'a> {
    adapter: Option<&'a str>,
    session: Option<Session>,
}

impl LazySession<'_> {
    fn get(&mut self) -> Result<&mut Session, crate::session::SessionError> {
        match &mut self.session {
            Some(session) => Ok(session),
            none => Ok(none.insert(open_session(self.adapter)?)),
        }
    }
}

fn steps(subject: Subject, gpu: &mut LazySession) -> Result<Arc<crate::capture::Capture>, CliError> {
    match subject {
        Subject::Folder(frame) => Ok(frame.capture),
        scene @ Subject::Scene(_) => Ok(scene.frame(gpu.get()?)?.capture),
    }
}

/// Returns the scene and capture request that the subject's frame is rendered from. Fails for a folder whose frame has
/// none, such as another program's; `name` names it in the error.
fn made<'a>(name: &str, subject: &'a Subject) -> Result<(&'a Scene, &'a CaptureRequest), CliError> {
    match subject {
        Subject::Scene(scene) => Ok((&scene.scene, &scene.request)),
        Subject::Folder(frame) => {
            frame.made().map_err(|reason| CliError::Usage(format!("`{name}`: {reason}: --steps shows it pass by pass")))
        }
    }
}

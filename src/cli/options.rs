//! Options that several commands have, and how their values are parsed.

use super::{CliError, output};
use crate::capture::disk;
use crate::import::ShippedFrame;
use crate::link::lights_of;
pub use crate::link::{edges, finite, picture_size, pixel, point, setting, spherical, viewport};
use crate::scene::{
    CameraChange, Light, OpenSpec, Projection, Scene, Spherical, TechniqueRequest, UpAxis, is_model, open,
};
use crate::session::{CaptureRequest, MotionFrames, MovingPart, RunFrame, Session, SessionError, SnapshotInterval};
use crate::technique::{Choice, Technique};
use clap::Args;
use glam::DVec3;
use std::collections::BTreeMap;
use std::path::Path;

/// Width and height of the picture in pixels where the command line names no size.
const DEFAULT_SIZE: [u32; 2] = [1280, 720];

/// Opens a session on the GPU whose name contains `adapter` (in any case), or on the fastest kind; says on standard error
/// which adapters gave no device.
pub fn open_session(adapter: Option<&str>) -> Result<Session, SessionError> {
    let session = Session::new(adapter)?;
    session.passed_over().for_each(|warning| output::note(&warning));
    Ok(session)
}

/// How a scene is completed, seen and lit.
#[derive(Debug, Clone, Args)]
pub struct SceneOptions {
    /// Leave out the floor under a bare model
    #[arg(long)]
    pub no_floor: bool,
    /// The z axis of a bare model is up, not y: it is turned
    #[arg(long)]
    pub z_up: bool,
    /// The eye's place
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub eye: Option<DVec3>,
    /// The eye's place about its target: distance, azimuth from +z towards +x and elevation in degrees, in place of --eye
    #[arg(long, value_name = "R,THETA,PHI", value_parser = spherical, allow_hyphen_values = true)]
    pub eye_spherical: Option<Spherical>,
    /// The point in the middle of the picture
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub target: Option<DVec3>,
    /// What is up
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub up: Option<DVec3>,
    /// Vertical field of view
    #[arg(long, value_name = "DEGREES", value_parser = finite, allow_hyphen_values = true)]
    pub fov: Option<f64>,
    /// The picture's edges on the near plane, metres from the view's axis: an off-centre perspective, as glFrustum
    #[arg(long, value_name = "L,R,B,T", value_parser = edges, allow_hyphen_values = true)]
    pub frustum: Option<[f64; 4]>,
    /// The part of the picture that is drawn into, shares of its width and height (glViewport) [default: 0,0,1,1]
    #[arg(long, value_name = "LEFT,TOP,WIDTH,HEIGHT", value_parser = viewport, allow_hyphen_values = true)]
    pub viewport: Option<[f64; 4]>,
    /// Distance of the near plane
    #[arg(long, value_name = "N", value_parser = finite, allow_hyphen_values = true)]
    pub near: Option<f64>,
    /// Distance of the far plane
    #[arg(long, value_name = "F", value_parser = finite, allow_hyphen_values = true)]
    pub far: Option<f64>,
    /// A point light in place of the scene's lights; repeatable
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub light: Vec<DVec3>,
    /// A directional light, towards it, in place of the scene's lights, after all of --light; repeatable
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub sun: Vec<DVec3>,
    /// A light that is switched off, counted as sentences count, from 1; repeatable
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub off: Vec<u32>,
    /// The moment of an animated scene; `report` also takes frames from A to B, A..B[:N], and counts the set-up of each
    #[arg(long, value_name = "SECONDS", value_parser = when, default_value = "0", allow_hyphen_values = true)]
    time: SceneTime,
}

/// The time or times in seconds at which a scene is rendered.
#[derive(Debug, Clone, Copy, PartialEq)]
enum SceneTime {
    /// One time, seconds.
    At(f64),
    /// From one time to another, seconds, in so many frames.
    Moving { from: f64, to: f64, frames: Option<usize> },
}

/// The largest number of frames that a range of times may have.
const MOST_FRAMES: usize = 10_000;

/// Parses `--time`: `SECONDS`, or a range `A..B` or `A..B:N` with A less than B and N frames (from 1 to the most that
/// are allowed). An error says what to give.
fn when(text: &str) -> Result<SceneTime, String> {
    let Some((from, rest)) = text.split_once("..") else { return finite(text).map(SceneTime::At) };
    let (to, frames) = rest.split_once(':').map_or((rest, None), |(to, frames)| (to, Some(frames)));
    let frames = frames.map(|frames| frames.parse().ok().filter(|frames| (1..=MOST_FRAMES).contains(frames)));
    match (finite(from), finite(to), frames) {
        (Ok(from), Ok(to), None) if from < to => Ok(SceneTime::Moving { from, to, frames: None }),
        (Ok(from), Ok(to), Some(Some(frames))) if from < to => Ok(SceneTime::Moving { from, to, frames: Some(frames) }),
        _ => Err(format!("give seconds from low to high, and maybe frames from 1 to {MOST_FRAMES}, as `0..2:30`")),
    }
}

/// How the picture is made.
#[derive(Debug, Clone, Args)]
pub struct FrameOptions {
    /// How shadows are made [default: the scene's, else auto]
    #[arg(short, long, value_name = "NAME")]
    pub technique: Option<String>,
    /// A setting of the technique; repeatable
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    pub set: Vec<(String, String)>,
    /// Width and height of the picture [default: 1280x720]
    #[arg(long, value_name = "WxH", value_parser = picture_size)]
    pub size: Option<[u32; 2]>,
    /// How often to snapshot
    #[arg(long, value_name = "pass|draw", default_value = "pass")]
    pub every: String,
    /// A part of the GPU's name; `llvmpipe` is the software one [default: the best]
    #[arg(long, value_name = "SUBSTRING")]
    pub adapter: Option<String>,
    /// Bracket the frame for an attached graphics debugger
    #[arg(long)]
    pub external_capture: bool,
}

impl SceneOptions {
    /// Returns how to open the scene again without these options, floor and up axis excepted.
    pub fn spec(&self, name: &str) -> OpenSpec {
        let up = if self.z_up { UpAxis::Z } else { UpAxis::Y };
        OpenSpec { name: name.to_owned(), floor: !self.no_floor, up }
    }

    /// Returns whether none of these options was given; a time of 0 counts as not given, any other as a change.
    fn is_untouched(&self) -> bool {
        let SceneOptions {
            no_floor,
            z_up,
            eye,
            eye_spherical,
            target,
            up,
            fov,
            frustum,
            viewport,
            near,
            far,
            light,
            sun,
            off,
            time,
        } = self;
        let points = [eye, target, up].iter().all(|point| point.is_none());
        let is_unplaced = eye_spherical.is_none() && frustum.is_none() && viewport.is_none();
        let numbers = [fov, near, far].iter().all(|number| number.is_none());
        !no_floor
            && !z_up
            && points
            && is_unplaced
            && numbers
            && light.is_empty()
            && sun.is_empty()
            && off.is_empty()
            && *time == SceneTime::At(0.0)
    }

    /// Opens the scene and applies these options; the result is at `--time`, without motions.
    pub fn open(&self, name: &str) -> Result<Scene, CliError> {
        Ok(self.load(name)?.at(self.seconds()?))
    }

    /// Returns the single time at which scenes are rendered, in seconds; an error where `--time` gave a range.
    pub fn seconds(&self) -> Result<f64, CliError> {
        match self.time {
            SceneTime::At(seconds) => Ok(seconds),
            SceneTime::Moving { .. } => {
                Err(CliError::Usage("`--time A..B` is for `report`: give one moment, in seconds".to_owned()))
            }
        }
    }

    /// Returns the frames of a motion, `usual` many where `--time A..B` gave no number; `None` where one time, or none,
    /// was given.
    pub fn motion_frames(&self, moves: MovingPart, usual: usize) -> Option<MotionFrames> {
        match self.time {
            SceneTime::At(_) => None,
            SceneTime::Moving { from, to, frames } => {
                Some(MotionFrames { moves, from, to, frames: frames.unwrap_or(usual) })
            }
        }
    }

    /// Opens the scene and applies these options' camera and lights; the result is at time 0 with all motions, whatever
    /// `--time` says. Given lights replace all of the scene's. Fails for options that don't apply, such as `--z-up` for
    /// no bare model.
    pub fn load(&self, name: &str) -> Result<Scene, CliError> {
        let scene = open(&self.spec(name))?;
        if self.z_up && !is_model(name) {
            let fix = "leave it out, or turn its objects in a scene file (`rotate_degrees`)";
            return Err(CliError::Usage(format!(
                "`--z-up` turns a bare model (.obj, .ply), and `{name}` is none: {fix}"
            )));
        }
        self.place(scene)
    }

    /// Returns a scene with the camera and the lights that these options ask for.
    pub fn place(&self, mut scene: Scene) -> Result<Scene, CliError> {
        self.place_camera(&mut scene)?;
        self.place_lights(&mut scene)?;
        Ok(scene)
    }

    fn place_camera(&self, scene: &mut Scene) -> Result<(), CliError> {
        let camera = &mut scene.camera;
        if self.fov.is_some() && self.frustum.is_some() {
            let reason = "`--fov` and `--frustum` both say how wide the picture is: leave one out";
            return Err(CliError::Usage(reason.to_owned()));
        }
        if self.fov.is_some() && camera.projection != Projection::Perspective {
            let name = match camera.projection {
                Projection::Frustum { .. } => "an off-centre frustum",
                parallel => parallel.name(),
            };
            let reason = format!("--fov: the scene's camera is {name} and has no field of view: leave it out");
            return Err(CliError::Usage(reason));
        }
        let change = CameraChange {
            eye: self.eye,
            eye_spherical: self.eye_spherical,
            target: self.target,
            up: self.up,
            fov_y_degrees: self.fov,
            frustum: self.frustum,
            viewport: self.viewport,
            near: self.near,
            far: self.far,
        };
        change.apply_to(camera).map_err(|reason| CliError::Usage(reason.to_owned()))
    }

    fn place_lights(&self, scene: &mut Scene) -> Result<(), CliError> {
        let points = self.light.iter().copied().map(Light::point);
        let lights: Vec<Light> = points.chain(self.sun.iter().copied().map(Light::directional)).collect();
        if let Some(reason) = lights.iter().find_map(|light| light.check().err()) {
            return Err(CliError::Usage(reason.to_owned()));
        }
        if !lights.is_empty() {
            scene.lights = lights;
        }
        let count = scene.lights.len();
        for number in &self.off {
            let Some(light) = scene.lights.get_mut(*number as usize - 1) else {
                let has = lights_of(count);
                return Err(CliError::Usage(format!(
                    "`--off {number}`: the scene has {has}: name one of them, or none"
                )));
            };
            light.is_on = false;
        }
        Ok(())
    }
}

/// The frame that a command works on: of a scene to be rendered, or stored in a folder.
pub enum Subject {
    /// A scene that is to be rendered.
    Scene(Box<SceneSubject>),
    /// The frame of a capture folder.
    Folder(RunFrame),
}

/// A scene, with the options by which it is rendered.
pub struct SceneSubject {
    /// The scene at time 0, with all motions.
    pub loaded: Scene,
    /// The scene at the time that was asked for.
    pub scene: Scene,
    /// How it is rendered, without timing.
    pub request: CaptureRequest,
}

impl Subject {
    /// Opens a scene, or a folder. Says on standard error what is left out of the scene's files.
    ///
    /// # Errors
    /// A scene, option or folder that can't be used; a folder that contains only pictures; options that would change
    /// its frame.
    pub fn new(name: &str, scene: &SceneOptions, frame: &FrameOptions) -> Result<Subject, CliError> {
        let folder = Path::new(name);
        let is_capture = disk::is_capture(folder);
        let shipped = ShippedFrame::named(name).filter(|_| !is_capture);
        if !is_capture && shipped.is_none() {
            let loaded = scene.load(name)?;
            output::note_left_out(name, &loaded, None);
            let at = loaded.at(scene.seconds()?);
            let request = frame.request(&at)?;
            return Ok(Subject::Scene(Box::new(SceneSubject { loaded, scene: at, request })));
        }
        if !scene.is_untouched() || frame.technique.is_some() || !frame.set.is_empty() || frame.size.is_some() {
            let fix = "leave its options out, or name its scene.toml in place of the folder";
            return Err(CliError::Usage(format!("`{name}` is a frame that was captured already: {fix}")));
        }
        let alone = "it holds no frame that this version can run: capture the scene again";
        let whole = RunFrame::from_folder(match shipped {
            Some(shipped) => shipped.open()?,
            None => disk::read_whole(folder)?,
        });
        whole.map(Subject::Folder).map_err(|_| CliError::Usage(format!("`{name}`: {alone}")))
    }

    /// Returns width and height of the picture in pixels: as requested for a scene, as stored for a folder.
    pub fn size(&self) -> [u32; 2] {
        match self {
            Subject::Scene(scene) => scene.request.size,
            Subject::Folder(frame) => frame.plan.size,
        }
    }

    /// Returns the frame: rendered now, or as it was stored.
    pub fn frame(self, session: &mut Session) -> Result<RunFrame, CliError> {
        match self {
            Subject::Scene(scene) => Ok(session.render(scene.scene, scene.request)?),
            Subject::Folder(frame) => Ok(frame),
        }
    }

    /// Returns the scene from which the frame is rendered, and how. Of a folder, `loaded` and `scene` are the same.
    /// Fails for a folder whose frame has no scene or known technique.
    pub fn scene(self) -> Result<SceneSubject, CliError> {
        match self {
            Subject::Scene(scene) => Ok(*scene),
            Subject::Folder(frame) => {
                let (scene, request) = frame.made()?;
                Ok(SceneSubject { loaded: scene.clone(), scene: scene.clone(), request: request.clone() })
            }
        }
    }
}

impl FrameOptions {
    /// Returns what to capture of `scene`: technique, settings, size and snapshots as the options say, else the
    /// scene's, else the defaults. Without timing.
    pub fn request(&self, scene: &Scene) -> Result<CaptureRequest, CliError> {
        Ok(CaptureRequest {
            every: self.every()?,
            external_capture: self.external_capture,
            ..CaptureRequest::new(self.choice(scene)?, self.picture_size())
        })
    }

    /// Returns width and height of the picture, pixels.
    pub fn picture_size(&self) -> [u32; 2] {
        self.size.unwrap_or(DEFAULT_SIZE)
    }

    /// Returns the technique of the command line, else the scene's, else the default. The scene's settings apply to the
    /// scene's technique only.
    fn choice(&self, scene: &Scene) -> Result<Choice, CliError> {
        Ok(Choice::for_scene(scene, self.technique.as_deref(), self.set.iter().cloned())?)
    }

    /// Fails where `--every draw` (or an invalid value) is given, for a command that can't use it; `why` explains it in
    /// the error.
    pub fn refuse_draws(&self, why: &str) -> Result<(), CliError> {
        match self.every()? {
            SnapshotInterval::Pass => Ok(()),
            SnapshotInterval::Draw => {
                Err(CliError::Usage(format!("`--every draw` is for captures; {why}: leave it out")))
            }
        }
    }

    /// Fails where `--external-capture` is given, for a command that does not render exactly one frame; `why` explains
    /// it in the error.
    pub fn refuse_external_capture(&self, why: &str) -> Result<(), CliError> {
        if self.external_capture {
            return Err(CliError::Usage(format!("`--external-capture` is for captures; {why}: leave it out")));
        }
        Ok(())
    }

    fn every(&self) -> Result<SnapshotInterval, CliError> {
        match self.every.as_str() {
            "pass" => Ok(SnapshotInterval::Pass),
            "draw" => Ok(SnapshotInterval::Draw),
            _ => Err(CliError::Usage("`--every` takes `pass` or `draw`: choose one".to_owned())),
        }
    }
}

/// Returns the technique of this name, or an error that lists the names.
pub fn technique_named(name: &str) -> Result<Technique, CliError> {
    let request = TechniqueRequest { name: name.to_owned(), settings: BTreeMap::new() };
    Ok(Choice::parse(&request)?.technique())
}

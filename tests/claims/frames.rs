//! The frames whose sentences are checked, and what their GPU left.

use crate::common::{opened, request};
use std::sync::Arc;
use stencilscope::capture::{Capture, Step};
use stencilscope::history::PixelHistory;
use stencilscope::plan::{FramePlan, Pass};
use stencilscope::reading::map_readers::MapReaders;
use stencilscope::scene::builtin;
use stencilscope::scene::{Projection, Scene};
use stencilscope::session::Session;
use stencilscope::technique::{SettingSpec, SettingValues, Technique};

const SIZE: [u32; 2] = [80, 60];
/// Its frame takes as long as ten others: it is checked with the defaults of a few techniques.
const LARGE: &str = "tiger-cage";

/// A frame to check.
pub struct Job {
    scene: &'static str,
    technique: Technique,
    settings: Vec<(&'static str, String)>,
    camera: Seen,
}

/// What a scene is seen by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Seen {
    /// Its own camera.
    AsItIs,
    /// The same place, with parallel view rays.
    Orthographic,
    /// The same place, with parallel view rays that are oblique to the picture.
    Cabinet,
    /// Parallel view rays, along the direction from the light's place to a caster: the ray through the light hits that.
    FromTheLight,
}

impl std::fmt::Display for Job {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} by {}", self.scene, self.technique.name())?;
        if self.camera != Seen::AsItIs {
            write!(f, ", {:?},", self.camera)?;
        }
        self.settings.iter().try_for_each(|(key, value)| write!(f, " {key}={value}"))
    }
}

impl Seen {
    fn place(self, scene: &mut Scene) {
        if self == Seen::FromTheLight {
            scene.camera.eye = scene.lights[0].position.truncate();
            let caster = scene.objects.iter().rfind(|object| object.casts).expect("a caster");
            let [a, b, c] = caster.mesh.triangles()[0].map(|corner| caster.world_positions()[corner as usize]);
            scene.camera.target = (a + b + c) / 3.0;
        }
        let half_height = scene.camera.half_height_at_target();
        scene.camera.projection = match self {
            Seen::AsItIs => Projection::Perspective,
            Seen::Orthographic | Seen::FromTheLight => Projection::Orthographic { half_height },
            Seen::Cabinet => Projection::Oblique { half_height, angle_degrees: 45.0, factor: 0.5 },
        };
    }
}

/// Values of a setting beside its default.
fn values(technique: Technique, spec: &SettingSpec) -> Vec<String> {
    let inside = |low: f64, high: f64| [3.0, 64.0, 1.0, 0.05].into_iter().find(|n| (low..=high).contains(n));
    let values: Vec<String> = match spec.values {
        SettingValues::OneOf(words) => words.iter().map(|word| (*word).to_owned()).collect(),
        // Each of them where they are decided about, else none of them.
        SettingValues::SomeOf(words) if technique == Technique::Auto => {
            words.iter().map(|word| (*word).to_owned()).chain(["none".to_owned()]).collect()
        }
        SettingValues::SomeOf(_) => vec!["none".to_owned()],
        SettingValues::Integer(low, high) => vec![64.clamp(low, high).to_string()],
        SettingValues::Number(low, high) => inside(low, high).map(|n| n.to_string()).into_iter().collect(),
        SettingValues::WordOrFrustum(words) => words.iter().copied().chain(["60:0.5:30"]).map(str::to_owned).collect(),
        // At the end of all, so that the others keep their scenes.
        SettingValues::DepthRange => Vec::new(),
        SettingValues::Receivers(_) => ["share:0.01", "largest:3", "all"].map(str::to_owned).to_vec(),
        SettingValues::WordOr { words, prefix, low, high, .. } => {
            let number = inside(low, high).map(|n| format!("{prefix}{n}"));
            words.iter().map(|word| (*word).to_owned()).chain(number).collect()
        }
    };
    values.into_iter().filter(|value| value != spec.default).collect()
}

/// Every technique in every scene, and every value of its settings in one: the next, each time.
pub fn jobs() -> Vec<Job> {
    let scenes: Vec<&str> = builtin::ALL.iter().map(|builtin| builtin.name).collect();
    let quick: Vec<&str> = scenes.iter().copied().filter(|name| *name != LARGE).collect();
    let mut jobs = Vec::new();
    for technique in Technique::ALL {
        for scene in &scenes {
            let is_slow = *scene == LARGE && technique != Technique::Auto;
            if !is_slow {
                jobs.push(job(scene, technique, Seen::AsItIs, &[]));
            }
        }
        for spec in technique.settings() {
            for value in values(technique, spec) {
                let scene = quick[jobs.len() % quick.len()];
                // What it changes only beside another.
                let beside: &[(&str, &str)] = match spec.key {
                    "epsilon" => &[("depth", "standard-infinite-epsilon")],
                    "far-vertices" => &[("extrusion", "finite:3")],
                    "order" => &[("faces", "two-pass")],
                    _ => &[],
                };
                jobs.push(job(scene, technique, Seen::AsItIs, &[beside, &[(spec.key, &value)]].concat()));
            }
        }
    }
    // Counts beyond eight bits, and both passes of faces in floats.
    let gate = |key, value| job("gate", Technique::ZFail, Seen::AsItIs, &[(key, value)]);
    jobs.extend([gate("counter", "float"), gate("operations", "clamp"), gate("faces", "two-pass")]);
    jobs.push(gate("stencil-bits", "4"));
    jobs.push(job("inside", Technique::ZPassPlus, Seen::AsItIs, &[("counter", "float")]));
    jobs.push(job("inside", Technique::ZPass, Seen::AsItIs, &[("faces", "two-pass")]));
    jobs.extend(parallel());
    let ranges = Technique::ALL.into_iter().zip(quick.iter().cycle());
    jobs.extend(ranges.map(|(technique, scene)| job(scene, technique, Seen::AsItIs, &[("depth-range", "0.2,0.9")])));
    jobs
}

fn job(scene: &'static str, technique: Technique, camera: Seen, settings: &[(&'static str, &str)]) -> Job {
    let settings = settings.iter().map(|(key, value)| (*key, (*value).to_owned())).collect();
    Job { scene, technique, settings, camera }
}

/// Parallel cameras: linear depth, and counts that begin elsewhere.
fn parallel() -> Vec<Job> {
    use Seen::{Cabinet, FromTheLight, Orthographic};
    vec![
        job("tori", Technique::ZFail, Orthographic, &[]),
        job("tori", Technique::Auto, Cabinet, &[]),
        job("inside", Technique::Auto, Orthographic, &[]),
        job("inside", Technique::ZPassPlus, Cabinet, &[]),
        job("two-lights", Technique::ZPass, Cabinet, &[]),
        job("table", Technique::ShadowMap, Orthographic, &[]),
        job("tori", Technique::ZFail, FromTheLight, &[]),
        job("tori", Technique::Auto, FromTheLight, &[]),
        job("tori", Technique::ZFail, FromTheLight, &[("counter", "float")]),
        job("tori", Technique::ZFail, FromTheLight, &[("faces", "two-pass"), ("depth", "standard-infinite")]),
        job("rings", Technique::ZFail, FromTheLight, &[("casters", "all")]),
        job("tori", Technique::ZFail, FromTheLight, &[("operations", "invert")]),
        job("tori", Technique::ZFail, FromTheLight, &[("stencil-bits", "1")]),
        job("tori", Technique::ZFail, FromTheLight, &[("stencil-bits", "2")]),
    ]
}

/// A frame with what is known of some of its pixels.
pub struct Frame {
    pub scene: Scene,
    pub capture: Capture,
    pub plan: Arc<FramePlan>,
    pub pixels: Vec<(PixelHistory, [u32; 2])>,
    pub readers: Vec<Option<MapReaders>>,
}

impl Frame {
    pub fn of(session: &mut Session, job: &Job) -> Frame {
        let mut scene = opened(job.scene);
        job.camera.place(&mut scene);
        let mut request = request(job.technique, SIZE);
        for (key, value) in &job.settings {
            request.choice.set(key, value).unwrap_or_else(|error| panic!("{job}: {error}"));
        }
        let (capture, plan) =
            session.capture_with_plan(&scene, &request).unwrap_or_else(|error| panic!("{job}: {error}"));
        let pixels = pixels(&capture);
        let pixels =
            pixels.into_iter().map(|at| (session.history(&plan, &capture, at).expect("a history"), at)).collect();
        let plan = Arc::new(plan);
        let readers = (0..capture.lights.len()).map(|light| MapReaders::new(&capture, Some(&plan), light)).collect();
        Frame { scene, capture, plan, pixels, readers }
    }

    /// Does the count begin at the volumes around the eye?
    pub fn starts_at_eye(&self) -> bool {
        self.plan.settings.get("start").is_some_and(|start| start == "eye-count")
    }

    pub fn step(&self, index: usize) -> (&Step, &Pass) {
        (&self.capture.steps[index], &self.plan.passes[index])
    }

    /// The stencil after a step; 0 before the first.
    pub fn stencil(&self, step: Option<usize>, at: [u32; 2]) -> Option<u8> {
        match step {
            None => Some(0),
            Some(step) => self.capture.frame_at(step)?.stencil.as_ref()?.image.byte_at(at),
        }
    }

    pub fn label(&self, light: usize, at: [u32; 2]) -> Option<u8> {
        self.capture.lights[light].shadow.as_ref()?.byte_at(at)
    }
}

/// One of each label of each light, and the picture's middle.
fn pixels(capture: &Capture) -> Vec<[u32; 2]> {
    let mut pixels = vec![[SIZE[0] / 2, SIZE[1] / 2]];
    for shadow in capture.lights.iter().filter_map(|light| light.shadow.as_ref()) {
        for label in 0..4 {
            // Not along the picture's border, and not always the first.
            let all = (5..SIZE[1]).step_by(7).flat_map(|y| (3..SIZE[0]).step_by(5).map(move |x| [x, y]));
            let of_label: Vec<[u32; 2]> = all.filter(|at| shadow.byte_at(*at) == Some(label)).collect();
            pixels.extend(of_label.get(of_label.len() / 3));
        }
    }
    pixels.sort_unstable();
    pixels.dedup();
    pixels
}

//! A view of a scene as the address of a page: `?scene=inside&technique=z-pass&step=2&pixel=330,300`.
//!
//! The words are those of the command line's options, and so are their values:
//!
//! ```text
//! scene=NAME  technique=NAME  set=KEY=VALUE (repeatable)  size=WxH  time=SECONDS
//! eye=X,Y,Z  target=X,Y,Z  up=X,Y,Z  fov=DEGREES  near=N  far=F      what differs of the scene's camera
//! eye-spherical=R,THETA,PHI  frustum=LEFT,RIGHT,BOTTOM,TOP           the same of it
//! viewport=LEFT,TOP,WIDTH,HEIGHT                                     the same, shares of the picture
//! light=N:X,Y,Z (repeatable)  off=N (repeatable)                     where light N is; switched off; from 1
//! step=N (an index, from 0)  pixel=X,Y  truth=1
//! ```

use crate::ask::{ObjectChanges, RunRequest};
use crate::scene::{CameraChange, Scene, Spherical};
use glam::{DVec3, DVec4};
use percent_encoding::{AsciiSet, CONTROLS, percent_decode_str, utf8_percent_encode};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// The largest width or height of a picture, pixels.
const LARGEST: u32 = 16_384;
/// What has another meaning in an address, or none.
const ENCODED: &AsciiSet = &CONTROLS.add(b' ').add(b'"').add(b'#').add(b'%').add(b'&').add(b'+').add(b'<').add(b'>');

/// Why an address can't be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LinkError {
    /// A key has no meaning.
    #[error("the link's `{0}` means nothing here: leave it out, or copy the link again")]
    Unknown(String),
    /// A value can't be used.
    #[error("the link's `{key}={value}` can't be used: {reason}")]
    Value {
        /// Its key.
        key: String,
        /// The value.
        value: String,
        /// What is wrong, and what to give.
        reason: String,
    },
}

/// What a link opens. What it does not name is as the scene has it, or as it is by default.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ViewLink {
    /// The scene, or recorded frame, by its built-in name.
    pub scene: Option<String>,
    /// The technique's name.
    pub technique: Option<String>,
    /// Settings of the technique.
    pub settings: BTreeMap<String, String>,
    /// Width and height of the picture, pixels.
    pub size: Option<[u32; 2]>,
    /// The time in an animated scene, seconds.
    pub time: Option<f64>,
    /// What is changed of the scene's camera.
    pub camera: CameraChange,
    /// Positions of lights, or directions of directional ones, by index.
    pub lights: BTreeMap<usize, DVec3>,
    /// Indices of the lights that are switched off.
    pub off: BTreeSet<usize>,
    /// Index of the step to select.
    pub step: Option<usize>,
    /// The pixel to pick.
    pub pixel: Option<[u32; 2]>,
    /// Show where the technique is wrong.
    pub truth: bool,
}

impl ViewLink {
    /// Reads an address from its `?` on, without it: what can be read, and what can't, each with its reason.
    pub fn parse(query: &str) -> (ViewLink, Vec<LinkError>) {
        let mut link = ViewLink::default();
        let mut problems = Vec::new();
        for part in query.split('&').filter(|part| !part.is_empty()) {
            let (key, value) = part.split_once('=').unwrap_or((part, ""));
            let [key, value] =
                [key, value].map(|text| percent_decode_str(&text.replace('+', " ")).decode_utf8_lossy().into_owned());
            match link.take(&key, &value) {
                Ok(true) => {}
                Ok(false) => problems.push(LinkError::Unknown(key)),
                Err(reason) => problems.push(LinkError::Value { key, value, reason }),
            }
        }
        (link, problems)
    }

    /// Takes a value in; returns false where its key has no meaning, and an error that says what to give.
    fn take(&mut self, key: &str, value: &str) -> Result<bool, String> {
        let index = |text: &str| text.parse().ok().and_then(|number: usize| number.checked_sub(1));
        match key {
            "scene" => self.scene = Some(value.to_owned()),
            "technique" => self.technique = Some(value.to_owned()),
            "set" => self.settings.extend([setting(value)?]),
            "size" => self.size = Some(picture_size(value)?),
            "time" => self.time = Some(finite(value)?),
            "eye" => self.camera.eye = Some(point(value)?),
            "eye-spherical" => self.camera.eye_spherical = Some(spherical(value)?),
            "frustum" => self.camera.frustum = Some(edges(value)?),
            "viewport" => self.camera.viewport = Some(viewport(value)?),
            "target" => self.camera.target = Some(point(value)?),
            "up" => self.camera.up = Some(point(value)?),
            "fov" => self.camera.fov_y_degrees = Some(finite(value)?),
            "near" => self.camera.near = Some(finite(value)?),
            "far" => self.camera.far = Some(finite(value)?),
            "light" => {
                let (number, position) = value.split_once(':').unwrap_or(("", value));
                let number = index(number).ok_or("give N:X,Y,Z, lights counted from 1")?;
                self.lights.insert(number, point(position)?);
            }
            "off" => self.off.extend([index(value).ok_or("give a light's number, from 1")?]),
            "step" => self.step = Some(value.parse().map_err(|_| "give a step's index, from 0")?),
            "pixel" => self.pixel = Some(pixel(value)?),
            "truth" => self.truth = value != "0",
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Returns the link to `scene`, which opens as `name`, run as `draft`; nothing is selected. Not everything that can be
    /// changed is part of a link: see [`ViewLink::lacks`].
    pub fn of_run(name: &str, scene: &Scene, draft: &RunRequest) -> ViewLink {
        let lights = || draft.lights.iter().zip(&scene.lights).enumerate();
        let moved = lights().filter(|(_, (light, before))| light.position != before.position);
        let off = lights().filter(|(_, (light, before))| !light.is_on && before.is_on);
        let choice = draft.choice.to_request();
        ViewLink {
            scene: Some(name.to_owned()),
            technique: Some(choice.name),
            settings: choice.settings,
            size: Some(draft.size),
            time: (draft.time != 0.0).then_some(draft.time),
            camera: CameraChange::between(&scene.camera, &draft.camera),
            lights: moved.map(|(index, (light, _))| (index, light.position.truncate())).collect(),
            off: off.map(|(index, _)| index).collect(),
            ..ViewLink::default()
        }
    }

    /// Returns what of `draft` the link to `scene` does not carry, in a few words; `None` where it carries all.
    pub fn lacks(&self, scene: &Scene, draft: &RunRequest) -> Option<&'static str> {
        let mut linked = scene.clone();
        let is_applied = self.apply_to(&mut linked).is_ok();
        if !is_applied || linked.lights != draft.lights {
            Some("what was changed of lights besides their places")
        } else if linked.camera != draft.camera {
            Some("what was changed of the camera's projection")
        } else if !draft.off.is_empty() || draft.objects != ObjectChanges::default() {
            Some("what was changed of objects")
        } else {
            None
        }
    }

    /// Changes a scene's camera and lights as the link says.
    ///
    /// # Errors
    /// A light that the scene does not have; a camera or a light that can't be used.
    pub fn apply_to(&self, scene: &mut Scene) -> Result<(), LinkError> {
        let invalid =
            |key: &str, value: String, reason: String| LinkError::Value { key: key.to_owned(), value, reason };
        let checked = self.camera.apply_to(&mut scene.camera);
        // Of what the link says of the camera, the least usual is named.
        let key = match &self.camera {
            CameraChange { viewport: Some(_), .. } => "viewport",
            CameraChange { frustum: Some(_), .. } => "frustum",
            CameraChange { eye_spherical: Some(_), .. } => "eye-spherical",
            _ => "eye",
        };
        checked.map_err(|reason| invalid(key, written(scene.camera.eye), reason.to_owned()))?;
        let count = scene.lights.len();
        let missing = |key: &str, index: usize| {
            invalid(key, (index + 1).to_string(), format!("the scene has {}: name one of them", lights_of(count)))
        };
        for (index, at) in &self.lights {
            let light = scene.lights.get_mut(*index).ok_or_else(|| missing("light", *index))?;
            light.position = DVec4::from((*at, light.position.w));
            light.check().map_err(|reason| invalid("light", written(*at), reason.to_owned()))?;
        }
        for index in &self.off {
            scene.lights.get_mut(*index).ok_or_else(|| missing("off", *index))?.is_on = false;
        }
        Ok(())
    }

    /// Returns the link as the part of an address from its `?` on, with it; empty where it names nothing.
    pub fn to_query(&self) -> String {
        let mut query = String::new();
        let mut add = |key: &str, value: String| {
            let start = if query.is_empty() { '?' } else { '&' };
            // Text takes whatever is written to it.
            let _ = write!(query, "{start}{key}={}", utf8_percent_encode(&value, ENCODED));
        };
        let pair = |[x, y]: [u32; 2], between: char| format!("{x}{between}{y}");
        self.scene.iter().for_each(|scene| add("scene", scene.clone()));
        self.technique.iter().for_each(|technique| add("technique", technique.clone()));
        self.settings.iter().for_each(|(key, value)| add("set", format!("{key}={value}")));
        self.size.iter().for_each(|size| add("size", pair(*size, 'x')));
        let CameraChange { eye, eye_spherical, target, up, fov_y_degrees, frustum, near, far, viewport } = self.camera;
        let numbers = [("time", self.time), ("fov", fov_y_degrees), ("near", near), ("far", far)];
        numbers.into_iter().for_each(|(key, number)| number.iter().for_each(|number| add(key, number.to_string())));
        let points = [("eye", eye), ("target", target), ("up", up)];
        points.into_iter().for_each(|(key, point)| point.iter().for_each(|point| add(key, written(*point))));
        if let Some(Spherical { r, theta_degrees, phi_degrees }) = eye_spherical {
            add("eye-spherical", format!("{r},{theta_degrees},{phi_degrees}"));
        }
        for (key, numbers) in [("frustum", frustum), ("viewport", viewport)] {
            numbers.iter().for_each(|[a, b, c, d]| add(key, format!("{a},{b},{c},{d}")));
        }
        self.lights.iter().for_each(|(index, at)| add("light", format!("{}:{}", index + 1, written(*at))));
        self.off.iter().for_each(|index| add("off", (index + 1).to_string()));
        self.step.iter().for_each(|step| add("step", step.to_string()));
        self.pixel.iter().for_each(|pixel| add("pixel", pair(*pixel, ',')));
        if self.truth {
            add("truth", "1".to_owned());
        }
        query
    }
}

/// Returns which lights a scene of so many has, in words.
pub fn lights_of(count: usize) -> String {
    match count {
        0 => "no light".to_owned(),
        1 => "light 1 alone".to_owned(),
        _ => format!("lights 1 to {count}"),
    }
}

/// Returns a point as [`point`] parses it, exactly.
fn written(at: DVec3) -> String {
    format!("{},{},{}", at.x, at.y, at.z)
}

/// Parses a point or vector `X,Y,Z` of three finite numbers; spaces around the numbers are allowed.
pub fn point(text: &str) -> Result<DVec3, String> {
    let numbers = text.split(',').map(|part| finite(part.trim())).collect::<Result<Vec<f64>, _>>()?;
    let [x, y, z] = numbers[..] else {
        return Err("give three numbers as X,Y,Z".to_owned());
    };
    Ok(DVec3::new(x, y, z))
}

/// Parses spherical coordinates `R,THETA,PHI` of an eye about its target, metres and degrees. Whether they are possible is
/// not checked.
pub fn spherical(text: &str) -> Result<Spherical, String> {
    let place = point(text).map_err(|_| "give three finite numbers as R,THETA,PHI".to_owned())?;
    Ok(Spherical { r: place.x, theta_degrees: place.y, phi_degrees: place.z })
}

/// Parses a frustum's edges `LEFT,RIGHT,BOTTOM,TOP`, metres on the near plane. Their order is not checked.
pub fn edges(text: &str) -> Result<[f64; 4], String> {
    four(text, "LEFT,RIGHT,BOTTOM,TOP")
}

/// Parses a viewport `LEFT,TOP,WIDTH,HEIGHT`, shares of the picture. Whether it is in the picture is not checked.
pub fn viewport(text: &str) -> Result<[f64; 4], String> {
    four(text, "LEFT,TOP,WIDTH,HEIGHT, shares of the picture from 0 to 1")
}

/// Parses four numbers with commas between them; the error says to give them as `form`.
fn four(text: &str, form: &str) -> Result<[f64; 4], String> {
    let numbers = text.split(',').map(|part| finite(part.trim())).collect::<Result<Vec<f64>, _>>();
    let four = numbers.ok().and_then(|numbers| <[f64; 4]>::try_from(numbers).ok());
    four.ok_or_else(|| format!("give four finite numbers as {form}"))
}

/// Parses a number; an error for NaN, infinity and text around the number, spaces included.
pub fn finite(text: &str) -> Result<f64, String> {
    let number: Option<f64> = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| "give finite numbers".to_owned())
}

/// Parses a picture size `WxH` in pixels, each from 1 to 16 384.
pub fn picture_size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X']).map(|(width, height)| [width.parse(), height.parse()]);
    match sides {
        Some([Ok(width), Ok(height)]) if [width, height].iter().all(|n| (1..=LARGEST).contains(n)) => {
            Ok([width, height])
        }
        _ => Err(format!("give WIDTHxHEIGHT, each a whole number from 1 to {LARGEST}")),
    }
}

/// Parses the column and row of a pixel, `X,Y`, counted from 0 at the top left. Whether it lies in the picture is not
/// checked.
pub fn pixel(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(',').map(|(x, y)| [x.trim().parse(), y.trim().parse()]);
    match sides {
        Some([Ok(x), Ok(y)]) => Ok([x, y]),
        _ => Err("give X,Y, counted from 0 at the top left".to_owned()),
    }
}

/// Splits `KEY=VALUE` at its first `=`. Fails without `=` or with an empty key; an empty value, and unknown keys, are
/// accepted.
pub fn setting(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.is_empty() => Ok((key.to_owned(), value.to_owned())),
        _ => Err("give KEY=VALUE".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Light, OpenSpec, open};
    use crate::technique::{Choice, Technique};

    #[test]
    fn a_link_opens_what_was_shared() {
        let mut scene = open(&OpenSpec::new("two-lights")).expect("a scene");
        let mut choice = Choice::new(Technique::ZFail);
        choice.set("casters", "light-facing").expect("a setting");
        let mut draft = RunRequest { time: 1.5, ..RunRequest::of(&scene, choice, [640, 360]) };
        draft.camera.eye = DVec3::new(0.1, -2.0, 1e-17);
        draft.lights[1].position = DVec4::new(1.0 / 3.0, 2.0, -3.0, draft.lights[1].position.w);
        draft.lights[0].is_on = false;
        let mut link = ViewLink::of_run("two-lights", &scene, &draft);
        assert_eq!(link.lacks(&scene, &draft), None);
        (link.step, link.pixel, link.truth) = (Some(2), Some([330, 300]), true);
        let (read, problems) = ViewLink::parse(link.to_query().trim_start_matches('?'));
        assert_eq!((&read, problems), (&link, Vec::new()));
        read.apply_to(&mut scene).expect("the scene's own lights");
        assert_eq!((scene.camera, &scene.lights), (draft.camera, &draft.lights));
        let rest = (read.settings["casters"].as_str(), read.time, read.size);
        assert_eq!(rest, ("light-facing", Some(1.5), Some([640, 360])));
    }

    #[test]
    fn a_link_carries_an_off_center_frustum_and_a_viewport_and_takes_an_eye_about_its_target() {
        let mut scene = open(&OpenSpec::new("tori")).expect("a scene");
        let mut draft = RunRequest::of(&scene, Choice::new(Technique::ZFail), [640, 360]);
        draft.camera.projection =
            crate::scene::Projection::Frustum { left: -0.01, right: 1.0 / 3.0, bottom: -0.2, top: 0.1 };
        draft.camera.viewport = Some([1.0 / 3.0, 0.0, 0.5, 0.25]);
        let link = ViewLink::of_run("tori", &scene, &draft);
        assert_eq!(link.lacks(&scene, &draft), None);
        let (read, problems) = ViewLink::parse(link.to_query().trim_start_matches('?'));
        assert_eq!((&read, problems), (&link, Vec::new()));
        read.apply_to(&mut scene).expect("a camera");
        assert_eq!(scene.camera, draft.camera);
        let (about, problems) = ViewLink::parse("eye-spherical=3,90,0&target=1,2,3");
        assert!(problems.is_empty() && ViewLink::parse(about.to_query().trim_start_matches('?')).0 == about);
        about.apply_to(&mut scene).expect("a camera");
        assert!((scene.camera.eye - DVec3::new(4.0, 2.0, 3.0)).length() < 1e-12, "{}", scene.camera.eye);
    }

    #[test]
    fn what_a_link_does_not_carry_is_said() {
        let scene = open(&OpenSpec::new("two-lights")).expect("a scene");
        let draft = RunRequest::of(&scene, Choice::new(Technique::ZFail), [640, 360]);
        let lacks = |change: &dyn Fn(&mut RunRequest)| {
            let mut draft = draft.clone();
            change(&mut draft);
            ViewLink::of_run("two-lights", &scene, &draft).lacks(&scene, &draft)
        };
        assert_eq!(lacks(&|draft| draft.camera.eye.x += 1.0), None);
        let lights = Some("what was changed of lights besides their places");
        assert_eq!(lacks(&|draft| draft.lights.push(Light::point([1.0; 3]))), lights);
        assert_eq!(lacks(&|draft| draft.lights.truncate(1)), lights);
        assert_eq!(lacks(&|draft| draft.lights[0].intensity = 2.0), lights);
        assert_eq!(lacks(&|draft| draft.lights[0].position.w = 1.0 - draft.lights[0].position.w), lights);
        let projection = crate::scene::Projection::Orthographic { half_height: 1.0 };
        assert!(lacks(&|draft| draft.camera.projection = projection).is_some_and(|what| what.contains("camera")));
        assert!(lacks(&|draft| draft.off.extend([0])).is_some_and(|what| what.contains("objects")));
    }

    #[test]
    fn what_is_not_named_is_as_it_was() {
        let scene = open(&OpenSpec::new("tori")).expect("a scene");
        let mut changed = scene.clone();
        let (link, problems) = ViewLink::parse("scene=tori&pixel=3%2C4");
        link.apply_to(&mut changed).expect("nothing to change");
        assert_eq!((changed.camera, changed.lights, problems), (scene.camera, scene.lights, Vec::new()));
        assert_eq!(link.pixel, Some([3, 4]));
        assert_eq!(ViewLink::parse(""), (ViewLink::default(), Vec::new()));
        assert_eq!(ViewLink::default().to_query(), "");
    }

    #[test]
    fn what_can_not_be_read_of_a_link_is_said_and_the_rest_is_read() {
        let read = |query: &str| {
            let (link, problems) = ViewLink::parse(&format!("{query}&scene=tori"));
            assert_eq!((link.scene.as_deref(), problems.len()), (Some("tori"), 1), "{query}");
            problems[0].to_string()
        };
        assert!(read("colour=3").contains("`colour`"));
        let broken = [
            "eye-spherical=1,2",
            "frustum=1,2,3",
            "viewport=0,0,1",
            "size=0x4",
            "pixel=3",
            "step=-1",
            "light=0:1,2,3",
            "light=1,2,3",
            "off=0",
            "eye=1,2",
            "time=nan",
            "set=x",
        ];
        for query in broken {
            let (key, value) = query.split_once('=').expect("a pair");
            let reason = read(query);
            assert!(reason.contains(&format!("`{key}={value}`")), "{reason}");
        }
        let mut scene = open(&OpenSpec::new("tori")).expect("a scene");
        let (link, _) = ViewLink::parse("off=9");
        assert!(link.apply_to(&mut scene).expect_err("one light").to_string().contains("light 1 alone"));
    }
}

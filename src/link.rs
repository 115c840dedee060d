//! A view of a scene as the address of a page: `?scene=inside&technique=z-pass&step=2&pixel=330,300`.
//!
//! The words are those of the command line's options, and so are their values:
//!
//! ```text
//! scene=NAME  technique=NAME  set=KEY=VALUE (repeatable)  size=WxH  time=SECONDS
//! eye=X,Y,Z  target=X,Y,Z  up=X,Y,Z  fov=DEGREES  near=N  far=F      what differs of the scene's camera
//! light=N:X,Y,Z (repeatable)  off=N (repeatable)                     where light N is; switched off; from 1
//! step=N (an index, from 0)  pixel=X,Y  truth=1
//! ```

use crate::ask::RunRequest;
use crate::scene::Scene;
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
    /// The eye, world space.
    pub eye: Option<DVec3>,
    /// The point in the middle of the picture, world space.
    pub target: Option<DVec3>,
    /// What is up, world space.
    pub up: Option<DVec3>,
    /// The vertical field of view, degrees.
    pub fov: Option<f64>,
    /// Distance of the near plane, metres.
    pub near: Option<f64>,
    /// Distance of the far plane, metres.
    pub far: Option<f64>,
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
    /// Reads an address from its `?` on, without it.
    ///
    /// # Errors
    /// The first key that has no meaning, or value that can't be used.
    pub fn parse(query: &str) -> Result<ViewLink, LinkError> {
        let mut link = ViewLink::default();
        for part in query.split('&').filter(|part| !part.is_empty()) {
            let (key, value) = part.split_once('=').unwrap_or((part, ""));
            let [key, value] =
                [key, value].map(|text| percent_decode_str(&text.replace('+', " ")).decode_utf8_lossy().into_owned());
            let invalid = |reason: String| LinkError::Value { key: key.clone(), value: value.clone(), reason };
            let index = |text: &str| text.parse().ok().and_then(|number: usize| number.checked_sub(1));
            match key.as_str() {
                "scene" => link.scene = Some(value),
                "technique" => link.technique = Some(value),
                "set" => link.settings.extend([setting(&value).map_err(invalid)?]),
                "size" => link.size = Some(picture_size(&value).map_err(invalid)?),
                "time" => link.time = Some(finite(&value).map_err(invalid)?),
                "eye" => link.eye = Some(point(&value).map_err(invalid)?),
                "target" => link.target = Some(point(&value).map_err(invalid)?),
                "up" => link.up = Some(point(&value).map_err(invalid)?),
                "fov" => link.fov = Some(finite(&value).map_err(invalid)?),
                "near" => link.near = Some(finite(&value).map_err(invalid)?),
                "far" => link.far = Some(finite(&value).map_err(invalid)?),
                "light" => {
                    let (number, position) = value.split_once(':').unwrap_or(("", &value));
                    let number =
                        index(number).ok_or_else(|| invalid("give N:X,Y,Z, lights counted from 1".to_owned()))?;
                    link.lights.insert(number, point(position).map_err(invalid)?);
                }
                "off" => {
                    let number = index(&value).ok_or_else(|| invalid("give a light's number, from 1".to_owned()))?;
                    link.off.insert(number);
                }
                "step" => {
                    let step = value.parse().map_err(|_| invalid("give a step's index, from 0".to_owned()))?;
                    link.step = Some(step);
                }
                "pixel" => link.pixel = Some(pixel(&value).map_err(invalid)?),
                "truth" => link.truth = value != "0",
                _ => return Err(LinkError::Unknown(key)),
            }
        }
        Ok(link)
    }

    /// Returns the link to a scene that was `opened` so and is to be run as `draft`; nothing is selected. Added lights
    /// and what was changed of objects are not part of a link: see [`ViewLink::lacks`].
    pub fn of_run(scene: &str, draft: &RunRequest, opened: &RunRequest) -> ViewLink {
        let changed = |own: DVec3, opened: DVec3| (own != opened).then_some(own);
        let number = |own: f64, opened: f64| (own != opened).then_some(own);
        let (camera, before) = (&draft.camera, &opened.camera);
        let moved = draft.lights.iter().zip(&opened.lights).enumerate();
        let moved = moved.filter(|(_, (light, before))| light.position != before.position);
        let off = draft.lights.iter().zip(&opened.lights).enumerate();
        let off = off.filter(|(_, (light, before))| !light.is_on && before.is_on);
        let choice = draft.choice.to_request();
        ViewLink {
            scene: Some(scene.to_owned()),
            technique: Some(choice.name),
            settings: choice.settings,
            size: Some(draft.size),
            time: number(draft.time, 0.0),
            eye: changed(camera.eye, before.eye),
            target: changed(camera.target, before.target),
            up: changed(camera.up, before.up),
            fov: number(camera.fov_y_degrees, before.fov_y_degrees),
            near: number(camera.near, before.near),
            far: camera.far.filter(|_| camera.far != before.far),
            lights: moved.map(|(index, (light, _))| (index, light.position.truncate())).collect(),
            off: off.map(|(index, _)| index).collect(),
            ..ViewLink::default()
        }
    }

    /// Returns what differs between a run and the scene as it was `opened` that no link carries, in a few words; `None`
    /// where a link carries all.
    pub fn lacks(draft: &RunRequest, opened: &RunRequest) -> Option<&'static str> {
        let is_directional =
            |request: &RunRequest| request.lights.iter().map(crate::scene::Light::is_directional).collect::<Vec<_>>();
        if is_directional(draft) != is_directional(opened) {
            Some("added and deleted lights")
        } else if (&draft.off, &draft.objects) != (&opened.off, &opened.objects) {
            Some("what was changed of objects")
        } else if draft.camera.projection != opened.camera.projection {
            Some("the camera's projection")
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
        let camera = &mut scene.camera;
        camera.eye = self.eye.unwrap_or(camera.eye);
        camera.target = self.target.unwrap_or(camera.target);
        camera.up = self.up.unwrap_or(camera.up);
        camera.fov_y_degrees = self.fov.unwrap_or(camera.fov_y_degrees);
        camera.near = self.near.unwrap_or(camera.near);
        camera.far = self.far.or(camera.far);
        camera.check().map_err(|reason| invalid("eye", written(camera.eye), reason.to_owned()))?;
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
        let numbers = [("time", self.time), ("fov", self.fov), ("near", self.near), ("far", self.far)];
        numbers.into_iter().for_each(|(key, number)| number.iter().for_each(|number| add(key, number.to_string())));
        let points = [("eye", self.eye), ("target", self.target), ("up", self.up)];
        points.into_iter().for_each(|(key, point)| point.iter().for_each(|point| add(key, written(*point))));
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
        let opened = RunRequest::of(&scene, choice, [640, 360]);
        let mut draft = RunRequest { time: 1.5, ..opened.clone() };
        draft.camera.eye = DVec3::new(0.1, -2.0, 1e-17);
        draft.lights[1].position = DVec4::new(1.0 / 3.0, 2.0, -3.0, draft.lights[1].position.w);
        draft.lights[0].is_on = false;
        let mut link = ViewLink::of_run("two-lights", &draft, &opened);
        (link.step, link.pixel, link.truth) = (Some(2), Some([330, 300]), true);
        let read = ViewLink::parse(link.to_query().trim_start_matches('?')).expect("its own link");
        assert_eq!(read, link);
        read.apply_to(&mut scene).expect("the scene's own lights");
        assert_eq!((scene.camera, &scene.lights), (draft.camera, &draft.lights));
        assert_eq!(
            (read.settings["casters"].as_str(), read.time, read.size),
            ("light-facing", Some(1.5), Some([640, 360]))
        );
        assert_eq!(ViewLink::lacks(&draft, &opened), None);
        draft.lights.push(Light::point([1.0; 3]));
        assert_eq!(ViewLink::lacks(&draft, &opened), Some("added and deleted lights"));
    }

    #[test]
    fn what_is_not_named_is_as_it_was() {
        let scene = open(&OpenSpec::new("tori")).expect("a scene");
        let mut changed = scene.clone();
        let link = ViewLink::parse("scene=tori&pixel=3%2C4").expect("a link");
        link.apply_to(&mut changed).expect("nothing to change");
        assert_eq!((changed.camera, changed.lights), (scene.camera, scene.lights));
        assert_eq!(link.pixel, Some([3, 4]));
        assert_eq!(ViewLink::parse(""), Ok(ViewLink::default()));
        assert_eq!(ViewLink::default().to_query(), "");
    }

    #[test]
    fn a_link_that_can_not_be_read_says_what_and_why() {
        let reason = |query: &str| ViewLink::parse(query).expect_err(query).to_string();
        assert!(reason("scene=tori&colour=3").contains("`colour`"));
        for query in
            ["size=0x4", "pixel=3", "step=-1", "light=0:1,2,3", "light=1,2,3", "off=0", "eye=1,2", "time=nan", "set=x"]
        {
            let (key, value) = query.split_once('=').expect("a pair");
            let reason = reason(query);
            assert!(reason.contains(&format!("`{key}={value}`")), "{reason}");
        }
        let mut scene = open(&OpenSpec::new("tori")).expect("a scene");
        let link = ViewLink::parse("off=9").expect("a link");
        assert!(link.apply_to(&mut scene).expect_err("one light").to_string().contains("light 1 alone"));
    }
}

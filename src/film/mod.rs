//! Films of a frame: its passes one after the other, a light that moves once round the scene, or an eye that moves a
//! little. Each is an animated PNG, whose pictures are written as they are made.
//!
//! ```text
//! steps.rs        a pass: what it writes, over its names      light_round.rs   positions of a light on its way round
//! ```
//!
//! Animated PNG and not GIF: it stores colours and counts as they are, where GIF has 256 colours, and the PNG encoder
//! that pictures are written with writes it. A program that knows PNG alone shows the first picture.

mod eye_move;
mod light_round;
mod steps;

use crate::capture::Capture;
use crate::files::{FileWriter, WholeFile};
use crate::picture::Picture;
use crate::picture::apng::{AnimatedPng, AnimationError, AnimationFormat, ColorDepth};
use crate::picture::caption;
use crate::picture::svg::SvgError;
use crate::reading::both_sides;
use crate::reading::written::{TexelContent, WrittenAspects};
use crate::scene::Scene;
use crate::session::{CaptureRequest, SessionError};
pub use eye_move::EyeMove;
pub use light_round::LightRound;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How long a pass is shown by default, milliseconds.
pub const STEP_MILLISECONDS: u16 = 1500;
/// How long a position of the light is shown by default, milliseconds.
pub const PLACE_MILLISECONDS: u16 = 100;
/// A picture's width divided by this is the width of a line of the pick's mark.
const WIDTH_A_LINE: u32 = 400;
/// How many positions of the light there are by default.
pub const PLACES: u32 = 24;

/// The reason why a film could not be written.
#[derive(Debug, thiserror::Error)]
pub enum FilmError {
    /// The scene has fewer lights.
    #[error("there is no light {}: {}", light + 1, choice_of(*lights))]
    NoLight {
        /// Index of the light that was asked for.
        light: usize,
        /// How many there are.
        lights: usize,
    },
    /// The light is on the axis, so it would not move.
    #[error("{light} is above the middle of the scene, so going round it changes nothing: move it to a side")]
    OnAxis {
        /// The light's name.
        light: String,
    },
    /// The frame has no passes.
    #[error("the frame has no passes, so there is nothing to show: capture it again")]
    NoSteps,
    /// The text can't be drawn.
    #[error("a caption can't be drawn: {0}")]
    Caption(#[from] SvgError),
    /// A picture of the film can't be rendered.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The file can't be written.
    #[error("{}: can't be written ({source}): choose another file", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: AnimationError,
    },
}

fn choice_of(lights: usize) -> String {
    match lights {
        0 => "the scene has none, so add one".to_owned(),
        1 => "choose light 1".to_owned(),
        lights => format!("choose one from 1 to {lights}"),
    }
}

/// What moves from picture to picture.
#[derive(Debug, Clone, PartialEq)]
pub enum FilmMotion {
    /// A light, once round the scene.
    LightRound(LightRound),
    /// The eye, a little to its side.
    EyeMove(EyeMove),
}

impl FilmMotion {
    fn places(&self) -> u32 {
        match self {
            FilmMotion::LightRound(round) => round.places(),
            FilmMotion::EyeMove(moves) => moves.places(),
        }
    }

    fn scene(&self, place: u32) -> Scene {
        match self {
            FilmMotion::LightRound(round) => round.scene(place),
            FilmMotion::EyeMove(moves) => moves.scene(place),
        }
    }

    /// Returns in a few words where what moves is at a place.
    fn words(&self, place: u32) -> String {
        match self {
            FilmMotion::LightRound(round) => round.words(place),
            FilmMotion::EyeMove(moves) => format!("place {} of {}", place + 1, moves.places()),
        }
    }
}

/// The content of a film: the steps of a frame, or a motion; of one frame, or of two side by side.
#[derive(Debug, Clone)]
pub enum FilmContent {
    /// One frame or two, pass by pass, from left to right; masks are not part of them and left out.
    Steps(Vec<Arc<Capture>>),
    /// A light or an eye that moves.
    Moving {
        /// What moves, and where to.
        motion: Box<FilmMotion>,
        /// How the scene is rendered at each place: once, or in two ways side by side.
        sides: Vec<CaptureRequest>,
        /// Each picture stands over a bar with its technique and the place; two always do.
        has_captions: bool,
        /// How colours are stored.
        colors: ColorDepth,
    },
}

impl FilmContent {
    /// Returns how many pictures the film has: one for each numbered pass (masks have none) of either side, or one for
    /// each position of what moves.
    pub fn pictures(&self) -> u32 {
        match self {
            FilmContent::Steps(sides) => both_sides::aligned(sides).len() as u32,
            FilmContent::Moving { motion, .. } => motion.places(),
        }
    }

    /// Returns width and height of each picture, pixels: the frame's, with a bar for the caption below it where there is
    /// one; of two frames beside each other, both with the gap between.
    pub fn size(&self) -> [u32; 2] {
        let in_a_row = |size: Option<[u32; 2]>, sides: usize| {
            size.map_or([0; 2], |size| caption::size_in_a_row(size, sides as u32))
        };
        match self {
            FilmContent::Steps(sides) => in_a_row(sides.first().map(|capture| capture.size), sides.len()),
            FilmContent::Moving { sides, has_captions, .. } => match &sides[..] {
                [one] if !has_captions => one.size,
                sides => in_a_row(sides.first().map(|request| request.size), sides.len()),
            },
        }
    }

    /// Returns how long each picture is shown by default, milliseconds.
    pub fn milliseconds(&self) -> u16 {
        match self {
            FilmContent::Steps(_) => STEP_MILLISECONDS,
            FilmContent::Moving { .. } => PLACE_MILLISECONDS,
        }
    }

    fn colors(&self) -> ColorDepth {
        match self {
            // Values must be readable off the colours.
            FilmContent::Steps(_) => ColorDepth::Exact,
            FilmContent::Moving { colors, .. } => *colors,
        }
    }

    /// Returns a picture of the film, with a mark around the `pick` of each side. `render` renders a scene as a request says; only for a film of a motion it is called,
    /// once for each side.
    async fn picture(
        &self,
        index: u32,
        pick: Option<[u32; 2]>,
        mut render: impl AsyncFnMut(&Scene, &CaptureRequest) -> Result<Capture, SessionError>,
    ) -> Result<Picture, FilmError> {
        match self {
            FilmContent::Steps(sides) => {
                let rows = both_sides::aligned(sides);
                let row = rows.get(index as usize).ok_or(FilmError::NoSteps)?;
                let of_sides = sides.iter().zip(both_sides::names(sides)).zip(row);
                let pictures = of_sides.map(|((capture, name), at)| steps::side_picture(capture, &name, *at, pick));
                Ok(caption::in_a_row(&pictures.collect::<Result<Vec<_>, _>>()?))
            }
            FilmContent::Moving { motion, sides, has_captions, .. } => {
                let (scene, mut frames) = (motion.scene(index), Vec::with_capacity(sides.len()));
                for request in sides {
                    frames.push(Arc::new(render(&scene, request).await?));
                }
                let shown = |frame: &Capture| {
                    let mut picture = finished(frame)?;
                    mark(&mut picture, pick);
                    Ok::<_, FilmError>(picture)
                };
                if let ([frame], false) = (&frames[..], *has_captions) {
                    return shown(frame);
                }
                let words = motion.words(index);
                let captioned = frames
                    .iter()
                    .zip(both_sides::names(&frames))
                    .map(|(frame, name)| Ok::<_, FilmError>(caption::captioned(&shown(frame)?, [&name, &words])?));
                Ok(caption::in_a_row(&captioned.collect::<Result<Vec<_>, _>>()?))
            }
        }
    }
}

/// Draws a light frame in a dark one around a pixel, which are seen on any colour, a little away from it; nothing without
/// one.
fn mark(picture: &mut Picture, pick: Option<[u32; 2]>) {
    let Some([x, y]) = pick else { return };
    let line = (picture.size()[0] / WIDTH_A_LINE).max(1);
    picture.frame([x, y, x, y], 3 * line, line, [255; 3]);
    picture.frame([x, y, x, y], 4 * line, line, [0; 3]);
}

/// Returns the finished picture of a frame.
fn finished(capture: &Capture) -> Result<Picture, FilmError> {
    let last = capture.steps.len().checked_sub(1).and_then(|last| capture.frame_at(last));
    let image = last.map(|frame| Arc::clone(&frame.color.image)).ok_or(FilmError::NoSteps)?;
    Ok(WrittenAspects { image, content: TexelContent::Color, name: "colour" }.picture())
}

/// A film that is being written. One that is dropped before its end leaves no file.
#[derive(Debug)]
pub struct Film {
    shows: FilmContent,
    /// The pixel that is marked in each picture.
    pick: Option<[u32; 2]>,
    next: u32,
    // Dropped, and so closed, before the file is deleted.
    animation: AnimatedPng<FileWriter>,
    file: WholeFile,
    path: PathBuf,
}

impl Film {
    /// Begins a film that shows each picture for `milliseconds`. The file at `path` is replaced only once the film is
    /// finished; dropped before, it leaves no file.
    pub fn begin(shows: FilmContent, path: &Path, milliseconds: u16) -> Result<Film, FilmError> {
        let format =
            AnimationFormat { size: shows.size(), pictures: shows.pictures(), milliseconds, colors: shows.colors() };
        if format.pictures == 0 {
            return Err(FilmError::NoSteps);
        }
        let failed = |source| FilmError::Write { path: path.to_owned(), source };
        let of_system = |error: std::io::Error| failed(AnimationError::Png(error.into()));
        let file = WholeFile::create(path).map_err(of_system)?;
        let animation = AnimatedPng::new(file.writer().map_err(of_system)?, format).map_err(failed)?;
        Ok(Film { shows, pick: None, next: 0, animation, file, path: path.to_owned() })
    }

    /// Returns the film with a mark around a pixel in each picture of a frame, if one is given.
    pub fn marking(self, pick: Option<[u32; 2]>) -> Film {
        Film { pick, ..self }
    }

    /// Returns how many pictures the film will have.
    pub fn pictures(&self) -> u32 {
        self.shows.pictures()
    }

    /// Writes the next picture, and returns true; returns false, and writes nothing, where all pictures are written.
    /// `render` renders a scene as a request says; it is called for a film of a motion, once for each side.
    pub async fn shoot(
        &mut self,
        render: impl AsyncFnMut(&Scene, &CaptureRequest) -> Result<Capture, SessionError>,
    ) -> Result<bool, FilmError> {
        if self.next == self.pictures() {
            return Ok(false);
        }
        let picture = self.shows.picture(self.next, self.pick, render).await?;
        self.animation.add(&picture).map_err(|source| FilmError::Write { path: self.path.clone(), source })?;
        self.next += 1;
        Ok(true)
    }

    /// Completes the film and moves it to its path, replacing a file there; returns the size of the file in bytes. Call
    /// it once all pictures are written.
    pub fn finish(self) -> Result<u64, FilmError> {
        let Film { animation, file, path, .. } = self;
        let failed = |source| FilmError::Write { path: path.clone(), source };
        let of_system = |error: std::io::Error| failed(AnimationError::Png(error.into()));
        animation.finish().map_err(failed)?;
        file.finish().map_err(of_system)
    }
}

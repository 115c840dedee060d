//! What is selected: step and draw, pixel, triangle. A capture need not contain the state after each draw: selecting a
//! draw without one asks for those of its pass; until they come the picture stays as it was.

use super::Model;
use crate::ask::{DrawsOf, QuestionKind, Reply};
use crate::capture::{Capture, CapturedLight, StepDraws};
use crate::history::PixelEvent;
use crate::reading::both_sides::same_step;
use crate::reading::capture_point::CapturePoint;
use crate::reading::notable_pixel;
use crate::reading::picture_view::{PictureKind, TexelZoom};
use crate::reading::steps;
use std::sync::Arc;

/// How long a step is shown while playing, seconds.
const SECONDS_A_STEP: f64 = 0.8;
/// Screen pixels that a region should take after the picture has gone to it.
const GO_TO_PIXELS: f32 = 240.0;
/// Screen pixels for each texel, at most, after the picture has gone to a region.
const MOST_GO_TO_ZOOM: f32 = 12.0;

/// The texel under the pointer, and in which of the shown images it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hover {
    /// Index of the image among the shown ones.
    pub image: usize,
    /// The texel: column and row.
    pub at: [u32; 2],
}

/// Indices of a triangle in a frame: pass, draw of the pass, primitive of the draw.
pub type TriangleKey = [usize; 3];

/// The selected step, draw, pixel and triangle, and what is under the pointer.
#[derive(Debug, Default)]
pub struct Selection {
    /// Index of the step.
    pub step: usize,
    /// Index of the draw of that step; `None`: the step as a whole.
    pub draw: Option<usize>,
    /// The point of the frame that is shown while the state after the selected draw is not known.
    stays: CapturePoint,
    /// The list of passes has to scroll to the selected row.
    pub wants_scroll: bool,
    /// While playing: the time of the next step, in egui's seconds.
    pub playing: Option<f64>,
    /// The picked pixel of the picture.
    pub pick: Option<[u32; 2]>,
    /// The picked texel of the map that the picture panel shows.
    pub map_pick: Option<[u32; 2]>,
    /// The texel under the pointer.
    pub hover: Option<Hover>,
    /// The selected triangle of the picked pixel's history.
    pub triangle: Option<TriangleKey>,
    /// The triangle whose row in history or ladder is under the pointer: in this frame so far, and in the last one, which is
    /// read by panels that are drawn before the row.
    pub pointed: [Option<TriangleKey>; 2],
    /// Pixels that read the texel which the Shadow map tab marks.
    pub readers: Arc<Vec<[u32; 2]>>,
    /// The light whose map the Shadow map tab shows, while it is open.
    pub map_light: Option<usize>,
}

impl Selection {
    /// Returns the pick for a kind of picture: the texel picked in a shadow map, or the pixel picked in the frame for
    /// all other kinds.
    pub fn pick_of(&mut self, kind: PictureKind) -> &mut Option<[u32; 2]> {
        if kind == PictureKind::Map { &mut self.map_pick } else { &mut self.pick }
    }

    /// Selects the triangle of an event; selects no triangle where the event has none, as a clear.
    pub fn select_event(&mut self, event: &PixelEvent) {
        self.triangle = key(event);
    }

    /// Forgets, as a frame begins, which row was under the pointer before the last one.
    pub fn begin_frame(&mut self) {
        self.pointed = [None, self.pointed[0]];
    }

    /// Notes that an event's row is under the pointer.
    pub fn point_at(&mut self, event: &PixelEvent) {
        self.pointed[0] = key(event);
    }

    /// Does the event belong to the triangle whose row was under the pointer in the last frame?
    pub fn points_at(&self, event: &PixelEvent) -> bool {
        self.pointed[1].is_some() && key(event) == self.pointed[1]
    }

    /// Does the event belong to the selected triangle?
    pub fn has_event(&self, event: &PixelEvent) -> bool {
        self.triangle.is_some() && key(event) == self.triangle
    }
}

fn key(event: &PixelEvent) -> Option<TriangleKey> {
    event.triangle().map(|one| [event.pass, one.draw, one.primitive as usize])
}

impl Model {
    /// Returns how many numbered steps the frame has.
    pub fn steps(&self) -> usize {
        self.frame.capture.as_ref().map_or(0, |capture| steps::count(capture))
    }

    /// Returns the indices of the numbered steps before and after the selected one, passing over masks; `None` at the
    /// start or end.
    pub fn neighbours(&self) -> [Option<usize>; 2] {
        let of = |find: fn(&Capture, usize) -> Option<usize>| find(self.frame.capture.as_ref()?, self.selection.step);
        [of(steps::previous), of(steps::next)]
    }

    /// Returns what is selected.
    pub fn selected(&self) -> CapturePoint {
        CapturePoint { step: self.selection.step, draw: self.selection.draw }
    }

    /// Returns the point of the frame that is shown: the selected one, or, while the state after the selected draw is
    /// not known, the one that was shown before it was selected.
    pub fn shown_point(&self) -> CapturePoint {
        let selected = self.selected();
        let is_known = self.frame.capture.as_ref().is_none_or(|capture| selected.is_known(capture));
        if is_known { selected } else { self.selection.stays }
    }

    /// Adapts the selection to a capture that replaces `before`: the step that means the same, the draw of the same
    /// name, and the pick if it lies inside; without `before`, the last step. Playing and what is under the pointer are
    /// cleared.
    pub(super) fn select_in(&mut self, before: Option<&Capture>, now: &Capture) {
        let at = self.selected();
        let [width, height] = now.size;
        self.selection = Selection {
            step: before.map_or(now.steps.len().saturating_sub(1), |before| same_step(before, at.step, now)),
            pick: self.selection.pick.filter(|[x, y]| *x < width && *y < height),
            wants_scroll: true,
            hover: None,
            playing: None,
            readers: Arc::default(),
            ..std::mem::take(&mut self.selection)
        };
        let draws = now.steps.get(self.selection.step).map_or(&[][..], |step| &step.draws);
        if let Some(before) = before {
            // The draw of the same name stays selected, and its state is asked for again.
            let name = at.draw.and_then(|draw| Some(&before.steps.get(at.step)?.draws.get(draw)?.name));
            let same = |draw: &usize| draws.get(*draw).is_some_and(|draw| Some(&draw.name) == name);
            self.selection.draw = at.draw.filter(same).or_else(|| (0..draws.len()).find(same));
        }
        self.selection.stays = self.selection.step.into();
    }

    /// Selects the step of this index, the last one if there are fewer, as a whole, scrolls to it and shows it. States
    /// after draws that failed may be asked for again. Does nothing without a capture.
    pub fn select_step(&mut self, step: usize) {
        let Some(capture) = self.frame.capture.clone() else { return };
        self.selection.step = step.min(capture.steps.len().saturating_sub(1));
        self.selection.draw = None;
        self.selection.wants_scroll = true;
        self.answers.try_again(QuestionKind::DrawsOf);
        self.view.follow(&capture, self.selection.step);
    }

    /// Selects a point of the frame; where its step has no draw of that index, the step as a whole. Until the draw's
    /// state is known, the point shown so far stays. Stops playing.
    pub fn select(&mut self, at: CapturePoint) {
        let stays = self.shown_point();
        self.select_step(at.step);
        self.selection.stays = stays;
        let step = self.frame.capture.as_ref().and_then(|capture| capture.steps.get(self.selection.step));
        let draws = step.map_or(0, |step| step.draws.len());
        self.selection.draw = at.draw.filter(|draw| *draw < draws);
        self.selection.playing = None;
    }

    /// Goes forward by `by` steps, or back where it is negative, as far as there are any; masks are passed over.
    pub fn step_by(&mut self, by: isize) {
        for _ in 0..by.unsigned_abs() {
            let [before, after] = self.neighbours();
            let Some(step) = (if by > 0 { after } else { before }) else { break };
            self.select_step(step);
        }
    }

    /// Goes forward by `by` draws through the whole frame, or back where it is negative, from step to step, as far as
    /// there are any.
    pub fn draw_by(&mut self, by: isize) {
        let Some(capture) = self.frame.capture.clone() else { return };
        let mut at = self.selected();
        for _ in 0..by.unsigned_abs() {
            let Some(next) = (if by > 0 { at.next(&capture) } else { at.previous(&capture) }) else { break };
            at = next;
        }
        if at != self.selected() {
            self.select(at);
        }
    }

    /// Asks for the states after the draws of the selected step, where the selected draw, or in the modes that need it
    /// the one before, is not known; otherwise an empty reply.
    pub fn want_draws(&self) -> Reply<StepDraws> {
        let is_missing = self.frame.capture.as_ref().is_some_and(|capture| !self.selected().is_known(capture));
        if is_missing || self.lacks_draw_before() {
            self.answers.want(DrawsOf { step: self.selection.step })
        } else {
            Reply::default()
        }
    }

    /// Stops playing, or starts it at time `now` (seconds), from the first step if the last is selected; the first
    /// change comes 0.8 s later. A frame with fewer than two numbered steps is not played.
    pub fn toggle_play(&mut self, now: f64) {
        if self.selection.playing.take().is_none() && self.steps() > 1 {
            if self.neighbours()[1].is_none() {
                self.select_step(0);
            }
            self.selection.playing = Some(now + SECONDS_A_STEP);
        }
    }

    /// Goes to the next step when its time has come, and stops at the last; returns the seconds until the next change,
    /// `None` while not playing.
    pub fn play(&mut self, now: f64) -> Option<f64> {
        if now >= self.selection.playing? {
            self.step_by(1);
            self.selection.playing = self.neighbours()[1].map(|_| now + SECONDS_A_STEP);
        }
        self.selection.playing.map(|next| (next - now).max(0.0))
    }

    /// Moves the pick of the shown picture right and down by so many texels, and keeps it inside; without a pick, it
    /// starts in the middle. Does nothing where no picture is shown.
    pub fn move_pick(&mut self, by: [i32; 2]) {
        let Some(capture) = self.frame.capture.clone() else { return };
        let Some(shown) = self.shown(&capture) else { return };
        let Some(size) = shown.images.first().map(|image| image.size()) else { return };
        let pick = self.selection.pick_of(shown.kind);
        *pick = Some(moved(*pick, by, size));
    }

    /// Picks a pixel that is well inside a shadow of the shown frame, so that the panels have something to say of a scene at
    /// once; removes the pick, which was one of another scene, where nothing is in shadow.
    pub fn take_first_look(&mut self) {
        self.selection.pick = self.frame.capture.as_ref().and_then(|capture| notable_pixel::well_in_shadow(capture));
    }

    /// Returns the light that is spoken of at a pixel: the selected step's, or the first that is blocked there.
    pub fn light_in_question(&self, capture: &Capture, at: [u32; 2]) -> usize {
        let of_step = capture.steps.get(self.selection.step).and_then(|step| step.light);
        let is_dark = |light: &CapturedLight| light.shadow.as_ref().and_then(|mask| mask.byte_at(at)) == Some(1);
        of_step.or_else(|| capture.lights.iter().position(is_dark)).unwrap_or(0)
    }

    /// Picks a pixel and brings it to the middle of the view. From a fitted view, zooms so that `side` texels take
    /// about 240 screen pixels, with 1 to 12 for each; another zoom stays, with at least one.
    pub fn go_to(&mut self, at: [u32; 2], side: u32) {
        self.selection.pick = Some(at);
        let fitting = (GO_TO_PIXELS / side.max(1) as f32).clamp(1.0, MOST_GO_TO_ZOOM);
        self.view.zoom = match self.view.zoom {
            TexelZoom::Fit => TexelZoom::Pixels(fitting),
            TexelZoom::Pixels(pixels) => TexelZoom::Pixels(pixels.max(1.0)),
        };
        self.view.center = at.map(|v| f64::from(v) + 0.5);
    }
}

/// Returns a pick moved right and down by `by`, limited to a picture of this size; without a pick, it starts from the
/// middle.
pub fn moved(pick: Option<[u32; 2]>, by: [i32; 2], size: [u32; 2]) -> [u32; 2] {
    let from = pick.unwrap_or(size.map(|side| side / 2));
    [0, 1].map(|axis| from[axis].saturating_add_signed(by[axis]).min(size[axis].saturating_sub(1)))
}

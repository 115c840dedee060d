//! The frame that is shown: its capture with all that is known of it by now. The capture as it was captured stays as it
//! is; its truth, its draws and its time are answers, and are added to it here and nowhere else.

use super::Model;
use crate::ask::{DiagnosisOf, DrawsOf, FilmOf, Filmed, QuestionKind, RunRequest, TestsOf, TimingOf, TruthOf};
use crate::capture::{Capture, FrameTruth, Origin};
use crate::diagnosis::Diagnosis;
use crate::plan::FramePlan;
use crate::reading::format;
use crate::reading::picture_view::has_truth;
use std::sync::Arc;

/// The frame that is shown: its capture, the plan that was run, and a number.
#[derive(Debug, Default)]
pub struct ShownFrame {
    /// The capture, with all answers that are known.
    pub capture: Option<Arc<Capture>>,
    /// Memory of its pictures, bytes.
    pub bytes: u64,
    /// The plan that was run; `None` for a capture folder.
    pub plan: Option<Arc<FramePlan>>,
    /// The scene's time in it, seconds; `None` where nothing moves.
    pub time: Option<f64>,
    /// It is a preview of a scene that is being changed: of fewer pixels, each as large as several.
    pub is_preview: bool,
    /// How many frames have been shown: what is computed for one can't be used for the next.
    pub number: u64,
}

impl ShownFrame {
    fn set(&mut self, capture: Arc<Capture>) {
        self.bytes = capture.bytes();
        self.capture = Some(capture);
    }
}

impl Model {
    /// Can questions be asked that only a run of the frame answers? Not of a folder that contains only pictures.
    pub fn can_ask(&self) -> bool {
        self.scene.is_some() || self.frame.plan.is_some()
    }

    /// Returns where the frame comes from, if another program drew it; `None` for own frames and without a capture.
    pub fn origin(&self) -> Option<&Origin> {
        self.frame.capture.as_ref()?.origin.as_ref()
    }

    /// Shows the capture of a new frame. The selected step stays where it means the same, and the pick where it lies
    /// inside; answers about the frame before are dropped or become older ones, errors of failed runs are removed, and
    /// the view follows the step.
    pub fn set_capture(&mut self, capture: Arc<Capture>) {
        self.activity.is_waiting = false;
        self.activity.succeeded();
        let before = self.frame.capture.take();
        self.select_in(before.as_deref(), &capture);
        self.answers.new_frame();
        self.keep_truth(before.as_deref(), &capture);
        self.view.follow(&capture, self.selection.step);
        self.view.tests = None;
        self.frame.number += 1;
        self.frame.time = self.scene.as_ref().filter(|scene| scene.animated).map(|scene| scene.draft.time);
        self.frame.is_preview = false;
        self.frame.set(capture);
    }

    /// Shows the capture of a preview, as that of a new frame; nothing is asked about its pixels.
    pub fn set_preview(&mut self, capture: Arc<Capture>) {
        self.set_capture(capture);
        self.frame.is_preview = true;
        self.answers.note_preview();
    }

    /// Replaces the capture by one of the same frame with more answers in it; selection and answers stay.
    pub fn update_capture(&mut self, capture: Arc<Capture>) {
        if has_truth(&capture) {
            self.view.older_truth = None;
        }
        self.frame.set(capture);
        self.textures.forget_unused();
    }

    /// Stores the previous frame's truth, to be shown until this frame's is known, where the truth is shown and both
    /// frames have the same scene and size; otherwise drops a stored one.
    fn keep_truth(&mut self, before: Option<&Capture>, now: &Capture) {
        let is_alike = |before: &&Capture| before.scene == now.scene && before.size == now.size;
        match before.filter(is_alike).filter(|_| self.view.wants_truth()) {
            None => self.view.older_truth = None,
            Some(before) if has_truth(before) => {
                let lights = before.lights.iter().map(|light| light.truth.clone()).collect();
                self.view.older_truth = Some(Arc::new(FrameTruth { size: now.size, lights, counts: Vec::new() }));
            }
            Some(_) => {}
        }
    }

    /// Stops the work on the question of this kind; it is not asked again automatically. With the truth, an older one
    /// that is still shown is dropped.
    pub fn cancel(&mut self, kind: QuestionKind) {
        self.answers.cancel(kind);
        if kind == QuestionKind::TruthOf {
            self.view.older_truth = None;
        }
    }

    /// Asks for a diagnosis of the open scene as it is to be run now, in place of one that is under way; does nothing
    /// where no scene is open.
    pub fn start_diagnosis(&mut self) {
        // What was written before is no news after it.
        self.activity.exported = None;
        if let Some(scene) = &self.scene {
            self.answers.start(DiagnosisOf { request: Box::new(scene.draft.clone()) });
        }
    }

    /// Returns whether the scene is run otherwise now than when its last known diagnosis was asked for, in more than
    /// technique and settings, which a fix changes: what was found then may be so no more.
    pub fn is_diagnosis_stale(&self) -> bool {
        let asked = self.answers.last::<DiagnosisOf>().map(|(question, _)| question);
        self.scene.as_ref().zip(asked).is_some_and(|(scene, DiagnosisOf { request })| {
            **request != RunRequest { choice: request.choice.clone(), ..scene.draft.clone() }
        })
    }

    /// Returns whether a diagnosis is of the technique and settings that are chosen now.
    pub fn is_diagnosed_as_shown(&self, diagnosis: &Diagnosis) -> bool {
        self.scene.as_ref().is_some_and(|scene| {
            let choice = &scene.draft.choice;
            choice.technique() == diagnosis.technique && *choice.settings() == diagnosis.settings
        })
    }

    /// Returns the diagnosis of the shown frame; `None` where it was not diagnosed, or is shown otherwise than it was.
    pub fn diagnosis_of_frame(&self) -> Option<Arc<Diagnosis>> {
        let (_, diagnosis) = self.answers.last::<DiagnosisOf>()?;
        let is_shown = !self.frame.is_preview && !self.activity.is_waiting && !self.is_diagnosis_stale();
        (is_shown && self.is_diagnosed_as_shown(diagnosis)).then(|| Arc::clone(diagnosis))
    }

    /// Adds the last current answer of this kind to the shown frame: truth, states after draws, timing or test results;
    /// a film's answer is shown as an export. Does nothing for other kinds.
    pub fn take_in(&mut self, kind: QuestionKind) {
        if kind == QuestionKind::FilmOf
            && let Some((film, Filmed { pictures, bytes })) =
                self.answers.last::<FilmOf>().map(|(film, filmed)| (film, **filmed))
        {
            let size = format::bytes(bytes);
            self.activity.note_export(format!("wrote {} ({pictures} pictures, {size})", film.path));
        }
        let Some(capture) = &self.frame.capture else { return };
        let known = match kind {
            QuestionKind::TruthOf => self.answers.current::<TruthOf>().map(|(_, truth)| capture.with_truth(truth)),
            QuestionKind::DrawsOf => self.answers.current::<DrawsOf>().map(|(_, draws)| capture.with_draws(draws)),
            QuestionKind::TimingOf => {
                let timing = self.answers.current::<TimingOf>();
                timing.map(|(_, timing)| Capture { timing: **timing, ..Capture::clone(capture) })
            }
            QuestionKind::TestsOf => {
                self.view.tests = self.answers.current::<TestsOf>().map(|(_, found)| Arc::clone(&found.tests));
                None
            }
            _ => None,
        };
        if let Some(capture) = known {
            self.update_capture(Arc::new(capture));
        }
    }
}

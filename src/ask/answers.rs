//! What is known, what is being computed, and what has to be asked next.

use super::{Answer, AnswerLifetime, Ask, Question, QuestionKind};
use crate::progress::Progress;
use std::cell::RefCell;
use std::sync::Arc;

/// A question that is sent and not yet answered in full.
#[derive(Debug, Clone)]
pub struct PendingQuestion {
    /// Sent back with the answer: an answer to a question that is no longer asked is dropped.
    pub ticket: u64,
    /// The question.
    pub ask: Ask,
    /// The progress of the answer; it is cancelled where nothing waits for it any longer.
    pub progress: Progress,
}

impl PartialEq for PendingQuestion {
    /// Returns whether both are the same question under the same ticket; progress is not compared.
    fn eq(&self, other: &PendingQuestion) -> bool {
        self.ticket == other.ticket && self.ask == other.ask
    }
}

/// The state of a question: its answer, an older one, the progress, or the reason for a failure.
#[derive(Debug)]
pub struct Reply<T> {
    /// Its answer.
    pub ready: Option<Arc<T>>,
    /// While there is no answer: that to the last question of its kind, about another pixel or the previous frame.
    pub older: Option<Arc<T>>,
    /// It is being answered.
    pub running: Option<Progress>,
    /// Seconds for which this question, or an earlier one of its kind that was not answered, has been waited for.
    pub waits_for: f64,
    /// How many parts have come of an answer that comes in parts.
    pub parts: usize,
    /// Why there is no answer, and how to fix it.
    pub failed: Option<String>,
    /// It was cancelled by the user.
    pub is_cancelled: bool,
}

impl<T> Default for Reply<T> {
    fn default() -> Reply<T> {
        Reply { ready: None, older: None, running: None, waits_for: 0.0, parts: 0, failed: None, is_cancelled: false }
    }
}

impl<T> Reply<T> {
    /// Returns the answer; while there is none, the older one (see [`Reply::older`]).
    pub fn latest(&self) -> Option<&Arc<T>> {
        self.ready.as_ref().or(self.older.as_ref())
    }

    /// Returns, while the question is being answered, how many steps of the work are done and how many there are; the
    /// total is 0 while it is not known.
    pub fn steps(&self) -> Option<(usize, usize)> {
        self.running.as_ref().map(Progress::steps)
    }
}

#[derive(Debug, Default)]
struct AnswerSlot {
    asked: Option<PendingQuestion>,
    /// How many parts of its answer have come.
    parts: usize,
    /// When the wait for it began, in seconds of the clock of [`Answers::tick`].
    since: f64,
    known: Option<KnownAnswer>,
    /// The question that was given up, and why; `None`: the user cancelled it.
    given_up: Option<(Ask, Option<String>)>,
}

#[derive(Debug)]
struct KnownAnswer {
    ask: Ask,
    answer: Answer,
    /// It is valid: nothing that it depends on was replaced.
    is_current: bool,
}

/// The last question and the last answer of each kind, and the questions that wait to be sent.
#[derive(Debug)]
pub struct Answers {
    slots: Vec<AnswerSlot>,
    /// The questions that panels asked since [`Answers::take_asked`].
    wanted: RefCell<Vec<Ask>>,
    /// The questions that the user started and that are not handed out yet.
    started: Vec<Ask>,
    tickets: u64,
    now: f64,
    has_frame: bool,
    /// The frame is a preview of fewer pixels: of it only is asked what does not depend on them.
    is_preview: bool,
    /// There is a scene to run; a folder's frame answers only questions that are answered from the capture.
    has_scene: bool,
    /// The frame can be run, though there is no scene: another program drew it.
    has_plan: bool,
}

impl Default for Answers {
    fn default() -> Answers {
        Answers {
            slots: QuestionKind::ALL.iter().map(|_| AnswerSlot::default()).collect(),
            wanted: RefCell::default(),
            started: Vec::new(),
            tickets: 0,
            now: 0.0,
            has_frame: false,
            is_preview: false,
            has_scene: false,
            has_plan: false,
        }
    }
}

impl Answers {
    /// Returns what is known about a question, and marks it to be asked by the next [`Answers::take_asked`] if it is
    /// neither answered, being asked nor given up. A question of a kind that is started by hand is only looked up.
    pub fn want<Q: Question>(&self, question: Q) -> Reply<Q::Answer> {
        let ask = question.into();
        let reply = self.reply::<Q>(&ask);
        if !Q::KIND.is_started_by_hand() {
            self.wanted.borrow_mut().push(ask);
        }
        reply
    }

    /// Returns what is known about a question, without asking it.
    pub fn of<Q: Question>(&self, question: Q) -> Reply<Q::Answer> {
        self.reply::<Q>(&question.into())
    }

    fn reply<Q: Question>(&self, ask: &Ask) -> Reply<Q::Answer> {
        let slot = self.slot(Q::KIND);
        let is_it = |known: &&KnownAnswer| known.is_current && known.ask == *ask;
        let ready = slot.known.as_ref().filter(is_it).and_then(|known| Q::answer(&known.answer)).cloned();
        let older = slot.known.as_ref().filter(|_| ready.is_none()).and_then(|known| Q::answer(&known.answer)).cloned();
        let asked = slot.asked.as_ref().filter(|asked| asked.ask == *ask);
        let is_waited_for = ready.is_none() && slot.asked.is_some();
        let given_up = slot.given_up.as_ref().filter(|(of, _)| of == ask).map(|(_, reason)| reason);
        Reply {
            ready,
            older,
            running: asked.map(|asked| asked.progress.clone()),
            waits_for: if is_waited_for { self.now - slot.since } else { 0.0 },
            parts: if asked.is_some() { slot.parts } else { 0 },
            failed: given_up.cloned().flatten(),
            is_cancelled: given_up.is_some_and(Option::is_none),
        }
    }

    /// Returns the last answer of a kind with its question, also where the frame that it is about is no longer shown;
    /// `None` where there is none or it was dropped.
    pub fn last<Q: Question>(&self) -> Option<(&Q, &Arc<Q::Answer>)> {
        let known = self.slot(Q::KIND).known.as_ref()?;
        Some((Q::of(&known.ask)?, Q::answer(&known.answer)?))
    }

    /// Returns the last answer of a kind with its question; `None` where there is none, or it is about a frame that is
    /// no longer shown.
    pub fn current<Q: Question>(&self) -> Option<(&Q, &Arc<Q::Answer>)> {
        self.last::<Q>().filter(|_| self.slot(Q::KIND).known.as_ref().is_some_and(|known| known.is_current))
    }

    /// Returns the state of a kind's question: of the one that is being answered, else the one given up last, else the
    /// one answered last. Nothing of a reply is set where there is none.
    pub fn under_way<Q: Question>(&self) -> Reply<Q::Answer> {
        let slot = self.slot(Q::KIND);
        let asked = slot.asked.as_ref().map(|asked| &asked.ask);
        let given_up = slot.given_up.as_ref().map(|(ask, _)| ask);
        let known = slot.known.as_ref().map(|known| &known.ask);
        asked.or(given_up).or(known).map_or_else(Reply::default, |ask| self.reply::<Q>(ask))
    }

    /// Returns the question of a kind that is being answered; `None` where none is.
    pub fn asked<Q: Question>(&self) -> Option<&Q> {
        Q::of(&self.slot(Q::KIND).asked.as_ref()?.ask)
    }

    /// Asks a question, even where the answer is known, failed or was stopped before.
    pub fn start<Q: Question>(&mut self, question: Q) {
        self.slot_mut(Q::KIND).given_up = None;
        self.started.push(question.into());
    }

    /// Allows a question that failed or was stopped to be asked again, once it is wanted.
    pub fn try_again(&mut self, kind: QuestionKind) {
        self.slot_mut(kind).given_up = None;
    }

    /// Stops the question of this kind that is being answered; it is not asked again automatically, only by
    /// [`Answers::start`] or [`Answers::try_again`]. Does nothing where none is being answered.
    pub fn cancel(&mut self, kind: QuestionKind) {
        self.give_up(kind, None);
    }

    fn give_up(&mut self, kind: QuestionKind, reason: Option<String>) {
        let slot = self.slot_mut(kind);
        if let Some(asked) = slot.asked.take() {
            asked.progress.cancel();
            slot.given_up = Some((asked.ask, reason));
        }
    }

    /// Stops the question of this kind that is being answered; it is asked again when a panel wants it.
    fn pause(&mut self, kind: QuestionKind) {
        if let Some(asked) = self.slot_mut(kind).asked.take() {
            asked.progress.cancel();
        }
    }

    /// Drops all answers to questions of this kind, so that the next use asks again.
    pub fn forget(&mut self, kind: QuestionKind) {
        self.slot_mut(kind).known = None;
    }

    /// Sets the current time, in seconds of any steady clock; [`Reply::waits_for`] is measured by it.
    pub fn tick(&mut self, now: f64) {
        self.now = now;
    }

    /// Returns the questions that have to be sent now: all that were started, then the wanted ones that are neither
    /// answered, being asked nor given up. Each replaces the one of its kind that is being answered. Left out is what
    /// can't be answered without a frame or scene. Urgent questions also stop long work, some the truth.
    pub fn take_asked(&mut self) -> Vec<PendingQuestion> {
        let wanted = std::mem::take(self.wanted.get_mut());
        let started = std::mem::take(&mut self.started);
        let mut asked: Vec<PendingQuestion> = started.into_iter().filter_map(|ask| self.ask(ask)).collect();
        for ask in wanted {
            if !self.is_settled(&ask) {
                asked.extend(self.ask(ask));
            }
        }
        let kinds = || asked.iter().map(|asked| asked.ask.kind());
        if kinds().any(QuestionKind::is_urgent) {
            self.make_way();
        } else if kinds().any(QuestionKind::interrupts_truth) {
            self.pause(QuestionKind::TruthOf);
        }
        asked
    }

    fn is_settled(&self, ask: &Ask) -> bool {
        let slot = self.slot(ask.kind());
        let is_known = slot.known.as_ref().is_some_and(|known| known.is_current && known.ask == *ask);
        let is_asked = slot.asked.as_ref().is_some_and(|asked| asked.ask == *ask);
        is_known || is_asked || slot.given_up.as_ref().is_some_and(|(of, _)| of == ask)
    }

    fn ask(&mut self, ask: Ask) -> Option<PendingQuestion> {
        let kind = ask.kind();
        let can_be = match kind.holds() {
            AnswerLifetime::Frame if self.is_preview && !kind.is_of_any_size() => false,
            // Another frame to compare with would come later than the next preview.
            _ if self.is_preview && kind == QuestionKind::CaptureOf => false,
            _ if kind.is_read_from_capture() => self.has_frame,
            AnswerLifetime::Frame => self.has_frame && (self.has_scene || self.has_plan),
            AnswerLifetime::Scene => self.has_scene,
            AnswerLifetime::Always => true,
        };
        if !can_be {
            return None;
        }
        self.tickets += 1;
        let (ticket, now) = (self.tickets, self.now);
        let slot = self.slot_mut(kind);
        match slot.asked.take() {
            // The question changed, as when a pick is dragged: the wait goes on from when it began.
            Some(before) => before.progress.cancel(),
            None => slot.since = now,
        }
        slot.given_up = None;
        slot.parts = 0;
        Some(slot.asked.insert(PendingQuestion { ticket, ask, progress: Progress::default() }).clone())
    }

    /// Stores an answer, or the reason why there is none, and returns the kind of its question; `None`, and nothing is
    /// stored, where no question with this ticket is being answered. A part of an answer is joined to the parts before
    /// it; the question stays asked until `is_last`.
    pub fn answer(&mut self, ticket: u64, result: Result<Answer, String>, is_last: bool) -> Option<QuestionKind> {
        let kind = QuestionKind::ALL
            .iter()
            .copied()
            .find(|kind| self.slot(*kind).asked.as_ref().is_some_and(|asked| asked.ticket == ticket))?;
        let slot = self.slot_mut(kind);
        let asked = if is_last { slot.asked.take() } else { slot.asked.clone() }?;
        match result {
            Ok(answer) => {
                slot.parts += 1;
                let answer = answer.after(slot.known.as_ref().map(|known| &known.answer));
                slot.known = Some(KnownAnswer { ask: asked.ask, answer, is_current: true });
            }
            Err(reason) => slot.given_up = Some((asked.ask, Some(reason))),
        }
        Some(kind)
    }

    /// Stores the answer, or the reason why there is none, to a question that was answered without being asked; it
    /// replaces what is known of its kind, and a question of that kind that is being answered is dropped (without being
    /// cancelled).
    pub fn take_in<Q: Question>(&mut self, question: Q, result: Result<Arc<Q::Answer>, String>) {
        let ask = question.into();
        let slot = self.slot_mut(Q::KIND);
        slot.asked = None;
        slot.given_up = None;
        match result {
            Ok(answer) => {
                let answer = Q::into_answer(answer).after(slot.known.as_ref().map(|known| &known.answer));
                slot.known = Some(KnownAnswer { ask, answer, is_current: true });
            }
            Err(reason) => slot.given_up = Some((ask, Some(reason))),
        }
    }

    /// Ends the question of this ticket, if it is still asked, as its answer came in parts and is complete; the parts
    /// stay.
    pub fn end(&mut self, ticket: u64) {
        for slot in &mut self.slots {
            slot.asked.take_if(|asked| asked.ticket == ticket);
        }
    }

    /// Adapts to a new frame: answers about a frame become older ones ([`Reply::older`]) where their kind outlives its
    /// frame, or are dropped; those about the scene stay. Questions about the frame that were not started by hand stop.
    pub fn new_frame(&mut self) {
        self.has_frame = true;
        self.is_preview = false;
        self.replace(AnswerLifetime::Frame, |kind, slot| match &mut slot.known {
            Some(known) if kind.outlives_frame() => known.is_current = false,
            known => *known = None,
        });
    }

    /// Notes that the frame is a preview of fewer pixels, which another one will replace: nothing is asked about its pixels.
    pub fn note_preview(&mut self) {
        self.is_preview = true;
    }

    /// Adapts to another scene, or (`has_scene` false) a folder, which can't be run.
    pub fn new_scene(&mut self, has_scene: bool) {
        (self.has_scene, self.has_plan) = (has_scene, false);
        self.replace(AnswerLifetime::Frame, |_, slot| slot.known = None);
        self.replace(AnswerLifetime::Scene, |_, slot| slot.known = None);
    }

    /// Notes that the plan of the frame is known, so that questions which need a run of it can be answered.
    pub fn know_plan(&mut self) {
        self.has_plan = true;
    }

    /// For each kind whose answers have this lifetime, stops its question (unless it was started by hand), forgets why
    /// the last one was given up, and calls `change` with its slot.
    fn replace(&mut self, holds: AnswerLifetime, change: impl Fn(QuestionKind, &mut AnswerSlot)) {
        for kind in QuestionKind::ALL.iter().copied().filter(|kind| kind.holds() == holds) {
            if !kind.is_started_by_hand() {
                self.pause(kind);
            }
            // The reason why a question about the previous frame was given up is not valid for this one.
            self.slot_mut(kind).given_up = None;
            change(kind, self.slot_mut(kind));
        }
    }

    /// Stops long work, as another picture is asked for and must not wait: the truth is asked again when it is wanted;
    /// a diagnosis and a report are given up with a message. Other questions go on.
    pub fn make_way(&mut self) {
        self.pause(QuestionKind::TruthOf);
        for kind in QuestionKind::ALL {
            if let Some(reason) = kind.stopped_by_picture() {
                self.give_up(*kind, Some(reason.to_owned()));
            }
        }
    }

    /// Returns whether any question was sent and is not answered in full.
    pub fn is_waiting(&self) -> bool {
        self.slots.iter().any(|slot| slot.asked.is_some())
    }

    /// Returns whether a question that takes long and reports progress is being answered: truth, diagnosis of an own
    /// frame, report, film or stress cases.
    pub fn has_progress(&self) -> bool {
        let takes_in = [
            QuestionKind::TruthOf,
            QuestionKind::DiagnosisOf,
            QuestionKind::ReportOf,
            QuestionKind::FilmOf,
            QuestionKind::StressOf,
        ];
        takes_in.iter().any(|kind| self.slot(*kind).asked.is_some())
    }

    fn slot(&self, kind: QuestionKind) -> &AnswerSlot {
        &self.slots[kind as usize]
    }

    fn slot_mut(&mut self, kind: QuestionKind) -> &mut AnswerSlot {
        &mut self.slots[kind as usize]
    }
}

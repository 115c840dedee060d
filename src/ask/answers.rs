//! What is known, what is being found out, and what has to be asked next.

use super::{Answer, AnswerLifetime, Ask, Question, QuestionKind};
use crate::progress::Progress;
use std::cell::RefCell;
use std::sync::Arc;

/// A question on its way to who answers it.
#[derive(Debug, Clone)]
pub struct PendingQuestion {
    /// Told with the answer: one to what is asked no more is dropped.
    pub ticket: u64,
    /// The question.
    pub ask: Ask,
    /// How far the answer is; it is cancelled where nobody waits for it any longer.
    pub progress: Progress,
}

impl PartialEq for PendingQuestion {
    /// Equal where question and ticket are.
    fn eq(&self, other: &PendingQuestion) -> bool {
        self.ticket == other.ticket && self.ask == other.ask
    }
}

/// What is known of a question.
#[derive(Debug)]
pub struct Reply<T> {
    /// Its answer.
    pub ready: Option<Arc<T>>,
    /// While there is none: the answer to the last question of its kind, of another pixel or of the frame before.
    pub older: Option<Arc<T>>,
    /// It is being answered.
    pub running: Option<Progress>,
    /// Seconds that it, or one of its kind that was asked before it and not answered, was waited for.
    pub waits_for: f64,
    /// Of an answer that comes in parts: how many have come.
    pub parts: usize,
    /// Why there is no answer, with the mend.
    pub failed: Option<String>,
    /// It was stopped by who asked.
    pub is_cancelled: bool,
}

impl<T> Default for Reply<T> {
    fn default() -> Reply<T> {
        Reply { ready: None, older: None, running: None, waits_for: 0.0, parts: 0, failed: None, is_cancelled: false }
    }
}

impl<T> Reply<T> {
    /// The answer, or the older one while there is none.
    pub fn latest(&self) -> Option<&Arc<T>> {
        self.ready.as_ref().or(self.older.as_ref())
    }

    /// Steps that are done, and how many there are, while it is being answered; 0 in all while that is not known.
    pub fn steps(&self) -> Option<(usize, usize)> {
        self.running.as_ref().map(Progress::steps)
    }
}

#[derive(Debug, Default)]
struct AnswerSlot {
    asked: Option<PendingQuestion>,
    /// Parts of its answer that have come.
    parts: usize,
    /// When the wait for it began, in the clock of [`Answers::tick`].
    since: f64,
    known: Option<KnownAnswer>,
    /// What was given up, and why; `None`: by who asked.
    given_up: Option<(Ask, Option<String>)>,
}

#[derive(Debug)]
struct KnownAnswer {
    ask: Ask,
    answer: Answer,
    /// It holds: nothing that it depends on was replaced.
    is_current: bool,
}

/// Answers by kind of question: the last of each.
#[derive(Debug)]
pub struct Answers {
    slots: Vec<AnswerSlot>,
    /// What was wanted since it was last looked at.
    wanted: RefCell<Vec<Ask>>,
    /// What was started by hand and not handed out yet.
    started: Vec<Ask>,
    tickets: u64,
    now: f64,
    has_frame: bool,
    /// There is a scene to run; a folder's frame answers only what is read from it.
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
            has_scene: false,
            has_plan: false,
        }
    }
}

impl Answers {
    /// What is known of a question, which is asked if need be.
    pub fn want<Q: Question>(&self, question: Q) -> Reply<Q::Answer> {
        let ask = question.into();
        let reply = self.reply::<Q>(&ask);
        if !Q::KIND.is_started_by_hand() {
            self.wanted.borrow_mut().push(ask);
        }
        reply
    }

    /// What is known of a question, without asking it.
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

    /// The last answer of a kind, whatever it is of, with its question.
    pub fn last<Q: Question>(&self) -> Option<(&Q, &Arc<Q::Answer>)> {
        let known = self.slot(Q::KIND).known.as_ref()?;
        Some((Q::of(&known.ask)?, Q::answer(&known.answer)?))
    }

    /// The last answer of a kind, where it is of what is shown now.
    pub fn current<Q: Question>(&self) -> Option<(&Q, &Arc<Q::Answer>)> {
        self.last::<Q>().filter(|_| self.slot(Q::KIND).known.as_ref().is_some_and(|known| known.is_current))
    }

    /// The question of a kind that is being answered, with how far that is; or why the last one was given up.
    pub fn under_way<Q: Question>(&self) -> Reply<Q::Answer> {
        let slot = self.slot(Q::KIND);
        let asked = slot.asked.as_ref().map(|asked| &asked.ask);
        let given_up = slot.given_up.as_ref().map(|(ask, _)| ask);
        let known = slot.known.as_ref().map(|known| &known.ask);
        asked.or(given_up).or(known).map_or_else(Reply::default, |ask| self.reply::<Q>(ask))
    }

    /// The question of a kind that is being answered.
    pub fn asked<Q: Question>(&self) -> Option<&Q> {
        Q::of(&self.slot(Q::KIND).asked.as_ref()?.ask)
    }

    /// Asks, even where the answer is known, failed or was stopped before.
    pub fn start<Q: Question>(&mut self, question: Q) {
        self.slot_mut(Q::KIND).given_up = None;
        self.started.push(question.into());
    }

    /// Asks again for what failed or was stopped, once it is wanted.
    pub fn try_again(&mut self, kind: QuestionKind) {
        self.slot_mut(kind).given_up = None;
    }

    /// Stops what is being found out; it is not asked for again by itself.
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

    /// Stops it, to be asked for again by who wants it.
    fn pause(&mut self, kind: QuestionKind) {
        if let Some(asked) = self.slot_mut(kind).asked.take() {
            asked.progress.cancel();
        }
    }

    /// Forgets what is known of a kind.
    pub fn forget(&mut self, kind: QuestionKind) {
        self.slot_mut(kind).known = None;
    }

    /// Tells the time, in seconds of any clock: how long answers are waited for is reckoned by it.
    pub fn tick(&mut self, now: f64) {
        self.now = now;
    }

    /// What has to be asked now, each once.
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
            // What is waited for changed, as a pick that is dragged: it is waited for all the same.
            Some(before) => before.progress.cancel(),
            None => slot.since = now,
        }
        slot.given_up = None;
        slot.parts = 0;
        Some(slot.asked.insert(PendingQuestion { ticket, ask, progress: Progress::default() }).clone())
    }

    /// Takes an answer in, or why there is none; the kind of its question, or `None` where that is asked no more.
    /// `is_last`: nothing more comes.
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

    /// Takes in what is known of a question that nobody need ask, or why nothing is.
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

    /// The question of this ticket is done with: an answer that came in parts is whole.
    pub fn end(&mut self, ticket: u64) {
        for slot in &mut self.slots {
            slot.asked.take_if(|asked| asked.ticket == ticket);
        }
    }

    /// Another frame is shown: answers that hold for a frame are older ones now, or go.
    pub fn new_frame(&mut self) {
        self.has_frame = true;
        self.replace(AnswerLifetime::Frame, |kind, slot| match &mut slot.known {
            Some(known) if kind.outlives_frame() => known.is_current = false,
            known => *known = None,
        });
    }

    /// Another scene is open, or (`has_scene` false) a folder, which can't be run.
    pub fn new_scene(&mut self, has_scene: bool) {
        (self.has_scene, self.has_plan) = (has_scene, false);
        self.replace(AnswerLifetime::Frame, |_, slot| slot.known = None);
        self.replace(AnswerLifetime::Scene, |_, slot| slot.known = None);
    }

    /// What was run for the frame is known: it answers what a run of it tells.
    pub fn know_plan(&mut self) {
        self.has_plan = true;
    }

    /// Drops what is asked and what was given up of answers that hold so long. What was started by hand goes on, or
    /// says why it does not: who works on it tells.
    fn replace(&mut self, holds: AnswerLifetime, change: impl Fn(QuestionKind, &mut AnswerSlot)) {
        for kind in QuestionKind::ALL.iter().copied().filter(|kind| kind.holds() == holds) {
            if !kind.is_started_by_hand() {
                self.pause(kind);
            }
            // Why one of the frame before was given up says nothing of this one.
            self.slot_mut(kind).given_up = None;
            change(kind, self.slot_mut(kind));
        }
    }

    /// Another picture is asked for, and must not wait: long work of this one stops.
    pub fn make_way(&mut self) {
        self.pause(QuestionKind::TruthOf);
        for kind in QuestionKind::ALL {
            if let Some(reason) = kind.stopped_by_picture() {
                self.give_up(*kind, Some(reason.to_owned()));
            }
        }
    }

    /// Is anything being found out?
    pub fn is_waiting(&self) -> bool {
        self.slots.iter().any(|slot| slot.asked.is_some())
    }

    /// Is anything being found out that says how far it is?
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

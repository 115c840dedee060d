//! Work in many parts: a report, which is interrupted for short questions between its rows, and stress cases, which are
//! interrupted for every order between theirs.

use super::WorkerState;
use crate::app::allocator;
use crate::app::news::News;
use crate::app::queue::{Inbox, Order};
use crate::ask::{Answer, AnswerLifetime, Ask, PendingQuestion, ReportOf};
use crate::capture::AdapterInfo;
use crate::report::{MeasuredReport, Report};
use crate::session::{AsyncSession, MeasuredTechnique, Measurement, SessionError, StressSteps, report_rows};
use crate::stress::{StressCase, StressRow, StressRows};
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;
use web_time::Instant;

/// How often memory is returned to the system while rows of a report are measured.
const GIVE_BACK_EVERY: Duration = Duration::from_millis(500);
/// How often the rows of a report are shown while they are measured: painting them takes time from the measured.
const REPORT_EVERY: Duration = Duration::from_secs(1);
/// Size of the pictures of stress cases, unless a case has its own.
const STRESS_SIZE: [u32; 2] = [320, 240];

/// Stress cases that are being run.
pub(super) struct StressRun {
    ticket: u64,
    /// The rows that are still to be run.
    steps: StressSteps,
    /// The rows so far of the present case.
    rows: Vec<StressRow>,
}

impl StressRun {
    /// Begins a run of the named stress cases, without the rows that take many seconds and gigabytes, which would block
    /// the window; a name that is not known is left out.
    fn new(ticket: u64, cases: &[&'static str]) -> StressRun {
        let cases: Vec<&'static StressCase> = cases.iter().filter_map(|name| StressCase::named(name)).collect();
        let steps = StressSteps::new(&cases, &[], STRESS_SIZE).without_heavy();
        StressRun { ticket, steps, rows: Vec::new() }
    }
}

impl WorkerState {
    /// Runs the next row of the stress cases that are asked for, and puts the question back while there are more; rows
    /// are reported case by case. At the end, or at an error, the run is dropped with what it cached.
    pub(super) async fn stress_turn(&mut self, of: [u64; 2], asked: PendingQuestion, inbox: &mut Inbox) {
        let Ask::StressOf(question) = &asked.ask else { return };
        let run = self.stress.take().filter(|run| run.ticket == asked.ticket);
        let mut run = run.unwrap_or_else(|| {
            let run = StressRun::new(asked.ticket, &question.cases);
            asked.progress.start(run.steps.left());
            run
        });
        let Some((case, name)) = run.steps.next_case() else {
            (self.notify)(News::AnswerEnded { ticket: asked.ticket });
            return self.end_stress();
        };
        (self.notify)(News::Busy(format!("stress: {name}")));
        let row = match self.session().await {
            Ok(session) => session.stress_step(&mut run.steps).await,
            Err(error) => Err(error),
        };
        match row {
            Ok(row) => run.rows.extend(row),
            Err(error) => {
                (self.notify)(News::Answered { ticket: asked.ticket, result: Err(error.to_string()) });
                return self.end_stress();
            }
        }
        asked.progress.advance();
        if run.steps.next_case().is_none_or(|(next, _)| next != case) {
            let rows = StressRows::new(std::mem::take(&mut run.rows));
            (self.notify)(News::AnsweredPart { ticket: asked.ticket, answer: Answer::StressOf(Arc::new(rows)) });
        }
        self.stress = Some(run);
        inbox.queue.restore_waiting(Order::Answer { scene: of[0], frame: of[1], asked });
    }

    /// Drops the stress run and all that the session cached for its scenes, gives freed memory back, and reports that
    /// the worker is idle.
    pub(super) fn end_stress(&mut self) {
        self.stress = None;
        self.session.iter_mut().for_each(AsyncSession::forget);
        allocator::give_back();
        (self.notify)(News::Idle);
    }

    /// Measures every technique of the question on the open scene, reports the rows so far, and answers short questions about
    /// the shown frame in between. An error where the question is about another scene; no answer where it was cancelled.
    pub(super) async fn report(&mut self, of: [u64; 2], asked: PendingQuestion, inbox: &mut Inbox) {
        let Ask::ReportOf(question) = &asked.ask else { return };
        (self.notify)(News::Busy("measuring every technique".to_owned()));
        let result = if of[0] == self.scenes {
            self.measured(question, &asked, inbox).await.map_err(|error| error.to_string())
        } else {
            Err("another scene was opened meanwhile: measure again when it is the one you want".to_owned())
        };
        // Where it was cancelled, the window knows: it has asked for it.
        if !asked.progress.is_cancelled() {
            let result = result.map(|measured| Answer::ReportOf(Arc::new(measured)));
            (self.notify)(News::Answered { ticket: asked.ticket, result });
        }
        (self.notify)(News::Idle);
    }

    async fn measured(
        &mut self,
        question: &ReportOf,
        asked: &PendingQuestion,
        inbox: &mut Inbox,
    ) -> Result<MeasuredReport, SessionError> {
        // A folder's frame was shown without a session.
        self.session().await?;
        let (Some(session), Some(frame), Some(open)) = (&mut self.session, &self.last, &self.open) else {
            return Err(SessionError::NoFrame);
        };
        let (notify, frames) = (&self.notify, self.frames);
        session.free_memory_for(&frame.plan);
        let (scene, _) = frame.made()?;
        let what = Measurement { choices: question.choices.clone(), size: frame.plan.size, runs: question.runs };
        let mut given_back = Instant::now();
        let report = |adapter: &AdapterInfo, measured: &[MeasuredTechnique]| {
            Report::new(adapter.clone(), report_rows(&scene.name, &what, measured, &what.choices))
        };
        let mut reported: Option<(Instant, [usize; 2])> = None;
        let mut between = async |session: &mut AsyncSession, so_far: &[MeasuredTechnique]| {
            // Within a round only times change, which painting would disturb.
            let state = [so_far.len(), so_far.iter().map(|row| row.frames.len()).min().unwrap_or(0)];
            let is_news = |(at, of): (Instant, [usize; 2])| of != state && at.elapsed() > REPORT_EVERY;
            if !so_far.is_empty() && reported.is_none_or(is_news) {
                reported = Some((Instant::now(), state));
                let report = report(session.adapter(), so_far);
                let so_far = MeasuredReport { report, left_out: Vec::new(), is_whole: false };
                let answer = Answer::ReportOf(Arc::new(so_far));
                notify(News::AnsweredPart { ticket: asked.ticket, answer });
            }
            // The next row does not reuse the memory that one row leaves free.
            if given_back.elapsed() > GIVE_BACK_EVERY {
                allocator::give_back();
                given_back = Instant::now();
            }
            while let Some(order) = inbox.next_short() {
                let Order::Answer { frame: of, asked, .. } = order else { continue };
                if asked.progress.is_cancelled() {
                    continue;
                }
                if asked.ask.kind().holds() != AnswerLifetime::Frame || of == frames {
                    let result = session.answer(&asked.ask, Some(open), Some(frame), &asked.progress).await;
                    notify(News::Answered { ticket: asked.ticket, result: result.map_err(|error| error.to_string()) });
                }
            }
        };
        let measured = session.measure_between(scene, &what, &asked.progress, &mut between).await?;
        let is_left_out = |choice: &&crate::technique::Choice| measured.iter().all(|row| row.choice != **choice);
        let left_out: BTreeSet<String> = what.choices.iter().filter(is_left_out).map(|one| one.short_name()).collect();
        let report = report(session.adapter(), &measured);
        Ok(MeasuredReport { report, left_out: left_out.into_iter().collect(), is_whole: true })
    }
}

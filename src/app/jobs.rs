//! The worker's long work, as the window watches and stops it: a truth, a diagnosis, a report, stress cases.

use super::orders::{Measure, StressRun};
use crate::diagnosis::Diagnosis;
use crate::inspector::{
    DiagnosisProgress, DiagnosisView, Inspector, ReportProgress, ReportView, StressProgress, TruthState,
};
use crate::progress::Progress;
use crate::report::Report;
use crate::stress::{Case, Row};
use crate::technique::Choice;
use std::sync::Arc;

/// Timed frames of each row of a report.
const RUNS: usize = 5;
/// Steps that a row of a report takes beside its timed frames: setting up and comparing.
const OTHER_STEPS: usize = 1;

/// What is under way.
#[derive(Debug, Default)]
pub struct Jobs {
    judging: Option<Progress>,
    diagnosing: Option<(u64, Progress)>,
    measuring: Option<Measuring>,
    stressing: Option<Stressing>,
    /// How often diagnosing, measuring or stress cases were begun.
    count: u64,
}

#[derive(Debug)]
struct Stressing {
    job: u64,
    progress: Progress,
    /// The cases, in order.
    names: Vec<&'static str>,
    /// How many are done.
    done: usize,
}

#[derive(Debug)]
struct Measuring {
    job: u64,
    progress: Progress,
    /// What is measured, in order.
    names: Vec<String>,
}

impl Jobs {
    /// Tells the panels how far everything is; true while anything is under way.
    pub fn watch(&self, inspector: &mut Inspector) -> bool {
        if let Some(progress) = &self.judging {
            let (done, of) = progress.steps();
            inspector.set_truth(TruthState::Running { done, of });
        }
        if let Some((_, progress)) = &self.diagnosing {
            let (done, of) = progress.steps();
            let diagnosis = inspector.diagnosis().diagnosis.clone();
            let running = Some(DiagnosisProgress { done, of });
            inspector.set_diagnosis(DiagnosisView { diagnosis, running, error: None });
        }
        if let Some(measuring) = &self.measuring {
            let running = Some(measuring.steps());
            inspector.set_report(ReportView { running, error: None, ..inspector.report().clone() });
        }
        if let Some(stressing) = &self.stressing {
            inspector.set_stress(Some(stressing.steps()), None);
        }
        let frame = self.judging.is_some() || self.diagnosing.is_some();
        frame || self.measuring.is_some() || self.stressing.is_some()
    }

    /// A truth is asked for.
    pub fn judge(&mut self) -> Progress {
        self.stop_judging();
        self.judging.insert(Progress::default()).clone()
    }

    /// No truth is waited for any longer.
    pub fn stop_judging(&mut self) {
        if let Some(progress) = self.judging.take() {
            progress.cancel();
        }
    }

    /// A diagnosis is asked for: its number, and what stops it.
    pub fn diagnose(&mut self, inspector: &mut Inspector) -> (u64, Progress) {
        self.stop_diagnosing(None, inspector);
        self.count += 1;
        let begun = self.diagnosing.insert((self.count, Progress::default())).clone();
        self.watch(inspector);
        begun
    }

    /// Stops diagnosing, where anything is diagnosed; what was found before stays, with `reason`.
    pub fn stop_diagnosing(&mut self, reason: Option<&str>, inspector: &mut Inspector) {
        if let Some((_, progress)) = self.diagnosing.take() {
            progress.cancel();
            let diagnosis = inspector.diagnosis().diagnosis.clone();
            inspector.set_diagnosis(DiagnosisView { diagnosis, running: None, error: reason.map(str::to_owned) });
        }
    }

    /// What was found, or why nothing was.
    pub fn end_diagnosing(&mut self, job: u64, result: Result<Arc<Diagnosis>, String>, inspector: &mut Inspector) {
        if self.diagnosing.take_if(|(of, _)| *of == job).is_none() {
            return;
        }
        let (diagnosis, error) = match result {
            Ok(diagnosis) => (Some(diagnosis), None),
            Err(reason) => (inspector.diagnosis().diagnosis.clone(), Some(reason)),
        };
        inspector.set_diagnosis(DiagnosisView { diagnosis, running: None, error });
    }

    /// A report over the default grid is asked for; `None` where there can be none, which the
    /// panel tells.
    pub fn measure(&mut self, generation: u64, inspector: &mut Inspector) -> Option<Measure> {
        self.stop_measuring(None, inspector);
        let choices = match Choice::report_grid() {
            Ok(choices) => choices,
            Err(error) => {
                self.show(inspector, Some(error.to_string()));
                return None;
            }
        };
        self.count += 1;
        let (job, progress) = (self.count, Progress::default());
        let names = choices.iter().map(name).collect();
        self.measuring = Some(Measuring { job, progress: progress.clone(), names });
        self.watch(inspector);
        Some(Measure { generation, job, choices, runs: RUNS, progress })
    }

    /// Stops measuring, where anything is measured; the rows that were there stay, with `reason`.
    pub fn stop_measuring(&mut self, reason: Option<&str>, inspector: &mut Inspector) {
        if let Some(measuring) = self.measuring.take() {
            measuring.progress.cancel();
            self.show(inspector, reason.map(str::to_owned));
        }
    }

    /// What was measured and what was left out, or why nothing was.
    pub fn end_measuring(
        &mut self,
        job: u64,
        result: Result<Report, String>,
        left_out: &[Choice],
        inspector: &mut Inspector,
    ) {
        if self.measuring.take_if(|measuring| measuring.job == job).is_none() {
            return;
        }
        match result {
            Ok(report) => {
                let mut names: Vec<String> = Vec::new();
                for name in left_out.iter().map(name) {
                    if !names.contains(&name) {
                        names.push(name);
                    }
                }
                let left_out = names;
                inspector.set_report(ReportView { report: Some(report), left_out, ..ReportView::default() });
            }
            Err(reason) => self.show(inspector, Some(reason)),
        }
    }

    /// Stress cases are asked for, by name.
    pub fn stress(&mut self, cases: &[&'static str], inspector: &mut Inspector) -> StressRun {
        self.stop_stress(inspector);
        self.count += 1;
        let (job, progress) = (self.count, Progress::default());
        let cases: Vec<&'static Case> = cases.iter().filter_map(|name| Case::named(name)).collect();
        let names = cases.iter().map(|case| case.name).collect();
        self.stressing = Some(Stressing { job, progress: progress.clone(), names, done: 0 });
        let run = StressRun::new(job, &cases, progress);
        self.watch(inspector);
        run
    }

    /// The rows of a case; those of a run that was stopped are dropped.
    pub fn add_stress(&mut self, job: u64, rows: Vec<Row>, inspector: &mut Inspector) {
        if let Some(stressing) = self.stressing.as_mut().filter(|stressing| stressing.job == job) {
            stressing.done += 1;
            inspector.add_stress(rows);
        }
    }

    /// No more stress cases run.
    pub fn end_stress(&mut self, job: u64, error: Option<String>, inspector: &mut Inspector) {
        if self.stressing.take_if(|stressing| stressing.job == job).is_some() {
            inspector.set_stress(None, error);
        }
    }

    /// Stops running stress cases, where any run; what is done stays.
    pub fn stop_stress(&mut self, inspector: &mut Inspector) {
        if let Some(stressing) = self.stressing.take() {
            stressing.progress.cancel();
            inspector.set_stress(None, None);
        }
    }

    /// Another picture is asked for, and must not wait. Stress cases give way by themselves.
    pub fn make_way(&mut self, inspector: &mut Inspector) {
        self.pause_judging(inspector);
        let stopped = "stopped for another picture: diagnose again when it is the one you want";
        self.stop_diagnosing(Some(stopped), inspector);
        self.stop_measuring(Some("stopped for another picture: measure again when it is the one you want"), inspector);
    }

    /// Something short is asked for of the frame that is shown: its truth is asked for again after it.
    pub fn pause_judging(&mut self, inspector: &mut Inspector) {
        if self.judging.is_some() {
            self.stop_judging();
            // Asked for again: of a new frame, or of this one should there be none.
            inspector.set_truth(TruthState::NotAsked);
        }
    }

    /// The rows that were there, and an error.
    fn show(&self, inspector: &mut Inspector, error: Option<String>) {
        inspector.set_report(ReportView { running: None, error, ..inspector.report().clone() });
    }
}

impl Stressing {
    fn steps(&self) -> StressProgress {
        let what = self.names.get(self.done).map_or_else(String::new, |name| (*name).to_owned());
        StressProgress { done: self.done, of: self.names.len(), rows: self.progress.steps(), what }
    }
}

impl Measuring {
    fn steps(&self) -> ReportProgress {
        let all = self.names.len() * (RUNS + OTHER_STEPS);
        let (done, of) = self.progress.steps();
        // The truth comes first, with steps of its own.
        let name = self.progress.item().and_then(|item| self.names.get(item));
        let what = name.map_or("the truth", String::as_str).to_owned();
        ReportProgress { done, of: if of == 0 { all } else { of }, what }
    }
}

/// `shadow-map 1024`.
fn name(choice: &Choice) -> String {
    let technique = choice.technique().name();
    choice.settings().get("size").map_or_else(|| technique.to_owned(), |size| format!("{technique} {size}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::AdapterInfo;

    fn report() -> Report {
        let adapter = AdapterInfo { name: "none".to_owned(), driver: "1".to_owned(), kind: "cpu".to_owned() };
        Report::new(adapter, Vec::new())
    }

    #[test]
    fn another_picture_stops_all_that_is_under_way() {
        let (mut jobs, mut inspector) = (Jobs::default(), Inspector::default());
        let judging = jobs.judge();
        let measure = jobs.measure(1, &mut inspector).expect("a grid");
        let (job, diagnosing) = jobs.diagnose(&mut inspector);
        assert!(jobs.watch(&mut inspector) && inspector.diagnosis().running.is_some());
        jobs.make_way(&mut inspector);
        assert!(diagnosing.is_cancelled() && inspector.diagnosis().running.is_none());
        assert!(inspector.diagnosis().error.as_ref().is_some_and(|error| error.contains("diagnose again")));
        jobs.end_diagnosing(job, Err("too late".to_owned()), &mut inspector);
        assert!(inspector.diagnosis().error.as_ref().is_some_and(|error| error.contains("diagnose again")));
        assert!(judging.is_cancelled() && measure.progress.is_cancelled());
        assert!(!jobs.watch(&mut inspector) && inspector.report().running.is_none());
        assert!(inspector.report().error.as_ref().is_some_and(|error| error.contains("measure again")));
    }

    #[test]
    fn a_report_says_how_far_it_is_and_one_that_was_stopped_comes_no_more() {
        let (mut jobs, mut inspector) = (Jobs::default(), Inspector::default());
        let stopped = jobs.measure(1, &mut inspector).expect("a grid");
        let measure = jobs.measure(1, &mut inspector).expect("a grid");
        measure.progress.start(100);
        jobs.watch(&mut inspector);
        let what = |inspector: &Inspector| inspector.report().running.clone().map(|running| running.what);
        assert_eq!(what(&inspector).as_deref(), Some("the truth"));
        measure.progress.start(measure.choices.len() * (RUNS + OTHER_STEPS));
        measure.progress.turn_to(3);
        jobs.watch(&mut inspector);
        assert_eq!(what(&inspector), Some(name(&measure.choices[3])));
        jobs.end_measuring(stopped.job, Ok(report()), &[], &mut inspector);
        assert!(inspector.report().report.is_none() && inspector.report().running.is_some());
        let mut left_out = Choice::report_grid().expect("a grid");
        left_out.retain(|choice| ["shadow-map 2048", "shadow-map 4096"].contains(&name(choice).as_str()));
        assert_eq!(left_out.len(), 4);
        jobs.end_measuring(measure.job, Ok(report()), &left_out, &mut inspector);
        assert!(inspector.report().report.is_some() && inspector.report().running.is_none());
        assert_eq!(inspector.report().left_out, ["shadow-map 2048", "shadow-map 4096"]);
    }

    #[test]
    fn stress_says_how_far_it_is_within_a_case_and_goes_on_beside_another_picture() {
        let (mut jobs, mut inspector) = (Jobs::default(), Inspector::default());
        let mut run = jobs.stress(&["random", "one-pixel"], &mut inspector);
        let all = run.steps.left();
        let steps = |jobs: &Jobs| jobs.stressing.as_ref().map(Stressing::steps).expect("it runs");
        let expected =
            |done, rows: usize, what: &str| StressProgress { done, of: 2, rows: (rows, all), what: what.to_owned() };
        assert!(all > 1000);
        assert_eq!(steps(&jobs), expected(0, 0, "random"));
        (0..500).for_each(|_| run.progress.advance());
        assert_eq!(steps(&jobs), expected(0, 500, "random"));
        jobs.make_way(&mut inspector);
        assert!(!run.progress.is_cancelled());
        jobs.add_stress(run.job, std::mem::take(&mut run.rows), &mut inspector);
        assert_eq!(steps(&jobs), expected(1, 500, "one-pixel"));
        jobs.stop_stress(&mut inspector);
        assert!(run.progress.is_cancelled() && !jobs.watch(&mut inspector));
    }
}

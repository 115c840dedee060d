//! Stress cases: run row by row, and opened as scenes.

use super::Bench;
use crate::app::allocator;
use crate::app::news::News;
use crate::app::orders::StressRun;
use crate::inspector::RunRequest;
use crate::session::Session;
use crate::stress::{Case, Drives, Entrant};
use crate::technique::{Choice, ChoiceError};

/// What a case brings along in place of what the user has chosen, which counts again when another
/// scene is opened. What the user changes meanwhile is chosen.
#[derive(Debug, Default)]
pub(super) struct Brought {
    /// How its shadows are made.
    pub choice: Option<Choice>,
    /// Of the picture.
    pub size: Option<[u32; 2]>,
}

impl Bench {
    /// Takes note of what a run asks for, but for what the open scene has brought along.
    pub(super) fn take_over(&mut self, request: &RunRequest) {
        if self.brought.choice.as_ref() != Some(&request.choice) {
            self.brought.choice = None;
            self.choice = request.choice.clone();
        }
        if self.brought.size != Some(request.size) {
            self.brought.size = None;
            self.size = request.size;
        }
    }

    /// Opens a stress case's scene at a value, with its shadows made as `entrant` says.
    pub(super) fn open_case(
        &mut self,
        case: &'static Case,
        value: f64,
        entrant: Option<Entrant>,
    ) -> Result<(), String> {
        (self.tell)(News::Busy(format!("opening {}", case.name)));
        let mut scene = case.scene(value).map_err(|error| format!("{} at {value}: {error}", case.name))?;
        scene.name = format!("{} {value}", case.name);
        let choice = match entrant {
            Some(entrant) => case.choice(&entrant, value).map(Some),
            None => driven(case, value, &self.choice),
        };
        let choice = choice.map_err(|error| format!("{}: {error}", case.name))?;
        self.spec = None;
        self.show_scene(Box::new(scene), 0.0, Brought { choice, size: case.size })
    }

    /// Makes the next row of a stress run, and gives back what is left of it.
    pub(super) fn stress(&mut self, mut run: Box<StressRun>) -> Option<Box<StressRun>> {
        let Some((case, name)) = run.steps.next_case().filter(|_| !run.progress.is_cancelled()) else {
            if !run.progress.is_cancelled() {
                (self.tell)(News::StressEnded { job: run.job, error: None });
            }
            self.end_stress();
            return None;
        };
        (self.tell)(News::Busy(format!("stress: {name}")));
        match self.session().and_then(|session| session.stress_step(&mut run.steps)) {
            Ok(row) => run.rows.extend(row),
            Err(error) => {
                (self.tell)(News::StressEnded { job: run.job, error: Some(error.to_string()) });
                self.end_stress();
                return None;
            }
        }
        run.progress.advance();
        if run.steps.next_case().is_none_or(|(next, _)| next != case) {
            (self.tell)(News::Stressed { job: run.job, rows: std::mem::take(&mut run.rows) });
        }
        Some(run)
    }

    /// Hundreds of scenes were open: what was kept of them is of no use any longer.
    fn end_stress(&mut self) {
        self.session.iter_mut().for_each(Session::forget);
        allocator::give_back();
        (self.tell)(News::Idle);
    }
}

/// Where a case drives a setting: `chosen` with the setting at that value, or the case's first
/// technique that has it; `None` where the case drives the scene.
fn driven(case: &Case, value: f64, chosen: &Choice) -> Result<Option<Choice>, ChoiceError> {
    let Drives::Setting(key, _) = case.drives else { return Ok(None) };
    if chosen.settings().contains_key(key) {
        let mut choice = chosen.clone();
        choice.set(key, &value.to_string())?;
        return Ok(Some(choice));
    }
    let choices = case.entrants().into_iter().map(|entrant| case.choice(&entrant, value));
    choices.collect::<Result<Vec<_>, _>>().map(|all| all.into_iter().find(|choice| choice.settings().contains_key(key)))
}

//! What is known of why the shown frame is wrong, as a file has it.

use super::Model;
use crate::ask::{DiagnosisOf, FaultsOf};
use crate::diagnosis::Diagnosis;
use crate::diagnosis::frame_causes::FrameDiagnosis;
use std::sync::Arc;

/// A diagnosis of the open scene's frame, or of another program's.
#[derive(Debug, Clone)]
pub enum KnownDiagnosis {
    /// Of the open scene.
    OfScene(Arc<Diagnosis>),
    /// Of another program's frame.
    OfRecorded(Arc<FrameDiagnosis>),
}

impl KnownDiagnosis {
    /// Returns it as the text that `diagnose` prints, but for what it measures of other techniques.
    pub fn to_text(&self) -> String {
        match self {
            KnownDiagnosis::OfScene(diagnosis) => diagnosis.to_text(&[]),
            KnownDiagnosis::OfRecorded(diagnosis) => diagnosis.to_text(),
        }
    }

    /// Returns it as the JSON of `diagnose --json`.
    ///
    /// # Errors
    /// It has a number that JSON does not have.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        match self {
            KnownDiagnosis::OfScene(diagnosis) => diagnosis.to_json(&[]),
            KnownDiagnosis::OfRecorded(diagnosis) => diagnosis.to_json(),
        }
    }

    /// Returns the name of what it is of: scene and technique, or the recorded frame's.
    pub fn name(&self) -> String {
        match self {
            KnownDiagnosis::OfScene(diagnosis) => format!("{}-{}", diagnosis.scene, diagnosis.technique.name()),
            KnownDiagnosis::OfRecorded(diagnosis) => diagnosis.scene.clone(),
        }
    }
}

impl Model {
    /// Returns the diagnosis that the Diagnosis tab shows, also one of the frame before; `None` where there is none.
    pub fn last_diagnosis(&self) -> Option<KnownDiagnosis> {
        match self.origin() {
            Some(_) => self.recorded_diagnosis(),
            None => self.answers.last::<DiagnosisOf>().map(|(_, found)| KnownDiagnosis::OfScene(Arc::clone(found))),
        }
    }

    /// Returns the diagnosis of the shown frame, as it is shown; `None` where it was not diagnosed so.
    pub fn diagnosis_as_shown(&self) -> Option<KnownDiagnosis> {
        match self.origin() {
            Some(_) => self.recorded_diagnosis(),
            None => self.diagnosis_of_frame().map(KnownDiagnosis::OfScene),
        }
    }

    fn recorded_diagnosis(&self) -> Option<KnownDiagnosis> {
        self.answers.current::<FaultsOf>().map(|(_, found)| KnownDiagnosis::OfRecorded(Arc::clone(found)))
    }
}

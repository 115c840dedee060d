//! What the panels ask of the app. Panels change nothing outside themselves.

use super::export::ExportKind;
use crate::scene::{Camera, Light};
use crate::stress::Entrant;
use crate::technique::Choice;
use std::collections::{BTreeMap, BTreeSet};

/// A wish of the user that needs files, windows or the GPU.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// Open a built-in scene by name, or a scene file, model or capture folder by path.
    Open(String),
    /// Ask for a file with the system's dialog.
    Browse,
    /// Ask for a capture folder with the system's dialog, which shows files or folders, not both.
    BrowseFolder,
    /// Render again, with this changed.
    Run(Box<RunRequest>),
    /// Render as this says, to compare with the frame that is shown, which stays.
    Compare(Box<RunRequest>),
    /// Count how fragments of the frame that is shown fare in the tests.
    Tests {
        /// Index of the step.
        step: usize,
        /// Index of the draw; `None`: all of the step.
        draw: Option<usize>,
    },
    /// Load the open scene again from its file, which changed.
    Reload,
    /// Write what is shown into a file.
    Export {
        /// What of it.
        kind: ExportKind,
        /// Where to.
        path: String,
        /// What is there may be replaced.
        replace: bool,
    },
    /// Ask with the system's dialog where to export to.
    BrowseExport {
        /// What is exported.
        kind: ExportKind,
        /// The place so far.
        path: String,
    },
    /// Trace the truth of the frame that is shown, and hold the technique against it.
    Judge,
    /// Capture the state after each draw of a step of the frame that is shown.
    CaptureDraws {
        /// Index of the step.
        step: usize,
    },
    /// Stop tracing.
    CancelJudge,
    /// Tell the history of a pixel of the frame that is shown.
    History {
        /// Column and row.
        at: [u32; 2],
    },
    /// Tell what the frame that is shown is made of in space.
    Anatomy,
    /// Find which texel of the shown map each pixel reads: [`Inspector::map_readers_job`](super::Inspector::map_readers_job).
    MapReaders,
    /// Tell what can't be walked through in the scene that would be run so.
    Walls(Box<RunRequest>),
    /// Measure every technique on the open scene.
    RunReport,
    /// Stop measuring; the rows so far stay.
    CancelReport,
    /// Say where the frame that is shown is wrong, why, and what mends it.
    Diagnose,
    /// Stop diagnosing.
    CancelDiagnosis,
    /// Run stress cases.
    RunStress {
        /// Their names.
        cases: Vec<&'static str>,
    },
    /// Stop running; the cases that are done stay.
    CancelStress,
    /// Open the scene of a stress case.
    OpenStress {
        /// Its name.
        case: &'static str,
        /// The value of its number.
        value: f64,
        /// How its shadows are made; `None`: as before.
        entrant: Option<Entrant>,
    },
    /// Render the open scene as a row of the report was.
    OpenReportRow {
        /// Name of the technique.
        technique: String,
        /// The row's settings.
        settings: BTreeMap<String, String>,
    },
}

/// Everything about a run that the panels can change; the objects are the app's.
#[derive(Debug, Clone, PartialEq)]
pub struct RunRequest {
    /// How shadows are made.
    pub choice: Choice,
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
    /// The eye.
    pub camera: Camera,
    /// All lights, where they are at the scene's start.
    pub lights: Vec<Light>,
    /// The moment of an animated scene, seconds.
    pub time: f64,
    /// Objects that are switched off, by index: neither drawn nor casting.
    pub off: BTreeSet<usize>,
}

impl RunRequest {
    /// Names what can't be run, in a few words with the mend.
    ///
    /// # Errors
    /// A camera or light that can't be used, a picture without pixels.
    pub fn check(&self) -> Result<(), String> {
        self.camera.check()?;
        for (index, light) in self.lights.iter().enumerate() {
            light.check().map_err(|reason| format!("light {}: {reason}", index + 1))?;
        }
        if self.size.contains(&0) {
            return Err("the picture needs at least one pixel each way".to_owned());
        }
        if !self.time.is_finite() {
            return Err("the time must be a finite number of seconds".to_owned());
        }
        Ok(())
    }
}

//! A row of the report and the frame that is shown.

use crate::inspector::action::Action;
use crate::inspector::model::Model;
use crate::report::ReportRow;

/// Is the row what is shown now: same scene, technique and settings?
pub fn is_current(model: &Model, row: &ReportRow) -> bool {
    let (scene, technique, settings) = match (&model.scene, &model.frame.capture) {
        (Some(open), _) => {
            let choice = &open.draft.choice;
            (open.name.as_str(), choice.technique().name(), choice.settings())
        }
        (None, Some(capture)) => (capture.scene.as_str(), capture.technique.as_str(), &capture.settings),
        (None, None) => return false,
    };
    let has_settings = || row.settings.iter().all(|(key, value)| settings.get(key) == Some(value));
    row.scene == scene && row.technique == technique && has_settings()
}

/// Asks to render as a row was.
pub fn open_row(row: &ReportRow) -> Action {
    Action::OpenReportRow { technique: row.technique.clone(), settings: row.settings.clone() }
}

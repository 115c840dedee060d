//! How a row of the report relates to the frame that is shown.

use crate::inspector::action::Action;
use crate::inspector::model::Model;
use crate::report::ReportRow;

/// Returns whether a row has the scene, the technique and, for each setting that the row names, the value of the open
/// scene's draft, or of the shown capture where no scene is open; false where nothing is shown.
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

/// Returns the action that renders with a row's technique and settings.
pub fn open_row(row: &ReportRow) -> Action {
    Action::OpenReportRow { technique: row.technique.clone(), settings: row.settings.clone() }
}

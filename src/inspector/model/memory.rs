//! What the window stores from one run to the next: theme, layout, what was open.

use super::Model;
use serde::{Deserialize, Serialize};

/// How many recent sources are stored.
const MOST_RECENT: usize = 12;

/// The theme that the user chose, dark by default.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ThemeChoice {
    /// Light text on a dark background.
    #[default]
    Dark,
    /// Dark text on a light background.
    Light,
}

impl ThemeChoice {
    /// Returns the other theme.
    #[must_use]
    pub fn other(self) -> ThemeChoice {
        match self {
            ThemeChoice::Dark => ThemeChoice::Light,
            ThemeChoice::Light => ThemeChoice::Dark,
        }
    }

    /// Returns egui's name for the theme.
    pub fn in_egui(self) -> egui::Theme {
        match self {
            ThemeChoice::Dark => egui::Theme::Dark,
            ThemeChoice::Light => egui::Theme::Light,
        }
    }
}

/// A window when it was closed, as the next one opens.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct ClosedWindow {
    /// It filled the screen.
    pub is_maximized: bool,
    /// Width and height in points while it did not; `None` where that is not known.
    pub size: Option<[f64; 2]>,
}

/// What is stored; unknown or missing parts of a stored file have their initial values.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct StoredSettings {
    /// Dark or light.
    pub theme: ThemeChoice,
    /// How much larger than usual everything is, if it is not of the usual size.
    pub zoom: Option<f32>,
    /// The sources that were opened, the last first: built-in names and paths.
    pub recent: Vec<String>,
    /// How the window was closed.
    #[serde(flatten)]
    pub closed: ClosedWindow,
    /// The list of tours was opened once, so that its button needs no mark.
    pub knows_tours: bool,
    /// The panels' layout, if the user changed it.
    pub layout: Option<serde_json::Value>,
}

impl Model {
    /// Puts a source first among the recent ones; if it is among them already, it moves there. Only the last 12 are
    /// stored.
    pub fn note_recent(&mut self, source: &str) {
        self.recent.retain(|other| other != source);
        self.recent.insert(0, source.to_owned());
        self.recent.truncate(MOST_RECENT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_opened_is_the_first_and_stands_once() {
        let mut model = Model::default();
        for source in ["tori", "table", "tori"] {
            model.note_recent(source);
        }
        assert_eq!(model.recent, ["tori", "table"]);
        (0..40).for_each(|index| model.note_recent(&index.to_string()));
        assert_eq!(model.recent.len(), MOST_RECENT);
    }

    #[test]
    fn a_stored_memory_with_parts_missing_or_unknown_is_read() {
        let read = serde_json::from_str::<StoredSettings>(r#"{"theme":"light","colour":"red"}"#).expect("a memory");
        assert_eq!(read, StoredSettings { theme: ThemeChoice::Light, ..StoredSettings::default() });
    }
}

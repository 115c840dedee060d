//! What the window remembers from one run to the next: theme, layout, what was open.

use super::Model;
use serde::{Deserialize, Serialize};

/// Sources that are remembered.
const MOST_RECENT: usize = 12;

/// Dark or light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ThemeChoice {
    /// Light ink on dark ground.
    #[default]
    Dark,
    /// Dark ink on light ground.
    Light,
}

impl ThemeChoice {
    /// The other one.
    #[must_use]
    pub fn other(self) -> ThemeChoice {
        match self {
            ThemeChoice::Dark => ThemeChoice::Light,
            ThemeChoice::Light => ThemeChoice::Dark,
        }
    }

    /// In egui's words.
    pub fn in_egui(self) -> egui::Theme {
        match self {
            ThemeChoice::Dark => egui::Theme::Dark,
            ThemeChoice::Light => egui::Theme::Light,
        }
    }
}

/// What is remembered; unknown or missing parts of a stored one are as at first.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct StoredSettings {
    /// Dark or light.
    pub theme: ThemeChoice,
    /// What was opened, the last first: built-in names and paths.
    pub recent: Vec<String>,
    /// Where the panels are, if they were moved.
    pub layout: Option<serde_json::Value>,
}

impl Model {
    /// Something was opened: it comes first among what was.
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

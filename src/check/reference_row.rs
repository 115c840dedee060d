//! A scene by one technique, as the reference adapter drew it.

use super::LabelsHash;
use crate::diagnosis::Cause;
use crate::technique::Technique;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What a technique drew of a scene on the reference adapter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReferenceRow {
    /// The technique, with default settings.
    pub technique: Technique,
    /// Hash of its labels.
    pub labels: LabelsHash,
    /// Pixels that are wrong, summed over the lights.
    pub wrong: u64,
    /// Pixels that differ from the truth along an edge, which is excused; summed over the lights.
    pub edge_band: u64,
    /// For each proven cause of wrong pixels, how many it explains.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub causes: BTreeMap<Cause, u64>,
}

impl ReferenceRow {
    /// Returns the number of wrong pixels that no proven cause explains.
    pub fn unproven(&self) -> u64 {
        self.wrong.saturating_sub(self.causes.values().sum())
    }
}

//! What the reference adapter drew: the data that comes with the program (`assets/check.json`).
//!
//! It is written with `stencilscope check --adapter llvmpipe --write-reference assets/check.json`, anew whenever a scene
//! or a technique is meant to draw something else.

use super::{AdapterCheck, CheckedScene, LabelsHash, ReferenceRow, SIZE};
use crate::capture::AdapterInfo;
use crate::technique::Technique;
use serde::{Deserialize, Serialize};

/// Version of the format.
const SCHEMA: u32 = 1;

/// Labels of every built-in scene by every technique, on the adapter that they are compared with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CheckReference {
    /// Version of the format.
    schema: u32,
    /// Version of the program that has drawn them: `0.1.0`.
    pub program: String,
    /// The adapter that has drawn them.
    pub adapter: AdapterInfo,
    /// Width and height of the pictures in pixels.
    size: [u32; 2],
    /// One entry for each scene.
    pub scenes: Vec<ReferenceScene>,
}

/// A scene of a [`CheckReference`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReferenceScene {
    /// Name of the built-in scene.
    pub scene: String,
    /// Hash of the ray-traced truth's labels.
    pub truth: LabelsHash,
    /// One entry for each technique that could draw the scene.
    pub rows: Vec<ReferenceRow>,
}

/// Why a text can't be read as a [`CheckReference`].
#[derive(Debug, thiserror::Error)]
pub enum CheckReferenceError {
    /// The text is not JSON, or fields are missing.
    #[error("the reference can't be read: {0}")]
    Json(#[from] serde_json::Error),
    /// It was written by a version with another format.
    #[error("a reference of schema {found} can't be read: write it again, this version knows schema {SCHEMA}")]
    Schema {
        /// The format version that the text names.
        found: u32,
    },
    /// It is of pictures of another size.
    #[error("a reference of {}x{} pixels can't be used: write it again, pictures have {}x{}", found[0], found[1], SIZE[0], SIZE[1])]
    Size {
        /// Width and height that the text names.
        found: [u32; 2],
    },
}

impl CheckReference {
    /// Returns the reference that comes with the program.
    ///
    /// # Errors
    /// None that a build can have that passes its tests.
    pub fn shipped() -> Result<CheckReference, CheckReferenceError> {
        CheckReference::from_json(include_str!("../../assets/check.json"))
    }

    /// Returns a reference without scenes: nothing is compared with it, and every wrong pixel is diagnosed.
    pub fn empty(adapter: &AdapterInfo) -> CheckReference {
        let program = env!("CARGO_PKG_VERSION").to_owned();
        CheckReference { schema: SCHEMA, program, adapter: adapter.clone(), size: SIZE, scenes: Vec::new() }
    }

    /// Returns what an adapter drew, to compare others with.
    pub fn of(check: &AdapterCheck) -> CheckReference {
        let scenes = check.scenes.iter().map(ReferenceScene::of).collect();
        CheckReference { scenes, ..CheckReference::empty(&check.adapter) }
    }

    /// Returns the entry of a scene; `None` where there is none of that name.
    pub fn scene(&self, name: &str) -> Option<&ReferenceScene> {
        self.scenes.iter().find(|scene| scene.scene == name)
    }

    /// Reads what [`CheckReference::to_json`] writes.
    ///
    /// # Errors
    /// Text that is not of this format, or of pictures of another size than [`SIZE`].
    pub fn from_json(text: &str) -> Result<CheckReference, CheckReferenceError> {
        let reference: CheckReference = serde_json::from_str(text)?;
        match reference {
            CheckReference { schema: SCHEMA, size: SIZE, .. } => Ok(reference),
            CheckReference { schema: SCHEMA, size, .. } => Err(CheckReferenceError::Size { found: size }),
            CheckReference { schema, .. } => Err(CheckReferenceError::Schema { found: schema }),
        }
    }

    /// Returns it as JSON, one line a row, so that a change shows which rows it is about.
    ///
    /// # Errors
    /// None that a reference can have: only maps with other keys than texts have some.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        let list = |entries: Vec<String>, indent: &str| match entries.is_empty() {
            true => "[]".to_owned(),
            false => format!("[\n{indent}  {}\n{indent}]", entries.join(&format!(",\n{indent}  "))),
        };
        let scene = |scene: &ReferenceScene| {
            let rows: Vec<String> = scene.rows.iter().map(serde_json::to_string).collect::<Result<_, _>>()?;
            let (name, truth) = (serde_json::to_string(&scene.scene)?, scene.truth);
            Ok(format!(r#"{{"scene":{name},"truth":"{truth}","rows":{}}}"#, list(rows, "    ")))
        };
        let scenes: Vec<String> = self.scenes.iter().map(scene).collect::<Result<_, serde_json::Error>>()?;
        let head = [
            format!(r#""schema": {}"#, self.schema),
            format!(r#""program": {}"#, serde_json::to_string(&self.program)?),
            format!(r#""adapter": {}"#, serde_json::to_string(&self.adapter)?),
            format!(r#""size": {}"#, serde_json::to_string(&self.size)?),
            format!(r#""scenes": {}"#, list(scenes, "  ")),
        ];
        Ok(format!("{{\n  {}\n}}\n", head.join(",\n  ")))
    }
}

impl ReferenceScene {
    /// Returns the row of a technique; `None` where it could not draw the scene.
    pub fn row(&self, technique: Technique) -> Option<&ReferenceRow> {
        self.rows.iter().find(|row| row.technique == technique)
    }

    fn of(scene: &CheckedScene) -> ReferenceScene {
        let row = |row: &super::CheckedRow| {
            let drawn = row.drawn.as_ref().ok()?;
            Some(ReferenceRow {
                technique: row.technique,
                labels: drawn.labels,
                wrong: drawn.error.wrong(),
                edge_band: drawn.error.edge_band,
                causes: drawn.causes.clone(),
            })
        };
        ReferenceScene {
            scene: scene.scene.clone(),
            truth: scene.truth,
            rows: scene.rows.iter().filter_map(row).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_reads_back_as_it_was_written() {
        let reference = CheckReference::shipped().expect("it reads");
        let text = reference.to_json().expect("JSON");
        assert_eq!(CheckReference::from_json(&text).expect("it reads"), reference);
        assert_eq!(text, include_str!("../../assets/check.json"), "and is written in this form");
        let empty = CheckReference::empty(&reference.adapter);
        assert_eq!(CheckReference::from_json(&empty.to_json().expect("JSON")).expect("it reads"), empty);
    }

    #[test]
    fn another_format_or_size_is_refused() {
        let text = CheckReference::shipped().and_then(|reference| Ok(reference.to_json()?)).expect("JSON");
        let refused = |text: &str| CheckReference::from_json(text).expect_err("refused").to_string();
        assert!(refused(&text.replacen("\"schema\": 1", "\"schema\": 2", 1)).contains("schema 2"));
        assert!(refused(&text.replacen("[320,240]", "[64,48]", 1)).contains("64x48"));
        assert!(refused("{}").contains("missing field"));
    }
}

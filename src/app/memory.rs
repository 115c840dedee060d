//! Where the window remembers theme, layout and recent files: `window.json` in the user's folder for settings.
//!
//! A memory that can't be read is as none: the window opens as at first. One that can't be written
//! is told once, and nothing else depends on it.

use crate::files::write_whole;
use crate::inspector::StoredSettings;
use std::path::PathBuf;

/// The file; `None` where the system names no folder.
fn file() -> Option<PathBuf> {
    let folders = directories::ProjectDirs::from("", "", "stencilscope")?;
    Some(folders.config_dir().join("window.json"))
}

/// What was remembered; as at first where nothing was, or it can't be read.
pub fn load() -> StoredSettings {
    let text = file().and_then(|file| std::fs::read_to_string(file).ok());
    text.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default()
}

/// Remembers it.
///
/// # Errors
/// The file can't be written: with the mend.
pub fn store(remembered: &StoredSettings) -> Result<(), String> {
    let Some(file) = file() else { return Ok(()) };
    let folder = file.parent().map_or(Ok(()), std::fs::create_dir_all);
    let text = serde_json::to_vec_pretty(remembered).map_err(|error| error.to_string())?;
    folder.and_then(|()| write_whole(&file, &text)).map_err(|error| {
        format!("the window's layout can't be remembered in {} ({error}): make the folder writable", file.display())
    })
}

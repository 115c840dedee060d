//! Where the window stores theme, layout and recent files: `window.json` in the user's folder for settings.
//!
//! A file that can't be read is treated as missing: the window opens with initial settings. A failure to write it is
//! reported once, and nothing else depends on it.

use crate::files::write_whole;
use crate::inspector::StoredSettings;
use crate::scene::builtin::Builtin;
use std::path::{Path, PathBuf};

/// Returns the path of the settings file, `window.json` in the user's configuration folder; `None` where the system
/// names no such folder.
fn file() -> Option<PathBuf> {
    let folders = directories::ProjectDirs::from("", "", "stencilscope")?;
    Some(folders.config_dir().join("window.json"))
}

/// Returns the stored settings, or the default ones where none are stored or they can't be read or parsed; that is not
/// reported.
pub fn load() -> StoredSettings {
    let text = file().and_then(|file| std::fs::read_to_string(file).ok());
    text.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default()
}

/// Stores the settings in the user's configuration folder, which is created if necessary. Does nothing, with `Ok`,
/// where the system names no such folder.
///
/// # Errors
/// The file can't be written: the reason, and how to fix it.
pub fn store(remembered: &StoredSettings) -> Result<(), String> {
    let Some(file) = file() else { return Ok(()) };
    let folder = file.parent().map_or(Ok(()), std::fs::create_dir_all);
    let text = serde_json::to_vec_pretty(remembered).map_err(|error| error.to_string())?;
    folder.and_then(|()| write_whole(&file, &text)).map_err(|error| {
        format!("the window's layout can't be remembered in {} ({error}): make the folder writable", file.display())
    })
}

/// Returns the settings with whole paths of recent sources: one from the folder of this run would be another file in the
/// next. Names of built-in scenes, and of what is not there, stay.
pub fn with_whole_paths(settings: &StoredSettings) -> StoredSettings {
    let whole = |source: &String| {
        let path = Path::new(source);
        let is_path = Builtin::named(source).is_none() && path.exists();
        let whole = is_path.then(|| std::path::absolute(path).ok()).flatten();
        whole.map_or_else(|| source.clone(), |whole| whole.display().to_string())
    };
    let mut recent: Vec<String> = Vec::new();
    for source in settings.recent.iter().map(whole) {
        // A file that was opened by several paths is there once.
        if !recent.contains(&source) {
            recent.push(source);
        }
    }
    StoredSettings { recent, ..settings.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recent_file_is_found_from_any_folder() {
        let here = std::env::current_dir().expect("a folder").join("Cargo.toml").display().to_string();
        let recent = ["Cargo.toml", "tori", &here, "no such file.obj", "/"].map(ToOwned::to_owned).to_vec();
        let stored = with_whole_paths(&StoredSettings { recent, ..StoredSettings::default() });
        assert_eq!(stored.recent, [here.as_str(), "tori", "no such file.obj", "/"]);
    }
}

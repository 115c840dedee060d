//! What a desktop has around the window: its files, and the system's dialogs.

use super::settings_file;
use super::watch::Watch;
use crate::app::AppError;
use crate::app::controller::{DialogFilter, Surroundings};
use crate::app::news::{Notify, WindowNews};
use crate::app::task;
use crate::inspector::StoredSettings;
use std::path::{Path, PathBuf};
use std::pin::Pin;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// No user cancels a dialog sooner after it was asked for.
const SOONEST_CANCEL: Duration = Duration::from_millis(300);
/// What is said where the system has no dialog.
const NO_CHOOSER: &str = "this system has no file chooser: type the path here, or install \
                          xdg-desktop-portal or zenity";

/// A desktop.
pub struct Desktop {
    watch: Watch,
    notify: Notify,
}

impl Desktop {
    /// Starts to watch files; `notify` receives what changes and what the user chooses.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(notify: Notify) -> Result<Desktop, AppError> {
        Ok(Desktop { watch: Watch::start(Arc::clone(&notify)).map_err(AppError::NoThread)?, notify })
    }

    /// Waits for a dialog beside the window, and reports the path that it gives, or that there is no dialog: then the answer
    /// comes sooner than anyone could cancel one.
    fn wait_for<D>(&self, dialog: D, news: fn(String) -> WindowNews) -> Result<(), String>
    where
        D: Future<Output = Option<rfd::FileHandle>> + Send + 'static,
    {
        let notify = Arc::clone(&self.notify);
        let begin = Instant::now();
        let wait = async move || match dialog.await {
            Some(chosen) => notify(news(chosen.path().display().to_string())),
            None if begin.elapsed() < SOONEST_CANCEL => notify(WindowNews::NoChooser(NO_CHOOSER.to_owned())),
            None => {}
        };
        let started = task::start("file dialog", wait).map(drop);
        started.map_err(|error| format!("the file dialog can't be opened: {error}; type the path instead"))
    }
}

impl Surroundings for Desktop {
    fn load_settings(&mut self) -> StoredSettings {
        settings_file::load()
    }

    fn store_settings(&mut self, settings: &StoredSettings) -> Result<(), String> {
        settings_file::store(&settings_file::with_whole_paths(settings))
    }

    fn watch(&mut self, files: Vec<PathBuf>) {
        self.watch.look_at(files);
    }

    fn browse(&mut self, wanted: DialogFilter) -> Result<(), String> {
        let dialog = rfd::AsyncFileDialog::new();
        // Created here, as some systems allow dialogs on the main thread only.
        let dialog: Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>> = match wanted {
            DialogFilter::File => {
                let dialog = dialog.set_title("Open a scene or a model");
                Box::pin(dialog.add_filter("scenes and models", &["toml", "obj", "ply", "gltf", "glb"]).pick_file())
            }
            DialogFilter::Folder => Box::pin(dialog.set_title("Open a capture folder").pick_folder()),
        };
        self.wait_for(dialog, WindowNews::Chosen)
    }

    fn browse_export(&mut self, path: &str) -> Result<(), String> {
        let dialog = rfd::AsyncFileDialog::new().set_title("Export");
        let name = Path::new(path).file_name().map(|name| name.to_string_lossy().into_owned());
        // A capture is a folder: its path is chosen like that of a new file.
        self.wait_for(dialog.set_file_name(name.unwrap_or_default()).save_file(), WindowNews::ChosenExport)
    }
}

//! What a page has around the window: the browser's storage, and its file dialog.

use super::page;
use crate::app::controller::{DialogFilter, Surroundings};
use crate::import::ShippedFrame;
use crate::inspector::{StoredSettings, ThemeChoice};
use crate::link::ViewLink;
use crate::scene::builtin::Builtin;

/// The key of the settings in the browser's storage.
const KEY: &str = "stencilscope window";

/// A page in a browser.
#[derive(Debug)]
pub struct Page;

fn storage() -> Option<web_sys::Storage> {
    web_sys::window()?.local_storage().ok().flatten()
}

impl Surroundings for Page {
    fn load_settings(&mut self) -> StoredSettings {
        let text = storage().and_then(|storage| storage.get_item(KEY).ok().flatten());
        // At first as the page's loading screen is.
        let theme = if page::is_light() { ThemeChoice::Light } else { ThemeChoice::Dark };
        let first = StoredSettings { theme, ..StoredSettings::default() };
        text.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or(first)
    }

    fn store_settings(&mut self, settings: &StoredSettings) -> Result<(), String> {
        let mut settings = settings.clone();
        // Dropped files are gone with the page.
        settings.recent.retain(|name| Builtin::named(name).is_some() || ShippedFrame::named(name).is_some());
        let text = serde_json::to_string(&settings).map_err(|error| error.to_string())?;
        // A browser that stores nothing, as in a private window, opens with the first layout again.
        storage().map_or(Ok(()), |storage| storage.set_item(KEY, &text)).map_err(|_| {
            "the window's layout can't be remembered: the browser's storage is full or switched off".to_owned()
        })
    }

    fn share(&mut self, link: &ViewLink) -> Result<(), String> {
        let address = page::address().ok_or("the page has no address that could be shared")?;
        page::copy(&format!("{address}{}", link.to_query()));
        Ok(())
    }

    fn browse(&mut self, wanted: DialogFilter) -> Result<(), String> {
        page::pick_files(wanted == DialogFilter::Folder);
        Ok(())
    }
}

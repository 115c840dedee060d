//! Everything around the tabs: bars, dialogs, keys, walking and tours.

pub mod arrangement;
pub mod dock;
pub mod export;
pub mod help;
pub mod keys;
pub mod messages;
pub mod open_dialog;
pub mod presets;
pub mod status_bar;
pub mod top_bar;
pub mod tour;
pub mod view_menu;
pub mod walk;

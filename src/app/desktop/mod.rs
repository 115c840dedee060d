//! The window of a desktop: the system's events, dialogs, clipboard and files.

mod clipboard;
mod loop_event;
mod settings_file;
mod surface;
mod surroundings;
mod watch;
mod window;

use super::{AppError, ViewRequest, allocator};

/// Sets up the allocator, and shows the window until it is closed.
pub fn run(request: ViewRequest) -> Result<(), AppError> {
    allocator::give_back_at_once();
    window::run(request)
}

/// Returns the error for a window that can't be opened: with the system's message, of which only what follows the last
/// `: ` remains where it begins with a place in a library's source (`os error at `).
fn no_window(error: &dyn std::fmt::Display) -> AppError {
    let text = error.to_string();
    let reason = text.rsplit(": ").next().filter(|_| text.starts_with("os error at "));
    AppError::NoWindow(reason.unwrap_or(&text).to_owned())
}

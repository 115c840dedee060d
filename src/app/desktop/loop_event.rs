//! What wakes the event loop besides the window's own events.

use crate::app::news::WindowNews;
use std::time::Instant;

/// An event of the loop that is not of the window's own.
#[derive(Debug)]
pub enum LoopEvent {
    /// What wakes the panels.
    News(WindowNews),
    /// egui wants to draw at this time.
    Repaint(Instant),
    /// An event of assistive technology.
    Access(egui_winit::accesskit_winit::Event),
}

impl From<egui_winit::accesskit_winit::Event> for LoopEvent {
    fn from(event: egui_winit::accesskit_winit::Event) -> LoopEvent {
        LoopEvent::Access(event)
    }
}

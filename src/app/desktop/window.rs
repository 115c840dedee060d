//! The event loop: passes actions of the panels to the worker and its news to the panels.

use super::loop_event::LoopEvent;
use super::no_window;
use super::surface::WindowSurface;
use super::surroundings::Desktop;
use crate::app::controller::Controller;
use crate::app::news::Notify;
use crate::app::{AppError, ViewRequest, title};
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::event::{DeviceEvent, DeviceId, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::WindowId;

/// How often progress is checked.
const WATCH: Duration = Duration::from_millis(100);

/// Shows the window until it is closed.
pub fn run(request: ViewRequest) -> Result<(), AppError> {
    let event_loop = EventLoop::<LoopEvent>::with_user_event().build();
    let event_loop = event_loop.map_err(|error| no_window(&error))?;
    event_loop.set_control_flow(ControlFlow::Wait);
    let proxy = event_loop.create_proxy();
    let mut app = App::new(request, proxy)?;
    event_loop.run_app(&mut app).map_err(|error| no_window(&error))?;
    app.failure.map_or(Ok(()), Err)
}

struct App {
    ctx: egui::Context,
    controller: Controller,
    proxy: EventLoopProxy<LoopEvent>,
    adapter: Option<String>,
    surface: Option<WindowSurface>,
    failure: Option<AppError>,
    repaint_at: Option<Instant>,
}

impl App {
    fn new(request: ViewRequest, proxy: EventLoopProxy<LoopEvent>) -> Result<App, AppError> {
        let adapter = request.adapter.clone();
        // A loop that has ended receives no news, and needs none.
        let to_window = proxy.clone();
        let notify: Notify = Arc::new(move |news| drop(to_window.send_event(LoopEvent::News(news))));
        let desktop = Desktop::new(Arc::clone(&notify))?;
        let controller = Controller::new(request, notify, Box::new(desktop))?;
        Ok(App { ctx: context(&proxy), controller, proxy, adapter, surface: None, failure: None, repaint_at: None })
    }

    fn redraw(&self) {
        if let Some(surface) = &self.surface {
            surface.request_redraw();
        }
    }

    fn draw(&mut self, event_loop: &ActiveEventLoop) {
        let Some(surface) = &mut self.surface else { return };
        let mut actions = Vec::new();
        let is_watching = self.controller.inspector.model.answers.has_progress();
        surface.draw(event_loop, &self.ctx, |ui| {
            actions.extend(self.controller.inspector.ui(ui));
            if is_watching {
                ui.ctx().request_repaint_after(WATCH);
            }
        });
        if let Some(failure) = surface.take_failure() {
            self.controller.inspector.model.push_error(failure);
        }
        if !actions.is_empty() {
            actions.into_iter().for_each(|action| self.controller.act(action));
            self.redraw();
        }
    }
}

impl ApplicationHandler<LoopEvent> for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.surface.is_some() {
            return;
        }
        let closed = self.controller.inspector.model.closed;
        let adapter = self.adapter.as_deref();
        match WindowSurface::new(event_loop, &self.ctx, self.proxy.clone(), adapter, closed) {
            Ok(mut surface) => {
                if let Some(capture) = self.controller.inspector.model.frame.capture.as_ref() {
                    surface.set_title(title(capture));
                }
                surface.request_redraw();
                self.surface = Some(surface);
            }
            Err(error) => {
                self.failure = Some(error);
                event_loop.exit();
            }
        }
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, event: LoopEvent) {
        match event {
            LoopEvent::Repaint(at) => {
                let at = self.repaint_at.map_or(at, |earlier| earlier.min(at));
                self.repaint_at = Some(at);
                event_loop.set_control_flow(ControlFlow::WaitUntil(at));
            }
            LoopEvent::Access(event) => {
                if let Some(surface) = &mut self.surface {
                    surface.on_access(event.window_event);
                }
            }
            LoopEvent::News(news) => {
                self.controller.wake(news);
                if let (Some(surface), Some(capture)) =
                    (&mut self.surface, self.controller.inspector.model.frame.capture.as_ref())
                {
                    surface.set_title(title(capture));
                }
                self.redraw();
            }
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _window: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested => {
                if let Some(surface) = &self.surface {
                    let model = &mut self.controller.inspector.model;
                    model.closed = surface.closed(model.closed);
                }
                self.controller.remember();
                event_loop.exit();
            }
            WindowEvent::RedrawRequested => self.draw(event_loop),
            event => {
                if let Some(surface) = &mut self.surface {
                    surface.on_event(&event);
                }
            }
        }
    }

    fn device_event(&mut self, _event_loop: &ActiveEventLoop, _device: DeviceId, event: DeviceEvent) {
        if let (DeviceEvent::MouseMotion { delta }, Some(surface)) = (event, &mut self.surface) {
            surface.on_mouse_motion(delta);
        }
    }

    fn new_events(&mut self, event_loop: &ActiveEventLoop, _cause: StartCause) {
        if self.repaint_at.is_some_and(|at| at <= Instant::now()) {
            self.repaint_at = None;
            event_loop.set_control_flow(ControlFlow::Wait);
            self.redraw();
        }
    }

    fn exiting(&mut self, _event_loop: &ActiveEventLoop) {
        // The window has to be dropped before its event loop.
        self.surface = None;
    }
}

/// Returns an egui context that sends `LoopEvent::Repaint` to the event loop when it wants to be drawn within an hour.
fn context(proxy: &EventLoopProxy<LoopEvent>) -> egui::Context {
    let ctx = egui::Context::default();
    let proxy = proxy.clone();
    ctx.set_request_repaint_callback(move |info| {
        // "Never" is a delay too long to add.
        if info.delay < Duration::from_secs(3600) {
            drop(proxy.send_event(LoopEvent::Repaint(Instant::now() + info.delay)));
        }
    });
    ctx
}

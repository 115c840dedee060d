//! The system's window, and the GPU surface on which egui is drawn.

use super::clipboard::SystemClipboard;
use super::loop_event::LoopEvent;
use super::no_window;
use crate::app::AppError;
use crate::app::input::events_of_frame;
use crate::inspector::ClosedWindow;
use crate::offscreen;
use crate::picture;
use crate::repaint::RetainedTarget;
use crate::session::MEMORY_HINTS;
use crate::viewport;
use egui::epaint::{Primitive, TextureId};
use egui::{ClippedPrimitive, Color32, Context, Mesh, Pos2, Rect, ViewportId, pos2, vec2};
use egui_wgpu::winit::Painter;
use egui_wgpu::{RenderState, ScreenDescriptor, WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use std::num::NonZeroU32;
use std::sync::Arc;
use winit::dpi::{LogicalSize, PhysicalSize};
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, EventLoopProxy};
#[cfg(target_os = "linux")]
use winit::platform::wayland::WindowAttributesExtWayland;
use winit::window::{CursorGrabMode, Icon, Window, WindowAttributes};

/// The window's initial size in points, on a screen that is large enough.
const FIRST_SIZE: [f64; 2] = [1440.0, 900.0];
/// The window's largest share of a smaller screen: the system's own bars need the rest.
const OF_SCREEN: f64 = 0.95;
/// Pixels of the window's icon for each unit of its drawing, which is 128 wide.
const ICON_SCALE: f32 = 0.5;
/// The least size in points at which the panels fit.
const LEAST_SIZE: [f64; 2] = [640.0, 400.0];

/// Returns the size of the screen on which a new window is likely to open, points; `None` where the system does not
/// say.
fn screen(event_loop: &ActiveEventLoop) -> Option<[f64; 2]> {
    let monitor = event_loop.primary_monitor().or_else(|| event_loop.available_monitors().next())?;
    Some(monitor.size().to_logical::<f64>(monitor.scale_factor()).into())
}

/// Returns the size in which a window opens, points: as it was closed, where that is known and no larger than the screen;
/// otherwise one that leaves some of the screen.
fn first_size(screen: Option<[f64; 2]>, closed: Option<[f64; 2]>) -> [f64; 2] {
    // Some systems say 0 for a screen that they don't know.
    let screen = screen.filter(|screen| screen.iter().all(|side| *side >= 1.0));
    let is_right = |size: &[f64; 2]| {
        (0..2).all(|axis| (LEAST_SIZE[axis]..=screen.map_or(f64::MAX, |screen| screen[axis])).contains(&size[axis]))
    };
    match (closed.filter(is_right), screen) {
        (Some(closed), _) => closed,
        (None, Some(screen)) => [0, 1].map(|axis| FIRST_SIZE[axis].min((screen[axis] * OF_SCREEN).floor())),
        (None, None) => FIRST_SIZE,
    }
}

/// Returns the picture that task bars show for the window; `None` where it can't be drawn, and the system shows its own.
fn icon() -> Option<Icon> {
    let drawn = picture::svg::picture(include_str!("../../../assets/icon.svg"), ICON_SCALE).ok()?;
    let [width, height] = drawn.size();
    // Only its corners, on which nothing is drawn, are black.
    let opacity = |pixel: &[u8; 3]| if *pixel == [0; 3] { 0 } else { u8::MAX };
    let rgba = drawn.pixels().iter().flat_map(|pixel| [pixel[0], pixel[1], pixel[2], opacity(pixel)]).collect();
    Icon::from_rgba(rgba, width, height).ok()
}

/// Gives a window the name by which a Linux desktop finds the program's menu entry and icon.
#[cfg(target_os = "linux")]
fn named(attributes: WindowAttributes) -> WindowAttributes {
    WindowAttributesExtWayland::with_name(attributes, "stencilscope", "stencilscope")
}

/// Returns the attributes unchanged: other systems find icons in other ways.
#[cfg(not(target_os = "linux"))]
fn named(attributes: WindowAttributes) -> WindowAttributes {
    attributes
}

/// A window that egui draws on.
pub struct WindowSurface {
    window: Arc<Window>,
    painter: Painter,
    input: egui_winit::State,
    clipboard: SystemClipboard,
    /// Events of mouse and keys that no frame has handled yet.
    events: Vec<egui::Event>,
    /// Texture changes that were not drawn yet.
    textures: egui::TexturesDelta,
    kept: KeptPicture,
    title: String,
    hidden: bool,
    /// The pointer is grabbed, and raw movement of the mouse is used.
    holds_pointer: bool,
    /// What the system refused since [`WindowSurface::take_failure`] was called last, as a sentence.
    failure: Option<String>,
}

impl WindowSurface {
    /// Opens the window and a GPU that can draw on it; with `adapter`, the first whose name contains that in any case,
    /// and an error where there is none. The window is shown only after the GPU and assistive technology are set up, in
    /// the `closed` one's size; it fills the screen where that did.
    pub fn new(
        event_loop: &ActiveEventLoop,
        ctx: &Context,
        proxy: EventLoopProxy<LoopEvent>,
        adapter: Option<&str>,
        closed: ClosedWindow,
    ) -> Result<WindowSurface, AppError> {
        let attributes = named(Window::default_attributes())
            .with_title("stencilscope")
            .with_window_icon(icon())
            .with_inner_size(LogicalSize::<f64>::from(first_size(screen(event_loop), closed.size)))
            .with_min_inner_size(LogicalSize::<f64>::from(LEAST_SIZE))
            .with_maximized(closed.is_maximized)
            // Assistive technology has to be set up before the window is visible.
            .with_visible(false);
        let window = Arc::new(event_loop.create_window(attributes).map_err(|error| no_window(&error))?);
        let mut painter = pollster::block_on(Painter::new(
            ctx.clone(),
            configuration(event_loop, adapter),
            false,
            offscreen::OF_WINDOW,
        ));
        let set = pollster::block_on(painter.set_window(ViewportId::ROOT, Some(Arc::clone(&window))));
        set.map_err(|error| no_window(&error))?;
        if let Some(gpu) = painter.render_state() {
            viewport::install(&gpu);
        }
        let scale = Some(window.scale_factor() as f32);
        let most = painter.max_texture_side();
        let theme = event_loop.system_theme();
        let mut input = egui_winit::State::new(ctx.clone(), ViewportId::ROOT, event_loop, scale, theme, most);
        input.init_accesskit(event_loop, &window, proxy);
        window.set_visible(true);
        let textures = egui::TexturesDelta::default();
        Ok(WindowSurface {
            window,
            painter,
            input,
            clipboard: SystemClipboard::new(event_loop),
            events: Vec::new(),
            textures,
            kept: KeptPicture::default(),
            title: String::new(),
            hidden: false,
            holds_pointer: false,
            failure: None,
        })
    }

    /// Sets the window's title; does nothing where it is the same already.
    pub fn set_title(&mut self, title: String) {
        if self.title != title {
            self.window.set_title(&title);
            self.title = title;
        }
    }

    /// Returns how the window is to be opened again. One that fills the screen keeps the size that it had `before`.
    pub fn closed(&self, before: ClosedWindow) -> ClosedWindow {
        match self.window.is_maximized() {
            true => ClosedWindow { is_maximized: true, ..before },
            false => {
                let size: [f64; 2] = self.window.inner_size().to_logical::<f64>(self.window.scale_factor()).into();
                // A minimized window may have none.
                let is_shown = (0..2).all(|axis| size[axis] >= LEAST_SIZE[axis]);
                ClosedWindow { is_maximized: false, size: if is_shown { Some(size) } else { before.size } }
            }
        }
    }

    /// Returns, once, what the system refused (to hold the pointer, to copy a text), as a sentence for the user.
    pub fn take_failure(&mut self) -> Option<String> {
        self.failure.take()
    }

    /// Asks the system for a redraw.
    pub fn request_redraw(&self) {
        self.window.request_redraw();
    }

    /// Passes a window event to egui, and asks for a redraw where egui wants one. A changed size also resizes the
    /// surface, and an occluded window is not drawn.
    pub fn on_event(&mut self, event: &WindowEvent) {
        match event {
            WindowEvent::Resized(size) => self.resize(*size),
            WindowEvent::Occluded(hidden) => self.hidden = *hidden,
            _ => {}
        }
        self.clipboard.before_event(event, &mut self.input);
        if self.input.on_window_event(&self.window, event).repaint {
            self.window.request_redraw();
        }
        self.clipboard.after_event(event, &mut self.input);
    }

    /// Passes an AccessKit event (tree requested, action requested, deactivated) to egui, and asks for a redraw.
    pub fn on_access(&mut self, event: egui_winit::accesskit_winit::WindowEvent) {
        use egui_winit::accesskit_winit::WindowEvent as Access;
        match event {
            Access::InitialTreeRequested => self.input.egui_ctx().enable_accesskit(),
            Access::ActionRequested(request) => self.input.on_accesskit_action_request(request),
            Access::AccessibilityDeactivated => self.input.egui_ctx().disable_accesskit(),
        }
        self.window.request_redraw();
    }

    /// Passes raw movement of the mouse to egui while the pointer is grabbed, and asks for a redraw then.
    pub fn on_mouse_motion(&mut self, delta: (f64, f64)) {
        if self.holds_pointer && self.input.on_mouse_motion(delta) {
            self.window.request_redraw();
        }
    }

    /// Grabs or releases the pointer, hides or shows it. On a system that can't lock it in place it is confined to the
    /// window; on one that can do neither it is free, and walking works up to the window's edge.
    fn obey(&mut self, command: &egui::ViewportCommand) {
        match command {
            egui::ViewportCommand::CursorGrab(grab) => {
                self.holds_pointer = *grab != egui::CursorGrab::None;
                let grabbed = if self.holds_pointer {
                    let locked = self.window.set_cursor_grab(CursorGrabMode::Locked);
                    locked.or_else(|_| self.window.set_cursor_grab(CursorGrabMode::Confined))
                } else {
                    self.window.set_cursor_grab(CursorGrabMode::None)
                };
                if let Err(error) = grabbed {
                    let words = format!("the pointer can't be held ({error}): walking turns until it meets an edge");
                    self.failure = Some(words);
                }
            }
            egui::ViewportCommand::CursorVisible(is_visible) => self.window.set_cursor_visible(*is_visible),
            _ => {}
        }
    }

    fn resize(&mut self, size: PhysicalSize<u32>) {
        if let (Some(width), Some(height)) = (NonZeroU32::new(size.width), NonZeroU32::new(size.height)) {
            self.painter.on_window_resized(ViewportId::ROOT, width, height);
        }
    }

    /// Runs `ui` and draws its output. Does nothing, and does not run `ui`, while the window is fully hidden or has no
    /// area; events that must wait for a later frame are left, and a redraw is asked for.
    pub fn draw(&mut self, event_loop: &ActiveEventLoop, ctx: &Context, ui: impl FnMut(&mut egui::Ui)) {
        let size = self.window.inner_size();
        if self.hidden || size.width == 0 || size.height == 0 {
            return;
        }
        let mut input = self.input.take_egui_input(&self.window);
        self.events.append(&mut input.events);
        input.events = events_of_frame(ctx, &mut self.events);
        if !self.events.is_empty() {
            self.window.request_redraw();
        }
        let output = ctx.run_ui(input, ui);
        if let Some(failure) = self.clipboard.after_frame(&output.platform_output.commands) {
            self.failure = Some(failure);
        }
        self.input.handle_platform_output_with_event_loop(&self.window, event_loop, output.platform_output);
        for command in output.viewport_output.values().flat_map(|output| &output.commands) {
            self.obey(command);
        }
        let mut primitives = ctx.tessellate(output.shapes, output.pixels_per_point);
        self.textures.append(output.textures_delta);
        let ground = ctx.global_style().visuals.panel_fill;
        let screen = ScreenDescriptor { size_in_pixels: size.into(), pixels_per_point: output.pixels_per_point };
        // egui copies texels as they are only where neither texture nor surface encodes them.
        if let Some(gpu) = self.painter.render_state().filter(|gpu| !gpu.target_format.is_srgb()) {
            primitives = vec![self.kept.draw(&gpu, &screen, &primitives, ground, &mut self.textures)];
        }
        self.painter.paint_and_update_textures(
            ViewportId::ROOT,
            output.pixels_per_point,
            ground.to_normalized_gamma_f32(),
            &primitives,
            &mut self.textures,
            Vec::new(),
            &self.window,
        );
    }
}

impl Drop for WindowSurface {
    fn drop(&mut self) {
        // Changes that were not drawn yet never will be; if they were dropped, egui would report a bug.
        self.textures.clear();
    }
}

/// What the window shows, which is kept from frame to frame, as a texture of egui's.
#[derive(Default)]
struct KeptPicture {
    target: RetainedTarget,
    shown: Option<(wgpu::Texture, TextureId)>,
}

impl KeptPicture {
    /// Draws what changed of the window, and returns what shows all of it.
    fn draw(
        &mut self,
        gpu: &RenderState,
        screen: &ScreenDescriptor,
        primitives: &[ClippedPrimitive],
        ground: Color32,
        textures: &mut egui::TexturesDelta,
    ) -> ClippedPrimitive {
        let texture = self.target.draw(gpu, screen, primitives, ground, textures);
        let id = match self.shown.take() {
            Some((shown, id)) if shown == texture => id,
            other => {
                let mut renderer = gpu.renderer.write();
                if let Some((_, id)) = other {
                    renderer.free_texture(&id);
                }
                let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
                renderer.register_native_texture(&gpu.device, &view, wgpu::FilterMode::Nearest)
            }
        };
        self.shown = Some((texture, id));
        let [width, height] = screen.size_in_pixels.map(|side| side as f32 / screen.pixels_per_point);
        let rect = Rect::from_min_size(Pos2::ZERO, vec2(width, height));
        let mut mesh = Mesh::with_texture(id);
        mesh.add_rect_with_uv(rect, Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0)), Color32::WHITE);
        ClippedPrimitive { clip_rect: rect, primitive: Primitive::Mesh(mesh) }
    }
}

fn configuration(event_loop: &ActiveEventLoop, adapter: Option<&str>) -> WgpuConfiguration {
    let mut setup = WgpuSetupCreateNew::from_display_handle(event_loop.owned_display_handle());
    setup.device_descriptor = Arc::new(device_descriptor);
    let wanted = adapter.map(str::to_lowercase);
    setup.native_adapter_selector = Some(Arc::new(move |adapters, surface| {
        let can_draw = |a: &&wgpu::Adapter| surface.is_none_or(|surface| a.is_surface_supported(surface));
        let is_wanted =
            |a: &&wgpu::Adapter| wanted.as_ref().is_none_or(|wanted| a.get_info().name.to_lowercase().contains(wanted));
        let able = adapters.iter().filter(can_draw).filter(is_wanted);
        offscreen::first_with_device(able, device_descriptor, false).ok_or_else(|| match &wanted {
            Some(wanted) => format!("no GPU called `{wanted}` can draw on this display"),
            None => "no GPU can draw on this display".to_owned(),
        })
    }));
    WgpuConfiguration { wgpu_setup: WgpuSetup::CreateNew(setup), ..WgpuConfiguration::default() }
}

fn device_descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
    wgpu::DeviceDescriptor {
        label: Some("stencilscope window"),
        // Pictures may be as large as the GPU allows.
        required_limits: wgpu::Limits {
            max_texture_dimension_2d: adapter.limits().max_texture_dimension_2d,
            ..wgpu::Limits::default()
        },
        memory_hints: MEMORY_HINTS,
        ..Default::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_icon_is_drawn() {
        assert!(icon().is_some());
    }

    #[test]
    fn the_window_fits_the_screen() {
        assert_eq!(first_size(Some([1920.0, 1080.0]), None), FIRST_SIZE);
        assert_eq!(first_size(Some([1280.0, 800.0]), None), [1216.0, 760.0]);
        assert_eq!(first_size(None, None), FIRST_SIZE);
        let closed = Some([1500.0, 950.0]);
        assert_eq!(first_size(Some([1920.0, 1080.0]), closed), [1500.0, 950.0]);
        assert_eq!(first_size(Some([1280.0, 800.0]), closed), [1216.0, 760.0], "another screen");
        assert_eq!(first_size(None, Some([20.0, 20.0])), FIRST_SIZE);
        assert_eq!(first_size(Some([0.0, 0.0]), None), FIRST_SIZE, "of a screen that nothing is known of");
    }
}

//! The inspector's panels: data in, pictures and [`Action`]s out.
//!
//! Nothing here runs a frame or touches a GPU. [`Inspector::ui`] draws the panels from [`State`]
//! and returns what the person asked for; the app does it and puts the outcome back into the
//! state. So the same panels run in a window and, headless, in tests.
//!
//! ```text
//! top bar      open, scene, techniques
//! Passes │ Settings      Picture (the largest)      Pixel
//! status bar   picture, hovered pixel, times, adapter
//! ```

mod action;
mod keys;
mod message;
mod open_dialog;
mod palette;
mod passes;
mod picture;
mod pixel;
mod settings;
mod state;
mod status;
mod texture;
mod theme;
mod top_bar;

pub use action::Action;
pub use palette::{label_color, label_name, signed_stencil, stencil_color};
pub use state::{DepthRange, Notice, PictureKind, SceneEntry, Setup, State};
pub use theme::install as install_theme;

use egui_tiles::{Behavior, Container, Linear, LinearDir, SimplificationOptions, TileId, Tiles, Tree, UiResponse};
use texture::Textures;

/// The panels and what they remember.
pub struct Inspector {
    /// What is shown; the app changes it between frames.
    pub state: State,
    tiles: Tree<Pane>,
    textures: Textures,
}

/// What a tile shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pane {
    Passes,
    Settings,
    Picture,
    Pixel,
}

impl Default for Inspector {
    fn default() -> Inspector {
        Inspector { state: State::default(), tiles: layout(), textures: Textures::default() }
    }
}

impl Inspector {
    /// Draws everything into `ui` and returns what was asked for, in order.
    pub fn ui(&mut self, ui: &mut egui::Ui) -> Vec<Action> {
        let mut actions = Vec::new();
        let Inspector { state, tiles, textures } = self;
        keys::handle(ui, state);
        open_dialog::take_dropped(ui, &mut actions);
        egui::Panel::top("top bar").frame(theme::bar_frame()).show(ui, |ui| top_bar::ui(ui, state, &mut actions));
        egui::Panel::bottom("status bar").frame(theme::bar_frame()).show(ui, |ui| status::ui(ui, state));
        if state.notice.is_some() {
            egui::Panel::top("message").frame(theme::bar_frame()).show(ui, |ui| message::ui(ui, state));
        }
        egui::CentralPanel::default().frame(egui::Frame::new().fill(theme::BACKGROUND)).show(ui, |ui| {
            tiles.ui(&mut Panes { state, textures, actions: &mut actions }, ui);
        });
        open_dialog::ui(ui, state, &mut actions);
        state.advance_playing(ui.ctx());
        actions
    }
}

fn layout() -> Tree<Pane> {
    let mut tiles = Tiles::default();
    let [passes, settings, picture, pixel] =
        [Pane::Passes, Pane::Settings, Pane::Picture, Pane::Pixel].map(|pane| tiles.insert_pane(pane));
    let left = tiles.insert_tab_tile(vec![passes, settings]);
    let middle = tiles.insert_tab_tile(vec![picture]);
    let right = tiles.insert_tab_tile(vec![pixel]);
    let mut columns = Linear::new(LinearDir::Horizontal, vec![left, middle, right]);
    for (tile, share) in [(left, 0.21), (middle, 0.54), (right, 0.25)] {
        columns.shares.set_share(tile, share);
    }
    let root = tiles.insert_new(egui_tiles::Tile::Container(Container::Linear(columns)));
    Tree::new(egui::Id::unique("inspector tiles"), root, tiles)
}

/// Draws tiles.
struct Panes<'a> {
    state: &'a mut State,
    textures: &'a mut Textures,
    actions: &'a mut Vec<Action>,
}

impl Behavior<Pane> for Panes<'_> {
    fn pane_ui(&mut self, ui: &mut egui::Ui, _tile: TileId, pane: &mut Pane) -> UiResponse {
        egui::Frame::new().fill(theme::PANEL).inner_margin(theme::SPACE * 2.0).show(ui, |ui| {
            ui.set_min_size(ui.available_size());
            match pane {
                Pane::Passes => passes::ui(ui, self.state, self.textures),
                Pane::Settings => settings::ui(ui, self.state, self.actions),
                Pane::Picture => picture::ui(ui, self.state, self.textures),
                Pane::Pixel => pixel::ui(ui, self.state),
            }
        });
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> egui::WidgetText {
        match pane {
            Pane::Passes => "Passes",
            Pane::Settings => "Settings",
            Pane::Picture => "Picture",
            Pane::Pixel => "Pixel",
        }
        .into()
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions { all_panes_must_have_tabs: true, ..SimplificationOptions::default() }
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        1.0
    }

    fn tab_bar_height(&self, _style: &egui::Style) -> f32 {
        theme::ROW + theme::SPACE
    }

    fn tab_bar_color(&self, _visuals: &egui::Visuals) -> egui::Color32 {
        theme::BACKGROUND
    }

    fn tab_bg_color(
        &self,
        _visuals: &egui::Visuals,
        _tiles: &Tiles<Pane>,
        _tile: TileId,
        tab: &egui_tiles::TabState,
    ) -> egui::Color32 {
        if tab.active { theme::PANEL } else { theme::BACKGROUND }
    }

    fn tab_text_color(
        &self,
        _visuals: &egui::Visuals,
        _tiles: &Tiles<Pane>,
        _tile: TileId,
        tab: &egui_tiles::TabState,
    ) -> egui::Color32 {
        if tab.active { theme::TEXT } else { theme::DIM }
    }
}

//! The docked panels: passes and settings on the left, picture in the middle with the report below
//! it, pixel on the right; on a phone the picture, and below it all others as tabs.
//!
//! They can be dragged and resized. Until the user does, the side panels keep their width, the
//! report its height, and the picture takes what is left.

use crate::ask::{DiagnosisOf, FaultsOf, ReportOf};
use crate::inspector::action::{Action, LayoutPreset, PanelKind};
use crate::inspector::model::Model;
use crate::inspector::panels::Panels;

use crate::inspector::look::theme;
use crate::inspector::shell::arrangement::{self, TileDrag};
use crate::inspector::shell::presets;
use egui::{Color32, CornerRadius, Id, Margin, Response, Role, Sense, Stroke, Ui, WidgetInfo, WidgetText, vec2};
use egui_tiles::{
    Behavior, Container, EditAction, SimplificationOptions, TabState, Tile, TileId, Tiles, Tree, UiResponse,
};

/// Widths of the side panels in points, where the window is wide enough.
const LEFT_WIDTH: f32 = 264.0;
/// Below this width the panels stand below the picture, points: beside it they would have no space.
const NARROW: f32 = 640.0;
/// From this width on the scene is beside the picture, points: the picture is as large as in a window of usual width.
const WIDE: f32 = 2200.0;
/// The largest share of the window's width for a side panel.
const SIDE_SHARE: f32 = 0.28;
/// Height of the report in points, without and with something to show.
const EMPTY_REPORT_HEIGHT: f32 = 88.0;
const REPORT_HEIGHT: f32 = 312.0;
/// The largest share of the window's height for the report.
const REPORT_SHARE: f32 = 0.42;
/// Height of the tabs and tools over a picture in a narrow window, points.
const PICTURE_TOOLS: f32 = 112.0;
/// Least and usual space that a tab has beside its word, points, both sides together.
const TAB_PADDING: [f32; 2] = [8.0, 24.0];
/// The largest share of a narrow window's height for the picture.
const PICTURE_SHARE: f32 = 0.55;

/// A stored layout, in egui's own format.
pub type StoredLayout = serde_json::Value;

/// The docked panels and their layout, which is the initial one until the user changes it.
#[derive(Debug)]
pub struct Dock {
    tree: Tree<PanelKind>,
    /// The column of the picture and what is below it, from the top.
    middle: TileId,
    column: [TileId; 2],
    /// The row of the middle column and the side panels, and those; `None` in a narrow window.
    row: Option<[TileId; 3]>,
    arranged_by_user: bool,
    /// Which of the layouts of the menu View was taken last; `None` once the user has moved something, and where a layout
    /// that was stored came back.
    preset: Option<LayoutPreset>,
    size_class: SizeClass,
    /// While the window is narrow: the layout that the user made of a wider one, and which one of the menu View it is.
    kept: Option<(Tree<PanelKind>, Option<LayoutPreset>)>,
    /// The tiles that were shown in the last frame.
    shown: Vec<TileId>,
    /// A pixel was picked in the last frame.
    had_pick: bool,
    /// The stress cases, which are always there, were shown in this layout.
    has_shown_stress: bool,
}

/// Size classes of windows by their width, each with a layout of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SizeClass {
    /// The panels are below the picture.
    Narrow,
    /// The panels are at both sides of the picture and below it.
    Usual,
    /// The scene is beside the picture, too.
    Wide,
}

impl SizeClass {
    fn of(width: f32) -> SizeClass {
        match width {
            width if width < NARROW => SizeClass::Narrow,
            width if width < WIDE => SizeClass::Usual,
            _ => SizeClass::Wide,
        }
    }
}

impl Dock {
    /// Returns the initial layout.
    pub fn new() -> Dock {
        Dock::first(SizeClass::Usual)
    }

    /// Returns the initial layout of a window of such a width.
    fn first(size_class: SizeClass) -> Dock {
        use PanelKind::{
            Bench, Diagnosis, Explain, Passes, Picture, Pixel, Report, Scene, Settings, ShadowMap, State, Stress,
        };
        let mut tiles = Tiles::default();
        let mut group = |panels: &[PanelKind]| {
            let panes = panels.iter().map(|panel| tiles.insert_pane(*panel)).collect();
            tiles.insert_tab_tile(panes)
        };
        let (sides, below) = match size_class {
            SizeClass::Narrow => {
                (None, group(&[Passes, Pixel, Explain, Settings, State, Diagnosis, Report, Stress, Bench]))
            }
            SizeClass::Usual | SizeClass::Wide => {
                let left = group(&[Passes, Settings]);
                let below = group(&[Report, Diagnosis, Stress]);
                (Some([left, group(&[Pixel, State, Explain, Bench])]), below)
            }
        };
        let picture = if size_class == SizeClass::Wide {
            let beside = [group(&[Picture]), group(&[Scene, ShadowMap])];
            tiles.insert_horizontal_tile(beside.to_vec())
        } else {
            group(&[Picture, Scene, ShadowMap])
        };
        let column = [picture, below];
        let middle = tiles.insert_vertical_tile(column.to_vec());
        let row = sides.map(|[left, right]| [tiles.insert_horizontal_tile(vec![left, middle, right]), left, right]);
        let root = row.map_or(middle, |[row, ..]| row);
        let tree = Tree::new(Id::unique("inspector dock"), root, tiles);
        Dock {
            tree,
            middle,
            column,
            row,
            arranged_by_user: false,
            preset: Some(LayoutPreset::First),
            size_class,
            kept: None,
            shown: Vec::new(),
            had_pick: false,
            has_shown_stress: false,
        }
    }

    /// Returns the layout that the user made of a window that is not narrow; `None` while it is the initial one.
    pub fn layout(&self) -> Option<StoredLayout> {
        let tree = match self.size_class {
            SizeClass::Narrow => self.kept.as_ref().map(|(tree, _)| tree),
            SizeClass::Usual | SizeClass::Wide => self.arranged_by_user.then_some(&self.tree),
        };
        tree.and_then(|tree| serde_json::to_value(tree).ok())
    }

    /// Takes the layout of a window of another size class where the window has become one: what the user made of a narrow
    /// window is dropped then, and what was made of a wider one comes back.
    fn follow(&mut self, size_class: SizeClass) {
        let is_narrow = size_class == SizeClass::Narrow;
        let crosses = is_narrow != (self.size_class == SizeClass::Narrow);
        if !crosses && (self.arranged_by_user || size_class == self.size_class) {
            return;
        }
        let made = match is_narrow {
            true => self.arranged_by_user.then(|| (self.tree.clone(), self.preset)),
            false => self.kept.take(),
        };
        *self = Dock { had_pick: self.had_pick, ..Dock::first(size_class) };
        match made {
            Some((tree, preset)) if !is_narrow => {
                (self.tree, self.arranged_by_user, self.preset) = (tree, true, preset);
            }
            made => self.kept = made,
        }
    }

    /// Restores a stored layout, with panels that it lacks added. One that can't be read or contains a panel twice is
    /// ignored.
    pub fn restore(&mut self, layout: StoredLayout) {
        let Ok(mut tree) = serde_json::from_value::<Tree<PanelKind>>(layout) else { return };
        arrangement::complete(&mut tree);
        if arrangement::is_whole(&tree) {
            self.tree = tree;
            arrangement::fix(&mut self.tree, None);
            (self.arranged_by_user, self.preset) = (true, None);
        }
    }

    /// Takes one of the layouts that the menu View offers, in a window of this width, points; another than the initial one
    /// counts as made by the user.
    pub fn arrange(&mut self, preset: LayoutPreset, width: f32) {
        match presets::tree(preset, width, self.size_class == SizeClass::Narrow) {
            Some(tree) => (self.tree, self.arranged_by_user, self.preset) = (tree, true, Some(preset)),
            None => *self = Dock { had_pick: self.had_pick, ..Dock::first(self.size_class) },
        }
    }

    /// Draws all panels into the rest of the window, and shows the tabs that other panels asked for. The initial layout
    /// follows the window's size; once the user has changed it, it stays.
    pub fn ui(&mut self, ui: &mut Ui, panels: &mut Panels, model: &mut Model, actions: &mut Vec<Action>) {
        let size_class = SizeClass::of(ui.available_width());
        self.follow(size_class);
        if !self.arranged_by_user {
            self.keep_widths(ui.available_width());
            let is_shown = |panel| {
                self.tree
                    .active_tiles()
                    .into_iter()
                    .any(|id| matches!(self.tree.tiles.get(id), Some(Tile::Pane(shown)) if *shown == panel))
            };
            self.has_shown_stress |= is_shown(PanelKind::Stress);
            // The same for all tabs below: going from one to another moves nothing.
            let is_empty = !self.has_shown_stress && !has_content_below(model);
            let size = ui.available_size();
            let below = match size_class {
                // The picture is as wide as the window, and about as high as its own width asks for.
                SizeClass::Narrow => size.y - (PICTURE_TOOLS + size.x * 0.75).min(size.y * PICTURE_SHARE),
                _ => if is_empty { EMPTY_REPORT_HEIGHT } else { REPORT_HEIGHT }.min(size.y * REPORT_SHARE),
            };
            self.keep_heights(size.y, below);
        }
        let has_pick = model.selection.pick.is_some();
        if !std::mem::replace(&mut self.had_pick, has_pick) && has_pick && size_class == SizeClass::Narrow {
            // What is known of it lies behind another tab. What is asked for by name comes after.
            model.requests.panels.insert(0, PanelKind::Pixel);
        }
        for wanted in std::mem::take(&mut model.requests.panels) {
            self.tree.make_active(|_, tile| matches!(tile, Tile::Pane(panel) if *panel == wanted));
        }
        let shown = self.tree.active_tiles();
        model.shown_panels = shown
            .iter()
            .filter_map(|id| if let Some(Tile::Pane(panel)) = self.tree.tiles.get(*id) { Some(*panel) } else { None })
            .collect();
        if !model.shown_panels.contains(&PanelKind::ShadowMap) {
            panels.shadow_map.hide(model);
        }
        // A panel knows whether it scrolls, and so its width, one frame after it is first shown.
        if self.shown != shown {
            self.shown = shown;
            ui.ctx().request_repaint();
        }
        let (size, drag) = (ui.available_size(), TileDrag::under_way(&self.tree, ui));
        let fitted = if self.arranged_by_user { arrangement::fit(&mut self.tree, size) } else { Vec::new() };
        let mut behavior =
            Panes { panels, model, actions, edited: false, dropped: false, resized: false, theme: theme::of(ui) };
        self.tree.ui(&mut behavior, ui);
        let Panes { edited, dropped, resized, .. } = behavior;
        if !resized {
            arrangement::restore_waiting(&mut self.tree, fitted);
        }
        if dropped && let Some(drag) = drag {
            drag.settle(&mut self.tree, size);
        }
        self.arranged_by_user |= edited;
        self.preset = self.preset.filter(|_| !edited);
        model.layout = self.preset;
    }

    fn keep_widths(&mut self, width: f32) {
        let Some([row, left, right]) = self.row else { return };
        let most = width * SIDE_SHARE;
        let sides = [LEFT_WIDTH.min(most), presets::PIXEL_WIDTH.min(most)];
        if let Some(Tile::Container(Container::Linear(row))) = self.tree.tiles.get_mut(row) {
            row.shares.set_share(left, sides[0]);
            row.shares.set_share(right, sides[1]);
            row.shares.set_share(self.middle, (width - sides[0] - sides[1]).max(1.0));
        }
    }

    fn keep_heights(&mut self, height: f32, below: f32) {
        let [picture, lower] = self.column;
        if let Some(Tile::Container(Container::Linear(column))) = self.tree.tiles.get_mut(self.middle) {
            column.shares.set_share(lower, below);
            column.shares.set_share(picture, (height - below).max(1.0));
        }
    }
}

/// Returns whether a tab below the picture has something to show, or will have: a report or a diagnosis.
fn has_content_below(model: &Model) -> bool {
    let answers = &model.answers;
    let has_report = answers.last::<ReportOf>().is_some_and(|(_, found)| !found.report.rows.is_empty());
    let is_asked = answers.asked::<ReportOf>().is_some()
        || answers.asked::<DiagnosisOf>().is_some()
        || answers.asked::<FaultsOf>().is_some();
    has_report || is_asked || model.last_diagnosis().is_some()
}

struct Panes<'a> {
    panels: &'a mut Panels,
    model: &'a mut Model,
    actions: &'a mut Vec<Action>,
    edited: bool,
    dropped: bool,
    resized: bool,
    theme: &'static theme::Theme,
}

/// Returns how much wider than its word a tab is, points: where the tabs of its group have less space than usual, each
/// gets less, so that none is hidden behind an arrow as long as their words fit.
fn tab_padding(tiles: &Tiles<PanelKind>, ui: &Ui, tile: TileId) -> f32 {
    let [least, most] = TAB_PADDING;
    let group = tiles.parent_of(tile).and_then(|group| Some((tiles.get_container(group)?, tiles.rect(group)?)));
    let Some((Container::Tabs(tabs), rect)) = group else { return most };
    let font = egui::TextStyle::Button.resolve(ui.style());
    let word = |panel: &PanelKind| {
        ui.painter().layout_no_wrap(panel.title().to_owned(), font.clone(), Color32::PLACEHOLDER).size().x
    };
    let words: f32 = tabs.children.iter().filter_map(|child| tiles.get_pane(child)).map(word).sum();
    ((rect.width() - words) / tabs.children.len().max(1) as f32).floor().clamp(least, most)
}

impl Behavior<PanelKind> for Panes<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile_id: TileId, panel: &mut PanelKind) -> UiResponse {
        // Without a ground of its own: the window is cleared to it. Where a CPU draws, every layer costs.
        let margin = match panel {
            PanelKind::Picture | PanelKind::Scene | PanelKind::ShadowMap => 0,
            _ => 8,
        };
        let frame = egui::Frame::new().inner_margin(Margin::same(margin));
        let place = ui.max_rect();
        let whole = ui.interact(place, ui.scope_id().with("panel"), Sense::hover());
        whole.widget_info(|| WidgetInfo::labeled(Role::TabPanel, true, panel.title()));
        frame.show(ui, |ui| {
            ui.set_min_size(ui.available_size());
            self.panels.ui(*panel, ui, self.model, self.actions);
        });
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, panel: &PanelKind) -> WidgetText {
        panel.title().into()
    }

    fn tab_ui(
        &mut self,
        tiles: &mut Tiles<PanelKind>,
        ui: &mut Ui,
        id: Id,
        tile_id: TileId,
        tab: &TabState,
    ) -> Response {
        let color = if tab.active { theme::of(ui).text } else { theme::of(ui).dim };
        let text = self.tab_title_for_tile(tiles, tile_id);
        let font = egui::TextStyle::Button.resolve(ui.style());
        let galley = text.into_galley(ui, Some(egui::TextWrapMode::Extend), f32::INFINITY, font);
        let padding = tab_padding(tiles, ui, tile_id);
        let (_, rect) = ui.allocate_space(vec2(galley.size().x + padding, ui.available_height()));
        let response = ui.interact(rect, id, Sense::click_and_drag());
        let name = galley.text().to_owned();
        response.widget_info(|| WidgetInfo::selected(Role::Tab, true, tab.active, &name));
        if ui.is_rect_visible(rect) && !tab.is_being_dragged {
            if tab.active {
                ui.painter().rect_filled(rect, CornerRadius::ZERO, theme::of(ui).panel);
                ui.painter().hline(rect.x_range(), rect.top() + 1.0, Stroke::new(2.0, theme::of(ui).selected));
            }
            if response.has_focus() {
                let outline = Stroke::new(1.0, theme::of(ui).focus);
                ui.painter().rect_stroke(rect.shrink(2.0), CornerRadius::same(2), outline, egui::StrokeKind::Inside);
            }
            ui.painter().galley(rect.center() - galley.size() / 2.0, galley, color);
        }
        self.on_tab_button(tiles, tile_id, response)
    }

    fn tab_bar_height(&self, _style: &egui::Style) -> f32 {
        28.0
    }

    fn tab_bar_color(&self, visuals: &egui::Visuals) -> Color32 {
        theme::in_visuals(visuals).background
    }

    fn tab_bar_hline_stroke(&self, _visuals: &egui::Visuals) -> Stroke {
        Stroke::NONE
    }

    fn resize_stroke(&self, _style: &egui::Style, state: egui_tiles::ResizeState) -> Stroke {
        let color = if state == egui_tiles::ResizeState::Idle { self.theme.line } else { self.theme.selected };
        Stroke::new(1.0, color)
    }

    fn simplification_options(&self) -> SimplificationOptions {
        arrangement::options()
    }

    fn on_edit(&mut self, action: EditAction) {
        self.edited |= action != EditAction::TabSelected;
        self.dropped |= action == EditAction::TileDropped;
        self.resized |= action == EditAction::TileResized;
    }
}

//! The layouts that the menu View offers, as trees of tiles.

use crate::inspector::action::{LayoutPreset, PanelKind};
use egui::Id;
use egui_tiles::{Container, LinearDir, Tile, TileId, Tiles, Tree};

/// Width of the picked pixel's panel, points, where the window is wide enough.
pub const PIXEL_WIDTH: f32 = 332.0;
/// Shares of the window's width for the picked pixel: mostly, and at most where that is less than its values need.
const PIXEL_SHARES: [f32; 2] = [0.28, 0.4];

/// Returns a layout with every panel once in a window of this width, points; `None` for the initial one, which follows the
/// window's size by itself. In a narrow window what is side by side elsewhere is one below the other.
pub fn tree(preset: LayoutPreset, width: f32, is_narrow: bool) -> Option<Tree<PanelKind>> {
    use PanelKind::{
        Bench, Diagnosis, Explain, Passes, Picture, Pixel, Report, Scene, Settings, ShadowMap, State, Stress,
    };
    let mut made = TileMaker { tiles: Tiles::default(), is_narrow };
    let root = match preset {
        LayoutPreset::First => return None,
        LayoutPreset::PictureAndScene | LayoutPreset::CompareTwo => {
            let pictures = match preset {
                LayoutPreset::PictureAndScene => {
                    let beside = [made.tabs(&[Picture]), made.tabs(&[Scene, ShadowMap])];
                    made.row(beside, 0.5)
                }
                _ => made.tabs(&[Picture, Scene, ShadowMap]),
            };
            let below = [made.tabs(&[Passes, Settings]), made.tabs(&[Report, Diagnosis, Stress])];
            let below = made.row(below, 0.4);
            let left = made.column([pictures, below], 0.66);
            let right = made.tabs(&[Pixel, State, Explain, Bench]);
            let [usual, most] = PIXEL_SHARES;
            made.row([left, right], 1.0 - (PIXEL_WIDTH / width.max(1.0)).clamp(usual, most))
        }
        LayoutPreset::Teach => {
            // What many look at together has the large place; beside it no tab is hidden behind an arrow.
            let picture = made.tabs(&[Picture, Scene, ShadowMap, Report, Stress]);
            let pixel = made.tabs(&[Pixel, Explain, State, Diagnosis]);
            let passes = made.tabs(&[Passes, Settings, Bench]);
            let right = made.column([pixel, passes], 0.6);
            // As much as the values of the pixel leave.
            made.row([picture, right], (1.0 - PIXEL_WIDTH / width.max(1.0)).clamp(0.6, 0.7))
        }
    };
    Some(Tree::new(Id::unique("inspector dock"), root, made.tiles))
}

struct TileMaker {
    tiles: Tiles<PanelKind>,
    is_narrow: bool,
}

impl TileMaker {
    fn tabs(&mut self, panels: &[PanelKind]) -> TileId {
        let panes = panels.iter().map(|panel| self.tiles.insert_pane(*panel)).collect();
        self.tiles.insert_tab_tile(panes)
    }

    fn row(&mut self, parts: [TileId; 2], first: f32) -> TileId {
        let direction = if self.is_narrow { LinearDir::Vertical } else { LinearDir::Horizontal };
        self.linear(direction, parts, first)
    }

    fn column(&mut self, parts: [TileId; 2], first: f32) -> TileId {
        self.linear(LinearDir::Vertical, parts, first)
    }

    /// Adds two tiles side by side or below each other; `first` is the share of the first.
    fn linear(&mut self, direction: LinearDir, parts: [TileId; 2], first: f32) -> TileId {
        let tile = match direction {
            LinearDir::Horizontal => self.tiles.insert_horizontal_tile(parts.to_vec()),
            LinearDir::Vertical => self.tiles.insert_vertical_tile(parts.to_vec()),
        };
        if let Some(Tile::Container(Container::Linear(linear))) = self.tiles.get_mut(tile) {
            linear.shares.set_share(parts[0], first);
            linear.shares.set_share(parts[1], 1.0 - first);
        }
        tile
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspector::shell::arrangement::is_whole;

    #[test]
    fn every_layout_has_every_panel_once() {
        for preset in LayoutPreset::ALL {
            for is_narrow in [false, true] {
                let whole = tree(preset, 1280.0, is_narrow).is_none_or(|tree| is_whole(&tree));
                assert!(whole, "{}", preset.name());
            }
        }
    }
}

//! The rules for a docked layout: every panel occurs once, in a group of tabs, large enough to be used.
//!
//! egui's tiles allow more. A tile that is dropped between others gets one share of the space, where theirs are
//! hundreds of points: it is as thin as a line. A panel that is dropped into the half of a group splits the panel on
//! top of it, and a tab called `Horizontal` contains both. So each drop is corrected here: a split is one of the whole
//! group, what is new gets as much space as the others have on average, and a drop for which there is no space joins
//! the group under the pointer.

use crate::inspector::action::PanelKind;
use egui::{Pos2, Vec2, vec2};
use egui_tiles::{Container, LinearDir, Shares, SimplificationOptions, Tile, TileId, Tiles, Tree};
use std::collections::BTreeSet;

/// The least size of a group, with its tabs, points.
const LEAST: Vec2 = vec2(120.0, 96.0);
/// Gap between two tiles, points.
const GAP: f32 = 1.0;

/// Returns the options by which every panel is in tabs, and nothing else is.
pub fn options() -> SimplificationOptions {
    SimplificationOptions { all_panes_must_have_tabs: true, flatten_tabs_in_tabs: true, ..Default::default() }
}

/// A drag of a tile, with where it would be dropped and the layout before.
#[derive(Debug)]
pub struct TileDrag {
    tile: TileId,
    before: Tree<PanelKind>,
    pointer: Option<Pos2>,
}

impl TileDrag {
    /// Returns the drag of a tile that is under way, with the layout before it; `None` where none is.
    pub fn under_way(tree: &Tree<PanelKind>, ui: &egui::Ui) -> Option<TileDrag> {
        let tile = tree.dragged_id(ui)?;
        Some(TileDrag { tile, before: tree.clone(), pointer: ui.input(|input| input.pointer.interact_pos()) })
    }

    /// Corrects the layout after the tile was dropped. Where its panels would get too small in a window of `size`, or a
    /// panel would be lost, the layout is as before the drag, with the tile added to the group of tabs under the
    /// pointer, if any.
    pub fn settle(self, tree: &mut Tree<PanelKind>, size: Vec2) {
        fix(tree, self.pointer);
        let least = |tree: &Tree<PanelKind>| tree.root.map_or(Vec2::ZERO, |root| least(&tree.tiles, root));
        let (needed, most) = (least(tree), size.max(least(&self.before)));
        let has_space = needed.x <= most.x && needed.y <= most.y;
        if has_space && is_whole(tree) {
            return;
        }
        let group = self.pointer.and_then(|at| group_at(&self.before.tiles, at, &|id| id != self.tile));
        *tree = self.before;
        if let Some(group) = group {
            tree.move_tile_to_container(self.tile, group, usize::MAX, false);
            fix(tree, None);
        }
    }
}

/// Returns whether every kind of panel is in the layout exactly once.
pub fn is_whole(tree: &Tree<PanelKind>) -> bool {
    let mut panels = Vec::new();
    let is_tree = tree.root.is_some_and(|root| visit(&tree.tiles, root, &mut BTreeSet::new(), &mut panels));
    panels.sort_unstable();
    is_tree && panels == PanelKind::ALL
}

/// Adds panels that are missing from a layout, as in one that an older version stored: at the end of the tabs with
/// Explain, or of the first tabs. Does nothing where a tile is missing or occurs twice, or there are no tabs.
pub fn complete(tree: &mut Tree<PanelKind>) {
    let mut panels = Vec::new();
    let is_tree = tree.root.is_some_and(|root| visit(&tree.tiles, root, &mut BTreeSet::new(), &mut panels));
    if !is_tree {
        return;
    }
    for panel in PanelKind::ALL.into_iter().filter(|panel| !panels.contains(panel)) {
        let explain = tree.tiles.find_pane(&PanelKind::Explain);
        let tabs = explain.and_then(|tile| tree.tiles.parent_of(tile));
        let is_tabs = |tile: &TileId| matches!(tree.tiles.get(*tile), Some(Tile::Container(Container::Tabs(_))));
        let first = || tree.tiles.tile_ids().filter(is_tabs).min_by_key(|tile| tile.0);
        let Some(tabs) = tabs.filter(is_tabs).or_else(first) else { return };
        let pane = tree.tiles.insert_pane(panel);
        if let Some(Tile::Container(Container::Tabs(tabs))) = tree.tiles.get_mut(tabs) {
            tabs.children.push(pane);
        }
    }
}

/// Appends the panels below a tile, in order; false where a tile is missing or occurs twice, and then not all are
/// appended. `seen` collects the tiles' numbers.
fn visit(tiles: &Tiles<PanelKind>, tile: TileId, seen: &mut BTreeSet<u64>, panels: &mut Vec<PanelKind>) -> bool {
    if !seen.insert(tile.0) {
        return false;
    }
    match tiles.get(tile) {
        None => false,
        Some(Tile::Pane(panel)) => {
            panels.push(*panel);
            true
        }
        Some(Tile::Container(container)) => container.children().all(|child| visit(tiles, *child, seen, panels)),
    }
}

/// Takes groups out of tabs, and gives new tiles their share. Panels that shared the tabs with a group join that of its
/// groups which is at `pointer`, or else its first.
pub fn fix(tree: &mut Tree<PanelKind>, pointer: Option<Pos2>) {
    share_fairly(tree);
    tree.simplify(&options());
    while let Some((tabs, split)) = split_in_tabs(&tree.tiles) {
        let Some(Tile::Container(Container::Tabs(outer))) = tree.tiles.get(tabs) else { return };
        let (others, active) = (outer.children.clone(), outer.active);
        let within = groups_below(&tree.tiles, split);
        let at = pointer.and_then(|at| group_at(&tree.tiles, at, &|id| within.contains(&id)));
        let Some(group) = at.or_else(|| within.first().copied()) else { return };
        if let Some(Tile::Container(Container::Tabs(inner))) = tree.tiles.get_mut(group) {
            let others = others.into_iter().filter(|other| *other != split);
            inner.children.extend(others);
            let active = active.filter(|active| *active != split);
            active.into_iter().for_each(|active| inner.set_active(active));
        }
        // The split replaces the tabs.
        let parent = tree.tiles.parent_of(tabs).and_then(|parent| tree.tiles.get_mut(parent));
        let place = match parent {
            Some(Tile::Container(parent)) => parent.replace_child(tabs, split),
            _ => None,
        };
        if place.is_none() {
            tree.root = Some(split);
        }
        tree.tiles.remove(tabs);
        tree.simplify(&options());
    }
    share_fairly(tree);
}

/// Returns tabs that have another container as a child, and that child; of several, the tabs with the smallest number.
/// `None` where there are none.
fn split_in_tabs(tiles: &Tiles<PanelKind>) -> Option<(TileId, TileId)> {
    let mut found: Vec<(TileId, TileId)> = Vec::new();
    for (id, tile) in tiles.iter() {
        let Tile::Container(Container::Tabs(tabs)) = tile else { continue };
        let is_split = |child: &&TileId| matches!(tiles.get(**child), Some(Tile::Container(_)));
        found.extend(tabs.children.iter().find(is_split).map(|child| (*id, *child)));
    }
    // Tiles are iterated in no fixed order.
    found.into_iter().min_by_key(|(id, _)| id.0)
}

/// Returns all groups of tabs below a tile, from left to right and top to bottom.
fn groups_below(tiles: &Tiles<PanelKind>, tile: TileId) -> Vec<TileId> {
    match tiles.get(tile) {
        Some(Tile::Container(Container::Tabs(_))) => vec![tile],
        Some(Tile::Container(container)) => {
            container.children().flat_map(|child| groups_below(tiles, *child)).collect()
        }
        _ => Vec::new(),
    }
}

/// Returns the group of tabs at a position, among those for which `is_meant` is true; of several, the one with the
/// smallest number.
fn group_at(tiles: &Tiles<PanelKind>, at: Pos2, is_meant: &dyn Fn(TileId) -> bool) -> Option<TileId> {
    let is_group = |id: &TileId| matches!(tiles.get(*id), Some(Tile::Container(Container::Tabs(_))));
    let is_there = |id: &TileId| tiles.rect(*id).is_some_and(|rect| rect.contains(at));
    tiles.tile_ids().filter(|id| is_meant(*id) && is_group(id) && is_there(id)).min_by_key(|id| id.0)
}

/// Gives tiles without a share as much as the others have on average.
fn share_fairly(tree: &mut Tree<PanelKind>) {
    for tile in tree.tiles.tiles_mut() {
        let Tile::Container(Container::Linear(linear)) = tile else { continue };
        let known = |id: &TileId| linear.shares.iter().find(|(of, _)| *of == id).map(|(_, share)| *share);
        let shares: Vec<f32> = linear.children.iter().filter_map(known).collect();
        let new: Vec<TileId> = linear.children.iter().copied().filter(|id| known(id).is_none()).collect();
        // Where no tile has one, all are equal.
        let average = if shares.is_empty() { 1.0 } else { shares.iter().sum::<f32>() / shares.len() as f32 };
        new.into_iter().for_each(|id| linear.shares.set_share(id, average));
    }
}

/// Returns the least size of a tile, in points: a fixed one for tabs and panels, and for rows and columns that of their
/// children and the gaps together.
fn least(tiles: &Tiles<PanelKind>, tile: TileId) -> Vec2 {
    let Some(Tile::Container(Container::Linear(linear))) = tiles.get(tile) else { return LEAST };
    let gaps = GAP * linear.children.len().saturating_sub(1) as f32;
    let parts = linear.children.iter().map(|child| least(tiles, *child));
    match linear.dir {
        LinearDir::Horizontal => parts.fold(vec2(gaps, 0.0), |all, part| vec2(all.x + part.x, all.y.max(part.y))),
        LinearDir::Vertical => parts.fold(vec2(0.0, gaps), |all, part| vec2(all.x.max(part.x), all.y + part.y)),
    }
}

/// Gives every group at least its least size, where a window of this size allows it. Returns the shares before, to be
/// restored once the tiles are drawn: in a larger window the shares are as they were.
pub fn fit(tree: &mut Tree<PanelKind>, size: Vec2) -> Vec<(TileId, Shares)> {
    let mut before = Vec::new();
    if let Some(root) = tree.root {
        fit_tile(&mut tree.tiles, root, size, &mut before);
    }
    before
}

/// Restores the shares of rows and columns that were changed for one window size; those that no longer exist are passed
/// over.
pub fn restore_waiting(tree: &mut Tree<PanelKind>, shares: Vec<(TileId, Shares)>) {
    for (id, before) in shares {
        if let Some(Tile::Container(Container::Linear(linear))) = tree.tiles.get_mut(id) {
            linear.shares = before;
        }
    }
}

fn fit_tile(tiles: &mut Tiles<PanelKind>, tile: TileId, size: Vec2, before: &mut Vec<(TileId, Shares)>) {
    let Some(Tile::Container(Container::Linear(linear))) = tiles.get(tile) else { return };
    let (children, is_row) = (linear.children.clone(), linear.dir == LinearDir::Horizontal);
    let along = |size: Vec2| if is_row { size.x } else { size.y };
    let space = (along(size) - GAP * children.len().saturating_sub(1) as f32).max(0.0);
    let wished = linear.shares.split(&children, space);
    let needed: Vec<f32> = children.iter().map(|child| along(least(tiles, *child))).collect();
    let lengths = lengths(&wished, &needed, space);
    if lengths != wished
        && let Some(Tile::Container(Container::Linear(linear))) = tiles.get_mut(tile)
    {
        before.push((tile, linear.shares.clone()));
        children.iter().zip(&lengths).for_each(|(child, length)| linear.shares.set_share(*child, *length));
    }
    for (child, length) in children.into_iter().zip(lengths) {
        fit_tile(tiles, child, if is_row { vec2(length, size.y) } else { vec2(size.x, length) }, before);
    }
}

/// Returns the wished lengths scaled to fill `space`, but none below what is needed, for which the others give way;
/// where the space is too small for all needed lengths, these scaled down in the same ratio.
fn lengths(wished: &[f32], needed: &[f32], space: f32) -> Vec<f32> {
    let all: f32 = needed.iter().sum();
    if all >= space {
        return needed.iter().map(|needed| needed * space / all.max(1.0)).collect();
    }
    let mut is_short = vec![false; wished.len()];
    loop {
        let rest: f32 = space - needed.iter().zip(&is_short).filter(|(_, short)| **short).map(|(n, _)| n).sum::<f32>();
        let sum: f32 = wished.iter().zip(&is_short).filter(|(_, short)| !**short).map(|(w, _)| w).sum();
        let scale = if sum > 0.0 { rest / sum } else { 0.0 };
        let next = (0..wished.len()).find(|index| !is_short[*index] && wished[*index] * scale < needed[*index]);
        match next {
            Some(index) => is_short[index] = true,
            None if scale == 1.0 => return wished.to_vec(),
            None => {
                let length = |index: usize| if is_short[index] { needed[index] } else { wished[index] * scale };
                return (0..wished.len()).map(length).collect();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_those_wished_for_unless_one_is_too_short() {
        assert_eq!(lengths(&[200.0, 300.0], &[120.0, 120.0], 500.0), [200.0, 300.0]);
        assert_eq!(lengths(&[1.0, 264.0, 535.0], &[120.0; 3], 800.0)[0], 120.0);
        let three = lengths(&[1.0, 125.0, 674.0], &[120.0; 3], 800.0);
        assert_eq!(three[..2], [120.0; 2], "the second is too short once the first has what it needs");
        assert!((three.iter().sum::<f32>() - 800.0).abs() < 1e-3);
        assert_eq!(lengths(&[5.0, 5.0], &[120.0, 240.0], 180.0), [60.0, 120.0], "no room");
        assert_eq!(lengths(&[0.0, 0.0], &[120.0, 120.0], 400.0).len(), 2);
    }
}

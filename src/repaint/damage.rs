//! What of a window changed since it was drawn last, so that only that is drawn again: on a software driver most of a frame's
//! time is filling the window.
//!
//! The window is divided into square tiles. What egui draws into each, triangle by triangle in order, is hashed; where the hash
//! is another than in the frame before, the tile is damaged. Damaged tiles are drawn again in a few rectangles.

use bytemuck::cast_slice;
use egui::epaint::{Primitive, TextureId, Vertex, WHITE_UV};
use egui::{ClippedPrimitive, Color32, Mesh, Pos2, Rect, TexturesDelta, pos2};
use egui_wgpu::ScreenDescriptor;
use foldhash::fast::RandomState;
use std::any::Any;
use std::collections::HashMap;
use std::hash::BuildHasher;
use std::ops::Range;
use std::sync::Arc;

/// Width and height of a tile, pixels.
const TILE: u32 = 32;
/// The most rectangles that are drawn in one frame: each has a list of triangles of its own.
const MOST_RECTS: usize = 12;

/// A rectangle of whole pixels; empty where `min` is not less than `max`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct DamagedRect {
    /// The first column and row in it.
    pub min: [u32; 2],
    /// The first column and row behind it.
    pub max: [u32; 2],
}

impl DamagedRect {
    fn is_empty(&self) -> bool {
        self.min[0] >= self.max[0] || self.min[1] >= self.max[1]
    }

    /// Returns how many pixels are in it.
    pub fn area(&self) -> u64 {
        [0, 1].map(|axis| u64::from(self.max[axis].saturating_sub(self.min[axis]))).iter().product()
    }

    fn both(&self, other: &DamagedRect) -> DamagedRect {
        DamagedRect {
            min: [0, 1].map(|axis| self.min[axis].max(other.min[axis])),
            max: [0, 1].map(|axis| self.max[axis].min(other.max[axis])),
        }
    }

    fn around(&self, other: &DamagedRect) -> DamagedRect {
        DamagedRect {
            min: [0, 1].map(|axis| self.min[axis].min(other.min[axis])),
            max: [0, 1].map(|axis| self.max[axis].max(other.max[axis])),
        }
    }

    /// Returns the rectangle in points that egui's renderer rounds to this one.
    fn points(&self, pixels_per_point: f32) -> Rect {
        let corner = |[x, y]: [u32; 2]| pos2(x as f32, y as f32) / pixels_per_point;
        Rect::from_min_max(corner(self.min), corner(self.max))
    }
}

/// What a window showed when it was drawn last.
#[derive(Default)]
pub struct WindowDamage {
    hasher: RandomState,
    /// Size in pixels, pixels per point and the ground's colour.
    drawn: Option<([u32; 2], f32, Color32)>,
    /// A hash of what was drawn into each tile, row by row.
    tiles: Vec<u64>,
    /// The number of the change that gave each texture its content.
    contents: HashMap<TextureId, u64>,
    changes: u64,
    /// The callbacks that were drawn. They are kept so that no other has the address of one of them.
    callbacks: Vec<Arc<dyn Any + Send + Sync>>,
}

impl WindowDamage {
    /// Returns the rectangles of a window, in pixels, in which these primitives over the ground's colour differ from those of the
    /// call before, or a texture that they show does. All of it where its size or scale or the ground changed, or after
    /// [`WindowDamage::default`]. A callback is the same where it is the same object.
    pub fn update(
        &mut self,
        screen: &ScreenDescriptor,
        ground: Color32,
        primitives: &[ClippedPrimitive],
        textures: &TexturesDelta,
    ) -> Vec<DamagedRect> {
        self.note_textures(textures);
        let window = WindowPixels::new(screen);
        let tiles = self.hashed(&window, primitives);
        let drawn = Some((screen.size_in_pixels, screen.pixels_per_point, ground));
        let before = std::mem::replace(&mut self.tiles, tiles);
        if std::mem::replace(&mut self.drawn, drawn) != drawn {
            return Vec::from_iter(Some(window.whole()).filter(|whole| !whole.is_empty()));
        }
        let is_damaged: Vec<bool> = before.iter().zip(&self.tiles).map(|(before, now)| before != now).collect();
        let mut rects = window.rects_of(&is_damaged);
        join_nearest(&mut rects);
        rects
    }

    /// Notes which textures have other contents now. What is added to the font's leaves the glyphs that are in it.
    fn note_textures(&mut self, textures: &TexturesDelta) {
        for (id, deltas) in &textures.set {
            if *id != TextureId::default() || deltas.iter().any(|delta| delta.is_whole()) {
                self.changes += 1;
                self.contents.insert(*id, self.changes);
            }
        }
    }

    /// Returns the hash of what is drawn into each tile.
    fn hashed(&mut self, window: &WindowPixels, primitives: &[ClippedPrimitive]) -> Vec<u64> {
        let mut tiles = vec![0_u64; (window.tiles[0] * window.tiles[1]) as usize];
        let mut callbacks = Vec::new();
        for ClippedPrimitive { clip_rect, primitive } in primitives {
            let clip = window.clip(*clip_rect);
            if clip.is_empty() {
                continue;
            }
            let mut add = |rect: DamagedRect, hash: u64| {
                let [columns, rows] = window.tiles_of(&rect);
                for row in rows {
                    let first = (row * window.tiles[0]) as usize;
                    for tile in &mut tiles[first + columns.start as usize..first + columns.end as usize] {
                        // What is drawn later hides what was drawn before: the order counts.
                        *tile = (tile.rotate_left(5) ^ hash).wrapping_mul(0x9e37_79b9_7f4a_7c15);
                    }
                }
            };
            match primitive {
                Primitive::Mesh(mesh) => {
                    let content = self.contents.get(&mesh.texture_id);
                    let shown = self.hasher.hash_one((mesh.texture_id, content, clip));
                    for corners in corners_of(mesh) {
                        let rect = window.bounds(&corners).both(&clip);
                        if !rect.is_empty() {
                            add(rect, self.hasher.hash_one((shown, cast_slice::<Vertex, u8>(&corners))));
                        }
                    }
                }
                Primitive::Callback(callback) => {
                    let rect =
                        [callback.rect.min, callback.rect.max].map(|corner| [corner.x, corner.y].map(f32::to_bits));
                    let object = Arc::as_ptr(&callback.callback).cast::<u8>() as usize;
                    add(clip, self.hasher.hash_one((rect, object, clip)));
                    callbacks.push(Arc::clone(&callback.callback));
                }
            }
        }
        self.callbacks = callbacks;
        tiles
    }
}

/// Returns what draws these rectangles of a window, and nothing beside them: in each the ground's colour, then the part of the
/// primitives that lies in it.
pub(super) fn within(
    rects: &[DamagedRect],
    screen: &ScreenDescriptor,
    ground: Color32,
    primitives: &[ClippedPrimitive],
) -> Vec<ClippedPrimitive> {
    let window = WindowPixels::new(screen);
    let mut drawn = Vec::new();
    for rect in rects {
        let clip_rect = rect.points(screen.pixels_per_point);
        let mut filled = Mesh::default();
        filled.add_rect_with_uv(clip_rect, Rect::from_min_max(WHITE_UV, WHITE_UV), ground);
        drawn.push(ClippedPrimitive { clip_rect, primitive: Primitive::Mesh(filled) });
        for ClippedPrimitive { clip_rect, primitive } in primitives {
            let clip = window.clip(*clip_rect).both(rect);
            if clip.is_empty() {
                continue;
            }
            let primitive = match primitive {
                Primitive::Mesh(mesh) => {
                    let within = corners_of(mesh).filter(|corners| !window.bounds(corners).both(&clip).is_empty());
                    let vertices: Vec<Vertex> = within.flatten().collect();
                    let indices = (0..vertices.len() as u32).collect();
                    Primitive::Mesh(Mesh { indices, vertices, texture_id: mesh.texture_id })
                }
                Primitive::Callback(callback) => Primitive::Callback(callback.clone()),
            };
            if !matches!(&primitive, Primitive::Mesh(mesh) if mesh.vertices.is_empty()) {
                drawn.push(ClippedPrimitive { clip_rect: clip.points(screen.pixels_per_point), primitive });
            }
        }
    }
    drawn
}

/// Returns the corners of each triangle of a mesh.
fn corners_of(mesh: &Mesh) -> impl Iterator<Item = [Vertex; 3]> + '_ {
    mesh.indices.as_chunks::<3>().0.iter().map(|corners| corners.map(|index| mesh.vertices[index as usize]))
}

/// Joins the two rectangles that have the fewest other pixels round them, until there are not too many.
fn join_nearest(rects: &mut Vec<DamagedRect>) {
    while rects.len() > MOST_RECTS {
        let others = |[one, other]: [usize; 2]| {
            let (one, other) = (rects[one], rects[other]);
            one.around(&other).area() as i64 - (one.area() + other.area()) as i64
        };
        let pairs = (0..rects.len()).flat_map(|one| (one + 1..rects.len()).map(move |other| [one, other]));
        let Some([one, other]) = pairs.min_by_key(|pair| others(*pair)) else { return };
        rects[one] = rects[one].around(&rects[other]);
        rects.swap_remove(other);
    }
}

/// The pixels and tiles of a window.
struct WindowPixels {
    size: [u32; 2],
    pixels_per_point: f32,
    /// Columns and rows of tiles.
    tiles: [u32; 2],
}

impl WindowPixels {
    fn new(screen: &ScreenDescriptor) -> WindowPixels {
        let size = screen.size_in_pixels;
        let pixels_per_point = screen.pixels_per_point;
        WindowPixels { size, pixels_per_point, tiles: size.map(|side| side.div_ceil(TILE)) }
    }

    fn whole(&self) -> DamagedRect {
        DamagedRect { min: [0; 2], max: self.size }
    }

    /// Returns the pixels of a clip rectangle, rounded as egui's renderer does.
    fn clip(&self, rect: Rect) -> DamagedRect {
        let corner = |at: Pos2| [0, 1].map(|axis| self.pixel((at[axis] * self.pixels_per_point).round(), axis));
        DamagedRect { min: corner(rect.min), max: corner(rect.max) }
    }

    /// Returns the pixels that a triangle may cover.
    fn bounds(&self, corners: &[Vertex; 3]) -> DamagedRect {
        let along = |axis: usize| corners.map(|corner| corner.pos[axis] * self.pixels_per_point);
        let min = |axis| self.pixel(along(axis).into_iter().fold(f32::INFINITY, f32::min).floor(), axis);
        let max = |axis| self.pixel(along(axis).into_iter().fold(f32::NEG_INFINITY, f32::max).ceil(), axis);
        DamagedRect { min: [min(0), min(1)], max: [max(0), max(1)] }
    }

    fn pixel(&self, at: f32, axis: usize) -> u32 {
        // Converting to whole numbers saturates.
        (at as u32).min(self.size[axis])
    }

    /// Returns the columns and rows of tiles in which pixels of a rectangle lie, which is not empty.
    fn tiles_of(&self, rect: &DamagedRect) -> [Range<u32>; 2] {
        [0, 1].map(|axis| rect.min[axis] / TILE..rect.max[axis].div_ceil(TILE))
    }

    /// Returns rectangles that cover the damaged tiles and no others: runs in a row, joined with equal ones in the row above.
    fn rects_of(&self, is_damaged: &[bool]) -> Vec<DamagedRect> {
        let mut rects: Vec<DamagedRect> = Vec::new();
        for (row, tiles) in (0..).zip(is_damaged.chunks(self.tiles[0].max(1) as usize)) {
            let mut column = 0;
            for run in tiles.chunk_by(|one, other| one == other) {
                let columns = column..column + run.len() as u32;
                column = columns.end;
                if !run[0] {
                    continue;
                }
                let corner = |column: u32, row: u32| [column * TILE, row * TILE];
                let run = DamagedRect { min: corner(columns.start, row), max: corner(columns.end, row + 1) };
                let run = run.both(&self.whole());
                let is_above = |rect: &&mut DamagedRect| {
                    rect.max[1] == run.min[1] && rect.min[0] == run.min[0] && rect.max[0] == run.max[0]
                };
                match rects.iter_mut().find(is_above) {
                    Some(above) => above.max[1] = run.max[1],
                    None => rects.push(run),
                }
            }
        }
        rects
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::vec2;

    const SCREEN: ScreenDescriptor = ScreenDescriptor { size_in_pixels: [200, 100], pixels_per_point: 2.0 };

    /// A filled rectangle, points.
    fn filled(rect: Rect, color: Color32) -> ClippedPrimitive {
        let mut mesh = Mesh::default();
        mesh.add_rect_with_uv(rect, Rect::from_min_max(WHITE_UV, WHITE_UV), color);
        ClippedPrimitive { clip_rect: Rect::EVERYTHING, primitive: Primitive::Mesh(mesh) }
    }

    fn square(at: [f32; 2]) -> Rect {
        Rect::from_min_size(at.into(), vec2(10.0, 10.0))
    }

    #[test]
    fn only_the_tiles_of_what_changed_are_damaged() {
        let mut damage = WindowDamage::default();
        let mut update = |primitives: &[ClippedPrimitive]| {
            damage.update(&SCREEN, Color32::BLACK, primitives, &TexturesDelta::default())
        };
        let still = filled(square([60.0, 30.0]), Color32::RED);
        let whole = DamagedRect { min: [0, 0], max: [200, 100] };
        assert_eq!(update(&[filled(square([1.0, 1.0]), Color32::RED), still.clone()]), [whole], "at first");
        assert_eq!(update(&[filled(square([1.0, 1.0]), Color32::RED), still.clone()]), [], "nothing changed");
        let blue = filled(square([1.0, 1.0]), Color32::BLUE);
        let first = DamagedRect { min: [0, 0], max: [32, 32] };
        assert_eq!(update(&[blue.clone(), still.clone()]), [first], "another colour");
        let beside = DamagedRect { min: [0, 0], max: [64, 32] };
        assert_eq!(update(&[filled(square([17.0, 1.0]), Color32::BLUE), still.clone()]), [beside], "left and arrived");
        let behind = [filled(square([17.0, 1.0]), Color32::BLUE), still];
        assert_eq!(update(&[behind[1].clone(), behind[0].clone()]), [], "the order of what does not touch");
    }

    #[test]
    fn another_content_of_a_texture_damages_what_shows_it() {
        let mut damage = WindowDamage::default();
        let id = TextureId::Managed(7);
        let mut shown = filled(square([60.0, 30.0]), Color32::WHITE);
        let Primitive::Mesh(mesh) = &mut shown.primitive else { unreachable!("a mesh") };
        mesh.texture_id = id;
        let primitives = [filled(square([1.0, 1.0]), Color32::RED), shown];
        let image = egui::ColorImage::filled([1, 1], Color32::WHITE);
        let change = |id| {
            let mut textures = TexturesDelta::default();
            textures.push(id, egui::epaint::ImageDelta::full(image.clone(), egui::TextureOptions::NEAREST));
            textures
        };
        damage.update(&SCREEN, Color32::BLACK, &primitives, &change(id));
        let of_square = DamagedRect { min: [96, 32], max: [160, 96] };
        assert_eq!(damage.update(&SCREEN, Color32::BLACK, &primitives, &change(id)), [of_square]);
        assert_eq!(damage.update(&SCREEN, Color32::BLACK, &primitives, &TexturesDelta::default()), []);
        let other = change(TextureId::Managed(8));
        assert_eq!(damage.update(&SCREEN, Color32::BLACK, &primitives, &other), [], "nothing shows it");
        let of_font = DamagedRect { min: [0, 0], max: [32, 32] };
        assert_eq!(damage.update(&SCREEN, Color32::BLACK, &primitives, &change(TextureId::default())), [of_font]);
    }

    #[test]
    fn many_rectangles_become_few_that_cover_them() {
        let tile = |x: u32, y: u32| DamagedRect { min: [x * 64, y * 64], max: [x * 64 + 32, y * 64 + 32] };
        let all: Vec<DamagedRect> = (0..6).flat_map(|y| (0..6).map(move |x| tile(x, y))).collect();
        let mut rects = all.clone();
        join_nearest(&mut rects);
        assert!(rects.len() <= MOST_RECTS, "{rects:?}");
        assert!(all.iter().all(|tile| rects.iter().any(|rect| rect.both(tile) == *tile)), "{rects:?}");
    }
}

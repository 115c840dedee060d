//! A rasteriser and stencil machine of its own, in `f64`: what a frame's positions and states make of what was there
//! before each draw, compared with what RenderDoc has stored after it.
//!
//! Triangles are taken in homogeneous coordinates (Olano and Greer, 1997), so that none has to be clipped.

use std::collections::BTreeMap;
use std::ops::Range;
use stencilscope::capture::Image;
use stencilscope::glam::DVec3;
use stencilscope::import::{RawContents, RawCull, RawDraw, RawFrame, RawKind, RawStencilFace, RawTarget};
use stencilscope::plan::ShaderEffect;
use stencilscope::wgpu::{CompareFunction, StencilOperation};

/// A draw compared with what was stored after it.
#[derive(Debug)]
pub struct Compared {
    pub event: u32,
    /// Pixels that the draw has a fragment on.
    pub touched: usize,
    /// Pixels whose stored stencil or depth the draw has changed.
    pub changed: usize,
    /// Pixels whose depth is another one.
    pub depth: usize,
    /// Those of them that are on no edge of a triangle, nearly, and where the depth is farther off than the triangle's
    /// slope makes of a last place of columns and rows.
    pub unexplained_depth: usize,
    /// Pixels whose stencil is another one.
    pub stencil: usize,
    /// Those of them where no fragment was as deep as what was stored, nearly: nothing but a last place excuses these.
    pub untied: usize,
}

/// Every draw whose depth and stencil are known before and after, and whose shader discards no fragment.
pub fn compare(frame: &RawFrame) -> Vec<Compared> {
    let mut contents: BTreeMap<RawTarget, RawContents> = frame.before.iter().cloned().collect();
    let mut found = Vec::new();
    for event in &frame.events {
        let Some(target) = event.depth_target else { continue };
        let before = contents.insert(target, event.after.clone());
        let (RawKind::Draw(draw), Some(before)) = (&event.kind, before) else { continue };
        if draw.fragment.may_discard != ShaderEffect::No {
            continue;
        }
        let texture = &frame.textures[target.texture];
        let [width, height] = texture.size.map(|side| (side >> target.mip) as usize);
        if let Some(mut machine) = Machine::new(&before, [width, height], texture.format.largest_depth()) {
            machine.draw(draw);
            found.extend(machine.compare(event.id, &before, &event.after));
        }
    }
    found
}

/// Last places of depth by which two rasterisers may differ.
const TIE: f64 = 8.0;
/// How far from an edge, in pixels, the next triangle may be drawn: a rasteriser rounds corners to parts like these.
const ON_EDGE: f64 = 1.0 / 256.0;
/// Last places of a column or row, as a float, by which two rasterisers may differ.
const LAST_PLACES: f64 = 2.0;

struct Machine {
    size: [usize; 2],
    /// The largest stored depth, where it is an integer.
    largest: Option<u32>,
    depth: Vec<f64>,
    stencil: Vec<u8>,
    touched: Vec<bool>,
    /// Pixels with a fragment as deep as what was stored, but for a few last places.
    tied: Vec<bool>,
    /// Pixels whose centre is on an edge of a triangle, nearly.
    on_edge: Vec<bool>,
    /// How far off the depth may be, as the place within the triangle is a float.
    rounding: Vec<f64>,
}

impl Machine {
    fn new(before: &RawContents, size: [usize; 2], largest: Option<u32>) -> Option<Self> {
        // An integer depth is taken as the quotient that it is, not as the float next to it.
        let exact =
            |depth: f64| largest.map_or(depth, |largest| (depth * f64::from(largest)).round() / f64::from(largest));
        let depth: Vec<f64> = depths(before.depth.as_ref()?).map(|depth| exact(f64::from(depth))).collect();
        let stencil = before.stencil.as_ref().map_or_else(|| vec![0; depth.len()], |stencil| bytes(stencil));
        let [touched, tied, on_edge] = [(); 3].map(|()| vec![false; depth.len()]);
        let rounding = vec![0.0; depth.len()];
        Some(Self { size, largest, touched, tied, on_edge, rounding, depth, stencil })
    }

    fn draw(&mut self, draw: &RawDraw) {
        for triangle in &draw.triangles {
            self.triangle(draw, triangle.map(|corner| draw.positions[corner as usize].map(f64::from)));
        }
    }

    fn triangle(&mut self, draw: &RawDraw, corners: [[f64; 4]; 3]) {
        let view = &draw.view;
        let [left, top, width, height] = view.viewport.map(f64::from);
        let up = if view.y_up { -1.0 } else { 1.0 };
        // Columns and rows times w; and w.
        let window = corners
            .map(|[x, y, _, w]| DVec3::new((x + w) * width / 2.0 + w * left, (up * y + w) * height / 2.0 + w * top, w));
        let [a, b, c] = window;
        let turn = a.dot(b.cross(c));
        if turn == 0.0 || !turn.is_finite() || window.iter().all(|corner| corner.z <= 0.0) {
            return;
        }
        // Rows count downwards: a positive turn is clockwise on the picture.
        let is_front = (turn < 0.0) == draw.shape.front_is_counter_clockwise;
        match draw.shape.cull {
            RawCull::Both => return,
            RawCull::Front if is_front => return,
            RawCull::Back if !is_front => return,
            _ => {}
        }
        let edges = [b.cross(c) / turn, c.cross(a) / turn, a.cross(b) / turn];
        let near_edges = edges.map(|edge| ON_EDGE * edge.truncate().length());
        let [columns, rows] = self.bounds(&window, draw);
        let [near, far] = view.depth_range.map(f64::from);
        let slope: DVec3 = edges.iter().zip(corners).map(|(edge, [_, _, z, _])| *edge * z).sum();
        let slope = (far - near).abs() * slope.truncate().length() * if view.z_from_minus_w { 0.5 } else { 1.0 };
        let rounding = slope * LAST_PLACES * self.size[0].max(self.size[1]) as f64 * f64::from(f32::EPSILON);
        for row in rows {
            for column in columns.clone() {
                let at = DVec3::new(column as f64 + 0.5, row as f64 + 0.5, 1.0);
                let inside = edges.map(|edge| edge.dot(at));
                let per_w: f64 = inside.iter().sum();
                let mut from_edges = inside.iter().zip(near_edges);
                if from_edges.clone().all(|(edge, near)| *edge >= -near)
                    && from_edges.any(|(edge, near)| edge.abs() <= near)
                {
                    self.on_edge[row * self.size[0] + column] = true;
                }
                if inside.iter().any(|edge| *edge < 0.0) || per_w <= 0.0 {
                    continue;
                }
                let z: f64 = inside.iter().zip(corners).map(|(edge, [_, _, z, _])| edge * z).sum();
                let depth = near + (far - near) * if view.z_from_minus_w { (z + 1.0) / 2.0 } else { z };
                let range = [near.min(far), near.max(far)];
                if draw.shape.depth_clip && !(range[0]..=range[1]).contains(&depth) {
                    continue;
                }
                let depth = if draw.shape.depth_clamp { depth.clamp(range[0], range[1]) } else { depth };
                let at = row * self.size[0] + column;
                let before = self.depth[at];
                self.fragment(draw, is_front, at, depth);
                if self.depth[at] != before {
                    self.rounding[at] = rounding;
                }
            }
        }
    }

    /// The columns and rows that a triangle may touch.
    fn bounds(&self, window: &[DVec3; 3], draw: &RawDraw) -> [Range<usize>; 2] {
        let limit = |value: f64, side: usize| value.clamp(0.0, side as f64) as usize;
        let [left, top, width, height] = draw.view.viewport.map(f64::from);
        std::array::from_fn(|axis| {
            let side = self.size[axis];
            let [mut low, mut high] = [[left, left + width], [top, top + height]][axis];
            if let Some(scissor) = draw.view.scissor {
                low = low.max(f64::from(scissor[axis]));
                high = high.min(f64::from(scissor[axis]) + f64::from(scissor[axis + 2]));
            }
            if window.iter().all(|corner| corner.z > 0.0) {
                let places = window.map(|corner| corner[axis] / corner.z);
                low = low.max(places.into_iter().fold(f64::INFINITY, f64::min).floor());
                high = high.min(places.into_iter().fold(f64::NEG_INFINITY, f64::max).ceil());
            }
            limit(low, side)..limit(high, side)
        })
    }

    fn fragment(&mut self, draw: &RawDraw, is_front: bool, at: usize, depth: f64) {
        self.touched[at] = true;
        let depth = match self.largest.map(f64::from) {
            Some(largest) => (depth * largest).round() / largest,
            None => f64::from(depth as f32),
        };
        let last_place = self.largest.map_or(depth * f64::from(f32::EPSILON), |largest| 1.0 / f64::from(largest));
        self.tied[at] |= (depth - self.depth[at]).abs() <= TIE * last_place;
        let passes_depth = draw.depth.is_none_or(|test| compares(test.compare, depth, self.depth[at]));
        let face = draw.stencil.map(|[front, back]| if is_front { front } else { back });
        let passes_stencil = face.is_none_or(|face| {
            let [reference, stored] = [face.masks.reference, self.stencil[at]].map(|value| value & face.masks.read);
            compares(face.face.compare, f64::from(reference), f64::from(stored))
        });
        if let Some(face) = face {
            self.stencil[at] = after(&face, self.stencil[at], passes_stencil, passes_depth);
        }
        if passes_stencil && passes_depth && draw.depth.is_some_and(|test| test.write) {
            self.depth[at] = depth;
        }
    }

    fn compare(&self, event: u32, before: &RawContents, after: &RawContents) -> Option<Compared> {
        /// A last place or two of depth: two rasterisers round differently.
        const NEARLY: f64 = 2e-6;
        let depth = after.depth.as_ref()?;
        // And one step of an integer, where the exact depth is half-way between two.
        let nearly = self.largest.map_or(NEARLY, |largest| NEARLY.max(1.5 / f64::from(largest)));
        let differs = |(own, stored): (&f64, f32)| (own - f64::from(stored)).abs() > nearly;
        let stencil = after.stencil.as_ref().map_or_else(|| self.stencil.clone(), |stencil| bytes(stencil));
        let before_stencil = before.stencil.as_ref().map_or_else(|| stencil.clone(), |stencil| bytes(stencil));
        let changed = depths(before.depth.as_ref()?).zip(depths(depth)).map(|(a, b)| a != b);
        let changed =
            changed.zip(before_stencil.iter().zip(&stencil)).filter(|(depth, (a, b))| *depth || a != b).count();
        let off = |at: usize, stored: f32| (self.depth[at] - f64::from(stored)).abs();
        let is_explained = |at: usize, stored: f32| self.on_edge[at] || off(at, stored) <= nearly + self.rounding[at];
        let unexplained = depths(depth).enumerate().filter(|(at, stored)| !is_explained(*at, *stored));
        let wrong = self.stencil.iter().zip(&stencil).map(|(own, stored)| own != stored);
        Some(Compared {
            event,
            touched: self.touched.iter().filter(|touched| **touched).count(),
            changed,
            depth: self.depth.iter().zip(depths(depth)).filter(|pair| differs(*pair)).count(),
            unexplained_depth: unexplained.count(),
            stencil: wrong.clone().filter(|wrong| *wrong).count(),
            untied: wrong.zip(&self.tied).filter(|(wrong, tied)| *wrong && !**tied).count(),
        })
    }
}

/// The bytes of a picture of one byte a texel.
fn bytes(image: &Image) -> Vec<u8> {
    image.rows().flatten().copied().collect()
}

/// The depths of a picture.
fn depths(image: &Image) -> impl Iterator<Item = f32> {
    image.rows().flat_map(|row| row.as_chunks::<4>().0).map(|depth| f32::from_le_bytes(*depth))
}

fn after(RawStencilFace { face, masks }: &RawStencilFace, stored: u8, passes_stencil: bool, passes_depth: bool) -> u8 {
    let operation = match (passes_stencil, passes_depth) {
        (false, _) => face.fail_op,
        (true, false) => face.depth_fail_op,
        (true, true) => face.pass_op,
    };
    let new = match operation {
        StencilOperation::Keep => stored,
        StencilOperation::Zero => 0,
        StencilOperation::Replace => masks.reference,
        StencilOperation::IncrementClamp => stored.saturating_add(1),
        StencilOperation::DecrementClamp => stored.saturating_sub(1),
        StencilOperation::Invert => !stored,
        StencilOperation::IncrementWrap => stored.wrapping_add(1),
        StencilOperation::DecrementWrap => stored.wrapping_sub(1),
    };
    new & masks.write | stored & !masks.write
}

fn compares(compare: CompareFunction, new: f64, stored: f64) -> bool {
    match compare {
        CompareFunction::Never => false,
        CompareFunction::Less => new < stored,
        CompareFunction::LessEqual => new <= stored,
        CompareFunction::Equal => new == stored,
        CompareFunction::GreaterEqual => new >= stored,
        CompareFunction::Greater => new > stored,
        CompareFunction::NotEqual => new != stored,
        CompareFunction::Always => true,
    }
}

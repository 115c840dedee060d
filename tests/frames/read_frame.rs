//! A frame that was recorded and read: how its draws and texels hold against what it stores.

use super::corners::SharedMeshes;
use super::machine;
use super::random::Random;
use std::collections::BTreeMap;
use stencilscope::diagnosis::NotCompared;
use stencilscope::diagnosis::frame_causes::FrameDiagnosis;
use stencilscope::glam::DVec2;
use stencilscope::import::{RawFrame, RawKind};
use stencilscope::plan::ShaderEffect;
use stencilscope::reading::MapReaders;
use stencilscope::reading::map_decision::MapDecision;
use stencilscope::recorded::{FoundLight, LightEvidence};
use stencilscope::session::RunFrame;

/// Pixels of a draw whose centre is nearly on an edge: either of two rasterisers may be right.
pub const EDGES: usize = 8;

/// A frame that was recorded and read.
pub struct ReadFrame {
    pub raw: RawFrame,
    pub frame: RunFrame,
    pub lights: Vec<Option<FoundLight>>,
    pub diagnosis: FrameDiagnosis,
    pub seconds: f64,
}

impl ReadFrame {
    /// The API that was recorded, with what it took to record it.
    pub fn api(&self) -> String {
        let is_by_zink = self.raw.limits.iter().any(|limit| limit.contains("zink"));
        format!("{}{}", self.raw.api.name(), if is_by_zink { ", by zink" } else { "" })
    }

    /// How many draws leave what was stored, of how many, and at how many pixels those do that differ: by the GPU those of the
    /// picture, by a rasteriser of our own those of maps, too. At how many is of the latter's stencils, as it knows the pixels at
    /// which a fragment is as deep as what is stored: there either of two rasterisers may be right. No shader here discards a
    /// fragment, though VTK's could. Draws whose depths a shader writes, or whose are moved by a bias, whose unit is the driver's,
    /// are not among them.
    pub fn draws_as_stored(&self) -> (usize, usize, u64) {
        let mut raw = self.raw.clone();
        for event in &mut raw.events {
            if let RawKind::Draw(draw) = &mut event.kind {
                let is_as_drawn = draw.fragment.writes_depth == ShaderEffect::No && draw.shape.bias == [0.0; 3];
                draw.fragment.may_discard = if is_as_drawn { ShaderEffect::No } else { ShaderEffect::Yes };
            }
        }
        let mut of_event: BTreeMap<String, u64> = BTreeMap::new();
        for draw in machine::compare(&raw) {
            let at_edges = draw.untied.max(draw.changed.saturating_sub(draw.touched));
            // A pixel whose centre is nearly on an edge is either rasteriser's.
            // So are those near an edge of any triangle, of which a draw has few.
            let excused = if draw.depth * 100 <= draw.touched { 0 } else { draw.depth };
            let most = draw.unexplained_depth.max(excused).max(if at_edges <= EDGES { 0 } else { at_edges });
            of_event.insert(format!("event {}", draw.event), most as u64);
        }
        let mut same = of_event.clone();
        for draw in self.frame.capture.steps.iter().flat_map(|step| &step.draws) {
            if let Some(differs) = draw.differs {
                let of_stencil = if of_event.contains_key(&draw.name) { 0 } else { differs.stencil };
                let most = of_event.entry(draw.name.clone()).or_default();
                *most = (*most).max(differs.depth).max(of_stencil);
                let most = same.entry(draw.name.clone()).or_default();
                *most = (*most).max(differs.depth).max(differs.stencil);
            }
        }
        let as_stored = same.values().filter(|differing| **differing == 0).count();
        (as_stored, same.len(), of_event.values().copied().max().unwrap_or_default())
    }

    /// The pixels that show a surface which the light can reach.
    pub fn comparable(&self) -> u64 {
        let coverage = &self.diagnosis.coverage[0];
        let beside = |because: &NotCompared| {
            matches!(because, NotCompared::NoSurface | NotCompared::FacesAway | NotCompared::OutsideMap)
        };
        let left_out = coverage.reasons().into_iter().filter(|(because, _)| beside(because));
        coverage.pixels - left_out.map(|(_, pixels)| pixels).sum::<u64>()
    }

    pub fn residual(&self) -> Option<f64> {
        match self.lights.first()?.as_ref()?.evidence {
            LightEvidence::Map { residual, .. } => Some(residual),
            LightEvidence::Edges { .. } | LightEvidence::EdgesOfCasters { .. } => None,
        }
    }

    /// Texels and depths of random pixels that read the map, whose distances are of `far`, against those that the corners of the frame's own draws give:
    /// how many were compared, and what is wrong.
    pub fn texels(&self, far: Option<f64>) -> (usize, Vec<String>) {
        /// How far places may be off, in texels, and depths, of the depth range: what 24 bits of the picture's depth leave.
        const OFF: (f64, f64) = (0.1, 1e-4);
        /// Planes that the light sees nearly edge-on, where depths change by so much from texel to texel: they are thinner than
        /// a matrix is exact, and their depths are not compared.
        const STEEP: f64 = 1e-2;
        let (capture, plan) = (&self.frame.capture, &self.frame.plan);
        let Some(map) = &capture.lights[0].map else { return (0, Vec::new()) };
        let size = map.faces[0].size();
        let shared = SharedMeshes::of(&self.raw, capture.size, size, far).expect("a picture and a map");
        let readers = MapReaders::new(capture, Some(plan), 0).expect("pixels that read the map");
        let (mut random, mut compared, mut wrong, mut most) = (Random::new(7), 0, Vec::new(), (0.0_f64, 0.0_f64));
        let mut steep = 0;
        for _ in 0..20_000 {
            if compared == 200 {
                break;
            }
            let pixel = capture.size.map(|side| random.below(side));
            let (Some(decision), Some(own)) = (MapDecision::of(capture, &readers, 0, pixel), shared.place(pixel))
            else {
                continue;
            };
            compared += 1;
            let middle = decision.middle;
            let [x, y] = middle.texel.at.map(f64::from);
            // The surface's plane is compared in the middle of the texel.
            let at = DVec2::new(x + 0.5, y + 0.5);
            let own_depth = own.depth_at(at);
            let slope = [DVec2::X, DVec2::Y].map(|step| (own.depth_at(at + step) - own_depth).abs());
            let outside = |place: f64, first: f64| (first - place).max(place - first - 1.0).max(0.0);
            let off = outside(own.texel.x, x).max(outside(own.texel.y, y));
            let is_steep = slope[0].max(slope[1]) > STEEP;
            steep += usize::from(is_steep);
            let depth = if is_steep { 0.0 } else { (f64::from(middle.depth) - own_depth).abs() };
            most = (most.0.max(off), most.1.max(depth));
            let stored = shared.stored(own.face, middle.texel.at);
            let is_stored = stored == Some(middle.stored);
            if middle.texel.face != own.face || !(off <= OFF.0 && depth <= OFF.1) || !is_stored {
                wrong.push(format!("{pixel:?}: {middle:?}, and by the corners {own:?}, stored {stored:?}"));
            }
        }
        if steep > compared / 10 {
            wrong.push(format!("{steep} of {compared} planes are steep"));
        }
        println!(
            "{compared} texels, {steep} of steep planes: off by at most {:.2e} texels and {:.2e} of depth",
            most.0, most.1
        );
        (compared, wrong)
    }
}

//! The data that rules examine: the frame as it was given and run, its truth, and a few pixels closely.

use super::RegionKind;
use super::cause::Cause;
use super::evidence::{Evidence, Quantity};
use super::fix::Fix;
use super::mesh_facts::MeshFacts;
use super::regions::ConnectedRegion;
use crate::accuracy::Finding;
use crate::capture::{Capture, Image};
use crate::history::PixelHistory;
pub(crate) use crate::numbers::counted as amount;
use crate::plan::{Draw, DrawPart, FramePlan, Pass};
use crate::scene::{Object, Scene};
use crate::technique::{CasterTriangles, Choice, MapSettings, Technique, VolumeSettings};
use crate::truth::{OccluderHit, SeenSurface, Tracer};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Everything that rules may look at in one frame. It does not say whether, or how, an error was injected.
pub(crate) struct FrameFacts<'a> {
    /// The scene as it was given to the technique.
    pub scene: &'a Scene,
    /// The technique and settings that were used.
    pub choice: &'a Choice,
    /// The plan that was run, before anything was clipped for the adapter.
    pub plan: &'a FramePlan,
    /// The plan as it was drawn: histories are of its triangles.
    pub drawn: &'a FramePlan,
    pub capture: &'a Capture,
    /// The frame with maps fitted to the view from places beside the eye; empty where no map follows the view.
    pub moved: &'a [MovedMap],
    /// The step that the rasteriser snaps corners to, pixels.
    pub step: f64,
    /// The same, where it moves corners without their depth; `None` where triangles are drawn as they are given.
    pub coarse_step: Option<f64>,
    /// Traces rays through the scene as it should be.
    pub tracer: &'a Tracer,
    /// Facts of the objects' meshes, parallel to the scene's objects.
    pub meshes: &'a [MeshFacts],
    /// For each light and each of the scene's objects, which triangles cast.
    pub casting: &'a [Vec<CasterTriangles>],
}

/// A frame whose maps are fitted to the view from another place than its eye.
pub(crate) struct MovedMap {
    pub plan: FramePlan,
    /// What it says of each light's pixels.
    pub labels: Vec<Option<Arc<Image>>>,
    /// How far that place is from the eye, metres.
    pub moved: f64,
}

/// A region of wrong pixels, with a few of them examined closely.
pub(crate) struct RegionSamples<'a> {
    pub region: &'a ConnectedRegion,
    pub samples: Vec<PixelSample>,
}

/// One wrong pixel, examined closely.
pub(crate) struct PixelSample {
    pub pixel: [u32; 2],
    pub seen: Option<SeenSurface>,
    /// The occluders that rays find between light and surface, the nearest to the surface first.
    pub between: Vec<OccluderHit>,
    /// The pixel's history; `None` where the technique leaves no events that explain its shadow.
    pub history: Option<PixelHistory>,
}

/// A cause for which a rule has found evidence.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SuspectedCause {
    pub cause: Cause,
    pub evidence: Evidence,
    /// Fixes in the order in which they are tried; empty where nothing helps.
    pub fixes: Vec<Fix>,
    /// How specific the evidence is to this frame: between equal results, the larger is named first.
    pub weight: usize,
}

impl SuspectedCause {
    /// Returns the suspected cause with weight 0.
    pub fn new(cause: Cause, evidence: Evidence, fixes: Vec<Fix>) -> SuspectedCause {
        SuspectedCause { cause, evidence, fixes, weight: 0 }
    }
}

/// A rule that looks for evidence of one cause in a region; `None` where there is none.
pub(crate) type CauseRule = fn(&FrameFacts, &RegionSamples) -> Option<SuspectedCause>;

impl<'a> FrameFacts<'a> {
    /// Returns the settings of shadow volumes; `None` for a technique that counts none.
    pub fn volumes(&self) -> Option<VolumeSettings> {
        self.choice.volumes()
    }

    /// Returns the settings of shadow maps; the defaults for another technique.
    pub fn map(&self) -> MapSettings {
        MapSettings::read(self.choice.settings())
    }

    /// Returns the texels along each side of maps, textures or silhouettes; 0 where the technique has none.
    pub fn texels(&self) -> f64 {
        f64::from(self.choice.texels().unwrap_or(0))
    }

    /// Returns the place that positions of the camera's passes are relative to: the eye, as the plan has rounded it.
    pub fn eye(&self) -> glam::DVec3 {
        self.plan.views.first().map_or(self.scene.camera.eye, |view| view.origin)
    }

    pub fn technique(&self) -> Technique {
        self.choice.technique()
    }

    /// Returns the index of the object of that name, and the object; `None` where there is none.
    pub fn object(&self, name: &str) -> Option<(usize, &'a Object)> {
        self.scene.objects.iter().enumerate().find(|(_, object)| object.name == name)
    }

    /// Returns the passes of a light that are part of the frame, without its mask.
    pub fn passes(&self, light: usize) -> impl Iterator<Item = &'a Pass> {
        self.plan.passes.iter().filter(move |pass| pass.timed && pass.light.is_some_and(|of| of.0 == light))
    }

    /// Returns the draws of a part of a light's shadows in passes of the camera's view.
    pub fn draws(&self, light: usize, part: DrawPart) -> impl Iterator<Item = &'a Draw> {
        let passes = self.passes(light).filter(move |pass| part == DrawPart::Map || pass.view.0 == 0);
        passes.flat_map(|pass| &pass.draws).filter(move |draw| draw.part.includes(part))
    }

    /// Returns whether volumes are counted for a light.
    pub fn counts_volumes(&self, light: usize) -> bool {
        self.passes(light).any(|pass| pass.view.0 == 0 && pass.draws.iter().any(|draw| draw.part.is_of_volume()))
    }

    /// Returns whether a draw of the caster's volume sides counts for this light behind the visible surface (z-fail):
    /// by stencil operations on depth failure, or in a float target with another depth test than "nearer".
    pub fn counts_behind(&self, light: usize, caster: &str) -> bool {
        let of_caster = |draw: &&Draw| draw.caster.as_deref() == Some(caster);
        let mut sides = self.draws(light, DrawPart::Side).filter(of_caster);
        sides.any(|draw| {
            let stencil = &draw.raster.stencil;
            let keeps = wgpu_types::StencilOperation::Keep;
            let in_stencil = stencil.front.depth_fail_op != keeps || stencil.back.depth_fail_op != keeps;
            let is_plain = draw.raster.depth_compare == self.nearer();
            in_stencil || (draw.program == crate::plan::Program::Count && !is_plain)
        })
    }

    /// Returns the strict depth test of the frame's depth mapping that nearer fragments pass: `Greater` where depth is
    /// reversed, else `Less`.
    fn nearer(&self) -> wgpu_types::CompareFunction {
        let is_reversed = self.plan.depth.mapping.is_reversed();
        if is_reversed { wgpu_types::CompareFunction::Greater } else { wgpu_types::CompareFunction::Less }
    }

    /// Returns whether a triangle of a caster casts for a light, as settings and meshes decide.
    pub fn casts(&self, light: usize, hit: &OccluderHit) -> bool {
        self.casting[light][hit.place.object].casts(hit.place.triangle, hit.faces_light)
    }

    /// Returns the width of a pixel in metres at a distance (metres) along the view's axis.
    pub fn pixel_width(&self, depth: f64) -> f64 {
        self.scene.camera.pixel_width_at(depth, self.plan.size)
    }

    /// Returns by how many metres a pixel's width grows a metre of distance: about its angle in radians. At least 1e-9,
    /// as in a parallel view, where it does not grow.
    pub fn pixel_angle(&self) -> f64 {
        let [near, away] = [0.0, 1.0].map(|depth| self.pixel_width(depth));
        (away - near).max(1e-9)
    }

    /// Returns the names of the objects that rays hit.
    pub fn names(&self, hits: &[OccluderHit]) -> BTreeSet<String> {
        hits.iter().map(|hit| self.tracer.name(hit.place).to_owned()).collect()
    }
}

impl RegionSamples<'_> {
    pub fn light(&self) -> usize {
        self.region.light
    }

    pub fn is_missing(&self) -> bool {
        self.region.key.kind == RegionKind::Wrong(Finding::MissingShadow)
    }

    pub fn is_false(&self) -> bool {
        self.region.key.kind == RegionKind::Wrong(Finding::FalseShadow)
    }

    pub fn is_too_dark(&self) -> bool {
        self.region.key.kind == RegionKind::TooDark
    }

    /// Returns evidence that `shown_by` of the samples show: its sentence, and the numbers that must hold.
    pub fn evidence(&self, sentence: String, shown_by: usize, quantities: impl Into<Vec<Quantity>>) -> Evidence {
        Evidence { sentence, quantities: quantities.into(), shown_by, examined: self.samples.len() }
    }

    /// Returns the first value that `look` returns for a sample, and for how many samples it returns one; `None` where
    /// it returns none. `look` runs for every sample.
    pub fn shown<T>(&self, look: impl FnMut(&PixelSample) -> Option<T>) -> Option<(T, usize)> {
        let mut found: Vec<T> = self.samples.iter().filter_map(look).collect();
        let count = found.len();
        (count > 0).then(|| (found.swap_remove(0), count))
    }
}

impl PixelSample {
    /// Returns the pixel's centre in pixels.
    pub fn center(&self) -> [f64; 2] {
        self.pixel.map(|n| f64::from(n) + 0.5)
    }

    /// Returns the sum of steps (up or down) by which a caster's volume changed a light's count at this pixel, as if
    /// the count had no limits; 0 where there is no history.
    pub fn counted(&self, light: usize, caster: &str) -> i32 {
        self.volume_events(light)
            .filter(|(_, one)| one.caster.as_deref() == Some(caster))
            .map(|(event, _)| event.step())
            .sum()
    }

    /// Returns the events at this pixel, with their triangles, in which faces of a light's shadow volumes were drawn;
    /// none where there is no history.
    pub fn volume_events(
        &self,
        light: usize,
    ) -> impl Iterator<Item = (&crate::history::PixelEvent, &crate::history::TriangleEvent)> {
        let all = self.history.iter().flat_map(|history| history.triangles());
        all.filter(move |(event, _)| event.light == Some(light) && event.is_of_volume())
    }

    /// Returns the casters whose volume added another number to the count than it has casting triangles between light
    /// and surface: name, counted number, expected number.
    pub fn miscounted(&self, facts: &FrameFacts, light: usize) -> Vec<(String, i32, i32)> {
        if self.history.is_none() || self.seen.is_none() {
            return Vec::new();
        }
        let mut found = Vec::new();
        for object in facts.scene.objects.iter().filter(|object| object.casts) {
            let is_of = |hit: &&OccluderHit| facts.tracer.name(hit.place) == object.name && facts.casts(light, hit);
            let expected = self.between.iter().filter(is_of).count() as i32;
            let counted = self.counted(light, &object.name);
            if counted != expected {
                found.push((object.name.clone(), counted, expected));
            }
        }
        found
    }
}

/// Returns names as a list: `box, ring and floor`; `nothing` without any.
pub(crate) fn listed<'n>(names: impl IntoIterator<Item = &'n String>) -> String {
    let names: Vec<&str> = names.into_iter().map(String::as_str).collect();
    match names.split_last() {
        None => "nothing".to_owned(),
        Some((last, [])) => (*last).to_owned(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
    }
}

//! What rules look at: the frame as it was given and run, its truth, and a few pixels closely.

use super::RegionKind;
use super::cause::Cause;
use super::fix::Fix;
use super::mesh_facts::MeshFacts;
use super::regions::ConnectedRegion;
use crate::accuracy::Finding;
use crate::capture::Capture;
use crate::geometry::Casters;
use crate::history::PixelHistory;
use crate::plan::{Draw, DrawPart, FramePlan, Pass};
use crate::scene::{Object, Scene};
use crate::technique::{Choice, MapSettings, Technique, VolumeSettings};
use crate::truth::{OccluderHit, SeenSurface, Tracer};
use std::collections::BTreeSet;

/// One frame. Nothing here tells whether, or how, something was made wrong on purpose.
pub(crate) struct FrameFacts<'a> {
    /// As the technique was given it.
    pub scene: &'a Scene,
    /// As it was used.
    pub choice: &'a Choice,
    /// As it was run.
    pub plan: &'a FramePlan,
    pub capture: &'a Capture,
    /// Of the scene as it should be.
    pub tracer: &'a Tracer,
    /// Parallel to the scene's objects.
    pub meshes: &'a [MeshFacts],
    /// Which of its triangles cast: by light, parallel to the scene's objects.
    pub casting: &'a [Vec<Casters>],
}

/// A region with a close look at some of its pixels.
pub(crate) struct RegionSamples<'a> {
    pub region: &'a ConnectedRegion,
    pub samples: Vec<PixelSample>,
}

/// One pixel of a region.
pub(crate) struct PixelSample {
    pub pixel: [u32; 2],
    pub seen: Option<SeenSurface>,
    /// What in truth lies between light and surface, the nearest to the surface first.
    pub between: Vec<OccluderHit>,
    /// `None` where the technique leaves no events that tell.
    pub history: Option<PixelHistory>,
}

/// A cause that may be it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SuspectedCause {
    pub cause: Cause,
    pub evidence: String,
    /// In the order in which they are tried; none where nothing helps.
    pub fixes: Vec<Fix>,
    /// How many samples show it.
    pub shown_by: usize,
    /// How much it says about this very frame: larger before smaller.
    pub weight: usize,
}

impl SuspectedCause {
    pub fn new(cause: Cause, evidence: String, fixes: Vec<Fix>, shown_by: usize) -> Option<SuspectedCause> {
        (shown_by > 0).then_some(SuspectedCause { cause, evidence, fixes, shown_by, weight: 0 })
    }
}

/// Looks for the evidence of one cause.
pub(crate) type CauseRule = fn(&FrameFacts, &RegionSamples) -> Option<SuspectedCause>;

impl<'a> FrameFacts<'a> {
    /// What a technique that counts volumes was told; `None` of another.
    pub fn volumes(&self) -> Option<VolumeSettings> {
        self.choice.volumes()
    }

    /// What shadow maps were told: their defaults for another technique.
    pub fn map(&self) -> MapSettings {
        MapSettings::read(self.choice.settings())
    }

    /// Texels along each side of maps, textures or silhouettes; 0 where the technique has none.
    pub fn texels(&self) -> f64 {
        f64::from(self.choice.texels().unwrap_or(0))
    }

    pub fn technique(&self) -> Technique {
        self.choice.technique()
    }

    /// The object of that name as the technique was given it, with its index.
    pub fn object(&self, name: &str) -> Option<(usize, &'a Object)> {
        self.scene.objects.iter().enumerate().find(|(_, object)| object.name == name)
    }

    /// The passes of a light that are part of the frame.
    pub fn passes(&self, light: usize) -> impl Iterator<Item = &'a Pass> {
        self.plan.passes.iter().filter(move |pass| pass.timed && pass.light.is_some_and(|of| of.0 == light))
    }

    /// The draws of a part of a light's shadows, as the camera sees them.
    pub fn draws(&self, light: usize, part: DrawPart) -> impl Iterator<Item = &'a Draw> {
        let passes = self.passes(light).filter(move |pass| part == DrawPart::Map || pass.view.0 == 0);
        passes.flat_map(|pass| &pass.draws).filter(move |draw| draw.part.includes(part))
    }

    /// Are volumes counted for a light?
    pub fn counts_volumes(&self, light: usize) -> bool {
        self.passes(light).any(|pass| pass.view.0 == 0 && pass.draws.iter().any(|draw| draw.part.is_of_volume()))
    }

    /// Is a caster's volume counted behind the visible surface?
    pub fn counts_behind(&self, light: usize, caster: &str) -> bool {
        let of_caster = |draw: &&Draw| draw.caster.as_deref() == Some(caster);
        let mut sides = self.draws(light, DrawPart::Side).filter(of_caster);
        sides.any(|draw| {
            let stencil = &draw.raster.stencil;
            let keeps = wgpu::StencilOperation::Keep;
            let in_stencil = stencil.front.depth_fail_op != keeps || stencil.back.depth_fail_op != keeps;
            let is_plain = draw.raster.depth_compare == self.nearer();
            in_stencil || (draw.program == crate::plan::Program::Count && !is_plain)
        })
    }

    /// The test that lets through what is nearer.
    fn nearer(&self) -> wgpu::CompareFunction {
        let is_reversed = self.plan.depth.mapping.is_reversed();
        if is_reversed { wgpu::CompareFunction::Greater } else { wgpu::CompareFunction::Less }
    }

    /// Does a triangle of a caster cast for a light, as settings and meshes decide?
    pub fn casts(&self, light: usize, met: &OccluderHit) -> bool {
        match self.casting[light][met.place.object] {
            Casters::LightFacing => met.faces_light,
            Casters::LightBackFacing => !met.faces_light,
            Casters::All => true,
        }
    }

    /// Metres that a pixel is wide at a distance along the view's axis.
    pub fn pixel_width(&self, depth: f64) -> f64 {
        2.0 * self.scene.camera.half_height_at(depth) / f64::from(self.plan.size[1])
    }

    /// Radians of the view that a pixel's height is, at the least.
    pub fn pixel_angle(&self) -> f64 {
        let [near, away] = [0.0, 1.0].map(|depth| self.pixel_width(depth));
        (away - near).max(1e-9)
    }

    /// The names of the objects that rays have met, in order.
    pub fn names(&self, met: &[OccluderHit]) -> BTreeSet<String> {
        met.iter().map(|met| self.tracer.name(met.place).to_owned()).collect()
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

    /// How many samples show something, with what the first of them tells.
    pub fn shown<T>(&self, look: impl FnMut(&PixelSample) -> Option<T>) -> Option<(T, usize)> {
        let mut found: Vec<T> = self.samples.iter().filter_map(look).collect();
        let count = found.len();
        (count > 0).then(|| (found.swap_remove(0), count))
    }
}

impl PixelSample {
    /// The middle of the pixel.
    pub fn center(&self) -> [f64; 2] {
        self.pixel.map(|n| f64::from(n) + 0.5)
    }

    /// What a caster's volume added to the count of a light here, as if no count had limits.
    pub fn counted(&self, light: usize, caster: &str) -> i32 {
        self.volume_events(light)
            .filter(|(_, one)| one.caster.as_deref() == Some(caster))
            .map(|(event, _)| event.step())
            .sum()
    }

    /// The faces of a light's volumes here.
    pub fn volume_events(
        &self,
        light: usize,
    ) -> impl Iterator<Item = (&crate::history::PixelEvent, &crate::history::TriangleEvent)> {
        let all = self.history.iter().flat_map(|history| history.triangles());
        all.filter(move |(event, _)| event.light == Some(light) && event.is_of_volume())
    }

    /// Casters whose volume was counted otherwise than their triangles between light and surface say: name, as
    /// counted, and as it should be.
    pub fn miscounted(&self, facts: &FrameFacts, light: usize) -> Vec<(String, i32, i32)> {
        if self.history.is_none() || self.seen.is_none() {
            return Vec::new();
        }
        let mut found = Vec::new();
        for object in facts.scene.objects.iter().filter(|object| object.casts) {
            let is_of = |met: &&OccluderHit| facts.tracer.name(met.place) == object.name && facts.casts(light, met);
            let expected = self.between.iter().filter(is_of).count() as i32;
            let counted = self.counted(light, &object.name);
            if counted != expected {
                found.push((object.name.clone(), counted, expected));
            }
        }
        found
    }
}

/// `3 volumes`.
pub(crate) fn amount(count: u64, noun: &str) -> String {
    format!("{} {noun}{}", crate::numbers::count(count), if count == 1 { "" } else { "s" })
}

/// `box, ring and floor`.
pub(crate) fn listed<'n>(names: impl IntoIterator<Item = &'n String>) -> String {
    let names: Vec<&str> = names.into_iter().map(String::as_str).collect();
    match names.split_last() {
        None => "nothing".to_owned(),
        Some((last, [])) => (*last).to_owned(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
    }
}

//! The data that rules examine: the frame as it was given and run, its truth, and a few pixels closely.

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

/// One frame. It does not contain whether, or how, an error was injected.
pub(crate) struct FrameFacts<'a> {
    /// The scene as the technique was given it.
    pub scene: &'a Scene,
    /// The technique and settings that were used.
    pub choice: &'a Choice,
    /// The plan that was run.
    pub plan: &'a FramePlan,
    pub capture: &'a Capture,
    /// Follows rays through the scene as it should be.
    pub tracer: &'a Tracer,
    /// Facts of the objects' meshes, parallel to the scene's objects.
    pub meshes: &'a [MeshFacts],
    /// Which triangles of each object cast: by light, parallel to the scene's objects.
    pub casting: &'a [Vec<Casters>],
}

/// A region with a few of its pixels examined closely.
pub(crate) struct RegionSamples<'a> {
    pub region: &'a ConnectedRegion,
    pub samples: Vec<PixelSample>,
}

/// One pixel of a region, examined closely.
pub(crate) struct PixelSample {
    pub pixel: [u32; 2],
    pub seen: Option<SeenSurface>,
    /// The occluders that rays find between light and surface, the nearest to the surface first.
    pub between: Vec<OccluderHit>,
    /// The pixel's fragments; `None` where the technique leaves none that explain its shadow.
    pub history: Option<PixelHistory>,
}

/// A cause that the evidence suggests.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SuspectedCause {
    pub cause: Cause,
    pub evidence: String,
    /// Fixes in the order in which they are tried; empty where nothing helps.
    pub fixes: Vec<Fix>,
    /// The number of samples that show it.
    pub shown_by: usize,
    /// How specific the evidence is to this very frame: larger is named before smaller.
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
    /// The settings of a technique that counts volumes; `None` for another.
    pub fn volumes(&self) -> Option<VolumeSettings> {
        self.choice.volumes()
    }

    /// The settings of shadow maps; their defaults for another technique.
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

    /// Returns the object of that name as the technique was given it, with its index.
    pub fn object(&self, name: &str) -> Option<(usize, &'a Object)> {
        self.scene.objects.iter().enumerate().find(|(_, object)| object.name == name)
    }

    /// The passes of a light that are part of the frame.
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

    /// Returns whether a caster's volume is counted behind the visible surface.
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

    /// The depth test that only nearer fragments pass.
    fn nearer(&self) -> wgpu::CompareFunction {
        let is_reversed = self.plan.depth.mapping.is_reversed();
        if is_reversed { wgpu::CompareFunction::Greater } else { wgpu::CompareFunction::Less }
    }

    /// Returns whether a triangle of a caster casts for a light, as settings and meshes decide.
    pub fn casts(&self, light: usize, met: &OccluderHit) -> bool {
        match self.casting[light][met.place.object] {
            Casters::LightFacing => met.faces_light,
            Casters::LightBackFacing => !met.faces_light,
            Casters::All => true,
        }
    }

    /// Returns the width of a pixel in metres at a distance along the view's axis.
    pub fn pixel_width(&self, depth: f64) -> f64 {
        2.0 * self.scene.camera.half_height_at(depth) / f64::from(self.plan.size[1])
    }

    /// The least angle that a pixel's height takes in the view, radians.
    pub fn pixel_angle(&self) -> f64 {
        let [near, away] = [0.0, 1.0].map(|depth| self.pixel_width(depth));
        (away - near).max(1e-9)
    }

    /// Returns the names of the objects that rays hit.
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

    /// Returns how many samples show something, with what `look` returned for the first of them.
    pub fn shown<T>(&self, look: impl FnMut(&PixelSample) -> Option<T>) -> Option<(T, usize)> {
        let mut found: Vec<T> = self.samples.iter().filter_map(look).collect();
        let count = found.len();
        (count > 0).then(|| (found.swap_remove(0), count))
    }
}

impl PixelSample {
    /// The pixel's centre.
    pub fn center(&self) -> [f64; 2] {
        self.pixel.map(|n| f64::from(n) + 0.5)
    }

    /// Returns what a caster's volume added to the count of a light here, as if no count had limits.
    pub fn counted(&self, light: usize, caster: &str) -> i32 {
        self.volume_events(light)
            .filter(|(_, one)| one.caster.as_deref() == Some(caster))
            .map(|(event, _)| event.step())
            .sum()
    }

    /// Returns the fragments of a light's volumes here.
    pub fn volume_events(
        &self,
        light: usize,
    ) -> impl Iterator<Item = (&crate::history::PixelEvent, &crate::history::TriangleEvent)> {
        let all = self.history.iter().flat_map(|history| history.triangles());
        all.filter(move |(event, _)| event.light == Some(light) && event.is_of_volume())
    }

    /// Returns the casters whose volume was counted otherwise than their triangles between light and surface require:
    /// name, as counted, and as it should be.
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

/// Writes a number with a noun: `3 volumes`.
pub(crate) fn amount(count: u64, noun: &str) -> String {
    format!("{} {noun}{}", crate::numbers::count(count), if count == 1 { "" } else { "s" })
}

/// Writes a list: `box, ring and floor`.
pub(crate) fn listed<'n>(names: impl IntoIterator<Item = &'n String>) -> String {
    let names: Vec<&str> = names.into_iter().map(String::as_str).collect();
    match names.split_last() {
        None => "nothing".to_owned(),
        Some((last, [])) => (*last).to_owned(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
    }
}

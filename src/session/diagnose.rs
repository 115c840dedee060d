//! Why a frame is wrong: runs it, applies the rules, and has each fix tried (`trials.rs`).

use super::fixed_frame::FixedFrame;
use super::trials::{JudgedFrame, OtherFrames, TrialRuns, judged, labels_of};
use super::truth::TracedScene;
use super::{AsyncSession, CaptureRequest, InjectedFault, SessionError};
use crate::accuracy::Finding;
use crate::capture::Capture;
use crate::diagnosis::facts::{FrameFacts, MovedMap, PixelSample, RegionSamples};
use crate::diagnosis::mesh_facts::MeshFacts;
use crate::diagnosis::regions::{self, ConnectedRegion, RegionKey};
use crate::diagnosis::rules::{self, map_comparison, planar, projective, swim};
use crate::diagnosis::{
    Cause, CauseFound, Diagnosis, Fix, FlagFound, ObjectChange, RegionFound, RegionKind, RemainingRegions,
};
use crate::geometry::{self, Caster};
use crate::gpu::{Executor, work_parts};
use crate::plan::{DrawPart, FramePlan};
use crate::progress::Progress;
use crate::scene::{Light, Object, Scene};
use crate::technique::{self, CasterTriangles, Choice};
use crate::truth::Tracer;
use glam::{DVec3, DVec4};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// The number of pixels of a region that are examined closely: with their histories, and by rays alone.
const SAMPLES: usize = 3;
const SAMPLES_BY_RAYS: usize = 64;
/// The most objects whose flags are examined; each costs a truth.
const MOST_FLAGS: usize = 8;

/// How much of a frame's diagnosis is asked for.
#[derive(Debug, Clone, Copy)]
pub(super) struct DiagnosisExtent {
    /// The most regions of wrong pixels that are explained, the largest first.
    pub most_regions: usize,
    /// Whether advice for the whole picture is asked for.
    pub has_advice: bool,
}

impl DiagnosisExtent {
    const FULL: DiagnosisExtent = DiagnosisExtent { most_regions: Diagnosis::MOST_REGIONS, has_advice: true };
}

/// The frame under diagnosis: its inputs, its capture, and its wrong pixels.
struct DiagnosisRun {
    scene: Scene,
    choice: Choice,
    plan: FramePlan,
    drawn: FramePlan,
    capture: Capture,
    moved: Vec<MovedMap>,
    judged: JudgedFrame,
}

impl AsyncSession {
    /// As [`Session::diagnose`](super::Session::diagnose).
    pub async fn diagnose(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
        fault: InjectedFault<'_>,
        progress: &Progress,
    ) -> Result<Diagnosis, SessionError> {
        self.diagnose_as_far(scene, request, fault, DiagnosisExtent::FULL, progress).await
    }

    /// The same, as far as is asked.
    pub(super) async fn diagnose_as_far(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
        fault: InjectedFault<'_>,
        extent: DiagnosisExtent,
        progress: &Progress,
    ) -> Result<Diagnosis, SessionError> {
        let found = self.diagnosed(scene, request, fault, extent, progress).await;
        self.executor.forget_trials();
        found
    }

    async fn diagnosed(
        &mut self,
        scene: &Scene,
        request: &CaptureRequest,
        fault: InjectedFault<'_>,
        extent: DiagnosisExtent,
        progress: &Progress,
    ) -> Result<Diagnosis, SessionError> {
        let traced = self.traced(scene, request.size, progress).await?;
        let FixedFrame { scene: given, choice, plan, drawn } =
            self.plan_fixed(scene, request, fault, &Fix::default(), None).await?;
        let capture = self.capture_plan(&given, &drawn).await?;
        let cameras = swim::cameras(&given, &choice);
        let moved = self.moved_maps(scene, request, fault, &Fix::default(), &cameras).await?;
        let guarded = self.guarded(&given, &drawn).await?;
        let other = OtherFrames { moved: &moved, guarded: guarded.as_ref() };
        let judged = judged(&self.executor, &plan, &traced, &labels_of(&capture), Some(&capture), other).await;
        let run = DiagnosisRun { scene: given, choice, plan, drawn, capture, moved, judged };
        let meshes = self.mesh_facts(&run.scene, progress).await?;
        let casting = self.casting(&run.scene, &run.choice);
        self.executor.yield_now().await;
        let lights: Vec<_> = run.scene.lights.iter().map(Light::homogeneous).collect();
        let darkening = darkening(&run.scene, &lights, progress)?;
        let size = request.size;
        let facts = FrameFacts {
            scene: &run.scene,
            choice: &run.choice,
            plan: &run.plan,
            drawn: &run.drawn,
            capture: &run.capture,
            moved: &run.moved,
            step: traced.step,
            coarse_step: self.executor.profile().await?.exact_range().coarse_step,
            tracer: &traced.tracer,
            meshes: &meshes,
            casting: &casting,
        };
        let mut found = wrong_regions(&self.executor, &facts, &run).await;
        let listed = found.len().min(extent.most_regions);
        let rest = &found[listed..];
        let rest = RemainingRegions {
            regions: rest.len(),
            pixels: rest.iter().map(|region| region.pixels.len() as u64).sum(),
        };
        found.truncate(listed);
        progress.start(found.len() + 1);
        let mut runs = TrialRuns { scene, request, fault, traced: &traced, progress, done: Vec::new() };
        let mut listed = Vec::new();
        for region in &found {
            if progress.is_cancelled() {
                return Err(SessionError::Cancelled);
            }
            let case = self.case(&facts, region).await?;
            self.executor.yield_now().await;
            let suspicions = rules::suspicions(&facts, &case);
            let causes = self.proven(&mut runs, region, &run.judged.wrong, suspicions).await?;
            listed.push(described(&facts, &case, causes, size));
            progress.advance();
        }
        self.executor.forget_trials();
        let advice = match extent.has_advice {
            true => self.advice(&mut runs, &listed, &run.judged.wrong, run.choice.technique()).await?,
            false => None,
        };
        Ok(Diagnosis {
            scene: scene.name.clone(),
            technique: request.choice.technique(),
            settings: request.choice.settings().clone(),
            size,
            error: run.judged.error,
            // Whether the mesh of an object is closed does not matter if it darkens nothing.
            mesh_findings: darkening
                .into_iter()
                .zip(&meshes)
                .filter(|(darkens, _)| *darkens)
                .flat_map(|(_, mesh)| mesh.findings(&lights))
                .collect(),
            flags: flags(self, scene, &traced, progress).await?,
            regions: listed,
            rest,
            advice,
            left_out_of_files: scene.unsupported().into_iter().cloned().collect(),
        })
    }

    /// Returns which triangles of each object cast under this choice: a list for each light, with an entry for each
    /// object.
    fn casting(&mut self, scene: &Scene, choice: &Choice) -> Vec<Vec<CasterTriangles>> {
        let worlds: Vec<_> = scene.objects.iter().map(Object::world_positions).collect();
        let mut of_light = |light: &Light| {
            let objects = scene.objects.iter().zip(&worlds);
            let casters = objects.map(|(object, world)| Caster { mesh: &object.mesh, pose: &object.pose, world });
            casters
                .map(|caster| technique::casting(choice, scene, &mut self.geometry, caster, light.homogeneous()))
                .collect()
        };
        scene.lights.iter().map(&mut of_light).collect()
    }

    async fn mesh_facts(&mut self, scene: &Scene, progress: &Progress) -> Result<Vec<MeshFacts>, SessionError> {
        let mut facts = Vec::with_capacity(scene.objects.len());
        for object in &scene.objects {
            if progress.is_cancelled() {
                return Err(SessionError::Cancelled);
            }
            self.executor.yield_now().await;
            let edges = self.geometry.edges(&object.mesh);
            facts.push(MeshFacts::new(object, edges, &self.geometry.topology(&object.mesh)));
        }
        Ok(facts)
    }

    /// Returns sample pixels of a region: the surface seen there, the casters between it and the light, and the pixel's
    /// history where the technique counts volumes or draws flattened casters, or where another surface is drawn.
    async fn case<'r>(
        &mut self,
        facts: &FrameFacts<'_>,
        region: &'r ConnectedRegion,
    ) -> Result<RegionSamples<'r>, SessionError> {
        let light = region.light;
        let has_events = facts.counts_volumes(light)
            || facts.draws(light, DrawPart::PlanarShadow).next().is_some()
            || region.key.kind == RegionKind::Wrong(Finding::WrongSurface);
        let mut samples = Vec::new();
        let most = if has_events { SAMPLES } else { SAMPLES_BY_RAYS };
        for pixel in region.samples(facts.plan.size, most) {
            let history = match has_events {
                true => Some(self.history(facts.drawn, facts.capture, pixel).await?),
                false => None,
            };
            self.executor.yield_now().await;
            let seen = facts.tracer.seen_at(pixel.map(|n| f64::from(n) + 0.5));
            let between = seen.map_or_else(Vec::new, |seen| facts.tracer.between(light, &seen));
            samples.push(PixelSample { pixel, seen, between, history });
        }
        Ok(RegionSamples { region, samples })
    }
}

/// Returns which objects can darken anything: those that cast, except floors and the like, for which all receivers lie
/// on the light's side or in their own plane. Each triangle of a floor is compared with each corner of what may be a
/// very large model: that is aborted at once when the work is cancelled.
fn darkening(scene: &Scene, lights: &[DVec4], progress: &Progress) -> Result<Vec<bool>, SessionError> {
    let places: Vec<Vec<DVec3>> = scene.objects.iter().map(Object::world_positions).collect();
    let receiving = || {
        let receives = scene.objects.iter().zip(&places).filter(|(object, _)| object.receives && object.visible);
        let corners = receives.flat_map(|(_, places)| places.iter().copied());
        corners.take_while(|_| !progress.is_cancelled())
    };
    let darkens = |(object, places): (&Object, &Vec<DVec3>)| {
        let triangles = object.mesh.triangles();
        let under = |light: &DVec4| geometry::object_can_darken(places, triangles, *light, receiving);
        object.casts && lights.iter().any(under)
    };
    let darkening = scene.objects.iter().zip(&places).map(darkens).collect();
    // An aborted search has no answer.
    if progress.is_cancelled() { Err(SessionError::Cancelled) } else { Ok(darkening) }
}

/// Returns all regions of wrong pixels, of all lights, the largest first; edges that swim, of which each light has one
/// region, come before all others, and regions that are merely too dark last.
async fn wrong_regions(executor: &Executor, facts: &FrameFacts<'_>, run: &DiagnosisRun) -> Vec<ConnectedRegion> {
    let size = facts.plan.size;
    let [width, height] = size.map(|side| side as usize);
    let mut found = Vec::new();
    for (light, findings) in run.judged.findings.iter().enumerate() {
        let key = |index: usize| {
            let finding = Finding::from_byte(findings[index]).filter(|finding| finding.is_wrong())?;
            Some(key_of(facts, light, RegionKind::Wrong(finding), crate::accuracy::place(index, size)))
        };
        let mut keys: Vec<Option<RegionKey>> = Vec::with_capacity(findings.len());
        for rows in work_parts(height, 1) {
            executor.yield_now().await;
            keys.par_extend((rows.start * width..rows.end * width).into_par_iter().map(key));
        }
        found.extend(regions::find(light, keys, size));
        let mut keys = vec![None; findings.len()];
        for index in &run.judged.too_dark[light] {
            keys[*index] = Some(RegionKey { kind: RegionKind::TooDark, caster: None, receiver: None, hint: None });
        }
        found.extend(regions::find(light, keys, size));
        for (kind, pixels) in [
            (RegionKind::LitTwice, &run.judged.lit_twice[light]),
            (RegionKind::PartlyDark, &run.judged.partly_dark[light]),
            (RegionKind::Seam, &run.judged.seamed[light]),
        ] {
            let mut keys = vec![None; findings.len()];
            let key = |index: &usize| key_of(facts, light, kind, crate::accuracy::place(*index, size));
            let mut of_pixels: Vec<RegionKey> = Vec::with_capacity(pixels.len());
            for part in pixels.chunks(width) {
                executor.yield_now().await;
                of_pixels.par_extend(part.par_iter().map(key));
            }
            pixels.iter().zip(of_pixels).for_each(|(index, key)| keys[*index] = Some(key));
            found.extend(regions::find(light, keys, size));
        }
        // Edges crawl all over the picture at once.
        let swims = RegionKey { kind: RegionKind::Swims, caster: None, receiver: None, hint: None };
        let swimming = &run.judged.wrong.swimming[light];
        let swimming = (0..swimming.len()).filter(|index| swimming[*index]).collect();
        found.extend(ConnectedRegion::of(swims, light, swimming, size));
    }
    found.sort_by_key(|region| {
        let kind = match region.key.kind {
            RegionKind::Swims => 0,
            RegionKind::TooDark => 2,
            _ => 1,
        };
        (kind, std::cmp::Reverse(region.pixels.len()), region.light, region.pixels[0])
    });
    found
}

/// Returns what one wrong pixel reveals by itself: its kind, receiver, and as far as rays and maps show them its caster
/// and a cause. Pixels with the same key are joined to regions.
fn key_of(facts: &FrameFacts, light: usize, kind: RegionKind, pixel: [u32; 2]) -> RegionKey {
    let seen = facts.tracer.seen_at(pixel.map(|n| f64::from(n) + 0.5));
    let receiver = seen.map(|seen| seen.place.object);
    let plain = RegionKey { kind, caster: None, receiver, hint: None };
    let Some(seen) = seen else { return plain };
    if let Some(look) = map_comparison::look(facts, light, kind, &seen) {
        return RegionKey { caster: look.caster, hint: Some(look.cause), ..plain };
    }
    if let Some(look) = projective::look(facts, light, kind, &seen) {
        return RegionKey { caster: Some(look.caster), hint: Some(look.cause), ..plain };
    }
    match kind {
        RegionKind::Wrong(Finding::MissingShadow) => {
            let between = facts.tracer.between(light, &seen);
            RegionKey { caster: between.first().map(|hit| hit.place.object), ..plain }
        }
        RegionKind::Wrong(Finding::FalseShadow) => RegionKey { hint: planar::hint(facts, light, &seen), ..plain },
        _ => plain,
    }
}

fn described(facts: &FrameFacts, case: &RegionSamples, causes: Vec<CauseFound>, size: [u32; 2]) -> RegionFound {
    let region = case.region;
    let light = region.light;
    let name = |object: usize| facts.tracer.object_name(object).to_owned();
    let mut casters: BTreeSet<String> = region.key.caster.map(name).into_iter().collect();
    if casters.is_empty() {
        for sample in &case.samples {
            casters.extend(sample.miscounted(facts, light).into_iter().map(|(name, ..)| name));
            let flattened = sample.history.iter().flat_map(|history| history.triangles());
            let flattened = flattened.filter(|(event, one)| {
                event.light == Some(light) && one.part == DrawPart::PlanarShadow && one.outcome.passed()
            });
            casters.extend(flattened.filter_map(|(_, one)| one.caster.clone()));
        }
    }
    RegionFound {
        pixels: region.pixels.len() as u64,
        kind: region.key.kind,
        light,
        bounds: region.bounds,
        at: case.samples.first().map_or(crate::accuracy::place(region.pixels[0], size), |sample| sample.pixel),
        casters: casters.into_iter().collect(),
        receivers: region.key.receiver.map(name).into_iter().collect(),
        causes,
    }
}

/// Traces, for each flag that an object has not set (receives, casts, visible), what the truth would be with it set,
/// and returns the flags that would change it. At most a few are tried.
async fn flags(
    session: &mut AsyncSession,
    scene: &Scene,
    traced: &TracedScene,
    progress: &Progress,
) -> Result<Vec<FlagFound>, SessionError> {
    let mut found = Vec::new();
    let mut asked = 0;
    for (index, object) in scene.objects.iter().enumerate() {
        let flags = [
            (object.receives, Cause::NotReceiving, ObjectChange::Receives),
            (object.casts, Cause::NotCasting, ObjectChange::Casts),
            (object.visible, Cause::Undrawn, ObjectChange::Visible),
        ];
        for (_, cause, change) in flags.into_iter().filter(|(is_set, ..)| !is_set) {
            if asked == MOST_FLAGS {
                return Ok(found);
            }
            asked += 1;
            let mut with = scene.clone();
            let object = &mut with.objects[index];
            match change {
                ObjectChange::Receives => object.receives = true,
                ObjectChange::Casts => object.casts = true,
                ObjectChange::Visible => object.visible = true,
                ObjectChange::Weld => {}
            }
            let silent = Progress::default();
            let tracer = Tracer::new(&with, traced.truth.size)?;
            let cancel = &mut async |_: &mut AsyncSession| {
                if progress.is_cancelled() {
                    silent.cancel();
                }
            };
            let truth = session.trace(&tracer, &silent, cancel).await?;
            let differs = |(a, b): (&Vec<u8>, &Vec<u8>)| -> Vec<usize> {
                (0..a.len()).filter(|pixel| a[*pixel] != b[*pixel]).collect()
            };
            let changed: Vec<Vec<usize>> = traced.truth.labels.iter().zip(&truth.labels).map(differs).collect();
            let pixels = changed.iter().map(|pixels| pixels.len() as u64).sum();
            let at = changed.iter().flatten().next();
            if pixels > 0 {
                found.push(FlagFound {
                    object: scene.objects[index].name.clone(),
                    cause,
                    pixels,
                    at: at.map(|pixel| crate::accuracy::place(*pixel, traced.truth.size)),
                    fix: Fix::scene(index, &scene.objects[index].name, change),
                });
            }
        }
    }
    Ok(found)
}

//! Why another program's frame is wrong: suspicions from its plan, each tried by running the plan without it.

use super::truth::TracedScene;
use super::{AsyncSession, RunFrame, SessionError};
use crate::accuracy::{Accuracy, Finding};
use crate::capture::{Capture, CapturedLight, Image, StoredQuantity};
use crate::diagnosis::frame_causes::{
    FrameCauseFound, FrameDiagnosis, FrameSuspicion, LightError, RecordedLight, kept_faces, stencil_uses, suspicion,
    suspicions, with_caster_in_map,
};
use crate::diagnosis::{Cause, Evidence, Proof, Quantity, TruthCoverage};
use crate::gpu::SnapshotMemory;
use crate::numbers;
use crate::plan::{FramePlan, LightId};
use crate::progress::Progress;
use crate::recorded::{MapReading, SeenSurfaces, UNKNOWN_DEPTH, UNKNOWN_QUANTITY, labels};
use crate::scene::{Object, Scene};
use crate::truth::{LIT, SHADOW};
use glam::{DVec3, DVec4};
use std::sync::Arc;

/// Returns why nothing is known of the light of a frame without lights, or of which one was not found.
fn unlit(capture: &Capture) -> String {
    if capture.lights.is_empty() {
        return "nothing in this frame counts shadow volumes, and no map is drawn for a light".to_owned();
    }
    // Where that is not known, no light is looked for.
    let limits = capture.origin.iter().flat_map(|origin| &origin.limits);
    if let Some(limit) = limits.clone().find(|limit| limit.as_str() == UNKNOWN_DEPTH) {
        return limit.clone();
    }
    let unfound = capture.lights.iter().enumerate().filter(|(_, light)| light.position == DVec4::ZERO);
    let names: Vec<String> = unfound.map(|(index, _)| LightId(index).name()).collect();
    format!("neither shadow volumes nor a shadow map tell where {} is", names.join(" and "))
}

/// Returns whether nothing but a map tells a light's shadow, and it is not known what that map holds.
fn is_of_unknown_quantity(light: &CapturedLight) -> bool {
    light.shadow.is_none() && light.map.as_ref().is_some_and(|map| map.quantity == StoredQuantity::Unknown)
}

/// Returns the coverage of a frame of which no light is known.
fn without_light(capture: &Capture) -> TruthCoverage {
    let clear = capture.depth.mapping.clear_depth().to_le_bytes();
    let last = capture.steps.len().checked_sub(1).and_then(|last| capture.frame_at(last));
    let depths = last.iter().flat_map(|frame| frame.depth.image.rows()).flat_map(|row| row.chunks_exact(4));
    TruthCoverage::without_light(depths.map(|depth| depth != clear))
}

/// What a frame shows that was run without a cause.
struct FixTrial {
    /// Number of the light's pixels that are still wrong; of acne, those that still need a bias.
    pixels_left: u64,
    /// The light's labels; `None` where the run has none.
    mask: Option<Arc<Image>>,
}

impl AsyncSession {
    /// As [`Session::diagnose_recorded`](super::Session::diagnose_recorded).
    pub async fn diagnose_recorded(
        &mut self,
        frame: &RunFrame,
        progress: &Progress,
    ) -> Result<FrameDiagnosis, SessionError> {
        let (plan, capture) = (&frame.plan, &frame.capture);
        let without = |coverage: Vec<TruthCoverage>, because: &str| FrameDiagnosis {
            scene: capture.scene.clone(),
            coverage,
            no_verdict: Some(because.to_owned()),
            stencil_uses: stencil_uses(plan),
            lights: Vec::new(),
            causes: Vec::new(),
            wrong_again: 0,
            silent: Vec::new(),
            unseen: Vec::new(),
        };
        let scene = match frame.scene() {
            Ok(scene) if !capture.lights.is_empty() => scene,
            Ok(_) | Err(SessionError::NoLights) => return Ok(without(vec![without_light(capture)], &unlit(capture))),
            Err(error) => return Err(error),
        };
        let traced = self.traced_for(scene, capture, progress).await?;
        let coverage = traced.coverage(capture);
        if let Some(first) = coverage.first().filter(|_| coverage.iter().all(TruthCoverage::is_too_little)) {
            let is_unknown = capture.lights.iter().all(is_of_unknown_quantity);
            let because = if is_unknown { UNKNOWN_QUANTITY } else { first.why_too_little() };
            return Ok(without(coverage, because));
        }
        let mut lights = Vec::new();
        let mut causes = Vec::new();
        let seen = SeenSurfaces::of(plan, capture);
        let again = self.run_again(plan, capture).await?;
        let mut wrong_again = 0;
        for (index, light) in capture.lights.iter().enumerate() {
            let id = LightId(index);
            if coverage[index].is_too_little() {
                lights.push(LightError::default());
                continue;
            }
            let found = self.error_of(&traced, plan, capture, id, light.shadow.clone(), &seen).await;
            let Some((found, pixels)) = found else {
                lights.push(LightError::default());
                continue;
            };
            let same = self.error_of(&traced, plan, &again, id, labels(plan, &again, id, &seen), &seen).await;
            let same_light = same.map_or_else(LightError::default, |(same, _)| same);
            let needing_of = |run: &Capture| {
                MapReading::new(run, id, &seen).map_or(0, |reading| reading.self_shadowed().len() as u64)
            };
            wrong_again += same_light.error.wrong();
            // Of what texels are too coarse for, no other cause is to blame, and none that is changed takes it away.
            let (wrong, same) = (found.beyond_texels(), same_light.beyond_texels());
            let (all_wrong, all_same) = (found.error.wrong(), same_light.error.wrong());
            let judge = async |session: &mut AsyncSession, plan: &FramePlan, cause: Cause| {
                let run = session.run_again(plan, capture).await?;
                let mask = labels(plan, &run, id, &seen);
                if cause == Cause::Acne {
                    return Ok(FixTrial { pixels_left: needing_of(&run), mask });
                }
                let left = session.error_of(&traced, plan, &run, id, mask.clone(), &seen).await;
                let pixels_left = match left {
                    Some((left, _)) if cause == Cause::Aliasing => left.error.wrong(),
                    // What takes pixels away and makes more wrong by the size of texels is no fix.
                    Some((left, _)) if left.error.wrong() > all_wrong => wrong.max(left.beyond_texels()),
                    Some((left, _)) => left.beyond_texels(),
                    None => wrong,
                };
                Ok::<_, SessionError>(FixTrial { pixels_left, mask })
            };
            let proof_of = |left: u64, wrong: u64, same: u64| match left {
                0 if wrong > 0 => Proof::Proven,
                // Another rasteriser may get a pixel right by chance.
                left if left < wrong.min(same) => Proof::Part,
                _ => Proof::NotIt,
            };
            let (needing, needing_again) = (needing_of(capture), needing_of(&again));
            lights.push(found);
            let mut of_light: Vec<FrameCauseFound> = Vec::new();
            let examined = RecordedLight { plan, capture, scene, light: id, wrong: &pixels, seen: &seen };
            let mut suspected = suspicions(&examined);
            // What a fix contains of others is tried before it.
            suspected.sort_by_key(|suspicion| suspicion.includes.len());
            for FrameSuspicion { cause, evidence, includes, fixed } in suspected {
                if progress.is_cancelled() {
                    return Err(SessionError::Cancelled);
                }
                let FixTrial { pixels_left, mask } = judge(self, &fixed, cause).await?;
                let contained = of_light.iter().filter(|found| includes.contains(&found.cause));
                let without_it = contained.map(|found| found.pixels_left).min();
                // Where what it contains takes as much away, its own part takes nothing.
                let adds = without_it.is_none_or(|left| pixels_left < left);
                let proof = match cause {
                    Cause::Aliasing => proof_of(pixels_left, all_wrong, all_same),
                    Cause::Acne => proof_of(pixels_left, needing, needing_again),
                    _ => proof_of(pixels_left, wrong, same),
                };
                let is_acne = cause == Cause::Acne && evidence.holds() && proof != Proof::NotIt;
                if let Some(light) = lights.last_mut().filter(|_| is_acne) {
                    // Of those that were examined, this part is drawn dark.
                    light.acne = needing * evidence.shown_by as u64 / (evidence.examined as u64).max(1);
                }
                let proof = if adds { evidence.proof(proof) } else { Proof::NotIt };
                of_light.push(FrameCauseFound {
                    cause,
                    light: id,
                    evidence,
                    proof,
                    pixels_left,
                    together_with: Vec::new(),
                    mask,
                });
            }
            let is_open = of_light
                .iter()
                .filter(|found| !found.is_beside_wrong_pixels())
                .all(|found| found.proof != Proof::Proven);
            if wrong > 0 && is_open {
                let proof_of = |left| proof_of(left, wrong, same);
                of_light.extend(self.together(&examined, &of_light, judge, proof_of, progress).await?);
            }
            causes.extend(of_light);
            causes.extend(self.not_in_map(frame, scene, &traced, id, &seen, progress).await?);
        }
        // Acne that shows at more pixels than are wrong is first. Of equally proven ones aliasing is last: some is in every map.
        causes.sort_by_key(|found| {
            let light = &lights[found.light.0];
            let is_most = found.cause == Cause::Acne && found.proof != Proof::NotIt && light.acne > light.error.wrong();
            let proof = Proof::ALL.iter().position(|proof| *proof == found.proof);
            (!is_most, proof, found.cause == Cause::Aliasing)
        });
        let named = |is_meant: &dyn Fn(&Object) -> bool| {
            scene.objects.iter().filter(|object| is_meant(object)).map(|object| object.name.clone()).collect()
        };
        Ok(FrameDiagnosis {
            scene: capture.scene.clone(),
            coverage,
            no_verdict: None,
            stencil_uses: Vec::new(),
            lights,
            causes,
            wrong_again,
            silent: named(&|object| object.visible && !object.casts),
            unseen: named(&|object| !object.visible),
        })
    }

    /// Finds the surfaces that are drawn into the picture and not into a light's map, and whose shadow would be seen: those
    /// for which pixels turn dark in truth if they cast, and in a run that draws them into the map. They may be meant to cast
    /// none, so that no pixel is called wrong for it.
    async fn not_in_map(
        &mut self,
        frame: &RunFrame,
        scene: &Scene,
        traced: &TracedScene,
        light: LightId,
        seen: &SeenSurfaces,
        progress: &Progress,
    ) -> Result<Vec<FrameCauseFound>, SessionError> {
        /// More are not tried, the largest first.
        const MOST: usize = 4;
        let (plan, capture) = (&frame.plan, &frame.capture);
        let mut silent: Vec<usize> = (0..scene.objects.len()).filter(|index| !scene.objects[*index].casts).collect();
        if capture.lights[light.0].map.is_none() || MapReading::new(capture, light, seen).is_none() {
            return Ok(Vec::new());
        }
        silent.sort_by_key(|index| std::cmp::Reverse(scene.objects[*index].mesh.triangles().len()));
        let mut found = Vec::new();
        for index in silent.into_iter().take(MOST) {
            let mut casting = scene.clone();
            casting.objects[index].casts = true;
            let with_it = self.traced_apart(&casting, capture, progress).await?;
            let darker =
                |(at, (with, without)): (usize, (&u8, &u8))| (*with == SHADOW && *without == LIT).then_some(at);
            let labels_of = with_it.truth.labels[light.0].iter().zip(&traced.truth.labels[light.0]);
            let pixels: Vec<usize> = labels_of.enumerate().filter_map(darker).collect();
            let object = &casting.objects[index];
            let corners = object.world_positions();
            let triangles = object.mesh.triangles().iter().map(|triangle| triangle.map(|at| corners[at as usize]));
            let triangles: Vec<[DVec3; 3]> = triangles.collect();
            let fixed = with_caster_in_map(plan, light, &object.name, &triangles);
            let Some(fixed) = fixed.filter(|_| !pixels.is_empty()) else { continue };
            let run = self.run_again(&fixed, capture).await?;
            let labels = labels(plan, &run, light, seen);
            let reading = MapReading::new(&run, light, seen);
            let kept = kept_faces(&fixed, &run, light);
            let is_left = |index: &&usize| {
                let width = capture.size[0] as usize;
                let at = [**index % width, **index / width].map(|place| place as u32);
                let is_dark = labels.as_ref().and_then(|labels| labels.byte_at(at)) == Some(SHADOW);
                let is_of_texels = |reading| with_it.is_of_texels(reading, light, kept, at, SHADOW);
                !is_dark && !reading.as_ref().is_some_and(is_of_texels)
            };
            let left = pixels.iter().filter(is_left).count() as u64;
            let count = pixels.len() as u64;
            let sentence = format!(
                "{} is drawn into the picture and not into the map: {} pixels would be in its shadow",
                object.name,
                numbers::count(count)
            );
            let quantity = Quantity::at_least("pixels that would be in its shadow", count as f64, 1.0);
            let evidence =
                Evidence { sentence, quantities: vec![quantity], shown_by: pixels.len(), examined: pixels.len() };
            let proof = match left {
                0 => Proof::Proven,
                left if left < count => Proof::Part,
                _ => Proof::NotIt,
            };
            found.push(FrameCauseFound {
                cause: Cause::NotInMap,
                light,
                proof: evidence.proof(proof),
                evidence,
                pixels_left: left,
                together_with: Vec::new(),
                mask: labels,
            });
        }
        Ok(found)
    }

    /// Returns how wrong the labels of a light are that a run of a plan has made, and the pixels that are wrong not only by
    /// the size of texels; `None` without labels.
    async fn error_of(
        &self,
        traced: &TracedScene,
        plan: &FramePlan,
        run: &Capture,
        light: LightId,
        labels: Option<Arc<Image>>,
        seen: &SeenSurfaces,
    ) -> Option<(LightError, Vec<[u32; 2]>)> {
        let labels = labels?;
        let Accuracy { counts, findings, worst } = traced.compare(&self.executor, light.0, &labels).await;
        let (reading, kept) = (MapReading::new(run, light, seen), kept_faces(plan, run, light));
        let width = run.size[0] as usize;
        let (mut within_texel, mut beyond) = (0, Vec::new());
        for (index, finding) in findings.iter().enumerate() {
            let Some(finding) = Finding::from_byte(*finding).filter(|finding| finding.is_wrong()) else { continue };
            let at = [index % width, index / width].map(|place| place as u32);
            let right = if finding == Finding::FalseShadow { LIT } else { SHADOW };
            let is_of_texels = |reading: &MapReading<'_>| traced.is_of_texels(reading, light, kept, at, right);
            match reading.as_ref().is_some_and(is_of_texels) {
                true => within_texel += 1,
                false => beyond.push(at),
            }
        }
        Some((LightError { error: counts, worst, within_texel, acne: 0 }, beyond))
    }

    /// Finds the first cause that takes some of the wrong pixels away, and with it, one by one, whichever cause takes
    /// most of the rest away. Where none does by itself, whichever two or more do together that leave the fewest: an eye in
    /// a volume whose side lies before the near plane needs both. `None` where nothing helps.
    async fn together(
        &mut self,
        light: &RecordedLight<'_>,
        found: &[FrameCauseFound],
        judge: impl AsyncFn(&mut AsyncSession, &FramePlan, Cause) -> Result<FixTrial, SessionError>,
        proof_of: impl Fn(u64) -> Proof,
        progress: &Progress,
    ) -> Result<Option<FrameCauseFound>, SessionError> {
        // What texels are too coarse for is no pixel of these.
        let is_of_these = |one: &&FrameCauseFound| !one.is_beside_wrong_pixels() && one.cause != Cause::Aliasing;
        let found: Vec<&FrameCauseFound> = found.iter().filter(is_of_these).collect();
        let helps = |one: &FrameCauseFound| one.proof == Proof::Part;
        let firsts = match found.iter().find(|one| helps(one)) {
            Some(first) => vec![*first],
            None => found.clone(),
        };
        let without = |cause, plan: &FramePlan| suspicion(cause, &RecordedLight { plan, ..*light });
        let mut least: Option<FrameCauseFound> = None;
        for (index, first) in firsts.iter().enumerate() {
            if least.as_ref().is_some_and(|least| least.pixels_left == 0) {
                break;
            }
            // With those before it, it was tried already.
            let partners = if firsts.len() > 1 { &found[index + 1..] } else { &found[..] };
            let Some(FrameSuspicion { mut fixed, .. }) = without(first.cause, light.plan) else { continue };
            let mut joined = (*first).clone();
            joined.pixels_left = joined.pixels_left.min(light.wrong.len() as u64);
            loop {
                let mut best: Option<(FixTrial, FrameSuspicion)> = None;
                let is_in = |cause: Cause| cause == first.cause || joined.together_with.contains(&cause);
                for cause in partners.iter().map(|one| one.cause).filter(|cause| !is_in(*cause)) {
                    if progress.is_cancelled() {
                        return Err(SessionError::Cancelled);
                    }
                    let Some(found) = without(cause, &fixed) else { continue };
                    let trial = judge(self, &found.fixed, cause).await?;
                    if trial.pixels_left < best.as_ref().map_or(joined.pixels_left, |(best, _)| best.pixels_left) {
                        best = Some((trial, found));
                    }
                }
                let Some((FixTrial { pixels_left: left, mask }, suspicion)) = best else { break };
                let FrameSuspicion { cause, evidence, fixed: plan, .. } = suspicion;
                joined.evidence.sentence += &format!("; {}", evidence.sentence);
                joined.evidence.quantities.extend(evidence.quantities);
                (joined.pixels_left, joined.proof, fixed) = (left, joined.evidence.proof(proof_of(left)), plan);
                joined.together_with.push(cause);
                joined.mask = mask;
            }
            let is_less = least.as_ref().is_none_or(|least| joined.pixels_left < least.pixels_left);
            if !joined.together_with.is_empty() && is_less {
                least = Some(joined);
            }
        }
        Ok(least.filter(|joined| joined.proof != Proof::NotIt))
    }

    /// Runs a recorded plan again from its first pass on, and returns the capture with the steps that this leaves in
    /// place of the stored ones.
    async fn run_again(&mut self, plan: &FramePlan, capture: &Capture) -> Result<Capture, SessionError> {
        let prepared = self.executor.prepare_once(plan).await?;
        let output = self.executor.capture(prepared, SnapshotMemory::Shared, false).await?;
        let made = plan.lights.iter().zip(output.maps);
        let lights = capture.lights.iter().cloned().zip(made).map(|(mut light, (planned, faces))| {
            if let (Some(map), Some(planned), Some(faces)) = (&mut light.map, &planned.map, faces) {
                map.faces = faces;
                map.clip_from_light.clone_from(&planned.clip_from_light);
                // Whatever a shader wrote, a run leaves depths.
                map.quantity = StoredQuantity::Depth;
            }
            light
        });
        Ok(Capture { steps: output.steps, lights: lights.collect(), ..capture.clone() })
    }
}

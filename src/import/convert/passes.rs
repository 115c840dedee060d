//! Runs of draws that do the same become passes, and what was stored after each draw becomes steps.

use super::stage::{DrawTarget, FollowedTargets};
use super::states::{self, DrawRole};
use crate::capture::{Aspect, DrawState, DrawSummary, FrameSnapshot, FrameTarget, Image, PixelFormat, Snapshot, Step};
use crate::import::raw::{RawContents, RawDraw, RawEvent, RawFrame, RawKind, RawTarget};
use crate::plan::{
    Blob, DepthStencilTarget, Draw, DrawMesh, DrawPart, LeftOut, LightId, MeshId, Pass, Program, RecordedPass,
    StartContent, ViewId, Viewport,
};
use std::collections::BTreeMap;
use std::sync::Arc;

/// What the draws of a pass have in common.
#[derive(Debug, Clone, PartialEq)]
struct DrawRun {
    place: DrawTarget,
    groups: Vec<String>,
    viewport: Viewport,
    scissor: Option<[u32; 4]>,
    role: DrawRole,
}

/// Builds passes and steps from a frame's events.
pub(super) struct PassBuilder<'a> {
    frame: &'a RawFrame,
    stage: &'a FollowedTargets,
    contents: BTreeMap<RawTarget, RawContents>,
    /// Targets whose depth or stencil something other than a draw has set since: a clear, a load, a copy.
    written: BTreeMap<DrawTarget, [bool; 2]>,
    run: Option<DrawRun>,
    /// Content of the last steps: colour, depth, stencil.
    shown: [Option<Arc<Image>>; 3],
    counting_light: Option<LightId>,
    /// True where the stencil was set by something other than a draw since volumes were counted in it.
    is_emptied: bool,
    pub passes: Vec<Pass>,
    pub steps: Vec<Step>,
    pub meshes: Vec<DrawMesh>,
    pub left_out: Vec<LeftOut>,
}

impl<'a> PassBuilder<'a> {
    /// Returns a builder that has made no pass, with the content that the targets had before the frame.
    pub fn new(frame: &'a RawFrame, stage: &'a FollowedTargets) -> PassBuilder<'a> {
        let mut making = PassBuilder {
            frame,
            stage,
            contents: BTreeMap::new(),
            written: BTreeMap::new(),
            run: None,
            shown: [None, None, None],
            counting_light: None,
            is_emptied: true,
            passes: Vec::new(),
            steps: Vec::new(),
            meshes: Vec::new(),
            left_out: Vec::new(),
        };
        for (target, before) in &frame.before {
            making.hold(*target, before.clone());
            making.written.extend(stage.places(*target).map(|place| (place, [true; 2])));
        }
        making
    }

    /// Returns the current depths of a face of a map; `None` where they are not known.
    pub fn face(&self, map: usize, face: usize) -> Option<Arc<Image>> {
        let [depth, _] = self.current(DrawTarget::Map(map, face), [true, false]);
        depth
    }

    /// Returns the current depth and stencil of a place, its part of a texture, each where it is asked for and known.
    fn current(&self, place: DrawTarget, is_asked: [bool; 2]) -> [Option<Arc<Image>>; 2] {
        let Some(contents) = self.contents.get(&self.stage.target(place)) else { return [None, None] };
        let part =
            |image: &Arc<Image>| self.stage.face(place).map_or_else(|| image.clone(), |face| face.part_of(image));
        let [depth, stencil] = is_asked;
        [contents.depth.as_ref().filter(|_| depth).map(part), contents.stencil.as_ref().filter(|_| stencil).map(part)]
    }

    /// Follows the next event: adds a draw to the current pass or begins one for it; a draw that can't be followed is
    /// left out with the reason. What any event left in the targets is noted, and becomes the content that the next
    /// pass begins with.
    pub fn event(&mut self, event: &RawEvent) {
        if let RawKind::Draw(draw) = &event.kind {
            // A pass begins with the content that is current before it.
            match self.begin_for(event, draw) {
                Ok((place, cull)) => {
                    self.note(event);
                    return self.add(event, draw, place, cull);
                }
                Err(why) => self.leave_out(event, why),
            }
        }
        // Its result is current when the next pass begins, whatever it was.
        let before = event.depth_target.and_then(|target| self.contents.get(&target).cloned()).unwrap_or_default();
        self.note(event);
        let Some(target) = event.depth_target else { return };
        let Some(after) = self.contents.get(&target) else { return };
        // A clear counts even where it changes nothing: counts from then on are another light's.
        let clears = matches!(event.kind, RawKind::Clear { stencil: true, .. });
        for place in self.stage.places(target) {
            let differs =
                |one: &Option<Arc<Image>>, other: &Option<Arc<Image>>| match (self.stage.face(place), one, other) {
                    (Some(face), Some(one), Some(other)) => face.differs(one, other),
                    _ => one != other,
                };
            let changed = [differs(&before.depth, &after.depth), differs(&before.stencil, &after.stencil) || clears];
            self.is_emptied |= place == DrawTarget::Picture && changed[1];
            if changed != [false; 2] {
                let written = self.written.entry(place).or_default();
                *written = [written[0] || changed[0], written[1] || changed[1]];
                self.run = None;
            }
        }
    }

    /// Stores what an event left in its depth target and in its first colour target.
    fn note(&mut self, event: &RawEvent) {
        let after = &event.after;
        if let Some(target) = event.depth_target {
            self.hold(target, RawContents { color: None, ..after.clone() });
        }
        if let Some(target) = event.color_targets.first() {
            self.hold(*target, RawContents { color: after.color.clone(), ..RawContents::default() });
        }
    }

    /// Replaces the known content of a target, aspect by aspect; an aspect that is missing or has another size leaves
    /// what is known.
    fn hold(&mut self, target: RawTarget, RawContents { depth, stencil, color }: RawContents) {
        let size = self.frame.size_of(target);
        let of_size = |image: Option<Arc<Image>>| image.filter(|image| image.size() == size);
        let contents = self.contents.entry(target).or_default();
        contents.depth = of_size(depth).or(contents.depth.take());
        contents.stencil = of_size(stencil).or(contents.stencil.take());
        contents.color = of_size(color).or(contents.color.take());
    }

    /// Begins a pass for a draw, unless it continues the one before (same target, debug groups, viewport, scissor and
    /// role). Returns the draw's target and culled faces, or as an error the reason why it can't be followed.
    fn begin_for(
        &mut self,
        event: &RawEvent,
        draw: &RawDraw,
    ) -> Result<(DrawTarget, Option<wgpu_types::Face>), &'static str> {
        let viewport = states::viewport(draw);
        let place = match (event.depth_target, event.color_targets.first()) {
            (Some(target), _) => self.stage.place(target, &viewport),
            (None, Some(target)) => (Some(*target) == self.stage.color).then_some(DrawTarget::Colors),
            (None, None) => None,
        };
        let is_beside = event.depth_target.is_some_and(|target| self.stage.places(target).next().is_some());
        let place = place.ok_or(match is_beside {
            true => "it draws into a part of a depth map for which no light is found",
            false => "it draws into a picture that is neither this one nor a depth map",
        })?;
        let cull = states::drawable(draw)?;
        let scissor = states::scissor(draw, self.stage.area(self.frame, place));
        if scissor.is_some_and(|[_, _, columns, rows]| columns == 0 || rows == 0) {
            return Err("its scissor leaves no pixel");
        }
        let viewport = self.stage.face(place).map_or(viewport, |face| face.viewport(viewport));
        let role = states::role(draw, place, self.is_emptied);
        let run = DrawRun { place, groups: event.groups.clone(), viewport, scissor, role };
        if self.run.as_ref() != Some(&run) {
            self.begin(run);
        }
        Ok((place, cull))
    }

    fn leave_out(&mut self, event: &RawEvent, because: &str) {
        self.left_out.push(LeftOut {
            decision: None,
            name: None,
            what: format!("event {}", event.id),
            of: event.name.clone(),
            count: None,
            because: because.to_owned(),
        });
    }

    /// Returns the light of a pass: a map's own; for passes that count or test volumes the one whose volumes were
    /// counted last; else `None`. Counting in a stencil that was cleared or set since begins another light, and testing it is
    /// of none.
    fn light(&mut self, run: &DrawRun) -> Option<LightId> {
        if let DrawTarget::Map(map, _) = run.place {
            return Some(LightId(map));
        }
        if run.role == DrawRole::Counts && std::mem::take(&mut self.is_emptied) {
            let next = self.counting_light.map_or(self.stage.maps.len(), |light| light.0 + 1);
            self.counting_light = Some(LightId(next));
        }
        // What is set anew holds no light's count.
        let asks = run.role == DrawRole::Tests && !self.is_emptied;
        self.counting_light.filter(|_| run.role == DrawRole::Counts || asks)
    }

    fn begin(&mut self, run: DrawRun) {
        let written = if run.place == DrawTarget::Colors {
            [false; 2]
        } else {
            self.written.remove(&run.place).unwrap_or_default()
        };
        // Content before its first draw: the current content may be the result of that draw.
        let (content, clears) = self.content(run.place, written);
        let light = self.light(&run);
        let (attachment, layer) = match run.place {
            DrawTarget::Picture | DrawTarget::Colors => (super::DEPTH_STENCIL, 0),
            DrawTarget::Map(map, face) => (super::map_attachment(map), face as u32),
        };
        let target = DepthStencilTarget { attachment, layer, clear_depth: clears.0, clear_stencil: clears.1 };
        let (name, purpose) = (run.role.name().to_owned(), run.role.purpose().to_owned());
        let recorded =
            RecordedPass { viewport: run.viewport, groups: run.groups.clone(), darkens: false, start: content };
        self.passes.push(Pass {
            name: name.clone(),
            purpose: purpose.clone(),
            light,
            timed: true,
            view: ViewId(0),
            color: None,
            depth_stencil: (run.place != DrawTarget::Colors).then_some(target),
            scissor: run.scissor,
            draws: Vec::new(),
            image: None,
            viewport: None,
            recorded: Some(Box::new(recorded)),
        });
        let snapshot = match run.place {
            DrawTarget::Map(map, face) => Snapshot::Map { light: map, face },
            _ => Snapshot::Frame(self.snapshot()),
        };
        let light = light.map(|light| light.0);
        self.steps.push(Step { name, purpose, light, draws: Vec::new(), gpu_ms: None, snapshot });
        self.run = Some(run);
    }

    /// Returns the depth and stencil of a target, where the flags say that they were set since its last pass: as
    /// content to write or, where one value is everywhere, as that value to clear to. `None` for what was not set or is
    /// not known.
    fn content(&self, place: DrawTarget, was_set: [bool; 2]) -> (Option<StartContent>, (Option<f32>, Option<u8>)) {
        let [depth, stencil] = self.current(place, was_set);
        let one_depth = depth.as_deref().and_then(uniform).map(|texel| bytemuck::pod_read_unaligned(&texel));
        let one_stencil = stencil.as_deref().and_then(uniform).map(|texel| texel[0]);
        let rows = |image: Arc<Image>| image.rows().collect::<Vec<_>>().concat();
        let start = StartContent {
            depth: depth
                .filter(|_| one_depth.is_none())
                .map(|image| Blob::new(rows(image).chunks_exact(4).map(bytemuck::pod_read_unaligned).collect())),
            stencil: stencil.filter(|_| one_stencil.is_none()).map(|image| Blob::new(rows(image))),
        };
        (Some(start).filter(|start| *start != StartContent::default()), (one_depth, one_stencil))
    }

    fn add(&mut self, event: &RawEvent, draw: &RawDraw, place: DrawTarget, cull: Option<wgpu_types::Face>) {
        let is_of_picture = !matches!(place, DrawTarget::Map(..));
        // It is not known for draws that are not followed one by one.
        let is_known = is_of_picture && event.after != RawContents::default();
        let after = is_known.then(|| DrawState { snapshot: Snapshot::Frame(self.snapshot()), target: None });
        let (Some(pass), Some(step)) = (self.passes.last_mut(), self.steps.last_mut()) else { return };
        let part = match self.run.as_ref().map(|run| run.role) {
            Some(DrawRole::FillsMap) => DrawPart::Map,
            Some(DrawRole::Counts) => DrawPart::Side,
            _ => DrawPart::Surface,
        };
        let (name, triangles) = (format!("event {}", event.id), draw.triangles.len() as u32);
        let mesh = MeshId(self.meshes.len());
        self.meshes.push(mesh_of(draw, name.clone()));
        let target = self.frame.textures[self.stage.target(place).texture].format.clone();
        let raster = states::raster(draw, cull, place != DrawTarget::Colors && target.has_stencil());
        let program =
            Program::Recorded { may_discard: draw.fragment.may_discard, writes_depth: draw.fragment.writes_depth };
        if let (Some(DrawState { snapshot: Snapshot::Frame(after), .. }), Snapshot::Frame(snapshot)) =
            (&after, &mut step.snapshot)
        {
            *snapshot = after_all(snapshot, after.clone());
        }
        let summary =
            DrawSummary { name: name.clone(), caster: None, part, triangles: triangles.into(), after, differs: None };
        step.draws.push(summary);
        let samples_maps_of = self.stage.sampled_by(event.id);
        pass.draws.push(Draw { program, samples_maps_of, ..Draw::of_positions(name, part, mesh, triangles, raster) });
    }

    /// Returns colour, depth and stencil of the picture as last known, each marked as unchanged where equal to the last
    /// snapshot; what is not known is as in that one, or zero.
    fn snapshot(&mut self) -> FrameSnapshot {
        let size = self.stage.size(self.frame);
        let of_depth = self.contents.get(&self.stage.depth).cloned().unwrap_or_default();
        let color = self.stage.color.and_then(|color| self.contents.get(&color)?.color.clone());
        let mut aspect = |slot: usize, image: Option<Arc<Image>>, format: PixelFormat| {
            let image = image.unwrap_or_else(|| {
                let texel = vec![0; format.texel_bytes()];
                self.shown[slot].clone().unwrap_or_else(|| Arc::new(Image::uniform(format, size, &texel)))
            });
            let unchanged = self.shown[slot].as_ref().is_some_and(|shown| *shown == image);
            let image = self.shown[slot].take().filter(|_| unchanged).unwrap_or(image);
            self.shown[slot] = Some(image.clone());
            Aspect { image, unchanged }
        };
        let has_stencil = self.frame.textures[self.stage.depth.texture].format.has_stencil();
        FrameSnapshot {
            color: aspect(0, color, PixelFormat::Rgba8Srgb),
            depth: aspect(1, of_depth.depth, PixelFormat::Depth32F),
            stencil: has_stencil.then(|| aspect(2, of_depth.stencil, PixelFormat::U8)),
            target: FrameTarget::Picture,
        }
    }
}

/// Returns a draw's triangles. Where its retained fragments are known, the shader that draws them again identifies a
/// triangle by its corners: none is shared.
fn mesh_of(draw: &RawDraw, name: String) -> DrawMesh {
    let (vertices, indices) = (states::vertices(draw), draw.triangles.as_flattened());
    let Some(retained) = &draw.retained else { return DrawMesh::of_positions(name, vertices, indices.to_vec()) };
    let corners = indices.iter().map(|index| vertices[*index as usize]).collect();
    let word = |(pixel, triangle): &([u16; 2], u32)| [DrawMesh::pixel_word(pixel.map(u32::from)), *triangle];
    let mut retained: Vec<[u32; 2]> = retained.iter().map(word).collect();
    retained.sort_unstable();
    let all = (0..indices.len() as u32).collect();
    DrawMesh { retained: Some(Blob::new(retained)), ..DrawMesh::of_positions(name, corners, all) }
}

/// Returns the state after draws that left `before`, and one more that left `after`: aspects that none of them changed
/// are unchanged.
fn after_all(before: &FrameSnapshot, mut after: FrameSnapshot) -> FrameSnapshot {
    after.color.unchanged &= before.color.unchanged;
    after.depth.unchanged &= before.depth.unchanged;
    if let (Some(after), Some(before)) = (&mut after.stencil, &before.stencil) {
        after.unchanged &= before.unchanged;
    }
    after
}

/// Returns the bytes of the texel that the whole image consists of; `None` where texels differ, or there are none.
fn uniform(image: &Image) -> Option<Vec<u8>> {
    let texel = image.format().texel_bytes();
    let first = image.rows().next()?.get(..texel)?.to_vec();
    image.rows().all(|row| row.chunks_exact(texel).all(|one| one == first)).then_some(first)
}

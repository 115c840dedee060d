//! Reads a capture folder. Its content is not trusted: every file, size and index is checked.

use super::super::manifest::{self, LightEntry, Manifest, PassEntry, StateFiles};
use super::super::store::{CaptureFiles, MemoryFiles};
use super::super::{
    Aspect, Capture, CapturedLight, CapturedMap, CapturedTruth, FrameSnapshot, FrameTarget, Image, PixelFormat,
    Snapshot, Step, VisibilityTruth, files,
};
use super::{CaptureError, MANIFEST, PLAN, SCENE, WholeFrame, frame};
use crate::accuracy::WrongRegion;
use crate::files::exists;
use crate::math::depth::DepthMapping;
use crate::plan::{FramePlan, lint};
use crate::scene::{self, Scene};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

/// Reads a capture folder with the frame's plan and scene; each is `None` where the folder has no file for it.
pub fn read_whole(folder: &Path) -> Result<WholeFrame, CaptureError> {
    let files = CaptureFiles::of_folder(folder);
    let capture = read_of(&files)?;
    let plan = frame::read(&files, &capture, lint::check)?;
    let file = folder.join(SCENE);
    let mut scene = if exists(&file) { Some(scene::file::load(&file)?) } else { None };
    if let Some(scene) = &mut scene {
        give_own_lights(scene, &capture)
            .map_err(|reason| CaptureError::Read { file: folder.join(MANIFEST), reason })?;
    }
    Ok(WholeFrame { capture, plan, scene })
}

/// Gives the objects of a scene the lights that a capture has for them alone: no scene file holds these, as our own
/// techniques draw no frame with them. Fails where one is for an object that is not there, or there are too
/// many.
fn give_own_lights(scene: &mut Scene, capture: &Capture) -> Result<(), String> {
    let known: BTreeSet<&str> = scene.objects.iter().map(|object| object.name.as_str()).collect();
    for light in &capture.lights {
        if let Some(name) = light.of_casters.keys().find(|name| !known.contains(name.as_str())) {
            return Err(format!("a light has a place for `{}`, which the scene has not", name.escape_debug()));
        }
        let places: BTreeSet<_> = light.of_casters.values().map(|at| at.to_array().map(f64::to_bits)).collect();
        if places.len() > CapturedLight::MOST_PLACES {
            return Err(format!("a light is in {} places, of {}", places.len(), CapturedLight::MOST_PLACES));
        }
    }
    for object in &mut scene.objects {
        let own = capture.lights.iter().map(|light| light.of_casters.get(&object.name)).enumerate();
        object.light_positions = own.filter_map(|(light, position)| Some((light, *position?))).collect();
    }
    Ok(())
}

/// Reads the files of a capture folder that are in memory: the capture, and the frame's plan where it is there, which is
/// to be read and not run: it may be without shading. The length of texts has no limit here, as they are in memory already.
pub fn read_memory(files: &MemoryFiles) -> Result<(Capture, Option<FramePlan>), CaptureError> {
    let files = CaptureFiles::Memory(files);
    let capture = read_of(&files)?;
    let plan = frame::read(&files, &capture, lint::check_unshaded)?;
    Ok((capture, plan))
}

/// Reads a capture folder without the frame's plan and scene.
pub fn read(folder: &Path) -> Result<Capture, CaptureError> {
    read_of(&CaptureFiles::of_folder(folder))
}

fn read_of(folder: &CaptureFiles) -> Result<Capture, CaptureError> {
    let wrong = |reason: String| CaptureError::Read { file: folder.path(MANIFEST), reason };
    let text = files::read_text(folder, MANIFEST)?;
    let manifest: Manifest = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    if !manifest::SCHEMAS.contains(&manifest.schema) {
        return Err(wrong(format!("its schema is {}, of which this version knows nothing", manifest.schema)));
    }
    if !manifest.size.iter().all(|pixels| (1..=files::LARGEST).contains(pixels)) {
        return Err(wrong(format!("its picture is {}x{}", manifest.size[0], manifest.size[1])));
    }
    let mut reader = FolderReader { folder, size: manifest.size, images: BTreeMap::new() };
    let lights =
        manifest.lights.iter().map(|light| reader.light(light, &manifest.technique)).collect::<Result<Vec<_>, _>>()?;
    let steps = manifest.passes.iter().map(|pass| reader.step(pass, &lights)).collect::<Result<_, _>>()?;
    let capture = Capture {
        scene: manifest.scene,
        technique: manifest.technique,
        settings: manifest.settings,
        size: manifest.size,
        adapter: manifest.adapter,
        profile: manifest.profile,
        camera: manifest.camera,
        depth: manifest.depth.unwrap_or_else(|| DepthMapping::ReversedInfinite.curve(manifest.camera.near, 0.0, 0.0)),
        steps,
        lights,
        left_out: manifest.left_out,
        timing: manifest.timing,
        plan_text: read_plan(folder)?,
        origin: manifest.origin,
    };
    match inconsistency(&capture) {
        Some(reason) => Err(wrong(reason.to_owned())),
        None => Ok(capture),
    }
}

/// Reads the text form of the plan from its file; returns an empty string where the folder has none.
fn read_plan(folder: &CaptureFiles) -> Result<String, CaptureError> {
    if folder.has(PLAN) { files::read_text(folder, PLAN) } else { Ok(String::new()) }
}

/// Returns whether depths are stored in a range that a viewport can have, if in any.
fn has_possible_range(capture: &Capture) -> bool {
    capture.depth.range.is_none_or(|range| {
        let [near, far] = range.stored;
        (0.0..=1.0).contains(&near)
            && (near..=1.0).contains(&far)
            && range.device_offset.is_finite()
            && range.device_scale.is_finite()
    })
}

/// Returns what is impossible in a capture that was read: no passes, a light, map or face that is not there, depths
/// that can't be read back, or a camera that can't see. `None` where nothing is wrong.
fn inconsistency(capture: &Capture) -> Option<&'static str> {
    let light = |index: usize| capture.lights.get(index);
    let is_consistent = |step: &Step| match &step.snapshot {
        Snapshot::Map { light: index, face } => {
            light(*index).and_then(|light| light.map.as_ref()).is_some_and(|map| *face < map.faces.len())
        }
        Snapshot::Frame(frame) => {
            let own = step.light.and_then(light);
            let is_there =
                frame.target == FrameTarget::Picture || own.and_then(|light| light.target(frame.target)).is_some();
            step.light.is_none_or(|index| light(index).is_some()) && is_there
        }
    };
    if capture.steps.is_empty() {
        Some("it has no passes")
    } else if !capture.steps.iter().all(is_consistent) {
        Some("a pass names a light, map or face that is not there")
    } else if !(capture.depth.offset.is_finite() && capture.depth.scale.is_finite() && has_possible_range(capture)) {
        Some("its depth can't be read back")
    } else if capture.camera.check().is_err() {
        Some("its camera can't see")
    } else {
        None
    }
}

/// Reads each file once: content that the manifest names twice is shared again.
pub(super) struct FolderReader<'a, 'f> {
    folder: &'a CaptureFiles<'f>,
    size: [u32; 2],
    images: BTreeMap<String, Arc<Image>>,
}

impl FolderReader<'_, '_> {
    pub(super) fn wrong(&self, file: &str, reason: &str) -> CaptureError {
        CaptureError::Read { file: self.folder.path(file), reason: reason.to_owned() }
    }

    pub(super) fn image(&mut self, file: &str, format: PixelFormat) -> Result<Arc<Image>, CaptureError> {
        self.image_of_size(file, format, self.size)
    }

    pub(super) fn image_of_size(
        &mut self,
        file: &str,
        format: PixelFormat,
        size: [u32; 2],
    ) -> Result<Arc<Image>, CaptureError> {
        if let Some(image) = self.images.get(file) {
            let is_same_kind = image.format() == format && image.size() == size;
            return is_same_kind
                .then(|| image.clone())
                .ok_or_else(|| self.wrong(file, "it is named as two kinds of picture"));
        }
        let image = files::read_image(self.folder, self.plain(file)?, format)?;
        if image.size() != size {
            return Err(self.wrong(file, "its size is not the manifest's"));
        }
        let image = Arc::new(image);
        self.images.insert(file.to_owned(), image.clone());
        Ok(image)
    }

    /// Returns the name of a file of the folder; an error where it is not plain, so that a manifest can't point out of
    /// its folder.
    fn plain<'b>(&self, file: &'b str) -> Result<&'b str, CaptureError> {
        match super::is_plain(file) {
            true => Ok(file),
            false => Err(self.wrong(MANIFEST, "it names a file outside its folder")),
        }
    }

    fn step(&mut self, pass: &PassEntry, lights: &[CapturedLight]) -> Result<Step, CaptureError> {
        let mut draws = pass.draw_list.clone();
        let files = &pass.files;
        let snapshot = match (files.map.as_ref().or(files.textures.as_ref()), pass.light) {
            (Some(_), Some(light)) => {
                Snapshot::Map { light, face: files.map_face.or(files.texture_layer).unwrap_or(0) }
            }
            _ => Snapshot::Frame(self.frame(files)?),
        };
        if let Some(captured) = &pass.draws_captured {
            self.draw_states(captured, &snapshot, lights, &mut draws)?;
        }
        Ok(Step {
            name: pass.name.clone(),
            purpose: pass.purpose.clone(),
            light: pass.light,
            draws,
            gpu_ms: pass.gpu_ms,
            snapshot,
        })
    }

    pub(super) fn frame(&mut self, files: &StateFiles) -> Result<FrameSnapshot, CaptureError> {
        let unchanged = files.unchanged.clone().unwrap_or_default();
        let mut aspect = |name: &str, file: &Option<String>, format| {
            let file =
                file.as_ref().ok_or_else(|| self.wrong(MANIFEST, &format!("a pass or draw lacks its {name}")))?;
            let unchanged = unchanged.iter().any(|aspect| aspect == name);
            Ok::<_, CaptureError>(Aspect { image: self.image(file, format)?, unchanged })
        };
        let color = aspect("color", &files.color, PixelFormat::Rgba8Srgb)?;
        let depth = aspect("depth", &files.depth, PixelFormat::Depth32F)?;
        let has_stencil = files.stencil.is_some();
        let stencil = has_stencil.then(|| aspect("stencil", &files.stencil, PixelFormat::U8)).transpose()?;
        Ok(FrameSnapshot { color, depth, stencil, target: files.target() })
    }

    fn truth(&mut self, entry: &LightEntry) -> Result<Option<CapturedTruth>, CaptureError> {
        let (Some(labels), Some(findings), Some(error)) = (&entry.truth, &entry.error_picture, entry.error) else {
            return Ok(None);
        };
        let is_possible = |WrongRegion { kind, bounds: [left, top, right, bottom], at, .. }: WrongRegion| {
            let is_inside = left <= right && right < self.size[0] && top <= bottom && bottom < self.size[1];
            kind.is_wrong() && is_inside && at[0] <= right && at[1] <= bottom
        };
        if !entry.worst_region.is_none_or(is_possible) {
            return Err(self.wrong(MANIFEST, "its worst region is outside the picture or of no known kind"));
        }
        Ok(Some(CapturedTruth {
            labels: self.image(labels, PixelFormat::U8)?,
            findings: self.image(findings, PixelFormat::U8)?,
            error,
            worst: entry.worst_region,
            visibility: match (&entry.truth_visibility, entry.visibility_error) {
                (Some(file), Some(error)) => {
                    Some(VisibilityTruth { image: self.image(file, PixelFormat::Value32F)?, error })
                }
                _ => None,
            },
        }))
    }

    fn light(&mut self, entry: &LightEntry, technique: &str) -> Result<CapturedLight, CaptureError> {
        let position = entry.homogeneous().ok_or_else(|| self.wrong(MANIFEST, "a light has no place"))?;
        let is_place = |[x, y, z, w]: &[f64; 4]| *w == 1.0 || (*w == 0.0 && [*x, *y, *z] != [0.0; 3]);
        if !entry.of_casters.values().all(is_place) {
            return Err(self.wrong(MANIFEST, "a light has no place for a caster"));
        }
        let mut target = |file: &Option<String>, target: FrameTarget| {
            file.as_ref().map(|file| self.image(file, target.format())).transpose()
        };
        let shadow = target(&entry.shadow, FrameTarget::Labels)?;
        let count = target(&entry.count, FrameTarget::Count)?;
        let visibility = target(&entry.visibility, FrameTarget::Visibility)?;
        let map = match (entry.map.as_ref().or(entry.textures.as_ref()), &entry.matrices) {
            (Some(file), Some(matrices)) => {
                let faces = files::read_layers(self.folder, self.plain(file)?)?;
                if faces.len() != matrices.clip_from_light.len() {
                    return Err(self.wrong(file, "it has another number of faces than the manifest"));
                }
                Some(CapturedMap {
                    faces: faces.into_iter().map(Arc::new).collect(),
                    layer_names: entry.layer_names.clone(),
                    light_from_world: manifest::from_rows(&matrices.light_from_world),
                    clip_from_light: matrices.clip_from_light.iter().map(manifest::from_rows).collect(),
                    quantity: matrices.quantity,
                })
            }
            _ => None,
        };
        let decided_by = entry.decided_by(technique);
        Ok(CapturedLight {
            position,
            of_casters: entry.of_casters.iter().map(|(name, position)| (name.clone(), (*position).into())).collect(),
            decided_by,
            count_of: entry.count_of,
            shadow,
            count,
            visibility,
            map,
            truth: self.truth(entry)?,
        })
    }
}

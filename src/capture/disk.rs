//! A capture as a folder: `manifest.json`, NumPy arrays and PNG pictures.
//!
//! The folder is written beside its place and renamed into it, so it is there whole or not at
//! all; a folder that it replaces is moved aside until then.

use super::manifest::{self, LightEntry, Manifest, Matrices, PassEntry, RegionEntry, StateFiles};
use super::{
    Aspect, Capture, CapturedLight, CapturedMap, CapturedTruth, DrawSummary, FrameSnapshot, FrameTarget, Image,
    PixelFormat, Snapshot, Step, files,
};
use crate::accuracy::Finding;
use crate::math::depth::DepthMapping;
use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

mod draws;

const MANIFEST: &str = "manifest.json";
const PLAN: &str = "plan.txt";

/// Why a capture folder can't be written or read.
#[derive(Debug, thiserror::Error)]
pub enum CaptureError {
    /// The folder is there already.
    #[error("{}: there is a capture already; replace it with --overwrite or choose another folder", folder.display())]
    Exists {
        /// Which folder.
        folder: PathBuf,
    },
    /// What is there is no capture folder, so it is never replaced.
    #[error("{}: it is there already and is no capture folder; choose another name", folder.display())]
    InTheWay {
        /// Which file or folder.
        folder: PathBuf,
    },
    /// The folder can't be made, filled or put in its place.
    #[error("{}: can't be written ({source}); choose a folder that you may write to, with room in it", file.display())]
    Write {
        /// Which file or folder.
        file: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file is missing or broken.
    #[error("{}: {reason}; capture the scene again", file.display())]
    Read {
        /// Which file.
        file: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}

/// Is there a capture folder at this path?
#[must_use]
pub fn is_capture(folder: &Path) -> bool {
    folder.join(MANIFEST).is_file()
}

/// Checks that [`write()`] may put a capture at this path, before any work is done for it.
///
/// # Errors
/// Something is there that may not be replaced.
pub fn check_target(folder: &Path, overwrite: bool) -> Result<(), CaptureError> {
    let is_empty_folder = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
    let folder = folder.to_owned();
    if folder.file_name().is_none() {
        // `.`, `..` or `/`: they have no name to be replaced by.
        Err(CaptureError::InTheWay { folder })
    } else if !folder.exists() || is_empty_folder {
        Ok(())
    } else if !is_capture(&folder) {
        Err(CaptureError::InTheWay { folder })
    } else if overwrite {
        Ok(())
    } else {
        Err(CaptureError::Exists { folder })
    }
}

/// Writes `capture` to `folder`, whole or not at all, and returns how many milliseconds its
/// pictures took (also in the manifest).
///
/// # Errors
/// A folder that is there already and may not be replaced, or a place that can't be written to.
pub fn write(capture: &Capture, folder: &Path, overwrite: bool) -> Result<f64, CaptureError> {
    check_target(folder, overwrite)?;
    // A link to a folder stays a link: what it points to is replaced.
    let folder = &fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
    let [new, old] = ["new", "old"].map(|which| beside(folder, which));
    let made: Vec<&Path> = new.ancestors().take_while(|ancestor| !ancestor.exists()).collect();
    let result = write_files(capture, &new).and_then(|write_ms| {
        put_in_place(folder, &new, &old)?;
        Ok(write_ms)
    });
    result.map_err(|error| {
        // What could not be finished is not left behind, nor are the folders made for it; what
        // failed is the error already.
        let _ = fs::remove_dir_all(&new);
        for ancestor in made {
            let _ = fs::remove_dir(ancestor);
        }
        match error {
            // Named as asked for: the hidden name would only puzzle.
            CaptureError::Write { source, .. } => CaptureError::Write { file: folder.to_owned(), source },
            other => other,
        }
    })
}

/// A hidden name in the same folder, so that renaming stays on one file system.
fn beside(folder: &Path, which: &str) -> PathBuf {
    let name = folder.file_name().map_or("capture".into(), |name| name.to_string_lossy());
    folder.with_file_name(format!(".{name}.{which}-{}", std::process::id()))
}

fn put_in_place(folder: &Path, new: &Path, old: &Path) -> Result<(), CaptureError> {
    let failed = |source| CaptureError::Write { file: folder.to_owned(), source };
    let replaces = folder.exists();
    if replaces {
        fs::rename(folder, old).map_err(failed)?;
    }
    if let Err(source) = fs::rename(new, folder) {
        if replaces {
            // Back to how it was; if even that fails, the old one is still beside its place.
            let _ = fs::rename(old, folder);
        }
        return Err(failed(source));
    }
    if replaces {
        fs::remove_dir_all(old).map_err(|source| CaptureError::Write { file: old.to_owned(), source })?;
    }
    Ok(())
}

fn write_files(capture: &Capture, folder: &Path) -> Result<f64, CaptureError> {
    let start = Instant::now();
    fs::create_dir_all(folder).map_err(|source| CaptureError::Write { file: folder.to_owned(), source })?;
    let mut manifest = Manifest::new(capture);
    let mut written = Written::default();
    for (index, step) in capture.steps.iter().enumerate() {
        let entry = write_step(folder, index, step, capture, &mut written)?;
        manifest.passes.push(entry);
    }
    for (index, light) in capture.lights.iter().enumerate() {
        manifest.lights.push(write_light(folder, index, light)?);
    }
    if !capture.plan_text.is_empty() {
        files::write(&folder.join(PLAN), |out| out.write_all(capture.plan_text.as_bytes()))?;
    }
    let write_ms = start.elapsed().as_secs_f64() * 1e3;
    manifest.timing.write_ms = Some(write_ms);
    files::write(&folder.join(MANIFEST), |out| Ok(serde_json::to_writer_pretty(out, &manifest)?))?;
    Ok(write_ms)
}

fn write_step(
    folder: &Path,
    index: usize,
    step: &Step,
    capture: &Capture,
    written: &mut Written,
) -> Result<PassEntry, CaptureError> {
    let stem = format!("{index:03}-{}", slug(&step.name));
    let files = match &step.snapshot {
        Snapshot::Map { light, face } => map_files(capture, *light, *face),
        Snapshot::Frame(frame) => StateFiles {
            labels: step.light.filter(|_| frame.target == FrameTarget::Labels).map(shadow_file),
            count: step.light.filter(|_| frame.target == FrameTarget::Count).map(count_file),
            ..frame_files(folder, &stem, frame, written)?
        },
    };
    Ok(PassEntry {
        index,
        name: step.name.clone(),
        purpose: step.purpose.clone(),
        light: step.light,
        caster: step.caster().map(ToOwned::to_owned),
        files,
        draws: step.draws.len(),
        triangles: step.triangles(),
        gpu_ms: step.gpu_ms,
        draw_list: step.draws.iter().map(Into::into).collect(),
        // After the pass's own files, which the last draw names again.
        draws_captured: draws::write(folder, &stem, step, capture, written)?,
    })
}

/// The light's map holds what a pass left in it.
fn map_files(capture: &Capture, light: usize, face: usize) -> StateFiles {
    let map = capture.lights.get(light).and_then(|light| light.map.as_ref());
    if map.is_some_and(CapturedMap::holds_colors) {
        StateFiles { textures: Some(textures_file(light)), texture_layer: Some(face), ..StateFiles::default() }
    } else {
        StateFiles { map: Some(map_file(light)), map_face: Some(face), ..StateFiles::default() }
    }
}

/// Writes the picture's aspects, as far as no earlier file has them.
fn frame_files(
    folder: &Path,
    stem: &str,
    frame: &FrameSnapshot,
    written: &mut Written,
) -> Result<StateFiles, CaptureError> {
    let mut unchanged = Vec::new();
    let mut put = |name: &'static str, ending: &str, aspect: &Aspect| {
        if aspect.unchanged {
            unchanged.push(name.to_owned());
        }
        written.put(folder, format!("{stem}.{name}.{ending}"), &aspect.image).map(Some)
    };
    let color = put("color", "png", &frame.color)?;
    let depth = put("depth", "npy", &frame.depth)?;
    let stencil = frame.stencil.as_ref().map_or(Ok(None), |stencil| put("stencil", "npy", stencil))?;
    Ok(StateFiles { color, depth, stencil, unchanged: Some(unchanged), ..StateFiles::default() })
}

/// The pictures that have a file. The capture holds all of them, so each is known by its place in
/// memory.
#[derive(Default)]
struct Written(BTreeMap<*const Image, String>);

impl Written {
    /// Writes a picture to `file` unless it has one; the file that it has.
    fn put(&mut self, folder: &Path, file: String, image: &Arc<Image>) -> Result<String, CaptureError> {
        if let Some(earlier) = self.0.get(&Arc::as_ptr(image)) {
            return Ok(earlier.clone());
        }
        files::write_image(&folder.join(&file), image)?;
        self.0.insert(Arc::as_ptr(image), file.clone());
        Ok(file)
    }
}

fn write_light(folder: &Path, index: usize, light: &CapturedLight) -> Result<LightEntry, CaptureError> {
    let mut entry = LightEntry::new(index, light.position);
    if let Some(shadow) = &light.shadow {
        entry.shadow = Some(shadow_file(index));
        files::write_image(&folder.join(shadow_file(index)), shadow)?;
    }
    if let Some(count) = &light.count {
        entry.count = Some(count_file(index));
        entry.wrapped_pixels = light.wrapped_pixels();
        files::write_image(&folder.join(count_file(index)), count)?;
    }
    if let Some(truth) = &light.truth {
        entry.truth = Some(format!("light{index}.truth.npy"));
        entry.error_picture = Some(format!("light{index}.error.npy"));
        for (file, image) in [(&entry.truth, &truth.labels), (&entry.error_picture, &truth.findings)] {
            file.iter().try_for_each(|file| files::write_image(&folder.join(file), image))?;
        }
        entry.error = Some(truth.error);
        entry.findings = Finding::ALL.iter().map(|finding| finding.name().to_owned()).collect();
        entry.worst_region = truth.worst.as_ref().map(Into::into);
    }
    if let Some(map) = &light.map {
        let file = if map.holds_colors() { textures_file(index) } else { map_file(index) };
        files::write_layers(&folder.join(&file), &map.faces)?;
        *(if map.holds_colors() { &mut entry.textures } else { &mut entry.map }) = Some(file);
        entry.matrices = Some(Matrices {
            light_from_world: manifest::rows(map.light_from_world),
            clip_from_light: map.clip_from_light.iter().copied().map(manifest::rows).collect(),
        });
    }
    Ok(entry)
}

fn shadow_file(light: usize) -> String {
    format!("light{light}.shadow.npy")
}

fn count_file(light: usize) -> String {
    format!("light{light}.count.npy")
}

fn map_file(light: usize) -> String {
    format!("light{light}.map.npy")
}

fn textures_file(light: usize) -> String {
    format!("light{light}.textures.npy")
}

/// Letters, digits, `+` and `-` of a name; the rest becomes `-`.
fn slug(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '+' || c == '-' { c } else { '-' }).collect()
}

/// Reads a capture folder.
///
/// # Errors
/// A file that is missing, broken or of another size than the manifest says.
pub fn read(folder: &Path) -> Result<Capture, CaptureError> {
    let file = folder.join(MANIFEST);
    let wrong = |reason: String| CaptureError::Read { file: file.clone(), reason };
    let text = fs::read_to_string(&file).map_err(|error| wrong(error.to_string()))?;
    let manifest: Manifest = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    if manifest.schema != manifest::SCHEMA {
        return Err(wrong(format!("its schema is {}, not {}", manifest.schema, manifest::SCHEMA)));
    }
    if !manifest.size.iter().all(|pixels| (1..=files::LARGEST).contains(pixels)) {
        return Err(wrong(format!("its picture is {}x{}", manifest.size[0], manifest.size[1])));
    }
    let mut reader = Reader { folder, size: manifest.size, images: BTreeMap::new() };
    let lights = manifest.lights.iter().map(|light| reader.light(light)).collect::<Result<Vec<_>, _>>()?;
    let steps = manifest.passes.iter().map(|pass| reader.step(pass, &lights)).collect::<Result<_, _>>()?;
    let capture = Capture {
        scene: manifest.scene,
        technique: manifest.technique,
        settings: manifest.settings,
        size: manifest.size,
        adapter: manifest.adapter,
        camera: (&manifest.camera).into(),
        depth: manifest.depth.unwrap_or_else(|| DepthMapping::ReversedInfinite.curve(manifest.camera.near, 0.0, 0.0)),
        steps,
        lights,
        left_out: manifest.left_out,
        timing: manifest.timing,
        plan_text: read_plan(folder)?,
    };
    match inconsistency(&capture) {
        Some(reason) => Err(wrong(reason.to_owned())),
        None => Ok(capture),
    }
}

/// The plan's text, where there is one.
fn read_plan(folder: &Path) -> Result<String, CaptureError> {
    let file = folder.join(PLAN);
    match fs::read_to_string(&file) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(String::new()),
        Err(error) => Err(CaptureError::Read { file, reason: error.to_string() }),
        Ok(text) => Ok(text),
    }
}

/// What a manifest may say that no frame leaves behind.
fn inconsistency(capture: &Capture) -> Option<&'static str> {
    let light = |index: usize| capture.lights.get(index);
    let is_consistent = |step: &Step| match &step.snapshot {
        Snapshot::Map { light: index, face } => {
            light(*index).and_then(|light| light.map.as_ref()).is_some_and(|map| *face < map.faces.len())
        }
        Snapshot::Frame(frame) => {
            let own = step.light.and_then(light);
            let is_there = match frame.target {
                FrameTarget::Picture => true,
                FrameTarget::Labels => own.is_some_and(|light| light.shadow.is_some()),
                FrameTarget::Count => own.is_some_and(|light| light.count.is_some()),
            };
            step.light.is_none_or(|index| light(index).is_some()) && is_there
        }
    };
    if capture.steps.is_empty() {
        Some("it has no passes")
    } else if !capture.steps.iter().all(is_consistent) {
        Some("a pass names a light, map or face that is not there")
    } else if !(capture.depth.offset.is_finite() && capture.depth.scale.is_finite()) {
        Some("its depth can't be read back")
    } else if capture.camera.check().is_err() {
        Some("its camera can't see")
    } else {
        None
    }
}

/// Reads each file once: what the manifest names twice is shared again.
struct Reader<'a> {
    folder: &'a Path,
    size: [u32; 2],
    images: BTreeMap<String, Arc<Image>>,
}

impl Reader<'_> {
    fn wrong(&self, file: &str, reason: &str) -> CaptureError {
        CaptureError::Read { file: self.folder.join(file), reason: reason.to_owned() }
    }

    fn image(&mut self, file: &str, format: PixelFormat) -> Result<Arc<Image>, CaptureError> {
        self.image_of_size(file, format, self.size)
    }

    fn image_of_size(&mut self, file: &str, format: PixelFormat, size: [u32; 2]) -> Result<Arc<Image>, CaptureError> {
        if let Some(image) = self.images.get(file) {
            let is_same_kind = image.format() == format && image.size() == size;
            return is_same_kind
                .then(|| image.clone())
                .ok_or_else(|| self.wrong(file, "it is named as two kinds of picture"));
        }
        let image = files::read_image(&self.path(file)?, format)?;
        if image.size() != size {
            return Err(self.wrong(file, "its size is not the manifest's"));
        }
        let image = Arc::new(image);
        self.images.insert(file.to_owned(), image.clone());
        Ok(image)
    }

    /// Only plain names: a manifest can't point out of its folder.
    fn path(&self, file: &str) -> Result<PathBuf, CaptureError> {
        if file.contains(['/', '\\']) || file.starts_with('.') {
            return Err(self.wrong(MANIFEST, "it names a file outside its folder"));
        }
        Ok(self.folder.join(file))
    }

    fn step(&mut self, pass: &PassEntry, lights: &[CapturedLight]) -> Result<Step, CaptureError> {
        let draws = pass.draw_list.iter().map(|draw| {
            draw.to_summary().ok_or_else(|| self.wrong(MANIFEST, "it names a part of a draw that is not known"))
        });
        let mut draws = draws.collect::<Result<Vec<DrawSummary>, _>>()?;
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

    fn frame(&mut self, files: &StateFiles) -> Result<FrameSnapshot, CaptureError> {
        let unchanged = files.unchanged.clone().unwrap_or_default();
        let mut aspect = |name: &str, file: &Option<String>, format| {
            let file =
                file.as_ref().ok_or_else(|| self.wrong(MANIFEST, &format!("a pass or draw lacks its {name}")))?;
            let unchanged = unchanged.iter().any(|aspect| aspect == name);
            Ok(Aspect { image: self.image(file, format)?, unchanged })
        };
        let color = aspect("color", &files.color, PixelFormat::Rgba8Srgb)?;
        let depth = aspect("depth", &files.depth, PixelFormat::Depth32F)?;
        let has_stencil = files.stencil.is_some();
        let stencil = has_stencil.then(|| aspect("stencil", &files.stencil, PixelFormat::U8)).transpose()?;
        let target = match (&files.labels, &files.count) {
            (Some(_), _) => FrameTarget::Labels,
            (None, Some(_)) => FrameTarget::Count,
            (None, None) => FrameTarget::Picture,
        };
        Ok(FrameSnapshot { color, depth, stencil, target })
    }

    fn truth(&mut self, entry: &LightEntry) -> Result<Option<CapturedTruth>, CaptureError> {
        let (Some(labels), Some(findings), Some(error)) = (&entry.truth, &entry.error_picture, entry.error) else {
            return Ok(None);
        };
        let is_known = |region: &RegionEntry| {
            let [left, top, right, bottom] = region.bounds;
            let is_inside = left <= right && right < self.size[0] && top <= bottom && bottom < self.size[1];
            region.to_region().filter(|_| is_inside && region.at[0] <= right && region.at[1] <= bottom)
        };
        let worst = match &entry.worst_region {
            None => None,
            Some(region) => {
                let wrong = || self.wrong(MANIFEST, "its worst region is outside the picture or of no known kind");
                Some(is_known(region).ok_or_else(wrong)?)
            }
        };
        Ok(Some(CapturedTruth {
            labels: self.image(labels, PixelFormat::U8)?,
            findings: self.image(findings, PixelFormat::U8)?,
            error,
            worst,
        }))
    }

    fn light(&mut self, entry: &LightEntry) -> Result<CapturedLight, CaptureError> {
        let position = entry.homogeneous().ok_or_else(|| self.wrong(MANIFEST, "a light has no place"))?;
        let shadow = entry.shadow.as_ref().map(|file| self.image(file, PixelFormat::U8)).transpose()?;
        let count = entry.count.as_ref().map(|file| self.image(file, PixelFormat::Count32F)).transpose()?;
        let map = match (entry.map.as_ref().or(entry.textures.as_ref()), &entry.matrices) {
            (Some(file), Some(matrices)) => {
                let faces = files::read_layers(&self.path(file)?)?;
                if faces.len() != matrices.clip_from_light.len() {
                    return Err(self.wrong(file, "it has another number of faces than the manifest"));
                }
                Some(CapturedMap {
                    faces: faces.into_iter().map(Arc::new).collect(),
                    light_from_world: manifest::from_rows(&matrices.light_from_world),
                    clip_from_light: matrices.clip_from_light.iter().map(manifest::from_rows).collect(),
                })
            }
            _ => None,
        };
        Ok(CapturedLight { position, shadow, count, map, truth: self.truth(entry)? })
    }
}

#[cfg(test)]
mod tests;

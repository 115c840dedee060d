//! A capture as a folder: `manifest.json`, NumPy arrays and PNG pictures.
//!
//! The folder is written beside its place and renamed into it, so it is there whole or not at all; a folder that it
//! replaces is moved aside until then. The same files can be in memory instead, as a page has them: then colours are
//! arrays too.

use super::manifest::{self, LightEntry, Manifest, MatricesEntry, PassEntry, StateFiles};
use super::store::CaptureFiles;
use super::{
    Aspect, Capture, CapturedLight, CapturedMap, FrameSnapshot, FrameTarget, Image, Snapshot, Step, files, npy,
};
use crate::accuracy::Finding;
use crate::files::{is_file, write_filled};
use crate::plan::FramePlan;
use crate::scene::{self, Scene, TechniqueRequest};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
#[cfg(not(feature = "gpu"))]
use std::time::Instant;
#[cfg(feature = "gpu")]
use web_time::Instant;

mod draws;
mod frame;
mod reader;

pub use super::error::CaptureError;
pub use super::store::MemoryFiles;
pub use reader::{read, read_memory, read_whole};

const MANIFEST: &str = "manifest.json";
/// Name of the file with the frame as text.
pub const PLAN: &str = "plan.txt";
const SCENE: &str = "scene.toml";

/// What is written to a capture folder: a capture and, where given, the plan and the scene, without which the frame
/// can't be run or examined again.
#[derive(Debug, Clone, Copy)]
pub struct FolderContents<'a> {
    /// The captured attachments.
    pub capture: &'a Capture,
    /// The frame's plan, by which it can be run and examined again.
    pub plan: Option<&'a FramePlan>,
    /// The scene that the frame shows, in the state that was captured.
    pub scene: Option<&'a Scene>,
}

impl<'a> From<&'a Capture> for FolderContents<'a> {
    fn from(capture: &'a Capture) -> FolderContents<'a> {
        FolderContents { capture, plan: None, scene: None }
    }
}

/// Everything that a capture folder stores.
#[derive(Debug, Clone)]
pub struct WholeFrame {
    /// The captured attachments.
    pub capture: Capture,
    /// The frame's plan; `None` in folders of schema 1.
    pub plan: Option<FramePlan>,
    /// The scene that the frame shows; `None` in folders of schema 1, and of frames that another program drew.
    pub scene: Option<Scene>,
}

/// Returns whether a capture folder is at this path: one with a file `manifest.json`, whose content is not checked.
pub fn is_capture(folder: &Path) -> bool {
    is_file(&folder.join(MANIFEST))
}

/// Returns the path of the scene's file in a capture folder, whether or not it is there.
pub fn scene_file(folder: &Path) -> PathBuf {
    folder.join(SCENE)
}

/// Checks, before any work is done, that [`write()`] may write a capture to this path: nothing or an empty folder is
/// there, or a capture folder and `overwrite` is true. Other files and folders are never replaced. Whether the disk can
/// be written to is not checked.
pub fn check_target(folder: &Path, overwrite: bool) -> Result<(), CaptureError> {
    let is_empty_folder = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
    let folder = folder.to_owned();
    if folder.file_name().is_none() {
        // `.`, `..` or `/`: they have no name that a new folder could be renamed to.
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

/// Writes a capture, with its frame and scene where they are given, to `folder`, whole or not at all, and returns how
/// many milliseconds its pictures took (also in the manifest).
pub fn write<'a>(contents: impl Into<FolderContents<'a>>, folder: &Path, overwrite: bool) -> Result<f64, CaptureError> {
    check_target(folder, overwrite)?;
    let contents = contents.into();
    write_folder(folder, |new| {
        let start = Instant::now();
        // Of a large model, its arrays take seconds to write, and so does its scene.
        let (manifest, scene) = rayon::join(
            || write_files(contents, &CaptureFiles::of_folder(new)),
            || contents.scene.map_or(Ok(()), |scene| write_scene(scene, contents.capture, new)),
        );
        let mut manifest = manifest?;
        scene?;
        let write_ms = start.elapsed().as_secs_f64() * 1e3;
        manifest.timing.write_ms = Some(write_ms);
        write_manifest(&manifest, &CaptureFiles::of_folder(new))?;
        Ok(write_ms)
    })
}

/// Hands on the files of a capture folder one by one, each with its name, without those of the scene. Colours are arrays
/// of bytes and not PNG, and their names end like those of arrays.
pub fn write_each<'a>(
    contents: impl Into<FolderContents<'a>>,
    take: &mut dyn FnMut(String, Vec<u8>),
) -> Result<(), CaptureError> {
    let files = CaptureFiles::Stream(RefCell::new(take));
    write_manifest(&write_files(contents.into(), &files)?, &files)
}

/// The parts of a NumPy file of a capture folder.
#[derive(Debug, Clone, PartialEq)]
pub struct ArrayFile<'a> {
    /// The file before its first number.
    pub header: &'a [u8],
    /// The type of its numbers: `|u1`, `<u4` or `<f4`.
    pub kind: String,
    /// The length of each dimension, the slowest first.
    pub shape: Vec<u64>,
    /// The numbers, little-endian.
    pub numbers: &'a [u8],
}

/// Returns the parts of a NumPy file; `None` for bytes that are none.
pub fn array_file(bytes: &[u8]) -> Option<ArrayFile<'_>> {
    let array = npy::Array::open(bytes).ok()?;
    let (kind, shape) = (array.kind().to_owned(), array.shape().to_vec());
    let numbers = array.into_numbers();
    Some(ArrayFile { header: &bytes[..bytes.len() - numbers.len()], kind, shape, numbers })
}

/// Writes the raw values of one picture, or of all faces of a map as one array with one more dimension, to a NumPy
/// file, whole or not at all. Colours are written as numbers too, not as PNG. Without any picture it fails.
pub fn write_arrays(file: &Path, images: &[Arc<Image>]) -> Result<(), CaptureError> {
    let written = write_filled(file, |out| match images {
        [image] => files::write_array(out, image),
        images => files::write_layers(out, images),
    });
    written.map_err(|source| CaptureError::Write { file: file.to_owned(), source })
}

/// Writes a folder whole or not at all: folders in memory are where files are.
#[cfg(target_family = "wasm")]
pub fn write_folder<T>(folder: &Path, fill: impl FnOnce(&Path) -> Result<T, CaptureError>) -> Result<T, CaptureError> {
    fill(folder).inspect_err(|_| crate::files::discard(folder))
}

/// Writes a folder whole or not at all: `fill` fills it beside its place, to which it is then renamed. A
/// folder that it replaces is moved aside until then; the caller decides whether it may be replaced.
#[cfg(not(target_family = "wasm"))]
pub fn write_folder<T>(folder: &Path, fill: impl FnOnce(&Path) -> Result<T, CaptureError>) -> Result<T, CaptureError> {
    // A link to a folder stays a link: what it points to is replaced.
    let folder = &fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
    let [new, old] = ["new", "old"].map(|which| beside(folder, which));
    let made: Vec<&Path> = new.ancestors().take_while(|ancestor| !ancestor.exists()).collect();
    let created = fs::create_dir_all(&new).map_err(|source| CaptureError::Write { file: new.clone(), source });
    let result = created.and_then(|()| fill(&new)).and_then(|filled| {
        swap_in(folder, &new, &old)?;
        Ok(filled)
    });
    result.map_err(|error| {
        // An unfinished folder is not left behind, nor are its new parents; the first failure is the error that is
        // returned.
        let _ = fs::remove_dir_all(&new);
        for ancestor in made {
            let _ = fs::remove_dir(ancestor);
        }
        match error {
            // The error names the path that was asked for: the hidden name would only puzzle.
            CaptureError::Write { source, .. } => CaptureError::Write { file: folder.to_owned(), source },
            other => other,
        }
    })
}

/// Returns the path `.NAME.WHICH-PID` beside a folder, so that renaming stays on one file system; NAME is `capture` for
/// a path without a name.
#[cfg(not(target_family = "wasm"))]
fn beside(folder: &Path, which: &str) -> PathBuf {
    let name = folder.file_name().map_or("capture".into(), |name| name.to_string_lossy());
    folder.with_file_name(format!(".{name}.{which}-{}", std::process::id()))
}

#[cfg(not(target_family = "wasm"))]
fn swap_in(folder: &Path, new: &Path, old: &Path) -> Result<(), CaptureError> {
    let failed = |source| CaptureError::Write { file: folder.to_owned(), source };
    let replaces = folder.exists();
    if replaces {
        fs::rename(folder, old).map_err(failed)?;
    }
    if let Err(source) = fs::rename(new, folder) {
        if replaces {
            // Restore the old folder; if even that fails, it is still beside its place.
            let _ = fs::rename(old, folder);
        }
        return Err(failed(source));
    }
    if replaces {
        fs::remove_dir_all(old).map_err(|source| CaptureError::Write { file: old.to_owned(), source })?;
    }
    Ok(())
}

/// Returns whether a name has no path and is not hidden: the files that a folder names lie in it.
fn is_plain(file: &str) -> bool {
    !file.contains(['/', '\\']) && !file.starts_with('.')
}

/// Writes all files but the scene's and the manifest, which is returned.
fn write_files(contents: FolderContents, folder: &CaptureFiles) -> Result<Manifest, CaptureError> {
    let FolderContents { capture, plan, .. } = contents;
    let mut manifest = Manifest::new(capture);
    let mut written = WrittenImages::default();
    for (index, step) in capture.steps.iter().enumerate() {
        let entry = write_step(folder, index, step, capture, &mut written)?;
        manifest.passes.push(entry);
    }
    for (index, light) in capture.lights.iter().enumerate() {
        manifest.lights.push(write_light(folder, index, light)?);
    }
    if !capture.plan_text.is_empty() {
        folder.write(PLAN, |out| out.write_all(capture.plan_text.as_bytes()))?;
    }
    if let Some(plan) = plan {
        frame::write(plan, folder)?;
    }
    Ok(manifest)
}

fn write_manifest(manifest: &Manifest, folder: &CaptureFiles) -> Result<(), CaptureError> {
    folder.write(MANIFEST, |out| Ok(serde_json::to_writer_pretty(out, manifest)?))
}

/// Writes the scene of a capture to its folder, with the technique that drew it where that is one of ours.
fn write_scene(scene: &Scene, capture: &Capture, folder: &Path) -> Result<(), CaptureError> {
    let technique = TechniqueRequest { name: capture.technique.clone(), settings: capture.settings.clone() };
    let technique = Some(technique).filter(|_| capture.origin.is_none());
    Ok(scene::file::store(&Scene { technique, ..scene.clone() }, None, &folder.join(SCENE))?)
}

fn write_step(
    folder: &CaptureFiles,
    index: usize,
    step: &Step,
    capture: &Capture,
    written: &mut WrittenImages,
) -> Result<PassEntry, CaptureError> {
    let stem = format!("{index:03}-{}", slug(&step.name));
    let files = match &step.snapshot {
        Snapshot::Map { light, face } => map_files(capture, *light, *face),
        Snapshot::Frame(frame) => {
            let files = frame_files(folder, &stem, frame, written)?;
            match step.light.and_then(|light| target_file(light, frame.target)) {
                Some(file) => files.with_target(frame.target, file),
                None => files,
            }
        }
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
        draw_list: step.draws.clone(),
        // After the pass's own files, since the last draw names them again.
        draws_captured: draws::write(folder, &stem, step, capture, written)?,
    })
}

/// Returns the file and face that a pass of a light's map refers to: the light's textures where the map holds colours,
/// else its depths. Writes nothing.
fn map_files(capture: &Capture, light: usize, face: usize) -> StateFiles {
    let map = capture.lights.get(light).and_then(|light| light.map.as_ref());
    if map.is_some_and(CapturedMap::holds_colors) {
        StateFiles { textures: Some(textures_file(light)), texture_layer: Some(face), ..StateFiles::default() }
    } else {
        StateFiles { map: Some(map_file(light)), map_face: Some(face), ..StateFiles::default() }
    }
}

/// Writes colour (PNG on disk), depth and stencil (NumPy) of a step, and returns their names. Pictures that `written` has
/// already are not written again: their earlier file is named. Aspects that the step did not change are listed in
/// `unchanged`.
fn frame_files(
    folder: &CaptureFiles,
    stem: &str,
    frame: &FrameSnapshot,
    written: &mut WrittenImages,
) -> Result<StateFiles, CaptureError> {
    let mut unchanged = Vec::new();
    let mut write = |name: &'static str, ending: &str, aspect: &Aspect| {
        if aspect.unchanged {
            unchanged.push(name.to_owned());
        }
        written.write(folder, format!("{stem}.{name}.{ending}"), &aspect.image).map(Some)
    };
    let color = write("color", folder.picture_ending(), &frame.color)?;
    let depth = write("depth", "npy", &frame.depth)?;
    let stencil = frame.stencil.as_ref().map_or(Ok(None), |stencil| write("stencil", "npy", stencil))?;
    Ok(StateFiles { color, depth, stencil, unchanged: Some(unchanged), ..StateFiles::default() })
}

/// The pictures that have a file already. The capture owns all of them, so each is known by its address.
#[derive(Default)]
struct WrittenImages(BTreeMap<*const Image, String>);

impl WrittenImages {
    /// Writes a picture to `file` in `folder` and returns that name. If the same picture (the same `Arc`, not an equal
    /// one) was written before, writes nothing and returns its earlier name.
    fn write(&mut self, folder: &CaptureFiles, file: String, image: &Arc<Image>) -> Result<String, CaptureError> {
        if let Some(earlier) = self.0.get(&Arc::as_ptr(image)) {
            return Ok(earlier.clone());
        }
        files::write_image(folder, &file, image)?;
        self.0.insert(Arc::as_ptr(image), file.clone());
        Ok(file)
    }
}

fn write_light(folder: &CaptureFiles, index: usize, light: &CapturedLight) -> Result<LightEntry, CaptureError> {
    let mut entry = LightEntry {
        of_casters: light.of_casters.iter().map(|(name, position)| (name.clone(), position.to_array())).collect(),
        decided_by: Some(light.decided_by),
        count_of: light.count_of,
        ..LightEntry::new(index, light.position)
    };
    let write = |target: FrameTarget| {
        let Some((file, image)) = target_file(index, target).zip(light.target(target)) else { return Ok(None) };
        files::write_image(folder, &file, image)?;
        Ok::<_, CaptureError>(Some(file))
    };
    entry.shadow = write(FrameTarget::Labels)?;
    entry.count = write(FrameTarget::Count)?;
    entry.visibility = write(FrameTarget::Visibility)?;
    entry.wrapped_pixels = light.wrapped_pixels();
    if let Some(truth) = &light.truth {
        entry.truth = Some(format!("light{index}.truth.npy"));
        entry.error_picture = Some(format!("light{index}.error.npy"));
        for (file, image) in [(&entry.truth, &truth.labels), (&entry.error_picture, &truth.findings)] {
            file.iter().try_for_each(|file| files::write_image(folder, file, image))?;
        }
        entry.error = Some(truth.error);
        entry.findings = Finding::ALL.iter().map(|finding| finding.name().to_owned()).collect();
        entry.worst_region = truth.worst;
        if let Some(visibility) = &truth.visibility {
            let file = format!("light{index}.truth-visibility.npy");
            files::write_image(folder, &file, &visibility.image)?;
            entry.truth_visibility = Some(file);
            entry.visibility_error = Some(visibility.error);
        }
    }
    if let Some(map) = &light.map {
        let file = if map.holds_colors() { textures_file(index) } else { map_file(index) };
        folder.write(&file, |out| files::write_layers(out, &map.faces))?;
        *(if map.holds_colors() { &mut entry.textures } else { &mut entry.map }) = Some(file);
        entry.layer_names.clone_from(&map.layer_names);
        entry.matrices = Some(MatricesEntry {
            light_from_world: manifest::rows(map.light_from_world),
            clip_from_light: map.clip_from_light.iter().copied().map(manifest::rows).collect(),
            quantity: map.quantity,
        });
    }
    Ok(entry)
}

/// Returns the name of the file of a light's target; `None` for the picture.
fn target_file(light: usize, target: FrameTarget) -> Option<String> {
    let what = match target {
        FrameTarget::Picture => return None,
        // A contract since before the target had a name.
        FrameTarget::Labels => "shadow",
        FrameTarget::Count | FrameTarget::Visibility => target.name(),
    };
    Some(format!("light{light}.{what}.npy"))
}

fn map_file(light: usize) -> String {
    format!("light{light}.map.npy")
}

fn textures_file(light: usize) -> String {
    format!("light{light}.textures.npy")
}

/// Returns the letters, digits, `+` and `-` of a name, and `-` for each other character.
fn slug(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '+' || c == '-' { c } else { '-' }).collect()
}

#[cfg(test)]
mod tests;

//! The states after draws in a folder: `draws_captured` of a pass, with the same keys as a pass.
//!
//! A draw's files are named after its pass: `002-volumes.draw003.stencil.npy`. The files of passes and lights are those
//! of a capture without draws; a draw that left the same content names those files. A face of a map after a draw has a
//! file of its own, unless it is the map's last state.

use super::super::manifest::{DrawStateEntry, StateFiles};
use super::super::store::CaptureFiles;
use super::super::{Aspect, Capture, CapturedLight, DrawState, DrawSummary, PixelFormat, Snapshot, Step};
use super::reader::FolderReader;
use super::{CaptureError, MANIFEST, WrittenImages, frame_files, map_files, target_file};
use std::sync::Arc;

const MAP: &str = "map";
const TEXTURES: &str = "textures";

/// Writes the states after each draw of a step and returns their entries, in order. `None`, and nothing is written,
/// where the step has no draws or a draw's state was not captured.
pub(super) fn write(
    folder: &CaptureFiles,
    stem: &str,
    step: &Step,
    capture: &Capture,
    written: &mut WrittenImages,
) -> Result<Option<Vec<DrawStateEntry>>, CaptureError> {
    let states: Option<Vec<&DrawState>> = step.draws.iter().map(|draw| draw.after.as_ref()).collect();
    // For a step without draws it is not known whether they were asked for.
    let Some(states) = states.filter(|states| !states.is_empty()) else { return Ok(None) };
    let mut entries = Vec::with_capacity(states.len());
    for (index, (draw, state)) in step.draws.iter().zip(states).enumerate() {
        entries.push(DrawStateEntry {
            name: draw.name.clone(),
            caster: draw.caster.clone(),
            part: draw.part,
            files: state_files(folder, &format!("{stem}.draw{index:03}"), step, state, capture, written)?,
        });
    }
    Ok(Some(entries))
}

fn state_files(
    folder: &CaptureFiles,
    stem: &str,
    step: &Step,
    state: &DrawState,
    capture: &Capture,
    written: &mut WrittenImages,
) -> Result<StateFiles, CaptureError> {
    let mut files = match &state.snapshot {
        Snapshot::Frame(frame) => frame_files(folder, stem, frame, written)?,
        Snapshot::Map { .. } => StateFiles::default(),
    };
    let Some(target) = &state.target else { return Ok(files) };
    let unchanged = |files: &mut StateFiles, name: &str| {
        let listed = files.unchanged.get_or_insert_default();
        listed.extend(target.unchanged.then(|| name.to_owned()));
    };
    let mut write = |name: &str, earlier: Option<String>| match earlier {
        Some(file) => Ok(file),
        None => written.write(folder, format!("{stem}.{name}.npy"), &target.image),
    };
    match &state.snapshot {
        Snapshot::Frame(frame) => {
            let light = step.light.and_then(|index| Some((index, capture.lights.get(index)?)));
            let is_last = |(_, light): &(usize, &CapturedLight)| {
                light.target(frame.target).is_some_and(|image| Arc::ptr_eq(image, &target.image))
            };
            let final_file = light.filter(is_last).and_then(|(index, _)| target_file(index, frame.target));
            files = files.with_target(frame.target, write(frame.target.name(), final_file)?);
            unchanged(&mut files, frame.target.name());
        }
        Snapshot::Map { light, face } => {
            let map = capture.lights.get(*light).and_then(|light| light.map.as_ref());
            let is_last = map.and_then(|map| map.faces.get(*face)).is_some_and(|face| Arc::ptr_eq(face, &target.image));
            let holds_colors = target.image.format() == PixelFormat::Rgba8;
            if is_last {
                files = map_files(capture, *light, *face);
            } else if holds_colors {
                files.textures = Some(write(TEXTURES, None)?);
            } else {
                files.map = Some(write(MAP, None)?);
            }
            unchanged(&mut files, if holds_colors { TEXTURES } else { MAP });
        }
    }
    Ok(files)
}

impl FolderReader<'_, '_> {
    /// Reads the states after the draws of a step and sets `after` of each of `draws`; `snapshot` is the state after
    /// the whole step. Fails where entries and draws differ in number.
    pub(super) fn draw_states(
        &mut self,
        entries: &[DrawStateEntry],
        snapshot: &Snapshot,
        lights: &[CapturedLight],
        draws: &mut [DrawSummary],
    ) -> Result<(), CaptureError> {
        if entries.len() != draws.len() {
            return Err(self.wrong(MANIFEST, "it has the states of more or fewer draws than a pass has"));
        }
        for (draw, entry) in draws.iter_mut().zip(entries) {
            draw.after = Some(self.draw_state(&entry.files, snapshot, lights)?);
        }
        Ok(())
    }

    fn draw_state(
        &mut self,
        files: &StateFiles,
        of_step: &Snapshot,
        lights: &[CapturedLight],
    ) -> Result<DrawState, CaptureError> {
        let (snapshot, target) = match of_step {
            Snapshot::Map { light, face } => (of_step.clone(), Some(self.face(files, *light, *face, lights)?)),
            Snapshot::Frame(step) => {
                let frame = self.frame(files)?;
                if frame.target != step.target || frame.stencil.is_some() != step.stencil.is_some() {
                    return Err(self.wrong(MANIFEST, "a draw left other pictures than its pass"));
                }
                let target = files.of_target(frame.target).map(|file| {
                    Ok::<_, CaptureError>(Aspect {
                        image: self.image(file, frame.target.format())?,
                        unchanged: is_unchanged(files, frame.target.name()),
                    })
                });
                (Snapshot::Frame(frame), target.transpose()?)
            }
        };
        Ok(DrawState { snapshot, target })
    }

    /// Returns a face of a light's map or textures after a draw: the light's own final face where the entry names it by
    /// number, else the content of the entry's file. Fails where `face` is not the named one, or the file's format or
    /// size is not the final face's.
    fn face(
        &mut self,
        files: &StateFiles,
        light: usize,
        face: usize,
        lights: &[CapturedLight],
    ) -> Result<Aspect, CaptureError> {
        let missing = "a draw lacks its map, or names a face that is not its pass's";
        let last = lights.get(light).and_then(|light| light.map.as_ref()?.faces.get(face));
        let last = last.ok_or_else(|| self.wrong(MANIFEST, missing))?;
        let (name, file, format) = match (&files.map, &files.textures) {
            (Some(file), _) => (MAP, file, PixelFormat::Depth32F),
            (None, Some(file)) => (TEXTURES, file, PixelFormat::Rgba8),
            (None, None) => return Err(self.wrong(MANIFEST, missing)),
        };
        let image = match files.map_face.or(files.texture_layer) {
            Some(named) if named == face => last.clone(),
            Some(_) => return Err(self.wrong(MANIFEST, missing)),
            None => self.image_of_size(file, format, last.size())?,
        };
        if image.format() != last.format() {
            return Err(self.wrong(file, "it is another kind of map than its light's"));
        }
        Ok(Aspect { image, unchanged: is_unchanged(files, name) })
    }
}

fn is_unchanged(files: &StateFiles, name: &str) -> bool {
    files.unchanged.iter().flatten().any(|aspect| aspect == name)
}

//! From a capture to a folder.

use super::folder::{Draft, check_target};
use super::{CaptureError, MANIFEST, arrays, pictures};
use crate::capture::manifest::{
    CameraEntry, DrawEntry, LightEntry, LightKind, Manifest, Matrices, PassEntry, Rows, SCHEMA,
};
use crate::capture::{Aspect, Capture, CapturedLight, CapturedMap, FrameSnapshot, Image, Snapshot, Step, Timing};
use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Writes `capture` to `folder`, which appears whole or not at all. The time it takes goes into
/// the manifest, in place of the capture's own [`Timing::write_ms`].
///
/// # Errors
/// `folder` exists, and is no capture folder or `overwrite` is off; the system refuses to write.
pub fn write(capture: &Capture, folder: &Path, overwrite: bool) -> Result<(), CaptureError> {
    check_target(folder, overwrite)?;
    let start = Instant::now();
    let draft = Draft::beside(folder)?;
    let mut manifest = write_images(capture, draft.path())?;
    manifest.timing.write_ms = Some(start.elapsed().as_secs_f64() * 1e3);
    let json = serde_json::to_string_pretty(&manifest).map_err(|error| CaptureError::write(folder, error))?;
    write_text(&draft.path().join(MANIFEST), &(json + "\n"))?;
    draft.put_in_place()
}

/// Everything but the manifest, which is returned.
fn write_images(capture: &Capture, folder: &Path) -> Result<Manifest, CaptureError> {
    let mut passes = PassWriter { folder, color: None, depth: None, stencil: None };
    let entries = capture.steps.iter().enumerate().map(|(index, step)| passes.write(index, step));
    let entries = entries.collect::<Result<Vec<_>, _>>()?;
    let lights = capture.lights.iter().enumerate().map(|(index, light)| write_light(folder, index, light));
    let lights = lights.collect::<Result<Vec<_>, _>>()?;
    let plan = (!capture.plan_text.is_empty()).then(|| "plan.txt".to_owned());
    if let Some(name) = &plan {
        write_text(&folder.join(name), &capture.plan_text)?;
    }
    let camera = &capture.camera;
    Ok(Manifest {
        schema: SCHEMA,
        program: concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION")).to_owned(),
        scene: capture.scene.clone(),
        technique: capture.technique.clone(),
        settings: capture.settings.clone(),
        size: capture.size,
        adapter: capture.adapter.clone(),
        camera: CameraEntry {
            eye: camera.eye.to_array(),
            target: camera.target.to_array(),
            up: camera.up.to_array(),
            fov_y_degrees: camera.fov_y_degrees,
            near: camera.near,
            far: camera.far,
        },
        passes: entries,
        lights,
        left_out: capture.left_out.clone(),
        timing: Timing { write_ms: None, ..capture.timing },
        plan,
    })
}

fn write_text(path: &Path, text: &str) -> Result<(), CaptureError> {
    fs::write(path, text).map_err(|error| CaptureError::write(path, error))
}

/// An aspect that was written, and in which file.
type Written = Option<(Arc<Image>, String)>;

/// Writes passes in order; keeps the last file of each aspect, for passes that leave it unchanged.
struct PassWriter<'a> {
    folder: &'a Path,
    color: Written,
    depth: Written,
    stencil: Written,
}

impl PassWriter<'_> {
    fn write(&mut self, index: usize, step: &Step) -> Result<PassEntry, CaptureError> {
        let mut entry = PassEntry {
            index,
            name: step.name.clone(),
            purpose: step.purpose.clone(),
            light: step.light,
            caster: step.caster().map(str::to_owned),
            color: None,
            depth: None,
            stencil: None,
            labels: None,
            map: None,
            map_face: None,
            unchanged: Vec::new(),
            draws: step.draws.len(),
            triangles: step.triangles(),
            gpu_ms: step.gpu_ms,
            draw_list: draw_list(step),
        };
        match &step.snapshot {
            Snapshot::Map { light, face } => {
                entry.map = Some(map_file(*light));
                entry.map_face = Some(*face);
            }
            Snapshot::Frame(frame) => {
                self.write_frame(&format!("{index:03}-{}", file_part(&step.name)), frame, &mut entry)?
            }
        }
        if let (Snapshot::Frame(FrameSnapshot { writes_labels: true, .. }), Some(light)) = (&step.snapshot, step.light)
        {
            entry.labels = Some(shadow_file(light));
        }
        Ok(entry)
    }

    fn write_frame(&mut self, prefix: &str, frame: &FrameSnapshot, entry: &mut PassEntry) -> Result<(), CaptureError> {
        let folder = self.folder;
        let mut keep = |aspect: &Aspect, name: &str, ending: &str, last: &mut Written| {
            if aspect.unchanged {
                entry.unchanged.push(name.to_owned());
            }
            write_aspect(folder, aspect, format!("{prefix}.{name}.{ending}"), last).map(Some)
        };
        let color = keep(&frame.color, "color", "png", &mut self.color)?;
        let depth = keep(&frame.depth, "depth", "npy", &mut self.depth)?;
        let stencil = match &frame.stencil {
            Some(aspect) => keep(aspect, "stencil", "npy", &mut self.stencil)?,
            None => None,
        };
        (entry.color, entry.depth, entry.stencil) = (color, depth, stencil);
        Ok(())
    }
}

/// The file that holds the aspect: an earlier one where nothing changed since.
fn write_aspect(folder: &Path, aspect: &Aspect, file: String, last: &mut Written) -> Result<String, CaptureError> {
    if let Some((image, earlier)) = last
        && aspect.unchanged
        && (Arc::ptr_eq(image, &aspect.image) || image == &aspect.image)
    {
        return Ok(earlier.clone());
    }
    let path = folder.join(&file);
    if file.ends_with(".png") {
        pictures::write_image(&path, &aspect.image)?;
    } else {
        arrays::write_image(&path, &aspect.image)?;
    }
    *last = Some((Arc::clone(&aspect.image), file.clone()));
    Ok(file)
}

fn write_light(folder: &Path, index: usize, light: &CapturedLight) -> Result<LightEntry, CaptureError> {
    if let Some(image) = &light.shadow {
        arrays::write_image(&folder.join(shadow_file(index)), image)?;
    }
    if let Some(map) = &light.map {
        arrays::write_faces(&folder.join(map_file(index)), &map.faces)?;
    }
    let xyz = light.position.truncate().to_array();
    let is_directional = light.position.w == 0.0;
    Ok(LightEntry {
        index,
        kind: if is_directional { LightKind::Directional } else { LightKind::Point },
        position: (!is_directional).then_some(xyz),
        towards: is_directional.then_some(xyz),
        shadow: light.shadow.as_ref().map(|_| shadow_file(index)),
        map: light.map.as_ref().map(|_| map_file(index)),
        matrices: light.map.as_ref().map(matrices),
    })
}

fn matrices(map: &CapturedMap) -> Matrices {
    let rows = |matrix: &glam::DMat4| -> Rows { matrix.transpose().to_cols_array_2d() };
    Matrices {
        light_from_world: rows(&map.light_from_world),
        clip_from_light: map.clip_from_light.iter().map(rows).collect(),
    }
}

fn draw_list(step: &Step) -> Vec<DrawEntry> {
    let entry = |draw: &crate::capture::DrawSummary| DrawEntry {
        name: draw.name.clone(),
        caster: draw.caster.clone(),
        part: draw.part.name().to_owned(),
        triangles: draw.triangles,
    };
    step.draws.iter().map(entry).collect()
}

fn shadow_file(light: usize) -> String {
    format!("light{light}.shadow.npy")
}

fn map_file(light: usize) -> String {
    format!("light{light}.map.npy")
}

/// A pass's name as a part of a file name.
fn file_part(name: &str) -> String {
    let part: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' }).collect();
    let words: Vec<&str> = part.split('-').filter(|word| !word.is_empty()).collect();
    words.join("-")
}

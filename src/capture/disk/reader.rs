//! From a folder to a capture.

use super::folder::is_capture_folder;
use super::{CaptureError, MANIFEST, arrays, pictures};
use crate::capture::manifest::{LightEntry, Manifest, Matrices, PassEntry, Rows, SCHEMA};
use crate::capture::{
    Aspect, Capture, CapturedLight, CapturedMap, DrawSummary, FrameSnapshot, Image, PixelFormat, Snapshot, Step,
};
use crate::plan::Part;
use crate::scene::Camera;
use glam::{DMat4, DVec3};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Pixels along a side of the largest picture that is read.
const LARGEST: u32 = 1 << 15;

/// Reads a capture folder back. Aspects that point to one file share one image.
///
/// # Errors
/// No manifest in `folder`, a newer schema, a file that is missing or does not hold what the
/// manifest says.
pub fn read(folder: &Path) -> Result<Capture, CaptureError> {
    if !is_capture_folder(folder) {
        return Err(CaptureError::NotACapture(folder.to_owned()));
    }
    let path = folder.join(MANIFEST);
    let text = fs::read_to_string(&path).map_err(|error| CaptureError::broken(&path, error))?;
    let manifest: Manifest = serde_json::from_str(&text).map_err(|error| CaptureError::broken(&path, error))?;
    if manifest.schema != SCHEMA {
        let reason = format!("has schema {}, but this program reads {SCHEMA}", manifest.schema);
        return Err(CaptureError::broken(&path, reason));
    }
    if !manifest.size.iter().all(|n| (1..=LARGEST).contains(n)) {
        return Err(CaptureError::broken(&path, format!("has a picture of {}x{}", manifest.size[0], manifest.size[1])));
    }
    Reader { folder, manifest_path: path, size: manifest.size, images: BTreeMap::new() }.capture(manifest)
}

/// Reads each file once.
struct Reader<'a> {
    folder: &'a Path,
    manifest_path: PathBuf,
    size: [u32; 2],
    images: BTreeMap<String, Arc<Image>>,
}

impl Reader<'_> {
    fn capture(mut self, manifest: Manifest) -> Result<Capture, CaptureError> {
        let steps = manifest.passes.iter().map(|entry| self.step(entry)).collect::<Result<Vec<_>, _>>()?;
        let lights = manifest.lights.iter().map(|entry| self.light(entry)).collect::<Result<Vec<_>, _>>()?;
        let plan_text = match &manifest.plan {
            Some(name) => {
                let path = self.file(name)?;
                fs::read_to_string(&path).map_err(|error| CaptureError::broken(&path, error))?
            }
            None => String::new(),
        };
        let camera = manifest.camera;
        Ok(Capture {
            scene: manifest.scene,
            technique: manifest.technique,
            settings: manifest.settings,
            size: manifest.size,
            adapter: manifest.adapter,
            camera: Camera {
                eye: camera.eye.into(),
                target: camera.target.into(),
                up: camera.up.into(),
                fov_y_degrees: camera.fov_y_degrees,
                near: camera.near,
                far: camera.far,
            },
            steps,
            lights,
            left_out: manifest.left_out,
            timing: manifest.timing,
            plan_text,
        })
    }

    fn step(&mut self, entry: &PassEntry) -> Result<Step, CaptureError> {
        let draws = entry.draw_list.iter().map(|draw| {
            let part =
                Part::from_name(&draw.part).ok_or_else(|| self.wrong(format!("no part is called `{}`", draw.part)))?;
            Ok(DrawSummary { name: draw.name.clone(), caster: draw.caster.clone(), part, triangles: draw.triangles })
        });
        Ok(Step {
            name: entry.name.clone(),
            purpose: entry.purpose.clone(),
            light: entry.light,
            draws: draws.collect::<Result<Vec<_>, _>>()?,
            gpu_ms: entry.gpu_ms,
            snapshot: self.snapshot(entry)?,
        })
    }

    fn snapshot(&mut self, entry: &PassEntry) -> Result<Snapshot, CaptureError> {
        if let (Some(_), Some(face)) = (&entry.map, entry.map_face) {
            let light =
                entry.light.ok_or_else(|| self.wrong(format!("pass {} draws a map of no light", entry.index)))?;
            return Ok(Snapshot::Map { light, face });
        }
        let (Some(color), Some(depth)) = (&entry.color, &entry.depth) else {
            return Err(self.wrong(format!("pass {} has neither color and depth nor a map", entry.index)));
        };
        let unchanged = |name: &str| entry.unchanged.iter().any(|aspect| aspect == name);
        let stencil = match &entry.stencil {
            Some(file) => Some(Aspect { image: self.array(file, PixelFormat::U8)?, unchanged: unchanged("stencil") }),
            None => None,
        };
        Ok(Snapshot::Frame(FrameSnapshot {
            color: Aspect { image: self.picture(color)?, unchanged: unchanged("color") },
            depth: Aspect { image: self.array(depth, PixelFormat::Depth32F)?, unchanged: unchanged("depth") },
            stencil,
            writes_labels: entry.labels.is_some(),
        }))
    }

    fn light(&mut self, entry: &LightEntry) -> Result<CapturedLight, CaptureError> {
        let position = match (entry.position, entry.towards) {
            (Some(position), None) => DVec3::from(position).extend(1.0),
            (None, Some(towards)) => DVec3::from(towards).extend(0.0),
            _ => return Err(self.wrong(format!("light {} needs either position or towards", entry.index))),
        };
        let shadow = match &entry.shadow {
            Some(file) => Some(self.array(file, PixelFormat::U8)?),
            None => None,
        };
        let map = match (&entry.map, &entry.matrices) {
            (Some(file), Some(matrices)) => Some(self.map(file, matrices)?),
            (Some(_), None) => return Err(self.wrong(format!("light {} has a map without matrices", entry.index))),
            (None, _) => None,
        };
        Ok(CapturedLight { position, shadow, map })
    }

    fn map(&self, file: &str, matrices: &Matrices) -> Result<CapturedMap, CaptureError> {
        let matrix = |rows: &Rows| DMat4::from_cols_array_2d(rows).transpose();
        Ok(CapturedMap {
            faces: arrays::read_faces(&self.file(file)?)?,
            light_from_world: matrix(&matrices.light_from_world),
            clip_from_light: matrices.clip_from_light.iter().map(matrix).collect(),
        })
    }

    fn picture(&mut self, file: &str) -> Result<Arc<Image>, CaptureError> {
        let size = self.size;
        self.image(file, |path| pictures::read_image(path, size))
    }

    fn array(&mut self, file: &str, format: PixelFormat) -> Result<Arc<Image>, CaptureError> {
        let size = self.size;
        let image = self.image(file, |path| arrays::read_image(path, format, size))?;
        if image.format() == format {
            Ok(image)
        } else {
            Err(self.wrong(format!("`{file}` is used as two kinds of image")))
        }
    }

    fn image(
        &mut self,
        file: &str,
        load: impl FnOnce(&Path) -> Result<Image, CaptureError>,
    ) -> Result<Arc<Image>, CaptureError> {
        if let Some(image) = self.images.get(file) {
            return Ok(Arc::clone(image));
        }
        let image = Arc::new(load(&self.file(file)?)?);
        self.images.insert(file.to_owned(), Arc::clone(&image));
        Ok(image)
    }

    /// A file of the folder itself: a manifest can't name others.
    fn file(&self, name: &str) -> Result<PathBuf, CaptureError> {
        if name.contains(['/', '\\']) || name.starts_with('.') || name.is_empty() {
            return Err(self.wrong(format!("`{}` is no file of this folder", name.escape_debug())));
        }
        Ok(self.folder.join(name))
    }

    fn wrong(&self, reason: String) -> CaptureError {
        CaptureError::broken(&self.manifest_path, reason)
    }
}

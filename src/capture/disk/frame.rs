//! The frame as data: `frame.json` is the plan, except for meshes and pictures from the CPU, which are arrays beside
//! it.
//!
//! What is read is not trusted: indexes, sizes and lengths are checked before anything runs it.

use super::super::store::CaptureFiles;
use super::super::{files, npy::Element};
use super::{Capture, CaptureError, Image};
use crate::capture::PixelFormat;
use crate::plan::lint::LintError;
use crate::plan::{
    Attachment, AttachmentId, AttachmentRole, Blob, Carry, CpuImage, DrawMesh, Extruded, FramePlan, LightId, MakeImage,
    PlanLight, PlanTexture, StartContent, SurfaceData, SurfaceNormals,
};
use crate::scene::TextureImage;
use foldhash::quality::FixedState;
use serde::{Deserialize, Serialize};
use std::any::Any;
use std::collections::BTreeMap;
use std::hash::BuildHasher;
use std::sync::Arc;

pub(super) const FRAME: &str = "frame.json";

/// The most layers of an attachment that are read.
const MOST_LAYERS: u32 = 2048;

#[derive(Serialize, Deserialize)]
struct FrameEntry<P> {
    plan: P,
    meshes: Vec<MeshEntry>,
    /// Textures on surfaces.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    textures: Vec<TextureEntry>,
    /// Pictures that passes get from the CPU.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    images: Vec<ImageEntry>,
    /// Content of passes' targets before the passes begin.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    starts: Vec<StartEntry>,
}

/// A mesh and the files of its arrays. An array that two meshes share is one file.
#[derive(Serialize, Deserialize)]
struct MeshEntry {
    name: String,
    /// Homogeneous positions: (vertices, 4), `<f4`.
    vertices: String,
    /// Vertex indices: (triangles, 3), `<u4`.
    indices: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    surface: Option<SurfaceEntry>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    extruded: Option<ExtrudedEntry>,
    /// Pixels and triangles of retained fragments: (fragments, 2), `<u4`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    kept: Option<String>,
    /// The triangle of the other mesh that each piece is of: (triangles,), `<u4`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pieces_of: Option<String>,
    /// The triangle of the object's mesh that each is: (triangles,), `<u4`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    source_triangles: Option<String>,
}

/// The input of a vertex shader that computes the vertices.
#[derive(Serialize, Deserialize)]
struct ExtrudedEntry {
    /// For each vertex its position before extrusion, and the plane that decides about it: (vertices, 8), `<f4`.
    corners: String,
    carry: Carry,
}

#[derive(Serialize, Deserialize)]
struct SurfaceEntry {
    /// Normals of each corner of each triangle: (3 · triangles, 4), `<f4`.
    normals: String,
    /// A word for each triangle, `<u4`.
    sides: String,
    /// Texture coordinates of each corner of each triangle: (3 · triangles, 2), `<f4`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    uvs: Option<String>,
}

#[derive(Serialize, Deserialize)]
struct TextureEntry {
    name: String,
    /// PNG file of RGBA with 8 bits a channel.
    file: String,
    clamps: bool,
}

#[derive(Serialize, Deserialize)]
struct ImageEntry {
    pass: usize,
    name: String,
    /// File of the texels as bytes.
    file: String,
}

/// Content of a pass's depth-stencil target before it begins: a value a pixel, row by row.
#[derive(Serialize, Deserialize)]
struct StartEntry {
    pass: usize,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    depth: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    stencil: Option<String>,
}

/// Writes a plan as `frame.json`, and its meshes, textures and pictures as files beside it, to an existing capture
/// folder. Equal arrays share one file.
pub(super) fn write(plan: &FramePlan, folder: &CaptureFiles) -> Result<(), CaptureError> {
    let mut written = BTreeMap::new();
    let mut entry =
        FrameEntry { plan, meshes: Vec::new(), textures: Vec::new(), images: Vec::new(), starts: Vec::new() };
    for (index, mesh) in plan.meshes.iter().enumerate() {
        let mut writer = ArrayWriter { folder, stem: format!("mesh{index:03}"), written: &mut written };
        let DrawMesh { name, vertices, indices, surface, extruded, retained, pieces_of, source_triangles, boxes: _ } =
            mesh;
        entry.meshes.push(MeshEntry {
            name: name.clone(),
            vertices: writer.blob::<f32, _>("vertices", vertices, 4)?,
            indices: writer.blob::<u32, _>("indices", indices, 3)?,
            surface: match surface {
                None => None,
                Some(SurfaceData { normals, sides, uvs }) => Some(SurfaceEntry {
                    normals: writer.normals(normals, mesh)?,
                    sides: writer.blob::<u32, _>("sides", sides, 1)?,
                    uvs: match uvs {
                        None => None,
                        Some(uvs) => Some(writer.blob::<f32, _>("uvs", uvs, 2)?),
                    },
                }),
            },
            extruded: match extruded {
                None => None,
                Some(Extruded { corners, carry }) => {
                    Some(ExtrudedEntry { corners: writer.blob::<f32, _>("corners", corners, 8)?, carry: *carry })
                }
            },
            kept: match retained {
                None => None,
                Some(retained) => Some(writer.blob::<u32, _>("kept", retained, 2)?),
            },
            pieces_of: pieces_of.as_ref().map(|of| writer.blob::<u32, _>("pieces_of", of, 1)).transpose()?,
            source_triangles: source_triangles
                .as_ref()
                .map(|of| writer.blob::<u32, _>("source_triangles", of, 1))
                .transpose()?,
        });
    }
    for (index, PlanTexture { picture, clamps }) in plan.textures.iter().enumerate() {
        let file = format!("texture{index:03}.png");
        let texels = picture.texels().as_flattened().to_vec();
        files::write_image(folder, &file, &Image::packed(PixelFormat::Rgba8Srgb, picture.size(), texels))?;
        entry.textures.push(TextureEntry { name: picture.name().to_owned(), file, clamps: *clamps });
    }
    for (pass, image) in plan.passes.iter().enumerate().filter_map(|(pass, of)| Some((pass, of.image.as_ref()?))) {
        let file = format!("pass{pass:03}.image.npy");
        files::write_values(folder, &file, &image.source.make(), 1)?;
        entry.images.push(ImageEntry { pass, name: image.name.clone(), file });
    }
    for (pass, of) in plan.passes.iter().enumerate() {
        let Some(start) = of.recorded.as_ref().and_then(|recorded| recorded.start.as_ref()) else { continue };
        let mut writer = ArrayWriter { folder, stem: format!("pass{pass:03}.start"), written: &mut written };
        let depth = start.depth.as_ref().map(|depth| writer.blob::<f32, _>("depth", depth, 1)).transpose()?;
        let stencil = start.stencil.as_ref();
        let stencil = stencil.map(|stencil| writer.blob::<u8, _>("stencil", stencil, 1)).transpose()?;
        entry.starts.push(StartEntry { pass, depth, stencil });
    }
    folder.write(FRAME, |out| Ok(serde_json::to_writer(out, &entry)?))
}

/// Writes each array once.
struct ArrayWriter<'a, 'f> {
    folder: &'a CaptureFiles<'f>,
    stem: String,
    /// File of each array by its kind, its hash and its length.
    written: &'a mut BTreeMap<(&'static str, u64, usize), String>,
}

impl ArrayWriter<'_, '_> {
    /// Writes an array of numbers, `columns` to a row, and returns its file's name. An equal array of the same kind
    /// that was written before is not written again: its file is named.
    fn blob<N: Element, T: bytemuck::Pod>(
        &mut self,
        kind: &'static str,
        blob: &Blob<T>,
        columns: u64,
    ) -> Result<String, CaptureError> {
        let key = (kind, blob.hash(), blob.data().len());
        if let Some(file) = self.written.get(&key) {
            return Ok(file.clone());
        }
        let file = format!("{}.{kind}.npy", self.stem);
        files::write_values::<N>(self.folder, &file, bytemuck::cast_slice(blob.data()), columns)?;
        self.written.insert(key, file.clone());
        Ok(file)
    }

    /// Writes the normals of a mesh's surface, corner by corner, each with a zero after it, and returns their file's name.
    fn normals(&mut self, normals: &SurfaceNormals, mesh: &DrawMesh) -> Result<String, CaptureError> {
        let corners = mesh.indices.data().as_chunks::<3>().0.iter().enumerate();
        let of_triangle = |(triangle, corners): (usize, &[u32; 3])| normals.of_triangle(triangle, *corners);
        let four = |[x, y, z]: [f32; 3]| [x, y, z, 0.0];
        let each = corners.filter_map(of_triangle).flat_map(|triangle| triangle.map(four));
        // The iterator does not know how many there are, and a vector that grows is in memory twice.
        let mut rows: Vec<[f32; 4]> = Vec::with_capacity(mesh.indices.data().len());
        rows.extend(each);
        self.blob::<f32, _>("normals", &Blob::new(rows), 4)
    }
}

/// Reads the plan of a capture folder with its meshes, textures and pictures; `None` where the folder has no
/// `frame.json`, as of schema 1. Fails where the plan breaks one of the rules that `lint` checks, or does not belong to
/// `capture`.
pub(super) fn read(
    folder: &CaptureFiles,
    capture: &Capture,
    lint: impl Fn(&FramePlan) -> Vec<LintError>,
) -> Result<Option<FramePlan>, CaptureError> {
    if !folder.has(FRAME) {
        return Ok(None);
    }
    let wrong = |reason: String| CaptureError::Read { file: folder.path(FRAME), reason };
    let text = files::read_text(folder, FRAME)?;
    let entry: FrameEntry<FramePlan> = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    let mut plan = entry.plan;
    let mut get = ArrayReader::new(folder);
    for MeshEntry { name, vertices, indices, surface, extruded, kept, pieces_of, source_triangles } in entry.meshes {
        let files = [indices.as_str(), vertices.as_str()].map(str::to_owned);
        let indices = get.blob::<u32, _>(&indices, 3)?;
        let count = match &extruded {
            None => get.blob::<f32, [f32; 4]>(&vertices, 4)?.len(),
            Some(_) => 0,
        };
        let surface = match surface {
            None => None,
            Some(SurfaceEntry { normals, sides, uvs }) => Some(SurfaceData {
                normals: get.normals(&normals, files, &indices, count)?,
                sides: get.blob::<u32, _>(&sides, 1)?,
                uvs: uvs.map(|file| get.blob::<f32, _>(&file, 2)).transpose()?,
            }),
        };
        plan.meshes.push(match extruded {
            None => {
                let retained = kept.map(|file| get.retained_fragments(&file)).transpose()?;
                let vertices = get.blob::<f32, _>(&vertices, 4)?;
                let pieces_of = pieces_of.map(|file| get.blob::<u32, _>(&file, 1)).transpose()?;
                let source_triangles = source_triangles.map(|file| get.blob::<u32, _>(&file, 1)).transpose()?;
                let mesh = DrawMesh::of_blobs(name, vertices, indices);
                DrawMesh { surface, retained, pieces_of, source_triangles, ..mesh }
            }
            Some(ExtrudedEntry { corners, carry }) => {
                let corners = get.blob::<f32, _>(&corners, 8)?;
                DrawMesh::of_extruded(name, Extruded { corners, carry }, indices)
            }
        });
    }
    for TextureEntry { name, file, clamps } in entry.textures {
        plan.textures.push(PlanTexture { picture: get.picture(name, &file)?, clamps });
    }
    for ImageEntry { pass, name, file } in entry.images {
        let texels: Vec<u8> = files::read_values(folder, plain(folder, &file)?, 1)?;
        let pass = plan.passes.get_mut(pass).ok_or_else(|| wrong("it names a pass that is not there".to_owned()))?;
        let content = FixedState::default().hash_one(&texels);
        pass.image = Some(CpuImage { name, content, source: Arc::new(StoredImage { texels }) });
    }
    for StartEntry { pass, depth, stencil } in entry.starts {
        let recorded = plan.passes.get_mut(pass).and_then(|pass| pass.recorded.as_mut());
        let recorded = recorded.ok_or_else(|| wrong("it names a pass that is not there".to_owned()))?;
        let depth = depth.map(|file| get.blob::<f32, _>(&file, 1)).transpose()?;
        let stencil = stencil.map(|file| get.blob::<u8, _>(&file, 1)).transpose()?;
        recorded.start = Some(StartContent { depth, stencil });
    }
    let broken = || lint(&plan).first().map(ToString::to_string);
    match inconsistency(&plan, capture).or_else(broken) {
        Some(reason) => Err(wrong(reason)),
        None => Ok(Some(plan)),
    }
}

/// Returns the name of a file of the folder; an error where it is not plain, so that a frame can't point out of its
/// folder.
fn plain<'a>(folder: &CaptureFiles, file: &'a str) -> Result<&'a str, CaptureError> {
    match super::is_plain(file) {
        true => Ok(file),
        false => {
            let reason = "it names a file outside its folder".to_owned();
            Err(CaptureError::Read { file: folder.path(FRAME), reason })
        }
    }
}

/// Reads each array once.
struct ArrayReader<'a, 'f> {
    folder: &'a CaptureFiles<'f>,
    blobs: BTreeMap<String, Box<dyn Any>>,
    /// By their file, and those of the mesh's indices and vertices.
    normals: BTreeMap<(String, [String; 2]), SurfaceNormals>,
    pictures: BTreeMap<String, Arc<TextureImage>>,
    /// The number of texels that the pictures still to be read may have.
    texels_left: u64,
}

impl<'a, 'f> ArrayReader<'a, 'f> {
    fn new(folder: &'a CaptureFiles<'f>) -> ArrayReader<'a, 'f> {
        ArrayReader {
            folder,
            blobs: BTreeMap::new(),
            normals: BTreeMap::new(),
            pictures: BTreeMap::new(),
            texels_left: TextureImage::MOST_TOGETHER,
        }
    }

    /// Reads an array whose rows have `columns` numbers. A file that was read before as the same type is not read
    /// again: the two arrays share memory.
    fn blob<N: Element, T: bytemuck::Pod>(&mut self, file: &str, columns: u64) -> Result<Blob<T>, CaptureError> {
        if let Some(known) = self.blobs.get(file).and_then(|known| known.downcast_ref::<Blob<T>>()) {
            return Ok(known.clone());
        }
        let numbers: Vec<N> = files::read_values(self.folder, plain(self.folder, file)?, columns)?;
        let blob = Blob::<T>::new(bytemuck::cast_slice(&numbers).to_vec());
        self.blobs.insert(file.to_owned(), Box::new(blob.clone()));
        Ok(blob)
    }

    /// Reads the normals of a surface, which a file has corner by corner, four numbers each, for a mesh of so many vertices
    /// whose indices and vertices are in `files`. Fails where they are not as many as the indices.
    fn normals(
        &mut self,
        file: &str,
        files: [String; 2],
        indices: &Blob<u32>,
        vertices: usize,
    ) -> Result<SurfaceNormals, CaptureError> {
        let key = (file.to_owned(), files);
        if let Some(known) = self.normals.get(&key) {
            return Ok(known.clone());
        }
        let numbers: Vec<f32> = files::read_values(self.folder, plain(self.folder, file)?, 4)?;
        let (corners, _) = numbers.as_chunks::<4>();
        if corners.len() != indices.len() {
            let reason = format!("it has {} normals, for {} corners", corners.len(), indices.len());
            return Err(CaptureError::Read { file: self.folder.path(file), reason });
        }
        let of_corner = |corner: usize| [corners[corner][0], corners[corner][1], corners[corner][2]];
        let of_triangle = |triangle: usize| [0, 1, 2].map(|corner| of_corner(triangle * 3 + corner));
        let normals = SurfaceNormals::new(indices.data(), vertices, of_triangle);
        self.normals.insert(key, normals.clone());
        Ok(normals)
    }

    /// Reads the fragments that a shader retained (pairs of pixel and triangle). Fails where they are not sorted, as
    /// they are searched by bisection.
    fn retained_fragments(&mut self, file: &str) -> Result<Blob<[u32; 2]>, CaptureError> {
        let retained = self.blob::<u32, [u32; 2]>(file, 2)?;
        match retained.data().is_sorted() {
            true => Ok(retained),
            false => {
                let reason = "its fragments are not in order".to_owned();
                Err(CaptureError::Read { file: self.folder.path(file), reason })
            }
        }
    }

    /// Reads a texture's picture and subtracts its texels from the budget `texels_left`; fails where it is larger than
    /// that. A file that was read before is returned again, under the name that was given first.
    fn picture(&mut self, name: String, file: &str) -> Result<Arc<TextureImage>, CaptureError> {
        if let Some(known) = self.pictures.get(file) {
            return Ok(Arc::clone(known));
        }
        let wrong = |reason: String| CaptureError::Read { file: self.folder.path(file), reason };
        let bytes = self.folder.read(plain(self.folder, file)?, TextureImage::MOST_BYTES).map_err(wrong)?;
        let read = TextureImage::decode(name, &bytes, self.texels_left);
        let picture = read.map_err(|error| wrong(error.to_string()))?;
        self.texels_left -= picture.texels().len() as u64;
        let picture = Arc::new(picture);
        self.pictures.insert(file.to_owned(), Arc::clone(&picture));
        Ok(picture)
    }
}

/// A picture that was computed before the folder was written.
#[derive(Debug)]
struct StoredImage {
    texels: Vec<u8>,
}

impl MakeImage for StoredImage {
    fn make(&self) -> Vec<u8> {
        self.texels.clone()
    }
}

/// Returns why a plan can't be run or is not the frame of `capture`: other numbers of passes or lights, another size,
/// indices or sizes out of range. `None` where nothing is wrong.
fn inconsistency(plan: &FramePlan, capture: &Capture) -> Option<String> {
    let has_light = |light: LightId| light.0 < plan.lights.len();
    let has_attachment = |id: AttachmentId| id.0 < plan.attachments.len();
    let is_light_whole = |light: &PlanLight| {
        let map = light.map.as_ref().is_none_or(|map| {
            let faces = [map.clip_from_light.len(), map.clip_from_relative.len()];
            has_attachment(map.attachment)
                && faces.iter().all(|count| *count == map.faces.len())
                && map.faces.len() <= plan.attachments[map.attachment.0].layers as usize
                && map.faces.iter().flatten().all(|view| view.0 < plan.views.len())
        });
        let others = [light.count, light.visibility];
        map && has_attachment(light.labels) && others.into_iter().flatten().all(has_attachment)
    };
    let is_sized = |attachment: &Attachment| {
        let is_side = |side: &u32| (1..=files::LARGEST).contains(side);
        let is_shown = matches!(attachment.role, AttachmentRole::Map(_)) || attachment.size == plan.size;
        attachment.size.iter().all(is_side) && (1..=MOST_LAYERS).contains(&attachment.layers) && is_shown
    };
    let of_light = |role: AttachmentRole| match role {
        AttachmentRole::Color | AttachmentRole::DepthStencil => None,
        AttachmentRole::Map(light)
        | AttachmentRole::Count(light)
        | AttachmentRole::Labels(light)
        | AttachmentRole::Visibility(light) => Some(light),
    };
    let steps = (plan.passes.len(), plan.lights.len(), plan.size);
    let texels = |pass: &crate::plan::Pass| {
        let target = pass.color.as_ref().and_then(|target| plan.attachments.get(target.attachment.0));
        target.map_or(0, |target| {
            u64::from(target.size[0])
                * u64::from(target.size[1])
                * u64::from(target.format.block_copy_size(None).unwrap_or(1))
        })
    };
    let is_picture = |pass: &crate::plan::Pass| {
        pass.image.as_ref().is_none_or(|image| image.source.make().len() as u64 == texels(pass))
    };
    if steps != (capture.steps.len(), capture.lights.len(), capture.size) {
        Some("it is not the frame of the manifest".to_owned())
    } else if !plan.attachments.iter().all(is_sized) {
        Some("an attachment has a size that it can't have".to_owned())
    } else if !plan.attachments.iter().filter_map(|one| of_light(one.role)).all(has_light)
        || !plan.lights.iter().all(is_light_whole)
        || !plan.passes.iter().filter_map(|pass| pass.light).all(has_light)
    {
        Some("it names a light, an attachment or a view that is not there".to_owned())
    } else if !plan.passes.iter().all(is_picture) {
        Some("a picture has not its target's size".to_owned())
    } else {
        None
    }
}

//! A glTF file, checked, with its buffers: JSON beside files (`.gltf`), or both in one (`.glb`).

use crate::files::read_plain;
use crate::scene::SceneError;
use crate::scene::files::read_text::quoted;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gltf::json::accessor::Accessor;
use gltf::json::validation::{Error, Validate};
use gltf::json::{Index, Path as JsonPath, Root, buffer};
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;
use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Bytes of the largest file, buffers and pictures alike.
const MOST_BYTES: u64 = 1 << 30;
/// Items of accessors that any file may have read; beyond, one more for each byte of its buffers. More means that one
/// buffer is used over and over.
const FREE_ITEMS: u64 = 1 << 22;
/// Bytes of the header, and so of the shortest binary file.
const GLB_HEAD: usize = 12;
/// Extensions that are fully supported.
const DONE_EXTENSIONS: [&str; 5] = [
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Second words of the names of extensions, after the vendor's, that change no surface: pictures in other formats
/// (`EXT_texture_webp`, `KHR_texture_basisu`), materials, lights and remarks. What they add is left out.
const HARMLESS_EXTENSIONS: [&str; 7] = ["materials", "texture", "technique", "techniques", "lights", "audio", "xmp"];
/// Extensions without which a file's surfaces can't be read, as they are compressed: Draco's, for which no small and
/// proven decoder exists in Rust, and meshoptimizer's.
const COMPRESSIONS: [&str; 3] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];

/// The error says why a file can't be shown and how to fix it; in one line, without the file's name.
pub type GltfResult<T> = Result<T, String>;

/// A glTF file that is valid by the format's rules, with its buffers.
#[derive(Debug)]
pub struct GltfDocument {
    /// Its JSON.
    pub root: Root,
    buffers: Vec<Vec<u8>>,
    /// Path that it was read from.
    pub file: PathBuf,
    /// The numbers of accessors that were read already, by index.
    pub(super) numbers: RefCell<HashMap<usize, Rc<Vec<f64>>>>,
    /// The number of items that may still be read.
    left: Cell<u64>,
}

impl GltfDocument {
    /// Reads a glTF file and its buffers, and checks the rules that reading relies on.
    pub fn open(file: &Path) -> Result<GltfDocument, SceneError> {
        let failed = |reason: String| SceneError::Read { file: file.to_owned(), reason };
        let bytes = read_plain(file, MOST_BYTES).map_err(|error| failed(error.to_string()))?;
        let (root, blob) = parse(&bytes, file)?;
        checked(&root).map_err(failed)?;
        let (numbers, left) = (RefCell::default(), Cell::new(FREE_ITEMS));
        let mut document = GltfDocument { root, buffers: Vec::new(), file: file.to_owned(), numbers, left };
        document.read_buffers(blob).map_err(failed)?;
        Ok(document)
    }

    fn read_buffers(&mut self, mut blob: Option<Vec<u8>>) -> GltfResult<()> {
        let (mut total, mut read) = (0, 0);
        for (index, buffer) in self.root.buffers.iter().enumerate() {
            let mut bytes = match &buffer.uri {
                Some(uri) => self.resource(uri, MOST_BYTES.saturating_sub(read))?,
                None => blob.take().filter(|_| index == 0).ok_or_else(|| {
                    format!(
                        "buffer {index} has no data: it names no file, and only the first may be in the .glb itself"
                    )
                })?,
            };
            let length = buffer.byte_length.0;
            if (bytes.len() as u64) < length {
                return Err(format!(
                    "buffer {index} has {} bytes where {length} are declared: export the file again",
                    bytes.len()
                ));
            }
            read += bytes.len() as u64;
            total += length;
            bytes.truncate(length as usize);
            bytes.shrink_to_fit();
            self.buffers.push(bytes);
        }
        self.left.set(FREE_ITEMS + total);
        Ok(())
    }

    /// Returns the bytes of a buffer's or a picture's URI: a file whose path is relative to this one's, of at most
    /// `most` bytes, or data in the URI itself.
    pub fn resource(&self, uri: &str, most: u64) -> GltfResult<Vec<u8>> {
        if let Some(data) = uri.strip_prefix("data:") {
            let broken = || "a data URI can't be read: export the file again".to_owned();
            let (head, data) = data.split_once(',').ok_or_else(broken)?;
            return match head.ends_with(";base64") {
                true => STANDARD.decode(data).map_err(|_| broken()),
                false => Ok(percent_encoding::percent_decode_str(data).collect()),
            };
        }
        let path = path_of(uri).ok_or_else(|| format!("{} is no file beside this one: put it there", quoted(uri)))?;
        read_plain(&self.file.with_file_name(path), most).map_err(|error| format!("{} {error}", quoted(uri)))
    }

    /// Returns the path of the file that a URI names, relative to this file; `None` for data in the URI and other
    /// schemes. It may not exist.
    pub fn beside(&self, uri: &str) -> Option<PathBuf> {
        path_of(uri).map(|path| self.file.with_file_name(path))
    }

    /// Returns the bytes of a buffer view; an error where it reaches beyond its buffer.
    pub fn view(&self, index: Index<buffer::View>) -> GltfResult<&[u8]> {
        let missing = || format!("buffer view {} is beyond its buffer: export the file again", index.value());
        let view = self.root.get(index).ok_or_else(missing)?;
        let start = view.byte_offset.map_or(0, |offset| offset.0);
        let end = start.checked_add(view.byte_length.0).ok_or_else(missing)?;
        let buffer = self.buffers.get(view.buffer.value()).ok_or_else(missing)?;
        buffer
            .get(usize::try_from(start).unwrap_or(usize::MAX)..usize::try_from(end).unwrap_or(usize::MAX))
            .ok_or_else(missing)
    }

    /// Subtracts `items` from the number of items that may still be read or computed; an error where fewer are left.
    pub fn take(&self, items: u64) -> GltfResult<()> {
        let left = self.left.get().checked_sub(items);
        self.left.set(left.ok_or("tells of more vertices and triangles than its buffers have bytes: split the model")?);
        Ok(())
    }
}

/// Returns the paths of the buffers and pictures that a glTF file names, sorted and each once, without data in URIs;
/// empty where it can't be read, which loading reports.
pub fn files_of(file: &Path) -> Vec<PathBuf> {
    let Ok(bytes) = read_plain(file, MOST_BYTES) else { return Vec::new() };
    let Ok((root, _)) = parse(&bytes, file) else { return Vec::new() };
    let buffers = root.buffers.iter().map(|buffer| buffer.uri.as_deref());
    let images = root.images.iter().map(|image| image.uri.as_deref());
    let named = buffers.chain(images).flatten().filter(|uri| !uri.starts_with("data:"));
    let mut files: Vec<PathBuf> = named.filter_map(path_of).map(|path| file.with_file_name(path)).collect();
    files.sort();
    files.dedup();
    files
}

/// Returns the decoded path in a URI (RFC 3986); `None` for data, another scheme with `://`, an empty URI, or bytes
/// that are not UTF-8.
///
/// It may lead out of the file's folder, as the picture of an OBJ's library may: `../textures/` is common, and whoever
/// opens a model could open that file, too. Nothing is fetched, only plain files are read, and they are used as numbers of
/// a buffer or texels of a picture. Backslashes, of files that were written on another system, separate folders.
fn path_of(uri: &str) -> Option<PathBuf> {
    let is_elsewhere = uri.starts_with("data:") || uri.contains("://") || uri.is_empty();
    let path = percent_encoding::percent_decode_str(uri).decode_utf8().ok()?;
    (!is_elsewhere).then(|| PathBuf::from(path.replace('\\', "/")))
}

fn parse(bytes: &[u8], file: &Path) -> Result<(Root, Option<Vec<u8>>), SceneError> {
    let failed = |reason: &str| SceneError::Read { file: file.to_owned(), reason: reason.to_owned() };
    if bytes.is_empty() {
        return Err(failed("is empty: give a glTF file with content"));
    }
    let is_binary = bytes.starts_with(b"glTF");
    // The crate subtracts the header's length unchecked.
    let length = bytes.get(8..GLB_HEAD).and_then(|length| length.try_into().ok()).map_or(0, u32::from_le_bytes);
    if is_binary && (length as usize) < GLB_HEAD {
        return Err(failed("is a broken .glb (its head is too short): export it again"));
    }
    let error = match gltf::Gltf::from_slice_without_validation(bytes) {
        Ok(gltf::Gltf { document, blob }) => return Ok((document.into_json(), blob)),
        Err(error) => error,
    };
    let older = match is_binary {
        true => (bytes[4..8] == [1, 0, 0, 0]).then(|| "1.0".to_owned()),
        false => older_version(bytes),
    };
    Err(match (older, error) {
        (Some(version), _) => failed(&other_version(&version)),
        (None, gltf::Error::Deserialize(error)) if !is_binary && error.line() > 0 => SceneError::Line {
            file: file.to_owned(),
            line: error.line(),
            reason: format!("is no glTF 2.0 ({}): export the file again", in_a_line(&error.to_string())),
        },
        (None, error) => failed(&format!("is no glTF 2.0 file ({}): export it again", in_a_line(&error.to_string()))),
    })
}

/// Returns a foreign message as one line of at most 120 characters, control characters escaped.
fn in_a_line(words: &str) -> String {
    const MOST: usize = 120;
    words.chars().take(MOST).flat_map(char::escape_debug).collect()
}

/// Checks the rules of the format that reading relies on: version 2, no required extension that changes surfaces and is not
/// supported, valid indices and values. The error says what is wrong and how to fix it.
fn checked(root: &Root) -> GltfResult<()> {
    if !is_version_2(&root.asset.version) {
        return Err(other_version(&root.asset.version));
    }
    if let Some(other) = root.extensions_required.iter().find(|name| !is_known(name)).or_else(|| compression(root)) {
        let fix = match COMPRESSIONS.contains(&other.as_str()) {
            true => "which compresses its surfaces: export it uncompressed, or as OBJ or PLY",
            false => "which is not done here: export it without",
        };
        return Err(format!("needs the extension {}, {fix}", quoted(other)));
    }
    // The crate's own check of these indexes without a bounds check.
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    if let Some(beyond) = primitives.flat_map(|one| one.attributes.values()).find(|index| root.get(**index).is_none()) {
        return Err(format!("has vertices in accessor {}, which is missing: export it again", beyond.value()));
    }
    let mut first: Option<(String, Error)> = None;
    root.validate(root, JsonPath::new, &mut |path, error| {
        let path = path();
        // Bounds of positions are computed here, extensions were checked above, and of an exporter's own attributes
        // (`_FEATURE_ID_0`) nothing is read.
        let is_bound = [".min", ".max"].iter().any(|end| path.as_str().ends_with(end));
        let is_own = path.as_str().contains(".attributes[") && error == Error::Invalid;
        let is_needless = (is_bound && path.as_str().contains("POSITION")) || is_own;
        if first.is_none() && error != Error::Unsupported && !is_needless {
            first = Some((path.as_str().to_owned(), error));
        }
    });
    match first {
        Some((path, error)) => {
            Err(format!("breaks a rule of glTF 2.0 at {} ({error}): export it again", quoted(&path)))
        }
        None => Ok(()),
    }
}

/// Returns the extension that compresses some surface of a file that only says that it uses it; `None` where every surface
/// is there uncompressed, too.
fn compression(root: &Root) -> Option<&String> {
    let has_no_data = |accessor: &Accessor| accessor.buffer_view.is_none() && accessor.sparse.is_none();
    let lacks_data =
        root.accessors.iter().any(has_no_data) || root.buffers.iter().skip(1).any(|buffer| buffer.uri.is_none());
    root.extensions_used.iter().find(|name| lacks_data && COMPRESSIONS.contains(&name.as_str()))
}

/// Returns whether a file that requires this extension is read all the same: the extension is supported, or changes
/// only how surfaces look. Whether it is fully supported is `is_done`.
fn is_known(extension: &str) -> bool {
    let kind = extension.split('_').nth(1);
    is_done(extension) || kind.is_some_and(|kind| HARMLESS_EXTENSIONS.contains(&kind))
}

/// Returns whether an extension is fully supported.
pub fn is_done(extension: &str) -> bool {
    DONE_EXTENSIONS.contains(&extension)
}

/// Returns the error about a file of another version of the format.
fn other_version(version: &str) -> String {
    format!("is of glTF version {}, and 2.0 is read: convert it", quoted(version))
}

fn is_version_2(version: &str) -> bool {
    version.split('.').next() == Some("2")
}

/// Returns the version of JSON that is no glTF 2.0 as it is of an older one: what it says, else 1.0 where its meshes have
/// names and no numbers. `None` for any other.
fn older_version(json: &[u8]) -> Option<String> {
    #[derive(Default, Deserialize)]
    #[serde(default)]
    struct VersionOnly {
        version: Option<Value>,
    }
    #[derive(Deserialize)]
    struct AssetOnly {
        asset: VersionOnly,
    }
    #[derive(Deserialize)]
    struct NamedMeshes {
        meshes: HashMap<String, IgnoredAny>,
    }
    let file = serde_json::from_slice::<AssetOnly>(json);
    let given = file.ok().and_then(|file| file.asset.version).map(|version| match version {
        Value::String(text) => text,
        number => number.to_string(),
    });
    match given {
        Some(version) => Some(version).filter(|version| !is_version_2(version)),
        None => {
            let named = serde_json::from_slice::<NamedMeshes>(json).ok().filter(|file| !file.meshes.is_empty());
            named.map(|_| "1.0".to_owned())
        }
    }
}

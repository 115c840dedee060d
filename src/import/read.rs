//! Reads the folder that the script has written as a frame.
//!
//! Nothing in it is trusted: it comes from a capture that anybody may have made. Numbers are checked against the files
//! before memory is allocated for them, names against those that are known. Positions are taken as they are, NaN too.

use super::blobs::BlobFile;
use super::document::{self, FORMAT, RenderDocDocument};
use super::error::ImportError;
use super::layers::SplitDraw;
use super::pictures::{self, TexelLayout};
use super::raw::{
    RawContents, RawDraw, RawEvent, RawFormat, RawFragment, RawFrame, RawKind, RawTarget, RawTexture, RawTopology,
    RecordedApi,
};
use super::{geometry, shader, states};
use crate::files::open_plain;
use crate::plan::ShaderEffect;
use std::collections::{BTreeMap, BTreeSet};
use std::io::{Read, Seek};
use std::path::Path;

/// Limit on the bytes of `frame.json`.
const MOST_TEXT: u64 = 256 << 20;
/// Limit on a texture's width and height in texels.
const LARGEST: u32 = 1 << 14;
/// Limit on the events of a frame.
const MOST_EVENTS: usize = 100_000;
/// Limit on the textures of a frame.
const MOST_TEXTURES: usize = 100_000;
/// Limit on the layers of a target that one event changes: the script reads no more.
const MOST_LAYERS: usize = 64;

/// Reads and checks the frame that a recording wrote into this folder, from `frame.json` and `data.bin`.
pub fn read(folder: &Path) -> Result<RawFrame, ImportError> {
    let open = |name: &str| open_plain(&folder.join(name)).map_err(|error| broken(format!("{name}: {error}")));
    read_from(open("frame.json")?, open("data.bin")?)
}

/// Reads and checks a frame from its document (JSON) and its data (compressed byte strings).
pub fn read_from(document: impl Read, data: impl Read + Seek + 'static) -> Result<RawFrame, ImportError> {
    let document = self::document(document)?;
    let api =
        RecordedApi::from_name(&document.api).ok_or_else(|| broken(format!("it is of the API `{}`", document.api)))?;
    let textures = document.textures.iter().map(texture).collect::<Result<_, _>>()?;
    let limits = document.limits.into_iter().collect();
    let blobs = BlobFile::new(data, document.blobs)?;
    let sizes = document.textures.iter().map(|texture| [texture.layers, texture.mips]).collect();
    let mut reader = DocumentReader {
        api,
        textures,
        sizes,
        blobs,
        pictures: BTreeMap::new(),
        last: BTreeMap::new(),
        shaders: BTreeMap::new(),
        multisampled: BTreeMap::new(),
        limits,
    };
    let mut before = Vec::new();
    for one in document.before {
        let target = reader.target(one.target)?;
        before.push((target, reader.contents(target, one.contents)?));
    }
    let is_layered = |event: &document::RenderDocEvent| event.draw.is_some() && !event.layers_after.is_empty();
    let layered: BTreeSet<u32> =
        document.events.iter().filter(|event| is_layered(event)).map(|event| event.id).collect();
    let mut events: Vec<RawEvent> = Vec::new();
    for event in document.events {
        let of_layers = reader.event(event)?;
        if events.len() + of_layers.len() > MOST_EVENTS {
            return Err(too_many_events(events.len() + of_layers.len()));
        }
        events.extend(of_layers);
    }
    for (texture, has_picture) in &reader.multisampled {
        let RawTexture { name, samples, .. } = &reader.textures[*texture];
        let words = if *has_picture { "of each the first is read" } else { "its pictures are not read" };
        reader.limits.insert(format!("`{name}` has {samples} samples a pixel: {words}"));
    }
    // Draws into different layers do not see each other: in the order of layers those into one are one pass.
    let texture = |event: &RawEvent| event.depth_target.filter(|_| layered.contains(&event.id)).map(|of| of.texture);
    for run in events.chunk_by_mut(|one, next| texture(one).is_some() && texture(one) == texture(next)) {
        run.sort_by_key(|event| event.depth_target);
    }
    Ok(RawFrame {
        api,
        adapter: document.adapter,
        recorder: document.recorder,
        program: None,
        before,
        events,
        textures: reader.textures,
        limits: reader.limits.into_iter().collect(),
    })
}

fn too_many_events(events: usize) -> ImportError {
    ImportError::TooLarge { what: format!("{events} events, of {MOST_EVENTS}") }
}

fn broken(what: impl Into<String>) -> ImportError {
    ImportError::Folder(what.into())
}

fn document(file: impl Read) -> Result<RenderDocDocument, ImportError> {
    let failed = |error: &dyn std::fmt::Display| broken(format!("frame.json: {error}"));
    let mut text = Vec::new();
    file.take(MOST_TEXT + 1).read_to_end(&mut text).map_err(|error| failed(&error))?;
    if text.len() as u64 > MOST_TEXT {
        return Err(ImportError::TooLarge { what: format!("more than {} MiB of states", MOST_TEXT >> 20) });
    }
    let document: RenderDocDocument = serde_json::from_slice(&text).map_err(|error| failed(&error))?;
    let [events, textures] = [document.events.len(), document.textures.len()];
    if document.format != FORMAT {
        Err(failed(&format!("it is of format {}, not {FORMAT}", document.format)))
    } else if events > MOST_EVENTS {
        Err(too_many_events(events))
    } else if textures > MOST_TEXTURES {
        Err(ImportError::TooLarge { what: format!("{textures} textures, of {MOST_TEXTURES}") })
    } else {
        Ok(document)
    }
}

fn texture(one: &document::RenderDocTexture) -> Result<RawTexture, ImportError> {
    let document::RenderDocTexture { name, format, size, layers, samples, .. } = one;
    if size.iter().any(|side| *side > LARGEST) {
        return Err(ImportError::TooLarge { what: format!("`{name}` has {}x{} texels", size[0], size[1]) });
    }
    let format = pictures::format(format);
    Ok(RawTexture {
        name: name.clone(),
        format,
        size: size.map(|side| side.max(1)),
        layers: *layers,
        samples: *samples,
    })
}

struct DocumentReader {
    api: RecordedApi,
    textures: Vec<RawTexture>,
    /// Numbers of layers and mip levels of each texture.
    sizes: Vec<[u32; 2]>,
    blobs: BlobFile,
    /// Pictures by byte string, format and size: equal ones share memory.
    pictures: BTreeMap<(usize, usize, [u32; 2]), RawContents>,
    /// The last pictures of each target: most rows of the next are equal.
    last: BTreeMap<RawTarget, RawContents>,
    shaders: BTreeMap<(String, usize), RawFragment>,
    /// Textures with several samples a pixel, and whether any picture of them is there.
    multisampled: BTreeMap<usize, bool>,
    limits: BTreeSet<String>,
}

impl DocumentReader {
    fn target(&self, one: document::RenderDocTarget) -> Result<RawTarget, ImportError> {
        let document::RenderDocTarget { texture, mip, layer } = one;
        let is_there = self.sizes.get(texture).is_some_and(|[layers, mips]| layer < *layers && mip < (*mips).min(32));
        let missing = || broken(format!("there is no level {mip} of layer {layer} of texture {texture}"));
        is_there.then_some(RawTarget { texture, mip, layer }).ok_or_else(missing)
    }

    fn is_gl(&self) -> bool {
        self.api != RecordedApi::Vulkan
    }

    /// Returns the width and height of a target in texels.
    fn size(&self, target: RawTarget) -> [u32; 2] {
        self.textures[target.texture].size.map(|side| (side >> target.mip).max(1))
    }

    /// Returns the pictures of a target from the byte string `blob`; none where that is `None` or the format is not
    /// read. What can't be read is added to the limits; a wrong length is an error. Pictures read before are shared.
    fn contents(&mut self, target: RawTarget, blob: Option<usize>) -> Result<RawContents, ImportError> {
        let texture = &self.textures[target.texture];
        let name = &texture.name;
        let samples = texture.samples;
        if let RawFormat::Other(format) = &texture.format {
            self.limits.insert(format!("`{name}` is of the format {format}: its pictures are not read"));
        } else if samples > 1 {
            *self.multisampled.entry(target.texture).or_default() |= blob.is_some();
        }
        let Some((blob, texel)) = blob.zip(pictures::texel_bytes(&texture.format)) else {
            return Ok(RawContents::default());
        };
        let [width, height] = self.size(target);
        let [found, expected] = [self.blobs.length(blob)?, u64::from(width) * u64::from(height) * texel as u64];
        // RenderDoc adds a byte a texel after Vulkan's depth of 24 bits with stencil: space for what it has stored
        // above.
        let has_padding = texture.format == RawFormat::D24S8 && found == expected / 4 * 5;
        if found != expected && !has_padding {
            return Err(broken(format!("a picture of `{name}` has {found} bytes, not {expected}")));
        }
        // The first texture of the format stands for all of them.
        let alike = self.textures.iter().position(|other| other.format == texture.format).unwrap_or(target.texture);
        if let Some(known) = self.pictures.get(&(blob, alike, [width, height])) {
            self.last.insert(target, known.clone());
            return Ok(known.clone());
        }
        let mut bytes = self.blobs.read(blob)?;
        bytes.truncate(usize::try_from(expected).unwrap_or(usize::MAX));
        if self.is_gl() && self.textures[target.texture].format == RawFormat::D32F && pictures::is_normalised(&bytes) {
            self.textures[target.texture].format = RawFormat::D32;
        }
        // The decoded pictures take at most as much again, and as much as depths.
        self.blobs.reserve(found.saturating_mul(3))?;
        let layout = TexelLayout { bottom_row_first: self.is_gl(), depth_above_stencil: self.is_gl() };
        let mut contents = pictures::read(&self.textures[target.texture].format, &bytes, [width, height], layout);
        let last = self.last.entry(target).or_default();
        let shared = pictures::share(&mut contents, last);
        last.clone_from(&contents);
        // The bytes are freed, and rows that are shared take nothing.
        self.blobs.give_back(found.saturating_mul(4).saturating_sub(shared));
        self.pictures.insert((blob, alike, [width, height]), contents.clone());
        Ok(contents)
    }

    /// Reads an event; one for each layer where it draws into several of them, or may change all.
    fn event(&mut self, event: document::RenderDocEvent) -> Result<Vec<RawEvent>, ImportError> {
        let targets = event.colors.iter().copied().flatten().map(|one| self.target(one));
        let color_targets: Vec<RawTarget> = targets.collect::<Result<_, _>>()?;
        // The picture that is read after an event is the target of output 0.
        let first = event.colors.first().copied().flatten().map(|one| self.target(one)).transpose()?;
        let depth_target = event.depth.map(|one| self.target(one)).transpose()?;
        let color = first.map(|target| self.contents(target, event.color_after)).transpose()?.unwrap_or_default();
        let depth = depth_target.map(|target| self.contents(target, event.depth_after)).transpose()?;
        let after = RawContents { color: color.color, ..depth.unwrap_or_default() };
        let mut layers = Vec::new();
        let kind = match (event.kind.as_str(), &event.draw) {
            ("draw", Some(draw)) => {
                let (draw, of_vertices) = self.draw(event.id, draw, color_targets.first().copied(), depth_target)?;
                layers = of_vertices;
                RawKind::Draw(Box::new(draw))
            }
            ("clear", _) => clear(&event.name, event.clears),
            ("begin", _) => RawKind::BeginPass,
            ("end", _) => RawKind::EndPass,
            ("copy", _) => RawKind::Copy,
            ("compute", _) => RawKind::Compute,
            ("present", _) => RawKind::Present,
            (kind, _) => return Err(broken(format!("event {} is of the kind `{kind}`", event.id))),
        };
        if kind == RawKind::Compute {
            self.limits.insert("what compute work writes is not followed".to_owned());
        }
        let document::RenderDocEvent { id, name, groups, layers_after, .. } = event;
        let event = RawEvent { id, name, groups, kind, color_targets, depth_target, after };
        if layers_after.is_empty() { Ok(vec![event]) } else { self.of_layers(event, &layers, &layers_after) }
    }

    /// Returns an event once for each layer of its depth target that it draws into or may change, counted from the target's
    /// own: `after` has what each of them holds afterwards, and `layers` which one each vertex names.
    fn of_layers(
        &mut self,
        event: RawEvent,
        layers: &[u32],
        after: &[Option<usize>],
    ) -> Result<Vec<RawEvent>, ImportError> {
        let Some(first) = event.depth_target else { return Ok(vec![event]) };
        if after.len() > MOST_LAYERS {
            return Err(ImportError::TooLarge {
                what: format!("{} layers of a target, of {MOST_LAYERS}", after.len()),
            });
        }
        let mut draws = match &event.kind {
            RawKind::Draw(draw) => {
                self.blobs.reserve(SplitDraw::most_bytes(draw, after.len()))?;
                let split = SplitDraw::of(draw, layers, after.len() as u32);
                if split.dropped > 0 {
                    let dropped = split.dropped;
                    self.limits.insert(format!(
                        "event {}: {dropped} triangles are drawn into layers that are not there",
                        event.id
                    ));
                }
                Some(split.draws)
            }
            _ => None,
        };
        let mut events = Vec::new();
        for (index, blob) in (0..).zip(after) {
            let at = |target: RawTarget| document::RenderDocTarget {
                texture: target.texture,
                mip: target.mip,
                layer: target.layer.saturating_add(index),
            };
            let target = self.target(at(first))?;
            let kind = match &mut draws {
                None => event.kind.clone(),
                Some(draws) => match draws.remove(&index) {
                    Some(draw) => RawKind::Draw(Box::new(draw)),
                    None => continue,
                },
            };
            let depth = self.contents(target, *blob)?;
            let colors = event.color_targets.iter().filter_map(|color| self.target(at(*color)).ok());
            events.push(RawEvent {
                kind,
                color_targets: colors.collect(),
                depth_target: Some(target),
                // Of colours the first layer alone is recorded.
                after: RawContents { color: event.after.color.clone().filter(|_| index == 0), ..depth },
                id: event.id,
                name: event.name.clone(),
                groups: event.groups.clone(),
            });
        }
        Ok(if events.is_empty() { vec![event] } else { events })
    }

    /// Reads a draw, and the layers of the target that its vertices name, if they do.
    fn draw(
        &mut self,
        event: u32,
        draw: &document::RenderDocDraw,
        color: Option<RawTarget>,
        depth: Option<RawTarget>,
    ) -> Result<(RawDraw, Vec<u32>), ImportError> {
        let of_event = |what: String| broken(format!("event {event}: {what}"));
        let target = depth.or(color);
        let [_, height] = target.map_or([LARGEST; 2], |target| self.size(target));
        let samples = target.map_or(1, |target| self.textures[target.texture].samples);
        let format = depth.map(|target| self.textures[target.texture].format.clone());
        let fragment = self.fragment(draw.shader.as_ref(), draw.alpha_to_coverage)?;
        let states = states::read(draw, self.is_gl(), [height, samples], format.as_ref(), color.is_some());
        let states = states.map_err(of_event)?;
        let geometry = geometry::read(&draw.instances, draw.layer_at, &mut self.blobs)?;
        let mut note = |is_so: bool, words: &str| {
            if is_so {
                self.limits.insert(format!("event {event}: {words}"));
            }
        };
        let has_triangles = !matches!(geometry.topology, RawTopology::Points | RawTopology::Lines | RawTopology::Other);
        note(draw.instances.is_empty(), &format!("its vertices are not known ({})", draw.why));
        note(!draw.instances.is_empty() && !has_triangles, "it draws points, lines or patches, which are not followed");
        note(geometry.dropped > 0, &format!("{} corners point to no vertex", geometry.dropped));
        note(draw.clip_planes, "it is cut by planes of its own, which are not followed");
        note(draw.depth_bounds, "stored depth is held against bounds, which are not followed");
        note(draw.fill != "Solid", "triangles are drawn as lines or points, which are not followed");
        note(
            draw.blend.as_ref().is_some_and(|blend| blend.logic),
            "colours meet by a logic operation, which is not read",
        );
        let read = RawDraw {
            topology: geometry.topology,
            positions: geometry.positions,
            triangles: geometry.triangles,
            instances: geometry.instances,
            view: states.view,
            shape: states.shape,
            depth: states.depth,
            stencil: states.stencil,
            blend: states.blend,
            fragment,
            retained: None,
            samples,
            sampled: self.sampled(draw.samples.as_deref()).map_err(of_event)?,
        };
        Ok((read, geometry.layers))
    }

    /// Returns the textures that a draw may sample.
    fn sampled(&self, textures: Option<&[usize]>) -> Result<Option<Vec<usize>>, String> {
        let unknown = textures.unwrap_or_default().iter().find(|one| **one >= self.textures.len());
        unknown.map_or(Ok(textures.map(<[usize]>::to_vec)), |one| Err(format!("there is no texture {one} to sample")))
    }

    /// Returns the effects of the fragment shader: it may discard too where alpha to coverage is on. A draw without a
    /// shader has no effect, whatever `alpha_to_coverage` says.
    fn fragment(
        &mut self,
        shader: Option<&document::RenderDocShader>,
        alpha_to_coverage: bool,
    ) -> Result<RawFragment, ImportError> {
        let none = RawFragment { may_discard: ShaderEffect::No, writes_depth: ShaderEffect::No };
        let Some(document::RenderDocShader { encoding, bytes }) = shader else { return Ok(none) };
        let key = (encoding.clone(), *bytes);
        let known = self.shaders.get(&key).copied();
        let fragment = known.map_or_else(|| Ok(shader::read(encoding, &self.blobs.read(*bytes)?)), Ok)?;
        self.shaders.insert(key, fragment);
        let may_discard = if alpha_to_coverage { ShaderEffect::Yes } else { fragment.may_discard };
        Ok(RawFragment { may_discard, ..fragment })
    }
}

/// Returns a clear of colour, and of depth and stencil as far as the call's name says: both where it names neither.
fn clear(name: &str, [color, depth_or_stencil]: [bool; 2]) -> RawKind {
    let [depth, stencil] = ["Depth", "Stencil"].map(|word| name.contains(word));
    let means_both = depth == stencil;
    RawKind::Clear {
        color,
        depth: depth_or_stencil && (depth || means_both),
        stencil: depth_or_stencil && (stencil || means_both),
    }
}

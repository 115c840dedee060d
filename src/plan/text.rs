//! A plan as text: stable, so that two plans can be compared line by line.
//!
//! Vertices are given by their number and kind; everything else that a GPU is given is printed in full.

use super::{
    AttachmentId, Carry, ColorWrite, DepthStencilTarget, Draw, DrawConstants, DrawPieces, FaceMasks, FramePlan,
    LightId, MapLookup, Pass, Program, RasterState, StencilFace, TextureId, Viewport, Visibility,
};
use std::fmt::{self, Display, Formatter};

impl Display for FramePlan {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "technique {} at {}x{}", self.technique, self.size[0], self.size[1])?;
        for (key, value) in &self.settings {
            writeln!(f, "  {key} = {value}")?;
        }
        writeln!(f, "depth {}: {}", self.depth.mapping.name(), self.depth.formula())?;
        for (index, attachment) in self.attachments.iter().enumerate() {
            let [width, height] = attachment.size;
            let (name, format, layers) = (&attachment.name, attachment.format, attachment.layers);
            let stored = self.stored_layers(AttachmentId(index));
            let left_out = if stored < layers { format!(", {stored} in memory") } else { String::new() };
            let floored = attachment.depth_bits.map_or(String::new(), |bits| format!(", depth floored to {bits} bits"));
            writeln!(
                f,
                "attachment {index}: {name}, {format:?} {width}x{height}, {layers} layer(s){left_out}{floored}"
            )?;
        }
        for (index, mesh) in self.meshes.iter().enumerate() {
            let (name, vertices, triangles) = (&mesh.name, mesh.vertices.len(), mesh.triangles());
            // The vertices that a vertex shader computes are not printed.
            if let Some(Carry { light, scale, offset, w }) = mesh.extruded.as_ref().map(|extruded| extruded.carry) {
                writeln!(f, "mesh {index}: {name}, {vertices} vertices, {triangles} triangles")?;
                writeln!(f, "  by its vertex shader carried from {light:?} to ({scale} v + {offset:?}, {w})")?;
                continue;
            }
            let infinite = mesh.vertices.data().iter().filter(|vertex| vertex[3] == 0.0).count();
            writeln!(f, "mesh {index}: {name}, {vertices} vertices ({infinite} at infinity), {triangles} triangles")?;
        }
        for (index, light) in self.lights.iter().enumerate() {
            let kind = if light.relative_position[3] == 0.0 { "directional" } else { "point" };
            let faces = light.map.as_ref().map_or(0, |map| map.faces.len());
            writeln!(f, "{}: {kind}, {faces} map face(s)", LightId(index).name())?;
            if let Some(lookup) = light.map.as_ref().and_then(|map| map.lookup) {
                let MapLookup { bias_normal, bias_receiver_plane, filter_width, .. } = lookup;
                let along = if bias_receiver_plane { ", along the surface's plane" } else { "" };
                writeln!(f, "  looked up {bias_normal} texels off, {filter_width}x{filter_width} texels{along}")?;
            }
        }
        for (index, pass) in self.passes.iter().enumerate() {
            self.fmt_pass(f, index, pass)?;
        }
        for left in &self.left_out {
            writeln!(f, "left out: {left}: {}", left.because)?;
        }
        Ok(())
    }
}

impl FramePlan {
    fn fmt_pass(&self, f: &mut Formatter<'_>, index: usize, pass: &Pass) -> fmt::Result {
        let light = pass.light.map_or(String::new(), |light| format!(" of {}", light.name()));
        let untimed = if pass.timed { "" } else { ", not timed" };
        writeln!(f, "pass {index}: {}{light}, seen from {}{untimed}", pass.name, self.views[pass.view.0].name)?;
        writeln!(f, "  {}", pass.purpose)?;
        if let Some(target) = &pass.color {
            let load = target.clear.map_or("kept".to_owned(), |value| format!("cleared to {value:?}"));
            writeln!(f, "  color: {} layer {}, {load}", self.name_of(target.attachment), target.layer)?;
        }
        if let Some(target) = &pass.depth_stencil {
            self.fmt_depth_stencil(f, target)?;
        }
        if let Some([left, top, columns, rows]) = pass.scissor {
            writeln!(f, "  only {columns}x{rows} pixels from {left},{top}")?;
        }
        if let Some(Viewport { area: [left, top, width, height], depth: [near, far] }) = pass.own_viewport() {
            writeln!(f, "  viewport {width}x{height} from {left},{top}, depths {near} to {far}")?;
        }
        if let Some(recorded) = &pass.recorded {
            if !recorded.groups.is_empty() {
                writeln!(f, "  in {}", recorded.groups.join(" / "))?;
            }
            if recorded.darkens {
                writeln!(f, "  takes light away where the stencil test passes")?;
            }
        }
        if let Some(image) = &pass.image {
            writeln!(f, "  image made on the CPU: {}", image.name)?;
        }
        pass.draws.iter().try_for_each(|draw| self.fmt_draw(f, draw))
    }

    fn fmt_depth_stencil(&self, f: &mut Formatter<'_>, target: &DepthStencilTarget) -> fmt::Result {
        let depth = target.clear_depth.map_or("kept".to_owned(), |value| format!("cleared to {value}"));
        let stencil = target.clear_stencil.map_or("kept".to_owned(), |value| format!("cleared to {value}"));
        let name = self.name_of(target.attachment);
        writeln!(f, "  depth-stencil: {name} layer {}, depth {depth}, stencil {stencil}", target.layer)
    }

    fn fmt_draw(&self, f: &mut Formatter<'_>, draw: &Draw) -> fmt::Result {
        let program = match draw.program {
            Program::Position => "position",
            Program::Flat => "one colour",
            Program::FlatLabel => "one label",
            Program::Count => "count",
            Program::Ambient { from_near: false } => "ambient",
            Program::Ambient { from_near: true } => "ambient from the near plane on",
            Program::Light(_) => "light",
            Program::AmbientDiffuse => "light whatever stands between",
            Program::Label(_) => "label",
            Program::Arriving(_) => "visibility",
            Program::Through => "darkened",
            Program::Recorded { .. } => "another program",
        };
        let by = match draw.program.visibility() {
            None | Some(Visibility::Everywhere) => "",
            Some(Visibility::Map) => " through the map",
            Some(Visibility::Labels) => " where labels say so",
            Some(Visibility::Count) => " where the count is zero",
            Some(Visibility::ReceiverTexture) => " through the receiver's texture",
            Some(Visibility::Projected) => " through projected silhouettes",
        };
        let range = &draw.triangles;
        writeln!(
            f,
            "  draw {} [{}] by {program}{by}, mesh {} triangles {range:?}",
            draw.name,
            draw.part.name(),
            draw.mesh.0
        )?;
        for light in &draw.samples_maps_of {
            writeln!(f, "    samples the map of {}", light.name())?;
        }
        if let Some(DrawPieces { mesh, triangles, .. }) = &draw.pieces {
            writeln!(f, "    the rasteriser is given mesh {} triangles {triangles:?}", mesh.0)?;
        }
        if draw.discards_unknown(&self.meshes[draw.mesh.0]) {
            writeln!(f, "    its shader may discard fragments")?;
        }
        if draw.faces_inwards {
            writeln!(f, "    its triangles face into the volume")?;
        }
        if draw.base_vertex > 0 {
            writeln!(f, "    {} added to every index", draw.base_vertex)?;
        }
        let DrawConstants { label, flat, count, layer, texture, .. } = draw.constants;
        match draw.program {
            Program::Label(_) | Program::FlatLabel => writeln!(f, "    label {label}")?,
            Program::Flat => writeln!(f, "    colour {flat:?}")?,
            Program::Count => writeln!(f, "    front faces count {count}")?,
            _ => {}
        }
        if let Some((TextureId(index), texture)) = texture.and_then(|id| Some((id, self.textures.get(id.0)?))) {
            let [width, height] = texture.picture.size();
            let beyond = if texture.clamps { "clamped" } else { "repeated" };
            writeln!(f, "    texture {index}: {}, {width}x{height}, {beyond}", texture.picture.name())?;
        }
        if let Some(layer) = layer {
            writeln!(f, "    own layer {layer}")?;
        }
        write!(f, "{}", draw.raster)
    }

    fn name_of(&self, id: AttachmentId) -> &str {
        self.attachments.get(id.0).map_or("missing", |attachment| &attachment.name)
    }
}

impl Display for RasterState {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let write = if self.depth_write { "written" } else { "kept" };
        let clamped = if self.unclipped_depth { ", clamped" } else { "" };
        writeln!(f, "    depth {:?}, {write}{clamped}", self.depth_compare)?;
        if self.depth_bias != wgpu_types::DepthBiasState::default() {
            let bias = &self.depth_bias;
            writeln!(f, "    depth bias {} steps, {} slopes", bias.constant, bias.slope_scale)?;
        }
        if self.stencil.is_enabled() {
            let FaceMasks { reference, read, write } = self.face(true).1;
            writeln!(f, "    stencil reference {reference}, read {read:#x}, write {write:#x}")?;
            fmt_face(f, "front", &self.stencil.front)?;
            fmt_face(f, "back", &self.stencil.back)?;
            if let Some(FaceMasks { reference, read, write }) = self.back {
                writeln!(f, "      back: reference {reference}, read {read:#x}, write {write:#x}")?;
            }
        }
        if self.front_face == wgpu_types::FrontFace::Cw {
            writeln!(f, "    front faces run clockwise")?;
        }
        if let Some(face) = self.cull {
            writeln!(f, "    {face:?} faces culled")?;
        }
        match self.color {
            ColorWrite::None => Ok(()),
            ColorWrite::Replace => writeln!(f, "    color replaced"),
            ColorWrite::Add => writeln!(f, "    color added"),
            ColorWrite::Multiply => writeln!(f, "    color multiplied"),
            ColorWrite::Minimum => writeln!(f, "    the smaller color kept"),
            ColorWrite::Blend => writeln!(f, "    color blended"),
        }
    }
}

fn fmt_face(f: &mut Formatter<'_>, name: &str, face: &StencilFace) -> fmt::Result {
    let (fail, depth_fail, pass) = (face.fail_op, face.depth_fail_op, face.pass_op);
    writeln!(f, "      {name}: {:?}; fail {fail:?}, depth fail {depth_fail:?}, pass {pass:?}", face.compare)
}

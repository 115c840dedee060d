//! Pictures of what casters let through, with one layer for each receiver or each caster of a light.

use super::frame::FrameBuilder;
use super::settings::TextureSettings;
use crate::geometry::relative;
use crate::plan::{
    Attachment, AttachmentRole, Blob, ColorTarget, ColorWrite, Draw, DrawConstants, DrawMesh, DrawPart, LightId, Pass,
    PlanMap, PlanView, Program, RasterState, ViewId,
};
use crate::scene::Material;
use glam::{DMat4, Mat4};
use wgpu_types::{CompareFunction, TextureFormat};

/// The clear value of a layer: texels that let all of the light through.
const ALL_OF_IT: [f64; 4] = [1.0; 4];

/// The pass that draws casters into one layer of a light's texture array.
pub struct LayerPass {
    pub layer: usize,
    pub name: String,
    pub draws: Vec<Draw>,
}

/// Gives a light a texture array with a layer for each name and matrix (clip space from world space), and adds a pass
/// for each layer that is drawn. The other layers let all of the light through.
pub fn add_map(
    frame: &mut FrameBuilder,
    light: LightId,
    settings: &TextureSettings,
    layer_names: Vec<String>,
    clip_from_world: Vec<DMat4>,
    passes: Vec<LayerPass>,
    purpose: &str,
) {
    let attachment = frame.add_attachment(Attachment {
        name: format!("{} textures", light.name()),
        role: AttachmentRole::Map(light),
        format: TextureFormat::Rgba8Unorm,
        size: [settings.size; 2],
        layers: clip_from_world.len() as u32,
        depth_bits: None,
    });
    let world_from_relative = DMat4::from_translation(frame.eye());
    let clip_from_relative: Vec<Mat4> =
        clip_from_world.iter().map(|clip| (*clip * world_from_relative).as_mat4()).collect();
    let mut faces = vec![None; clip_from_world.len()];
    for LayerPass { layer, name, draws } in passes {
        frame.plan.views.push(PlanView {
            name: format!("{} {name}", light.name()),
            origin: frame.eye(),
            eye: PlanView::at_origin(),
            clip_from_relative: clip_from_relative[layer],
        });
        let view = ViewId(frame.plan.views.len() - 1);
        faces[layer] = Some(view);
        frame.plan.passes.push(Pass {
            name,
            image: None,
            viewport: None,
            recorded: None,
            scissor: None,
            purpose: purpose.to_owned(),
            light: Some(light),
            timed: true,
            view,
            color: Some(ColorTarget { attachment, layer: layer as u32, clear: Some(ALL_OF_IT) }),
            depth_stencil: None,
            draws,
        });
    }
    frame.plan.lights[light.0].map = Some(PlanMap {
        attachment,
        faces,
        light_from_world: DMat4::IDENTITY,
        clip_from_light: clip_from_world,
        clip_from_relative,
        layer_names,
        lookup: None,
        projects_backwards: settings.projects_backwards,
        repeats_edge: settings.repeats_edge,
        is_cached: settings.keeps,
    });
}

/// Returns draws of those of a caster's triangles whose indices are in `of`, as a silhouette without depth test: one
/// for each group that has any, whose mesh is added to the plan.
pub fn draws(frame: &mut FrameBuilder, caster: usize, of: &[u32]) -> Vec<Draw> {
    let placed = &frame.placed[caster];
    let (object, triangles) = (placed.object, placed.object.mesh.triangles());
    let eye = frame.eye();
    let vertices = match placed.surface {
        Some(mesh) => frame.plan.meshes[mesh.0].vertices.clone(),
        None => Blob::new(placed.world.iter().map(|position| relative::point(*position, eye)).collect()),
    };
    let mut draws = Vec::new();
    for group in object.mesh.groups() {
        let is_of_group = |triangle: &u32| group.triangles.contains(&(*triangle as usize));
        let own: Vec<u32> = of.iter().copied().filter(is_of_group).collect();
        if own.is_empty() {
            continue;
        }
        let indices = Blob::new(own.iter().flat_map(|triangle| triangles[*triangle as usize]).collect());
        let name = format!("silhouette of {}", object.name);
        let mesh = frame.add_mesh(DrawMesh::of_blobs(name, vertices.clone(), indices));
        draws.push(Draw {
            name: object.name.clone(),
            caster: Some(object.name.clone()),
            part: DrawPart::Map,
            program: Program::Flat,
            raster: RasterState {
                depth_compare: CompareFunction::Always,
                depth_write: false,
                // Whichever face is drawn first, and however many: a caster lets light through once.
                color: ColorWrite::Minimum,
                ..RasterState::surface()
            },
            mesh,
            triangles: 0..own.len() as u32,
            base_vertex: 0,
            pieces: None,
            faces_inwards: false,
            constants: DrawConstants {
                flat: let_through(&group.material.unwrap_or(object.material)),
                ..DrawConstants::default()
            },
            samples_maps_of: Vec::new(),
        });
    }
    draws
}

/// Returns the share of red, green and blue light that a material transmits, and 0 as the share for labels, which take
/// translucent casters for opaque.
fn let_through(material: &Material) -> [f32; 4] {
    let brightest = material.color.iter().copied().fold(0.0, f32::max);
    // Black has no colour of its own: it takes from all channels alike.
    let tint = |channel: f32| if brightest > 0.0 { channel / brightest } else { 1.0 };
    let [r, g, b] = material.color.map(|channel| (1.0 - material.opacity) * tint(channel));
    [r, g, b, 0.0]
}

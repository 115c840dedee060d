//! Plans in clip space, of passes that draw depth and stencil alone.

use glam::{DVec3, Mat4};
use std::collections::BTreeMap;
use stencilscope::math::depth::DepthCurve;
use stencilscope::plan::{
    Attachment, AttachmentId, AttachmentRole, DepthStencilTarget, Draw, DrawMesh, FramePlan, Pass, PlanView, ViewId,
};
use wgpu::{StencilOperation, TextureFormat};

/// All operations of a stencil.
pub const OPERATIONS: [StencilOperation; 8] = [
    StencilOperation::Keep,
    StencilOperation::Zero,
    StencilOperation::Replace,
    StencilOperation::Invert,
    StencilOperation::IncrementClamp,
    StencilOperation::DecrementClamp,
    StencilOperation::IncrementWrap,
    StencilOperation::DecrementWrap,
];

/// A pass over the one attachment, which it clears to a depth and a stencil or loads.
pub fn pass(name: &str, clear: Option<(f32, u8)>, draws: Vec<Draw>) -> Pass {
    Pass {
        name: name.to_owned(),
        image: None,
        viewport: None,
        recorded: None,
        scissor: None,
        purpose: String::new(),
        light: None,
        timed: true,
        view: ViewId(0),
        color: None,
        depth_stencil: Some(DepthStencilTarget {
            attachment: AttachmentId(0),
            layer: 0,
            clear_depth: clear.map(|(depth, _)| depth),
            clear_stencil: clear.map(|(_, stencil)| stencil),
        }),
        draws,
    }
}

/// A frame of such passes, seen by a view that leaves vertices where they are.
pub fn plan(
    technique: &str,
    depth: DepthCurve,
    (format, size): (TextureFormat, [u32; 2]),
    meshes: Vec<DrawMesh>,
    passes: Vec<Pass>,
) -> FramePlan {
    FramePlan {
        depth,
        wraps_diffuse: false,
        ambient_diffuse: 0.0,
        technique: technique.to_owned(),
        settings: BTreeMap::new(),
        size,
        attachments: vec![Attachment {
            name: "depth and stencil".to_owned(),
            role: AttachmentRole::DepthStencil,
            format,
            size,
            layers: 1,
            depth_bits: None,
        }],
        views: vec![PlanView {
            name: "camera".to_owned(),
            origin: DVec3::ZERO,
            eye: PlanView::at_origin(),
            clip_from_relative: Mat4::IDENTITY,
        }],
        lights: Vec::new(),
        ambient: [0.0; 3],
        meshes,
        textures: Vec::new(),
        passes,
        left_out: Vec::new(),
    }
}

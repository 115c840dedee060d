//! A pool of attachments' textures, handed out again from plan to plan.
//!
//! A frame that is set up anew, as a light moves, draws into textures like those of the frame before. New ones cost a
//! page fault for every page that is drawn to; those of an earlier plan exist already. What they contain does not
//! matter: only those are handed out again that the first pass which draws to them clears. Where the frames of several
//! plans run in turn, one after the other, they can so have the same textures at once.

use crate::plan::{AttachmentId, FramePlan, Pass};
use std::sync::Arc;
use wgpu::{Device, Texture, TextureFormat};

/// Everything that a texture is created from; textures with equal descriptors can replace each other.
type AttachmentKey = wgpu_types::TextureDescriptor<Option<String>, Vec<TextureFormat>>;

/// The most bytes of a texture that the pool keeps; larger textures are freed with their plan.
const MOST_BYTES_POOLED: u64 = 1 << 26;

/// The attachment textures of the newest plan, pooled so that the next plan can use them again; a shared pool has those of
/// all plans.
#[derive(Debug, Default)]
pub struct AttachmentPool {
    pooled: Vec<(AttachmentKey, Arc<Texture>)>,
    /// Whether plans that are prepared at the same time get the same textures.
    is_shared: bool,
}

impl AttachmentPool {
    /// Returns a pool for plans whose frames run in turn, never at once: its textures are handed out to all of them, and
    /// live as long as it does.
    pub fn shared() -> AttachmentPool {
        AttachmentPool { is_shared: true, ..AttachmentPool::default() }
    }

    /// Returns how many bytes of the attachments that a frame's timed passes draw to can be shared with other plans.
    pub fn shared_bytes(plan: &FramePlan) -> u64 {
        let draws_to = |id| plan.passes.iter().any(|pass| pass.timed && pass.targets().any(|target| target == id));
        let is_shared = |id: &AttachmentId| draws_to(*id) && plan.cache_key(*id).is_none() && may_hand_on(plan, *id);
        let shared = (0..plan.attachments.len()).map(AttachmentId).filter(is_shared);
        shared.map(|id| plan.attachment_bytes(id)).sum()
    }

    /// Returns a texture for each attachment of a plan, none of which another plan uses, unless the pool is shared; where
    /// `given` has one, that one. Textures of the last plan that this one can't use are freed first.
    pub(super) fn hand_out<'a>(
        &mut self,
        device: &Device,
        plan: &FramePlan,
        given: &[Option<Arc<Texture>>],
        describe: impl Fn(AttachmentId) -> wgpu::TextureDescriptor<'a>,
    ) -> Vec<Arc<Texture>> {
        let owned = |id| {
            let wanted = describe(id);
            wanted.map_label_and_view_formats(|label| label.map(str::to_owned), |formats| formats.to_vec())
        };
        let ids = || (0..plan.attachments.len()).map(AttachmentId);
        let mut left = std::mem::take(&mut self.pooled);
        if !self.is_shared {
            left.retain(|(_, texture)| Arc::strong_count(texture) == 1);
        }
        let mut free = |id: AttachmentId| {
            let wanted = owned(id);
            let found = left.iter().position(|(made, _)| *made == wanted)?;
            Some(left.swap_remove(found).1)
        };
        let may_cache: Vec<bool> = ids().map(|id| given[id.0].is_none() && may_hand_on(plan, id)).collect();
        let mut found: Vec<Option<Arc<Texture>>> = given.to_vec();
        ids().filter(|id| may_cache[id.0]).for_each(|id| found[id.0] = free(id));
        if !self.is_shared {
            left.clear();
        }
        self.pooled = left;
        let create = |id| Arc::new(device.create_texture(&describe(id)));
        let textures: Vec<Arc<Texture>> = ids().map(|id| found[id.0].take().unwrap_or_else(|| create(id))).collect();
        self.pooled.extend(ids().filter(|id| may_cache[id.0]).map(|id| (owned(id), textures[id.0].clone())));
        textures
    }
}

/// Returns whether the next plan may use this attachment's texture: it is small, and nothing of the plan reads what it
/// contained before. That is not known of a frame that another program drew.
fn may_hand_on(plan: &FramePlan, id: AttachmentId) -> bool {
    let clears = |pass: &Pass| {
        let has_stencil = plan.attachment(id).format.has_stencil_aspect();
        let color = pass.color.as_ref().filter(|target| target.attachment == id);
        let depth = pass.depth_stencil.as_ref().filter(|target| target.attachment == id);
        color.is_none_or(|target| target.clear.is_some())
            && depth
                .is_none_or(|target| target.clear_depth.is_some() && (!has_stencil || target.clear_stencil.is_some()))
    };
    let first = plan.passes.iter().find(|pass| pass.targets().any(|target| target == id));
    plan.stored_layers(id) == 1
        && plan.attachment_bytes(id) <= MOST_BYTES_POOLED
        && plan.passes.iter().all(|pass| pass.recorded.is_none())
        && first.is_some_and(clears)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::GpuContext;
    use crate::math::depth::DepthMapping;
    use crate::plan::{Attachment, AttachmentRole, DepthStencilTarget, ViewId};
    use pollster::block_on;
    use std::collections::BTreeMap;

    /// A plan of one pass over a stencil of a size, which it clears or goes on from.
    fn plan(size: [u32; 2], clears: bool) -> FramePlan {
        let clear = |value: u8| clears.then_some(value);
        let depth_stencil = Some(DepthStencilTarget {
            attachment: AttachmentId(0),
            layer: 0,
            clear_depth: clear(0).map(f32::from),
            clear_stencil: clear(0),
        });
        let pass = Pass {
            name: "volumes".to_owned(),
            image: None,
            viewport: None,
            recorded: None,
            scissor: None,
            purpose: String::new(),
            light: None,
            timed: true,
            view: ViewId(0),
            color: None,
            depth_stencil,
            draws: Vec::new(),
        };
        let attachment = Attachment {
            name: "depth and stencil".to_owned(),
            role: AttachmentRole::DepthStencil,
            format: TextureFormat::Depth32FloatStencil8,
            size,
            layers: 1,
            depth_bits: None,
        };
        FramePlan {
            technique: "z-fail".to_owned(),
            settings: BTreeMap::new(),
            size,
            depth: DepthMapping::ReversedInfinite.curve(0.1, 0.0, 0.0),
            wraps_diffuse: false,
            ambient_diffuse: 0.0,
            attachments: vec![attachment],
            views: Vec::new(),
            lights: Vec::new(),
            ambient: [0.0; 3],
            meshes: Vec::new(),
            textures: Vec::new(),
            passes: vec![pass],
            left_out: Vec::new(),
        }
    }

    fn hand_out(pool: &mut AttachmentPool, context: &GpuContext, plan: &FramePlan) -> Arc<Texture> {
        let describe = |id: AttachmentId| wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: plan.size[0], height: plan.size[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: plan.attachment(id).format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        };
        pool.hand_out(&context.device, plan, &[None], describe).remove(0)
    }

    #[test]
    fn a_pool_hands_out_what_no_plan_uses_and_a_shared_one_also_what_others_do() {
        let context = block_on(GpuContext::new(None)).expect("the reference adapter");
        let [small, large, goes_on] = [plan([8, 8], true), plan([16, 8], true), plan([8, 8], false)];
        let mut own = AttachmentPool::default();
        let first = hand_out(&mut own, &context, &small);
        let second = hand_out(&mut own, &context, &small);
        assert!(!Arc::ptr_eq(&first, &second), "the first plan still draws into its own");
        let place = Arc::as_ptr(&second);
        drop(second);
        assert_eq!(Arc::as_ptr(&hand_out(&mut own, &context, &small)), place);
        hand_out(&mut own, &context, &large);
        assert_eq!(own.pooled.len(), 1, "what the newest plan has no use for is freed");

        let mut shared = AttachmentPool::shared();
        let [one, other] = [&small, &small].map(|plan| hand_out(&mut shared, &context, plan));
        assert!(Arc::ptr_eq(&one, &other));
        let larger = hand_out(&mut shared, &context, &large);
        assert!(!Arc::ptr_eq(&one, &larger));
        assert!(Arc::ptr_eq(&one, &hand_out(&mut shared, &context, &small)), "it lives as long as the pool");
        assert!(!Arc::ptr_eq(&one, &hand_out(&mut shared, &context, &goes_on)), "what was there before shows");
        assert_eq!([&small, &goes_on].map(AttachmentPool::shared_bytes), [small.attachment_bytes(AttachmentId(0)), 0]);
        assert!(AttachmentPool::shared_bytes(&large) > AttachmentPool::shared_bytes(&small));
    }
}

//! What a light's map is made from: equal inputs make equal texels, so a map may be cached from frame to frame.

use super::{Attachment, AttachmentId, Draw, FramePlan, Pass, RasterisedTriangles};
use foldhash::quality::FixedState;
use std::hash::{BuildHasher, Hash, Hasher};

impl FramePlan {
    /// Returns a hash of all that decides an attachment's content at the end of the frame, stable within a process
    /// only. `None` if the plan does not cache the attachment, or if a pass into it does more than draw by position or
    /// in one colour.
    pub fn cache_key(&self, id: AttachmentId) -> Option<u64> {
        let map = self.map_in(id)?;
        if !map.is_cached {
            return None;
        }
        let mut hasher = FixedState::default().build_hasher();
        let Attachment { name: _, role: _, format, size, layers, depth_bits } = self.attachment(id);
        (format, size, layers, depth_bits).hash(&mut hasher);
        for pass in self.passes.iter().filter(|pass| pass.targets().any(|target| target == id)) {
            if pass.image.is_some() || pass.targets().any(|target| target != id) {
                return None;
            }
            self.hash_pass(pass, &mut hasher)?;
        }
        Some(hasher.finish())
    }

    fn hash_pass(&self, pass: &Pass, hasher: &mut impl Hasher) -> Option<()> {
        let bits = |value: f64| value.to_bits();
        let color = pass.color.as_ref().map(|target| (target.layer, target.clear.map(|clear| clear.map(bits))));
        let depth = pass.depth_stencil.as_ref();
        let depth = depth.map(|target| (target.layer, target.clear_depth.map(f32::to_bits), target.clear_stencil));
        (color, depth).hash(hasher);
        let clip_from_relative = self.views[pass.view.0].clip_from_relative.to_cols_array();
        clip_from_relative.map(f32::to_bits).hash(hasher);
        pass.draws.iter().try_for_each(|draw| self.hash_draw(draw, hasher))
    }

    fn hash_draw(&self, draw: &Draw, hasher: &mut impl Hasher) -> Option<()> {
        // Shaders that are not flat read more than this hash covers.
        if !draw.program.is_flat() {
            return None;
        }
        let RasterisedTriangles { mesh, triangles, base_vertex } = draw.rasterised();
        (draw.program, &draw.raster, triangles, base_vertex).hash(hasher);
        draw.constants.flat.map(f32::to_bits).hash(hasher);
        self.meshes[mesh.0].blobs().hash(hasher);
        Some(())
    }
}

impl Pass {
    /// Returns the attachments that the pass draws into: colour first, then depth-stencil, each if it has one.
    pub(crate) fn targets(&self) -> impl Iterator<Item = AttachmentId> {
        let color = self.color.iter().map(|target| target.attachment);
        color.chain(self.depth_stencil.iter().map(|target| target.attachment))
    }
}

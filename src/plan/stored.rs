//! Which layers of an attachment take memory: faces that a map leaves out take none.

use super::{Attachment, AttachmentId, FramePlan, PlanMap};

impl PlanMap {
    /// Returns the layer of a face in the map's texture, which stores only faces that are drawn; `None` for a face that
    /// is left out or does not exist.
    pub fn stored_layer(&self, face: u32) -> Option<u32> {
        let before = self.faces.get(..=face as usize)?;
        before.last()?.map(|_| before.iter().flatten().count() as u32 - 1)
    }
}

impl FramePlan {
    /// Returns the light's map that is stored in an attachment; `None` for other attachments.
    pub(crate) fn map_in(&self, id: AttachmentId) -> Option<&PlanMap> {
        self.lights.iter().filter_map(|light| light.map.as_ref()).find(|map| map.attachment == id)
    }

    /// Returns the layer of an attachment's texture that stores `layer`; `None` where that is left out.
    pub fn stored_layer(&self, id: AttachmentId, layer: u32) -> Option<u32> {
        match self.map_in(id) {
            Some(map) => map.stored_layer(layer),
            None => Some(layer),
        }
    }

    /// Returns the number of layers of an attachment's texture: of a light's map only the faces that are drawn (at
    /// least one), else as many as the attachment has.
    ///
    /// # Panics
    /// If the id is of another plan.
    pub fn stored_layers(&self, id: AttachmentId) -> u32 {
        let drawn = |map: &PlanMap| (map.faces.iter().flatten().count() as u32).max(1);
        self.map_in(id).map_or_else(|| self.attachment(id).layers, drawn)
    }

    /// Returns the number of texels in all layers of an attachment's texture.
    pub(crate) fn stored_texels(&self, id: AttachmentId) -> u64 {
        let [width, height] = self.attachment(id).size.map(u64::from);
        width * height * u64::from(self.stored_layers(id))
    }

    /// Returns how many bytes all stored texels of an attachment take; five a texel for depth with stencil. Faces of
    /// maps that are not drawn take none.
    pub(crate) fn attachment_bytes(&self, id: AttachmentId) -> u64 {
        let Attachment { format, .. } = self.attachment(id);
        // Depth32FloatStencil8 has no fixed size; drivers use four bytes and one.
        self.stored_texels(id) * u64::from(format.block_copy_size(None).unwrap_or(5))
    }
}

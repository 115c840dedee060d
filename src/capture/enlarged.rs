//! A capture of fewer pixels in the size of one of more, so that it can stand in its place for a moment.

use super::{Capture, FrameTarget, Image, Snapshot};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Enlarged images by where the originals lie in memory: what steps share stays shared.
#[derive(Default)]
struct EnlargedImages(BTreeMap<*const Image, Arc<Image>>);

impl EnlargedImages {
    fn replace(&mut self, image: &mut Arc<Image>, size: [u32; 2]) {
        let enlarged = self.0.entry(Arc::as_ptr(image)).or_insert_with(|| Arc::new(image.enlarged(size)));
        *image = Arc::clone(enlarged);
    }
}

impl Capture {
    /// Returns the capture with pictures of `size` pixels: each pixel has what the one of this capture has in which its
    /// middle lies. Maps stay as they are; states after draws and truths, which previews have none of, are dropped.
    #[must_use]
    pub fn enlarged(&self, size: [u32; 2]) -> Capture {
        let mut enlarged = EnlargedImages::default();
        let mut capture = Capture { size, ..self.clone() };
        for step in &mut capture.steps {
            step.draws.iter_mut().for_each(|draw| draw.after = None);
            if let Snapshot::Frame(frame) = &mut step.snapshot {
                let aspects = [&mut frame.color, &mut frame.depth].into_iter().chain(&mut frame.stencil);
                aspects.for_each(|aspect| enlarged.replace(&mut aspect.image, size));
            }
        }
        for light in &mut capture.lights {
            light.truth = None;
            for target in FrameTarget::ALL {
                light.target_mut(target).into_iter().for_each(|image| enlarged.replace(image, size));
            }
        }
        capture
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::PixelFormat;

    #[test]
    fn each_pixel_has_what_the_one_in_its_place_has() {
        let small = Image::packed(PixelFormat::U8, [2, 2], vec![1, 2, 3, 4]);
        let rows = |image: &Image| image.rows().map(<[u8]>::to_vec).collect::<Vec<_>>();
        assert_eq!(rows(&small.enlarged([4, 2])), [[1, 1, 2, 2], [3, 3, 4, 4]]);
        // Of an odd side, the last pixel has what is left.
        assert_eq!(rows(&small.enlarged([3, 3])), [[1, 2, 2], [3, 4, 4], [3, 4, 4]]);
        let wide = Image::packed(PixelFormat::Rgba8, [1, 2], vec![1, 2, 3, 4, 5, 6, 7, 8]);
        assert_eq!(rows(&wide.enlarged([2, 2])), [[1, 2, 3, 4, 1, 2, 3, 4], [5, 6, 7, 8, 5, 6, 7, 8]]);
    }
}

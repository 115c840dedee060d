//! What a step or a draw wrote: the one picture that stands for it, as in the list of passes and in animations of a
//! frame.

use super::counts;
use super::depth::{DepthMeasure, DepthScale};
use super::layers::MapContent;
use crate::capture::{Capture, FrameSnapshot, FrameTarget, Image, PixelFormat, Snapshot};
use crate::picture::Picture;
use crate::picture::colors::{self, Rgb};
use std::sync::Arc;

/// The one picture that represents what a step or a draw wrote.
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenAspects {
    /// Its texels after the step or draw.
    pub image: Arc<Image>,
    /// The meaning of its texels.
    pub content: TexelContent,
    /// Its name in a word or two: `stencil`.
    pub name: &'static str,
}

/// What a picture's texels mean, and so how they are coloured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TexelContent {
    /// sRGB bytes.
    Color,
    /// Shares of light that are let through, linear bytes.
    LetThrough,
    /// Stencil values.
    Stencil,
    /// Signed counts in floats.
    Count,
    /// A light's labels: lit, in shadow, background, facing away.
    Labels,
    /// Which share of a light arrives, 0 to 1.
    Visibility,
    /// Stored depths.
    Depth(DepthMeasure),
}

impl TexelContent {
    /// Returns what the texels of a light's target mean; `None` for the picture.
    fn of_target(target: FrameTarget) -> Option<TexelContent> {
        match target {
            FrameTarget::Picture => None,
            FrameTarget::Labels => Some(TexelContent::Labels),
            FrameTarget::Count => Some(TexelContent::Count),
            FrameTarget::Visibility => Some(TexelContent::Visibility),
        }
    }
}

impl WrittenAspects {
    fn new(image: &Arc<Image>, content: TexelContent) -> WrittenAspects {
        let name = match content {
            TexelContent::Color => "colour",
            TexelContent::LetThrough => "light that comes through",
            TexelContent::Stencil => "stencil",
            TexelContent::Count => "count",
            TexelContent::Labels => "mask",
            TexelContent::Visibility => "visibility",
            TexelContent::Depth(_) => "depth",
        };
        WrittenAspects { image: Arc::clone(image), content, name }
    }

    /// Returns what a step wrote: its map layer, its finished count, its mask, or the first of colour, stencil and
    /// depth that it changed; `None` where it changed none.
    pub fn by_step(capture: &Capture, index: usize) -> Option<WrittenAspects> {
        let step = capture.steps.get(index)?;
        match &step.snapshot {
            Snapshot::Map { light, face } => {
                let map = capture.lights.get(*light)?.map.as_ref()?;
                Some(WrittenAspects::layer(capture, [*light, *face], map.faces.get(*face)?))
            }
            Snapshot::Frame(frame) => match frame.target {
                FrameTarget::Picture => WrittenAspects::aspect(capture, frame),
                FrameTarget::Count => counts::finished_by(capture, index)
                    .map(|(_, count)| WrittenAspects::new(count, TexelContent::Count)),
                target @ (FrameTarget::Labels | FrameTarget::Visibility) => {
                    let image = capture.lights.get(step.light?)?.target(target)?;
                    Some(WrittenAspects::new(image, TexelContent::of_target(target)?))
                }
            },
        }
    }

    /// Returns what a draw wrote: its map layer, counts or labels, or the first of colour, stencil and depth that it
    /// changed; `None` where it changed nothing, or the state after it is not known.
    pub fn by_draw(capture: &Capture, step: usize, draw: usize) -> Option<WrittenAspects> {
        let after = capture.steps.get(step)?.draws.get(draw)?.after.as_ref()?;
        let target = after.target.as_ref().filter(|target| !target.unchanged).map(|target| &target.image);
        match &after.snapshot {
            Snapshot::Map { light, face } => Some(WrittenAspects::layer(capture, [*light, *face], target?)),
            Snapshot::Frame(frame) => match frame.target {
                FrameTarget::Picture => WrittenAspects::aspect(capture, frame),
                of_light => Some(WrittenAspects::new(target?, TexelContent::of_target(of_light)?)),
            },
        }
    }

    /// Returns the picture of a layer of a light's map, as light that is let through or as depths; the two indices are
    /// the light's and the layer's.
    fn layer(capture: &Capture, [light, face]: [usize; 2], image: &Arc<Image>) -> WrittenAspects {
        let content = match image.format() {
            PixelFormat::Rgba8 => TexelContent::LetThrough,
            _ => TexelContent::Depth(DepthMeasure::of_map(capture, light, face).unwrap_or(DepthMeasure::Raw)),
        };
        let name = MapContent::of(capture, light).map_or("map", MapContent::whole);
        WrittenAspects { name, ..WrittenAspects::new(image, content) }
    }

    fn aspect(capture: &Capture, frame: &FrameSnapshot) -> Option<WrittenAspects> {
        let stencil = frame.stencil.as_ref().filter(|stencil| !stencil.unchanged);
        if !frame.color.unchanged {
            Some(WrittenAspects::new(&frame.color.image, TexelContent::Color))
        } else if let Some(stencil) = stencil {
            Some(WrittenAspects::new(&stencil.image, TexelContent::Stencil))
        } else {
            let content = TexelContent::Depth(DepthMeasure::of_camera(capture));
            (!frame.depth.unchanged).then(|| WrittenAspects::new(&frame.depth.image, content))
        }
    }

    /// Returns the texels in display colours, one pixel for each; depths from near (light) to far (dark) over the
    /// image's own range.
    pub fn picture(&self) -> Picture {
        let image = &self.image;
        let in_color = |color: &dyn Fn([u32; 2]) -> Option<Rgb>| {
            Picture::drawn(image.size(), |at| color(at).unwrap_or(colors::NOTHING))
        };
        let rgb = |at| image.rgba_at(at).map(|[red, green, blue, _]| [red, green, blue]);
        match self.content {
            TexelContent::Color => in_color(&rgb),
            TexelContent::LetThrough => in_color(&|at| rgb(at).map(colors::linear)),
            TexelContent::Stencil => in_color(&|at| image.byte_at(at).map(colors::stencil)),
            TexelContent::Count => in_color(&|at| image.value_at(at).map(colors::count)),
            TexelContent::Labels => in_color(&|at| image.byte_at(at).map(colors::label)),
            TexelContent::Visibility => in_color(&|at| image.value_at(at).map(colors::visibility)),
            TexelContent::Depth(measure) => {
                let scale = DepthScale { measure, range: measure.range_of(image).unwrap_or([0.0, 1.0]) };
                in_color(&|at| scale.place(image.depth_at(at)?).map(colors::near_far))
            }
        }
    }
}

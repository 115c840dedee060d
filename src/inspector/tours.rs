//! The stops of every guided tour: their text, and what the panels show meanwhile.

use crate::inspector::action::Overlay;
use crate::inspector::action::PanelKind;
use crate::reading::picture_view::PictureKind;
use crate::technique::Technique;

/// One thing that a stop of a tour does to scene, technique or panels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TourMove {
    /// Opens a built-in scene, if another one is open.
    Scene(&'static str),
    /// Switches to another technique at this stop.
    Technique(Technique),
    /// Goes to the first pass.
    First,
    /// Goes to the last pass.
    Last,
    /// Goes to the first pass whose name contains this word.
    Step(&'static str),
    /// Shows this kind of picture.
    Picture(PictureKind),
    /// Shows this tab.
    Panel(PanelKind),
    /// Shows this overlay over the picture, and no other.
    Over(Overlay),
    /// Picks a pixel in shadow.
    PickShadow,
    /// Picks a pixel in light.
    PickLit,
    /// Picks a pixel that is wrong, or else one in shadow.
    PickWrong,
}

/// One stop of a tour.
#[derive(Debug)]
pub struct TourStop {
    /// A short title.
    pub title: &'static str,
    /// Text of two or three sentences.
    pub text: &'static str,
    /// What the stop does to the panels, in order.
    pub go: &'static [TourMove],
}

impl TourStop {
    /// Returns the technique that is used at this stop: the first that its moves name, otherwise that of `tour`.
    pub fn technique(&self, tour: &Tour) -> Technique {
        let own =
            self.go.iter().find_map(|go| if let TourMove::Technique(technique) = go { Some(*technique) } else { None });
        own.unwrap_or(tour.technique)
    }
}

/// A guided tour of a technique: stops with a short text, each of which sets up the inspector's panels.
#[derive(Debug)]
pub struct Tour {
    /// The technique.
    pub technique: Technique,
    /// What the user knows after it.
    pub promise: &'static str,
    /// The stops, in order.
    pub stops: &'static [TourStop],
}

use PanelKind::{Explain, Pixel, State as StateTab};
use TourMove::{First, Last, Over, PickLit, PickShadow, PickWrong, Picture, Scene, Step};

const fn stop(title: &'static str, text: &'static str, go: &'static [TourMove]) -> TourStop {
    TourStop { title, text, go }
}

/// Returns the index and the tour of a technique; `None` where it has none.
pub fn tour_of(technique: Technique) -> Option<(usize, &'static Tour)> {
    TOURS.iter().enumerate().find(|(_, tour)| tour.technique == technique)
}

/// One tour for each technique, in the order in which they build on each other.
pub const TOURS: [Tour; 10] = [
    Tour {
        technique: Technique::None,
        promise: "What a frame is before anything casts a shadow",
        stops: &[
            stop(
                "Ambient light and depth",
                "The first pass draws every surface in a little light that comes from everywhere, and leaves in the depth buffer how far the nearest surface is. Every technique begins like this.",
                &[Scene("rings"), First, Picture(PictureKind::Color), TourMove::Panel(Explain)],
            ),
            stop(
                "How far everything is",
                "This is that depth buffer, shown as distance: light is near. What comes later never draws a surface twice at the same place: it asks this buffer who is seen.",
                &[First, Picture(PictureKind::Depth), TourMove::Panel(Explain)],
            ),
            stop(
                "Light without shadow",
                "The light's own pass adds what it sends to every surface that faces it, whatever stands between. Choose Error to see how much of the picture is wrong that way.",
                &[Last, Picture(PictureKind::Error), TourMove::Panel(Explain)],
            ),
        ],
    },
    Tour {
        technique: Technique::Planar,
        promise: "A caster drawn flat onto the floor, and where that fails",
        stops: &[
            stop(
                "A floor that catches shadows",
                "Planar shadows know one kind of receiver: a plane. Its pixels are marked in the stencil buffer first, so that no shadow hangs over its edge.",
                &[Scene("rings"), Step("receivers"), Picture(PictureKind::Stencil), TourMove::Panel(Explain)],
            ),
            stop(
                "Casters pressed flat",
                "A matrix made of the plane and the light carries every vertex along its ray to the plane. The stencil test lets each pixel be darkened once, however many triangles fall on it.",
                &[Step("shadows"), Picture(PictureKind::Stencil), TourMove::Panel(Explain)],
            ),
            stop(
                "One pixel, event by event",
                "The history lists what was drawn at the picked pixel: the receiver marks it, a flattened triangle passes the test and raises it, the next ones fail: no double darkening.",
                &[Step("shadows"), PickShadow, TourMove::Panel(Pixel)],
            ),
            stop(
                "Where it is wrong",
                "Against the truth that rays tell: shadows on anything but planes are missing, and casters beyond the light or under the floor must be clipped away, or they throw shadows that are none.",
                &[Last, Picture(PictureKind::Error), PickWrong, TourMove::Panel(Pixel)],
            ),
        ],
    },
    Tour {
        technique: Technique::PlanarTexture,
        promise: "The same shadow, drawn into a texture of each receiver",
        stops: &[
            stop(
                "A texture for each flat piece",
                "Every flat piece of a receiver gets a picture of its own: the casters drawn as the light sees them through that piece. White lets light through, black keeps it away.",
                &[Scene("panels"), First, Picture(PictureKind::Map), TourMove::Panel(Explain)],
            ),
            stop(
                "Light, read through the texture",
                "In the light's pass a receiver looks into its own texture. No stencil is needed; the price is the texel, whose size shows at the shadow's edge.",
                &[Last, Picture(PictureKind::Color), PickShadow, TourMove::Panel(Pixel)],
            ),
            stop(
                "Its error",
                "Wrong pixels lie along edges, where a texel of the shadow covers pixels of both sides. Larger textures make them fewer: see the settings, and the report for the price.",
                &[Last, Picture(PictureKind::Error), TourMove::Panel(Explain)],
            ),
        ],
    },
    Tour {
        technique: Technique::ZPass,
        promise: "Counting volumes from the eye to the surface, and how the near plane breaks it",
        stops: &[
            stop(
                "Shadow as a volume",
                "Behind every caster lies a volume that its light can't reach. A point is in shadow exactly if it is inside one: so count how many volumes the ray from the eye enters and leaves before it meets the surface.",
                &[Scene("tori"), Step("volumes"), Picture(PictureKind::Stencil), TourMove::Panel(Explain)],
            ),
            stop(
                "Seen from beside",
                "The Scene tab is a second camera that sees the first. The shells are the volumes: sides, light caps and dark caps in their own colours; the yellow handle is the light. Drag to go round.",
                &[Step("volumes"), TourMove::Panel(PanelKind::Scene)],
            ),
            stop(
                "The count of one pixel",
                "A front face before the surface adds 1, a back face takes 1 away. The ladder shows the ray: each rung is a face, at its distance, and the number beside it is the running count.",
                &[Step("volumes"), TourMove::Panel(PanelKind::Picture), PickShadow, TourMove::Panel(Pixel)],
            ),
            stop(
                "Where it fails",
                "Here the eye is inside a volume, and the near plane cuts others: faces behind it are never drawn, so the count starts from a wrong number. Everything that is off by one is lit or dark where it should not be.",
                &[Scene("inside"), Step("volumes"), Picture(PictureKind::Stencil), TourMove::Panel(Explain)],
            ),
            stop(
                "Held against the truth",
                "The hatched pixels are wrong. Pick one: the ladder starts at the near plane with 0, although the eye is in shadow already. The Diagnosis tab says so in words, and proves the fix.",
                &[Last, Picture(PictureKind::Error), PickWrong, TourMove::Panel(Pixel)],
            ),
            stop(
                "The fix: count from the other end",
                "z-fail counts the faces behind the surface instead. No near plane lies there, so nothing is cut off, if the volumes are closed. The same scene, and no pixel is wrong.",
                &[TourMove::Technique(Technique::ZFail), Last, Picture(PictureKind::Error), TourMove::Panel(Pixel)],
            ),
        ],
    },
    Tour {
        technique: Technique::ZFail,
        promise: "Counting behind the surface: right for any camera",
        stops: &[
            stop(
                "What every pixel shows",
                "First the scene in ambient light, with its depths. The shadow's question is asked of this surface only, pixel by pixel.",
                &[Scene("tori"), First, Picture(PictureKind::Depth), TourMove::Panel(Explain)],
            ),
            stop(
                "Faces behind it",
                "Now all volumes are drawn, without colour. A back face that is hidden by the surface adds 1 to the stencil, a hidden front face takes 1 away. What is left counts the volumes that contain the surface.",
                &[Step("volumes"), Picture(PictureKind::Stencil), TourMove::Panel(Explain)],
            ),
            stop(
                "Who failed the depth test",
                "The overlay shows where faces of the volumes lie behind the surface: their depth test fails, and just there they count. Debuggers hide these hits; here they stay visible.",
                &[Step("volumes"), Picture(PictureKind::Color), Over(Overlay::Tests)],
            ),
            stop(
                "The same in the API's words",
                "The State tab has the whole state: the depth test is not changed, only what happens to the stencil where it fails: decrement for front faces, increment for back faces, both wrapping.",
                &[Step("volumes"), TourMove::Panel(StateTab)],
            ),
            stop(
                "One pixel, face by face",
                "A dark pixel: the history lists every face at it with its test and the count before and after. Failed here means counted: the face lies behind the surface.",
                &[Step("volumes"), PickShadow, TourMove::Panel(Pixel)],
            ),
            stop(
                "Light where the count is 0",
                "The light's pass tests the stencil for 0 and adds its light there. This pixel's count is 0: it lies in no volume.",
                &[Last, Picture(PictureKind::Color), PickLit, TourMove::Panel(Pixel)],
            ),
            stop(
                "No wrong pixel",
                "Against the truth: all pixels agree but for a thin band along edges, where a pixel shows both sides and is not compared.",
                &[Last, Picture(PictureKind::Error), TourMove::Panel(Explain)],
            ),
        ],
    },
    Tour {
        technique: Technique::ZPassPlus,
        promise: "How z-pass is fixed at the near plane",
        stops: &[
            stop(
                "What was cut off",
                "z-pass loses the faces before the near plane. Here an extra pass draws the casters onto the near plane as the light sees them, and so counts for every pixel how many volumes it starts in.",
                &[Scene("inside"), Step("near plane"), Picture(PictureKind::Stencil), TourMove::Panel(Explain)],
            ),
            stop(
                "Then count as z-pass does",
                "The volumes are counted in front of the surface, on top of that start.",
                &[Step("volumes"), Picture(PictureKind::Stencil), PickShadow, TourMove::Panel(Pixel)],
            ),
            stop(
                "What remains",
                "Two projections meet at the near plane, and they round differently: single pixels may leak along the cut. z-fail has no such seam.",
                &[Last, Picture(PictureKind::Error), TourMove::Panel(Explain)],
            ),
        ],
    },
    Tour {
        technique: Technique::Auto,
        promise: "Only what this scene needs, and why the rest may be left out",
        stops: &[
            stop(
                "The cheapest that is right",
                "auto looks at each light and caster: a volume that can't be cut by the near plane is counted without caps, another with the caps that it needs, and one that reaches nothing in view not at all.",
                &[Scene("tori"), Step("volumes"), Picture(PictureKind::Stencil), TourMove::Panel(Explain)],
            ),
            stop(
                "What was left out",
                "The Explain tab lists everything that was left out with its reason and its numbers. leave-out in the settings puts each back: the picture stays the same, but for single pixels at the very edge of a shadow, only slower.",
                &[Last, Picture(PictureKind::Color), TourMove::Panel(Explain)],
            ),
            stop(
                "Still no wrong pixel",
                "Held against rays, auto has no wrong pixel in any of the built-in scenes.",
                &[Last, Picture(PictureKind::Error), TourMove::Panel(Explain)],
            ),
        ],
    },
    Tour {
        technique: Technique::ShadowMap,
        promise: "Depth from the light, and what its texels cost",
        stops: &[
            stop(
                "What the light sees",
                "The casters are drawn from the light, and only depth is kept: how far the first thing is in every direction. A point light that has casters all around looks into a cube of six maps; where they fit into one view, as here, one map is enough.",
                &[Scene("table"), First, Picture(PictureKind::Map), TourMove::Panel(Explain)],
            ),
            stop(
                "Compared at every pixel",
                "Each pixel's surface point is carried into the map. If the map has something nearer, the point is in shadow. The read-out beside shows the texel that was read and both depths.",
                &[Last, Picture(PictureKind::Color), PickShadow, TourMove::Panel(Pixel)],
            ),
            stop(
                "Texel and pixel, linked",
                "The Shadow map tab marks the texel that the picked pixel reads. Hover another texel, and the pixels that read it are marked in the picture: near the light one texel serves many.",
                &[Last, PickShadow, TourMove::Panel(PanelKind::ShadowMap)],
            ),
            stop(
                "Bias",
                "A texel is one depth for a piece of surface, so a surface would shadow itself in stripes. The depth is moved by a bias: too little leaves stripes (acne), too much tears the shadow off its caster.",
                &[Last, TourMove::Panel(PanelKind::Picture), Picture(PictureKind::Mask), TourMove::Panel(Explain)],
            ),
            stop(
                "Its error",
                "Wrong pixels follow the texels along every edge. A larger map makes them fewer and the frame slower: the Report tab measures both.",
                &[Last, Picture(PictureKind::Error), PickWrong, TourMove::Panel(Pixel)],
            ),
        ],
    },
    Tour {
        technique: Technique::Projective,
        promise: "Silhouettes projected like slides, and glass that colours light",
        stops: &[
            stop(
                "A slide of each caster",
                "Each caster is drawn in black, or in its colour where it is glass, as the light sees it.",
                &[Scene("glass"), First, Picture(PictureKind::Map), TourMove::Panel(Explain)],
            ),
            stop(
                "Thrown over the scene",
                "Every surface behind it is looked up in that slide and multiplied by what it lets through: colours add up as glass over glass does.",
                &[Last, Picture(PictureKind::Color), PickShadow, TourMove::Panel(Pixel)],
            ),
            stop(
                "What it can't know",
                "A slide has no depth: what lies before the caster is darkened too, unless it is left out by hand, and a caster can't shadow itself. The hatching shows it.",
                &[Last, Picture(PictureKind::Error), PickWrong, TourMove::Panel(Pixel)],
            ),
        ],
    },
    Tour {
        technique: Technique::RayTraced,
        promise: "The truth that all others are held against",
        stops: &[
            stop(
                "A ray for every pixel",
                "From each surface point a ray goes to the light. If anything lies between, the point is in shadow. Nothing is approximated but the numbers themselves, in 64 bits.",
                &[Scene("tori"), Step("rays"), Picture(PictureKind::Mask), TourMove::Panel(Explain)],
            ),
            stop(
                "Edges",
                "Along a silhouette one pixel sees both sides. Such pixels are an edge band and not compared: no technique is blamed for a coin's toss.",
                &[Last, Picture(PictureKind::Truth), TourMove::Panel(Explain)],
            ),
            stop(
                "What it costs",
                "The report sets every technique's wrong pixels beside its milliseconds, rays included. Press Measure in the Report tab.",
                &[Last, Picture(PictureKind::Color), TourMove::Panel(PanelKind::Report)],
            ),
        ],
    },
];

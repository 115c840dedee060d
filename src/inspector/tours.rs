//! The stops of every guided tour: their text, and what the panels show meanwhile.

use crate::inspector::action::Overlay;
use crate::inspector::action::PanelKind;
use crate::inspector::action::TourSubject;
use crate::plan::DrawPart;
use crate::reading::picture_view::PictureKind;
use crate::technique::{Choice, Technique};

/// One thing that a stop of a tour does to scene, technique or panels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TourMove {
    /// Opens a built-in scene, if another one is open.
    Scene(&'static str),
    /// Switches to another technique at this stop.
    Technique(Technique),
    /// Sets a setting of the stop's technique; all others have their defaults. The tour gives all back at its end.
    Set(&'static str, &'static str),
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
    /// Frames this part of a panel: it is what the text speaks of.
    Mark(TourSubject),
    /// Shows the volume of this caster alone in the view of the scene.
    VolumeOf(&'static str),
    /// Picks a pixel in shadow.
    PickShadow,
    /// Picks a pixel in light.
    PickLit,
    /// Picks a pixel that is wrong, as soon as the truth is known; none where no pixel is.
    PickWrong,
}

/// What a stop says of the frame that it shows, so that it can be compared with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TourClaim {
    /// Compared with the truth, no pixel is wrong.
    NoneWrong,
    /// Some pixels are dark that should be lit.
    FalseShadow,
    /// Some pixels are lit that should be dark.
    MissingShadow,
    /// No pixel is dark that should be lit.
    NoFalseShadow,
    /// At most this many of ten thousand compared pixels are wrong.
    FewWrong(u64),
    /// The picked pixel is wrong.
    PickIsWrong,
    /// The picked pixel is in shadow.
    PickIsDark,
    /// The picked pixel is lit.
    PickIsLit,
    /// The selected pass draws this part of the volumes.
    Draws(DrawPart),
    /// The frame draws no such part.
    LacksPart(DrawPart),
    /// After the selected pass the stencil has other values than 0.
    StencilIsSet,
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
    /// What the text says of the frame.
    pub claims: &'static [TourClaim],
}

impl TourStop {
    /// Returns the technique that is used at this stop: the first that its moves name, otherwise that of `tour`.
    pub fn technique(&self, tour: &Tour) -> Technique {
        let own =
            self.go.iter().find_map(|go| if let TourMove::Technique(technique) = go { Some(*technique) } else { None });
        own.unwrap_or(tour.technique)
    }

    /// Returns the technique of this stop with its settings: those that its moves set, all others as by default.
    pub fn choice(&self, tour: &Tour) -> Choice {
        let mut choice = Choice::new(self.technique(tour));
        for go in self.go {
            if let Set(key, value) = go {
                let set = choice.set(key, value);
                debug_assert!(set.is_ok(), "{}: {set:?}", self.title);
            }
        }
        choice
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
use TourClaim::{
    Draws, FalseShadow, FewWrong, LacksPart, MissingShadow, NoFalseShadow, NoneWrong, PickIsDark, PickIsLit,
    PickIsWrong, StencilIsSet,
};
use TourMove::{First, Last, Mark, Over, PickLit, PickShadow, PickWrong, Picture, Scene, Set, Step, VolumeOf};
use TourSubject::{Answer, Formula, History, Ladder, LeftOut, Legend, Measure, State, Texel, Volumes};

const fn stop(title: &'static str, text: &'static str, go: &'static [TourMove]) -> TourStop {
    TourStop { title, text, go, claims: &[] }
}

impl TourStop {
    /// Returns the stop with what it says of the frame.
    const fn claims(self, claims: &'static [TourClaim]) -> TourStop {
        TourStop { claims, ..self }
    }
}

/// Returns the index and the tour of a technique; `None` where it has none.
pub fn tour_of(technique: Technique) -> Option<(usize, &'static Tour)> {
    TOURS.iter().enumerate().find(|(_, tour)| tour.technique == technique)
}

/// Returns the index of the tour after this one, and that tour; `None` after the last.
pub fn tour_after(tour: usize) -> Option<(usize, &'static Tour)> {
    Some((tour + 1, TOURS.get(tour + 1)?))
}

/// One tour for each technique, in the order in which they build on each other.
pub const TOURS: [Tour; 10] = [
    Tour {
        technique: Technique::None,
        promise: "What a frame is before anything casts a shadow",
        stops: &[
            stop(
                "Ambient light and depth",
                "The first pass draws every surface in a little light that comes from everywhere, and leaves in the depth buffer how far the nearest surface is. Light comes on top of it.",
                &[Scene("rings"), First, Picture(PictureKind::Color), TourMove::Panel(Explain), Mark(Formula)],
            ),
            stop(
                "How far everything is",
                "This is that depth buffer, shown as distance: the brighter, the nearer. What comes later asks this buffer who is seen: only the nearest surface takes light or shadow.",
                &[First, Picture(PictureKind::Depth), TourMove::Panel(Explain), Mark(Legend)],
            ),
            stop(
                "Light without shadow",
                "The light's own pass adds what it sends to every surface that faces it, whatever stands between. Error shows how much of the picture is wrong that way: every shadow is missing.",
                &[Last, Picture(PictureKind::Error), TourMove::Panel(Explain), Mark(Legend)],
            )
            .claims(&[MissingShadow, NoFalseShadow]),
        ],
    },
    Tour {
        technique: Technique::Planar,
        promise: "A caster drawn flat onto the floor, and where that fails",
        stops: &[
            stop(
                "A floor that catches shadows",
                "Planar shadows know one kind of receiver: a plane. Its pixels are marked in the stencil buffer first, so that no shadow hangs over its edge.",
                &[Scene("rings"), Step("receivers"), Picture(PictureKind::Stencil), TourMove::Panel(Explain), Mark(Legend)],
            )
            .claims(&[StencilIsSet, Draws(DrawPart::Receiver)]),
            stop(
                "Casters pressed flat",
                "A matrix made of the plane and the light carries every vertex along its ray to the plane. The stencil test lets each pixel be darkened once, however many triangles fall on it.",
                &[Step("shadows"), Picture(PictureKind::Stencil), TourMove::Panel(Explain), Mark(Formula)],
            )
            .claims(&[StencilIsSet, Draws(DrawPart::PlanarShadow)]),
            stop(
                "One pixel, event by event",
                "The history lists what was drawn at the picked pixel: the receiver marks it, a flattened triangle passes the test and raises it. Any other that falls there then fails: no double darkening.",
                &[Step("shadows"), PickShadow, TourMove::Panel(Pixel), Mark(History)],
            )
            .claims(&[PickIsDark]),
            stop(
                "Where it is right",
                "Held against the truth that rays tell: all that is darkened here is flat, and every caster was clipped to what lies between light and floor. No part of a shadow is wrong, at most a few pixels along its edge.",
                &[Last, Picture(PictureKind::Error), TourMove::Panel(Explain), Mark(Legend)],
            )
            .claims(&[FewWrong(2)]),
            stop(
                "The anti-shadow",
                "The same frame with the setting clip off. A ring beyond the light, or below the floor, is pressed onto the plane too, and throws a shadow that is none: the hatched pixels are dark and should be lit.",
                &[Set("clip", "off"), Last, Picture(PictureKind::Error), PickWrong, TourMove::Panel(Pixel), Mark(Answer)],
            )
            .claims(&[FalseShadow, PickIsWrong]),
            stop(
                "Shadows on what is not flat",
                "Stairs, balls and a wall shadow each other here. Planar shadows fall on planes alone: on the balls they are missing, and the picked pixel is lit where it should be dark.",
                &[Scene("steps"), Last, Picture(PictureKind::Error), PickWrong, TourMove::Panel(Pixel), Mark(Answer)],
            )
            .claims(&[MissingShadow, NoFalseShadow, PickIsWrong]),
        ],
    },
    Tour {
        technique: Technique::PlanarTexture,
        promise: "The same shadow, drawn into a texture of each receiver",
        stops: &[
            stop(
                "A texture for each flat piece",
                "Every flat piece of a receiver gets a picture of its own: the casters drawn as the light sees them through that piece. White lets light through, black keeps it away.",
                &[Scene("panels"), First, Picture(PictureKind::Map), TourMove::Panel(Explain), Mark(Legend)],
            ),
            stop(
                "Light, read through the texture",
                "In the light's pass a receiver looks into its own texture. No stencil is needed; the price is the texel, whose size shows at the shadow's edge.",
                &[Last, Picture(PictureKind::Color), PickShadow, TourMove::Panel(Pixel), Mark(Answer)],
            )
            .claims(&[PickIsDark]),
            stop(
                "Its error",
                "Wrong pixels lie along edges, where a texel of the shadow covers pixels of both sides. Larger textures make them fewer: see the settings, and the report for the price.",
                &[Last, Picture(PictureKind::Error), PickWrong, TourMove::Panel(Pixel), Mark(Legend)],
            )
            .claims(&[FalseShadow, MissingShadow, FewWrong(50), PickIsWrong]),
        ],
    },
    Tour {
        technique: Technique::ZPass,
        promise: "Counting volumes from the eye to the surface, and how the near plane breaks it",
        stops: &[
            stop(
                "Shadow as a volume",
                "Behind every caster lies a volume that its light can't reach. A point is in shadow exactly if it is inside one: so count the volumes that the ray from the eye has entered, and not left again, where it meets the surface.",
                &[Scene("tori"), Step("volumes"), Picture(PictureKind::Stencil), TourMove::Panel(Explain), Mark(Formula)],
            )
            .claims(&[StencilIsSet]),
            stop(
                "Seen from beside",
                "The Scene tab is a second camera that sees the first. The shells are the volumes: from each caster's silhouette, sides run away from the light. z-pass draws no more than these sides: a volume may be open where nobody counts. The sign of a sun is the light; drag beside it to go round.",
                &[Step("volumes"), TourMove::Panel(PanelKind::Scene), Mark(Volumes)],
            )
            .claims(&[Draws(DrawPart::Side), LacksPart(DrawPart::LightCap), LacksPart(DrawPart::DarkCap)]),
            stop(
                "The count of one pixel",
                "A front face before the surface adds 1, where the ray enters a volume; a back face takes 1 away, where the ray leaves it again. The ladder shows the ray: each rung is a face, at its distance, and the number beside it is the running count.",
                &[Step("volumes"), TourMove::Panel(PanelKind::Picture), PickShadow, TourMove::Panel(Pixel), Mark(Ladder)],
            )
            .claims(&[PickIsDark]),
            stop(
                "Where it fails",
                "Here the eye is inside a volume, and the near plane cuts others: faces behind it are never drawn, so the count starts from a wrong number. A pixel that should have 0 and has not is dark by mistake; one that has 0 by mistake is lit.",
                &[Scene("inside"), Step("volumes"), Picture(PictureKind::Stencil), TourMove::Panel(Explain), Mark(Legend)],
            )
            .claims(&[FalseShadow, MissingShadow]),
            stop(
                "Held against the truth",
                "The hatched pixels are wrong, and one is picked: the ladder begins to count at the near plane, as if the eye were in no volume, although it is in shadow already. The Diagnosis tab says so in words, and proves the fix.",
                &[Last, Picture(PictureKind::Error), PickWrong, TourMove::Panel(Pixel), Mark(Ladder)],
            )
            .claims(&[PickIsWrong]),
            stop(
                "The fix: count from the other end",
                "z-fail counts the faces behind the surface instead. No near plane lies there, so nothing is cut off, if the volumes are closed. The same scene, and no pixel is wrong.",
                &[TourMove::Technique(Technique::ZFail), Last, Picture(PictureKind::Error), TourMove::Panel(Pixel), Mark(Legend)],
            )
            .claims(&[NoneWrong]),
        ],
    },
    Tour {
        technique: Technique::ZFail,
        promise: "Counting behind the surface: right for any camera",
        stops: &[
            stop(
                "What every pixel shows",
                "First the scene is drawn in ambient light: this is the depth that it leaves. The shadow's question is asked of this surface only, pixel by pixel.",
                &[Scene("tori"), First, Picture(PictureKind::Depth), TourMove::Panel(Explain), Mark(Legend)],
            ),
            stop(
                "Faces behind it",
                "Now all volumes are drawn, without colour. A back face that is hidden by the surface adds 1 to the stencil, a hidden front face takes 1 away. What is left counts the volumes that contain the surface. Counting so begins at infinity, outside of every volume and where no near plane cuts anything off: wherever the eye is, it is right.",
                &[Step("volumes"), Picture(PictureKind::Stencil), TourMove::Panel(Explain), Mark(Formula)],
            )
            .claims(&[StencilIsSet, Draws(DrawPart::Side)]),
            stop(
                "What a cap is",
                "Faces behind the surface are counted up to infinity, so a volume must be closed. The light cap closes it at the caster, which it tints yellow: the triangles that face the light. The dark cap, blue, closes the far end: it lies at infinity, and Scene draws it nearer. Without caps the −1 of a front face has no +1 to cancel it.",
                &[Step("volumes"), TourMove::Panel(PanelKind::Scene), VolumeOf("blue torus"), Mark(Volumes)],
            )
            .claims(&[Draws(DrawPart::LightCap), Draws(DrawPart::DarkCap)]),
            stop(
                "Who failed the depth test",
                "The overlay shows where faces of the volumes lie behind the surface: their depth test fails, and just there they count. Debuggers hide these hits; here they stay visible.",
                &[Step("volumes"), TourMove::Panel(PanelKind::Picture), Picture(PictureKind::Color), Over(Overlay::Tests), Mark(Legend)],
            ),
            stop(
                "The same in the API's words",
                "The State tab has the whole state: the depth test is not changed, only what happens to the stencil where it fails: decrement for front faces, increment for back faces, both wrapping.",
                &[Step("volumes"), TourMove::Panel(StateTab), Mark(State)],
            ),
            stop(
                "One pixel, face by face",
                "A dark pixel: the history lists every face at it with its test and the count before and after. Failed here means counted: the face lies behind the surface.",
                &[Step("volumes"), PickShadow, TourMove::Panel(Pixel), Mark(History)],
            )
            .claims(&[PickIsDark]),
            stop(
                "The same without caps",
                "The caps are left out here, with caps = none, and the count is wrong wherever a cap lies behind the surface. Of the picked pixel's faces some are missing, so that the others do not pair up. Error shows how much that is; the next stop draws them again.",
                &[Set("caps", "none"), Last, Picture(PictureKind::Error), PickWrong, TourMove::Panel(Pixel), Mark(Ladder)],
            )
            .claims(&[FalseShadow, PickIsWrong, LacksPart(DrawPart::DarkCap), LacksPart(DrawPart::LightCap)]),
            stop(
                "Light where the count is 0",
                "The light's pass tests the stencil for 0 and adds its light there. This pixel's count was 0: it lies in no volume.",
                &[Last, Picture(PictureKind::Color), PickLit, TourMove::Panel(Pixel), Mark(Answer)],
            )
            .claims(&[PickIsLit]),
            stop(
                "No wrong pixel",
                "Against the truth: every pixel that is compared agrees. Not compared is what no shadow can darken: surfaces turned away from the light, and the background.",
                &[Last, Picture(PictureKind::Error), TourMove::Panel(Explain), Mark(Legend)],
            )
            .claims(&[NoneWrong]),
        ],
    },
    Tour {
        technique: Technique::ZPassPlus,
        promise: "How z-pass is fixed at the near plane",
        stops: &[
            stop(
                "What was cut off",
                "z-pass loses the faces before the near plane. Here an extra pass draws the casters onto the near plane as the light sees them, and so counts for every pixel how many volumes it starts in.",
                &[Scene("inside"), Step("near plane"), Picture(PictureKind::Stencil), TourMove::Panel(Explain), Mark(Formula)],
            ),
            stop(
                "Then count as z-pass does",
                "The volumes are counted in front of the surface, on top of that start.",
                &[Step("volumes"), Picture(PictureKind::Stencil), PickShadow, TourMove::Panel(Pixel), Mark(Ladder)],
            )
            .claims(&[PickIsDark, StencilIsSet]),
            stop(
                "What remains",
                "Two projections meet at the near plane, and they round differently: single pixels may leak along the cut, here few or none. z-fail has no such seam.",
                &[Last, Picture(PictureKind::Error), TourMove::Panel(Explain), Mark(Legend)],
            )
            .claims(&[FewWrong(2)]),
        ],
    },
    Tour {
        technique: Technique::Auto,
        promise: "Only what this scene needs, and why the rest may be left out",
        stops: &[
            stop(
                "The cheapest that is right",
                "auto looks at each light and caster: a volume that can't be cut by the near plane is counted without caps, another with the caps that it needs, and one that reaches nothing in view not at all.",
                &[Scene("tori"), Step("volumes"), Picture(PictureKind::Stencil), TourMove::Panel(Explain), Mark(Formula)],
            ),
            stop(
                "What was left out",
                "The Explain tab lists everything that was left out with its reason and its numbers. leave-out in the settings puts each back: the picture stays the same, but for single pixels at the very edge of a shadow, only slower.",
                &[Last, Picture(PictureKind::Color), TourMove::Panel(Explain), Mark(LeftOut)],
            ),
            stop(
                "Still no wrong pixel",
                "Held against rays, auto has no wrong pixel in any of the built-in scenes.",
                &[Last, Picture(PictureKind::Error), TourMove::Panel(Explain), Mark(Legend)],
            )
            .claims(&[NoneWrong]),
        ],
    },
    Tour {
        technique: Technique::ShadowMap,
        promise: "Depth from the light, and what its texels cost",
        stops: &[
            stop(
                "What the light sees",
                "The casters are drawn from the light, and only depth is kept: how far the first thing is in every direction. A point light that has casters all around looks into a cube of six maps; where they fit into one view, as here, one map is enough.",
                &[Scene("table"), First, Picture(PictureKind::Map), TourMove::Panel(Explain), Mark(Legend)],
            ),
            stop(
                "Compared at every pixel",
                "Each pixel's surface point is carried into the map. If the map has something nearer, the point is in shadow. The read-out beside shows the texel that was read and both depths.",
                &[Last, Picture(PictureKind::Color), PickShadow, TourMove::Panel(Pixel), Mark(Texel)],
            )
            .claims(&[PickIsDark]),
            stop(
                "Texel and pixel, linked",
                "The Shadow map tab marks the texel that the picked pixel reads. Hover another texel, and the pixels that read it are marked in the picture: the farther from the light, the larger the piece of surface that shares one texel.",
                &[Last, PickShadow, TourMove::Panel(PanelKind::ShadowMap), Mark(Texel)],
            )
            .claims(&[PickIsDark]),
            stop(
                "No bias: acne",
                "A texel is one depth for a piece of surface, so beside the texel's middle the surface lies behind what the map has of itself, and shadows itself in stripes. Here both bias settings are 0: the hatched pixels are dark and should be lit.",
                &[Set("bias-constant", "0"), Set("bias-slope", "0"), Last, TourMove::Panel(PanelKind::Picture), Picture(PictureKind::Error), PickWrong, TourMove::Panel(Pixel), Mark(Answer)],
            )
            .claims(&[FalseShadow, PickIsWrong]),
            stop(
                "The other faces",
                "Still no bias, but cull is front: the map has the faces that are turned away from the light. A lit surface is then no longer compared with itself, and hardly a pixel is wrong. Only closed casters have such faces.",
                &[Set("bias-constant", "0"), Set("bias-slope", "0"), Set("cull", "front"), Last, Picture(PictureKind::Error), TourMove::Panel(Explain), Mark(Legend)],
            )
            .claims(&[FewWrong(20)]),
            stop(
                "Too much bias",
                "A bias pushes the map away from the light. With far too much of it, and large texels, a caster's depth lies behind the surface that it shadows: near its caster the shadow is missing, as if it had been torn off.",
                &[Set("size", "512"), Set("bias-slope", "60"), Last, Picture(PictureKind::Error), PickWrong, TourMove::Panel(Pixel), Mark(Answer)],
            )
            .claims(&[MissingShadow, NoFalseShadow, PickIsWrong]),
            stop(
                "Its error",
                "Wrong pixels follow the texels along every edge. Here the map has 256 texels a side; a larger one makes them fewer and the frame slower: the Report tab measures both.",
                &[Set("size", "256"), Last, Picture(PictureKind::Error), PickWrong, TourMove::Panel(Pixel), Mark(Answer)],
            )
            .claims(&[FalseShadow, MissingShadow, FewWrong(50), PickIsWrong]),
        ],
    },
    Tour {
        technique: Technique::Projective,
        promise: "Silhouettes projected like slides, and glass that colours light",
        stops: &[
            stop(
                "A slide of each caster",
                "Each caster is drawn in black, or in its colour where it is glass, as the light sees it.",
                &[Scene("glass"), First, Picture(PictureKind::Map), TourMove::Panel(Explain), Mark(Legend)],
            ),
            stop(
                "Thrown over the scene",
                "Every surface in the slide's beam is looked up in it and multiplied by what it lets through, so that two colours darken each other as glass over glass does.",
                &[Last, Picture(PictureKind::Color), PickShadow, TourMove::Panel(Pixel), Mark(Answer)],
            )
            .claims(&[PickIsDark]),
            stop(
                "What it can't know",
                "A slide has no depth: what lies before the caster is darkened too, as at the picked pixel, unless it is left out by hand. The hatching shows where. Nor can a caster shadow itself.",
                &[Last, Picture(PictureKind::Error), PickWrong, TourMove::Panel(Pixel), Mark(Answer)],
            )
            .claims(&[FalseShadow, PickIsWrong, PickIsDark]),
        ],
    },
    Tour {
        technique: Technique::RayTraced,
        promise: "The truth that all others are held against",
        stops: &[
            stop(
                "A ray for every pixel",
                "From each surface point a ray goes to the light. If anything lies between, the point is in shadow. Nothing is approximated but the numbers themselves, in 64 bits.",
                &[Scene("tori"), Step("rays"), Picture(PictureKind::Mask), TourMove::Panel(Explain), Mark(Formula)],
            ),
            stop(
                "Edges",
                "Along a silhouette one pixel sees both sides, and a technique may show the other one than the ray through its middle. A pixel that differs so near an edge of this truth is called edge band and excused: no technique is blamed for a coin's toss. The rays' own mask has no such pixel.",
                &[Last, Picture(PictureKind::Truth), TourMove::Panel(Explain), Mark(Legend)],
            ),
            stop(
                "Umbra alone",
                "Where a light is wholly hidden is its umbra, where it is hidden in part its penumbra. A point is either hidden or not, and so is a direction: all lights here are one or the other, so that each pixel is lit or dark, and nothing lies between. A lamp with a size would have a soft edge, sharp at the caster and wider with the distance from it.",
                &[Last, Picture(PictureKind::Mask), PickShadow, TourMove::Panel(Pixel), Mark(Answer)],
            )
            .claims(&[PickIsDark]),
            stop(
                "What it costs",
                "The report sets every technique's wrong pixels beside its milliseconds, rays included. Press Measure in the Report tab.",
                &[Last, Picture(PictureKind::Color), TourMove::Panel(PanelKind::Report), Mark(Measure)],
            )
            .claims(&[NoneWrong]),
        ],
    },
];

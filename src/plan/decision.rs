//! What a frame may do without: one decision each, and what it leaves out in words.

use crate::numbers;

named_enum! {
    /// Why something is not in a frame. The first may be forbidden (`leave-out`), each by its name; the rest is what
    /// a technique can't do, does not do, or has done before.
    pub enum Decision {
        /// A light that reaches no surface in view: its passes.
        Light = "light",
        /// A caster behind which, as the light sees it, there is nothing: its volume.
        Caster = "caster",
        /// A volume that misses the view.
        View = "view",
        /// A caster wholly in the umbra of another, or a part of one in that of another part: its volume.
        Umbra = "umbra",
        /// Of a closed caster, the triangles that face away from the light.
        AwayTriangles = "away-triangles",
        /// Caps of a caster that holds no point of the near plane in its shadow: z-pass counts without.
        Caps = "caps",
        /// The light cap of a caster that is not in view.
        LightCap = "light-cap",
        /// The dark cap of a volume whose far end is not in view, or is one point.
        DarkCap = "dark-cap",
        /// What of a volume lies beyond all that receives: it ends there.
        BeyondReceivers = "beyond-receivers",
        /// Surfaces that are not in view.
        Surfaces = "surfaces",
        /// Triangles of a closed surface that face away from the eye.
        HiddenTriangles = "hidden-triangles",
        /// In a light's pass, triangles that face away from it.
        UnlitTriangles = "unlit-triangles",
        /// The stencil buffer where nothing counts or marks.
        Stencil = "stencil",
        /// Clearing a stencil that nothing has written.
        Clear = "clear",
        /// Faces of a cube map that no caster shows in.
        MapFaces = "map-faces",
        /// Pixels that a light of limited range does not reach.
        Scissor = "scissor",
        /// The volume of a caster that has no casting triangle.
        NothingCasts = "nothing-casts",
        /// The pass of a light that no volume is needed for.
        VolumePass = "volume-pass",
        /// Triangles inside the outline of a dark cap at infinity.
        InnerDarkCap = "inner-dark-cap",
        /// Counting with the triangles that face the light alone: what it takes is not proven.
        LightFacing = "light-facing",
        /// Counting in eight bits, which could be too few.
        EightBits = "eight-bits",
        /// Two passes and clamping, which a float count does not know.
        TwoPasses = "two-passes",
        /// Extrusion in the vertex shader, which finds no casting triangle for the CPU.
        VertexExtrusion = "vertex-extrusion",
        /// What z-pass-plus begins with.
        NearPlane = "near-plane",
        /// A light's shadow map: nothing would be in it.
        Map = "map",
        /// A caster in a light's map: behind it there is nothing.
        MapCaster = "map-caster",
        /// A caster's silhouette: behind it there is nothing, or no picture holds it.
        Silhouette = "silhouette",
        /// Silhouettes of more casters than fit.
        MostSilhouettes = "most-silhouettes",
        /// The texture of a receiver that would show no shadow.
        Texture = "texture",
        /// All of a light's textures.
        Textures = "textures",
        /// Shadows on flat receivers: there are none.
        PlanarShadows = "planar-shadows",
        /// Flat receivers that show the side that the light is not on.
        DarkReceivers = "dark-receivers",
        /// Flat receivers beyond those that are served.
        SmallReceivers = "small-receivers",
        /// Darkening a pixel once only, which takes a stencil.
        BlendOnce = "blend-once",
        /// What a model's materials ask for and no shader does.
        Material = "material",
        /// What a scene's file holds and no frame shows.
        SceneFile = "scene-file",
        /// Drawing again what is there from the frame before.
        Kept = "kept",
        /// A draw of which no sample showed in the frame before.
        Unseen = "unseen",
    }
}

impl Decision {
    /// The names of those that may be forbidden: what `leave-out` knows, in order.
    pub const NAMES: [&str; 16] = {
        let mut names = [""; 16];
        let mut index = 0;
        while index < names.len() {
            names[index] = Decision::ALL[index].name();
            index += 1;
        }
        names
    };

    /// What is left out, for people: `dark cap`, `texture of floor`, `3 flat receivers`. `count`: how many
    /// triangles or things; `name`: which of several.
    pub(super) fn what(self, name: Option<&str>, count: Option<u64>) -> String {
        let (name, of) = (name.unwrap_or("it"), numbers::count(count.unwrap_or(0)));
        let plain = match self {
            Decision::Light => "all passes",
            Decision::Umbra if count.is_some() => return format!("volume of parts ({of} triangles)"),
            Decision::Caster | Decision::View | Decision::Umbra | Decision::NothingCasts => "volume",
            Decision::AwayTriangles => "triangles that face away",
            Decision::Caps => "caps",
            Decision::LightCap => "light cap",
            Decision::DarkCap => "dark cap",
            Decision::BeyondReceivers => "far part of the volume",
            Decision::Surfaces => "surface",
            Decision::HiddenTriangles => return format!("{of} triangles that face away from the eye"),
            Decision::UnlitTriangles => return format!("{of} triangles that face away"),
            Decision::Stencil => "stencil buffer",
            Decision::Clear => "stencil clear",
            Decision::MapFaces | Decision::Unseen | Decision::Material | Decision::SceneFile => name,
            Decision::Scissor => "pixels out of reach",
            Decision::VolumePass => "volume pass",
            Decision::InnerDarkCap => "inner triangles of the dark cap",
            Decision::LightFacing => "choice of light-facing triangles",
            Decision::EightBits => "eight-bit count",
            Decision::TwoPasses => "two passes and clamping",
            Decision::VertexExtrusion => "extrusion in the vertex shader",
            Decision::NearPlane => "count at the near plane",
            Decision::Map => "shadow map",
            Decision::MapCaster => return format!("{name} in the shadow map"),
            Decision::Silhouette => return format!("silhouette of {name}"),
            Decision::MostSilhouettes => return format!("silhouettes of the last {of} objects"),
            Decision::Texture => return format!("texture of {name}"),
            Decision::Textures => "textures",
            Decision::PlanarShadows => "planar shadows",
            Decision::DarkReceivers => return format!("{of} flat receivers"),
            Decision::SmallReceivers => return format!("{of} small flat receivers"),
            Decision::BlendOnce => "blending once",
            Decision::Kept => return format!("drawing `{name}` again"),
        };
        plain.to_owned()
    }
}

//! What a frame may do without: one decision for each reason, with the text for what it leaves out.

use crate::numbers;

named_enum! {
    /// Why something is not in a frame. The first 16 decisions can be forbidden by name in the setting `leave-out`; the
    /// others record what a technique can't do, does not do, or has done before.
    pub enum Decision(
        /// What is left out, in words, with places for a name and a number.
        template
    ) {
        /// A light that reaches no surface in view: its passes.
        Light = "light" ("all passes"),
        /// A caster behind which, as the light sees it, there is nothing: its volume.
        Caster = "caster" ("volume"),
        /// A volume that lies outside the view.
        View = "view" ("volume"),
        /// A caster wholly in the umbra of another, or a part of one in that of another part: its volume.
        Umbra = "umbra" ("volume"),
        /// Of a closed caster, the triangles that face away from the light.
        AwayTriangles = "away-triangles" ("triangles that face away"),
        /// The caps of a caster whose shadow contains no point of the near plane: z-pass counts without.
        Caps = "caps" ("caps"),
        /// The light cap of a caster that is not in view.
        LightCap = "light-cap" ("light cap"),
        /// The dark cap of a volume whose far end is not in view, or is one point.
        DarkCap = "dark-cap" ("dark cap"),
        /// The part of a volume that lies beyond all receivers: the volume ends there.
        BeyondReceivers = "beyond-receivers" ("far part of the volume"),
        /// Surfaces that are not in view.
        Surfaces = "surfaces" ("surface"),
        /// Triangles of a closed surface that face away from the eye.
        HiddenTriangles = "hidden-triangles" ("{count} triangles that face away from the eye"),
        /// In a light's pass, triangles that face away from it.
        UnlitTriangles = "unlit-triangles" ("{count} triangles that face away"),
        /// The stencil buffer where nothing counts or marks.
        Stencil = "stencil" ("stencil buffer"),
        /// Clearing a stencil that nothing has written.
        Clear = "clear" ("stencil clear"),
        /// Faces of a cube map that no caster shows in.
        MapFaces = "map-faces" ("{name}"),
        /// Pixels that a light of limited range does not reach.
        Scissor = "scissor" ("pixels out of reach"),
        /// The volume of a caster that has no casting triangle.
        NothingCasts = "nothing-casts" ("volume"),
        /// The pass of a light that no volume is needed for.
        VolumePass = "volume-pass" ("volume pass"),
        /// Triangles inside the outline of a dark cap at infinity.
        InnerDarkCap = "inner-dark-cap" ("inner triangles of the dark cap"),
        /// Counting with the triangles that face the light alone: the conditions for it are not proven.
        LightFacing = "light-facing" ("choice of light-facing triangles"),
        /// Counting in eight bits, which could be too few.
        EightBits = "eight-bits" ("eight-bit count"),
        /// Two passes and clamping, which do not apply to a float count.
        TwoPasses = "two-passes" ("two passes and clamping"),
        /// Extrusion in the vertex shader, which leaves the CPU without the casting triangles.
        VertexExtrusion = "vertex-extrusion" ("extrusion in the vertex shader"),
        /// The count at the near plane that z-pass-plus begins with.
        NearPlane = "near-plane" ("count at the near plane"),
        /// A light's shadow map: nothing would be in it.
        Map = "map" ("shadow map"),
        /// A caster in a light's map: behind it there is nothing.
        MapCaster = "map-caster" ("{name} in the shadow map"),
        /// A caster's silhouette: nothing lies behind the caster, or no picture can contain the silhouette.
        Silhouette = "silhouette" ("silhouette of {name}"),
        /// Silhouettes of more casters than the budget allows.
        MostSilhouettes = "most-silhouettes" ("silhouettes of the last {count} objects"),
        /// The texture of a receiver that would show no shadow.
        Texture = "texture" ("texture of {name}"),
        /// All of a light's textures.
        Textures = "textures" ("textures"),
        /// Shadows on flat receivers: there are none.
        PlanarShadows = "planar-shadows" ("planar shadows"),
        /// Flat receivers that show the side that the light is not on.
        DarkReceivers = "dark-receivers" ("{count} flat receivers"),
        /// Flat pieces of an object that get no planar shadow or texture, though they show their lit side: too small, too many
        /// or not named.
        SmallReceivers = "small-receivers" ("shadows on {count} flat pieces of {name}"),
        /// Darkening a pixel only once, which takes a stencil.
        BlendOnce = "blend-once" ("blending once"),
        /// A feature that a model's materials ask for and no shader has.
        Material = "material" ("{name}"),
        /// Data in a scene's file that no frame shows.
        SceneFile = "scene-file" ("{name}"),
        /// Drawing again what is cached from the frame before.
        Cached = "kept" ("drawing `{name}` again"),
        /// A draw of which no sample passed in the frame before.
        Unseen = "unseen" ("{name}"),
    }
}

impl Decision {
    /// The names of the decisions that can be forbidden, in order: the values of the setting `leave-out`.
    pub const NAMES: [&str; 16] = {
        let mut names = [""; 16];
        let mut index = 0;
        while index < names.len() {
            names[index] = Decision::ALL[index].name();
            index += 1;
        }
        names
    };

    /// Returns what is left out, in words: `dark cap`, `texture of floor`, `3 flat receivers`. `count` is how many
    /// triangles or things, `name` which of several.
    pub(super) fn what(self, name: Option<&str>, count: Option<u64>) -> String {
        let (name, of) = (name.unwrap_or("it"), numbers::count(count.unwrap_or(0)));
        match self {
            Decision::Umbra if count.is_some() => format!("volume of parts ({of} triangles)"),
            _ => self.template().replace("{count}", &of).replace("{name}", name),
        }
    }
}

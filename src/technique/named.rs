//! The techniques by name.

named_enum! {
    /// A way to make shadows, in teaching order.
    pub enum Technique {
        /// No shadows at all.
        None = "none",
        /// Casters flattened onto planes.
        Planar = "planar",
        /// Casters drawn into textures of the largest flat receivers.
        PlanarTexture = "planar-texture",
        /// Shadow volumes counted in front of the surface.
        ZPass = "z-pass",
        /// Shadow volumes counted behind the surface.
        ZFail = "z-fail",
        /// Shadow volumes counted in front of the surface, from the near plane's own count on.
        ZPassPlus = "z-pass-plus",
        /// Shadow volumes, each counted as is cheapest while right, and only those that matter.
        Auto = "auto",
        /// Depth from the light, compared at every pixel.
        ShadowMap = "shadow-map",
        /// Casters' silhouettes projected over the scene.
        Projective = "projective",
        /// Rays from eye and light: the ground truth.
        RayTraced = "ray-traced",
    }
}

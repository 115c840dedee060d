//! Every way in which a shadow is known to go wrong.

use std::fmt;

named_enum! {
    /// Why pixels are wrong, in our own frames and in those of other programs, ordered by families: volumes, meshes,
    /// counts, planes, maps, silhouettes, numbers, flags, states. The rules for other programs' frames are the table in
    /// [`frame_causes`](super::frame_causes).
    pub enum Cause {
        /// Z-pass starts to count inside a volume.
        EyeInVolume = "eye-in-volume",
        /// Z-pass starts to count on a near plane that cuts volumes open.
        NearPlaneCut = "near-plane-cut",
        /// Z-pass-plus cuts a caster twice at the near plane, and the cuts round apart.
        NearPlaneCrack = "near-plane-crack",
        /// A volume is open at its far end.
        MissingDarkCap = "missing-dark-cap",
        /// A volume is open at its caster.
        MissingLightCap = "missing-light-cap",
        /// Volumes or surfaces are cut at a far plane.
        FarClip = "far-clip",
        /// Volumes end before the receiver.
        FiniteExtrusion = "finite-extrusion",
        /// Far vertices of finite volumes are carried from the world's origin and not from the light.
        LightNotAdded = "light-not-added",
        /// A caster's mesh has edges of one triangle, and only its light-facing triangles cast.
        OpenMesh = "open-mesh",
        /// A caster's mesh has edges of more than two triangles, and only light-facing triangles cast.
        NonManifold = "non-manifold",
        /// Neighbouring triangles of a caster disagree on which side is out, or all face inwards.
        InconsistentWinding = "inconsistent-winding",
        /// Vertices at bit-equal positions count as different ones.
        SplitVertices = "split-vertices",
        /// Vertices lie within a millionth of the size of each other.
        NearVertices = "near-vertices",
        /// A corner lies on another triangle's edge, which silhouettes from shared corners take for an open one.
        TJunction = "t-junction",
        /// A mirrored caster's volume is wound as if it were not mirrored.
        Mirrored = "mirrored",
        /// The light is inside a caster, and only its light-facing triangles cast.
        LightInside = "light-inside",
        /// A count stops at 255.
        Clamped = "clamped",
        /// A count of a multiple of 256 reads as none.
        Wrap256 = "wrap-256",
        /// The count has fewer bits than eight, and a multiple of the largest number that fits reads as none.
        FewBits = "few-bits",
        /// One bit only distinguishes odd from even, and an even count reads as none.
        Parity = "parity",
        /// A count stops at 0, since subtracting faces came before adding ones.
        OperationOrder = "operation-order",
        /// A light cap's depths are not those of the surface that it lies on.
        CapFighting = "cap-fighting",
        /// A flattened shadow darkens the same pixel more than once.
        DoubleBlend = "double-blend",
        /// The light pass does not note where it has lit, and lights surfaces that lie in one plane each.
        DoubleLighting = "double-lighting",
        /// A flattened shadow covers the picture in black, ambient light included.
        OpaqueShadow = "opaque-shadow",
        /// A flattened shadow and its receiver have the same depths, except for rounding.
        ZFighting = "z-fighting",
        /// A flattened shadow is drawn beyond its receiver.
        OffReceiver = "off-receiver",
        /// What lies beyond the light is flattened onto the receiver.
        AntiShadow = "anti-shadow",
        /// What lies under the receiver's plane is flattened onto it.
        FalseShadow = "false-shadow",
        /// A receiver is not a plane that shadows can be flattened onto.
        NotPlanar = "not-planar",
        /// A receiver is flat, but is none of those that shadows are flattened onto.
        ReceiverLeftOut = "receiver-left-out",
        /// A surface shadows itself, as texels of the map are coarser than its slope.
        Acne = "acne",
        /// The bias is larger than the gap between caster and receiver.
        PeterPanning = "peter-panning",
        /// All faces of a caster between light and surface are of those that the map leaves out.
        MapFacesCulled = "map-faces-culled",
        /// Texels are coarser than the shadow's outline.
        Aliasing = "aliasing",
        /// Surfaces lie outside what the map covers.
        OutsideMap = "outside-map",
        /// A filter reads beyond the border of a cube's face, where it finds that face's last texels again.
        MapSeam = "map-seam",
        /// The map follows the view, and its texels move over the world by parts of themselves.
        MapSwims = "map-swims",
        /// A caster is nearer to the light than the map begins.
        MapNearPlane = "map-near-plane",
        /// A caster is farther from the light than the map ends.
        MapFarPlane = "map-far-plane",
        /// A silhouette is projected behind the light too.
        ReverseProjection = "reverse-projection",
        /// A silhouette falls on a surface between the light and its caster.
        Between = "between",
        /// The last texels of a silhouette's picture are repeated beyond it.
        EdgeSmear = "edge-smear",
        /// A silhouette is not projected onto its own caster.
        SelfShadow = "self-shadow",
        /// Single precision cannot distinguish the two sides.
        F32Limit = "f32-limit",
        /// Positions are rounded to single precision in world space, far from the origin.
        F32World = "f32-world",
        /// Depths have so few bits, or so narrow a range, that places that are apart are stored alike.
        DepthPrecision = "depth-precision",
        /// Edges of the caster are shorter than a pixel, and corners of volumes snap to parts of one.
        SubpixelEdges = "subpixel-edges",
        /// A side of a volume is seen so nearly edge-on that a part of a pixel decides on which side of the surface it is.
        RasteriserPrecision = "rasteriser-precision",
        /// The scene says that an object receives no shadows.
        NotReceiving = "not-receiving",
        /// The scene says that an object casts no shadow.
        NotCasting = "not-casting",
        /// The scene says that an object is not drawn.
        Undrawn = "undrawn",
        /// A vertex shader computes in single precision which triangles face the light, and where vertices are carried.
        CarriedInF32 = "carried-in-f32",
        /// One side of the volumes' faces is culled, though both count.
        FaceCulled = "face-culled",
        /// Volumes write depth, and hide each other.
        VolumesWriteDepth = "volumes-write-depth",
        /// The stencil stores other values than 0 before the first volume is counted.
        StencilNotCleared = "stencil-not-cleared",
        /// The light's pass compares only some bits of the count.
        StencilMask = "stencil-mask",
        /// The volumes are not closed, and are counted behind the surface.
        OpenVolume = "open-volume",
        /// The map holds depths before the first draw into it.
        MapNotCleared = "map-not-cleared",
        /// A surface is drawn into the picture, and not into the light's map.
        NotInMap = "not-in-map",
        /// Depths of the map are so alike that rounding makes casters and what they fall on the same.
        MapDepthCoarse = "map-depth-coarse",
    }
}

impl Cause {
    /// Returns sentences that explain the cause and what to do about it, for a reader who does not know it.
    pub fn meaning(self) -> &'static str {
        match self {
            Cause::EyeInVolume => {
                "The eye stands in shadow: z-pass counts from the eye on and misses the volumes that it is already in. \
                 Count from behind with z-fail."
            }
            Cause::NearPlaneCut => {
                "The near plane cuts a shadow volume open, and z-pass misses the faces that are cut away. Count from \
                 behind with z-fail."
            }
            Cause::NearPlaneCrack => {
                "A caster crosses the near plane, where z-pass-plus joins two pictures whose edges round apart. Count \
                 from behind with z-fail."
            }
            Cause::MissingDarkCap => {
                "Z-fail needs volumes that are closed at their far end, and this one is not. Draw the dark cap."
            }
            Cause::MissingLightCap => {
                "Z-fail needs volumes that are closed at their caster, and this one is not. Draw the light cap, and \
                 test its depth."
            }
            Cause::FarClip => {
                "A far plane cuts surfaces or shadow volumes away, and what is cut away is not seen or not counted. Use \
                 an infinite depth mapping; clamped depth saves the volumes."
            }
            Cause::LightNotAdded => {
                "Far vertices are the way from light to vertex times a number, and the light's own place is not added \
                 back: the volumes lean towards the world's origin. Carry them from the light."
            }
            Cause::CarriedInF32 => {
                "A vertex shader tells in single precision which triangles face the light and where its volumes go, and \
                 the light is too near to the caster or to the plane of its triangles for that. Let the CPU carry them."
            }
            Cause::FiniteExtrusion => "The shadow volumes end before they reach the surface. Extrude them to infinity.",
            Cause::OpenMesh => {
                "The mesh has holes, so its light-facing triangles do not bound a volume as those of a closed mesh do. \
                 Let all triangles cast, as going by topology does."
            }
            Cause::NonManifold => {
                "More than two triangles share an edge, so the outline of the light-facing ones is not the whole \
                 story. Let all triangles cast, as going by topology does."
            }
            Cause::InconsistentWinding => {
                "Triangles of the mesh are wound the wrong way, and are taken to face the light when they do not. Let \
                 all triangles cast, or turn them."
            }
            Cause::SplitVertices => {
                "Neighbouring triangles have vertices of their own at the very same positions, so the mesh looks open \
                 along their seam. Weld them."
            }
            Cause::NearVertices => {
                "Vertices that look like one lie a hair apart, so the mesh is open between them. Let all triangles \
                 cast; welding by a tolerance would move the surface."
            }
            Cause::LightInside => {
                "The light is inside the caster, and no triangle that should cast faces it. Let all triangles cast."
            }
            Cause::Clamped => {
                "More volumes overlap here than eight bits count, and the count stops at 255. Let counts wrap, or \
                 count in a float."
            }
            Cause::Wrap256 => {
                "Exactly a multiple of 256 volumes overlap here, which eight bits hold as 0. Count in a float."
            }
            Cause::FewBits => {
                "As many volumes overlap here as the bits of the stencil's mask hold as 0. Count in all eight bits, or \
                 in a float."
            }
            Cause::Parity => {
                "Each face turns one bit over, which tells an odd count from an even one: where two volumes overlap, \
                 the surface reads as lit. Count up and down, and let counts wrap."
            }
            Cause::OperationOrder => {
                "Counts stop at 0, and what takes away is drawn before what adds. Let counts wrap: then the order \
                 does not matter."
            }
            Cause::CapFighting => {
                "The light cap lies on the surface itself, but its depths round differently, as its corners are \
                 drawn in another order. Draw caps in the surface's own vertex order."
            }
            Cause::DoubleBlend => {
                "Flattened triangles overlap, and each darkens the pixel again. Let the stencil count what is \
                 darkened, and blend once."
            }
            Cause::DoubleLighting => {
                "Surfaces lie in one plane, so that the depths of both are equal to what is stored, and each adds the light. Let \
                 the light pass raise the stencil where it has lit (relight = guarded)."
            }
            Cause::OpaqueShadow => {
                "Flattened casters are drawn in black over the lit picture, and take ambient light and other lights away with \
                 their own. Keep the light off where the stencil says so (blend = once)."
            }
            Cause::ZFighting => {
                "The flattened shadow lies in its receiver's plane, and rounding decides which is in front. Turn the \
                 depth test off for shadows, or offset them."
            }
            Cause::OffReceiver => {
                "The flattened shadow runs on beyond the end of its receiver. Mark the receiver in the stencil and \
                 draw the shadow only there."
            }
            Cause::AntiShadow => {
                "What lies beyond the light cannot shadow the receiver, but flattening carries it there all the same. \
                 Clip casters at the light."
            }
            Cause::FalseShadow => {
                "What lies under the receiver's plane cannot shadow it, but flattening carries it there all the same. \
                 Clip casters at the plane."
            }
            Cause::NotPlanar => {
                "Shadows are flattened onto planes only, and this receiver has none here. Use shadow volumes."
            }
            Cause::ReceiverLeftOut => {
                "The surface is flat, but casters are flattened onto some receivers only, as each costs a draw for every \
                 caster, and this is none of them. Let all receive (receivers = all), name it (receivers = named:NAME), or \
                 use shadow volumes, whose cost does not grow with receivers."
            }
            Cause::Acne => {
                "A surface shadows itself: within one texel of the map it slopes by more than the bias. Raise the bias \
                 with the slope."
            }
            Cause::PeterPanning => {
                "The bias is larger than the gap between the caster and what lies behind it, so the shadow begins too \
                 late. Lower the bias, or make the map larger: a bias of so many texels or slopes shrinks with them."
            }
            Cause::MapFacesCulled => {
                "The map leaves out one side of all faces, a usual cure for acne (second depths, Wang and Molnár 1994), and the caster shows the light no other \
                 here: it is thin or open, so the faces left out have none behind them within the shadow. Draw both sides \
                 (cull = none, glDisable(GL_CULL_FACE)) and bias them, or give the caster a back."
            }
            Cause::Aliasing => {
                "Texels of the map cover more than the detail of the shadow's outline. Use a larger map or a volume."
            }
            Cause::TJunction => {
                "A corner lies in the middle of another triangle's edge. Silhouettes that ask for shared corners find no \
                 neighbour there and make no side, so that the volume is open. Join the corners, or find edges by \
                 positions (silhouette = adjacency)."
            }
            Cause::Mirrored => {
                "A scale of negative determinant turns an object's front faces into back faces, and its volume was not \
                 flipped with it: it takes from the count what it should add. Flip its winding (mirrored = flipped)."
            }
            Cause::MapSeam => {
                "At the border between two faces of a cube the filter has no texels on the other side, and reads its last \
                 ones again: soft shadows break off in a line there. Read on in the next face, give faces a margin that \
                 holds the filter, or use none (filter = none)."
            }
            Cause::MapSwims => {
                "The map is fitted anew to what each picture shows, and its texels come to lie elsewhere: shadows' edges \
                 crawl though nothing moves. Give the map one size and move it by whole texels (light-frustum = \
                 view-snapped), as cascaded maps do."
            }
            Cause::MapNearPlane => {
                "The map's near plane lies behind the caster, which has no part in the map. Move the plane nearer to the \
                 light, or fit the map to what casts (light-frustum = casters)."
            }
            Cause::MapFarPlane => {
                "The map's far plane lies before the caster, which has no part in the map. Move the plane away from the \
                 light, or fit the map to what casts (light-frustum = casters)."
            }
            Cause::RasteriserPrecision => {
                "Rasterisers move corners to parts of a pixel, 1/256 of one or more. A face that is seen nearly edge-on then \
                 has another depth at the pixel's middle: a volume's side lies before the surface instead of behind it, or \
                 what is hidden shows. A larger picture shows that; nothing else mends it."
            }
            Cause::F32World => {
                "Single precision has coarse steps far from the origin, and world positions are rounded to them: surfaces \
                 that touch part, and edges jump. Subtract the eye in double precision first (world = f64)."
            }
            Cause::DepthPrecision => {
                "Depths are floored to so few bits, or stored in so narrow a range, that two places which are apart have the \
                 same: a volume's side counts on the wrong side of the surface, surfaces fight, a map darkens what it saw \
                 itself. Take more bits (depth-bits) or the whole range (depth-range), or move the near plane out."
            }
            Cause::OutsideMap => {
                "These surfaces or their casters are outside what the light's map shows. Fit the map again."
            }
            Cause::ReverseProjection => {
                "The silhouette is projected behind the light too, as a slide would never be. Leave out what lies \
                 behind it."
            }
            Cause::Between => {
                "A silhouette is projected with no regard to distance, and falls on what stands before its caster. Use \
                 a shadow volume or a map."
            }
            Cause::EdgeSmear => {
                "Beyond the silhouette's picture its last texels go on for ever, and the silhouette touches them. Keep \
                 a clear border around it."
            }
            Cause::SelfShadow => {
                "A silhouette is not projected onto its own caster, which cannot shadow itself. Use a shadow volume or \
                 a map."
            }
            Cause::F32Limit => {
                "Single precision is too coarse: the light lies nearly in a triangle's plane, or a volume's side meets the \
                 surface in the very middle of a pixel. No setting fixes it: move the light, the triangle or the eye."
            }
            Cause::SubpixelEdges => {
                "The caster's edges are two pixels long or less. The GPU moves corners to the nearest part of a pixel (1/256 on most), \
                 which tilts a side as narrow as that, and it meets the surface beside its place. Draw a larger picture."
            }
            Cause::NotReceiving => "The scene says that this object receives no shadows. Set `receives` if it should.",
            Cause::NotCasting => "The scene says that this object casts no shadow. Set `casts` if it should.",
            Cause::Undrawn => "The scene says that this object is not drawn. Set `visible` if it should be.",
            Cause::FaceCulled => {
                "Face culling throws away one side of the volumes, and only the other counts. Switch culling off for \
                 the volumes."
            }
            Cause::VolumesWriteDepth => {
                "Shadow volumes write depth, so that faces behind them are not counted as they should. Switch depth \
                 writing off for the volumes."
            }
            Cause::MapNotCleared => {
                "The map is drawn over what it held before, so that casters of an earlier frame still throw shadows. Clear \
                 its depth first."
            }
            Cause::MapDepthCoarse => {
                "The light's view begins so near to the light that all depths round to a few steps. Move its near plane as \
                 far out as casters allow, or reverse a float depth."
            }
            Cause::NotInMap => {
                "What is not drawn into the map casts no shadow. Draw it there too, unless it is meant to cast none."
            }
            Cause::StencilNotCleared => {
                "The stencil is not cleared before volumes are counted in it. Clear it for every light."
            }
            Cause::StencilMask => {
                "The light's stencil test looks at some of the bits that were counted in. Compare all of them."
            }
            Cause::OpenVolume => "Z-fail needs closed volumes, and these have edges of one triangle. Draw both caps.",
        }
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_lead_back() {
        for (at, cause) in Cause::ALL.into_iter().enumerate() {
            assert_eq!(Cause::from_name(cause.name()), Some(cause));
            assert_eq!(cause as usize, at);
            assert!(cause.meaning().ends_with('.'));
        }
        assert_eq!(Cause::from_name("bad-luck"), None);
    }
}

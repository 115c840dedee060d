//! What a setting or a technique teaches; it stands beside the definition of each, which is not complete without it.

/// The help text of a setting or a technique, beside its values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lesson {
    /// A few sentences, and a Markdown table for some. For a setting, explains each word that can be chosen.
    pub text: &'static str,
    /// The rule as a formula, with its letters explained.
    pub formula: &'static str,
    /// The publications that describe it; empty where it is this program's own.
    pub sources: &'static [Citation],
}

/// A publication that is cited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Citation {
    /// The authors' last names.
    pub authors: &'static str,
    /// The year of publication.
    pub year: u16,
    /// The title.
    pub title: &'static str,
}

const fn source(authors: &'static str, year: u16, title: &'static str) -> Citation {
    Citation { authors, year, title }
}

impl std::fmt::Display for Citation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({}), \"{}\"", self.authors, self.year, self.title)
    }
}

/// All publications that lessons cite.
pub(crate) mod cited {
    use super::{Citation, source};

    /// Aldridge and Woods 2004, on shadow volumes of any triangle soup.
    pub const ALDRIDGE: Citation = source("Aldridge and Woods", 2004, "Robust, Geometry-Independent Shadow Volumes");
    /// Appel 1968, on shading and shadows by rays.
    pub const APPEL: Citation = source("Appel", 1968, "Some Techniques for Shading Machine Renderings of Solids");
    /// Bilodeau and Songy 1999, on counting behind the surface.
    pub const BILODEAU: Citation = source("Bilodeau and Songy", 1999, "Real Time Shadows");
    /// Bittner, Wimmer, Piringer and Purgathofer 2004, on occlusion queries.
    pub const BITTNER: Citation = source(
        "Bittner, Wimmer, Piringer and Purgathofer",
        2004,
        "Coherent Hierarchical Culling: Hardware Occlusion Queries Made Useful",
    );
    /// Blinn 1988, on planar shadows.
    pub const BLINN: Citation = source("Blinn", 1988, "Me and My (Fake) Shadow");
    /// Brabec, Annen and Seidel 2002, on maps fitted to what the camera sees.
    pub const BRABEC: Citation = source("Brabec, Annen and Seidel", 2002, "Practical Shadow Mapping");
    /// Brennan 2002, on shadow volumes that a vertex shader extrudes.
    pub const BRENNAN: Citation = source("Brennan", 2002, "Shadow Volume Extrusion using a Vertex Shader");
    /// Carmack 2000, on counting behind the surface.
    pub const CARMACK: Citation = source("Carmack", 2000, "Unpublished correspondence on shadow volumes");
    /// Crow 1977, on shadow volumes.
    pub const CROW: Citation = source("Crow", 1977, "Shadow Algorithms for Computer Graphics");
    /// Everitt and Kilgard 2002, on z-fail with volumes to infinity and a projection without a far plane.
    pub const EVERITT_KILGARD: Citation = source(
        "Everitt and Kilgard",
        2002,
        "Practical and Robust Stenciled Shadow Volumes for Hardware-Accelerated Rendering",
    );
    /// Gouraud 1971, on shading that interpolates colours from vertices.
    pub const GOURAUD: Citation = source("Gouraud", 1971, "Continuous Shading of Curved Surfaces");
    /// Green 2004, on wrapped diffuse light.
    pub const GREEN: Citation = source("Green", 2004, "Real-Time Approximations to Subsurface Scattering");
    /// Heckbert and Herf 1997, on receiver textures.
    pub const HECKBERT_HERF: Citation =
        source("Heckbert and Herf", 1997, "Simulating Soft Shadows with Graphics Hardware");
    /// Heidmann 1991, on shadow volumes in the stencil buffer.
    pub const HEIDMANN: Citation = source("Heidmann", 1991, "Real Shadows, Real Time");
    /// Holbert 2011, on the normal offset of shadow maps.
    pub const HOLBERT: Citation = source("Holbert", 2011, "Saying Goodbye to Shadow Acne");
    /// Hornus, Hoberock, Lefebvre and Hart 2005, on z-pass-plus.
    pub const HORNUS: Citation =
        source("Hornus, Hoberock, Lefebvre and Hart", 2005, "ZP+: correct Z-pass stencil shadows");
    /// Isidoro 2006, on the receiver-plane bias of shadow maps.
    pub const ISIDORO: Citation = source("Isidoro", 2006, "Shadow Mapping: GPU-based Tips and Techniques");
    /// Kilgard 1999, on shadows and reflections with the stencil buffer.
    pub const KILGARD: Citation = source("Kilgard", 1999, "Improving Shadows and Reflections via the Stencil Buffer");
    /// Kim, Kim and Turk 2008, on shadow volumes of non-manifold casters.
    pub const KIM: Citation =
        source("Kim, Kim and Turk", 2008, "A Shadow-Volume Algorithm for Opaque and Transparent Nonmanifold Casters");
    /// Lambert 1760, on diffuse light.
    pub const LAMBERT: Citation = source("Lambert", 1760, "Photometria");
    /// Lengyel 2002, on robust stencil shadows.
    pub const LENGYEL: Citation = source("Lengyel", 2002, "The Mechanics of Robust Stencil Shadows");
    /// Lloyd, Wendt, Govindaraju and Manocha 2004, on culling and clamping shadow volumes.
    pub const LLOYD: Citation = source("Lloyd, Wendt, Govindaraju and Manocha", 2004, "CC Shadow Volumes");
    /// McGuire, Hughes, Egan, Kilgard and Everitt 2003, on fast and robust shadow volumes.
    pub const MCGUIRE: Citation =
        source("McGuire, Hughes, Egan, Kilgard and Everitt", 2003, "Fast, Practical and Robust Shadows");
    /// Phong 1975, on shading that interpolates normals, and on highlights.
    pub const PHONG: Citation = source("Phong", 1975, "Illumination for Computer Generated Pictures");
    /// Reed 2015, on depth precision.
    pub const REED: Citation = source("Reed", 2015, "Depth Precision Visualized");
    /// Reeves, Salesin and Cook 1987, on filtering shadow maps (percentage-closer filtering) and their bias.
    pub const REEVES: Citation =
        source("Reeves, Salesin and Cook", 1987, "Rendering Antialiased Shadows with Depth Maps");
    /// Segal, Korobkin, van Widenfelt, Foran and Haeberli 1992, on projected textures.
    pub const SEGAL: Citation = source(
        "Segal, Korobkin, van Widenfelt, Foran and Haeberli",
        1992,
        "Fast Shadows and Lighting Effects Using Texture Mapping",
    );
    /// Segal and Akeley 1997, the specification of OpenGL 1.1.
    pub const SEGAL_AKELEY: Citation =
        source("Segal and Akeley", 1997, "The OpenGL Graphics System: A Specification (Version 1.1)");
    /// Shewchuk 1997, on exact signs of geometric predicates.
    pub const SHEWCHUK: Citation =
        source("Shewchuk", 1997, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates");
    /// Thorne 2005, on worlds whose origin is the eye.
    pub const THORNE: Citation = source("Thorne", 2005, "Using a Floating Origin to Improve Fidelity and Performance");
    /// Valient 2008, on maps that move by whole texels.
    pub const VALIENT: Citation = source("Valient", 2008, "Stable Rendering of Cascaded Shadow Maps");
    /// Wang and Molnar 1994, on shadow maps of back faces.
    pub const WANG_MOLNAR: Citation = source("Wang and Molnar", 1994, "Second-Depth Shadow Mapping");
    /// Whitted 1980, on ray tracing.
    pub const WHITTED: Citation = source("Whitted", 1980, "An Improved Illumination Model for Shaded Display");
    /// Williams 1978, on shadow maps.
    pub const WILLIAMS: Citation = source("Williams", 1978, "Casting Curved Shadows on Curved Surfaces");
}

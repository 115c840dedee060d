//! What a setting or a technique teaches. Each says so beside its own definition, which is not complete without.

/// What `stencilscope help` says of a setting or a technique, beside its values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lesson {
    /// In a few sentences; a table's rows have lines of their own. Of a setting it says each word that can be chosen.
    pub text: &'static str,
    /// What it decides, as a formula, its letters explained.
    pub formula: &'static str,
    /// Where it was described; none where it is this program's own.
    pub sources: &'static [Source],
}

/// A publication.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source {
    /// Who wrote it.
    pub authors: &'static str,
    /// When it came out.
    pub year: u16,
    /// What it is called.
    pub title: &'static str,
}

const fn source(authors: &'static str, year: u16, title: &'static str) -> Source {
    Source { authors, year, title }
}

impl std::fmt::Display for Source {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({}), \"{}\"", self.authors, self.year, self.title)
    }
}

/// What is cited, each once.
pub(super) mod cited {
    use super::{Source, source};

    pub const ALDRIDGE: Source = source("Aldridge and Woods", 2004, "Robust, Geometry-Independent Shadow Volumes");
    pub const APPEL: Source = source("Appel", 1968, "Some Techniques for Shading Machine Renderings of Solids");
    pub const BILODEAU: Source = source("Bilodeau and Songy", 1999, "Real Time Shadows");
    pub const BITTNER: Source = source(
        "Bittner, Wimmer, Piringer and Purgathofer",
        2004,
        "Coherent Hierarchical Culling: Hardware Occlusion Queries Made Useful",
    );
    pub const BLINN: Source = source("Blinn", 1988, "Me and My (Fake) Shadow");
    pub const BRENNAN: Source = source("Brennan", 2002, "Shadow Volume Extrusion using a Vertex Shader");
    pub const CARMACK: Source = source("Carmack", 2000, "Unpublished correspondence on shadow volumes");
    pub const CROW: Source = source("Crow", 1977, "Shadow Algorithms for Computer Graphics");
    pub const EVERITT_KILGARD: Source = source(
        "Everitt and Kilgard",
        2002,
        "Practical and Robust Stenciled Shadow Volumes for Hardware-Accelerated Rendering",
    );
    pub const GOURAUD: Source = source("Gouraud", 1971, "Continuous Shading of Curved Surfaces");
    pub const GREEN: Source = source("Green", 2004, "Real-Time Approximations to Subsurface Scattering");
    pub const HECKBERT_HERF: Source =
        source("Heckbert and Herf", 1997, "Simulating Soft Shadows with Graphics Hardware");
    pub const HEIDMANN: Source = source("Heidmann", 1991, "Real Shadows, Real Time");
    pub const HOLBERT: Source = source("Holbert", 2011, "Saying Goodbye to Shadow Acne");
    pub const HORNUS: Source =
        source("Hornus, Hoberock, Lefebvre and Hart", 2005, "ZP+: correct Z-pass stencil shadows");
    pub const ISIDORO: Source = source("Isidoro", 2006, "Shadow Mapping: GPU-based Tips and Techniques");
    pub const KILGARD: Source = source("Kilgard", 1999, "Improving Shadows and Reflections via the Stencil Buffer");
    pub const KIM: Source =
        source("Kim, Kim and Turk", 2008, "A Shadow-Volume Algorithm for Opaque and Transparent Nonmanifold Casters");
    pub const LAMBERT: Source = source("Lambert", 1760, "Photometria");
    pub const LENGYEL: Source = source("Lengyel", 2002, "The Mechanics of Robust Stencil Shadows");
    pub const LLOYD: Source = source("Lloyd, Wendt, Govindaraju and Manocha", 2004, "CC Shadow Volumes");
    pub const MCGUIRE: Source =
        source("McGuire, Hughes, Egan, Kilgard and Everitt", 2003, "Fast, Practical and Robust Shadows");
    pub const PHONG: Source = source("Phong", 1975, "Illumination for Computer Generated Pictures");
    pub const REED: Source = source("Reed", 2015, "Depth Precision Visualized");
    pub const REEVES: Source =
        source("Reeves, Salesin and Cook", 1987, "Rendering Antialiased Shadows with Depth Maps");
    pub const SEGAL: Source = source(
        "Segal, Korobkin, van Widenfelt, Foran and Haeberli",
        1992,
        "Fast Shadows and Lighting Effects Using Texture Mapping",
    );
    pub const SEGAL_AKELEY: Source =
        source("Segal and Akeley", 1997, "The OpenGL Graphics System: A Specification (Version 1.1)");
    pub const SHEWCHUK: Source =
        source("Shewchuk", 1997, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates");
    pub const WANG_MOLNAR: Source = source("Wang and Molnar", 1994, "Second-Depth Shadow Mapping");
    pub const WHITTED: Source = source("Whitted", 1980, "An Improved Illumination Model for Shaded Display");
    pub const WILLIAMS: Source = source("Williams", 1978, "Casting Curved Shadows on Curved Surfaces");
}

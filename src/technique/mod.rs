//! The techniques: each a pure function from a scene to a [`FramePlan`].
//!
//! A technique is one file with one function `(Job) → FramePlan`, a variant of [`Technique`] with its
//! name and summary, a line in [`plan`], and its settings as data (`settings.rs`). What they share is
//! [`Frame`]: the camera, surfaces, and the ambient, light and mask passes.
//!
//! # A technique of your own
//!
//! needs nothing but [`Frame`]: any function to a plan will do, in any crate. This one flattens every
//! caster onto the ground and marks it in the stencil, and light is added where nothing is marked.
//!
//! ```
//! use stencilscope::geometry::{GeometryCache, relative};
//! use stencilscope::plan::{ColorWrite, Draw, DrawMesh, FramePlan, Part, RasterState, StencilFace};
//! use stencilscope::scene::{Light, Object, SceneBuilder, shapes};
//! use stencilscope::session::Session;
//! use stencilscope::technique::{Choice, Drawn, Frame, Job, PlanError, StencilUse, Technique};
//! use stencilscope::testing::{Label, Rendered};
//! use stencilscope::wgpu::{CompareFunction, DepthBiasState, StencilOperation};
//!
//! fn ground_shadows(job: Job) -> Result<FramePlan, PlanError> {
//!     let mut frame = Frame::new(job, StencilUse::Always)?;
//!     frame.plan.technique = "ground-shadows".to_owned();
//!     frame.ambient_pass();
//!     let mark = StencilFace {
//!         compare: CompareFunction::Always,
//!         pass_op: StencilOperation::Replace,
//!         ..StencilFace::IGNORE
//!     };
//!     // A flattened caster lies in the ground: it is pulled a little towards the eye.
//!     let raster = RasterState {
//!         depth_write: false,
//!         depth_bias: DepthBiasState { constant: 64, slope_scale: 2.0, clamp: 0.0 },
//!         color: ColorWrite::None,
//!         ..RasterState::surface()
//!     };
//!     let raster = raster.with_stencil(mark, 1);
//!     for light in frame.light_ids() {
//!         let (at, eye) = (frame.light_position(light), frame.eye());
//!         let mut draws = Vec::new();
//!         for index in (0..frame.placed.len()).filter(|index| *index > 0) {
//!             let (placed, name) = (&frame.placed[index], format!("shadow of {}", frame.placed[index].object.name));
//!             // Where the line from the light through a point meets the height 0.
//!             let flat = placed.world.iter().map(|point| point.extend(1.0) * at.y - at * point.y);
//!             let vertices = flat.map(|point| relative::homogeneous(point, eye)).collect();
//!             let indices = placed.object.mesh.triangles().as_flattened().to_vec();
//!             let mesh = DrawMesh::of_positions(&name, vertices, indices);
//!             let triangles = mesh.triangles();
//!             let mesh = frame.add_mesh(mesh);
//!             draws.push(Draw::of_positions(name, Part::PlanarShadow, mesh, triangles, raster.clone()));
//!         }
//!         frame.stencil_pass(light, "shadows", "Marks what the flattened casters cover.", draws);
//!         frame.mask_pass(light, &[Drawn::lit(), Drawn::shadow().where_stencil(0xff, 1)]);
//!         let purpose = "Adds the light where nothing is marked.";
//!         frame.light_pass(light, purpose, &Drawn::light_once_where_zero(0xff));
//!     }
//!     Ok(frame.finish())
//! }
//!
//! let scene = SceneBuilder::new("a box over the ground")
//!     .object(Object::of("ground", shapes::quad([8.0, 8.0])?))
//!     .object(Object::of("box", shapes::cuboid([1.0, 0.2, 1.0])?).at([0.0, 1.0, 0.0]))
//!     .light(Light::point([0.0, 3.0, 0.0]))
//!     .seen_from([4.0, 2.0, 0.0], [0.0, 0.3, 0.0])
//!     .build();
//! let (choice, mut cache) = (Choice::new(Technique::None), GeometryCache::default());
//! let job = Job { scene: &scene, size: [160, 120], choice: &choice, cache: &mut cache };
//! let mut frame = Rendered::of_plan(Session::new(None)?, &scene, ground_shadows(job)?)?;
//!
//! // It agrees with z-fail on the ground: below the box, and far from it.
//! let mut truth = Rendered::new(&scene, Choice::new(Technique::ZFail), [160, 120])?;
//! for (pixel, label) in [([80, 70], Label::Shadow), ([20, 100], Label::Lit)] {
//!     frame.at(pixel).label(0, label).agrees();
//!     truth.at(pixel).label(0, label);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod auto;
mod casters;
mod frame;
mod maps;
mod none;
mod planar;
mod planar_texture;
mod projective;
mod ray_traced;
mod receivers;
mod settings;
mod shadow_map;
mod shown;
mod silhouettes;
mod surfaces;
mod volume;

pub use frame::{Drawn, Frame, Job, MOST_LIGHTS, Piece, Placed, StencilUse};
pub use planar::PlanarSettings;
pub use settings::{Choice, ChoiceError, CommonSettings, ReportRows, SettingSpec, SettingValues, Values};
pub use shadow_map::MapSettings;
pub use volume::{VolumeSettings, WhoCasts, casting};

use crate::plan::FramePlan;

/// Plans one frame.
///
/// # Errors
/// A camera or light that can't be used, or too many lights.
pub fn plan(job: Job) -> Result<FramePlan, PlanError> {
    match job.choice.technique() {
        Technique::None => none::plan(job),
        Technique::Planar => planar::plan(job),
        Technique::PlanarTexture => planar_texture::plan(job),
        Technique::ZPass | Technique::ZFail | Technique::ZPassPlus => volume::plan(job),
        Technique::Auto => auto::plan(job),
        Technique::ShadowMap => shadow_map::plan(job),
        Technique::Projective => projective::plan(job),
        Technique::RayTraced => ray_traced::plan(job),
    }
}

/// Why a scene can't be planned.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// A camera, light or object that no technique can draw.
    #[error("{problem}")]
    Unusable {
        /// What is wrong, and the mend.
        problem: String,
    },
    /// More lights than bits in a word.
    #[error("{count} lights are too many: leave out {}, at most {MOST_LIGHTS} fit", count - MOST_LIGHTS)]
    TooManyLights {
        /// How many the scene has.
        count: usize,
    },
}

/// A way to make shadows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Technique {
    /// No shadows at all.
    None,
    /// Casters flattened onto planes.
    Planar,
    /// Casters drawn into a texture of every flat receiver.
    PlanarTexture,
    /// Shadow volumes counted in front of the surface.
    ZPass,
    /// Shadow volumes counted behind the surface.
    ZFail,
    /// Shadow volumes counted in front of the surface, from the near plane's own count on.
    ZPassPlus,
    /// Shadow volumes, each counted as is cheapest while right, and only those that matter.
    Auto,
    /// Depth from the light, compared at every pixel.
    ShadowMap,
    /// Casters' silhouettes projected over the scene.
    Projective,
    /// Rays from eye and light: the ground truth.
    RayTraced,
}

impl Technique {
    /// All that exist, in teaching order.
    pub const ALL: [Technique; 10] = [
        Technique::None,
        Technique::Planar,
        Technique::PlanarTexture,
        Technique::ZPass,
        Technique::ZFail,
        Technique::ZPassPlus,
        Technique::Auto,
        Technique::ShadowMap,
        Technique::Projective,
        Technique::RayTraced,
    ];

    /// The name on the command line, in scene files and manifests.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Technique::None => "none",
            Technique::Planar => "planar",
            Technique::PlanarTexture => "planar-texture",
            Technique::ZPass => "z-pass",
            Technique::ZFail => "z-fail",
            Technique::ZPassPlus => "z-pass-plus",
            Technique::Auto => "auto",
            Technique::ShadowMap => "shadow-map",
            Technique::Projective => "projective",
            Technique::RayTraced => "ray-traced",
        }
    }

    /// What it does, in one sentence.
    #[must_use]
    pub fn summary(self) -> &'static str {
        match self {
            Technique::None => "Every light reaches every surface that faces it: the picture to compare others with.",
            Technique::Planar => {
                "Casters are flattened onto every flat receiver, and the stencil keeps their shadow on it."
            }
            Technique::PlanarTexture => {
                "Draws the casters into a texture of every flat receiver, through the box that the light's pyramid becomes."
            }
            Technique::ZPass => {
                "Counts the shadow volumes that the view ray is inside of when it reaches the surface, from the eye on."
            }
            Technique::ZFail => {
                "Counts the same volumes from infinity back to the surface, so the eye may be inside one."
            }
            Technique::ZPassPlus => {
                "Counts the near plane's volumes from the light first, then as z-pass: the eye may be inside one."
            }
            Technique::Auto => {
                "Counts each volume by z-pass or z-fail, whichever is cheaper while right, and leaves out what nothing needs."
            }
            Technique::ShadowMap => "Stores the depth of what the light sees, and darkens what lies behind it.",
            Technique::Projective => {
                "Throws a picture of each caster's silhouette over the scene like a slide: no depths are compared."
            }
            Technique::RayTraced => {
                "Follows rays from the eye and the light on the CPU: what the other techniques are measured against."
            }
        }
    }

    /// The technique of that name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Technique> {
        Technique::ALL.into_iter().find(|technique| technique.name() == name)
    }
}

//! The techniques: each a pure function from a scene to a [`FramePlan`](crate::plan::FramePlan).
//!
//! A technique is one file with a function `(PlanRequest) → FramePlan`, its settings as constants, and a [`TechniqueDescription`] with
//! all else that is said of it; and a variant of [`Technique`] with its name. The compiler names the few places that
//! ask for more, such as its mark in plots. What techniques share is [`FrameBuilder`]: the camera, surfaces, and the
//! ambient, light and mask passes.
//!
//! # A technique of your own
//!
//! needs nothing but [`FrameBuilder`]: any function to a plan will do, in any crate. This one flattens every
//! caster onto the ground and marks it in the stencil, and light is added where nothing is marked.
//!
//! ```
//! use stencilscope::geometry::{GeometryCache, relative};
//! use stencilscope::plan::{ColorWrite, Draw, DrawMesh, FramePlan, DrawPart, RasterState, StencilFace};
//! use stencilscope::scene::{Light, Object, SceneBuilder, shapes};
//! use stencilscope::session::Session;
//! use stencilscope::technique::{Choice, FrameBuilder, PlanError, PlanRequest, SurfaceDrawing, StencilUse, Technique};
//! use stencilscope::testing::{PixelLabel, Rendered};
//! use stencilscope::wgpu_types::{CompareFunction, DepthBiasState, StencilOperation};
//!
//! fn ground_shadows(job: PlanRequest) -> Result<FramePlan, PlanError> {
//!     let mut frame = FrameBuilder::new(job, StencilUse::Always)?;
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
//!             draws.push(Draw::of_positions(name, DrawPart::PlanarShadow, mesh, triangles, raster.clone()));
//!         }
//!         frame.stencil_pass(light, "shadows", "Marks what the flattened casters cover.", draws);
//!         frame.mask_pass(light, &[SurfaceDrawing::lit(), SurfaceDrawing::shadow().where_stencil(0xff, 1)]);
//!         let purpose = "Adds the light where nothing is marked.";
//!         frame.light_pass(light, purpose, &SurfaceDrawing::light_once_where_zero(0xff));
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
//! let job = PlanRequest { scene: &scene, size: [160, 120], choice: &choice, cache: &mut cache, map_camera: None };
//! let mut frame = Rendered::of_plan(Session::new(None)?, &scene, ground_shadows(job)?)?;
//!
//! // It agrees with z-fail on the ground: below the box, and far from it.
//! let mut truth = Rendered::new(&scene, Choice::new(Technique::ZFail), [160, 120])?;
//! for (pixel, label) in [([80, 70], PixelLabel::Shadow), ([20, 100], PixelLabel::Lit)] {
//!     frame.at(pixel).label(0, label).agrees();
//!     truth.at(pixel).label(0, label);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod auto;
mod casters;
mod choice;
mod description;
mod error;
mod frame;
mod lesson;
mod named;
mod none;
mod outside;
mod plan;
mod planar;
mod planar_texture;
mod projective;
mod ray_traced;
mod receivers;
mod settings;
mod shadow_map;
mod silhouettes;
mod surfaces;
mod visible_triangles;
mod volume;

pub use choice::{Choice, ChoiceError, WIDEST_LIGHT_FRUSTUM};
pub use description::{ComparisonRole, ReportRows, TechniqueDescription};
pub use error::{MOST_LIGHTS, PlanError};
pub use frame::{FrameBuilder, FrameObject, PlanRequest, StencilUse, SurfaceDrawing, SurfacePiece};
#[cfg(feature = "program")]
pub(crate) use lesson::cited;
pub use lesson::{Citation, Lesson};
pub use named::Technique;
pub use plan::plan;
pub(crate) use ray_traced::plan_of_labels;
pub use settings::{
    CasterRule, CommonSettings, CountOperations, MapSettings, PlanarSettings, ReceiverChoice, SettingMap, SettingSpec,
    SettingValues, ShadowBlend, TextureSettings, VolumeSettings,
};
pub use volume::{CasterTriangles, casting};

//! What the fragment shader is given at each pixel: the point of the surface, the normal that it is shaded with, the
//! plane of its triangle.
//!
//! The plan's surfaces are drawn on the CPU, nearest first, once for a frame. A capture folder has no plan: there, and
//! where the depths show that another surface is seen, the plane is fitted through the points of neighbouring pixels.

use crate::capture::{Capture, Image, PixelUnprojection};
use crate::plan::{DrawMesh, FramePlan, LightId, Program, ViewId, Visibility};
use crate::reading::object_ids::fill;
use crate::reading::projected::Projector;
use crate::recorded::SeenSurfaces;
use glam::{DVec3, DVec4};
use std::sync::Arc;

/// The id of the camera's view.
const CAMERA: ViewId = ViewId(0);
/// The bit of a triangle's side flags that is set where the eye sees its back.
const SEES_BACK: u32 = 1 << 31;
/// A drawn point belongs to the surface of the stored depth if the two are nearer to each other than this share of
/// their distance from the eye.
const SAME_SURFACE: f64 = 0.01;

/// What the fragment shader gets for a surface at a pixel's centre, as computed here.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FragmentInputs {
    /// Whether they are of a triangle that the plan draws; otherwise `normal`, `reads` and `layer` are guesses.
    pub is_drawn: bool,
    /// Position in world space, metres.
    pub world: DVec3,
    /// The unit shading normal, towards the side that the eye sees.
    pub normal: DVec3,
    /// The unit normal of its triangle's plane.
    pub plane: DVec3,
    /// Whether its shader looks up the light's map or textures.
    pub reads: bool,
    /// Index of its own layer in the light's texture array; `None` where it has none, or where that is not known.
    pub layer: Option<u32>,
}

/// The fragment shader's inputs at every pixel of the final picture, computed from depths and, where there is a plan,
/// its triangles.
#[derive(Debug)]
pub struct SurfaceFragments {
    surface: PixelUnprojection,
    depth: Arc<Image>,
    drawn: Option<DrawnTriangles>,
    /// What another program's draws show; `None` for a frame of our own.
    seen: Option<SeenSurfaces>,
}

impl SurfaceFragments {
    /// Finds the visible fragments at the end of the frame, and which of them look up the map of the light with this
    /// index; `None` where nothing is drawn. Without a plan, normals are guessed from depths.
    pub fn new(capture: &Capture, plan: Option<&Arc<FramePlan>>, light: usize) -> Option<SurfaceFragments> {
        if capture.origin.is_none() {
            return SurfaceFragments::of_own(capture, plan, light);
        }
        let seen = of_size(capture, plan).map(|plan| SeenSurfaces::of(plan, capture));
        SurfaceFragments::from_depths(capture).map(|fragments| SurfaceFragments { seen, ..fragments })
    }

    /// As [`SurfaceFragments::new`] for a frame of our own: a page, which asks about no other, needs no ray tracing.
    pub fn of_own(capture: &Capture, plan: Option<&Arc<FramePlan>>, light: usize) -> Option<SurfaceFragments> {
        let drawn = of_size(capture, plan).map(|plan| DrawnTriangles::new(capture, plan, light));
        SurfaceFragments::from_depths(capture).map(|fragments| SurfaceFragments { drawn, ..fragments })
    }

    fn from_depths(capture: &Capture) -> Option<SurfaceFragments> {
        let depth = capture.frame_at(capture.steps.len().checked_sub(1)?)?.depth.image.clone();
        Some(SurfaceFragments { surface: PixelUnprojection::new(capture), depth, drawn: None, seen: None })
    }

    /// Returns whether the plan's triangles are known, so that normals are those that were drawn and not guesses.
    pub fn are_drawn(&self) -> bool {
        self.drawn.is_some() || self.seen.is_some()
    }

    /// Returns the fragment at a pixel (column, row); `None` where the pixel shows no surface. Where no drawn triangle
    /// is known there, position and plane are computed from depths ([`FragmentInputs::is_drawn`] is false).
    pub fn at(&self, at: [u32; 2]) -> Option<FragmentInputs> {
        let world = self.surface.at(at, self.depth.depth_at(at)?)?;
        let most = SAME_SURFACE * world.distance(self.surface.eye);
        let drawn = self.drawn.as_ref().and_then(|drawn| drawn.at(at, &self.surface));
        let drawn = drawn.filter(|fragment| fragment.world.distance(world) <= most);
        let seen = || self.seen.as_ref()?.drawn(at, world);
        let drawn = drawn.or_else(|| {
            let (world, plane) = seen()?;
            Some(FragmentInputs { is_drawn: true, world, normal: plane, plane, reads: true, layer: None })
        });
        Some(drawn.unwrap_or_else(|| {
            let plane = self.surface.guessed_normal(&self.depth, at, world);
            FragmentInputs { is_drawn: false, world, normal: plane, plane, reads: true, layer: None }
        }))
    }

    /// Returns the surface's world position at a pixel, and whether its shader looks up the light's map, without
    /// computing the normal; `None` where the pixel shows no surface.
    pub fn place(&self, at: [u32; 2]) -> Option<(DVec3, bool)> {
        let world = self.surface.at(at, self.depth.depth_at(at)?)?;
        Some((world, self.drawn.as_ref().and_then(|drawn| drawn.place(at)).is_none_or(|place| place.reads)))
    }

    /// Returns where the view rays through a pixel's four corners hit a fragment's plane, world space, in order round
    /// it from the upper left; `None` where one does not hit it in front of the eye.
    pub fn corners(&self, [x, y]: [u32; 2], fragment: &FragmentInputs) -> Option<[DVec3; 4]> {
        let eye = self.surface.eye;
        let height = fragment.plane.dot(fragment.world - eye);
        let corner = |right: f64, down: f64| {
            let ray = self.surface.ray([f64::from(x) + right, f64::from(y) + down]);
            let distance = (height - fragment.plane.dot(ray.from)) / fragment.plane.dot(ray.along);
            (distance.is_finite() && distance > 0.0).then(|| eye + ray.at(distance))
        };
        Some([corner(0.0, 0.0)?, corner(1.0, 0.0)?, corner(1.0, 1.0)?, corner(0.0, 1.0)?])
    }
}

/// Returns the plan if it is one for pictures of a capture's size.
fn of_size<'a>(capture: &Capture, plan: Option<&'a Arc<FramePlan>>) -> Option<&'a Arc<FramePlan>> {
    plan.filter(|plan| plan.size == capture.size)
}

/// The triangle of the plan that each pixel shows.
#[derive(Debug)]
struct DrawnTriangles {
    plan: Arc<FramePlan>,
    /// For each pixel the index of its triangle in `places` plus 1; 0 where there is none.
    ids: Vec<u32>,
    places: Vec<PlanTriangle>,
}

/// The mesh and the index of a triangle in a plan, and how it is drawn.
#[derive(Debug, Clone, Copy)]
struct PlanTriangle {
    mesh: u32,
    triangle: u32,
    reads: bool,
    layer: Option<u32>,
}

impl DrawnTriangles {
    fn new(capture: &Capture, plan: &Arc<FramePlan>, light: usize) -> DrawnTriangles {
        let places = places(plan, light);
        let size = capture.size.map(|side| side as usize);
        let projector = Projector::new(capture);
        let mut ids = vec![0_u32; size[0] * size[1]];
        let mut nearness = vec![0.0_f64; ids.len()];
        for (index, place) in places.iter().enumerate() {
            let Some((_, corners)) = triangle(plan, *place) else { continue };
            let polygon = projector.polygon(corners.map(|corner| (capture.camera.eye + corner).extend(1.0)));
            for last in 2..polygon.len() {
                fill([polygon[0], polygon[last - 1], polygon[last]], size, |at, near| {
                    if near > nearness[at] {
                        nearness[at] = near;
                        ids[at] = index as u32 + 1;
                    }
                });
            }
        }
        DrawnTriangles { plan: plan.clone(), ids, places }
    }

    fn place(&self, [x, y]: [u32; 2]) -> Option<PlanTriangle> {
        let index = (y as usize).checked_mul(self.plan.size[0] as usize)? + x as usize;
        self.places.get((*self.ids.get(index)? as usize).checked_sub(1)?).copied()
    }

    fn at(&self, [x, y]: [u32; 2], surface: &PixelUnprojection) -> Option<FragmentInputs> {
        let place = self.place([x, y])?;
        let (mesh, [a, b, c]) = triangle(&self.plan, place)?;
        let ray = surface.ray([f64::from(x) + 0.5, f64::from(y) + 0.5]);
        let across = (b - a).cross(c - a);
        let relative = ray.at(across.dot(a - ray.from) / across.dot(ray.along));
        let area = across.length_squared();
        let shares = [(b, c), (c, a), (a, b)].map(|(from, to)| across.dot((to - from).cross(relative - from)) / area);
        let data = mesh.surface.as_ref()?;
        let normals = data.normals.of_triangle(place.triangle as usize, mesh.corners(place.triangle, 0)?)?;
        let wide = |normal: [f32; 3]| DVec3::from_array(normal.map(f64::from));
        let normal: DVec3 = normals.into_iter().zip(shares).map(|(normal, share)| wide(normal) * share).sum();
        let sees_back = data.sides.data().get(place.triangle as usize)? & SEES_BACK != 0;
        let fragment = FragmentInputs {
            is_drawn: true,
            world: surface.eye + relative,
            normal: if sees_back { -normal } else { normal }.try_normalize()?,
            plane: across.try_normalize()?,
            reads: place.reads,
            layer: place.layer,
        };
        fragment.world.is_finite().then_some(fragment)
    }
}

/// Returns the triangles with normals that the camera's shading and label passes draw, each once, with whether a shader
/// reads the map or textures of `light` for it, and its layer.
fn places(plan: &FramePlan, light: usize) -> Vec<PlanTriangle> {
    const DRAWN: u8 = 1;
    const READS: u8 = 2;
    let mut found: Vec<Vec<(u8, Option<u32>)>> = vec![Vec::new(); plan.meshes.len()];
    for pass in plan.passes.iter().filter(|pass| pass.view == CAMERA) {
        let is_of_light = pass.light == Some(LightId(light));
        for draw in &pass.draws {
            let how = match draw.program {
                Program::Light(Visibility::Map | Visibility::Projected | Visibility::ReceiverTexture)
                | Program::Label(Visibility::Map | Visibility::Projected | Visibility::ReceiverTexture)
                | Program::Arriving(Visibility::Map | Visibility::Projected | Visibility::ReceiverTexture)
                    if is_of_light =>
                {
                    DRAWN | READS
                }
                Program::Light(_)
                | Program::AmbientDiffuse
                | Program::Label(_)
                | Program::Arriving(_)
                | Program::Ambient { .. } => DRAWN,
                _ => continue,
            };
            let Some(mesh) = plan.meshes.get(draw.mesh.0).filter(|mesh| mesh.surface.is_some()) else { continue };
            let of_mesh = &mut found[draw.mesh.0];
            of_mesh.resize(mesh.indices.data().len() / 3, (0, None));
            let range = draw.triangles.start as usize..draw.triangles.end as usize;
            let layer = draw.constants.layer;
            of_mesh.get_mut(range).into_iter().flatten().for_each(|(drawn, own)| {
                *drawn |= how;
                *own = own.or(layer);
            });
        }
    }
    let places = found.iter().enumerate().flat_map(|(mesh, triangles)| {
        let drawn = triangles.iter().enumerate().filter(|(_, (how, _))| *how != 0);
        drawn.map(move |(triangle, (how, layer))| PlanTriangle {
            mesh: mesh as u32,
            triangle: triangle as u32,
            reads: how & READS != 0,
            layer: *layer,
        })
    });
    places.collect()
}

/// Returns the triangle's mesh, and its corners relative to the eye; `None` where an index is out of range.
fn triangle(plan: &FramePlan, place: PlanTriangle) -> Option<(&DrawMesh, [DVec3; 3])> {
    let mesh = plan.meshes.get(place.mesh as usize)?;
    let first = place.triangle as usize * 3;
    let indices = mesh.indices.data().get(first..first + 3)?;
    let corner = |index: usize| Some(xyz(*mesh.vertices.data().get(indices[index] as usize)?).truncate());
    Some((mesh, [corner(0)?, corner(1)?, corner(2)?]))
}

fn xyz(value: [f32; 4]) -> DVec4 {
    DVec4::from_array(value.map(f64::from))
}

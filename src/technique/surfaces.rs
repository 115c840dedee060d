//! Drawn surfaces as data for the GPU: positions, normals, and which triangles face away.

use crate::geometry::{Caster, DrawnSurface, Facings, GeometryCache, relative};
use crate::plan::{Blob, DrawMesh, SurfaceData, SurfaceNormals};
use crate::scene::{Mesh, Object, Scene, Shading};
use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;

/// How many triangles one thread picks, at least.
const SHARE: usize = 16 * 1024;

/// Returns the mesh of an object's surface for shading: positions relative to the eye, and for each corner normals and
/// texture coordinates (if any group has a texture). `shading`, if given, overrides the materials'. Vertex data is
/// cached.
pub fn draw_mesh(
    object: &Object,
    world: &[DVec3],
    scene: &Scene,
    shading: Option<Shading>,
    cache: &mut GeometryCache,
) -> DrawMesh {
    let eye = scene.camera.eye;
    let mesh = &object.mesh;
    let shadings: Vec<Shading> = mesh
        .groups()
        .iter()
        .map(|group| shading.unwrap_or(group.material.unwrap_or(object.material).shading))
        .collect();
    let make = || DrawnSurface {
        vertices: Blob::new(world.iter().map(|position| relative::point(*position, eye)).collect()),
        indices: Blob::new(mesh.triangles().as_flattened().to_vec()),
        normals: normals(object, world, &shadings),
    };
    let of = Caster { mesh, pose: &object.pose, world };
    let DrawnSurface { vertices, indices, normals } = cache.surface(of, eye, &shadings, make);
    DrawMesh {
        surface: Some(SurfaceData {
            normals,
            sides: Blob::new(sides(object, world, scene, cache)),
            uvs: uvs(object, world).map(Blob::new),
        }),
        ..DrawMesh::of_blobs(&object.name, vertices, indices)
    }
}

/// Returns [`SurfaceData::uvs`]: texture coordinates of all corners, zero for groups without a texture or triangles
/// without coordinates; by world x and −z where the texture has a side in metres. `None` where no group has a texture.
fn uvs(object: &Object, world: &[DVec3]) -> Option<Vec<[f32; 2]>> {
    let mesh = &object.mesh;
    mesh.groups().iter().find_map(|group| object.texture_of(group))?;
    let mut uvs = Vec::with_capacity(mesh.triangles().len() * 3);
    for group in mesh.groups() {
        let texture = object.texture_of(group);
        match texture.map(|texture| texture.side) {
            None => uvs.extend(group.triangles.clone().flat_map(|_| [[0.0; 2]; 3])),
            Some(None) => {
                let given = |triangle| mesh.corner_uvs().and_then(|uvs| uvs[triangle]).unwrap_or_default();
                uvs.extend(group.triangles.clone().flat_map(given).map(|uv| uv.to_array()));
            }
            // As seen from above, with X to the right: its upper edge lies towards −Z.
            Some(Some(side)) => {
                let place = |vertex: u32| {
                    let at = world[vertex as usize] / f64::from(side);
                    DVec2::new(at.x, -at.z)
                };
                let corners = || group.triangles.clone().flat_map(|triangle| mesh.triangles()[triangle]);
                // Whole repetitions are subtracted, which changes nothing where a texture repeats: small numbers are
                // exact enough in single precision.
                let repeats = texture.is_some_and(|texture| !texture.clamps);
                let first = corners().map(place).reduce(DVec2::min).filter(|_| repeats).unwrap_or_default().floor();
                uvs.extend(corners().map(|vertex| (place(vertex) - first).as_vec2().to_array()));
            }
        }
    }
    Some(uvs)
}

/// Returns [`SurfaceData::sides`]: a word for each triangle, whose bit n is set where it faces away from light n as the
/// eye sees it, and bit 31 where the eye sees its back.
fn sides(object: &Object, world: &[DVec3], scene: &Scene, cache: &mut GeometryCache) -> Vec<u32> {
    let triangles = object.mesh.triangles();
    let planes = cache.planes(Caster { mesh: &object.mesh, pose: &object.pose, world });
    let (mut of_eye, mut of_light) = (Facings::default(), Facings::default());
    planes.facings(world, triangles, scene.camera.eye_position(), &mut of_eye);
    let mut sides: Vec<u32> = of_eye.signs().iter().map(|eye| u32::from(*eye < 0) << 31).collect();
    for (index, light) in scene.lights.iter().enumerate() {
        planes.facings(world, triangles, light.homogeneous(), &mut of_light);
        let signs = of_eye.signs().iter().zip(of_light.signs());
        for (word, (eye, light)) in sides.iter_mut().zip(signs) {
            *word |= u32::from(*eye == 0 || light != eye) << index;
        }
    }
    sides
}

/// Returns unit normals of all corners, world space, on the side from which corners run counter-clockwise: the
/// triangle's, the mesh's own, or averaged, as each group's shading asks.
fn normals(object: &Object, world: &[DVec3], shadings: &[Shading]) -> SurfaceNormals {
    let mesh = &object.mesh;
    let face_normal = |triangle: usize| scaled_normal(world, mesh.triangles()[triangle]);
    let are_averaged = mesh.corner_normals().is_none() && shadings.iter().any(|shading| *shading != Shading::Flat);
    let averaged = if are_averaged { averaged_normals(mesh, world) } else { Vec::new() };
    let world_from_object = DMat3::from_mat4(object.pose.world_from_object());
    // Mirroring flips the winding, but not a stored normal.
    let orientation = world_from_object.determinant().signum();
    let normal_from_object = world_from_object.inverse().transpose() * orientation;
    let group_of = |triangle: usize| mesh.groups().partition_point(|group| group.triangles.end <= triangle);
    let of_triangle = |triangle: usize| {
        let stored = |normal: DVec3| {
            let usable = normal.try_normalize().or_else(|| face_normal(triangle).try_normalize());
            usable.unwrap_or(DVec3::Y).as_vec3().to_array()
        };
        match (shadings[group_of(triangle)], mesh.corner_normals()) {
            (Shading::Flat, _) => [stored(face_normal(triangle)); 3],
            (_, Some(given)) => given[triangle].map(|given| stored(normal_from_object * given.as_dvec3())),
            (_, None) => mesh.triangles()[triangle]
                .map(|vertex| averaged[vertex as usize].unwrap_or_else(|| stored(face_normal(triangle)))),
        }
    };
    SurfaceNormals::new(mesh.triangles().as_flattened(), world.len(), of_triangle)
}

fn scaled_normal(world: &[DVec3], corners: [u32; 3]) -> DVec3 {
    let [a, b, c] = corners.map(|vertex| world[vertex as usize]);
    (b - a).cross(c - a)
}

/// Returns for each vertex the unit normal that its triangles have on average, weighted by area; `None` where the
/// sum of their normals can't be normalised.
fn averaged_normals(mesh: &Mesh, world: &[DVec3]) -> Vec<Option<[f32; 3]>> {
    let mut sums = vec![DVec3::ZERO; mesh.positions().len()];
    for corners in mesh.triangles() {
        let normal = scaled_normal(world, *corners);
        corners.iter().for_each(|vertex| sums[*vertex as usize] += normal);
    }
    sums.iter().map(|sum| sum.try_normalize().map(|normal| normal.as_vec3().to_array())).collect()
}

/// Returns a mesh of the triangles with these indices, in this order. It shares all vertices of `mesh`, so that depths
/// are bit-equal; extrusion and retained fragments are dropped.
pub fn subset(mesh: &DrawMesh, name: &str, triangles: &[u32]) -> DrawMesh {
    fn pick<T: bytemuck::Pod + Send + Sync, const N: usize>(blob: &Blob<T>, triangles: &[u32]) -> Blob<T> {
        let all = blob.data().as_chunks::<N>().0;
        let of = triangles.par_iter().with_min_len(SHARE).map(|triangle| all[*triangle as usize]);
        Blob::new(of.collect::<Vec<[T; N]>>().into_flattened())
    }
    let indices = pick::<_, 3>(&mesh.indices, triangles);
    DrawMesh {
        surface: mesh.surface.as_ref().map(|surface| SurfaceData {
            normals: SurfaceNormals::new(indices.data(), mesh.vertices.len(), |triangle| {
                let of = triangles[triangle];
                let own = mesh.corners(of, 0).and_then(|corners| surface.normals.of_triangle(of as usize, corners));
                own.unwrap_or_default()
            }),
            sides: pick::<_, 1>(&surface.sides, triangles),
            uvs: surface.uvs.as_ref().map(|uvs| pick::<_, 3>(uvs, triangles)),
        }),
        source_triangles: Some(Blob::new(triangles.iter().map(|triangle| mesh.source_triangle(*triangle)).collect())),
        ..DrawMesh::of_blobs(name, mesh.vertices.clone(), indices)
    }
}

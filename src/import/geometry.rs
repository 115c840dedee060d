//! The vertices of a draw, instance by instance: positions are gathered, indices followed, strips and fans split into
//! triangles.

use super::blobs::BlobFile;
use super::document::RenderDocInstance;
use super::error::ImportError;
use super::raw::RawTopology;
use super::unroll;
use std::ops::Range;

/// Size of a clip-space position in bytes: four 32-bit floats.
const POSITION: usize = 16;

/// The vertices and triangles of a draw after the vertex shader.
#[derive(Debug)]
pub struct DrawGeometry {
    pub topology: RawTopology,
    pub positions: Vec<[f32; 4]>,
    /// The layer of the target that each vertex names; empty where vertices name none.
    pub layers: Vec<u32>,
    pub triangles: Vec<[u32; 3]>,
    /// The range of triangles of each instance.
    pub instances: Vec<Range<usize>>,
    /// The number of triangles' corners that refer to no vertex.
    pub dropped: usize,
}

/// Reads the vertices and triangles of all instances of a draw, one after the other, with indices into the joined
/// vertices. Triangles with a corner that refers to no vertex are left out, and those corners counted. `layer_at` is where
/// in a vertex its layer is, in bytes.
pub fn read(
    instances: &[RenderDocInstance],
    layer_at: Option<u64>,
    blobs: &mut BlobFile,
) -> Result<DrawGeometry, ImportError> {
    let mut all = DrawGeometry {
        topology: instances.first().map_or(RawTopology::Other, |first| topology(&first.topology)),
        positions: Vec::new(),
        layers: Vec::new(),
        triangles: Vec::new(),
        instances: Vec::new(),
        dropped: 0,
    };
    for instance in instances {
        let first = u32::try_from(all.positions.len()).map_err(|_| too_many())?;
        let bytes = blobs.read(instance.vertices)?;
        let mut positions = positions(&bytes, instance.stride)?;
        if instance.indices.is_none() {
            positions.truncate(usize::try_from(instance.count).unwrap_or(usize::MAX));
        }
        let count = u32::try_from(positions.len()).ok().filter(|count| first.checked_add(*count).is_some());
        let count = count.ok_or_else(too_many)?;
        let corners = corners(instance, count, blobs)?;
        // A strip has nearly one triangle for each corner.
        blobs.reserve((positions.len() * (POSITION + 4) + corners.len() * 20) as u64)?;
        if let Some(at) = layer_at {
            all.layers.extend(layers(&bytes, instance.stride, at).take(positions.len()));
            all.layers.resize(all.positions.len() + positions.len(), 0);
        }
        let start = all.triangles.len();
        for triangle in unroll::triangles(all.topology, &corners) {
            let dropped = triangle.iter().filter(|corner| **corner >= count).count();
            all.dropped += dropped;
            if dropped == 0 {
                all.triangles.push(triangle.map(|corner| first + corner));
            }
        }
        all.positions.append(&mut positions);
        all.instances.push(start..all.triangles.len());
    }
    Ok(all)
}

fn too_many() -> ImportError {
    ImportError::TooLarge { what: "more than 4 294 967 295 vertices in a draw".to_owned() }
}

fn topology(name: &str) -> RawTopology {
    match name {
        "PointList" => RawTopology::Points,
        "LineList" | "LineStrip" | "LineLoop" | "LineList_Adj" | "LineStrip_Adj" => RawTopology::Lines,
        "TriangleList" => RawTopology::TriangleList,
        "TriangleStrip" => RawTopology::TriangleStrip,
        "TriangleFan" => RawTopology::TriangleFan,
        "TriangleList_Adj" => RawTopology::TriangleListAdjacency,
        "TriangleStrip_Adj" => RawTopology::TriangleStripAdjacency,
        _ => RawTopology::Other,
    }
}

/// Returns the first four little-endian floats of every `stride` bytes; a last vertex too short for them is left out.
/// Fails where the stride is less than 16 or no multiple of 4.
fn positions(bytes: &[u8], stride: u64) -> Result<Vec<[f32; 4]>, ImportError> {
    let stride = usize::try_from(stride).ok().filter(|stride| *stride >= POSITION && stride % 4 == 0);
    let stride = stride.ok_or_else(|| ImportError::Folder("vertices lie closer than a position is long".to_owned()))?;
    let position = |vertex: &[u8]| {
        let mut floats = vertex.as_chunks::<4>().0.iter().map(|float| f32::from_le_bytes(*float));
        std::array::from_fn(|_| floats.next().unwrap_or(f32::NAN))
    };
    // The last vertex may lack bytes after its position.
    Ok(bytes.chunks(stride).filter(|vertex| vertex.len() >= POSITION).map(position).collect())
}

/// Returns the layers that vertices name: the little-endian integer at byte `at` of every `stride` bytes; 0 where it is
/// beyond them.
fn layers(bytes: &[u8], stride: u64, at: u64) -> impl Iterator<Item = u32> {
    let at = usize::try_from(at).unwrap_or(usize::MAX);
    let stride = usize::try_from(stride).unwrap_or(usize::MAX).max(1);
    bytes.chunks(stride).map(move |vertex| {
        let layer = vertex.get(at..).and_then(<[u8]>::first_chunk::<4>);
        layer.map_or(0, |layer| u32::from_le_bytes(*layer))
    })
}

/// Returns an instance's corners in order, as indices of its vertices with the base vertex added; `None` where the
/// primitive restarts, `u32::MAX` where none can be meant. Without indices all vertices in order.
fn corners(instance: &RenderDocInstance, vertices: u32, blobs: &mut BlobFile) -> Result<Vec<Option<u32>>, ImportError> {
    let Some(indices) = instance.indices else { return Ok((0..vertices).map(Some).collect()) };
    let bytes = blobs.read(indices)?;
    blobs.reserve(bytes.len() as u64 * 8)?;
    let indices: Vec<u32> = match instance.index_stride {
        1 => bytes.iter().map(|index| u32::from(*index)).collect(),
        2 => bytes.as_chunks::<2>().0.iter().map(|index| u32::from(u16::from_le_bytes(*index))).collect(),
        4 => bytes.as_chunks::<4>().0.iter().map(|index| u32::from_le_bytes(*index)).collect(),
        stride => return Err(ImportError::Folder(format!("indices are {stride} bytes long"))),
    };
    // OpenGL's fixed index, like Vulkan's, has all bits of the index.
    let all_bits = u32::MAX >> (32 - 8 * instance.index_stride);
    let restart = instance.restart.map(|restart| restart & all_bits);
    let vertex = |index: u32| u32::try_from(i64::from(index).saturating_add(instance.base_vertex)).unwrap_or(u32::MAX);
    Ok(indices.into_iter().map(|index| (Some(index) != restart).then(|| vertex(index))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_are_integers_beside_the_position() {
        let vertex =
            |layer: i32| [[1.0_f32; 4].map(f32::to_le_bytes).as_flattened(), &layer.to_le_bytes()[..]].concat();
        let bytes = [vertex(3), vertex(-1), vertex(5)[..18].to_vec()].concat();
        assert_eq!(layers(&bytes, 20, 16).collect::<Vec<_>>(), [3, u32::MAX, 0]);
        for at in [17, u64::MAX] {
            assert_eq!(layers(&vertex(3), 20, at).collect::<Vec<_>>(), [0], "{at}");
        }
    }

    #[test]
    fn positions_are_the_first_four_floats_and_may_be_nan() {
        let floats = [1.0, 2.0, 3.0, 4.0, 9.0, f32::NAN, f32::INFINITY, 7.0, 8.0];
        let bytes: Vec<u8> = floats.into_iter().flat_map(f32::to_le_bytes).collect();
        let found = positions(&bytes, 20).expect("positions");
        assert_eq!(found[0], [1.0, 2.0, 3.0, 4.0]);
        assert!(found.len() == 2 && found[1][0].is_nan() && found[1][1].is_infinite());
        for stride in [0, 3, 12, 17, u64::MAX] {
            assert!(positions(&bytes, stride).is_err(), "{stride}");
        }
    }
}

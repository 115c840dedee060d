//! A draw into all layers of a target, of which each triangle has one: it becomes a draw for each layer, so that what follows
//! knows draws into one layer alone.

use super::raw::RawDraw;
use std::collections::BTreeMap;
use std::ops::Range;

/// The draws that a layered draw consists of.
#[derive(Debug)]
pub struct SplitDraw {
    /// The draw into each layer that gets a triangle, by the layer; all into layer 0 where there are none.
    pub draws: BTreeMap<u32, RawDraw>,
    /// The number of triangles whose layer is not there.
    pub dropped: usize,
}

impl SplitDraw {
    /// Splits a draw by the layers that its vertices name, of which there are `count`. The first corner of a triangle
    /// decides: all three should name one. Vertices that name none are of layer 0.
    pub fn of(draw: &RawDraw, layers: &[u32], count: u32) -> SplitDraw {
        let layer = |triangle: &[u32; 3]| layers.get(triangle[0] as usize).copied().unwrap_or(0);
        let mut of_layer: BTreeMap<u32, LayerTriangles> = BTreeMap::new();
        let mut dropped = 0;
        for (instance, range) in draw.instances.iter().enumerate() {
            for triangle in draw.triangles.get(range.clone()).unwrap_or_default() {
                match layer(triangle) {
                    layer if layer < count => of_layer.entry(layer).or_default().add(draw, instance, triangle),
                    _ => dropped += 1,
                }
            }
        }
        let mut draws: BTreeMap<u32, RawDraw> =
            of_layer.into_iter().map(|(layer, triangles)| (layer, triangles.draw(draw))).collect();
        if draws.is_empty() {
            draws.insert(0, RawDraw { triangles: Vec::new(), instances: Vec::new(), ..draw.clone() });
        }
        SplitDraw { draws, dropped }
    }

    /// Returns how many bytes of memory the parts of a draw in `count` layers take at most: where they share no vertex, and
    /// each has triangles of the last instance.
    pub fn most_bytes(draw: &RawDraw, count: usize) -> u64 {
        // A triangle, its vertices, and the numbers that these had and have.
        let of_triangle = size_of::<([u32; 3], [[f32; 4]; 3], [[u32; 2]; 3])>();
        let of_instances = draw.instances.len() as u64 * size_of::<Range<usize>>() as u64;
        draw.triangles.len() as u64 * of_triangle as u64 + of_instances * count as u64
    }
}

/// The part of a draw that goes into one layer.
#[derive(Debug, Default)]
struct LayerTriangles {
    positions: Vec<[f32; 4]>,
    triangles: Vec<[u32; 3]>,
    instances: Vec<Range<usize>>,
    /// The vertex here of one of the draw.
    known: BTreeMap<u32, u32>,
}

impl LayerTriangles {
    fn add(&mut self, draw: &RawDraw, instance: usize, triangle: &[u32; 3]) {
        let vertex = triangle.map(|corner| {
            let next = self.positions.len() as u32;
            *self.known.entry(corner).or_insert_with(|| {
                self.positions.push(draw.positions.get(corner as usize).copied().unwrap_or([f32::NAN; 4]));
                next
            })
        });
        let at = self.triangles.len();
        self.instances.resize(instance + 1, at..at);
        self.triangles.push(vertex);
        self.instances[instance].end = at + 1;
    }

    fn draw(mut self, of: &RawDraw) -> RawDraw {
        let at = self.triangles.len();
        self.instances.resize(of.instances.len(), at..at);
        RawDraw {
            topology: of.topology,
            positions: self.positions,
            triangles: self.triangles,
            instances: self.instances,
            sampled: of.sampled.clone(),
            blend: of.blend.clone(),
            retained: None,
            ..*of
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::raw::{RawCull, RawFragment, RawShape, RawTopology, RawView};
    use crate::plan::ShaderEffect;
    use wgpu_types::PolygonMode;

    /// A draw of two instances, of two triangles and of one, whose vertices are numbered by x.
    fn draw() -> RawDraw {
        RawDraw {
            topology: RawTopology::TriangleList,
            positions: (0..5).map(|x| [x as f32, 0.0, 0.0, 1.0]).collect(),
            triangles: vec![[0, 1, 2], [2, 1, 3], [3, 4, 0]],
            instances: vec![0..2, 2..3],
            view: RawView {
                viewport: [0.0, 0.0, 1.0, 1.0],
                depth_range: [0.0, 1.0],
                scissor: None,
                y_up: true,
                z_from_minus_w: true,
            },
            shape: RawShape {
                cull: RawCull::None,
                front_is_counter_clockwise: true,
                fill: PolygonMode::Fill,
                bias: [0.0; 3],
                depth_clamp: false,
                depth_clip: true,
                clip_planes: false,
            },
            depth: None,
            stencil: None,
            blend: None,
            fragment: RawFragment { may_discard: ShaderEffect::No, writes_depth: ShaderEffect::Yes },
            retained: None,
            samples: 1,
            sampled: Some(vec![7]),
        }
    }

    fn columns(draw: &RawDraw) -> Vec<[f32; 3]> {
        draw.triangles.iter().map(|triangle| triangle.map(|corner| draw.positions[corner as usize][0])).collect()
    }

    #[test]
    fn each_layer_gets_its_triangles_with_their_vertices_alone() {
        let split = SplitDraw::of(&draw(), &[5, 0, 1, 5, 5], 6);
        assert_eq!(split.draws.keys().copied().collect::<Vec<_>>(), [1, 5]);
        let [one, five] = [1, 5].map(|layer| &split.draws[&layer]);
        assert_eq!(columns(one), [[2.0, 1.0, 3.0]]);
        assert_eq!(columns(five), [[0.0, 1.0, 2.0], [3.0, 4.0, 0.0]]);
        assert_eq!([one, five].map(|draw| draw.positions.len()), [3, 5]);
        assert_eq!([one, five].map(|draw| draw.instances.clone()), [vec![0..1, 1..1], vec![0..1, 1..2]]);
        assert_eq!((one.fragment.writes_depth, one.sampled.clone()), (ShaderEffect::Yes, Some(vec![7])));
    }

    #[test]
    fn layers_that_are_not_there_are_counted_and_no_layer_is_the_first() {
        let split = SplitDraw::of(&draw(), &[u32::MAX, 0, 1, 2, 2], 2);
        assert_eq!((split.dropped, split.draws.len()), (2, 1));
        let split = SplitDraw::of(&draw(), &[], 6);
        assert_eq!(split.draws.keys().copied().collect::<Vec<_>>(), [0]);
        assert_eq!(columns(&split.draws[&0]), columns(&draw()));
        let none = SplitDraw::of(&RawDraw { triangles: Vec::new(), instances: Vec::new(), ..draw() }, &[], 6);
        assert_eq!(none.draws.len(), 1);
    }
}

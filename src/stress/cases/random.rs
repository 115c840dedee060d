//! A thousand random scenes: soups of up to two hundred triangles, closed and open, under random eyes, lights and near
//! planes. The value of the case is the seed, so any of them can be examined.

use super::who::{BY_VERTEX_SHADER, FACING_IN_F32, PLAIN};
use crate::math::angle;
use crate::scene::{Camera, Light, Mesh, MeshError, Object, Scene, shapes};
use crate::stress::{CaseNumber, LeastShares, StressCase};
use crate::technique::Technique;
use glam::DVec3;

const OTHERS: &str = "eyes and near planes are anywhere, and receivers are no planes: not promised";

/// The stress case of random triangle soups, eyes, lights and near planes. Only z-fail, also with volumes that a vertex
/// shader extrudes, and auto run in it: no other technique is promised right there.
pub const RANDOM: StressCase = StressCase {
    name: "random",
    lesson: "soups of 1 to 200 triangles, any eye, any light, any near plane: z-fail asks nothing of a scene",
    parameter: "seed",
    values: &SEEDS,
    drives: CaseNumber::Scene(scene),
    without: &[
        (Technique::ZPass, OTHERS),
        (Technique::ZPassPlus, OTHERS),
        (Technique::ShadowMap, OTHERS),
        (Technique::Planar, OTHERS),
        (Technique::PlanarTexture, OTHERS),
        (Technique::Projective, OTHERS),
    ],
    also: &[BY_VERTEX_SHADER],
    failures: &[FACING_IN_F32.at_most(1e-4).perhaps()],
    least: |_| LeastShares::nothing("many eyes look past all there is, and many soups lie wholly in light or shadow"),
    ..PLAIN
};

const SEEDS: [f64; 1000] = {
    let mut seeds = [0.0; 1000];
    let mut index = 0;
    while index < seeds.len() {
        seeds[index] = index as f64;
        index += 1;
    }
    seeds
};

/// A generator of pseudo-random numbers in [0, 1): a linear congruential generator with Knuth's MMIX constants, the
/// same on every machine.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, count: u32) -> u32 {
        (self.unit() * f64::from(count)) as u32
    }

    fn within(&mut self, reach: f64) -> DVec3 {
        let mut one = || (self.unit() * 2.0 - 1.0) * reach;
        DVec3::new(one(), one(), one())
    }
}

fn scene(seed: f64) -> Result<Scene, MeshError> {
    let mut random = Random((seed as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let caster = Object::of("soup", soup(&mut random, seed as u32 % 4)?);
    let visible = random.unit() < 0.8;
    let mut objects = vec![Object { visible, ..caster }];
    if random.unit() < 0.6 || !visible {
        let ground = Object::of("ground", shapes::quad([8.0; 2])?);
        objects.push(ground.at([0.0, -1.2, 0.0]));
    }
    let eye = random.within(2.5);
    let light = match random.below(3) {
        0 => Light::directional(random.within(1.0)),
        // Often inside the soup.
        _ => Light::point(random.within(2.5)),
    };
    let near = angle::pow(10.0, random.unit() * 2.5 - 2.5);
    let camera = Camera {
        eye,
        target: random.within(0.7),
        up: DVec3::Y,
        projection: crate::scene::Projection::Perspective,
        fov_y_degrees: 60.0,
        near,
        far: None,
        viewport: None,
    };
    Ok(Scene {
        name: format!("random {seed}"),
        ambient: [0.12; 3],
        camera,
        lights: vec![light],
        objects,
        technique: None,
        not_taken: Vec::new(),
    })
}

fn soup(random: &mut Random, kind: u32) -> Result<Mesh, MeshError> {
    let count = 1 + random.below(200);
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    match kind {
        // Triangles of any size, none of them connected.
        0 => {
            for first in (0..count).map(|index| 3 * index) {
                let middle = random.within(1.0);
                let size = 0.1 + 0.9 * random.unit();
                points.extend((0..3).map(|_| (middle + random.within(size)).to_array()));
                triangles.push([first, first + 1, first + 2]);
            }
        }
        // Few points, so that edges are shared by any number of triangles, wound in any way.
        1 => {
            let corners = 4 + random.below(12);
            points.extend((0..corners).map(|_| random.within(1.2).to_array()));
            triangles.extend((0..count).map(|_| [0; 3].map(|_| random.below(corners))));
        }
        // Closed and open by turns: tetrahedra, some without a side, that pass through each other.
        2 => {
            for first in (0..count.div_ceil(4)).map(|index| 4 * index) {
                let middle = random.within(1.0);
                points.extend((0..4).map(|_| (middle + random.within(0.6)).to_array()));
                let sides = 4 - random.below(8) / 7;
                let all = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];
                triangles.extend(all[..sides as usize].iter().map(|side| side.map(|corner| first + corner)));
            }
        }
        // A dented ball: closed and consistently wound, but it may pass through itself.
        _ => {
            let rings = 3 + random.below(6);
            let ball = shapes::sphere(1.0, 2 * rings, rings)?;
            points.extend(ball.positions().iter().map(|point| (*point * (0.3 + random.unit())).to_array()));
            triangles.extend(ball.triangles());
        }
    }
    shapes::triangles(&points, &triangles)
}

//! Scenes from a seed in which a technique may go wrong.

use crate::common::random::Random;
use glam::{DMat3, DVec3};
use std::sync::Arc;
use stencilscope::scene::{Light, Mesh, MeshBuilder, Object, Scene, SceneBuilder, builtin, shapes};
use stencilscope::stress::{CaseNumber, StressCase};
use stencilscope::truth::Tracer;

pub fn cuboid(name: &str, at: [f64; 3], size: [f64; 3]) -> Object {
    Object::of(name, shapes::cuboid(size).expect("a box")).at(at)
}

pub fn floor() -> Object {
    Object::of("floor", shapes::quad([6.0; 2]).expect("a floor"))
}

pub fn scene(eye: [f64; 3], target: [f64; 3], light: Light, objects: Vec<Object>) -> Scene {
    SceneBuilder::new("provoked").light(light).objects(objects).seen_from(eye, target).build()
}

/// What a seed decides.
pub struct Dice(pub Random);

impl Dice {
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.unit()
    }

    /// A random index below `count`.
    pub fn one_of(&mut self, count: usize) -> usize {
        (self.0.unit() * count as f64) as usize
    }

    fn lamp(&mut self) -> Light {
        Light::point([self.between(-1.2, 1.2), self.between(3.0, 4.5), self.between(-0.5, 1.5)])
    }

    fn eye(&mut self) -> [f64; 3] {
        let around = self.between(-1.2, 1.2);
        let far = self.between(4.0, 6.0);
        [far * around.sin(), self.between(2.0, 3.5), far * around.cos()]
    }

    /// A place over the middle of the floor.
    fn place(&mut self) -> [f64; 3] {
        [self.between(-0.6, 0.6), self.between(0.7, 1.2), self.between(-0.6, 0.6)]
    }

    fn degrees(&mut self) -> [f64; 3] {
        [self.between(-30.0, 30.0), self.between(0.0, 90.0), self.between(-20.0, 20.0)]
    }

    pub fn closed(&mut self) -> Mesh {
        let size = self.between(0.5, 0.9);
        let made = match self.one_of(3) {
            0 => shapes::cuboid([size, size * 0.8, size * 1.1]),
            1 => shapes::sphere(size * 0.6, 16, 8),
            _ => shapes::torus(size * 0.6, size * 0.25, 20, 10),
        };
        made.expect("a shape")
    }

    /// A mesh over the floor, under a lamp.
    pub fn with(&mut self, mesh: Mesh) -> Scene {
        let caster = Object::of("caster", mesh).at(self.place()).rotated(self.degrees());
        scene(self.eye(), [0.0, 0.3, 0.0], self.lamp(), vec![floor(), caster])
    }

    pub fn still_life(&mut self) -> Scene {
        let mesh = self.closed();
        let mut scene = self.with(mesh);
        if self.one_of(2) == 1 {
            let place = [self.between(1.0, 1.6), self.between(0.4, 0.8), self.between(-1.0, 1.0)];
            scene.objects.push(cuboid("crate", place, [0.4; 3]));
        }
        scene
    }

    /// That, or a built-in scene, from any place.
    pub fn any_scene(&mut self) -> Scene {
        let name = ["", "", "table", "steps", "rings", "tori", "two-lights", "panels"][self.one_of(8)];
        let Some(builtin) = builtin::Builtin::named(name) else { return self.still_life() };
        let mut scene = builtin.scene().expect("a scene");
        scene.camera = scene.camera.anywhere(self.one_of(1 << 20) as u64);
        scene
    }

    /// A box with corners of its own for each triangle, moved apart by a part of its size.
    pub fn seams(&mut self, apart: f64) -> MeshBuilder {
        let size = self.between(0.6, 0.9);
        let cube = shapes::cuboid([size, size * 0.7, size]).expect("a box");
        let mut builder = MeshBuilder::default();
        for (index, corners) in cube.triangles().iter().enumerate() {
            // Both triangles of a side alike.
            let shift = DVec3::new(0.3, 0.5, 0.2) * apart * size * ((index / 2) as f64);
            builder.positions.extend(corners.map(|corner| cube.positions()[corner as usize] + shift));
            let first = 3 * index as u32;
            builder.triangles.push([first, first + 1, first + 2]);
        }
        builder
    }
}

pub fn rebuilt(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    MeshBuilder { positions, triangles, ..MeshBuilder::default() }.build().expect("a mesh")
}

/// Seen from beside a near plane so close that 16 bits have steps of centimetres where the things are.
pub fn coarse_depth(dice: &mut Dice) -> Scene {
    let mut scene = dice.still_life();
    scene.camera.near = dice.between(0.004, 0.01);
    scene
}

pub fn eye_in_shadow(dice: &mut Dice) -> Scene {
    let mut scene = dice.still_life();
    let place = DVec3::new(dice.between(-0.3, 0.3), 1.5, dice.between(-0.3, 0.3));
    scene.objects[1] = Object::of("caster", shapes::cuboid([1.0, 0.2, 1.0]).expect("a box")).at(place.to_array());
    let light = scene.lights[0].position.truncate();
    scene.camera.eye = light + (place - light) * ((light.y - dice.between(0.5, 0.9)) / (light.y - place.y));
    if dice.one_of(2) == 1 {
        scene.lights = vec![Light::directional(light - place)];
    }
    let around = dice.between(0.0, 6.2);
    scene.camera.target = scene.camera.eye + DVec3::new(around.sin(), dice.between(-0.5, -0.2), around.cos());
    scene
}

/// The eye is lit, and a part of the near rectangle is not.
pub fn near_in_shadow(dice: &mut Dice) -> Scene {
    let mut scene = dice.still_life();
    let place = DVec3::new(0.0, 1.6, 0.0);
    scene.objects[1] = Object::of("caster", shapes::cuboid([0.8, 0.2, 0.8]).expect("a box")).at(place.to_array());
    scene.camera.near = dice.between(0.3, 0.5);
    if dice.one_of(2) == 1 {
        scene.lights = vec![Light::directional(scene.lights[0].position.truncate())];
    }
    for _ in 0..500 {
        let around = dice.between(0.0, 6.2);
        let out = dice.between(0.6, 1.4);
        scene.camera.eye = DVec3::new(out * around.sin(), dice.between(0.5, 1.1), out * around.cos());
        scene.camera.target = DVec3::new(dice.between(-0.3, 0.3), 0.3, dice.between(-0.3, 0.3));
        let tracer = Tracer::new(&scene, super::SMALL).expect("a tracer");
        let is_in = |point: DVec3| !tracer.between_points(0, point).is_empty();
        let corners = [[0.5, 0.5], [159.5, 0.5], [0.5, 119.5], [159.5, 119.5], [80.0, 60.0]];
        if !is_in(scene.camera.eye) && corners.iter().any(|corner| is_in(tracer.near_point(*corner))) {
            return scene;
        }
    }
    scene
}

/// The near plane runs through a roof in many folds.
pub fn near_through_roof(dice: &mut Dice) -> Scene {
    let steps = 60_u32;
    let at = |step: u32, z: f64| {
        [f64::from(step) / f64::from(steps) * 3.0 - 1.5, if step.is_multiple_of(2) { 0.15 } else { -0.15 }, z]
    };
    let points: Vec<[f64; 3]> = (0..=steps).flat_map(|step| [at(step, -0.4), at(step, 0.4)]).collect();
    let quads =
        (0..steps).flat_map(|step| [[2 * step, 2 * step + 1, 2 * step + 3], [2 * step, 2 * step + 3, 2 * step + 2]]);
    let roof = rebuilt(points.into_iter().map(DVec3::from_array).collect(), quads.collect());
    let roof = Object::of("roof", roof).at([0.0, 1.0, 1.2]).unseen();
    let light = Light::point([dice.between(-0.4, 0.4), dice.between(2.4, 2.9), dice.between(2.0, 2.4)]);
    let mut scene = scene([dice.between(-0.2, 0.2), 1.2, 3.0], [0.0, 0.6, 0.0], light, vec![floor(), roof]);
    scene.camera.near = dice.between(1.55, 2.0);
    scene
}

pub fn beside_the_lamp(dice: &mut Dice) -> Scene {
    let mut scene = dice.still_life();
    let light = scene.lights[0].position.truncate();
    let place = scene.objects[1].pose.translate;
    scene.camera.eye = light + DVec3::new(dice.between(-1.0, 1.0), dice.between(-0.5, 0.5), dice.between(0.4, 1.2));
    scene.camera.target = DVec3::new(place.x, 0.0, place.z);
    scene
}

/// A box of which one side is missing that the light would be shown.
pub fn open_box(dice: &mut Dice) -> Mesh {
    let size = dice.between(0.6, 1.0);
    let cube = shapes::cuboid([size, size * 0.7, size]).expect("a box");
    let is_top = |corners: &&[u32; 3]| corners.iter().all(|vertex| cube.positions()[*vertex as usize].y > 0.0);
    let open = cube.triangles().iter().filter(|corners| !is_top(corners)).copied().collect();
    rebuilt(cube.positions().to_vec(), open)
}

/// A closed box with a wall inside from edge to edge, along the halves of top and bottom.
pub fn walled_box(dice: &mut Dice) -> Mesh {
    let size = dice.between(0.6, 1.0);
    let [h, v] = [size / 2.0, size * 0.35];
    let corner = |x: f64, z: f64, y: f64| DVec3::new(x * h, y * v, z * h);
    let ring = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let mut positions: Vec<DVec3> = ring.iter().map(|[x, z]| corner(*x, *z, -1.0)).collect();
    positions.extend(ring.iter().map(|[x, z]| corner(*x, *z, 1.0)));
    let mut triangles = vec![[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]];
    for side in 0..4_u32 {
        let next = (side + 1) % 4;
        triangles.extend([[side, side + 4, next + 4], [side, next + 4, next]]);
    }
    triangles.extend([[0, 2, 6], [0, 6, 4]]);
    rebuilt(positions, triangles)
}

/// A box whose top has a corner in the middle of two of its sides, which the triangles below do not know.
pub fn box_with_t_junctions(dice: &mut Dice) -> Mesh {
    let size = dice.between(0.6, 0.9);
    let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * size;
    let low = [corner(0.0, 0.0, 0.0), corner(0.0, 0.0, 1.0), corner(1.0, 0.0, 1.0), corner(1.0, 0.0, 0.0)];
    let high = low.map(|point| point + DVec3::Y * size);
    let middles = [corner(0.5, 1.0, 1.0), corner(0.5, 1.0, 0.0)];
    let quads = [[0, 3, 2, 1], [4, 5, 8, 9], [9, 8, 6, 7], [1, 2, 6, 5], [3, 0, 4, 7], [0, 1, 5, 4], [2, 3, 7, 6]];
    let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    rebuilt([&low[..], &high, &middles].concat(), triangles.collect())
}

/// A box between 1.3 and 2.5 metres from a lamp that stands over it.
pub fn box_under_lamp(dice: &mut Dice) -> Scene {
    let place = [dice.between(-0.3, 0.3), dice.between(1.4, 1.6), dice.between(-0.3, 0.3)];
    let caster = cuboid("box", place, [dice.between(0.3, 0.5), 0.3, 0.4]).rotated([0.0, dice.between(0.0, 90.0), 0.0]);
    let lamp = Light::point([place[0], place[1] + dice.between(1.6, 2.0), place[2]]);
    scene(dice.eye(), [0.0, 0.3, 0.0], lamp, vec![floor(), caster])
}

/// Two boxes over each other, of which the lower one is mirrored and in the shadow of the other.
pub fn one_behind_the_other(dice: &mut Dice) -> Scene {
    let place = dice.place();
    let above = [place[0], place[1] + 0.6, place[2]];
    let upper = cuboid("upper", above, [dice.between(0.7, 0.9), 0.2, 0.8]);
    let mut lower = cuboid("lower", place, [dice.between(0.5, 0.7), 0.3, 0.5]).rotated(dice.degrees());
    lower.pose.scale = DVec3::new(-1.0, 1.0, 1.0);
    scene(dice.eye(), [0.0, 0.3, 0.0], dice.lamp(), vec![floor(), upper, lower])
}

pub fn moved(mut scene: Scene, by: DVec3) -> Scene {
    scene.objects.iter_mut().for_each(|object| object.pose.translate += by);
    for light in scene.lights.iter_mut().filter(|light| !light.is_directional()) {
        light.position += by.extend(0.0);
    }
    scene.camera.eye += by;
    scene.camera.target += by;
    scene
}

/// Turns a part of the triangles that face a light.
pub fn flip_some(object: &mut Object, light: DVec3, part: f64) {
    let world = object.world_positions();
    let mut triangles = object.mesh.triangles().to_vec();
    let faces = |[a, b, c]: [u32; 3]| {
        let [a, b, c] = [a, b, c].map(|corner| world[corner as usize]);
        (b - a).cross(c - a).dot(light - a) > 0.0
    };
    let facing: Vec<usize> = (0..triangles.len()).filter(|index| faces(triangles[*index])).collect();
    let count = ((facing.len() as f64 * part) as usize).max(1);
    facing.iter().take(count).for_each(|index| triangles[*index].swap(0, 1));
    object.mesh = Arc::new(rebuilt(object.mesh.positions().to_vec(), triangles));
}

/// Panes over each other that throw the same shadow, none of them drawn.
pub fn panes(light: DVec3, onto: DVec3, half: f64, count: u32) -> impl Iterator<Item = Object> {
    (0..count).map(move |index| {
        let up = (0.5 + f64::from(index) * 0.002) / light.y;
        let pane = shapes::quad([2.0 * half * (1.0 - up); 2]).expect("a pane");
        let at = onto + (light - onto) * up;
        Object { visible: false, ..Object::of(format!("pane {}", index + 1), pane).at(at.to_array()) }
    })
}

/// The lamp is a ten-millionth of a metre over a tilted sheet.
pub fn lamp_on_a_sheet(dice: &mut Dice) -> Scene {
    let tilt = dice.between(20.0, 40.0);
    let sheet = Object::of("sheet", shapes::quad([0.8; 2]).expect("a sheet")).rotated([tilt, 0.0, 0.0]);
    let over = DVec3::new(dice.between(-0.1, 0.1), 1e-7, dice.between(-0.1, 0.1));
    let lamp = DVec3::Y + DMat3::from_rotation_x(tilt.to_radians()) * over;
    scene(dice.eye(), [0.0, 0.3, 0.0], Light::point(lamp), vec![floor(), sheet.at([0.0, 1.0, 0.0])])
}

pub fn under_panes(dice: &mut Dice, count: u32) -> Scene {
    let light = DVec3::new(dice.between(-0.5, 0.5), dice.between(7.0, 9.0), dice.between(-0.5, 0.5));
    let onto = DVec3::new(dice.between(-0.4, 0.4), 0.0, dice.between(-0.4, 0.4));
    let mut objects = vec![floor()];
    objects.extend(panes(light, onto, 0.45, count));
    scene(dice.eye(), [0.0, 0.3, 0.0], Light::point(light), objects)
}

/// A shadow before so many volumes that their faces behind the floor are more than eight bits count.
pub fn before_many(dice: &mut Dice) -> Scene {
    let light = DVec3::new(dice.between(-0.3, 0.3), 8.0, dice.between(0.0, 0.5));
    let onto = DVec3::new(0.0, 0.0, dice.between(-1.4, -1.0));
    let mut objects = vec![floor()];
    objects.extend(panes(light, onto, 0.6, 270));
    objects.push(cuboid("box", [dice.between(-0.2, 0.2), 0.4, dice.between(0.0, 0.2)], [0.5, 0.2, 0.5]));
    let eye = [dice.between(-0.5, 0.5), dice.between(2.2, 3.0), 4.5];
    scene(eye, [0.0, 0.2, 0.0], Light::point(light), objects)
}

/// Nothing but what is flat.
pub fn flat_scene(dice: &mut Dice) -> Scene {
    let caster = cuboid("box", dice.place(), [dice.between(0.4, 0.9), 0.4, 0.6]).rotated(dice.degrees());
    scene(dice.eye(), [0.0, 0.3, 0.0], dice.lamp(), vec![floor(), caster])
}

pub fn over_a_table(dice: &mut Dice) -> Scene {
    let top = cuboid("table", [0.0, 0.6, 0.0], [1.2, 0.08, 1.0]);
    let ball = Object::of("ball", shapes::sphere(0.25, 12, 6).expect("a ball")).at([
        dice.between(0.3, 0.5),
        dice.between(1.0, 1.3),
        0.0,
    ]);
    scene(
        dice.eye(),
        [0.0, 0.3, 0.0],
        Light::point([dice.between(-1.5, -0.5), 3.0, dice.between(-0.5, 0.8)]),
        vec![floor(), top, ball],
    )
}

pub fn beyond_the_lamp(dice: &mut Dice) -> Scene {
    let light = [dice.between(-0.3, 0.3), dice.between(1.2, 1.6), dice.between(-0.3, 0.3)];
    let above =
        [light[0] + dice.between(-0.2, 0.2), light[1] + dice.between(0.5, 0.9), light[2] + dice.between(-0.2, 0.2)];
    let caster = cuboid("box", above, [0.3; 3]);
    scene(dice.eye(), [0.0, 0.3, 0.0], Light::point([light[0], light[1], light[2]]), vec![floor(), caster])
}

pub fn through_the_floor(dice: &mut Dice) -> Scene {
    let post = cuboid("post", [dice.between(-0.3, 0.3), -0.4, dice.between(-0.3, 0.3)], [0.5, 1.5, 0.5]);
    let light = Light::point([dice.between(1.2, 1.8), dice.between(1.3, 1.8), dice.between(0.2, 0.8)]);
    scene(dice.eye(), [0.0, 0.3, 0.0], light, vec![floor(), post])
}

pub fn round_receiver(dice: &mut Dice) -> Scene {
    let ring =
        Object::of("ring", shapes::torus(0.6, 0.25, 32, 16).expect("a ring")).at([dice.between(-0.2, 0.2), 0.5, 0.0]);
    let board = Object::of("board", shapes::quad([0.5, 0.9]).expect("a board")).at([
        0.4,
        dice.between(1.5, 1.8),
        dice.between(-0.2, 0.2),
    ]);
    scene(dice.eye(), [0.0, 0.3, 0.0], Light::point([dice.between(1.0, 2.0), 3.5, 0.5]), vec![floor(), ring, board])
}

/// A tile in the floor's plane, and a box over both.
pub fn tile_in_the_floor(dice: &mut Dice) -> Scene {
    let tile = Object::of("tile", shapes::quad([1.3; 2]).expect("a tile")).at([dice.between(-0.2, 0.2), 0.0, 0.3]);
    let over = cuboid("box", dice.place(), [0.4; 3]);
    scene(dice.eye(), [0.0, 0.3, 0.0], dice.lamp(), vec![floor(), tile, over])
}

/// A box on the floor, and a shelf over it whose shadow falls on the box's top.
pub fn shelf_over_box(dice: &mut Dice) -> Scene {
    let shelf = Object::of("shelf", shapes::quad([0.5; 2]).expect("a shelf")).at([0.0, dice.between(1.3, 1.6), 0.0]);
    let below = cuboid("box", [dice.between(-0.1, 0.1), 0.3, dice.between(-0.1, 0.1)], [0.8, 0.6, 0.8]);
    scene(dice.eye(), [0.0, 0.3, 0.0], Light::point([dice.between(0.2, 0.6), 4.0, 0.5]), vec![floor(), below, shelf])
}

pub fn lone_sphere(dice: &mut Dice) -> Scene {
    let flat =
        Object { receives: false, ..Object::of("board", shapes::quad([0.8, 0.5]).expect("a board")).at(dice.place()) };
    scene(dice.eye(), [0.0, 0.3, 0.0], dice.lamp(), vec![floor(), flat.rotated(dice.degrees())])
}

/// A sheet that shows the light its front, and a box whose back is in the map whatever faces that keeps.
pub fn under_a_pane(dice: &mut Dice) -> Scene {
    let pane = Object::of("pane", shapes::quad([dice.between(0.6, 1.0); 2]).expect("a pane")).at(dice.place());
    let tilted = pane.rotated([dice.between(-20.0, 20.0), 0.0, dice.between(-20.0, 20.0)]);
    let beside = cuboid("crate", [dice.between(1.2, 1.6), 0.6, dice.between(-1.0, 0.0)], [0.4; 3]);
    scene(dice.eye(), [0.0, 0.3, 0.0], dice.lamp(), vec![floor(), tilted, beside])
}

pub fn wall_behind_lamp(dice: &mut Dice) -> Scene {
    let wall =
        Object::of("wall", shapes::quad([6.0, 3.0]).expect("a wall")).at([0.0, 1.5, -2.0]).rotated([90.0, 0.0, 0.0]);
    let board = [dice.between(0.0, 0.2), dice.between(1.2, 1.4), 1.5];
    let board = Object::of("board", shapes::quad([0.5; 2]).expect("a board")).at(board).rotated([90.0, 0.0, 0.0]);
    let eye = [dice.between(0.6, 1.4), 3.0, 4.5];
    scene(eye, [0.0, 0.8, -1.0], Light::point([0.0, 1.2, dice.between(0.3, 0.6)]), vec![floor(), wall, board])
}

pub fn shelf_between(dice: &mut Dice) -> Scene {
    let shelf = Object::of("shelf", shapes::quad([1.2; 2]).expect("a shelf")).at([0.0, dice.between(1.3, 1.6), 0.0]);
    let small = cuboid("box", [dice.between(-0.1, 0.1), 0.6, dice.between(-0.1, 0.1)], [0.5; 3]);
    scene(dice.eye(), [0.0, 0.3, 0.0], Light::point([dice.between(0.2, 0.5), 4.0, 0.6]), vec![floor(), shelf, small])
}

pub fn ring_alone(dice: &mut Dice) -> Scene {
    let ring = Object::of("ring", shapes::torus(0.8, 0.3, 32, 16).expect("a ring")).at([0.0, 1.0, 0.0]).rotated([
        dice.between(60.0, 100.0),
        dice.between(0.0, 60.0),
        0.0,
    ]);
    scene(
        dice.eye(),
        [0.0, 0.8, 0.0],
        Light::point([dice.between(1.5, 2.5), dice.between(2.0, 3.0), dice.between(0.5, 1.5)]),
        vec![floor(), ring],
    )
}

/// A sun so low that single precision loses the shadow's edge.
pub fn low_sun(dice: &mut Dice) -> Scene {
    let slope = dice.between(5e-5, 2e-4_f64).to_radians().tan();
    let board = Object::of("board", shapes::quad([2.0, 1.0]).expect("a board")).at([0.0, 2.0 * slope, 1.5]);
    let sun = Light::directional(DVec3::new(dice.between(-0.1, 0.1), slope, 1.0));
    let objects = vec![floor(), board.unseen()];
    scene([dice.between(-0.3, 0.3), 2.0, 4.0], [0.0; 3], sun, objects)
}

/// The one view of hundreds in which a mesh of 48 000 triangles, some thirty pixels wide, has a wrong pixel.
pub fn far_mesh() -> Scene {
    let case = StressCase::named("subpixel-edges").expect("a case");
    let CaseNumber::Scene(scene) = case.drives else { panic!("it drives a scene") };
    scene(30.0).expect("a scene")
}

/// A lamp in the middle of a room, and posts around it, of which one's shadow ends a little beside a corner of the room:
/// there two faces of a cube meet.
pub fn posts_in_a_room(dice: &mut Dice) -> Scene {
    let room = cuboid("room", [0.0, 3.0, 0.0], [6.0; 3]);
    let post = |name: &str, degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        cuboid(name, [1.5 * cos, 1.0, 1.5 * sin], [0.2, 2.0, 0.2])
    };
    let beside = post("beside the corner", dice.between(230.4, 230.9));
    let objects = vec![room, beside, post("behind", 45.0), post("to the left", 135.0)];
    scene([2.4, 2.2, -0.5], [-2.5, 0.6, -2.5], Light::point([0.0, dice.between(1.4, 1.6), 0.0]), objects)
}

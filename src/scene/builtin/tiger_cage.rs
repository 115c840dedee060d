//! `tiger-cage`: a prison block of small cells with barred ceilings, under a lamp that swings.
//!
//! After the model of the prison of Côn Đảo in a museum: two rows of cells along a corridor; guards went on a walkway
//! above and looked down through the bars. Metres; the corridor runs along z, the walkway over it, stairs lead up at
//! its near end. Every wall is an object with thickness.
//!
//! The light hangs below a shade, so bars cast their stripes into the cells, rails and planks theirs into the corridor,
//! and all of them move when the lamp does.

use crate::scene::{Camera, Light, Material, Mesh, MeshError, Motion, Object, Scene, SceneBuilder, Swing, shapes};
use glam::{DVec2, DVec3};
use std::sync::Arc;

const CONCRETE: [f32; 3] = [0.40, 0.39, 0.36];
const PLASTER: [f32; 3] = [0.52, 0.47, 0.38];
const OUTER: [f32; 3] = [0.36, 0.38, 0.38];
const WOOD: [f32; 3] = [0.30, 0.18, 0.10];
const IRON: [f32; 3] = [0.13, 0.13, 0.14];
const ENAMEL: [f32; 3] = [0.05, 0.22, 0.16];

/// Cells of each row, and the distance from one to the next.
const CELLS: u32 = 6;
const CELL_PITCH: f64 = 1.8;
/// Distances from the corridor's middle to the cells' fronts, and on to the outer wall.
const CORRIDOR_HALF: f64 = 1.1;
const CELL_DEPTH: f64 = 2.5;
const CELL_HEIGHT: f64 = 2.4;
const DOOR: [f64; 2] = [0.8, 2.0];
const WALL: f64 = 0.2;
/// Walls reach this far under the floor, so that no light slips through underneath.
const SUNK: f64 = 0.1;
const ROOF: f64 = 5.4;
/// Distance from the origin to the ends of the rows of cells; the corridor continues towards the stairs' foot.
const HALF_LENGTH: f64 = CELLS as f64 * CELL_PITCH / 2.0;
const LANDING: f64 = 3.2;
/// Height of the walkway's upper side.
const DECK: f64 = 2.6;
const DECK_HALF: f64 = 0.55;

const PIVOT: DVec3 = DVec3::new(0.0, ROOF, -0.6);
/// Length of the cord under the pivot.
const CORD: f64 = 0.8;
/// The swing of an ideal pendulum of that length.
const SWING: Swing = Swing { pivot: PIVOT, axis: DVec3::new(0.35, 0.0, 1.0), degrees: 20.0, period_seconds: 1.8 };

/// Builds the scene `tiger-cage`: two rows of cells in a hall with a walkway above, lit by a lamp that swings. The
/// floor is at height 0, the origin in the middle of the cells.
pub fn build() -> Result<Scene, MeshError> {
    let mut objects = hall()?;
    objects.extend(cells()?);
    objects.extend(walkway()?);
    let lamp = lamp()?;
    let bulb = Light {
        color: [1.0, 0.86, 0.62],
        intensity: 1.5,
        range: Some(14.0),
        motion: Motion { swing: Some(SWING), ..Motion::default() },
        ..Light::point(PIVOT - DVec3::Y * (CORD + 0.17))
    };
    objects.push(lamp);
    Ok(SceneBuilder::new("tiger-cage")
        .ambient([0.13, 0.135, 0.15])
        .camera(Camera { near: 0.1, fov_y_degrees: 66.0, ..Camera::looking([0.65, 1.6, 3.6], [-1.2, 1.35, 0.4]) })
        .light(bulb)
        .objects(objects)
        .build())
}

/// Returns floor, roof and outer walls. The floor is one sheet; walls reach below it.
fn hall() -> Result<Vec<Object>, MeshError> {
    let half_width = CORRIDOR_HALF + CELL_DEPTH;
    let length = 2.0 * HALF_LENGTH + LANDING;
    let middle = LANDING / 2.0;
    let outside = 2.0 * (half_width + WALL);
    let height = ROOF + SUNK;
    let floor = Arc::new(shapes::quad([outside, length + 2.0 * WALL])?);
    let roof = Arc::new(shapes::cuboid([outside + 0.4, WALL, length + 2.0 * WALL + 0.4])?);
    let side = Arc::new(shapes::cuboid([WALL, height, length])?);
    let end = Arc::new(shapes::cuboid([outside, height, WALL])?);
    let wall_middle = height / 2.0 - SUNK;
    let side_x = half_width + WALL / 2.0;
    let [far, near] = [-HALF_LENGTH - WALL / 2.0, HALF_LENGTH + LANDING + WALL / 2.0];
    let at = DVec3::new;
    Ok(vec![
        Object::new("floor", floor.clone(), Material::matte(CONCRETE)).at(at(0.0, 0.0, middle)),
        Object::new("roof", roof.clone(), Material::matte(OUTER)).at(at(0.0, ROOF + WALL / 2.0, middle)),
        Object::new("left outer wall", side.clone(), Material::matte(OUTER)).at(at(-side_x, wall_middle, middle)),
        Object::new("right outer wall", side.clone(), Material::matte(OUTER)).at(at(side_x, wall_middle, middle)),
        Object::new("far outer wall", end.clone(), Material::matte(OUTER)).at(at(0.0, wall_middle, far)),
        Object::new("near outer wall", end.clone(), Material::matte(OUTER)).at(at(0.0, wall_middle, near)),
    ])
}

/// Returns fronts with doors, partitions, beds and bars of both rows of cells.
fn cells() -> Result<Vec<Object>, MeshError> {
    let front = Arc::new(cell_fronts()?);
    let partition = Arc::new(shapes::cuboid([CELL_DEPTH - WALL, CELL_HEIGHT + SUNK, WALL])?);
    let bed = Arc::new(shapes::cuboid([0.7, 0.45, CELL_PITCH - WALL])?);
    let bars = Arc::new(bars()?);
    let iron = Material { specular: 0.2, shininess: 20.0, ..Material::matte(IRON) };
    let mut objects = Vec::new();
    for (row, side) in [("left", -1.0), ("right", 1.0)] {
        let mut fronts = Object::new(format!("{row} cell fronts"), front.clone(), Material::matte(PLASTER))
            .at(DVec3::new(side * (CORRIDOR_HALF + WALL / 2.0), 0.0, 0.0));
        fronts.pose.rotate_degrees.y = 90.0;
        objects.push(fronts);
        let middle_x = side * (CORRIDOR_HALF + WALL + (CELL_DEPTH - WALL) / 2.0);
        for cell in 0..CELLS {
            let z = HALF_LENGTH - CELL_PITCH * (f64::from(cell) + 0.5);
            let of_cell = |what: &str| format!("{what} {row} {}", cell + 1);
            let wall_z = z + CELL_PITCH / 2.0;
            let wall_place = DVec3::new(middle_x, (CELL_HEIGHT - SUNK) / 2.0, wall_z);
            objects.push(Object::new(of_cell("partition"), partition.clone(), Material::matte(PLASTER)).at(wall_place));
            let bed_x = side * (CORRIDOR_HALF + CELL_DEPTH - 0.35);
            objects.push(
                Object::new(of_cell("bed"), bed.clone(), Material::matte(CONCRETE)).at(DVec3::new(bed_x, 0.225, z)),
            );
            objects.push(Object::new(of_cell("bars"), bars.clone(), iron).at(DVec3::new(
                middle_x,
                CELL_HEIGHT - 0.06,
                z,
            )));
        }
    }
    Ok(objects)
}

/// Returns one wall along x with a door to each cell, upright, reaching below the floor at height 0.
fn cell_fronts() -> Result<Mesh, MeshError> {
    let mut lines = vec![-HALF_LENGTH];
    for cell in 0..CELLS {
        let middle = CELL_PITCH * (f64::from(cell) + 0.5) - HALF_LENGTH;
        lines.extend([middle - DOOR[0] / 2.0, middle + DOOR[0] / 2.0]);
    }
    lines.push(HALF_LENGTH + WALL / 2.0);
    shapes::plate(&lines, &[-SUNK, DOOR[1], CELL_HEIGHT], WALL, |column, row| column % 2 == 1 && row == 0)
}

/// Returns the ceiling of a cell: bars along the corridor, which reach into the partitions, and one across under them.
fn bars() -> Result<Mesh, MeshError> {
    const SPACING: f64 = 0.19;
    const COUNT: u32 = 12;
    let bar = shapes::cuboid([0.035, 0.035, CELL_PITCH - WALL + 0.1])?;
    let across = shapes::cuboid([CELL_DEPTH - WALL + 0.1, 0.03, 0.06])?;
    let offset = |index: u32| DVec3::X * SPACING * (f64::from(index) - f64::from(COUNT - 1) / 2.0);
    let along = (0..COUNT).map(|index| (&bar, offset(index)));
    // Under the bars, not through them.
    shapes::joined(along.chain([(&across, DVec3::Y * -0.04)]))
}

/// Returns planks with gaps on beams over the corridor, narrower than it; rails on posts, and the stairs up.
fn walkway() -> Result<Vec<Object>, MeshError> {
    const PLANK: f64 = 0.28;
    const GAP: f64 = 0.07;
    let [far, near] = [-HALF_LENGTH, HALF_LENGTH];
    let count = ((near - far + GAP) / (PLANK + GAP)).floor() as u32;
    let plank = shapes::cuboid([2.0 * DECK_HALF, 0.06, PLANK])?;
    let planks = (0..count).map(|index| DVec3::Z * (near - PLANK / 2.0 - f64::from(index) * (PLANK + GAP)));
    let deck = shapes::joined(planks.map(|offset| (&plank, offset)))?;

    let post = shapes::cylinder(0.022, 0.95, 8)?;
    let rail = shapes::cuboid([0.045, 0.04, near - far])?;
    let posts =
        (0..=CELLS).map(|index| DVec3::Z * (far + 0.06 + f64::from(index) * (near - far - 0.12) / f64::from(CELLS)));
    let beam = shapes::cuboid([2.0 * CORRIDOR_HALF + WALL, 0.14, 0.12])?;
    let beams = (0..=CELLS).map(|index| DVec3::Z * (near - CELL_PITCH * f64::from(index)));
    let beams = shapes::joined(beams.map(|offset| (&beam, offset)))?;
    let railing = shapes::joined(
        posts.map(|offset| (&post, offset)).chain([(&rail, DVec3::Y * 0.48), (&rail, DVec3::Y * 0.05)]),
    )?;
    let railing = Arc::new(railing);
    let rail_height = DECK + 0.44;
    let iron = Material { specular: 0.2, shininess: 20.0, ..Material::matte(IRON) };
    // 12 steps up to the deck, the last one its height below it.
    let rise = DECK / 13.0;
    let flight = Arc::new(shapes::stairs(12, rise, LANDING / 14.0, 1.1)?);
    let mut stairs = Object::new("stairs", flight.clone(), Material::matte(CONCRETE)).at(DVec3::new(
        0.0,
        0.0,
        near + 12.0 * LANDING / 14.0,
    ));
    stairs.pose.rotate_degrees.y = 90.0;
    Ok(vec![
        Object::new("walkway", Arc::new(deck), Material::matte(WOOD)).at(DVec3::new(0.0, DECK - 0.03, 0.0)),
        Object::new("beams", Arc::new(beams), Material::matte(WOOD)).at(DVec3::new(0.0, DECK - 0.14, 0.0)),
        Object::new("left railing", railing.clone(), iron).at(DVec3::new(-DECK_HALF + 0.04, rail_height, 0.0)),
        Object::new("right railing", railing.clone(), iron).at(DVec3::new(DECK_HALF - 0.04, rail_height, 0.0)),
        stairs,
    ])
}

/// Cord and shade in one mesh around the pivot; the shade is an open sheet, and the bulb is below
/// its rim's plane, so the roof stays dark only where the shade hides it.
fn lamp() -> Result<Object, MeshError> {
    let cord = shapes::cylinder(0.012, CORD, 6)?;
    let shade = shapes::revolve(&[DVec2::new(0.30, -0.12), DVec2::new(0.05, 0.05), DVec2::new(0.0, 0.06)], false, 32)?;
    let mesh = shapes::joined([(&cord, DVec3::Y * (-CORD / 2.0)), (&shade, DVec3::Y * -(CORD + 0.02))])?;
    let enamel = Material { specular: 0.3, shininess: 30.0, ..Material::matte(ENAMEL) };
    let mut lamp = Object::new("lamp", Arc::new(mesh), enamel).at(PIVOT);
    lamp.motion = Motion { swing: Some(SWING), ..Motion::default() };
    Ok(lamp)
}

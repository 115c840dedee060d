//! Large meshes as fewer triangles, so that a view that is turned stays quick.
//!
//! A grid is laid over the vertices, and of each cell one stays, the nearest to their mean; triangles go
//! between those (Rossignac and Borrel 1993). What is closed stays closed: it looks whole, only coarser. Caps of
//! volumes are the object's own triangles, and go with them, so that they lie on it still.

use super::toggles::{Choice, Toggles};
use crate::anatomy::{Anatomy, PlacedObject, ShadowVolume};
use crate::plan::Part;
use crate::reading::format;
use crate::scene::Mesh;
use glam::DVec3;
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

/// Faces of large meshes that are drawn at most; beyond it these are drawn coarser.
const MOST_FACES: usize = 30_000;
/// Meshes of fewer triangles are large nowhere.
const LARGE: usize = 2_000;
/// No mesh is drawn with fewer triangles than this, however many there are.
const COARSEST: usize = 600;
/// Single precision moves a vertex by no more than this, in parts of the largest coordinate.
const ROUNDING: f64 = 1e-5;
/// Grids that are tried until there are few enough triangles.
const TRIES: usize = 4;
/// Cells of one vertex's width of triangles there are about so many triangles to a cell.
const A_CELL: f64 = 3.0;

/// Vertex indices of triangles.
pub type Triangles = Vec<[u32; 3]>;

/// A mesh with fewer triangles, between some of its own vertices.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Coarse {
    /// Of each vertex the one that stays in its place.
    stays: Vec<u32>,
    /// The triangles that are left.
    pub triangles: Triangles,
}

/// How many steps of detail there are from one to half of it.
const STEPS_OF_DETAIL: f64 = 2.0;

/// Coarser meshes, kept while these are shown.
#[derive(Debug, Default)]
pub struct Coarsened {
    kept: HashMap<(u64, usize), Arc<Coarse>>,
    /// Those that were asked for since the last [`Coarsened::forget_unused`].
    used: HashMap<(u64, usize), Arc<Coarse>>,
}

impl Coarsened {
    /// A mesh with about `most` triangles; made once.
    pub fn of(&mut self, mesh: &Mesh, most: usize) -> Arc<Coarse> {
        let key = (mesh.content_hash(), most);
        let known = self.used.get(&key).or_else(|| self.kept.get(&key));
        let found = known.cloned().unwrap_or_else(|| Arc::new(Coarse::new(mesh.positions(), mesh.triangles(), most)));
        self.used.insert(key, found.clone());
        found
    }

    /// Forgets what was not asked for since this was last called.
    pub fn forget_unused(&mut self) {
        self.kept = std::mem::take(&mut self.used);
    }
}

/// How much coarser large meshes are drawn.
#[derive(Debug)]
pub struct Detail {
    /// Of their triangles so much is left; 1: all.
    share: f64,
}

impl Detail {
    /// Of what is shown of an anatomy.
    #[must_use]
    pub fn new(anatomy: &Anatomy, shown: &Toggles, choice: Choice, holders: &[bool]) -> Detail {
        let objects = anatomy.objects.iter().filter(|_| shown.objects).map(|object| object.mesh.triangles().len());
        let volumes = anatomy.volumes.iter().filter(|volume| choice.has(volume.light, volume.caster, holders));
        let parts = volumes.flat_map(|volume| &volume.parts).filter(|part| match part.part {
            Part::LightCap => shown.light_caps,
            Part::DarkCap => shown.dark_caps,
            _ => false,
        });
        let counts = objects.chain(parts.map(|part| part.triangles.len()));
        let large: usize = counts.filter(|count| *count >= LARGE).sum();
        let share = MOST_FACES as f64 / large.max(MOST_FACES) as f64;
        // Caps come and go with every step of a light: in coarse steps, the meshes mostly stay as they are.
        Detail { share: ((share.log2() * STEPS_OF_DETAIL).floor() / STEPS_OF_DETAIL).exp2() }
    }

    /// So many triangles are drawn of a mesh of `count`.
    fn most(&self, count: usize) -> usize {
        if count < LARGE { count } else { ((count as f64 * self.share) as usize).max(COARSEST) }
    }

    /// An object, coarser; `None` where all its triangles are drawn.
    pub fn of_object(&self, object: &PlacedObject, coarsened: &mut Coarsened) -> Option<Arc<Coarse>> {
        let count = object.mesh.triangles().len();
        (self.most(count) < count).then(|| coarsened.of(&object.mesh, self.most(count)))
    }

    /// The triangles of a cap of an object's volume, coarser where the object is.
    pub fn of_cap<'a>(
        &self,
        object: &PlacedObject,
        volume: &ShadowVolume,
        triangles: &'a Triangles,
        coarsened: &mut Coarsened,
    ) -> Cow<'a, Triangles> {
        let coarse = self.of_object(object, coarsened).filter(|_| is_over(volume, object));
        let moved = coarse.and_then(|coarse| coarse.moved(triangles));
        moved.map_or(Cow::Borrowed(triangles), Cow::Owned)
    }
}

/// Do the volume's vertices begin with those of the object, but for rounding?
fn is_over(volume: &ShadowVolume, object: &PlacedObject) -> bool {
    let far = object.positions.iter().fold(0.0_f64, |most, place| most.max(place.abs().max_element()));
    let is_same = |(vertex, place): (&glam::DVec4, &DVec3)| {
        vertex.w == 1.0 && (vertex.truncate() - *place).abs().max_element() <= ROUNDING * far.max(f64::MIN_POSITIVE)
    };
    volume.vertices.len() >= object.positions.len() && volume.vertices.iter().zip(&object.positions).all(is_same)
}

/// What is drawn coarser, in words: names, with how many of how many triangles are drawn.
#[must_use]
pub fn words_of_fewer(fewer: &[(&str, usize, usize)]) -> Option<String> {
    let counts = |of: fn(&(&str, usize, usize)) -> usize| format::count(fewer.iter().map(of).sum::<usize>() as u64);
    let names: Vec<&str> = fewer.iter().take(3).map(|(name, ..)| *name).collect();
    let more = if fewer.len() > 3 { format!(" and {} more", fewer.len() - 3) } else { String::new() };
    let (drawn, all) = (counts(|one| one.1), counts(|one| one.2));
    let words = format!("Drawn coarser here, caps too: {}{more}, {drawn} of {all} triangles.", names.join(", "));
    (!fewer.is_empty()).then_some(words)
}

impl Coarse {
    /// `most` triangles or fewer.
    #[must_use]
    pub fn new(positions: &[DVec3], triangles: &[[u32; 3]], most: usize) -> Coarse {
        let all = |triangles| Coarse { stays: (0..positions.len() as u32).collect(), triangles };
        if triangles.len() <= most {
            return all(triangles.to_vec());
        }
        let area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).length() / 2.0;
        let area: f64 = triangles.iter().map(|corners| area(corners.map(|corner| positions[corner as usize]))).sum();
        let mut cell = (A_CELL * area / most.max(1) as f64).sqrt();
        let mut found = all(Vec::new());
        for _ in 0..TRIES {
            // Without an area there is nothing to be seen.
            if !(cell > 0.0 && cell.is_finite()) {
                break;
            }
            found.stays = staying(positions, triangles, cell);
            found.triangles = found.between(triangles);
            if found.triangles.len() <= most {
                break;
            }
            cell *= 1.05 * (found.triangles.len() as f64 / most as f64).sqrt();
        }
        found
    }

    /// Triangles of the mesh between what stays of its vertices, without those that are left no area.
    fn between(&self, triangles: &[[u32; 3]]) -> Triangles {
        let moved = triangles.iter().map(|corners| corners.map(|corner| self.stays[corner as usize]));
        moved.filter(|[a, b, c]| a != b && b != c && c != a).collect()
    }

    /// Fewer triangles in place of those between the mesh's vertices and, after them, these vertices carried away from
    /// the light; `None` where they have others.
    fn moved(&self, triangles: &[[u32; 3]]) -> Option<Triangles> {
        let count = self.stays.len() as u32;
        let near = |corners: &[u32; 3]| corners.iter().all(|corner| *corner < count);
        let far = |corners: &[u32; 3]| corners.iter().all(|corner| (count..2 * count).contains(corner));
        if triangles.iter().all(near) {
            Some(self.between(triangles))
        } else if triangles.iter().all(far) {
            let back: Triangles = triangles.iter().map(|corners| corners.map(|corner| corner - count)).collect();
            Some(self.between(&back).into_iter().map(|corners| corners.map(|corner| corner + count)).collect())
        } else {
            None
        }
    }
}

/// Of each vertex the one that stays of its cell; cells are so wide.
fn staying(positions: &[DVec3], triangles: &[[u32; 3]], cell: f64) -> Vec<u32> {
    const NONE: u32 = u32::MAX;
    struct Cell {
        sum: DVec3,
        count: f64,
        nearest: (f64, u32),
    }
    let mut of_vertex = vec![NONE; positions.len()];
    let mut cells: Vec<Cell> = Vec::new();
    let mut known: HashMap<[i64; 3], u32> = HashMap::new();
    for corner in triangles.as_flattened() {
        let slot = &mut of_vertex[*corner as usize];
        if *slot == NONE {
            let place = positions[*corner as usize];
            let key = (place / cell).floor().to_array().map(|along| along as i64);
            *slot = *known.entry(key).or_insert_with(|| {
                cells.push(Cell { sum: DVec3::ZERO, count: 0.0, nearest: (f64::INFINITY, *corner) });
                (cells.len() - 1) as u32
            });
            let of = &mut cells[*slot as usize];
            (of.sum, of.count) = (of.sum + place, of.count + 1.0);
        }
    }
    for (vertex, slot) in of_vertex.iter().enumerate().filter(|(_, slot)| **slot != NONE) {
        let of = &mut cells[*slot as usize];
        let distance = positions[vertex].distance_squared(of.sum / of.count);
        if distance < of.nearest.0 {
            of.nearest = (distance, vertex as u32);
        }
    }
    let of_slot = |(vertex, slot): (usize, &u32)| match cells.get(*slot as usize) {
        Some(cell) => cell.nearest.1,
        None => vertex as u32,
    };
    of_vertex.iter().enumerate().map(of_slot).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    /// A sphere of radius 1.
    pub fn ball(around: u32, down: u32) -> (Vec<DVec3>, Triangles) {
        let place = |row: u32, column: u32| {
            let (a, b) = (f64::from(column) / f64::from(around), f64::from(row) / f64::from(down));
            let (a, b) = (a * std::f64::consts::TAU, b * std::f64::consts::PI);
            DVec3::new(b.sin() * a.cos(), b.cos(), b.sin() * a.sin())
        };
        // One vertex at each pole.
        let at = |row: u32, column: u32| match row {
            0 => 0,
            _ if row == down => 1 + (down - 1) * around,
            _ => 1 + (row - 1) * around + column % around,
        };
        let mut positions = vec![DVec3::Y];
        positions.extend((1..down).flat_map(|row| (0..around).map(move |column| place(row, column))));
        positions.push(DVec3::NEG_Y);
        let grid = |rows: std::ops::Range<u32>| rows.flat_map(|row| (0..around).map(move |column| (row, column)));
        let upper = grid(1..down).map(|(row, column)| [at(row, column), at(row, column + 1), at(row + 1, column + 1)]);
        let lower =
            grid(0..down - 1).map(|(row, column)| [at(row, column), at(row + 1, column + 1), at(row + 1, column)]);
        (positions, upper.chain(lower).collect())
    }

    #[test]
    fn a_large_ball_stays_closed_and_round_with_few_triangles() {
        let (positions, triangles) = ball(264, 133);
        assert_eq!(triangles.len(), 69_696);
        for most in [10_000, 4_000] {
            let found = Coarse::new(&positions, &triangles, most).triangles;
            assert!(found.len() <= most && 3 * found.len() >= most, "{} for {most}", found.len());
            let mut edges = BTreeMap::new();
            for [a, b, c] in &found {
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    *edges.entry((from.min(to), from.max(to))).or_insert(0) += if from < to { 1 } else { -1 };
                }
            }
            assert!(edges.values().all(|sum| *sum == 0), "each side of a triangle is run back by another one");
            let area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).length() / 2.0;
            let all: f64 = found.iter().map(|corners| area(corners.map(|corner| positions[corner as usize]))).sum();
            assert!((all / (4.0 * std::f64::consts::PI) - 1.0).abs() < 0.03, "its area is a ball's still: {all}");
        }
    }

    /// Near the light as far away from it: the triangles of a cap lie on those of the object.
    #[test]
    fn a_cap_is_some_of_the_objects_coarser_triangles_near_and_far() {
        let (positions, triangles) = ball(80, 40);
        let coarse = Coarse::new(&positions, &triangles, 800);
        let lit: Triangles =
            triangles.iter().filter(|corners| positions[corners[0] as usize].y > 0.0).copied().collect();
        let near = coarse.moved(&lit).expect("the mesh's own vertices");
        assert!(near.len() > 300 && near.iter().all(|corners| coarse.triangles.contains(corners)));
        let count = positions.len() as u32;
        let away = |triangles: &Triangles| -> Triangles {
            triangles.iter().map(|one| one.map(|corner| corner + count)).collect()
        };
        assert_eq!(coarse.moved(&away(&lit)), Some(away(&near)));
        assert_eq!(coarse.moved(&[[0, 1, count]]), None);
    }

    #[test]
    fn what_is_small_or_has_no_area_is_no_trouble_and_a_mesh_is_made_coarser_once() {
        let (positions, triangles) = ball(12, 6);
        assert_eq!(Coarse::new(&positions, &triangles, 1_000).triangles, triangles);
        for place in [DVec3::ONE, DVec3::NAN] {
            assert!(Coarse::new(&[place; 3], &[[0, 1, 2]; 9], 4).triangles.is_empty());
        }
        let builder = crate::scene::MeshBuilder { positions, triangles, ..crate::scene::MeshBuilder::default() };
        let mesh = builder.build().expect("a mesh");
        let mut coarsened = Coarsened::default();
        let first = coarsened.of(&mesh, 50);
        coarsened.forget_unused();
        assert!(Arc::ptr_eq(&first, &coarsened.of(&mesh, 50)));
        coarsened.forget_unused();
        coarsened.forget_unused();
        assert!(!Arc::ptr_eq(&first, &coarsened.of(&mesh, 50)), "what is not shown is forgotten");
    }
}

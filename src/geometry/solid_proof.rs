//! The proof that a mesh bounds solids, made once in object space and carried to wherever the mesh is placed.
//!
//! World positions are an affine image of the mesh's own, rounded. Seen from the mesh they are its corners moved by no
//! more than that rounding over the least factor by which the pose stretches anything. What is proven of the mesh for
//! *all* small displacements of its corners ([`Perturbation`]) so holds at every pose whose rounding is less: triangles
//! that stay apart do so in any affine image, and while nothing passes through anything, no winding number changes but
//! for its sign where the pose mirrors. Pairs of triangles that are nearer to each other than that are few; they are
//! tested at each pose, exactly. A pose that rounds more, and a mesh of slivers, is examined anew.

use super::intersection::{any_meet, unsettled_pairs};
use super::perturbed::Perturbation;
use super::solid::{self, NotSolid};
use super::{Caster, Connectivity};
use crate::math::AxisBox;
use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// By how much corners may be displaced, relative to the mesh's size: rounding less than that is allowed up to a hundred
/// thousand sizes from the origin.
const DISPLACEMENT: f64 = 1e-9;
/// An upper bound for the rounding of a corner's place and of what is subtracted from it here, relative to the lengths
/// that are added.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// What is proven of a mesh at every pose that does not displace its corners by too much.
#[derive(Debug, Clone, PartialEq)]
pub enum SolidProof {
    /// This speaks against it wherever it is placed.
    Refuted(NotSolid),
    /// Nothing: it is to be examined at each pose.
    AtEachPose,
    /// It is solid or not by what is known of it, where corners are displaced by at most `distance`.
    Carried(CarriedProof),
}

/// What is known of a closed and consistently wound mesh whose corners are displaced by a little.
#[derive(Debug, Clone, PartialEq)]
pub struct CarriedProof {
    /// In object space.
    distance: f64,
    /// The greatest distance of a corner from the object's origin.
    reach: f64,
    /// Pairs of triangles that may meet, by index: all others are proven not to.
    unsettled: Vec<[u32; 2]>,
    /// The winding numbers on both sides of each component, at a pose that does not mirror; of no use where pairs are
    /// unsettled.
    windings: Vec<[i32; 2]>,
}

impl SolidProof {
    /// Examines a mesh in object space.
    pub fn new(positions: &[DVec3], triangles: &[[u32; 3]], connectivity: &Connectivity) -> SolidProof {
        if let Err(refuted) = solid::check_connectivity(triangles.len(), connectivity) {
            return SolidProof::Refuted(refuted);
        }
        CarriedProof::new(positions, triangles, connectivity).map_or(SolidProof::AtEachPose, SolidProof::Carried)
    }

    /// Returns what follows for a mesh at its place, the same as [`solid::check`] does there; `None` where only that can
    /// say.
    pub fn at(&self, placed: Caster, connectivity: &Connectivity) -> Option<Result<(), NotSolid>> {
        match self {
            SolidProof::Refuted(refuted) => Some(Err(refuted.clone())),
            SolidProof::AtEachPose => None,
            SolidProof::Carried(proof) => proof.at(placed, connectivity),
        }
    }

    /// Returns how many pairs of triangles are tested at each pose.
    pub fn unsettled(&self) -> usize {
        if let SolidProof::Carried(proof) = self { proof.unsettled.len() } else { 0 }
    }
}

impl CarriedProof {
    fn new(positions: &[DVec3], triangles: &[[u32; 3]], connectivity: &Connectivity) -> Option<CarriedProof> {
        let distance = DISPLACEMENT * AxisBox::around(positions.iter().copied()).diagonal();
        let perturbation = Perturbation::by(distance);
        let keeps_area = |corners: &[u32; 3]| perturbation.keeps_area(corners.map(|vertex| positions[vertex as usize]));
        if !(distance.is_finite() && triangles.par_iter().all(keeps_area)) {
            return None;
        }
        let unsettled = unsettled_pairs(positions, triangles, distance)?;
        let windings = match unsettled.is_empty() {
            true => solid::windings(positions, triangles, connectivity).into_iter().collect::<Option<_>>()?,
            false => Vec::new(),
        };
        let reach = positions.iter().map(|position| position.length()).fold(0.0, f64::max);
        Some(CarriedProof { distance, reach, unsettled, windings })
    }

    fn at(&self, placed: Caster, connectivity: &Connectivity) -> Option<Result<(), NotSolid>> {
        let Caster { mesh, pose, world } = placed;
        let world_from_object = pose.world_from_object();
        let stretches = DMat3::from_mat4(world_from_object);
        let least = least_stretch(stretches)?;
        let translate = world_from_object.w_axis.truncate();
        let farthest = world.iter().map(|position| position.length()).fold(0.0, f64::max);
        let rounding = ROUNDING * (frobenius(stretches) * self.reach + translate.length() + farthest);
        let is_near = |(position, world): (&DVec3, &DVec3)| {
            (*world - (stretches * *position + translate)).length() + rounding < least * self.distance
        };
        let is_within = mesh.positions().len() == world.len() && mesh.positions().iter().zip(world).all(is_near);
        // Which pair meets is said as it is found at this pose.
        if !is_within || any_meet(world, mesh.triangles(), &self.unsettled) {
            return None;
        }
        if !self.unsettled.is_empty() {
            return Some(solid::check_windings(world, mesh.triangles(), connectivity));
        }
        let sign = if stretches.determinant() < 0.0 { -1 } else { 1 };
        let mut windings = self.windings.iter().map(|sides| sides.map(|winding| winding * sign)).enumerate();
        Some(windings.try_for_each(|(component, sides)| solid::check_winding(component, Some(sides))))
    }
}

/// Returns a lower bound for the least factor by which a map stretches any vector; `None` where rounding leaves open
/// whether it flattens space.
fn least_stretch(map: DMat3) -> Option<f64> {
    let square = frobenius(map).powi(2);
    let volume = map.determinant().abs() - ROUNDING * square * square.sqrt();
    // The determinant is the product of the three factors, and the greater two's is at most half of the squares' sum.
    let least = 2.0 * volume / square * (1.0 - 1e-9);
    (least.is_finite() && least > 0.0).then_some(least)
}

/// Returns the root of the sum of the squares of a matrix's elements: at least the greatest factor by which it
/// stretches.
fn frobenius(map: DMat3) -> f64 {
    [map.x_axis, map.y_axis, map.z_axis].iter().map(|axis| axis.length_squared()).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::EdgeList;
    use super::*;
    use crate::scene::{Mesh, Object, Pose, shapes};
    use std::sync::Arc;

    struct Random(u64);

    impl Random {
        /// From −1 to 1.
        fn number(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }

        fn point(&mut self) -> DVec3 {
            DVec3::new(self.number(), self.number(), self.number())
        }

        fn rigid(&mut self) -> Pose {
            Pose { translate: self.point() * 10.0, rotate_degrees: self.point() * 180.0, scale: DVec3::ONE }
        }
    }

    fn connectivity(mesh: &Mesh) -> Connectivity {
        Connectivity::new(mesh, &EdgeList::new(mesh.triangles(), mesh.positions().len()))
    }

    fn proof(mesh: &Mesh) -> SolidProof {
        SolidProof::new(mesh.positions(), mesh.triangles(), &connectivity(mesh))
    }

    /// Returns whether the proof carries over to a pose, after checking that it then says what an examination there does.
    fn carries(mesh: &Arc<Mesh>, proof: &SolidProof, pose: Pose) -> bool {
        let world = Object { pose, ..Object::of("it", mesh.clone()) }.world_positions();
        let connectivity = connectivity(mesh);
        let carried = proof.at(Caster { mesh, pose: &pose, world: &world }, &connectivity);
        let anew = solid::check(&world, mesh.triangles(), &connectivity);
        assert!(carried.as_ref().is_none_or(|carried| *carried == anew), "{pose:?}: {carried:?}, but {anew:?}");
        carried.is_some()
    }

    /// Two balls whose surfaces are `gap` apart, or meet where it is negative.
    fn balls(gap: f64) -> Arc<Mesh> {
        let ball = shapes::sphere(1.0, 12, 7).expect("a ball");
        let reach = ball.positions().iter().map(|at| at.x).fold(0.0, f64::max);
        Arc::new(shapes::joined([(&ball, DVec3::ZERO), (&ball, DVec3::X * (2.0 * reach + gap))]).expect("two balls"))
    }

    /// A ball in a hollow one, of which one is turned inside out.
    fn shell(outer_is_turned: bool) -> Arc<Mesh> {
        let [outer, inner] = [2.0, 1.0].map(|radius| shapes::sphere(radius, 12, 7).expect("a ball"));
        let both = shapes::joined([(&outer, DVec3::ZERO), (&inner, DVec3::ZERO)]).expect("two balls");
        let count = outer.triangles().len();
        let turned = |(at, [a, b, c]): (usize, &[u32; 3])| {
            if (at < count) == outer_is_turned { [*a, *c, *b] } else { [*a, *b, *c] }
        };
        let triangles = both.triangles().iter().enumerate().map(turned).collect();
        let builder =
            crate::scene::MeshBuilder { positions: both.positions().to_vec(), triangles, ..Default::default() };
        Arc::new(builder.build().expect("a shell"))
    }

    fn meshes() -> Vec<Arc<Mesh>> {
        let torus = shapes::torus(0.66, 0.22, 24, 12).expect("a torus");
        let open = shapes::quad([2.0; 2]).expect("a board");
        let cube = shapes::cuboid([2.0, 1.0, 3.0]).expect("a box");
        let tetrahedron = shapes::tetrahedron(1.0).expect("a tetrahedron");
        let mut meshes = [torus, open, cube, tetrahedron].map(Arc::new).to_vec();
        meshes.extend([balls(0.3), balls(-0.3), shell(false), shell(true)]);
        meshes
    }

    #[test]
    fn what_is_carried_to_a_pose_is_what_is_found_there() {
        let random = &mut Random(3);
        for mesh in meshes() {
            let proof = proof(&mesh);
            let meets = solid::check(mesh.positions(), mesh.triangles(), &connectivity(&mesh));
            let meets = matches!(meets, Err(NotSolid::MeetsItself(..)));
            for _ in 0..12 {
                let rigid = random.rigid();
                let stretch = random.point().abs() * 3.0 + 0.05;
                let scaled = |scale: DVec3| Pose { scale, ..rigid };
                let size = random.number() * 12.0;
                assert_ne!(carries(&mesh, &proof, rigid), meets);
                assert_ne!(carries(&mesh, &proof, scaled(stretch)), meets);
                assert_ne!(carries(&mesh, &proof, scaled(stretch * DVec3::new(-1.0, 1.0, 1.0))), meets);
                // A size of its own, as far from the origin as it is large.
                let sized = Pose { translate: rigid.translate * 10f64.powf(size), ..rigid };
                assert_ne!(carries(&mesh, &proof, Pose { scale: DVec3::splat(10f64.powf(size)), ..sized }), meets);
            }
        }
    }

    #[test]
    fn where_places_are_rounded_by_too_much_nothing_is_carried() {
        let random = &mut Random(5);
        for mesh in meshes() {
            let proof = proof(&mesh);
            let is_refuted = matches!(proof, SolidProof::Refuted(_));
            for _ in 0..4 {
                let rigid = random.rigid();
                for far in [1e7, 1e9, 1e12, 1e15] {
                    let away = Pose { translate: rigid.translate.normalize() * far, ..rigid };
                    assert_eq!(carries(&mesh, &proof, away), is_refuted, "{far}");
                }
                // Small, but where it is large steps: what places it is what rounds it.
                assert_eq!(carries(&mesh, &proof, Pose { scale: DVec3::splat(1e-9), ..rigid }), is_refuted);
                // Nearly flat.
                assert_eq!(carries(&mesh, &proof, Pose { scale: DVec3::new(1.0, 1e-8, 1.0), ..rigid }), is_refuted);
            }
        }
    }

    #[test]
    fn pairs_that_are_nearly_in_touch_are_tested_at_each_pose() {
        let random = &mut Random(7);
        for gap in [1e-6, 1e-7, 1e-9, 1e-10, 1e-12, 1e-14, -1e-14, -1e-12, -1e-10, -1e-9] {
            let mesh = balls(gap);
            let proof = proof(&mesh);
            assert_eq!(proof.unsettled() == 0, gap > 1e-8, "{gap}");
            for _ in 0..8 {
                let rigid = random.rigid();
                let is_carried = carries(&mesh, &proof, rigid);
                // Where one meets, it is said which; a gap of the rounding's size may close.
                assert!(is_carried == (gap > 0.0) || gap.abs() < 1e-13, "{gap}");
            }
        }
    }

    #[test]
    fn a_proof_is_only_of_places_where_the_pose_puts_them() {
        let mesh = Arc::new(shapes::torus(1.0, 0.4, 24, 12).expect("a torus"));
        let (proof, connectivity, pose) = (proof(&mesh), connectivity(&mesh), Pose::default());
        let at = |world: &[DVec3]| proof.at(Caster { mesh: &mesh, pose: &pose, world }, &connectivity);
        let mut world = mesh.positions().to_vec();
        assert_eq!(at(&world), Some(Ok(())));
        world[5].x += 1e-10;
        assert_eq!(at(&world), Some(Ok(())));
        world[5].x += 1e-6;
        assert_eq!(at(&world), None);
        world[5].x = f64::NAN;
        assert_eq!(at(&world), None);
    }

    /// A fan of slivers: no place of its corners is sure to leave them an area.
    #[test]
    fn a_mesh_of_slivers_is_examined_at_each_pose() {
        let sliver = shapes::cuboid([1.0, 1e-10, 1.0]).expect("a thin box");
        assert_eq!(proof(&sliver), SolidProof::AtEachPose);
    }
}

//! One placed mesh, and how placed things move.

use super::{Material, MaterialTexture, Mesh, MeshGroup};
use crate::math::angle;
use glam::{DMat4, DQuat, DVec3, DVec4};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::Arc;

/// A mesh placed in the world. One object is one caster, whatever groups its mesh has: groups
/// would open closed meshes.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Unique within its scene.
    pub name: String,
    /// Its mesh, shared between instances.
    pub mesh: Arc<Mesh>,
    /// Its scale, rotation and position.
    pub pose: Pose,
    /// How it moves.
    pub motion: Motion,
    /// Material of every group that has none of its own.
    pub material: Material,
    /// The texture that this material's colour is multiplied with.
    pub texture: Option<MaterialTexture>,
    /// True where it casts shadows.
    pub casts: bool,
    /// True where shadows darken it; otherwise it is lit as if nothing stood between.
    pub receives: bool,
    /// True where it is drawn; otherwise it casts without being visible.
    pub visible: bool,
    /// Where lights are for the shadow that it casts, by their index among the scene's, homogeneous, world space; lights that
    /// are not in it are where the scene has them. Scenes of recorded frames whose program gives each model a light of its
    /// own have it, and no scene file: of all that renders only the truth asks for it.
    pub light_positions: BTreeMap<usize, DVec4>,
}

impl Object {
    /// Returns an unmoving object at the origin that casts, receives and is visible.
    pub fn new(name: impl Into<String>, mesh: Arc<Mesh>, material: Material) -> Object {
        Object {
            name: name.into(),
            mesh,
            pose: Pose::default(),
            motion: Motion::default(),
            material,
            texture: None,
            casts: true,
            receives: true,
            visible: true,
            light_positions: BTreeMap::new(),
        }
    }

    /// Returns an object as [`Object::new`] does, of the default material.
    pub fn of(name: impl Into<String>, mesh: impl Into<Arc<Mesh>>) -> Object {
        Object::new(name, mesh.into(), Material::default())
    }

    /// Sets the object's position, in place of the one before, and returns it.
    #[must_use]
    pub fn at(mut self, translate: impl Into<DVec3>) -> Object {
        self.pose.translate = translate.into();
        self
    }

    /// Sets the object's rotation about the fixed x, then y, then z axis, in degrees, in place of the one before, and
    /// returns it.
    #[must_use]
    pub fn rotated(mut self, rotate_degrees: impl Into<DVec3>) -> Object {
        self.pose.rotate_degrees = rotate_degrees.into();
        self
    }

    /// Sets the object's scale, in place of the one before, and returns it; negative factors mirror, and none may be
    /// zero, which is not checked here.
    #[must_use]
    pub fn scaled(mut self, scale: impl Into<DVec3>) -> Object {
        self.pose.scale = scale.into();
        self
    }

    /// Makes the object cast without being drawn, so that its whole shadow shows.
    #[must_use]
    pub fn unseen(self) -> Object {
        Object { visible: false, ..self }
    }

    /// Returns the texture of a group of the object's mesh: of the group's own material where it has one, otherwise the
    /// object's; `None` where that has none.
    pub fn texture_of<'a>(&'a self, group: &'a MeshGroup) -> Option<&'a MaterialTexture> {
        if group.material.is_some() { group.texture.as_ref() } else { self.texture.as_ref() }
    }

    /// Returns the mesh's vertices in world space, at the pose as it is, in the mesh's order. All users of a vertex get
    /// the same rounding.
    pub fn world_positions(&self) -> Vec<DVec3> {
        if self.pose == Pose::default() {
            return self.mesh.positions().to_vec();
        }
        let world_from_object = self.pose.world_from_object();
        self.mesh.positions().iter().map(|p| world_from_object.transform_point3(*p)).collect()
    }
}

/// A placement of an object: scale, then rotations about the fixed x, y and z axes, then translation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Translation, world units.
    pub translate: DVec3,
    /// Rotations about the fixed x, then y, then z axis, degrees.
    pub rotate_degrees: DVec3,
    /// Scale along each axis; no component is zero; negative ones mirror.
    pub scale: DVec3,
}

impl Default for Pose {
    fn default() -> Pose {
        Pose { translate: DVec3::ZERO, rotate_degrees: DVec3::ZERO, scale: DVec3::ONE }
    }
}

/// A pose as a key: the bits of the numbers of translation, rotation and scale.
pub type PoseBits = [[u64; 3]; 3];

impl Pose {
    /// Returns its bits; poses that are equal except for the sign of a zero differ.
    pub fn bits(&self) -> PoseBits {
        [self.translate, self.rotate_degrees, self.scale].map(|part| part.to_array().map(f64::to_bits))
    }

    /// Names what makes this pose unusable, in a few words for an error line.
    ///
    /// # Errors
    /// Numbers that are not finite; a scale of zero.
    pub fn check(&self) -> Result<(), &'static str> {
        if !(self.translate.is_finite() && self.rotate_degrees.is_finite() && self.scale.is_finite()) {
            Err("an object's place, turn and scale must be finite numbers")
        } else if self.scale.to_array().contains(&0.0) {
            Err("an object's scale must not be zero: it would have no volume")
        } else {
            Ok(())
        }
    }

    /// Returns the matrix of this pose: scale first, then rotation, then translation.
    pub fn world_from_object(&self) -> DMat4 {
        DMat4::from_scale_rotation_translation(self.scale, self.rotation(), self.translate)
    }

    /// Returns the pose of a scale, a rotation and a translation, applied in this order.
    pub(super) fn of(scale: DVec3, rotation: DQuat, translate: DVec3) -> Pose {
        Pose { translate, rotate_degrees: angle::fixed_angles(rotation).map(f64::to_degrees), scale }
    }

    /// Returns whether it mirrors: its scale is negative along one axis, or along all three.
    pub fn is_mirrored(&self) -> bool {
        self.scale.to_array().iter().filter(|factor| **factor < 0.0).count() % 2 == 1
    }

    /// Returns the pose at the same position, rotated by −90° about the world's x axis: what pointed along the world's
    /// z axis points up (y). For a pose without rotation that is the object's own z axis. Called again it rotates on.
    pub fn with_z_up(&self) -> Pose {
        self.rotated_about(self.translate, angle::rotation(DVec3::X, -TAU / 4.0))
    }

    fn rotation(&self) -> DQuat {
        let [x, y, z] = self.rotate_degrees.to_array().map(f64::to_radians);
        angle::rotation(DVec3::Z, z) * angle::rotation(DVec3::Y, y) * angle::rotation(DVec3::X, x)
    }

    /// Returns the same scale, rotated and moved as one rigid body about a point.
    fn rotated_about(&self, pivot: DVec3, turn: DQuat) -> Pose {
        Pose::of(self.scale, turn * self.rotation(), pivot + turn * (self.translate - pivot))
    }
}

/// How an object or a light moves. Still by default. An object spins, then runs along its orbit, then swings; a light
/// only has a position.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// Rotation added to [`Pose::rotate_degrees`] every second.
    pub spin_degrees_per_second: DVec3,
    /// A circle that the position runs along; the object does not rotate with it.
    pub orbit: Option<Orbit>,
    /// To and fro about an axis, as a pendulum does; the object rotates with it.
    pub swing: Option<Swing>,
}

/// A motion on a circle about an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    /// A point of the axis, world units.
    pub center: DVec3,
    /// Direction of the axis, not zero.
    pub axis: DVec3,
    /// Angular speed, counter-clockwise seen from the axis' tip.
    pub degrees_per_second: f64,
}

/// A pendulum: what hangs on it at second 0 hangs at rest then, and moves fastest. Its angle is a sine of time, which
/// is what a pendulum's is as long as it stays small.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing {
    /// A point of the axis, world units: where the cord is fixed.
    pub pivot: DVec3,
    /// Direction of the axis, not zero.
    pub axis: DVec3,
    /// The largest angle on either side; first counter-clockwise seen from the axis' tip.
    pub degrees: f64,
    /// Period in seconds, > 0.
    pub period_seconds: f64,
}

impl Motion {
    /// Returns whether the motion moves nothing: no spin, no orbit with a speed, no swing with an angle.
    pub fn is_still(&self) -> bool {
        self.spin_degrees_per_second == DVec3::ZERO
            && self.orbit.is_none_or(|orbit| orbit.degrees_per_second == 0.0)
            && self.swing.is_none_or(|swing| swing.degrees == 0.0)
    }

    /// Returns the pose `seconds` later: spun and moved along the orbit, then swung.
    pub fn apply(&self, pose: &Pose, seconds: f64) -> Pose {
        let translate = self.orbit.map_or(pose.translate, |orbit| orbit.point_at(pose.translate, seconds));
        let rotate_degrees = pose.rotate_degrees + self.spin_degrees_per_second * seconds;
        let moved = Pose { translate, rotate_degrees, ..*pose };
        match self.turn_of_swing(seconds) {
            Some((pivot, turn)) => moved.rotated_about(pivot, turn),
            None => moved,
        }
    }

    /// Returns a homogeneous light position `seconds` later, by orbit and swing; a spin does nothing. The direction of
    /// a directional light only rotates about the axes.
    pub fn apply_to_light(&self, position: DVec4, seconds: f64) -> DVec4 {
        let orbited = self.orbit.map_or(position, |orbit| orbit.light_at(position, seconds));
        let Some((pivot, turn)) = self.turn_of_swing(seconds) else { return orbited };
        if orbited.w == 0.0 {
            return (turn * orbited.truncate()).extend(0.0);
        }
        (pivot + turn * (orbited.truncate() - pivot)).extend(orbited.w)
    }

    /// Returns pivot and rotation of the swing after `seconds`; `None` without a swing, or where it is at rest, so that
    /// what does not move has exactly the same bits.
    fn turn_of_swing(&self, seconds: f64) -> Option<(DVec3, DQuat)> {
        let swing = self.swing?;
        let degrees = swing.degrees * angle::sin(TAU * seconds / swing.period_seconds);
        let turn = || angle::rotation(swing.axis.normalize(), degrees.to_radians());
        (degrees != 0.0).then(|| (swing.pivot, turn()))
    }
}

impl Orbit {
    fn rotation_at(&self, seconds: f64) -> DQuat {
        angle::rotation(self.axis.normalize(), (self.degrees_per_second * seconds).to_radians())
    }

    fn point_at(&self, start: DVec3, seconds: f64) -> DVec3 {
        if self.degrees_per_second * seconds == 0.0 {
            return start;
        }
        self.center + self.rotation_at(seconds) * (start - self.center)
    }

    fn light_at(&self, position: DVec4, seconds: f64) -> DVec4 {
        if position.w == 0.0 {
            return (self.rotation_at(seconds) * position.truncate()).extend(0.0);
        }
        self.point_at(position.truncate(), seconds).extend(position.w)
    }
}

//! Rays of one origin that are near each other, followed together.

use super::direction_projection::OriginRay;
use glam::DVec3;

/// Up to [`RayPacket::MOST`] rays of one kind that are near each other.
#[derive(Debug)]
pub struct RayPacket {
    kind: fn(DVec3) -> OriginRay,
    points: [DVec3; RayPacket::MOST],
    len: usize,
}

impl RayPacket {
    /// Larger packets hit more triangles that most of their rays miss.
    pub const MOST: usize = 16;

    /// Makes an empty packet of rays that `kind` makes of points.
    pub fn new(kind: fn(DVec3) -> OriginRay) -> RayPacket {
        RayPacket { kind, points: [DVec3::ZERO; RayPacket::MOST], len: 0 }
    }

    pub fn push(&mut self, point: DVec3) {
        self.points[self.len] = point;
        self.len += 1;
    }

    pub fn len(&self) -> usize {
        self.len
    }

    pub fn points(&self) -> &[DVec3] {
        &self.points[..self.len]
    }

    /// The line of a number below [`RayPacket::len`].
    pub fn line(&self, index: usize) -> OriginRay {
        (self.kind)(self.points[index])
    }

    pub fn lines(&self) -> impl Iterator<Item = OriginRay> + Clone {
        self.points().iter().map(|point| (self.kind)(*point))
    }

    /// Returns the place that the packet's points are relative to, where the hierarchy's are relative to `origin`.
    pub fn base(&self, origin: DVec3) -> DVec3 {
        if matches!((self.kind)(DVec3::ZERO), OriginRay::Along(_)) { DVec3::ZERO } else { origin }
    }

    /// Do its lines go on without end?
    pub fn is_endless(&self) -> bool {
        !matches!((self.kind)(DVec3::ZERO), OriginRay::To(_))
    }
}

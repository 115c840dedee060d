//! Rays of one origin that are near each other, followed together.

use super::direction_projection::OriginRay;
use glam::DVec3;

/// Up to [`RayPacket::MOST`] rays of one kind that are near each other and are traced together.
#[derive(Debug)]
pub struct RayPacket {
    kind: fn(DVec3) -> OriginRay,
    points: [DVec3; RayPacket::MOST],
    len: usize,
}

impl RayPacket {
    /// The most rays in a packet: larger ones hit more triangles that most of their rays miss.
    pub const MOST: usize = 16;

    /// Makes an empty packet; `kind` makes a ray of each point that is added.
    pub fn new(kind: fn(DVec3) -> OriginRay) -> RayPacket {
        RayPacket { kind, points: [DVec3::ZERO; RayPacket::MOST], len: 0 }
    }

    /// Appends a ray by its point. Panics where the packet is full.
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

    /// Returns the ray with this index, from 0 in the order in which rays were added.
    pub fn line(&self, index: usize) -> OriginRay {
        (self.kind)(self.points[index])
    }

    pub fn lines(&self) -> impl Iterator<Item = OriginRay> + Clone {
        self.points().iter().map(|point| (self.kind)(*point))
    }

    /// Returns the position that the packet's points are relative to: `origin`, or zero for directions.
    pub fn base(&self, origin: DVec3) -> DVec3 {
        if matches!((self.kind)(DVec3::ZERO), OriginRay::Along(_)) { DVec3::ZERO } else { origin }
    }

    /// Returns whether its rays have no end.
    pub fn is_endless(&self) -> bool {
        !matches!((self.kind)(DVec3::ZERO), OriginRay::To(_))
    }
}

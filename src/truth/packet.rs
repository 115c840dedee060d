//! Rays of one origin that are near each other, followed together.

use super::chart::Line;
use glam::DVec3;

/// Up to [`Bundle::MOST`] lines of a kind that are near each other.
#[derive(Debug)]
pub struct Bundle {
    kind: fn(DVec3) -> Line,
    points: [DVec3; Bundle::MOST],
    len: usize,
}

impl Bundle {
    /// Larger ones meet more triangles that most of their lines miss.
    pub const MOST: usize = 16;

    /// Of lines that `kind` makes of points.
    pub fn new(kind: fn(DVec3) -> Line) -> Bundle {
        Bundle { kind, points: [DVec3::ZERO; Bundle::MOST], len: 0 }
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

    /// The line of a number below [`Bundle::len`].
    pub fn line(&self, index: usize) -> Line {
        (self.kind)(self.points[index])
    }

    pub fn lines(&self) -> impl Iterator<Item = Line> + Clone {
        self.points().iter().map(|point| (self.kind)(*point))
    }

    /// What its points are relative to where a pencil's places are relative to `origin`.
    pub fn base(&self, origin: DVec3) -> DVec3 {
        if matches!((self.kind)(DVec3::ZERO), Line::Along(_)) { DVec3::ZERO } else { origin }
    }

    /// Do its lines go on without end?
    pub fn is_endless(&self) -> bool {
        !matches!((self.kind)(DVec3::ZERO), Line::To(_))
    }
}

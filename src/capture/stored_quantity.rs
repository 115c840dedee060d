//! What a shadow map holds of the surface that is nearest to its light: depth, or what a fragment shader wrote instead.

use glam::{DVec2, DVec4};
use serde::{Deserialize, Serialize};

/// The quantity that the texels of a depth map hold.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum StoredQuantity {
    /// Depth as it is rasterised: z / w.
    #[default]
    Depth,
    /// The distance from the light over a constant, as maps of point lights do.
    Distance {
        /// The square of what is held is the sum of x², y² and w² of clip space times these.
        squares: [f64; 3],
        /// How far texels are off it, at most, but for those that it does not explain at all.
        residual: f64,
    },
    /// The distance along the axis of the view, times a factor, and an offset: linear depth.
    AxisDistance {
        /// The factor of w.
        factor: f64,
        /// What is added.
        offset: f64,
        /// How far texels are off it, at most, but for those that it does not explain at all.
        residual: f64,
    },
    /// None of these: a fragment shader wrote something else.
    Unknown,
}

impl StoredQuantity {
    /// Returns what is held of a point in the clip space of a face; its depth where that is not known.
    pub fn of(&self, clip: DVec4) -> f64 {
        self.at(clip.truncate().truncate() / clip.w, clip.z / clip.w, clip.w.recip())
    }

    /// Returns what is held of a point at a place of a face (normalised device coordinates) with a depth, where 1 / w is
    /// `nearness`: depth and nearness are linear over the picture of a plane.
    pub fn at(&self, place: DVec2, depth: f64, nearness: f64) -> f64 {
        match self {
            StoredQuantity::Depth | StoredQuantity::Unknown => depth,
            StoredQuantity::Distance { squares: [x, y, w], .. } => {
                (x * place.x * place.x + y * place.y * place.y + w).max(0.0).sqrt() / nearness
            }
            StoredQuantity::AxisDistance { factor, offset, .. } => factor / nearness + offset,
        }
    }

    /// Returns by how much what is held changes where a point in clip space moves a little.
    pub fn change(&self, clip: DVec4, moved: DVec4) -> f64 {
        match self {
            StoredQuantity::Depth | StoredQuantity::Unknown => (moved.z - clip.z / clip.w * moved.w) / clip.w,
            StoredQuantity::Distance { squares: [x, y, w], .. } => {
                (x * clip.x * moved.x + y * clip.y * moved.y + w * clip.w * moved.w) / self.of(clip)
            }
            StoredQuantity::AxisDistance { factor, .. } => factor * moved.w,
        }
    }

    /// Returns how far texels are off it that it explains, at most; 0 for depth, which is as exact as it is stored.
    pub fn residual(&self) -> f64 {
        match self {
            StoredQuantity::Depth | StoredQuantity::Unknown => 0.0,
            StoredQuantity::Distance { residual, .. } | StoredQuantity::AxisDistance { residual, .. } => *residual,
        }
    }

    /// Returns in words what is held, and how exactly, where a fragment shader wrote it; empty for depth.
    pub fn words(&self) -> String {
        match self {
            StoredQuantity::Depth => String::new(),
            StoredQuantity::Distance { residual, .. } => format!("distances from the light, to {residual:.1e}"),
            StoredQuantity::AxisDistance { residual, .. } => format!("distances along its axis, to {residual:.1e}"),
            StoredQuantity::Unknown => "neither depths nor distances".to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [StoredQuantity; 3] = [
        StoredQuantity::Depth,
        StoredQuantity::Distance { squares: [0.01, 0.04, 0.01], residual: 0.0 },
        StoredQuantity::AxisDistance { factor: 0.1, offset: -0.05, residual: 0.0 },
    ];

    #[test]
    fn distances_are_measured_from_the_light_or_along_its_axis() {
        let clip = DVec4::new(2.0, 1.0, 4.5, 5.0);
        let [depth, distance, axis] = ALL.map(|quantity| quantity.of(clip));
        assert!((depth - 0.9).abs() < 1e-12 && (axis - 0.45).abs() < 1e-12);
        assert!((distance - (0.04_f64 + 0.04 + 0.25).sqrt()).abs() < 1e-12, "{distance}");
    }

    #[test]
    fn a_change_is_what_a_small_step_makes() {
        let (clip, moved) = (DVec4::new(2.0, -1.0, 4.5, 5.0), DVec4::new(0.3, 0.2, -0.4, 0.7));
        for quantity in ALL {
            let step = 1e-6;
            let made = (quantity.of(clip + moved * step) - quantity.of(clip - moved * step)) / (2.0 * step);
            assert!((made - quantity.change(clip, moved)).abs() < 1e-8, "{quantity:?}: {made}");
        }
    }
}

//! What a shadow map holds where fragment shaders write it: found by casting the map's own draws at the middles of texels
//! and fitting each known quantity to what is stored there.

use super::map_views::drawn_into_face;
use crate::capture::{Image, StoredQuantity};
use crate::plan::{Draw, FramePlan, LightId, Program, ShaderEffect};
use glam::{DMat3, DVec2, DVec3, DVec4};
use std::sync::Arc;

/// Texels along a side of a face that are cast, at most.
const CASTS: u32 = 48;
/// This part of the texels that are cast must be explained: at outlines another rasteriser may find another triangle.
const LEAST_EXPLAINED: f64 = 0.95;
/// A quantity with as many factors as these explains fewer texels by chance.
const LEAST_TEXELS: usize = 32;
/// How far a texel may be off what explains it: a part of the range that is stored, and rounding.
const SAME: f64 = 1e-3;
const ROUNDED: f64 = 2e-5;
/// How often a fit is made anew without the texels that are far off.
const FITS: usize = 4;

/// A texel of a map, with the point of the map's draws that is nearest to the light there.
#[derive(Debug, Clone, Copy)]
struct CastTexel {
    /// Normalised device coordinates.
    place: DVec2,
    /// Depth of the point, and 1 / w.
    depth: f64,
    nearness: f64,
    stored: f64,
}

/// Finds what the faces of a light's map hold at the end. Depth where no shader writes any, or nothing is stored.
pub fn stored_quantity(plan: &FramePlan, light: LightId, faces: &[Arc<Image>]) -> StoredQuantity {
    let drawn: Vec<Vec<(&Draw, Vec<DVec4>)>> =
        (0..faces.len()).map(|face| drawn_into_face(plan, light, face as u32)).collect();
    if !drawn.iter().flatten().any(|(draw, _)| may_write_depth(draw)) {
        return StoredQuantity::Depth;
    }
    let texels: Vec<CastTexel> = drawn.iter().zip(faces).flat_map(|(drawn, image)| cast_texels(drawn, image)).collect();
    explained(&texels)
}

fn may_write_depth(draw: &Draw) -> bool {
    matches!(&draw.program, Program::Recorded { writes_depth, .. } if *writes_depth != ShaderEffect::No)
}

/// Casts the draws into a face at a grid of texels. Those where nothing is drawn, or that hold an end of the range of depths,
/// as a clear or clamping leaves it, are left out.
fn cast_texels(drawn: &[(&Draw, Vec<DVec4>)], image: &Image) -> Vec<CastTexel> {
    let sides = image.size();
    let step = sides.map(|side| side.div_ceil(CASTS).max(1));
    let [columns, rows] = [0, 1].map(|axis| sides[axis] / step[axis]);
    // How many steps a side has: one that is no multiple of them ends with a part of one.
    let cells = [0, 1].map(|axis| f64::from(sides[axis]) / f64::from(step[axis]));
    let texel = |index: usize| {
        let at = [index as u32 % columns, index as u32 / columns];
        [0, 1].map(|axis| at[axis] * step[axis] + step[axis] / 2)
    };
    let places: Vec<DVec2> = (0..(columns * rows) as usize)
        .map(|index| {
            let [x, y] = [0, 1].map(|axis| (f64::from(texel(index)[axis]) + 0.5) / f64::from(sides[axis]) * 2.0 - 1.0);
            DVec2::new(x, -y)
        })
        .collect();
    // Depth and 1 / w of the nearest point.
    let mut nearest: Vec<Option<[f64; 2]>> = vec![None; places.len()];
    for (draw, corners) in drawn {
        let is_reached =
            |corners: &&[DVec4; 3]| !is_culled(draw, corners) && corners.iter().any(|corner| corner.w > 0.0);
        for corners in corners.as_chunks::<3>().0.iter().filter(is_reached) {
            for index in indices_round(corners, [columns, rows], cells) {
                let Some(point) = point_of(corners, places[index], draw.raster.unclipped_depth) else { continue };
                let is_nearer = nearest[index].is_none_or(|known| is_before(draw, point[0], known[0]));
                nearest[index] = Some(point).filter(|_| is_nearer).or(nearest[index]);
            }
        }
    }
    let cast = |(index, point): (usize, Option<[f64; 2]>)| {
        let [depth, nearness] = point?;
        let stored = f64::from(image.depth_at(texel(index))?);
        let is_open = stored > 0.0 && stored < 1.0;
        is_open.then_some(CastTexel { place: places[index], depth, nearness, stored })
    };
    nearest.into_iter().enumerate().filter_map(cast).collect()
}

/// Returns whether a draw's test prefers a depth to another.
fn is_before(draw: &Draw, depth: f64, known: f64) -> bool {
    use wgpu_types::CompareFunction::{Greater, GreaterEqual};
    let is_reversed = matches!(draw.raster.depth_compare, Greater | GreaterEqual);
    if is_reversed { depth > known } else { depth < known }
}

/// Returns twice the area of a triangle, by x, y and w: it is positive where its corners run counter-clockwise.
fn turn(corners: &[DVec4; 3]) -> f64 {
    let [a, b, c] = corners.map(flat);
    a.dot(b.cross(c))
}

/// Returns x, y and w of clip space.
fn flat(corner: DVec4) -> DVec3 {
    DVec3::new(corner.x, corner.y, corner.w)
}

fn is_culled(draw: &Draw, corners: &[DVec4; 3]) -> bool {
    let is_front = (turn(corners) > 0.0) == (draw.raster.front_face == wgpu_types::FrontFace::Ccw);
    draw.raster.cull.is_some_and(|culled| (culled == wgpu_types::Face::Front) == is_front)
}

/// Returns the indices of a grid that may be in a triangle: those in the rectangle round it, or all where it reaches behind
/// the light. `cells` says how many steps of the grid a face has along each axis.
fn indices_round(
    corners: &[DVec4; 3],
    [columns, rows]: [u32; 2],
    cells: [f64; 2],
) -> impl Iterator<Item = usize> + use<> {
    let is_before = corners.iter().all(|corner| corner.w > 0.0);
    let of = |axis: usize, sign: f64, count: u32| {
        let at = corners.map(|corner| (sign * corner[axis] / corner.w * 0.5 + 0.5) * cells[axis]);
        let [low, high] = [at.iter().copied().fold(f64::INFINITY, f64::min), at.iter().copied().fold(0.0, f64::max)];
        if is_before { low.floor().max(0.0) as u32..(high.ceil().max(0.0) as u32).min(count) } else { 0..count }
    };
    let (across, down) = (of(0, 1.0, columns), of(1, -1.0, rows));
    down.flat_map(move |row| across.clone().map(move |column| (row * columns + column) as usize))
}

/// Returns depth and 1 / w of a triangle at a place of a face; `None` where it is not there, or it is beyond the range of
/// depths and clipped.
fn point_of(corners: &[DVec4; 3], place: DVec2, is_unclipped: bool) -> Option<[f64; 2]> {
    let [a, b, c] = corners.map(flat);
    let turn = turn(corners);
    // Of which parts of the corners the point with w = 1 consists.
    let weights = [b.cross(c), c.cross(a), a.cross(b)].map(|edge| edge.dot(place.extend(1.0)) / turn);
    let nearness: f64 = weights.iter().sum();
    let depth: f64 = weights.iter().zip(corners).map(|(weight, corner)| weight * corner.z).sum();
    let is_inside = weights.iter().all(|weight| *weight >= 0.0) && nearness > 0.0 && nearness.is_finite();
    (is_inside && (is_unclipped || (0.0..=1.0).contains(&depth))).then_some([depth, nearness])
}

/// Returns the first known quantity that explains what texels store; depth where there are none.
fn explained(texels: &[CastTexel]) -> StoredQuantity {
    let stored = || texels.iter().map(|texel| texel.stored);
    let range = stored().fold(0.0, f64::max) - stored().fold(1.0, f64::min);
    let most_off = SAME * range.max(0.0) + ROUNDED;
    let explains = |quantity: &StoredQuantity| {
        let explained = texels.iter().filter(|texel| off(quantity, texel) <= most_off).count();
        explained as f64 >= LEAST_EXPLAINED * texels.len() as f64
    };
    if explains(&StoredQuantity::Depth) {
        return StoredQuantity::Depth;
    }
    let fits = [trimmed(texels, distance_of), trimmed(texels, axis_distance_of)];
    let found = fits.into_iter().flatten().find(|quantity| texels.len() >= LEAST_TEXELS && explains(quantity));
    let within = |quantity: &StoredQuantity| {
        texels.iter().map(|texel| off(quantity, texel)).filter(|off| *off <= most_off).fold(0.0, f64::max)
    };
    match found {
        Some(quantity @ StoredQuantity::Distance { squares, .. }) => {
            StoredQuantity::Distance { squares, residual: within(&quantity) }
        }
        Some(quantity @ StoredQuantity::AxisDistance { factor, offset, .. }) => {
            StoredQuantity::AxisDistance { factor, offset, residual: within(&quantity) }
        }
        _ => StoredQuantity::Unknown,
    }
}

/// Returns how far a texel is off what it would store.
fn off(quantity: &StoredQuantity, texel: &CastTexel) -> f64 {
    (quantity.at(texel.place, texel.depth, texel.nearness) - texel.stored).abs()
}

/// Returns a fit, made anew without texels that are far off it, as at outlines.
fn trimmed(texels: &[CastTexel], fit: impl Fn(&[CastTexel]) -> Option<StoredQuantity>) -> Option<StoredQuantity> {
    let mut kept = texels.to_vec();
    let mut found = fit(&kept)?;
    for _ in 1..FITS {
        kept.sort_by(|a, b| off(&found, a).total_cmp(&off(&found, b)));
        let middle = off(&found, kept.get(kept.len() / 2)?);
        kept.retain(|texel| off(&found, texel) <= 4.0 * middle + ROUNDED);
        found = fit(&kept)?;
    }
    Some(found)
}

/// Fits a distance from the light: the square of what is stored by those of x, y and w, by least squares.
fn distance_of(texels: &[CastTexel]) -> Option<StoredQuantity> {
    let (mut squares, mut products) = (DMat3::ZERO, DVec3::ZERO);
    // So that w is about 1.
    let unit = texels.iter().map(|texel| texel.nearness).sum::<f64>() / texels.len() as f64;
    for texel in texels {
        let place = texel.place * texel.place;
        let row = place.extend(1.0) * (unit / texel.nearness).powi(2);
        squares += DMat3::from_cols(row * row.x, row * row.y, row * row.z);
        products += row * texel.stored * texel.stored;
    }
    let found = squares.inverse() * products * unit * unit;
    let is_one = found.is_finite() && found.min_element() > 0.0;
    is_one.then(|| StoredQuantity::Distance { squares: found.to_array(), residual: 0.0 })
}

/// Fits a distance along the axis: what is stored by w, by least squares.
fn axis_distance_of(texels: &[CastTexel]) -> Option<StoredQuantity> {
    let count = texels.len() as f64;
    let mean = |of: &dyn Fn(&CastTexel) -> f64| texels.iter().map(of).sum::<f64>() / count;
    let (w, stored) = (mean(&|texel| texel.nearness.recip()), mean(&|texel| texel.stored));
    let spread = mean(&|texel| (texel.nearness.recip() - w).powi(2));
    let joint = mean(&|texel| (texel.nearness.recip() - w) * (texel.stored - stored));
    let factor = joint / spread;
    let offset = stored - factor * w;
    let is_one = factor.is_finite() && factor > 0.0;
    is_one.then_some(StoredQuantity::AxisDistance { factor, offset, residual: 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::PixelFormat;
    use crate::math::depth::DepthMapping;
    use crate::math::projection;
    use crate::plan::{DrawPart, MeshId, RasterState};

    const SIDE: u32 = 96;

    /// A slanted floor and a piece above it, as a light at the origin with a field of view of 90 degrees sees them along −z.
    fn corners() -> Vec<DVec4> {
        let clip = projection::perspective(90.0, 1.0, &DepthMapping::StandardFinite.curve(0.5, 40.0, 0.0));
        let at = |x: f64, y: f64, z: f64| clip * DVec4::new(x, y, z, 1.0);
        let floor = [at(-60.0, -60.0, -20.0), at(60.0, -60.0, -26.0), at(0.0, 90.0, -15.0)];
        let piece = [at(-2.0, -1.0, -8.0), at(3.0, -2.0, -7.0), at(0.0, 3.0, -9.0)];
        [floor, piece].concat()
    }

    fn draw(writes_depth: ShaderEffect) -> Draw {
        let raster = RasterState { cull: None, ..RasterState::surface() };
        let program = Program::Recorded { may_discard: ShaderEffect::No, writes_depth };
        Draw { program, ..Draw::of_positions("map".to_owned(), DrawPart::Map, MeshId(0), 2, raster) }
    }

    /// What texels hold by a quantity of the point that is nearest to the light.
    fn quantity_of(holds: impl Fn(DVec2, f64, f64) -> f64) -> StoredQuantity {
        let (draw, corners) = (draw(ShaderEffect::Yes), corners());
        let texel = |index: u32| {
            let place = DVec2::new(f64::from(index % SIDE) + 0.5, f64::from(index / SIDE) + 0.5) / f64::from(SIDE);
            let place = (place * 2.0 - 1.0) * DVec2::new(1.0, -1.0);
            let points = corners.as_chunks::<3>().0.iter().filter_map(|corners| point_of(corners, place, false));
            let nearest = points.min_by(|a, b| a[0].total_cmp(&b[0]));
            (nearest.map_or(1.0, |[depth, nearness]| holds(place, depth, nearness)) as f32).to_le_bytes()
        };
        let bytes: Vec<u8> = (0..SIDE * SIDE).flat_map(texel).collect();
        let image = Image::packed(PixelFormat::Depth32F, [SIDE; 2], bytes);
        let texels = cast_texels(&[(&draw, corners.clone())], &image);
        assert!(texels.len() > 1000, "{}", texels.len());
        explained(&texels)
    }

    #[test]
    fn depths_and_distances_are_told_apart() {
        assert_eq!(quantity_of(|_, depth, _| depth), StoredQuantity::Depth);
        let far = 64.0;
        let found = quantity_of(|place, _, nearness| place.extend(1.0).length() / nearness / far);
        let StoredQuantity::Distance { squares, residual } = found else { panic!("{found:?}") };
        let expected = 1.0 / (far * far);
        assert!(squares.iter().all(|square| (square / expected - 1.0).abs() < 1e-4), "{squares:?}");
        assert!(residual < 1e-6, "{residual}");
        let found = quantity_of(|_, _, nearness| (1.0 / nearness - 0.5) / 39.5);
        let StoredQuantity::AxisDistance { factor, offset, .. } = found else { panic!("{found:?}") };
        assert!((factor * 39.5 - 1.0).abs() < 1e-4 && (offset * 39.5 + 0.5).abs() < 1e-3, "{found:?}");
    }

    #[test]
    fn other_quantities_are_not_known() {
        assert_eq!(quantity_of(|_, _, nearness| (-0.1 / nearness).exp()), StoredQuantity::Unknown);
        assert_eq!(quantity_of(|place, _, nearness| (place.x * 40.0).sin().abs() * nearness), StoredQuantity::Unknown);
    }

    #[test]
    fn a_map_of_which_nothing_is_seen_holds_depths() {
        assert_eq!(explained(&[]), StoredQuantity::Depth);
        let clear = Image::uniform(PixelFormat::Depth32F, [4, 4], &1.0_f32.to_le_bytes());
        assert!(cast_texels(&[(&draw(ShaderEffect::Yes), corners())], &clear).is_empty());
    }

    #[test]
    fn small_triangles_are_found_where_a_side_is_no_multiple_of_the_step() {
        let cells = 1080.0 / 23.0;
        for column in 0..46_u32 {
            let x = (f64::from(column) + 0.5) / cells * 2.0 - 1.0;
            let around = [[-1e-3, 1e-3], [1e-3, 1e-3], [0.0, -1e-3]].map(|[dx, y]| DVec4::new(x + dx, y, 0.5, 1.0));
            assert!(indices_round(&around, [46, 46], [cells; 2]).any(|index| index as u32 % 46 == column), "{column}");
        }
    }

    #[test]
    fn faces_that_are_culled_hold_nothing() {
        let mut culling = draw(ShaderEffect::Yes);
        let [first, second, third] = corners()[..3] else { panic!("three corners") };
        let is_front = turn(&[first, second, third]) > 0.0;
        culling.raster.front_face = wgpu_types::FrontFace::Ccw;
        culling.raster.cull = Some(if is_front { wgpu_types::Face::Front } else { wgpu_types::Face::Back });
        assert!(is_culled(&culling, &[first, second, third]));
        assert!(!is_culled(&culling, &[first, third, second]));
    }
}

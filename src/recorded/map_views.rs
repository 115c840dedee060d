//! With which view a shadow map was drawn, and so where its light is.
//!
//! A mesh that is drawn into the map and into the picture has its corners in both clip spaces, in one order. Clip space
//! of the map is linear in the eye's space, so four corners that lie in no plane determine the matrix between them, and
//! all others check it. Copies of one mesh fit each other as well: each pair of meshes is a hypothesis, the one on which
//! most meshes agree is meant, and faces of one map share a light. That light is where x, y and w of the map's clip space
//! vanish together.

use super::space::{PassSpace, triangles};
use crate::plan::{Draw, DrawPart, FramePlan, LightId, Pass};
use glam::{DMat4, DVec3, DVec4};
use std::collections::{BTreeMap, BTreeSet};

/// A corner may be off the matrix by this part of the largest clip coordinate of its mesh.
const SAME: f64 = 2e-4;
/// A mesh whose corners span less than this part of the volume of the box round them is flat: it alone does not determine
/// a matrix.
const LEAST_VOLUME: f64 = 1e-9;
/// Limits on the pairs of meshes of a face that are tried alone, and two at a time.
const MOST_PAIRS: usize = 4000;
const MOST_PAIRS_OF_TWO: usize = 400;
/// Limit on the corners of all pairs of a face together.
const MOST_CORNERS: usize = 20_000_000;
/// A light that is as far away as this many times the size of the scene is a direction.
const DISTANT: f64 = 1e4;

/// A light is found by one draw alone only if its triangles have more corners than those of a box.
const LEAST_CORNERS: usize = 36;
/// This part of the draws into the faces that are known must agree.
const LEAST_SHARE: f64 = 0.1;

/// A face of a shadow map, as its own draws tell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundMapView {
    /// Clip space of the whole face from the eye's space; w is not normalised.
    pub clip_from_eye: DMat4,
    /// How far corners that had no part in a fit are off, at most, in texels.
    pub residual: f64,
    /// The number of the map's draws whose corners agree.
    pub agree: usize,
    /// The number of the map's draws.
    pub of: usize,
}

/// A light, as the views of its map tell.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundMapLight {
    /// Homogeneous position in the eye's space: a point, or with `w = 0` the direction towards it.
    pub position: DVec4,
    /// The view of each face; `None` for those of which no mesh is in the picture, too.
    pub faces: Vec<Option<FoundMapView>>,
}

/// The corners of a draw's triangles, one after the other.
type DrawCorners = Vec<DVec4>;

/// A matrix that explains some of a face's draws.
#[derive(Debug, Clone)]
struct ViewHypothesis {
    clip_from_eye: DMat4,
    position: DVec4,
    /// For each draw that agrees, the draw of the picture with its corners and its own.
    pairs: Vec<(usize, usize)>,
    /// The number of their corners.
    corners: usize,
}

impl ViewHypothesis {
    /// Returns how well it is confirmed: by the number of draws, then of corners.
    fn weight(&self) -> (usize, usize) {
        (self.pairs.len(), self.corners)
    }
}

/// Finds the light of a map of a recorded plan: the one of all passes of this light into the map with this number of
/// faces. `None` where no mesh of them is in the picture, too, where several places explain them equally well, or where
/// the map is drawn from the eye itself.
pub fn map_light(plan: &FramePlan, light: LightId, faces: usize) -> Option<FoundMapLight> {
    if faces == 0 {
        return None;
    }
    let drawn: Vec<Vec<DrawCorners>> = (0..faces).map(|face| map_corners(plan, light, face as u32)).collect();
    let seen = SeenCorners::of(plan);
    let found: Vec<Vec<ViewHypothesis>> = drawn.iter().map(|drawn| seen.hypotheses(plan, light, drawn)).collect();
    let SeenCorners { surfaces: seen, extent } = seen;
    let position = elected(&found, extent)?;
    let size = plan.attachments.get(map_of(plan, light)?)?.size;
    let view = |(found, drawn): (&Vec<ViewHypothesis>, &Vec<DrawCorners>)| {
        let meant = found.iter().filter(|one| is_same_place(one.position, position, extent));
        let best = meant.max_by_key(|one| one.weight())?;
        Some(FoundMapView {
            clip_from_eye: best.clip_from_eye,
            residual: residual(best, &seen, drawn, size),
            agree: best.pairs.len(),
            of: drawn.len(),
        })
    };
    let faces: Vec<Option<FoundMapView>> = found.iter().zip(&drawn).map(view).collect();
    // The eye's own depths, which a shader reads for other reasons, are no light's.
    let is_eye = position.w == 1.0 && position.truncate().length() < 1e-4 * extent;
    let agree: usize = faces.iter().flatten().map(|face| face.agree).sum();
    let of: usize = faces.iter().flatten().map(|face| face.of).sum();
    // Eight corners of one box fit any other box.
    let is_sure = agree > 1 || meant_corners(&found, position, extent) > LEAST_CORNERS;
    let is_found = !is_eye && is_sure && agree as f64 >= LEAST_SHARE * of as f64;
    is_found.then_some(FoundMapLight { position, faces })
}

/// Says which maps of a plan share a light, where each has one face and is of a light of its own: for each of them the index
/// of a light, or `None` where none is found. `layers_of` has for each map what others are layers of, too: layers of one
/// texture are mostly of one light, of which all of them tell together. Faces with one view, as of two frames or two eyes, are
/// not of one map.
pub fn lights_of_faces(plan: &FramePlan, layers_of: &[usize]) -> Vec<Option<usize>> {
    let seen = SeenCorners::of(plan);
    let of_map = |map: usize| seen.hypotheses(plan, LightId(map), &map_corners(plan, LightId(map), 0));
    let found: Vec<Vec<ViewHypothesis>> = (0..layers_of.len()).map(of_map).collect();
    let mut together: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (map, of) in layers_of.iter().enumerate() {
        together.entry(*of).or_default().push(map);
    }
    let is_at = |one: &&ViewHypothesis, place: DVec4| is_same_place(one.position, place, seen.extent);
    let mut places: Vec<Option<DVec4>> = vec![None; layers_of.len()];
    for maps in together.values() {
        let of_maps: Vec<Vec<ViewHypothesis>> = maps.iter().map(|map| found[*map].clone()).collect();
        let common = elected(&of_maps, seen.extent);
        for map in maps {
            // A layer of another light has several meshes that say so: a copy of one of them fits by chance.
            let is_of_common = common.is_some_and(|place| found[*map].iter().any(|one| is_at(&one, place)));
            let own = elected(std::slice::from_ref(&found[*map]), seen.extent).filter(|place| {
                let best = found[*map].iter().find(|one| is_at(one, *place));
                best.is_some_and(|one| one.pairs.len() > 1)
            });
            places[*map] = if is_of_common { common } else { own.or(common) };
        }
    }
    // Where several places explain a face equally well, one that is another face's is meant.
    let known: Vec<DVec4> = places.iter().flatten().copied().collect();
    for (place, found) in places.iter_mut().zip(&found).filter(|(place, _)| place.is_none()) {
        let most = found.iter().map(|one| one.pairs.len()).max();
        let mut best = found.iter().filter(|one| Some(one.pairs.len()) == most);
        *place = best.find_map(|one| known.iter().copied().find(|known| is_at(&one, *known)));
    }
    let mut lights: Vec<(DVec4, Vec<DMat4>)> = Vec::new();
    let light_of = |(place, found): (Option<DVec4>, &Vec<ViewHypothesis>)| {
        let place = place?;
        let view = found.iter().find(|one| is_at(one, place)).map(|one| one.clip_from_eye);
        let takes = |(at, views): &(DVec4, Vec<DMat4>)| {
            let is_new = view.is_none_or(|view| !views.iter().any(|known| is_same_view(*known, view)));
            is_new && is_same_place(*at, place, seen.extent)
        };
        let light = lights.iter().position(takes).unwrap_or_else(|| {
            lights.push((place, Vec::new()));
            lights.len() - 1
        });
        lights[light].1.extend(view);
        Some(light)
    };
    places.into_iter().zip(&found).map(light_of).collect()
}

/// Returns whether two views are one, but for rounding: clip space has no scale of its own.
fn is_same_view(one: DMat4, other: DMat4) -> bool {
    const NEAR: f64 = 1e-4;
    let [one, other] = [one, other].map(|view| {
        let values = view.to_cols_array();
        let length = values.iter().map(|value| value * value).sum::<f64>().sqrt();
        values.map(|value| value / length)
    });
    one.iter().zip(other).all(|(one, other)| (one - other).abs() < NEAR)
}

/// Returns the number of corners of the hypotheses for a place.
fn meant_corners(found: &[Vec<ViewHypothesis>], position: DVec4, extent: f64) -> usize {
    let meant = found.iter().flatten().filter(|one| is_same_place(one.position, position, extent));
    meant.map(|one| one.corners).max().unwrap_or_default()
}

/// Returns the index of the attachment that the passes of a light draw its map into.
fn map_of(plan: &FramePlan, light: LightId) -> Option<usize> {
    let is_map = |attachment: &crate::plan::Attachment| attachment.role == crate::plan::AttachmentRole::Map(light);
    plan.attachments.iter().position(is_map)
}

/// Returns the passes that made what a face of a light's map holds at the end: those since it was set by something other
/// than a draw, as one texture may serve several lights in turn.
fn passes_of(plan: &FramePlan, light: LightId, face: u32) -> impl Iterator<Item = &Pass> {
    let map = map_of(plan, light);
    let is_of_face = move |pass: &&Pass| {
        let target = pass.depth_stencil.as_ref();
        target.is_some_and(|target| Some(target.attachment.0) == map && target.layer == face)
    };
    let is_set = |pass: &Pass| {
        let starts = pass.recorded.as_ref().and_then(|recorded| recorded.start.as_ref()?.depth.as_ref());
        starts.is_some() || pass.depth_stencil.as_ref().is_some_and(|target| target.clear_depth.is_some())
    };
    let first = plan.passes.iter().rposition(|pass| is_of_face(&pass) && is_set(pass)).unwrap_or(0);
    plan.passes[first..].iter().filter(is_of_face)
}

/// Returns whether the draws of a light's map let greater depths pass.
fn is_reversed(plan: &FramePlan, light: LightId) -> bool {
    use wgpu_types::CompareFunction::{Greater, GreaterEqual};
    let passes = plan.passes.iter().filter(|pass| pass.light == Some(light) && !plan.is_of_picture(pass));
    let (reversed, all) = passes.flat_map(|pass| &pass.draws).fold((0, 0), |(reversed, all), draw| {
        (reversed + usize::from(matches!(draw.raster.depth_compare, Greater | GreaterEqual)), all + 1)
    });
    reversed * 2 > all
}

/// The corners of the picture's surfaces, a list for each, in the eye's space.
struct SeenCorners {
    surfaces: Vec<DrawCorners>,
    /// The greatest distance of one from the eye.
    extent: f64,
}

impl SeenCorners {
    fn of(plan: &FramePlan) -> SeenCorners {
        let surfaces = distinct(seen_corners(plan));
        let extent = surfaces.iter().flatten().map(|at| at.truncate().length()).fold(0.0, f64::max);
        SeenCorners { surfaces, extent }
    }

    /// Returns what explains the corners that are drawn into a face of a light's map.
    fn hypotheses(&self, plan: &FramePlan, light: LightId, drawn: &[DrawCorners]) -> Vec<ViewHypothesis> {
        hypotheses(&self.surfaces, drawn, is_reversed(plan, light), self.extent)
    }
}

/// Returns the corners of the picture's surfaces in the eye's space, those whose triangles are all finite.
fn seen_corners(plan: &FramePlan) -> Vec<DrawCorners> {
    let picture = plan.passes.iter().filter(|pass| plan.is_of_picture(pass));
    let draws = picture.flat_map(|pass| pass.draws.iter().map(move |draw| (pass, draw)));
    let surfaces = draws.filter(|(_, draw)| draw.part == DrawPart::Surface && draw.raster.depth_write);
    let corners = |(pass, of): (&Pass, &Draw)| {
        let places = PassSpace::new(plan, pass).places(plan, of);
        let corners: Vec<DVec4> = triangles(plan, of, &places).flat_map(|(_, corners)| corners).collect();
        let is_whole = corners.len() == of.triangles.len() * 3 && corners.iter().all(|corner| corner.w == 1.0);
        is_whole.then_some(corners)
    };
    surfaces.filter_map(corners).collect()
}

/// Returns the corners of the draws into a face of a map, in clip space of the whole face and all depths.
fn map_corners(plan: &FramePlan, light: LightId, face: u32) -> Vec<DrawCorners> {
    drawn_into_face(plan, light, face).into_iter().map(|(_, corners)| corners).collect()
}

/// Returns the draws into a face of a map that make what it holds at the end, each with its corners in clip space of the whole
/// face and all depths, those whose corners are all finite.
pub(super) fn drawn_into_face(plan: &FramePlan, light: LightId, face: u32) -> Vec<(&Draw, Vec<DVec4>)> {
    let Some(size) = map_of(plan, light).map(|map| plan.attachments[map].size) else { return Vec::new() };
    let draws = passes_of(plan, light, face).flat_map(|pass| pass.draws.iter().map(move |draw| (pass, draw)));
    let with_corners = draws.filter_map(|(pass, of)| {
        let viewport = pass.viewport(size);
        let whole = |vertex: &[f32; 4]| {
            let clip = viewport.clip_of_target(size, DVec4::from_array(vertex.map(f64::from)));
            clip.is_finite().then_some(clip)
        };
        let places: Vec<Option<DVec4>> = plan.meshes[of.mesh.0].vertices.data().iter().map(whole).collect();
        let corners: Vec<DVec4> = triangles(plan, of, &places).flat_map(|(_, corners)| corners).collect();
        (corners.len() == of.triangles.len() * 3).then_some((of, corners))
    });
    with_corners.collect()
}

/// Returns draws without those that repeat another: a surface may be drawn again for each light.
fn distinct(all: Vec<DrawCorners>) -> Vec<DrawCorners> {
    let mut known: BTreeSet<Vec<[u64; 4]>> = BTreeSet::new();
    let key = |of: &DrawCorners| {
        let step = of.len().div_ceil(16).max(1);
        let some = of.iter().step_by(step).map(|corner| corner.to_array().map(f64::to_bits));
        some.chain([[of.len() as u64; 4]]).collect::<Vec<_>>()
    };
    all.into_iter().filter(|of| known.insert(key(of))).collect()
}

/// Returns the matrices that explain draws of a face, the best confirmed first.
fn hypotheses(seen: &[DrawCorners], drawn: &[DrawCorners], is_reversed: bool, extent: f64) -> Vec<ViewHypothesis> {
    let mut of_count: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (index, of) in seen.iter().enumerate() {
        of_count.entry(of.len()).or_default().push(index);
    }
    let alike = |of: &DrawCorners| of_count.get(&of.len()).cloned().unwrap_or_default();
    let mut corners_left = MOST_CORNERS;
    let pairs: Vec<(usize, usize)> = drawn
        .iter()
        .enumerate()
        .flat_map(|(map, of)| alike(of).into_iter().map(move |seen| (seen, map)))
        .take(MOST_PAIRS)
        .take_while(|(_, map)| {
            let corners = drawn[*map].len();
            let fits = corners <= corners_left;
            corners_left = corners_left.saturating_sub(corners);
            fits
        })
        .collect();
    let explained = |matrix: &DMat4| -> Vec<(usize, usize)> {
        let mut agreeing: Vec<(usize, usize)> = Vec::new();
        // The pairs of one draw of the map follow each other.
        for (eye, map) in &pairs {
            let is_known = agreeing.last().is_some_and(|(_, last)| last == map);
            if !is_known && fits(matrix, &seen[*eye], &drawn[*map]) {
                agreeing.push((*eye, *map));
            }
        }
        agreeing
    };
    let hypothesis = |chosen: &[(usize, usize)]| {
        let matrix = fitted(chosen.iter().map(|(eye, map)| (&seen[*eye][..], &drawn[*map][..])))?;
        let all = chosen.iter().all(|(eye, map)| fits(&matrix, &seen[*eye], &drawn[*map]));
        let agreeing = all.then(|| explained(&matrix))?;
        // Once more through all that agree.
        let of_all = agreeing.iter().map(|(eye, map)| (&seen[*eye][..], &drawn[*map][..]));
        let clip_from_eye = fitted(of_all).unwrap_or(matrix);
        let corners = agreeing.iter().map(|(_, map)| drawn[*map].len()).sum();
        let position = light_place(clip_from_eye, is_reversed, extent)?;
        Some(ViewHypothesis { clip_from_eye, position, pairs: agreeing, corners })
    };
    let mut found: Vec<ViewHypothesis> = Vec::new();
    for pair in &pairs {
        if !found.iter().any(|one| one.pairs.contains(pair)) {
            found.extend(hypothesis(&[*pair]));
        }
    }
    if found.is_empty() {
        // Each mesh is flat: two together are not.
        let twos =
            pairs.iter().enumerate().flat_map(|(index, one)| pairs[index + 1..].iter().map(move |two| (one, two)));
        let twos = twos.filter(|(one, two)| one.0 != two.0 && one.1 != two.1).take(MOST_PAIRS_OF_TWO);
        found.extend(twos.filter_map(|(one, two)| hypothesis(&[*one, *two])));
    }
    found.sort_by_key(|one| std::cmp::Reverse(one.weight()));
    found
}

/// Returns the matrix that takes the corners of each pair from the first space to the second, by least squares; `None`
/// where they lie in a plane.
fn fitted<'a>(pairs: impl Iterator<Item = (&'a [DVec4], &'a [DVec4])> + Clone) -> Option<DMat4> {
    let corners = || pairs.clone().flat_map(|(eye, clip)| eye.iter().zip(clip));
    let count = corners().count() as f64;
    let middle = corners().map(|(eye, _)| eye.truncate()).sum::<DVec3>() / count;
    let size = corners().map(|(eye, _)| (eye.truncate() - middle).abs().max_element()).fold(0.0, f64::max);
    if size == 0.0 {
        return None;
    }
    // Round the middle and of size 1, so that the sums are well conditioned.
    let (mut squares, mut products) = (DMat4::ZERO, DMat4::ZERO);
    for (eye, clip) in corners() {
        let place = ((eye.truncate() - middle) / size).extend(1.0);
        squares += DMat4::from_cols(place * place.x, place * place.y, place * place.z, place * place.w);
        products += DMat4::from_cols(*clip * place.x, *clip * place.y, *clip * place.z, *clip * place.w);
    }
    let (squares, products) = (squares * (1.0 / count), products * (1.0 / count));
    if squares.determinant() < LEAST_VOLUME {
        return None;
    }
    let from_scaled = products * squares.inverse();
    let scaled = DMat4::from_scale(DVec3::splat(1.0 / size)) * DMat4::from_translation(-middle);
    let matrix = from_scaled * scaled;
    matrix.is_finite().then_some(matrix)
}

/// Returns whether a matrix takes each corner to its partner, but for rounding.
fn fits(matrix: &DMat4, eye: &[DVec4], clip: &[DVec4]) -> bool {
    let largest = clip.iter().map(|corner| corner.abs().max_element()).fold(0.0, f64::max);
    let is_near = |(eye, clip): (&DVec4, &DVec4)| (*matrix * *eye - *clip).abs().max_element() <= SAME * largest;
    // A few corners refuse most matrices.
    let step = eye.len().div_ceil(8).max(1);
    eye.iter().zip(clip).step_by(step).all(is_near) && eye.iter().zip(clip).all(is_near)
}

/// Returns where x, y and w of a clip space vanish: homogeneous, a point or a direction towards the light, from which
/// depth grows, or falls where it is reversed. `None` where that is no single place.
fn light_place(matrix: DMat4, is_reversed: bool, extent: f64) -> Option<DVec4> {
    let rows = [matrix.row(0), matrix.row(1), matrix.row(3)].map(DVec4::normalize_or_zero);
    let without = |left_out: usize| {
        let column = |row: DVec4| {
            let kept: Vec<f64> = (0..4).filter(|column| *column != left_out).map(|column| row[column]).collect();
            DVec3::new(kept[0], kept[1], kept[2])
        };
        let [a, b, c] = rows.map(column);
        let sign = if left_out.is_multiple_of(2) { 1.0 } else { -1.0 };
        sign * a.dot(b.cross(c))
    };
    let place = DVec4::new(without(0), without(1), without(2), without(3));
    let length = place.truncate().length();
    if !place.is_finite() || place.length() < 1e-12 {
        return None;
    }
    if place.w.abs() * DISTANT * extent > length {
        return Some(place / place.w);
    }
    let towards = (place.truncate() / length).extend(0.0);
    let depth_falls = matrix.row(2).dot(towards) < 0.0;
    Some(if depth_falls == is_reversed { -towards } else { towards })
}

/// Returns whether two places of lights are one, but for rounding.
fn is_same_place(one: DVec4, other: DVec4, extent: f64) -> bool {
    const NEAR: f64 = 1e-3;
    let off = (one.truncate() - other.truncate()).length();
    let scale = if one.w == 0.0 { 1.0 } else { one.truncate().length().max(extent) };
    one.w == other.w && off < NEAR * scale
}

/// Returns the place on which the best confirmed hypotheses of most faces agree; `None` where there is none, or another
/// place is as well confirmed.
fn elected(faces: &[Vec<ViewHypothesis>], extent: f64) -> Option<DVec4> {
    let votes = |place: DVec4| {
        let best = |of: &Vec<ViewHypothesis>| {
            let meant = of.iter().filter(|one| is_same_place(one.position, place, extent));
            meant.map(ViewHypothesis::weight).max().unwrap_or_default()
        };
        faces.iter().map(best).fold((0, 0), |(draws, corners), one| (draws + one.0, corners + one.1))
    };
    let places: Vec<DVec4> = faces.iter().flatten().map(|one| one.position).collect();
    let best = places.iter().copied().max_by_key(|place| votes(*place))?;
    let is_equal = |place: &&DVec4| !is_same_place(**place, best, extent) && votes(**place) == votes(best);
    (!places.iter().any(|place| is_equal(&place))).then_some(best)
}

/// Returns how far corners are off a matrix that is fitted without them, at most, in texels: those of every other
/// triangle, where they are inside the face.
fn residual(found: &ViewHypothesis, seen: &[DrawCorners], drawn: &[DrawCorners], size: [u32; 2]) -> f64 {
    let parts = |held_back: bool| {
        let of = found.pairs.iter().map(move |(eye, map)| {
            let half = |corners: &[DVec4]| -> Vec<DVec4> {
                let triangles = corners.chunks(3).enumerate();
                triangles.filter(|(index, _)| (index % 2 == 1) == held_back).flat_map(|(_, one)| one.to_vec()).collect()
            };
            (half(&seen[*eye]), half(&drawn[*map]))
        });
        of.collect::<Vec<_>>()
    };
    let (fit, check) = (parts(false), parts(true));
    let matrix = fitted(fit.iter().map(|(eye, clip)| (&eye[..], &clip[..]))).unwrap_or(found.clip_from_eye);
    let texels = glam::DVec2::new(f64::from(size[0]), f64::from(size[1])) * 0.5;
    let off = |(eye, clip): (&DVec4, &DVec4)| {
        let is_in = clip.w > 0.0 && clip.truncate().truncate().abs().max_element() <= clip.w;
        let made = matrix * *eye;
        let apart = made.truncate().truncate() / made.w - clip.truncate().truncate() / clip.w;
        if is_in { (apart * texels).length() } else { 0.0 }
    };
    check.iter().flat_map(|(eye, clip)| eye.iter().zip(clip)).map(off).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::depth::DepthMapping;
    use crate::math::projection;
    use glam::dcamera::rh::view::look_at_mat4;

    /// A light at `eye` that looks at `target` with a near plane at 1 and a far plane at 50.
    fn view(eye: DVec3, target: DVec3) -> DMat4 {
        projection::frustum(1.8, 1.8, &DepthMapping::StandardFinite.curve(1.0, 50.0, 0.0))
            * look_at_mat4(eye, target, DVec3::Y)
    }

    /// Corners that lie in no plane, round a place.
    fn mesh(round: DVec3) -> DrawCorners {
        let corner = |index: usize| {
            let at = index as f64;
            (round + DVec3::new((at * 1.7).sin(), (at * 0.9).cos() * 2.0, (at * 2.3).sin())).extend(1.0)
        };
        (0..30).map(corner).collect()
    }

    /// What a map's vertex shader makes of corners.
    fn drawn(view: DMat4, corners: &DrawCorners) -> DrawCorners {
        corners.iter().map(|corner| (view * *corner).as_vec4().as_dvec4()).collect()
    }

    #[test]
    fn a_view_and_its_light_are_found_among_meshes_that_are_not_in_the_map() {
        let light = DVec3::new(3.0, 9.0, -12.0);
        let clip = view(light, DVec3::new(0.0, 0.0, -20.0));
        let seen = vec![mesh(DVec3::new(0.0, 1.0, -20.0)), mesh(DVec3::new(4.0, 0.0, -23.0))];
        let found = hypotheses(&seen, &[drawn(clip, &seen[1])], false, 30.0);
        let alone: Vec<_> = found.iter().filter(|one| is_same_place(one.position, light.extend(1.0), 30.0)).collect();
        assert!(!alone.is_empty() && alone[0].pairs == [(1, 0)], "{found:?}");
        // With both of them in the map there is no doubt.
        let both = seen.iter().map(|one| drawn(clip, one)).collect::<Vec<_>>();
        let found = hypotheses(&seen, &both, false, 30.0);
        let position = elected(std::slice::from_ref(&found), 30.0).expect("a light");
        assert!((position - light.extend(1.0)).length() < 1e-4, "{position}");
        assert!(residual(&found[0], &seen, &both, [1024, 1024]) < 1e-3);
    }

    #[test]
    fn copies_of_a_mesh_that_fit_equally_well_tell_no_light() {
        let clip = view(DVec3::new(3.0, 9.0, -12.0), DVec3::new(0.0, 0.0, -20.0));
        let seen = vec![mesh(DVec3::new(0.0, 1.0, -20.0)), mesh(DVec3::new(4.0, 0.0, -23.0))];
        let one_of_them = vec![drawn(clip, &seen[1])];
        assert_eq!(elected(&[hypotheses(&seen, &one_of_them, false, 30.0)], 30.0), None);
    }

    #[test]
    fn flat_meshes_tell_a_view_together() {
        let clip = view(DVec3::new(3.0, 9.0, -12.0), DVec3::new(0.0, 0.0, -20.0));
        let flat = |up: f64, count: usize| -> DrawCorners {
            mesh(DVec3::ZERO).into_iter().take(count).map(|at| DVec4::new(at.x, up, at.z - 20.0, 1.0)).collect()
        };
        let seen = vec![flat(0.0, 30), flat(2.0, 27)];
        assert!(fitted([(&seen[0][..], &drawn(clip, &seen[0])[..])].into_iter()).is_none());
        let both = seen.iter().map(|one| drawn(clip, one)).collect::<Vec<_>>();
        let position = elected(&[hypotheses(&seen, &both, false, 30.0)], 30.0).expect("a light");
        assert!((position - DVec4::new(3.0, 9.0, -12.0, 1.0)).length() < 1e-3, "{position}");
    }

    #[test]
    fn a_parallel_view_has_a_direction_from_which_depth_grows() {
        let towards = DVec3::new(1.0, 3.0, 0.5).normalize();
        let look = look_at_mat4(towards * 20.0, DVec3::ZERO, DVec3::Y);
        for is_reversed in [false, true] {
            let clip = projection::orthographic([9.0, 9.0], 1.0, 40.0, is_reversed) * look;
            let found = light_place(clip, is_reversed, 10.0).expect("a direction");
            assert!((found - towards.extend(0.0)).length() < 1e-9, "{found}");
        }
    }
}

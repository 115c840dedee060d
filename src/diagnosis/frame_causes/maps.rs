//! What is wrong with the shadow map of another program's frame, by the states and the triangles of the draws into it. The
//! map is read as [`MapLookup::RECORDED`](crate::plan::MapLookup::RECORDED) says: what its shader does with it is not known.

use super::{FrameFinding, FrameRule, RecordedLight};
use crate::capture::{MapProjection, PixelUnprojection, StoredQuantity};
use crate::diagnosis::Cause;
use crate::diagnosis::evidence::{Evidence, Quantity};
use crate::numbers;
use crate::plan::Draw;
use crate::recorded::MapReading;
use crate::truth::{LIT, SHADOW};
use glam::{DMat4, DVec2, DVec3, DVec4};

/// The rules for the causes that can be seen in the draws into a shadow map whose view is known.
pub(super) const RULES: [FrameRule; 9] = [
    FrameRule {
        cause: Cause::Acne,
        meaning: Some(
            "A surface shadows itself: a texel stores one depth of it for several pixels, and what is taken off before the \
             comparison is too little. Add a bias by slope (glPolygonOffset, depthBiasSlopeFactor), or move the lookup along \
             the surface's normal.",
        ),
        includes: &[],
        look: |light| light.acne(),
    },
    FrameRule {
        cause: Cause::MapFarPlane,
        meaning: Some(
            "The far plane of the light's view cuts casters away, or what they fall on. Move it beyond all of them; depth \
             clamping keeps casters, but not their order.",
        ),
        includes: &[],
        look: |light| light.beyond_far_plane(),
    },
    FrameRule {
        cause: Cause::MapNearPlane,
        meaning: Some(
            "The near plane of the light's view cuts casters away. Move it nearer, or clamp depth (GL_DEPTH_CLAMP, \
             depthClampEnable) while the map is drawn.",
        ),
        includes: &[],
        look: |light| light.before_near_plane(),
    },
    FrameRule {
        cause: Cause::MapFacesCulled,
        meaning: Some(
            "The map leaves out faces of casters: where a caster is open or thin, none between light and surface is left. \
             Draw both faces into the map, with a bias against acne.",
        ),
        includes: &[],
        look: |light| light.map_culls(),
    },
    FrameRule {
        cause: Cause::PeterPanning,
        meaning: Some(
            "The depth bias of the draws into the map moves what they store further from the light than the gap between \
             caster and surface. Lower it (glPolygonOffset, depthBiasConstantFactor).",
        ),
        includes: &[],
        look: |light| light.map_bias(),
    },
    FrameRule {
        cause: Cause::OutsideMap,
        meaning: Some(
            "Surfaces lie outside of what the light's view covers. Make it wider, or fit it to what is seen.",
        ),
        includes: &[],
        look: |light| light.outside(),
    },
    FrameRule { cause: Cause::MapNotCleared, meaning: None, includes: &[], look: |light| light.map_not_cleared() },
    FrameRule { cause: Cause::MapDepthCoarse, meaning: None, includes: &[], look: |light| light.depths_are_alike() },
    FrameRule {
        cause: Cause::Aliasing,
        meaning: Some(
            "Texels of the map are coarser than the shadow's outline. Use a larger map, or a view that is fitted closer to \
             what is seen.",
        ),
        includes: &[],
        look: |light| light.coarse(),
    },
];

/// How much wider a view is made at most.
const MOST_WIDENED: f64 = 8.0;
/// The most pixels of which neighbours are examined.
const MOST_EXAMINED: usize = 3000;
/// How far before the near plane depths are brought into the map's range; what lies nearer is clamped.
const MOST_BEFORE: f64 = -1e3;

impl RecordedLight<'_> {
    fn beyond_far_plane(&self) -> Option<FrameFinding> {
        let is_reversed = self.is_reversed();
        let depth = |clip: &DVec4| if is_reversed { 1.0 - clip.z / clip.w } else { clip.z / clip.w };
        let depths: Vec<f64> = self.inside_sides().iter().map(depth).filter(|depth| *depth > 1.0).collect();
        let farthest = depths.iter().copied().fold(1.0, f64::max) * (1.0 + 1e-3);
        if depths.is_empty() {
            return None;
        }
        // All depths are scaled so that the farthest corner has 1.
        let (z, w) = if is_reversed { (1.0 / farthest, 1.0 - 1.0 / farthest) } else { (1.0 / farthest, 0.0) };
        let mut changed = DMat4::IDENTITY;
        changed.z_axis.z = z;
        changed.w_axis.z = w;
        let sentence = format!(
            "{} corners drawn into the map lie beyond the far plane of its view",
            numbers::count(depths.len() as u64)
        );
        let corners = Quantity::at_least("corners beyond the far plane of the map", depths.len() as f64, 1.0);
        Some(FrameFinding { evidence: Evidence::of_frame(sentence, corners), fixed: self.with_view(changed) })
    }

    fn before_near_plane(&self) -> Option<FrameFinding> {
        let is_reversed = self.is_reversed();
        let depth = |clip: &DVec4| if is_reversed { 1.0 - clip.z / clip.w } else { clip.z / clip.w };
        let depths: Vec<f64> = self.inside_sides().iter().map(depth).filter(|depth| *depth < 0.0).collect();
        let is_clipped = self.map_draws().any(|(_, draw)| !draw.raster.unclipped_depth);
        if depths.is_empty() || !is_clipped {
            return None;
        }
        // All depths are moved so that the nearest corner has 0, and 1 stays.
        let nearest = depths.iter().copied().fold(0.0, f64::min).max(MOST_BEFORE) * (1.0 + 1e-3);
        let scale = 1.0 / (1.0 - nearest);
        let mut changed = DMat4::IDENTITY;
        changed.z_axis.z = scale;
        changed.w_axis.z = if is_reversed { 0.0 } else { -nearest * scale };
        let mut fixed = self.with_view(changed);
        for (pass, _) in fixed.passes.iter_mut().zip(&self.plan.passes).filter(|(_, own)| self.is_into_map(own)) {
            pass.draws.iter_mut().for_each(|draw| draw.raster.unclipped_depth = true);
        }
        let sentence = format!(
            "{} corners drawn into the map lie before the near plane of its view, and depth clamping is off",
            numbers::count(depths.len() as u64)
        );
        let corners = Quantity::at_least("corners before the near plane of the map", depths.len() as f64, 1.0);
        Some(FrameFinding { evidence: Evidence::of_frame(sentence, corners), fixed })
    }

    /// Looks for lit pixels that are dark without a bias, and that the program draws darker than others of their surface
    /// beside them that need none; returns how many are, with the plan in which the draws into the map have enough bias.
    fn acne(&self) -> Option<FrameFinding> {
        /// How much darker than those beside it, at least, is drawn dark: more than shading and rounding make.
        const DARKER: f64 = 0.97;
        /// How many columns and rows away pixels are beside another.
        const BESIDE: i64 = 3;
        /// Fewer of the lit pixels need a bias where back faces are stored: those at edges.
        const LEAST_NEEDING: f64 = 0.01;
        let reading = MapReading::new(self.capture, self.light, self.seen)?;
        let frame = self.capture.frame_at(self.capture.steps.len().checked_sub(1)?)?;
        let needing = reading.self_shadowed();
        let labels = self.capture.lights.get(self.light.0)?.shadow.as_ref()?;
        let lit = labels.rows().flatten().filter(|label| **label == LIT).count().max(1);
        let share = needing.len() as f64 / lit as f64;
        if share < LEAST_NEEDING {
            return None;
        }
        let brightness = |at: [u32; 2]| {
            let texel = frame.color.image.texel(at)?;
            Some(texel.iter().take(3).map(|channel| f64::from(*channel)).sum::<f64>())
        };
        let plane = |at: [u32; 2]| self.seen.at(at, &frame.depth.image).map(|(_, plane)| plane);
        let step = needing.len().div_ceil(MOST_EXAMINED).max(1);
        let (mut examined, mut dark) = (0, 0);
        for at in needing.iter().copied().step_by(step) {
            let (Some(own), Some(normal)) = (brightness(at), plane(at)) else { continue };
            let beside = (-BESIDE..=BESIDE).flat_map(|down| (-BESIDE..=BESIDE).map(move |right| [right, down]));
            let place = |[right, down]: [i64; 2]| {
                Some([u32::try_from(i64::from(at[0]) + right).ok()?, u32::try_from(i64::from(at[1]) + down).ok()?])
            };
            let needs_none = |at: &[u32; 2]| {
                let is_same = plane(*at).is_some_and(|other| other.dot(normal).abs() > 0.999);
                is_same && reading.margin(*at).is_some_and(|margin| margin < 0.0) && reading.label(*at) == LIT
            };
            let lit: Vec<f64> = beside.filter_map(place).filter(needs_none).filter_map(brightness).collect();
            if lit.len() < 2 {
                continue;
            }
            examined += 1;
            dark += usize::from(own < DARKER * lit.iter().sum::<f64>() / lit.len() as f64);
        }
        // Where a lookup has bias enough, shading makes a few darker by chance.
        if 2 * dark < examined || dark == 0 {
            return None;
        }
        let away = if self.is_reversed() { -1.0 } else { 1.0 };
        let fixed = self.with_map_states(|raster| {
            raster.depth_bias.slope_scale += away as f32 * 5.0;
            raster.depth_bias.constant = raster.depth_bias.constant.saturating_add(away as i32 * 16);
        });
        let sentence = format!(
            "{} lit pixels read a texel that holds their own surface as nearer; of {} that have others beside them which do \
             not, {} are drawn darker than those",
            numbers::count(needing.len() as u64),
            numbers::count(examined as u64),
            numbers::count(dark as u64)
        );
        let share =
            Quantity::at_least("share of lit pixels whose own surface is stored as nearer", share, LEAST_NEEDING);
        let evidence = Evidence { sentence, quantities: vec![share], shown_by: dark, examined };
        Some(FrameFinding { evidence, fixed })
    }

    fn depths_are_alike(&self) -> Option<FrameFinding> {
        /// Steps that a depth buffer has at least, of 24 bits or a float's between one half and one.
        const STEPS: f64 = (1_u32 << 24) as f64;
        /// As many as 12 bits have, which is too few for a gap of a thousandth of the scene.
        const MOST_USED: f64 = 4096.0;
        // What a shader writes has steps of its own.
        if self.capture.lights.get(self.light.0)?.map.as_ref()?.quantity != StoredQuantity::Depth {
            return None;
        }
        let clips = self.inside_sides();
        let view = self.map()?.clip_from_light.first()?;
        // A parallel view spreads depths evenly.
        let is_perspective = view.row(3).truncate().length() > 1e-6 * view.row(0).truncate().length();
        let range = |of: &dyn Fn(&DVec4) -> f64| {
            clips.iter().map(of).fold((f64::INFINITY, 0.0_f64), |(least, most), one| (least.min(one), most.max(one)))
        };
        let (nearest, farthest) = range(&|clip| clip.z / clip.w);
        let (near, far) = range(&|clip| clip.w);
        let used = (farthest - nearest) * STEPS;
        if !is_perspective || self.is_reversed() || !(near > 0.0 && far > near) || used > MOST_USED {
            return None;
        }
        // Depth by distance along the view's axis, as a near and a far plane give it that fit what is drawn.
        let (near, far) = (near * 0.99, far * 1.01);
        let (offset, scale) = (far / (far - near), -near * far / (far - near));
        let mut fixed = self.with_map_vertices(|clip| DVec4 { z: offset * clip.w + scale, ..clip });
        let map = fixed.lights[self.light.0].map.as_mut()?;
        for clip in &mut map.clip_from_light {
            let depth = clip.row(3) * offset + DVec4::W * scale;
            for (column, value) in depth.to_array().into_iter().enumerate() {
                clip.col_mut(column).z = value;
            }
        }
        map.clip_from_relative = map.clip_from_light.iter().map(DMat4::as_mat4).collect();
        let sentence = format!(
            "all depths drawn into the map lie within {} of its {} steps",
            numbers::count(used.ceil() as u64),
            numbers::count(STEPS as u64)
        );
        let steps = Quantity::at_most("steps of depth that the map uses", used, MOST_USED);
        Some(FrameFinding { evidence: Evidence::of_frame(sentence, steps), fixed })
    }

    fn map_culls(&self) -> Option<FrameFinding> {
        let culling = self.map_draws().filter(|(_, draw)| draw.raster.cull.is_some()).count();
        if culling == 0 {
            return None;
        }
        let faces = |face| self.map_draws().any(|(_, draw)| draw.raster.cull == Some(face));
        let [front, back] = [wgpu_types::Face::Front, wgpu_types::Face::Back].map(faces);
        let which = match (front, back) {
            (true, false) => "front faces",
            (false, true) => "back faces",
            _ => "front or back faces",
        };
        let sentence = format!("{} into the map cull {which}", numbers::counted(culling as u64, "draw"));
        let draws = Quantity::at_least("draws into the map that cull a face", culling as f64, 1.0);
        // Where faces meet, the middle of a texel that is read for one may lie on the other, half a texel on.
        let away = if self.is_reversed() { -0.5 } else { 0.5 };
        let fixed = self.with_map_states(|raster| {
            raster.cull = None;
            raster.depth_bias.slope_scale += away;
        });
        Some(FrameFinding { evidence: Evidence::of_frame(sentence, draws), fixed })
    }

    fn map_bias(&self) -> Option<FrameFinding> {
        let away = if self.is_reversed() { -1.0 } else { 1.0 };
        let constant = |draw: &Draw| away * f64::from(draw.raster.depth_bias.constant);
        let slope = |draw: &Draw| away * f64::from(draw.raster.depth_bias.slope_scale);
        let most = |of: &dyn Fn(&Draw) -> f64| self.map_draws().map(|(_, draw)| of(draw)).fold(0.0, f64::max);
        let (constant, slope) = (most(&constant), most(&slope));
        if constant + slope <= 0.0 {
            return None;
        }
        let sentence = format!(
            "the draws into the map add up to {} depth steps and {} slopes",
            numbers::digits(constant),
            numbers::digits(slope)
        );
        let bias = Quantity::more_than("steps and slopes of bias away from the light", constant + slope, 0.0);
        let fixed = self.with_map_states(|raster| raster.depth_bias = wgpu_types::DepthBiasState::default());
        Some(FrameFinding { evidence: Evidence::of_frame(sentence, bias), fixed })
    }

    fn outside(&self) -> Option<FrameFinding> {
        let map = self.map().filter(|map| map.faces.len() == 1)?;
        let view = map.clip_from_light.first()?;
        let frame = self.capture.frame_at(self.capture.steps.len().checked_sub(1)?)?;
        let pixels = PixelUnprojection::new(self.capture);
        let place = |at: &[u32; 2]| Some(*view * pixels.at(*at, frame.depth.image.depth_at(*at)?)?.extend(1.0));
        let off = |clip: DVec4| if clip.w > 0.0 { clip.x.abs().max(clip.y.abs()) / clip.w } else { f64::INFINITY };
        let outside: Vec<f64> = self.wrong.iter().filter_map(place).map(off).filter(|off| *off > 1.0).collect();
        let reached = outside.iter().copied().filter(|off| off.is_finite()).fold(1.0, f64::max);
        if outside.is_empty() {
            return None;
        }
        let widest = reached.min(MOST_WIDENED) * (1.0 + 1e-3);
        let mut fixed = self.with_view(DMat4::from_diagonal(DVec4::new(1.0 / widest, 1.0 / widest, 1.0, 1.0)));
        let is_as_fine = self.enlarge(&mut fixed, widest);
        let finer = if is_as_fine { "" } else { "; a map that is wider and as fine would be too large" };
        let sentence = format!(
            "{} of {} wrong pixels lie outside of the map, up to {} times as far from its middle as its border{finer}",
            numbers::count(outside.len() as u64),
            numbers::count(self.wrong.len() as u64),
            numbers::digits(reached)
        );
        let beyond = Quantity::more_than("widths of the map from its middle", reached, 1.0);
        let quantities = vec![beyond];
        let evidence = Evidence { sentence, quantities, shown_by: outside.len(), examined: self.wrong.len() };
        Some(FrameFinding { evidence, fixed })
    }

    fn map_not_cleared(&self) -> Option<FrameFinding> {
        let clear = self.capture.map_clear_depth(self.light.0);
        let mut fixed = self.plan.clone();
        let (mut texels, mut seen) = (0_u64, Vec::new());
        let map = self.map()?;
        for (index, pass) in self.plan.passes.iter().enumerate().filter(|(_, pass)| self.is_into_map(pass)) {
            let Some(target) = &pass.depth_stencil else { continue };
            // What later passes into a face find there is of the earlier ones.
            if seen.contains(&target.layer) {
                continue;
            }
            seen.push(target.layer);
            let start = pass.recorded.as_ref().and_then(|recorded| recorded.start.as_ref()?.depth.as_ref());
            let [width, height] = self.plan.attachments.get(map.attachment.0)?.size.map(u64::from);
            let left = match (start, target.clear_depth) {
                (Some(start), _) => start.data().iter().filter(|depth| **depth != clear).count() as u64,
                (None, Some(depth)) if depth != clear => width * height,
                _ => 0,
            };
            if left == 0 {
                continue;
            }
            texels += left;
            let pass = &mut fixed.passes[index];
            pass.recorded.iter_mut().for_each(|recorded| recorded.start = None);
            pass.depth_stencil.iter_mut().for_each(|target| target.clear_depth = Some(clear));
        }
        if texels == 0 {
            return None;
        }
        let sentence = format!("{} texels held a depth before the first draw into the map", numbers::count(texels));
        let texels = Quantity::at_least("texels that held a depth before the first draw", texels as f64, 1.0);
        Some(FrameFinding { evidence: Evidence::of_frame(sentence, texels), fixed })
    }

    /// Returns how many pixels a texel of the map spans at the outline of its shadows, as the median there.
    fn coarse(&self) -> Option<FrameFinding> {
        /// A finer texel shows in no outline.
        const LEAST_PIXELS: f64 = 0.25;
        self.map()?;
        let projection = MapProjection::recorded(self.capture, self.light.0)?;
        let labels = self.capture.lights.get(self.light.0)?.shadow.as_ref()?;
        let frame = self.capture.frame_at(self.capture.steps.len().checked_sub(1)?)?;
        let pixels = PixelUnprojection::new(self.capture);
        let texel = |at: [u32; 2]| {
            let world = pixels.at(at, frame.depth.image.depth_at(at)?)?;
            let (face, clip) = projection.place(world, DVec3::Y)?;
            Some((face, projection.texel(clip)))
        };
        let [width, height] = self.capture.size;
        let is_outline = |at: &[u32; 2]| {
            let [one, other] = [[at[0] - 1, at[1]], *at].map(|at| labels.byte_at(at));
            matches!((one, other), (Some(LIT), Some(SHADOW)) | (Some(SHADOW), Some(LIT)))
        };
        let outline = (0..height).flat_map(|y| (1..width).map(move |x| [x, y])).filter(is_outline);
        let span = |at: [u32; 2]| {
            let ([face, other], [one, next]) = {
                let (first, second) = (texel([at[0] - 1, at[1]])?, texel(at)?);
                ([first.0, second.0], [first.1, second.1])
            };
            let apart = DVec2::distance(one, next);
            (face == other && apart > 0.0).then(|| 1.0 / apart)
        };
        let mut spans: Vec<f64> = outline.filter_map(span).collect();
        spans.sort_by(f64::total_cmp);
        let median = *spans.get(spans.len() / 2)?;
        let mut fixed = self.plan.clone();
        if !self.enlarge(&mut fixed, 4.0) {
            return None;
        }
        let sentence = format!("at the outline of shadows a texel of the map spans {} pixels", numbers::digits(median));
        let span = Quantity::at_least("pixels that a texel spans at outlines", median, LEAST_PIXELS);
        Some(FrameFinding { evidence: Evidence::of_frame(sentence, span), fixed })
    }
}

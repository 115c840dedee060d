//! Faults of where volumes are counted from, and of volumes that are not closed.

use crate::diagnosis::cause::Cause;
use crate::diagnosis::evidence::Quantity;
use crate::diagnosis::facts::{CauseRule, FrameFacts, PixelSample, RegionSamples, SuspectedCause, amount, listed};
use crate::diagnosis::fix::{Fix, PlanEdit};
use crate::geometry::{Extruder, Extrusion, ViewVolume};
use crate::history::FragmentOutcome;
use crate::math::{AxisBox, Sign, side_of_triangle};
use crate::numbers;
use crate::plan::{ClipPlane, Decision, Draw, DrawPart, Pass};
use crate::technique::Technique;
use glam::{DVec3, DVec4};
use std::collections::BTreeSet;

pub(crate) const RULES: &[CauseRule] = &[
    eye_in_volume,
    near_plane_cut,
    near_plane_crack,
    missing_dark_cap,
    missing_light_cap,
    far_clip,
    light_not_added,
    carried_in_f32,
    finite_extrusion,
    cap_fighting,
];

/// Returns whether counting begins with the same number at all pixels: only with z-pass and z-pass-plus, and only where
/// the light has no pass that counts at the near plane.
fn begins_with_one_number(facts: &FrameFacts, light: usize) -> bool {
    let has_near_count = facts.passes(light).any(Pass::counts_at_near_plane);
    matches!(facts.technique(), Technique::ZPass | Technique::ZPassPlus) && !has_near_count
}

/// Returns whether that number is the count of volumes around the eye, by the setting `start`.
fn starts_at_eye(facts: &FrameFacts) -> bool {
    facts.volumes().is_some_and(|settings| settings.starts_at_eye)
}

/// Returns the fix that draws missing caps: the setting `caps` with these where it leaves them out, and no others, so that
/// it proves these alone; else the given edit of the plan. `light_or_dark` is 0 for light caps, 1 for dark caps.
fn draw_caps(facts: &FrameFacts, light_or_dark: usize, edit: PlanEdit) -> Fix {
    let Some(mut caps) = facts.volumes().map(|settings| settings.caps).filter(|caps| !caps[light_or_dark]) else {
        return Fix::plan(edit);
    };
    caps[light_or_dark] = true;
    match caps {
        [true, true] => Fix::setting("caps", "both"),
        [true, false] => Fix::setting("caps", "light"),
        [false, _] => Fix::setting("caps", "dark"),
    }
}

/// Returns the names of the casters that have casting triangles between a light and a world-space point, and the number
/// of those triangles: the volumes that contain the point.
fn holding(facts: &FrameFacts, light: usize, point: DVec3) -> (BTreeSet<String>, u64) {
    let mut hits = facts.tracer.between_points(light, point);
    hits.retain(|hit| facts.casts(light, hit));
    (facts.names(&hits), hits.len() as u64)
}

fn eye_in_volume(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let light = case.light();
    // Parallel view rays begin at the near plane, each in volumes of its own.
    let has_eye = !facts.scene.camera.is_parallel();
    if !has_eye || !begins_with_one_number(facts, light) || starts_at_eye(facts) {
        return None;
    }
    let (eye_in, volumes) = holding(facts, light, facts.scene.camera.eye);
    let (missed, shown_by) = case.shown(|sample| {
        let (near_in, _) = holding(facts, light, facts.tracer.near_point(sample.center()));
        missed_by_z_pass(facts, light, sample, |name| near_in.contains(name) && eye_in.contains(name))
    })?;
    let sentence = format!(
        "the eye is inside {} of {} ({}), which z-pass does not count",
        amount(volumes, "shadow volume"),
        numbers::light(light),
        listed(&eye_in)
    );
    let quantities = [
        Quantity::at_least("volumes that contain the eye", volumes as f64, 1.0),
        Quantity::at_least("volumes around the near plane that the count misses", missed.into(), 1.0),
    ];
    let evidence = case.evidence(sentence, shown_by, quantities);
    Some(SuspectedCause::new(Cause::EyeInVolume, evidence, vec![Fix::technique(Technique::ZFail)]))
}

fn near_plane_cut(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let light = case.light();
    if !begins_with_one_number(facts, light) {
        return None;
    }
    let camera = &facts.scene.camera;
    let (eye_in, start) = holding(facts, light, camera.counting_place());
    if starts_at_eye(facts) {
        let (count, shown_by) = case.shown(|sample| {
            let (_, count) = holding(facts, light, facts.tracer.near_point(sample.center()));
            (count != start).then_some(count)
        })?;
        let sentence = format!(
            "the count begins with {} around {}, and the near plane, {} ahead, is in {count} here",
            amount(start, "shadow volume"),
            camera.counting_place_name(),
            numbers::metres(facts.scene.camera.near),
        );
        let apart =
            Quantity::at_least("volumes by which the count begins beside its place", count.abs_diff(start) as f64, 1.0);
        let evidence = case.evidence(sentence, shown_by, [apart]);
        return Some(SuspectedCause::new(Cause::NearPlaneCut, evidence, vec![Fix::technique(Technique::ZFail)]));
    }
    let is_of_eye = |near_in: &BTreeSet<String>| {
        !facts.scene.camera.is_parallel() && near_in.intersection(&eye_in).next().is_some()
    };
    let ((near_in, count, missed), shown_by) = case.shown(|sample| {
        let (near_in, count) = holding(facts, light, facts.tracer.near_point(sample.center()));
        let missed = missed_by_z_pass(facts, light, sample, |name| near_in.contains(name))?;
        (count > 0 && !is_of_eye(&near_in)).then_some((near_in, count, missed))
    })?;
    let meeting = meeting_near_clip(facts, light);
    let sentence = format!(
        "the near plane, {} ahead, cuts {} of {} open here: {} of the {} that meet the space between near plane and light",
        numbers::metres(facts.scene.camera.near),
        amount(count, "shadow volume"),
        listed(&near_in),
        near_in.len(),
        amount(meeting.len() as u64, "caster"),
    );
    let quantities = [
        Quantity::at_least("volumes that contain the near plane here", count as f64, 1.0),
        Quantity::at_least("volumes around the near plane that the count misses", missed.into(), 1.0),
    ];
    let evidence = case.evidence(sentence, shown_by, quantities);
    Some(SuspectedCause::new(Cause::NearPlaneCut, evidence, vec![Fix::technique(Technique::ZFail)]))
}

/// Returns by how many volumes the count at a sample differs from the truth, of the casters that `is_meant` names;
/// `None` where it does not.
fn missed_by_z_pass(
    facts: &FrameFacts,
    light: usize,
    sample: &PixelSample,
    is_meant: impl Fn(&String) -> bool,
) -> Option<u32> {
    let miscounted = sample.miscounted(facts, light).into_iter().filter(|(name, ..)| is_meant(name));
    let missed: u32 = miscounted.map(|(_, counted, expected)| counted.abs_diff(expected)).sum();
    (missed > 0).then_some(missed)
}

/// Returns the names of casting objects whose vertices are not all outside one plane of the light's near-clip volume:
/// those that may reach into it.
fn meeting_near_clip(facts: &FrameFacts, light: usize) -> Vec<String> {
    let camera = &facts.scene.camera;
    let position = facts.tracer.light_position(light);
    let relative = (position.truncate() - camera.eye * position.w).extend(position.w);
    let near_clip = ViewVolume::new(camera, camera.aspect_in(facts.plan.size)).near_clip(relative);
    let casting = facts.scene.objects.iter().filter(|object| object.casts);
    let meets = casting.filter(|object| {
        let points: Vec<DVec4> =
            object.world_positions().iter().map(|point| (*point - camera.eye).extend(1.0)).collect();
        near_clip.outside(&points).is_none()
    });
    meets.map(|object| object.name.clone()).collect()
}

fn near_plane_crack(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let light = case.light();
    if facts.technique() != Technique::ZPassPlus || begins_with_one_number(facts, light) {
        return None;
    }
    let near = facts.scene.camera.near;
    let crossing = meeting_near_clip(facts, light).into_iter().filter_map(|name| {
        let (_, object) = facts.object(&name)?;
        let depths: Vec<f64> = object.world_positions().iter().map(|point| facts.tracer.depth_of(*point)).collect();
        let (low, high) =
            depths.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (low.min(*d), high.max(*d)));
        (low < near && near < high).then_some((name, low, high))
    });
    let crossing: Vec<(String, f64, f64)> = crossing.collect();
    let ((name, low, high), shown_by) = case.shown(|sample| {
        let wrong = sample.miscounted(facts, light);
        crossing.iter().find(|(name, ..)| wrong.iter().any(|(miscounted, ..)| miscounted == name))
    })?;
    let sentence = format!(
        "{name} reaches from {} to {} along the view and crosses the near plane at {}, where the light's picture and \
         the camera's are cut and round apart",
        numbers::metres(*low),
        numbers::metres(*high),
        numbers::metres(near)
    );
    let quantities = [
        Quantity::less_than("where the caster begins along the view, in metres", *low, near),
        Quantity::more_than("where the caster ends along the view, in metres", *high, near),
    ];
    let evidence = case.evidence(sentence, shown_by, quantities);
    Some(SuspectedCause::new(Cause::NearPlaneCrack, evidence, vec![Fix::technique(Technique::ZFail)]))
}

/// Returns the draws of a part of a caster's volume.
fn part_of<'f>(facts: &'f FrameFacts, light: usize, caster: &'f str, part: DrawPart) -> impl Iterator<Item = &'f Draw> {
    facts.draws(light, part).filter(move |draw| draw.caster.as_deref() == Some(caster) && !draw.triangles.is_empty())
}

/// Returns whether the plan records why a caster goes without a cap.
fn is_excused(facts: &FrameFacts, caster: &str, decision: Decision) -> bool {
    facts.plan.left_out.iter().any(|left| left.is(decision, caster) || left.is(Decision::Caps, caster))
}

/// Returns the first miscounted caster for which `lacks` is true (name, counted, expected), and how many samples have
/// such a caster; `None` where none has.
fn lacking(
    facts: &FrameFacts,
    case: &RegionSamples,
    lacks: impl Fn(&str) -> bool,
) -> Option<((String, i32, i32), usize)> {
    case.shown(|sample: &PixelSample| {
        sample.miscounted(facts, case.light()).into_iter().find(|(caster, ..)| lacks(caster))
    })
}

fn missing_dark_cap(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let light = case.light();
    let is_finite = facts.volumes().is_some_and(|settings| settings.extrusion != Extrusion::Infinite);
    let is_point = facts.tracer.light_position(light).w != 0.0;
    let lacks = |caster: &str| {
        let needs = is_finite || (is_point && facts.counts_behind(light, caster));
        needs
            && part_of(facts, light, caster, DrawPart::Side).next().is_some()
            && part_of(facts, light, caster, DrawPart::DarkCap).next().is_none()
            && !is_excused(facts, caster, Decision::DarkCap)
    };
    let ((caster, counted, expected), shown_by) = lacking(facts, case, lacks)?;
    let sentence = format!(
        "the volume of {caster} has no dark cap in this frame, and z-fail needs one: it counts {} here where \
         {} between light and surface",
        numbers::whole(counted.into()),
        lie(expected)
    );
    let evidence = case.evidence(sentence, shown_by, [miscount(counted, expected)]);
    let fixes = vec![draw_caps(facts, 1, PlanEdit::DrawDarkCaps)];
    Some(SuspectedCause::new(Cause::MissingDarkCap, evidence, fixes))
}

fn missing_light_cap(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let light = case.light();
    let needs = |caster: &str| {
        let is_drawn = facts.object(caster).is_none_or(|(_, object)| object.visible);
        facts.counts_behind(light, caster) || !is_drawn
    };
    let lacks = |caster: &str| {
        needs(caster)
            && part_of(facts, light, caster, DrawPart::Side).next().is_some()
            && part_of(facts, light, caster, DrawPart::LightCap).next().is_none()
            && !is_excused(facts, caster, Decision::LightCap)
    };
    if let Some(((caster, counted, expected), shown_by)) = lacking(facts, case, lacks) {
        let sentence = format!(
            "the volume of {caster} has no light cap in this frame, and z-fail needs one: it counts {} here \
             where {} between light and surface",
            numbers::whole(counted.into()),
            lie(expected)
        );
        let evidence = case.evidence(sentence, shown_by, [miscount(counted, expected)]);
        let fixes = vec![draw_caps(facts, 0, PlanEdit::DrawLightCaps)];
        return Some(SuspectedCause::new(Cause::MissingLightCap, evidence, fixes));
    }
    let is_untested = |caster: &str| {
        let never = wgpu_types::CompareFunction::Never;
        part_of(facts, light, caster, DrawPart::LightCap).any(|draw| draw.raster.depth_compare == never)
    };
    let ((caster, counted, expected), shown_by) = lacking(facts, case, is_untested)?;
    let sentence = format!(
        "the light cap of {caster} is drawn but never passes the depth test, though it is in front of the surface \
         here: it counts {} where {} between",
        numbers::whole(counted.into()),
        lie(expected)
    );
    let evidence = case.evidence(sentence, shown_by, [miscount(counted, expected)]);
    let fixes = vec![Fix::setting("light-caps", "tested")];
    Some(SuspectedCause::new(Cause::MissingLightCap, evidence, fixes))
}

/// Returns by how much a caster's count is off, which must be something.
fn miscount(counted: i32, expected: i32) -> Quantity {
    Quantity::at_least("how far the count of the caster's volume is off", counted.abs_diff(expected).into(), 1.0)
}

/// Returns the end of a sentence about `count` triangles, with its verb: `none of its triangles lies`, `1 of its
/// triangles lies`, `2 of its triangles lie`.
fn lie(count: i32) -> String {
    match count {
        0 => "none of its triangles lies".to_owned(),
        1 => "1 of its triangles lies".to_owned(),
        count => format!("{count} of its triangles lie"),
    }
}

fn far_clip(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let light = case.light();
    let mapping = facts.plan.depth.mapping;
    if mapping.is_reversed() {
        return None;
    }
    let far = facts.plan.depth.far;
    if mapping.clamps() {
        return beyond_clamped(facts, case, far?);
    }
    let ((what, count), shown_by) = case.shown(|sample| {
        let is_clipped = |outcome: FragmentOutcome| outcome == FragmentOutcome::Clipped(ClipPlane::Far);
        let faces = sample.volume_events(light).filter(|(_, one)| is_clipped(one.outcome)).count();
        let is_beyond = sample.seen.zip(far).is_some_and(|(seen, far)| facts.tracer.depth_of(seen.point) >= far);
        match (faces, is_beyond) {
            (_, true) => Some(("the surface itself lies".to_owned(), 1)),
            (1.., _) if !sample.miscounted(facts, light).is_empty() => Some((
                format!(
                    "{} over this pixel {}",
                    amount(faces as u64, "volume face"),
                    if faces == 1 { "lies" } else { "lie" }
                ),
                faces,
            )),
            _ => None,
        }
    })?;
    let place = far.map_or_else(|| "at infinity".to_owned(), |far| format!("{} away", numbers::metres(far)));
    let sentence =
        format!("{what} beyond the far plane, {place}, and {} cut away", if count == 1 { "is" } else { "are" });
    let fixes = vec![Fix::setting("depth", "reversed-infinite"), Fix::setting("depth", "standard-finite-clamp")];
    let cut = Quantity::at_least("faces or surfaces that the far plane cuts away here", count as f64, 1.0);
    Some(SuspectedCause::new(Cause::FarClip, case.evidence(sentence, shown_by, [cut]), fixes))
}

/// Looks for surfaces at or beyond the far plane (`far` metres along the view's axis) under clamped depth, which get
/// the depth of the background. `None` where no sample shows one.
fn beyond_clamped(facts: &FrameFacts, case: &RegionSamples, far: f64) -> Option<SuspectedCause> {
    let (distance, shown_by) = case.shown(|sample| {
        let distance = facts.tracer.depth_of(sample.seen?.point);
        (distance >= far).then_some(distance)
    })?;
    let sentence = format!(
        "the surface lies {} away, beyond the far plane at {}, where clamped depth is that of nothing and nothing is \
         drawn",
        numbers::metres(distance),
        numbers::metres(far)
    );
    let beyond = Quantity::at_least("the distance of the surface along the view, in metres", distance, far);
    let evidence = case.evidence(sentence, shown_by, [beyond]);
    Some(SuspectedCause::new(Cause::FarClip, evidence, vec![Fix::setting("depth", "reversed-infinite")]))
}

/// How much nearer the middle of a volume's flat end may be than its corners are carried.
const FLAT_END: f64 = 1.02;

fn finite_extrusion(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let light = case.light();
    // For a light that is not added back: as far as its volumes would reach if it were.
    let (Extrusion::Finite(factor) | Extrusion::FromOrigin(factor)) = facts.volumes()?.extrusion else { return None };
    if !case.is_missing() {
        return None;
    }
    let ((caster, reach, needed), shown_by) = case.shown(|sample| {
        let seen = sample.seen?;
        let distance = facts.tracer.light_distance(light, seen.point);
        let mut casting = sample.between.iter().filter(|hit| facts.casts(light, hit)).peekable();
        casting.peek()?;
        // How far the volume continues behind the caster, and how far it would have to.
        let reaches = casting.map(|hit| {
            let caster = facts.tracer.name(hit.place);
            let reach = match distance.is_finite() {
                true => factor * (distance - hit.towards_light),
                false => factor * size_of(facts, caster),
            };
            (caster.to_owned(), reach, hit.towards_light)
        });
        let best = reaches.max_by(|a, b| (a.1 / a.2).total_cmp(&(b.1 / b.2)))?;
        // The end is flat, so its middle may be nearer than the corners are carried.
        (best.1 < best.2 * FLAT_END).then_some(best)
    })?;
    let sentence = format!(
        "the volume of {caster} goes on for {} behind it, and the surface lies {} behind it",
        numbers::metres(reach),
        numbers::metres(needed)
    );
    let short =
        Quantity::less_than("how far the volume goes on behind its caster, in metres", reach, needed * FLAT_END);
    let evidence = case.evidence(sentence, shown_by, [short]);
    Some(SuspectedCause::new(Cause::FiniteExtrusion, evidence, vec![Fix::setting("extrusion", "infinite")]))
}

/// Single-precision errors in a volume that a vertex shader extrudes.
struct ExtrusionInF32 {
    /// Number of triangles that the shader takes to face the wrong way.
    misfaced: usize,
    triangles: usize,
    /// The largest angle between a vertex's computed and exact extrusion direction, radians.
    beside: f64,
}

impl ExtrusionInF32 {
    /// Measures the errors of extruding a caster's volume in single precision in the vertex shader; `None` where the
    /// CPU extrudes it, or no side of it is drawn.
    fn of(facts: &FrameFacts, light: usize, caster: &str) -> Option<ExtrusionInF32> {
        let draw = part_of(facts, light, caster, DrawPart::Side).next()?;
        let extruded = facts.plan.meshes.get(draw.mesh.0)?.extruded.as_ref()?;
        let (_, object) = facts.object(caster)?;
        let (position, world) = (facts.tracer.light_position(light), object.world_positions());
        let extruder = Extruder::new(&world, position, facts.volumes()?.extrusion);
        let origin = facts.plan.views.first()?.origin;
        let triangles = object.mesh.triangles();
        // Each triangle has a front, or a front and a back.
        let copies = if extruded.corners.len() == triangles.len() * 3 { 3 } else { 6 };
        let mut carried = ExtrusionInF32 { misfaced: 0, triangles: triangles.len(), beside: 0.0 };
        for (triangle, corners) in triangles.iter().zip(extruded.corners.data().chunks_exact(copies)) {
            let places = triangle.map(|vertex| world[vertex as usize]);
            // A triangle whose back alone casts has no plane in its front's corners.
            let is_back = corners[0].plane == [0.0; 4];
            let (at, casts) = if is_back { (copies - 1, Sign::Negative) } else { (0, Sign::Positive) };
            let stays = side_of_triangle(places, position) == casts;
            carried.misfaced += usize::from(stays == extruded.carry.carries(corners[at].plane));
            for (place, corner) in places.into_iter().zip(corners) {
                let far = extruder.carry(place);
                let way = far.truncate() - place * far.w;
                let [x, y, z, w] = extruded.carry.far(corner.near).map(f64::from);
                let rounded = DVec3::new(x, y, z) + origin * w - place * w;
                carried.beside = carried.beside.max(way.cross(rounded).length().atan2(way.dot(rounded)));
            }
        }
        Some(carried)
    }
}

fn carried_in_f32(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let light = case.light();
    facts.volumes().filter(|settings| settings.by_vertex_shader)?;
    let (found, shown_by) = case.shown(|sample| {
        let miscounted = sample.miscounted(facts, light).into_iter();
        // A smaller deviation of the direction moves no edge by a pixel.
        let is_off = |of: &ExtrusionInF32| of.misfaced > 0 || of.beside > facts.pixel_angle() / 2.0;
        let carried = |caster: String| Some((ExtrusionInF32::of(facts, light, &caster).filter(is_off)?, caster));
        miscounted.map(|(caster, ..)| caster).find_map(carried)
    })?;
    let (ExtrusionInF32 { misfaced, triangles, beside }, caster) = found;
    let faces = match misfaced {
        0 => "each triangle is found to face as it does".to_owned(),
        1 => format!("1 of {} is found to face the wrong way", amount(triangles as u64, "triangle")),
        _ => format!("{misfaced} of {} are found to face the wrong way", amount(triangles as u64, "triangle")),
    };
    let sentence = format!(
        "the volume of {caster} is carried by a vertex shader, in single precision: {faces}, and a vertex goes up to {} \
         radians beside its way",
        numbers::digits(beside)
    );
    let off = match misfaced {
        0 => Quantity::more_than(
            "the angle by which a vertex goes beside its way, radians",
            beside,
            facts.pixel_angle() / 2.0,
        ),
        _ => Quantity::at_least("triangles that are found to face the wrong way", misfaced as f64, 1.0),
    };
    let evidence = case.evidence(sentence, shown_by, [off]);
    Some(SuspectedCause::new(Cause::CarriedInF32, evidence, vec![Fix::setting("extruded-by", "cpu")]))
}

fn light_not_added(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let Extrusion::FromOrigin(factor) = facts.volumes()?.extrusion else { return None };
    let position = facts.tracer.light_position(case.light());
    if position.w == 0.0 {
        return None;
    }
    let light = position.truncate() / position.w;
    let ((caster, width), shown_by) = case.shown(|sample| {
        let (caster, ..) = sample.miscounted(facts, case.light()).into_iter().next()?;
        Some((caster, facts.pixel_width(facts.tracer.depth_of(sample.seen?.point))))
    })?;
    let sentence = format!(
        "far vertices of {caster} are {} times the way from the light, from the world's origin on: they lie {} from \
         their place, as far as the light lies from the origin",
        numbers::digits(factor + 1.0),
        numbers::metres(light.length())
    );
    // What moves far vertices by less than a pixel leaves every pixel as it is.
    let away = Quantity::at_least("how far far vertices lie from their place, in metres", light.length(), width);
    let evidence = case.evidence(sentence, shown_by, [away]);
    Some(SuspectedCause::new(Cause::LightNotAdded, evidence, vec![Fix::setting("far-vertices", "from-light")]))
}

/// Returns the length in metres of the diagonal of an object's bounding box.
fn size_of(facts: &FrameFacts, name: &str) -> f64 {
    let Some((_, object)) = facts.object(name) else { return 0.0 };
    AxisBox::around(object.world_positions()).diagonal()
}

/// How far the corners of a cap may lie from the plane of the surface that it is, as a part of their distance from the
/// eye.
const SAME_PLANE: f64 = 1e-5;

fn cap_fighting(facts: &FrameFacts, case: &RegionSamples) -> Option<SuspectedCause> {
    let light = case.light();
    let is_clipped = facts.drawn.meshes.len() > facts.plan.meshes.len();
    let ((caster, cap, surface), shown_by) = case.shown(|sample| {
        let history = sample.history.as_ref()?;
        let bits = |one: &crate::history::TriangleEvent| {
            let mut bits = one.corners.map(|corner| corner.map(f32::to_bits));
            bits.sort_unstable();
            bits
        };
        // What is clipped beforehand is cut into other triangles when it begins with another corner.
        let is_same = |cap: &crate::history::TriangleEvent, surface: &crate::history::TriangleEvent| {
            if bits(cap) == bits(surface) {
                return true;
            }
            let [a, b, c] = surface.corners.map(|corner| DVec3::from_slice(&corner.map(f64::from)));
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let off = |corner: [f32; 4]| {
                let corner = DVec3::from_slice(&corner.map(f64::from));
                normal.dot(corner - a).abs() / corner.length()
            };
            let is_near = cap.corners.iter().all(|corner| corner[3] != 0.0 && off(*corner) <= SAME_PLANE);
            is_clipped && normal != DVec3::ZERO && cap.caster == surface.caster && is_near
        };
        let visible = history.triangles().filter(|(event, one)| event.light.is_none() && one.part == DrawPart::Surface);
        let visible: Vec<_> = visible.filter(|(_, one)| one.outcome.passed()).map(|(_, one)| one).collect();
        let visible = visible.last()?;
        let mut caps = sample.volume_events(light).filter(|(_, one)| one.part.includes(DrawPart::LightCap));
        let (event, cap) = caps.find(|(_, one)| is_same(one, visible))?;
        let differs = cap.depth.to_bits() != event.before.depth.to_bits();
        differs.then(|| (cap.caster.clone().unwrap_or_default(), cap.depth, event.before.depth))
    })?;
    let steps = (i64::from(cap.to_bits()) - i64::from(surface.to_bits())).unsigned_abs();
    let sentence = format!(
        "the light cap of {caster} is the very triangle that is seen, but its depth is {} here and the surface's {}: \
         {} apart",
        numbers::depth(cap),
        numbers::depth(surface),
        amount(steps, "step")
    );
    let apart = Quantity::at_least("steps of depth between the cap and the surface that it is", steps as f64, 1.0);
    let evidence = case.evidence(sentence, shown_by, [apart]);
    Some(SuspectedCause::new(Cause::CapFighting, evidence, vec![Fix::plan(PlanEdit::SurfaceOrder)]))
}

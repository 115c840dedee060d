//! The Explain tab's cards, compared with the plan's draws and what the GPU left.

mod formulas;
mod lines;

use super::SeenPatterns;
use super::frames::Frame;
use super::patterns::{all_but, find, gaps, is_near, is_number, mask_of, matching, number};
use super::purposes::steps;
use crate::common::stencil;
use formulas::FORMULAS;
use lines::LINES;
use stencilscope::history::{PixelEventKind, PixelHistory};
use stencilscope::math::depth::DepthMapping;
use stencilscope::plan::{CountOf, CountedSide, DecidedBy, DrawPart, Program, Visibility};
use stencilscope::reading::explain_facts::{ExplainContext, facts};
use stencilscope::reading::map_decision::MapDecision;
use stencilscope::scene::Projection;
use stencilscope::technique::VolumeSettings;
use wgpu::CompareFunction;

/// A card, and what it is about.
struct Here<'a> {
    frame: &'a Frame,
    step: usize,
    pick: Option<[u32; 2]>,
    history: Option<&'a PixelHistory>,
    map: Option<&'a MapDecision>,
    /// Its formula.
    formula: &'a str,
}

type Check = fn(&Here, &[&str]) -> bool;

impl Here<'_> {
    fn light(&self) -> usize {
        self.frame.step(self.step).1.light.expect("a light").0
    }

    fn decided_by(&self) -> DecidedBy {
        self.frame.plan.lights[self.light()].decided_by
    }

    fn draws(&self, part: DrawPart) -> impl Iterator<Item = &stencilscope::plan::Draw> {
        self.frame.step(self.step).1.draws.iter().filter(move |draw| draw.part == part)
    }

    /// For each volume that is extruded by its vertex shader: the number of triangles of its caster, of copies of each
    /// triangle, and of triangles of the volume's sides. Zeros for any other volume.
    fn copies_and_sides(&self) -> impl Iterator<Item = (usize, usize, usize)> {
        self.draws(DrawPart::Side).map(|draw| {
            let caster = self.frame.scene.objects.iter().find(|object| draw.caster.as_ref() == Some(&object.name));
            let triangles = caster.map_or(0, |object| object.mesh.triangles().len());
            let corners = self.frame.plan.meshes[draw.mesh.0].extruded.as_ref().map_or(0, |of| of.corners.len());
            (triangles, corners / (3 * triangles.max(1)), draw.triangles.len())
        })
    }

    fn is_of_sun(&self) -> bool {
        self.frame.capture.lights[self.light()].position.w == 0.0
    }

    fn volumes(&self) -> VolumeSettings {
        VolumeSettings::read(&self.frame.capture.settings)
    }

    /// Is it said of some volumes that they end before infinity? So it should be where one of this light does that is
    /// not asked to, and nowhere where none of the frame does.
    fn ends_as_reported(&self, text: &str) -> bool {
        let ends = |draw: &stencilscope::plan::Draw| {
            draw.part == DrawPart::Side
                && self.frame.plan.meshes[draw.mesh.0].vertices.data().iter().all(|[.., w]| *w != 0.0)
        };
        let mut of_frame = self.frame.plan.passes.iter().flat_map(|pass| &pass.draws);
        match text {
            "" => !self.draws(DrawPart::Side).any(ends),
            "; a volume that ends sooner, beyond the last surface in view, is counted in front and open at that end" => {
                of_frame.any(ends)
            }
            _ => false,
        }
    }

    fn triangles(&self, part: DrawPart) -> f64 {
        self.draws(part).map(|draw| f64::from(draw.triangles.end - draw.triangles.start)).sum()
    }

    /// Sides that count, and no others, are on this side, and the first adds where its outside is seen.
    fn counts(&self, side: CountedSide) -> bool {
        let is_in_front = side == CountedSide::InFront;
        let mut sides = self.draws(DrawPart::Side).filter_map(steps).peekable();
        sides.peek().is_none()
            || sides.all(|one| {
                let (up, down) = if is_in_front { (one.outside, one.inside) } else { (one.inside, one.outside) };
                one.is_in_front == is_in_front && up >= 0 && down <= 0 && up != down
            })
    }

    /// All bytes of the stencil after this step.
    fn bytes(&self) -> Vec<u8> {
        stencil(self.frame.capture.frame_at(self.step).expect("a frame"))
    }

    /// All counts after this step.
    fn all_counts(&self) -> Vec<f32> {
        if !self.decided_by().counts_in_floats() {
            return self.bytes().into_iter().map(f32::from).collect();
        }
        let count = self.frame.capture.lights[self.light()].count.as_ref().expect("a count");
        count.rows().flat_map(bytemuck::pod_collect_to_vec::<u8, f32>).collect()
    }

    /// What the GPU stored as the picked pixel's count after this step.
    fn stored(&self, at: [u32; 2]) -> f32 {
        if self.decided_by().counts_in_floats() {
            self.frame.capture.lights[self.light()]
                .count
                .as_ref()
                .and_then(|count| count.value_at(at))
                .expect("a count")
        } else {
            self.frame.stencil(Some(self.step), at).expect("a stencil").into()
        }
    }

    /// What it was before this step's draws.
    fn before(&self, at: [u32; 2]) -> f32 {
        let pass = self.frame.step(self.step).1;
        let cleared = pass.depth_stencil.as_ref().and_then(|target| target.clear_stencil);
        if self.decided_by().counts_in_floats() {
            return pass.color.as_ref().and_then(|target| target.clear).map_or(0.0, |clear| clear[0] as f32);
        }
        cleared.or_else(|| self.frame.stencil(self.step.checked_sub(1), at)).expect("a stencil").into()
    }

    /// The stored depth after this step.
    fn depth(&self, at: [u32; 2]) -> Option<f32> {
        self.frame.capture.frame_at(self.step)?.depth.image.depth_at(at)
    }

    /// The stencil before this step.
    fn stencil_before(&self, at: [u32; 2]) -> u8 {
        self.frame.stencil(self.step.checked_sub(1), at).expect("a stencil")
    }

    /// The stored depth where nothing is.
    fn clear_depth(&self) -> f32 {
        if self.frame.plan.depth.mapping == DepthMapping::ReversedInfinite { 0.0 } else { 1.0 }
    }

    /// Is this number the count of triangles that this step draws of the part?
    fn has_drawn(&self, part: DrawPart, text: &str) -> bool {
        number(text) == self.triangles(part)
    }

    fn volume_passes_follow(&self) -> bool {
        let is_one = |pass: &stencilscope::plan::Pass| {
            pass.light.is_some_and(|light| light.0 == self.light())
                && pass.draws.iter().any(|draw| draw.part.is_of_volume())
        };
        self.frame.plan.passes[self.step + 1..].iter().any(is_one)
    }
}

fn at(x: &str, y: &str) -> [u32; 2] {
    [x, y].map(|text| text.parse().expect("a coordinate"))
}

fn is_count_of(here: &Here, of: CountOf) -> bool {
    let light = here.light();
    // Closed, as far as every edge is shared by an even number of triangles.
    let is_closed = |object: &stencilscope::scene::Object| {
        let place = |v: u32| object.mesh.positions()[v as usize].to_array().map(f64::to_bits);
        let mut edges = std::collections::HashMap::new();
        for corners in object.mesh.triangles() {
            for side in 0..3 {
                let mut ends = [place(corners[side]), place(corners[(side + 1) % 3])];
                ends.sort_unstable();
                *edges.entry(ends).or_insert(0) += 1;
            }
        }
        edges.values().all(|count| count % 2 == 0)
    };
    let names: Vec<&str> = (here.frame.plan.passes.iter())
        .filter(|pass| pass.light.is_some_and(|own| own.0 == light))
        .flat_map(|pass| &pass.draws)
        .filter(|draw| draw.part.is_of_volume())
        .filter_map(|draw| draw.caster.as_deref())
        .collect();
    let cast = || here.frame.scene.objects.iter().filter(|object| names.contains(&object.name.as_str()));
    let is_reported = here.frame.capture.lights[light].count_of == Some(of);
    let by_hand = here.frame.capture.settings.get("casters").is_some_and(|casters| casters != "by-topology");
    match of {
        // An open caster that nothing lies behind is let be: it is a quad.
        CountOf::Bodies => {
            is_reported
                && !by_hand
                && cast().all(|object| is_closed(object) || object.mesh.triangles().len() <= 2)
                && cast().any(is_closed)
        }
        CountOf::Surfaces => is_reported,
        CountOf::Mixed => is_reported && !by_hand && cast().any(is_closed),
    }
}

/// Are these the faces of a pass at a pixel, those that add and those that take away, and is their sum the stored
/// count?
fn adds_up(here: &Here, parts: &[&str], modulus: f64) -> bool {
    let at = at(parts[0], parts[1]);
    let sum = number(parts[7]);
    let change = f64::from(here.stored(at) - here.before(at));
    let in_floats = here.decided_by().counts_in_floats();
    let near = if in_floats && sum != change { near_count(here, at) } else { 0.0 };
    let stored = if in_floats { sum == change - near } else { (sum - change).rem_euclid(modulus) == 0.0 };
    // What a first pass of floats leaves is not stored.
    faces_add_up(here, parts) && (stored || (in_floats && here.volume_passes_follow()))
}

/// Are these the picked pixel's faces, and their sum?
fn faces_add_up(here: &Here, parts: &[&str]) -> bool {
    let [up, down, idle, up_again, down_again, sum] = [2, 3, 4, 5, 6, 7].map(|gap| number(parts[gap]));
    let history = here.history.expect("a history");
    // Triangle by triangle, as the machine of the history took them; and in the end as the GPU stored it.
    let (mut ups, mut downs, mut rest) = (0.0, 0.0, 0.0);
    for event in history.events.iter().filter(|event| event.pass == here.step) {
        match &event.kind {
            PixelEventKind::Triangle(one) if one.part.is_of_volume() => {
                *match event.counted() {
                    0 => &mut rest,
                    1.. => &mut ups,
                    _ => &mut downs,
                } += 1.0
            }
            _ => {}
        }
    }
    (up, down, idle) == (ups, downs, rest) && (up, down) == (up_again, down_again) && sum == up - down
}

fn asks_stencil(here: &Here, bits: u8) -> bool {
    here.frame.step(here.step).1.draws.iter().filter(|draw| draw.raster.stencil.is_enabled()).all(|draw| {
        let (face, masks) = draw.raster.face(true);
        face.compare == CompareFunction::Equal && masks.read == bits && masks.reference == 0
    })
}

fn pick_is_missing(here: &Here, _: &[&str]) -> bool {
    here.pick.is_none()
}

/// The sum of a pixel's depth: what the GPU stored, and what a reader gets by adding the numbers up.
fn is_sum(here: &Here, parts: &[&str], [sign, power]: [f64; 2]) -> bool {
    let pixel = at(parts[0], parts[1]);
    let stored = here.depth(pixel);
    let [offset, scale, distance] = [parts[2], parts[3], parts[4]].map(number);
    let part = scale * distance.powf(power);
    let is_sum = (offset + sign * part - number(parts[5])).abs() <= 2e-3 * part + 1e-6;
    parts[4].ends_with(" m") && parts[5].parse().ok() == stored && is_sum
}

/// What depth 0 and depth 1 are stored as, by the setting: in single precision, as a viewport has them.
fn depth_range(here: &Here) -> [f64; 2] {
    let ends = here.frame.capture.settings["depth-range"].split(',');
    let ends: Vec<f64> = ends.map(|end| f64::from(end.parse::<f32>().expect("a depth"))).collect();
    [ends[0], ends[1]]
}

/// A depth mapping's numbers, from the camera's.
fn is_curve(here: &Here, parts: &[&str], sign: f64) -> bool {
    let camera = here.frame.scene.camera;
    let far = here.frame.plan.depth.far;
    let epsilon = here.frame.capture.settings["epsilon"].parse::<f64>().expect("a number");
    let offset = match parts[0] {
        "reversed-infinite" => 0.0,
        "standard-infinite" => 1.0,
        "standard-infinite-epsilon" => 1.0 - epsilon,
        _ => far.map_or(f64::NAN, |far| far / (far - camera.near)),
    };
    let scale = if parts[0] == "reversed-infinite" { camera.near } else { -camera.near * offset };
    let [near, far] = depth_range(here);
    let (offset, scale) = (near + (far - near) * offset, (far - near) * scale);
    let is = |text: &str, value: f64| (number(text) / value - 1.0).abs() < 1e-6 || number(text) == value;
    parts[0] == here.frame.capture.settings["depth"] && is(parts[1], offset) && is(parts[2], sign * scale)
}

/// The numbers of linear depth: where it is 0 and 1 lie near plane and what is behind all.
fn is_line(here: &Here, parts: &[&str], sign: f64) -> bool {
    let [offset, scale] = [number(parts[1]), sign * number(parts[2])];
    let near = here.frame.scene.camera.near;
    let is_reversed = parts[0] == "reversed-infinite";
    let end = if is_reversed { -offset / scale } else { (1.0 - offset) / scale };
    let at_near = offset + scale * near;
    let camera = here.frame.scene.camera;
    let ahead = (camera.target - camera.eye).normalize();
    let deepest = here.frame.scene.objects.iter().filter(|object| object.visible).flat_map(|o| o.world_positions());
    let deepest = deepest.map(|point| (point - camera.eye).dot(ahead)).fold(0.0, f64::max);
    parts[0] == here.frame.capture.settings["depth"]
        && (at_near - if is_reversed { 1.0 } else { 0.0 }).abs() < 1e-5
        && end > near
        && end < deepest * 1.02
}

/// What z-pass-plus began with: no step stores it.
fn near_count(here: &Here, at: [u32; 2]) -> f64 {
    let history = here.history.expect("a history");
    let of_light = history.events.iter().filter(|event| event.light == Some(here.light()) && !event.is_from_camera);
    let sum: i32 = of_light.map(|event| event.counted()).sum();
    assert_eq!(history.pixel, at);
    f64::from(sum)
}

pub fn patterns() -> Vec<&'static str> {
    // No built-in scene has an object that receives no shadow, and is tested.
    all_but(&["receives no shadow", "no texel of it is known"], &[FORMULAS, LINES])
}

/// Checks a text by the first pattern that it fits. Returns what is wrong, if anything.
fn find_first(
    all: &'static [(&'static str, Check)],
    here: &Here,
    text: &str,
    seen: &mut SeenPatterns,
) -> Option<String> {
    find(matching(all, text).take(1), text, seen, |check, parts| check(here, parts))
}

pub fn check(frame: &Frame, seen: &mut SeenPatterns) -> Vec<String> {
    let mut wrong = Vec::new();
    for step in 0..frame.capture.steps.len() {
        let light = frame.capture.steps[step].light;
        let picks = frame.pixels.iter().map(|(history, at)| (Some(*at), Some(history)));
        for (pick, history) in std::iter::once((None, None)).chain(picks) {
            let readers = light.and_then(|light| frame.readers[light].as_ref());
            let map = pick.and_then(|at| MapDecision::of(&frame.capture, readers?, light?, at));
            let known = ExplainContext {
                capture: &frame.capture,
                step,
                lights: &frame.scene.lights,
                pick,
                history,
                map: map.as_ref(),
            };
            for fact in facts(&known) {
                let here = Here { frame, step, pick, history, map: map.as_ref(), formula: &fact.formula };
                let formula = find_first(FORMULAS, &here, here.formula, seen);
                let lines = fact.here.iter().filter_map(|line| find_first(LINES, &here, line, seen));
                let name = &frame.capture.steps[step].name;
                let found = formula.into_iter().chain(lines);
                wrong.extend(found.map(|what| format!("a card of {name} (step {step}), pixel {pick:?}, {what}")));
            }
        }
    }
    wrong
}

//! The Explain tab's cards, held against the plan's draws and what the GPU left.

use super::Held;
use super::frames::Frame;
use super::patterns::{gaps, is_near, mask_of, number};
use super::purposes::steps;
use stencilscope::history::{EventKind, PixelHistory};
use stencilscope::math::depth::DepthMapping;
use stencilscope::plan::{CountOf, DecidedBy, Part, Program, Side, Visibility};
use stencilscope::reading::explain_facts::{Known, facts};
use stencilscope::reading::map_decision::MapDecision;
use wgpu::CompareFunction;

/// A card, and what it is told of.
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

    fn draws(&self, part: Part) -> impl Iterator<Item = &stencilscope::plan::Draw> {
        self.frame.step(self.step).1.draws.iter().filter(move |draw| draw.part == part)
    }

    fn triangles(&self, part: Part) -> f64 {
        self.draws(part).map(|draw| f64::from(draw.triangles.end - draw.triangles.start)).sum()
    }

    /// Sides that count, and no others, are on this side, and the first adds where its outside is seen.
    fn counts(&self, side: Side) -> bool {
        let is_in_front = side == Side::InFront;
        let mut sides = self.draws(Part::Side).filter_map(steps).peekable();
        sides.peek().is_none()
            || sides.all(|one| {
                let (up, down) = if is_in_front { (one.outside, one.inside) } else { (one.inside, one.outside) };
                one.is_in_front == is_in_front && up >= 0 && down <= 0 && up != down
            })
    }

    /// All bytes of the stencil after this step.
    fn bytes(&self) -> Vec<u8> {
        let frame = self.frame.capture.frame_at(self.step).expect("a frame");
        frame.stencil.as_ref().expect("a stencil").image.rows().flatten().copied().collect()
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
                .and_then(|count| count.count_at(at))
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
    let told = here.frame.capture.lights[light].count_of == Some(of);
    let by_hand = here.frame.capture.settings.get("casters").is_some_and(|casters| casters != "by-topology");
    match of {
        // An open caster that nothing lies behind is let be: it is a quad.
        CountOf::Bodies => {
            told && !by_hand
                && cast().all(|object| is_closed(object) || object.mesh.triangles().len() <= 2)
                && cast().any(is_closed)
        }
        CountOf::Surfaces => told,
        CountOf::Mixed => told && !by_hand && cast().any(is_closed),
    }
}

const FORMULAS: &[(&str, Check)] = &[
    ("stored depth = offset + scale / distance along the view", |here, _| {
        let curve = here.frame.plan.depth;
        let camera = here.frame.scene.camera;
        // Linear in 1 / distance, from the near plane's depth on.
        let near = if curve.mapping == DepthMapping::ReversedInfinite { 1.0 } else { 0.0 };
        (curve.depth(camera.near) - near).abs() < 1e-9
    }),
    ("stored depth = offset + scale · distance along the view", |here, _| {
        let curve = here.frame.plan.depth;
        let near = if curve.mapping == DepthMapping::ReversedInfinite { 1.0 } else { 0.0 };
        let [at_near, at_middle] = [1.0, 2.0].map(|nears| curve.depth(nears * here.frame.scene.camera.near));
        // Linear in the distance.
        let slope = (at_middle - at_near) / here.frame.scene.camera.near;
        here.frame.scene.camera.is_parallel()
            && (at_near - near).abs() < 1e-9
            && (slope / curve.scale - 1.0).abs() < 1e-6
    }),
    ("count = front faces before the surface − back faces before it, seen from the eye", |here, _| {
        here.counts(Side::InFront)
    }),
    ("count = back faces behind the surface − front faces behind it, seen from the eye", |here, _| {
        here.counts(Side::Behind)
    }),
    ("count = volumes that contain the surface: each face the ray crosses adds or takes 1", |here, _| {
        here.decided_by().counted_side() == Some(Side::AsNeeded)
    }),
    ("count at the near plane = casting triangles between the light and the pixel's point of that plane", |here, _| {
        here.frame.step(here.step).1.counts_at_near_plane()
    }),
    ("a closed volume = sides + light cap + dark cap", |here, _| here.draws(Part::Side).next().is_some()),
    ("light is added where count = 0", |here, _| asks_stencil(here, 0xff)),
    ("light is added where count = 0, kept in {}", |here, told| asks_stencil(here, mask_of(told[0]))),
    ("light is added where the stencil is even: a shadow adds 1 to its receiver's even mark", |here, _| {
        asks_stencil(here, 1)
    }),
    ("light is added where the technique lets it through", |here, _| {
        let how = match here.decided_by() {
            DecidedBy::FloatCount { .. } => Visibility::Count,
            DecidedBy::ReceiverTextures => Visibility::ReceiverTexture,
            DecidedBy::Silhouettes => Visibility::Projected,
            DecidedBy::Labels => Visibility::Labels,
            DecidedBy::Nothing | DecidedBy::Flattened => Visibility::Everywhere,
            DecidedBy::StencilCount { .. } | DecidedBy::Map => return false,
        };
        let lights = |program| {
            [Program::Light(how), Program::Light(Visibility::Everywhere), Program::Through].contains(&program)
        };
        let rest = |part| [Part::Surface, Part::PlanarShadow].contains(&part);
        here.frame.step(here.step).1.draws.iter().all(|draw| lights(draw.program) && rest(draw.part))
    }),
    (
        "lit where the map stores nothing nearer to the light than this surface: stored depth against its own",
        |here, _| here.frame.plan.lights[here.light()].map.as_ref().is_some_and(|map| map.lookup.is_some()),
    ),
    ("label = 0 lit, 1 shadow, 2 background, 3 out of reach: the technique's answer, pixel by pixel", |here, _| {
        let labels = here.frame.capture.lights[here.light()].shadow.as_ref().expect("labels");
        labels.rows().flatten().all(|label| *label <= 3)
    }),
    (
        "a texel keeps the depth nearest to the light; a point is in shadow where it is deeper than its texel",
        |here, _| here.frame.plan.lights[here.light()].map.as_ref().is_some_and(|map| map.lookup.is_some()),
    ),
    ("light on the receiver = light × its texel: none of it where a caster was drawn", |here, _| {
        here.frame.plan.technique == "planar-texture" && here.frame.step(here.step).1.color.is_some()
    }),
    ("light behind the caster = light × its texel: what the caster lets through there", |here, _| {
        here.frame.plan.technique == "projective" && here.frame.step(here.step).1.color.is_some()
    }),
    ("shadow matrix = (P·L) I − L Pt, with the plane P = (n, d) and the light L = (x, y, z, w)", |here, _| {
        here.draws(Part::PlanarShadow).next().is_some()
    }),
    ("shadow may fall only where the receiver itself is seen: it is marked in the stencil first", |here, _| {
        here.draws(Part::Receiver).next().is_some()
    }),
];

/// The faces of a pass at a pixel: those that add and take away, and what the count holds after them.
fn adds_up(here: &Here, told: &[&str], modulus: f64) -> bool {
    let at = at(told[0], told[1]);
    let [up, down, idle, up_again, down_again, sum] = [2, 3, 4, 5, 6, 7].map(|gap| number(told[gap]));
    let history = here.history.expect("a history");
    // Triangle by triangle, as the machine of the history took them; and in the end as the GPU stored it.
    let (mut ups, mut downs, mut rest) = (0.0, 0.0, 0.0);
    for event in history.events.iter().filter(|event| event.pass == here.step) {
        match &event.kind {
            EventKind::Triangle(one) if one.part.is_of_volume() => {
                *match event.counted() {
                    0 => &mut rest,
                    1.. => &mut ups,
                    _ => &mut downs,
                } += 1.0
            }
            _ => {}
        }
    }
    let change = f64::from(here.stored(at) - here.before(at));
    let in_floats = here.decided_by().counts_in_floats();
    let near = if in_floats && sum != change { near_count(here, at) } else { 0.0 };
    let stored = if in_floats { sum == change - near } else { (sum - change).rem_euclid(modulus) == 0.0 };
    // What a first pass of floats leaves is not kept.
    let stored = stored || (in_floats && here.volume_passes_follow());
    (up, down, idle) == (ups, downs, rest) && (up, down) == (up_again, down_again) && sum == up - down && stored
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

/// The sum of a pixel's depth: what the GPU stored, and what a reader gets who adds the numbers up.
fn is_sum(here: &Here, told: &[&str], sign: f64) -> bool {
    let pixel = at(told[0], told[1]);
    let stored = here.frame.capture.frame_at(here.step).and_then(|frame| frame.depth.image.depth_at(pixel));
    let [offset, scale, distance] = [told[2], told[3], told[4]].map(number);
    let part = scale / distance;
    let is_sum = (offset + sign * part - number(told[5])).abs() <= 1e-3 * part + 1e-6;
    told[4].ends_with(" m") && told[5].parse().ok() == stored && is_sum
}

/// The same of a parallel camera.
fn is_linear_sum(here: &Here, told: &[&str], sign: f64) -> bool {
    let stored =
        here.frame.capture.frame_at(here.step).and_then(|frame| frame.depth.image.depth_at(at(told[0], told[1])));
    let [offset, scale, distance] = [told[2], told[3], told[4]].map(number);
    let part = scale * distance;
    let is_sum = (offset + sign * part - number(told[5])).abs() <= 2e-3 * part + 1e-6;
    told[4].ends_with(" m") && told[5].parse().ok() == stored && is_sum
}

/// The numbers of linear depth: where it is 0 and 1 lie near plane and what is behind all.
fn is_line(here: &Here, told: &[&str], sign: f64) -> bool {
    let [offset, scale] = [number(told[1]), sign * number(told[2])];
    let near = here.frame.scene.camera.near;
    let is_reversed = told[0] == "reversed-infinite";
    let end = if is_reversed { -offset / scale } else { (1.0 - offset) / scale };
    let at_near = offset + scale * near;
    let camera = here.frame.scene.camera;
    let ahead = (camera.target - camera.eye).normalize();
    let deepest = here.frame.scene.objects.iter().filter(|object| object.visible).flat_map(|o| o.world_positions());
    let deepest = deepest.map(|point| (point - camera.eye).dot(ahead)).fold(0.0, f64::max);
    told[0] == here.frame.capture.settings["depth"]
        && (at_near - if is_reversed { 1.0 } else { 0.0 }).abs() < 1e-5
        && end > near
        && end < deepest * 1.02
}

/// A depth mapping's numbers, from the camera's.
fn is_curve(here: &Here, told: &[&str], sign: f64) -> bool {
    let camera = here.frame.scene.camera;
    let far = here.frame.plan.depth.far;
    let epsilon = here.frame.capture.settings["epsilon"].parse::<f64>().expect("a number");
    let offset = match told[0] {
        "reversed-infinite" => 0.0,
        "standard-infinite" => 1.0,
        "standard-infinite-epsilon" => 1.0 - epsilon,
        _ => far.map_or(f64::NAN, |far| far / (far - camera.near)),
    };
    let scale = if told[0] == "reversed-infinite" { camera.near } else { -camera.near * offset };
    let is = |told: &str, value: f64| (number(told) / value - 1.0).abs() < 1e-6 || number(told) == value;
    told[0] == here.frame.capture.settings["depth"] && is(told[1], offset) && is(told[2], sign * scale)
}

const LINES: &[(&str, Check)] = &[
    ("Pick a pixel (right click) to see its own numbers.", pick_is_missing),
    ("Pick a pixel (right click) to see the faces that made its count.", pick_is_missing),
    ("Pick a pixel (right click) to see the texel that decides it.", pick_is_missing),
    ("pixel {}, {}: no surface is there, and depth stays {}", |here, told| {
        let stored =
            here.frame.capture.frame_at(here.step).and_then(|frame| frame.depth.image.depth_at(at(told[0], told[1])));
        let clear = if here.frame.plan.depth.mapping == DepthMapping::ReversedInfinite { 0.0 } else { 1.0 };
        stored == Some(clear) && told[2].parse() == Ok(clear)
    }),
    ("pixel {}, {}: {} + {} / {} = {}", |here, told| is_sum(here, told, 1.0)),
    ("pixel {}, {}: {} − {} / {} = {}", |here, told| is_sum(here, told, -1.0)),
    ("pixel {}, {}: {} + {} · {} = {}", |here, told| is_linear_sum(here, told, 1.0)),
    ("pixel {}, {}: {} − {} · {} = {}", |here, told| is_linear_sum(here, told, -1.0)),
    ("the count began at {}, the volumes that all lines of sight end in", |here, told| {
        let began = here.history.expect("a history").events.iter().rev().find_map(|event| match event.kind {
            EventKind::ClearStencil => Some(f64::from(event.after.stencil)),
            EventKind::ClearCount => Some(f64::from(event.after.count)),
            _ => None,
        });
        here.frame.scene.camera.is_parallel() && began == Some(number(told[0]))
    }),
    ("the next depth that can be stored is {} further", |here, told| {
        let at = here.pick.expect("a pick");
        let stored =
            here.frame.capture.frame_at(here.step).and_then(|frame| frame.depth.image.depth_at(at)).expect("a depth");
        let curve = here.frame.plan.depth;
        let away = |depth: f32| {
            let above = f64::from(depth) - curve.offset;
            if curve.is_linear { above / curve.scale } else { curve.scale / above }
        };
        let step = (away(stored.next_up()) - away(stored)).abs();
        !step.is_finite() || is_near(told[0], step)
    }),
    ("{}: {} + {} · distance", |here, told| is_line(here, told, 1.0)),
    ("{}: {} − {} · distance", |here, told| is_line(here, told, -1.0)),
    ("{}: {} + {} / distance", |here, told| is_curve(here, told, 1.0)),
    ("{}: {} − {} / distance", |here, told| is_curve(here, told, -1.0)),
    ("pixel {}, {}: {} faces turn the bit over, {} do not count here", |here, told| {
        let history = here.history.expect("a history");
        let of_step = history.events.iter().filter(|event| event.pass == here.step);
        let faces = of_step.filter(|event| event.triangle().is_some_and(|one| one.part.is_of_volume()));
        let (turning, idle): (Vec<_>, Vec<_>) = faces.partition(|event| event.before.stencil != event.after.stencil);
        let change = here.stored(at(told[0], told[1])) - here.before(at(told[0], told[1]));
        let is_odd = turning.len() % 2 == 1;
        [number(told[2]), number(told[3])] == [turning.len() as f64, idle.len() as f64] && is_odd == (change != 0.0)
    }),
    ("pixel {}, {}: {} faces add 1, {} take 1 away, {} do not count here: {} − {} = {}, kept in {}", |here, told| {
        adds_up(here, &told[..8], f64::from(mask_of(told[8])) + 1.0)
    }),
    ("pixel {}, {}: {} faces add 1, {} take 1 away, {} do not count here: {} − {} = {}", |here, told| {
        adds_up(here, told, 256.0)
    }),
    ("the stored count is {} then, and the pixel is {}", |here, told| {
        let pick = here.pick.expect("a pick");
        let label = here.frame.label(here.light(), pick);
        let is_lit = label == Some(0);
        let words = if is_lit { "lit" } else { "in shadow" };
        matches!(label, Some(0 | 1))
            && !here.volume_passes_follow()
            && told[1] == words
            && number(told[0]) == f64::from(here.stored(pick))
    }),
    ("the stored count is {} then", |here, told| {
        let pick = here.pick.expect("a pick");
        let in_between = here.decided_by().counts_in_floats() && here.volume_passes_follow();
        in_between || number(told[0]) == f64::from(here.stored(pick))
    }),
    ("{} of {} pixels have a count other than 0", |here, told| {
        let counts = here.all_counts();
        let marked = counts.iter().filter(|count| **count != 0.0).count();
        [number(told[0]), number(told[1])] == [marked as f64, counts.len() as f64]
    }),
    ("the highest count is {}", |here, told| {
        let most = here.all_counts().into_iter().fold(f32::MIN, f32::max);
        number(told[0]) == f64::from(most) && (most < 128.0 || here.decided_by().counts_in_floats())
    }),
    ("the highest count up to 127 is {}; {} pixels hold 128 to 255, which may be less than 0", |here, told| {
        let bytes = here.bytes();
        let most = bytes.iter().filter(|byte| **byte < 128).max().copied().unwrap_or(0);
        let beyond = bytes.iter().filter(|byte| **byte > 127).count();
        number(told[0]) == f64::from(most) && number(told[1]) == beyond as f64 && beyond > 0
    }),
    ("sides, between each silhouette edge and the same edge at the far end: {}", |here, told| {
        number(told[0]) == here.triangles(Part::Side)
    }),
    ("light caps, the casting triangles themselves: {}", |here, told| {
        number(told[0]) == here.triangles(Part::LightCap)
    }),
    ("dark caps, the casting triangles carried to the far end: {}", |here, told| {
        let finite = here.frame.capture.settings["extrusion"].starts_with("finite");
        finite && number(told[0]) == here.triangles(Part::DarkCap)
    }),
    ("dark caps: the sides of a sun's volume meet in one point at infinity, so it needs none: {}", |here, told| {
        here.frame.capture.lights[here.light()].position.w == 0.0
            && told[0] == "0"
            && here.triangles(Part::DarkCap) == 0.0
    }),
    ("dark caps, fans over the silhouettes at infinity: {}", |here, told| {
        here.frame.capture.lights[here.light()].position.w != 0.0 && number(told[0]) == here.triangles(Part::DarkCap)
    }),
    (
        "dark caps: parallel lines of sight see infinity as one point, and the count begins at what lies there: {}",
        |here, told| told[0] == "0" && here.triangles(Part::DarkCap) == 0.0 && here.frame.scene.camera.is_parallel(),
    ),
    ("{} adds ({}, {}, {}) × (material × {} + highlight){}", |here, told| {
        let index = here.light();
        let light = &here.frame.scene.lights[index];
        let color =
            [0, 1, 2].map(|channel| is_near(told[1 + channel], f64::from(light.color[channel] * light.intensity)));
        let wraps = here.frame.plan.wraps_diffuse;
        let diffuse = if wraps { "(1 + cosine of its angle) / 2" } else { "cosine of its angle" };
        let fades = light.range.is_some() && here.frame.capture.lights[index].position.w != 0.0;
        let fading = if fades { " × what is left at its distance" } else { "" };
        told[0] == format!("light {}", index + 1) && color == [true; 3] && told[4] == diffuse && told[5] == fading
    }),
    ("{} of {} pixels have {}: the test lets light through", |here, told| {
        let bytes: Vec<u8> =
            match here.step.checked_sub(1).and_then(|step| here.frame.capture.frame_at(step)?.stencil.as_ref()) {
                Some(stencil) => stencil.image.rows().flatten().copied().collect(),
                None => return false,
            };
        let is_even = told[2] == "an even number";
        let lit = bytes.iter().filter(|byte| if is_even { **byte % 2 == 0 } else { **byte == 0 }).count();
        let asks = if is_even {
            asks_stencil(here, 1)
        } else {
            told[2] == "the count 0" && [0xff, 0xf, 3, 1].iter().any(|mask| asks_stencil(here, *mask))
        };
        asks && [number(told[0]), number(told[1])] == [lit as f64, bytes.len() as f64]
    }),
    ("pixel {}, {}: its stencil is {}, so {}", |here, told| {
        let pixel = at(told[0], told[1]);
        let stencil = here.frame.stencil(here.step.checked_sub(1), pixel).expect("a stencil");
        let is_added = told[3] == "light is added";
        let before = here.frame.capture.frame_at(here.step - 1).and_then(|frame| frame.color.image.rgba_at(pixel));
        let after = here.frame.capture.frame_at(here.step).and_then(|frame| frame.color.image.rgba_at(pixel));
        let is_kept_away = told[3] == "the stencil test keeps light away" && before == after;
        let says = match here.frame.label(here.light(), pixel) {
            Some(0) => is_added,
            Some(1) => is_kept_away,
            _ => is_added || is_kept_away,
        };
        number(told[2]) == f64::from(stencil) && says
    }),
    ("pixel {}, {}: its stencil is {}, but the object receives no shadow, and light is added", |here, told| {
        let pixel = at(told[0], told[1]);
        let has_one = here.frame.scene.objects.iter().any(|object| !object.receives);
        number(told[2]) == f64::from(here.frame.stencil(here.step.checked_sub(1), pixel).expect("a stencil"))
            && here.frame.label(here.light(), pixel) == Some(0)
            && has_one
    }),
    ("pixel {}, {} reads texel {}", |here, told| {
        here.map.is_some_and(|map| {
            let texel = told[2].split(" of face").next().unwrap_or_default();
            let [x, y] = map.middle.texel.at;
            at(told[0], told[1]) == here.pick.expect("a pick") && texel == format!("{x}, {y}")
        })
    }),
    ("stored {}, this surface {}: {}", |here, told| {
        here.map.is_some_and(|map| {
            let light = &here.frame.capture.lights[map.light];
            let faces = &light.map.as_ref().expect("a map").faces;
            let stored = faces[map.middle.texel.face].depth_at(map.middle.texel.at).expect("a depth");
            let clear = if here.frame.plan.depth.mapping == DepthMapping::ReversedInfinite { 0.0 } else { 1.0 };
            let first = |text: &str| text.split(' ').next().and_then(|number| number.parse::<f32>().ok());
            let is_stored = if stored == clear { told[0] == "no caster" } else { first(told[0]) == Some(stored) };
            let own = first(told[1]).expect("a depth");
            let is_nearer = stored != clear && if clear == 0.0 { stored > own } else { stored < own };
            let label = here.frame.label(map.light, here.pick.expect("a pick"));
            let outcome = match told[2] {
                "stored is nearer to the light: shadow" => is_nearer && label != Some(0),
                "stored is not nearer: lit" => !is_nearer && stored != clear && label != Some(1),
                "nothing is stored: lit" => stored == clear && label != Some(1),
                "too close to tell anew" => matches!(label, Some(0 | 1)),
                many => gaps("{} of {} hold nothing nearer: {}/{} lit", many).is_some_and(|told| {
                    let width = here.frame.plan.lights[map.light]
                        .map
                        .as_ref()
                        .and_then(|map| map.lookup)
                        .map_or(0, |how| how.filter_width);
                    let [lit, all, lit_again, all_again] = [0, 1, 2, 3].map(|gap| number(told[gap]));
                    let of_width = f64::from(width * width);
                    // Beyond its face a filter reads none.
                    let lit_here = map.compared.iter().filter(|one| one.is_lit).count() as f64;
                    width > 1
                        && all <= of_width
                        && (lit, all) == (lit_again, all_again)
                        && lit == lit_here
                        && lit <= all
                        && match label {
                            Some(0) => 2.0 * lit >= all,
                            Some(1) => 2.0 * lit < all,
                            _ => true,
                        }
                }),
            };
            is_stored && outcome
        })
    }),
    ("pixel {}, {}: no texel of it is known that decides", |here, _| here.map.is_none() && here.pick.is_some()),
    ("{} lit, {} in shadow, {} background, {} faces away", |here, told| {
        let labels: Vec<u8> = here.frame.capture.lights[here.light()]
            .shadow
            .as_ref()
            .expect("labels")
            .rows()
            .flatten()
            .copied()
            .collect();
        (0..4)
            .all(|label| number(told[label]) == labels.iter().filter(|one| usize::from(**one) == label).count() as f64)
    }),
    ("Choose the picture Truth or Error to hold it against rays.", |here, _| {
        here.frame.capture.lights[here.light()].truth.is_none()
    }),
    ("layer {} of {}: {}×{} texels", |here, told| {
        let pass = here.frame.step(here.step).1;
        let color = pass.color.as_ref().map(|target| (target.attachment, target.layer));
        let target = color.or_else(|| pass.depth_stencil.as_ref().map(|target| (target.attachment, target.layer)));
        let (attachment, layer) = target.expect("a target");
        let attachment = here.frame.plan.attachment(attachment);
        let map = here.frame.plan.lights[here.light()].map.as_ref().expect("a map");
        // Faces that no caster shows in have no layer; the lesson counts them.
        let layers = map.faces.len();
        let own = number(told[0]) - 1.0;
        let seen = map.faces.get(own as usize).copied().flatten();
        (seen == Some(pass.view) || own == f64::from(layer))
            && number(told[1]) == layers as f64
            && [told[2], told[3]].map(number) == attachment.size.map(f64::from)
    }),
    ("1 m from the light a texel is {} mm wide, 10 m away {} mm", |here, told| {
        let map = here.frame.plan.lights[here.light()].map.as_ref().expect("a map");
        let side = 2e3 / f64::from(here.frame.plan.attachment(map.attachment).size[0]);
        let is_cube = map.faces.len() == 6 && map.lookup.is_some();
        is_cube && is_near(told[0], side) && is_near(told[1], 10.0 * side)
    }),
    ("L = ({}, {}, {}, {}){}", |here, told| {
        let light = here.frame.capture.lights[here.light()].position.to_array();
        let is_told = (0..4).all(|axis| is_near(told[axis], light[axis]));
        is_told && told[4] == if light[3] == 0.0 { ": a direction, as w = 0" } else { "" }
    }),
    ("{} flattened in {}, one for each receiver behind it", |here, told| {
        let mut casters: Vec<&str> = here.draws(Part::PlanarShadow).filter_map(|draw| draw.caster.as_deref()).collect();
        let draws = casters.len();
        casters.sort_unstable();
        casters.dedup();
        let is = |text: &str, count: usize, noun: &str| {
            number(text) == count as f64 && text.ends_with(&format!(" {noun}{}", if count == 1 { "" } else { "s" }))
        };
        is(told[0], casters.len(), "caster") && is(told[1], draws, "draw")
    }),
    ("{} pixels are marked", |here, told| {
        number(told[0]) == here.bytes().iter().filter(|byte| **byte != 0).count() as f64
    }),
    (
        "A count is of bodies: every caster that can darken a surface here is proven closed, and counts 1 each time the way to the light goes through it.",
        |here, _| is_count_of(here, CountOf::Bodies),
    ),
    (
        "A count is of surfaces, not of bodies: each one on the way to the light counts 1, so that a closed body whose both sides cast counts 2.",
        |here, _| is_count_of(here, CountOf::Surfaces),
    ),
    (
        "A count is of bodies and of surfaces: a caster that is proven closed counts 1 each time the way to the light goes through it, of the others each surface counts 1.",
        |here, _| is_count_of(here, CountOf::Mixed),
    ),
];

/// What z-pass-plus began with: no step keeps it.
fn near_count(here: &Here, at: [u32; 2]) -> f64 {
    let history = here.history.expect("a history");
    let of_light = history.events.iter().filter(|event| event.light == Some(here.light()) && !event.is_from_camera);
    let sum: i32 = of_light.map(|event| event.counted()).sum();
    assert_eq!(history.pixel, at);
    f64::from(sum)
}

pub fn patterns() -> Vec<&'static str> {
    // No built-in scene has an object that receives no shadow, and is tested.
    let rare = ["receives no shadow", "no texel of it is known"];
    FORMULAS
        .iter()
        .chain(LINES)
        .map(|(pattern, _)| *pattern)
        .filter(|pattern| !rare.iter().any(|words| pattern.contains(words)))
        .collect()
}

fn find(all: &'static [(&'static str, Check)], here: &Here, text: &str, held: &mut Held) -> Option<String> {
    let known = all.iter().find_map(|(pattern, check)| Some((pattern, check, gaps(pattern, text)?)));
    match known {
        Some((pattern, check, told)) if check(here, &told) => {
            held.insert(pattern);
            None
        }
        Some((pattern, ..)) => Some(format!("is not so ({pattern}): {text}")),
        None => Some(format!("is known to no check: {text}")),
    }
}

pub fn check(frame: &Frame, held: &mut Held) -> Vec<String> {
    let mut wrong = Vec::new();
    for step in 0..frame.capture.steps.len() {
        let light = frame.capture.steps[step].light;
        let picks = frame.pixels.iter().map(|(history, at)| (Some(*at), Some(history)));
        for (pick, history) in std::iter::once((None, None)).chain(picks) {
            let readers = light.and_then(|light| frame.readers[light].as_ref());
            let map = pick.and_then(|at| MapDecision::of(&frame.capture, readers?, light?, at));
            let known =
                Known { capture: &frame.capture, step, lights: &frame.scene.lights, pick, history, map: map.as_ref() };
            for fact in facts(&known) {
                let here = Here { frame, step, pick, history, map: map.as_ref(), formula: &fact.formula };
                let formula = find(FORMULAS, &here, here.formula, held);
                let lines = fact.here.iter().filter_map(|line| find(LINES, &here, line, held));
                let name = &frame.capture.steps[step].name;
                let told = formula.into_iter().chain(lines);
                wrong.extend(told.map(|what| format!("a card of {name} (step {step}), pixel {pick:?}, {what}")));
            }
        }
    }
    wrong
}

//! What a step does, as a formula and as that formula with this scene's own numbers.
//!
//! The kind of step is known from what it draws: surfaces in ambient light, volumes, what a light sees, flattened
//! casters, light, or labels. Where a pixel is picked the numbers are that pixel's, else the picture's.

use crate::capture::{Capture, Snapshot, Step};
use crate::history::{PixelEvent, PixelEventKind, PixelHistory};
use crate::numbers;
use crate::plan::{CountBits, CountedSide, DecidedBy, Decision, DrawPart, LeftOut};
use crate::reading::counts;
use crate::reading::depth::DepthMeasure;
use crate::reading::format;
use crate::reading::map_decision::MapDecision;
use crate::scene::Light;
use crate::technique::{CommonSettings, CountOperations, VolumeSettings};
use crate::truth::{LIT, PixelLabel, SHADOW};
use std::collections::BTreeSet;

/// A formula that a step computes, with its values in this frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExplainFact {
    /// The formula.
    pub formula: String,
    /// Lines with the formula's values in this frame.
    pub here: Vec<String>,
}

/// What is known of the shown frame: the input of [`facts`].
#[derive(Debug, Clone, Copy)]
pub struct ExplainContext<'a> {
    /// The frame.
    pub capture: &'a Capture,
    /// Index of the step in [`Capture::steps`].
    pub step: usize,
    /// The scene's lights; empty for a capture folder.
    pub lights: &'a [Light],
    /// The picked pixel (column, row).
    pub pick: Option<[u32; 2]>,
    /// The picked pixel's history.
    pub history: Option<&'a PixelHistory>,
    /// How a light's shadow map decides the picked pixel; `None` where that is not known.
    pub map: Option<&'a MapDecision>,
}

/// Returns the formulas of a step with their values, the most important first; empty where the capture has no step of
/// this index. What the step draws decides which: a map, volumes, flattened casters, receivers, labels, a light, or
/// else how depth is stored.
pub fn facts(known: &ExplainContext) -> Vec<ExplainFact> {
    let Some(step) = known.capture.steps.get(known.step) else { return Vec::new() };
    let has = |part: DrawPart| step.draws.iter().any(|draw| draw.part == part);
    if matches!(step.snapshot, Snapshot::Map { .. }) {
        return vec![map(known, step)];
    }
    if step.draws.iter().any(|draw| draw.part.is_of_volume()) {
        // In another program's volumes, sides and caps can't be distinguished.
        let has_sides = has(DrawPart::Side);
        let parts = (known.capture.origin.is_none() && has_sides).then(|| triangles(known, step));
        return std::iter::once(volumes(known)).chain(parts).collect();
    }
    if has(DrawPart::PlanarShadow) {
        return vec![flattened(known, step)];
    }
    if has(DrawPart::Receiver) {
        return vec![receivers(known)];
    }
    match &step.snapshot {
        Snapshot::Frame(frame) if frame.target.is_beside() => {
            std::iter::once(labels(known, step)).chain(compared(known, step.light.unwrap_or(0))).collect()
        }
        Snapshot::Frame(_) if step.light.is_some() => vec![light(known, step)],
        _ => vec![depth(known)],
    }
}

fn fact(formula: &str, here: Vec<String>) -> ExplainFact {
    ExplainFact { formula: formula.to_owned(), here }
}

/// Explains how depth is stored: `offset + scale / distance`, or of a parallel camera `offset + scale · distance`, with
/// the picked pixel's numbers, or a hint to pick one.
fn depth(known: &ExplainContext) -> ExplainFact {
    let curve = known.capture.depth;
    // With fewer digits the sum would differ from what is stored.
    let sign = if curve.scale < 0.0 { "−" } else { "+" };
    let by = if curve.is_linear { "·" } else { "/" };
    let terms = format!("{} {sign} {} {by}", format::precise(curve.offset), format::precise(curve.scale.abs()));
    let mut here = vec![format!("{}: {terms} distance", curve.mapping.name())];
    let stored = known.pick.and_then(|at| known.capture.frame_at(known.step)?.depth.image.depth_at(at));
    if let (Some([x, y]), Some(stored)) = (known.pick, stored) {
        let measure = DepthMeasure::of_camera(known.capture);
        match measure.value(stored) {
            None if !curve.tells_distances() => here.push(format!(
                "pixel {x}, {y}: all depths are stored as {}, whatever the distance",
                format::depth(stored)
            )),
            None => {
                here.push(format!("pixel {x}, {y}: no surface is there, and depth stays {}", format::depth(stored)))
            }
            Some(distance) => {
                let away = format::length(distance, curve.unit.name());
                here.push(format!("pixel {x}, {y}: {terms} {away} = {}", format::depth(stored)));
                here.extend(measure.step_at(stored).map(|step| {
                    format!("the next depth that can be stored is {} further", format::length(step, curve.unit.name()))
                }));
            }
        }
    } else {
        here.push("Pick a pixel (click it) to see its own numbers.".to_owned());
    }
    fact(&format!("stored depth = offset + scale {by} distance along the view"), here)
}

/// Explains how a step counts shadow volumes, on the side of the surface where they count, with the picked pixel's
/// numbers.
fn volumes(known: &ExplainContext) -> ExplainFact {
    let light = known.capture.steps.get(known.step).and_then(|step| step.light);
    let side = light.and_then(|light| known.capture.decided_by(light).counted_side());
    let step = &known.capture.steps[known.step];
    let of_light = |other: &&Step| other.light == light;
    // Triangles between the light and the near plane have no sides: z-pass-plus begins with them.
    let is_at_near_plane = !step.draws.iter().any(|draw| draw.part == DrawPart::Side) && !step.draws.is_empty();
    let is_last = !known.capture.steps[known.step + 1..].iter().filter(of_light).any(has_volumes);
    let formula = match side {
        _ if is_at_near_plane => {
            "count at the near plane = casting triangles between the light and the pixel's point of that plane"
        }
        Some(CountedSide::InFront) => {
            "count = front faces before the surface − back faces before it, seen from the eye"
        }
        Some(CountedSide::Behind) => "count = back faces behind the surface − front faces behind it, seen from the eye",
        Some(CountedSide::AsNeeded) | None => {
            "count = volumes that contain the surface: each face the ray crosses adds or takes 1"
        }
    };
    let mut here = Vec::new();
    match (known.pick, known.history) {
        (Some([x, y]), Some(history)) => {
            let begins_here = |event: &&PixelEvent| {
                event.pass == known.step
                    && matches!(event.kind, PixelEventKind::ClearStencil | PixelEventKind::ClearCount)
            };
            let began = history.events.iter().find(begins_here).and(light).map_or(0, |light| history.cleared_to(light));
            let (mut up, mut down, mut idle) = (0_u32, 0_u32, 0_u32);
            let mut last = None;
            for event in history.events.iter().filter(|event| event.pass == known.step) {
                let PixelEventKind::Triangle(triangle) = &event.kind else { continue };
                if !triangle.part.is_of_volume() {
                    continue;
                }
                last = Some(f32::from(event.after.stencil) + event.after.count);
                match event.counted() {
                    0 => idle += 1,
                    1.. => up += 1,
                    _ => down += 1,
                }
            }
            let settings = VolumeSettings::read(&known.capture.settings);
            let in_float = light.is_some_and(|light| known.capture.decided_by(light).counts_in_floats());
            here.push(match settings.operations {
                CountOperations::Inverting if !in_float => {
                    format!("pixel {x}, {y}: faces that turn the bit over: {up}; that do not count here: {idle}")
                }
                _ => {
                    let (begins, first) = match began {
                        0 => (String::new(), String::new()),
                        _ => (format!("it begins at {began}, "), format!("{began} + ")),
                    };
                    let sum = i64::from(began) + i64::from(up) - i64::from(down);
                    format!(
                        "pixel {x}, {y}: {begins}faces that add 1: {up}; that take 1 away: {down}; that do not count here: \
                         {idle}; {first}{up} − {down} = {}{}",
                        numbers::whole(sum),
                        if in_float { String::new() } else { in_bits(&settings) }
                    )
                }
            });
            // Where a surface faces away, or there is no surface, no count decides.
            let label = light.and_then(|light| known.capture.lights.get(light)?.shadow.as_ref()?.byte_at([x, y]));
            here.extend(last.map(|count| match label.filter(|_| is_last) {
                Some(LIT) => format!("the stored count is {count} then, so the pixel is drawn lit"),
                Some(SHADOW) => format!("the stored count is {count} then, so the pixel is drawn dark"),
                _ => format!("the stored count is {count} then"),
            }));
        }
        _ => {
            here.extend(counted(known, light));
            here.push("Pick a pixel (click it) to see the faces that made its count.".to_owned());
        }
    }
    here.extend(light.and_then(|light| known.capture.lights.get(light)?.count_of).map(|of| of.meaning().to_owned()));
    fact(formula, here)
}

fn has_volumes(step: &Step) -> bool {
    step.draws.iter().any(|draw| draw.part.is_of_volume())
}

/// Returns lines about the counts in the whole picture after a step: how many pixels have one other than 0, and the
/// highest. Empty where there is no stencil, and for float counts before the light's last counting pass.
fn counted(known: &ExplainContext, light: Option<usize>) -> Vec<String> {
    let of_light = light.and_then(|light| known.capture.lights.get(light));
    let in_floats = light.is_some_and(|light| known.capture.decided_by(light).counts_in_floats());
    let counted = |marked: u64, all: u64| {
        format!("{} of {} pixels have a count other than 0", format::count(marked), format::count(all))
    };
    if in_floats {
        // Float counts are captured only after the last pass.
        let is_last =
            !known.capture.steps[known.step + 1..].iter().any(|step| step.light == light && has_volumes(step));
        let Some(count) = of_light.and_then(|light| light.count.as_ref()).filter(|_| is_last) else {
            return Vec::new();
        };
        let tally = counts::tally(count);
        let all: u64 = tally.values().sum();
        let most = tally.keys().next_back().copied().unwrap_or(0);
        let marked = all - tally.get(&0).copied().unwrap_or(0);
        return vec![counted(marked, all), format!("the highest count is {}", numbers::count_in_float(most as f32))];
    }
    let Some(stencil) = known.capture.frame_at(known.step).and_then(|frame| frame.stencil.as_ref()) else {
        return Vec::new();
    };
    let counts = stencil.image.histogram();
    let all: u64 = counts.iter().sum();
    let most = counts[..128].iter().rposition(|count| *count > 0).unwrap_or(0);
    let beyond: u64 = counts[128..].iter().sum();
    let highest = match beyond {
        0 => format!("the highest count is {most}"),
        // Eight bits no longer distinguish 255 from −1.
        _ => format!(
            "the highest count up to 127 is {most}; {} pixels hold 128 to 255, which may be less than 0",
            format::count(beyond)
        ),
    };
    vec![counted(all - counts[0], all), highest]
}

fn triangles(known: &ExplainContext, step: &Step) -> ExplainFact {
    let of =
        |part: DrawPart| step.draws.iter().filter(|draw| draw.part == part).map(|draw| draw.triangles).sum::<u64>();
    let [sides, light, dark] = [DrawPart::Side, DrawPart::LightCap, DrawPart::DarkCap].map(of);
    let is_sun = step.light.and_then(|light| known.lights.get(light)).is_some_and(Light::is_directional);
    let is_finite = known.capture.settings.get("extrusion").is_some_and(|how| how.starts_with("finite"));
    let is_parallel = known.capture.camera.is_parallel();
    let settings = VolumeSettings::read(&known.capture.settings);
    if settings.by_vertex_shader && (is_finite || !is_parallel) {
        let (sides, caps) = (format::count(sides), format::count(of(DrawPart::Caps)));
        let here = vec![
            format!(
                "sides, two triangles at every edge of what is one closed volume, and at those of each triangle of what is \
                 not: {sides}"
            ),
            format!(
                "caps, every triangle of the former once and of the latter twice, in its place or at the far end: {caps}"
            ),
        ];
        return fact("a closed volume = sides + light cap + dark cap", here);
    }
    // A count that does not begin there is absent, or lacks that start.
    let side = step.light.and_then(|light| known.capture.decided_by(light).counted_side());
    let draws_them = settings.caps[1];
    let begins_there = is_parallel && side != Some(CountedSide::InFront) && draws_them;
    let ends = |left: &LeftOut| left.decision == Some(Decision::BeyondReceivers);
    let ends_early = side != Some(CountedSide::Behind) && known.capture.left_out.iter().any(ends);
    let dark_cap = match (is_sun, is_finite) {
        (false, false) if begins_there => {
            "dark caps: parallel lines of sight see infinity as one point, and the count begins at what lies there"
        }
        (_, true) => "dark caps, the casting triangles carried to the far end",
        (true, false) => "dark caps: the sides of a sun's volume meet in one point at infinity, so it needs none",
        (false, false) => "dark caps, fans over the silhouettes at infinity",
    };
    // The capture does not store which light it belonged to.
    let ending = match ends_early {
        true => {
            "; a volume that ends sooner, beyond the last surface in view, is counted in front and open at that end"
        }
        false => "",
    };
    let here = vec![
        format!("sides, between each silhouette edge and the same edge at the far end: {}", format::count(sides)),
        format!("light caps, the casting triangles themselves: {}", format::count(light)),
        format!("{dark_cap}{ending}: {}", format::count(dark)),
    ];
    fact("a closed volume = sides + light cap + dark cap", here)
}

/// Returns whether a step that adds light is the one that asks nothing: the first of its light, its map's excepted, where a
/// share of its diffuse light belongs to the ambient light.
fn is_of_ambient_share(known: &ExplainContext, step: &Step, share: f32) -> bool {
    let comes_before = |one: &Step| one.light == step.light && !matches!(one.snapshot, Snapshot::Map { .. });
    share > 0.0 && !known.capture.steps[..known.step].iter().any(comes_before)
}

fn light(known: &ExplainContext, step: &Step) -> ExplainFact {
    let index = step.light.unwrap_or(0);
    let mut here = Vec::new();
    let share = CommonSettings::read(&known.capture.settings).ambient_diffuse;
    let is_unasked = is_of_ambient_share(known, step, share);
    if let Some(light) = known.lights.get(index) {
        let [red, green, blue] = light.emitted().map(|share| format::digits(share.into()));
        let diffuse = match known.capture.settings.get("diffuse").is_some_and(|how| how == "wrapped") {
            true => "(1 + cosine of its angle) / 2",
            false => "cosine of its angle",
        };
        let fading =
            if light.range.is_some() && !light.is_directional() { " × what is left at its distance" } else { "" };
        let adds = match (is_unasked, share > 0.0) {
            (true, _) => format!("{} × material × {diffuse}, whatever stands between", format::digits(share.into())),
            (false, true) => format!("({} × material × {diffuse} + highlight)", format::digits((1.0 - share).into())),
            (false, false) => format!("(material × {diffuse} + highlight)"),
        };
        here.push(format!("{} adds ({red}, {green}, {blue}) × {adds}{fading}", format::light(index)));
    }
    if is_unasked {
        return fact(
            "light is added whatever stands between: the share of its diffuse light that counts as ambient",
            here,
        );
    }
    if let Some(compared) = compared(known, index) {
        here.extend(compared.here);
        return fact(&compared.formula, here);
    }
    let before = known.step.checked_sub(1).and_then(|before| known.capture.frame_at(before));
    let stencil = before.and_then(|frame| frame.stencil.as_ref());
    // Shadows that are blended come after the light, whose pass then tests nothing.
    let has_shadows =
        |step: &Step| step.light == Some(index) && step.draws.iter().any(|draw| draw.part == DrawPart::PlanarShadow);
    let is_flattened = known.capture.steps[..known.step].iter().any(has_shadows);
    let settings = VolumeSettings::read(&known.capture.settings);
    // What the stencil test of the light pass lets through.
    let darkens = step.darkens();
    let (formula, what) = match known.capture.decided_by(index) {
        DecidedBy::StencilCount { .. } if darkens => {
            (format!("the picture is darkened where count ≠ 0{}", in_bits(&settings)), "the count 0")
        }
        DecidedBy::StencilCount { .. } => {
            (format!("light is added where count = 0{}", in_bits(&settings)), "the count 0")
        }
        DecidedBy::Flattened if is_flattened => {
            let formula = "light is added where the stencil is even: a shadow adds 1 to its receiver's even mark";
            (formula.to_owned(), "an even number")
        }
        _ => ("light is added where the technique lets it through".to_owned(), ""),
    };
    let Some(stencil) = stencil.filter(|_| !what.is_empty()) else { return fact(&formula, here) };
    let is_lit = |value: usize| if is_flattened { value.is_multiple_of(2) } else { value == 0 };
    let counts = stencil.image.histogram();
    let lit: u64 = counts.iter().enumerate().filter(|(value, _)| is_lit(*value)).map(|(_, count)| count).sum();
    let [lit, all] = [lit, counts.iter().sum()].map(format::count);
    let test = if darkens { "the test leaves them lit" } else { "the test lets light through" };
    here.push(format!("{lit} of {all} pixels have {what}: {test}"));
    if let Some((at, value)) = known.pick.and_then(|at| Some((at, stencil.image.byte_at(at)?))) {
        let does = match (is_lit(value.into()), darkens) {
            (true, false) => "light is added",
            (false, false) => "the stencil test keeps light away",
            (true, true) => "the stencil test leaves it lit",
            (false, true) => "light is taken away",
        };
        here.push(format!("pixel {}, {}: its stencil was {value} at this test, so {does}", at[0], at[1]));
    }
    fact(&formula, here)
}

/// Returns words for the bits of the stencil in which a count is stored, beginning with a comma; empty where these are
/// all eight.
fn in_bits(settings: &VolumeSettings) -> String {
    match CountBits::of_mask(settings.mask().into()) {
        CountBits::EIGHT => String::new(),
        bits => format!(", kept in {bits}"),
    }
}

/// Explains the comparison with the light's shadow map: texel, stored depth and own depth of the picked pixel, or a
/// prompt to pick one. `None` where no map decides for this light.
fn compared(known: &ExplainContext, light: usize) -> Option<ExplainFact> {
    if known.capture.decided_by(light) != DecidedBy::Map {
        return None;
    }
    let formula =
        "lit where the map stores nothing nearer to the light than this surface: stored depth against its own";
    let here = match (known.pick, known.map.filter(|map| map.light == light)) {
        (Some([x, y]), Some(map)) => vec![
            format!("pixel {x}, {y} reads texel {}", map.place_words()),
            format!(
                "stored {}, this surface {}: {}",
                map.stored_words(),
                map.depth_words(map.middle.depth),
                map.outcome()
            ),
        ],
        (Some([x, y]), None) => vec![format!("pixel {x}, {y}: no texel of it is known that decides")],
        (None, _) => vec!["Pick a pixel (click it) to see the texel that decides it.".to_owned()],
    };
    Some(fact(formula, here))
}

fn labels(known: &ExplainContext, step: &Step) -> ExplainFact {
    let index = step.light.unwrap_or(0);
    let mut here = Vec::new();
    if let Some(light) = known.capture.lights.get(index) {
        if let Some(shadow) = &light.shadow {
            let counts = shadow.histogram();
            let counted = PixelLabel::ALL.into_iter().zip(counts);
            let counted = counted.map(|(label, count)| format!("{} {}", format::count(count), label.name()));
            here.push(counted.collect::<Vec<_>>().join(", "));
        }
        match &light.truth {
            Some(truth) => {
                let error = &truth.error;
                here.push(format!(
                    "{} of {} compared pixels differ from the truth that rays tell",
                    format::count(error.wrong()),
                    format::count(error.compared)
                ));
            }
            None => here.push("Choose the picture Truth or Error to hold it against rays.".to_owned()),
        }
    }
    fact("label = 0 lit, 1 shadow, 2 background, 3 out of reach: the technique's answer, pixel by pixel", here)
}

fn map(known: &ExplainContext, step: &Step) -> ExplainFact {
    let Snapshot::Map { light, face } = step.snapshot else { return fact("", Vec::new()) };
    let mut here = Vec::new();
    let map = known.capture.lights.get(light).and_then(|light| light.map.as_ref());
    if let Some((map, image)) = map.and_then(|map| Some((map, map.faces.get(face)?))) {
        let [width, height] = image.size();
        here.push(format!("layer {} of {}: {width}×{height} texels", face + 1, map.faces.len()));
        if map.faces.len() == 6 && known.capture.decided_by(light) == DecidedBy::Map {
            // A cube's face spans a right angle: at distance d it is 2 d wide.
            let millimetres = 2e3 / f64::from(width.max(1));
            here.push(format!(
                "1 m from the light a texel is {} mm wide, 10 m away {} mm",
                format::digits(millimetres),
                format::digits(millimetres * 10.0)
            ));
        }
    }
    let formula = match known.capture.decided_by(light) {
        DecidedBy::ReceiverTextures => "light on the receiver = light × its texel: none of it where a caster was drawn",
        DecidedBy::Silhouettes => "light behind the caster = light × its texel: what the caster lets through there",
        _ => "a texel keeps the depth nearest to the light; a point is in shadow where it is deeper than its texel",
    };
    fact(formula, here)
}

fn flattened(known: &ExplainContext, step: &Step) -> ExplainFact {
    let index = step.light.unwrap_or(0);
    let mut here = Vec::new();
    if let Some(light) = known.lights.get(index) {
        let [x, y, z, w] = light.position.to_array().map(format::digits);
        here.push(format!(
            "L = ({x}, {y}, {z}, {w}){}",
            if light.is_directional() { ": a direction, as w = 0" } else { "" }
        ));
    }
    let flattened = || step.draws.iter().filter(|draw| draw.part == DrawPart::PlanarShadow);
    let casters: BTreeSet<&str> = flattened().filter_map(|draw| draw.caster.as_deref()).collect();
    let [casters, draws] = [casters.len(), flattened().count()].map(|count| count as u64);
    here.push(format!(
        "{} flattened in {}, one for each receiver behind it",
        format::counted(casters, "caster"),
        format::counted(draws, "draw")
    ));
    fact("shadow matrix = (P·L) I − L Pt, with the plane P = (n, d) and the light L = (x, y, z, w)", here)
}

fn receivers(known: &ExplainContext) -> ExplainFact {
    let mut here = Vec::new();
    if let Some(stencil) = known.capture.frame_at(known.step).and_then(|frame| frame.stencil.as_ref()) {
        let counts = stencil.image.histogram();
        let marked: u64 = counts[1..].iter().sum();
        here.push(format!("{} pixels are marked", format::count(marked)));
    }
    fact("shadow may fall only where the receiver itself is seen: it is marked in the stencil first", here)
}

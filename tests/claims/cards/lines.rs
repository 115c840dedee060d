//! Each line below a card's formula, and when it is so.

use super::*;
use crate::common::labels;

pub const LINES: &[(&str, Check)] = &[
    ("Pick a pixel (click it) to see its own numbers.", pick_is_missing),
    ("Pick a pixel (click it) to see the faces that made its count.", pick_is_missing),
    ("Pick a pixel (click it) to see the texel that decides it.", pick_is_missing),
    ("pixel {}, {}: no surface is there, and depth stays {}", |here, parts| {
        let clear = here.clear_depth();
        here.depth(at(parts[0], parts[1])) == Some(clear) && parts[2].parse() == Ok(clear)
    }),
    ("pixel {}, {}: {} + {} · {} = {}", |here, parts| is_sum(here, parts, [1.0, 1.0])),
    ("pixel {}, {}: {} − {} · {} = {}", |here, parts| is_sum(here, parts, [-1.0, 1.0])),
    ("pixel {}, {}: {} + {} / {} = {}", |here, parts| is_sum(here, parts, [1.0, -1.0])),
    ("pixel {}, {}: {} − {} / {} = {}", |here, parts| is_sum(here, parts, [-1.0, -1.0])),
    ("the next depth that can be stored is {} further", |here, parts| {
        let stored = here.depth(here.pick.expect("a pick")).expect("a depth");
        let curve = here.frame.plan.depth;
        let away = |depth: f32| {
            let part = f64::from(depth) - curve.offset;
            if here.frame.capture.camera.is_parallel() { part / curve.scale } else { curve.scale / part }
        };
        let step = (away(stored.next_up()) - away(stored)).abs();
        !step.is_finite() || is_near(parts[0], step)
    }),
    ("{}: {} + {} · distance", |here, parts| is_line(here, parts, 1.0)),
    ("{}: {} − {} · distance", |here, parts| is_line(here, parts, -1.0)),
    ("{}: {} + {} / distance", |here, parts| is_curve(here, parts, 1.0)),
    ("{}: {} − {} / distance", |here, parts| is_curve(here, parts, -1.0)),
    ("pixel {}, {}: faces that turn the bit over: {}; that do not count here: {}", |here, parts| {
        let history = here.history.expect("a history");
        let of_step = history.events.iter().filter(|event| event.pass == here.step);
        let faces = of_step.filter(|event| event.triangle().is_some_and(|one| one.part.is_of_volume()));
        let (turning, idle): (Vec<_>, Vec<_>) = faces.partition(|event| event.before.stencil != event.after.stencil);
        let change = here.stored(at(parts[0], parts[1])) - here.before(at(parts[0], parts[1]));
        let is_odd = turning.len() % 2 == 1;
        is_number(parts[2], turning.len()) && is_number(parts[3], idle.len()) && is_odd == (change != 0.0)
    }),
    (
        "pixel {}, {}: it begins at {}, faces that add 1: {}; that take 1 away: {}; that do not count here: {}; {} + {} − {} = {}",
        |here, parts| {
            let (sum, mask) = parts[9].split_once(", kept in ").unwrap_or((parts[9], ""));
            let modulus = if mask.is_empty() { 256.0 } else { f64::from(mask_of(mask)) + 1.0 };
            let stored = f64::from(here.stored(at(parts[0], parts[1])));
            let [began, again] = [parts[2], parts[6]].map(number);
            let rest = (number(sum) - began).to_string();
            let of_faces = [parts[0], parts[1], parts[3], parts[4], parts[5], parts[7], parts[8], rest.as_str()];
            let is_stored = (number(sum) - stored).rem_euclid(modulus) == 0.0;
            began == again && faces_add_up(here, &of_faces) && (is_stored || here.volume_passes_follow())
        },
    ),
    (
        "pixel {}, {}: faces that add 1: {}; that take 1 away: {}; that do not count here: {}; {} − {} = {}, kept in {}",
        |here, parts| adds_up(here, &parts[..8], f64::from(mask_of(parts[8])) + 1.0),
    ),
    (
        "pixel {}, {}: faces that add 1: {}; that take 1 away: {}; that do not count here: {}; {} − {} = {}",
        |here, parts| adds_up(here, parts, 256.0),
    ),
    ("the stored count is {} then, so the pixel is drawn {}", |here, parts| {
        let pick = here.pick.expect("a pick");
        let label = here.frame.label(here.light(), pick);
        let is_lit = label == Some(0);
        let words = if is_lit { "lit" } else { "dark" };
        matches!(label, Some(0 | 1))
            && !here.volume_passes_follow()
            && parts[1] == words
            && number(parts[0]) == f64::from(here.stored(pick))
    }),
    ("the stored count is {} then", |here, parts| {
        let pick = here.pick.expect("a pick");
        let in_between = here.decided_by().counts_in_floats() && here.volume_passes_follow();
        in_between || number(parts[0]) == f64::from(here.stored(pick))
    }),
    ("{} of {} pixels have a count other than 0", |here, parts| {
        let counts = here.all_counts();
        let marked = counts.iter().filter(|count| **count != 0.0).count();
        is_number(parts[0], marked) && is_number(parts[1], counts.len())
    }),
    ("the highest count is {}", |here, parts| {
        let most = here.all_counts().into_iter().fold(f32::MIN, f32::max);
        number(parts[0]) == f64::from(most) && (most < 128.0 || here.decided_by().counts_in_floats())
    }),
    ("the highest count up to 127 is {}; {} pixels hold 128 to 255, which may be less than 0", |here, parts| {
        let bytes = here.bytes();
        let most = bytes.iter().filter(|byte| **byte < 128).max().copied().unwrap_or(0);
        let beyond = bytes.iter().filter(|byte| **byte > 127).count();
        number(parts[0]) == f64::from(most) && is_number(parts[1], beyond) && beyond > 0
    }),
    ("sides, between each silhouette edge and the same edge at the far end: {}", |here, parts| {
        here.has_drawn(DrawPart::Side, parts[0])
    }),
    (
        "sides, two triangles at every edge of what is one closed volume, and at those of each triangle of what is not: {}",
        |here, parts| here.has_drawn(DrawPart::Side, parts[0]) && here.copies_and_sides().all(is_closed_or_prism),
    ),
    (
        "caps, every triangle of the former once and of the latter twice, in its place or at the far end: {}",
        |here, parts| {
            let caps: usize = here.copies_and_sides().map(|(triangles, copies, _)| triangles * copies).sum();
            let drawn = here.triangles(DrawPart::Caps);
            number(parts[0]) == drawn && (drawn == 0.0 || drawn == caps as f64)
        },
    ),
    ("light caps, the casting triangles themselves: {}", |here, parts| here.has_drawn(DrawPart::LightCap, parts[0])),
    ("dark caps, the casting triangles carried to the far end: {}", |here, parts| {
        let finite = here.frame.capture.settings["extrusion"].starts_with("finite");
        finite && number(parts[0]) == here.triangles(DrawPart::DarkCap)
    }),
    ("dark caps: the sides of a sun's volume meet in one point at infinity, so it needs none{}: {}", |here, parts| {
        here.is_of_sun()
            && here.ends_as_reported(parts[0])
            && parts[1] == "0"
            && here.triangles(DrawPart::DarkCap) == 0.0
    }),
    (
        "dark caps: parallel lines of sight see infinity as one point, and the count begins at what lies there{}: {}",
        |here, parts| {
            let is_behind = here.decided_by().counted_side() != Some(CountedSide::InFront);
            let is_there = here.frame.capture.camera.is_parallel() && is_behind && !here.is_of_sun();
            is_there && here.ends_as_reported(parts[0]) && parts[1] == "0" && here.triangles(DrawPart::DarkCap) == 0.0
        },
    ),
    ("dark caps, fans over the silhouettes at infinity{}: {}", |here, parts| {
        let is_there = here.frame.capture.camera.is_parallel()
            && here.decided_by().counted_side() != Some(CountedSide::InFront)
            && here.volumes().caps[1];
        !here.is_of_sun()
            && !is_there
            && here.ends_as_reported(parts[0])
            && number(parts[1]) == here.triangles(DrawPart::DarkCap)
    }),
    ("{} adds ({}, {}, {}) × (material × {} + highlight){}", |here, parts| {
        here.frame.plan.ambient_diffuse == 0.0 && adds(here, parts)
    }),
    ("{} adds ({}, {}, {}) × ({} × material × {} + highlight){}", |here, parts| {
        let share = here.frame.plan.ambient_diffuse;
        let (of_light, rest) = parts.split_at(4);
        share > 0.0 && is_near(rest[0], f64::from(1.0 - share)) && adds(here, &[of_light, &rest[1..]].concat())
    }),
    ("{} adds ({}, {}, {}) × {} × material × {}, whatever stands between{}", |here, parts| {
        let (of_light, rest) = parts.split_at(4);
        is_near(rest[0], here.frame.plan.ambient_diffuse.into()) && adds(here, &[of_light, &rest[1..]].concat())
    }),
    ("{} of {} pixels have {}: the test lets light through", |here, parts| {
        let before = here.step.checked_sub(1).and_then(|step| here.frame.capture.frame_at(step));
        let Some(before) = before.filter(|frame| frame.stencil.is_some()) else { return false };
        let bytes = stencil(before);
        let is_even = parts[2] == "an even number";
        let lit = bytes.iter().filter(|byte| if is_even { **byte % 2 == 0 } else { **byte == 0 }).count();
        let asks = if is_even {
            asks_stencil(here, 1)
        } else {
            parts[2] == "the count 0" && [0xff, 0xf, 3, 1].iter().any(|mask| asks_stencil(here, *mask))
        };
        asks && is_number(parts[0], lit) && is_number(parts[1], bytes.len())
    }),
    ("pixel {}, {}: its stencil was {} at this test, so {}", |here, parts| {
        let pixel = at(parts[0], parts[1]);
        let is_added = parts[3] == "light is added";
        let color = |step| here.frame.capture.frame_at(step).and_then(|frame| frame.color.image.rgba_at(pixel));
        let is_blocked = parts[3] == "the stencil test keeps light away" && color(here.step - 1) == color(here.step);
        let says = match here.frame.label(here.light(), pixel) {
            Some(0) => is_added,
            Some(1) => is_blocked,
            _ => is_added || is_blocked,
        };
        number(parts[2]) == f64::from(here.stencil_before(pixel)) && says
    }),
    ("pixel {}, {}: its stencil is {}, but the object receives no shadow, and light is added", |here, parts| {
        let pixel = at(parts[0], parts[1]);
        let has_one = here.frame.scene.objects.iter().any(|object| !object.receives);
        number(parts[2]) == f64::from(here.stencil_before(pixel))
            && here.frame.label(here.light(), pixel) == Some(0)
            && has_one
    }),
    ("pixel {}, {} reads texel {}", |here, parts| {
        here.map.is_some_and(|map| {
            let texel = parts[2].split(" of face").next().unwrap_or_default();
            let [x, y] = map.middle.texel.at;
            at(parts[0], parts[1]) == here.pick.expect("a pick") && texel == format!("{x}, {y}")
        })
    }),
    ("stored {}, this surface {}: {}", |here, parts| {
        here.map.is_some_and(|map| {
            let light = &here.frame.capture.lights[map.light];
            let faces = &light.map.as_ref().expect("a map").faces;
            let stored = faces[map.middle.texel.face].depth_at(map.middle.texel.at).expect("a depth");
            let clear = here.clear_depth();
            let first = |text: &str| text.split(' ').next().and_then(|number| number.parse::<f32>().ok());
            let is_stored = if stored == clear { parts[0] == "no caster" } else { first(parts[0]) == Some(stored) };
            let own = first(parts[1]).expect("a depth");
            let is_nearer = stored != clear && if clear == 0.0 { stored > own } else { stored < own };
            let label = here.frame.label(map.light, here.pick.expect("a pick"));
            let outcome = match parts[2] {
                "stored is nearer to the light: shadow" => is_nearer && label != Some(0),
                "stored is not nearer: lit" => !is_nearer && stored != clear && label != Some(1),
                "nothing is stored: lit" => stored == clear && label != Some(1),
                "too close to tell anew" => matches!(label, Some(0 | 1)),
                many => gaps("{} of {} hold nothing nearer: {}/{} lit", many).is_some_and(|parts| {
                    let lookup = here.frame.plan.lights[map.light].map.as_ref().and_then(|map| map.lookup);
                    let width = lookup.map_or(0, |how| how.filter_width);
                    let [lit, all, lit_again, all_again] = [0, 1, 2, 3].map(|gap| number(parts[gap]));
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
    ("{} lit, {} in shadow, {} background, {} faces away", |here, parts| {
        let labels = &labels(&here.frame.capture)[here.light()];
        (0..4).all(|label| is_number(parts[label], labels.iter().filter(|one| usize::from(**one) == label).count()))
    }),
    ("Choose the picture Truth or Error to hold it against rays.", |here, _| {
        here.frame.capture.lights[here.light()].truth.is_none()
    }),
    ("layer {} of {}: {}×{} texels", |here, parts| {
        let pass = here.frame.step(here.step).1;
        let color = pass.color.as_ref().map(|target| (target.attachment, target.layer));
        let target = color.or_else(|| pass.depth_stencil.as_ref().map(|target| (target.attachment, target.layer)));
        let (attachment, layer) = target.expect("a target");
        let attachment = here.frame.plan.attachment(attachment);
        let map = here.frame.plan.lights[here.light()].map.as_ref().expect("a map");
        // Faces that no caster shows in have no layer; the lesson counts them.
        let layers = map.faces.len();
        let own = number(parts[0]) - 1.0;
        let seen = map.faces.get(own as usize).copied().flatten();
        (seen == Some(pass.view) || own == f64::from(layer))
            && is_number(parts[1], layers)
            && [parts[2], parts[3]].map(number) == attachment.size.map(f64::from)
    }),
    ("1 m from the light a texel is {} mm wide, 10 m away {} mm", |here, parts| {
        let map = here.frame.plan.lights[here.light()].map.as_ref().expect("a map");
        let side = 2e3 / f64::from(here.frame.plan.attachment(map.attachment).size[0]);
        let is_cube = map.faces.len() == 6 && map.lookup.is_some();
        is_cube && is_near(parts[0], side) && is_near(parts[1], 10.0 * side)
    }),
    ("L = ({}, {}, {}, {}){}", |here, parts| {
        let light = here.frame.capture.lights[here.light()].position.to_array();
        let is_reported = (0..4).all(|axis| is_near(parts[axis], light[axis]));
        is_reported && parts[4] == if light[3] == 0.0 { ": a direction, as w = 0" } else { "" }
    }),
    ("{} flattened in {}, one for each receiver behind it", |here, parts| {
        let mut casters: Vec<&str> =
            here.draws(DrawPart::PlanarShadow).filter_map(|draw| draw.caster.as_deref()).collect();
        let draws = casters.len();
        casters.sort_unstable();
        casters.dedup();
        let is = |text: &str, count: usize, noun: &str| {
            is_number(text, count) && text.ends_with(&format!(" {noun}{}", if count == 1 { "" } else { "s" }))
        };
        is(parts[0], casters.len(), "caster") && is(parts[1], draws, "draw")
    }),
    ("{} pixels are marked", |here, parts| is_number(parts[0], here.bytes().iter().filter(|byte| **byte != 0).count())),
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

/// Two triangles at each of 3n/2 edges, or at each of 3n.
fn is_closed_or_prism((triangles, copies, sides): (usize, usize, usize)) -> bool {
    sides == 3 * triangles * copies && (1..=2).contains(&copies)
}

/// Does a light add this colour, times the material by its diffuse model, and does it fade as said? The parts are its name, its
/// red, green and blue, the diffuse term and the fading.
fn adds(here: &Here, parts: &[&str]) -> bool {
    let index = here.light();
    let light = &here.frame.scene.lights[index];
    let color = [0, 1, 2].map(|channel| is_near(parts[1 + channel], f64::from(light.color[channel] * light.intensity)));
    let wraps = here.frame.plan.wraps_diffuse;
    let diffuse = if wraps { "(1 + cosine of its angle) / 2" } else { "cosine of its angle" };
    let fades = light.range.is_some() && here.frame.capture.lights[index].position.w != 0.0;
    let fading = if fades { " × what is left at its distance" } else { "" };
    parts[0] == format!("light {}", index + 1) && color == [true; 3] && parts[4] == diffuse && parts[5] == fading
}

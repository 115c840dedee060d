//! What each pass is for, compared with its raster state, its programs and its targets.

use super::SeenPatterns;
use super::frames::Frame;
use super::patterns::{all_but, find, gaps, mask_of, matching};
use glam::{DVec3, DVec4};
use stencilscope::plan::{ColorWrite, Draw, DrawPart, Pass, PlanMap, Program, Visibility};
use stencilscope::technique::Technique;
use wgpu::{CompareFunction, StencilOperation as Operation};

type Check = fn(&Frame, &Pass, &[&str]) -> bool;

/// On which side of the surface a draw's faces count, and by how much: of the outside of the volume, and of its inside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Steps {
    pub is_in_front: bool,
    pub outside: i32,
    pub inside: i32,
}

/// `None` where it counts nowhere.
pub fn steps(draw: &Draw) -> Option<Steps> {
    let by = |operation| match operation {
        Operation::IncrementWrap | Operation::IncrementClamp => 1,
        Operation::DecrementWrap | Operation::DecrementClamp => -1,
        _ => 0,
    };
    let raster = &draw.raster;
    let (is_in_front, front, back) = if draw.program == Program::Count {
        let nearer = matches!(raster.depth_compare, CompareFunction::Greater | CompareFunction::GreaterEqual);
        let standard = matches!(raster.depth_compare, CompareFunction::Less | CompareFunction::LessEqual);
        assert!(nearer || standard, "{:?}", raster.depth_compare);
        let count = draw.constants.count as i32;
        // Of strict tests one is "nearer"; the complement of the other is true for equal depths.
        let is_strict = matches!(raster.depth_compare, CompareFunction::Greater | CompareFunction::Less);
        (is_strict, count, -count)
    } else {
        let [front, back] = [true, false].map(|is_front| *raster.face(is_front).0);
        let passing = [by(front.pass_op), by(back.pass_op)];
        let failing = [by(front.depth_fail_op), by(back.depth_fail_op)];
        match (passing, failing) {
            ([0, 0], [0, 0]) => return None,
            ([front, back], [0, 0]) => (true, front, back),
            ([0, 0], [front, back]) => (false, front, back),
            _ => panic!("{} counts on both sides", draw.name),
        }
    };
    let (outside, inside) = if draw.faces_inwards { (back, front) } else { (front, back) };
    Some(Steps { is_in_front, outside, inside })
}

fn counting(pass: &Pass) -> Vec<Steps> {
    pass.draws.iter().filter(|draw| draw.part.is_of_volume()).filter_map(steps).collect()
}

/// Do all that count do so here, up for one side and down for the other?
fn count_all(pass: &Pass, is_in_front: bool, up: bool, down: bool) -> bool {
    let wished = |one: &Steps| {
        let [up_by, down_by] = if is_in_front { [one.outside, one.inside] } else { [one.inside, one.outside] };
        one.is_in_front == is_in_front && (up_by, down_by) == (i32::from(up), -i32::from(down))
    };
    counting(pass).iter().all(wished)
}

/// Half of a count: what its faces do.
fn is_half(pass: &Pass, is_in_front: bool, text: &str) -> bool {
    let up = match (is_in_front, text) {
        (true, "a front face nearer than the surface adds 1") | (false, "a back face hidden by the surface adds 1") => {
            true
        }
        (true, "a back face nearer than it takes 1 away") | (false, "a hidden front face takes 1 away") => false,
        _ => return false,
    };
    count_all(pass, is_in_front, up, !up)
}

/// Is the other half before it?
fn is_second(frame: &Frame, pass: &Pass) -> bool {
    let is_half = |other: &&Pass| other.light == pass.light && other.name.starts_with("volumes, ");
    frame.plan.passes.iter().filter(is_half).position(|other| std::ptr::eq(other, pass)) == Some(1)
}

fn is_light(pass: &Pass, light: &str) -> bool {
    pass.light.is_some_and(|own| format!("light {}", own.0 + 1) == light)
}

/// All draws that light and test the stencil: for 0 in these bits.
fn tests_zero(pass: &Pass, bits: u32) -> bool {
    let tested = |draw: &&Draw| draw.raster.stencil.is_enabled();
    pass.draws.iter().filter(tested).all(|draw| {
        let (face, masks) = draw.raster.face(true);
        face.compare == CompareFunction::Equal && u32::from(masks.read) & 0xff == bits && masks.reference == 0
    })
}

/// Does a volume's draw invert one bit on this side of the surface, and nothing on the other?
fn turns_over(draw: &Draw, is_in_front: bool) -> bool {
    [true, false].into_iter().all(|is_front| {
        let (face, masks) = draw.raster.face(is_front);
        let [here, there] =
            if is_in_front { [face.pass_op, face.depth_fail_op] } else { [face.depth_fail_op, face.pass_op] };
        (here, there, masks.write) == (Operation::Invert, Operation::Keep, 1)
    })
}

/// Where the first pass of its light begins to count, if not at nothing.
fn cleared_to(frame: &Frame, pass: &Pass) -> u32 {
    let counts = |other: &&Pass| {
        other.light == pass.light && other.view.0 == 0 && other.draws.iter().any(|draw| draw.part.is_of_volume())
    };
    let Some(first) = frame.plan.passes.iter().find(counts) else { return 0 };
    let stencil = first.depth_stencil.as_ref().and_then(|target| target.clear_stencil).map(u32::from);
    let float = first.color.as_ref().and_then(|target| target.clear).map(|clear| clear[0] as u32);
    if first.draws.iter().any(|draw| draw.program == Program::Count) { float } else { stencil }.unwrap_or(0)
}

/// Does a count begin at the casting triangles that the light's ray along the parallel view rays hits?
fn begins_at_far_end(frame: &Frame, pass: &Pass, bits: u8) -> bool {
    let eye = frame.scene.camera.relative_eye();
    let light = pass.light.expect("a light").0;
    let [x, y, z, w] = frame.plan.lights[light].relative_position.map(f64::from);
    let (light, along) = (DVec3::new(x, y, z), -eye.truncate());
    let meets = |corners: [DVec3; 3]| {
        let [a, b, c] = corners.map(|corner| corner - light);
        let sides = [(a, b), (b, c), (c, a)].map(|(p, q)| p.cross(q).dot(along) > 0.0);
        let normal = (b - a).cross(c - a);
        (sides == [true; 3] || sides == [false; 3]) && normal.dot(a) / normal.dot(along) > 0.0
    };
    let caps = pass.draws.iter().filter(|draw| draw.part.includes(DrawPart::LightCap));
    let hit = caps.flat_map(|draw| {
        let mesh = &frame.plan.meshes[draw.mesh.0];
        let corners = &mesh.indices.data()[draw.triangles.start as usize * 3..draw.triangles.end as usize * 3];
        let place = |index: u32| DVec4::from_array(mesh.vertices.data()[index as usize].map(f64::from)).truncate();
        corners.chunks_exact(3).map(move |corners| [0, 1, 2].map(|corner| place(corners[corner]))).collect::<Vec<_>>()
    });
    let hit = hit.filter(|corners| meets(*corners)).count() as u32;
    let is_in_bits = |draw: &Draw| draw.program == Program::Count || draw.raster.face(true).1.write == bits;
    let counts_float = pass.draws.iter().any(|draw| draw.program == Program::Count);
    let start_count = if counts_float { hit } else { hit & u32::from(bits) };
    eye.w == 0.0
        && w == 1.0
        && cleared_to(frame, pass) == start_count
        && start_count > 0
        && pass.draws.iter().all(is_in_bits)
}

/// What follows of what a count is said to begin at; `None` where that is not so.
fn begins<'t>(frame: &Frame, pass: &Pass, text: &'t str) -> Option<&'t str> {
    let cleared = cleared_to(frame, pass);
    let (start, is_so, rest) = if let Some(parts) = gaps("It begins at {}, for the volumes around {}. {}", text) {
        let starts_at_eye = frame.starts_at_eye();
        let place = if frame.scene.camera.is_parallel() { "the middle of the near plane" } else { "the eye" };
        (parts[0], starts_at_eye && parts[1] == place, parts[2])
    } else if let Some(parts) = gaps(
        "It begins at {}: parallel lines of sight all end at one point at infinity, in the volumes of so many casting triangles, those that a ray from {} along them meets. {}",
        text,
    ) {
        let (start, bits) =
            parts[0].split_once(" in ").map_or((parts[0], u8::MAX), |(start, bits)| (start, mask_of(bits)));
        (start, is_light(pass, parts[1]) && begins_at_far_end(frame, pass, bits), parts[2])
    } else {
        return (cleared == 0).then_some(text);
    };
    (is_so && start.parse() == Ok(cleared)).then_some(rest)
}

/// What a count says in the end.
fn is_left(frame: &Frame, pass: &Pass, text: &str) -> bool {
    let Some(rest) = begins(frame, pass, text) else { return false };
    let [one_side, is_plus] = [rest.starts_with("What is left"), frame.plan.technique == Technique::ZPassPlus.name()];
    let kinds = [
        ("What is left is the number of volumes that contain the surface{}.", one_side && !is_plus),
        (
            "With what the near plane began with, if anything, what is left is the number of volumes that contain the surface{}.",
            is_plus,
        ),
        (
            "Either way, what is left is the number of volumes that contain the surface{}.",
            frame.plan.technique == Technique::Auto.name(),
        ),
    ];
    kinds
        .iter()
        .any(|(pattern, is_so)| *is_so && gaps(pattern, rest).is_some_and(|parts| is_so_where(frame, pass, parts[0])))
}

/// On what that hangs: the eye, the near plane, and caps that are not drawn.
fn is_so_where(frame: &Frame, pass: &Pass, text: &str) -> bool {
    let (eye, caps) = text.split_once("; ").unwrap_or((text, ""));
    let [is_z_pass, is_auto] =
        [Technique::ZPass, Technique::Auto].map(|technique| frame.plan.technique == technique.name());
    let starts_at_eye = frame.starts_at_eye();
    let is_parallel = frame.scene.camera.is_parallel();
    let is_eye_so = match eye {
        ", if the eye itself is in none" => is_z_pass && !starts_at_eye && !is_parallel,
        ", if the near plane is in none" => is_z_pass && !starts_at_eye && is_parallel,
        ", as the near plane is in none" => is_auto && is_parallel && counting(pass).iter().all(|one| one.is_in_front),
        ", if the near plane cuts none" => is_z_pass && starts_at_eye,
        ", as neither the eye nor the near plane is in any" => {
            is_auto && !is_parallel && counting(pass).iter().all(|one| one.is_in_front)
        }
        ", wherever the eye is" => !is_z_pass,
        _ => false,
    };
    let lacks = match caps {
        "" => [false; 2],
        "but no light cap is drawn, and where one lies on that side the count is wrong" => [true, false],
        "but no dark cap is drawn, and where one lies on that side the count is wrong" => [false, true],
        "but no cap is drawn, and where one lies on that side the count is wrong" => [true, true],
        _ => return false,
    };
    let own = || frame.plan.passes.iter().filter(|other| other.light == pass.light && other.view.0 == 0);
    let is_drawn = [DrawPart::LightCap, DrawPart::DarkCap]
        .map(|part| own().any(|pass| pass.draws.iter().any(|draw| draw.part.includes(part))));
    // Behind surfaces all volumes need a light cap, and those whose sides do not end in one point a dark one.
    let light = pass.light.expect("a light").0;
    let is_behind =
        counting(pass).iter().any(|one| !one.is_in_front) || pass.draws.iter().any(|d| turns_over(d, false));
    let is_point = frame.scene.lights[light].homogeneous().w != 0.0;
    // Parallel view rays see it as a point.
    let is_needed = [is_behind, is_behind && is_point && !is_parallel];
    is_eye_so
        && [0, 1]
            .into_iter()
            .all(|cap| !(lacks[cap] && is_drawn[cap]) && (lacks[cap] || is_drawn[cap] || !is_needed[cap]))
}

/// Does each face on this side turn the bit over, and is what follows of that so?
fn is_odd_or_even(frame: &Frame, pass: &Pass, parts: &[&str], is_in_front: bool) -> bool {
    is_light(pass, parts[0])
        && pass.draws.iter().all(|draw| turns_over(draw, is_in_front))
        && begins(frame, pass, parts[1]) == Some("")
        && is_so_where(frame, pass, parts[2])
}

/// Do all faces count on this side, and is the text right about what is left of them?
fn is_whole(frame: &Frame, pass: &Pass, parts: &[&str], is_in_front: bool) -> bool {
    is_light(pass, parts[0]) && count_all(pass, is_in_front, true, true) && is_left(frame, pass, parts[1])
}

fn is_first_half(frame: &Frame, pass: &Pass, parts: &[&str], is_in_front: bool) -> bool {
    is_light(pass, parts[0]) && is_half(pass, is_in_front, parts[1]) && !is_second(frame, pass)
}

fn is_second_half(frame: &Frame, pass: &Pass, parts: &[&str], is_in_front: bool) -> bool {
    let is_so = is_half(pass, is_in_front, parts[1]) && is_left(frame, pass, parts[2]);
    is_light(pass, parts[0]) && is_so && is_second(frame, pass)
}

fn asks(pass: &Pass, how: Visibility) -> bool {
    pass.draws.iter().all(|draw| [Program::Light(how), Program::Light(Visibility::Everywhere)].contains(&draw.program))
}

fn is_even_marked(pass: &Pass) -> bool {
    let marks: Vec<u8> = pass.draws.iter().map(|draw| draw.raster.stencil_reference).collect();
    let mut own = marks.clone();
    own.dedup();
    pass.draws.iter().all(|draw| draw.part == DrawPart::Receiver)
        && own.len() == marks.len()
        && marks.iter().all(|mark| mark % 2 == 0)
}

fn map_of<'a>(frame: &'a Frame, pass: &Pass) -> Option<&'a PlanMap> {
    frame.plan.lights[pass.light.expect("a light").0].map.as_ref()
}

fn sees_from_the_light(frame: &Frame, pass: &Pass) -> bool {
    pass.view.0 != 0 && pass.draws.iter().all(|draw| draw.part == DrawPart::Map) && map_of(frame, pass).is_some()
}

fn holds_depth(frame: &Frame, pass: &Pass) -> bool {
    let reads_depth = map_of(frame, pass).is_some_and(|map| map.lookup.is_some());
    sees_from_the_light(frame, pass) && reads_depth && pass.color.is_none()
}

fn holds_color(frame: &Frame, pass: &Pass) -> bool {
    let reads_color = map_of(frame, pass).is_some_and(|map| map.lookup.is_none());
    sees_from_the_light(frame, pass) && reads_color && pass.color.is_some()
}

/// Is the light's map there where its pass says that it is read?
fn has_map(frame: &Frame, pass: &Pass) -> bool {
    map_of(frame, pass).is_some()
}

const PURPOSES: &[(&str, Check)] = &[
    (
        "Draws every surface in ambient light only, and leaves in the depth buffer how far the nearest one is: all later passes ask about that surface.",
        |_, pass, _| {
            let is_ambient = |draw: &Draw| matches!(draw.program, Program::Ambient { .. }) && draw.raster.depth_write;
            pass.light.is_none() && pass.draws.iter().all(is_ambient)
        },
    ),
    (
        "Counts the shadow volumes of {} in front of each surface: a front face nearer than the surface adds 1, a back face nearer than it takes 1 away. {}",
        |frame, pass, parts| is_whole(frame, pass, parts, true),
    ),
    (
        "Counts the shadow volumes of {} behind each surface: a back face hidden by the surface adds 1, a hidden front face takes 1 away. {}",
        |frame, pass, parts| is_whole(frame, pass, parts, false),
    ),
    (
        "Counts the shadow volumes of {}, behind each surface where they may hold {}, else in front of it: in front, a front face adds 1 and a back face takes 1 away, behind, it is the other way round. {}",
        |frame, pass, parts| {
            let counting = counting(pass);
            let [front, behind] = [true, false].map(|side| counting.iter().any(|one| one.is_in_front == side));
            let is_right = |one: &Steps| (one.outside, one.inside) == if one.is_in_front { (1, -1) } else { (-1, 1) };
            let are_right = counting.iter().all(is_right);
            let place = if frame.scene.camera.is_parallel() { "the near plane" } else { "the eye" };
            let is_so = front && behind && are_right && parts[1] == place;
            is_light(pass, parts[0]) && is_so && is_left(frame, pass, parts[2])
        },
    ),
    (
        "Counts the shadow volumes of {} in front of each surface, first half: {}. The other faces follow in a pass of their own.",
        |frame, pass, parts| is_first_half(frame, pass, parts, true),
    ),
    ("Counts the shadow volumes of {} in front of each surface, second half: {}. {}", |frame, pass, parts| {
        is_second_half(frame, pass, parts, true)
    }),
    (
        "Counts the shadow volumes of {} behind each surface, first half: {}. The other faces follow in a pass of their own.",
        |frame, pass, parts| is_first_half(frame, pass, parts, false),
    ),
    ("Counts the shadow volumes of {} behind each surface, second half: {}. {}", |frame, pass, parts| {
        is_second_half(frame, pass, parts, false)
    }),
    (
        "Counts how many shadow volumes of {} contain each point of the near plane: every casting triangle between it and the light adds 1, drawn as the light sees it through the near rectangle.",
        |_, pass, parts| is_light(pass, parts[0]) && pass.counts_at_near_plane() && pass.view.0 != 0,
    ),
    (
        "Writes what this technique says of the light at every pixel: lit, in shadow, or facing away. It is not part of the frame; it is how techniques are compared.",
        |_, pass, _| {
            let labels = |draw: &Draw| matches!(draw.program, Program::Label(_) | Program::FlatLabel);
            !pass.timed && pass.draws.iter().all(labels)
        },
    ),
    (
        "Writes which share of the light arrives at every pixel, from 0 (dark) to 1 (lit): between them lie soft edges, and what a filter mixes in. It is not part of the frame; by it the error of partly dark pixels is counted, too.",
        |frame, pass, _| {
            let arriving = |draw: &Draw| match draw.program {
                Program::Arriving(how) => {
                    let light = pass.light.and_then(|light| frame.plan.lights.get(light.0));
                    how == Visibility::Everywhere || light.is_some_and(|light| light.knows_shares(how))
                }
                _ => false,
            };
            !pass.timed && pass.draws.iter().all(arriving)
        },
    ),
    (
        "Adds the light where the count is zero, and raises the count there, so that no pixel is lit twice. Everywhere else the surface is inside a shadow volume and stays dark.",
        |_, pass, _| tests_zero(pass, 0xff) && pass.draws.iter().all(raises) && asks(pass, Visibility::Everywhere),
    ),
    (
        "Adds the light where the count is zero, and leaves it so: surfaces that lie in one plane are lit each. Everywhere else the surface is inside a shadow volume and stays dark.",
        |_, pass, _| {
            // What receives none is not tested, and raises nothing.
            let tested = |draw: &&Draw| draw.raster.stencil.is_enabled();
            let leaves_it = !pass.draws.iter().filter(tested).any(raises);
            tests_zero(pass, 0xff) && leaves_it && asks(pass, Visibility::Everywhere)
        },
    ),
    (
        "Adds the light where the count is zero in {}, and raises the count there, so that no pixel is lit twice. Everywhere else the surface is inside a shadow volume and stays dark.",
        |frame, pass, parts| {
            let mask = mask_of(parts[0]);
            let writes =
                frame.plan.passes.iter().filter(|other| other.light == pass.light).flat_map(|other| &other.draws);
            let mut writes = writes.filter(|draw| draw.part.is_of_volume());
            tests_zero(pass, mask.into())
                && writes.all(|draw| draw.raster.face(true).1.write == mask)
                && asks(pass, Visibility::Everywhere)
        },
    ),
    (
        "Counts the shadow volumes of {} in front of each surface, odd or even: every face nearer than it turns one bit over. {}1 is left where an odd number of volumes contains the surface, and an even one reads as none{}.",
        |frame, pass, parts| is_odd_or_even(frame, pass, parts, true),
    ),
    (
        "Counts the shadow volumes of {} behind each surface, odd or even: every face hidden by the surface turns one bit over. {}1 is left where an odd number of volumes contains the surface, and an even one reads as none{}.",
        |frame, pass, parts| is_odd_or_even(frame, pass, parts, false),
    ),
    (
        "Counts how many shadow volumes of {} contain each point of the near plane: every casting triangle between it and the light turns the bit over, drawn as the light sees it through the near rectangle.",
        |_, pass, parts| {
            let inverts = |draw: &Draw| draw.raster.face(true).0.pass_op == Operation::Invert;
            is_light(pass, parts[0])
                && pass.counts_at_near_plane()
                && pass.view.0 != 0
                && pass.draws.iter().all(inverts)
        },
    ),
    (
        "Draws the caster as the light sees it, in a frame that is alike for all casters: not how far it is, but how much light it lets through.",
        |frame, pass, _| holds_color(frame, pass) && frame.plan.settings.get("fit").is_some_and(|fit| fit == "off"),
    ),
    (
        "Adds the light where the count is zero. Everywhere else the surface is inside a shadow volume and stays dark.",
        |_, pass, _| asks(pass, Visibility::Count),
    ),
    ("Adds the light everywhere: nothing asks whether something stands between.", |_, pass, _| {
        asks(pass, Visibility::Everywhere)
    }),
    (
        "Marks the visible pixels of each flat receiver with an even number of its own, so that no shadow can leave its receiver.",
        |_, pass, _| is_even_marked(pass),
    ),
    (
        "Draws every caster, flattened onto each receiver's plane. Where the stencil still has the receiver's mark it goes up by one: overlapping triangles can't darken a pixel twice.",
        |_, pass, _| {
            pass.draws.iter().all(|draw| {
                let (face, masks) = draw.raster.face(true);
                let once = face.compare == CompareFunction::Equal && face.pass_op == Operation::IncrementClamp;
                draw.part == DrawPart::PlanarShadow && once && masks.reference % 2 == 0
            })
        },
    ),
    (
        "Adds the light where the stencil is even: odd numbers are shadows. It makes lit numbers odd, so that no pixel is lit twice.",
        |_, pass, _| tests_zero(pass, 1) && asks(pass, Visibility::Everywhere),
    ),
    ("Adds the light everywhere: shadows are blended over it afterwards.", |frame, pass, _| {
        let at = frame.plan.passes.iter().position(|one| std::ptr::eq(one, pass)).expect("a pass of it");
        let flattens = |pass: &Pass| pass.draws.iter().any(|draw| draw.part == DrawPart::PlanarShadow);
        let before = frame.plan.passes[..at].iter().any(|one| one.light == pass.light && flattens(one));
        asks(pass, Visibility::Everywhere) && !before
    }),
    (
        "Draws every caster, flattened onto each receiver's plane, and darkens what is there: once for every triangle that covers a pixel, and what other lights gave as well.",
        |_, pass, _| pass.draws.iter().all(|draw| draw.part == DrawPart::PlanarShadow && draw.program == Program::Flat),
    ),
    (
        "Draws every caster, flattened onto each receiver's plane, in black over what is there: ambient light and what other lights gave are gone as well.",
        |_, pass, _| {
            let is_black =
                |draw: &Draw| draw.raster.color == ColorWrite::Replace && draw.constants.flat[..3] == [0.0; 3];
            pass.draws.iter().all(|draw| draw.part == DrawPart::PlanarShadow && is_black(draw))
        },
    ),
    (
        "Draws the casters between this receiver and the light through the box that the light's pyramid over the receiver becomes: their picture is the shadow on it.",
        |frame, pass, _| holds_color(frame, pass),
    ),
    (
        "Adds the light as far as the receiver's texture lets it through. Surfaces that are not flat have none, and are lit as if nothing stood between.",
        |frame, pass, _| has_map(frame, pass) && asks(pass, Visibility::ReceiverTexture),
    ),
    ("Adds the light everywhere: no flat receiver has a shadow of it that shows.", |frame, pass, _| {
        !has_map(frame, pass) && asks(pass, Visibility::Everywhere)
    }),
    (
        "Draws the casters as the light sees them and keeps only how far they are: what lies behind them, seen from the light, is in shadow.",
        |frame, pass, _| holds_depth(frame, pass),
    ),
    (
        "Adds the light, carrying every fragment into the light's map: where the map holds something nearer to the light, the fragment is in shadow and gets nothing.",
        |frame, pass, _| has_map(frame, pass) && asks(pass, Visibility::Map),
    ),
    ("Adds the light everywhere: no caster can darken anything, and there is no map.", |frame, pass, _| {
        !has_map(frame, pass) && asks(pass, Visibility::Everywhere)
    }),
    (
        "Draws the caster as the light sees it, in a frame that fits it: not how far it is, but how much light it lets through.",
        |frame, pass, _| holds_color(frame, pass),
    ),
    ("Adds the light, as far as the silhouettes on its way let it through.", |_, pass, _| {
        asks(pass, Visibility::Projected)
    }),
    (
        "Adds a share of the light's diffuse light to every surface that faces it, whatever stands between: shadows keep some of the shape of what they fall on.",
        |frame, pass, _| {
            let share = frame.plan.ambient_diffuse;
            let is_share =
                |draw: &Draw| draw.program == Program::AmbientDiffuse && draw.constants.material.specular == 0.0;
            share > 0.0 && pass.draws.iter().all(is_share)
        },
    ),
    ("Adds the light everywhere: no silhouette is on its way.", |_, pass, _| asks(pass, Visibility::Everywhere)),
    ("Adds the light everywhere: silhouettes darken it afterwards.", |_, pass, _| asks(pass, Visibility::Everywhere)),
    (
        "Draws what is visible again and darkens it where this silhouette falls, with what ambient and other lights gave as well.",
        |_, pass, _| pass.draws.iter().all(|draw| draw.program == Program::Through),
    ),
    (
        "Follows a ray from the eye through every pixel to the surface it meets, and one from the light to that point: whatever lies between keeps the light away. This is done on the CPU.",
        |_, pass, _| pass.image.is_some() && pass.draws.is_empty(),
    ),
    (
        "Adds the light where its rays arrived, nothing elsewhere, and raises the stencil at all of these pixels, so that none is lit twice.",
        |_, pass, _| asks(pass, Visibility::Labels) && pass.draws.iter().all(raises),
    ),
];

pub fn patterns() -> Vec<&'static str> {
    // In no built-in scene does a light without casters that darken reach this.
    let rare = ["no caster can darken anything", "no flat receiver has a shadow", "no silhouette is on its way"];
    all_but(&rare, &[PURPOSES])
}

pub fn check(frame: &Frame, seen: &mut SeenPatterns) -> Vec<String> {
    let wrong = |pass: &Pass| {
        let known = matching(PURPOSES, &pass.purpose).take(1);
        let wrong = find(known, &pass.purpose, seen, |check, parts| check(frame, pass, parts))?;
        Some(format!("the purpose of {} {wrong}", pass.name))
    };
    frame.plan.passes.iter().filter_map(wrong).collect()
}

/// What is lit is marked in the stencil, where the draw has one.
fn raises(draw: &Draw) -> bool {
    !draw.raster.stencil.is_enabled() || draw.raster.face(true).0.pass_op == Operation::IncrementClamp
}

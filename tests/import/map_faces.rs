//! A light's map in one layer, in an atlas, and in textures of its own: a recording's, arranged anew.

use super::shared::recording;
use std::sync::Arc;
use stencilscope::capture::{Image, PixelFormat};
use stencilscope::glam::DVec4;
use stencilscope::import::{ConvertedFrame, RawContents, RawEvent, RawFrame, RawKind, RawTarget, convert, read};
use stencilscope::plan::LightId;

/// The recording, and the index of its map's texture.
fn recorded() -> (RawFrame, usize) {
    let frame = read(&recording("pygfx")).expect("a recording");
    let is_map = |event: &&RawEvent| matches!(event.kind, RawKind::Draw(_)) && event.color_targets.is_empty();
    let map = frame.events.iter().find(is_map).and_then(|event| event.depth_target).expect("a map");
    (frame, map.texture)
}

/// The events that change the map, or draw into it.
fn of_map(frame: &RawFrame, map: usize) -> Vec<RawEvent> {
    let is_of_map = |event: &&RawEvent| event.depth_target.is_some_and(|target| target.texture == map);
    frame.events.iter().filter(is_of_map).cloned().collect()
}

/// Two depth images of one size, the second right of the first (axis 0) or below it.
fn beside(axis: usize, first: &Image, second: &Image) -> Arc<Image> {
    let mut size = first.size();
    size[axis] *= 2;
    let bytes: Vec<u8> = match axis {
        0 => first.rows().zip(second.rows()).flat_map(|(left, right)| [left, right].concat()).collect(),
        _ => first.rows().chain(second.rows()).flatten().copied().collect(),
    };
    Arc::new(Image::packed(PixelFormat::Depth32F, size, bytes))
}

/// How a second view of the map's meshes differs from the first: by what its corners get.
type Change = fn(&mut [f32; 4]);

/// The same light sees half as much, as in the next finer cascade.
const FINER: Change = |corner| {
    corner[0] *= 2.0;
    corner[1] *= 2.0;
};
/// Sheared, so that the light stands in another direction.
const ELSEWHERE: Change = |corner| corner[0] += 0.4 * corner[2];
const SAME: Change = |_| ();

fn change(event: &mut RawEvent, change: Change) {
    if let RawKind::Draw(draw) = &mut event.kind {
        draw.positions.iter_mut().for_each(change);
    }
}

/// Makes the map the right or lower half of a texture of twice its width or height, whose other half holds the same meshes in
/// another view.
fn in_atlas(axis: usize, second: Change) -> RawFrame {
    let (mut frame, map) = recorded();
    let size = frame.textures[map].size;
    let clear = Image::uniform(PixelFormat::Depth32F, size, &1.0_f32.to_le_bytes());
    let mut again = of_map(&frame, map);
    let mut last = Arc::new(clear.clone());
    for event in frame.events.iter_mut().filter(|event| event.depth_target.is_some_and(|at| at.texture == map)) {
        if let RawKind::Draw(draw) = &mut event.kind {
            draw.view.viewport[axis] += size[axis] as f32;
            if let Some(scissor) = &mut draw.view.scissor {
                scissor[axis] += size[axis] as i32;
            }
        }
        if let Some(depth) = event.after.depth.take() {
            event.after.depth = Some(beside(axis, &clear, &depth));
            last = depth;
        }
    }
    let after_map = frame.events.iter().rposition(|event| event.depth_target.is_some_and(|at| at.texture == map));
    again.retain(|event| matches!(event.kind, RawKind::Draw(_)));
    for event in &mut again {
        event.id += 100_000;
        event.after.depth = event.after.depth.take().map(|depth| beside(axis, &depth, &last));
        change(event, second);
    }
    let at = after_map.expect("events of the map") + 1;
    frame.events.splice(at..at, again);
    frame.before.retain(|(target, _)| target.texture != map);
    frame.textures[map].size[axis] *= 2;
    frame
}

/// Adds a second texture of the map's meshes in another view, which is sampled with the first.
fn in_two_textures(view: Change) -> RawFrame {
    let (mut frame, map) = recorded();
    let second = frame.textures.len();
    frame.textures.push(frame.textures[map].clone());
    let mut again = of_map(&frame, map);
    for event in &mut again {
        event.id += 100_000;
        event.depth_target = event.depth_target.map(|target| RawTarget { texture: second, ..target });
        change(event, view);
    }
    let at = frame.events.iter().rposition(|event| event.depth_target.is_some_and(|at| at.texture == map));
    let at = at.expect("events of the map") + 1;
    for event in &mut frame.events[at..] {
        if let RawKind::Draw(draw) = &mut event.kind
            && let Some(sampled) = draw.sampled.as_mut().filter(|sampled| sampled.contains(&map))
        {
            sampled.push(second);
        }
    }
    frame.events.splice(at..at, again);
    let before = frame.before.iter().filter(|(target, _)| target.texture == map);
    let before: Vec<(RawTarget, RawContents)> =
        before.map(|(target, contents)| (RawTarget { texture: second, ..*target }, contents.clone())).collect();
    frame.before.extend(before);
    frame
}

fn converted(frame: &RawFrame) -> ConvertedFrame {
    convert(frame, "pygfx").expect("a frame")
}

fn light_of(converted: &ConvertedFrame) -> DVec4 {
    converted.lights[0].expect("a light").position
}

#[test]
fn viewports_of_an_atlas_and_textures_that_one_light_draws_are_faces_of_its_map() {
    let alone = converted(&recorded().0);
    let stored = &alone.capture.lights[0].map.as_ref().expect("a map").faces[0];
    let arranged =
        [("columns", in_atlas(0, FINER)), ("rows", in_atlas(1, FINER)), ("textures", in_two_textures(FINER))];
    for (name, frame) in arranged {
        let found = converted(&frame);
        assert_eq!(found.lights.len(), 1, "{name}: {:?}", found.lights);
        assert!(light_of(&found).distance(light_of(&alone)) < 1e-6, "{name}: {:?}", found.lights);
        let map = found.capture.lights[0].map.as_ref().expect("a map");
        assert_eq!(map.faces.len(), 2, "{name}");
        assert!(map.faces.iter().all(|face| face == stored), "{name}: each face holds what the map alone does");
        // The first that is drawn is the recording's own view.
        let apart = [0, 1].map(|face| map.clip_from_light[face].to_cols_array());
        let alone = alone.capture.lights[0].map.as_ref().expect("a map").clip_from_light[0].to_cols_array();
        let is_near = |one: &[f64; 16]| one.iter().zip(alone).all(|(one, other)| (one - other).abs() < 1e-4);
        assert_eq!(apart.each_ref().map(is_near), [true, false], "{name}");
        let attachment = found.plan.attachment(found.plan.lights[0].map.as_ref().expect("a map").attachment);
        assert_eq!((attachment.layers, attachment.size), (2, stored.size()), "{name}");
    }
}

/// What is below a viewport is not read with it: a part is the same as the whole of a texture of its size.
#[test]
fn a_map_that_is_a_part_of_its_texture_is_read_as_if_alone() {
    let alone = converted(&recorded().0);
    for axis in [0, 1] {
        let mut frame = in_atlas(axis, SAME);
        // The other half is never drawn into.
        frame.events.retain(|event| event.id < 100_000);
        let found = converted(&frame);
        assert_eq!(found.lights.len(), 1, "{:?}", found.lights);
        assert_eq!(found.capture.lights[0].shadow, alone.capture.lights[0].shadow, "axis {axis}");
        assert_eq!(found.capture.lights[0].map, alone.capture.lights[0].map, "axis {axis}");
    }
}

#[test]
fn viewports_of_an_atlas_that_two_lights_draw_are_two_maps() {
    let found = converted(&in_atlas(0, ELSEWHERE));
    let [Some(one), Some(other)] = found.lights[..] else { panic!("{:?}", found.lights) };
    let angle = one.position.truncate().angle_between(other.position.truncate()).to_degrees();
    assert!(angle > 5.0 && one.position.w == 0.0 && other.position.w == 0.0, "{angle}: {:?}", found.lights);
    for light in &found.capture.lights {
        assert_eq!(light.map.as_ref().expect("a map").faces.len(), 1);
    }
    assert_eq!(found.scene.expect("a scene").lights.len(), 2);
}

/// Two maps of one view are no cascades: neither is read in place of the other, and that is said.
#[test]
fn maps_of_one_view_are_read_each_by_itself() {
    let found = converted(&in_two_textures(SAME));
    assert_eq!(found.lights.len(), 2, "{:?}", found.lights);
    let limits = &found.capture.origin.expect("an origin").limits;
    assert!(limits.iter().any(|limit| limit.contains("light 1 and light 2 are in one place")), "{limits:?}");
}

#[test]
fn draws_say_which_maps_they_sample() {
    let found = converted(&recorded().0);
    let is_lit = |draw: &&stencilscope::plan::Draw| draw.samples_maps_of == [LightId(0)];
    let of = |is_of_picture: bool| {
        let passes = found.plan.passes.iter().filter(move |pass| (pass.name != "map") == is_of_picture);
        passes.flat_map(|pass| &pass.draws).filter(is_lit).count()
    };
    assert!(of(true) >= 3 && of(false) == 0, "{}", found.plan);
    assert!(found.plan.to_string().contains("samples the map of light 1"), "{}", found.plan);
}

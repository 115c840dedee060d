//! Pictures on surfaces: the colour changes by the texel that a ray hits, and nothing else of a frame does.

mod files;

use crate::common::shade::{linear, shaded, srgb};
use crate::common::{adapter, last_frame, opened, pixels, request, session};
use glam::{DVec3, Vec2};
use std::path::Path;
use std::sync::Arc;
use stencilscope::capture::disk::{read_whole, write};
use stencilscope::plan::{Blob, FramePlan};
use stencilscope::reading::pick_ray::ray;
use stencilscope::scene::{
    Camera, Light, Material, MaterialTexture, Mesh, MeshBuilder, Object, Projection, Scene, SceneBuilder, Shading,
    TextureImage, obj, shapes,
};
use stencilscope::session::CaptureRequest;
use stencilscope::technique::{Choice, Technique};
use stencilscope::testing::{PixelLabel, Rendered};

const SIZE: [u32; 2] = [96, 72];

fn picture(size: [u32; 2], of: impl Fn(u32, u32) -> [u8; 3]) -> Arc<TextureImage> {
    let texels = pixels(size).map(|[x, y]| of(x, y)).map(|[r, g, b]| [r, g, b, 255]).collect();
    Arc::new(TextureImage::new("a picture", size, texels).expect("a picture"))
}

/// Red grows to the right and green to the top.
fn ramp() -> Arc<TextureImage> {
    picture([256, 256], |x, y| [x as u8, 255 - y as u8, 90])
}

fn along_world(picture: &Arc<TextureImage>, side: f32) -> Option<MaterialTexture> {
    Some(MaterialTexture { picture: picture.clone(), side: Some(side), clamps: false })
}

/// A slanted board whose corners say where they lie in a picture: all of it, three times as wide as high.
fn slanted() -> Mesh {
    let uvs = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Vec2::from_array);
    let builder = MeshBuilder {
        positions: [[-3.0, 0.0, 1.0], [3.0, 0.0, 1.0], [3.0, 2.0, -6.0], [-3.0, 2.0, -6.0]].map(DVec3::from).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        corner_uvs: [[0, 1, 2], [0, 2, 3]].map(|corners| Some(corners.map(|corner| uvs[corner]))).to_vec(),
        ..MeshBuilder::default()
    };
    builder.build().expect("a board")
}

fn on_board(picture: &Arc<TextureImage>) -> Object {
    let texture = Some(MaterialTexture { picture: picture.clone(), side: None, clamps: false });
    Object { texture, ..Object::new("board", Arc::new(slanted()), Material::matte([1.0; 3])) }
}

fn rendered(scene: &Scene, technique: Technique) -> Rendered {
    Rendered::new(scene, Choice::new(technique), SIZE).expect("a frame")
}

fn last_color(frame: &Rendered, at: [u32; 2]) -> [u8; 4] {
    last_frame(frame.capture()).color.image.rgba_at(at).expect("a pixel")
}

fn asset(path: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(path).display().to_string()
}

fn pattern() -> Scene {
    opened(&asset("scenes/pattern.toml"))
}

/// The plan with every picture taken off.
fn bare(plan: &FramePlan) -> FramePlan {
    let mut plan = plan.clone();
    plan.textures.clear();
    let surfaces = plan.meshes.iter_mut().filter_map(|mesh| mesh.surface.as_mut());
    surfaces.for_each(|surface| surface.uvs = None);
    plan.passes.iter_mut().flat_map(|pass| &mut pass.draws).for_each(|draw| draw.constants.texture = None);
    plan.passes.iter_mut().for_each(|pass| pass.image = None);
    plan
}

/// The scene with every picture taken off.
fn plain(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    for object in &mut scene.objects {
        object.texture = None;
        let mut groups = object.mesh.groups().to_vec();
        groups.iter_mut().for_each(|group| group.texture = None);
        let builder = MeshBuilder {
            positions: object.mesh.positions().to_vec(),
            triangles: object.mesh.triangles().to_vec(),
            corner_normals: object.mesh.corner_normals().map_or_else(Vec::new, <[_]>::to_vec),
            groups,
            ..MeshBuilder::default()
        };
        object.mesh = Arc::new(builder.build().expect("the same mesh"));
    }
    scene
}

#[test]
fn seams_of_a_picture_split_no_vertex() {
    let crate_of_eight = obj::load(Path::new(&asset("models/crate.obj"))).expect("a crate");
    assert_eq!((crate_of_eight.positions().len(), crate_of_eight.triangles().len()), (8, 12));
    let uvs = crate_of_eight.corner_uvs().expect("places");
    assert!(crate_of_eight.has_uvs(&(0..12)) && crate_of_eight.not_taken().is_empty());
    // A vertex lies in other places of the picture on each of its sides.
    let of_first: Vec<Vec2> = crate_of_eight
        .triangles()
        .iter()
        .zip(uvs)
        .flat_map(|(corners, uvs)| corners.iter().zip(uvs.expect("places")))
        .filter_map(|(vertex, uv)| (*vertex == 0).then_some(uv))
        .collect();
    assert!(of_first.iter().any(|uv| *uv != of_first[0]), "{of_first:?}");
    // Every edge has both its triangles.
    let mut edges = std::collections::BTreeMap::new();
    for [a, b, c] in crate_of_eight.triangles() {
        [(a, b), (b, c), (c, a)].iter().for_each(|(from, to)| *edges.entry((*from, *to)).or_insert(0) += 1);
    }
    assert!(edges.iter().all(|((from, to), count)| *count == 1 && edges.contains_key(&(*to, *from))));
    assert_eq!(edges.len(), 36);
}

#[test]
fn a_picture_changes_colours_and_nothing_else() {
    let (with, mut session) = (pattern(), session());
    let without = plain(&with);
    for technique in Technique::ALL {
        let [with, without] =
            [&with, &without].map(|scene| session.render(scene.clone(), request(technique, SIZE)).expect("a frame"));
        let name = technique.name();
        assert!(with.plan.textures.len() == 2 && without.plan.textures.is_empty(), "{name}");
        assert!(bare(&with.plan) == bare(&without.plan) && without.plan.bytes() < with.plan.bytes(), "{name}");
        let mut colors_differ = false;
        for step in 0..with.capture.steps.len() {
            let [one, other] = [&with, &without].map(|frame| frame.capture.frame_at(step));
            let (Some(one), Some(other)) = (one, other) else { continue };
            assert!(one.depth.image == other.depth.image, "{name}, depth of step {step}");
            let stencils = [one, other].map(|frame| frame.stencil.as_ref().map(|stencil| &stencil.image));
            assert!(stencils[0] == stencils[1], "{name}, stencil of step {step}");
            colors_differ |= one.color.image != other.color.image;
        }
        assert!(colors_differ, "{name}");
        let labels = [&with, &without].map(|frame| frame.capture.lights[0].shadow.clone());
        assert!(labels[0].is_some() && labels[0] == labels[1], "{name}");
    }
}

/// Four texels of a metre each, seen from above: at the middle of one nothing is mixed.
#[test]
fn a_pixel_is_its_texel_times_what_arrives() {
    let texels = [[255, 0, 0], [0, 128, 255], [90, 90, 90], [255, 255, 255]];
    let four = picture([2, 2], |x, y| texels[(2 * y + x) as usize]);
    let color = [0.5, 0.8, 1.0];
    let floor = Object {
        texture: along_world(&four, 2.0),
        material: Material::matte(color),
        ..Object::of("floor", shapes::quad([8.0; 2]).expect("a floor"))
    };
    let mut camera = Camera { up: DVec3::NEG_Z, ..Camera::looking([0.0, 10.0, 0.0], [0.0; 3]) };
    camera.projection = Projection::Orthographic { half_height: 2.0 };
    let scene = SceneBuilder::new("four")
        .ambient([0.25; 3])
        .camera(camera)
        .object(floor)
        .light(Light { intensity: 0.5, ..Light::directional([0.0, 1.0, 1.0]) })
        .build();
    let mut frame = Rendered::new(&scene, Choice::new(Technique::ZFail), [80, 80]).expect("a frame");
    // 20 pixels a metre; up is −Z, and so is the upper side of the picture.
    for (index, [row, column]) in [[0, 0], [0, 1], [1, 0], [1, 1]].into_iter().enumerate() {
        for repeated in [0, 40] {
            // Between two pixels is the middle of a texel: a fortieth of it away next to nothing is mixed.
            let at = [column * 20 + 10 + repeated, row * 20 + 10];
            let stored = last_color(&frame, at);
            let light = 0.25 + 0.5 * std::f64::consts::FRAC_1_SQRT_2;
            for channel in 0..3 {
                let share = |index: usize| linear(texels[index][channel]);
                let (beside, below) = (index ^ 1, index ^ 2);
                let near = 0.975;
                let mixed = near * near * share(index)
                    + near * (1.0 - near) * (share(beside) + share(below))
                    + (1.0 - near) * (1.0 - near) * share(index ^ 3);
                let expected = srgb(mixed * f64::from(color[channel]) * light);
                let found = f64::from(stored[channel]);
                assert!((found - expected).abs() <= 3.0, "{at:?}, channel {channel}: {found} is not {expected}");
            }
            let term = shaded(&mut frame, at).expect("a surface").texture.expect("a picture");
            assert_eq!((term.texel, term.level), ([column, row], 0.0), "{at:?}: {term:?}");
            let inside = term.uv.map(|part| part.rem_euclid(1.0));
            let expected = [0.25 + 0.5 * f64::from(column), 0.75 - 0.5 * f64::from(row)];
            let near = inside.iter().zip(expected).all(|(part, expected)| (part - expected).abs() < 0.02);
            assert!(near, "{at:?}: {inside:?}");
        }
    }
}

/// A clamped picture lies once in the world: from its origin to the right and towards −Z; far from it one that repeats
/// is as sharp as near.
#[test]
fn a_picture_along_the_world_lies_where_it_is_said_to() {
    let quarters = picture([2, 2], |x, y| [255 * x as u8, 255 * y as u8, 0]);
    let look = |clamps: bool, at: [f64; 2]| {
        let floor = Object {
            texture: Some(MaterialTexture { picture: quarters.clone(), side: Some(2.0), clamps }),
            ..Object::new("floor", Arc::new(shapes::quad([8.0; 2]).expect("a floor")), Material::matte([1.0; 3]))
        };
        let [x, z] = at;
        let mut camera = Camera { up: DVec3::NEG_Z, ..Camera::looking([x, 4.0, z], [x, 0.0, z]) };
        camera.projection = Projection::Orthographic { half_height: 0.05 };
        let far = DVec3::new((x / 8.0).round() * 8.0, 0.0, (z / 8.0).round() * 8.0);
        let scene =
            SceneBuilder::new("a floor").ambient([1.0; 3]).camera(camera).object(floor.at(far)).lights([]).build();
        let frame = Rendered::new(&scene, Choice::new(Technique::None), [9, 9]).expect("a frame");
        let [red, green, ..] = last_color(&frame, [4, 4]);
        [red > 128, green > 128]
    };
    // The middles of its texels, row 0 at the top: x right, and y down.
    let cases = [([0.5, -1.5], [false, false]), ([1.5, -1.5], [true, false]), ([0.5, -0.5], [false, true])];
    for ([x, z], expected) in cases {
        assert_eq!((look(true, [x, z]), look(false, [x, z])), (expected, expected), "{x}, {z}");
        assert_eq!(look(false, [x + 2.0e6, z - 4.0e6]), expected, "far away");
    }
    // Beyond it, the nearest of its texels; or the next picture's.
    assert_eq!((look(true, [3.5, -0.5]), look(false, [2.5, -0.5])), ([true, true], [false, true]));
    assert_eq!((look(true, [-3.5, -1.5]), look(false, [-0.5, -1.5])), ([false, false], [true, false]));
}

/// The texel at the point that a ray hits, computed from the board's own plane, is what the GPU shows. If coordinates
/// were interpolated along the picture's lines and not in space, the middle of the board would show half of the ramp.
#[test]
fn places_in_a_picture_are_in_perspective() {
    let scene = SceneBuilder::new("slanted")
        .ambient([1.0; 3])
        .object(on_board(&ramp()))
        .lights([])
        .seen_from([0.4, 2.2, 4.0], [0.0, 0.8, -2.0])
        .build();
    let mut frame = rendered(&scene, Technique::None);
    let [corner, right, up] = [DVec3::new(-3.0, 0.0, 1.0), DVec3::new(6.0, 0.0, 0.0), DVec3::new(0.0, 2.0, -7.0)];
    let normal = right.cross(up);
    let (mut compared, mut bent) = (0, 0.0_f64);
    for [x, y] in (1..SIZE[1]).step_by(3).flat_map(|y| (1..SIZE[0]).step_by(4).map(move |x| [x, y])) {
        let ray = ray(frame.capture(), [x, y]);
        let from = scene.camera.eye + ray.from;
        let distance = normal.dot(corner - from) / normal.dot(ray.along);
        let at = from + ray.along * distance - corner;
        let uv = [at.dot(right) / right.length_squared(), at.dot(up) / up.length_squared()];
        if !uv.iter().all(|part| (0.06..0.94).contains(part)) {
            continue;
        }
        let stored = last_color(&frame, [x, y]);
        // The ramp's middle texels are wide where a pixel is small; sRGB bytes are a step a texel.
        for (found, expected) in [(stored[0], uv[0] * 256.0 - 0.5), (stored[1], uv[1] * 256.0 - 0.5)] {
            assert!((f64::from(found) - expected).abs() < 2.0, "{x},{y}: {found} is not {expected}");
        }
        let term = shaded(&mut frame, [x, y]).expect("a surface").texture.expect("a picture");
        // Corners on a coarse grid take their places in the picture along.
        let most = if adapter::draws_as_given() { 1e-5 } else { 1e-3 };
        assert!(term.uv.iter().zip(uv).all(|(found, uv)| (found - uv).abs() < most), "{term:?} is not {uv:?}");
        compared += 1;
        let height = f64::from(y) / f64::from(SIZE[1]);
        bent = bent.max((uv[1] - (1.0 - height)).abs());
    }
    assert!(compared > 150 && bent > 0.1, "{compared} pixels, bent by {bent}");
}

/// From the terms of every pixel that is looked at comes its colour, whichever way the surface is shaded.
#[test]
fn the_terms_of_a_pixel_with_a_picture_add_up_to_its_colour() {
    let noisy = picture([64, 32], |x, y| [(x * 4) as u8, (y * 8) as u8, (x * 37 + y * 91) as u8]);
    for (shading, clamps) in [(Shading::Flat, false), (Shading::Gouraud, true), (Shading::Phong, false)] {
        let mut board = on_board(&noisy);
        board.material = Material { shading, specular: 0.4, shininess: 8.0, checks: 0.7, ..board.material };
        board.texture = board.texture.map(|texture| MaterialTexture { clamps, ..texture });
        let floor = Object {
            texture: along_world(&noisy, 3.0),
            material: Material { emission: [0.02, 0.0, 0.05], ..Material::default() },
            ..Object::of("floor", shapes::quad([30.0; 2]).expect("a floor"))
        };
        let mut scene = SceneBuilder::new("noisy")
            .objects([floor.at([0.0, -0.5, 0.0]), board])
            .lights([Light::point([1.0, 4.0, 2.0]), Light::directional([-1.0, 2.0, 0.3])])
            .seen_from([0.4, 2.2, 4.0], [0.0, 0.8, -2.0])
            .build();
        for projection in [Projection::Perspective, Projection::Orthographic { half_height: 3.0 }] {
            scene.camera.projection = projection;
            let mut frame = rendered(&scene, Technique::ZFail);
            let mut blurred = 0;
            for [x, y] in (2..SIZE[1]).step_by(4).flat_map(|y| (2..SIZE[0]).step_by(5).map(move |x| [x, y])) {
                let Some(found) = shaded(&mut frame, [x, y]) else { continue };
                let term = found.texture.as_ref().expect("a picture");
                // Where the texels of a mip level are much larger than a pixel, differences in how GPUs compute the
                // level are visible.
                blurred += u32::from(term.level > 0.0);
                let stored = last_color(&frame, [x, y]);
                let lit = found.lights.iter().filter(|light| light.label == Some(PixelLabel::Lit));
                let lights: Vec<[f64; 3]> = lit.map(|light| light.adds).collect();
                for channel in 0..3 {
                    let sum = found.unlit[channel] + lights.iter().map(|adds| adds[channel]).sum::<f64>();
                    // Each pass rounds to eight bits of sRGB; filters have eight bits too.
                    let most = 2.5 + 2.0 * lights.len() as f64;
                    let (found_here, expected) = (f64::from(stored[channel]), srgb(sum));
                    let differs = (found_here - expected).abs();
                    assert!(differs <= most, "{shading:?} {x},{y}: {found_here} is not {expected}: {found:?}");
                }
            }
            assert!(blurred > 20, "{blurred}");
        }
    }
}

#[test]
fn a_folder_holds_the_pictures_and_runs_again_as_it_was() {
    let (folder, mut session) = (tempfile::tempdir().expect("a folder"), session());
    for technique in [Technique::ZFail, Technique::PlanarTexture, Technique::Projective] {
        let place = folder.path().join(technique.name());
        let frame = session.render(pattern(), CaptureRequest::new(Choice::new(technique), SIZE)).expect("a frame");
        write(frame.contents(), &place, false).expect("written");
        let whole = read_whole(&place).expect("read");
        let (plan, scene) = (whole.plan.expect("a plan"), whole.scene.expect("a scene"));
        assert!(plan == *frame.plan, "{}", technique.name());
        assert_eq!(plan.textures[0].picture.name(), "tiles.png");
        let again = session.capture_plan(&scene, &plan).expect("a capture");
        let of_scene = session.capture(&scene, &request(technique, SIZE)).expect("a capture");
        for step in 0..again.steps.len() {
            let color = |capture: &stencilscope::capture::Capture| {
                capture.frame_at(step).map(|frame| frame.color.image.clone())
            };
            assert!(color(&again) == color(&frame.capture), "{}, step {step}", technique.name());
            assert!(color(&of_scene) == color(&frame.capture), "{}, step {step} of its scene", technique.name());
        }
    }
    // A texel less, and it is no frame.
    let file = folder.path().join("z-fail/texture000.png");
    let bytes = std::fs::read(&file).expect("bytes");
    std::fs::write(&file, &bytes[..bytes.len() / 2]).expect("cut");
    let error = read_whole(&folder.path().join("z-fail")).expect_err("cut off").to_string();
    assert!(error.contains("texture000.png") && !error.contains('\n'), "{error}");
    let frame = folder.path().join("planar-texture/frame.json");
    let document = std::fs::read_to_string(&frame).expect("text");
    std::fs::write(&frame, document.replace("\"texture\":0", "\"texture\":7")).expect("broken");
    let error = read_whole(&folder.path().join("planar-texture")).expect_err("no such texture").to_string();
    assert!(error.contains("its texture does not exist"), "{error}");
}

#[test]
fn a_texture_without_places_or_with_a_shader_that_shows_none_is_found_by_the_lint() {
    let frame = session().render(pattern(), request(Technique::ZFail, SIZE)).expect("a frame");
    let problems = |change: &dyn Fn(&mut FramePlan)| {
        let mut plan = FramePlan::clone(&frame.plan);
        change(&mut plan);
        stencilscope::plan::lint::check(&plan).iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    };
    assert_eq!(problems(&|_| {}), "");
    let short = problems(&|plan| {
        let surfaces = plan.meshes.iter_mut().filter_map(|mesh| mesh.surface.as_mut());
        surfaces.for_each(|surface| surface.uvs = Some(Blob::new(vec![[0.0; 2]; 2])));
    });
    assert!(short.contains("its corners do not lie in a picture"), "{short}");
    let volumes = problems(&|plan| {
        let texture = plan.passes[0].draws[0].constants.texture;
        plan.passes[1].draws[0].constants.texture = texture;
    });
    assert!(volumes.contains("its shader shows no texture"), "{volumes}");
}

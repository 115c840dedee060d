//! Projective shadow textures: the casters' silhouettes, projected over the scene like slides.
//!
//! Each caster has a picture of what it lets through, seen from the light in a frame that fits it; the light passes
//! through all of them on its way to a surface. No depths are compared: what lies between light and caster is darkened
//! like what lies behind it, and a caster can't darken itself. Casters may be translucent.

use super::PlanError;
use super::casters::{self, DarkenedObjects};
use super::description::{ComparisonRole, TechniqueDescription};
use super::frame::{FrameBuilder, PlanRequest, StencilUse, SurfaceDrawing};
use super::lesson::{Lesson, cited};
use super::settings::TextureSettings;
use super::silhouettes::{self, LayerPass};
use crate::geometry::light_frame::{self, SilhouetteView};
use crate::math::AxisBox;
use crate::plan::{DecidedBy, Decision, FramePlan, LeftOut, LightId, PlanMap, Visibility};
use glam::DMat4;

/// Describes `projective` for commands, tables and the inspector.
pub(super) const DESCRIPTION: TechniqueDescription = TechniqueDescription {
    summary: "Throws a picture of each caster's silhouette over the scene like a slide: no depths are compared.",
    lesson: Lesson {
        text: "A picture of each caster's silhouette is thrown over the scene like a slide, and translucent casters \
             let some light through. No depths are compared: what stands between light and caster is darkened \
             too, and a caster can't darken itself.",
        formula: "(s, t) = (x, y) / q of the point as the light sees it; light * what the silhouette lets through at \
             (s, t)",
        sources: &[cited::SEGAL],
    },
    plan,
    // Sizes of pictures.
    report_rows: &[&[("size", "128")], &[("size", "512")], &[("size", "2048")]],
    standing: ComparisonRole::Rival {
        place: 7,
        right_because: "nothing darkens itself here, or stands between light and caster",
        texels: Some((0.002, "512 texels hold the whole silhouette: where the light spreads it, each shows")),
    },
};

/// Plans a frame with projective shadow textures: each caster's silhouette is projected over the scene, in the light
/// pass or in a pass of its own, as the settings say.
pub fn plan(job: PlanRequest) -> Result<FramePlan, PlanError> {
    let settings = TextureSettings::of_silhouettes(job.choice.settings());
    let mut frame = FrameBuilder::new(job, StencilUse::ToLightOnce)?;
    let layers = casting_objects(&mut frame);
    for piece in &mut frame.pieces {
        piece.layer = layers.iter().position(|object| *object == piece.object).map(|layer| layer as u32);
    }
    for light in frame.light_ids() {
        add_silhouettes(&mut frame, light, &layers, &settings);
    }
    frame.ambient_pass();
    for light in frame.light_ids() {
        let drawn_layers: Vec<usize> = match &frame.plan.lights[light.0].map {
            Some(map) => (0..map.faces.len()).filter(|layer| map.faces[*layer].is_some()).collect(),
            None => Vec::new(),
        };
        let how = if drawn_layers.is_empty() { Visibility::Everywhere } else { Visibility::Projected };
        if settings.is_single_pass || drawn_layers.is_empty() {
            let purpose = match how {
                Visibility::Everywhere => "Adds the light everywhere: no silhouette is on its way.",
                _ => "Adds the light, as far as the silhouettes on its way let it through.",
            };
            frame.mask_and_light_passes(light, how, purpose);
        } else {
            multi_pass(&mut frame, light, &layers, &drawn_layers);
        }
    }
    Ok(frame.finish())
}

/// Adds passes that light everything first, then multiply the picture by one silhouette after another, and the mask
/// pass. A multiplied pixel loses ambient and other lights' light too.
fn multi_pass(frame: &mut FrameBuilder, light: LightId, layers: &[usize], drawn_layers: &[usize]) {
    let purpose = "Adds the light everywhere: silhouettes darken it afterwards.";
    frame.light_pass(light, purpose, &frame.light_everywhere());
    for layer in drawn_layers {
        let purpose = "Draws what is visible again and darkens it where this silhouette falls, with what ambient and \
                       other lights gave as well.";
        let name = format!("projection of {}", frame.placed[layers[*layer]].object.name);
        let draws = frame.draws_through(*layer);
        if !draws.is_empty() {
            frame.blend_pass(light, &name, purpose, draws);
        }
    }
    frame.mask_pass(light, &[SurfaceDrawing::lit_by(Visibility::Projected)]);
}

/// Returns the indices of casters that can darken another object under any light, the first [`PlanMap::MOST_FACES`] of
/// them; records in the plan how many more there are.
fn casting_objects(frame: &mut FrameBuilder) -> Vec<usize> {
    let casts = |index: &usize| {
        let object = frame.placed[*index].object;
        let darkens = |light| casters::can_darken(frame, *index, light, DarkenedObjects::Others);
        object.casts && !object.mesh.triangles().is_empty() && frame.light_ids().any(darkens)
    };
    let mut objects: Vec<usize> = (0..frame.placed.len()).filter(casts).collect();
    if objects.len() > PlanMap::MOST_FACES {
        let count = objects.len() - PlanMap::MOST_FACES;
        let because = "a light passes through 64 silhouettes at most";
        let left_out = LeftOut::counted(Decision::MostSilhouettes, count as u64, "the frame", because);
        frame.plan.left_out.push(left_out);
        objects.truncate(PlanMap::MOST_FACES);
    }
    objects
}

/// Tangent of half a point light's field of view where a silhouette is not fitted to its caster.
const TANGENT_OF_45_DEGREES: f64 = 1.0;

/// Returns the length in metres of the diagonal of the box around all objects.
fn size_of_scene(frame: &FrameBuilder) -> f64 {
    AxisBox::around(frame.placed.iter().flat_map(|placed| placed.world.iter().copied())).diagonal()
}

fn add_silhouettes(frame: &mut FrameBuilder, light: LightId, layers: &[usize], settings: &TextureSettings) {
    let mut matrices = vec![DMat4::IDENTITY; layers.len()];
    let mut passes = Vec::new();
    for (layer, object) in layers.iter().enumerate() {
        let name = frame.placed[*object].object.name.clone();
        if !casters::can_darken(frame, *object, light, DarkenedObjects::Others) {
            let because = "every other object that receives lies on the light's side of its triangles";
            frame.plan.left_out.push(LeftOut::named(Decision::Silhouette, &name, light.name(), because));
            continue;
        }
        let position = frame.light_position(light);
        let view = match settings.fits {
            true => SilhouetteView::Fitted { has_border: !settings.repeats_edge },
            false if position.w == 0.0 => SilhouetteView::Fixed { half: size_of_scene(frame) / 2.0 },
            false => SilhouetteView::Fixed { half: TANGENT_OF_45_DEGREES },
        };
        let Some(clip_from_world) = light_frame::fit_silhouette(&frame.placed[*object].world, position, view) else {
            let because = "it reaches behind the light or into its plane, so no picture holds it: it casts nothing";
            frame.plan.left_out.push(LeftOut::named(Decision::Silhouette, &name, light.name(), because));
            continue;
        };
        matrices[layer] = clip_from_world;
        let all: Vec<u32> = (0..frame.placed[*object].object.mesh.triangles().len() as u32).collect();
        let draws = silhouettes::draws(frame, *object, &all);
        passes.push(LayerPass { layer, name: format!("silhouette of {name}"), draws });
    }
    if passes.is_empty() {
        return;
    }
    let frame_of_it = if settings.fits { "a frame that fits it" } else { "a frame that is alike for all casters" };
    let purpose = format!(
        "Draws the caster as the light sees it, in {frame_of_it}: not how far it is, but how much light it lets through."
    );
    let names = layers.iter().map(|object| frame.placed[*object].object.name.clone()).collect();
    silhouettes::add_map(frame, light, settings, names, matrices, passes, &purpose);
    frame.plan.lights[light.0].decided_by = DecidedBy::Silhouettes;
}

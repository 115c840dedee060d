//! Checks a plan without a GPU: each of its errors names what would be a driver error, or silently wrong.

use super::{
    AttachmentId, AttachmentRole, Draw, DrawMesh, DrawPieces, FramePlan, LightId, MeshId, Pass, PlanMap, Program,
    RecordedPass, StartContent, Visibility,
};

/// A rule for plans that a pass breaks.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("pass {pass} ({name}): {problem}")]
pub struct LintError {
    /// Index of the pass.
    pub pass: usize,
    /// Name of the pass.
    pub name: String,
    /// What is wrong, in words.
    pub problem: String,
}

/// Checks a plan before it runs; returns every broken rule, in the order of passes; empty where the plan is right.
pub fn check(plan: &FramePlan) -> Vec<LintError> {
    check_for(plan, true)
}

/// Checks a plan that is read and not run: it may lack what only shading needs
/// ([`FramePlan::without_shading`]).
pub fn check_unshaded(plan: &FramePlan) -> Vec<LintError> {
    check_for(plan, false)
}

fn check_for(plan: &FramePlan, is_shaded: bool) -> Vec<LintError> {
    let in_range = |mesh: &DrawMesh| {
        let vertex_count = mesh.vertices.len();
        mesh.indices.data().iter().all(|index| (*index as usize) < vertex_count)
    };
    let meshes_in_range: Vec<bool> = plan.meshes.iter().map(in_range).collect();
    let problems = |(index, pass): (usize, &Pass)| {
        let error = move |problem| LintError { pass: index, name: pass.name.clone(), problem };
        check_pass(plan, pass, &meshes_in_range, is_shaded).into_iter().map(error).collect::<Vec<_>>()
    };
    plan.passes.iter().enumerate().flat_map(problems).collect()
}

fn check_pass(plan: &FramePlan, pass: &Pass, meshes_in_range: &[bool], is_shaded: bool) -> Vec<String> {
    let mut problems = Vec::new();
    if plan.views.get(pass.view.0).is_none() {
        problems.push("its view does not exist".to_owned());
    }
    if let Some(target) = &pass.color {
        match plan.attachments.get(target.attachment.0).map(|attachment| attachment.role) {
            Some(AttachmentRole::DepthStencil) | None => {
                problems.push("its colour target is no colour attachment".to_owned())
            }
            Some(_) => {}
        }
    }
    let color = pass.color.as_ref().map(|target| (target.attachment, target.layer));
    let depth = pass.depth_stencil.as_ref().map(|target| (target.attachment, target.layer));
    if color.into_iter().chain(depth).any(|(id, layer)| plan.stored_layer(id, layer).is_none()) {
        problems.push("it draws a face that its light's map leaves out".to_owned());
    }
    let has_stencil = pass.depth_stencil.as_ref().is_some_and(|target| {
        plan.attachments.get(target.attachment.0).is_some_and(|attachment| attachment.format.has_stencil_aspect())
    });
    if let Some(target) = &pass.depth_stencil {
        match plan.attachments.get(target.attachment.0) {
            Some(attachment) if attachment.format.has_depth_aspect() && target.layer < attachment.layers => {}
            _ => problems.push("its depth-stencil target does not exist or has no depth".to_owned()),
        }
        if target.clear_stencil.is_some() && !has_stencil {
            problems.push("it clears a stencil that its target does not have".to_owned());
        }
    }
    let fits = |[left, top, columns, rows]: [u32; 4]| {
        let [end_x, end_y] = [u64::from(left) + u64::from(columns), u64::from(top) + u64::from(rows)];
        let is_in = |id: AttachmentId| {
            let size = plan.attachments.get(id.0).map(|target| target.size.map(u64::from));
            size.is_some_and(|[width, height]| end_x <= width && end_y <= height)
        };
        pass.targets().all(is_in)
    };
    if !pass.scissor.is_none_or(fits) {
        problems.push("its scissor reaches out of a target".to_owned());
    }
    if let Some(problem) = pass.recorded.as_ref().and_then(|recorded| recorded_problem(plan, pass, recorded)) {
        problems.push(problem.to_owned());
    }
    if let Some(problem) = pass.viewport.and_then(|viewport| viewport.problem()) {
        problems.push(problem.to_owned());
    }
    if pass.image.is_some() && (pass.color.is_none() || !pass.draws.is_empty()) {
        problems.push("an image made on the CPU needs a colour target and no draws".to_owned());
    }
    for draw in &pass.draws {
        let is_out = |mesh: MeshId| meshes_in_range.get(mesh.0) == Some(&false);
        if is_out(draw.mesh) || is_out(draw.rasterised().mesh) {
            problems.push(format!("{}: an index of its mesh is out of range", draw.name));
        }
        let found = check_draw(plan, pass, draw, has_stencil, is_shaded);
        problems.extend(found.into_iter().map(|p| format!("{}: {p}", draw.name)));
    }
    problems
}

fn recorded_problem(plan: &FramePlan, pass: &Pass, recorded: &RecordedPass) -> Option<&'static str> {
    let target = pass.depth_stencil.as_ref().and_then(|target| plan.attachments.get(target.attachment.0));
    let texels = target.map_or(0, |target| target.size[0] as usize * target.size[1] as usize);
    let fits = |start: &StartContent| {
        start.depth.as_ref().is_none_or(|depth| depth.data().len() == texels)
            && start.stencil.as_ref().is_none_or(|stencil| stencil.data().len() == texels)
    };
    if let Some(problem) = recorded.viewport.problem() {
        Some(problem)
    } else if pass.color.is_some() {
        Some("another program's colours are not known, so that it has no colour target")
    } else if !recorded.start.as_ref().is_none_or(fits) {
        Some("what its target holds at the start has not its size")
    } else {
        None
    }
}

/// Returns whether the mesh has every vertex that the draw's indices refer to with its base vertex added. Always true
/// for base vertex 0, for which the indices are checked alone; else false where the mesh lacks the draw's triangles.
fn base_fits(mesh: &DrawMesh, draw: &Draw) -> bool {
    let corners = draw.triangles.start as usize * 3..draw.triangles.end as usize * 3;
    let count = mesh.vertices.len();
    let exists = |index: &u32| (*index as usize + draw.base_vertex as usize) < count;
    draw.base_vertex == 0 || mesh.indices.data().get(corners).is_some_and(|indices| indices.iter().all(exists))
}

/// Returns whether the pieces exist, are of triangles that the draw has, and are shaded by as much as these.
fn pieces_fit(plan: &FramePlan, draw: &Draw, whole: &DrawMesh, pieces: &DrawPieces) -> bool {
    let of = plan.meshes.get(pieces.mesh.0).and_then(|mesh| mesh.pieces_of.as_ref().map(|of| (mesh, of)));
    let range = pieces.triangles.start as usize..pieces.triangles.end as usize;
    let uvs = |mesh: &DrawMesh| mesh.surface.as_ref().map(|surface| surface.uvs.as_ref().map(|uvs| uvs.len()));
    let corners = |mesh: &DrawMesh| uvs(mesh).flatten().is_none_or(|count| count == mesh.indices.len());
    of.is_some_and(|(mesh, of)| {
        of.len() == mesh.triangles() as usize
            && uvs(mesh).map(|uvs| uvs.is_some()) == uvs(whole).map(|uvs| uvs.is_some())
            && corners(mesh)
            && of.data().get(range).is_some_and(|of| of.iter().all(|triangle| draw.triangles.contains(triangle)))
    })
}

fn check_draw(plan: &FramePlan, pass: &Pass, draw: &Draw, has_stencil: bool, is_shaded: bool) -> Vec<String> {
    let mut problems = Vec::new();
    let mut demand = |holds: bool, problem: &str| {
        if !holds {
            problems.push(problem.to_owned());
        }
    };
    let Some(mesh) = plan.meshes.get(draw.mesh.0) else {
        return vec!["its mesh does not exist".to_owned()];
    };
    demand(draw.triangles.start < draw.triangles.end, "it draws nothing: leave it out");
    demand(draw.triangles.end as usize * 3 <= mesh.indices.data().len(), "it runs past the end of its mesh");
    demand(base_fits(mesh, draw), "its first vertex puts an index of its mesh out of range");
    let fits = |pieces| !draw.program.is_recorded() && pieces_fit(plan, draw, mesh, pieces);
    demand(draw.pieces.as_ref().is_none_or(fits), "its pieces are not of its triangles");
    demand(mesh.pieces_of.is_none(), "its mesh has but pieces of another's triangles");
    demand(has_stencil || !draw.raster.stencil.is_enabled(), "it tests a stencil that its pass does not have");
    let writes_color = draw.raster.color != super::ColorWrite::None;
    let is_recorded = draw.program.is_recorded();
    demand(is_recorded == pass.recorded.is_some(), "another program's draw in a pass of ours, or the reverse");
    demand(
        is_recorded || writes_color != (draw.program == Program::Position),
        "a shader with colour and a state without, or the reverse",
    );
    demand(is_recorded || !writes_color || pass.color.is_some(), "it writes a colour that its pass does not have");
    let is_plain = matches!(draw.program, Program::Position | Program::Flat | Program::FlatLabel | Program::Count);
    demand(mesh.extruded.is_none() || is_plain, "it shades a mesh whose vertices are carried away from a light");
    let shades = draw.program.visibility().is_some();
    demand(!shades || !is_shaded || mesh.surface.is_some(), "it shades a mesh without normals");
    demand(!shades || pass.light.is_some_and(|light| light.0 < plan.lights.len()), "it shades without a light");
    let is_there = |light: &LightId| plan.lights.get(light.0).is_some_and(|light| light.map.is_some());
    demand(draw.samples_maps_of.iter().all(is_there), "it samples the map of a light that has none");
    let light = pass.light.and_then(|light| plan.lights.get(light.0));
    let map = light.and_then(|light| light.map.as_ref());
    match draw.program.visibility() {
        Some(Visibility::Map) => {
            let has_depth = map.is_some_and(|map| map.lookup.is_some());
            demand(has_depth, "it reads a shadow map that its light does not have");
        }
        Some(Visibility::ReceiverTexture | Visibility::Projected) => {
            let faces = map.map_or(0, |map| map.faces.len());
            demand(faces > 0, "it reads a texture that its light does not have");
            let own = draw.constants.layer.is_none_or(|layer| (layer as usize) < faces);
            demand(own, "its layer is none of its light's map");
        }
        Some(Visibility::Count) => {
            demand(light.is_some_and(|light| light.count.is_some()), "it reads a count that its light does not have");
        }
        Some(Visibility::Everywhere | Visibility::Labels) | None => {}
    }
    if let Some(texture) = draw.constants.texture {
        let uvs = mesh.surface.as_ref().and_then(|surface| surface.uvs.as_ref());
        let is_placed = uvs.is_some_and(|uvs| uvs.data().len() == mesh.indices.data().len());
        demand(texture.0 < plan.textures.len(), "its texture does not exist");
        demand(is_placed, "its corners do not lie in a picture, and it has one");
        demand(draw.program.shows_texture(), "its shader shows no texture, and it has one");
    }
    demand(map.is_none_or(|map| map.faces.len() <= PlanMap::MOST_FACES), "its light's map has too many faces");
    problems
}

//! Each formula of a card, and when it is so.

use super::*;

pub const FORMULAS: &[(&str, Check)] = &[
    ("stored depth = offset + scale / distance along the view", |here, _| {
        let curve = here.frame.plan.depth;
        let camera = here.frame.scene.camera;
        // Linear in 1 / distance, from the near plane's depth on.
        let near = usize::from(curve.mapping == DepthMapping::ReversedInfinite);
        (curve.depth(camera.near) - depth_range(here)[near]).abs() < 1e-9
    }),
    ("stored depth = offset + scale · distance along the view", |here, _| {
        let curve = here.frame.plan.depth;
        let camera = here.frame.scene.camera;
        // As far beyond the near plane again is as many steps further.
        let [near, middle, far] = [1.0, 1.5, 2.0].map(|factor| curve.depth(camera.near * factor));
        let is_linear = (far - middle - (middle - near)).abs() < 1e-9 && far != near;
        is_linear && camera.projection != Projection::Perspective
    }),
    ("count = front faces before the surface − back faces before it, seen from the eye", |here, _| {
        here.counts(CountedSide::InFront)
    }),
    ("count = back faces behind the surface − front faces behind it, seen from the eye", |here, _| {
        here.counts(CountedSide::Behind)
    }),
    ("count = volumes that contain the surface: each face the ray crosses adds or takes 1", |here, _| {
        here.decided_by().counted_side() == Some(CountedSide::AsNeeded)
    }),
    ("count at the near plane = casting triangles between the light and the pixel's point of that plane", |here, _| {
        here.frame.step(here.step).1.counts_at_near_plane()
    }),
    ("a closed volume = sides + light cap + dark cap", |here, _| here.draws(DrawPart::Side).next().is_some()),
    ("light is added where count = 0", |here, _| asks_stencil(here, 0xff)),
    ("light is added where count = 0, kept in {}", |here, parts| asks_stencil(here, mask_of(parts[0]))),
    ("light is added where the stencil is even: a shadow adds 1 to its receiver's even mark", |here, _| {
        asks_stencil(here, 1)
    }),
    ("light is added whatever stands between: the share of its diffuse light that counts as ambient", |here, _| {
        let mut draws = here.frame.step(here.step).1.draws.iter();
        here.frame.plan.ambient_diffuse > 0.0 && draws.all(|draw| draw.program == Program::AmbientDiffuse)
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
        let rest = |part| [DrawPart::Surface, DrawPart::PlanarShadow].contains(&part);
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
        here.draws(DrawPart::PlanarShadow).next().is_some()
    }),
    ("shadow may fall only where the receiver itself is seen: it is marked in the stencil first", |here, _| {
        here.draws(DrawPart::Receiver).next().is_some()
    }),
];

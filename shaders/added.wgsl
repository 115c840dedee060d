// What one light adds to a visible surface.

alias Value = vec4f;

// `share`: how much of its colour the surface has there.
fn light_added(surface: Surface, share: vec3f) -> Value {
    if is_beyond_far(surface) {
        discard;
    }
    return vec4f(added(surface, share) * arriving(surface).rgb, 0.0);
}

fn added(surface: Surface, share: vec3f) -> vec3f {
    // Wrapped light reaches round the edge; Lambert's ends there, and exact signs say where.
    if !wraps && faces_away(surface.sides) {
        return vec3f(0.0);
    }
    if is_gouraud {
        return surface.diffuse * share + surface.gloss;
    }
    let light_here = light_on(surface.relative, normalize(surface.normal));
    return light_here.diffuse * share + light_here.gloss;
}

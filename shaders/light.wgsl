// What one light adds to a visible surface.

fn light_added(surface: Surface) -> vec4f {
    if is_beyond_far(surface) {
        discard;
    }
    return vec4f(added(surface, vec3f(in_checks(surface.relative))) * arriving(surface).rgb, 0.0);
}

@fragment
fn fs_light(surface: Surface) -> @location(0) vec4f {
    return light_added(surface);
}

@fragment
fn fs_light_steps(surface: Surface) -> SteppedColor {
    return SteppedColor(light_added(surface), floored(surface.clip.z));
}

// `share`: how much of its colour the surface has there.
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

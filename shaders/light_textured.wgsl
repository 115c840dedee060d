// One light on a surface with a picture.

struct Textured {
    @invariant @builtin(position) clip: vec4f,
    @location(0) relative: vec3f,
    @location(1) normal: vec3f,
    @location(2) diffuse: vec3f,
    @location(3) gloss: vec3f,
    @location(4) @interpolate(flat) sides: u32,
    @location(5) uv: vec2f,
}

@vertex
fn vs_surface_textured(@builtin(vertex_index) corner: u32) -> Textured {
    let at = surface_at(corner);
    return Textured(at.clip, at.relative, at.normal, at.diffuse, at.gloss, at.sides, uvs[corner]);
}

fn light_added_to_picture(at: Textured) -> vec4f {
    let shown = in_picture(at.uv);
    let surface = Surface(at.clip, at.relative, at.normal, at.diffuse, at.gloss, at.sides);
    if is_beyond_far(surface) {
        discard;
    }
    return vec4f(added(surface, shown * in_checks(at.relative)) * arriving(surface).rgb, 0.0);
}

@fragment
fn fs_light_textured(at: Textured) -> @location(0) vec4f {
    return light_added_to_picture(at);
}

@fragment
fn fs_light_textured_steps(at: Textured) -> SteppedColor {
    return SteppedColor(light_added_to_picture(at), floored(at.clip.z));
}

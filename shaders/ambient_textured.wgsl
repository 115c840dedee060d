// Ambient light on a surface with a picture.

struct UnlitTextured {
    @invariant @builtin(position) clip: vec4f,
    @location(0) relative: vec3f,
    @location(1) uv: vec2f,
}

@vertex
fn vs_ambient_textured(@builtin(vertex_index) corner: u32) -> UnlitTextured {
    let relative = positions[corners[corner]];
    return UnlitTextured(clip_position(relative), relative.xyz, uvs[corner]);
}

fn pictured(at: UnlitTextured) -> vec4f {
    return in_ambient_light(draw.color * in_picture(at.uv) * in_checks(at.relative));
}

@fragment
fn fs_ambient_textured(at: UnlitTextured) -> @location(0) vec4f {
    return pictured(at);
}

@fragment
fn fs_ambient_textured_steps(at: UnlitTextured) -> SteppedColor {
    return SteppedColor(pictured(at), floored(at.clip.z));
}

// Where depth is clamped nothing clips at the near plane: this does.
fn pictured_from_near(at: UnlitTextured) -> vec4f {
    let shown = in_picture(at.uv);
    if at.clip.z < 0.0 {
        discard;
    }
    return in_ambient_light(draw.color * shown * in_checks(at.relative));
}

@fragment
fn fs_ambient_textured_from_near(at: UnlitTextured) -> @location(0) vec4f {
    return pictured_from_near(at);
}

@fragment
fn fs_ambient_textured_from_near_steps(at: UnlitTextured) -> SteppedColor {
    return SteppedColor(pictured_from_near(at), floored(at.clip.z));
}

// The material's colour under ambient light, and what it sends out by itself.

struct Unlit {
    @invariant @builtin(position) clip: vec4f,
    // Relative to the eye.
    @location(0) relative: vec3f,
}

@vertex
fn vs_ambient(@location(0) relative: vec4f) -> Unlit {
    return Unlit(clip_position(relative), relative.xyz);
}

@fragment
fn fs_ambient(at: Unlit) -> @location(0) vec4f {
    return under_ambient_light(at);
}

fn under_ambient_light(at: Unlit) -> vec4f {
    return in_ambient_light(draw.color * in_checks(at.relative));
}

fn in_ambient_light(color: vec3f) -> vec4f {
    return vec4f(color * view.ambient.rgb + draw.emission, 1.0);
}

@fragment
fn fs_ambient_steps(at: Unlit) -> SteppedColor {
    return SteppedColor(under_ambient_light(at), floored(at.clip.z));
}

// Where depth is clamped nothing clips at the near plane: this does.
fn from_near(at: Unlit) -> vec4f {
    if at.clip.z < 0.0 {
        discard;
    }
    return under_ambient_light(at);
}

@fragment
fn fs_ambient_from_near(at: Unlit) -> @location(0) vec4f {
    return from_near(at);
}

@fragment
fn fs_ambient_from_near_steps(at: Unlit) -> SteppedColor {
    return SteppedColor(from_near(at), floored(at.clip.z));
}

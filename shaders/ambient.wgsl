// The material's colour under ambient light.

@vertex
fn vs_ambient(@location(0) relative: vec4f) -> @invariant @builtin(position) vec4f {
    return clip_position(relative);
}

@fragment
fn fs_ambient() -> @location(0) vec4f {
    return under_ambient_light();
}

fn under_ambient_light() -> vec4f {
    return vec4f(draw.color * view.ambient.rgb, 1.0);
}

// Where depth is clamped nothing clips at the near plane: this does.
@fragment
fn fs_ambient_from_near(@builtin(position) place: vec4f) -> @location(0) vec4f {
    if place.z < 0.0 {
        discard;
    }
    return under_ambient_light();
}

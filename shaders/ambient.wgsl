// The material's colour under ambient light.

@vertex
fn vs_ambient(@location(0) relative: vec4f) -> @invariant @builtin(position) vec4f {
    return clip_position(relative);
}

@fragment
fn fs_ambient() -> @location(0) vec4f {
    return vec4f(draw.color * view.ambient.rgb, 1.0);
}

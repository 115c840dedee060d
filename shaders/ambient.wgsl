// Ambient light on a surface of one colour.

struct Fragment {
    @invariant @builtin(position) clip: vec4f,
    // Relative to the eye.
    @location(0) relative: vec3f,
}

@vertex
fn vs_ambient(@location(0) relative: vec4f) -> Fragment {
    return Fragment(clip_position(relative), relative.xyz);
}

fn value_of(at: Fragment) -> Value {
    return in_ambient_light(draw.color * in_checks(at.relative), at.clip.z);
}

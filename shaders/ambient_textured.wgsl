// Ambient light on a surface with a picture.

struct Fragment {
    @invariant @builtin(position) clip: vec4f,
    @location(0) relative: vec3f,
    @location(1) uv: vec2f,
}

@vertex
fn vs_ambient_textured(@builtin(vertex_index) corner: u32) -> Fragment {
    let relative = positions[corners[corner]];
    return Fragment(clip_position(relative), relative.xyz, uvs[corner]);
}

fn value_of(at: Fragment) -> Value {
    return in_ambient_light(draw.color * in_picture(at.uv) * in_checks(at.relative), at.clip.z);
}

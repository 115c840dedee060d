// One light on a surface with a picture.

struct Fragment {
    @invariant @builtin(position) clip: vec4f,
    @location(0) relative: vec3f,
    @location(1) normal: vec3f,
    @location(2) diffuse: vec3f,
    @location(3) gloss: vec3f,
    @location(4) @interpolate(flat) sides: u32,
    @location(5) uv: vec2f,
}

@vertex
fn vs_surface_textured(@builtin(vertex_index) corner: u32) -> Fragment {
    let at = surface_at(corner);
    return Fragment(at.clip, at.relative, at.normal, at.diffuse, at.gloss, at.sides, uvs[corner]);
}

fn value_of(at: Fragment) -> Value {
    let surface = Surface(at.clip, at.relative, at.normal, at.diffuse, at.gloss, at.sides);
    return light_added(surface, in_picture(at.uv) * in_checks(at.relative));
}

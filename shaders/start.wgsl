// Writes depths into a target: those that another program's frame began with.

struct Content {
    // Width of the target, texels.
    width: u32,
    depths: array<f32>,
}

@group(0) @binding(0) var<storage, read> content: Content;

@vertex
fn vs_start(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4f {
    // A triangle that covers the whole target.
    return vec4f(f32(corner & 1u) * 4.0 - 1.0, f32(corner >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fs_start(@builtin(position) at: vec4f) -> @builtin(frag_depth) f32 {
    return content.depths[u32(at.y) * content.width + u32(at.x)];
}

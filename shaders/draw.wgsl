// Values of one draw.

struct DrawConstants {
    // Linear RGB reflectance.
    color: vec3f,
    // Strength and Blinn-Phong exponent of the highlight.
    specular: f32,
    shininess: f32,
    // 0 flat, 1 Gouraud, 2 Phong.
    shading: u32,
    // What a label draw writes.
    label: u32,
    // First plus last triangle where triangles run in reverse order, else NOT_REVERSED.
    reversed_sum: u32,
    // What a flat draw writes.
    flat: vec4f,
    // What a count draw adds for a front face.
    count: f32,
    // Its own layer of the light's map, else NO_LAYER.
    layer: u32,
}

const NO_LAYER: u32 = 0xffffffffu;

// Storage, not uniform: see `uniforms.rs`.
@group(1) @binding(0) var<storage, read> draw: DrawConstants;

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
}

@group(1) @binding(0) var<uniform> draw: DrawConstants;

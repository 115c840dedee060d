// Values of one draw.

struct DrawConstants {
    // Linear RGB reflectance.
    color: vec3f,
    // Strength and Blinn-Phong exponent of the highlight.
    specular: f32,
    shininess: f32,
    // What a normal of the mesh belongs to: a corner, a vertex (1) or a triangle.
    normals_per: u32,
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
    // Where the pattern of checks begins, and the side of each along X and Z: 0 for none.
    checks_from: vec2f,
    // What the surface sends out by itself.
    emission: vec3f,
    checks: f32,
    // Of vertices that are extruded here: the light, homogeneous and relative to the view's origin; what is added to
    // the fourth's multiple of a vertex that is carried, and its w.
    extrude_from: vec4f,
    extrude_to: vec4f,
    extruded_w: f32,
}

const NO_LAYER: u32 = 0xffffffffu;
const PER_CORNER: u32 = 0u;
const PER_TRIANGLE: u32 = 2u;

// No condition reads it: see `uniforms.rs`.
@group(1) @binding(0) var<uniform> draw: DrawConstants;

// What a pipeline's draws have; see `specialization.rs`.
override has_checks: bool = true;

// How much of its colour a surface has at a place relative to the eye: a third in every other check.
fn in_checks(relative: vec3f) -> f32 {
    if !has_checks {
        return 1.0;
    }
    let place = floor((relative.xz + draw.checks_from) / draw.checks);
    return select(1.0, 1.0 / 3.0, (i32(place.x + place.y) & 1) != 0);
}

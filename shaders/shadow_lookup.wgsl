// Carries a point into the light's map and compares depths. Depth is reversed: nearer is greater.

@group(3) @binding(1) var shadow_map: texture_depth_2d_array;

// Points on the border between two cube faces belong to both: rounding must not lose them.
const BORDER: f32 = 1.0001;

fn lit_by_map(relative: vec3f) -> bool {
    let size = vec2f(textureDimensions(shadow_map));
    for (var face = 0u; face < light.face_count; face++) {
        let clip = light.clip_from_relative[face] * vec4f(relative, 1.0);
        if clip.w <= 0.0 || max(abs(clip.x), abs(clip.y)) > clip.w * BORDER {
            continue;
        }
        let device = clip.xyz / clip.w;
        let place = (device.xy * vec2f(0.5, -0.5) + 0.5) * size;
        let texel = vec2i(clamp(floor(place), vec2f(0.0), size - 1.0));
        let stored = textureLoad(shadow_map, texel, face, 0);
        // 0 is what the map was cleared to: no caster covers this texel.
        return stored == 0.0 || device.z >= stored;
    }
    // Outside the map: no caster lies in this direction.
    return true;
}

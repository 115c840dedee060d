// Carries a point into the light's map and compares depths.

@group(3) @binding(1) var shadow_map: texture_depth_2d_array;

// Points on the border between two cube faces belong to both: rounding must not lose them.
const BORDER: f32 = 1.0001;

fn arriving(surface: Surface) -> vec4f {
    // Derivatives before any branch: two directions within the triangle's plane.
    let along_x = dpdx(surface.relative);
    let along_y = dpdy(surface.relative);
    for (var face = 0u; face < light.face_count; face++) {
        let clip = light.clip_from_relative[face] * vec4f(surface.relative, 1.0);
        if clip.w > 0.0 && max(abs(clip.x), abs(clip.y)) <= clip.w * BORDER {
            return vec4f(lit_part(face, pushed_off(face, clip, surface), along_x, along_y));
        }
    }
    // Outside the map nothing is known to be in the way.
    return vec4f(1.0);
}

// The point moved along its normal by some texels, more where light grazes the surface.
fn pushed_off(face: u32, clip: vec4f, surface: Surface) -> vec4f {
    if light.bias_normal == 0.0 {
        return clip;
    }
    let to_light = normalize(light.position.xyz - surface.relative * light.position.w);
    let normal = normalize(surface.normal);
    let cosine = dot(normal, to_light);
    let sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    let matrix = light.clip_from_relative[face];
    let focal = length(vec3f(matrix[0].x, matrix[1].x, matrix[2].x));
    let texel = 2.0 * clip.w / (focal * f32(textureDimensions(shadow_map).x));
    return matrix * vec4f(surface.relative + normal * (light.bias_normal * texel * sine), 1.0);
}

// The part of the texels around a point that hold nothing nearer to the light.
fn lit_part(face: u32, clip: vec4f, along_x: vec3f, along_y: vec3f) -> f32 {
    let size = vec2f(textureDimensions(shadow_map));
    let device = clip.xyz / clip.w;
    let place = (device.xy * vec2f(0.5, -0.5) + 0.5) * size;
    let slope = select(vec2f(0.0), slope_in_map(face, clip, along_x, along_y), light.bias_receiver_plane != 0u);
    let first = floor(place - 0.5 * f32(light.filter_width - 1u));
    var lit = 0.0;
    for (var row = 0u; row < light.filter_width; row++) {
        for (var column = 0u; column < light.filter_width; column++) {
            let texel = clamp(first + vec2f(f32(column), f32(row)), vec2f(0.0), size - 1.0);
            let offset = (texel + 0.5 - place) / size * vec2f(2.0, -2.0);
            let depth = device.z + dot(slope, offset);
            let stored = textureLoad(shadow_map, vec2i(texel), face, 0);
            // A texel at its clear value is covered by no caster.
            let is_nearer = select(depth <= stored, depth >= stored, light.map_clear == 0.0);
            lit += f32(stored == light.map_clear || is_nearer);
        }
    }
    return lit / f32(light.filter_width * light.filter_width);
}

// How the depth of the triangle's plane grows along x and y of the map: both are linear in device
// space, so two directions of the plane determine it. Zero for a plane that the light sees edge-on.
fn slope_in_map(face: u32, clip: vec4f, along_x: vec3f, along_y: vec3f) -> vec2f {
    let a = device_along(face, clip, along_x);
    let b = device_along(face, clip, along_y);
    let area = a.x * b.y - a.y * b.x;
    if area == 0.0 {
        return vec2f(0.0);
    }
    return vec2f(a.z * b.y - b.z * a.y, b.z * a.x - a.z * b.x) / area;
}

fn device_along(face: u32, clip: vec4f, direction: vec3f) -> vec3f {
    let moved = light.clip_from_relative[face] * vec4f(direction, 0.0);
    return (moved.xyz - clip.xyz * (moved.w / clip.w)) / clip.w;
}

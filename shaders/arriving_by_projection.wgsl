// The light arrives through the silhouettes of all casters but the surface's own.

@group(3) @binding(1) var silhouettes: texture_2d_array<f32>;
@group(3) @binding(2) var smooth_sampler: sampler;

fn arriving(surface: Surface) -> vec4f {
    var arriving = vec4f(1.0);
    for (var layer = 0u; layer < light.face_count; layer++) {
        arriving *= select(through(layer, surface.relative), vec4f(1.0), layer == draw.layer);
    }
    return arriving;
}

fn through(layer: u32, relative: vec3f) -> vec4f {
    let clip = light.clip_from_relative[layer] * vec4f(relative, 1.0);
    // Behind the light the same lines go on: nothing but this test keeps silhouettes off there.
    if clip.w <= 0.0 && light.projects_backwards == 0u {
        return vec4f(1.0);
    }
    let place = clip.xy / clip.w * vec2f(0.5, -0.5) + 0.5;
    // Outside its picture nothing is on the way; a small picture's edge is not clear.
    if light.repeats_edge == 0u && (any(place < vec2f(0.0)) || any(place > vec2f(1.0))) {
        return vec4f(1.0);
    }
    return textureSampleLevel(silhouettes, smooth_sampler, place, layer, 0.0);
}

// The light arrives as the receiver's own texture says.

@group(3) @binding(1) var textures: texture_2d_array<f32>;
@group(3) @binding(2) var smooth_sampler: sampler;

fn arriving(surface: Surface) -> vec4f {
    let has_none = draw.layer == NO_LAYER;
    let layer = select(draw.layer, 0u, has_none);
    let clip = light.clip_from_relative[layer] * vec4f(surface.relative, 1.0);
    let place = clip.xy / clip.w * vec2f(0.5, -0.5) + 0.5;
    return select(textureSampleLevel(textures, smooth_sampler, place, layer, 0.0), vec4f(1.0), has_none);
}

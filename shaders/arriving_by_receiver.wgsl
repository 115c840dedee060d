// The light arrives as the receiver's own texture says.

@group(3) @binding(1) var textures: texture_2d_array<f32>;
@group(3) @binding(2) var smooth_sampler: sampler;

fn arriving(surface: Surface) -> vec4f {
    if draw.layer == NO_LAYER {
        return vec4f(1.0);
    }
    let clip = light.clip_from_relative[draw.layer] * vec4f(surface.relative, 1.0);
    let place = clip.xy / clip.w * vec2f(0.5, -0.5) + 0.5;
    return textureSampleLevel(textures, smooth_sampler, place, draw.layer, 0.0);
}

// The light arrives where no shadow volume contains the surface.

@group(3) @binding(1) var counts: texture_2d<f32>;

fn arriving(surface: Surface) -> vec4f {
    return vec4f(f32(textureLoad(counts, vec2i(surface.clip.xy), 0).r == 0.0));
}

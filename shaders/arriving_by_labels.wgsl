// The light arrives where the labels made on the CPU say that it is lit.

@group(3) @binding(1) var labels: texture_2d<u32>;

fn arriving(surface: Surface) -> vec4f {
    return vec4f(f32(textureLoad(labels, vec2i(surface.clip.xy), 0).r == LIT));
}

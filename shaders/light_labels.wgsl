// What one light adds where the labels made on the CPU say that it is lit.

@group(3) @binding(1) var labels: texture_2d<u32>;

const LIT: u32 = 0u;

@fragment
fn fs_light_labels(surface: Surface) -> @location(0) vec4f {
    let label = textureLoad(labels, vec2i(surface.clip.xy), 0).r;
    return vec4f(select(vec3f(0.0), added(surface), label == LIT), 0.0);
}

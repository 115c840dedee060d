// The picture on a surface.

// Texture coordinates of each corner of each triangle; 0, 0 is the picture's lower left.
@group(2) @binding(4) var<storage, read> uvs: array<vec2f>;
@group(2) @binding(5) var picture: texture_2d<f32>;
@group(2) @binding(6) var picture_sampler: sampler;

// Linear RGB at a place of the picture, on the level whose texels are as large as a pixel. It compares neighbouring
// pixels: to be called in uniform control flow.
fn in_picture(uv: vec2f) -> vec3f {
    let size = vec2f(textureDimensions(picture));
    let longest = max(length(dpdx(uv) * size), length(dpdy(uv) * size));
    let level = log2(max(longest, 1.0));
    return textureSampleLevel(picture, picture_sampler, vec2f(uv.x, 1.0 - uv.y), level).rgb;
}

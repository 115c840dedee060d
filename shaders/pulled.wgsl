// A surface's data. Vertices are pulled: the triangle is known, so flat normals and per-triangle signs
// need no duplicated vertices, and positions are the same bits that other passes read.

@group(2) @binding(0) var<storage, read> positions: array<vec4f>;
@group(2) @binding(1) var<storage, read> corners: array<u32>;
// Three floats a normal, of what they belong to.
@group(2) @binding(2) var<storage, read> normals: array<f32>;
@group(2) @binding(3) var<storage, read> sides: array<u32>;

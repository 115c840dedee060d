// The light of programs that branch on what its map is like: storage, not uniform, see `uniforms.rs`.

@group(3) @binding(0) var<storage, read> light: Light;

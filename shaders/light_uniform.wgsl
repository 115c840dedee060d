// The light of programs that look nothing up in its map: no condition reads it, see `uniforms.rs`.

@group(3) @binding(0) var<uniform> light: Light;

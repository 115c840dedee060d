// Draws clip-space corners as they are.

@vertex
fn vs_probe(@location(0) corner: vec4f) -> @builtin(position) vec4f {
    return corner;
}

// Positions only: shadow volumes, caps, planar shadows, receiver marks and shadow maps.

@vertex
fn vs_position(@location(0) relative: vec4f) -> @invariant @builtin(position) vec4f {
    return clip_position(relative);
}

@fragment
fn fs_position_steps(@builtin(position) at: vec4f) -> @builtin(frag_depth) f32 {
    return floored(at.z);
}

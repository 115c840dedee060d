// Another program's draw: its vertices are in clip space already, and nothing is known of its colours.

@vertex
fn vs_recorded(@location(0) clip: vec4f) -> @invariant @builtin(position) vec4f {
    return clip;
}

@fragment
fn fs_recorded_steps(@builtin(position) at: vec4f) -> @builtin(frag_depth) f32 {
    return rounded(at.z);
}

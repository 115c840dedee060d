// Another program's draw: its vertices are in clip space already, and nothing is known of its colours.

// The largest depth as an integer, where depths are stored as integers.
override steps: f32 = 1.0;

@vertex
fn vs_recorded(@location(0) clip: vec4f) -> @invariant @builtin(position) vec4f {
    return clip;
}

// Rounds the depth to the nearest that an integer target stores.
@fragment
fn fs_recorded(@builtin(position) at: vec4f) -> @builtin(frag_depth) f32 {
    return round(at.z * steps) / steps;
}

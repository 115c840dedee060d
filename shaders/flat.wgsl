// Positions with one colour, one label or one count a draw.

@vertex
fn vs_flat(@location(0) relative: vec4f) -> @invariant @builtin(position) vec4f {
    return clip_position(relative);
}

struct Fragment {
    @builtin(position) clip: vec4f,
    @builtin(front_facing) is_front: bool,
}

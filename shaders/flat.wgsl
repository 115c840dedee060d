// Positions with one colour, one label or one count a draw.

@vertex
fn vs_flat(@location(0) relative: vec4f) -> @invariant @builtin(position) vec4f {
    return clip_position(relative);
}

@fragment
fn fs_flat() -> @location(0) vec4f {
    return draw.flat;
}

@fragment
fn fs_flat_steps(@builtin(position) at: vec4f) -> SteppedColor {
    return SteppedColor(draw.flat, floored(at.z));
}

@fragment
fn fs_flat_label() -> @location(0) u32 {
    return draw.label;
}

@fragment
fn fs_flat_label_steps(@builtin(position) at: vec4f) -> SteppedLabel {
    return SteppedLabel(draw.label, floored(at.z));
}

@fragment
fn fs_count(@builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    return counted(is_front);
}

@fragment
fn fs_count_steps(@builtin(position) at: vec4f, @builtin(front_facing) is_front: bool) -> SteppedColor {
    return SteppedColor(counted(is_front), floored(at.z));
}

fn counted(is_front: bool) -> vec4f {
    return vec4f(select(-draw.count, draw.count, is_front), 0.0, 0.0, 0.0);
}

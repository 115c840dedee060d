// The label of a visible surface: 0 lit, 1 shadow, 3 out of the light's reach: facing away, or beyond its range.

fn label_of(surface: Surface) -> u32 {
    if is_beyond_far(surface) {
        discard;
    }
    let label = select(draw.label, SHADOW, arriving(surface).a < 0.5);
    return select(label, AWAY, is_out_of_reach(surface));
}

@fragment
fn fs_label(surface: Surface) -> @location(0) u32 {
    return label_of(surface);
}

@fragment
fn fs_label_steps(surface: Surface) -> SteppedLabel {
    return SteppedLabel(label_of(surface), floored(surface.clip.z));
}

// Which share of the light arrives at a visible surface: none where it faces away or is beyond the light's range.

fn share_of_light(surface: Surface) -> f32 {
    if is_beyond_far(surface) {
        discard;
    }
    let share = arriving(surface).a;
    return select(share, 0.0, is_out_of_reach(surface));
}

@fragment
fn fs_visibility(surface: Surface) -> @location(0) f32 {
    return share_of_light(surface);
}

@fragment
fn fs_visibility_steps(surface: Surface) -> SteppedShare {
    return SteppedShare(share_of_light(surface), floored(surface.clip.z));
}

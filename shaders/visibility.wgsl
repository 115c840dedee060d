// Which share of the light arrives at a visible surface: none where it faces away or is beyond the light's range.

alias Fragment = Surface;
alias Value = f32;

fn value_of(surface: Fragment) -> Value {
    if is_beyond_far(surface) {
        discard;
    }
    let share = arriving(surface).a;
    return select(share, 0.0, is_out_of_reach(surface));
}

// The label of a visible surface: 0 lit, 1 shadow, 3 out of the light's reach: facing away, or beyond its range.

alias Fragment = Surface;
alias Value = u32;

fn value_of(surface: Fragment) -> Value {
    if is_beyond_far(surface) {
        discard;
    }
    let label = select(draw.label, SHADOW, arriving(surface).a < 0.5);
    return select(label, AWAY, is_out_of_reach(surface));
}

// What one silhouette lets through, to be multiplied with what is there.

alias Fragment = Surface;
alias Value = vec4f;

fn value_of(surface: Fragment) -> Value {
    if is_beyond_far(surface) {
        discard;
    }
    if !wraps && faces_away(surface.sides) {
        return vec4f(1.0);
    }
    return vec4f(through(draw.layer, surface.relative).rgb, 1.0);
}

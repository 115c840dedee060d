// What one silhouette lets through, to be multiplied with what is there.

@fragment
fn fs_through(surface: Surface) -> @location(0) vec4f {
    if is_beyond_far(surface) {
        discard;
    }
    if !wraps && faces_away(surface.sides) {
        return vec4f(1.0);
    }
    return vec4f(through(draw.layer, surface.relative).rgb, 1.0);
}

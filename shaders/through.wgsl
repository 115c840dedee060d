// What one silhouette lets through, to be multiplied with what is there.

fn let_through(surface: Surface) -> vec4f {
    if is_beyond_far(surface) {
        discard;
    }
    if !wraps && faces_away(surface.sides) {
        return vec4f(1.0);
    }
    return vec4f(through(draw.layer, surface.relative).rgb, 1.0);
}

@fragment
fn fs_through(surface: Surface) -> @location(0) vec4f {
    return let_through(surface);
}

@fragment
fn fs_through_steps(surface: Surface) -> SteppedColor {
    return SteppedColor(let_through(surface), floored(surface.clip.z));
}

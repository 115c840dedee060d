// The label of a visible surface: 0 lit, 1 shadow, 3 out of the light's reach: facing away, or beyond its range.

@fragment
fn fs_label(surface: Surface) -> @location(0) u32 {
    if is_beyond_far(surface) {
        discard;
    }
    let label = select(draw.label, SHADOW, arriving(surface).a < 0.5);
    let is_beyond_range = falloff(length(light.position.xyz - surface.relative * light.position.w)) == 0.0;
    return select(label, AWAY, faces_away(surface.sides) || is_beyond_range);
}

// The label of a visible surface, as the light's shadow map says.

@fragment
fn fs_label_map(surface: Surface) -> @location(0) u32 {
    let shadowed = select(1u, 0u, lit_by_map(surface.relative));
    return select(shadowed, AWAY, faces_away(surface.sides));
}

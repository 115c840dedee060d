// The label of a visible surface: 0 lit, 1 shadow, 3 faces away.

const AWAY: u32 = 3u;

@fragment
fn fs_label(surface: Surface) -> @location(0) u32 {
    return select(draw.label, AWAY, faces_away(surface.sides));
}

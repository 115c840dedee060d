// What one light adds where its shadow map lets it.

@fragment
fn fs_light_map(surface: Surface) -> @location(0) vec4f {
    return vec4f(select(vec3f(0.0), added(surface), lit_by_map(surface.relative)), 0.0);
}

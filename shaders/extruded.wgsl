// Vertices that the light decides about: they stay where the plane of their triangle faces it, and else go to the far
// end. `Carry` of the plan does the same steps on the CPU: keep them in this order.

fn extruded(near: vec4f, plane: vec4f) -> vec4f {
    let source = draw.extrude_from;
    let side = plane.x * source.x + plane.y * source.y + plane.z * source.z + plane.w * source.w;
    if side > 0.0 {
        return near;
    }
    let far = draw.extrude_to;
    return vec4f(far.w * near.x + far.x, far.w * near.y + far.y, far.w * near.z + far.z, draw.extruded_w);
}

@vertex
fn vs_extruded(@location(0) near: vec4f, @location(1) plane: vec4f) -> @invariant @builtin(position) vec4f {
    return clip_position(extruded(near, plane));
}

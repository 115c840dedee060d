// All of the light arrives: the depth and stencil tests have excluded the pixels in shadow.

fn arriving(surface: Surface) -> vec4f {
    return vec4f(1.0);
}

// What every program shares: the pass's view, and the one function that places vertices.
//
// Positions are homogeneous and relative to the view's origin; w = 0 is at infinity. Equal and
// z-fail depth tests rely on equal bits, so every program places vertices with this function and
// marks its position @invariant.

struct View {
    clip_from_relative: mat4x4f,
    // The point that all view rays start at; in a parallel projection their direction, with w = 0.
    eye: vec4f,
    // Linear RGB; the fourth is unused.
    ambient: vec4f,
}

@group(0) @binding(0) var<uniform> view: View;

fn clip_position(relative: vec4f) -> vec4f {
    return view.clip_from_relative * relative;
}

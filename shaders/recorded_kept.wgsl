// Another program's draw whose shader discards fragments: the list of those that it did not discard is known, and this
// discards all others.

// The fragments that are not discarded, sorted: column and row of the pixel in one word, and the triangle.
@group(2) @binding(0) var<storage, read> kept: array<vec2u>;

struct Corner {
    @invariant @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
}

// No two triangles share a vertex, so that a vertex's index gives its triangle.
@vertex
fn vs_recorded_kept(@location(0) clip: vec4f, @builtin(vertex_index) index: u32) -> Corner {
    return Corner(clip, index / 3);
}

fn is_before(one: vec2u, other: vec2u) -> bool {
    return one.x < other.x || (one.x == other.x && one.y < other.y);
}

fn is_kept(fragment: vec2u) -> bool {
    var low = 0u;
    var high = arrayLength(&kept);
    while low < high {
        let middle = (low + high) / 2;
        if is_before(kept[middle], fragment) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low < arrayLength(&kept) && all(kept[low] == fragment);
}

@fragment
fn fs_recorded_kept(corner: Corner) {
    let at = vec2u(corner.clip.xy);
    if !is_kept(vec2u(at.x | at.y << 16, corner.triangle)) {
        discard;
    }
}

@fragment
fn fs_recorded_kept_steps(corner: Corner) -> @builtin(frag_depth) f32 {
    let at = vec2u(corner.clip.xy);
    if !is_kept(vec2u(at.x | at.y << 16, corner.triangle)) {
        discard;
    }
    return rounded(corner.clip.z);
}

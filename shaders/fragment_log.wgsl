// Writes down every fragment: of which triangle, which side of it, and how deep. No test discards a
// fragment before this, since the log's own draws test nothing.

struct Fragment {
    // Index into the triangles that were asked about.
    triangle: u32,
    is_front: u32,
    depth: f32,
}

struct Log {
    // How many fragments there were, also those that `fragments` has no space for.
    count: atomic<u32>,
    fragments: array<Fragment>,
}

@group(1) @binding(0) var<storage, read_write> kept: Log;

struct Corner {
    @location(0) relative: vec4f,
    @location(1) triangle: u32,
}

struct Placed {
    @invariant @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
}

@vertex
fn vs_log(corner: Corner) -> Placed {
    return Placed(clip_position(corner.relative), corner.triangle);
}

// Another program's corners are in clip space already.
@vertex
fn vs_log_clip(corner: Corner) -> Placed {
    return Placed(corner.relative, corner.triangle);
}

@fragment
fn fs_log(placed: Placed, @builtin(front_facing) is_front: bool) {
    let slot = atomicAdd(&kept.count, 1u);
    if slot < arrayLength(&kept.fragments) {
        kept.fragments[slot] = Fragment(placed.triangle, u32(is_front), placed.clip.z);
    }
}

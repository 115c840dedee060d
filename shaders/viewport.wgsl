// Faces and lines with a depth buffer, and the picture of them laid into the window.

struct View {
    // Depth is reversed: 1 at the near plane.
    clip_from_stage: mat4x4f,
    // Where it is looked from; the direction towards the viewer, with w = 0, in parallel views.
    viewer: vec4f,
    // How much nearer a step is: as a fraction of the depth, and in absolute depth.
    step: vec2f,
    // Pixels.
    size: vec2f,
    pixels_per_point: f32,
}

@group(0) @binding(0) var<uniform> view: View;

// By how many steps shells and lines are drawn in front of what they lie on.
const SHELL_STEPS: f32 = 1.0;
const LINE_STEPS: f32 = 12.0;
// Opacity of the back of an object that contains others, which one looks through.
const GLASS: f32 = 0.07;
// Where what runs to infinity begins to fade, and where it is gone, in lengths of its corner at infinity.
const FADE: vec2f = vec2f(1.0, 3.5);

fn clip_position(at: vec4f, steps: f32) -> vec4f {
    var clip = view.clip_from_stage * at;
    clip.z += steps * (view.step.x * clip.z + view.step.y * clip.w);
    return clip;
}

struct Face {
    @builtin(position) clip: vec4f,
    // Premultiplied, shaded.
    @location(0) color: vec4f,
    // 0 at infinity.
    @location(1) w: f32,
}

// Lit by the viewer and a little from above, whichever way it is wound. A zero normal is not shaded. Once a corner: a CPU
// that draws fine meshes has less to do, and large faces are flat.
fn face(at: vec4f, normal: vec4f, color: vec4f, steps: f32) -> Face {
    var share = 1.0;
    if any(normal.xyz != vec3f(0.0)) {
        let facing = dot(normalize(normal.xyz), normalize(view.viewer.xyz - at.xyz * view.viewer.w));
        share = 0.52 + 0.34 * abs(facing) + 0.14 * normal.y * sign(facing);
    }
    return Face(clip_position(at, steps), vec4f(color.rgb * share, color.a), at.w);
}

@vertex
fn vs_solid(@location(0) at: vec4f, @location(1) normal: vec4f, @location(2) color: vec4f) -> Face {
    return face(at, normal, color, 0.0);
}

@vertex
fn vs_shell(@location(0) at: vec4f, @location(1) normal: vec4f, @location(2) color: vec4f) -> Face {
    // Glass lies on nothing.
    return face(at, normal, color, SHELL_STEPS * f32(all(normal.xyz == vec3f(0.0))));
}

@fragment
fn fs_solid(in: Face) -> @location(0) vec4f {
    return in.color;
}

@fragment
fn fs_glass(in: Face) -> @location(0) vec4f {
    return in.color * GLASS;
}

@fragment
fn fs_shell(in: Face) -> @location(0) vec4f {
    return in.color * (1.0 - smoothstep(FADE.x, FADE.y, (1.0 - in.w) / max(in.w, 1e-6)));
}

struct Stroke {
    @builtin(position) clip: vec4f,
    @location(0) color: vec4f,
    // Pixels from the middle of the line, and where its border is.
    @location(1) @interpolate(linear) across: f32,
    @location(2) @interpolate(flat) half_width: f32,
}

// A corner of a line: a rectangle on the screen, four corners as a strip.
@vertex
fn vs_line(
    @builtin(vertex_index) corner: u32,
    @location(0) from_point: vec3f,
    @location(1) width: f32,
    @location(2) to_point: vec3f,
    @location(3) color: vec4f,
) -> Stroke {
    var a = clip_position(vec4f(from_point, 1.0), LINE_STEPS);
    var b = clip_position(vec4f(to_point, 1.0), LINE_STEPS);
    // Both ends on this side of the near plane, or a line of no length.
    let before = vec2f(a.w - a.z, b.w - b.z);
    if before.x < 0.0 && before.y < 0.0 {
        return Stroke(vec4f(0.0, 0.0, 0.0, 1.0), color, 0.0, 0.0);
    }
    if before.x < 0.0 {
        a = mix(a, b, before.x / (before.x - before.y));
    } else if before.y < 0.0 {
        b = mix(b, a, before.y / (before.y - before.x));
    }
    let pixel = 2.0 / view.size;
    let along = (b.xy / b.w - a.xy / a.w) / pixel;
    let direction = along / max(length(along), 1e-6);
    let half_width = width * view.pixels_per_point / 2.0;
    let across = (half_width + 1.0) * select(-1.0, 1.0, (corner & 1u) == 1u);
    let is_end = corner >= 2u;
    var clip = select(a, b, is_end);
    // A little longer each way, so that the lines of an outline meet.
    let offset = vec2f(-direction.y, direction.x) * across + direction * select(-0.3, 0.3, is_end) * half_width;
    clip = vec4f(clip.xy + offset * pixel * clip.w, clip.zw);
    return Stroke(clip, color, across, half_width);
}

@fragment
fn fs_line(in: Stroke) -> @location(0) vec4f {
    // What is thinner than a pixel is fainter instead.
    return in.color * clamp(in.half_width + 0.5 - abs(in.across), 0.0, 1.0) * min(2.0 * in.half_width, 1.0);
}

struct Texel {
    @builtin(position) clip: vec4f,
    @location(0) at: vec2f,
}

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var smooth_sampler: sampler;

// One triangle over all of the rectangle.
@vertex
fn vs_window(@builtin(vertex_index) corner: u32) -> Texel {
    let at = vec2f(f32(corner & 1u) * 2.0, f32(corner >> 1u) * 2.0);
    return Texel(vec4f(at.x * 2.0 - 1.0, 1.0 - at.y * 2.0, 0.0, 1.0), at);
}

@fragment
fn fs_window(in: Texel) -> @location(0) vec4f {
    return textureSample(picture, smooth_sampler, in.at);
}

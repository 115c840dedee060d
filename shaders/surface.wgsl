// Surfaces with what shading and labels need.

const NOT_REVERSED: u32 = 0xffffffffu;
const SEES_BACK: u32 = 0x80000000u;
// Labels.
const LIT: u32 = 0u;
const SHADOW: u32 = 1u;
const AWAY: u32 = 3u;

struct Light {
    // Homogeneous, relative to the eye.
    position: vec4f,
    // Linear RGB times intensity.
    color: vec3f,
    // Distance at which it has faded to nothing, metres; 0 for no falloff.
    range: f32,
    // Which bit of a triangle's `sides` belongs to this light.
    index: u32,
    unused: u32,
    // Faces of its map, and what their depth was cleared to: 0 where depth is reversed.
    face_count: u32,
    map_clear: f32,
    // How far lookups are moved off the surface, in texels; along the surface's plane where not 0;
    // texels averaged along each side.
    bias_normal: f32,
    bias_receiver_plane: u32,
    filter_width: u32,
    // Projected silhouettes reach behind the light.
    projects_backwards: u32,
    // Beyond the edge of a silhouette's picture its last texels are repeated.
    repeats_edge: u32,
    clip_from_relative: array<mat4x4f, 64>,
}

// What a pipeline's draws and light have; see `specialization.rs`.
override is_gouraud: bool = true;
override has_gloss: bool = true;
override fades: bool = true;
override wraps: bool = true;
override is_depth_clamped: bool = true;
// What the far end of clip space is stored as: the end of the viewport's depth range.
override farthest_depth: f32 = 1.0;

struct Surface {
    @invariant @builtin(position) clip: vec4f,
    // Relative to the eye.
    @location(0) relative: vec3f,
    // Towards the side that the eye sees.
    @location(1) normal: vec3f,
    // Gouraud's light.
    @location(2) diffuse: vec3f,
    @location(3) gloss: vec3f,
    @location(4) @interpolate(flat) sides: u32,
}

@vertex
fn vs_surface(@builtin(vertex_index) vertex_index: u32) -> Surface {
    return surface_at(vertex_index);
}

fn surface_at(vertex_index: u32) -> Surface {
    let in_order = vertex_index / 3u;
    let triangle = select(draw.reversed_sum - in_order, in_order, draw.reversed_sum == NOT_REVERSED);
    let corner = triangle * 3u + vertex_index % 3u;
    let vertex = corners[corner];
    let relative = positions[vertex];
    var out: Surface;
    out.clip = clip_position(relative);
    out.relative = relative.xyz;
    out.sides = sides[triangle];
    let index = select(vertex, triangle, draw.normals_per == PER_TRIANGLE);
    let at = 3u * select(index, corner, draw.normals_per == PER_CORNER);
    let normal = vec3f(normals[at], normals[at + 1u], normals[at + 2u]);
    out.normal = select(normal, -normal, (out.sides & SEES_BACK) != 0u);
    if is_gouraud {
        let light_here = light_on(out.relative, out.normal);
        out.diffuse = light_here.diffuse;
        out.gloss = light_here.gloss;
    }
    return out;
}

// Clamped depth is 1 beyond the far plane, which is also what nothing was drawn at.
fn is_beyond_far(surface: Surface) -> bool {
    return is_depth_clamped && surface.clip.z > farthest_depth;
}

fn faces_away(surface_sides: u32) -> bool {
    return (surface_sides & (1u << light.index)) != 0u;
}

// Out of the light's reach: facing away from it, or beyond its range.
fn is_out_of_reach(surface: Surface) -> bool {
    let to_light = light.position.xyz - surface.relative * light.position.w;
    return faces_away(surface.sides) || falloff(length(to_light)) == 0.0;
}

struct LightOn {
    // Lambert's, or wrapped.
    diffuse: vec3f,
    // Blinn-Phong's highlight, which no pattern darkens.
    gloss: vec3f,
}

fn light_on(relative: vec3f, normal: vec3f) -> LightOn {
    let to_light = light.position.xyz - relative * light.position.w;
    let direction = normalize(to_light);
    let cosine = dot(normal, direction);
    let diffuse = select(max(cosine, 0.0), 0.5 * cosine + 0.5, wraps);
    let arriving = light.color * falloff(length(to_light));
    if !has_gloss {
        return LightOn(arriving * draw.color * diffuse, vec3f(0.0));
    }
    let halfway = normalize(direction + normalize(view.eye.xyz - relative * view.eye.w));
    let gloss = select(0.0, draw.specular * pow(max(dot(normal, halfway), 0.0), draw.shininess), cosine > 0.0);
    return LightOn(arriving * draw.color * diffuse, arriving * gloss);
}

fn falloff(distance: f32) -> f32 {
    if !fades {
        return 1.0;
    }
    let inside = max(1.0 - distance * distance / (light.range * light.range), 0.0);
    return inside * inside;
}

// The material's colour under ambient light, and what it sends out by itself.

alias Value = vec4f;

// Where depth is clamped nothing clips at the near plane: this does.
override from_near: bool = true;
// What the near end of clip space is stored as: the beginning of the viewport's depth range.
override nearest_depth: f32 = 0.0;

fn in_ambient_light(color: vec3f, depth: f32) -> Value {
    if from_near && depth < nearest_depth {
        discard;
    }
    return vec4f(color * view.ambient.rgb + draw.emission, 1.0);
}

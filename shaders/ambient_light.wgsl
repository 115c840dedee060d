// The material's colour under ambient light, and what it sends out by itself.

alias Value = vec4f;

// Where depth is clamped nothing clips at the near plane: this does.
override from_near: bool = true;

fn in_ambient_light(color: vec3f, depth: f32) -> Value {
    if from_near && depth < 0.0 {
        discard;
    }
    return vec4f(color * view.ambient.rgb + draw.emission, 1.0);
}

alias Value = vec4f;

fn value_of(at: Fragment) -> Value {
    return vec4f(select(-draw.count, draw.count, at.is_front), 0.0, 0.0, 0.0);
}

alias Value = vec4f;

fn value_of(at: Fragment) -> Value {
    return draw.flat;
}

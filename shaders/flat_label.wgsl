alias Value = u32;

fn value_of(at: Fragment) -> Value {
    return draw.label;
}

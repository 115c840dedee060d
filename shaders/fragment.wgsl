// The fragment entry points of each program that writes a value. The program's own file says what it gets of the vertex
// shader, `Fragment` with the place `clip`, what it writes, `Value`, and which value, `value_of`.

struct ValueAndDepth {
    @location(0) value: Value,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn fs_value(at: Fragment) -> @location(0) Value {
    return value_of(at);
}

@fragment
fn fs_value_steps(at: Fragment) -> ValueAndDepth {
    return ValueAndDepth(value_of(at), floored(at.clip.z));
}

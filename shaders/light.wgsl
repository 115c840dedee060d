// One light on a surface of one colour.

alias Fragment = Surface;

fn value_of(surface: Fragment) -> Value {
    return light_added(surface, vec3f(in_checks(surface.relative)));
}

// Depths that are stored as integers, by targets that hold them as floats. Fragment entry points whose names end with
// `_steps` write them: a rasteriser's own depth would go through the test unrounded.

// The largest depth as an integer, 2^bits - 1.
override steps: f32 = 1.0;
// A power of two, so that products with it are exact.
override part: f32 = 1.0 / (steps + 1.0);
// A draw's constant bias, as a depth: the rasteriser's own is in units of a float's last place.
override constant_bias: f32 = 0.0;

// The integer below, as fixed-point depth is defined: floor(depth * steps) / steps. `floored_depth` of the plan does the
// same steps on the CPU. The quotient is its series k/2^b + k/4^b + k/8^b, as a GPU may round a division otherwise.
fn floored(depth: f32) -> f32 {
    let biased = clamp(depth + constant_bias, 0.0, 1.0);
    // steps * biased would round: the same is 2^bits * biased, which is exact, less biased.
    let scaled = biased * (steps + 1.0);
    let below = floor(scaled);
    let whole = below - f32(scaled - below < biased);
    return whole * part + (whole * part * part + whole * part * part * part);
}

// The nearest integer, as another program's GPU stored it.
fn rounded(depth: f32) -> f32 {
    return round(depth * steps) / steps;
}

// Depths that are stored as integers, by targets that hold them as floats. Fragment entry points whose names end with
// `_steps` write them: a rasteriser's own depth would go through the test unrounded.

// The largest depth as an integer, 2^bits - 1.
override steps: f32 = 1.0;
// A draw's constant bias, as a depth: the rasteriser's own is in units of a float's last place.
override constant_bias: f32 = 0.0;

// The integer below, as fixed-point depth is defined: floor(depth * steps) / steps. `DepthBits::floored` does the
// same steps on the CPU.
fn floored(depth: f32) -> f32 {
    let biased = clamp(depth + constant_bias, 0.0, 1.0);
    // steps * biased would round: the same is 2^bits * biased, which is exact, less biased.
    let scaled = biased * (steps + 1.0);
    let below = floor(scaled);
    let whole = below - f32(scaled - below < biased);
    return quotient(u32(whole));
}

// whole / steps, rounded to the nearest float by integers alone: GPUs round divisions otherwise, and may reorder sums. In
// binary it repeats the b bits of `whole` for ever, so its mantissa is 24 of them from the first 1 on, and one more rounds.
fn quotient(whole: u32) -> f32 {
    if whole == 0u {
        return 0.0;
    }
    var width = countOneBits(u32(steps));
    var period = whole;
    // Two short periods are one of twice as many bits.
    while width < 16u {
        period = (period << width) | period;
        width = 2u * width;
    }
    let zeros = countLeadingZeros(period) + width - 32u;
    let all = (1u << width) - 1u;
    let from_first = ((period << zeros) | (period >> (width - zeros))) & all;
    let bits = (from_first << (32u - width)) | (from_first >> (2u * width - 32u));
    let mantissa = (bits >> 8u) + ((bits >> 7u) & 1u);
    return f32(mantissa) * bitcast<f32>((103u - zeros) << 23u);
}

// The nearest integer, as another program's GPU stored it.
fn rounded(depth: f32) -> f32 {
    return round(depth * steps) / steps;
}

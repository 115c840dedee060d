//! Colours of pixels: as pictures store them, and the terms that they are sums of.

use stencilscope::reading::shading::SurfaceShading;
use stencilscope::testing::Rendered;

/// The terms of a pixel's colour, if a surface is there.
pub fn shaded(frame: &mut Rendered, at: [u32; 2]) -> Option<SurfaceShading> {
    let history = frame.at(at).history().clone();
    SurfaceShading::of(frame.capture(), frame.plan(), &history)
}

/// The linear value, from 0 to 1, of an sRGB byte of a picture.
pub fn linear(byte: u8) -> f64 {
    let value = f64::from(byte) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// A linear value as sRGB, from 0 to 255 and not rounded.
pub fn srgb(linear: f64) -> f64 {
    let linear = linear.clamp(0.0, 1.0);
    255.0 * if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

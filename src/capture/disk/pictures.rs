//! Colour images as PNG files: 8 bits a channel with alpha, marked as sRGB.

use crate::capture::{CaptureError, Image, PixelFormat};
use std::fs::File;
use std::io::{BufReader, BufWriter, Write};
use std::path::Path;

/// Writes a colour image.
///
/// # Errors
/// The file can't be written.
pub fn write_image(path: &Path, image: &Image) -> Result<(), CaptureError> {
    let fail = |error: png::EncodingError| CaptureError::write(path, error);
    let io_fail = |error: std::io::Error| CaptureError::write(path, error);
    let file = BufWriter::new(File::create_new(path).map_err(io_fail)?);
    let [width, height] = image.size();
    let mut encoder = png::Encoder::new(file, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header().map_err(fail)?;
    let mut stream = writer.stream_writer().map_err(fail)?;
    for row in image.rows() {
        stream.write_all(row).map_err(io_fail)?;
    }
    stream.finish().map_err(fail)?;
    writer.finish().map_err(fail)
}

/// Reads a colour image of this size.
///
/// # Errors
/// The file can't be read, or holds another kind of picture.
pub fn read_image(path: &Path, size: [u32; 2]) -> Result<Image, CaptureError> {
    let fail = |error: png::DecodingError| CaptureError::broken(path, error);
    let file = File::open(path).map_err(|error| CaptureError::broken(path, error))?;
    let mut reader = png::Decoder::new(BufReader::new(file)).read_info().map_err(fail)?;
    let info = reader.info();
    let is_rgba = info.color_type == png::ColorType::Rgba && info.bit_depth == png::BitDepth::Eight;
    if !is_rgba || [info.width, info.height] != size {
        return Err(CaptureError::broken(path, format!("is no 8-bit RGBA picture of {}x{}", size[0], size[1])));
    }
    let length = size[0] as usize * size[1] as usize * PixelFormat::Rgba8Srgb.texel_bytes();
    let mut bytes = vec![0; length];
    reader.next_frame(&mut bytes).map_err(fail)?;
    Ok(Image::packed(PixelFormat::Rgba8Srgb, size, bytes))
}

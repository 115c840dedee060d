//! Single files of a capture: `.npy` arrays and `.png` pictures.
//!
//! Arrays are C order, shape (height, width), row 0 at the top, or (faces, size, size) for shadow
//! maps; stencil and labels are `|u1`, depth and counts `<f4`. A light's textures are
//! (layers, size, size, 4), `|u1`.

use super::npy::{self, Array, Element};
use super::store::CaptureFiles;
use super::{CaptureError, Image, PixelFormat};
use std::io::{self, Cursor, Read, Write};
use std::sync::Arc;

/// Texels along a side of the largest picture that is read: the size in a file's header is not trusted.
pub(super) const LARGEST: u32 = 1 << 15;
/// How the names of pictures end that are not arrays.
const PNG: &str = ".png";

/// Writes one picture: as PNG where its file is named so, else as a NumPy array.
pub(super) fn write_image(files: &CaptureFiles, file: &str, image: &Image) -> Result<(), CaptureError> {
    match file.ends_with(PNG) {
        true => files.write(file, |out| write_png(out, image)),
        false => files.write(file, |out| write_array(out, image)),
    }
}

/// Writes one picture as a NumPy array, whatever its format.
pub(super) fn write_array(out: &mut dyn Write, image: &Image) -> io::Result<()> {
    write_arrays(out, &[], [image], image)
}

/// Writes values, row-major, as a NumPy array of shape (rows, `columns`), or of one dimension where `columns` is 1. The
/// number of values must be a multiple of `columns`.
pub(super) fn write_values<T: Element>(
    files: &CaptureFiles,
    file: &str,
    values: &[T],
    columns: u64,
) -> Result<(), CaptureError> {
    let shape = [values.len() as u64 / columns, columns];
    let shape = if columns == 1 { &shape[..1] } else { &shape[..] };
    files.write(file, |mut out| {
        npy::write_header::<T>(&mut out, shape)?;
        out.write_all(bytemuck::cast_slice(values))
    })
}

/// Reads an array that [`write_values`] wrote, row by row. Fails where its shape is not (any number, `columns`), or of
/// one dimension for 1 column, or its numbers are of another type.
pub(super) fn read_values<T: Element>(files: &CaptureFiles, file: &str, columns: u64) -> Result<Vec<T>, CaptureError> {
    let read = || {
        let (array, bytes) = open(files, file)?;
        let shape = array.shape();
        let is_expected = if columns == 1 { shape.len() == 1 } else { shape.len() == 2 && shape[1] == columns };
        if !is_expected {
            return Err(format!("its rows have not {columns} values"));
        }
        array.into_vec(bytes)
    };
    read().map_err(|reason| broken(files, file, reason))
}

/// Writes pictures of one size and format as one NumPy array whose first dimension is the picture. Fails where there
/// are none.
pub(super) fn write_layers(out: &mut dyn Write, layers: &[Arc<Image>]) -> io::Result<()> {
    let first = layers.first().ok_or_else(|| io::Error::other("a map without faces"))?;
    write_arrays(out, &[layers.len() as u64], layers.iter().map(Arc::as_ref), first)
}

/// Writes pictures of the size and format of `first` as one NumPy array of shape `outer`, height, width, and 4 for
/// colours. `first` itself is only written if it is among `images`.
fn write_arrays<'a>(
    mut out: &mut dyn Write,
    outer: &[u64],
    images: impl IntoIterator<Item = &'a Image>,
    first: &Image,
) -> io::Result<()> {
    let [width, height] = first.size();
    let mut shape = [outer, &[u64::from(height), u64::from(width)]].concat();
    match first.format() {
        PixelFormat::Depth32F | PixelFormat::Value32F => npy::write_header::<f32>(&mut out, &shape)?,
        format => {
            if format != PixelFormat::U8 {
                shape.push(format.texel_bytes() as u64);
            }
            npy::write_header::<u8>(&mut out, &shape)?;
        }
    }
    images.into_iter().flat_map(Image::rows).try_for_each(|row| out.write_all(row))
}

fn write_png(out: &mut dyn Write, image: &Image) -> io::Result<()> {
    let [width, height] = image.size();
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&image.rows().collect::<Vec<_>>().concat())?;
    writer.finish()?;
    Ok(())
}

/// Reads one picture as the given format: a PNG where its file is named so, which only sRGB colour is, else a NumPy
/// array. Fails where the file's type or shape is not that of the format.
pub(super) fn read_image(files: &CaptureFiles, file: &str, format: PixelFormat) -> Result<Image, CaptureError> {
    let read = match format {
        PixelFormat::Rgba8Srgb if file.ends_with(PNG) => read_png(files, file),
        PixelFormat::Depth32F | PixelFormat::Value32F => read_floats(files, file, format, 2),
        PixelFormat::U8 | PixelFormat::Rgba8 | PixelFormat::Rgba8Srgb => read_bytes(files, file, format, 2),
    };
    let one = read.map(|mut images| images.pop()).map_err(|reason| broken(files, file, reason))?;
    one.ok_or_else(|| broken(files, file, "it is empty".to_owned()))
}

/// Reads all layers of a NumPy array of pictures: an array of three dimensions as depths (faces of a shadow map), any
/// other as linear RGBA (a light's textures).
pub(super) fn read_layers(files: &CaptureFiles, file: &str) -> Result<Vec<Image>, CaptureError> {
    let read = open(files, file).and_then(|(array, _)| match array.shape().len() {
        3 => read_floats(files, file, PixelFormat::Depth32F, 3),
        _ => read_bytes(files, file, PixelFormat::Rgba8, 3),
    });
    read.map_err(|reason| broken(files, file, reason))
}

/// Bytes of the longest text that is read.
const MOST_TEXT: u64 = 2 << 30;

/// Reads a UTF-8 text file; fails where it is larger than a text of a capture folder may be, or no plain file.
pub(super) fn read_text(files: &CaptureFiles, file: &str) -> Result<String, CaptureError> {
    let bytes = files.read(file, MOST_TEXT).map_err(|reason| broken(files, file, reason))?;
    String::from_utf8(bytes.into()).map_err(|_| broken(files, file, "it is no text".to_owned()))
}

fn broken(files: &CaptureFiles, file: &str, reason: String) -> CaptureError {
    CaptureError::Read { file: files.path(file), reason }
}

/// Opens a NumPy file and reads its header; returns the array, whose numbers are not read yet, and the size of the
/// whole file in bytes.
fn open(files: &CaptureFiles, file: &str) -> Result<(Array<Box<dyn Read>>, u64), String> {
    let (file, bytes) = files.open(file)?;
    Ok((Array::open(file)?, bytes))
}

fn read_floats(files: &CaptureFiles, file: &str, format: PixelFormat, dimensions: usize) -> Result<Vec<Image>, String> {
    let (array, bytes) = open(files, file)?;
    let shape = array.shape().to_vec();
    layers(&shape, bytemuck::cast_slice(&array.into_vec::<f32>(bytes)?), format, dimensions)
}

fn read_bytes(files: &CaptureFiles, file: &str, format: PixelFormat, dimensions: usize) -> Result<Vec<Image>, String> {
    let (array, bytes) = open(files, file)?;
    let mut shape = array.shape().to_vec();
    let channels = format.texel_bytes() as u64;
    if channels > 1 && shape.pop() != Some(channels) {
        return Err(format!("its texels have not {channels} channels"));
    }
    layers(&shape, &array.into_vec::<u8>(bytes)?, format, dimensions)
}

fn layers(shape: &[u64], bytes: &[u8], format: PixelFormat, dimensions: usize) -> Result<Vec<Image>, String> {
    if shape.len() != dimensions {
        return Err(format!("it has not {dimensions} dimensions"));
    }
    let (width, height) = (shape[dimensions - 1], shape[dimensions - 2]);
    let size = size(width, height)?;
    let layer_bytes = size[0] as usize * size[1] as usize * format.texel_bytes();
    Ok(bytes.chunks_exact(layer_bytes).map(|layer| Image::packed(format, size, layer.to_vec())).collect())
}

fn size(width: u64, height: u64) -> Result<[u32; 2], String> {
    let fits = |n: u64| u32::try_from(n).ok().filter(|n| (1..=LARGEST).contains(n));
    match [fits(width), fits(height)] {
        [Some(width), Some(height)] => Ok([width, height]),
        _ => Err(format!("its size is {width}x{height}")),
    }
}

fn read_png(files: &CaptureFiles, file: &str) -> Result<Vec<Image>, String> {
    // The decoder wants to seek.
    let bytes = files.read(file, MOST_TEXT)?;
    let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().map_err(|error| error.to_string())?;
    size(u64::from(reader.info().width), u64::from(reader.info().height))?;
    let length = reader.output_buffer_size().ok_or("it is too large")?;
    let mut bytes = vec![0; length];
    let info = reader.next_frame(&mut bytes).map_err(|error| error.to_string())?;
    if (info.color_type, info.bit_depth) != (png::ColorType::Rgba, png::BitDepth::Eight) {
        return Err("it is not RGBA with 8 bits a channel".to_owned());
    }
    Ok(vec![Image::packed(PixelFormat::Rgba8Srgb, [info.width, info.height], bytes)])
}

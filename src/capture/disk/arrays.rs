//! Images as NumPy arrays in C order: (height, width), or (faces, height, width) for maps.

use crate::capture::{CaptureError, Image, PixelFormat};
use npyz::{DType, NpyFile, Order, TypeStr, WriterBuilder};
use std::fs::File;
use std::io::{BufWriter, Read, Write};
use std::path::Path;
use std::sync::Arc;

/// Texels along a side of the largest map that is read.
const LARGEST: u32 = 1 << 15;

/// One picture, rows from the top.
///
/// # Errors
/// The file can't be written.
pub fn write_image(path: &Path, image: &Image) -> Result<(), CaptureError> {
    let [width, height] = image.size().map(u64::from);
    write_layers(path, &[image], &[height, width])
}

/// The faces of a map, all of one size and format.
///
/// # Errors
/// The file can't be written, or there are no faces.
pub fn write_faces(path: &Path, faces: &[Arc<Image>]) -> Result<(), CaptureError> {
    let first = faces.first().ok_or_else(|| CaptureError::write(path, "a shadow map without faces"))?;
    let [width, height] = first.size().map(u64::from);
    let layers: Vec<&Image> = faces.iter().map(AsRef::as_ref).collect();
    write_layers(path, &layers, &[faces.len() as u64, height, width])
}

/// One picture of this format and size.
///
/// # Errors
/// The file can't be read, or holds something else.
pub fn read_image(path: &Path, format: PixelFormat, size: [u32; 2]) -> Result<Image, CaptureError> {
    let (shape, bytes) = read_array(path, format)?;
    if shape != [u64::from(size[1]), u64::from(size[0])] {
        return Err(CaptureError::broken(
            path,
            format!("has shape {shape:?}, but the picture is {}x{}", size[0], size[1]),
        ));
    }
    Ok(Image::packed(format, size, bytes))
}

/// The faces of a depth map.
///
/// # Errors
/// The file can't be read, or holds something else.
pub fn read_faces(path: &Path) -> Result<Vec<Arc<Image>>, CaptureError> {
    let format = PixelFormat::Depth32F;
    let (shape, bytes) = read_array(path, format)?;
    let sizes = shape.iter().map(|n| u32::try_from(*n)).collect::<Result<Vec<u32>, _>>();
    let Ok([1..=6, height @ 1..=LARGEST, width @ 1..=LARGEST]) = sizes.as_deref() else {
        return Err(CaptureError::broken(path, format!("has shape {shape:?} in place of (faces, size, size)")));
    };
    let bytes = bytes::Bytes::from(bytes);
    let face_bytes = *width as usize * *height as usize * format.texel_bytes();
    let faces = (0..bytes.len() / face_bytes).map(|face| bytes.slice(face * face_bytes..(face + 1) * face_bytes));
    Ok(faces.map(|rows| Arc::new(Image::packed(format, [*width, *height], rows))).collect())
}

fn write_layers(path: &Path, layers: &[&Image], shape: &[u64]) -> Result<(), CaptureError> {
    let fail = |error: std::io::Error| CaptureError::write(path, error);
    let format = layers.first().map_or(PixelFormat::U8, |image| image.format());
    let dtype = dtype(format).ok_or_else(|| CaptureError::write(path, "a colour picture is no array"))?;
    let file = BufWriter::with_capacity(1 << 18, File::create_new(path).map_err(fail)?);
    let header = npyz::WriteOptions::new_header_only().dtype(dtype).shape(shape).writer(file);
    let mut file = header.write_header_only().map_err(fail)?;
    for row in layers.iter().flat_map(|image| image.rows()) {
        file.write_all(row).map_err(fail)?;
    }
    file.flush().map_err(fail)
}

/// Shape and texels, as many as the shape says.
fn read_array(path: &Path, format: PixelFormat) -> Result<(Vec<u64>, Vec<u8>), CaptureError> {
    let fail = |error: std::io::Error| CaptureError::broken(path, error);
    let file = File::open(path).map_err(fail)?;
    // What the header promises can't be more than the file holds.
    let file_bytes = file.metadata().map_err(fail)?.len();
    let array = NpyFile::new(std::io::BufReader::new(file)).map_err(fail)?;
    if Some(array.dtype()) != dtype(format) || array.order() != Order::C {
        return Err(CaptureError::broken(
            path,
            format!("is no {} array in C order", type_name(format).unwrap_or("byte")),
        ));
    }
    let shape = array.shape().to_vec();
    let texels = shape.iter().try_fold(format.texel_bytes() as u64, |product, n| product.checked_mul(*n));
    let expected = texels.filter(|bytes| *bytes <= file_bytes);
    let mut bytes = Vec::new();
    array.into_inner().read_to_end(&mut bytes).map_err(fail)?;
    if expected != Some(bytes.len() as u64) {
        return Err(CaptureError::broken(
            path,
            format!("has {} bytes of texels, not what shape {shape:?} needs", bytes.len()),
        ));
    }
    Ok((shape, bytes))
}

/// NumPy's name of the element type.
fn type_name(format: PixelFormat) -> Option<&'static str> {
    match format {
        PixelFormat::Rgba8Srgb => None,
        PixelFormat::Depth32F => Some("<f4"),
        PixelFormat::U8 => Some("|u1"),
    }
}

fn dtype(format: PixelFormat) -> Option<DType> {
    let name: TypeStr = type_name(format)?.parse().ok()?;
    Some(DType::Plain(name))
}

//! Single files of a capture folder: `.npy` arrays and `.png` pictures.
//!
//! Arrays are C order, shape (height, width), row 0 at the top, or (faces, size, size) for shadow
//! maps; stencil and labels are `|u1`, depth `<f4` as stored in the buffer.

use super::{CaptureError, Image, PixelFormat};
use npyz::WriterBuilder;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Write};
use std::path::Path;
use std::sync::Arc;

/// Texels along a side of the largest picture that is read: what a file claims is not trusted.
pub(super) const LARGEST: u32 = 1 << 15;

/// Creates a file, lets `fill` write it, and makes sure that all of it arrived.
pub(super) fn write(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), CaptureError> {
    let filled = File::create(path).map(BufWriter::new).and_then(|mut out| {
        fill(&mut out)?;
        out.flush()
    });
    filled.map_err(|source| CaptureError::Write { file: path.to_owned(), source })
}

/// One picture: PNG for colour, NumPy for the rest.
pub(super) fn write_image(path: &Path, image: &Image) -> Result<(), CaptureError> {
    match image.format() {
        PixelFormat::Rgba8Srgb => write(path, |out| write_png(out, image)),
        PixelFormat::Depth32F => write(path, |out| write_depths(out, &shape(image), [image])),
        PixelFormat::U8 => write(path, |out| write_bytes(out, image)),
    }
}

/// Pictures of one size and format as one array with a dimension more.
pub(super) fn write_layers(path: &Path, layers: &[Arc<Image>]) -> Result<(), CaptureError> {
    write(path, |out| {
        let first = layers.first().ok_or_else(|| io::Error::other("a shadow map without faces"))?;
        let [height, width] = shape(first);
        let full = [layers.len() as u64, height, width];
        write_depths(out, &full, layers.iter().map(Arc::as_ref))
    })
}

fn shape(image: &Image) -> [u64; 2] {
    let [width, height] = image.size();
    [u64::from(height), u64::from(width)]
}

fn write_depths<'a>(
    out: &mut impl Write,
    shape: &[u64],
    layers: impl IntoIterator<Item = &'a Image>,
) -> io::Result<()> {
    let mut array = npyz::WriteOptions::new().default_dtype().shape(shape).writer(out).begin_nd()?;
    for image in layers {
        for row in image.rows() {
            array.extend(row.chunks_exact(4).map(bytemuck::pod_read_unaligned::<f32>))?;
        }
    }
    array.finish()
}

fn write_bytes(out: &mut impl Write, image: &Image) -> io::Result<()> {
    let mut array = npyz::WriteOptions::new().default_dtype().shape(&shape(image)).writer(out).begin_nd()?;
    for row in image.rows() {
        array.extend(row.iter().copied())?;
    }
    array.finish()
}

fn write_png(out: &mut impl Write, image: &Image) -> io::Result<()> {
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

/// One picture of the format that its place in the manifest asks for.
pub(super) fn read_image(path: &Path, format: PixelFormat) -> Result<Image, CaptureError> {
    let read = match format {
        PixelFormat::Rgba8Srgb => read_png(path),
        PixelFormat::Depth32F => read_depths(path).and_then(|(shape, values)| layers(&shape, &values, 2)),
        PixelFormat::U8 => read_bytes(path),
    };
    let one = read.map(|mut images| images.pop()).map_err(|reason| broken(path, reason))?;
    one.ok_or_else(|| broken(path, "it is empty".to_owned()))
}

/// The layers of a shadow map.
pub(super) fn read_layers(path: &Path) -> Result<Vec<Image>, CaptureError> {
    read_depths(path).and_then(|(shape, values)| layers(&shape, &values, 3)).map_err(|reason| broken(path, reason))
}

fn broken(path: &Path, reason: String) -> CaptureError {
    CaptureError::Read { file: path.to_owned(), reason }
}

fn open(path: &Path) -> Result<npyz::NpyFile<BufReader<File>>, String> {
    let file = File::open(path).map_err(|error| error.to_string())?;
    npyz::NpyFile::new(BufReader::new(file)).map_err(|error| format!("no NumPy array ({error})"))
}

/// The array's length is checked against the file's before anything is allocated for it.
fn checked_shape(path: &Path, array: &npyz::NpyFile<BufReader<File>>, bytes: u64) -> Result<Vec<u64>, String> {
    let file_bytes = path.metadata().map_err(|error| error.to_string())?.len();
    let count = array.shape().iter().try_fold(1u64, |product, n| product.checked_mul(*n));
    match count.and_then(|count| count.checked_mul(bytes)) {
        Some(needed) if needed <= file_bytes && array.order() == npyz::Order::C => Ok(array.shape().to_vec()),
        _ => Err("it is cut off or not in C order".to_owned()),
    }
}

fn read_depths(path: &Path) -> Result<(Vec<u64>, Vec<f32>), String> {
    let array = open(path)?;
    let shape = checked_shape(path, &array, 4)?;
    let values = array.into_vec::<f32>().map_err(|error| error.to_string())?;
    Ok((shape, values))
}

fn read_bytes(path: &Path) -> Result<Vec<Image>, String> {
    let array = open(path)?;
    let shape = checked_shape(path, &array, 1)?;
    let values = array.into_vec::<u8>().map_err(|error| error.to_string())?;
    let [height, width] = shape[..] else { return Err("it has not two dimensions".to_owned()) };
    Ok(vec![Image::packed(PixelFormat::U8, size(width, height)?, values)])
}

fn layers(shape: &[u64], values: &[f32], dimensions: usize) -> Result<Vec<Image>, String> {
    if shape.len() != dimensions {
        return Err(format!("it has not {dimensions} dimensions"));
    }
    let (width, height) = (shape[dimensions - 1], shape[dimensions - 2]);
    let size = size(width, height)?;
    let texels = size[0] as usize * size[1] as usize;
    let image =
        |layer: &[f32]| Image::packed(PixelFormat::Depth32F, size, bytemuck::cast_slice::<f32, u8>(layer).to_vec());
    Ok(values.chunks_exact(texels).map(image).collect())
}

fn size(width: u64, height: u64) -> Result<[u32; 2], String> {
    let fits = |n: u64| u32::try_from(n).ok().filter(|n| (1..=LARGEST).contains(n));
    match [fits(width), fits(height)] {
        [Some(width), Some(height)] => Ok([width, height]),
        _ => Err(format!("its size is {width}x{height}")),
    }
}

fn read_png(path: &Path) -> Result<Vec<Image>, String> {
    let file = File::open(path).map_err(|error| error.to_string())?;
    let mut reader = png::Decoder::new(BufReader::new(file)).read_info().map_err(|error| error.to_string())?;
    size(u64::from(reader.info().width), u64::from(reader.info().height))?;
    let length = reader.output_buffer_size().ok_or("it is too large")?;
    let mut bytes = vec![0; length];
    let info = reader.next_frame(&mut bytes).map_err(|error| error.to_string())?;
    if (info.color_type, info.bit_depth) != (png::ColorType::Rgba, png::BitDepth::Eight) {
        return Err("it is not RGBA with 8 bits a channel".to_owned());
    }
    Ok(vec![Image::packed(PixelFormat::Rgba8Srgb, [info.width, info.height], bytes)])
}

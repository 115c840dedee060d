//! A picture in memory: rows of texels, top row first, possibly padded.
//!
//! Rows may be longer than their texels need (a GPU copy pads them to 256 bytes), so that a
//! mapped GPU buffer can be shown without copying it again. Texels are read one at a time or by
//! row; [`PartialEq`] compares texels, not padding.

use bytes::Bytes;

/// What one texel is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PixelFormat {
    /// Four bytes: red, green, blue (sRGB), alpha.
    Rgba8Srgb,
    /// Four bytes: red, green, blue and alpha, linear.
    Rgba8,
    /// One little-endian `f32`: a stored depth.
    Depth32F,
    /// One little-endian `f32`: a signed count.
    Count32F,
    /// One byte: a stencil count or a label.
    U8,
}

impl PixelFormat {
    /// Bytes of one texel.
    #[must_use]
    pub fn texel_bytes(self) -> usize {
        match self {
            PixelFormat::Rgba8Srgb | PixelFormat::Rgba8 | PixelFormat::Depth32F | PixelFormat::Count32F => 4,
            PixelFormat::U8 => 1,
        }
    }
}

/// Texels of one format.
#[derive(Clone)]
pub struct Image {
    format: PixelFormat,
    size: [u32; 2],
    row_stride: usize,
    bytes: Bytes,
}

impl Image {
    /// Wraps rows that lie `row_stride` bytes apart.
    ///
    /// # Panics
    /// If `bytes` is too short for the rows, or `row_stride` for the texels of one.
    #[must_use]
    pub fn from_rows(format: PixelFormat, size: [u32; 2], row_stride: usize, bytes: impl Into<Bytes>) -> Image {
        let bytes = bytes.into();
        let [width, height] = size.map(|n| n as usize);
        let row_bytes = width * format.texel_bytes();
        assert!(row_stride >= row_bytes, "a row of {row_bytes} bytes does not fit a stride of {row_stride}");
        let needed = height.checked_sub(1).map_or(0, |rows| rows * row_stride + row_bytes);
        assert!(bytes.len() >= needed, "{} bytes are too few for {needed}", bytes.len());
        Image { format, size, row_stride, bytes }
    }

    /// Wraps rows without padding.
    ///
    /// # Panics
    /// If `bytes` is too short.
    #[must_use]
    pub fn packed(format: PixelFormat, size: [u32; 2], bytes: impl Into<Bytes>) -> Image {
        Image::from_rows(format, size, size[0] as usize * format.texel_bytes(), bytes)
    }

    /// The same texel everywhere: what a cleared attachment holds. One row is stored.
    ///
    /// # Panics
    /// If `texel` has not the format's length.
    #[must_use]
    pub fn uniform(format: PixelFormat, size: [u32; 2], texel: &[u8]) -> Image {
        assert_eq!(texel.len(), format.texel_bytes());
        let row = texel.repeat(size[0] as usize);
        Image { format, size, row_stride: 0, bytes: row.into() }
    }

    /// What one texel is.
    #[must_use]
    pub fn format(&self) -> PixelFormat {
        self.format
    }

    /// Width and height in texels.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Bytes held, padding included.
    #[must_use]
    pub fn byte_len(&self) -> usize {
        self.bytes.len()
    }

    /// The texels of row `y` (0 at the top), without padding.
    ///
    /// # Panics
    /// If there is no such row.
    #[must_use]
    pub fn row(&self, y: u32) -> &[u8] {
        assert!(y < self.size[1], "row {y} of {}", self.size[1]);
        let start = y as usize * self.row_stride;
        &self.bytes[start..start + self.size[0] as usize * self.format.texel_bytes()]
    }

    /// All rows, top first.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[u8]> {
        (0..self.size[1]).map(|y| self.row(y))
    }

    /// The bytes of one texel; `None` outside the picture.
    #[must_use]
    pub fn texel(&self, [x, y]: [u32; 2]) -> Option<&[u8]> {
        if x >= self.size[0] || y >= self.size[1] {
            return None;
        }
        let bytes = self.format.texel_bytes();
        self.row(y).get(x as usize * bytes..(x as usize + 1) * bytes)
    }

    /// One byte texel; `None` outside the picture or for another format.
    #[must_use]
    pub fn byte_at(&self, at: [u32; 2]) -> Option<u8> {
        (self.format == PixelFormat::U8).then(|| self.texel(at).map(|texel| texel[0])).flatten()
    }

    /// One depth texel; `None` outside the picture or for another format.
    #[must_use]
    pub fn depth_at(&self, at: [u32; 2]) -> Option<f32> {
        let texel = (self.format == PixelFormat::Depth32F).then(|| self.texel(at)).flatten()?;
        Some(bytemuck::pod_read_unaligned(texel))
    }

    /// One count; `None` outside the picture or for another format.
    #[must_use]
    pub fn count_at(&self, at: [u32; 2]) -> Option<f32> {
        let texel = (self.format == PixelFormat::Count32F).then(|| self.texel(at)).flatten()?;
        Some(bytemuck::pod_read_unaligned(texel))
    }

    /// One colour texel as bytes; `None` outside the picture or for another format.
    #[must_use]
    pub fn rgba_at(&self, at: [u32; 2]) -> Option<[u8; 4]> {
        let is_color = matches!(self.format, PixelFormat::Rgba8Srgb | PixelFormat::Rgba8);
        let texel = is_color.then(|| self.texel(at)).flatten()?;
        texel.try_into().ok()
    }

    /// How many texels of a byte picture have each value.
    #[must_use]
    pub fn histogram(&self) -> [u64; 256] {
        let mut counts = [0; 256];
        if self.format == PixelFormat::U8 {
            self.rows().flatten().for_each(|value| counts[usize::from(*value)] += 1);
        }
        counts
    }
}

impl PartialEq for Image {
    fn eq(&self, other: &Image) -> bool {
        self.format == other.format && self.size == other.size && self.rows().eq(other.rows())
    }
}

impl std::fmt::Debug for Image {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Image({:?}, {}x{})", self.format, self.size[0], self.size[1])
    }
}

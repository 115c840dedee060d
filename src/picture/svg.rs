//! SVG as pixels, with one built-in typeface: the same picture everywhere.

use super::Picture;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::Database;
use resvg::usvg::{self, Options, Tree};
use std::sync::{Arc, LazyLock};

/// The most pixels along a side.
const MOST_PIXELS: f32 = 16_384.0;

/// Why an SVG can't be rendered.
#[derive(Debug, thiserror::Error)]
pub enum SvgError {
    /// It is not valid, or not supported.
    #[error(transparent)]
    Svg(#[from] usvg::Error),
    /// More pixels than the limit.
    #[error("{width}×{height} pixels are too many")]
    TooLarge {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
}

/// The typeface and its family name.
static FACE: LazyLock<(String, Arc<Database>)> = LazyLock::new(|| {
    let mut fonts = Database::new();
    fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    let family = fonts.faces().next().and_then(|face| face.families.first()).map(|(name, _)| name.clone());
    let family = family.unwrap_or_default();
    fonts.set_sans_serif_family(family.clone());
    (family, Arc::new(fonts))
});

fn tree(svg: &str) -> Result<Tree, SvgError> {
    let (family, fonts) = &*FACE;
    let options = Options { font_family: family.clone(), fontdb: Arc::clone(fonts), ..Options::default() };
    Ok(Tree::from_str(svg, &options)?)
}

/// Renders an SVG with `scale` pixels a point, its size rounded up. Where it draws nothing the picture is black.
///
/// # Errors An SVG that is not valid; a side of 0 or of more than 16 384 pixels, which is [`SvgError::TooLarge`] too.
pub fn picture(svg: &str, scale: f32) -> Result<Picture, SvgError> {
    let tree = tree(svg)?;
    let size = [tree.size().width(), tree.size().height()].map(|side| (side * scale).ceil());
    let [width, height] = size.map(|side| side as u32);
    let too_large = SvgError::TooLarge { width, height };
    if size.iter().any(|side| *side > MOST_PIXELS) {
        return Err(too_large);
    }
    let mut pixels = Pixmap::new(width, height).ok_or(too_large)?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    let pixels = pixels.pixels().iter().map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect();
    Ok(Picture { size: [width, height], pixels })
}

/// Returns the width of an SVG, points.
pub fn width(svg: &str) -> Result<f32, SvgError> {
    Ok(tree(svg)?.root().abs_bounding_box().width())
}

/// Returns text for XML content and attributes in double quotes: `&`, `<`, `>` and `"` escaped, and characters that XML
/// does not allow replaced by U+FFFD; apostrophes, tabs and line ends stay.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '\t' | '\n' | '\r' => out.push(c),
            c if c < ' ' || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_svg_or_too_large_is_an_error() {
        assert!(matches!(picture("<html/>", 1.0), Err(SvgError::Svg(_))));
        let wide = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"20000\" height=\"9\"/>";
        assert!(matches!(picture(wide, 1.0), Err(SvgError::TooLarge { width: 20_000, height: 9 })));
    }
}

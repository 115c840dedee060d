//! The plot's SVG as pixels, with the one face that is built in: the same picture everywhere.

use super::ReportError;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::Database;
use resvg::usvg::{Options, Tree};
use std::sync::Arc;

/// Most pixels along a side.
const MOST_PIXELS: f32 = 16_384.0;

/// An SVG with `scale` pixels a point, as a PNG file.
///
/// # Errors
/// No SVG, or too many pixels.
pub fn png(svg: &str, scale: f32) -> Result<Vec<u8>, ReportError> {
    let mut fonts = Database::new();
    fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    let family = fonts.faces().next().and_then(|face| face.families.first()).map(|(name, _)| name.clone());
    let family = family.unwrap_or_default();
    fonts.set_sans_serif_family(family.clone());
    let options = Options { font_family: family, fontdb: Arc::new(fonts), ..Options::default() };
    let tree = Tree::from_str(svg, &options)?;
    let size = [tree.size().width(), tree.size().height()].map(|side| (side * scale).ceil());
    let [width, height] = size.map(|side| side as u32);
    let too_large = ReportError::TooLarge { width, height };
    if size.iter().any(|side| *side > MOST_PIXELS) {
        return Err(too_large);
    }
    let mut pixels = Pixmap::new(width, height).ok_or(too_large)?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    encode(&pixels)
}

fn encode(pixels: &Pixmap) -> Result<Vec<u8>, ReportError> {
    // White paper covers every pixel, so alpha says nothing.
    let rgb: Vec<u8> = pixels.pixels().iter().flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect();
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, pixels.width(), pixels.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header()?.write_image_data(&rgb)?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::super::Report;
    use super::super::tests::{adapter, row};
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn it_has_two_pixels_a_point_and_is_not_blank() {
        let report = Report::new(adapter(), vec![row("tori", "z-fail", "", 0, 6.25), row("tori", "none", "", 9, 2.0)]);
        let svg = report.to_svg();
        let height: f32 = svg
            .split("viewBox=\"0 0 760 ")
            .nth(1)
            .and_then(|rest| rest.split('"').next())
            .expect("a height")
            .parse()
            .expect("a number");
        let bytes = report.to_png().expect("a picture");
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
        let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
        let info = reader.next_frame(&mut pixels).expect("pixels");
        assert_eq!([info.width, info.height], [1520, (height * 2.0).ceil() as u32]);
        let colors: BTreeSet<&[u8]> = pixels.chunks_exact(3).collect();
        assert!(colors.contains(&[255_u8; 3][..]) && colors.len() > 50, "{} colours", colors.len());
    }

    #[test]
    fn what_is_no_svg_or_too_large_is_an_error() {
        assert!(matches!(png("<html/>", 1.0), Err(ReportError::Svg(_))));
        let wide = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"20000\" height=\"9\"/>";
        assert!(matches!(png(wide, 1.0), Err(ReportError::TooLarge { width: 20_000, height: 9 })));
    }
}

use super::*;

fn board(size: [u32; 2], of: impl Fn(u32, u32) -> [u8; 4]) -> Picture {
    let texels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))).map(|(x, y)| of(x, y)).collect();
    Picture::new("board", size, texels).expect("a picture")
}

fn encode(color: png::ColorType, depth: png::BitDepth, size: [u32; 2], data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if color == png::ColorType::Indexed {
        encoder.set_palette(vec![1, 2, 3, 250, 251, 252]);
    }
    encoder.write_header().and_then(|mut writer| writer.write_image_data(data)).expect("encoded");
    bytes
}

fn load(bytes: &[u8]) -> Result<Picture, PictureError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a picture");
    std::fs::write(&path, bytes).expect("written");
    Picture::load(&path)
}

#[test]
fn every_kind_of_png_becomes_rgba() {
    use png::{BitDepth, ColorType};
    let cases: [(ColorType, BitDepth, &[u8], [[u8; 4]; 2]); 6] = [
        (ColorType::Grayscale, BitDepth::Eight, &[7, 9], [[7, 7, 7, 255], [9, 9, 9, 255]]),
        (ColorType::Grayscale, BitDepth::One, &[0b0100_0000], [[0, 0, 0, 255], [255, 255, 255, 255]]),
        (ColorType::GrayscaleAlpha, BitDepth::Eight, &[7, 8, 9, 10], [[7, 7, 7, 8], [9, 9, 9, 10]]),
        (ColorType::Rgb, BitDepth::Sixteen, &[1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0], [[1, 2, 3, 255], [4, 5, 6, 255]]),
        (ColorType::Rgba, BitDepth::Eight, &[1, 2, 3, 4, 5, 6, 7, 8], [[1, 2, 3, 4], [5, 6, 7, 8]]),
        (ColorType::Indexed, BitDepth::Eight, &[1, 0], [[250, 251, 252, 255], [1, 2, 3, 255]]),
    ];
    for (color, depth, data, texels) in cases {
        let picture = load(&encode(color, depth, [2, 1], data)).expect("a picture");
        assert_eq!((picture.size(), picture.texels()), ([2, 1], &texels[..]), "{color:?} {depth:?}");
    }
}

/// A PNG of 100 000 texels each way, in 45 bytes: its head, and nothing.
fn claims(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR".to_vec();
    bytes.extend([width.to_be_bytes(), height.to_be_bytes()].concat());
    bytes.extend([8, 6, 0, 0, 0]);
    let mut sum = flate2::Crc::new();
    sum.update(&bytes[12..]);
    bytes.extend(sum.sum().to_be_bytes());
    bytes.extend(b"\0\0\0\0IDAT\x35\xaf\x06\x1e");
    bytes
}

#[test]
fn what_is_no_picture_is_refused_in_a_line() {
    let good = encode(png::ColorType::Grayscale, png::BitDepth::Eight, [40, 40], &[9; 1600]);
    let cut = &good[..good.len() - 20];
    let jpeg_head = b"\xff\xd8\xff\xc0\0\x11\x08\xff\xff\xff\xff\x03\x01\x22\0\x02\x11\x01\x03\x11\x01";
    let cases: [(&[u8], &str); 7] = [
        (b"", "neither PNG nor JPEG"),
        (b"GIF89a", "neither PNG nor JPEG"),
        (&claims(100_000, 100_000), "is 100000x100000 texels, and at most 8192"),
        (&claims(0, 4), "is broken ("),
        (cut, "is broken ("),
        (&good[..9], "is broken ("),
        (jpeg_head, "is "),
    ];
    for (bytes, words) in cases {
        let error = load(bytes).expect_err(words).to_string();
        assert!(error.starts_with("is ") && error.contains(words) && !error.contains('\n'), "{error}");
        assert!(error.contains(": "), "no mend: {error}");
    }
}

#[test]
fn together_they_have_a_limit() {
    let folder = tempfile::tempdir().expect("a folder");
    let place = |name: &str| folder.path().join(name);
    for name in ["a", "b"] {
        std::fs::write(place(name), encode(png::ColorType::Grayscale, png::BitDepth::Eight, [4, 4], &[9; 16]))
            .expect("written");
    }
    let mut pictures = Pictures { left: 20, ..Pictures::default() };
    let first = pictures.load(&place("a")).expect("16 texels");
    assert!(Arc::ptr_eq(&first, &pictures.load(&place("a")).expect("the same")));
    assert!(matches!(pictures.load(&place("b")), Err(PictureError::TooMany)));
}

#[test]
fn levels_halve_down_to_the_mean_of_linear_light() {
    let picture = board([8, 2], |x, y| if (x + y) % 2 == 0 { [255; 4] } else { [0, 0, 0, 255] });
    let sizes: Vec<[u32; 2]> = picture.levels().iter().map(|level| level.size).collect();
    assert_eq!((picture.level_count(), sizes), (4, vec![[4, 1], [2, 1], [1, 1]]));
    // Half the light of white is not half of 255.
    assert!(picture.levels().iter().all(|level| level.texels.iter().all(|texel| *texel == [188, 188, 188, 255])));
    assert!((picture.mean()[0] - 0.5).abs() < 0.005);
    assert!((0..=255).all(|byte| encoded(linear(byte)) == byte), "bytes are told apart");
}

#[test]
fn a_place_is_counted_from_the_lower_left_and_repeats_unless_clamped() {
    // 0 1 / 2 3 from the top.
    let picture = board([2, 2], |x, y| [10 * (2 * y + x) as u8, 0, 0, 255]);
    let red = |uv: [f64; 2], clamps| (picture.linear_at(uv, 0.0, clamps)[0], picture.texel_at(uv, clamps));
    for clamps in [false, true] {
        assert_eq!(red([0.25, 0.75], clamps), (linear(0), [0, 0]));
        assert_eq!(red([0.75, 0.25], clamps), (linear(30), [1, 1]));
    }
    assert_eq!(red([1.25, 2.75], false), (linear(0), [0, 0]));
    assert_eq!(red([-0.25, 0.25], false), (linear(30), [1, 1]));
    assert_eq!(red([7.0, 0.25], true), (linear(30), [1, 1]));
    assert_eq!(red([-7.0, 0.25], true), (linear(20), [0, 1]));
    let between = picture.linear_at([0.5, 0.75], 0.0, false)[0];
    assert!((between - (linear(0) + linear(10)) / 2.0).abs() < 1e-12);
    let blurred = picture.linear_at([0.25, 0.75], 0.5, false)[0];
    assert!((blurred - linear(0) / 2.0 - picture.mean()[0] / 2.0).abs() < 1e-12);
}

use super::*;

fn board(size: [u32; 2], of: impl Fn(u32, u32) -> [u8; 4]) -> TextureImage {
    let texels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))).map(|(x, y)| of(x, y)).collect();
    TextureImage::new("board", size, texels).expect("a picture")
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

fn load(bytes: &[u8]) -> Result<TextureImage, ImageError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a picture");
    std::fs::write(&path, bytes).expect("written");
    TextureImage::load(&path)
}

#[test]
fn every_kind_of_png_becomes_rgba() {
    use png::{BitDepth, ColorType};
    type Case = (ColorType, BitDepth, &'static [u8], [[u8; 4]; 2]);
    let cases: [Case; 6] = [
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

/// A JPEG of 8 by 8 texels of one colour (ITU-T T.81): `components` of grey, or of Y, Cb and Cr, have only their mean,
/// whose code is either `0` and ten bits, or `10` for none; `0` ends each.
fn jpeg_of(components: u8, bits: &[u8]) -> Vec<u8> {
    let mut bytes = b"\xff\xd8\xff\xdb\0\x43\0".to_vec();
    bytes.extend([1; 64]);
    bytes.extend([0xff, 0xc0, 0, 8 + 3 * components, 8, 0, 8, 0, 8, components]);
    (1..=components).for_each(|id| bytes.extend([id, 0x11, 0]));
    bytes.extend(b"\xff\xc4\0\x15\0\x01\x01\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x0a\0");
    bytes.extend(b"\xff\xc4\0\x14\x10\x01\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0");
    bytes.extend([0xff, 0xda, 0, 6 + 2 * components, components]);
    (1..=components).for_each(|id| bytes.extend([id, 0]));
    bytes.extend([0, 63, 0]);
    bytes.extend(bits);
    bytes.extend(b"\xff\xd9");
    bytes
}

#[test]
fn a_jpeg_becomes_rgba_and_half_of_one_is_refused() {
    // 8 × (200 − 128) = 0b1001000000, and Cr 8 × 64.
    let cases = [(1, vec![0x48, 0x0f], [200, 200, 200]), (3, vec![0x48, 0x08, 0x80, 0x1f], [255, 154, 200])];
    for (components, bits, [red, green, blue]) in cases {
        let picture = load(&jpeg_of(components, &bits)).expect("a JPEG");
        assert_eq!(picture.size(), [8, 8]);
        let near = |texel: &[u8; 4]| {
            let differs = [red, green, blue].iter().zip(texel).any(|(a, b): (&u8, &u8)| a.abs_diff(*b) > 1);
            !differs && texel[3] == 255
        };
        assert!(picture.texels().iter().all(near), "{:?} is not {red}, {green}, {blue}", picture.texels()[0]);
        let whole = jpeg_of(components, &bits);
        let error = load(&whole[..whole.len() / 2]).expect_err("half").to_string();
        assert!(error.starts_with("is broken (") && !error.contains('\n'), "{error}");
    }
}

/// A PNG of 100 000 texels each way, in 45 bytes: its header, and nothing else.
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
        assert!(error.contains(": "), "no fix: {error}");
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
    let mut pictures = ImageLoader { left: 20, ..ImageLoader::default() };
    let first = pictures.load(&place("a")).expect("16 texels");
    assert!(Arc::ptr_eq(&first, &pictures.load(&place("a")).expect("the same")));
    assert!(matches!(pictures.load(&place("b")), Err(ImageError::TooMany)));
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

/// A small generator, so that every run sees the same bytes (Marsaglia 2003).
fn next(state: &mut u64) -> usize {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 8) as usize
}

#[test]
fn no_bytes_panic_and_every_error_is_one_line() {
    let grey: Vec<u8> = (0..16 * 16).map(|at| (at * 7) as u8).collect();
    let whole = [
        encode(png::ColorType::Grayscale, png::BitDepth::Eight, [16, 16], &grey),
        encode(png::ColorType::Indexed, png::BitDepth::One, [16, 2], &[0b1010_1010; 4]),
        jpeg_of(1, &[0x48, 0x0f]),
        jpeg_of(3, &[0x48, 0x08, 0x80, 0x1f]),
    ];
    let (mut state, mut read, mut refused) = (9, 0, 0);
    for round in 0..4000 {
        let mut bytes = whole[round % whole.len()].clone();
        for _ in 0..=next(&mut state) % 4 {
            let at = next(&mut state) % bytes.len();
            match next(&mut state) % 3 {
                0 => bytes[at] = next(&mut state) as u8,
                1 => bytes[at] ^= 1 << (next(&mut state) % 8),
                _ => bytes.truncate(at.max(1)),
            }
        }
        let result = match bytes[0] {
            0x89 => png(&bytes, 1 << 16),
            _ => jpeg(&bytes, 1 << 16),
        };
        match result {
            Ok((size, texels)) => {
                read += 1;
                assert_eq!(texels.len(), size[0] as usize * size[1] as usize, "round {round}");
            }
            Err(error) => {
                refused += 1;
                let error = error.to_string();
                assert!(error.starts_with("is ") && !error.contains('\n') && error.len() < 200, "{error}");
            }
        }
    }
    assert!(read > 100 && refused > 1000, "{read} read, {refused} refused");
}

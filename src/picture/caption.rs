//! Words below a picture of a file: a bar that says what it shows.

use super::Picture;
use super::colors::{self, Rgb};
use super::svg::{self, SvgError};

/// The bar's height is the picture's width divided by this; the least and the largest height, pixels.
const WIDTH_A_HEIGHT: u32 = 24;
const HEIGHTS: [u32; 2] = [20, 56];
/// Size of the letters, and space beside them, as shares of the bar's height.
const LETTERS: f32 = 0.54;
const BESIDE: f32 = 0.4;
/// Baseline of the letters, as a share of the bar's height from its top.
const BASELINE: f32 = 0.68;
const TEXT: Rgb = [0xd9, 0xdc, 0xe3];
const DIM: Rgb = [0x8b, 0x92, 0xa1];
/// Space between captioned pictures side by side, pixels.
const GAP: u32 = 8;

/// Returns width and height of a picture of this size with its bar.
pub fn captioned_size([width, height]: [u32; 2]) -> [u32; 2] {
    [width, height + bar_height(width)]
}

/// Returns a picture over a bar with two pieces of text, one at each end.
pub fn captioned(picture: &Picture, words: [&str; 2]) -> Result<Picture, SvgError> {
    let [width, height] = picture.size();
    let mut all = Picture::filled(captioned_size([width, height]), colors::BACKGROUND);
    all.paste(picture, [0, 0]);
    all.paste(&bar(width, words[0], words[1])?, [0, height]);
    Ok(all)
}

/// Returns captioned pictures in a row, with a gap between.
pub fn in_a_row(captioned: &[Picture]) -> Picture {
    Picture::in_a_row(captioned, GAP, colors::BACKGROUND)
}

/// Returns the size of so many captioned pictures in a row, `size` each without its bar.
pub fn size_in_a_row(size: [u32; 2], pictures: u32) -> [u32; 2] {
    let [width, height] = captioned_size(size);
    [width * pictures + GAP * pictures.saturating_sub(1), height]
}

fn bar_height(width: u32) -> u32 {
    (width / WIDTH_A_HEIGHT).clamp(HEIGHTS[0], HEIGHTS[1])
}

/// Returns the caption bar, `width` pixels wide: `left` bright, cut off with an ellipsis where it does not fit, and
/// `right` dim at the right end, left out where it would take more than half of the bar.
fn bar(width: u32, left: &str, right: &str) -> Result<Picture, SvgError> {
    let height = bar_height(width);
    let beside = height as f32 * BESIDE;
    let inner = width as f32 - 2.0 * beside;
    let drawn_width = |words: &str| svg::width(&document(width, height, &text(words, 0.0, height, TEXT)));
    let right_width = drawn_width(right)?;
    // A pass's name is more important than what it writes.
    let right = if right_width + beside > inner / 2.0 { "" } else { right };
    let left_width = if right.is_empty() { inner } else { inner - right_width - beside };
    let letters: Vec<char> = left.chars().collect();
    let (mut shown, mut words) = (letters.len(), left.to_owned());
    let mut drawn = drawn_width(&words)?;
    while drawn > left_width && shown > 0 {
        // As many as the width has space for; at least one is removed.
        shown = ((shown as f32 * left_width / drawn) as usize).min(shown - 1);
        words = letters[..shown].iter().collect::<String>() + "…";
        drawn = drawn_width(&words)?;
    }
    let right_at = width as f32 - beside - right_width;
    let paper = format!("<rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>", css(colors::BACKGROUND));
    let words = text(&words, beside, height, TEXT) + &text(right, right_at, height, DIM);
    svg::picture(&document(width, height, &(paper + &words)), 1.0)
}

fn document(width: u32, height: u32, contents: &str) -> String {
    format!("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\">{contents}</svg>")
}

fn css([red, green, blue]: Rgb) -> String {
    format!("rgb({red},{green},{blue})")
}

fn text(words: &str, left: f32, height: u32, color: Rgb) -> String {
    let [size, baseline] = [LETTERS, BASELINE].map(|share| height as f32 * share);
    let (words, color) = (svg::escaped(words), css(color));
    format!(
        "<text x=\"{left}\" y=\"{baseline}\" font-size=\"{size}\" fill=\"{color}\" \
         xml:space=\"preserve\">{words}</text>"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the first and the last column that is not blank; `None` without any.
    fn inked(bar: &Picture) -> Option<[u32; 2]> {
        let [width, height] = bar.size();
        let has_ink = |x: &u32| (0..height).any(|y| bar.at([*x, y]) != Some(colors::BACKGROUND));
        Some([(0..width).find(has_ink)?, (0..width).rfind(has_ink)?])
    }

    #[test]
    fn words_stand_at_both_ends_and_stay_within_the_bar() {
        let both = bar(320, "2 · volumes", "stencil").expect("a bar");
        assert_eq!(both.size(), [320, 20]);
        let [first, last] = inked(&both).expect("ink");
        assert!((6..14).contains(&first) && (304..314).contains(&last), "{first} to {last}");
    }

    #[test]
    fn of_a_long_name_as_much_is_shown_as_there_is_room_for_and_never_under_the_other_words() {
        let [long, longer] = [40, 4000].map(|times| bar(320, &"shadow ".repeat(times), "stencil").expect("a bar"));
        assert_eq!(long, longer);
        let words = inked(&bar(320, "", "stencil").expect("a bar")).expect("ink");
        let gap = (words[0] - 6..words[0]).filter(|x| (0..20).any(|y| long.at([*x, y]) != Some(colors::BACKGROUND)));
        assert_eq!(gap.count(), 0, "before column {}", words[0]);
    }

    #[test]
    fn a_bar_without_room_or_words_is_drawn_all_the_same() {
        for (width, left, right) in [(1, "1 · a", "colour"), (8, "", ""), (64, "<&>\u{1}", "colour"), (64, "測", "色")]
        {
            assert_eq!(bar(width, left, right).expect("a bar").size(), [width, 20]);
        }
        assert_eq!(inked(&bar(64, "", "").expect("a bar")), None);
    }
}

//! Counts of shadow volumes in floats: signed, and beyond what eight bits hold.

use super::by_hand::counted_in_floats;
use super::*;

#[test]
fn the_legend_counts_signed_values_and_says_what_eight_bits_would_miss() {
    let mut harness = harness(counted_in_floats());
    assert!(is_disabled(&harness, "Stencil"), "there is none");
    click_button(&mut harness, "Count");
    harness.get_by_label("count of light 1 · 40×30 · R32Float");
    harness.get_by_label("Count, light 1");
    for text in ["0", "600", "1", "597", "300", "−1", "256", "would read 0 in eight bits"] {
        assert!(harness.query_all_by_label(text).next().is_some(), "{text}");
    }
}

#[test]
fn whoever_looks_at_the_stencil_sees_the_counts_where_there_is_none() {
    let mut harness = harness(z_fail(SIZE));
    click_button(&mut harness, "Stencil");
    show_capture(&mut harness, counted_in_floats());
    assert_eq!(harness.state().inspector.picture_kind(), Some(PictureKind::Count));
    show_capture(&mut harness, z_fail(SIZE));
    assert_eq!(harness.state().inspector.picture_kind(), Some(PictureKind::Stencil));
}

#[test]
fn the_read_out_reports_the_count_and_what_eight_bits_would_make_of_it() {
    let harness = picked(counted_in_floats(), [1, 0]);
    harness.get_by_label("Dark under light 1: its count is 256.");
    harness.get_by_label_contains("Eight bits would read 0 and light this pixel.");
    harness.get_by_label("would read 0 in eight bits");
    assert!(harness.query_by_label("no buffer").is_none());
    picked(counted_in_floats(), [0, 0]).get_by_label("Dark under light 1: its count is −1.");
    picked(counted_in_floats(), [0, 0]).get_by_label("would read 255 in eight bits");
    picked(counted_in_floats(), [2, 0]).get_by_label("would read 44 in eight bits");
    let lit = picked(counted_in_floats(), [30, 4]);
    lit.get_by_label("Lit by light 1: its count is 0.");
    assert!(lit.query_by_label_contains("in eight bits").is_none());
}

#[test]
fn before_the_volumes_nobody_knows_the_count() {
    let mut harness = picked(counted_in_floats(), [2, 0]);
    // Now, and after each of the last three steps.
    assert_eq!(harness.query_all_by_label("300").count(), 4);
    press(&mut harness, Key::Home);
    assert_eq!(harness.query_all_by_label("300").count(), 3);
    assert!(harness.query_by_label_contains("in eight bits").is_none());
}

#[test]
fn of_many_counts_the_legend_lists_those_of_the_most_pixels() {
    let mut capture = counted_in_floats();
    // A pixel each of 2 to 41 in the first row, and 500 everywhere else.
    let texels = (0..40 * 30).map(|index| if index < 40 { index as f32 + 2.0 } else { 500.0_f32 });
    let bytes: Vec<u8> = texels.flat_map(f32::to_le_bytes).collect();
    capture.lights[0].count = Some(Arc::new(Image::packed(PixelFormat::Value32F, SIZE, bytes)));
    let mut harness = harness(capture);
    click_button(&mut harness, "Count");
    harness.get_by_label("500");
    harness.get_by_label("1\u{a0}160");
    harness.get_by_label("29 more values · 29");
}

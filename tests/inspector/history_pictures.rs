//! Pictures of the Pixel panel with histories of few, a dozen and 600 events, for people to look at.

use super::history_by_hand::{FACES, Face, history};
use super::pictures::{Gallery, inspector, inspector_of};
use super::*;
use stencilscope::history::PixelHistory;

/// A window that shows the whole panel at once, beside one as it is used.
const SIZES: [[u32; 2]; 2] = [[1280, 1560], [1440, 900]];

fn draw(
    gallery: &Gallery,
    name: &str,
    inspector: impl Fn() -> Inspector,
    history: &PixelHistory,
    select: Option<usize>,
) {
    let sizes: &[[u32; 2]] = if gallery.folder.is_some() { &SIZES } else { gallery.sizes() };
    gallery.show(&format!("history-{name}"), sizes, inspector, |harness| {
        change(harness, |inspector| inspector.take_in(HistoryOf { at: history.pixel }, Ok(Arc::new(history.clone()))));
        if let Some(rung) = select {
            click_rung(harness, rung);
        }
        if harness.ctx.content_rect().height() < 1000.0 {
            harness.get_by_label("History").scroll_to_me();
        }
    });
}

/// Clicks the rung of that number, where the panel shows it.
fn click_rung(harness: &mut Harness<Seen>, number: usize) {
    let is_rung = |label: String| label.starts_with("rung: ");
    let rungs = harness.query_all_by_role(Role::ListItem);
    if let Some(rung) = rungs.filter(|rung| rung.accesskit_node().label().is_some_and(is_rung)).nth(number) {
        rung.click_accesskit();
    }
    harness.run_steps(3);
}

/// `INSPECTOR_PICTURES=FOLDER cargo test --profile bench pictures_of_histories` writes them.
#[test]
fn pictures_of_histories_can_be_drawn() {
    let gallery = Gallery::open();
    let size = if gallery.folder.is_some() { [1280, 720] } else { [160, 90] };
    let mut session = common::session();
    for (scene, technique) in
        [("tori", Technique::ZFail), ("inside", Technique::ZPassPlus), ("tori", Technique::Planar)]
    {
        let frame = common::frame(&mut session, scene, common::request(technique, size));
        let grid = (0..10).flat_map(|y| (0..16).map(move |x| [x * size[0] / 16 + 4, y * size[1] / 10 + 4]));
        let histories: Vec<PixelHistory> =
            grid.map(|at| session.history(&frame.plan, &frame.capture, at).expect("a history")).collect();
        for events in [2, 12, 40] {
            let nearest = histories.iter().min_by_key(|history| history.events.len().abs_diff(events));
            let history = nearest.expect("a history");
            let name = format!("{scene}-{}-{events}", technique.name());
            draw(&gallery, &name, || inspector(&frame, history.pixel), history, Some(3));
        }
    }
    let faces: Vec<Face> = (0..595)
        .map(|index| {
            let part = if index < 500 { DrawPart::Side } else { DrawPart::DarkCap };
            (part, index % 2 == 1, if index % 7 < 4 { 1.0 + index as f32 * 0.004 } else { 4.5 + index as f32 * 0.1 })
        })
        .collect();
    let request = common::request(Technique::ZFail, [40, 30]);
    let capture = Arc::new(z_fail([40, 30]));
    let by_hand = || inspector_of(&scene(), &request, &capture, [3, 4]);
    let mut wrong = history([3, 4], &FACES);
    wrong.events.remove(7);
    let late = || {
        let mut inspector = by_hand();
        inspector.take_in(HistoryOf { at: [3, 4] }, Ok(Arc::new(history([3, 4], &FACES))));
        inspector.model.selection.pick = Some([9, 9]);
        inspector
    };
    draw(&gallery, "by-hand-late", late, &wrong, None);
    draw(&gallery, "by-hand-wrong", by_hand, &wrong, None);
    for (name, faces) in [("by-hand-600", &faces[..]), ("by-hand-0", &[])] {
        draw(&gallery, name, by_hand, &history([3, 4], faces), (!faces.is_empty()).then_some(9));
    }
}

//! Pictures of the Pixel panel with histories of few, a dozen and 600 events, for people to look at.

use super::history_by_hand::{FACES, Face, history};
use super::pictures::{MARGIN, draw, inspector, sizes};
use super::{Seen, harness_of, z_fail};
use crate::common;
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use std::path::PathBuf;
use std::sync::Arc;
use stencilscope::ask::HistoryOf;
use stencilscope::capture::Capture;
use stencilscope::history::PixelHistory;
use stencilscope::inspector::Inspector;
use stencilscope::plan::DrawPart;
use stencilscope::scene::{OpenSpec, open};
use stencilscope::technique::Technique;

/// A window that shows the whole panel at once, beside one as it is used.
const SIZES: [[u32; 2]; 2] = [[1280, 1560], [1440, 900]];

struct Gallery {
    folder: Option<PathBuf>,
}

impl Gallery {
    fn draw(&self, name: &str, of: impl Fn() -> Inspector, history: &PixelHistory, select: Option<usize>) {
        let sizes: &[[u32; 2]] = if self.folder.is_some() { &SIZES } else { sizes(false) };
        for size in sizes {
            let mut harness = harness_of(of(), size.map(|side| (side + 2 * MARGIN) as f32));
            harness.state_mut().inspector.tell(HistoryOf { at: history.pixel }, Ok(Arc::new(history.clone())));
            harness.run_steps(2);
            if let Some(rung) = select {
                click_rung(&mut harness, rung);
            }
            if size[1] < 1000 {
                harness.get_by_label("History").scroll_to_me();
                harness.run_steps(3);
            }
            draw(&mut harness, self.folder.as_deref(), &format!("history-{name}"), *size);
        }
    }
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

/// `INSPECTOR_PICTURES=FOLDER cargo test pictures_of_histories` writes them.
#[test]
fn pictures_of_histories_can_be_drawn() {
    let gallery = Gallery { folder: std::env::var_os("INSPECTOR_PICTURES").map(PathBuf::from) };
    let size = if gallery.folder.is_some() { [1280, 720] } else { [160, 90] };
    let mut session = common::session();
    for (scene, technique) in
        [("tori", Technique::ZFail), ("inside", Technique::ZPassPlus), ("tori", Technique::Planar)]
    {
        let scene = open(&OpenSpec::new(scene)).expect("a built-in scene");
        let request = common::request(technique, size);
        let (capture, plan) = session.capture_with_plan(&scene, &request).expect("a capture");
        let capture = Arc::new(capture);
        let grid = (0..10).flat_map(|y| (0..16).map(move |x| [x * size[0] / 16 + 4, y * size[1] / 10 + 4]));
        let histories: Vec<PixelHistory> =
            grid.map(|at| session.history(&plan, &capture, at).expect("a history")).collect();
        for events in [2, 12, 40] {
            let nearest = histories.iter().min_by_key(|history| history.events.len().abs_diff(events));
            let history = nearest.expect("a history");
            let name = format!("{}-{}-{events}", scene.name, technique.name());
            gallery.draw(&name, || inspector(&scene, &request, &capture, history.pixel), history, Some(3));
        }
    }
    let faces: Vec<Face> = (0..595)
        .map(|index| {
            let part = if index < 500 { DrawPart::Side } else { DrawPart::DarkCap };
            (part, index % 2 == 1, if index % 7 < 4 { 1.0 + index as f32 * 0.004 } else { 4.5 + index as f32 * 0.1 })
        })
        .collect();
    let scene = super::scene();
    let request = common::request(Technique::ZFail, [40, 30]);
    let capture: Arc<Capture> = Arc::new(z_fail([40, 30]));
    let mut wrong = history([3, 4], &FACES);
    wrong.events.remove(7);
    gallery.draw(
        "by-hand-late",
        || {
            let mut inspector = inspector(&scene, &request, &capture, [3, 4]);
            inspector.tell(HistoryOf { at: [3, 4] }, Ok(Arc::new(history([3, 4], &FACES))));
            inspector.pick([9, 9]);
            inspector
        },
        &wrong,
        None,
    );
    gallery.draw("by-hand-wrong", || inspector(&scene, &request, &capture, [3, 4]), &wrong, None);
    for (name, faces) in [("by-hand-600", &faces[..]), ("by-hand-0", &[])] {
        let history = history([3, 4], faces);
        gallery.draw(
            name,
            || inspector(&scene, &request, &capture, [3, 4]),
            &history,
            (!faces.is_empty()).then_some(9),
        );
    }
}

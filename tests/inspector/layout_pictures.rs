//! Pictures of the layouts of the menu View over a real frame, for people to look at.

use super::pictures::{Gallery, anatomy};
use super::*;
use stencilscope::ask::{CaptureOf, RaysOf};
use stencilscope::inspector::model::comparing::SidesLayout;
use stencilscope::inspector::{LayoutPreset, ThemeChoice};

/// What is answered as it is asked for, from a real session.
fn answer_all(harness: &mut Harness<Seen>, session: &mut Session, frame: &RunFrame) {
    for _ in 0..6 {
        let asked: Vec<PendingQuestion> = std::mem::take(&mut harness.state_mut().actions)
            .into_iter()
            .filter_map(|action| if let Action::Ask(asked) = action { Some(asked) } else { None })
            .collect();
        let scene = frame.scene().expect("a scene");
        for PendingQuestion { ticket, ask, .. } in asked {
            let answer = match &ask {
                Ask::HistoryOf(HistoryOf { at }) => {
                    let history = session.history(&frame.plan, &frame.capture, *at);
                    history.ok().map(|history| Answer::HistoryOf(Arc::new(history)))
                }
                Ask::RaysOf(RaysOf { at }) => {
                    session.light_rays(frame, *at).ok().map(|rays| Answer::RaysOf(Arc::new(rays)))
                }
                Ask::AnatomyOf(_) => Some(Answer::AnatomyOf(anatomy(session, frame))),
                Ask::CaptureOf(CaptureOf { request, .. }) => {
                    let other = CaptureRequest::new(request.choice.clone(), request.size);
                    let capture = session.capture(&request.applied_to(scene), &other);
                    capture.ok().map(|capture| Answer::CaptureOf(Arc::new(capture)))
                }
                _ => None,
            };
            if let Some(answer) = answer {
                harness.state_mut().inspector.answer(ticket, Ok(answer), true);
            }
        }
        harness.run_steps(3);
    }
}

/// `INSPECTOR_PICTURES=FOLDER cargo test --profile bench pictures_of_layouts` writes them.
#[test]
fn pictures_of_layouts_can_be_drawn() {
    let gallery = Gallery::open();
    let sizes: &[[u32; 2]] =
        if gallery.folder.is_some() { &[[1280, 800], [1440, 900], [1000, 700]] } else { &[[1280, 400]] };
    let mut session = common::session();
    let frame = common::frame(&mut session, "tori", common::request(Technique::ZFail, [640, 480]));
    let pick = [322, 92];
    let views: [(&str, Option<LayoutPreset>); 5] = [
        ("first", None),
        ("scene", Some(LayoutPreset::PictureAndScene)),
        ("two", Some(LayoutPreset::CompareTwo)),
        ("teach", Some(LayoutPreset::Teach)),
        ("numbers", None),
    ];
    for theme in [ThemeChoice::Dark, ThemeChoice::Light] {
        for ((name, preset), size) in views.iter().flat_map(|view| sizes.iter().map(move |size| (view, *size))) {
            let scale = if *preset == Some(LayoutPreset::Teach) { 1.4 } else { 1.0 };
            let mut inspector = pictures::inspector(&frame, pick);
            inspector.set_plan(Arc::clone(&frame.plan));
            inspector.model.theme = theme;
            inspector.model.requests.layout = *preset;
            inspector.model.requests.zoom = (scale != 1.0).then_some(scale);
            if *preset == Some(LayoutPreset::CompareTwo) {
                inspector.compare_with(Technique::ShadowMap);
                inspector.model.modes.compare.iter_mut().for_each(|compare| compare.layout = SidesLayout::Beside);
            }
            let mut harness = harness_in(inspector, size.map(|side| side as f32 / scale));
            answer_all(&mut harness, &mut session, &frame);
            if *name == "numbers" {
                for section in ["Rays", "Shading", "Coordinates"] {
                    click(&mut harness, section);
                    harness.run_steps(8);
                }
                answer_all(&mut harness, &mut session, &frame);
            }
            let picture = window_picture(&mut harness);
            if let Some(folder) = &gallery.folder {
                let file = format!("layout-{name}-{theme:?}-{}.png", size[0]).to_lowercase();
                std::fs::write(folder.join(file), picture.to_png().expect("a PNG")).expect("written");
            }
        }
    }
}

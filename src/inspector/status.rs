//! The status bar: what is shown, what is under the pointer, what it cost and where it ran.

use super::palette::{label_color, label_name, signed_stencil, stencil_color};
use super::{PictureKind, State, theme};
use egui::{Align, Layout, Ui};

pub(super) fn ui(ui: &mut Ui, state: &State) {
    ui.horizontal(|ui| {
        if let Some(job) = &state.job {
            ui.spinner();
            ui.label(theme::dim(job));
            ui.separator();
        }
        let Some(capture) = &state.capture else {
            if state.job.is_none() {
                ui.label(theme::dim("nothing open"));
            }
            return;
        };
        picture(ui, state);
        ui.separator();
        hovered(ui, state);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.label(theme::dim(format!("{}, {}", capture.adapter.name, capture.adapter.driver)));
            ui.separator();
            let megabytes = capture.bytes() as f64 / 1e6;
            ui.label(theme::dim(format!("capture {megabytes:.1} MB")));
            let gpu: f64 = capture.steps.iter().filter_map(|step| step.gpu_ms).sum();
            if let Some(frame_ms) = capture.timing.frame_ms {
                ui.label(theme::dim(format!("frame {frame_ms:.1} ms")));
            } else if gpu > 0.0 {
                ui.label(theme::dim(format!("GPU {gpu:.1} ms")));
            }
        });
    });
}

fn picture(ui: &mut Ui, state: &State) {
    let Some(image) = state.image() else { return };
    let [width, height] = image.size();
    let step = state.step + 1;
    let kind = state.picture.name().to_lowercase();
    ui.label(theme::dim(format!("{kind} after step {step} · {width}×{height} · {:?}", image.format())));
}

fn hovered(ui: &mut Ui, state: &State) {
    let Some([x, y]) = state.hover else {
        ui.label(theme::faint("point at a pixel to read it"));
        return;
    };
    ui.label(theme::number(format!("{x}, {y}")));
    let texel = [x, y];
    if state.picture == PictureKind::Map {
        if let Some(depth) = state.image().and_then(|image| image.depth_at(texel)) {
            ui.label(theme::number(format!("stored depth {}", theme::short(f64::from(depth)))));
        }
        return;
    }
    let Some(frame) = state.frame() else { return };
    if let Some([r, g, b, _]) = frame.color.image.rgba_at(texel) {
        theme::swatch(ui, egui::Color32::from_rgb(r, g, b));
        ui.label(theme::number(format!("{r} {g} {b}")));
    }
    if let Some(depth) = frame.depth.image.depth_at(texel) {
        ui.label(theme::number(format!("depth {}", theme::short(f64::from(depth)))));
    }
    if let Some(stencil) = frame.stencil.as_ref().and_then(|aspect| aspect.image.byte_at(texel)) {
        theme::swatch(ui, stencil_color(stencil));
        ui.label(theme::number(format!("stencil {}", signed_stencil(stencil))));
    }
    let light = state.capture.as_ref().and_then(|capture| capture.lights.get(state.light));
    if let Some(label) = light.and_then(|light| light.shadow.as_ref()).and_then(|image| image.byte_at(texel)) {
        theme::swatch(ui, label_color(label));
        ui.label(theme::number(label_name(label)));
    }
}

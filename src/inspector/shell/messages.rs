//! Errors and warnings as bars under the top bar: text with how to fix it, until dismissed; what was written as one over the
//! status bar, for a while.

use crate::inspector::action::Action;
use crate::inspector::look::theme;
use crate::inspector::model::{Message, Model, Severity};
use egui::{Align2, CornerRadius, Margin, RichText, Role, Stroke, TextStyle, Ui, WidgetInfo};

/// The largest share of the window's height for messages; more are scrolled to.
const MOST_HEIGHT: f32 = 0.25;
/// For how long a bar says what was written, seconds.
const DONE_SECONDS: f64 = 15.0;
/// Width of that bar at most, and how far it is above the window's lower edge, points: it lies over the status bar, and hides
/// nothing of the panels.
const DONE_WIDTH: f32 = 560.0;
const ABOVE_EDGE: f32 = 1.0;

/// Draws the offer to load a changed file again, and a bar for each message, the last one first, which can be dismissed
/// one by one or all at once; nothing where there is neither.
pub fn ui(ui: &mut Ui, model: &mut Model, actions: &mut Vec<Action>) {
    if let Some(file) = model.activity.changed_file.clone() {
        reload(ui, model, &file, actions);
    }
    if model.activity.messages.is_empty() {
        return;
    }
    written(ui, model);
    if model.activity.messages.iter().all(|message| message.severity == Severity::Done) {
        return;
    }
    let frame = egui::Frame::new().fill(theme::of(ui).panel).inner_margin(Margin::symmetric(8, 4));
    egui::Panel::top("messages").frame(frame).show(ui, |ui| {
        if model.activity.messages.len() > 1 && ui.button("Dismiss all").on_hover_text("Hide all messages").clicked() {
            while let Some(last) = model.activity.messages.len().checked_sub(1) {
                model.activity.dismiss(last);
            }
        }
        let most = ui.ctx().content_rect().height() * MOST_HEIGHT;
        let mut dismissed = None;
        egui::ScrollArea::vertical().max_height(most).auto_shrink([false, true]).show(ui, |ui| {
            // The last one first: it belongs to the latest action.
            let messages = model.activity.messages.iter().enumerate().rev();
            for (index, message) in messages.filter(|(_, message)| message.severity != Severity::Done) {
                if bar(ui, message) {
                    dismissed = Some(index);
                }
            }
        });
        if let Some(index) = dismissed {
            model.activity.dismiss(index);
        }
    });
}

/// Draws what was written over the status bar: nothing moves under the pointer when it comes or goes.
fn written(ui: &Ui, model: &mut Model) {
    let Some(index) = model.activity.messages.iter().position(|message| message.severity == Severity::Done) else {
        return;
    };
    let ctx = ui.ctx();
    let width = (ctx.content_rect().width() - 48.0).clamp(1.0, DONE_WIDTH);
    let area = egui::Area::new(egui::Id::unique("written")).anchor(Align2::CENTER_BOTTOM, [0.0, -ABOVE_EDGE]);
    let drawn = area.show(ctx, |ui| {
        ui.set_width(width);
        let ground = egui::Frame::new().fill(theme::of(ui).raised).corner_radius(CornerRadius::same(4));
        ground.show(ui, |ui| bar(ui, &model.activity.messages[index])).inner
    });
    if drawn.inner {
        model.activity.dismiss(index);
    }
}

fn reload(ui: &mut Ui, model: &mut Model, file: &str, actions: &mut Vec<Action>) {
    let frame = egui::Frame::new().fill(theme::of(ui).panel).inner_margin(Margin::symmetric(8, 4));
    egui::Panel::top("reload").frame(frame).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.label(format!("{file} changed on disk."));
            if ui
                .button("Load it again")
                .on_hover_text("The file's scene, with all that was set here and still has a place in it")
                .clicked()
            {
                actions.push(Action::Reload);
                model.activity.changed_file = None;
            }
            if ui.button("Not now").on_hover_text("Go on with the scene as it is").clicked() {
                model.activity.changed_file = None;
            }
        });
    });
}

/// Draws one message; returns true when it is dismissed, or, where it says what was written, has been there for a while.
fn bar(ui: &mut Ui, message: &Message) -> bool {
    let (word, color) = match message.severity {
        Severity::Error => ("× Error", theme::of(ui).error),
        Severity::Warning => ("! Warning", theme::of(ui).dim),
        Severity::Done => ("Done", theme::of(ui).passed),
    };
    let is_done = message.severity == Severity::Done;
    let frame = egui::Frame::new()
        .stroke(Stroke::new(1.0, color))
        .corner_radius(CornerRadius::same(4))
        .inner_margin(Margin::symmetric(8, 4));
    let contents = |ui: &mut Ui| {
        let dismiss = ui.button("Dismiss").on_hover_text("Hide this message");
        ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
            ui.label(RichText::new(word).color(color));
            if is_done {
                let words =
                    theme::elided(ui, &message.text, &TextStyle::Body.resolve(ui.style()), ui.available_width());
                let label = ui.add(egui::Label::new(words).extend()).on_hover_text(&message.text);
                label.widget_info(|| WidgetInfo::labeled(Role::Label, true, &message.text));
            } else {
                ui.add(egui::Label::new(&message.text).wrap());
            }
        });
        dismiss.clicked() || is_done && is_over(ui, &message.text)
    };
    let layout = egui::Layout::right_to_left(egui::Align::Center);
    frame
        .show(ui, |ui| ui.allocate_ui_with_layout(egui::vec2(ui.available_width(), 24.0), layout, contents).inner)
        .inner
}

/// Returns whether a text has been shown for as long as one is that says what was written; asks for another frame then.
fn is_over(ui: &Ui, text: &str) -> bool {
    let now = ui.input(|input| input.time);
    let id = egui::Id::unique("written").with(text);
    let last: Option<[f64; 2]> = ui.data(|data| data.get_temp(id));
    // One that was shown before and was away since begins anew.
    let since = last.filter(|[_, seen]| now - seen < DONE_SECONDS).map_or(now, |[since, _]| since);
    ui.data_mut(|data| data.insert_temp(id, [since, now]));
    let left = since + DONE_SECONDS - now;
    if left > 0.0 {
        ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(left));
    }
    left <= 0.0
}

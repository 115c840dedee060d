//! The bar at the top: what is open, and the technique.

use crate::inspector::action::{Action, DialogKind};
use crate::inspector::look::theme;
use crate::inspector::look::widgets::{ButtonSegment, at_right, choice, known_width, menu_button, menu_triangle};
use crate::inspector::model::scene::OpenScene;
use crate::inspector::model::{Model, WindowPlace};
use crate::inspector::panels::settings::is_same;
use crate::inspector::shell::{export, view_menu};
use crate::inspector::tours::TOURS;
use crate::technique::Technique;
use egui::containers::menu::MenuButton;
use egui::{Margin, RichText, Ui, vec2};

/// From this width on there is space for the tools side by side, points; in a narrower window they are a menu.
const WIDE: f32 = 760.0;
/// From this width on there is space for the program's name, too, points.
const TITLED: f32 = 880.0;
/// Name of the tools at the right end.
const TOOLS: &str = "tools";
/// Width of the name of what is open, points: it is fixed so that the techniques do not move.
const NAME_WIDTH: f32 = 112.0;
const NARROW_NAME_WIDTH: f32 = 88.0;

/// Draws the bar at the upper edge: opening, what is open, the techniques, and tools.
pub fn ui(ui: &mut Ui, model: &mut Model, actions: &mut Vec<Action>) {
    let frame = egui::Frame::new().fill(theme::of(ui).background).inner_margin(Margin::symmetric(8, 4));
    egui::Panel::top("top bar").frame(frame).show(ui, |ui| {
        ui.horizontal(|ui| {
            let is_wide = ui.available_width() >= WIDE;
            if ui.available_width() >= TITLED {
                theme::heading(ui, "stencilscope");
                ui.separator();
            }
            if ui.button("Open…").on_hover_text("Open a scene, a model or a capture folder (Ctrl-O)").clicked() {
                model.dialog = Some(DialogKind::Open);
            }
            recent(ui, model, is_wide, actions);
            if is_wide {
                ui.add_space(8.0);
            }
            techniques(ui, model, actions);
            at_right(ui, TOOLS, |ui| match is_wide {
                true => tools(ui, model, actions),
                false => {
                    menu_button(ui, "More", |ui| tools(ui, model, actions));
                }
            });
        });
    });
}

/// Draws the name of what is open, with a menu that opens recent sources again, or the dialog for any other; nothing where
/// nothing is open.
fn recent(ui: &mut Ui, model: &mut Model, is_wide: bool, actions: &mut Vec<Action>) {
    let Some(name) = open_name(model) else { return };
    let text = RichText::new(&name).color(theme::of(ui).text);
    let width = if is_wide { NAME_WIDTH } else { NARROW_NAME_WIDTH };
    let size = vec2(width, ui.spacing().interact_size.y);
    let button = egui::Button::new((text, menu_triangle())).gap(6.0).truncate().min_size(size);
    let entries = |ui: &mut Ui| {
        ui.label(theme::note("Opened before"));
        if model.recent.is_empty() {
            ui.label("nothing yet");
        }
        for source in &model.recent {
            if ui.button(source).clicked() {
                actions.push(Action::Open(source.clone()));
                ui.close();
            }
        }
        ui.separator();
        let another = ui.add(egui::Button::new("Another scene…").shortcut_text(theme::number("Ctrl-O")));
        if another.accessible_name("Another scene…").clicked() {
            model.dialog = Some(DialogKind::Open);
            ui.close();
        }
    };
    let place = ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
        MenuButton::from_button(button).ui(ui, entries).0
    });
    place
        .inner
        .accessible_name(format!("What is open: {name}"))
        .on_hover_text(format!("{name}: what is open, and what was"));
}

/// Draws the buttons for undo, redo, export, in a page sharing, view, help.
fn tools(ui: &mut Ui, model: &mut Model, actions: &mut Vec<Action>) {
    let undoes = model.undoes();
    let words = undoes.as_ref().map_or_else(|| "Nothing to undo".to_owned(), |what| format!("Undo {what} (Ctrl-Z)"));
    let undo = ui.add_enabled(undoes.is_some(), egui::Button::new("Undo"));
    if undo.on_hover_text(&words).on_disabled_hover_text(&words).clicked() {
        model.take_back(actions);
    }
    let redoes = model.redoes();
    let words =
        redoes.as_ref().map_or_else(|| "Nothing to redo".to_owned(), |what| format!("Redo {what} (Ctrl-Shift-Z)"));
    let redo = ui.add_enabled(redoes.is_some(), egui::Button::new("Redo"));
    if redo.on_hover_text(&words).on_disabled_hover_text(&words).clicked() {
        model.make_again(actions);
    }
    let menu = menu_button(ui, "Export", |ui| export::menu(ui, model));
    menu.response.on_hover_text("Save the picture, its values, the capture or the scene (Ctrl-S)");
    if model.place == WindowPlace::Page {
        let share = ui.button("Share").on_hover_text("Copy a link to this scene, technique, step and pixel");
        if share.clicked() {
            actions.push(Action::Share);
        }
    }
    tours_button(ui, model);
    let menu = menu_button(ui, "View", |ui| view_menu::menu(ui, model));
    menu.response.on_hover_text("Layouts of the panels, size of everything, theme");
    if ui.button("Help").on_hover_text("All keys (F1)").clicked() {
        model.dialog = Some(DialogKind::Help);
    }
}

/// Draws the button of the list of tours, with a mark until it was pressed for the first time: whoever is new is to find
/// them.
fn tours_button(ui: &mut Ui, model: &mut Model) {
    let menu = menu_button(ui, "Tours", |ui| tours(ui, model));
    let is_new = !model.knows_tours && model.tour_focus.is_none();
    let hover = match is_new {
        true => "New here? Guided tours go through each technique and move the panels for you",
        false => "Guided tours of the techniques: they move the panels for you",
    };
    if is_new {
        let at = menu.response.rect.right_top() + vec2(-4.0, 4.0);
        ui.painter().circle_filled(at, 3.5, theme::of(ui).tour);
    }
    model.knows_tours |= menu.response.clicked();
    menu.response.on_hover_text(hover);
}

/// Draws the list of guided tours, each with what one knows after it; a click asks for one to begin.
fn tours(ui: &mut Ui, model: &mut Model) {
    // The two lines of an entry belong together.
    ui.spacing_mut().item_spacing.y = 8.0;
    for (index, tour) in TOURS.iter().enumerate() {
        let colors = theme::of(ui);
        let format = |size: f32, color| egui::TextFormat::simple(egui::FontId::proportional(size), color);
        let promise = format!("\n{}: {} stops", tour.promise, tour.stops.len());
        let mut words = egui::text::LayoutJob::default();
        words.append(tour.technique.name(), 0.0, format(theme::TEXT_SIZE, colors.text));
        words.append(&promise, 0.0, format(theme::SMALL_SIZE, colors.dim));
        let entry = ui.add(egui::Button::new(words).wrap_mode(egui::TextWrapMode::Extend));
        if entry.accessible_name(format!("Begin the tour of {}", tour.technique.name())).clicked() {
            model.requests.tour = Some(index);
            ui.close();
        }
    }
}

fn open_name(model: &Model) -> Option<String> {
    let of_scene = model.scene.as_ref().map(|scene| scene.name.clone());
    let what = if model.origin().is_some() { "recorded" } else { "capture" };
    of_scene.or_else(|| model.frame.capture.as_ref().map(|capture| format!("{} ({what})", capture.scene)))
}

/// Draws one button for each technique, or a list where the window is narrow; choosing another one runs the scene with
/// it. Where no scene is open, only the capture's technique, or that it is another program's.
fn techniques(ui: &mut Ui, model: &mut Model, actions: &mut Vec<Action>) {
    let beside = known_width(ui, TOOLS) + ui.spacing().item_spacing.x;
    let Some(scene) = &model.scene else {
        // A capture folder: its technique can't be changed.
        match (&model.frame.capture, model.origin()) {
            (_, Some(_)) => {
                let words = theme::note("drawn by another program: its technique can't be changed");
                let size = vec2(ui.available_width() - beside, ui.spacing().interact_size.y);
                ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
                    ui.add(egui::Label::new(words).truncate());
                });
            }
            (Some(capture), None) => {
                ui.label(theme::note(format!("technique {}", capture.technique)));
            }
            (None, None) => {}
        }
        return;
    };
    let current = scene.draft.choice.technique();
    let labels = Technique::ALL.map(|technique| (technique.name(), technique.summary()));
    let chosen = Technique::ALL.iter().position(|technique| *technique == current);
    let changes = Technique::ALL.map(|technique| changes(scene, technique));
    let segment = |((label, explanation), changed)| ButtonSegment { changed, ..ButtonSegment::new(label, explanation) };
    let all: Vec<ButtonSegment> = labels.into_iter().zip(changes.iter().map(String::as_str)).map(segment).collect();
    let picked = choice(ui, "Technique", &all, chosen, beside);
    if let Some(index) = picked {
        model.choose_technique(Technique::ALL[index], actions);
    }
}

/// Returns the settings of a technique, as used now or last in this scene, that differ from its defaults: `casters
/// light-facing`, separated by commas. Empty where none does or it was not used.
fn changes(scene: &OpenScene, technique: Technique) -> String {
    let choice = if scene.draft.choice.technique() == technique {
        Some(&scene.draft.choice)
    } else {
        scene.choices.get(&technique)
    };
    let Some(choice) = choice else { return String::new() };
    let specs = technique.settings().iter();
    let changed = specs.filter_map(|spec| {
        let value = choice.settings().get(spec.key).filter(|value| !is_same(value, spec.default))?;
        Some(format!("{} {value}", spec.key))
    });
    changed.collect::<Vec<_>>().join(", ")
}

//! Export: the shown picture, its data, the capture, the scene, or the report, into a file.
//!
//! The panel asks for a place; the app writes. A place that is taken is asked about once more.

use super::action::{Action, RunRequest};
use super::as_shown::{self, Drawing};
use super::coloring::Coloring;
use super::modes::{Phase, has_phases};
use super::picture;
use super::state::State;
use super::texture;
use super::theme;
use crate::capture::{Capture, Image};
use crate::picture::Picture;
use crate::report::Report;
use egui::{Context, Id, Key, RichText, Ui};
use std::sync::Arc;

/// What is exported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportKind {
    /// The shown picture in its colours, or what the step changed, a pixel a texel: PNG. What lies over it
    /// and what it is compared with is left out.
    Picture,
    /// The same with overlays and the compared half, at the same resolution: PNG.
    AsShown,
    /// The shown picture's values: NumPy.
    Data,
    /// The whole capture: a folder.
    Capture,
    /// The scene as it is now, with its technique: a scene file.
    Scene,
    /// The rows of the Report tab, or their plot: what the file's ending says.
    Report,
}

impl ExportKind {
    /// All, in the order of the menu.
    pub const ALL: [ExportKind; 6] = [
        ExportKind::Picture,
        ExportKind::AsShown,
        ExportKind::Data,
        ExportKind::Capture,
        ExportKind::Scene,
        ExportKind::Report,
    ];

    /// In the menu.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            ExportKind::Picture => "Shown picture (PNG)…",
            ExportKind::AsShown => "Picture with overlays (PNG)…",
            ExportKind::Data => "Shown values (.npy)…",
            ExportKind::Capture => "Capture folder…",
            ExportKind::Scene => "Scene file (TOML)…",
            ExportKind::Report => "Report (table or plot)…",
        }
    }

    fn explanation(self) -> &'static str {
        match self {
            ExportKind::Picture => "The shown picture in its colours, a pixel a texel",
            ExportKind::AsShown => {
                "The shown picture with overlays and the compared half, whole and a pixel a texel, not as zoomed here"
            }
            ExportKind::Data => "The shown picture's values as an array that NumPy reads",
            ExportKind::Capture => {
                "Every buffer after every pass, with a manifest, to be opened again or scripted against"
            }
            ExportKind::Scene => "The scene with its lights, camera and technique as they are now",
            ExportKind::Report => {
                "Error against run time, as measured in the Report tab: .csv, .md or .json for the rows, .svg or .png \
                 for the plot"
            }
        }
    }
}

/// Asks where to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExportDialog {
    /// What is exported.
    pub kind: ExportKind,
    /// The path field.
    pub path: String,
    /// The path that was found taken: pressing again replaces it.
    pub taken: Option<String>,
    /// Why the last try failed, with the mend.
    pub error: Option<String>,
}

impl ExportDialog {
    /// The dialog of the shown picture; none while nothing is shown.
    #[must_use]
    pub fn first(state: &State) -> Option<ExportDialog> {
        ExportDialog::new(ExportKind::Picture, state)
    }

    /// With a name that says what it is; none where there is nothing of this kind.
    #[must_use]
    pub fn new(kind: ExportKind, state: &State) -> Option<ExportDialog> {
        let name = match kind {
            ExportKind::Report => format!("{}-report.csv", state.report.measured()?.rows.first()?.scene),
            kind => ExportDialog::name_of_shown(kind, state)?,
        };
        let plain = |c: char| if c.is_alphanumeric() || matches!(c, '.' | '-' | '_') { c } else { '-' };
        let path = name.chars().map(plain).collect();
        Some(ExportDialog { kind, path, taken: None, error: None })
    }

    /// What is made of the capture or the open scene.
    fn name_of_shown(kind: ExportKind, state: &State) -> Option<String> {
        let capture = state.capture.as_ref()?;
        let title = || {
            let shown = state.shown(capture)?;
            let is_change = state.modes.phase == Phase::Diff && has_phases(shown.kind);
            Some(if is_change { format!("{}-change", shown.title) } else { shown.title })
        };
        let stem = format!("{}-{}", capture.scene, capture.technique);
        Some(match kind {
            ExportKind::Picture => format!("{stem}-{}.png", title()?),
            // Nothing lies over layers side by side.
            ExportKind::AsShown if state.shown(capture)?.images.len() > 1 => return None,
            ExportKind::AsShown => format!("{stem}-{}-as-shown.png", title()?),
            ExportKind::Data => format!("{stem}-{}.npy", state.shown(capture)?.title),
            ExportKind::Capture => format!("{stem}-capture"),
            ExportKind::Scene => format!("{}.toml", state.scene.as_ref()?.name),
            ExportKind::Report => return None,
        })
    }
}

/// The dialog, and what came of the last export.
#[derive(Debug, Default)]
pub struct ExportState {
    /// While it is open.
    pub dialog: Option<ExportDialog>,
    /// What was written last, for the status bar.
    pub done: Option<String>,
}

/// What is to be written.
#[derive(Debug, Clone)]
pub enum ExportData {
    /// Pixels.
    Picture(Picture),
    /// Pixels, once it is finished.
    AsShown(Box<Drawing>),
    /// One picture, or all layers of a map.
    Data(Vec<Arc<Image>>),
    /// All of it.
    Capture(Arc<Capture>),
    /// The scene as this runs it.
    Scene(Box<RunRequest>),
    /// What was measured.
    Report(Box<Report>),
}

/// What `kind` means now; none where there is nothing of it.
#[must_use]
pub fn data(state: &mut State, kind: ExportKind) -> Option<ExportData> {
    if kind == ExportKind::Report {
        return state.report.measured().cloned().map(|report| ExportData::Report(Box::new(report)));
    }
    let capture = state.capture.clone()?;
    match kind {
        ExportKind::Capture => return Some(ExportData::Capture(capture)),
        ExportKind::Scene => return Some(ExportData::Scene(Box::new(state.scene.as_ref()?.draft.clone()))),
        ExportKind::Picture | ExportKind::AsShown | ExportKind::Data | ExportKind::Report => {}
    }
    let shown = state.shown(&capture)?;
    if kind == ExportKind::Data {
        return Some(ExportData::Data(shown.images));
    }
    let coloring = picture::shown_coloring(state, &shown);
    if kind == ExportKind::AsShown {
        let is_one = shown.images.len() == 1;
        return is_one.then(|| ExportData::AsShown(Box::new(as_shown::drawing(state, &capture, &shown, coloring))));
    }
    if let Some((ground, change)) = picture::change_of(state, &capture, &shown) {
        let mut picture = texture::picture(&ground, Coloring::Srgb);
        texture::lay_over(&mut picture, &change.image, change.coloring(), 0..ground.size()[0]);
        return Some(ExportData::Picture(picture));
    }
    let images: Vec<Picture> = shown.images.iter().map(|image| texture::picture(image, coloring.0)).collect();
    Some(ExportData::Picture(side_by_side(&images)))
}

/// Pictures in a row, their tops level.
fn side_by_side(pictures: &[Picture]) -> Picture {
    let width = pictures.iter().map(|picture| picture.size()[0]).sum();
    let height = pictures.iter().map(|picture| picture.size()[1]).max().unwrap_or(0);
    let mut all = Picture::filled([width, height], [0; 3]);
    let mut left = 0;
    for picture in pictures {
        all.paste(picture, [left, 0]);
        left += picture.size()[0];
    }
    all
}

/// The menu's entries.
pub fn menu(ui: &mut Ui, state: &mut State) {
    for kind in ExportKind::ALL {
        let dialog = ExportDialog::new(kind, state);
        let button = ui.add_enabled(dialog.is_some(), egui::Button::new(kind.name()));
        let button = button.on_hover_text(kind.explanation());
        let nothing = match kind {
            ExportKind::AsShown => "Overlays lie over one picture: show one, and not all layers of a light's map",
            ExportKind::Report => "Nothing is measured yet, or not all: press Measure in the Report tab",
            _ => "There is nothing of this kind to export now",
        };
        if button.on_disabled_hover_text(nothing).clicked() {
            state.export.dialog = dialog;
            ui.close();
        }
    }
}

/// Draws the dialog while it is open.
pub fn ui(ctx: &Context, state: &mut State, actions: &mut Vec<Action>) {
    let Some(mut dialog) = state.export.dialog.take() else { return };
    let modal = egui::Modal::new(Id::unique("export dialog")).frame(theme::dialog(ctx));
    let answer = modal.show(ctx, |ui| {
        ui.set_width(480.0_f32.min(ctx.content_rect().width() - 64.0).max(1.0));
        contents(ui, &mut dialog)
    });
    match answer.inner {
        Answer::Cancel => return,
        Answer::Waiting if answer.should_close() => return,
        Answer::Waiting => {}
        Answer::Browse => actions.push(Action::BrowseExport { kind: dialog.kind, path: dialog.path.clone() }),
        Answer::Write => {
            let path = dialog.path.trim().to_owned();
            let replace = dialog.taken.as_ref() == Some(&path);
            dialog.error = None;
            actions.push(Action::Export { kind: dialog.kind, path, replace });
        }
    }
    state.export.dialog = Some(dialog);
}

enum Answer {
    Waiting,
    Cancel,
    Browse,
    Write,
}

fn contents(ui: &mut Ui, dialog: &mut ExportDialog) -> Answer {
    theme::heading(ui, &format!("Export: {}", dialog.kind.name().trim_end_matches('…')));
    ui.label(theme::note(dialog.kind.explanation()));
    ui.add_space(8.0);
    let what = if dialog.kind == ExportKind::Capture { "To this folder" } else { "To this file" };
    let label = ui.label(theme::note(what));
    let field = egui::TextEdit::singleline(&mut dialog.path).desired_width(f32::INFINITY);
    let field = ui.add(field.align(egui::Align2::LEFT_CENTER)).labelled_by(label.id);
    let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    if ui.memory(|memory| memory.focused().is_none()) {
        field.request_focus();
    }
    let path = dialog.path.trim().to_owned();
    let is_taken = dialog.taken.as_ref() == Some(&path);
    if is_taken {
        let text = RichText::new("× Something of this name is there already.").color(theme::of(ui).error);
        ui.add(egui::Label::new(text).wrap());
    }
    if let Some(error) = &dialog.error {
        ui.add(egui::Label::new(RichText::new(format!("× {error}")).color(theme::of(ui).error)).wrap());
    }
    ui.add_space(8.0);
    let mut answer = Answer::Waiting;
    ui.horizontal(|ui| {
        let word = if is_taken { "Replace it" } else { "Save" };
        let save = ui.add_enabled(!path.is_empty(), egui::Button::new(word));
        if !path.is_empty() && (save.clicked() || (is_entered && !is_taken)) {
            answer = Answer::Write;
        }
        if ui.button("Browse…").on_hover_text("Choose the place with the system's dialog").clicked() {
            answer = Answer::Browse;
        }
        if ui.button("Cancel").clicked() {
            answer = Answer::Cancel;
        }
    });
    answer
}

//! Export: the shown picture, its data, the capture, the scene, or the report, into a file.
//!
//! The dialog asks for a path; the app writes. Before an existing file is replaced it asks once more.

use crate::ask::{FilmOf, FilmSubject, ReportOf, RunRequest};
use crate::capture::{Capture, Image};
use crate::inspector::action::{Action, DialogKind, ExportKind};
use crate::inspector::look::coloring::Coloring;
use crate::inspector::look::texture;
use crate::inspector::look::theme;
use crate::inspector::model::diagnosed::KnownDiagnosis;
use crate::inspector::model::{Model, WindowPlace};
use crate::inspector::panels::picture::as_shown::{self, BothSides, PickMark, PictureDrawing};
use crate::inspector::panels::picture::{self, PicturePanel, compared};
use crate::numbers;
use crate::picture::Picture;
use crate::reading::both_sides;
use crate::reading::picture_view::{PictureKind, ShownPicture};
use crate::report::Report;
use egui::text::{CCursor, CCursorRange};
use egui::text_edit::TextEditState;
use egui::{Context, Id, Key, RichText, Role, Ui, WidgetInfo};
use std::path::Path;
use std::sync::Arc;

/// The dialog that asks for an export's path.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExportDialog {
    /// What is exported.
    pub kind: ExportKind,
    /// The text of the path field.
    pub path: String,
    /// The path at which a file was found: pressing again replaces it.
    pub taken: Option<String>,
    /// Why the last try failed, and how to fix it.
    pub error: Option<String>,
    /// The name in the field was selected, as it is once, when the dialog opens.
    is_selected: bool,
}

impl ExportDialog {
    /// Opens the dialog with a file name that describes the content, in which unusual characters are `-`; `None` where
    /// there is nothing of this kind to export, or a film is being written and this would be another.
    pub fn new(kind: ExportKind, model: &Model) -> Option<ExportDialog> {
        if is_film(kind) && model.answers.asked::<FilmOf>().is_some() {
            return None;
        }
        let name = match kind {
            ExportKind::Report => format!("{}-report.csv", measured(model)?.rows.first()?.scene),
            ExportKind::Diagnosis => format!("{}-diagnosis.txt", model.last_diagnosis()?.name()),
            kind => ExportDialog::name_of_shown(kind, model)?,
        };
        let plain = |c: char| if c.is_alphanumeric() || matches!(c, '.' | '-' | '_') { c } else { '-' };
        let path = name.chars().map(plain).collect();
        Some(ExportDialog { kind, path, taken: None, error: None, is_selected: false })
    }

    /// Returns a file name for an export of the capture or of the open scene; `None` where there is nothing of this
    /// kind, for several layers as they are shown, and for the report.
    fn name_of_shown(kind: ExportKind, model: &Model) -> Option<String> {
        let capture = model.frame.capture.as_ref()?;
        let title = || {
            let shown = model.shown(capture)?;
            Some(match changed(model, capture, &shown) {
                Some(what) => format!("{}-{what}", shown.title),
                None => shown.title,
            })
        };
        let is_picture = matches!(kind, ExportKind::Picture | ExportKind::AsShown);
        let carries_both = kind.carries_both() && (!is_picture || pictures_both(model, kind));
        let stem = match model.both_frames().filter(|_| carries_both) {
            Some((frames, _)) => {
                let names = both_sides::names(&frames).join("-beside-").replace(", ", "-").replace(' ', "-");
                format!("{}-{names}", capture.scene)
            }
            None => format!("{}-{}", capture.scene, capture.technique),
        };
        Some(match kind {
            ExportKind::Picture => format!("{stem}-{}.png", title()?),
            // Layers shown side by side have no overlays.
            ExportKind::AsShown if model.shown(capture)?.images.len() > 1 => return None,
            ExportKind::AsShown => format!("{stem}-{}-as-shown.png", title()?),
            ExportKind::Data => format!("{stem}-{}.npy", model.shown(capture)?.title),
            ExportKind::Steps => format!("{stem}-passes.png"),
            ExportKind::LightRound => format!("{stem}-{}-round.png", numbers::light(selected_light(model)?)),
            ExportKind::Page => format!("{stem}.html"),
            ExportKind::Capture => format!("{stem}-capture"),
            ExportKind::Scene => format!("{}.toml", model.scene.as_ref()?.name),
            ExportKind::Report | ExportKind::Diagnosis => return None,
        })
    }
}

/// The data of an export, ready to be written.
#[derive(Debug, Clone)]
pub enum ExportData {
    /// A finished picture.
    Picture(Picture),
    /// A picture whose triangles are still to be drawn.
    AsShown(Box<PictureDrawing>),
    /// Both pictures of a comparison, whole, each over its name.
    BothSides(Box<BothSides>),
    /// One picture, or all layers of a map.
    Data(Vec<Arc<Image>>),
    /// The whole capture, as a folder.
    Capture(Arc<Capture>),
    /// The whole capture, as a page for a browser.
    Page {
        /// The frame, with all that is known of it by now.
        capture: Arc<Capture>,
        /// What the page opens at, in the words of its fragment.
        look: String,
        /// Why it is wrong, where that is known.
        diagnosis: Option<KnownDiagnosis>,
    },
    /// An animation, computed while it is written.
    Film(FilmSubject),
    /// The scene with its present settings.
    Scene(Box<RunRequest>),
    /// The measured report.
    Report(Box<Report>),
    /// What was found wrong.
    Diagnosis(KnownDiagnosis),
}

/// Returns the run of the open scene with the present settings; `None` where no scene is open, or they can't be run.
fn runnable(model: &Model) -> Option<RunRequest> {
    let scene = model.scene.as_ref()?;
    scene.problem.is_none().then(|| scene.draft.clone())
}

/// Returns the data for a `kind` of export as it is now; `None` where there is none, as for several layers as they are
/// shown.
pub fn data(own: &mut PicturePanel, model: &mut Model, kind: ExportKind) -> Option<ExportData> {
    if kind == ExportKind::Report {
        return measured(model).cloned().map(|report| ExportData::Report(Box::new(report)));
    }
    if kind == ExportKind::Diagnosis {
        return model.last_diagnosis().map(ExportData::Diagnosis);
    }
    // A preview is nothing to keep.
    let capture = model.frame.capture.clone().filter(|_| !model.frame.is_preview)?;
    match kind {
        ExportKind::Capture => return Some(ExportData::Capture(capture)),
        ExportKind::Page => {
            let look = page_look(model);
            return Some(ExportData::Page { capture, look, diagnosis: model.diagnosis_as_shown() });
        }
        ExportKind::Scene => return Some(ExportData::Scene(Box::new(runnable(model)?))),
        ExportKind::Steps => {
            let sides = model.both_frames().map_or_else(|| vec![capture], |(frames, _)| frames.to_vec());
            return Some(ExportData::Film(FilmSubject::Steps(sides)));
        }
        ExportKind::LightRound => {
            let light = selected_light(model)?;
            let request = runnable(model)?;
            let sides = model.both_frames().map_or_else(|| vec![request], |(_, requests)| requests.to_vec());
            return Some(ExportData::Film(FilmSubject::LightRound { sides, light }));
        }
        ExportKind::Picture | ExportKind::AsShown | ExportKind::Data => {}
        ExportKind::Report | ExportKind::Diagnosis => return None,
    }
    let shown = model.shown(&capture)?;
    if kind == ExportKind::Data {
        return Some(ExportData::Data(shown.images));
    }
    let mapping = model.shown_coloring(&shown);
    let compare = model.modes.compare;
    if kind == ExportKind::AsShown {
        if shown.images.len() != 1 {
            return None;
        }
        if compare.is_some_and(|compare| compare.has_two_places()) && !model.subtracts(&capture, &shown) {
            let now = as_shown::drawing(own, model, &capture, &shown, mapping, None);
            let both = as_shown::both(own, model, &capture, &shown, mapping, now.clone(), PickMark::Drawn);
            return Some(
                both.map_or_else(|| ExportData::AsShown(Box::new(now)), |both| ExportData::BothSides(Box::new(both))),
            );
        }
        let drawing = as_shown::drawing(own, model, &capture, &shown, mapping, compare);
        return Some(ExportData::AsShown(Box::new(drawing)));
    }
    if let Some((ground, change)) = picture::change_of(own, model, &capture, &shown) {
        let mut picture = texture::picture(&ground, Coloring::Srgb);
        texture::lay_over(&mut picture, &change.image, Coloring::of_change(change.kind), 0..ground.size()[0]);
        return Some(ExportData::Picture(picture));
    }
    let mut images: Vec<Picture> = shown.images.iter().map(|image| texture::picture(image, mapping.coloring)).collect();
    if let ([one], Some([_, veil])) = (&mut images[..], compared::veils(own, model, &capture, &shown)) {
        texture::lay_over(one, &veil, Coloring::ColorChange, 0..veil.size()[0]);
    }
    if let [one] = &images[..]
        && let Some(both) =
            as_shown::both(own, model, &capture, &shown, mapping, PictureDrawing::plain(one.clone()), PickMark::LeftOut)
    {
        return Some(ExportData::BothSides(Box::new(both)));
    }
    Some(ExportData::Picture(Picture::in_a_row(&images, 0, [0; 3])))
}

/// Returns what a page opens at, in the words of its fragment: the step, draw, picture and pixel that are shown here, and the
/// scene's time, where something moves, for its title.
fn page_look(model: &Model) -> String {
    let point = model.selected();
    let mut words = vec![format!("step={}", point.step + 1)];
    words.extend(point.draw.map(|draw| format!("draw={}", draw + 1)));
    let view = match model.view.kind {
        Some(PictureKind::Color) => "color",
        Some(PictureKind::Stencil) => "stencil",
        Some(PictureKind::Count) => "count",
        Some(PictureKind::Depth) => "depth",
        Some(PictureKind::Mask) => "mask",
        Some(PictureKind::Error) => "error",
        Some(PictureKind::Map) => "map",
        _ => "auto",
    };
    words.push(format!("view={view}"));
    words.extend((model.view.light > 0).then(|| format!("light={}", model.view.light + 1)));
    words.extend(model.selection.pick.map(|[x, y]| format!("pixel={x},{y}")));
    words.extend(model.frame.time.map(|time| format!("time={time:.2}")));
    words.join("&")
}

/// Returns what is shown in place of a picture: the `change` that the step made, or the `difference` of the counts or depths
/// of two sides; `None` where it is a picture.
fn changed(model: &Model, capture: &Arc<Capture>, shown: &ShownPicture) -> Option<&'static str> {
    if !shown.kind.has_phases() {
        return None;
    }
    match model.modes.shows_change() {
        true => Some("change"),
        false => model.subtracts(capture, shown).then_some("difference"),
    }
}

/// Does a picture that is exported show both sides of a comparison?
fn pictures_both(model: &Model, kind: ExportKind) -> bool {
    let Some(capture) = &model.frame.capture else { return false };
    let Some(shown) = model.shown(capture) else { return false };
    let is_alone = kind == ExportKind::Picture && changed(model, capture, &shown).is_some();
    !is_alone && shown.images.len() == 1 && model.both_compared(capture, &shown).is_some()
}

/// Returns a sentence that says which side of the comparison an export carries; `None` where nothing is compared, or the
/// export is of no frame.
fn carried(model: &Model, kind: ExportKind) -> Option<String> {
    let compare = model.modes.compare?;
    let capture = model.frame.capture.as_ref()?;
    let [other, now] = compared::names(model, capture, &compare);
    let shown = model.shown(capture)?;
    // In the order in which they stand, as in the file's name.
    let [first, second] = if compare.flipped { [&now, &other] } else { [&other, &now] };
    let both = || Some(format!("Carries both sides, each over its name: {first} and {second}."));
    let alone = |because: &str| Some(format!("Carries one side alone, {now}, and not {other}: {because}."));
    match kind {
        ExportKind::Report | ExportKind::Diagnosis => None,
        ExportKind::Picture | ExportKind::AsShown if changed(model, capture, &shown).is_some() => {
            Some(format!("Carries one picture, of {now} minus {other}."))
        }
        ExportKind::AsShown if !compare.has_two_places() && model.both_compared(capture, &shown).is_some() => {
            Some(format!("Carries both sides under the divider, as it stands: {first} and {second}."))
        }
        ExportKind::Picture | ExportKind::AsShown if pictures_both(model, kind) => both(),
        ExportKind::Picture | ExportKind::AsShown => alone("the other can't be shown beside it now"),
        ExportKind::Steps | ExportKind::LightRound if !compare.with.is_of_another_frame() => {
            alone("both are of one frame")
        }
        ExportKind::Steps | ExportKind::LightRound if model.both_frames().is_some() => both(),
        ExportKind::Steps | ExportKind::LightRound if !model.compares_one_scene() => {
            alone("the other is of the scene before it was changed; a picture carries both")
        }
        ExportKind::Steps | ExportKind::LightRound => alone("the other is not captured yet"),
        ExportKind::Data => alone("an array has one picture's values"),
        ExportKind::Page | ExportKind::Capture if !compare.with.is_of_another_frame() => {
            Some("Carries the whole frame, of which both sides are, and not that they are compared.".to_owned())
        }
        ExportKind::Page | ExportKind::Capture => {
            alone("it is of one frame; a picture or an animation carries both, or make a second one of the other")
        }
        ExportKind::Scene => alone("a scene file has one technique"),
    }
}

/// Returns a sentence that says whether a page carries the diagnosis that is known; `None` for other exports, and where none
/// is known.
fn diagnosis_carried(model: &Model, kind: ExportKind) -> Option<String> {
    model.last_diagnosis().filter(|_| kind == ExportKind::Page)?;
    Some(match model.diagnosis_as_shown() {
        Some(_) => "Carries the diagnosis: each wrong region with its cause, and the fix with its proof.".to_owned(),
        None => "The diagnosis is not of the frame as it is shown, so it is left out: diagnose again to have it in."
            .to_owned(),
    })
}

/// Returns a sentence that says which file a scene file names, and so must be given with it: that of the open model; `None`
/// for other exports, and where the scene is of no model.
fn named_beside(model: &Model, kind: ExportKind) -> Option<String> {
    let source = model.scene.as_ref()?.source.as_deref().filter(|_| kind == ExportKind::Scene)?;
    let file = Path::new(source).file_name()?.to_str()?;
    let is_model = Path::new(source).extension().is_some_and(|ending| !ending.eq_ignore_ascii_case("toml"));
    is_model.then(|| format!("Names the model {file} by its place: who opens it needs that file, too."))
}

fn is_film(kind: ExportKind) -> bool {
    matches!(kind, ExportKind::Steps | ExportKind::LightRound)
}

/// Returns the index of the light that goes round the scene: the one chosen in the picture panel, or the last where
/// there are fewer; `None` without a scene or lights.
fn selected_light(model: &Model) -> Option<usize> {
    let last = model.scene.as_ref()?.draft.lights.len().checked_sub(1)?;
    Some(model.view.light.min(last))
}

/// Returns the last measured report; `None` while one is being measured, or where it has no rows or is not whole.
fn measured(model: &Model) -> Option<&Report> {
    let (_, measured) = model.answers.last::<ReportOf>().filter(|_| model.answers.asked::<ReportOf>().is_none())?;
    (measured.is_whole && !measured.report.rows.is_empty()).then_some(&measured.report)
}

/// Draws the menu's entries, one for each kind of export, off with the reason where there is nothing of that kind; a
/// click opens the dialog.
pub fn menu(ui: &mut Ui, model: &mut Model) {
    for kind in ExportKind::ALL {
        let dialog = ExportDialog::new(kind, model);
        let button = ui.add_enabled(dialog.is_some(), egui::Button::new(kind.name()));
        let button = button.on_hover_text(kind.explanation());
        let nothing = match kind {
            kind if is_film(kind) && model.answers.asked::<FilmOf>().is_some() => {
                "An animation is being written: wait for it, or cancel it in the status bar"
            }
            ExportKind::LightRound if model.origin().is_some() => {
                "Another program drew this frame: there is no scene to light anew. Export it pass by pass"
            }
            ExportKind::LightRound => "There is no scene with a light that could go round: open one",
            ExportKind::AsShown => "Overlays lie over one picture: show one, and not all layers of a light's map",
            ExportKind::Diagnosis => "Nothing is diagnosed yet: press Diagnose in the Diagnosis tab",
            ExportKind::Report => "Nothing is measured yet, or not all: press Measure in the Report tab",
            _ => "There is nothing of this kind to export now",
        };
        if button.on_disabled_hover_text(nothing).clicked() {
            model.dialog = dialog.map(|dialog| DialogKind::Export(dialog.kind));
            ui.close();
        }
    }
}

/// Draws the export dialog while it is open, and adds the action that the user asks for; `own` is its state, `None`
/// while it is closed. It closes where there is nothing to export.
pub fn ui(ctx: &Context, own: &mut Option<ExportDialog>, model: &mut Model, actions: &mut Vec<Action>) {
    let Some(DialogKind::Export(kind)) = model.dialog else {
        *own = None;
        return;
    };
    // What is exported is of the moment at which it was asked for.
    model.animation.is_running = false;
    // Where there is nothing to export, the dialog closes.
    let Some(mut dialog) = own.take().or_else(|| ExportDialog::new(kind, model)) else {
        model.dialog = None;
        return;
    };
    let modal = egui::Modal::new(Id::unique("export dialog")).frame(theme::dialog(ctx));
    let shown = model.frame.capture.as_ref().and_then(|capture| model.shown(capture));
    let may_have_legend = kind == ExportKind::AsShown && shown.is_some_and(|shown| as_shown::may_have_legend(&shown));
    let mut has_legend = may_have_legend.then_some(!model.modes.exports_no_legend);
    let notes = [carried(model, kind), diagnosis_carried(model, kind), named_beside(model, kind)];
    let answer = modal.show(ctx, |ui| {
        ui.set_width(480.0_f32.min(ctx.content_rect().width() - 64.0).max(1.0));
        contents(ui, &mut dialog, model.place, &notes, &mut has_legend)
    });
    if let Some(has_legend) = has_legend {
        model.modes.exports_no_legend = !has_legend;
    }
    match answer.inner {
        ExportReply::Waiting if !answer.should_close() => {}
        ExportReply::Waiting | ExportReply::Cancel => {
            model.dialog = None;
            return;
        }
        ExportReply::Browse => actions.push(Action::BrowseExport { path: dialog.path.clone() }),
        ExportReply::Write => {
            let path = dialog.path.trim().to_owned();
            let replace = dialog.taken.as_ref() == Some(&path);
            dialog.error = None;
            actions.push(Action::Export { kind: dialog.kind, path, replace });
        }
    }
    *own = Some(dialog);
}

/// Returns a path with the folder that it is in, so that the user finds it; as it was given where there are no folders.
pub fn whole(path: &Path) -> String {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned()).display().to_string()
}

/// Draws in which folder a file will be, or which folder will be written, with the whole path as hover text.
fn destination(ui: &mut Ui, path: &Path, kind: ExportKind) {
    let whole = whole(path);
    let words = match (kind, Path::new(&whole).parent()) {
        (ExportKind::Capture, _) | (_, None) => format!("makes {whole}"),
        (_, Some(folder)) => format!("in {}", folder.display()),
    };
    let shown = theme::elided(ui, &words, &egui::TextStyle::Small.resolve(ui.style()), ui.available_width());
    let label = ui.add(egui::Label::new(theme::note(shown)).extend()).on_hover_text(whole);
    label.widget_info(|| WidgetInfo::labeled(Role::Label, true, &words));
}

/// Selects in the field of a path the file's name without its ending: that is what one types anew.
fn select_stem(ctx: &Context, field: Id, path: &str) {
    let place = |byte: usize| CCursor::new(path[..byte].chars().count());
    let start = path.rfind(['/', '\\']).map_or(0, |slash| slash + 1);
    let end = path[start..].rfind('.').filter(|dot| *dot > 0).map_or(path.len(), |dot| start + dot);
    let mut state = TextEditState::load(ctx, field).unwrap_or_default();
    state.cursor.set_char_range(Some(CCursorRange::two(place(start), place(end))));
    state.store(ctx, field);
}

enum ExportReply {
    Waiting,
    Cancel,
    Browse,
    Write,
}

/// Draws the dialog's contents: what is exported, notes on what it carries, whether it has a legend where it may, and
/// the path. Returns what the user wants.
fn contents(
    ui: &mut Ui,
    dialog: &mut ExportDialog,
    place: WindowPlace,
    notes: &[Option<String>],
    has_legend: &mut Option<bool>,
) -> ExportReply {
    theme::heading(ui, &format!("Export: {}", dialog.kind.name().trim_end_matches('…')));
    ui.label(theme::note(dialog.kind.explanation()));
    for note in notes.iter().flatten() {
        ui.add(egui::Label::new(RichText::new(note).color(theme::of(ui).text)).wrap());
    }
    if let Some(has_legend) = has_legend {
        ui.checkbox(has_legend, "With the legend").on_hover_text("In a corner of the picture, as in the window");
    }
    ui.add_space(8.0);
    let what = match (place, dialog.kind) {
        (WindowPlace::Page, ExportKind::Capture) => "As a download of this name: a .zip of the folder",
        (WindowPlace::Page, _) => "As a download of this name",
        (WindowPlace::Desktop, ExportKind::Capture) => "To this folder",
        (WindowPlace::Desktop, _) => "To this file",
    };
    let label = ui.label(theme::note(what));
    let field = egui::TextEdit::singleline(&mut dialog.path).desired_width(f32::INFINITY);
    let field = ui.add(field.align(egui::Align2::LEFT_CENTER)).labelled_by(label.id);
    let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    if ui.memory(|memory| memory.focused().is_none()) {
        field.request_focus();
        if !std::mem::replace(&mut dialog.is_selected, true) {
            select_stem(ui.ctx(), field.id, &dialog.path);
        }
    }
    let path = dialog.path.trim().to_owned();
    if place == WindowPlace::Desktop && !path.is_empty() {
        destination(ui, Path::new(&path), dialog.kind);
    }
    let is_taken = dialog.taken.as_ref() == Some(&path);
    if is_taken {
        let text = RichText::new("× Something of this name is there already.").color(theme::of(ui).error);
        ui.add(egui::Label::new(text).wrap());
    }
    if let Some(error) = &dialog.error {
        ui.add(egui::Label::new(RichText::new(format!("× {error}")).color(theme::of(ui).error)).wrap());
    }
    ui.add_space(8.0);
    let mut answer = ExportReply::Waiting;
    ui.horizontal(|ui| {
        let word = if is_taken { "Replace it" } else { "Save" };
        let save = ui.add_enabled(!path.is_empty(), egui::Button::new(word));
        let save = save.on_disabled_hover_text("Type first where to save it");
        if !path.is_empty() && (save.clicked() || (is_entered && !is_taken)) {
            answer = ExportReply::Write;
        }
        let browse = "Choose the place with the system's dialog";
        if place == WindowPlace::Desktop && ui.button("Browse…").on_hover_text(browse).clicked() {
            answer = ExportReply::Browse;
        }
        if ui.button("Cancel").clicked() {
            answer = ExportReply::Cancel;
        }
    });
    answer
}

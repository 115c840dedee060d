//! The dialog that opens a scene: built-in ones with their lessons, or a path.

use crate::inspector::action::{Action, DialogKind};
use crate::inspector::look::theme;
use crate::inspector::model::{Model, WindowPlace};
use crate::scene::{TextureImage, builtin};
use egui::{ColorImage, Context, Id, Image, Key, Rect, RichText, TextureHandle, TextureOptions, Ui, pos2, vec2};
use std::path::Path;

/// Width and height of a scene's thumbnail in its file, pixels.
pub const THUMBNAIL: [u32; 2] = [80, 60];
/// Thumbnails of the built-in scenes in their order, one below the other: `stencilscope pictures --only thumbnails` draws them.
const THUMBNAILS: &[u8] = include_bytes!("../../../assets/pictures/thumbnails.png");
/// Their size in the dialog, points.
const SHOWN_THUMBNAIL: egui::Vec2 = vec2(36.0, 27.0);

/// How many recent files are listed.
const MOST_RECENT: usize = 4;

/// A built-in scene, or a frame of another program, in the dialog.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneEntry {
    /// The name or path that opens it.
    pub name: String,
    /// What it shows, in a sentence.
    pub lesson: String,
}

/// The entries of the dialog, and the path that is typed into it.
#[derive(Debug, Default)]
pub struct OpenDialog {
    /// Built-in scenes.
    scenes: Vec<SceneEntry>,
    /// Frames of other programs.
    pub frames: Vec<SceneEntry>,
    path: String,
    /// The path that was typed and is being opened.
    typed: Option<String>,
    /// Why that could not be opened, until another is typed.
    refused: Option<String>,
}

impl OpenDialog {
    /// Returns a dialog that offers these built-in scenes, and no frames of other programs.
    pub fn new(scenes: Vec<SceneEntry>) -> OpenDialog {
        OpenDialog { scenes, ..OpenDialog::default() }
    }

    /// Takes back a path that was typed here and could not be opened, with the reason, to be corrected; what was typed since
    /// stays. Returns false for any other.
    pub fn take_back(&mut self, source: &str, reason: &str) -> bool {
        let is_own = self.typed.take_if(|typed| typed == source).is_some();
        if is_own {
            if self.path.trim().is_empty() {
                source.clone_into(&mut self.path);
            }
            self.refused = Some(reason.to_owned());
        }
        is_own
    }

    /// Sets what stands under the path as an error, until another path is typed.
    pub fn refuse(&mut self, reason: String) {
        self.refused = Some(reason);
    }

    /// A scene or a folder is open: returns whether that of a typed path was waited for, which is over.
    pub fn end_waiting(&mut self) -> bool {
        self.typed.take().is_some()
    }

    /// Returns whether the source is the name of a listed scene or frame.
    fn names(&self, source: &str) -> bool {
        self.scenes.iter().chain(&self.frames).any(|entry| entry.name == source)
    }
}

/// Draws the open dialog while it is open, and adds the action that opens what was chosen or asks for a file or folder;
/// a choice closes it. A typed path does once it is open, so that what is typed meanwhile is typed here; it is cleared while
/// the dialog is closed.
pub fn ui(ctx: &Context, own: &mut OpenDialog, model: &mut Model, actions: &mut Vec<Action>) {
    if model.dialog != Some(DialogKind::Open) {
        own.path.clear();
        own.refused = None;
        return;
    }
    let modal = egui::Modal::new(Id::unique("open dialog")).frame(theme::dialog(ctx));
    let answer = modal.show(ctx, |ui| {
        ui.set_width(480.0_f32.min(ctx.content_rect().width() - 64.0).max(1.0));
        contents(ui, own, &model.recent, model.place)
    });
    match answer.inner {
        OpenReply::Waiting if !answer.should_close() => return,
        OpenReply::Waiting | OpenReply::Cancel => {}
        OpenReply::Open(what) => {
            own.typed = Some(what.clone()).filter(|what| what == own.path.trim());
            own.refused = None;
            actions.push(Action::Open(what));
            if own.typed.is_some() {
                return;
            }
        }
        OpenReply::Browse => actions.push(Action::Browse),
        OpenReply::BrowseFolder => actions.push(Action::BrowseFolder),
    }
    model.dialog = None;
}

enum OpenReply {
    Waiting,
    Cancel,
    Browse,
    BrowseFolder,
    Open(String),
}

fn contents(ui: &mut Ui, dialog: &mut OpenDialog, recent: &[String], place: WindowPlace) -> OpenReply {
    let mut answer = OpenReply::Waiting;
    theme::heading(ui, "Open");
    let files: Vec<&String> = recent.iter().filter(|source| !dialog.names(source)).take(MOST_RECENT).collect();
    if !files.is_empty() {
        ui.label(theme::note("Opened before"));
    }
    for file in &files {
        let path = Path::new(file);
        let name = path.file_name().map_or_else(|| file.to_string(), |name| name.to_string_lossy().into_owned());
        let folder = path.parent().map_or_else(String::new, |folder| folder.display().to_string());
        if scene_row(ui, None, &name, &folder) {
            answer = OpenReply::Open(file.to_string());
        }
    }
    ui.add_space(if files.is_empty() { 0.0 } else { 8.0 });
    // So that what is under the lists stays visible.
    let others = ui.min_rect().height() + 320.0;
    let height = (ui.ctx().content_rect().height() - others).clamp(60.0, 400.0);
    let lists = [("A built-in scene", &dialog.scenes, height), ("A frame of another program", &dialog.frames, 120.0)];
    for (title, entries, height) in lists.into_iter().filter(|(_, entries, _)| !entries.is_empty()) {
        ui.label(theme::note(title));
        let scroll = egui::ScrollArea::vertical().id_salt(title).max_height(height).auto_shrink([false, true]);
        scroll.show(ui, |ui| {
            for entry in entries {
                if scene_row(ui, thumbnail(ui.ctx(), &entry.name), &entry.name, &entry.lesson) {
                    answer = OpenReply::Open(entry.name.clone());
                }
            }
        });
        ui.add_space(8.0);
    }
    let own = match place {
        WindowPlace::Desktop => of_path(ui, dialog),
        WindowPlace::Page => of_files(ui),
    };
    if matches!(own, OpenReply::Waiting) { answer } else { own }
}

/// Draws what opens files in a page, where nothing has a path.
fn of_files(ui: &mut Ui) -> OpenReply {
    let text = "Your own: drop it onto the page, or choose it. A scene file (.toml) or a model (.obj, .ply, .gltf, .glb) with \
                the files that it names, a capture folder, or a .zip of any. It stays on this machine.";
    ui.add(egui::Label::new(theme::note(text)).wrap());
    ui.add_space(8.0);
    let mut answer = OpenReply::Waiting;
    ui.horizontal(|ui| {
        if ui.button("Choose files…").on_hover_text("Files of one scene or model, or a .zip").clicked() {
            answer = OpenReply::Browse;
        }
        if ui.button("Choose a folder…").on_hover_text("A capture folder, or a model's with all its files").clicked()
        {
            answer = OpenReply::BrowseFolder;
        }
        if ui.button("Cancel").clicked() {
            answer = OpenReply::Cancel;
        }
    });
    answer
}

/// Draws what opens a path, or asks the system's dialog for one.
fn of_path(ui: &mut Ui, dialog: &mut OpenDialog) -> OpenReply {
    let mut answer = OpenReply::Waiting;
    let OpenDialog { path, refused, typed, .. } = dialog;
    let label = ui.label(theme::note("A scene file (.toml), a model (.obj, .ply, .gltf, .glb) or a capture folder"));
    let field = egui::TextEdit::singleline(path).hint_text("path").desired_width(f32::INFINITY);
    let field = field.align(egui::Align2::LEFT_CENTER);
    let field = ui.add(field).labelled_by(label.id);
    let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    if ui.memory(|memory| memory.focused().is_none()) {
        field.request_focus();
    }
    if field.changed() {
        *refused = None;
    }
    if let Some(reason) = refused {
        ui.add(egui::Label::new(RichText::new(format!("× {reason}")).color(theme::of(ui).error)).wrap());
    } else if let Some(typed) = typed {
        ui.add(egui::Label::new(theme::note(format!("Opening {typed} …"))).wrap());
    }
    ui.add_space(8.0);
    let path = path.trim();
    ui.horizontal(|ui| {
        let open = ui.add_enabled(!path.is_empty(), egui::Button::new("Open this"));
        let open = open.on_disabled_hover_text("Type a path first, or press Browse…");
        if !path.is_empty() && (open.clicked() || entered) {
            answer = OpenReply::Open(path.to_owned());
        }
        if ui.button("Browse…").on_hover_text("Choose a scene or model with the system's dialog").clicked() {
            answer = OpenReply::Browse;
        }
        if ui.button("Browse captures…").on_hover_text("Choose a capture folder with the system's dialog").clicked() {
            answer = OpenReply::BrowseFolder;
        }
        if ui.button("Cancel").clicked() {
            answer = OpenReply::Cancel;
        }
    });
    answer
}

/// Returns the thumbnail of a built-in scene: a texture, made at the first call, and the part of it; `None` for anything
/// else, or where thumbnails can't be read.
fn thumbnail(ctx: &Context, scene: &str) -> Option<(TextureHandle, Rect)> {
    let place = builtin::ALL.iter().position(|of| of.name == scene)?;
    let id = Id::unique("thumbnails");
    let known: Option<TextureHandle> = ctx.data(|data| data.get_temp(id));
    let all = match known {
        Some(all) => all,
        None => {
            let most = u64::from(THUMBNAIL[0] * THUMBNAIL[1]) * builtin::ALL.len() as u64;
            let all = TextureImage::decode("thumbnails".to_owned(), THUMBNAILS, most);
            debug_assert!(all.is_ok(), "{all:?}");
            let all = all.ok()?;
            let size = all.size().map(|side| side as usize);
            let image = ColorImage::from_rgba_unmultiplied(size, all.texels().as_flattened());
            let all = ctx.load_texture("thumbnails", image, TextureOptions::LINEAR);
            ctx.data_mut(|data| data.insert_temp(id, all.clone()));
            all
        }
    };
    let share = |place: usize| place as f32 / builtin::ALL.len() as f32;
    Some((all, Rect::from_min_max(pos2(0.0, share(place)), pos2(1.0, share(place + 1)))))
}

/// Draws a scene's thumbnail, if it has one, a button with its name, and its lesson; returns true when thumbnail or button is
/// clicked.
fn scene_row(ui: &mut Ui, thumbnail: Option<(TextureHandle, Rect)>, name: &str, lesson: &str) -> bool {
    let text = RichText::new(name).color(theme::of(ui).text);
    ui.horizontal(|ui| {
        let mut is_clicked = false;
        if let Some((all, part)) = thumbnail {
            let image = Image::new((all.id(), SHOWN_THUMBNAIL)).uv(part).corner_radius(2).sense(egui::Sense::CLICK);
            is_clicked = ui.add(image.alt_text(format!("Picture of {name}"))).clicked();
        }
        let button = egui::Button::new(text).truncate();
        let clicked = ui.add_sized(vec2(112.0, theme::ROW_HEIGHT), button).clicked();
        ui.add(egui::Label::new(theme::note(lesson)).wrap());
        clicked || is_clicked
    })
    .inner
}

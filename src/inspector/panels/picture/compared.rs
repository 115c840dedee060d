//! The picture that the shown one is compared with: its name, how many pixels differ and where, and both pictures whole,
//! side by side or one over the other.

use super::{PicturePanel, legend, overlays};
use crate::capture::{Capture, Image};
use crate::history::Verdict;
use crate::inspector::canvas::magnifier::{self, Occupied};
use crate::inspector::canvas::placement::Placement;
use crate::inspector::canvas::{self, Canvas, PictureSheet};
use crate::inspector::look::coloring::{ColorMapping, Coloring};
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::inspector::model::comparing::{ComparedWith, Comparison, FrameBeside, ONCE_WHOLE, SidesLayout, sentence};
use crate::inspector::model::selection::Hover;
use crate::inspector::panels::pixel::truth;
use crate::reading::both_sides::{self, Counterpart};
use crate::reading::capture_point::CapturePoint;
use crate::reading::format;
use crate::reading::moment;
use crate::reading::picture_view::{PictureKind, ShownPicture, TexelZoom};
use egui::{
    Button, Galley, Label, Pos2, Rect, RichText, Shape, Stroke, TextStyle, TextWrapMode, Ui, UiBuilder, Vec2,
    WidgetText, pos2, vec2,
};
use std::sync::Arc;

/// Width of the note on how many pixels differ, points.
const NOTE_WIDTH: f32 = 232.0;
/// Height of what is said in place of a picture, points.
const REASON_HEIGHT: f32 = 20.0;
/// Space around what stands over a picture, between its lines, and between a name and what stands beside it, points.
const HEAD_MARGIN: Vec2 = vec2(8.0, 4.0);
const HEAD_GAP: f32 = 2.0;
const ASIDE_GAP: f32 = 16.0;
/// Size of the button that goes to the next difference, points.
const NEXT_WIDTH: f32 = 40.0;
const NEXT_HEIGHT: f32 = 18.0;
/// In a panel narrower than this and higher than wide, two pictures lie one over the other, points.
const LEAST_BESIDE: f32 = 480.0;
/// Space between two pictures, in which a line divides them, points.
const HALVES_GAP: f32 = 5.0;
/// Kinds of picture whose legends count texels: each of two pictures side by side has its own.
const LEGENDS: [PictureKind; 4] = [PictureKind::Stencil, PictureKind::Count, PictureKind::Mask, PictureKind::Truth];
/// How far from the middle the divider leaves the place of a difference seen, as a share of the panel's width.
const ASIDE: f32 = 0.1;
/// Name of the canvas of the picture that the shown one is compared with.
const COMPARED: &str = "Compared canvas";

/// Returns the names of the two sides of a comparison: first the compared picture's, then the shown one's; steps by
/// their words, techniques by their names, settings by their values.
pub fn names(model: &Model, capture: &Capture, compare: &Comparison) -> [String; 2] {
    let now = match compare.with {
        ComparedWith::Step(_) => model.shown_point().words(capture),
        ComparedWith::Technique(_) => capture.technique.clone(),
        ComparedWith::Setting { key, .. } => match capture.settings.get(key) {
            Some(value) => format!("{key} {value}"),
            None => capture.technique.clone(),
        },
        ComparedWith::Defaults => "as it is set".to_owned(),
        ComparedWith::BeforeFix if model.fix_in_use().is_some() => "after the fix".to_owned(),
        ComparedWith::BeforeFix => capture.technique.clone(),
        ComparedWith::BeforeChange if model.before_last_change().is_some() => "after the change".to_owned(),
        ComparedWith::BeforeChange => "as it is set".to_owned(),
        ComparedWith::Fixed { .. } => "as it was drawn".to_owned(),
    };
    [compare.with.words(capture), now]
}

/// Returns, where the compared side shows its colour in place of a kind of picture that it has not, what it lacks.
fn lacks_kind(model: &Model, capture: &Arc<Capture>, shown: &ShownPicture) -> Option<String> {
    model.lacks_kind(capture, shown, &model.shown_compared(capture, shown).ok()?)
}

/// Returns how the compared picture is coloured beside one of this mapping: in the same bit or range.
pub fn coloring_beside(other: &ShownPicture, ColorMapping { coloring, range }: ColorMapping) -> Coloring {
    match coloring {
        Coloring::Bit(_) if other.kind == PictureKind::Stencil => coloring,
        _ => Coloring::of_shown(other, range),
    }
}

/// Returns what stands below each picture of a comparison in a file, first the compared one's: its technique with what is
/// set of it, or that it is before or after a change of the scene, which picture after which step it is, the pass's name, and the scene's time where something moves.
pub fn captions(
    model: &Model,
    capture: &Arc<Capture>,
    shown: &ShownPicture,
    other: &FrameBeside,
    beside: &ShownPicture,
) -> [String; 2] {
    let frames = [Arc::clone(&other.capture), Arc::clone(capture)];
    let names = match model.modes.compare.filter(|_| !model.compares_one_scene()) {
        Some(compare) => names(model, capture, &compare).to_vec(),
        None => both_sides::names(&frames),
    };
    let words = |side: usize, title: &str, point: CapturePoint, time: Option<f64>| {
        let step = frames[side].steps.get(point.step);
        let pass = step.map_or_else(String::new, |step| format!(" ({})", step.name));
        let time = time.map_or_else(String::new, |time| format!(" · {}", format::time(time)));
        format!("{} · {title}{pass}{time}", names[side])
    };
    let point = model.compared_point(capture, &other.capture).point;
    [words(0, &beside.title, point, other.time), words(1, &shown.title, model.shown_point(), model.frame.time)]
}

/// Returns the names of the two sides with the moment that each shows: the step or draw, what the compared side lacks of the
/// shown one's, and the scene's time where something moves; first the compared side's, without a moment while there is no
/// picture of it.
pub fn names_with_moment(
    model: &Model,
    capture: &Arc<Capture>,
    compare: &Comparison,
    other: Option<&FrameBeside>,
    shown: &ShownPicture,
) -> [String; 2] {
    let [other_name, now_name] = names(model, capture, compare);
    let in_brackets = |lacks: Option<String>| lacks.map_or_else(String::new, |lacks| format!(" ({lacks})"));
    let no_kind = in_brackets(lacks_kind(model, capture, shown));
    let at = |time: Option<f64>| time.map_or_else(String::new, |time| format!(" · {}", format::time(time)));
    let now = model.shown_point();
    let now_name = match compare.with.is_of_another_frame() {
        true => format!("{now_name} · {}{}", now.words(capture), at(model.frame.time)),
        false => now_name,
    };
    let Some(FrameBeside { capture: of, time, is_behind }) = other.filter(|_| compare.with.is_of_another_frame())
    else {
        return [other_name + &no_kind, now_name];
    };
    let Counterpart { point, lacks } = model.compared_point(capture, of);
    let lacks = in_brackets(lacks) + &no_kind;
    let behind = if *is_behind && time.is_none() { " · as it was before" } else { "" };
    [format!("{other_name} · {}{lacks}{}{behind}", point.words(of), at(*time)), now_name]
}

/// Returns the names of the two sides as they stand beside a divider: with what the compared one lacks, if it shows its colour.
pub fn names_in_place(
    model: &Model,
    capture: &Arc<Capture>,
    compare: &Comparison,
    shown: &ShownPicture,
) -> [String; 2] {
    let [other, now] = names(model, capture, compare);
    let lacks = lacks_kind(model, capture, shown);
    [lacks.map_or_else(|| other.clone(), |lacks| format!("{other} ({lacks})")), now]
}

/// Draws the compared picture into one half of `rect`, and over both halves what they show and what each says of the picked
/// pixel; returns the rest of the other half, for the shown picture. Both halves show the same part, and a pick in one is
/// that of the other. Until there is a picture to compare with, its half says why.
pub fn beside(
    ui: &mut Ui,
    own: &mut PicturePanel,
    model: &mut Model,
    capture: &Arc<Capture>,
    rect: Rect,
    shown: &ShownPicture,
    compare: &Comparison,
) -> Rect {
    let (first, second) = halves(rect, compare.layout);
    let [now_half, other_half] = if compare.flipped { [first, second] } else { [second, first] };
    let other = model.compared_frame(capture).ok();
    let [other_name, now_name] = names_with_moment(model, capture, compare, other.as_ref(), shown);
    let differ = difference(own, model, capture, shown);
    let has_next = differ.as_ref().is_ok_and(|differ| differ.pixels > 0);
    let differ = differ.map(|differ| differ.words).unwrap_or_default();
    let verdict =
        |of: Option<(&Arc<Capture>, CapturePoint)>| verdict(model, of, capture, shown.kind).unwrap_or_default();
    // Two pictures of which most is grey are not taken for the two sides.
    let heading = if model.modes.shows_difference() { "Difference · " } else { "" };
    let [other_name, now_name] = [other_name, now_name].map(|name| format!("{heading}{name}"));
    let now_words = [now_name, String::new(), verdict(Some((capture, model.shown_point())))];
    let other_at = other.as_ref().map(|other| (&other.capture, model.compared_point(capture, &other.capture).point));
    let other_words = [other_name, differ, verdict(other_at)];
    let width = first.width();
    let lines = [head_lines(ui, &now_words, false, width), head_lines(ui, &other_words, has_next, width)];
    // Both pictures are as large. Side by side, a verdict has two lines at least, also before a pixel is picked: the pictures
    // must not move under the pointer that picks.
    let is_side_by_side = first.top() == second.top();
    let more = |lines: &HeadLines| if is_side_by_side { lines.below_two() } else { 0.0 };
    let height = lines.iter().map(|lines| lines.height + more(lines)).fold(0.0, f32::max);
    let [now_place, other_place] = [(now_half, &lines[0]), (other_half, &lines[1])].map(|(half, lines)| {
        head(ui, half.with_max_y((half.top() + height).min(half.bottom())), lines, model);
        half.with_min_y((half.top() + height).min(half.bottom()))
    });
    match model.shown_compared(capture, shown) {
        Ok(other) => {
            let coloring = coloring_beside(&other, model.shown_coloring(shown));
            let veil = veils(own, model, capture, shown).map(|[veil, _]| veil_sheet(veil, other_place));
            let sheets: Vec<PictureSheet> = veil.into_iter().collect();
            let canvas = Canvas {
                name: COMPARED,
                view: &mut model.view,
                pick: model.selection.pick_of(shown.kind),
                textures: &mut model.textures,
                has_arrows: false,
                picks_by_click: !model.walk.is_on(),
            };
            let (placement, hover) = canvas::ui(ui, canvas, other_place, &other, coloring, &sheets);
            model.selection.hover = hover.map(|at| Hover { image: 0, at });
            mark_specks(ui, own, model, capture, shown, other_place, placement);
            if shown.kind != PictureKind::Map && model.compares_one_scene() {
                let is_of_one_frame = !compare.with.is_of_another_frame();
                overlays::over_compared(ui, &mut own.overlays, model, other_place, placement, is_of_one_frame);
            }
            let mut occupied = Occupied::default();
            if LEGENDS.contains(&other.kind) {
                // Its counts are those of its own picture.
                let range = model.shown_coloring(&other).range;
                let legend = |ui: &mut Ui| {
                    legend::ui(ui, &mut own.counts_findings, model, other_place, &other, range, &Occupied::default())
                };
                occupied.kept.extend(ui.push_id("legend of the compared picture", legend).inner);
            }
            if let Some(pick) = *model.selection.pick_of(shown.kind) {
                magnifier::ui(ui, pick, other_place, &other, coloring, placement, &occupied);
            }
        }
        Err(reason) => {
            canvas::background(ui, other_place, None);
            let size = vec2((other_place.width() - 32.0).clamp(1.0, NOTE_WIDTH), REASON_HEIGHT);
            let text = Label::new(theme::note(reason)).wrap().halign(egui::Align::Center);
            ui.put(Rect::from_center_size(other_place.center(), size), text);
        }
    }
    let line = Stroke::new(1.0, theme::of(ui).faint);
    let middle = rect.center().round();
    if is_side_by_side {
        ui.painter().vline(middle.x + 0.5, rect.y_range(), line);
    } else {
        ui.painter().hline(rect.x_range(), middle.y + 0.5, line);
    }
    now_place
}

/// Returns the halves of a panel in a layout of two pictures, with a gap between: left and right, or top and bottom.
fn halves(rect: Rect, layout: SidesLayout) -> (Rect, Rect) {
    let middle = rect.center();
    let [before, after] = [-0.5, 0.5].map(|side| side * HALVES_GAP);
    let is_narrow = rect.width() < rect.height() && rect.width() < LEAST_BESIDE;
    if layout == SidesLayout::Stacked || is_narrow {
        (rect.with_max_y(middle.y + before), rect.with_min_y(middle.y + after))
    } else {
        (rect.with_max_x(middle.x + before), rect.with_min_x(middle.x + after))
    }
}

/// Returns why the picked pixel is dark or lit in the picture of a capture, as it is read beside the stencil at a point of
/// it, once that is known, and whether that is right, where the truth is; `None` where no pixel is picked, or a map is shown.
/// The light is the one that is spoken of in `shown`, the capture that is shown.
fn verdict(
    model: &Model,
    of: Option<(&Arc<Capture>, CapturePoint)>,
    shown: &Capture,
    kind: PictureKind,
) -> Option<String> {
    let at = model.selection.pick.filter(|_| kind != PictureKind::Map)?;
    if model.frame.is_preview {
        return Some(ONCE_WHOLE.to_owned());
    }
    let title = |(of, point): (&Arc<Capture>, CapturePoint)| {
        let light = model.light_in_question(shown, at);
        let title = moment::title(&Verdict::of(of, light, at), of, point, at);
        match of.finding_at(light, at).and_then(truth::sentence) {
            Some(truth) => format!("{title} {truth}"),
            None => title,
        }
    };
    let said = of.map(title);
    Some(said.unwrap_or_else(|| "not known yet".to_owned()))
}

/// What stands over one of two pictures: its name, what else there is to say, and the verdict on the picked pixel, each in
/// as many lines as it takes.
struct HeadLines {
    name: Arc<Galley>,
    aside: Arc<Galley>,
    verdict: Arc<Galley>,
    /// What else there is to say has space at the right end of the name's line.
    is_aside_beside: bool,
    /// Behind it is the button that goes to the next difference.
    has_next: bool,
    /// Height of all, with the space around them, points.
    height: f32,
}

impl HeadLines {
    /// Returns how much lower the verdict is than one of two lines, points.
    fn below_two(&self) -> f32 {
        let line = self.verdict.rows.first().map_or(0.0, |row| row.height());
        let is_empty = self.verdict.text().is_empty();
        if is_empty { 2.0 * line + HEAD_GAP } else { (2.0 * line - self.verdict.size().y).max(0.0) }
    }
}

/// Lays out what stands over a picture of this width, points: name, what else there is to say, with the button that goes to
/// the next difference if it has that, and verdict; the last two may be empty.
fn head_lines(ui: &Ui, [name, aside, verdict]: &[String; 3], has_next: bool, width: f32) -> HeadLines {
    let width = (width - 2.0 * HEAD_MARGIN.x).max(1.0);
    let button = if has_next { NEXT_WIDTH + HEAD_MARGIN.x } else { 0.0 };
    let galley = |text: RichText, width: f32| {
        WidgetText::from(text).into_galley(ui, Some(TextWrapMode::Wrap), width, TextStyle::Body)
    };
    let name = galley(RichText::new(name).color(theme::of(ui).text), width);
    let aside = galley(theme::note(aside), (width - button).max(1.0));
    let verdict = galley(theme::note(verdict), width);
    let is_aside_beside = name.size().x + ASIDE_GAP + aside.size().x + button <= width;
    let line = |galley: &Galley| if galley.text().is_empty() { 0.0 } else { HEAD_GAP + galley.size().y };
    let beside = if is_aside_beside { 0.0 } else { line(&aside) };
    let height = 2.0 * HEAD_MARGIN.y + name.size().y + beside + line(&verdict);
    HeadLines { name, aside, verdict, is_aside_beside, has_next, height }
}

/// Draws over a picture what stands there.
fn head(ui: &mut Ui, place: Rect, lines: &HeadLines, model: &mut Model) {
    ui.painter().rect_filled(place, 0, theme::of(ui).panel);
    let inner = place.shrink2(HEAD_MARGIN);
    let mut draw = |galley: &Arc<Galley>, at: Pos2| {
        if !galley.text().is_empty() {
            let builder = UiBuilder::new().max_rect(Rect::from_min_size(at, galley.size()));
            ui.scope_builder(builder, |ui| ui.add(Label::new(Arc::clone(galley))));
        }
    };
    draw(&lines.name, inner.min);
    let mut top = inner.top() + lines.name.size().y + HEAD_GAP;
    let button = if lines.has_next { NEXT_WIDTH + HEAD_MARGIN.x } else { 0.0 };
    let at = match lines.is_aside_beside {
        true => pos2(inner.right() - button - lines.aside.size().x, inner.top()),
        false => pos2(inner.left(), top),
    };
    draw(&lines.aside, at);
    if !lines.is_aside_beside && !lines.aside.text().is_empty() {
        top += lines.aside.size().y + HEAD_GAP;
    }
    draw(&lines.verdict, pos2(inner.left(), top));
    if lines.has_next {
        let left = (at.x + lines.aside.size().x + HEAD_MARGIN.x).min(inner.right() - NEXT_WIDTH);
        let middle = at.y + lines.aside.rows.first().map_or(0.0, |row| row.height()) / 2.0;
        let place = Rect::from_center_size(pos2(left + NEXT_WIDTH / 2.0, middle), vec2(NEXT_WIDTH, NEXT_HEIGHT));
        ui.scope_builder(UiBuilder::new().max_rect(place).id_salt("next difference"), |ui| next(ui, model, "Next"));
    }
}

/// Draws the button that picks a pixel of the next region in which the sides differ, with these words.
fn next(ui: &mut Ui, model: &mut Model, words: &str) {
    ui.spacing_mut().button_padding = vec2(6.0, 0.0);
    ui.spacing_mut().interact_size.y = NEXT_HEIGHT;
    let button = Button::new(theme::note(words)).min_size(vec2(NEXT_WIDTH, NEXT_HEIGHT));
    let hover = "Pick a pixel of the next region in which the two sides differ, from that of the pick on to smaller ones (N; \
                 Shift-N: back)";
    if ui.add(button).on_hover_text(hover).accessible_name("Next difference").clicked() {
        model.requests.differing_regions = 1;
    }
}

/// How many pixels of the compared pictures differ.
struct DifferingPixels {
    pixels: u64,
    /// The same in words, with the region in which the pick lies where that is known.
    words: String,
}

/// Returns how many pixels differ between the compared pictures, and in which of the regions the pick lies where they are
/// known.
///
/// # Errors
/// They can't be compared, or not yet: why, in a sentence.
fn difference(
    own: &mut PicturePanel,
    model: &Model,
    capture: &Arc<Capture>,
    shown: &ShownPicture,
) -> Result<DifferingPixels, String> {
    let [other, now] = model.pair_to_compare(capture, shown)?;
    let [width, height] = now.size().map(u64::from);
    let pixels = own.changes.differing([&other, &now]).unwrap_or_default();
    let words = sentence(pixels, width * height, shown.kind);
    // Two frames that differ in the end may be the same up to here.
    let is_of_another_frame = model.modes.compare.is_some_and(|compare| compare.with.is_of_another_frame());
    let is_before_the_end = model.shown_point().step + 1 < capture.steps.len();
    let words = match words.strip_suffix('.') {
        Some(none) if pixels == 0 && is_of_another_frame && is_before_the_end => format!("{none} after this step."),
        _ => words,
    };
    let pick = if shown.kind == PictureKind::Map { model.selection.map_pick } else { model.selection.pick };
    let known = own.differing.known_regions([&other, &now]);
    let region = known.and_then(|regions| Some((regions.at(pick?)?, regions.regions.len())));
    let words = match region {
        Some((index, all)) => {
            format!("{words} · region {} of {}", format::count(index as u64 + 1), format::count(all as u64))
        }
        None => words,
    };
    Ok(DifferingPixels { pixels, words })
}

/// Moves the pick as many regions on as is asked for, to the inmost place of the next in which the compared pictures differ,
/// and the view with it where it is zoomed. Returns whether it has moved.
pub fn go_to_difference(
    own: &mut PicturePanel,
    model: &mut Model,
    capture: &Arc<Capture>,
    shown: &ShownPicture,
) -> bool {
    let by = std::mem::take(&mut model.requests.differing_regions);
    if by == 0 {
        return false;
    }
    let Ok([other, now]) = model.pair_to_compare(capture, shown) else { return false };
    let Some(regions) = own.differing.regions([&other, &now]) else { return false };
    let pick = model.selection.pick_of(shown.kind);
    let Some(place) = regions.from(*pick, by) else { return false };
    *pick = Some(place.inmost);
    if model.view.zoom != TexelZoom::Fit {
        model.view.center = place.inmost.map(|along| f64::from(along) + 0.5);
        // In the middle the divider's handle would hide it.
        let hides = |compare: &&mut Comparison| !compare.has_two_places() && (compare.at - 0.5).abs() < ASIDE;
        if let Some(compare) = model.modes.compare.as_mut().filter(hides) {
            compare.at = 0.5 - ASIDE;
        }
    }
    true
}

/// Returns, where of two colour pictures only that is shown in which they differ, how many pixels are the same; `None`
/// otherwise, or where they can't be compared.
pub fn same_colors(own: &mut PicturePanel, model: &Model, capture: &Arc<Capture>, shown: &ShownPicture) -> Option<u64> {
    if !model.modes.shows_difference() || shown.kind != PictureKind::Color {
        return None;
    }
    let [other, now] = model.pair_to_compare(capture, shown).ok()?;
    let [width, height] = now.size().map(u64::from);
    Some(width * height - own.changes.differing([&other, &now])?)
}

/// Returns what lies over both pictures of a comparison, first the compared one, where only that is shown in which they
/// differ: grey where they are the same. `None` where all is shown, or they can't be compared.
pub fn veils(
    own: &mut PicturePanel,
    model: &Model,
    capture: &Arc<Capture>,
    shown: &ShownPicture,
) -> Option<[Arc<Image>; 2]> {
    if !model.modes.shows_difference() {
        return None;
    }
    let [other, now] = model.pair_to_compare(capture, shown).ok()?;
    let of = model.compared_frame(capture).ok()?.capture;
    let points = [model.compared_point(capture, &of).point, model.shown_point()];
    // Values are shown over the finished frame, in which the place is recognised.
    let ground = |frame: &Capture, point: CapturePoint| {
        let at = if shown.kind == PictureKind::Color { point } else { frame.steps.len().checked_sub(1)?.into() };
        Some(at.frame(frame)?.color.image.clone())
    };
    let grounds = [ground(&of, points[0])?, ground(capture, points[1])?];
    let mut veil = |ground: &Arc<Image>| own.differing.veil([&other, &now], &own.changes.ground(ground));
    Some([veil(&grounds[0])?, veil(&grounds[1])?])
}

/// Marks in a picture of a comparison, where only that is shown in which its sides differ, the regions that are too small to be
/// seen.
pub fn mark_specks(
    ui: &Ui,
    own: &mut PicturePanel,
    model: &Model,
    capture: &Arc<Capture>,
    shown: &ShownPicture,
    rect: Rect,
    placement: Placement,
) {
    if !model.modes.shows_difference() {
        return;
    }
    let Ok([other, now]) = model.pair_to_compare(capture, shown) else { return };
    // While the pictures change many times a second there is no time to look for regions in each.
    let known = match model.animation.is_running {
        true => own.differing.known_regions([&other, &now]),
        false => own.differing.regions([&other, &now]),
    };
    let Some(regions) = known else { return };
    let mesh = canvas::marks(placement, &regions.specks, theme::of(ui).failed);
    ui.painter_at(placement.rect().intersect(rect)).add(Shape::mesh(mesh));
}

/// Returns the sheet of a veil over the picture in a part of the screen.
pub fn veil_sheet(image: Arc<Image>, part: Rect) -> PictureSheet {
    PictureSheet { image, coloring: Coloring::ColorChange, part, has_numbers: false }
}

/// Draws in the upper left corner of `rect` how many pixels differ between the compared pictures, or why they can't be
/// compared; nothing while nothing is compared.
pub fn note(
    ui: &mut Ui,
    own: &mut PicturePanel,
    model: &mut Model,
    capture: &Arc<Capture>,
    shown: &ShownPicture,
    rect: Rect,
) {
    if model.modes.compare.is_none() {
        return;
    }
    match difference(own, model, capture, shown) {
        Ok(DifferingPixels { pixels: 0, words }) | Err(words) => card(ui, rect, &words, |_| ()),
        Ok(DifferingPixels { words, .. }) => card(ui, rect, &words, |ui| next(ui, model, "Next difference")),
    }
}

/// Draws a card with a note in the upper left corner of `rect`, and `more` below it.
pub fn card(ui: &mut Ui, rect: Rect, text: &str, more: impl FnOnce(&mut Ui)) {
    let size = vec2(NOTE_WIDTH.min(rect.width() / 2.0), rect.height());
    let place = Rect::from_min_size(rect.min + vec2(12.0, 12.0), size);
    ui.scope_builder(UiBuilder::new().max_rect(place).id_salt("note in the corner"), |ui| {
        theme::card(ui).fill(theme::of(ui).panel.gamma_multiply(0.94)).show(ui, |ui| {
            ui.add(Label::new(theme::note(text)).wrap());
            more(ui);
        });
    });
}

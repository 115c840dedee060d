//! What only the frames of other programs have: the program, debug groups, and draws whose result differs from the
//! stored one when they are run again.

use super::fields::PassesPanel;
use crate::capture::{DrawSummary, RecomputeDifference};
use crate::inspector::look::theme;
use crate::inspector::model::Model;
use crate::plan::{FramePlan, Program, ShaderEffect};
use crate::reading::format;
use egui::{Label, Role, Sense, TextStyle, Ui, UiBuilder, WidgetInfo, pos2, vec2};
use std::sync::Arc;

/// Indent of each level of groups, points, and the largest number of levels.
const INDENT: f32 = 12.0;
const MOST_INDENTED: usize = 4;

/// Draws which program drew the frame, with which API, what recorded it, and what could not be read. Draws nothing for
/// own frames.
pub fn origin(ui: &mut Ui, model: &Model) {
    let Some(origin) = model.origin() else { return };
    let program = origin.program.as_ref().map_or_else(String::new, |program| format!("{program} · "));
    let words = format!("{program}{} · depth {} · recorded by {}", origin.api, origin.depth_format, origin.recorder);
    let hover = "Another program drew this frame. Its pictures are as they were stored; its draws are computed anew for \
                 histories and counts of tests.";
    ui.add(Label::new(theme::note(words)).wrap()).on_hover_text(hover);
    for limit in &origin.limits {
        ui.add(Label::new(theme::note(format!("Limit: {limit}"))).wrap());
    }
}

/// Returns the debug groups of a pass, outermost first.
pub fn groups_of(plan: &FramePlan, pass: usize) -> &[String] {
    plan.passes.get(pass).and_then(|pass| pass.recorded.as_ref()).map_or(&[], |recorded| &recorded.groups)
}

/// The debug groups of a frame that has any, as its plan lists them for each pass.
#[derive(Debug)]
pub struct DebugGroups {
    plan: Arc<FramePlan>,
}

impl DebugGroups {
    /// Returns the groups of the shown frame; `None` where no pass is in a group or the plan is not known. Where the
    /// selected pass has to be scrolled to, the groups that hide it are opened; with another scene, all are.
    pub fn new(own: &mut PassesPanel, model: &Model) -> Option<DebugGroups> {
        let plan = model.frame.plan.clone()?;
        if (0..plan.passes.len()).all(|pass| groups_of(&plan, pass).is_empty()) {
            return None;
        }
        let groups = DebugGroups { plan };
        if std::mem::replace(&mut own.folded_of, model.scenes_opened) != model.scenes_opened {
            own.folded.clear();
        }
        if model.selection.wants_scroll {
            let step = model.selection.step;
            for level in 0..groups_of(&groups.plan, step).len() {
                own.folded.remove(&[groups.first(step, level), level]);
            }
        }
        Some(groups)
    }

    /// Returns the index of the first pass of the run of passes, up to `pass`, that are in the same group on this level
    /// (and in the same groups around it).
    fn first(&self, pass: usize, level: usize) -> usize {
        let path = groups_of(&self.plan, pass).get(..=level);
        let is_in = |other: &usize| groups_of(&self.plan, *other).get(..=level) == path;
        (0..=pass).rev().take_while(is_in).last().unwrap_or(pass)
    }

    /// Draws the headings of the groups that begin with `pass`, down to the first one that is folded. Returns the
    /// pass's indent in levels, or `None` where a folded group hides it.
    pub fn above(&self, ui: &mut Ui, own: &mut PassesPanel, pass: usize) -> Option<usize> {
        let path = groups_of(&self.plan, pass);
        for (level, name) in path.iter().enumerate() {
            let first = self.first(pass, level);
            if first == pass {
                indented(ui, level, |ui| heading(ui, own, name, [pass, level]));
            }
            if own.folded.contains(&[first, level]) {
                return None;
            }
        }
        Some(path.len())
    }
}

/// Draws a group's heading, with a sign that says whether it is folded; a click folds or unfolds its passes. `group` is
/// the index of its first pass, and its level.
fn heading(ui: &mut Ui, own: &mut PassesPanel, name: &str, group: [usize; 2]) {
    let is_folded = own.folded.contains(&group);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), theme::ROW_HEIGHT), Sense::click());
    let label = format!("Debug group {name}");
    response.widget_info(|| WidgetInfo::selected(Role::TreeItem, true, !is_folded, &label));
    theme::row_background(ui, rect, false, &response);
    let sign = if is_folded { "▶" } else { "▼" };
    let colors = theme::of(ui);
    let at = pos2(rect.left() + 8.0, rect.center().y - 7.0);
    theme::line(ui, at, 12.0, sign, TextStyle::Monospace, colors.dim);
    theme::name_line(ui, at + vec2(16.0, -1.0), rect.width() - 32.0, name, TextStyle::Body, colors.text);
    let words = if is_folded { "show" } else { "hide" };
    let response = response.on_hover_text(format!("{name}\nA debug group of the program: click to {words} its passes"));
    if response.clicked() && !own.folded.remove(&group) {
        own.folded.insert(group);
    }
}

/// Draws contents indented by so many levels of groups; deeper levels than a limit are indented by that limit.
pub fn indented(ui: &mut Ui, levels: usize, add: impl FnOnce(&mut Ui)) {
    let mut area = ui.available_rect_before_wrap();
    area.min.x = (area.min.x + INDENT * levels.min(MOST_INDENTED) as f32).min(area.max.x);
    ui.scope_builder(UiBuilder::new().max_rect(area), add);
}

/// Returns a mark for a draw of another program's frame, `≠ 12`, with the larger of the numbers of pixels whose depth
/// and whose stencil differ from the stored ones when it is run again; `None` where none differs or it was not run
/// again.
pub fn mark(draw: &DrawSummary) -> Option<String> {
    let RecomputeDifference { depth, stencil, .. } = draw.differs.filter(|differs| !differs.is_nowhere())?;
    Some(format!("≠ {}", format::count(depth.max(stencil))))
}

/// Explains the mark of [`mark`], and what the shader of the draw of this index in the selected pass may do that is not
/// followed here: discard fragments, write its own depth. Each sentence begins with a line break; empty where there is
/// nothing to say.
pub fn explained(model: &Model, draw: &DrawSummary, index: usize) -> String {
    let mut words = String::new();
    if let Some(RecomputeDifference { depth, stencil, .. }) = draw.differs.filter(|differs| !differs.is_nowhere()) {
        words += &format!(
            "\n≠ Computed anew from what was there before it, this draw leaves another stencil at {} and another depth \
             at {}. Histories are not to be trusted there.",
            format::counted(stencil, "pixel"),
            format::counted(depth, "pixel"),
        );
    }
    let plan = model.frame.plan.as_ref();
    let draw = plan.and_then(|plan| plan.passes.get(model.selection.step)?.draws.get(index));
    if let Some((plan, draw)) = plan.zip(draw)
        && let Program::Recorded { may_discard, writes_depth } = draw.program
    {
        let mut report = |may: ShaderEffect, what: &str| match may {
            ShaderEffect::No => {}
            ShaderEffect::Yes => words += &format!("\nIts shader may {what}, which is not followed"),
            ShaderEffect::Unknown => words += &format!("\nIts shader could not be read: it may {what}"),
        };
        if draw.discards_unknown(&plan.meshes[draw.mesh.0]) {
            report(may_discard, "discard fragments");
        }
        report(writes_depth, "write its own depth");
        for light in &draw.samples_maps_of {
            words += &format!("\nIts shader samples the shadow map of {}", light.name());
        }
    }
    words
}

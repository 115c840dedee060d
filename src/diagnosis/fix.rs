//! Fixes: what to change so that a cause is gone.

use crate::plan::{DrawPart, FramePlan};
use crate::scene::{MeshError, Scene};
use crate::technique::{Choice, ChoiceError, Technique};
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

/// A change of technique, settings, scene, plan or picture size that may remove a fault; empty where nothing helps.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct Fix {
    /// The technique to use instead; settings that both have stay as they are. `None` for no change.
    pub technique: Option<Technique>,
    /// Settings to change: values by keys.
    pub settings: BTreeMap<String, String>,
    /// Changes of the scene.
    pub scene: Vec<SceneEdit>,
    /// Changes of the plan, for errors that no setting of ours could cause.
    pub plan: Vec<PlanEdit>,
    /// Draw a picture this many times as large along each side: an odd number, so that each pixel's centre stays the
    /// centre of one. `None` for no change.
    pub larger: Option<u32>,
}

/// Why a fix can't be applied.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FixError {
    /// The technique has no such setting or value.
    #[error(transparent)]
    Choice(#[from] ChoiceError),
    /// A mesh can't be welded.
    #[error("{name}: {source}")]
    Mesh {
        /// Name of the object.
        name: String,
        /// The error of the mesh.
        source: MeshError,
    },
    /// The scene has no such object.
    #[error("the scene has no object number {} ({name})", object + 1)]
    NoObject {
        /// Index of the object.
        object: usize,
        /// The name that it had.
        name: String,
    },
}

/// A change of one object of the scene.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct SceneEdit {
    /// Index of the object in the scene.
    pub object: usize,
    /// Its name.
    pub name: String,
    /// The change.
    pub change: ObjectChange,
}

named_enum! {
    /// A change of an object.
    pub enum ObjectChange {
        /// Merges vertices at bit-equal positions.
        Weld = "weld",
        /// Sets `receives = true`.
        Receives = "receives",
        /// Sets `casts = true`.
        Casts = "casts",
        /// Sets `visible = true`.
        Visible = "visible",
    }
}

named_enum! {
    /// A change of a plan, for errors that no setting could cause.
    pub enum PlanEdit {
        /// Draws the light caps that are missing.
        DrawLightCaps = "draw-light-caps",
        /// Draws the dark caps that are missing.
        DrawDarkCaps = "draw-dark-caps",
        /// Draws light caps in the vertex order of the surface.
        SurfaceOrder = "surface-order",
        /// Fits the views of maps and textures to the scene again.
        Refit = "refit",
    }
}

impl PlanEdit {
    /// Returns the part of volumes that the change draws; `None` for [`PlanEdit::Refit`].
    pub fn part(self) -> Option<DrawPart> {
        match self {
            PlanEdit::DrawLightCaps | PlanEdit::SurfaceOrder => Some(DrawPart::LightCap),
            PlanEdit::DrawDarkCaps => Some(DrawPart::DarkCap),
            PlanEdit::Refit => None,
        }
    }
}

impl Fix {
    /// Returns a fix that changes the technique.
    pub fn technique(technique: Technique) -> Fix {
        Fix { technique: Some(technique), ..Fix::default() }
    }

    /// Returns a fix that changes one setting.
    pub fn setting(key: &str, value: &str) -> Fix {
        Fix { settings: BTreeMap::from([(key.to_owned(), value.to_owned())]), ..Fix::default() }
    }

    /// Returns a fix that changes an object of the scene.
    pub fn scene(object: usize, name: &str, change: ObjectChange) -> Fix {
        Fix { scene: vec![SceneEdit { object, name: name.to_owned(), change }], ..Fix::default() }
    }

    /// Returns a fix that changes the plan.
    pub fn plan(edit: PlanEdit) -> Fix {
        Fix { plan: vec![edit], ..Fix::default() }
    }

    /// Returns a fix that draws a larger picture.
    pub fn larger(times: u32) -> Fix {
        Fix { larger: Some(times), ..Fix::default() }
    }

    /// Returns whether the fix changes nothing at all.
    pub fn is_empty(&self) -> bool {
        *self == Fix::default()
    }

    /// Returns both fixes as one; where both change technique or the same setting, `other` decides, but of light caps and
    /// dark caps both are drawn, and of two larger pictures the larger one decides. Edits of scene and plan are united,
    /// sorted, equal ones once.
    pub fn and(&self, other: &Fix) -> Fix {
        let mut both = self.clone();
        both.technique = other.technique.or(self.technique);
        both.larger = other.larger.max(self.larger);
        both.settings.extend(other.settings.clone());
        let is_other_cap = |(key, value): (&String, &String)| {
            key == "caps" && other.settings.get(key).is_some_and(|other| other != value)
        };
        if self.settings.iter().any(is_other_cap) {
            both.settings.insert("caps".to_owned(), "both".to_owned());
        }
        both.scene.extend(other.scene.iter().cloned());
        both.plan.extend(&other.plan);
        both.scene.sort();
        both.scene.dedup();
        both.plan.sort();
        both.plan.dedup();
        both
    }

    /// Applies the fix's changes of objects, technique and settings; not those of the plan ([`Fix::edit`]) and of the
    /// picture's size. On an error it changes nothing.
    pub fn apply(&self, scene: &mut Scene, choice: &mut Choice) -> Result<(), FixError> {
        // Objects share their meshes, so that copies are small.
        let mut objects = scene.objects.clone();
        for SceneEdit { object, name, change } in &self.scene {
            let missing = || FixError::NoObject { object: *object, name: name.clone() };
            let object = objects.get_mut(*object).ok_or_else(missing)?;
            match change {
                ObjectChange::Weld => {
                    let welded = object.mesh.welded();
                    let welded = welded.map_err(|source| FixError::Mesh { name: name.clone(), source })?;
                    object.mesh = Arc::new(welded);
                }
                ObjectChange::Receives => object.receives = true,
                ObjectChange::Casts => object.casts = true,
                ObjectChange::Visible => object.visible = true,
            }
        }
        self.choose(choice)?;
        scene.objects = objects;
        Ok(())
    }

    /// Applies the changes of technique and settings alone. A new technique keeps the settings that both have, except
    /// `size`; its others are the defaults. The fix's own settings come last. On an error it changes nothing.
    pub fn choose(&self, choice: &mut Choice) -> Result<(), FixError> {
        let mut chosen = choice.clone();
        if let Some(technique) = self.technique.filter(|technique| *technique != choice.technique()) {
            let mut other = Choice::new(technique);
            for spec in technique.settings() {
                if let Some(value) = choice.settings().get(spec.key) {
                    // A size has another meaning in another technique, which may refuse it.
                    if spec.key != "size" {
                        other.set(spec.key, value)?;
                    }
                }
            }
            chosen = other;
        }
        self.settings.iter().try_for_each(|(key, value)| chosen.set(key, value))?;
        *choice = chosen;
        Ok(())
    }

    /// Returns the size of the picture to draw in place of `size`.
    pub fn size(&self, size: [u32; 2]) -> [u32; 2] {
        size.map(|side| side.saturating_mul(self.larger.unwrap_or(1)))
    }

    /// Applies the fix's changes of the plan alone; `fresh` is the technique's own plan of the same scene and settings,
    /// from which missing draws, cap draws and views are taken. Passes are matched by their place.
    pub fn edit(&self, plan: &mut FramePlan, fresh: &FramePlan) {
        for edit in &self.plan {
            match edit {
                PlanEdit::DrawLightCaps | PlanEdit::DrawDarkCaps => draw_missing(plan, fresh, edit.part()),
                PlanEdit::SurfaceOrder => draw_caps_in_order(plan, fresh),
                PlanEdit::Refit => {
                    plan.views.clone_from(&fresh.views);
                    for (light, fresh) in plan.lights.iter_mut().zip(&fresh.lights) {
                        light.map.clone_from(&fresh.map);
                    }
                }
            }
        }
    }

    /// Returns whether it changes technique and settings only, which the window can do.
    pub fn is_a_choice(&self) -> bool {
        self.scene.is_empty() && self.plan.is_empty() && self.larger.is_none() && !self.is_empty()
    }

    /// Returns how much the fix changes, for choosing the smallest: 1 for each setting, 2 for each edit of the plan, 3
    /// for each of the scene, 10 for another technique, 20 for a larger picture.
    pub fn weight(&self) -> usize {
        let [technique, larger] = [self.technique.is_some(), self.larger.is_some()].map(usize::from);
        self.settings.len() + 2 * self.plan.len() + 3 * self.scene.len() + 10 * technique + 20 * larger
    }

    /// Returns the fix in words: `use z-fail`, `set casters = all`.
    pub fn describe(&self) -> String {
        let mut words = Vec::new();
        words.extend(self.technique.map(|technique| format!("use {}", technique.name())));
        words.extend(self.settings.iter().map(|(key, value)| format!("set {key} = {value}")));
        words.extend(self.scene.iter().map(|SceneEdit { name, change, .. }| match change {
            ObjectChange::Weld => format!("weld the vertices of {name}"),
            ObjectChange::Receives => format!("let {name} receive shadows (receives = true)"),
            ObjectChange::Casts => format!("let {name} cast a shadow (casts = true)"),
            ObjectChange::Visible => format!("draw {name} (visible = true)"),
        }));
        words.extend(self.plan.iter().map(|edit| {
            match edit {
                PlanEdit::DrawLightCaps => "draw the light caps",
                PlanEdit::DrawDarkCaps => "draw the dark caps",
                PlanEdit::SurfaceOrder => "draw light caps in the surface's vertex order",
                PlanEdit::Refit => "fit the light's view to the scene again",
            }
            .to_owned()
        }));
        words.extend(self.larger.map(|times| format!("draw the picture {times} times as large")));
        if words.is_empty() { "nothing fixes it".to_owned() } else { words.join(", ") }
    }
}

/// Appends to each pass the draws of a part that the pass of `fresh` at the same place has and it lacks (by name and
/// part). `None` adds nothing.
fn draw_missing(plan: &mut FramePlan, fresh: &FramePlan, part: Option<DrawPart>) {
    for (pass, fresh) in plan.passes.iter_mut().zip(&fresh.passes) {
        let missing = fresh.draws.iter().filter(|draw| Some(draw.part) == part);
        for draw in missing {
            if !pass.draws.iter().any(|other| (&other.name, other.part) == (&draw.name, draw.part)) {
                pass.draws.push(draw.clone());
            }
        }
    }
}

/// Replaces each light cap and dark cap draw, and its mesh, by that of the same name and part in `fresh`, whose
/// vertices are in the surface's order. Draws that `fresh` lacks stay.
fn draw_caps_in_order(plan: &mut FramePlan, fresh: &FramePlan) {
    for (pass, fresh_pass) in plan.passes.iter_mut().zip(&fresh.passes) {
        for draw in pass.draws.iter_mut().filter(|draw| matches!(draw.part, DrawPart::LightCap | DrawPart::DarkCap)) {
            let same = fresh_pass.draws.iter().find(|other| (&other.name, other.part) == (&draw.name, draw.part));
            let Some(same) = same else { continue };
            *draw = same.clone();
            let meshes = plan.meshes.get_mut(draw.mesh.0).zip(fresh.meshes.get(draw.mesh.0));
            if let Some((mesh, fresh_mesh)) = meshes {
                mesh.clone_from(fresh_mesh);
            }
        }
    }
}

impl fmt::Display for Fix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.describe())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Object, SceneBuilder, shapes};

    #[test]
    fn two_fixes_are_one_that_says_both() {
        let both = Fix::setting("casters", "all").and(&Fix::setting("operations", "wrap"));
        assert_eq!(both.describe(), "set casters = all, set operations = wrap");
        assert_eq!(both.and(&both), both);
        assert!(Fix::default().is_empty() && !both.is_empty());
        assert!(both.weight() < Fix::technique(Technique::ZFail).weight());
    }

    #[test]
    fn a_fix_that_can_not_be_applied_changes_nothing() {
        let quad = shapes::quad([1.0; 2]).expect("a quad");
        let floor = Object { casts: false, receives: false, ..Object::of("floor", quad) };
        let before = SceneBuilder::new("a floor").objects(vec![floor]).build();
        let casts = Fix::scene(0, "floor", ObjectChange::Casts);
        let wrong = [
            casts.and(&Fix::scene(7, "ball", ObjectChange::Receives)),
            casts.and(&Fix::setting("casters", "all")).and(&Fix::setting("caps", "every one")),
            casts.and(&Fix::technique(Technique::ShadowMap)).and(&Fix::setting("casters", "all")),
        ];
        for fix in wrong {
            let (mut scene, mut choice) = (before.clone(), Choice::new(Technique::ZFail));
            choice.set("casters", "light-facing").expect("a setting");
            let choice_before = choice.clone();
            assert!(fix.apply(&mut scene, &mut choice).is_err(), "{fix}");
            assert!(!scene.objects[0].casts && choice == choice_before, "{fix}");
        }
        let (mut scene, mut choice) = (before, Choice::new(Technique::ZFail));
        casts.apply(&mut scene, &mut choice).expect("a fix");
        assert!(scene.objects[0].casts);
    }
}

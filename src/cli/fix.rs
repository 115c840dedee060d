//! `diagnose --fix`: the scene as a scene file, mended; then opened again and held against the truth.

use super::diagnose::mend_for;
use super::{CliError, output};
use crate::diagnosis::{Diagnosis, Mend, Suited};
use crate::numbers;
use crate::progress::Progress;
use crate::scene::file::{SavedScene, save};
use crate::scene::{OpenSpec, Scene, TechniqueRequest, open};
use crate::session::{CaptureRequest, Session};
use crate::technique::Choice;
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// Where a mended scene goes.
pub struct Fix<'a> {
    file: &'a str,
    /// The name by which the scene was opened.
    source: &'a str,
}

impl<'a> Fix<'a> {
    /// Checks, before long work, that the file may be written.
    ///
    /// # Errors
    /// It is no scene file, it is the scene itself, it is there already, or there is no such folder.
    pub fn new(file: &'a str, source: &'a str, overwrite: bool) -> Result<Fix<'a>, CliError> {
        let usage = |what: &str| Err(CliError::Usage(format!("`{}` {what}", file.escape_debug())));
        let path = Path::new(file);
        let is_scene_file = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
        let is_source = path.canonicalize().ok().zip(Path::new(source).canonicalize().ok());
        if !is_scene_file {
            usage("can't be a scene file: give `--fix` a name that ends in .toml")
        } else if is_source.is_some_and(|(file, source)| file == source) {
            usage("is the scene itself: give `--fix` another name")
        } else if path.exists() && !overwrite {
            usage("is there already: replace it with --overwrite or choose another name")
        } else {
            output::check_target(file)?;
            Ok(Fix { file, source })
        }
    }

    /// Writes `loaded`, mended, with its motions; opens it again and says how many pixels are wrong then.
    ///
    /// # Errors
    /// A file that can't be written or opened again; a lost GPU.
    pub fn write(
        &self,
        session: &mut Session,
        loaded: &Scene,
        time: f64,
        request: &CaptureRequest,
        diagnosis: &Diagnosis,
        suited: &[Suited],
    ) -> Result<String, CliError> {
        if !diagnosis.is_bad() {
            return Ok(format!("{}: not written, as nothing is wrong\n", self.file));
        }
        let Some(mend) = mend_for(diagnosis, suited) else {
            return Ok(format!("{}: not written, as nothing that was tried helps\n", self.file));
        };
        let scene = mended(loaded, request.choice.clone(), &mend)?;
        self.write_files(&self.saved(&scene)?)?;
        let again = open(&OpenSpec { name: self.file.to_owned(), floor: false })?.at(time);
        let choice = again.technique.as_ref().map(Choice::parse).transpose()?;
        let request = CaptureRequest { choice: choice.unwrap_or_else(|| request.choice.clone()), ..request.clone() };
        let mut capture = session.capture(&again, &request)?;
        session.judge(&again, &mut capture, &Progress::default())?;
        let error = capture.error().unwrap_or_default();
        Ok(format!(
            "{}: written so that it says: {mend}; opened again, {} of {} compared pixels are wrong\n",
            self.file,
            numbers::count(error.wrong()),
            numbers::count(error.compared),
        ))
    }

    fn saved(&self, scene: &Scene) -> Result<SavedScene, CliError> {
        let path = Path::new(self.file);
        let mut known = BTreeMap::new();
        let is_model = Path::new(self.source).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("obj"));
        // The model comes first, the floor after it. A mesh that was mended is another, and not named.
        if let Some(object) = scene.objects.first().filter(|_| is_model)
            && let Ok(original) = crate::scene::obj::load(Path::new(self.source))
            && original.content_hash() == object.mesh.content_hash()
        {
            known.insert(original.content_hash(), from_beside(path, Path::new(self.source)));
        }
        let stem = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        Ok(save(scene, &stem, &known)?)
    }

    /// The models first, so that the scene file is never there without them; what was not there before goes again
    /// where something fails.
    fn write_files(&self, saved: &SavedScene) -> Result<(), CliError> {
        let beside = |name: &str| Path::new(self.file).with_file_name(name).to_string_lossy().into_owned();
        let mut models: Vec<(String, &String)> = saved.files.iter().map(|(name, text)| (beside(name), text)).collect();
        // A model that holds the same already stays; another may be somebody's work, or what the scene is made of.
        let is_there =
            |(file, text): &(String, &String)| std::fs::read(file).is_ok_and(|bytes| bytes == text.as_bytes());
        models.retain(|model| !is_there(model));
        if let Some((taken, _)) = models.iter().find(|(file, _)| Path::new(file).exists()) {
            return Err(CliError::Usage(format!(
                "`{}` is another model, and stays as it is: choose another name for `--fix`",
                taken.escape_debug()
            )));
        }
        let all = models.iter().map(|(file, text)| (file.as_str(), *text)).chain([(self.file, &saved.toml)]);
        let mut written: Vec<&str> = Vec::new();
        for (file, text) in all {
            let is_new = !Path::new(file).exists();
            if let Err(error) = output::write(file, text.as_bytes()) {
                // What failed is the error already.
                written.iter().for_each(|file| drop(std::fs::remove_file(file)));
                return Err(error);
            }
            written.extend(is_new.then_some(file));
        }
        Ok(())
    }
}

/// The scene with the mend made, and the technique that it asks for.
fn mended(loaded: &Scene, mut choice: Choice, mend: &Mend) -> Result<Scene, CliError> {
    let mut scene = loaded.clone();
    mend.apply(&mut scene, &mut choice)?;
    let changed = choice.technique().settings().iter().filter_map(|spec| {
        let value = choice.settings().get(spec.key)?;
        (value != spec.default).then(|| (spec.key.to_owned(), value.clone()))
    });
    scene.technique =
        Some(TechniqueRequest { name: choice.technique().name().to_owned(), settings: changed.collect() });
    Ok(scene)
}

/// The path of a model as a scene file beside `file` names it.
fn from_beside(file: &Path, model: &Path) -> String {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let both = folder.canonicalize().ok().zip(model.canonicalize().ok());
    let way = both.and_then(|(folder, model)| relative(&folder, &model));
    way.unwrap_or_else(|| model.to_owned()).to_string_lossy().into_owned()
}

/// The way from a folder to a file, both from the root; `None` where there is none, as between two drives.
fn relative(folder: &Path, file: &Path) -> Option<PathBuf> {
    let (folder, file): (Vec<Component>, Vec<Component>) = (folder.components().collect(), file.components().collect());
    let common = folder.iter().zip(&file).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return None;
    }
    let up = folder[common..].iter().map(|_| Component::ParentDir);
    Some(up.chain(file[common..].iter().copied()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_goes_up_and_down() {
        let way = |folder: &str, file: &str| relative(Path::new(folder), Path::new(file));
        assert_eq!(way("/a/b", "/a/b/m.obj"), Some("m.obj".into()));
        assert_eq!(way("/a/b/c", "/a/d/m.obj"), Some("../../d/m.obj".into()));
        assert_eq!(way("a", "b/m.obj"), None);
    }
}

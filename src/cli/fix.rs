//! `diagnose --fix`: writes the scene with the fix as a scene file; then opens it again and compares it with the truth.

use super::{CliError, output};
use crate::diagnosis::{Diagnosis, Fix, TechniqueFit};
use crate::numbers;
use crate::progress::Progress;
use crate::scene::file::store;
use crate::scene::{OpenSpec, Scene, open};
use crate::session::{CaptureRequest, Session};
use crate::technique::Choice;
use std::path::Path;

/// A checked target for `--fix`: the scene file to write, and the name by which the scene was opened.
pub struct FixOutput<'a> {
    file: &'a str,
    /// The name by which the scene was opened.
    source: &'a str,
}

impl<'a> FixOutput<'a> {
    /// Returns the target after checking, before long work, that `file` ends in .toml, is not the source itself, does
    /// not exist or may be overwritten, and lies in an existing folder.
    pub fn new(file: &'a str, source: &'a str, overwrite: bool) -> Result<FixOutput<'a>, CliError> {
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
            Ok(FixOutput { file, source })
        }
    }

    /// Writes the scene with the best fix, keeping its motions, opens and renders the file again, and returns a line on
    /// how many pixels are wrong then. Where nothing is wrong, or nothing helps, writes nothing and says so.
    pub fn write(
        &self,
        session: &mut Session,
        loaded: &Scene,
        time: f64,
        request: &CaptureRequest,
        diagnosis: &Diagnosis,
        suited: &[TechniqueFit],
    ) -> Result<String, CliError> {
        if !diagnosis.is_bad() {
            return Ok(format!("{}: not written, as nothing is wrong\n", self.file));
        }
        let Some(fix) = diagnosis.fix_to_write(suited) else {
            return Ok(format!("{}: not written, as nothing that was tried helps\n", self.file));
        };
        let scene = fixed(loaded, request.choice.clone(), &fix)?;
        store(&scene, Some(Path::new(self.source)), Path::new(self.file))?;
        let again = open(&OpenSpec { floor: false, ..OpenSpec::new(self.file) })?.at(time);
        let choice = again.technique.as_ref().map(Choice::parse).transpose()?;
        let request = CaptureRequest { choice: choice.unwrap_or_else(|| request.choice.clone()), ..request.clone() };
        let capture = session.capture(&again, &request)?;
        let error = session.judged(&again, &capture, &Progress::default())?.error().unwrap_or_default();
        Ok(format!(
            "{}: written so that it says: {fix}; opened again, {} of {} compared pixels are wrong\n",
            self.file,
            numbers::count(error.wrong()),
            numbers::count(error.compared),
        ))
    }
}

/// Returns a copy of the scene with the fix applied. Its technique is then `choice` with the fix's changes, every
/// setting that differs from the scene's included.
fn fixed(loaded: &Scene, mut choice: Choice, fix: &Fix) -> Result<Scene, CliError> {
    let mut scene = loaded.clone();
    fix.apply(&mut scene, &mut choice)?;
    scene.technique = Some(choice.to_request());
    Ok(scene)
}

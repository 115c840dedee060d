//! Results of one run in several formats: each to a file, one of them to standard output in place of the table.

use super::{CliError, output};
use crate::files::from_beside;
use std::path::Path;

/// Where a format is written: `None` where it is not asked for, standard output where no file is named.
pub type ResultTarget = Option<Option<String>>;

/// Returns the target of a format that is written only to files.
pub fn target(file: &Option<String>) -> ResultTarget {
    file.clone().map(Some)
}

/// Returns the plot's path relative to the page's folder; `None` unless both are named. Opens neither file.
pub fn plot_beside(page: &Option<String>, plot: &Option<String>) -> Option<String> {
    let (page, plot) = page.as_ref().zip(plot.as_ref())?;
    Some(from_beside(Path::new(page), Path::new(plot)))
}

/// Returns the files that are named, those of formats first.
pub fn files<'a>(forms: &[&'a ResultTarget], plot: &'a Option<String>) -> Vec<&'a str> {
    let of_forms = forms.iter().filter_map(|target| target.as_ref()?.as_deref());
    of_forms.chain(plot.as_deref()).collect()
}

/// Fails, before long work, where a named file can't be made, one file is named twice, or more than one format goes to
/// standard output.
pub fn check(forms: &[&ResultTarget], plot: &Option<String>) -> Result<(), CliError> {
    let files = files(forms, plot);
    files.iter().try_for_each(|file| output::check_target(file))?;
    let is_twice = |(index, file): &(usize, &&str)| files[..*index].contains(*file);
    if let Some((_, file)) = files.iter().enumerate().find(is_twice) {
        let line = format!("`{}` is named for two results: choose another file for one", file.escape_debug());
        return Err(CliError::Usage(line));
    }
    if forms.iter().filter(|target| matches!(target, Some(None))).count() > 1 {
        let line =
            "two results can't both go to standard output: give one a file, as `--json=FILE` or `--markdown=FILE`";
        return Err(CliError::Usage(line.to_owned()));
    }
    Ok(())
}

/// The target of a format, and the function that returns its text.
pub type ResultFormat<'a> = (&'a ResultTarget, &'a dyn Fn() -> Result<String, CliError>);

/// Writes each format that is asked for, files before standard output; prints `table` instead only where no format is
/// asked for.
pub fn deliver(forms: &[ResultFormat], table: impl FnOnce() -> String) -> Result<(), CliError> {
    if forms.iter().all(|(target, _)| target.is_none()) {
        return output::print(&table());
    }
    let mut asked: Vec<_> = forms.iter().filter_map(|(target, text)| Some((target.as_ref()?, text))).collect();
    // Files come first: the reader of standard output may close it, and no file is missing then.
    asked.sort_by_key(|(file, _)| file.is_none());
    asked.into_iter().try_for_each(|(file, text)| output::deliver(&text()?, file.as_deref()))
}

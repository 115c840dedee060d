//! `stencilscope report`: how wrong each technique is, and what it costs.

use super::options::{SceneOptions, picture_size, setting, technique_named};
use super::progress::with_bar;
use super::results::{self, Form};
use super::{CliError, output};
use crate::progress::Progress;
use crate::report::{PageOrigin, Report, Row};
use crate::scene::Scene;
use crate::scene::builtin::Builtin;
use crate::session::{Measurement, Session, report_rows};
use crate::technique::{Choice, Technique};
use clap::Args;
use std::path::Path;

#[derive(Debug, Args)]
pub struct ReportArguments {
    /// Built-in scenes, scene files (.toml) or models (.obj)
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<String>,
    #[command(flatten)]
    scene_options: SceneOptions,
    /// Only these techniques; repeatable
    #[arg(short, long, value_name = "NAME")]
    technique: Vec<String>,
    /// A setting, for every technique that has it; repeatable
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    set: Vec<(String, String)>,
    /// Width and height of the picture
    #[arg(long, value_name = "WxH", value_parser = picture_size, default_value = "1280x720")]
    size: [u32; 2],
    /// Timed frames of each row
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000), default_value = "9")]
    runs: u16,
    /// A part of the GPU's name; `llvmpipe` is the software one [default: the best]
    #[arg(long, value_name = "SUBSTRING")]
    adapter: Option<String>,
    /// Machine-readable, to a file or to standard output in place of the table
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    json: Option<Option<String>>,
    /// Comma-separated, to a file or to standard output in place of the table
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    csv: Option<Option<String>>,
    /// A Markdown table, to a file or to standard output in place of the table
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    markdown: Option<Option<String>>,
    /// A picture of error against run time (.svg or .png)
    #[arg(long, value_name = "FILE", value_parser = plot_file)]
    plot: Option<String>,
    /// A page in Markdown: this command, the machine, the plot, the tables, and how to read them
    #[arg(short, long, value_name = "FILE.md", value_parser = page_file)]
    output: Option<String>,
}

/// Measures and prints; `command` is the command line, for the page.
///
/// # Errors
/// A scene, technique or setting that can't be used; no GPU; a file that can't be written.
pub fn run(arguments: &ReportArguments, command: &str) -> Result<(), CliError> {
    let choices = choices(arguments)?;
    let open = |name: &String| arguments.scene_options.open(name);
    let scenes = arguments.scenes.iter().map(open).collect::<Result<Vec<Scene>, _>>()?;
    let page = results::target(&arguments.output);
    let forms = [&arguments.json, &arguments.csv, &arguments.markdown, &page];
    check_no_scene(&results::files(&forms, &arguments.plot), &arguments.scenes)?;
    results::check(&forms, &arguments.plot)?;
    let mut session = Session::new(arguments.adapter.as_deref())?;
    let what = Measurement { choices, size: arguments.size, runs: usize::from(arguments.runs) };
    let mut rows: Vec<Row> = Vec::new();
    for (scene, name) in scenes.iter().zip(distinct_names(&scenes)) {
        let measured = with_bar(&name, &Progress::default(), |progress| session.measure(scene, &what, progress))?;
        rows.extend(report_rows(&name, what.size, &measured));
    }
    deliver(arguments, command, &Report::new(session.adapter().clone(), rows))
}

fn deliver(arguments: &ReportArguments, command: &str, report: &Report) -> Result<(), CliError> {
    if let Some(file) = &arguments.plot {
        let bytes = if is_png(file) { report.to_png()? } else { report.to_svg().into_bytes() };
        output::write(file, &bytes)?;
    }
    let page = results::target(&arguments.output);
    let plot = results::plot_beside(&arguments.output, &arguments.plot);
    let origin = PageOrigin { command, plot: plot.as_deref() };
    let forms: [Form; 4] = [
        (&arguments.json, &|| Ok(report.to_json()?)),
        (&arguments.csv, &|| Ok(report.to_csv())),
        (&arguments.markdown, &|| Ok(report.to_markdown())),
        (&page, &|| Ok(report.to_page(origin))),
    ];
    results::deliver(&forms, || report.to_table())
}

/// The default grid, or its rows of the techniques asked for, with settings changed.
fn choices(arguments: &ReportArguments) -> Result<Vec<Choice>, CliError> {
    let only = arguments.technique.iter().map(|name| technique_named(name)).collect::<Result<Vec<Technique>, _>>()?;
    let mut grid = Choice::report_grid()?;
    grid.retain(|choice| only.is_empty() || only.contains(&choice.technique()));
    for (key, value) in &arguments.set {
        let has_key = |choice: &&mut Choice| choice.settings().contains_key(key);
        let (with_key, without) = grid.iter_mut().partition::<Vec<_>, _>(has_key);
        let known = !with_key.is_empty();
        with_key.into_iter().try_for_each(|choice| choice.set(key, value))?;
        // No technique has it: the first one's error names the nearest key.
        without.into_iter().take(usize::from(!known)).try_for_each(|choice| choice.set(key, value))?;
    }
    let mut choices: Vec<Choice> = Vec::new();
    for choice in grid {
        if !choices.contains(&choice) {
            choices.push(choice);
        }
    }
    Ok(choices)
}

/// Names of scenes, numbered where two are alike: rows of different scenes are never compared.
fn distinct_names(scenes: &[Scene]) -> Vec<String> {
    let name = |(index, scene): (usize, &Scene)| {
        let earlier = scenes[..index].iter().filter(|other| other.name == scene.name).count();
        if earlier == 0 { scene.name.clone() } else { format!("{} ({})", scene.name, earlier + 1) }
    };
    scenes.iter().enumerate().map(name).collect()
}

/// No result may replace a scene: an option takes the word after it for its file.
fn check_no_scene(files: &[&str], scenes: &[String]) -> Result<(), CliError> {
    let is_scene = |file: &&&str| {
        let ending = Path::new(file).extension().map(|ending| ending.to_ascii_lowercase());
        let is_input = ending.is_some_and(|ending| ending == "obj" || ending == "toml");
        is_input || Builtin::named(file).is_some() || scenes.iter().any(|scene| scene == **file)
    };
    files.iter().find(is_scene).map_or(Ok(()), |file| {
        let what = "names a scene: put the option last, or give its file as `--json=FILE`";
        Err(CliError::Usage(format!("`{}` {what}", file.escape_debug())))
    })
}

/// Does a file's ending ask for pixels?
pub fn is_png(file: &str) -> bool {
    Path::new(file).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"))
}

/// A file whose ending says what to write.
pub fn plot_file(text: &str) -> Result<String, String> {
    let is_svg = Path::new(text).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("svg"));
    if is_svg || is_png(text) { Ok(text.to_owned()) } else { Err("give a file that ends in .svg or .png".to_owned()) }
}

/// A page's file.
pub fn page_file(text: &str) -> Result<String, String> {
    let is_page = Path::new(text).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("md"));
    if is_page { Ok(text.to_owned()) } else { Err("give a file that ends in .md".to_owned()) }
}

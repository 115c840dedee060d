//! Where a report is written, and in which formats.

use super::results::{self, ResultFormat, ResultTarget};
use super::{CliError, output};
use crate::report::{PageOrigin, Report};
use clap::Args;
use std::io::IsTerminal;
use std::path::Path;

/// Where a report is written, and in which formats.
#[derive(Debug, Args)]
pub struct ReportResults {
    /// Machine-readable, to a file or to standard output in place of the table
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    pub json: Option<Option<String>>,
    /// Comma-separated, to a file or to standard output in place of the table
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    pub csv: Option<Option<String>>,
    /// A Markdown table, to a file or to standard output in place of the table
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    pub markdown: Option<Option<String>>,
    /// A picture of error against run time (.svg or .png)
    #[arg(long, value_name = "FILE", value_parser = plot_file)]
    pub plot: Option<String>,
    /// A page in Markdown: this command, the machine, the plot, the tables, and how to read them
    #[arg(short, long, value_name = "FILE.md", value_parser = page_file)]
    pub output: Option<String>,
}

impl ReportResults {
    /// Returns the targets of JSON, CSV, Markdown and the page, in this order; the plot is not among them.
    pub fn targets(&self) -> [ResultTarget; 4] {
        [self.json.clone(), self.csv.clone(), self.markdown.clone(), results::target(&self.output)]
    }

    /// Fails, before long work, where a file can't be made, one file is named for two results, or two results would go
    /// to standard output.
    pub fn check(&self) -> Result<(), CliError> {
        results::check(&self.targets().each_ref(), &self.plot)
    }

    /// Writes the plot and each format that is asked for; prints the table where no format is, even if a plot was
    /// written. `command` is the command line to print in the page.
    pub fn deliver(&self, command: &str, report: &Report) -> Result<(), CliError> {
        if let Some(file) = &self.plot {
            let bytes = if is_png(file) { report.to_png()? } else { report.to_svg().into_bytes() };
            output::write(file, &bytes)?;
        }
        let [json, csv, markdown, page] = self.targets();
        let plot = results::plot_beside(&self.output, &self.plot);
        let origin = PageOrigin { command, plot: plot.as_deref() };
        let forms: [ResultFormat; 4] = [
            (&json, &|| Ok(report.to_json()?)),
            (&csv, &|| Ok(report.to_csv())),
            (&markdown, &|| Ok(report.to_markdown())),
            (&page, &|| Ok(report.to_page(origin))),
        ];
        results::deliver(&forms, || match std::io::stdout().is_terminal() {
            true => report.to_narrow_table(),
            false => report.to_table(),
        })
    }
}

/// Returns whether a file's extension is that of a PNG picture.
pub fn is_png(file: &str) -> bool {
    Path::new(file).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"))
}

/// Parses the path of a plot's file, whose extension must be that of a format that plots can have.
pub fn plot_file(text: &str) -> Result<String, String> {
    let is_svg = Path::new(text).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("svg"));
    if is_svg || is_png(text) { Ok(text.to_owned()) } else { Err("give a file that ends in .svg or .png".to_owned()) }
}

/// Parses the path of a page, which must end in `.md` (in any case).
pub fn page_file(text: &str) -> Result<String, String> {
    let is_page = Path::new(text).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("md"));
    if is_page { Ok(text.to_owned()) } else { Err("give a file that ends in .md".to_owned()) }
}

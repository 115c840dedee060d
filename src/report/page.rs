//! A report as a page in Markdown that stands alone: the command that writes it, the machine, the plot, a table a
//! scene, and how to read them.

use super::{Report, table};

/// The command that wrote a Markdown page, and the plot that the page shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PageOrigin<'a> {
    /// The command line that writes the page again.
    pub command: &'a str,
    /// Path of the plot's file as the page links to it; `None` without a plot.
    pub plot: Option<&'a str>,
}

impl PageOrigin<'_> {
    /// Returns the page's beginning in Markdown: title, command, and the plot with the description `of_plot`, if one is
    /// named.
    pub(crate) fn opening(&self, title: &str, of_plot: &str) -> String {
        let plot = self.plot.map_or_else(String::new, |file| format!("![{of_plot}]({file})\n\n"));
        format!("# {title}\n\nWritten by\n\n```sh\n{}\n```\n\n{plot}", self.command)
    }
}

/// The section that explains how rows are measured and read.
const READING: &str = "Every row is a scene rendered by one technique. Each pixel is held against rays that are followed through \
the scene in double precision, and counts as wrong where the technique says something else of a light, unless the truth itself \
changes within an eighth of a pixel, or another triangle is visible within the step that the rasteriser snaps corners to (1/256 on most). *Wrong \
colour* counts the pixels, background included, that look unlike the picture that those rays light in the same shading: shadows \
in the air, blended twice, soft or tinted by translucent casters have right labels and wrong colours. *Frame* is \
the median wall time of a frame; frames of all rows are timed in turn, each after one that does not count. *Set-up* is planning, \
geometry, pipelines and uploads. *MiB* is the memory of buffers and attachments. Bold: nothing else of the scene is both at \
least as fast and at least as right (Pareto front).";

impl Report {
    /// Returns the report as a Markdown page: command, plot, machine, how to read it, and a table for each scene.
    pub fn to_page(&self, origin: PageOrigin) -> String {
        let adapter = &self.adapter;
        let of_plot = match self.is_swept() {
            true => "Frame time against what a sweep changes, one chart a scene",
            false => "Wrong pixels against frame time, one chart a scene",
        };
        let opening = origin.opening("How right, at what cost", of_plot);
        let sizes = table::sizes(self.rows.iter().map(|row| row.size));
        let runs = self.rows.iter().map(|row| row.frame_ms.runs).max().unwrap_or(0);
        let scenes = self.scenes();
        let tables = scenes.iter().map(|scene| format!("## {scene}\n\n{}", table::markdown_of(self, scene)));
        format!(
            "{opening}on {}; pictures of {sizes}, {runs} timed frames a row. Only the ratios of times mean \
             anything elsewhere.\n\n{READING}\n\n{}",
            adapter.in_words(),
            tables.collect::<Vec<_>>().join("\n")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{adapter, row};
    use super::*;

    #[test]
    fn a_page_names_its_command_its_machine_its_plot_and_every_scene() {
        let report = Report::new(adapter(), vec![row("tori", "z-fail", "", 0, 6.25), row("table", "none", "", 3, 2.0)]);
        let page = report.to_page(PageOrigin { command: "stencilscope report tori table", plot: Some("a/b.svg") });
        let expected = "# How right, at what cost\n\nWritten by\n\n```sh\nstencilscope report tori table\n```\n\n\
                        ![Wrong pixels against frame time, one chart a scene](a/b.svg)\n\non hand, 1 (cpu); pictures of 100×10";
        assert!(page.starts_with(expected), "{page}");
        assert_eq!(page.matches("| technique | settings |").count(), 2);
        assert!(page.contains("## tori\n\n| technique") && page.contains("## table\n\n| technique"), "{page}");
        let alone = report.to_page(PageOrigin { command: "x", plot: None });
        assert!(!alone.contains("!["), "{alone}");
    }
}

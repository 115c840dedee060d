//! `stencilscope report merge`: merges the parts of a run.

use super::report_results::ReportResults;
use super::{CliError, stress};
use crate::report::Report;
use crate::shards::MergeError;
use crate::stress::StressResults;
use clap::Args;

/// Text after the help of `report merge`: how the parts of a run are made on several cores or machines.
pub const EXAMPLES: &str = "\
Parts of a run side by side, here four; a part that was killed is run again alone:

  GNU parallel   parallel stencilscope stress --shard {}/4 --json part-{}.json ::: 1 2 3 4
  Slurm array    #SBATCH --array=1-4
                 stencilscope stress --shard $SLURM_ARRAY_TASK_ID/4 --json part-$SLURM_ARRAY_TASK_ID.json
  CI matrix      strategy: { matrix: { part: [1, 2, 3, 4] } }
                 stencilscope stress --shard ${{ matrix.part }}/4 --json part-${{ matrix.part }}.json

  then           stencilscope report merge part-*.json -o stress.md
";

/// The largest size of a file of results, bytes; larger files are refused.
const LARGEST_FILE: u64 = 256 << 20;

#[derive(Debug, Args)]
pub struct MergeArguments {
    /// What `report --shard K/N --json FILE` or `stress --shard K/N --json FILE` has written, of every K
    #[arg(required = true, value_name = "FILE")]
    files: Vec<String>,
    #[command(flatten)]
    results: ReportResults,
}

/// Merges and prints; `command` is the command line, for the page.
///
/// # Errors
/// A file that can't be read; parts that are missing or not of one run; a file that can't be written;
/// [`CliError::Unexpected`] where a technique did not do as expected in a stress case.
pub fn run(arguments: &MergeArguments, command: &str) -> Result<(), CliError> {
    arguments.results.check()?;
    let texts = arguments.files.iter().map(|file| Ok((file.clone(), read(file)?)));
    let texts: Vec<(String, String)> = texts.collect::<Result<_, CliError>>()?;
    let refused = |error: MergeError| CliError::Usage(error.to_string());
    if is_stress(&texts) {
        let parts = parts(texts, |text| StressResults::from_json(text).map_err(|error| error.to_string()))?;
        deliver_stress(&StressResults::merged(parts).map_err(refused)?, command, &arguments.results)
    } else {
        let parts = parts(texts, |text| Report::from_json(text).map_err(|error| error.to_string()))?;
        arguments.results.deliver(command, &Report::merged(parts).map_err(refused)?)
    }
}

/// Prints or writes merged stress results in the formats asked for, with the plot. Fails where CSV is asked for, and at
/// the end where a result is unexpected.
fn deliver_stress(merged: &StressResults, command: &str, results: &ReportResults) -> Result<(), CliError> {
    let [json, csv, markdown, page] = results.targets();
    if csv.is_some() {
        return Err(CliError::Usage("results of `stress` have no CSV: choose `--json`".to_owned()));
    }
    stress::deliver(merged, command, [&json, &markdown, &page], &results.output, &results.plot)
}

fn read(file: &str) -> Result<String, CliError> {
    let unread = |why: String| CliError::Usage(format!("{}: {why}", file.escape_debug()));
    let bytes =
        crate::files::read_plain(std::path::Path::new(file), LARGEST_FILE).map_err(|why| unread(why.to_string()))?;
    String::from_utf8(bytes).map_err(|_| unread("it is no text: give the JSON of a part".to_owned()))
}

/// Returns whether any of the files' texts is of stress results and not of a report.
fn is_stress(texts: &[(String, String)]) -> bool {
    let is =
        |text: &str| serde_json::from_str(text).is_ok_and(|value: serde_json::Value| value.get("summary").is_some());
    texts.iter().any(|(_, text)| is(text))
}

fn parts<T>(
    texts: Vec<(String, String)>,
    read: impl Fn(&str) -> Result<T, String>,
) -> Result<Vec<(String, T)>, CliError> {
    let part = |(file, text): (String, String)| {
        let part = read(&text).map_err(|why| CliError::Usage(format!("{}: {why}", file.escape_debug())))?;
        Ok((file, part))
    };
    texts.into_iter().map(part).collect()
}

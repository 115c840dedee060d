//! `stencilscope import`: a frame out of a RenderDoc capture.

use super::options::open_session;
use super::{CliError, output, progress};
use crate::capture::disk::{self, FolderContents};
use crate::capture::{Capture, DrawSummary, RecomputeDifference};
use crate::import::{self, ConvertedFrame, ImportError, RawFrame, RenderDocOptions};
use crate::plan::{FramePlan, LightId};
use crate::progress::Progress;
use crate::recorded::{FoundLight, LightEvidence};
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(after_help = "What a capture holds:    stencilscope import frame.rdc --list\n\
    As a capture folder:     stencilscope import frame.rdc -o DIR\n\n\
    Vulkan, OpenGL core and OpenGL ES. RenderDoc's Python module reads the file (Debian: python3-renderdoc), in a \
    process of its own.")]
pub struct ImportArguments {
    /// A RenderDoc capture
    #[arg(value_name = "FILE.rdc")]
    file: PathBuf,
    #[command(flatten)]
    target: ImportTarget,
    #[command(flatten)]
    reader: ReaderOptions,
}

/// Where the frame is written.
#[derive(Debug, Args)]
pub struct ImportTarget {
    /// The capture folder to write
    #[arg(short, long, value_name = "DIR", required_unless_present = "list")]
    output: Option<PathBuf>,
    /// Replace a capture folder that is there
    #[arg(long, requires = "output")]
    overwrite: bool,
    /// Print the frame's events and states
    #[arg(long)]
    list: bool,
    /// A part of the name of the GPU that computes the draws anew; `llvmpipe` is the software one [default: the best]
    #[arg(long, value_name = "SUBSTRING")]
    adapter: Option<String>,
}

/// How RenderDoc is reached.
#[derive(Debug, Args)]
pub struct ReaderOptions {
    /// The interpreter that has the module `renderdoc` [default: the first python3 or python3.N that has it]
    #[arg(long, value_name = "PYTHON")]
    python: Option<String>,
    /// Gibibytes of memory that RenderDoc may take to replay the frame
    #[arg(long, value_name = "GIB", default_value = "8", value_parser = clap::value_parser!(u64).range(1..=1024))]
    memory: u64,
    /// Seconds that RenderDoc may take to replay the frame
    #[arg(long, value_name = "SECONDS", default_value = "600", value_parser = clap::value_parser!(u64).range(1..))]
    replay_seconds: u64,
}

impl ReaderOptions {
    /// Returns the options for RenderDoc's replay: the interpreter, time in seconds and memory in bytes. Pictures are
    /// read only where the frame is to be stored, not for a list alone.
    pub fn options(&self, target: &ImportTarget) -> RenderDocOptions {
        RenderDocOptions {
            python: self.python.clone(),
            seconds: self.replay_seconds,
            most_memory: self.memory << 30,
            pictures: target.output.is_some(),
        }
    }
}

impl ImportTarget {
    /// Fails, before any work, where the folder can't be written.
    pub fn check(&self) -> Result<(), CliError> {
        Ok(self.output.as_deref().map_or(Ok(()), |folder| disk::check_target(folder, self.overwrite))?)
    }

    /// Prints the list of the frame's events where asked for; where a folder was named, converts the frame, runs it
    /// again on the GPU to compare, writes the folder and prints a summary. `name` becomes the frame's name.
    pub fn deliver(&self, frame: RawFrame, name: &str) -> Result<(), CliError> {
        if self.list {
            output::print(&import::list(&frame))?;
        }
        let Some(folder) = &self.output else { return Ok(()) };
        let ConvertedFrame { plan, capture, scene, lights } = import::convert(&frame, name)?;
        drop(frame);
        let mut session = open_session(self.adapter.as_deref())?;
        let capture = progress::with_bar("check", &Progress::default(), |progress| {
            session.compared_with_rerun(&plan, &capture, progress)
        })?;
        disk::write(
            FolderContents { capture: &capture, plan: Some(&plan), scene: scene.as_ref() },
            folder,
            self.overwrite,
        )?;
        output::print(&summary(&plan, &capture, folder, &lights))
    }
}

/// Returns text about the stored frame: picture size, numbers of passes and draws, how many draws leave the same values
/// when run again here and how the others differ, for each light whether it was found, what histories can't know,
/// limits of the import, and what was left out.
fn summary(plan: &FramePlan, capture: &Capture, folder: &Path, lights: &[Option<FoundLight>]) -> String {
    let [width, height] = capture.size;
    let draws: Vec<&DrawSummary> = capture.steps.iter().flat_map(|step| &step.draws).collect();
    let (passes, count) = (capture.steps.len(), draws.len());
    let mut text =
        format!("{}: {}, {width}x{height}, {passes} passes, {count} draws\n", folder.display(), capture.scene);
    let checked = draws.iter().filter_map(|draw| Some((draw, draw.differs?)));
    let (equal, apart): (Vec<_>, Vec<_>) = checked.partition(|(_, differs)| differs.is_nowhere());
    let exact = equal.iter().filter(|(_, differs)| differs.rounded == 0).count();
    let all = equal.len() + apart.len();
    text += &format!(
        "computed anew: {} of {all} draws{} leave what was stored, {exact} of them to the last bit\n",
        equal.len(),
        if all < count { " and runs of draws" } else { "" }
    );
    for (draw, RecomputeDifference { depth, stencil, .. }) in apart {
        text += &format!("  {}: another depth at {depth} pixels, another stencil at {stencil}\n", draw.name);
    }
    for (index, light) in lights.iter().enumerate() {
        let name = LightId(index).name();
        text += &match light {
            Some(FoundLight { evidence: LightEvidence::Edges { agree, of }, .. }) => {
                format!("{name}: found, {agree} of {of} edges run away from it\n")
            }
            Some(FoundLight {
                evidence: evidence @ LightEvidence::EdgesOfCasters { agree, of, places, .. }, ..
            }) => {
                let casters = evidence.casters_words();
                format!(
                    "{name}: found in {places} places, for the volumes of {casters}: {agree} of {of} of their triangles run away from it\n"
                )
            }
            Some(FoundLight { evidence: LightEvidence::Map { agree, of, residual }, .. }) => {
                let map = capture.lights.get(index).and_then(|light| light.map.as_ref());
                let holds = map.map(|map| map.quantity.words()).filter(|words| !words.is_empty());
                let holds = holds.map_or_else(String::new, |words| format!("; it holds {words}"));
                format!(
                    "{name}: found, {agree} of {of} draws into its shadow map agree with the picture's, to {residual:.1e} texels{holds}\n"
                )
            }
            None => format!("{name}: not found: neither shadow volumes nor a shadow map tell where it is\n"),
        };
    }
    let draws = plan.passes.iter().flat_map(|pass| &pass.draws);
    for draw in draws.filter(|draw| draw.discards_unknown(&plan.meshes[draw.mesh.0])) {
        text += &format!("  {}: its shader may discard fragments, which histories do not know\n", draw.name);
    }
    for limit in capture.origin.iter().flat_map(|origin| &origin.limits) {
        text += &format!("limit: {limit}\n");
    }
    for left in &capture.left_out {
        text += &format!("left out: {left}: {}\n", left.because);
    }
    text
}

/// Runs `work` while a progress bar shows how far RenderDoc is, and returns its result.
pub fn with_bar(work: impl FnOnce(&Progress) -> Result<RawFrame, ImportError>) -> Result<RawFrame, CliError> {
    Ok(progress::with_bar("replay", &Progress::default(), work)?)
}

/// Runs the command `import`: reads a RenderDoc capture and prints or stores its frame.
pub fn run(arguments: &ImportArguments) -> Result<(), CliError> {
    arguments.target.check()?;
    let options = arguments.reader.options(&arguments.target);
    let frame = with_bar(|progress| import::import(&arguments.file, &options, progress))?;
    let name = arguments.file.file_stem().map_or_else(|| "frame".into(), |stem| stem.to_string_lossy());
    arguments.target.deliver(frame, &name)
}

//! `stencilscope report`: how wrong each technique is, and what it costs.

use super::merge::{self, MergeArguments};
use super::options::{SceneOptions, open_session, picture_size, setting, technique_named};
use super::progress::with_bar;
use super::report_results::ReportResults;
use super::{CliError, output, results};
use crate::progress::Progress;
use crate::report::{Report, ReportRow};
use crate::scene::builtin::Builtin;
use crate::scene::{Scene, is_scene_file, suggestion};
use crate::session::{Measurement, MotionFrames, MovingPart, Sweep, SweepBlock, report_rows};
use crate::shards::{Shard, ShardPart};
use crate::technique::{Choice, Technique};
use clap::{Args, Subcommand};
use std::path::Path;

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct ReportArguments {
    #[command(subcommand)]
    merge: Option<MergedFiles>,
    /// Built-in scenes, scene files (.toml) or models (.obj, .ply, .gltf, .glb)
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
    /// What moves in the frames of `--time A..B`: `scene` as it is made to, its first `light` or the `eye` round what the
    /// camera looks at, `everything` of these, or `nothing` after the first
    #[arg(long, value_name = "WHAT", value_parser = moves, default_value = "scene")]
    moves: MovingPart,
    /// Each scene at several values of `size`, `lights`, `casters`, `triangles` or `map-size`: `a,b,c` or `a..b`
    #[arg(long, value_name = "NAME=VALUES")]
    sweep: Option<Sweep>,
    /// The K-th of N disjoint parts of the rows, for `report merge`
    #[arg(long, value_name = "K/N")]
    shard: Option<Shard>,
    /// A part of the GPU's name; `llvmpipe` is the software one [default: the best]
    #[arg(long, value_name = "SUBSTRING")]
    adapter: Option<String>,
    #[command(flatten)]
    results: ReportResults,
}

#[derive(Debug, Subcommand)]
enum MergedFiles {
    /// Put the parts of a run together that `--shard` made, of `report` or of `stress`
    #[command(after_help = merge::EXAMPLES)]
    Merge(MergeArguments),
}

/// Runs the command `report`: measures techniques on scenes and prints or writes the results, or merges the parts of a
/// run. With a shard it measures only its rows. `command` is the command line to print in the page.
pub fn run(arguments: &ReportArguments, command: &str) -> Result<(), CliError> {
    if let Some(MergedFiles::Merge(arguments)) = &arguments.merge {
        return merge::run(arguments, command);
    }
    if arguments.moves != MovingPart::Scene && arguments.motion_frames().is_none() {
        return Err(CliError::Usage("`--moves` is for frames from a moment to another: add `--time A..B`".to_owned()));
    }
    let choices = choices(arguments)?;
    let open = |name: &String| match arguments.motion_frames() {
        Some(_) => arguments.scene_options.load(name),
        None => arguments.scene_options.open(name),
    };
    let scenes = arguments.scenes.iter().map(open).collect::<Result<Vec<Scene>, _>>()?;
    arguments.scenes.iter().zip(&scenes).for_each(|(name, scene)| output::note_left_out(name, scene, None));
    let targets = arguments.results.targets();
    check_no_scene(&results::files(&targets.each_ref(), &arguments.results.plot), &arguments.scenes)?;
    arguments.results.check()?;
    let what = Measurement { choices, size: arguments.size, runs: usize::from(arguments.runs) };
    let blocks = scenes.iter().zip(distinct_names(&scenes)).map(|(scene, name)| blocks(arguments, scene, name, &what));
    let blocks: Vec<(String, SweepBlock)> = blocks.collect::<Result<Vec<_>, _>>()?.concat();
    let mut session = open_session(arguments.adapter.as_deref())?;
    let mut rows: Vec<ReportRow> = Vec::new();
    let mut places = Vec::new();
    let mut place = 0;
    for (name, SweepBlock { scene, what, swept }) in &blocks {
        let mut ours = what.clone();
        ours.choices.retain(|_| {
            let is_ours = arguments.shard.is_none_or(|shard| shard.has(place));
            places.extend(is_ours.then_some(place));
            place += 1;
            is_ours
        });
        if ours.choices.is_empty() {
            continue;
        }
        let bar = swept.as_ref().map_or_else(|| name.clone(), |swept| format!("{name}, {} {}", swept.name, swept.text));
        let motion_frames = arguments.motion_frames();
        let measured = with_bar(&bar, &Progress::default(), |progress| match motion_frames {
            Some(motion_frames) => session.measure_moving(scene, &ours, motion_frames, progress),
            None => session.measure(scene, &ours, progress),
        })?;
        let of_block = report_rows(name, &ours, &measured, &what.choices);
        rows.extend(of_block.into_iter().map(|row| ReportRow { sweep: swept.clone(), ..row }));
    }
    let part = arguments.shard.map(|shard| {
        let moving = arguments.motion_frames().map_or_else(String::new, |MotionFrames { moves, from, to, frames }| {
            format!(", {frames} from {from} to {to} s, {} moves", moves.name())
        });
        let how = format!("stencilscope {} report, {} timed frames{moving}", env!("CARGO_PKG_VERSION"), arguments.runs);
        ShardPart::new(shard, places, how, blocks.iter().flat_map(|(name, block)| names_of(name, block)))
    });
    let report = Report { part, ..Report::new(session.adapter().clone(), rows) };
    arguments.results.deliver(command, &report)
}

impl ReportArguments {
    /// Returns the frames of a motion that are asked for; `None` for scenes that stand still.
    fn motion_frames(&self) -> Option<MotionFrames> {
        self.scene_options.motion_frames(self.moves, usize::from(self.runs))
    }
}

fn moves(name: &str) -> Result<MovingPart, String> {
    let names = MovingPart::ALL.map(MovingPart::name);
    MovingPart::from_name(name).ok_or_else(|| suggestion(name, &names))
}

/// Returns what is measured of a scene, each with `name`: one block, or one for each value of the sweep. Fails where
/// the scene can't be swept.
fn blocks(
    arguments: &ReportArguments,
    scene: &Scene,
    name: String,
    what: &Measurement,
) -> Result<Vec<(String, SweepBlock)>, CliError> {
    let blocks = match &arguments.sweep {
        None => vec![SweepBlock { scene: scene.clone(), what: what.clone(), swept: None }],
        Some(sweep) => sweep.blocks(scene, what).map_err(|why| {
            CliError::Usage(format!("`{}` can't be swept over {}: {why}", name.escape_debug(), sweep.name()))
        })?,
    };
    Ok(blocks.into_iter().map(|block| (name.clone(), block)).collect())
}

/// Returns a name for each row of a block, with scene, technique, settings, size and swept value: the same in all parts
/// of a run, by which they are merged.
fn names_of(name: &str, SweepBlock { what, swept, .. }: &SweepBlock) -> Vec<String> {
    let [width, height] = what.size;
    let swept = swept.as_ref().map_or_else(String::new, |swept| format!(" · {} {}", swept.name, swept.text));
    let named = |choice: &Choice| {
        let settings: Vec<String> = choice.settings().iter().map(|(key, value)| format!("{key}={value}")).collect();
        let technique = choice.technique().name();
        format!("{name} · {technique} {} · {width}×{height}{swept}", settings.join(" "))
    };
    what.choices.iter().map(named).collect()
}

/// Returns the default grid, or its rows for the techniques asked for, with settings changed. In a sweep each technique
/// has one row, but over map sizes every variant with a map has its own.
fn choices(arguments: &ReportArguments) -> Result<Vec<Choice>, CliError> {
    let only = arguments.technique.iter().map(|name| technique_named(name)).collect::<Result<Vec<Technique>, _>>()?;
    let mut grid = match &arguments.sweep {
        None | Some(Sweep::MapSize(_)) => Choice::report_grid()?,
        Some(_) => Technique::ALL.map(Choice::new).to_vec(),
    };
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

/// Returns the scenes' names, in order; a name that came before gets its number in brackets: `box`, `box (2)`. So rows
/// of different scenes are never compared.
fn distinct_names(scenes: &[Scene]) -> Vec<String> {
    let name = |(index, scene): (usize, &Scene)| {
        let earlier = scenes[..index].iter().filter(|other| other.name == scene.name).count();
        if earlier == 0 { scene.name.clone() } else { format!("{} ({})", scene.name, earlier + 1) }
    };
    scenes.iter().enumerate().map(name).collect()
}

/// Fails where a file of results has the name of a scene file, a built-in scene or one of `scenes`: an option such as
/// `--json` takes the word after it as its file.
fn check_no_scene(files: &[&str], scenes: &[String]) -> Result<(), CliError> {
    let is_scene = |file: &&&str| {
        is_scene_file(Path::new(file)) || Builtin::named(file).is_some() || scenes.iter().any(|scene| scene == **file)
    };
    files.iter().find(is_scene).map_or(Ok(()), |file| {
        let what = "names a scene: put the option last, or give its file as `--json=FILE`";
        Err(CliError::Usage(format!("`{}` {what}", file.escape_debug())))
    })
}

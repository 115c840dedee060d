//! `stencilscope bench`: the program's own speed, as ratios.

use super::options::{FrameOptions, SceneOptions, open_session};
use super::{CliError, output};
use crate::progress::Progress;
use crate::scene::{Mesh, MeshBuilder, Scene, SceneError, UpAxis, model_scene};
use crate::scene::{builtin, shapes};
use crate::session::{
    CaptureCost, MeasuredTechnique, Measurement, TruthCost, VolumeCost, median_ms, truth_cost, volume_cost,
};
use crate::technique::{Choice, Technique};
use clap::Args;
use glam::DVec3;
use std::collections::BTreeMap;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Names of the benchmarks that exist.
const BENCHMARKS: [&str; 8] = ["capture", "volumes", "truth", "history", "auto", "moving", "dragged", "panels"];
/// How many frames of each kind are timed.
const RUNS: usize = 15;
/// Techniques enter the comparison with `auto` where a single timed frame takes at most this factor of the fastest
/// one's time.
const MAY_WIN: f64 = 2.0;
/// How many pixels' histories are timed.
const PIXELS: usize = 200;
/// Name of the benchmarks' own model.
const BUMPY: &str = "bumpy sphere";
/// How many lights' volumes are timed; each takes less than a millisecond.
const LIGHTS: usize = 80;

#[derive(Debug, Args)]
pub struct BenchArguments {
    /// What to measure: capture, volumes, truth, history, auto, moving, dragged, panels
    #[arg(value_name = "NAME", default_value = "capture")]
    names: Vec<String>,
    /// A scene in place of the benchmark's own; repeatable; `moving`: `tumbling N` is a random one
    #[arg(long, value_name = "SCENE")]
    scene: Vec<String>,
    /// `auto`: from how many places each scene is seen
    #[arg(long, value_name = "N", default_value_t = 20)]
    cameras: u64,
    /// `moving`: how many random scenes follow the built-in ones
    #[arg(long, value_name = "N", default_value_t = 20)]
    tumbling: u64,
    #[command(flatten)]
    scene_options: SceneOptions,
    #[command(flatten)]
    frame: FrameOptions,
}

/// Runs the command `bench`: the named benchmarks in order, after checking all names. Each prints its own result.
pub fn run(arguments: &BenchArguments) -> Result<(), CliError> {
    arguments.names.iter().try_for_each(|name| check_name(name))?;
    arguments.frame.refuse_draws("a benchmark times whole passes")?;
    arguments.frame.refuse_external_capture("a benchmark runs many frames")?;
    for name in &arguments.names {
        match name.as_str() {
            "truth" => truth(arguments)?,
            "volumes" => volumes(arguments)?,
            "history" => history(arguments)?,
            "auto" => auto(arguments)?,
            "moving" => {
                let load = |name: &String| match super::bench_moving::tumbling_named(name) {
                    Some(scene) => arguments.scene_options.place(scene?),
                    None => arguments.scene_options.load(name),
                };
                let scenes = arguments.scene.iter().map(load).collect::<Result<_, _>>()?;
                super::bench_moving::run(scenes, arguments.tumbling, &arguments.frame)?;
            }
            "dragged" => {
                let scenes = scenes(arguments, || Ok(vec![bumpy_model(1000, 501)?]))?;
                super::bench_dragged::run(&scenes, &arguments.frame)?;
            }
            "panels" => super::bench_panels::run(&arguments.scene, &arguments.scene_options, &arguments.frame)?,
            _ => capture(arguments)?,
        }
    }
    Ok(())
}

/// Runs the benchmark `capture`: times each scene's frame with snapshots and without, and prints both.
fn capture(arguments: &BenchArguments) -> Result<(), CliError> {
    let scenes = scenes(arguments, || Ok(vec![arguments.scene_options.open("tori")?, bumpy_model(62, 31)?]))?;
    let mut session = open_session(arguments.frame.adapter.as_deref())?;
    for scene in &scenes {
        let request = arguments.frame.request(scene)?;
        let cost = session.capture_cost(scene, &request, RUNS)?;
        let title =
            format!("{}, {}, {}x{}", scene.name, request.choice.technique().name(), request.size[0], request.size[1]);
        output::print(&capture_lines(&title, &cost))?;
    }
    Ok(())
}

fn check_name(name: &str) -> Result<(), CliError> {
    if BENCHMARKS.contains(&name) {
        return Ok(());
    }
    let instead = format!("choose {}", BENCHMARKS.join(", "));
    Err(CliError::Usage(format!("no benchmark is called `{}`: {instead}", name.escape_debug())))
}

/// Runs the benchmark `truth`: for each scene prints median times of building the ray hierarchies and of tracing, and
/// rays a second with and without building. The technique does not matter, only the picture's size.
fn truth(arguments: &BenchArguments) -> Result<(), CliError> {
    let size = arguments.frame.picture_size();
    for scene in scenes(arguments, || Ok(vec![bumpy_model(62, 31)?, bumpy_model(264, 133)?]))? {
        // The options are checked, though the truth depends on the size alone.
        arguments.frame.request(&scene)?;
        let TruthCost { sorting, following, rays } = truth_cost(&scene, size, RUNS)?;
        let [sort, follow] = [&sorting, &following].map(|times| median_ms(times).unwrap_or(f64::NAN));
        let triangles: usize = scene.objects.iter().map(|object| object.mesh.triangles().len()).sum();
        output::print(&format!(
            "{}, {triangles} triangles, {}x{}\n  sorting_ms {sort:.1}\n  following_ms {follow:.1}\n  \
             truth_ms {:.1}\n  rays {rays}\n  million rays a second {:.1}, with sorting {:.1}; sorting/following {:.2}\n",
            scene.name,
            size[0],
            size[1],
            sort + follow,
            rays as f64 / follow / 1e3,
            rays as f64 / (sort + follow) / 1e3,
            sort / follow,
        ))?;
    }
    Ok(())
}

/// Runs the benchmark `history`: for each scene times histories of single pixels, and prints them beside the time of
/// the frame and whether all histories agree with the stored results.
fn history(arguments: &BenchArguments) -> Result<(), CliError> {
    for scene in scenes(arguments, || Ok(vec![bumpy_model(62, 31)?, bumpy_model(264, 133)?]))? {
        let request = arguments.frame.request(&scene)?;
        let mut session = open_session(arguments.frame.adapter.as_deref())?;
        let cost = session.history_cost(&scene, &request, PIXELS)?;
        let triangles: usize = scene.objects.iter().map(|object| object.mesh.triangles().len()).sum();
        let frame = median_ms(&cost.frames).unwrap_or(f64::NAN);
        let line = |what: &str, times: &[Duration]| {
            let slowest = times.iter().max().map_or(f64::NAN, |time| time.as_secs_f64() * 1e3);
            format!("  {what}_ms {:.2} (slowest {slowest:.2})\n", median_ms(times).unwrap_or(f64::NAN))
        };
        output::print(&format!(
            "{}, {triangles} triangles, {}, {}x{}: {} pixels, {} events on average, {} at most; all agree: {}\n  \
             frame_ms {frame:.2}\n  first_ms {:.2}\n{}{}{}  history/frame {:.3}\n",
            scene.name,
            request.choice.technique().name(),
            request.size[0],
            request.size[1],
            cost.histories.len(),
            cost.events / cost.histories.len().max(1),
            cost.most_events,
            cost.all_agree,
            cost.first.as_secs_f64() * 1e3,
            line("history", &cost.histories),
            line("geometry", &cost.geometry),
            line("log", &cost.logs),
            median_ms(&cost.histories).unwrap_or(f64::NAN) / frame,
        ))?;
    }
    Ok(())
}

/// Runs the benchmark `auto`: from random camera positions (`--cameras` of them a scene, those that see no surface to
/// compare not counted) prints the ratio of its frame time to the fastest technique without wrong pixels, and to
/// z-fail.
fn auto(arguments: &BenchArguments) -> Result<(), CliError> {
    let built_in = || builtin::ALL.iter().map(|of| Ok(of.scene()?)).collect();
    let mut session = open_session(arguments.frame.adapter.as_deref())?;
    let choices: Vec<Choice> = Technique::rivals().into_iter().map(Choice::new).collect();
    let size = arguments.frame.picture_size();
    let everyone = Measurement { choices, size, runs: 1 };
    for scene in scenes(arguments, built_in)? {
        let (mut to_fastest, mut to_z_fail, mut wrong) = (Vec::new(), Vec::new(), 0);
        let mut rivals: BTreeMap<&str, usize> = BTreeMap::new();
        // From some positions, such as behind the walls, nothing lit or dark is seen.
        let places =
            (0..10 * arguments.cameras).map(|seed| Scene { camera: scene.camera.anywhere(seed), ..scene.clone() });
        for seen in places {
            if to_z_fail.len() as u64 == arguments.cameras {
                break;
            }
            let tried = session.measure(&seen, &everyone, &Progress::default())?;
            if tried.iter().all(|one| one.error.compared == 0) {
                continue;
            }
            // All are run once; those that can be the fastest are timed in turn.
            let choices = contenders(&tried);
            let measured = session.measure(&seen, &Measurement { choices, size, runs: RUNS }, &Progress::default())?;
            let of = |technique: Technique| measured.iter().find(|one| one.choice.technique() == technique);
            let (Some(auto), Some(z_fail)) = (of(Technique::Auto), of(Technique::ZFail)) else { continue };
            let right = measured.iter().filter(|one| one.error.wrong() == 0);
            let others = right.filter(|one| one.choice.technique() != Technique::Auto);
            let fastest = others.min_by(|a, b| frame_ms(a).total_cmp(&frame_ms(b)));
            if let Some(fastest) = fastest {
                to_fastest.push(frame_ms(auto) / frame_ms(fastest));
                *rivals.entry(fastest.choice.technique().name()).or_default() += 1;
            }
            to_z_fail.push(frame_ms(auto) / frame_ms(z_fail));
            wrong += auto.error.wrong();
        }
        output::print(&format!(
            "{}, {} cameras, {}x{}: {wrong} wrong pixels\n  auto/fastest that is right: {}{}\n  auto/z-fail: {}\n",
            scene.name,
            to_z_fail.len(),
            size[0],
            size[1],
            spread(to_fastest),
            named(&rivals),
            spread(to_z_fail),
        ))?;
    }
    Ok(())
}

fn frame_ms(of: &MeasuredTechnique) -> f64 {
    median_ms(&of.frames).unwrap_or(f64::NAN)
}

/// Returns the choices to time again: `auto` and z-fail always, and every technique without wrong pixels whose frame
/// took at most `MAY_WIN` times that of the fastest of these.
fn contenders(tried: &[MeasuredTechnique]) -> Vec<Choice> {
    let right = || tried.iter().filter(|one| one.error.wrong() == 0);
    let fastest = right().map(frame_ms).fold(f64::INFINITY, f64::min);
    let always = |one: &&MeasuredTechnique| matches!(one.choice.technique(), Technique::Auto | Technique::ZFail);
    let may_win = |one: &&MeasuredTechnique| one.error.wrong() == 0 && frame_ms(one) <= MAY_WIN * fastest;
    tried.iter().filter(|one| always(one) || may_win(one)).map(|one| one.choice.clone()).collect()
}

/// Returns which techniques were the fastest, in how many positions: `; that was planar 3, z-fail 12`.
fn named(rivals: &BTreeMap<&str, usize>) -> String {
    let each: Vec<String> = rivals.iter().map(|(name, times)| format!("{name} {times}")).collect();
    if each.is_empty() { String::new() } else { format!("; that was {}", each.join(", ")) }
}

/// Returns the median, least and greatest of the ratios as `1.20 (from 1.00 to 1.50)`; `none` where there are none. Of
/// an even number the higher middle one is the median.
fn spread(mut ratios: Vec<f64>) -> String {
    ratios.sort_by(f64::total_cmp);
    match (ratios.first(), ratios.get(ratios.len() / 2), ratios.last()) {
        (Some(least), Some(median), Some(most)) => format!("{median:.2} (from {least:.2} to {most:.2})"),
        _ => "none".to_owned(),
    }
}

fn scenes(
    arguments: &BenchArguments,
    own: impl FnOnce() -> Result<Vec<Scene>, CliError>,
) -> Result<Vec<Scene>, CliError> {
    let open = |name: &String| arguments.scene_options.open(name);
    if arguments.scene.is_empty() { own() } else { arguments.scene.iter().map(open).collect() }
}

/// Runs the benchmark `volumes`: times the edge list of a mesh, and silhouettes and volumes again for each new light.
/// Measures the casters of the given scenes; without scenes two bumpy spheres, with the ratio of their times per
/// triangle.
fn volumes(arguments: &BenchArguments) -> Result<(), CliError> {
    if arguments.scene.is_empty() {
        let small = bumpy_mesh(264, 133)?;
        let large = bumpy_mesh(1000, 501)?;
        let (small_cost, large_cost) = (volume_cost(&small, LIGHTS), volume_cost(&large, LIGHTS));
        output::print(&volume_lines("bumpy sphere", &small_cost))?;
        output::print(&volume_lines("bumpy sphere", &large_cost))?;
        let ratio = |times: fn(&VolumeCost) -> &[Duration]| {
            let per_triangle = |cost: &VolumeCost| median_ms(times(cost)).unwrap_or(f64::NAN) / cost.triangles as f64;
            per_triangle(&large_cost) / per_triangle(&small_cost)
        };
        return output::print(&format!(
            "large against small, a triangle: edge list {:.2}, new light {:.2}\n",
            ratio(|cost| &cost.edge_list),
            ratio(|cost| &cost.new_light),
        ));
    }
    for scene in scenes(arguments, || Ok(Vec::new()))? {
        for object in scene.objects.iter().filter(|object| object.casts) {
            let title = format!("{}, {}", scene.name, object.name);
            output::print(&volume_lines(&title, &volume_cost(&object.mesh, LIGHTS)))?;
        }
    }
    Ok(())
}

fn volume_lines(title: &str, cost: &VolumeCost) -> String {
    let line = |what: &str, times: &[Duration]| {
        let fastest = times.iter().min().map_or(f64::NAN, |time| time.as_secs_f64() * 1e3);
        format!("  {what}_ms {:.3} (fastest {fastest:.3})\n", median_ms(times).unwrap_or(f64::NAN))
    };
    format!(
        "{title}: {} triangles, {} edges; last light: {} silhouette edges, {} triangles of its volume\n{}{}{}{}{}{}{}",
        cost.triangles,
        cost.edges,
        cost.silhouette_edges,
        cost.volume_triangles,
        line("edge_list", &cost.edge_list),
        line("planes", &cost.planes),
        line("facing", &cost.facing),
        line("multiplicities", &cost.multiplicities),
        line("indices", &cost.indices),
        line("new_light", &cost.new_light),
        line("hashing", &cost.hashing),
    )
}

/// Returns a closed model of about twice `around` times `up` triangles on a floor, as uneven as a scanned one.
fn bumpy_model(around: u32, up: u32) -> Result<Scene, SceneError> {
    model_scene(BUMPY, bumpy_mesh(around, up)?, true, UpAxis::Y)
}

fn bumpy_mesh(around: u32, up: u32) -> Result<Mesh, SceneError> {
    let fail = |source| SceneError::Mesh { name: BUMPY.to_owned(), source };
    let smooth = shapes::sphere(1.0, around, up).map_err(fail)?;
    let bump = |p: &DVec3| *p * (1.0 + 0.12 * (5.0 * p.x).sin() * (4.0 * p.y + 1.0).sin() * (6.0 * p.z).cos());
    let builder = MeshBuilder {
        positions: smooth.positions().iter().map(bump).collect(),
        triangles: smooth.triangles().to_vec(),
        ..MeshBuilder::default()
    };
    builder.build().map_err(fail)
}

/// Returns lines with the frame's median times without and with snapshots, and how long plain memory takes to copy as
/// many bytes. Where the snapshots don't fit in memory at once, only the frame's time and that fact.
fn capture_lines(title: &str, cost: &CaptureCost) -> String {
    let frame = median_ms(&cost.frames).unwrap_or(f64::NAN);
    if cost.captured.is_empty() {
        return format!(
            "{title}\n  frame_ms {frame:.2}\n  not all {} bytes of snapshots fit into memory at once\n",
            cost.snapshot_bytes
        );
    }
    let captured = median_ms(&cost.captured).unwrap_or(f64::NAN);
    let copy = median_ms(&memory_copies(cost.snapshot_bytes)).unwrap_or(f64::NAN);
    let megabytes = cost.snapshot_bytes as f64 / 1e6;
    let added = captured - frame;
    format!(
        "{title}\n  frame_ms {frame:.2}\n  captured_ms {captured:.2}\n  captured/frame {:.3}\n  \
         bytes moved {} ({megabytes:.1} MB)\n  plain copy of as many: {copy:.2} ms, {:.3} of a frame; snapshots cost {:.2} such copies\n",
        captured / frame,
        cost.snapshot_bytes,
        copy / frame,
        added / copy,
    )
}

/// Returns the times of several copies of `count` bytes from one place in memory to another.
fn memory_copies(count: u64) -> Vec<Duration> {
    let count = usize::try_from(count).unwrap_or(usize::MAX);
    let source = vec![1u8; count];
    let mut target = vec![0u8; count];
    let copy = |_| {
        let start = Instant::now();
        target.copy_from_slice(black_box(&source));
        black_box(&target);
        start.elapsed()
    };
    (0..RUNS).map(copy).collect()
}

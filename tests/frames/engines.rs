//! Other people's engines, recorded as they are: what is found of their lights, maps and volumes is held against what their
//! scripts say, and against the corners of their own draws. Writes `assets/engines.md`.
//!
//! `ENGINES_PYTHON` is the interpreter that has them; `ENGINES_KEEP=FOLDER` keeps the recordings.

use super::games::{GAMES, Game, game_row};
use super::read_frame::{EDGES, ReadFrame};
use super::said_places::SaidPlaces;
use super::shared::{draws, recording};
use std::fmt::Write as _;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;
use stencilscope::diagnosis::{Cause, Proof};
use stencilscope::import::{self, ConvertedFrame, RecordingRequest, RenderDocOptions};
use stencilscope::progress::Progress;
use stencilscope::reading::format::count;
use stencilscope::session::{FrameSource, RunFrame, Session};

/// An engine, and the script, or Godot's project, that draws a scene with it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Engine {
    Pygfx,
    Vtk,
    Panda,
    Ogre,
    Irrlicht,
    Blender,
    Godot,
    Taught,
}

impl Engine {
    fn name(self) -> &'static str {
        match self {
            Engine::Pygfx => "pygfx",
            Engine::Vtk => "VTK",
            Engine::Panda => "Panda3D, simplepbr",
            Engine::Ogre => "OGRE",
            Engine::Irrlicht => "Irrlicht",
            Engine::Blender => "Blender, Workbench",
            Engine::Godot => "Godot",
            Engine::Taught => "own program",
        }
    }

    fn script(self) -> &'static str {
        match self {
            Engine::Pygfx => "pygfx_shadows.py",
            Engine::Vtk => "vtk_shadows.py",
            Engine::Panda => "panda_shadows.py",
            Engine::Ogre => "ogre.py",
            Engine::Irrlicht => "irrlicht_shadows.cpp",
            Engine::Blender => "blender_shadows.py",
            Engine::Godot => "godot",
            Engine::Taught => "taught_shadows.py",
        }
    }
}

/// A frame that is read as its engine draws it.
struct SoundFrame {
    engine: Engine,
    options: &'static str,
    what: &'static str,
    /// How many pixels are wrong not only by the size of a map's texels: the engine's own.
    most_beyond: u64,
    /// The engine's own fault that makes more of them wrong, and is proven.
    explained_by: Option<Cause>,
}

const fn sound(engine: Engine, options: &'static str, what: &'static str, most_beyond: u64) -> SoundFrame {
    SoundFrame { engine, options, what, most_beyond, explained_by: None }
}

const SOUND: [SoundFrame; 24] = [
    sound(Engine::Pygfx, "", "directional light, one map", 0),
    sound(Engine::Pygfx, "--light point", "point light, a cube of maps", 0),
    sound(Engine::Vtk, "", "spot light, one map", 0),
    sound(Engine::Panda, "", "spot light, one map", 0),
    sound(Engine::Panda, "--light directional", "directional light, one map", 0),
    sound(Engine::Ogre, "--texture spot", "spot light, one map of 16 bits", 0),
    sound(Engine::Ogre, "--texture directional", "directional light, one map of 16 bits", 0),
    sound(Engine::Ogre, "", "point light, stencil counts in front", 0),
    sound(Engine::Ogre, "--inside", "the eye in a shadow, stencil counts on either side", 0),
    sound(Engine::Ogre, "--along", "a low light, the eye in a shadow", 0),
    sound(Engine::Irrlicht, "--z-pass", "point light, stencil counts in front", 2),
    sound(Engine::Irrlicht, "--inside", "the eye in a shadow, stencil counts behind", 0),
    sound(Engine::Blender, "--view 1", "directional light, stencil counts in front", 0),
    SoundFrame {
        explained_by: Some(Cause::CapFighting),
        ..sound(Engine::Blender, "--view 2", "directional light, stencil counts on either side", 0)
    },
    sound(Engine::Blender, "--view 3", "directional light, stencil counts in front", 0),
    sound(Engine::Godot, "--light spot", "spot light, one map in a part of a texture", 0),
    sound(Engine::Godot, "--light directional --normal-bias 0", "directional light, one map", 0),
    sound(Engine::Godot, "--light point", "point light, a cube of maps", 0),
    sound(Engine::Taught, "--kind cube", "point light, a cube of distances in one layered draw a mesh", 0),
    sound(Engine::Taught, "--kind cascades", "directional light, three cascades in layers", 0),
    sound(Engine::Taught, "--kind cascades --in atlas", "directional light, three cascades in an atlas", 0),
    sound(
        Engine::Taught,
        "--kind cascades --in textures",
        "directional light, three cascades in textures of their own",
        0,
    ),
    sound(Engine::Taught, "--kind moments", "spot light, moments of depth", 0),
    sound(Engine::Taught, "--kind moments --blur", "spot light, moments of depth that are blurred", 0),
];

/// A fault that a script provokes, and the cause that should be named first.
struct ProvokedFault(Engine, &'static str, Cause);

const FAULTS: [ProvokedFault; 25] = [
    ProvokedFault(Engine::Pygfx, "--cull back", Cause::Acne),
    ProvokedFault(Engine::Pygfx, "--far 22", Cause::MapFarPlane),
    ProvokedFault(Engine::Pygfx, "--near 19", Cause::MapNearPlane),
    ProvokedFault(Engine::Pygfx, "--wide 16", Cause::OutsideMap),
    ProvokedFault(Engine::Pygfx, "--open", Cause::MapFacesCulled),
    ProvokedFault(Engine::Pygfx, "--left-out", Cause::NotInMap),
    ProvokedFault(Engine::Pygfx, "--light spot", Cause::MapDepthCoarse),
    ProvokedFault(Engine::Vtk, "--texels 64", Cause::Aliasing),
    ProvokedFault(Engine::Panda, "--far 15", Cause::MapFarPlane),
    ProvokedFault(Engine::Panda, "--near 14", Cause::MapNearPlane),
    ProvokedFault(Engine::Panda, "--light directional --wide 9", Cause::OutsideMap),
    ProvokedFault(Engine::Panda, "--left-out", Cause::NotInMap),
    ProvokedFault(Engine::Irrlicht, "--z-pass --inside", Cause::EyeInVolume),
    ProvokedFault(Engine::Irrlicht, "", Cause::OpenVolume),
    ProvokedFault(Engine::Godot, "--light spot --bias 0", Cause::Acne),
    ProvokedFault(Engine::Godot, "--light spot --texels 256", Cause::Aliasing),
    ProvokedFault(Engine::Godot, "--light directional --normal-bias 0 --bias 0", Cause::Acne),
    ProvokedFault(Engine::Godot, "--light directional --normal-bias 0 --open", Cause::MapFacesCulled),
    ProvokedFault(Engine::Godot, "--light directional --normal-bias 0 --left-out", Cause::NotInMap),
    ProvokedFault(Engine::Taught, "--kind cube --bias 0", Cause::Acne),
    ProvokedFault(Engine::Taught, "--kind cube --far 9", Cause::MapFarPlane),
    ProvokedFault(Engine::Taught, "--kind cube --left-out", Cause::NotInMap),
    ProvokedFault(Engine::Taught, "--kind cascades --texels 64", Cause::Aliasing),
    ProvokedFault(Engine::Taught, "--kind cascades --far 18", Cause::MapFarPlane),
    ProvokedFault(Engine::Taught, "--kind moments --far 16", Cause::MapFarPlane),
];

/// What records programs: interpreters, Irrlicht's program once it is built, and the GPU.
struct Workshop {
    folder: tempfile::TempDir,
    python: String,
    session: Session,
}

impl Workshop {
    fn new() -> Workshop {
        let python =
            std::env::var("ENGINES_PYTHON").expect("ENGINES_PYTHON: the interpreter that has pygfx, VTK and Panda3D");
        let session = Session::new(None).expect("the reference adapter (Debian: mesa-vulkan-drivers)");
        let folder = tempfile::tempdir().expect("a folder");
        // Mesa's software driver fails to compile Panda3D's shaders otherwise, in the program and where it is replayed.
        let interpreter = folder.path().join("interpreter");
        let text = format!("#!/bin/sh\nGALLIVM_PERF=nopt exec {} \"$@\"\n", super::PYTHON);
        fs::write(&interpreter, text).expect("written");
        fs::set_permissions(&interpreter, fs::Permissions::from_mode(0o755)).expect("made executable");
        Workshop { folder, python, session }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The program and its first arguments.
    fn program(&self, engine: Engine) -> Vec<String> {
        let script = recording(engine.script()).display().to_string();
        match engine {
            Engine::Irrlicht => {}
            Engine::Ogre | Engine::Taught => return vec![super::PYTHON.to_owned(), script],
            Engine::Pygfx | Engine::Vtk | Engine::Panda => return vec![self.python.clone(), script],
            Engine::Godot => {
                let words = ["godot3", "--path", &script, "-s", "shadows.gd"];
                return words.map(str::to_owned).to_vec();
            }
            Engine::Blender => {
                let words = "blender --factory-startup --no-window-focus --window-geometry 0 0 900 640 --python";
                let words = words.split(' ').map(str::to_owned);
                return words.chain([script, "--".to_owned()]).collect();
            }
        }
        let program = self.path("irrlicht_shadows");
        if !program.exists() {
            let status = Command::new("g++").args([&script, "-lIrrlicht", "-o"]).arg(&program).status();
            assert!(status.expect("g++").success(), "{script} is not built");
        }
        vec![program.display().to_string()]
    }

    fn record(&mut self, engine: Engine, options: &str) -> (SaidPlaces, ReadFrame) {
        let file = self.path("said");
        // What another script has said is not this one's.
        if file.exists() {
            fs::remove_file(&file).expect("removed");
        }
        let mut command = self.program(engine);
        command.extend(options.split_whitespace().map(str::to_owned));
        command.extend(["--say".to_owned(), file.display().to_string()]);
        let python = match engine {
            Engine::Panda => self.path("interpreter").display().to_string(),
            _ => super::PYTHON.to_owned(),
        };
        let words: String = options.chars().filter(|c| !c.is_whitespace()).collect();
        let request = RecordingRequest { command, frame: 5, seconds: 60, keep: kept(&format!("{engine:?}{words}")) };
        let read = self.read(&request, python, engine.name());
        (SaidPlaces::read(&fs::read_to_string(&file).expect("places")), read)
    }

    fn play(&mut self, game: &Game) -> ReadFrame {
        let home = self.path("home").display().to_string();
        let command = game.command.split_whitespace().map(|word| word.replace("{home}", &home)).collect();
        let request = RecordingRequest { command, frame: game.frame, seconds: game.seconds, keep: kept(game.name) };
        self.read(&request, super::PYTHON.to_owned(), game.name)
    }

    fn read(&mut self, request: &RecordingRequest, python: String, name: &str) -> ReadFrame {
        let start = Instant::now();
        let reader = RenderDocOptions { python: Some(python), ..RenderDocOptions::default() };
        let progress = Progress::default();
        let raw = import::record(request, &reader, &progress)
            .unwrap_or_else(|error| panic!("{}: {error}", request.command.join(" ")));
        let ConvertedFrame { plan, capture, scene, lights } = import::convert(&raw, name).expect("a frame");
        let capture = self.session.compared_with_rerun(&plan, &capture, &progress).expect("checked");
        let source = scene.map(|scene| Arc::new(FrameSource { scene, request: None }));
        let frame = RunFrame { capture: Arc::new(capture), plan: Arc::new(plan), source };
        let diagnosis = self.session.diagnose_recorded(&frame, &progress).expect("a diagnosis");
        ReadFrame { raw, frame, lights, diagnosis, seconds: start.elapsed().as_secs_f64() }
    }
}

/// Where a recording is kept, if any is.
fn kept(name: &str) -> Option<PathBuf> {
    std::env::var_os("ENGINES_KEEP").map(|folder| Path::new(&folder).join(format!("{name}.rdc")))
}

/// Numbers of a frame that is read as its engine draws it, as a row of the page; adds to `wrong` what does not hold.
fn row(frame: &SoundFrame, said: &SaidPlaces, read: &ReadFrame, wrong: &mut Vec<String>) -> String {
    let title = format!("{} {}", frame.engine.name(), frame.options);
    let mut holds = |what: &str, holds: bool| {
        if !holds {
            wrong.push(format!("{title}: {what}"));
        }
    };
    println!("{}", read.diagnosis.to_text());
    let (same, all, most) = read.draws_as_stored();
    let is_same = all > 0 && most <= 2 * EDGES as u64;
    holds(&format!("{same} of {all} draws leave what was stored, one does not at {most} pixels"), is_same);
    let compared = read.diagnosis.coverage[0].compared;
    let comparable = read.comparable();
    holds(&format!("{compared} of {comparable} pixels compared"), compared * 100 > comparable * 99);
    let [light] = &read.diagnosis.lights[..] else { panic!("{title}: one light") };
    let beyond = light.beyond_texels();
    let is_explained = read.diagnosis.causes.first().is_some_and(|first| Some(first.cause) == frame.explained_by);
    let is_explained = is_explained && read.diagnosis.causes[0].proof == Proof::Proven;
    holds(&format!("{beyond} pixels wrong beyond texels"), beyond <= frame.most_beyond || is_explained);
    let found = read.lights[0].as_ref().expect("a light");
    let off = said.degrees_off(found.position);
    holds(&format!("the light is {off} degrees off"), off < 0.5);
    holds("a point or a direction", found.position.w == said.light.w);
    let residual = read.residual();
    holds(&format!("a residual of {residual:?} texels"), residual.is_none_or(|residual| residual < 0.5));
    let (texels, differing) = read.texels(said.far);
    holds(&format!("{texels} texels"), texels == if residual.is_some() { 200 } else { 0 });
    holds(&differing.join("\n  "), differing.is_empty());
    format!(
        "| {} | {} | {} | {} | {} | {same} of {all} | {} | {} | {} | {} | {} | {:.1} |\n",
        frame.engine.name(),
        said.version,
        frame.what,
        read.api(),
        draws(&read.raw).len(),
        count(compared),
        count(light.error.wrong()),
        if residual.is_some() { count(light.within_texel) } else { String::new() },
        small(off),
        residual.map_or_else(String::new, small),
        read.seconds,
    )
}

/// A small number, with one digit.
fn small(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:.0e}") }
}

/// What is found of a provoked fault, as a row of the page; adds to `wrong` where another cause is named first.
fn fault_row(
    ProvokedFault(engine, options, cause): &ProvokedFault,
    read: &ReadFrame,
    wrong: &mut Vec<String>,
) -> String {
    let text = read.diagnosis.to_text();
    println!("{text}");
    let title = format!("{} {options}", engine.name());
    let Some(first) = read.diagnosis.causes.iter().find(|found| found.proof != Proof::NotIt) else {
        wrong.push(format!("{title}: no cause\n{text}"));
        return String::new();
    };
    // Single pixels are left of what a map is too coarse for; and Irrlicht's caps lack more than the edges that are open.
    let leaves_some = matches!(cause, Cause::Acne | Cause::Aliasing | Cause::OpenVolume);
    let expected = if leaves_some { Proof::Part } else { Proof::Proven };
    if (first.cause, first.proof) != (*cause, expected) {
        wrong.push(format!("{title}: {} first\n{text}", first.title()));
    }
    let light = &read.diagnosis.lights[0];
    format!(
        "| {} | {} | {} | {} | {} | {} |\n",
        engine.name(),
        if options.is_empty() { String::new() } else { format!("`{options}`") },
        // What is not in the map may be meant to cast no shadow, so that no pixel is wrong for it.
        count(if first.cause == Cause::NotInMap {
            first.evidence.shown_by as u64
        } else {
            light.error.wrong() + light.acne
        }),
        first.names(),
        first.proof.name(),
        count(first.pixels_left),
    )
}

fn page(rows: &str, games: &str, faults: &str) -> String {
    let head = "| program | version | what it draws | API | draws | as stored | compared | wrong | by texels' size | \
                light off by, ° | residual, texels | s |";
    let mut page = String::from(
        "# Engines as they are\n\nWritten by `.ci/frames`, which records the programs of `assets/recordings` on the software \
         driver, computes their draws anew, and counts as wrong the pixels for which a shadow map or a stencil count says \
         something else than rays through the frame's own triangles.\n\n",
    );
    writeln!(page, "{head}\n|---|---|---|---|--:|--:|--:|--:|--:|--:|--:|--:|").expect("written");
    page += rows;
    page += "\nGames, which say nowhere where their lights are; the seconds hold the time until the frame:\n\n\
             | program | version | what it draws | API | draws | as stored | compared | wrong | proven cause | casters with a light | s |\n\
             |---|---|---|---|--:|--:|--:|--:|---|--:|--:|\n";
    page += games;
    page += "\nOf fourteen frames of OpenArena, from places that chance chose, 0 to 20 pixels are wrong, and a changed plan makes \
             each right. `open-mesh`: the glass of a scope is two discs, of which its volumes carry the one that is turned away \
             from the light alone, so that light goes through the other. `near-plane-cut and eye-in-volume`: the eye stands in \
             the shadow of a model.\n";
    page += "\nFaults that the scripts provoke, and the cause that is named first:\n\n\
             | program | options | pixels wrong, or dark by it | cause | proof | pixels left |\n|---|---|--:|---|---|--:|\n";
    page + faults
}

#[test]
fn engines_are_read_as_they_draw_and_their_faults_are_named() {
    let mut workshop = Workshop::new();
    let (mut rows, mut games, mut faults, mut wrong) = (String::new(), String::new(), String::new(), Vec::new());
    for frame in &SOUND {
        println!("== {} {}", frame.engine.name(), frame.options);
        let (said, read) = workshop.record(frame.engine, frame.options);
        rows += &row(frame, &said, &read, &mut wrong);
    }
    for game in &GAMES {
        println!("== {}", game.name);
        let read = workshop.play(game);
        games += &game_row(game, &read, &mut wrong);
    }
    for fault in &FAULTS {
        println!("== {} {}", fault.0.name(), fault.1);
        let (_, read) = workshop.record(fault.0, fault.1);
        faults += &fault_row(fault, &read, &mut wrong);
    }
    let page = page(&rows, &games, &faults);
    println!("{page}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/engines.md");
    fs::write(file, page).expect("written");
}

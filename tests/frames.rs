//! Real programs under RenderDoc: a test program of its own, as it needs packages that the other tests do not.
//! `.ci/frames` installs them and runs it.

#[path = "frames/corners.rs"]
mod corners;
#[path = "frames/engines.rs"]
mod engines;
#[path = "frames/games.rs"]
mod games;
#[path = "import/machine.rs"]
mod machine;
#[path = "common/random.rs"]
#[expect(dead_code, reason = "other tests use the rest")]
mod random;
#[path = "frames/read_frame.rs"]
mod read_frame;
#[path = "frames/said_places.rs"]
mod said_places;
#[path = "import/shared.rs"]
mod shared;

use shared::{assert_makes_what_was_stored, draws, has_ended, recording};
use std::process::{Command, Stdio};
use std::time::Duration;
use stencilscope::import::{self, ImportError, RawContents, RawFrame, RecordedApi, RecordingRequest, RenderDocOptions};
use stencilscope::progress::Progress;

/// Debian's interpreter, which has the packages' modules.
const PYTHON: &str = "/usr/bin/python3";

fn options() -> RenderDocOptions {
    RenderDocOptions { python: Some(PYTHON.to_owned()), ..RenderDocOptions::default() }
}

fn record(command: &[&str], seconds: u64) -> Result<RawFrame, ImportError> {
    let command = command.iter().map(|word| (*word).to_owned()).collect();
    import::record(&RecordingRequest { command, frame: 3, seconds, keep: None }, &options(), &Progress::default())
}

#[test]
fn ogre_is_recorded_with_every_option() {
    let script = recording("ogre.py").display().to_string();
    for more in [&[][..], &["--inside"], &["--along"], &["--along", "--far", "350"], &["--reach", "330"]] {
        let frame = record(&[&[PYTHON, script.as_str()], more].concat(), 60).expect("a frame");
        println!("{more:?}");
        assert_eq!((frame.api, frame.limits.len()), (RecordedApi::OpenGl, 0), "{:?}", frame.limits);
        assert_makes_what_was_stored(&frame);
    }
}

#[test]
fn recordings_that_are_here_are_imported() {
    for name in ["ogre", "ogre-inside", "ogre-far", "ogre-short", "own"] {
        let file = recording(&format!("{name}.rdc"));
        let frame = import::import(&file, &options(), &Progress::default()).expect("a frame");
        println!("{name}");
        assert_makes_what_was_stored(&frame);
        if recording(name).is_dir() {
            // Another driver may round otherwise: what is drawn and how is the same.
            let [found, stored] =
                [frame, import::read(&recording(name)).expect("a frame")].map(|frame| import::list(&frame));
            assert!(found.lines().skip(1).eq(stored.lines().skip(1)), "{name}: {found}\n{stored}");
        }
    }
}

/// Arrays of a capture folder, as NumPy itself reads them.
#[test]
fn numpy_reads_every_array() {
    const SCRIPT: &str = "import numpy, sys\nfor file in sys.argv[1:]:\n    array = numpy.load(file, allow_pickle=False)\n    \
                          print(array.dtype.str, *array.shape, array.size)";
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let capture = ["capture", "two-lights", "-t", "shadow-map", "--truth", "--size", "80x60", "-o"];
    let status =
        Command::new(env!("CARGO_BIN_EXE_stencilscope")).args(capture).arg(&out).status().expect("the program");
    assert!(status.success());
    let names = |ending: &str| -> Vec<_> {
        let entries = std::fs::read_dir(&out).expect("a folder").map(|entry| entry.expect("an entry").path());
        let mut names: Vec<_> = entries.filter(|path| path.to_string_lossy().ends_with(ending)).collect();
        names.sort();
        names
    };
    let read = |files: &[std::path::PathBuf]| {
        let output = Command::new(PYTHON).args(["-c", SCRIPT]).args(files).output().expect("Python");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).expect("text")
    };
    let all = names(".npy");
    assert!(all.len() > 20 && read(&all).lines().count() == all.len());
    assert_eq!(read(&names(".shadow.npy")), "|u1 60 80 4800\n".repeat(2));
    assert_eq!(read(&names(".depth.npy")[..1]), "<f4 60 80 4800\n");
}

/// A list of states and vertices needs no pictures: of a frame that is too large for them, too.
#[test]
fn a_list_reads_no_pictures() {
    let file = recording("ogre.rdc");
    let states = RenderDocOptions { pictures: false, ..options() };
    let [whole, states] =
        [options(), states].map(|options| import::import(&file, &options, &Progress::default()).expect("a frame"));
    assert_eq!(import::list(&whole), import::list(&states));
    assert!(states.events.iter().all(|event| event.after == RawContents::default()));
}

/// Clip space with its origin at the top, depth reversed, strips and fans that start again, instances, masks, a cube.
#[test]
fn opengl_as_few_use_it_is_the_right_way_round() {
    let frame = record(&[PYTHON, &recording("odd.py").display().to_string()], 60).expect("a frame");
    assert_makes_what_was_stored(&frame);
    let compared = machine::compare(&frame);
    assert_eq!(compared.len(), 7, "all but the one of four samples");
    assert!(compared.iter().all(|draw| draw.changed > 0), "{compared:?}");
    assert_eq!(frame.limits.len(), 1, "{:?}", frame.limits);
    let layers: Vec<u32> = frame.events.iter().filter_map(|event| Some(event.depth_target?.layer)).collect();
    assert_eq!(layers[2..6], [1, 1, 4, 4]);
}

/// Its depth map can't be read back on OpenGL ES, which is said; the picture can.
#[test]
fn a_shadow_map_of_glmark_is_recorded() {
    let frame = record(&["glmark2-es2", "-b", "shadow", "-s", "320x240"], 60).expect("a frame");
    assert_eq!((frame.api, draws(&frame).len()), (RecordedApi::Gles, 3));
    assert_makes_what_was_stored(&frame);
}

/// Our own frames, drawn by wgpu on Vulkan.
#[test]
fn vulkan_is_recorded() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out").display().to_string();
    let program = env!("CARGO_BIN_EXE_stencilscope");
    let capture = [program, "capture", "tori", "-t", "z-fail", "--size", "320x180", "--external-capture", "-o", &out];
    let frame = record(&capture, 60).expect("a frame");
    assert_eq!(frame.api, RecordedApi::Vulkan);
    assert!(frame.events.iter().any(|event| event.groups == ["volumes"]));
    assert_makes_what_was_stored(&frame);
}

#[test]
fn programs_that_show_nothing_are_named() {
    let failed = |command: &[&str]| record(command, 3).expect_err("no frame");
    assert!(matches!(failed(&["no-such-program"]), ImportError::NoProgram { .. }));
    // RenderDoc may have taken the exit code for itself.
    let died = failed(&["sh", "-c", "echo alas; exit 3"]);
    assert!(matches!(&died, ImportError::Died { and_said, .. } if and_said.contains("alas")), "{died}");
    assert!(matches!(failed(&["sleep", "100"]), ImportError::NeverPresented { seconds: 3, .. }));
}

#[test]
fn files_that_are_no_whole_captures_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let whole = std::fs::read(recording("ogre.rdc")).expect("a recording");
    let failed = |bytes: &[u8]| {
        let file = folder.path().join("frame.rdc");
        std::fs::write(&file, bytes).expect("written");
        import::import(&file, &options(), &Progress::default()).expect_err("no frame")
    };
    for bytes in [&b""[..], b"text", &whole[..100], &whole[..whole.len() / 2]] {
        let error = failed(bytes);
        assert!(matches!(error, ImportError::Corrupt { .. }), "{} bytes: {error}", bytes.len());
    }
}

/// Killed in the middle of a recording, we leave neither the program nor a folder.
#[test]
fn nothing_is_left_when_we_are_killed() {
    let folder = tempfile::tempdir().expect("a folder");
    let pid = folder.path().join("pid");
    let program = format!("echo $$ >{}; exec sleep 100", pid.display());
    let mut command = Command::new(env!("CARGO_BIN_EXE_stencilscope"));
    command.args(["record", "--list", "--python", PYTHON, "--", "sh", "-c", &program]);
    let temporary = folder.path().join("temporary");
    std::fs::create_dir(&temporary).expect("made");
    let mut child = command.env("TMPDIR", &temporary).stderr(Stdio::null()).spawn().expect("the program runs");
    while !std::fs::read_to_string(&pid).is_ok_and(|text| text.ends_with('\n')) {
        std::thread::sleep(Duration::from_millis(20));
    }
    child.kill().expect("killed");
    child.wait().expect("ended");
    let pid = std::fs::read_to_string(&pid).expect("a number");
    assert!(has_ended(pid.trim()), "{pid} runs on");
    assert!(std::fs::read_dir(&temporary).expect("a folder").next().is_none());
}

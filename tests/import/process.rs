//! The process that reads a capture, played by scripts of the shell: limits, errors, and what is left behind.

use super::shared::has_ended;
use crate::common::names;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use stencilscope::import::{self, ImportError, RenderDocOptions};
use stencilscope::progress::Progress;
use tempfile::TempDir;

/// A folder with a file for a capture, an interpreter that does what the shell's `script` does, and an empty folder for
/// temporary ones.
fn folder(script: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let python = folder.path().join("python");
    fs::write(&python, format!("#!/bin/sh\n{script}\n")).expect("written");
    fs::set_permissions(&python, fs::Permissions::from_mode(0o755)).expect("made a program");
    fs::write(folder.path().join("frame.rdc"), "no capture").expect("written");
    fs::create_dir(folder.path().join("temporary")).expect("made");
    folder
}

/// Runs the program with that interpreter, and asserts that it fails with one line that has all words, and leaves nothing.
#[track_caller]
fn assert_fails(script: &str, arguments: &[&str], code: i32, words: &[&str]) -> Duration {
    let folder = folder(script);
    let start = Instant::now();
    let output = Command::new(env!("CARGO_BIN_EXE_stencilscope"))
        .args(arguments)
        .current_dir(folder.path())
        .env("TMPDIR", folder.path().join("temporary"))
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .stdin(Stdio::null())
        .output()
        .expect("the program runs");
    let line = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{script}: {line}");
    assert_eq!((line.trim_end().lines().count(), output.stdout.len()), (1, 0), "{script}: {line}");
    words.iter().for_each(|word| assert!(line.contains(word), "{script}: `{word}` is not in {line}"));
    assert!(names(&folder.path().join("temporary")).is_empty(), "{script}");
    assert!(!folder.path().join("out").exists(), "{script}");
    start.elapsed()
}

const IMPORT: [&str; 5] = ["import", "frame.rdc", "--list", "--python", "./python"];
const RECORD: [&str; 6] = ["record", "--list", "--python", "./python", "--", "game"];

#[test]
fn what_is_missing_is_named_with_its_package() {
    assert_fails("echo \"error module No module named 'renderdoc'\"", &IMPORT, 3, &["`./python`", "python3-renderdoc"]);
    assert_fails("echo error module nothing", &RECORD, 3, &["python3-renderdoc", "--python"]);
    let nothing = ["import", "frame.rdc", "--list", "--python", "./nothing"];
    assert_fails("", &nothing, 3, &["`./nothing` can't be started", "python3-renderdoc"]);
    assert_fails("", &["import", "gone.rdc", "--list", "--python", "./python"], 2, &["gone.rdc", "check the path"]);
    assert_fails("", &["import", "temporary", "--list", "--python", "./python"], 2, &["it is a folder"]);
    // Nobody writes to it: opening it would wait for ever.
    let pipes = tempfile::tempdir().expect("a folder");
    let pipe = pipes.path().join("pipe.rdc");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
    let pipe = pipe.to_str().expect("a name");
    assert_fails("", &["import", pipe, "--list", "--python", "./python"], 2, &["pipe.rdc", "it is a pipe"]);
}

/// The interpreter that has the module need not be the one that a shell finds first.
#[test]
fn the_interpreter_that_has_the_module_is_found() {
    let folder = folder("exit 1");
    let python = |name: &str, script: &str| {
        let file = folder.path().join(name);
        fs::write(&file, format!("#!/bin/sh\n{script}\n")).expect("written");
        fs::set_permissions(&file, fs::Permissions::from_mode(0o755)).expect("made a program");
    };
    python("python3", "exit 1");
    // No version that a system has, and a file that is none.
    let answers = |probe: &str, words: &str| format!("case $3 in '') {probe};; *) echo error corrupt {words};; esac");
    python("python3.9001", &answers("exit 1", "asked the older one"));
    python("python3.9002", &answers("echo done v9", "asked the right one"));
    python("python3.9003", "exit 1");
    fs::write(folder.path().join("python3.x"), "").expect("written");
    let mut command = Command::new(env!("CARGO_BIN_EXE_stencilscope"));
    command.args(["import", "frame.rdc", "--list"]).current_dir(folder.path()).env("PATH", folder.path());
    let output = command.stdin(Stdio::null()).output().expect("the program runs");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("asked the right one"), "{said}");
}

#[test]
fn each_failure_has_its_own_words() {
    let cases: [(&str, &[&str]); 10] = [
        ("error corrupt Not a file", &["frame.rdc", "not a whole RenderDoc capture (Not a file)", "record"]),
        ("error newer Needs 1.30", &["frame.rdc", "another version", "Needs 1.30", "--python"]),
        ("error replay No context", &["frame.rdc", "No context", "xvfb-run -a"]),
        ("error api D3D11", &["D3D11 is not read", "Vulkan"]),
        ("error large 4", &["more than 4 GiB", "fewer draws"]),
        ("error memory", &["more than 8 GiB of memory"]),
        ("error disk No space left", &["No space left", "with room"]),
        ("error script KeyError: 3", &["KeyError: 3", "report"]),
        ("error", &["RenderDoc's part failed"]),
        ("done", &["frame.json"]),
    ];
    for (said, words) in cases {
        assert_fails(&format!("echo '{said}'"), &IMPORT, 2, words);
    }
    assert_fails("echo boom >&2; exit 1", &IMPORT, 2, &["(boom)"]);
    assert_fails("exit 0", &IMPORT, 2, &["without a word"]);
    assert_fails("kill -SEGV $$", &IMPORT, 2, &["ended by signal 11; run it again"]);
    assert_fails("echo boom >&2; kill -ABRT $$", &RECORD, 2, &["ended by signal 6: boom; run it again"]);
    assert_fails("printf 'err\\nor\\001s %0500d' 7 >&2", &IMPORT, 2, &["(ors 000"]);
    assert_fails("head -c 3000000 /dev/urandom; head -c 3000000 /dev/urandom >&2", &IMPORT, 2, &["RenderDoc's part"]);
}

#[test]
fn a_program_that_shows_nothing_is_named_with_the_fix() {
    let cases: [(&str, &[&str]); 7] = [
        ("error program there is none", &["`game` can't be run", "check the name"]),
        ("error died with exit code 3", &["`game` ended with exit code 3 before frame 10: alas", "xvfb-run -a"]),
        ("error never it has not begun to draw", &["frame 10 after 60 s (it has not begun", "xvfb-run -a"]),
        ("error unsupported OpenGL compatibility profile", &["draws with OpenGL", "(compatibility profile)"]),
        (
            "error zink it ended by signal 11: uses glBegin",
            &["(uses glBegin)", "zink", "signal 11: alas;", "--seconds"],
        ),
        ("error no-zink it ended by signal 6: uses glBegin", &["(uses glBegin)", "signal 6: alas;", "a Vulkan driver"]),
        ("done itself gone.rdc", &["gone.rdc", "check the path"]),
    ];
    for (said, words) in cases {
        assert_fails(&format!("echo alas >&2; sleep 0.1; echo '{said}'"), &RECORD, 2, words);
    }
}

/// A folder can't be written yet: no work is done before that is known to be possible.
#[test]
fn a_folder_in_the_way_is_seen_first() {
    let arguments = ["import", "frame.rdc", "-o", "temporary/..", "--python", "./nothing"];
    assert_fails("", &arguments, 2, &["choose another name"]);
    assert_fails("", &["import", "frame.rdc", "--python", "./python"], 2, &["--output"]);
}

#[test]
fn what_takes_too_long_ends_with_all_that_it_has_started() {
    let script = "sleep 100 & echo $! >child; echo progress 1 2; sleep 100";
    let folder = folder(script);
    let python = Some(folder.path().join("python").display().to_string());
    let options = RenderDocOptions { python, seconds: 1, ..RenderDocOptions::default() };
    let child = folder.path().join("child");
    // The script runs where the tests do.
    let script = format!("cd {}; {script}", folder.path().display());
    fs::write(folder.path().join("python"), format!("#!/bin/sh\n{script}\n")).expect("written");
    let error = import::import(&folder.path().join("frame.rdc"), &options, &Progress::default());
    assert!(matches!(error, Err(ImportError::TooLong { seconds: 1 })), "{error:?}");
    let child = fs::read_to_string(child).expect("a child");
    assert!(has_ended(child.trim()), "{child} runs on");
}

#[cfg(target_os = "linux")]
#[test]
fn what_takes_too_much_memory_is_ended() {
    let folder = folder("x=$(head -c 400000000 /dev/zero | tr '\\0' x); sleep 100");
    let python = Some(folder.path().join("python").display().to_string());
    let options = RenderDocOptions { python, most_memory: 50 << 20, ..RenderDocOptions::default() };
    let error = import::import(&folder.path().join("frame.rdc"), &options, &Progress::default());
    assert!(matches!(error, Err(ImportError::TooMuchMemory { .. })), "{error:?}");
}

#[test]
fn work_that_is_called_off_ends() {
    let folder = folder("sleep 100");
    let options = RenderDocOptions {
        python: Some(folder.path().join("python").display().to_string()),
        ..RenderDocOptions::default()
    };
    let progress = Progress::default();
    progress.cancel();
    let error = import::import(&folder.path().join("frame.rdc"), &options, &progress);
    assert!(matches!(error, Err(ImportError::Cancelled)), "{error:?}");
}

//! Files that are broken at random: none makes the program panic, wait long or eat the memory.
//!
//! A seed is a broken file, so that a failure can be looked at again: what was read last stays in the system's folder for
//! temporary files, below `stencilscope-fuzz-PROCESS`. CI reads so many files of each kind as take some seconds; with
//! `STENCILSCOPE_FUZZ=SECONDS` as long as that, from a seed that the clock chooses.

use crate::common::apart;
use crate::common::random::Random;
use std::env;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};
use stencilscope::capture::disk;
use stencilscope::import;
use stencilscope::scene::{OpenSpec, open};
use stencilscope::session::{CaptureRequest, Session};
use stencilscope::technique::{Choice, Technique};

/// Address space that reading may take, bytes.
const MOST_MEMORY: u64 = 2 << 30;
/// What reading one file may take: the machine has other work.
const LONGEST: Duration = Duration::from_secs(5);
/// Files of each kind that CI reads.
const FILES: u64 = 6000;

/// A folder with everything that a file needs beside it, and which of them is broken.
type Whole = (PathBuf, String);
/// Reads a file. Could it be read?
type Read = fn(&Path) -> bool;

/// A kind of file: what whole ones look like, and how they are read.
struct Kind {
    name: &'static str,
    whole: Vec<Whole>,
    read: Read,
}

#[test]
fn broken_files_are_refused_or_read() {
    let parts = ["obj", "mtl", "toml", "gltf", "ply", "manifest", "arrays", "recordings"];
    apart("fuzz::broken_files_are_refused_or_read", &parts, |part| {
        let home = env::temp_dir().join(format!("stencilscope-fuzz-{}", std::process::id()));
        let kind = kind(part, &home.join("whole"));
        // After what needs a GPU: its driver maps more than this.
        limit_memory();
        let outcome = run(&kind, &home.join("broken"));
        println!("{part}: {outcome}");
        fs::remove_dir_all(&home).expect("removed");
    });
}

fn run(kind: &Kind, place: &Path) -> String {
    let seconds = env::var("STENCILSCOPE_FUZZ").ok().map(|seconds| seconds.parse::<u64>().expect("seconds"));
    let now = SystemTime::now().duration_since(UNIX_EPOCH).expect("a clock").as_secs();
    let (first, began) = (seconds.map_or(0, |_| now << 24), Instant::now());
    let whole: Vec<Vec<u8>> =
        kind.whole.iter().map(|(folder, file)| fs::read(folder.join(file)).expect("a file")).collect();
    let mut slowest = (Duration::ZERO, 0);
    let mut seed = first;
    let is_over = |seed: u64| seconds.map_or(seed - first == FILES, |limit| began.elapsed().as_secs() >= limit);
    for (folder, _) in &kind.whole {
        copy(folder, &place.join(folder.file_name().expect("a name")));
    }
    let mut read = 0;
    for (folder, file) in &kind.whole {
        assert!((kind.read)(&folder.join(file)), "{}: {file} is whole", kind.name);
    }
    while !is_over(seed) {
        let mut random = Random::new(seed);
        let chosen = random.below(whole.len() as u32) as usize;
        let (folder, file) = &kind.whole[chosen];
        let broken = place.join(folder.file_name().expect("a name")).join(file);
        fs::write(&broken, mutated(whole[chosen].clone(), &whole, &mut random)).expect("written");
        let start = Instant::now();
        let result = catch_unwind(AssertUnwindSafe(|| (kind.read)(&broken)));
        let took = start.elapsed();
        let Ok(was_read) = result else { panic!("{}, seed {seed}: panicked at {}", kind.name, broken.display()) };
        read += u64::from(was_read);
        assert!(took < LONGEST, "{}, seed {seed}: {took:?} for {}", kind.name, broken.display());
        fs::write(&broken, &whole[chosen]).expect("written");
        slowest = slowest.max((took, seed));
        seed += 1;
    }
    let count = seed - first;
    format!(
        "{count} files, {read} of them read, in {:?}; slowest {:?} (seed {})",
        began.elapsed(),
        slowest.0,
        slowest.1
    )
}

/// Limits the memory that the process may take from here on.
fn limit_memory() {
    let status = fs::read_to_string("/proc/self/status").expect("Linux");
    let line = status.lines().find_map(|line| line.strip_prefix("VmSize:")).expect("its address space");
    let taken = line.split_whitespace().next().expect("a number").parse::<u64>().expect("a number") << 10;
    let limit = Some(taken + MOST_MEMORY);
    let limit = rustix::process::Rlimit { current: limit, maximum: limit };
    rustix::process::setrlimit(rustix::process::Resource::As, limit).expect("a limit");
}

/// The files of one kind: those of the repository, and others that are made and written into the folder `made`.
fn kind(part: &str, made: &Path) -> Kind {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    let scene = |file: &Path| open(&OpenSpec::new(file.to_string_lossy())).is_ok();
    let recording = |name: &str, file: &str| (assets.join("recordings").join(name), file.to_owned());
    let (whole, read): (Vec<Whole>, Read) = match part {
        "obj" | "mtl" => {
            let ending = if part == "obj" { "obj" } else { "mtl" };
            let files = ["crate", "knot"].map(|name| (assets.join("models"), format!("{name}.{ending}")));
            let files = files.into_iter().filter(|(folder, file)| folder.join(file).is_file()).collect();
            (
                files,
                if part == "obj" {
                    scene
                } else {
                    |file| open(&OpenSpec::new(file.with_extension("obj").to_string_lossy())).is_ok()
                },
            )
        }
        "toml" => {
            // Every key: a scene with all of them is among the built-in ones, saved.
            for name in ["tori", "glass", "two-lights", "tiger-cage"] {
                let scene = open(&OpenSpec::new(name)).expect("a built-in scene");
                let folder = made.join(name);
                fs::create_dir_all(&folder).expect("a folder");
                stencilscope::scene::file::store(&scene, None, &folder.join("scene.toml")).expect("stored");
            }
            let names = ["tori", "glass", "two-lights", "tiger-cage"];
            (names.map(|name| (made.join(name), "scene.toml".to_owned())).to_vec(), scene)
        }
        "gltf" | "ply" => {
            let folder = assets.join(part);
            let names = crate::common::names(&folder).into_iter();
            let names = names.filter(|name| [".glb", ".gltf", ".ply"].iter().any(|ending| name.ends_with(ending)));
            (names.map(|name| (folder.clone(), name)).collect(), scene)
        }
        "manifest" | "arrays" => {
            let request = CaptureRequest::new(Choice::new(Technique::ZFail), [24, 16]);
            let scene = open(&OpenSpec::new("tetrahedron")).expect("a built-in scene");
            let capture = Session::new(None).expect("an adapter").capture(&scene, &request).expect("a capture");
            let folder = made.join("capture");
            fs::create_dir_all(made).expect("a folder");
            disk::write(&capture, &folder, false).expect("written");
            let files = fs::read_dir(&folder).expect("files").map(|entry| entry.expect("a file").file_name());
            let files = files.map(|name| name.to_string_lossy().into_owned());
            let is_array = |name: &String| name.ends_with(".npy") || name.ends_with(".png");
            let mut files: Vec<String> =
                files.filter(|name| if part == "arrays" { is_array(name) } else { name.ends_with(".json") }).collect();
            files.sort();
            let read = |file: &Path| disk::read_whole(file.parent().expect("a folder")).is_ok();
            (files.into_iter().map(|file| (folder.clone(), file)).collect(), read)
        }
        _ => {
            let read = |file: &Path| {
                let frame = import::read(file.parent().expect("a folder"));
                frame.is_ok_and(|frame| import::convert(&frame, "broken").is_ok())
            };
            let files = ["frame.json", "data.bin"].map(|file| [recording("own", file), recording("ogre-short", file)]);
            (files.concat(), read)
        }
    };
    let name = ["obj", "mtl", "toml", "gltf", "ply", "manifest", "arrays"].into_iter().find(|name| *name == part);
    Kind { name: name.unwrap_or("recordings"), whole, read }
}

/// All files of a folder, over what is there; nothing in it is a folder.
fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(from).expect("a folder") {
        let entry = entry.expect("a file");
        if entry.path().is_file() {
            fs::copy(entry.path(), to.join(entry.file_name())).expect("copied");
        }
    }
}

/// The bytes with one to eight things wrong.
fn mutated(mut bytes: Vec<u8>, others: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    // JSON within binary glTF keeps its stated length, or nothing behind the head is ever looked at.
    let json = glb_json(&bytes);
    for _ in 0..1 + random.below(8) {
        let range = match &json {
            Some(json) if random.below(4) > 0 => json.clone(),
            _ => 0..bytes.len(),
        };
        let length = range.len().min(bytes.len().saturating_sub(range.start));
        if length == 0 {
            break;
        }
        let at = range.start + random.below(length as u32) as usize;
        let grows = json.is_none();
        match random.below(if grows { 9 } else { 4 }) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = random.below(256) as u8,
            2 | 3 => number(&mut bytes, at, grows, random),
            4 => drop(bytes.drain(at..(at + 1 + random.below(40) as usize).min(bytes.len()))),
            5 => bytes.truncate(at),
            6 => {
                let end = (at + 1 + random.below(200) as usize).min(bytes.len());
                let again = bytes[at..end].to_vec();
                bytes.splice(at..at, again);
            }
            7 => {
                let other = &others[random.below(others.len() as u32) as usize];
                let from = random.below(other.len().max(1) as u32) as usize;
                let part = &other[from.min(other.len())..(from + 1 + random.below(120) as usize).min(other.len())];
                bytes.splice(at..at, part.to_vec());
            }
            _ => {
                let from = random.below(bytes.len() as u32) as usize;
                let end = (from + 1 + random.below(60) as usize).min(bytes.len());
                let part = bytes[from..end].to_vec();
                let until = (at + part.len()).min(bytes.len());
                bytes.splice(at..until, part);
            }
        }
        if bytes.is_empty() {
            break;
        }
    }
    bytes
}

/// Writes another number over the next one.
fn number(bytes: &mut Vec<u8>, at: usize, grows: bool, random: &mut Random) {
    const NUMBERS: [&str; 16] = [
        "0",
        "-1",
        "1",
        "255",
        "256",
        "65536",
        "4294967295",
        "2147483648",
        "18446744073709551615",
        "1e9",
        "1e308",
        "-1e38",
        "1e-320",
        "NaN",
        "0.5",
        "99999999",
    ];
    let is_digit = |byte: &u8| byte.is_ascii_digit() || b"-+.eE".contains(byte);
    let Some(start) = bytes[at..].iter().position(u8::is_ascii_digit).map(|offset| at + offset) else { return };
    let end = bytes[start..].iter().position(|byte| !is_digit(byte)).map_or(bytes.len(), |offset| start + offset);
    let other = NUMBERS[random.below(NUMBERS.len() as u32) as usize].as_bytes();
    if grows {
        bytes.splice(start..end, other.iter().copied());
    } else {
        let length = end - start;
        let padded = (0..length).map(|index| other.get(index).copied().unwrap_or(b' '));
        let padded: Vec<u8> = padded.collect();
        bytes[start..end].copy_from_slice(&padded);
    }
}

/// Where a binary glTF's JSON lies.
fn glb_json(bytes: &[u8]) -> Option<std::ops::Range<usize>> {
    let length = u32::from_le_bytes(bytes.get(12..16)?.try_into().ok()?) as usize;
    (bytes.starts_with(b"glTF") && 20 + length <= bytes.len()).then_some(20..20 + length)
}

//! What the window's page does with files: it brings those that a person drops, chooses the one to open, and takes those
//! that were written.

use super::archive::{self, ArchiveError};
use super::memory::{BroughtFile, key, with_store};
use bytes::Bytes;
use std::path::Path;

/// Bytes of all files that a page holds: a module has 4 GiB of memory for them and for all that is made of them.
const MOST_BROUGHT: u64 = 512 << 20;
/// Name of the file by which a folder is a capture.
const MANIFEST: &str = "manifest.json";

/// Why dropped files are not taken, or none is opened.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum BroughtError {
    /// One drop has more bytes than all files may have.
    #[error(
        "these files have {} MiB, and a page holds at most {} MiB: drop fewer or smaller ones, or open them with the \
         program",
        .bytes.div_ceil(1 << 20), .most >> 20
    )]
    TooLarge {
        /// Bytes of the dropped files.
        bytes: u64,
        /// The limit, bytes.
        most: u64,
    },
    /// A path has no name.
    #[error("`{}` names no file: drop files that have names", .0.escape_debug())]
    Nameless(String),
    /// No file can be opened.
    #[error(
        "none of these files can be opened: drop a scene file (.toml) or a model (.obj, .ply, .gltf, .glb) together \
         with the files that it names, or a capture folder"
    )]
    NothingToOpen,
}

/// Puts the files of one drop, by their paths, into memory, from where they are opened like files on disk: `model.obj`
/// is opened as `model.obj`. A file replaces one of the same path that was dropped before; a capture folder replaces
/// all files in its folder, as what is left of another capture would be taken for a part of it. Where all files
/// together have more than 512 MiB, the oldest drops are removed.
///
/// # Errors
/// This drop alone has more, or a path has no name; then nothing is changed.
pub fn bring(files: Vec<(String, Vec<u8>)>) -> Result<(), BroughtError> {
    bring_within(MOST_BROUGHT, files)
}

fn bring_within(most: u64, files: Vec<(String, Vec<u8>)>) -> Result<(), BroughtError> {
    let bytes = files.iter().map(|(_, bytes)| bytes.len() as u64).sum();
    if bytes > most {
        return Err(BroughtError::TooLarge { bytes, most });
    }
    let keyed = files.into_iter().map(|(name, bytes)| match key(Path::new(&name)) {
        key if key.is_empty() => Err(BroughtError::Nameless(name)),
        key => Ok((key, bytes)),
    });
    let keyed = keyed.collect::<Result<Vec<_>, _>>()?;
    with_store(|store| {
        store.drops += 1;
        let captures: Vec<&str> = keyed.iter().filter_map(|(key, _)| capture_folder(key)).collect();
        store.brought.retain(|key, _| !captures.contains(&folder_of(key)));
        let of_drop = store.drops;
        let brought = keyed.into_iter().map(|(key, bytes)| (key, BroughtFile { bytes: bytes.into(), of_drop }));
        store.brought.extend(brought);
        let size = |file: &BroughtFile| file.bytes.len() as u64;
        while store.brought.values().map(size).sum::<u64>() > most {
            let oldest = store.brought.values().map(|file| file.of_drop).min();
            store.brought.retain(|_, file| Some(file.of_drop) != oldest);
        }
    });
    Ok(())
}

/// Returns the files of a drop with those of each `.zip` among them in its place, in a folder of its name unless they lie
/// in one already. A `.zip` within a `.zip` stays as it is.
///
/// # Errors
/// An archive can't be unpacked, or the files of all have together more bytes than a page holds.
pub fn unpacked(files: Vec<(String, Vec<u8>)>) -> Result<Vec<(String, Vec<u8>)>, ArchiveError> {
    unpacked_within(MOST_BROUGHT, files)
}

fn unpacked_within(most: u64, files: Vec<(String, Vec<u8>)>) -> Result<Vec<(String, Vec<u8>)>, ArchiveError> {
    let mut all = Vec::new();
    let mut left = most;
    for (name, bytes) in files {
        let Some(stem) = name.strip_suffix(".zip").or_else(|| name.strip_suffix(".ZIP")) else {
            all.push((name, bytes));
            continue;
        };
        let inside = archive::unpack(&bytes, left)?;
        left = left.saturating_sub(inside.iter().map(|(_, bytes)| bytes.len() as u64).sum());
        let top = |name: &str| name.split_once('/').map(|(top, _)| top.to_owned());
        let first = inside.first().and_then(|(name, _)| top(name));
        let is_in_one = first.is_some() && inside.iter().all(|(name, _)| top(name) == first);
        let place = |name: String| if is_in_one { name } else { format!("{stem}/{name}") };
        all.extend(inside.into_iter().map(|(name, bytes)| (place(name), bytes)));
    }
    Ok(all)
}

/// Checks that files of so many bytes can be brought, before they are read.
///
/// # Errors
/// They have more than all files may have.
pub fn check_size(bytes: u64) -> Result<(), BroughtError> {
    if bytes > MOST_BROUGHT { Err(BroughtError::TooLarge { bytes, most: MOST_BROUGHT }) } else { Ok(()) }
}

/// Returns the path to open of the files of a drop, as [`bring`] stores them: the folder of a capture, else a scene file
/// (`.toml`), a glTF file (`.gltf`, `.glb`), or a bare model (`.obj`, `.ply`). Of several of a kind it is the one
/// nearest to the root, and of these the first by name. Hidden files are not opened. A capture at the root is `.`.
///
/// # Errors
/// None of them can be opened, as where only pictures were dropped. They are brought nevertheless: what names them finds
/// them when it is opened again.
pub fn main_file<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<String, BroughtError> {
    let keys = names.into_iter().map(|name| key(Path::new(name)));
    let candidates = keys.filter_map(|key| Some((kind(&key)?, key.matches('/').count(), key)));
    let (.., first) = candidates.min().ok_or(BroughtError::NothingToOpen)?;
    match capture_folder(&first) {
        Some("") => Ok(".".to_owned()),
        Some(folder) => Ok(folder.to_owned()),
        None => Ok(first),
    }
}

/// Returns the files that were written since the last call, oldest first, each with its path. Only these copies are left
/// of them.
pub fn take_written() -> Vec<(String, Bytes)> {
    with_store(|store| std::mem::take(&mut store.written))
}

/// Returns the rank by which a file is chosen to be opened, from 0; `None` where it can't be.
fn kind(key: &str) -> Option<u8> {
    let path = Path::new(key);
    let name = path.file_name()?.to_str()?;
    // Archives made on a Mac have a hidden file of that ending beside each file.
    if name.starts_with('.') {
        return None;
    }
    if name == MANIFEST {
        return Some(0);
    }
    match path.extension()?.to_ascii_lowercase().to_str()? {
        "toml" => Some(1),
        "gltf" | "glb" => Some(2),
        "obj" | "ply" => Some(3),
        _ => None,
    }
}

fn folder_of(key: &str) -> &str {
    key.rsplit_once('/').map_or("", |(folder, _)| folder)
}

/// Returns the folder of a capture's manifest; `None` for another file.
fn capture_folder(key: &str) -> Option<&str> {
    let folder = folder_of(key);
    (key.strip_prefix(folder)?.trim_start_matches('/') == MANIFEST).then_some(folder)
}

#[cfg(test)]
thread_local! {
    static IS_ON: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
}

/// While it lives, the files of this thread's test are in memory. At first there are none.
#[cfg(test)]
pub struct InMemory;

#[cfg(test)]
impl InMemory {
    /// Begins with the files of a drop.
    pub fn with(files: &[(&str, &[u8])]) -> InMemory {
        with_store(|store| *store = super::memory::MemoryStore::new());
        IS_ON.set(true);
        bring(files.iter().map(|(name, bytes)| ((*name).to_owned(), bytes.to_vec())).collect()).expect("brought");
        InMemory
    }

    /// Returns whether this thread's files are in memory.
    pub fn is_on() -> bool {
        IS_ON.get()
    }
}

#[cfg(test)]
impl Drop for InMemory {
    fn drop(&mut self) {
        IS_ON.set(false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::{exists, read_plain};

    fn drop_of(files: &[(&str, usize)]) -> Vec<(String, Vec<u8>)> {
        files.iter().map(|(name, length)| ((*name).to_owned(), vec![7; *length])).collect()
    }

    fn has(path: &str) -> bool {
        exists(Path::new(path))
    }

    #[test]
    fn the_oldest_drops_go_where_all_are_too_large() {
        let _files = InMemory::with(&[]);
        for drop in [drop_of(&[("a", 2), ("b", 2)]), drop_of(&[("b", 3), ("c", 1)]), drop_of(&[("d", 4)])] {
            bring_within(10, drop).expect("brought");
        }
        assert!(["a", "b", "c", "d"].iter().all(|path| has(path)), "ten bytes");
        bring_within(10, drop_of(&[("e", 1)])).expect("brought");
        assert!(!has("a") && ["b", "c", "d", "e"].iter().all(|path| has(path)), "of the first drop only `a` was left");
        bring_within(10, drop_of(&[("f", 9)])).expect("brought");
        assert!(!has("b") && !has("c") && !has("d") && has("e") && has("f"));
        let refused = bring_within(10, drop_of(&[("g", 6), ("h", 6)])).expect_err("too large");
        assert_eq!(refused, BroughtError::TooLarge { bytes: 12, most: 10 });
        assert!(!has("g") && has("e") && has("f"), "nothing is changed");
    }

    #[test]
    fn a_refused_drop_says_what_to_do() {
        let refused = BroughtError::TooLarge { bytes: (600 << 20) + 1, most: MOST_BROUGHT }.to_string();
        assert!(refused.contains("601 MiB") && refused.contains("512 MiB") && refused.contains("drop fewer"));
        let nameless = bring(drop_of(&[("a.obj", 1), ("..", 1)])).expect_err("no name");
        assert_eq!(nameless, BroughtError::Nameless("..".to_owned()));
    }

    /// The first capture has a plan, and the second none.
    #[test]
    fn a_capture_replaces_what_another_left_in_its_folder() {
        let _files = InMemory::with(&[("manifest.json", b"1"), ("plan.txt", b"1"), ("models/a.obj", b"1")]);
        bring(drop_of(&[("manifest.json", 1), ("a.npy", 1)])).expect("brought");
        assert!(has("manifest.json") && has("a.npy") && has("models/a.obj") && !has("plan.txt"));
        assert_eq!(read_plain(Path::new("manifest.json"), 1).expect("the second"), [7]);
        bring(drop_of(&[("out/manifest.json", 1), ("out/plan.txt", 1)])).expect("brought");
        bring(drop_of(&[("out/manifest.json", 1)])).expect("brought");
        assert!(has("out/manifest.json") && has("a.npy") && !has("out/plan.txt"));
    }

    #[test]
    fn the_file_to_open_is_chosen_by_kind_then_depth_then_name() {
        let chosen = |names: &[&str]| main_file(names.iter().copied());
        let cases: [(&[&str], &str); 9] = [
            (&["a.obj", "b/c/manifest.json", "b/c/scene.toml"], "b/c"),
            (&["scene.toml", "manifest.json"], "."),
            (&["a.obj", "b.gltf", "c/d.toml"], "c/d.toml"),
            (&["a.obj", "b.GLB", "c.bin"], "b.GLB"),
            (&["a.png", "b.mtl", "c.PLY"], "c.PLY"),
            (&["a/b/a.obj", "z/c.obj", "z/b.obj"], "z/b.obj"),
            (&["./b.obj", "/a.obj"], "a.obj"),
            (&["a/._m.obj", "a/m.obj"], "a/m.obj"),
            (&["b.obj", "a/no-manifest.json"], "b.obj"),
        ];
        for (names, expected) in cases {
            assert_eq!(chosen(names), Ok(expected.to_owned()), "{names:?}");
        }
        for names in [&[][..], &["a.png", "b.mtl"], &["toml", ".toml", "a.json"]] {
            assert_eq!(chosen(names), Err(BroughtError::NothingToOpen), "{names:?}");
        }
    }

    #[test]
    fn an_archive_is_opened_in_its_place() {
        let zip = |names: &[&str]| archive::pack(names.iter().map(|name| ((*name).to_owned(), b"x"))).expect("packed");
        let unpacked = |name: &str, names: &[&str]| {
            let files = unpacked(vec![(name.to_owned(), zip(names)), ("b.mtl".to_owned(), vec![1])]).expect("unpacked");
            files.into_iter().map(|(name, _)| name).collect::<Vec<_>>()
        };
        assert_eq!(unpacked("a.zip", &["m.obj", "t/m.png"]), ["a/m.obj", "a/t/m.png", "b.mtl"]);
        assert_eq!(unpacked("a.ZIP", &["out/manifest.json", "out/a.npy"]), ["out/manifest.json", "out/a.npy", "b.mtl"]);
        assert_eq!(unpacked("a.zip", &["in.zip"]), ["a/in.zip", "b.mtl"]);
        assert!(super::unpacked(vec![("a.zip".to_owned(), b"no".to_vec())]).is_err());
        // All archives of a drop share one limit.
        let two = || ["a.zip", "b.zip"].map(|name| (name.to_owned(), zip(&["x", "y"]))).to_vec();
        assert_eq!(unpacked_within(4, two()).expect("four bytes").len(), 4);
        assert!(matches!(unpacked_within(3, two()), Err(ArchiveError::TooLarge { .. })));
        assert!(check_size(MOST_BROUGHT).is_ok() && check_size(MOST_BROUGHT + 1).is_err());
    }
}

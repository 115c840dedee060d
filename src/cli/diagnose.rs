//! `stencilscope diagnose`: where shadows are wrong, why, how to fix it, and the proof.

use super::fix::FixOutput;
use super::options::{FrameOptions, SceneOptions, SceneSubject, Subject, open_session};
use super::progress::with_bar;
use super::{CliError, output};
use crate::capture::{CaptureError, disk};
use crate::diagnosis::{Cause, Diagnosis, Fix, Proof, RegionFound, RegionKind, wrong_pixels};
use crate::picture::Picture;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::session::{CaptureRequest, InjectedFault, RunFrame, Session};
use clap::Args;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Name of the file by which a folder is recognised as a diagnosis.
const DOCUMENT: &str = "diagnosis.json";

#[derive(Debug, Args)]
pub struct DiagnoseArguments {
    /// A built-in scene, a scene file (.toml) or a model (.obj, .ply, .gltf, .glb)
    scene: String,
    #[command(flatten)]
    scene_options: SceneOptions,
    #[command(flatten)]
    frame: FrameOptions,
    /// Machine-readable, to a file or to standard output in place of the text
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    json: Option<Option<String>>,
    /// A folder to make, with pictures of what is wrong and of the frame fixed, the text and the JSON
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// A scene file to write, fixed
    #[arg(long, value_name = "FILE.toml")]
    fix: Option<String>,
    /// Replace the folder of an earlier diagnosis, and the scene file
    #[arg(long)]
    overwrite: bool,
    /// Do not measure which techniques are right for the scene
    #[arg(long)]
    no_techniques: bool,
}

/// Runs the command `diagnose`: finds and prints the causes of wrong pixels of a frame, and writes the files that are
/// asked for. Fails too where pixels are wrong.
pub fn run(arguments: &DiagnoseArguments) -> Result<(), CliError> {
    let DiagnoseArguments { scene_options, frame, output: folder, .. } = arguments;
    frame.refuse_draws("a diagnosis looks at draws by itself")?;
    frame.refuse_external_capture("a diagnosis runs many frames")?;
    let subject = Subject::new(&arguments.scene, scene_options, frame)?;
    let subject = match subject {
        Subject::Folder(frame) if frame.capture.origin.is_some() => return recorded(arguments, &frame),
        subject => subject,
    };
    let SceneSubject { loaded, scene, request } = subject.scene()?;
    let json = arguments.json.as_ref().and_then(Option::as_deref);
    json.map_or(Ok(()), output::check_target)?;
    folder.as_deref().map_or(Ok(()), |folder| check_folder(folder, arguments.overwrite))?;
    let fix =
        arguments.fix.as_deref().map(|file| FixOutput::new(file, &arguments.scene, arguments.overwrite)).transpose()?;

    let mut session = open_session(frame.adapter.as_deref())?;
    let diagnosis = with_bar("diagnosis", &Progress::default(), |progress| {
        session.diagnose(&scene, &request, InjectedFault::None, progress)
    })?;
    let suited = if arguments.no_techniques {
        Vec::new()
    } else {
        with_bar("techniques", &Progress::default(), |progress| session.suited(&scene, request.size, progress))?
    };
    let text = diagnosis.to_text(&suited);
    let document = diagnosis.to_json(&suited).map_err(|error| broken(error.into()))?;
    match &arguments.json {
        Some(_) => output::deliver(&document, json)?,
        None => output::print(&text)?,
    }
    let mut notes = String::new();
    if let Some(folder) = folder {
        let files = files(&mut session, &scene, &request, &diagnosis, &text, &document)?;
        notes += &write_folder(folder, &files)?;
    }
    if let Some(fix) = fix {
        notes += &fix.write(&mut session, &loaded, scene_options.seconds()?, &request, &diagnosis, &suited)?;
    }
    if arguments.json.is_none() {
        output::print(&notes)?;
    }
    verdict(&diagnosis)
}

/// Diagnoses another program's frame and prints or writes the result. Fails where `-o` or `--fix` is given, as there is
/// no scene, and at the end where pixels are wrong or too little was compared.
fn recorded(arguments: &DiagnoseArguments, run: &RunFrame) -> Result<(), CliError> {
    if arguments.output.is_some() || arguments.fix.is_some() {
        let why = "another program drew this frame, and there is no scene to write: leave `-o` and `--fix` out";
        return Err(CliError::Usage(why.to_owned()));
    }
    let json = arguments.json.as_ref().and_then(Option::as_deref);
    json.map_or(Ok(()), output::check_target)?;
    let mut session = open_session(arguments.frame.adapter.as_deref())?;
    let diagnosis = with_bar("diagnosis", &Progress::default(), |progress| session.diagnose_recorded(run, progress))?;
    match &arguments.json {
        Some(_) => output::deliver(&diagnosis.to_json().map_err(|error| broken(error.into()))?, json)?,
        None => output::print(&diagnosis.to_text())?,
    }
    if let Some(because) = &diagnosis.no_verdict {
        return Err(CliError::NoVerdict(because.clone()));
    }
    let because = diagnosis.proven().map_or_else(String::new, |found| format!(", by {}", found.cause.name()));
    match diagnosis.wrong_or_dark() {
        0 => Ok(()),
        pixels => Err(CliError::Wrong { pixels, because }),
    }
}

fn verdict(diagnosis: &Diagnosis) -> Result<(), CliError> {
    if !diagnosis.is_bad() {
        return Ok(());
    }
    let (swimming, wrong): (Vec<&RegionFound>, Vec<&RegionFound>) =
        diagnosis.regions.iter().partition(|region| region.kind == RegionKind::Swims);
    let pixels = |regions: &[&RegionFound]| -> u64 { regions.iter().map(|region| region.pixels).sum() };
    let all = pixels(&wrong) + diagnosis.rest.pixels;
    let mut by_cause: BTreeMap<Cause, u64> = BTreeMap::new();
    for region in wrong {
        let first = region.causes.first().filter(|found| found.proof != Proof::NotIt);
        if let Some(found) = first {
            *by_cause.entry(found.cause).or_default() += region.pixels;
        }
    }
    let most = by_cause.into_iter().max_by_key(|(_, pixels)| *pixels);
    let mut because = most.map_or_else(String::new, |(cause, pixels)| match pixels * 2 > all {
        true => format!(", most of them by {cause}"),
        false => format!(", {pixels} of them by {cause}"),
    });
    if !swimming.is_empty() {
        because += &format!(", and {} right or wrong by chance, by {}", pixels(&swimming), Cause::MapSwims);
    }
    Err(CliError::Wrong { pixels: all, because })
}

/// Fails where the folder exists and is not empty, unless it holds a diagnosis and `overwrite` is true; fails too for
/// paths without a name, such as `.` or `..`.
fn check_folder(folder: &Path, overwrite: bool) -> Result<(), CliError> {
    let name = folder.display();
    let is_empty = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
    if folder.file_name().is_some() && (!folder.exists() || is_empty) {
        Ok(())
    } else if !folder.join(DOCUMENT).is_file() {
        Err(CliError::Usage(format!("{name}: it is there already and holds no diagnosis; choose another name")))
    } else if overwrite {
        Ok(())
    } else {
        Err(CliError::Usage(format!("{name}: there is a diagnosis already; replace it with --overwrite")))
    }
}

type DiagnosisFiles = Vec<(&'static str, Vec<u8>)>;

/// Returns the names and contents of the files of the diagnosis' folder: a picture of the wrong regions, text and JSON.
/// With advice that keeps the picture's size, also a picture of the frame run with that fix.
fn files(
    session: &mut Session,
    scene: &Scene,
    request: &CaptureRequest,
    diagnosis: &Diagnosis,
    text: &str,
    document: &str,
) -> Result<DiagnosisFiles, CliError> {
    let mut pictured = |fix: &Fix| {
        let (capture, _) = session.capture_fixed(scene, request, InjectedFault::None, fix)?;
        Ok::<_, CliError>(session.judged(scene, &capture, &Progress::default())?)
    };
    let png = |picture: &Picture| picture.to_png().map_err(|error| broken(std::io::Error::other(error.to_string())));
    let mut files = vec![("regions.png", png(&diagnosis.shown(&pictured(&Fix::default())?))?)];
    // A larger picture is another one: its pixels can't be compared with the first.
    if let Some(advice) = diagnosis.advice.as_ref().filter(|advice| advice.fix.larger.is_none()) {
        files.push(("mended.png", png(&wrong_pixels(&pictured(&advice.fix)?))?));
    }
    files.push(("diagnosis.txt", text.as_bytes().to_vec()));
    files.push((DOCUMENT, document.as_bytes().to_vec()));
    Ok(files)
}

fn write_folder(folder: &Path, files: &DiagnosisFiles) -> Result<String, CliError> {
    disk::write_folder(folder, |new| {
        let failed = |source| CaptureError::Write { file: new.to_owned(), source };
        files.iter().try_for_each(|(name, bytes)| fs::write(new.join(name), bytes).map_err(failed))
    })?;
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    Ok(format!("{}: {}\n", folder.display(), names.join(", ")))
}

fn broken(source: std::io::Error) -> CliError {
    CliError::Output { path: "the diagnosis".to_owned(), source }
}

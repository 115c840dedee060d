//! The errors that end a command early: one line for standard error and an exit code.

use crate::capture::CaptureError;
use crate::scene::SceneError;
use crate::session::SessionError;
use crate::technique::ChoiceError;

/// Why a command failed; decides the message and the program's exit code.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// A word of the command line is wrong: which, and how to fix it.
    #[error("{0}")]
    Usage(String),
    /// The scene can't be loaded.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// There is no such technique or setting.
    #[error(transparent)]
    Choice(#[from] ChoiceError),
    /// The capture folder can't be written or read.
    #[error(transparent)]
    Capture(#[from] CaptureError),
    /// The frame can't be rendered.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The frame of another program can't be read.
    #[error(transparent)]
    Import(#[from] crate::import::ImportError),
    /// The animation can't be made.
    #[error(transparent)]
    Film(#[from] crate::film::FilmError),
    /// The page can't be made.
    #[error(transparent)]
    Page(#[from] crate::page::PageError),
    /// The report can't be written in the format asked for.
    #[error(transparent)]
    Report(#[from] crate::report::ReportError),
    /// A result can't be written.
    #[error("{path}: can't be written ({source}): choose another file")]
    Output {
        /// The file.
        path: String,
        /// The system's error.
        source: std::io::Error,
    },
    /// The window failed.
    #[error("the window can't be opened: {0}; use `stencilscope capture`")]
    Window(String),
    /// The panels can't be drawn without a window.
    #[cfg(feature = "inspector")]
    #[error(transparent)]
    Panels(#[from] crate::app::AppError),
    /// Histories contradict what the GPU stored.
    #[error(
        "{pixels} of the histories do not make what the GPU stored, by the GPU's rounding or a bug of stencilscope: please report it"
    )]
    WrongHistory {
        /// How many pixels.
        pixels: usize,
    },
    /// Techniques gave unexpected results in a stress case.
    #[error("{count} of the results are unexpected: see the lines marked `!!`")]
    Unexpected {
        /// How many pairs of case and technique.
        count: usize,
    },
    /// An adapter does not draw as it should, for no known cause.
    #[error("unexplained: {what}: please report what the check says")]
    Unexplained {
        /// How much of what, in words.
        what: String,
    },
    /// Two captures that can't be compared.
    #[error(transparent)]
    Difference(#[from] crate::difference::DifferenceError),
    /// Two captures differ.
    #[error("they differ, first in {place}")]
    Different {
        /// The first pass that differs.
        place: String,
    },
    /// A diagnosis has found wrong pixels.
    #[error("{pixels} pixels are wrong{because}")]
    Wrong {
        /// How many pixels.
        pixels: u64,
        /// The first cause, in words.
        because: String,
    },
    /// Too little of a frame could be compared to call it right or wrong: the reason.
    #[error("no verdict: {0}")]
    NoVerdict(String),
    /// The fixed scene can't be written.
    #[error(transparent)]
    Store(#[from] crate::scene::file::StoreError),
    /// A fix can't be made.
    #[error(transparent)]
    Fix(#[from] crate::diagnosis::FixError),
    /// The reader of standard output has closed it.
    #[error("standard output was closed")]
    ClosedOutput,
}

impl CliError {
    /// Returns 1 where the result is bad, 2 for bad input or usage, 3 where no GPU can be used or RenderDoc is not
    /// installed, 4 where there is no verdict, 0 where the reader of the result has closed it.
    pub fn exit_code(&self) -> u8 {
        match self {
            CliError::Session(error) if error.is_missing_adapter() => 3,
            CliError::Film(crate::film::FilmError::Session(error)) if error.is_missing_adapter() => 3,
            CliError::Import(error) if error.is_missing_package() => 3,
            CliError::ClosedOutput => 0,
            CliError::WrongHistory { .. }
            | CliError::Unexpected { .. }
            | CliError::Unexplained { .. }
            | CliError::Different { .. }
            | CliError::Wrong { .. } => 1,
            CliError::NoVerdict(_) | CliError::Session(SessionError::NoLights | SessionError::TooLittleCompared(_)) => {
                4
            }
            _ => 2,
        }
    }

    /// Returns the message for standard error; `None` where nothing is to be printed.
    pub fn line(&self) -> Option<String> {
        match self {
            CliError::ClosedOutput => None,
            error => Some(error.to_string().replace(['\n', '\r'], " ")),
        }
    }
}

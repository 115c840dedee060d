//! What can go wrong on the way from a program or a RenderDoc capture to a frame.

use std::path::PathBuf;

/// Why there is no frame.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// No draw has a depth buffer.
    #[error("the frame has no depth buffer that could be followed: --list shows what it draws")]
    NoDepth,
    /// The picture's depth buffer has several samples a pixel.
    #[error(
        "the frame's depth buffer has {samples} samples a pixel, of which no history can be told: switch the program's \
         anti-aliasing off; --list shows its states"
    )]
    Multisampled {
        /// Samples of a pixel.
        samples: u32,
    },
    /// Every draw is of a kind that is not followed.
    #[error("the frame draws no triangles that could be followed: --list shows what it draws")]
    NothingDrawn,
    /// The interpreter can't be started.
    #[error(
        "`{python}` can't be started ({source}): install python3 and python3-renderdoc, or name an interpreter with --python"
    )]
    NoInterpreter {
        /// Its name.
        python: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// The interpreter has no module `renderdoc`.
    #[error(
        "`{python}` has no module `renderdoc`: install python3-renderdoc, or name the interpreter that has it with \
         --python (Debian: --python /usr/bin/python3)"
    )]
    NoModule {
        /// Its name.
        python: String,
    },
    /// There is no such file, or it can't be read.
    #[error("{}: {reason}; check the path", file.display())]
    NoFile {
        /// Which file.
        file: PathBuf,
        /// Why.
        reason: String,
    },
    /// The file is no capture, or not whole.
    #[error("{}: not a whole RenderDoc capture ({reason}); record the program again", file.display())]
    Corrupt {
        /// Which file.
        file: PathBuf,
        /// RenderDoc's words.
        reason: String,
    },
    /// The file is of another version of RenderDoc.
    #[error(
        "{}: of another version of RenderDoc ({reason}); record it with the version that is installed here, or name an \
         interpreter with the newer module with --python",
        file.display()
    )]
    Version {
        /// Which file.
        file: PathBuf,
        /// RenderDoc's words.
        reason: String,
    },
    /// RenderDoc can't replay the capture here.
    #[error("{}: can't be replayed here ({reason}); {fix}", file.display())]
    Replay {
        /// Which file.
        file: PathBuf,
        /// RenderDoc's words.
        reason: String,
        /// What may help.
        fix: &'static str,
    },
    /// The capture is of an API that is not read.
    #[error("{}: {api} is not read; record a program that draws with Vulkan, OpenGL core or OpenGL ES", file.display())]
    Api {
        /// Which file.
        file: PathBuf,
        /// RenderDoc's name of it.
        api: String,
    },
    /// The process took too long.
    #[error("RenderDoc had no result after {seconds} s, and was ended; give it more with --replay-seconds")]
    TooLong {
        /// How long it had.
        seconds: u64,
    },
    /// The process took too much memory.
    #[error("RenderDoc needed more than {gibibytes} GiB of memory, and was ended; give it more with --memory")]
    TooMuchMemory {
        /// How much it had.
        gibibytes: u64,
    },
    /// The frame is too large to be read.
    #[error("the frame is too large ({what}); record a smaller picture, or a frame with fewer draws")]
    TooLarge {
        /// What there is too much of.
        what: String,
    },
    /// The work was called off.
    #[error("the import was called off")]
    Cancelled,
    /// The script, or RenderDoc in it, has failed.
    #[error("RenderDoc's part failed ({last}); try another capture, and report this one if it opens in RenderDoc")]
    Script {
        /// The last line that it wrote.
        last: String,
    },
    /// The script's process was ended by a signal: RenderDoc, its drivers, or somebody else.
    #[error("RenderDoc's part was ended by signal {signal}{and_said}; run it again, and report this if it stays")]
    Crashed {
        /// Its number: 11 is SIGSEGV, 6 is SIGABRT, 9 is SIGKILL.
        signal: i32,
        /// The last line that it wrote, after a colon.
        and_said: String,
    },
    /// What the script left does not hold together.
    #[error("what RenderDoc's part wrote can't be used ({0}): please report it")]
    Folder(String),
    /// A file that has to be written can't be.
    #[error("{}: can't be written ({source}); choose a place with room that you may write to", file.display())]
    Write {
        /// Which file.
        file: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The program to record is not there.
    #[error("`{program}` can't be run ({reason}): check the name, or give its path")]
    NoProgram {
        /// Its name.
        program: String,
        /// Why.
        reason: String,
    },
    /// The program has ended before the frame.
    #[error("`{program}` ended{how} before frame {frame}{and_said}; {fix}")]
    Died {
        /// Its name.
        program: String,
        /// ` with exit code 1`, ` by signal 11`, or nothing where RenderDoc has kept it.
        how: String,
        /// The frame that was asked for.
        frame: u32,
        /// `: ` and its last line, where it wrote one.
        and_said: String,
        /// What may help.
        fix: &'static str,
    },
    /// The program runs, but the frame does not come.
    #[error("`{program}` had not shown frame {frame} after {seconds} s ({seen}); {fix}")]
    NeverPresented {
        /// Its name.
        program: String,
        /// The frame that was asked for.
        frame: u32,
        /// How long it had.
        seconds: u64,
        /// What it had done until then.
        seen: String,
        /// What may help.
        fix: &'static str,
    },
    /// RenderDoc can't record what the program draws with.
    #[error("`{program}` draws with {api}, which RenderDoc can't record ({reason}); have it use Vulkan or OpenGL core")]
    Unsupported {
        /// Its name.
        program: String,
        /// RenderDoc's name of it.
        api: String,
        /// RenderDoc's words.
        reason: String,
    },
}

impl ImportError {
    /// Is something not installed here that has to be?
    pub fn is_missing_package(&self) -> bool {
        matches!(self, ImportError::NoInterpreter { .. } | ImportError::NoModule { .. })
    }
}

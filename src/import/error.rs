//! The errors on the way from a program or a RenderDoc capture to a frame.

use std::path::PathBuf;

/// The reason why a frame could not be imported.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// No draw has a depth buffer.
    #[error("the frame has no depth buffer that could be followed: --list shows what it draws")]
    NoDepth,
    /// The picture's depth buffer has several samples a pixel, and the recording none of them.
    #[error(
        "the frame's depth buffer has {samples} samples a pixel, of which no history can be told: record it again, or \
         switch the program's anti-aliasing off; --list shows its states"
    )]
    Multisampled {
        /// Number of samples a pixel.
        samples: u32,
    },
    /// Every draw is of a kind that is not followed.
    #[error("the frame draws no triangles that could be followed{because}: --list shows what it draws")]
    NothingDrawn {
        /// Why the first draw is not followed, in brackets after a space; empty where there is none.
        because: String,
    },
    /// Another system than Linux was asked to record.
    #[error(
        "`record` works on Linux only: take the capture in RenderDoc's own window, then `stencilscope import FILE`"
    )]
    RecordsOnLinux,
    /// The interpreter can't be started.
    #[error(
        "`{python}` can't be started ({source}): install python3 and python3-renderdoc, or name an interpreter with --python"
    )]
    NoInterpreter {
        /// Name of the interpreter.
        python: String,
        /// The system's error.
        source: std::io::Error,
    },
    /// The interpreter has no module `renderdoc`.
    #[error(
        "`{python}` has no module `renderdoc`: install python3-renderdoc, or name the interpreter that has it with \
         --python (Debian: --python /usr/bin/python3)"
    )]
    NoModule {
        /// Name of the interpreter.
        python: String,
    },
    /// No interpreter that is usually there has the module `renderdoc`.
    #[error(
        "RenderDoc's Python module is missing (looked for in {tried}): install python3-renderdoc, or name the interpreter \
         that has it with --python"
    )]
    NoModuleFound {
        /// Names of the interpreters, separated by commas.
        tried: String,
    },
    /// There is no such file, or it can't be read.
    #[error("{}: {reason}; check the path", file.display())]
    NoFile {
        /// Path of the file.
        file: PathBuf,
        /// The reason, in words.
        reason: String,
    },
    /// The file is no capture, or not whole.
    #[error("{}: not a whole RenderDoc capture ({reason}); record the program again", file.display())]
    Corrupt {
        /// Path of the file.
        file: PathBuf,
        /// RenderDoc's message.
        reason: String,
    },
    /// The file is of another version of RenderDoc.
    #[error(
        "{}: of another version of RenderDoc ({reason}); record it with the version that is installed here, or name an \
         interpreter with the newer module with --python",
        file.display()
    )]
    Version {
        /// Path of the file.
        file: PathBuf,
        /// RenderDoc's message.
        reason: String,
    },
    /// RenderDoc can't replay the capture here.
    #[error("{}: can't be replayed here ({reason}); {fix}", file.display())]
    Replay {
        /// Path of the file.
        file: PathBuf,
        /// RenderDoc's message.
        reason: String,
        /// What may help, in words.
        fix: &'static str,
    },
    /// The capture is of an API that is not read.
    #[error("{}: {api} is not read; record a program that draws with Vulkan, OpenGL core or OpenGL ES", file.display())]
    Api {
        /// Path of the file.
        file: PathBuf,
        /// RenderDoc's name of the API.
        api: String,
    },
    /// The process took too long.
    #[error("RenderDoc had no result after {seconds} s, and was ended; give it more with --replay-seconds")]
    TooLong {
        /// The limit of time, seconds.
        seconds: u64,
    },
    /// The process took too much memory.
    #[error("RenderDoc needed more than {gibibytes} GiB of memory, and was ended; give it more with --memory")]
    TooMuchMemory {
        /// The limit of memory, GiB.
        gibibytes: u64,
    },
    /// The frame is too large to be read.
    #[error("the frame is too large ({what}); record a smaller picture, or a frame with fewer draws")]
    TooLarge {
        /// What there is too much of, in words.
        what: String,
    },
    /// The work was cancelled.
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
        /// Number of the signal: 11 is SIGSEGV, 6 is SIGABRT, 9 is SIGKILL.
        signal: i32,
        /// The last line that it wrote, after a colon.
        and_said: String,
    },
    /// What the script wrote is inconsistent.
    #[error("what RenderDoc's part wrote can't be used ({0}): please report it")]
    Folder(String),
    /// A file can't be written.
    #[error("{}: can't be written ({source}); choose a place with room that you may write to", file.display())]
    Write {
        /// Path of the file.
        file: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// The program to record does not exist or can't be started.
    #[error("`{program}` can't be run ({reason}): check the name, or give its path")]
    NoProgram {
        /// Name of the program.
        program: String,
        /// The reason, in words.
        reason: String,
    },
    /// The program has ended before the frame.
    #[error("`{program}` ended{how} before frame {frame}{and_said}; {fix}")]
    Died {
        /// Name of the program.
        program: String,
        /// ` with exit code 1`, ` by signal 11`, or nothing where RenderDoc does not report it.
        how: String,
        /// Number of the frame that was asked for.
        frame: u32,
        /// `: ` and its last line, where it wrote one.
        and_said: String,
        /// What may help, in words.
        fix: &'static str,
    },
    /// The program runs, but the frame does not come.
    #[error("`{program}` had not shown frame {frame} after {seconds} s ({seen}); {fix}")]
    NeverPresented {
        /// Name of the program.
        program: String,
        /// Number of the frame that was asked for.
        frame: u32,
        /// The limit of time, seconds.
        seconds: u64,
        /// What the program had done until then, in words.
        seen: String,
        /// What may help, in words.
        fix: &'static str,
    },
    /// RenderDoc can't record what the program draws with.
    #[error("`{program}` draws with {api}, which RenderDoc can't record ({reason}); have it use Vulkan or OpenGL core")]
    Unsupported {
        /// Name of the program.
        program: String,
        /// RenderDoc's name of the API.
        api: String,
        /// RenderDoc's message.
        reason: String,
    },
    /// RenderDoc can't record the program's OpenGL, and on Mesa's zink the program did not come to the frame.
    #[error(
        "`{program}` draws with an OpenGL that RenderDoc can't record ({reason}), and on Mesa's zink, which draws it with \
         Vulkan, {how}{and_said}; {fix}"
    )]
    NotByZink {
        /// Name of the program.
        program: String,
        /// RenderDoc's message about the program's own OpenGL.
        reason: String,
        /// What the program did on zink, in words: `it ended by signal 11`.
        how: String,
        /// `: ` and its last line, where it wrote one.
        and_said: String,
        /// What may help, in words.
        fix: &'static str,
    },
}

impl ImportError {
    /// Returns whether something that is needed is not installed here.
    pub fn is_missing_package(&self) -> bool {
        use ImportError::{NoInterpreter, NoModule, NoModuleFound};
        matches!(self, NoInterpreter { .. } | NoModule { .. } | NoModuleFound { .. })
    }
}

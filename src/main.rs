//! Parses the command line, calls the command, prints the error: nothing else.

use std::io::Write;
use std::process::ExitCode;

fn main() -> ExitCode {
    keep_mesa_quiet();
    match stencilscope::cli::run(std::env::args_os()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            if let Some(line) = error.line() {
                // Standard error may be closed; the exit code still reports the error.
                let _ = writeln!(std::io::stderr(), "stencilscope: {line}");
            }
            ExitCode::from(error.exit_code())
        }
    }
}

/// Where there is no folder for a Wayland display, Mesa's device-select layer has libwayland look for one all the same,
/// which complains on standard error each time that GPUs are listed. The layer sorts them, and we choose by ourselves,
/// so it is turned off, unless an environment variable of the layer or the driver is set.
#[expect(unsafe_code, reason = "no other thread runs yet that could read the environment")]
fn keep_mesa_quiet() {
    let is_set = |name| std::env::var_os(name).is_some();
    let is_chosen = ["NODEVICE_SELECT", "MESA_VK_DEVICE_SELECT", "DRI_PRIME"].into_iter().any(is_set);
    if cfg!(target_os = "linux") && !is_set("XDG_RUNTIME_DIR") && !is_chosen {
        // Sound for the reason above: `main` calls this first.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}

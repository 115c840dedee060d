//! Tests of many frames, in processes of their own.

use std::env;
use std::process::Command;

/// Which part the process was started for.
const PART: &str = "STENCILSCOPE_TEST_PART";

/// Runs a test's `body` for each of `parts`, each in a process of its own, so that whatever a driver retains of
/// thousands of frames ends with it, and so that it can be measured. `test` is the test's own path, as the list of
/// tests has it.
pub fn apart(test: &str, parts: &[&str], body: impl Fn(&str)) {
    if let Ok(part) = env::var(PART) {
        assert!(parts.contains(&part.as_str()), "{test} has no part `{part}`");
        return body(&part);
    }
    for part in parts {
        let program = env::current_exe().expect("the test program");
        let output = Command::new(program).args(["--exact", test, "--nocapture"]).env(PART, part).output();
        let output = output.expect("a process");
        let text = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert!(output.status.success() && text.contains("1 passed"), "{test}, {part}:\n{text}");
    }
}

//! A progress bar on standard error, where that is a terminal.

use crate::progress::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

const REDRAW: Duration = Duration::from_millis(100);

/// Runs `work` while a bar on standard error shows the steps of `progress`, which `work` gets too; returns its result,
/// and removes the bar. `what` is the text beside the bar.
pub fn with_bar<R>(what: &str, progress: &Progress, work: impl FnOnce(&Progress) -> R) -> R {
    let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} %") {
        bar.set_style(style);
    }
    bar.set_message(what.to_owned());
    let (finish, finished) = channel::<()>();
    std::thread::scope(|scope| {
        let bar = &bar;
        scope.spawn(move || {
            while finished.recv_timeout(REDRAW) == Err(RecvTimeoutError::Timeout) {
                let (done, of) = progress.steps();
                bar.set_length(of as u64);
                bar.set_position(done as u64);
            }
            bar.finish_and_clear();
        });
        let result = work(progress);
        drop(finish);
        result
    })
}

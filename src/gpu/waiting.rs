//! Waiting for the GPU, and giving way to the browser meanwhile: what differs here between a native program and a browser.
//!
//! Natively a wait holds up the thread until the GPU is done, so that a future is ready when it is first polled, and
//! long work is shared among threads. In a browser nothing happens while the module runs, on its only thread: a wait
//! returns to the browser, which wakes the future, and long work is done in small parts that give way in between.

use std::ops::Range;

#[cfg(target_family = "wasm")]
pub(super) use browser::{submitted_work, yield_now};
#[cfg(not(target_family = "wasm"))]
pub(super) use native::{submitted_work, yield_now};

/// Returns the parts, from the top down, in which work on `rows` rows of a picture is done, giving way in between:
/// natively a band of the truth for each thread, in a browser the `least` number of rows that is to be done at once.
pub fn row_parts(rows: usize, least: usize) -> impl Iterator<Item = Range<usize>> {
    let most = if cfg!(target_family = "wasm") { least } else { 16 * rayon::current_num_threads() };
    (0..rows).step_by(most).map(move |first| first..rows.min(first + most))
}

#[cfg(not(target_family = "wasm"))]
mod native {
    use crate::gpu::GpuError;
    use wgpu::{Device, PollType, Queue};

    /// Waits until all submitted work is done and the mappings that were asked for are there.
    pub async fn submitted_work(device: &Device, _: &Queue) -> Result<(), GpuError> {
        device.poll(PollType::wait_indefinitely()).map_err(|error| GpuError::Driver(error.to_string()))?;
        Ok(())
    }

    /// Does nothing: other threads go on meanwhile.
    pub async fn yield_now(_: &Queue) {}
}

#[cfg(target_family = "wasm")]
mod browser {
    use crate::gpu::GpuError;
    use std::cell::Cell;
    use std::future::poll_fn;
    use std::sync::{Arc, Mutex, PoisonError};
    use std::task::{Poll, Waker};
    use std::time::Duration;
    use web_time::Instant;
    use wgpu::{Device, Queue};

    /// How long work may go on before it gives way: a quarter of a frame at 60 Hz.
    const LONGEST_TURN: Duration = Duration::from_millis(4);

    thread_local! {
        /// When the browser last had its turn.
        static LAST_YIELD: Cell<Instant> = Cell::new(Instant::now());
    }

    /// Whether the GPU is done, and whom to wake then.
    #[derive(Default)]
    struct Completion {
        is_done: bool,
        waker: Option<Waker>,
    }

    /// Waits until all submitted work is done and the mappings that were asked for are there: WebGPU settles those first
    /// (<https://www.w3.org/TR/webgpu/#promise-ordering>). A lost device counts as done.
    pub async fn submitted_work(_: &Device, queue: &Queue) -> Result<(), GpuError> {
        give_way(queue).await;
        Ok(())
    }

    /// Gives way to the browser if the last time is more than a few milliseconds ago: it may be called often. The GPU's
    /// answer comes in a turn of its own, after the browser has handled events and drawn; timers come later.
    pub async fn yield_now(queue: &Queue) {
        if LAST_YIELD.get().elapsed() >= LONGEST_TURN {
            give_way(queue).await;
        }
    }

    async fn give_way(queue: &Queue) {
        let completion = Arc::new(Mutex::new(Completion::default()));
        let completed = Arc::clone(&completion);
        queue.on_submitted_work_done(move || {
            let mut completion = completed.lock().unwrap_or_else(PoisonError::into_inner);
            completion.is_done = true;
            let waker = completion.waker.take();
            // Whoever is woken may look at once.
            drop(completion);
            waker.into_iter().for_each(Waker::wake);
        });
        poll_fn(|context| {
            let mut completion = completion.lock().unwrap_or_else(PoisonError::into_inner);
            completion.waker = Some(context.waker().clone());
            if completion.is_done { Poll::Ready(()) } else { Poll::Pending }
        })
        .await;
        LAST_YIELD.set(Instant::now());
    }
}

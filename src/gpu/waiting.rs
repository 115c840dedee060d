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

/// Returns the parts, from the top down, in which work on `rows` rows of a picture, or on as many other things, is done,
/// giving way in between: natively a band of the truth for each thread, in a browser the `least` number that is to be
/// done at once.
pub fn work_parts(rows: usize, least: usize) -> impl Iterator<Item = Range<usize>> {
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
    use js_sys::{Array, Function, Reflect};
    use std::cell::{Cell, RefCell};
    use std::collections::VecDeque;
    use std::future::poll_fn;
    use std::rc::Rc;
    use std::sync::{Arc, Mutex, PoisonError};
    use std::task::{Context, Poll, Waker};
    use std::time::Duration;
    use wasm_bindgen::prelude::Closure;
    use wasm_bindgen::{JsCast, JsValue};
    use web_time::Instant;
    use wgpu::{Device, Queue};

    /// How long work may go on before it gives way: a quarter of a frame at 60 Hz.
    const LONGEST_TURN: Duration = Duration::from_millis(4);

    thread_local! {
        /// When the browser last had its turn.
        static LAST_YIELD: Cell<Instant> = Cell::new(Instant::now());
        /// Who waits for their turn, in order: one for each message that is under way.
        static TURNS: RefCell<VecDeque<Rc<RefCell<Completion>>>> = RefCell::default();
        /// Sends such a message; `None` where the browser has no channels.
        static MESSAGES: Option<Messages> = Messages::new();
    }

    /// Whether what is waited for has come, and whom to wake then.
    #[derive(Default)]
    struct Completion {
        is_done: bool,
        waker: Option<Waker>,
    }

    impl Completion {
        /// Marks it as done, and returns whom to wake.
        fn complete(&mut self) -> Option<Waker> {
            self.is_done = true;
            self.waker.take()
        }

        fn poll(&mut self, context: &Context) -> Poll<()> {
            self.waker = Some(context.waker().clone());
            if self.is_done { Poll::Ready(()) } else { Poll::Pending }
        }
    }

    /// A channel to this page itself. A message is a turn of its own: events are handled and the page is drawn before, and it
    /// comes sooner than any timer.
    struct Messages {
        port: JsValue,
        post: Function,
    }

    impl Messages {
        fn new() -> Option<Messages> {
            let get = |of: &JsValue, name: &str| Reflect::get(of, &name.into()).ok();
            let class = get(&js_sys::global(), "MessageChannel")?.dyn_into::<Function>().ok()?;
            let channel = Reflect::construct(&class, &Array::new()).ok()?;
            let (own, port) = (get(&channel, "port1")?, get(&channel, "port2")?);
            let take_turn = Closure::<dyn FnMut()>::new(|| {
                let turn = TURNS.with_borrow_mut(VecDeque::pop_front);
                let waker = turn.and_then(|turn| turn.borrow_mut().complete());
                waker.into_iter().for_each(Waker::wake);
            });
            Reflect::set(&own, &"onmessage".into(), &take_turn.into_js_value()).ok()?;
            let post = get(&port, "postMessage")?.dyn_into::<Function>().ok()?;
            Some(Messages { port, post })
        }

        fn send(&self) -> bool {
            self.post.call1(&self.port, &JsValue::NULL).is_ok()
        }
    }

    /// Waits until all submitted work is done and the mappings that were asked for are there: WebGPU settles those first
    /// (<https://www.w3.org/TR/webgpu/#promise-ordering>). A lost device counts as done.
    pub async fn submitted_work(_: &Device, queue: &Queue) -> Result<(), GpuError> {
        let completion = Arc::new(Mutex::new(Completion::default()));
        let completed = Arc::clone(&completion);
        queue.on_submitted_work_done(move || {
            // Whoever is woken may look at once.
            let waker = completed.lock().unwrap_or_else(PoisonError::into_inner).complete();
            waker.into_iter().for_each(Waker::wake);
        });
        poll_fn(|context| completion.lock().unwrap_or_else(PoisonError::into_inner).poll(context)).await;
        LAST_YIELD.set(Instant::now());
        Ok(())
    }

    /// Gives way to the browser if the last time is more than a few milliseconds ago: it may be called often. It does not
    /// wait for the GPU, which may be busy with the page.
    pub async fn yield_now(_: &Queue) {
        if LAST_YIELD.get().elapsed() < LONGEST_TURN {
            return;
        }
        let turn = Rc::new(RefCell::new(Completion::default()));
        TURNS.with_borrow_mut(|turns| turns.push_back(Rc::clone(&turn)));
        if MESSAGES.with(|messages| messages.as_ref().is_some_and(Messages::send)) {
            poll_fn(|context| turn.borrow_mut().poll(context)).await;
        } else {
            // Without channels the page waits for the end.
            TURNS.with_borrow_mut(|turns| turns.retain(|other| !Rc::ptr_eq(other, &turn)));
        }
        LAST_YIELD.set(Instant::now());
    }
}

//! Work beside the window, and its channel: on threads natively, in turns of the only thread in a browser.
//!
//! The work itself is one async function for both. Natively its thread blocks on it, and what it waits for holds the
//! thread up; in a browser it is polled whenever what it waits for has come.

use std::sync::mpsc::{self, RecvTimeoutError, TryRecvError};
use std::{io, time::Duration};

#[cfg(target_family = "wasm")]
pub use browser::{give_way, go_on};
#[cfg(not(target_family = "wasm"))]
pub use native::give_way;

/// Work that was started.
#[derive(Debug)]
pub struct Task {
    /// Nothing is sent; the channel is closed when the thread ends.
    #[cfg(not(target_family = "wasm"))]
    ended: mpsc::Receiver<()>,
}

/// Starts work: natively on a thread of its own, in a browser in turns with the page.
///
/// # Errors
/// The system gives no thread.
#[cfg(not(target_family = "wasm"))]
pub fn start<F: Future<Output = ()>>(name: &str, work: impl FnOnce() -> F + Send + 'static) -> io::Result<Task> {
    native::start(name, work).map(|ended| Task { ended })
}

/// Starts work: natively on a thread of its own, in a browser in turns with the page.
///
/// # Errors
/// None.
#[cfg(target_family = "wasm")]
pub fn start<F: Future<Output = ()> + 'static>(_: &str, work: impl FnOnce() -> F + 'static) -> io::Result<Task> {
    browser::start(work());
    Ok(Task {})
}

impl Task {
    /// Waits until the work has ended, at most so long. In a browser it returns at once: the page goes with all that runs
    /// in it.
    #[cfg_attr(target_family = "wasm", expect(unused_variables, reason = "nothing is waited for"))]
    pub fn wait(&self, at_most: Duration) {
        #[cfg(not(target_family = "wasm"))]
        let _ = self.ended.recv_timeout(at_most);
    }
}

/// The end of a channel that sends.
#[derive(Debug)]
pub struct ChannelSender<T> {
    /// `None` once it is dropped, so that who waits finds the channel closed.
    queue: Option<mpsc::Sender<T>>,
    #[cfg(target_family = "wasm")]
    waiting: browser::WaitingTask,
}

impl<T> ChannelSender<T> {
    /// Sends; returns false where the other end is gone.
    pub fn send(&self, what: T) -> bool {
        let is_sent = self.queue.as_ref().is_some_and(|queue| queue.send(what).is_ok());
        #[cfg(target_family = "wasm")]
        self.waiting.wake();
        is_sent
    }
}

impl<T> Drop for ChannelSender<T> {
    fn drop(&mut self) {
        self.queue = None;
        #[cfg(target_family = "wasm")]
        self.waiting.wake();
    }
}

/// The end of a channel that receives.
#[derive(Debug)]
pub struct ChannelReceiver<T> {
    queue: mpsc::Receiver<T>,
    #[cfg(target_family = "wasm")]
    waiting: browser::WaitingTask,
}

impl<T> ChannelReceiver<T> {
    /// Receives what was sent already.
    pub fn try_recv(&self) -> Result<T, TryRecvError> {
        self.queue.try_recv()
    }

    /// Waits until something is sent, `within` so long or, with `None`, for as long as there is a sender.
    pub async fn recv(&self, within: Option<Duration>) -> Result<T, RecvTimeoutError> {
        #[cfg(target_family = "wasm")]
        return self.waiting.received(&self.queue, within).await;
        #[cfg(not(target_family = "wasm"))]
        match within {
            Some(within) => self.queue.recv_timeout(within),
            None => self.queue.recv().map_err(|_| RecvTimeoutError::Disconnected),
        }
    }
}

/// Returns both ends of a channel.
pub fn channel<T>() -> (ChannelSender<T>, ChannelReceiver<T>) {
    let (sender, queue) = mpsc::channel();
    #[cfg(target_family = "wasm")]
    let waiting = browser::WaitingTask::default();
    let sender = ChannelSender {
        queue: Some(sender),
        #[cfg(target_family = "wasm")]
        waiting: waiting.clone(),
    };
    let receiver = ChannelReceiver {
        queue,
        #[cfg(target_family = "wasm")]
        waiting,
    };
    (sender, receiver)
}

#[cfg(not(target_family = "wasm"))]
mod native {
    use std::sync::mpsc;
    use std::{io, thread};

    /// Starts a thread, and returns the channel that is closed when it ends.
    pub fn start<F: Future<Output = ()>>(
        name: &str,
        work: impl FnOnce() -> F + Send + 'static,
    ) -> io::Result<mpsc::Receiver<()>> {
        let (alive, ended) = mpsc::channel();
        let run = move || {
            // Dropped last, after everything else.
            let _alive: mpsc::Sender<()> = alive;
            pollster::block_on(work());
        };
        thread::Builder::new().name(name.to_owned()).spawn(run)?;
        Ok(ended)
    }

    /// Does nothing: other threads go on meanwhile.
    pub async fn give_way() {}
}

#[cfg(target_family = "wasm")]
mod browser {
    use std::cell::RefCell;
    use std::future::poll_fn;
    use std::pin::{Pin, pin};
    use std::rc::Rc;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::mpsc::{self, RecvTimeoutError, TryRecvError};
    use std::task::{Context, Poll, Wake, Waker};
    use std::time::Duration;
    use wasm_bindgen_futures::{JsFuture, spawn_local};

    thread_local! {
        /// The work that was started and has not ended; taken out while it is polled.
        static STARTED: RefCell<Vec<StartedWork>> = const { RefCell::new(Vec::new()) };
    }

    struct StartedWork {
        future: Pin<Box<dyn Future<Output = ()>>>,
        turn: Arc<Turn>,
    }

    /// Whether what some work waits for has come: then it is polled once the page's own call has returned, or before.
    #[derive(Default)]
    struct Turn {
        is_due: AtomicBool,
    }

    impl Wake for Turn {
        fn wake(self: Arc<Turn>) {
            if !self.is_due.swap(true, Ordering::Relaxed) {
                spawn_local(async { go_on() });
            }
        }
    }

    /// Starts work, which is first polled once the page's own call has returned.
    pub fn start(work: impl Future<Output = ()> + 'static) {
        let turn = Arc::new(Turn::default());
        STARTED.with_borrow_mut(|all| all.push(StartedWork { future: Box::pin(work), turn: Arc::clone(&turn) }));
        turn.wake();
    }

    /// Polls now what would be polled once the page's own call has returned: what it submits to the GPU comes before what the
    /// call itself will.
    pub fn go_on() {
        let all = STARTED.take();
        let left = all.into_iter().filter_map(|mut work| {
            if !work.turn.is_due.swap(false, Ordering::Relaxed) {
                return Some(work);
            }
            let waker = Waker::from(Arc::clone(&work.turn));
            work.future.as_mut().poll(&mut Context::from_waker(&waker)).is_pending().then_some(work)
        });
        let mut left: Vec<StartedWork> = left.collect();
        // Others were started meanwhile.
        STARTED.with_borrow_mut(|all| all.splice(0..0, left.drain(..)).for_each(drop));
    }

    /// Gives the browser a turn: to handle events and to draw.
    pub async fn give_way() {
        sleep(Duration::ZERO).await;
    }

    async fn sleep(duration: Duration) {
        let milliseconds = i32::try_from(duration.as_millis()).unwrap_or(i32::MAX);
        let timer = js_sys::Promise::new(&mut |wake, _| {
            // Without a timer the wait ends at once.
            let is_set = web_sys::window().is_some_and(|page| {
                page.set_timeout_with_callback_and_timeout_and_arguments_0(&wake, milliseconds).is_ok()
            });
            if !is_set {
                drop(wake.call0(&wasm_bindgen::JsValue::UNDEFINED));
            }
        });
        // A timer is never refused.
        drop(JsFuture::from(timer).await);
    }

    /// The task that waits for a channel.
    #[derive(Debug, Clone, Default)]
    pub struct WaitingTask(Rc<RefCell<Option<Waker>>>);

    impl WaitingTask {
        /// Lets it look again.
        pub fn wake(&self) {
            self.0.take().into_iter().for_each(Waker::wake);
        }

        /// Waits until something is in the queue, `within` so long or for as long as there is a sender.
        pub async fn received<T>(
            &self,
            queue: &mpsc::Receiver<T>,
            within: Option<Duration>,
        ) -> Result<T, RecvTimeoutError> {
            let mut timer = pin!(async {
                match within {
                    Some(within) => sleep(within).await,
                    None => std::future::pending().await,
                }
            });
            poll_fn(|context| {
                match queue.try_recv() {
                    Ok(received) => return Poll::Ready(Ok(received)),
                    Err(TryRecvError::Disconnected) => return Poll::Ready(Err(RecvTimeoutError::Disconnected)),
                    Err(TryRecvError::Empty) => {}
                }
                self.0.replace(Some(context.waker().clone()));
                timer.as_mut().poll(context).map(|()| Err(RecvTimeoutError::Timeout))
            })
            .await
        }
    }
}

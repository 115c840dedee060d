//! Work beside the window, and its channel: on threads natively, in turns of the only thread in a browser.
//!
//! The work itself is one async function for both. Natively its thread blocks on it, and what it waits for holds the
//! thread up; in a browser it is polled whenever what it waits for has come.

#[cfg(target_family = "wasm")]
pub use browser::{Receiver, Sender, Task, channel, give_way, start};
#[cfg(not(target_family = "wasm"))]
pub use native::{Receiver, Sender, Task, channel, give_way, start};

#[cfg(not(target_family = "wasm"))]
mod native {
    use std::sync::mpsc::{self, RecvTimeoutError, TryRecvError};
    use std::{io, thread, time::Duration};

    /// Work that was started on a thread of its own.
    #[derive(Debug)]
    pub struct Task(mpsc::Receiver<()>);

    impl Task {
        /// Waits until the work has ended, at most so long.
        pub fn wait(&self, at_most: Duration) {
            // Nothing is ever sent: the channel is closed when the thread ends.
            let _ = self.0.recv_timeout(at_most);
        }
    }

    /// Starts work on a thread of its own.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn start<F: Future<Output = ()>>(name: &str, work: impl FnOnce() -> F + Send + 'static) -> io::Result<Task> {
        let (alive, ended) = mpsc::channel();
        let run = move || {
            // Dropped last, after everything else.
            let _alive: mpsc::Sender<()> = alive;
            pollster::block_on(work());
        };
        thread::Builder::new().name(name.to_owned()).spawn(run)?;
        Ok(Task(ended))
    }

    /// Does nothing: other threads go on meanwhile.
    pub async fn give_way() {}

    /// The end of a channel that sends.
    #[derive(Debug)]
    pub struct Sender<T>(mpsc::Sender<T>);

    impl<T> Sender<T> {
        /// Sends; returns false where the other end is gone.
        pub fn send(&self, what: T) -> bool {
            self.0.send(what).is_ok()
        }
    }

    /// The end of a channel that receives.
    #[derive(Debug)]
    pub struct Receiver<T>(mpsc::Receiver<T>);

    impl<T> Receiver<T> {
        /// Receives what was sent already.
        pub fn try_recv(&self) -> Result<T, TryRecvError> {
            self.0.try_recv()
        }

        /// Waits until something is sent, `within` so long or, with `None`, for as long as there is a sender.
        pub async fn recv(&self, within: Option<Duration>) -> Result<T, RecvTimeoutError> {
            match within {
                Some(within) => self.0.recv_timeout(within),
                None => self.0.recv().map_err(|_| RecvTimeoutError::Disconnected),
            }
        }
    }

    /// Returns both ends of a channel.
    pub fn channel<T>() -> (Sender<T>, Receiver<T>) {
        let (sender, receiver) = mpsc::channel();
        (Sender(sender), Receiver(receiver))
    }
}

#[cfg(target_family = "wasm")]
mod browser {
    use std::cell::RefCell;
    use std::future::poll_fn;
    use std::pin::pin;
    use std::rc::Rc;
    use std::sync::mpsc::{self, RecvTimeoutError, TryRecvError};
    use std::task::{Poll, Waker};
    use std::{io, time::Duration};
    use wasm_bindgen_futures::JsFuture;

    /// Work that was started.
    #[derive(Debug)]
    pub struct Task;

    impl Task {
        /// Returns at once: the page goes with all that runs in it.
        pub fn wait(&self, _at_most: Duration) {}
    }

    /// Starts work that is done in turns with the page.
    ///
    /// # Errors
    /// None.
    pub fn start<F: Future<Output = ()> + 'static>(_: &str, work: impl FnOnce() -> F + 'static) -> io::Result<Task> {
        wasm_bindgen_futures::spawn_local(async move { work().await });
        Ok(Task)
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

    /// Who waits for the channel.
    type Waiting = Rc<RefCell<Option<Waker>>>;

    /// The end of a channel that sends.
    #[derive(Debug)]
    pub struct Sender<T> {
        /// `None` once it is dropped, so that the one who waits finds the channel closed.
        queue: Option<mpsc::Sender<T>>,
        waiting: Waiting,
    }

    impl<T> Sender<T> {
        /// Sends; returns false where the other end is gone.
        pub fn send(&self, what: T) -> bool {
            let is_sent = self.queue.as_ref().is_some_and(|queue| queue.send(what).is_ok());
            self.waiting.take().into_iter().for_each(Waker::wake);
            is_sent
        }
    }

    impl<T> Drop for Sender<T> {
        fn drop(&mut self) {
            self.queue = None;
            self.waiting.take().into_iter().for_each(Waker::wake);
        }
    }

    /// The end of a channel that receives.
    #[derive(Debug)]
    pub struct Receiver<T> {
        queue: mpsc::Receiver<T>,
        waiting: Waiting,
    }

    impl<T> Receiver<T> {
        /// Receives what was sent already.
        pub fn try_recv(&self) -> Result<T, TryRecvError> {
            self.queue.try_recv()
        }

        /// Waits until something is sent, `within` so long or, with `None`, for as long as there is a sender.
        pub async fn recv(&self, within: Option<Duration>) -> Result<T, RecvTimeoutError> {
            let mut timer = pin!(async {
                match within {
                    Some(within) => sleep(within).await,
                    None => std::future::pending().await,
                }
            });
            poll_fn(|context| {
                match self.queue.try_recv() {
                    Ok(received) => return Poll::Ready(Ok(received)),
                    Err(TryRecvError::Disconnected) => return Poll::Ready(Err(RecvTimeoutError::Disconnected)),
                    Err(TryRecvError::Empty) => {}
                }
                self.waiting.replace(Some(context.waker().clone()));
                timer.as_mut().poll(context).map(|()| Err(RecvTimeoutError::Timeout))
            })
            .await
        }
    }

    /// Returns both ends of a channel.
    pub fn channel<T>() -> (Sender<T>, Receiver<T>) {
        let (sender, receiver) = mpsc::channel();
        let waiting = Waiting::default();
        (Sender { queue: Some(sender), waiting: Rc::clone(&waiting) }, Receiver { queue: receiver, waiting })
    }
}

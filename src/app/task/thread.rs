//! Background thread, or worker of a web page, with progress and cancellation.

use std::io;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::app::platform;
use crate::app::prelude::*;

/// Time between two polls of a background task.
pub(crate) const POLL: Duration = Duration::from_millis(50);
/// Time between two polls of a measurement of time, which drawing would disturb.
pub(crate) const QUIET_POLL: Duration = Duration::from_millis(200);

/// Update of a task.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) enum Update<P, T> {
    /// No update since the last poll.
    None,
    Progress(P),
    /// Result; no more updates follow.
    Done(T),
    /// The thread ended without a result.
    Died,
}

/// Data that a web page can send to a worker, or receive from it.
pub(crate) trait Data: Serialize + DeserializeOwned + Send + 'static {}

impl<T: Serialize + DeserializeOwned + Send + 'static> Data for T {}

/// Work whose request, progress and result are data. It is done in a thread, or in a worker of a web page.
pub(crate) type Work<R, P, T> = fn(R, &Reporter<P, T>) -> T;

/// Work in a background thread that reports its progress as `P` and ends with a `T`. Dropping it cancels it.
pub(crate) struct Task<P, T> {
    receiver: Receiver<Update<P, T>>,
    is_cancelled: Arc<AtomicBool>,
    /// Worker of a web page that does the work.
    worker: Option<platform::work::Worker>,
}

/// Interface of a task for its thread.
pub(crate) struct Reporter<P, T> {
    /// Sends an update; returns `false` if there is no receiver.
    send: Box<dyn Fn(Update<P, T>) -> bool + Send + Sync>,
    is_cancelled: Arc<AtomicBool>,
}

impl<P: Send + 'static, T: Send + 'static> Task<P, T> {
    /// Starts the thread, if the system can start another one.
    pub(crate) fn start(name: &str, work: impl FnOnce(&Reporter<P, T>) -> T + Send + 'static) -> io::Result<Self> {
        let (sender, receiver) = channel();
        let is_cancelled = Arc::new(AtomicBool::new(false));
        let send = Box::new(move |update| sender.send(update).is_ok());
        let reporter = Reporter { send, is_cancelled: is_cancelled.clone() };
        platform::work::start(name, move || {
            let done = work(&reporter);
            (reporter.send)(Update::Done(done));
        })?;
        Ok(Self { receiver, is_cancelled, worker: None })
    }

    /// Returns the next update without waiting for it.
    pub(crate) fn poll(&self) -> Update<P, T> {
        match self.receiver.try_recv() {
            Ok(update) => update,
            Err(TryRecvError::Empty) => Update::None,
            Err(TryRecvError::Disconnected) => Update::Died,
        }
    }

    /// Returns the next update; waits for it if `waits` is `true`.
    pub(crate) fn next(&self, waits: bool) -> Update<P, T> {
        if waits { self.receiver.recv().unwrap_or(Update::Died) } else { self.poll() }
    }
}

impl<P: Data, T: Data> Task<P, T> {
    /// Starts work whose request and results are data.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn run<R: Data>(name: &str, request: R, work: Work<R, P, T>) -> io::Result<Self> {
        Self::start(name, move |reporter| work(request, reporter))
    }

    /// Starts work in a worker, if the browser can start another one. The worker looks it up by its name.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn run<R: Data>(name: &str, request: R, _: Work<R, P, T>) -> io::Result<Self> {
        use platform::work::Received;
        let (sender, receiver) = channel();
        let receive = move |bytes: &[u8]| {
            let Some(update) = platform::work::decode::<Update<P, T>>(bytes) else { return Received::Unreadable };
            let is_done = matches!(update, Update::Done(_));
            let _ = sender.send(update);
            if is_done { Received::Done } else { Received::Progress }
        };
        let worker = platform::work::send(name, &platform::work::encode(&request), receive)?;
        Ok(Self { receiver, is_cancelled: Arc::new(AtomicBool::new(false)), worker: Some(worker) })
    }
}

impl<P, T> Task<P, T> {
    /// Asks the thread to end with the result that it has. A worker ends without a result.
    pub(crate) fn cancel(&self) {
        self.is_cancelled.store(true, Ordering::Relaxed);
        self.worker.iter().for_each(platform::work::end);
    }

    /// Returns `true` if [`Self::cancel`] has been called.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }
}

/// Does work in a worker, and sends its reports and its result to the page.
#[cfg(target_arch = "wasm32")]
pub(crate) fn serve<R: Data, P: Data, T: Data>(request: &[u8], work: Work<R, P, T>) {
    let Some(request) = platform::work::decode::<R>(request) else { return platform::work::post(&[]) };
    let send = Box::new(|update| {
        platform::work::post(&platform::work::encode::<Update<P, T>>(&update));
        true
    });
    let reporter = Reporter { send, is_cancelled: Arc::new(AtomicBool::new(false)) };
    let done = work(request, &reporter);
    (reporter.send)(Update::Done(done));
}

impl<P, T> Drop for Task<P, T> {
    fn drop(&mut self) {
        self.cancel();
    }
}

impl<P, T> Reporter<P, T> {
    /// Reports progress; breaks if the task is cancelled.
    pub(crate) fn report(&self, progress: P) -> ControlFlow<()> {
        // If the task was dropped, there is no receiver.
        let is_received = (self.send)(Update::Progress(progress));
        if is_received && !self.is_cancelled.load(Ordering::Relaxed) {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    }
}

#[cfg(test)]
mod tests {
    use std::thread;

    use super::*;

    /// Starts a task that counts until it is cancelled.
    fn counter() -> Task<u32, u32> {
        Task::start("counter", |reporter| {
            let mut n = 0;
            while reporter.report(n).is_continue() {
                n += 1;
            }
            n
        })
        .unwrap()
    }

    #[test]
    fn a_task_reports_progress_and_ends_with_its_result_when_cancelled() {
        let task = counter();
        let mut last = 0;
        while last < 100 {
            let Update::Progress(n) = task.next(true) else { panic!("it ended") };
            last = n;
        }
        task.cancel();
        let done = loop {
            match task.next(true) {
                Update::Progress(n) => last = n,
                Update::Done(done) => break done,
                Update::None | Update::Died => panic!("no result"),
            }
        };
        assert_eq!(done, last);
        assert!(matches!(task.next(true), Update::Died), "there is more after the end");
    }

    #[test]
    fn a_dropped_task_ends_its_thread() {
        let alive = Arc::new(());
        let there = Arc::downgrade(&alive);
        let task: Task<(), ()> = Task::start("waiting", move |reporter| {
            let _alive = alive;
            while reporter.report(()).is_continue() {
                thread::yield_now();
            }
        })
        .unwrap();
        assert!(matches!(task.next(true), Update::Progress(())));
        drop(task);
        while there.upgrade().is_some() {
            thread::yield_now();
        }
    }

    #[test]
    fn a_task_that_panics_has_died() {
        let task: Task<(), u32> = Task::start("panics", |_| {
            std::panic::panic_any("meant");
        })
        .unwrap();
        assert!(matches!(task.next(true), Update::Died));
    }
}

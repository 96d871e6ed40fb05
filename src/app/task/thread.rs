//! Background thread with progress and cancellation.

use std::io;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::time::Duration;

use crate::app::platform;

/// Time between two polls of a background task.
pub(crate) const POLL: Duration = Duration::from_millis(50);

enum Message<P, T> {
    Progress(P),
    Done(T),
}

/// Update of a task.
#[derive(Debug)]
pub(crate) enum Update<P, T> {
    /// No update since the last poll.
    None,
    /// Progress report.
    Progress(P),
    /// Result; no more updates follow.
    Done(T),
    /// The thread ended without a result.
    Died,
}

/// Work in a background thread that reports its progress as `P` and ends with a `T`. Dropping it cancels it.
#[derive(Debug)]
pub(crate) struct Task<P, T> {
    receiver: Receiver<Message<P, T>>,
    is_cancelled: Arc<AtomicBool>,
}

/// Interface of a task for its thread.
pub(crate) struct Reporter<P, T> {
    sender: Sender<Message<P, T>>,
    is_cancelled: Arc<AtomicBool>,
}

impl<P: Send + 'static, T: Send + 'static> Task<P, T> {
    /// Starts the thread.
    ///
    /// # Errors
    /// The system cannot start another thread.
    pub(crate) fn start(name: &str, work: impl FnOnce(&Reporter<P, T>) -> T + Send + 'static) -> io::Result<Self> {
        let (sender, receiver) = channel();
        let is_cancelled = Arc::new(AtomicBool::new(false));
        let reporter = Reporter { sender, is_cancelled: is_cancelled.clone() };
        platform::work::start(name, move || {
            let done = work(&reporter);
            let _ = reporter.sender.send(Message::Done(done));
        })?;
        Ok(Self { receiver, is_cancelled })
    }

    /// Returns the next update without waiting for it.
    pub(crate) fn poll(&self) -> Update<P, T> {
        match self.receiver.try_recv() {
            Ok(message) => message.into(),
            Err(TryRecvError::Empty) => Update::None,
            Err(TryRecvError::Disconnected) => Update::Died,
        }
    }

    /// Waits for the next update.
    pub(crate) fn wait(&self) -> Update<P, T> {
        self.receiver.recv().map_or(Update::Died, Into::into)
    }
}

impl<P, T> Task<P, T> {
    /// Asks the thread to end with the result that it has.
    pub(crate) fn cancel(&self) {
        self.is_cancelled.store(true, Ordering::Relaxed);
    }
}

impl<P, T> Drop for Task<P, T> {
    fn drop(&mut self) {
        self.cancel();
    }
}

impl<P, T> From<Message<P, T>> for Update<P, T> {
    fn from(message: Message<P, T>) -> Self {
        match message {
            Message::Progress(progress) => Self::Progress(progress),
            Message::Done(done) => Self::Done(done),
        }
    }
}

impl<P, T> Reporter<P, T> {
    /// Reports progress; breaks if the task is cancelled.
    pub(crate) fn report(&self, progress: P) -> ControlFlow<()> {
        // If the task was dropped, there is no receiver.
        let is_received = self.sender.send(Message::Progress(progress)).is_ok();
        if is_received && !self.is_cancelled() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }

    /// Returns `true` if the thread is to end with the result that it has.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
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
            let Update::Progress(n) = task.wait() else { panic!("it ended") };
            last = n;
        }
        task.cancel();
        let done = loop {
            match task.wait() {
                Update::Progress(n) => last = n,
                Update::Done(done) => break done,
                Update::None | Update::Died => panic!("no result"),
            }
        };
        assert_eq!(done, last);
        assert!(matches!(task.wait(), Update::Died), "there is more after the end");
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
        assert!(matches!(task.wait(), Update::Progress(())));
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
        assert!(matches!(task.wait(), Update::Died));
    }
}

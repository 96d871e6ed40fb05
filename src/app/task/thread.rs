//! Work in a thread of its own, beside the window.

use std::io;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;
use std::time::Duration;

/// How often work beside the window is listened to.
pub(crate) const LISTEN: Duration = Duration::from_millis(50);

enum Message<N, T> {
    News(N),
    Done(T),
}

/// What has been heard of a job.
#[derive(Debug)]
pub(crate) enum Heard<N, T> {
    /// Nothing new.
    Nothing,
    /// How far it is.
    News(N),
    /// It has ended with this: nothing more will be heard.
    Done(T),
    /// It has ended without a result.
    Died,
}

/// Work in a thread of its own, which says how far it is by `N` and ends with a `T`. Dropped, it is called off.
#[derive(Debug)]
pub(crate) struct Job<N, T> {
    receiver: Receiver<Message<N, T>>,
    called_off: Arc<AtomicBool>,
}

/// The worker's end of the line.
pub(crate) struct Line<N, T> {
    sender: Sender<Message<N, T>>,
    called_off: Arc<AtomicBool>,
}

impl<N: Send + 'static, T: Send + 'static> Job<N, T> {
    /// Starts to work.
    ///
    /// # Errors
    /// The system has no thread for it.
    pub(crate) fn start(name: &str, work: impl FnOnce(&Line<N, T>) -> T + Send + 'static) -> io::Result<Self> {
        let (sender, receiver) = channel();
        let called_off = Arc::new(AtomicBool::new(false));
        let line = Line { sender, called_off: called_off.clone() };
        thread::Builder::new().name(name.to_owned()).spawn(move || {
            let done = work(&line);
            let _ = line.sender.send(Message::Done(done));
        })?;
        Ok(Self { receiver, called_off })
    }

    /// What it has said since, one message after the other.
    pub(crate) fn hear(&self) -> Heard<N, T> {
        match self.receiver.try_recv() {
            Ok(message) => message.into(),
            Err(TryRecvError::Empty) => Heard::Nothing,
            Err(TryRecvError::Disconnected) => Heard::Died,
        }
    }

    /// What it says next, however long that takes.
    pub(crate) fn wait(&self) -> Heard<N, T> {
        self.receiver.recv().map_or(Heard::Died, Into::into)
    }
}

impl<N, T> Job<N, T> {
    /// Asks it to end with what it has.
    pub(crate) fn call_off(&self) {
        self.called_off.store(true, Ordering::Relaxed);
    }
}

impl<N, T> Drop for Job<N, T> {
    fn drop(&mut self) {
        self.call_off();
    }
}

impl<N, T> From<Message<N, T>> for Heard<N, T> {
    fn from(message: Message<N, T>) -> Self {
        match message {
            Message::News(news) => Self::News(news),
            Message::Done(done) => Self::Done(done),
        }
    }
}

impl<N, T> Line<N, T> {
    /// Says how far it is; breaks where it is to end with what it has.
    pub(crate) fn say(&self, news: N) -> ControlFlow<()> {
        // Nobody listening is as good as being called off.
        let heard = self.sender.send(Message::News(news)).is_ok();
        if heard && !self.is_called_off() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }

    /// Whether it is to end with what it has.
    pub(crate) fn is_called_off(&self) -> bool {
        self.called_off.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts until it is called off.
    fn counter() -> Job<u32, u32> {
        Job::start("counter", |line| {
            let mut n = 0;
            while line.say(n).is_continue() {
                n += 1;
            }
            n
        })
        .unwrap()
    }

    #[test]
    fn a_job_says_how_far_it_is_and_ends_with_what_it_has_when_it_is_called_off() {
        let job = counter();
        let mut last = 0;
        while last < 100 {
            let Heard::News(n) = job.wait() else { panic!("it ended") };
            last = n;
        }
        job.call_off();
        let done = loop {
            match job.wait() {
                Heard::News(n) => last = n,
                Heard::Done(done) => break done,
                Heard::Nothing | Heard::Died => panic!("no result"),
            }
        };
        assert_eq!(done, last);
        assert!(matches!(job.wait(), Heard::Died), "there is more after the end");
    }

    #[test]
    fn a_dropped_job_ends_its_thread() {
        let alive = Arc::new(());
        let there = Arc::downgrade(&alive);
        let job: Job<(), ()> = Job::start("waiting", move |line| {
            let _alive = alive;
            while line.say(()).is_continue() {
                thread::yield_now();
            }
        })
        .unwrap();
        assert!(matches!(job.wait(), Heard::News(())));
        drop(job);
        while there.upgrade().is_some() {
            thread::yield_now();
        }
    }

    #[test]
    fn a_job_that_panics_has_died() {
        let job: Job<(), u32> = Job::start("panics", |_| {
            std::panic::panic_any("meant");
        })
        .unwrap();
        assert!(matches!(job.wait(), Heard::Died));
    }
}

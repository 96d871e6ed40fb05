//! Parallel execution of untimed work on all cores. Timed work must not run at the same time.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use rayon::prelude::*;

use super::progress::{Result, StudyError};
use crate::progress::{Observer, Progress};
use crate::sentence::Sentence;

/// Locks a value, which is whole even if another thread has panicked.
pub fn lock<T>(value: &Mutex<T>) -> MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Processes all items as [`map`], and returns the results, or the error of the first that failed or was cancelled. Reports
/// the progress from the first to the second of two fractions.
pub fn all<T: Sync, R: Send>(
    items: &[T],
    observe: Observer<'_>,
    [from, to]: [f64; 2],
    now: &Sentence,
    work: impl Fn(&T, Observer<'_>) -> Result<R> + Sync,
) -> Result<Vec<R>> {
    let part = |done: usize| done as f64 / items.len() as f64;
    let results = map(items, work, |done| {
        observe(Progress { fraction: (from + (to - from) * part(done)).min(to), now: Some(now) })
    });
    results.into_iter().map(|result| result.ok_or(StudyError::Cancelled)?).collect()
}

/// Processes all items on all cores, and returns the results in order. Items are started in order. `observe` is called
/// on the calling thread with the number of finished items, and can cancel the rest: items not started then give
/// `None`, and the observer of running ones breaks. A web page has no threads: it processes one item after the other.
pub fn map<T: Sync, R: Send>(
    items: &[T],
    work: impl Fn(&T, Observer<'_>) -> R + Sync,
    mut observe: impl FnMut(usize) -> ControlFlow<()>,
) -> Vec<Option<R>> {
    /// Interval of calls of an observer while no item is finished.
    const ASK: Duration = Duration::from_millis(50);
    if cfg!(target_arch = "wasm32") {
        let one = |(done, item)| observe(done).is_continue().then(|| work(item, &|_| ControlFlow::Continue(())));
        return items.iter().enumerate().map(one).collect();
    }
    let cancelled = AtomicBool::new(false);
    let flow = |_: Progress<'_>| match cancelled.load(Ordering::Relaxed) {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let (sender, receiver) = mpsc::channel();
    // Splitting the items among cores does not keep their order: each start takes the next one.
    let next = AtomicUsize::new(0);
    let one = |sender: &mut mpsc::Sender<()>, _: &T| {
        let number = next.fetch_add(1, Ordering::Relaxed);
        let item = items.get(number).filter(|_| !cancelled.load(Ordering::Relaxed));
        let result = item.map(|item| work(item, &flow));
        // Sending fails only if the caller panics.
        let _ = result.as_ref().map(|_| sender.send(()));
        (number, result)
    };
    std::thread::scope(|scope| {
        // Items are split one by one, because they are few and long compared with the overhead of a task.
        let worker = scope.spawn(|| items.par_iter().with_max_len(1).map_with(sender, one).collect());
        let mut done = 0;
        loop {
            if observe(done).is_break() {
                cancelled.store(true, Ordering::Relaxed);
            }
            match receiver.recv_timeout(ASK) {
                Ok(()) => done += 1,
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        let mut results: Vec<_> = worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        results.sort_by_key(|(number, _)| *number);
        results.into_iter().map(|(_, result)| result).collect()
    })
}

#[cfg(test)]
mod tests {
    use std::thread;

    use super::*;

    #[test]
    fn results_come_in_order_and_work_is_cancelled() {
        let items: Vec<u32> = (0..1000).collect();
        let squares = map(&items, |n, _| n * n, |_| ControlFlow::Continue(()));
        assert!(squares.iter().zip(&items).all(|(square, n)| *square == Some(n * n)));
        let slow = |n: &u32, _: Observer<'_>| {
            thread::sleep(Duration::from_millis(1));
            *n
        };
        let after_ten = |done| if done < 10 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
        let some = map(&items, slow, after_ten);
        let done = some.iter().flatten().count();
        assert!(some.len() == items.len() && (10..items.len()).contains(&done), "{done}");
        assert!(some.iter().zip(&items).all(|(result, n)| result.is_none_or(|result| result == *n)));
    }

    #[test]
    fn running_work_is_notified_of_its_cancellation() {
        // Without the flag neither item would end.
        let has_begun = AtomicBool::new(false);
        let until_told = |_: &u32, observe: Observer<'_>| {
            has_begun.store(true, Ordering::Relaxed);
            while observe(Progress::at(0.0)).is_continue() {
                thread::yield_now();
            }
        };
        let once_begun = |_| match has_begun.load(Ordering::Relaxed) {
            false => ControlFlow::Continue(()),
            true => ControlFlow::Break(()),
        };
        assert!(map(&[1, 2], until_told, once_begun).iter().flatten().count() > 0);
    }
}

//! Parallel execution of untimed work on all cores. Timed work must not run at the same time.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use rayon::prelude::*;

use super::progress::{Result, StudyError, within};
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
    shares: [f64; 2],
    now: &Sentence,
    work: impl Fn(&T, Observer<'_>) -> Result<R> + Sync,
) -> Result<Vec<R>> {
    let results = map(items, work, |done| {
        observe(within(Progress { fraction: done as f64 / items.len() as f64, now: Some(now) }, shares))
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
    let mut results: Vec<Option<R>> = items.iter().map(|_| None).collect();
    std::thread::scope(|scope| {
        // A bridge keeps the order of the items: each start takes the next one.
        let bridge = items.iter().enumerate().par_bridge();
        scope.spawn(|| {
            bridge.for_each_with(sender, |sender, (number, item)| {
                if !cancelled.load(Ordering::Relaxed) {
                    // Sending fails only if the caller panics.
                    let _ = sender.send((number, work(item, &flow)));
                }
            });
        });
        let mut done = 0;
        loop {
            if observe(done).is_break() {
                cancelled.store(true, Ordering::Relaxed);
            }
            match receiver.recv_timeout(ASK) {
                Ok((number, result)) => {
                    results[number] = Some(result);
                    done += 1;
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
    });
    results
}

#[cfg(test)]
mod tests {
    use std::thread;

    use super::*;

    fn flow(goes_on: bool) -> ControlFlow<()> {
        if goes_on { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }

    #[test]
    fn results_come_in_order_and_work_is_cancelled() {
        let items: Vec<u32> = (0..1000).collect();
        let square = |n: &u32, _: Observer<'_>| {
            thread::sleep(Duration::from_millis(1));
            n * n
        };
        for (most, finished) in [(items.len() + 1, 1000..=1000), (10, 10..=999)] {
            let squares = map(&items, square, |done| flow(done < most));
            assert!(finished.contains(&squares.iter().flatten().count()) && squares.len() == items.len());
            assert!(squares.iter().zip(&items).all(|(square, n)| square.is_none_or(|square| square == n * n)));
        }
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
        let done = map(&[1, 2], until_told, |_| flow(!has_begun.load(Ordering::Relaxed)));
        assert!(done.iter().flatten().count() > 0);
    }
}

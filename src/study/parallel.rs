//! Work that is not timed, on all cores. Nothing that is timed runs beside it.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use rayon::prelude::*;

/// Time after which an observer is asked again, though nothing is done.
const ASK: Duration = Duration::from_millis(50);

/// Works on all items on all cores, and returns what comes of them in their order. `observe` is told on the calling
/// thread how many are done, and calls the rest off: of items that were not begun then there is `None`.
pub fn map<T: Sync, R: Send>(
    items: &[T],
    work: impl Fn(&T) -> R + Sync,
    mut observe: impl FnMut(usize) -> ControlFlow<()>,
) -> Vec<Option<R>> {
    let called_off = AtomicBool::new(false);
    let (sender, receiver) = mpsc::channel();
    let one = |sender: &mut mpsc::Sender<()>, item: &T| {
        if called_off.load(Ordering::Relaxed) {
            return None;
        }
        let result = work(item);
        // Nobody listens any more only where the caller panics.
        let _ = sender.send(());
        Some(result)
    };
    thread::scope(|scope| {
        let worker = scope.spawn(|| items.par_iter().map_with(sender, one).collect());
        let mut done = 0;
        loop {
            if observe(done).is_break() {
                called_off.store(true, Ordering::Relaxed);
            }
            match receiver.recv_timeout(ASK) {
                Ok(()) => done += 1,
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order_and_work_is_called_off() {
        let items: Vec<u32> = (0..1000).collect();
        let squares = map(&items, |n| n * n, |_| ControlFlow::Continue(()));
        assert!(squares.iter().zip(&items).all(|(square, n)| *square == Some(n * n)));
        let slow = |n: &u32| {
            thread::sleep(Duration::from_millis(1));
            *n
        };
        let after_ten = |done| if done < 10 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
        let some = map(&items, slow, after_ten);
        let done = some.iter().flatten().count();
        assert!(some.len() == items.len() && (10..items.len()).contains(&done), "{done}");
        assert!(some.iter().zip(&items).all(|(result, n)| result.is_none_or(|result| result == *n)));
    }
}

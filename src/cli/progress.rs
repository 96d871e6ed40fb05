//! Commands that take long: how far they are, and that nobody waits for them any more.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::study::Progress;

/// Steps of a full bar.
const FULL: u64 = 10_000;
/// Time from one drawing of the bar to the next: texts are not made to be thrown away.
const REDRAW: Duration = Duration::from_millis(100);
/// What shells see of a process that a second Ctrl-C has ended.
const KILLED_BY_INTERRUPT: i32 = 130;

/// A bar on standard error while it lives, if that is a terminal, and an ear for Ctrl-C (and SIGTERM): the first asks
/// the command to end with what it has, the second ends the process.
#[derive(Debug)]
pub(super) struct Watch {
    bar: ProgressBar,
    began: Instant,
    drawn: Cell<Option<Instant>>,
    called_off: Arc<AtomicBool>,
}

impl Watch {
    /// One a command: the process has one ear for Ctrl-C.
    pub(super) fn new() -> Self {
        let called_off = Arc::new(AtomicBool::new(false));
        let heard = called_off.clone();
        let listening = ctrlc::set_handler(move || {
            if heard.swap(true, Ordering::Relaxed) {
                std::process::exit(KILLED_BY_INTERRUPT);
            }
        });
        if let Err(error) = listening {
            log::warn!("Ctrl-C ends the process without its result: {error}");
        }
        // Not drawn where standard error is no terminal.
        let bar = ProgressBar::new(FULL);
        if let Ok(style) = ProgressStyle::with_template("{msg}  {wide_bar} {percent:>3} %, {eta} left") {
            bar.set_style(style);
        }
        Self { bar, began: Instant::now(), drawn: Cell::new(None), called_off }
    }

    /// Whether the command is to end with what it has.
    pub(super) fn is_called_off(&self) -> bool {
        self.called_off.load(Ordering::Relaxed)
    }

    /// Shows the fraction that is done, 0 to 1, and some words.
    pub(super) fn show(&self, fraction: f64, words: impl FnOnce() -> String) {
        let now = Instant::now();
        let fresh = self.drawn.get().is_some_and(|drawn| now.duration_since(drawn) < REDRAW);
        if self.bar.is_hidden() || fresh {
            return;
        }
        self.drawn.set(Some(now));
        self.bar.set_position((fraction.clamp(0.0, 1.0) * FULL as f64) as u64);
        self.bar.set_message(words());
    }

    /// Shows how far a motion is, s.
    pub(super) fn show_time(&self, time: f64, duration: f64) {
        let rate = || time / self.began.elapsed().as_secs_f64().max(1e-9);
        self.show(time / duration, || format!("{time:.3} of {duration} s, {:.3} s a second", rate()));
    }

    /// Shows how far a study is; calls it off where the command is to end.
    pub(super) fn observe(&self, progress: &Progress<'_>) -> ControlFlow<()> {
        if !progress.now.is_empty() {
            self.show(progress.fraction, || format!("measuring {}", progress.now));
        }
        if self.is_called_off() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

//! Progress of commands that take long, and their cancellation by Ctrl-C or SIGTERM.

use std::io::{IsTerminal as _, Write as _};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::progress::{Observer, Progress};
use crate::simulation::{Simulation, Status};

/// Interval between drawings of the line.
const REDRAW: Duration = Duration::from_millis(100);
/// Time before the line is first drawn.
const LONG: Duration = Duration::from_millis(400);
/// Completed fraction from which on the remaining time is estimated.
const TELLING: f64 = 0.02;
/// Exit code after a second Ctrl-C, as used by shells.
const KILLED_BY_INTERRUPT: i32 = 130;

/// Computes a value with an observer that shows the progress, and cancels as [`Watch`] does.
pub(super) fn watched<T>(compute: impl FnOnce(Observer<'_>) -> T) -> T {
    let watch = Watch::new();
    compute(&|progress| watch.observe(progress))
}

/// Line of progress on standard error, if that is a terminal, and handler of Ctrl-C, SIGTERM and SIGHUP: the first signal
/// makes the command end with its partial result, the second ends the process.
#[derive(Debug)]
pub(super) struct Watch {
    is_on_terminal: bool,
    began: Instant,
    /// Time of the last drawing, and its number of letters.
    drawn: Mutex<(Option<Instant>, usize)>,
    cancelled: Arc<AtomicBool>,
}

impl Watch {
    /// Installs the signal handler. A process can have one watch.
    pub(super) fn new() -> Self {
        let cancelled = Arc::new(AtomicBool::new(false));
        let heard = cancelled.clone();
        let listening = ctrlc::set_handler(move || {
            if heard.swap(true, Ordering::Relaxed) {
                std::process::exit(KILLED_BY_INTERRUPT);
            }
        });
        if let Err(error) = listening {
            log::warn!("Ctrl-C ends the process without its result: {error}");
        }
        let is_on_terminal = std::io::stderr().is_terminal();
        Self { is_on_terminal, began: Instant::now(), drawn: Mutex::default(), cancelled }
    }

    /// Returns `true` if the command should end with its partial result.
    pub(super) fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Shows a message and the completed fraction, 0 to 1.
    fn show(&self, fraction: f64, message: impl FnOnce() -> String) {
        let now = Instant::now();
        let spent = now.duration_since(self.began);
        let mut drawn = self.drawn.lock().unwrap_or_else(PoisonError::into_inner);
        let fresh = drawn.0.is_some_and(|drawn| now.duration_since(drawn) < REDRAW);
        if !self.is_on_terminal || fresh || spent < LONG {
            return;
        }
        let fraction = fraction.clamp(0.0, 1.0);
        let mut line = format!("{}: {:.0} %", message(), 100.0 * fraction);
        if fraction >= TELLING {
            let left = spent.as_secs_f64() * (1.0 / fraction - 1.0);
            line +=
                &if left < 120.0 { format!(", {left:.0} s left") } else { format!(", {:.0} min left", left / 60.0) };
        }
        overwrite(drawn.1, &line);
        *drawn = (Some(now), line.chars().count());
    }

    /// Steps a search or a motion until its status is final, or it is cancelled; calls `after` after each step.
    pub(super) fn run(&self, simulation: &mut Simulation, mut after: impl FnMut(&Simulation)) {
        let (tolerance, duration) = (simulation.scene().solver.tolerance, simulation.scene().dynamics.duration);
        while *simulation.status() == Status::Running && !self.is_cancelled() {
            simulation.step();
            after(simulation);
            let (n, residual, time) = (simulation.iterations(), simulation.residual(), simulation.state().time());
            if simulation.motion().is_some() {
                let rate = || time / self.began.elapsed().as_secs_f64().max(1e-9);
                self.show(time / duration, || format!("{time:.3} of {duration} s, {:.3} s per second", rate()));
            } else {
                // `f64::max` turns NaN into 0.
                let fraction = (residual.ln() / tolerance.ln()).max(0.0);
                self.show(fraction, || format!("iteration {n}, residual {residual:.1e}"));
            }
        }
        simulation.stop();
    }

    /// Shows the progress of a study; returns [`ControlFlow::Break`] if the command should end.
    pub(super) fn observe(&self, progress: Progress<'_>) -> ControlFlow<()> {
        if let Some(now) = progress.now {
            self.show(progress.fraction, || now.to_string());
        }
        if self.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        let drawn = self.drawn.get_mut().unwrap_or_else(PoisonError::into_inner);
        if drawn.0.is_some() {
            overwrite(drawn.1, "");
            overwrite(0, "");
        }
    }
}

/// Writes a line over the last one, which had `letters`. Text that a terminal does not accept is lost.
fn overwrite(letters: usize, line: &str) {
    let _ = write!(std::io::stderr(), "\r{line:letters$}").and_then(|()| std::io::stderr().flush());
}

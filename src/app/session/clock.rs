//! Real-time clock of a motion: the number of time steps that are due depends on the elapsed time, not on the frame
//! rate.

use crate::app::prelude::*;

/// Displayed frames per second for which the costs of motions are stated.
pub(crate) const FRAMES: f64 = 60.0;
/// Largest time for time steps per displayed frame. It is longer than a frame at 60 Hz: where it is used up, fewer
/// frames are displayed.
const WORK: Duration = Duration::from_millis(24);

/// Lowest playback speed, simulated seconds per second.
const SLOWEST: f64 = 1e-6;
/// Longest time between two frames that is made up for, s.
const LONGEST_FRAME: f64 = 0.1;
/// Interval over which the real-time factor is measured, s.
const WINDOW: f64 = 0.5;

/// Formats a speed: as a decimal number, or as a fraction with numerator 1 if it is small.
pub(crate) fn fraction(speed: f64) -> String {
    if speed > 0.0 && speed < 0.1 { format!("1/{:.0}", 1.0 / speed) } else { format!("{speed:.2}") }
}

/// Simulated time that is due, playback speed and measured real-time factor of a motion.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RealTimeClock {
    /// Requested playback speed, simulated seconds per second.
    pub speed: f64,
    /// Time of the last frame, s.
    last: Option<f64>,
    /// Simulated time that is due but not yet computed, s.
    owed: f64,
    /// Start of the current measuring interval, s, and simulated time since then, s.
    counted: (f64, f64),
    /// Measured real-time factor, simulated seconds per second; `None` at rest, and during the first half second.
    pub factor: Option<f64>,
}

/// Makes the time steps that are due, as many as a frame has time for, but at least one, until `make` returns `false`; returns
/// their number.
pub(crate) fn make_steps(due: u32, mut make: impl FnMut() -> bool) -> u32 {
    let begun = Instant::now();
    let mut made = 0;
    while made < due && (made == 0 || begun.elapsed() < WORK) {
        made += 1;
        if !make() {
            break;
        }
    }
    made
}

impl Default for RealTimeClock {
    fn default() -> Self {
        Self { speed: 1.0, last: None, owed: 0.0, counted: (0.0, 0.0), factor: None }
    }
}

impl RealTimeClock {
    /// Sets the requested playback speed, simulated seconds per second.
    pub(crate) fn set_speed(&mut self, speed: f64) {
        self.speed = speed.clamp(SLOWEST, 1.0);
        self.rest();
    }

    /// Returns `true` if the machine is too slow for the requested speed.
    pub(crate) fn lags(&self) -> bool {
        self.factor.is_some_and(|factor| factor < 0.9 * self.speed)
    }

    /// Stops the clock: time that passes until the next frame does not count.
    pub(crate) fn rest(&mut self) {
        self.last = None;
        self.owed = 0.0;
        self.factor = None;
    }

    /// Starts the frame at `now`, s, and returns the number of whole steps of length `step`, s, that are due.
    pub(crate) fn begin(&mut self, now: f64, step: f64) -> u32 {
        match self.last.replace(now) {
            Some(last) => {
                self.owed += (now - last).clamp(0.0, LONGEST_FRAME) * self.speed;
                // The tolerance counts a time that is shorter than a step by rounding only as a step: a frame as long as
                // a step makes one.
                (self.owed / step + 1e-6) as u32
            }
            None => {
                self.counted = (now, 0.0);
                // The first frame makes one step, so that the motion visibly starts.
                1
            }
        }
    }

    /// Ends a frame in which `made` of the steps of length `step`, s, that were due were made. Missing steps are dropped: the
    /// motion slows down on a machine that cannot keep up.
    pub(crate) fn end(&mut self, due: u32, made: u32, step: f64) {
        self.owed = if made < due { 0.0 } else { (self.owed - f64::from(made) * step).max(0.0) };
        let now = self.last.unwrap_or_default();
        self.counted.1 += f64::from(made) * step;
        let (since, simulated) = self.counted;
        if now - since >= WINDOW {
            self.factor = Some(simulated / (now - since));
            self.counted = (now, 0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the number of steps made in four seconds of frames of length `frame`, s.
    fn steps(frame: f64, speed: f64) -> u32 {
        let mut clock = RealTimeClock::default();
        clock.set_speed(speed);
        let frames = (4.0 / frame).round() as u32;
        let mut all = 0;
        for i in 0..=frames {
            let due = clock.begin(f64::from(i) * frame, 1.0 / 60.0);
            clock.end(due, due, 1.0 / 60.0);
            all += due;
        }
        all
    }

    #[test]
    fn the_speed_of_a_motion_does_not_depend_on_the_frame_rate() {
        for frame in [1.0 / 240.0, 1.0 / 144.0, 1.0 / 60.0, 1.0 / 25.0, 0.07] {
            for (speed, expected) in [(1.0, 240), (0.5, 120), (0.125, 30)] {
                let made = steps(frame, speed);
                assert!(made.abs_diff(expected) <= 3, "frames of {frame} s at {speed}: {made} steps, not {expected}");
            }
        }
    }

    #[test]
    fn a_slow_machine_slows_the_motion_and_reports_it() {
        let mut clock = RealTimeClock::default();
        let mut made = 0;
        for i in 0..60 {
            let due = clock.begin(f64::from(i) * 0.05, 0.01);
            assert!(due <= 11, "the debt grows: {due}");
            clock.end(due, due.min(2), 0.01);
            made += due.min(2);
        }
        assert!(made < 125);
        assert!(clock.lags() && clock.factor.is_some_and(|f| (0.3..0.5).contains(&f)), "{clock:?}");
    }

    #[test]
    fn a_frame_after_a_long_absence_makes_up_for_little() {
        let mut clock = RealTimeClock::default();
        let due = clock.begin(0.0, 0.01);
        clock.end(due, due, 0.01);
        assert!(clock.begin(3600.0, 0.01) <= 10);
    }
    #[test]
    fn small_speeds_are_fractions() {
        assert_eq!([1.0, 0.125, 0.0, 1.0 / 41.0].map(fraction), ["1.00", "0.12", "0.00", "1/41"]);
    }
}

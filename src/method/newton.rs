//! Newton's method with the exact tangent A + G: full steps, and around them adaptive load stepping.
//!
//! The first full step from rest is the linear solution, absurdly long, and the second one repairs it: a line search on
//! the energy would refuse both, and is what makes Newton slow here. Where full steps fail the load is put on in parts.
//! Where no part is small enough, line-searched descent takes over: on A + G where that is positive definite, else on
//! A + max(G, 0), which always is.

use nalgebra::Vector2;

use super::certificate::{is_stable, tangent};
use super::frame::{Workspace, timed};
use super::status::{ROUNDING, farthest};
use super::{Frame, FrameError, Method, Occasion, Reason, Verdict};
use crate::assembly::System;
use crate::element::GeometricShare;
use crate::rotation::Rotation;

pub(super) const ABOUT: &str =
    "Newton with the exact tangent A + G: an exact, stable equilibrium in a few solves, also under large loads.";

/// Full steps a load step may take before it must be close. The ordinary count is 5 to 9.
const MAX_STEPS: u32 = 15;
/// A relative residual this small is close: convergence is quadratic from here …
const CLOSE: f64 = 1e-2;
/// … and gets this many steps more.
const LAST_STEPS: u32 = 6;
/// A step this many sizes of the body long is a failure: the linear solution of a slender beam under a moderate load
/// is shorter.
const LONGEST_STEP: f64 = 20.0;
/// Load steps grow by this after a success …
const GROW: f64 = 2.0;
/// … and shrink by this after a failure.
const SHRINK: f64 = 0.35;
/// A load step below this hands over to descent.
const SMALLEST_LOAD_STEP: f64 = 1e-4;
/// Relative residual that will do between load steps: the next step corrects it anyway.
const BETWEEN_LOAD_STEPS: f64 = 1e-3;
/// Steps in a row that do not shorten, after which a load step is given up.
const PATIENCE: u32 = 3;
/// Armijo's constant: the share of the promised decrease that descent insists on.
const SUFFICIENT: f64 = 1e-4;
/// Halvings of a descent step before it is given up.
const MAX_HALVINGS: u32 = 40;

/// The state of the load stepping.
#[derive(Clone, Debug)]
pub struct Newton {
    /// Load factor being solved for.
    target: f64,
    /// The last load factor whose equilibrium was found, and that equilibrium.
    reached: f64,
    base: Vec<Vector2<f64>>,
    load_step: f64,
    load_steps: u32,
    steps: u32,
    shortest: f64,
    worse: u32,
    descends: bool,
    stuck: bool,
    last_step: f64,
}

impl Default for Newton {
    fn default() -> Self {
        Self {
            target: 1.0,
            reached: 0.0,
            base: Vec::new(),
            load_step: 1.0,
            load_steps: 1,
            steps: 0,
            shortest: f64::INFINITY,
            worse: 0,
            descends: false,
            stuck: false,
            last_step: 0.0,
        }
    }
}

impl Newton {
    fn begin_load_step(&mut self) {
        self.target = if self.descends { 1.0 } else { (self.reached + self.load_step).min(1.0) };
        self.load_steps += 1;
        self.steps = 0;
        self.shortest = f64::INFINITY;
        self.worse = 0;
    }

    /// Back to the last equilibrium, with less load; or, if that was hardly any, to descent.
    fn give_up_load_step(&mut self, frame: &mut Frame<'_>) -> Verdict {
        self.restore(frame.u);
        self.load_step = SHRINK * (self.target - self.reached);
        self.descends = self.load_step < SMALLEST_LOAD_STEP;
        self.begin_load_step();
        Verdict::Changed
    }

    /// The last equilibrium: of no load that is the body at rest, wherever the iteration started.
    fn restore(&mut self, u: &mut [Vector2<f64>]) {
        if self.reached == 0.0 {
            self.base.fill(Vector2::zeros());
        }
        if !self.base.is_empty() {
            u.copy_from_slice(&self.base);
        }
    }

    fn solve_descending(&mut self, frame: &mut Frame<'_>) -> Result<(), FrameError> {
        let Workspace { values, factor, .. } = &mut *frame.workspace;
        timed(&mut frame.profile.assemble, || tangent(frame.system, frame.u, frame.r, self.target, values));
        if timed(&mut frame.profile.factorize, || factor.factorize(values)).is_err() {
            timed(&mut frame.profile.assemble, || {
                frame.system.stiffness(frame.r, values);
                frame.system.add_geometric_stiffness(frame.u, frame.r, GeometricShare::Tensile, values);
            });
            timed(&mut frame.profile.factorize, || factor.factorize(values))?;
        }
        frame.solve_for_step()?;
        let mut slope = vec![0.0; frame.workspace.free.len()];
        frame.system.restrict(frame.imbalance, &mut slope);
        let promised: f64 = slope.iter().zip(&frame.workspace.free).map(|(f, d)| f * d).sum();
        let step = frame.workspace.free.clone();
        let start = frame.u.to_vec();
        let mut r = frame.r.to_vec();
        let mut energy = |system: &System, u: &[Vector2<f64>]| {
            system.elements.rotations(u, &mut r);
            system.elements.energy(system.lame, u, &r) + system.load_potential(u, self.target)
        };
        let before = energy(frame.system, &start);
        // Differences of energies below this are rounding.
        let noise = 1e-13 * before.abs();
        let mut share = 1.0;
        for _ in 0..MAX_HALVINGS {
            frame.u.copy_from_slice(&start);
            frame.workspace.free.copy_from_slice(&step);
            frame.advance(share);
            let after = energy(frame.system, frame.u);
            if after.is_finite() && after <= before - SUFFICIENT * share * promised + noise {
                self.last_step = frame.step_length();
                return Ok(());
            }
            share *= 0.5;
        }
        frame.u.copy_from_slice(&start);
        self.stuck = true;
        Ok(())
    }
}

impl Method for Newton {
    fn begin(&mut self, _: Occasion) {
        *self = Self::default();
    }

    fn rotate(&self, system: &System, u: &[Vector2<f64>], r: &mut [Rotation]) {
        system.elements.rotations(u, r);
    }

    fn corotates(&self) -> bool {
        true
    }

    fn load_factor(&self) -> f64 {
        self.target
    }

    fn load_steps(&self) -> u32 {
        self.load_steps
    }

    fn solve(&mut self, frame: &mut Frame<'_>) -> Result<(), FrameError> {
        if self.base.is_empty() {
            self.base = frame.u.to_vec();
        }
        self.steps += 1;
        if self.descends {
            return self.solve_descending(frame);
        }
        let Workspace { values, factor, .. } = &mut *frame.workspace;
        timed(&mut frame.profile.assemble, || tangent(frame.system, frame.u, frame.r, self.target, values));
        timed(&mut frame.profile.factorize, || factor.factorize_symmetric(values));
        frame.solve_for_step()?;
        frame.advance(1.0);
        self.last_step = frame.step_length();
        Ok(())
    }

    fn judge(&mut self, frame: &mut Frame<'_>) -> Verdict {
        let (residual, tolerance) = (frame.residual, frame.goal.tolerance);
        if self.steps == 0 {
            // Nothing solved yet; a state without load is its own equilibrium.
            return if residual <= tolerance && self.target == 1.0 { Verdict::Converged } else { Verdict::Continue };
        }
        let enough = if self.target < 1.0 { tolerance.max(BETWEEN_LOAD_STEPS) } else { tolerance };
        if residual <= enough {
            let (system, workspace) = (frame.system, &mut *frame.workspace);
            let stable =
                timed(&mut frame.profile.factorize, || is_stable(system, frame.u, frame.r, self.target, workspace));
            if self.target == 1.0 && (stable || self.descends) {
                return Verdict::Converged;
            }
            if !stable {
                return self.give_up_load_step(frame);
            }
            self.base.copy_from_slice(frame.u);
            self.reached = self.target;
            self.load_step *= GROW;
            self.begin_load_step();
            return Verdict::Changed;
        }
        if self.stuck {
            return Verdict::Stop(Reason::Stuck);
        }
        if self.descends {
            return Verdict::Continue;
        }
        if self.last_step < self.shortest {
            self.shortest = self.last_step;
            self.worse = 0;
        } else {
            self.worse += 1;
        }
        if self.worse >= PATIENCE && residual < ROUNDING && self.target == 1.0 {
            return Verdict::Stop(Reason::Stagnated(self.worse));
        }
        let nodes = (frame.workspace.free.len() as f64 * 0.5).sqrt();
        let too_long = self.last_step / nodes > LONGEST_STEP * frame.system.size;
        let hopeless =
            self.steps > 1 && (too_long || self.worse >= PATIENCE || farthest(frame.system, frame.u) > LONGEST_STEP);
        let late = self.steps >= MAX_STEPS + if residual < CLOSE { LAST_STEPS } else { 0 };
        if late || hopeless { self.give_up_load_step(frame) } else { Verdict::Continue }
    }

    fn stop(&mut self, u: &mut [Vector2<f64>]) {
        // Descent only ever improves on what it started from.
        if !self.descends {
            self.restore(u);
            self.target = self.reached;
        }
    }

    fn recover(&mut self, frame: &mut Frame<'_>, error: FrameError) -> Verdict {
        if self.descends { Verdict::Stop(Reason::Frame(error)) } else { self.give_up_load_step(frame) }
    }
}

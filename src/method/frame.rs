//! What a frame works with, and the step all methods share.

use std::time::{Duration, Instant};

use nalgebra::Vector2;
use thiserror::Error;

use crate::assembly::System;
use crate::rotation::Rotation;
use crate::solver::{Factor, SolverError};

/// Why a frame produced no new state.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum FrameError {
    /// No factor.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// The solution is not finite.
    #[error("the solution is not a finite number")]
    NotFinite,
}

/// Time spent in each stage of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Profile {
    /// Element maps and polar decompositions.
    pub rotate: Duration,
    /// Stiffness, forces, residual.
    pub assemble: Duration,
    /// Numeric factorization.
    pub factorize: Duration,
    /// Forward and back substitution, update.
    pub solve: Duration,
}

impl Profile {
    /// All stages together.
    #[must_use]
    pub fn total(&self) -> Duration {
        self.rotate + self.assemble + self.factorize + self.solve
    }

    /// Adds another profile, stage by stage.
    pub fn add(&mut self, other: &Self) {
        self.rotate += other.rotate;
        self.assemble += other.assemble;
        self.factorize += other.factorize;
        self.solve += other.solve;
    }
}

/// Runs `work` and adds the time it took to `stage`.
pub(crate) fn timed<T>(stage: &mut Duration, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *stage += start.elapsed();
    result
}

/// Memory a frame works in, made once.
#[derive(Debug)]
pub struct Workspace {
    /// Matrix values in the pattern's order, and the slot where held unknowns go.
    pub values: Vec<f64>,
    /// The factor of those values.
    pub factor: Factor,
    /// A vector over the free unknowns.
    pub free: Vec<f64>,
}

impl Workspace {
    /// Analyses the system's pattern.
    ///
    /// # Errors
    /// [`SolverError::TooLarge`].
    pub fn new(system: &System) -> Result<Self, SolverError> {
        Ok(Self {
            values: vec![0.0; system.pattern.entries() + 1],
            factor: Factor::new(&system.pattern)?,
            free: vec![0.0; system.dofs()],
        })
    }
}

/// When a solve is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Relative residual, for methods that iterate to an equilibrium.
    pub tolerance: f64,
    /// Error as a share of the displacement, for `auto`.
    pub max_error: f64,
}

/// What a method may use and change in one frame.
#[derive(Debug)]
pub struct Frame<'a> {
    /// The equations.
    pub system: &'a System,
    /// Rotations of the current state.
    pub r: &'a [Rotation],
    /// f_ext − f_int of the current state at the present load factor, N.
    pub imbalance: &'a [Vector2<f64>],
    /// Its relative residual.
    pub residual: f64,
    /// When the solve is done.
    pub goal: Goal,
    /// Displacement, m: read and replaced.
    pub u: &'a mut [Vector2<f64>],
    /// Memory.
    pub workspace: &'a mut Workspace,
    /// Where the time goes.
    pub profile: &'a mut Profile,
}

impl Frame<'_> {
    /// u ← u + A⁻¹ (f_ext − f_int), with A = Σ R Ke Rᵀ assembled for the frame's rotations; returns the step's length.
    ///
    /// This is the article's frame A x = f_ext + R K X (eq. 2) with A x taken to the right-hand side: f_int is
    /// A x − R K X. The held unknowns do not move, so eliminating them leaves no term behind (its 24 → 20 → 24), and a
    /// small step keeps its digits next to a large x.
    pub(super) fn step_with_warped_stiffness(&mut self) -> Result<f64, FrameError> {
        let Workspace { values, factor, .. } = &mut *self.workspace;
        timed(&mut self.profile.assemble, || self.system.stiffness(self.r, values));
        timed(&mut self.profile.factorize, || factor.factorize(values))?;
        self.solve_for_step()?;
        self.advance(1.0);
        Ok(self.step_length())
    }

    /// The step K⁻¹ (f_ext − f_int) with the last factor, left in the workspace.
    pub(super) fn solve_for_step(&mut self) -> Result<(), FrameError> {
        let Workspace { factor, free, .. } = &mut *self.workspace;
        timed(&mut self.profile.solve, || {
            self.system.restrict(self.imbalance, free);
            factor.solve_in_place(free);
            if free.iter().all(|v| v.is_finite()) { Ok(()) } else { Err(FrameError::NotFinite) }
        })
    }

    /// u ← u + `share` · step.
    pub(super) fn advance(&mut self, share: f64) {
        let free = &mut self.workspace.free;
        if share != 1.0 {
            free.iter_mut().for_each(|v| *v *= share);
        }
        self.system.add_free(free, self.u);
    }

    /// Length of the step in the workspace.
    pub(super) fn step_length(&self) -> f64 {
        self.workspace.free.iter().map(|v| v * v).sum::<f64>().sqrt()
    }
}

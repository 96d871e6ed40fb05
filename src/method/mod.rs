//! Methods: how a frame turns the current state into the next one.
//!
//! A method decides with which rotations the body is seen and which matrix a frame factorizes. The frame itself is
//! the article's, the same for all ([`Frame`]):
//!
//! rotations(F(x)) → assemble A, f → factorize → solve → update x

use std::time::{Duration, Instant};

use nalgebra::Vector2;
use thiserror::Error;

use crate::assembly::System;
use crate::rotation::Rotation;
use crate::scene::MethodKind;
use crate::solver::{Cholesky, SolverError};

mod linear;
mod warped;

/// An entry of the registry.
#[derive(Clone, Copy)]
pub struct MethodEntry {
    /// What scene files name.
    pub kind: MethodKind,
    /// One sentence for lists and tooltips.
    pub about: &'static str,
    /// The method.
    pub method: &'static dyn Method,
}

const LINEAR: MethodEntry = MethodEntry { kind: MethodKind::Linear, about: linear::ABOUT, method: &linear::Linear };
const WARPED: MethodEntry = MethodEntry { kind: MethodKind::Warped, about: warped::ABOUT, method: &warped::Warped };

/// Every method there is: a file beside this one and a line here.
pub const METHODS: &[MethodEntry] = &[LINEAR, WARPED];

impl MethodKind {
    fn entry(self) -> MethodEntry {
        match self {
            Self::Linear => LINEAR,
            Self::Warped => WARPED,
        }
    }

    /// The method of this name.
    #[must_use]
    pub fn method(self) -> &'static dyn Method {
        self.entry().method
    }

    /// One sentence about it.
    #[must_use]
    pub fn about(self) -> &'static str {
        self.entry().about
    }
}

/// What makes a method.
pub trait Method: Sync {
    /// The rotations with which the state `u` is seen.
    fn rotate(&self, system: &System, u: &[Vector2<f64>], r: &mut [Rotation]);

    /// Whether strains are measured after turning elements back. If not, they are those of linear theory.
    fn corotates(&self) -> bool;

    /// One frame: a new displacement from the current one.
    ///
    /// # Errors
    /// [`FrameError`]; the displacement is unchanged then.
    fn solve(&self, frame: &mut Frame<'_>) -> Result<(), FrameError>;
}

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
    /// Stiffness, force offset, residual.
    pub assemble: Duration,
    /// Numeric Cholesky.
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
    pub cholesky: Cholesky,
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
            cholesky: Cholesky::new(&system.pattern)?,
            free: vec![0.0; system.dofs()],
        })
    }
}

/// What a method may use and change in one frame.
#[derive(Debug)]
pub struct Frame<'a> {
    /// The equations.
    pub system: &'a System,
    /// Rotations of the current state.
    pub r: &'a [Rotation],
    /// f_ext − f_int of the current state, N.
    pub imbalance: &'a [Vector2<f64>],
    /// Displacement, m: read and replaced.
    pub u: &'a mut [Vector2<f64>],
    /// Memory.
    pub workspace: &'a mut Workspace,
    /// Where the time goes.
    pub profile: &'a mut Profile,
}

impl Frame<'_> {
    /// u ← u + A⁻¹ (f_ext − f_int), with A = Σ R Ke Rᵀ assembled for the frame's rotations.
    ///
    /// This is the article's frame A x = f_ext + R K X (eq. 2) with A x taken to the right-hand side: f_int is
    /// A x − R K X. The held unknowns do not move, so eliminating them leaves no term behind (its 24 → 20 → 24), and a
    /// small step keeps its digits next to a large x.
    pub(crate) fn step_with_warped_stiffness(&mut self) -> Result<(), FrameError> {
        let Workspace { values, cholesky, free } = &mut *self.workspace;
        timed(&mut self.profile.assemble, || self.system.stiffness(self.r, values));
        timed(&mut self.profile.factorize, || cholesky.factorize(values))?;
        timed(&mut self.profile.solve, || {
            self.system.restrict(self.imbalance, free);
            cholesky.solve_in_place(free);
            if !free.iter().all(|v| v.is_finite()) {
                return Err(FrameError::NotFinite);
            }
            self.system.add_free(free, self.u);
            Ok(())
        })
    }
}

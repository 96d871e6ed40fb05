//! Report of the decisions of `auto`.

use crate::sentence::{Sentence, displayed, sentence};

/// Decisions of `auto` for the current result.
///
/// ```
/// use warpbeam::{AutoReport, Decision, MethodKind, Scene, Simulation};
///
/// // The deflection P L³/(3 E I) = 4 mm of a beam of 10 m is small enough for linear theory.
/// let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -1.0]).with_method(MethodKind::Auto);
/// let mut beam = Simulation::new(&scene)?;
/// beam.solve();
/// let AutoReport { decision, estimated_error, .. } = beam.solution().auto.ok_or("the method is `auto`")?;
/// assert!(decision == Decision::Linear && estimated_error < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct AutoReport {
    /// Kind of solution.
    pub decision: Decision,
    /// Number of back substitutions.
    pub solves: u32,
    /// Number of factorized matrices.
    pub factorizations: u32,
    /// Estimated error of the method (without that of the mesh) relative to the displacement; after load stepping, the
    /// relative residual. Infinite until the method has finished.
    pub estimated_error: f64,
}

/// Kind of solution that `auto` chose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Decision {
    /// Not finished.
    #[default]
    Undecided,
    /// No solve, because nothing has changed.
    Unchanged,
    /// Linear theory.
    Linear,
    /// Every corotated step reused the factorization of an earlier solve.
    OldFactor,
    /// Corotated steps with a new factor.
    NewFactor,
    /// Load stepping.
    LoadSteps,
}

displayed!(Decision);

impl From<&Decision> for Sentence {
    fn from(decision: &Decision) -> Self {
        match decision {
            Decision::Undecided => sentence!("not decided yet"),
            Decision::Unchanged => sentence!("nothing changed: no solve"),
            Decision::Linear => sentence!("linear theory suffices"),
            Decision::OldFactor => sentence!("old factorization reused"),
            Decision::NewFactor => sentence!("new factorization"),
            Decision::LoadSteps => sentence!("load stepping"),
        }
    }
}

//! Linear theory and its error, estimated by the next terms of the displacement's expansion in the load.

use nalgebra::{Matrix2, Vector2};

use super::AutoReport;
use crate::assembly::{Forces, Kinematics, Matrix, Problem};
use crate::element::Tangent;
use crate::method::IterationError;
use crate::method::certificate::is_stable;
use crate::solver::Factor;
use crate::state::{State, largest};
use crate::step::Iteration;
use crate::timings::timed;

/// Size of the displacement gradient at which the terms of g are computed: smaller values lose digits to rounding,
/// larger ones include higher terms.
const PROBING: f64 = 1e-4;
/// Multiple of the load at which linear theory is checked for stability, so that a slowly growing load needs few
/// checks.
const CHECK_AHEAD: f64 = 2.0;
/// Two linear solutions have the same shape if they differ by at most this fraction, up to a factor.
const SAME_SHAPE: f64 = 0.1;

/// Koiter's asymptotic expansion from rest: with g(u, λ) = λ f_ext(u) − f_int(u) and u(λ) = λ u₁ + λ² u₂ + λ³ u₃ + …, K
/// u₁ = f_ext(0) is the linear solution, K u₂ the quadratic part of g along λ u₁, and K u₃ the cubic part along λ u₁ +
/// λ² u₂.
///
/// The residual force at u₁ would be a poor estimate: on a slender beam its cubic part is large, and cancels against
/// that of u₂.
#[derive(Debug)]
pub(super) struct Expansion {
    /// Factor of K.
    factor: Option<Factor>,
    /// Terms u₁, u₂, u₃.
    terms: [Vec<Vector2<f64>>; 3],
    /// A linear solution up to which the body was found stable.
    checked: Option<Vec<Vector2<f64>>>,
    rest: State,
    probe: State,
    forces: Forces,
    sum: Vec<Vector2<f64>>,
}

impl Expansion {
    /// Allocates the memory of a problem's expansion.
    pub(super) fn new(problem: &Problem) -> Self {
        let rest = problem.system().at_rest();
        let sum = rest.displacement.to_vec();
        let (terms, forces, probe) = ([(); 3].map(|()| sum.clone()), Forces::new(sum.len()), rest.clone());
        Self { factor: None, terms, checked: None, rest, probe, forces, sum }
    }

    /// Returns the expansion without results for another stiffness.
    pub(super) fn without_factor(self) -> Self {
        Self { factor: None, checked: None, ..self }
    }

    /// Returns the linear solution u₁ of the last [`Self::solve`], m.
    pub(super) fn linear(&self) -> &[Vector2<f64>] {
        &self.terms[0]
    }

    /// Solves for all terms; returns the size of u₂ and u₃ relative to u₁, which is the error of u₁.
    pub(super) fn solve(&mut self, it: &mut Iteration<'_>, report: &mut AutoReport) -> Result<f64, IterationError> {
        let problem = it.problem;
        let system = problem.system();
        let Self { factor, terms: [first, second, third], rest, probe, forces, sum, .. } = self;
        let factor = match factor {
            Some(factor) => factor,
            None => {
                let mut matrix = Matrix::new(system.pattern());
                timed(&mut it.timings.linearize, || {
                    problem.linearize(rest, forces, Some((Tangent::WARPED, &mut matrix)));
                });
                let mut new = Factor::new(system.symbolic()?)?;
                timed(&mut it.timings.factorize, || new.factorize(matrix.values()))?;
                report.factorizations += 1;
                factor.insert(new)
            }
        };
        timed(&mut it.timings.linearize, || {
            problem.loads().force(system, &rest.displacement, Kinematics::Linear, 1.0, sum);
        });
        solve_nodal(it, factor, sum, first)?;
        let mut gradient: f64 = 0.0;
        timed(&mut it.timings.linearize, || {
            let lame = problem.material().lame();
            let visit = &mut |_, h: &Matrix2<f64>, _: &Matrix2<f64>| gradient = gradient.max(h.amax());
            system.elements().visit_strains(lame, first, &rest.rotations, visit);
        });
        let scale = PROBING / gradient.max(f64::MIN_POSITIVE);
        second.fill(Vector2::zeros());
        // Half the sum of g(±λ) is its even part, which begins with λ²; half the difference is its odd part. Along λ u₁
        // the linear part of g cancels, along λ u₁ + λ² u₂ the quadratic one too.
        for power in [2, 3] {
            timed(&mut it.timings.linearize, || {
                sum.fill(Vector2::zeros());
                for scale in [scale, -scale] {
                    let terms = first.iter().zip(second.iter());
                    let displacement = probe.displacement.overwrite().iter_mut().zip(terms);
                    displacement.for_each(|(p, (u, v))| *p = u * scale + v * (scale * scale));
                    problem.update_and_linearize(probe, Kinematics::Corotated, forces, None);
                    problem.balance(probe, Kinematics::Corotated, scale, forces);
                    let weight = 0.5 / scale.powi(power);
                    sum.iter_mut().zip(forces.residual()).for_each(|(s, f)| *s += f * weight);
                }
            });
            solve_nodal(it, factor, sum, if power == 2 { &mut *second } else { &mut *third })?;
        }
        report.solves += 3;
        Ok(relative_size(problem, second, first) + relative_size(problem, third, first))
    }

    /// Returns `true` if the body is stable under its linear solution; checked once per shape of the solution.
    pub(super) fn is_stable(&mut self, it: &mut Iteration<'_>, report: &mut AutoReport) -> bool {
        let Self { terms: [first, ..], checked, probe, forces, .. } = self;
        let covered = checked.as_ref().and_then(|checked| same_shape(first, checked, SAME_SHAPE));
        if covered.is_some_and(|scale| (0.0..=1.0).contains(&scale)) {
            return true;
        }
        for ahead in [CHECK_AHEAD, 1.0] {
            probe.displacement.overwrite().iter_mut().zip(first.iter()).for_each(|(p, u)| *p = u * ahead);
            report.factorizations += 1;
            let (problem, workspace) = (it.problem, &mut *it.workspace);
            let stable = timed(&mut it.timings.factorize, || {
                problem.system().update_rotations(probe, Kinematics::Corotated);
                is_stable(problem, probe, ahead, forces, workspace)
            });
            workspace.tangent = None;
            if stable {
                let checked = checked.get_or_insert_default();
                checked.clear();
                checked.extend_from_slice(&probe.displacement);
                return true;
            }
        }
        false
    }
}

/// Computes the displacement for a nodal force with a factor; the free components also remain in the workspace.
pub(super) fn solve_nodal(
    it: &mut Iteration<'_>,
    factor: &mut Factor,
    force: &[Vector2<f64>],
    displacement: &mut [Vector2<f64>],
) -> Result<(), IterationError> {
    let (free, pattern) = (&mut it.workspace.linear.correction, it.problem.system().pattern());
    timed(&mut it.timings.solve, || {
        pattern.restrict(force, free);
        factor.solve_in_place(free);
        displacement.fill(Vector2::zeros());
        pattern.add_free(free, 1.0, displacement);
    });
    if free.iter().all(|v| v.is_finite()) { Ok(()) } else { Err(IterationError::NotFinite) }
}

/// Returns the size of `part` relative to `whole`: the larger of that of the nodal field and that at the first probe.
pub(super) fn relative_size(problem: &Problem, part: &[Vector2<f64>], whole: &[Vector2<f64>]) -> f64 {
    /// Displacement of a probe relative to the body's below which the probe is ignored.
    const AT_REST: f64 = 1e-9;
    let scale = largest(whole);
    if scale == 0.0 {
        return if largest(part) == 0.0 { 0.0 } else { f64::INFINITY };
    }
    let seen = problem.probes().first().map(|p| (p.mean(part).norm(), p.mean(whole).norm()));
    let seen = seen.filter(|(_, whole)| *whole > AT_REST * scale).map_or(0.0, |(part, whole)| part / whole);
    seen.max(largest(part) / scale)
}

/// Returns the factor between two nodal fields if they are equal up to a factor, within `tolerance` relative to the
/// first.
fn same_shape(field: &[Vector2<f64>], other: &[Vector2<f64>], tolerance: f64) -> Option<f64> {
    let along: f64 = field.iter().zip(other).map(|(u, c)| u.dot(c)).sum();
    let of: f64 = other.iter().map(|c| c.norm_squared()).sum();
    let scale = along / of;
    let off = field.iter().zip(other).map(|(u, c)| (u - c * scale).norm()).fold(0.0, f64::max);
    (off <= tolerance * largest(field)).then_some(scale)
}

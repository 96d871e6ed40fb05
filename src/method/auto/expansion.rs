//! Linear theory, and how wrong it is: the next terms of the displacement's expansion in the load.

use nalgebra::Vector2;

use super::Thrift;
use crate::assembly::System;
use crate::method::certificate::is_stable;
use crate::method::frame::timed;
use crate::method::status::largest;
use crate::method::{Frame, FrameError};
use crate::rotation::Rotation;
use crate::solver::Factor;

/// Size of the displacement gradient at which the parts of g are measured: smaller loses digits to rounding, larger lets
/// higher parts in.
const PROBING: f64 = 1e-4;
/// How many times the load linear theory is checked for stability, so that a growing load is not checked every frame.
const CHECK_AHEAD: f64 = 2.0;
/// Two linear solutions are the same up to a factor if they differ by this share.
const SAME_SHAPE: f64 = 0.1;

/// Koiter's asymptotic expansion from rest: with g(u, λ) = λ f_ext(u) − f_int(u) and u(λ) = λ u₁ + λ² u₂ + λ³ u₃ + …,
/// K u₁ = f_ext(0) is the linear solution, K u₂ the quadratic part of g along λ u₁, and K u₃ the cubic part along
/// λ u₁ + λ² u₂.
///
/// The imbalance at u₁ itself would say less: on a slender beam its cubic part is large, and cancels against u₂'s own.
#[derive(Debug, Default)]
pub(super) struct Expansion {
    /// The factor of K.
    factor: Option<Factor>,
    /// The terms u₁, u₂, u₃.
    terms: [Vec<Vector2<f64>>; 3],
    /// A linear solution up to which the body has been found stable.
    checked: Option<Vec<Vector2<f64>>>,
    scratch: Scratch,
}

/// Vectors over nodes and points, made once.
#[derive(Debug, Default)]
struct Scratch {
    rest: Vec<Vector2<f64>>,
    probe: Vec<Vector2<f64>>,
    force: Vec<Vector2<f64>>,
    magnitude: Vec<Vector2<f64>>,
    sum: Vec<Vector2<f64>>,
    r: Vec<Rotation>,
}

impl Expansion {
    /// The linear solution u₁ of the last [`Self::solve`], m.
    pub(super) fn linear(&self) -> &[Vector2<f64>] {
        &self.terms[0]
    }

    /// Solves for all terms; returns the size of u₂ and u₃ over u₁, the error of u₁.
    pub(super) fn solve(&mut self, frame: &mut Frame<'_>, thrift: &mut Thrift) -> Result<f64, FrameError> {
        let system = frame.system;
        let Self { factor, terms: [first, second, third], scratch, .. } = self;
        let Scratch { rest, probe, force, magnitude, sum, r } = scratch;
        for vector in [&mut *first, second, third, rest, probe, force, magnitude, sum] {
            vector.resize(frame.u.len(), Vector2::zeros());
        }
        r.resize(frame.r.len(), Rotation::IDENTITY);
        let factor = match factor {
            Some(factor) => factor,
            None => {
                r.fill(Rotation::IDENTITY);
                let values = &mut frame.workspace.values;
                timed(&mut frame.profile.assemble, || system.stiffness(r, values));
                let mut new = Factor::new(&system.pattern)?;
                timed(&mut frame.profile.factorize, || new.factorize(values))?;
                thrift.factorizations += 1;
                factor.insert(new)
            }
        };
        timed(&mut frame.profile.assemble, || system.external_force(rest, 1.0, force));
        solve_nodal(frame, factor, force, first)?;
        let mut gradient: f64 = 0.0;
        timed(&mut frame.profile.assemble, || {
            r.fill(Rotation::IDENTITY);
            system.elements.visit_strains(first, r, &mut |_, h, _| gradient = gradient.max(h.amax()));
        });
        let scale = PROBING / gradient.max(f64::MIN_POSITIVE);
        second.fill(Vector2::zeros());
        // Of g(±λ) half the sum is the even part, which begins with λ²; half the difference the odd one. Along λ u₁ the
        // linear part of g cancels, along λ u₁ + λ² u₂ the quadratic one too.
        for power in [2, 3] {
            timed(&mut frame.profile.assemble, || {
                sum.fill(Vector2::zeros());
                for scale in [scale, -scale] {
                    let terms = first.iter().zip(second.iter());
                    probe.iter_mut().zip(terms).for_each(|(p, (u, v))| *p = u * scale + v * (scale * scale));
                    let weight = 0.5 / scale.powi(power);
                    system.elements.rotations(probe, r);
                    system.internal_force(probe, r, force, magnitude);
                    sum.iter_mut().zip(force.iter()).for_each(|(s, f)| *s -= f * weight);
                    system.external_force(probe, scale, force);
                    sum.iter_mut().zip(force.iter()).for_each(|(s, f)| *s += f * weight);
                }
            });
            solve_nodal(frame, factor, sum, if power == 2 { &mut *second } else { &mut *third })?;
        }
        thrift.solves += 3;
        Ok(share(system, second, first) + share(system, third, first))
    }

    /// Whether the body is stable under its linear solution; checked once for a shape of it.
    pub(super) fn is_stable(&mut self, frame: &mut Frame<'_>, thrift: &mut Thrift) -> bool {
        let Self { terms: [first, ..], checked, scratch: Scratch { probe, r, .. }, .. } = self;
        let covered = checked.as_ref().is_some_and(|checked| {
            let along: f64 = first.iter().zip(checked).map(|(u, c)| u.dot(c)).sum();
            let of: f64 = checked.iter().map(|c| c.norm_squared()).sum();
            let scale = along / of;
            let off = first.iter().zip(checked).map(|(u, c)| (u - c * scale).norm()).fold(0.0, f64::max);
            (0.0..=1.0).contains(&scale) && off <= SAME_SHAPE * largest(first)
        });
        if covered {
            return true;
        }
        for ahead in [CHECK_AHEAD, 1.0] {
            probe.iter_mut().zip(first.iter()).for_each(|(p, u)| *p = u * ahead);
            let (system, workspace) = (frame.system, &mut *frame.workspace);
            thrift.factorizations += 1;
            let stable = timed(&mut frame.profile.factorize, || {
                system.elements.rotations(probe, r);
                is_stable(system, probe, r, ahead, workspace)
            });
            if stable {
                *checked = Some(probe.clone());
                return true;
            }
        }
        false
    }
}

/// The displacement that a factor gives a nodal force; it stays in the workspace too.
pub(super) fn solve_nodal(
    frame: &mut Frame<'_>,
    factor: &mut Factor,
    force: &[Vector2<f64>],
    displacement: &mut [Vector2<f64>],
) -> Result<(), FrameError> {
    let free = &mut frame.workspace.free;
    timed(&mut frame.profile.solve, || {
        frame.system.restrict(force, free);
        factor.solve_in_place(free);
        displacement.fill(Vector2::zeros());
        frame.system.add_free(free, displacement);
    });
    if free.iter().all(|v| v.is_finite()) { Ok(()) } else { Err(FrameError::NotFinite) }
}

/// The size of `part` over that of `whole`: of the field, or of what the first probe sees of it if that is more.
pub(super) fn share(system: &System, part: &[Vector2<f64>], whole: &[Vector2<f64>]) -> f64 {
    /// A probe that moves less than this share of the body does not measure it.
    const AT_REST: f64 = 1e-9;
    let scale = largest(whole);
    if scale == 0.0 {
        return if largest(part) == 0.0 { 0.0 } else { f64::INFINITY };
    }
    let seen = system.probes.first().map(|p| (p.mean(part).norm(), p.mean(whole).norm()));
    let seen = seen.filter(|(_, whole)| *whole > AT_REST * scale).map_or(0.0, |(part, whole)| part / whole);
    seen.max(largest(part) / scale)
}

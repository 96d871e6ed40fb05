//! Claims: the statements that results make, each with the numbers that prove it. Commands, reports and the window take
//! their words from here; `tests/physics/claims.rs` recomputes every kind by other means.

use super::load_path::{LoadPath, PathSummary};
use super::prelude::*;
use super::reference::Reference;
use super::trade::Study;
use super::{LoadCurve, Sample};
use crate::method::{Bifurcation, Drive, Jump, PathEndReason};
use crate::simulation::probe_results;

/// Statement of a result, with the numbers that prove it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Claim {
    /// Kind in JSON, such as `buckles`.
    pub id: &'static str,
    /// Numbers that prove it, such as the load factor at which the body buckles.
    pub numbers: Vec<f64>,
    /// Statement in words.
    pub text: Sentence,
}

displayed!(Claim);

impl From<&Claim> for Sentence {
    fn from(claim: &Claim) -> Self {
        claim.text.clone()
    }
}

impl Claim {
    fn new(id: &'static str, numbers: &[f64], text: impl Into<Sentence>) -> Self {
        Self { id, numbers: numbers.to_vec(), text: text.into() }
    }

    /// Returns the claims of the result of a simulation at rest; none of a motion. `rho` is the spectral radius of the
    /// warped iteration at its equilibrium, `path` its path from rest, and `reference` its reference solution, each if
    /// known.
    pub fn of_result(
        simulation: &Simulation,
        rho: Option<f64>,
        path: Option<&PathSummary>,
        reference: Option<&Reference>,
    ) -> Vec<Self> {
        let Some(search) = simulation.equilibrium() else { return Vec::new() };
        let (status, solver) = (simulation.status(), &simulation.scene().solver);
        let failed = || Self::new("failed", &[], status.failure_sentence().unwrap_or_default());
        let mut claims = Vec::new();
        match status {
            Status::Converged => {
                claims.push(Self::converged(simulation.residual(), solver.tolerance, search.residual_floor()));
            }
            Status::NotConverged(_) => {
                claims.push(failed());
                let factor = search.load_factor();
                if factor < 1.0 {
                    let (part, drive) = (load_percent(factor), Drive::of(simulation.problem()));
                    let text = format!("the numbers below are those of the equilibrium at {part} of {drive}");
                    claims.push(Self::new("part", &[factor], text));
                }
            }
            Status::Diverged(_) => {
                claims.push(failed());
                if solver.method != MethodKind::Newton {
                    let text = "the last state of a diverging iteration has no meaning; solve with method newton";
                    claims.push(Self::new("helps", &[], text));
                }
                return claims;
            }
            _ => {}
        }
        if let Some(path) = path {
            claims.extend(path.claims());
        }
        let stable = search.certificate().and_then(|certificate| certificate.stable);
        if let Some(stable) = stable.filter(|_| *status == Status::Converged) {
            let text = match stable {
                true => {
                    "stable: after a small push the body returns (the exact tangent stiffness is positive definite)"
                }
                false => {
                    "unstable: after a small push the body moves away (the exact tangent stiffness is not positive \
                     definite)"
                }
            };
            claims.push(Self::new(if stable { "stable" } else { "unstable" }, &[], text));
        }
        let has_buckled = path.is_some_and(|path| path.buckling.is_some() && path.elsewhere.is_none());
        if has_buckled && stable == Some(false) {
            let text = "a small force across the body, as an imperfection, leads to a stable equilibrium";
            claims.push(Self::new("helps", &[], text));
        }
        claims.extend(rho.map(|rho| {
            let converged = solver.method == MethodKind::Warped && *status == Status::Converged;
            let text = match rho_text(rho) {
                disturbance if converged && rho > 1.0 => sentence!(
                    "%{disturbance}; it converged because nothing disturbs it, as in a bar loaded along its axis",
                    disturbance
                ),
                disturbance => disturbance,
            };
            Self::new("disturbance", &[rho], text)
        }));
        if let Some(reference) = reference {
            let probes = probe_results(simulation.problem(), simulation.state());
            claims.extend(probes.iter().zip(reference.probes()).filter_map(|(probe, known)| {
                let percent = known.as_ref()?.error_percent(probe)?;
                let text = format!("error of {} {percent:.3} %, against {}", probe.name, known.as_ref()?);
                Some(Self::new("error", &[percent], text))
            }));
            claims.extend(reference.beam_off_by_percent.map(Self::beam_theory));
        }
        claims
    }

    /// Returns the claim that the forces balance, under `auto` so well that the error is within
    /// `solver.max_error_percent`. `floor` is the bound of the residual's rounding error, if the solve ended within it above
    /// the tolerance.
    fn converged(residual: f64, tolerance: f64, floor: Option<f64>) -> Self {
        let [shown, asked] = [number(two_digits(residual)), number(tolerance)];
        let text = match floor {
            Some(floor) => sentence!(
                "the forces balance to machine precision: %{rounding}",
                rounding = floor_text(floor, tolerance)
            ),
            None if residual > tolerance => sentence!(
                "the solve ends within solver.max_error_percent: the relative residual is %{residual}, above the \
                 tolerance of %{asked}",
                residual = shown,
                asked
            ),
            None => sentence!(
                "the forces balance: the relative residual is %{residual}, the tolerance is %{asked}",
                residual = shown,
                asked
            ),
        };
        Self::new("converged", &[residual, tolerance], text)
    }

    /// Returns the claim that the exact beam differs from the fine solution that is the reference.
    pub(crate) fn beam_theory(off_by_percent: f64) -> Self {
        let text = sentence!("beam theory differs by %{off}", off = percent(off_by_percent));
        Self::new("beam_theory", &[off_by_percent], text)
    }

    /// Returns the claim that the path from rest jumps.
    fn jumps(Jump { factor, distance }: Jump, drive: &Drive) -> Self {
        let percent = load_percent(factor);
        let text = match distance.map(|distance| engineering(distance, "m")) {
            None => sentence!(
                "limit point at %{percent} of %{drive}: no stable equilibrium was found beyond it",
                percent,
                drive
            ),
            Some(distance) => sentence!(
                "jumped: beyond the limit point at %{percent} of %{drive}, the next equilibrium is %{distance} away",
                percent,
                drive,
                distance
            ),
        };
        Self::new("jumps", &[factor], text)
    }

    /// Returns the claim that the path from rest loses or regains stability where another path crosses it.
    fn buckles(Bifurcation { factor, unstable_modes }: Bifurcation, drive: &Drive) -> Self {
        let percent = load_percent(factor);
        let text = match unstable_modes {
            [0, _] => sentence!("buckles at %{percent} of %{drive}: beyond it, this path is unstable", percent, drive),
            [_, 0] => sentence!("stable again above %{percent} of %{drive}", percent, drive),
            [_, 1] => sentence!("1 mode is unstable above %{percent} of %{drive}", percent, drive),
            [_, n] => sentence!("%{n} modes are unstable above %{percent} of %{drive}", n, percent, drive),
        };
        Self::new("buckles", &[factor], text)
    }

    /// Returns the claims of a load path in its order: the largest reaction of its moving support, which is the limit load
    /// of a force in place of the motion, bifurcations, the jump, and its end.
    pub fn of_path(scene: &Scene, path: &LoadPath) -> Vec<Self> {
        let limit = path.limit_under_force().and_then(|state| {
            let (pair, rotates) = (path.driven_pair(scene, state)?, path.rotates(scene));
            let ([motion, reaction], force) = (driven_texts(pair, rotates), if rotates { "moment" } else { "force" });
            let text =
                format!("{motion}, {reaction}: the limit load, where a {force} in place of the motion would jump");
            Some((state.factor, Self::new("limit_load", &pair, text)))
        });
        let drive = &path.drive;
        let bifurcations = path.bifurcations.iter().map(|event| (event.factor, Self::buckles(*event, drive)));
        let jump = path.jump.map(|jump| (jump.factor, Self::jumps(jump, drive)));
        let mut events: Vec<(f64, Self)> = limit.into_iter().chain(bifurcations).chain(jump).collect();
        events.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let end = path.end.map(|(factor, reason)| {
            let reason = match reason {
                PathEndReason::NoEquilibrium => "no stable equilibrium was found there".to_owned(),
                PathEndReason::Solves(most) => format!("the path took {most} solves until there"),
                PathEndReason::Interrupted => "interrupted".to_owned(),
            };
            Self::new("ends", &[factor], format!("not followed beyond {} of {drive}: {reason}", load_percent(factor)))
        });
        events.into_iter().map(|(_, claim)| claim).chain(end).collect()
    }

    /// Returns the claims of a load–deflection curve: where linear theory fails, and where the exact beam ends.
    pub fn of_curve(curve: &LoadCurve) -> Vec<Self> {
        let departure = |(percent, at): &(f64, Sample)| {
            let text = format!(
                "linear theory differs by {percent} % at {} of the load: tip rotation {}, largest strain {}",
                engineering(three_digits(100.0 * at.factor), "%"),
                engineering(three_digits(at.rotation.to_degrees().abs()), "°"),
                engineering(three_digits(100.0 * at.strain), "%")
            );
            Self::new("linear_theory", &[*percent, at.factor], text)
        };
        let buckles = |factor: f64| {
            let part = load_percent(factor);
            let text = format!("the exact beam buckles at {part} of the load: beyond it, its path is unstable");
            Self::new("beam_buckles", &[factor], text)
        };
        let last = curve.samples.last().map(|sample| sample.factor).filter(|factor| *factor < 1.0);
        let ends = |factor: f64| {
            let part = engineering(three_digits(100.0 * factor), "%");
            Self::new("beam_ends", &[factor], format!("the exact beam could not be followed beyond {part} of the load"))
        };
        let end = curve.buckles_at.map(buckles).or_else(|| last.map(ends));
        curve.departures.iter().map(departure).chain(end).collect()
    }

    /// Returns the claim about the fastest setting of a study with an error of at most a limit, percent, the reference's own
    /// included.
    pub fn of_study(study: &Study, percent: f64) -> Self {
        let own = study.own_error_percent;
        if own >= percent {
            let text = format!("an error of {percent} %: not known, the reference's own error may be {own:.2} %");
            return Self::new("not_known", &[percent, own], text);
        }
        match study.within(percent).first() {
            None => {
                let text = format!("an error of {percent} % is not reached by a measured setting");
                Self::new("not_reached", &[percent], text)
            }
            Some(m) => {
                let text = format!("an error of {percent} % costs {}, {}", m.time_text(), m.setting);
                Self::new("best", &[percent, m.milliseconds], text)
            }
        }
    }
}

impl PathSummary {
    /// Returns the claims that the path jumps, buckles, is about to, or ends at another equilibrium than the result.
    pub fn claims(&self) -> impl Iterator<Item = Claim> {
        let drive = &self.drive;
        // The claim of another equilibrium has the buckling of the path from rest.
        let buckling = self.buckling.filter(|_| self.elsewhere.is_none()).map(|event| Claim::buckles(event, drive));
        let jump = self.jump.map(|jump| Claim::jumps(jump, drive));
        let critical = self.critical.map(|factor| {
            // Next to the load, four digits could say 100 %.
            let percent = match factor > 1.0 && factor < 1.0005 {
                true => sentence!("just beyond 100 %"),
                false => load_percent(factor).into(),
            };
            let text = sentence!("becomes unstable at %{percent} of %{drive}", percent, drive);
            Claim::new("critical", &[factor], text)
        });
        let elsewhere = self.elsewhere.map(|farthest| {
            let distance = engineering(farthest, "m");
            let text = match &self.buckling {
                None => sentence!("loading from rest leads to another equilibrium, %{distance} away", distance),
                Some(Bifurcation { factor, .. }) => sentence!(
                    "not on the path from rest, which is unstable above %{percent} of %{drive} and ends %{distance} away",
                    percent = load_percent(*factor),
                    drive,
                    distance
                ),
            };
            Claim::new("elsewhere", &[farthest], text)
        });
        jump.into_iter().chain(buckling).chain(critical).chain(elsewhere)
    }
}

/// Formats a load factor in percent, with four digits.
fn load_percent(factor: f64) -> String {
    engineering(100.0 * factor, "%")
}

/// Formats the motion of a moving support and its reaction; a support that only rotates has an angle, rad, and a moment,
/// N m.
pub fn driven_texts([motion, reaction]: [f64; 2], rotates: bool) -> [String; 2] {
    match rotates {
        true => [engineering(motion.to_degrees(), "°"), engineering(reaction, "N m")],
        false => [engineering(motion, "m"), engineering(reaction, "N")],
    }
}

/// Describes ρ in a sentence.
pub fn rho_text(rho: f64) -> Sentence {
    let text = match rho {
        // Near 1, more digits are needed.
        _ if (rho - 1.0).abs() < 5e-4 => format!("{rho:.6}"),
        0.01..1000.0 => format!("{rho:.3}"),
        ..0.01 => number(two_digits(rho)),
        _ => format!("{rho:.1e}"),
    };
    match rho {
        ..1.0 => sentence!(
            "the warped iteration converges near this equilibrium: an iteration multiplies a disturbance by ρ = %{n}",
            n = text
        ),
        _ => sentence!(
            "the warped iteration leaves this equilibrium: an iteration multiplies a disturbance by ρ = %{n}",
            n = text
        ),
    }
}

/// Explains in a sentence that a solve has ended at the rounding error of its residual.
pub fn floor_text(floor: f64, tolerance: f64) -> Sentence {
    let [floor, tolerance] = [floor, tolerance].map(|v| number(two_digits(v)));
    sentence!(
        "the limit of rounding is reached: rounding may change the residual by %{floor}, so the tolerance \
         %{tolerance} cannot be met here",
        floor,
        tolerance
    )
}

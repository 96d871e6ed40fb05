//! Claims: the statements that results make, each with the numbers that prove it. Commands, reports and the window take
//! their words from here; `tests/physics/claims.rs` recomputes every kind by other means.

use super::load_path::{CriticalLoad, Elsewhere, LoadPath, PathEnd, PathSummary};
use super::ranking::{Demand, Tuning};
use super::reference::{ProbeReference, Reference};
use super::trade::{Measurement, Study};
use super::{Departure, LoadCurve};
use crate::format::{engineering, number, percent, three_digits, two_digits};
use crate::method::{Bifurcation, Drive, Jump};
use crate::scene::{MethodKind, Scene};
use crate::sentence::{Sentence, displayed, sentence};
use crate::simulation::{Simulation, Status, probe_results};

/// Statement of a result, with the numbers that prove it.
///
/// ```
/// use warpbeam::study::Claim;
/// use warpbeam::{Scene, Simulation};
///
/// // A column under three times its critical load, without any imperfection.
/// let scene = Scene::beam(10.0, 0.5).with_cells(10, 1).with_element(warpbeam::ElementKind::Q4);
/// let critical = std::f64::consts::PI.powi(2) * 1e6 * 0.5f64.powi(3) / 12.0 / 400.0;
/// let scene = scene.clamp("left").force("right", [-3.0 * critical, 0.0]);
/// let mut column = Simulation::new(&scene)?;
/// column.solve();
/// let certificate = column.certify();
/// let path = warpbeam::study::LoadPath::to_result(&column, &|_| std::ops::ControlFlow::Continue(()));
/// let claims = Claim::of_result(&column, certificate.fixed_point_rho, path.as_ref(), None);
/// let ids: Vec<&str> = claims.iter().map(Claim::id).collect();
/// assert_eq!(ids[..4], ["converged", "buckles", "unstable", "helps"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Claim {
    /// The forces balance, under `auto` so well that the error is within `solver.max_error_percent`.
    Converged {
        /// Relative residual.
        residual: f64,
        /// Relative residual that the scene asks for.
        tolerance: f64,
        /// Bound of the residual's rounding error, if the solve ended within it above the tolerance.
        floor: Option<f64>,
    },
    /// The search ended without an equilibrium.
    Failed(Status),
    /// The result is the equilibrium under a part of the load.
    Part {
        /// Load factor.
        factor: f64,
        /// Quantities that the load factor refers to.
        drive: Drive,
    },
    /// The exact tangent is positive definite.
    Stable,
    /// The exact tangent is not positive definite.
    Unstable,
    /// Disturbances of the equilibrium shrink or grow under the iteration of `warped`.
    Disturbance {
        /// Spectral radius.
        rho: f64,
        /// `true` if `warped` converged to the equilibrium.
        has_converged: bool,
    },
    /// The path from rest jumps.
    Jumps(Jump),
    /// The path from rest loses or regains stability where another path crosses it.
    Buckles(Bifurcation),
    /// The path from rest loses its stability above the load.
    Critical(CriticalLoad),
    /// The path from rest leads to another equilibrium.
    Elsewhere(Elsewhere),
    /// The path from rest was not followed to the full load.
    Ends(PathEnd),
    /// The reaction of a moving support has its first largest value: the limit load of a force in place of the motion.
    LimitLoad {
        /// Motion of the support: m, or rad if it only rotates.
        motion: f64,
        /// Its reaction along the motion: N, or N m.
        reaction: f64,
        /// `true` if the support only rotates.
        rotates: bool,
    },
    /// The displacement of a probe differs from the reference solution.
    Error {
        /// Name of the probe.
        probe: String,
        /// Distance, percent of the reference's displacement.
        percent: f64,
        /// Reference solution, with the bound of its own error.
        reference: ProbeReference,
    },
    /// The exact beam differs from the fine solution that is the reference.
    BeamTheory {
        /// Distance, percent.
        off_by_percent: f64,
    },
    /// The load and the state at which the error of linear theory reaches a given percentage.
    LinearTheory(Departure),
    /// The exact beam buckles at this load factor.
    BeamBuckles(f64),
    /// The exact beam could not be followed beyond this load factor.
    BeamEnds(f64),
    /// A setting is the fastest of those measured with an error of at most a limit.
    Best {
        /// Limit of the error, the reference's own included, percent.
        percent: f64,
        /// Computing time: `0.0161 ms`.
        time: String,
        /// Setting.
        setting: Sentence,
    },
    /// No measured setting has an error of at most this limit, percent.
    NotReached(f64),
    /// The reference's own error is too large to tell which settings have an error of at most a limit.
    NotKnown {
        /// Limit, percent.
        percent: f64,
        /// Bound of the reference's own error, percent.
        own_percent: f64,
    },
    /// Ranks of settings are undecided, because their errors differ by less than the reference's own error, percent.
    Undecided(f64),
    /// A number of measured settings, possibly none, meets a demand.
    Suffices {
        /// Limits of error and time that the user asked for.
        demand: Demand,
        /// Number of settings that meet it.
        meeting: usize,
        /// Number of measured settings that converge.
        measured: usize,
        /// Reason why the chosen setting is chosen: `the fastest`.
        chosen: &'static str,
        /// Number of settings as accurate as the chosen one, as far as the reference's own error tells.
        as_accurate: usize,
    },
    /// An edit of the scene leads to a result where this one is none, or is unstable.
    Helps(Advice),
}

/// Edit of a scene that leads to a stable equilibrium.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Advice {
    /// `solver.method = "newton"` instead of a method that diverges.
    Newton,
    /// A small force across a body that has buckled without an imperfection.
    Imperfection,
}

displayed!(Claim);

impl From<&Claim> for Sentence {
    fn from(claim: &Claim) -> Self {
        match claim {
            Claim::Converged { tolerance, floor: Some(floor), .. } => sentence!(
                "the forces balance to machine precision: %{rounding}",
                rounding = floor_text(*floor, *tolerance)
            ),
            Claim::Converged { residual, tolerance, floor: None } if residual > tolerance => sentence!(
                "the solve ends within solver.max_error_percent: the relative residual is %{residual}, above the \
                 tolerance of %{asked}",
                residual = number(two_digits(*residual)),
                asked = number(*tolerance)
            ),
            Claim::Converged { residual, tolerance, floor: None } => sentence!(
                "the forces balance: the relative residual is %{residual}, the tolerance is %{asked}",
                residual = number(two_digits(*residual)),
                asked = number(*tolerance)
            ),
            Claim::Failed(status) => status.failure_sentence().unwrap_or_default(),
            Claim::Part { factor, drive } => {
                let part = engineering(100.0 * factor, "%");
                format!("the numbers below are those of the equilibrium at {part} of {drive}").into()
            }
            Claim::Stable => {
                "stable: after a small push the body returns (the exact tangent stiffness is positive definite)".into()
            }
            Claim::Unstable => "unstable: after a small push the body moves away (the exact tangent stiffness is not \
                                positive definite)"
                .into(),
            Claim::Disturbance { rho, has_converged: true } if *rho > 1.0 => sentence!(
                "%{disturbance}; it converged because nothing disturbs it, as in a bar loaded along its axis",
                disturbance = rho_text(*rho)
            ),
            Claim::Disturbance { rho, .. } => rho_text(*rho),
            Claim::Jumps(jump) => jump.into(),
            Claim::Buckles(bifurcation) => bifurcation.into(),
            Claim::Critical(critical) => critical.into(),
            Claim::Elsewhere(elsewhere) => elsewhere.into(),
            Claim::Ends(end) => end.to_string().into(),
            Claim::LimitLoad { motion, reaction, rotates } => {
                let [motion, reaction] = driven_texts([*motion, *reaction], *rotates);
                let force = if *rotates { "moment" } else { "force" };
                format!("{motion}, {reaction}: the limit load, where a {force} in place of the motion would jump")
                    .into()
            }
            Claim::Error { probe, percent, reference } => {
                format!("error of {probe} {percent:.3} %, against {reference}").into()
            }
            Claim::BeamTheory { off_by_percent } => {
                sentence!("beam theory differs by %{off}", off = percent(*off_by_percent))
            }
            Claim::LinearTheory(Departure { percent, at }) => format!(
                "linear theory differs by {percent} % at {} of the load: tip rotation {}, largest strain {}",
                engineering(three_digits(100.0 * at.factor), "%"),
                engineering(three_digits(at.rotation.to_degrees().abs()), "°"),
                engineering(three_digits(100.0 * at.strain), "%")
            )
            .into(),
            Claim::BeamBuckles(factor) => {
                let part = engineering(100.0 * factor, "%");
                format!("the exact beam buckles at {part} of the load: beyond it, its path is unstable").into()
            }
            Claim::BeamEnds(factor) => {
                let part = engineering(three_digits(100.0 * factor), "%");
                format!("the exact beam could not be followed beyond {part} of the load").into()
            }
            Claim::Best { percent, time, setting } => format!("an error of {percent} % costs {time}, {setting}").into(),
            Claim::NotReached(percent) => {
                format!("an error of {percent} % is not reached by a measured setting").into()
            }
            Claim::NotKnown { percent, own_percent } => {
                format!("an error of {percent} %: not known, the reference's own error may be {own_percent:.2} %")
                    .into()
            }
            Claim::Undecided(own) => format!(
                "rank undecided: a faster setting may be as accurate, because their errors differ by less than the \
                 reference's own error, {}",
                percent(*own)
            )
            .into(),
            Claim::Suffices { demand, meeting, measured, chosen, as_accurate } => {
                let undecided = match as_accurate {
                    0 | 1 => String::new(),
                    n => format!(", undecided between {n} whose errors differ by less than the reference's own"),
                };
                match meeting {
                    0 => format!("none of {measured} settings measured here meets {demand}; {chosen}{undecided}"),
                    _ => format!("{meeting} of {measured} settings measured here meet {demand}; {chosen}{undecided}"),
                }
                .into()
            }
            Claim::Helps(Advice::Newton) => {
                "the last state of a diverging iteration has no meaning; solve with method newton".into()
            }
            Claim::Helps(Advice::Imperfection) => {
                "a small force across the body, as an imperfection, leads to a stable equilibrium".into()
            }
        }
    }
}

impl Claim {
    /// Returns the kind of the claim in JSON.
    pub fn id(&self) -> &'static str {
        match self {
            Self::Converged { .. } => "converged",
            Self::Failed(_) => "failed",
            Self::Part { .. } => "part",
            Self::Stable => "stable",
            Self::Unstable => "unstable",
            Self::Disturbance { .. } => "disturbance",
            Self::Jumps(_) => "jumps",
            Self::Buckles(_) => "buckles",
            Self::Critical(_) => "critical",
            Self::Elsewhere(_) => "elsewhere",
            Self::Ends(_) => "ends",
            Self::LimitLoad { .. } => "limit_load",
            Self::Error { .. } => "error",
            Self::BeamTheory { .. } => "beam_theory",
            Self::LinearTheory(_) => "linear_theory",
            Self::BeamBuckles(_) => "beam_buckles",
            Self::BeamEnds(_) => "beam_ends",
            Self::Best { .. } => "best",
            Self::NotReached(_) => "not_reached",
            Self::NotKnown { .. } => "not_known",
            Self::Undecided(_) => "undecided",
            Self::Suffices { .. } => "suffices",
            Self::Helps(_) => "helps",
        }
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
        let mut claims = Vec::new();
        match status {
            Status::Converged => {
                let (residual, floor) = (simulation.residual(), search.residual_floor());
                claims.push(Self::Converged { residual, tolerance: solver.tolerance, floor });
            }
            Status::NotConverged(_) => {
                claims.push(Self::Failed(status.clone()));
                let (factor, drive) = (search.load_factor(), Drive::of(simulation.problem()));
                claims.extend((factor < 1.0).then_some(Self::Part { factor, drive }));
            }
            Status::Diverged(_) => {
                let help = (solver.method != MethodKind::Newton).then_some(Self::Helps(Advice::Newton));
                claims.extend(std::iter::once(Self::Failed(status.clone())).chain(help));
                return claims;
            }
            _ => {}
        }
        if let Some(path) = path {
            claims.extend(path.claims());
        }
        let stable = search.certificate().and_then(|certificate| certificate.stable);
        claims.extend(stable.filter(|_| *status == Status::Converged).map(|stable| match stable {
            true => Self::Stable,
            false => Self::Unstable,
        }));
        let has_buckled = path.is_some_and(|path| path.buckling.is_some() && path.elsewhere.is_none());
        if has_buckled && stable == Some(false) {
            claims.push(Self::Helps(Advice::Imperfection));
        }
        claims.extend(rho.map(|rho| Self::disturbance(rho, solver.method, status)));
        if let Some(reference) = reference {
            let probes = probe_results(simulation.problem(), simulation.state());
            claims.extend(probes.iter().zip(reference.probes()).filter_map(|(probe, known)| {
                let reference = (*known)?;
                let percent = reference.error_percent(probe)?;
                Some(Self::Error { probe: probe.name.clone(), percent, reference })
            }));
            claims.extend(reference.beam_off_by_percent.map(|off_by_percent| Self::BeamTheory { off_by_percent }));
        }
        claims
    }

    /// Returns the claim about disturbances of an equilibrium that a method has led to.
    pub(crate) fn disturbance(rho: f64, method: MethodKind, status: &Status) -> Self {
        Self::Disturbance { rho, has_converged: method == MethodKind::Warped && *status == Status::Converged }
    }

    /// Returns the claims of a load path in its order: the largest reaction of its moving support, bifurcations, the jump,
    /// and its end.
    pub fn of_path(scene: &Scene, path: &LoadPath) -> Vec<Self> {
        let limit = path.limit_under_force().and_then(|state| {
            let ([motion, reaction], rotates) = (path.driven_pair(scene, state)?, path.rotates(scene));
            Some((state.factor, Self::LimitLoad { motion, reaction, rotates }))
        });
        let bifurcations =
            path.bifurcations.iter().map(|bifurcation| (bifurcation.factor, Self::Buckles(*bifurcation)));
        let jump = path.jump.map(|jump| (jump.factor, Self::Jumps(jump)));
        let mut events: Vec<(f64, Self)> = limit.into_iter().chain(bifurcations).chain(jump).collect();
        events.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        events.into_iter().map(|(_, claim)| claim).chain(path.end.map(Self::Ends)).collect()
    }

    /// Returns the claims of a load–deflection curve: where linear theory fails, and where the exact beam ends.
    pub fn of_curve(curve: &LoadCurve) -> Vec<Self> {
        let last = curve.samples.last().map(|sample| sample.factor).filter(|factor| *factor < 1.0);
        let end = curve.buckles_at.map(Self::BeamBuckles).or_else(|| last.map(Self::BeamEnds));
        curve.departures.iter().copied().map(Self::LinearTheory).chain(end).collect()
    }

    /// Returns the claim about the fastest setting of a study with an error of at most a limit, percent.
    pub fn of_study(study: &Study, percent: f64) -> Self {
        let own_percent = study.own_error_percent;
        if own_percent >= percent {
            return Self::NotKnown { percent, own_percent };
        }
        study.within(percent).first().map_or(Self::NotReached(percent), |m| Self::Best {
            percent,
            time: m.time_text(),
            setting: (&m.setting).into(),
        })
    }

    /// Returns the claim about the settings that meet a demand.
    pub fn of_tuning(tuning: &Tuning) -> Self {
        let Tuning { chosen, demand, met, measured, meeting, study, .. } = tuning;
        let reason = match (met, demand.max_error_percent.is_some(), demand.time_is_met(chosen)) {
            (true, true, _) => "the fastest",
            (true, false, _) => "the most accurate",
            (false, _, true) => "the most accurate within the time",
            (false, _, false) => "the fastest of all",
        };
        let is_as_accurate = |m: &&Measurement| {
            let apart = (m.error_percent() - chosen.error_percent()).abs();
            m.converged && demand.time_is_met(m) && apart < study.own_error_percent
        };
        // The setting itself is one of them. The fastest is chosen by its time, which is decided.
        let as_accurate = match reason.starts_with("the most accurate") {
            true => study.measurements.iter().filter(is_as_accurate).count(),
            false => 1,
        };
        let meeting = if *met { *meeting } else { 0 };
        Self::Suffices { demand: *demand, meeting, measured: *measured, chosen: reason, as_accurate }
    }
}

impl PathSummary {
    /// Returns the claims that the path jumps, buckles, is about to, or ends elsewhere than the result.
    pub fn claims(&self) -> impl Iterator<Item = Claim> {
        // The claim of another equilibrium has the buckling of the path from rest.
        let buckling = self.buckling.filter(|_| self.elsewhere.is_none()).map(Claim::Buckles);
        let jump = self.jump.map(Claim::Jumps);
        let critical = self.critical.map(Claim::Critical);
        jump.into_iter().chain(buckling).chain(critical).chain(self.elsewhere.map(Claim::Elsewhere))
    }
}

/// Formats the motion of a moving support and its reaction; a support that only rotates has an angle, rad, and a moment,
/// N m.
pub(crate) fn driven_texts([motion, reaction]: [f64; 2], rotates: bool) -> [String; 2] {
    match rotates {
        true => [engineering(motion.to_degrees(), "°"), engineering(reaction, "N m")],
        false => [engineering(motion, "m"), engineering(reaction, "N")],
    }
}

/// Describes ρ in a sentence.
#[must_use]
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
#[must_use]
pub fn floor_text(floor: f64, tolerance: f64) -> Sentence {
    let [floor, tolerance] = [floor, tolerance].map(|v| number(two_digits(v)));
    sentence!(
        "the limit of rounding is reached: rounding may change the residual by %{floor}, so the tolerance \
         %{tolerance} cannot be met here",
        floor,
        tolerance
    )
}

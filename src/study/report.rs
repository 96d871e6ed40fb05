//! Reports of the speed–accuracy study, table and summary, and of a tuning.

use std::fmt::Write as _;

use super::claim::Claim;
use super::motion::MotionReference;
use super::prelude::*;
use super::ranking::Tuning;
use super::trade::{ErrorSplit, Measurement, MotionFigures, Study, StudyReference};

/// Columns of the table of a body at rest, and of a motion.
const COLUMNS: [&str; 2] = [
    "element,cells_along,cells_across,dofs,method,iterations,converged,time_us,rotate_us,assemble_us,factorize_us,solve_us,error_percent,discretization_percent,iteration_percent,model_percent,error_bound_percent,pareto,at_most_percent,undecided\n",
    "element,cells_along,cells_across,dofs,integrator,method,time_step_s,solves,ending,ms_per_simulated_second,error_percent,rms_error_percent,discretization_percent,integration_percent,model_percent,error_bound_percent,resolved,energy_drift_percent,energy,steps_taken,solves_taken,factorizations,pareto,at_most_percent,undecided\n",
];

impl Study {
    /// Formats the study as CSV. `error_bound_percent` is the sum of the error's parts; `at_most_percent` includes the
    /// reference's own error. At rest, times are in microseconds. In motion, `solves` is the number per step or stage, 0 to
    /// iterate to the tolerance; `resolved` is `true` if the sum of the error's parts is above the reference's own error;
    /// motions that did not finish have no error. `docs/reference/results.md` has the columns.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = COLUMNS[usize::from(matches!(self.reference, StudyReference::Motion(_)))].to_owned();
        for (m, undecided) in self.measurements.iter().zip(self.undecided()) {
            let [along, across] = m.setting.cells.unwrap_or([0, 0]);
            let columns = match m.setting.stepping.zip(m.motion) {
                None => columns_at_rest(m),
                Some((stepping, motion)) => self.columns_in_motion(m, stepping, motion),
            };
            let at_most = m.error.map_or_else(String::new, |_| format!("{:e}", self.error_bound(m)));
            let (element, dofs) = (m.setting.element.id(), m.dofs);
            let _ = writeln!(text, "{element},{along},{across},{dofs},{columns},{},{at_most},{undecided}", m.pareto);
        }
        text
    }

    fn columns_in_motion(&self, m: &Measurement, stepping: Stepping, motion: MotionFigures) -> String {
        let errors = m.error.map_or_else(
            || ",,,,,,".to_owned(),
            |e| {
                let parts = [e.total, motion.rms_percent, e.discretization, e.iteration, e.model, e.bound()];
                format!("{},{}", exponents(parts), e.bound() > self.own_error_percent)
            },
        );
        let Setting { method, iterations, .. } = m.setting;
        let MotionFigures { drift_percent, counts, .. } = motion;
        format!(
            "{},{},{:e},{iterations},{},{:.4},{errors},{drift_percent:e},{},{},{},{}",
            stepping.integrator.id(),
            method.id(),
            stepping.time_step,
            m.ending(),
            m.milliseconds,
            motion.energy(),
            counts.steps,
            counts.solves,
            counts.factorizations
        )
    }

    /// Formats a summary for display: reference solution, Pareto front, and cost of given errors; of a motion also the effect
    /// of its time step and the savings of `auto`.
    #[must_use]
    pub fn summary(&self) -> String {
        let StudyReference::Motion(reference) = &self.reference else {
            let head = format!("{}: error of the first probe against {}\n\n", self.scene, self.reference);
            return head + &self.front_text() + &self.costs_text();
        };
        let mut text = format!(
            "{}: error of the first probe's path: largest distance over {} s, percent of its largest displacement \
             {:.4} m,\nagainst {reference}\n",
            self.scene,
            number(round(reference.duration())),
            reference.size
        );
        if reference.duration() < reference.scene_duration * (1.0 - 1e-6) {
            let lasts = number(reference.scene_duration);
            let _ = writeln!(text, "(the scene lasts {lasts} s; the rest is not measured)");
        }
        text += &format!("\n{}{}\n", self.front_text(), self.costs_text());
        self.add_steps(reference, &mut text);
        self.add_auto(&mut text);
        let unfinished = self.measurements.iter().filter(|m| !m.converged).count();
        if unfinished > 0 {
            let settings = count(unfinished as u64, "setting");
            let _ = writeln!(text, "{settings} did not reach the end: see the column `ending` of the table");
        }
        text
    }

    /// Formats a row for each setting of the Pareto front, fastest first, and a note if the rank of one is undecided.
    fn front_text(&self) -> String {
        let moves = matches!(self.reference, StudyReference::Motion(_));
        let (unit, iteration) = if moves { (" per simulated second", "time steps") } else { ("", "stopped early") };
        let mut text = format!(
            "Pareto front: no measured setting is both faster and more accurate (time{unit}; error: at most the sum of its \
             parts and of the reference's own error):\n"
        );
        let row = |columns: &[String]| columns.iter().map(|text| format!("{text:>14}")).collect::<String>();
        let columns = ["time, ms", "at most, %", "measured", "mesh error", iteration, "linear theory"];
        let in_motion = if moves { &["rms", "energy, %"][..] } else { &[] };
        let columns: Vec<String> = columns.iter().chain(in_motion).map(ToString::to_string).collect();
        let _ = writeln!(text, "{}   setting", row(&columns));
        let ranked = self.measurements.iter().zip(self.undecided());
        let mut front: Vec<(&Measurement, bool)> = ranked.filter(|(m, _)| m.pareto).collect();
        front.sort_by(|(a, _), (b, _)| a.milliseconds.total_cmp(&b.milliseconds));
        for (m, undecided) in &front {
            let Some(ErrorSplit { total, discretization, iteration, model }) = m.error else { continue };
            let mut values = vec![m.milliseconds, self.error_bound(m), total, discretization, iteration, model];
            values.extend(m.motion.iter().flat_map(|motion| [motion.rms_percent, motion.drift_percent]));
            let values: Vec<String> = values.iter().map(|value| format!("{value:.4}")).collect();
            let _ =
                writeln!(text, "{}   {}{}", row(&values), m.setting, if *undecided { " (rank undecided)" } else { "" });
        }
        if front.iter().any(|(m, undecided)| m.error.is_some() && *undecided) {
            let _ = writeln!(
                text,
                "rank undecided: a faster setting may be as accurate, because their errors differ by less than the \
                 reference's own error, {}",
                percent(self.own_error_percent)
            );
        }
        text + "\n"
    }

    /// Formats the fastest setting with an error of at most 10, 1 and 0.1 %, of all and of each element and method, or
    /// integrator.
    fn costs_text(&self) -> String {
        let rival = |m: &Measurement| match m.setting.stepping {
            Some(_) => m.setting.series().to_owned(),
            None => format!("{} {}", m.setting.element.id(), m.setting.series()),
        };
        let mut rivals: Vec<String> = Vec::new();
        for name in self.measurements.iter().map(rival) {
            if !rivals.contains(&name) {
                rivals.push(name);
            }
        }
        let mut text = String::new();
        for percent in [10.0, 1.0, 0.1] {
            let _ = writeln!(text, "{}", Claim::of_study(self, percent));
            let within = self.within(percent);
            for name in rivals.iter().filter(|_| self.own_error_percent < percent) {
                let cost = match within.iter().find(|m| rival(m) == *name) {
                    Some(m) => format!("{}, {}", m.time_text(), m.setting),
                    None if name.ends_with("auto") && percent < self.asked_percent => {
                        format!("solver.max_error_percent is {}", self.asked_percent)
                    }
                    None => "not reached".to_owned(),
                };
                let _ = writeln!(text, "    {name:<16} {cost}");
            }
        }
        text
    }

    /// Returns each measurement with its time stepping and figures.
    fn motions(&self) -> impl Iterator<Item = (&Measurement, Stepping, &MotionFigures)> {
        self.measurements.iter().filter_map(|m| Some((m, m.setting.stepping?, m.motion.as_ref()?)))
    }

    /// Adds the effect of the time step on error and energy, on the scene's mesh.
    fn add_steps(&self, reference: &MotionReference, text: &mut String) {
        let _ = writeln!(
            text,
            "by time step, newton on {}: error of the time steps, %; energy drift, % of the largest kinetic energy; \
             time per simulated second, ms",
            mesh_text(reference.element, reference.own_mesh)
        );
        let own = (reference.element, reference.own_mesh, MethodKind::Newton);
        for (m, stepping, motion) in self.motions() {
            let Setting { element, cells, method, iterations, .. } = m.setting;
            if (element, cells, method) != own {
                continue;
            }
            let _ = writeln!(
                text,
                "    {:<16} {:<18} {:>10}  {:>12} {:>12.5} {:<6} {:>10.3}",
                stepping.integrator.id(),
                stepping.solves_text(iterations).to_string(),
                step_text(stepping.time_step),
                m.error.map_or_else(|| m.ending().replace('_', " "), |e| format!("{:.4}", e.iteration)),
                motion.drift_percent,
                motion.energy(),
                m.milliseconds
            );
        }
        text.push('\n');
    }

    /// Adds the savings of `auto` compared with `newton`.
    fn add_auto(&self, text: &mut String) {
        let autos = self.motions().filter(|(m, ..)| m.setting.method == MethodKind::Auto);
        let pairs = autos.filter_map(|(auto, _, figures)| {
            let setting = Setting { method: MethodKind::Newton, ..auto.setting };
            let (newton, _, of_newton) = self.motions().find(|(m, ..)| m.setting == setting)?;
            let farther = auto.error?.bound() - newton.error?.bound();
            let [all, few] = [of_newton, figures].map(|motion| motion.counts.factorizations as f64);
            let factors = few / all.max(1.0);
            Some((auto.milliseconds / newton.milliseconds, factors, farther))
        });
        let pairs: Vec<(f64, f64, f64)> = pairs.collect();
        let median = |of: fn(&(f64, f64, f64)) -> f64| {
            let mut values: Vec<f64> = pairs.iter().map(of).collect();
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 2).copied().unwrap_or(1.0)
        };
        let worst = pairs.iter().map(|p| p.2).fold(0.0, f64::max);
        if !pairs.is_empty() {
            let _ = writeln!(
                text,
                "auto compared with newton, otherwise the same setting: {:.2} of the time and {:.2} of the \
                 factorizations (medians), its error larger by {} % at most",
                median(|p| p.0),
                median(|p| p.1),
                number(round(worst))
            );
        }
    }
}

fn columns_at_rest(m: &Measurement) -> String {
    let t = &m.time;
    let times = [t.total(), t.rotate, t.linearize, t.factorize, t.solve + t.advance];
    let times = times.map(|time| format!("{:.2}", time.as_secs_f64() * 1e6)).join(",");
    let errors = m.error.map_or([0.0; 5], |e| [e.total, e.discretization, e.iteration, e.model, e.bound()]);
    format!("{},{},{},{times},{}", m.setting.method.id(), m.setting.iterations, m.converged, exponents(errors))
}

fn exponents<const N: usize>(values: [f64; N]) -> String {
    values.map(|value| format!("{value:e}")).join(",")
}

/// Rounds to six decimal places, for sums of steps.
fn round(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

impl std::fmt::Display for Tuning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { chosen, study, .. } = self;
        writeln!(f, "{}: error of the first probe against {}", study.scene, study.reference)?;
        writeln!(f, "{}:", Claim::of_tuning(self))?;
        let cost = |m: &Measurement| {
            let bound = study.error_bound(m);
            format!("{}: {:.4} ms, error at most {bound:.4} %", m.setting, m.milliseconds)
        };
        write!(f, "  {}", cost(chosen))?;
        if let Some(ErrorSplit { discretization, iteration, model, .. }) = chosen.error {
            write!(
                f,
                "\n  of which mesh {discretization:.4} %, stopped early {iteration:.4} %, linear theory {model:.4} %, the \
                 reference's own {:.4} %",
                study.own_error_percent
            )?;
        }
        let asked = self.demand.max_error_percent.filter(|_| !self.met);
        let within = asked.map_or_else(Vec::new, |percent| study.within(percent));
        match within.into_iter().find(|m| m.converged) {
            Some(other) => write!(f, "\nthe fastest within the error:\n  {}", cost(other)),
            None => Ok(()),
        }
    }
}

//! Reports of the speed–accuracy study, table and summary, and of a tuning.

use std::fmt::Write as _;

use super::claim::Claim;
use super::motion::{MotionReference, REAL_TIME};
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

    /// Formats a summary for display: reference solution, Pareto front, and cost of given errors; of a motion also
    /// results in real time, and energy behaviour.
    #[must_use]
    pub fn summary(&self) -> String {
        match &self.reference {
            StudyReference::Rest(_) => self.summary_at_rest(),
            StudyReference::Motion(reference) => self.motion_summary(reference),
        }
    }

    fn summary_at_rest(&self) -> String {
        let mut text = format!("{}: error of the first probe against {}\n\n", self.scene, self.reference);
        let columns = "    time, ms    at most, %     measured   mesh error  stopped early  linear theory   setting";
        self.add_front(&mut text, ["", columns], |m, ErrorSplit { total, discretization, iteration, model }| {
            let bound = self.error_bound(m);
            let parts = format!("{total:12.4} {discretization:12.4} {iteration:14.4} {model:14.4}");
            format!("{:12.4} {bound:12.4} {parts}", m.milliseconds)
        });
        self.add_costs(&mut text, |text, percent| {
            let within = self.within(percent);
            for (element, method) in
                ElementKind::all().flat_map(|element| METHODS.iter().map(move |m| (element, m.kind)))
            {
                let own = within.iter().find(|m| (m.setting.element, m.setting.method) == (element, method));
                let cost = match own {
                    Some(m) => m.time_text(),
                    None if method == MethodKind::Auto && percent < self.asked_percent => {
                        format!("solver.max_error_percent is {}", self.asked_percent)
                    }
                    None => "not reached".to_owned(),
                };
                let _ = writeln!(text, "    {} {:<7} {cost}", element.id(), method.id());
            }
        });
        text
    }

    /// Adds a row for each setting of the Pareto front, fastest first, and a note if the rank of one is undecided. `row`
    /// formats time and errors of a setting, whose meaning is explained before the names of the columns.
    fn add_front(&self, text: &mut String, head: [&str; 2], row: impl Fn(&Measurement, ErrorSplit) -> String) {
        let [time, columns] = head;
        let _ = writeln!(
            text,
            "Pareto front: no measured setting is both faster and more accurate ({time}error: at most the sum of its parts \
             and of the reference's own error):\n{columns}"
        );
        let ranked = self.measurements.iter().zip(self.undecided()).filter(|(m, _)| m.pareto);
        let mut front: Vec<_> = ranked.filter_map(|(m, undecided)| Some((m, m.error?, undecided))).collect();
        front.sort_by(|(a, ..), (b, ..)| a.milliseconds.total_cmp(&b.milliseconds));
        for (m, error, undecided) in &front {
            let mark = if *undecided { " (rank undecided)" } else { "" };
            let _ = writeln!(text, "{}   {}{mark}", row(m, *error), m.setting);
        }
        if front.iter().any(|(.., undecided)| *undecided) {
            let _ = writeln!(
                text,
                "rank undecided: a faster setting may be as accurate, because their errors differ by less than the \
                 reference's own error, {}",
                percent(self.own_error_percent)
            );
        }
        text.push('\n');
    }

    /// Adds the fastest setting with an error of at most 10, 1 and 0.1 %, and the `details` of each.
    fn add_costs(&self, text: &mut String, details: impl Fn(&mut String, f64)) {
        for percent in [10.0, 1.0, 0.1] {
            let claim = Claim::of_study(self, percent);
            let _ = writeln!(text, "{claim}");
            if self.own_error_percent < percent {
                details(text, percent);
            }
        }
    }

    /// Returns each measurement with its time stepping and figures.
    fn motions(&self) -> impl Iterator<Item = (&Measurement, Stepping, &MotionFigures)> {
        self.measurements.iter().filter_map(|m| Some((m, m.setting.stepping?, m.motion.as_ref()?)))
    }

    /// Formats a summary for display: reference, Pareto front, results in real time, and energy behaviour.
    fn motion_summary(&self, reference: &MotionReference) -> String {
        let mut text = format!(
            "{}: error of the first probe's path: largest distance over {} s, percent of its largest displacement \
             {:.4} m,\nagainst {}\n",
            self.scene,
            number(round(reference.duration())),
            reference.size,
            reference
        );
        if reference.duration() < reference.scene_duration * (1.0 - 1e-6) {
            let lasts = number(reference.scene_duration);
            let _ = writeln!(text, "(the scene lasts {lasts} s; the rest is not measured)");
        }
        text.push('\n');
        let columns = "    time, ms   at most, %    measured         rms   mesh error  time steps  linear theory   energy, %   setting";
        let head = ["time: per simulated second; ", columns];
        self.add_front(&mut text, head, |m, ErrorSplit { total, discretization, iteration, model }| {
            let bound = self.error_bound(m);
            let [rms, drift] = m.motion.map_or([0.0; 2], |motion| [motion.rms_percent, motion.drift_percent]);
            let parts = format!("{total:11.4} {rms:11.4} {discretization:12.4} {iteration:11.4} {model:14.4}");
            format!("{:12.3} {bound:12.4} {parts} {drift:11.4}", m.milliseconds)
        });
        self.add_motion_costs(&mut text);
        self.add_steps(reference, &mut text);
        self.add_auto(&mut text);
        self.add_unfinished(&mut text);
        text
    }

    /// Adds the cost of given errors with every integrator.
    fn add_motion_costs(&self, text: &mut String) {
        let integrator_of = |m: &Measurement| m.setting.stepping.map(|stepping| stepping.integrator);
        self.add_costs(text, |text, percent| {
            let within = self.within(percent);
            for integrator in INTEGRATORS {
                let own = within.iter().find(|m| integrator_of(m) == Some(integrator.kind));
                let cost = own.map_or_else(|| "not reached".to_owned(), |m| cost_text(m));
                let _ = writeln!(text, "    {:<16} {cost}", integrator.id);
            }
        });
        if self.own_error_percent >= 1.0 {
            text.push('\n');
            return;
        }
        let cost = match self.within(1.0).first() {
            None => "no measured setting is within 1 %".to_owned(),
            Some(m) if m.milliseconds <= REAL_TIME => {
                let times = REAL_TIME / m.milliseconds;
                format!("within 1 %, the fastest setting runs at {times:.0} times real time: {}", m.setting)
            }
            Some(m) => format!("within 1 %, no measured setting runs in real time; the fastest: {}", cost_text(m)),
        };
        let _ = writeln!(text, "{cost}\n");
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

    /// Adds the settings without an error, and the reason.
    fn add_unfinished(&self, text: &mut String) {
        for (is_cut_short, label) in
            [(false, "stopped before the end"), (true, "stopped early: too many steps to the end")]
        {
            let of_label = |motion: &MotionFigures| motion.is_cut_short == is_cut_short;
            let those: Vec<_> = self.motions().filter(|(m, _, motion)| !m.converged && of_label(motion)).collect();
            if !those.is_empty() {
                let _ = writeln!(text, "{} {label}:", count(those.len() as u64, "setting"));
            }
            for (m, ..) in those {
                let _ = writeln!(text, "    {} ({:.0} ms per simulated second)", m.setting, m.milliseconds);
            }
        }
        let gained = self.motions().filter(|(.., motion)| motion.energy() == "gained");
        let most = gained.max_by(|(.., a), (.., b)| a.drift_percent.total_cmp(&b.drift_percent));
        if let Some((m, _, motion)) = most {
            let _ = writeln!(text, "the most energy was gained, {:.2} %, by {}", motion.drift_percent, m.setting);
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

fn cost_text(m: &Measurement) -> String {
    format!("{}, {}", m.time_text(), m.setting)
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

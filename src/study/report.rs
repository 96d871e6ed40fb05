//! Reports of the speed–accuracy study, table and summary, and of a tuning.

use std::fmt::Write as _;

use super::claim::Claim;
use super::extremes::distinct;
use super::prelude::*;
use super::ranking::Tuning;
use super::trade::{ErrorSplit, Measurement, Study};
use crate::dynamics::Counts;

/// Columns of the table of a body at rest, and of a motion.
const COLUMNS: [&str; 2] = [
    "element,cells_along,cells_across,dofs,method,iterations,converged,time_us,rotate_us,assemble_us,factorize_us,solve_us,error_percent,discretization_percent,iteration_percent,model_percent,error_bound_percent,pareto,at_most_percent,undecided\n",
    "element,cells_along,cells_across,dofs,integrator,method,time_step_s,solves,ending,ms_per_simulated_second,error_percent,rms_error_percent,discretization_percent,integration_percent,model_percent,error_bound_percent,resolved,energy_drift_percent,energy,steps_taken,solves_taken,factorizations,pareto,at_most_percent,undecided\n",
];

impl Study {
    /// Formats the study as CSV; `docs/reference/results.md` has the columns. Motions that did not finish have no error.
    pub fn table(&self) -> String {
        /// Change of the energy below which it counts as kept, percent of the largest kinetic energy.
        const KEPT: f64 = 0.01;
        let mut text = COLUMNS[usize::from(self.moves())].to_owned();
        for m in &self.measurements {
            let Setting { element, cells, method, iterations, stepping } = m.setting;
            let ([along, across], (element, method)) = (cells.unwrap_or([0, 0]), (element.id(), method.id()));
            let Measurement { dofs, converged, milliseconds, pareto, undecided, .. } = m;
            let ErrorSplit { total, discretization, iteration, model } = m.error.unwrap_or_default();
            let (error, at_most) = (m.error_percent(), self.error_bound(m));
            let if_known = |text: String| m.error.map_or_else(String::new, |_| text);
            let exponents =
                |values: &[f64]| values.iter().map(|v| if_known(format!("{v:e}"))).collect::<Vec<_>>().join(",");
            let (parts, at_most) = (exponents(&[discretization, iteration, model, error]), exponents(&[at_most]));
            let columns = if let Some((stepping, motion)) = stepping.zip(m.motion) {
                let (integrator, step, drift) = (stepping.integrator.id(), stepping.time_step, motion.drift_percent);
                let ending = match (converged, motion.is_cut_short) {
                    (true, _) => "finished",
                    (false, true) => "cut_short",
                    (false, false) => "stopped",
                };
                let totals = exponents(&[total, motion.rms_percent]);
                let resolved = if_known((error > self.own_error_percent).to_string());
                let energy = match drift {
                    d if d.abs() < KEPT => "kept",
                    d if d < 0.0 => "lost",
                    _ => "gained",
                };
                let Counts { steps, solves, factorizations, .. } = motion.counts;
                format!(
                    "{integrator},{method},{step:e},{iterations},{ending},{milliseconds:.4},{totals},{parts},{resolved},{drift:e},{energy},{steps},{solves},{factorizations}"
                )
            } else {
                let t = &m.time;
                let times = [t.total(), t.rotate, t.linearize, t.factorize, t.solve + t.advance];
                let times = times.map(|time| format!("{:.2}", time.as_secs_f64() * 1e6)).join(",");
                format!("{method},{iterations},{converged},{times},{},{parts}", exponents(&[total]))
            };
            let _ = writeln!(text, "{element},{along},{across},{dofs},{columns},{pareto},{at_most},{undecided}");
        }
        text
    }

    /// Formats a summary for display: reference solution, Pareto front, and cost of given errors.
    pub fn summary(&self) -> String {
        let (reference, costs) = (&self.reference, self.front_text() + &self.costs_text());
        if !self.moves() {
            return format!("{}: error of the first probe against {}\n\n{costs}", self.scene, reference.text);
        }
        let mut text = format!(
            "{}: error of the first probe's path: largest distance over {} s, percent of its largest displacement \
             {:.4} m,\nagainst {}\n",
            self.scene,
            // The duration is a sum of steps.
            number((reference.samples.duration() * 1e6).round() / 1e6),
            reference.size,
            reference.text
        );
        text += &format!("\n{costs}");
        let unfinished = self.measurements.iter().filter(|m| !m.converged).count();
        if unfinished > 0 {
            let settings = count(unfinished as u64, "setting");
            let _ = writeln!(text, "\n{settings} did not reach the end: see the column `ending` of the table");
        }
        text
    }

    /// Formats a row for each setting of the Pareto front, fastest first, and a note if the rank of one is undecided.
    fn front_text(&self) -> String {
        let moves = self.moves();
        let (unit, iteration) = if moves { (" per simulated second", "time steps") } else { ("", "stopped early") };
        let mut text = format!(
            "Pareto front: no measured setting is both faster and more accurate (time{unit}; error: at most the sum of its \
             parts and of the reference's own error):\n"
        );
        let mut columns = vec!["time, ms", "at most, %", "measured", "mesh error", iteration, "linear theory"];
        columns.extend(if moves { &["rms", "energy, %"][..] } else { &[] });
        let heading: String = columns.iter().map(|text| format!("{text:>14}")).collect();
        let _ = writeln!(text, "{heading}   setting");
        let front = self.front();
        for m in &front {
            let Some(ErrorSplit { total, discretization, iteration, model }) = m.error else { continue };
            let mut values = vec![m.milliseconds, self.error_bound(m), total, discretization, iteration, model];
            values.extend(m.motion.iter().flat_map(|motion| [motion.rms_percent, motion.drift_percent]));
            let values: String = values.iter().map(|value| format!("{value:>14.4}")).collect();
            let undecided = if m.undecided { " (rank undecided)" } else { "" };
            let _ = writeln!(text, "{values}   {}{undecided}", m.setting);
        }
        if front.iter().any(|m| m.undecided) {
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
        let rivals = distinct(self.measurements.iter().map(rival));
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
}

impl std::fmt::Display for Tuning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { chosen, demand, met, study } = self;
        writeln!(f, "{}: error of the first probe against {}", study.scene, study.reference.text)?;
        let reason = match (met, demand.max_error_percent.is_some(), demand.time_is_met(chosen)) {
            (true, true, _) => "the fastest",
            (true, false, _) => "the most accurate",
            (false, _, true) => "the most accurate within the time",
            (false, _, false) => "the fastest of all",
        };
        let undecided = match chosen.undecided && reason.starts_with("the most accurate") {
            true => ", undecided: the errors of faster ones differ by less than the reference's own",
            false => "",
        };
        let ended = study.measurements.iter().filter(|m| m.converged);
        let meeting = match ended.clone().filter(|m| *met && study.meets(m, *demand)).count() {
            0 => format!("none of {} settings measured here meets", ended.count()),
            n => format!("{n} of {} settings measured here meet", ended.count()),
        };
        writeln!(f, "{meeting} {demand}; {reason}{undecided}:")?;
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
        let asked = demand.max_error_percent.filter(|_| !met);
        let within = asked.map_or_else(Vec::new, |percent| study.within(percent));
        match within.into_iter().find(|m| m.converged) {
            Some(other) => write!(f, "\nthe fastest within the error:\n  {}", cost(other)),
            None => Ok(()),
        }
    }
}

//! Report of the study of a motion: table and summary.

use std::fmt::Write as _;

use super::claim::Claim;
use super::motion::{MotionReference, REAL_TIME};
use super::setting::{Setting, Stepping, mesh_text, step_text};
use super::trade::{Ending, EnergyBehaviour, ErrorSplit, Measurement, MotionFigures, Study};
use crate::dynamics::INTEGRATORS;
use crate::format::{count, number};
use crate::scene::MethodKind;

impl Study {
    /// Returns each measurement with its time stepping and figures.
    fn motions(&self) -> impl Iterator<Item = (&Measurement, Stepping, &MotionFigures)> {
        self.measurements.iter().filter_map(|m| Some((m, m.setting.stepping?, m.motion.as_ref()?)))
    }

    /// Formats the study as CSV. `solves` is the number per step or stage, 0 to iterate to the tolerance; `resolved` is
    /// `true` if the sum of the error's parts, `error_bound_percent`, is above the reference's own error;
    /// `at_most_percent` includes it. Motions that did not finish have no error.
    pub(super) fn motion_table(&self, reference: &MotionReference) -> String {
        let mut text = String::from(
            "element,cells_along,cells_across,dofs,integrator,method,time_step_s,solves,ending,ms_per_simulated_second,error_percent,rms_error_percent,discretization_percent,integration_percent,model_percent,error_bound_percent,resolved,energy_drift_percent,energy,steps_taken,solves_taken,factorizations,pareto,at_most_percent,undecided\n",
        );
        for ((m, stepping, motion), undecided) in self.motions().zip(self.undecided()) {
            let [along, across] = m.setting.cells.unwrap_or([0, 0]);
            let error = m.error.map_or_else(
                || ",,,,,,".to_owned(),
                |e| {
                    let parts = [e.total, motion.rms_percent, e.discretization, e.iteration, e.model, e.bound()];
                    let resolved = e.bound() > reference.error_percent;
                    format!("{},{resolved}", parts.map(|v| format!("{v:e}")).join(","))
                },
            );
            let _ = writeln!(
                text,
                "{},{along},{across},{},{},{},{:e},{},{},{:.4},{error},{:e},{},{},{},{},{},{},{undecided}",
                m.setting.element.id(),
                m.dofs,
                stepping.integrator.id(),
                m.setting.method.id(),
                stepping.time_step,
                m.setting.iterations,
                motion.ending.id(),
                m.milliseconds,
                motion.drift_percent,
                motion.energy().id(),
                motion.counts.steps,
                motion.counts.solves,
                motion.counts.factorizations,
                m.pareto,
                m.error.map_or_else(String::new, |_| format!("{:e}", self.error_bound(m)))
            );
        }
        text
    }

    /// Formats a summary for display: reference, Pareto front, results in real time, and energy behaviour.
    pub(super) fn motion_summary(&self, reference: &MotionReference) -> String {
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
        text.push_str(
            "\nPareto front: no measured setting is both faster and more accurate (time: per simulated \
             second; error: at most the sum of its parts and of the reference's own error):\n",
        );
        text.push_str(
            "    time, ms   at most, %    measured         rms   mesh error  time steps  linear theory   energy, %   setting\n",
        );
        self.add_front(&mut text, |m, ErrorSplit { total, discretization, iteration, model }| {
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
        if let Claim::NotKnown { .. } = Claim::of_study(self, 1.0) {
            text.push('\n');
            return;
        }
        let close = self.within(1.0);
        let real = close.first().filter(|m| m.milliseconds <= REAL_TIME);
        let cost = real.map_or_else(
            || match close.first() {
                None => "no measured setting is within 1 %".to_owned(),
                Some(fastest) => {
                    format!("within 1 %, no measured setting runs in real time; the fastest: {}", cost_text(fastest))
                }
            },
            |m| {
                let times = REAL_TIME / m.milliseconds;
                format!("within 1 %, the fastest setting runs at {times:.0} times real time: {}", m.setting)
            },
        );
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
                m.error.map_or_else(|| motion.ending.id().replace('_', " "), |e| format!("{:.4}", e.iteration)),
                motion.drift_percent,
                motion.energy().id(),
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
        for (ending, label) in [
            (Ending::Stopped, "stopped before the end"),
            (Ending::CutShort, "stopped early: too many steps to the end"),
        ] {
            let those: Vec<_> = self.motions().filter(|(.., motion)| motion.ending == ending).collect();
            if !those.is_empty() {
                let _ = writeln!(text, "{} {label}:", count(those.len() as u64, "setting"));
            }
            for (m, ..) in those {
                let _ = writeln!(text, "    {} ({:.0} ms per simulated second)", m.setting, m.milliseconds);
            }
        }
        let gained = self.motions().filter(|(.., motion)| motion.energy() == EnergyBehaviour::Gained);
        let most = gained.max_by(|(.., a), (.., b)| a.drift_percent.total_cmp(&b.drift_percent));
        if let Some((m, _, motion)) = most {
            let _ = writeln!(text, "the most energy was gained, {:.2} %, by {}", motion.drift_percent, m.setting);
        }
    }
}

fn cost_text(m: &Measurement) -> String {
    format!("{}, {}", m.time_text(), m.setting)
}

/// Rounds to six decimal places, for sums of steps.
fn round(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

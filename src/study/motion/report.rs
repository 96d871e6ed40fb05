//! Report of the study of motions: table and summary.

use std::fmt::Write as _;

use super::{Ending, EnergyBehaviour, MotionMeasurement, MotionSetting, MotionStudy, PathError, REAL_TIME, step_text};
use crate::dynamics::INTEGRATORS;
use crate::format::{count, number};
use crate::scene::MethodKind;
use crate::study::claim::Claim;
use crate::study::ranking::Ranked;
use crate::study::trade::mesh_text;

impl MotionStudy {
    /// Formats the study as CSV. `solves` is the number per step or stage, 0 to iterate to the tolerance; `resolved` is
    /// `true` if the sum of the error's parts, `error_bound_percent`, is above the reference's own error;
    /// `at_most_percent` includes it. Motions that did not finish have no error.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = String::from(
            "element,cells_along,cells_across,dofs,integrator,method,time_step_s,solves,ending,ms_per_simulated_second,error_percent,rms_error_percent,discretization_percent,integration_percent,model_percent,error_bound_percent,resolved,energy_drift_percent,energy,steps_taken,solves_taken,factorizations,pareto,at_most_percent,undecided\n",
        );
        let ranking = self.ranking();
        for (m, undecided) in self.measurements.iter().zip(ranking.undecided()) {
            let [along, across] = m.setting.cells.unwrap_or([0, 0]);
            let error = m.error.map_or_else(
                || ",,,,,,".to_owned(),
                |e| {
                    let parts = [e.total, e.rms, e.discretization, e.integration, e.model, e.bound()];
                    let resolved = e.bound() > self.reference.error_percent;
                    format!("{},{resolved}", parts.map(|v| format!("{v:e}")).join(","))
                },
            );
            let _ = writeln!(
                text,
                "{},{along},{across},{},{},{},{:e},{},{},{:.4},{error},{:e},{},{},{},{},{},{},{undecided}",
                m.setting.element.id(),
                m.dofs,
                m.setting.integrator.id(),
                m.setting.method.id(),
                m.setting.time_step,
                m.setting.iterations,
                m.ending.id(),
                m.milliseconds,
                m.drift_percent,
                m.energy().id(),
                m.counts.steps,
                m.counts.solves,
                m.counts.factorizations,
                m.pareto,
                m.error.map_or_else(String::new, |_| format!("{:e}", ranking.error_bound(m)))
            );
        }
        text
    }

    /// Formats a summary for display: reference, Pareto front, results in real time, and energy behaviour.
    #[must_use]
    pub fn summary(&self) -> String {
        let mut text = format!(
            "{}: error of the first probe's path: largest distance over {} s, percent of its largest displacement \
             {:.4} m,\nagainst {}\n",
            self.scene,
            number(round(self.duration)),
            self.reference.size,
            self.reference
        );
        if self.duration < self.scene_duration * (1.0 - 1e-6) {
            let _ = writeln!(text, "(the scene lasts {} s; the rest is not measured)", number(self.scene_duration));
        }
        text.push_str(
            "\nPareto front: no measured setting is both faster and more accurate (time: per simulated \
             second; error: at most the sum of its parts and of the reference's own error):\n",
        );
        text.push_str(
            "    time, ms   at most, %    measured         rms   mesh error  time steps  linear theory   energy, %   setting\n",
        );
        let ranking = self.ranking();
        ranking.add_front(&mut text, |m| {
            let bound = ranking.error_bound(m);
            let parts = m.error.map_or_else(String::new, |e| {
                let PathError { total, rms, discretization, integration, model } = e;
                format!("{total:11.4} {rms:11.4} {discretization:12.4} {integration:11.4} {model:14.4}")
            });
            format!("{:12.3} {bound:12.4} {parts} {:11.4}", m.milliseconds, m.drift_percent)
        });
        self.costs(&mut text);
        self.steps(&mut text);
        self.auto(&mut text);
        self.unfinished(&mut text);
        text
    }

    /// Adds the cost of given errors with every integrator.
    fn costs(&self, text: &mut String) {
        let ranking = self.ranking();
        ranking.add_costs(text, |text, percent| {
            let within = ranking.within(percent);
            for integrator in INTEGRATORS {
                let own = within.iter().find(|m| m.setting.integrator == integrator.kind);
                let cost = own.map_or_else(|| "not reached".to_owned(), |m| cost_text(m));
                let _ = writeln!(text, "    {:<16} {cost}", integrator.id);
            }
        });
        if let Claim::NotKnown { .. } = Claim::of_ranking(ranking, 1.0) {
            text.push('\n');
            return;
        }
        let close = ranking.within(1.0);
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
    fn steps(&self, text: &mut String) {
        let _ = writeln!(
            text,
            "by time step, newton on {}: error of the time steps, %; energy drift, % of the largest kinetic energy; \
             time per simulated second, ms",
            mesh_text(self.reference.element, self.own_mesh)
        );
        let own = |m: &&MotionMeasurement| {
            let MotionSetting { element, cells, method, .. } = m.setting;
            (element, cells, method) == (self.reference.element, self.own_mesh, MethodKind::Newton)
        };
        for m in self.measurements.iter().filter(own) {
            let setting = &m.setting;
            let _ = writeln!(
                text,
                "    {:<16} {:<18} {:>10}  {:>12} {:>12.5} {:<6} {:>10.3}",
                setting.integrator.id(),
                setting.solves_text().to_string(),
                step_text(setting.time_step),
                m.error.map_or_else(|| m.ending.id().replace('_', " "), |e| format!("{:.4}", e.integration)),
                m.drift_percent,
                m.energy().id(),
                m.milliseconds
            );
        }
        text.push('\n');
    }

    /// Adds the savings of `auto` compared with `newton`.
    fn auto(&self, text: &mut String) {
        let pairs = self.measurements.iter().filter(|m| m.setting.method == MethodKind::Auto).filter_map(|auto| {
            let setting = MotionSetting { method: MethodKind::Newton, ..auto.setting };
            let newton = self.measurements.iter().find(|m| m.setting == setting)?;
            let farther = auto.error?.bound() - newton.error?.bound();
            let factors = auto.counts.factorizations as f64 / newton.counts.factorizations.max(1) as f64;
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
    fn unfinished(&self, text: &mut String) {
        for (ending, label) in [
            (Ending::Stopped, "stopped before the end"),
            (Ending::CutShort, "stopped early: too many steps to the end"),
        ] {
            let those: Vec<_> = self.measurements.iter().filter(|m| m.ending == ending).collect();
            if !those.is_empty() {
                let _ = writeln!(text, "{} {label}:", count(those.len() as u64, "setting"));
            }
            for m in those {
                let _ = writeln!(text, "    {} ({:.0} ms per simulated second)", m.setting, m.milliseconds);
            }
        }
        let gained = self.measurements.iter().filter(|m| m.energy() == EnergyBehaviour::Gained);
        let most = gained.max_by(|a, b| a.drift_percent.total_cmp(&b.drift_percent));
        if let Some(m) = most {
            let _ = writeln!(text, "the most energy was gained, {:.2} %, by {}", m.drift_percent, m.setting);
        }
    }
}

fn cost_text(m: &MotionMeasurement) -> String {
    format!("{}, {}", m.time_text(), m.setting)
}

/// Rounds to six decimal places, for sums of steps.
fn round(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

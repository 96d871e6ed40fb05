//! Reports of the speed–accuracy study, table and summary, and of a tuning.

use std::fmt::Write as _;
use std::time::Duration;

use super::claim::Claim;
use super::trade::Study;
use super::tune::Tuning;
use crate::method::METHODS;
use crate::scene::{ElementKind, MethodKind};

/// Mark of a setting whose rank is undecided.
pub(super) const UNDECIDED: &str = " (rank undecided)";

impl Study {
    /// Formats the study as CSV, with times in microseconds. `error_bound_percent` is the sum of the error's parts;
    /// `at_most_percent` includes the reference's own error.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = String::from(
            "element,cells_along,cells_across,dofs,method,iterations,converged,time_us,rotate_us,assemble_us,factorize_us,solve_us,error_percent,discretization_percent,iteration_percent,model_percent,error_bound_percent,pareto,at_most_percent,undecided\n",
        );
        for (m, undecided) in self.measurements.iter().zip(self.undecided()) {
            let [along, across] = m.setting.cells.unwrap_or([0, 0]);
            let us = |d: Duration| d.as_secs_f64() * 1e6;
            let (t, e) = (&m.time, &m.error);
            let _ = writeln!(
                text,
                "{},{along},{across},{},{},{},{},{:.2},{:.2},{:.2},{:.2},{:.2},{:e},{:e},{:e},{:e},{:e},{},{:e},{undecided}",
                m.setting.element.id(),
                m.dofs,
                m.setting.method.id(),
                m.setting.iterations,
                m.converged,
                us(t.total()),
                us(t.rotate),
                us(t.assemble),
                us(t.factorize),
                us(t.solve),
                e.total,
                e.discretization,
                e.iteration,
                e.model,
                e.bound(),
                m.pareto,
                self.error_bound(m)
            );
        }
        text
    }

    /// Formats a summary for display: reference solution, Pareto front, and cost of given errors.
    #[must_use]
    pub fn summary(&self) -> String {
        let mut text = format!("{}: error of the first probe against {}\n\n", self.scene, self.reference);
        text.push_str(
            "Pareto front: no measured setting is both faster and more accurate (error: at most the sum of its parts and \
             of the reference's own error):\n",
        );
        text.push_str("    time, ms    at most, %     measured   mesh error  stopped early  linear theory   setting\n");
        let ranked = self.measurements.iter().zip(self.undecided()).filter(|(m, _)| m.pareto);
        let mut front: Vec<_> = ranked.collect();
        front.sort_by_key(|(m, _)| m.time.total());
        for (m, undecided) in &front {
            let e = &m.error;
            let _ = writeln!(
                text,
                "{:12.4} {:12.4} {:12.4} {:12.4} {:14.4} {:14.4}   {}{}",
                m.milliseconds(),
                self.error_bound(m),
                e.total,
                e.discretization,
                e.iteration,
                e.model,
                m.setting,
                if *undecided { UNDECIDED } else { "" }
            );
        }
        let own = self.against.own_error_percent;
        if front.iter().any(|(_, undecided)| *undecided) {
            let _ = writeln!(text, "{}", Claim::Undecided(own));
        }
        text.push('\n');
        for percent in [10.0, 1.0, 0.1] {
            let claim = Claim::of_study(self, percent);
            let _ = writeln!(text, "{claim}");
            if matches!(claim, Claim::NotKnown { .. }) {
                continue;
            }
            for element in ElementKind::all() {
                for method in METHODS.iter().map(|m| m.kind) {
                    let own = self.measurements.iter().filter(|m| {
                        (m.setting.element, m.setting.method) == (element, method) && self.error_bound(m) <= percent
                    });
                    let cost = match own.min_by_key(|m| m.time.total()) {
                        Some(m) => format!("{:.4} ms", m.milliseconds()),
                        None if method == MethodKind::Auto && percent < self.asked_percent => {
                            format!("solver.max_error_percent is {}", self.asked_percent)
                        }
                        None => "not reached".to_owned(),
                    };
                    let _ = writeln!(text, "    {} {:<7} {cost}", element.id(), method.id());
                }
            }
        }
        text
    }
}

impl std::fmt::Display for Tuning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { chosen, study, .. } = self;
        let e = &chosen.error;
        writeln!(f, "{}: error of the first probe against {}", study.scene, study.reference)?;
        writeln!(f, "{}:", Claim::of_tuning(self))?;
        writeln!(
            f,
            "  {}: {:.4} ms, error at most {:.4} %",
            chosen.setting,
            chosen.milliseconds(),
            study.error_bound(chosen)
        )?;
        write!(
            f,
            "  of which mesh {:.4} %, stopped early {:.4} %, linear theory {:.4} %, the reference's own {:.4} %",
            e.discretization, e.iteration, e.model, study.against.own_error_percent
        )
    }
}

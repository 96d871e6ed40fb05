//! Report of the speed–accuracy study: table and summary.

use std::fmt::Write as _;
use std::time::Duration;

use super::trade::Study;
use crate::method::METHODS;
use crate::scene::{ElementKind, MethodKind};

impl Study {
    /// Formats the study as CSV, with times in microseconds.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = String::from(
            "element,cells_along,cells_across,dofs,method,iterations,converged,time_us,rotate_us,assemble_us,factorize_us,solve_us,error_percent,discretization_percent,iteration_percent,model_percent,error_bound_percent,pareto\n",
        );
        for m in &self.measurements {
            let [along, across] = m.setting.cells.unwrap_or([0, 0]);
            let us = |d: Duration| d.as_secs_f64() * 1e6;
            let (t, e) = (&m.time, &m.error);
            let _ = writeln!(
                text,
                "{},{along},{across},{},{},{},{},{:.2},{:.2},{:.2},{:.2},{:.2},{:e},{:e},{:e},{:e},{:e},{}",
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
                m.pareto
            );
        }
        text
    }

    /// Formats a summary for display: reference solution, Pareto front, and cost of given errors.
    #[must_use]
    pub fn summary(&self) -> String {
        let mut text = format!("{}: error of the first probe against {}\n\n", self.scene, self.reference);
        text.push_str(
            "Pareto front: no measured setting is both faster and more accurate (error: at most the sum of its parts):\n",
        );
        text.push_str("    time, ms    at most, %     measured   mesh error  stopped early  linear theory   setting\n");
        for m in self.front() {
            let e = &m.error;
            let _ = writeln!(
                text,
                "{:12.4} {:12.4} {:12.4} {:12.4} {:14.4} {:14.4}   {}",
                m.milliseconds(),
                e.bound(),
                e.total,
                e.discretization,
                e.iteration,
                e.model,
                m.setting
            );
        }
        text.push('\n');
        let own = self.against.own_error_percent;
        for percent in [10.0, 1.0, 0.1] {
            if own >= percent {
                let _ =
                    writeln!(text, "an error of {percent} %: not known, the reference's own error may be {own:.2} %");
                continue;
            }
            let cost = self
                .cheapest_within(percent)
                .map_or_else(|| "not reached".to_owned(), |m| format!("{:.4} ms, {}", m.milliseconds(), m.setting));
            let _ = writeln!(text, "an error of {percent} % costs {cost}");
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

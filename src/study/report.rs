//! Reports of the speed–accuracy study, table and summary, and of a tuning.

use std::fmt::Write as _;
use std::time::Duration;

use super::claim::Claim;
use super::trade::{ErrorSplit, Measurement, Study, StudyReference};
use super::tune::Tuning;
use crate::method::METHODS;
use crate::scene::{ElementKind, MethodKind};

impl Study {
    /// Formats the study as CSV. At rest, times are in microseconds. `error_bound_percent` is the sum of the error's parts;
    /// `at_most_percent` includes the reference's own error. A motion has the columns of `docs/reference/results.md`.
    #[must_use]
    pub fn table(&self) -> String {
        match &self.reference {
            StudyReference::Rest(_) => self.table_at_rest(),
            StudyReference::Motion(reference) => self.motion_table(reference),
        }
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

    fn table_at_rest(&self) -> String {
        let mut text = String::from(
            "element,cells_along,cells_across,dofs,method,iterations,converged,time_us,rotate_us,assemble_us,factorize_us,solve_us,error_percent,discretization_percent,iteration_percent,model_percent,error_bound_percent,pareto,at_most_percent,undecided\n",
        );
        for (m, undecided) in self.measurements.iter().zip(self.undecided()) {
            let [along, across] = m.setting.cells.unwrap_or([0, 0]);
            let us = |d: Duration| d.as_secs_f64() * 1e6;
            let (t, Some(e)) = (&m.time, m.error) else { continue };
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
                us(t.linearize),
                us(t.factorize),
                us(t.solve + t.advance),
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

    fn summary_at_rest(&self) -> String {
        let mut text = format!("{}: error of the first probe against {}\n\n", self.scene, self.reference);
        text.push_str(
            "Pareto front: no measured setting is both faster and more accurate (error: at most the sum of its parts and \
             of the reference's own error):\n",
        );
        text.push_str("    time, ms    at most, %     measured   mesh error  stopped early  linear theory   setting\n");
        self.add_front(&mut text, |m, ErrorSplit { total, discretization, iteration, model }| {
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
    /// formats time and errors of a setting.
    pub(super) fn add_front(&self, text: &mut String, row: impl Fn(&Measurement, ErrorSplit) -> String) {
        let ranked = self.measurements.iter().zip(self.undecided()).filter(|(m, _)| m.pareto);
        let mut front: Vec<_> = ranked.filter_map(|(m, undecided)| Some((m, m.error?, undecided))).collect();
        front.sort_by(|(a, ..), (b, ..)| a.milliseconds.total_cmp(&b.milliseconds));
        for (m, error, undecided) in &front {
            let mark = if *undecided { " (rank undecided)" } else { "" };
            let _ = writeln!(text, "{}   {}{mark}", row(m, *error), m.setting);
        }
        if front.iter().any(|(.., undecided)| *undecided) {
            let _ = writeln!(text, "{}", Claim::Undecided(self.own_error_percent));
        }
        text.push('\n');
    }

    /// Adds the fastest setting with an error of at most 10, 1 and 0.1 %, and the `details` of each.
    pub(super) fn add_costs(&self, text: &mut String, details: impl Fn(&mut String, f64)) {
        for percent in [10.0, 1.0, 0.1] {
            let claim = Claim::of_study(self, percent);
            let _ = writeln!(text, "{claim}");
            if !matches!(claim, Claim::NotKnown { .. }) {
                details(text, percent);
            }
        }
    }
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

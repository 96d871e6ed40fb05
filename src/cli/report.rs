//! What commands print.

use std::fmt::Write as _;
use std::io::Write as _;
use std::time::Duration;

use serde_json::{Value, json};

use crate::method::rho_words;
use crate::scene::limits::count;
use crate::scene::{Scene, registry};
use crate::simulation::{Certificate, Solution, Status};
use crate::study::{Choice, LoadCurve};

/// Prints to standard output. A reader that went away, such as `head`, is no error.
pub(super) fn print(text: &str) {
    let mut out = std::io::stdout().lock();
    let _ = out.write_all(text.as_bytes());
    let _ = out.flush();
}

/// The list of built-in scenes.
pub(super) fn scenes() -> String {
    let mut text = String::new();
    for built_in in registry::BUILT_IN {
        // The registry's own files are checked by a test; one that did not read would still be listed.
        let (name, about) = Scene::from_toml(built_in.toml, built_in.id.as_ref())
            .map_or_else(|error| (error.to_string(), String::new()), |scene| (scene.name, scene.about));
        let _ = writeln!(text, "{:<12} {name}\n{:12} {about}", built_in.id, "");
    }
    text
}

/// A result for people, and why `auto` chose as it did.
pub(super) fn text(scene: &Scene, solution: &Solution, choice: Option<&Choice>) -> String {
    let mut text = choice.map_or_else(String::new, |choice| format!("{choice}\n\n"));
    let _ = writeln!(
        text,
        "{}: element {}, method {}, {} unknowns",
        scene.name,
        scene.element().id(),
        scene.solver.method.id(),
        solution.dofs
    );
    let word = solution.status.id().replace('_', " ");
    let _ = writeln!(
        text,
        "{word} after {}, relative residual {:.2e}",
        count(solution.iterations, "iteration"),
        solution.residual
    );
    if let Status::NotConverged(reason) | Status::Diverged(reason) = &solution.status {
        let _ = writeln!(text, "  {reason}");
    }
    if let Some(thrift) = &solution.thrift {
        let _ = writeln!(
            text,
            "{}: estimated error {:.4} %, {}, {}",
            thrift.decision,
            100.0 * thrift.estimated_error,
            count(thrift.solves, "back substitution"),
            count(thrift.factorizations, "factorization")
        );
    }
    let Certificate { stable, fixed_point_rho } = solution.certificate;
    if solution.status == Status::Converged && stable == Some(false) {
        let _ = writeln!(text, "  this equilibrium is unstable: the exact tangent is not positive definite");
    }
    if let Some(rho) = fixed_point_rho {
        let _ = writeln!(text, "{}", rho_words(rho));
    }
    for probe in &solution.probes {
        let _ = writeln!(
            text,
            "{}: at ({:.6}, {:.6}) m, moved by ({:.6}, {:.6}) m",
            probe.name, probe.x.x, probe.x.y, probe.u.x, probe.u.y
        );
        if let (Some(truth), Some(error)) = (probe.truth, probe.error_percent()) {
            let _ = writeln!(text, "  beam theory: ({:.6}, {:.6}) m, error {error:.3} %", truth.x, truth.y);
        }
    }
    let _ = writeln!(
        text,
        "largest rotation {:.2}°, largest strain {:.4}, inverted elements {}",
        solution.max_rotation_deg, solution.max_strain, solution.inverted_elements
    );
    let _ = writeln!(
        text,
        "reaction ({:.6}, {:.6}) N, moment about the origin {:.6} N m",
        solution.reaction.force.x, solution.reaction.force.y, solution.reaction.moment
    );
    let _ = writeln!(
        text,
        "elastic energy {:.6} J, work of the loads {:.6} J",
        solution.energy.elastic, solution.energy.external
    );
    let time = &solution.time;
    let _ = writeln!(
        text,
        "time {:.0} µs: rotate {:.0}, assemble {:.0}, factorize {:.0}, solve {:.0}",
        microseconds(time.total()),
        microseconds(time.rotate),
        microseconds(time.assemble),
        microseconds(time.factorize),
        microseconds(time.solve)
    );
    text
}

/// A load–deflection curve for people.
pub(super) fn curve(scene: &Scene, curve: &LoadCurve) -> String {
    let mut text = format!("{}: tip displacement, m\n\n", scene.name);
    let _ =
        writeln!(text, "  load   linear theory            exact beam               linear error   tip turn   strain");
    for sample in curve.samples.iter().step_by(5).skip(1) {
        let _ = writeln!(
            text,
            "{:5.1} %  ({:9.4}, {:9.4})   ({:9.4}, {:9.4})   {:9.2} %   {:7.2}°   {:.5}",
            100.0 * sample.factor,
            sample.linear.x,
            sample.linear.y,
            sample.truth.x,
            sample.truth.y,
            sample.linear_error_percent(),
            sample.rotation.to_degrees(),
            sample.strain
        );
    }
    text.push('\n');
    for limit in &curve.limits {
        let _ = writeln!(
            text,
            "linear theory is off by {} % at {:.1} % of the load: the tip has turned by {:.1}°, the largest strain is {:.2} %",
            limit.percent,
            100.0 * limit.at.factor,
            limit.at.rotation.to_degrees().abs(),
            100.0 * limit.at.strain
        );
    }
    text.push('\n');
    for point in &curve.methods {
        let word = point.status.id().replace('_', " ");
        let _ =
            writeln!(text, "{:<7} at full load: ({:.4}, {:.4}) m, {word}", point.method.id(), point.tip.x, point.tip.y);
    }
    text
}

/// A load–deflection curve as CSV.
pub(super) fn curve_table(curve: &LoadCurve) -> String {
    let mut text =
        String::from("load_factor,linear_x,linear_y,truth_x,truth_y,linear_error_percent,tip_rotation_deg,strain\n");
    for s in &curve.samples {
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{}",
            s.factor,
            s.linear.x,
            s.linear.y,
            s.truth.x,
            s.truth.y,
            s.linear_error_percent(),
            s.rotation.to_degrees(),
            s.strain
        );
    }
    text
}

fn microseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

/// What `auto` chose, for programs.
fn choice_value(choice: &Choice) -> Value {
    let (chosen, e) = (&choice.chosen, &choice.chosen.error);
    json!({
        "max_error_percent": choice.demand.max_error_percent,
        "budget_ms": choice.demand.budget_ms,
        "met": choice.met,
        "settings_measured": choice.measured,
        "settings_meeting": choice.meeting,
        "chosen": {
            "element": chosen.setting.element.id(),
            "cells": chosen.setting.cells,
            "method": chosen.setting.method.id(),
            "iterations": chosen.setting.iterations,
            "time_ms": number(chosen.milliseconds()),
            "error_percent": {
                "at_most": number(e.bound() + choice.truth_error_percent),
                "mesh": number(e.discretization),
                "stopped_early": number(e.iteration),
                "linear_theory": number(e.model),
                "truth": number(choice.truth_error_percent),
            },
        },
    })
}

/// A result for programs: the object of the documented contract.
pub(super) fn json(scene: &Scene, solution: &Solution, choice: Option<&Choice>) -> String {
    let pair = |v: &nalgebra::Vector2<f64>| json!([number(v.x), number(v.y)]);
    let probes: Vec<Value> = solution
        .probes
        .iter()
        .map(|p| {
            json!({
                "name": p.name,
                "x": pair(&p.x),
                "u": pair(&p.u),
                "truth_u": p.truth.map(|t| pair(&t)),
                "error_percent": p.error_percent().map(number),
            })
        })
        .collect();
    let time = &solution.time;
    let mut object = json!({
        "scene": scene.name,
        "element": scene.element().id(),
        "method": scene.solver.method.id(),
        "dofs": solution.dofs,
        "status": solution.status.id(),
        "stable": solution.certificate.stable,
        "iterations": solution.iterations,
        "load_steps": solution.load_steps,
        "residual": number(solution.residual),
        "fixed_point_rho": solution.certificate.fixed_point_rho.map(number),
        "max_rotation_deg": number(solution.max_rotation_deg),
        "max_strain": number(solution.max_strain),
        "inverted_elements": solution.inverted_elements,
        "probes": probes,
        "energy": {
            "elastic": number(solution.energy.elastic),
            "external": number(solution.energy.external),
            "kinetic": 0.0,
            "dissipated": 0.0,
        },
        "reaction": { "force": pair(&solution.reaction.force), "moment": number(solution.reaction.moment) },
        "time_us": {
            "total": number(microseconds(time.total())),
            "rotate": number(microseconds(time.rotate)),
            "assemble": number(microseconds(time.assemble)),
            "factorize": number(microseconds(time.factorize)),
            "solve": number(microseconds(time.solve)),
        },
    });
    // Only where it decided: everyone else gets the documented object and nothing more.
    if choice.is_some() || solution.thrift.is_some() {
        let thrift = solution.thrift.map(|t| {
            json!({
                "decision": t.decision.id(),
                "estimated_error_percent": number(100.0 * t.estimated_error),
                "solves": t.solves,
                "factorizations": t.factorizations,
            })
        });
        object["auto"] = json!({ "choice": choice.map(choice_value), "thrift": thrift });
    }
    format!("{object:#}\n")
}

/// A number JSON can hold: what left the range of f64 is reported as its largest number.
fn number(value: f64) -> f64 {
    if value.is_nan() { f64::MAX } else { value.clamp(-f64::MAX, f64::MAX) }
}

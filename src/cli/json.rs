//! What commands print for programs: the object of the documented contract.

use std::time::Duration;

use nalgebra::Vector2;
use serde_json::{Value, json};

use crate::scene::Scene;
use crate::simulation::{MotionResult, ProbeResult, Solution};
use crate::study::{ProbeTruth, Reference};

/// A result.
pub(super) fn solution(scene: &Scene, solution: &Solution, truth: Option<&Reference>) -> String {
    let truths = truth.map_or(&[][..], Reference::probes);
    let probes: Vec<Value> = solution.probes.iter().enumerate().map(|(i, p)| probe(p, truths.get(i))).collect();
    let certificate = solution.certificate.unwrap_or_default();
    let (deformation, time) = (&solution.deformation, &solution.time);
    let mut object = json!({
        "scene": scene.name,
        "element": scene.element().id(),
        "method": scene.solver.method.id(),
        "dofs": solution.dofs,
        "status": solution.status.id(),
        "stable": certificate.stable,
        "iterations": solution.iterations,
        "load_steps": solution.load_steps,
        "residual": number(solution.residual),
        "fixed_point_rho": certificate.fixed_point_rho.map(number),
        "max_rotation_deg": number(deformation.max_rotation_deg),
        "max_strain": number(deformation.max_strain),
        "inverted_elements": deformation.inverted_elements,
        "probes": probes,
        "energy": {
            "elastic": number(solution.energy.elastic),
            "external": number(solution.energy.external),
            // A body at rest has neither.
            "kinetic": solution.motion.map(|m| number(m.ledger.kinetic)),
            "dissipated": solution.motion.map(|m| number(m.ledger.dissipated)),
        },
        "reaction": { "force": pair(solution.reaction.force), "moment": number(solution.reaction.moment) },
        "time_us": {
            "total": microseconds(time.total()),
            "rotate": microseconds(time.rotate),
            "assemble": microseconds(time.assemble),
            "factorize": microseconds(time.factorize),
            "solve": microseconds(time.solve),
        },
    });
    // Only where it decided: everyone else gets the documented object and nothing more.
    if let Some(auto) = &solution.auto {
        object["auto"] = json!({
            "decision": auto.decision.id(),
            "estimated_error_percent": number(100.0 * auto.estimated_error),
            "solves": auto.solves,
            "factorizations": auto.factorizations,
        });
    }
    if let Some(motion) = &solution.motion {
        add_motion(&mut object, scene, motion);
    }
    format!("{object:#}\n")
}

/// What the object of a body in motion has beside.
fn add_motion(object: &mut Value, scene: &Scene, motion: &MotionResult) {
    let MotionResult { time, counts, ledger, momentum, critical_step, auto, .. } = motion;
    object["integrator"] = json!(scene.dynamics.integrator.id());
    object["time"] = number(*time);
    object["steps"] = json!(counts.steps);
    object["halvings"] = json!(counts.halvings);
    object["critical_step"] = critical_step.map_or(Value::Null, number);
    object["energy_drift"] = number(ledger.drift());
    if let Some(auto) = auto {
        object["auto"] = json!({
            "decision": auto.decision.id(),
            "solves": auto.solves,
            "factorizations": auto.factorizations,
            "linear_steps": auto.linear_steps,
            "old_factor_steps": auto.old_factor_steps,
            "new_factor_steps": auto.new_factor_steps,
        });
    }
    object["momentum"] = json!({ "linear": pair(momentum.linear), "angular": number(momentum.angular) });
    let energy = &mut object["energy"];
    energy["integrator"] = number(ledger.integrator);
    energy["pulses"] = number(ledger.pulses);
    energy["hands"] = number(ledger.hands);
}

fn probe(result: &ProbeResult, truth: Option<&ProbeTruth>) -> Value {
    json!({
        "name": result.name,
        "x": pair(result.x),
        "u": pair(result.u),
        "truth_u": truth.map(|t| pair(t.displacement)),
        "truth_source": truth.map(|t| t.source.to_string()),
        "error_percent": truth.and_then(|t| t.error_percent(result)).map(number),
    })
}

fn pair(v: Vector2<f64>) -> Value {
    json!([number(v.x), number(v.y)])
}

fn microseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

/// A number, or `null` for one that JSON cannot hold.
fn number(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

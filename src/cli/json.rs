//! JSON output of commands, as documented.

use std::time::Duration;

use nalgebra::Vector2;
use serde_json::{Map, Value, json};

use super::solved::SolvedScene;
use crate::scene::{Analysis, Place, Scene, Support};
use crate::section::{Section, SectionForces, SectionPoint};
use crate::simulation::{MotionResult, ProbeResult, ProbeStress, Status, StressResult, SupportReaction};
use crate::stress::PlaneTensor;
use crate::study::{ProbeReference, Reference};

/// Formats a result.
pub(super) fn solution(solved: &SolvedScene<'_>) -> String {
    let SolvedScene { scene, mesh, solution, stress, sections, path, reference, claims, warnings, spent } = *solved;
    // The last finite state of a diverging iteration has no meaning but its positions.
    let diverged = matches!(solution.status, Status::Diverged(_));
    let known = |value: f64| if diverged { Value::Null } else { number(value) };
    let stress = if diverged { &StressResult::default() } else { stress };
    let references = reference.map_or(&[][..], Reference::probes);
    let probes = solution.probes.iter().enumerate();
    let probes: Vec<Value> =
        probes.map(|(i, p)| probe(p, stress.probes.get(i), references.get(i).and_then(Option::as_ref))).collect();
    let supports: Vec<Value> = scene.supports.iter().zip(&solution.supports).map(|(s, r)| support(s, r)).collect();
    let certificate = solution.certificate.unwrap_or_default();
    let deformation = &solution.deformation;
    let parts = spent.parts().map(|(name, time)| (name.to_owned(), json!(microseconds(time))));
    let sums = [("total", spent.solve()), ("wall", spent.wall())];
    let sums = sums.map(|(name, time)| (name.to_owned(), json!(microseconds(time))));
    let time_us: Map<String, Value> = sums.into_iter().chain(parts).collect();
    let mut object = json!({
        "scene": scene.name,
        "element": scene.element().id(),
        "method": scene.solver.method.id(),
        "dofs": solution.dofs,
        "status": solution.status.id(),
        "reason": solution.status.failure(),
        "stable": certificate.stable,
        "jumped": path.map(|path| path.jump.is_some()),
        "jumped_at": path.and_then(|path| path.jump).map(|jump| number(jump.factor)),
        "buckles_at": path.and_then(|path| path.buckling).map(|buckling| number(buckling.factor)),
        "iterations": solution.iterations,
        "load_steps": solution.load_steps,
        "load_fraction": (scene.analysis == Analysis::Static).then(|| number(solution.load_factor)),
        "on_path_from_rest": path.map(|path| path.elsewhere.is_none()),
        "residual": number(solution.residual),
        "residual_floor": solution.residual_floor.map(number),
        "fixed_point_rho": certificate.fixed_point_rho.map(number),
        "max_rotation_deg": known(deformation.max_rotation_deg),
        "max_strain": known(deformation.max_strain),
        "inverted_elements": deformation.inverted_elements,
        "max_von_mises": stress.largest.map(|largest| json!({
            "value": number(largest.von_mises),
            "stress": "cauchy",
            "node": mesh.node_name(largest.node),
            "at": pair(largest.at),
        })),
        "mesh_error_percent": stress.mesh_error_percent.map(number),
        "mesh_error_of": "estimate: energy norm",
        "claims": claims.iter().map(|claim| json!({ "claim": claim.id(), "text": claim.to_string() })).collect::<Value>(),
        "warnings": warnings,
        "probes": probes,
        "sections": sections.iter().map(section).collect::<Value>(),
        "energy": {
            "elastic": known(solution.energy.elastic),
            "external": known(solution.energy.external),
            "supports": solution.energy.supports.map(number),
            // Null at rest.
            "kinetic": solution.motion.map(|m| number(m.ledger.kinetic)),
            "dissipated": solution.motion.map(|m| number(m.ledger.dissipated)),
        },
        "reaction": { "force": pair(solution.reaction.force), "moment": number(solution.reaction.moment) },
        "supports": supports,
        "time_us": time_us,
    });
    // Other methods have no `auto`.
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

/// Adds the values of a motion to the object.
fn add_motion(object: &mut Value, scene: &Scene, motion: &MotionResult) {
    let MotionResult { time, counts, ledger, momentum, critical_step, auto, .. } = motion;
    object["integrator"] = json!(scene.dynamics.integrator.id());
    object["time"] = number(*time);
    object["steps"] = json!(counts.steps);
    object["halvings"] = json!(counts.halvings);
    object["critical_step"] = critical_step.map_or(Value::Null, number);
    object["energy_drift"] = number(ledger.drift());
    object["energy_drift_of_input"] = number(ledger.drift_of_input());
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
    energy["hands"] = number(ledger.mouse_spring);
}

fn tensor(tensor: &PlaneTensor) -> Value {
    let [xx, yy, zz, xy] = tensor.components().map(number);
    json!({ "xx": xx, "yy": yy, "zz": zz, "xy": xy })
}

fn probe(result: &ProbeResult, stress: Option<&ProbeStress>, reference: Option<&ProbeReference>) -> Value {
    let (u, source) = (reference.map(|r| pair(r.displacement)), reference.map(|r| r.source));
    let cauchy = stress.and_then(|s| s.cauchy);
    json!({
        "name": result.name,
        "x": pair(result.x),
        "u": pair(result.u),
        "rotation_deg": stress.map(|s| number(s.rotation_deg)),
        "strain": stress.map(|s| tensor(&s.strain)),
        "stress": cauchy.map(|s| tensor(&s)),
        "von_mises": cauchy.map(|s| number(s.von_mises())),
        "reference_u": u,
        "reference_source": source.map(|source| source.to_string()),
        "reference_error_percent": reference.map(|r| number(r.own_error_percent)),
        "error_percent": reference.and_then(|r| r.error_percent(result)).map(number),
        // Deprecated names of version 0.1, kept for one more version.
        "truth_u": u,
        "truth_source": source.map(|source| source.to_string()),
    })
}

/// Formats a support and its reaction; the moment is about the middle of its edge.
fn support(support: &Support, reaction: &SupportReaction) -> Value {
    let mut object = Map::new();
    match &support.place {
        Place::Edge(edge) => object.insert("edge".to_owned(), json!(edge)),
        Place::At(at) => object.insert("at".to_owned(), json!(at)),
    };
    object.insert("displacement".to_owned(), pair(support.displacement.into()));
    object.insert("turn".to_owned(), number(support.turn));
    object.insert("force".to_owned(), pair(reaction.force));
    object.insert("moment".to_owned(), number(reaction.moment));
    Value::Object(object)
}

/// Returns a section as JSON.
pub(super) fn section(section: &Section) -> Value {
    let ends = |ends: [Vector2<f64>; 2]| json!(ends.map(pair));
    let forces = |forces: &SectionForces| {
        json!({
            "normal_force": number(forces.normal),
            "shear_force": number(forces.shear),
            "moment": number(forces.moment),
        })
    };
    let point = |point: &SectionPoint| {
        json!({
            "rest": pair(point.rest),
            "along": number(point.along),
            "normal_stress": point.stress.map(|stress| number(stress[0])),
            "shear_stress": point.stress.map(|stress| number(stress[1])),
            "beam_normal_stress": point.beam.map(|beam| number(beam[0])),
            "beam_shear_stress": point.beam.map(|beam| number(beam[1])),
        })
    };
    let mut object = forces(&section.forces);
    object["at"] = pair(section.line.at);
    object["angle"] = number(section.line.angle);
    object["rest"] = ends(section.rest);
    object["ends"] = ends(section.ends);
    object["normal"] = pair(section.normal());
    object["force"] = pair(section.force);
    object["of_stress"] = forces(&section.stress_forces);
    object["points"] = section.points.iter().map(point).collect::<Value>();
    object
}

pub(super) fn pair(v: Vector2<f64>) -> Value {
    json!([number(v.x), number(v.y)])
}

fn microseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

/// Returns a number, or `null` if it is not finite.
pub(super) fn number(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

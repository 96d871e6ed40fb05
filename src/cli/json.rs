//! JSON output of commands, as documented. A number that is not finite serializes to `null`.

use serde_json::{Map, Value, json};

use super::solved::SolvedScene;
use crate::scene::{Analysis, MethodKind, Place, Support};
use crate::section::{Section, SectionPoint};
use crate::simulation::{Motion, ProbeResult, ProbeStress, Simulation, Status, StressResult, SupportReaction};
use crate::stress::PlaneTensor;
use crate::study::{ProbeReference, Reference};

/// Formats an object for standard output.
pub(super) fn text(object: &Value) -> String {
    format!("{object:#}\n")
}

/// Formats a result.
pub(super) fn solution(solved: &SolvedScene<'_>) -> String {
    let SolvedScene { simulation, solution, stress, sections, path, reference, claims, warnings, .. } = solved;
    let (scene, ledger) = (simulation.scene(), simulation.motion().map(Motion::ledger));
    // The last finite state of a diverging iteration has no meaning but its positions.
    let diverged = matches!(solution.status, Status::Diverged(_));
    let known = |value: f64| (!diverged).then_some(value);
    let stress = if diverged { &StressResult::default() } else { stress };
    let references = reference.as_ref().map_or(&[][..], Reference::probes);
    let probes = solution.probes.iter().enumerate();
    let probes: Vec<Value> =
        probes.map(|(i, p)| probe(p, stress.probes.get(i), references.get(i).and_then(Option::as_ref))).collect();
    let supports = scene.supports.iter().zip(&solution.supports);
    let (certificate, deformation) = (solution.certificate.unwrap_or_default(), &solution.deformation);
    let times = [("total", solved.solve), ("wall", solved.wall)].into_iter().chain(solved.parts);
    let microseconds = times.map(|(name, time)| (name.to_owned(), json!(time.as_secs_f64() * 1e6)));
    let time_us: Map<String, Value> = microseconds.collect();
    // Linear theory follows no path.
    let followed = path.filter(|_| scene.solver.method != MethodKind::Linear);
    let mut object = json!({
        "scene": scene.name,
        "element": scene.element().id(),
        "method": scene.solver.method.id(),
        "dofs": solution.dofs,
        "status": solution.status.id(),
        "reason": solution.status.failure(),
        "stable": certificate.stable,
        "jumped": followed.map(|path| path.jump.is_some()),
        "jumped_at": path.and_then(|path| path.jump).map(|jump| jump.factor),
        "buckles_at": path.and_then(|path| path.buckling).map(|buckling| buckling.factor),
        "critical_at": path.and_then(|path| path.critical),
        "iterations": solution.iterations,
        "load_steps": solution.load_steps,
        "load_fraction": (scene.analysis == Analysis::Static).then_some(solution.load_factor),
        "on_path_from_rest": followed.map(|path| path.elsewhere.is_none()),
        "residual": solution.residual,
        "residual_floor": solution.residual_floor,
        "fixed_point_rho": certificate.fixed_point_rho,
        "max_rotation_deg": known(deformation.max_rotation_deg),
        "max_strain": known(deformation.max_strain),
        "area_change_percent": known(100.0 * deformation.area_change),
        "inverted_elements": deformation.inverted_elements,
        "max_von_mises": stress.largest.map(|(node, von_mises)| json!({
            "value": von_mises,
            "stress": "cauchy",
            "node": simulation.mesh().node_name(node),
            "at": simulation.mesh().node(node),
        })),
        "mesh_error_percent": stress.mesh_error_percent,
        "mesh_error_of": "estimate: energy norm",
        "claims": claims.iter().map(|claim| json!({ "claim": claim.id, "text": claim.to_string() })).collect::<Value>(),
        "warnings": warnings,
        "probes": probes,
        "sections": sections.iter().map(section).collect::<Value>(),
        "energy": {
            "elastic": known(solution.energy.elastic),
            "external": known(solution.energy.external),
            "supports": solution.energy.supports,
            // Null at rest.
            "kinetic": ledger.map(|ledger| ledger.kinetic),
            "dissipated": ledger.map(|ledger| ledger.dissipated),
        },
        "reaction": solution.reaction,
        "supports": supports.map(|(s, r)| support(s, r)).collect::<Value>(),
        "time_us": time_us,
    });
    // Other methods have no `auto`.
    if let Some(auto) = &solution.auto {
        object["auto"] = json!({
            "decision": auto.decision,
            "estimated_error_percent": 100.0 * auto.estimated_error,
            "solves": auto.solves,
            "factorizations": auto.factorizations,
        });
    }
    if let Some(motion) = simulation.motion() {
        add_motion(&mut object, simulation, motion);
    }
    text(&object)
}

/// Adds the values of a motion to the object.
fn add_motion(object: &mut Value, simulation: &Simulation, motion: Motion<'_>) {
    let (counts, ledger) = (motion.counts(), motion.ledger());
    object["integrator"] = json!(simulation.scene().dynamics.integrator.id());
    object["time"] = json!(simulation.state().time());
    object["steps"] = json!(counts.steps);
    object["halvings"] = json!(counts.halvings);
    object["critical_step"] = json!(motion.critical_step());
    object["energy_drift"] = json!(ledger.drift());
    object["energy_drift_of_input"] = json!(ledger.drift_of_input());
    if let Some(decision) = motion.decision() {
        object["auto"] = json!({
            "decision": decision,
            "solves": counts.solves,
            "factorizations": counts.factorizations,
            "linear_steps": counts.linear_steps,
            "old_factor_steps": counts.old_factor_steps,
            "new_factor_steps": counts.new_factor_steps,
        });
    }
    object["momentum"] = json!(motion.momentum());
    let energy = &mut object["energy"];
    energy["integrator"] = json!(ledger.integrator);
    energy["pulses"] = json!(ledger.pulses);
    energy["mouse_spring"] = json!(ledger.mouse_spring);
}

fn tensor(tensor: &PlaneTensor) -> Value {
    let [xx, yy, zz, xy] = tensor.components();
    json!({ "xx": xx, "yy": yy, "zz": zz, "xy": xy })
}

fn probe(result: &ProbeResult, stress: Option<&ProbeStress>, reference: Option<&ProbeReference>) -> Value {
    let cauchy = stress.and_then(|s| s.cauchy);
    json!({
        "name": result.name,
        "x": result.x,
        "u": result.u,
        "rotation_deg": stress.map(|s| s.rotation_deg),
        "strain": stress.map(|s| tensor(&s.strain)),
        "stress": cauchy.map(|s| tensor(&s)),
        "von_mises": cauchy.map(|s| s.von_mises()),
        "reference_u": reference.map(|r| r.displacement),
        "reference_source": reference.map(|r| r.source.to_string()),
        "reference_error_percent": reference.map(|r| r.own_error_percent),
        "error_percent": reference.and_then(|r| r.error_percent(result)),
    })
}

/// Formats a support and its reaction; the moment is about the middle of its edge.
fn support(support: &Support, reaction: &SupportReaction) -> Value {
    let (key, place) = match &support.place {
        Place::Edge(edge) => ("edge", json!(edge)),
        Place::At(at) => ("at", json!(at)),
    };
    json!({
        key: place,
        "displacement": support.displacement,
        "turn": support.turn,
        "force": reaction.force,
        "moment": reaction.moment,
    })
}

/// Returns a section as JSON.
pub(super) fn section(section: &Section) -> Value {
    let point = |point: &SectionPoint| {
        json!({
            "rest": point.rest,
            "along": point.along,
            "normal_stress": point.stress.map(|stress| stress[0]),
            "shear_stress": point.stress.map(|stress| stress[1]),
            "beam_normal_stress": point.beam.map(|beam| beam[0]),
            "beam_shear_stress": point.beam.map(|beam| beam[1]),
        })
    };
    let mut object = json!(section.forces);
    object["at"] = json!(section.line.at);
    object["angle"] = json!(section.line.angle);
    object["rest"] = json!(section.rest);
    object["ends"] = json!(section.ends);
    object["normal"] = json!(section.normal());
    object["force"] = json!(section.force);
    object["of_stress"] = json!(section.stress_forces);
    object["points"] = section.points.iter().map(point).collect::<Value>();
    object
}

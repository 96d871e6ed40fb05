//! Report of the window's state, which tests of the web page read.

use serde_json::json;

use crate::app::shell::lab::Lab;
use crate::scene::Load;

/// Returns the state of the window as JSON. `frames` is the number of frames drawn. Positions are in points from the
/// upper left corner of the window. A number that is not finite is `null`.
pub(super) fn json(lab: &Lab, frames: u64) -> String {
    let (scene, simulation) = (lab.scene(), lab.simulation());
    let probes = scene.probes.iter().map(|probe| json!({ "name": probe.name, "u": simulation.probe(&probe.name) }));
    let loads = scene.loads.iter().map(|load| match load {
        Load::Force { force, .. } => json!({ "force": force }),
        Load::Moment { moment, .. } => json!({ "moment": moment }),
        Load::Gravity { acceleration, .. } => json!({ "gravity": acceleration }),
    });
    let tips = lab.arrow_tips().into_iter().map(|(load, at)| json!({ "load": load, "x": at.x, "y": at.y }));
    let (study, is_measuring) = lab.study();
    let view = lab.view_rect();
    let (camera, mesh) = (lab.camera(), simulation.mesh());
    let mut body = egui::Rect::NOTHING;
    for (x, u) in mesh.nodes().iter().zip(simulation.displacement()) {
        let [right, down] = camera.to_view(x + u);
        body.extend_with(view.center() + egui::vec2(right as f32, down as f32));
    }
    json!({
        "frames": frames,
        "title": lab.title(),
        "scene": scene.name,
        "language": lab.settings.language,
        "status": simulation.status().id(),
        "iterations": simulation.iterations(),
        "residual": simulation.residual(),
        "unknowns": simulation.system().dofs(),
        "probes": probes.collect::<Vec<_>>(),
        "loads": loads.collect::<Vec<_>>(),
        "motion": simulation.motion().map(|motion| json!({
            "time": simulation.state().time(),
            "steps": motion.counts().steps,
            "energy_drift": motion.ledger().drift(),
        })),
        "card": lab.card().map(|(card, _)| card),
        "cards": lab.card().map(|(_, cards)| cards),
        "points": study.map(|study| study.measurements.len()),
        "is_measuring": is_measuring,
        "is_computing": lab.is_computing(),
        "offers_unsaved": lab.left.is_some(),
        "arrow_tips": tips.collect::<Vec<_>>(),
        "scale": lab.camera().scale,
        "view": [view.left(), view.top(), view.right(), view.bottom()],
        "body": [body.left(), body.top(), body.right(), body.bottom()],
    })
    .to_string()
}

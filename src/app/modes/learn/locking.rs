//! Card of locking: the same beam with every element, one button each with its error.

use super::Learn;
use crate::app::interface::*;
use crate::simulation::probe_results;
use crate::study::Extent;

/// Error of an element on the scene's cells.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct ElementError {
    pub element: ElementKind,
    /// Number of free unknowns.
    pub unknowns: usize,
    /// Error, percent of the reference displacement of the first probe.
    pub percent: f64,
}

/// Returns the errors of all elements that the scene's cells can have, each at its own equilibrium.
pub(super) fn errors(scene: &Scene, observe: Observer<'_>) -> Option<Vec<ElementError>> {
    let reference = Reference::find(scene, None, Extent::Quick, observe).ok()?.first()?;
    let error = |element: ElementKind| {
        let mut scene = scene.clone();
        scene.set_element(element);
        scene.solver.method = MethodKind::Newton;
        let mut simulation = Simulation::new(&scene).ok()?;
        let is_cancelled = simulation.solve_watched(&mut |_| observe(Progress::at(1.0))).is_break();
        if is_cancelled || *simulation.status() != Status::Converged {
            return None;
        }
        let probe = probe_results(simulation.problem(), simulation.state()).into_iter().next()?;
        Some(ElementError { element, unknowns: simulation.system().dofs(), percent: reference.error_percent(&probe)? })
    };
    scene.elements().map(error).collect()
}

/// Shows one button per element.
pub(super) fn show(ui: &mut Ui, shown: &Readout<'_>, learn: &mut Learn, actions: &mut Vec<Action>) {
    let scene = shown.scene;
    let known = learn.errors.get(scene);
    for element in scene.elements() {
        let error = known.and_then(|all| all.iter().find(|e| e.element == element));
        let text = match error {
            Some(e) => fill!(
                "%{element}: error %{error}, %{n} unknowns",
                element = element.id(),
                error = percent(e.percent),
                n = e.unknowns
            ),
            None => element.id().to_owned(),
        };
        let chosen = scene.element() == element;
        let button = ui.add(Button::selectable(chosen, RichText::new(&text).size(16.0)));
        if button.clicked() && !chosen {
            actions.push(Action::edit("Element", scene, |scene| scene.set_element(element)));
        }
        ui.add(Label::new(RichText::new(tr(element.entry().about)).small().weak()).wrap());
        ui.add_space(2.0);
    }
    if known.is_none() {
        let text = if learn.is_computing(scene) {
            "Computing the errors."
        } else {
            "No reference solution of this scene is known."
        };
        ui.label(RichText::new(tr(text)).small().weak());
    }
}

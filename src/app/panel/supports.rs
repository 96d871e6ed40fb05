//! Panel section of moving supports: prescribed displacements and rotations, and reactions.

use egui::{ComboBox, Id, Ui};

use crate::app::language::{fill, joined, tr};
use crate::app::panel::{Action, PanelState};
use crate::app::readout::Readout;
use crate::app::widgets::number_field::{NumberField, SliderScale};
use crate::format::{Context, editable, engineering, engineering_pair, three_digits};
use crate::scene::limits::Limit;
use crate::scene::{Analysis, Axis, Place, Scene, Support, limits};
use crate::simulation::Simulation;

/// Returns the index of the support that the sliders move; `None` for a motion, or if no support of this scene has been
/// moved.
pub(super) fn chosen(ui: &Ui, input: &Readout<'_>) -> Option<usize> {
    if input.scene.analysis == Analysis::Dynamic {
        return None;
    }
    // A support that has been dragged back to rest stays the chosen one.
    let id = Id::unique(("support", input.scene_name));
    let first = input.scene.supports.iter().position(Support::moves);
    let remembered = ui.data(|data| data.get_temp::<usize>(id));
    let chosen = remembered.or(first).filter(|&i| i < input.scene.supports.len());
    if let Some(chosen) = chosen {
        ui.data_mut(|data| data.insert_temp(id, chosen));
    }
    chosen
}

/// Returns a summary of a support's prescribed displacement and rotation.
pub(super) fn summary(scene: &Scene, number: usize) -> String {
    scene.supports.get(number).map_or_else(String::new, |support| {
        let displacement = engineering_pair(support.displacement, "m");
        if support.turn == 0.0 {
            displacement
        } else {
            joined([displacement, editable(support.turn.to_degrees(), "°")])
        }
    })
}

/// Shows the sliders of a support: its displacement in fixed directions, and its rotation if it is an edge.
pub(super) fn show(ui: &mut Ui, input: &Readout<'_>, number: usize, state: &mut PanelState, actions: &mut Vec<Action>) {
    let scene = input.scene;
    let Some(support) = scene.supports.get(number) else { return };
    let original = input.original.supports.get(number);
    if scene.supports.len() > 1 {
        ui.horizontal(|ui| {
            let label = ui.label(tr("Support"));
            ComboBox::from_id_salt("support")
                .selected_text(tr(&support.place.to_string()))
                .show_ui(ui, |ui| {
                    for (i, other) in scene.supports.iter().enumerate() {
                        if ui.selectable_label(i == number, tr(&other.place.to_string())).clicked() {
                            ui.data_mut(|data| data.insert_temp(Id::unique(("support", input.scene_name)), i));
                        }
                    }
                })
                .response
                .labelled_by(label.id)
                .on_hover_text(tr("The support that the sliders move"));
        });
    }
    let reach = reach(0.1 * input.simulation.system().size());
    for (axis, label, tooltip) in [
        (
            Axis::X,
            "Move x",
            "Prescribed displacement of the support to the right, m. Numbers with a unit can be typed, such as 3 mm.",
        ),
        (
            Axis::Y,
            "Move y",
            "Prescribed displacement of the support upwards, m. Numbers with a unit can be typed, such as -3 mm.",
        ),
    ] {
        if !support.fix.contains(&axis) {
            continue;
        }
        let component = usize::from(axis == Axis::Y);
        let field = NumberField {
            label,
            tooltip,
            limit: limits::COORDINATE,
            slider: -reach..=reach,
            scale: SliderScale::Linear,
            whole: false,
        };
        let original = original.map(|support| support.displacement[component]);
        if let Some(new) = field.show_with_original(ui, &mut state.messages, support.displacement[component], original)
        {
            let edit = |support: &mut Support| support.displacement[component] = new;
            actions.push(Action::Edit(label, edited(scene, number, edit)));
        }
    }
    if matches!(support.place, Place::Edge(_)) && support.fix.contains(&Axis::X) && support.fix.contains(&Axis::Y) {
        let field = NumberField {
            label: "Rotation",
            tooltip: "Prescribed rotation of the support's edge about its middle, counter-clockwise: in degrees, or \
                      with a unit, such as 0.5 rad.",
            limit: Limit { unit: "°", min: limits::ROTATION.min.to_degrees(), max: limits::ROTATION.max.to_degrees() },
            slider: -180.0..=180.0,
            scale: SliderScale::Linear,
            whole: false,
        };
        let original = original.map(|support| support.turn.to_degrees());
        if let Some(new) = field.show_with_original(ui, &mut state.messages, support.turn.to_degrees(), original) {
            actions.push(Action::Edit("Rotation", edited(scene, number, |support| support.turn = new.to_radians())));
        }
    }
}

fn edited(scene: &Scene, number: usize, edit: impl FnOnce(&mut Support)) -> Box<Scene> {
    let mut scene = Box::new(scene.clone());
    if let Some(support) = scene.supports.get_mut(number) {
        edit(support);
    }
    scene
}

/// Returns a round number that is about as large as `length` or larger.
fn reach(length: f64) -> f64 {
    let decade = 10f64.powf(length.max(1e-12).log10().floor());
    [1.0, 2.0, 5.0].map(|m| m * decade).into_iter().find(|r| *r >= 0.9 * length).unwrap_or(10.0 * decade)
}

/// Shows a row with the reaction of every support of a body at rest.
pub(super) fn reaction_rows(row: &mut dyn FnMut(&str, String, &str), simulation: &Simulation) {
    let reactions = simulation.support_reactions();
    let forces = Context::of_inexact(reactions.iter().map(|reaction| reaction.force.norm()), Context::MAX_INEXACT);
    for (i, reaction) in reactions.into_iter().enumerate() {
        let force = forces.pair(reaction.force.into(), "N");
        let size = simulation.system().size();
        // A roller has no moment, and a clamp that nothing turns only a rounding error.
        let moment = (reaction.moment.abs() > 1e-9 * size * reaction.force.norm())
            .then(|| engineering(three_digits(reaction.moment), "N m"));
        let (name, tip) = match &reaction.place {
            Place::Edge(edge) => (
                fill!("Support %{edge}", edge = tr(edge)),
                fill!(
                    "Reaction of this support; its moment about the edge's middle is %{moment}",
                    moment = engineering(reaction.moment, "N m")
                ),
            ),
            place @ Place::At(_) => {
                (fill!("Support %{n}", n = i + 1), fill!("Reaction of the support at %{place}", place = place))
            }
        };
        row(&name, joined([force].into_iter().chain(moment)), &tip);
    }
}

//! Panel section of moving supports: prescribed displacements and rotations, and reactions.

use super::*;
use crate::format::Context;

/// Returns the support that the sliders move, with its index; `None` for a motion, or if no support of this scene has
/// been moved.
pub(super) fn chosen<'a>(panel: &mut Panel<'a>) -> Option<(usize, &'a Support)> {
    let scene = panel.scene;
    // A support that has been dragged back to rest stays the chosen one.
    let first = || scene.supports.iter().position(Support::moves);
    panel.state.support = panel.state.support.or_else(first);
    let number = panel.state.support.filter(|_| scene.analysis == Analysis::Static)?;
    Some((number, scene.supports.get(number)?))
}

pub(super) fn summary(support: &Support) -> String {
    let turn = (support.turn != 0.0).then(|| editable(support.turn.to_degrees(), "°"));
    joined([engineering_pair(support.displacement, "m")].into_iter().chain(turn))
}

/// Shows the sliders of a support: its displacement in fixed directions, and its rotation if it is an edge.
pub(super) fn show(ui: &mut Ui, panel: &mut Panel<'_>, number: usize, support: &Support) {
    let scene = panel.scene;
    if scene.supports.len() > 1 {
        let tip = "The support that the sliders move";
        combo(ui, "Support", tr(&support.place.to_string()), tip, None, |ui| {
            for (i, other) in scene.supports.iter().enumerate() {
                if ui.selectable_label(i == number, tr(&other.place.to_string())).clicked() {
                    panel.state.support = Some(i);
                }
            }
        });
    }
    let reach = reach(0.1 * panel.session.simulation().system().size());
    const RIGHT: &str =
        "Prescribed displacement of the support to the right, m. Numbers with a unit can be typed, such as 3 mm.";
    const UP: &str =
        "Prescribed displacement of the support upwards, m. Numbers with a unit can be typed, such as -3 mm.";
    for (axis, component, label, tip) in [(Axis::X, 0, "Move x", RIGHT), (Axis::Y, 1, "Move y", UP)] {
        if support.fix.contains(&axis) {
            let field = NumberField::new(label, limits::COORDINATE, -reach..=reach).tip(tip);
            let own = |scene: &Scene| Some(scene.supports.get(number)?.displacement[component]);
            panel.field(ui, &field, own, |scene, new| {
                scene.supports.get_mut(number).into_iter().for_each(|support| support.displacement[component] = new);
            });
        }
    }
    if matches!(support.place, Place::Edge(_)) && [Axis::X, Axis::Y].iter().all(|axis| support.fix.contains(axis)) {
        let own = |scene: &Scene| Some(scene.supports.get(number)?.turn.to_degrees());
        panel.field(ui, &ROTATION, own, |scene, new| {
            scene.supports.get_mut(number).into_iter().for_each(|support| support.turn = new.to_radians());
        });
    }
}

/// Limit of an angle that may have full turns, in degrees.
pub(super) const TURNS: Limit =
    Limit { unit: "°", min: limits::ROTATION.min.to_degrees(), max: limits::ROTATION.max.to_degrees() };
const ROTATION: NumberField = NumberField::new("Rotation", TURNS, -180.0..=180.0).tip(
    "Prescribed rotation of the support's edge about its middle, counter-clockwise: in degrees, or with a unit, such as \
     0.5 rad.",
);

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
                (fill!("Support %{n}", n = i + 1), fill!("Reaction of the support at %{place}", place))
            }
        };
        row(&name, joined([force].into_iter().chain(moment)), &tip);
    }
}

//! Panel section of force, gravity and moment.

use super::*;
use crate::app::viewport::arrow::{polar_form, vector};

/// Gravitational acceleration on earth, m/s².
const EARTH: f64 = 9.81;

/// Returns the forces of a scene, each with its index among the loads.
fn forces(scene: &Scene) -> impl Iterator<Item = (usize, &Place, [f64; 2])> {
    scene.loads.iter().enumerate().filter_map(|(i, load)| match load {
        Load::Force { place, force, .. } => Some((i, place, *force)),
        _ => None,
    })
}

fn gravity_of(scene: &Scene) -> Option<[f64; 2]> {
    scene.loads.iter().find_map(|l| match l {
        Load::Gravity { acceleration, .. } => Some(*acceleration),
        _ => None,
    })
}

fn moment_of(scene: &Scene) -> Option<f64> {
    scene.loads.iter().find_map(|l| match l {
        Load::Moment { moment, .. } => Some(*moment),
        _ => None,
    })
}

pub(super) fn summary(scene: &Scene) -> String {
    let gravity = gravity_of(scene).map(|g| polar_form(g).0).filter(|&g| g > 0.0).map(|g| engineering(g, "m/s²"));
    let moment = moment_of(scene).filter(|&m| m != 0.0).map(|m| engineering(m, "N m"));
    let both: Vec<String> = gravity.into_iter().chain(moment).collect();
    if both.is_empty() { tr("none").to_owned() } else { joined(both) }
}

/// Shows the magnitude and the direction of the force; nothing if the scene has none.
pub(super) fn force(ui: &mut Ui, panel: &mut Panel<'_>) {
    let (session, scene, document) = (panel.session, panel.scene, panel.session.document());
    let mut all = forces(scene).map(|(i, _, force)| (i, force));
    let first = all.next();
    let Some((chosen, force)) = all.find(|(i, _)| Some(*i) == panel.state.force).or(first) else { return };
    choose(ui, panel, chosen);
    let (magnitude, direction) = polar_form(force);
    let as_opened = forces(&document.original).find(|(i, ..)| *i == chosen);
    let (original, original_direction) = polar_form(as_opened.map_or([0.0; 2], |(_, _, force)| force));
    let direction = direction.unwrap_or(panel.state.force_direction());
    let [usual, largest] = LoadRanges::new(document.opened, &scene.material, session.simulation().system()).force;
    // A negative force can be typed for one in the opposite direction.
    let limit = const { keys::range("load.force") };
    let field = NumberField::new("Force", Limit { min: -limit.max, ..limit }, 0.0..=largest)
        .around(usual)
        .tip("Magnitude of the force, N. Other values can be typed, such as 12 kN; a negative one reverses the force.");
    if let Some(new) = panel.number(ui, &field, magnitude, Some(original)) {
        let reversed = if direction > 0.0 { direction - 180.0 } else { direction + 180.0 };
        set_force(panel, "Force", chosen, (new.abs(), if new < 0.0 { reversed } else { direction }));
    }
    let original = original_direction.map(shown_degrees);
    if let Some(new) = panel.number(ui, &DIRECTION, shown_degrees(direction), original) {
        set_force(panel, "Direction", chosen, (magnitude, new));
    }
}

/// 270° can be typed for −90°.
const DIRECTION: NumberField =
    NumberField::new("Direction", Limit { unit: "°", min: -360.0, max: 360.0 }, -180.0..=180.0)
        .tip("Direction of the force: 0° right, 90° up, −90° down.");

/// Sets a force by its magnitude, N, and its direction, degrees.
fn set_force(panel: &mut Panel<'_>, label: &'static str, load: usize, (magnitude, direction): (f64, f64)) {
    panel.state.force_direction = Some(direction);
    panel.edit(label, |scene| _ = scene.set_force(load, vector(magnitude, direction)));
}

/// Shows gravity and the first moment; a new moment is put on an edge that can carry it.
pub(super) fn gravity_and_moment(ui: &mut Ui, panel: &mut Panel<'_>) {
    let (session, scene, document) = (panel.session, panel.scene, panel.session.document());
    let (magnitude, direction) = polar_form(gravity_of(scene).unwrap_or_default());
    let direction = direction.or(panel.state.gravity_direction).unwrap_or(DOWN);
    let original = polar_form(gravity_of(&document.original).unwrap_or_default()).0;
    let field = NumberField::new("Gravity", const { keys::range("load.acceleration") }, 0.0..=1000.0)
        .around(if original > 0.0 { original } else { EARTH })
        .tip("Gravitational acceleration, m/s²; 9.81 on Earth, 0 for none.");
    if let Some(new) = panel.number(ui, &field, magnitude, Some(original)) {
        panel.state.gravity_direction = Some(direction);
        let own = scene.loads.iter().position(|load| matches!(load, Load::Gravity { .. }));
        panel.edit("Gravity", |scene| match own {
            Some(own) => _ = scene.set_gravity(own, vector(new, direction)),
            None => scene.loads.push(Load::gravity(vector(new, direction))),
        });
    }
    let [usual, largest] = LoadRanges::new(document.opened, &scene.material, session.simulation().system()).moment;
    let field = NumberField::new("Moment", const { keys::range("load.moment") }, -largest..=largest)
        .around(usual)
        .tip("Moment on an edge, N m, counter-clockwise; it rotates with the edge. 2πEI/L bends a beam into a circle.");
    let [current, original] = [scene, &document.original].map(|scene| moment_of(scene).unwrap_or(0.0));
    let Some(new) = panel.number(ui, &field, current, Some(original)) else { return };
    let own = scene.loads.iter().position(Load::is_moment);
    let edge = edges::edge_for_moment(scene, session.simulation().system());
    match (own, edge) {
        (Some(own), _) => panel.edit("Moment", |scene| _ = scene.set_moment(own, new)),
        (None, Some(edge)) => panel.edit("Moment", |scene| scene.loads.push(Load::moment(&edge, new))),
        (None, None) => {
            let message = sentence!("expected a straight edge without support; the body has none");
            panel.state.messages.insert("Moment", message);
        }
    }
}

/// Rounds a direction to remove the rounding errors of its conversion to a vector and back.
fn shown_degrees(degrees: f64) -> f64 {
    (degrees * 1e9).round() / 1e9
}

/// Lets the user choose the force that the sliders set, if the scene has several.
fn choose(ui: &mut Ui, panel: &mut Panel<'_>, present: usize) {
    let scene = panel.scene;
    let names = forces(scene).zip(1..).map(|((i, place, _), number)| {
        (i, fill!("Force %{number}: %{place}", number, place = edges::text(scene, place)))
    });
    let names: Vec<(usize, String)> = names.collect();
    if names.len() < 2 {
        return;
    }
    let chosen = names.iter().find(|(i, _)| *i == present).map_or("", |(_, name)| name);
    let tip = "The force that the sliders change; dragging an arrow selects its force";
    combo(ui, "Selected force", chosen, tip, Some(0.0), |ui| {
        for (i, name) in &names {
            if ui.selectable_label(*i == present, name).clicked() {
                panel.state.force = Some(*i);
            }
        }
    });
}

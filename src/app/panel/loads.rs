//! Panel section of force, gravity and moment.

use egui::{ComboBox, Ui};

use crate::app::language::{fill, joined, tr};
use crate::app::panel::{Action, PanelState, edges};
use crate::app::readout::Readout;
use crate::app::viewport::arrow::{DOWN, force_range, polar_form, vector};
use crate::app::viewport::moment_arrow::moment_range;
use crate::app::widgets::number_field::{NumberField, SliderScale};
use crate::format::engineering;
use crate::scene::{Load, Place, Scene, limits};
use crate::sentence::sentence;

/// Gravitational acceleration on earth, m/s².
const EARTH: f64 = 9.81;

/// Returns the forces of a scene, each with its index among the loads.
fn forces(scene: &Scene) -> impl Iterator<Item = (usize, &Place, [f64; 2])> {
    scene.loads.iter().enumerate().filter_map(|(i, load)| match load {
        Load::Force { place, force, .. } => Some((i, place, *force)),
        _ => None,
    })
}

/// Returns the force that the sliders set: the chosen one, or the first.
fn chosen_force(scene: &Scene, state: &PanelState) -> Option<(usize, [f64; 2])> {
    let mut all = forces(scene).map(|(i, _, force)| (i, force));
    let first = all.next();
    all.find(|(i, _)| Some(*i) == state.force).or(first)
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

/// Returns a summary of gravity and moment.
pub(super) fn summary(scene: &Scene) -> String {
    let gravity = gravity_of(scene).map(|g| polar_form(g).0).filter(|&g| g > 0.0).map(|g| engineering(g, "m/s²"));
    let moment = moment_of(scene).filter(|&m| m != 0.0).map(|m| engineering(m, "N m"));
    let both: Vec<String> = gravity.into_iter().chain(moment).collect();
    if both.is_empty() { tr("none").to_owned() } else { joined(both) }
}

/// Shows the magnitude and the direction of the force; nothing if the scene has none.
pub(super) fn force(ui: &mut Ui, input: &Readout<'_>, state: &mut PanelState, actions: &mut Vec<Action>) {
    let scene = input.scene;
    let Some((chosen, force)) = chosen_force(scene, state) else { return };
    choose(ui, scene, state);
    let (magnitude, direction) = polar_form(force);
    let as_opened = forces(input.original).find(|(i, ..)| *i == chosen);
    let (original, original_direction) = polar_form(as_opened.map_or([0.0; 2], |(_, _, force)| force));
    let direction = direction.unwrap_or(state.force_direction());
    let opening = input.opening;
    let [usual, largest] = force_range(opening, &scene.material, input.simulation.system());
    let field = NumberField {
        label: "Force",
        tooltip: "Magnitude of the force, N. Larger or smaller values can be typed, such as 12 kN.",
        limit: limits::FORCE,
        slider: 0.0..=largest,
        scale: SliderScale::Around(usual),
        whole: false,
    };
    if let Some(new) = field.show_with_original(ui, &mut state.messages, magnitude, Some(original)) {
        state.keep_force_direction(direction);
        actions.push(Action::Edit("Force", with_force(input, chosen, vector(new, direction))));
    }
    let field = NumberField {
        label: "Direction",
        tooltip: "Direction of the force: 0° right, 90° up, −90° down.",
        limit: TURN,
        slider: -180.0..=180.0,
        scale: SliderScale::Linear,
        whole: false,
    };
    let original = original_direction.map(shown_degrees);
    if let Some(new) = field.show_with_original(ui, &mut state.messages, shown_degrees(direction), original) {
        state.keep_force_direction(new);
        actions.push(Action::Edit("Direction", with_force(input, chosen, vector(magnitude, new))));
    }
}

/// Typed directions; 270° is −90°.
const TURN: limits::Limit = limits::Limit { min: -360.0, max: 360.0, ..limits::DIRECTION };

/// Shows gravity and the first moment; a new moment is put on an edge that can carry it.
pub(super) fn gravity_and_moment(ui: &mut Ui, input: &Readout<'_>, state: &mut PanelState, actions: &mut Vec<Action>) {
    let scene = input.scene;
    let (magnitude, direction) = polar_form(gravity_of(scene).unwrap_or_default());
    let direction = direction.or(state.gravity_direction).unwrap_or(DOWN);
    let original = polar_form(gravity_of(input.original).unwrap_or_default()).0;
    let usual = if original > 0.0 { original } else { EARTH };
    let field = NumberField {
        label: "Gravity",
        tooltip: "Gravitational acceleration, m/s²; 9.81 on Earth, 0 for none.",
        limit: limits::ACCELERATION,
        slider: 0.0..=1000.0,
        scale: SliderScale::Around(usual),
        whole: false,
    };
    if let Some(new) = field.show_with_original(ui, &mut state.messages, magnitude, Some(original)) {
        state.gravity_direction = Some(direction);
        actions.push(Action::Edit("Gravity", with_gravity(scene, vector(new, direction))));
    }
    let current = moment_of(scene);
    let opening = input.opening;
    let [usual, largest] = moment_range(opening, &scene.material, input.simulation.system());
    let field = NumberField {
        label: "Moment",
        tooltip: "Moment on an edge, N m, counter-clockwise; it rotates with the edge. 2πEI/L bends a beam into a \
                  circle.",
        limit: limits::MOMENT,
        slider: -largest..=largest,
        scale: SliderScale::Around(usual),
        whole: false,
    };
    let original = moment_of(input.original).unwrap_or(0.0);
    if let Some(new) = field.show_with_original(ui, &mut state.messages, current.unwrap_or(0.0), Some(original)) {
        let mut scene = Box::new(input.scene.clone());
        let first = scene.loads.iter_mut().find_map(|l| match l {
            Load::Moment { moment, .. } => Some(moment),
            _ => None,
        });
        match first {
            Some(moment) => *moment = new,
            None => match edges::edge_for_moment(&scene, input.simulation.system()) {
                Some(edge) => scene.loads.push(Load::moment(&edge, new)),
                None => {
                    let message = sentence!("expected a straight edge without support; the body has none");
                    state.messages.insert("Moment", message);
                    return;
                }
            },
        }
        actions.push(Action::Edit("Moment", scene));
    }
}

/// Rounds a direction to remove the rounding errors of its conversion to a vector and back.
fn shown_degrees(degrees: f64) -> f64 {
    (degrees * 1e9).round() / 1e9
}

/// Returns the scene with a force replaced.
fn with_force(input: &Readout<'_>, load: usize, new: [f64; 2]) -> Box<Scene> {
    let mut scene = Box::new(input.scene.clone());
    if let Some(Load::Force { force, .. }) = scene.loads.get_mut(load) {
        *force = new;
    }
    scene
}

/// Lets the user choose the force that the sliders set, if the scene has several.
fn choose(ui: &mut Ui, scene: &Scene, state: &mut PanelState) {
    let Some((present, _)) = chosen_force(scene, state).filter(|_| forces(scene).count() > 1) else { return };
    let name = |i: usize, place: &Place| {
        let number = forces(scene).position(|(j, ..)| j == i).unwrap_or(0) + 1;
        fill!("Force %{number}: %{place}", number = number, place = edges::text(scene, place))
    };
    let place = forces(scene).find(|(i, ..)| *i == present).map(|(_, place, _)| place);
    ui.horizontal(|ui| {
        let label = ui.label(tr("Selected force"));
        let text = place.map_or_else(String::new, |place| name(present, place));
        ComboBox::from_id_salt("chosen force")
            .selected_text(text)
            .width(ui.available_width())
            .truncate()
            .show_ui(ui, |ui| {
                for (i, place, _) in forces(scene) {
                    if ui.selectable_label(i == present, name(i, place)).clicked() {
                        state.force = Some(i);
                    }
                }
            })
            .response
            .labelled_by(label.id)
            .on_hover_text(tr("The force that the sliders change; dragging an arrow selects its force"));
    });
}

fn with_gravity(scene: &Scene, new: [f64; 2]) -> Box<Scene> {
    let mut scene = Box::new(scene.clone());
    let first = scene.loads.iter_mut().find_map(|l| match l {
        Load::Gravity { acceleration, .. } => Some(acceleration),
        _ => None,
    });
    match first {
        Some(acceleration) => *acceleration = new,
        None => scene.loads.push(Load::gravity(new)),
    }
    scene
}

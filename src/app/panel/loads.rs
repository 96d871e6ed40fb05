//! Force, gravity, moment.

use egui::Ui;

use super::{Action, PanelInput, PanelState, edges};
use crate::app::arrow::{DOWN, force_range, polar_form, vector};
use crate::app::field::{NumberField, SliderScale};
use crate::app::language::{joined, tr};
use crate::app::load_scale::OpeningLoads;
use crate::app::turn::moment_range;
use crate::assembly::System;
use crate::scene::{Load, Scene, limits};
use crate::words::engineering;

/// Acceleration of free fall on earth, m/s².
const EARTH: f64 = 9.81;

fn force_of(scene: &Scene) -> Option<[f64; 2]> {
    scene.loads.iter().find_map(|l| match l {
        Load::Force { force, .. } => Some(*force),
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

/// What there is of gravity and moment, in words.
pub(super) fn summary(scene: &Scene) -> String {
    let gravity = gravity_of(scene).map(|g| polar_form(g).0).filter(|&g| g > 0.0).map(|g| engineering(g, "m/s²"));
    let moment = moment_of(scene).filter(|&m| m != 0.0).map(|m| engineering(m, "N m"));
    let both: Vec<String> = gravity.into_iter().chain(moment).collect();
    if both.is_empty() { tr("none").to_owned() } else { joined(both) }
}

/// Force and its direction.
pub(super) fn force(ui: &mut Ui, input: &PanelInput<'_>, state: &mut PanelState, actions: &mut Vec<Action>) {
    let scene = input.scene;
    let (magnitude, direction) = polar_form(force_of(scene).unwrap_or_default());
    let (original, original_direction) = polar_form(force_of(input.original).unwrap_or_default());
    let direction = direction.unwrap_or(state.force_direction());
    let opening = OpeningLoads::of(input.original);
    let [usual, largest] = force_range(opening, &scene.material, input.simulation.system());
    let field = NumberField {
        label: "Force",
        tooltip: "Magnitude of the force, N. Type a number for values the slider has not, such as 12 kN.",
        limit: limits::FORCE,
        slider: 0.0..=largest,
        scale: SliderScale::Around(usual),
        whole: false,
    };
    if let Some(new) = field.show_beside(ui, &mut state.messages, magnitude, Some(original)) {
        state.keep_force_direction(direction);
        actions.push(Action::Edit("Force", with_force(scene, input.simulation.system(), vector(new, direction))));
    }
    let field = NumberField {
        label: "Direction",
        tooltip: "Direction of the force: 0° right, 90° up, −90° down.",
        limit: limits::DIRECTION,
        slider: -180.0..=180.0,
        scale: SliderScale::Linear,
        whole: false,
    };
    let original = original_direction.map(shown_degrees);
    if let Some(new) = field.show_beside(ui, &mut state.messages, shown_degrees(direction), original) {
        state.keep_force_direction(new);
        actions.push(Action::Edit("Direction", with_force(scene, input.simulation.system(), vector(magnitude, new))));
    }
}

/// Gravity, and the moment on the right edge, or on whichever edge has one.
pub(super) fn gravity_and_moment(
    ui: &mut Ui,
    input: &PanelInput<'_>,
    state: &mut PanelState,
    actions: &mut Vec<Action>,
) {
    let scene = input.scene;
    let (magnitude, direction) = polar_form(gravity_of(scene).unwrap_or_default());
    let direction = direction.or(state.gravity_direction).unwrap_or(DOWN);
    let original = polar_form(gravity_of(input.original).unwrap_or_default()).0;
    let usual = if original > 0.0 { original } else { EARTH };
    let field = NumberField {
        label: "Gravity",
        tooltip: "Acceleration that gives the body its weight, m/s²; 9.81 on earth, 0 for none.",
        limit: limits::ACCELERATION,
        slider: 0.0..=1000.0,
        scale: SliderScale::Around(usual),
        whole: false,
    };
    if let Some(new) = field.show_beside(ui, &mut state.messages, magnitude, Some(original)) {
        state.gravity_direction = Some(direction);
        actions.push(Action::Edit("Gravity", with_gravity(scene, vector(new, direction))));
    }
    let current = moment_of(scene);
    let opening = OpeningLoads::of(input.original);
    let [usual, largest] = moment_range(opening, &scene.material, input.simulation.system());
    let field = NumberField {
        label: "Moment",
        tooltip: "Moment on an edge, N m, counter-clockwise; it turns with the edge. 2πEI/L rolls a beam up once.",
        limit: limits::MOMENT,
        slider: -largest..=largest,
        scale: SliderScale::Around(usual),
        whole: false,
    };
    let original = moment_of(input.original).unwrap_or(0.0);
    if let Some(new) = field.show_beside(ui, &mut state.messages, current.unwrap_or(0.0), Some(original)) {
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
                    let message = "expected a straight edge that is not held, there is none";
                    state.messages.insert("Moment", message.to_owned());
                    return;
                }
            },
        }
        actions.push(Action::Edit("Moment", scene));
    }
}

/// A direction without the digits that going through a vector adds.
fn shown_degrees(degrees: f64) -> f64 {
    (degrees * 1e9).round() / 1e9
}

/// The scene with its first force replaced, or with one on an edge that can carry it.
fn with_force(scene: &Scene, system: &System, new: [f64; 2]) -> Box<Scene> {
    let mut scene = Box::new(scene.clone());
    let first = scene.loads.iter_mut().find_map(|l| match l {
        Load::Force { force, .. } => Some(force),
        _ => None,
    });
    match first {
        Some(force) => *force = new,
        None => {
            let edge = edges::edge_for_force(&scene, system).unwrap_or_else(|| "right".to_owned());
            scene.loads.push(Load::force(edge.as_str(), new));
        }
    }
    scene
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

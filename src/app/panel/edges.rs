//! Pickers of the edges that loads and supports are on.

use egui::{ComboBox, Ui};

use super::{Action, PanelInput, PanelState, ViewOptions};
use crate::app::field::show_message;
use crate::app::language::{count, fill, joined, tr};
use crate::assembly::{Edge, System};
use crate::scene::{Load, Place, Scene};

/// Edges that a load is looked for on, before all others.
const USUAL: [&str; 4] = ["right", "left", "top", "bottom"];

/// Whether a load on this edge can move something: supports do not fix all of it.
fn is_free(system: &System, edge: &Edge) -> bool {
    edge.weights().iter().any(|&(node, _)| system.pattern().fixed(node) != [true, true])
}

/// Whether the edge can carry a moment, and turn under it.
fn can_turn(system: &System, edge: &Edge) -> bool {
    edge.is_straight() && is_free(system, edge)
}

/// The edge that a new load of a scene goes on: that of its force, else the first that can carry it.
fn edge_for(scene: &Scene, system: &System, can_carry: fn(&System, &Edge) -> bool) -> Option<String> {
    let of_force = scene.loads.iter().find_map(|load| match load {
        Load::Force { place: Place::Edge(name), .. } => Some(name.as_str()),
        _ => None,
    });
    let others = system.edges().iter().map(Edge::name);
    let mut names = of_force.into_iter().chain(USUAL).chain(others);
    let found = names.find(|name| system.edges().iter().any(|e| e.name() == *name && can_carry(system, e)));
    found.map(str::to_owned)
}

/// The edge that a first force goes on; `None` where none can be moved.
pub(super) fn edge_for_force(scene: &Scene, system: &System) -> Option<String> {
    edge_for(scene, system, is_free)
}

/// The edge that a first moment goes on; `None` where none is straight and can turn.
pub(super) fn edge_for_moment(scene: &Scene, system: &System) -> Option<String> {
    edge_for(scene, system, can_turn)
}

/// A place in words.
fn words(place: &Place) -> String {
    match place {
        Place::Edge(name) => tr(name).to_owned(),
        Place::At([x, y]) => fill!("point (%{x}, %{y})", x = x, y = y),
    }
}

/// The edge of a load; `None` for a weight, which has no place.
fn place_of(load: &Load) -> Option<Place> {
    match load {
        Load::Force { place, .. } => Some(place.clone()),
        Load::Moment { edge, .. } => Some(Place::from(edge.as_str())),
        Load::Gravity { .. } => None,
    }
}

/// A row with the edge of something; says which edge was picked. The edge under the pointer is shown in the view.
fn row(
    ui: &mut Ui,
    (label, id): (&'static str, usize),
    present: &Place,
    edges: &[&Edge],
    view: &mut ViewOptions,
) -> Option<String> {
    let mut picked = None;
    ui.horizontal(|ui| {
        let name = ui.label(tr(label));
        let combo = ComboBox::from_id_salt((label, id)).selected_text(words(present)).show_ui(ui, |ui| {
            for edge in edges {
                let is_present = matches!(present, Place::Edge(name) if name == edge.name());
                let entry = ui.selectable_label(is_present, tr(edge.name()));
                if entry.hovered() || entry.has_focus() {
                    view.edge = Some(edge.name().to_owned());
                }
                if entry.clicked() && !is_present {
                    picked = Some(edge.name().to_owned());
                }
            }
        });
        let button =
            combo.response.labelled_by(name.id).on_hover_text(tr("The edge it is on; other edges are in the list"));
        if let (true, Place::Edge(name), None) = (button.hovered(), present, &view.edge) {
            view.edge = Some(name.clone());
        }
    });
    picked
}

/// What is on edges, in a few words.
pub(super) fn summary(scene: &Scene) -> String {
    let loads = scene.loads.iter().filter_map(place_of).count();
    joined([count(loads as u64, "load"), count(scene.supports.len() as u64, "support")])
}

/// Shows where loads and supports are.
pub(super) fn show(
    ui: &mut Ui,
    input: &PanelInput<'_>,
    state: &mut PanelState,
    view: &mut ViewOptions,
    actions: &mut Vec<Action>,
) {
    let (scene, system) = (input.scene, input.simulation.system());
    for (i, load) in scene.loads.iter().enumerate() {
        let Some(present) = place_of(load) else { continue };
        let (label, can_carry): (_, fn(&System, &Edge) -> bool) =
            if load.is_moment() { ("Moment on", can_turn) } else { ("Force on", is_free) };
        let edges: Vec<&Edge> = system.edges().iter().filter(|e| can_carry(system, e)).collect();
        if let Some(name) = row(ui, (label, i), &present, &edges, view) {
            let mut scene = Box::new(scene.clone());
            match &mut scene.loads[i] {
                Load::Force { place, .. } => *place = Place::Edge(name),
                Load::Moment { edge, .. } => *edge = name,
                Load::Gravity { .. } => {}
            }
            actions.push(Action::Edit("Edges", scene));
        }
    }
    for (i, support) in scene.supports.iter().enumerate() {
        let edges: Vec<&Edge> = system.edges().iter().collect();
        if let Some(name) = row(ui, ("Held at", i), &support.place, &edges, view) {
            let mut scene = Box::new(scene.clone());
            scene.supports[i].place = Place::Edge(name);
            actions.push(Action::Edit("Edges", scene));
        }
    }
    show_message(ui, &state.messages, "Edges");
}

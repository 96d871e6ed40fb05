//! Loads and supports in the panel: the edge or point of each, and buttons that add and remove them.

use std::cell::RefCell;

use super::*;
use crate::app::viewport::objects::{
    self, Object, ObjectChange, acts_at_point, can_carry_moment, force_by_hand, is_free, support_by_hand,
};
use crate::app::widgets::number_field::{FirstText, read};
use crate::study::moved_points;

/// Name of the section, with which its messages are kept.
pub(crate) const SECTION: &str = "Loads and supports";

/// Edges that are tried first for a new load.
const USUAL: [&str; 4] = ["right", "left", "top", "bottom"];

/// Returns the edge for the first moment: that of the scene's first force, or else the first edge that is straight and
/// can rotate; `None` if there is none.
pub(super) fn edge_for_moment(scene: &Scene, system: &System) -> Option<String> {
    let of_force = scene.loads.iter().find_map(|load| match load {
        Load::Force { place: Place::Edge(name), .. } => Some(name.as_str()),
        _ => None,
    });
    let others = system.edges().iter().map(Edge::name);
    let mut names = of_force.into_iter().chain(USUAL).chain(others);
    let found = names.find(|name| system.edges().iter().any(|e| e.name() == *name && can_carry_moment(system, e)));
    found.map(str::to_owned)
}

/// Common points of loads and supports on a beam: the name of each, and its coordinates along and across the beam.
const POINTS: [(&str, [f64; 2]); 8] = [
    ("lower left", [0.0, -0.5]),
    ("lower right", [1.0, -0.5]),
    ("upper left", [0.0, 0.5]),
    ("upper right", [1.0, 0.5]),
    ("bottom, middle", [0.5, -0.5]),
    ("top, middle", [0.5, 0.5]),
    ("left, middle", [0.0, 0.0]),
    ("right, middle", [1.0, 0.0]),
];

/// Returns the named points of the beam, if the scene has one.
fn points(scene: &Scene) -> impl Iterator<Item = Place> {
    let beam = scene.beam.as_ref();
    beam.into_iter().flat_map(|beam| POINTS.map(|(_, [along, across])| beam.point(along, across).into()))
}

/// Returns the description of a place.
pub(super) fn text(scene: &Scene, place: &Place) -> String {
    match place {
        Place::Edge(name) => tr(name).to_owned(),
        Place::At([x, y]) => match points(scene).zip(POINTS).find(|(point, _)| point == place) {
            Some((_, (name, _))) => tr(name).to_owned(),
            None => fill!("point %{place}", place = engineering_pair([*x, *y], "m")),
        },
    }
}

/// Shows the row of a load, support or probe with its place; the user moves, widens and removes it there. The edge under the
/// pointer is highlighted in the view. `width` is that of a load or support at a point, m; `more` shows further controls.
fn row(
    ui: &mut Ui,
    panel: &mut Panel<'_>,
    object: Object,
    (label, id, remove): (&str, usize, &str),
    width: Option<f64>,
    places: impl Iterator<Item = Place>,
    more: impl FnOnce(&mut Ui),
) {
    let (scene, highlighted) = (panel.scene, &mut panel.view.edge);
    let Some(present) = &object.place(scene) else { return };
    let mut change = None;
    ui.horizontal(|ui| {
        let name = ui.label(label);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let response = ui.add(Button::new("×").frame(false).min_size(vec2(20.0, 20.0))).on_hover_text(remove);
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, remove));
            if response.clicked() {
                change = Some(ObjectChange::Remove);
            }
            more(ui);
            let picker = ComboBox::from_id_salt((label, id)).selected_text(text(scene, present));
            let combo = picker.width(ui.available_width()).truncate().show_ui(ui, |ui| {
                for place in places {
                    let entry = ui.selectable_label(*present == place, text(scene, &place));
                    if let (true, Place::Edge(name)) = (entry.hovered() || entry.has_focus(), &place) {
                        *highlighted = Some(name.clone());
                    }
                    if entry.clicked() && *present != place {
                        change = Some(ObjectChange::Move(place));
                    }
                }
            });
            let tip = tr("Edge or point where it acts; choose another from the list");
            let button = combo.response.labelled_by(name.id).on_hover_text(tip);
            if let (true, Place::Edge(name), None) = (button.hovered(), present, &highlighted) {
                *highlighted = Some(name.clone());
            }
        });
    });
    if let Place::At(at) = present {
        change = change.or(coordinates(ui, (label, id), (*at, width), &mut panel.state.messages));
    }
    let Some(change) = change else { return };
    if let (ObjectChange::Remove, Object::Load(i)) = (&change, object) {
        // The same force stays chosen if it still exists.
        let chosen = panel.state.force.filter(|chosen| *chosen != i);
        panel.state.force = chosen.map(|chosen| if chosen > i { chosen - 1 } else { chosen });
    }
    panel.edit(SECTION, |scene| object.change(scene, panel.session.simulation().system(), change));
}

/// Shows the coordinates of a point and its width, m; returns the change that was typed. The reason for which a text is
/// refused becomes the message of the loads and supports.
fn coordinates(
    ui: &mut Ui,
    id: (&str, usize),
    (at, width): ([f64; 2], Option<f64>),
    messages: &mut Messages,
) -> Option<ObjectChange> {
    const POINT: &str = "Coordinate of the point at rest; numbers with a unit can be typed, such as 30 cm";
    const WIDTH: &str = "Length of the edge, or of the horizontal line through an inner point, over which it acts; the error \
                         of 0, a point, has no limit on finer meshes";
    let (mut moved, mut widened) = (at, width);
    let refused = RefCell::new(None);
    ui.push_id(id, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 5.0;
            let [x, y] = &mut moved;
            let fields = [("x", x, limits::COORDINATE, POINT), ("y", y, limits::COORDINATE, POINT)];
            let wide = widened.as_mut().map(|width| (tr("width"), width, limits::WIDTH, WIDTH));
            for (name, value, limit, tip) in fields.into_iter().chain(wide) {
                let label = ui.label(name);
                let first = FirstText::of(ui, ui.scope_id().with(name), editable(*value, "m"));
                let field = egui::DragValue::new(value)
                    .speed(0.0)
                    .update_while_editing(false)
                    .custom_formatter(|v, _| editable(v, "m"))
                    .custom_parser(|text| {
                        read(text, &first.text, limit).map_err(|reason| refused.replace(Some(reason))).ok()
                    });
                let field = ui.add(field).labelled_by(label.id).on_hover_text(tr(tip));
                first.keep(ui, &field);
            }
        });
    });
    if let Some(reason) = refused.into_inner() {
        messages.insert(SECTION, reason);
    }
    let widened = widened.filter(|_| widened != width).map(ObjectChange::Widen);
    (moved != at).then(|| ObjectChange::Move(moved.into())).or(widened)
}

pub(super) fn summary(scene: &Scene) -> String {
    let loads = (0..scene.loads.len()).filter(|i| Object::Load(*i).place(scene).is_some()).count();
    joined([count(loads as u64, "load"), count(scene.supports.len() as u64, "support")])
}

pub(super) fn show(ui: &mut Ui, panel: &mut Panel<'_>) {
    let (scene, system) = (panel.scene, panel.session.simulation().system());
    let edges = |can_carry: fn(&System, &Edge) -> bool| {
        system.edges().iter().filter(move |edge| can_carry(system, edge)).map(|edge| Place::from(edge.name()))
    };
    let all = || edges(|_, _| true).chain(points(scene));
    let on_nodes = moved_points(scene, system.mesh());
    let say_if_on_node = |ui: &mut Ui, key: &str| {
        if let Some(point) = on_nodes.iter().find(|point| point.key == key) {
            let distance = engineering(three_digits(point.distance), "m");
            ui.weak(fill!("on the nearest node, %{distance} away", distance));
        }
    };
    for (i, load) in scene.loads.iter().enumerate() {
        let remove = fill!("Remove load %{n}", n = i + 1);
        let (label, width, size) = match load {
            Load::Force { force: [x, y], width, .. } => {
                ("Force on", Some(*width), engineering(three_digits(x.hypot(*y)), "N"))
            }
            Load::Moment { moment, .. } => ("Moment on", None, engineering(three_digits(*moment), "N m")),
            Load::Gravity { .. } => continue,
        };
        let edges = edges(if load.is_moment() { can_carry_moment } else { is_free });
        let places = edges.chain(points(scene).filter(|_| !load.is_moment()));
        let size = |ui: &mut Ui| _ = ui.weak(&size);
        row(ui, panel, Object::Load(i), (tr(label), i, &remove), width, places, size);
        say_if_on_node(ui, &format!("load.{i}"));
    }
    for (i, support) in scene.supports.iter().enumerate() {
        let mut fix = support.fix.clone();
        let remove = fill!("Remove support %{n}", n = i + 1);
        let (object, names) = (Object::Support(i), (tr("Held at"), i, &*remove));
        row(ui, panel, object, names, Some(support.width), all(), |ui| directions(ui, &mut fix));
        say_if_on_node(ui, &format!("support.{i}"));
        if fix == support.fix {
            continue;
        }
        if fix.is_empty() {
            // A support that fixes no direction is removed.
            panel.edit(SECTION, |scene| object.change(scene, system, ObjectChange::Remove));
        } else {
            // The prescribed displacements of directions that stay fixed are kept.
            panel.edit(SECTION, |scene| {
                let Support { displacement, turn, fix: own, .. } = &mut scene.supports[i];
                for (axis, displacement) in [Axis::X, Axis::Y].into_iter().zip(displacement) {
                    *displacement = if fix.contains(&axis) { *displacement } else { 0.0 };
                }
                (*own, *turn) = (fix, 0.0);
            });
        }
    }
    for (i, probe) in scene.probes.iter().enumerate() {
        let name = tr(&probe.name);
        let (label, remove) = (fill!("Probe %{name}", name), fill!("Remove the probe %{name}", name));
        row(ui, panel, Object::Probe(i), (&label, i, &remove), None, all(), |_| {});
    }
    ui.horizontal_wrapped(|ui| {
        ui.label(tr("Add"));
        for (word, tip, add) in ADDITIONS {
            if ui.add(option_button(false, tr(word))).on_hover_text(tr(tip)).clicked() {
                panel.edit(SECTION, |scene| add(scene, system));
            }
        }
    });
    show_message(ui, &panel.state.messages, SECTION);
}

fn directions(ui: &mut Ui, fix: &mut Vec<Axis>) {
    ui.spacing_mut().item_spacing.x = 2.0;
    // The layout runs from right to left.
    for (axis, word) in [(Axis::Y, "y"), (Axis::X, "x")] {
        let is_fixed = fix.contains(&axis);
        let tip =
            fill!("Fixes the displacement along %{axis}: a clamp fixes both directions, a roller one", axis = word);
        if ui.add(option_button(is_fixed, word).min_size(vec2(22.0, 0.0))).on_hover_text(tip).clicked() {
            match is_fixed {
                true => fix.retain(|other| *other != axis),
                false => fix.push(axis),
            }
        }
    }
}

/// Button that adds a load, support or probe: its name, its tooltip, and the function that extends the scene.
type Addition = (&'static str, &'static str, fn(&mut Scene, &System));
const ADDITIONS: [Addition; 4] = [
    ("Force", "Add a downward force at a place without one", add_force),
    ("Moment", "Add a moment on an edge without one", add_moment),
    ("Support", "Add a support at a place that is not held; x and y select the directions that it fixes", add_support),
    ("Probe", "Add a probe: its displacement is in Details and in the table of Compare", add_probe),
];

/// Adds a force at the first place without one: a free edge, or else a point of the beam.
fn add_force(scene: &mut Scene, system: &System) {
    let usual = USUAL.into_iter().filter(|name| system.edges().iter().any(|e| e.name() == *name && is_free(system, e)));
    let others = system.edges().iter().filter(|edge| is_free(system, edge)).map(Edge::name);
    let taken: Vec<Place> = (0..scene.loads.len()).filter_map(|i| Object::Load(i).place(scene)).collect();
    let place = usual.chain(others).map(Place::from).chain(points(scene)).find(|place| !taken.contains(place));
    if let Some(place) = place {
        scene.loads.push(force_by_hand(scene, system, place));
    }
}

fn add_moment(scene: &mut Scene, system: &System) {
    let is_taken = |name: &str| scene.loads.iter().any(|l| matches!(l, Load::Moment { edge, .. } if edge == name));
    let mut edges = system.edges().iter().filter(|edge| can_carry_moment(system, edge)).map(Edge::name);
    let first = edge_for_moment(scene, system).filter(|name| !is_taken(name));
    if let Some(edge) = first.or_else(|| edges.find(|name| !is_taken(name)).map(str::to_owned)) {
        let [usual, _] = LoadRanges::new(OpeningLoads::of(scene), &scene.material, system).moment;
        scene.loads.push(Load::moment(&edge, usual));
    }
}

fn add_support(scene: &mut Scene, system: &System) {
    let is_taken = |place: &Place| match place {
        Place::Edge(name) => system.edges().iter().any(|edge| edge.name() == name && !is_free(system, edge)),
        Place::At(at) => {
            let is_held = |support: &Support| support.place == *place && support.fix.len() == 2;
            let node = system.mesh().nearest_node((*at).into());
            let is_node_held = || system.pattern().fixed(node) == [true, true] && !acts_at_point(system.mesh(), place);
            scene.supports.iter().any(is_held) || is_node_held()
        }
    };
    let edges = system.edges().iter().map(|edge| Place::from(edge.name()));
    // A beam that is held at one end gets a roller under the other end.
    let place = points(scene).chain(edges).find(|place| !is_taken(place));
    if let Some(place) = place {
        scene.supports.push(support_by_hand(system, place, &[Axis::Y]));
    }
}

/// Adds a probe at a common point of the beam that has none, or in the middle of the body.
fn add_probe(scene: &mut Scene, system: &System) {
    let mesh = system.mesh();
    let (low, high) = mesh.bounds();
    let is_free = |place: &Place| scene.probes.iter().all(|probe| probe.place != *place);
    let places = points(scene).filter_map(|place| match place {
        Place::At(at) if is_free(&place) => Some(Vector2::from(at)),
        _ => None,
    });
    let at = places.last().unwrap_or_else(|| mesh.node(mesh.nearest_node(0.5 * (low + high))));
    objects::add_probe(scene, system, at);
}

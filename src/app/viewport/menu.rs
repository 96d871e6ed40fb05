//! Menu of a point of the body: loads, supports, probes and sections to add there, and those to remove.

use std::f64::consts::FRAC_PI_2;

use crate::app::interface::*;
use crate::app::viewport::arrow::force_range;
use crate::app::viewport::moment_arrow::moment_range;
use crate::mesh::{axis_angle, bent, straightened};
use crate::scene::Probe;
use crate::section;

/// Entry of the menu: its text, and its edit.
type MenuEntry = (String, Action);

/// Shows the menu of a point with rest position `at`, m, after a click with the secondary button; returns the edit that
/// was chosen. Objects within `near`, m, can be removed; new loads have the usual magnitude of the scene's loads.
pub(crate) fn show(
    response: &Response,
    (scene, system): (&Scene, &System),
    (at, near): (Vector2<f64>, f64),
) -> Option<Action> {
    let mut chosen = None;
    response.context_menu(|ui: &mut Ui| {
        let edge = nearest_edge_for_moment(system, at);
        let added = additions(scene, system, (at, near), edge);
        let entries = added.into_iter().chain(removals(scene, system.mesh(), (at, near), edge));
        for (text, edit) in entries {
            if ui.button(text).clicked() {
                chosen = Some(edit);
                ui.close();
            }
        }
    });
    chosen
}

fn edited(scene: &Scene, edit: impl FnOnce(&mut Scene)) -> Action {
    Action::edit(EDIT, scene, edit)
}

/// Returns `true` if a force that is put at a place by hand acts at a point without a node.
pub(crate) fn acts_at_point(mesh: &Mesh, place: &Place) -> bool {
    matches!(place, Place::At(at) if mesh.node(mesh.nearest_node((*at).into())) != Vector2::from(*at))
}

/// Name of the edits that are made on the body; a message about one has no field beside which it could stand.
pub(crate) const EDIT: &str = "body";

/// Returns the width, m, of a support or force that is put at a place by hand: a tenth of the height of the beam, or of the
/// smaller dimension of another body; 0 on an edge.
fn width_by_hand(system: &System, place: &Place) -> f64 {
    let (low, high) = system.mesh().bounds();
    let height = system.beam().map_or((high - low).min(), |beam| beam.height);
    if matches!(place, Place::At(_)) { two_digits(0.1 * height) } else { 0.0 }
}

/// Moves a support or a force to another place by hand, where it acts on a width if it did, or comes from an edge.
pub(crate) fn move_by_hand(system: &System, to: Place, own: &mut Place, at_point: &mut bool, width: &mut f64) {
    *width = match (&to, &own) {
        (Place::At(_), Place::At(_)) => *width,
        _ => width_by_hand(system, &to),
    };
    *at_point = *width > 0.0 || acts_at_point(system.mesh(), &to);
    *own = to;
}

/// Returns a force, N, that is put at a place by hand.
pub(crate) fn force_by_hand(system: &System, place: Place, force: [f64; 2]) -> Load {
    let width = width_by_hand(system, &place);
    Load::Force { at_point: width > 0.0, width, place, force, pulse: None }
}

/// Returns `true` if a load on this edge can move the body: supports do not fix the whole edge.
pub(crate) fn is_free(system: &System, edge: &Edge) -> bool {
    edge.weights().iter().any(|&(node, _)| system.pattern().fixed(node) != [true, true])
}

/// Returns `true` if the edge can carry a moment and rotate under it.
pub(crate) fn can_carry_moment(system: &System, edge: &Edge) -> bool {
    edge.is_straight() && is_free(system, edge)
}

/// Returns the name of the edge nearest to a point, m, that can carry a moment.
fn nearest_edge_for_moment(system: &System, at: Vector2<f64>) -> Option<&str> {
    let mesh = system.mesh();
    let edges = system.edges().iter().filter(|edge| can_carry_moment(system, edge)).map(Edge::name);
    let distances = edges.filter_map(|name| Some((name, distance_to_edge(mesh, name, at)?)));
    distances.min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(name, _)| name)
}

/// Returns the distance, m, of a point from an edge of a mesh at rest; `None` if the edge does not exist.
fn distance_to_edge(mesh: &Mesh, name: &str, at: Vector2<f64>) -> Option<f64> {
    let distance = |segment: &Segment| (nearest_on_side(mesh, segment, at) - at).norm();
    Some(mesh.edges().get(name)?.iter().map(distance).fold(f64::INFINITY, f64::min))
}

/// Returns the point of a side at rest that is nearest to `at`, m.
fn nearest_on_side(mesh: &Mesh, side: &Segment, at: Vector2<f64>) -> Vector2<f64> {
    let [a, b] = side.ends().map(|node| mesh.node(node));
    a + (b - a) * ((at - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0)
}

/// Returns the point of the outline that is nearest to a rest position, m, or else that of the beam's axis, if it is within
/// a distance, m, or else the position; rounded.
pub(crate) fn snapped(system: &System, outline: &[Segment], at: Vector2<f64>, within: f64) -> Vector2<f64> {
    let is_close = |point: &Vector2<f64>| (point - at).norm() <= within;
    let feet = outline.iter().map(|side| nearest_on_side(system.mesh(), side, at));
    let foot = feet.min_by(|a, b| (a - at).norm().total_cmp(&(b - at).norm())).filter(is_close);
    let axis = || system.beam().map(|beam| bent(beam, straightened(beam, at)[0], 0.0)).filter(is_close);
    rounded(system, foot.or_else(axis).unwrap_or(at))
}

/// Returns a support that is put at a place by hand.
pub(crate) fn support_by_hand(system: &System, place: Place, fix: &[Axis]) -> Support {
    let width = width_by_hand(system, &place);
    Support { at_point: width > 0.0, width, ..Support::new(place, fix) }
}

/// Returns the entries that add an object at a rounded point, or a moment on an edge. A node within `near`, m, is held itself.
fn additions(scene: &Scene, system: &System, (at, near): (Vector2<f64>, f64), edge: Option<&str>) -> Vec<MenuEntry> {
    let (mesh, present) = (system.mesh(), OpeningLoads::of(scene));
    let node = mesh.node(mesh.nearest_node(at));
    let held = if (node - at).norm() <= near { node } else { at };
    let support = support_by_hand(system, held.into(), &[Axis::X, Axis::Y]);
    let held = support.place.clone();
    let [usual, _] = force_range(present, &scene.material, system);
    let force = force_by_hand(system, at.into(), [0.0, -usual]);
    let mut entries = [
        ("Add a force here", edited(scene, |scene| scene.loads.push(force))),
        ("Hold this point", edited(scene, |scene| scene.supports.push(support))),
        ("Add a probe here", edited(scene, |scene| add_probe(scene, system, at))),
        ("Add a section here", edited(scene, |scene| scene.sections.push(normal_section(system, at)))),
    ]
    .map(|(text, edit)| (tr(text).to_owned(), edit))
    .to_vec();
    // A second support of a point changes nothing.
    if scene.supports.iter().any(|support| support.place == held && support.fix.len() == 2) {
        entries.remove(1);
    }
    if let Some(edge) = edge {
        let [usual, _] = moment_range(present, &scene.material, system);
        let text = fill!("Add a moment on %{edge}", edge = tr(edge));
        entries.insert(1, (text, edited(scene, |scene| scene.loads.push(Load::moment(edge, usual)))));
    }
    entries
}

pub(crate) fn add_probe(scene: &mut Scene, system: &System, at: Vector2<f64>) {
    let is_free = |name: &String| scene.probes.iter().all(|probe| probe.name != *name);
    let name = (1..).map(|n| format!("p{n}")).find(is_free).unwrap_or_default();
    scene.probes.push(Probe { name, place: Place::At(rounded(system, at).into()) });
}

/// Adds a section through the middle of the body.
pub(crate) fn add_middle_section(scene: &mut Scene, system: &System) {
    let (low, high) = system.mesh().bounds();
    let node = || system.mesh().node(system.mesh().nearest_node(0.5 * (low + high)));
    let middle = system.beam().map_or_else(node, |beam| bent(beam, 0.5, 0.0));
    scene.sections.push(normal_section(system, rounded(system, middle)));
}

/// Returns the section through a point that is normal to the axis of the beam; in a body without axis it is vertical or
/// horizontal, whichever is shorter.
fn normal_section(system: &System, at: Vector2<f64>) -> SectionLine {
    if let Some(beam) = system.beam() {
        return SectionLine { at, angle: axis_angle(beam, straightened(beam, at)[0]) };
    }
    let [vertical, horizontal] = [0.0, FRAC_PI_2].map(|angle| SectionLine { at, angle });
    let length = |line| section::cut_ends(system, line).map_or(f64::INFINITY, |[from, to]| to - from);
    if length(horizontal) < length(vertical) { horizontal } else { vertical }
}

/// Rounds a point to a thousandth of the body's size, and to a hundredth of its smaller dimension, if the body has that
/// point.
pub(crate) fn rounded(system: &System, at: Vector2<f64>) -> Vector2<f64> {
    let (low, high) = system.mesh().bounds();
    let step = (1e-3 * system.size()).min(1e-2 * (high - low).min());
    let step = 10f64.powf(step.log10().floor());
    // Quotients by a power of ten have short decimals.
    let rounded =
        at.map(|x| if step < 1.0 { (x / step).round() / (1.0 / step).round() } else { (x / step).round() * step });
    let rounded = rounded.map(|x| if x == 0.0 { 0.0 } else { x });
    if system.mesh().locate(rounded).is_some() { rounded } else { at }
}

/// Returns the entries that remove an object at a point near `at`, a support of an edge near it, or a moment on an edge.
fn removals(scene: &Scene, mesh: &Mesh, (at, near): (Vector2<f64>, f64), edge: Option<&str>) -> Vec<MenuEntry> {
    let is_near = |place: &Place| match place {
        Place::At(point) => (Vector2::from(*point) - at).norm() <= near,
        Place::Edge(_) => false,
    };
    let is_near_force = |load: &Load| matches!(load, Load::Force { place, .. } if is_near(place));
    let probes = scene.probes.iter().enumerate().filter(|(_, probe)| is_near(&probe.place)).map(|(i, probe)| {
        let text = fill!("Remove the probe %{name}", name = tr(&probe.name));
        (text, edited(scene, |scene| _ = scene.probes.remove(i)))
    });
    let forces = scene.loads.iter().enumerate().filter(|(_, load)| is_near_force(load));
    let forces =
        forces.map(|(i, _)| (tr("Remove this force").to_owned(), edited(scene, |scene| _ = scene.loads.remove(i))));
    let moments = scene.loads.iter().enumerate().filter_map(|(i, load)| match load {
        Load::Moment { edge: own, .. } if edge == Some(own) => {
            let text = fill!("Remove the moment on %{edge}", edge = tr(own));
            Some((text, edited(scene, |scene| _ = scene.loads.remove(i))))
        }
        _ => None,
    });
    let is_near_edge = |place: &Place| match place {
        Place::Edge(name) => distance_to_edge(mesh, name, at).is_some_and(|distance| distance <= near),
        Place::At(_) => false,
    };
    let supports = scene.supports.iter().enumerate();
    let supports = supports
        .filter(|(_, support)| is_near(&support.place) || is_near_edge(&support.place))
        .map(|(i, _)| (tr("Remove this support").to_owned(), edited(scene, |scene| _ = scene.supports.remove(i))));
    let is_on_line = |line: &SectionLine| line.normal().dot(&(at - line.at)).abs() <= near;
    let sections = scene.sections.iter().enumerate().filter(|(_, line)| is_on_line(line));
    let sections = sections
        .map(|(i, _)| (tr("Remove this section").to_owned(), edited(scene, |scene| _ = scene.sections.remove(i))));
    probes.chain(forces).chain(moments).chain(supports).chain(sections).collect()
}

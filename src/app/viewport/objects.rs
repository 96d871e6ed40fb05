//! Objects of a scene that have a place: loads, supports, probes and sections. Panel, drags and the menu of a point put them
//! there, move and remove them here.

use std::f64::consts::FRAC_PI_2;

use crate::app::interface::*;
use crate::app::viewport::arrow::LoadRanges;
use crate::mesh::{axis_angle, bent, straightened};
use crate::scene::Probe;
use crate::section;

/// Object of a scene, by its index among those of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Object {
    /// Force or moment.
    Load(usize),
    Support(usize),
    Probe(usize),
    Section(usize),
    /// End of the cut of a section, 0 or 1, which turns about the point of the section.
    SectionEnd(usize, usize),
}

impl Object {
    /// Returns the edge or the point of the object; `None` for gravity and the end of a section.
    pub(crate) fn place(self, scene: &Scene) -> Option<Place> {
        match self {
            Self::Load(i) => match scene.loads.get(i)? {
                Load::Force { place, .. } => Some(place.clone()),
                Load::Moment { edge, .. } => Some(Place::from(edge.as_str())),
                Load::Gravity { .. } => None,
            },
            Self::Support(i) => scene.supports.get(i).map(|support| support.place.clone()),
            Self::Probe(i) => scene.probes.get(i).map(|probe| probe.place.clone()),
            Self::Section(i) => scene.sections.get(i).map(|line| Place::At(line.at.into())),
            Self::SectionEnd(..) => None,
        }
    }

    /// Changes the object, if the scene has it: a dragged one may have been undone.
    pub(crate) fn change(self, scene: &mut Scene, system: &System, change: ObjectChange) {
        if self.place(scene).is_none() {
            return;
        }
        match (self, change) {
            (Self::Load(i), ObjectChange::Remove) => _ = scene.loads.remove(i),
            (Self::Support(i), ObjectChange::Remove) => _ = scene.supports.remove(i),
            (Self::Probe(i), ObjectChange::Remove) => _ = scene.probes.remove(i),
            (Self::Section(i), ObjectChange::Remove) => _ = scene.sections.remove(i),
            (Self::Load(i), change) => match (&mut scene.loads[i], change) {
                (Load::Force { place, at_point, width, .. }, change) => change.apply(system, (place, at_point, width)),
                (Load::Moment { edge, .. }, ObjectChange::Move(Place::Edge(to))) => *edge = to,
                _ => {}
            },
            (Self::Support(i), change) => {
                let Support { place, at_point, width, .. } = &mut scene.supports[i];
                change.apply(system, (place, at_point, width));
            }
            (Self::Probe(i), ObjectChange::Move(to)) => scene.probes[i].place = to,
            (Self::Section(i), ObjectChange::Move(Place::At(to))) => scene.sections[i].at = to.into(),
            _ => {}
        }
    }
}

/// Change of an object by hand.
pub(crate) enum ObjectChange {
    Move(Place),
    /// Width of a force or a support, m.
    Widen(f64),
    Remove,
}

impl ObjectChange {
    /// Moves or widens a force or a support. At another place it acts on a width if it did, or comes from an edge.
    fn apply(self, system: &System, (place, at_point, width): (&mut Place, &mut bool, &mut f64)) {
        match self {
            Self::Move(to) => {
                if matches!(to, Place::Edge(_)) || matches!(place, Place::Edge(_)) {
                    *width = width_by_hand(system, &to);
                }
                *at_point = *width > 0.0 || acts_at_point(system.mesh(), &to);
                *place = to;
            }
            Self::Widen(to) => (*at_point, *width) = (true, to),
            Self::Remove => {}
        }
    }
}

/// Returns `true` if a force that is put at a place by hand acts at a point without a node.
pub(crate) fn acts_at_point(mesh: &Mesh, place: &Place) -> bool {
    matches!(place, Place::At(at) if mesh.node(mesh.nearest_node((*at).into())) != Vector2::from(*at))
}

/// Returns the width, m, of a support or force that is put at a place by hand: a tenth of the height of the beam, or of the
/// smaller dimension of another body; 0 on an edge.
fn width_by_hand(system: &System, place: &Place) -> f64 {
    let (low, high) = system.mesh().bounds();
    let height = system.beam().map_or((high - low).min(), |beam| beam.height);
    if matches!(place, Place::At(_)) { two_digits(0.1 * height) } else { 0.0 }
}

/// Returns a downward force of the usual magnitude of the scene's loads that is put at a place by hand.
pub(crate) fn force_by_hand(scene: &Scene, system: &System, place: Place) -> Load {
    let [usual, _] = LoadRanges::new(OpeningLoads::of(scene), &scene.material, system).force;
    let width = width_by_hand(system, &place);
    Load::Force { at_point: width > 0.0, width, place, force: [0.0, -usual], pulse: None }
}

/// Returns a support that is put at a place by hand.
pub(crate) fn support_by_hand(system: &System, place: Place, fix: &[Axis]) -> Support {
    let width = width_by_hand(system, &place);
    Support { at_point: width > 0.0, width, ..Support::new(place, fix) }
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

/// Entry of the menu: its text, and its edit.
type MenuEntry = (String, Action);

/// Shows the menu of a point with rest position `at`, m, after a click with the secondary button; returns the edit that
/// was chosen. Objects within `near`, m, can be removed; new loads have the usual magnitude of the scene's loads.
pub(crate) fn show_menu(
    response: &Response,
    (scene, system): (&Scene, &System),
    (at, near): (Vector2<f64>, f64),
) -> Option<Action> {
    let mut chosen = None;
    response.context_menu(|ui: &mut Ui| {
        let edge = nearest_edge_for_moment(system, at);
        let added = additions(scene, system, (at, near), edge);
        let entries = added.into_iter().chain(removals(scene, system, (at, near), edge));
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

/// Name of the edits that are made on the body; a message about one has no field beside which it could stand.
pub(crate) const EDIT: &str = "body";

/// Returns `true` if a load on this edge can move the body: supports do not fix the whole edge.
pub(crate) fn is_free(system: &System, edge: &Edge) -> bool {
    edge.weights.iter().any(|&(node, _)| system.pattern().fixed(node) != [true, true])
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

/// Returns the entries that add an object at a rounded point, or a moment on an edge. A node within `near`, m, is held itself.
fn additions(scene: &Scene, system: &System, (at, near): (Vector2<f64>, f64), edge: Option<&str>) -> Vec<MenuEntry> {
    let mesh = system.mesh();
    let node = mesh.node(mesh.nearest_node(at));
    let held = if (node - at).norm() <= near { node } else { at };
    let support = support_by_hand(system, held.into(), &[Axis::X, Axis::Y]);
    let held = support.place.clone();
    let force = force_by_hand(scene, system, at.into());
    // A second support of a point changes nothing.
    let is_held = scene.supports.iter().any(|support| support.place == held && support.fix.len() == 2);
    let moment = edge.map(|edge| {
        let [usual, _] = LoadRanges::new(OpeningLoads::of(scene), &scene.material, system).moment;
        let text = fill!("Add a moment on %{edge}", edge = tr(edge));
        (text, edited(scene, |scene| scene.loads.push(Load::moment(edge, usual))))
    });
    let entry = |text: &str, edit: Action| Some((tr(text).to_owned(), edit));
    let entries = [
        entry("Add a force here", edited(scene, |scene| scene.loads.push(force))),
        moment,
        entry("Hold this point", edited(scene, |scene| scene.supports.push(support))).filter(|_| !is_held),
        entry("Add a probe here", edited(scene, |scene| add_probe(scene, system, at))),
        entry("Add a section here", edited(scene, |scene| scene.sections.push(normal_section(system, at)))),
    ];
    entries.into_iter().flatten().collect()
}

/// Returns the entries that remove an object at a point near `at`, a support of an edge near it, or a moment on an edge.
fn removals(scene: &Scene, system: &System, (at, near): (Vector2<f64>, f64), edge: Option<&str>) -> Vec<MenuEntry> {
    let entry = |object: Object| {
        let distance = match object.place(scene)? {
            Place::At(point) => (Vector2::from(point) - at).norm(),
            Place::Edge(name) if matches!(object, Object::Support(_)) => distance_to_edge(system.mesh(), &name, at)?,
            Place::Edge(_) => f64::INFINITY,
        };
        let (is_here, text) = match object {
            Object::Load(i) => match scene.loads.get(i)? {
                Load::Moment { edge: own, .. } => {
                    (edge == Some(own), fill!("Remove the moment on %{edge}", edge = tr(own)))
                }
                _ => (distance <= near, tr("Remove this force").to_owned()),
            },
            Object::Support(_) => (distance <= near, tr("Remove this support").to_owned()),
            Object::Probe(i) => {
                (distance <= near, fill!("Remove the probe %{name}", name = tr(&scene.probes.get(i)?.name)))
            }
            Object::Section(section) | Object::SectionEnd(section, _) => {
                let line = scene.sections.get(section)?;
                (line.normal().dot(&(at - line.at)).abs() <= near, tr("Remove this section").to_owned())
            }
        };
        is_here.then(|| (text, edited(scene, |scene| object.change(scene, system, ObjectChange::Remove))))
    };
    let probes = (0..scene.probes.len()).map(Object::Probe);
    let loads = (0..scene.loads.len()).map(Object::Load);
    let supports = (0..scene.supports.len()).map(Object::Support);
    let sections = (0..scene.sections.len()).map(Object::Section);
    probes.chain(loads).chain(supports).chain(sections).filter_map(entry).collect()
}

//! Menu of a point of the body: loads, supports and probes to add there, and those to remove.

use egui::{Response, Ui};
use nalgebra::Vector2;

use crate::app::language::{fill, tr};
use crate::assembly::System;
use crate::scene::{Axis, Load, Place, Probe, Scene, Support};

/// Entry of the menu: its text, and the scene that it leads to.
type Entry = (String, Scene);

/// Shows the menu of a point with rest position `at`, m, after a click with the secondary button; returns the scene that
/// was chosen. Objects within `near`, m, can be removed; a new force has the magnitude `usual`, N.
pub(crate) fn show(
    response: &Response,
    (scene, system): (&Scene, &System),
    (at, near): (Vector2<f64>, f64),
    usual: f64,
) -> Option<Scene> {
    let mut chosen = None;
    response.context_menu(|ui: &mut Ui| {
        let entries = additions(scene, system, at, usual).into_iter().chain(removals(scene, at, near));
        for (text, edited) in entries {
            if ui.button(text).clicked() {
                chosen = Some(edited);
                ui.close();
            }
        }
    });
    chosen
}

/// Returns the entries that add an object. Forces and supports act on nodes, so they are put on the nearest one.
fn additions(scene: &Scene, system: &System, at: Vector2<f64>, usual: f64) -> Vec<Entry> {
    let nodes = system.mesh().nodes().iter();
    let node = nodes.min_by(|a, b| (*a - at).norm_squared().total_cmp(&(*b - at).norm_squared())).copied();
    let node: [f64; 2] = node.unwrap_or(at).into();
    let [mut force, mut support, mut probe] = [(); 3].map(|()| scene.clone());
    force.loads.push(Load::force(node, [0.0, -usual]));
    support.supports.push(Support::new(node, &[Axis::X, Axis::Y]));
    let is_free = |name: &String| scene.probes.iter().all(|probe| probe.name != *name);
    let name = (1..).map(|n| format!("p{n}")).find(is_free).unwrap_or_default();
    probe.probes.push(Probe { name, place: Place::At(rounded(system, at).into()) });
    vec![
        (tr("Add a force here").to_owned(), force),
        (tr("Hold this point").to_owned(), support),
        (tr("Add a probe here").to_owned(), probe),
    ]
}

/// Rounds a point to a thousandth of the body's size, if the body has that point.
fn rounded(system: &System, at: Vector2<f64>) -> Vector2<f64> {
    let step = 10f64.powf((1e-3 * system.size()).log10().floor());
    // Quotients by a power of ten have short decimals.
    let rounded =
        at.map(|x| if step < 1.0 { (x / step).round() / (1.0 / step).round() } else { (x / step).round() * step });
    if system.mesh().locate(rounded).is_some() { rounded } else { at }
}

/// Returns the entries that remove an object at a point near `at`.
fn removals(scene: &Scene, at: Vector2<f64>, near: f64) -> Vec<Entry> {
    let is_near = |place: &Place| match place {
        Place::At(point) => (Vector2::from(*point) - at).norm() <= near,
        Place::Edge(_) => false,
    };
    let mut entries = Vec::new();
    for (i, probe) in scene.probes.iter().enumerate().filter(|(_, probe)| is_near(&probe.place)) {
        let mut without = scene.clone();
        without.probes.remove(i);
        entries.push((fill!("Remove the probe %{name}", name = probe.name.as_str()), without));
    }
    for (i, load) in scene.loads.iter().enumerate() {
        if let Load::Force { place, .. } = load
            && is_near(place)
        {
            let mut without = scene.clone();
            without.loads.remove(i);
            entries.push((tr("Remove this force").to_owned(), without));
        }
    }
    for (i, _) in scene.supports.iter().enumerate().filter(|(_, support)| is_near(&support.place)) {
        let mut without = scene.clone();
        without.supports.remove(i);
        entries.push((tr("Remove this support").to_owned(), without));
    }
    entries
}

//! A load path as a figure: unstable branches are dashed, a jump is dotted.

use super::figure::{Figure, FigurePoint, FigureQuantity, FigureSeries, Ink, LoadAxis, Mark, dominant_axis};
use super::prelude::*;
use super::{LoadPath, PathState, support_text};

/// The pair of quantities that is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ordinate {
    /// The reaction of a support that moves, else the larger displacement component of the first probe.
    Usual,
    /// The components of a probe's displacement against each other, by its number.
    Path(usize),
    /// A component of a probe's displacement: the probe's number, then 0 for x or 1 for y.
    Component(usize, usize),
    /// The length of a probe's displacement, by its number.
    Probe(usize),
    /// The size of a support's reaction force, by its number.
    Reaction(usize),
}

/// Function that renders a name.
pub type Render<'a> = &'a dyn Fn(&Sentence) -> String;

/// Draws the path over the displacement or angle of the moving support, or over the load; `render` translates its
/// names.
pub fn figure(path: &LoadPath, scene: &Scene, ordinate: &Ordinate, render: Render<'_>) -> Figure {
    let probe = match ordinate {
        Ordinate::Path(i) | Ordinate::Component(i, _) | Ordinate::Probe(i) => *i,
        Ordinate::Usual | Ordinate::Reaction(_) => 0,
    };
    let name = scene.probes.get(probe).map_or("probe", |p| p.name.as_str());
    let displacement = |s: &PathState| s.probes.get(probe).copied().unwrap_or_else(Vector2::zeros);
    let turns = path.rotates(scene);
    let along = abscissa(path, scene);
    let mut quantities = vec![
        FigureQuantity::new(render(&along.name), along.unit),
        FigureQuantity::new(render(&sentence!("u_x of %{probe}", probe = name)), "m"),
        FigureQuantity::new(render(&sentence!("u_y of %{probe}", probe = name)), "m"),
    ];
    let axes = match (ordinate, path.driven) {
        (Ordinate::Path(_), _) => [1, 2],
        (Ordinate::Component(_, axis), _) => [0, 1 + axis.min(&1)],
        (Ordinate::Usual, None) => [0, 1 + dominant_axis(path.states.iter().map(displacement))],
        (Ordinate::Usual | Ordinate::Reaction(_) | Ordinate::Probe(_), _) => [0, 3],
    };
    quantities.extend(
        match (ordinate, path.driven) {
            (Ordinate::Reaction(i), _) => Some((format!("reaction of {}", support_text(scene, *i)), "N")),
            (Ordinate::Probe(_), _) => Some((format!("displacement of {name}"), "m")),
            // The other axis names the support.
            (_, Some(_)) => Some((render(&sentence!("reaction in this direction")), if turns { "N m" } else { "N" })),
            _ => None,
        }
        .map(|(name, unit)| FigureQuantity::new(name, unit)),
    );
    let point = |s: &PathState| {
        let u = displacement(s);
        let driven = path.driven_pair(scene, s);
        let last = match ordinate {
            Ordinate::Reaction(i) => s.reactions.get(*i).map(|r| r.force.norm()),
            Ordinate::Probe(_) => Some(u.norm()),
            _ => driven.map(|[_, force]| force),
        };
        let along = match driven {
            Some([motion, _]) if turns => motion.to_degrees(),
            Some([motion, _]) => motion,
            None => along.full * s.factor,
        };
        [along, u.x, u.y].into_iter().chain(last).collect()
    };
    let points: Vec<FigurePoint> = path.states.iter().map(point).collect();
    let mut series: Vec<FigureSeries> = pieces(path, &points)
        .into_iter()
        .map(|(points, (name, ink, mark))| FigureSeries::new(render(&name.into()), ink, mark, points))
        .collect();
    // Where the path loses or regains its stability without a jump.
    series.extend(path.bifurcations.iter().filter_map(|bifurcation| {
        let next = path.states.iter().position(|s| s.factor > bifurcation.factor)?;
        let (from, to) = (points.get(next.checked_sub(1)?)?, points.get(next)?);
        let middle = from.iter().zip(to).map(|(a, b)| 0.5 * (a + b)).collect();
        Some(FigureSeries::new(render(&bifurcation.label()), Ink::Unstable, Mark::Disc, vec![middle]))
    }));
    let (name, last) = (render(&sentence!("the scene")), points.last().cloned());
    series.push(FigureSeries::new(name, Ink::Scene, Mark::Disc, last.into_iter().collect()));
    Figure { title: format!("{}: load path", path.scene), quantities, axes, series, head: Default::default() }
}

/// Returns the axis of the quantity that grows along the path.
fn abscissa(path: &LoadPath, scene: &Scene) -> LoadAxis {
    let place = path.driven.and_then(|i| scene.supports.get(i)).map(|support| &support.place);
    let (name, unit) = match place {
        Some(place) if path.rotates(scene) => {
            (sentence!("rotation of support %{place}", place = place.to_string()), "°")
        }
        Some(Place::At([x, y])) => {
            (sentence!("displacement of support (%{x}, %{y})", x = number(*x), y = number(*y)), "m")
        }
        Some(Place::Edge(edge)) => (sentence!("displacement of support %{place}", place = edge.as_str()), "m"),
        None => return LoadAxis::of(scene),
    };
    LoadAxis { name, unit, full: 1.0 }
}

/// Name, colour and mark of the lines of a path.
type PathLine = (&'static str, Ink, Mark);

/// Joins neighbouring points of a path to lines of one kind, which share their ends; a jump comes last.
fn pieces(path: &LoadPath, points: &[FigurePoint]) -> Vec<(Vec<FigurePoint>, PathLine)> {
    let mut pieces: Vec<(Vec<FigurePoint>, PathLine)> = Vec::new();
    for (i, (pair, states)) in points.windows(2).zip(path.states.windows(2)).enumerate() {
        // A piece is stable where both of its ends are, with the supports held. A jump has no equilibria.
        let is_stable = states.iter().all(|s| s.unstable_modes == 0);
        let line = match path.states_before_jump == Some(i + 1) {
            true => ("it jumps", Ink::Unstable, Mark::Dots),
            false if is_stable => ("load path", Ink::Solution(MethodKind::Newton.entry().colors), Mark::Line),
            false => ("unstable", Ink::Unstable, Mark::Dashes),
        };
        match pieces.last_mut().filter(|(_, last)| *last == line) {
            Some((points, _)) => points.push(pair[1].clone()),
            None => pieces.push((pair.to_vec(), line)),
        }
    }
    pieces.sort_by_key(|(_, (_, _, mark))| *mark == Mark::Dots);
    pieces
}

//! A load path as a figure: unstable branches are dashed, a jump is dotted.

use nalgebra::Vector2;

use super::figure::{Figure, FigurePoint, FigureQuantity, FigureRow, FigureSeries, Ink, LoadAxis, Mark, dominant_axis};
use super::{LoadPath, PathState, support_text};
use crate::format::number;
use crate::scene::{MethodKind, Place, Scene};
use crate::sentence::{Sentence, sentence};

/// The pair of quantities that is drawn.
#[derive(Clone, Debug, PartialEq)]
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
#[must_use]
pub fn figure(path: &LoadPath, scene: &Scene, ordinate: &Ordinate, render: Render<'_>) -> Figure {
    let probe = match ordinate {
        Ordinate::Path(i) | Ordinate::Component(i, _) | Ordinate::Probe(i) => *i,
        Ordinate::Usual | Ordinate::Reaction(_) => 0,
    };
    let name = scene.probes.get(probe).map_or("probe", |p| p.name.as_str());
    let displacement = |s: &PathState| s.probes.get(probe).copied().unwrap_or_else(Vector2::zeros);
    let along = Abscissa::of(path, scene);
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
    quantities.extend(match (ordinate, path.driven) {
        (Ordinate::Reaction(i), _) => {
            Some(FigureQuantity::new(format!("reaction of {}", support_text(scene, *i)), "N"))
        }
        (Ordinate::Probe(_), _) => Some(FigureQuantity::new(format!("displacement of {name}"), "m")),
        // The other axis names the support.
        (_, Some(_)) => {
            let name = render(&sentence!("reaction in this direction"));
            Some(FigureQuantity::new(name, if along.turns { "N m" } else { "N" }))
        }
        _ => None,
    });
    let point = |s: &PathState| {
        let u = displacement(s);
        let driven = path.driven_pair(scene, s).map(|[_, force]| force);
        let last = match ordinate {
            Ordinate::Reaction(i) => s.reactions.get(*i).map(|r| r.force.norm()),
            Ordinate::Probe(_) => Some(u.norm()),
            _ => driven,
        };
        FigurePoint::new([along.value(path, scene, s), u.x, u.y].into_iter().chain(last))
    };
    let points: Vec<FigurePoint> = path.states.iter().map(point).collect();
    let mut series: Vec<FigureSeries> =
        pieces(path, &points).into_iter().map(|(points, piece)| piece.series(points, render)).collect();
    series.extend(bifurcations(path, &points, render));
    let last = points.last().map(|point| FigurePoint { is_present: true, ..point.clone() });
    let name = render(&sentence!("the scene"));
    series.push(FigureSeries::new(name, Ink::Scene, Mark::Disc, last.into_iter().collect()));
    let mut rows: Vec<FigureRow> = Vec::new();
    for FigureSeries { name, ink, mark, .. } in &series {
        if !rows.iter().any(|row| row.name == *name) {
            rows.push(FigureRow { name: name.clone(), ink: *ink, mark: *mark, value: String::new() });
        }
    }
    Figure { title: format!("{}: load path", path.scene), quantities, axes, series, head: Default::default(), rows }
}

/// The quantity that grows along the path.
struct Abscissa {
    name: Sentence,
    unit: &'static str,
    full: f64,
    turns: bool,
}

impl Abscissa {
    fn of(path: &LoadPath, scene: &Scene) -> Self {
        let turns = path.rotates(scene);
        let place = path.driven.and_then(|i| scene.supports.get(i)).map(|support| &support.place);
        let (name, unit) = match place {
            Some(place) if turns => (sentence!("rotation of support %{place}", place = place.to_string()), "°"),
            Some(Place::At([x, y])) => {
                (sentence!("displacement of support (%{x}, %{y})", x = number(*x), y = number(*y)), "m")
            }
            Some(Place::Edge(edge)) => (sentence!("displacement of support %{place}", place = edge.as_str()), "m"),
            None => {
                let LoadAxis { name, unit, full } = LoadAxis::of(scene);
                return Self { name, unit, full, turns };
            }
        };
        Self { name, unit, full: 1.0, turns }
    }

    fn value(&self, path: &LoadPath, scene: &Scene, state: &PathState) -> f64 {
        match path.driven_pair(scene, state) {
            Some([displacement, _]) if self.turns => displacement.to_degrees(),
            Some([displacement, _]) => displacement,
            None => self.full * state.factor,
        }
    }
}

/// Kind of a line of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PathLine {
    /// Equilibria that are stable with the supports held.
    Stable,
    /// Equilibria that are unstable.
    Unstable,
    /// No equilibria: from where the body jumps to where it comes to rest.
    Jump,
}

impl PathLine {
    fn series(self, points: Vec<FigurePoint>, render: Render<'_>) -> FigureSeries {
        let (name, ink, mark) = match self {
            Self::Stable => ("stable", Ink::Method(MethodKind::Newton), Mark::Line),
            Self::Unstable => ("unstable", Ink::Unstable, Mark::Dashes),
            Self::Jump => ("it jumps", Ink::Unstable, Mark::Dots),
        };
        FigureSeries::new(render(&name.into()), ink, mark, points)
    }
}

/// Returns the lines of a path, each of one kind.
fn pieces(path: &LoadPath, points: &[FigurePoint]) -> Vec<(Vec<FigurePoint>, PathLine)> {
    let stable: Vec<bool> = path.states.iter().map(|s| s.unstable_modes == 0).collect();
    let Some(cut) = path.states_before_jump.filter(|cut| (1..points.len()).contains(cut)) else {
        return branches(points, &stable);
    };
    let ((before, after), (stable_before, stable_after)) = (points.split_at(cut), stable.split_at(cut));
    let mut pieces = branches(before, stable_before);
    pieces.extend(branches(after, stable_after));
    if let (Some(from), Some(to)) = (before.last(), after.first()) {
        pieces.push((vec![from.clone(), to.clone()], PathLine::Jump));
    }
    pieces
}

/// Joins neighbouring points of one kind to lines, which share their ends.
fn branches(points: &[FigurePoint], stable: &[bool]) -> Vec<(Vec<FigurePoint>, PathLine)> {
    let mut branches: Vec<(Vec<FigurePoint>, PathLine)> = Vec::new();
    for (pair, stable) in points.windows(2).zip(stable.windows(2)) {
        // A piece is stable where both of its ends are.
        let kind = if stable[0] && stable[1] { PathLine::Stable } else { PathLine::Unstable };
        match branches.last_mut().filter(|branch| branch.1 == kind) {
            Some((points, _)) => points.push(pair[1].clone()),
            None => branches.push((pair.to_vec(), kind)),
        }
    }
    branches
}

/// Returns the places where the path loses or regains its stability without a jump, each with its label.
fn bifurcations<'a>(
    path: &'a LoadPath,
    points: &'a [FigurePoint],
    render: Render<'a>,
) -> impl Iterator<Item = FigureSeries> + 'a {
    path.bifurcations.iter().filter_map(|bifurcation| {
        let next = path.states.iter().position(|s| s.factor > bifurcation.factor)?;
        let (from, to) = (points.get(next.checked_sub(1)?)?, points.get(next)?);
        let middle = from.values.iter().zip(&to.values).map(|(a, b)| Some(0.5 * ((*a)? + (*b)?))).collect();
        let points = vec![FigurePoint { values: middle, ..FigurePoint::default() }];
        Some(FigureSeries::new(render(&bifurcation.label()), Ink::Unstable, Mark::Disc, points))
    })
}

/// Returns the name of a state of a path for tables; empty if it is stable.
#[must_use]
pub fn stability_text(state: &PathState) -> &'static str {
    if state.unstable_modes == 0 { "" } else { "unstable" }
}

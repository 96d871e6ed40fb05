//! A load path as a picture (SVG): unstable branches are dashed, a jump is dotted.

use std::fmt::Write as _;

use super::chart::Margins;
use super::{LoadPath, PathState, support_words};
use crate::scene::Scene;
use crate::words::{number, prefix};

/// What is drawn over what.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// What goes to the right, with its unit.
    pub x_label: String,
    /// What goes up, with its unit.
    pub y_label: String,
    /// A point for every state of the path, in these units, and whether it is stable under force control.
    pub points: Vec<([f64; 2], bool)>,
}

/// What goes up.
#[derive(Clone, Debug, PartialEq)]
pub enum Ordinate {
    /// What says most of the path: the reaction of a support that moves, else the displacement of the first probe.
    Usual,
    /// The length of a probe's displacement, by its number.
    Probe(usize),
    /// The size of a support's reaction force, by its number.
    Reaction(usize),
}

/// The path over the way of the support that moves, or over the load.
#[must_use]
pub fn drawn(path: &LoadPath, scene: &Scene, ordinate: &Ordinate) -> Drawn {
    let driven = |s: &PathState| path.driven_pair(scene, s);
    let turns = path.driven.and_then(|i| scene.supports.get(i)).is_some_and(|s| s.displacement == [0.0; 2]);
    let mut x: Vec<f64> = path.states.iter().map(|s| driven(s).map_or(100.0 * s.factor, |[way, _]| way)).collect();
    let (name, unit) = match path.driven {
        Some(i) if turns => (format!("turn of {}", support_words(scene, i)), "°"),
        Some(i) => (format!("way of {}", support_words(scene, i)), "m"),
        None => ("part of the load".to_owned(), "%"),
    };
    if turns {
        x.iter_mut().for_each(|angle| *angle = angle.to_degrees());
    }
    let x_label = scaled(&mut x, &name, unit);
    let probe_name = |i: usize| scene.probes.get(i).map_or("largest", |p| p.name.as_str());
    let probe = |s: &PathState, i: usize| s.probes.get(i).map_or(0.0, |u| u.norm());
    let (mut y, name, unit): (Vec<f64>, _, _) = match (ordinate, path.driven) {
        (Ordinate::Reaction(i), _) => (
            path.states.iter().map(|s| s.reactions.get(*i).map_or(0.0, |r| r.force.norm())).collect(),
            format!("reaction of {}", support_words(scene, *i)),
            "N",
        ),
        // The other axis names the support.
        (Ordinate::Usual, Some(_)) => (
            path.states.iter().map(|s| driven(s).map_or(0.0, |[_, force]| force)).collect(),
            "its reaction along the way".to_owned(),
            if turns { "N m" } else { "N" },
        ),
        (Ordinate::Usual, None) | (Ordinate::Probe(_), _) => {
            let i = if let Ordinate::Probe(i) = ordinate { *i } else { 0 };
            (path.states.iter().map(|s| probe(s, i)).collect(), format!("displacement of {}", probe_name(i)), "m")
        }
    };
    let y_label = scaled(&mut y, &name, unit);
    let stable = path.states.iter().map(|s| s.stable != Some(false));
    Drawn { x_label, y_label, points: x.into_iter().zip(y).map(|(x, y)| [x, y]).zip(stable).collect() }
}

/// Takes values to the prefix that suits them; what they are, with their unit.
fn scaled(values: &mut [f64], name: &str, unit: &str) -> String {
    let (power, symbol) = prefix(values, unit);
    values.iter_mut().for_each(|v| *v /= 10f64.powi(power));
    format!("{name}, {symbol}{unit}")
}

/// What a line of a path is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Piece {
    /// Equilibria that are stable under force control too.
    Stable,
    /// Equilibria that are stable only as supports hold them.
    Unstable,
    /// No equilibria: from where the body jumps to where it comes to rest.
    Jump,
}

impl Drawn {
    /// The lines of a path.
    #[must_use]
    pub fn pieces(&self, path: &LoadPath) -> Vec<(Vec<[f64; 2]>, Piece)> {
        let kind = |stable: bool| if stable { Piece::Stable } else { Piece::Unstable };
        let jump = path.jump.filter(|jump| jump.distance > 0.0);
        let cut = jump.and_then(|jump| path.states.iter().position(|s| s.factor > jump.factor));
        let Some(cut) = cut.filter(|&cut| cut > 0) else {
            return self.branches().into_iter().map(|(points, stable)| (points, kind(stable))).collect();
        };
        let (before, after) = self.points.split_at(cut);
        let mut pieces = Vec::new();
        for part in [before, after] {
            let part = Self { points: part.to_vec(), ..self.clone() };
            pieces.extend(part.branches().into_iter().map(|(points, stable)| (points, kind(stable))));
        }
        if let (Some(from), Some(to)) = (before.last(), after.first()) {
            pieces.push((vec![from.0, to.0], Piece::Jump));
        }
        pieces
    }

    /// Where the path loses or regains its stability without a jump, each with its label.
    #[must_use]
    pub fn bifurcations(&self, path: &LoadPath) -> Vec<([f64; 2], String)> {
        let all = path.bifurcations.iter().filter_map(|bifurcation| {
            let next = path.states.iter().position(|s| s.factor > bifurcation.factor)?;
            let (from, to) = (self.points.get(next.checked_sub(1)?)?.0, self.points.get(next)?.0);
            Some(([0, 1].map(|i| 0.5 * (from[i] + to[i])), bifurcation.label()))
        });
        all.collect()
    }

    /// Lines of neighbouring points that are of one kind, each with whether it is stable; they share their ends.
    fn branches(&self) -> Vec<(Vec<[f64; 2]>, bool)> {
        let mut branches: Vec<(Vec<[f64; 2]>, bool)> = Vec::new();
        for pair in self.points.windows(2) {
            // A piece is stable where both of its ends are.
            let stable = pair[0].1 && pair[1].1;
            match branches.last_mut().filter(|branch| branch.1 == stable) {
                Some((points, _)) => points.push(pair[1].0),
                None => branches.push((vec![pair[0].0, pair[1].0], stable)),
            }
        }
        branches
    }
}

const MARGINS: Margins = Margins { left: 86.0, right: 36.0, top: 56.0, bottom: 64.0 };

/// Values from one end of the picture to the other.
struct Axis {
    from: f64,
    to: f64,
    step: f64,
}

impl Axis {
    /// Round numbers around some values, and around 0.
    fn around(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = values.fold((0.0_f64, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        let span = if high > low { high - low } else { 1.0 };
        let decade = 10f64.powf((span / 6.0).log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * decade).into_iter().find(|s| span / s <= 7.0).unwrap_or(span);
        Self { from: (low / step).floor() * step, to: (high / step).ceil().max(1.0) * step, step }
    }

    fn place(&self, value: f64, [start, end]: [f64; 2]) -> f64 {
        start + (end - start) * (value - self.from) / (self.to - self.from)
    }

    fn ticks(&self) -> impl Iterator<Item = f64> {
        let count = ((self.to - self.from) / self.step).round() as i32;
        // Free of the rounding of sums.
        (0..=count).map(|i| ((self.from / self.step).round() + f64::from(i)) * self.step)
    }
}

/// Draws the path.
#[must_use]
pub fn svg(path: &LoadPath, scene: &Scene, ordinate: &Ordinate) -> String {
    let drawn = drawn(path, scene, ordinate);
    let (x, y) =
        (Axis::around(drawn.points.iter().map(|(p, _)| p[0])), Axis::around(drawn.points.iter().map(|(p, _)| p[1])));
    let (across, up) = (MARGINS.across(), MARGINS.up());
    let at = |p: [f64; 2]| [x.place(p[0], across), y.place(p[1], up)];
    let mut svg = MARGINS.head(&format!("{}: load path", path.scene));
    let ticks = |axis: &Axis, ends| axis.ticks().map(|value| (axis.place(value, ends), tick(value))).collect();
    MARGINS.grid(&mut svg, [ticks(&x, across), ticks(&y, up)], [&drawn.x_label, &drawn.y_label]);
    let jumps = path.jump.is_some_and(|jump| jump.distance > 0.0);
    for (points, stable) in drawn.pieces(path) {
        let line: Vec<String> = points.iter().map(|&p| at(p)).map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let (color, dashes) = match stable {
            Piece::Stable => ("#0064b4", ""),
            Piece::Unstable => ("#be141e", " stroke-dasharray=\"9 5\""),
            Piece::Jump => ("#be141e", " stroke-dasharray=\"2 5\""),
        };
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2.2\"{dashes}/>",
            line.join(" ")
        );
    }
    for (point, words) in drawn.bifurcations(path) {
        let [x, y] = at(point);
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\" fill=\"#be141e\"/><text x=\"{:.1}\" y=\"{:.1}\">{words}</text>",
            x + 9.0,
            y + 18.0
        );
    }
    let mut row = 0.0;
    let mut key = |words: &str, color: &str, dashes: &str| {
        let (right, y) = (across[1] - 230.0, 24.0 + row);
        let _ = writeln!(
            svg,
            "<line x1=\"{right}\" y1=\"{y}\" x2=\"{}\" y2=\"{y}\" stroke=\"{color}\" stroke-width=\"2.2\"{dashes}/><text x=\"{}\" y=\"{}\">{words}</text>",
            right + 34.0,
            right + 42.0,
            y + 4.0
        );
        row += 18.0;
    };
    if drawn.points.iter().any(|(_, stable)| !stable) {
        key(unstable_words(path), "#be141e", " stroke-dasharray=\"9 5\"");
    }
    if jumps {
        key("it jumps", "#be141e", " stroke-dasharray=\"2 5\"");
    }
    svg.push_str("</svg>\n");
    svg
}

/// Name of the unstable part of a path: where a support moves, it is unstable only once that is let go of.
#[must_use]
pub fn unstable_words(path: &LoadPath) -> &'static str {
    if path.driven.is_some() { "unstable under force control" } else { "unstable" }
}

/// A number at an axis, without the rounding of its steps.
fn tick(value: f64) -> String {
    let short: f64 = format!("{value:.6e}").parse().unwrap_or(value);
    number(if short == 0.0 { 0.0 } else { short })
}

//! Load curve. For a cantilever it shows linear theory, the exact beam, the result of every method, and the loads at
//! which linear theory departs. For any other scene it shows the load path, with unstable parts dashed.

use super::*;
use crate::format::engineering_pair_among;
use crate::study::path_chart::{self, Ordinate};
use crate::study::{LoadCurve, LoadPath, PathState, Sample};

/// Quantities that a load curve can show, each with its name and a description; the first only of a moving support.
const PLOTS: [(Ordinate, &str, &str); 4] = [
    (Ordinate::Usual, "Reaction", "Reaction of the support against its displacement"),
    (Ordinate::Path(0), "Path", "Path of the first probe: u_y against u_x, in equal scales"),
    (Ordinate::Component(0, 0), "u_x", "u_x of the first probe against load"),
    (Ordinate::Component(0, 1), "u_y", "u_y of the first probe against load"),
];

/// Shows the plot, or the previous scene's while a new one is being computed. Without a plot it shows the reason: it is
/// being computed, or the scene has none.
pub(crate) fn show(
    ui: &mut Ui,
    session: &Session,
    fact: &Keyed<facts::CurveFact>,
    chosen: Option<Ordinate>,
    actions: &mut Vec<Action>,
) {
    let scene = session.scene();
    let looked_for = !fact.is_pending(scene);
    let Some(curve) = fact.latest() else {
        ui.centered_and_justified(|ui| {
            ui.weak(match fact.failure(scene) {
                Some(reason) => said(reason),
                None if looked_for => tr("No load curve: in linear theory it is a straight line.").to_owned(),
                None => tr("The load curve is being computed.").to_owned(),
            });
        });
        return;
    };
    let offered = curve.offered();
    let shown = chosen.filter(|own| offered.iter().any(|(other, ..)| other == own)).unwrap_or_else(|| curve.usual());
    let mut drawn = curve.figure(shown);
    if let Some(body) = first_probe(session.drawn()).filter(|_| looked_for) {
        move_scene(&mut drawn, body);
    }
    // The curve of a cantilever has linear theory of beams.
    if let (Curve::Path(of), Some(linear)) = (curve, session.linear().and_then(first_probe))
        && of.0.driven.is_none()
        && looked_for
    {
        let points = vec![figure::point(0.0, Vector2::zeros()), figure::point(LoadAxis::of(scene).full, linear)];
        let ink = Ink::Solution(MethodKind::Linear.id());
        let series = FigureSeries::new(tr(MethodKind::Linear.id()).to_owned(), ink, Mark::Dashes, points);
        drawn.series.push(FigureSeries { may_leave: true, ..series });
    }
    let show_table = |ui: &mut Ui| {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(4.0, 2.0);
            actions.extend(options(ui, offered.iter().copied(), Some(shown)).map(Action::Plot));
            figure::export_menu(ui, &drawn, actions);
        });
        figure::table(ui, &drawn);
    };
    let area = figure::beside(ui, |ui| _ = figure::plot(ui, &drawn, drawn.corners()), show_table);
    if !looked_for {
        let text = "Curve before the last change; the new one is being computed.";
        let at = area.center_top() + egui::vec2(0.0, 10.0);
        let color = ui.visuals().weak_text_color();
        Labels::new(ui.painter(), ui.visuals()).add(at, Align2::CENTER_TOP, tr(text), color, area.width());
    }
}

impl Curve {
    /// Returns the quantities that can be shown.
    fn offered(&self) -> &'static [(Ordinate, &'static str, &'static str)] {
        let is_driven = matches!(self, Self::Path(of) if of.0.driven.is_some());
        if is_driven { &PLOTS } else { &PLOTS[1..] }
    }

    /// Returns the default quantities: the reaction of a moving support, else the larger component of the displacement
    /// over the load, where a result has another value than the exact beam at the same load.
    fn usual(&self) -> Ordinate {
        let tip = |state: &PathState| state.probes.first().copied();
        match self {
            Self::Path(of) if of.0.driven.is_some() => Ordinate::Usual,
            Self::Beam(of) => Ordinate::Component(0, dominant_axis(of.0.samples.iter().map(|s| s.exact))),
            Self::Path(of) => Ordinate::Component(0, dominant_axis(of.0.states.iter().filter_map(tip))),
        }
    }

    fn figure(&self, shown: Ordinate) -> Figure {
        match self {
            Self::Beam(of) => beam(&of.0, &of.1.0, shown),
            Self::Path(of) => path(&of.0, &of.1.0, shown),
        }
    }
}

/// Formats a displacement, m, for a table, in the prefix that suits its whole column.
fn pair(u: Vector2<f64>, column: &[Vector2<f64>]) -> String {
    let column: Vec<f64> = column.iter().flat_map(|u| [u.x, u.y]).collect();
    engineering_pair_among([u.x, u.y].map(three_digits), &column, "m")
}

fn path(path: &LoadPath, scene: &Scene, shown: Ordinate) -> Figure {
    Figure { title: curve_title(scene), ..path_chart::figure(path, scene, &shown, &|name| said(name)) }
}

/// Moves the mark of the scene from the end of the path to the displacement of the body, which may be at rest elsewhere.
fn move_scene(figure: &mut Figure, body: Vector2<f64>) {
    let marks = figure.series.iter_mut().filter(|series| series.ink == Ink::Scene);
    for [_, x, y] in marks.flat_map(|series| &mut series.points).filter_map(|point| point.values.first_chunk_mut()) {
        (*x, *y) = (Some(body.x), Some(body.y));
    }
}

fn curve_title(scene: &Scene) -> String {
    format!("{}: {}", tr(&scene.name), tr("Load curve"))
}

fn beam(curve: &LoadCurve, scene: &Scene, shown: Ordinate) -> Figure {
    let LoadAxis { name, unit, full } = LoadAxis::of(scene);
    let line = |value: fn(&Sample) -> Vector2<f64>| -> Vec<FigurePoint> {
        let samples = curve.samples.iter();
        samples.map(|s| figure::point(s.factor * full, value(s))).collect()
    };
    let series = |name: String, ink, mark, may_leave, points| FigureSeries {
        may_leave,
        ..FigureSeries::new(name, ink, mark, points)
    };
    let mut all = vec![
        series(tr("linear beam theory").to_owned(), Ink::BeamTheory, Mark::Dashes, true, line(|s| s.linear)),
        series(tr("exact beam").to_owned(), Ink::BeamTheory, Mark::Line, false, line(|s| s.exact)),
    ];
    let departures = curve.departures.iter().map(|(_, at)| figure::point(at.factor * full, at.exact)).collect();
    let departs = departure_text(&curve.departures, (full, unit));
    if let Some((name, _)) = &departs {
        all.push(series(name.clone(), Ink::BeamTheory, Mark::Ring, false, departures));
    }
    for point in &curve.methods {
        let converged = point.status == Status::Converged;
        let mark = if converged { Mark::Disc } else { Mark::Cross };
        let state = if converged { "" } else { tr("does not converge") }.to_owned();
        let may_leave = !converged || point.method == MethodKind::Linear;
        let at = FigurePoint { state, is_present: true, ..figure::point(full, point.tip) };
        // Linear theory of the elements differs from that of beams.
        let name = format!("{} {}", scene.element().id(), tr(point.method.id()));
        all.push(series(name, Ink::Solution(point.method.id()), mark, may_leave, vec![at]));
    }
    let at_load = curve.samples.iter().find(|s| (s.factor - 1.0).abs() < 1e-9);
    let converged = curve.methods.iter().filter(|p| p.status == Status::Converged);
    let column: Vec<_> = at_load.iter().flat_map(|s| [s.exact, s.linear]).chain(converged.map(|p| p.tip)).collect();
    let in_column = |u| pair(u, &column);
    let value = |series: &FigureSeries| match series.mark {
        Mark::Ring => departs.as_ref().map(|(_, loads)| loads.clone()),
        Mark::Cross => Some(tr("does not converge").to_owned()),
        Mark::Line => at_load.map(|s| in_column(s.exact)),
        Mark::Dashes => at_load.map(|s| in_column(s.linear)),
        _ => curve.methods.iter().find(|p| series.ink == Ink::Solution(p.method.id())).map(|p| in_column(p.tip)),
    };
    all.iter_mut().for_each(|series| series.value = Some(value(series).unwrap_or_default()));
    let load = engineering(three_digits(full), unit);
    let probe = scene.probes.first().map_or("probe", |probe| probe.name.as_str());
    let [x, y] = [sentence!("u_x of %{probe}", probe), sentence!("u_y of %{probe}", probe)].map(|name| said(&name));
    Figure {
        title: curve_title(scene),
        // The quantities are load, u_x and u_y.
        axes: match shown {
            Ordinate::Path(_) => [1, 2],
            Ordinate::Component(_, 0) => [0, 1],
            _ => [0, 2],
        },
        series: all,
        head: [fill!("at %{load}", load), fill!("(u_x, u_y) of %{probe}", probe = tr(probe))],
        quantities: vec![
            FigureQuantity::new(said(&name), unit),
            FigureQuantity::new(x, "m"),
            FigureQuantity::new(y, "m"),
        ],
    }
}

/// Returns the errors in percent at which linear theory departs from the exact beam, and the loads.
fn departure_text(departures: &[(f64, Sample)], (full, unit): (f64, &str)) -> Option<(String, String)> {
    let each = |value: &dyn Fn(&(f64, Sample)) -> String| departures.iter().map(value).collect::<Vec<_>>().join(", ");
    let percent = each(&|(percent, _)| percent.to_string());
    let loads = each(&|(_, at)| engineering(three_digits(at.factor * full), unit));
    (!departures.is_empty())
        .then(|| (fill!("beam theory off by %{percent} %", percent), fill!("at %{load}", load = loads)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Source, open};

    /// The mark of the scene is at the displacement of the body, also where the path from rest ends elsewhere.
    #[test]
    fn the_mark_of_the_scene_is_at_the_body() {
        let scene = open(&Source { name: "jump".into(), assignments: Vec::new() }).unwrap();
        let followed = LoadPath::of(&scene).unwrap();
        let before = path(&followed, &scene, Ordinate::Component(0, 1));
        let mut after = before.clone();
        move_scene(&mut after, Vector2::new(1.0, 2.0));
        for (before, after) in before.series.iter().zip(&after.series) {
            match before.ink {
                Ink::Scene => assert_eq!(after.points[0].values[1..3], [Some(1.0), Some(2.0)]),
                _ => assert_eq!(before, after),
            }
        }
        assert_eq!(after.series.iter().filter(|series| series.ink == Ink::Scene).count(), 1);
    }
}

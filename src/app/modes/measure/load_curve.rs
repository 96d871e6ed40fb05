//! Load curve: the load path on the scene's mesh, with unstable parts dashed, and linear theory. For a cantilever it also
//! shows linear beam theory, the exact beam, and the loads at which they depart.

use super::*;
use crate::format::engineering_pair_among;
use crate::study::Sample;
use crate::study::path_chart::{self, Ordinate};

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
    if looked_for {
        curve.add_present(&mut drawn, first_probe(session.drawn()), session.linear().and_then(first_probe));
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
        if self.path.driven.is_some() { &PLOTS } else { &PLOTS[1..] }
    }

    /// Returns the default quantities: the reaction of a moving support, else the larger component of the displacement over
    /// the load.
    fn usual(&self) -> Ordinate {
        let of_beam = self.beam.iter().flat_map(|beam| &beam.samples).map(|sample| sample.exact);
        let displacements = self.path.states.iter().filter_map(|state| state.probes.first().copied());
        match self.path.driven {
            Some(_) => Ordinate::Usual,
            None => Ordinate::Component(0, dominant_axis(displacements.chain(of_beam))),
        }
    }

    /// Draws the load path, and over the load also beam theory.
    fn figure(&self, shown: Ordinate) -> Figure {
        let scene = &self.scene.0;
        let title = format!("{}: {}", tr(&scene.name), tr("Load curve"));
        let mut figure = Figure { title, ..path_chart::figure(&self.path, scene, &shown, &|name| said(name)) };
        let Some(beam) = self.beam.as_ref().filter(|_| self.path.driven.is_none()) else { return figure };
        let LoadAxis { unit, full, .. } = LoadAxis::of(scene);
        let point = |s: &Sample, u: Vector2<f64>| vec![s.factor * full, u.x, u.y];
        let mut add = |name: String, mark, may_leave, points, value: Option<String>| {
            let series = FigureSeries::new(name, Ink::Text, mark, points);
            figure.series.push(FigureSeries { may_leave, value, ..series });
        };
        let samples = beam.samples.iter();
        let linear = samples.clone().map(|s| point(s, s.linear)).collect();
        add(tr("linear beam theory").to_owned(), Mark::Dashes, true, linear, None);
        add(tr("exact beam").to_owned(), Mark::Line, false, samples.map(|s| point(s, s.exact)).collect(), None);
        if let Some((name, loads)) = departure_text(&beam.departures, (full, unit)) {
            let points = beam.departures.iter().map(|(_, at)| point(at, at.exact)).collect();
            add(name, Mark::Ring, false, points, Some(loads));
        }
        figure
    }

    /// Adds the present displacements of the first probe, m: that of the body, which may be at rest elsewhere than at the
    /// end of the path, and that of linear theory. The table then has the displacements of all lines under the scene's load.
    fn add_present(&self, figure: &mut Figure, body: Option<Vector2<f64>>, linear: Option<Vector2<f64>>) {
        /// Relative rounding error of a load.
        const ROUNDING: f64 = 1e-9;
        let (scene, LoadAxis { unit, full, .. }) = (&self.scene.0, LoadAxis::of(&self.scene.0));
        let marks = figure.series.iter_mut().filter(|series| series.ink == Ink::Scene);
        let places = marks.flat_map(|series| &mut series.points).filter_map(|point| point.first_chunk_mut());
        for ([_, x, y], u) in places.zip(body) {
            (*x, *y) = (u.x, u.y);
        }
        if self.path.driven.is_some() {
            return;
        }
        figure.series.extend(linear.map(|u| {
            let (linear, points) = (MethodKind::Linear.entry(), vec![vec![0.0; 3], vec![full, u.x, u.y]]);
            let name = format!("{} {}", scene.element().id(), tr(linear.id));
            FigureSeries {
                may_leave: true,
                ..FigureSeries::new(name, Ink::Solution(linear.colors), Mark::Dashes, points)
            }
        }));
        let at_load = |series: &FigureSeries| {
            series.points.iter().find_map(|point| match point[..] {
                [load, x, y, ..] if (load - full).abs() <= ROUNDING * full => Some([x, y].map(three_digits)),
                _ => None,
            })
        };
        let column: Vec<f64> = figure.series.iter().filter_map(at_load).flatten().collect();
        for series in &mut figure.series {
            let value = at_load(series).map(|u| engineering_pair_among(u, &column, "m"));
            series.value = value.or_else(|| series.value.take());
        }
        let probe = scene.probes.first().map_or("probe", |probe| probe.name.as_str());
        let load = engineering(three_digits(full), unit);
        figure.head = [fill!("at %{load}", load), fill!("(u_x, u_y) of %{probe}", probe = tr(probe))];
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
    use crate::app::task::keyed::SentScene;
    use crate::scene::{Source, open};
    use crate::study::LoadPath;

    /// The mark of the scene is at the displacement of the body, also where the path from rest ends elsewhere.
    #[test]
    fn the_mark_of_the_scene_is_at_the_body() {
        let scene = open(&Source { name: "jump".into(), assignments: Vec::new() }).unwrap();
        let path = LoadPath::of(&scene, &|_| std::ops::ControlFlow::Continue(())).unwrap();
        let curve = Curve { path, scene: SentScene(scene), beam: None };
        let before = curve.figure(Ordinate::Component(0, 1));
        let mut after = before.clone();
        curve.add_present(&mut after, Some(Vector2::new(1.0, 2.0)), None);
        for (before, after) in before.series.iter().zip(&after.series) {
            match before.ink {
                Ink::Scene => assert_eq!(after.points[0][1..3], [1.0, 2.0]),
                _ => assert_eq!(before.points, after.points),
            }
        }
        assert_eq!(after.series.iter().filter(|series| series.ink == Ink::Scene).count(), 1);
    }
}

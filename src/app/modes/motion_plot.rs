//! Plots of a motion: energy by kind, and displacement of the first probe over time.

use super::*;
use crate::app::session::history::{History, MotionSample};
use crate::app::view_options::MotionPlot;

const PLOTS: [(MotionPlot, &str, &str); 2] = [
    (MotionPlot::Energy, "Energy", "Energy over time, by kind"),
    (MotionPlot::Tip, "Tip", "Displacement of the first probe over time"),
];

/// Duration that is shown, s; more if the displayed moment is earlier.
const SHOWN: f64 = 12.0;
/// Largest number of points of a line; longer lines are thinned.
const MAX_POINTS: usize = 1000;
/// Size of the sample of a line's colour, points.
const SAMPLE: Vec2 = vec2(14.0, 3.0);

/// Returns the line of a value in the last seconds of a motion.
fn line(
    (name, ink): (&str, Ink),
    (history, seconds): (&History, f64),
    value: impl Fn(&MotionSample) -> f64,
) -> FigureSeries {
    let samples: Vec<&MotionSample> = history.last(seconds).collect();
    let stride = samples.len().div_ceil(MAX_POINTS).max(1);
    let points = samples.iter().rev().step_by(stride).map(|s| FigurePoint::new([s.time, value(s)])).collect();
    FigureSeries::new(tr(name).to_owned(), ink, Mark::Line, points)
}

/// Shows the chosen plot, with the names of its lines above it.
pub(crate) fn show(ui: &mut Ui, chosen: &mut MotionPlot, session: &Session) {
    let (playback, integrator) = (&session.playback, session.scene().dynamics.integrator);
    let palette = Palette::new(ui.visuals());
    let axis = playback.history.axis();
    let probe = format!("{} {}", tr(&playback.history.probe), ["x", "y"][axis]);
    let before_end = playback.shown.zip(playback.span()).map(|(shown, [_, last])| last - shown);
    let seconds = before_end.unwrap_or_default().max(SHOWN);
    let (y, series) = match chosen {
        MotionPlot::Energy => (FigureQuantity::new(tr("energy"), "J"), energies(&playback.history, seconds, &palette)),
        MotionPlot::Tip => {
            let look = (integrator.id(), Ink::Solution(integrator.id()));
            (FigureQuantity::new(probe, "m"), vec![line(look, (&playback.history, seconds), |s| s.displacement[axis])])
        }
    };
    ui.horizontal_wrapped(|ui| {
        *chosen = options(ui, PLOTS, Some(*chosen)).unwrap_or(*chosen);
        ui.spacing_mut().item_spacing.x = 14.0;
        let shown = series.iter().filter(|line| !line.points.is_empty());
        for line in shown {
            let sample = |ui: &Ui, sample| _ = ui.painter().rect_filled(sample, 1.0, palette.ink(line.ink));
            legend::entry(ui, &line.name, SAMPLE, &sample);
        }
    });
    if playback.history.samples.is_empty() {
        ui.centered_and_justified(|ui| ui.weak(tr("No time step yet: press Run or Step.")));
        return;
    }
    let quantities = vec![FigureQuantity::new(tr("time"), "s"), y];
    let drawn = Figure { quantities, axes: [0, 1], series, ..Figure::default() };
    let [mut low, mut high] = drawn.corners();
    // The oldest and the latest moment are at the edges.
    let mut times = playback.history.last(seconds).map(|sample| sample.time);
    if let Some(times) = times.next().zip(times.last()) {
        (low[0], high[0]) = times;
    }
    let (mut painter, [time, value]) = figure::plot(ui, &drawn, [low, high]);
    // Displayed moment, if it is not the latest.
    if let Some(x) = playback.shown.map(|shown| time.place(shown)) {
        painter.line(&[low[1], high[1]].map(|end| [x, value.place(end)]), Ink::Text, solid(1.0));
    }
}

/// Name of a kind of energy, its colour, and the function that returns its value, J.
type EnergyKind = (&'static str, Color32, fn(&MotionSample) -> f64);

/// Returns the energies of a motion by kind, and their sum. Energies that are always zero have no line.
fn energies(history: &History, seconds: f64, palette: &Palette) -> Vec<FigureSeries> {
    let [kinetic, elastic, potential, dissipated, lost, put_in] = palette.energies();
    let kinds: [EnergyKind; 6] = [
        ("kinetic", kinetic, |s| s.ledger.kinetic),
        ("elastic", elastic, |s| s.ledger.elastic),
        ("potential of loads", potential, |s| s.ledger.potential),
        ("dissipated", dissipated, |s| s.ledger.dissipated),
        ("lost by the integrator", lost, |s| s.ledger.integrator),
        ("energy input", put_in, |s| s.ledger.pulses + s.ledger.mouse_spring + s.ledger.edits),
    ];
    let shown = kinds.into_iter().filter(|(_, _, value)| history.samples.iter().any(|s| value(s) != 0.0));
    let parts = shown.map(|(name, color, value)| {
        let [r, g, b, _] = color.to_array();
        line((name, Ink::Fixed([r, g, b])), (history, seconds), value)
    });
    parts.chain([line(("total", Ink::Text), (history, seconds), |s| s.ledger.total())]).collect()
}

//! Plots of a motion: energy by kind, and displacement of the first probe over time.

use crate::app::view_options::MotionPlot;
use egui::{Color32, Ui, Vec2, vec2};
use egui_plot::{Line, PlotPoint, PlotPoints, VLine};

use crate::app::language::{fill, tr};
use crate::app::session::history::{History, MotionSample};
use crate::app::session::playback::Playback;
use crate::app::widgets::buttons::option_button;
use crate::app::widgets::legend;
use crate::app::widgets::palette::Palette;
use crate::app::widgets::plot::still;
use crate::scene::IntegratorKind;

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

/// Named line of a plot.
struct PlotLine {
    name: String,
    color: Color32,
    width: f32,
    points: Vec<PlotPoint>,
}

/// Lines and axes of a plot.
struct LinePlot<'a> {
    id: &'a str,
    /// Name and unit of each axis.
    axes: [(&'a str, &'static str); 2],
    lines: Vec<PlotLine>,
}

/// Shows the chosen plot, with the names of its lines above it.
pub(crate) fn show(ui: &mut Ui, chosen: &mut MotionPlot, playback: &Playback, integrator: IntegratorKind) {
    let palette = Palette::new(ui.visuals());
    // One line per motion.
    let companions = playback.companions().iter().map(|c| (c.integrator, &c.history));
    let motions: Vec<_> = std::iter::once((integrator, &playback.history)).chain(companions).collect();
    let axis = playback.history.axis();
    let name = format!("{} {}", tr(playback.history.probe()), ["x", "y"][axis]);
    let lines = |points: &dyn Fn(&History) -> Vec<PlotPoint>| -> Vec<PlotLine> {
        let line = |&(kind, history): &(IntegratorKind, &History)| PlotLine {
            name: tr(kind.id()).to_owned(),
            color: palette.integrator(kind),
            width: 1.5,
            points: points(history),
        };
        motions.iter().map(line).collect()
    };
    let time = (tr("time"), "s");
    let before_end = playback.shown_time().zip(playback.span()).map(|(shown, [_, last])| last - shown);
    let duration = before_end.unwrap_or_default().max(SHOWN);
    let drawn = match chosen {
        MotionPlot::Energy => {
            LinePlot { id: "energy", axes: [time, (tr("energy"), "J")], lines: energies(&motions, duration, &palette) }
        }
        MotionPlot::Tip => {
            let lines = lines(&|history| thinned(history, duration, |s| [s.time, s.displacement[axis]]));
            LinePlot { id: "tip", axes: [time, (&name, "m")], lines }
        }
    };
    ui.horizontal_wrapped(|ui| {
        for (plot, word, tip) in PLOTS {
            if ui.add(option_button(*chosen == plot, tr(word))).on_hover_text(tr(tip)).clicked() {
                *chosen = plot;
            }
        }
        ui.spacing_mut().item_spacing.x = 14.0;
        let shown = drawn.lines.iter().filter(|line| !line.points.is_empty());
        for line in shown {
            let sample = |ui: &Ui, sample| _ = ui.painter().rect_filled(sample, 1.0, line.color);
            legend::entry(ui, &line.name, SAMPLE, &sample);
        }
    });
    if playback.history.samples().is_empty() {
        ui.centered_and_justified(|ui| ui.weak(tr("No time step yet: press Run or Step.")));
        return;
    }
    let LinePlot { id, axes: [x, y], lines } = drawn;
    // Displayed moment, if it is not the latest.
    let cursor = playback.shown_time();
    still(&palette, id, x, y).show(ui, |plot| {
        for PlotLine { name, color, width, points } in lines {
            plot.line(Line::new(name, PlotPoints::Owned(points)).color(color).width(width));
        }
        if let Some(time) = cursor {
            plot.vline(VLine::new("", time).color(palette.text).width(1.0));
        }
    });
}

fn thinned(history: &History, duration: f64, point: impl Fn(&MotionSample) -> [f64; 2]) -> Vec<PlotPoint> {
    let samples: Vec<&MotionSample> = history.last(duration).collect();
    let stride = samples.len().div_ceil(MAX_POINTS).max(1);
    let kept = samples.iter().rev().step_by(stride);
    kept.map(|s| PlotPoint::from(point(s))).collect()
}

/// Name of a kind of energy, its colour, and the function that returns its value, J.
type EnergyKind = (&'static str, Color32, fn(&MotionSample) -> f64);

/// Returns the energies of a motion by kind, and their sum; of several motions only the sum of each, for comparison.
fn energies(motions: &[(IntegratorKind, &History)], duration: f64, palette: &Palette) -> Vec<PlotLine> {
    let [kinetic, elastic, potential, dissipated, lost, put_in] = palette.energies();
    let kinds: [EnergyKind; 6] = [
        ("kinetic", kinetic, |s| s.ledger.kinetic),
        ("elastic", elastic, |s| s.ledger.elastic),
        ("potential of loads", potential, |s| s.ledger.potential),
        ("dissipated", dissipated, |s| s.ledger.dissipated),
        ("lost by the integrator", lost, |s| s.ledger.integrator),
        ("energy input", put_in, |s| s.ledger.pulses + s.ledger.mouse_spring + s.ledger.edits),
    ];
    let total = |history: &History| thinned(history, duration, |s| [s.time, s.ledger.total()]);
    if let [(_, history)] = motions {
        // Energies that are always zero have no line.
        let shown = kinds.into_iter().filter(|(_, _, value)| history.samples().iter().any(|s| value(s) != 0.0));
        let parts = shown.map(|(name, color, value)| PlotLine {
            name: tr(name).to_owned(),
            color,
            width: 1.5,
            points: thinned(history, duration, |s| [s.time, value(s)]),
        });
        let sum = PlotLine { name: tr("total").to_owned(), color: palette.text, width: 2.5, points: total(history) };
        return parts.chain([sum]).collect();
    }
    let sum = |&(kind, history): &(IntegratorKind, &History)| PlotLine {
        name: fill!("total, %{integrator}", integrator = tr(kind.id())),
        color: palette.integrator(kind),
        width: 2.5,
        points: total(history),
    };
    motions.iter().map(sum).collect()
}

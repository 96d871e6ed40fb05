//! Plots of a motion: energy by kind, displacement of the first probe over time, its phase diagram, and its spectrum.

use crate::app::view_options::MotionPlot;
use egui::{Color32, Ui};
use egui_plot::{Corner, Legend, Line, LineStyle, Plot, PlotPoint, PlotPoints, PlotUi, Points, VLine};
use realfft::RealFftPlanner;

use crate::app::language::{fill, tr};
use crate::app::session::history::{History, MotionSample};
use crate::app::session::playback::Playback;
use crate::app::widgets::buttons::option_button;
use crate::app::widgets::palette::Palette;
use crate::app::widgets::plot::still;
use crate::format::engineering;
use crate::scene::IntegratorKind;

const PLOTS: [(MotionPlot, &str, &str); 4] = [
    (MotionPlot::Energy, "Energy", "Energy over time, by kind"),
    (MotionPlot::Tip, "Tip", "Displacement of the first probe over time"),
    (MotionPlot::Phase, "Phase", "Velocity of the first probe against its displacement"),
    (MotionPlot::Spectrum, "Spectrum", "Amplitudes of the frequencies in the motion of the first probe"),
];

/// Duration that is shown, s.
const SHOWN: f64 = 12.0;
/// Space for the legend to the right of the data, as a fraction of the data's width.
const LEGEND_ROOM: f64 = 0.22;
/// Largest number of points of a line; longer lines are thinned.
const MAX_POINTS: usize = 1000;
/// Largest number of samples of the spectrum; a power of two.
const LONGEST_SPECTRUM: usize = 4096;
/// Smallest number of samples of a spectrum.
const SHORTEST_SPECTRUM: usize = 64;

/// Shows the chosen plot; `frequency` is the lowest natural frequency, Hz.
pub(crate) fn show(
    ui: &mut Ui,
    chosen: &mut MotionPlot,
    playback: &Playback,
    integrator: IntegratorKind,
    frequency: Option<f64>,
) {
    ui.horizontal(|ui| {
        for (plot, word, tip) in PLOTS {
            if ui.add(option_button(*chosen == plot, tr(word))).on_hover_text(tr(tip)).clicked() {
                *chosen = plot;
            }
        }
    });
    if playback.history.samples().is_empty() {
        ui.centered_and_justified(|ui| ui.weak(tr("No time step yet: press Run or Step.")));
        return;
    }
    let palette = Palette::new(ui.visuals());
    // One line per motion.
    let companions = playback.companions().iter().map(|c| (c.integrator, &c.history));
    let motions: Vec<_> = std::iter::once((integrator, &playback.history)).chain(companions).collect();
    let axis = playback.history.axis();
    // Displayed moment, if it is not the latest.
    let cursor = playback.shown_time();
    let name = format!("{} {}", tr(playback.history.probe()), ["x", "y"][axis]);
    match chosen {
        MotionPlot::Energy => energy(ui, &playback.history, &motions, cursor),
        MotionPlot::Tip => {
            let lines =
                motions.iter().map(|(kind, history)| (*kind, thinned(history, |s| [s.time, s.displacement[axis]])));
            let plot = over_time(plot(&palette, "tip", (tr("time"), "s"), (&name, "m")), &playback.history);
            plot.show(ui, |plot| {
                curves(plot, lines, &palette);
                time_cursor(plot, cursor, &palette);
            });
        }
        MotionPlot::Phase => {
            let lines = motions
                .iter()
                .map(|(kind, history)| (*kind, thinned(history, |s| [s.displacement[axis], s.velocity[axis]])));
            plot(&palette, "phase", (&name, "m"), (tr("velocity"), "m/s")).show(ui, |plot| {
                curves(plot, lines, &palette);
                if let Some(sample) = cursor.and_then(|time| playback.history.at(time)) {
                    let at = Points::new("", [sample.displacement[axis], sample.velocity[axis]]);
                    plot.points(at.color(palette.text).radius(4.0));
                }
            });
        }
        MotionPlot::Spectrum => spectra(ui, &motions, axis, frequency, &palette),
    }
}

fn plot<'a>(palette: &Palette, id: &str, x: (&str, &'static str), y: (&str, &'static str)) -> Plot<'a> {
    still(palette, id, x, y).legend(Legend::default().position(Corner::LeftTop).follow_insertion_order(true))
}

fn thinned(history: &History, point: impl Fn(&MotionSample) -> [f64; 2]) -> Vec<PlotPoint> {
    let samples: Vec<&MotionSample> = history.last(SHOWN).collect();
    let stride = samples.len().div_ceil(MAX_POINTS).max(1);
    let kept = samples.iter().rev().step_by(stride);
    kept.map(|s| PlotPoint::from(point(s))).collect()
}

/// Adds space for the legend to the right of the data.
fn over_time<'a>(plot: Plot<'a>, history: &History) -> Plot<'a> {
    let first = history.last(SHOWN).next().map_or(0.0, |s| s.time);
    let last = history.samples().back().map_or(0.0, |s| s.time);
    plot.include_x(last + LEGEND_ROOM * (last - first).max(1e-9))
}

/// Marks the displayed moment.
fn time_cursor(plot: &mut PlotUi<'_>, time: Option<f64>, palette: &Palette) {
    if let Some(time) = time {
        plot.vline(VLine::new("", time).color(palette.text).width(1.0));
    }
}

fn curves(plot: &mut PlotUi<'_>, lines: impl Iterator<Item = (IntegratorKind, Vec<PlotPoint>)>, palette: &Palette) {
    for (kind, points) in lines {
        let line = Line::new(tr(kind.id()), PlotPoints::Owned(points));
        plot.line(line.color(palette.integrator(kind)).width(1.5));
    }
}

/// Name of a kind of energy, its colour, and the function that returns its value, J.
type EnergyKind = (&'static str, Color32, fn(&MotionSample) -> f64);

fn energy(ui: &mut Ui, history: &History, motions: &[(IntegratorKind, &History)], cursor: Option<f64>) {
    let palette = Palette::new(ui.visuals());
    let sum = palette.text;
    let [kinetic, elastic, potential, dissipated, lost, put_in] = palette.energies();
    let kinds: [EnergyKind; 6] = [
        ("kinetic", kinetic, |s| s.ledger.kinetic),
        ("elastic", elastic, |s| s.ledger.elastic),
        ("potential of loads", potential, |s| s.ledger.potential),
        ("dissipated", dissipated, |s| s.ledger.dissipated),
        ("lost by the integrator", lost, |s| s.ledger.integrator),
        ("energy input", put_in, |s| s.ledger.pulses + s.ledger.mouse_spring + s.ledger.edits),
    ];
    over_time(plot(&palette, "energy", (tr("time"), "s"), (tr("energy"), "J")), history).show(ui, |plot| {
        // With several motions only the total energy of each is shown, for comparison.
        let shown = if motions.len() == 1 { &kinds[..] } else { &[] };
        for (name, color, value) in shown {
            // Energies that are always zero have no line.
            if history.samples().iter().any(|s| value(s) != 0.0) {
                let points = thinned(history, |s| [s.time, value(s)]);
                plot.line(Line::new(tr(name), PlotPoints::Owned(points)).color(*color).width(1.5));
            }
        }
        for (kind, history) in motions {
            let points = thinned(history, |s| [s.time, s.ledger.total()]);
            let (name, color) = if motions.len() == 1 {
                (tr("total").to_owned(), sum)
            } else {
                (fill!("total, %{integrator}", integrator = tr(kind.id())), palette.integrator(*kind))
            };
            plot.line(Line::new(name, PlotPoints::Owned(points)).color(color).width(2.5));
        }
        time_cursor(plot, cursor, &palette);
    });
}

/// Returns the amplitude, m, of every frequency, Hz, of the probe's displacement along an axis; empty if there are too
/// few samples.
///
/// Uses a Hann window, scaled so that a sine of amplitude 1 between two bins has an amplitude of about 1.
fn spectrum(history: &History, axis: usize) -> Vec<[f64; 2]> {
    let samples = history.samples();
    let count = samples.len().min(LONGEST_SPECTRUM);
    if count < SHORTEST_SPECTRUM {
        return Vec::new();
    }
    let own = || samples.range(samples.len() - count..);
    let (Some(first), Some(last)) = (own().next(), own().next_back()) else { return Vec::new() };
    let duration = last.time - first.time;
    let mean = own().map(|s| s.displacement[axis]).sum::<f64>() / count as f64;
    let mut values: Vec<f64> = own()
        .enumerate()
        .map(|(i, s)| {
            let phase = std::f64::consts::TAU * i as f64 / (count - 1) as f64;
            (s.displacement[axis] - mean) * (1.0 - phase.cos())
        })
        .collect();
    let forward = RealFftPlanner::<f64>::new().plan_fft_forward(count);
    let mut amplitudes = forward.make_output_vec();
    if duration <= 0.0 || forward.process(&mut values, &mut amplitudes).is_err() {
        return Vec::new();
    }
    let bin = (count - 1) as f64 / (count as f64 * duration);
    let scale = 2.0 / count as f64;
    amplitudes.iter().enumerate().map(|(i, a)| [i as f64 * bin, a.norm() * scale]).collect()
}

fn spectra(
    ui: &mut Ui,
    motions: &[(IntegratorKind, &History)],
    axis: usize,
    frequency: Option<f64>,
    palette: &Palette,
) {
    /// The plot ends at the highest frequency whose amplitude exceeds this fraction of the largest one.
    const SEEN: f64 = 1e-3;
    let all: Vec<_> = motions.iter().map(|(kind, history)| (*kind, spectrum(history, axis))).collect();
    if all.iter().all(|(_, s)| s.is_empty()) {
        ui.centered_and_justified(|ui| ui.weak(fill!("A spectrum needs %{n} time steps.", n = SHORTEST_SPECTRUM)));
        return;
    }
    let largest = all.iter().flat_map(|(_, s)| s).map(|p| p[1]).fold(0.0, f64::max);
    let seen = all.iter().flat_map(|(_, s)| s).filter(|p| p[1] > SEEN * largest).map(|p| p[0]).fold(0.0, f64::max);
    let end = seen.max(3.0 * frequency.unwrap_or(0.0));
    plot(palette, "spectrum", (tr("frequency"), "Hz"), (tr("amplitude"), "m")).include_y(0.0).show(ui, |plot| {
        for (kind, spectrum) in all {
            let points: Vec<[f64; 2]> = spectrum.into_iter().take_while(|p| p[0] <= end).collect();
            let line = Line::new(tr(kind.id()), PlotPoints::from(points));
            plot.line(line.color(palette.integrator(kind)).width(1.5));
        }
        if let Some(frequency) = frequency {
            let name =
                fill!("\u{3c9}\u{2081}/2\u{3c0} about rest: %{frequency}", frequency = engineering(frequency, "Hz"));
            let color = palette.secondary;
            plot.vline(VLine::new(name, frequency).color(color).style(LineStyle::dashed_dense()));
        }
    });
}

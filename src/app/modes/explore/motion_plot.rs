//! Plots of a motion: energy by kind, displacement of the first probe over time, its phase diagram, and its spectrum.

use crate::app::view_options::MotionPlot;
use egui::{Color32, Ui, Vec2, vec2};
use egui_plot::{Line, LineStyle, PlotPoint, PlotPoints, Points, VLine};
use realfft::RealFftPlanner;

use crate::app::language::{fill, tr};
use crate::app::session::history::{History, MotionSample};
use crate::app::session::playback::Playback;
use crate::app::widgets::buttons::option_button;
use crate::app::widgets::legend;
use crate::app::widgets::palette::Palette;
use crate::app::widgets::plot::still;
use crate::format::{number, three_digits};
use crate::scene::IntegratorKind;

const PLOTS: [(MotionPlot, &str, &str); 4] = [
    (MotionPlot::Energy, "Energy", "Energy over time, by kind"),
    (MotionPlot::Tip, "Tip", "Displacement of the first probe over time"),
    (MotionPlot::Phase, "Phase", "Velocity of the first probe against its displacement"),
    (MotionPlot::Spectrum, "Spectrum", "Amplitudes of the frequencies in the motion of the first probe"),
];

/// Duration that is shown, s; more if the displayed moment is earlier.
const SHOWN: f64 = 12.0;
/// Largest number of points of a line; longer lines are thinned.
const MAX_POINTS: usize = 1000;
/// Largest number of samples of the spectrum; a power of two.
const LONGEST_SPECTRUM: usize = 4096;
/// Smallest number of samples of a spectrum.
const SHORTEST_SPECTRUM: usize = 64;

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

/// Shows the chosen plot, with the names of its lines above it; `frequency` is the lowest natural frequency, Hz.
pub(crate) fn show(
    ui: &mut Ui,
    chosen: &mut MotionPlot,
    playback: &Playback,
    integrator: IntegratorKind,
    frequency: Option<f64>,
) {
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
        MotionPlot::Phase => {
            let lines = lines(&|history| thinned(history, duration, |s| [s.displacement[axis], s.velocity[axis]]));
            LinePlot { id: "phase", axes: [(&name, "m"), (tr("velocity"), "m/s")], lines }
        }
        MotionPlot::Spectrum => {
            let mut lines =
                lines(&|history| spectrum(history, axis).into_iter().map(|[x, y]| PlotPoint::new(x, y)).collect());
            cut_spectra(&mut lines, frequency);
            LinePlot { id: "spectrum", axes: [(tr("frequency"), "Hz"), (tr("amplitude"), "m")], lines }
        }
    };
    let natural = frequency.filter(|_| *chosen == MotionPlot::Spectrum).map(|frequency| {
        let name = fill!(
            "\u{3c9}\u{2081}/2\u{3c0} about rest: %{frequency}",
            frequency = format!("{} Hz", number(three_digits(frequency)))
        );
        (frequency, name)
    });
    ui.horizontal_wrapped(|ui| {
        for (plot, word, tip) in PLOTS {
            if ui.add(option_button(*chosen == plot, tr(word))).on_hover_text(tr(tip)).clicked() {
                *chosen = plot;
            }
        }
        ui.spacing_mut().item_spacing.x = 14.0;
        let shown = drawn.lines.iter().filter(|line| !line.points.is_empty());
        let names = shown.map(|line| (line.name.as_str(), line.color));
        for (name, color) in names.chain(natural.iter().map(|(_, name)| (name.as_str(), palette.secondary))) {
            legend::entry(ui, name, SAMPLE, &|ui, sample| _ = ui.painter().rect_filled(sample, 1.0, color));
        }
    });
    if playback.history.samples().is_empty() {
        ui.centered_and_justified(|ui| ui.weak(tr("No time step yet: press Run or Step.")));
        return;
    }
    if drawn.lines.iter().all(|line| line.points.is_empty()) {
        ui.centered_and_justified(|ui| ui.weak(fill!("A spectrum needs %{n} time steps.", n = SHORTEST_SPECTRUM)));
        return;
    }
    let LinePlot { id, axes: [x, y], lines } = drawn;
    let plot = still(&palette, id, x, y);
    let plot = if *chosen == MotionPlot::Spectrum { plot.include_y(0.0) } else { plot };
    // Displayed moment, if it is not the latest.
    let cursor = playback.shown_time();
    plot.show(ui, |plot| {
        for PlotLine { name, color, width, points } in lines {
            plot.line(Line::new(name, PlotPoints::Owned(points)).color(color).width(width));
        }
        if let Some((frequency, name)) = natural {
            plot.vline(VLine::new(name, frequency).color(palette.secondary).style(LineStyle::dashed_dense()));
        }
        match (chosen, cursor) {
            (MotionPlot::Energy | MotionPlot::Tip, Some(time)) => {
                plot.vline(VLine::new("", time).color(palette.text).width(1.0));
            }
            (MotionPlot::Phase, Some(time)) => {
                if let Some(sample) = playback.history.at(time) {
                    let at = Points::new("", [sample.displacement[axis], sample.velocity[axis]]);
                    plot.points(at.color(palette.text).radius(4.0));
                }
            }
            _ => {}
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

/// Ends spectra at the highest frequency whose amplitude is visible, or at three times the lowest natural frequency, Hz.
fn cut_spectra(spectra: &mut [PlotLine], frequency: Option<f64>) {
    /// Fraction of the largest amplitude that is visible.
    const VISIBLE: f64 = 1e-3;
    let points = || spectra.iter().flat_map(|spectrum| &spectrum.points);
    let largest = points().map(|p| p.y).fold(0.0, f64::max);
    let seen = points().filter(|p| p.y > VISIBLE * largest).map(|p| p.x).fold(0.0, f64::max);
    let end = seen.max(3.0 * frequency.unwrap_or(0.0));
    spectra.iter_mut().for_each(|spectrum| spectrum.points.retain(|p| p.x <= end));
}

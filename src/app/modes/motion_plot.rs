//! Plots of a motion: energy by kind, and displacement of the first probe over time.

use egui_plot::{Line, PlotPoints, VLine};

use crate::app::interface::*;
use crate::app::session::history::{History, MotionSample};
use crate::app::view_options::MotionPlot;
use crate::app::widgets::plot::still;

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

/// Named line of a plot over time.
struct PlotLine {
    name: String,
    color: Color32,
    width: f32,
    points: Vec<[f64; 2]>,
}

impl PlotLine {
    /// Returns the line of a value in the last seconds of a motion.
    fn new(
        (name, color, width): (String, Color32, f32),
        (history, seconds): (&History, f64),
        value: impl Fn(&MotionSample) -> f64,
    ) -> Self {
        let samples: Vec<&MotionSample> = history.last(seconds).collect();
        let stride = samples.len().div_ceil(MAX_POINTS).max(1);
        let points = samples.iter().rev().step_by(stride).map(|s| [s.time, value(s)]).collect();
        Self { name, color, width, points }
    }
}

/// Shows the chosen plot, with the names of its lines above it.
pub(crate) fn show(ui: &mut Ui, chosen: &mut MotionPlot, playback: &Playback, integrator: IntegratorKind) {
    let palette = Palette::new(ui.visuals());
    let axis = playback.history.axis();
    let probe = format!("{} {}", tr(&playback.history.probe), ["x", "y"][axis]);
    let before_end = playback.shown.zip(playback.span()).map(|(shown, [_, last])| last - shown);
    let seconds = before_end.unwrap_or_default().max(SHOWN);
    let (id, y) = match chosen {
        MotionPlot::Energy => ("energy", (tr("energy"), "J")),
        MotionPlot::Tip => ("tip", (&*probe, "m")),
    };
    let lines = match chosen {
        MotionPlot::Energy => energies(&playback.history, seconds, &palette),
        MotionPlot::Tip => {
            let look = (tr(integrator.id()).to_owned(), palette.integrator(integrator), 1.5);
            vec![PlotLine::new(look, (&playback.history, seconds), |s| s.displacement[axis])]
        }
    };
    ui.horizontal_wrapped(|ui| {
        for (plot, word, tip) in PLOTS {
            if ui.add(option_button(*chosen == plot, tr(word))).on_hover_text(tr(tip)).clicked() {
                *chosen = plot;
            }
        }
        ui.spacing_mut().item_spacing.x = 14.0;
        let shown = lines.iter().filter(|line| !line.points.is_empty());
        for line in shown {
            let sample = |ui: &Ui, sample| _ = ui.painter().rect_filled(sample, 1.0, line.color);
            legend::entry(ui, &line.name, SAMPLE, &sample);
        }
    });
    if playback.history.samples.is_empty() {
        ui.centered_and_justified(|ui| ui.weak(tr("No time step yet: press Run or Step.")));
        return;
    }
    // Displayed moment, if it is not the latest.
    let cursor = playback.shown;
    still(&palette, id, (tr("time"), "s"), y).show(ui, |plot| {
        for PlotLine { name, color, width, points } in lines {
            plot.line(Line::new(name, PlotPoints::from(points)).color(color).width(width));
        }
        if let Some(time) = cursor {
            plot.vline(VLine::new("", time).color(palette.text).width(1.0));
        }
    });
}

/// Name of a kind of energy, its colour, and the function that returns its value, J.
type EnergyKind = (&'static str, Color32, fn(&MotionSample) -> f64);

/// Returns the energies of a motion by kind, and their sum. Energies that are always zero have no line.
fn energies(history: &History, seconds: f64, palette: &Palette) -> Vec<PlotLine> {
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
    let line = |name, color, width, value: fn(&MotionSample) -> f64| {
        PlotLine::new((tr(name).to_owned(), color, width), (history, seconds), value)
    };
    let parts = shown.map(|(name, color, value)| line(name, color, 1.5, value));
    parts.chain([line("total", palette.text, 2.5, |s| s.ledger.total())]).collect()
}

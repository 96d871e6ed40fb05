//! Studies as drawings: error over time with the Pareto front, both axes logarithmic.

use super::axes::{ChartAxis, ChartFrame, mark};
use super::drawing::{Anchor, DrawTarget, Drawing};
use crate::dynamics::INTEGRATORS;
use crate::format::number;
use crate::method::METHODS;
use crate::scene::{ElementKind, MethodKind};
use crate::study::figure::Ink;
use crate::study::{Measurement, Study};

/// Errors below this are drawn at it: they are rounding, or chance.
pub(crate) const SMALLEST_ERROR: f64 = 1e-3;
/// Errors above this are drawn at it: those of an iteration that diverges are off the picture.
const LARGEST_ERROR: f64 = 1e3;
const WIDTH: f64 = 1.5;
const DASHES: &[f64] = &[6.0, 4.0];

/// Draws the error of a study over its time. Each colour of the key is shown with every element.
pub fn study(study: &Study) -> Drawing {
    let moves = study.moves();
    let real_time = moves.then_some(1e3); // ms per simulated second
    let (title, names) = if moves {
        (
            "error of its path against time",
            ["computing time per simulated second, ms", "error bound of the path, % of its largest displacement"],
        )
    } else {
        ("error against time", ["time of a solve, ms", "error bound, % of the reference displacement"])
    };
    let (mut drawing, frame) = (Drawing::default(), ChartFrame::FILE);
    let chart = StudyChart::new(Some(study), |m| m.milliseconds, [real_time.as_slice(), &[]], &frame);
    drawing.page(frame.size, frame.across[0], &format!("{}: {title}", study.scene));
    chart.grid(&mut drawing, &frame, names);
    if let Some(time) = real_time {
        let ([bottom, top], at) = (frame.up, chart.axes[0].place(time));
        drawing.line(&[[at, top], [at, bottom]], Ink::Limit, WIDTH, DASHES);
        drawing.text([at, top - 6.0], Anchor::Middle, Ink::Text, "real time");
    }
    chart.draw(&mut drawing);
    key(&mut drawing, &frame, moves);
    drawing
}

/// Settings of a study by their time and their error, on logarithmic axes.
pub(crate) struct StudyChart<'a> {
    pub axes: [ChartAxis; 2],
    /// Settings whose error is known, each with its place.
    pub marks: Vec<([f64; 2], &'a Measurement)>,
}

impl<'a> StudyChart<'a> {
    /// Returns a chart around the settings, whose times, ms, `time` returns, and around these times and errors.
    pub fn new(
        study: Option<&'a Study>,
        time: fn(&Measurement) -> f64,
        usual: [&[f64]; 2],
        frame: &ChartFrame,
    ) -> Self {
        let measured = |study: &'a Study| {
            let own = study.measurements.iter().filter(|m| m.error.is_some());
            own.map(move |m| ([time(m), error(study.error_bound(m))], m))
        };
        let mut marks: Vec<_> = study.into_iter().flat_map(measured).collect();
        let values = |i: usize| marks.iter().map(move |(values, _)| values[i]).chain(usual[i].iter().copied());
        let axes = [ChartAxis::decades(values(0), frame.across), ChartAxis::decades(values(1), frame.up)];
        marks.iter_mut().for_each(|(at, _)| *at = [0, 1].map(|i| axes[i].place(at[i])));
        Self { axes, marks }
    }

    /// Returns the place of a time, ms, and an error, percent.
    #[cfg(feature = "app")]
    pub fn place(&self, [time, bound]: [f64; 2]) -> [f64; 2] {
        [self.axes[0].place(time), self.axes[1].place(error(bound))]
    }

    pub fn grid(&self, drawing: &mut dyn DrawTarget, frame: &ChartFrame, names: [&str; 2]) {
        let ticks = |axis: &ChartAxis| axis.ticks().into_iter().map(|(place, value)| (place, number(value))).collect();
        frame.grid(drawing, self.axes.each_ref().map(ticks), names);
    }

    /// Draws the Pareto front, and a mark for each setting.
    pub fn draw(&self, drawing: &mut dyn DrawTarget) {
        let mut front: Vec<_> = self.marks.iter().filter(|(_, m)| m.pareto).map(|(at, _)| *at).collect();
        front.sort_by(|a, b| a[0].total_cmp(&b[0]));
        drawing.line(&front, Ink::Text, WIDTH, &[]);
        for (at, m) in &self.marks {
            let mark = mark(*at, m.setting.element, if m.pareto { 5.5 } else { 3.5 });
            let is_faint = if m.motion.is_some() { m.setting.method == MethodKind::Linear } else { !m.converged };
            let opacity = if is_faint { 0.45 } else { 1.0 };
            drawing.polygon(&mark, Ink::of(&m.setting), opacity);
        }
    }
}

/// Moves an error into the picture.
fn error(bound: f64) -> f64 {
    bound.clamp(SMALLEST_ERROR, LARGEST_ERROR)
}

/// Draws the key: each colour with every element, and the lines.
fn key(drawing: &mut Drawing, frame: &ChartFrame, moves: bool) {
    const ROW: f64 = 22.0;
    let (x, mut y) = (frame.across[1], frame.up[1] + 10.0);
    let integrators = INTEGRATORS.iter().map(|entry| (entry.id, entry.colors)).filter(|_| moves);
    for (id, colors) in METHODS.iter().map(|entry| (entry.id, entry.colors)).filter(|_| !moves).chain(integrators) {
        for element in ElementKind::all() {
            drawing.polygon(&mark([x + 22.0, y], element, 5.0), Ink::Solution(colors), 1.0);
            drawing.text([x + 36.0, y + 4.0], Anchor::Start, Ink::Text, &format!("{} {id}", element.id()));
            y += ROW;
        }
    }
    let lines: [(&[f64], _); 2] = [(&[], "Pareto front"), (DASHES, "real time")];
    for (dashes, name) in lines.into_iter().take(1 + usize::from(moves)) {
        drawing.line(&[[x + 12.0, y], [x + 32.0, y]], Ink::Text, WIDTH, dashes);
        drawing.text([x + 36.0, y + 4.0], Anchor::Start, Ink::Text, name);
        y += ROW;
    }
    if moves {
        drawing.text([x + 36.0, y + 4.0], Anchor::Start, Ink::Text, "faint: linear theory");
    }
}

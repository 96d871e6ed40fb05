//! Studies as drawings: error over time with the Pareto front, both axes logarithmic.

use super::axes::{MARGINS, ROW, ScaledAxis, mark};
use super::drawing::{Anchor, Drawing, INK, Stroke, Text, solid};
use crate::dynamics::INTEGRATORS;
use crate::format::number;
use crate::method::METHODS;
use crate::scene::{ElementKind, MethodKind};
use crate::study::motion::REAL_TIME;
use crate::study::{Measurement, Study, StudyReference, color};

/// Errors below this are drawn at it: they are rounding, or chance.
pub const SMALLEST_ERROR: f64 = 1e-3;
/// Errors above this are drawn at it: those of an iteration that diverges are off the picture.
pub const LARGEST_ERROR: f64 = 1e3;
const WIDTH: f64 = 1.5;

const DASHED: Stroke = Stroke { width: WIDTH, dashes: &[6.0, 4.0] };

/// Draws the error of a study over its time. Each colour of the key is shown with every element.
pub fn study(study: &Study) -> Drawing {
    let moves = matches!(study.reference, StudyReference::Motion(_));
    let measured: Vec<&Measurement> = study.measurements.iter().filter(|m| m.error.is_some()).collect();
    let error = |m: &Measurement| study.error_bound(m).clamp(SMALLEST_ERROR, LARGEST_ERROR);
    let real_time = moves.then_some(REAL_TIME);
    let (title, labels) = if moves {
        (
            "error of its path against time",
            ["computing time per simulated second, ms", "error bound of the path, % of its largest displacement"],
        )
    } else {
        ("error against time", ["time of a solve, ms", "error bound, % of the reference displacement"])
    };
    let x = ScaledAxis::decades(measured.iter().map(|m| m.milliseconds).chain(real_time), MARGINS.across());
    let y = ScaledAxis::decades(measured.iter().map(|m| error(m)), MARGINS.up());
    let mut drawing = Drawing::default();
    MARGINS.start(&mut drawing, format!("{}: {title}", study.scene));
    let ticks = [&x, &y].map(|axis| axis.values().into_iter().map(|(place, value)| (place, number(value))).collect());
    MARGINS.grid(&mut drawing, ticks, labels);
    if let Some(time) = real_time {
        let ([bottom, top], at) = (MARGINS.up(), x.place(time));
        drawing.line(&[[at, top], [at, bottom]], [0x55; 3], DASHED);
        let label = Text::new([at, top - 6.0], Anchor::Middle, "real time");
        drawing.put(Text { color: INK, ..label });
    }
    let place = |m: &Measurement| [x.place(m.milliseconds), y.place(error(m))];
    drawing.line(&study.front().into_iter().map(place).collect::<Vec<_>>(), INK, solid(WIDTH));
    for m in measured {
        let mark = mark(place(m), m.setting.element, if m.pareto { 5.5 } else { 3.5 });
        let is_faint = if moves { m.setting.method == MethodKind::Linear } else { !m.converged };
        let opacity = if is_faint { 0.45 } else { 1.0 };
        drawing.polygon(&mark, color(m.setting.series(), false), opacity, &m.setting.to_string());
    }
    key(&mut drawing, moves);
    drawing
}

fn key(drawing: &mut Drawing, moves: bool) {
    let [_, right] = MARGINS.across();
    let mut row = MARGINS.top + 10.0;
    let mut add = |symbol: &dyn Fn(&mut Drawing, f64), text: &str| {
        symbol(drawing, row);
        drawing.text([right + 36.0, row + 4.0], Anchor::Start, text);
        row += ROW;
    };
    let methods = METHODS.iter().map(|entry| entry.id).filter(|_| !moves);
    for id in methods.chain(INTEGRATORS.iter().map(|entry| entry.id).filter(|_| moves)) {
        for element in ElementKind::all() {
            let symbol = |drawing: &mut Drawing, row: f64| {
                drawing.polygon(&mark([right + 22.0, row], element, 5.0), color(id, false), 1.0, "");
            };
            add(&symbol, &format!("{} {id}", element.id()));
        }
    }
    let line = |stroke| {
        move |drawing: &mut Drawing, row: f64| drawing.line(&[[right + 12.0, row], [right + 32.0, row]], INK, stroke)
    };
    add(&line(solid(WIDTH)), "Pareto front");
    if moves {
        add(&line(DASHED), "real time");
        add(&|_, _| {}, "faint: linear theory");
    }
}

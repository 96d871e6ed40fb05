//! The stability atlas as a drawing.

use super::drawing::{Anchor, Color, Drawing, DrawingItem, Text};
use crate::element::ELEMENTS;
use crate::format::number;
use crate::method::METHODS;
use crate::scene::{ElementKind, MethodKind};
use crate::study::extremes::motion::{MotionEntry, MotionOutcome, variant_text, variants};
use crate::study::extremes::{Case, CaseBody, CaseStart, Entry, FILES, Outcome, alphas};

/// Size of a cell.
const CELL: [f64; 2] = [52.0, 20.0];

/// A table of cells, each divided by how its cases ended.
struct Panel {
    title: String,
    columns: Vec<String>,
    /// Each with how many cases of each column ended how, in the order of the legend.
    rows: Vec<(String, Vec<Vec<usize>>)>,
}

/// Draws the atlas: for every element and method, load against slenderness; from rest, from the other starts,
/// with distorted cells, and on mesh files. A cell's bar is divided by how its cases ended.
pub fn atlas(entries: &[Entry]) -> Drawing {
    let columns = alphas(entries);
    let mut rows: Vec<(String, [f64; 2])> = entries.iter().map(|e| row(&e.case)).collect();
    rows.sort_by(|(_, a), (_, b)| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    rows.dedup_by(|a, b| a.0 == b.0);
    let panel = |element: ElementKind, method: MethodKind| Panel {
        title: format!("{} {}: load α = P L²/EI", element.id(), method.id()),
        columns: columns.iter().map(|&alpha| number(alpha)).collect(),
        rows: rows
            .iter()
            .map(|(label, _)| {
                let cell = |alpha: &f64| {
                    let here = entries.iter().filter(|e| {
                        let c = &e.case;
                        (c.element, c.method, c.moved, c.alpha) == (element, method, false, *alpha)
                            && row(c).0 == *label
                    });
                    let mut count = vec![0; Outcome::COUNT];
                    here.for_each(|e| count[e.outcome as usize] += 1);
                    count
                };
                (label.clone(), columns.iter().map(cell).collect())
            })
            // A mesh file has not every element.
            .filter(|(_, cells): &(String, Vec<Vec<usize>>)| cells.iter().flatten().any(|&count| count > 0))
            .collect(),
    };
    let panels = METHODS.iter().flat_map(|m| ElementKind::all().map(move |e| (e, m.kind)));
    let panels: Vec<Panel> = panels.map(|(element, method)| panel(element, method)).collect();
    draw(&Outcome::ALL.map(|o| (o.id(), color(o))), &panels)
}

/// Draws the atlas in time: for every element and integrator, time step against stiffness. A cell's bar is
/// divided by how its cases, of several weights, ended.
pub fn motion_atlas(entries: &[MotionEntry]) -> Drawing {
    let sorted = |value: fn(&MotionEntry) -> f64| {
        let mut values: Vec<f64> = entries.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    };
    let (youngs, steps) = (sorted(|e| e.case.young), sorted(|e| e.case.time_step));
    let panel = |element: ElementKind, (integrator, iterations)| Panel {
        title: format!("{} {}: E, Pa", element.id(), variant_text(integrator, iterations)),
        columns: youngs.iter().map(|&young| format!("{young:e}")).collect(),
        rows: steps
            .iter()
            .map(|&step| {
                let cell = |young: &f64| {
                    let here = entries.iter().filter(|e| {
                        let c = &e.case;
                        (c.element, c.integrator, c.iterations) == (element, integrator, iterations)
                            && c.young == *young
                            && c.time_step == step
                    });
                    let mut count = vec![0; MotionOutcome::COUNT];
                    here.for_each(|e| count[e.outcome as usize] += 1);
                    count
                };
                (format!("1/{:.0} s", 1.0 / step), youngs.iter().map(cell).collect())
            })
            .collect(),
    };
    let panels: Vec<Panel> =
        variants().flat_map(|v| ElementKind::all().map(move |e| (e, v))).map(|(e, v)| panel(e, v)).collect();
    draw(&MotionOutcome::ALL.map(|o| (o.id(), motion_color(o))), &panels)
}

/// Returns the label of a case's row, and its place among the rows; cases of one row differ in what the label does not name.
fn row(case: &Case) -> (String, [f64; 2]) {
    match (case.body, case.start) {
        (CaseBody::File(id), _) => {
            (id.to_owned(), [3.0, FILES.iter().position(|f| *f == id).unwrap_or_default() as f64])
        }
        (CaseBody::Beam, CaseStart::Rest) if case.distortion > 0.0 => {
            (format!("distorted {}", case.distortion), [2.0, case.distortion])
        }
        (CaseBody::Beam, CaseStart::Rest) => (format!("L/H {}", case.slenderness), [0.0, case.slenderness]),
        (CaseBody::Beam, start) => (start.id().to_owned(), [1.0, f64::from(start as u8)]),
    }
}

/// Draws panels, one of each element in a row.
fn draw(legend: &[(&str, Color)], panels: &[Panel]) -> Drawing {
    const MARGIN: [f64; 2] = [96.0, 64.0];
    const GAP: f64 = 56.0;
    const LEGEND: f64 = 128.0;
    let across = ELEMENTS.len();
    let columns = panels.iter().map(|p| p.columns.len()).max().unwrap_or(0);
    let rows = panels.iter().map(|p| p.rows.len()).max().unwrap_or(0);
    let panel_size = [MARGIN[0] + CELL[0] * columns as f64, GAP + CELL[1] * rows as f64];
    let mut drawing = Drawing::new([
        (20.0 + panel_size[0] * across as f64).max(LEGEND * legend.len() as f64 + 40.0),
        MARGIN[1] + panel_size[1] * panels.len().div_ceil(across) as f64,
    ]);
    for (i, (word, color)) in legend.iter().enumerate() {
        let x = 20.0 + LEGEND * i as f64;
        drawing.rect([[x, 14.0], [14.0; 2]], *color);
        text(&mut drawing, 12.0, [x + 20.0, 26.0], Anchor::Start, &word.replace('_', " "));
    }
    for (index, panel) in panels.iter().enumerate() {
        let (i, j) = (index % across, index / across);
        panel.draw(&mut drawing, legend, [MARGIN[0] + panel_size[0] * i as f64, MARGIN[1] + panel_size[1] * j as f64]);
    }
    drawing
}

impl Panel {
    fn draw(&self, drawing: &mut Drawing, legend: &[(&str, Color)], [x, y]: [f64; 2]) {
        text(drawing, 14.0, [x, y - 8.0], Anchor::Start, &self.title);
        for (row, (label, cells)) in self.rows.iter().enumerate() {
            let y = y + CELL[1] * row as f64;
            text(drawing, 12.0, [x - 6.0, y + 14.0], Anchor::End, label);
            for (column, counts) in cells.iter().enumerate() {
                let total: usize = counts.iter().sum();
                let mut left = x + CELL[0] * column as f64;
                for ((_, color), &count) in legend.iter().zip(counts) {
                    let width = (CELL[0] - 2.0) * count as f64 / total.max(1) as f64;
                    if count > 0 {
                        drawing.rect([[left, y], [width, CELL[1] - 2.0]], *color);
                    }
                    left += width;
                }
            }
        }
        for (column, label) in self.columns.iter().enumerate() {
            let at = [x + CELL[0] * (column as f64 + 0.5), y + CELL[1] * self.rows.len() as f64 + 14.0];
            text(drawing, 12.0, at, Anchor::Middle, label);
        }
    }
}

fn text(drawing: &mut Drawing, size: f64, at: [f64; 2], anchor: Anchor, content: &str) {
    drawing.items.push(DrawingItem::Text(Text { size, ..Text::new(at, anchor, content) }));
}

/// Colours that differ in brightness (Okabe and Ito 2008).
fn color(outcome: Outcome) -> Color {
    match outcome {
        Outcome::Certified => [0x00, 0x72, 0xb2],
        Outcome::Converged => [0x56, 0xb4, 0xe9],
        Outcome::Inverted => [0xf0, 0xe4, 0x42],
        Outcome::Stalled => [0xe6, 0x9f, 0x00],
        Outcome::NotConverged => [0xb0, 0x3a, 0x2e],
    }
}

/// The same.
fn motion_color(outcome: MotionOutcome) -> Color {
    match outcome {
        MotionOutcome::Finished => [0x00, 0x72, 0xb2],
        MotionOutcome::Inverted => [0xf0, 0xe4, 0x42],
        MotionOutcome::GainedEnergy => [0xe6, 0x9f, 0x00],
        MotionOutcome::Exploded => [0xb0, 0x3a, 0x2e],
        MotionOutcome::Stopped => [0x56, 0xb4, 0xe9],
    }
}

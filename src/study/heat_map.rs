//! The stability atlas as a picture.

use std::fmt::Write as _;

use super::extremes::motion::{MotionEntry, MotionOutcome, variant_words, variants};
use super::extremes::{Entry, Outcome, alphas};
use crate::element::ELEMENTS;
use crate::method::METHODS;
use crate::scene::{ElementKind, MethodKind};
use crate::words::number;

/// A table of cells, each divided by how its cases ended.
struct Panel {
    title: String,
    columns: Vec<String>,
    /// Each with how many cases of each column ended how, in the order of the legend.
    rows: Vec<(String, Vec<Vec<usize>>)>,
}

/// The atlas as a picture (SVG): for every element and method, load against slenderness; from rest, from the other starts,
/// with distorted cells, and on mesh files. A cell's bar is divided by how its cases ended.
#[must_use]
pub fn heat_map(entries: &[Entry]) -> String {
    let columns = alphas(entries);
    let mut rows: Vec<(String, [f64; 2])> = entries.iter().map(|e| e.case.row()).collect();
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
                            && c.row().0 == *label
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

/// The atlas in time as a picture (SVG): for every element and integrator, time step against stiffness. A cell's bar is
/// divided by how its cases, of several weights, ended.
#[must_use]
pub fn motion_heat_map(entries: &[MotionEntry]) -> String {
    let sorted = |value: fn(&MotionEntry) -> f64| {
        let mut values: Vec<f64> = entries.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    };
    let (youngs, steps) = (sorted(|e| e.case.young), sorted(|e| e.case.time_step));
    let panel = |element: ElementKind, (integrator, iterations)| Panel {
        title: format!("{} {}: E, Pa", element.id(), variant_words(integrator, iterations)),
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

/// Draws panels, one of each element in a row.
fn draw(legend: &[(&str, &str)], panels: &[Panel]) -> String {
    const CELL: [f64; 2] = [52.0, 20.0];
    const MARGIN: [f64; 2] = [96.0, 64.0];
    const GAP: f64 = 56.0;
    const LEGEND: f64 = 128.0;
    let across = ELEMENTS.len();
    let columns = panels.iter().map(|p| p.columns.len()).max().unwrap_or(0);
    let rows = panels.iter().map(|p| p.rows.len()).max().unwrap_or(0);
    let panel_size = [MARGIN[0] + CELL[0] * columns as f64, GAP + CELL[1] * rows as f64];
    let size = [
        (20.0 + panel_size[0] * across as f64).max(LEGEND * legend.len() as f64 + 40.0),
        MARGIN[1] + panel_size[1] * panels.len().div_ceil(across) as f64,
    ];
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" font-family=\"Ubuntu, sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        size[0], size[1]
    );
    let mut x = 20.0;
    for (word, color) in legend {
        let _ = writeln!(
            svg,
            "<rect x=\"{x}\" y=\"14\" width=\"14\" height=\"14\" fill=\"{color}\"/><text x=\"{}\" y=\"26\">{}</text>",
            x + 20.0,
            word.replace('_', " ")
        );
        x += LEGEND;
    }
    for (index, panel) in panels.iter().enumerate() {
        let (i, j) = (index % across, index / across);
        let corner = [MARGIN[0] + panel_size[0] * i as f64, MARGIN[1] + panel_size[1] * j as f64];
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{}\" font-size=\"14\">{}</text>",
            corner[0],
            corner[1] - 8.0,
            panel.title
        );
        for (row, (label, cells)) in panel.rows.iter().enumerate() {
            let y = corner[1] + CELL[1] * row as f64;
            let _ =
                writeln!(svg, "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{label}</text>", corner[0] - 6.0, y + 14.0);
            for (column, counts) in cells.iter().enumerate() {
                let total: usize = counts.iter().sum();
                let mut left = corner[0] + CELL[0] * column as f64;
                for ((_, color), &count) in legend.iter().zip(counts) {
                    let width = (CELL[0] - 2.0) * count as f64 / total.max(1) as f64;
                    if count > 0 {
                        let _ = writeln!(
                            svg,
                            "<rect x=\"{left}\" y=\"{y}\" width=\"{width}\" height=\"{}\" fill=\"{color}\"/>",
                            CELL[1] - 2.0
                        );
                    }
                    left += width;
                }
            }
        }
        for (column, label) in panel.columns.iter().enumerate() {
            let _ = writeln!(
                svg,
                "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{label}</text>",
                corner[0] + CELL[0] * (column as f64 + 0.5),
                corner[1] + CELL[1] * panel.rows.len() as f64 + 14.0
            );
        }
    }
    svg.push_str("</svg>\n");
    svg
}

/// Colours that differ in brightness (Okabe and Ito 2008).
fn color(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Certified => "#0072b2",
        Outcome::Converged => "#56b4e9",
        Outcome::Inverted => "#f0e442",
        Outcome::Stalled => "#e69f00",
        Outcome::NotConverged => "#b03a2e",
    }
}

/// The same.
fn motion_color(outcome: MotionOutcome) -> &'static str {
    match outcome {
        MotionOutcome::Finished => "#0072b2",
        MotionOutcome::Inverted => "#f0e442",
        MotionOutcome::GainedEnergy => "#e69f00",
        MotionOutcome::Exploded => "#b03a2e",
        MotionOutcome::Stopped => "#56b4e9",
    }
}

//! The stability atlas as a picture.

use std::fmt::Write as _;

use super::extremes::{Entry, Outcome, Start, alphas};
use crate::element::ELEMENTS;
use crate::method::METHODS;
use crate::scene::ElementKind;
use crate::words::number;

/// The atlas as a picture (SVG): for every element and method, load against slenderness; from rest, and from the other
/// starts. A cell's bar is divided by how its cases ended.
#[must_use]
pub fn heat_map(entries: &[Entry]) -> String {
    const CELL: [f64; 2] = [52.0, 20.0];
    const MARGIN: [f64; 2] = [96.0, 64.0];
    const GAP: f64 = 56.0;
    const LEGEND: f64 = 128.0;
    let columns = alphas(entries);
    // Rows: slenderness from rest, then the other starts.
    let mut rows: Vec<(String, Start, f64)> = entries
        .iter()
        .map(|e| match e.case.start {
            Start::Rest => (format!("L/H {}", e.case.slenderness), Start::Rest, e.case.slenderness),
            start => (start.id().to_owned(), start, e.case.slenderness),
        })
        .collect();
    rows.sort_by(|a, b| (a.1, a.2).partial_cmp(&(b.1, b.2)).unwrap_or(std::cmp::Ordering::Equal));
    rows.dedup_by(|a, b| a.0 == b.0);
    let panel = [MARGIN[0] + CELL[0] * columns.len() as f64, GAP + CELL[1] * rows.len() as f64];
    let size = [
        (20.0 + panel[0] * ELEMENTS.len() as f64).max(LEGEND * Outcome::COUNT as f64 + 40.0),
        MARGIN[1] + panel[1] * METHODS.len() as f64,
    ];
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" font-family=\"Ubuntu, sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        size[0], size[1]
    );
    let mut x = 20.0;
    for outcome in Outcome::ALL {
        let _ = writeln!(
            svg,
            "<rect x=\"{x}\" y=\"14\" width=\"14\" height=\"14\" fill=\"{}\"/><text x=\"{}\" y=\"26\">{}</text>",
            color(outcome),
            x + 20.0,
            outcome.id().replace('_', " ")
        );
        x += LEGEND;
    }
    for (i, element) in ElementKind::all().enumerate() {
        for (j, method) in METHODS.iter().enumerate() {
            let corner = [MARGIN[0] + panel[0] * i as f64, MARGIN[1] + panel[1] * j as f64];
            let _ = writeln!(
                svg,
                "<text x=\"{}\" y=\"{}\" font-size=\"14\">{} {}: load α = P L²/EI</text>",
                corner[0],
                corner[1] - 8.0,
                element.id(),
                method.kind.id()
            );
            for (row, (label, start, slenderness)) in rows.iter().enumerate() {
                let y = corner[1] + CELL[1] * row as f64;
                let _ = writeln!(
                    svg,
                    "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{label}</text>",
                    corner[0] - 6.0,
                    y + 14.0
                );
                for (column, &alpha) in columns.iter().enumerate() {
                    let here = entries.iter().filter(|e| {
                        let c = &e.case;
                        (c.element, c.method, c.start) == (element, method.kind, *start)
                            && c.alpha == alpha
                            && c.slenderness == *slenderness
                    });
                    let mut count = [0usize; Outcome::COUNT];
                    here.for_each(|e| count[e.outcome as usize] += 1);
                    let total: usize = count.iter().sum();
                    let mut left = corner[0] + CELL[0] * column as f64;
                    for (outcome, count) in Outcome::ALL.into_iter().zip(count) {
                        let width = (CELL[0] - 2.0) * count as f64 / total.max(1) as f64;
                        if count > 0 {
                            let _ = writeln!(
                                svg,
                                "<rect x=\"{left}\" y=\"{y}\" width=\"{width}\" height=\"{}\" fill=\"{}\"/>",
                                CELL[1] - 2.0,
                                color(outcome)
                            );
                        }
                        left += width;
                    }
                }
            }
            for (column, alpha) in columns.iter().enumerate() {
                let _ = writeln!(
                    svg,
                    "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                    corner[0] + CELL[0] * (column as f64 + 0.5),
                    corner[1] + CELL[1] * rows.len() as f64 + 14.0,
                    number(*alpha)
                );
            }
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

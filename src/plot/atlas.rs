//! A stability atlas as a drawing.

use super::drawing::{Anchor, DrawTarget, Drawing};
use crate::scene::ElementKind;
use crate::study::extremes::{Case, Entry, Outcome, counts, labels};
use crate::study::figure::Ink;

const CELL: [f64; 2] = [52.0, 20.0];

/// Draws an atlas: a panel for every element and method or integrator, one of each element in a row. A cell's bar is
/// divided by how its cases ended.
pub fn atlas<C: Case>(entries: &[Entry<C>]) -> Drawing {
    const MARGIN: [f64; 2] = [96.0, 64.0];
    const GAP: f64 = 56.0;
    /// Smallest width, which the key needs.
    const LEGEND: f64 = 680.0;
    let names = labels(entries, |case| Some(case.series().1));
    let [rows, columns] = [0, 1].map(|axis| labels(entries, |case| Some(case.cell()?[axis].clone())));
    let counts = counts(entries, |case| Some((case.series(), case.cell()?)));
    let panel_size = [MARGIN[0] + CELL[0] * columns.len() as f64, GAP + CELL[1] * rows.len() as f64];
    let mut drawing = Drawing::default();
    let width = (20.0 + panel_size[0] * ElementKind::all().count() as f64).max(LEGEND);
    drawing.page([width, MARGIN[1] + panel_size[1] * names.len() as f64], 0.0, "");
    let mut x = 20.0;
    for (id, color) in C::OUTCOMES.map(Outcome::entry) {
        x = drawing.key([x, 14.0], (Ink::Fixed(color), &id.replace('_', " ")));
    }
    for (j, name) in names.iter().enumerate() {
        for (i, element) in ElementKind::all().enumerate() {
            let [x, mut y] = [MARGIN[0] + panel_size[0] * i as f64, MARGIN[1] + panel_size[1] * j as f64];
            let title = format!("{} {name}: {}", element.id(), C::COLUMNS);
            drawing.text([x, y - 8.0], Anchor::Start, Ink::Text, &title);
            for row in &rows {
                let key = |column: &String| ((element.id(), name.clone()), [row.clone(), column.clone()]);
                let cells: Vec<_> = columns.iter().map(|column| counts.get(&key(column))).collect();
                // A mesh file has not every element.
                if cells.iter().all(Option::is_none) {
                    continue;
                }
                drawing.text([x - 6.0, y + 14.0], Anchor::End, Ink::Text, row);
                for (column, counts) in cells.into_iter().enumerate().filter_map(|(i, counts)| Some((i, counts?))) {
                    // The cell is divided by the counts of outcomes.
                    let (total, mut left) = (counts.iter().sum::<usize>(), x + CELL[0] * column as f64);
                    for (outcome, &count) in C::OUTCOMES.into_iter().zip(counts).filter(|(_, count)| **count > 0) {
                        let width = (CELL[0] - 2.0) * count as f64 / total as f64;
                        drawing.rect([[left, y], [width, CELL[1] - 2.0]], Ink::Fixed(outcome.entry().1), 1.0);
                        left += width;
                    }
                }
                y += CELL[1];
            }
            for (column, label) in columns.iter().enumerate() {
                drawing.text([x + CELL[0] * (column as f64 + 0.5), y + 14.0], Anchor::Middle, Ink::Text, label);
            }
        }
    }
    drawing
}

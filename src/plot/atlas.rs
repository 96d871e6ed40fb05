//! A stability atlas as a drawing.

use super::drawing::{Anchor, DrawTarget, Drawing};
use crate::scene::ElementKind;
use crate::study::extremes::{Atlas, distinct};
use crate::study::figure::Ink;

const CELL: [f64; 2] = [52.0, 20.0];

/// Draws an atlas: a panel for every element and method or integrator, one of each element in a row. A cell's bar is
/// divided by how its cases ended.
pub fn atlas(atlas: &Atlas) -> Drawing {
    const MARGIN: [f64; 2] = [104.0, 64.0];
    const GAP: f64 = 56.0;
    /// Smallest width, which the key needs.
    const LEGEND: f64 = 680.0;
    let names = distinct(atlas.entries.iter().map(|entry| &entry.name));
    let rows = distinct(atlas.entries.iter().filter_map(|entry| entry.row.as_ref())).len();
    let columns = distinct(atlas.entries.iter().map(|entry| &entry.column));
    let panel_size = [MARGIN[0] + CELL[0] * columns.len() as f64, GAP + CELL[1] * rows as f64];
    let mut drawing = Drawing::default();
    let width = (60.0 + panel_size[0] * ElementKind::all().count() as f64).max(LEGEND);
    drawing.page([width, MARGIN[1] + panel_size[1] * names.len() as f64], 0.0, "");
    let mut x = 20.0;
    for (id, color) in atlas.outcomes.iter().map(|outcome| outcome.entry()) {
        x = drawing.key([x, 14.0], (Ink::Fixed(color), &id.replace('_', " ")));
    }
    for (j, &name) in names.iter().enumerate() {
        for (i, element) in ElementKind::all().enumerate() {
            let [x, mut y] = [MARGIN[0] + panel_size[0] * i as f64, MARGIN[1] + panel_size[1] * j as f64];
            let (panel, title) = (atlas.of(element, name), format!("{} {name}: {}", element.id(), atlas.columns));
            drawing.text([x, y - 8.0], Anchor::Start, Ink::Text, &title);
            // A mesh file has not every element.
            for row in distinct(panel.iter().filter_map(|entry| entry.row.as_ref())) {
                drawing.text([x - 6.0, y + 14.0], Anchor::End, Ink::Text, row);
                for (i, &column) in columns.iter().enumerate() {
                    let cell = panel.iter().filter(|e| (e.row.as_ref(), &e.column) == (Some(row), column));
                    let (total, mut left) = (cell.clone().count(), x + CELL[0] * i as f64);
                    for outcome in atlas.outcomes {
                        let count = cell.clone().filter(|entry| entry.outcome == *outcome).count();
                        if count > 0 {
                            let width = (CELL[0] - 2.0) * count as f64 / total as f64;
                            drawing.rect([[left, y], [width, CELL[1] - 2.0]], Ink::Fixed(outcome.entry().1), 1.0);
                            left += width;
                        }
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

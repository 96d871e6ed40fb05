//! Plots that cannot be dragged or zoomed, with round ticks and values in engineering units.

use egui_plot::{AxisHints, GridInput, GridMark, HoverPosition, MarkerShape, Plot};

use crate::app::widgets::palette::Palette;
use crate::element::ELEMENTS;
use crate::format::{engineering, three_digits, tick, ticks};
use crate::scene::ElementKind;

/// Space for the tick labels and the title of an axis, points, before egui_plot has measured them.
pub(crate) const X_AXIS: f32 = 38.0;

pub(crate) const Y_AXIS: f32 = 68.0;

/// Grid lines closer together than this, points, are not drawn.
const NEAREST: f32 = 8.0;

/// Smallest distances between tick labels, points: horizontal and vertical.
const APART: [f32; 2] = [66.0, 26.0];

/// Fraction of the x axis, from either end, in which a tick label would overlap the labels of the y axis or be cut.
const CORNER: f64 = 0.02;

pub(crate) fn fixed<'a>(id: &str, palette: &Palette) -> Plot<'a> {
    Plot::new(id.to_owned())
        .grid_color(palette.line)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
}

/// Returns a plot that cannot be dragged or zoomed, with round ticks and values in engineering units.
pub(crate) fn still<'a>(palette: &Palette, id: &str, x: (&str, &'static str), y: (&str, &'static str)) -> Plot<'a> {
    /// Formats a value between ticks with three digits.
    fn value(value: f64, unit: &str) -> String {
        engineering(three_digits(value), unit)
    }
    let ((x_name, x_unit), (y_name, y_unit)) = (x, y);
    // The distance between ticks depends on the width of their labels.
    let near = egui::Rangef::new(0.5 * APART[0], 0.75 * APART[0]);
    let x_axis = AxisHints::new_x().label(x_name.to_owned()).label_spacing(near).min_thickness(X_AXIS).formatter(
        move |mark, range| {
            // In the corner the label of the y axis has priority; at the end there is room for half of a label only.
            let distance = (mark.value - range.start()).min(range.end() - mark.value);
            if distance < CORNER * (range.end() - range.start()) {
                String::new()
            } else {
                tick(mark.value, [*range.start(), *range.end()], x_unit)
            }
        },
    );
    let y_axis = AxisHints::new_y().label(y_name.to_owned()).min_thickness(Y_AXIS);
    fixed(id, palette)
        .custom_x_axes(vec![x_axis])
        .custom_y_axes(vec![
            y_axis.formatter(move |mark, range| tick(mark.value, [*range.start(), *range.end()], y_unit)),
        ])
        .x_grid_spacer(|input| round_marks(input, APART[0]))
        .y_grid_spacer(|input| round_marks(input, APART[1]))
        .label_formatter(move |at| match at {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                Some(format!("{plot_name}\n{}, {}", value(position.x, x_unit), value(position.y, y_unit)))
            }
            HoverPosition::Elsewhere { .. } => None,
        })
        .grid_spacing(egui::Rangef::new(NEAREST, APART[1]))
}

/// Returns ticks at multiples of 1, 2 or 5 · 10ⁿ, as many as have room for their labels.
fn round_marks(input: GridInput, apart: f32) -> Vec<GridMark> {
    const MAX_TICKS: f64 = 9.0;
    let (low, high) = input.bounds;
    let room = (high - low) / input.base_step_size * f64::from(NEAREST / apart);
    let ticks = ticks(low, high, room.clamp(2.0, MAX_TICKS) as u32);
    let step_size = ticks.windows(2).next().map_or(high - low, |pair| pair[1] - pair[0]);
    ticks.into_iter().map(|value| GridMark { value, step_size }).collect()
}

/// Splits a line into its segments. As one thick line its joints would stick out at sharp corners.
pub(crate) fn segments(line: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    line.windows(2).map(<[_]>::to_vec).collect()
}

/// Returns the marker of an element and the marker's name; markers follow the order of the element registry.
pub(crate) fn marker(element: ElementKind) -> (MarkerShape, &'static str) {
    const SHAPES: [(MarkerShape, &str); 4] = [
        (MarkerShape::Up, "triangles"),
        (MarkerShape::Circle, "circles"),
        (MarkerShape::Square, "squares"),
        (MarkerShape::Diamond, "diamonds"),
    ];
    let number = ELEMENTS.iter().position(|e| e.kind == element).unwrap_or_default();
    SHAPES[number % SHAPES.len()]
}

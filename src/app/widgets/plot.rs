//! Plots that stand still, with round ticks and values in engineering units.

use egui_plot::{AxisHints, GridInput, GridMark, HoverPosition, MarkerShape, Plot};

use crate::app::widgets::palette::Palette;
use crate::element::ELEMENTS;
use crate::scene::ElementKind;
use crate::words::{engineering, three_digits, ticks};

/// Room for the numbers and the title of an axis, points, before egui_plot has measured them.
pub(crate) const X_AXIS: f32 = 38.0;

pub(crate) const Y_AXIS: f32 = 68.0;

/// Grid lines nearer to each other than this, points, are not drawn.
const NEAREST: f32 = 8.0;

/// Numbers so far apart, points, have room: beside each other, and over each other.
const APART: [f32; 2] = [66.0, 26.0];

/// The part of an axis, from its beginning, over which its numbers would touch those of the other axis.
const CORNER: f64 = 0.02;

/// A plot that stands still, with round ticks and values in engineering units.
pub(crate) fn still<'a>(palette: &Palette, id: &str, x: (&str, &'static str), y: (&str, &'static str)) -> Plot<'a> {
    /// A value between ticks, to three digits.
    fn value(value: f64, unit: &str) -> String {
        engineering(three_digits(value), unit)
    }
    let ((x_name, x_unit), (y_name, y_unit)) = (x, y);
    // The marks are as far apart as their numbers need.
    let near = egui::Rangef::new(0.5 * APART[0], 0.75 * APART[0]);
    let x_axis = AxisHints::new_x().label(x_name.to_owned()).label_spacing(near).min_thickness(X_AXIS).formatter(
        move |mark, range| {
            // In the corner stands the number of the other axis.
            let in_corner = mark.value - range.start() < CORNER * (range.end() - range.start());
            if in_corner { String::new() } else { engineering(mark.value, x_unit) }
        },
    );
    let y_axis = AxisHints::new_y().label(y_name.to_owned()).min_thickness(Y_AXIS);
    Plot::new(id.to_owned())
        .custom_x_axes(vec![x_axis])
        .custom_y_axes(vec![y_axis.formatter(move |mark, _| engineering(mark.value, y_unit))])
        .x_grid_spacer(|input| round_marks(input, APART[0]))
        .y_grid_spacer(|input| round_marks(input, APART[1]))
        .label_formatter(move |at| match at {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                Some(format!("{plot_name}\n{}, {}", value(position.x, x_unit), value(position.y, y_unit)))
            }
            HoverPosition::Elsewhere { .. } => None,
        })
        .grid_color(palette.line)
        .grid_spacing(egui::Rangef::new(NEAREST, APART[1]))
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
}

/// Marks 1, 2 or 5 · 10ⁿ apart, as many as have room for their numbers.
fn round_marks(input: GridInput, apart: f32) -> Vec<GridMark> {
    const MOST: f64 = 9.0;
    let (low, high) = input.bounds;
    let room = (high - low) / input.base_step_size * f64::from(NEAREST / apart);
    let ticks = ticks(low, high, room.clamp(2.0, MOST) as u32);
    let step_size = ticks.windows(2).next().map_or(high - low, |pair| pair[1] - pair[0]);
    ticks.into_iter().map(|value| GridMark { value, step_size }).collect()
}

/// The pieces of a line: joints of one thick line would stick out where it turns sharply.
pub(crate) fn segments(line: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    line.windows(2).map(<[_]>::to_vec).collect()
}

/// The mark of an element and its name: the first for the first of the registry.
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

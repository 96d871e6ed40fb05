//! A row of the panel: label, slider, number. Values out of range are refused with a message under the row.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use egui::{DragValue, Slider, SliderClamping, Ui};
use thiserror::Error;

use super::format;
use crate::scene::OutOfRange;
use crate::scene::limits::Limit;
use crate::words::number;

/// Messages next to fields, by the field's label.
pub(super) type Messages = BTreeMap<&'static str, String>;

/// A number to show and edit.
pub(super) struct NumberField {
    /// What it is called; unique in the panel.
    pub label: &'static str,
    /// What it does.
    pub tooltip: &'static str,
    /// What is accepted.
    pub limit: Limit,
    /// What the slider spans. Typed values may lie outside, within the limit.
    pub slider: RangeInclusive<f64>,
    /// Logarithmic, with the smallest value above zero that the slider can give.
    pub logarithmic: Option<f64>,
    /// Whole numbers only.
    pub whole: bool,
}

/// Why a typed number is refused.
#[derive(Debug, Error)]
enum FieldError {
    #[error("expected a whole number, got {0}")]
    NotWhole(String),
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
}

const LABEL_WIDTH: f32 = 78.0;
const VALUE_WIDTH: f32 = 104.0;

impl NumberField {
    /// Shows the row; returns a new value that is within the limit, once there is one.
    pub(super) fn show(&self, ui: &mut Ui, messages: &mut Messages, value: f64) -> Option<f64> {
        let mut edited = None;
        let unparsed = RefCell::new(None);
        ui.horizontal(|ui| {
            let label = ui
                .scope(|ui| {
                    ui.set_min_width(LABEL_WIDTH);
                    ui.set_max_width(LABEL_WIDTH);
                    ui.label(self.label)
                })
                .inner
                .on_hover_text(self.tooltip);
            let spacing = ui.spacing().item_spacing.x;
            ui.spacing_mut().slider_width = (ui.available_width() - VALUE_WIDTH - spacing).max(40.0);

            let mut slid = value;
            let mut slider =
                Slider::new(&mut slid, self.slider.clone()).clamping(SliderClamping::Never).show_value(false);
            if let Some(smallest) = self.logarithmic {
                slider = slider.logarithmic(true).smallest_positive(smallest);
            }
            let response = ui.add(slider).labelled_by(label.id).on_hover_text(self.tooltip);
            if response.changed() {
                edited = Some(if self.whole { slid.round() } else { format::round_to_slider(slid) });
            }

            let mut typed = value;
            let suffix = if self.limit.unit.is_empty() { String::new() } else { format!(" {}", self.limit.unit) };
            let drag = DragValue::new(&mut typed)
                .speed(if self.whole { 0.1 } else { 0.005 * value.abs().max(*self.slider.end() * 1e-3) })
                .suffix(suffix)
                .update_while_editing(false)
                .custom_formatter(|v, _| format::editable(v))
                .custom_parser(|text| {
                    let parsed = format::parse(text, self.limit.unit).filter(|v| v.is_finite());
                    if parsed.is_none() {
                        *unparsed.borrow_mut() = Some(text.trim().to_owned());
                    }
                    parsed
                });
            let size = egui::vec2(VALUE_WIDTH, ui.spacing().interact_size.y);
            let response = ui.add_sized(size, drag).labelled_by(label.id).on_hover_text(self.tooltip);
            if response.changed() {
                edited = Some(if response.dragged() { format::round_to_slider(typed) } else { typed });
            }
        });
        let accepted = match (unparsed.into_inner(), edited) {
            (Some(text), _) => {
                messages.insert(self.label, self.limit.expected(&format!("\u{201c}{text}\u{201d}")).to_string());
                None
            }
            (None, Some(new)) => match self.check(new) {
                Ok(()) => {
                    messages.remove(self.label);
                    Some(new)
                }
                Err(error) => {
                    messages.insert(self.label, error.to_string());
                    None
                }
            },
            (None, None) => None,
        };
        show_message(ui, messages, self.label);
        accepted.filter(|&new| new != value)
    }

    fn check(&self, value: f64) -> Result<(), FieldError> {
        if self.whole && value.fract() != 0.0 {
            return Err(FieldError::NotWhole(number(value)));
        }
        Ok(self.limit.check(value)?)
    }
}

/// The message of a field, if it has one.
pub(super) fn show_message(ui: &mut Ui, messages: &Messages, label: &str) {
    if let Some(message) = messages.get(label) {
        let color = ui.visuals().error_fg_color;
        ui.add(egui::Label::new(egui::RichText::new(message).color(color).small()).wrap());
    }
}

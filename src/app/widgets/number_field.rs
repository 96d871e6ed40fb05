//! Row of the panel with label, slider and number. Values out of range are refused with a message under the row.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use egui::text_edit::TextEditState;
use egui::{DragValue, Id, Key, Layout, PointerButton, Rect, Response, Slider, SliderClamping, Stroke, Ui};

use crate::app::prelude::*;
use crate::app::widgets::load_scale::LoadScale;
use crate::app::widgets::palette::Palette;
use crate::format::{editable, number, three_digits};
use crate::scene::limits::Limit;
use crate::scene::units::{self, UnitError};

/// Messages next to fields, by the field's label.
pub(crate) type Messages = BTreeMap<&'static str, Sentence>;

pub(crate) struct NumberField {
    /// Label; unique in the panel.
    pub label: &'static str,
    tooltip: &'static str,
    limit: Limit,
    /// Range of the slider. Typed values may lie outside it, but within the limit.
    slider: RangeInclusive<f64>,
    scale: SliderScale,
    /// `true` if only whole numbers are accepted.
    whole: bool,
}

/// Relation between the values of a slider and the positions on it.
enum SliderScale {
    Linear,
    Logarithmic(f64),
    Around(f64),
}

/// Field of a number of the scene.
pub(crate) struct NumberRow {
    pub field: NumberField,
    pub get: fn(&Scene) -> f64,
    pub set: fn(&mut Scene, f64),
}

const VALUE_WIDTH: f32 = 104.0;

impl NumberField {
    /// Returns a field of any number within the limit, with a slider that is proportional to it.
    pub(crate) const fn new(label: &'static str, limit: Limit, slider: RangeInclusive<f64>) -> Self {
        Self { label, tooltip: "", limit, slider, scale: SliderScale::Linear, whole: false }
    }

    pub(crate) const fn tip(mut self, tooltip: &'static str) -> Self {
        self.tooltip = tooltip;
        self
    }

    /// Makes the slider logarithmic above this smallest positive value, and symmetric about zero.
    pub(crate) const fn logarithmic(mut self, smallest: f64) -> Self {
        self.scale = SliderScale::Logarithmic(smallest);
        self
    }

    /// Makes the slider proportional around this value, and logarithmic far beyond it: [`LoadScale`].
    pub(crate) const fn around(mut self, usual: f64) -> Self {
        self.scale = SliderScale::Around(usual);
        self
    }

    pub(crate) const fn whole(mut self) -> Self {
        self.whole = true;
        self
    }

    pub(crate) const fn row(self, get: fn(&Scene) -> f64, set: fn(&mut Scene, f64)) -> NumberRow {
        NumberRow { field: self, get, set }
    }

    /// Shows the row; returns the new value when the user has entered one within the limit. A double click, or Delete on
    /// the slider, restores the original, if there is one.
    pub(crate) fn show(&self, ui: &mut Ui, messages: &mut Messages, value: f64, original: Option<f64>) -> Option<f64> {
        let mut edited = None;
        let (mut is_reset, mut is_committed) = (false, false);
        let tip = self.full_tip(original);
        let refused = RefCell::new(None);
        let unit = self.limit.unit;
        let first = FirstText::of(ui, Id::unique((self.label, "shown")), editable(value, unit));
        // In the frame after Escape egui reads the typed text once more.
        let escape_id = Id::unique((self.label, "escape"));
        let has_escaped = ui.data_mut(|data| data.remove_temp::<bool>(escape_id)).is_some();
        let label = ui
            .horizontal(|ui| {
                let label = ui.label(tr(self.label)).on_hover_text(tr(self.tooltip));
                ui.with_layout(Layout::right_to_left(egui::Align::Center), |ui| {
                    let mut typed = value;
                    let drag = DragValue::new(&mut typed)
                        .speed(if self.whole { 0.1 } else { 0.005 * value.abs().max(*self.slider.end() * 1e-3) })
                        .update_while_editing(false)
                        .custom_formatter(|v, _| editable(v, unit))
                        .custom_parser(|text| {
                            // The text is unchanged, so the value keeps the digits that are not shown.
                            if has_escaped || text.trim() == first.text {
                                return Some(value);
                            }
                            let number = read(text, &first.text, self.limit).and_then(|number| self.check(number));
                            number.map_err(|reason| refused.replace(Some(reason))).ok()
                        });
                    let size = egui::vec2(VALUE_WIDTH.min(ui.available_width()), ui.spacing().interact_size.y);
                    let response = ui.add_sized(size, drag).labelled_by(label.id);
                    first.keep(ui, &response);
                    if response.gained_focus()
                        && let Some(mut text) = TextEditState::load(ui.ctx(), response.id)
                    {
                        // Undo in the field ends at the text that the edit begins with.
                        text.clear_undoer();
                        text.store(ui.ctx(), response.id);
                    }
                    if response.changed() {
                        edited = Some(if response.dragged() { three_digits(typed) } else { typed });
                    }
                    if ui.input(|i| i.key_pressed(Key::Escape)) {
                        ui.data_mut(|data| data.insert_temp(escape_id, true));
                        messages.remove(self.label);
                    } else if refused.borrow().is_some() && ui.input(|i| i.key_pressed(Key::Enter)) {
                        // A refused text stays in the field, which keeps the focus, so that it can be corrected.
                        ui.memory_mut(|memory| memory.request_focus(response.id));
                    }
                    is_committed = response.lost_focus();
                    if response.double_clicked() && original.is_some() {
                        is_reset = true;
                        // The first click of the double click has started editing the text.
                        ui.memory_mut(|memory| memory.surrender_focus(response.id));
                    }
                    quiet_tip(response, &tip);
                });
                label
            })
            .inner;
        ui.spacing_mut().slider_width = ui.available_width();
        let (response, slid) = self.show_slider(ui, value);
        let (slider, response) = (response.rect, response.labelled_by(label.id));
        if response.has_focus() && !response.dragged() {
            edited = self.stepped(ui, value).or(edited);
        } else if response.changed() {
            edited = Some(if self.whole { slid.round() } else { three_digits(slid) });
        }
        if response.has_focus() {
            // The handle alone shows the focus too faintly.
            let accent = Palette::new(ui.visuals()).accent;
            ui.painter().rect_stroke(slider.expand(2.0), 4.0, Stroke::new(1.5, accent), egui::StrokeKind::Outside);
        }
        is_reset |= is_reset_by(ui, &response);
        quiet_tip(response, &tip);
        if let (true, Some(original)) = (is_reset, original) {
            refused.replace(None);
            edited = Some(original);
        }
        let entered = self.entered(ui, messages, refused.into_inner(), edited, is_committed);
        if messages.contains_key(self.label) {
            show_over_slider(ui, messages, self.label, slider);
        }
        entered.filter(|&new| new != value)
    }

    /// Returns the edited value if it is within the limit, and sets or removes the message of the field. A text may have been
    /// refused, or committed.
    fn entered(
        &self,
        ui: &Ui,
        messages: &mut Messages,
        refused: Option<Sentence>,
        edited: Option<f64>,
        is_committed: bool,
    ) -> Option<f64> {
        let refused_id = Id::unique((self.label, "refused"));
        let is_settled = refused.is_none() && (is_committed || edited.is_some());
        let was_refused = is_settled && ui.data_mut(|data| data.remove_temp::<()>(refused_id)).is_some();
        let entered = match refused {
            Some(reason) => {
                ui.data_mut(|data| data.insert_temp(refused_id, ()));
                Err(reason)
            }
            None => edited.map(|new| self.check(new)).transpose(),
        };
        match &entered {
            Err(reason) => _ = messages.insert(self.label, reason.clone()),
            // The present value may have been typed in place of a refused text.
            Ok(new) if new.is_some() || was_refused => _ = messages.remove(self.label),
            Ok(_) => {}
        }
        entered.ok().flatten()
    }

    /// Shows the slider; returns the value that it is moved to.
    fn show_slider(&self, ui: &mut Ui, value: f64) -> (Response, f64) {
        let mut slid = value;
        let shown = |ui: &mut Ui, slider: Slider<'_>| ui.add(slider.clamping(SliderClamping::Never).show_value(false));
        let (low, high) = (*self.slider.start(), *self.slider.end());
        let response = match self.scale {
            SliderScale::Linear => shown(ui, Slider::new(&mut slid, low..=high)),
            SliderScale::Logarithmic(smallest) => {
                shown(ui, Slider::new(&mut slid, low..=high).logarithmic(true).smallest_positive(smallest))
            }
            SliderScale::Around(usual) => {
                let scale = LoadScale::slider(usual, high, low < 0.0);
                let start = if low < 0.0 { -1.0 } else { 0.0 };
                let mut place = scale.length(value.abs()).copysign(value);
                let response = shown(ui, Slider::new(&mut place, start..=1.0));
                // Screen readers read the value instead of the position on the slider.
                ui.ctx().accesskit_node_builder(response.id, |node| {
                    node.set_numeric_value(value);
                    node.set_min_numeric_value(low);
                    node.set_max_numeric_value(high);
                });
                if response.changed() {
                    slid = scale.load(place.abs()).copysign(place).clamp(low.min(value), high.max(value));
                }
                response
            }
        };
        (response, slid)
    }

    /// Returns the whole tooltip: the description, and how to restore the original.
    fn full_tip(&self, original: Option<f64>) -> String {
        let tip = tr(self.tooltip);
        let Some(original) = original else { return tip.to_owned() };
        let value = editable(original, self.limit.unit);
        let back = fill!("Double click, or Delete on the slider: %{value}, as in the scene.", value);
        format!("{tip}\n{back}")
    }

    /// Returns the value after the arrow keys pressed in this frame. A step is 1 for whole numbers, one 360th of a
    /// linear range, and otherwise 1 % of the value.
    fn stepped(&self, ui: &Ui, value: f64) -> Option<f64> {
        let pressed = |key| ui.input(|i| i.num_presses(key)) as f64;
        let steps = pressed(Key::ArrowRight) - pressed(Key::ArrowLeft);
        if steps == 0.0 {
            return None;
        }
        let (low, high) = (*self.slider.start(), *self.slider.end());
        let step = match self.scale {
            _ if self.whole => 1.0,
            SliderScale::Logarithmic(smallest) => (0.01 * value.abs()).max(smallest),
            SliderScale::Around(usual) => (0.01 * value.abs()).max(0.001 * usual),
            SliderScale::Linear => (high - low) / 360.0,
        };
        let stepped = (value + steps * step).clamp(low.min(value), high.max(value));
        Some(if self.whole { stepped } else { three_digits(stepped) })
    }

    fn check(&self, value: f64) -> Result<f64, Sentence> {
        if self.whole && value.fract() != 0.0 {
            return Err(sentence!("expected a whole number, got %{got}", got = number(value)));
        }
        self.limit.check(value).map(|()| value)
    }
}

/// Text of a number when its edit began. While it is committed the field may show another unit.
pub(crate) struct FirstText {
    id: Id,
    shown: String,
    pub text: String,
}

impl FirstText {
    /// Returns the text for a field that now shows `shown`; `id` is the place where it is kept.
    pub(crate) fn of(ui: &Ui, id: Id, shown: String) -> Self {
        let text = ui.data(|data| data.get_temp(id)).unwrap_or_else(|| shown.clone());
        Self { id, shown, text }
    }

    /// Keeps the shown text if an edit begins.
    pub(crate) fn keep(&self, ui: &Ui, field: &Response) {
        if field.gained_focus() {
            ui.data_mut(|data| data.insert_temp(self.id, self.shown.clone()));
        }
    }
}

/// Reads a number within a limit: `2.5`, `1e4`, `12 kN`, `30 000`; one without a unit has that of the text `shown` before. The
/// error says what was expected.
pub(crate) fn read(text: &str, shown: &str, limit: Limit) -> Result<f64, Sentence> {
    let is_bare = text.trim_end().ends_with(|last: char| last.is_ascii_digit() || last == '.');
    let unit = shown.split_once(' ').map_or("", |(_, unit)| unit);
    let typed = if is_bare && text.trim() != shown { format!("{} {unit}", text.trim()) } else { text.to_owned() };
    // A prefix without a unit belongs to the field's unit: `3k` is 3 kN.
    let parse = |text: &str| units::parse(text, limit.unit);
    match parse(&typed).or_else(|error| parse(&format!("{}{}", typed.trim(), limit.unit)).map_err(|_| error)) {
        Ok(number) if number.is_finite() => limit.check(number).map(|()| number),
        Ok(_) | Err(UnitError { has_number: false, .. }) => {
            let (example, got) = (editable(12.0, limit.unit), text.trim());
            Err(sentence!("expected a number, such as %{example}, got \u{201c}%{got}\u{201d}", example, got))
        }
        Err(error) => Err(error.message),
    }
}

/// Shows the message of a field, if it has one.
pub(crate) fn show_message(ui: &mut Ui, messages: &Messages, label: &str) {
    if let Some(message) = messages.get(label) {
        let color = ui.visuals().error_fg_color;
        ui.add(egui::Label::new(egui::RichText::new(said(message)).color(color).small()).wrap());
    }
}

/// Shows the message of a field over its slider, so that it does not move the rows below.
fn show_over_slider(ui: &mut Ui, messages: &Messages, label: &str, slider: Rect) {
    /// Space above and below the slider that belongs to the field, points: two lines of the message have room.
    const ABOVE: f32 = 5.0;
    const BELOW: f32 = 7.0;
    let place = Rect::from_x_y_ranges(slider.x_range(), slider.top() - ABOVE..=slider.bottom() + BELOW);
    let mut over = ui.new_child(egui::UiBuilder::new().max_rect(place));
    over.painter().rect_filled(place, 0.0, over.visuals().panel_fill);
    show_message(&mut over, messages, label);
}

/// Returns `true` if a slider was double-clicked, or has the focus while Delete or Backspace is pressed.
fn is_reset_by(ui: &Ui, slider: &Response) -> bool {
    // A slider senses drags only: a click is a drag without movement.
    let clicked_twice = slider.drag_stopped() && ui.input(|i| i.pointer.button_double_clicked(PointerButton::Primary));
    let deletes = || ui.input(|i| i.key_pressed(Key::Delete) || i.key_pressed(Key::Backspace));
    clicked_twice || slider.has_focus() && deletes()
}

/// Adds a tooltip that is hidden while the widget is dragged or has the focus, and afterwards until the pointer leaves it,
/// because it would cover the row below.
fn quiet_tip(response: Response, tip: &str) {
    let used = response.id.with("used");
    let is_used = response.dragged() || response.has_focus();
    let was_used = response.ctx.data_mut(|data| {
        let was_used = data.get_temp::<bool>(used).is_some_and(|_| response.contains_pointer());
        match is_used || was_used {
            true => _ = data.insert_temp(used, true),
            false => data.remove::<bool>(used),
        }
        was_used
    });
    if !is_used && !was_used {
        response.on_hover_text(tip);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::keys;

    #[test]
    fn a_number_without_a_unit_has_the_one_that_is_shown() {
        let length = keys::range("beam.length");
        for (text, shown, value) in [
            ("500", "600 mm", 0.5),
            ("1.", "600 mm", 0.001),
            ("2 m", "600 mm", 2.0),
            ("7", "3 m", 7.0),
            ("3e2", "600 mm", 0.3),
            ("5k", "600 mm", 5e3),
        ] {
            assert_eq!(read(text, shown, length), Ok(value), "{text} in place of {shown}");
        }
        let degrees = Limit { unit: "\u{b0}", ..length };
        assert_eq!(read("45", "90\u{b0}", degrees), Ok(45.0));
        assert_eq!(read("3", "2", keys::range("solver.accept_after")), Ok(3.0));
    }
}

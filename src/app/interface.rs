//! Names that most files of the panel, Learn and the shell use, beside those of the prelude.

pub(super) use egui::{
    Align, Align2, Button, Color32, ComboBox, Context, Event, FontId, Frame, Id, Key, Label, Layout, Margin, Modal,
    Modifiers, Painter, Pos2, Rect, Response, RichText, Role, ScrollArea, Sense, Shape, Stroke, StrokeKind, TextEdit,
    Ui, Vec2, WidgetInfo, pos2, vec2,
};

pub(super) use crate::app::action::Action;
pub(super) use crate::app::language::{sentence, spaced};
pub(super) use crate::app::prelude::*;
pub(super) use crate::app::readout::Readout;
pub(super) use crate::app::view_options::{Drawer, MeasureTab, Mode, Toggle, ViewOptions};
pub(super) use crate::app::widgets::buttons::option_button;
pub(super) use crate::app::widgets::number_field::NumberField;
pub(super) use crate::app::widgets::palette::{BODY, HEADLINE, Palette, SMALL};
pub(super) use crate::app::widgets::text::with_keys;
pub(super) use crate::format::{editable, engineering, engineering_pair, three_digits};
pub(super) use crate::scene::{Axis, Place, Support, keys, limits, registry};

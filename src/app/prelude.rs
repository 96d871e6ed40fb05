//! Names that most files of the application use: of the library, of egui, and of the texts of the window.

pub(super) use std::path::{Path, PathBuf};
pub(super) use std::sync::Arc;

pub(super) use egui::{
    Align, Align2, Button, Color32, ComboBox, Context, Event, FontId, Frame, Id, Key, Label, Layout, Margin, Modal,
    Modifiers, Painter, Pos2, Rect, Response, RichText, Role, ScrollArea, Sense, Shape, Stroke, StrokeKind, TextEdit,
    Ui, Vec2, WidgetInfo, pos2, vec2,
};
pub(super) use nalgebra::Vector2;
pub(super) use web_time::{Duration, Instant};

pub(super) use crate::app::action::Action;
pub(super) use crate::app::language::{count, fill, joined, percent, said, sentence, spaced, tr};
pub(super) use crate::app::readout::Readout;
pub(super) use crate::app::view_options::{Drawer, MeasureTab, Mode, Toggle, ViewOptions};
pub(super) use crate::app::widgets::buttons::option_button;
pub(super) use crate::app::widgets::number_field::NumberField;
pub(super) use crate::app::widgets::palette::{BODY, HEADLINE, Palette, SMALL};
pub(super) use crate::app::widgets::text::with_keys;
pub(super) use crate::format::{editable, engineering, engineering_pair, three_digits};
pub(super) use crate::progress::{Observer, Progress};
pub(super) use crate::scene::{
    Analysis, Axis, ElementKind, IntegratorKind, Load, MethodKind, Place, Scene, Source, Support, keys, limits,
    registry,
};
pub(super) use crate::sentence::{Sentence, sentence};
pub(super) use crate::simulation::{Field, Simulation, Status};
pub(super) use crate::study::Reference;

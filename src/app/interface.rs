//! Names that most files of the view, the panel, the modes and the shell use, beside those of the prelude.

pub(super) use std::borrow::Cow;

pub(super) use egui::{
    Align, Align2, Button, CentralPanel, Color32, ComboBox, Context, Event, FontId, Frame, Id, Key, Label, Layout,
    Margin, Modal, Modifiers, Painter, Panel, Pos2, ProgressBar, Rect, Response, RichText, Role, ScrollArea, Sense,
    Shape, Stroke, StrokeKind, TextEdit, Ui, UiBuilder, Vec2, Visuals, WidgetInfo, pos2, vec2,
};

pub(super) use crate::app::action::Action;
pub(super) use crate::app::language::{area_text, sentence, signed_percent, spaced};
pub(super) use crate::app::platform::IS_PAGE;
pub(super) use crate::app::prelude::*;
pub(super) use crate::app::session::Session;
pub(super) use crate::app::session::document::OpeningLoads;
pub(super) use crate::app::session::playback::Playback;
pub(super) use crate::app::task::thread::POLL;
pub(super) use crate::app::view_options::{
    Drawer, LayoutOptions, Magnification, MeasureTab, Mode, Toggle, ViewOptions,
};
pub(super) use crate::app::widgets::buttons::{choice, option_button, options};
pub(super) use crate::app::widgets::legend::{self, LegendMark};
pub(super) use crate::app::widgets::load_scale::{LoadScale, STRAIGHT};
pub(super) use crate::app::widgets::number_field::{Messages, NumberField, NumberRow, show_message};
pub(super) use crate::app::widgets::palette::{BODY, HEADLINE, Palette, SMALL};
pub(super) use crate::app::widgets::text::{Labels, UNKNOWN, semibold, with_keys};
pub(super) use crate::assembly::{Edge, System};
pub(super) use crate::dynamics::INTEGRATORS;
pub(super) use crate::format::{
    editable, engineering, engineering_pair, number, prefix, round_down, three_digits, ticks, two_digits,
};
pub(super) use crate::mesh::{MaterialPoint, Mesh, Segment};
pub(super) use crate::method::METHODS;
pub(super) use crate::render::colormap::ColorMap;
pub(super) use crate::render::display_geometry::DisplayGeometry;
pub(super) use crate::render::{Camera, Margins, View};
pub(super) use crate::scene::limits::{self, Limit};
pub(super) use crate::scene::{Axis, Beam, Material, Place, SectionLine, Support, keys, registry};
pub(super) use crate::simulation::{Motion, PointValues};

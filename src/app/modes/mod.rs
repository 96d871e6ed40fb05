//! Modes of the window. Each module owns the state of its mode.

pub(crate) mod compare;
pub(crate) mod figure;
pub(crate) mod learn;
pub(crate) mod measure;
pub(crate) mod plots;

use crate::app::interface::*;
use crate::app::session::facts::{self, Curve};
use crate::app::task::keyed::Keyed;
use crate::app::viewport::projection::Projection;
use crate::app::widgets::chart::{self, ChartPainter};
use crate::plot::{self, Anchor, ChartAxis, ChartFrame, DrawTarget};
use crate::study::Setting;
use crate::study::figure::{Figure, FigureQuantity, FigureSeries, Ink, LoadAxis, Mark, dominant_axis};

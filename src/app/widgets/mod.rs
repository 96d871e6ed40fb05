//! Widgets that do not depend on the session: colours, number fields, buttons, text.

pub(crate) mod buttons;
pub(crate) mod chart;
pub(crate) mod legend;
pub(crate) mod load_scale;
pub(crate) mod number_field;
pub(crate) mod palette;
pub(crate) mod text;

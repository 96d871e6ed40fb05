//! View of the body: camera, drawn mesh, load handles, overlays, and interaction with the pointer.

pub(crate) mod arrow;
pub(crate) mod arrow_painter;
pub(crate) mod bars;
pub(crate) mod base;
pub(crate) mod body_mesh;
pub(crate) mod body_view;
pub(crate) mod camera_controller;
pub(crate) mod main_view;
pub(crate) mod objects;
pub(crate) mod overlay;
pub(crate) mod pointer;
pub(crate) mod probe;
pub(crate) mod projection;
pub(crate) mod time_line;

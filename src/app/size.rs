//! Sizes of scenes that are meshed and solved between two frames; larger ones are solved in the background.

/// More unknowns than this are not solved between two frames in a pane, which is one of several.
pub(super) const MOST_UNKNOWNS: u64 = 4000;
/// More are not meshed and solved between two frames where one body is all there is.
pub(super) const MOST_ALONE: u64 = 16_000;

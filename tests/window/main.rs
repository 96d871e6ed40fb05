//! Tests of the window, all but `desktop` without a display. `cargo test --test window TOPIC` runs one file.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

#[path = "../common/mod.rs"]
mod common;

mod background_solve;
mod compare;
#[cfg(target_os = "linux")]
mod desktop;
mod drag;
mod figures;
mod golden;
mod language;
mod learn;
mod limits;
mod motions;
mod numbers;
mod panel;
mod pictures;
mod points;
mod sections;
mod soak;
mod story;
mod ui_interaction;

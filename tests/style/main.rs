//! Tests that read the source text: layers, the public face, size. `cargo test --test style TOPIC` runs one file.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

mod architecture;
mod chain;
#[path = "../common/files.rs"]
mod files;
mod public_api;
mod size;
mod topics;

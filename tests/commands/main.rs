//! Tests of the command line, examples and documents. `cargo test --test commands TOPIC` runs one file.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

#[path = "../common/mod.rs"]
mod common;

mod cli;
#[cfg(feature = "app")]
mod docs;
mod examples;
mod files;
mod limits;
mod packages;
#[cfg(feature = "app")]
mod record;
mod section;
#[cfg(target_os = "linux")]
mod statements;
#[cfg(feature = "app")]
mod texts;
#[cfg(target_os = "linux")]
mod usage;

//! Tests of the numbers: elements, methods, motions, stresses and references, against exact and independent solutions.
//! `cargo test --test physics TOPIC` runs one file.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

#[path = "../common/mod.rs"]
mod common;

mod allocations;
mod api;
mod article;
mod auto;
mod beam_theory;
mod calculix;
mod claims;
mod dynamics;
mod edits;
mod elements;
mod equilibria;
mod gmsh;
mod grab;
mod held_points;
mod limits;
mod load_path;
mod meshes;
mod moments;
#[cfg(target_os = "linux")]
mod moved_supports;
#[cfg(target_os = "linux")]
mod path_from_rest;
mod point_values;
mod precision;
mod pulses;
mod reference;
mod scene_text;
mod sections;
mod stress;
mod study;
mod supports;
mod units;

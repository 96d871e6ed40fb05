#![forbid(unsafe_code)]
//! lib
#[cfg(feature = "app")]
pub mod app;
pub mod assembly;
#[cfg(feature = "app")]
pub mod cli;
pub mod element;
pub mod export;
pub mod material;
pub mod mesh;
pub mod method;
#[cfg(feature = "app")]
pub mod render;
pub mod rotation;
pub mod scene;
pub mod simulation;
pub mod solver;

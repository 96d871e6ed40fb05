//! Names that most files of the application use: of the library, and of the texts of the window.

pub(super) use std::path::{Path, PathBuf};
pub(super) use std::sync::Arc;

pub(super) use nalgebra::Vector2;
pub(super) use web_time::{Duration, Instant};

pub(super) use crate::app::language::{count, fill, joined, percent, said, tr};
pub(super) use crate::progress::{Observer, Progress};
pub(super) use crate::scene::{Analysis, ElementKind, IntegratorKind, Load, MethodKind, Scene, Source};
pub(super) use crate::sentence::{Sentence, sentence};
pub(super) use crate::simulation::{Field, Simulation, Status};
pub(super) use crate::study::Reference;

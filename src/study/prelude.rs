//! Names that most files of the studies use: of lower layers, and of the files that import nothing of the studies.

pub(super) use std::sync::Arc;

pub(super) use nalgebra::Vector2;

pub(super) use super::parallel::{self, lock};
pub(super) use super::progress::{Extent, Result, StudyError, check, within};
pub(super) use super::setting::{Setting, Stepping, mesh_text, step_text};
pub(super) use crate::assembly::System;
pub(super) use crate::dynamics::INTEGRATORS;
pub(super) use crate::exact_beam::error_percent;
pub(super) use crate::format::{count, engineering, number, percent, three_digits, two_digits};
pub(super) use crate::mesh::Mesh;
pub(super) use crate::method::METHODS;
pub(super) use crate::progress::{Observer, Progress};
pub(super) use crate::scene::{Analysis, ElementKind, IntegratorKind, Load, MethodKind, Place, Scene};
pub(super) use crate::sentence::{Sentence, displayed, sentence};
pub(super) use crate::simulation::{Deformation, Simulation, SimulationError, Status};
pub(super) use crate::timings::Timings;

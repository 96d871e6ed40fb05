//! Arguments that commands share: a scene with its assignments, and numbers with units.

use std::path::PathBuf;

use clap::Args;
use thiserror::Error;

use crate::scene;
use crate::scene::limits::{Limit, OutOfRange};
use crate::scene::units::{self, UnitError};

#[derive(Debug, Args)]
pub(super) struct SceneArgs {
    /// A built-in scene (see `warpbeam scenes`) or a scene file; `-` reads it from standard input.
    #[arg(default_value = scene::registry::DEFAULT)]
    pub scene: PathBuf,
    #[command(flatten)]
    pub set: SetArgs,
}

#[derive(Debug, Args)]
pub(super) struct RequiredSceneArgs {
    /// A built-in scene (see `warpbeam scenes`) or a scene file; `-` reads it from standard input.
    pub scene: PathBuf,
    #[command(flatten)]
    pub set: SetArgs,
}

#[derive(Debug, Args)]
pub(super) struct SetArgs {
    /// Change a value of the scene: material.young=2e6, beam.cells=[40,2], load.0.force=[0,-5]. Numbers may have units:
    /// material.young="210 GPa", load.0.force=[0 N, -12 kN].
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub assignments: Vec<String>,
}

impl From<SceneArgs> for scene::Source {
    fn from(args: SceneArgs) -> Self {
        Self { name: args.scene, assignments: args.set.assignments }
    }
}

impl From<RequiredSceneArgs> for scene::Source {
    fn from(args: RequiredSceneArgs) -> Self {
        Self { name: args.scene, assignments: args.set.assignments }
    }
}

/// Why a number on the command line is refused.
#[derive(Clone, Debug, Error, PartialEq)]
pub(super) enum NumberError {
    #[error(transparent)]
    Unit(#[from] UnitError),
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
}

/// A number within the limit, in its unit or with another of the same kind.
pub(super) fn parse_number(text: &str, limit: Limit) -> Result<f64, NumberError> {
    let value = units::parse(text, limit.unit)?;
    limit.check(value)?;
    Ok(value)
}

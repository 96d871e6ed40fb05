//! Arguments shared by commands: a scene with assignments, numbers with units, and files beside the text.

use std::path::PathBuf;

use clap::{Arg, Args};

use super::{CliError, check_suffix};
use crate::export;
use crate::plot::Drawing;
use crate::scene;

#[derive(Debug, Default, Args)]
pub(super) struct SceneArgs {
    /// Built-in scene (see `warpbeam scenes`) or scene file; `-` reads standard input.
    #[arg(required = true)]
    pub scene: Option<PathBuf>,
    /// Change a value of the scene: material.young=2e6, beam.cells=[40,2], load.0.force=[0,-5]. Numbers may have units:
    /// material.young="210 GPa", load.0.force=[0 N, -12 kN].
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub assignments: Vec<String>,
}

/// Lets a command without a scene take the default one.
pub(super) fn or_default(scene: Arg) -> Arg {
    const HELP: &str =
        "Built-in scene (see `warpbeam scenes`) or scene file; `-` reads standard input. Default: cantilever";
    scene.required(false).help(HELP)
}

impl From<SceneArgs> for scene::Source {
    fn from(SceneArgs { scene, assignments }: SceneArgs) -> Self {
        Self { name: scene.unwrap_or_else(|| scene::registry::DEFAULT.into()), assignments }
    }
}

#[derive(Debug, Args)]
pub(super) struct OutputArgs {
    /// Also write a table.
    #[arg(long = "out", value_name = "FILE.csv")]
    table: Option<PathBuf>,
    /// Also draw a picture.
    #[arg(long, value_name = "FILE.svg")]
    picture: Option<PathBuf>,
}

impl OutputArgs {
    /// Refuses names with another ending, so that nothing is computed in vain.
    pub fn check(&self) -> Result<(), CliError> {
        self.picture.as_deref().map_or(Ok(()), |path| check_suffix(path, ".svg"))?;
        self.table.as_deref().map_or(Ok(()), |path| check_suffix(path, ".csv"))
    }

    /// Writes the table and the picture, each if it is wanted.
    pub fn write(
        &self,
        table: impl FnOnce() -> String,
        picture: impl FnOnce() -> Result<Drawing, CliError>,
    ) -> Result<(), CliError> {
        self.table.as_deref().map_or(Ok(()), |path| export::write_text(path, &table()))?;
        let Some(path) = &self.picture else { return Ok(()) };
        Ok(export::write_text(path, &picture()?.svg())?)
    }
}

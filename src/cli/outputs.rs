//! Files that a command writes beside its text: a table and a picture.

use std::path::PathBuf;

use clap::Args;

use super::{CliError, check_suffix};
use crate::export;
use crate::plot::Drawing;

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
        self.picture.as_deref().map_or(Ok(()), |path| check_suffix(path, &[".svg"], ".svg"))?;
        self.table.as_deref().map_or(Ok(()), |path| check_suffix(path, &[".csv"], ".csv"))
    }

    /// Writes the table, if one is wanted.
    pub fn write_table(&self, table: impl FnOnce() -> String) -> Result<(), CliError> {
        let Some(path) = &self.table else { return Ok(()) };
        Ok(export::write_text(path, &table())?)
    }

    /// Writes the picture, if one is wanted.
    pub fn write_picture(&self, drawing: impl FnOnce() -> Result<Drawing, CliError>) -> Result<(), CliError> {
        let Some(path) = &self.picture else { return Ok(()) };
        Ok(export::write_text(path, &drawing()?.svg())?)
    }
}

//! What can be typed after the commands that draw.

use std::path::PathBuf;

use clap::Args;
use thiserror::Error;

use crate::app;

/// The picture written where there is no display.
pub(super) const DEFAULT_PICTURE: &str = "warpbeam.png";

#[derive(Debug, Args)]
pub(super) struct ShotArgs {
    #[command(flatten)]
    pub scene: super::args::RequiredSceneArgs,
    /// The picture to write.
    #[arg(short, long, value_name = "OUT.png")]
    pub output: PathBuf,
    /// Its size in pixels, 64x64 to 8192x8192.
    #[arg(long, value_name = "WxH", default_value = "1280x800", value_parser = parse_size)]
    pub size: [u32; 2],
    /// Only the view, without the panel.
    #[arg(long)]
    pub no_panel: bool,
    /// With the load–deflection curve.
    #[arg(long)]
    pub curve: bool,
    /// With error against time, measured now.
    #[arg(long, conflicts_with = "curve")]
    pub study: bool,
    /// Light or dark.
    #[arg(long, value_enum, default_value_t = app::ThemeChoice::Dark)]
    pub theme: app::ThemeChoice,
}

/// A size that is none, or is out of range.
#[derive(Debug, Error)]
#[error("expected WIDTHxHEIGHT, each from 64 to {}, as in 1280x800", app::MAX_SHOT_SIDE)]
struct SizeError;

fn parse_size(text: &str) -> Result<[u32; 2], SizeError> {
    let (width, height) = text.split_once(['x', 'X', '×']).ok_or(SizeError)?;
    let side = |text: &str| match text.trim().parse() {
        Ok(side) if (64..=app::MAX_SHOT_SIDE).contains(&side) => Ok(side),
        _ => Err(SizeError),
    };
    Ok([side(width)?, side(height)?])
}

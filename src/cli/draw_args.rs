//! What can be typed after the commands that draw.

use std::path::PathBuf;

use clap::Args;
use thiserror::Error;

use super::scene_args::{NumberError, RequiredSceneArgs, parse_number};
use crate::app;
use crate::dynamics::INTEGRATORS;
use crate::scene::IntegratorKind;
use crate::scene::limits::{DURATION, PLAYBACK_SPEED};

/// The picture written where there is no display.
pub(super) const DEFAULT_PICTURE: &str = "warpbeam.png";

#[derive(Debug, Args)]
pub(super) struct ShotArgs {
    #[command(flatten)]
    pub scene: RequiredSceneArgs,
    /// The picture to write.
    #[arg(short, long, value_name = "OUT.png")]
    pub output: PathBuf,
    /// Its size in pixels, 64x64 to 8192x8192.
    #[arg(long, value_name = "WxH", default_value = "1280x800", value_parser = parse_size)]
    pub size: [u32; 2],
    /// Only the view, without panel and bars.
    #[arg(long)]
    pub no_panel: bool,
    /// With the load–deflection curve.
    #[arg(long)]
    pub curve: bool,
    /// With error against time, measured now.
    #[arg(long, conflicts_with = "curve")]
    pub study: bool,
    /// A card of the window's mode Learn, from 1: each shows the article's beam, whatever the scene. The last one with --study
    /// has its table.
    #[arg(long, value_name = "CARD", value_parser = clap::value_parser!(u8).range(1..=i64::try_from(app::card_count()).unwrap_or(i64::MAX)), conflicts_with_all = ["curve", "motion"])]
    pub learn: Option<u8>,
    /// Of a scene in time: with the plot of its energy, and the same motion under other integrators beside.
    #[arg(long, value_name = "INTEGRATOR", num_args = 0.., value_parser = parse_integrator, conflicts_with_all = ["curve", "study"])]
    pub motion: Option<Vec<IntegratorKind>>,
    /// Two to four panes beside each other under one load. A pane is a method, an element, cells or most iterations, or
    /// several of these between colons, in any order; the rest is as in the scene: linear,warped,newton or
    /// warped:t3,warped:t6:10x2,newton:5. `scene` is the scene as it is.
    #[arg(long, value_name = "PANE,PANE", value_parser = parse_panes, conflicts_with_all = ["curve", "study", "motion"])]
    pub compare: Option<Panes>,
    /// Light or dark.
    #[arg(long, value_enum, default_value_t = app::ThemeChoice::Dark)]
    pub theme: app::ThemeChoice,
    /// English or Chinese.
    #[arg(long, value_enum, default_value_t = app::Language::English)]
    pub language: app::Language,
}

/// Panes that are compared: one value of an option.
#[derive(Clone, Debug)]
pub(super) struct Panes(pub Vec<app::PaneSetting>);

fn parse_panes(text: &str) -> Result<Panes, app::PaneSettingError> {
    app::parse_panes(text).map(Panes)
}

/// What `record --help` says of files.
pub(super) const RECORD_NOTES: &str = "\
OUT.gif loops for ever, in one palette of 256 colours. A GIF counts in hundredths of a second: where --fps is no such \
rate, the nearest is taken, and said.
A name without extension is a folder of numbered pictures in full colour, frame-0001.png and on, ready for
  ffmpeg -framerate 25 -i FOLDER/frame-%04d.png -pix_fmt yuv420p OUT.mp4

Camera and colours span the whole motion: it is run once before it is drawn.
Ctrl-C leaves a shorter, valid recording, and exit code 1.
";

#[derive(Debug, Args)]
pub(super) struct RecordArgs {
    #[command(flatten)]
    pub scene: RequiredSceneArgs,
    /// The file, or the folder, to write.
    #[arg(short, long, value_name = "OUT.gif|FOLDER")]
    pub output: PathBuf,
    /// How much of a motion is recorded: 2, 2s or 500ms. Else the scene's dynamics.duration.
    #[arg(long, value_name = "TIME", value_parser = parse_seconds)]
    pub seconds: Option<f64>,
    /// Seconds of the motion in a second of the picture: 0.1 is slow motion.
    #[arg(long, value_name = "FACTOR", value_parser = parse_speed)]
    pub speed: Option<f64>,
    /// Pictures a second, 1 to 100. Else 25, and 4 of the way to an equilibrium.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=100))]
    pub fps: Option<u16>,
    /// Its size in pixels, 64x64 to 8192x8192.
    #[arg(long, value_name = "WxH", default_value = "800x500", value_parser = parse_size)]
    pub size: [u32; 2],
    /// Replace the numbered pictures that the folder has.
    #[arg(long)]
    pub overwrite: bool,
    /// Light or dark.
    #[arg(long, value_enum, default_value_t = app::ThemeChoice::Dark)]
    pub theme: app::ThemeChoice,
    /// English or Chinese.
    #[arg(long, value_enum, default_value_t = app::Language::English)]
    pub language: app::Language,
}

/// A name that is no integrator's.
#[derive(Debug, Error)]
#[error("expected one of {}", INTEGRATORS.iter().map(|entry| entry.id).collect::<Vec<_>>().join(", "))]
struct NoIntegrator;

fn parse_integrator(text: &str) -> Result<IntegratorKind, NoIntegrator> {
    INTEGRATORS.iter().find(|entry| entry.id == text).map(|entry| entry.kind).ok_or(NoIntegrator)
}

fn parse_seconds(text: &str) -> Result<f64, NumberError> {
    parse_number(text, DURATION)
}

fn parse_speed(text: &str) -> Result<f64, NumberError> {
    parse_number(text, PLAYBACK_SPEED)
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

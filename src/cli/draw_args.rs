//! Command line arguments of the commands that draw.

use std::path::PathBuf;

use clap::Args;

use super::CliError;
use super::shared_args::{RequiredSceneArgs, SetArgs, within};
use crate::app;
use crate::dynamics::INTEGRATORS;
use crate::scene::IntegratorKind;
use crate::scene::keys::range;
use crate::scene::limits::PLAYBACK_SPEED;
use crate::simulation::Field;

/// Default image file if there is no display.
pub(super) const DEFAULT_PICTURE: &str = "warpbeam.png";

#[derive(Debug, Args)]
pub(super) struct AdapterArgs {
    /// Graphics adapter: a part of its name, in lower or upper case; `warpbeam gpu` lists the names. Default: the
    /// environment variable WGPU_ADAPTER_NAME, or the best adapter that works. WGPU_BACKEND (vulkan, metal, dx12, gl)
    /// restricts the choice.
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

#[derive(Debug, Args)]
pub(super) struct LookArgs {
    /// Colour theme.
    #[arg(long, value_enum, default_value_t = app::ThemeChoice::Dark)]
    pub theme: app::ThemeChoice,
    /// Language.
    #[arg(long, value_enum, default_value_t = app::Language::English)]
    pub language: app::Language,
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

#[derive(Debug, Args)]
pub(super) struct ShotArgs {
    #[command(flatten)]
    pub scene: RequiredSceneArgs,
    /// Image file to write.
    #[arg(short, long, value_name = "OUT.png")]
    pub output: PathBuf,
    /// Size in pixels, 64x64 to 8192x8192.
    #[arg(long, value_name = "WxH", default_value = "1280x800", value_parser = parse_size)]
    pub size: [u32; 2],
    /// Draw only the view, without panel and bars.
    #[arg(long)]
    pub no_panel: bool,
    /// Colour the body with a field: von-mises, stress-x, strain-x, displacement, rotation, ..., as the window's list
    /// of colours has them.
    #[arg(long, value_name = "FIELD", default_value = Field::default().id(), value_parser = parse_field)]
    pub field: Field,
    /// Draw the body with a multiple of its displacement: a factor, or `auto` for about a twentieth of the body's size.
    #[arg(long, value_name = "FACTOR", value_parser = parse_magnification, conflicts_with = "learn")]
    pub magnify: Option<app::Magnification>,
    /// Add the load–deflection curve.
    #[arg(long)]
    pub curve: bool,
    /// Add the stress along the first section of the scene, or M along the beam if it has none.
    #[arg(long, conflicts_with = "curve")]
    pub sections: bool,
    /// Add the plot of error against time, measured now.
    #[arg(long, conflicts_with_all = ["curve", "sections", "learn"])]
    pub study: bool,
    /// Add the map of the loads up to which each method and element holds, or of the time steps up to which each
    /// integrator does, as the window's mode Measure shows them.
    #[arg(long, conflicts_with_all = ["curve", "sections", "study", "learn", "motion", "compare"])]
    pub limits: bool,
    /// Show a card of the window's Learn mode, numbered from 1: each shows the article's beam, whatever the scene.
    #[arg(long, value_name = "CARD", value_parser = clap::value_parser!(u8).range(1..=i64::try_from(app::card_count()).unwrap_or(i64::MAX)), conflicts_with_all = ["curve", "sections", "motion"])]
    pub learn: Option<u8>,
    /// For a dynamic scene: add the plot of its energy, and show the same motion with other integrators side by side.
    #[arg(long, value_name = "INTEGRATOR", num_args = 0.., value_parser = parse_integrator, conflicts_with_all = ["curve", "sections", "study"])]
    pub motion: Option<Vec<IntegratorKind>>,
    /// Show two to four panes side by side under one load. A pane is a method, an element, cells or an iteration limit,
    /// or several of these separated by colons, in any order; the rest is as in the scene: linear,warped,newton or
    /// warped:t3,warped:t6:10x2,newton:5. `scene` is the scene unchanged.
    #[arg(long, value_name = "PANE,PANE", value_parser = app::parse_panes, conflicts_with_all = ["curve", "sections", "study", "motion"])]
    pub compare: Option<PaneSettings>,
    #[command(flatten)]
    pub look: LookArgs,
}

/// Panes of a comparison, as the option --compare lists them: one value, which clap would not read as a `Vec`.
type PaneSettings = Vec<app::PaneSetting>;

/// Notes about files in `record --help`.
pub(super) const RECORD_NOTES: &str = "\
OUT.gif loops forever and has one palette of 256 colours. GIF frame times are hundredths of a second: if --fps does \
not fit, the nearest rate is used and printed.
A name without extension is a folder for images in full colour, frame-0001.png, frame-0002.png, ..., ready for
  ffmpeg -framerate 25 -i FOLDER/frame-%04d.png -pix_fmt yuv420p OUT.mp4

Camera and colour range fit the whole motion, which is computed once before it is drawn.
Ctrl-C ends with a shorter, valid recording and exit code 1.
";

#[derive(Debug, Args)]
pub(super) struct RecordArgs {
    /// Built-in scene (see `warpbeam scenes`) or scene file; `-` reads standard input.
    #[arg(required_unless_present = "story")]
    pub scene: Option<PathBuf>,
    #[command(flatten)]
    pub set: SetArgs,
    /// Record the story of the window's first start, 20 s on the default scene, in place of a scene.
    #[arg(long, conflicts_with_all = ["scene", "assignments", "seconds", "speed"])]
    pub story: bool,
    /// File or folder to write.
    #[arg(short, long, value_name = "OUT.gif|FOLDER")]
    pub output: PathBuf,
    /// Duration to record: 2, 2s or 500ms. Default: the scene's dynamics.duration.
    #[arg(long, value_name = "TIME", value_parser = within(range("dynamics.duration")))]
    pub seconds: Option<f64>,
    /// Playback speed, simulated seconds per second: 0.1 is slow motion.
    #[arg(long, value_name = "FACTOR", value_parser = within(PLAYBACK_SPEED))]
    pub speed: Option<f64>,
    /// Frames per second, 1 to 100. Default: 25, 4 for the iterations of a static scene, or 10 for the story.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=100))]
    pub fps: Option<u16>,
    /// Size in pixels, 64x64 to 8192x8192.
    #[arg(long, value_name = "WxH", default_value = "800x500", value_parser = parse_size)]
    pub size: [u32; 2],
    /// Replace existing numbered images in the folder.
    #[arg(long)]
    pub overwrite: bool,
    #[command(flatten)]
    pub look: LookArgs,
}

fn parse_integrator(text: &str) -> Result<IntegratorKind, CliError> {
    let known = || INTEGRATORS.iter().map(|entry| entry.id).collect::<Vec<_>>().join(", ");
    let entry = INTEGRATORS.iter().find(|entry| entry.id == text);
    Ok(entry.ok_or_else(|| format!("expected one of {}", known()))?.kind)
}

fn parse_field(text: &str) -> Result<Field, CliError> {
    let known = || Field::ALL.map(Field::id).join(", ");
    let field = Field::ALL.into_iter().find(|field| field.id() == text);
    Ok(field.ok_or_else(|| format!("expected one of {}", known()))?)
}

fn parse_magnification(text: &str) -> Result<app::Magnification, CliError> {
    match text {
        "auto" => Ok(app::Magnification::Automatic),
        _ => within(app::Magnification::LIMIT)(text).map(app::Magnification::Factor),
    }
}

fn parse_size(text: &str) -> Result<[u32; 2], CliError> {
    let side = |text: &str| text.trim().parse().ok().filter(|side| (64..=app::MAX_SHOT_SIDE).contains(side));
    let sides = text.split_once(['x', 'X', '×']).and_then(|(width, height)| Some([side(width)?, side(height)?]));
    Ok(sides.ok_or_else(|| format!("expected WIDTHxHEIGHT, each from 64 to {}, as in 1280x800", app::MAX_SHOT_SIDE))?)
}

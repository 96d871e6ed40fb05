//! Options of images and recordings, as the commands `shot` and `record` read them.

use clap::Args;

use crate::app::ThemeChoice;
use crate::app::language::Language;
use crate::app::modes::compare::{PaneSetting, parse_panes};
use crate::app::modes::learn::card_count;
use crate::app::prelude::*;
use crate::app::view_options::Magnification;
use crate::scene::keys::range;
use crate::scene::limits::PLAYBACK_SPEED;
use crate::scene::units::within;

/// Largest side of a shot, pixels.
const MAX_SHOT_SIDE: u32 = 8192;

/// Choice of the graphics adapter.
#[derive(Clone, Debug, Default, PartialEq, Args)]
pub struct AdapterArgs {
    /// Graphics adapter: a part of its name, in lower or upper case; `warpbeam gpu` lists the names. Default: the
    /// environment variable WGPU_ADAPTER_NAME, or the best adapter that works. WGPU_BACKEND (vulkan, metal, dx12, gl)
    /// restricts the choice.
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

/// Appearance of a picture.
#[derive(Clone, Debug, Default, PartialEq, Args)]
pub struct LookArgs {
    /// Colour theme.
    #[arg(long, value_enum, default_value_t = ThemeChoice::Dark)]
    pub theme: ThemeChoice,
    /// Language.
    #[arg(long, value_enum, default_value_t = Language::English)]
    pub language: Language,
    /// Graphics adapter.
    #[command(flatten)]
    pub adapter: AdapterArgs,
}

/// Options of a shot, with the defaults of the command, but for the size, which is to be set.
#[derive(Clone, Debug, Default, PartialEq, Args)]
pub struct ShotOptions {
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
    pub magnify: Option<Magnification>,
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
    #[arg(long, value_name = "CARD", value_parser = clap::value_parser!(u8).range(1..=i64::try_from(card_count()).unwrap_or(i64::MAX)), conflicts_with_all = ["curve", "sections", "motion"])]
    pub learn: Option<u8>,
    /// For a dynamic scene: add the plot of its energy.
    #[arg(long, conflicts_with_all = ["curve", "sections", "study"])]
    pub motion: bool,
    /// Show two to four panes side by side under one load. A pane is a method, an element, cells or an iteration limit,
    /// or several of these separated by colons, in any order; the rest is as in the scene: linear,warped,newton or
    /// warped:t3,warped:t6:10x2,newton:5. `scene` is the scene unchanged.
    #[arg(long, value_name = "PANE,PANE", value_parser = parse_panes, conflicts_with_all = ["curve", "sections", "study", "motion"])]
    pub compare: Option<PaneSettings>,
    /// Appearance.
    #[command(flatten)]
    pub look: LookArgs,
}

/// Panes of a comparison, as the option --compare lists them: one value, which clap would not read as a `Vec`.
type PaneSettings = Vec<PaneSetting>;

/// Options of a recording.
#[derive(Clone, Debug, PartialEq, Args)]
pub struct RecordOptions {
    /// Duration to record: 2, 2s or 500ms. Default: the scene's dynamics.duration.
    #[arg(long, value_name = "TIME", value_parser = within(const { range("dynamics.duration") }))]
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
    /// Appearance.
    #[command(flatten)]
    pub look: LookArgs,
}

fn parse_field(text: &str) -> Result<Field, String> {
    let field = Field::ALL.into_iter().find(|field| field.id() == text);
    field.ok_or_else(|| format!("expected one of {}", Field::ALL.map(Field::id).join(", ")))
}

fn parse_magnification(text: &str) -> Result<Magnification, String> {
    match text {
        "auto" => Ok(Magnification::Automatic),
        _ => within(Magnification::LIMIT)(text).map(Magnification::Factor),
    }
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let side = |text: &str| text.trim().parse().ok().filter(|side| (64..=MAX_SHOT_SIDE).contains(side));
    let sides = text.split_once(['x', 'X', '×']).and_then(|(width, height)| Some([side(width)?, side(height)?]));
    sides.ok_or_else(|| format!("expected WIDTHxHEIGHT, each from 64 to {MAX_SHOT_SIDE}, as in 1280x800"))
}

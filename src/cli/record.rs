//! Command `record`.

use std::path::Path;
use std::process::ExitCode;

use super::draw_args::{LookArgs, RecordArgs};
use super::progress::Watch;
use super::{CliError, NOT_CONVERGED, exit_code, text};
use crate::app::{self, RecordOptions, Recorded};
use crate::format::{count, number};
use crate::scene;

pub(super) fn record(args: RecordArgs) -> Result<ExitCode, CliError> {
    let RecordArgs { scene, set, story: _, output, seconds, speed, fps, size, overwrite, look } = args;
    let LookArgs { theme, language, adapter } = look;
    let options = RecordOptions { size, seconds, speed, fps, overwrite, theme, language, adapter: adapter.adapter };
    let source = scene.map(|name| scene::Source { name, assignments: set.assignments });
    let opened = source.map(|source| scene::open(&source).map(|scene| (source, scene))).transpose()?;
    let watch = Watch::new();
    let recorded = app::record(opened, &options, &output, &|progress| watch.observe(progress));
    drop(watch);
    let recorded = recorded?;
    if recorded.pictures == 0 {
        eprintln!("warpbeam: interrupted before the first picture: nothing was written");
        return Ok(ExitCode::from(NOT_CONVERGED));
    }
    text::print(&summary(&recorded, fps, &output))?;
    if recorded.interrupted {
        eprintln!("warpbeam: interrupted: the recording is partial");
        return Ok(ExitCode::from(NOT_CONVERGED));
    }
    if let Some(reason) = recorded.status.failure() {
        eprintln!("warpbeam: {}: {reason}", recorded.status.word());
    }
    Ok(exit_code(&recorded.status))
}

/// Describes the written file and its frame rate.
fn summary(recorded: &Recorded, asked: Option<u16>, output: &Path) -> String {
    let Recorded { pictures, rate, .. } = recorded;
    let rounded = number((100.0 * rate).round() / 100.0);
    let mut text = format!("{}: {}, {rounded} per second", output.display(), count(*pictures, "picture"));
    if let Some(asked) = asked.filter(|&asked| (f64::from(asked) - rate).abs() > 1e-9) {
        // Folders have every rate.
        text += &format!(" (a GIF cannot have {asked})");
    }
    text + "\n"
}

//! Commands `run`, `shot`, `record` and `gpu`.

use std::ops::ControlFlow;
use std::path::Path;
use std::process::ExitCode;

use super::args::{RecordArgs, ShotArgs, SolveArgs};
use super::progress::{Watch, watched};
use super::shared_args::SceneArgs;
use super::{CliError, check_fit, check_suffix, commands, drawn, ended, exit_code, sections_of, simulate, text};
use crate::app;
use crate::format::{count, number};
use crate::render;
use crate::scene;
use crate::study::Extent;

pub(super) fn shot(args: ShotArgs) -> Result<ExitCode, CliError> {
    let ShotArgs { scene, output, options } = args;
    check_suffix(&output, ".png")?;
    let source = scene::Source::from(scene);
    let (scene, simulation) = simulate(&source)?;
    sections_of(&source, &simulation)?;
    let shows = "it shows equilibria; for a motion, --motion shows the energy";
    let energy = "it shows the energy of a motion; for an equilibrium, use --compare";
    let measures = options.study && options.learn.is_none();
    for (option, given, moves, reason) in [
        ("--compare", options.compare.is_some(), false, shows),
        ("--curve", options.curve, false, shows),
        ("--sections", options.sections, false, "for a motion, use `warpbeam section`"),
        ("--motion", options.motion, true, energy),
        ("--study", measures, false, "it measures solves; for a motion, use `warpbeam study`"),
    ] {
        check_fit((&source, &scene), (option, given), moves, reason)?;
    }
    let watch = Watch::new();
    let shot = app::shot(source, scene, simulation, &options, &output, &|progress| watch.observe(progress))?;
    let interrupted = watch.is_cancelled();
    drop(watch);
    if interrupted {
        return Ok(ended(true, "the picture shows only the settings measured until then"));
    }
    let code = drawn(&shot.status);
    Ok(shot.study_error.map_or(code, |reason| {
        eprintln!("warpbeam: no study: {reason}");
        exit_code(false)
    }))
}

/// Opens the window. `is_default` is `true` if no scene was asked for.
pub(super) fn run(
    source: scene::Source,
    output: &Path,
    adapter: Option<String>,
    is_default: bool,
) -> Result<ExitCode, CliError> {
    check_suffix(output, ".png")?;
    let scene = scene::open(&source)?;
    let simulation = || Ok::<_, CliError>(simulate(&source)?.1);
    // A window opens without waiting for a large mesh; errors of a small one are reported before opening a window.
    let small = if app::opens_in_background(&scene) { None } else { Some(simulation()?) };
    match app::Display::open() {
        Ok(display) => app::run(display, source, scene, small, adapter, is_default)?,
        Err(reason) => {
            let simulation = small.map_or_else(simulation, Ok)?;
            let picture = output.display();
            text::print(&format!("No window: {reason}.\nSolving the scene instead; the picture goes to {picture}.\n"))?;
            let scene_args = SceneArgs { scene: Some(source.name.clone()), assignments: source.assignments.clone() };
            let reference = Some(Extent::Quick);
            commands::solve(SolveArgs { scene: scene_args, reference, ..SolveArgs::default() })?;
            let look = app::LookArgs { adapter: app::AdapterArgs { adapter }, ..Default::default() };
            let options = app::ShotOptions { size: [1280, 800], look, ..Default::default() };
            app::shot(source, scene, simulation, &options, output, &|_| ControlFlow::Continue(()))?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

pub(super) fn gpu(name: Option<&str>) -> Result<ExitCode, CliError> {
    let adapters = render::adapters(name);
    text::print(&text::adapters(&adapters))?;
    if !adapters.iter().any(|adapter| adapter.is_used) {
        // The error has the reason for which none is used.
        render::Gpu::headless(name).map_err(app::AppError::from)?;
    }
    Ok(ExitCode::SUCCESS)
}

pub(super) fn record(args: RecordArgs) -> Result<ExitCode, CliError> {
    let RecordArgs { scene, story, output, options } = args;
    let source = (!story).then(|| scene::Source::from(scene));
    let opened = source.map(|source| scene::open(&source).map(|scene| (source, scene))).transpose()?;
    let recorded = watched(|observe| app::record(opened, &options, &output, observe))?;
    if recorded.pictures == 0 {
        eprintln!("warpbeam: interrupted before the first picture: nothing was written");
        return Ok(exit_code(false));
    }
    text::print(&summary(&recorded, options.fps, &output))?;
    if recorded.interrupted {
        return Ok(ended(true, "the recording is partial"));
    }
    Ok(drawn(&recorded.status))
}

/// Describes the written file and its frame rate.
fn summary(recorded: &app::Recorded, asked: Option<u16>, output: &Path) -> String {
    let app::Recorded { pictures, rate, .. } = recorded;
    let rounded = number((100.0 * rate).round() / 100.0);
    let mut text = format!("{}: {}, {rounded} per second", output.display(), count(*pictures, "picture"));
    if let Some(asked) = asked.filter(|&asked| (f64::from(asked) - rate).abs() > 1e-9) {
        // Folders have every rate.
        text += &format!(" (a GIF cannot have {asked})");
    }
    text + "\n"
}

//! Commands `run` and `shot`.

use std::ops::ControlFlow;
use std::path::Path;
use std::process::ExitCode;

use super::args::{ReferenceEffort, SolveArgs};
use super::draw_args::{DEFAULT_PICTURE, ShotArgs};
use super::progress::Watch;
use super::scene_args::{RequiredSceneArgs, SetArgs};
use super::{CliError, NOT_CONVERGED, check_fit, check_suffix, commands, exit_code, simulate, text};
use crate::app;
use crate::scene::{self, registry};

pub(super) fn shot(args: ShotArgs) -> Result<ExitCode, CliError> {
    let ShotArgs { scene, output, size, no_panel, curve, study, learn, motion, compare, theme, language } = args;
    let compare = compare.map(|panes| panes.0).unwrap_or_default();
    let learn = learn.map(usize::from);
    let options = app::ShotOptions { size, panel: !no_panel, curve, study, learn, motion, compare, theme, language };
    check_suffix(&output, &[".png"], ".png")?;
    let source = scene::Source::from(scene);
    let (scene, simulation) = simulate(&source)?;
    let fits = |option, given, moves, reason| check_fit((&source, &scene), (option, given), moves, reason);
    fits("--compare", !options.compare.is_empty(), false, "it shows equilibria; for a motion, use --motion")?;
    fits("--curve", options.curve, false, "it shows equilibria; for a motion, --motion shows the energy")?;
    fits("--motion", options.motion.is_some(), true, "it shows integrators; for an equilibrium, use --compare")?;
    fits(
        "--study",
        options.study && options.learn.is_none(),
        false,
        "it measures solves; for a motion, use `warpbeam study`",
    )?;
    let watch = Watch::new();
    let shot = app::shot(source, scene, simulation, &options, &output, &|progress| watch.observe(progress))?;
    let interrupted = watch.is_cancelled();
    drop(watch);
    if interrupted {
        eprintln!("warpbeam: interrupted: the picture shows only the settings measured until then");
        return Ok(ExitCode::from(NOT_CONVERGED));
    }
    if let Some(reason) = shot.status.failure() {
        eprintln!("warpbeam: {}: {reason}", shot.status.word());
    }
    if let Some(reason) = shot.study_error {
        eprintln!("warpbeam: no study: {reason}");
        return Ok(ExitCode::from(NOT_CONVERGED));
    }
    Ok(exit_code(&shot.status))
}

/// Runs `warpbeam` without a command.
pub(super) fn run_default() -> Result<ExitCode, CliError> {
    let source = scene::Source { name: registry::DEFAULT.into(), assignments: Vec::new() };
    run(source, Path::new(DEFAULT_PICTURE))
}

pub(super) fn run(source: scene::Source, output: &Path) -> Result<ExitCode, CliError> {
    check_suffix(output, &[".png"], ".png")?;
    let scene = scene::open(&source)?;
    let simulation = || Ok::<_, CliError>(simulate(&source)?.1);
    // A window opens without waiting for a large mesh; errors of a small one are reported before opening a window.
    let small = if app::opens_in_background(&scene) { None } else { Some(simulation()?) };
    match app::Display::open() {
        Ok(display) => app::run(display, source, scene, small)?,
        Err(reason) => {
            let simulation = small.map_or_else(simulation, Ok)?;
            let picture = output.display();
            text::print(&format!("No window: {reason}.\nSolving the scene instead; the picture goes to {picture}.\n"))?;
            let args = RequiredSceneArgs {
                scene: source.name.clone(),
                set: SetArgs { assignments: source.assignments.clone() },
            };
            commands::solve(SolveArgs {
                scene: args,
                json: false,
                out: None,
                reference: ReferenceEffort::Bounded,
                no_reference: false,
                certificate: false,
                no_certificate: false,
            })?;
            app::shot(source, scene, simulation, &app::ShotOptions::default(), output, &|_| ControlFlow::Continue(()))?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

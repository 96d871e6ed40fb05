//! The commands that draw: `run` and `shot`.

use std::path::Path;
use std::process::ExitCode;

use super::args::{RequiredSceneArgs, SetArgs, SolveArgs};
use super::draw_args::{DEFAULT_PICTURE, ShotArgs};
use super::{CliError, commands, exit_code, named, simulate, text};
use crate::app;
use crate::scene::{self, registry};

pub(super) fn shot(args: ShotArgs) -> Result<ExitCode, CliError> {
    let ShotArgs { scene, output, size, no_panel, curve, study, learn, motion, compare, theme, language } = args;
    let compare = compare.map(|panes| panes.0).unwrap_or_default();
    let learn = learn.map(usize::from);
    let options = app::ShotOptions { size, panel: !no_panel, curve, study, learn, motion, compare, theme, language };
    let source = scene::Source::from(scene);
    let (scene, simulation) = simulate(&source)?;
    if !options.compare.is_empty() && scene.analysis == scene::Analysis::Dynamic {
        return Err(CliError::ComparesMotion { scene: named(&source) });
    }
    let status = app::shot(source, scene, simulation, &options, &output)?;
    if let Some(reason) = status.failure() {
        eprintln!("warpbeam: {}: {reason}", status.id());
    }
    Ok(exit_code(&status))
}

/// `warpbeam` without a command.
pub(super) fn run_default() -> Result<ExitCode, CliError> {
    let source = scene::Source { name: registry::DEFAULT.into(), assignments: Vec::new() };
    run(source, Path::new(DEFAULT_PICTURE))
}

pub(super) fn run(source: scene::Source, output: &Path) -> Result<ExitCode, CliError> {
    let scene = scene::open(&source)?;
    let simulation = || Ok::<_, CliError>(simulate(&source)?.1);
    // A window does not wait for a large mesh; what is wrong with a small one is said without a window.
    let small = if app::opens_beside(&scene) { None } else { Some(simulation()?) };
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
            commands::solve(SolveArgs { scene: args, json: false, out: None, no_truth: false, no_certificate: false })?;
            app::shot(source, scene, simulation, &app::ShotOptions::default(), output)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

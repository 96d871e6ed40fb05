//! Commands `run`, `scenes`, `solve`, `curve`, `section`, `study`, `limits`, `tune`, `extremes`, `shot`, `record` and `gpu`;
//! without the feature `app`, those that need no window and no GPU.
//!
//! Exit codes: 0 done and converged, 1 ran but did not converge, was interrupted or gained energy from its integrator,
//! 2 bad input or usage, a result that could not be written, or a defect of the program, 3 no graphics adapter.

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use clap::error::{ContextKind, ContextValue};
use clap::{CommandFactory as _, Parser};

use self::args::{Cli, Command};
use crate::assembly::{Problem, System};
use crate::format::number;
use crate::scene::{self, Analysis, MeshFile, Scene};
use crate::section::{Section, SectionError};
#[cfg(feature = "app")]
use crate::simulation::Status;
use crate::simulation::{Simulation, SimulationError};

mod args;
mod commands;
#[cfg(all(feature = "app", target_os = "linux"))]
mod driver;
#[cfg(all(feature = "app", windows))]
mod explorer;
mod json;
mod limits;
mod progress;
mod section;
mod shared_args;
mod solved;
mod text;
#[cfg(feature = "app")]
mod window;

/// Exit code: ran, but did not converge, was interrupted, or gained energy from its integrator.
const NOT_CONVERGED: u8 = 1;
/// Exit code: bad input or usage.
const BAD_INPUT: u8 = 2;
/// Exit code: no usable graphics adapter.
#[cfg(feature = "app")]
const NO_ADAPTER: u8 = 3;

/// Error that ends a command early; its text is the message.
type CliError = Box<dyn std::error::Error + Send + Sync>;

/// Returns an error with the name of its scene.
fn about(source: &scene::Source, error: impl std::fmt::Display) -> CliError {
    format!("{}: {error}", source.name.display()).into()
}

/// Messages of libraries that are printed without `RUST_LOG`. Errors of drivers are left out: they come back as values,
/// and those of adapters that cannot draw are printed only if no adapter can.
const LOG_FILTER: &str = "error,wgpu_hal=off,wgpu::backend=off";

/// Adds a hint to the error of a scene that was given instead of a command.
fn with_hint(mut error: clap::Error) -> clap::Error {
    if let Some(ContextValue::String(name)) = error.get(ContextKind::InvalidSubcommand)
        && (scene::registry::find(name).is_some() || Path::new(name).exists())
    {
        let solves = format!("this is a scene: `warpbeam solve {name}` solves it");
        let hint = if cfg!(feature = "app") { format!("{solves}, `warpbeam run {name}` opens it") } else { solves };
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![hint.into()]));
    }
    error
}

/// Runs a command. A defect of the program ends it as an error with a sentence, without a backtrace.
fn guarded(run: impl FnOnce() -> ExitCode) -> ExitCode {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|defect| {
        let place = defect.location().map_or_else(String::new, |at| format!(" at {}:{}", at.file(), at.line()));
        let message = defect.payload_as_str().unwrap_or("no message");
        eprintln!(
            "warpbeam: a defect of the program ended the command{place}: {message}; please report it with the command and \
             the scene"
        );
    }));
    let code = std::panic::catch_unwind(std::panic::AssertUnwindSafe(run)).unwrap_or(ExitCode::from(BAD_INPUT));
    std::panic::set_hook(hook);
    code
}

/// Returns the definition of the command line.
pub fn command() -> clap::Command {
    Cli::command()
}

/// Runs the command given by the process arguments.
pub fn main() -> ExitCode {
    guarded(run)
}

fn run() -> ExitCode {
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or(LOG_FILTER)).init();
    let command = Cli::try_parse().unwrap_or_else(|error| with_hint(error).exit()).command;
    #[cfg(all(feature = "app", target_os = "linux"))]
    if matches!(command, None | Some(Command::Run { .. } | Command::Shot(_) | Command::Record(_) | Command::Gpu(_))) {
        driver::silence();
    }
    #[cfg(all(feature = "app", windows))]
    let needs_dialog = matches!(command, None | Some(Command::Run { .. })) && explorer::leave_console();
    let result = match command {
        #[cfg(feature = "app")]
        None => window::run(shared_args::SceneArgs::default().into(), Path::new(args::DEFAULT_PICTURE), None, true),
        // Unreachable: clap requires a command.
        #[cfg(not(feature = "app"))]
        None => Ok(ExitCode::from(BAD_INPUT)),
        #[cfg(feature = "app")]
        Some(Command::Run { scene, output, adapter }) => {
            let is_default = scene.scene.is_none() && scene.assignments.is_empty();
            window::run(scene.into(), &output, adapter.adapter, is_default)
        }
        Some(Command::Scenes) => text::print(&text::scenes()).map(|()| ExitCode::SUCCESS),
        Some(Command::Solve(args)) => commands::solve(args),
        Some(Command::Curve(args)) => commands::curve(args),
        Some(Command::Section(args)) => section::section(args),
        Some(Command::Study { scene, out }) => commands::study(&scene.into(), &out),
        Some(Command::Limits(args)) => limits::limits(args),
        Some(Command::Tune(args)) => commands::tune(args),
        Some(Command::Extremes { out }) => commands::extremes(&out),
        #[cfg(feature = "app")]
        Some(Command::Shot(args)) => window::shot(args),
        #[cfg(feature = "app")]
        Some(Command::Record(args)) => window::record(args),
        #[cfg(feature = "app")]
        Some(Command::Gpu(args)) => window::gpu(args.adapter.as_deref()),
    };
    result.unwrap_or_else(|error| {
        eprintln!("warpbeam: {error}");
        #[cfg(all(feature = "app", windows))]
        if needs_dialog {
            explorer::show_error(&error.to_string());
        }
        #[cfg(feature = "app")]
        if let Some(crate::app::AppError::Render(error)) = error.downcast_ref()
            && error.is_missing_adapter()
        {
            return ExitCode::from(NO_ADAPTER);
        }
        ExitCode::from(BAD_INPUT)
    })
}

/// Rejects a file name with another suffix than the expected one, which includes the dot.
fn check_suffix(path: &Path, expected: &str) -> Result<(), CliError> {
    let suffix = path.extension().and_then(|e| e.to_str()).map(|e| format!(".{e}"));
    match suffix.is_some_and(|suffix| suffix.eq_ignore_ascii_case(expected)) {
        true => Ok(()),
        false => Err(format!("{}: expected a name that ends in {expected}", path.display()).into()),
    }
}

/// Rejects an option for a scene whose analysis it does not support.
fn check_fit(
    (source, scene): (&scene::Source, &Scene),
    (option, given): (&'static str, bool),
    moves: bool,
    reason: &'static str,
) -> Result<(), CliError> {
    let fits = (scene.analysis == Analysis::Dynamic) == moves;
    let expected = if moves { "dynamic" } else { "static" };
    let refusal = || format!("expected a scene with analysis = \"{expected}\" for {option}: {reason}");
    if given && !fits { Err(about(source, refusal())) } else { Ok(()) }
}

/// Computes the sections that the scene lists.
fn sections_of(source: &scene::Source, simulation: &Simulation) -> Result<Vec<Section>, CliError> {
    let sections = simulation.scene_sections().into_iter().enumerate();
    let located = |i: usize, error: SectionError| about(source, format_args!("section.{i}: {error}"));
    sections.map(|(i, section)| section.map_err(|error| located(i, error))).collect()
}

/// Opens a scene, and sets up its simulation.
fn simulate(source: &scene::Source) -> Result<(Scene, Simulation), CliError> {
    let scene = scene::open(source)?;
    let simulation = Simulation::new(&scene).map_err(|error| refused(source, error))?;
    warn_of_mesh(source, &scene, simulation.system());
    Ok((scene, simulation))
}

/// Opens a scene, and checks that it can be simulated.
fn validated(source: &scene::Source) -> Result<(Scene, Arc<System>), CliError> {
    let scene = scene::open(source)?;
    let problem = System::for_display(&scene).and_then(|system| Problem::new(&scene, Arc::new(system)));
    let problem = problem.map_err(|error| refused(source, error))?;
    warn_of_mesh(source, &scene, problem.system());
    Ok((scene, problem.system().clone()))
}

/// Adds the place in the scene file to the reason for which a scene cannot be simulated.
fn refused(source: &scene::Source, error: SimulationError) -> CliError {
    match error {
        SimulationError::Scene(invalid) => scene::locate(source, invalid).into(),
        error => about(source, error),
    }
}

/// Prints warnings about the mesh file of a scene: that it seems to be in millimetres, its seams, and that it does not
/// exist, so that the mesh of a built-in scene is used. The unit of a built-in mesh is known.
fn warn_of_mesh(source: &scene::Source, scene: &Scene, system: &System) {
    /// Size above which a body is suspicious, m.
    const LARGE: f64 = 50.0;
    if source.built_in().is_some() {
        return;
    }
    let (size, mesh) = (system.size(), scene.mesh.as_ref());
    if let Some(MeshFile { file, .. }) = mesh.filter(|mesh| mesh.scale.is_none() && size > LARGE) {
        let advice = "if it is in millimetres, write scale = 0.001 under [mesh], else scale = 1";
        eprintln!("warpbeam: warning: {file} is {} m across; {advice}", number(size.round()));
    }
    system.seams().iter().for_each(|seam| eprintln!("warpbeam: warning: {seam}"));
    if let Some(file) = mesh.map(|mesh| &mesh.file)
        && scene::built_in_mesh(file, &source.folder()).is_some()
    {
        let stand_in = "the built-in mesh of this name is used";
        eprintln!("warpbeam: warning: {file} does not exist in the folder of the scene; {stand_in}");
    }
}

/// Returns the exit code of a command that ran; `is_done` is `true` if it converged, and was not interrupted.
fn exit_code(is_done: bool) -> ExitCode {
    if is_done { ExitCode::SUCCESS } else { ExitCode::from(NOT_CONVERGED) }
}

/// Returns the exit code of a command that may have been interrupted; prints what is missing if it was.
fn ended(interrupted: bool, missing: &str) -> ExitCode {
    if interrupted {
        eprintln!("warpbeam: interrupted: {missing}");
    }
    exit_code(!interrupted)
}

/// Returns the exit code of a picture or a recording of a scene; prints the reason why its simulation failed, if it did.
#[cfg(feature = "app")]
fn drawn(status: &Status) -> ExitCode {
    if let Some(reason) = status.failure() {
        eprintln!("warpbeam: {}: {reason}", status.word());
    }
    exit_code(status.is_success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_defect_is_an_error_with_its_own_exit_code() {
        let code = |run: fn() -> ExitCode| format!("{:?}", guarded(run));
        assert_eq!(code(|| std::panic::panic_any("meant")), format!("{:?}", ExitCode::from(BAD_INPUT)));
        assert_eq!(code(|| ExitCode::SUCCESS), format!("{:?}", ExitCode::SUCCESS));
    }
}

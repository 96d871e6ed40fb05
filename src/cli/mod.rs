//! The commands: `run`, `scenes`, `solve`, `curve`, `study`, `extremes`, `shot`.
//!
//! Exit codes: 0 done and converged, 1 ran but did not converge, 2 bad input or usage, 3 no graphics adapter.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};

use crate::app;
use crate::export::{self, ExportError, Format};
use crate::render::{RenderError, draw_svg};
use crate::scene::{self, MethodKind, Scene, SceneError, registry};
use crate::simulation::{Simulation, SimulationError, Status};
use crate::study::{Choice, Extent, LoadCurve, Progress, Study, StudyError, extremes, plot};
use crate::truth::Truth;

mod report;

/// Ran, but did not converge.
const NOT_CONVERGED: u8 = 1;
/// Bad input or usage.
const BAD_INPUT: u8 = 2;
/// No usable graphics adapter.
const NO_ADAPTER: u8 = 3;

const EXIT_CODES: &str = "Exit codes: 0 done and converged, 1 ran but did not converge (the result is still printed), \
2 bad input or usage, 3 no usable graphics adapter.";

/// A lab for the warped stiffness (corotational finite element) method on 2D triangle beams.
///
/// Without a command: the window.
#[derive(Debug, Parser)]
#[command(name = "warpbeam", version, after_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Open the window. Without a display: solve the scene, write a picture, exit 0.
    #[command(after_help = EXIT_CODES)]
    Run {
        #[command(flatten)]
        scene: SceneArgs,
        /// The picture written where there is no display.
        #[arg(short, long, value_name = "OUT.png", default_value = "warpbeam.png")]
        output: PathBuf,
    },
    /// List the built-in scenes.
    Scenes,
    /// Find the equilibrium of a scene, without a window.
    #[command(after_help = EXIT_CODES)]
    Solve {
        #[command(flatten)]
        scene: RequiredSceneArgs,
        /// Print one JSON object, and nothing else, on standard output.
        #[arg(long)]
        json: bool,
        /// Also write the nodes (.csv) or the mesh with its fields (.vtu, for ParaView).
        #[arg(long, value_name = "FILE.csv|.vtu")]
        out: Option<PathBuf>,
    },
    /// Print load against deflection of a cantilever: linear theory, the truth, every method, and where linear theory
    /// leaves the truth by 3, 5 and 10 percent.
    Curve {
        #[command(flatten)]
        scene: RequiredSceneArgs,
        /// Also write the curve as a table.
        #[arg(long, value_name = "FILE.csv")]
        out: Option<PathBuf>,
    },
    /// Measure error against time on this machine, for every element, mesh, method and number of iterations: a table
    /// (study.csv), a plot with the Pareto front (study.svg and .png) and a summary (study.txt).
    Study(StudyArgs),
    /// Solve at the extremes of load, stiffness, Poisson ratio, slenderness and starting state, and count how each method
    /// ends: a table (extremes.csv), a heat map (extremes.svg and .png) and a summary.
    Extremes {
        /// The folder to write to; made if it is not there.
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
        /// A few hundred cases instead of a few thousand.
        #[arg(long)]
        quick: bool,
    },
    /// Draw the picture the window shows into a PNG file, without a window.
    #[command(after_help = EXIT_CODES)]
    Shot {
        #[command(flatten)]
        scene: RequiredSceneArgs,
        /// The picture to write.
        #[arg(short, long, value_name = "OUT.png")]
        output: PathBuf,
        /// Its size in pixels, 64x64 to 8192x8192.
        #[arg(long, value_name = "WxH", default_value = "1280x800", value_parser = parse_size)]
        size: [u32; 2],
        /// Only the view, without the panel.
        #[arg(long)]
        no_panel: bool,
        /// With the load–deflection curve.
        #[arg(long)]
        curve: bool,
        /// With error against time, measured now.
        #[arg(long, conflicts_with = "curve")]
        study: bool,
        /// Light or dark.
        #[arg(long, value_enum, default_value_t = app::ThemeChoice::Dark)]
        theme: app::ThemeChoice,
    },
}

#[derive(Debug, Args)]
struct SceneArgs {
    /// A built-in scene (see `warpbeam scenes`) or a scene file.
    #[arg(default_value = registry::DEFAULT)]
    scene: String,
    #[command(flatten)]
    set: SetArgs,
}

#[derive(Debug, Args)]
struct RequiredSceneArgs {
    /// A built-in scene (see `warpbeam scenes`) or a scene file.
    scene: String,
    #[command(flatten)]
    set: SetArgs,
}

#[derive(Debug, Args)]
struct StudyArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The folder to write to; made if it is not there.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Without the finer meshes.
    #[arg(long)]
    quick: bool,
    /// Also how long rapier2d's soft bodies take for the same (rivals.csv).
    #[cfg(feature = "rivals")]
    #[arg(long)]
    rivals: bool,
}

#[derive(Debug, Args)]
struct SetArgs {
    /// Change a value of the scene: material.young=2e6, beam.cells=[40,2], load.0.force=[0,-5].
    #[arg(long = "set", value_name = "PATH=VALUE")]
    assignments: Vec<String>,
}

impl From<SceneArgs> for scene::Source {
    fn from(args: SceneArgs) -> Self {
        Self { name: args.scene, assignments: args.set.assignments }
    }
}

impl From<RequiredSceneArgs> for scene::Source {
    fn from(args: RequiredSceneArgs) -> Self {
        Self { name: args.scene, assignments: args.set.assignments }
    }
}

/// Anything that ends a command early.
#[derive(Debug, thiserror::Error)]
enum CliError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error("{scene}: {error}")]
    Simulation { scene: String, error: SimulationError },
    #[error("{scene}: {error}")]
    Study { scene: String, error: StudyError },
    #[error(
        "{0}: expected a beam clamped left and loaded on its right edge or by its weight; no truth is known for this scene"
    )]
    NoTruth(String),
    #[error(transparent)]
    Export(#[from] ExportError),
    #[error(transparent)]
    Render(#[from] RenderError),
    #[error(transparent)]
    App(#[from] app::AppError),
}

impl CliError {
    fn exit_code(&self) -> u8 {
        match self {
            Self::Render(error) | Self::App(app::AppError::Render(error)) if error.is_missing_adapter() => NO_ADAPTER,
            _ => BAD_INPUT,
        }
    }
}

/// Runs the command that the process was started with.
#[must_use]
pub fn main() -> ExitCode {
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("error,wgpu_hal=off")).init();
    let cli = Cli::parse();
    let command = cli.command.unwrap_or_else(|| Command::Run {
        scene: SceneArgs { scene: registry::DEFAULT.to_owned(), set: SetArgs { assignments: Vec::new() } },
        output: PathBuf::from("warpbeam.png"),
    });
    let result = match command {
        Command::Run { scene, output } => run(scene.into(), &output),
        Command::Scenes => {
            report::print(&report::scenes());
            Ok(ExitCode::SUCCESS)
        }
        Command::Solve { scene, json, out } => solve(&scene.into(), json, out.as_deref()),
        Command::Curve { scene, out } => curve(&scene.into(), out.as_deref()),
        Command::Study(args) => study(args),
        Command::Extremes { out, quick } => extremes(&out, quick),
        Command::Shot { scene, output, size, no_panel, curve, study, theme } => {
            shot(scene.into(), &output, &app::ShotOptions { size, panel: !no_panel, curve, study, theme })
        }
    };
    result.unwrap_or_else(|error| {
        eprintln!("warpbeam: {error}");
        ExitCode::from(error.exit_code())
    })
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let expected = || format!("expected WIDTHxHEIGHT, each from 64 to {}, as in 1280x800", app::MAX_SHOT_SIDE);
    let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(expected)?;
    let side = |text: &str| match text.trim().parse() {
        Ok(side) if (64..=app::MAX_SHOT_SIDE).contains(&side) => Ok(side),
        _ => Err(expected()),
    };
    Ok([side(width)?, side(height)?])
}

fn simulate(source: &scene::Source) -> Result<(Scene, Simulation), CliError> {
    let scene = scene::open(source)?;
    let simulation = set_up(source, &scene)?;
    Ok((scene, simulation))
}

fn set_up(source: &scene::Source, scene: &Scene) -> Result<Simulation, CliError> {
    Simulation::new(scene).map_err(|error| CliError::Simulation { scene: source.name.clone(), error })
}

fn exit_code(status: &Status) -> ExitCode {
    if *status == Status::Converged { ExitCode::SUCCESS } else { ExitCode::from(NOT_CONVERGED) }
}

/// Measures what a scene that leaves the choice of element, mesh and method open asks for. `None` where it does not, or
/// where nothing can be measured: then its own mesh has to do.
fn choose(source: &scene::Source, scene: &Scene) -> Result<Option<Choice>, CliError> {
    if scene.solver.method != MethodKind::Auto {
        return Ok(None);
    }
    match Choice::of(scene, &mut watch()) {
        Ok(choice) => Ok(Some(choice)),
        Err(error @ (StudyError::NoProbe | StudyError::NoTruth)) => {
            eprintln!("warpbeam: auto keeps the scene's own mesh: {error}");
            Ok(None)
        }
        Err(error) => Err(CliError::Study { scene: source.name.clone(), error }),
    }
}

fn solve(source: &scene::Source, json: bool, out: Option<&Path>) -> Result<ExitCode, CliError> {
    // A wrong file name is said before the work, not after.
    out.map(Format::of).transpose()?;
    let (mut scene, mut simulation) = simulate(source)?;
    let choice = choose(source, &scene)?;
    if let Some(choice) = &choice {
        scene = choice.chosen.setting.apply(&scene);
        simulation = set_up(source, &scene)?;
    }
    let status = simulation.solve().clone();
    if let Some(path) = out {
        export::write(&simulation, path)?;
    }
    let solution = simulation.solution(Truth::of(&scene).as_ref());
    let choice = choice.as_ref();
    report::print(&if json {
        report::json(&scene, &solution, choice)
    } else {
        report::text(&scene, &solution, choice)
    });
    // A demand that is not met is a result that falls short of what was asked.
    let met = choice.is_none_or(|c| c.met);
    Ok(if met { exit_code(&status) } else { ExitCode::from(NOT_CONVERGED) })
}

fn curve(source: &scene::Source, out: Option<&Path>) -> Result<ExitCode, CliError> {
    let (scene, _) = simulate(source)?;
    let curve = LoadCurve::new(&scene).ok_or_else(|| CliError::NoTruth(source.name.clone()))?;
    if let Some(path) = out {
        export::write_text(path, &report::curve_table(&curve))?;
    }
    report::print(&report::curve(&scene, &curve));
    Ok(ExitCode::SUCCESS)
}

fn extent(quick: bool) -> Extent {
    if quick { Extent::Quick } else { Extent::Full }
}

/// Tells people who wait how far a study is; scripts get clean streams.
fn watch() -> impl FnMut(Progress<'_>) -> ControlFlow<()> {
    let watched = std::io::IsTerminal::is_terminal(&std::io::stderr());
    move |progress| {
        if watched && !progress.now.is_empty() {
            eprintln!("measuring {}", progress.now);
        }
        ControlFlow::Continue(())
    }
}

/// Writes a folder of texts, and one of them, an SVG picture, as PNG too.
fn write_folder(out: &Path, texts: &[(&str, &str)], picture: &str) -> Result<(), CliError> {
    std::fs::create_dir_all(out).map_err(|source| ExportError::Write { path: out.display().to_string(), source })?;
    for (name, text) in texts {
        let path = out.join(name);
        export::write_text(&path, text)?;
        if *name == picture {
            draw_svg(text)?.write_png(&path.with_extension("png"))?;
        }
    }
    Ok(())
}

fn study(args: StudyArgs) -> Result<ExitCode, CliError> {
    let source = scene::Source::from(args.scene);
    let (scene, _) = simulate(&source)?;
    let failed = |error| CliError::Study { scene: source.name.clone(), error };
    let extent = extent(args.quick);
    let study = Study::new(&scene, extent, &mut watch()).map_err(failed)?;
    #[cfg_attr(not(feature = "rivals"), expect(unused_mut, reason = "rivals add to it"))]
    let mut summary = study.summary();
    #[cfg(feature = "rivals")]
    if args.rivals {
        use crate::study::rivals;
        match rivals::rivals(&scene, extent).map_err(failed)? {
            Some(rivals) => {
                write_folder(&args.out, &[("rivals.csv", &rivals::table(&rivals))], "")?;
                summary.push('\n');
                summary.push_str(&rivals::summary(&rivals));
            }
            None => summary
                .push_str("\nrapier2d holds nodes in both directions and knows no follower moments: not measured\n"),
        }
    }
    let texts = [("study.csv", study.table()), ("study.svg", plot::svg(&study)), ("study.txt", summary.clone())];
    write_folder(&args.out, &texts.each_ref().map(|(name, text)| (*name, text.as_str())), "study.svg")?;
    report::print(&summary);
    Ok(ExitCode::SUCCESS)
}

fn extremes(out: &Path, quick: bool) -> Result<ExitCode, CliError> {
    let cases = extremes::cases(extent(quick));
    let mut entries = Vec::with_capacity(cases.len());
    for case in cases {
        let broken = |error| CliError::Simulation { scene: format!("{case:?}"), error };
        entries.push(case.solve().map_err(broken)?);
    }
    let (table, svg, summary) = (extremes::table(&entries), extremes::heat_map(&entries), extremes::summary(&entries));
    let texts = [("extremes.csv", table.as_str()), ("extremes.svg", &svg), ("extremes.txt", &summary)];
    write_folder(out, &texts, "extremes.svg")?;
    report::print(&summary);
    Ok(ExitCode::SUCCESS)
}

fn shot(source: scene::Source, output: &Path, options: &app::ShotOptions) -> Result<ExitCode, CliError> {
    let (scene, simulation) = simulate(&source)?;
    let status = app::shot(source, scene, simulation, options, output)?;
    if let Status::NotConverged(reason) | Status::Diverged(reason) = &status {
        eprintln!("warpbeam: {}: {reason}", status.id());
    }
    Ok(exit_code(&status))
}

fn run(source: scene::Source, output: &Path) -> Result<ExitCode, CliError> {
    let (scene, simulation) = simulate(&source)?;
    match app::Display::open() {
        Ok(display) => app::run(display, source, scene, simulation)?,
        Err(reason) => {
            let picture = output.display();
            report::print(&format!(
                "No window: {reason}.\nSolving the scene instead; the picture goes to {picture}.\n"
            ));
            solve(&source, false, None)?;
            app::shot(source, scene, simulation, &app::ShotOptions::default(), output)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

//! Command line arguments of `warpbeam`.

use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};

use super::CliError;
use super::shared_args::{OutputArgs, SceneArgs, or_default};
#[cfg(feature = "app")]
use crate::app::{AdapterArgs, RecordOptions, ShotOptions};
use crate::scene::keys::range;
use crate::scene::limits::{BUDGET_MS, COORDINATE, ROTATION};
use crate::scene::units::within;
use crate::study::Extent;

const EXIT_CODES: &str = "Exit codes: 0 done (converged, or accepted after solver.accept_after iterations), \
1 did not converge, was interrupted, or gained more than 10 % of the energy put in from its integrator \
(the result is still printed), \
2 bad input or usage, a result that could not be written, or a defect of the program, 3 no usable graphics adapter.";

const SOLVE_FILES: &str = "--out of a static scene:
  .csv  a row per node: node, rest_x, rest_y, x, y, u_x, u_y (m), rotation_deg
          (that of the strains: 0 in linear theory),
          strain_xx, _yy, _zz, _xy (Biot), stress_xx, _yy, _zz, _xy (Cauchy, Pa),
          von_mises (Cauchy, Pa), file_node (its number in the mesh file)
  .vtu  the mesh and its fields, for ParaView: at points displacement, strain,
        stress, von Mises, node numbers, named edges; of cells rotation,
        energy density, largest strain, mesh error
--out of a scene in motion (analysis = \"dynamic\"):
  .csv  a row per time step. Columns: t (s); for every probe NAME
          NAME_x, NAME_y, NAME_u_x, NAME_u_y (m), NAME_v_x, NAME_v_y (m/s);
        then energies (J):
          kinetic, elastic, potential, dissipated, integrator (energy lost by it),
          pulses and mouse_spring (work of pulses and of the mouse spring)
  .pvd  a ParaView collection of FILE_0000.vtu, FILE_0001.vtu, ... next to it:
        at most about 300 states, evenly spread in time
  .vtu  the last state

Ctrl-C ends a motion early: its files are valid, the result is printed with status `stopped`, exit code 1.
";

/// A lab for the warped stiffness (corotational finite element) method on 2D beams of triangles
/// and quadrilaterals.
#[derive(Debug, Parser)]
#[command(name = "warpbeam", version, after_help = EXIT_CODES)]
#[cfg_attr(feature = "app", command(before_help = "Without a command, the window opens."))]
#[cfg_attr(not(feature = "app"), command(subcommand_required = true, arg_required_else_help = true))]
pub(super) struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Open the window. Without a display, solve the scene and write an image.
    #[cfg(feature = "app")]
    #[command(after_help = EXIT_CODES, mut_arg("scene", or_default))]
    Run {
        #[command(flatten)]
        scene: SceneArgs,
        /// Image file written if there is no display.
        #[arg(short, long, value_name = "OUT.png", default_value = DEFAULT_PICTURE)]
        output: PathBuf,
        #[command(flatten)]
        adapter: AdapterArgs,
    },
    /// List the built-in scenes.
    Scenes,
    /// Compute the equilibrium of a static scene, or the motion of a dynamic one to the end of its duration.
    #[command(after_help = format!("{SOLVE_FILES}\n{EXIT_CODES}"))]
    Solve(SolveArgs),
    /// Print the load path of a scene: its equilibria as loads and prescribed displacements grow, the largest reaction of a
    /// moving support, where they lose their stability, and where the body jumps. For a cantilever also: linear theory, the
    /// exact beam, every method, and the loads at which linear theory differs from the exact beam by 3, 5 and 10 percent. The
    /// picture shows the load path, over the displacement of the moving support or over the load; unstable states are dashed.
    Curve(CurveArgs),
    /// Compute the forces in a cut through the body: normal force N, shear force V and bending moment M, which the part
    /// in front of the cut exerts on the part behind, and the stress along the cut beside that of beam theory. With
    /// --along, N, V and M along a beam. The picture shows the stress along the cut, or N, V and M along the beam.
    #[command(after_help = EXIT_CODES)]
    Section(SectionArgs),
    /// Measure error against time on this machine, for every element, mesh, method and number of iterations: a table
    /// (study.csv), a plot with the Pareto front (study.svg) and a summary (study.txt). For a dynamic scene:
    /// the error of the first probe's path against the computing time per simulated second, also for every integrator
    /// and time step, with the energy drift.
    #[command(mut_arg("scene", or_default))]
    Study {
        #[command(flatten)]
        scene: SceneArgs,
        #[command(flatten)]
        out: FolderArgs,
    },
    /// Find the loads up to which each method and element holds on the cells of a static scene, from a hundredth to ten
    /// times its load: within 1 % and 5 % of the reference solution, converged, and with strains below 10 %. For a dynamic
    /// scene, find the time steps up to which each integrator does, from a sixteenth to eight times its own. The table has
    /// a row for each load or time step; the picture shows the load curve, and below it a strip for each method and
    /// element, or for each integrator.
    Limits(LimitsArgs),
    /// Choose element, mesh and method of a static scene for a required error and time: measure finer and finer meshes
    /// on this machine until both are met, and print the choice and the reason. Every solve runs to its end; `study`
    /// also measures solves that stop early.
    #[command(
        after_help = "Exit codes: 0 both are met, 1 no setting meets them (the best one is printed), 2 bad input or usage."
    )]
    Tune(TuneArgs),
    /// Solve at extremes of load, stiffness, Poisson ratio, slenderness, cells and initial state, and on mesh files,
    /// and count the outcomes of each method: a table (extremes.csv), a heat map (extremes.svg) and a summary.
    /// The same for every integrator in motion, at extremes of stiffness, time step and weight: extremes-motion.csv
    /// and .svg.
    Extremes {
        #[command(flatten)]
        out: FolderArgs,
    },
    /// Write the image shown in the window to a PNG file, without a window.
    #[cfg(feature = "app")]
    #[command(after_help = EXIT_CODES)]
    Shot(ShotArgs),
    /// Record a dynamic scene, or the iterations of a static one (one per frame), without a window: an animated GIF, or
    /// numbered images.
    #[cfg(feature = "app")]
    #[command(after_help = format!("{RECORD_NOTES}\n{EXIT_CODES}"))]
    Record(RecordArgs),
    /// List the graphics adapters in the order in which they are tried: name, backend, driver, whether the adapter is
    /// usable or why not, and which one is used. An adapter of hardware is preferred to software, and Vulkan, Metal and
    /// DirectX 12 to OpenGL. In a window, the adapter must also be able to draw into it.
    #[cfg(feature = "app")]
    #[command(after_help = EXIT_CODES)]
    Gpu(AdapterArgs),
}

#[derive(Debug, Default, Args)]
pub(super) struct SolveArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Print one JSON object, and nothing else, on standard output.
    #[arg(long)]
    pub json: bool,
    /// Also write a table (.csv), the mesh with its fields (.vtu) or, for a motion, a series of them (.pvd); see below.
    #[arg(long, value_name = "FILE.csv|.vtu|.pvd")]
    pub out: Option<PathBuf>,
    /// Reference solution against which errors are measured. `bounded`: meshes of up to about 10,000 unknowns, a second
    /// or two; `full`: meshes fine enough for an error of 0.01 %; `none`: no reference solution and no errors.
    #[arg(long, value_parser = reference_parser(), default_value = "bounded")]
    pub reference: std::option::Option<Extent>,
    /// Certify the result, whatever the size of the scene: stability, spectral radius ρ of the warped iteration, and
    /// jumps on the load path to it.
    #[arg(long)]
    pub certificate: bool,
    /// Do not certify the result. Certification takes some solves, and is omitted beyond 100,000 unknowns anyway.
    #[arg(long, conflicts_with = "certificate")]
    pub no_certificate: bool,
}

/// Returns the parser of the extent of the search for a reference solution; `None` for no reference.
fn reference_parser() -> impl TypedValueParser<Value = Option<Extent>> {
    PossibleValuesParser::new(["none", "bounded", "full"]).map(|cost| match cost.as_str() {
        "none" => None,
        "full" => Some(Extent::Full),
        _ => Some(Extent::Quick),
    })
}

#[derive(Debug, Args)]
pub(super) struct CurveArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    #[command(flatten)]
    pub outputs: OutputArgs,
    /// Quantity in the figure: `PROBE.x` or `PROBE.y` for a component of a probe's displacement, `PROBE.path` for one
    /// over the other, `PROBE` for its length, or `support.N` for the reaction of a support. Default: the reaction of
    /// the moving support, or the larger component of the first probe.
    #[arg(long, value_name = "NAME", requires = "picture")]
    pub of: Option<String>,
}

#[derive(Debug, Args)]
pub(super) struct SectionArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Point of the cut on the body at rest: X and Y, or X alone if the line crosses the body in one place. Numbers are
    /// in m, or have units: --at "30 mm,2 mm". Default: the sections of the scene.
    #[arg(long, value_name = "X[,Y]", value_parser = parse_place, allow_hyphen_values = true)]
    pub at: Option<(f64, Option<f64>)>,
    /// Direction of the cut's normal, counter-clockwise from the x axis, with --at: 30deg, or a number of radians. The normal
    /// points to the part in front.
    #[arg(long, value_name = "ANGLE", value_parser = within(ROTATION), default_value = "0deg", requires = "at", allow_hyphen_values = true)]
    pub angle: f64,
    /// Print N, V and M in this number of sections normal to the axis of a beam, evenly spaced from end to end.
    #[arg(long, value_name = "COUNT", conflicts_with_all = ["at", "angle"], value_parser = clap::value_parser!(u16).range(2..=1000))]
    pub along: Option<u16>,
    /// Print one JSON object, and nothing else, on standard output.
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub outputs: OutputArgs,
}

fn parse_place(text: &str) -> Result<(f64, Option<f64>), CliError> {
    let coordinate = within(COORDINATE);
    let (x, y) = text.split_once(',').map_or((text, None), |(x, y)| (x, Some(y)));
    Ok((coordinate(x)?, y.map(coordinate).transpose()?))
}

#[derive(Debug, Args)]
pub(super) struct LimitsArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Print one JSON object, and nothing else, on standard output.
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub outputs: OutputArgs,
}

#[derive(Debug, Args)]
pub(super) struct FolderArgs {
    /// Folder to write to; created if necessary.
    #[arg(long = "out", value_name = "DIR")]
    pub folder: PathBuf,
    /// Measure less, in less time: coarser meshes, fewer cases.
    #[arg(long)]
    pub quick: bool,
}

#[derive(Debug, Args)]
pub(super) struct TuneArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Largest error, percent of the exact displacement of the first probe: 1% or 1. Without --time and --error: 1%.
    #[arg(long, value_name = "PERCENT", value_parser = within(const { range("solver.max_error_percent") }))]
    pub error: Option<f64>,
    /// Longest time of a solve from rest: 0.5ms, 200us, 2s, or a number of milliseconds.
    #[arg(long, value_name = "TIME", value_parser = within(BUDGET_MS))]
    pub time: Option<f64>,
    /// Save the scene with the chosen setting; the rest of its text stays as it is.
    #[arg(long, value_name = "FILE.toml")]
    pub write: Option<PathBuf>,
}

/// Default image file if there is no display.
#[cfg(feature = "app")]
pub(super) const DEFAULT_PICTURE: &str = "warpbeam.png";

/// Notes about files in `record --help`.
#[cfg(feature = "app")]
pub(super) const RECORD_NOTES: &str = "\
OUT.gif loops forever and has one palette of 256 colours. GIF frame times are hundredths of a second: if --fps does \
not fit, the nearest rate is used and printed.
A name without extension is a folder for images in full colour, frame-0001.png, frame-0002.png, ..., ready for
  ffmpeg -framerate 25 -i FOLDER/frame-%04d.png -pix_fmt yuv420p OUT.mp4

Camera and colour range fit the whole motion, which is computed once before it is drawn.
Ctrl-C ends with a shorter, valid recording and exit code 1.
";

#[cfg(feature = "app")]
#[derive(Debug, Args)]
pub(super) struct ShotArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Image file to write.
    #[arg(short, long, value_name = "OUT.png")]
    pub output: PathBuf,
    #[command(flatten)]
    pub options: ShotOptions,
}

#[cfg(feature = "app")]
#[derive(Debug, Args)]
#[command(mut_arg("scene", |scene| scene.required(false).required_unless_present("story")))]
pub(super) struct RecordArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Record the story of the window's first start, 20 s on the default scene, in place of a scene.
    #[arg(long, conflicts_with_all = ["scene", "assignments", "seconds", "speed"])]
    pub story: bool,
    /// File or folder to write.
    #[arg(short, long, value_name = "OUT.gif|FOLDER")]
    pub output: PathBuf,
    #[command(flatten)]
    pub options: RecordOptions,
}

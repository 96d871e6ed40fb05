//! The commands that need no window.

use std::ops::ControlFlow;
use std::path::Path;
use std::process::ExitCode;

use super::args::{FolderArgs, SolveArgs, TuneArgs};
use super::{CliError, NOT_CONVERGED, exit_code, json, simulate, text};
use crate::export::{self, ExportError, Format};
use crate::picture::draw_svg;
use crate::scene::{self, Analysis, Scene};
use crate::study::{
    Demand, Extent, LoadCurve, MotionStudy, Progress, Reference, Study, StudyError, Tuning, extremes, heat_map,
    motion_heat_map, plot,
};

pub(super) fn solve(args: SolveArgs) -> Result<ExitCode, CliError> {
    let SolveArgs { scene, json, out, no_truth } = args;
    // A wrong file name is said before the work, not after.
    out.as_deref().map(Format::of).transpose()?;
    let (scene, mut simulation) = simulate(&scene.into())?;
    let status = simulation.solve().clone();
    simulation.certify();
    if let Some(path) = &out {
        export::write(&simulation, path)?;
    }
    // A scene without a truth has a result all the same.
    let truth = if no_truth { None } else { Reference::of(&scene).ok() };
    let solution = simulation.solution();
    text::print(&if json {
        json::solution(&scene, &solution, truth.as_ref())
    } else {
        text::solution(&scene, &solution, truth.as_ref())
    });
    Ok(exit_code(&status))
}

pub(super) fn curve(source: &scene::Source, out: Option<&Path>) -> Result<ExitCode, CliError> {
    let (scene, _) = simulate(source)?;
    let curve = LoadCurve::new(&scene).ok_or_else(|| CliError::NoBeam(source.name.clone()))?;
    if let Some(path) = out {
        export::write_text(path, &text::curve_table(&curve))?;
    }
    text::print(&text::curve(&scene, &curve));
    Ok(ExitCode::SUCCESS)
}

pub(super) fn study(source: &scene::Source, out: &FolderArgs) -> Result<ExitCode, CliError> {
    let (scene, _) = simulate(source)?;
    let (table, svg, summary) = match scene.analysis {
        Analysis::Static => {
            let study = Study::new(&scene, extent(out), &mut observer()).map_err(failed(source))?;
            (study.table(), plot::svg(&study), study.summary())
        }
        Analysis::Dynamic => {
            let study = MotionStudy::new(&scene, extent(out), &mut observer()).map_err(failed(source))?;
            (study.table(), plot::motion_svg(&study), study.summary())
        }
    };
    let texts = [("study.csv", table.as_str()), ("study.svg", &svg), ("study.txt", &summary)];
    write_folder(&out.folder, &texts, "study.svg")?;
    text::print(&summary);
    Ok(ExitCode::SUCCESS)
}

pub(super) fn tune(args: TuneArgs) -> Result<ExitCode, CliError> {
    let TuneArgs { scene, error, time, write } = args;
    let source = scene::Source::from(scene);
    let (scene, _) = simulate(&source)?;
    let error = if time.is_none() { error.or(Some(1.0)) } else { error };
    let demand = Demand { max_error_percent: error, max_time_ms: time };
    let tuning = Tuning::of(&scene, demand, &mut observer()).map_err(failed(&source))?;
    if let Some(path) = &write {
        export::write_text(path, &tuned(&scene, &tuning, &source, path).to_toml()?)?;
    }
    text::print(&format!("{tuning}\n"));
    Ok(if tuning.met { ExitCode::SUCCESS } else { ExitCode::from(NOT_CONVERGED) })
}

/// The scene with what was chosen, to be written to `path`.
fn tuned(scene: &Scene, tuning: &Tuning, source: &scene::Source, path: &Path) -> Scene {
    let mut tuned = tuning.chosen.setting.apply(scene);
    if let (Some(mesh), false) = (&mut tuned.mesh, scene::registry::find(&source.name).is_some()) {
        // The mesh is named relative to the scene file, which is another one now.
        let folder = |path: &Path| path.parent().and_then(|folder| std::path::absolute(folder).ok());
        let old = folder(Path::new(&source.name));
        if let Some(old) = old.filter(|old| Some(old) != folder(path).as_ref()) {
            mesh.file = old.join(&mesh.file).display().to_string();
        }
    }
    tuned
}

pub(super) fn extremes(out: &FolderArgs) -> Result<ExitCode, CliError> {
    let cases = extremes::cases(extent(out));
    let mut entries = Vec::with_capacity(cases.len());
    for case in cases {
        let broken = |error| CliError::Simulation { scene: format!("{case:?}"), error };
        entries.push(case.solve().map_err(broken)?);
    }
    let mut motions = Vec::new();
    for case in extremes::motion::cases(extent(out)) {
        let broken = |error| CliError::Simulation { scene: format!("{case:?}"), error };
        motions.push(case.run().map_err(broken)?);
    }
    let summary = format!("{}\n{}", extremes::summary(&entries), extremes::motion::summary(&motions));
    let (table, svg) = (extremes::table(&entries), heat_map(&entries));
    let texts = [("extremes.csv", table.as_str()), ("extremes.svg", &svg), ("extremes.txt", &summary)];
    write_folder(&out.folder, &texts, "extremes.svg")?;
    let (table, svg) = (extremes::motion::table(&motions), motion_heat_map(&motions));
    let texts = [("extremes-motion.csv", table.as_str()), ("extremes-motion.svg", &svg)];
    write_folder(&out.folder, &texts, "extremes-motion.svg")?;
    text::print(&summary);
    Ok(ExitCode::SUCCESS)
}

fn failed(source: &scene::Source) -> impl Fn(StudyError) -> CliError {
    |error| CliError::Study { scene: source.name.clone(), error }
}

fn extent(out: &FolderArgs) -> Extent {
    if out.quick { Extent::Quick } else { Extent::Full }
}

/// Tells people who wait how far a study is; scripts get clean streams.
fn observer() -> impl FnMut(Progress<'_>) -> ControlFlow<()> {
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

//! The commands that need no window.

use std::ops::ControlFlow;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use super::args::{CurveArgs, FolderArgs, SolveArgs, TuneArgs};
use super::progress::Watch;
use super::{CliError, NOT_CONVERGED, exit_code, json, named, simulate, text};
use crate::dynamics::StopReason;
use crate::export::{self, ExportError, Format, MotionWriter};
use crate::picture::draw_svg;
use crate::scene::{self, Analysis, Scene};
use crate::simulation::{Simulation, Solution, Status};
use crate::study::path_chart::Ordinate;
use crate::study::{
    Demand, Extent, LoadCurve, LoadPath, MotionStudy, Progress, Reference, Scaling, Study, StudyError, Tuning,
    extremes, heat_map, motion_heat_map, parallel, path_chart, plot,
};
use crate::timings::Timings;
use crate::words::count;

/// Where the time of a command went.
pub(super) struct Spent {
    /// All of it, by the clock.
    wall: Duration,
    /// Reading, meshing, the order of elimination.
    set_up: Duration,
    /// The solve.
    stages: Timings,
    /// Recovering stresses, and estimating the mesh's error from them.
    stress: Duration,
    /// Finding the truth that errors are measured against.
    truth: Duration,
}

impl Spent {
    /// All of it.
    pub(super) fn wall(&self) -> Duration {
        self.wall
    }

    /// What the solve took: its four stages.
    pub(super) fn solve(&self) -> Duration {
        self.stages.total().saturating_sub(self.stages.certify)
    }

    /// The parts that sum to all of it, each with the name it has in JSON.
    pub(super) fn parts(&self) -> [(&'static str, Duration); 9] {
        let Self { wall, set_up, stages, stress, truth } = *self;
        let Timings { rotate, assemble, factorize, solve, certify } = stages;
        let other = wall.saturating_sub(set_up + stages.total() + stress + truth);
        [
            ("rotate", rotate),
            ("assemble", assemble),
            ("factorize", factorize),
            ("solve", solve),
            ("certify", certify),
            ("set_up", set_up),
            ("stress", stress),
            ("truth", truth),
            ("other", other),
        ]
    }
}

pub(super) fn solve(args: SolveArgs) -> Result<ExitCode, CliError> {
    let SolveArgs { scene, json, out, no_truth, no_certificate } = args;
    let began = Instant::now();
    // A wrong file name is said before the work, not after.
    let format = out.as_deref().map(Format::of).transpose()?;
    let (scene, mut simulation) = simulate(&scene.into())?;
    let set_up = began.elapsed();
    let (status, written) = match (scene.analysis, &out) {
        (Analysis::Static, Some(path)) if format == Some(Format::Pvd) => {
            return Err(ExportError::NotInMotion(path.display().to_string()).into());
        }
        (Analysis::Static, _) => {
            let status = simulation.solve().clone();
            if !no_certificate {
                simulation.certify();
            }
            (status, out.as_deref().map_or(Ok(()), |path| export::write(&simulation, path)))
        }
        (Analysis::Dynamic, _) => {
            let writer = out.as_deref().map(|path| MotionWriter::create(&simulation, path)).transpose()?;
            march(&mut simulation, writer)
        }
    };
    let mut certify_path = Duration::ZERO;
    let mut jump = None;
    if status == Status::Converged && !no_certificate && !simulation.is_linear() {
        let certified = Instant::now();
        jump = LoadPath::jump_before(&scene, simulation.displacement());
        certify_path = certified.elapsed();
    }
    let recovered = Instant::now();
    let stress = simulation.stress_result();
    let stress_time = recovered.elapsed();
    // A scene without a truth has a result all the same.
    let sought = Instant::now();
    let truth = if no_truth { None } else { Reference::of(&scene).ok() };
    let truth_time = sought.elapsed();
    let solution = Solution { status, ..simulation.solution() };
    let mut stages = solution.time;
    stages.certify += certify_path;
    let spent = Spent { wall: began.elapsed(), set_up, stages, stress: stress_time, truth: truth_time };
    let (mesh, results) = (simulation.system().mesh(), (&solution, &stress));
    text::print(&if json {
        json::solution(&scene, mesh, results, jump, truth.as_ref(), &spent)
    } else {
        text::solution(&scene, mesh, results, jump, truth.as_ref(), &spent)
    })?;
    // What could not be written is no reason to keep the result from who waits for it.
    written?;
    if solution.status == Status::Stopped(StopReason::Interrupted) {
        eprintln!("warpbeam: {}", StopReason::Interrupted);
    }
    Ok(exit_code(&solution.status))
}

/// Takes a motion to its end, or to where it is called off; the file, if there is one, has what was reached.
fn march(simulation: &mut Simulation, mut writer: Option<MotionWriter>) -> (Status, Result<(), ExportError>) {
    let watch = Watch::new();
    let duration = simulation.scene().dynamics.duration;
    let mut written = Ok(());
    while *simulation.status() == Status::Running && !watch.is_called_off() {
        simulation.step();
        let added = writer.as_mut().map_or(Ok(()), |writer| writer.add(simulation));
        if added.is_err() {
            (writer, written) = (None, added);
        }
        watch.show_time(simulation.state().time(), duration);
    }
    if let Some(writer) = writer {
        written = writer.finish(simulation);
    }
    let status = match simulation.status() {
        Status::Running => Status::Stopped(StopReason::Interrupted),
        status => status.clone(),
    };
    (status, written)
}

pub(super) fn curve(args: CurveArgs) -> Result<ExitCode, CliError> {
    let CurveArgs { scene, out, picture, of } = args;
    let source = scene::Source::from(scene);
    let (scene, _) = simulate(&source)?;
    // What cannot be drawn is said before the work.
    let ordinate = of.map_or(Ok(Ordinate::Usual), |name| ordinate(&scene, name))?;
    let is_png = |path: &Path| match path.extension().and_then(|e| e.to_str()) {
        Some("png") => Ok(true),
        Some("svg") => Ok(false),
        _ => Err(CliError::NoPictureFormat(path.to_owned())),
    };
    let is_png = picture.as_deref().map(is_png).transpose()?;
    let beam = LoadCurve::new(&scene);
    let path = if beam.is_none() || picture.is_some() { LoadPath::of(&scene) } else { None };
    let (words, table) = match (&beam, &path) {
        (Some(curve), _) => (text::curve(&scene, curve), text::curve_table(curve)),
        (None, Some(path)) => (text::path(&scene, path), text::path_table(&scene, path)),
        (None, None) => return Err(CliError::NoPath(named(&source))),
    };
    if let Some(out) = out {
        export::write_text(&out, &table)?;
    }
    if let (Some(picture), Some(is_png)) = (picture, is_png) {
        let path = path.as_ref().ok_or_else(|| CliError::NoPath(named(&source)))?;
        let svg = path_chart::svg(path, &scene, &ordinate);
        if is_png { draw_svg(&svg)?.write_png(&picture)? } else { export::write_text(&picture, &svg)? }
    }
    text::print(&words)?;
    Ok(if path.is_none_or(|path| path.complete) { ExitCode::SUCCESS } else { ExitCode::from(NOT_CONVERGED) })
}

/// What a name on the command line asks to be drawn.
fn ordinate(scene: &Scene, name: String) -> Result<Ordinate, CliError> {
    if let Some(i) = scene.probes.iter().position(|p| p.name == name) {
        return Ok(Ordinate::Probe(i));
    }
    let supports = (0..scene.supports.len()).map(|i| format!("support.{i}"));
    match supports.clone().position(|support| support == name) {
        Some(i) => Ok(Ordinate::Reaction(i)),
        None => {
            let known = scene.probes.iter().map(|p| p.name.clone()).chain(supports).collect();
            Err(CliError::NoOrdinate { name, known })
        }
    }
}

pub(super) fn study(source: &scene::Source, out: &FolderArgs) -> Result<ExitCode, CliError> {
    let (scene, _) = simulate(source)?;
    let watch = Watch::new();
    let (texts, interrupted) = match scene.analysis {
        Analysis::Static => {
            let mut partial = None;
            let observe = &mut |progress: Progress<'_>| {
                partial = progress.so_far.filter(|study| !study.measurements.is_empty()).cloned().or(partial.take());
                watch.observe(&progress)
            };
            let whole = Study::new(&scene, extent(out), observe);
            let (study, interrupted) = match (whole, partial) {
                (Err(StudyError::Cancelled), Some(partial)) => (Ok(partial), true),
                (whole, _) => (whole, false),
            };
            (study.map(|study| [study.table(), plot::svg(&study), study.summary()]), interrupted)
        }
        Analysis::Dynamic => {
            let study = MotionStudy::new(&scene, extent(out), &mut |progress| watch.observe(&progress));
            let interrupted = study.as_ref().is_ok_and(|study| study.is_partial);
            (study.map(|study| [study.table(), plot::motion_svg(&study), study.summary()]), interrupted)
        }
    };
    drop(watch);
    let [table, svg, summary] = match texts {
        Err(StudyError::Cancelled) => return Ok(ended(true, "nothing has been measured")),
        texts => texts.map_err(failed(source))?,
    };
    let texts = [("study.csv", table.as_str()), ("study.svg", &svg), ("study.txt", &summary)];
    write_folder(&out.folder, &texts, "study.svg")?;
    text::print(&summary)?;
    Ok(ended(interrupted, "the study lacks what was not measured yet"))
}

pub(super) fn scaling(source: &scene::Source, out: &FolderArgs) -> Result<ExitCode, CliError> {
    let (scene, _) = simulate(source)?;
    let watch = Watch::new();
    let study = Scaling::new(&scene, extent(out), &mut |progress| watch.observe(&progress));
    drop(watch);
    let study = match study {
        Err(StudyError::Cancelled) => return Ok(ended(true, "nothing has been measured")),
        study => study.map_err(failed(source))?,
    };
    let (table, svg, summary) = (study.table(), study.svg(), study.summary());
    let texts = [("scaling.csv", table.as_str()), ("scaling.svg", &svg), ("scaling.txt", &summary)];
    write_folder(&out.folder, &texts, "scaling.svg")?;
    text::print(&summary)?;
    Ok(ended(study.is_partial, "finer meshes have not been measured"))
}

/// The exit code of a command that may have been interrupted, and then says what is missing.
fn ended(interrupted: bool, missing: &str) -> ExitCode {
    if !interrupted {
        return ExitCode::SUCCESS;
    }
    eprintln!("warpbeam: interrupted: {missing}");
    ExitCode::from(NOT_CONVERGED)
}

pub(super) fn tune(args: TuneArgs) -> Result<ExitCode, CliError> {
    let TuneArgs { scene, error, time, write } = args;
    let source = scene::Source::from(scene);
    let (scene, _) = simulate(&source)?;
    let error = if time.is_none() { error.or(Some(1.0)) } else { error };
    let demand = Demand { max_error_percent: error, max_time_ms: time };
    let watch = Watch::new();
    let tuning = Tuning::of(&scene, demand, &mut |progress| watch.observe(&progress));
    drop(watch);
    let tuning = match tuning {
        Err(StudyError::Cancelled) => return Ok(ended(true, "nothing has been chosen")),
        tuning => tuning.map_err(failed(&source))?,
    };
    if let Some(path) = &write {
        export::write_text(path, &tuned(&scene, &tuning, &source, path).to_toml()?)?;
    }
    text::print(&format!("{tuning}\n"))?;
    Ok(if tuning.met { ExitCode::SUCCESS } else { ExitCode::from(NOT_CONVERGED) })
}

/// The scene with what was chosen, to be written to `path`.
fn tuned(scene: &Scene, tuning: &Tuning, source: &scene::Source, path: &Path) -> Scene {
    let mut tuned = tuning.chosen.setting.apply(scene);
    if let (Some(mesh), false) = (&mut tuned.mesh, source.built_in().is_some()) {
        // The mesh is named relative to the scene file, which is another one now.
        let folder = |path: &Path| path.parent().and_then(|folder| std::path::absolute(folder).ok());
        let old = folder(&source.name);
        if let Some(old) = old.filter(|old| Some(old) != folder(path).as_ref()) {
            mesh.file = old.join(&mesh.file).display().to_string();
        }
    }
    tuned
}

pub(super) fn extremes(out: &FolderArgs) -> Result<ExitCode, CliError> {
    let (cases, motion_cases) = (extremes::cases(extent(out)), extremes::motion::cases(extent(out)));
    let all = cases.len() + motion_cases.len();
    let watch = Watch::new();
    let observe = |done: usize| {
        watch.show(done as f64 / all as f64, || format!("{done} of {all} cases"));
        if watch.is_called_off() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let entries = parallel::map(
        &cases,
        |case, _| case.solve().map_err(|error| CliError::Simulation { scene: format!("{case:?}"), error }),
        observe,
    );
    let entries: Vec<_> = entries.into_iter().flatten().collect::<Result<_, _>>()?;
    let motions = parallel::map(
        &motion_cases,
        |case, _| case.run().map_err(|error| CliError::Simulation { scene: format!("{case:?}"), error }),
        |done| observe(cases.len() + done),
    );
    let motions: Vec<_> = motions.into_iter().flatten().collect::<Result<_, _>>()?;
    drop(watch);
    let missing = all - entries.len() - motions.len();
    let summary = format!("{}\n{}", extremes::summary(&entries), extremes::motion::summary(&motions));
    let (table, svg) = (extremes::table(&entries), heat_map(&entries));
    let texts = [("extremes.csv", table.as_str()), ("extremes.svg", &svg), ("extremes.txt", &summary)];
    write_folder(&out.folder, &texts, "extremes.svg")?;
    let (table, svg) = (extremes::motion::table(&motions), motion_heat_map(&motions));
    let texts = [("extremes-motion.csv", table.as_str()), ("extremes-motion.svg", &svg)];
    write_folder(&out.folder, &texts, "extremes-motion.svg")?;
    text::print(&summary)?;
    Ok(ended(missing > 0, &format!("{} not in the atlas", count(missing as u64, "case"))))
}

fn failed(source: &scene::Source) -> impl Fn(StudyError) -> CliError {
    |error| CliError::Study { scene: named(source), error }
}

fn extent(out: &FolderArgs) -> Extent {
    if out.quick { Extent::Quick } else { Extent::Full }
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

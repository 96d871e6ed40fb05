//! Commands without a window.

use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use super::args::{CurveArgs, FolderArgs, SolveArgs, TuneArgs};
use super::progress::{Watch, watched};
use super::solved::SolvedScene;
use super::{CliError, about, check_fit, check_suffix, ended, exit_code, json, sections_of, simulate, text, validated};
use crate::atomic_write;
use crate::export::{self, ExportError, Format, MotionWriter};
use crate::format::{count, number, percent};
use crate::plot::{self, Drawing};
use crate::progress::Progress;
use crate::scene::{self, Analysis, Probe, Scene};
use crate::simulation::{Deformation, Simulation, Solution, Status, StressResult};
use crate::stress::{inversion_warning, strain_warning};
use crate::study::extremes::{motion, rest};
use crate::study::path_chart::Ordinate;
use crate::study::{
    Claim, Demand, Extent, LoadCurve, LoadPath, MAX_CERTIFIED, PathSummary, Reference, Study, StudyError, Tuning,
    moved_points, parallel, path_chart,
};
use crate::timings::{Timings, timed};

pub(super) fn solve(args: SolveArgs) -> Result<ExitCode, CliError> {
    let began = Instant::now();
    let SolveArgs { scene, json, out, reference: extent, certificate, no_certificate } = args;
    // Report a wrong file name before solving.
    let format = out.as_deref().map(Format::of).transpose()?;
    let source = scene::Source::from(scene);
    let (scene, mut simulation) = simulate(&source)?;
    let fits = |option, given| check_fit((&source, &scene), (option, given), false, "it is about equilibria");
    fits("--reference full", extent == Some(Extent::Full))?;
    fits("--certificate", certificate)?;
    // A line that misses the body is refused before the solve.
    sections_of(&source, &simulation)?;
    let set_up = began.elapsed();
    let watch = Watch::new();
    let certifies = certificate || !no_certificate && simulation.system().dofs() <= MAX_CERTIFIED;
    let is_static = scene.analysis == Analysis::Static;
    let mut writer = match &out {
        Some(path) if is_static && format == Some(Format::Pvd) => {
            return Err(ExportError::NotInMotion(path.display().to_string()).into());
        }
        Some(path) if !is_static => Some(MotionWriter::create(&simulation, path)?),
        _ => None,
    };
    let mut written = Ok(());
    watch.run(&mut simulation, |simulation| {
        let added = writer.as_mut().map_or(Ok(()), |writer| writer.add(simulation));
        if added.is_err() {
            (writer, written) = (None, added);
        }
    });
    if let Some(writer) = writer {
        written = writer.finish(&simulation);
    }
    if certifies && !watch.is_cancelled() {
        simulation.certify();
    }
    if let Some(path) = out.as_deref().filter(|_| is_static) {
        written = export::write(&simulation, path);
    }
    let status = simulation.status().clone();
    let mut certify_path = Duration::ZERO;
    let observe = |progress: Progress<'_>| watch.observe(progress);
    let follow = || timed(&mut certify_path, || LoadPath::to_result(&simulation, &observe));
    let path = (status == Status::Converged && certifies).then(follow).flatten();
    let recovered = Instant::now();
    let stress = simulation.stress_result();
    let has_forces = !matches!(status, Status::Diverged(_));
    let sections = if has_forces { sections_of(&source, &simulation)? } else { Vec::new() };
    let stress_time = recovered.elapsed();
    let sought = Instant::now();
    // A state that is not the one asked for has no error.
    let is_elsewhere = path.is_some_and(|path| path.elsewhere.is_some());
    let reference = extent
        .filter(|_| is_static && status.is_success() && !is_elsewhere)
        .filter(|_| !watch.is_cancelled() && !scene.probes.is_empty())
        .map(|extent| Reference::find(&scene, Some(&simulation), extent, &observe));
    let reference_time = sought.elapsed();
    let interrupted = watch.is_cancelled();
    drop(watch);
    let mut solution = simulation.solution();
    solution.energy.supports = solution.energy.supports.or(path.and_then(|path: PathSummary| path.supports_work));
    let (stages, wall) = (*simulation.timings(), began.elapsed());
    let Timings { rotate, linearize, factorize, solve, advance, certify } = stages;
    let other = wall.saturating_sub(set_up + stages.total() + certify_path + stress_time + reference_time);
    let parts = [
        ("rotate", rotate),
        ("assemble", linearize),
        ("factorize", factorize),
        ("solve", solve + advance),
        ("certify", certify + certify_path),
        ("set_up", set_up),
        ("stress", stress_time),
        ("reference", reference_time),
        ("other", other),
    ];
    let solve = stages.total().saturating_sub(certify);
    let mut warnings = limits_of(&simulation, &solution.deformation, &stress);
    if let Some(Err(error)) = &reference {
        warnings.push(match error {
            StudyError::TooFine { .. } => format!("{error} within the default effort; --reference full does it"),
            error => error.to_string(),
        });
    }
    if is_elsewhere {
        warnings.push("no error is stated: the reference solution is the one to which loading from rest leads".into());
    }
    if is_static && !certifies && !no_certificate {
        let unknowns = count(simulation.system().dofs() as u64, "unknown");
        warnings.push(format!("not certified: {unknowns}; use --certificate to certify the result"));
    }
    let reference = reference.and_then(Result::ok);
    warnings.extend(reference.as_ref().map(Reference::limits).unwrap_or_default());
    warnings.extend(limits_of_auto(&scene, &solution, reference.as_ref()));
    let rho = solution.certificate.and_then(|certificate| certificate.fixed_point_rho);
    let claims = Claim::of_result(&simulation, rho, path.as_ref(), reference.as_ref());
    let simulation = &simulation;
    let solved =
        SolvedScene { simulation, solution, stress, sections, path, reference, claims, warnings, wall, solve, parts };
    text::print(&if json { json::solution(&solved) } else { text::solution(&solved) })?;
    // Print the result even if its file could not be written.
    written?;
    match status {
        Status::Stopped(reason) if interrupted => eprintln!("warpbeam: {reason}"),
        _ if interrupted && status.is_success() => eprintln!("warpbeam: interrupted: some results are missing"),
        _ => {}
    }
    let gained = simulation.motion().is_some_and(|motion| motion.ledger().has_gained_too_much());
    Ok(exit_code(!interrupted && !gained && status.is_success()))
}

/// Returns sentences about the limitations of a result that are found without a reference solution.
fn limits_of(simulation: &Simulation, deformation: &Deformation, stress: &StressResult) -> Vec<String> {
    fn texts<T: ToString>(limits: impl IntoIterator<Item = T>) -> Vec<String> {
        limits.into_iter().map(|limit| limit.to_string()).collect()
    }
    let Deformation { max_strain, inverted_elements, .. } = *deformation;
    let (scene, mesh, system) = (simulation.scene(), simulation.mesh(), simulation.system());
    // The strains of a diverging iteration mean nothing.
    let strain = strain_warning(max_strain).filter(|_| !matches!(simulation.status(), Status::Diverged(_)));
    [
        texts(inversion_warning(inverted_elements, mesh.element_count())),
        texts(strain),
        texts(simulation.passes_through_itself().then_some("the body passes through itself: contact is not modelled")),
        texts(system.seams()),
        texts(stress.singularity),
        texts(moved_points(scene, mesh)),
        texts(system.crowded_supports(|i| format!("support.{i}"))),
        scene.unresolved_pulses(),
        texts(simulation.motion().and_then(|motion| motion.ledger().drift_warning())),
    ]
    .concat()
}

/// Returns sentences about errors above the one that is asked of `auto`.
fn limits_of_auto(scene: &Scene, solution: &Solution, reference: Option<&Reference>) -> Vec<String> {
    let Some(auto) = solution.auto.filter(|_| solution.status.is_success()) else { return Vec::new() };
    let asked = scene.solver.max_error_percent;
    let above = format!("above the {} % of solver.max_error_percent", number(asked));
    let mut limits = Vec::new();
    let estimated = 100.0 * auto.estimated_error;
    if estimated.is_finite() && estimated > asked {
        limits.push(format!("the estimated error of the method, {}, is {above}", percent(estimated)));
    }
    let probes = reference.map_or(&[][..], Reference::probes).iter().zip(&solution.probes);
    for (known, probe) in probes {
        let Some(known) = known else { continue };
        let error = known.error_percent(probe).filter(|error| error - known.own_error_percent > asked);
        limits.extend(error.map(|error| {
            let (name, error) = (&probe.name, percent(error));
            format!("the error of {name}, {error}, is {above}, which limits the error of the method only")
        }));
    }
    limits
}

pub(super) fn curve(args: CurveArgs) -> Result<ExitCode, CliError> {
    let CurveArgs { scene, outputs, of } = args;
    let source = scene::Source::from(scene);
    let (scene, _) = validated(&source)?;
    // Report invalid names before computing the path.
    let ordinate = of.map_or(Ok(Ordinate::Usual), |name| ordinate(&scene, &name))?;
    outputs.check()?;
    let watch = Watch::new();
    let path = LoadPath::of(&scene, &|progress| watch.observe(progress));
    let beam = LoadCurve::new(&scene).filter(|_| !watch.is_cancelled());
    drop(watch);
    let no_path = || {
        let expected = "expected a static scene with a method other than linear";
        about(&source, format_args!("{expected}: a load path is a sequence of equilibria with large rotations"))
    };
    let (summary, table) = match (&beam, &path) {
        (Some(curve), path) => (text::curve(&scene, curve, path.as_ref()), text::curve_table(curve)),
        (None, Some(path)) => (text::path(&scene, path), text::path_table(&scene, path)),
        (None, None) => return Err(no_path()),
    };
    let picture = || {
        let path = path.as_ref().ok_or_else(no_path)?;
        Ok(plot::figures([path_chart::figure(path, &scene, &ordinate, &ToString::to_string)]))
    };
    outputs.write(|| table, picture)?;
    text::print(&summary)?;
    Ok(exit_code(path.is_none_or(|path| path.end.is_none())))
}

/// Returns the quantity to be drawn by its name.
fn ordinate(scene: &Scene, name: &str) -> Result<Ordinate, CliError> {
    let of_probe = |(i, Probe { name, .. }): (usize, &Probe)| {
        let [x, y] = [0, 1].map(|axis| Ordinate::Component(i, axis));
        let parts = [("", Ordinate::Probe(i)), (".x", x), (".y", y), (".path", Ordinate::Path(i))];
        parts.map(|(part, ordinate)| (format!("{name}{part}"), ordinate))
    };
    let supports = (0..scene.supports.len()).map(|i| (format!("support.{i}"), Ordinate::Reaction(i)));
    let all: Vec<_> = scene.probes.iter().enumerate().flat_map(of_probe).chain(supports).collect();
    let found = all.iter().find(|(known, _)| known == name).map(|(_, ordinate)| *ordinate);
    let names = || all.iter().map(|(known, _)| known.as_str()).collect::<Vec<_>>().join(", ");
    found.ok_or_else(|| format!("--of {name}: expected one of {}", names()).into())
}

pub(super) fn study(source: &scene::Source, out: &FolderArgs) -> Result<ExitCode, CliError> {
    let (scene, _) = validated(source)?;
    let study = match watched(|observe| Study::new(&scene, extent(out), observe)) {
        Err(StudyError::Cancelled) => return Ok(ended(true, "nothing has been measured")),
        study => study.map_err(|error| about(source, error))?,
    };
    let summary = study.summary();
    write_folder(&out.folder, "study", &study.table(), &plot::study(&study), Some(&summary))?;
    text::print(&summary)?;
    Ok(ended(study.is_partial, "the study has only the settings measured until then"))
}

pub(super) fn tune(args: TuneArgs) -> Result<ExitCode, CliError> {
    let TuneArgs { scene, error, time, write } = args;
    write.as_deref().map_or(Ok(()), |path| check_suffix(path, ".toml"))?;
    let source = scene::Source::from(scene);
    let (scene, _) = validated(&source)?;
    let error = if time.is_none() { error.or(Some(1.0)) } else { error };
    let demand = Demand { max_error_percent: error, max_time_ms: time };
    let tuning = match watched(|observe| Tuning::of(&scene, demand, observe)) {
        Err(StudyError::Cancelled) => return Ok(ended(true, "nothing has been measured")),
        Err(error) if error.is_unknown() => {
            text::print(&format!("{}: it is not known which settings meet {demand}: {error}\n", scene.name))?;
            return Ok(exit_code(false));
        }
        tuning => tuning.map_err(|error| about(&source, error))?,
    };
    text::print(&format!("{tuning}\n"))?;
    if let Some(path) = &write {
        let text = scene::edited(&source.text()?, &tuned(&scene, &tuning, &source, path))?;
        atomic_write::save(path, text.as_bytes()).map_err(export::failed(path))?;
    }
    if tuning.study.is_partial {
        return Ok(ended(true, "finer meshes have not been measured"));
    }
    Ok(exit_code(tuning.met))
}

/// Returns the scene with the chosen setting, to be written to `path`.
fn tuned(scene: &Scene, tuning: &Tuning, source: &scene::Source, path: &Path) -> Scene {
    let mut tuned = tuning.chosen.applied().apply(scene);
    if let (Some(mesh), false) = (&mut tuned.mesh, source.built_in().is_some()) {
        // The mesh path is relative to the scene file, which changes. The folder of a bare file name is the current
        // one.
        let folder = |path: &Path| path.parent().and_then(|folder| std::path::absolute(folder.join(".")).ok());
        if let Some(old) = folder(&source.name).filter(|old| Some(old) != folder(path).as_ref()) {
            mesh.file = old.join(&mesh.file).display().to_string();
        }
    }
    tuned
}

pub(super) fn extremes(out: &FolderArgs) -> Result<ExitCode, CliError> {
    let (cases, motion_cases) = (rest::cases(extent(out)), motion::cases(extent(out)));
    let all = cases.len() + motion_cases.len();
    let watch = Watch::new();
    let observe = |done: usize| {
        let now = format!("{done} of {all} cases").into();
        watch.observe(Progress { fraction: done as f64 / all as f64, now: Some(&now) })
    };
    let entries = parallel::map(&cases, |case, _| case.solve(), observe);
    let motions = parallel::map(&motion_cases, |case, _| motion::entry(case), |done| observe(cases.len() + done));
    drop(watch);
    let atlas = rest::atlas(entries.into_iter().flatten().collect::<Result<_, _>>()?);
    let motions = motion::atlas(motions.into_iter().flatten().collect::<Result<_, _>>()?);
    let missing = all - atlas.entries.len() - motions.entries.len();
    let summary = format!("{}\n{}", rest::summary(&atlas), motion::summary(&motions));
    write_folder(&out.folder, "extremes", &atlas.table(), &plot::atlas(&atlas), Some(&summary))?;
    write_folder(&out.folder, "extremes-motion", &motions.table(), &plot::atlas(&motions), None)?;
    text::print(&summary)?;
    Ok(ended(missing > 0, &format!("{} not in the atlas", count(missing as u64, "case"))))
}

fn extent(out: &FolderArgs) -> Extent {
    if out.quick { Extent::Quick } else { Extent::Full }
}

/// Writes a table, a drawing and a summary into a folder, under one name.
fn write_folder(out: &Path, name: &str, table: &str, drawing: &Drawing, summary: Option<&str>) -> Result<(), CliError> {
    std::fs::create_dir_all(out).map_err(export::failed(out))?;
    let file = |extension: &str| out.join(format!("{name}.{extension}"));
    export::write_text(&file("csv"), table)?;
    export::write_text(&file("svg"), &drawing.svg())?;
    summary.map_or(Ok(()), |summary| export::write_text(&file("txt"), summary))?;
    Ok(())
}

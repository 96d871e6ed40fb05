//! Command `section`: section forces, and the stress along a cut.

use std::cell::LazyCell;
use std::fmt::Write as _;
use std::process::ExitCode;

use nalgebra::Vector2;
use serde_json::{Value, json};

use super::args::SectionArgs;
use super::progress::Watch;
use super::{CliError, about, exit_code, json, sections_of, simulate, text};
use crate::format::{Context, engineering, in_power, number, prefix, three_digits};
use crate::plot;
use crate::scene::{self, Scene, SectionLine};
use crate::section::{Section, SectionError, SectionForces, SectionPoint};
use crate::simulation::{Equilibrium, Simulation, Status};
use crate::study::section_chart::{self, COMPONENTS, SectionComponent};

/// Runs the command.
pub(super) fn section(args: SectionArgs) -> Result<ExitCode, CliError> {
    let SectionArgs { scene, at, angle, along, json, outputs } = args;
    let source = scene::Source::from(scene);
    outputs.check()?;
    let (scene, mut simulation) = simulate(&source)?;
    let refused = |error: SectionError| about(&source, error);
    let (low, high) = simulation.mesh().bounds();
    // Without y, the line goes through the middle of the body's bounding box.
    let point = |(x, y): (f64, Option<f64>)| Vector2::new(x, y.unwrap_or(0.5 * (low.y + high.y)));
    let line = at.map(|at| SectionLine { at: point(at), angle });
    if line.is_none() && along.is_none() && scene.sections.is_empty() {
        return Err(about(&source, "expected --at or --along, or a scene with a [[section]]"));
    }
    let cut = |simulation: &Simulation| match (line, along) {
        (Some(line), _) => simulation.section(line).map(|section| vec![section]).map_err(refused),
        (None, Some(count)) => simulation.sections(usize::from(count)).map_err(refused),
        (None, None) => sections_of(&source, simulation),
    };
    // A line that misses the body is refused before the solve.
    if along.is_none() {
        cut(&simulation)?;
    }
    Watch::new().run(&mut simulation, |_| ());
    let status = simulation.status().clone();
    if matches!(status, Status::Diverged(_)) {
        eprintln!("warpbeam: {}", about(&source, status.failure().unwrap_or_default()));
        return Ok(exit_code(false));
    }
    let sections = cut(&simulation)?;
    // Diagrams and largest values do not miss a jump between the sections that were asked for.
    let diagram = LazyCell::new(|| simulation.diagram_sections());
    let diagram = || LazyCell::force(&diagram).as_ref().map_err(|error| refused(*error));
    let table = || match (along, &sections[..]) {
        (None, [section]) => stress_table(section),
        _ => forces_table(&sections),
    };
    outputs.write(table, || {
        let within = |cuts: &[Section]| section_chart::contexts(cuts, &simulation);
        let stress = |cut| section_chart::stress(cut, &scene, &within(std::slice::from_ref(cut)), &ToString::to_string);
        Ok(match along {
            None => plot::figures(sections.iter().flat_map(stress)),
            Some(_) => {
                let diagram = diagram()?;
                plot::figures(section_chart::forces(diagram, &scene, &within(diagram), &ToString::to_string))
            }
        })
    })?;
    text::print(&match (json, along) {
        (true, _) => as_json(&scene, &simulation, &sections),
        (false, Some(_)) => heading(&scene, &simulation) + &along_beam(&sections, diagram()?, &simulation),
        (false, None) => {
            let cuts: Vec<String> = sections.iter().map(|section| of_cut(section, &simulation)).collect();
            heading(&scene, &simulation) + &cuts.join("\n")
        }
    })?;
    Ok(exit_code(status.is_success()))
}

fn heading(scene: &Scene, simulation: &Simulation) -> String {
    let factor = simulation.equilibrium().map(Equilibrium::load_factor).filter(|factor| *factor < 1.0);
    let part = |factor| format!(", at {} % of the load", number(three_digits(100.0 * factor)));
    let part = factor.map_or_else(String::new, part);
    format!("{}: element {}, {}{part}\n", scene.name, scene.element().id(), simulation.status().word())
}

fn of_cut(section: &Section, simulation: &Simulation) -> String {
    let ends = section.rest.iter().chain(&section.ends).flat_map(|end| [end.x, end.y]);
    let places = Context::of_inexact(ends, 1e-12);
    let pair = |v: Vector2<f64>| places.pair(v.into(), "m");
    let theory = match section.points.iter().any(|point| point.beam.is_some()) {
        true => "beam theory: of a rectangular section",
        false => "beam theory: only in cuts normal to the axis",
    };
    let [[from, to], [now_from, now_to]] = [section.rest, section.ends].map(|ends| ends.map(pair));
    let angle = engineering(three_digits(section.line.angle.to_degrees()), "°");
    let mut text = format!("cut from {from} to {to} at rest, normal at {angle}, now from {now_from} to {now_to}\n");
    for (component, within) in COMPONENTS.iter().zip(section_chart::contexts(std::slice::from_ref(section), simulation))
    {
        let [value, of_stress] = [&section.forces, &section.stress_forces]
            .map(|forces| within.engineering((component.of)(forces), component.unit));
        let _ = writeln!(text, "{:<17} {value:>12}   of the recovered stress {of_stress}", component.name);
    }
    let stresses: Vec<f64> =
        section.points.iter().flat_map(|point| point.stress.into_iter().chain(point.beam).flatten()).collect();
    let ((power, symbol), within) = (prefix(&stresses, "Pa"), Context::of(stresses));
    let along: Vec<f64> = section.points.iter().map(|point| point.along).collect();
    let ((along_power, along_symbol), along_within) = (prefix(&along, "m"), Context::of_inexact(along, 1e-6));
    let place = format!("η, {along_symbol}m");
    let _ = writeln!(text, "\nstress, {symbol}Pa ({theory})");
    let _ = writeln!(text, "{place:>10}        normal  beam theory         shear  beam theory");
    let short = |value: f64| in_power(within.rounded(value), power);
    for point in shown(&section.points) {
        let cells = |stress: Option<[f64; 2]>| stress.map_or_else(|| ["–"; 2].map(str::to_owned), |s| s.map(short));
        let ([normal, shear], [beam_normal, beam_shear]) = (cells(point.stress), cells(point.beam));
        let along = in_power(along_within.rounded(point.along), along_power);
        let _ = writeln!(text, "{along:>10}  {normal:>12} {beam_normal:>12}  {shear:>12} {beam_shear:>12}");
    }
    text
}

/// Returns at most 25 of the values, the first and the last among them.
fn shown<T>(values: &[T]) -> impl Iterator<Item = &T> {
    const MAX_ROWS: usize = 25;
    let rows = values.len().min(MAX_ROWS);
    (0..rows).filter_map(move |row| values.get(row * (values.len() - 1) / (rows - 1).max(1)))
}

/// Formats N, V and M in these sections as a table, and the largest value of each in a diagram of the beam.
fn along_beam(sections: &[Section], diagram: &[Section], simulation: &Simulation) -> String {
    // The heading of a column and its cells.
    let column = |name: &str, unit: &str, values: Vec<f64>| -> Vec<String> {
        let (power, symbol) = prefix(&values, unit);
        let cells = values.iter().map(|value| in_power(*value, power));
        std::iter::once(format!("{name}, {symbol}{unit}")).chain(cells).collect()
    };
    let x = column("x", "m", sections.iter().map(|section| section.line.at.x).collect());
    let contexts = section_chart::contexts(sections, simulation);
    let [n, v, m] = [0, 1, 2].map(|i| {
        let (SectionComponent { symbol, unit, of, .. }, within) = (&COMPONENTS[i], contexts[i]);
        column(symbol, unit, sections.iter().map(|section| within.rounded(of(&section.forces))).collect())
    });
    let mut text = String::new();
    for (((x, n), v), m) in x.iter().zip(&n).zip(&v).zip(&m) {
        let _ = writeln!(text, "{x:>10}  {n:>14}  {v:>14}  {m:>14}");
    }
    text.push('\n');
    for (component, within) in COMPONENTS.iter().zip(section_chart::contexts(diagram, simulation)) {
        if let Some((value, x)) = section_chart::largest(diagram, component, &within) {
            let (value, x) = (engineering(value, component.unit), engineering(three_digits(x), "m"));
            let _ = writeln!(text, "largest {}: {value}, at x = {x}", component.symbol);
        }
    }
    text
}

fn as_json(scene: &Scene, simulation: &Simulation, sections: &[Section]) -> String {
    json::text(&json!({
        "scene": scene.name,
        "status": simulation.status().id(),
        "load_fraction": simulation.equilibrium().map(|equilibrium| equilibrium.load_factor()),
        "sections": sections.iter().map(json::section).collect::<Value>(),
    }))
}

/// Formats the stress along a cut as CSV.
fn stress_table(section: &Section) -> String {
    let mut text = "rest_x,rest_y,along,normal_stress,shear_stress,beam_normal_stress,beam_shear_stress\n".to_owned();
    for SectionPoint { rest, along, stress, beam } in &section.points {
        let cells =
            |of: &Option<[f64; 2]>| [0, 1].map(|i| of.map_or_else(String::new, |of| of[i].to_string())).join(",");
        let _ = writeln!(text, "{},{},{along},{},{}", rest.x, rest.y, cells(stress), cells(beam));
    }
    text
}

/// Formats N, V and M along a beam as CSV.
fn forces_table(sections: &[Section]) -> String {
    let mut text =
        "x,y,normal_force,shear_force,moment,stress_normal_force,stress_shear_force,stress_moment,angle\n".to_owned();
    for Section { line, forces, stress_forces, .. } in sections {
        let _ = write!(text, "{},{}", line.at.x, line.at.y);
        for SectionForces { normal, shear, moment } in [forces, stress_forces] {
            let _ = write!(text, ",{normal},{shear},{moment}");
        }
        let _ = writeln!(text, ",{}", line.angle);
    }
    text
}

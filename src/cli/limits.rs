//! Command `limits`: the loads up to which each method and element holds, or the time steps up to which each integrator
//! does.

use std::fmt::Write as _;
use std::process::ExitCode;

use serde_json::{Value, json};

use super::args::LimitsArgs;
use super::progress::watched;
use super::{CliError, about, json, text, validated};
use crate::format::{engineering, percent, three_digits};
use crate::plot;
use crate::scene::{self, Scene};
use crate::study::figure::LoadAxis;
use crate::study::limits::{GOOD, LARGE_OWN, LimitPoint, MethodLimits, Strip, USABLE, load_text};
use crate::study::{Setting, moved_points};

pub(super) fn limits(args: LimitsArgs) -> Result<ExitCode, CliError> {
    let LimitsArgs { scene, json, outputs } = args;
    let source = scene::Source::from(scene);
    outputs.check()?;
    let (scene, system) = validated(&source)?;
    let seams = system.seams().iter().map(ToString::to_string);
    let notes: Vec<String> = seams.chain(moved_points(&scene, system.mesh()).iter().map(ToString::to_string)).collect();
    let limits =
        watched(|observe| MethodLimits::of(&scene, observe, &|_| {})).map_err(|error| about(&source, error))?;
    outputs.write(|| table(&limits), || Ok(plot::limits(&limits, &scene)))?;
    text::print(&match json {
        true => as_json(&limits, &scene, &notes),
        false => summary(&limits, &scene) + &text::notes(&notes),
    })?;
    Ok(ExitCode::SUCCESS)
}

fn summary(limits: &MethodLimits, scene: &Scene) -> String {
    let axis = LoadAxis::of(scene);
    let load = |factor: f64| load_text(&axis, factor);
    let [low, high] = limits.range.map(load);
    let mut text = format!("{}: {} from {low} to {high}, {} in the scene; ", scene.name, axis.name, load(1.0));
    text += &match limits.duration {
        Some(duration) => {
            let mesh = limits.mesh_error_text().map_or_else(String::new, |mesh| format!("; {mesh}"));
            format!("the first {} of the motion{mesh}\n\n", engineering(three_digits(duration), "s"))
        }
        None => {
            let (known, all) = (limits.reference.iter().filter(|(_, u)| u.is_some()).count(), limits.reference.len());
            let own = limits.strips.iter().flat_map(|strip| &strip.points).filter_map(|point| point.reference_percent);
            let own = own.max_by(f64::total_cmp).filter(|own| *own > LARGE_OWN * GOOD);
            let own = own.map_or_else(String::new, |own| format!(", its own error is at most {}", percent(own)));
            let found = limits.criticals.iter().filter_map(|(element, at)| Some((element.id(), (*at)?)));
            let criticals: Vec<String> = found.map(|(element, at)| format!("{} with {element}", load(at))).collect();
            let criticals = match criticals.join(", ").as_str() {
                "" => String::new(),
                all => format!("critical load of this mesh, where the path from rest buckles or jumps: {all}\n"),
            };
            format!("the reference solution is known at {known} of {all} loads{own}\n{criticals}\n")
        }
    };
    let ends = if limits.duration.is_some() { "finishes to" } else { "converges to" };
    let head = ["", &format!("within {GOOD} %"), &format!("within {USABLE} %"), ends, "strains > 10 %"];
    let row = |strip: &Strip| {
        let [good, usable, converges, law] = strip.words(&axis).map(|words| words.to_string());
        [strip.name(str::to_owned), good, usable, converges, law]
    };
    let rows: Vec<_> = std::iter::once(head.map(str::to_owned)).chain(limits.strips.iter().map(row)).collect();
    let width = |i: usize| rows.iter().map(|row| row[i].chars().count()).fold(if i == 0 { 11 } else { 15 }, usize::max);
    for [name, cells @ ..] in &rows {
        let _ = write!(text, "{name:<width$}", width = width(0));
        cells.iter().enumerate().for_each(|(i, cell)| _ = write!(text, "  {cell:>width$}", width = width(i + 1)));
        text.push('\n');
    }
    text
}

/// Formats every result as CSV.
fn table(limits: &MethodLimits) -> String {
    let first = if limits.duration.is_some() { "integrator,time_step" } else { "element,method,load_factor" };
    let mut text = format!("{first},displacement_x,displacement_y,error_percent,max_strain,inverted_elements\n");
    for strip in &limits.strips {
        let name = strip.name(str::to_owned).replace(' ', ",");
        let unit = strip.setting.stepping.map_or(1.0, |stepping| stepping.time_step);
        for point in strip.points.iter().filter(|point| point.is_compared) {
            let LimitPoint { factor, displacement, inverted_elements, .. } = point;
            let error = point.error_percent.map_or_else(String::new, |error| error.to_string());
            let ([x, y], max_strain) = (<[f64; 2]>::from(*displacement), point.max_strain.unwrap_or_default());
            let _ = writeln!(text, "{name},{},{x},{y},{error},{max_strain},{inverted_elements}", factor * unit);
        }
    }
    text
}

fn as_json(limits: &MethodLimits, scene: &Scene, warnings: &[String]) -> String {
    let axis = LoadAxis::of(scene);
    let strip = |strip: &Strip| {
        let (fails, Setting { element, method, iterations, stepping, .. }) = (strip.fails(), strip.setting);
        let within = |percent: f64| strip.within(percent).filter(|end| strip.last_known() != Some(*end));
        let mut object = json!({
            "element": element.id(),
            "method": method.id(),
            "accept_after": stepping.map_or(iterations, |_| scene.solver.accept_after),
            "within_1_percent": within(GOOD),
            "within_5_percent": within(USABLE),
            "error_known_to": strip.last_known(),
            "converges_to": fails.first().map(|[end, _]| end),
            "converges_again_from": fails.first().map(|[_, again]| again).filter(|again| **again < limits.range[1]),
            "does_not_converge": fails,
            "law_ends_at": strip.law_ends_at(),
            "critical_load_factor": limits.critical_of(element),
        });
        if let Some(stepping) = stepping {
            object["integrator"] = json!(stepping.integrator.id());
        }
        object
    };
    let mut object = json!({
        "scene": scene.name,
        "load": axis.name.to_string(),
        "unit": axis.unit,
        "full_load": axis.full,
        "reference": limits.reference.iter().map(|(factor, u)| json!({ "load_factor": factor, "displacement": u })).collect::<Value>(),
        "strips": limits.strips.iter().map(strip).collect::<Value>(),
        "warnings": warnings,
    });
    match limits.duration {
        Some(duration) => {
            object["duration"] = json!(duration);
            object["mesh_error_percent"] = json!(limits.mesh_error_percent);
        }
        None => object["critical_load_factor"] = json!(limits.critical()),
    }
    json::text(&object)
}

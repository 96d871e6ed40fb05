//! Command `limits`: the loads up to which each method and element holds.

use std::fmt::Write as _;
use std::process::ExitCode;

use serde_json::{Value, json};

use super::args::LimitsArgs;
use super::progress::Watch;
use super::{CliError, json, named, simulate, text};
use crate::plot::{self, Scale};
use crate::scene::{self, Scene};
use crate::study::figure::LoadAxis;
use crate::study::limits::{GOOD, LimitPoint, MethodLimits, RANGE, Strip, USABLE, load_text};

/// Runs the command.
pub(super) fn limits(args: LimitsArgs) -> Result<ExitCode, CliError> {
    let LimitsArgs { scene, json, outputs, linear } = args;
    let source = scene::Source::from(scene);
    outputs.check()?;
    let (scene, _) = simulate(&source)?;
    let watch = Watch::new();
    let limits = MethodLimits::of(&scene, &|progress| watch.observe(progress));
    drop(watch);
    let limits = limits.map_err(|error| CliError::Study { scene: named(&source), error })?;
    let scale = if linear { Scale::Linear } else { Scale::Logarithmic };
    outputs.write_table(|| table(&limits))?;
    outputs.write_picture(|| Ok(plot::limits(&limits, &scene, scale)))?;
    text::print(&if json { as_json(&limits, &scene) } else { summary(&limits, &scene) })?;
    Ok(ExitCode::SUCCESS)
}

fn summary(limits: &MethodLimits, scene: &Scene) -> String {
    let axis = LoadAxis::of(scene);
    let load = |factor: f64| load_text(&axis, factor);
    let known = limits.reference.iter().filter(|(_, u)| u.is_some()).count();
    let mut text = format!(
        "{}: {} from {} to {}, {} in the scene; the reference solution is known at {known} of {} loads\n\n",
        scene.name,
        axis.name,
        load(RANGE[0]),
        load(RANGE[1]),
        load(1.0),
        limits.reference.len()
    );
    let head =
        [format!("within {GOOD} %"), format!("within {USABLE} %"), "converges to".into(), "strains > 10 %".into()];
    let _ = write!(text, "{:<11}", "");
    head.iter().for_each(|head| _ = write!(text, "  {head:>15}"));
    text.push('\n');
    for strip in &limits.strips {
        let _ = write!(text, "{:<11}", format!("{} {}", strip.element.id(), strip.method.id()));
        strip.words(&axis).iter().for_each(|cell| _ = write!(text, "  {:>15}", cell.to_string()));
        text.push('\n');
    }
    text
}

/// Formats every result as CSV.
fn table(limits: &MethodLimits) -> String {
    let mut text =
        "element,method,load_factor,displacement_x,displacement_y,error_percent,max_strain,inverted_elements\n"
            .to_owned();
    for Strip { element, method, points, .. } in &limits.strips {
        for LimitPoint { factor, displacement, error_percent, max_strain, inverted_elements } in points {
            let error = error_percent.map_or_else(String::new, |error| error.to_string());
            let (element, method) = (element.id(), method.id());
            let [x, y] = [displacement.x, displacement.y];
            let _ = writeln!(text, "{element},{method},{factor},{x},{y},{error},{max_strain},{inverted_elements}");
        }
    }
    text
}

fn as_json(limits: &MethodLimits, scene: &Scene) -> String {
    let axis = LoadAxis::of(scene);
    let strip = |strip: &Strip| {
        json!({
            "element": strip.element.id(),
            "method": strip.method.id(),
            "within_1_percent": strip.within(GOOD),
            "within_5_percent": strip.within(USABLE),
            "error_known_to": strip.last_known().map(|(factor, _)| factor),
            "converges_to": strip.ends_at,
            "law_ends_at": strip.law_ends_at(),
        })
    };
    json::text(&json!({
        "scene": scene.name,
        "load": axis.name.to_string(),
        "unit": axis.unit,
        "full_load": axis.full,
        "reference": limits.reference.iter().map(|(factor, u)| json!({ "load_factor": factor, "displacement": u })).collect::<Value>(),
        "strips": limits.strips.iter().map(strip).collect::<Value>(),
    }))
}

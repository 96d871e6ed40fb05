//! Limits of methods: each end that is stated holds for single solves 1 % below and 1 % above it.

use crate::common::*;
use warpbeam::study::limits::{MethodLimits, Strip};

/// Ratio of two neighbouring loads between which an end lies.
const NEXT: f64 = 1.0101;

/// Result of a single solve: its error, percent, with that of the reference, and `true` if its strains are beyond the
/// linear law.
fn solved(scene: &Scene, strip: &Strip, factor: f64) -> Option<(Option<f64>, bool)> {
    let mut scene = strip.setting.apply(scene);
    scene.scale_loads(factor);
    let mut simulation = Simulation::new(&scene).ok()?;
    simulation.solve().is_success().then_some(())?;
    let deformation = simulation.solution().deformation;
    let reference = Reference::of(&scene).ok().and_then(|reference| reference.first());
    let percent = |(probe, u): (ProbeReference, _)| probe.percent(u, probe.displacement) + probe.own_error_percent;
    let error = reference.zip(simulation.probe(&scene.probes[0].name)).map(percent);
    Some((error, deformation.inverted_elements > 0 || deformation.max_strain > 0.1))
}

#[test]
fn stated_ends_of_limits_hold() {
    let seeds = seeds(300, 2, 30);
    let (mut ends, mut wrong) = ([0; 4], Vec::new());
    for &seed in &seeds {
        let mut scene = random::scene(seed);
        scene.solver.accept_after = 0;
        let Ok(limits) = MethodLimits::of(&scene, &go_on, &|_| {}) else { continue };
        let axis = warpbeam::study::figure::LoadAxis::of(&scene);
        for strip in &limits.strips {
            let words = strip.words(&axis).map(|words| words.to_string());
            let is_tried =
                |range: [f64; 2]| strip.points.iter().any(|point| (range[0]..=range[1]).contains(&point.factor));
            let mut check = |column: usize, end: f64, holds: &dyn Fn(f64) -> Option<bool>| {
                ends[column] += 1;
                let [below, above] = [0.99 * end, 1.01 * end].map(holds);
                let is_above_told = words[column].contains("not everywhere beyond");
                if below == Some(false) || above == Some(true) && !is_above_told {
                    let name = strip.name(str::to_owned);
                    wrong.push(format!("{seed} {name}: {column} {end}: {below:?} {above:?}; {words:?}"));
                }
            };
            for (column, percent) in [1.0, 5.0].into_iter().enumerate() {
                let end = strip.within(percent).filter(|end| *end > 0.0 && !words[column].starts_with("at least"));
                let holds = |factor: f64| {
                    solved(&scene, strip, factor).map_or(Some(false), |(error, _)| Some(error? <= percent))
                };
                end.into_iter().for_each(|end| check(column, end, &holds));
            }
            let end = strip.fails().first().map(|[end, _]| *end).filter(|end| *end > 0.0);
            let converges = |factor: f64| Some(solved(&scene, strip, factor).is_some());
            end.into_iter().for_each(|end| check(2, end, &converges));
            let end = strip.law_ends_at().filter(|end| is_tried([end / NEXT, 0.9999 * end]));
            let is_lawful = |factor: f64| solved(&scene, strip, factor).map(|(_, is_beyond)| !is_beyond);
            end.into_iter().for_each(|end| check(3, end, &is_lawful));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(ends.iter().sum::<usize>() >= 3 * seeds.len(), "{ends:?}");
}

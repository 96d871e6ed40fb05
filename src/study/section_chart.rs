//! Section forces as figures: the stress along a cut, and N, V and M along a beam.

use super::figure::{Figure, FigurePoint, FigureQuantity, FigureSeries, Ink, Mark};
use super::path_chart::Render;
use super::prelude::*;
use crate::format::Context;
use crate::section::{Section, SectionForces};

/// Component of section forces.
#[derive(Clone, Copy, Debug)]
pub struct SectionComponent {
    /// Name with its symbol.
    pub name: &'static str,
    /// Symbol.
    pub symbol: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Value, in this unit.
    pub of: fn(&SectionForces) -> f64,
}

/// Normal force, shear force and bending moment.
pub const COMPONENTS: [SectionComponent; 3] = [
    SectionComponent { name: "normal force N", symbol: "N", unit: "N", of: |forces| forces.normal },
    SectionComponent { name: "shear force V", symbol: "V", unit: "N", of: |forces| forces.shear },
    SectionComponent { name: "bending moment M", symbol: "M", unit: "N m", of: |forces| forces.moment },
];

/// Returns the contexts of the [`COMPONENTS`] of sections of one state: results below the rounding errors of the solve
/// are 0.
pub fn contexts(sections: &[Section], simulation: &Simulation) -> [Context; 3] {
    let size = simulation.system().size();
    let inexact = simulation.scene().solver.tolerance.max(simulation.residual()).min(Context::MAX_INEXACT);
    // The forces of a part without loads and supports are rounding errors of the whole body's.
    let mut whole: Vec<f64> = simulation.support_reactions().iter().map(|reaction| reaction.force.norm()).collect();
    // The residual is relative to the forces of single elements, which cancel in a section of a stiff beam.
    whole.extend(simulation.forces().magnitude.iter().map(|force| force.norm()));
    let forces = || {
        let own = sections.iter().flat_map(|section| [section.force.norm(), section.forces.moment.abs() / size]);
        own.chain(whole.iter().copied())
    };
    let force = Context::of_inexact(forces(), inexact);
    [force, force, Context::of_inexact(forces().map(|force| force * size), inexact)]
}

/// Formats the forces of a section: "N 12 kN, V 0 N, M -3.4 kN m".
pub fn text(section: &Section, contexts: &[Context; 3]) -> String {
    let values = COMPONENTS.iter().zip(contexts).map(|(SectionComponent { symbol, unit, of, .. }, within)| {
        format!("{symbol} {}", within.engineering(of(&section.forces), unit))
    });
    values.collect::<Vec<_>>().join(", ")
}

/// Formats the forces of a section of a state as [`text`], in the contexts of this section alone.
pub fn text_of(section: &Section, simulation: &Simulation) -> String {
    text(section, &contexts(std::slice::from_ref(section), simulation))
}

/// Number of points of a curve of beam theory, whose shear stress is a parabola.
const BEAM_POINTS: u32 = 25;

/// Names of the stresses on a cut, with their symbols: recovered and of beam theory.
pub const STRESSES: [(&str, &str, [&str; 2]); 2] = [
    ("\u{3c3}", "normal stress", ["normal stress, recovered", "normal stress, beam theory"]),
    ("\u{3c4}", "shear stress", ["shear stress, recovered", "shear stress, beam theory"]),
];

/// Draws the normal stress and the shear stress along a cut of a scene: recovered and by beam theory, against the distance
/// from the middle; the forces have these contexts, and `render` translates the names.
pub fn stress(section: &Section, scene: &Scene, contexts: &[Context; 3], render: Render<'_>) -> [Figure; 2] {
    [0, 1].map(|component| {
        let (_, name, names) = STRESSES[component];
        let recovered =
            section.points.iter().map(|p| vec![p.stress.map_or(f64::NAN, |stress| stress[component]), p.along]);
        let ends =
            [section.points.first(), section.points.last()].map(|point| point.filter(|point| point.beam.is_some()));
        let beam = || -> Vec<FigurePoint> {
            let [Some(first), Some(last)] = ends else { return Vec::new() };
            let along = |k: u32| first.along + (last.along - first.along) * f64::from(k) / f64::from(BEAM_POINTS - 1);
            let stress = |along: f64| section.beam_stress(scene.material.thickness, along)[component];
            (0..BEAM_POINTS).map(along).map(|along| vec![stress(along), along]).collect()
        };
        let series = |name: &str, ink, mark, points| FigureSeries::new(render(&name.into()), ink, mark, points);
        let method = Ink::of(&Setting::of(scene));
        let mut series = vec![
            series(names[0], method, Mark::Line, recovered.collect()),
            series(names[1], Ink::Text, Mark::Dashes, beam()),
        ];
        series.retain(|series| series.points.iter().any(|point| point.iter().all(|value| value.is_finite())));
        series.extend(COMPONENTS.iter().zip(contexts).map(|(SectionComponent { symbol, unit, of, .. }, within)| {
            let [value, of_stress] = [&section.forces, &section.stress_forces]
                .map(|forces| within.engineering(three_digits(of(forces)), unit));
            FigureSeries::row((*symbol).to_owned(), Ink::Scene, Mark::Disc, format!("{value} ({of_stress})"))
        }));
        let quantity = |name: &str, unit| FigureQuantity::new(render(&name.into()), unit);
        Figure {
            title: format!("{}: {}", render(&scene.name.as_str().into()), render(&"stress in a cut".into())),
            quantities: vec![quantity(name, "Pa"), quantity("distance from the middle", "m")],
            axes: [0, 1],
            series,
            head: [String::new(), render(&"in the cut (of the drawn stress)".into())],
        }
    })
}

/// Returns the largest value of a component in these sections, rounded within a context, and its position x, m: the first
/// one where the value is constant.
pub(crate) fn largest(sections: &[Section], component: &SectionComponent, within: &Context) -> Option<(f64, f64)> {
    /// Relative difference of equal values.
    const ROUNDING: f64 = 1e-6;
    let value = |section: &Section| within.rounded((component.of)(&section.forces));
    let largest = sections.iter().map(|section| value(section).abs()).max_by(f64::total_cmp)?;
    let first = sections.iter().find(|section| value(section).abs() >= (1.0 - ROUNDING) * largest)?;
    Some((value(first), first.line.at.x))
}

/// Draws N, V and M along a beam, each with its largest value; `render` translates the names.
pub fn forces(sections: &[Section], scene: &Scene, contexts: &[Context; 3], render: Render<'_>) -> [Figure; 3] {
    let of = |i: usize| {
        let SectionComponent { name, unit, of: value, .. } = COMPONENTS[i];
        let within = contexts[i];
        let value = |forces: &SectionForces| within.rounded(value(forces));
        let (ink, name) = (Ink::of(&Setting::of(scene)), render(&name.into()));
        let points = sections.iter().map(|section| vec![section.line.at.x, value(&section.forces)]);
        let values = || sections.iter().map(|section| value(&section.forces));
        let [low, high] = [values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)];
        let is_constant = three_digits(low) == three_digits(high);
        let largest = largest(sections, &COMPONENTS[i], &within).map(|(value, x)| {
            let at = match is_constant {
                true => sentence!("constant"),
                false => sentence!("largest, at %{at}", at = engineering(three_digits(x), "m")),
            };
            FigureSeries::row(render(&at), ink, Mark::Line, engineering(three_digits(value), unit))
        });
        let curve = FigureSeries { value: None, ..FigureSeries::new(name.clone(), ink, Mark::Line, points.collect()) };
        Figure {
            title: format!("{}: {name}", render(&scene.name.as_str().into())),
            quantities: vec![FigureQuantity::new(render(&"x at rest".into()), "m"), FigureQuantity::new(name, unit)],
            axes: [0, 1],
            series: std::iter::once(curve).chain(largest).collect(),
            ..Figure::default()
        }
    };
    [0, 1, 2].map(of)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::SectionLine;

    /// Beam theory's shear stress is drawn as a parabola, although the cut of one row of cells has few points.
    #[test]
    fn the_shear_stress_of_beam_theory_has_its_peak() {
        let scene = Scene::beam(10.0, 1.0).with_cells(5, 1).clamp("left").force("right", [0.0, -1000.0]);
        let mut beam = Simulation::new(&scene).unwrap();
        beam.solve();
        let section = beam.section(SectionLine { at: nalgebra::Vector2::new(5.0, 0.0), angle: 0.0 }).unwrap();
        let within = contexts(std::slice::from_ref(&section), &beam);
        let [_, figure] = stress(&section, &scene, &within, &ToString::to_string);
        let series = figure.series.iter().find(|series| series.name == "shear stress, beam theory").unwrap();
        let peak = series.points.iter().map(|point| point[0].abs()).fold(0.0, f64::max);
        let area = (section.ends[1] - section.ends[0]).norm() * scene.material.thickness;
        assert!((peak - 1.5 * section.forces.shear.abs() / area).abs() < 1e-9 * peak, "{peak}");
    }
}

//! Study of the computing time and memory of an iteration as functions of the number of unknowns.

use std::fmt::Write as _;
use std::time::Duration;

use super::timing::{Runs, median_time};
use super::{Extent, StudyError};
use crate::progress::{Observer, Progress};
use crate::scene::{ElementKind, MethodKind, Scene};
use crate::simulation::Simulation;

/// Measurement on one mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalingPoint {
    /// Element.
    pub element: ElementKind,
    /// Cells along and across.
    pub cells: [u32; 2],
    /// Number of free unknowns.
    pub dofs: usize,
    /// Time of an iteration of `newton`, ms, median.
    pub milliseconds: f64,
    /// Peak memory of meshing, setup and iteration, MiB; `None` if not measured, or too small to be measured.
    pub peak_mib: Option<f64>,
}

/// Meter of the memory of the process.
pub trait MemoryMeter {
    /// Starts a measurement.
    fn begin(&self);

    /// Returns the peak memory of the process since [`Self::begin`], minus that before all measurements, MiB; `None` if
    /// the system does not report it.
    fn peak_mib(&self) -> Option<f64>;
}

/// Power law fitted to the larger half of an element's meshes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exponents {
    /// Element.
    pub element: ElementKind,
    /// Exponent p of time ∝ unknownsᵖ.
    pub time: f64,
    /// Exponent p of memory ∝ unknownsᵖ, if memory was measured.
    pub memory: Option<f64>,
}

/// Scaling study of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Scaling {
    /// Name of the scene.
    pub scene: String,
    /// Measurements, by element from coarse to fine.
    pub points: Vec<ScalingPoint>,
    /// `true` if the study was cancelled before everything was measured.
    pub is_partial: bool,
}

/// Approximate numbers of unknowns of the meshes.
const UNKNOWNS: [f64; 11] = [1e2, 2e2, 5e2, 1e3, 2e3, 5e3, 1e4, 2e4, 5e4, 1e5, 2e5];
/// Number of meshes of a quick study.
const QUICK: usize = 5;
/// Time spent on the iterations of a mesh.
const MIN_TIME: Duration = Duration::from_millis(500);
/// Largest number of timed iterations per mesh.
const MAX_TIMED: usize = 101;
/// Smallest number of timed iterations per mesh.
const MIN_TIMED: usize = 3;
/// Smallest measurable memory increase, MiB.
const RESOLVED: f64 = 1.0;

impl Scaling {
    /// Measures a static scene with a beam, without other work on the machine; memory only if a meter is given. If
    /// cancelled, returns the measurements so far.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn new(
        scene: &Scene,
        extent: Extent,
        memory: Option<&dyn MemoryMeter>,
        observe: Observer<'_>,
    ) -> Result<Self, StudyError> {
        let Some(beam) = &scene.beam else { return Err(StudyError::NoBeam) };
        if scene.analysis == crate::scene::Analysis::Dynamic {
            return Err(StudyError::InMotion);
        }
        let unknowns = if extent == Extent::Quick { &UNKNOWNS[..QUICK] } else { &UNKNOWNS[..] };
        let all: f64 = unknowns.iter().sum::<f64>() * ElementKind::all().count() as f64;
        let mut study = Self { scene: scene.name.clone(), points: Vec::new(), is_partial: false };
        let mut done = 0.0;
        // Small meshes of all elements first: memory kept by the allocator is then no more than the next mesh needs.
        for (&unknowns, element) in unknowns.iter().flat_map(|n| ElementKind::all().map(move |e| (n, e))) {
            let cells = cells(element, beam.length / beam.height, unknowns);
            let now = super::trade::mesh_text(element, Some(cells));
            if observe(Progress { fraction: done / all, now: Some(&now) }).is_break() {
                study.is_partial = true;
                break;
            }
            study.points.push(measure(scene, element, cells, memory)?);
            done += unknowns;
        }
        study.points.sort_by_key(|p| p.element as usize);
        if study.points.is_empty() { Err(StudyError::Cancelled) } else { Ok(study) }
    }

    fn of(&self, element: ElementKind) -> Vec<&ScalingPoint> {
        self.points.iter().filter(|p| p.element == element).collect()
    }

    /// Returns the exponents of every element with enough meshes.
    #[must_use]
    pub fn exponents(&self) -> Vec<Exponents> {
        let fit = |element| {
            let points = self.of(element);
            let larger = &points[points.len() / 2..];
            let of = |value: fn(&ScalingPoint) -> Option<f64>| {
                slope(larger.iter().filter_map(|p| Some(((p.dofs as f64).ln(), value(p)?.ln()))).collect())
            };
            Some(Exponents { element, time: of(|p| Some(p.milliseconds))?, memory: of(|p| p.peak_mib) })
        };
        ElementKind::all().filter_map(fit).collect()
    }

    /// Formats the study as CSV.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = String::from("element,cells_along,cells_across,dofs,iteration_ms,peak_mib\n");
        for p in &self.points {
            let [along, across] = p.cells;
            let memory = p.peak_mib.map_or_else(String::new, |m| format!("{m:.1}"));
            let _ = writeln!(text, "{},{along},{across},{},{:.5},{memory}", p.element.id(), p.dofs, p.milliseconds);
        }
        text
    }

    /// Formats a summary for display.
    #[must_use]
    pub fn summary(&self) -> String {
        let mut text = format!("{}: an iteration of `newton`, by unknowns\n\n", self.scene);
        text.push_str("element   unknowns  iteration, ms  µs per unknown   memory, MiB\n");
        for p in &self.points {
            let memory = p.peak_mib.map_or_else(|| "–".to_owned(), |m| format!("{m:.1}"));
            let each = p.milliseconds * 1e3 / p.dofs as f64;
            let _ = writeln!(
                text,
                "{:7} {:>10} {:>14.4} {each:>15.3} {memory:>13}",
                p.element.id(),
                p.dofs,
                p.milliseconds
            );
        }
        text.push('\n');
        for e in self.exponents() {
            let memory = e.memory.map_or_else(String::new, |m| format!(", memory ∝ unknowns^{m:.2}"));
            let _ = writeln!(text, "{}: time ∝ unknowns^{:.2}{memory} (larger half)", e.element.id(), e.time);
        }
        text
    }
}

/// Returns the cells of a beam with this length over height for about `unknowns` unknowns.
fn cells(element: ElementKind, slenderness: f64, unknowns: f64) -> [u32; 2] {
    let pieces = element.entry().degree() as f64;
    let across = (0.5 * unknowns / slenderness).sqrt();
    // There is one more node than pieces across, which matters for thin beams.
    let across = ((across - 0.5) / pieces).round().max(1.0);
    let along = (0.5 * unknowns / (across * pieces + 1.0) / pieces).round().max(1.0);
    [along as u32, across as u32]
}

fn measure(
    scene: &Scene,
    element: ElementKind,
    cells: [u32; 2],
    memory: Option<&dyn MemoryMeter>,
) -> Result<ScalingPoint, StudyError> {
    let setting = super::Setting { element, cells: Some(cells), method: MethodKind::Newton, iterations: 1 };
    memory.iter().for_each(|meter| meter.begin());
    let mut simulation = Simulation::new(&setting.apply(scene))?;
    // The first iteration warms up.
    simulation.step();
    let runs = Runs { count: MIN_TIMED..=MAX_TIMED, enough: MIN_TIME };
    let time = median_time(runs, &mut simulation, Simulation::reset, |simulation| {
        simulation.step();
    });
    let milliseconds = time.as_secs_f64() * 1e3;
    let peak_mib = memory.and_then(MemoryMeter::peak_mib).filter(|&mib| mib >= RESOLVED);
    Ok(ScalingPoint { element, cells, dofs: simulation.system().dofs(), milliseconds, peak_mib })
}

/// Returns the slope of the regression line through some points; `None` for fewer than two different abscissas.
fn slope(points: Vec<(f64, f64)>) -> Option<f64> {
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let (top, below) =
        points.iter().fold((0.0, 0.0), |(top, below), p| (top + (p.0 - x) * (p.1 - y), below + (p.0 - x) * (p.0 - x)));
    (below > 0.0).then(|| top / below)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_have_about_the_requested_unknowns() {
        for element in ElementKind::all() {
            for unknowns in UNKNOWNS {
                let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -1.0]);
                let cells = cells(element, 10.0, unknowns);
                let setting =
                    super::super::Setting { element, cells: Some(cells), method: MethodKind::Newton, iterations: 1 };
                if unknowns <= 2e4 {
                    let dofs = Simulation::new(&setting.apply(&scene)).map(|s| s.system().dofs());
                    assert!(dofs.is_ok_and(|n| (0.6..1.7).contains(&(n as f64 / unknowns))), "{element:?} {cells:?}");
                }
            }
        }
    }

    #[test]
    fn a_power_law_has_its_exponent() {
        let points = [1.0f64, 3.0, 10.0, 40.0].map(|x| (x.ln(), (0.2 * x.powf(1.3)).ln()));
        assert!(slope(points.to_vec()).is_some_and(|p| (p - 1.3).abs() < 1e-12));
        assert_eq!(slope(vec![(1.0, 2.0)]), None);
    }
}

//! Plan of a study of motions: meshes, integrators, time steps, methods and numbers of solves, and sampling times.

use std::f64::consts::TAU;
use std::time::Duration;

use crate::assembly::{Mass, Problem};
use crate::dynamics::lowest_frequency;
use crate::study::prelude::*;
use crate::study::reference::system_of;

// Values of a quick and of a full study.

/// Longest simulated time, in periods of the body's lowest natural frequency and in time steps; the longer counts.
const LONGEST: [(f64, f64); 2] = [(2.0, 60.0), (4.0, 120.0)];
/// Largest number of samples of a path; a longer motion is sampled, and stepped, more coarsely.
const MAX_SAMPLES: [f64; 2] = [240.0, 480.0];
/// Longest time step relative to the scene's.
const COARSEST: [f64; 2] = [1.0, 2.0];
/// Numbers of time steps per sampling interval, which is the longest time step.
const STEPS: [&[u32]; 2] = [&[1, 2, 4], &[1, 2, 4, 8, 16]];
/// Number of reference steps between samples: four in the shortest step of the settings.
pub(in crate::study) const REFERENCE_STEPS: [u32; 2] = [4 * STEPS[0][2], 4 * STEPS[1][4]];
/// Numbers of solves per step; 0 iterates to the tolerance.
const SOLVES: [&[u32]; 2] = [&[1, 0], &[1, 2, 0]];
/// Numbers of nodes along the beam relative to the scene's mesh.
const MESHES: [&[f64]; 2] = [&[0.5, 1.0], &[0.25, 0.5, 1.0, 1.5]];
/// Number of nodes along the beam of the reference's mesh, relative to the scene's.
pub(super) const REFERENCE_MESH: [f64; 2] = [2.0, 3.0];
/// Largest number of steps of a run; longer ones are shortened.
pub(super) const MAX_STEPS: [u32; 2] = [20_000, 100_000];
/// Time spent on timing a setting.
pub(super) const TIMING: [Duration; 2] = [Duration::from_millis(20), Duration::from_millis(200)];

/// Step of the explicit integrator relative to its critical step.
const BELOW_CRITICAL: f64 = 0.9;
/// Smallest number of steps in a scene; a shorter scene is studied with shorter steps.
const MIN_STEPS: f64 = 8.0;
/// Largest number of nodes, along times across, of a mesh with `factor` 1.
const MAX_NODES: f64 = 1000.0;

/// Sampling times of paths: multiples of the longest time step.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Samples {
    /// Time between two samples, s.
    pub interval: f64,
    /// Number of samples, without the start.
    pub count: u32,
}

impl Samples {
    /// Returns the sampling times of a scene.
    pub(in crate::study) fn of(scene: &Scene, extent: Extent) -> Result<Self> {
        let (periods, steps) = extent.pick(LONGEST);
        let own = scene.dynamics.time_step;
        let system = system_of(scene)?;
        let mass = Mass::new(&system, scene.material.area_density());
        let problem = Problem::new(scene, system)?;
        // A body that is free to move has no lowest period.
        let frequency = lowest_frequency(&problem, &mass).filter(|frequency| *frequency > 0.0);
        let period = frequency.map(|frequency| TAU / frequency).filter(|period| period.is_finite());
        let longest = period.map_or(0.0, |period| periods * period).max(steps * own);
        let duration = scene.dynamics.duration.min(longest);
        let mut interval = (extent.pick(COARSEST) * own).min(duration / MIN_STEPS);
        // Doubled, so that the scene's own step remains one of the measured steps.
        while duration / interval > extent.pick(MAX_SAMPLES) {
            interval *= 2.0;
        }
        Ok(Self { interval, count: (duration / interval * (1.0 + 1e-9)).floor().max(1.0) as u32 })
    }

    /// Returns the time from the start to the last sample, s.
    pub fn duration(self) -> f64 {
        self.interval * f64::from(self.count)
    }
}

/// Returns the longer side of a scene's beam relative to the shorter one; `None` for a mesh file.
pub(super) fn slenderness(scene: &Scene) -> Option<f64> {
    let beam = scene.beam.as_ref()?;
    let ratio = beam.length / beam.height;
    Some(ratio.max(1.0 / ratio))
}

/// Returns the numbers of nodes in x and y that the shape of a scene's beam requires: `per_height` along for each height, but
/// not more than always suffice, and `across`; `None` for a mesh file.
pub(super) fn nodes_of_shape(scene: &Scene, per_height: f64, across: f64) -> Option<[f64; 2]> {
    /// Number of nodes along that always suffices.
    const ALONG: f64 = 80.0;
    let beam = scene.beam.as_ref()?;
    let along = (per_height * slenderness(scene)?).min(ALONG);
    Some(if beam.length >= beam.height { [along, across] } else { [across, along] })
}

/// Returns the cells of a mesh whose numbers of nodes along and across are `factor` times the scene's, or those that the
/// shape of the beam requires if these are more: a scene with a coarse mesh, such as one that a study has recommended, is
/// studied on the same meshes as one with a finer mesh. `None` for a mesh file.
pub(super) fn cells(scene: &Scene, element: ElementKind, factor: f64) -> Option<[u32; 2]> {
    /// Smallest number of nodes along per height, and across.
    const PER_HEIGHT: f64 = 4.0;
    const ACROSS: f64 = 2.0;
    let beam = scene.beam.as_ref()?;
    let pieces = |element: ElementKind| element.entry().degree() as f64;
    let least = nodes_of_shape(scene, PER_HEIGHT, ACROSS)?;
    let own = [0, 1].map(|i| least[i].max(f64::from(beam.cells[i]) * pieces(beam.element)));
    // A scene with a very fine mesh is studied on coarser ones.
    let factor = factor * (MAX_NODES / (own[0] * own[1])).sqrt().min(1.0);
    Some(own.map(|n| (n * factor / pieces(element)).round().max(1.0) as u32))
}

/// Returns every mesh of a scene, from coarse to fine for each element. Each has the same settings, and the weight 1.
pub(in crate::study) fn meshes(scene: &Scene, extent: Extent) -> Vec<(Setting, f64)> {
    let of = |element| {
        extent.pick(MESHES).iter().map(move |&factor| (Setting::newton(element, cells(scene, element, factor)), 1.0))
    };
    let mut meshes: Vec<(Setting, f64)> = scene.elements().flat_map(of).collect();
    meshes.dedup();
    meshes
}

/// Returns all settings measured on a mesh, each with its number of steps between samples. `critical` is the critical step
/// of the explicit integrator there, s.
pub(super) fn settings(mesh: Setting, critical: Option<f64>, samples: Samples, extent: Extent) -> Vec<(Setting, u32)> {
    let interval = samples.interval;
    let stable = (interval / critical.map_or(interval, |critical| BELOW_CRITICAL * critical)).ceil().max(1.0) as u32;
    let mut settings = Vec::new();
    for integrator in INTEGRATORS {
        for &steps in if integrator.is_explicit() { std::slice::from_ref(&stable) } else { extent.pick(STEPS) } {
            let stepping = Stepping { integrator: integrator.kind, time_step: interval / f64::from(steps) };
            // Without a matrix, methods differ only in the theory.
            let differs = |method: MethodKind| match integrator.is_explicit() {
                true => matches!(method, MethodKind::Linear | MethodKind::Newton),
                false => extent == Extent::Full || method != MethodKind::Warped,
            };
            // Numbers of solves that give different results.
            let solves = |method: MethodKind| match integrator.is_explicit() || integrator.always_iterates {
                true => &[0],
                // A single solve is exact.
                false if method.moves_linearly() => &[1],
                false => extent.pick(SOLVES),
            };
            for method in METHODS.iter().map(|m| m.kind).filter(|&method| differs(method)) {
                let of = |&iterations| (Setting { method, iterations, stepping: Some(stepping), ..mesh }, steps);
                settings.extend(solves(method).iter().map(of));
            }
        }
    }
    settings
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scene with a mesh that a study has recommended is studied on the same meshes as the scene it came from.
    #[test]
    fn coarse_scenes_are_studied_on_the_meshes_of_finer_ones() {
        const ELEMENTS: [ElementKind; 3] = [ElementKind::T3, ElementKind::T6, ElementKind::Q4];
        let [t3, t6, q4] = ELEMENTS;
        let of = |element, along, kind, factor| {
            cells(&Scene::beam(1.0, 0.1).with_element(element).with_cells(along, 1), kind, factor)
        };
        for (element, along) in [(q4, 20), (q4, 10), (t3, 40), (t6, 10)] {
            for (kind, factor) in ELEMENTS.into_iter().flat_map(|kind| [0.5, 1.0, 1.5].map(|factor| (kind, factor))) {
                assert_eq!(of(element, along, kind, factor), of(t6, 20, kind, factor), "{element:?} {kind:?} {factor}");
            }
        }
        assert_eq!(of(t6, 40, t6, 1.0), Some([40, 1]), "a finer scene keeps its own");
    }
}

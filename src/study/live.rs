//! Reference solution that follows a dragged load: fine solutions on a few small meshes, each of which goes on from its own
//! last state.

use super::fine::{Meshes, errors, places, prepared};
use super::prelude::*;
use super::reference::{MovedPoint, Reference, probes_of};
use crate::scene::SolverSettings;

/// Largest number of unknowns of a mesh.
const MAX_UNKNOWNS: usize = 3500;
/// Largest sum of unknowns over the iterations that follow a load: about 50 ms.
const MAX_WORK: usize = 40_000;
/// Largest sum for the first solution, which starts from rest.
const MAX_FIRST_WORK: usize = 400_000;

/// Fine solutions of a scene that follow its load.
#[derive(Debug)]
pub(crate) struct LiveReference {
    /// Scene without the values of its loads, to which the meshes belong.
    key: Scene,
    /// Scene of the solutions: its points are at nodes.
    own: Scene,
    /// Solutions, from the coarsest mesh to the finest.
    levels: Vec<Simulation>,
    /// Linear theory on the finest mesh.
    linear: Simulation,
    moved: Vec<MovedPoint>,
    is_started: bool,
}

impl LiveReference {
    /// Makes the meshes of a scene at rest; `None` if they are too large for a drag.
    pub(crate) fn new(scene: &Scene) -> Option<Self> {
        let mut own = prepared(scene);
        let (mut meshes, moved) = Meshes::of(&mut own, None, Extent::Quick).ok()?;
        let mut levels = Vec::new();
        loop {
            let level = Simulation::with_mesh(&own, meshes.mesh().ok()?).ok()?;
            let (dofs, nodes) = (level.system().dofs(), level.mesh().nodes().len());
            levels.push(level);
            if 4 * dofs > MAX_UNKNOWNS {
                break;
            }
            meshes.refine(&vec![Default::default(); nodes]);
        }
        let finest = levels.last().filter(|finest| levels.len() > 1 && finest.system().dofs() <= MAX_UNKNOWNS)?;
        let linear =
            Simulation::with_system(&own.clone().with_method(MethodKind::Linear), finest.system().clone()).ok()?;
        Some(Self { key: key(scene), own, levels, linear, moved, is_started: false })
    }

    /// Returns `true` if the meshes are those of a scene.
    pub(crate) fn suits(&self, scene: &Scene) -> bool {
        Scene { material: self.key.material, ..key(scene) } == self.key
    }

    /// Returns the reference solution of a scene under another load; `None` if it is not found soon.
    pub(crate) fn follow(&mut self, scene: &Scene) -> Option<Reference> {
        // The points of the solutions are at nodes.
        let mut own = Scene { beam: self.own.beam.clone(), ..prepared(scene) };
        places(&mut own).zip(places(&mut self.own)).for_each(|((_, to, _), (_, from, _))| to.clone_from(from));
        let goes_on = std::mem::replace(&mut self.is_started, false);
        if !(goes_on && self.solve(&own, MAX_WORK)) {
            // Far from the last load.
            self.levels.iter_mut().for_each(Simulation::reset);
            self.solve(&own, MAX_FIRST_WORK).then_some(())?;
        }
        self.is_started = true;
        self.linear.change_scene(&own.with_method(MethodKind::Linear)).ok()?;
        self.linear.solve();
        let [.., _, finest] = self.levels.as_slice() else { return None };
        let solutions: Vec<_> = self.levels.iter().map(probes_of).collect();
        let [.., coarse, fine] = solutions.as_slice() else { return None };
        // The displacements of the probes are extrapolated from the two finest meshes.
        let probes = coarse.iter().zip(fine).map(|(coarse, fine)| fine + (fine - coarse) / 3.0);
        let solved: Vec<_> = probes.zip(errors(&solutions, self.own.acts_on_points())).collect();
        Some(Reference::of_finest(scene, finest, &solved, &self.linear, self.moved.clone(), false))
    }

    /// Solves every level under the loads of a scene; returns `false` if that takes more than `left` unknowns times
    /// iterations, or a level has no sound solution.
    fn solve(&mut self, scene: &Scene, mut left: usize) -> bool {
        self.levels.iter_mut().all(|level| {
            let mut goes_on = level.change_scene(scene).is_ok();
            while goes_on && *level.status() == Status::Running {
                let before = level.iterations();
                level.step();
                let work = level.system().dofs() * level.iterations().saturating_sub(before).max(1) as usize;
                goes_on = left >= work;
                left = left.saturating_sub(work);
            }
            *level.status() == Status::Converged
                && level.system().elements().smallest_area_ratio(level.displacement()) > 0.0
        })
    }
}

/// Returns a scene without the values of its loads and without the settings of its own solution.
fn key(scene: &Scene) -> Scene {
    let mut scene = prepared(scene);
    scene.scale_loads(0.0);
    scene.solver = SolverSettings::default();
    if let Some(beam) = &mut scene.beam {
        beam.cells = [1, 1];
    }
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Far from the last load, the solutions start from rest.
    #[test]
    fn a_load_that_jumps_has_a_reference() {
        let source = crate::scene::Source { name: "incline".into(), assignments: Vec::new() };
        let mut scene = crate::scene::open(&source).unwrap();
        let mut live = LiveReference::new(&scene).unwrap();
        for factor in [1.0, -0.9, -1.1, -1.0, -0.5] {
            scene.scale_loads(factor);
            assert!(live.follow(&scene).is_some(), "{factor}");
        }
    }
}

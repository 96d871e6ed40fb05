//! Settings that a study varies, and their names.

use crate::scene::{Analysis, ElementKind, IntegratorKind, MethodKind, Scene};
use crate::sentence::{Sentence, displayed, sentence};

/// Parameters varied in the study.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Setting {
    /// Element.
    pub element: ElementKind,
    /// Cells along and across; `None` for the mesh of a file.
    pub cells: Option<[u32; 2]>,
    /// Method. For an explicit integrator, which has no matrix, only the theory.
    pub method: MethodKind,
    /// Number of iterations of a solve; of a motion, solves per step, or per stage of one. 0 iterates to the solver's
    /// tolerance.
    pub iterations: u32,
    /// Time stepping of a motion; `None` for a body at rest.
    pub stepping: Option<Stepping>,
}

/// Time stepping of a motion.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Stepping {
    /// Integrator.
    pub integrator: IntegratorKind,
    /// Time step, s.
    pub time_step: f64,
}

impl Setting {
    /// Returns the setting of a scene.
    pub fn of(scene: &Scene) -> Self {
        let dynamics = &scene.dynamics;
        let moves = scene.analysis == Analysis::Dynamic;
        Self {
            element: scene.element(),
            cells: scene.beam.as_ref().map(|b| b.cells),
            method: scene.solver.method,
            iterations: if moves { dynamics.iterations } else { scene.solver.accept_after },
            stepping: moves.then_some(Stepping { integrator: dynamics.integrator, time_step: dynamics.time_step }),
        }
    }

    /// Returns the setting of a solve by Newton's method on a mesh.
    pub(super) fn newton(element: ElementKind, cells: Option<[u32; 2]>) -> Self {
        Self { element, cells, method: MethodKind::Newton, iterations: 0, stepping: None }
    }

    /// Returns the identifier of the integrator, or of the method at rest.
    pub(crate) fn series(&self) -> &'static str {
        self.stepping.map_or(self.method.id(), |stepping| stepping.integrator.id())
    }

    /// Returns the scene with this setting.
    pub fn apply(&self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        scene.set_element(self.element);
        if let (Some(beam), Some(cells)) = (&mut scene.beam, self.cells) {
            beam.cells = cells;
        }
        scene.solver.method = self.method;
        scene.solver.accept_after = if self.stepping.is_none() { self.iterations } else { 0 };
        if let Some(Stepping { integrator, time_step }) = self.stepping {
            let dynamics = &mut scene.dynamics;
            (dynamics.integrator, dynamics.time_step, dynamics.iterations) = (integrator, time_step, self.iterations);
        }
        scene
    }
}

displayed!(Setting);

impl From<&Setting> for Sentence {
    fn from(setting: &Setting) -> Self {
        let Setting { element, cells, method, iterations, stepping } = *setting;
        let mesh = mesh_text(element, cells);
        let Some(stepping) = stepping else {
            let count = Self::count(iterations, "iteration");
            return sentence!("%{mesh}, %{method}, %{count}", mesh, method = method.id(), count);
        };
        let integrator = stepping.integrator.entry();
        let theory = match method {
            method if method.moves_linearly() => "linear theory",
            _ if integrator.is_explicit() => "corotated",
            method => method.id(),
        };
        let solves = match (iterations, integrator.stages > 1) {
            _ if integrator.is_explicit() => sentence!("no solve"),
            (0, _) => sentence!("to tolerance"),
            (n, true) => sentence!("%{solves} a stage", solves = Self::count(n, "solve")),
            (n, false) => sentence!("%{solves} a step", solves = Self::count(n, "solve")),
        };
        sentence!(
            "%{mesh}, %{theory}, %{integrator}, %{step}, %{solves}",
            integrator = integrator.id,
            step = step_text(stepping.time_step),
            mesh,
            theory,
            solves
        )
    }
}

/// Describes a time step: `1/60 s` if it is that fraction.
pub(super) fn step_text(step: f64) -> String {
    let rate = 1.0 / step;
    if rate >= 1.5 && (rate - rate.round()).abs() < 1e-6 * rate {
        format!("1/{} s", rate.round())
    } else {
        format!("{step:.3e} s")
    }
}

pub(super) fn mesh_text(element: ElementKind, cells: Option<[u32; 2]>) -> Sentence {
    match cells {
        Some([along, across]) => format!("{} {along}×{across}", element.id()).into(),
        None => sentence!("%{element} as meshed", element = element.id()),
    }
}

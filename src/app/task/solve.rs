//! Model of a scene, the quality of its result, and its solve in the background: request, progress and result.

use std::ops::ControlFlow;

use crate::app::platform::IS_PAGE;
use crate::app::prelude::*;
use crate::app::task::thread::{Reporter, Task};
use crate::assembly::System;
use crate::render::display_geometry::DisplayGeometry;
use crate::scene::{Beam, Invalid, Material, MeshFile, SolverSettings};
use crate::simulation::{Deformation, Equilibrium, SimulationError, StressResult};
use crate::stress::{inversion_warning, strain_warning};

/// Largest number of unknowns of a model that is meshed and solved between two frames.
pub(crate) const MAX_UNKNOWNS: u64 = 16_000;
/// Largest number of unknowns of a model that is solved between two frames in a pane of Compare, which shows several.
pub(crate) const MAX_PANE_UNKNOWNS: u64 = 4000;

/// Largest number of residuals recorded for one solve.
const MAX_RESIDUALS: usize = 400;

/// Equations of a scene's mesh, and its display geometry, that several models share.
#[derive(Clone, Debug)]
pub(crate) struct Equations {
    beam: Option<Beam>,
    mesh: Option<MeshFile>,
    pub system: Arc<System>,
    geometry: Arc<DisplayGeometry>,
}

/// Simulation with everything that is displayed with it.
pub(crate) struct Model {
    pub simulation: Simulation,
    /// Solution of linear theory on the same equations; `None` if it could not be set up, or has not been asked for.
    pub linear: Option<Simulation>,
    pub geometry: Arc<DisplayGeometry>,
    /// Residual after every iteration since the last change.
    pub residuals: Vec<f64>,
    pub quality: Quality,
}

impl Model {
    /// Creates the model of a simulation on a mesh with this display geometry, or a new one.
    pub(crate) fn new(simulation: Simulation, geometry: Option<Arc<DisplayGeometry>>) -> Self {
        let geometry = geometry.unwrap_or_else(|| Arc::new(DisplayGeometry::new(simulation.system().mesh())));
        Self { simulation, linear: None, geometry, residuals: Vec::new(), quality: Quality::default() }
    }

    /// Makes an iteration, and records its residual; a new solve starts a new list.
    pub(crate) fn step(&mut self) {
        self.simulation.step();
        if self.simulation.iterations() <= 1 || self.residuals.len() >= MAX_RESIDUALS {
            self.residuals.clear();
        }
        self.residuals.push(self.simulation.residual());
    }

    /// Returns a copy to display while the solve goes on; `None` for a motion, which has no search.
    pub(crate) fn snapshot(&self) -> Option<Self> {
        Some(Self {
            simulation: self.simulation.equilibrium()?.snapshot(),
            linear: self.linear.as_ref().and_then(Simulation::equilibrium).map(Equilibrium::snapshot),
            geometry: self.geometry.clone(),
            residuals: self.residuals.clone(),
            quality: self.quality.clone(),
        })
    }

    /// Returns the equations, for models on the same mesh.
    pub(crate) fn equations(&self) -> Equations {
        let Scene { beam, mesh, .. } = self.simulation.scene();
        let (system, geometry) = (self.simulation.system().clone(), self.geometry.clone());
        Equations { beam: beam.clone(), mesh: mesh.clone(), system, geometry }
    }
}

/// Quality of the last state that was evaluated.
#[derive(Clone, Debug, Default)]
pub(crate) struct Quality {
    of: Option<(Vec<Vector2<f64>>, Material)>,
    pub stress: StressResult,
    pub deformation: Deformation,
    elements: usize,
}

impl Quality {
    /// Certifies the result of a simulation, and computes its quality.
    pub(crate) fn certified(simulation: &mut Simulation) -> Self {
        let mut quality = Self::default();
        simulation.certify();
        quality.update(simulation);
        quality
    }

    /// Computes the quality of the current state, unless it is already known.
    pub(crate) fn update(&mut self, simulation: &Simulation) {
        if self.is_of(simulation) {
            return;
        }
        let nodal = simulation.nodal_stress();
        self.stress = StressResult::of(simulation.problem(), simulation.state(), &nodal);
        self.deformation = Deformation::of(simulation.problem(), simulation.state(), &nodal);
        self.elements = simulation.mesh().element_count();
        self.of = Some((simulation.displacement().to_vec(), *simulation.problem().material()));
    }

    /// Returns `true` if the quality is that of the simulation's state.
    pub(crate) fn is_of(&self, simulation: &Simulation) -> bool {
        let (u, material) = (simulation.displacement(), simulation.problem().material());
        self.of.as_ref().is_some_and(|(known, of)| known == u && of == material)
    }

    /// Returns `true` if an element is turned inside out, which no real body can be. For a state that has not been
    /// evaluated it is computed here.
    pub(crate) fn is_inside_out(&self, simulation: &Simulation) -> bool {
        if self.is_of(simulation) {
            return self.deformation.inverted_elements > 0;
        }
        simulation.system().elements().smallest_area_ratio(simulation.displacement()) <= 0.0
    }

    /// Returns the warnings for inverted elements and for large strains.
    pub(crate) fn warnings(&self) -> impl Iterator<Item = Sentence> {
        let Deformation { inverted_elements, max_strain, .. } = self.deformation;
        inversion_warning(inverted_elements, self.elements).into_iter().chain(strain_warning(max_strain))
    }
}

/// Part of a model that exists before a solve.
pub(crate) enum ModelBase {
    Model(Box<Model>),
    Equations(Equations),
    /// Nothing: a mesh is made first.
    None,
}

impl ModelBase {
    /// Returns the equations for a scene's mesh, if they are among `known`.
    pub(crate) fn among(known: &[Equations], scene: &Scene) -> Self {
        let own = known.iter().find(|own| own.beam == scene.beam && own.mesh == scene.mesh);
        own.cloned().map_or(Self::None, Self::Equations)
    }

    /// Sets up the model of a scene, before its first iteration.
    pub(crate) fn set_up(self, scene: &Scene) -> Result<Box<Model>, SimulationError> {
        Ok(match self {
            Self::Model(mut model) => {
                if model.simulation.scene() != scene {
                    model.simulation.change_scene(scene)?;
                }
                model
            }
            Self::Equations(Equations { system, geometry, .. }) => {
                Box::new(Model::new(Simulation::with_system(scene, system)?, Some(geometry)))
            }
            Self::None => {
                check_size(scene)?;
                Box::new(Model::new(Simulation::new(scene)?, None))
            }
        })
    }
}

pub(crate) struct SolveRequest {
    pub scene: Scene,
    pub base: ModelBase,
    /// `true` if the solve starts from rest, not from the state of its base.
    pub from_rest: bool,
    /// Largest number of iterations; `None` for no limit.
    pub iterations: Option<u32>,
    /// `true` if the main view shows the model: the solve then also computes the solution of linear theory and the quality.
    pub is_displayed: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    Meshing,
    LinearSolve,
    /// Iterating, with the number of iterations made.
    Iterating(u32),
    Certifying,
}

/// Solved model, or the error of a scene that has none.
pub(crate) type SolveOutcome = Result<Box<Model>, SimulationError>;

/// Solve in a background thread, or on a web page after the current frame. Dropping it cancels it.
pub(crate) struct BackgroundSolve {
    pub task: Task<Phase, SolveOutcome>,
    /// Scene that is solved.
    pub scene: Scene,
    pub phase: Phase,
}

impl BackgroundSolve {
    /// Starts the thread, if the system can start another one.
    pub(crate) fn start(request: SolveRequest) -> std::io::Result<Self> {
        let phase = if matches!(request.base, ModelBase::None) { Phase::Meshing } else { Phase::Iterating(0) };
        let scene = request.scene.clone();
        let work = move |reporter: &Reporter<_, _>| run(request, &|phase| reporter.report(phase));
        Ok(Self { task: Task::start("solve", work)?, scene, phase })
    }
}

/// Returns the scene with linear theory as the method.
pub(crate) fn linear_scene(scene: &Scene) -> Scene {
    let solver = SolverSettings { method: MethodKind::Linear, ..scene.solver.clone() };
    Scene { solver, ..scene.clone() }
}

/// Solves a static scene with linear theory on existing equations; `None` for a motion. `known` is the solution of the
/// previous scene.
pub(crate) fn solve_linear(scene: &Scene, system: &Arc<System>, known: Option<Simulation>) -> Option<Simulation> {
    if scene.analysis == Analysis::Dynamic {
        return None;
    }
    let scene = linear_scene(scene);
    let mut shared = known.filter(|linear| Arc::ptr_eq(linear.system(), system));
    shared = shared.and_then(|mut linear| linear.change_scene(&scene).is_ok().then_some(linear));
    let mut linear = shared.or_else(|| Simulation::with_system(&scene, system.clone()).ok())?;
    linear.solve();
    Some(linear)
}

/// Refuses a model that takes too long for a web page, which solves it on its own thread.
pub(crate) fn check_size(scene: &Scene) -> Result<(), SimulationError> {
    let (most, n) = (MAX_UNKNOWNS, scene.unknowns());
    if !IS_PAGE || n <= most {
        return Ok(());
    }
    let key = if scene.mesh.is_some() { "mesh.file" } else { "beam.cells" };
    let [most, n] = [most, n].map(|n| n as usize);
    Err(Invalid::new(
        key,
        sentence!(
            "expected at most %{most} unknowns on a web page, got %{n}; the program for desktops solves larger models",
            most,
            n
        ),
    )
    .into())
}

/// Solves; `report` breaks to cancel.
fn run(request: SolveRequest, report: &dyn Fn(Phase) -> ControlFlow<()>) -> SolveOutcome {
    let SolveRequest { scene, base, from_rest, iterations, is_displayed } = request;
    let is_new = matches!(base, ModelBase::None);
    let mut model = base.set_up(&scene)?;
    if is_new {
        // Smooth fields need the nodal recovery; computing it here avoids a delay between two frames.
        let _ = model.simulation.system().recovery();
    }
    if from_rest {
        model.simulation.reset();
    }
    if is_displayed && model.linear.as_ref().is_none_or(|linear| *linear.scene() != linear_scene(&scene)) {
        let known = model.linear.take();
        if report(Phase::LinearSolve).is_continue() {
            model.linear = solve_linear(&scene, model.simulation.system(), known);
        }
    }
    let is_search = model.simulation.motion().is_none();
    let mut made = 0;
    while is_search
        && *model.simulation.status() == Status::Running
        && iterations.is_none_or(|most| made < most)
        && report(Phase::Iterating(model.simulation.iterations())).is_continue()
    {
        model.step();
        made += 1;
    }
    let has_ended = is_search && *model.simulation.status() != Status::Running;
    if is_displayed && has_ended && report(Phase::Certifying).is_continue() {
        model.quality = Quality::certified(&mut model.simulation);
    }
    Ok(model)
}

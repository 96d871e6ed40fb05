//! Views of a simulation: results that only a search for an equilibrium has, and results that only a motion has.

use super::motion::{Moment, TimeStepping, has_lumped_mass};
use super::search::Search;
use super::{Body, Process, Simulation, Status};
use crate::dynamics::{Counts, Ledger, Momentum};
use crate::method::{AutoReport, Certificate, Decision, PathEvents};

/// Results of a search for an equilibrium; returned by [`Simulation::equilibrium`].
///
/// ```
/// use warpbeam::{Scene, Simulation};
///
/// let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -500.0]);
/// let mut beam = Simulation::new(&scene)?;
/// beam.solve();
/// let search = beam.equilibrium().ok_or("a static scene has a search")?;
/// assert_eq!((search.load_factor(), search.load_steps()), (1.0, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Equilibrium<'a> {
    pub(super) search: &'a Search,
    pub(super) body: &'a Body,
}

impl Equilibrium<'_> {
    /// Returns the result of [`Simulation::certify`], if it was called since the last change.
    pub fn certificate(self) -> Option<Certificate> {
        self.search.certificate
    }

    /// Returns `true` if the state can be certified, and has not been since the last change.
    #[cfg(feature = "app")]
    pub(crate) fn needs_certificate(self) -> bool {
        self.search.certificate.is_none() && self.search.can_be_certified(self.body)
    }

    /// Returns the decisions of `auto`; `None` for other methods.
    #[doc(hidden)]
    pub fn auto_report(self) -> Option<AutoReport> {
        self.search.method.report().auto_report
    }

    /// Returns the load factor currently applied, relative to the full loads.
    pub fn load_factor(self) -> f64 {
        self.search.load_factor()
    }

    /// Returns the number of load steps so far; 1 if the loads were applied at once.
    pub fn load_steps(self) -> u32 {
        self.search.method.report().load_steps
    }

    /// Returns the bound of the rounding error of [`Simulation::residual`], if a solve has ended within this bound but
    /// above the tolerance. `None` if the tolerance is met, or the solve has not converged.
    pub fn residual_floor(self) -> Option<f64> {
        let below = self.search.forces.below_rounding.filter(|_| self.body.status == Status::Converged);
        let floor = self.search.floor.or(below.map(|[_, bound]| bound));
        floor.filter(|_| self.search.residual() > self.body.scene.solver.tolerance)
    }

    /// Returns the critical points of the path from rest; `None` if the result is not known to be its end.
    #[doc(hidden)]
    pub fn path_events(self) -> Option<PathEvents> {
        self.search.method.path_events().filter(|_| self.body.status.is_success())
    }

    /// Returns a copy of the search, for display while the search itself goes on elsewhere. It has no work memory; that
    /// is allocated if the copy is itself continued.
    pub fn snapshot(self) -> Simulation {
        Simulation { body: self.body.clone(), process: Process::Search(Box::new(self.search.copy())) }
    }
}

/// Results of a motion; returned by [`Simulation::motion`].
///
/// ```
/// use warpbeam::{Counts, IntegratorKind, Ledger, Moment, Momentum, Motion, Scene, Simulation};
///
/// // A free beam of 1000 kg/m³ · 1 m · 0.1 m · 1 m = 100 kg falls for half a second.
/// let scene = Scene::beam(1.0, 0.1).gravity([0.0, -9.81]);
/// let mut fall = Simulation::new(&scene.moving(IntegratorKind::EnergyMomentum, 1.0 / 60.0))?;
/// let start: Moment = fall.motion().ok_or("a dynamic scene has a motion")?.moment();
/// for _ in 0..30 {
///     fall.step();
/// }
/// let motion: Motion<'_> = fall.motion().ok_or("a dynamic scene has a motion")?;
/// let (Counts { steps, .. }, Momentum { linear, .. }) = (motion.counts(), motion.momentum());
/// assert!(steps == 30 && (linear.y + 100.0 * 9.81 * 0.5).abs() < 1e-6);
/// // Kinetic energy comes from the potential of the weight, and from nothing else.
/// let ledger: &Ledger = motion.ledger();
/// assert!((ledger.kinetic + ledger.potential).abs() < 1e-6 && ledger.drift().abs() < 1e-9);
/// fall.return_to(&start)?;
/// assert_eq!(fall.state().time(), 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    pub(super) steps: &'a TimeStepping,
    pub(super) body: &'a Body,
}

impl<'a> Motion<'a> {
    /// Returns the energy ledger since the start.
    pub fn ledger(self) -> &'a Ledger {
        &self.steps.ledger
    }

    /// Returns the numbers of steps and solves since the start.
    pub fn counts(self) -> Counts {
        self.steps.counts
    }

    /// Returns the momentum and angular momentum.
    pub fn momentum(self) -> Momentum {
        let Body { scene, problem, state, .. } = self.body;
        Momentum::of(problem, &self.steps.mass, has_lumped_mass(scene), state)
    }

    /// Returns the decision of `auto` for the last step; `None` for other methods and for explicit integrators.
    /// [`Self::counts`] has the numbers of steps by decision.
    ///
    /// ```
    /// use warpbeam::{Decision, IntegratorKind, MethodKind, Scene, Simulation};
    ///
    /// let scene = Scene::beam(1.0, 0.1).clamp("left").gravity([0.0, -9.81]).with_method(MethodKind::Auto);
    /// let mut swing = Simulation::new(&scene.moving(IntegratorKind::TrBdf2, 1.0 / 60.0))?;
    /// for _ in 0..30 {
    ///     swing.step();
    /// }
    /// assert!((swing.state().time() - 0.5).abs() < 1e-9);
    /// let motion = swing.motion().ok_or("a dynamic scene has a motion")?;
    /// assert!(motion.decision().is_some_and(|decision| decision != Decision::Undecided));
    /// let counts = motion.counts();
    /// assert_eq!(counts.linear_steps + counts.old_factor_steps + counts.new_factor_steps, 30);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn decision(self) -> Option<Decision> {
        self.steps.decides(&self.body.scene).then_some(self.steps.decision)
    }

    /// Returns the longest stable step about rest, s; `None` for integrators without such a limit.
    pub fn critical_step(self) -> Option<f64> {
        self.steps.critical_step
    }

    /// Returns a snapshot for [`Simulation::return_to`].
    pub fn moment(self) -> Moment {
        Moment::of(self.steps, self.body)
    }
}

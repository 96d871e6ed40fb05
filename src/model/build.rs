//! Builders and setters of scenes. Values are checked when the scene is simulated.

use nalgebra::Vector2;

use super::{
    Analysis, Axis, Beam, Diagonals, DynamicsSettings, ElementKind, IntegratorKind, Invalid, Load, Material,
    MethodKind, Place, Plane, Probe, Pulse, Scene, SectionLine, Start, Support,
};
use crate::format::{engineering, rounded};

impl Scene {
    /// Returns a scene without a mesh, for [`crate::Simulation::with_mesh`].
    pub fn named(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// Returns a rubber rectangle [0, length] × [−height/2, height/2], m, on one row of six-node triangles, without
    /// supports and loads.
    ///
    /// ```
    /// use warpbeam::{Scene, Simulation};
    ///
    /// let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -1000.0]).probe("tip", "right");
    /// let mut beam = Simulation::new(&scene)?;
    /// beam.solve();
    /// assert!(beam.probe("tip").is_some_and(|u| u.y < -3.0));
    /// # Ok::<(), warpbeam::SimulationError>(())
    /// ```
    pub fn beam(length: f64, height: f64) -> Self {
        // The cells are about as long as high.
        let along = (length / height).round().clamp(4.0, 100.0);
        let along = if along.is_finite() { along as u32 } else { 4 };
        let beam = Beam { length, height, cells: [along, 1], element: ElementKind::T6, ..Beam::default() };
        Self { beam: Some(beam), ..Self::named("Beam") }
    }

    /// Sets the metres per unit of the mesh file. Does nothing if the scene has no mesh file.
    #[must_use]
    pub fn with_scale(mut self, scale: f64) -> Self {
        if let Some(mesh) = &mut self.mesh {
            mesh.scale = Some(scale);
        }
        self
    }

    /// Sets how cells of the beam are cut into triangles. Does nothing if the scene has no beam.
    #[must_use]
    pub fn with_diagonals(mut self, diagonals: Diagonals) -> Self {
        if let Some(beam) = &mut self.beam {
            beam.diagonals = diagonals;
        }
        self
    }

    /// Bends the beam to an arch whose axis rises by `rise`, m, in its middle. Does nothing if the scene has no beam.
    #[must_use]
    pub fn with_rise(mut self, rise: f64) -> Self {
        if let Some(beam) = &mut self.beam {
            beam.rise = rise;
        }
        self
    }

    /// Sets the number of cells along and across the beam. Does nothing if the scene has no beam.
    #[must_use]
    pub fn with_cells(mut self, along: u32, across: u32) -> Self {
        if let Some(beam) = &mut self.beam {
            beam.cells = [along, across];
        }
        self
    }

    /// Sets the element type of the scene's mesh. Does nothing if the scene has neither a beam nor a mesh file.
    #[must_use]
    pub fn with_element(mut self, element: ElementKind) -> Self {
        self.set_element(element);
        self
    }

    /// Sets the material.
    #[must_use]
    pub fn with_material(mut self, material: Material) -> Self {
        self.material = material;
        self
    }

    /// Sets the method.
    #[must_use]
    pub fn with_method(mut self, method: MethodKind) -> Self {
        self.solver.method = method;
        self
    }

    /// Adds a support that fixes `place` in both directions.
    #[must_use]
    pub fn clamp(self, place: impl Into<Place>) -> Self {
        self.support(place, &[Axis::X, Axis::Y])
    }

    /// Adds a support that fixes `place` in these directions.
    ///
    /// ```
    /// use warpbeam::{Axis, Scene, Simulation};
    ///
    /// // A simply supported beam under its weight.
    /// let beam = Scene::beam(10.0, 1.0).support([0.0, -0.5], &[Axis::X, Axis::Y]).support([10.0, -0.5], &[Axis::Y]);
    /// let mut beam = Simulation::new(&beam.gravity([0.0, -9.81]))?;
    /// beam.solve();
    /// # Ok::<(), warpbeam::SimulationError>(())
    /// ```
    #[must_use]
    pub fn support(mut self, place: impl Into<Place>, fix: &[Axis]) -> Self {
        self.supports.push(Support::new(place, fix));
        self
    }

    /// Adds a support that fixes a point of the body, m, in these directions, and not its nearest node.
    ///
    /// ```
    /// use warpbeam::{Axis, Scene, Simulation};
    ///
    /// // The cells are 1 m long and high: there is no node at these points of the axis.
    /// let beam = Scene::beam(10.0, 1.0).with_cells(10, 1).gravity([0.0, -9.81]);
    /// let beam = beam.point_support([0.5, 0.0], &[Axis::X, Axis::Y]).point_support([9.5, 0.0], &[Axis::Y]);
    /// let mut beam = Simulation::new(&beam)?;
    /// beam.solve();
    /// let [left, right] = [0, 1].map(|i| beam.support_reactions()[i].force.y);
    /// assert!((left - right).abs() < 1e-6 * left);
    /// # Ok::<(), warpbeam::SimulationError>(())
    /// ```
    #[must_use]
    pub fn point_support(mut self, at: impl Into<Vector2<f64>>, fix: &[Axis]) -> Self {
        self.supports.push(Support::point(at, fix));
        self
    }

    /// Prescribes a displacement, m, and a rotation about its middle, rad, for the support added last. Does nothing if
    /// the scene has no support.
    ///
    /// ```
    /// use warpbeam::{Scene, Simulation, Status};
    ///
    /// let scene = Scene::beam(10.0, 1.0).clamp("left").clamp("right").moved([0.0, -1.0], 0.0);
    /// let mut beam = Simulation::new(&scene)?;
    /// assert_eq!(*beam.solve(), Status::Converged);
    /// assert!(beam.support_reactions()[1].force.y < 0.0, "the right end is pushed down");
    /// # Ok::<(), warpbeam::SimulationError>(())
    /// ```
    #[must_use]
    pub fn moved(mut self, displacement: impl Into<Vector2<f64>>, rotation: f64) -> Self {
        if let Some(support) = self.supports.last_mut() {
            (support.displacement, support.turn) = (displacement.into().into(), rotation);
        }
        self
    }

    /// Adds a dead force, N, on an edge or on the node nearest to a point.
    #[must_use]
    pub fn force(mut self, place: impl Into<Place>, force: impl Into<Vector2<f64>>) -> Self {
        self.loads.push(Load::force(place, force));
        self
    }

    /// Adds a dead force, N, at a point of the body, m, and not on its nearest node.
    ///
    /// ```
    /// use warpbeam::{Load, Scene, Simulation};
    ///
    /// // The cells are 1 m long: there is no node at 3.4 m.
    /// let scene = Scene::beam(10.0, 1.0).with_cells(10, 1).clamp("left").point_force([3.4, 0.0], [0.0, -1.0]);
    /// assert!(matches!(scene.loads[0], Load::Force { at_point: true, .. }));
    /// let mut beam = Simulation::new(&scene)?;
    /// beam.solve();
    /// let moment = beam.support_reactions()[0].moment;
    /// assert!((moment - 3.4).abs() < 1e-3);
    /// # Ok::<(), warpbeam::SimulationError>(())
    /// ```
    #[must_use]
    pub fn point_force(mut self, at: impl Into<Vector2<f64>>, force: impl Into<Vector2<f64>>) -> Self {
        self.loads.push(Load::point_force(at, force));
        self
    }

    /// Returns `true` if a support or force acts on a point or a node, and not on a width or an edge.
    pub(crate) fn acts_on_points(&self) -> bool {
        let is_point = |place: &Place, width: f64| matches!(place, Place::At(_)) && width == 0.0;
        self.supports.iter().any(|support| is_point(&support.place, support.width))
            || self.loads.iter().any(|load| matches!(load, Load::Force { place, width, .. } if is_point(place, *width)))
    }

    /// Spreads every support and force at a point over a width, m: see [`Support::width`].
    ///
    /// ```
    /// use warpbeam::{Axis, Scene, Simulation, Status};
    ///
    /// let beam = Scene::beam(10.0, 1.0).point_support([0.5, -0.5], &[Axis::X, Axis::Y]).point_support([9.5, -0.5], &[Axis::Y]);
    /// let beam = beam.point_force([5.0, 0.5], [0.0, -1000.0]).probe("middle", [5.0, 0.0]).with_widths(0.1);
    /// let mut simulation = Simulation::new(&beam)?;
    /// assert_eq!(*simulation.solve(), Status::Converged);
    /// assert!((simulation.support_reactions()[0].force.y - 500.0).abs() < 20.0);
    /// # Ok::<(), warpbeam::SimulationError>(())
    /// ```
    #[must_use]
    pub fn with_widths(mut self, to: f64) -> Self {
        for support in self.supports.iter_mut().filter(|support| support.at_point) {
            support.width = to;
        }
        for load in &mut self.loads {
            if let Load::Force { at_point: true, width, .. } = load {
                *width = to;
            }
        }
        self
    }

    /// Adds a moment, N m, counter-clockwise, that rotates with its edge.
    #[must_use]
    pub fn moment(mut self, edge: &str, moment: f64) -> Self {
        self.loads.push(Load::moment(edge, moment));
        self
    }

    /// Adds the weight under this acceleration, m/s².
    #[must_use]
    pub fn gravity(mut self, acceleration: impl Into<Vector2<f64>>) -> Self {
        self.loads.push(Load::gravity(acceleration));
        self
    }

    /// Makes the load added last a pulse, with the factor sin²(π (t − start)/duration) from `start`, s, for `duration`,
    /// s, and 0 at other times. Does nothing if the scene has no load.
    ///
    /// ```
    /// use warpbeam::{IntegratorKind, Momentum, Pulse, Scene, Simulation};
    ///
    /// // A free beam of 1000 kg/m³ · 1 m · 0.1 m · 1 m = 100 kg gets the impulse ½ · 2000 N · 0.1 s = 100 kg m/s.
    /// let scene = Scene::beam(1.0, 0.1).force("right", [2000.0, 0.0]).pulse(0.0, 0.1);
    /// assert_eq!(scene.loads[0].pulse(), Some(Pulse { start: 0.0, duration: 0.1 }));
    /// let mut beam = Simulation::new(&scene.moving(IntegratorKind::TrBdf2, 0.01))?;
    /// for _ in 0..20 {
    ///     beam.step();
    /// }
    /// let Momentum { linear, .. } = beam.motion().ok_or("a dynamic scene has a motion")?.momentum();
    /// assert!((linear.x - 100.0).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn pulse(mut self, start: f64, duration: f64) -> Self {
        match self.loads.last_mut() {
            Some(Load::Force { pulse, .. } | Load::Moment { pulse, .. } | Load::Gravity { pulse, .. }) => {
                *pulse = Some(Pulse { start, duration });
            }
            None => {}
        }
        self
    }

    /// Makes the scene dynamic with this integrator and time step, s.
    ///
    /// ```
    /// use warpbeam::{IntegratorKind, Scene, Simulation};
    ///
    /// let scene = Scene::beam(1.0, 0.1).clamp("left").gravity([0.0, -9.81]).probe("tip", "right");
    /// let mut swing = Simulation::new(&scene.moving(IntegratorKind::TrBdf2, 1.0 / 60.0))?;
    /// for _ in 0..30 {
    ///     swing.step(); // one time step
    /// }
    /// assert!(swing.probe("tip").is_some_and(|u| u.y < -0.3));
    /// # Ok::<(), warpbeam::SimulationError>(())
    /// ```
    #[must_use]
    pub fn moving(mut self, integrator: IntegratorKind, time_step: f64) -> Self {
        self.analysis = Analysis::Dynamic;
        (self.dynamics.integrator, self.dynamics.time_step) = (integrator, time_step);
        self
    }

    /// Sets the initial velocity, m/s, and angular velocity about the centre of mass, rad/s.
    #[must_use]
    pub fn starting(mut self, velocity: impl Into<Vector2<f64>>, spin: f64) -> Self {
        self.start = Start { velocity: velocity.into().into(), spin };
        self
    }

    /// Adds a probe.
    #[must_use]
    pub fn probe(mut self, name: &str, place: impl Into<Place>) -> Self {
        self.probes.push(Probe { name: name.to_owned(), place: place.into() });
        self
    }

    /// Adds a section through the point `at`, m, with its normal at `angle`, rad, from the x axis.
    ///
    /// ```
    /// use warpbeam::{Scene, Simulation};
    ///
    /// let scene = Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -1.0]).section([4.0, 0.0], 0.0);
    /// let mut beam = Simulation::new(&scene)?;
    /// beam.solve();
    /// let section = beam.section(scene.sections[0])?;
    /// assert!((section.forces.moment + 6.0).abs() < 1e-3); // 1 N at a distance of 6 m
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn section(mut self, at: impl Into<Vector2<f64>>, angle: f64) -> Self {
        self.sections.push(SectionLine { at: at.into(), angle });
        self
    }

    /// Returns the index in [`Self::loads`] of the first force or moment on an edge, by name, or on a point.
    pub fn load_on(&self, place: impl Into<Place>) -> Option<usize> {
        let place = place.into();
        let is_there = |load: &Load| match load {
            Load::Force { place: own, .. } => *own == place,
            Load::Moment { edge, .. } => matches!(&place, Place::Edge(name) if name == edge),
            Load::Gravity { .. } => false,
        };
        self.loads.iter().position(is_there)
    }

    /// Sets the components, N, of the force with this index in [`Self::loads`], as in `load.0` of a scene file.
    ///
    /// # Errors
    /// [`Invalid`] if this is not a force of the scene. Values out of range are rejected when the scene is simulated.
    pub fn set_force(&mut self, load: usize, new: impl Into<Vector2<f64>>) -> Result<(), Invalid> {
        match self.loads.get_mut(load) {
            Some(Load::Force { force, .. }) => *force = new.into().into(),
            other => return Err(no_such_load(load, "force", other.as_deref())),
        }
        Ok(())
    }

    /// Sets the moment with this index in [`Self::loads`], N m.
    ///
    /// # Errors
    /// Same errors as [`Self::set_force`].
    pub fn set_moment(&mut self, load: usize, new: f64) -> Result<(), Invalid> {
        match self.loads.get_mut(load) {
            Some(Load::Moment { moment, .. }) => *moment = new,
            other => return Err(no_such_load(load, "moment", other.as_deref())),
        }
        Ok(())
    }

    /// Sets the acceleration of the weight with this index in [`Self::loads`], m/s².
    ///
    /// # Errors
    /// Same errors as [`Self::set_force`].
    pub fn set_gravity(&mut self, load: usize, new: impl Into<Vector2<f64>>) -> Result<(), Invalid> {
        match self.loads.get_mut(load) {
            Some(Load::Gravity { acceleration, .. }) => *acceleration = new.into().into(),
            other => return Err(no_such_load(load, "gravity", other.as_deref())),
        }
        Ok(())
    }

    /// Sets the prescribed displacement, m, and rotation, rad, of the support with this index in [`Self::supports`].
    ///
    /// ```
    /// use warpbeam::{Material, Scene, Simulation};
    ///
    /// let scene = Scene::beam(10.0, 1.0).with_material(Material::new(1e6, 0.0)).clamp("left").clamp("right");
    /// let mut beam = Simulation::new(&scene)?;
    /// beam.edit(|scene| scene.move_support(1, [0.1, 0.0], 0.0))?; // `support.1` of a scene file
    /// beam.solve();
    /// // A strain of 1 % needs the force E A ε = 1e6 Pa · 1 m² · 0.01.
    /// assert!((beam.support_reactions()[1].force.x - 10_000.0).abs() < 1e-3);
    /// # Ok::<(), warpbeam::SimulationError>(())
    /// ```
    ///
    /// # Errors
    /// [`Invalid`] if this is not a support of the scene. Values out of range are rejected when the scene is simulated.
    pub fn move_support(
        &mut self,
        support: usize,
        displacement: impl Into<Vector2<f64>>,
        rotation: f64,
    ) -> Result<(), Invalid> {
        let count = self.supports.len();
        let Some(moved) = self.supports.get_mut(support) else {
            let message = format!("expected one of {}, counted from 0", crate::format::count(count as u64, "support"));
            return Err(Invalid::new(format!("support.{support}"), message));
        };
        (moved.displacement, moved.turn) = (displacement.into().into(), rotation);
        Ok(())
    }

    /// Changes the length and height of the beam, m, and moves loads, supports and probes at points and sections with it;
    /// their widths grow with the height. The number of cells does not change. Does nothing if the scene has no beam.
    pub fn resize_beam(&mut self, length: f64, height: f64) {
        let Some(beam) = &mut self.beam else { return };
        let before = std::mem::replace(beam, Beam { length, height, ..beam.clone() });
        let loads = self.loads.iter_mut().filter_map(|load| match load {
            Load::Force { place, width, .. } => Some((place, Some(width))),
            Load::Moment { .. } | Load::Gravity { .. } => None,
        });
        let supports = self.supports.iter_mut().map(|support| (&mut support.place, Some(&mut support.width)));
        let probes = self.probes.iter_mut().map(|probe| (&mut probe.place, None));
        let moved = |[x, y]: [f64; 2]| {
            let along = x / before.length;
            beam.point(along, (y - before.axis(along)) / before.height).map(|x| rounded(x, 12))
        };
        for (place, width) in loads.chain(supports).chain(probes) {
            if let Place::At(at) = place {
                *at = moved(*at);
            }
            width.into_iter().for_each(|width| *width = rounded(*width * height / before.height, 12));
        }
        self.sections.iter_mut().for_each(|line| line.at = moved(line.at.into()).into());
    }

    /// Multiplies every load and every prescribed displacement and rotation of supports by `factor`.
    pub fn scale_loads(&mut self, factor: f64) {
        for support in &mut self.supports {
            support.displacement = support.displacement.map(|u| u * factor);
            support.turn *= factor;
        }
        for load in &mut self.loads {
            match load {
                Load::Force { force: v, .. } | Load::Gravity { acceleration: v, .. } => *v = v.map(|v| v * factor),
                Load::Moment { moment, .. } => *moment *= factor,
            }
        }
    }

    /// Returns the element type of the scene's mesh.
    pub fn element(&self) -> ElementKind {
        let beam = self.beam.as_ref().map(|b| b.element);
        beam.or(self.mesh.as_ref().and_then(|m| m.element)).unwrap_or_default()
    }

    /// Returns warnings about pulses that are shorter than a time step, or outside the motion.
    pub fn unresolved_pulses(&self) -> Vec<String> {
        /// Smallest number of time steps in a pulse that resolve its shape in outline.
        const RESOLVED: f64 = 5.0;
        let DynamicsSettings { duration, time_step, .. } = self.dynamics;
        let warning = |(i, load): (usize, &Load)| {
            let pulse = load.pulse()?;
            let [start, end, motion, length, step] =
                [pulse.start, pulse.end(), duration, pulse.duration, time_step].map(|time| engineering(time, "s"));
            let steps = pulse.duration / time_step;
            let reason = if pulse.end() <= 0.0 || pulse.start >= duration {
                format!(", from {start} to {end}, is outside the motion, which lasts {motion}")
            } else if pulse.duration < time_step {
                format!(
                    " lasts {length}, less than a time step of {step}: its impulse is exact, its shape is not resolved"
                )
            } else if pulse.duration < RESOLVED * time_step {
                format!(" lasts {length}, only {steps:.1} time steps: a twentieth of it resolves its shape")
            } else {
                return None;
            };
            Some(format!("the pulse of load.{i}{reason}"))
        };
        self.loads.iter().enumerate().filter_map(warning).collect()
    }

    /// Sets the element type of the scene's mesh. Does nothing if the scene has neither a beam nor a mesh file.
    pub fn set_element(&mut self, element: ElementKind) {
        if let Some(beam) = &mut self.beam {
            beam.element = element;
        }
        if let Some(mesh) = &mut self.mesh {
            mesh.element = Some(element);
        }
    }
}

fn no_such_load(load: usize, expected: &str, got: Option<&Load>) -> Invalid {
    let got = match got {
        Some(Load::Force { .. }) => "a force",
        Some(Load::Moment { .. }) => "a moment",
        Some(Load::Gravity { .. }) => "gravity",
        None => "no load",
    };
    Invalid::new(format!("load.{load}"), format!("expected a load of kind \"{expected}\", got {got}"))
}

impl Material {
    /// Returns a rubber-like material in plane stress with this Young's modulus (Pa) and Poisson ratio, 1000 kg/m³ and
    /// 1 m thick.
    ///
    /// ```
    /// use warpbeam::{Material, Plane};
    /// let mut steel = Material::new(2.1e11, 0.3);
    /// (steel.density, steel.thickness, steel.plane) = (7800.0, 0.01, Plane::Strain);
    /// ```
    pub fn new(young: f64, poisson: f64) -> Self {
        Self { young, poisson, ..Self::default() }
    }
}

impl Default for Material {
    fn default() -> Self {
        Self { young: 1e6, poisson: 0.3, density: 1000.0, thickness: 1.0, plane: Plane::default() }
    }
}

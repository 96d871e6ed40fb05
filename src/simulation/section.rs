//! Sections of the current state.

use std::cell::LazyCell;

use nalgebra::Vector2;

use super::{Process, Simulation};
#[cfg(feature = "cli")]
use crate::mesh::straightened;
use crate::mesh::{axis_angle, bent};
use crate::model::SectionLine;
#[cfg(feature = "cli")]
use crate::model::{Load, Place};
use crate::section::{NodalBalance, Section, SectionError};
use crate::stress::NodalStress;

impl Simulation {
    /// Computes the section forces of the current state along a line: those that the part of the body in front of the
    /// line exerts on the part behind. Takes a loop over the whole body.
    ///
    /// They balance the loads, the reactions and in a motion the inertia of the part in front, also those between the line
    /// and the nodes; reactions of supports on nodes act on the nodes. In a motion they include the viscous stress of
    /// stiffness-proportional damping, which the stress along the line does not.
    ///
    /// ```
    /// use warpbeam::{Scene, Section, SectionError, SectionForces, SectionLine, SectionPoint, Simulation};
    ///
    /// let mut beam = Simulation::new(&Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -1.0]))?;
    /// beam.solve();
    /// let Section { forces, points, .. } = beam.section(SectionLine { at: [4.0, 0.0].into(), angle: 0.0 })?;
    /// // In front of the cut there is 1 N at a distance of 6 m.
    /// let SectionForces { normal, shear, moment } = forces;
    /// assert!(normal.abs() < 1e-2 && (shear + 1.0).abs() < 1e-3 && (moment + 6.0).abs() < 1e-3);
    /// // Beam theory at the upper side: N/A − M (h/2)/I = 36 Pa.
    /// let SectionPoint { beam: of_theory, .. } = points[points.len() - 1];
    /// let [normal_stress, _] = of_theory.ok_or("the cut is normal to the axis")?;
    /// assert!((normal_stress - 36.0).abs() < 0.1);
    /// let beyond = SectionLine { at: [11.0, 0.0].into(), angle: 0.0 };
    /// assert_eq!(beam.section(beyond), Err(SectionError::Missed));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SectionError::Missed`], [`SectionError::Several`], [`SectionError::NotFinite`].
    pub fn section(&self, line: SectionLine) -> Result<Section, SectionError> {
        self.cutter(Some(&self.nodal_stress()))(line)
    }

    /// Computes as [`Self::section`], without the stress along the line.
    #[cfg(feature = "app")]
    pub(crate) fn section_forces(&self, line: SectionLine) -> Result<Section, SectionError> {
        self.cutter(None)(line)
    }

    /// Computes the sections of the scene, with the stress recovered once for all.
    #[cfg(feature = "cli")]
    pub(crate) fn scene_sections(&self) -> Vec<Result<Section, SectionError>> {
        let lines = &self.scene().sections;
        let nodal = if lines.is_empty() { None } else { Some(self.nodal_stress()) };
        lines.iter().copied().map(self.cutter(nodal.as_ref())).collect()
    }

    /// Returns a function that computes the section along a line, with the stress along it if that was recovered; all
    /// balance the same forces and accelerations.
    fn cutter(&self, nodal: Option<&NodalStress>) -> impl Fn(SectionLine) -> Result<Section, SectionError> {
        let balance = LazyCell::new(|| {
            let mouse_spring = self.mouse_spring().map_or_else(Vector2::zeros, |(_, force)| force);
            match &self.process {
                Process::Search(search) => NodalBalance {
                    load_factor: search.load_factor(),
                    residual: self.forces().residual().into(),
                    mouse_spring: mouse_spring * search.load_factor(),
                    motion: None,
                },
                Process::Motion(motion) => motion.nodal_balance(&self.body, mouse_spring),
            }
        });
        move |line| Section::of(self.problem(), self.state(), self.kinematics(), &balance, nodal, line)
    }

    /// Computes as [`Self::section`] the sections normal to the axis of a beam at `count` points, evenly spaced from
    /// its left end to its right end.
    ///
    /// # Errors
    /// [`SectionError::NoAxis`] for a body from a mesh file or a given mesh, and the errors of [`Self::section`].
    pub fn sections(&self, count: usize) -> Result<Vec<Section>, SectionError> {
        let intervals = count.saturating_sub(1).max(1) as f64;
        self.sections_along((0..count).map(|i| i as f64 / intervals))
    }

    /// Computes as [`Self::sections`] the sections of diagrams of N, V and M: even ones, and two beside every point of a
    /// load or a support, where the forces jump.
    ///
    /// # Errors
    /// As [`Self::sections`].
    #[cfg(feature = "cli")]
    pub(crate) fn diagram_sections(&self) -> Result<Vec<Section>, SectionError> {
        /// Number of intervals between even sections.
        const ALONG: u32 = 40;
        /// Distance of a section from a point where the forces jump, relative to the length.
        const BESIDE: f64 = 1e-6;
        let scene = self.scene();
        let loads = scene.loads.iter().filter_map(|load| match load {
            Load::Force { place, .. } => Some(place),
            _ => None,
        });
        let points = loads.chain(scene.supports.iter().map(|support| &support.place));
        let beam = self.system().beam();
        let jumps = points.filter_map(|place| match place {
            Place::At(at) => Some(straightened(beam?, (*at).into())[0]),
            Place::Edge(_) => None,
        });
        let beside = jumps.flat_map(|along| [along - BESIDE, along + BESIDE]);
        let even = (0..=ALONG).map(|i| f64::from(i) / f64::from(ALONG));
        let mut along: Vec<f64> = beside.filter(|along| (0.0..=1.0).contains(along)).chain(even).collect();
        along.sort_by(f64::total_cmp);
        self.sections_along(along.into_iter())
    }

    /// Computes as [`Self::sections`] the sections at these points of the axis, fractions of the beam's length.
    fn sections_along(&self, along: impl Iterator<Item = f64>) -> Result<Vec<Section>, SectionError> {
        let beam = self.system().beam().ok_or(SectionError::NoAxis)?;
        let nodal = self.nodal_stress();
        let line = |along: f64| SectionLine { at: bent(beam, along, 0.0), angle: axis_angle(beam, along) };
        along.map(line).map(self.cutter(Some(&nodal))).collect()
    }
}

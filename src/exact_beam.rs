//! Reference solutions for errors: beam theories solved as ordinary differential equations, independently of any mesh.
//!
//! - the **elastica** (Euler 1744): inextensible, no shear;
//! - the **geometrically exact beam** (Reissner 1972): with stretch and shear, shear area 5/6 of the section;
//! - linear beam theory, P L³/3EI and its companions.
//!
//! A clamped beam of length L carries a dead tip force, a tip moment and a weight per rest length. With s the rest arc
//! length, θ the section's angle, n the section force, M the bending moment:
//!
//! x′ = (1 + ε) t + γ m,  θ′ = M / EI,  M′ = −x′ × n,  n(s) = F + q (L − s),
//!
//! t = (cos θ, sin θ), m = (−sin θ, cos θ), ε = n·t / EA, γ = n·m / GA (both 0 for the elastica), θ(0) = 0, M(L) =
//! M_tip. The equations are solved by multiple shooting with RK4, along the path of equilibria from zero load.

use nalgebra::{DMatrix, DVector, Vector2};

use crate::continuation::{Continuation, Critical, CriticalMode, PathEquations};
use crate::model::{Analysis, Axis, Load, Place, Plane, Scene, Support};

/// Clamped beam and its loads, in any consistent units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClampedBeam {
    /// Length L at rest.
    pub length: f64,
    /// Bending stiffness EI.
    pub bending: f64,
    /// 1/EA: 0 makes it inextensible.
    pub stretch_compliance: f64,
    /// 1/GA: 0 makes it unshearable.
    pub shear_compliance: f64,
    /// Dead force at the tip, F.
    pub tip_force: Vector2<f64>,
    /// Moment at the tip, counter-clockwise.
    pub tip_moment: f64,
    /// Weight per rest length, q.
    pub weight: Vector2<f64>,
}

/// Tip of a beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tip {
    /// Position; the clamp is at the origin and the beam at rest lies along x.
    pub x: Vector2<f64>,
    /// Angle of the section, rad.
    pub angle: f64,
}

/// Equilibrium on the load path from zero load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint {
    /// Load factor, relative to the full load.
    pub factor: f64,
    /// Tip position and angle.
    pub tip: Tip,
    /// Bending moment at the clamp.
    pub clamp_moment: f64,
}

/// Number of shooting segments; a single segment would be ill-conditioned under large loads.
const SEGMENTS: usize = 32;
/// RK4 steps per segment.
const STEPS: usize = 24;

/// θ and M at a point, and the vector from the start of the segment to it.
#[derive(Clone, Copy)]
struct SectionState {
    theta: f64,
    moment: f64,
    x: Vector2<f64>,
}

impl ClampedBeam {
    /// Returns the derivatives with respect to s at a load factor.
    fn derivative(&self, s: f64, state: &SectionState, factor: f64) -> SectionState {
        let n = (self.tip_force + self.weight * (self.length - s)) * factor;
        let (sin, cos) = state.theta.sin_cos();
        let (t, m) = (Vector2::new(cos, sin), Vector2::new(-sin, cos));
        let x = t * (1.0 + n.dot(&t) * self.stretch_compliance) + m * (n.dot(&m) * self.shear_compliance);
        SectionState { theta: state.moment / self.bending, moment: -x.perp(&n), x }
    }

    /// Integrates over one segment from θ and M at its start; returns the state at its end.
    fn shoot(&self, piece: usize, theta: f64, moment: f64, factor: f64) -> SectionState {
        let h = self.length / (SEGMENTS * STEPS) as f64;
        let mut state = SectionState { theta, moment, x: Vector2::zeros() };
        for step in 0..STEPS {
            let s = (piece * STEPS + step) as f64 * h;
            let at = |k: &SectionState, step: f64| SectionState {
                theta: state.theta + step * k.theta,
                moment: state.moment + step * k.moment,
                x: state.x + k.x * step,
            };
            let k1 = self.derivative(s, &state, factor);
            let k2 = self.derivative(s + 0.5 * h, &at(&k1, 0.5 * h), factor);
            let k3 = self.derivative(s + 0.5 * h, &at(&k2, 0.5 * h), factor);
            let k4 = self.derivative(s + h, &at(&k3, h), factor);
            let mean = |a: f64, b: f64, c: f64, d: f64| h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
            state = SectionState {
                theta: state.theta + mean(k1.theta, k2.theta, k3.theta, k4.theta),
                moment: state.moment + mean(k1.moment, k2.moment, k3.moment, k4.moment),
                x: state.x + (k1.x + k2.x * 2.0 + k3.x * 2.0 + k4.x) * (h / 6.0),
            };
        }
        state
    }

    /// Linearizes multiple shooting at the unknowns θₖ, Mₖ (M in units of EI/L): returns the Jacobian and the residual.
    fn shooting(&self, unknowns: &DVector<f64>, factor: f64) -> (DMatrix<f64>, DVector<f64>) {
        const DIFFERENCE: f64 = 1e-7;
        let scale = self.bending / self.length;
        let n = 2 * SEGMENTS;
        let (mut jacobian, mut residual) = (DMatrix::zeros(n, n), DVector::zeros(n));
        // The equation θ₀ = 0 takes row 0; the other rows state that segment k − 1 ends where segment k begins.
        jacobian[(0, 0)] = 1.0;
        residual[0] = unknowns[0];
        for piece in 0..SEGMENTS {
            let (theta, moment) = (unknowns[2 * piece], unknowns[2 * piece + 1] * scale);
            let end = self.shoot(piece, theta, moment, factor);
            let by_theta = self.shoot(piece, theta + DIFFERENCE, moment, factor);
            let by_moment = self.shoot(piece, theta, moment + DIFFERENCE * scale, factor);
            // Rows 2k+1 (θ) and 2k+2 (M): continuity with the next segment; the last segment has only M = M_tip.
            let last = piece + 1 == SEGMENTS;
            let row = 2 * piece + 1;
            if !last {
                residual[row] = end.theta - unknowns[2 * piece + 2];
                jacobian[(row, 2 * piece)] = (by_theta.theta - end.theta) / DIFFERENCE;
                jacobian[(row, 2 * piece + 1)] = (by_moment.theta - end.theta) / DIFFERENCE;
                jacobian[(row, 2 * piece + 2)] = -1.0;
            }
            let row = if last { row } else { row + 1 };
            let target = if last { factor * self.tip_moment / scale } else { unknowns[2 * piece + 3] };
            residual[row] = end.moment / scale - target;
            jacobian[(row, 2 * piece)] = (by_theta.moment - end.moment) / (DIFFERENCE * scale);
            jacobian[(row, 2 * piece + 1)] = (by_moment.moment - end.moment) / (DIFFERENCE * scale);
            if !last {
                jacobian[(row, 2 * piece + 3)] = -1.0;
            }
        }
        (jacobian, residual)
    }

    /// Returns the equilibria on the path from the straight beam as the load grows from zero to `largest` times the
    /// full load, at `points` equally spaced load factors; fewer points if the path cannot be followed to its end.
    ///
    /// The path is followed in its own length ([`crate::continuation`]). It ends where it loses its stability: where the
    /// load stops growing along it, or another path crosses.
    pub fn path(&self, largest: f64, points: u32) -> Vec<PathPoint> {
        self.path_to_critical(largest, points).0
    }

    /// Returns [`Self::path`] and the load factor at which it loses its stability by bifurcation (buckling); `None` for
    /// the load factor if the path stays stable or turns back.
    pub fn path_to_critical(&self, largest: f64, points: u32) -> (Vec<PathPoint>, Option<f64>) {
        let mut path = Vec::new();
        let critical = self.visit_path(largest, points, &mut |factor, unknowns| {
            let tip = self.stations(unknowns, factor).pop();
            let tip = tip.unwrap_or(Tip { x: Vector2::zeros(), angle: 0.0 });
            path.push(PathPoint { factor, tip, clamp_moment: unknowns[1] * self.bending / self.length });
        });
        (path, critical)
    }

    /// Returns the axis under the full load, from the clamp to the tip; `None` if the equilibrium cannot be followed.
    pub fn axis(&self) -> Option<Vec<Tip>> {
        let mut axis = None;
        self.visit_path(1.0, 1, &mut |factor, unknowns| axis = Some(self.stations(unknowns, factor)));
        axis
    }

    /// Returns the end points of all segments of a solution, from the clamp to the tip.
    fn stations(&self, unknowns: &DVector<f64>, factor: f64) -> Vec<Tip> {
        let scale = self.bending / self.length;
        let mut tip = Tip { x: Vector2::zeros(), angle: 0.0 };
        let mut stations = vec![tip];
        for piece in 0..SEGMENTS {
            let end = self.shoot(piece, unknowns[2 * piece], unknowns[2 * piece + 1] * scale, factor);
            tip = Tip { x: tip.x + end.x, angle: end.theta };
            stations.push(tip);
        }
        stations
    }

    /// Visits the equilibria of [`Self::path`]; returns the load factor of the bifurcation at which the path loses its
    /// stability, if that is why it ends.
    fn visit_path(&self, largest: f64, points: u32, visit: &mut dyn FnMut(f64, &DVector<f64>)) -> Option<f64> {
        /// Largest number of linearizations.
        const MAX_LINEARIZATIONS: u32 = 3000;
        let mut shooting = Shooting { beam: self, positive: None, scratch: DVector::zeros(2 * SEGMENTS) };
        let rest = DVector::zeros(2 * SEGMENTS);
        let mut path = Continuation::start(&mut shooting, rest, 0.0, 1.0, MAX_LINEARIZATIONS)?;
        let mut goals = (1..=points).map(|point| largest * f64::from(point) / f64::from(points)).peekable();
        while goals.peek().is_some() {
            let passed = path.step(&mut shooting).ok()?;
            let (from, to) = (path.before.clone(), path.point.clone());
            let end = passed.as_ref().map_or(&to, |(_, critical)| critical);
            while let Some(&goal) = goals.peek().filter(|goal| (from.factor..=end.factor).contains(goal)) {
                let found = path.between(&mut shooting, &from, end, goal)?;
                visit(goal, &found.state);
                goals.next();
            }
            match passed {
                None => {}
                Some((Critical::Bifurcation(_), crossing)) => return goals.peek().map(|_| crossing.factor),
                Some((Critical::Limit | Critical::Tip, _)) => return None,
            }
        }
        None
    }

    /// Returns the tip of the equilibrium on the path from the straight beam; `None` if the path cannot be followed.
    pub fn tip(&self) -> Option<Tip> {
        self.path(1.0, 1).pop().map(|p| p.tip)
    }

    /// Returns the tip's displacement in linear beam theory: P L³/3EI, q L⁴/8EI, M L²/2EI across, F L/EA and q L²/2EA
    /// along, and the shear's P L/GA and q L²/2GA.
    pub fn linear_tip_displacement(&self) -> Vector2<f64> {
        let (l, f, q) = (self.length, self.tip_force, self.weight);
        let bending = (f.y * l.powi(3) / 3.0 + q.y * l.powi(4) / 8.0 + self.tip_moment * l * l / 2.0) / self.bending;
        let total = f * l + q * (l * l / 2.0);
        Vector2::new(total.x * self.stretch_compliance, bending + total.y * self.shear_compliance)
    }
}

/// Equations of multiple shooting, as a path sees them.
struct Shooting<'a> {
    beam: &'a ClampedBeam,
    /// Sign of the Jacobian's determinant at rest.
    positive: Option<bool>,
    scratch: DVector<f64>,
}

impl PathEquations for Shooting<'_> {
    type Configuration = DVector<f64>;

    fn unknowns(&self) -> usize {
        2 * SEGMENTS
    }

    fn advance(&self, state: &mut Self::Configuration, direction: &[f64], length: f64, _: [f64; 2]) {
        state.iter_mut().zip(direction).for_each(|(x, d)| *x += length * d);
    }

    /// The number of unstable modes is known modulo 2 only, from the sign of the determinant.
    fn linearize(
        &mut self,
        state: &mut Self::Configuration,
        factor: f64,
        _: Option<&Self::Configuration>,
        correction: &mut [f64],
        rate: &mut [f64],
    ) -> Option<usize> {
        /// Step of the central differences in the load factor.
        const DIFFERENCE: f64 = 1e-5;
        let (jacobian, residual) = self.beam.shooting(state, factor);
        let lu = jacobian.lu();
        let ahead = self.beam.shooting(state, factor + DIFFERENCE).1;
        let behind = self.beam.shooting(state, factor - DIFFERENCE).1;
        self.scratch = (ahead - behind) / (2.0 * DIFFERENCE);
        correction.copy_from_slice((-lu.solve(&residual)?).as_slice());
        rate.copy_from_slice((-lu.solve(&self.scratch)?).as_slice());
        let positive = lu.determinant() > 0.0;
        let changed = positive != *self.positive.get_or_insert(positive);
        let is_finite = correction.iter().chain(&*rate).all(|v| v.is_finite());
        is_finite.then_some(usize::from(changed))
    }

    fn critical_mode(&mut self) -> Option<CriticalMode> {
        None
    }
}

/// Returns the distance of a displacement from the reference, relative to the reference's length, percent; `None` if
/// the reference is zero, or only rounding error beside the distance.
pub fn error_percent(u: Vector2<f64>, reference: Vector2<f64>) -> Option<f64> {
    /// Length of a reference, relative to the distance, that is rounding error.
    const ROUNDING: f64 = 1e-9;
    let (length, distance) = (reference.norm(), (u - reference).norm());
    (length > ROUNDING * distance).then(|| 100.0 * distance / length)
}

/// Reference solution for scenes whose right edge has a known displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ExactBeam {
    /// Clamped left, loaded on the right edge or by its weight: the geometrically exact beam.
    Cantilever(ClampedBeam),
    /// Bar pulled along its axis, free to contract laterally: P L / (E A).
    Bar {
        /// Displacement of the right edge along x, m.
        stretch: f64,
    },
}

impl ExactBeam {
    /// Returns the reference solution of a scene, `None` if it has none.
    ///
    /// The exact beam exists for a rectangle clamped on its left edge whose loads are gravity and forces and moments on the right
    /// edge; and for a rectangle fixed there in x only (and in one point in y) that is pulled along its axis.
    pub fn of(scene: &Scene) -> Option<Self> {
        const SHEAR_AREA: f64 = 5.0 / 6.0;
        if scene.analysis != Analysis::Static || scene.supports.iter().any(Support::moves) {
            return None;
        }
        let beam = scene.beam.as_ref().filter(|beam| beam.rise == 0.0)?;
        let m = &scene.material;
        let young = match m.plane {
            Plane::Stress => m.young,
            Plane::Strain => m.young / (1.0 - m.poisson * m.poisson),
        };
        let area = beam.height * m.thickness;
        let shear = m.young / (2.0 * (1.0 + m.poisson));
        let mut clamped = ClampedBeam {
            length: beam.length,
            bending: young * m.thickness * beam.height.powi(3) / 12.0,
            stretch_compliance: 1.0 / (young * area),
            shear_compliance: 1.0 / (SHEAR_AREA * shear * area),
            tip_force: Vector2::zeros(),
            tip_moment: 0.0,
            weight: Vector2::zeros(),
        };
        for load in &scene.loads {
            match load {
                Load::Force { place: Place::Edge(edge), force, pulse: None, .. } if edge == "right" => {
                    clamped.tip_force += Vector2::from(*force);
                }
                Load::Gravity { acceleration, pulse: None } => {
                    clamped.weight += Vector2::from(*acceleration) * (m.density * area);
                }
                Load::Moment { edge, moment, pulse: None } if edge == "right" => clamped.tip_moment += moment,
                _ => return None,
            }
        }
        let left = |axes: &[Axis]| {
            scene.supports.iter().any(|s| s.place == Place::from("left") && axes.iter().all(|a| s.fix.contains(a)))
        };
        if scene.supports.len() == 1 && left(&[Axis::X, Axis::Y]) {
            return Some(Self::Cantilever(clamped));
        }
        let axial = clamped.tip_force.y == 0.0 && clamped.tip_moment == 0.0 && clamped.weight == Vector2::zeros();
        let point = scene.supports.iter().any(|s| matches!(s.place, Place::At(_)) && s.fix == [Axis::Y]);
        (scene.supports.len() == 2 && left(&[Axis::X]) && point && axial)
            .then(|| Self::Bar { stretch: clamped.tip_force.x * beam.length * clamped.stretch_compliance })
    }

    /// Returns the displacement of the right edge's middle, m; `None` if the equilibrium cannot be followed.
    pub fn tip_displacement(&self) -> Option<Vector2<f64>> {
        match self {
            Self::Cantilever(beam) => beam.tip().map(|tip| tip.x - Vector2::new(beam.length, 0.0)),
            Self::Bar { stretch } => Some(Vector2::new(*stretch, 0.0)),
        }
    }

    /// Returns the displacements, m, of the lower and the upper end of sections at equal distances along a beam of this
    /// height, m; `None` for the bar, whose sides contract, and if the equilibrium cannot be followed.
    pub fn section_displacements(&self, height: f64) -> Option<Vec<[Vector2<f64>; 2]>> {
        let Self::Cantilever(beam) = self else { return None };
        let section = |(i, Tip { x, angle }): (usize, Tip)| {
            let rest = Vector2::new(beam.length * i as f64 / SEGMENTS as f64, 0.0);
            let turned = Vector2::new(-angle.sin(), angle.cos()) - Vector2::y();
            [-0.5, 0.5].map(|side| x - rest + turned * (side * height))
        };
        Some(beam.axis()?.into_iter().enumerate().map(section).collect())
    }
}

#[cfg(test)]
mod tests;

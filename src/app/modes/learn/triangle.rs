//! Quantities of the article for the elements of a body.

use super::*;
use crate::article::affine::Affine2;
use crate::article::stiffness::ElementStiffness;
use crate::element::QuadraturePoint;
use crate::rotation::polar;

/// Three-node triangle, at rest and in the current state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    pub nodes: [u32; 3],
    /// Corners at rest, m.
    pub rest: [Vector2<f64>; 3],
    /// F, the linear part of the map from the rest shape to the current one (article eqs. 12–15).
    pub gradient: Matrix2<f64>,
    /// R and S of F = R S (eqs. 37–39).
    pub rotation: Rotation,
    pub stretch: Matrix2<f64>,
}

impl Triangle {
    /// Returns an element of a body of three-node triangles; `None` for other elements, and if F has no polar
    /// decomposition.
    pub(super) fn of(simulation: &Simulation, element: usize) -> Option<Self> {
        let mesh = simulation.system().mesh();
        if mesh.element() != ElementKind::T3 {
            return None;
        }
        let nodes: [u32; 3] = mesh.elements().nth(element)?.try_into().ok()?;
        let u = simulation.displacement();
        let rest = nodes.map(|n| mesh.nodes()[n as usize]);
        let now = nodes.map(|n| mesh.nodes()[n as usize] + u[n as usize]);
        let gradient = Affine2::from_triangle(rest, now).ok()?.linear;
        let rotation = polar(&gradient)?;
        let stretch = rotation.matrix().transpose() * gradient;
        Some(Self { nodes, rest, gradient, rotation, stretch: (stretch + stretch.transpose()) * 0.5 })
    }

    /// Returns Ke, N/m (eqs. 1, 3).
    pub(super) fn stiffness(&self, simulation: &Simulation) -> Option<ElementStiffness> {
        let entry = ElementKind::T3.entry();
        let point = entry.points.first()?;
        let point = QuadraturePoint::<3>::new(entry, &self.rest, point.at, point.weight);
        Some(ElementStiffness::new(&[point], simulation.problem().material().membrane()))
    }

    /// Returns the unknowns (2 · node + axis) of the six rows.
    pub(super) fn unknowns(&self) -> [usize; 6] {
        std::array::from_fn(|i| 2 * self.nodes[i / 2] as usize + i % 2)
    }
}

/// Returns Σ R Ke Rᵀ over all nodes, N/m, without supports, with the R that the method uses; `None` for other elements.
pub(super) fn assembled(simulation: &Simulation) -> Option<DMatrix<f64>> {
    let count = 2 * simulation.system().mesh().nodes().len();
    let mut sum = DMatrix::zeros(count, count);
    for (element, rotation) in simulation.element_rotations().into_iter().enumerate() {
        let triangle = Triangle::of(simulation, element)?;
        let rotated = triangle.stiffness(simulation)?.rkrt(rotation);
        let unknowns = triangle.unknowns();
        for (row, &i) in unknowns.iter().enumerate() {
            for (column, &j) in unknowns.iter().enumerate() {
                sum[(i, j)] += rotated[(row, column)];
            }
        }
    }
    Some(sum)
}

/// Returns the largest angle θ, rad, of linear theory in a body: half the difference of the derivatives of the
/// displacement across each other.
pub(super) fn largest_linear_angle(simulation: &Simulation) -> f64 {
    let (problem, state) = (simulation.problem(), simulation.state());
    let mut largest = 0.0_f64;
    let elements = problem.system().elements();
    elements.visit_strains(problem.material().lame(), state.displacement(), state.rotations(), &mut |_, h, _| {
        largest = largest.max(0.5 * (h[(1, 0)] - h[(0, 1)]).abs());
    });
    largest
}

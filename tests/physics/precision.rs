//! Tests at the limit of double precision: the smallest residuals of slender bodies, and the bound of their rounding
//! error, compared with the same residual in twice as many digits.

use crate::common::*;
use qd::Quad;
use warpbeam::element::{ElementType, Lame, QuadraturePoint, StrainRate};
use warpbeam::solver::Factor;
use warpbeam::study::extremes::rest::RestCase;
use warpbeam::study::extremes::{Entry, Outcome};

/// Returns a cantilever with L/H = 1000 under α = 1e-6.
fn slender(element: ElementKind, method: MethodKind) -> RestCase {
    RestCase { element, method, alpha: 1e-6, slenderness: 1e3, aspect: 5.0, ..RestCase::ORDINARY }
}

/// Solves a case until its residual stops decreasing.
fn at_its_floor(case: RestCase) -> Simulation {
    let mut scene = case.scene();
    scene.solver.tolerance = 1e-14;
    ended(&scene)
}

/// Returns the smallest residual of an iteration whose displacement has one f64 per component.
fn plain_floor(problem: &Problem) -> f64 {
    let system = problem.system();
    let mut state = system.at_rest();
    let (mut forces, mut matrix) = (Forces::new(system.mesh().nodes().len()), Matrix::new(system.pattern()));
    let mut factor = Factor::new(system.symbolic().unwrap()).unwrap();
    problem.linearize(&state, &mut forces, Some((Tangent::WARPED, &mut matrix)));
    factor.factorize(matrix.values()).unwrap();
    let mut free = vec![0.0; system.dofs()];
    let mut floor = f64::INFINITY;
    for _ in 0..10 {
        problem.linearize(&state, &mut forces, None);
        floor = floor.min(problem.balance(&state, Kinematics::Linear, 1.0, &mut forces));
        system.pattern().restrict(forces.residual(), &mut free);
        factor.solve_in_place(&mut free);
        let mut u = state.displacement().to_vec();
        system.pattern().add_free(&free, 1.0, &mut u);
        state = state.with_displacement(u).unwrap();
    }
    floor
}

/// Rotation, stretch and stress of a point, in twice as many digits.
struct Seen {
    /// R.
    turn: Matrix2<Quad>,
    /// tr S.
    trace: Quad,
    /// First Piola–Kirchhoff stress times the area, N.
    stress: Matrix2<Quad>,
}

type Vectors<const N: usize> = [Vector2<Quad>; N];

impl Seen {
    fn new<const N: usize>(point: &QuadraturePoint<N>, moduli: Lame, kinematics: Kinematics, u: &Vectors<N>) -> Self {
        let h = (1..N).map(|a| (u[a] - u[0]) * point.gradients[a].map(Quad::from).transpose());
        let f = h.sum::<Matrix2<Quad>>() + Matrix2::identity();
        let (a, b) = (f.m11 + f.m22, f.m21 - f.m12);
        let size = (a * a + b * b).sqrt();
        let (c, s) = match kinematics {
            Kinematics::Corotated => (a / size, b / size),
            Kinematics::Linear => (Quad::ONE, Quad::ZERO),
        };
        let turn = Matrix2::new(c, -s, s, c);
        let stretch = turn.transpose() * f;
        let strain = (stretch + stretch.transpose()) * Quad::from(0.5) - Matrix2::identity();
        let [mu2, lambda, area] = [2.0 * moduli.mu, moduli.lambda, point.area].map(Quad::from);
        let t = strain * mu2 + Matrix2::from_diagonal_element(lambda * strain.trace());
        Self { turn, trace: size, stress: turn * t * area }
    }

    /// Returns the force on every node, N.
    fn forces<const N: usize>(&self, point: &QuadraturePoint<N>) -> Vectors<N> {
        point.gradients.map(|g| self.stress * g.map(Quad::from))
    }
}

/// Returns the nodal forces of an element that integrates over points, N.
fn exact_forces<const N: usize>(
    element: &ElementType,
    (moduli, kinematics): (Lame, Kinematics),
    rest: &[Vector2<f64>; N],
    u: &Vectors<N>,
) -> Vectors<N> {
    let mut sum = [Vector2::zeros(); N];
    for rule in element.points {
        let point = QuadraturePoint::<N>::new(element, rest, rule.at, rule.weight);
        let own = Seen::new(&point, moduli, kinematics, u).forces(&point);
        sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
    }
    sum
}

/// Values of ξη at a quadrilateral's corners.
const TWIST: [f64; 4] = [1.0, -1.0, 1.0, -1.0];

/// Returns K of a quadrilateral over μ as the element has stored it, bit for bit. In a parallelogram,
/// where γ is TWIST/4, the force on a body that bends at the rate 1 is a quarter of a column, and no
/// operation in its computation rounds.
fn stored_stiffness(element: &ElementType, rest: &[Vector2<f64>; 4], moduli: Lame) -> Matrix2<f64> {
    let elements = (element.loops)(rest, &[0, 1, 2, 3]);
    let over_mu = Lame { lambda: moduli.lambda / moduli.mu, mu: 1.0 };
    let columns = [Vector2::x(), Vector2::y()].map(|axis| {
        let mut force = [Vector2::zeros(); 4];
        let rate = TWIST.map(|t| axis * t);
        elements.viscous_force(over_mu, &[Vector2::zeros(); 4], StrainRate::Velocity(&rate), &mut force);
        let column = force[0] * 4.0;
        assert_eq!(force, TWIST.map(|t| column * (0.25 * t)));
        column
    });
    Matrix2::from_columns(&columns)
}

/// Returns the forces of the quadrilateral with incompatible modes, N: with q = Σ γₐ uₐ, q̃ = Rᵀ q and f = K q̃, they
/// are P ∇Nₐ + γₐ R f − (f·J q̃) R J ∇Nₐ / tr S, the last term only where R follows x.
fn exact_quad_forces(
    element: &ElementType,
    (moduli, kinematics): (Lame, Kinematics),
    rest: &[Vector2<f64>; 4],
    u: &Vectors<4>,
) -> Vectors<4> {
    let centre = QuadraturePoint::<4>::new(element, rest, [0.0; 2], element.cell.area);
    assert_eq!((rest[0] - rest[1]) + (rest[2] - rest[3]), Vector2::zeros(), "no parallelogram: γ is not TWIST/4");
    let gamma = TWIST.map(|t| Quad::from(0.25 * t));
    let seen = Seen::new(&centre, moduli, kinematics, u);
    let q: Vector2<Quad> = u.iter().zip(gamma).map(|(u, gamma)| u * gamma).sum();
    let back = seen.turn.transpose() * q;
    let f = stored_stiffness(element, rest, moduli).map(Quad::from).tr_mul(&back) * Quad::from(moduli.mu);
    let turn = match kinematics {
        Kinematics::Corotated => f.perp(&back) / seen.trace,
        Kinematics::Linear => Quad::ZERO,
    };
    let mut forces = seen.forces(&centre);
    for ((force, g), gamma) in forces.iter_mut().zip(&centre.gradients).zip(gamma) {
        *force += seen.turn * (f * gamma + Vector2::new(-g.y, g.x).map(Quad::from) * turn);
    }
    forces
}

/// Returns the residual force of a state in twice as many digits, for elements of `N` nodes with these forces.
fn exact_residual<const N: usize>(
    (mesh, state): (&Mesh, &State),
    external: &[Vector2<f64>],
    forces: impl Fn(&[Vector2<f64>; N], &Vectors<N>) -> Vectors<N>,
) -> Vec<Vector2<Quad>> {
    let parts = state.compensated();
    let both = |n: usize| parts.rounded[n].map(Quad::from) + parts.remainder[n].map(Quad::from);
    let mut residual: Vec<_> = external.iter().map(|f| f.map(Quad::from)).collect();
    for nodes in mesh.elements() {
        let nodes: [usize; N] = std::array::from_fn(|a| nodes[a] as usize);
        let own = forces(&nodes.map(|n| mesh.nodes()[n]), &nodes.map(both));
        nodes.into_iter().zip(own).for_each(|(n, force)| residual[n] -= force);
    }
    residual
}

/// Rounding error of the relative residual of a state.
#[derive(Debug)]
struct Rounding {
    /// Distance from the residual in twice as many digits.
    error: f64,
    /// Bound of this distance.
    bound: f64,
}

impl Rounding {
    /// Computes error and bound, and checks every free node's error against its own bound.
    fn of(problem: &Problem, state: &State, kinematics: Kinematics) -> Self {
        let mut forces = forces_at(problem, state);
        let residual = problem.balance(state, kinematics, 1.0, &mut forces);
        let mut bounds = forces.residual().to_vec();
        let bound = problem.residual_floor(state, &forces, &mut bounds).unwrap();
        let mesh = problem.system().mesh();
        let (body, external) = ((mesh, state), &forces.external);
        let (element, seen) = (mesh.element().entry(), (problem.material().membrane(), kinematics));
        let exact = match element.kind {
            ElementKind::T3 => exact_residual(body, external, |x, u| exact_forces::<3>(element, seen, x, u)),
            ElementKind::Q4 => exact_residual(body, external, |x, u| exact_quad_forces(element, seen, x, u)),
            _ => exact_residual(body, external, |x, u| exact_forces::<6>(element, seen, x, u)),
        };
        let pairs = exact.iter().zip(forces.residual());
        let off: Vec<_> = pairs.map(|(exact, found)| (found.map(Quad::from) - exact).map(|off| off.0)).collect();
        let pattern = problem.system().pattern();
        for ((off, bound), mask) in off.iter().zip(&bounds).zip(&pattern.mask) {
            let off = off.component_mul(mask).abs();
            assert!(off.x <= bound.x && off.y <= bound.y, "{} {off:?} {bound:?}", element.id);
        }
        let scale = pattern.norm(forces.residual()) / residual;
        Self { error: pattern.norm(&off) / scale, bound }
    }
}

/// The bound holds for the distance from the residual in twice as many digits, and is not absurdly large.
#[test]
fn the_bound_of_rounding_holds() {
    for element in ElementKind::all() {
        for (method, alpha, slenderness) in [
            (MethodKind::Linear, 1e-6, 1e3),
            (MethodKind::Linear, 1e3, 1e3),
            (MethodKind::Newton, 1e-6, 1e3),
            (MethodKind::Newton, 1.0, 1e3),
            (MethodKind::Newton, 30.0, 100.0),
            (MethodKind::Newton, 10.0, 5.0),
        ] {
            let simulation = at_its_floor(RestCase { alpha, slenderness, ..slender(element, method) });
            let kinematics = if simulation.is_linear() { Kinematics::Linear } else { Kinematics::Corotated };
            let found = Rounding::of(simulation.problem(), simulation.state(), kinematics);
            let what = format!("{} {} {alpha} {slenderness}: {found:?}", element.id(), method.id());
            assert!(found.error <= found.bound && found.bound <= 1000.0 * found.error, "{what}");
        }
    }
}

/// The bound holds for bodies rotated by any angle, with random strain or bending in every cell.
#[test]
fn the_bound_of_rounding_holds_out_of_balance() {
    let mut random = Random(1);
    let mut random = || random.between(-1.0, 1.0);
    for element in ElementKind::all() {
        for (aspect, poisson) in [(1.0, 0.0), (5.0, 0.3), (50.0, 0.4999)] {
            let case = RestCase { aspect, poisson, slenderness: 4.0 * aspect, ..slender(element, MethodKind::Newton) };
            let scene = case.scene();
            let beam = scene.beam.clone().unwrap();
            let cell = Vector2::new(beam.length / f64::from(beam.cells[0]), beam.height / f64::from(beam.cells[1]));
            let simulation = Simulation::new(&scene).unwrap();
            let (problem, mesh) = (simulation.problem(), simulation.system().mesh());
            for (angle, strain, bend) in
                [(PI, 0.1, 0.0), (PI, 1e-6, 0.0), (PI, 0.0, 0.1), (PI, 0.0, 1e-6), (PI, 1e-3, 1e-3), (0.0, 0.1, 0.0)]
            {
                let mut tightest = f64::INFINITY;
                for _ in 0..100 {
                    let (turn, twist) = (Rotation::from_angle(angle * random()), Vector2::new(random(), random()));
                    let move_node = |x: &Vector2<f64>| {
                        // The corners have alternating signs as on a chessboard, so that every cell deforms by ξη only.
                        let on = x.component_div(&cell).map(f64::round).sum();
                        let sign = if on.rem_euclid(2.0) == 0.0 { 1.0 } else { -1.0 };
                        let own = Vector2::new(random(), random()) * strain + twist * (sign * bend);
                        (turn.apply(*x) - x) + turn.apply(own)
                    };
                    let u: Vec<Vector2<f64>> = mesh.nodes().iter().map(move_node).collect();
                    let found = Rounding::of(problem, &problem.system().state_of(&u).unwrap(), Kinematics::Corotated);
                    assert!(found.error <= found.bound, "{} {aspect} {angle} {strain} {bend}: {found:?}", element.id());
                    tightest = tightest.min(found.bound / found.error);
                }
                assert!(tightest <= 1000.0, "{} {aspect} {angle} {strain} {bend}: {tightest}", element.id());
            }
        }
    }
}

/// The path goes on beyond a limit point, also after more solves than load steps are tried from.
#[test]
fn a_long_path_goes_on_beyond_a_limit_point() {
    let q4 = slender(ElementKind::Q4, MethodKind::Newton);
    let case = RestCase { alpha: 1e3, poisson: 0.4999, slenderness: 100.0, aspect: 50.0, ..q4 };
    assert_eq!(case.solve().unwrap().outcome, Outcome::Certified);
}

/// The solve reports the bound of its rounding error; one that stops above that bound does not.
#[test]
fn a_residual_at_its_rounding_floor_counts_as_converged() {
    for element in ElementKind::all() {
        for method in [MethodKind::Linear, MethodKind::Warped, MethodKind::Newton] {
            let simulation = at_its_floor(slender(element, method));
            assert_eq!(*simulation.status(), Status::Converged, "{} {}", element.id(), method.id());
            let floor = simulation.equilibrium().unwrap().residual_floor().unwrap();
            assert!(simulation.residual() <= floor && floor < 1e-6, "{floor:e} {:e}", simulation.residual());
        }
    }
    // Nearly incompressible, with cells fifty times as long as high: the bound may exceed the usual tolerance.
    let mut at_floor = 0;
    for (element, alpha) in [ElementKind::T6, ElementKind::Q4].into_iter().flat_map(|e| [(e, 0.01), (e, 0.1)]) {
        let case = RestCase { alpha, poisson: 0.4999, aspect: 50.0, ..slender(element, MethodKind::Newton) };
        let Entry { outcome, solution: Solution { residual, residual_floor, .. }, .. } = case.solve().unwrap();
        assert_eq!(outcome, Outcome::Certified, "{} {alpha}: {residual:e}", element.id());
        match residual_floor {
            Some(floor) => assert!(residual <= floor && floor <= 1e-5, "{}: {floor:e}", element.id()),
            None => assert!(residual <= case.scene().solver.tolerance, "{}: {residual:e}", element.id()),
        }
        at_floor += usize::from(residual_floor.is_some());
    }
    assert!(at_floor > 0, "each of them meets its tolerance");
    let mut scene = RestCase { slenderness: 5.0, ..slender(ElementKind::T6, MethodKind::Newton) }.scene();
    let simulation = solved(&scene);
    assert_eq!(simulation.equilibrium().unwrap().residual_floor(), None);
    // A slow iteration that is stopped early is not at the limit of precision.
    scene.solver.max_iterations = 1;
    scene.scale_loads(1e6);
    let mut simulation = Simulation::new(&scene).unwrap();
    assert!(matches!(simulation.solve(), Status::NotConverged(Reason::IterationLimit(1))));
    assert_eq!(simulation.equilibrium().unwrap().residual_floor(), None);
    // With one f64 per component of the displacement, the smallest residual is more than fifteen times as large.
    for element in ElementKind::all() {
        for aspect in [1.0, 50.0] {
            let simulation = at_its_floor(RestCase { aspect, ..slender(element, MethodKind::Linear) });
            let (plain, residual) = (plain_floor(simulation.problem()), simulation.residual());
            assert!(plain > 15.0 * residual, "{} {aspect}: {plain:e} {residual:e}", element.id());
        }
    }
}

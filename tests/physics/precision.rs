//! Tests at the limit of double precision: the smallest residuals of slender bodies, and the bound of their rounding
//! error, compared with the same residual in twice as many digits.

use std::f64::consts::PI;
use std::ops::{Add, Div, Mul, Neg, Sub};

use nalgebra::Vector2;

use crate::common::random::Random;
use warpbeam::assembly::{Forces, Kinematics, Matrix, Problem};
use warpbeam::element::{ElementType, Lame, QuadraturePoint, StrainRate, Tangent};
use warpbeam::method::Reason;
use warpbeam::rotation::Rotation;
use warpbeam::solver::Factor;
use warpbeam::study::extremes::rest::{RestCase, Variant};
use warpbeam::study::extremes::{Case, Entry, Outcome};
use warpbeam::{ElementKind, Mesh, MethodKind, Simulation, Solution, State, Status};

/// Returns a cantilever with L/H = 1000 under α = 1e-6.
fn slender(element: ElementKind, method: MethodKind) -> RestCase {
    RestCase {
        element,
        method,
        variant: Variant::Plain,
        alpha: 1e-6,
        young: 1e6,
        poisson: 0.3,
        slenderness: 1e3,
        aspect: 5.0,
    }
}

/// Solves a case until its residual stops decreasing.
fn at_its_floor(case: RestCase) -> Simulation {
    let mut scene = case.scene();
    scene.solver.tolerance = 1e-14;
    let mut simulation = Simulation::new(&scene).unwrap();
    simulation.solve();
    simulation
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

/// With one f64 per component, the smallest residual is more than fifteen times as large.
#[test]
fn the_second_part_of_the_displacement_lowers_the_floor() {
    for element in ElementKind::all() {
        for aspect in [1.0, 50.0] {
            let simulation = at_its_floor(RestCase { aspect, ..slender(element, MethodKind::Linear) });
            let (plain, residual) = (plain_floor(simulation.problem()), simulation.residual());
            assert!(plain > 15.0 * residual, "{} {aspect}: {plain:e} {residual:e}", element.id());
        }
    }
}

/// An unevaluated sum of two f64, used as one number.
#[derive(Clone, Copy, Debug)]
struct Double(f64, f64);

const ZERO: Double = Double(0.0, 0.0);

fn two_sum(a: f64, b: f64) -> Double {
    let sum = a + b;
    let of_b = sum - a;
    Double(sum, (a - (sum - of_b)) + (b - of_b))
}

impl Add for Double {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = (two_sum(self.0, other.0), two_sum(self.1, other.1));
        let sum = two_sum(high.0, high.1 + low.0);
        two_sum(sum.0, sum.1 + low.1)
    }
}

impl Neg for Double {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let high = self.0 * other.0;
        two_sum(high, self.0.mul_add(other.0, -high) + (self.0 * other.1 + self.1 * other.0))
    }
}

impl Div for Double {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let mut quotient = Self(self.0 / other.0, 0.0);
        for _ in 0..2 {
            let rest = self - quotient * other;
            quotient = quotient + Self(rest.0 / other.0, 0.0);
        }
        quotient
    }
}

impl Double {
    fn root(self) -> Self {
        let root = Self(self.0.sqrt(), 0.0);
        root + (self - root * root) / (root + root)
    }
}

impl From<f64> for Double {
    fn from(value: f64) -> Self {
        Self(value, 0.0)
    }
}

/// Rotation, stretch and stress of a point, in twice as many digits.
struct Seen {
    /// R.
    turn: [[Double; 2]; 2],
    /// tr S.
    trace: Double,
    /// First Piola–Kirchhoff stress times the area, N.
    stress: [[Double; 2]; 2],
}

type Vectors<const N: usize> = [[Double; 2]; N];

fn product(m: &[[Double; 2]; 2], v: [Double; 2]) -> [Double; 2] {
    m.map(|row| row[0] * v[0] + row[1] * v[1])
}

fn add(sum: &mut [Double; 2], v: [Double; 2]) {
    sum.iter_mut().zip(v).for_each(|(sum, v)| *sum = *sum + v);
}

impl Seen {
    fn new<const N: usize>(point: &QuadraturePoint<N>, moduli: Lame, kinematics: Kinematics, u: &Vectors<N>) -> Self {
        let (mu2, lambda) = (Double::from(2.0 * moduli.mu), Double::from(moduli.lambda));
        let h = |i: usize, j: usize| {
            (1..N).fold(ZERO, |sum, a| sum + (u[a][i] - u[0][i]) * Double::from(point.gradients[a][j]))
        };
        let f = [[h(0, 0) + 1.0.into(), h(0, 1)], [h(1, 0), h(1, 1) + 1.0.into()]];
        let (a, b) = (f[0][0] + f[1][1], f[1][0] - f[0][1]);
        let size = (a * a + b * b).root();
        let (c, s) = match kinematics {
            Kinematics::Corotated => (a / size, b / size),
            Kinematics::Linear => (1.0.into(), ZERO),
        };
        let xx = c * f[0][0] + s * f[1][0] - 1.0.into();
        let yy = c * f[1][1] - s * f[0][1] - 1.0.into();
        let xy = Double::from(0.5) * (c * (f[0][1] + f[1][0]) + s * (f[1][1] - f[0][0]));
        let pressure = lambda * (xx + yy);
        let t = [[mu2 * xx + pressure, mu2 * xy], [mu2 * xy, mu2 * yy + pressure]];
        let turn = [[c, -s], [s, c]];
        let area = Double::from(point.area);
        let stress = turn.map(|r| [0, 1].map(|j| (r[0] * t[0][j] + r[1] * t[1][j]) * area));
        Self { turn, trace: size, stress }
    }

    /// Returns the force on every node, N.
    fn forces<const N: usize>(&self, point: &QuadraturePoint<N>) -> Vectors<N> {
        point.gradients.map(|g| product(&self.stress, [g.x.into(), g.y.into()]))
    }
}

/// Returns the nodal forces of an element that integrates over points, N.
fn exact_forces<const N: usize>(
    element: &ElementType,
    (moduli, kinematics): (Lame, Kinematics),
    rest: &[Vector2<f64>; N],
    u: &Vectors<N>,
) -> Vectors<N> {
    let mut sum = [[ZERO; 2]; N];
    for rule in element.points {
        let point = QuadraturePoint::<N>::new(element, rest, rule.at, rule.weight);
        let own = Seen::new(&point, moduli, kinematics, u).forces(&point);
        sum.iter_mut().zip(own).for_each(|(sum, own)| add(sum, own));
    }
    sum
}

/// Values of ξη at a quadrilateral's corners.
const TWIST: [f64; 4] = [1.0, -1.0, 1.0, -1.0];

/// Returns K of a quadrilateral over μ as the element has stored it, bit for bit. In a parallelogram,
/// where γ is TWIST/4, the force on a body that bends at the rate 1 is a quarter of a column, and no
/// operation in its computation rounds.
fn stored_stiffness(element: &ElementType, rest: &[Vector2<f64>; 4], moduli: Lame) -> [[f64; 2]; 2] {
    let elements = (element.loops)(rest, &[0, 1, 2, 3]);
    let over_mu = Lame { lambda: moduli.lambda / moduli.mu, mu: 1.0 };
    [Vector2::x(), Vector2::y()].map(|axis| {
        let mut force = [Vector2::zeros(); 4];
        let rate = TWIST.map(|t| axis * t);
        elements.viscous_force(over_mu, &[Vector2::zeros(); 4], StrainRate::Velocity(&rate), &mut force);
        let column = force[0] * 4.0;
        assert_eq!(force, TWIST.map(|t| column * (0.25 * t)));
        column.into()
    })
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
    let gamma = TWIST.map(|t| Double::from(0.25 * t));
    let seen = Seen::new(&centre, moduli, kinematics, u);
    let mut q = [ZERO; 2];
    u.iter().zip(gamma).for_each(|(u, gamma)| add(&mut q, u.map(|u| u * gamma)));
    let [[c, minus_s], [s, _]] = seen.turn;
    let back = product(&[[c, s], [minus_s, c]], q);
    let k = stored_stiffness(element, rest, moduli).map(|row| row.map(|k| Double::from(k) * Double::from(moduli.mu)));
    let f = product(&k, back);
    let twist = product(&seen.turn, f);
    let turn = match kinematics {
        Kinematics::Corotated => (f[0] * back[1] - f[1] * back[0]) / seen.trace,
        Kinematics::Linear => ZERO,
    };
    let mut forces = seen.forces(&centre);
    for ((force, g), gamma) in forces.iter_mut().zip(&centre.gradients).zip(gamma) {
        add(force, twist.map(|f| f * gamma));
        add(force, product(&seen.turn, [(-g.y).into(), g.x.into()]).map(|v| v * turn));
    }
    forces
}

/// Returns the residual force of a state in twice as many digits, for elements of `N` nodes with these forces.
fn exact_residual<const N: usize>(
    (mesh, state): (&Mesh, &State),
    external: &[Vector2<f64>],
    forces: impl Fn(&[Vector2<f64>; N], &Vectors<N>) -> Vectors<N>,
) -> Vec<[Double; 2]> {
    let parts = state.compensated();
    let both = |n: usize, i: usize| Double::from(parts.rounded()[n][i]) + Double::from(parts.remainder()[n][i]);
    let mut residual: Vec<[Double; 2]> = external.iter().map(|f| [f.x.into(), f.y.into()]).collect();
    for nodes in mesh.elements() {
        let nodes: [usize; N] = std::array::from_fn(|a| nodes[a] as usize);
        let own = forces(&nodes.map(|n| mesh.nodes()[n]), &nodes.map(|n| [both(n, 0), both(n, 1)]));
        for (n, force) in nodes.into_iter().zip(own) {
            add(&mut residual[n], force.map(|f| -f));
        }
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
        let mut forces = Forces::new(state.displacement().len());
        problem.linearize(state, &mut forces, None);
        let residual = problem.balance(state, kinematics, 1.0, &mut forces);
        let mut bounds = forces.residual().to_vec();
        let bound = problem.residual_floor(state, &forces, &mut bounds).unwrap();
        let mesh = problem.system().mesh();
        let (body, external) = ((mesh, state), forces.external());
        let (element, seen) = (mesh.element().entry(), (problem.material().membrane(), kinematics));
        let exact = match element.kind {
            ElementKind::T3 => exact_residual(body, external, |x, u| exact_forces::<3>(element, seen, x, u)),
            ElementKind::Q4 => exact_residual(body, external, |x, u| exact_quad_forces(element, seen, x, u)),
            _ => exact_residual(body, external, |x, u| exact_forces::<6>(element, seen, x, u)),
        };
        let off = |(exact, found): (&[Double; 2], &Vector2<f64>)| {
            Vector2::new((Double::from(found.x) - exact[0]).0, (Double::from(found.y) - exact[1]).0)
        };
        let off: Vec<Vector2<f64>> = exact.iter().zip(forces.residual()).map(off).collect();
        let pattern = problem.system().pattern();
        for ((off, bound), mask) in off.iter().zip(&bounds).zip(pattern.mask()) {
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
    let mut simulation = Simulation::new(&scene).unwrap();
    assert_eq!(*simulation.solve(), Status::Converged);
    assert_eq!(simulation.equilibrium().unwrap().residual_floor(), None);
    // A slow iteration that is stopped early is not at the limit of precision.
    scene.solver.max_iterations = 1;
    scene.scale_loads(1e6);
    let mut simulation = Simulation::new(&scene).unwrap();
    assert!(matches!(simulation.solve(), Status::NotConverged(Reason::IterationLimit(1))));
    assert_eq!(simulation.equilibrium().unwrap().residual_floor(), None);
}

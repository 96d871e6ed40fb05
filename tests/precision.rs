//! The edge of double precision: how far down residuals go on slender bodies, and the bound of what rounding leaves in
//! them, against the same residual in twice as many digits.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::ops::{Add, Div, Mul, Neg, Sub};

use nalgebra::Vector2;
use warpbeam::assembly::{Forces, Kinematics, Matrix, Problem};
use warpbeam::element::{QuadraturePoint, Tangent};
use warpbeam::method::Reason;
use warpbeam::solver::Factor;
use warpbeam::study::extremes::{Body, Case, Outcome, Start};
use warpbeam::{ElementKind, MethodKind, Simulation, Status};

/// A cantilever a thousand times as long as high under α = 1e-6.
fn slender(element: ElementKind, method: MethodKind) -> Case {
    Case {
        body: Body::Beam,
        element,
        method,
        start: Start::Rest,
        alpha: 1e-6,
        young: 1e6,
        poisson: 0.3,
        slenderness: 1e3,
        aspect: 5.0,
        distortion: 0.0,
        moved: false,
    }
}

/// The simulation of a case, solved as far as it goes.
fn at_its_floor(case: Case) -> Simulation {
    let mut scene = case.scene();
    scene.solver.tolerance = 1e-14;
    let mut simulation = Simulation::new(&scene).unwrap();
    simulation.solve();
    simulation
}

/// The smallest residual of steps whose displacement is rounded to one number each.
fn plain_floor(problem: &Problem) -> f64 {
    let system = problem.system();
    let mut state = system.at_rest();
    let (mut forces, mut matrix) = (Forces::new(system.mesh().nodes().len()), Matrix::new(system.pattern()));
    let mut factor = Factor::new(system.symbolic()).unwrap();
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

/// What a displacement of one number a component leaves of the residual is fifteen times as much.
#[test]
fn the_second_part_of_the_displacement_lowers_the_floor() {
    for element in ElementKind::all() {
        for aspect in [1.0, 50.0] {
            let simulation = at_its_floor(Case { aspect, ..slender(element, MethodKind::Linear) });
            let (plain, residual) = (plain_floor(simulation.problem()), simulation.residual());
            println!("{} {aspect}: {plain:e} {residual:e} {:?}", element.id(), simulation.residual_floor());
            assert!(plain > 15.0 * residual, "{} {aspect}: {plain:e} {residual:e}", element.id());
        }
    }
}

/// An unevaluated sum of two numbers, as a number.
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

/// The residual force of a state in twice as many digits, for elements of `N` nodes that are sums over points.
fn exact_residual<const N: usize>(
    simulation: &Simulation,
    kinematics: Kinematics,
    external: &[Vector2<f64>],
) -> Vec<[Double; 2]> {
    let (mesh, moduli) = (simulation.system().mesh(), simulation.problem().material().membrane());
    let element = mesh.element().entry();
    let (mu2, lambda) = (Double::from(2.0 * moduli.mu), Double::from(moduli.lambda));
    let parts = simulation.state().compensated();
    let mut residual: Vec<[Double; 2]> = external.iter().map(|f| [f.x.into(), f.y.into()]).collect();
    for nodes in mesh.elements() {
        let rest: Vec<Vector2<f64>> = nodes.iter().map(|&n| mesh.nodes()[n as usize]).collect();
        let u = |a: usize, i: usize| {
            let n = nodes[a] as usize;
            Double::from(parts.rounded()[n][i]) + Double::from(parts.remainder()[n][i])
        };
        for rule in element.points {
            let point = QuadraturePoint::<N>::new(element, &rest, rule.at, rule.weight);
            let gradient = |a: usize, j: usize| Double::from(point.gradients[a][j]);
            let h = |i: usize, j: usize| (1..N).fold(ZERO, |sum, a| sum + (u(a, i) - u(0, i)) * gradient(a, j));
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
            let p = [0, 1].map(|j| [c * t[0][j] - s * t[1][j], s * t[0][j] + c * t[1][j]]);
            for (a, &node) in nodes.iter().enumerate() {
                for (i, sum) in residual[node as usize].iter_mut().enumerate() {
                    let force = p[0][i] * gradient(a, 0) + p[1][i] * gradient(a, 1);
                    *sum = *sum - force * point.area.into();
                }
            }
        }
    }
    residual
}

/// The bound is one: the residual in twice as many digits is no farther away, and not absurdly nearer.
#[test]
fn the_bound_of_rounding_holds() {
    for element in [ElementKind::T3, ElementKind::T6] {
        for (method, alpha, slenderness) in [
            (MethodKind::Linear, 1e-6, 1e3),
            (MethodKind::Linear, 1e3, 1e3),
            (MethodKind::Newton, 1e-6, 1e3),
            (MethodKind::Newton, 1.0, 1e3),
            (MethodKind::Newton, 30.0, 100.0),
            (MethodKind::Newton, 10.0, 5.0),
        ] {
            let simulation = at_its_floor(Case { alpha, slenderness, ..slender(element, method) });
            let (problem, state) = (simulation.problem(), simulation.state());
            let kinematics = if simulation.is_linear() { Kinematics::Linear } else { Kinematics::Corotated };
            let mut forces = Forces::new(state.displacement().len());
            problem.linearize(state, &mut forces, None);
            let relative = problem.balance(state, kinematics, 1.0, &mut forces);
            let mut scratch = forces.residual().to_vec();
            let bound = problem.residual_floor(state, &forces, &mut scratch).unwrap();
            let exact = match element {
                ElementKind::T3 => exact_residual::<3>(&simulation, kinematics, forces.external()),
                _ => exact_residual::<6>(&simulation, kinematics, forces.external()),
            };
            let off = |(exact, found): (&[Double; 2], &Vector2<f64>)| {
                Vector2::new((Double::from(found.x) - exact[0]).0, (Double::from(found.y) - exact[1]).0)
            };
            let off: Vec<Vector2<f64>> = exact.iter().zip(forces.residual()).map(off).collect();
            let pattern = problem.system().pattern();
            let scale = pattern.norm(forces.residual()) / relative;
            let error = pattern.norm(&off) / scale;
            let what =
                format!("{} {} {alpha} {slenderness}: {error:e} {bound:e} {relative:e}", element.id(), method.id());
            println!("{what}");
            assert!(error <= bound && bound <= 1000.0 * error, "{what}");
            // It bounds every node's by itself.
            let each = off.iter().zip(&scratch).zip(pattern.mask());
            assert!(each.into_iter().all(|((off, bound), mask)| {
                off.component_mul(mask).iter().zip(bound).all(|(off, bound)| off.abs() <= *bound)
            }));
        }
    }
}

/// A solve that ends where digits end says so, with the bound; one that stops above it does not.
#[test]
fn working_precision_is_called_what_it_is() {
    for element in ElementKind::all() {
        for method in [MethodKind::Linear, MethodKind::Warped, MethodKind::Newton] {
            let simulation = at_its_floor(slender(element, method));
            assert_eq!(*simulation.status(), Status::Converged, "{} {}", element.id(), method.id());
            let floor = simulation.residual_floor().unwrap();
            assert!(simulation.residual() <= floor && floor < 1e-6, "{floor:e} {:e}", simulation.residual());
        }
    }
    // Nearly incompressible, of cells fifty times as long as high: beyond the usual tolerance too.
    for (element, alpha) in [ElementKind::T6, ElementKind::Q4].into_iter().flat_map(|e| [(e, 0.01), (e, 0.1)]) {
        let case = Case { alpha, poisson: 0.4999, aspect: 50.0, ..slender(element, MethodKind::Newton) };
        let entry = case.solve().unwrap();
        assert_eq!(entry.outcome, Outcome::Certified, "{} {alpha}: {:e}", element.id(), entry.residual);
        assert!(entry.residual_floor.as_ref().is_none_or(|floor| entry.residual <= *floor && *floor <= 1e-5));
    }
    // What meets its tolerance needs no such words.
    let mut simulation =
        Simulation::new(&Case { slenderness: 5.0, ..slender(ElementKind::T6, MethodKind::Newton) }.scene()).unwrap();
    assert_eq!((simulation.solve().clone(), simulation.residual_floor()), (Status::Converged, None));
    // A slow iteration that is cut off is not there, whatever rounding does.
    let mut scene = Case { slenderness: 5.0, ..slender(ElementKind::T6, MethodKind::Newton) }.scene();
    scene.solver.max_iterations = 1;
    scene.scale_loads(1e6);
    let mut simulation = Simulation::new(&scene).unwrap();
    assert!(matches!(simulation.solve(), Status::NotConverged(Reason::IterationLimit(1))));
    assert_eq!(simulation.residual_floor(), None);
}

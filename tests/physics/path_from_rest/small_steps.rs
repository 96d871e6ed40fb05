//! Equilibria in small steps of the load factor: a judge of the path from rest that shares with it only the forces and
//! the tangent of the elements. Each step extrapolates the last ones, and corrects that by full Newton steps at a constant
//! load factor. Steps are halved where a correction is long or converges slowly, and where the number of unstable modes
//! changes; beyond that, they go on from a longer one. Where no step is short enough, the next extrapolation ignores the
//! earlier points: the steps then pass a sharp turn, but no limit point. A limit point beside which the body comes to rest
//! with as many unstable modes is none, as in the path, and so is a turn that no step resolves.

use crate::common::*;
use warpbeam::assembly::NodalSupport;
use warpbeam::solver::Factor;

/// Number of steps on a path along which nothing is difficult.
const STEPS: f64 = 160.0;
/// Length of steps that resolve sharp turns.
pub const SHARP: f64 = 1e-8;

/// Ratio of successive corrections that converge fast.
const FAST: f64 = 0.3;
/// Distance of two places that are the same, relative to the size of the body: a shorter jump is none.
const SAME_PLACE: f64 = 1e-3;

type Field = Vec<Vector2<f64>>;

/// Equilibrium, with the forces that its work needs.
#[derive(Clone)]
struct Point {
    factor: f64,
    u: Field,
    /// Loads, and forces of supports, on every node, N.
    forces: [Field; 2],
    modes: usize,
}

/// Path from rest, to the full load or to the limit point that ended it.
pub struct SmallSteps {
    /// Largest load factor that was reached: below 1 where no step leads further.
    pub factor: f64,
    /// Displacement there, m.
    pub u: Field,
    /// Load factors at which the number of unstable modes changes, with the numbers before and after.
    pub bifurcations: Vec<(f64, [usize; 2])>,
    /// Load factors of jumps to nearly the same place, which the path may count as none.
    pub short_jumps: Vec<f64>,
    /// Work of the loads and of the supports, J.
    pub work: [f64; 2],
    /// Sum of the magnitudes of both in each step, J.
    pub exchanged: f64,
    /// Elastic energy at the end, J.
    pub elastic: f64,
}

/// Follows the path of a simulation's scene by steps not shorter than `shortest`; `None` if the tangent at rest is
/// singular.
pub fn follow(simulation: &Simulation, shortest: f64) -> Option<SmallSteps> {
    let mut judge = Judge::new(simulation.problem());
    let rest = vec![Vector2::zeros(); simulation.displacement().len()];
    let mut points = vec![judge.equilibrium(rest, 0.0, [f64::INFINITY, FAST])?];
    let (mut bifurcations, mut short_jumps) = (Vec::new(), Vec::new());
    let (mut work, mut exchanged, longest) = ([0.0; 2], 0.0, 1.0 / STEPS);
    // The first step has nothing to extrapolate.
    let (mut step, mut speed) = (1e-2 * longest, f64::INFINITY);
    // The last points before a change of the number of unstable modes, and one beyond.
    let mut beyond: Vec<Vec<Point>> = Vec::new();
    loop {
        let last = points.last()?.clone();
        if last.factor >= 1.0 {
            break;
        }
        let factor = if last.factor + step > 1.0 - 0.5 * shortest { 1.0 } else { last.factor + step };
        let start = extrapolated(&points, factor);
        let ahead = largest_distance(&start, &last.u);
        let least = shortest.min(0.1 * last.factor).max(SHARP);
        let (is_short, is_alone) = (step <= least, points.len() == 1);
        // In a sharp turn of the path, the displacement soon grows much faster than before.
        let sudden = if step <= SHARP { 1e-5 * simulation.system().size() } else { 0.0 };
        let allowed = if is_alone { (4.0 * speed * (factor - last.factor)).max(sudden) } else { 0.25 * ahead };
        let next = judge.equilibrium(start, factor, [allowed, FAST]);
        // The shortest steps pass a jump to nearly the same place.
        let lands = step <= SHARP && is_alone && next.is_none();
        let next = next.or_else(|| {
            let landing = lands.then(|| judge.landing(&last))??;
            short_jumps.push(last.factor);
            Some(landing)
        });
        // Beside a singular tangent, rounding displaces points or hides them: the steps go on from one farther beyond,
        // unless they are short enough for a sharp turn of the path.
        let next = next.or_else(|| beyond.last().filter(|_| is_short && shortest > SHARP)?.last().cloned());
        match next {
            Some(next) if next.modes != last.modes && !is_short => {
                step = (0.5 * (factor - last.factor)).max(least);
                beyond.push([&points[..], &[next]].concat());
            }
            Some(mut next) => {
                if next.modes != last.modes {
                    bifurcations.push((next.factor, [last.modes, next.modes]));
                    if let Some(far) = beyond.drain(..).find(|far| far.last().is_some_and(|p| p.modes == next.modes)) {
                        points = far;
                        next = points.pop()?;
                    }
                }
                beyond.retain(|far| far.last().is_some_and(|p| p.factor > next.factor));
                for (work, (before, after)) in work.iter_mut().zip(last.forces.iter().zip(&next.forces)) {
                    let nodes = before.iter().zip(after).zip(last.u.iter().zip(&next.u));
                    let more = nodes.map(|((f, g), (u, v))| 0.5 * (f + g).dot(&(v - u))).sum::<f64>();
                    *work += more;
                    exchanged += more.abs();
                }
                speed = largest_distance(&next.u, &last.u) / (next.factor - last.factor);
                points.push(next);
                if points.len() > 3 {
                    points.remove(0);
                }
                step = (2.0 * step).min(longest);
            }
            None if is_short && !is_alone => drop(points.drain(..points.len() - 1)),
            None if is_short => break,
            None => step = (0.5 * (factor - last.factor)).max(least),
        }
    }
    let Point { factor, u, .. } = points.pop()?;
    let elastic = judge.problem.elastic_energy(&judge.problem.system().state_of(&u).ok()?);
    Some(SmallSteps { factor, u, bifurcations, short_jumps, work, exchanged, elastic })
}

/// Returns the polynomial through up to three points at a load factor.
fn extrapolated(points: &[Point], factor: f64) -> Field {
    let weight = |p: &Point| {
        let others = points.iter().filter(|other| other.factor != p.factor);
        others.map(|other| (factor - other.factor) / (p.factor - other.factor)).product::<f64>()
    };
    let mut u = vec![Vector2::zeros(); points[0].u.len()];
    for point in points {
        let weight = weight(point);
        u.iter_mut().zip(&point.u).for_each(|(u, v)| *u += v * weight);
    }
    u
}

struct Judge<'a> {
    problem: &'a Problem,
    forces: Forces,
    matrix: Matrix,
    factor: Factor,
    free: Vec<f64>,
}

impl<'a> Judge<'a> {
    fn new(problem: &'a Problem) -> Self {
        let system = problem.system();
        Self {
            problem,
            forces: Forces::new(system.mesh().nodes().len()),
            matrix: Matrix::new(system.pattern()),
            factor: Factor::new(system.symbolic().unwrap()).unwrap(),
            free: vec![0.0; system.dofs()],
        }
    }

    /// Moves the supports to their places.
    fn put_supports(&self, u: &mut [Vector2<f64>], factor: f64) {
        let (mesh, supports) = (self.problem.system().mesh(), self.problem.supports().all());
        let target = |support: &NodalSupport, x: Vector2<f64>| {
            let arm = x - support.middle;
            Rotation::from_angle(factor * support.rotation).apply(arm) - arm + support.displacement * factor
        };
        let mut is_fixed = vec![[false; 2]; u.len()];
        for support in supports {
            for &(node, own) in &support.nodes {
                for axis in (0..2).filter(|&axis| own[axis]) {
                    u[node as usize][axis] = target(support, mesh.nodes()[node as usize])[axis];
                    is_fixed[node as usize][axis] = true;
                }
            }
        }
        // Two points in an element disturb each other.
        for _ in 0..200 {
            let mut largest = 0.0_f64;
            for support in supports {
                for axis in (0..2).filter(|&axis| support.point.is_some_and(|axes| axes[axis])) {
                    let mean: f64 = support.weights.iter().map(|&(node, n)| n * u[node as usize][axis]).sum();
                    let off = target(support, support.middle)[axis] - mean;
                    let nodes = || support.weights.iter().filter(|(node, _)| !is_fixed[*node as usize][axis]);
                    let sum: f64 = nodes().map(|(_, n)| n * n).sum();
                    nodes().for_each(|&(node, n)| u[node as usize][axis] += n * off / sum);
                    largest = largest.max(off.abs());
                }
            }
            if largest <= 1e-15 * self.problem.system().size() {
                break;
            }
        }
    }

    /// Returns the first equilibrium a little beyond a point that is in the same place, but for the motion of the supports,
    /// and has as many unstable modes.
    fn landing(&mut self, from: &Point) -> Option<Point> {
        let near = SAME_PLACE * self.problem.system().size();
        [SHARP, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3].into_iter().find_map(|step| {
            let factor = (from.factor + step).min(1.0);
            let mut carried = from.u.clone();
            self.put_supports(&mut carried, factor);
            let by_supports = largest_distance(&carried, &from.u);
            let next = self.equilibrium(carried, factor, [f64::INFINITY; 2])?;
            let is_near = largest_distance(&next.u, &from.u) <= near + by_supports;
            (next.modes == from.modes && is_near).then_some(next)
        })
    }

    /// Returns the equilibrium at a load factor that full steps from `u` lead to, unless the first is longer than `allowed`,
    /// m, or the ratio of two of them is larger than `contraction`.
    fn equilibrium(&mut self, mut u: Field, factor: f64, [allowed, contraction]: [f64; 2]) -> Option<Point> {
        let system = self.problem.system();
        let (pattern, size) = (system.pattern(), system.size());
        self.put_supports(&mut u, factor);
        let mut allowed = allowed.max(1e-9 * size);
        for _ in 0..40 {
            let state = system.state_of(&u).ok()?;
            self.problem.linearize(&state, &mut self.forces, Some((Tangent::EXACT, &mut self.matrix)));
            self.problem.balance(&state, Kinematics::Corotated, factor, &mut self.forces);
            pattern.restrict(self.forces.residual(), &mut self.free);
            self.factor.factorize_symmetric(self.matrix.values());
            self.factor.solve_in_place(&mut self.free);
            let length = self.free.iter().map(|v| v.abs()).fold(0.0, f64::max);
            if length.is_nan() || length > allowed {
                return None;
            }
            pattern.add_free(&self.free, 1.0, &mut u);
            if length <= 1e-8 * size {
                let supports = self.forces.residual().iter().map(|f| -f).collect();
                let forces = [self.forces.external.to_vec(), supports];
                return Some(Point { factor, u, forces, modes: self.factor.negative_eigenvalues() });
            }
            allowed = contraction * length;
        }
        None
    }
}

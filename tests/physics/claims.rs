//! Tests the claims of results over random scenes, each by other means than the one that made it: equilibria by those of
//! other methods, stability by the eigenvalues of a stiffness of finite differences, and ρ by the iteration of
//! `warped`. Errors are tested in `reference.rs`.

use std::collections::BTreeMap;

use crate::common::random;
use warpbeam::assembly::{Forces, Kinematics};
use warpbeam::nalgebra::{DMatrix, Vector2};
use warpbeam::study::LoadPath;
use warpbeam::{MethodKind, Simulation, Status};

/// Number of claims of each kind, and those that are false.
#[derive(Debug, Default)]
struct Claims {
    checked: BTreeMap<&'static str, u32>,
    wrong: Vec<String>,
}

impl Claims {
    fn check(&mut self, kind: &'static str, seed: u64, is_true: bool, words: impl FnOnce() -> String) {
        *self.checked.entry(kind).or_default() += 1;
        if !is_true {
            self.wrong.push(format!("seed {seed}, {kind}: {}", words()));
        }
    }
}

/// Returns the largest distance of a node between two displacements, m, relative to the largest displacement.
fn distance(a: &[Vector2<f64>], b: &[Vector2<f64>]) -> f64 {
    let largest = a.iter().chain(b).map(|u| u.norm()).fold(f64::MIN_POSITIVE, f64::max);
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max) / largest
}

/// Returns the smallest eigenvalue of the exact stiffness relative to the largest, from central differences of forces.
fn smallest_eigenvalue(simulation: &Simulation) -> f64 {
    let problem = simulation.problem();
    let system = problem.system();
    let (n, nodes) = (system.dofs(), simulation.displacement().len());
    let pattern = system.pattern();
    let mut forces = Forces::new(nodes);
    let step = 1e-6 * system.strip()[1];
    let mut residual_at = |direction: &[f64], by: f64| {
        let mut state = simulation.state().clone();
        let mut u = state.displacement().to_vec();
        pattern.add_free(direction, by, &mut u);
        state = state.with_displacement(u).unwrap();
        system.update_rotations(&mut state, Kinematics::Corotated);
        problem.linearize(&state, &mut forces, None);
        problem.balance(&state, Kinematics::Corotated, 1.0, &mut forces);
        let mut free = vec![0.0; n];
        pattern.restrict(forces.residual(), &mut free);
        free
    };
    let mut stiffness = DMatrix::zeros(n, n);
    for i in 0..n {
        let mut unit = vec![0.0; n];
        unit[i] = 1.0;
        let (ahead, behind) = (residual_at(&unit, step), residual_at(&unit, -step));
        for j in 0..n {
            stiffness[(j, i)] = (behind[j] - ahead[j]) / (2.0 * step);
        }
    }
    let symmetric = (&stiffness + stiffness.transpose()) * 0.5;
    let eigenvalues = symmetric.symmetric_eigenvalues();
    eigenvalues.min() / eigenvalues.amax()
}

/// Returns the factor by which a small disturbance of an equilibrium grows or shrinks in an iteration of `warped`; `None`
/// if rounding errors hide it.
fn observed_ratio(equilibrium: &Simulation, rho: f64) -> Option<f64> {
    let mut scene = equilibrium.scene().clone().with_method(MethodKind::Warped);
    scene.solver.tolerance = 1e-14;
    let at_rest = equilibrium.displacement();
    let height = equilibrium.system().strip()[1];
    let mut warped = Simulation::with_system(&scene, equilibrium.system().clone()).ok()?;
    // A disturbance that is small in all iterations, and larger than rounding errors.
    let small = height * if rho > 1.0 { 1e-7 } else { 1e-3 };
    let (lowest, highest) = (1e-7 * height, 1e-3 * height);
    let mask = equilibrium.system().pattern().mask();
    let disturbed = at_rest.iter().zip(mask).enumerate().map(|(i, (u, mask))| {
        let push = |k: f64| ((i as f64 + k) * 0.754_877_666).fract() - 0.5;
        u + Vector2::new(push(0.0), push(0.3)).component_mul(&mask.map(|m| f64::from(m > 0.0))) * small
    });
    warped.start_from(&disturbed.collect::<Vec<_>>()).ok()?;
    let off = |simulation: &Simulation| {
        simulation.displacement().iter().zip(at_rest).map(|(a, b)| (a - b).norm_squared()).sum::<f64>().sqrt()
    };
    let (mut ratio, mut earlier) = (None, f64::INFINITY);
    for k in 0..30 {
        let before = off(&warped);
        warped.step();
        // An iteration that has ended does not move.
        if *warped.status() != Status::Running {
            break;
        }
        let after = off(&warped);
        if after < lowest && rho < 1.0 || after > highest && k > 0 {
            break;
        }
        // The first iterations remove the parts of the disturbance that shrink fast.
        // Modes of opposite signs beat: over two iterations they do not.
        ratio = (k > 1).then(|| (after / earlier).sqrt());
        earlier = before;
    }
    ratio
}

#[test]
fn claims_about_random_scenes_are_true() {
    let first: u64 = std::env::var("WARPBEAM_SEED").map_or(11_000, |seed| seed.parse().unwrap());
    let count = if crate::common::sweeps_run_in_full() { 300 } else { 30 };
    let (mut claims, mut unsolved) = (Claims::default(), 0);
    for seed in (first..).take(count) {
        let mut scene = random::scene(seed);
        scene.solver.accept_after = 0;
        let with = |method| Simulation::new(&scene.clone().with_method(method));
        let Ok(mut newton) = with(MethodKind::Newton) else { continue };
        let is_solved = *newton.solve() == Status::Converged;
        if !is_solved {
            // Short bodies under large moments are crushed before the full load.
            unsolved += 1;
            continue;
        }
        let certificate = newton.certify();
        let scale = newton.displacement().iter().map(|u| u.norm()).fold(0.0, f64::max);
        if newton.system().dofs() <= 200 {
            // Closer to singular than this, differences do not tell.
            let smallest = smallest_eigenvalue(&newton);
            if smallest.abs() > 1e-8 {
                claims.check("stable", seed, certificate.stable == Some(smallest > 0.0), || {
                    format!("{certificate:?}, but the smallest eigenvalue is {smallest}")
                });
            }
        }
        if let Some(rho) = certificate.fixed_point_rho
            && rho > 0.3
            && let Some(ratio) = observed_ratio(&newton, rho)
        {
            claims.check("ρ", seed, ratio < 1.3 * rho && ratio > (0.5 * rho).min(1.0), || {
                format!("{rho}, observed {ratio}")
            });
        }
        for method in [MethodKind::Warped, MethodKind::Auto] {
            let mut other = with(method).unwrap();
            if *other.solve() != Status::Converged {
                // Newton's method is never worse.
                continue;
            }
            let is_elsewhere = |simulation: &Simulation| {
                LoadPath::to_result(simulation, &|_| std::ops::ControlFlow::Continue(()))
                    .is_some_and(|path| path.elsewhere.is_some())
            };
            let off = distance(newton.displacement(), other.displacement());
            let allowed = match other.equilibrium().and_then(|it| it.auto_report()) {
                // Twice the error that the scene asks for.
                Some(auto) => (3.0 * auto.estimated_error).max(0.02 * scene.solver.max_error_percent),
                None => 1e-3,
            };
            let kind = if method == MethodKind::Auto { "auto's error" } else { "warped converges" };
            claims.check(kind, seed, off <= allowed || is_elsewhere(&other), || {
                format!("{off} off of newton, {scale} m; {:?}", other.equilibrium().and_then(|it| it.auto_report()))
            });
        }
    }
    println!("{:?}", claims.checked);
    assert!(claims.wrong.is_empty(), "{:#?}", claims.wrong);
    assert!(unsolved <= count / 20, "{unsolved} of {count} not solved");
    // None of the checks is skipped.
    assert!(claims.checked.len() == 4 && claims.checked.values().all(|&n| n as usize >= count / 30), "{claims:?}");
}

//! Tests the claims of results over random scenes, each by other means than the one that made it: equilibria by those of
//! other methods, stability and critical loads by the eigenvalues of a stiffness of finite differences, limit loads by
//! prescribed displacements, ρ by the iteration of `warped`, and advice by following it. Errors are tested in
//! `reference.rs`.

use std::collections::BTreeMap;

use crate::common::*;
use warpbeam::study::PathSummary;

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

fn path_of(simulation: &Simulation) -> Option<PathSummary> {
    LoadPath::to_result(simulation, &go_on)
}

/// Returns the claims of a result, without an error.
fn claims_of(simulation: &mut Simulation) -> Vec<Claim> {
    let rho = simulation.certify().fixed_point_rho;
    Claim::of_result(simulation, rho, path_of(simulation).as_ref(), None)
}

impl Claims {
    /// Checks the claims of a result that hold for the result alone.
    fn check_result(&mut self, claim: &Claim, seed: u64, simulation: &Simulation) {
        match claim.id {
            "converged" => {
                let mut scene = simulation.scene().clone();
                scene.solver.tolerance = 1e-14;
                let mut further = Simulation::with_system(&scene, simulation.system().clone()).unwrap();
                further.start_from(simulation.displacement()).unwrap();
                further.solve();
                let off = distance(simulation.displacement(), further.displacement());
                self.check(claim.id, seed, off < 1e-3, || format!("{off} off"));
            }
            "stable" | "unstable" if simulation.system().dofs() <= 200 => {
                let smallest = smallest_eigenvalue(simulation);
                // Closer to singular than this, differences do not tell.
                if smallest.abs() > 1e-8 {
                    self.check(claim.id, seed, (claim.id == "stable") == (smallest > 0.0), || {
                        format!("the smallest eigenvalue is {smallest}")
                    });
                }
            }
            "disturbance" if claim.numbers[0] > 0.3 => {
                let rho = claim.numbers[0];
                if let Some(ratio) = observed_ratio(simulation, rho) {
                    self.check(claim.id, seed, ratio < 1.3 * rho && ratio > (0.5 * rho).min(1.0), || {
                        format!("{rho}, observed {ratio}")
                    });
                }
            }
            _ => {}
        }
    }
}

/// Returns the numbers of the first claim of a kind.
fn stated<'a>(claims: &'a [Claim], id: &str) -> Option<&'a [f64]> {
    Some(&claims.iter().find(|claim| claim.id == id)?.numbers)
}

/// Returns the critical load factor next to the load.
fn critical(claims: &[Claim]) -> Option<f64> {
    Some(stated(claims, "critical")?[0])
}

/// Returns the largest distance of a node between two displacements, m, relative to the largest displacement.
fn distance(a: &[Vector2<f64>], b: &[Vector2<f64>]) -> f64 {
    let largest = a.iter().chain(b).map(|u| u.norm()).fold(f64::MIN_POSITIVE, f64::max);
    largest_distance(a, b) / largest
}

/// Returns the smallest eigenvalue of the exact stiffness relative to the largest, from central differences of forces.
fn smallest_eigenvalue(simulation: &Simulation) -> f64 {
    let step = 1e-6 * simulation.system().strip()[1];
    let stiffness = numeric_stiffness(simulation.problem(), simulation.state(), 1.0, step);
    let eigenvalues = ((&stiffness + stiffness.transpose()) * 0.5).symmetric_eigenvalues();
    eigenvalues.min() / eigenvalues.amax()
}

/// Returns the growth of a small disturbance in an iteration of `warped`; `None` if rounding errors hide it.
fn observed_ratio(equilibrium: &Simulation, rho: f64) -> Option<f64> {
    let mut scene = equilibrium.scene().clone().with_method(MethodKind::Warped);
    scene.solver.tolerance = 1e-14;
    let at_rest = equilibrium.displacement();
    let height = equilibrium.system().strip()[1];
    let mut warped = Simulation::with_system(&scene, equilibrium.system().clone()).ok()?;
    // A disturbance that is small in all iterations, and larger than rounding errors.
    let small = height * if rho > 1.0 { 1e-7 } else { 1e-3 };
    let (lowest, highest) = (1e-6 * height, 1e-3 * height);
    let mask = &equilibrium.system().pattern().mask;
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
    let seeds = seeds(11_000, 30, 300);
    let (mut claims, mut unsolved) = (Claims::default(), 0);
    for &seed in &seeds {
        let mut scene = random::scene(seed);
        scene.solver.accept_after = 0;
        let with = |method| Simulation::new(&scene.clone().with_method(method));
        let Ok(mut newton) = with(MethodKind::Newton) else { continue };
        if *newton.solve() != Status::Converged {
            // Short bodies under large moments are crushed before the full load.
            unsolved += 1;
            continue;
        }
        let scale = largest(newton.displacement());
        for claim in claims_of(&mut newton) {
            claims.check_result(&claim, seed, &newton);
        }
        for method in [MethodKind::Warped, MethodKind::Auto] {
            let mut other = with(method).unwrap();
            if *other.solve() != Status::Converged {
                // Newton's method is never worse.
                continue;
            }
            let is_elsewhere =
                |simulation: &Simulation| path_of(simulation).is_some_and(|path| path.elsewhere.is_some());
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
    assert!(claims.wrong.is_empty(), "{:#?}", claims.wrong);
    assert!(unsolved <= seeds.len() / 20, "{unsolved} of {} not solved", seeds.len());
    for kind in ["converged", "stable", "disturbance", "warped converges", "auto's error"] {
        let checked = claims.checked.get(kind).copied().unwrap_or_default() as usize;
        assert!(checked >= seeds.len() / 30, "{kind}: {claims:?}");
    }
}

/// A perfect column buckles, an arch jumps at the largest force that holds it, an imperfect body stays stable.
#[test]
fn claims_near_critical_loads_are_true() {
    let seeds = seeds(500, 12, 60);
    let mut claims = Claims::default();
    // After a long step of the last ones, a second mode is closer to 0 than the one that has buckled, or the stiffness of
    // the mode is far from its tangent; the second limit point of 71_039 is just below the first.
    for &seed in seeds.iter().chain(&[535, 72_037, 71_039]) {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9).wrapping_add(13));
        let slenderness = random.between(8.0, 60.0);
        // A row of triangles is not symmetric, which would be an imperfection of its own.
        let mut beam = Scene::beam(slenderness, 1.0).with_cells(16, 1).with_element(ElementKind::Q4);
        (beam.material.young, beam.material.poisson) = (1e6, random.between(0.0, 0.45));
        let euler = PI.powi(2) * 1e6 / 12.0 / slenderness.powi(2);
        let near = random.between(1.2, 2.5);
        let newton = |scene: Scene| solved(&scene.with_method(MethodKind::Newton));
        match seed % 3 {
            kind @ (0 | 1) => {
                let push = |part: f64, side: f64| {
                    let end = if kind == 0 { "right".into() } else { Place::from([0.5 * slenderness, 0.5]) };
                    let along = if kind == 0 { -0.25 * near * part * euler } else { 0.0 };
                    let scene = beam.clone().clamp("left").force(end, [along, side]);
                    match kind {
                        0 => scene,
                        _ => scene.clamp("right").moved([-4.0 * near * part * euler / 1e6 * slenderness, 0.0], 0.0),
                    }
                };
                let mut column = newton(push(1.0, 0.0));
                let own = claims_of(&mut column);
                let Some(&[at]) = stated(&own, "buckles") else {
                    claims.check("buckles", seed, false, || format!("{own:?}"));
                    continue;
                };
                let [below, beyond] = [0.99, 1.01].map(|part| smallest_eigenvalue(&newton(push(part * at, 0.0))));
                claims.check("buckles", seed, below > 0.0 && beyond < 0.0, || format!("{at}: {below}, {beyond}"));
                for claim in &own {
                    claims.check_result(claim, seed, &column);
                }
                let is_near = |scene: Scene, expected: f64| {
                    critical(&claims_of(&mut solved(&scene))).is_some_and(|at| (at / expected - 1.0).abs() < 1e-3)
                };
                let below = push(0.8 * at, 0.0).with_method(MethodKind::Newton);
                let is_stated = is_near(below, 1.25) && is_near(push(1.0, 0.0).with_method(MethodKind::Linear), at);
                let far = claims_of(&mut newton(push(0.6 * at, 0.0)));
                claims.check("critical", seed, is_stated && critical(&far).is_none(), || format!("{at}: {far:?}"));
                let helps = stated(&own, "helps").is_some();
                let mut helped = newton(push(1.0, 1e-4 * euler));
                let is_stable =
                    stated(&claims_of(&mut helped), "stable").is_some() && smallest_eigenvalue(&helped) > 0.0;
                claims.check("helps", seed, helps && is_stable, || format!("{own:?}"));
                // A body that has buckled has left the path that is said to be unstable.
                let mut left = Simulation::new(&push(1.0, 0.0).with_method(MethodKind::Newton)).unwrap();
                left.start_from(helped.displacement()).unwrap();
                left.solve();
                if distance(left.displacement(), column.displacement()) > 0.05 && *left.status() == Status::Converged {
                    let own = claims_of(&mut left);
                    let has_left =
                        own.iter().any(|claim| claim.id == "elsewhere" && claim.text.to_string().contains("unstable"));
                    let is_true = has_left && stated(&own, "buckles").is_none();
                    claims.check("elsewhere", seed, is_true, || format!("{own:?}"));
                }
            }
            _ => {
                let rise = random.between(1.5, 4.0);
                beam.beam.as_mut().unwrap().rise = rise;
                let crown = [0.5 * slenderness, rise + 0.5];
                let arch = beam.clamp("left").clamp("right").probe("crown", Place::from(crown));
                let moved = arch.clone().support(crown, &[Axis::Y]).moved([0.0, -2.0 * rise], 0.0);
                let path = LoadPath::of(&moved, &go_on).unwrap();
                let of_path = Claim::of_path(&moved, &path);
                // A buckling arch leaves this path.
                let limit = stated(&of_path, "limit_load").filter(|_| path.is_plain());
                let Some(&[motion, reaction]) = limit else { continue };
                let held = [0.99, 1.01].map(|part| {
                    let at = arch.clone().support(crown, &[Axis::Y]).moved([0.0, -motion * part], 0.0);
                    newton(at).solution().supports[2].force.y.abs()
                });
                let is_largest = held.iter().all(|held| *held <= reaction.abs() * (1.0 + 1e-6));
                claims.check("limit_load", seed, is_largest, || format!("{reaction} at {motion}, {held:?}"));
                let load = 1.3 * reaction.abs();
                let beyond = claims_of(&mut newton(arch.clone().force(crown, [0.0, -load])));
                let jump = stated(&beyond, "jumps");
                let is_same = jump.is_some_and(|jump| (jump[0] * load / reaction.abs() - 1.0).abs() < 1e-3);
                claims.check("jumps", seed, is_same, || format!("{jump:?} of {load} N, {reaction} N"));
                let below = claims_of(&mut newton(arch.force(crown, [0.0, -0.98 * reaction.abs()])));
                claims.check("does not jump", seed, stated(&below, "jumps").is_none(), || format!("{below:?}"));
                let is_near = critical(&below).is_some_and(|at| (0.98 * at - 1.0).abs() < 1e-3);
                claims.check("critical", seed, is_near, || format!("{below:?}"));
            }
        }
    }
    assert!(claims.wrong.is_empty(), "{:#?}", claims.wrong);
    for kind in ["buckles", "critical", "helps", "elsewhere", "unstable", "limit_load", "jumps", "does not jump"] {
        let checked = claims.checked.get(kind).copied().unwrap_or_default() as usize;
        assert!(checked >= seeds.len() / 6, "{kind}: {claims:?}");
    }
}

/// Claims of a study agree with its table.
#[test]
fn claims_of_a_study_are_those_of_its_table() {
    let scene = scene("cantilever");
    let study = Study::new(&scene, Extent::Quick, &go_on).unwrap();
    let csv = study.table();
    let (names, rows) = table(&csv);
    let of = |row: &[&str], name: &str| -> f64 {
        row[names.iter().position(|n| *n == name).unwrap()].parse().unwrap_or(f64::INFINITY)
    };
    let mut kinds = Vec::new();
    for percent in [50.0, 10.0, 3.0, 1.0, 0.3, 1e-3, 1e-9] {
        let within = rows.iter().filter(|row| of(row, "at_most_percent") <= percent);
        let fastest = within.map(|row| of(row, "time_us")).fold(f64::INFINITY, f64::min);
        let claim = Claim::of_study(&study, percent);
        kinds.push(claim.id);
        match claim.id {
            "best" => {
                let text = claim.text.to_string();
                let (_, time) = text.split_once(" costs ").unwrap();
                let stated: f64 = time.split_once(" ms").unwrap().0.parse().unwrap();
                assert!((1e3 * stated - fastest).abs() <= 0.06, "{percent} %: {text}, {fastest} µs");
            }
            "not_reached" => assert!(fastest.is_infinite(), "{percent} %"),
            "not_known" => assert!(claim.numbers[1] >= percent, "{percent} %"),
            other => panic!("{other}"),
        }
        let demand = Demand { max_error_percent: Some(percent), max_time_ms: None };
        assert_eq!(study.meeting(demand).is_empty(), fastest.is_infinite(), "{percent} %");
    }
    assert!(["best", "not_known"].iter().all(|kind| kinds.contains(kind)), "{kinds:?}");
}

//! Tests of moments that rotate with their edge: potential, work and full turns.

use crate::common::*;

/// Returns the scene of the rolled-up beam with `turns` times the moment that closes it, 2πEI/L.
fn rolled(turns: f64) -> Scene {
    let mut scene = scene("roll-up");
    scene.scale_loads(turns);
    scene.solver.max_iterations = 2000;
    scene
}

/// Returns the work M θ with θ = M L / E I.
fn expected_work(turns: f64) -> f64 {
    let scene = scene("roll-up");
    let beam = scene.beam.as_ref().unwrap();
    let bending = scene.material.young * scene.material.thickness * beam.height.powi(3) / 12.0;
    TAU * TAU * turns * turns * bending / beam.length
}

/// The loads do the work M θ for any number of turns of the edge: twice the stored energy, by Clapeyron's theorem.
#[test]
fn the_work_of_a_moment_counts_full_rotations() {
    for turns in [0.25, 0.5, 0.75, 1.0, 1.5, 2.0, -1.0] {
        let mut simulation = Simulation::new(&rolled(turns)).unwrap();
        // Steps of half a turn: a beam rolled up twice in one step finds other equilibria.
        for i in 1..=(2.0 * f64::abs(turns)).ceil() as u32 {
            let reached = (0.5 * f64::from(i)).min(turns.abs()) * turns.signum();
            simulation.change_scene(&rolled(reached)).unwrap();
            assert_eq!(*simulation.solve(), Status::Converged, "{reached} turns");
        }
        let energy = simulation.solution().energy;
        let work = expected_work(turns);
        assert!((energy.external / work - 1.0).abs() < 0.01, "{turns} turns: {} J, not {work} J", energy.external);
        assert!((energy.external / energy.elastic / 2.0 - 1.0).abs() < 0.01, "{turns} turns: {energy:?}");
        let turned = turn_of_the_right_edge(simulation.system(), simulation.state());
        assert!((turned - TAU * turns).abs() < 0.01 * TAU * turns.abs(), "{turns} turns: {turned}");
    }
}

fn turn_of_the_right_edge(system: &System, state: &State) -> f64 {
    let right = system.edges().iter().position(|e| e.name() == "right").unwrap();
    state.edge_angles()[right]
}

fn problem() -> Problem {
    let scene = Scene::beam(2.0, 1.0).with_cells(3, 2).with_material(Material::new(100.0, 0.3)).clamp("left");
    let scene = scene.force("right", [0.3, -0.2]).gravity([0.1, -0.4]).moment("right", 3.0);
    Problem::new(&scene, System::new(&scene).unwrap().into()).unwrap()
}

/// Returns the force of the loads on every node, N.
fn force(problem: &Problem, state: &State, factor: f64) -> Vec<Vector2<f64>> {
    let mut force = vec![Vector2::zeros(); state.displacement().len()];
    problem.loads().force(problem.system(), state.displacement(), Kinematics::Corotated, factor, &mut force);
    force
}

/// Returns the state of a beam rolled up by `angle`, reached from rest in small steps.
fn rolled_state(problem: &Problem, angle: f64) -> State {
    let mut state = problem.system().at_rest();
    let mut now = 0.0f64;
    while now != angle {
        now += (angle - now).clamp(-0.3, 0.3);
        let u = problem.system().mesh().nodes().iter().map(|x| {
            let (s, c) = (now * x.x / 2.0).sin_cos();
            Vector2::new(x.x * 0.5 - s * x.y, 0.7 * x.x + c * x.y) - x
        });
        state = state.with_displacement(u.collect()).unwrap();
        problem.system().update_rotations(&mut state, Kinematics::Corotated);
    }
    state
}

/// f_ext is the negative gradient of the loads' potential, before and beyond a full turn.
#[test]
fn the_force_is_the_gradient_of_the_potential_beyond_a_full_rotation() {
    const FACTOR: f64 = 0.7;
    let problem = problem();
    for angle in [0.0, 1.0, PI - 1e-9, PI + 0.1, TAU + 0.5, 2.0 * TAU - 0.2, -TAU - 1.0] {
        let state = rolled_state(&problem, angle);
        assert!((turn_of_the_right_edge(problem.system(), &state) - angle).abs() < 1e-9);
        let force = force(&problem, &state, FACTOR);
        check_gradient(&force, 1e-6, 1e-7 * largest(&force), |node, step| {
            let mut u = state.displacement().to_vec();
            u[node] += step;
            let mut moved = state.with_displacement(u).unwrap();
            problem.system().update_rotations(&mut moved, Kinematics::Corotated);
            -problem.loads().potential(&moved, FACTOR)
        });
    }
}

/// The potential is the work along any path: ∫ f · du by the trapezoidal rule, over more than a full turn.
#[test]
fn the_potential_is_the_work_along_a_path() {
    let problem = problem();
    let states: Vec<State> = (0..=400).map(|i| rolled_state(&problem, 1.2 * TAU * f64::from(i) / 400.0)).collect();
    let mut work = 0.0;
    for pair in states.windows(2) {
        let (before, after) = (force(&problem, &pair[0], 1.0), force(&problem, &pair[1], 1.0));
        for ((f, g), (u, v)) in before.iter().zip(&after).zip(pair[0].displacement().iter().zip(pair[1].displacement()))
        {
            work += 0.5 * (f + g).dot(&(v - u));
        }
    }
    let potential = |state: &State| problem.loads().potential(state, 1.0);
    let difference = potential(&states[0]) - potential(states.last().unwrap());
    assert!((work - difference).abs() < 1e-3 * difference.abs(), "{work} {difference}");
}

/// Exactly, for any rotation of the edge. If both states are equal, it is the ordinary force.
#[test]
fn between_two_states_the_loads_work_by_their_potential() {
    let problem = problem();
    let potential = |state: &State| problem.loads().potential(state, 1.0);
    for (from, to) in [(0.0, 0.0), (0.4, 0.4), (0.3, 0.3 + 1e-6), (0.1, 0.9), (1.0, -1.5), (3.0, 3.0 + 2.5), (TAU, 8.0)]
    {
        let states = [from, to].map(|angle| rolled_state(&problem, angle));
        let mut force = vec![Vector2::zeros(); states[0].displacement().len()];
        problem.loads().force_between(problem.system(), [&states[0], &states[1]], &mut force);
        let increment = states[1].displacement().iter().zip(states[0].displacement()).map(|(b, a)| b - a);
        let work: f64 = increment.zip(&force).map(|(increment, f)| increment.dot(f)).sum();
        let fall = potential(&states[0]) - potential(&states[1]);
        assert!((work - fall).abs() < 1e-12 * (1.0 + fall.abs()), "{from} to {to}: {work} {fall}");
        let off = largest_distance(&force, &self::force(&problem, &states[0], 1.0));
        assert!(if (to - from).abs() < 1e-5 { off < 1e-5 } else { off > 1e-3 }, "{from} to {to}: {off}");
    }
}

//! Fuzz tests of the scene parser, the Gmsh reader, and the solver on small scenes: no panic, no hang, finite results
//! and bounded memory. `cargo test` runs a bounded number of random inputs; CONTRIBUTING.md describes runs guided by
//! coverage.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU32, Ordering};

use peak_alloc::PeakAlloc;
use warpbeam::element::ELEMENTS;
use warpbeam::scene::registry;
use warpbeam::scene::units::parse;
use warpbeam::study::LoadPath;
use warpbeam::{Axis, ElementKind, Field, Material, Mesh, MethodKind, Progress, Scene, Simulation, Status};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

const BOTH: &[Axis] = &[Axis::X, Axis::Y];

/// Number of random paths that `cargo test` follows.
const ITERATIONS: usize = 100;

/// Largest memory that all tests of this file together may use, MB.
const MAX_MEMORY_MB: f32 = 256.0;

fn memory_is_bounded() {
    let peak = MEMORY.peak_usage_as_mb();
    assert!(peak < MAX_MEMORY_MB, "{peak} MB");
}

/// Choices taken from the bytes of an input, then from a random sequence seeded with them.
struct Choices<'a> {
    bytes: &'a [u8],
    state: u64,
}

impl<'a> Choices<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        // FNV-1a.
        let hash = |state: u64, byte: &u8| (state ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        Self { bytes, state: bytes.iter().fold(0xcbf2_9ce4_8422_2325, hash) | 1 }
    }

    fn byte(&mut self) -> u8 {
        if let Some((first, rest)) = self.bytes.split_first() {
            self.bytes = rest;
            return *first;
        }
        // Xorshift64 (Marsaglia 2003).
        self.state ^= self.state << 13;
        self.state ^= self.state >> 7;
        self.state ^= self.state << 17;
        (self.state >> 32) as u8
    }

    fn below(&mut self, n: usize) -> usize {
        usize::from(u16::from_le_bytes([self.byte(), self.byte()])) % n
    }

    fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    /// Returns numbers over many decades, and special values.
    fn number(&mut self) -> String {
        match self.byte() {
            0..=159 => format!("{:e}", 10f64.powf(f64::from(self.byte()) / 32.0 - 3.0)),
            160..=199 => format!("{:?}", 0.1 + f64::from(self.byte()) / 25.0),
            200..=229 => format!("{:e}", 10f64.powf(f64::from(self.byte()) / 9.0 - 12.0)),
            230..=239 => format!("-{:e}", 10f64.powf(f64::from(self.byte()) / 32.0 - 3.0)),
            _ => self.of(&["0.0", "-0.0", "nan", "inf", "-1.0", "5e-324", "1.7976931348623157e308", "9e99"]).to_owned(),
        }
    }

    /// Returns a scene file with random words and numbers. Some are invalid and must give an error, not a panic.
    fn scene(&mut self) -> String {
        let edges = ["left", "right", "bottom", "top"];
        let mut text = format!(
            "name = \"Random\"\n[beam]\nlength = {}\nheight = {}\nrise = {}\ncells = [{}, {}]\nelement = \"{}\"\ndiagonals = \"{}\"\n\
             [material]\nyoung = {}\npoisson = {:?}\ndensity = {}\nthickness = {}\nplane = \"{}\"\n",
            self.number(),
            self.number(),
            if self.below(3) == 0 { self.number() } else { "0.0".to_owned() },
            1 + self.below(12),
            1 + self.below(4),
            self.of(&["t3", "t6"]),
            self.of(&["alternating", "same"]),
            self.number(),
            f64::from(self.byte()) * 1.49 / 255.0 - 0.99,
            self.number(),
            self.number(),
            self.of(&["stress", "strain"]),
        );
        for _ in 0..=self.below(2) {
            let fix = self.of(&["\"x\", \"y\"", "\"x\", \"y\"", "\"x\"", "\"y\""]);
            let place = match self.below(4) {
                0 => format!("at = [{}, {}]\nacts_on = \"point\"", self.number(), self.number()),
                _ => format!("edge = \"{}\"", self.of(&edges)),
            };
            text += &format!("[[support]]\n{place}\nfix = [{fix}]\n");
            text += &match self.below(12) {
                0 if fix.len() > 3 => format!("displacement = [{}, {}]\n", self.number(), self.number()),
                1 => format!("displacement = [0.0, {}]\n", self.number()),
                2 => format!("displacement = [0.0, {}]\nturn = {}\n", self.number(), self.number()),
                3 => format!("turn = {:e}\n", f64::from(self.byte()) / 25.0 - 5.0),
                _ => String::new(),
            };
        }
        for _ in 0..=self.below(2) {
            text += &match self.below(5) {
                0 => format!("[[load]]\nkind = \"gravity\"\nacceleration = [{}, {}]\n", self.number(), self.number()),
                1 => {
                    format!("[[load]]\nkind = \"moment\"\nedge = \"{}\"\nmoment = {}\n", self.of(&edges), self.number())
                }
                2 => format!(
                    "[[load]]\nkind = \"force\"\nat = [{}, 0.0]\nforce = [0.0, {}]\n",
                    self.number(),
                    self.number()
                ),
                _ => {
                    let (edge, force) = (self.of(&edges), [self.number(), self.number()].join(", "));
                    format!("[[load]]\nkind = \"force\"\nedge = \"{edge}\"\nforce = [{force}]\n")
                }
            };
        }
        text += &format!("[[probe]]\nname = \"p\"\nedge = \"{}\"\n", self.of(&edges));
        text += &format!(
            "[solver]\nmethod = \"{}\"\nmax_iterations = 1000\nmax_error_percent = {:e}\n",
            self.of(&["linear", "warped", "newton", "auto"]),
            10f64.powi(self.below(5) as i32 - 3)
        );
        text
    }

    /// Returns a number from 0 to 1.
    fn unit(&mut self) -> f64 {
        f64::from(u16::from_le_bytes([self.byte(), self.byte()])) / 65535.0
    }

    /// Returns a number from `-size` to `size`.
    fn within(&mut self, size: f64) -> f64 {
        size * (2.0 * self.unit() - 1.0)
    }

    /// Returns the scene of a body, 1 m high, held at edges and points that may move, up to 100 times its critical load.
    fn moved_scene(&mut self) -> Scene {
        let length = 1.0 + 40.0 * self.unit().powi(2);
        let rise = if self.below(4) == 0 { self.within(0.3 * length) } else { 0.0 };
        let (along, across, element) = (1 + self.below(10) as u32, 1 + self.below(2) as u32, self.of(ELEMENTS).kind);
        let mut scene = Scene::beam(length, 1.0).with_rise(rise).with_cells(along, across).with_element(element);
        scene.material = Material::new(1e6, 0.49 * self.unit());
        for edge in ["left", "right", "top"] {
            let turn = self.within(400.0).to_radians();
            let at = [self.unit() * length, self.within(0.5)];
            let by = [self.within(0.5 * length), self.within(0.5 * length)];
            let (kind, moves) = (self.below(7), self.below(2) == 0);
            let by = if moves { by } else { [0.0; 2] };
            scene = match kind {
                0 | 1 if edge != "top" => scene.clamp(edge).moved(by, turn),
                2..=4 => {
                    let fix = self.of(&[BOTH, BOTH, &[Axis::Y]]);
                    let is_node = self.below(4) == 0;
                    let held = if is_node { scene.support(at, fix) } else { scene.point_support(at, fix) };
                    held.moved(if fix == BOTH { by } else { [0.0; 2] }, 0.0)
                }
                _ => scene,
            };
        }
        // π² EI/L² is about the critical load.
        let critical = 1e6 / length.powi(2);
        for _ in 0..self.below(3) {
            let size = critical * 10f64.powf(self.within(2.0));
            let (x, force) = (self.unit() * length, [self.within(size), self.within(size)]);
            scene = match self.below(4) {
                0 => scene.moment("right", self.within(size * length)),
                1 => scene.point_force([x, 0.0], force),
                2 => scene.gravity(force.map(|force| force / (1000.0 * length))),
                _ => scene.force("right", force),
            };
        }
        let methods = [MethodKind::Newton, MethodKind::Newton, MethodKind::Auto, MethodKind::Warped];
        scene.probe("p", "right").with_method(self.of(&methods))
    }

    /// Returns the text with some pieces replaced, removed, doubled or inserted.
    fn damage(&mut self, text: &str) -> String {
        let mut letters: Vec<char> = text.chars().collect();
        for _ in 0..=self.below(3) {
            let at = self.below(letters.len().max(1)).min(letters.len());
            let end = (at + self.below(24)).min(letters.len());
            let with =
                self.of(&["", "", "9", "-", ".", "\"", "\n", "[", "]", "é", "1e99", "nan", "4294967295", "$End", " "]);
            let piece: Vec<char> = letters[at..end].to_vec();
            let new = with.chars();
            match self.below(3) {
                0 => drop(letters.splice(at..end, new)),
                1 => drop(letters.splice(at..at, piece)),
                _ => drop(letters.splice(at..at, new)),
            }
        }
        letters.into_iter().collect()
    }
}

/// Number of scenes that could be set up, and of those that converged after some steps.
#[derive(Default)]
struct Counts([AtomicU32; 2]);

impl Counts {
    fn solve(&self, scene: &Scene) {
        for (count, yes) in self.0.iter().zip(solve(scene)) {
            count.fetch_add(u32::from(yes), Ordering::Relaxed);
        }
    }
}

/// Solves a scene. Returns `true` if it could be set up, and if it converged.
fn solve(scene: &Scene) -> [bool; 2] {
    let Ok(mut simulation) = Simulation::new(scene) else { return [false; 2] };
    let text = scene.to_toml().unwrap();
    simulation.solve();
    assert_ne!(*simulation.status(), Status::Running);
    assert!(simulation.iterations() <= scene.solver.max_iterations);
    assert!(simulation.displacement().iter().all(|u| u.x.is_finite() && u.y.is_finite()), "{text}");
    assert!(simulation.residual().is_finite(), "{text}");
    let mut values = Vec::new();
    for field in Field::ALL {
        simulation.field(field, &mut values);
        assert!(values.iter().flatten().all(|v| v.is_finite()), "{field:?} {text}");
    }
    assert!(simulation.certify().fixed_point_rho.is_none_or(f64::is_finite), "{text}");
    [true, *simulation.status() == Status::Converged && simulation.iterations() > 2]
}

#[test]
fn the_solver_solves_or_refuses_small_scenes() {
    let counts = Counts::default();
    bolero::check!().with_iterations(8000).with_max_len(256).for_each(|bytes: &[u8]| {
        if let Ok(scene) = Scene::from_toml(&Choices::new(bytes).scene()) {
            counts.solve(&scene);
        }
        memory_is_bounded();
    });
    let [set_up, converged] = counts.0.map(AtomicU32::into_inner);
    // About 810 and 300, with deviations of 27 and 17.
    assert!(set_up > 600 && converged > 200, "too few of the random scenes are scenes: {set_up}, {converged}");
}

/// The bodies have held points, and supports that turn and move.
#[test]
fn paths_are_followed_or_refused() {
    let counts = Counts::default();
    bolero::check!().with_iterations(ITERATIONS).with_max_len(256).for_each(|bytes: &[u8]| {
        let scene = Choices::new(bytes).moved_scene();
        counts.solve(&scene);
        let text = scene.to_toml().unwrap();
        // A path may be long: it is cancelled as by a user.
        let watched = || {
            let left = AtomicU32::new(200);
            move |_: Progress<'_>| match left
                .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1))
            {
                Ok(_) => ControlFlow::Continue(()),
                Err(_) => ControlFlow::Break(()),
            }
        };
        if let Some(path) = LoadPath::of(&scene, &watched()) {
            let states = path.states.iter().flat_map(|state| {
                let reactions = state.reactions.iter().flat_map(|r| [r.force.x, r.force.y, r.moment]);
                state.probes.iter().flat_map(|u| [u.x, u.y]).chain(reactions).chain([state.factor])
            });
            assert!(states.chain([path.supports_work]).all(f64::is_finite), "{text}");
        }
        if let Ok(mut simulation) = Simulation::new(&scene) {
            simulation.solve();
            let summary = LoadPath::to_result(&simulation, &watched());
            assert!(summary.and_then(|summary| summary.supports_work).is_none_or(f64::is_finite), "{text}");
        }
        memory_is_bounded();
    });
    let [set_up, converged] = counts.0.map(AtomicU32::into_inner);
    let few = ITERATIONS as u32 / 8;
    assert!(set_up > 2 * few && converged > few, "too few of the random scenes are scenes: {set_up}, {converged}");
}

#[test]
fn the_scene_parser_reads_or_refuses_any_text() {
    bolero::check!().with_iterations(6000).with_max_len(512).for_each(|bytes: &[u8]| {
        let mut choices = Choices::new(bytes);
        let text = match choices.below(3) {
            0 => String::from_utf8_lossy(bytes).into_owned(),
            1 => {
                let scene = choices.scene();
                choices.damage(&scene)
            }
            _ => {
                let built_in = choices.of(registry::BUILT_IN);
                choices.damage(built_in.toml)
            }
        };
        if let Ok(scene) = Scene::from_toml(&text) {
            assert!(scene.validate().is_ok(), "{text}");
        }
        memory_is_bounded();
    });
}

/// For any text and unit, the parser returns a number or an error; a scene file with that text gives the same number.
#[test]
fn units_are_read_or_refused() {
    let words = [
        "1", "12", "-3.5", "1e9", "nan", "inf", " ", "k", "M", "G", "µ", "m", "N", "Pa", "g", "cm", "s", "rad", "°",
        "%", "/", "·", "^", "²", "³", "-1", "⁻¹", "\"", "\n", "in", "é",
    ];
    let accepted = AtomicU32::new(0);
    bolero::check!().with_iterations(20_000).with_max_len(64).for_each(|bytes: &[u8]| {
        let mut choices = Choices::new(bytes);
        let text = match choices.below(4) {
            0 => String::from_utf8_lossy(bytes).into_owned(),
            1 => format!("{}{}", choices.of(&["1 ", "-2.5", "1e9 "]), choices.of(&words)),
            _ => (0..=choices.below(8)).map(|_| choices.of(&words)).collect(),
        };
        let unit = choices.of(&["Pa", "N", "m", "kg/m³", "m/s²", "1/s", "rad/s", "°", "%", ""]);
        match parse(&text, unit) {
            Ok(value) => {
                accepted.fetch_add(1, Ordering::Relaxed);
                assert_eq!(parse(&format!(" {text} "), unit).unwrap().to_bits(), value.to_bits(), "{text}");
            }
            Err(error) => assert!(error.to_string().chars().count() < 400, "{error}"),
        }
        let file = registry::find("article").unwrap().toml.replacen("young = ", &format!("young = '{text}' #"), 1);
        if let Ok(scene) = Scene::from_toml(&file) {
            assert_eq!(scene.material.young.to_bits(), parse(&text, "Pa").unwrap().to_bits(), "{text}");
        }
        memory_is_bounded();
    });
    assert!(accepted.into_inner() > 200);
}

/// A square of two triangles whose left side has a name.
const SQUARE: &str = include_str!("../data/square.msh");

#[test]
fn the_gmsh_reader_reads_or_refuses_any_file() {
    assert!(Mesh::from_gmsh(SQUARE, ElementKind::T6).is_ok());
    bolero::check!().with_iterations(20_000).with_max_len(128).for_each(|bytes: &[u8]| {
        let mut choices = Choices::new(bytes);
        let text =
            if choices.byte() < 8 { String::from_utf8_lossy(bytes).into_owned() } else { choices.damage(SQUARE) };
        if let Ok(mesh) = Mesh::from_gmsh(&text, choices.of(ELEMENTS).kind) {
            assert!(mesh.nodes().iter().all(|x| x.x.is_finite() && x.y.is_finite()));
            assert!(mesh.connectivity().iter().all(|&n| (n as usize) < mesh.nodes().len()), "{text}");
            assert_eq!(mesh.refined().element_count(), 4 * mesh.element_count());
        }
        memory_is_bounded();
    });
}

/// Scenes and meshes that are too large are refused before memory is allocated for them.
#[test]
fn enormous_models_are_refused_before_allocation() {
    let built_in = registry::find("article").unwrap().toml;
    for cells in ["[100000, 100000]", "[4294967295, 1]", "[100000, 3]"] {
        let text = built_in.replacen("cells = [5, 1]", &format!("cells = {cells}"), 1);
        assert!(text.contains(cells));
        assert!(Scene::from_toml(&text).is_err(), "{cells}");
    }
    for (old, new) in [
        ("1 4 1 4\n2 1 0 4", "1 4000000000 1 4\n2 1 0 4000000000"),
        ("2 3 1 3\n1 4 1 1", "2 4000000000 1 3\n1 4 1 4000000000"),
        ("2 1 2 2\n", "2 1 2 18446744073709551615\n"),
        ("$PhysicalNames\n1\n", "$PhysicalNames\n4000000000\n"),
        ("0 1 1 0\n", "0 4000000000 1 0\n"),
    ] {
        assert!(SQUARE.contains(old));
        assert!(Mesh::from_gmsh(&SQUARE.replacen(old, new, 1), ElementKind::T3).is_err(), "{new}");
    }
    memory_is_bounded();
}

//! Random scenes from a fixed seed.

use super::BOTH;
use warpbeam::{Axis, ElementKind, Material, Plane, Scene};

/// A fixed sequence of well-mixed 64-bit numbers (splitmix64, Steele et al. 2014).
#[derive(Debug)]
pub struct Random(pub u64);

impl Random {
    /// Returns a number from 0 to 1.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Returns a whole number below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    pub fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }
}

const PLANES: &[Plane] = &[Plane::Stress, Plane::Strain];
const ELEMENTS: &[ElementKind] = &[ElementKind::T3, ElementKind::T6, ElementKind::Q4];

/// Returns a static rectangle of aspect 0.1 to 1000 with supports, loads and a probe of every kind, on a coarse mesh.
pub fn scene(seed: u64) -> Scene {
    let mut random = Random(seed.wrapping_mul(0x5851_F42D_4C95_7F2D));
    let random = &mut random;
    let aspect = 10f64.powf(random.between(-1.0, 3.0));
    let [length, height] = [aspect.max(1.0), (1.0 / aspect).max(1.0)];
    let (lies, long, short) = (length >= height, length.max(height), length.min(height));
    let poisson = random.one_of(&[0.0, 0.3, 0.45, 0.49, 0.499, 0.4999]);
    let material = Material { plane: random.one_of(PLANES), ..Material::new(1e6, poisson) };
    let element = random.one_of(ELEMENTS);
    let most = if element == ElementKind::T6 { 20 } else { 40 };
    let (along, across) = (4 + random.below(most) as u32, 1 + random.below(4) as u32);
    let [along, across] = if lies { [along, across] } else { [across, along] };
    let mut scene = Scene::beam(length, height).with_cells(along, across).with_element(element).with_material(material);
    scene.name = format!("random {seed}");
    let [start, end] = if lies { ["left", "right"] } else { ["bottom", "top"] };
    let side = random.one_of(if lies { &["top", "bottom"] } else { &["left", "right"] });
    // Returns a point by its position along and across the rectangle.
    let at = |along: f64, across: f64| match lies {
        true => [along * length, across * height],
        false => [(across + 0.5) * length, (along - 0.5) * height],
    };
    let vector = |along: f64, across: f64| if lies { [along, across] } else { [across, along] };
    let across_axis = if lies { Axis::Y } else { Axis::X };
    let kind = random.below(6);
    scene = match kind {
        0 | 1 => scene.clamp(start),
        2 => scene.clamp(start).clamp(end),
        3 => {
            let (a, b) = (at(random.between(0.0, 0.3), -0.5), at(random.between(0.7, 1.0), -0.5));
            scene.support(a, BOTH).support(b, &[across_axis])
        }
        4 => scene.clamp(start).support(end, &[across_axis]),
        _ => {
            let moved = vector(0.0, random.between(-0.02, 0.02) * long);
            let turn = if random.unit() < 0.3 { random.between(-0.2, 0.2) } else { 0.0 };
            scene.clamp(start).clamp(end).moved(moved, turn)
        }
    };
    let is_cantilever = kind < 2;
    let slender = long / short > 3.0;
    let unit = if slender { 1e6 * short.powi(3) / 12.0 / long.powi(2) } else { 1e5 * short };
    let loaded = if is_cantilever { end } else { side };
    for _ in 0..=random.below(2) {
        let size = unit * 10f64.powf(random.between(-2.0, 0.5));
        // Across the rectangle, or inclined by up to a right angle towards tension.
        let angle = random.between(0.0, std::f64::consts::FRAC_PI_2);
        let sign = random.one_of(&[-1.0, 1.0]);
        let force = vector(size * angle.cos() * if is_cantilever { 1.0 } else { 0.1 }, sign * size * angle.sin());
        scene = match random.below(4) {
            0 => scene.force(loaded, force),
            1 => scene.force(at(random.between(0.3, 1.0), random.between(-0.5, 0.5)), force),
            2 => scene.gravity(force.map(|f| f / (1000.0 * length * height))),
            _ => scene.moment(loaded, sign * size * long * if is_cantilever { 1.0 } else { 0.1 }),
        };
    }
    match random.below(2) {
        0 => scene.probe("probe", loaded),
        _ => scene.probe("probe", at(random.between(0.3, 1.0), random.between(-0.5, 0.5))),
    }
}

/// Returns a static scene on a coarse mesh with forces, and in some scenes supports, at points between nodes; a probe at
/// each of them, at another point and at the end.
pub fn scene_with_points(seed: u64) -> Scene {
    let mut random = Random(seed.wrapping_mul(0x5851_F42D_4C95_7F2D));
    let random = &mut random;
    let length = random.between(1.5, 6.0);
    let element = random.one_of(ELEMENTS);
    let (along, across) = (3 + random.below(4) as u32, 1 + random.below(4) as u32);
    let poisson = random.one_of(&[0.0, 0.3, 0.45]);
    let material = Material { plane: random.one_of(PLANES), ..Material::new(1e6, poisson) };
    let mut scene = Scene::beam(length, 1.0).with_cells(along, across).with_element(element).with_material(material);
    scene.name = format!("points {seed}");
    let mut points: Vec<[f64; 2]> = Vec::new();
    // On an outline, near it, or anywhere.
    let mut point = |random: &mut Random| {
        let anywhere = random.between(-0.5, 0.5);
        points.push([random.between(0.02, 1.0) * length, random.one_of(&[-0.5, 0.5, 0.49, 0.0, anywhere])]);
        points[points.len() - 1]
    };
    scene = match random.below(4) {
        0 | 1 => scene.clamp("left"),
        2 => (0..=random.below(2)).fold(scene.clamp("left"), |scene, _| {
            let fix = random.one_of(&[&[Axis::Y][..], &[Axis::X], BOTH]);
            let is_moved = random.unit() < 0.4 && fix.contains(&Axis::Y);
            let moved = if is_moved { random.between(-0.03, 0.03) } else { 0.0 };
            scene.point_support(point(random), fix).moved([0.0, moved], 0.0)
        }),
        _ => scene.point_support(point(random), BOTH).point_support(point(random), &[Axis::Y]),
    };
    for _ in 0..=random.below(3) {
        let size = 1e6 / 12.0 / (length * length) * 10f64.powf(random.between(-2.0, -0.5));
        let angle = random.between(-3.2, 3.2);
        scene = scene.point_force(point(random), [size * angle.cos(), size * angle.sin()]);
    }
    point(random);
    let probes = points.iter().enumerate();
    probes.fold(scene, |scene, (i, at)| scene.probe(&format!("p{i}"), *at)).probe("end", "right")
}

//! Random scenes from a fixed seed.

use std::fmt::Write as _;

use warpbeam::Scene;

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

/// Returns a static rectangle of aspect 0.1 to 1000 with supports, loads and a probe of every kind, on a coarse mesh.
pub fn scene(seed: u64) -> Scene {
    let mut random = Random(seed.wrapping_mul(0x5851_F42D_4C95_7F2D));
    let random = &mut random;
    let aspect = 10f64.powf(random.between(-1.0, 3.0));
    let [length, height] = [aspect.max(1.0), (1.0 / aspect).max(1.0)];
    let (lies, long, short) = (length >= height, length.max(height), length.min(height));
    let poisson = random.one_of(&[0.0, 0.3, 0.45, 0.49, 0.499, 0.4999]);
    let plane = random.one_of(&["stress", "strain"]);
    let (element, most) = random.one_of(&[("t3", 40), ("t6", 20), ("q4", 40)]);
    let (along, across) = (4 + random.below(most), 1 + random.below(4));
    let cells = if lies { [along, across] } else { [across, along] };
    let mut toml = format!(
        "name = \"random {seed}\"\n[beam]\nlength = {length}\nheight = {height}\ncells = {cells:?}\nelement = \"{element}\"\n\
         [material]\nyoung = 1e6\npoisson = {poisson}\nplane = \"{plane}\"\n"
    );
    let [start, end] = if lies { ["left", "right"] } else { ["bottom", "top"] };
    let side = random.one_of(if lies { &["top", "bottom"] } else { &["left", "right"] });
    // Returns a point by its position along and across the rectangle.
    let at = |along: f64, across: f64| match lies {
        true => [along * length, across * height],
        false => [(across + 0.5) * length, (along - 0.5) * height],
    };
    let vector = |along: f64, across: f64| if lies { [along, across] } else { [across, along] };
    let across_axis = if lies { "y" } else { "x" };
    let clamp = |edge: &str| format!("[[support]]\nedge = \"{edge}\"\nfix = [\"x\", \"y\"]\n");
    let kind = random.below(6);
    toml += &match kind {
        0 | 1 => clamp(start),
        2 => clamp(start) + &clamp(end),
        3 => {
            let (a, b) = (at(random.between(0.0, 0.3), -0.5), at(random.between(0.7, 1.0), -0.5));
            format!(
                "[[support]]\nat = {a:?}\nfix = [\"x\", \"y\"]\n[[support]]\nat = {b:?}\nfix = [\"{across_axis}\"]\n"
            )
        }
        4 => clamp(start) + &format!("[[support]]\nedge = \"{end}\"\nfix = [\"{across_axis}\"]\n"),
        _ => {
            let moved = vector(0.0, random.between(-0.02, 0.02) * long);
            let turn = if random.unit() < 0.3 { random.between(-0.2, 0.2) } else { 0.0 };
            clamp(start) + &format!("{}displacement = {moved:?}\nturn = {turn}\n", clamp(end))
        }
    };
    let is_cantilever = kind < 2;
    let slender = long / short > 3.0;
    let unit = if slender { 1e6 * short.powi(3) / 12.0 / long.powi(2) } else { 1e5 * short };
    for _ in 0..=random.below(2) {
        let size = unit * 10f64.powf(random.between(-2.0, 0.5));
        // Across the rectangle, or inclined by up to a right angle towards tension.
        let angle = random.between(0.0, std::f64::consts::FRAC_PI_2);
        let sign = random.one_of(&[-1.0, 1.0]);
        let force = vector(size * angle.cos() * if is_cantilever { 1.0 } else { 0.1 }, sign * size * angle.sin());
        let loaded = if is_cantilever { end } else { side };
        let _ = match random.below(4) {
            0 => write!(toml, "[[load]]\nkind = \"force\"\nedge = \"{loaded}\"\nforce = {force:?}\n"),
            1 => {
                let point = at(random.between(0.3, 1.0), random.between(-0.5, 0.5));
                write!(toml, "[[load]]\nkind = \"force\"\nat = {point:?}\nforce = {force:?}\n")
            }
            2 => {
                let acceleration = force.map(|f| f / (1000.0 * length * height));
                write!(toml, "[[load]]\nkind = \"gravity\"\nacceleration = {acceleration:?}\n")
            }
            _ => {
                let moment = sign * size * long * if is_cantilever { 1.0 } else { 0.1 };
                write!(toml, "[[load]]\nkind = \"moment\"\nedge = \"{loaded}\"\nmoment = {moment}\n")
            }
        };
    }
    let _ = match random.below(2) {
        0 => write!(toml, "[[probe]]\nname = \"probe\"\nedge = \"{}\"\n", if is_cantilever { end } else { side }),
        _ => {
            let point = at(random.between(0.3, 1.0), random.between(-0.5, 0.5));
            write!(toml, "[[probe]]\nname = \"probe\"\nat = {point:?}\n")
        }
    };
    Scene::from_toml(&toml).unwrap_or_else(|error| panic!("{error}\n{toml}"))
}

/// Returns a static scene on a coarse mesh with forces, and in some scenes supports, at points between nodes; a probe at
/// each of them, at another point and at the end.
pub fn scene_with_points(seed: u64) -> Scene {
    let mut random = Random(seed.wrapping_mul(0x5851_F42D_4C95_7F2D));
    let random = &mut random;
    let length = random.between(1.5, 6.0);
    let (element, along, across) = (random.one_of(&["t3", "t6", "q4"]), 3 + random.below(4), 1 + random.below(4));
    let (poisson, plane) = (random.one_of(&[0.0, 0.3, 0.45]), random.one_of(&["stress", "strain"]));
    let mut toml = format!(
        "name = \"points {seed}\"\n[beam]\nlength = {length}\nheight = 1.0\ncells = [{along}, {across}]\nelement = \"{element}\"\n\
         [material]\nyoung = 1e6\npoisson = {poisson}\nplane = \"{plane}\"\n"
    );
    let mut points: Vec<[f64; 2]> = Vec::new();
    // On an outline, near it, or anywhere.
    let mut point = |random: &mut Random| {
        let anywhere = random.between(-0.5, 0.5);
        let at = [random.between(0.02, 1.0) * length, random.one_of(&[-0.5, 0.5, 0.49, 0.0, anywhere])];
        points.push(at);
        at
    };
    let clamp = "[[support]]\nedge = \"left\"\nfix = [\"x\", \"y\"]\n";
    let held = |at: [f64; 2], fix: &str, moved: f64| {
        format!("[[support]]\nat = {at:?}\nacts_on = \"point\"\nfix = {fix}\ndisplacement = [0.0, {moved}]\n")
    };
    match random.below(4) {
        0 | 1 => toml += clamp,
        2 => {
            toml += clamp;
            for _ in 0..=random.below(2) {
                let fix = random.one_of(&["[\"y\"]", "[\"x\"]", "[\"x\", \"y\"]"]);
                let moved = if random.unit() < 0.4 && fix.contains('y') { random.between(-0.03, 0.03) } else { 0.0 };
                toml += &held(point(random), fix, moved);
            }
        }
        _ => toml += &(held(point(random), "[\"x\", \"y\"]", 0.0) + &held(point(random), "[\"y\"]", 0.0)),
    }
    for _ in 0..=random.below(3) {
        let size = 1e6 / 12.0 / (length * length) * 10f64.powf(random.between(-2.0, -0.5));
        let angle = random.between(-3.2, 3.2);
        let force = [size * angle.cos(), size * angle.sin()];
        let at = point(random);
        let _ = write!(toml, "[[load]]\nkind = \"force\"\nat = {at:?}\nacts_on = \"point\"\nforce = {force:?}\n");
    }
    point(random);
    for (i, at) in points.iter().enumerate() {
        let _ = write!(toml, "[[probe]]\nname = \"p{i}\"\nat = {at:?}\n");
    }
    toml += "[[probe]]\nname = \"end\"\nedge = \"right\"\n";
    Scene::from_toml(&toml).unwrap_or_else(|error| panic!("{error}\n{toml}"))
}

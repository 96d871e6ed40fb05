//! Draws the figures of the documents, each as an SVG for a light and for a dark page.
//!
//! `cargo run --release --example figures --no-default-features` computes all but the figure of times, whose numbers
//! are read from `docs/measurements/performance.md`.

use std::error::Error;
use std::f64::consts::FRAC_PI_4;
use std::fmt::Write as _;
use std::path::Path;

use warpbeam::{ElementKind, Material, MethodKind, Reference, Scene, Simulation, Status};

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let table = std::fs::read_to_string(root.join("docs/measurements/performance.md"))?;
    let figures =
        [("theory-rotation", rotation()), ("rho", rho()?), ("convergence", convergence()?), ("front", front(&table))];
    for (name, figure) in figures {
        for (theme, colors) in [("light", &LIGHT), ("dark", &DARK)] {
            let file = format!("assets/{name}-{theme}.svg");
            std::fs::write(root.join(&file), figure.svg(colors))?;
            println!("wrote {file}");
        }
    }
    Ok(())
}

/// Colours of a page: text, grid, and series.
pub struct Colors {
    text: &'static str,
    grid: &'static str,
    series: [&'static str; 4],
}

/// Colours of a light page.
pub const LIGHT: Colors = Colors { text: "#333", grid: "#ddd", series: ["#1f6fb4", "#c8500a", "#007d73", "#8a4fbf"] };
/// Colours of a dark page.
pub const DARK: Colors = Colors { text: "#ccc", grid: "#444", series: ["#6db3f2", "#ff9d57", "#4fd1c5", "#c8a2f0"] };

/// Scale of an axis.
#[derive(Clone, Copy)]
enum Axis {
    Linear,
    Logarithmic,
}

/// Series of a figure: name, points, and `true` if they are joined.
struct Series {
    name: String,
    points: Vec<[f64; 2]>,
    joined: bool,
}

/// Figure over two axes, each with a label, a scale, and its marked values.
pub struct Figure {
    axes: [(String, Axis, Vec<f64>); 2],
    series: Vec<Series>,
    /// `true` if a unit has the same length along both axes.
    has_one_scale: bool,
}

const SIZE: [f64; 2] = [640.0, 380.0];
const LEFT: f64 = 70.0;
const RIGHT: f64 = 130.0;
const TOP: f64 = 20.0;
const BOTTOM: f64 = 55.0;

impl Figure {
    /// Returns the figure as SVG. The first and last marked value are the ends of an axis.
    pub fn svg(&self, colors: &Colors) -> String {
        let [width, height] = [SIZE[0] - LEFT - RIGHT, SIZE[1] - TOP - BOTTOM];
        let part = |i: usize, value: f64| {
            let (_, scale, marks) = &self.axes[i];
            let (low, high) = (marks[0], marks[marks.len() - 1]);
            match scale {
                Axis::Linear => (value - low) / (high - low),
                Axis::Logarithmic => (value / low).ln() / (high / low).ln(),
            }
        };
        // With one scale, the vertical axis decides.
        let across = if self.has_one_scale { height / width } else { 1.0 };
        let place = |[x, y]: [f64; 2]| [LEFT + width * across * part(0, x), TOP + height * (1.0 - part(1, y))];
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" \
             font-size=\"13\" fill=\"{}\">\n",
            SIZE[0], SIZE[1], colors.text
        );
        let lows = [0, 1].map(|i| self.axes[i].2[0]);
        let highs = [0, 1].map(|i| self.axes[i].2[self.axes[i].2.len() - 1]);
        for (i, (label, _, marks)) in self.axes.iter().enumerate() {
            for &mark in marks {
                let ends =
                    if i == 0 { [[mark, lows[1]], [mark, highs[1]]] } else { [[lows[0], mark], [highs[0], mark]] };
                let [[x0, y0], [x1, y1]] = ends.map(place);
                let _ = writeln!(svg, "<path d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}\" stroke=\"{}\"/>", colors.grid);
                let (x, y, anchor) = if i == 0 { (x0, y0 + 18.0, "middle") } else { (x0 - 8.0, y0 + 4.0, "end") };
                let _ = writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{mark}</text>");
            }
            let (x, y) = (LEFT + 0.5 * width, SIZE[1] - 12.0);
            let _ = match i {
                0 => writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{label}</text>"),
                _ => {
                    let middle = TOP + 0.5 * height;
                    let turn = format!("rotate(-90 18 {middle:.1})");
                    writeln!(
                        svg,
                        "<text x=\"18\" y=\"{middle:.1}\" text-anchor=\"middle\" transform=\"{turn}\">{label}</text>"
                    )
                }
            };
        }
        for (i, Series { name, points, joined }) in self.series.iter().enumerate() {
            let color = colors.series[i % colors.series.len()];
            let places: Vec<_> = points.iter().map(|&point| place(point)).collect();
            if *joined {
                let path: Vec<_> = places.iter().map(|[x, y]| format!("{x:.1} {y:.1}")).collect();
                let _ = writeln!(
                    svg,
                    "<path d=\"M{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>",
                    path.join("L")
                );
            }
            for [x, y] in &places {
                let _ = writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\" fill=\"{color}\"/>");
            }
            let (x, y) = (SIZE[0] - RIGHT + 16.0, TOP + 14.0 + 22.0 * i as f64);
            let _ = writeln!(svg, "<circle cx=\"{x}\" cy=\"{:.1}\" r=\"4\" fill=\"{color}\"/>", y - 4.0);
            let _ = writeln!(svg, "<text x=\"{:.1}\" y=\"{y:.1}\">{name}</text>", x + 10.0);
        }
        svg + "</svg>\n"
    }
}

/// Draws a triangle at rest, under the displacement gradient θ J of linear theory, and under the rotation by θ.
pub fn rotation() -> Figure {
    let rest = [[1.0, 0.0], [2.0, 0.0], [1.0, 1.0], [1.0, 0.0]];
    // The gradient θ J moves the end of a body that turns by 45° in linear theory: θ = tan 45°.
    let linear = rest.map(|[x, y]| [x - y, y + x]);
    let (s, c) = FRAC_PI_4.sin_cos();
    let rotated = rest.map(|[x, y]| [c * x - s * y, s * x + c * y]);
    let series = [("rotated by R", rotated), ("linear theory", linear), ("at rest", rest)];
    let marks = || vec![0.0, 0.5, 1.0, 1.5, 2.0];
    Figure {
        axes: [("x, m".to_owned(), Axis::Linear, marks()), ("y, m".to_owned(), Axis::Linear, marks())],
        series: series
            .map(|(name, points)| Series { name: name.to_owned(), points: points.to_vec(), joined: true })
            .into(),
        has_one_scale: true,
    }
}

/// Returns a cantilever fifty times as long as high, and the force of α = P L²/EI = 1, N.
fn ribbon() -> (Scene, f64) {
    let scene = Scene::beam(50.0, 1.0)
        .with_material(Material::new(1e6, 0.0))
        .clamp("left")
        .force("right", [0.0, 0.0])
        .probe("tip", "right");
    (scene, 1e6 / 12.0 / 2500.0)
}

/// Computes ρ of a cantilever under growing loads.
fn rho() -> Result<Figure, Box<dyn Error>> {
    let (scene, unit) = ribbon();
    let mut beam = Simulation::new(&scene.with_cells(20, 1).with_element(ElementKind::T6))?;
    let mut points = Vec::new();
    for i in 1..=20 {
        let alpha = 0.5 * f64::from(i);
        beam.edit(|scene| scene.set_force(0, [0.0, -alpha * unit]))?;
        if *beam.solve() != Status::Converged {
            return Err(format!("α = {alpha}: {:?}", beam.status()).into());
        }
        let rho = beam.certify().fixed_point_rho.ok_or("no ρ")?;
        println!("α = {alpha}: ρ = {rho:.3}");
        points.push([alpha, rho]);
    }
    let axes = [
        ("load α = P L²/EI".to_owned(), Axis::Linear, (0..=5).map(|i| 2.0 * f64::from(i)).collect()),
        ("ρ".to_owned(), Axis::Linear, (0..=4).map(f64::from).collect()),
    ];
    let limit = Series { name: "ρ = 1".to_owned(), points: vec![[0.0, 1.0], [10.0, 1.0]], joined: true };
    Ok(Figure {
        axes,
        series: vec![Series { name: "T6 20 × 1".to_owned(), points, joined: true }, limit],
        has_one_scale: false,
    })
}

/// Computes the error of the tip of a cantilever on finer and finer meshes of each element.
fn convergence() -> Result<Figure, Box<dyn Error>> {
    let scene = Scene::beam(10.0, 1.0)
        .with_material(Material::new(1e6, 0.3))
        .with_method(MethodKind::Newton)
        .clamp("left")
        .force("right", [0.0, -1000.0])
        .probe("tip", "right");
    let reference = Reference::of(&scene.clone().with_cells(20, 2).with_element(ElementKind::T6))?;
    let probe = reference.first().ok_or("no reference")?;
    println!("reference: {:?}, own error {:.2} %", probe.displacement, probe.own_error_percent);
    let mut series = Vec::new();
    for (element, name, finest) in [(ElementKind::T3, "t3", 16), (ElementKind::T6, "t6", 8), (ElementKind::Q4, "q4", 8)]
    {
        let mut points = Vec::new();
        for across in [1, 2, 4, 8, 16].into_iter().filter(|n| *n <= finest) {
            let mut beam = Simulation::new(&scene.clone().with_cells(10 * across, across).with_element(element))?;
            beam.solve();
            let tip = beam.probe("tip").ok_or("no tip")?;
            let error = 100.0 * (tip - probe.displacement).norm() / probe.displacement.norm();
            let unknowns = beam.system().dofs() as f64;
            println!("{name} {}×{across}: {unknowns} unknowns, {error:.3} %", 10 * across);
            points.push([unknowns, error.max(0.02)]);
        }
        series.push(Series { name: name.to_owned(), points, joined: true });
    }
    let bound = probe.own_error_percent;
    series.push(Series { name: "reference".to_owned(), points: vec![[10.0, bound], [10_000.0, bound]], joined: true });
    let axes = [
        ("unknowns".to_owned(), Axis::Logarithmic, vec![10.0, 100.0, 1000.0, 10_000.0]),
        ("error of the tip, %".to_owned(), Axis::Logarithmic, vec![0.01, 0.1, 1.0, 10.0, 100.0]),
    ];
    Ok(Figure { axes, series, has_one_scale: false })
}

/// Draws the Pareto front that is printed in a document: its first table with a column of settings.
pub fn front(document: &str) -> Figure {
    let number = |cell: &str| cell.trim().trim_end_matches('%').trim().parse::<f64>().ok();
    let rows = document.lines().skip_while(|line| !line.starts_with("| time, ms ")).skip(2);
    let mut series: Vec<Series> = Vec::new();
    for row in rows.take_while(|line| line.starts_with('|')) {
        let cells: Vec<_> = row.trim_matches('|').split('|').collect();
        let [time, error, .., setting] = cells[..] else { continue };
        let (Some(time), Some(error)) = (number(time), number(error)) else { continue };
        let element = setting.trim().split(' ').next().unwrap_or_default();
        match series.iter_mut().find(|series| series.name == element) {
            Some(series) => series.points.push([time, error]),
            None => series.push(Series { name: element.to_owned(), points: vec![[time, error]], joined: false }),
        }
    }
    let axes = [
        ("time of a solve from rest, ms".to_owned(), Axis::Logarithmic, vec![0.0005, 0.001, 0.01, 0.1, 1.0]),
        ("error at most, %".to_owned(), Axis::Logarithmic, vec![0.1, 1.0, 10.0, 100.0]),
    ];
    Figure { axes, series, has_one_scale: false }
}

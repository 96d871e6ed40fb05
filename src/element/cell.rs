//! Reference shapes of elements in coordinates (ξ, η), independent of the number of nodes.

/// Reference shape, shared by elements of any degree on it.
#[derive(Debug)]
pub struct Cell {
    /// Name of the shape.
    pub name: &'static str,
    /// Corners, counter-clockwise.
    pub corners: &'static [[f64; 2]],
    /// Area in reference coordinates.
    pub area: f64,
    /// Corners of the four parts of a uniform refinement.
    pub children: &'static [&'static [[f64; 2]]],
    /// Weights of the corners at a point; they interpolate a map that keeps straight sides straight.
    pub corner_weights: fn(at: [f64; 2]) -> Vec<f64>,
    /// Distance-like function of a point: positive inside, 0 on the boundary, negative outside.
    pub depth: fn(at: [f64; 2]) -> f64,
    /// Cuts the cell into small triangles with `pieces` pieces per side.
    pub lattice: fn(pieces: u32) -> Lattice,
}

/// Cell cut into small triangles, for drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    /// Reference coordinates of the points.
    pub points: Vec<[f64; 2]>,
    /// Triangles between points, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// Points along each side, counter-clockwise, ends included.
    pub sides: Vec<Vec<u32>>,
}

/// The triangle (0, 0), (1, 0), (0, 1): ξ and η are the second and the third area coordinate.
pub const TRIANGLE: Cell = Cell {
    name: "triangle",
    corners: &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
    area: 0.5,
    children: &[
        &[[0.0, 0.0], [0.5, 0.0], [0.0, 0.5]],
        &[[0.5, 0.0], [1.0, 0.0], [0.5, 0.5]],
        &[[0.0, 0.5], [0.5, 0.5], [0.0, 1.0]],
        &[[0.5, 0.0], [0.5, 0.5], [0.0, 0.5]],
    ],
    corner_weights: |[x, y]| vec![1.0 - x - y, x, y],
    depth: |[x, y]| (1.0 - x - y).min(x).min(y),
    lattice: triangle_lattice,
};

/// The square [−1, 1]².
pub const SQUARE: Cell = Cell {
    name: "quadrilateral",
    corners: &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]],
    area: 4.0,
    children: &[
        &[[-1.0, -1.0], [0.0, -1.0], [0.0, 0.0], [-1.0, 0.0]],
        &[[0.0, -1.0], [1.0, -1.0], [1.0, 0.0], [0.0, 0.0]],
        &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        &[[-1.0, 0.0], [0.0, 0.0], [0.0, 1.0], [-1.0, 1.0]],
    ],
    corner_weights: bilinear,
    depth: |[x, y]| (1.0 - x.abs()).min(1.0 - y.abs()),
    lattice: square_lattice,
};

/// Evaluates the bilinear shape functions of the four corners of the square.
pub(super) fn bilinear([x, y]: [f64; 2]) -> Vec<f64> {
    SQUARE.corners.iter().map(|[a, b]| 0.25 * (1.0 + a * x) * (1.0 + b * y)).collect()
}

fn square_lattice(pieces: u32) -> Lattice {
    let point = |i: u32, j: u32| j * (pieces + 1) + i;
    let place = |i: u32| 2.0 * f64::from(i) / f64::from(pieces) - 1.0;
    let points = (0..=pieces).flat_map(|j| (0..=pieces).map(move |i| [place(i), place(j)])).collect();
    let mut triangles = Vec::new();
    for (i, j) in (0..pieces).flat_map(|j| (0..pieces).map(move |i| (i, j))) {
        let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    let sides = vec![
        (0..=pieces).map(|i| point(i, 0)).collect(),
        (0..=pieces).map(|j| point(pieces, j)).collect(),
        (0..=pieces).rev().map(|i| point(i, pieces)).collect(),
        (0..=pieces).rev().map(|j| point(0, j)).collect(),
    ];
    Lattice { points, triangles, sides }
}

fn triangle_lattice(pieces: u32) -> Lattice {
    // Rows get shorter: row j holds pieces + 1 − j points.
    let point = |i: u32, j: u32| j * (pieces + 1) - j * j.saturating_sub(1) / 2 + i;
    let step = 1.0 / f64::from(pieces);
    let rows = || (0..=pieces).flat_map(move |j| (0..=pieces - j).map(move |i| (i, j)));
    let points = rows().map(|(i, j)| [f64::from(i) * step, f64::from(j) * step]).collect();
    let mut triangles = Vec::new();
    for (i, j) in rows().filter(|(i, j)| i + j < pieces) {
        triangles.push([point(i, j), point(i + 1, j), point(i, j + 1)]);
        if i + j + 2 <= pieces {
            triangles.push([point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
        }
    }
    let sides = vec![
        (0..=pieces).map(|i| point(i, 0)).collect(),
        (0..=pieces).map(|j| point(pieces - j, j)).collect(),
        (0..=pieces).rev().map(|j| point(0, j)).collect(),
    ];
    Lattice { points, triangles, sides }
}

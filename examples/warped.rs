//! The warped stiffness method on one page, in dense matrices: the beam of the article, 10 triangles and 12 nodes.
//! `cargo run --example warped --no-default-features` prints the tip of `warpbeam solve article`.

use warpbeam::nalgebra::{DMatrix, DVector, Matrix2, Matrix3, SMatrix, Vector2, Vector6};

const YOUNG: f64 = 1e6; // Pa
const POISSON: f64 = 0.3;
const FORCE: f64 = -30e3; // N, downwards on the free end

fn main() {
    println!("tip of the beam, m: {:.6?}", tip().map(|u| [u.x, u.y]));
}

/// Returns the displacement of the middle of the free end, m; `None` if the iteration does not converge.
pub fn tip() -> Option<Vector2<f64>> {
    // Pairs of nodes from left to right, the lower one first; two triangles for each square cell.
    let rest: Vec<Vector2<f64>> = (0..12).map(|i| Vector2::new((i / 2) as f64, (i % 2) as f64)).collect();
    let triangles = (0..10).step_by(2).flat_map(|i| [[i, i + 2, i + 3], [i, i + 3, i + 1]]);
    let c = Matrix3::new(1.0, POISSON, 0.0, POISSON, 1.0, 0.0, 0.0, 0.0, 0.5 * (1.0 - POISSON));
    let hooke = c * (YOUNG / (1.0 - POISSON * POISSON)); // plane stress
    let mut x = rest.clone();
    for _ in 0..1000 {
        // Σ R Ke Rᵀ x = f + Σ R Ke X: equation (2) of the article, here A x = b.
        let (mut a, mut b) = (DMatrix::<f64>::zeros(24, 24), DVector::<f64>::zeros(24));
        (b[21], b[23]) = (0.5 * FORCE, 0.5 * FORCE);
        for nodes in triangles.clone() {
            let sides = |x: &[Vector2<f64>]| Matrix2::from_columns(&[1, 2].map(|i| x[nodes[i]] - x[nodes[0]]));
            let inverse = sides(&rest).try_inverse()?;
            // The rotation R of F = R S, by the polar decomposition in closed form (equations (37) to (39)).
            let f = sides(&x) * inverse;
            let (cos, sin) = (f.m11 + f.m22, f.m21 - f.m12);
            let r = Matrix2::new(cos, -sin, sin, cos) / cos.hypot(sin);
            // The stiffness Ke = ∫ Bᵀ C B dA of linear theory; B takes displacements to strains.
            let (g, h) = (inverse.row(0), inverse.row(1));
            let gradients = [-g - h, g.into_owned(), h.into_owned()];
            let strain = SMatrix::<f64, 3, 6>::from_fn(|row, k| match (row, k % 2) {
                (0, 0) | (1, 1) => gradients[k / 2][row],
                (2, axis) => gradients[k / 2][1 - axis],
                _ => 0.0,
            });
            let stiffness = strain.transpose() * hooke * strain * (0.5 * sides(&rest).determinant());
            let warp = Matrix3::identity().kronecker(&r); // R for each of the three nodes
            let offset = warp * stiffness * Vector6::from_fn(|k, _| rest[nodes[k / 2]][k % 2]);
            let warped = warp * stiffness * warp.transpose();
            let unknown = |k: usize| 2 * nodes[k / 2] + k % 2;
            (0..6).for_each(|i| b[unknown(i)] += offset[i]);
            (0..36).for_each(|k| a[(unknown(k / 6), unknown(k % 6))] += warped[(k / 6, k % 6)]);
        }
        // 24 → 20 unknowns: the two nodes at the left stay at X, and their columns are known forces.
        let clamped = DVector::from_fn(4, |k, _| rest[k / 2][k % 2]);
        let forces = b.rows(4, 20) - a.view((4, 0), (20, 4)) * clamped;
        let free = a.view((4, 4), (20, 20)).into_owned().cholesky()?.solve(&forces);
        let moved = (0..20).map(|k| (free[k] - x[2 + k / 2][k % 2]).abs()).fold(0.0, f64::max);
        (0..20).for_each(|k| x[2 + k / 2][k % 2] = free[k]);
        if moved < 1e-12 {
            return Some(0.5 * (x[10] - rest[10] + x[11] - rest[11]));
        }
    }
    None
}

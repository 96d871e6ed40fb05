//! Sides of elements: nodes along a line, straight or curved.

use nalgebra::Vector2;

/// Gauss points and weights on [−1, 1], exact to degree 5.
const GAUSS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Evaluates Lagrange's polynomials on `n` equally spaced nodes over [−1, 1], and their derivatives, at `xi`.
pub(crate) fn lagrange(n: usize, xi: f64) -> Vec<(f64, f64)> {
    let node = |i: usize| 2.0 * i as f64 / (n - 1) as f64 - 1.0;
    let others = |a: usize| (0..n).filter(move |&b| b != a);
    (0..n)
        .map(|a| {
            let factor = |b: usize| (xi - node(b)) / (node(a) - node(b));
            let value = others(a).map(factor).product();
            let slope = others(a).map(|b| {
                let rest: f64 = others(a).filter(|&c| c != b).map(factor).product();
                rest / (node(a) - node(b))
            });
            (value, slope.sum())
        })
        .collect()
}

/// Returns ∫ Nₐ ds for nodes in their order along a side, m: the nodes' weights in a uniform traction.
pub fn side_weights(nodes: &[Vector2<f64>]) -> Vec<f64> {
    let mut weights = vec![0.0; nodes.len()];
    if nodes.len() < 2 {
        return weights;
    }
    integrate_side(nodes, [-1.0, 1.0], |shape, length| {
        weights.iter_mut().zip(shape).for_each(|(sum, n)| *sum += length * n);
    });
    weights
}

/// Calls `visit` at Gauss points of a part of a side, from one parameter to another within [−1, 1], with the shape
/// functions of the side's nodes and the length that the point stands for, m.
pub(crate) fn integrate_side(nodes: &[Vector2<f64>], [from, to]: [f64; 2], mut visit: impl FnMut(&[f64], f64)) {
    let half = 0.5 * (to - from);
    for (xi, weight) in GAUSS {
        let (shape, slopes): (Vec<f64>, Vec<f64>) = lagrange(nodes.len(), from + half * (xi + 1.0)).into_iter().unzip();
        let tangent: Vector2<f64> = nodes.iter().zip(slopes).map(|(x, slope)| x * slope).sum();
        visit(&shape, weight * half * tangent.norm());
    }
}
